//! The part of the plane that a tiling works on: a whole domain, or a window with a halo beyond which nothing is known.

use glam::{I64Vec2, IVec2};

use crate::engine::parallel::clip::PlacedBlock;
use crate::engine::parallel::frame::Frame;
use crate::lattice::{Domain, Point, R, Rect};

/// Late darts, which are those of [`LATE_LEVEL`](crate::exact::history::LATE_LEVEL) and after, are thrown only at
/// places this far from the unknown part. Nearer, where most samples are doubtful, all late darts count as unknown,
/// which spares following them. Of early samples farther than this fewer than one in a hundred was doubtful.
const LATE_MARGIN: i32 = 3 * R;

/// More than any place of a frame with a halo is away from the frame's ends.
const FAR: i32 = 1 << 29;

/// A frame, and how the plane goes on beyond it. Places are in the frame's coordinates.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ground {
    pub(crate) frame: Frame,
    /// The sides of a periodic domain that is worked on as a whole, so that opposite ends are joined.
    joined: Option<Point>,
    /// The known part of the plane, if not all of it is known: the frame, and everything on the sides where a domain ends.
    known: Option<Rect>,
    /// Where late darts are thrown, if not everywhere although all is known.
    thrown: Option<Rect>,
}

/// How far from the ends of a ground with nothing beyond it late darts are thrown. Nearer, many samples differ from the domain's in
/// any case: without these darts the deepest that differed were as deep as with them, up to 4 r
/// (`what_is_unknown_reaches_less_far_than_a_halo`).
const ALONE_MARGIN: i32 = 2 * R;

impl Ground {
    /// Returns the ground of a whole domain.
    pub(crate) fn whole(domain: &Domain) -> Self {
        let rect = domain.rect();
        let no_halo = 0;
        let frame = Frame {
            // `Frame::new` gives a periodic domain a frame that ends with its last cells, which may reach beyond the
            // domain, and behind which the plane goes on. Here the frame ends where the domain does, and `joined` says
            // the plane behind its ends.
            end: [rect.max.x, rect.max.y],
            goes_on: [[false; 2]; 2],
            ..Frame::new(domain, &rect, no_halo)
        };
        let joined = domain.is_periodic().then_some(rect.max);
        Self {
            frame,
            joined,
            known: None,
            thrown: None,
        }
    }

    /// Returns the ground of a window of a domain, with a halo of `halo` cells around it.
    pub(crate) fn around(domain: &Domain, window: &Rect, halo: i32) -> Self {
        let frame = Frame::new(domain, window, halo);
        let [[left, right], [bottom, top]] = frame.goes_on;
        let [width, height] = frame.end;
        // Where a domain ends there are no samples beyond: that part of the plane is known, however far.
        let reach = |goes_on: bool| if goes_on { 0 } else { FAR };

        let known = Rect {
            min: Point::new(-reach(left), -reach(bottom)),
            max: Point::new(width + reach(right), height + reach(top)),
        };

        // A periodic domain goes on at every side of the frame.
        let is_whole_domain = !frame.goes_on.as_flattened().contains(&true);

        Self {
            frame,
            joined: None,
            known: (!is_whole_domain).then_some(known),
            thrown: None,
        }
    }

    /// Returns the same ground with nothing beyond it. Near its ends samples then differ from those of the domain.
    pub(crate) fn alone(domain: &Domain, window: &Rect, halo: i32) -> Self {
        let around = Self::around(domain, window, halo);
        let thrown = around.known.map(|known| inner(&known, ALONE_MARGIN));
        Self {
            known: None,
            thrown,
            ..around
        }
    }

    /// Returns whether some place of the domain lies on the ground twice.
    pub(crate) fn repeats(&self) -> bool {
        let Frame { end, sides, .. } = &self.frame;
        self.frame.periodic && (end[0] > sides[0] || end[1] > sides[1])
    }

    /// Returns how far a block is moved from where the domain has it to where the ground has it.
    pub(crate) fn moved(&self, block: &PlacedBlock) -> IVec2 {
        let mut at = block.rect.min + self.frame.origin;

        if self.frame.periodic {
            let [width, height] = self.frame.sides.map(i64::from);
            // No block crosses the domain's ends.
            at = I64Vec2::new(at.x.rem_euclid(width), at.y.rem_euclid(height));
        }

        // Only the sum of a place and this fits into 32 bits.
        let moved = block.rect.min - at;
        IVec2::new(moved.x as i32, moved.y as i32)
    }

    /// Returns the places that it has.
    pub(crate) fn rect(&self) -> Rect {
        let [width, height] = self.frame.end;
        Rect {
            min: Point::new(0, 0),
            max: Point::new(width, height),
        }
    }

    /// Returns the places at which late darts are thrown: those where they are known.
    pub(crate) fn core(&self) -> Rect {
        let Rect { min, max } = self.rect();
        let Some(Rect {
            min: low,
            max: high,
        }) = self.late_known().or(self.thrown)
        else {
            return Rect { min, max };
        };
        Rect {
            min: Point::new(min.x.max(low.x), min.y.max(low.y)),
            max: Point::new(max.x.min(high.x), max.y.min(high.y)),
        }
    }

    /// Returns the part of the plane in which late darts are known, if it is not all.
    #[inline]
    pub(crate) fn late_known(&self) -> Option<Rect> {
        self.known.map(|known| inner(&known, LATE_MARGIN))
    }

    /// Returns whether something is unknown.
    pub(crate) const fn has_unknown(&self) -> bool {
        self.known.is_some()
    }

    /// Returns whether a dart at a place may be covered by something unknown that is earlier. Early darts are unknown beyond the
    /// ground alone.
    #[inline]
    pub(crate) fn is_near_unknown(&self, place: Point, is_late: bool) -> bool {
        let known = if is_late {
            self.late_known()
        } else {
            self.known
        };
        known.is_some_and(|known| known.depth(place) <= R)
    }

    /// Calls `visit` with the parts of a rectangle that lie on the ground, and how far samples found there must be moved to
    /// be beside the rectangle: opposite ends may be joined. Stops when `visit` returns `true`; returns whether it did.
    #[inline]
    pub(crate) fn any_part(
        &self,
        rect: &Rect,
        mut visit: impl FnMut(&Rect, IVec2) -> bool,
    ) -> bool {
        let all = self.rect();
        let Rect { min, max } = *rect;
        // Nearly always it lies inside.
        if min.x >= 0 && min.y >= 0 && max.x <= all.max.x && max.y <= all.max.y {
            return visit(rect, IVec2::ZERO);
        }
        self.any_cut_part(rect, &mut visit)
    }

    /// Does what [`Self::any_part`] does, for a rectangle that reaches beyond the ground.
    #[cold]
    fn any_cut_part(&self, rect: &Rect, visit: &mut dyn FnMut(&Rect, IVec2) -> bool) -> bool {
        let all = self.rect();
        // Where ends are joined, parts of the rectangle may also lie a side farther, either way. Where they are not,
        // only the first shift is used, which is 0.
        let shifts = |side: Option<i32>| side.map_or([0; 3], |side| [0, -side, side]);
        let count = if self.joined.is_some() { 3 } else { 1 };
        let (xs, ys) = (
            shifts(self.joined.map(|sides| sides.x)),
            shifts(self.joined.map(|sides| sides.y)),
        );

        let part = |min: i32, max: i32, shift: i32, end: i32| {
            // A domain may end where the 32-bit integers do, so that a place moved by a side needs more bits.
            let moved = |v: i32| (i64::from(v) - i64::from(shift)).clamp(0, end.into()) as i32;
            moved(min)..moved(max)
        };
        for &up in &ys[..count] {
            let rows = part(rect.min.y, rect.max.y, up, all.max.y);
            for &right in &xs[..count] {
                let columns = part(rect.min.x, rect.max.x, right, all.max.x);
                if rows.is_empty() || columns.is_empty() {
                    continue;
                }

                let found = Rect {
                    min: Point::new(columns.start, rows.start),
                    max: Point::new(columns.end, rows.end),
                };
                if visit(&found, IVec2::new(right, up)) {
                    return true;
                }
            }
        }
        false
    }
}

/// Returns a rectangle without a margin at its ends.
fn inner(Rect { min, max }: &Rect, margin: i32) -> Rect {
    Rect {
        min: Point::new(min.x + margin, min.y + margin),
        max: Point::new(max.x - margin, max.y - margin),
    }
}
