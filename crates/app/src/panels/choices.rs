//! The meanings of the fields of the parameter form, and the options of its lists, each with its name and its meaning.

use tilescope_core::{Parameter, ParameterOption, Parameters, WithinLevel};
use tilescope_session::draft::RadiusBy;
use tilescope_session::glossary;

/// An option of a list: its value, name and meaning.
pub type Listed<T> = (T, &'static str, &'static str);

/// The numbers of nested levels.
pub const LEVELS: [Listed<Option<u32>>; 12] = [
    (None, "none", "A run: one maximal set."),
    (Some(1), "1", "One maximal set in an order."),
    (Some(2), "2", "The radius of the first is 1.41 r."),
    (Some(3), "3", "The radius of the first is 2 r."),
    (Some(4), "4", "The radius of the first is 2.83 r."),
    (Some(5), "5", "The radius of the first is 4 r."),
    (Some(6), "6", "The radius of the first is 5.66 r."),
    (Some(7), "7", "The radius of the first is 8 r."),
    (Some(8), "8", "The radius of the first is 11.3 r."),
    (Some(9), "9", "The radius of the first is 16 r."),
    (Some(10), "10", "The radius of the first is 22.6 r."),
    (Some(11), "11", "The radius of the first is 32 r."),
];

/// How many of [`RADIUS_BY`] need no image.
pub const WITHOUT_IMAGE: usize = 2;

/// The ways in which the radius is given; those of an image come last.
pub const RADIUS_BY: [Listed<RadiusBy>; 5] = [
    (
        RadiusBy::Constant,
        "a number",
        "The same radius everywhere.",
    ),
    (
        RadiusBy::Expression,
        "a formula",
        "A function of the place: the reference sampler throws darts, the denser the smaller the radius.",
    ),
    (
        RadiusBy::Image,
        "grey of an image",
        "From the radius of black to that of white.",
    ),
    (
        RadiusBy::Density,
        "dark of an image",
        "Samples are as dense as the image is dark.",
    ),
    (
        RadiusBy::Stipple,
        "dots of an image",
        "A stipple: exactly so many dots, as dense as the image is dark. Any beginning of them is the image with fewer dots.",
    ),
];

/// The ways in which a shape of one radius is made, by the names of methods. Darts stand in the place of KDRT, which makes no
/// shapes.
pub const SHAPE_BY: [Listed<&str>; 2] = [
    (
        "kdrt",
        "darts",
        "The reference sampler throws darts, without tiling.",
    ),
    (
        "exact",
        "exact tiling",
        "Blocks of one pattern: darts outside of the shape do not exist, so that its border is one more seam.",
    ),
];

/// What the formula of the radius may have.
pub const FORMULA: &str = "The radius as a function of x and y, such as 0.006 + 0.024*x, with + - * / ^ pi abs atan2 cos exp floor hypot log max min pow sin sqrt tanh.";

/// The orders of the samples within a level.
pub const WITHIN: [Listed<WithinLevel>; 2] = [
    (WithinLevel::Random, "random", "By a draw for each place."),
    (
        WithinLevel::Farthest,
        "farthest first",
        "Each sample is the one that is farthest from all before it.",
    ),
];

/// Returns the options of a parameter.
pub fn options(parameter: Parameter) -> Vec<Listed<&'static ParameterOption>> {
    let default = parameter.chosen(&Parameters::default());
    let all = parameter.options().iter();
    let mut options: Vec<_> = all.map(|it| (it, it.label, it.meaning)).collect();
    // The default is looked for first.
    options.sort_by_key(|(option, ..)| Some(*option) != default);
    options
}

/// Returns what a parameter means, in a sentence or two.
pub fn meaning(parameter: Parameter) -> &'static str {
    match parameter {
        // These names are terms that the glossary defines.
        Parameter::Radius => glossary::RADIUS.meaning,
        Parameter::Leaf => glossary::LEAF.meaning,
        other => other.row().meaning,
    }
}
