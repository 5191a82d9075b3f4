//! The darts of active cubes, drawn for eight cubes or eight darts at a time: those of [`SolidThrow::thrown`].

use fearless_simd::Simd;
use glam::IVec3;

use super::parcel::ActiveCube;
use crate::random::{DRAW_LANES, Key, Stream, draw_by_eight};
use crate::solid::Place;
use crate::solid::darts::{PlaneKeys, SolidThrow};

/// The keys of lanes whose draws are not used.
const NO_KEYS: [Key; DRAW_LANES] = [Key::from_seed(0); DRAW_LANES];

/// A dart of a cube, before anything is asked of its place.
#[derive(Clone, Copy)]
pub(super) struct CubeDart {
    /// The place of its cube among those for which darts were drawn.
    pub cube: u8,
    /// Its number in its cube.
    pub index: u32,
    pub key: Key,
    /// From the lowest place of its cube to its own.
    pub offset: Place,
}

/// A buffer for the darts of some cubes.
#[derive(Default)]
pub(super) struct DrawnCubeDarts {
    pub darts: Vec<CubeDart>,
}

impl DrawnCubeDarts {
    /// For how many cubes darts are drawn at a time. [`CubeDart::cube`] numbers them with 8 bits.
    pub const CUBES: usize = 8 * DRAW_LANES;

    /// Draws the darts of at most [`Self::CUBES`] cubes. `lowest` returns the lowest place of one.
    #[inline(always)]
    pub fn draw<S: Simd>(
        &mut self,
        simd: S,
        throw: SolidThrow,
        planes: &mut PlaneKeys,
        cubes: &[ActiveCube],
        lowest: impl Fn(&ActiveCube) -> IVec3,
    ) {
        self.darts.clear();
        for (held, first) in cubes.chunks(DRAW_LANES).zip((0..).step_by(DRAW_LANES)) {
            // Lanes without a cube draw in vain.
            let (mut keys, mut counters) = (NO_KEYS, [[0; 2]; DRAW_LANES]);
            for ((key, counter), cube) in keys.iter_mut().zip(&mut counters).zip(held) {
                let place = lowest(cube);
                *key = planes.of(place.z);
                *counter = [place.x as u32, place.y as u32];
            }
            let drawn = draw_by_eight(simd, keys, counters);

            // The words of a cube are its key. The first word also decides how many darts the cube gets.
            for (words, cube) in drawn.into_iter().take(held.len()).zip(first..) {
                for index in 0..throw.dart_count(words[0]) {
                    self.darts.push(CubeDart {
                        cube,
                        index,
                        key: Key::from_words(words),
                        offset: [0; 3],
                    });
                }
            }
        }

        // All darts are listed by now. Their places are drawn last, so that eight darts of any cubes share a draw.
        for held in self.darts.chunks_mut(DRAW_LANES) {
            let (mut keys, mut counters) = (NO_KEYS, [[0; 2]; DRAW_LANES]);
            for ((key, counter), dart) in keys.iter_mut().zip(&mut counters).zip(&*held) {
                *key = dart.key;
                *counter = [Stream::Dart as u32, dart.index];
            }
            let drawn = draw_by_eight(simd, keys, counters);
            for (dart, words) in held.iter_mut().zip(drawn) {
                dart.offset = throw.offset(words);
            }
        }
    }
}
