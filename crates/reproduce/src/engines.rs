//! Every engine there is, as something that makes a set: for experiments that take their time.
//! It takes no time itself and verifies nothing.

use std::sync::Arc;

use pollster::block_on;
use rayon::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use tilescope_core::combine::{CombineOptions, Piece, combine, grid};
use tilescope_core::{
    Boundary, Domain, Parameters, Pattern, Point, Rect, Sequential, reference_sample,
};
use tilescope_gpu::{self as gpu, ASKED_FOR, Backend, Bands, Choice, Gpu};

use crate::control::Control;
use crate::error::ReproduceError;
use crate::machine::gpus;

/// Sets along each side of what is made of nine.
const ALONG: u32 = 3;

/// Who makes a set.
#[derive(Clone, Debug, PartialEq)]
pub enum Engine {
    /// The reference sampler, on one thread.
    Reference,
    /// Nine sets of the reference sampler, on all threads, combined.
    Combined,
    /// The sequential engine, on one thread.
    Sequential,
    /// The parallel engine, on one thread or on all.
    Parallel { all: bool },
    /// The engine on a GPU, by its name.
    Gpu { adapter: String },
}

impl Engine {
    /// Returns its name, without the leaf.
    pub fn name(&self) -> String {
        match self {
            Self::Reference => "reference".to_owned(),
            Self::Combined => format!("reference, {ALONG} x {ALONG} combined"),
            Self::Sequential => "KDRT, sequential".to_owned(),
            Self::Parallel { .. } => "KDRT, parallel".to_owned(),
            Self::Gpu { adapter } => format!("KDRT, {adapter}"),
        }
    }

    /// Returns how many threads of the processor it uses; none for a GPU.
    pub fn threads(&self) -> Option<usize> {
        match self {
            Self::Combined | Self::Parallel { all: true } => Some(rayon::current_num_threads()),
            Self::Gpu { .. } => None,
            _ => Some(1),
        }
    }
}

/// Engines at hand: one thread, and open GPUs.
pub struct Engines {
    one: ThreadPool,
    gpus: Vec<Arc<Gpu>>,
}

impl Engines {
    /// Returns them; opens every GPU.
    pub fn open() -> Result<Self, ReproduceError> {
        let one = ThreadPoolBuilder::new().num_threads(1).build();
        let gpus = gpus().iter().map(|gpu| {
            let choice = Choice {
                name: Some(gpu.name.clone()),
                ..Choice::default()
            };
            block_on(Gpu::open(&choice)).map(Arc::new).map_err(failed)
        });
        Ok(Self {
            one: one.map_err(failed)?,
            gpus: gpus.collect::<Result<_, _>>()?,
        })
    }

    /// Makes a set.
    pub fn make(
        &self,
        engine: &Engine,
        parameters: &Parameters,
        pattern: &Arc<Pattern>,
        control: &Control<'_>,
    ) -> Result<Vec<Point>, ReproduceError> {
        let observer = &mut |_| control.flow();
        let domain = parameters.validate()?;
        let by_bands = |engine| by_bands(engine, parameters, pattern, control);
        let points = match engine {
            Engine::Reference => reference_sample(domain, parameters.seed, observer)?,
            Engine::Combined => combined(domain, parameters.seed, control)?,
            Engine::Sequential => {
                let engine = Sequential::new(parameters, Arc::clone(pattern))?;
                engine.finish(observer)?.points()
            }
            Engine::Parallel { all: true } => by_bands(gpu::Engine::Parallel)?,
            Engine::Parallel { all: false } => {
                self.one.install(|| by_bands(gpu::Engine::Parallel))?
            }
            Engine::Gpu { adapter } => by_bands(gpu::Engine::Gpu(self.gpu(adapter)?))?,
        };
        Ok(points)
    }

    /// Returns an open GPU by its name.
    pub fn gpu(&self, adapter: &str) -> Result<Arc<Gpu>, ReproduceError> {
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
) -> Result<Vec<Point>, ReproduceError> {
    let backend = Backend::new(engine, ASKED_FOR);
    let made = block_on(async {
        let bands = Bands::new(parameters, pattern, false, &backend, |_| {}).await?;
        bands.finish(&mut control.observer()).await
    });
    match made {
        Ok((sampled, ..)) => Ok(sampled.points),
        Err(error) => Err(failed(error.of_device()?)),
    }
}

fn combined(
    domain: Domain,
    seed: u64,
    control: &Control<'_>,
) -> Result<Vec<Point>, ReproduceError> {
    let pieces = nine(domain, seed, control)?;
    let options = CombineOptions::default();
    Ok(combine(domain, &pieces, &options, &mut control.observer())?.points)
}

/// Returns the rectangles of nine sets that fill a domain.
pub fn nine_rects(domain: &Domain) -> Vec<Rect> {
    grid(domain, ALONG, ALONG)
}

/// Makes nine periodic sets with the reference sampler, each with a seed of its own, on all threads.
pub fn nine(
    domain: Domain,
    seed: u64,
    control: &Control<'_>,
) -> Result<Vec<Piece>, ReproduceError> {
    let rects = nine_rects(&domain).into_par_iter().enumerate();
    rects
        .map(|(index, rect)| {
            let own = Domain::of_rect(&rect, Boundary::Periodic)?;
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
            let engines = Engines::open()?;
            let make = |engine| engines.make(&engine, &parameters, &pattern, control);
            let all = make(Engine::Parallel { all: true })?;
            assert_eq!(all, make(Engine::Parallel { all: false })?);
            assert_eq!(all, make(Engine::Sequential)?);
            assert_ne!(all, make(Engine::Reference)?);
            assert_ne!(all, make(Engine::Combined)?);
            let nowhere = Engine::Gpu {
                adapter: "none of that name".to_owned(),
            };
            assert!(make(nowhere).is_err());
            Ok(())
        });
    }
}
