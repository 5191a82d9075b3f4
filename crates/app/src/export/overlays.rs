//! The layers of the canvas that a figure of a moment lacks: clips, conflicts, candidates, and the triangulation.
//! They lie below the samples, as on the canvas.

use tilescope_analysis::Tessellation;
use tilescope_core::{Point, Stage};
use tilescope_figures::{
    Fill, Group, Marker, MomentOptions, Palette, Rect, Scene, Shape, Stroke, Style, with_alpha,
};

use super::picture::View;
use super::still::Still;
use crate::canvas::layers::Layer;
use crate::canvas::seams;
use crate::geometry::{MOST_SAMPLES, region_of};
use crate::session::{Session, radii};

/// The layers that are drawn here.
pub const LAYERS: [Layer; 6] = [
    Layer::Pattern,
    Layer::Conflicts,
    Layer::Candidates,
    Layer::Delaunay,
    Layer::Voronoi,
    Layer::Circumcircles,
];

/// Circles of a larger radius, in pixels, are hardly curved where they can be seen.
const LARGEST_CIRCLE: f64 = 10_000.0;
/// By how much a radius may exceed r from rounding alone.
const HAIR: f64 = 1e-6;

/// Adds the layers that are on.
pub fn add(
    scene: &mut Scene,
    session: &Session,
    moment: &Still,
    view: &View,
    options: &MomentOptions,
) {
    let overlays = Overlays::new(session, moment, view, options);
    let has = |layer| view.layers.has(layer);
    let mut groups = Vec::new();
    if has(Layer::Delaunay) || has(Layer::Voronoi) || has(Layer::Circumcircles) {
        groups.extend(overlays.triangulation());
    }
    if has(Layer::Pattern) && moment.stage > Stage::Pattern {
        groups.push(overlays.clips());
    }
    if has(Layer::Conflicts) {
        groups.push(overlays.conflicts());
    }
    if has(Layer::Candidates) {
        groups.push(overlays.candidates());
    }
    groups.retain(|group| !group.shapes.is_empty());
    let below = |group: &Group| {
        ["eliminated", "undecided", "kept", "inserted", "event"].contains(&group.name.as_str())
    };
    let place = scene.groups.iter().position(below);
    let place = place.unwrap_or(scene.groups.len());
    scene.groups.splice(place..place, groups);
}

/// Adds the seams of a combination and their band to the picture of a stage, if they are shown.
pub fn add_seams(
    scene: &mut Scene,
    session: &Session,
    stage: Stage,
    view: &View,
    options: &MomentOptions,
) {
    if !view.layers.has(Layer::Seams) || session.combination.is_none() {
        return;
    }
    let moment = Still {
        cursor: None,
        stage,
    };
    let overlays = Overlays::new(session, &moment, view, options);
    let groups = overlays.seams();
    let below =
        |group: &Group| ["eliminated", "samples", "inserted"].contains(&group.name.as_str());
    let place = scene.groups.iter().position(below);
    let place = place.unwrap_or(scene.groups.len());
    scene.groups.splice(place..place, groups);
}

struct Overlays<'a> {
    session: &'a Session,
    moment: &'a Still,
    view: &'a View,
    palette: Palette,
    /// Where the plane is seen, in pixels.
    frame: Rect,
    /// How far one sees from the middle, in r.
    half: [f64; 2],
    center: [f64; 2],
}

impl<'a> Overlays<'a> {
    fn new(
        session: &'a Session,
        moment: &'a Still,
        view: &'a View,
        options: &MomentOptions,
    ) -> Self {
        let frame = options.frame();
        Self {
            session,
            moment,
            view,
            palette: options.palette,
            frame,
            half: [0, 1].map(|k| (frame.max[k] - frame.min[k]) / view.camera.scale / 2.0),
            center: view.camera.center,
        }
    }

    /// The seams of a combination, and below them what gluing can have touched.
    fn seams(&self) -> Vec<Group> {
        let Some(combination) = &self.session.combination else {
            return Vec::new();
        };
        let palette = if self.view.dark {
            &crate::theme::DARK
        } else {
            &crate::theme::LIGHT
        };
        let accent = palette.accent.to_array();
        let mut band = self.group("band");
        for rect in &combination.band {
            let corner = |point: Point| [radii(point.x), radii(point.y)];
            let (low, high) = (corner(rect.min), corner(rect.max));
            if self.sees(low, high) {
                let [left, bottom] = self.pixel(low);
                let [right, top] = self.pixel(high);
                band.shapes.push(Shape::Rect {
                    rect: Rect::new([left, top], [right, bottom]),
                    style: Style {
                        fill: Some(Fill::Solid(with_alpha(accent, 26))),
                        stroke: None,
                    },
                });
            }
        }
        let mut lines = self.group("seams");
        let segments: Vec<_> = seams::ends(self.session)
            .into_iter()
            .map(|ends| ends.map(|end| self.pixel(end)))
            .collect();
        if !segments.is_empty() {
            let stroke = Stroke::new(accent, 1.6);
            lines.shapes.push(Shape::Segments { segments, stroke });
        }
        let mut groups = vec![band, lines];
        groups.retain(|group| !group.shapes.is_empty());
        groups
    }

    fn group(&self, name: &str) -> Group {
        Group {
            clip: Some(self.frame),
            ..Group::new(name)
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

    /// Returns whether something between two corners, in r, is in view.
    fn sees(&self, low: [f64; 2], high: [f64; 2]) -> bool {
        let half = self.half;
        (0..2).all(|k| low[k] <= self.center[k] + half[k] && self.center[k] - half[k] <= high[k])
    }

    /// Returns the shifts by whole periods that may bring something near the domain into view.
    fn shifts(&self) -> Vec<[f64; 2]> {
        let size = self.session.size_radii();
        let steps: &[f64] = if self.session.run().domain.is_periodic() {
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

    /// Returns the copies in view of lines, given in r, in pixels.
    fn lines(&self, lines: impl Iterator<Item = [[f64; 2]; 2]>) -> Vec<[[f64; 2]; 2]> {
        let shifts = self.shifts();
        let copies = lines.flat_map(|ends| {
            let moved = |shift: &[f64; 2]| ends.map(|end| [end[0] + shift[0], end[1] + shift[1]]);
            shifts.iter().map(moved).collect::<Vec<_>>()
        });
        let seen = copies.filter(|&[a, b]| {
            let corner = |pick: fn(f64, f64) -> f64| [0, 1].map(|k| pick(a[k], b[k]));
            self.sees(corner(f64::min), corner(f64::max))
        });
        seen.map(|ends| ends.map(|end| self.pixel(end))).collect()
    }

    fn segments(
        &self,
        name: &str,
        lines: impl Iterator<Item = [[f64; 2]; 2]>,
        stroke: Stroke,
    ) -> Group {
        let mut group = self.group(name);
        let segments = self.lines(lines);
        if !segments.is_empty() {
            group.shapes.push(Shape::Segments { segments, stroke });
        }
        group
    }

    /// Each block enlarged by r.
    fn clips(&self) -> Group {
        let mut group = self.group("clips");
        for (index, block) in self.session.run().blocks.leaves.iter().enumerate() {
            let corner = |point: Point, by: f64| [radii(point.x) + by, radii(point.y) + by];
            let (low, high) = (corner(block.rect.min, -1.0), corner(block.rect.max, 1.0));
            if self.sees(low, high) {
                let [left, bottom] = self.pixel(low);
                let [right, top] = self.pixel(high);
                let stroke = Stroke::new(self.palette.block(index).1, 1.0).dashed(6.0, 4.0);
                let style = Style {
                    fill: None,
                    stroke: Some(stroke),
                };
                let rect = Rect::new([left, top], [right, bottom]);
                group.shapes.push(Shape::Rect { rect, style });
            }
        }
        group
    }

    /// Pairs of samples that cover one another, and, while they are eliminated, what yielded to what.
    fn conflicts(&self) -> Group {
        let (session, moment) = (self.session, self.moment);
        let pair = |[a, b]: [u32; 2]| {
            let from = session.place(a);
            [from, session.image_near(b, from)]
        };
        let stroke = Stroke::new(self.palette.conflict, 1.4).dashed(6.0, 4.0);
        let both = |ids: &&[u32; 2]| ids.iter().all(|&id| moment.covers(session, id));
        let open = session.conflicts.iter().filter(both).copied();
        let ids = 0..session.run().samples.len() as u32;
        let yielded = ids.filter_map(|id| Some([id, moment.yielded_to(session, id)?]));
        let pairs: Vec<[u32; 2]> = match moment.stage {
            Stage::Tile => open.collect(),
            Stage::Eliminate if moment.ends_stage(session) => yielded.collect(),
            Stage::Eliminate => yielded.chain(open).collect(),
            _ => Vec::new(),
        };
        self.segments("conflicts", pairs.into_iter().map(pair), stroke)
    }

    /// The candidates of the iteration that have been found by now.
    fn candidates(&self) -> Group {
        let mut group = self.group("candidates");
        let Stage::Iterate(number) = self.moment.stage else {
            return group;
        };
        let run = self.session.run();
        let Some(iteration) = run.iterations.get((number as usize).wrapping_sub(1)) else {
            return group;
        };
        let recording = self.session.recording().zip(self.moment.cursor);
        let recording = recording.filter(|_| !self.moment.ends_stage(self.session));
        let size = (0.72 * self.view.camera.scale).clamp(7.0, 20.0);
        let style = Style::stroked(self.palette.candidate, 1.4);
        for candidate in &iteration.candidates {
            let found = recording
                .is_none_or(|(recording, cursor)| recording.gap(candidate.sites, cursor).is_some());
            let place = [radii(candidate.point.x), radii(candidate.point.y)];
            if found && self.sees(place, place) {
                let at = self.pixel(place);
                group
                    .shapes
                    .push(Shape::marker(Marker::Triangle, at, size, style));
            }
        }
        group
    }

    /// The layers that follow from the triangulation of the moment, where there is one.
    fn triangulation(&self) -> Vec<Group> {
        let session = self.session;
        if self.moment.stage < Stage::Tile || session.run().samples.len() > MOST_SAMPLES {
            return Vec::new();
        }
        let ids = self.moment.samples(session);
        let points: Vec<[f64; 2]> = ids.iter().map(|&id| session.place(id)).collect();
        let Ok(tessellation) = Tessellation::of(&points, region_of(session), 1.0) else {
            return Vec::new();
        };
        let mut groups = Vec::new();
        if self.view.layers.has(Layer::Delaunay) {
            groups.push(self.delaunay(&tessellation));
        }
        if self.view.layers.has(Layer::Voronoi) {
            let stroke = Stroke::new(with_alpha(self.palette.detector, 180), 1.0);
            let edges = tessellation.voronoi_edges.iter().copied();
            groups.push(self.segments("Voronoi", edges, stroke));
        }
        if self.view.layers.has(Layer::Circumcircles) {
            groups.push(self.circumcircles(&tessellation));
        }
        groups
    }

    fn delaunay(&self, tessellation: &Tessellation) -> Group {
        let periodic = self.session.run().domain.is_periodic();
        let edges = tessellation.triangles.iter().flat_map(|triangle| {
            let (sites, corners) = (triangle.sites, triangle.corners);
            let around = [(0, 1), (1, 2), (2, 0)].into_iter();
            // Two triangles run along an edge in opposite ways; only at a closed border there is but one.
            around
                .filter(move |&(from, to)| !periodic || sites[from] < sites[to])
                .map(move |(from, to)| [corners[from], corners[to]])
        });
        let stroke = Stroke::new(with_alpha(self.palette.sample, 115), 1.0);
        self.segments("Delaunay", edges, stroke)
    }

    fn circumcircles(&self, tessellation: &Tessellation) -> Group {
        let mut group = self.group("circumcircles");
        let style = Style::stroked(self.palette.conflict, 1.4);
        let shifts = self.shifts();
        let wide = tessellation.triangles.iter();
        for triangle in wide.filter(|triangle| triangle.circumradius > 1.0 + HAIR) {
            let reach = triangle.circumradius;
            let pixels = reach * self.view.camera.scale;
            for shift in shifts.iter().filter(|_| pixels < LARGEST_CIRCLE) {
                let center = [0, 1].map(|k| triangle.center[k] + shift[k]);
                let corner = |sign: f64| center.map(|value| value + sign * reach);
                if self.sees(corner(-1.0), corner(1.0)) {
                    let at = self.pixel(center);
                    group.shapes.push(Shape::circle(at, pixels, style));
                }
            }
        }
        group
    }
}
