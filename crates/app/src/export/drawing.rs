//! What the canvas shows of a moment, as shapes of a picture: the same layers in the same sequence, colours and sizes. What
//! a step tests and changes is drawn by the figures.

use egui::Color32;
use tilescope_analysis::Tessellation;
use tilescope_core::stages::blocks::Axis;
use tilescope_core::{Point, Rect as LatticeRect, Stage, Standing};
use tilescope_drawing::palette::Palette;
use tilescope_figures::{
    Anchor, Baseline, Color, Fill, Font, Group, Hatch, Marker, MomentOptions, Rect, Shape, Stroke,
    Style, Text, text_width, with_alpha,
};
use tilescope_session::geometry::{Geometry, MOST_SAMPLES, region_of};
use tilescope_session::layers::Layer;
use tilescope_session::moment::Shown;
use tilescope_session::session::Session;
use tilescope_session::units::radii;

use super::picture::View;
use crate::canvas::MIN_DISK_SCALE;
use crate::canvas::blocks::{MIN_LABELLED, TINTS};
use crate::canvas::tree::{self, Made};
use tilescope_drawing::look::Symbol;
use tilescope_drawing::looks::{Looks, Swatches};
use tilescope_drawing::subject::Subject;

/// Circles of a larger radius, in pixels, are hardly curved where they can be seen.
const LARGEST_CIRCLE: f64 = 10_000.0;
/// By how much a radius may exceed r from rounding alone.
const HAIR: f64 = 1e-6;

/// Returns a colour of the window for a picture, `opacity` times as strong.
pub(super) fn color(color: Color32, opacity: f64) -> Color {
    let [red, green, blue, alpha] = color.to_srgba_unmultiplied();
    with_alpha(
        [red, green, blue, 255],
        (f64::from(alpha) * opacity).round() as u8,
    )
}

/// A moment on the canvas that is pictured.
pub(super) struct Drawing<'a> {
    session: &'a Session,
    shown: Shown<'a>,
    view: &'a View,
    /// None: looks of samples do not follow from it.
    geometry: &'a Geometry,
    palette: &'static Palette,
    made: Made,
    /// Where the plane is seen, in pixels.
    frame: Rect,
    /// Where the domain is seen, in pixels: what reaches over the border of a periodic one comes in at the other side.
    inside: Rect,
    /// How far one sees from the middle, in r.
    half: [f64; 2],
    center: [f64; 2],
    groups: Vec<Group>,
}

impl<'a> Drawing<'a> {
    pub(super) fn new(
        shown: Shown<'a>,
        view: &'a View,
        geometry: &'a Geometry,
        options: &MomentOptions,
    ) -> Self {
        let frame = options.frame();
        let mut drawing = Self {
            session: shown.session,
            shown,
            view,
            geometry,
            palette: view.palette(),
            made: Made::at(&shown),
            frame,
            inside: frame,
            half: [0, 1].map(|k| (frame.max[k] - frame.min[k]) / view.camera.scale / 2.0),
            center: view.camera.center,
            groups: Vec::new(),
        };
        if drawing.is_periodic() {
            let domain = drawing.rect([0.0; 2], shown.session.size_radii());
            let low = [0, 1].map(|k| domain.min[k].clamp(frame.min[k], frame.max[k]));
            let high = [0, 1].map(|k| domain.max[k].clamp(low[k], frame.max[k]));
            drawing.inside = Rect::new(low, high);
        }
        drawing
    }

    /// Returns all layers that are on, from the ground up.
    pub(super) fn layers(mut self) -> Vec<Group> {
        let has = |layer| self.view.layers.has(layer);
        if self.shown.stage == Stage::Pattern {
            self.pattern();
            return self.groups;
        }
        self.ground(self.session.size_radii());
        let fine = self.view.camera.scale >= MIN_DISK_SCALE;
        if fine && has(Layer::Gaps) && self.shown.stage >= Stage::Eliminate {
            self.gaps();
        }
        let swatches = self.swatches();
        let subject = self.subject();
        let looks = Looks::new(&subject, self.palette, &swatches);
        if has(Layer::Blocks) {
            self.tints();
        }
        self.band();
        if has(Layer::Delaunay) || has(Layer::Voronoi) || has(Layer::Circumcircles) {
            self.triangulation();
        }
        if fine && has(Layer::Disks) && self.shown.stage >= Stage::Tile {
            self.disks(&looks);
        }
        if has(Layer::Blocks) {
            self.borders();
        }
        self.seams();
        if has(Layer::Tree) {
            self.tree();
        }
        if has(Layer::Pattern) {
            self.clips();
        }
        if has(Layer::Conflicts) {
            self.conflicts();
        }
        self.samples(&looks);
        self.search();
        self.groups
    }

    /// Returns the domain of the run before anything has happened in it.
    pub(super) fn empty_domain(mut self) -> Vec<Group> {
        self.ground(self.session.size_radii());
        self.groups
    }

    fn subject(&self) -> Subject<'a> {
        Subject {
            shown: self.shown,
            camera: self.view.camera,
            layers: self.view.layers,
            colouring: self.view.colouring,
            hovered: None,
            selected: None,
            place: None,
            sight: None,
            geometry: self.geometry,
            contrast: None,
            causes: None,
        }
    }

    fn swatches(&self) -> Swatches {
        let mut swatches = Swatches::default();
        swatches.follow(&self.subject(), self.palette);
        swatches
    }

    fn is_periodic(&self) -> bool {
        self.session.run().domain.is_periodic()
    }

    fn add(&mut self, name: &str, clip: Rect, shapes: Vec<Shape>) {
        if !shapes.is_empty() {
            self.groups.push(Group {
                clip: Some(clip),
                shapes,
                ..Group::new(name)
            });
        }
    }

    /// Returns the pixel of a place, given in r.
    fn pixel(&self, place: [f64; 2]) -> [f64; 2] {
        let middle = [0, 1].map(|k| f64::midpoint(self.frame.min[k], self.frame.max[k]));
        let scale = self.view.camera.scale;
        [
            middle[0] + (place[0] - self.center[0]) * scale,
            middle[1] - (place[1] - self.center[1]) * scale,
        ]
    }

    fn rect(&self, low: [f64; 2], high: [f64; 2]) -> Rect {
        let ([left, bottom], [right, top]) = (self.pixel(low), self.pixel(high));
        Rect::new([left, top], [right, bottom])
    }

    /// Returns where a rectangle of the lattice is seen, `by` r larger on every side, unless it is out of view.
    fn lattice_rect(&self, rect: &LatticeRect, by: f64) -> Option<Rect> {
        let corner = |point: Point, by: f64| [radii(point.x) + by, radii(point.y) + by];
        let (low, high) = (corner(rect.min, -by), corner(rect.max, by));
        self.sees(low, high).then(|| self.rect(low, high))
    }

    /// Returns whether something between two corners, in r, is in view.
    fn sees(&self, low: [f64; 2], high: [f64; 2]) -> bool {
        let half = self.half;
        (0..2).all(|k| low[k] <= self.center[k] + half[k] && self.center[k] - half[k] <= high[k])
    }

    /// Returns the lowest and the highest places in view, in r.
    fn corners(&self) -> [[f64; 2]; 2] {
        [-1.0, 1.0].map(|sign| [0, 1].map(|k| self.center[k] + sign * self.half[k]))
    }

    /// The domain, and what is around it.
    fn ground(&mut self, size: [f64; 2]) {
        let outside = Shape::Rect {
            rect: self.frame,
            style: Style::filled(color(self.view.outside(), 1.0)),
        };
        let border = Stroke::new(color(self.palette.border, 1.0), 1.2);
        let domain = Shape::Rect {
            rect: self.rect([0.0; 2], size),
            style: Style::filled(color(self.palette.domain, 1.0)).with_stroke(border),
        };
        self.add("ground", self.frame, vec![outside, domain]);
    }

    /// The pattern, which has a domain of its own.
    fn pattern(&mut self) {
        let pattern = &self.session.run().pattern;
        let domain = pattern.domain();
        self.ground([radii(domain.width()), radii(domain.height())]);
        let size = 2.0 * (0.17 * self.view.camera.scale).clamp(0.8, 5.0);
        let style = Style::filled(color(self.palette.sample, 1.0));
        let places = pattern.samples().iter();
        let places = places.map(|point| [radii(point.x), radii(point.y)]);
        let seen = places.filter(|&place| self.sees(place, place));
        let dots = seen.map(|place| Shape::marker(Marker::Dot, self.pixel(place), size, style));
        let dots = dots.collect();
        self.add("samples", self.frame, dots);
    }

    fn blocks(&self) -> Vec<(u32, Rect)> {
        let leaves = &self.session.run().blocks.leaves[..self.made.leaves];
        let rects = (0..).zip(leaves);
        let seen = rects.map(|(index, block)| (index, self.lattice_rect(&block.rect, 0.0)));
        seen.filter_map(|(index, rect)| Some((index, rect?)))
            .collect()
    }

    fn tints(&mut self) {
        let strength = TINTS[usize::from(self.shown.stage != Stage::Blocks)];
        let tint = |(index, rect)| Shape::Rect {
            rect,
            style: Style::filled(color(self.palette.block(index), f64::from(strength))),
        };
        let tints = self.blocks().into_iter().map(tint).collect();
        self.add("blocks", self.frame, tints);
    }

    fn borders(&mut self) {
        let blocks = self.blocks();
        let border = |&(index, rect): &(u32, Rect)| Shape::Rect {
            rect,
            style: Style::stroked(color(self.palette.block(index), 0.55), 1.0),
        };
        let borders = blocks.iter().map(border).collect();
        let mut numbers = Vec::new();
        for (index, rect) in blocks {
            let [width, height] = [0, 1].map(|k| rect.max[k] - rect.min[k]);
            if width.min(height) >= f64::from(MIN_LABELLED) {
                let corner = [0, 1].map(|k| rect.min[k].max(self.frame.min[k]));
                numbers.extend(self.tag(corner, &index.to_string(), self.palette.block(index)));
            }
        }
        self.add("block borders", self.frame, borders);
        self.add("block numbers", self.frame, numbers);
    }

    /// Returns a number with its ground, whose upper left corner is given.
    fn tag(&self, corner: [f64; 2], text: &str, ink: Color32) -> [Shape; 2] {
        let size = 11.0;
        let width = text_width(text, Font::Mono, size) + 9.0;
        let height = 19.0;
        let ground = Shape::Rect {
            rect: Rect::new(corner, [corner[0] + width, corner[1] + height]),
            style: Style::filled(color(self.palette.domain, 0.86)),
        };
        let at = [corner[0] + 4.5, corner[1] + height / 2.0];
        let mut text = Text::new(at, text, size, color(ink, 1.0));
        (text.font, text.baseline) = (Font::Mono, Baseline::Middle);
        [ground, Shape::Text(text)]
    }

    /// Hatches the domain and covers it with disks: what stays hatched is a gap, exactly.
    fn gaps(&mut self) {
        let gap = color(self.palette.gap, 1.0);
        let rect = self.rect([0.0; 2], self.session.size_radii());
        let hatch = Hatch {
            color: with_alpha(gap, 217),
            spacing: 5.0,
            width: 2.0,
        };
        let fills = [Fill::Solid(with_alpha(gap, 128)), Fill::Hatch(hatch)];
        let hatched = fills.map(|fill| Shape::Rect {
            rect,
            style: Style {
                fill: Some(fill),
                stroke: None,
            },
        });
        self.add("gaps", self.inside, hatched.into());
        let style = Style::filled(color(self.palette.domain, 1.0));
        let disks = self.disk_places(|id| self.shown.covers(id).then_some(style));
        self.add("covered", self.inside, disks);
    }

    /// Returns the disks in view, with their images across the border of a periodic domain, in the style that `style`
    /// gives them.
    fn disk_places(&self, style: impl Fn(u32) -> Option<Style>) -> Vec<Shape> {
        let [low, high] = self.corners();
        let mut disks = Vec::new();
        self.session.index.visit(low, high, 1.0, |seen| {
            if let Some(style) = style(seen.id) {
                let radius = self.view.camera.scale;
                disks.push(Shape::circle(self.pixel(seen.place), radius, style));
            }
        });
        disks
    }

    fn disks(&mut self, looks: &Looks<'_>) {
        let style = |id| {
            let look = looks.of(id);
            let ring = Stroke::new(color(look.color, 0.62), 0.9);
            look.disk
                .then(|| Style::filled(color(look.color, 0.07)).with_stroke(ring))
        };
        let disks = self.disk_places(style);
        self.add("disks", self.inside, disks);
    }

    /// The samples, eliminated ones below the others.
    fn samples(&mut self, looks: &Looks<'_>) {
        let scale = self.view.camera.scale;
        let domain = color(self.palette.domain, 1.0);
        let mut shapes: [Vec<Shape>; 3] = Default::default();
        let [low, high] = self.corners();
        self.session.index.visit(low, high, 6.0 / scale, |seen| {
            let look = looks.of(seen.id);
            let ink = color(look.color, 1.0);
            let (place, marker, radius, style) = match look.symbol {
                Symbol::Cross => {
                    let style = Style::stroked(ink, 1.2);
                    (0, Marker::Cross, (0.26 * scale).clamp(2.2, 8.0), style)
                }
                Symbol::Dot => {
                    let radius = (0.2 * scale).clamp(1.0, 5.5);
                    (1, Marker::Dot, radius, Style::filled(ink))
                }
                Symbol::Diamond => {
                    let style = Style::filled(ink).with_stroke(Stroke::new(domain, 1.6));
                    (
                        2,
                        Marker::Diamond,
                        (0.27 * scale).clamp(2.6, 8.5) + 0.8,
                        style,
                    )
                }
                Symbol::Ring | Symbol::None => return,
            };
            if !seen.image {
                let at = self.pixel(seen.place);
                shapes[place].push(Shape::marker(marker, at, 2.0 * radius, style));
            }
        });
        for (name, shapes) in ["eliminated", "samples", "inserted"]
            .into_iter()
            .zip(shapes)
        {
            self.add(name, self.frame, shapes);
        }
    }

    /// The detectors and candidates of the iteration that is shown or comes next.
    fn search(&mut self) {
        let iterations = &self.session.run().iterations;
        let iteration = match self.shown.stage {
            Stage::Eliminate => iterations.first(),
            Stage::Iterate(k) => iterations.get((k as usize).wrapping_sub(1)),
            _ => None,
        };
        let Some(iteration) = iteration else {
            return;
        };
        let scale = self.view.camera.scale;
        if self.view.layers.has(Layer::Detectors) {
            let ink = color(self.palette.detector, 1.0);
            let size = 2.0 * (0.33 * scale).clamp(2.4, 9.0);
            let marked = iteration.detectors.iter();
            let marked = marked.filter(|&&id| self.shown.is_marked(id));
            let places = marked.map(|&id| self.session.place(id));
            let seen = places.filter(|&place| self.sees(place, place));
            let rings = seen.map(|place| {
                Shape::marker(
                    Marker::Dot,
                    self.pixel(place),
                    size,
                    Style::stroked(ink, 1.4),
                )
            });
            let rings = rings.collect();
            self.add("detectors", self.frame, rings);
        }
        if self.view.layers.has(Layer::Candidates) && self.shown.stage != Stage::Eliminate {
            let debugger = self.shown.debugger.filter(|_| !self.shown.ends_stage());
            let found = |sites| {
                debugger.is_none_or(|debugger| {
                    let cursor = debugger.state().cursor();
                    debugger.recording().gap(sites, cursor).is_some()
                })
            };
            let size = 2.0 * (0.36 * scale).clamp(3.5, 10.0);
            let style = Style::stroked(color(self.palette.candidate, 1.0), 1.4);
            let candidates = iteration.candidates.iter();
            let places = candidates.filter(|candidate| found(candidate.sites));
            let places = places.map(|found| [radii(found.point.x), radii(found.point.y)]);
            let seen = places.filter(|&place| self.sees(place, place));
            let marks = seen.map(|at| Shape::marker(Marker::Triangle, self.pixel(at), size, style));
            let marks = marks.collect();
            self.add("candidates", self.frame, marks);
        }
    }

    /// What gluing can have touched.
    fn band(&mut self) {
        let combination = self.session.combination.as_ref();
        let Some(combination) = combination.filter(|_| self.view.layers.has(Layer::Seams)) else {
            return;
        };
        let tint = Style::filled(color(self.palette.accent, 0.10));
        let rects = combination.band.iter();
        let rects = rects.filter_map(|rect| self.lattice_rect(rect, 0.0));
        let band = rects
            .map(|rect| Shape::Rect { rect, style: tint })
            .collect();
        self.add("band", self.frame, band);
    }

    fn seams(&mut self) {
        let combination = self.session.combination.as_ref();
        let Some(combination) = combination.filter(|_| self.view.layers.has(Layer::Seams)) else {
            return;
        };
        let lines = combination.lines.iter();
        let segments: Vec<_> = lines.map(|ends| ends.map(|end| self.pixel(end))).collect();
        let stroke = Stroke::new(color(self.palette.accent, 1.0), 1.6);
        self.segments("seams", self.frame, segments, stroke);
    }

    fn segments(&mut self, name: &str, clip: Rect, segments: Vec<[[f64; 2]; 2]>, stroke: Stroke) {
        if !segments.is_empty() {
            self.add(name, clip, vec![Shape::Segments { segments, stroke }]);
        }
    }

    /// The splits of the KD-tree that were made by now, with their numbers.
    fn tree(&mut self) {
        let is_ground = self.shown.stage == Stage::Blocks;
        let ink = color(self.palette.text, if is_ground { 1.0 } else { 0.5 });
        let (mut lines, mut numbers) = (Vec::new(), Vec::new());
        let splits = &self.session.run().blocks.splits[..self.made.splits];
        for (number, split) in (1..).zip(splits) {
            let rect = &split.rect;
            let (low, high) = match split.axis {
                Axis::X => ([split.plane, rect.min.y], [split.plane, rect.max.y]),
                Axis::Y => ([rect.min.x, split.plane], [rect.max.x, split.plane]),
            };
            let (low, high) = (low.map(radii), high.map(radii));
            if !self.sees(low, high) {
                continue;
            }
            let [from, to] = [low, high].map(|end| self.pixel(end));
            lines.push(Shape::line(
                from,
                to,
                Stroke::new(ink, f64::from(tree::width(split))),
            ));
            let text = number.to_string();
            let width = text_width(&text, Font::Mono, 11.5) + 10.0;
            let length = (to[0] - from[0]).hypot(to[1] - from[1]);
            let enough = tree::MIN_LENGTHS[usize::from(!is_ground)];
            if length >= f64::from(enough) * width {
                let middle = [0, 1].map(|k| f64::midpoint(from[k], to[k]));
                numbers.extend(self.pill(middle, width, text));
            }
        }
        self.add("KD-tree", self.frame, lines);
        self.add("split numbers", self.frame, numbers);
    }

    /// Returns a number in a frame about its middle.
    fn pill(&self, middle: [f64; 2], width: f64, text: String) -> [Shape; 2] {
        let half = [width / 2.0, 9.0];
        let corner = |sign: f64| [0, 1].map(|k| middle[k] + sign * half[k]);
        let ink = color(self.palette.text, 1.0);
        let ground = Shape::Rect {
            rect: Rect::new(corner(-1.0), corner(1.0)),
            style: Style::filled(color(self.palette.panel, 1.0)).with_stroke(Stroke::new(ink, 1.0)),
        };
        let mut text = Text::new(middle, text, 11.5, ink);
        (text.font, text.anchor, text.baseline) = (Font::Mono, Anchor::Middle, Baseline::Middle);
        [ground, Shape::Text(text)]
    }

    /// Each block enlarged by r.
    fn clips(&mut self) {
        let leaves = &self.session.run().blocks.leaves[..self.made.leaves];
        let mut clips = Vec::new();
        for (index, block) in (0..).zip(leaves) {
            if let Some(rect) = self.lattice_rect(&block.rect, 1.0) {
                let stroke = Stroke::new(color(self.palette.block(index), 0.9), 1.0);
                let style = Style {
                    fill: None,
                    stroke: Some(stroke.dashed(6.0, 4.0)),
                };
                clips.push(Shape::Rect { rect, style });
            }
        }
        self.add("clips", self.frame, clips);
    }

    /// Pairs of samples that cover one another, and, while they are eliminated, what yielded to what.
    fn conflicts(&mut self) {
        let (session, shown) = (self.session, self.shown);
        let both = |ids: &&[u32; 2]| ids.iter().all(|&id| shown.covers(id));
        let open = || session.conflicts.iter().filter(both).copied();
        let yielded = || {
            let ids = 0..session.run().samples.len() as u32;
            ids.filter_map(|id| match shown.standing(id) {
                Standing::Eliminated { by } => Some([id, by]),
                _ => None,
            })
        };
        let [open, yielded]: [Vec<[u32; 2]>; 2] = match shown.stage {
            Stage::Tile => [open().collect(), Vec::new()],
            Stage::Eliminate if shown.ends_stage() => [Vec::new(), yielded().collect()],
            Stage::Eliminate => [open().collect(), yielded().collect()],
            _ => Default::default(),
        };
        let mut shapes = Vec::new();
        for (pairs, opacity) in [(open, 0.85), (yielded, 0.6)] {
            let ends = pairs.into_iter().map(|[a, b]| {
                let from = session.place(a);
                [from, session.image_near(b, from)]
            });
            let segments = self.lines(ends, &[[0.0; 2]]);
            if !segments.is_empty() {
                let stroke = Stroke::new(color(self.palette.conflict, opacity), 1.4);
                let stroke = stroke.dashed(6.0, 4.0);
                shapes.push(Shape::Segments { segments, stroke });
            }
        }
        self.add("conflicts", self.frame, shapes);
    }

    /// Returns the copies in view of lines, given in r, in pixels.
    fn lines(
        &self,
        lines: impl Iterator<Item = [[f64; 2]; 2]>,
        shifts: &[[f64; 2]],
    ) -> Vec<[[f64; 2]; 2]> {
        let copies = lines.flat_map(|ends| {
            let moved =
                move |shift: &[f64; 2]| ends.map(|end| [end[0] + shift[0], end[1] + shift[1]]);
            shifts.iter().map(moved)
        });
        let seen = copies.filter(|&[a, b]| {
            let corner = |pick: fn(f64, f64) -> f64| [0, 1].map(|k| pick(a[k], b[k]));
            self.sees(corner(f64::min), corner(f64::max))
        });
        seen.map(|ends| ends.map(|end| self.pixel(end))).collect()
    }

    /// Returns the shifts by whole periods that may bring what reaches over a border into the domain.
    fn shifts(&self) -> Vec<[f64; 2]> {
        let size = self.session.size_radii();
        let steps: &[f64] = if self.is_periodic() {
            &[0.0, -1.0, 1.0]
        } else {
            &[0.0]
        };
        let shift = |&up: &f64| {
            steps
                .iter()
                .map(move |right| [right * size[0], up * size[1]])
        };
        steps.iter().flat_map(shift).collect()
    }

    /// The layers that follow from the triangulation of the moment, where there is one.
    fn triangulation(&mut self) {
        let session = self.session;
        if self.shown.stage < Stage::Tile || session.run().samples.len() > MOST_SAMPLES {
            return;
        }
        let covering = self.shown.covering();
        let points: Vec<[f64; 2]> = covering.iter().map(|&(_, id)| session.place(id)).collect();
        let Ok(tessellation) = Tessellation::of(&points, region_of(session), 1.0) else {
            return;
        };
        let shifts = self.shifts();
        if self.view.layers.has(Layer::Delaunay) {
            self.delaunay(&tessellation, &shifts);
        }
        if self.view.layers.has(Layer::Voronoi) {
            let stroke = Stroke::new(color(self.palette.detector, 0.7), 1.0);
            let edges = tessellation.voronoi_edges.iter().copied();
            let edges = self.lines(edges, &shifts);
            self.segments("Voronoi", self.inside, edges, stroke);
        }
        if self.view.layers.has(Layer::Circumcircles) {
            self.circumcircles(&tessellation, &shifts);
        }
    }

    fn delaunay(&mut self, tessellation: &Tessellation, shifts: &[[f64; 2]]) {
        let periodic = self.is_periodic();
        let edges = tessellation.triangles.iter().flat_map(|triangle| {
            let (sites, corners) = (triangle.sites, triangle.corners);
            let around = [(0, 1), (1, 2), (2, 0)].into_iter();
            // Two triangles run along an edge in opposite ways; only at a closed border there is but one.
            around
                .filter(move |&(from, to)| !periodic || sites[from] < sites[to])
                .map(move |(from, to)| [corners[from], corners[to]])
        });
        let stroke = Stroke::new(color(self.palette.sample, 0.45), 1.0);
        let edges = self.lines(edges, shifts);
        self.segments("Delaunay", self.inside, edges, stroke);
    }

    fn circumcircles(&mut self, tessellation: &Tessellation, shifts: &[[f64; 2]]) {
        let mut circles = Vec::new();
        let style = Style::stroked(color(self.palette.conflict, 1.0), 1.4);
        let wide = tessellation.triangles.iter();
        for triangle in wide.filter(|triangle| triangle.circumradius > 1.0 + HAIR) {
            let reach = triangle.circumradius;
            let pixels = reach * self.view.camera.scale;
            for shift in shifts.iter().filter(|_| pixels < LARGEST_CIRCLE) {
                let center = [0, 1].map(|k| triangle.center[k] + shift[k]);
                let corner = |sign: f64| center.map(|value| value + sign * reach);
                if self.sees(corner(-1.0), corner(1.0)) {
                    circles.push(Shape::circle(self.pixel(center), pixels, style));
                }
            }
        }
        self.add("circumcircles", self.inside, circles);
    }
}
