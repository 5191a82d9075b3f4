//! The report of a pass: its name, workgroups, buffers and time.

use tilescope_core::Stage;

use crate::layout::{Access, Name};

/// How much is recorded for inspection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Recording {
    /// Nothing is recorded, as in a run for its result alone.
    Nothing,
    /// Reports of passes alone.
    Passes,
    /// Reports of passes, and the buffers that stages leave behind.
    Stages,
}

/// The report of one pass.
#[derive(Clone, Debug, PartialEq)]
pub struct PassReport {
    /// The stage it belongs to.
    pub stage: Stage,
    /// Its name: that of its shader.
    pub name: &'static str,
    /// Whether the device computed how many workgroups there are, from the length of a list.
    pub indirect: bool,
    /// Workgroups on each axis; `None` for an indirect pass whose arguments the host did not read back.
    pub workgroups: Option<[u32; 3]>,
    /// Invocations, if the workgroups are known.
    pub invocations: Option<u64>,
    /// The buffers that it used, how, and their lengths in bytes.
    pub bindings: Vec<(Name, Access, u64)>,
    /// Seconds on the device, if the adapter measures them.
    pub seconds: Option<f64>,
}

impl PassReport {
    /// Returns the least bytes that a pass over all elements moves: each buffer once, or twice if it is both read and
    /// written. `None` for indirect passes, which visit only a list.
    #[must_use]
    pub fn bytes(&self) -> Option<u64> {
        let moved = |&(_, access, length): &(Name, Access, u64)| match access {
            Access::Uniform => 0,
            Access::Read | Access::Write => length,
            Access::Update | Access::Atomic => 2 * length,
        };
        (!self.indirect).then(|| self.bindings.iter().map(moved).sum())
    }
}
