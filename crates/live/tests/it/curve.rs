//! Curves: a row for each change, with the numbers of that moment.

use std::collections::BTreeSet;
use std::sync::Arc;

use tilescope_analysis::measures::{Part, number};
use tilescope_core::{Domain, Parameters, Stage, TilingMethod};
use tilescope_live::{
    Course, Curve, CurveError, CurveMaker, NumberError, is_of_spectrum, live_numbers, numbers_named,
};

use crate::support::{course, from_nothing, record, variants};

/// Makes a curve in slices.
fn made(course: &Arc<Course>, keys: &[&str], moments: Option<usize>) -> Curve {
    let numbers = numbers_named(keys).unwrap();
    let mut maker = CurveMaker::new(Arc::clone(course), &numbers, moments).unwrap();
    let mut before = 0;
    while !maker.proceed(1_000_000).unwrap() {
        let [done, total] = maker.progress();
        assert!(before <= done && done < total);
        before = done;
    }
    maker.finish()
}

#[test]
fn a_row_follows_every_change() {
    for parameters in variants() {
        let course = course(&parameters);
        let curve = made(&course, &["samples", "conflicts", "gaps"], None);
        let changes = course.changes();
        assert_eq!(curve.events.len(), changes.len() + 2, "and both ends");
        assert_eq!((curve.events[0], curve.stages[0]), (0, Stage::Pattern));
        assert_eq!(curve.events.last(), Some(&course.events()));
        assert_eq!(curve.stages.last(), Some(&Stage::Finish));
        for (row, change) in changes.iter().enumerate() {
            assert_eq!(curve.events[row + 1], change.event as usize + 1);
            let count = curve.columns[0][row + 1].to_bits();
            assert_eq!(count, f64::from(change.count).to_bits());
        }

        // Rows all over the run have the verdict from nothing.
        for row in (1..curve.events.len()).step_by(curve.events.len() / 12) {
            let set = from_nothing(&course, curve.events[row], &[Part::Report]);
            for (number, column) in curve.numbers.iter().zip(&curve.columns) {
                // There is no verdict on no samples.
                let expected = number.of(&set).unwrap_or(f64::NAN);
                assert_eq!(
                    expected.to_bits(),
                    column[row].to_bits(),
                    "{} {row}",
                    number.key
                );
            }
        }
        assert!(curve.columns[1].iter().any(|conflicts| *conflicts > 0.0));
    }
}

#[test]
fn the_last_row_has_every_number_of_the_finished_set() {
    let keys: Vec<&str> = live_numbers().map(|number| number.key).collect();
    for parameters in variants() {
        let course = course(&parameters);
        let curve = made(&course, &keys, Some(5));
        assert_eq!(curve.events.len(), 5);
        let expected = from_nothing(&course, course.events(), &[Part::Report, Part::Spectrum]);
        for (number, column) in curve.numbers.iter().zip(&curve.columns) {
            let (found, expected) = (column[4], number.of(&expected).unwrap_or(f64::NAN));
            let tolerance = if is_of_spectrum(number) { 1e-3 } else { 2e-6 };
            assert!(
                (found - expected).abs() <= tolerance * expected.abs().max(1.0)
                    || (found.is_nan() && expected.is_nan()),
                "{}: {found} {expected}",
                number.key
            );
        }
    }
}

#[test]
fn a_curve_of_no_sample_and_of_one_has_empty_cells() {
    let domain = Domain::from_size([1.0, 1.0], 0.05, tilescope_core::Boundary::Periodic).unwrap();
    let keys = ["samples", "min_distance_r", "gaps", "low_power"];
    let none = Arc::new(Course::of_order(domain, &[]));
    let csv = made(&none, &keys, None).csv();
    assert_eq!(
        csv,
        "event,stage,samples,min_distance_r,gaps,low_power\n0,finish,0,,,\n"
    );

    let point = domain.lattice_from_user([0.3, 0.6]);
    let one = Arc::new(Course::of_order(domain, &[point]));
    let curve = made(&one, &keys[..3], None);
    assert_eq!(curve.events, [0, 1]);
    let set = from_nothing(&one, 1, &[Part::Report]);
    for (column, number) in curve.columns.iter().zip(&curve.numbers) {
        assert_eq!(Some(column[1]), number.of(&set), "{}", number.key);
    }
}

#[test]
fn a_curve_of_a_recording_that_was_cut_off_ends_there() {
    let whole = record(&variants()[0]);
    let course = Course::of_recording(&whole);
    let middle = course.changes()[course.changes().len() / 2].event as usize + 1;
    let cut = Arc::new(Course::of_recording(&whole.until(middle)));
    let keys = ["samples", "conflicts", "min_distance_r"];
    let (part, all) = (
        made(&cut, &keys, None),
        made(&Arc::new(course), &keys, None),
    );
    assert_eq!(part.events.last(), Some(&middle));
    let rows = part.events.len();
    assert_eq!(part.events, all.events[..rows]);
    for (part, all) in part.columns.iter().zip(&all.columns) {
        let bits = |column: &[f64]| {
            column
                .iter()
                .map(|value| value.to_bits())
                .collect::<Vec<_>>()
        };
        assert_eq!(bits(part), bits(&all[..rows]));
    }
}

#[test]
fn numbers_are_refused_by_name() {
    let error = |keys: &[&str]| numbers_named(keys).unwrap_err();
    let known = |error: &NumberError| {
        let text = error.to_string();
        text.contains("samples") && text.contains("covering_radius_r") && !text.contains("bond_")
    };
    let unknown = error(&["samples", "conflict"]);
    assert!(matches!(&unknown, NumberError::Unknown { key, .. } if key == "conflict"));
    assert!(known(&unknown), "{unknown}");
    let whole = error(&["mean_sides"]);
    assert!(matches!(&whole, NumberError::NotLive { key, .. } if key == "mean_sides"));
    assert!(known(&whole), "{whole}");
    assert_eq!(
        error(&["gaps", "gaps"]),
        NumberError::Twice {
            key: "gaps".to_owned()
        }
    );
    assert!(known(&error(&[])));
    assert_eq!(
        numbers_named(&["gaps"]).unwrap()[0].name,
        number("gaps").unwrap().name
    );
}

#[test]
fn spectra_of_large_sets_and_curves_of_one_moment_are_refused() {
    let parameters = Parameters {
        radius: 0.005,
        ..Parameters::default()
    };
    let domain = parameters.validate().unwrap();
    let points: Vec<_> = (0..20_001)
        .map(|i| domain.lattice_from_user([f64::from(i % 150) / 150.0, f64::from(i / 150) / 150.0]))
        .collect();
    let course = Arc::new(Course::of_order(domain, &points));
    let begin = |keys: &[&str], moments| {
        let numbers = numbers_named(keys).unwrap();
        CurveMaker::new(Arc::clone(&course), &numbers, moments).map(|_| ())
    };
    let error = begin(&["samples", "peak"], None).unwrap_err();
    assert_eq!(
        error,
        CurveError::TooMany {
            key: "peak",
            count: 20_001
        }
    );
    assert!(error.to_string().contains("20000"), "{error}");
    let error = begin(&["samples"], Some(1)).unwrap_err();
    assert_eq!(error, CurveError::TooFewMoments { moments: 1 });
    assert_eq!(begin(&["samples"], Some(2)), Ok(()));
}

#[test]
fn iterations_of_exact_tilings_are_named_by_their_levels() {
    let kdrt = Parameters {
        radius: 0.05,
        ..Parameters::default()
    };
    let exact = Parameters {
        method: TilingMethod::Exact,
        ..kdrt
    };
    let names = |parameters: &Parameters| -> BTreeSet<String> {
        let curve = made(&course(parameters), &["samples"], None);
        curve.stage_names().collect()
    };
    let (levels, iterations) = (names(&exact), names(&kdrt));
    assert!(
        levels.contains("levels 0 and 1") && !levels.contains("iterate 1"),
        "{levels:?}"
    );
    // Negative control: KDRT has iterations and no levels.
    assert!(iterations.contains("iterate 1") && !iterations.contains("levels 0 and 1"));
}
