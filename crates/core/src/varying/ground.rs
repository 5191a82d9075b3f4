//! The process of darts where the radius varies: which darts exist, which of them have an earlier sample near them, and
//! which cells a sample is near as a whole. Places are *near* each other if they are at most the reach of their two
//! radii apart ([`super::rule`]). Cells are parts of the base cells of [`super::quadtree`], whose *sight* says which samples can
//! be near them.

use glam::IVec2;

use super::field::RadiusField;
use super::octaves::{Octaves, Sight};
use super::quadtree::VaryingCell;
use super::rule::{is_near, is_thinned, most_reach};
use super::shape::{Class, Shape};
use crate::lattice::Point;
use crate::stages::darts::{DartGround, Landing};
use crate::stages::disks::{Cell, farthest};

/// A field, a shape, and the samples so far.
pub(super) struct VaryingGround<'a> {
    field: &'a RadiusField,
    shape: &'a Shape,
    samples: Octaves,
}

/// The radius at the place of a dart, and the samples that can be near it.
#[derive(Clone, Copy)]
pub(super) struct DartPlace {
    radius: i32,
    sight: Sight,
}

/// A sample near a cell: its offset from the cell's lowest point, and its radius.
#[derive(Clone, Copy)]
pub(super) struct NearDisk {
    offset: IVec2,
    radius: i32,
}

impl<'a> VaryingGround<'a> {
    pub fn new(field: &'a RadiusField, shape: &'a Shape) -> Self {
        Self {
            field,
            shape,
            samples: Octaves::new(field),
        }
    }
}

impl DartGround for VaryingGround<'_> {
    type Cell = VaryingCell;
    type Place = DartPlace;
    type Near = NearDisk;

    fn square(&self, cell: &VaryingCell, _: u32) -> Cell {
        cell.square()
    }

    fn landing(
        &self,
        cell: &VaryingCell,
        at: Point,
        coin: impl FnOnce() -> u32,
    ) -> Landing<DartPlace> {
        // A cell may reach beyond the domain, and a mixed one has places inside and outside of the shape.
        let rect = self.field.domain().rect();
        if !rect.contains(at) || cell.class == Class::Mixed && !self.shape.inside(at) {
            return Landing::Outside;
        }

        // The dart of a cell of one point, whose `bits` are 0, always stays, which makes the set maximal.
        let radius = self.field.radius_at(at);
        if cell.bits > 0 && is_thinned(radius, cell.base_bits, coin) {
            return Landing::Thinned;
        }
        let sight = cell.sight;
        Landing::Inside(DartPlace { radius, sight })
    }

    fn covers(&self, at: Point, DartPlace { radius, sight }: DartPlace) -> bool {
        self.samples.covers(at, radius, sight)
    }

    fn insert(&mut self, at: Point, place: DartPlace) -> bool {
        self.samples.insert(at, place.radius)
    }

    fn split(
        &self,
        cell: &VaryingCell,
        _: u32,
        near: &mut Vec<NearDisk>,
        out: &mut Vec<VaryingCell>,
    ) {
        let square = cell.square();
        let half = square.side / 2;
        let middle = Point::new(square.min.x + half, square.min.y + half);
        let (least_radii, greatest) = self.field.quarter_bounds(square);

        near.clear();
        // A sample that is near all places of a quarter is near the quarter's corner beside the cell's middle, too, and
        // this corner is less than 2 units from the middle.
        let slack = 2;
        self.samples
            .any_near(middle, greatest, slack, cell.sight, |offset, radius| {
                let limit = i64::from(most_reach(radius, greatest) + slack);
                if offset.as_i64vec2().length_squared() <= limit * limit {
                    // From here on offsets begin at the cell's lowest place.
                    let offset = offset + half;
                    near.push(NearDisk { offset, radius });
                }
                // The search goes on to all samples.
                false
            });

        let rect = self.field.domain().rect();
        for (quarter, least) in square.quarters().into_iter().zip(least_radii) {
            // A quarter that begins beyond the domain has no place of it.
            if !rect.contains(quarter.min) {
                continue;
            }

            // A sample is near all places of the quarter if it is near the farthest, were the radius there the least.
            // Places beyond the domain count, too: a quarter that the domain's end cuts may stay in vain.
            let corner = quarter.min - square.min;
            let covered = near.iter().any(|disk| {
                let across = farthest(disk.offset - corner, IVec2::splat(half - 1));
                is_near(across.as_i64vec2().length_squared(), disk.radius, least)
            });
            if covered {
                continue;
            }

            // A cell that lies inside as a whole has no quarter outside.
            let class = match cell.class {
                Class::Inside => Class::Inside,
                Class::Mixed | Class::Outside => self.shape.class(quarter),
            };
            if class != Class::Outside {
                out.push(VaryingCell {
                    min: quarter.min,
                    bits: cell.bits - 1,
                    class,
                    ..*cell
                });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::{Boundary, Domain, R};
    use crate::progress::Unobserved;
    use crate::random::Key;
    use crate::record::Unrecorded;
    use crate::reference::finished;
    use crate::stages::darts::DartProcess;
    use crate::varying::quadtree::base_cells;

    /// The same ground on which all darts stay.
    struct Unthinned<'a>(VaryingGround<'a>);

    impl DartGround for Unthinned<'_> {
        type Cell = VaryingCell;
        type Place = DartPlace;
        type Near = NearDisk;

        fn square(&self, cell: &VaryingCell, level: u32) -> Cell {
            self.0.square(cell, level)
        }

        fn landing(
            &self,
            cell: &VaryingCell,
            at: Point,
            _: impl FnOnce() -> u32,
        ) -> Landing<DartPlace> {
            self.0.landing(cell, at, || 0)
        }

        fn covers(&self, at: Point, place: DartPlace) -> bool {
            self.0.covers(at, place)
        }

        fn insert(&mut self, at: Point, place: DartPlace) -> bool {
            self.0.insert(at, place)
        }

        fn split(
            &self,
            cell: &VaryingCell,
            level: u32,
            near: &mut Vec<NearDisk>,
            out: &mut Vec<VaryingCell>,
        ) {
            self.0.split(cell, level, near, out);
        }
    }

    /// A field that grows to the right by 3 in 100 of the way, and is 2 R at 10 R from the left, where cells of side 2
    /// R begin.
    fn ramp() -> RadiusField {
        let domain = Domain::from_units(20 * R, 1_500 * R, Boundary::Bounded);
        let [columns, rows] = RadiusField::node_counts(&domain, 15).unwrap();
        let node = |index: usize| 2 * R + ((index % columns) as i32 - 10) * (R * 3 / 100);
        let nodes: Vec<i32> = (0..columns * rows).map(node).collect();
        RadiusField::from_nodes(domain, 15, &nodes).unwrap()
    }

    /// Returns N R^2 of the places whose radius is from 1.97 to 2, and of those from 2 to 2.03, in several sets on
    /// grounds that `ground` makes.
    fn densities<'a, G: DartGround<Cell = VaryingCell>>(
        field: &'a RadiusField,
        shape: &'a Shape,
        ground: impl Fn(VaryingGround<'a>) -> G,
    ) -> [f64; 2] {
        let mut counts = [0; 2];
        let sets = 1..=4;
        for seed in sets.clone() {
            let ground = ground(VaryingGround::new(field, shape));
            let process = DartProcess::on(ground, Key::from_seed(seed), base_cells(field, shape));
            let samples = finished(process, &mut Unobserved, &mut Unrecorded).unwrap();
            for (count, column) in counts.iter_mut().zip([9, 10]) {
                *count += samples.iter().filter(|p| p.x >> 15 == column).count();
            }
        }

        let area = f64::from(field.domain().height() / R) * sets.count() as f64;
        [0, 1].map(|index| {
            let radius = 1.985 + 0.03 * index as f64;
            counts[index] as f64 * radius * radius / area
        })
    }

    #[test]
    fn without_thinning_a_stripe_appears_where_the_radius_passes_a_power_of_two() {
        let (field, shape) = (ramp(), Shape::rectangle());
        let thinned = densities(&field, &shape, |ground| ground);
        assert!(
            thinned.iter().all(|density| (0.65..0.75).contains(density)),
            "{thinned:?}"
        );
        let stripe = densities(&field, &shape, Unthinned);
        assert!(stripe[0] > 0.8 && stripe[1] < 0.6, "{stripe:?}");
    }
}
