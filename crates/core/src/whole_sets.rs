//! Patterns of whole sets, which [`crate::combine`] glues. Sets that this program made need no check; all others are
//! checked.

use crate::engine::parallel::sweep::Sweep;
use crate::engine::sequential::Sequential;
use crate::error::{PatternError, SampleError};
use crate::lattice::{Domain, Point};
use crate::parameters::{Parameters, Search, Variant};
use crate::pattern::Pattern;
use crate::pattern_making::check_count;
use crate::progress::Observer;
use crate::reference::reference_sample;

impl Pattern {
    /// Returns the pattern of given lattice points of `domain`, in any order.
    ///
    /// Fails as [`Self::from_positions`], with positions in the domain's user units.
    pub fn from_points(domain: &Domain, points: Vec<Point>) -> Result<Self, PatternError> {
        check_count(points.len(), domain)?;
        if let Some(index) = points.iter().position(|&p| !domain.rect().contains(p)) {
            return Err(PatternError::Outside {
                index,
                position: domain.user_from_lattice(points[index]),
                size: domain.size(),
            });
        }
        Self::checked(domain, points)
    }

    /// Returns the reference sampler's set of `domain`: [`reference_sample`]'s, which needs no check.
    pub fn of_reference(
        domain: Domain,
        seed: u64,
        observer: &mut dyn Observer,
    ) -> Result<Self, SampleError> {
        let samples = reference_sample(domain, seed, observer)?;
        let covers_lattice = true;
        Ok(Self::of_samples(&domain, samples, covers_lattice))
    }

    /// Returns the set of a run of `parameters` by randomized tiling that clips from `pattern`. With
    /// [`crate::Search::TwoRadii`] it is checked for gaps.
    ///
    /// Fails as the run, when the domain has more samples than the sequential engine accepts, and with
    /// [`PatternError::NotMaximal`] when that check finds a gap.
    pub fn of_run(
        parameters: &Parameters,
        pattern: &std::sync::Arc<Self>,
        observer: &mut dyn Observer,
    ) -> Result<Self, SampleError> {
        let domain = parameters.validate_sequential()?;

        let samples = match parameters.variant {
            Variant::Staged => {
                let sources = false;
                let sweep = Sweep::new(parameters, pattern, sources)?;
                let (sampled, _) = sweep.finish(observer)?;
                sampled.points
            }
            // The parallel engine does not have this variant.
            Variant::AsPrinted => {
                let engine = Sequential::new(parameters, pattern.clone())?;
                engine.finish(observer)?.points()
            }
        };

        match parameters.search {
            // The set is valid by construction. It may miss lattice points by a hair, since insertion tests rounded
            // circumcentres.
            Search::Complete => {
                let covers_lattice = false;
                Ok(Self::of_samples(&domain, samples, covers_lattice))
            }
            // A search within two radii may miss gaps.
            Search::TwoRadii => Ok(Self::checked(&domain, samples)?),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::{Boundary, R, Rect};
    use crate::parameters::PatternSpec;
    use crate::progress::Unobserved;

    fn domain() -> Domain {
        let rect = Rect {
            min: Point::new(5, 7),
            max: Point::new(5 + 20 * R, 7 + 13 * R),
        };
        Domain::of_rect(&rect, Boundary::Bounded).unwrap()
    }

    #[test]
    fn the_domain_of_a_rectangle_has_its_lattice_points() {
        assert_eq!(domain().rect().max, Point::new(20 * R, 13 * R));
    }

    #[test]
    fn sets_of_this_program_pass_the_check_that_they_are_spared() {
        let reference = Pattern::of_reference(domain(), 3, &mut Unobserved).unwrap();
        let checked = Pattern::from_points(&domain(), reference.samples().to_vec());
        assert_eq!(checked, Ok(reference));
        for variant in [Variant::Staged, Variant::AsPrinted] {
            let parameters = Parameters {
                width: 33.0,
                height: 21.0,
                radius: 1.0,
                leaf: 8.0,
                variant,
                ..Parameters::default()
            };
            let pattern = Pattern::of_spec(&PatternSpec::default(), &mut Unobserved).unwrap();
            let run = Pattern::of_run(&parameters, &pattern, &mut Unobserved).unwrap();
            let checked = Pattern::from_points(run.domain(), run.samples().to_vec());
            assert_eq!(checked, Ok(run));
        }
    }

    #[test]
    fn bad_points_are_refused() {
        let good = Pattern::of_reference(domain(), 3, &mut Unobserved).unwrap();
        let refused = |change: fn(&mut Vec<Point>)| {
            let mut points = good.samples().to_vec();
            change(&mut points);
            Pattern::from_points(&domain(), points).unwrap_err()
        };
        assert_eq!(refused(Vec::clear), PatternError::Empty);
        let few = refused(|points| points.truncate(20));
        assert!(matches!(few, PatternError::TooFew { count: 20, .. }));
        let outside = refused(|points| points[7].x = 20 * R);
        assert!(matches!(outside, PatternError::Outside { index: 7, .. }));
        let gap = refused(|points| points.truncate(points.len() - 1));
        assert!(matches!(gap, PatternError::NotMaximal { .. }));
        let conflict = refused(|points| points.push(points[9]));
        assert!(matches!(conflict, PatternError::Conflict { .. }));
    }
}
