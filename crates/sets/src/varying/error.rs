//! Why a field or a shape is refused: each names the value, the limit and what helps.

use std::ops::RangeInclusive;

use thiserror::Error;
use tilescope_analysis::{Number, VerifyError};
use tilescope_core::{FieldError, ParameterError, SampleError, ShapeError};

use super::image::MAX_PIXELS;
use super::polygon::MAX_CORNERS;

/// Why a set of varying radius, or in a shape, is not made or not judged.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum VaryingError {
    /// An expression is not understood.
    #[error("the expression cannot be read at character {at}: {reason}")]
    Expression {
        /// The place, from 1.
        at: usize,
        /// The fault at that place, in words.
        reason: String,
    },
    /// A radius is not a positive number.
    #[error(
        "the radius is {} at ({}, {}); it must be above 0 everywhere in the domain",
        Number(*.radius), Number(.place[0]), Number(.place[1])
    )]
    Radius {
        /// The value of the field there.
        radius: f64,
        /// The first place that has it.
        place: [f64; 2],
    },
    /// Radii differ too much.
    #[error(
        "the radius goes from {} to {}, {:.1} times as much; at most {limit:.1} times is possible{}",
        Number(*.least), Number(*.greatest), .greatest / .least, beside_pixels(*.allowing)
    )]
    Contrast {
        /// The least radius of the field.
        least: f64,
        /// The greatest radius of the field.
        greatest: f64,
        /// The largest possible quotient.
        limit: f64,
        /// The next larger radius that would be the least of a quotient of 64, where the pixels make the limit smaller.
        allowing: Option<f64>,
    },
    /// Exact tiling is asked for with a radius that varies.
    #[error("exact tiling has one radius everywhere; leave out what makes it vary, or the method")]
    ExactRadius,
    /// Two radii are in the wrong order.
    #[error("the radii are {} to {}; the first must be above 0 and no more than the second", Number(.radii[0]), Number(.radii[1]))]
    Reversed {
        /// The radii of black and of white.
        radii: [f64; 2],
    },
    /// The radius is too small for the pitch of the field.
    #[error(
        "the least radius is {}, and nodes are {} apart; at least {} is needed, 1/32 of that",
        Number(*.least), Number(*.pitch), Number(.pitch / 32.0)
    )]
    Fine {
        /// The least radius of the field.
        least: f64,
        /// The distance between nodes.
        pitch: f64,
    },
    /// An image cannot be used.
    #[error("{name}: {reason}")]
    Image {
        /// The name of its file.
        name: String,
        /// The fault, and a remedy.
        reason: String,
    },
    /// An image has too many pixels.
    #[error(
        "{name}: the image has {columns} x {rows} pixels; from 1 to {MAX_PIXELS} in all are possible"
    )]
    Pixels {
        /// The name of its file.
        name: String,
        /// How many pixels a row has.
        columns: u32,
        /// How many pixels a column has.
        rows: u32,
    },
    /// A number of a tone is out of range.
    #[error("the {name} is {value}; it must be from {} to {}", .range.start(), .range.end())]
    Tone {
        /// The name of the number.
        name: &'static str,
        /// The value that was given.
        value: f64,
        /// The values that are possible.
        range: RangeInclusive<f64>,
    },
    /// Blocks of pixels do not fill an image.
    #[error("blocks of {block} x {block} pixels do not fill {} x {}", .pixels[0], .pixels[1])]
    Block {
        /// The side of a block.
        block: usize,
        /// The pixels of a row and of a column.
        pixels: [usize; 2],
    },
    /// No pixel of an image is dark enough for dots.
    #[error(
        "{name}: no place of the image is darker than white ({white} of black), so that it has no dots; make it darker, or white less"
    )]
    White {
        /// The name of its file.
        name: String,
        /// The darkness below which there are no dots.
        white: f64,
    },
    /// Pixels would not be squares.
    #[error(
        "{} x {} pixels do not fit a domain of {} x {}: pixels must be squares; leave out a side, and it follows",
        .pixels[0], .pixels[1], Number(.size[0]), Number(.size[1])
    )]
    Aspect {
        /// The pixels of a row and of a column.
        pixels: [usize; 2],
        /// The domain's width and height.
        size: [f64; 2],
    },
    /// The values of a grid are no whole rows.
    #[error(
        "{count} values are no rows of {columns}; there must be at least one row of at least one value"
    )]
    Grid {
        /// How many there are.
        count: usize,
        /// How many a row has.
        columns: usize,
    },
    /// A density is no number from 0.
    #[error(
        "the density is {} in column {} of row {}; it must be a finite number of at least 0",
        Number(*.density), .place[0], .place[1]
    )]
    Density {
        /// The first such value.
        density: f64,
        /// Its column and its row.
        place: [usize; 2],
    },
    /// A density is 0 everywhere.
    #[error("the density is 0 everywhere; it must be above 0 somewhere")]
    NoDensity,
    /// A density is that of a white image.
    #[error(
        "{name}: the image is white everywhere, so that it asks for no samples; make it darker"
    )]
    Blank {
        /// The name of its file.
        name: String,
    },
    /// Two images differ in size.
    #[error(
        "one image has {} x {} pixels and the other {} x {}: they must be equal",
        .first[0], .first[1], .second[0], .second[1]
    )]
    Sizes {
        /// The pixels of one.
        first: [usize; 2],
        /// The pixels of the other.
        second: [usize; 2],
    },
    /// A side of a periodic domain is no multiple of a distance between nodes.
    #[error(
        "a periodic domain of {} x {} has no common pitch for a field: the ratio of its sides must be that of whole numbers up to {limit}; a bounded one may have any",
        Number(.size[0]), Number(.size[1])
    )]
    Ratio {
        /// The domain's width and height.
        size: [f64; 2],
        /// The largest number of nodes of a side.
        limit: usize,
    },
    /// A polygon cannot be used.
    #[error("{name}: {reason}")]
    Polygon {
        /// The name of its file.
        name: String,
        /// The fault, and a remedy.
        reason: String,
    },
    /// A polygon has too many corners.
    #[error("{name}: the polygons have {corners} corners; at most {MAX_CORNERS} are possible")]
    Corners {
        /// The name of its file.
        name: String,
        /// Corners of all rings.
        corners: usize,
    },
    /// Coordinates are perhaps longitudes and latitudes.
    #[error(
        "{name}: all corners lie within 180 and 90, such as ({}, {}), as longitudes and latitudes do; lengths in degrees are no distances: project them to a plane, for example to UTM",
        Number(.corner[0]), Number(.corner[1])
    )]
    Degrees {
        /// The name of its file.
        name: String,
        /// A corner beyond the unit square.
        corner: [f64; 2],
    },
    /// No place of the domain belongs to the shape.
    #[error("the shape has no place in the domain, so that there is nothing to cover")]
    Nothing,
    /// A window is to have the scale at which the whole set has a number of samples.
    #[error(
        "the scale of the radii at which the set has {count} samples is only found by making the whole set, which a window does without: give the radii themselves"
    )]
    WindowCount {
        /// The number of samples that was asked for.
        count: u64,
    },
    /// A certificate needs a file that is not given.
    #[error(
        "the certificate states {what} from {file}, which must be given to judge the set: {option} {file}"
    )]
    Needed {
        /// A field or a mask.
        what: &'static str,
        /// The name of the file as it is stated.
        file: String,
        /// The option that gives it.
        option: &'static str,
    },
    /// A certificate states radii of an array or a function, which only Python can be given.
    #[error(
        "the certificate states a field from an array or a function (`{name}`), which only Python can be given to judge the set"
    )]
    NeedsGrid {
        /// The parameter that states it.
        name: &'static str,
    },
    /// A certificate states radii of points, and not of places.
    #[error(
        "the certificate states the radius of each point, by the column {column}, and no radius between the points"
    )]
    NoPlaces {
        /// The name of the column.
        column: String,
    },
    /// A certificate does not say from what the field was made.
    #[error("the certificate does not say how its field or its shape was made: {0}")]
    Unstated(String),
    /// No scale of the radii gives the count.
    #[error("no radii give {count} samples to within a hundredth; the nearest were {nearest}")]
    Count {
        /// How many were asked for.
        count: u64,
        /// How many were made.
        nearest: u64,
    },
    /// No scale of the radii gives as many samples, of which the first could be kept.
    #[error("no radii give {samples} samples or a few more; the nearest were {nearest}")]
    Exactly {
        /// How many were asked for.
        samples: u64,
        /// How many were made.
        nearest: u64,
    },
    /// So few samples are asked for that the domain is too short for their radii.
    #[error(
        "{samples} samples are too few for the domain: its {name} must be at least {} times the least of their radii; choose more samples",
        Number(*.minimum)
    )]
    Few {
        /// How many were asked for.
        samples: u64,
        /// The name of the side that is too short: "width" or "height".
        name: &'static str,
        /// The limit in the least radius.
        minimum: f64,
    },
    /// The first samples of an exact tiling are asked for.
    #[error(
        "exact tiling keeps its samples in no order of arrival, so that the first of them are not spread over the shape; leave the method out"
    )]
    ExactOrder,
    /// The domain is refused.
    #[error(transparent)]
    Domain(#[from] ParameterError),
    /// The field is refused.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// The shape is refused.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// The judge refuses field or shape.
    #[error(transparent)]
    Judge(#[from] VerifyError),
    /// No pixels fill a domain.
    #[error(
        "the domain is {} x {}; to be painted, a field needs square pixels that fill it, at most {limit} along the longer side",
        Number(.size[0]), Number(.size[1])
    )]
    Unsquare {
        /// Width and height of the domain.
        size: [f64; 2],
        /// The most pixels along the longer side.
        limit: usize,
    },
    /// The sampler refused the parameters, or was cancelled.
    #[error(transparent)]
    Sample(#[from] SampleError),
}

impl VaryingError {
    /// Whether a side of the domain is too short for the radii.
    pub(super) const fn is_of_short_side(&self) -> bool {
        matches!(self, Self::Domain(ParameterError::SideTooShort { .. }))
    }

    /// Returns the error of a set whose radii follow from a number of samples: where a side is too short for them, the number is
    /// named, since no radius was given that could be chosen smaller.
    pub(super) fn of_count(self, samples: u64) -> Self {
        match self {
            Self::Domain(ParameterError::SideTooShort { name, minimum, .. }) => Self::Few {
                samples,
                name,
                minimum,
            },
            other => other,
        }
    }
}

/// Says why radii beside pixels may differ by less than 64 times, and which least radius would allow as much.
fn beside_pixels(allowing: Option<f64>) -> String {
    let reason = |radius: f64| {
        format!(
            " with pixels of this width: a pixel is a power of two of lattice units wide, so that the least radius has more units than it \
             needs; a least radius of {} allows 64 times",
            Number(radius)
        )
    };
    allowing.map(reason).unwrap_or_default()
}
