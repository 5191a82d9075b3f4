//! Why a scene cannot become a picture, and the limits behind that.
//!
//! Both exporters check the same things, so a scene that one refuses the other refuses too. Shapes
//! outside the picture are no error: they are not seen.

/// The largest side of a picture in pixels: viewers and the rasteriser's 16.16 fixed-point edges end there.
pub const MAX_SIDE: f64 = 32_768.0;

/// The largest number of pixels, 2^28 (16,384 x 16,384): 1 GiB while rasterising.
pub const MAX_PIXELS: u64 = 1 << 28;

/// The largest radius, stroke width, marker or letter in pixels: three times the largest picture. Positions may be
/// anywhere; parts far outside are cut off.
pub const MAX_LENGTH: f64 = 100_000.0;

/// The largest number of columns or rows of a bitmap.
pub const MAX_BITMAP_SIDE: usize = 4096;

/// Why there is no picture.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// A side is NaN, below one pixel or above the limit.
    #[error(
        "a picture of {width} x {height} pixels cannot be made; each side must be 1 to {MAX_SIDE}"
    )]
    Size {
        /// Width in pixels, the scale applied.
        width: f64,
        /// Height in pixels, the scale applied.
        height: f64,
    },
    /// The scale is NaN, infinite or not above 0.
    #[error("the scale is {0}; it must be finite and above 0")]
    Scale(f64),
    /// Both sides are fine and the area is not.
    #[error("a picture of {pixels} pixels needs too much memory; the limit is {MAX_PIXELS}")]
    Pixels {
        /// Width times height, in pixels.
        pixels: u64,
    },
    /// A coordinate or length of a shape is NaN or infinite.
    #[error("shape {index} of group \"{group}\" has a coordinate or length that is not finite")]
    NotFinite {
        /// Name of the group that has the shape.
        group: String,
        /// Index of the shape in its group.
        index: usize,
    },
    /// A radius, stroke width, marker or text size is out of proportion to any picture.
    #[error(
        "shape {index} of group \"{group}\" has a length of {length} pixels; the limit is {MAX_LENGTH}"
    )]
    Length {
        /// Name of the group that has the shape.
        group: String,
        /// Index of the shape in its group.
        index: usize,
        /// The length in pixels, the scale applied.
        length: f64,
    },
    /// The pixels of a bitmap do not fill its rows, or are too many.
    #[error(
        "a bitmap of {bytes} bytes in rows of {row} cannot be made; they must fill 1 to {MAX_BITMAP_SIDE} rows of as many pixels \
         at most"
    )]
    Bitmap {
        /// Bytes of all pixels.
        bytes: usize,
        /// Bytes of a row.
        row: usize,
    },
    /// A group's view or clip rectangle is NaN or infinite, or its scale not above 0.
    #[error(
        "the view or clip rectangle of group \"{group}\" is not finite, or its scale not above 0"
    )]
    View {
        /// Name of the group with that view.
        group: String,
    },
    /// A font of the program does not parse: a damaged build.
    #[error("the font {0} is damaged")]
    Font(&'static str),
    /// The control function asked to stop.
    #[error("the picture was cancelled")]
    Cancelled,
    /// A chart of the picture could not be drawn, for the reason of its `ChartError`.
    #[error("{0}")]
    Chart(String),
    /// The PNG encoder refused.
    #[error("the PNG could not be encoded: {0}")]
    Encode(String),
}
