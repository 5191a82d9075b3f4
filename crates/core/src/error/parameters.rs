//! Errors of parameters, with one variant for each cause, with the value and the limit.

use std::fmt;

use thiserror::Error;

use crate::words::grouped;

/// From this size on the decimals of a number say nothing beside a limit.
const WITHOUT_DECIMALS: f64 = 1e6;

/// Displays a number: with an exponent if it would have very many digits, otherwise with commas between thousands.
struct Number(f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Very small and very large numbers would have long rows of zeros: they are written with an exponent. The two
        // bounds are chosen, not measured.
        let size = self.0.abs();
        let is_short = (1e-5..1e16).contains(&size) || size == 0.0;
        if !is_short {
            return write!(f, "{:e}", self.0);
        }

        let sign = if self.0 < 0.0 { "-" } else { "" };
        if size >= WITHOUT_DECIMALS {
            return write!(f, "{sign}{}", grouped(size.round() as u64));
        }

        // Only the digits before the point are grouped by thousands.
        let text = size.to_string();
        let (whole, decimals) = text.split_at(text.find('.').unwrap_or(text.len()));
        let whole = whole.parse().map_or_else(|_| whole.to_owned(), grouped);
        write!(f, "{sign}{whole}{decimals}")
    }
}

/// Displays a length that is beyond a limit: with the fewest decimals, two or more, that still show on which side of the limit it
/// lies.
struct Beyond {
    length: f64,
    limit: f64,
}

impl fmt::Display for Beyond {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let side = self.length.partial_cmp(&self.limit);
        // As many decimals as needed for the text to be on the same side of the limit. Seventeen suffice for any two
        // numbers near 1.
        let rounded = (2..=17)
            .filter_map(|decimals| format!("{:.decimals$}", self.length).parse::<f64>().ok())
            // A length above 0 is not shown as 0.
            .find(|rounded| *rounded != 0.0 && rounded.partial_cmp(&self.limit) == side);
        Number(rounded.unwrap_or(self.length)).fmt(f)
    }
}

/// Rounds a least length in r up to a decimal, so that the length displayed suffices.
fn rounded_up(least: f64) -> Number {
    Number((least * 10.0).ceil() / 10.0)
}

/// Why parameters are refused. Lengths "in r" are multiples of the Poisson-disk radius.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ParameterError {
    /// The radius is not a positive finite number.
    #[error("the radius is {}; it must be a finite number above 0", Number(*.radius))]
    Radius {
        /// The value as given.
        radius: f64,
    },
    /// A side of the domain is not a number within [`crate::SIDE_LIMITS`].
    #[error(
        "the {name} is {}; it must be a number between {shortest:.1e} and {longest:.1e}",
        Number(*.side)
    )]
    Side {
        /// The name of the side: "width", "height" or "depth".
        name: &'static str,
        /// The value as given.
        side: f64,
        /// The lower limit, in user units.
        shortest: f64,
        /// The upper limit, in user units.
        longest: f64,
    },
    /// A side is too short for its radius.
    #[error(
        "the {name} is {} r long; it must be at least {} r: choose a smaller radius",
        Beyond { length: *.radii, limit: *.minimum },
        Number(*.minimum)
    )]
    SideTooShort {
        /// The name of the side: "width", "height" or "depth".
        name: &'static str,
        /// Its length in radii.
        radii: f64,
        /// The limit in radii.
        minimum: f64,
    },
    /// A side is too long for its radius.
    #[error(
        "the {name} is {} r long; it must be at most {} r: choose a larger radius",
        Beyond { length: *.radii, limit: *.maximum },
        Number(*.maximum)
    )]
    SideTooLong {
        /// The name of the side: "width", "height" or "depth".
        name: &'static str,
        /// Its length in radii.
        radii: f64,
        /// The limit in radii.
        maximum: f64,
    },
    /// A box is too large for its radius.
    #[error(
        "the box holds {} cubes of side r; it must hold at most {}: choose a larger radius",
        Number(.volume.round()),
        Number(*.maximum)
    )]
    Volume {
        /// Its volume in cubed radii.
        volume: f64,
        /// The limit in cubed radii.
        maximum: f64,
    },
    /// The leaf is not a finite number of at least 6.
    #[error("the leaf is {} r; it must be a finite number of at least {minimum} r", Number(*.leaf))]
    Leaf {
        /// The value as given, in radii.
        leaf: f64,
        /// The limit in radii.
        minimum: f64,
    },
    /// The pattern's side is out of range.
    #[error(
        "the pattern's side is {} r; it must be between {} r and {} r",
        Number(*.side),
        Number(*.minimum),
        Number(*.maximum)
    )]
    PatternSide {
        /// The value as given, in radii.
        side: f64,
        /// The lower limit in radii.
        minimum: f64,
        /// The upper limit in radii.
        maximum: f64,
    },
    /// Algorithm 4 as printed inserts circumcentres only.
    #[error(
        "uniform insertion needs the staged variant; Algorithm 4 as printed inserts circumcentres"
    )]
    UniformAsPrinted,
    /// Algorithm 4 as printed is one loop over all samples.
    #[error(
        "the parallel engine runs the staged variant; Algorithm 4 as printed needs the sequential engine"
    )]
    AsPrintedParallel,
    /// Exact tiling has no choice of this kind.
    #[error(
        "the {name} has no meaning in exact tiling, which keeps whatever arrived first; leave it at its default"
    )]
    NotOfExact {
        /// The parameter's name in options, in Python and in lessons.
        name: &'static str,
    },
    /// Engines of KDRT clip samples, and exact tiling clips darts.
    #[error("only KDRT can be used here, not exact tiling")]
    ExactByKdrt,
    /// A pattern that is given has samples, and exact tiling clips darts.
    #[error(
        "exact tiling takes darts, and here a pattern from a file has only samples: choose the side and the seed of a pattern instead, or KDRT"
    )]
    ExactOfSamples,
    /// A window is empty, or larger than the domain.
    #[error(
        "the window's {name} runs from {} to {}; it must be finite, above 0 and at most {} long",
        Number(*.low), Number(*.high), Number(*.maximum)
    )]
    Window {
        /// The name of the side: "width", "height" or "depth".
        name: &'static str,
        /// Where it begins, in user units.
        low: f64,
        /// Where it ends, in user units.
        high: f64,
        /// The side of the domain, in user units.
        maximum: f64,
    },
    /// A window lies so far from the domain that rounding would change it.
    #[error(
        "the window's {name} begins at {}; it must begin between {} and {}",
        Number(*.low), Number(-.limit), Number(*.limit)
    )]
    FarWindow {
        /// The name of the side: "width", "height" or "depth".
        name: &'static str,
        /// Where it begins, in user units.
        low: f64,
        /// The limit on either side of 0.
        limit: f64,
    },
    /// A corner of a window in space lies farther from the origin than lattice points are counted.
    #[error(
        "the window's {name} reaches {}; it must lie between {} and {}",
        Number(*.at), Number(-.limit), Number(*.limit)
    )]
    FarCorner {
        /// The name of the side: "width", "height" or "depth".
        name: &'static str,
        /// Where the corner lies, in user units.
        at: f64,
        /// The limit on either side of 0.
        limit: f64,
    },
    /// More samples than a set may have that is made as a whole, whatever engine makes it.
    #[error(
        "about {samples:.3e} samples would result; a set that is made as a whole has at most {maximum:.0e}: choose a larger radius"
    )]
    TooManySamples {
        /// The number of samples that is expected.
        samples: f64,
        /// The largest number of samples.
        maximum: f64,
    },
    /// A wanted number of samples is out of range.
    #[error(
        "{} samples were asked for; with these sides it must be between {} and {}",
        grouped(*.count), grouped(*.minimum), grouped(*.maximum)
    )]
    Count {
        /// The number of samples that was asked for.
        count: u64,
        /// The fewest that the sides allow.
        minimum: u64,
        /// The most that the sides allow.
        maximum: u64,
    },
    /// No radius that was tried gave the wanted number of samples.
    #[error(
        "no radius gave {} samples to within 1% or one sample; the nearest gave {}",
        grouped(*.count), grouped(*.nearest)
    )]
    CountMissed {
        /// The number of samples that was asked for.
        count: u64,
        /// The nearest count found.
        nearest: u64,
    },
    /// The number of nested levels is out of range.
    #[error("{levels} levels were asked for; there must be between 1 and {maximum}")]
    Levels {
        /// The number of levels as given.
        levels: u32,
        /// The most levels that there may be.
        maximum: u32,
    },
    /// An exact number of samples was asked for with one level.
    #[error(
        "exactly {} samples need at least 2 levels: the first samples of one level may leave any place uncovered",
        grouped(*.count as u64)
    )]
    OneLevel {
        /// The number of samples that was asked for.
        count: usize,
    },
    /// A side is too short for the coarsest of nested levels.
    #[error(
        "the {name} is {} r long; {levels} levels need at least {} r: choose fewer levels or more samples",
        Beyond { length: *.radii, limit: *.minimum },
        rounded_up(*.minimum)
    )]
    TooManyLevels {
        /// The name of the side: "width" or "height".
        name: &'static str,
        /// How many levels were asked for.
        levels: u32,
        /// The side's length in radii.
        radii: f64,
        /// The limit in radii.
        minimum: f64,
    },
    /// A number of samples is too small for a number of nested levels.
    #[error(
        "exactly {} samples are too few for {levels} levels: the {name} would be {} r long, and must be at least {} r: choose fewer levels or more samples",
        grouped(*.count as u64),
        Beyond { length: *.radii, limit: *.minimum },
        rounded_up(*.minimum)
    )]
    TooFewForLevels {
        /// The number of samples that was asked for.
        count: usize,
        /// How many levels were asked for.
        levels: u32,
        /// Which side is too short.
        name: &'static str,
        /// The side's length in radii of this many samples.
        radii: f64,
        /// The limit in radii.
        minimum: f64,
    },
    /// Nested levels are made in one way only.
    #[error("nested levels need the default for {name}")]
    NestedChoice {
        /// The choice that differs from its default.
        name: &'static str,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_separators_and_no_more_digits_than_they_need() {
        for (number, text) in [
            (0.0, "0"),
            (0.008_36, "0.00836"),
            (-3.0, "-3"),
            (1234.5, "1,234.5"),
            (-20_041.0, "-20,041"),
            (999_999_999.999_999_9, "1,000,000,000"),
            (1e-12, "1e-12"),
            (1e300, "1e300"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(Number(number).to_string(), text);
        }
    }

    #[test]
    fn lengths_have_few_decimals_and_stay_on_their_side_of_the_limit() {
        for (length, limit, text) in [
            (16.931_304_931_640_625, 20.0, "16.93"),
            (9.999_999_999_999_998, 10.0, "9.999999999999998"),
            (3.9996, 4.0, "3.9996"),
            (2.0, 10.0, "2"),
            (1e-300, 10.0, "1e-300"),
            (0.000_123, 10.0, "0.0001"),
        ] {
            assert_eq!(Beyond { length, limit }.to_string(), text);
        }
        assert_eq!(rounded_up(56.54).to_string(), "56.6");
        assert_eq!(rounded_up(20.0).to_string(), "20");
    }

    #[test]
    fn counts_have_separators() {
        let error = ParameterError::Count {
            count: 99_999_999_999,
            minimum: 31,
            maximum: 2_936_167_948,
        };
        let said = error.to_string();
        assert!(said.contains("99,999,999,999 samples") && said.ends_with("31 and 2,936,167,948"));
    }
}
