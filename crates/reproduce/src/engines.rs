//! Makes sets with any engine. Does not time or verify them.

use std::sync::Arc;

use pollster::block_on;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use serde::{Deserialize, Serialize};
use tilescope_core::combine::{CombineOptions, Piece, combine, grid};
use tilescope_core::{
    Boundary, Domain, Parameters, Pattern, PatternArrivals, PatternHistory, Point, Rect,
    Sequential, exact_points, reference_sample,
};
use tilescope_gpu::{self as gpu, ASKED_FOR, Backend, Bands, Choice, Gpu, exact_on_gpu};

use crate::control::Control;
use crate::error::{ReproduceError, Result};
use crate::machine::GPUS;

/// Sets along each side of a combination of nine.
const ALONG: u32 = 3;

/// A sampler, or an engine of randomized tiling.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Engine {
    /// The reference sampler, on one thread.
    Reference,
    /// Nine sets of the reference sampler, on all threads, combined.
    Combined {
        /// Threads that they are made on.
        threads: usize,
    },
    /// The sequential engine, on one thread.
    Sequential,
    /// The parallel engine, on a pool of threads.
    Parallel {
        /// Threads that it runs on.
        threads: usize,
    },
    /// Exact tiling, on one thread, with the pattern and tables that are open.
    Exact,
    /// The engine on a GPU.
    Gpu {
        /// The name of the GPU.
        adapter: String,
    },
    /// Exact tiling, on a pool of threads, with the pattern and tables that are open.
    ExactParallel {
        /// Threads that it runs on.
        threads: usize,
    },
    /// Exact tiling on a GPU, with the pattern that is open. Its sets have sources, and those of the other engines have none.
    ExactGpu {
        /// The name of the GPU.
        adapter: String,
    },
}

impl Engine {
    /// Returns the parallel engine on all threads.
    pub(crate) fn parallel() -> Self {
        let threads = rayon::current_num_threads();
        Self::Parallel { threads }
    }

    /// Returns exact tiling on all threads.
    pub(crate) fn exact_parallel() -> Self {
        let threads = rayon::current_num_threads();
        Self::ExactParallel { threads }
    }

    /// Returns whether it tiles, and does not make sets from scratch.
    pub(crate) const fn tiles(&self) -> bool {
        !matches!(self, Self::Reference | Self::Combined { .. })
    }

    /// Returns its name, without the leaf.
    #[must_use]
    pub fn name(&self) -> String {
        match self {
            Self::Reference => "reference".to_owned(),
            Self::Combined { .. } => format!("reference, {ALONG} x {ALONG} combined"),
            Self::Sequential => "KDRT, sequential".to_owned(),
            Self::Parallel { .. } => "KDRT, parallel".to_owned(),
            Self::Exact => "exact tiling".to_owned(),
            Self::Gpu { adapter } => format!("KDRT, {adapter}"),
            Self::ExactParallel { .. } => "exact tiling, parallel".to_owned(),
            Self::ExactGpu { adapter } => format!("exact tiling, {adapter}"),
        }
    }

    /// Returns how many threads of the processor it uses, or `None` for a GPU.
    #[must_use]
    pub const fn threads(&self) -> Option<usize> {
        match self {
            Self::Combined { threads }
            | Self::Parallel { threads }
            | Self::ExactParallel { threads } => Some(*threads),
            Self::Gpu { .. } | Self::ExactGpu { .. } => None,
            Self::Reference | Self::Sequential | Self::Exact => Some(1),
        }
    }
}

/// Pools of threads, open GPUs and the tables of a pattern, with which engines run.
pub struct Engines {
    pools: Vec<ThreadPool>,
    gpus: Vec<Arc<Gpu>>,
    history: Option<PatternHistory>,
    arrivals: Option<PatternArrivals>,
}

impl Engines {
    /// Starts a pool for each of these numbers of threads, and one of a single thread. For all threads there is the global pool.
    pub fn open(threads: &[usize], gpus: Vec<Arc<Gpu>>) -> Result<Self> {
        let all = rayon::current_num_threads();
        // Exact tiling is always measured on one thread, too. If that is asked for as well, a second such pool does no harm.
        let pools = threads
            .iter()
            .chain(&[1])
            .filter(|&&threads| threads != all);
        let pool = |&threads: &usize| {
            let builder = ThreadPoolBuilder::new().num_threads(threads);
            builder.build().map_err(failed)
        };
        let pools = pools.map(pool).collect::<Result<_, _>>()?;
        Ok(Self {
            pools,
            gpus,
            history: None,
            arrivals: None,
        })
    }

    /// Returns the engines with what exact tiling on a GPU needs.
    pub fn with_arrivals(self, arrivals: PatternArrivals) -> Self {
        let arrivals = Some(arrivals);
        Self { arrivals, ..self }
    }

    /// Returns the engines with what exact tiling needs.
    pub fn with_history(self, history: PatternHistory) -> Self {
        let history = Some(history);
        Self { history, ..self }
    }

    /// Starts a pool of one thread and opens every GPU.
    pub fn open_all() -> Result<Self> {
        let gpus = GPUS.iter().map(|gpu| {
            let choice = Choice {
                name: Some(gpu.name.clone()),
                ..Choice::default()
            };
            block_on(Gpu::open(&choice)).map(Arc::new)
        });
        Self::open(&[1], gpus.collect::<Result<_, _>>()?)
    }

    /// Makes a set with an engine, and returns its points.
    pub fn make(
        &self,
        engine: &Engine,
        parameters: &Parameters,
        pattern: &Arc<Pattern>,
        control: &Control<'_>,
    ) -> Result<Vec<Point>> {
        let observer = &mut |_| control.flow();
        let domain = parameters.validate()?;
        let banded = |engine| by_bands(engine, parameters, pattern, control);

        let points = match engine {
            Engine::Reference => reference_sample(domain, parameters.seed, observer)?,
            // It always runs on all threads: `threads` only says how many there are.
            Engine::Combined { .. } => {
                let pieces = nine(domain, parameters.seed, control)?;
                combine(domain, &pieces, &CombineOptions::default(), observer)?.points
            }
            Engine::Sequential => {
                let engine = Sequential::new(parameters, Arc::clone(pattern))?;
                engine.finish(observer)?.points()
            }
            Engine::Parallel { threads } => {
                let make = || banded(gpu::Engine::Parallel);
                let pool = self.pool(*threads);
                pool.map_or_else(make, |pool| pool.install(make))?
            }
            Engine::ExactParallel { threads } => self.exact(*threads, parameters, control)?,
            Engine::ExactGpu { adapter } => {
                let none = || failed("there is no pattern for exact tiling on a GPU");
                let arrivals = self.arrivals.as_ref().ok_or_else(none)?;
                let gpu = self.gpu(adapter)?;
                block_on(exact_on_gpu(&gpu, parameters, arrivals, observer))?.points()
            }
            Engine::Exact => self.exact(1, parameters, control)?,
            Engine::Gpu { adapter } => banded(gpu::Engine::Gpu(self.gpu(adapter)?))?,
        };

        Ok(points)
    }

    /// Makes an exact tiling on so many threads.
    fn exact(
        &self,
        threads: usize,
        parameters: &Parameters,
        control: &Control<'_>,
    ) -> Result<Vec<Point>> {
        let history = self.history()?;
        // `make` is passed twice below, and so is copied. It could not be if it borrowed an observer.
        let make = || exact_points(parameters, history, &mut |_| control.flow());
        let pool = self.pool(threads);
        Ok(pool.map_or_else(make, |pool| pool.install(make))?)
    }

    /// Returns the pool of so many threads. [`Self::open`] has started one for each number that it was given but that of all
    /// threads, for which the global pool serves.
    fn pool(&self, threads: usize) -> Option<&ThreadPool> {
        let mut pools = self.pools.iter();
        pools.find(|pool| pool.current_num_threads() == threads)
    }

    /// Returns the tables of exact tiling, which were made before, so that they do not count in the time of a set.
    pub(crate) fn history(&self) -> Result<&PatternHistory> {
        let none = || failed("there are no tables for exact tiling");
        self.history.as_ref().ok_or_else(none)
    }

    /// Returns an open GPU by its name.
    pub fn gpu(&self, adapter: &str) -> Result<Arc<Gpu>> {
        let found = self.gpus.iter().find(|gpu| gpu.report().name == adapter);
        found
            .cloned()
            .ok_or_else(|| failed(format!("{adapter} is not open")))
    }
}

fn failed(error: impl std::fmt::Display) -> ReproduceError {
    ReproduceError::Engine(error.to_string())
}

/// Makes a set with an engine that has no substitute.
fn by_bands(
    engine: gpu::Engine,
    parameters: &Parameters,
    pattern: &Arc<Pattern>,
    control: &Control<'_>,
) -> Result<Vec<Point>> {
    let backend = Backend::new(engine, ASKED_FOR);
    let sources = false;
    let (sampled, ..) = block_on(async {
        let bands = Bands::new(parameters, pattern, sources, &backend, |_| {}).await?;
        bands.finish(&mut control.observer()).await
    })?;
    Ok(sampled.points)
}

/// Returns the rectangles of nine sets that fill a domain.
pub fn nine_rects(domain: &Domain) -> Vec<Rect> {
    grid(domain, ALONG, ALONG)
}

/// Makes nine periodic sets with the reference sampler, each with a seed of its own, on all threads.
pub fn nine(domain: Domain, seed: u64, control: &Control<'_>) -> Result<Vec<Piece>> {
    let rects = nine_rects(&domain).into_par_iter().enumerate();
    rects
        .map(|(index, rect)| {
            let own = Domain::of_rect(&rect, Boundary::Periodic)?;
            // Seeds of consecutive sets are a hundred apart, so that none of the nine has that of another set.
            let seed = seed.wrapping_mul(100).wrapping_add(index as u64);
            let set = Pattern::of_reference(own, seed, &mut control.observer())?;
            Ok(Piece {
                set: Arc::new(set),
                rect,
                start: Point::default(),
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Settings;
    use crate::study::tests::alone;
    use tilescope_core::Unobserved;

    #[test]
    fn engines_of_one_run_agree_and_others_make_other_sets() {
        alone(&Settings::default(), |control| {
            let parameters = Parameters {
                radius: 0.02,
                leaf: 20.0,
                ..Parameters::default()
            };
            let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved)?;
            let engines = Engines::open(&[1], Vec::new())?;
            let make = |engine| engines.make(&engine, &parameters, &pattern, control);
            let all = make(Engine::parallel())?;
            assert_eq!(all, make(Engine::Parallel { threads: 1 })?);
            assert_eq!(all, make(Engine::Sequential)?);
            assert_ne!(all, make(Engine::Reference)?);
            assert_ne!(all, make(Engine::Combined { threads: 2 })?);
            let nowhere = Engine::Gpu {
                adapter: "none of that name".to_owned(),
            };
            assert!(make(nowhere).is_err() && make(Engine::Exact).is_err());
            assert!(make(Engine::exact_parallel()).is_err());
            let no_gpu = Engine::ExactGpu {
                adapter: "none of that name".to_owned(),
            };
            assert!(make(no_gpu).is_err());

            let history = PatternHistory::of_spec(&parameters.pattern, &mut Unobserved)?;
            let engines = engines.with_history(history);
            let exact = engines.make(&Engine::Exact, &parameters, &pattern, control)?;
            assert_ne!(exact, all);
            let on_all = Engine::exact_parallel();
            assert_eq!(
                engines.make(&on_all, &parameters, &pattern, control)?,
                exact
            );
            Ok(())
        });
    }
}
