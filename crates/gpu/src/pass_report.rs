//! What a pass did, for whoever looks at passes or times them. It is filled where passes are executed.

use tilescope_core::Stage;

use crate::layout::{Access, Name};

/// What a pass did.
#[derive(Clone, Debug, PartialEq)]
pub struct PassReport {
    /// The stage it belongs to.
    pub stage: Stage,
    /// Its name: that of its shader.
    pub name: &'static str,
    /// Whether the device computed how many workgroups there are, from the length of a list.
    pub indirect: bool,
    /// Workgroups on each axis; `None` of indirect passes that ran without the host waiting for each.
    pub workgroups: Option<[u32; 3]>,
    /// Invocations, where the workgroups are known.
    pub invocations: Option<u64>,
    /// The buffers that it saw, what for, and their lengths in bytes.
    pub bindings: Vec<(Name, Access, u64)>,
    /// Seconds on the device, where the adapter measures them.
    pub seconds: Option<f64>,
}

impl PassReport {
    /// Returns the bytes that a pass over all elements moves at least: every buffer that it sees once, those that it
    /// both reads and writes twice. `None` of indirect passes, which go over lists.
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
