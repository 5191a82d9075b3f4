//! A whole run as windows, band by band: the counterpart of core's `Sweep`, with the same result.

use std::sync::Arc;

use tilescope_core::{Domain, Observer, Parameters, Pattern, Run, Sampled, Summary, SweepState};

use crate::adapter::Gpu;
use crate::error::GpuError;

/// What a run may use and is asked to keep.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// The most bytes of device memory to use at once; a share of what the adapter allows, if not given.
    pub memory: Option<u64>,
    /// Whether samples say where they come from.
    pub sources: bool,
}

/// A run in progress on a GPU, band by band. The bands, one after the other, are the result in
/// canonical order, equal to every other engine's.
pub struct GpuSweep {
    domain: Domain,
}

impl GpuSweep {
    /// Returns a run at its beginning.
    pub async fn new(
        _gpu: Arc<Gpu>,
        parameters: &Parameters,
        _pattern: &Arc<Pattern>,
        _options: Options,
    ) -> Result<Self, GpuError> {
        Ok(Self {
            domain: parameters.validate()?,
        })
    }

    /// Returns the domain.
    #[must_use]
    pub const fn domain(&self) -> &Domain {
        &self.domain
    }

    /// Returns how many rows of cells have been computed, of how many.
    #[must_use]
    pub fn rows(&self) -> (u32, u32) {
        todo!()
    }

    /// Returns where the run is, to go on from there in another process, with any engine.
    #[must_use]
    pub fn state(&self) -> SweepState {
        todo!()
    }

    /// Goes on from a state of a run of the same parameters and pattern.
    pub fn restore(&mut self, _state: &SweepState) {
        todo!()
    }

    /// Returns the counts of all bands so far.
    #[must_use]
    pub fn summary(&self) -> Summary {
        todo!()
    }

    /// Computes the next band and returns its samples, or `None` at the end.
    pub async fn step(
        &mut self,
        _observer: &mut dyn Observer,
    ) -> Result<Option<Sampled>, GpuError> {
        todo!()
    }

    /// Runs to the end and returns the samples of all bands that are left, and the run's summary.
    pub async fn finish(
        self,
        _observer: &mut dyn Observer,
    ) -> Result<(Sampled, Summary), GpuError> {
        todo!()
    }

    /// Returns a finished run that knows its blocks, its result and its counts, as core's `Sweep::run`.
    pub async fn run(
        _gpu: Arc<Gpu>,
        _parameters: &Parameters,
        _pattern: &Arc<Pattern>,
        _observer: &mut dyn Observer,
    ) -> Result<Run, GpuError> {
        todo!()
    }
}
