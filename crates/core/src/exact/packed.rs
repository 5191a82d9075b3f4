//! The entries of a pattern's history, in few bytes: there are many of them, and they are read at places all over the pattern.

use glam::IVec2;

use crate::exact::darts::Arrival;
use crate::lattice::R;

/// A throw of the levels that are kept takes three bits.
const THROW_BITS: u32 = 3;

/// A refused dart, in 12 bytes.
#[derive(Clone, Copy)]
pub(super) struct Refused {
    rank: u32,
    /// From the highest bit on: how far right of its first blocker it is, counted from R to the left of that; the throw, counted
    /// over all levels that are kept; and the highest bits of its second blocker.
    right: u32,
    /// How far above its first blocker it is, counted from R below that; and the other bits of its second blocker.
    up: u32,
}

/// The bits of an offset of at most R, made positive.
const OFFSET_BITS: u32 = 17;

/// The bits beside an offset and a throw, and beside an offset.
const SECOND_HIGH: u32 = 32 - OFFSET_BITS - THROW_BITS;
const SECOND_LOW: u32 = 32 - OFFSET_BITS;

impl Refused {
    pub(super) fn new(arrival: Arrival, offset: IVec2, second: SecondBlocker) -> Self {
        // Level 0 has four throws, level 1 one.
        let throw = 4 * arrival.level() + arrival.throw();
        let positive = |at: i32| ((at + R) as u32) << SECOND_LOW;
        Self {
            rank: arrival.rank(),
            right: positive(offset.x) | throw << SECOND_HIGH | second.0 >> SECOND_LOW,
            up: positive(offset.y) | (second.0 % (1 << SECOND_LOW)),
        }
    }

    #[inline]
    pub(super) const fn arrival(self) -> Arrival {
        let throw = self.right >> SECOND_HIGH & ((1 << THROW_BITS) - 1);
        Arrival::new(throw / 4, throw % 4, self.rank)
    }

    #[inline]
    pub(super) const fn offset(self) -> IVec2 {
        let [x, y] = [self.right, self.up];
        IVec2::new((x >> SECOND_LOW) as i32 - R, (y >> SECOND_LOW) as i32 - R)
    }

    /// Returns whether its offset lies within bounds.
    #[inline]
    pub(super) const fn lies_in(self, bounds: &OffsetBounds) -> bool {
        // Unsigned, an offset below the lowest one is far too long.
        let [x, y] = [self.right, self.up];
        (x >> SECOND_LOW).wrapping_sub(bounds.low[0]) < bounds.extent[0]
            && (y >> SECOND_LOW).wrapping_sub(bounds.low[1]) < bounds.extent[1]
    }

    #[inline]
    pub(super) const fn second(self) -> SecondBlocker {
        let high = self.right % (1 << SECOND_HIGH);
        SecondBlocker(high << SECOND_LOW | (self.up % (1 << SECOND_LOW)))
    }
}

/// The offsets in a rectangle, as refused darts have them.
pub(super) struct OffsetBounds {
    low: [u32; 2],
    extent: [u32; 2],
}

impl OffsetBounds {
    /// Returns the offsets from `low` to `high`, both included, of those that are at most R on both axes.
    pub(super) fn new(low: IVec2, high: IVec2) -> Self {
        // Bounds beyond R would not fit the bits. There may be no offsets: then `end` is at most `low`.
        let low = low.clamp(IVec2::splat(-R), IVec2::splat(R + 1));
        let end = high.clamp(IVec2::splat(-R - 1), IVec2::splat(R)) + 1;
        let extent = (end - low).max(IVec2::ZERO);
        Self {
            low: [low.x, low.y].map(|at| (at + R) as u32),
            extent: [extent.x, extent.y].map(|at| at as u32),
        }
    }
}

/// The second sample of the pattern that covers a refused dart and arrived before it, in 27 bits: about where it lies, and the last
/// eight bits of its number. While it is present, the dart stays refused without its first blocker.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SecondBlocker(u32);

/// The accuracy of where a second blocker lies. One that is present is taken for missing if it lies so near a block's
/// border or the frame's edge, if the last eight bits of its number are those of a lost sample, or if its offset
/// reaches R. This costs a question, never a sample.
const SECOND_UNIT: i32 = 1 << SECOND_UNIT_BITS;
const SECOND_UNIT_BITS: u32 = 7;

/// The bits of an offset of less than R, made positive, to that accuracy.
const SECOND_BITS: u32 = (2 * R as u32).ilog2() - SECOND_UNIT_BITS;

impl SecondBlocker {
    /// No sample.
    pub(super) const NONE: Self = Self(1 << (8 + 2 * SECOND_BITS));

    /// How far it may be from [`Self::offset`], on each axis.
    pub(crate) const REACH: i32 = SECOND_UNIT / 2;

    /// Returns a sample at an offset from the dart.
    pub(super) fn new(sample: u32, offset: IVec2) -> Self {
        // The longest offsets do not fit. A dart so far from its second blocker is taken to have none.
        if offset.max_element() >= R {
            return Self::NONE;
        }
        let [x, y] = [offset.x, offset.y].map(|at| ((at + R) as u32) >> SECOND_UNIT_BITS);
        Self(x << (8 + SECOND_BITS) | y << 8 | (sample % 256))
    }

    /// Returns whether there is one.
    #[inline]
    pub(crate) const fn is_some(self) -> bool {
        self.0 < Self::NONE.0
    }

    /// Returns about where it lies, counted from the dart.
    #[inline]
    pub(crate) const fn offset(self) -> IVec2 {
        let mask = (1 << SECOND_BITS) - 1;
        let (x, y) = (self.0 >> (8 + SECOND_BITS) & mask, self.0 >> 8 & mask);
        // The middle of the places that it may have.
        let [x, y] = [x << SECOND_UNIT_BITS, y << SECOND_UNIT_BITS];
        IVec2::new(x as i32 + Self::REACH - R, y as i32 + Self::REACH - R)
    }

    /// Returns the last eight bits of its number.
    #[inline]
    pub(crate) const fn number(self) -> u32 {
        self.0 % 256
    }
}

/// An early sample that covers all of a cell of half a radius, in 4 bytes: where it lies to [`COVERING_UNIT`], and the last eight
/// bits of its number.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) struct CoveringSample(u32);

/// The accuracy of where a covering sample lies. A sample that is present is taken for missing only if it lies so near a
/// block's border, or if the last eight bits of its number are those of a lost sample.
pub(super) const COVERING_UNIT: i32 = 1 << COVERING_BITS;
const COVERING_BITS: u32 = 4;

/// A covering sample lies less than R left of its cell or below it; so offsets are made positive.
const COVERING_REACH: i32 = R;

impl CoveringSample {
    /// No sample: no offset is so long.
    pub(super) const NONE: Self = Self(u32::MAX);

    /// Returns a sample at an offset from the cell's lowest place.
    pub(super) const fn new(sample: u32, offset: IVec2) -> Self {
        let [x, y] = [offset.x, offset.y];
        let x = (x + COVERING_REACH) as u32 >> COVERING_BITS;
        let y = (y + COVERING_REACH) as u32 >> COVERING_BITS;
        Self(x << 20 | y << 8 | (sample % 256))
    }

    /// Returns a number with the last eight bits of the sample's.
    #[inline]
    pub(super) const fn number(self) -> u32 {
        self.0
    }

    /// Returns the lowest offset that it may have; it may be up to a [`COVERING_UNIT`] more on each axis.
    #[inline]
    pub(super) const fn lowest(self) -> IVec2 {
        let x = (self.0 >> 20 << COVERING_BITS) as i32;
        let y = (self.0 >> 8 << COVERING_BITS) as i32 & (0xfff << COVERING_BITS);
        IVec2::new(x - COVERING_REACH, y - COVERING_REACH)
    }
}
