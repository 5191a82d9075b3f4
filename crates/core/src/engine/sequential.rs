//! The sequential engine, written to be read: one stage per step, in the paper's order. The run can be inspected
//! between steps.

use std::sync::Arc;

use crate::engine::as_printed::AsPrinted;
use crate::error::SampleError;
use crate::grid::SampleGrid;
use crate::lattice::Domain;
use crate::parameters::{Insertion, Parameters, Variant};
use crate::pattern::Pattern;
use crate::progress::{Meter, Observer};
use crate::random::Key;
use crate::record::{Recorder, RunEvent, Unrecorded};
use crate::run::{Iteration, Run};
use crate::samples::{Fate, Origin, Samples, Sites};
use crate::stage::Stage;
use crate::stages::blocks::split_recorded;
use crate::stages::darts::DartProcess;
use crate::stages::detect::{Candidate, Detection, first_detectors};
use crate::stages::eliminate::{contested, eliminate};
use crate::stages::insert::{insert, unique};
use crate::stages::order::Ranking;
use crate::stages::tile::tile;
use crate::stages::uniform::gap_process;

/// The engine between two stages.
pub struct Sequential {
    run: Run,
    key: Key,
    next: Option<Stage>,
    filling: Filling,
}

/// How gaps are being filled; set by elimination.
enum Filling {
    NotYet,
    Circumcentres {
        survivors: SampleGrid,
        detectors: Vec<u32>,
    },
    Uniform(DartProcess),
    AsPrinted(AsPrinted),
}

impl Sequential {
    /// Returns an engine before its first stage.
    ///
    /// `pattern` need not be the one that the parameters describe; it may come from a file.
    pub fn new(parameters: &Parameters, pattern: Arc<Pattern>) -> Result<Self, SampleError> {
        let domain = parameters.validate_sequential()?;
        parameters.check_kdrt()?;
        pattern.check_domain(&domain)?;
        let key = Key::from_seed(parameters.seed);
        Ok(Self {
            run: Run::new(parameters, domain, pattern),
            key,
            next: Some(Stage::Blocks),
            filling: Filling::NotYet,
        })
    }

    /// Returns the run so far.
    #[must_use]
    pub const fn run(&self) -> &Run {
        &self.run
    }

    /// Returns the stage that the next step begins with, or `None` when the run is finished.
    #[must_use]
    pub const fn next(&self) -> Option<Stage> {
        self.next
    }

    /// Runs one stage and returns it, or `None` when the run is finished. An iteration that finds
    /// no gap is not recorded: the step goes on to [`Stage::Finish`]. In Algorithm 4 as printed the step
    /// [`Stage::Eliminate`] contains iteration 1.
    ///
    /// After an error the engine must not be used any more.
    pub fn step(&mut self, observer: &mut dyn Observer) -> Result<Option<Stage>, SampleError> {
        self.step_recorded(observer, &mut Unrecorded)
    }

    /// Like [`Self::step`], and reports events to `recorder`.
    pub fn step_recorded<T: Recorder>(
        &mut self,
        observer: &mut dyn Observer,
        recorder: &mut T,
    ) -> Result<Option<Stage>, SampleError> {
        let Some(mut stage) = self.next else {
            return Ok(None);
        };

        // Two stages never occur, as this engine is given its pattern and has no regions. Each is treated as the stage
        // that would follow it.
        match stage {
            Stage::Pattern | Stage::Blocks => self.split(observer, recorder)?,
            Stage::Tile => self.tile(observer, recorder)?,
            Stage::Eliminate => self.eliminate(observer, recorder)?,
            Stage::Iterate(k) => {
                // Without a gap nothing is left to do: the same step ends the run.
                if !self.iterate(k, observer, recorder)? {
                    stage = Stage::Finish;
                    self.gather(observer, recorder)?;
                }
            }
            Stage::Regions | Stage::Finish => self.gather(observer, recorder)?,
        }

        self.next = match stage {
            Stage::Pattern | Stage::Blocks => Some(Stage::Tile),
            Stage::Tile => Some(Stage::Eliminate),
            // Algorithm 4 as printed has made iteration 1 by now: its first loop inserts, too.
            Stage::Eliminate => Some(Stage::Iterate(self.run.iterations.len() as u32 + 1)),
            Stage::Iterate(k) => Some(Stage::Iterate(k + 1)),
            Stage::Regions | Stage::Finish => None,
        };

        Ok(Some(stage))
    }

    /// Runs all remaining stages and returns the run.
    pub fn finish(mut self, observer: &mut dyn Observer) -> Result<Run, SampleError> {
        while self.step(observer)?.is_some() {}
        Ok(self.run)
    }

    /// Makes the blocks.
    fn split<T: Recorder>(
        &mut self,
        observer: &mut dyn Observer,
        recorder: &mut T,
    ) -> Result<(), SampleError> {
        recorder.record(RunEvent::Begin(Stage::Blocks));
        let meter = Meter::begin(observer, Stage::Blocks, 1)?;
        let leaf = self.run.parameters.leaf_units()?;
        self.run.blocks = split_recorded(&self.run.domain, leaf, self.key, recorder);
        meter.end()
    }

    /// Clips the pattern for every block: the samples and tiles of the run.
    fn tile<T: Recorder>(
        &mut self,
        observer: &mut dyn Observer,
        recorder: &mut T,
    ) -> Result<(), SampleError> {
        recorder.record(RunEvent::Begin(Stage::Tile));
        let Run {
            domain,
            blocks,
            pattern,
            samples,
            parameters,
            ..
        } = &mut self.run;

        let meter = Meter::begin(observer, Stage::Tile, blocks.leaves.len() as u64)?;
        self.run.tiles = tile(
            domain,
            blocks,
            pattern,
            parameters.dihedral,
            samples,
            meter,
            recorder,
        )?;

        Ok(())
    }

    /// Decides all fates, and prepares to fill gaps as the parameters ask. Algorithm 4 as printed also makes iteration
    /// 1.
    fn eliminate<T: Recorder>(
        &mut self,
        observer: &mut dyn Observer,
        recorder: &mut T,
    ) -> Result<(), SampleError> {
        recorder.record(RunEvent::Begin(Stage::Eliminate));
        let run = &mut self.run;
        let Parameters {
            order,
            insertion,
            search,
            variant,
            ..
        } = run.parameters;

        let ranking = Ranking::new(order, &run.domain, self.key);
        let mut meter = Meter::begin(observer, Stage::Eliminate, run.samples.len() as u64)?;
        // Only samples near the borders of their blocks may be in conflict: they alone are ranked, and count as work to
        // come.
        let ranked = contested(&run.samples, &run.blocks, &ranking, &mut meter)?;
        meter.set_total(ranked.len() as u64);

        // Algorithm 4 as printed eliminates in the loop that also inserts, below.
        if variant == Variant::Staged {
            let (domain, samples) = (&run.domain, &mut run.samples);
            eliminate(domain, samples, &ranked, &mut meter, recorder)?;
        }

        self.filling = match (variant, insertion) {
            // The first loop is lines 2 to 12 of Algorithm 4, which eliminate and insert in turn. It inserts
            // circumcentres alone: parameters that ask for uniform insertion with it are refused.
            (Variant::AsPrinted, _) => {
                let mut printed = AsPrinted::new(run.domain, search, &run.samples);
                run.iterations.push(printed.first_loop(
                    &mut run.samples,
                    &ranked,
                    meter,
                    recorder,
                )?);
                Filling::AsPrinted(printed)
            }
            (Variant::Staged, Insertion::Circumcentre) => {
                // Detection asks for valid samples alone, and the grid of elimination also holds lost ones.
                let grid = survivors(run.domain, &run.samples, &mut meter)?;
                let detectors = first_detectors(&run.samples, &grid, &mut meter, recorder)?;
                meter.end()?;
                Filling::Circumcentres {
                    survivors: grid,
                    detectors,
                }
            }
            (Variant::Staged, Insertion::Uniform) => {
                meter.end()?;
                Filling::Uniform(gap_process(run.domain, &run.samples, self.key))
            }
        };

        Ok(())
    }

    /// Runs iteration `k` and returns whether it found a gap or threw into cells that may hold one. Otherwise it is not
    /// kept in the run. Its events are reported all the same if it looked for gaps: uniform insertion sees beforehand
    /// that no cell is left.
    fn iterate<T: Recorder>(
        &mut self,
        k: u32,
        observer: &mut dyn Observer,
        recorder: &mut T,
    ) -> Result<bool, SampleError> {
        let run = &mut self.run;

        let iteration = match &mut self.filling {
            // This cannot occur, since elimination comes before and chooses another one.
            Filling::NotYet => return Ok(false),
            Filling::Circumcentres {
                survivors,
                detectors,
            } => {
                let meter = Meter::begin(observer, Stage::Iterate(k), detectors.len() as u64)?;
                recorder.record(RunEvent::Iteration {
                    number: k,
                    detectors: detectors.len() as u32,
                });

                let candidates = detect(run, survivors, detectors, meter, recorder)?;
                let inserted = insert(
                    &mut run.samples,
                    survivors,
                    &candidates,
                    k,
                    self.key,
                    recorder,
                );

                // A gap that is left touches a sample inserted just now: any other had a candidate, which was inserted
                // or is covered by one that was. So these samples alone detect next (paper, Algorithm 4, line 19).
                let searched = std::mem::replace(detectors, inserted.clone().collect());

                Iteration {
                    detectors: searched,
                    candidates,
                    cells: Vec::new(),
                    inserted,
                }
            }
            Filling::Uniform(process) if process.is_finished() => return Ok(false),
            Filling::Uniform(process) => uniform(process, k, &mut run.samples, observer, recorder)?,
            Filling::AsPrinted(printed) => {
                // The loop sets the total, once it has gathered its detectors.
                let meter = Meter::begin(observer, Stage::Iterate(k), 1)?;
                printed.second_loop(k, &mut run.samples, meter, recorder)?
            }
        };

        recorder.record(RunEvent::IterationEnd {
            number: k,
            inserted: iteration.inserted.len() as u32,
        });

        // A throw that hits nothing is not the end of uniform insertion: its cells are cut and throw again.
        let found = !iteration.inserted.is_empty() || !iteration.cells.is_empty();
        if found {
            run.iterations.push(iteration);
        }

        Ok(found)
    }

    /// Ends the run: lists the samples of the result.
    fn gather<T: Recorder>(
        &mut self,
        observer: &mut dyn Observer,
        recorder: &mut T,
    ) -> Result<(), SampleError> {
        recorder.record(RunEvent::Begin(Stage::Finish));
        let meter = Meter::begin(observer, Stage::Finish, 1)?;
        let result = self.run.samples.kept();
        recorder.record(RunEvent::Finish {
            count: result.len() as u32,
        });

        self.run.result = result;
        meter.end()
    }
}

/// Returns the grid of all kept samples.
pub(crate) fn survivors(
    domain: Domain,
    samples: &Samples,
    meter: &mut Meter<'_>,
) -> Result<SampleGrid, SampleError> {
    let mut grid = SampleGrid::with_capacity(domain, samples.len());
    for (id, &fate) in (0..).zip(&samples.fates) {
        meter.work(1)?;
        if fate == Fate::Kept {
            grid.insert(id, samples.points[id as usize]);
        }
    }
    Ok(grid)
}

/// Returns the candidates that the detectors find among the survivors, each once.
fn detect<T: Recorder>(
    run: &Run,
    survivors: &SampleGrid,
    detectors: &[u32],
    mut meter: Meter<'_>,
    recorder: &mut T,
) -> Result<Vec<Candidate>, SampleError> {
    let mut detection = Detection::new(run.domain, run.parameters.search, survivors);
    let mut candidates = Vec::new();

    for &id in detectors {
        let at = run.samples.points[id as usize];
        detection.find(id, at, &mut candidates, recorder);
        meter.tick()?;
    }

    // A place is found by each of its sites that is a detector.
    unique(&mut candidates);
    meter.end()?;
    Ok(candidates)
}

/// Makes iteration `k` of uniform insertion: one throw of the process.
pub(crate) fn uniform<T: Recorder>(
    process: &mut DartProcess,
    k: u32,
    samples: &mut Samples,
    observer: &mut dyn Observer,
    recorder: &mut T,
) -> Result<Iteration, SampleError> {
    // The cells are read before the step, which may cut them. The event counts them in place of detectors.
    let cells: Vec<_> = process.active_cells().collect();
    recorder.record(RunEvent::Iteration {
        number: k,
        detectors: cells.len() as u32,
    });

    let first = samples.len() as u32;
    for point in process.step_recorded(Stage::Iterate(k), observer, first, recorder)? {
        let (iteration, sites) = (k, Sites::Dart);
        samples.push(point, Origin::Inserted { iteration, sites }, Fate::Kept);
    }

    Ok(Iteration {
        cells,
        inserted: first..samples.len() as u32,
        ..Iteration::default()
    })
}
