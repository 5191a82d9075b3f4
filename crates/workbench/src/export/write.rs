//! Makes the files of an export in the background: in memory, or natively on the disk, where a file is written
//! completely or not at all. Both give the same bytes.

use std::io::{self, Write};
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use tilescope_drawing::brushed::BrushedCause;

use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::json;
use tilescope_analysis::Report;
use tilescope_figures::{
    AnimationError, FigureError, Scene, to_pixels, to_png, to_svg, write_apng, write_gif,
};
use tilescope_formats::{
    ExportContext, ExportError, FormatError, PointSet, Warning, certificate_path, export_bytes,
};
#[cfg(not(target_arch = "wasm32"))]
use tilescope_formats::{export, write_through, write_whole};

use super::picture::{described, frame, scene};
use super::provenance::{method, parameter_map, point_set, provenance};
use super::{ExportContent, ExportJob, extension, scene_path};
use crate::clock::Clock;
use tilescope_session::incoming::NamedBytes;
use tilescope_session::jobs::Monitor;
use tilescope_session::verification::region_of;

/// The longest animation that is made in memory, in bytes.
pub const MAX_ANIMATION_BYTES: usize = 512 << 20;

/// An exported file.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub struct Written {
    /// The file.
    pub path: PathBuf,
    /// Its contents.
    pub what: What,
}

/// The content of an exported file.
#[derive(Clone, Debug, serde::Serialize, serde::Deserialize)]
pub enum What {
    /// Samples, beside their certificate.
    Samples {
        /// The certificate's file.
        certificate: PathBuf,
        /// The verdict on the samples, as read back from the file.
        report: Box<Report>,
        /// Warnings for the user.
        warnings: Vec<Warning>,
        /// Whether they are the result, which must be valid.
        result: bool,
    },
    /// A picture.
    Picture,
    /// Pictures of scenes.
    Scenes {
        /// How many they are.
        count: usize,
    },
    /// An animation.
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
    /// Their contents.
    pub written: Written,
}

/// Why no file was written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The user cancelled.
    #[error("the export was cancelled")]
    Cancelled,
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
    #[error("{message}")]
    InWorker {
        /// The error in words.
        message: String,
    },
    /// The path ends with no name.
    #[error("{path} names no file")]
    NoName {
        /// The path.
        path: String,
    },
}

/// A [`WriteError`] as it is sent: whether it was cancelled, and its message.
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
            Self::InWorker { message }
        })
    }
}

/// Writes an export to the disk.
///
/// # Errors
///
/// [`WriteError`]; no new file is left then, and an existing one is unchanged.
#[cfg(not(target_arch = "wasm32"))]
pub fn write(order: &ExportJob, monitor: &Monitor) -> Result<Written, WriteError> {
    let written = match &order.content {
        ExportContent::Samples { .. } => write_samples(order, monitor),
        ExportContent::Picture { .. } => picture(order, monitor).and_then(|bytes| {
            write_whole(&order.path, &bytes)?;
            Ok(What::Picture)
        }),
        ExportContent::Scenes { .. } => scenes(order, monitor).and_then(|files| {
            let count = files.len();
            for (path, bytes) in files {
                write_whole(&path, &bytes)?;
            }
            Ok(What::Scenes { count })
        }),
        ExportContent::Animation { .. } => {
            let written = write_through(&order.path, |file| animate(order, file, monitor));
            written.map(|()| animation(order))
        }
    };
    finish(order, written, monitor)
}

/// Makes what was ordered in memory: the bytes that [`write()`] puts on a disk. Samples are read back from them, verified
/// and certified.
///
/// # Errors
///
/// [`WriteError`].
pub fn render(order: &ExportJob, monitor: &Monitor) -> Result<Outgoing, WriteError> {
    let name = name_of(&order.path)?;
    let mut files = Vec::new();
    let made = match &order.content {
        ExportContent::Samples { .. } => render_samples(order, &name, &mut files, monitor),
        ExportContent::Picture { .. } => picture(order, monitor).map(|bytes| {
            files.push(NamedBytes::new(name, bytes));
            What::Picture
        }),
        ExportContent::Scenes { .. } => scenes(order, monitor).and_then(|made| {
            let count = made.len();
            for (path, bytes) in made {
                files.push(NamedBytes::new(name_of(&path)?, bytes));
            }
            Ok(What::Scenes { count })
        }),
        ExportContent::Animation { .. } => {
            let mut bytes = Limited(Vec::new());
            animate(order, &mut bytes, monitor).map(|()| {
                files.push(NamedBytes::new(name, bytes.0));
                animation(order)
            })
        }
    };
    let written = finish(order, made, monitor)?;
    Ok(Outgoing { files, written })
}

fn name_of(path: &Path) -> Result<String, WriteError> {
    let name = path.file_name().ok_or_else(|| WriteError::NoName {
        path: path.display().to_string(),
    })?;
    Ok(name.to_string_lossy().into_owned())
}

fn finish(
    order: &ExportJob,
    made: Result<What, WriteError>,
    monitor: &Monitor,
) -> Result<Written, WriteError> {
    // An error after cancellation is the cancellation.
    let what = made.map_err(|error| match error {
        _ if monitor.is_cancelled() => WriteError::Cancelled,
        error => error,
    })?;
    let path = order.path.clone();
    Ok(Written { path, what })
}

fn go_on(monitor: &Monitor) -> Result<(), WriteError> {
    if monitor.is_cancelled() {
        return Err(WriteError::Cancelled);
    }
    Ok(())
}

/// Returns the samples of an export, the context for their certificate, and whether they are the result.
fn samples(order: &ExportJob) -> (PointSet, ExportContext, bool) {
    let (session, run) = (&*order.session, order.session.run());
    let mut context = ExportContext::new(region_of(session), run.domain.radius());
    method(session).clone_into(&mut context.method);
    context.parameters = parameter_map(session);
    let mut moment = None;
    if let ExportContent::Samples {
        moment: wanted,
        precision,
    } = &order.content
    {
        context.precision = *precision;
        moment = wanted.as_ref();
    }
    let set = match moment {
        Some(moment) => {
            let description = moment.description(session);
            context.parameters.insert("moment".to_owned(), description);
            point_set(run, &moment.samples(session))
        }
        None => point_set(run, &run.result),
    };
    (set, context, moment.is_none())
}

const VERIFYING: &str = "verifying what was written";

#[cfg(not(target_arch = "wasm32"))]
fn write_samples(order: &ExportJob, monitor: &Monitor) -> Result<What, WriteError> {
    monitor.set_activity(VERIFYING);
    go_on(monitor)?;
    let (set, context, result) = samples(order);
    let control = |progress| monitor.follow(progress);
    let exported = export(&order.path, &set, &context, &control)?;
    Ok(What::Samples {
        certificate: exported.certificate_path,
        report: Box::new(exported.report),
        warnings: exported.warnings,
        result,
    })
}

fn render_samples(
    order: &ExportJob,
    name: &str,
    files: &mut Vec<NamedBytes>,
    monitor: &Monitor,
) -> Result<What, WriteError> {
    monitor.set_activity(VERIFYING);
    go_on(monitor)?;
    let (set, context, result) = samples(order);
    let control = |progress| monitor.follow(progress);
    let exported = export_bytes(name, &set, &context, &control)?;
    let certificate = certificate_path(Path::new(name));
    let beside = certificate.to_string_lossy().into_owned();
    files.push(NamedBytes::new(name, exported.data));
    files.push(NamedBytes::new(beside, exported.certificate_bytes));
    Ok(What::Samples {
        certificate,
        report: Box::new(exported.report),
        warnings: exported.warnings,
        result,
    })
}

fn picture(order: &ExportJob, monitor: &Monitor) -> Result<Vec<u8>, WriteError> {
    let ExportContent::Picture {
        shown,
        causes,
        scale,
    } = &order.content
    else {
        return Ok(Vec::new());
    };
    monitor.set_activity("drawing");
    let causes = causes
        .clone()
        .map(|cause| BrushedCause { serial: 0, cause });
    let scene = scene(&order.session, shown, causes.as_ref());
    monitor.set_fraction(0.3);
    go_on(monitor)?;
    let bytes = encoded(&scene, order, *scale)?;
    monitor.set_fraction(0.9);
    go_on(monitor)?;
    Ok(bytes)
}

/// Returns a picture in the format of the file's extension.
fn encoded(scene: &Scene, order: &ExportJob, scale: f64) -> Result<Vec<u8>, WriteError> {
    Ok(match extension(&order.path).as_deref() {
        Some("svg") => to_svg(scene)?.into_bytes(),
        _ => to_png(scene, scale)?,
    })
}

/// Returns the files of the scenes: all are drawn before the first one is written.
fn scenes(order: &ExportJob, monitor: &Monitor) -> Result<Vec<(PathBuf, Vec<u8>)>, WriteError> {
    let ExportContent::Scenes { shown, scale } = &order.content else {
        return Ok(Vec::new());
    };
    let count = shown.len();
    let mut files = Vec::new();
    for (index, shown) in shown.iter().enumerate() {
        monitor.set_activity(&format!("scene {} of {count}", index + 1));
        monitor.set_fraction(index as f32 / count as f32);
        go_on(monitor)?;
        let bytes = encoded(&scene(&order.session, shown, None), order, *scale)?;
        files.push((scene_path(&order.path, index, count), bytes));
    }
    Ok(files)
}

fn animation(order: &ExportJob) -> What {
    let frames = match &order.content {
        ExportContent::Animation { cursors, .. } => cursors.len(),
        _ => 0,
    };
    What::Animation { frames }
}

fn animate(order: &ExportJob, out: &mut dyn Write, monitor: &Monitor) -> Result<(), WriteError> {
    let ExportContent::Animation {
        cursors,
        view,
        scale,
        delay,
        clock,
        every,
    } = &order.content
    else {
        return Err(AnimationError::NoFrames.into());
    };
    let session = &*order.session;
    let mut metadata = provenance(session);
    let range = described_range(cursors, *clock, *every, *delay);
    metadata.push(("Range".to_owned(), range));
    metadata.push(("View".to_owned(), described(view)));
    let draw = |&cursor: &usize| to_pixels(&frame(session, cursor, view), *scale);
    let mut tell = |done: usize, all: usize| {
        monitor.set_activity(&format!("frame {done} of {all}"));
        monitor.set_fraction(done as f32 / all.max(1) as f32);
        if monitor.is_cancelled() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    let frames = cursors.iter().map(draw);
    match extension(&order.path).as_deref() {
        Some("gif") => write_gif(frames, *delay, &metadata, out, &mut tell)?,
        _ => write_apng(frames, *delay, &metadata, out, &mut tell)?,
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
