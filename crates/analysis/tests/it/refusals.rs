//! Input that cannot be judged is refused, with the sample and the limit, and a judgement can be stopped.

use std::ops::ControlFlow;

use crate::support::{BOTH, judge, maximal_set, region};
use tilescope_analysis::{Boundary, Progress, VerifyError, VerifyOptions, verify};

#[test]
fn unreadable_sets_are_refused_with_the_place() {
    let good = vec![[0.1, 0.1], [0.5, 0.9], [0.8, 0.2]];
    let with = |index: usize, point: [f64; 2]| {
        let mut points = good.clone();
        points[index] = point;
        points
    };
    for boundary in BOTH {
        let square = region(1.0, 1.0, boundary);
        assert!(judge(&good, square, 0.3).is_ok());
        assert_eq!(judge(&[], square, 0.3), Err(VerifyError::Empty));
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let error = judge(&with(1, [0.5, bad]), square, 0.3);
            assert!(matches!(
                error,
                Err(VerifyError::NotFinite { index: 1, .. })
            ));
        }
        for point in [[-1e-300, 0.5], [0.5, 1.0 + 1e-15], [7.0, 0.5]] {
            let error = judge(&with(2, point), square, 0.3);
            let expected = VerifyError::OutOfRegion {
                index: 2,
                point,
                region: square,
            };
            assert_eq!(error, Err(expected));
        }
        let far_side = judge(&with(2, [1.0, 0.2]), square, 0.3);
        assert_eq!(far_side.is_ok(), boundary == Boundary::Bounded);
    }
}

#[test]
fn impossible_questions_are_refused() {
    let points = [[0.1, 0.1], [0.5, 0.9], [0.8, 0.2]];
    let square = region(1.0, 1.0, Boundary::Periodic);
    for radius in [0.0, -0.1, f64::NAN, f64::INFINITY, 1e-40, 1e40] {
        let error = judge(&points, square, radius);
        assert!(
            matches!(error, Err(VerifyError::BadRadius { .. })),
            "{radius}"
        );
    }
    for extent in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-200, 1e200] {
        let error = judge(&points, region(1.0, extent, Boundary::Periodic), 0.1);
        assert!(
            matches!(error, Err(VerifyError::BadRegion { .. })),
            "{extent}"
        );
    }
    let options = VerifyOptions {
        covering_tolerance: f64::NAN,
        ..VerifyOptions::default()
    };
    let error = verify(&points, square, 0.1, &options, &|_| {
        ControlFlow::Continue(())
    });
    assert!(matches!(error, Err(VerifyError::BadTolerance { .. })));
}

#[test]
fn errors_name_the_value_and_the_limit() {
    let square = region(1.0, 2.0, Boundary::Periodic);
    let error = judge(&[[0.5, 0.5], [1.0, 0.25]], square, 0.1).expect_err("outside");
    assert_eq!(
        error.to_string(),
        "sample 1 at (1, 0.25) lies outside the region periodic [0, 1) x [0, 2): in a periodic region the upper side is the lower \
         one, at 0; a set that has both is of a bounded region"
    );
    let error = judge(&[[0.5, 0.5], [1.5, 0.25]], square, 0.1).expect_err("outside");
    assert!(error.to_string().ends_with("[0, 2)"), "{error}");
    let error = judge(&[[0.5, 0.5]], square, -3.0).expect_err("negative");
    assert!(error.to_string().starts_with("the radius -3 is not"));
}

#[test]
fn cancelling_stops_at_any_moment() {
    let torus = region(1.0, 1.0, Boundary::Periodic);
    let points = maximal_set(torus, 0.02, 9);
    let options = VerifyOptions {
        tile_samples: 100,
        ..VerifyOptions::default()
    };
    // Two searches of the first judge and one of the second.
    let total = 3 * points.len() as u64;
    for stop in [0, 1, total / 2 + 1, total] {
        let control = |progress: Progress| {
            assert_eq!(progress.total, total);
            assert!(progress.done <= total);
            if progress.done >= stop {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let error = verify(&points, torus, 0.02, &options, &control);
        assert_eq!(error, Err(VerifyError::Cancelled), "{stop}");
    }
}
