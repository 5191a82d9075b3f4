//! What a recording of exact tiling has beside the engine: its events, the iterations, and the run with all samples.

use std::sync::Arc;

use crate::engine::parallel::clip::PlacedBlock;
use crate::error::SampleError;
use crate::exact::agenda::Arriving;
use crate::exact::bare::PieceCell;
use crate::exact::darts::PlacedDart;
use crate::exact::engine::{ExactTiling, clipper};
use crate::exact::ground::Ground;
use crate::exact::history::PatternHistory;
use crate::parameters::Parameters;
use crate::progress::Observer;
use crate::random::Key;
use crate::record::{Recorder, RunEvent, Verdict};
use crate::run::{Iteration, Run};
use crate::samples::{Fate, Origin, Sites};
use crate::stage::Stage;
use crate::stages::blocks::split_recorded;
use crate::stages::disks::Cell;
use crate::stages::tile::Tile;
use crate::varying::Shape;

/// Like [`exact_in_shape`](crate::exact_in_shape), and reports events to `recorder`. The result is the same. The run also has the
/// samples that were lost, each with the first sample that covers it.
///
/// All that a block has of the pattern's samples is laid down first, then everything arrives in its order: a sample is kept
/// or eliminated, a dart is refused or inserted. The engine asks only samples near seams; here each one's arrival is an event.
pub fn exact_recorded<T: Recorder>(
    parameters: &Parameters,
    history: &PatternHistory,
    shape: &Shape,
    observer: &mut dyn Observer,
    recorder: &mut T,
) -> Result<Run, SampleError> {
    if !T::ENABLED {
        // The run has lost samples too, which only an enabled recorder makes the engine keep.
        return exact_recorded(parameters, history, shape, observer, &mut NoEvents);
    }

    // The run keeps the origin and the fate of every sample, and has the limit of such runs.
    let domain = parameters.validate_sequential()?;
    let mut run_clipper = clipper(parameters, history.pattern())?;
    // Origins name blocks by their indices, which blocks have only once they are counted.
    run_clipper.count_blocks();

    let pattern = Arc::clone(history.pattern());
    // The run states the defaults of the parameters that have no meaning in exact tiling.
    let mut run = Run::new(&parameters.as_exact(), domain, pattern);

    recorder.record(RunEvent::Begin(Stage::Blocks));
    let (leaf, key) = (parameters.leaf_units()?, Key::from_seed(parameters.seed));
    run.blocks = split_recorded(&domain, leaf, key, recorder);

    let mut tiling = ExactTiling::new(history, shape);
    tiling.run(&run_clipper, Ground::whole(&domain), observer, recorder)?;

    recorder.record(RunEvent::Begin(Stage::Finish));
    tiling.into_run(&mut run);
    recorder.record(RunEvent::Finish {
        count: run.result.len() as u32,
    });
    Ok(run)
}

/// An enabled recorder that keeps no event.
struct NoEvents;

impl Recorder for NoEvents {
    fn record(&mut self, _: RunEvent) {}
}

/// What a recorded tiling keeps beside its samples.
#[derive(Default)]
pub(super) struct KeptLevels {
    /// Lost samples, each with its first blocker.
    pub(super) losses: Vec<[u32; 2]>,
    /// Iterations: the first has levels 0 and 1, the kth has level k.
    iterations: Vec<Iteration>,
    /// The last thing that was decided.
    pub(super) last: Option<Arriving>,
}

impl ExactTiling<'_> {
    /// Begins an iteration, if the tiling is recorded.
    pub(super) fn begin<T: Recorder>(&mut self, number: u32, recorder: &mut T) {
        if T::ENABLED {
            let first = self.present.samples().len() as u32;
            self.kept.iterations.push(Iteration {
                inserted: first..first,
                ..Iteration::default()
            });
            recorder.record(RunEvent::Iteration {
                number,
                detectors: self.open.len() as u32,
            });
        }
    }

    /// Ends the iteration that has begun last.
    pub(super) fn end<T: Recorder>(&mut self, recorder: &mut T) {
        let number = self.kept.iterations.len() as u32;
        if let Some(iteration) = self.kept.iterations.last_mut() {
            iteration.inserted.end = self.present.samples().len() as u32;
            recorder.record(RunEvent::IterationEnd {
                number,
                inserted: iteration.inserted.len() as u32,
            });
        }
    }

    /// Keeps where the open cells from the one at `first` on are, as those of the iteration that has begun last.
    pub(super) fn keep_cells(&mut self, first: usize) {
        let cells = self.open[first..].iter();
        let squares: Vec<Cell> = cells.map(|cell| self.square(*cell, self.side)).collect();
        if let Some(iteration) = self.kept.iterations.last_mut() {
            iteration.cells.extend(squares);
        }
    }

    /// Returns where the domain has a cell of the pattern. At the border of a block a part of it is missing.
    pub(super) fn square(&self, cell: PieceCell, side: i32) -> Cell {
        let placed = self.cells.placed(cell, side);
        // Marked and open cells have a part in their piece, so that `cell.min` never stands in.
        let min = placed.map_or(cell.min, |placed| placed.min);
        Cell { min, side }
    }

    /// Returns the verdict on a dart, with its first blocker if one covers it.
    pub(super) fn verdict(&self, dart: &PlacedDart, tile: u32, is_covered: bool) -> Verdict {
        if is_covered {
            let by = self.blocker(dart, tile);
            Verdict::Covered { by }
        } else {
            Verdict::Accepted
        }
    }

    /// Returns the id of the first blocker of a dart that an earlier sample covers.
    pub(super) fn blocker(&self, dart: &PlacedDart, tile: u32) -> u32 {
        let first = self.present.first_blocker(dart, tile);
        first.expect("an earlier sample covers it")
    }

    /// Moves all samples of a recorded tiling into its run, with their fates and the iterations.
    fn into_run(self, run: &mut Run) {
        for sample in self.present.samples() {
            let origin = match sample.pattern() {
                Some(pattern) => Origin::Tiled {
                    block: self.tiles[sample.tile as usize].block,
                    pattern,
                    // The samples of margins are not laid down in exact tiling.
                    own: true,
                },
                None => Origin::Inserted {
                    iteration: self.iteration(sample),
                    sites: Sites::Dart,
                },
            };
            let place = self.present.in_domain(sample.tile, sample.place);
            run.samples.push(place, origin, Fate::Kept);
        }

        for &[sample, by] in &self.kept.losses {
            run.samples.fates[sample as usize] = Fate::Eliminated { by };
        }

        // Blocks that reach onto the ground with their margins alone have no tile.
        let all = self.present.ground().rect();
        let on_ground = |block: &&PlacedBlock| block.rect.within(&all).is_some();
        let starts = self
            .blocks
            .iter()
            .filter(on_ground)
            .map(|block| block.start);

        // The samples of the tiles come first, tile by tile, and then all that were inserted.
        let samples = self.present.samples();
        let tiled = samples.partition_point(|sample| sample.pattern().is_some());
        let first_of = |tile| samples[..tiled].partition_point(|sample| sample.tile < tile) as u32;
        let tiles = (0..).zip(&self.tiles).zip(starts);

        run.tiles = tiles
            .map(|((tile, held), start)| Tile {
                start,
                symmetry: held.symmetry,
                samples: first_of(tile)..first_of(tile + 1),
            })
            .collect();

        run.iterations = self.kept.iterations;
        run.result = run.samples.kept();
    }
}
