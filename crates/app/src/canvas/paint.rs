//! What is drawn in a frame, and the ground of it: the domain, or the pattern. It decides nothing about samples.

use egui::{Align2, FontId, Painter, Pos2, Rect, Stroke, StrokeKind, vec2};
use tilescope_core::{Rect as LatticeRect, Stage};
use tilescope_drawing::palette::Palette;
use tilescope_session::layers::Layer;
use tilescope_session::moment::Shown;
use tilescope_session::session::Session;
use tilescope_session::units::radii;

use super::sprites::{Sprite, Sprites};
use super::strokes::Stamps;
use super::tree::Made;
use tilescope_drawing::subject::Subject;

/// What is drawn in one frame.
pub struct Scene<'a> {
    pub painter: &'a Painter,
    pub rect: Rect,
    pub subject: Subject<'a>,
    pub session: &'a Session,
    pub shown: Shown<'a>,
    pub stage: Stage,
    pub palette: &'a Palette,
    /// The lowest visible coordinates, in r.
    pub low: [f64; 2],
    /// The highest visible coordinates, in r.
    pub high: [f64; 2],
    /// How much of the KD-tree there is.
    pub made: Made,
}

impl<'a> Scene<'a> {
    pub fn new(
        painter: &'a Painter,
        rect: Rect,
        subject: Subject<'a>,
        palette: &'a Palette,
    ) -> Self {
        let (low, high) = subject.camera.visible(rect);
        let shown = subject.shown;
        Self {
            painter,
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

    pub(super) fn at(&self, place: [f64; 2]) -> Pos2 {
        self.subject.camera.screen_from_domain(self.rect, place)
    }

    pub(super) fn scale(&self) -> f32 {
        self.subject.camera.scale as f32
    }

    pub(super) fn has(&self, layer: Layer) -> bool {
        self.subject.layers.has(layer)
    }

    /// Returns where a rectangle between two places appears.
    pub(super) fn screen_rect(&self, low: [f64; 2], high: [f64; 2]) -> Rect {
        Rect::from_two_pos(self.at(low), self.at(high))
    }

    /// Returns where a rectangle of the lattice appears.
    pub(super) fn lattice_rect(&self, rect: &LatticeRect) -> Rect {
        self.screen_rect(
            [radii(rect.min.x), radii(rect.min.y)],
            [radii(rect.max.x), radii(rect.max.y)],
        )
    }

    /// Draws the ground of the domain and its border.
    pub fn domain(&self) {
        let size = match self.stage {
            Stage::Pattern => {
                let domain = self.session.run().pattern.domain();
                [radii(domain.width()), radii(domain.height())]
            }
            _ => self.session.size_radii(),
        };
        let rect = self.screen_rect([0.0; 2], size);
        self.painter.rect_filled(rect, 0.0, self.palette.domain);
        let stroke = Stroke::new(1.2, self.palette.border);
        self.painter
            .rect_stroke(rect, 0.0, stroke, StrokeKind::Outside);
    }

    /// Draws the pattern's own samples.
    pub fn pattern(&self, sprites: &mut Sprites) {
        let radius = (0.17 * self.scale()).clamp(0.8, 5.0);
        let mut stamps = Stamps::of(sprites, self.painter.ctx(), Sprite::Dot, radius);
        for point in self.session.run().pattern.samples() {
            let pos = self.at([radii(point.x), radii(point.y)]);
            if self.rect.expand(8.0).contains(pos) {
                stamps.add(pos, self.palette.sample);
            }
        }
        self.painter.add(stamps.into_shape());
    }
}

/// Text with a ground, so that it can be read over anything.
pub fn tag(painter: &Painter, pos: Pos2, anchor: Align2, text: &str, palette: &Palette) {
    let galley = painter.layout_no_wrap(text.to_owned(), FontId::monospace(12.0), palette.text);
    let rect = anchor.anchor_size(pos, galley.size());
    let ground = palette.panel.gamma_multiply(0.9);
    painter.rect_filled(rect.expand2(vec2(6.0, 3.0)), 5.0, ground);
    painter.galley(rect.min, galley, palette.text);
}
