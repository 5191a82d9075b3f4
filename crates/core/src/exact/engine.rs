//! The engine of exact tiling, written to be read. It lays down the pattern's samples and follows the differences from
//! what the pattern's own darts made of them, in the order of arrival.
//!
//! It works on a whole domain, and can be recorded. [`super::seams`] makes the same samples window by window, in a
//! fraction of the time.
//!
//! The *ground* is the part of the plane that is worked on, here the whole domain. A *tile* is the part of a block on the
//! ground, and a *piece* the part of a tile that one copy of the pattern fills. The *first blocker* of a dart is the
//! earliest sample of the pattern that covers it. *Late* darts are those of [`LATE_LEVEL`] and after.

pub(super) mod recorded;

use glam::I64Vec2;

use self::recorded::KeptLevels;

use crate::engine::parallel::claim::tiled_tag;
use crate::engine::parallel::clip::{Clipper, PlacedBlock};
use crate::engine::parallel::counts::WindowCounts;
use crate::engine::parallel::gaps::inserted_tag;
use crate::engine::parallel::sweep::sampled;
use crate::engine::parallel::window_maker::WindowSamples;
use crate::error::SampleError;
use crate::exact::agenda::{Agenda, What};
use crate::exact::bare::{MARK_SIDE, MarkedCells, PieceCell};
use crate::exact::darts::{Arrival, PlacedDart};
use crate::exact::filter::SampleFilter;
use crate::exact::ground::Ground;
use crate::exact::history::{LATE_LEVEL, PatternHistory};
use crate::exact::pieces::pieces;
use crate::exact::present::{ArrivedSample, PresentSamples};
use crate::lattice::{Point, R, Rect, Rect64};
use crate::parameters::Parameters;
use crate::pattern::{Pattern, Symmetry};
use crate::progress::{Meter, Observer};
use crate::random::Key;
use crate::record::{Recorder, RunEvent, Unrecorded};
use crate::run::Run;
use crate::stage::Stage;
use crate::stages::darts::LAST_LEVEL;
use crate::varying::Shape;

/// Returns the exact tiling of a domain with the pattern of `history`.
///
/// The result is conflict-free, and no lattice point of the domain is uncovered. It depends on the domain, the seed, the
/// leaf, dihedral variation and the pattern; the other parameters have no meaning here. Samples of the pattern have their
/// block and their index as source. A dart that became a sample here and not in the pattern counts as inserted: one of levels
/// 0 and 1 in iteration 1, one of level k in iteration k. Equal parameters give equal results, bit for bit, on every machine.
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
    exact_in_shape(parameters, history, &Shape::rectangle(), observer)
}

/// Returns the exact tiling of a shape in a domain: darts outside of the shape do not exist.
///
/// The result is conflict-free and inside the shape, and no lattice point of the shape is uncovered. A sample of the pattern
/// outside of the shape is missing as one that is lost, and counts as neither tiled nor eliminated. The rest is as
/// [`exact_sample`] has it, whose result this is for the shape of all places.
pub fn exact_in_shape(
    parameters: &Parameters,
    history: &PatternHistory,
    shape: &Shape,
    observer: &mut dyn Observer,
) -> Result<Run, SampleError> {
    let domain = parameters.validate_sequential()?;
    let mut run_clipper = clipper(parameters, history.pattern())?;
    // Sources name blocks by their indices, which blocks have only once they are counted.
    run_clipper.count_blocks();

    let mut tiling = ExactTiling::new(history, shape);
    let ground = Ground::whole(&domain);
    tiling.run(&run_clipper, ground, observer, &mut Unrecorded)?;

    let mut samples = WindowSamples::default();
    let with_sources = true;
    tiling.emit(with_sources, &mut samples);

    let summary = samples.counts.summary(samples.points.len() as u64);
    let result = sampled(samples.points, samples.tags, with_sources);
    // The run states the defaults of the parameters that have no meaning here.
    Run::of_result(&parameters.as_exact(), history.pattern(), result, summary)
}

/// Returns the clipper of a run, which finds its blocks and the samples that they clip.
pub(crate) fn clipper(parameters: &Parameters, pattern: &Pattern) -> Result<Clipper, SampleError> {
    let domain = parameters.validate()?;
    let key = Key::from_seed(parameters.seed);
    let leaf = parameters.leaf_units()?;
    Ok(Clipper::new(
        domain,
        leaf,
        key,
        pattern,
        parameters.dihedral,
    ))
}

/// Returns the iteration in which a dart counts as inserted.
pub(super) fn iteration_of(arrival: Arrival) -> u32 {
    arrival.level().max(1)
}

/// A part of a block on the ground.
#[derive(Clone, Copy)]
struct ExactTile {
    /// The index of the block.
    block: u32,
    /// Where the ground has it.
    rect: Rect,
    symmetry: Symmetry,
    /// The first of its pieces, and the first of the next tile.
    first_piece: u32,
    end_piece: u32,
    /// The pattern's samples that are lost here.
    missing: SampleFilter,
}

/// An exact tiling in progress. Its buffers can be used again.
pub(crate) struct ExactTiling<'a> {
    history: &'a PatternHistory,
    /// The places that darts can lie at.
    shape: &'a Shape,
    blocks: Vec<PlacedBlock>,
    tiles: Vec<ExactTile>,
    present: PresentSamples<'a>,
    agenda: Agenda,
    cells: MarkedCells,
    /// Marked cells that have not thrown any darts.
    fresh: Vec<PieceCell>,
    /// The side of the cells to throw darts into, of the level that is being decided, and these cells.
    side: i32,
    open: Vec<PieceCell>,
    /// Of a recorded tiling, what it keeps of each level.
    kept: KeptLevels,
}

impl<'a> ExactTiling<'a> {
    /// Returns buffers for tilings of a shape with a pattern.
    pub(crate) fn new(history: &'a PatternHistory, shape: &'a Shape) -> Self {
        Self {
            history,
            shape,
            blocks: Vec::new(),
            tiles: Vec::new(),
            present: PresentSamples::new(history),
            agenda: Agenda::default(),
            cells: MarkedCells::default(),
            fresh: Vec::new(),
            side: R,
            open: Vec::new(),
            kept: KeptLevels::default(),
        }
    }

    /// Makes the samples of a ground.
    pub(crate) fn run<T: Recorder>(
        &mut self,
        clipper: &Clipper,
        ground: Ground,
        observer: &mut dyn Observer,
        recorder: &mut T,
    ) -> Result<(), SampleError> {
        clipper.blocks(&ground.frame, &mut self.blocks)?;
        self.present.reset(ground);
        self.agenda.clear();
        self.tile(clipper, observer, recorder)?;

        // The darts of the first levels are not thrown here: the history has them, each under its first blocker. Those
        // whose blocker is missing are woken, as questions on the agenda.
        self.begin(1, recorder);
        for level in 0..LATE_LEVEL {
            self.settle(level, Stage::Iterate(1), observer, recorder)?;
        }

        // The darts of later levels are thrown where something changed.
        self.open_borders::<T>();
        for level in LATE_LEVEL..=LAST_LEVEL {
            // In a recording the cuts for a level belong to the iteration before it.
            self.cut(level, recorder);
            self.end(recorder);
            // Nothing is left to do: no cell throws, and no question waits for this level or a later one.
            if self.open.is_empty() && self.agenda.is_empty_from(level) {
                return Ok(());
            }

            self.begin(level, recorder);
            let (first_cell, after) = (0, None);
            self.throw(first_cell, level, after, recorder);
            self.settle(level, Stage::Iterate(level), observer, recorder)?;
        }
        self.end(recorder);
        Ok(())
    }

    /// Lays down every block's own samples.
    fn tile<T: Recorder>(
        &mut self,
        clipper: &Clipper,
        observer: &mut dyn Observer,
        recorder: &mut T,
    ) -> Result<(), SampleError> {
        recorder.record(RunEvent::Begin(Stage::Tile));
        self.tiles.clear();
        self.cells.clear();
        self.fresh.clear();
        self.open.clear();
        self.side = R;

        // The list is taken out of the tiling, which changes meanwhile.
        let blocks = std::mem::take(&mut self.blocks);
        let all = self.present.ground().rect();
        let mut meter = Meter::begin(observer, Stage::Tile, blocks.len() as u64)?;

        for block in &blocks {
            // Some blocks reach onto the ground with their margins alone.
            if let Some(rect) = block.rect.within(&all) {
                recorder.record(RunEvent::Clip { block: block.index });
                self.add_tile(block, rect);
                self.clip(clipper, block, recorder);
            }
            meter.tick()?;
        }

        self.blocks = blocks;
        meter.end()
    }

    /// Adds the tile of the part of a block that lies on the ground.
    fn add_tile(&mut self, block: &PlacedBlock, rect: Rect) {
        let (tile, first_piece) = (self.tiles.len() as u32, self.cells.pieces().len() as u32);
        let symmetry = Symmetry(block.symmetry);
        let moved = self.present.ground().moved(block);
        self.present.add_tile(moved);

        // `block.start` is where the turned pattern has the lowest corner of the block enlarged by r. `start` is where
        // it has that of `rect` enlarged by r.
        let start = I64Vec2::from(block.start) + I64Vec2::from(rect.min) - block.rect.min;
        let pattern_rect = self.history.pattern().domain().rect();
        let in_domain = self.present.rect_in_domain(tile, &rect);
        for piece in pieces(tile, &in_domain, start, symmetry, &pattern_rect) {
            self.cells.add(piece);
        }

        self.tiles.push(ExactTile {
            block: block.index,
            rect,
            symmetry,
            first_piece,
            end_piece: self.cells.pieces().len() as u32,
            missing: SampleFilter::default(),
        });
    }

    /// Lays down the samples of a clip that lie in the last tile. Those around the tile count as lost from the beginning: the
    /// darts that they refused are woken.
    fn clip<T: Recorder>(&mut self, clipper: &Clipper, block: &PlacedBlock, recorder: &mut T) {
        let tile = self.tiles.len() as u32 - 1;
        let rect = self.tiles[tile as usize].rect;

        // A sample at most r outside may be the first blocker of darts inside.
        let reach = i64::from(R);
        let around = Rect64::from(rect).grown(reach, reach);
        let ground = self.present.ground().rect();
        let target = Rect {
            min: Point::new(ground.min.x - R, ground.min.y - R),
            max: Point::new(ground.max.x + R, ground.max.y + R),
        };

        clipper.clip(block, &around, &target, |x, y, pattern| {
            let place = Point::new(x, y);
            if !rect.contains(place) {
                let no_id = u32::MAX;
                self.wake(tile, place, pattern, no_id, recorder);
                return;
            }

            // Outside of the shape there are no darts: the sample is missing, as one that is lost.
            if !self.shape.inside(self.present.in_domain(tile, place)) {
                let no_id = u32::MAX;
                self.release(tile, place, pattern, no_id, recorder);
                return;
            }

            let id = self.present.add(place, tile, pattern);
            recorder.record(RunEvent::Tiled {
                sample: id,
                block: block.index,
                // A tile has no place outside of the domain.
                inside: true,
            });
            // Samples of other blocks cover only places within r of the border. A sample deeper than r is decided about
            // only if a dart that becomes a sample covers it (`decide_dart`). The others are decided about when they
            // arrive, and in a recording all are.
            if T::ENABLED || rect.depth(place) <= R {
                let dart = self.present.dart(self.present.get(id));
                self.agenda.add(dart, What::Sample(id));
            }
        });
    }

    /// Puts on the agenda the darts whose first blocker is missing: the sample with the index `pattern` in the pattern, at
    /// `place` of the ground. `behind` is the blocker's id, or the largest number if it was not laid down.
    fn wake<T: Recorder>(
        &mut self,
        tile: u32,
        place: Point,
        pattern: u32,
        behind: u32,
        recorder: &mut T,
    ) {
        let history = self.history;
        let ExactTile { rect, symmetry, .. } = self.tiles[tile as usize];

        // Only darts in the tile are visited: outside of it another block has darts of its own. A dart comes with its
        // second blocker, too, which is not needed: whether another sample covers the dart is decided in its turn.
        history.each_waiting_in(&rect, pattern, place, symmetry, |mut dart, _| {
            dart.place = self.present.in_domain(tile, dart.place);
            // Outside of the shape there are no darts.
            if !self.shape.inside(dart.place) {
                return;
            }

            self.agenda.add(dart, What::Dart(tile));
            recorder.record(RunEvent::Wake {
                point: dart.place,
                behind,
            });
        });
    }

    /// Decides what arrives with a level, in order.
    fn settle<T: Recorder>(
        &mut self,
        level: u32,
        stage: Stage,
        observer: &mut dyn Observer,
        recorder: &mut T,
    ) -> Result<(), SampleError> {
        // The meter's total is the number of questions known when the level begins; decisions may add more.
        let known = self.agenda.begin(level);
        let mut meter = Meter::begin(observer, stage, known as u64)?;

        while let Some(next) = self.agenda.next() {
            // A question may be asked twice, which changes nothing. A recording has it once: equal questions follow each
            // other in the order of arrival, so that each is compared with the one before it.
            let is_repeated = T::ENABLED && self.kept.last.replace(next) == Some(next);
            if !is_repeated {
                match next.what {
                    What::Sample(id) => self.decide_sample(id, &next.dart, recorder),
                    What::Dart(tile) => self.decide_dart(&next.dart, tile, recorder),
                }
            }
            meter.tick()?;
        }
        meter.end()
    }

    /// Loses a sample if an earlier one covers it. Everything earlier is final.
    fn decide_sample<T: Recorder>(&mut self, id: u32, dart: &PlacedDart, recorder: &mut T) {
        let sample = *self.present.get(id);
        // A dart that became a sample here was decided when it arrived, and a lost sample stays so.
        let (Some(pattern), false) = (sample.pattern(), sample.is_lost) else {
            return;
        };

        if !self.present.is_covered(dart, sample.tile) {
            // More than r inside its tile, no sample of another block could cover it: it was never contested, and is
            // recorded with the rest of the samples that stay.
            let rest = T::ENABLED && self.tiles[sample.tile as usize].rect.depth(sample.place) > R;
            recorder.record(RunEvent::Keep { sample: id, rest });
            return;
        }

        if T::ENABLED {
            let by = self.blocker(dart, sample.tile);
            self.kept.losses.push([id, by]);
            recorder.record(RunEvent::Eliminate { sample: id, by });
        }
        self.present.lose(id);
        self.release(sample.tile, sample.place, pattern, id, recorder);

        let level = dart.arrival.level();
        if level >= LATE_LEVEL {
            // The cells that the lost sample leaves bare are opened. Their darts that are earlier than that sample were
            // refused by other samples, and need not be thrown.
            let first = self.open.len();
            self.cut_fresh(level, recorder);
            self.throw(first, level, Some(dart), recorder);
        }
    }

    /// Has the darts decided again that a missing sample refused: the one with the index `pattern` in the pattern, at `place` of
    /// the ground. It is lost, or lies outside of the shape, where no sample is laid down and `id` is the largest number.
    fn release<T: Recorder>(
        &mut self,
        tile: u32,
        place: Point,
        pattern: u32,
        id: u32,
        recorder: &mut T,
    ) {
        self.tiles[tile as usize].missing.add(pattern);
        self.wake(tile, place, pattern, id, recorder);

        // Its disk may be bare. Cells are marked in its own block alone: in other blocks its disk reaches only cells within r of
        // the border, and all of those are marked.
        let in_domain = self.present.in_domain(tile, place);
        let held = &self.tiles[tile as usize];
        for piece in held.first_piece..held.end_piece {
            // No cell is left out here: those that a sample covers are dropped when they are cut.
            let is_closed = |_, _| false;
            self.cells
                .mark_disk(piece, in_domain, is_closed, &mut self.fresh);
        }
    }

    /// Makes a dart a sample, unless it is one or an earlier sample covers it.
    fn decide_dart<T: Recorder>(&mut self, dart: &PlacedDart, tile: u32, recorder: &mut T) {
        // The dart of a present sample does not become a second sample.
        if self.present.has(dart, tile) {
            return;
        }

        let is_covered = self.present.is_covered(dart, tile);
        if T::ENABLED {
            recorder.record(RunEvent::Dart {
                point: dart.place,
                z: 0,
                // Its turn in the order of arrival has come.
                ranked: true,
                verdict: self.verdict(dart, tile, is_covered),
            });
        }

        if is_covered {
            return;
        }

        // Samples laid down that arrive later may be covered by it: they are decided again when their turn comes.
        let mut later = Vec::new();
        self.present.later(dart, tile, &mut later);
        for id in later {
            let sample = self.present.dart(self.present.get(id));
            self.agenda.add(sample, What::Sample(id));
        }

        let id = self.present.insert(*dart, tile);
        recorder.record(RunEvent::Insert {
            sample: id,
            iteration: iteration_of(dart.arrival),
        });
    }

    /// Marks the cells whose darts may lack a first blocker beyond the border of their tile.
    fn open_borders<T: Recorder>(&mut self) {
        let history = self.history;
        for (tile, held) in (0..).zip(&self.tiles) {
            let rect = self.present.rect_in_domain(tile, &held.rect);
            for piece in held.first_piece..held.end_piece {
                // A cell is closed if a sample of the pattern that also lies in this tile covers all of it: no dart of
                // the cell can become a sample. Three of four cells are. A recording cuts all, and so shows why they
                // are closed. `inside` has the places of the pattern up to r around the piece that lie in the tile:
                // samples beyond cover no place of the piece, or are of another block.
                let inside = self.cells.pieces()[piece as usize].sources_around(&rect, R);
                let is_closed = |column: i32, row: i32| {
                    !T::ENABLED && history.is_covered(column, row, &inside, &held.missing)
                };
                let fresh = &mut self.fresh;
                self.cells.mark_border(piece, &rect, is_closed, fresh);
            }
        }
    }

    /// Cuts all cells for a level: those that throw darts, and those that were marked.
    fn cut<T: Recorder>(&mut self, level: u32, recorder: &mut T) {
        let before = std::mem::replace(&mut self.side, R >> level);
        for cell in std::mem::take(&mut self.open) {
            self.cut_cell(cell, before, level, recorder);
        }
        self.cut_fresh(level, recorder);
    }

    /// Cuts the cells that were marked for a level.
    fn cut_fresh<T: Recorder>(&mut self, level: u32, recorder: &mut T) {
        let mut fresh = std::mem::take(&mut self.fresh);
        for cell in fresh.drain(..) {
            self.cut_cell(cell, MARK_SIDE, level, recorder);
        }
        self.fresh = fresh;
    }

    /// Cuts a cell of `side` units for a level, and opens the parts that no single sample of the levels before covers.
    fn cut_cell<T: Recorder>(&mut self, cell: PieceCell, side: i32, level: u32, recorder: &mut T) {
        let first = self.open.len();
        let first_of_level = Arrival::new(level, 0, 0);
        let mut decided = self.present.before(first_of_level);
        let open = &mut self.open;
        self.cells
            .cut(cell, side, R >> level, self.shape, &mut decided, open);

        if T::ENABLED {
            let square = self.square(cell, side);
            recorder.record(RunEvent::Cut {
                cell: square.min,
                z: 0,
                side,
                kept: (self.open.len() - first) as u32,
            });
        }
    }

    /// Throws the darts of a level into the open cells from the one at `first` on, those later than `after`.
    fn throw<T: Recorder>(
        &mut self,
        first: usize,
        level: u32,
        after: Option<&PlacedDart>,
        recorder: &mut T,
    ) {
        if T::ENABLED {
            self.keep_cells(first);
        }
        for index in first..self.open.len() {
            self.throw_into(self.open[index], level, after, recorder);
        }
    }

    /// Throws the darts of a level into a cell, those later than `after`.
    fn throw_into<T: Recorder>(
        &mut self,
        cell: PieceCell,
        level: u32,
        after: Option<&PlacedDart>,
        recorder: &mut T,
    ) {
        let history = self.history;
        let piece = self.cells.pieces()[cell.piece as usize];

        for (arrival, source) in history.darts().of_cell(level, cell.min) {
            // A cell at the border of a piece reaches beyond it, to darts that the piece does not have.
            if !piece.sources.contains(source) {
                continue;
            }

            let dart = PlacedDart {
                arrival,
                source,
                place: piece.place(source),
            };
            // A cell at the border of the shape reaches beyond it, where there are no darts.
            if !self.shape.inside(dart.place) {
                continue;
            }

            // `after` is the dart of a lost sample, which refused later darts alone: other samples cover the earlier ones.
            if after.is_some_and(|after| dart <= *after) {
                continue;
            }

            // The dart of a present sample is dropped when its turn comes (`decide_dart`). A recording leaves it out here, since
            // it would show it as falling, where it arrives as the sample.
            if T::ENABLED && self.present.has(&dart, piece.tile) {
                continue;
            }

            // A filter: samples of earlier levels are final, and a dart that one of them covers need not wait for its
            // turn.
            let first_of_level = Arrival::new(level, 0, 0);
            let mut decided = self.present.before(first_of_level);
            let is_covered = decided.covers(piece.tile, dart.place);
            if T::ENABLED {
                recorder.record(RunEvent::Dart {
                    point: dart.place,
                    z: 0,
                    // A first look, before its turn.
                    ranked: false,
                    verdict: self.verdict(&dart, piece.tile, is_covered),
                });
            }
            if !is_covered {
                self.agenda.add(dart, What::Dart(piece.tile));
            }
        }
    }

    /// Puts the window's samples into `out`, in canonical order, with their counts, and with tags of their sources if they
    /// are wanted.
    pub(crate) fn emit(&self, with_tags: bool, out: &mut WindowSamples) {
        out.clear();
        self.count(&mut out.counts);
        let frame = &self.present.ground().frame;
        let (window, cells) = (frame.window, frame.window_cells());
        // No window crosses the domain's ends, so that all places are moved alike.
        let first = frame.point(window.min.x, window.min.y);
        let (right, up) = (first.x - window.min.x, first.y - window.min.y);

        let mut held = Vec::new();
        for row in cells.min.y..cells.max.y {
            for column in cells.min.x..cells.max.x {
                held.clear();
                self.present.in_cell(column, row, |id, place| {
                    // The outermost cells reach beyond the window.
                    if window.contains(place) {
                        held.push((place, id));
                    }
                });

                // Most cells have one.
                if held.len() > 1 {
                    held.sort_unstable_by_key(|(place, _)| place.row_major());
                }

                for &(place, id) in &held {
                    out.points.push(Point::new(place.x + right, place.y + up));
                    if with_tags {
                        out.tags.push(self.tag(self.present.get(id)));
                    }
                }
            }

            // How many samples there are up to the end of this row of cells.
            out.rows.push(out.points.len() as u32);
        }
    }

    fn tag(&self, sample: &ArrivedSample) -> u64 {
        match sample.pattern() {
            Some(pattern) => tiled_tag(self.tiles[sample.tile as usize].block, pattern),
            None => inserted_tag(self.iteration(sample)),
        }
    }

    /// Returns the iteration in which a sample counts as inserted.
    fn iteration(&self, sample: &ArrivedSample) -> u32 {
        iteration_of(self.present.arrival(sample))
    }

    /// Counts what the window has.
    fn count(&self, counts: &mut WindowCounts) {
        counts.clear();
        let window = self.present.ground().frame.window;
        // Each block has its lowest corner in one window, so that the counts of all windows add up.
        let corners = self.blocks.iter().map(|block| block.rect.min);
        let inside = corners.filter(|&corner| Rect64::from(window).contains(corner));
        counts.blocks = inside.count() as u64;

        // Nearly all are the pattern's own, and stay. The rest were lost, or inserted here.
        let samples = self.present.samples().iter();
        let others = samples.filter(|sample| !sample.is_own());
        for sample in others.filter(|sample| window.contains(sample.place)) {
            // Tiled samples follow from the other counts.
            if sample.is_lost {
                counts.eliminated += 1;
            } else {
                // Iterations are counted from 1.
                counts.insert(self.iteration(sample) as usize - 1, 1);
            }
        }
    }
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
        for stopped in [Stage::Tile, Stage::Iterate(1), Stage::Iterate(3)] {
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
