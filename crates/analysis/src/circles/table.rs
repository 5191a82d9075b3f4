//! Which directions around a sample the disk of another one covers, looked up by their offset.
//! The circle is cut into 128 bins, offsets into squares of a 64th of the radius; a mask has the bins that the disk covers
//! wholly *for every offset of its square*, so a union of masks that is full proves the circle covered.
//! It never proves a circle uncovered.

use std::f64::consts::TAU;
use std::sync::OnceLock;

/// Bins of the circle, one a bit.
const BINS: usize = 128;
/// Squares along the two radii to either side of a sample.
const HALF: usize = 128;
const SQUARES: usize = 2 * HALF;
/// Squares in a radius.
pub(super) const PER_RADIUS: f64 = HALF as f64 / 2.0;
/// Arcs are shortened by this angle at both ends: far more than all rounding, far less than a bin.
const MARGIN: f64 = 1.0 / 65536.0;

/// Bins of the circle of a sample that are covered.
pub(super) type Mask = u128;

/// The mask of a circle that is covered wholly.
pub(super) const FULL: Mask = Mask::MAX;

/// The same bins seen from the other one of two samples: opposite directions.
pub(super) const fn opposite(mask: Mask) -> Mask {
    mask.rotate_left(BINS as u32 / 2)
}

pub(super) struct Table(Box<[Mask]>);

impl Table {
    pub fn get() -> &'static Self {
        static TABLE: OnceLock<Table> = OnceLock::new();
        TABLE.get_or_init(Self::new)
    }

    fn new() -> Self {
        // Only the corners of one quarter are computed; the others are its rotations by 32 bins.
        let side = HALF + 1;
        let arcs: Vec<Option<Arc>> = (0..side * side)
            .map(|index| Arc::at([index % side, index / side]))
            .collect();
        let mut masks = vec![0; SQUARES * SQUARES];
        for y in 0..HALF {
            for x in 0..HALF {
                let corners = [(x, y), (x + 1, y), (x, y + 1), (x + 1, y + 1)];
                let arcs = corners.map(|(x, y)| arcs[y * side + x]);
                let mask = common(arcs);
                let (x, y) = (x as i64, y as i64);
                // A quarter turn takes the square at (x, y) to the one at (-y - 1, x).
                for (turn, [x, y]) in [[x, y], [-y - 1, x], [-x - 1, -y - 1], [y, -x - 1]]
                    .into_iter()
                    .enumerate()
                {
                    let [x, y] = [x, y].map(|value| (value + HALF as i64) as usize);
                    masks[y * SQUARES + x] = mask.rotate_left((turn * BINS / 4) as u32);
                }
            }
        }
        Self(masks.into_boxed_slice())
    }

    /// The mask for an offset, given in squares; offsets beyond two radii give any mask.
    #[inline]
    pub fn mask(&self, x: f64, y: f64) -> Mask {
        // Through i32, which needs no branch; the remainder keeps the index in range.
        let [x, y] = [x, y].map(|value| (value + HALF as f64) as i32 as usize);
        self.0[(y * SQUARES + x) % (SQUARES * SQUARES)]
    }
}

/// Directions covered by the disk at an offset: from `start` to `end`, in turns counted anticlockwise.
#[derive(Clone, Copy)]
struct Arc {
    start: f64,
    end: f64,
}

impl Arc {
    /// The arc for a corner of squares of the first quarter; none where the disks do not overlap, or are the same.
    fn at([x, y]: [usize; 2]) -> Option<Self> {
        let [x, y] = [x, y].map(|value| value as f64 / PER_RADIUS);
        let half_distance = x.hypot(y) / 2.0;
        if half_distance == 0.0 || half_distance >= 1.0 {
            return None;
        }
        let (direction, half) = (y.atan2(x), half_distance.acos() - MARGIN);
        (half > 0.0).then(|| Self {
            start: (direction - half) / TAU,
            end: (direction + half) / TAU,
        })
    }
}

/// The bins within all four arcs.
///
/// A disk at the offset `d` covers the direction `u` when `d` is in the open unit disk about `u`. That disk is convex: it holds
/// a square when it holds its corners.
fn common(arcs: [Option<Arc>; 4]) -> Mask {
    let (mut start, mut end) = (f64::NEG_INFINITY, f64::INFINITY);
    for arc in arcs {
        let Some(arc) = arc else { return 0 };
        start = start.max(arc.start);
        end = end.min(arc.end);
    }
    // Starts are above -1/4 and ends below 1/2, so no arc meets itself.
    let (first, end) = (
        (start * BINS as f64).ceil() as i32,
        (end * BINS as f64).floor() as i32,
    );
    if end <= first {
        return 0;
    }
    (FULL >> (BINS as i32 - (end - first))).rotate_left(first.rem_euclid(BINS as i32) as u32)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the definition: each bin of a mask is covered, at both ends and in the middle, for offsets all over the square.
    #[test]
    fn masks_cover_what_they_claim_and_little_less() {
        let table = Table::get();
        let (mut claimed, mut covered) = (0, 0);
        for index in (0..SQUARES * SQUARES).step_by(37) {
            let corner = [index % SQUARES, index / SQUARES].map(|at| at as f64 - HALF as f64);
            let mask = table.mask(corner[0] + 0.5, corner[1] + 0.5);
            for bin in 0..BINS {
                let mut all = true;
                for step in 0..=2 {
                    let angle = (bin as f64 + f64::from(step) / 2.0) / BINS as f64 * TAU;
                    let (sin, cos) = angle.sin_cos();
                    for at in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.5, 0.5]] {
                        let x = (corner[0] + at[0]) / PER_RADIUS;
                        let y = (corner[1] + at[1]) / PER_RADIUS;
                        all &= x * cos + y * sin > (x * x + y * y) / 2.0;
                    }
                }
                let claims = mask >> bin & 1 == 1;
                assert!(all || !claims, "bin {bin} at {corner:?}");
                claimed += u32::from(claims);
                covered += u32::from(all);
            }
        }
        // Only bins that an arc leaves by less than the margin are given up.
        assert!(claimed > 0 && f64::from(claimed) > 0.99 * f64::from(covered), "{claimed} of {covered}");
    }

    #[test]
    fn an_opposite_offset_covers_opposite_directions() {
        let table = Table::get();
        let mask = table.mask(40.5, 20.5);
        assert_ne!(mask, 0);
        assert_eq!(table.mask(-40.5, -20.5), opposite(mask));
    }
}
