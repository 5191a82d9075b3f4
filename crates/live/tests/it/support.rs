//! Small runs of every variant, and what is measured of a moment from nothing.

use std::ops::ControlFlow;
use std::sync::Arc;

use tilescope_analysis::measures::{MeasuredSet, Part};
use tilescope_core::{Boundary, Insertion, Parameters, PatternSpec, Unobserved, Variant};
use tilescope_debugger::{DEFAULT_BUDGET, Recording};
use tilescope_live::Course;

/// Returns parameters of runs of some hundred samples: staged, darts and printed, periodic and bounded.
pub fn variants() -> Vec<Parameters> {
    let kinds = [
        (Variant::Staged, Insertion::Circumcentre),
        (Variant::Staged, Insertion::Uniform),
        (Variant::AsPrinted, Insertion::Circumcentre),
    ];
    let boundaries = [Boundary::Periodic, Boundary::Bounded];
    let all = boundaries.into_iter().flat_map(|boundary| {
        kinds.map(|(variant, insertion)| Parameters {
            height: 0.7,
            radius: 1.0 / 22.0,
            leaf: 6.0,
            seed: 5,
            boundary,
            variant,
            insertion,
            pattern: PatternSpec {
                side: 20.0,
                ..PatternSpec::default()
            },
            ..Parameters::default()
        })
    });
    all.collect()
}

/// Records a run.
pub fn record(parameters: &Parameters) -> Recording {
    Recording::new(parameters, DEFAULT_BUDGET, &mut Unobserved).unwrap()
}

/// Returns the course of a run.
pub fn course(parameters: &Parameters) -> Arc<Course> {
    Arc::new(Course::of_recording(&record(parameters)))
}

/// Returns cursors all over a run, in a sequence that jumps and steps both ways.
pub fn cursors(events: usize) -> Vec<usize> {
    let mut all: Vec<usize> = (0..=12).map(|k| k * events / 12).collect();
    let step = |cursor: usize| [cursor + 1, cursor, cursor.saturating_sub(3)];
    all.extend((0..12).flat_map(|k| step(k * 7 % 12 * events / 12 + 5)));
    all.retain(|cursor| *cursor <= events);
    all
}

/// Measures parts of the samples at a cursor from nothing.
pub fn from_nothing(course: &Course, cursor: usize, parts: &[Part]) -> MeasuredSet {
    let samples = course.samples_after(course.changes_before(cursor));
    let domain = course.domain();
    let user = |(_, [x, y]): &(u32, [i32; 2])| {
        domain.user_from_lattice(tilescope_core::Point::new(*x, *y))
    };
    let points: Vec<[f64; 2]> = samples.iter().map(user).collect();

    let mut set = MeasuredSet::new(points.len(), course.region(), Some(domain.radius()));
    let control = |_| ControlFlow::Continue(());
    for part in parts {
        set.measure(*part, &points, &control).unwrap();
    }
    set
}
