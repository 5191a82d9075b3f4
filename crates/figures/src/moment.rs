//! A picture of one moment of a recorded run: how every sample stands, and what the step at the cursor tests
//! and changes. It reads a recording and never runs or changes one.

mod overlays;

use tilescope_core::{Boundary, Moment, Origin, Stage};
use tilescope_debugger::{Kind, Listings, Recording, State, Status};

use crate::canvas::{CAPTION, Canvas, MARGIN, PictureOptions};
use crate::fonts::{Font, text_width};
use crate::palette::{Palette, with_alpha};
use crate::scene::{Anchor, Group, Marker, Rect, Scene, Shape, Style, Text};

/// What a picture of a moment shows besides samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(
    clippy::struct_excessive_bools,
    reason = "each is a layer that is on or off"
)]
pub struct Layers {
    /// Building blocks.
    pub blocks: bool,
    /// Samples.
    pub samples: bool,
    /// Rings of the disks of valid samples.
    pub disks: bool,
    /// What no valid sample covers, from elimination on.
    pub gaps: bool,
    /// Eliminated samples.
    pub eliminated: bool,
    /// Gap detectors.
    pub detectors: bool,
    /// The search disk and its test buffer.
    pub search: bool,
    /// The place under test with its circle and its verdict, and the conflict.
    pub test: bool,
    /// The current sample and what the step changed.
    pub current: bool,
}

impl Layers {
    /// The domain alone.
    pub const NONE: Self = Self {
        blocks: false,
        samples: false,
        disks: false,
        gaps: false,
        eliminated: false,
        detectors: false,
        search: false,
        test: false,
        current: false,
    };

    /// Everything.
    pub const ALL: Self = Self {
        blocks: true,
        samples: true,
        disks: true,
        gaps: true,
        eliminated: true,
        detectors: true,
        search: true,
        test: true,
        current: true,
    };
}

/// How a moment is pictured.
#[derive(Clone, Debug, PartialEq)]
pub struct MomentOptions {
    /// The place in the middle, in user units.
    pub center: [f64; 2],
    /// Pixels of one radius.
    pub scale: f64,
    /// Width and height of the picture in pixels.
    pub size: [f64; 2],
    /// Colours: [`Palette::LIGHT`] or [`Palette::DARK`].
    pub palette: Palette,
    /// What is shown.
    pub layers: Layers,
    /// Whether copies of a periodic domain are drawn around it. Without them what a step looks at lies where the place
    /// under test is in the domain.
    pub copies: bool,
}

impl MomentOptions {
    /// Returns the options that show `radii` radii across around the place of the event at `cursor - 1`, or
    /// around the middle of the domain where that event has none.
    #[must_use]
    pub fn around(recording: &Recording, cursor: usize, radii: f64) -> Self {
        let domain = recording.domain();
        let event = cursor.checked_sub(1).and_then(|last| recording.event(last));
        let place = event.and_then(|event| recording.place(event));
        let [width, height] = domain.size();
        let center = place.map_or([width / 2.0, height / 2.0], |p| domain.user_from_lattice(p));
        let size = [1000.0, 1000.0];
        Self {
            center,
            scale: (size[0] - 2.0 * MARGIN) / radii,
            size,
            palette: Palette::LIGHT,
            layers: Layers::ALL,
            copies: true,
        }
    }

    /// Returns the options that show `frame` pixels of the plane, width and height, around `center` (user units) with
    /// `scale` pixels for a radius; margins and caption are added around them.
    #[must_use]
    pub fn framing(center: [f64; 2], scale: f64, frame: [f64; 2]) -> Self {
        let width = frame[0] / (1.0 - 2.0 * MARGIN / 1000.0);
        let height = frame[1] + (2.0 * MARGIN + CAPTION) * width / 1000.0;
        Self {
            center,
            scale,
            size: [width, height],
            palette: Palette::LIGHT,
            layers: Layers::ALL,
            copies: true,
        }
    }

    fn is_drawable(&self) -> bool {
        let positive = |value: f64| value.is_finite() && value > 0.0;
        let lengths = [self.scale, self.size[0], self.size[1]];
        lengths.into_iter().all(positive) && self.center.iter().all(|value| value.is_finite())
    }

    /// Returns the part of the picture, in its pixels, in which the plane is seen.
    #[must_use]
    pub fn frame(&self) -> Rect {
        let px = self.size[0] / 1000.0;
        let min = [MARGIN * px, (MARGIN + CAPTION) * px];
        let max = [0, 1].map(|k| (self.size[k] - MARGIN * px).max(min[k] + 1.0));
        Rect::new(min, max)
    }

    /// Returns the part of the plane that is seen, in user units, for samples of `radius`.
    #[must_use]
    pub fn window(&self, radius: f64) -> Rect {
        let frame = self.frame();
        let half = [0, 1].map(|k| (frame.max[k] - frame.min[k]) / self.scale * radius / 2.0);
        let end = |sign: f64| [0, 1].map(|k| self.center[k] + sign * half[k]);
        Rect::new(end(-1.0), end(1.0))
    }
}

/// Returns the picture of a recording when the events before `cursor` have happened.
///
/// Rings and halos mark what the last of them concerns and changes; the caption has its line of pseudocode. In a
/// periodic domain copies are drawn up to one period beyond the domain, unless the options leave them out. Options that are not finite or not
/// above 0 give a scene that no exporter accepts.
#[must_use]
pub fn moment_scene(recording: &Recording, cursor: usize, options: &MomentOptions) -> Scene {
    if !options.is_drawable() {
        return Scene::new(0.0, 0.0, options.palette.background);
    }
    let state = State::at(recording, cursor);
    let domain = recording.domain();
    let picture = PictureOptions {
        width: options.size[0],
        palette: options.palette,
        window: Some(options.window(domain.radius())),
        disks: options.layers.disks,
    };
    let boundary = if options.copies {
        domain.boundary()
    } else {
        Boundary::Bounded
    };
    let canvas = Canvas::new(domain.size(), boundary, domain.radius(), &picture);
    let mut view = MomentView {
        recording,
        state: &state,
        options,
        canvas,
    };
    view.ground();
    if options.layers.samples {
        view.samples();
    }
    view.overlays();
    view.finish()
}

/// A moment on its canvas.
struct MomentView<'a> {
    recording: &'a Recording,
    state: &'a State,
    options: &'a MomentOptions,
    canvas: Canvas<'a>,
}

impl MomentView<'_> {
    /// The last event.
    fn moment(&self) -> Option<Moment> {
        let last = self.state.cursor().checked_sub(1)?;
        self.recording.event(last)?.moment()
    }

    fn place(&self, sample: u32) -> Option<[f64; 2]> {
        let point = self.recording.point(sample)?;
        Some(self.recording.domain().user_from_lattice(point))
    }

    /// Blocks, gaps and disks.
    fn ground(&mut self) {
        let layers = self.options.layers;
        let phase = self.state.context().phase;
        let blocks = if layers.blocks {
            self.blocks()
        } else {
            Vec::new()
        };
        let covers = matches!(phase, Some(stage) if stage >= Stage::Eliminate);
        let valid: Vec<[f64; 2]> = (0..)
            .zip(self.state.statuses())
            .filter(|(_, status)| status.is_valid())
            .filter_map(|(sample, _)| self.place(sample))
            .collect();
        if covers && layers.gaps {
            self.canvas.coverage(&valid);
            self.canvas.block_borders(blocks.into_iter());
        } else {
            if covers {
                self.canvas.block_borders(blocks.into_iter());
            } else {
                self.canvas.blocks(blocks.into_iter());
            }
            self.canvas.rings(&valid, None);
        }
        let mut border = self.canvas.group("domain");
        let rect = self.canvas.flip_rect(Rect::new([0.0; 2], self.canvas.size));
        let style = Style::stroked(self.options.palette.muted, 1.5 * self.px());
        border.shapes.push(Shape::Rect { rect, style });
        self.canvas.push([border]);
    }

    /// The blocks that are cut off already.
    fn blocks(&self) -> Vec<Rect> {
        let leaves = &self.recording.run().blocks.leaves;
        let count = match self.state.context().phase {
            None | Some(Stage::Pattern) => 0,
            Some(Stage::Blocks) => {
                let events = self.recording.tape().from(0).take(self.state.cursor());
                events
                    .filter(|(_, event)| event.kind() == Kind::Leaf)
                    .count()
            }
            _ => leaves.len(),
        };
        let user = |p| self.recording.domain().user_from_lattice(p);
        let corners = leaves
            .iter()
            .map(|block| [block.rect.min, block.rect.max].map(user));
        corners
            .take(count)
            .map(|[min, max]| Rect::new(min, max))
            .collect()
    }

    fn px(&self) -> f64 {
        self.options.size[0] / 1000.0
    }

    fn samples(&mut self) {
        let names = ["eliminated", "undecided", "kept", "inserted"];
        let mut groups = names.map(|name| self.canvas.group(name));
        let cross = Style::stroked(
            with_alpha(self.options.palette.eliminated, 210),
            self.canvas.line_px(),
        );
        for (sample, status) in (0..).zip(self.state.statuses()) {
            let Some(place) = self.place(sample) else {
                continue;
            };
            let origin = self.recording.run().samples.origins[sample as usize];
            let (group, marker, style) = match (status, origin) {
                (Status::Absent | Status::Dropped, _) => continue,
                (Status::Eliminated, _) if !self.options.layers.eliminated => continue,
                (Status::Eliminated, _) => (0, Marker::Cross, cross),
                (_, Origin::Inserted { .. }) => (3, Marker::Diamond, self.canvas.inserted()),
                (Status::Undecided, Origin::Tiled { block, .. }) => {
                    (1, Marker::Dot, self.canvas.dot(Some(block)))
                }
                (Status::Kept, Origin::Tiled { .. }) => (2, Marker::Dot, self.canvas.dot(None)),
            };
            self.canvas.mark(&mut groups[group], marker, place, style);
        }
        self.canvas.push(groups);
    }

    fn finish(mut self) -> Scene {
        let cursor = self.state.cursor();
        let count = format!("event {cursor} of {}", self.recording.len());
        let px = self.px();
        let size = 20.0 * px;
        let frame = self.canvas.frame;
        let mut right = Text::new(
            [frame.max[0], frame.min[1] - 16.0 * px],
            count.clone(),
            size,
            self.options.palette.muted,
        );
        right.anchor = Anchor::End;
        let room = frame.max[0] - frame.min[0] - text_width(&count, Font::Regular, size) - size;
        let mut group = Group::new("event");
        group.shapes.push(Shape::Text(right));
        self.canvas.push([group]);
        let line = self.line();
        let mut scene = self.canvas.finish(&fitted(&line, room, size));
        scene.title = format!("{line} ({count})");
        scene
    }

    /// The line of pseudocode that the last event executed.
    fn line(&self) -> String {
        let last = self.state.cursor().checked_sub(1);
        let event = last.and_then(|last| self.recording.event(last));
        let line = event.and_then(|event| Listings::shipped().line(event.line()));
        line.map_or_else(
            || "Before the first event".to_owned(),
            |line| line.text(&self.recording.run().parameters),
        )
    }
}

/// Returns a text, cut off behind as many words as there is room for, in pixels, at a size of the regular font.
#[must_use]
pub fn fitted(text: &str, room: f64, size: f64) -> String {
    let mut fitted = text.to_owned();
    while text_width(&fitted, Font::Regular, size) > room {
        let words = fitted.trim_end_matches('\u{2026}').trim_end();
        let Some((start, _)) = words.rsplit_once(' ') else {
            break;
        };
        fitted = format!("{}\u{2026}", start.trim_end());
    }
    fitted
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn captions_are_cut_between_words() {
        let text = "an inserted sample covers the candidate: pass it over";
        assert_eq!(fitted(text, 1e4, 20.0), text);
        let short = fitted(text, 200.0, 20.0);
        assert!(
            short.ends_with('\u{2026}') && text.starts_with(short.trim_end_matches('\u{2026}'))
        );
        assert!(text_width(&short, Font::Regular, 20.0) <= 200.0);
        assert_eq!(fitted("word", 1.0, 20.0), "word");
    }
}
