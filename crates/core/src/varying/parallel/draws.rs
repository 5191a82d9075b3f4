//! The darts of active parts, drawn for eight parts or eight darts at a time: those of [`crate::stages::darts::cell_darts`]. A
//! part is an active cell within a base cell.

use fearless_simd::Simd;

use super::parcel::ActivePart;
use crate::lattice::Point;
use crate::random::{DRAW_LANES, Key, Stream, draw_by_eight};
use crate::stages::darts::{DartDraws, cell_dart, dart_count};
use crate::stages::disks::Cell;

/// A dart of a part, before anything is asked of its place.
#[derive(Clone, Copy)]
pub(super) struct PartDart {
    /// The place of its part among those for which darts were drawn.
    pub part: u8,
    /// The binary logarithm of the part's side.
    bits: u8,
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
    pub const PARTS: usize = 8 * DRAW_LANES;

    /// Draws the darts of at most [`Self::PARTS`] parts with the key of a throw. A part is two to the power
    /// `bits_of(part)` wide.
    #[inline(always)]
    pub fn draw<S: Simd>(
        &mut self,
        simd: S,
        throw_key: Key,
        parts: &[ActivePart],
        bits_of: impl Fn(&ActivePart) -> u32,
    ) {
        self.darts.clear();
        for (held, first) in parts.chunks(DRAW_LANES).zip((0..).step_by(DRAW_LANES)) {
            let mut counters = [[0; 2]; DRAW_LANES];
            for (counter, part) in counters.iter_mut().zip(held) {
                *counter = [part.min.x as u32, part.min.y as u32];
            }
            let words = draw_by_eight(simd, [throw_key; DRAW_LANES], counters);

            for ((part, words), number) in held.iter().zip(words).zip(first..) {
                let cell_key = Key::from_words(words);
                let bits = bits_of(part);
                for index in 0..dart_count(cell_key, 1 << bits) {
                    self.darts.push(PartDart {
                        part: number,
                        bits: bits as u8,
                        index,
                        cell_key,
                        rank: 0,
                        at: part.min,
                    });
                }
            }
        }

        // All darts are listed by now. Their ranks and places are drawn here.
        for held in self.darts.chunks_mut(DRAW_LANES) {
            let (mut keys, mut counters) = ([throw_key; DRAW_LANES], [[0; 2]; DRAW_LANES]);
            for ((key, counter), dart) in keys.iter_mut().zip(&mut counters).zip(&*held) {
                *key = dart.cell_key;
                *counter = [Stream::Dart as u32, dart.index];
            }
            let words = draw_by_eight(simd, keys, counters);

            for (dart, [halves, rank]) in held.iter_mut().zip(words) {
                let bits = u32::from(dart.bits);
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
