//! How dots of a stipple are drawn, between Python and the formats.

use tilescope_formats::{Dots, Drawing};

/// How dots are drawn, as the Python class `Stipple` holds it: paper, ink, and the radius of the dots, or, if their areas
/// follow the darkness, its product with the radius of the sample.
pub type DrawingFields = (Color, Color, bool, f64);

/// Red, green and blue.
type Color = (u8, u8, u8);

/// Returns how dots are drawn, as the formats take it.
pub fn drawing((paper, ink, by_density, number): DrawingFields) -> Drawing {
    let dots = if by_density {
        Dots::ByDensity(number)
    } else {
        Dots::Constant(number)
    };
    Drawing {
        paper: paper.into(),
        ink: ink.into(),
        dots,
    }
}

/// Returns how dots are drawn, as Python keeps it.
pub fn fields_of(drawing: &Drawing) -> DrawingFields {
    let (by_density, number) = match drawing.dots {
        Dots::Constant(radius) => (false, radius),
        Dots::ByDensity(product) => (true, product),
    };
    (drawing.paper.into(), drawing.ink.into(), by_density, number)
}
