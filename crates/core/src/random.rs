//! Counter-based random draws: Threefry2x32-20 (Salmon et al. 2011), keyed by the purpose of the draw and the number or
//! position that it is for. No generator state exists, so no draw depends on the order in which draws are made: any
//! block, cell or candidate can be visited alone, on any thread or device.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, u32x8};

/// The purpose of a draw. The streams of a key are independent of each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Stream {
    /// The key of the KD-tree's root and of a node's children.
    Split = 1,
    /// The plane that splits a node.
    Plane = 2,
    /// Where a block's clip starts in the pattern.
    Offset = 3,
    /// The rotation or mirror image of the pattern that a block clips from.
    Dihedral = 4,
    /// The rank of a sample in the random elimination order.
    Order = 5,
    /// The sequence of the phase groups.
    Phase = 6,
    /// The key of an iteration of insertion.
    Iteration = 7,
    /// The key of a level of the dart process.
    Level = 8,
    /// A dart of a cell.
    Dart = 9,
    /// The seed of a pattern.
    Pattern = 10,
    /// The key of one of a level's throws.
    Throw = 11,
    /// The key of a level of nested levels.
    Nested = 12,
    /// The place of a sample among those of its level.
    Sequence = 13,
    /// Whether a dart stays where the radius is larger than the side of its base cell.
    Thin = 14,
    /// The place of a point in the order in which a cloud is thinned.
    Priority = 15,
    /// The key of a plane of cells in three dimensions.
    Depth = 16,
    /// The rank of a dart in three dimensions.
    Rank = 17,
}

/// A 64-bit key from which draws and further keys are derived.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub struct Key([u32; 2]);

impl Key {
    /// Returns the key of a user's seed.
    #[must_use]
    pub const fn from_seed(seed: u64) -> Self {
        Self([seed as u32, (seed >> 32) as u32])
    }

    /// Returns the two words drawn for `index` of `stream`.
    #[inline]
    #[must_use]
    pub const fn draw(self, stream: Stream, index: u32) -> [u32; 2] {
        threefry2x32_20(self.0, [stream as u32, index])
    }

    /// Returns the key derived for `index` of `stream`.
    #[inline]
    #[must_use]
    pub const fn derive(self, stream: Stream, index: u32) -> Self {
        Self(self.draw(stream, index))
    }

    /// Returns the two words drawn for a lattice point. The key must be a derived one that is used for points only.
    #[inline]
    #[must_use]
    pub const fn draw_at(self, x: i32, y: i32) -> [u32; 2] {
        threefry2x32_20(self.0, [x as u32, y as u32])
    }

    /// Returns the key derived for a lattice point, as [`Self::draw_at`].
    #[inline]
    #[must_use]
    pub const fn derive_at(self, x: i32, y: i32) -> Self {
        Self(self.draw_at(x, y))
    }

    /// Returns the key whose words were drawn.
    #[inline]
    pub(crate) const fn from_words(words: [u32; 2]) -> Self {
        Self(words)
    }

    /// Returns the key's words.
    #[must_use]
    pub const fn words(self) -> [u32; 2] {
        self.0
    }
}

/// Returns `word` mapped to `[0, n)`: the high half of the 32 x 32-bit product.
#[inline]
#[must_use]
pub const fn below(word: u32, n: u32) -> u32 {
    ((word as u64 * n as u64) >> 32) as u32
}

/// Parity word of Threefry (Salmon et al. 2011), as in Random123.
const PARITY: u32 = 0x1BD1_1BDA;

/// How far the second word turns in each of four rounds, for even and for odd groups of rounds, as in Random123.
const EVEN: [u32; 4] = [13, 15, 26, 6];
const ODD: [u32; 4] = [17, 29, 16, 24];

/// Returns the Threefry2x32 block of `counter` under `key`, 20 rounds.
#[inline]
#[must_use]
pub const fn threefry2x32_20(key: [u32; 2], counter: [u32; 2]) -> [u32; 2] {
    let keys = [key[0], key[1], PARITY ^ key[0] ^ key[1]];
    let mut x = [
        counter[0].wrapping_add(keys[0]),
        counter[1].wrapping_add(keys[1]),
    ];
    // Written out: as a loop over rounds it is not unrolled, and takes four times the instructions.
    x = four_rounds(x, EVEN, keys, 1);
    x = four_rounds(x, ODD, keys, 2);
    x = four_rounds(x, EVEN, keys, 3);
    x = four_rounds(x, ODD, keys, 4);
    four_rounds(x, EVEN, keys, 5)
}

/// Returns the words after four rounds and the injection of the key that follows them. Each injection turns the key and adds
/// its number, so that rounds differ.
#[expect(
    clippy::inline_always,
    reason = "rotations are constants only where it is inlined"
)]
#[inline(always)]
const fn four_rounds(
    [mut x0, mut x1]: [u32; 2],
    [a, b, c, d]: [u32; 4],
    keys: [u32; 3],
    injection: u32,
) -> [u32; 2] {
    // A round of Threefry adds the second word to the first, turns it, and mixes in the sum.
    x0 = x0.wrapping_add(x1);
    x1 = x1.rotate_left(a) ^ x0;
    x0 = x0.wrapping_add(x1);
    x1 = x1.rotate_left(b) ^ x0;
    x0 = x0.wrapping_add(x1);
    x1 = x1.rotate_left(c) ^ x0;
    x0 = x0.wrapping_add(x1);
    x1 = x1.rotate_left(d) ^ x0;

    // The three words of the key are taken in turn, and the number of the injection is added.
    let next = keys[(injection as usize + 1) % 3];
    [
        x0.wrapping_add(keys[injection as usize % 3]),
        x1.wrapping_add(next).wrapping_add(injection),
    ]
}

/// How many blocks are drawn at once.
pub(crate) const DRAW_LANES: usize = 8;

/// Returns the two words drawn for each of eight counters, each under its own key.
#[expect(
    clippy::inline_always,
    reason = "only code that is inlined may use the vector instructions"
)]
#[inline(always)]
pub(crate) fn draw_by_eight<S: Simd>(
    simd: S,
    keys: [Key; DRAW_LANES],
    counters: [[u32; 2]; DRAW_LANES],
) -> [[u32; 2]; DRAW_LANES] {
    // The vectors need the first words of all keys side by side, and the second ones, and so for counters.
    let (mut first_keys, mut second_keys) = ([0; DRAW_LANES], [0; DRAW_LANES]);
    let (mut first_counters, mut second_counters) = ([0; DRAW_LANES], [0; DRAW_LANES]);
    for lane in 0..DRAW_LANES {
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
    let (firsts, seconds): ([u32; DRAW_LANES], [u32; DRAW_LANES]) = (firsts.into(), seconds.into());

    let mut words = [[0; 2]; DRAW_LANES];
    for lane in 0..DRAW_LANES {
        words[lane] = [firsts[lane], seconds[lane]];
    }
    words
}

/// Returns what [`threefry2x32_20`] returns, for eight keys and counters at once.
#[expect(
    clippy::inline_always,
    reason = "only code that is inlined may use the vector instructions"
)]
#[inline(always)]
pub(crate) fn threefry2x32_20_by_eight<S: Simd>(
    [a, b]: [u32x8<S>; 2],
    counters: [u32x8<S>; 2],
) -> [u32x8<S>; 2] {
    let keys = [a, b, a ^ b ^ PARITY];
    let mut x0 = counters[0] + a;
    let mut x1 = counters[1] + b;
    // Each group does what `four_rounds` does.
    for (group, turns) in (1..).zip([EVEN, ODD, EVEN, ODD, EVEN]) {
        for turn in turns {
            x0 += x1;
            x1 = ((x1 << turn) | (x1 >> (u32::BITS - turn))) ^ x0;
        }
        x0 += keys[group % 3];
        x1 = x1 + keys[(group + 1) % 3] + group as u32;
    }
    [x0, x1]
}

#[cfg(test)]
mod tests {
    use fearless_simd::dispatch;

    use super::*;
    use crate::instructions::InstructionSet;

    /// Known answers published with Random123 (threefry2x32, 20 rounds).
    #[test]
    fn known_answers() {
        let ones = [u32::MAX; 2];
        assert_eq!(threefry2x32_20([0; 2], [0; 2]), [0x6b20_0159, 0x99ba_4efe]);
        assert_eq!(threefry2x32_20(ones, ones), [0x1cb9_96fc, 0xbb00_2be7]);
        assert_eq!(
            threefry2x32_20([0x1319_8a2e, 0x0370_7344], [0x243f_6a88, 0x85a3_08d3]),
            [0xc492_3a9c, 0x483d_f7a0]
        );
    }

    #[test]
    fn eight_draws_are_those_of_each_key_on_every_instruction_set() {
        let keys: [Key; DRAW_LANES] =
            std::array::from_fn(|lane| Key::from_seed(lane as u64 * 0x1234_5678_9abc));
        let counters: [[u32; 2]; DRAW_LANES] =
            std::array::from_fn(|lane| [lane as u32, u32::MAX - lane as u32]);
        let expected: [[u32; 2]; DRAW_LANES] =
            std::array::from_fn(|lane| threefry2x32_20(keys[lane].words(), counters[lane]));
        for set in InstructionSet::available() {
            let drawn: [[u32; 2]; DRAW_LANES] =
                dispatch!(set.level(), simd => draw_by_eight(simd, keys, counters));
            assert_eq!(drawn, expected, "{set:?}");
        }
    }

    #[test]
    fn below_reaches_both_ends_and_stays_inside() {
        assert_eq!(below(0, 7), 0);
        assert_eq!(below(u32::MAX, 7), 6);
        assert_eq!(below(u32::MAX, 1), 0);
        let mut seen = [0_u32; 7];
        for index in 0..7000 {
            seen[below(Key::from_seed(1).draw(Stream::Order, index)[0], 7) as usize] += 1;
        }
        assert!(seen.iter().all(|&n| (850..1150).contains(&n)), "{seen:?}");
    }

    #[test]
    fn streams_and_indices_differ() {
        let key = Key::from_seed(42);
        assert_ne!(key.draw(Stream::Split, 0), key.draw(Stream::Plane, 0));
        assert_ne!(key.draw(Stream::Split, 0), key.draw(Stream::Split, 1));
        assert_ne!(
            key.derive(Stream::Split, 0),
            Key::from_seed(43).derive(Stream::Split, 0)
        );
        assert_ne!(Key::from_seed(1 << 32), Key::from_seed(0));
    }
}
