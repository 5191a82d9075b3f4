//! About how many samples a polygon asks for: cheap enough to be asked for in each frame of a window.

use tilescope_sets::{RadiusSource, VaryingRecipe};

/// The columns and the rows of places at which a polygon is looked at. Chosen, not measured.
const LOOKS: usize = 48;

/// The most corners of a polygon that is looked at in each frame; of longer ones the rectangle around them is taken.
/// Chosen, not measured.
const MAX_LOOKED_AT: usize = 500;

/// Returns about how many samples there are in a polygon, from the radii at some places in it. `None` for rings without
/// a corner or with many, for a recipe without a size or an origin, and where the radius is neither a constant nor an
/// expression.
pub(super) fn samples_in_polygon(recipe: &VaryingRecipe, rings: &[Vec<[f64; 2]>]) -> Option<f64> {
    let corners: usize = rings.iter().map(Vec::len).sum();
    if !(1..=MAX_LOOKED_AT).contains(&corners) {
        return None;
    }
    let radius_at = |x: f64, y: f64| match &recipe.radius {
        RadiusSource::Constant(radius) => Some(*radius),
        RadiusSource::Expression { expression, scale } => Some(scale * expression.at(x, y)),
        RadiusSource::Image { .. } | RadiusSource::Density { .. } | RadiusSource::Grid { .. } => {
            None
        }
    };

    let ([Some(width), Some(height)], [left, bottom]) = (recipe.size, recipe.origin?) else {
        return None;
    };
    // A place stands for the rectangle around it.
    let step = [width, height].map(|side| side / LOOKS as f64);
    let mut sum = 0.0;
    for row in 0..LOOKS {
        for column in 0..LOOKS {
            let x = left + (column as f64 + 0.5) * step[0];
            let y = bottom + (row as f64 + 0.5) * step[1];
            // Holes and the area beyond the outline ask for no samples.
            if is_inside(rings, [x, y]) {
                // The samples per area go with the inverse square of the radius.
                sum += radius_at(x, y)?.powi(-2);
            }
        }
    }
    Some(tilescope_core::MAXIMAL_DENSITY * sum * step[0] * step[1])
}

/// Returns whether rings wind around a place an odd number of times.
fn is_inside(rings: &[Vec<[f64; 2]>], [x, y]: [f64; 2]) -> bool {
    let mut is_odd = false;
    for ring in rings {
        for (from, to) in ring.iter().zip(ring.iter().cycle().skip(1)) {
            // An edge without its upper end, so that a corner counts once.
            if (from[1] <= y) != (to[1] <= y) {
                let share = (y - from[1]) / (to[1] - from[1]);
                is_odd ^= x < from[0] + share * (to[0] - from[0]);
            }
        }
    }
    is_odd
}
