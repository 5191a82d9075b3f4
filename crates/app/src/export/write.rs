//! Writing files in the background, and asking the system for their names. A file appears whole or not at all: what
//! fails or is cancelled leaves none, and another file of that name as it was.

use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use serde_json::json;
use tilescope_figures::{
    AnimationError, FigureError, to_pixels, to_png, to_svg, write_apng, write_gif,
};
use tilescope_formats::{
    ExportContext, ExportError, Exported, FormatError, Precision, export, write_through,
    write_whole,
};

use super::form::ExportForm;
use super::picture::{View, described, recorded, scene};
use super::still::{Still, parameter_map, point_set, provenance};
use super::{Content, Kind, Order, extension};
use crate::clock::Clock;
use crate::jobs::{Job, Monitor, Wake};
use crate::verification::region_of;

/// A file that was written.
#[derive(Clone, Debug)]
pub enum Written {
    /// Samples and their certificate.
    Samples {
        /// The files and the verdict.
        exported: Box<Exported>,
        /// Whether they are the result, which should be valid.
        result: bool,
    },
    /// A picture.
    Picture {
        /// The file.
        path: PathBuf,
    },
    /// An animation.
    Animation {
        /// The file.
        path: PathBuf,
        /// How many frames it has.
        frames: usize,
    },
}

impl Written {
    /// Returns the file.
    #[must_use]
    pub fn path(&self) -> &Path {
        match self {
            Self::Samples { exported, .. } => &exported.path,
            Self::Picture { path } | Self::Animation { path, .. } => path,
        }
    }
}

/// Why no file was written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The user asked to stop.
    #[error("the export was cancelled")]
    Cancelled,
    /// Samples could not be written.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// There is no such picture.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// There is no such animation.
    #[error(transparent)]
    Animation(#[from] AnimationError),
    /// A file could not be written.
    #[error(transparent)]
    File(#[from] FormatError),
}

/// Writes what was ordered.
///
/// # Errors
///
/// [`WriteError`]; no file is left then, and one that was there is as it was.
pub fn write(order: &Order, monitor: &Monitor) -> Result<Written, WriteError> {
    let written = match &order.content {
        Content::Samples { moment, precision } => {
            write_samples(order, moment.as_ref(), *precision, monitor)
        }
        Content::Picture {
            moment,
            view,
            scale,
        } => write_picture(order, moment, view, *scale, monitor),
        Content::Animation { .. } => write_animation(order, monitor),
    };
    // What stops because it was asked to has not failed.
    written.map_err(|error| match error {
        _ if monitor.is_cancelled() => WriteError::Cancelled,
        error => error,
    })
}

fn go_on(monitor: &Monitor) -> Result<(), WriteError> {
    if monitor.is_cancelled() {
        return Err(WriteError::Cancelled);
    }
    Ok(())
}

fn write_samples(
    order: &Order,
    moment: Option<&Still>,
    precision: Precision,
    monitor: &Monitor,
) -> Result<Written, WriteError> {
    monitor.set_activity("verifying what was written");
    go_on(monitor)?;
    let (session, run) = (&*order.session, order.session.run());
    let mut context = ExportContext::new(region_of(session), run.domain.radius());
    context.precision = precision;
    "kdrt".clone_into(&mut context.method);
    context.parameters = parameter_map(session);
    let set = match moment {
        Some(moment) => {
            let description = moment.description(session);
            context.parameters.insert("moment".to_owned(), description);
            point_set(run, &moment.samples(session))
        }
        None => point_set(run, &run.result),
    };
    let control = |progress| monitor.follow(progress);
    let exported = export(&order.path, &set, &context, &control)?;
    Ok(Written::Samples {
        exported: Box::new(exported),
        result: moment.is_none(),
    })
}

fn write_picture(
    order: &Order,
    moment: &Still,
    view: &View,
    scale: f64,
    monitor: &Monitor,
) -> Result<Written, WriteError> {
    monitor.set_activity("drawing");
    let scene = scene(&order.session, moment, view);
    monitor.set_fraction(0.3);
    go_on(monitor)?;
    let bytes = match extension(&order.path).as_deref() {
        Some("svg") => to_svg(&scene)?.into_bytes(),
        _ => to_png(&scene, scale)?,
    };
    monitor.set_fraction(0.9);
    go_on(monitor)?;
    write_whole(&order.path, &bytes)?;
    let path = order.path.clone();
    Ok(Written::Picture { path })
}

fn write_animation(order: &Order, monitor: &Monitor) -> Result<Written, WriteError> {
    let Content::Animation {
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
    let draw = |&cursor: &usize| to_pixels(&recorded(session, cursor, view), *scale);
    let mut tell = |done: usize, all: usize| {
        monitor.set_activity(&format!("frame {done} of {all}"));
        monitor.set_fraction(done as f32 / all.max(1) as f32);
        if monitor.is_cancelled() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    };
    write_through(&order.path, |file| -> Result<(), WriteError> {
        let frames = cursors.iter().map(draw);
        match extension(&order.path).as_deref() {
            Some("gif") => write_gif(frames, *delay, &metadata, file, &mut tell)?,
            _ => write_apng(frames, *delay, &metadata, file, &mut tell)?,
        }
        Ok(())
    })?;
    Ok(Written::Animation {
        path: order.path.clone(),
        frames: cursors.len(),
    })
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

/// Opens the system's dialog; the job ends with the chosen file, or `None`.
#[must_use]
pub fn browse(form: &ExportForm, wake: &Wake) -> Job<Option<PathBuf>> {
    let path = form.file();
    let extensions = form.kind.extensions();
    let name = path.file_name().map_or_else(
        || format!("tilescope.{}", extensions[0]),
        |name| name.to_string_lossy().into_owned(),
    );
    let (title, all) = match form.kind {
        Kind::Result | Kind::Samples => {
            ("Export the samples and their certificate", "All point sets")
        }
        Kind::Picture => ("Export a picture of this moment", "All pictures"),
        Kind::Animation => ("Export an animation", "All animations"),
    };
    let mut dialog = rfd::AsyncFileDialog::new()
        .set_title(title)
        .set_file_name(name)
        .add_filter(all, &extensions);
    for (name, extensions) in form.kind.formats() {
        dialog = dialog.add_filter(name, &extensions);
    }
    if let Some(folder) = path.parent().filter(|folder| folder.is_dir()) {
        dialog = dialog.set_directory(folder);
    }
    // The dialog must be made on the window's thread; waiting for it must not.
    let answer = dialog.save_file();
    Job::start(wake, move |_| {
        pollster::block_on(answer).map(|file| file.path().to_owned())
    })
}
