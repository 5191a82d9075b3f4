//! Random sequential addition on coarse lattices, by the plain rule: places come in random order, and one that no earlier
//! sample covers is a sample. The reference sampler has this law with 32,768 units to r. What a lattice leaves out is in
//! proportion to its spacing, and on coarse ones it is large enough to be measured.

use std::f64::consts::PI;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use tilescope_core::{Key, Stream, below};

use super::sums::CountSums;
use crate::control::Control;
use crate::error::{ReproduceError, Result};

/// Units to r of the lattices. Below 8 a disk is no longer round; above 32 a lattice leaves out too few samples to be
/// worth the time that a set takes.
pub const RADII: [u16; 5] = [8, 12, 16, 24, 32];
/// Side of the torus in radii. Chosen, not measured.
const SIDE: u16 = 16;

/// Sets on one coarse lattice, counted.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CoarseSets {
    /// Units to r.
    pub radius: u16,
    /// The places that a sample covers, its own among them.
    pub covered: usize,
    pub sums: CountSums,
}

impl CoarseSets {
    /// Makes and counts a set of each seed, on all threads.
    pub fn made(radius: u16, seeds: Vec<u64>, control: &Control<'_>) -> Result<Self> {
        let disk = disk(radius.into());
        let each = seeds.into_par_iter().map(|seed| {
            if control.flow().is_break() {
                return Err(ReproduceError::Cancelled);
            }
            // The radius goes into the key, so that sets of one seed on two lattices have different draws. Any other
            // stream would do as well.
            let key = Key::from_seed(seed).derive(Stream::Order, radius.into());
            Ok(CountSums::of(count(i32::from(SIDE * radius), &disk, key)))
        });

        let sums = each.try_reduce(CountSums::default, |a, b| Ok(a.joined(b)))?;
        Ok(Self {
            radius,
            covered: disk.len(),
            sums,
        })
    }

    /// Returns the density and its standard error, for the radius of a disk as large as what a sample covers: the places in
    /// a circle are not quite its area.
    pub fn density(&self) -> [f64; 2] {
        let side = f64::from(SIDE) * f64::from(self.radius);
        let scale = self.covered as f64 / (PI * side * side);
        [self.sums.mean() * scale, self.sums.error() * scale]
    }
}

/// Returns the offsets of all places within a radius.
fn disk(radius: i32) -> Vec<[i32; 2]> {
    let rows = -radius..=radius;
    let all = rows.flat_map(|y| (-radius..=radius).map(move |x| [x, y]));
    all.filter(|[x, y]| x * x + y * y <= radius * radius)
        .collect()
}

/// Stands in `slots` for a place that is no longer open.
const GONE: u32 = u32::MAX;

/// The places of a torus that no sample covers.
struct OpenPlaces {
    side: i32,
    open: Vec<u32>,
    /// Where in `open` each place is.
    slots: Vec<u32>,
}

impl OpenPlaces {
    fn all(side: i32) -> Self {
        let open: Vec<u32> = (0..(side * side) as u32).collect();
        let slots = open.clone();
        Self { side, open, slots }
    }

    /// Removes the places of a disk about a place.
    fn cover(&mut self, place: u32, disk: &[[i32; 2]]) {
        let (x, y) = (place as i32 % self.side, place as i32 / self.side);
        for [right, up] in disk {
            let [column, row] = [x + right, y + up].map(|along| along.rem_euclid(self.side));
            let covered = (row * self.side + column) as usize;

            let slot = std::mem::replace(&mut self.slots[covered], GONE);
            if slot != GONE {
                self.open.swap_remove(slot as usize);
                // The last place of the list has come into the slot, unless it was the covered one itself.
                if let Some(&moved) = self.open.get(slot as usize) {
                    self.slots[moved as usize] = slot;
                }
            }
        }
    }
}

/// Returns the number of samples of a set on a torus of `side` units.
fn count(side: i32, disk: &[[i32; 2]], key: Key) -> usize {
    let mut places = OpenPlaces::all(side);
    let mut samples = 0;
    // A uniform open place is the next in a random order that no sample covers.
    while !places.open.is_empty() {
        let [word, _] = key.draw(Stream::Sequence, samples);
        let place = places.open[below(word, places.open.len() as u32) as usize];
        places.cover(place, disk);
        samples += 1;
    }
    samples as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_set_covers_every_place_and_its_samples_do_not_cover_each_other() {
        let (side, radius) = (60, 5);
        let disk = disk(radius);
        assert_eq!(disk.len(), 81);
        let key = Key::from_seed(3);
        let samples = count(side, &disk, key);
        // A sample covers 81 places and shares most of them: at saturation each place is covered about twice.
        assert!((70..110).contains(&samples), "{samples}");
        assert_eq!(count(side, &disk, key), samples);
        assert_ne!(count(side, &disk, Key::from_seed(4)), samples);

        let mut places = OpenPlaces::all(side);
        places.cover(0, &disk);
        assert_eq!(places.open.len(), 3600 - 81);
        places.cover(1, &disk);
        // Of a disk that is moved by one place a column of eleven rows is new.
        assert_eq!(places.open.len(), 3600 - 81 - 11);
        assert!(
            (places.open.iter().zip(0..))
                .all(|(place, slot)| places.slots[*place as usize] == slot)
        );
    }
}
