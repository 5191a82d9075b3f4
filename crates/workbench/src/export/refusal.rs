//! The reasons for which an export does not begin, as sentences for the user. `state/export.rs` decides on them, and
//! `form.rs` for names and numbers as typed. An export that fails after it has begun has a `WriteError` (`write.rs`).

use std::path::PathBuf;

use tilescope_session::words::{counted, grouped};

use super::beside::MAX_MEASURED;
use super::form::{MAX_COLUMNS, MAX_DELAY_MS, MAX_EVERY, MAX_SCALE, MIN_DELAY_MS, MIN_SCALE};
use super::frames::MAX_FRAMES;
use super::picture::MAX_DRAWN;

/// Why an export is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ExportRefusal {
    /// There is no session.
    #[error("There is no session yet.")]
    NoSession,
    /// Animations need events, and this session has kept none.
    #[error(
        "This session was made without events, so that there is no time to animate: runs of more than {} samples keep their result alone.",
        grouped(tilescope_session::limits::MAX_STAGED as usize)
    )]
    NoEvents,
    /// Animations need events, and a combination has none.
    #[error("A combination has stages but no events, so that there is no time to animate.")]
    Combination,
    /// Animations need events, and nested levels have none.
    #[error("Nested levels have no events, so that there is no time to animate.")]
    Nested,
    /// The format holds no set in space; its reason.
    #[error("{0}")]
    NotInSpace(String),
    /// The analysis beside a picture is that of planar sets.
    #[error("The analysis is that of planar sets, and this set is in space: leave it out.")]
    SolidAnalysis,
    /// No sample covers its disk.
    #[error("No sample covers its disk at this moment.")]
    NoSamples,
    /// There is no scene whose moment is in this run.
    #[error("There are no scenes of this run: B makes one.")]
    NoScenes,
    /// No file was named.
    #[error("Name a file.")]
    NoName,
    /// The file would be in a folder that does not exist.
    #[error("There is no folder \"{}\".", .0.display())]
    NoFolder(PathBuf),
    /// The extension is none of these.
    #[error("The extension chooses the format: {}.", .0.iter().map(|e| format!(".{e}")).collect::<Vec<_>>().join(" "))]
    Extension(Vec<&'static str>),
    /// A colour as typed is none.
    #[error("The colour is \"{0}\"; it must be written as #rrggbb, or as black or white.")]
    Color(String),
    /// The width of a picture as typed is not a whole number within the limits.
    #[error(
        "The width is \"{0}\" pixels; it must be a whole number from 1 to {most}.",
        most = grouped(MAX_COLUMNS as usize)
    )]
    Columns(String),
    /// The scale as typed is not a number within the limits.
    #[error("The scale is \"{0}\"; it must be a number from {MIN_SCALE} to {MAX_SCALE}.")]
    Scale(String),
    /// The number of ticks from frame to frame, as typed, is not a whole number within the limits.
    #[error(
        "A frame for every \"{0}\" steps: it must be a whole number from 1 to {most}.",
        most = grouped(MAX_EVERY)
    )]
    Every(String),
    /// The time for a frame, as typed, is not within the limits.
    #[error(
        "The delay is \"{0}\" ms; it must be a whole number from {MIN_DELAY_MS} to {most}.",
        most = grouped(MAX_DELAY_MS as usize)
    )]
    Delay(String),
    /// The range is empty.
    #[error("The range from event {} to event {} is empty: there is nothing to animate.", grouped(*.start), grouped(*.end))]
    EmptyRange {
        /// The cursor where it begins.
        start: usize,
        /// The cursor where it ends, or that of the last event.
        end: usize,
    },
    /// There would be too many frames.
    #[error(
        "These are {} frames; the limit is {MAX_FRAMES}. A frame for every {} steps or more would do.",
        grouped(*.frames), grouped(*.enough)
    )]
    TooManyFrames {
        /// The number of them.
        frames: usize,
        /// The smallest number of ticks between frames that keeps the limit.
        enough: usize,
    },
    /// The analysis of this many pictures would take too long.
    #[error(
        "The analysis of {} with {} samples measures {} samples; the limit is {}. Fewer pictures, or none with the analysis, would do.",
        counted(*.pictures, "picture", "pictures"), grouped(*.samples),
        grouped(.pictures.saturating_mul(*.samples)), grouped(MAX_MEASURED)
    )]
    TooMuchMeasured {
        /// The number of pictures, or of an animation's frames.
        pictures: usize,
        /// Samples of the finished set.
        samples: usize,
    },
    /// The picture, or a frame, would have too many pixels.
    #[error(
        "A picture of {} x {} pixels is too large; the limit is {} pixels and {} on a side. A smaller scale would do.",
        grouped(*.width), grouped(*.height), grouped(*.pixels), grouped(*.side)
    )]
    TooLarge {
        /// The picture's width in pixels.
        width: usize,
        /// The picture's height in pixels.
        height: usize,
        /// The largest number of pixels in all.
        pixels: usize,
        /// The largest number of pixels on a side.
        side: usize,
    },
    /// About this many samples are in view.
    #[error(
        "About {} samples are in view; pictures draw {} at most. Zoom in.",
        grouped(*.0), grouped(MAX_DRAWN)
    )]
    TooManySamples(usize),
    /// The canvas has not been shown yet.
    #[error("There is no canvas to take the picture from.")]
    NoCanvas,
}
