//! What leaves the window as a file: samples with a certificate, pictures and animations. Formats and figures write;
//! here it is said what of the session they are given.

#[cfg(not(target_arch = "wasm32"))]
pub mod browse;
mod drawing;
pub mod form;
pub mod frames;
pub mod picture;
mod provenance;
pub mod refusal;
mod surface;
pub mod write;

use std::path::{Path, PathBuf};
use tilescope_drawing::brushed::Cause;
use tilescope_session::moment::Moment;

use tilescope_formats::{Format, Precision};

use crate::clock::Clock;
pub use form::{ExportForm, NumberField};
pub use frames::MAX_FRAMES;
pub use picture::PictureView;
pub use refusal::ExportRefusal;
use tilescope_session::task::SessionRef;

/// What can be written.
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
    /// What the canvas shows.
    Picture,
    /// What the canvas shows while time goes on.
    Animation,
}

impl ExportKind {
    /// Every kind.
    pub const ALL: [Self; 4] = [Self::Result, Self::Samples, Self::Picture, Self::Animation];

    /// Returns its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Result => "Result",
            Self::Samples => "Samples of this moment",
            Self::Picture => "Picture",
            Self::Animation => "Animation",
        }
    }

    /// Returns whether it is a set of samples, rather than a picture.
    #[must_use]
    pub const fn is_set(self) -> bool {
        matches!(self, Self::Result | Self::Samples)
    }

    /// Returns the extensions of its files, the one to begin with first.
    #[must_use]
    pub fn extensions(self) -> Vec<&'static str> {
        match self {
            Self::Result | Self::Samples => {
                // Both PLY formats have the same one.
                let formats = Format::ALL.iter().filter(|f| **f != Format::PlyAscii);
                formats.map(|format| format.extension()).collect()
            }
            Self::Picture => vec!["png", "svg"],
            Self::Animation => vec!["gif", "apng", "png"],
        }
    }

    /// Returns its formats by name, with their extensions.
    #[must_use]
    pub fn formats(self) -> Vec<(String, Vec<&'static str>)> {
        let named = |name: &str, extensions| (name.to_owned(), extensions);
        match self {
            Self::Result | Self::Samples => {
                let formats = Format::ALL.iter();
                formats
                    .map(|format| (format.to_string(), vec![format.extension()]))
                    .collect()
            }
            Self::Picture => vec![named("PNG", vec!["png"]), named("SVG", vec!["svg"])],
            Self::Animation => vec![
                named("GIF", vec!["gif"]),
                named("Animated PNG", vec!["apng", "png"]),
            ],
        }
    }

    /// Returns the name of the format that a file of this name gets, or `None` if it cannot be written.
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

/// Returns the extension of a path in small letters.
#[must_use]
pub fn extension(path: &Path) -> Option<String> {
    Some(path.extension()?.to_str()?.to_ascii_lowercase())
}

/// An action of the export sheet.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ExportCommand {
    /// Opens the sheet.
    Open(ExportKind),
    /// Closes the sheet; an export at work goes on.
    Close,
    /// Chooses what to write.
    Choose(ExportKind),
    /// Types the name of the file.
    Path(String),
    /// Chooses the number type of coordinates.
    Precision(Precision),
    /// Types a number.
    Type(NumberField, String),
    /// Chooses whether a picture is coloured for print instead of as in the window.
    Print(bool),
    /// Chooses what the frames of an animation are counted in.
    Clock(Clock),
    /// Asks for the file in the system's dialog.
    Browse,
    /// Writes the file; the first time it only asks, where that would replace another file.
    Write,
    /// Stops the export at work; no file is left of it.
    Cancel,
}

/// All that an export needs to know, so that the window may go on meanwhile.
#[derive(Clone, serde::Serialize, serde::Deserialize)]
pub struct ExportJob {
    /// The file.
    pub path: PathBuf,
    /// The session.
    pub session: SessionRef,
    /// What to write.
    pub content: ExportContent,
}

/// What is written.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum ExportContent {
    /// Samples: the result, or those of a moment.
    Samples {
        /// The moment, if not the result.
        moment: Option<Moment>,
        /// Number type of the coordinates, where the format leaves the choice.
        precision: Precision,
    },
    /// A picture.
    Picture {
        /// The moment.
        moment: Moment,
        /// What of it is seen.
        view: PictureView,
        /// The causes of what is brushed.
        causes: Option<Cause>,
        /// Pixels of the file for a point of the window; SVG has none.
        scale: f64,
    },
    /// An animation.
    Animation {
        /// The cursor of each frame.
        cursors: Vec<usize>,
        /// What is seen.
        view: PictureView,
        /// Pixels for a point of the window.
        scale: f64,
        /// Hundredths of a second for a frame.
        delay: u16,
        /// How the frames were counted off: ticks of this clock.
        clock: Clock,
        /// Ticks from frame to frame.
        every: usize,
    },
}
