//! The GPU for sampling: the choice of the engine, whether the device was opened and passed its self-test, and whether the
//! next run may use it after a failure. `state/gpu.rs` has the commands; `tilescope_gpu` tests and computes.

use std::sync::Arc;

use tilescope_gpu::{Choice, Gpu, GpuError, SelfTest, self_test};

use tilescope_session::jobs::Job;
use tilescope_session::words::sentence;

/// The engine that the user chose for runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EngineChoice {
    /// Chosen by the program: the CPU, or on a page a GPU that passed its test.
    #[default]
    Auto,
    /// The CPU, also where there is a GPU.
    Cpu,
    /// The GPU, once it has passed its test.
    Gpu,
}

/// A device that was opened, and its test.
pub struct Tried {
    /// The device, ready to compute.
    pub gpu: Arc<Gpu>,
    /// The result of its test.
    pub test: SelfTest,
}

/// The state of the GPU.
#[derive(Default)]
pub enum Device {
    /// It was not requested yet.
    #[default]
    Unknown,
    /// It is being opened and tested.
    Testing(Job<Result<Tried, GpuError>>),
    /// It passed its test.
    Ready(Tried),
    /// It cannot be used, and why.
    Refused(String),
}

/// Why the passes cannot be run while no GPU was opened.
pub const CHOOSE_GPU_FIRST: &str =
    "Choose the GPU as the engine first: it is opened and tested then.";

impl Device {
    /// Returns the device that passed its test.
    #[must_use]
    pub const fn ready(&self) -> Option<&Arc<Gpu>> {
        match self {
            Self::Ready(tried) => Some(&tried.gpu),
            _ => None,
        }
    }

    /// Returns its state, in a word.
    #[must_use]
    pub const fn word(&self) -> &'static str {
        match self {
            Self::Unknown => "unknown",
            Self::Testing(_) => "testing",
            Self::Ready(_) => "ready",
            Self::Refused(_) => "refused",
        }
    }

    /// Returns its name, once known.
    #[must_use]
    pub fn name(&self) -> Option<&str> {
        self.ready().map(|gpu| gpu.report().name.as_str())
    }

    /// Returns why it cannot be chosen, if so.
    #[must_use]
    pub fn refusal(&self) -> Option<&str> {
        match self {
            Self::Refused(reason) => Some(reason),
            _ => None,
        }
    }

    /// Returns its state in a sentence, unless it was not requested yet.
    #[must_use]
    pub fn description(&self) -> Option<String> {
        match self {
            Self::Unknown => None,
            Self::Testing(_) => Some("The GPU is being opened and tested.".to_owned()),
            Self::Ready(tried) => {
                let report = tried.gpu.report();
                let remark = if report.is_software {
                    ", which computes on the CPU"
                } else {
                    ""
                };
                let verdict = sentence(&tried.test.verdict);
                Some(format!(
                    "{}{remark}: self-test passed. {verdict}",
                    report.name
                ))
            }
            Self::Refused(reason) => Some(reason.clone()),
        }
    }

    /// Returns why the device cannot be used now, or `None` if it is ready.
    pub(crate) fn not_ready(&self) -> Option<String> {
        match self {
            Self::Ready(_) => None,
            Self::Unknown => Some(CHOOSE_GPU_FIRST.to_owned()),
            device => device.description(),
        }
    }

    /// Returns the state after opening and testing.
    pub(crate) fn from_test(outcome: Result<Result<Tried, GpuError>, String>) -> Self {
        match outcome {
            Ok(Ok(tried)) if tried.test.passed => Self::Ready(tried),
            Ok(Ok(tried)) => Self::Refused(format!(
                "{}: self-test failed. {}",
                tried.gpu.report().name,
                sentence(&tried.test.verdict)
            )),
            Ok(Err(error)) => Self::Refused(sentence(&error.to_string())),
            Err(failure) => Self::Refused(sentence(&failure)),
        }
    }

    /// Notes a failure in a run. A device that was lost, or had no memory left, may be opened again; a run that did not
    /// fit changes nothing; after any other failure the device is not used again.
    pub fn failed(&mut self, error: &GpuError) {
        match error {
            GpuError::NotInOneGo { .. }
            | GpuError::TooLittleMemory { .. }
            | GpuError::ExactTooLarge { .. } => {}
            GpuError::DeviceLost { .. } | GpuError::OutOfMemory => *self = Self::Unknown,
            error => *self = Self::Refused(sentence(&error.to_string())),
        }
    }
}

/// Opens the adapter that `choice` names, and tests it.
pub(crate) async fn open_and_test(choice: Choice) -> Result<Tried, GpuError> {
    let gpu = Arc::new(Gpu::open(&choice).await?);
    let test = self_test(&gpu).await?;
    Ok(Tried { gpu, test })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lost_device_may_be_opened_again_and_a_faulty_one_may_not() {
        let reason = "gone".to_owned();
        let mut device = Device::Refused("before".to_owned());
        device.failed(&GpuError::DeviceLost {
            reason: reason.clone(),
        });
        assert!(matches!(device, Device::Unknown));
        device.failed(&GpuError::NotInOneGo {
            needed: 2,
            allowed: 1,
        });
        assert!(matches!(device, Device::Unknown));
        device.failed(&GpuError::Refused { reason });
        assert!(device.refusal().unwrap().contains("gone"));
        assert_eq!(device.description().as_deref(), device.refusal());
    }
}
