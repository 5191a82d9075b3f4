//! Makes nested levels on the CPU, or takes them from a file that was exported with them. Begin with [`sample`] and
//! [`of_file`].

use tilescope_analysis::PrefixClaim;
use tilescope_core::{Boundary, Domain, MAX_LEVELS, NestedRequest, Parameters, Run, SampleError};
use tilescope_formats::ReadSet;

use crate::jobs::Monitor;
use crate::nested::{NestedLevels, stated_by};
use crate::recipe::Recipe;
use crate::session::{Reporter, Session};

/// Makes the levels that a recipe asks for, on the CPU.
///
/// Fails as [`NestedRequest::make`] does, and when `monitor` is cancelled.
pub fn sample(
    recipe: &Recipe,
    request: NestedRequest,
    generation: u64,
    monitor: &Monitor,
) -> Result<Session, SampleError> {
    let observer = &mut Reporter { monitor };
    let asked = recipe.parameters;
    let nested = request.make(&asked, observer)?;

    let domain = *nested.domain();
    // The radius is the one that was used. If an exact number of samples was asked for, that number decided it, not the parameter.
    let parameters = Parameters {
        radius: domain.radius(),
        ..asked
    };

    let levels = NestedLevels {
        claims: nested.claims().map(PrefixClaim::from).collect(),
        // Only a window of the levels can lack ranks, and these are whole.
        ranks: nested.ranks().unwrap_or_default(),
        asked: Some((asked, request)),
        method: "kdrt".to_owned(),
        stated: stated_by(&parameters, &request),
    };

    let run = Run::of_points(parameters, domain, nested.points().to_vec());
    observer.prepare(|| Session::from_levels(run, levels, generation))
}

/// Returns the session of a set that was exported with its levels; `None` if its certificate states none.
///
/// Fails when the levels that it states do not fit the set.
#[must_use]
pub fn of_file(set: &ReadSet, name: &str, generation: u64) -> Option<Result<Session, String>> {
    let certificate = set.certificate.as_ref()?;
    let claims = certificate.claims();

    (!claims.is_empty()).then(|| {
        let region = certificate.region;
        let boundary = Boundary::of(region.is_periodic());
        // Nested levels have one radius, which is then the least.
        let radius = certificate.radius.least();

        let domain = Domain::from_size([region.width, region.height], radius, boundary)
            .map_err(|error| format!("{name}: {error}"))?;

        // A certificate comes from outside, and the window relies on counts that ascend to the number of samples.
        if !fit(&claims, set.set.points.len(), radius) {
            return Err(format!(
                "{name}: the levels of its certificate do not fit its samples"
            ));
        }

        let at = |&position: &[f64; 2]| domain.lattice_from_user(position);
        let parameters = Parameters {
            width: region.width,
            height: region.height,
            radius,
            boundary,
            // The certificate states the others by name, as `stated` below has them.
            ..Parameters::default()
        };

        let levels = NestedLevels {
            claims,
            // Files have the ranks in a column, which is not read with the points.
            ranks: Vec::new(),
            asked: None,
            method: certificate.method.clone(),
            stated: certificate.parameters.clone(),
        };

        let run = Run::of_points(parameters, domain, set.set.points.iter().map(at).collect());
        Ok(Session::from_levels(run, levels, generation))
    })
}

/// Returns whether claims from outside are those of nested levels with this number of samples.
fn fit(claims: &[PrefixClaim], count: usize, radius: f64) -> bool {
    // Each level has the radius of the next one times the root of 2, so that the first of MAX_LEVELS has 32 r. With a factor of 2
    // on either side no level is refused for its rounding.
    let is_radius = |length: f64| (0.5 * radius..=64.0 * radius).contains(&length);

    let radii = claims.iter().all(|claim| {
        is_radius(claim.distance) && claim.covering.is_none_or(is_radius) && claim.count > 0
    });

    let ascend = claims.windows(2).all(|pair| pair[0].count < pair[1].count);
    let ends = claims.last().is_some_and(|last| last.count == count);
    radii && ascend && ends && claims.len() <= MAX_LEVELS as usize
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use tilescope_core::WithinLevel;

    use super::*;

    fn made(exactly: Option<usize>) -> Session {
        let request = NestedRequest {
            levels: 3,
            exactly,
            order_within: WithinLevel::Random,
        };
        let recipe = Recipe {
            nested: Some(request),
            ..Recipe::from(Parameters {
                radius: 0.03,
                ..Parameters::default()
            })
        };
        let monitor = Monitor::reporting(|_, _| {});
        let session = sample(&recipe, request, 1, &monitor).unwrap();
        assert_eq!(session.recipe(), recipe);
        assert_eq!(
            session.nested.as_ref().unwrap().ranks.len(),
            session.summary.count
        );
        session
    }

    #[test]
    fn prefixes_have_the_claims_of_their_levels() {
        let session = made(None);
        let levels = session.nested.as_ref().unwrap();
        let ends: Vec<usize> = levels.ends().collect();
        assert_eq!((ends.len(), ends[2]), (3, session.summary.count));
        assert_eq!(
            (levels.whole(ends[0] - 1), levels.whole(ends[0])),
            (None, Some(0))
        );
        assert_eq!(
            (levels.whole(ends[1]), levels.whole(ends[2])),
            (Some(1), Some(2))
        );
        assert_eq!(
            (levels.level_of(ends[0] - 1), levels.level_of(ends[0])),
            (0, 1)
        );
        // Ranks below the thresholds of the levels are those of the levels.
        let below = [0.25, 0.5, 1.0].map(|rank| levels.below(rank).unwrap());
        assert_eq!(below.to_vec(), ends);
        // The number beside the slider names the prefix that it was asked of, and no more.
        for count in [1, 2, ends[0], ends[1], ends[1] + 1, ends[2]] {
            let threshold = levels.threshold(count).unwrap();
            assert_eq!(levels.below(threshold), Some(count));
        }
        let whole = ends.iter().map(|&end| levels.threshold(end).unwrap());
        assert_eq!(whole.collect::<Vec<f64>>(), [0.25, 0.5, 1.0]);
        let equal = NestedLevels {
            ranks: vec![0.1, 0.1, 0.3],
            ..levels.clone()
        };
        assert_eq!(
            [1, 2].map(|count| equal.threshold(count)),
            [None, Some(0.3)]
        );

        let cut = levels.cut(ends[1] + 1);
        assert_eq!((cut.len(), cut[1]), (3, levels.claims[1]));
        assert_eq!(
            (cut[2].distance, cut[2].covering),
            (0.03, Some(levels.claims[1].distance))
        );
        assert!((levels.disk_radius(1) / 0.06 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn recorded_levels_are_the_levels_again() {
        let session = made(None);
        let levels = session.nested.as_ref().unwrap();
        let recording = Arc::new(levels.recording(session.run()).unwrap());
        let again = Session::from_recording(Arc::clone(&recording), 2);
        let nested = again.nested.as_ref().unwrap();
        assert_eq!(
            (&nested.claims, &nested.ranks),
            (&levels.claims, &levels.ranks)
        );
        assert_eq!(
            (nested.asked, &nested.stated),
            (levels.asked, &levels.stated)
        );
        assert_eq!(again.digest(), session.digest());

        // The first samples, as before an open question, claim what the whole set claims of them.
        let count = levels.claims[1].count;
        for first in [1, count - 1, count, count + 1] {
            let cut = Session::from_recording(Arc::new(recording.until(first)), 3);
            let nested = cut.nested.as_ref().unwrap();
            assert_eq!(
                (cut.summary.count, nested.claim(first)),
                (first, levels.claim(first))
            );
            assert_eq!(nested.claims, levels.cut(first));
            // What follows is not known, and a level that is whole says nothing of it.
            assert_eq!(nested.threshold(first), None);
        }

        // Of painted samples only the distance is claimed, and no recipe makes them.
        let painted = recording.painted(&[0, count as u32 + 1]).unwrap();
        let painted = Session::from_recording(Arc::new(painted), 4)
            .nested
            .unwrap();
        assert!(painted.asked.is_none());
        let claim = PrefixClaim {
            count: 2,
            covering: None,
            ..levels.claims[2]
        };
        assert_eq!(painted.claims, [claim]);
    }

    #[test]
    fn exactly_so_many_samples_end_within_a_level() {
        let session = made(Some(500));
        let levels = session.nested.as_ref().unwrap();
        assert_eq!(
            (session.summary.count, levels.ends().last()),
            (500, Some(500))
        );
        assert_eq!(levels.whole(500), Some(1));
    }

    #[test]
    fn claims_from_outside_have_to_fit() {
        let levels = made(None).nested.unwrap();
        let count = levels.claims[2].count;
        assert!(fit(&levels.claims, count, 0.03));
        assert!(!fit(&levels.claims, count + 1, 0.03) && !fit(&levels.claims, count, 3.0));
        let mut claims = levels.claims.clone();
        claims.swap(0, 1);
        assert!(!fit(&claims, count, 0.03));
        claims.swap(0, 1);
        claims[1].distance = f64::NAN;
        assert!(!fit(&claims, count, 0.03));
    }
}
