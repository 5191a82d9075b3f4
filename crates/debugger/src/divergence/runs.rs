//! The first stage at which two runs differ, by the data of the runs: blocks, samples with their fates, detectors,
//! candidates and the result. Needs no events. Functions that look for a difference return `None` where there is none.

use tilescope_core::stages::detect::{Candidate, Sites};
use tilescope_core::{Fate, Origin, Point, Run, Stage, Variant};

use super::{Divergence, domains};
use crate::sentence::{count, sample_name};

/// Returns the first stage at which two runs differ.
///
/// If a run keeps only its result, only pattern, blocks and result are compared. Lists that an engine never fills
/// (detectors, candidates, cells) and sites that it did not record are not compared.
#[must_use]
pub fn first_divergence_of_runs(a: &Run, b: &Run) -> Divergence {
    if let Some(different) = domains(&a.domain, &b.domain) {
        return different;
    }

    let pair = Pair { a, b };
    let found = pair.patterns().or_else(|| pair.blocks());

    // A run with counts alone has no samples but those of its result.
    let whole = a.counted.is_none() && b.counted.is_none();
    let found = found.or_else(|| whole.then(|| pair.stages()).flatten());
    found.or_else(|| pair.results()).unwrap_or(Divergence::Same)
}

struct Pair<'a> {
    a: &'a Run,
    b: &'a Run,
}

/// The sort key of lists that are compared: row, column and one more number.
type Key = (i32, i32, u32);

fn keyed(point: Point, number: u32) -> Key {
    let (row, column) = point.row_major();
    (row, column, number)
}

/// Writes a point in units, since points may differ by a single unit.
fn units(point: Point) -> String {
    format!("({}, {}) units", point.x, point.y)
}

/// Returns the difference of a stage, at a point if it has one; `a` and `b` describe what the runs have there.
fn differ(stage: Stage, point: Option<Point>, a: String, b: String) -> Divergence {
    Divergence::Stage { stage, point, a, b }
}

/// Returns the lowest key that only one of two sorted lists has, and whether it is the first one.
fn first_alone(a: &[Key], b: &[Key]) -> Option<(Key, bool)> {
    let same = a.iter().zip(b).take_while(|(x, y)| x == y).count();
    match (a.get(same), b.get(same)) {
        (None, None) => None,
        (Some(&x), Some(&y)) if y < x => Some((y, false)),
        (Some(&x), _) => Some((x, true)),
        (None, Some(&y)) => Some((y, false)),
    }
}

/// Returns the first difference of two sorted lists.
fn lists(stage: Stage, noun: &str, a: &[Key], b: &[Key]) -> Option<Divergence> {
    let ((y, x, _), of_a) = first_alone(a, b)?;

    let point = Point::new(x, y);
    let there = format!("{noun} at {}", units(point));
    let nothing = format!("no such {noun} there");

    let (a, b) = if of_a {
        (there, nothing)
    } else {
        (nothing, there)
    };
    Some(differ(stage, Some(point), a, b))
}

impl Pair<'_> {
    /// Returns the difference of the patterns, which is at no place.
    fn patterns(&self) -> Option<Divergence> {
        let text = |run: &Run| {
            let samples = count(run.pattern.samples().len() as u64, "sample");
            let domain = run.pattern.domain();
            format!(
                "a pattern of {samples}, {} by {} units",
                domain.width(),
                domain.height()
            )
        };
        let differs = self.a.pattern != self.b.pattern;
        let nowhere = None;
        differs.then(|| differ(Stage::Pattern, nowhere, text(self.a), text(self.b)))
    }

    /// Returns the first difference of the blocks.
    fn blocks(&self) -> Option<Divergence> {
        let (a, b) = (&self.a.blocks, &self.b.blocks);
        let splits = a.splits.iter().zip(&b.splits);
        if let Some((x, y)) = splits.clone().find(|(x, y)| x != y) {
            // The splits before are equal, so that these two cut the same node.
            let text = |plane| format!("a node cut at {plane} units");
            let point = Some(x.rect.min);
            return Some(differ(Stage::Blocks, point, text(x.plane), text(y.plane)));
        }

        let leaves = a.leaves.iter().zip(&b.leaves);
        if let Some((x, y)) = leaves.clone().find(|(x, y)| x != y) {
            // Blocks may also differ by the keys of their draws alone. They then have one corner, which is named twice.
            let text = |point| format!("a block from {}", units(point));
            let (low, other) = (x.rect.min, y.rect.min);
            return Some(differ(Stage::Blocks, Some(low), text(low), text(other)));
        }

        // Lists that agree as far as the shorter one reaches differ by their lengths alone. There is one split fewer
        // than there are leaves, so that the leaves decide for both lists.
        let text = |blocks: usize| count(blocks as u64, "block");
        let (m, n) = (a.leaves.len(), b.leaves.len());
        let nowhere = None;
        (m != n).then(|| differ(Stage::Blocks, nowhere, text(m), text(n)))
    }

    /// Returns the first difference of the stages between the blocks and the result: tiling, elimination and the
    /// iterations.
    fn stages(&self) -> Option<Divergence> {
        let (a, b) = (tiled(self.a), tiled(self.b));
        let keys = |tiled: &[(Key, u32)]| tiled.iter().map(|&(key, _)| key).collect::<Vec<_>>();

        let tiling = self
            .tiles()
            .or_else(|| lists(Stage::Tile, "tiled sample", &keys(&a), &keys(&b)));

        // Without a difference so far, the lists have the same points at the same indices.
        let found = tiling
            .or_else(|| self.fates(Stage::Tile, &a, &b))
            .or_else(|| self.fates(Stage::Eliminate, &a, &b));

        // One run may go on after the other has ended.
        let last = self.a.iterations.len().max(self.b.iterations.len());
        found.or_else(|| (0..last).find_map(|k| self.iteration(k)))
    }

    /// Returns the difference of the first block to which the two runs give different clips. The samples in the clips
    /// are compared afterwards, by their places.
    fn tiles(&self) -> Option<Divergence> {
        let mut pairs = self
            .a
            .tiles
            .iter()
            .zip(&self.b.tiles)
            .zip(&self.a.blocks.leaves);
        let different = pairs.find(|((x, y), _)| (x.start, x.symmetry) != (y.start, y.symmetry));
        let ((x, y), block) = different?;

        let text = |tile: &tilescope_core::stages::tile::Tile| {
            format!(
                "a clip from {} under symmetry {}",
                units(tile.start),
                tile.symmetry.0
            )
        };
        Some(differ(Stage::Tile, Some(block.rect.min), text(x), text(y)))
    }

    /// Returns the first difference of the fates after a stage: after tiling, in which samples were dropped; after elimination,
    /// in any fate. `a` and `b` are the tiled samples of the runs with their ids, and have the same points in the same order.
    fn fates(&self, stage: Stage, a: &[(Key, u32)], b: &[(Key, u32)]) -> Option<Divergence> {
        // The fate in words and, of an eliminated sample, the point of the one that eliminated it.
        let fate = |run: &Run, id: u32| match run.samples.fates[id as usize] {
            Fate::Eliminated { by } => ("eliminated", run.samples.points.get(by as usize).copied()),
            Fate::Dropped => ("dropped", None),
            Fate::Kept => ("kept", None),
            Fate::Undecided => ("undecided", None),
        };

        let dropped = |(name, _): &(&str, _)| *name == "dropped";
        a.iter().zip(b).find_map(|(&(key, id_a), &(_, id_b))| {
            let (of_a, of_b) = (fate(self.a, id_a), fate(self.b, id_b));
            // Tiling decides only which samples lie outside the domain and are dropped.
            let same = match stage {
                Stage::Tile => dropped(&of_a) == dropped(&of_b),
                _ => of_a == of_b,
            };

            let text = |run: &Run, id: u32, (name, by): (&str, Option<Point>)| {
                let by =
                    by.map_or_else(String::new, |by| format!(" by the sample at {}", units(by)));
                format!("{} is {name}{by}", sample_name(run, id))
            };

            // A key has the row first, which is y.
            let point = Some(Point::new(key.1, key.0));
            (!same).then(|| {
                differ(
                    stage,
                    point,
                    text(self.a, id_a, of_a),
                    text(self.b, id_b, of_b),
                )
            })
        })
    }

    /// Returns the first difference of an iteration, counted from 0.
    fn iteration(&self, k: usize) -> Option<Divergence> {
        let number = k as u32 + 1;
        // Algorithm 4 as printed makes iteration 1 in its first loop, together with elimination. If the
        // runs have different variants, the stage is that of the first run.
        let stage = match self.a.parameters.variant {
            Variant::AsPrinted if number == 1 => Stage::Eliminate,
            _ => Stage::Iterate(number),
        };

        let compare = |noun: &str, of: fn(&Run, usize) -> Vec<Key>| {
            // A list that is empty in all iterations is one that the engine does not fill.
            let keeps = |run: &Run| (0..run.iterations.len()).any(|each| !of(run, each).is_empty());
            let (a, b) = (of(self.a, k), of(self.b, k));
            let both = keeps(self.a) && keeps(self.b);
            both.then(|| lists(stage, noun, &a, &b)).flatten()
        };

        // In the order in which an iteration makes them, so that the first cause is named.
        let found = compare("detector", detectors)
            .or_else(|| compare("active cell", cells))
            .or_else(|| compare("candidate", candidates))
            .or_else(|| self.sites(stage, k));

        // Every engine fills the list of inserted samples.
        let (a, b) = (inserted(self.a, k), inserted(self.b, k));
        found.or_else(|| lists(stage, "inserted sample", &a, &b))
    }

    /// Returns the first difference of the candidates' sites in iteration `k`, counted from 0. The candidates' points
    /// are equal, unless the engine of a run lists no candidates: then there is no difference of their sites.
    fn sites(&self, stage: Stage, k: usize) -> Option<Divergence> {
        let in_order = |run: &Run| {
            let mut all = run
                .iterations
                .get(k)
                .map_or_else(Vec::new, |i| i.candidates.clone());
            // An iteration has at most one candidate at each point, and the points are the same in both runs. Their
            // order therefore pairs the candidates.
            all.sort_unstable_by_key(|c| c.point.row_major());
            all
        };

        let (a, b) = (in_order(self.a), in_order(self.b));
        a.iter().zip(&b).find_map(|(one, other)| {
            // A sample may have different ids in the two runs, so that the points of the sites are compared. Sites
            // that one of the engines did not record are not compared.
            let (of_a, of_b) = (
                points_of_sites(self.a, one)?,
                points_of_sites(self.b, other)?,
            );

            let text = |sites: &[Key]| {
                // A key has the row first, which is y.
                let points = sites.iter().map(|&(y, x, _)| units(Point::new(x, y)));
                format!(
                    "a candidate made by samples at {}",
                    points.collect::<Vec<_>>().join(", ")
                )
            };
            let differs = of_a != of_b;
            differs.then(|| differ(stage, Some(one.point), text(&of_a), text(&of_b)))
        })
    }

    /// Returns the first difference of the results: a sample that only one has, or the first place in their order that
    /// differs.
    fn results(&self) -> Option<Divergence> {
        let (a, b) = (self.a.points(), self.b.points());
        let keys = |points: &[Point]| sorted(points.iter().map(|&point| keyed(point, 0)).collect());
        let found = lists(Stage::Finish, "sample of the result", &keys(&a), &keys(&b));

        // The same samples in another order are not the same result: the order is canonical.
        found.or_else(|| {
            let (x, y) = a.iter().zip(&b).find(|(x, y)| x != y)?;
            let text = |point: &Point| format!("the sample at {} comes first", units(*point));
            Some(differ(Stage::Finish, Some(*x), text(x), text(y)))
        })
    }
}

fn sorted(mut keys: Vec<Key>) -> Vec<Key> {
    keys.sort_unstable();
    keys
}

/// Returns the tiled samples by position and block, with their ids.
fn tiled(run: &Run) -> Vec<(Key, u32)> {
    let samples = run.samples.points.iter().zip(&run.samples.origins).zip(0..);
    let mut all: Vec<(Key, u32)> = samples
        .filter_map(|((&point, origin), id)| match *origin {
            Origin::Tiled { block, .. } => Some((keyed(point, block), id)),
            Origin::Inserted { .. } => None,
        })
        .collect();
    all.sort_unstable();
    all
}

/// Returns the positions of ids. Unknown ids are skipped.
fn points(run: &Run, ids: impl Iterator<Item = u32>) -> Vec<Key> {
    let points = &run.samples.points;
    let found = ids.filter_map(|id| points.get(id as usize));
    sorted(found.map(|&point| keyed(point, 0)).collect())
}

fn detectors(run: &Run, k: usize) -> Vec<Key> {
    let iteration = run.iterations.get(k);
    iteration.map_or_else(Vec::new, |i| points(run, i.detectors.iter().copied()))
}

fn inserted(run: &Run, k: usize) -> Vec<Key> {
    let iteration = run.iterations.get(k);
    iteration.map_or_else(Vec::new, |i| points(run, i.inserted.clone()))
}

/// Returns the keys of the active cells of the iteration at `k`; none if the run has no such iteration.
fn cells(run: &Run, k: usize) -> Vec<Key> {
    let cells = run.iterations.get(k).map_or(&[][..], |i| &i.cells);
    let keys = cells
        .iter()
        .map(|cell| keyed(cell.min, cell.side.unsigned_abs()));
    sorted(keys.collect())
}

fn candidates(run: &Run, k: usize) -> Vec<Key> {
    let candidates = run.iterations.get(k).map_or(&[][..], |i| &i.candidates);
    sorted(candidates.iter().map(|c| keyed(c.point, 0)).collect())
}

/// Returns the positions of the samples that made a candidate, or `None` if they were not recorded.
fn points_of_sites(run: &Run, candidate: &Candidate) -> Option<Vec<Key>> {
    let sites = &candidate.sites;
    (*sites != Sites::Unrecorded).then(|| points(run, sites.ids().iter().copied()))
}
