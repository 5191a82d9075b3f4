//! Errors of the GPU engine, with one variant for each cause.

use thiserror::Error;
use tilescope_core::{ParameterError, SampleError};

/// Why the GPU engine gives no result.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum GpuError {
    /// The program was built without the feature `gpu`.
    #[error(
        "this build has no GPU engine; build the program with its feature gpu, or choose another engine"
    )]
    NotBuilt,
    /// There is no adapter at all.
    #[error("no GPU adapter was found: {reason}")]
    NoAdapter {
        /// The reason, from the system.
        reason: String,
    },
    /// No adapter has the wanted name.
    #[error("no GPU adapter is called {wanted:?}; the adapters are: {}", found.join(", "))]
    NoSuchAdapter {
        /// The name that was asked for.
        wanted: String,
        /// The names of the existing adapters.
        found: Vec<String>,
    },
    /// The only adapters compute on the CPU.
    #[error("the only GPU adapter is {name}, which computes on the CPU; name it to use it")]
    SoftwareOnly {
        /// The name of that adapter.
        name: String,
    },
    /// An adapter could not open a device.
    #[error("the adapter {name} could not open a device: {reason}")]
    NoDevice {
        /// The name of the adapter.
        name: String,
        /// The message of the driver.
        reason: String,
    },
    /// A limit of the device is too low for any run.
    #[error("the adapter {name} allows {limit} = {value}; the engine needs at least {minimum}")]
    LimitTooLow {
        /// The name of the adapter.
        name: String,
        /// The limit, as WebGPU names it.
        limit: &'static str,
        /// What the adapter allows.
        value: u64,
        /// What the engine needs.
        minimum: u64,
    },
    /// A window is too large for the memory that may be used.
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
        /// What the limit allows.
        allowed: u64,
    },
    /// An exact tiling, which is made in one go, is too large for the memory that may be used.
    #[error(
        "an exact tiling of {width} x {height} cells of side r needs {needed} {unit} on the device; {limit} allows {allowed}; another engine can make it"
    )]
    ExactTooLarge {
        /// Cells of side r in a row of the domain.
        width: u32,
        /// Rows of cells.
        height: u32,
        /// How much does not fit, in `unit`s: bytes of the longest buffer or of all, or pieces of blocks.
        needed: u64,
        /// The name of the counted things.
        unit: &'static str,
        /// Which limit it is.
        limit: &'static str,
        /// What the limit allows.
        allowed: u64,
    },
    /// A run whose stages are recorded must fit the device in one window, and does not.
    #[error(
        "a run of {needed} x {needed} cells does not fit the device in one go ({allowed} x {allowed} do), so its stages cannot be inspected; its result can still be computed in windows"
    )]
    NotInOneGo {
        /// Cells along the longer side of the domain.
        needed: u32,
        /// Cells along the longest side that fits the device.
        allowed: u32,
    },
    /// The driver has no memory left.
    #[error("the device has no memory left; choose another engine")]
    OutOfMemory,
    /// The device is lost: removed, reset, or revoked by the system.
    #[error("the device was lost: {reason}")]
    DeviceLost {
        /// The message of the driver.
        reason: String,
    },
    /// The driver rejected a command: a bug in this program.
    #[error("the device rejected a command: {reason}; this is a bug in the program")]
    Refused {
        /// The message of the driver.
        reason: String,
    },
    /// A pass found its data inconsistent: a bug in this program or in the driver.
    #[error(
        "the data of the stage {stage} on the device is inconsistent (fault {code}); use another engine"
    )]
    Fault {
        /// The stage in which the counters showed it.
        stage: tilescope_core::Stage,
        /// The kind of fault, numbered by `FAULTS` in constants.rs.
        code: u32,
    },
    /// The GPU cannot begin with the requested stage.
    #[error("the GPU cannot begin with the stage {stage}")]
    FirstStage {
        /// The stage that was asked for.
        stage: tilescope_core::Stage,
    },
    /// The run itself fails, whatever the engine.
    #[error(transparent)]
    Sample(#[from] SampleError),
}

impl From<ParameterError> for GpuError {
    fn from(error: ParameterError) -> Self {
        Self::Sample(error.into())
    }
}

impl GpuError {
    /// Returns the error where another engine can take over.
    ///
    /// Fails with the run's own error where the run fails on any engine.
    pub fn of_device(self) -> Result<Self, SampleError> {
        match self {
            Self::Sample(error) => Err(error),
            error => Ok(error),
        }
    }
}
