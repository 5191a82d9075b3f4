//! Patterns of given samples: they are checked, since clips of a set with conflicts or gaps would not make a maximal set.

use crate::error::PatternError;
use crate::grid::SampleGrid;
use crate::lattice::{Boundary, Domain, Point, R, covers_offset};
use crate::pattern::Pattern;
use crate::stages::disks::DiskGrid;

/// How much farther than `R` (as a difference of squares) a lattice point of a *given* pattern may be from its nearest
/// sample: a distance of 0.12 units. With the 0.71 units between a place and its lattice point and the 0.17 by which a
/// unit may exceed its share of the radius that stays below one unit, the promised (1 + 2^-15) r. Nearly all results of
/// KDRT pass (measured: 0.24 units in one of four sets of 865,000 samples, none elsewhere); those of the reference
/// sampler always do.
const GIVEN_SLACK: i64 = 7_800;

/// The fewest samples to a squared radius that can cover a plane: 2 / (3 sqrt 3), the triangular lattice's. Half of it
/// allows for the disks' parts beyond a closed border.
const MIN_DENSITY: f64 = 0.5 * 0.384_9;

impl Pattern {
    /// Returns the pattern of given positions in user units: a set of radius `radius` on
    /// `[0, size[0]] x [0, size[1]]`.
    ///
    /// Fails, naming samples and places in user units, when the set is empty, not finite, outside,
    /// too small, not conflict-free or not maximal once rounded to the lattice.
    pub fn from_positions(
        positions: &[[f64; 2]],
        size: [f64; 2],
        radius: f64,
        boundary: Boundary,
    ) -> Result<Self, PatternError> {
        if positions.is_empty() {
            return Err(PatternError::Empty);
        }

        let domain = Domain::from_size(size, radius, boundary)?;
        for (index, &[x, y]) in positions.iter().enumerate() {
            // A position on the upper border of a periodic domain is allowed, and is one on its lower border.
            let inside = (0.0..=size[0]).contains(&x) && (0.0..=size[1]).contains(&y);
            if !inside {
                return Err(PatternError::Outside {
                    index,
                    position: [x, y],
                    size,
                });
            }
        }

        check_count(positions.len(), &domain)?;

        // Rounding moves samples by up to 0.71 units: the set is checked as it is on the lattice.
        let samples = positions
            .iter()
            .map(|&p| domain.lattice_from_user(p))
            .collect();

        Self::checked(&domain, samples)
    }

    /// Returns the pattern of samples of `domain` if they are conflict-free and maximal.
    pub(crate) fn checked(domain: &Domain, mut samples: Vec<Point>) -> Result<Self, PatternError> {
        samples.sort_unstable_by_key(|p| p.canonical());
        let covers_lattice = check(domain, &samples)?;
        Ok(Self::of_samples(domain, samples, covers_lattice))
    }
}

/// Refuses too few samples, before memory that grows with the domain is allocated.
pub(crate) fn check_count(count: usize, domain: &Domain) -> Result<(), PatternError> {
    let area = domain.area_radii();
    if count == 0 {
        return Err(PatternError::Empty);
    }
    if (count as f64) < MIN_DENSITY * area {
        return Err(PatternError::TooFew { count, area });
    }
    Ok(())
}

/// Checks a given set and returns whether it covers every lattice point.
fn check(domain: &Domain, samples: &[Point]) -> Result<bool, PatternError> {
    let conflict = |a: Point, b: Point| {
        let units = (domain.distance_squared(a, b) as f64).sqrt();
        PatternError::Conflict {
            first: domain.user_from_lattice(a),
            second: domain.user_from_lattice(b),
            radii: units / f64::from(R),
        }
    };

    let mut grid = SampleGrid::with_capacity(*domain, samples.len());
    let mut disks = DiskGrid::new(*domain);

    for (&p, id) in samples.iter().zip(0..) {
        let mut other = None;
        // The grid holds the samples before this one, so that every pair is compared once.
        grid.any_near(p, R, |near| {
            let covered = covers_offset(near.offset);
            if covered {
                other = Some(samples[near.id as usize]);
            }
            covered
        });

        if let Some(other) = other {
            return Err(conflict(other, p));
        }

        // Without conflicts a cell of `disks` has room for all of its samples.
        grid.insert(id, p);
        let fits = disks.insert(p);
        debug_assert!(fits, "no conflict was found");
    }

    // A given set may leave lattice points uncovered by a hair, and the second search says whether it does.
    match disks.uncovered_point(GIVEN_SLACK) {
        None => Ok(disks.uncovered_point(0).is_none()),
        Some(p) => Err(PatternError::NotMaximal {
            witness: domain.user_from_lattice(p),
        }),
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::parameters::PatternSpec;
    use crate::progress::Unobserved;

    fn small(boundary: Boundary) -> Pattern {
        let spec = PatternSpec {
            side: 14.5,
            boundary,
            seed: 3,
        };
        Pattern::generate(&spec, &mut Unobserved).unwrap()
    }

    fn positions(pattern: &Pattern) -> Vec<[f64; 2]> {
        pattern.domain().users_from_lattice(pattern.samples())
    }

    #[test]
    fn a_generated_pattern_passes_the_check_for_given_ones() {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            let pattern = small(boundary);
            let given = Pattern::from_positions(
                &positions(&pattern),
                pattern.domain().size(),
                1.0,
                boundary,
            );
            assert_eq!(given.unwrap(), pattern);
        }
    }

    #[test]
    fn bad_patterns_are_refused() {
        let pattern = small(Boundary::Periodic);
        let size = pattern.domain().size();
        let make = |p: &[[f64; 2]], r| Pattern::from_positions(p, size, r, Boundary::Periodic);
        let good = positions(&pattern);
        assert_eq!(make(&[], 1.0), Err(PatternError::Empty));
        let mut bad = good.clone();
        bad.remove(17);
        let removed = good[17];
        match make(&bad, 1.0) {
            Err(PatternError::NotMaximal { witness }) => {
                assert!(DVec2::from(witness).distance(removed.into()) < 1.01);
            }
            other => panic!("{other:?}"),
        }
        let mut bad = good.clone();
        bad.push([good[3][0], good[3][1] + 0.5]);
        assert!(matches!(
            make(&bad, 1.0),
            Err(PatternError::Conflict { .. })
        ));
        bad.pop();
        bad.push([f64::NAN, 1.0]);
        assert!(matches!(make(&bad, 1.0), Err(PatternError::Outside { .. })));
        assert!(matches!(
            make(&good, 1.1),
            Err(PatternError::Conflict { .. })
        ));
        assert!(matches!(
            make(&good, 0.9),
            Err(PatternError::NotMaximal { .. })
        ));
        assert!(matches!(make(&good, 2.0), Err(PatternError::Domain(_))));
    }
}
