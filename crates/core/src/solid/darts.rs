//! How darts are drawn: each from the key of its cube, so that no draw depends on the order in which cubes are visited.

use crate::lattice::R;
use crate::random::{Key, Stream};
use crate::record::Verdict;
use crate::stages::darts::{throw_key, throws, verdict};

use super::Place;
use super::balls::BallGrid;

/// Cumulative probabilities, times 2^32, of 0, 1, 2, ... darts for a mean of 1.4 a cube. Means from 0.7 to 2 cost the same
/// time within 7%; 1.4 was the fastest, and takes a sixth less memory than the plane's 0.85.
const SOLID_POISSON: [u32; 13] = [
    0x3f20_fa87,
    0x9782_5945,
    0xd560_1b97,
    0xf23f_0fdf,
    0xfc59_e55e,
    0xff2e_35a1,
    0xffd7_374a,
    0xfff9_046c,
    0xfffe_eeb8,
    0xffff_da47,
    0xffff_fb41,
    0xffff_ff74,
    0xffff_fff1,
];

/// How many keys of planes are kept. Cubes come cell by cell, and a cell of side R has 2^level planes of cubes: up to
/// level 5, at which nearly all cubes are gone, the keys of all of them are kept.
const KEPT_PLANES: usize = 32;

/// A dart that no sample covered when it was thrown.
#[derive(Clone, Copy)]
pub(super) struct SolidDart {
    rank: u32,
    pub place: Place,
}

impl SolidDart {
    /// Returns the order of arrival within a throw. Equal ranks are decided by place, so that the sequence of the cubes does
    /// not matter.
    pub const fn arrival(&self) -> (u32, [i32; 3]) {
        let [x, y, z] = self.place;
        (self.rank, [z, y, x])
    }
}

/// One throw of a level: each cube of the level gets darts of it.
#[derive(Clone, Copy)]
pub(super) struct SolidThrow {
    key: Key,
    level: u32,
    number: u32,
}

impl SolidThrow {
    pub fn new(key: Key, level: u32, number: u32) -> Self {
        Self {
            key: throw_key(key, level, number),
            level,
            number,
        }
    }

    /// Returns its level: how many times the cubes were halved.
    pub const fn level(&self) -> u32 {
        self.level
    }

    /// Returns the side of the level's cubes.
    pub const fn side(&self) -> i32 {
        R >> self.level
    }

    /// Returns the throw that follows, which may be the first one of the next level. `key` is that of all throws.
    pub fn next(&self, key: Key) -> Self {
        if self.is_last() {
            Self::new(key, self.level + 1, 0)
        } else {
            Self::new(key, self.level, self.number + 1)
        }
    }

    /// Returns whether it is the first one of its level, and cubes of a level before have to be cut.
    pub const fn begins_level(&self) -> bool {
        self.level > 0 && self.number == 0
    }

    /// Returns whether it is the last one of its level.
    pub const fn is_last(&self) -> bool {
        self.number + 1 == throws(self.level)
    }

    /// Appends to `out` the darts into some cubes that land in the domain and that no sample covers.
    pub fn uncovered(&self, cubes: &[Place], balls: &BallGrid, out: &mut Vec<SolidDart>) {
        self.thrown(cubes, balls, out, |_, _| {});
    }

    /// Like [`Self::uncovered`], and passes each dart to `report` with the place where it lands and its verdict. A
    /// verdict names no sample that covers the dart, since the process keeps no ids.
    #[inline]
    pub fn thrown(
        &self,
        cubes: &[Place],
        balls: &BallGrid,
        out: &mut Vec<SolidDart>,
        mut report: impl FnMut(Place, Verdict),
    ) {
        let last = balls.frame().last();
        let mut planes = PlaneKeys::new(*self);
        for &[x, y, z] in cubes {
            // Cubes are given by their lowest places.
            let cube_key = planes.of(z).derive_at(x, y);
            // The words of a key were drawn themselves: the first one is the draw of the number of darts.
            let [word, _] = cube_key.words();
            for index in 0..self.dart_count(word) {
                let [right, up, deep] = self.offset(cube_key.draw(Stream::Dart, index));
                let place = [x + right, y + up, z + deep];
                // A cube at an upper side may reach beyond it.
                let is_inside = (0..3).all(|axis| place[axis] <= last[axis]);
                if !is_inside {
                    report(place, Verdict::Outside);
                    continue;
                }

                let is_covered = balls.covers(place);
                report(place, verdict(is_covered));
                if !is_covered {
                    // The rank is drawn only now, since nine of ten darts are covered and need none.
                    let [rank, _] = cube_key.draw(Stream::Rank, index);
                    out.push(SolidDart { rank, place });
                }
            }
        }
    }

    /// Returns how many darts a cube gets, of which a uniform word was drawn.
    #[inline]
    pub fn dart_count(&self, word: u32) -> u32 {
        // A cube of side 1 has one place, which gets exactly one dart: after it no cube is left, so that the process ends.
        if self.side() == 1 { 1 } else { poisson(word) }
    }

    /// Returns where in its cube a dart lands: 15 bits for each coordinate, of which a smaller cube takes the highest.
    #[inline]
    pub fn offset(&self, [a, b]: [u32; 2]) -> Place {
        // Written out, as elsewhere: `map` is a call.
        let [x, y, z] = [a >> 17, a >> 2 & 0x7fff, b >> 17];
        [
            (x >> self.level) as i32,
            (y >> self.level) as i32,
            (z >> self.level) as i32,
        ]
    }
}

/// The keys of the planes in which cubes lie: half of the draws for a cube's key are those of its plane.
pub(super) struct PlaneKeys {
    throw: Key,
    /// The binary logarithm of the side of the throw's cubes.
    side_bits: u32,
    /// The planes whose keys were drawn last, each by where it begins, with its key.
    kept: [Option<(i32, Key)>; KEPT_PLANES],
}

impl PlaneKeys {
    pub const fn new(throw: SolidThrow) -> Self {
        Self {
            throw: throw.key,
            side_bits: throw.side().ilog2(),
            kept: [None; KEPT_PLANES],
        }
    }

    /// Returns the key of the plane of cubes that begins at `z`.
    #[inline]
    pub fn of(&mut self, z: i32) -> Key {
        // The sides of cubes are powers of two: a shift divides by them, and gives the number of the plane.
        let number = (z >> self.side_bits) as usize;
        let kept = &mut self.kept[number % KEPT_PLANES];
        match *kept {
            Some((at, key)) if at == z => key,
            _ => {
                let key = self.throw.derive(Stream::Depth, z as u32);
                *kept = Some((z, key));
                key
            }
        }
    }
}

/// Returns the Poisson count of mean 1.4 for a uniform word.
#[inline]
pub(super) fn poisson(word: u32) -> u32 {
    let below = SOLID_POISSON.iter().take_while(|&&bound| word >= bound);
    below.count() as u32
}
