//! A spatial index of samples: which ones lie in a part of the domain, with their images across a periodic
//! border. It is a compact grid that is built once per session.

use std::ops::RangeInclusive;

use glam::DVec2;
use tilescope_core::{Domain, Point};

use crate::units::{position, radii, size};

/// The most cells of the grid: 32 MB of offsets.
const MAX_CELLS: f64 = 8e6;

/// A grid of sample ids, sorted by cell.
#[derive(serde::Serialize, serde::Deserialize)]
pub struct SampleIndex {
    size: DVec2,
    periodic: bool,
    cell: f64,
    columns: usize,
    rows: usize,
    starts: Vec<u32>,
    /// The ids of the samples with their places, cell by cell.
    entries: Vec<(u32, [f32; 2])>,
}

/// A sample, or an image of it, in a part of the domain.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    /// The id of the sample.
    pub id: u32,
    /// Where it lies, in r; an image lies outside the domain.
    pub position: DVec2,
    /// Whether it is an image across the border.
    pub image: bool,
}

impl SampleIndex {
    /// Returns the index of `points`, whose ids are their indices in the list.
    #[must_use]
    pub fn new(domain: &Domain, points: &[Point]) -> Self {
        let size = size(domain);
        // Cells of 2 r hold about three samples; a domain with too many of them gets larger ones.
        let cell = (size.element_product() / MAX_CELLS).sqrt().max(2.0);
        let columns = (size.x / cell) as usize + 1;
        let rows = (size.y / cell) as usize + 1;

        let cell_of = |point: &Point| {
            // Samples that a bounded domain dropped lie outside it. They are kept in the cells at the border.
            let column = ((radii(point.x) / cell).max(0.0) as usize).min(columns - 1);
            let row = ((radii(point.y) / cell).max(0.0) as usize).min(rows - 1);
            row * columns + column
        };

        // A sort by counting. First `starts[k + 1]` is how many samples cell `k` has. The sums then make `starts[k]` the
        // place in the list at which the samples of cell `k` begin.
        let mut starts = vec![0_u32; columns * rows + 1];
        for point in points {
            starts[cell_of(point) + 1] += 1;
        }
        for k in 1..starts.len() {
            starts[k] += starts[k - 1];
        }

        let mut next = starts.clone();
        let mut entries = vec![(0, [0.0; 2]); points.len()];
        for (point, id) in points.iter().zip(0..) {
            let slot = &mut next[cell_of(point)];
            entries[*slot as usize] = (id, position(*point).as_vec2().to_array());
            *slot += 1;
        }

        Self {
            size,
            periodic: domain.is_periodic(),
            cell,
            columns,
            rows,
            starts,
            entries,
        }
    }

    /// Returns about how many samples lie between `low` and `high`.
    #[must_use]
    pub fn count_in(&self, low: DVec2, high: DVec2) -> usize {
        let Some([columns, rows]) = self.cells(low, high) else {
            return 0;
        };

        // Whole cells are counted, without a look at the samples in them. The cells of a row follow one another.
        let row = |row: usize| {
            let start = self.starts[row * self.columns + columns.start()];
            let end = self.starts[row * self.columns + columns.end() + 1];
            (end - start) as usize
        };
        rows.map(row).sum()
    }

    /// Calls `visit` with every sample within `reach` of the rectangle from `low` to `high` and, in
    /// a periodic domain, with their images up to `reach` outside the domain.
    pub fn visit(&self, low: DVec2, high: DVec2, reach: f64, visit: impl FnMut(Seen)) {
        let images_alone = false;
        self.visit_copies(low, high, [reach, reach], images_alone, visit);
    }

    /// Like [`Self::visit`], with images up to `beyond` outside a periodic domain, whatever `reach` is.
    pub fn visit_around(
        &self,
        low: DVec2,
        high: DVec2,
        reach: f64,
        beyond: f64,
        visit: impl FnMut(Seen),
    ) {
        let images_alone = false;
        self.visit_copies(low, high, [reach, beyond], images_alone, visit);
    }

    /// Calls `visit` with the images alone that [`Self::visit`] calls it with.
    pub fn visit_images(&self, low: DVec2, high: DVec2, reach: f64, visit: impl FnMut(Seen)) {
        let images_alone = true;
        self.visit_copies(low, high, [reach, reach], images_alone, visit);
    }

    /// Calls `visit` with the samples within `reach` of the rectangle from `low` to `high`, and with images up to `beyond` outside a
    /// periodic domain; with images only if `images_alone` is set.
    fn visit_copies(
        &self,
        low: DVec2,
        high: DVec2,
        [reach, beyond]: [f64; 2],
        images_alone: bool,
        mut visit: impl FnMut(Seen),
    ) {
        let copies: &[f64] = if self.periodic {
            &[0.0, -1.0, 1.0]
        } else {
            &[0.0]
        };

        // A bounded domain has no images, but the samples that it dropped lie up to one radius outside it. The
        // rectangle must not be cut off before these samples: at least one radius is left around the domain.
        let beyond = if self.periodic {
            beyond
        } else {
            reach.max(1.0)
        };

        for &up in copies {
            for &right in copies {
                let shift = DVec2::new(right, up) * self.size;
                let image = right != 0.0 || up != 0.0;

                if images_alone && !image {
                    continue;
                }

                // The part of the domain whose copy, moved by `shift`, lies in the rectangle.
                let from = (low - reach).max(DVec2::splat(-beyond)) - shift;
                let to = (high + reach).min(self.size + beyond) - shift;
                self.visit_copy(from, to, |id, position| {
                    let position = position + shift;
                    visit(Seen {
                        id,
                        position,
                        image,
                    });
                });
            }
        }
    }

    /// Calls `visit` with the samples in a rectangle of the domain itself, not of its copies.
    fn visit_copy(&self, low: DVec2, high: DVec2, mut visit: impl FnMut(u32, DVec2)) {
        let Some([columns, rows]) = self.cells(low, high) else {
            return;
        };

        for row in rows {
            let start = self.starts[row * self.columns + columns.start()] as usize;
            let end = self.starts[row * self.columns + columns.end() + 1] as usize;
            for &(id, position) in &self.entries[start..end] {
                let position = DVec2::from(position.map(f64::from));
                // Cells reach beyond the rectangle.
                if (position.cmpge(low) & position.cmple(high)).all() {
                    visit(id, position);
                }
            }
        }
    }

    /// Returns the columns and the rows of the cells that a rectangle meets; `None` if it lies outside the domain.
    fn cells(&self, low: DVec2, high: DVec2) -> Option<[RangeInclusive<usize>; 2]> {
        let axis = |k: usize, count: usize| {
            let (from, to) = (low[k].max(0.0), high[k].min(self.size[k]));
            let cell = |value: f64| ((value / self.cell) as usize).min(count - 1);
            (from <= to).then(|| cell(from)..=cell(to))
        };
        Some([axis(0, self.columns)?, axis(1, self.rows)?])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tilescope_core::{Boundary, R};

    fn index(boundary: Boundary) -> SampleIndex {
        let domain = Domain::from_size([20.0, 20.0], 1.0, boundary).unwrap();
        let at = |x: i32, y: i32| Point::new(x * R, y * R);
        SampleIndex::new(&domain, &[at(0, 10), at(5, 5), at(19, 19)])
    }

    fn seen(index: &SampleIndex, low: [f64; 2], high: [f64; 2]) -> Vec<(u32, bool)> {
        let mut all = Vec::new();
        index.visit(low.into(), high.into(), 1.0, |seen| {
            all.push((seen.id, seen.image));
        });
        all.sort_unstable();
        all
    }

    #[test]
    fn only_samples_near_the_rectangle_are_visited() {
        let index = index(Boundary::Bounded);
        assert_eq!(seen(&index, [4.0, 4.0], [6.0, 6.0]), [(1, false)]);
        assert_eq!(seen(&index, [6.1, 4.0], [9.0, 6.0]), []);
        let all = seen(&index, [-99.0, -99.0], [99.0, 99.0]);
        assert_eq!(all, [(0, false), (1, false), (2, false)]);
    }

    #[test]
    fn images_appear_across_a_periodic_border_only() {
        let index = index(Boundary::Periodic);
        assert_eq!(seen(&index, [19.5, 9.0], [20.0, 11.0]), [(0, true)]);
        let mut images = Vec::new();
        let whole = [DVec2::ZERO, DVec2::splat(20.0)];
        index.visit_images(whole[0], whole[1], 1.0, |seen| images.push(seen.id));
        images.sort_unstable();
        assert_eq!(images, [0, 2, 2, 2]);
        let corner = seen(&index, [-1.0, -1.0], [0.0, 0.0]);
        assert_eq!(corner, [(2, true)]);
    }
}
