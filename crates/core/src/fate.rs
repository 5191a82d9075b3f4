//! Whether a dart becomes a sample, as found by the first thread that asks.

use std::sync::atomic::{AtomicU8, Ordering};

/// What becomes of a dart, once it is decided.
///
/// Threads may decide at the same time. All of them find the same, so that it does not matter which one writes it, or how often.
#[derive(Debug)]
pub(crate) struct Fate(AtomicU8);

const UNDECIDED: u8 = 0;
const KEPT: u8 = 1;
const REFUSED: u8 = 2;

impl Fate {
    /// Returns the fate of a dart that is not decided yet.
    pub const fn undecided() -> Self {
        Self(AtomicU8::new(UNDECIDED))
    }

    /// Returns whether the dart becomes a sample. `decide` finds out, unless the dart is decided already.
    #[inline]
    pub fn is_kept(&self, decide: impl FnOnce() -> bool) -> bool {
        match self.0.load(Ordering::Relaxed) {
            UNDECIDED => {
                let is_kept = decide();
                let fate = if is_kept { KEPT } else { REFUSED };
                self.0.store(fate, Ordering::Relaxed);
                is_kept
            }
            fate => fate == KEPT,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fate_is_decided_once() {
        for expected in [true, false] {
            let fate = Fate::undecided();
            assert_eq!(fate.is_kept(|| expected), expected);
            assert_eq!(fate.is_kept(|| !expected), expected);
        }
    }
}
