//! Pixels: the 8 x 8 squares of a cell, the unit of coverage stamps.

use super::super::near::MeasuredPixel;
use super::super::stamp::{PIXEL_SIDE, PIXELS};

/// A pixel that no single sample is known to cover.
#[derive(Clone, Copy)]
pub(super) struct Pixel {
    /// The samples that may make a candidate in it, as bits of the gathered samples.
    pub sites: u64,
    /// The distance from its centre to the nearest sample when that was measured.
    pub nearest: f32,
    /// Its number in the cell, 0 to 63, row by row.
    pub number: u8,
}

/// A pixel with the number of its cell.
#[derive(Clone, Copy)]
pub(super) struct PlacedPixel {
    pub cell: usize,
    pub pixel: Pixel,
}

impl Pixel {
    pub(super) fn new(number: u8, measured: &MeasuredPixel) -> Self {
        Self {
            sites: measured.sites,
            nearest: measured.nearest,
            number,
        }
    }
}

/// Returns the lowest corner of a pixel in its cell.
#[inline(always)]
pub(crate) const fn corner(number: u8) -> (i32, i32) {
    (
        (number as i32 % PIXELS as i32) * PIXEL_SIDE,
        (number as i32 / PIXELS as i32) * PIXEL_SIDE,
    )
}

/// Returns the middle of a pixel in its cell.
#[inline(always)]
pub(super) fn centre(number: u8) -> (f32, f32) {
    let (x, y) = corner(number);
    ((x + PIXEL_SIDE / 2) as f32, (y + PIXEL_SIDE / 2) as f32)
}

/// Returns the numbers of the bits that are set, the lowest first.
#[inline(always)]
pub(crate) fn each_bit(mut bits: u64) -> impl Iterator<Item = u8> {
    std::iter::from_fn(move || {
        let bit = bits.trailing_zeros() as u8;
        // The bit is taken away from those that are left; without any, the iterator ends.
        (bits != 0).then(|| bits &= bits - 1)?;
        Some(bit)
    })
}

/// Returns the pixels of the open cell at `index`.
pub(super) fn pixels_of<'a>(first: &[u32], pixels: &'a [Pixel], index: u32) -> &'a [Pixel] {
    let end = first
        .get(index as usize + 1)
        .map_or(pixels.len(), |&next| next as usize);
    &pixels[first[index as usize] as usize..end]
}
