//! Pictures of a lesson's steps: of the next step for a lecturer's notes, and of all steps for handouts. Begin with
//! `step_at` and [`picture`].

use std::sync::Arc;

use emath::{Pos2, Rect, pos2, vec2};
use glam::DVec2;
use serde::{Deserialize, Serialize};
use tilescope_core::Unobserved;
use tilescope_debugger::Recording;
use tilescope_drawing::camera::Camera;
use tilescope_drawing::labels::{Labelled, places};
use tilescope_drawing::palette::{DARK, LIGHT, Palette};
use tilescope_drawing::picture::{
    MomentView, PictureView, Thumbnail, at as on_picture, color, thumbnail,
};
use tilescope_figures::{Group, Scene, Shape, Stroke, Style, Text, to_pixels, to_svg};
use tilescope_lessons::{Arrival, Learner, Lesson, MarkKind, Translation};
use tilescope_session::jobs::{Job, Monitor};
use tilescope_session::layers::{Colouring, Layer, Layers};
use tilescope_session::moment::Moment;
use tilescope_session::selection::Selection;
use tilescope_session::task::Task;

use crate::lesson_set::LessonSet;
use crate::lessons::{LessonSource, OpenLesson};
use crate::pen::PenStroke;

/// The radius of the circle around a marked place. Chosen, not measured.
const MARK_RADIUS: f32 = 7.0;
/// The size of the em of a mark's label. Chosen, not measured.
const LABEL_SIZE: f32 = 12.0;

/// How a picture of a step is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PictureStyle {
    /// Width and height in points.
    pub size: [f64; 2],
    /// Whether it is light on dark.
    pub dark: bool,
}

/// Returns a lesson's step at its moment, with its question open. `last` has the run of another step, if there is one:
/// it is used again if this step shows the same run. Afterwards `last` has the run of this step, and after an error
/// none.
///
/// # Errors
///
/// A sentence, if the run cannot be made, has no such moment, or the lesson has a fault.
pub(crate) fn step_at(
    lesson: &Arc<Lesson>,
    translation: &Arc<Translation>,
    index: usize,
    last: &mut Option<Arc<Recording>>,
) -> Result<OpenLesson, String> {
    let mut learner = Learner::new(Arc::clone(lesson), Arc::clone(translation));
    learner.go(index);

    let wanted = learner.run();
    // Steps of one lesson often show the same run, which is then made once.
    let run = match last.take() {
        Some(run) if wanted.is_of(&run) => run,
        _ => {
            let made = wanted.make(&mut Unobserved);
            made.map_err(|error| error.to_string())?
        }
    };

    // The time of an arrival is only used in results, which a picture does not have.
    let now = 0.0;
    let arrival = learner.arrive(&run, now);
    if arrival.map_err(|error| error.to_string())? == Arrival::NoMoment {
        let line = learner.step().scene.line;
        return Err(format!("line {line}: the run has no such moment"));
    }

    *last = Some(Arc::clone(&run));
    let mut open = OpenLesson::new(learner, LessonSource::Text);
    open.run = Some(run);
    Ok(open)
}

/// Draws a step at its moment, with the lecturer's strokes over it.
#[must_use]
pub fn picture(open: &OpenLesson, style: PictureStyle, strokes: &[PenStroke]) -> Scene {
    let [width, height] = style.size;
    let frame = Rect::from_min_size(Pos2::ZERO, style.size.map(|side| side as f32).into());
    let palette = if style.dark { &DARK } else { &LIGHT };

    let Some((run, cursor)) = open.shown_run().zip(open.learner.cursor()) else {
        return Scene::new(width, height, color(palette.outside));
    };

    // The session ends at the moment, so that nothing later is drawn. Generations distinguish the sessions of a window;
    // this one serves a single picture.
    let generation = 0;
    let shown = Arc::new(run.until(cursor));
    let session = LessonSet::session(open.shown_set().as_ref(), shown, generation);

    let size = session.size_radii();
    let camera = open.camera().map_or_else(
        || Camera::fitting(size, frame),
        |(center, radii)| Camera {
            center: center.into(),
            // The shorter side is this many r long.
            scale: width.min(height) / radii,
        },
    );

    let view = PictureView {
        camera,
        size: style.size,
        chosen_layers: open.layers().map(|names| layers_named(&names)),
        colouring: Colouring::default(),
        selection: Selection::Nothing,
        dark: style.dark,
        print: false,
        caption: String::new(),
        legend: None,
        analysis: false,
        plane: session.solid.as_ref().and_then(|solid| {
            let place = open.learner.scene()?.plane()?;
            Some(solid.plane_at_radii(place))
        }),
    };

    let moment = Moment::at(&session, cursor);
    let mut scene = thumbnail(&session, &MomentView { moment, view });

    // A periodic domain repeats: a place is drawn at its image nearest to the middle of the picture, `turns` domains away.
    // A bounded one has no other images.
    let is_periodic = session.run().domain.is_periodic();
    let place = |at: DVec2| {
        let turns = ((at - camera.center) / size).round() * f64::from(u8::from(is_periodic));
        on_picture(camera.screen_from_domain(frame, at - turns * size))
    };

    scene.groups.push(marks(open, palette, frame, place));

    let mut drawn = Group::new("pen");
    for stroke in strokes {
        // In points, as the widths of the lines in `marks`; all are chosen, not measured.
        let ink = Stroke::new(color(stroke.color(style.dark)), 3.0);
        let pairs = stroke.points.windows(2);
        let line =
            |ends: &[[f64; 2]]| Shape::line(place(ends[0].into()), place(ends[1].into()), ink);
        drawn.shapes.extend(pairs.map(line));
    }

    scene.groups.push(drawn);
    scene
}

/// Returns the box that is to be cut, if the question has one, and the marks of a step; `place` gives the place in the picture.
fn marks(
    open: &OpenLesson,
    palette: &Palette,
    frame: Rect,
    place: impl Fn(DVec2) -> DVec2,
) -> Group {
    let mut marks = Group::new("marks");

    // Pictures show a question before its answer, so that no line is chosen or right yet.
    if let Some(lines) = open.lines() {
        let [low, high] = lines.outline.map(|corner| place(corner.into()));
        let corners = [low, low.with_x(high.x), high, high.with_x(low.x), low];
        let stroke = Stroke::new(color(palette.accent), 2.0);
        let pairs = corners.windows(2);
        marks
            .shapes
            .extend(pairs.map(|ends| Shape::line(ends[0], ends[1], stroke)));
    }

    let drawn = open.marks();
    // The places of all labels are chosen together, so that no label covers another.
    let labelled: Vec<Labelled> = drawn
        .iter()
        .map(|mark| {
            let at = place(mark.at);
            Labelled {
                at: pos2(at.x as f32, at.y as f32),
                radius: MARK_RADIUS,
                // A letter of this size is about 7 points wide.
                size: vec2(7.0 * mark.label.chars().count() as f32, LABEL_SIZE),
            }
        })
        .collect();

    // Nothing else stands in the picture of which labels would have to keep clear.
    let taken: &[Rect] = &[];
    for (mark, label) in drawn.into_iter().zip(places(&labelled, taken, frame)) {
        let ink = color(match mark.kind {
            MarkKind::Named => palette.halo,
            MarkKind::Listed => palette.accent,
            MarkKind::Chosen => palette.candidate,
            MarkKind::Right => palette.inserted,
        });

        let circle = Shape::circle(place(mark.at), MARK_RADIUS.into(), Style::stroked(ink, 1.6));
        marks.shapes.push(circle);

        if !mark.label.is_empty() {
            // A text is placed by its baseline, which lies a little above the lower side of its box.
            let corner = DVec2::new(label.min.x.into(), f64::from(label.max.y) - 2.0);
            let label = Text::new(corner, mark.label, LABEL_SIZE.into(), ink);
            marks.shapes.push(Shape::Text(label));
        }
    }

    marks
}

/// Returns the layers of these names; unknown names are left out.
pub(crate) fn layers_named(names: &[String]) -> Layers {
    let mut chosen = Layers::none();
    for layer in Layer::ALL {
        if names.contains(&layer.key()) {
            chosen.toggle(layer);
        }
    }
    chosen
}

/// A picture of a step: as text for pages, as pixels for windows.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct StepPicture {
    /// The picture in SVG, if it was asked for.
    pub svg: Option<String>,
    /// Its pixels, if they were asked for.
    pub pixels: Option<Arc<Thumbnail>>,
    /// Why there is no picture, if there is none.
    pub fault: Option<String>,
}

/// The task of drawing a picture of a step with its question open.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StepPictureTask {
    /// The name of the lesson.
    pub name: String,
    /// The content of the lesson's file.
    pub text: String,
    /// The index of the step.
    pub index: usize,
    /// How it is drawn.
    pub style: PictureStyle,
    /// Whether SVG is made instead of pixels.
    pub as_svg: bool,
}

/// Everything that a picture of a step depends on.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PictureKey {
    /// The name of the lesson of the step.
    pub name: String,
    /// The hash of the open lesson, whose file may change while it is presented.
    pub hash: String,
    /// The index of the step.
    pub index: usize,
    pub style: PictureStyle,
}

/// The picture of the step that follows in a talk.
#[derive(Default)]
pub struct NextPicture {
    key: Option<PictureKey>,
    drawing: Option<Job<StepPicture>>,
    drawn: Option<StepPicture>,
}

impl NextPicture {
    /// Returns the picture, once it is drawn.
    #[must_use]
    pub const fn drawn(&self) -> Option<&StepPicture> {
        self.drawn.as_ref()
    }

    /// Takes a finished picture. Returns whether another picture is wanted; if no picture is wanted, drops the old one.
    pub(crate) fn wants(&mut self, wanted: Option<&PictureKey>) -> bool {
        if let Some(outcome) = self.drawing.as_ref().and_then(Job::poll) {
            self.take(outcome);
        }
        if wanted.is_none() {
            *self = Self::default();
        }
        self.key.as_ref() != wanted
    }

    /// Sets the key and the job of the picture that is wanted now.
    pub(crate) fn draw(&mut self, key: Option<PictureKey>, job: Job<StepPicture>) {
        (self.key, self.drawing, self.drawn) = (key, Some(job), None);
    }

    fn take(&mut self, outcome: Result<StepPicture, String>) {
        let drawn = outcome.unwrap_or_else(StepPicture::failed);
        (self.drawing, self.drawn) = (None, Some(drawn));
    }

    /// Waits for the picture that is being drawn.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn settle(&mut self) {
        if let Some(job) = &self.drawing {
            let outcome = job.wait();
            self.take(outcome);
        }
    }
}

/// Pixels in a point of a picture for windows, so that it is sharp on dense screens.
const SHARPNESS: f64 = 2.0;

impl Task for StepPictureTask {
    type Outcome = StepPicture;
    const NAME: &'static str = "picture of a step";

    fn run(self, _: &Monitor) -> StepPicture {
        self.drawn().unwrap_or_else(StepPicture::failed)
    }
}

impl StepPicture {
    fn failed(fault: String) -> Self {
        Self {
            fault: Some(fault),
            ..Self::default()
        }
    }
}

impl StepPictureTask {
    /// Draws the step, or says why it cannot be drawn.
    fn drawn(&self) -> Result<StepPicture, String> {
        let lesson = Lesson::read(&self.name, &self.text).map_err(|error| error.to_string())?;

        // The index may be that of a step in another version of the file.
        let count = lesson.steps.len();
        if self.index >= count {
            return Err(format!("the lesson has {count} steps"));
        }

        // A picture has no texts of the lesson to translate, and only one run is made for it.
        let (translation, mut last) = (Arc::default(), None);
        let open = step_at(&Arc::new(lesson), &translation, self.index, &mut last)?;
        let scene = picture(&open, self.style, &[]);

        // Pages draw SVG themselves, windows show pixels.
        let mut drawn = StepPicture::default();
        if self.as_svg {
            drawn.svg = Some(to_svg(&scene).map_err(|error| error.to_string())?);
        } else {
            let pixels = to_pixels(&scene, SHARPNESS).map_err(|error| error.to_string())?;
            drawn.pixels = Some(Arc::new(pixels.into()));
        }

        Ok(drawn)
    }
}
