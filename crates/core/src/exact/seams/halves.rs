//! How far the halves of a range of columns or rows are from eight samples.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, i32x8};

/// Two ranges of places on one axis. Closures instead would not be inlined, and each of their vector operations would be a call.
pub(super) trait Halves: Copy {
    /// Returns how far the farther end of each half is from eight coordinates.
    fn farther<S: Simd>(self, simd: S, at: i32x8<S>) -> [i32x8<S>; 2];
}

/// The halves of twice `half` places.
#[derive(Clone, Copy)]
pub(super) struct EqualHalves {
    pub(super) first: i32,
    pub(super) half: i32,
}

impl Halves for EqualHalves {
    #[inline(always)]
    fn farther<S: Simd>(self, simd: S, at: i32x8<S>) -> [i32x8<S>; 2] {
        let from = at - self.first;
        let last = i32x8::splat(simd, self.half - 1) - from;
        // The other half begins and ends `half` farther.
        [from.max(last), (from - self.half).max(last + self.half)]
    }
}

/// The first and the last place of each half of a range of which an end was cut off.
#[derive(Clone, Copy)]
pub(super) struct CutHalves(pub(super) [[i32; 2]; 2]);

impl Halves for CutHalves {
    #[inline(always)]
    fn farther<S: Simd>(self, simd: S, at: i32x8<S>) -> [i32x8<S>; 2] {
        let [[a, b], [c, d]] = self.0;
        [
            (at - a).max(i32x8::splat(simd, b) - at),
            (at - c).max(i32x8::splat(simd, d) - at),
        ]
    }
}
