//! What a run's samples lie in, which decides which of its numbers mean something at every moment.

use tilescope_analysis::measures::{
    CATALOGUE, Part, SPACE_CATALOGUE, SetNumber, number, space_number,
};
use tilescope_analysis::{LiveSquares, VaryingRegion};

/// What the samples of a run lie in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Setting {
    /// A rectangle of one radius, or a torus.
    Rectangle,
    /// A polygon or the pixels of a mask, of one radius.
    Shape,
    /// A field of radii, perhaps in a shape.
    Field,
    /// A box in space.
    Space,
}

impl Setting {
    /// Returns that of a planar set in a field or a shape.
    #[must_use]
    pub const fn of_ground(has_one_radius: bool) -> Self {
        if has_one_radius {
            Self::Shape
        } else {
            Self::Field
        }
    }

    /// Returns that of a set in space or of one in a rectangle.
    #[must_use]
    pub const fn of_box(is_in_space: bool) -> Self {
        if is_in_space {
            Self::Space
        } else {
            Self::Rectangle
        }
    }

    /// Returns its place in messages.
    #[must_use]
    pub const fn place(self) -> &'static str {
        match self {
            Self::Rectangle => "in the plane",
            Self::Shape => "in a shape",
            Self::Field => "where the radius varies",
            Self::Space => "in space",
        }
    }

    /// Returns the number with a key that every moment of such a run has.
    #[must_use]
    pub fn number(self, key: &str) -> Option<&'static SetNumber> {
        match self {
            Self::Space => space_number(key),
            Self::Rectangle | Self::Shape | Self::Field => {
                number(key).filter(|number| is_live(number) && self.defines(number))
            }
        }
    }

    /// Returns the numbers that every moment of such a run has, in the sequence of tables.
    pub fn numbers(self) -> impl Iterator<Item = &'static SetNumber> {
        let catalogue = match self {
            Self::Space => SPACE_CATALOGUE,
            Self::Rectangle | Self::Shape | Self::Field => CATALOGUE,
        };
        // By its key a number is looked up as it is in this setting, which leaves out those that mean nothing here.
        let keys = catalogue.iter().map(|number| number.key);
        keys.filter_map(move |key| self.number(key))
    }

    /// Returns whether a planar number means something in it.
    #[must_use]
    pub fn defines(self, number: &SetNumber) -> bool {
        match self {
            Self::Rectangle => true,
            // Subdivision finds out whether a place is covered, and not how far its nearest sample is. The smooth spectrum, cells
            // and discrepancies are defined in a rectangle or a torus. The spectrum is of all samples, and is called global.
            Self::Shape => is_live(number) && number.key != "covering_radius_r",
            // Counts and the density are by the radius at each place. Of the numbers of the spectrum all but the slope have
            // limits in 1 / r, and there is no r.
            Self::Field => {
                const BY_PLACE: [&str; 5] =
                    ["samples", "density", "conflicts", "gaps", "spectral_slope"];
                BY_PLACE.contains(&number.key)
            }
            Self::Space => false,
        }
    }
}

/// Returns whether a number is read from what live measures give.
pub const fn is_live(number: &SetNumber) -> bool {
    match number.needs {
        None | Some(Part::Report | Part::Spectrum) => true,
        Some(
            Part::Pairs
            | Part::Distances
            | Part::Rough
            | Part::Smooth
            | Part::Cells
            | Part::Discrepancy,
        ) => false,
    }
}

/// A field or a shape in which samples come and go, before there is one.
#[derive(Clone, Debug)]
pub struct LiveGround {
    /// The squares of its judge, without samples.
    pub squares: LiveSquares,
    /// The only radius, or the least, in user units.
    pub radius: f64,
    /// The area that is to be covered, as a report has it.
    pub area: f64,
    /// Whether all places have the same radius.
    pub has_one_radius: bool,
}

impl LiveGround {
    /// Returns the field or the shape in which a set is judged; `None` if the radius is so steep that too many squares would
    /// have to be kept.
    #[must_use]
    pub fn of(judged: &VaryingRegion) -> Option<Self> {
        Some(Self {
            squares: judged.live()?,
            radius: judged.radius(),
            area: judged.area(),
            has_one_radius: judged.has_one_radius(),
        })
    }
}
