//! What a host may ask for. Values cross as numbers alone: a reader of JSON in the module would be a tenth of it.

use tilescope_core::{Boundary, Insertion, Order, Parameters, PatternSpec, Search, TilingMethod};

/// The side of the square after which a plane repeats, in radii. It leaves a little to the longest that a domain may have,
/// 65,532 r, so that no rounding of the product refuses it. The library for C has the same planes.
pub const PERIOD_RADII: f64 = 65_000.0;

/// How many values there are: one for each field of [`Settings`].
pub const VALUES: usize = 15;

/// Values of a host, each in 64 bits: a float by its bits, a seed or a count as it is, a choice by its number.
pub type Values = [u64; VALUES];

/// How a set is made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Randomized tiling.
    #[default]
    Kdrt,
    /// Tiling of all darts of a pattern, without bias at seams.
    Exact,
    /// Dart throwing from scratch.
    Reference,
}

const BOUNDARIES: [Boundary; 2] = [Boundary::Periodic, Boundary::Bounded];
const METHODS: [Method; 3] = [Method::Kdrt, Method::Exact, Method::Reference];
const ORDERS: [Order; 4] = [
    Order::Index,
    Order::Random,
    Order::OwnBlockFirst,
    Order::PhaseGroup,
];
const INSERTIONS: [Insertion; 2] = [Insertion::Circumcentre, Insertion::Uniform];
const SEARCHES: [Search; 2] = [Search::Complete, Search::TwoRadii];

/// What a set or a plane is made from. Lengths are in user units, but for `leaf` and `pattern_side`, which are in radii. What
/// is missing has the value that the command line uses.
#[derive(Clone, Copy, Debug, Default)]
pub struct Settings {
    /// The radius. A set has it, or a count.
    pub radius: Option<f64>,
    /// About so many samples: the radius is searched for.
    pub count: Option<u64>,
    /// The side of the domain along x; of a plane the side of the square that repeats.
    pub width: Option<f64>,
    /// The side along y.
    pub height: Option<f64>,
    /// How the domain ends.
    pub boundary: Option<Boundary>,
    /// The seed of every draw.
    pub seed: Option<u64>,
    /// How it is made.
    pub method: Option<Method>,
    /// The shortest edge of a block.
    pub leaf: Option<f64>,
    /// The side of the pattern.
    pub pattern_side: Option<f64>,
    /// The seed of the pattern.
    pub pattern_seed: Option<u64>,
    /// How the pattern ends.
    pub pattern_boundary: Option<Boundary>,
    /// Whether blocks turn and mirror the pattern.
    pub dihedral: Option<bool>,
    /// In which order samples claim their disks.
    pub order: Option<Order>,
    /// How gaps are filled.
    pub insertion: Option<Insertion>,
    /// How far detectors look.
    pub search: Option<Search>,
}

impl Settings {
    /// Reads the values of a host, of which bit k of `given` says whether value k is given. They are in the order of the fields.
    ///
    /// # Errors
    ///
    /// A choice has a number that no choice has.
    pub fn read(given: u32, values: &Values) -> Result<Self, String> {
        let value = |index: usize| (given >> index & 1 == 1).then(|| values[index]);
        let float = |index| value(index).map(f64::from_bits);

        Ok(Self {
            radius: float(0),
            count: value(1),
            width: float(2),
            height: float(3),
            boundary: chosen(value(4), &BOUNDARIES)?,
            seed: value(5),
            method: chosen(value(6), &METHODS)?,
            leaf: float(7),
            pattern_side: float(8),
            pattern_seed: value(9),
            pattern_boundary: chosen(value(10), &BOUNDARIES)?,
            dihedral: value(11).map(|value| value != 0),
            order: chosen(value(12), &ORDERS)?,
            insertion: chosen(value(13), &INSERTIONS)?,
            search: chosen(value(14), &SEARCHES)?,
        })
    }

    /// Returns the parameters of the run, whose radius is the usual one where a count is asked for.
    #[must_use]
    pub fn parameters(&self) -> Parameters {
        let usual = Parameters::default();
        let mut parameters = Parameters {
            width: self.width.unwrap_or(usual.width),
            height: self.height.unwrap_or(usual.height),
            radius: self.radius.unwrap_or(usual.radius),
            boundary: self.boundary.unwrap_or(usual.boundary),
            seed: self.seed.unwrap_or(usual.seed),
            // The reference sampler is no tiling; of these parameters it takes domain, radius and seed alone.
            method: match self.method.unwrap_or_default() {
                Method::Exact => TilingMethod::Exact,
                Method::Kdrt | Method::Reference => TilingMethod::Kdrt,
            },
            leaf: self.leaf.unwrap_or(usual.leaf),
            dihedral: self.dihedral.unwrap_or(usual.dihedral),
            order: self.order.unwrap_or(usual.order),
            insertion: self.insertion.unwrap_or(usual.insertion),
            search: self.search.unwrap_or(usual.search),
            ..usual
        };

        // The usual pattern of an exact tiling depends on the size of the set.
        let pattern = parameters.usual_pattern();
        parameters.pattern = PatternSpec {
            side: self.pattern_side.unwrap_or(pattern.side),
            seed: self.pattern_seed.unwrap_or(pattern.seed),
            boundary: self.pattern_boundary.unwrap_or(pattern.boundary),
        };
        parameters
    }

    /// Returns the settings of a plane: the square that repeats has its usual side where none is given.
    #[must_use]
    pub fn as_plane(self) -> Self {
        let side = self.radius.map(|radius| radius * PERIOD_RADII);
        Self {
            width: self.width.or(side),
            height: self.height.or(self.width).or(side),
            ..self
        }
    }
}

/// Returns the choice that a value names.
fn chosen<T: Copy>(value: Option<u64>, all: &[T]) -> Result<Option<T>, String> {
    let Some(number) = value else {
        return Ok(None);
    };
    let index = usize::try_from(number).ok();
    let found = index.and_then(|index| all.get(index)).copied();
    let most = all.len() - 1;
    found
        .map(Some)
        .ok_or_else(|| format!("there is no choice {number}; the last one is {most}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_read_where_they_are_given() {
        let mut values = Values::default();
        values[0] = 0.25_f64.to_bits();
        values[5] = u64::MAX;
        values[6] = 1;
        let settings = Settings::read(1 | 1 << 5 | 1 << 6, &values).unwrap();
        assert_eq!(settings.radius, Some(0.25));
        assert_eq!(settings.seed, Some(u64::MAX));
        assert_eq!(settings.method, Some(Method::Exact));
        assert!(settings.count.is_none() && settings.boundary.is_none());

        values[4] = 7;
        let error = Settings::read(1 << 4, &values).unwrap_err();
        assert_eq!(error, "there is no choice 7; the last one is 1");
    }
}
