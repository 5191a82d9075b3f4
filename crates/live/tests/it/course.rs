//! The samples of a course are those of the recording at every cursor.

use tilescope_core::{NestedRequest, Parameters, Unobserved, WithinLevel, reference_sample};
use tilescope_debugger::{Recording, Status};
use tilescope_live::{Course, CourseError};
use tilescope_sets::Recipe;

use crate::support::{cursors, record, variants};

/// Returns the ids that cover their disks at a cursor.
fn covering(recording: &Recording, cursor: usize) -> Vec<u32> {
    let ids = 0..recording.run().samples.len() as u32;
    let covers = |id: &u32| recording.status(*id, cursor).is_valid();
    ids.filter(covers).collect()
}

/// Returns the same by the course.
fn of_course(course: &Course, cursor: usize) -> Vec<u32> {
    let samples = course.samples_after(course.changes_before(cursor));
    samples.iter().map(|(id, _)| *id).collect()
}

#[test]
fn a_course_has_the_samples_and_stages_of_its_recording() {
    for parameters in variants() {
        let recording = record(&parameters);
        let course = Course::of_recording(&recording);
        assert_eq!(course.events(), recording.len());

        for cursor in cursors(recording.len()) {
            let expected = covering(&recording, cursor);
            assert_eq!(of_course(&course, cursor), expected, "{cursor}");
            let changes = course.changes_before(cursor);
            assert_eq!(course.count_after(changes), expected.len());
            let phase = recording.context(cursor).phase;
            assert!(phase.is_none_or(|phase| course.stage(cursor) == phase));
        }
    }
}

/// The control: an event later the samples differ, so that the comparison above would find it.
#[test]
fn a_course_that_is_an_event_late_is_found() {
    let recording = record(&variants()[0]);
    let course = Course::of_recording(&recording);
    let differs = |change: &tilescope_live::Change| {
        let cursor = change.event as usize + 1;
        of_course(&course, cursor - 1) != covering(&recording, cursor)
    };
    assert!(course.changes().iter().step_by(50).all(differs));
}

#[test]
fn recordings_that_were_thinned_or_cut_off_have_all_changes_until_then() {
    for parameters in variants() {
        let whole = record(&parameters);
        let thinned = Recording::new(&parameters, 1, &mut Unobserved).unwrap();
        let last = |recording: &Recording| of_course(&Course::of_recording(recording), usize::MAX);
        assert_eq!(last(&thinned), last(&whole));

        for cursor in cursors(whole.len()) {
            let cut = whole.until(cursor);
            assert_eq!(last(&cut), covering(&whole, cursor));
        }
    }
}

#[test]
fn dropped_samples_never_come() {
    let recording = record(&variants()[3]);
    let dropped = |id: &u32| recording.status(*id, recording.len()) == Status::Dropped;
    let ids: Vec<u32> = (0..recording.run().samples.len() as u32)
        .filter(dropped)
        .collect();
    assert!(!ids.is_empty());
    let course = Course::of_recording(&recording);
    let comes = |id: &u32| course.changes().iter().any(|change| change.sample == *id);
    assert!(!ids.iter().any(comes));
}

#[test]
fn the_reference_sampler_has_a_course_of_its_darts() {
    let parameters = Parameters {
        radius: 0.05,
        ..Parameters::default()
    };
    let recipe = Recipe::from(parameters);
    let course = Course::of_reference(&recipe, &mut Unobserved).unwrap();

    let domain = parameters.validate().unwrap();
    let mut expected = reference_sample(domain, parameters.seed, &mut Unobserved).unwrap();
    let samples = course.samples_after(course.changes().len());
    let mut found: Vec<_> = samples.iter().map(|(_, [x, y])| (*x, *y)).collect();
    found.sort_unstable();
    expected.sort_unstable_by_key(|point| (point.x, point.y));
    assert!(
        found
            .iter()
            .copied()
            .eq(expected.iter().map(|point| (point.x, point.y)))
    );

    // Most darts hit a disk.
    assert!(course.events() > 3 * found.len());
    assert_eq!(course.stage(0).to_string(), "iterate 1");
    assert_ne!(course.stage(course.events()), course.stage(0));
}

#[test]
fn a_moment_of_nested_levels_is_a_prefix() {
    let recipe = Recipe::from(Parameters {
        radius: 0.04,
        ..Parameters::default()
    });
    let request = NestedRequest {
        levels: 3,
        exactly: None,
        order_within: WithinLevel::Random,
    };
    let course = Course::of_levels(&recipe, &request, &mut Unobserved).unwrap();
    for cursor in [0, 1, 100, course.events()] {
        assert_eq!(
            of_course(&course, cursor),
            (0..cursor as u32).collect::<Vec<_>>()
        );
    }
    assert_eq!(course.final_count(), course.events());
}

#[test]
fn runs_of_too_many_samples_are_refused_by_the_limit() {
    let recipe = Recipe::from(Parameters {
        radius: 0.0002,
        ..Parameters::default()
    });
    let Err(error) = Course::of_reference(&recipe, &mut Unobserved) else {
        panic!("17 million samples");
    };
    assert!(matches!(error, CourseError::TooMany { .. }));
    let text = error.to_string();
    assert!(
        text.contains("2000000") && text.contains("about 174"),
        "{text}"
    );
}
