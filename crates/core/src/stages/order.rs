//! The order of elimination. The greedy independent set depends only on the order, so any way to compute it gives the
//! same set.

use crate::lattice::{Domain, Point, R};
use crate::parameters::Order;
use crate::random::{Key, Stream, below};

/// Ranks tiled samples. Samples of equal rank follow each other block by block and row by row,
/// which is the sequence of their ids.
pub struct Ranking {
    order: Order,
    key: Key,
    phases: Phases,
}

impl Ranking {
    /// Returns the ranking of `order` in a domain under a run's key.
    #[must_use]
    pub fn new(order: Order, domain: &Domain, key: Key) -> Self {
        Self {
            order,
            key: key.derive(Stream::Order, 0),
            phases: Phases::new(domain, key),
        }
    }

    /// Returns the numbers from which ranks are made.
    #[must_use]
    pub const fn numbers(&self) -> RankNumbers {
        RankNumbers {
            key: self.key,
            cell: self.phases.cell,
            count: self.phases.count,
            sequence: self.phases.sequence,
        }
    }

    /// Returns the rank of a tiled sample: lower ranks claim their disks first.
    #[must_use]
    pub fn rank(&self, point: Point, own: bool) -> u32 {
        match self.order {
            Order::Index => 0,
            Order::Random => self.key.draw_at(point.x, point.y)[0],
            Order::OwnBlockFirst => u32::from(!own),
            Order::PhaseGroup => self.phases.group(point),
        }
    }
}

/// The constants of a ranking, for shaders that compute ranks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RankNumbers {
    /// The key of random ranks: the first word drawn for a point is its rank.
    pub key: Key,
    /// Sides of the phase groups' cells, in units.
    pub cell: [i32; 2],
    /// How many such cells there are on each axis; the last one takes the remainder of the side.
    pub count: [i32; 2],
    /// The turn of each group, by the lowest bits of the cell's row (2) and column (1).
    pub sequence: [u32; 4],
}

/// The phase groups: cells at least 2r wide, an even number on each axis, in a 2 x 2 scheme. Cells
/// of one group are at least 2r apart, so none of their samples conflict across cells.
struct Phases {
    // These are the numbers of the same names in `RankNumbers`.
    cell: [i32; 2],
    count: [i32; 2],
    sequence: [u32; 4],
}

impl Phases {
    /// Returns the cells of a domain, and the random sequence of their groups.
    fn new(domain: &Domain, key: Key) -> Self {
        // An even number, so that groups also alternate across a periodic border. Sides are at least 4r long, so that
        // each axis has two cells of 2r, and all four groups have cells. `max` keeps the divisions below from a 0 in
        // any case.
        let count = [domain.width(), domain.height()].map(|side| ((side / (2 * R)) & !1).max(2));

        // The groups have their turns in random sequence, as in Wei 2008 (a shuffle by Fisher and Yates).
        let mut sequence = [0, 1, 2, 3];
        for last in (1..4_u32).rev() {
            let other = below(key.draw(Stream::Phase, last)[0], last + 1);
            sequence.swap(last as usize, other as usize);
        }

        Self {
            cell: [domain.width() / count[0], domain.height() / count[1]],
            count,
            sequence,
        }
    }

    /// Returns the turn of the group to which the cell of a place belongs.
    fn group(&self, p: Point) -> u32 {
        // The last cell takes the remainder of the side.
        let phase = |x: i32, axis: usize| (x / self.cell[axis]).min(self.count[axis] - 1) & 1;
        self.sequence[(phase(p.y, 1) * 2 + phase(p.x, 0)) as usize]
    }
}

#[cfg(test)]
mod tests {
    use glam::{I64Vec2, IVec2};

    use super::*;
    use crate::lattice::Boundary;

    #[test]
    fn samples_of_one_phase_group_conflict_only_within_a_cell() {
        for (width, height) in [(10.0, 10.0), (13.7, 31.9), (58.2, 10.1)] {
            let domain = Domain::from_size([width, height], 1.0, Boundary::Periodic).unwrap();
            let phases = Phases::new(&domain, Key::from_seed(5));
            let mut sorted = phases.sequence;
            sorted.sort_unstable();
            assert_eq!(sorted, [0, 1, 2, 3]);
            let cell = |p: Point| {
                let index =
                    |x: i32, axis: usize| (x / phases.cell[axis]).min(phases.count[axis] - 1);
                (index(p.x, 0), index(p.y, 1))
            };
            for k in 0..20_000 {
                let [x, y] = Key::from_seed(9).draw(Stream::Dart, k);
                let p = Point::new(
                    below(x, domain.width() as u32) as i32,
                    below(y, domain.height() as u32) as i32,
                );
                for offset in [[R, 0], [0, R], [-R, 0], [23_170, -23_170]] {
                    let offset = IVec2::from(offset).as_i64vec2();
                    let q = domain.wrap(I64Vec2::from(p) + offset).unwrap();
                    assert!(cell(p) == cell(q) || phases.group(p) != phases.group(q));
                }
            }
        }
    }

    #[test]
    fn own_samples_come_first() {
        let domain = Domain::from_size([20.0; 2], 1.0, Boundary::Periodic).unwrap();
        let ranking = Ranking::new(Order::OwnBlockFirst, &domain, Key::from_seed(1));
        let p = Point::new(3, 4);
        assert!(ranking.rank(p, true) < ranking.rank(p, false));
    }
}
