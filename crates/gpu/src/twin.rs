//! The CPU's twin of a run on a device: core's sequential engine, brought to the same stage and compared with what
//! lies on the device. It never repairs what differs.

use std::fmt::{self, Debug};
use std::sync::Arc;

use tilescope_core::{Observer, Parameters, Pattern, Run, SampleError, Sequential, Stage};

/// The longest piece of a differing element that a sentence quotes, in characters.
const MAX_QUOTED: usize = 120;

/// The first thing in which a device's run differs from the CPU's.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Which list: blocks, tiles, points, origins, fates, iterations or result.
    pub list: &'static str,
    /// The first place of the list at which they differ; `None` where the list is no sequence of equal elements.
    pub place: Option<usize>,
    /// What the device has there; empty where its list has ended.
    pub device: String,
    /// What the CPU has there; empty where its list has ended.
    pub cpu: String,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.list)?;
        let Some(place) = self.place else {
            return Ok(());
        };
        let or_nothing = |text: &str| match text {
            "" => "nothing".to_owned(),
            text => text.to_owned(),
        };
        let (device, cpu) = (or_nothing(&self.device), or_nothing(&self.cpu));
        write!(f, " at {place}: {device} on the device, {cpu} on the CPU")
    }
}

/// The sequential engine beside a [`crate::Stepper`] of the same parameters and pattern.
pub struct Twin {
    engine: Sequential,
    done: Option<Stage>,
}

impl Twin {
    /// Returns a twin that has done nothing yet.
    ///
    /// Fails when the sequential engine refuses the parameters.
    pub fn new(parameters: &Parameters, pattern: &Arc<Pattern>) -> Result<Self, SampleError> {
        Ok(Self {
            engine: Sequential::new(parameters, Arc::clone(pattern))?,
            done: None,
        })
    }

    /// Runs to the end of `stage`. It never goes back: a stage before the one reached leaves it where it is.
    ///
    /// Fails as the engine, and when the observer stops it.
    pub fn advance(
        &mut self,
        stage: Stage,
        observer: &mut dyn Observer,
    ) -> Result<(), SampleError> {
        // An iteration that finds nothing is no stage of the sequential engine.
        while self.done < Some(stage)
            && (stage == Stage::Finish || self.engine.next().is_some_and(|next| next <= stage))
        {
            match self.engine.step(observer)? {
                Some(ran) => self.done = Some(ran),
                None => break,
            }
        }
        Ok(())
    }

    /// Returns the first difference between a device's run after `stage` and this one, which must have been advanced
    /// to it; `None` where all is equal.
    #[must_use]
    pub fn compare(&self, stage: Stage, device: &Run) -> Option<Difference> {
        let cpu = self.engine.run();
        // The sequential engine may know its result before the device has put it into its sequence.
        let result = if stage == Stage::Finish {
            &cpu.result[..]
        } else {
            &[]
        };
        first_difference(device, cpu, result)
    }

    /// Returns whether the CPU has no stage left to run.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.engine.next().is_none()
    }
}

/// Returns the first difference between two runs after the same stage; `None` where all is equal.
#[must_use]
pub fn difference(device: &Run, cpu: &Run) -> Option<Difference> {
    first_difference(device, cpu, &cpu.result)
}

fn first_difference(device: &Run, cpu: &Run, result: &[u32]) -> Option<Difference> {
    if device.blocks != cpu.blocks {
        return Some(Difference {
            list: "blocks",
            place: None,
            device: String::new(),
            cpu: String::new(),
        });
    }
    let (a, b) = (&device.samples, &cpu.samples);
    in_list("tiles", &device.tiles, &cpu.tiles)
        .or_else(|| in_list("points", &a.points, &b.points))
        .or_else(|| in_list("origins", &a.origins, &b.origins))
        .or_else(|| in_list("fates", &a.fates, &b.fates))
        .or_else(|| in_list("iterations", &device.iterations, &cpu.iterations))
        .or_else(|| in_list("result", &device.result, result))
}

fn in_list<T: PartialEq + Debug>(
    list: &'static str,
    device: &[T],
    cpu: &[T],
) -> Option<Difference> {
    if device == cpu {
        return None;
    }
    let shorter = device.len().min(cpu.len());
    let place = device.iter().zip(cpu).position(|(a, b)| a != b);
    let place = place.unwrap_or(shorter);
    let quoted = |of: &[T]| of.get(place).map_or_else(String::new, quote);
    Some(Difference {
        list,
        place: Some(place),
        device: quoted(device),
        cpu: quoted(cpu),
    })
}

fn quote(element: &impl Debug) -> String {
    let text = format!("{element:?}");
    match text.char_indices().nth(MAX_QUOTED) {
        Some((end, _)) => format!("{}\u{2026}", &text[..end]),
        None => text,
    }
}
