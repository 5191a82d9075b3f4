//! Sets of balls: from a request to a made set, judged and certified.

use serde_json::json;
use tilescope_analysis::{
    Control, Region, SolidError, SolidRegion, SolidVerdict, VerifyOptions, measure_solid,
};
use tilescope_core::{
    Boundary, Observer, SampleError, SolidDomain, SolidLevels, SolidRequest, SolidSample,
    solid_arrivals_parallel,
};
use tilescope_formats::{ExportContext, SolidColumns, SolidContext, in_space};

use crate::facts::Stated;

/// How large the balls of a set are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BallSize {
    /// Their radius: no two samples are within it of each other.
    Radius(f64),
    /// That of a set of this many samples, to within a hundredth.
    Count(u64),
    /// That of a set with a few samples more than this number, of which the first to arrive are taken.
    Exactly(u64),
}

/// What a set of balls is made from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidRecipe {
    /// Width, height and depth.
    pub size: [f64; 3],
    /// How the box ends.
    pub boundary: Boundary,
    /// The seed of all random draws.
    pub seed: u64,
    /// How large the balls are.
    pub balls: BallSize,
}

impl SolidRecipe {
    /// Returns about how many samples the set will have.
    ///
    /// # Errors
    ///
    /// [`SampleError`] when sides or radius are refused.
    pub fn expected(&self) -> Result<f64, SampleError> {
        match self.balls {
            BallSize::Radius(radius) => {
                let domain = SolidDomain::from_size(self.size, radius, self.boundary)?;
                Ok(domain.expected_samples())
            }
            BallSize::Count(count) | BallSize::Exactly(count) => Ok(count as f64),
        }
    }

    /// Makes the set on all threads of the current rayon pool. The samples do not depend on their number.
    ///
    /// # Errors
    ///
    /// [`SampleError`] when sides or radius are refused, when there is not enough memory, when no radius gives the number of
    /// samples, and when it is cancelled.
    pub fn make(&self, observer: &mut dyn Observer) -> Result<SolidMade, SampleError> {
        let &Self {
            size,
            boundary,
            seed,
            balls,
        } = self;
        let request = SolidRequest {
            size,
            boundary,
            seed,
        };

        // For a wanted number of samples, whole sets with different radii are made until one has about as many.
        let (found, may_be_beginning) = match balls {
            BallSize::Radius(radius) => {
                // With a given radius there is nothing to search for: one set is made.
                let domain = SolidDomain::from_size(size, radius, boundary)?;
                let arrived = solid_arrivals_parallel(domain, seed, observer)?;
                let made = arrived.places.len();
                let sample = SolidSample {
                    domain,
                    arrived,
                    made,
                };
                (sample, false)
            }
            BallSize::Count(count) => (request.of_count(count, observer)?, false),
            BallSize::Exactly(count) => (request.of_exactly(count, observer)?, true),
        };

        // If the made set happens to have exactly the wanted number of samples, it is taken whole.
        let arrived = found.arrived;
        let is_beginning = may_be_beginning && found.made > arrived.places.len();
        Ok(SolidMade {
            points: found.domain.users_from_lattice(&arrived.places),
            levels: arrived.levels,
            made: is_beginning.then_some(found.made as u64),
            domain: found.domain,
            seed,
        })
    }
}

/// A set of balls in user units, with how it was made.
#[derive(Clone, Debug)]
pub struct SolidMade {
    /// Its positions, in the order of their arrival.
    pub points: Vec<[f64; 3]>,
    /// The levels at which they arrived.
    pub levels: SolidLevels,
    /// Its box, with the radius.
    pub domain: SolidDomain,
    /// How many samples were made, if the set is the first of those.
    pub made: Option<u64>,
    seed: u64,
}

impl SolidMade {
    /// The method, as certificates name it.
    pub const METHOD: &str = "reference";

    /// About how many samples there are to a cubed radius, away from the sides of a box.
    pub const DENSITY: f64 = tilescope_core::SOLID_DENSITY;

    /// Returns every parameter that the method uses, as certificates state them: equal ones make the set again.
    #[must_use]
    pub fn parameters(&self) -> Stated {
        let [width, height, depth] = self.domain.size();
        Stated::from([
            ("width".to_owned(), width.into()),
            ("height".to_owned(), height.into()),
            ("depth".to_owned(), depth.into()),
            ("radius".to_owned(), self.domain.radius().into()),
            ("boundary".to_owned(), json!(self.domain.boundary())),
            ("seed".to_owned(), self.seed.into()),
        ])
    }

    /// Returns the verifier's box.
    #[must_use]
    pub fn region(&self) -> SolidRegion {
        let [_, _, depth] = self.domain.size();
        in_space(self.base(), depth)
    }

    /// Returns the rectangle that the box stands on.
    fn base(&self) -> Region {
        let [width, height, _] = self.domain.size();
        Region::new(
            [width, height],
            self.domain.boundary() == Boundary::Periodic,
        )
    }

    /// Returns what the certificate of an export is to state.
    #[must_use]
    pub fn context(&self) -> SolidContext {
        let [_, _, depth] = self.domain.size();
        SolidContext {
            planar: ExportContext {
                method: Self::METHOD.to_owned(),
                parameters: self.parameters(),
                made: self.made,
                ..ExportContext::new(self.base(), self.domain.radius())
            },
            depth,
            columns: columns_of(&self.levels),
        }
    }

    /// Returns the verdict on the set, whatever it says.
    ///
    /// # Errors
    ///
    /// [`SolidError`] when there is no verdict.
    pub fn judge(
        &self,
        options: &VerifyOptions,
        control: Control<'_>,
    ) -> Result<SolidVerdict, SolidError> {
        let (region, radius) = (self.region(), self.domain.radius());
        let is_prefix = self.made.is_some();
        measure_solid(&self.points, region, radius, is_prefix, options, control)
    }
}

/// Returns the columns that files have of a set in the order of arrival.
#[must_use]
pub fn columns_of(levels: &SolidLevels) -> SolidColumns {
    SolidColumns {
        // A box has fewer than 2^30 samples.
        arrival: (0..levels.count() as u32).collect(),
        level: levels.of_samples().collect(),
    }
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use tilescope_core::Unobserved;

    use super::*;

    fn recipe(balls: BallSize, boundary: Boundary) -> SolidRecipe {
        SolidRecipe {
            size: [6.0, 5.0, 7.0],
            boundary,
            seed: 3,
            balls,
        }
    }

    #[test]
    fn every_size_of_balls_makes_a_set_that_verifies() {
        let go_on = |_| ControlFlow::Continue(());
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            for balls in [
                BallSize::Radius(1.0),
                BallSize::Count(400),
                BallSize::Exactly(401),
            ] {
                let made = recipe(balls, boundary).make(&mut Unobserved).unwrap();
                let verdict = made.judge(&VerifyOptions::default(), &go_on).unwrap();
                assert!(verdict.valid(), "{balls:?}: {verdict:?}");
                let is_beginning = matches!(balls, BallSize::Exactly(_));
                assert_eq!(made.made.is_some(), is_beginning, "{balls:?}");
                assert_eq!(verdict.covering_factor.is_some(), is_beginning);

                // A sample less is seen, but for the factor of a beginning.
                let fewer = SolidMade {
                    points: made.points[1..].to_vec(),
                    made: None,
                    ..made
                };
                let verdict = fewer.judge(&VerifyOptions::default(), &go_on).unwrap();
                assert!(!verdict.valid(), "{balls:?}");
            }
        }
    }

    #[test]
    fn parameters_make_the_set_again() {
        let made = recipe(BallSize::Count(300), Boundary::Bounded)
            .make(&mut Unobserved)
            .unwrap();
        let radius = made.parameters()["radius"].as_f64().unwrap();
        let again = recipe(BallSize::Radius(radius), Boundary::Bounded)
            .make(&mut Unobserved)
            .unwrap();
        assert_eq!((again.points, again.domain), (made.points, made.domain));
    }
}
