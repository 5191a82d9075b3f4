//! The darts of one throw, and which of them become samples: each that comes before all darts near it, or before those of them
//! that become samples.
//!
//! Taken by rank one after another, a dart looks at the samples so far. Here any dart may be asked first, on any thread: it looks for
//! the earlier darts near it, and asks those. Each question is about an earlier dart, so that it ends. Chains of questions are
//! short, since ranks are random: a chain of length k has one order of k! that counts, and a dart has few others near it.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::IVec2;
use rayon::prelude::*;

use super::field::RadiusField;
use super::octaves::{Sight, octave_of};
use super::rule::{is_near, reach};
use crate::fate::Fate;
use crate::lattice::Point;
use crate::memory::{NoMemory, ask};
use crate::stages::cells::CellGrid;

/// A sample of the last throw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct NewSample {
    rank: u32,
    pub at: Point,
    pub radius: i32,
}

impl NewSample {
    /// Returns the order of arrival within a throw. Equal ranks are decided by place, so that the sequence of cells does not matter.
    pub const fn arrival(&self) -> (u32, (i32, i32)) {
        (self.rank, self.at.row_major())
    }
}

/// A dart that no sample so far is near.
#[derive(Debug)]
pub(super) struct OpenDart {
    /// What it is if it becomes a sample.
    sample: NewSample,
    /// Which radii a dart or a sample near it may have.
    sight: Sight,
    /// The dart that was put into the same cell before it, as [`link`] gives it, or 0.
    next: AtomicU64,
    fate: Fate,
}

impl OpenDart {
    /// Returns a dart about which nothing is decided. `sight` is that of its base cell.
    pub const fn new(rank: u32, at: Point, radius: i32, sight: Sight) -> Self {
        Self {
            sample: NewSample { rank, at, radius },
            sight,
            next: AtomicU64::new(0),
            fate: Fate::undecided(),
        }
    }
}

/// The grids by which darts are found, which hold none between throws.
pub(super) struct Crowd {
    /// The binary logarithm of the first octave.
    first: u8,
    octaves: Vec<OctaveDarts>,
}

/// The darts of an octave of radii.
struct OctaveDarts {
    grid: CellGrid,
    /// The last dart that was put into each cell, as [`link`] gives it, or 0.
    heads: Vec<AtomicU64>,
}

/// Returns how many bytes the heads of the chains of some grids take.
fn heads_bytes(grids: &[CellGrid]) -> u64 {
    let cells: u64 = grids.iter().map(|grid| grid.count() as u64).sum();
    cells * size_of::<AtomicU64>() as u64
}

/// Returns heads of chains without darts.
fn empty_heads(count: usize) -> Vec<AtomicU64> {
    // All threads make them, as the memory is used for the first time.
    let heads = (0..count).into_par_iter().map(|_| AtomicU64::new(0));
    heads.collect()
}

/// Returns a number other than 0 for a dart of a parcel, which [`linked`] turns back.
const fn link(parcel: usize, number: usize) -> u64 {
    // The darts of a parcel are far fewer than 2^32, which would not fit memory.
    (parcel as u64 + 1) << 32 | number as u64
}

/// Returns the numbers of the parcel and of the dart from which [`link`] made a number, or `None` for 0.
const fn linked(link: u64) -> Option<(usize, usize)> {
    match (link >> 32).checked_sub(1) {
        Some(parcel) => Some((parcel as usize, link as u32 as usize)),
        None => None,
    }
}

impl Crowd {
    /// Returns empty grids for darts of the field's radii. Fails if the system does not give the memory for them.
    pub fn new(field: &RadiusField) -> Result<Self, NoMemory> {
        let domain = field.domain();
        let grid = |bits: u8| CellGrid::new(domain.rect(), domain.is_periodic(), bits.into());
        let [first, last] = field.extremes().map(octave_of);
        let grids: Vec<CellGrid> = (first..=last).map(grid).collect();

        // The grid of the smallest radii covers the whole domain, even if few samples have them. So the number of samples
        // does not bound the memory: where nearly all radii were 30 times the smallest, grids took 37 KB a sample.
        ask(heads_bytes(&grids))?;
        let octave = |grid: CellGrid| OctaveDarts {
            heads: empty_heads(grid.count()),
            grid,
        };
        Ok(Self {
            first,
            octaves: grids.into_iter().map(octave).collect(),
        })
    }

    /// Returns the darts that become samples, by parcels as the darts are.
    pub fn kept(&self, parcels: &[&[OpenDart]]) -> Vec<Vec<NewSample>> {
        // Which dart of a cell comes first in its chain depends on the threads. All of them are looked at, so that the result
        // does not.
        parcels.par_iter().enumerate().for_each(|(parcel, darts)| {
            for (number, dart) in darts.iter().enumerate() {
                let before = self
                    .head(dart)
                    .swap(link(parcel, number), Ordering::Relaxed);
                dart.next.store(before, Ordering::Relaxed);
            }
        });

        let of_parcel = |(parcel, darts): (usize, &&[OpenDart])| {
            let numbered = darts.iter().enumerate();
            numbered
                .filter(|&(number, _)| self.is_kept(parcels, (parcel, number)))
                .map(|(_, dart)| dart.sample)
                .collect()
        };
        let kept = parcels.par_iter().enumerate().map(of_parcel).collect();

        parcels
            .par_iter()
            .flat_map_iter(|darts| darts.iter())
            .for_each(|dart| self.head(dart).store(0, Ordering::Relaxed));
        kept
    }

    /// Returns the head of the chain of a dart's cell.
    fn head(&self, dart: &OpenDart) -> &AtomicU64 {
        let NewSample { at, radius, .. } = dart.sample;
        let octave = &self.octaves[usize::from(octave_of(radius) - self.first)];
        &octave.heads[octave.grid.cell_at(at)]
    }

    /// Returns whether a dart, given by the numbers of its parcel and of itself, becomes a sample.
    fn is_kept(&self, parcels: &[&[OpenDart]], own: (usize, usize)) -> bool {
        let dart = &parcels[own.0][own.1];
        dart.fate.is_kept(|| !self.is_refused(parcels, own))
    }

    /// Returns whether a dart is near an earlier one that becomes a sample.
    fn is_refused(&self, parcels: &[&[OpenDart]], own: (usize, usize)) -> bool {
        let OpenDart { sample, sight, .. } = &parcels[own.0][own.1];
        let [first, last] = sight.octaves.map(|bits| usize::from(bits - self.first));

        let mut octaves = self.octaves[first..=last].iter().zip(sight.octaves[0]..);
        octaves.any(|(octave, bits)| {
            // All radii of an octave are below twice the side of its cells.
            let end = 2 << bits;
            let farthest = reach(sight.largest.min(end - 1), sample.radius);
            octave.grid.any_range(sample.at, farthest, |cells, shift| {
                let mut heads = octave.heads[cells].iter();
                heads.any(|head| {
                    let last = head.load(Ordering::Relaxed);
                    // Most cells have no dart, above all after the first throw.
                    last != 0 && self.any_refuses(parcels, last, shift, (own, sample))
                })
            })
        })
    }

    /// Returns whether a dart of the chain that begins with a link comes earlier than `sample`, which is the dart `own`, is near it,
    /// and becomes a sample. `shift` leads from the chain's places to those near it.
    fn any_refuses(
        &self,
        parcels: &[&[OpenDart]],
        mut chain: u64,
        shift: IVec2,
        (own, sample): ((usize, usize), &NewSample),
    ) -> bool {
        while let Some(number) = linked(chain) {
            let OpenDart {
                sample: other,
                next,
                ..
            } = &parcels[number.0][number.1];
            chain = next.load(Ordering::Relaxed);
            // Half of all darts come later, which is found before any distance.
            if other.rank > sample.rank {
                continue;
            }

            // The wrapped sums are right, as the offsets of darts found here are short.
            let dx = other.at.x.wrapping_add(shift.x).wrapping_sub(sample.at.x);
            let dy = other.at.y.wrapping_add(shift.y).wrapping_sub(sample.at.y);
            let squared = i64::from(dx) * i64::from(dx) + i64::from(dy) * i64::from(dy);
            // Two darts of one cell may have one place and one rank: the first one counts as earlier, so that they do not both
            // stay.
            let is_earlier = || (other.arrival(), number) < (sample.arrival(), own);
            if is_near(squared, other.radius, sample.radius)
                && is_earlier()
                && self.is_kept(parcels, number)
            {
                return true;
            }
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::{Boundary, Domain, R};

    #[test]
    fn of_two_darts_with_one_place_and_one_rank_one_stays() {
        let domain = Domain::from_size([12.0, 12.0], 1.0, Boundary::Periodic).unwrap();
        let field = RadiusField::constant(domain, R).unwrap();
        let sight = Sight {
            octaves: [octave_of(R); 2],
            largest: R,
        };
        let dart = |x: i32| OpenDart::new(3, Point::new(x, 5), R, sight);
        // The last one is near neither of the others.
        let darts = [dart(7), dart(7), dart(3 * R)];
        let kept = Crowd::new(&field)
            .unwrap()
            .kept(&[&darts[..1], &darts[1..]]);
        assert_eq!(kept, [vec![darts[0].sample], vec![darts[2].sample]]);
    }
    /// Beside a few large radii a small one has a grid over the whole domain, and a set of one radius has that of its own.
    #[test]
    fn grids_of_all_octaves_are_counted() {
        let domain = Domain::from_size([64.0, 48.0], 1.0, Boundary::Periodic).unwrap();
        let grid = |octave: u32| CellGrid::new(domain.rect(), true, R.ilog2() + octave);
        let cells = 64 * 48;
        assert_eq!(heads_bytes(&[grid(0)]), 8 * cells);
        assert_eq!(heads_bytes(&[grid(0), grid(1)]), 8 * (cells + cells / 4));
    }
}
