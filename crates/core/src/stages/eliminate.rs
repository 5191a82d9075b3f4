//! Elimination: samples claim their disks in an order (paper, Algorithm 4, first loop). The survivors are the greedy
//! maximal independent set of the conflict graph in that order. Whether two samples are in conflict is decided by
//! [`covers_offset`], and which of them survives by `eliminate` below.

use crate::error::SampleError;
use crate::grid::SampleGrid;
use crate::lattice::{Domain, R, covers_offset};
use crate::progress::Meter;
use crate::record::{Recorder, RunEvent};
use crate::samples::{Fate, Origin, Samples};
use crate::stages::blocks::Blocks;
use crate::stages::order::Ranking;

/// Returns the ids of the samples that may be in conflict, by rank, then id. They lie inside the domain, and either in
/// a margin (the part of a clip beyond its block) or within 2r of their block's border.
pub(crate) fn contested(
    samples: &Samples,
    blocks: &Blocks,
    ranking: &Ranking,
    meter: &mut Meter<'_>,
) -> Result<Vec<u32>, SampleError> {
    let mut ranked: Vec<(u32, u32)> = Vec::new();

    for (id, (&point, &origin)) in (0..).zip(samples.points.iter().zip(&samples.origins)) {
        meter.work(1)?;
        let Origin::Tiled { block, own, .. } = origin else {
            continue;
        };

        // The margins of other blocks end r inside a block. A sample deeper than 2 r in its block is farther than r from
        // them, and is in conflict with nothing (paper, section 3.2.3).
        let may_conflict = !own || blocks.leaves[block as usize].rect.depth(point) <= 2 * R;
        if may_conflict && samples.fates[id as usize] != Fate::Dropped {
            ranked.push((ranking.rank(point, own), id));
        }
    }

    ranked.sort_unstable();
    Ok(ranked.into_iter().map(|(_, id)| id).collect())
}

/// Decides the fate of every undecided sample: `Kept`, or `Eliminated` by the first kept sample
/// that covers it. `contested` lists, in order, all that may be in conflict.
pub(crate) fn eliminate<T: Recorder>(
    domain: &Domain,
    samples: &mut Samples,
    contested: &[u32],
    meter: &mut Meter<'_>,
    recorder: &mut T,
) -> Result<(), SampleError> {
    // All other samples are in conflict with none, so that nothing needs to find them.
    let mut grid = SampleGrid::with_capacity(*domain, contested.len());
    for &id in contested {
        grid.insert(id, samples.points[id as usize]);
        meter.work(1)?;
    }

    // Algorithm 4, lines 2 to 6. An eliminated sample claims nothing.
    for &id in contested {
        let valid = samples.fates[id as usize] == Fate::Undecided;
        recorder.record(RunEvent::Take { sample: id, valid });

        if valid {
            samples.fates[id as usize] = Fate::Kept;
            // The rest, those that nothing contests, are kept below.
            let rest = false;
            recorder.record(RunEvent::Keep { sample: id, rest });

            grid.any_near(samples.points[id as usize], R, |near| {
                let fate = &mut samples.fates[near.id as usize];
                // Samples kept before do not cover this one, or it would be gone; eliminated ones keep the name of the
                // first that covered them.
                if *fate == Fate::Undecided {
                    let covers = covers_offset(near.offset);
                    let (pivot, other) = (id, near.id);
                    recorder.record(RunEvent::Test {
                        pivot,
                        other,
                        covers,
                    });
                    if covers {
                        *fate = Fate::Eliminated { by: id };
                        recorder.record(RunEvent::Eliminate {
                            sample: near.id,
                            by: id,
                        });
                    }
                }
                // The search goes on to all samples.
                false
            });
        }

        meter.tick()?;
    }

    keep_rest(samples, recorder);
    Ok(())
}

/// Keeps every sample that was not contested.
pub(crate) fn keep_rest<T: Recorder>(samples: &mut Samples, recorder: &mut T) {
    for (fate, sample) in samples.fates.iter_mut().zip(0..) {
        if *fate == Fate::Undecided {
            *fate = Fate::Kept;
            recorder.record(RunEvent::Keep { sample, rest: true });
        }
    }
}
