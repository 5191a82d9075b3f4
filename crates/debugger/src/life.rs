//! The status of samples, and the events that changed it.

use tilescope_core::RunEvent;

use crate::event::NONE;

/// The status of a sample at a cursor.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Status {
    /// It does not exist yet.
    Absent,
    /// It is tiled, valid and not yet decided.
    Undecided,
    /// It is valid and stays.
    Kept,
    /// It was eliminated by a kept sample.
    Eliminated,
    /// It was tiled outside a bounded domain.
    Dropped,
}

impl Status {
    /// Returns whether the sample covers its disk.
    #[must_use]
    pub const fn is_valid(self) -> bool {
        matches!(self, Self::Undecided | Self::Kept)
    }
}

/// The indices of the events that changed a sample, or [`NONE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Life {
    /// It was tiled or inserted.
    pub born: u32,
    /// It was kept; of an inserted sample, its insertion.
    pub kept: u32,
    /// It was eliminated or dropped.
    pub lost: u32,
    /// It became a detector.
    pub marked: u32,
}

/// The life of a sample before anything happened to it.
pub(crate) const UNBORN: Life = Life {
    born: NONE,
    kept: NONE,
    lost: NONE,
    marked: NONE,
};

/// Records in `lives` how the event of number `index` changes the status of a sample. The recording itself notes that a
/// sample becomes a detector, which is no change of status.
pub(crate) fn note_change(lives: &mut [Life], run_event: RunEvent, index: u32) {
    match run_event {
        RunEvent::Tiled { sample, inside, .. } => {
            let life = &mut lives[sample as usize];
            life.born = index;
            // A sample outside a bounded domain is dropped as it is tiled, without an event of its own.
            if !inside {
                life.lost = index;
            }
        }

        RunEvent::Keep { sample, .. } => lives[sample as usize].kept = index,
        RunEvent::Eliminate { sample, .. } => lives[sample as usize].lost = index,

        RunEvent::Insert { sample, .. } => {
            let life = &mut lives[sample as usize];
            // An inserted sample never awaits a decision.
            (life.born, life.kept) = (index, index);
        }

        // All other events change the status of no sample.
        _ => {}
    }
}
