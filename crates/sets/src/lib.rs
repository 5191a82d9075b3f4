//! From parameters to a made, judged, certified set: what the command line, Python, the experiments and the window share.
//!
//! Begin with [`Recipe`]: with its radius and its pattern settled it is a [`Settled`] run, which makes a set. [`Made`] is the
//! set with its [`Facts`]: how it was made, and the domain and radius that a verdict on it is about. [`Facts::context`] is what
//! an export certifies.
//!
//! A set whose radius varies, or that covers a shape, is made from a [`VaryingRecipe`], a set of balls from a
//! [`SolidRecipe`]. [`thinning`] chooses from points that are there.
//!
//! The sampler and the verifier share nothing, so that they cannot be wrong together. Their types meet here: [`region()`] is
//! the sampler's domain as the verifier has it.
//!
//! ```
//! use tilescope_analysis::VerifyOptions;
//! use tilescope_core::{Parameters, Unobserved};
//! use tilescope_formats::export_bytes;
//! use tilescope_sets::Recipe;
//!
//! let go_on = |_| std::ops::ControlFlow::Continue(());
//! let recipe = Recipe::from(Parameters { radius: 0.05, ..Parameters::default() });
//! let made = recipe.settle(&mut Unobserved)?.parallel(true, &mut Unobserved)?;
//! assert!(made.judge(&VerifyOptions::default(), &go_on)?.valid());
//!
//! let exported = export_bytes("set.csv", &made.set, &made.facts.context(), &go_on)?;
//! assert_eq!(exported.certificate.parameters["radius"], 0.05);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod domain;
mod facts;
mod layout;
mod made;
mod recipe;
mod reference_pattern;
mod solid;
mod solid_window;
#[cfg(test)]
mod tests;
pub mod thinning;
mod varying;

pub use domain::{GivenDomain, KnownDomain, check_or_unit_square, region, region_in_radii};
#[cfg(not(target_arch = "wasm32"))]
pub use facts::named_by_content;
pub use facts::{Facts, Stated, stated};
pub use layout::{set_of_piece, stated_layout};
pub use made::{Made, point_set, provenance};
pub use recipe::{
    GivenPattern, Recipe, Settled, exact_pattern, exact_pays_from, exact_seconds, facts_of_exact,
    independent_samples, reference_seconds,
};
pub use reference_pattern::{ReferencePatternError, StatedSet};
pub use solid::{BallSize, SolidMade, SolidRecipe, columns_of};
pub use solid_window::SolidSurroundings;
pub use varying::{
    Brush, BrushStroke, ComputedPicture, DEFAULT_WHITE, ExactBlocks, Expression, GivenGround,
    GivenRadius, GrayImage, Ground, MAX_CORNERS, MAX_EXPRESSION, MAX_PIXELS, PAINTED, PaintedRadii,
    PlanarPolygon, RadiusGrid, RadiusSource, ShapeSource, Stipple, StippleLook, StippleRecipe,
    Tone, VaryingError, VaryingRecipe, WindowMade, check_pixels, check_white, color_of,
};
