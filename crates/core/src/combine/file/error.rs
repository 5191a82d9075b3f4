//! Errors of layouts.

use thiserror::Error;

use super::{MAX_LAYOUT_BYTES, VERSION};
use crate::combine::CombineError;
use crate::error::ParameterError;
use crate::parameters::MAX_SEQUENTIAL_SAMPLES;

/// An error of a layout or of one of its pieces.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LayoutError {
    /// It is too long.
    #[error("the layout has {bytes} bytes; it may have {MAX_LAYOUT_BYTES}")]
    TooLong {
        /// The length of the file.
        bytes: u64,
    },
    /// It is not a layout.
    #[error("this is not a layout of pieces: {0}")]
    NoLayout(serde_json::Error),
    /// It is of another version.
    #[error("the layout has version {version}; this program reads version {VERSION}")]
    Version {
        /// The version of the file.
        version: u32,
    },
    /// It has another form.
    #[error("{0}")]
    Form(serde_json::Error),
    /// Rectangles are given in both ways or in neither.
    #[error("either \"columns\" and \"rows\" or \"width\" and \"height\" must be given")]
    GridOrSize,
    /// The numbers of pieces and of rectangles differ.
    #[error(
        "{columns} columns and {rows} rows make {rectangles} rectangles; there are {pieces} pieces"
    )]
    Count {
        /// The number of columns.
        columns: usize,
        /// The number of rows.
        rows: usize,
        /// The number of rectangles that these make.
        rectangles: usize,
        /// The number of pieces.
        pieces: usize,
    },
    /// A column or row has no length.
    #[error("{name}[{index}] is {side}; it must be a finite number above 0")]
    Side {
        /// The name of the list: "columns" or "rows".
        name: &'static str,
        /// Its index in the list.
        index: usize,
        /// The length that the file gives.
        side: f64,
    },
    /// There would be too many samples.
    #[error(
        "about {expected:.3e} samples would be made; there may be {MAX_SEQUENTIAL_SAMPLES:.0e}"
    )]
    TooManySamples {
        /// The number of samples that is expected.
        expected: f64,
    },
    /// A rectangle is given although columns and rows give it.
    #[error("a \"rect\" has no place in a layout of columns and rows")]
    RectInGrid,
    /// A rectangle is missing.
    #[error("\"rect\" is missing; the layout has no columns and rows")]
    NoRect,
    /// A rectangle is empty or not in the domain.
    #[error(
        "the rect [{}, {}, {}, {}] is empty or not inside {} x {}",
        rect[0], rect[1], rect[2], rect[3], size[0], size[1]
    )]
    Rect {
        /// The rectangle: lowest corner, highest corner.
        rect: [f64; 4],
        /// The sides of the domain.
        size: [f64; 2],
    },
    /// A piece has no source, or several.
    #[error("a piece is one of \"file\", \"parameters\" and \"seed\"")]
    NoSource,
    /// Values that describe a file are given without a file.
    #[error("\"radius\", \"width\" and \"height\" belong to a \"file\"")]
    OfFile,
    /// A method is given without a seed.
    #[error("\"method\" belongs to a \"seed\"")]
    OfSeed,
    /// The boundary is given twice.
    #[error("the \"boundary\" of a set by \"parameters\" is one of these")]
    OfParameters,
    /// An offset is given for a set that is made for its rectangle.
    #[error("a set by \"seed\" is made for its rectangle and has no \"offset\"")]
    OffsetOfSeed,
    /// An offset lies outside its set.
    #[error("the offset {value} is not inside the set, which is {side} long")]
    Offset {
        /// The coordinate that the file gives.
        value: f64,
        /// The side of the set on the same axis.
        side: f64,
    },
    /// Only some of width, height and radius are given.
    #[error("width, height and radius must be given together, or not at all")]
    Lengths,
    /// A parameter is unknown.
    #[error("there is no parameter \"{name}\"")]
    UnknownParameter {
        /// The name that the file gives.
        name: String,
    },
    /// A parameter does not parse.
    #[error("{name}: {error}")]
    ParameterForm {
        /// Where in the file.
        name: &'static str,
        /// The error of the JSON reader.
        error: serde_json::Error,
    },
    /// Parameters cannot be sampled.
    #[error(transparent)]
    Parameters(#[from] ParameterError),
    /// The rectangles do not partition the domain.
    #[error(transparent)]
    Combine(#[from] CombineError),
    /// Something is wrong with a piece.
    #[error("pieces[{piece}]: {error}")]
    Piece {
        /// The piece, counted from 0.
        piece: usize,
        /// The error of that piece.
        error: Box<LayoutError>,
    },
}

impl LayoutError {
    /// Returns the error as one of a piece.
    pub(super) fn of_piece(self, piece: usize) -> Self {
        let error = Box::new(self);
        Self::Piece { piece, error }
    }
}
