//! Five rules for what two different radii mean, beside each other: by a small dart process of this experiment alone.
//!
//! The sampler has one rule, the harmonic mean. Here every place of a coarse lattice is a dart with an arrival time, the sooner the
//! smaller its radius; a dart is a sample unless an earlier sample is near it. So nothing is shared with the sampler, and any
//! rule may be asked for. The lattice leaves out some hundredths of the samples: all densities are relative to those of one
//! radius on the same lattice.

use serde::{Deserialize, Serialize};
use tilescope_core::{Key, Stream};

use super::fields::{FieldCounts, integral};

/// How two radii make the distance up to which samples are in conflict.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RadiusRule {
    Least,
    Greatest,
    Arithmetic,
    Geometric,
    Harmonic,
}

impl RadiusRule {
    pub const ALL: [Self; 5] = [
        Self::Harmonic,
        Self::Geometric,
        Self::Arithmetic,
        Self::Least,
        Self::Greatest,
    ];

    pub const fn name(self) -> &'static str {
        match self {
            Self::Least => "least",
            Self::Greatest => "greatest",
            Self::Arithmetic => "arithmetic mean",
            Self::Geometric => "geometric mean",
            Self::Harmonic => "harmonic mean",
        }
    }

    /// Returns the distance up to which places of these radii are near each other.
    fn near(self, one: f64, other: f64) -> f64 {
        match self {
            Self::Least => one.min(other),
            Self::Greatest => one.max(other),
            Self::Arithmetic => 0.5 * (one + other),
            Self::Geometric => (one * other).sqrt(),
            Self::Harmonic => 2.0 * one * other / (one + other),
        }
    }

    /// Returns how far from a place of some radius others can be near it, where no radius is above `greatest`. No rule
    /// gives less for a larger one.
    fn reach(self, radius: f64, greatest: f64) -> f64 {
        self.near(radius, greatest)
    }
}

/// A field of which the radius depends on x alone. It repeats along y, and ends along x.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RuledField {
    /// The radius is 1 everywhere.
    Level,
    /// It grows by this much for each unit along x.
    Slope(f64),
    /// It is 1 on a strip, as wide as this, in the middle of ground with another one.
    Strip { width: f64, ground: f64 },
}

/// Places to a unit. The finer they are, the fewer samples are missing; 8 lose 3 to 4 %.
const PLACES: f64 = 8.0;
/// Samples on ramps are counted this many radii from both ends.
const MARGIN: f64 = 2.0;
/// Room on either side of a strip, in radii of the ground.
const GROUND: f64 = 2.5;

impl RuledField {
    pub const ALL: [Self; 5] = [
        Self::Level,
        Self::Slope(0.1),
        Self::Slope(0.3),
        Self::Strip {
            width: 4.0,
            ground: 4.0,
        },
        Self::Strip {
            width: 4.0,
            ground: 16.0,
        },
    ];

    pub fn name(self) -> String {
        match self {
            Self::Level => "one radius".to_owned(),
            Self::Slope(slope) => format!("slope {slope}"),
            Self::Strip { ground, .. } => format!("strip in {ground}-fold ground"),
        }
    }

    /// Returns the key of its unit.
    pub fn key(self) -> String {
        self.name().replace([' ', '.'], "-")
    }

    /// Returns width and height. They were chosen so that all fields take about as long.
    const fn size(self) -> [f64; 2] {
        match self {
            Self::Level => [28.0, 24.0],
            // The radius grows to 4 and to 8.
            Self::Slope(slope) => [if slope < 0.2 { 30.0 } else { 70.0 / 3.0 }, 48.0],
            Self::Strip { width, ground } => [width + 2.0 * GROUND * ground, 48.0],
        }
    }

    fn radius_at(self, x: f64) -> f64 {
        match self {
            Self::Level => 1.0,
            Self::Slope(slope) => 1.0 + slope * x,
            Self::Strip { ground, .. } => {
                if self.is_on_strip(x) {
                    1.0
                } else {
                    ground
                }
            }
        }
    }

    fn is_on_strip(self, x: f64) -> bool {
        match self {
            Self::Strip { width, .. } => (x - 0.5 * self.size()[0]).abs() <= 0.5 * width,
            Self::Level | Self::Slope(_) => false,
        }
    }

    /// Returns whether samples at some x are counted: those far from the ends, and of strips those on them.
    fn counts_at(self, x: f64) -> bool {
        let away = MARGIN * self.radius_at(x);
        match self {
            Self::Level | Self::Slope(_) => x >= away && self.size()[0] - x >= away,
            Self::Strip { .. } => self.is_on_strip(x),
        }
    }

    /// Returns the samples that are counted of the set of a seed by a rule.
    pub fn count(self, rule: RadiusRule, seed: u64) -> u64 {
        let samples = self.samples(rule, seed);
        samples.iter().filter(|&&[x, _]| self.counts_at(x)).count() as u64
    }

    /// Returns the set of a seed by a rule, in the order of arrival.
    fn samples(self, rule: RadiusRule, seed: u64) -> Vec<[f64; 2]> {
        let [columns, rows] = self.size().map(|side| (side * PLACES).round() as usize);
        let radii: Vec<f64> = (0..columns)
            .map(|column| self.radius_at(middle_of(column)))
            .collect();
        let greatest = radii.iter().copied().fold(0.0, f64::max);
        let mut is_near_one = vec![false; columns * rows];

        let mut samples = Vec::new();
        for place in arrivals(&radii, rows, seed) {
            if is_near_one[place] {
                continue;
            }
            let (row, column) = (place / columns, place % columns);
            samples.push([middle_of(column), middle_of(row)]);

            // No place near this sample can become a sample. The first and the last row are neighbours, since the field
            // repeats along y; the first and the last column are not.
            let reach = (rule.reach(radii[column], greatest) * PLACES) as usize;
            let beside = column.saturating_sub(reach)..(column + reach + 1).min(columns);
            for other in beside {
                let near = rule.near(radii[column], radii[other]) * PLACES;
                let across = column.abs_diff(other) as f64;
                // A column whose x is farther away than the distance `near` has no place near the sample.
                let Some(along) = positive_root(near * near - across * across) else {
                    continue;
                };
                // A disk that is higher than the field covers the whole column.
                let along = (along as usize).min(rows / 2);
                for step in 0..=2 * along {
                    let at = (row + rows + step - along) % rows;
                    is_near_one[at * columns + other] = true;
                }
            }
        }
        samples
    }

    /// Returns the sets that were counted, over the area in which they were.
    pub fn joined(self, counts: Vec<u64>) -> FieldCounts {
        let [width, height] = self.size();
        let area_at = |x: f64| {
            let counted = f64::from(u8::from(self.counts_at(x)));
            counted * height / self.radius_at(x).powi(2)
        };
        FieldCounts {
            counts,
            area: integral(0.0, width, area_at),
        }
    }
}

/// Returns the middle of a column or a row of places: its x or its y.
fn middle_of(index: usize) -> f64 {
    (index as f64 + 0.5) / PLACES
}

/// Returns the root of a number, unless it is negative.
fn positive_root(square: f64) -> Option<f64> {
    (square >= 0.0).then(|| square.sqrt())
}

/// Returns all places in the order in which they arrive. `radii` are those of the columns. The mean time of a place is
/// R^2, where R is its radius. So an area of R^2 has as many arrivals in a short time where R is small as where R is
/// large.
fn arrivals(radii: &[f64], rows: usize, seed: u64) -> Vec<usize> {
    // The sampler draws its darts with the key of the seed itself. This key differs, so that no draws are the same.
    let key = Key::from_seed(seed).derive(Stream::Dart, u32::MAX);
    let columns = radii.len();
    // The logarithm of a uniform number has the exponential distribution of a waiting time.
    let time = |place: usize| {
        let [word, _] = key.draw(Stream::Dart, place as u32);
        // From 0 to 1, without either.
        let uniform = (f64::from(word) + 0.5) / 2_f64.powi(32);
        -uniform.ln() * radii[place % columns].powi(2)
    };
    let mut timed: Vec<(f64, usize)> = (0..columns * rows)
        .map(|place| (time(place), place))
        .collect();
    timed.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    timed.into_iter().map(|(_, place)| place).collect()
}

/// What the sets of each rule on one field have.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RuleCounts {
    /// In the sequence of the rules.
    pub by_rule: Vec<FieldCounts>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_two_samples_are_near_and_no_place_is_without_one() {
        let field = RuledField::Strip {
            width: 4.0,
            ground: 4.0,
        };
        for rule in RadiusRule::ALL {
            let samples = field.samples(rule, 3);
            let [_, height] = field.size();
            let near = |a: [f64; 2], b: [f64; 2], rule: RadiusRule| {
                let y = (a[1] - b[1]).abs();
                let distance = (a[0] - b[0]).hypot(y.min(height - y));
                distance <= rule.near(field.radius_at(a[0]), field.radius_at(b[0])) - 1e-9
            };
            let conflicts = |rule| {
                let pairs = samples.iter().enumerate();
                let later = pairs.map(|(index, &a)| {
                    samples[index + 1..]
                        .iter()
                        .filter(|&&b| near(a, b, rule))
                        .count()
                });
                later.sum::<usize>()
            };
            assert_eq!(conflicts(rule), 0, "{rule:?}");
            // Under a rule that asks for more distance, the same set must have conflicts.
            if rule != RadiusRule::Greatest {
                assert!(conflicts(RadiusRule::Greatest) > 0, "{rule:?}");
            }
        }
    }
}
