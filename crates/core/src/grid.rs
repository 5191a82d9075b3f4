//! A uniform grid over the domain that finds the samples near a point. Callers apply the exact predicate
//! ([`crate::covers_offset`]) to the samples found.

use glam::IVec2;

use crate::lattice::{Domain, Point, R, covers_offset};

/// Cells have sides of 2^15 units, one radius.
const CELL_BITS: u32 = 15;

/// Ends the list of a cell.
const NONE: u32 = u32::MAX;

/// A sample found by the grid.
#[derive(Clone, Copy, Debug)]
pub struct NearSample {
    /// The id under which it was inserted.
    pub id: u32,
    /// Its offset from the query's point, the shortest way around.
    pub offset: IVec2,
}

#[derive(Clone, Copy, serde::Serialize, serde::Deserialize)]
struct GridEntry {
    point: Point,
    id: u32,
    next: u32,
}

/// Samples by cell, as linked lists, so that samples can be added at any time.
#[derive(serde::Serialize, serde::Deserialize)]
pub struct SampleGrid {
    domain: Domain,
    columns: usize,
    first: Vec<u32>,
    entries: Vec<GridEntry>,
}

impl SampleGrid {
    /// Returns an empty grid with room for `capacity` samples.
    #[must_use]
    pub fn with_capacity(domain: Domain, capacity: usize) -> Self {
        let rect = domain.rect();
        let columns = (((rect.max.x - 1) >> CELL_BITS) + 1) as usize;
        let rows = (((rect.max.y - 1) >> CELL_BITS) + 1) as usize;
        Self {
            domain,
            columns,
            first: vec![NONE; columns * rows],
            entries: Vec::with_capacity(capacity),
        }
    }

    /// Returns whether there are no samples.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Adds the sample `id` at `point`, which must lie in the domain.
    pub fn insert(&mut self, id: u32, point: Point) {
        let cell = (point.y >> CELL_BITS) as usize * self.columns + (point.x >> CELL_BITS) as usize;
        let entry = GridEntry {
            point,
            id,
            next: self.first[cell],
        };
        self.first[cell] = self.entries.len() as u32;
        self.entries.push(entry);
    }

    /// Calls `visit` with every sample whose offset from `centre` is at most `reach` units on both
    /// axes, in no particular order, until `visit` returns `true`; returns whether it did.
    ///
    /// `centre` may lie outside a bounded domain. In a periodic one a sample is visited once, with its shortest offset.
    #[inline]
    pub fn any_near(
        &self,
        centre: Point,
        reach: i32,
        mut visit: impl FnMut(NearSample) -> bool,
    ) -> bool {
        let rect = self.domain.rect();
        let periodic = self.domain.is_periodic();
        let (row_spans, row_span_count) = spans(centre.y, reach, rect.max.y, periodic);
        let (column_spans, column_span_count) = spans(centre.x, reach, rect.max.x, periodic);

        for &(row_min, row_max) in &row_spans[..row_span_count] {
            for row in row_min..=row_max {
                for &(column_min, column_max) in &column_spans[..column_span_count] {
                    let start = row as usize * self.columns;
                    let cells = start + column_min as usize..=start + column_max as usize;
                    for &first in &self.first[cells] {
                        let mut next = first;
                        while next != NONE {
                            let entry = self.entries[next as usize];
                            next = entry.next;
                            // A sample counts once, with its shortest offset, however many images are in reach.
                            let offset = self.domain.difference(centre, entry.point);

                            if offset.x.abs() <= reach
                                && offset.y.abs() <= reach
                                && visit(NearSample {
                                    id: entry.id,
                                    offset,
                                })
                            {
                                return true;
                            }
                        }
                    }
                }
            }
        }

        false
    }

    /// Returns whether any sample covers `point`.
    #[inline]
    #[must_use]
    pub fn covers(&self, point: Point) -> bool {
        self.any_near(point, R, |near| covers_offset(near.offset))
    }
}

/// Returns the inclusive ranges of cells (at most two) that hold coordinates within `reach` of
/// `centre` on an axis of `extent` lattice points, and how many of the two are used.
#[inline]
pub(crate) fn spans(
    centre: i32,
    reach: i32,
    extent: i32,
    periodic: bool,
) -> ([(i32, i32); 2], usize) {
    let (low, high) = (
        i64::from(centre) - i64::from(reach),
        i64::from(centre) + i64::from(reach),
    );

    let last = extent - 1;
    let cell = |x: i64| (x >> CELL_BITS) as i32;
    let unused = (0, 0);
    let all = ([(0, last >> CELL_BITS), unused], 1);

    if low >= 0 && high <= i64::from(last) {
        return ([(cell(low), cell(high)), unused], 1);
    }

    if !periodic {
        let (low, high) = (low.max(0), high.min(i64::from(last)));
        // A centre far outside a bounded domain has no cell in reach.
        return ([(cell(low), cell(high)), unused], usize::from(low <= high));
    }

    // Places beyond one end of a periodic axis lie at its other end.
    let extent = i64::from(extent);
    let (upper_first, lower_last) = if low < 0 {
        (low + extent, high)
    } else {
        (low, high - extent)
    };

    // Two ranges that share a cell would visit its samples twice: all cells are then one range. The same holds if the
    // upper range begins below 0, since the reach is then longer than the axis.
    if upper_first < 0 || cell(lower_last) >= cell(upper_first) {
        return all;
    }

    (
        [(0, cell(lower_last)), (cell(upper_first), cell(extent - 1))],
        2,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::Boundary;
    use crate::random::{Key, Stream, below};
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(tilescope_tests::cases(64)))]
        /// The grid visits exactly the samples that a plain scan finds, each once.
        #[test]
        fn finds_what_a_scan_finds(
            seed: u64,
            periodic: bool,
            width in 10.0_f64..30.0,
            height in 10.0_f64..30.0,
            reach in 1..7 * R,
        ) {
            let boundary = if periodic { Boundary::Periodic } else { Boundary::Bounded };
            let domain = Domain::from_size([width, height], 1.0, boundary).unwrap();
            let rect = domain.rect();
            let points: Vec<Point> = (0..300).map(|k| {
                let [a, b] = Key::from_seed(seed).draw(Stream::Dart, k);
                Point::new(
                    below(a, rect.max.x as u32) as i32,
                    below(b, rect.max.y as u32) as i32,
                )
            }).collect();
            let mut grid = SampleGrid::with_capacity(domain, points.len());
            for (id, &p) in points.iter().enumerate() {
                grid.insert(id as u32, p);
            }
            for &centre in &points[..40] {
                let mut found = Vec::new();
                grid.any_near(centre, reach, |near| { found.push(near.id); false });
                found.sort_unstable();
                let scanned: Vec<u32> = points.iter().enumerate().filter(|&(_, &p)| {
                    domain.difference(centre, p).abs().max_element() <= reach
                }).map(|(id, _)| id as u32).collect();
                prop_assert_eq!(found, scanned);
            }
        }
    }
}
