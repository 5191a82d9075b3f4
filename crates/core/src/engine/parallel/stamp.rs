//! Coverage stamps: which of a cell's 8 x 8 pixels a sample surely covers, by the sample's cell and its position in it.
//! Stamps only prove coverage: a pixel that no stamp covers may still be covered.

use std::sync::OnceLock;

use crate::lattice::{R, R_SQUARED};

/// Pixels along a cell's side.
pub(crate) const PIXELS: usize = 8;

/// Units along a pixel's side.
pub(crate) const PIXEL_SIDE: i32 = R / PIXELS as i32;

/// Bins along a cell's side: a stamp is made for each of `BINS` x `BINS` squares of positions.
const BINS: usize = 1 << BIN_BITS;
const BIN_BITS: u32 = 5;
const BIN_SIDE: i32 = R / BINS as i32;

/// Bins of a table: a free slot reads as a position far above its cell, whose stamp is empty.
const ROOM: usize = 1 << (2 + 2 * BIN_BITS);

/// One table for each of the nine cells that a sample may lie in, seen from the cell whose pixels
/// are asked about: rows of cells first.
pub(crate) struct Stamps {
    tables: [Box<[u64; ROOM]>; 9],
}

impl Stamps {
    /// Returns the table, made once.
    pub(crate) fn get() -> &'static Self {
        static STAMPS: OnceLock<Stamps> = OnceLock::new();
        STAMPS.get_or_init(Self::new)
    }

    /// Returns the pixels that a slot's sample surely covers, as a bit for each; none for a free slot. `from`
    /// (0 to 8) says in which cell the slot is.
    #[inline(always)]
    pub(crate) fn stamp(&self, from: usize, packed: u32) -> u64 {
        // The highest bits of x and y, which a slot has in 15 bits each, with y above x.
        let x = (packed >> (15 - BIN_BITS)) as usize & (BINS - 1);
        let y = (packed >> (30 - BIN_BITS)) as usize;
        self.tables[from][y * BINS + x]
    }

    /// Computes the tables.
    fn new() -> Self {
        let tables = std::array::from_fn(|from| {
            let (column, row) = (from as i32 % 3 - 1, from as i32 / 3 - 1);
            // Made on the heap: the table would fill small stacks.
            let mut table = vec![0; ROOM].into_boxed_slice();
            for y in 0..BINS {
                for x in 0..BINS {
                    let bin = [
                        column * R + x as i32 * BIN_SIDE,
                        row * R + y as i32 * BIN_SIDE,
                    ];
                    table[y * BINS + x] = stamp_of_bin(bin);
                }
            }
            table.try_into().expect("it has ROOM entries")
        });
        Self { tables }
    }
}

/// Returns the pixels whose every point is within R of every point of the bin that starts at `bin`.
fn stamp_of_bin(bin: [i32; 2]) -> u64 {
    // The square of the largest distance along an axis: from the upper end of the pixel to the bin's lower one, or the
    // other way round.
    let farthest_squared = |bin_low: i32, pixel: usize| {
        let low = pixel as i32 * PIXEL_SIDE;
        let (high, bin_high) = (low + PIXEL_SIDE - 1, bin_low + BIN_SIDE - 1);
        i64::from((high - bin_low).abs().max((bin_high - low).abs())).pow(2)
    };
    let across: [i64; PIXELS] = std::array::from_fn(|pixel| farthest_squared(bin[0], pixel));
    let mut stamp = 0;
    for row in 0..PIXELS {
        let up = farthest_squared(bin[1], row);
        for (column, across) in across.iter().enumerate() {
            stamp |= u64::from(across + up <= R_SQUARED) << (row * PIXELS + column);
        }
    }
    stamp
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::covers_offset;
    use crate::random::{Key, Stream, below};

    #[test]
    fn a_stamped_pixel_is_covered_and_most_covered_pixels_are_stamped() {
        let stamps = Stamps::get();
        let (mut stamped, mut covered) = (0, 0);
        for k in 0..2_000 {
            let [x, y] = Key::from_seed(4)
                .draw(Stream::Dart, k)
                .map(|w| below(w, R as u32) as i32);
            for from in 0..9 {
                let (column, row) = (from % 3 - 1, from / 3 - 1);
                let stamp = stamps.stamp(from as usize, (y << 15 | x) as u32);
                for pixel in 0..64 {
                    let corner = |k: i32| k * PIXEL_SIDE;
                    let (left, bottom) = (corner(pixel % 8), corner(pixel / 8));
                    let all = [(0, 0), (1, 0), (0, 1), (1, 1)].iter().all(|(right, up)| {
                        let px = left + right * (PIXEL_SIDE - 1) - (x + column * R);
                        let py = bottom + up * (PIXEL_SIDE - 1) - (y + row * R);
                        covers_offset(glam::IVec2::new(px, py))
                    });
                    let is_stamped = stamp >> pixel & 1 == 1;
                    assert!(all || !is_stamped, "{x} {y} from {from}, pixel {pixel}");
                    stamped += u32::from(is_stamped);
                    covered += u32::from(all);
                }
            }
        }
        assert!(stamped * 100 > covered * 85, "{stamped} of {covered}");
    }
}
