//! Stands for [`crate::execute`] in a build without the feature `device`. A value of [`Device`] cannot exist.
#![allow(clippy::unused_async)] // As in a build with devices.

use std::ops::{Deref, DerefMut, Range};
use std::sync::Arc;

use tilescope_core::Stage;

use crate::error::GpuError;
use crate::layout::Name;
use crate::opened::Gpu;
use crate::pass_report::{PassReport, Recording};
use crate::passes::Command;
use crate::plan::{Phase, WindowPlan};
use crate::setup::Setup;

/// The buffers of a window. There are none in this build.
pub(crate) enum Device {}

/// The fields of a device.
pub(crate) struct Fields {
    pub highest_bytes: u64,
    pub swaps: u32,
    pub reports: Option<Vec<PassReport>>,
}

impl Deref for Device {
    type Target = Fields;

    fn deref(&self) -> &Fields {
        match *self {}
    }
}

impl DerefMut for Device {
    fn deref_mut(&mut self) -> &mut Fields {
        match *self {}
    }
}

impl Device {
    pub(crate) async fn new(
        gpu: &Arc<Gpu>,
        _: &Setup,
        _: &WindowPlan,
        _: Option<Self>,
        _: Recording,
    ) -> Result<Self, GpuError> {
        match **gpu {}
    }

    pub(crate) fn empty(gpu: &Arc<Gpu>, _: Recording) -> Result<Self, GpuError> {
        match **gpu {}
    }

    pub(crate) async fn hold(&mut self, _: Vec<(Name, u64)>) -> Result<(), GpuError> {
        match *self {}
    }

    pub(crate) async fn enter(
        &mut self,
        _: &Setup,
        _: &WindowPlan,
        _: Phase,
    ) -> Result<(), GpuError> {
        match *self {}
    }

    pub(crate) fn write(&self, _: Name, _: &[u8]) -> Result<(), GpuError> {
        match *self {}
    }

    pub(crate) fn set_word(&self, _: Name, _: u64, _: u32) {
        match *self {}
    }

    pub(crate) fn length(&self, _: Name) -> u64 {
        match *self {}
    }

    pub(crate) fn lengths(&self) -> Vec<(Name, u64)> {
        match *self {}
    }

    pub(crate) fn held_bytes(&self) -> u64 {
        match *self {}
    }

    pub(crate) async fn bytes(&self, _: Name, _: Range<u64>) -> Result<Vec<u8>, GpuError> {
        match *self {}
    }

    pub(crate) async fn words(&self, _: Name, _: Range<u64>) -> Result<Vec<u32>, GpuError> {
        match *self {}
    }

    pub(crate) fn submit(&mut self, _: &[Command], _: Stage) -> Result<(), GpuError> {
        match *self {}
    }

    pub(crate) async fn read_workgroups(&mut self, _: &Command) -> Result<(), GpuError> {
        match *self {}
    }

    pub(crate) async fn read_times(&mut self) -> Result<(), GpuError> {
        match *self {}
    }
}
