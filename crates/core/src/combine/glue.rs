//! Runs the stages near the seams: elimination, detection and insertion among the samples there.

use rayon::prelude::*;

use super::clip::{Clip, clips};
use super::{CombineError, CombineOptions, EliminatedSample, Piece};
use crate::engine::sequential::{survivors, uniform};
use crate::error::SampleError;
use crate::lattice::{Domain, Point, R};
use crate::parameters::Insertion;
use crate::pattern::Symmetry;
use crate::progress::{Meter, Observer};
use crate::random::Key;
use crate::record::Unrecorded;
use crate::run::Iteration;
use crate::samples::{Fate, Origin, Samples};
use crate::stage::Stage;
use crate::stages::blocks::{Block, Blocks};
use crate::stages::detect::{Candidate, Detection, first_detectors};
use crate::stages::eliminate::{contested, eliminate};
use crate::stages::insert::{insert, unique};
use crate::stages::order::Ranking;
use crate::stages::tile::{Tile, push_tiled};
use crate::stages::uniform::gap_process;

/// How far around a detector samples are read, at most: 7r in the box around a detector at a border.
const READ: i32 = 7 * R;

/// How far inside their rectangles samples are considered at first. Eliminated samples are at most 2r inside, so first
/// detectors at most 4r and 4 units.
pub(super) const NEAR: i32 = 5 * R + READ;

/// Detectors between two calls of the observer, and those of one task of a thread. No result depends on either.
const BATCH: usize = 1 << 14;
const TURN: usize = 256;

/// The samples near the seams with their fates, and all others.
pub(super) struct Glued {
    pub samples: Samples,
    /// The samples near the seams by piece.
    pub tiles: Vec<Tile>,
    /// The other samples by piece; all are in the result.
    pub deep: Vec<Vec<(Point, u32)>>,
    /// The iterations, up to the last one that inserted any sample.
    pub iterations: Vec<Iteration>,
}

impl Glued {
    /// Returns the eliminated samples in the order of their ids: piece by piece and row by row.
    pub fn eliminated(&self) -> Vec<EliminatedSample> {
        let Samples {
            points,
            origins,
            fates,
        } = &self.samples;

        let each = points.iter().zip(origins).zip(fates);
        each.filter_map(|((&point, &origin), fate)| match (origin, fate) {
            (
                Origin::Tiled {
                    block,
                    pattern,
                    own,
                },
                Fate::Eliminated { .. },
            ) => {
                // A piece is tiled as the block of its number, from its own set in place of a pattern.
                Some(EliminatedSample {
                    point,
                    piece: block,
                    index: pattern,
                    own,
                })
            }
            // Other tiled samples were kept or dropped, and inserted ones are never eliminated.
            _ => None,
        })
        .collect()
    }
}

/// Glues the pieces, considering only samples up to `near` units inside their rectangles: [`NEAR`], or `i32::MAX` for
/// all, which gives the same result. If a sample is inserted deeper than expected, which only sets with lattice points
/// uncovered by a hair allow, it may depend on samples that were not considered: then gluing begins again with twice
/// the depth.
pub(super) fn glue(
    mut near: i32,
    domain: Domain,
    pieces: &[Piece],
    options: &CombineOptions,
    observer: &mut dyn Observer,
) -> Result<Glued, CombineError> {
    loop {
        let (glued, deepest) = glue_within(domain, pieces, options, near, observer)?;

        let sides = domain.rect().max;
        // A detector reads up to `READ` around itself, and inserted samples are the next detectors. Beyond the longest
        // side all samples were considered.
        if deepest <= near - READ || near > sides.x.max(sides.y) {
            return Ok(glued);
        }
        near = near.saturating_mul(2);
    }
}

/// Glues the pieces considering only samples up to `near` units inside their rectangles. Also returns the depth of the
/// deepest inserted sample.
fn glue_within(
    domain: Domain,
    pieces: &[Piece],
    options: &CombineOptions,
    near: i32,
    observer: &mut dyn Observer,
) -> Result<(Glued, i32), CombineError> {
    let meter = Meter::begin(observer, Stage::Tile, pieces.len() as u64)?;
    let contributions = clips(&domain, pieces, near);
    let mut glued = placed(&domain, pieces, contributions);
    meter.end()?;

    // Ids from here on are those of inserted samples.
    let first_inserted = glued.samples.len();
    decide_fates(&domain, pieces, options, &mut glued.samples, observer)?;

    match options.insertion {
        Insertion::Circumcentre => fill(domain, options, &mut glued, observer)?,
        Insertion::Uniform => throw(domain, options, &mut glued, observer)?,
    }

    // The last throws of darts may have hit nothing. The iterations end with one that inserted samples.
    let last_count = |glued: &Glued| glued.iterations.last().map(|last| last.inserted.len());
    while last_count(&glued) == Some(0) {
        glued.iterations.pop();
    }

    let inserted = &glued.samples.points[first_inserted..];
    // Each inserted sample lies in one of the rectangles, which partition the domain.
    let depth = |p: &Point| {
        let mut rects = pieces.iter().map(|piece| piece.rect);
        rects.find(|rect| rect.contains(*p)).map(|r| r.depth(*p))
    };
    // Without an inserted sample the depth is 0.
    let deepest = inserted.par_iter().filter_map(depth).max();
    Ok((glued, deepest.unwrap_or(0)))
}

/// Returns the contributions as samples, piece by piece.
fn placed(domain: &Domain, pieces: &[Piece], clips: Vec<Clip>) -> Glued {
    let mut samples = Samples::default();
    let (mut tiles, mut deep) = (
        Vec::with_capacity(clips.len()),
        Vec::with_capacity(clips.len()),
    );

    for ((piece, clip), index) in pieces.iter().zip(clips).zip(0..) {
        let first = samples.len() as u32;
        for (at, pattern) in clip.near {
            push_tiled(domain, &piece.rect, at, index, pattern, &mut samples);
        }

        tiles.push(Tile {
            // A tile's start is the point of the set that lies on the lowest corner of the rectangle enlarged by r.
            // The caller may give any 32-bit point as the start of a periodic set. The subtraction saturates, as it
            // would overflow for a start within r of the least number.
            start: Point::new(
                piece.start.x.saturating_sub(R),
                piece.start.y.saturating_sub(R),
            ),
            // Sets are not turned.
            symmetry: Symmetry(0),
            samples: first..samples.len() as u32,
        });
        deep.push(clip.deep);
    }

    Glued {
        samples,
        tiles,
        deep,
        iterations: Vec::new(),
    }
}

/// Returns the pieces' rectangles as blocks, without splits.
pub(super) fn blocks(pieces: &[Piece], key: Key) -> Blocks {
    let block = |piece: &Piece| Block {
        rect: piece.rect,
        key,
        depth: 0,
    };
    Blocks {
        splits: Vec::new(),
        leaves: pieces.iter().map(block).collect(),
    }
}

/// Decides the fates of all samples, as the stage of elimination does where the pieces are the blocks.
fn decide_fates(
    domain: &Domain,
    pieces: &[Piece],
    options: &CombineOptions,
    samples: &mut Samples,
    observer: &mut dyn Observer,
) -> Result<(), SampleError> {
    let key = Key::from_seed(options.seed);
    let as_blocks = blocks(pieces, key);
    let ranking = Ranking::new(options.order, domain, key);
    let mut meter = Meter::begin(observer, Stage::Eliminate, samples.len() as u64)?;
    // Only samples that may be in conflict with those of another piece are ranked and decided one by one; the others
    // are kept.
    let ranked = contested(samples, &as_blocks, &ranking, &mut meter)?;
    meter.set_total(ranked.len() as u64);
    eliminate(domain, samples, &ranked, &mut meter, &mut Unrecorded)?;
    meter.end()
}

/// Detects and inserts until no gap is left.
fn fill(
    domain: Domain,
    options: &CombineOptions,
    glued: &mut Glued,
    observer: &mut dyn Observer,
) -> Result<(), SampleError> {
    let key = Key::from_seed(options.seed);
    let samples = &mut glued.samples;
    // The search for the first detectors is progress of iteration 1, whose own meter follows in the loop.
    let mut meter = Meter::begin(observer, Stage::Iterate(1), samples.len() as u64)?;
    let mut grid = survivors(domain, samples, &mut meter)?;
    let mut detectors = first_detectors(samples, &grid, &mut meter, &mut Unrecorded)?;

    for k in 1.. {
        let meter = Meter::begin(observer, Stage::Iterate(k), detectors.len() as u64)?;
        // A detection keeps buffers, so that each task has one of its own.
        let detection = || Detection::new(domain, options.search, &grid);
        let candidates = detect(detection, samples, &detectors, meter)?;

        let inserted = insert(samples, &mut grid, &candidates, k, key, &mut Unrecorded);

        // If there is any candidate, the first one is inserted. If no sample was inserted, there is no candidate, and
        // so no gap.
        if inserted.is_empty() {
            break;
        }

        // Gaps that are left touch a sample inserted just now, as in the sequential engine: these samples alone detect
        // next.
        let searched = std::mem::replace(&mut detectors, inserted.clone().collect());
        glued.iterations.push(Iteration {
            detectors: searched,
            candidates,
            // Cells are those into which darts are thrown: here there are none.
            cells: Vec::new(),
            inserted,
        });
    }

    Ok(())
}

/// Throws darts into the gaps until none is left.
fn throw(
    domain: Domain,
    options: &CombineOptions,
    glued: &mut Glued,
    observer: &mut dyn Observer,
) -> Result<(), SampleError> {
    let samples = &mut glued.samples;
    let mut process = gap_process(domain, samples, Key::from_seed(options.seed));

    for k in 1.. {
        if process.is_finished() {
            break;
        }
        let made = uniform(&mut process, k, samples, observer, &mut Unrecorded)?;
        glued.iterations.push(made);
    }

    Ok(())
}

/// Returns the unique candidates of the detectors, found on all threads.
fn detect<'a>(
    detection: impl Fn() -> Detection<'a> + Sync,
    samples: &Samples,
    detectors: &[u32],
    mut meter: Meter<'_>,
) -> Result<Vec<Candidate>, SampleError> {
    let mut candidates = Vec::new();

    // The observer is asked between batches, since threads cannot share it.
    for batch in detectors.chunks(BATCH) {
        // Which thread finds a candidate does not matter: they are sorted below.
        let turns = batch.par_chunks(TURN).map(|turn| {
            let (mut own, mut found) = (detection(), Vec::new());
            for &id in turn {
                let at = samples.points[id as usize];
                own.find(id, at, &mut found, &mut Unrecorded);
            }
            found
        });

        candidates.par_extend(turns.flatten_iter());
        for _ in batch {
            meter.tick()?;
        }
    }

    unique(&mut candidates);
    meter.end()?;
    Ok(candidates)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::combine::grid;
    use crate::lattice::Boundary;
    use crate::parameters::Order;
    use crate::pattern::Pattern;
    use crate::progress::Unobserved;
    use std::sync::Arc;

    fn layout(boundary: Boundary) -> (Domain, Vec<Piece>) {
        let domain = Domain::from_size([72.0, 63.0], 1.0, boundary).unwrap();
        let each = grid(&domain, 2, 2).into_iter().zip(1..);
        let pieces = each.map(|(rect, seed)| {
            let own = Domain::of_rect(&rect, Boundary::Periodic).unwrap();
            let set = Pattern::of_reference(own, seed, &mut Unobserved).unwrap();
            let (set, start) = (Arc::new(set), Point::default());
            Piece { set, rect, start }
        });
        (domain, pieces.collect())
    }

    /// All samples of a result, by position, and how many of them were considered.
    fn kept(glued: &Glued) -> (Vec<Point>, usize) {
        let samples = glued.samples.points.iter().zip(&glued.samples.fates);
        let near = samples.filter(|(_, fate)| **fate == Fate::Kept);
        let near: Vec<Point> = near.map(|(&p, _)| p).collect();
        let looked_at = near.len();
        let deep = glued.deep.iter().flatten().map(|&(p, _)| p);
        let mut all: Vec<Point> = near.into_iter().chain(deep).collect();
        all.sort_unstable_by_key(|p| p.canonical());
        (all, looked_at)
    }

    #[test]
    fn what_is_far_from_seams_is_not_looked_at_and_would_change_nothing() {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            let (domain, pieces) = layout(boundary);
            for order in [Order::OwnBlockFirst, Order::Random] {
                for insertion in [Insertion::Circumcentre, Insertion::Uniform] {
                    let options = CombineOptions {
                        order,
                        insertion,
                        ..CombineOptions::default()
                    };
                    let within = |near: i32| {
                        let made =
                            glue_within(domain, &pieces, &options, near, &mut Unobserved).unwrap();
                        assert!(made.1 <= crate::combine::TOUCHED);
                        kept(&made.0)
                    };
                    let (near, whole) = (within(NEAR), within(i32::MAX));
                    assert_eq!(near.0, whole.0);
                    assert!(near.1 < whole.1);
                }
            }
        }
    }

    /// If a detector needs samples beyond the depth, these samples are added.
    #[test]
    fn too_little_is_widened_until_it_suffices() {
        let (domain, pieces) = layout(Boundary::Bounded);
        let options = CombineOptions::default();
        let from = |near| glue(near, domain, &pieces, &options, &mut Unobserved).unwrap();
        let within = |near| glue_within(domain, &pieces, &options, near, &mut Unobserved).unwrap();
        let whole = kept(&within(i32::MAX).0).0;
        let narrow = 2 * R + R / 4;
        assert_ne!(kept(&within(narrow).0).0, whole);
        assert_eq!(kept(&from(narrow)).0, whole);
    }
}
