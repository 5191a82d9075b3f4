//! The samples so far, in a grid for each octave of radii. Samples of radii from S to 2S are more than S apart, so that
//! a cell of side S holds three at most. Places are *near* each other if they are at most the reach of their two radii
//! apart ([`super::rule`]).

use glam::IVec2;

use super::field::RadiusField;
use super::rule::{is_near, reach};
use crate::lattice::Point;
use crate::stages::cells::CellGrid;

/// Samples of a cell: see the argument of [`crate::stages::disks`].
const SLOTS: usize = 3;

/// A sample and its radius; without a sample the radius is 0.
#[derive(Clone, Copy)]
struct Disk {
    at: Point,
    radius: i32,
}

const EMPTY: Disk = Disk {
    at: Point::new(0, 0),
    radius: 0,
};

/// The samples that can be near a place: those of some octaves, and none larger than a radius.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Sight {
    /// The binary logarithms of the first and of the last octave.
    pub octaves: [u8; 2],
    /// No sample in sight is larger, in units.
    pub largest: i32,
}

/// The samples of an octave.
struct Octave {
    grid: CellGrid,
    /// Of each cell of the grid, which of `cells` has its samples. Most have none: they share the first, which stays
    /// empty.
    index: Vec<u32>,
    cells: Vec<[Disk; SLOTS]>,
}

/// A conflict-free set of samples of many radii that grows.
pub(super) struct Octaves {
    /// The binary logarithm of the first octave.
    first: u8,
    octaves: Vec<Octave>,
}

/// Returns the binary logarithm of a radius, rounded down.
pub(super) const fn octave_of(radius: i32) -> u8 {
    radius.ilog2() as u8
}

impl Octaves {
    /// Returns a grid without samples for each octave of the field's radii.
    pub fn new(field: &RadiusField) -> Self {
        let (domain, range) = (field.domain(), field.whole());
        let octave = |bits: u8| {
            let grid = CellGrid::new(domain.rect(), domain.is_periodic(), bits.into());
            Octave {
                index: vec![0; grid.count()],
                grid,
                cells: vec![[EMPTY; SLOTS]],
            }
        };

        let first = octave_of(range.least);
        Self {
            first,
            octaves: (first..=octave_of(range.greatest)).map(octave).collect(),
        }
    }

    /// Adds a sample of the domain; returns `false`, and adds nothing, when its cell is full, which happens only in a
    /// set that is not conflict-free.
    pub fn insert(&mut self, at: Point, radius: i32) -> bool {
        let octave = &mut self.octaves[usize::from(octave_of(radius) - self.first)];
        let listed = &mut octave.index[octave.grid.cell_at(at)];
        if *listed == 0 {
            *listed = octave.cells.len() as u32;
            octave.cells.push([EMPTY; SLOTS]);
        }

        let cell = &mut octave.cells[*listed as usize];
        let free = cell.iter_mut().find(|disk| disk.radius == 0);
        free.map(|disk| *disk = Disk { at, radius }).is_some()
    }

    /// Calls `visit` with the offset from `from` and the radius of samples in sight, until it returns `true`; returns
    /// whether it did. Take any place of this radius that is at most `slack` units from `from` on both axes: all
    /// samples in sight that are near it are visited, and some that are not.
    #[inline]
    pub fn any_near(
        &self,
        from: Point,
        radius: i32,
        slack: i32,
        sight: Sight,
        mut visit: impl FnMut(IVec2, i32) -> bool,
    ) -> bool {
        let [first, last] = sight.octaves.map(|bits| usize::from(bits - self.first));
        self.octaves[first..=last]
            .iter()
            .enumerate()
            .any(|(index, octave)| {
                // Cell 0 is empty: an octave without another has no sample.
                if octave.cells.len() == 1 {
                    return false;
                }

                // All radii of an octave are below twice the side of its cells.
                let end = 2 << (index + first + usize::from(self.first));
                let farthest = reach(sight.largest.min(end - 1), radius) + slack;
                octave.grid.any_range(from, farthest, |range, shift| {
                    // The wrapped sums are right, as the offsets of samples found here are short.
                    let (x, y) = (shift.x.wrapping_sub(from.x), shift.y.wrapping_sub(from.y));
                    octave.index[range].iter().any(|&listed| {
                        let mut disks = octave.cells[listed as usize]
                            .iter()
                            .take_while(|disk| disk.radius > 0);
                        disks.any(|disk| {
                            let Point { x: right, y: up } = disk.at;
                            let offset = IVec2::new(right.wrapping_add(x), up.wrapping_add(y));
                            visit(offset, disk.radius)
                        })
                    })
                })
            })
    }

    /// Returns whether a sample in sight is near a place of this radius, which lies in the domain.
    #[inline]
    pub fn covers(&self, place: Point, radius: i32, sight: Sight) -> bool {
        // A sample in the place's own cell nearly always answers. It is near wherever the radii do not differ much.
        let own = &self.octaves[usize::from(octave_of(radius) - self.first)];
        let listed = own.index[own.grid.cell_at(place)];
        let mut disks = own.cells[listed as usize]
            .iter()
            .take_while(|disk| disk.radius > 0);
        let near = |offset: IVec2, other: i32| {
            is_near(offset.as_i64vec2().length_squared(), other, radius)
        };
        let slack = 0;
        disks.any(|disk| near(disk.at - place, disk.radius))
            || self.any_near(place, radius, slack, sight, near)
    }
}
