//! The engine of exact tiling, written to be read. It lays down the pattern's samples and follows the differences from what
//! the pattern's own darts made of them, in the order of arrival.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use crate::error::SampleError;
use crate::exact::bare::{MARK_SIDE, MarkedCells, PieceCell};
use crate::exact::darts::{Arrival, PlacedDart};
use crate::exact::history::{LATE_LEVEL, PatternHistory};
use crate::exact::pieces::pieces;
use crate::exact::present::{ArrivedSample, PresentSamples};
use crate::lattice::{Domain, Point, R, Rect};
use crate::parameters::Parameters;
use crate::pattern::{PatternVariant, Symmetry};
use crate::progress::{Meter, Observer};
use crate::random::{Key, Stream, below};
use crate::run::{Run, Summary};
use crate::samples::{Sampled, Source};
use crate::stage::Stage;
use crate::stages::blocks::{Block, split};
use crate::stages::darts::LAST_LEVEL;
use crate::stages::tile::clip_start;

/// Returns the exact tiling of a domain with the pattern of `history`.
///
/// The result is conflict-free, and no lattice point of the domain is uncovered. It depends on the domain, the seed, the
/// leaf, dihedral variation and the pattern; the other parameters have no meaning here. Samples of the pattern have their
/// block and their index as source. A dart that became a sample here alone counts as inserted: one of levels 0 and 1 in
/// iteration 1, one of level k in iteration k. Equal parameters give equal results, bit for bit, on every machine.
///
/// ```
/// use tilescope_core::{Parameters, PatternHistory, Unobserved, exact_sample};
///
/// let parameters = Parameters { radius: 0.02, ..Parameters::default() };
/// let history = PatternHistory::of_spec(&parameters.pattern, &mut Unobserved)?;
/// let run = exact_sample(&parameters, &history, &mut Unobserved)?;
/// assert!((1650..1850).contains(&run.summary().count));
/// # Ok::<(), tilescope_core::SampleError>(())
/// ```
pub fn exact_sample(
    parameters: &Parameters,
    history: &PatternHistory,
    observer: &mut dyn Observer,
) -> Result<Run, SampleError> {
    let mut tiling = ExactTiling::new(parameters, history)?;
    tiling.tile(observer)?;

    // The darts of the first levels wait in the history.
    for level in 0..LATE_LEVEL {
        tiling.settle(level, Stage::Eliminate, observer)?;
    }
    // Those of later levels are thrown where something changed.
    tiling.open_borders();
    for level in LATE_LEVEL..=LAST_LEVEL {
        tiling.throw(level);
        tiling.settle(level, Stage::Iterate(level), observer)?;
    }

    let summary = tiling.summary();
    Run::of_result(parameters, history.pattern(), tiling.sampled(), summary)
}

/// A block with its clip.
#[derive(Clone, Copy)]
struct ExactTile {
    rect: Rect,
    symmetry: Symmetry,
    /// The first of its pieces, and the first of the next block.
    first_piece: u32,
    end_piece: u32,
}

/// Something that may be another way than in the pattern, to be decided when its dart arrives.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Arriving {
    dart: PlacedDart,
    what: What,
}

/// What is to be decided.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum What {
    /// Whether an earlier sample covers a present one, given by its id.
    Sample(u32),
    /// Whether no earlier sample covers a dart of the block given by its index.
    Dart(u32),
}

/// An exact tiling in progress.
struct ExactTiling<'a> {
    history: &'a PatternHistory,
    blocks: Vec<Block>,
    dihedral: bool,
    tiles: Vec<ExactTile>,
    present: PresentSamples,
    /// What arrives with each level.
    queues: Vec<Vec<Arriving>>,
    /// What has come up since the level that is being decided began, and belongs to it.
    sudden: BinaryHeap<Reverse<Arriving>>,
    deciding: Option<u32>,
    cells: MarkedCells,
    /// The side of the cells to throw darts into, of the level that is being decided, and these cells.
    side: i32,
    active: Vec<PieceCell>,
    /// Marked cells that have not thrown any.
    fresh: Vec<PieceCell>,
}

impl<'a> ExactTiling<'a> {
    fn new(parameters: &Parameters, history: &'a PatternHistory) -> Result<Self, SampleError> {
        let domain: Domain = parameters.validate_sequential()?;
        let key = Key::from_seed(parameters.seed);
        let expected = domain.area_radii() * crate::parameters::MAXIMAL_DENSITY;
        Ok(Self {
            history,
            blocks: split(&domain, parameters.leaf_units()?, key).leaves,
            dihedral: parameters.dihedral,
            tiles: Vec::new(),
            present: PresentSamples::with_capacity(domain, (1.1 * expected) as usize),
            queues: vec![Vec::new(); LAST_LEVEL as usize + 1],
            sudden: BinaryHeap::new(),
            deciding: None,
            cells: MarkedCells::default(),
            side: R,
            active: Vec::new(),
            fresh: Vec::new(),
        })
    }

    /// Lays down every block's own samples.
    fn tile(&mut self, observer: &mut dyn Observer) -> Result<(), SampleError> {
        let pattern = self.history.pattern();
        let variants: Vec<PatternVariant> = (0..if self.dihedral { 8 } else { 1 })
            .map(|symmetry| pattern.variant(Symmetry(symmetry)))
            .collect();
        let mut meter = Meter::begin(observer, Stage::Tile, self.blocks.len() as u64)?;

        for index in 0..self.blocks.len() {
            let block = self.blocks[index];
            let word = block.key.draw(Stream::Dihedral, 0)[0];
            let symmetry = below(word, variants.len() as u32);
            let variant = &variants[symmetry as usize];
            let start = clip_start(&block, variant)?;

            let first = self.cells.pieces().len() as u32;
            let symmetry = Symmetry(symmetry as u8);
            let held = pattern.domain().rect();
            for piece in pieces(index as u32, &block.rect, start, symmetry, &held) {
                self.cells.add(piece);
            }
            self.tiles.push(ExactTile {
                rect: block.rect,
                symmetry,
                first_piece: first,
                end_piece: self.cells.pieces().len() as u32,
            });
            self.clip(index as u32, start, variant);
            meter.tick()?;
        }
        meter.end()
    }

    /// Lays down the samples of a clip that lie in the block. Those around it are missing from the beginning.
    fn clip(&mut self, block: u32, start: Point, variant: &PatternVariant) {
        let rect = self.tiles[block as usize].rect;
        let (width, height) = (rect.width() + 2 * R, rect.height() + 2 * R);
        variant.clip(start, width, height, |right, up, pattern| {
            let place = Point::new(rect.min.x - R + right, rect.min.y - R + up);
            if !rect.contains(place) {
                self.wake(block, place, pattern);
                return;
            }

            let dart = PlacedDart {
                arrival: self.history.arrival(pattern),
                source: self.history.pattern().samples()[pattern as usize],
                place,
            };
            let id = self.present.add(dart, block, Some(pattern));
            // A sample of another block can cover only what is within r of the border.
            if rect.depth(place) <= R {
                self.await_arrival(dart, What::Sample(id));
            }
        });
    }

    /// Asks the darts again whose first blocker is a pattern's sample that is missing at `place`.
    fn wake(&mut self, block: u32, place: Point, pattern: u32) {
        let history = self.history;
        let ExactTile { rect, symmetry, .. } = self.tiles[block as usize];
        for waiting in history.waiting(pattern) {
            let offset = symmetry.turn(waiting.offset);
            let dart = PlacedDart {
                arrival: waiting.arrival,
                source: waiting.source,
                place: Point::new(place.x + offset.x, place.y + offset.y),
            };
            // Another block has its own darts there.
            if rect.contains(dart.place) {
                self.await_arrival(dart, What::Dart(block));
            }
        }
    }

    /// Notes what is to be decided when its dart arrives.
    fn await_arrival(&mut self, dart: PlacedDart, what: What) {
        let level = dart.arrival.level();
        let arriving = Arriving { dart, what };
        if self.deciding == Some(level) {
            self.sudden.push(Reverse(arriving));
        } else {
            self.queues[level as usize].push(arriving);
        }
    }

    /// Decides what arrives with a level, in order.
    fn settle(
        &mut self,
        level: u32,
        stage: Stage,
        observer: &mut dyn Observer,
    ) -> Result<(), SampleError> {
        // Nearly everything is known when a level begins: to sort it once costs less than a heap of all.
        let mut queue = std::mem::take(&mut self.queues[level as usize]);
        queue.sort_unstable();
        let mut meter = Meter::begin(observer, stage, queue.len() as u64)?;
        self.deciding = Some(level);

        let mut known = queue.into_iter().peekable();
        loop {
            let sudden = self.sudden.peek().map(|Reverse(sudden)| *sudden);
            let is_sudden = sudden.is_some_and(|sudden| known.peek().is_none_or(|k| sudden < *k));
            let next = if is_sudden {
                self.sudden.pop();
                sudden
            } else {
                known.next()
            };
            let Some(next) = next else { break };

            match next.what {
                What::Sample(id) => self.decide_sample(id),
                What::Dart(block) => self.decide_dart(next.dart, block),
            }
            meter.tick()?;
        }
        meter.end()
    }

    /// Loses a sample if an earlier one covers it. Everything earlier is final.
    fn decide_sample(&mut self, id: u32) {
        let sample = *self.present.get(id);
        let (Some(pattern), false) = (sample.pattern, sample.is_lost) else {
            return;
        };
        if !self.present.precedes(&sample.dart) {
            return;
        }

        self.present.lose(id);
        self.wake(sample.block, sample.dart.place, pattern);
        let tile = &self.tiles[sample.block as usize];
        let pieces = tile.first_piece..tile.end_piece;
        let place = sample.dart.place;
        self.cells.mark_disk(pieces, place, &mut self.fresh);
        let level = sample.dart.arrival.level();
        if level >= LATE_LEVEL {
            // What the cells threw before would have been refused by others.
            self.throw_fresh(level, Some(&sample.dart));
        }
    }

    /// Makes a dart a sample if it is none, and no earlier one covers it.
    fn decide_dart(&mut self, dart: PlacedDart, block: u32) {
        if self.present.refuses(&dart) {
            return;
        }
        let mut later = Vec::new();
        self.present.later(&dart, |id| later.push(id));
        for id in later {
            self.await_arrival(self.present.get(id).dart, What::Sample(id));
        }
        self.present.add(dart, block, None);
    }

    /// Marks the cells whose darts may lack a first blocker beyond the border of their block.
    fn open_borders(&mut self) {
        for index in 0..self.cells.pieces().len() as u32 {
            let block = self.cells.pieces()[index as usize].block;
            let rect = self.tiles[block as usize].rect;
            self.cells.mark_border(index, &rect, &mut self.fresh);
        }
    }

    /// Throws the darts of a level into all active cells.
    fn throw(&mut self, level: u32) {
        let end = Arrival::new(level, 0, 0);
        let decided = self.present.before(end);
        let (side, before) = (R >> level, self.side);
        let (mut active, mut near) = (Vec::with_capacity(self.active.len()), Vec::new());
        for &cell in &self.active {
            self.cells
                .cut(cell, before, side, decided, &mut near, &mut active);
        }
        self.active = active;
        self.side = side;

        for index in 0..self.active.len() {
            self.throw_into(self.active[index], level, None);
        }
        self.throw_fresh(level, None);
    }

    /// Throws the darts of a level into cells that were marked, those later than `after`.
    fn throw_fresh(&mut self, level: u32, after: Option<&PlacedDart>) {
        let decided = self.present.before(Arrival::new(level, 0, 0));
        let (first, mut near) = (self.active.len(), Vec::new());
        for cell in self.fresh.drain(..) {
            let (side, active) = (R >> level, &mut self.active);
            self.cells
                .cut(cell, MARK_SIDE, side, decided, &mut near, active);
        }
        for index in first..self.active.len() {
            self.throw_into(self.active[index], level, after);
        }
    }

    /// Throws the darts of a level into a cell, those later than `after`.
    fn throw_into(&mut self, cell: PieceCell, level: u32, after: Option<&PlacedDart>) {
        let history = self.history;
        let piece = self.cells.pieces()[cell.piece as usize];
        for (arrival, source) in history.darts().of_cell(level, cell.min) {
            if !piece.sources.contains(source) {
                continue;
            }
            let dart = PlacedDart {
                arrival,
                source,
                place: piece.place(source),
            };
            let is_later = after.is_none_or(|after| dart > *after);
            let decided = self.present.before(Arrival::new(level, 0, 0));
            if is_later && !decided.covers(dart.place) {
                self.await_arrival(dart, What::Dart(piece.block));
            }
        }
    }

    fn summary(&self) -> Summary {
        let samples = self.present.samples();
        let tiled = samples.iter().filter(|sample| sample.pattern.is_some());
        let tiled = tiled.count();
        let eliminated = samples.iter().filter(|sample| sample.is_lost).count();
        let mut inserted = vec![0; LAST_LEVEL as usize];
        for sample in samples.iter().filter(|sample| sample.pattern.is_none()) {
            inserted[iteration(sample) as usize - 1] += 1;
        }
        while inserted.last() == Some(&0) {
            inserted.pop();
        }

        Summary {
            blocks: self.blocks.len(),
            tiled,
            dropped: 0,
            eliminated,
            inserted,
            count: samples.len() - eliminated,
        }
    }

    /// Returns the samples in canonical order, with their sources.
    fn sampled(&self) -> Sampled {
        let samples = self.present.samples().iter();
        let mut kept: Vec<_> = samples.filter(|sample| !sample.is_lost).collect();
        kept.sort_unstable_by_key(|sample| sample.dart.place.canonical());
        let sources = kept.iter().map(|sample| match sample.pattern {
            Some(pattern) => Source::Tiled {
                block: sample.block,
                pattern,
            },
            None => Source::Inserted {
                iteration: iteration(sample),
            },
        });
        Sampled {
            sources: Some(sources.collect()),
            points: kept.iter().map(|sample| sample.dart.place).collect(),
        }
    }
}

/// Returns the iteration in which a sample counts as inserted.
fn iteration(sample: &ArrivedSample) -> u32 {
    sample.dart.arrival.level().max(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::PatternSpec;
    use crate::progress::Unobserved;

    fn parameters(side: f64) -> Parameters {
        Parameters {
            width: side,
            height: side,
            radius: 1.0,
            leaf: 8.0,
            pattern: PatternSpec {
                side: 20.0,
                ..PatternSpec::default()
            },
            ..Parameters::default()
        }
    }

    /// The control of the comparison with the definition: without what waits behind missing samples the set is another, if
    /// one without conflicts and bare places.
    #[test]
    fn a_missing_wake_is_noticed() {
        let parameters = parameters(30.0);
        let whole = PatternHistory::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
        let unwoken = whole.without_waiting();
        let [points, other] = [&whole, &unwoken].map(|history| {
            let run = exact_sample(&parameters, history, &mut Unobserved).unwrap();
            run.points()
        });
        assert!(points.len() > 500 && points != other);
    }

    #[test]
    fn whoever_observes_may_stop_it() {
        let parameters = parameters(60.0);
        let history = PatternHistory::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
        for stopped in [Stage::Tile, Stage::Eliminate, Stage::Iterate(3)] {
            let mut stop = |progress: crate::progress::Progress| {
                if progress.stage == stopped {
                    std::ops::ControlFlow::Break(())
                } else {
                    std::ops::ControlFlow::Continue(())
                }
            };
            let outcome = exact_sample(&parameters, &history, &mut stop);
            assert_eq!(
                outcome.err(),
                Some(SampleError::Cancelled { stage: stopped })
            );
        }
    }
}
