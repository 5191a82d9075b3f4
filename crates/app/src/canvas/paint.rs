//! The layers of the canvas, from the ground up: one mesh per symbol, stamped at every sample in view.
//! Nothing outside the view is touched.

use egui::{
    Align2, Color32, ColorImage, FontId, Mesh, Painter, Pos2, Rect, Shape, Stroke, StrokeKind,
    Vec2, pos2, vec2,
};
use tilescope_core::stages::detect::Candidate;
use tilescope_core::{Iteration, Origin, Point, Rect as LatticeRect, Stage, Standing};

use super::layers::{Colouring, Layer};
use super::raster::{Density, Frame};
use super::sprites::{Sprite, Sprites, Stamp};
use super::subject::Subject;
use crate::moment::Shown;
use crate::session::{Session, radii};
use crate::theme::Palette;

/// Disks larger than this are drawn as circles, not as pictures, in screen points.
const MAX_DISK_SPRITE: f32 = 160.0;
/// Blocks at least this wide show their number, in screen points.
const MIN_LABELLED_BLOCK: f32 = 84.0;

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

    fn screen_rect(&self, low: [f64; 2], high: [f64; 2]) -> Rect {
        Rect::from_two_pos(self.at(low), self.at(high))
    }

    fn block_rect(&self, rect: &LatticeRect) -> Rect {
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
        let stamp = sprites.stamp(self.painter.ctx(), Sprite::Dot, radius);
        let mut mesh = Mesh::with_texture(stamp.texture);
        for point in self.session.run().pattern.samples() {
            let pos = self.at([radii(point.x), radii(point.y)]);
            if self.rect.expand(8.0).contains(pos) {
                add_stamp(&mut mesh, stamp, pos, self.palette.sample);
            }
        }
        self.painter.add(mesh);
    }

    fn visible_blocks(&self) -> impl Iterator<Item = (u32, Rect)> {
        let leaves = &self.session.run().blocks.leaves;
        let rects = leaves.iter().map(|block| self.block_rect(&block.rect));
        (0..)
            .zip(rects)
            .filter(|(_, rect)| rect.intersects(self.rect))
    }

    /// Tints the blocks.
    pub fn block_tints(&self) {
        let strength = if self.stage == Stage::Blocks {
            0.20
        } else {
            0.085
        };
        for (index, rect) in self.visible_blocks() {
            let tint = self.palette.block(index).gamma_multiply(strength);
            self.painter.rect_filled(rect, 0.0, tint);
        }
    }

    /// Draws the borders of the blocks, and their numbers where there is room.
    pub fn block_borders(&self) {
        if !self.has(Layer::Blocks) {
            return;
        }
        for (index, rect) in self.visible_blocks() {
            let color = self.palette.block(index);
            let stroke = Stroke::new(1.0, color.gamma_multiply(0.55));
            self.painter
                .rect_stroke(rect, 0.0, stroke, StrokeKind::Middle);
            if rect.width().min(rect.height()) >= MIN_LABELLED_BLOCK {
                self.block_number(index, rect.intersect(self.rect).left_top(), color);
            }
        }
    }

    fn block_number(&self, index: u32, corner: Pos2, color: Color32) {
        let galley = self
            .painter
            .layout_no_wrap(index.to_string(), FontId::monospace(11.0), color);
        let tag = Rect::from_min_size(corner, galley.size() + vec2(9.0, 5.0));
        let ground = self.palette.domain.gamma_multiply(0.86);
        self.painter.rect_filled(tag, 0.0, ground);
        self.painter.galley(corner + vec2(4.5, 2.5), galley, color);
    }

    /// Draws everything that is made of symbols.
    pub fn symbols(&self, sprites: &mut Sprites, fine: bool) {
        if fine && self.has(Layer::Disks) && self.stage >= Stage::Tile {
            self.disks(sprites);
        }
        self.block_borders();
        if self.has(Layer::Pattern) {
            self.clips();
        }
        if self.has(Layer::Conflicts) {
            self.conflicts(sprites);
        }
        self.samples(sprites);
        self.search_symbols(sprites);
        super::now::paint(self);
        self.highlight(sprites);
    }

    fn visit(&self, mut visit: impl FnMut(u32, Pos2, Standing)) {
        let reach = 6.0 / self.subject.camera.scale;
        self.session
            .index
            .visit(self.low, self.high, reach, |seen| {
                let standing = self.shown.standing(seen.id);
                if !seen.image && standing != Standing::Absent {
                    visit(seen.id, self.at(seen.place), standing);
                }
            });
    }

    fn disks(&self, sprites: &mut Sprites) {
        let radius = self.scale();
        let clip = if self.session.run().domain.is_periodic() {
            self.screen_rect([0.0; 2], self.session.size_radii())
        } else {
            self.rect
        };
        let painter = self.painter.with_clip_rect(clip.intersect(self.rect));
        let small = radius <= MAX_DISK_SPRITE;
        let stamp = sprites.stamp(
            painter.ctx(),
            Sprite::Disk,
            if small { radius } else { 1.0 },
        );
        let mut mesh = Mesh::with_texture(stamp.texture);
        self.session.index.visit(self.low, self.high, 1.0, |seen| {
            let standing = self.shown.standing(seen.id);
            if !matches!(standing, Standing::Valid | Standing::Tiled) {
                return;
            }
            let color = self.sample_color(seen.id);
            let pos = self.at(seen.place);
            if small {
                add_stamp(&mut mesh, stamp, pos, color);
            } else {
                let stroke = Stroke::new(1.0, color.gamma_multiply(0.62));
                painter.circle(pos, radius, color.gamma_multiply(0.05), stroke);
            }
        });
        painter.add(mesh);
    }

    /// Draws each block enlarged by r, dashed.
    fn clips(&self) {
        for (index, rect) in self.visible_blocks() {
            // Dashing what is far outside the view could take millions of dashes.
            let clip = rect.expand(self.scale()).intersect(self.rect.expand(20.0));
            let corners = [
                clip.left_top(),
                clip.right_top(),
                clip.right_bottom(),
                clip.left_bottom(),
                clip.left_top(),
            ];
            let stroke = Stroke::new(1.0, self.palette.block(index).gamma_multiply(0.9));
            self.painter
                .extend(Shape::dashed_line(&corners, stroke, 6.0, 4.0));
        }
    }

    /// Draws the conflicts after tiling, or how elimination resolved them.
    fn conflicts(&self, sprites: &mut Sprites) {
        let stamp = sprites.stamp(self.painter.ctx(), Sprite::Stroke, 0.7);
        let mut mesh = Mesh::with_texture(stamp.texture);
        let color = self.palette.conflict;
        match self.stage {
            Stage::Tile => self.open_conflicts(&mut mesh, stamp),
            Stage::Eliminate => {
                self.visit(|id, _, standing| {
                    if let Standing::Eliminated { by } = standing {
                        self.edge(&mut mesh, stamp, [id, by], color.gamma_multiply(0.6));
                    }
                });
                if !self.shown.ends_stage() {
                    self.open_conflicts(&mut mesh, stamp);
                }
            }
            _ => {}
        }
        self.painter.add(mesh);
    }

    /// Draws the conflicts between samples that are both there.
    fn open_conflicts(&self, mesh: &mut Mesh, stamp: Stamp) {
        let color = self.palette.conflict.gamma_multiply(0.85);
        for &[a, b] in &self.session.conflicts {
            if self.shown.covers(a) && self.shown.covers(b) {
                self.edge(mesh, stamp, [a, b], color);
            }
        }
    }

    fn edge(&self, mesh: &mut Mesh, stamp: Stamp, [a, b]: [u32; 2], color: Color32) {
        let from = self.session.place(a);
        let (from, to) = (self.at(from), self.at(self.session.image_near(b, from)));
        if self.rect.intersects(Rect::from_two_pos(from, to)) {
            add_dashes(mesh, stamp, from, to, color);
        }
    }

    /// Returns the colour of a sample.
    pub fn sample_color(&self, id: u32) -> Color32 {
        match (
            self.session.run().samples.origins[id as usize],
            self.subject.colouring,
        ) {
            (Origin::Inserted { .. }, _) => self.palette.inserted,
            (Origin::Tiled { block, .. }, Colouring::Block) => self.palette.block(block),
            (Origin::Tiled { own: true, .. }, Colouring::Provenance) => self.palette.sample,
            (Origin::Tiled { .. }, Colouring::Provenance) => self.palette.margin,
        }
    }

    fn samples(&self, sprites: &mut Sprites) {
        let scale = self.scale();
        let ctx = self.painter.ctx();
        let dot = sprites.stamp(ctx, Sprite::Dot, (0.2 * scale).clamp(1.0, 5.5));
        let cross = sprites.stamp(ctx, Sprite::Cross, (0.26 * scale).clamp(2.2, 8.0));
        let ground = sprites.stamp(ctx, Sprite::Diamond, (0.27 * scale).clamp(2.6, 8.5));
        let mut dots = Mesh::with_texture(dot.texture);
        let mut crosses = Mesh::with_texture(cross.texture);
        let mut diamonds = Mesh::with_texture(ground.texture);
        let dropped = self.palette.eliminated.gamma_multiply(0.35);
        // Once the result stands, those it does not hold step back.
        let presence = match self.stage {
            Stage::Finish => 0.3,
            Stage::Iterate(_) => 0.6,
            _ => 1.0,
        };
        let ghost = self.palette.eliminated.gamma_multiply(presence);
        self.visit(|id, pos, standing| match standing {
            Standing::Eliminated { .. } if self.has(Layer::Eliminated) => {
                add_stamp(&mut crosses, cross, pos, ghost);
            }
            Standing::Dropped if self.has(Layer::Eliminated) && self.stage == Stage::Tile => {
                add_stamp(&mut dots, dot, pos, dropped);
            }
            Standing::Valid | Standing::Tiled => {
                match self.session.run().samples.origins[id as usize] {
                    Origin::Inserted { .. } if self.has(Layer::Inserted) => {
                        let outline = Stamp {
                            half: ground.half + 1.6,
                            ..ground
                        };
                        add_stamp(&mut diamonds, outline, pos, self.palette.domain);
                        add_stamp(&mut diamonds, ground, pos, self.palette.inserted);
                    }
                    Origin::Tiled { .. } if self.has(Layer::Samples) => {
                        add_stamp(&mut dots, dot, pos, self.sample_color(id));
                    }
                    _ => {}
                }
            }
            _ => {}
        });
        for mesh in [crosses, dots, diamonds] {
            self.painter.add(mesh);
        }
    }

    /// Draws the detectors and candidates of the iteration that is shown or comes next.
    fn search_symbols(&self, sprites: &mut Sprites) {
        let iterations = &self.session.run().iterations;
        let iteration = match self.stage {
            Stage::Eliminate => iterations.first(),
            Stage::Iterate(k) => iterations.get(k as usize - 1),
            _ => None,
        };
        let Some(iteration) = iteration else {
            return;
        };
        let (scale, ctx) = (self.scale(), self.painter.ctx());
        let view = self.rect.expand(12.0);
        if self.has(Layer::Detectors) {
            let stamp = sprites.stamp(ctx, Sprite::Detector, (0.33 * scale).clamp(2.4, 9.0));
            let mut mesh = Mesh::with_texture(stamp.texture);
            let marked = iteration
                .detectors
                .iter()
                .filter(|&&id| self.shown.is_marked(id));
            let places = marked.map(|&id| self.session.place(id));
            for pos in places
                .map(|place| self.at(place))
                .filter(|p| view.contains(*p))
            {
                add_stamp(&mut mesh, stamp, pos, self.palette.detector);
            }
            self.painter.add(mesh);
        }
        if self.has(Layer::Candidates) && self.stage != Stage::Eliminate {
            let stamp = sprites.stamp(ctx, Sprite::Triangle, (0.36 * scale).clamp(3.5, 10.0));
            let mut mesh = Mesh::with_texture(stamp.texture);
            for point in self.candidates(iteration) {
                let pos = self.at([radii(point.x), radii(point.y)]);
                if view.contains(pos) {
                    add_stamp(&mut mesh, stamp, pos, self.palette.candidate);
                }
            }
            self.painter.add(mesh);
        }
    }

    /// Returns the candidates of an iteration that have been found by now.
    fn candidates<'b>(&'b self, iteration: &'b Iteration) -> impl Iterator<Item = Point> + 'b {
        let debugger = self.shown.debugger.filter(|_| !self.shown.ends_stage());
        let found = move |candidate: &&Candidate| {
            debugger.is_none_or(|debugger| {
                let cursor = debugger.state().cursor();
                let recording = debugger.recording();
                recording.gap(candidate.sites, cursor).is_some()
            })
        };
        let candidates = iteration.candidates.iter().filter(found);
        candidates.map(|candidate| candidate.point)
    }

    /// Draws the current samples and the place that a verdict was followed to.
    fn highlight(&self, sprites: &mut Sprites) {
        super::overlay::sight(self.painter, self.rect, &self.subject, self.palette);
        let radius = (0.45 * self.scale()).clamp(6.0, 14.0);
        let stamp = sprites.stamp(self.painter.ctx(), Sprite::Halo, radius);
        let mut mesh = Mesh::with_texture(stamp.texture);
        let stroke = Stroke::new(1.2, self.palette.halo.gamma_multiply(0.8));
        if let Some(place) = self.subject.place {
            let at = self.at(place);
            for side in [vec2(7.0, 0.0), vec2(0.0, 7.0)] {
                self.painter.line_segment([at - side, at + side], stroke);
            }
        }
        if let Some(id) = self.subject.selected {
            let place = self.session.place(id);
            if self.stage >= Stage::Tile {
                self.painter
                    .circle_stroke(self.at(place), self.scale(), stroke);
            }
            for cause in causes(&self.shown, id) {
                let from = self.at(self.session.image_near(cause, place));
                self.painter.line_segment([from, self.at(place)], stroke);
            }
            add_stamp(&mut mesh, stamp, self.at(place), self.palette.halo);
        }
        if let Some(id) = self
            .subject
            .hovered
            .filter(|_| self.subject.hovered != self.subject.selected)
        {
            let color = self.palette.halo.gamma_multiply(0.6);
            add_stamp(&mut mesh, stamp, self.at(self.session.place(id)), color);
        }
        self.painter.add(mesh);
    }

    /// Returns a picture of all samples in view as points.
    pub fn points(&self, frame: &Frame) -> ColorImage {
        let mut density = Density::empty(frame);
        let blocks = self.session.run().blocks.leaves.len() as u32;
        let colors: Vec<Color32> = (0..blocks).map(|k| self.palette.block(k)).collect();
        self.session.index.visit(self.low, self.high, 0.0, |seen| {
            let standing = self.shown.standing(seen.id);
            if seen.image || !matches!(standing, Standing::Valid | Standing::Tiled) {
                return;
            }
            let color = match self.session.run().samples.origins[seen.id as usize] {
                Origin::Tiled { block, .. } if self.subject.colouring == Colouring::Block => {
                    colors[block as usize]
                }
                _ => self.sample_color(seen.id),
            };
            density.add(frame.pixel_from_domain(seen.place), color);
        });
        density.image(1.1)
    }
}

/// Returns the samples that made `id` what it is.
fn causes(shown: &Shown<'_>, id: u32) -> Vec<u32> {
    use tilescope_core::stages::detect::Sites;
    if let Standing::Eliminated { by } = shown.standing(id) {
        return vec![by];
    }
    match shown.session.run().samples.origins[id as usize] {
        Origin::Inserted { sites, .. } => match sites {
            Sites::Three(ids) => ids.to_vec(),
            Sites::Border(ids) => ids.to_vec(),
            Sites::Corner(site) => vec![site],
            Sites::Dart | Sites::Unrecorded => Vec::new(),
        },
        Origin::Tiled { .. } => Vec::new(),
    }
}

fn add_stamp(mesh: &mut Mesh, stamp: Stamp, pos: Pos2, color: Color32) {
    let rect = Rect::from_center_size(pos, Vec2::splat(2.0 * stamp.half));
    mesh.add_rect_with_uv(rect, super::UNIT, color);
}

/// Adds a dashed line: quads whose texture softens both sides.
fn add_dashes(mesh: &mut Mesh, stamp: Stamp, from: Pos2, to: Pos2, color: Color32) {
    let length = (to - from).length();
    if length < 0.5 {
        return;
    }
    let along = (to - from) / length;
    let across = along.rot90() * stamp.half;
    let (dash, gap) = if length > 24.0 {
        (6.0, 4.0)
    } else {
        (2.5, 1.5)
    };
    let mut start = 0.0;
    while start < length {
        let ends = [start, (start + dash).min(length)].map(|t| from + along * t);
        let first = mesh.vertices.len() as u32;
        for (end, side, v) in [(0, -1.0, 0.0), (0, 1.0, 1.0), (1, -1.0, 0.0), (1, 1.0, 1.0)] {
            mesh.vertices.push(egui::epaint::Vertex {
                pos: ends[end] + across * side,
                uv: pos2(0.5, v),
                color,
            });
        }
        mesh.add_triangle(first, first + 1, first + 2);
        mesh.add_triangle(first + 2, first + 1, first + 3);
        start += dash + gap;
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
