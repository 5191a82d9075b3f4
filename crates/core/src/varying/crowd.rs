//! The darts of one throw, and which of them become samples: each that comes before all darts near it, or before those of them
//! that become samples.
//!
//! Taken by rank one after another, a dart looks at the samples so far. Here each dart first lists the darts near it that come
//! earlier, on all threads, and then lists are read by rank: the same darts are kept, and what is left to one thread is little.

use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;

use super::field::RadiusField;
use super::octaves::{Sight, octave_of};
use super::rule::{is_near, reach};
use crate::lattice::Point;
use crate::stages::cells::CellGrid;

/// Darts that one thread lists at a time.
const PORTION: usize = 1 << 10;

/// A dart that no sample so far is near.
#[derive(Clone, Copy, Debug)]
pub(super) struct OpenDart {
    pub rank: u32,
    pub at: Point,
    pub radius: i32,
    /// Which radii a dart or a sample near it may have.
    pub sight: Sight,
}

impl OpenDart {
    /// Returns what darts are taken by. Equal ranks are decided by place, so that the sequence of cells does not matter.
    fn order(&self) -> (u32, (i32, i32)) {
        (self.rank, self.at.row_major())
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
    /// One more than the number of the last dart that was put into each cell, or 0.
    heads: Vec<AtomicU32>,
}

/// Darts that come earlier than others near them.
#[derive(Default)]
struct EarlierDarts {
    /// The darts that have such ones, and where the list of each ends.
    of: Vec<(u32, u32)>,
    earlier: Vec<u32>,
}

impl Crowd {
    /// Returns empty grids for darts of the field's radii.
    pub fn new(field: &RadiusField) -> Self {
        let domain = field.domain();
        let octave = |bits: u8| {
            let grid = CellGrid::new(domain.rect(), domain.is_periodic(), bits.into());
            OctaveDarts {
                heads: (0..grid.count()).map(|_| AtomicU32::new(0)).collect(),
                grid,
            }
        };
        let [first, last] = field.extremes().map(octave_of);
        Self {
            first,
            octaves: (first..=last).map(octave).collect(),
        }
    }

    /// Returns the numbers of the darts that become samples, in the order of their ranks.
    pub fn kept(&self, darts: &[OpenDart]) -> Vec<u32> {
        // Which dart of a cell comes first in its chain depends on the threads. All of them are looked at, so that the result
        // does not.
        let mut next = Vec::new();
        darts
            .par_iter()
            .enumerate()
            .map(|(index, dart)| self.head(dart).swap(index as u32 + 1, Ordering::Relaxed))
            .collect_into_vec(&mut next);

        let portions = darts.par_chunks(PORTION).enumerate();
        let lists: Vec<EarlierDarts> = portions
            .map(|(portion, of)| self.list(darts, &next, portion * PORTION, of.len()))
            .collect();
        darts
            .par_iter()
            .for_each(|dart| self.head(dart).store(0, Ordering::Relaxed));

        let mut is_kept = vec![true; darts.len()];
        decide(darts, &lists, &mut is_kept);
        let kept = (0..darts.len() as u32).filter(|&index| is_kept[index as usize]);
        in_order(darts, kept.collect())
    }

    /// Returns the head of the chain of a dart's cell.
    fn head(&self, dart: &OpenDart) -> &AtomicU32 {
        let octave = &self.octaves[usize::from(octave_of(dart.radius) - self.first)];
        &octave.heads[octave.grid.cell_at(dart.at)]
    }

    /// Lists the earlier darts near each of `count` darts from the number `begin` on.
    fn list(&self, darts: &[OpenDart], next: &[u32], begin: usize, count: usize) -> EarlierDarts {
        let mut lists = EarlierDarts::default();
        for index in begin..begin + count {
            let before = lists.earlier.len();
            self.add_earlier(darts, next, index as u32, &mut lists.earlier);
            if lists.earlier.len() > before {
                lists.of.push((index as u32, lists.earlier.len() as u32));
            }
        }
        lists
    }

    /// Appends the numbers of the darts near the dart of the number `own` that come before it.
    fn add_earlier(&self, darts: &[OpenDart], next: &[u32], own: u32, out: &mut Vec<u32>) {
        let dart = &darts[own as usize];
        let OpenDart {
            at, radius, sight, ..
        } = *dart;
        let [first, last] = sight.octaves.map(|bits| usize::from(bits - self.first));

        for (octave, bits) in self.octaves[first..=last].iter().zip(sight.octaves[0]..) {
            // All radii of an octave are below twice the side of its cells.
            let end = 2 << bits;
            let farthest = reach(sight.largest.min(end - 1), radius);
            octave.grid.any_range(at, farthest, |range, shift| {
                for head in &octave.heads[range] {
                    let mut number = head.load(Ordering::Relaxed);
                    while let Some(index) = number.checked_sub(1) {
                        number = next[index as usize];
                        let other = &darts[index as usize];
                        // Half of all darts come later, which is found before any distance.
                        if other.rank > dart.rank {
                            continue;
                        }

                        // The wrapped sums are right, as the offsets of darts found here are short.
                        let dx = other.at.x.wrapping_add(shift.x).wrapping_sub(at.x);
                        let dy = other.at.y.wrapping_add(shift.y).wrapping_sub(at.y);
                        let squared = i64::from(dx) * i64::from(dx) + i64::from(dy) * i64::from(dy);
                        // Two darts of one cell may have one place and one rank: the first one counts as earlier, so that
                        // they do not both stay.
                        let is_earlier = (other.order(), index) < (dart.order(), own);
                        if is_near(squared, other.radius, radius) && is_earlier {
                            out.push(index);
                        }
                    }
                }
                // The search goes on to all darts.
                false
            });
        }
    }
}

/// Sets `is_kept` to false for each dart that is near an earlier one which is kept. All darts begin as kept.
fn decide(darts: &[OpenDart], lists: &[EarlierDarts], is_kept: &mut [bool]) {
    // A dart with a list is known by its number, the portion that listed it, and its place among the lists there.
    let mut listed: Vec<(u32, u32, u32)> = Vec::new();
    for (portion, list) in (0..).zip(lists) {
        listed.extend(
            (0..)
                .zip(&list.of)
                .map(|(place, &(dart, _))| (dart, portion, place)),
        );
    }
    listed.par_sort_unstable_by_key(|&(dart, ..)| darts[dart as usize].order());

    for (dart, portion, place) in listed {
        let list = &lists[portion as usize];
        let place = place as usize;
        let begin = place.checked_sub(1).map_or(0, |before| list.of[before].1);
        let earlier = &list.earlier[begin as usize..list.of[place].1 as usize];
        // Those before it are decided already.
        is_kept[dart as usize] = !earlier.iter().any(|&other| is_kept[other as usize]);
    }
}

/// Returns the numbers of darts in the order of their ranks.
fn in_order(darts: &[OpenDart], numbers: Vec<u32>) -> Vec<u32> {
    // The rank in the higher half of a word decides nearly always.
    let keyed = |number: u32| u64::from(darts[number as usize].rank) << 32 | u64::from(number);
    let mut keys: Vec<u64> = numbers.into_par_iter().map(keyed).collect();
    keys.par_sort_unstable_by(|&a, &b| {
        let dart = |key: u64| &darts[key as u32 as usize];
        (a >> 32)
            .cmp(&(b >> 32))
            .then_with(|| dart(a).order().cmp(&dart(b).order()))
    });
    keys.into_iter().map(|key| key as u32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::{Boundary, Domain, R};

    #[test]
    fn of_two_darts_with_one_place_and_one_rank_one_stays() {
        let domain = Domain::from_size([12.0, 12.0], 1.0, Boundary::Periodic).unwrap();
        let field = RadiusField::constant(domain, R).unwrap();
        let dart = |x: i32| OpenDart {
            rank: 3,
            at: Point::new(x, 5),
            radius: R,
            sight: Sight {
                octaves: [octave_of(R); 2],
                largest: R,
            },
        };
        // The third one is near neither of the others.
        let darts = [dart(7), dart(7), dart(3 * R)];
        assert_eq!(Crowd::new(&field).kept(&darts), [0_u32, 2]);
    }
}
