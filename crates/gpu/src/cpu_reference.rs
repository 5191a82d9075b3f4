//! The CPU reference of a run on a device: core's sequential engine, run to the same stage and compared with the
//! device's data. Differences are reported, never repaired.

use std::fmt::{self, Debug};
use std::sync::Arc;

use tilescope_core::{Observer, Parameters, Pattern, Run, SampleError, Sequential, Stage};

/// The most characters of a differing element that are quoted.
const MAX_QUOTED: usize = 120;

/// The first difference between a run on the device and the same run on the CPU.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunDifference {
    /// Which list: blocks, tiles, points, origins, fates, iterations or result.
    pub list: &'static str,
    /// The index in the list; `None` if the list has no indices.
    pub index: Option<usize>,
    /// The element on the device; empty past the end of its list, and if the list has no indices.
    pub device: String,
    /// The element on the CPU; empty past the end of its list, and if the list has no indices.
    pub cpu: String,
}

impl fmt::Display for RunDifference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.list)?;
        let Some(index) = self.index else {
            return Ok(());
        };
        let or_nothing = |text: &str| match text {
            "" => "nothing".to_owned(),
            text => text.to_owned(),
        };

        let (device, cpu) = (or_nothing(&self.device), or_nothing(&self.cpu));
        write!(f, " at {index}: {device} on the device, {cpu} on the CPU")
    }
}

/// The sequential engine beside a [`crate::Stepper`] of the same parameters and pattern.
pub struct CpuReference {
    engine: Sequential,
    done: Option<Stage>,
}

impl CpuReference {
    /// Returns the reference before its first stage.
    ///
    /// Fails when the sequential engine rejects the parameters.
    pub fn new(parameters: &Parameters, pattern: &Arc<Pattern>) -> Result<Self, SampleError> {
        Ok(Self {
            engine: Sequential::new(parameters, Arc::clone(pattern))?,
            done: None,
        })
    }

    /// Runs to the end of `stage`. Does nothing if that stage is already done.
    ///
    /// Fails when the engine does, and when the observer stops it.
    pub fn advance(
        &mut self,
        stage: Stage,
        observer: &mut dyn Observer,
    ) -> Result<(), SampleError> {
        // The sequential engine has no stage for an iteration that finds nothing. If such an iteration is asked for,
        // the engine's next stage comes after it, and is not run.
        while self.done < Some(stage) && self.engine.next().is_some_and(|next| next <= stage) {
            match self.engine.step(observer)? {
                Some(ran) => self.done = Some(ran),
                None => break,
            }
        }

        Ok(())
    }

    /// Returns the first difference from a device's run after `stage`, or `None` if they are equal. The reference must
    /// have been advanced to that stage.
    #[must_use]
    pub fn compare(&self, stage: Stage, device: &Run) -> Option<RunDifference> {
        let cpu = self.engine.run();
        // The sequential engine may have its result earlier than the device has written it.
        let result = if stage == Stage::Finish {
            &cpu.result[..]
        } else {
            &[]
        };
        first_difference(device, cpu, result)
    }

    /// Returns whether all stages have been run.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.engine.next().is_none()
    }
}

/// Returns the first difference between two runs after the same stage, or `None` if they are equal.
#[must_use]
pub fn difference(device: &Run, cpu: &Run) -> Option<RunDifference> {
    first_difference(device, cpu, &cpu.result)
}

/// Returns the first difference between the lists of two runs. `result` is the CPU's, or empty before the stage in
/// which the device writes its own.
fn first_difference(device: &Run, cpu: &Run, result: &[u32]) -> Option<RunDifference> {
    if device.blocks != cpu.blocks {
        return Some(RunDifference {
            // A tree of blocks differs as a whole: it has no index, and is too long to quote.
            list: "blocks",
            index: None,
            device: String::new(),
            cpu: String::new(),
        });
    }

    // In the sequence in which stages write these lists, so that the earliest difference is the one reported.
    let (a, b) = (&device.samples, &cpu.samples);
    in_list("tiles", &device.tiles, &cpu.tiles)
        .or_else(|| in_list("points", &a.points, &b.points))
        .or_else(|| in_list("origins", &a.origins, &b.origins))
        .or_else(|| in_list("fates", &a.fates, &b.fates))
        .or_else(|| in_list("iterations", &device.iterations, &cpu.iterations))
        .or_else(|| in_list("result", &device.result, result))
}

/// Returns the first difference between two lists.
pub(crate) fn in_list<T: PartialEq + Debug>(
    list: &'static str,
    device: &[T],
    cpu: &[T],
) -> Option<RunDifference> {
    if device == cpu {
        return None;
    }
    // If one list is the beginning of the other, they differ at the first element that only one has.
    let shorter = device.len().min(cpu.len());
    let index = device
        .iter()
        .zip(cpu)
        .position(|(a, b)| a != b)
        .unwrap_or(shorter);

    let quoted = |of: &[T]| of.get(index).map_or_else(String::new, quote);
    Some(RunDifference {
        list,
        index: Some(index),
        device: quoted(device),
        cpu: quoted(cpu),
    })
}

/// Returns an element as text, of which the end is cut off if it is long.
fn quote(element: &impl Debug) -> String {
    let text = format!("{element:?}");
    match text.char_indices().nth(MAX_QUOTED) {
        Some((end, _)) => format!("{}\u{2026}", &text[..end]),
        None => text,
    }
}
