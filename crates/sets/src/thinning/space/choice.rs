//! The greedy choice in space, cell by cell as in the plane ([`super::super::greedy`]).
//!
//! The first open point of a cell is kept or refused once no cell around holds an open point of an earlier rank, and is refused
//! as soon as a kept point is near. Whatever the order in which cells are visited, and on whatever threads, each point then
//! meets exactly the kept points that it would meet one by one.

use std::ops::{ControlFlow, Range};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use rayon::prelude::*;
use tilescope_analysis::{Control, Progress};

use super::super::ThinError;
use super::super::near::Reach;
use super::SpaceCloud;
use super::cells::SpaceCells;

/// Decided points between two reports. Chosen, not measured.
const STRIDE: u64 = 1 << 14;

/// Bands for each thread: more would have more borders, over which cells wait for each other, and fewer would leave a thread
/// without work while another one ends.
const BANDS_A_THREAD: usize = 4;

/// A choice in space in the making.
struct SpaceChoice<'a> {
    cells: SpaceCells,
    reach: Reach,
    decided: AtomicU64,
    control: Control<'a>,
    is_cancelled: AtomicBool,
}

/// Returns which points are kept. `low` is the lowest corner of a box around all points.
pub(super) fn choose(
    cloud: &SpaceCloud<'_>,
    low: [f64; 3],
    control: Control<'_>,
) -> Result<Vec<bool>, ThinError> {
    let choice = SpaceChoice {
        cells: SpaceCells::new(cloud, low),
        reach: Reach::of(cloud.radius),
        decided: AtomicU64::new(0),
        control,
        is_cancelled: AtomicBool::new(false),
    };
    choice.report(0);

    // First each thread settles bands of cells that follow each other. A point that waits for one of another band is left, and so
    // are all that wait for it.
    let all = choice.cells.count();
    let bands = (rayon::current_num_threads() * BANDS_A_THREAD) as u64;
    let border = |band: u64| (u64::from(all) * band / bands) as u32;
    (0..bands)
        .into_par_iter()
        .for_each(|band| choice.settle(Some(border(band)..border(band + 1))));
    // After the bands, one thread decides the points that waited for those of other bands.
    choice.settle(None);
    if choice.is_cancelled.into_inner() {
        return Err(ThinError::Cancelled);
    }
    Ok(choice.cells.flags())
}

impl SpaceChoice<'_> {
    /// Counts decided points and asks whether to go on.
    fn report(&self, more: u64) {
        let done = self.decided.fetch_add(more, Ordering::Relaxed) + more;
        let total = self.cells.points.len() as u64;
        if (self.control)(Progress { done, total }) == ControlFlow::Break(()) {
            self.is_cancelled.store(true, Ordering::Relaxed);
        }
    }

    /// Decides the points of a band of the cells, as far as they do not wait for other bands. Without a band, decides
    /// all points that are left.
    fn settle(&self, band: Option<Range<u32>>) {
        let cells = band.clone().unwrap_or(0..self.cells.count());
        let mut visitor = SpaceVisitor {
            choice: self,
            band,
            around: Vec::new(),
            waiting: Vec::new(),
            decided: 0,
        };
        for cell in cells {
            // Without this, each band would go on to its next report.
            if self.is_cancelled.load(Ordering::Relaxed) {
                return;
            }
            visitor.settle(cell);
        }
        self.report(visitor.decided);
    }
}

/// What a thread needs to visit cells.
struct SpaceVisitor<'a> {
    choice: &'a SpaceChoice<'a>,
    /// The cells that this thread may visit; `None` for all cells, once no other thread works.
    band: Option<Range<u32>>,
    around: Vec<u32>,
    /// Cells that wait, each for the cell that was pushed after it. The first open point of the later cell has the
    /// earlier rank, so that the list ends.
    waiting: Vec<u32>,
    /// Points decided since the last report.
    decided: u64,
}

impl SpaceVisitor<'_> {
    /// Decides all points of a cell, and before them those that they wait for.
    fn settle(&mut self, cell: u32) {
        let stuck = &self.choice.cells.turns.stuck;
        self.waiting.push(cell);
        while let Some(&cell) = self.waiting.last() {
            match self.visit(cell) {
                None => {
                    self.waiting.pop();
                }
                Some(earlier) if self.may_visit(earlier) => self.waiting.push(earlier),
                // All that waits for another band is marked, so that no cell follows the same way again.
                Some(_) => {
                    for cell in self.waiting.drain(..) {
                        stuck[cell as usize].store(true, Ordering::Relaxed);
                    }
                }
            }

            if self.decided >= STRIDE {
                self.choice.report(std::mem::take(&mut self.decided));
                if self.choice.is_cancelled.load(Ordering::Relaxed) {
                    return;
                }
            }
        }
    }

    /// Returns whether a cell is of this band and does not wait for another band.
    fn may_visit(&self, cell: u32) -> bool {
        let Some(band) = &self.band else {
            return true;
        };
        let is_stuck = self.choice.cells.turns.stuck[cell as usize].load(Ordering::Relaxed);
        band.contains(&cell) && !is_stuck
    }

    /// Decides the open points of a cell until one waits for an earlier one; returns the cell of that, or nothing when all points
    /// are decided.
    fn visit(&mut self, cell: u32) -> Option<u32> {
        let cells = &self.choice.cells;
        let mut has_looked = false;
        while let Some(open) = cells.turns.head(cell) {
            if !has_looked {
                cells.look_around(cell, &mut self.around);
                has_looked = true;
            }

            let is_kept = match self.meets(open) {
                // This holds whatever else is open: a kept point that is near came before this one.
                SpaceMeeting::Kept => false,
                SpaceMeeting::Open(earlier) => return Some(earlier),
                SpaceMeeting::Nothing => true,
            };
            cells.turns.decide(cell, is_kept);
            self.decided += 1;
        }
        None
    }

    /// Returns what an open point meets in the cells around it.
    fn meets(&self, open: u32) -> SpaceMeeting {
        let SpaceChoice { cells, reach, .. } = self.choice;
        let (point, rank) = (cells.points[open as usize], cells.ranks[open as usize]);
        // The rank and the cell of the earliest open point that comes before this one.
        let mut earliest: Option<(u32, u32)> = None;
        for &cell in &self.around {
            // The head is read before the kept points, since another thread may decide points of the cell meanwhile.
            // Read the other way round, an earlier point that is kept between the two readings would be missed by both.
            if let Some(head) = cells.turns.head(cell) {
                let before = cells.ranks[head as usize];
                if before < rank && earliest.is_none_or(|(least, _)| before < least) {
                    earliest = Some((before, cell));
                }
            }

            for other in cells.turns.kept(cell) {
                let other = cells.points[other as usize];
                if reach.holds([0, 1, 2].map(|axis| (point[axis] - other[axis]).abs())) {
                    return SpaceMeeting::Kept;
                }
            }
        }
        earliest.map_or(SpaceMeeting::Nothing, |(_, cell)| SpaceMeeting::Open(cell))
    }
}

/// What an open point meets.
enum SpaceMeeting {
    /// A kept point is near.
    Kept,
    /// None is, and this cell has the earliest open point that comes before it.
    Open(u32),
    /// Neither.
    Nothing,
}
