//! The description of a combination: sets that a layout places side by side and glues along their seams. It is
//! shown as a session whose blocks are the pieces; [`crate::combining`] makes it.

use glam::DVec2;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use tilescope_core::combine::file::{Layout, LayoutError, PieceError, PieceSource, PlacedLayout};
use tilescope_core::combine::{CombineError, Seam};
use tilescope_core::{Domain, Rect, SampleError, Stage};

use crate::encoding::as_json;
use crate::units::{position, radii};
use crate::words::grouped;

/// The layout of the paper's figure 12: nine independent sets.
pub const NINE: &str = include_str!("../../../assets/layouts/nine.json");

/// The most samples of a combination in the window: the same limit as for a session file, since either can come
/// from anywhere.
pub const MAX_COMBINED: usize = tilescope_debugger::MAX_SAMPLES;

/// An action that makes a combination.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CombineCommand {
    /// Makes the one of figure 12.
    Nine,
    /// Makes the one that a layout's text describes; its sets cannot come from files, as the text has no
    /// folder.
    Text(String),
}

/// The description of a combination, which its session holds beside the run.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Combination {
    /// The layout as it was read or asked for.
    #[serde(with = "as_json")]
    pub layout: Layout,
    /// The layout as certificates state it: files without folders, with their digests.
    #[serde(with = "as_json")]
    pub stated: Value,
    /// The lines along which different sets meet.
    pub seams: Vec<Seam>,
    /// The area that gluing can have changed, as rectangles that do not overlap.
    pub band: Vec<Rect>,
    /// The seams as drawn: the ends of every line, in r. A seam on the border of a periodic domain is a line on
    /// both sides of it.
    pub lines: Vec<[DVec2; 2]>,
    /// The total length of the seams, in r.
    pub length: f64,
    /// The share of the domain that the band covers, from 0 to 1.
    pub in_reach: f64,
    /// The number of pieces that come from files.
    pub files: usize,
}

impl Combination {
    /// Returns the combination of a layout. `stated` is the layout as its certificate states it.
    #[must_use]
    pub fn of(
        layout: Layout,
        stated: Value,
        placed: &PlacedLayout,
        seams: Vec<Seam>,
        band: Vec<Rect>,
    ) -> Self {
        let domain = &placed.domain;
        let sources = placed.pieces.iter().map(|piece| &piece.source);
        let files = sources.filter(|source| is_file(source)).count();
        let area = |rect: &Rect| f64::from(rect.width()) * f64::from(rect.height());
        // A seam lies along an axis, so that one of the two differences is 0.
        let length = |seam: &Seam| radii(seam.to.x - seam.from.x + seam.to.y - seam.from.y);
        Self {
            lines: lines(domain, &seams),
            length: seams.iter().map(length).sum(),
            in_reach: band.iter().map(area).sum::<f64>() / area(&domain.rect()),
            files,
            layout,
            stated,
            seams,
            band,
        }
    }
}

/// Returns the seams as they are drawn, with those on a border of a periodic domain on both of its sides. A bounded domain has no
/// seams on its border.
fn lines(domain: &Domain, seams: &[Seam]) -> Vec<[DVec2; 2]> {
    let size = [domain.width(), domain.height()].map(radii);
    let mut lines = Vec::with_capacity(seams.len());
    for seam in seams {
        let line = [seam.from, seam.to].map(position);
        lines.push(line);
        for axis in 0..2 {
            // A seam on the left or lower border of a periodic domain is on the opposite one, too. No coordinate is
            // below 0.
            if line.iter().all(|end| end[axis] <= 0.0) {
                let mut other = line;
                for end in &mut other {
                    end[axis] += size[axis];
                }
                lines.push(other);
            }
        }
    }
    lines
}

/// Why a combination could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CombinationError {
    /// The layout is invalid.
    #[error(transparent)]
    Layout(#[from] LayoutError),
    /// The pieces cannot be glued.
    #[error(transparent)]
    Combine(#[from] CombineError),
    /// A set cannot be made, or the work was cancelled.
    #[error(transparent)]
    Sample(#[from] SampleError),
    /// It is too large for the window.
    #[error(
        "the layout makes about {} samples; the window combines at most {}, and the command line more",
        about(*expected),
        grouped(MAX_COMBINED)
    )]
    TooManySamples {
        /// The expected number of samples.
        expected: f64,
    },
    /// A set lies in a file, but the layout has no folder to read it from.
    #[error(
        "its set is in the file {path}, and files are read only with a layout that is in a file, too; sets by \"seed\" or \"parameters\" serve everywhere"
    )]
    NoFiles {
        /// The path as written in the layout.
        path: String,
    },
    /// A file cannot be used.
    #[error("{path}: {why}")]
    File {
        /// The path as written in the layout.
        path: String,
        /// The reason, as part of a sentence.
        why: String,
    },
    /// Something is wrong with a piece.
    #[error(transparent)]
    Piece(Box<PieceError<CombinationError>>),
}

/// Returns a number rounded to two significant digits, such as "3,100,000".
fn about(expected: f64) -> String {
    let unit = 10_f64.powi((expected.max(1.0).log10().floor() as i32 - 1).max(0));
    grouped(((expected / unit).round() * unit) as usize)
}

impl CombinationError {
    /// Returns the stage in which it was cancelled, if it was.
    #[must_use]
    pub fn cancelled(&self) -> Option<Stage> {
        match self {
            Self::Sample(SampleError::Cancelled { stage })
            | Self::Combine(CombineError::Sample(SampleError::Cancelled { stage })) => Some(*stage),
            Self::Piece(piece) => piece.error.cancelled(),
            // All other errors are faults of the layout or of its sets.
            _ => None,
        }
    }
}

fn is_file(source: &PieceSource) -> bool {
    matches!(source, PieceSource::File { .. })
}
