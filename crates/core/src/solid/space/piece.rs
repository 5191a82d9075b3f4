//! A piece of a window, made alone in a frame around it.

use crate::error::SampleError;
use crate::lattice::R;
use crate::random::{Key, Stream};
use crate::stages::darts::{throw_key, throws};

use super::super::Place;
use super::super::balls::BallGrid;
use super::super::darts::poisson;
use super::super::domain::SolidDomain;
use super::SolidWindow;
use super::doubt::Doubt;

/// The first width of the halo of small windows, in cells. Of 40 windows of 5 r, 36 were in doubt with 5 cells, 18 with 6, 2 with 7,
/// and none with 8 (`windows_seldom_need_a_second_halo`).
pub(super) const HALO: i32 = 8;

/// That of larger windows, along whose sides a doubt reaches inwards more often somewhere.
const WIDE_HALO: i32 = 10;

/// The longest side of a small window, in cells. Chosen, not measured.
const SMALL: i32 = 16;

/// The widest halo in cells.
const MAX_HALO: i32 = 64;

/// A sample in the order of arrival in the whole space: by level, throw and rank, and of equal ranks by place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Arrived {
    level: u32,
    throw: u32,
    rank: u32,
    /// z, y and x.
    turned: Place,
}

impl Arrived {
    /// Returns its level.
    pub const fn level(&self) -> u32 {
        self.level
    }

    /// Returns where it lies: x, y and z.
    pub const fn place(&self) -> Place {
        let [z, y, x] = self.turned;
        [x, y, z]
    }
}

/// The process in a frame. Places are counted from the lowest one of the frame, but for those of the window and of samples.
pub(super) struct SpacePiece<'a> {
    key: Key,
    window: &'a SolidWindow,
    /// The lowest place of the frame in space, a multiple of R on each axis.
    low: Place,
    /// The lowest places of active cubes.
    active: Vec<Place>,
    balls: BallGrid,
    doubt: Doubt,
    arrived: Vec<Arrived>,
    /// Whether a place of the window is in doubt.
    is_doubtful: bool,
}

impl<'a> SpacePiece<'a> {
    /// Returns the samples of a window in the order of their arrival. The window must hold at least one place.
    ///
    /// Fails when the window is still in doubt with a halo of [`MAX_HALO`] cells.
    pub fn made(key: Key, window: &'a SolidWindow) -> Result<Vec<Arrived>, SampleError> {
        let is_small = (0..3).all(|axis| window.max[axis] - window.min[axis] <= SMALL * R);
        let mut halo = if is_small { HALO } else { WIDE_HALO };
        loop {
            let piece = Self::run(key, window, halo);
            if !piece.is_doubtful {
                return Ok(piece.arrived);
            }
            if halo >= MAX_HALO {
                // Cells are as wide as the radius.
                let radii = f64::from(halo);
                return Err(SampleError::Remote { radii });
            }
            halo = (halo * 3 / 2).min(MAX_HALO);
        }
    }

    /// Runs the process in a frame with a halo of that many cells, until it ends or the window is in doubt.
    pub fn run(key: Key, window: &'a SolidWindow, halo: i32) -> Self {
        let first = window.min.map(|at| at.div_euclid(R) - halo);
        let last = window.max.map(|at| (at - 1).div_euclid(R) + halo);
        let cells = [0, 1, 2].map(|axis| last[axis] - first[axis] + 1);

        let mut active = Vec::new();
        for z in 0..cells[2] {
            for y in 0..cells[1] {
                active.extend((0..cells[0]).map(|x| [x * R, y * R, z * R]));
            }
        }
        let mut piece = Self {
            key,
            window,
            low: first.map(|cell| cell * R),
            active,
            balls: BallGrid::new(&SolidDomain::of_last(cells.map(|count| count * R - 1))),
            doubt: Doubt::new(cells),
            arrived: Vec::new(),
            is_doubtful: false,
        };

        let mut level = 0;
        while !piece.active.is_empty() && !piece.is_doubtful {
            for throw in 0..throws(level) {
                piece.throw(level, throw);
            }
            piece.cut(level);
            level += 1;
        }
        piece
    }

    /// Returns whether a place of the window is in doubt.
    #[cfg(test)]
    pub const fn is_doubtful(&self) -> bool {
        self.is_doubtful
    }

    /// Returns the samples of the window that are decided.
    #[cfg(test)]
    pub fn arrived(&self) -> &[Arrived] {
        &self.arrived
    }

    /// Returns a place of the frame as one of the space.
    fn in_space(&self, place: Place) -> Place {
        [0, 1, 2].map(|axis| self.low[axis] + place[axis])
    }

    /// Makes one throw.
    fn throw(&mut self, level: u32, throw: u32) {
        let throw_key = throw_key(self.key, level, throw);
        let mut darts: Vec<Arrived> = Vec::new();
        // No cube lies at `i32::MIN`, so that the first cube derives its plane's key.
        let (mut plane, mut plane_key) = (i32::MIN, throw_key);
        for &cube in &self.active {
            let [x, y, z] = self.in_space(cube);
            // Cubes of one plane follow each other more often than not, and share the first half of their keys.
            if z != plane {
                (plane, plane_key) = (z, throw_key.derive(Stream::Depth, z as u32));
            }
            let cube_key = plane_key.derive_at(x, y);
            let [word, _] = cube_key.words();
            // As in a box: a cube of one place gets exactly one dart.
            let count = if R >> level == 1 { 1 } else { poisson(word) };

            for index in 0..count {
                let [a, b] = cube_key.draw(Stream::Dart, index);
                // 15 bits for each coordinate, of which a smaller cube takes the highest.
                let offset = [a >> 17, a >> 2 & 0x7fff, b >> 17].map(|bits| (bits >> level) as i32);
                let dart = [0, 1, 2].map(|axis| cube[axis] + offset[axis]);
                if !self.balls.covers(dart) {
                    let [rank, _] = cube_key.draw(Stream::Rank, index);
                    let [x, y, z] = self.in_space(dart);
                    darts.push(Arrived {
                        level,
                        throw,
                        rank,
                        turned: [z, y, x],
                    });
                }
            }
        }
        darts.sort_unstable();

        for dart in darts {
            let place = dart.place();
            let local = [0, 1, 2].map(|axis| place[axis] - self.low[axis]);
            if self.balls.covers(local) {
                continue;
            }
            if self.doubt.reaches(local) {
                // One place is a cube of side 1.
                self.put_in_doubt(local, 1);
                continue;
            }
            self.balls.insert(local);
            if self.window.contains(place) {
                self.arrived.push(dart);
            }
        }
    }

    /// Cuts the active cubes into octants. Those that a sample covers are done, and those whose darts would all be in doubt are
    /// given up.
    fn cut(&mut self, level: u32) {
        let (before, side) = (std::mem::take(&mut self.active), R >> level);
        // A cube of one place has thrown that place.
        if side == 1 {
            return;
        }
        let mut open = Vec::new();
        for cube in before {
            open.clear();
            self.balls.open_octants(cube, side, &mut open);
            for &octant in &open {
                if self.doubt.gives_up(octant, side / 2) {
                    self.put_in_doubt(octant, side / 2);
                } else {
                    self.active.push(octant);
                }
            }
        }
    }

    /// Puts a cube in doubt.
    fn put_in_doubt(&mut self, min: Place, side: i32) {
        self.doubt.add(min, side);
        let place = self.in_space(min);
        self.is_doubtful |= (0..3).all(|axis| {
            place[axis] < self.window.max[axis] && place[axis] + side > self.window.min[axis]
        });
    }
}
