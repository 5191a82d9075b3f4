//! Why a layout cannot serve.

use thiserror::Error;

use super::{MAX_LAYOUT_BYTES, VERSION};
use crate::combine::CombineError;
use crate::error::ParameterError;
use crate::parameters::MAX_SEQUENTIAL_SAMPLES;

/// Why a layout, or a piece of one, cannot serve.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum LayoutError {
    /// It is too long.
    #[error("the layout has {bytes} bytes; it may have {MAX_LAYOUT_BYTES}")]
    TooLong {
        /// Its length.
        bytes: u64,
    },
    /// It is something else.
    #[error("this is no layout of pieces: {0}")]
    NoLayout(serde_json::Error),
    /// It is of another version.
    #[error("the layout has version {version}; this program reads version {VERSION}")]
    Version {
        /// Its version.
        version: u32,
    },
    /// It has another form.
    #[error("{0}")]
    Form(serde_json::Error),
    /// Neither or both ways to give rectangles.
    #[error("either \"columns\" and \"rows\" or \"width\" and \"height\" must be given")]
    GridOrSize,
    /// There is not one piece for each rectangle.
    #[error(
        "{columns} columns and {rows} rows make {rectangles} rectangles; there are {pieces} pieces"
    )]
    Count {
        /// Columns.
        columns: usize,
        /// Rows.
        rows: usize,
        /// Their product.
        rectangles: usize,
        /// Pieces.
        pieces: usize,
    },
    /// A column or row has no length.
    #[error("{name}[{index}] is {side}; it must be a finite number above 0")]
    Side {
        /// "columns" or "rows".
        name: &'static str,
        /// Which of them.
        index: usize,
        /// Its length.
        side: f64,
    },
    /// More samples than there may be.
    #[error(
        "about {expected:.3e} samples would be made; there may be {MAX_SEQUENTIAL_SAMPLES:.0e}"
    )]
    TooManySamples {
        /// How many.
        expected: f64,
    },
    /// A rectangle where columns and rows give it.
    #[error("a \"rect\" has no place in a layout of columns and rows")]
    RectInGrid,
    /// No rectangle where nothing else gives it.
    #[error("\"rect\" is missing; the layout has no columns and rows")]
    NoRect,
    /// A rectangle that is none, or not in the domain.
    #[error(
        "the rect [{}, {}, {}, {}] is empty or not inside {} x {}",
        rect[0], rect[1], rect[2], rect[3], size[0], size[1]
    )]
    Rect {
        /// The rectangle: lowest corner, highest corner.
        rect: [f64; 4],
        /// The domain's sides.
        size: [f64; 2],
    },
    /// A piece has no source, or several.
    #[error("a piece is one of \"file\", \"parameters\" and \"seed\"")]
    NoSource,
    /// What describes a file, without one.
    #[error("\"radius\", \"width\" and \"height\" belong to a \"file\"")]
    OfFile,
    /// A method without a seed.
    #[error("\"method\" belongs to a \"seed\"")]
    OfSeed,
    /// Two boundaries.
    #[error("the \"boundary\" of a set by \"parameters\" is one of these")]
    OfParameters,
    /// An offset in a set that is made for its rectangle.
    #[error("a set by \"seed\" is made for its rectangle and has no \"offset\"")]
    OffsetOfSeed,
    /// An offset outside its set.
    #[error("the offset {value} is not inside the set, which is {side} long")]
    Offset {
        /// The offset.
        value: f64,
        /// The set's side.
        side: f64,
    },
    /// Some of three lengths that belong together.
    #[error("width, height and radius must be given together, or not at all")]
    Lengths,
    /// A parameter that there is not.
    #[error("there is no parameter \"{name}\"")]
    UnknownParameter {
        /// Its name.
        name: String,
    },
    /// A parameter that is none.
    #[error("{name}: {error}")]
    ParameterForm {
        /// Where.
        name: &'static str,
        /// What is wrong.
        error: serde_json::Error,
    },
    /// Parameters that cannot be sampled.
    #[error(transparent)]
    Parameters(#[from] ParameterError),
    /// Rectangles that do not partition the domain.
    #[error(transparent)]
    Combine(#[from] CombineError),
    /// Something is wrong with a piece.
    #[error("pieces[{piece}]: {error}")]
    Piece {
        /// The piece, counted from 0.
        piece: usize,
        /// What is wrong.
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
