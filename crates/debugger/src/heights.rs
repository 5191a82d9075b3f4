//! The third axis of a run in space: its box, and how high samples and cubes lie. `space.rs` has the runs.

use tilescope_core::{Boundary, Run, SolidDomain};

/// What a run in space has besides its projection.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Heights {
    /// The box.
    pub(crate) domain: SolidDomain,
    /// Where each sample lies along the third axis, in units.
    pub(crate) all: Vec<i32>,
    /// Of each throw, where the lowest place of each active cube lies along the third axis, in units.
    pub(crate) cubes: Vec<Vec<i32>>,
}

impl Heights {
    /// Leaves what belongs to the first samples and throws, which a run has.
    pub(crate) fn of(mut self, run: &Run) -> Self {
        self.all.truncate(run.samples.len());
        self.cubes.truncate(run.iterations.len());

        // Where a throw is cut, its squares are gone, and with them the cubes above them.
        for (cubes, throw) in self.cubes.iter_mut().zip(&run.iterations) {
            cubes.truncate(throw.cells.len());
        }
        self
    }

    /// Returns how far above a place of the third axis a sample lies, in units; around a periodic box by the shorter way.
    pub(crate) fn above(&self, sample: u32, z: i32) -> Option<i32> {
        let straight = self.all.get(sample as usize)? - z;
        // The third side of a periodic box has at least four radii, so that a longer way is never within one.
        let is_periodic = self.domain.boundary() == Boundary::Periodic;
        Some(match is_periodic.then(|| self.domain.sides()[2]) {
            Some(period) if straight > period / 2 => straight - period,
            Some(period) if straight < -period / 2 => straight + period,
            Some(_) | None => straight,
        })
    }
}
