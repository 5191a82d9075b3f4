//! The part of the KD-tree that exists at a moment.

use tilescope_core::{RunEvent, Stage};
use tilescope_session::moment::ShownMoment;

/// The numbers of splits and leaves that exist at a moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Made {
    /// The number of splits.
    pub splits: usize,
    /// The number of leaves, which are the blocks.
    pub leaves: usize,
}

impl Made {
    /// Returns the counts at a moment: all, unless the moment lies within the stage that makes them.
    #[must_use]
    pub fn at(shown: &ShownMoment<'_>) -> Self {
        let blocks = &shown.session.run().blocks;
        let mut made = Self {
            splits: blocks.splits.len(),
            leaves: blocks.leaves.len(),
        };

        // Without events only whole stages are shown.
        let Some(debugger) = shown.debugger else {
            return made;
        };

        // The tape begins with the events of the blocks. They are few, so that they are counted anew each time.
        if shown.stage == Stage::Blocks && !shown.ends_stage() {
            (made.splits, made.leaves) = (0, 0);
            let tape = debugger.recording().tape();
            for (_, event) in tape.from(0).take(shown.cursor()) {
                match event.run_event() {
                    Some(RunEvent::Split { .. }) => made.splits += 1,
                    Some(RunEvent::Leaf { .. }) => made.leaves += 1,
                    // Other events make neither.
                    _ => {}
                }
            }
        }

        made
    }
}
