//! Counts of a window. The counts of all windows of a run add up to the run's summary.
//!
//! A `Region` computes a window. Cells in which something depends on the plane beyond it are *unsure*: other regions,
//! the *repairing* ones, compute them again.

use serde::{Deserialize, Serialize};

use crate::lattice::{Point, Rect, Rect64};
use crate::run::Summary;

use super::frame::CELL_BITS;
use super::region::{Loss, Region};

/// Counts of a window or of several.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct WindowCounts {
    /// Blocks whose lowest corner lies in the window.
    pub blocks: u64,
    /// Samples that were eliminated.
    pub eliminated: u64,
    /// Samples tiled outside a bounded domain, counted in the window of the nearest point of the domain.
    pub dropped: u64,
    /// Samples inserted, by iteration.
    pub inserted: Vec<u64>,
}

impl WindowCounts {
    /// Begins to count anew.
    pub(crate) fn clear(&mut self) {
        // The list is cleared and used again, so that its memory is kept.
        let mut inserted = std::mem::take(&mut self.inserted);
        inserted.clear();
        *self = Self {
            inserted,
            ..Self::default()
        };
    }

    /// Adds the counts of another window.
    pub fn add(&mut self, other: &Self) {
        self.blocks += other.blocks;
        self.eliminated += other.eliminated;
        self.dropped += other.dropped;
        for (k, n) in other.inserted.iter().enumerate() {
            self.insert(k, *n);
        }
    }

    /// Counts `n` samples inserted in the iteration `index`, from 0.
    pub fn insert(&mut self, index: usize, n: u64) {
        if self.inserted.len() <= index {
            self.inserted.resize(index + 1, 0);
        }
        self.inserted[index] += n;
    }

    /// Returns the summary of a run with `count` samples.
    #[must_use]
    pub fn summary(&self, count: u64) -> Summary {
        let inserted: u64 = self.inserted.iter().sum();
        Summary {
            blocks: self.blocks as usize,
            // All samples that were not inserted were tiled, and so were all that were eliminated.
            tiled: (count - inserted + self.eliminated) as usize,
            dropped: self.dropped as usize,
            eliminated: self.eliminated as usize,
            inserted: self.inserted.iter().map(|&n| n as usize).collect(),
            count: count as usize,
        }
    }
}

impl<const TAGS: bool> Region<TAGS> {
    /// Adds the counts of the window without the cells in `repaired`, which the repairing regions count.
    pub(super) fn count(&self, repaired: &[Rect], counts: &mut WindowCounts) {
        let window = self.frame.window;
        let counted = |x: i32, y: i32| {
            let cell = Point::new(x >> CELL_BITS, y >> CELL_BITS);
            let is_repaired = repaired.iter().any(|cells| cells.contains(cell));
            window.contains(Point::new(x, y)) && !is_repaired
        };

        for block in &self.blocks {
            let min = block.rect.min;
            let is_inside = Rect64::from(window).contains(min);
            // A far corner may not fit 32 bits, but one inside of the window does.
            counts.blocks += u64::from(is_inside && counted(min.x as i32, min.y as i32));
        }

        // A sample of unknown fate lies in an unsure cell, and repairing regions count the samples of unsure cells.
        for lost in self.lost.iter().filter(|lost| lost.loss == Loss::Certain) {
            if self.frame.holds(lost.x, lost.y) {
                counts.eliminated += u64::from(counted(lost.x, lost.y));
            } else {
                // A dropped sample lies in no window: the window with the nearest place of the domain counts it. The
                // sample is beyond a closed border, where the frame ends with the domain.
                let [end_x, end_y] = self.frame.end;
                let (nearest_x, nearest_y) =
                    (lost.x.clamp(0, end_x - 1), lost.y.clamp(0, end_y - 1));
                counts.dropped += u64::from(counted(nearest_x, nearest_y));
            }
        }

        for inserted in &self.gaps.inserted {
            if counted(inserted.x, inserted.y) {
                // Iterations are numbered from 1.
                counts.insert(inserted.iteration as usize - 1, 1);
            }
        }
    }
}
