//! The content of a link, as values. `write.rs` writes it as text, `read.rs` reads it.

use tilescope_classroom::lessons::WantedLesson;
use tilescope_core::combine::file::Layout as Combination;
use tilescope_core::{NestedRequest, Parameters, radius_estimate};
use tilescope_debugger::{SavedBreakpoint, SavedScene};
use tilescope_session::ground::{GroundRequest, PortableGround};
use tilescope_session::recipe::Recipe;

use super::text::{escaped, rings_text};
use super::{MAX_GROUND, MAX_SAMPLES};
use crate::view::SavedView;

/// How a link names a moment of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum NamedMoment {
    /// The end of the run.
    #[default]
    End,
    /// After this many events, or of nested levels this many samples.
    Event(usize),
    /// Of nested levels, the samples with ranks below this number.
    Rank(f64),
    /// After the stage of this name.
    Stage(String),
}

/// The content of a link: the input of a run, and its view.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LinkContent {
    /// The parameters of the run, where one is shown.
    pub parameters: Parameters,
    /// The levels, if nested ones are shown instead of a run.
    pub nested: Option<NestedRequest>,
    /// The field and the shape, if the radius depends on the place or the domain is a shape.
    pub ground: Option<GroundRequest>,
    /// Whether the set that is shown has a field or a shape that no link holds, so that the link leads to another set.
    pub lacks_ground: bool,
    /// The third side in user units, if a set in space is shown.
    pub depth: Option<f64>,
    /// The layout of the combination, if one is shown instead of a run.
    pub combination: Option<Combination>,
    /// The moment that is shown.
    pub moment: NamedMoment,
    /// The view of that moment.
    pub view: SavedView,
    /// The breakpoints, also those that are disabled.
    pub breakpoints: Vec<SavedBreakpoint>,
    /// The watched expressions, as typed.
    pub watches: Vec<String>,
    /// The user's scenes, with their views.
    pub scenes: Vec<SavedScene>,
    /// The lesson that is opened instead of a run.
    pub lesson: Option<WantedLesson>,
    /// The language of lessons, "en" or "de"; None for the reader's own.
    pub language: Option<String>,
}

impl LinkContent {
    /// Returns the recipe of its run.
    #[must_use]
    pub fn recipe(&self) -> Recipe {
        Recipe {
            parameters: self.parameters,
            own: None,
            nested: self.nested,
            ground: self.ground.clone().map(Box::new),
            depth: self.depth,
        }
    }
}

/// Returns whether a link may ask for the number of samples of nested levels, if that is given.
pub(crate) fn allows(nested: &NestedRequest) -> bool {
    nested
        .exactly
        .is_none_or(|count| count as f64 <= MAX_SAMPLES)
}

/// Returns whether a link may hold a field and a shape: without images, and not too long.
pub(crate) fn carries(ground: &GroundRequest) -> bool {
    PortableGround::of(ground).is_some_and(|portable| {
        // Marks of a formula take three characters of a link each. Those of corners are not escaped.
        let formula = portable.radius_expression.as_deref().unwrap_or_default();
        escaped(formula).len() + rings_text(&portable.rings).len() <= MAX_GROUND
    })
}

/// Returns the recipe as a link has it: if the number of samples is given, with a radius that suits it. The radius is not used
/// then, and might be one that no link may ask for.
pub(crate) fn normal(recipe: Recipe) -> Recipe {
    let exactly = recipe.nested.and_then(|nested| nested.exactly);
    let suited = exactly.and_then(|count| radius_estimate(&recipe.parameters, count as u64).ok());
    // The radius is rounded to four digits, as the window shows it.
    let rounded = suited.and_then(|radius| format!("{radius:.3e}").parse().ok());
    let radius = rounded.unwrap_or_else(|| linked_radius(&recipe));
    Recipe {
        parameters: Parameters {
            radius,
            ..recipe.parameters
        },
        ..recipe
    }
}

/// Returns the radius of a recipe as a link has it. Where a formula or an image gives the radii, no sample depends on
/// the recipe's own radius. A link might not be allowed to ask for that radius, and then has another one instead.
fn linked_radius(recipe: &Recipe) -> f64 {
    let Parameters {
        width,
        height,
        radius,
        ..
    } = recipe.parameters;
    let gives_radii = |it: &GroundRequest| it.radius.is_some() || it.stipple.is_some();
    let is_used = !recipe.ground.as_deref().is_some_and(gives_radii);
    // Every link may ask for a radius with 50 r or more in the shorter side and at most about 70,000 samples, 0.7 on
    // each r x r. These bounds are well within those of links; chosen, not measured.
    let suits = width.min(height) >= 50.0 * radius && width * height <= 1e5 * radius * radius;
    if is_used || suits {
        return radius;
    }
    // Otherwise the radius is a hundredth of the shorter side, with four digits. A square of that radius has about
    // 7,000 samples; chosen, not measured.
    let suited = format!("{:.3e}", width.min(height) / 100.0).parse();
    suited.unwrap_or(radius)
}
