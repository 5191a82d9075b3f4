//! Exports as values: samples with a certificate, pictures and animations. An export goes through three files.
//! `state/export.rs` keeps the sheet and decides whether an export may begin; [`refusal`] lists the reasons for which it may
//! not. `write.rs` makes the files in the background. `state/export/outcome.rs` starts that and shows a notice at the end.

pub mod beside;
#[cfg(not(target_arch = "wasm32"))]
pub mod browse;
pub mod form;
pub mod frames;
mod ink;
pub mod picture;
mod provenance;
pub mod refusal;
pub mod write;

use std::path::{Path, PathBuf};

pub(crate) use provenance::provenance;
use tilescope_drawing::brushed::Cause;
use tilescope_drawing::orbit::OrbitView;
use tilescope_drawing::picture::{MomentView, PictureView};
use tilescope_session::moment::Moment;

use tilescope_formats::{Format, Precision};
use tilescope_sets::StippleLook;

use crate::clock::Clock;
pub use form::{ExportForm, NumberField};
pub use frames::MAX_FRAMES;
pub use ink::{InkCommand, InkForm};
pub use refusal::ExportRefusal;
use tilescope_session::task::SessionRef;

/// The kinds of exports.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize,
)]
#[serde(rename_all = "kebab-case")]
pub enum ExportKind {
    /// The samples of the result.
    #[default]
    Result,
    /// The samples that cover their disks at the moment.
    Samples,
    /// The view of the canvas.
    Picture,
    /// The scenes, each as a picture.
    Scenes,
    /// The view of the canvas during playback.
    Animation,
}

impl ExportKind {
    /// Every kind, in the sequence of the sheet.
    pub const ALL: [Self; 5] = [
        Self::Result,
        Self::Samples,
        Self::Picture,
        Self::Scenes,
        Self::Animation,
    ];

    /// Returns the name, as the sheet shows it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Result => "Result",
            Self::Samples => "Samples of this moment",
            Self::Picture => "Picture",
            Self::Scenes => "Scenes",
            Self::Animation => "Animation",
        }
    }

    /// Returns whether it is a set of samples, rather than a picture.
    #[must_use]
    pub const fn is_set(self) -> bool {
        matches!(self, Self::Result | Self::Samples)
    }

    /// Returns the extensions of its files, the default first.
    #[must_use]
    pub fn extensions(self) -> Vec<&'static str> {
        let formats = self.formats().into_iter();
        let mut extensions: Vec<_> = formats.flat_map(|(_, extensions)| extensions).collect();
        // Both PLY formats have the same one.
        extensions.dedup();
        extensions
    }

    /// Returns its formats by name, with their extensions.
    #[must_use]
    pub fn formats(self) -> Vec<(String, Vec<&'static str>)> {
        let named = |name: &str, extensions| (name.to_owned(), extensions);
        match self {
            Self::Result | Self::Samples => {
                let row = |format: &Format| (format.to_string(), vec![format.extension()]);
                Format::ALL.iter().map(row).collect()
            }
            Self::Picture | Self::Scenes => {
                vec![named("PNG", vec!["png"]), named("SVG", vec!["svg"])]
            }
            Self::Animation => vec![
                named("GIF", vec!["gif"]),
                named("Animated PNG", vec!["apng", "png"]),
            ],
        }
    }

    /// Returns the name of the format for a file name, or `None` if the extension is unknown.
    #[must_use]
    pub fn format(self, path: &Path) -> Option<String> {
        if self.is_set() {
            return Format::from_path(path).map(|format| format.to_string());
        }
        let found = extension(path)?;
        let mut formats = self.formats().into_iter();
        let format = formats.find(|(_, extensions)| extensions.contains(&found.as_str()));
        format.map(|(name, _)| name)
    }
}

/// Returns the extension of a path in lower case.
#[must_use]
pub fn extension(path: &Path) -> Option<String> {
    Some(path.extension()?.to_str()?.to_ascii_lowercase())
}

/// Returns the path of the picture of a scene, counted from 0, of `count` scenes: `talk.png` becomes `talk-07.png`.
pub(crate) fn scene_path(path: &Path, index: usize, count: usize) -> PathBuf {
    let digits = count.to_string().len();
    // The sheet refuses a path without a name, and adds an extension where there is none.
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let extension = extension(path).unwrap_or_default();
    path.with_file_name(format!("{stem}-{:0digits$}.{extension}", index + 1))
}

/// An action of the export sheet.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ExportCommand {
    /// Opens the sheet for a kind of export.
    Open(ExportKind),
    /// Closes the sheet; a running export continues.
    Close,
    /// Chooses another kind in the open sheet.
    Choose(ExportKind),
    /// Sets the path of the file.
    Path(String),
    /// Chooses the number type of coordinates.
    Precision(Precision),
    /// Sets the text of a number.
    Type(NumberField, String),
    /// Chooses whether a picture is coloured for print instead of as in the window.
    Print(bool),
    /// Chooses whether a legend is below a picture.
    Legend(bool),
    /// Chooses whether the analysis of the moment is beside a picture.
    Analysis(bool),
    /// Chooses whether an animation shows the whole run.
    WholeRun(bool),
    /// Chooses whether an animation of a set in space shows the passage of the plane, instead of events.
    Passage(bool),
    /// Chooses the clock that counts the frames of an animation.
    Clock(Clock),
    /// Chooses how a stipple is drawn.
    Ink(InkCommand),
    /// Asks for the file in the system's dialog.
    Browse,
    /// Writes the file. If that replaces another file, the first call only asks.
    Write,
    /// Cancels the running export; no file is left of it.
    Cancel,
}

/// Everything that an export needs. Later changes in the window do not affect it.
#[derive(Clone, serde::Serialize, serde::Deserialize)]
pub struct ExportJob {
    /// The path of the file to write; its extension chooses the format.
    pub path: PathBuf,
    /// The session whose samples or moments are exported.
    pub session: SessionRef,
    /// The content to write.
    pub content: ExportContent,
}

/// How a picture shows the balls of a set in space.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct BallsView {
    /// From where they are seen.
    pub view: OrbitView,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Whether the colours are those of the dark palette.
    pub is_dark: bool,
    /// A line above the picture; empty for none.
    pub caption: String,
    /// Whether the meaning of the colours stands below it.
    pub legend: bool,
}

/// The passage of the plane through a set in space.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct PassageView {
    /// The moment and the view of all frames, whatever the plane of the view.
    pub shown: MomentView,
    /// Pixels for a point of the window.
    pub scale: f64,
}

/// The content of an export.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum ExportContent {
    /// Samples: the result, or those of a moment.
    Samples {
        /// The moment; `None` for the result.
        moment: Option<Moment>,
        /// Number type of the coordinates, if the format leaves a choice.
        precision: Precision,
        /// How SVG shows a stipple, if it is one.
        look: Option<StippleLook>,
    },
    /// A picture of a stipple as dots of ink on paper.
    Dots {
        /// The moment.
        moment: Moment,
        /// The colours, and how large the dots are.
        look: StippleLook,
        /// The width in pixels; unused for SVG.
        columns: u32,
    },
    /// A picture of one moment.
    Picture {
        /// The moment and its view.
        shown: MomentView,
        /// The causes of the brush.
        causes: Option<Cause>,
        /// Pixels for a point of the window; unused for SVG.
        scale: f64,
    },
    /// The balls of a set in space.
    Balls {
        /// The view, of the first frame if they turn.
        shown: BallsView,
        /// Hundredths of a second for a frame of a turn; `None` for one picture.
        delay: Option<u16>,
    },
    /// An animation in which the plane passes through a set in space.
    Passage {
        /// The view of all frames.
        shown: PassageView,
        /// Hundredths of a second for a frame.
        delay: u16,
    },
    /// An animation in which the dots of a stipple appear in the order of their arrival, as ink on paper.
    Making {
        /// The colours, and how large the dots are.
        look: StippleLook,
        /// The width in pixels.
        columns: u32,
        /// Hundredths of a second for a frame.
        delay: u16,
    },
    /// A picture of each scene, in files whose names are numbered.
    Scenes {
        /// Their moments and views.
        shown: Vec<MomentView>,
        /// Pixels for a point of the window; unused for SVG.
        scale: f64,
    },
    /// An animation, with a frame for each cursor.
    Animation {
        /// The cursor of each frame.
        cursors: Vec<usize>,
        /// The view of all frames.
        view: PictureView,
        /// Pixels for a point of the window.
        scale: f64,
        /// Hundredths of a second for a frame.
        delay: u16,
        /// The clock whose ticks count the frames.
        clock: Clock,
        /// Ticks from frame to frame.
        every: usize,
    },
}
