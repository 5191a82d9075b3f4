//! The meanings of the fields of the parameter form, and the options of its lists, each with its name and its meaning.

use tilescope_core::{Boundary, Insertion, Order, Search, Variant, WithinLevel};
use tilescope_session::glossary;
use tilescope_workbench::draft::Field;

/// An option of a list: its value, name and meaning.
pub type Listed<T> = (T, &'static str, &'static str);

/// The borders of the domain.
pub const BOUNDARIES: [Listed<Boundary>; 2] = [
    (
        Boundary::Periodic,
        "periodic",
        "Opposite sides are joined. The set tiles the plane.",
    ),
    (
        Boundary::Bounded,
        "bounded",
        "The domain ends at its border. Distances do not reach across it.",
    ),
];

/// The borders of the pattern.
pub const PATTERN_BOUNDARIES: [Listed<Boundary>; 2] = [
    (
        Boundary::Periodic,
        "periodic",
        "The pattern repeats, so that a clip may begin anywhere in it.",
    ),
    (
        Boundary::Bounded,
        "bounded",
        "As in the paper: a clip must lie inside the pattern.",
    ),
];

/// Whether the pattern is turned and mirrored.
pub const ORIENTATIONS: [Listed<bool>; 2] = [
    (
        false,
        "fixed",
        "All blocks clip from the pattern as it was made.",
    ),
    (
        true,
        "random",
        "Each block clips from one of the pattern's 8 rotations and mirror images.",
    ),
];

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

/// The orders of the samples within a level.
pub const WITHIN: [Listed<WithinLevel>; 2] = [
    (WithinLevel::Random, "random", "By a draw for each place."),
    (
        WithinLevel::Farthest,
        "farthest first",
        "Each sample is the one that is farthest from all before it.",
    ),
];

/// Who wins a conflict.
pub const ORDERS: [Listed<Order>; 4] = [
    (
        Order::OwnBlockFirst,
        "own block's",
        "A sample inside its own block wins against one from a margin.",
    ),
    (
        Order::Index,
        "lower index",
        "The sample that was tiled first wins.",
    ),
    (
        Order::Random,
        "random",
        "The samples claim their disks in a random order.",
    ),
    (
        Order::PhaseGroup,
        "phase groups",
        "Four groups of cells that lie far apart take turns, in a random sequence.",
    ),
];

/// Where gaps are filled.
pub const INSERTIONS: [Listed<Insertion>; 2] = [
    (
        Insertion::Circumcentre,
        "circumcentres",
        "The paper's way: the middle of the circle through three samples, slightly biased.",
    ),
    (
        Insertion::Uniform,
        "uniform darts",
        "Random places in the gaps, each as likely as any other.",
    ),
];

/// How far detectors look.
pub const SEARCHES: [Listed<Search>; 2] = [
    (Search::Complete, "4 r (complete)", "No gap can be missed."),
    (
        Search::TwoRadii,
        "2 r (incomplete)",
        "The paper believes that this suffices. A few gaps stay open.",
    ),
];

/// The variants of Algorithm 4.
pub const VARIANTS: [Listed<Variant>; 2] = [
    (
        Variant::Staged,
        "in stages",
        "All conflicts are resolved before the first gap is looked for.",
    ),
    (
        Variant::AsPrinted,
        "as printed",
        "A sample looks for gaps as soon as it has claimed its disk.",
    ),
];

/// Returns what a field means, in a sentence or two.
pub const fn meaning(field: Field) -> &'static str {
    match field {
        Field::Width => {
            "The width of the domain, in the unit of your points. The height is beside it."
        }
        Field::Height => {
            "The height of the domain, in the unit of your points. The width is beside it."
        }
        Field::Radius => glossary::RADIUS.meaning,
        Field::Seed => {
            "The number from which all random choices follow. The same seed gives the same points everywhere."
        }
        Field::Leaf => glossary::LEAF.meaning,
        Field::PatternSide => {
            "The side of the pattern from which every block is clipped, in r. A larger one repeats less and takes longer to make."
        }
        Field::PatternSeed => {
            "The seed of the pattern. Another one gives another pattern of the same size."
        }
    }
}
