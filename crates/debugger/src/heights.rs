//! How high the samples of a run in space lie; `space.rs` has the runs.

/// How high the samples of a run in space lie.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Heights {
    /// Where each sample lies along the third axis, in units.
    pub(crate) all: Vec<i32>,
    /// The third side of a periodic box, in units.
    pub(crate) period: Option<i32>,
}

impl Heights {
    /// Returns how far above a place of the third axis a sample lies, in units; around a periodic box by the shorter way.
    pub(crate) fn above(&self, sample: u32, z: i32) -> Option<i32> {
        let straight = self.all.get(sample as usize)? - z;
        // A period has at least four radii, so that a longer way is never within one.
        Some(match self.period {
            Some(period) if straight > period / 2 => straight - period,
            Some(period) if straight < -period / 2 => straight + period,
            Some(_) | None => straight,
        })
    }
}
