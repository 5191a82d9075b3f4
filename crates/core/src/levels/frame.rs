//! The rectangle of the plane in which a level is computed.

use glam::I64Vec2;

use crate::border::Border;
use crate::lattice::{Domain, Point, Rect};
use crate::radius::Radius;

/// A rectangle in which a level is computed. Its coordinates begin at the plane's place `origin`.
#[derive(Clone, Copy, Default)]
pub(super) struct LevelFrame {
    pub rect: Rect,
    pub origin: I64Vec2,
    /// Whether the plane goes on below and above the frame, by axis.
    pub goes_on: [[bool; 2]; 2],
    /// Whether the frame is a periodic domain.
    pub wraps: bool,
    /// Width and height of the domain.
    pub sides: [i32; 2],
    pub periodic: bool,
    /// The closed border of the domain.
    pub border: Border,
}

impl LevelFrame {
    /// Returns an empty frame at a place of a domain.
    pub fn at(domain: &Domain, origin: I64Vec2) -> Self {
        Self {
            origin,
            sides: [domain.width(), domain.height()],
            periodic: domain.is_periodic(),
            border: Border::of(domain, origin),
            ..Self::default()
        }
    }

    /// Returns the rectangle from which tiled samples are taken: the frame, and as much beyond the closed borders of the
    /// domain as samples there could reach into it.
    pub fn tiled(&self, reach: i32) -> Rect {
        self.moved(|goes_on| if goes_on { 0 } else { reach })
    }

    /// Returns the frame without a strip along the sides beyond which the plane goes on.
    pub fn inside(&self, strip: i32) -> Rect {
        self.moved(|goes_on| if goes_on { -strip } else { 0 })
    }

    /// Returns the frame with each side moved outwards.
    fn moved(&self, by: impl Fn(bool) -> i32) -> Rect {
        let [[left, right], [bottom, top]] = self.goes_on;
        let Rect { min, max } = self.rect;
        Rect {
            min: Point::new(min.x - by(left), min.y - by(bottom)),
            max: Point::new(
                max.x.saturating_add(by(right)),
                max.y.saturating_add(by(top)),
            ),
        }
    }

    /// Returns `p` in the frame, if the frame wraps.
    #[inline]
    pub fn wrap(&self, p: Point) -> Point {
        if self.wraps { self.in_domain(p) } else { p }
    }

    /// Returns the place of the domain that the frame shows at `p`.
    #[inline]
    pub fn in_domain(&self, p: Point) -> Point {
        let axis = |at: i32, axis: usize| {
            let at = i64::from(at) + self.origin[axis];
            if self.periodic {
                at.rem_euclid(self.sides[axis].into()) as i32
            } else {
                at as i32
            }
        };
        Point::new(axis(p.x, 0), axis(p.y, 1))
    }

    /// Returns whether the plane goes on beyond the frame.
    pub fn ends_inside(&self) -> bool {
        self.goes_on != [[false; 2]; 2]
    }

    /// Returns how far samples may be from a place and yet concern candidates around it, in units: 2r and two diagonals
    /// of a pixel; near closed borders places may be (2 + sqrt 2) r from all samples (see [`crate::stages::detect`]).
    pub const fn sight(&self, radius: Radius) -> i32 {
        if self.periodic {
            radius.units * 5 / 2
        } else {
            radius.units * 9 / 2
        }
    }
}
