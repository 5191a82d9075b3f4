//! Inputs, random and adversarial: the same in every run.

use std::f64::consts::TAU;

use glam::{DVec2, I64Vec2, IVec2};
use tilescope_core::{Key, R, R_SQUARED, Stream, below};

use super::Words;

/// The largest component of an offset that circumcentres and lines are defined for.
pub const OFFSET_LIMIT: i64 = 1 << 18;

/// Words at which carries, signs and halves of words change.
const EDGES: [u32; 18] = [
    0,
    1,
    2,
    3,
    0x7FFF,
    0x8000,
    0xFFFF,
    0x1_0000,
    0x1_0001,
    0x7FFF_FFFE,
    0x7FFF_FFFF,
    0x8000_0000,
    0x8000_0001,
    0xFFFE_FFFF,
    0xFFFF_0000,
    0xFFFF_7FFF,
    0xFFFF_FFFE,
    0xFFFF_FFFF,
];

/// A sequence of numbers determined by a seed.
pub struct Numbers {
    key: Key,
    index: u32,
}

impl Numbers {
    /// Returns the sequence of a seed.
    pub const fn new(seed: u64) -> Self {
        Self {
            key: Key::from_seed(seed),
            index: 0,
        }
    }

    /// Returns two words.
    pub const fn pair(&mut self) -> [u32; 2] {
        self.index += 1;
        self.key.draw(Stream::Order, self.index)
    }

    /// Returns a number of `low..=high`, which are less than 2^32 apart.
    pub fn between(&mut self, low: i64, high: i64) -> i64 {
        low + i64::from(below(self.pair()[0], (high - low + 1) as u32))
    }

    /// Returns a number of `[0, 1)`.
    pub fn share(&mut self) -> f64 {
        f64::from(self.pair()[0]) / 4_294_967_296.0
    }

    /// Returns a number of 0 to `bits` bits, each length as often as the others, of either sign.
    pub fn of_bits(&mut self, bits: u32) -> i64 {
        let [high, low] = self.pair();
        let [length, sign] = self.pair();
        let wide = u64::from(high) << 32 | u64::from(low);
        let length = below(length, bits + 1);
        let value = wide.checked_shr(64 - length).unwrap_or(0) as i64;
        if sign & 1 == 0 { value } else { -value }
    }

    /// Returns a word: any, a short one of either sign, or one of the edges.
    pub fn word(&mut self) -> u32 {
        let [word, choice] = self.pair();
        match choice % 4 {
            0 => EDGES[choice as usize / 4 % EDGES.len()],
            1 => word >> (choice / 4 % 32),
            2 => (word >> (choice / 4 % 32)).wrapping_neg(),
            _ => word,
        }
    }

    /// Returns an offset within the limit.
    pub fn offset(&mut self) -> I64Vec2 {
        let mut component = || self.between(-OFFSET_LIMIT, OFFSET_LIMIT);
        I64Vec2::new(component(), component())
    }
}

/// Returns the words of a 64-bit number, the low one first.
pub const fn halves(value: i64) -> [u32; 2] {
    [value as u32, (value >> 32) as u32]
}

/// Returns the 64-bit number of two words, the low one first.
pub const fn joined(low: u32, high: u32) -> i64 {
    (high as i64) << 32 | low as i64
}

/// Returns an offset of two words.
pub fn offset(x: u32, y: u32) -> I64Vec2 {
    IVec2::new(x as i32, y as i32).as_i64vec2()
}

/// Returns the words of two offsets.
pub const fn offsets(a: I64Vec2, b: I64Vec2) -> Words {
    [a.x as u32, a.y as u32, b.x as u32, b.y as u32]
}

/// Returns every choice of four edges, then `count` times four words of [`Numbers::word`].
pub fn words(seed: u64, count: usize) -> Vec<Words> {
    let mut all = Vec::with_capacity(count + EDGES.len().pow(4));
    for a in EDGES {
        for b in EDGES {
            for c in EDGES {
                all.extend(EDGES.map(|d| [a, b, c, d]));
            }
        }
    }
    let mut numbers = Numbers::new(seed);
    all.extend((0..count).map(|_| std::array::from_fn(|_| numbers.word())));
    all
}

/// Returns numerators and denominators: quotients near all thresholds with remainders near halves
/// and wholes, quotients of any size, and denominators of 0.
pub fn quotients(seed: u64, count: usize) -> Vec<Words> {
    let mut numbers = Numbers::new(seed);
    let mut one = || {
        let mut d = numbers.of_bits(38);
        let limit = [131_136, OFFSET_LIMIT][numbers.pair()[0] as usize % 2];
        let n = match numbers.pair()[0] % 4 {
            0 => numbers.of_bits(57),
            1 => {
                d = numbers.of_bits(57);
                numbers.of_bits(57)
            }
            choice => {
                let whole = match choice {
                    2 => numbers.between(-limit - 8, limit + 8),
                    _ => limit * [1, -1][numbers.pair()[0] as usize % 2] + numbers.between(-4, 4),
                };
                let rests = [0, 1, d / 2 - 1, d / 2, d / 2 + 1, d - 1, d];
                let rest = rests[numbers.pair()[0] as usize % rests.len()];
                whole * d + rest * [1, -1][numbers.pair()[0] as usize % 2]
            }
        };
        let ([a, b], [c, d]) = (halves(n), halves(d));
        [a, b, c, d]
    };
    (0..count).map(|_| one()).collect()
}

/// Returns triangles: any, nearly and exactly collinear, right-angled ones with centres at halves,
/// those with circumradii at the thresholds, those at the limits of offsets.
pub fn triangles(seed: u64, count: usize) -> Vec<Words> {
    let mut numbers = Numbers::new(seed);
    let mut all: Vec<Words> = extreme_triangles();
    let shapes = [any, nearly_collinear, right_angled, of_a_circle, small];
    all.extend((0..count).map(|index| {
        let (a, b) = shapes[index % shapes.len()](&mut numbers);
        let [low, high] = [-OFFSET_LIMIT, OFFSET_LIMIT].map(I64Vec2::splat);
        let inside = |offset: I64Vec2| offset.clamp(low, high);
        offsets(inside(a), inside(b))
    }));
    all
}

fn extreme_triangles() -> Vec<Words> {
    let far = OFFSET_LIMIT;
    let ends = [-far, 1 - far, -1, 0, 1, far - 1, far];
    let places = ends.map(|x| ends.map(|y| I64Vec2::new(x, y))).concat();
    let pairs = |a: &I64Vec2| places.iter().map(|b| offsets(*a, *b)).collect::<Vec<_>>();
    places.iter().flat_map(pairs).collect()
}

fn any(numbers: &mut Numbers) -> (I64Vec2, I64Vec2) {
    (numbers.offset(), numbers.offset())
}

fn small(numbers: &mut Numbers) -> (I64Vec2, I64Vec2) {
    let mut near = || I64Vec2::new(numbers.between(-40, 40), numbers.between(-40, 40));
    (near(), near())
}

fn nearly_collinear(numbers: &mut Numbers) -> (I64Vec2, I64Vec2) {
    let a = I64Vec2::new(numbers.of_bits(18), numbers.of_bits(18));
    let (times, parts) = (numbers.between(-9, 9), numbers.between(1, 9));
    (a, a.map(|v| v * times / parts + numbers.between(-1, 1)))
}

/// The centre is the middle of the longest side, a half wherever the sum is odd.
fn right_angled(numbers: &mut Numbers) -> (I64Vec2, I64Vec2) {
    let a = I64Vec2::new(numbers.of_bits(9), numbers.of_bits(9));
    let (p, q) = (numbers.between(-500, 500), numbers.between(-500, 500));
    (p * a, q * a.perp())
}

/// The centre is close to one that is a threshold's length away.
fn of_a_circle(numbers: &mut Numbers) -> (I64Vec2, I64Vec2) {
    let choice = numbers.pair()[0] as usize;
    let radius = [1.0, 229_376.0, 131_072.0, 131_136.0, 262_144.0, 262_146.0][choice % 6];
    let radius = radius + 8.0 * (numbers.share() - 0.5);
    // Half of the centres lie on an axis, so that one coordinate is at the threshold.
    let turn = if choice % 4 < 2 {
        numbers.share()
    } else {
        (choice / 8 % 4) as f64 / 4.0
    };
    let centre = DVec2::from_angle(turn * TAU) * radius;
    let mut place = || {
        let other = (turn + 0.5 + 0.3 * (numbers.share() - 0.5)) * TAU;
        (centre + DVec2::from_angle(other) * radius)
            .round()
            .as_i64vec2()
    };
    (place(), place())
}

/// Returns lines and samples: any, those with results at halves, those at the limits.
pub fn lines(seed: u64, count: usize) -> Vec<Words> {
    let mut numbers = Numbers::new(seed);
    let mut one = |index: usize| {
        let (line, m) = match index % 4 {
            0 => (numbers.of_bits(18), numbers.offset()),
            1 => {
                let line = numbers.of_bits(18);
                (line, I64Vec2::new(numbers.of_bits(18), numbers.of_bits(4)))
            }
            2 => (numbers.between(-40, 40), small(&mut numbers).0),
            _ => {
                let mut end = || [-1, 0, 1][numbers.pair()[0] as usize % 3] * OFFSET_LIMIT;
                let (line, x, y) = (end(), end(), end());
                let mut near =
                    |v: i64| (v + numbers.between(-2, 2)).clamp(-OFFSET_LIMIT, OFFSET_LIMIT);
                (near(line), I64Vec2::new(near(x), near(y)))
            }
        };
        offsets(I64Vec2::new(line, 0), m)
    };
    (0..count).map(&mut one).collect()
}

/// Returns all offsets next to the circle of the radius, on both sides of it and in all quarters:
/// those at R^2 and R^2 + 1 are among them.
pub fn rim() -> Vec<Words> {
    let mut all = Vec::new();
    for x in 0..=i64::from(R) + 1 {
        let y = (R_SQUARED - x * x).max(0).isqrt();
        for y in [y - 1, y, y + 1, y + 2] {
            for (x, y) in [(x, y), (-x, y), (x, -y), (-x, -y)] {
                all.push(offsets(I64Vec2::new(x, y), I64Vec2::ZERO));
            }
        }
    }
    all
}
