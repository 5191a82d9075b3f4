//! Everything that can go wrong on a device, one variant a cause.

use thiserror::Error;
use tilescope_core::{ParameterError, SampleError};

/// Why the GPU engine gives no result.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum GpuError {
    /// There is no adapter at all.
    #[error("no GPU adapter was found: {reason}")]
    NoAdapter {
        /// What the system says.
        reason: String,
    },
    /// No adapter has the wanted name.
    #[error("no GPU adapter is called {wanted:?}; there are: {}", found.join(", "))]
    NoSuchAdapter {
        /// What was asked for.
        wanted: String,
        /// The names of those that are there.
        found: Vec<String>,
    },
    /// The only adapters compute on the CPU.
    #[error("the only GPU adapter is {name}, which computes on the CPU; name it to use it")]
    SoftwareOnly {
        /// Its name.
        name: String,
    },
    /// An adapter gives no device.
    #[error("the adapter {name} gives no device: {reason}")]
    NoDevice {
        /// Its name.
        name: String,
        /// What the driver says.
        reason: String,
    },
    /// The device cannot do what every run needs.
    #[error("the adapter {name} allows {limit} = {value}; the engine needs at least {minimum}")]
    LimitTooLow {
        /// The adapter's name.
        name: String,
        /// The limit, as WebGPU names it.
        limit: &'static str,
        /// What the adapter allows.
        value: u64,
        /// What the engine needs.
        minimum: u64,
    },
    /// Even the smallest window is too large for the memory that may be used.
    #[error(
        "a window of {cells} x {cells} cells needs {needed} bytes on the device; {limit} allows {allowed}"
    )]
    TooLittleMemory {
        /// Cells along the side of the window.
        cells: u32,
        /// Bytes of the buffer or of all buffers that do not fit.
        needed: u64,
        /// Which limit it is.
        limit: &'static str,
        /// What it allows.
        allowed: u64,
    },
    /// A run that is to be kept stage by stage does not fit in one go.
    #[error(
        "a run of {needed} x {needed} cells does not fit the device in one go ({allowed} x {allowed} do), so that its stages cannot be looked at; its result can be computed in windows"
    )]
    NotInOneGo {
        /// Cells along the longer side, with what is computed around the domain.
        needed: u32,
        /// Cells along the side that the device can take.
        allowed: u32,
    },
    /// The driver has no memory left.
    #[error("the device has no memory left; choose another engine")]
    OutOfMemory,
    /// The device is gone: removed, reset, or taken away by the system.
    #[error("the device was lost: {reason}")]
    DeviceLost {
        /// What the driver says.
        reason: String,
    },
    /// The driver refuses a command: a fault of the program.
    #[error("the device refuses a command: {reason}; this is a fault of the program")]
    Refused {
        /// What the driver says.
        reason: String,
    },
    /// A pass met what cannot happen: a fault of the program or of the driver.
    #[error(
        "the stage {stage} met on the device what cannot happen (fault {code}); use another engine"
    )]
    Fault {
        /// The stage in which the counters showed it.
        stage: tilescope_core::Stage,
        /// What was met, as `FAULTS` in the crate's constants numbers it.
        code: u32,
    },
    /// A stage was asked for that the GPU does not run, or an order of stages that makes no sense.
    #[error("the GPU cannot begin with the stage {stage}")]
    FirstStage {
        /// The stage.
        stage: tilescope_core::Stage,
    },
    /// The run itself fails, on any engine.
    #[error(transparent)]
    Sample(#[from] SampleError),
}

impl From<ParameterError> for GpuError {
    fn from(error: ParameterError) -> Self {
        Self::Sample(error.into())
    }
}

impl GpuError {
    /// Returns whether another engine may well succeed: the device fails, not the run. That goes for samples that
    /// depend on too much around them, too: other engines look farther.
    #[must_use]
    pub const fn is_of_the_device(&self) -> bool {
        !matches!(self, Self::Sample(error) if !matches!(error, SampleError::Entangled { .. }))
    }
}
