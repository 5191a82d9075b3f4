//! The engine of exact tiling, written to be read. It lays down the pattern's samples and follows the differences from
//! what the pattern's own darts made of them, in the order of arrival.
//!
//! Its stages are files: `tile` lays down, `decide` goes through what arrives, `throw` has the late darts, and `emit` the
//! result. It works on a whole domain, and can be recorded. [`super::seams`] makes the same samples window by window, in a
//! fraction of the time.
//!
//! The *ground* is the part of the plane that is worked on, here the whole domain. A *tile* is the part of a block on the
//! ground, and a *piece* the part of a tile that one copy of the pattern fills. The *first blocker* of a dart is the
//! earliest sample of the pattern that covers it. *Late* darts are those of [`LATE_LEVEL`] and after.

mod decide;
mod emit;
pub(super) mod recorded;
mod throw;
mod tile;

use self::recorded::KeptLevels;

use crate::engine::parallel::clip::{Clipper, PlacedBlock};
use crate::engine::parallel::sweep::sampled;
use crate::engine::parallel::window_maker::WindowSamples;
use crate::error::SampleError;
use crate::exact::agenda::Agenda;
use crate::exact::bare::{MarkedCells, PieceCell};
use crate::exact::darts::Arrival;
use crate::exact::filter::SampleFilter;
use crate::exact::ground::Ground;
use crate::exact::history::{LATE_LEVEL, PatternHistory};
use crate::exact::present::PresentSamples;
use crate::lattice::{R, Rect};
use crate::parameters::Parameters;
use crate::pattern::{Pattern, Symmetry};
use crate::progress::Observer;
use crate::random::Key;
use crate::record::{Recorder, Unrecorded};
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
