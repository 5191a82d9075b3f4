//! The table of parameters: what each is called, what it may be, and how it is read and set. Form, links, command line,
//! Python and lessons read it, so that a new parameter is a field of [`Parameters`] and a row here.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Error, Value, json};

use super::{MAX_PATTERN_SIDE_RADII, MIN_LEAF_RADII, MIN_PATTERN_SIDE_RADII, Parameters};
use crate::lattice::SIDE_LIMITS;

/// The description of a parameter.
#[derive(Debug)]
pub struct ParameterRow {
    /// The parameter of this row.
    pub parameter: Parameter,
    /// Its name in options of the command line, in Python (with `_`) and in lessons.
    pub key: &'static str,
    /// The kind of its values, and where they are.
    pub kind: ParameterKind,
    /// The part of the window's form in which it stands.
    pub group: ParameterGroup,
    /// Its name beside a field, as it is written within a sentence.
    pub label: &'static str,
    /// Its meaning in the window, in a sentence or two. Empty for a term of the glossary, which defines it.
    pub meaning: &'static str,
    /// Its line in `--help`.
    pub help: &'static str,
    /// What stands for its value in `--help`; empty where none follows.
    pub value_name: &'static str,
}

/// The parts of the window's form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterGroup {
    /// The domain and the density of its samples.
    Domain,
    /// Blocks and their pattern.
    Tiling,
    /// The choices of elimination and insertion.
    Algorithm,
}

/// The values of a parameter, and how they are read and set.
#[derive(Debug)]
pub enum ParameterKind {
    /// A number with a fraction.
    Real {
        /// Its place among the parameters.
        place: fn(&mut Parameters) -> &mut f64,
        /// Its unit: "r", or "" for that of the user.
        unit: &'static str,
        /// The least and the largest that is valid with some other parameters.
        limits: [f64; 2],
    },
    /// A whole number of 64 bits, all of which are valid, by its place among the parameters.
    Whole(fn(&mut Parameters) -> &mut u64),
    /// Off or on, in this order.
    Switch {
        /// Its place among the parameters.
        place: fn(&mut Parameters) -> &mut bool,
        /// What it is to be off and on; their names are "no" and "yes".
        options: &'static [ParameterOption],
    },
    /// One of several values with names.
    Choice {
        /// The values and their names.
        options: &'static [ParameterOption],
        /// Returns the name of the present one.
        get: fn(&Parameters) -> Value,
        /// Sets the one of a name.
        set: fn(&mut Parameters, Value) -> Result<(), Error>,
    },
}

/// A value of a switch or a choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ParameterOption {
    /// Its name in JSON, links, lessons and Python.
    pub name: &'static str,
    /// Its name on the command line.
    pub word: &'static str,
    /// Its line in `--help`; empty if the help of the parameter says it.
    pub help: &'static str,
    /// Its name in the window.
    pub label: &'static str,
    /// Its meaning in the window, in a sentence.
    pub meaning: &'static str,
}

/// The smallest and the largest number above 0.
const POSITIVE: [f64; 2] = [f64::from_bits(1), f64::MAX];

/// Makes the table and [`Parameter`], of which each is a row.
macro_rules! parameters {
    ($(
        $parameter:ident, $key:literal, $group:ident, $kind:expr;
        $label:literal, $meaning:literal;
        $value_name:literal, $help:literal;
    )*) => {
        /// A parameter of a run. Its name in JSON is its key.
        #[derive(
            Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
        )]
        #[serde(rename_all = "kebab-case")]
        pub enum Parameter {
            $(
                #[doc = $help]
                $parameter,
            )*
        }

        /// Every parameter, in the order in which surfaces list them.
        pub static PARAMETERS: [ParameterRow; [$($key),*].len()] = [$(
            ParameterRow {
                parameter: Parameter::$parameter,
                key: $key,
                kind: $kind,
                group: ParameterGroup::$group,
                label: $label,
                meaning: $meaning,
                help: $help,
                value_name: $value_name,
            },
        )*];
    };
}

/// Makes the options of a parameter.
macro_rules! options {
    ($($name:literal $(as $word:literal)?, $help:literal; $label:literal, $meaning:literal;)*) => {
        &[$(
            ParameterOption {
                name: $name,
                // The word if there is one, otherwise the name: the last element of the list.
                word: [$name $(, $word)?][[$name $(, $word)?].len() - 1],
                help: $help,
                label: $label,
                meaning: $meaning,
            },
        )*]
    };
}

/// Makes a choice of a field's values.
macro_rules! choice {
    ($($field:ident).+; $($options:tt)*) => {
        ParameterKind::Choice {
            options: options!($($options)*),
            get: |p| json!(p.$($field).+),
            set: |p, value| read(&mut p.$($field).+, value),
        }
    };
}

/// Makes a switch of a field.
macro_rules! switch {
    ($($field:ident).+; $($options:tt)*) => {
        ParameterKind::Switch {
            options: options!($($options)*),
            place: |p| &mut p.$($field).+,
        }
    };
}

parameters! {
    // Parameter, key, part of the form, kind; label and meaning in the window; value and line in `--help`. Below a kind with
    // options, each of them: name, line in `--help`; label and meaning in the window.

    Width, "width", Domain, ParameterKind::Real { place: |p| &mut p.width, unit: "", limits: SIDE_LIMITS };
        "width", "The width of the domain, in the unit of your points. The height is beside it.";
        "W", "Width of the domain";

    Height, "height", Domain, ParameterKind::Real { place: |p| &mut p.height, unit: "", limits: SIDE_LIMITS };
        "height", "The height of the domain, in the unit of your points. The width is beside it.";
        "H", "Height of the domain";

    Radius, "radius", Domain, ParameterKind::Real { place: |p| &mut p.radius, unit: "", limits: POSITIVE };
        "radius", "";
        "R", "Poisson-disk radius, in user units";

    Boundary, "boundary", Domain, choice![boundary;
        "periodic", "Opposite sides are joined";
            "periodic", "Opposite sides are joined. The set tiles the plane.";
        "bounded", "The border is closed and must be covered";
            "bounded", "The domain ends at its border. Distances do not reach across it.";
    ];
        "boundary", "Periodic: opposite sides are joined, and the set tiles the plane. Bounded: the domain ends at its border.";
        "BOUNDARY", "How the domain ends";

    Seed, "seed", Tiling, ParameterKind::Whole(|p| &mut p.seed);
        "seed", "The number from which all random choices follow. The same seed gives the same points everywhere.";
        "S", "Seed of every draw: any 64-bit number";

    Method, "method", Tiling, choice![method;
        "kdrt", "Samples are clipped, conflicts eliminated and gaps filled";
            "KDRT", "The paper's method: samples are clipped, conflicts eliminated and gaps filled. Seams are a little denser.";
        "exact", "Darts are clipped with their order of arrival: no bias at seams";
            "exact tiling", "Darts are clipped with their order of arrival, and the one that came first stays. Seams have no bias.";
    ];
        "method", "What blocks clip from the pattern: its samples, as in the paper, or all of its darts with their order of arrival.";
        "METHOD", "What blocks clip";

    Leaf, "leaf", Tiling, ParameterKind::Real { place: |p| &mut p.leaf, unit: "r", limits: [MIN_LEAF_RADII, f64::MAX] };
        "smallest block", "";
        "LEAF", "Shortest edge of a building block, in radii: any number of at least 6";

    PatternSide, "pattern-side", Tiling, ParameterKind::Real {
        place: |p| &mut p.pattern.side, unit: "r", limits: [MIN_PATTERN_SIDE_RADII, MAX_PATTERN_SIDE_RADII],
    };
        "pattern size", "The side of the pattern from which every block is clipped, in r. A larger one repeats less and takes longer to make.";
        "SIDE", "Side of the generated pattern, in radii: from 10 to 2,000";

    PatternBoundary, "pattern-boundary", Tiling, choice![pattern.boundary;
        "periodic", "Opposite sides are joined";
            "periodic", "The pattern repeats, so that a clip may begin anywhere in it.";
        "bounded", "The border is closed and must be covered";
            "bounded", "As in the paper: a clip must lie inside the pattern.";
    ];
        "pattern border", "Whether the pattern repeats. A periodic one can be clipped anywhere; the paper uses a bounded one.";
        "PATTERN_BOUNDARY", "How the generated pattern ends: a bounded one is the paper's, and must be larger than every block";

    PatternSeed, "pattern-seed", Tiling, ParameterKind::Whole(|p| &mut p.pattern.seed);
        "pattern seed", "The seed of the pattern. Another one gives another pattern of the same size.";
        "S", "Seed of the generated pattern";

    Dihedral, "dihedral", Tiling, switch![dihedral;
        "no", "";
            "fixed", "All blocks clip from the pattern as it was made.";
        "yes", "";
            "random", "Each block clips from one of the pattern's 8 rotations and mirror images.";
    ];
        "orientation", "How the pattern lies where a block clips from it. Random rotations and mirrors repeat less.";
        "", "Clip from the pattern's 8 rotations and mirror images";

    Order, "order", Algorithm, choice![order;
        "index", "Block by block, row by row";
            "lower index", "The sample that was tiled first wins.";
        "random", "A random rank for each sample";
            "random", "The samples claim their disks in a random order.";
        "own-block-first", "Samples inside their own block before margin samples";
            "own block's", "A sample inside its own block wins against one from a margin.";
        "phase-group", "Four groups of far-apart cells in turn";
            "phase groups", "Four groups of cells that lie far apart take turns, in a random sequence.";
    ];
        "who wins", "Who wins a conflict: the sample that comes first in this order claims its disk, and the other one is eliminated.";
        "ORDER", "Order of elimination";

    Insertion, "insertion", Algorithm, choice![insertion;
        "circumcentre", "At uncovered circumcentres";
            "circumcentres", "The paper's way: the middle of the circle through three samples, slightly biased.";
        "uniform", "Uniformly within the gap; seams stay denser all the same";
            "uniform darts", "Random places in a gap, each as likely as any other. Seams stay denser all the same.";
    ];
        "insertion", "Where a gap is filled: at circumcentres (the paper, slightly biased) or by uniform darts. Seams stay denser with either.";
        "INSERTION", "How gaps are filled";

    Search, "search", Algorithm, choice![search;
        "complete" as "4", "";
            "4 r (complete)", "No gap can be missed.";
        "two-radii" as "2", "";
            "2 r (incomplete)", "The paper believes that this suffices. A few gaps stay open.";
    ];
        "gap search", "How far around itself a detector looks for gaps. 2 r is the paper's choice and misses a few.";
        "4|2", "How far gap detectors search, in radii: 4 is proven, 2 is an experiment that leaves gaps";

    Variant, "variant", Algorithm, choice![variant;
        "staged", "Elimination first, then insertion";
            "in stages", "All conflicts are resolved before the first gap is looked for.";
        "as-printed", "Interleaved";
            "as printed", "A sample looks for gaps as soon as it has claimed its disk.";
    ];
        "Algorithm 4", "Algorithm 4 in stages, elimination first, or as the paper prints it.";
        "VARIANT", "Staged, or Algorithm 4 as printed";
}

/// Sets a value to the one that JSON names. An error leaves it.
fn read<T: DeserializeOwned>(place: &mut T, value: Value) -> Result<(), Error> {
    *place = serde_json::from_value(value)?;
    Ok(())
}

impl Parameter {
    /// Returns every parameter, in the order in which surfaces list them.
    pub fn all() -> impl Iterator<Item = Self> + Clone {
        PARAMETERS.iter().map(|row| row.parameter)
    }

    /// Returns the row of the parameter.
    #[must_use]
    pub fn row(self) -> &'static ParameterRow {
        &PARAMETERS[self as usize]
    }

    /// Returns its name in options, in Python (with `_`) and in lessons.
    #[must_use]
    pub fn key(self) -> &'static str {
        self.row().key
    }

    /// Returns its values, if they have names, and nothing for a number.
    #[must_use]
    pub fn options(self) -> &'static [ParameterOption] {
        match &self.row().kind {
            ParameterKind::Switch { options, .. } | ParameterKind::Choice { options, .. } => {
                options
            }
            ParameterKind::Real { .. } | ParameterKind::Whole(_) => &[],
        }
    }

    /// Returns the option that is chosen, and none for a number.
    #[must_use]
    pub fn chosen(self, parameters: &Parameters) -> Option<&'static ParameterOption> {
        let value = self.value(parameters);
        let mut options = self.options().iter();
        options.find(|option| self.value_of(option) == value)
    }

    /// Returns its value as JSON: a number, a truth value or a name. It is null for a number that is not finite.
    #[must_use]
    pub fn value(self, parameters: &Parameters) -> Value {
        let mut copy = *parameters;
        match &self.row().kind {
            ParameterKind::Real { place, .. } => json!(*place(&mut copy)),
            ParameterKind::Whole(place) => json!(*place(&mut copy)),
            ParameterKind::Switch { place, .. } => json!(*place(&mut copy)),
            ParameterKind::Choice { get, .. } => get(parameters),
        }
    }

    /// Returns its value as it is typed: a number in digits, or the option's name on the command line.
    #[must_use]
    pub fn text(self, parameters: &Parameters) -> String {
        let mut copy = *parameters;
        match (&self.row().kind, self.chosen(parameters)) {
            (_, Some(option)) => option.word.to_owned(),
            // JSON writes 30 as 30.0.
            (ParameterKind::Real { place, .. }, None) => place(&mut copy).to_string(),
            (_, None) => self.value(parameters).to_string(),
        }
    }

    /// Sets its value as [`Self::value`] gives it. Values that are valid with no other parameters are not refused.
    ///
    /// # Errors
    ///
    /// If the value is of another type or has an unknown name; the parameters are then as before.
    pub fn set(self, parameters: &mut Parameters, value: Value) -> Result<(), Error> {
        match &self.row().kind {
            ParameterKind::Real { place, .. } => read(place(parameters), value),
            ParameterKind::Whole(place) => read(place(parameters), value),
            ParameterKind::Switch { place, .. } => read(place(parameters), value),
            ParameterKind::Choice { set, .. } => set(parameters, value),
        }
    }

    /// Returns an option's value as JSON.
    #[must_use]
    pub fn value_of(self, option: &ParameterOption) -> Value {
        match self.row().kind {
            ParameterKind::Switch { .. } => json!(option.name == "yes"),
            // A choice. Numbers have no options.
            _ => json!(option.name),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_stands_at_its_parameter_and_has_its_name() {
        for (index, row) in PARAMETERS.iter().enumerate() {
            assert_eq!(row.parameter as usize, index);
            assert_eq!(json!(row.parameter), row.key);
        }
    }

    #[test]
    fn the_rows_reach_every_field_and_each_its_own() {
        let mut reached = Parameters::default();
        for parameter in Parameter::all() {
            let before = serde_json::to_value(reached).unwrap();
            let value = match parameter.options().last() {
                Some(option) => parameter.value_of(option),
                None => json!(7),
            };
            parameter.set(&mut reached, value.clone()).unwrap();
            assert_eq!(
                parameter.value(&reached).to_string().trim_end_matches(".0"),
                value.to_string()
            );

            let after = serde_json::to_value(reached).unwrap();
            assert_eq!(changes(&before, &after), 1, "{parameter:?}");
        }
        let defaults = serde_json::to_value(Parameters::default()).unwrap();
        let all = serde_json::to_value(reached).unwrap();
        assert_eq!(changes(&defaults, &all), PARAMETERS.len());
        assert_eq!(
            leaves(&all),
            PARAMETERS.len(),
            "a field of the parameters has no row"
        );
    }

    fn leaves(value: &Value) -> usize {
        value
            .as_object()
            .map_or(1, |fields| fields.values().map(leaves).sum())
    }

    fn changes(before: &Value, after: &Value) -> usize {
        match (before.as_object(), after.as_object()) {
            (Some(before), Some(after)) => before
                .iter()
                .map(|(key, value)| changes(value, &after[key]))
                .sum(),
            _ => usize::from(before != after),
        }
    }

    #[test]
    fn every_option_has_the_name_of_its_value_and_no_other_name_is_taken() {
        let mut parameters = Parameters::default();
        for parameter in Parameter::all() {
            for option in parameter.options() {
                let value = parameter.value_of(option);
                parameter.set(&mut parameters, value).unwrap();
                assert_eq!(parameter.chosen(&parameters), Some(option));
            }
            let before = parameters;
            parameter.set(&mut parameters, json!("?")).unwrap_err();
            assert_eq!(parameters, before);
        }
    }

    #[test]
    fn numbers_beyond_their_limits_are_never_valid() {
        for row in &PARAMETERS {
            let ParameterKind::Real { place, limits, .. } = &row.kind else {
                continue;
            };
            let [least, largest] = *limits;
            for wrong in [least.next_down(), largest.next_up(), f64::NAN] {
                let mut parameters = Parameters::default();
                *place(&mut parameters) = wrong;
                assert!(parameters.validate().is_err(), "{} {wrong}", row.key);
            }
        }
    }
}
