//! Stands for [`crate::opened`] in a build without the feature `device`: there is no adapter, and no device can be opened. A
//! value of [`Gpu`] cannot exist, so that the code that has one compiles and never runs.

use crate::adapter::{AdapterReport, Choice};
use crate::error::GpuError;

/// An open device. There is none in this build.
#[derive(Debug)]
pub enum Gpu {}

/// Returns no adapter: this build has no devices.
#[allow(clippy::unused_async)] // As in a build with devices.
pub async fn adapters() -> Vec<AdapterReport> {
    Vec::new()
}

impl Gpu {
    /// Returns [`GpuError::NotBuilt`] whatever is asked for.
    #[allow(clippy::unused_async)] // As in a build with devices.
    pub async fn open(_: &Choice) -> Result<Self, GpuError> {
        Err(GpuError::NotBuilt)
    }

    /// Returns the adapter's report.
    #[must_use]
    pub const fn report(&self) -> &AdapterReport {
        match *self {}
    }

    /// Copies bytes on the device.
    #[allow(clippy::unused_async)] // As in a build with devices.
    pub async fn copy(&self, _: u64, _: u32) -> Result<(), GpuError> {
        match *self {}
    }

    pub(crate) const fn check(&self) -> Result<(), GpuError> {
        match *self {}
    }
}
