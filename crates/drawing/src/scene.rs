//! A subject in a rectangle of the screen: coordinate conversion, the visible range, and the ground below all
//! parts.

use emath::{Align2, Pos2, Rect, Vec2, vec2};
use glam::DVec2;
use tilescope_core::{Point, Rect as LatticeRect, Stage};
use tilescope_session::layers::Layer;
use tilescope_session::moment::ShownMoment;
use tilescope_session::session::Session;
use tilescope_session::units::position;

use crate::made::Made;
use crate::palette::Palette;
use crate::subject::Subject;
use crate::surface::{Stroke, Surface, Tag};

/// Font size of a tag, and the room around its text, in screen points.
pub(crate) const TAG_SIZE: f32 = 12.0;
pub(crate) const TAG_PADDING: Vec2 = vec2(6.0, 3.0);

/// How far around a periodic domain its copies are drawn, in r.
const AROUND: f64 = 8.0;

/// Returns how far around the domain of a session its copies are drawn, in r: 0 if it is bounded. There is one copy on each
/// side, so it is no more than the domain's shorter side.
#[must_use]
pub fn drawn_around(session: &Session) -> f64 {
    if session.run().domain.is_periodic() {
        AROUND.min(session.size_radii().min_element())
    } else {
        0.0
    }
}

/// A subject as it appears in a rectangle of the screen.
pub struct Scene<'a> {
    /// The rectangle, in screen points.
    pub rect: Rect,
    /// The moment and its view.
    pub subject: Subject<'a>,
    /// The run and its verdict.
    pub session: &'a Session,
    /// The moment that is shown.
    pub shown: ShownMoment<'a>,
    /// The stage of the moment.
    pub stage: Stage,
    /// The colours of the look.
    pub palette: &'a Palette,
    /// The lowest visible coordinates, in r.
    pub low: DVec2,
    /// The highest visible coordinates, in r.
    pub high: DVec2,
    /// The part of the KD-tree that exists.
    pub made: Made,
}

impl<'a> Scene<'a> {
    /// Returns the scene of a subject in a rectangle.
    #[must_use]
    pub fn new(rect: Rect, subject: Subject<'a>, palette: &'a Palette) -> Self {
        let (low, high) = subject.camera.visible(rect);
        let shown = subject.shown;
        Self {
            rect,
            subject,
            session: shown.session,
            shown,
            stage: shown.stage,
            palette,
            low,
            high,
            made: Made::at(&shown),
        }
    }

    /// Returns the position on the screen of a position of the domain, given in r.
    #[must_use]
    pub fn at(&self, position: impl Into<DVec2>) -> Pos2 {
        self.subject.camera.screen_from_domain(self.rect, position)
    }

    /// Returns the position of a lattice point on the screen.
    #[must_use]
    pub fn point(&self, point: Point) -> Pos2 {
        self.at(position(point))
    }

    /// Returns the screen points in one r.
    #[must_use]
    pub const fn scale(&self) -> f32 {
        self.subject.camera.scale as f32
    }

    /// Returns the radius of the disks of samples, in screen points.
    #[must_use]
    pub fn disk_scale(&self) -> f32 {
        self.scale() * self.shown.disk_radius() as f32
    }

    /// Returns the screen points in one r by which symbols of samples get their size: more than there are where fewer samples
    /// of nested levels are shown, or where radii are larger than r, which leaves more room.
    #[must_use]
    pub fn symbol_scale(&self) -> f32 {
        self.scale() * self.shown.spacing() as f32
    }

    /// Returns about how many samples are in view.
    #[must_use]
    pub fn count_in_view(&self) -> usize {
        self.shown.count_within(self.low, self.high)
    }

    /// Returns whether a layer is on.
    #[must_use]
    pub fn has(&self, layer: Layer) -> bool {
        self.subject.layers.has(layer)
    }

    /// Returns the rectangle between two points, on the screen.
    #[must_use]
    pub fn screen_rect(&self, low: impl Into<DVec2>, high: impl Into<DVec2>) -> Rect {
        Rect::from_two_pos(self.at(low), self.at(high))
    }

    /// Returns a lattice rectangle on the screen.
    #[must_use]
    pub fn lattice_rect(&self, rect: &LatticeRect) -> Rect {
        Rect::from_two_pos(self.point(rect.min), self.point(rect.max))
    }

    /// Returns the domain on the screen: the run's, or the pattern's where the pattern is shown.
    #[must_use]
    pub fn domain(&self) -> Rect {
        self.screen_rect(DVec2::ZERO, self.session.size_at(Some(self.stage)))
    }

    /// Returns the clip rectangle of parts that reach across the domain's border: the domain itself if it is periodic,
    /// since their images come in on the other side.
    #[must_use]
    pub fn inside(&self) -> Rect {
        if self.session.run().domain.is_periodic() {
            self.domain().intersect(self.rect)
        } else {
            self.rect
        }
    }

    /// Returns the clip rectangle of parts that the copies around a periodic domain have, too.
    #[must_use]
    pub fn around(&self) -> Rect {
        if self.session.run().domain.is_periodic() {
            let margin = DVec2::splat(drawn_around(self.session));
            let size = self.session.size_radii();
            self.screen_rect(-margin, size + margin)
                .intersect(self.rect)
        } else {
            self.rect
        }
    }

    /// Returns whether a place is in the domain or in a copy that is drawn around it.
    pub(crate) fn is_drawn(&self, place: DVec2) -> bool {
        let margin = DVec2::splat(drawn_around(self.session));
        let end = self.session.size_radii() + margin;
        (place.cmpge(-margin) & place.cmple(end)).all()
    }

    /// Returns the shifts by whole periods that move something of the box from `low` to `high` both into the domain or a
    /// copy that is drawn, and into view; of a bounded domain, the shift by zero alone, if the box is in view.
    pub(crate) fn shifts(&self, low: DVec2, high: DVec2) -> impl Iterator<Item = DVec2> + use<> {
        let size = self.session.size_radii();
        let margin = drawn_around(self.session);
        let steps = |k: usize| {
            // The first step is the least at which the moved box still reaches the margin's lower end, the last one
            // the greatest at which it still reaches the upper end. There is at most one copy on each side, however
            // wide the margin.
            let (from, to) = if margin > 0.0 {
                let first = ((-margin - high[k]) / size[k]).ceil();
                let last = ((size[k] + margin - low[k]) / size[k]).floor();
                (first.max(-1.0) as i32, last.min(1.0) as i32)
            } else {
                (0, 0)
            };
            from..=to
        };

        let (columns, rows) = (steps(0), steps(1));
        let (view_low, view_high) = (self.low, self.high);

        let moves = rows.flat_map(move |up| columns.clone().map(move |right| (right, up)));
        let shifts = moves.map(move |(right, up)| DVec2::new(right.into(), up.into()) * size);
        shifts.filter(move |shift| {
            ((high + *shift).cmpge(view_low) & (low + *shift).cmple(view_high)).all()
        })
    }

    /// Returns whether disks and gaps are large enough to be drawn.
    #[must_use]
    pub fn is_fine(&self) -> bool {
        let radius = self.shown.disk_radius() * self.session.largest_radius();
        self.subject.camera.scale * radius >= crate::MIN_DISK_SCALE
    }

    /// Draws a text with a background, so that it is readable over anything.
    pub(crate) fn tag(&self, surface: &mut impl Surface, pos: Pos2, anchor: Align2, text: String) {
        surface.tag(&Tag {
            text,
            pos,
            anchor,
            size: TAG_SIZE,
            ink: self.palette.text,
            ground: self.palette.panel.gamma_multiply(0.9),
            border: None,
            padding: TAG_PADDING,
            rounding: 5.0,
        });
    }

    /// Returns the ends of the visible part of a horizontal or vertical line; `None` if no part is visible.
    pub(crate) fn visible_line(&self, ends: [Pos2; 2], width: f32) -> Option<[Pos2; 2]> {
        let line = Rect::from_two_pos(ends[0], ends[1]);
        let seen = line.intersect(self.rect.expand(width));
        let is_seen = seen.min.x <= seen.max.x && seen.min.y <= seen.max.y;
        is_seen.then_some([seen.min, seen.max])
    }

    /// Fills the domain and draws its border.
    pub fn ground(&self, surface: &mut impl Surface) {
        let border = Stroke::new(1.2, self.palette.border);
        surface.rect(self.domain(), Some(self.palette.domain), Some(border));
    }
}
