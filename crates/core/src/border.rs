//! The closed border of a bounded domain as a list of straight lines, and the places on it that may be candidates.

use glam::I64Vec2;

use crate::circumcentre::on_line;
use crate::lattice::{Domain, Rect};

/// A line of a border: all places with one coordinate on an axis, with the domain on one side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BorderLine {
    /// The axis that the line crosses: 0 if it is vertical, 1 if it is horizontal.
    pub axis: usize,
    /// The coordinate on that axis, in units.
    pub at: i64,
    /// 1 if the domain lies at larger coordinates on that axis, -1 if at smaller ones.
    pub inward: i64,
}

impl BorderLine {
    /// Returns whether the line runs through a rectangle.
    #[inline]
    fn meets(&self, rect: &Rect) -> bool {
        let (first, end) = if self.axis == 0 {
            (rect.min.x, rect.max.x)
        } else {
            (rect.min.y, rect.max.y)
        };
        (first.into()..end.into()).contains(&self.at)
    }

    /// Returns the place of the line that is as far from `a` as from `b`, rounded half up, or `None` if the two lie
    /// straight across the line from each other.
    fn as_far_from(&self, a: I64Vec2, b: I64Vec2) -> Option<I64Vec2> {
        let (across, along) = (self.axis, 1 - self.axis);
        let m = b - a;
        let from_a = on_line(self.at - a[across], I64Vec2::new(m[across], m[along]))?;

        let mut place = I64Vec2::splat(self.at);
        place[along] = a[along] + from_a;
        Some(place)
    }
}

/// Lines of the border of a domain, in coordinates that may begin anywhere.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Border {
    lines: [Option<BorderLine>; 4],
}

impl Border {
    /// Returns the border of a domain in coordinates that begin at `origin`: its left, right, lower and upper line, or
    /// none if the domain is periodic.
    pub fn of(domain: &Domain, origin: I64Vec2) -> Self {
        if domain.is_periodic() {
            return Self::default();
        }

        let line = |axis, at: i32, inward| BorderLine {
            axis,
            at: i64::from(at) - origin[axis],
            inward,
        };

        let (width, height) = (domain.width(), domain.height());
        let lines = [
            line(0, 0, 1),
            line(0, width, -1),
            line(1, 0, 1),
            line(1, height, -1),
        ];

        Self {
            lines: lines.map(Some),
        }
    }

    /// Returns the border in coordinates that begin at `origin`.
    pub fn seen_from(&self, origin: I64Vec2) -> Self {
        let moved = |line: BorderLine| BorderLine {
            at: line.at - origin[line.axis],
            ..line
        };
        Self {
            lines: self.lines.map(|line| line.map(moved)),
        }
    }

    /// Returns the lines that run through a rectangle. Places of the border in the rectangle lie on these lines, and
    /// corners in it are where two of them cross.
    pub fn through(&self, rect: &Rect) -> Self {
        Self {
            lines: self.lines.map(|line| line.filter(|line| line.meets(rect))),
        }
    }

    /// Returns whether a line runs through a rectangle.
    #[inline]
    pub fn meets(&self, rect: &Rect) -> bool {
        self.lines.iter().flatten().any(|line| line.meets(rect))
    }

    /// Returns the lines that the list holds: left, right, lower, upper.
    pub fn lines(&self) -> impl Iterator<Item = BorderLine> + use<> {
        self.lines.into_iter().flatten()
    }

    /// Returns the places of the border that may be candidates of detection for the sample at `own`: first those that
    /// are as far from it as from one of `others`, each with that other, then the corners, with `None`. `position`
    /// gives the place of one of `others`, in the coordinates of the border. Some places lie far outside the domain:
    /// callers leave these out.
    pub fn places<'a, T>(
        &self,
        own: I64Vec2,
        others: &'a [T],
        position: impl Fn(&T) -> I64Vec2,
    ) -> impl Iterator<Item = (I64Vec2, Option<&'a T>)> {
        let border = *self;

        // Along a line the distance to the nearest sample is largest where two samples are equally near, or at the
        // line's ends.
        let between = others.iter().flat_map(move |other| {
            let b = position(other);
            let places = border
                .lines()
                .filter_map(move |line| line.as_far_from(own, b));
            places.map(move |place| (place, Some(other)))
        });
        between.chain(self.corners().map(|corner| (corner, None)))
    }

    /// Returns the places where two lines cross, row by row.
    fn corners(&self) -> impl Iterator<Item = I64Vec2> + use<> {
        let border = *self;
        let across = move |axis| border.lines().filter(move |line| line.axis == axis);
        across(1).flat_map(move |row| across(0).map(move |column| I64Vec2::new(column.at, row.at)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::{Boundary, Point, R};

    #[test]
    fn a_border_has_lines_corners_and_places_between_samples() {
        let domain = Domain::from_units(20 * R, 10 * R, Boundary::Bounded);
        let origin = I64Vec2::new(3, 5);
        let border = Border::of(&domain, I64Vec2::ZERO).seen_from(origin);
        assert_eq!(border, Border::of(&domain, origin));
        let (right, top) = (i64::from(20 * R) - 3, i64::from(10 * R) - 5);

        let corners: Vec<[i64; 2]> = border.corners().map(|c| c.to_array()).collect();
        assert_eq!(corners, [[-3, -5], [right, -5], [-3, top], [right, top]]);

        // A line has one place as far from both samples, unless they lie straight across it.
        let (a, others) = (I64Vec2::new(10, 20), [I64Vec2::new(10, 40)]);
        let places: Vec<_> = border.places(a, &others, |b| *b).collect();
        assert_eq!(places[0], (I64Vec2::new(-3, 30), Some(&others[0])));
        assert_eq!(places[1], (I64Vec2::new(right, 30), Some(&others[0])));
        assert_eq!(places.len(), 2 + 4);
    }

    #[test]
    fn a_line_meets_the_rectangles_that_hold_places_of_it() {
        let domain = |boundary| Domain::from_units(20 * R, 20 * R, boundary);
        let rect = |x| Rect {
            min: Point::new(x, R),
            max: Point::new(x + 8, R + 8),
        };
        let border = Border::of(&domain(Boundary::Bounded), I64Vec2::ZERO);
        assert!(border.meets(&rect(0)) && border.meets(&rect(20 * R)));
        assert!(!border.meets(&rect(1)) && !border.meets(&rect(20 * R - 8)));
        assert_eq!(border.through(&rect(0)).lines().count(), 1);
        let periodic = Border::of(&domain(Boundary::Periodic), I64Vec2::ZERO);
        assert!(!periodic.meets(&rect(0)));
    }
}
