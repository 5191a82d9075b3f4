//! The darts of active parts, drawn for eight parts or eight darts at a time: those of [`crate::stages::darts::cell_darts`]. A
//! part is an active cell within a base cell.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, u32x8};

use super::parcel::ActivePart;
use crate::lattice::Point;
use crate::random::{Key, Stream, threefry2x32_20_by_eight};
use crate::stages::darts::{DartDraws, cell_dart, dart_count};
use crate::stages::disks::Cell;

/// How many parts, or darts, are drawn at once.
const LANES: usize = 8;

/// A dart of a part, before anything is asked of its place.
#[derive(Clone, Copy)]
pub(super) struct PartDart {
    /// The place of its part among those for which darts were drawn.
    pub part: u8,
    /// Its number in its part.
    pub index: u32,
    pub cell_key: Key,
    pub rank: u32,
    pub at: Point,
}

/// A buffer for the darts of some parts.
#[derive(Default)]
pub(super) struct DrawnDarts {
    pub darts: Vec<PartDart>,
}

impl DrawnDarts {
    /// For how many parts darts are drawn at a time.
    pub const PARTS: usize = 8 * LANES;

    /// Draws the darts of at most [`Self::PARTS`] parts with the key of a throw. A part is two to the power `bits` wide.
    #[inline(always)]
    pub fn draw<S: Simd>(
        &mut self,
        simd: S,
        throw_key: Key,
        parts: &[ActivePart],
        bits: impl Fn(&ActivePart) -> u32,
    ) {
        self.darts.clear();
        for (held, first) in parts.chunks(LANES).zip((0..).step_by(LANES)) {
            let mut counters = [[0; 2]; LANES];
            for (counter, part) in counters.iter_mut().zip(held) {
                *counter = [part.min.x as u32, part.min.y as u32];
            }
            let words = blocks(simd, [throw_key; LANES], counters);

            for ((part, words), number) in held.iter().zip(words).zip(first..) {
                let cell_key = key_of(words);
                for index in 0..dart_count(cell_key, 1 << bits(part)) {
                    self.darts.push(PartDart {
                        part: number,
                        index,
                        cell_key,
                        rank: 0,
                        at: part.min,
                    });
                }
            }
        }

        // Their numbers are drawn by now, and their ranks and places follow.
        for held in self.darts.chunks_mut(LANES) {
            let (mut keys, mut counters) = ([throw_key; LANES], [[0; 2]; LANES]);
            for ((key, counter), dart) in keys.iter_mut().zip(&mut counters).zip(&*held) {
                *key = dart.cell_key;
                *counter = [Stream::Dart as u32, dart.index];
            }
            let words = blocks(simd, keys, counters);

            for (dart, [halves, rank]) in held.iter_mut().zip(words) {
                let bits = bits(&parts[usize::from(dart.part)]);
                // A coordinate has 16 random bits, of which a cell takes the highest; wider cells draw more, one by one.
                if bits <= 16 {
                    let (right, up) = (
                        halves >> 16 >> (16 - bits),
                        (halves & 0xffff) >> (16 - bits),
                    );
                    dart.rank = rank;
                    dart.at = Point::new(dart.at.x + right as i32, dart.at.y + up as i32);
                } else {
                    let cell = Cell {
                        min: dart.at,
                        side: 1 << bits,
                    };
                    (dart.rank, dart.at) =
                        cell_dart(dart.cell_key, cell, DartDraws::Two, dart.index);
                }
            }
        }
    }
}

/// Returns the two random words of each of eight counters, each under its own key.
#[inline(always)]
fn blocks<S: Simd>(simd: S, keys: [Key; LANES], counters: [[u32; 2]; LANES]) -> [[u32; 2]; LANES] {
    let (mut first_keys, mut second_keys) = ([0; LANES], [0; LANES]);
    let (mut first_counters, mut second_counters) = ([0; LANES], [0; LANES]);
    for lane in 0..LANES {
        [first_keys[lane], second_keys[lane]] = keys[lane].words();
        [first_counters[lane], second_counters[lane]] = counters[lane];
    }
    let [firsts, seconds] = threefry2x32_20_by_eight(
        [
            u32x8::simd_from(simd, first_keys),
            u32x8::simd_from(simd, second_keys),
        ],
        [
            u32x8::simd_from(simd, first_counters),
            u32x8::simd_from(simd, second_counters),
        ],
    );
    let (firsts, seconds): ([u32; LANES], [u32; LANES]) = (firsts.into(), seconds.into());

    let mut words = [[0; 2]; LANES];
    for lane in 0..LANES {
        words[lane] = [firsts[lane], seconds[lane]];
    }
    words
}

/// Returns the key whose words were drawn.
#[inline(always)]
fn key_of([first, second]: [u32; 2]) -> Key {
    Key::from_seed(u64::from(second) << 32 | u64::from(first))
}
