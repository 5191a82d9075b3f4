//! How a picture shows points as dots of ink on paper.

/// Dots on paper, with y upwards: the picture stands as the domain does.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// The colour of the paper: red, green and blue.
    pub paper: [u8; 3],
    /// The colour of the ink, likewise.
    pub ink: [u8; 3],
    /// How large the dots are.
    pub dots: Dots,
}

/// How large dots are, in domain units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Dots {
    /// All have this radius.
    Constant(f64),
    /// Their area is as the density of the points around them: this number, divided by the radius that keeps others away.
    ByDensity(f64),
}

impl Dots {
    /// Returns the radius of the dot of a point, whose own radius keeps others away.
    #[must_use]
    pub fn radius(self, own: f64) -> f64 {
        match self {
            Self::Constant(radius) => radius,
            Self::ByDensity(product) => product / own,
        }
    }
}

/// Returns "#rrggbb".
pub(super) fn hex([red, green, blue]: [u8; 3]) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}
