//! Stipples as dots of ink on paper: a picture of those of a moment, and an animation in which they appear in the order of
//! their arrival.

use std::io::Write;

use tilescope_figures::{FigureError, Scene, on_paper, to_pixels, to_png_controlled, to_svg};
use tilescope_formats::ExportContext;
use tilescope_session::jobs::Monitor;
use tilescope_session::moment::Moment;
use tilescope_sets::{StippleLook, point_set, region};

use super::{ExportJob, WriteError, drawing, extension, flow, go_on};
use crate::export::provenance::provenance;

/// The most frames of the making of a stipple: at 10 frames a second it takes twelve seconds, as a plane's passage does.
const MAKING_FRAMES: usize = 120;

/// The dots of a stipple, and the paper below them.
struct Paper {
    size: [f64; 2],
    columns: u32,
    /// Of paper and of ink.
    colors: [[u8; 3]; 2],
    /// The place and the radius of each dot, in the unit of the domain and in the order of arrival.
    dots: Vec<([f64; 2], f64)>,
}

impl Paper {
    /// Returns the dots of a job that these are the numbers of, drawn in this look on paper so many pixels wide.
    fn of(
        job: &ExportJob,
        ids: &[u32],
        look: &StippleLook,
        columns: u32,
    ) -> Result<Self, WriteError> {
        let session = &*job.session;
        let none = || WriteError::Ground("this set is no stipple".to_owned());
        let made = session.ground.as_ref().ok_or_else(none)?;
        let (ground, _stated) = made
            .ground()
            .map_err(|error| WriteError::Ground(error.to_string()))?;

        let run = session.run();
        let set = point_set(run, ids);
        let context = ExportContext {
            varying: Some(ground.varying),
            ..ExportContext::new(region(&run.domain), run.domain.radius())
        };
        let drawing = drawing(look, made, &context, &set).ok_or_else(none)?;
        let judged = context.varying.as_ref().map(|varying| &varying.judged);
        // The context has a field, so that the 1 never stands in.
        let own = |at| judged.map_or(1.0, |judged| judged.radius_at(at));
        let dots = set.points.iter().copied();
        Ok(Self {
            size: context.region.size(),
            columns,
            colors: [drawing.paper, drawing.ink],
            dots: dots.map(|at| (at, drawing.dots.radius(own(at)))).collect(),
        })
    }

    /// Returns the picture of the first `count` dots.
    fn scene(&self, count: usize) -> Scene {
        let dots = self.dots.iter().take(count).copied();
        on_paper(self.size, self.columns, self.colors, dots)
    }
}

/// Returns the file of a picture of the dots of a moment.
pub(super) fn picture(
    job: &ExportJob,
    moment: Moment,
    look: &StippleLook,
    columns: u32,
    monitor: &Monitor,
) -> Result<Vec<u8>, WriteError> {
    monitor.set_activity("drawing");
    go_on(monitor)?;
    let ids = moment.samples(&job.session);
    let mut scene = Paper::of(job, &ids, look, columns)?.scene(ids.len());
    scene.metadata = provenance(&job.session);

    // The scene is laid out in pixels already.
    let scale = 1.0;
    match extension(&job.path).as_deref() {
        Some("svg") => Ok(to_svg(&scene)?.into_bytes()),
        _ => match to_png_controlled(&scene, scale, &mut |_, _| flow(monitor)) {
            Err(FigureError::Cancelled) => Err(WriteError::Cancelled),
            bytes => Ok(bytes?),
        },
    }
}

/// Returns how many frames the making of a stipple of so many dots has: one for each dot, if they are few.
#[must_use]
pub fn making_frames(dots: usize) -> usize {
    dots.clamp(1, MAKING_FRAMES)
}

/// Returns how many dots are there in a frame, counted from 0. Each frame has as many more, and the last one has all.
fn dots_at(frame: usize, dots: usize) -> usize {
    (dots * (frame + 1)).div_ceil(making_frames(dots))
}

/// Writes an animation in which all dots appear in the order of their arrival. A frame is shown for `delay` hundredths of a
/// second.
pub(super) fn making(
    job: &ExportJob,
    look: &StippleLook,
    columns: u32,
    delay: u16,
    out: &mut dyn Write,
    monitor: &Monitor,
) -> Result<(), WriteError> {
    let dots = job.session.0.summary.count;
    // The numbers of dots follow their arrival.
    let ids: Vec<u32> = (0..dots as u32).collect();
    let paper = Paper::of(job, &ids, look, columns)?;
    let mut metadata = provenance(&job.session);
    let shown = format!("the dots in the order of their arrival, up to all {dots}");
    metadata.push(("Shows".to_owned(), shown));

    let frames = (0..making_frames(dots)).map(|frame| {
        let scale = 1.0;
        to_pixels(&paper.scene(dots_at(frame, dots)), scale)
    });
    super::balls::written(job, frames, delay, &metadata, out, monitor)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_begin_with_some_dots_and_end_with_all() {
        for dots in [1, 2, 119, 120, 121, 1_000, 50_000] {
            let frames = making_frames(dots);
            let counts: Vec<usize> = (0..frames).map(|frame| dots_at(frame, dots)).collect();
            assert!(counts[0] >= 1 && counts[frames - 1] == dots, "{counts:?}");
            assert!(
                counts.windows(2).all(|pair| pair[0] < pair[1]),
                "{counts:?}"
            );
        }
        // The control: with a frame more, one of these would show no new dot.
        assert_eq!((making_frames(119), dots_at(118, 119)), (119, 119));
        assert_eq!(making_frames(121), 120);
    }
}
