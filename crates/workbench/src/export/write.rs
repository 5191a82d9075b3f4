//! Makes the files of an export in the background: in memory, or natively on the disk, where a file is written
//! completely or not at all. Both give the same bytes. [`WriteError`] says why an export fails once it has begun;
//! `refusal.rs` lists the reasons for which it does not begin.

mod balls;
mod paper;
mod space;

use std::io::{self, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use tilescope_drawing::brushed::BrushedCause;
use tilescope_drawing::orbit::TURN_FRAMES;
use tilescope_drawing::picture::{PictureView, frame};

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::json;
use tilescope_analysis::Report;
use tilescope_figures::{
    AnimationError, FigureError, Scene, to_pixels, to_png_controlled, to_svg, write_apng, write_gif,
};
use tilescope_formats::{
    Drawing, ExportContext, ExportError, FormatError, PointSet, Warning, certificate_path,
    export_bytes, is_valid,
};
#[cfg(not(target_arch = "wasm32"))]
use tilescope_formats::{export, write_through, write_whole};

use super::beside::beside;
use super::picture::{described, scene};
use super::provenance::{method, parameter_map, provenance};
use super::{ExportContent, ExportJob, extension, scene_path};
use crate::clock::Clock;
pub use balls::PASSAGE_FRAMES;
pub use paper::making_frames;
use tilescope_session::ground::MadeGround;
use tilescope_session::incoming::NamedBytes;
use tilescope_session::jobs::Monitor;
use tilescope_session::moment::Moment;
use tilescope_sets::{StippleLook, point_set, region};

/// The longest animation that is made in memory, in bytes: a browser's tab crashes when it runs out of memory. Chosen,
/// not measured.
pub const MAX_ANIMATION_BYTES: usize = 512 << 20;

/// An export whose files were made.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct Written {
    /// The path that was chosen.
    pub path: PathBuf,
    /// The content of the file, or of the files beside it.
    pub what: What,
}

/// The content of an exported file.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub enum What {
    /// Samples, beside their certificate.
    Samples {
        /// The path of the certificate's file.
        certificate: PathBuf,
        /// The verdict on the samples, as read back from the file.
        report: Box<Report>,
        /// Warnings for the user.
        warnings: Vec<Warning>,
        /// Whether they are the result, which must be valid.
        result: bool,
        /// Whether they are valid, or of nested levels each level is.
        valid: bool,
    },
    /// The picture of one moment.
    Picture,
    /// Pictures of scenes, in numbered files.
    Scenes {
        /// How many they are.
        count: usize,
    },
    /// An animation with a frame for each cursor.
    Animation {
        /// How many frames it has.
        frames: usize,
    },
}

/// Files made in memory.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct Outgoing {
    /// The files, by names without folders; the export itself is first.
    pub files: Vec<NamedBytes>,
    /// The export that the files make up.
    pub written: Written,
}

/// Why no file was written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The user cancelled the export.
    #[error("the export was cancelled")]
    Cancelled,
    /// The field or the shape of the set could not be made again.
    #[error("{0}")]
    Ground(String),
    /// Samples could not be written.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// The picture could not be made.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// The animation could not be made.
    #[error(transparent)]
    Animation(#[from] AnimationError),
    /// A file could not be written.
    #[error(transparent)]
    File(#[from] FormatError),
    /// The files could not be put together for a download.
    #[error(transparent)]
    Pack(#[from] crate::files::PackError),
    /// It failed in a worker; the error arrives as text.
    #[error("{0}")]
    InWorker(String),
    /// This path ends without a file name.
    #[error("{0} names no file")]
    NoName(String),
}

/// A [`WriteError`] as a worker sends it: whether the user cancelled, and the message.
#[derive(Serialize, Deserialize)]
struct SentError(bool, String);

impl Serialize for WriteError {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        SentError(matches!(self, Self::Cancelled), self.to_string()).serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for WriteError {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let SentError(cancelled, message) = SentError::deserialize(deserializer)?;
        Ok(if cancelled {
            Self::Cancelled
        } else {
            Self::InWorker(message)
        })
    }
}

/// Writes an export to the disk.
///
/// # Errors
///
/// [`WriteError`]; no unfinished file is left then, and a file that was not replaced is unchanged. Pictures of scenes
/// that were written before the error stay.
#[cfg(not(target_arch = "wasm32"))]
pub fn write(job: &ExportJob, monitor: &Monitor) -> Result<Written, WriteError> {
    // Balls without a delay are one picture. With a delay they are an animation, in which they turn.
    let written = match &job.content {
        ExportContent::Samples { .. } => write_samples(job, monitor),
        ExportContent::Picture { .. }
        | ExportContent::Scenes { .. }
        | ExportContent::Balls { delay: None, .. }
        | ExportContent::Dots { .. } => pictures(job, monitor).and_then(|files| {
            // All are drawn by now, so that a picture that cannot be drawn leaves no files of the others.
            for (path, bytes) in &files {
                write_whole(path, bytes)?;
            }
            Ok(what(job))
        }),
        // Frames go to the file one by one, as all of them may not fit into memory.
        ExportContent::Animation { .. }
        | ExportContent::Balls { .. }
        | ExportContent::Passage { .. }
        | ExportContent::Making { .. } => {
            let written = write_through(&job.path, |file| animate(job, file, monitor));
            written.map(|()| what(job))
        }
    };

    finish(job, written, monitor)
}

/// Makes the files of an export in memory: the same bytes that [`write()`] puts on a disk. Samples are read back from them,
/// verified and certified.
///
/// # Errors
///
/// [`WriteError`].
pub fn render(job: &ExportJob, monitor: &Monitor) -> Result<Outgoing, WriteError> {
    let name = name_of(&job.path)?;

    let mut files = Vec::new();
    let made = match &job.content {
        ExportContent::Samples { .. } => render_samples(job, &name, &mut files, monitor),
        ExportContent::Picture { .. }
        | ExportContent::Scenes { .. }
        | ExportContent::Balls { delay: None, .. }
        | ExportContent::Dots { .. } => pictures(job, monitor).and_then(|made| {
            for (path, bytes) in made {
                files.push(NamedBytes::new(name_of(&path)?, bytes));
            }
            Ok(what(job))
        }),
        ExportContent::Animation { .. }
        | ExportContent::Balls { .. }
        | ExportContent::Passage { .. }
        | ExportContent::Making { .. } => {
            // A browser has no file to write to, so that the whole animation is in memory, up to a limit.
            let mut bytes = Limited(Vec::new());
            animate(job, &mut bytes, monitor).map(|()| {
                files.push(NamedBytes::new(name, bytes.0));
                what(job)
            })
        }
    };

    let written = finish(job, made, monitor)?;
    Ok(Outgoing { files, written })
}

fn name_of(path: &Path) -> Result<String, WriteError> {
    let name = path.file_name();
    let none = || WriteError::NoName(path.display().to_string());
    Ok(name.ok_or_else(none)?.to_string_lossy().into_owned())
}

/// Adds the path to the content of an export that succeeded.
fn finish(
    job: &ExportJob,
    made: Result<What, WriteError>,
    monitor: &Monitor,
) -> Result<Written, WriteError> {
    let path = job.path.clone();
    let written = made.map(|what| Written { path, what });
    // After the user cancelled, any error is reported as the cancellation, which is its likely cause.
    written.map_err(|error| go_on(monitor).err().unwrap_or(error))
}

fn go_on(monitor: &Monitor) -> Result<(), WriteError> {
    if monitor.is_cancelled() {
        return Err(WriteError::Cancelled);
    }
    Ok(())
}

/// Returns whether to go on, for functions that ask.
fn flow(monitor: &Monitor) -> ControlFlow<()> {
    if monitor.is_cancelled() {
        ControlFlow::Break(())
    } else {
        ControlFlow::Continue(())
    }
}

/// Returns the samples of an export, the context for their certificate, and whether they are the result.
fn samples(
    job: &ExportJob,
    monitor: &Monitor,
) -> Result<(PointSet, ExportContext, bool), WriteError> {
    // The activity is what the caller does after this, which takes longer than gathering the samples.
    monitor.set_activity("verifying what was written");
    go_on(monitor)?;
    let (session, run) = (&*job.session, job.session.run());

    let mut context = ExportContext::new(region(&run.domain), run.domain.radius());
    method(session).clone_into(&mut context.method);
    context.parameters = parameter_map(session);
    if let Some(made) = &session.ground {
        // The certificate states the field and the shape, in which the set is judged.
        let (ground, _stated) = made
            .ground()
            .map_err(|error| WriteError::Ground(error.to_string()))?;
        // The beginning of a larger set is certified as such.
        context.made = made.stipple.map(|stipple| stipple.made);
        // The radius is the least one, as the command line states it.
        context.radius = ground.varying.judged.radius();
        (context.origin, context.varying) = (ground.origin, Some(ground.varying));
    }

    let (mut moment, mut look) = (None, None);
    // Pictures and animations have no samples, and do not come here.
    if let ExportContent::Samples {
        moment: wanted,
        precision,
        look: chosen,
    } = &job.content
    {
        context.precision = *precision;
        (moment, look) = (wanted.as_ref(), chosen.as_ref());
    }

    if let Some(nested) = &session.nested {
        // A moment of nested levels is a prefix of their samples; the certificate names only the levels in it.
        let prefix = moment.and_then(|moment| moment.prefix(session));
        let count = prefix.unwrap_or(session.summary.count);
        context.levels = nested.cut(count);
        context.ranks = nested.ranks.get(..count).unwrap_or_default().into();
    }

    let set = match moment {
        Some(moment) => {
            // The run's parameters alone reproduce its result, but not the samples of a moment: the certificate names the moment.
            let description = moment.description(session);
            context.parameters.insert("moment".to_owned(), description);
            point_set(run, &moment.samples(session))
        }
        None => point_set(run, &run.result),
    };
    // Of the formats only SVG shows dots on paper.
    let look = look.zip(session.ground.as_ref());
    context.drawing = look.and_then(|(look, made)| drawing(look, made, &context, &set));
    let is_result = moment.is_none();
    Ok((set, context, is_result))
}

/// Returns how pictures show these dots of a stipple.
fn drawing(
    look: &StippleLook,
    made: &MadeGround,
    context: &ExportContext,
    set: &PointSet,
) -> Option<Drawing> {
    let judged = &context.varying.as_ref()?.judged;
    let is_inverted = made.asked.1.stipple.as_ref()?.tone.is_inverted;
    let black = made.stipple?.black;
    Some(look.drawing(black, judged, &set.points, is_inverted))
}

/// Writes the samples and their certificate beside them.
#[cfg(not(target_arch = "wasm32"))]
fn write_samples(job: &ExportJob, monitor: &Monitor) -> Result<What, WriteError> {
    if let Some(solid) = &job.session.solid {
        return space::write(job, solid, monitor);
    }
    let (set, context, result) = samples(job, monitor)?;
    let exported = export(&job.path, &set, &context, &|progress| {
        monitor.follow(progress)
    })?;

    Ok(What::Samples {
        certificate: exported.certificate_path,
        valid: is_valid(&exported.report, &exported.certificate.levels),
        report: Box::new(exported.report),
        warnings: exported.warnings,
        result,
    })
}

/// Appends the file of a set and its certificate to `files`.
fn render_samples(
    job: &ExportJob,
    name: &str,
    files: &mut Vec<NamedBytes>,
    monitor: &Monitor,
) -> Result<What, WriteError> {
    if let Some(solid) = &job.session.solid {
        return space::render(job, solid, name, files, monitor);
    }
    let (set, context, result) = samples(job, monitor)?;
    let exported = export_bytes(name, &set, &context, &|progress| monitor.follow(progress))?;

    let certificate = certificate_path(Path::new(name));
    let beside = certificate.to_string_lossy().into_owned();

    // The set itself comes first: the archive for a download is named after it.
    files.push(NamedBytes::new(name, exported.data));
    files.push(NamedBytes::new(beside, exported.certificate_bytes));

    Ok(What::Samples {
        certificate,
        valid: is_valid(&exported.report, &exported.certificate.levels),
        report: Box::new(exported.report),
        warnings: exported.warnings,
        result,
    })
}

/// Returns the files of a picture or of the scenes; all are drawn before the first one is written.
fn pictures(job: &ExportJob, monitor: &Monitor) -> Result<Vec<(PathBuf, Vec<u8>)>, WriteError> {
    let (shown, causes, scale, is_one) = match &job.content {
        ExportContent::Dots {
            moment,
            look,
            columns,
        } => {
            let picture = paper::picture(job, *moment, look, *columns, monitor)?;
            return Ok(vec![(job.path.clone(), picture)]);
        }
        ExportContent::Balls { shown, delay: None } => {
            let picture = balls::picture(job, shown, monitor)?;
            return Ok(vec![(job.path.clone(), picture)]);
        }
        ExportContent::Picture {
            shown,
            causes,
            scale,
        } => (std::slice::from_ref(shown), causes.clone(), *scale, true),
        ExportContent::Scenes { shown, scale } => (&shown[..], None, *scale, false),
        // Samples and animations have no pictures.
        _ => return Ok(Vec::new()),
    };
    // A serial number keeps cached pictures apart. This picture is not cached, so that any number will do.
    let causes = causes.map(|cause| BrushedCause { serial: 0, cause });
    let count = shown.len();

    let mut files = Vec::new();
    for (index, shown) in shown.iter().enumerate() {
        let (path, activity) = if is_one {
            (job.path.clone(), "drawing".to_owned())
        } else {
            let activity = format!("scene {} of {count}", index + 1);
            (scene_path(&job.path, index, count), activity)
        };
        monitor.set_activity(&activity);
        monitor.set_fraction(index as f32 / count as f32);
        go_on(monitor)?;

        let mut drawn = scene(&job.session, shown, causes.as_ref());
        if shown.view.analysis {
            add_analysis(job, shown.moment, &shown.view, &mut drawn, monitor)?;
        }

        // The 0.3 is an estimate: laying out a picture takes less time than encoding it.
        monitor.set_fraction((index as f32 + 0.3) / count as f32);
        go_on(monitor)?;
        // The form has refused extensions of other formats than these two.
        let bytes = match extension(&path).as_deref() {
            Some("svg") => to_svg(&drawn)?.into_bytes(),
            _ => match to_png_controlled(&drawn, scale, &mut |_, _| flow(monitor)) {
                Err(FigureError::Cancelled) => return Err(WriteError::Cancelled),
                bytes => bytes?,
            },
        };
        files.push((path, bytes));
    }
    // Nothing is written after a cancellation, though all pictures are there.
    go_on(monitor)?;
    Ok(files)
}

/// Measures a moment and draws its analysis beside its picture.
fn add_analysis(
    job: &ExportJob,
    moment: Moment,
    view: &PictureView,
    picture: &mut Scene,
    monitor: &Monitor,
) -> Result<(), FigureError> {
    // The fraction done is that of all pictures, not of one measure. Only a cancellation is an error here.
    let found =
        beside(&job.session.0, moment, &|_| flow(monitor)).map_err(|_| FigureError::Cancelled)?;
    Ok(found.draw(view, picture)?)
}

/// Returns the content of an export that has no samples.
fn what(job: &ExportJob) -> What {
    match &job.content {
        ExportContent::Scenes { shown, .. } => What::Scenes { count: shown.len() },
        ExportContent::Animation { cursors, .. } => What::Animation {
            frames: cursors.len(),
        },
        ExportContent::Balls { delay: Some(_), .. } => What::Animation {
            frames: TURN_FRAMES,
        },
        ExportContent::Passage { .. } => What::Animation {
            frames: PASSAGE_FRAMES,
        },
        ExportContent::Making { .. } => What::Animation {
            frames: making_frames(job.session.0.summary.count),
        },
        _ => What::Picture,
    }
}

/// Writes an animation to `out` frame by frame.
fn animate(job: &ExportJob, out: &mut dyn Write, monitor: &Monitor) -> Result<(), WriteError> {
    match &job.content {
        ExportContent::Balls {
            shown,
            delay: Some(delay),
        } => return balls::turn(job, shown, *delay, out, monitor),
        ExportContent::Passage { shown, delay } => {
            return balls::passage(job, shown, *delay, out, monitor);
        }
        ExportContent::Making {
            look,
            columns,
            delay,
        } => return paper::making(job, look, *columns, *delay, out, monitor),
        _ => {}
    }
    let ExportContent::Animation {
        cursors,
        view,
        scale,
        delay,
        clock,
        every,
    } = &job.content
    else {
        // Only animations come here; any other content would have no frames.
        return Err(AnimationError::NoFrames.into());
    };

    let session = &*job.session;
    let mut metadata = provenance(session);
    let range = described_range(cursors, *clock, *every, *delay);
    metadata.push(("Range".to_owned(), range));
    metadata.push(("View".to_owned(), described(view)));

    let draw = |&cursor: &usize| {
        let mut drawn = frame(session, cursor, view);
        if view.analysis {
            let moment = Moment::at(session, cursor);
            add_analysis(job, moment, view, &mut drawn, monitor)?;
        }
        to_pixels(&drawn, *scale)
    };
    let mut report = |done: usize, all: usize| {
        monitor.set_activity(&format!("frame {done} of {all}"));
        monitor.set_fraction(done as f32 / all.max(1) as f32);
        flow(monitor)
    };

    let frames = cursors.iter().map(draw);
    // The extension chooses the format. The form has refused extensions of other formats.
    match extension(&job.path).as_deref() {
        Some("gif") => write_gif(frames, *delay, &metadata, out, &mut report)?,
        _ => write_apng(frames, *delay, &metadata, out, &mut report)?,
    }
    Ok(())
}

/// A writer into memory with a limit, as a browser's tab crashes when it runs out of memory.
struct Limited(Vec<u8>);

impl Write for Limited {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.0.len() + bytes.len() > MAX_ANIMATION_BYTES {
            let most = tilescope_session::words::grouped(MAX_ANIMATION_BYTES);
            return Err(io::Error::other(format!(
                "it is longer than {most} bytes; fewer frames or a smaller scale would do"
            )));
        }
        self.0.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn described_range(cursors: &[usize], clock: Clock, every: usize, delay: u16) -> String {
    // Delays are in hundredths of a second.
    json!({
        "start": cursors.first(),
        "end": cursors.last(),
        "frames": cursors.len(),
        "clock": clock.name(),
        "every": every,
        "delay_ms": 10 * u32::from(delay),
    })
    .to_string()
}
