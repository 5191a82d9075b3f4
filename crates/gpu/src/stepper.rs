//! A run in one go that can be stopped after any pass and looked at.

use std::sync::Arc;

use tilescope_core::{Parameters, Pattern, Run, Stage};

use crate::adapter::Gpu;
use crate::error::GpuError;
use crate::layout::{Access, Name};

/// What a pass did.
#[derive(Clone, Debug, PartialEq)]
pub struct PassReport {
    /// The stage it belongs to.
    pub stage: Stage,
    /// Its name: that of its shader.
    pub name: &'static str,
    /// Workgroups on each axis; `None` where the device computed them.
    pub workgroups: Option<[u32; 3]>,
    /// Invocations, where the host knows them.
    pub invocations: Option<u64>,
    /// The buffers that it saw, what for, and their lengths in bytes.
    pub bindings: Vec<(Name, Access, u64)>,
    /// Seconds on the device, where the adapter measures them.
    pub seconds: Option<f64>,
}

/// A buffer's content as a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Names of the columns.
    pub columns: Vec<&'static str>,
    /// The rows, a number a column.
    pub rows: Vec<Vec<i64>>,
    /// Rows in the buffer, of which `rows` may hold but the first.
    pub total: u64,
}

/// A run on a GPU between two passes.
pub struct Stepper {}

impl Stepper {
    /// Returns a run that has done nothing yet. Stages before `first_gpu_stage` will run on the CPU.
    pub async fn new(
        _gpu: Arc<Gpu>,
        _parameters: &Parameters,
        _pattern: &Arc<Pattern>,
        _first_gpu_stage: Stage,
    ) -> Result<Self, GpuError> {
        todo!()
    }

    /// Runs one pass and reports it, or returns `None` when the run is finished.
    pub async fn step_pass(&mut self) -> Result<Option<PassReport>, GpuError> {
        todo!()
    }

    /// Runs to the end of a stage and returns it, or `None` when the run is finished.
    pub async fn step(&mut self) -> Result<Option<Stage>, GpuError> {
        todo!()
    }

    /// Returns the passes so far.
    #[must_use]
    pub fn reports(&self) -> &[PassReport] {
        todo!()
    }

    /// Returns the run so far as core's engines would have it after the last whole stage.
    pub async fn run(&self) -> Result<Run, GpuError> {
        todo!()
    }

    /// Returns the first `rows` rows of a buffer as a table.
    pub async fn table(&self, _name: Name, _rows: u64) -> Result<Table, GpuError> {
        todo!()
    }
}
