//! Makes the sets of figure 13: the methods, and the radius and seeds of a group of sets.

use serde::{Deserialize, Serialize};
use tilescope_core::{Domain, Parameters, Point, Rect};

use crate::control::Control;
use crate::error::Result;
use crate::experiments::common::DENSITY;
use crate::sets::{Set, exact, pattern_side};

/// Side in radii of the default pattern.
pub const PATTERN: f64 = 100.0;
/// Copies of one set along each side of the control.
const COPIES: i32 = 4;
/// The seeds of [`Method::Again`] are those of [`Method::Reference`] plus this number. A group has fewer sets than this
/// number, so that the two methods share no seed.
const APART: u64 = 10_000;

/// A method of making sets.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Method {
    /// By the reference sampler, from scratch.
    Reference,
    /// By the reference sampler with other seeds: differs by chance alone.
    Again,
    /// By randomized tiling, every set from a pattern of its own with this side.
    Kdrt { leaf: f64, side: f64 },
    /// By randomized tiling, all sets from one pattern.
    OnePattern { leaf: f64 },
    /// By exact tiling, every set from a pattern of its own that is as large as the method chooses.
    Exact { leaf: f64 },
    /// Copies of a small periodic set side by side: a control whose regularity the measures must detect.
    Copies,
}

impl Method {
    pub fn name(self) -> String {
        self.words()[0].clone()
    }

    /// Returns its name in files.
    pub fn key(self) -> String {
        self.words()[1].clone()
    }

    /// Returns the name for readers and the one in files.
    fn words(self) -> [String; 2] {
        let words = |name: &str, key: &str| [name.to_owned(), key.to_owned()];

        match self {
            Self::Reference => words("reference", "reference"),
            Self::Again => words("reference, other seeds", "again"),
            Self::Kdrt { leaf, side } => {
                // The name mentions the pattern only if it is larger than the default one, or if blocks do not fit into it.
                let default = self.fits() && side <= PATTERN;
                let pattern = if default {
                    String::new()
                } else {
                    format!(", pattern {side} r")
                };
                words(
                    &format!("KDRT, leaf {leaf} r{pattern}"),
                    &format!("leaf-{leaf}-of-{side}"),
                )
            }
            Self::OnePattern { leaf } => words(
                &format!("KDRT, leaf {leaf} r, one pattern"),
                &format!("one-pattern-{leaf}"),
            ),
            Self::Exact { leaf } => words(
                &format!("exact tiling, leaf {leaf} r"),
                &format!("exact-{leaf}"),
            ),
            Self::Copies => words(&format!("{COPIES} x {COPIES} copies (control)"), "copies"),
        }
    }

    /// By randomized tiling, from patterns that the largest blocks fit into.
    pub fn kdrt(leaf: f64) -> Self {
        let side = pattern_side(leaf);
        Self::Kdrt { leaf, side }
    }

    /// Whether the largest block fits into the pattern, so that no block repeats a part of it.
    pub fn fits(self) -> bool {
        match self {
            Self::Kdrt { leaf, side } => side >= pattern_side(leaf),
            Self::OnePattern { leaf } => PATTERN >= pattern_side(leaf),
            _ => false,
        }
    }

    /// Whether sets of this radius on the unit square have more than one block: one is split only where both halves
    /// can be as long as the leaf.
    pub fn tiles(self, radius: f64) -> bool {
        match self {
            Self::Kdrt { leaf, .. } | Self::OnePattern { leaf } | Self::Exact { leaf } => {
                2.0 * leaf * radius <= 1.0
            }
            Self::Copies => true,
            Self::Reference | Self::Again => false,
        }
    }

    /// Whether sets of this radius on the unit square have at least nine blocks: a side of four leaves is cut into
    /// parts shorter than two leaves, so into at least three.
    pub fn tiles_often(self, radius: f64) -> bool {
        self.leaf().is_some_and(|leaf| 4.0 * leaf * radius <= 1.0)
    }

    pub const fn leaf(self) -> Option<f64> {
        match self {
            Self::Kdrt { leaf, .. } | Self::OnePattern { leaf } | Self::Exact { leaf } => {
                Some(leaf)
            }
            _ => None,
        }
    }
}

/// The periodic unit square with a radius, and the number of sets that are measured.
#[derive(Clone, Copy, Debug)]
pub struct SetGroup {
    pub radius: f64,
    pub sets: u64,
    pub seed: u64,
}

impl SetGroup {
    /// Samples of a set, about.
    pub fn samples(&self) -> f64 {
        DENSITY / (self.radius * self.radius)
    }

    /// Returns the set of a method by its number.
    pub fn set(&self, method: Method, number: u64, control: &Control<'_>) -> Result<Set> {
        // The seeds of a group's sets begin at a thousand times the group's seed. A group has fewer than a thousand
        // sets, so that groups with consecutive seeds share no set.
        let seed = self.seed.wrapping_mul(1000).wrapping_add(number);
        let base = Parameters {
            radius: self.radius,
            ..Parameters::default()
        };
        let domain = base.validate()?;

        // A set by KDRT, from a pattern of this side and seed.
        let tiled = |leaf, side, of_pattern| {
            let mut parameters = Parameters { leaf, seed, ..base };
            (parameters.pattern.side, parameters.pattern.seed) = (side, of_pattern);
            Set::kdrt(&parameters, control).map(|(set, _)| set)
        };

        match method {
            Method::Reference => Set::reference(domain, seed, control),
            Method::Again => Set::reference(domain, seed.wrapping_add(APART), control),
            Method::Kdrt { leaf, side } => tiled(leaf, side, seed),
            // The pattern has the seed of the group, so that all its sets share it.
            Method::OnePattern { leaf } => tiled(leaf, PATTERN, self.seed),
            Method::Exact { leaf } => {
                let run = exact(&Parameters { leaf, seed, ..base }, control)?;
                Ok(Set::of_run(&run))
            }
            Method::Copies => copies(&domain, seed, control),
        }
    }
}

/// Returns a domain full of copies of one periodic set. Its sides are whole multiples of the copies' on the lattice.
fn copies(domain: &Domain, seed: u64, control: &Control<'_>) -> Result<Set> {
    let side = domain.rect().max.x / COPIES;
    let rect = Rect {
        min: Point::default(),
        max: Point::new(side, side),
    };
    let tile = Domain::of_rect(&rect, tilescope_core::Boundary::Periodic)?;
    let one = tilescope_core::reference_sample(tile, seed, &mut control.observer())?;
    let shifts = (0..COPIES * COPIES).map(|i| [i % COPIES * side, i / COPIES * side]);
    let points: Vec<Point> = shifts
        .flat_map(|[x, y]| one.iter().map(move |p| Point::new(p.x + x, p.y + y)))
        .collect();
    Ok(Set::of(domain, &points))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sets::pattern;
    use crate::study::Settings;
    use crate::study::tests::alone;
    use tilescope_core::PatternSpec;

    #[test]
    fn methods_tile_where_runs_have_more_than_one_block() {
        alone(&Settings::default(), |control| {
            for radius in [0.02, 0.01, 0.005] {
                for leaf in [20.0, 40.0, 80.0] {
                    let parameters = Parameters {
                        radius,
                        leaf,
                        ..Parameters::default()
                    };
                    let (_, summary) = Set::kdrt(&parameters, control)?;
                    let tiles = Method::kdrt(leaf).tiles(radius);
                    assert_eq!(tiles, summary.blocks > 1, "leaf {leaf}, radius {radius}");
                    if Method::kdrt(leaf).tiles_often(radius) {
                        assert!(summary.blocks >= 9, "leaf {leaf}, radius {radius}");
                    }
                }
            }
            Ok(())
        });
    }

    #[test]
    fn a_leaf_that_takes_the_whole_domain_gives_the_pattern_shifted() {
        alone(&Settings::default(), |control| {
            let group = SetGroup {
                radius: 0.01,
                sets: 1,
                seed: 1,
            };
            let method = Method::Kdrt {
                leaf: 80.0,
                side: PATTERN,
            };
            assert!(!method.fits());
            let set = group.set(method, 3, control)?;
            let spec = PatternSpec {
                side: PATTERN,
                seed: 1003,
                ..PatternSpec::default()
            };
            assert_eq!(set.points.len(), pattern(&spec, control)?.samples().len());
            Ok(())
        });
    }
}
