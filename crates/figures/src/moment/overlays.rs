//! What a step looks at and changes: the current sample, its search, the place under test, the conflict.
//! Places are drawn next to the sample they belong to, across seams.

use tilescope_core::stages::detect::Sites;
use tilescope_core::{Moment, Stage, Verdict};
use tilescope_debugger::{Examined, Search};

use super::MomentView;
use crate::palette::{Color, with_alpha};
use crate::scene::{Fill, Marker, Shape, Stroke, Style};
use crate::stages::unit;

/// Circles larger than this are lines on any screen, and larger than exporters accept at some scale.
const LARGEST_CIRCLE_PX: f64 = 20_000.0;

impl MomentView<'_> {
    pub(super) fn overlays(&mut self) {
        let layers = self.options.layers;
        let context = *self.state.context();
        if layers.detectors {
            self.detectors(context.phase);
        }
        if let (true, Some(search)) = (layers.search, context.search) {
            self.search(&search);
        }
        if layers.test {
            if let Some(examined) = context.examined {
                self.examined(&examined);
            } else if let Some((point, verdict)) = context.dart {
                let place = self.recording.domain().user_from_lattice(point);
                self.verdict(self.nearest_copy(place), verdict);
            }
            self.conflict();
        }
        if layers.current {
            if let Some(sample) = context.sample {
                self.halo("current", sample, self.options.palette.current, 3.2, 3.0);
            }
            if let Some(sample) = self.changed() {
                self.halo("changed", sample, self.options.palette.accent, 4.4, 2.0);
            }
        }
    }

    /// The copy of a place that is nearest to the middle of the picture.
    fn nearest_copy(&self, place: [f64; 2]) -> [f64; 2] {
        if !self.canvas.periodic {
            return place;
        }
        [0, 1].map(|k| {
            let period = self.canvas.size[k];
            let off = place[k] - self.options.center[k];
            place[k] - period * (off / period).round()
        })
    }

    /// A sample next to another one that is drawn at `at`.
    fn beside(&self, at: [f64; 2], from: u32, to: u32) -> Option<[f64; 2]> {
        let domain = self.recording.domain();
        let (dx, dy) = domain.difference(self.recording.point(from)?, self.recording.point(to)?);
        let [ux, uy] = unit(domain);
        Some([at[0] + f64::from(dx) * ux, at[1] + f64::from(dy) * uy])
    }

    /// Where a sample is drawn around which a step looks: without copies so that the place under test lies in the domain.
    fn looked_from(&self, sample: u32) -> Option<[f64; 2]> {
        let at = self.shown(sample)?;
        let domain = self.recording.domain();
        let examined = self.state.context().examined;
        let Some(examined) = examined.filter(|_| !self.options.copies && domain.is_periodic())
        else {
            return Some(at);
        };
        let detector = self.place(examined.detector)?;
        let user = unit(domain);
        Some([0, 1].map(|k| {
            let period = self.canvas.size[k];
            let offset = f64::from(examined.offset[k]) * user[k];
            // An offset that was clamped says nothing about the place.
            let is_near = offset.abs() < period;
            let steps = ((detector[k] + offset) / period).floor();
            at[k] - if is_near { steps * period } else { 0.0 }
        }))
    }

    fn shown(&self, sample: u32) -> Option<[f64; 2]> {
        self.place(sample).map(|place| self.nearest_copy(place))
    }

    fn ring(&self, at: [f64; 2], dots: f64, color: Color, width: f64) -> Shape {
        let style = Style::stroked(color, width * self.px());
        Shape::marker(
            Marker::Dot,
            self.canvas.flip(at),
            dots * self.canvas.dot_px(),
            style,
        )
    }

    fn detectors(&mut self, phase: Option<Stage>) {
        let before = |event: u32| (event as usize) < self.state.cursor();
        let run = self.recording.run();
        let detectors: Vec<u32> = match phase {
            Some(Stage::Iterate(k)) => (run.iterations.get((k as usize).wrapping_sub(1)))
                .map(|iteration| iteration.detectors.clone())
                .unwrap_or_default(),
            Some(Stage::Eliminate) => (0..)
                .zip(self.state.statuses())
                .filter(|(_, status)| status.is_valid())
                .map(|(sample, _)| sample)
                .filter(|&id| {
                    self.recording
                        .life(id)
                        .is_some_and(|life| before(life.marked))
                })
                .collect(),
            _ => Vec::new(),
        };
        let mut group = self.canvas.group("detectors");
        for place in detectors.into_iter().filter_map(|id| self.place(id)) {
            for image in self.canvas.images(place) {
                group
                    .shapes
                    .push(self.ring(image, 2.0, self.options.palette.detector, 1.8));
            }
        }
        self.canvas.push([group]);
    }

    fn search(&mut self, search: &Search) {
        let Some(at) = self.looked_from(search.centre) else {
            return;
        };
        let palette = self.options.palette;
        let radius = f64::from(search.radius) * unit(self.recording.domain())[0];
        let mut group = self.canvas.group("search");
        let edge =
            Stroke::new(palette.accent, 2.0 * self.px()).dashed(8.0 * self.px(), 5.0 * self.px());
        let style = Style::filled(with_alpha(palette.accent, 20)).with_stroke(edge);
        group
            .shapes
            .push(Shape::circle(self.canvas.flip(at), radius, style));
        let found = self.recording.test_buffer(search);
        // Squares, so that they are told from the rings of detectors.
        let (size, style) = (
            2.5 * self.canvas.dot_px(),
            Style::stroked(palette.accent, 1.6 * self.px()),
        );
        let places = found
            .iter()
            .filter_map(|&id| self.beside(at, search.centre, id));
        for place in places.map(|place| self.canvas.flip(place)) {
            group
                .shapes
                .push(Shape::marker(Marker::Square, place, size, style));
        }
        self.canvas.push([group]);
    }

    fn examined(&mut self, examined: &Examined) {
        let Some(at) = self.looked_from(examined.detector) else {
            return;
        };
        let user = unit(self.recording.domain());
        let offset = [0, 1].map(|k| f64::from(examined.offset[k]) * user[k]);
        let center = [at[0] + offset[0], at[1] + offset[1]];
        let radius = offset[0].hypot(offset[1]);
        let color = self.color(examined.verdict);
        let mut group = self.canvas.group("circle under test");
        if radius / self.canvas.radius * self.canvas.radius_px() < LARGEST_CIRCLE_PX {
            let style = Style {
                fill: Some(Fill::Solid(with_alpha(color, 18))),
                stroke: Some(Stroke::new(color, 2.0 * self.px())),
            };
            group
                .shapes
                .push(Shape::circle(self.canvas.flip(center), radius, style));
        }
        let ids: &[u32] = match &examined.sites {
            Sites::Three(ids) => ids,
            Sites::Border(ids) => ids,
            Sites::Corner(id) => std::slice::from_ref(id),
            Sites::Dart | Sites::Unrecorded => &[],
        };
        let places = ids
            .iter()
            .filter_map(|&id| self.beside(at, examined.detector, id));
        let points: Vec<[f64; 2]> = places.map(|place| self.canvas.flip(place)).collect();
        if points.len() > 1 {
            let style = Style::stroked(with_alpha(color, 190), 1.5 * self.px());
            group.shapes.push(Shape::Polygon { points, style });
        }
        if let Verdict::Covered { by } | Verdict::NotNearest { nearer: by } = examined.verdict
            && let Some(place) = self.beside(at, examined.detector, by)
        {
            let stroke =
                Stroke::new(color, 2.0 * self.px()).dashed(5.0 * self.px(), 4.0 * self.px());
            group.shapes.push(Shape::line(
                self.canvas.flip(center),
                self.canvas.flip(place),
                stroke,
            ));
        }
        self.canvas.push([group]);
        self.verdict(center, examined.verdict);
    }

    /// The colour of an accepted or of a rejected place.
    fn color(&self, verdict: Verdict) -> Color {
        match verdict {
            Verdict::Accepted => self.options.palette.inserted,
            _ => self.options.palette.conflict,
        }
    }

    /// The mark of a place under test: a candidate where it is accepted, a cross otherwise.
    fn verdict(&mut self, at: [f64; 2], verdict: Verdict) {
        let marker = match verdict {
            Verdict::Accepted => Marker::Triangle,
            _ => Marker::Cross,
        };
        let edge = Stroke::new(self.options.palette.background, self.px());
        let style = Style::filled(self.color(verdict)).with_stroke(edge);
        let size = (2.2 * self.canvas.dot_px()).max(8.0 * self.px());
        let mut group = self.canvas.group("place under test");
        group
            .shapes
            .push(Shape::marker(marker, self.canvas.flip(at), size, style));
        self.canvas.push([group]);
    }

    /// The edge between the two samples that the step compares.
    fn conflict(&mut self) {
        let palette = self.options.palette;
        let (one, other, covers) = match self.moment() {
            Some(Moment::Test {
                pivot,
                other,
                covers,
            }) => (pivot, other, covers),
            Some(Moment::Eliminate { sample, by }) => (by, sample, true),
            _ => return,
        };
        let Some(from) = self.shown(one) else {
            return;
        };
        let Some(to) = self.beside(from, one, other) else {
            return;
        };
        let color = if covers {
            palette.conflict
        } else {
            palette.muted
        };
        let stroke = Stroke::new(color, 3.0 * self.px()).dashed(7.0 * self.px(), 4.0 * self.px());
        let mut group = self.canvas.group("conflict");
        group.shapes.push(Shape::line(
            self.canvas.flip(from),
            self.canvas.flip(to),
            stroke,
        ));
        group.shapes.push(self.ring(to, 2.2, color, 2.0));
        self.canvas.push([group]);
    }

    /// The sample that the step changed.
    fn changed(&self) -> Option<u32> {
        match self.moment()? {
            Moment::Tiled {
                sample,
                inside: true,
                ..
            }
            | Moment::Keep { sample, .. }
            | Moment::Eliminate { sample, .. }
            | Moment::Mark { sample, .. }
            | Moment::Insert { sample, .. } => Some(sample),
            _ => None,
        }
    }

    fn halo(&mut self, name: &str, sample: u32, color: Color, dots: f64, width: f64) {
        if let Some(at) = self.shown(sample) {
            let mut group = self.canvas.group(name);
            group
                .shapes
                .push(self.ring(at, dots, with_alpha(color, 235), width));
            self.canvas.push([group]);
        }
    }
}
