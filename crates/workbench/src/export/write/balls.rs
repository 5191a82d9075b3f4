//! Pictures and animations of a set in space: its balls, once or turning, and a plane that passes through it.

use std::io::Write;

use tilescope_drawing::orbit::{OrbitError, OrbitPicture, described, scene};
use tilescope_drawing::picture::MomentView;
use tilescope_figures::{FigureError, Pixels, Scene, to_pixels, to_png_controlled, to_svg};
use tilescope_figures::{write_apng, write_gif};
use tilescope_session::jobs::Monitor;
use tilescope_session::solid::MadeSolid;

use super::{ExportJob, WriteError, extension, flow, go_on};
use crate::export::picture::scene as scene_of_moment;
use crate::export::provenance::provenance;
use crate::export::{BallsView, PassageView};
use crate::orbit::{drawn_set, palette};

/// The frames of a plane's passage through a set: at 10 frames a second it takes twelve seconds.
pub const PASSAGE_FRAMES: usize = 120;

/// Balls to be drawn: all that the frames have in common.
struct Balls<'a> {
    job: &'a ExportJob,
    shown: &'a BallsView,
    points: Vec<[f64; 3]>,
    levels: Vec<u8>,
    solid: &'a MadeSolid,
}

impl<'a> Balls<'a> {
    fn of(job: &'a ExportJob, shown: &'a BallsView) -> Result<Self, WriteError> {
        let session = &*job.session;
        let planar = || WriteError::Ground("this set is planar".to_owned());
        let solid = session.solid.as_ref().ok_or_else(planar)?;
        Ok(Self {
            job,
            shown,
            points: solid.positions(session.run()),
            levels: solid.levels.of_samples().collect(),
            solid,
        })
    }

    fn picture(&self) -> OrbitPicture<'_> {
        let BallsView {
            view,
            size,
            is_dark,
            ..
        } = *self.shown;
        let set = drawn_set(&self.job.session, self.solid, &self.points, &self.levels);
        OrbitPicture::new(set, view, size, palette(is_dark))
    }

    /// Returns what files say of the picture.
    fn metadata(&self) -> Vec<(String, String)> {
        let mut metadata = provenance(&self.job.session);
        let picture = self.picture();
        metadata.push(("View".to_owned(), picture.view.to_string()));
        metadata.push((
            "Shows".to_owned(),
            described(self.points.len(), picture.set.size, picture.view),
        ));
        metadata
    }

    /// Lays a picture out.
    fn scene(&self, picture: &OrbitPicture<'_>, monitor: &Monitor) -> Result<Scene, FigureError> {
        let BallsView {
            caption, legend, ..
        } = self.shown;
        scene(picture, caption, *legend, &|| monitor.go_on()).map_err(|error| match error {
            OrbitError::Cancelled => FigureError::Cancelled,
            other => FigureError::Chart(other.to_string()),
        })
    }
}

/// Returns the file of a picture of balls.
pub(super) fn picture(
    job: &ExportJob,
    shown: &BallsView,
    monitor: &Monitor,
) -> Result<Vec<u8>, WriteError> {
    monitor.set_activity("drawing");
    go_on(monitor)?;
    let balls = Balls::of(job, shown)?;
    let mut drawn = balls.scene(&balls.picture(), monitor)?;
    drawn.metadata = balls.metadata();

    // The scene is laid out in pixels already.
    let scale = 1.0;
    match extension(&job.path).as_deref() {
        Some("svg") => Ok(to_svg(&drawn)?.into_bytes()),
        _ => Ok(to_png_controlled(&drawn, scale, &mut |_, _| flow(monitor))?),
    }
}

/// Writes an animation in which the set turns once. A frame is shown for `delay` hundredths of a second.
pub(super) fn turn(
    job: &ExportJob,
    shown: &BallsView,
    delay: u16,
    out: &mut dyn Write,
    monitor: &Monitor,
) -> Result<(), WriteError> {
    let balls = Balls::of(job, shown)?;
    let still = balls.picture();
    // The corner that is cut out stays that of the first frame, and turns with the set.
    let views: Vec<_> = shown.view.turn().collect();
    let frames = views.into_iter().map(|view| {
        let frame = OrbitPicture { view, ..still };
        let scale = 1.0;
        to_pixels(&balls.scene(&frame, monitor)?, scale)
    });
    written(job, frames, delay, &balls.metadata(), out, monitor)
}

/// Writes an animation in which the plane passes through the set, from one end of the box to the other. A frame is
/// shown for `delay` hundredths of a second.
pub(super) fn passage(
    job: &ExportJob,
    shown: &PassageView,
    delay: u16,
    out: &mut dyn Write,
    monitor: &Monitor,
) -> Result<(), WriteError> {
    let session = &*job.session;
    let planar = || WriteError::Ground("this set is planar".to_owned());
    let solid = session.solid.as_ref().ok_or_else(planar)?;
    let mut metadata = provenance(session);
    metadata.push(("Plane".to_owned(), format!("z from 0 to {}", solid.depth())));

    // The frames are planes at equal distances, both ends among them.
    let end = PASSAGE_FRAMES - 1;
    let frames = (0..PASSAGE_FRAMES).map(|frame| {
        let place = solid.depth() * frame as f64 / end as f64;
        let mut at: MomentView = shown.shown.clone();
        at.view.plane = Some(solid.plane_at(place));
        to_pixels(&scene_of_moment(session, &at, None), shown.scale)
    });
    written(job, frames, delay, &metadata, out, monitor)
}

/// Writes frames as GIF if the extension says so, and otherwise as animated PNG. A frame is shown for `delay`
/// hundredths of a second.
pub(super) fn written(
    job: &ExportJob,
    frames: impl ExactSizeIterator<Item = Result<Pixels, FigureError>>,
    delay: u16,
    metadata: &[(String, String)],
    out: &mut dyn Write,
    monitor: &Monitor,
) -> Result<(), WriteError> {
    let mut report = |done: usize, all: usize| {
        monitor.set_activity(&format!("frame {done} of {all}"));
        monitor.set_fraction(done as f32 / all.max(1) as f32);
        flow(monitor)
    };
    match extension(&job.path).as_deref() {
        Some("gif") => write_gif(frames, delay, metadata, out, &mut report)?,
        _ => write_apng(frames, delay, metadata, out, &mut report)?,
    }
    Ok(())
}
