//! Runs in space: the numbers of a moment are those of its samples from nothing, wherever the cursor came from.

use std::sync::Arc;

use tilescope_analysis::measures::{MeasuredSet, space_number};
use tilescope_core::{
    Boundary, Domain, Parameters, RunEvent, SolidDomain, Stage, Unobserved, solid_sample,
};
use tilescope_debugger::{DEFAULT_BUDGET, Debugger, MomentNumbers, Recording};
use tilescope_live::{
    Course, CurveError, CurveMaker, LiveMoment, MOMENT_NUMBERS, NumberError, SPACE_MOMENT_NUMBERS,
    Wanted, numbers_named, space_numbers, space_numbers_named,
};

const PAIRS: Wanted = Wanted {
    spectrum: false,
    thinned: false,
    pairs: true,
    cover: false,
};

const SIZE: [f64; 3] = [11.0, 10.0, 4.5];

fn recorded(seed: u64, boundary: Boundary) -> Recording {
    let domain = SolidDomain::from_size(SIZE, 1.0, boundary).unwrap();
    let planar = Domain::from_size([SIZE[0], SIZE[1]], 1.0, boundary).unwrap();
    let parameters = Parameters {
        seed,
        ..Parameters::default()
    };
    Recording::in_space(domain, planar, &parameters, DEFAULT_BUDGET, &mut Unobserved).unwrap()
}

/// Returns the places of the samples that have arrived at a cursor, by their events alone, in user units.
fn arrived(recording: &Recording, cursor: usize) -> Vec<[f64; 3]> {
    let domain = recording.domain_in_space().unwrap();
    let events = (0..cursor).filter_map(|event| recording.event(event)?.run_event());
    let samples = events.filter_map(|event| match event {
        RunEvent::Insert { sample, .. } => Some(sample as usize),
        _ => None,
    });
    let places: Vec<[i32; 3]> = samples
        .map(|sample| {
            let at = recording.run().samples.points[sample];
            [at.x, at.y, recording.heights().unwrap()[sample]]
        })
        .collect();
    domain.users_from_lattice(&places)
}

/// Returns the conflicts and the smallest distance of all pairs, by their definition: every image is looked at.
fn of_all_pairs(recording: &Recording, points: &[[f64; 3]]) -> (u64, f64) {
    let is_periodic = recording.domain_in_space().unwrap().boundary() == Boundary::Periodic;
    let shifts: &[f64] = if is_periodic {
        &[-1.0, 0.0, 1.0]
    } else {
        &[0.0]
    };
    let along = |a: &[f64; 3], b: &[f64; 3], axis: usize| {
        let images = shifts
            .iter()
            .map(|shift| a[axis] - b[axis] + shift * SIZE[axis]);
        images
            .map(|offset| offset * offset)
            .fold(f64::INFINITY, f64::min)
    };
    // A sample of a periodic box has a copy one side away.
    let own = if is_periodic { SIZE[2] } else { f64::INFINITY };
    let (mut conflicts, mut least) = (0, own);
    for (index, a) in points.iter().enumerate() {
        for b in &points[..index] {
            let square: f64 = (0..3).map(|axis| along(a, b, axis)).sum();
            conflicts += u64::from(square < 1.0);
            least = least.min(square.sqrt());
        }
    }
    (conflicts, least)
}

fn value(set: &MeasuredSet, key: &str) -> Option<f64> {
    space_number(key).unwrap().of(set)
}

/// Returns whether the numbers of a moment are those of the samples of a cursor.
fn agrees(set: &MeasuredSet, recording: &Recording, cursor: usize) -> bool {
    let points = arrived(recording, cursor);
    if points.is_empty() {
        return set.samples == 0 && value(set, "min_distance_r").is_none();
    }
    let (conflicts, min_distance) = of_all_pairs(recording, &points);
    let density = points.len() as f64 / SIZE.into_iter().product::<f64>();
    let is_near = |key, expected: f64| {
        // Sides of the lattice are rounded to whole units, of which a side has more than 2^17.
        match value(set, key) {
            Some(found) => (found - expected).abs() <= 1e-5 * expected,
            None => !expected.is_finite(),
        }
    };
    set.samples == points.len()
        && value(set, "conflicts") == Some(conflicts as f64)
        && is_near("density", density)
        && is_near("min_distance_r", min_distance)
}

/// Sixty courses through small runs: steps, moves in both directions and jumps.
#[test]
fn numbers_of_a_moment_in_space_are_those_of_all_pairs() {
    let mut state = 1_u64;
    let mut random = |end: usize| {
        // Knuth's linear congruential generator: its high bits are random enough to choose cursors.
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 33) as usize % (end + 1)
    };
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        let recording = recorded(3, boundary);
        let course = Arc::new(Course::of_recording(&recording));
        let events = course.events();
        for _ in 0..30 {
            let mut moment = LiveMoment::new(Arc::clone(&course));
            let mut cursor = random(events);
            for _ in 0..5 {
                cursor = match random(3) {
                    0 => (cursor + 1).min(events),
                    1 => cursor.saturating_sub(1 + random(400)),
                    2 => (cursor + random(400)).min(events),
                    _ => random(events),
                };
                // Small budgets go on from call to call.
                while !moment.seek(cursor, PAIRS, 5_000).unwrap().arrived {}
                assert!(agrees(&moment.measured(), &recording, cursor), "{cursor}");
            }
        }

        // The control: a sample that arrived since is missed.
        let mut moment = LiveMoment::new(Arc::clone(&course));
        let change = course.changes()[40].event as usize;
        moment.seek(change, PAIRS, u64::MAX).unwrap();
        assert!(!agrees(&moment.measured(), &recording, change + 1));
    }
}

#[test]
fn active_cubes_are_those_of_the_throw_at_work() {
    let recording = recorded(5, Boundary::Periodic);
    let course = Course::of_recording(&recording);
    let throws = recording.active_cubes();
    assert_eq!(course.active(0), 0);
    assert_eq!(course.active(course.events()), 0);
    for cursor in 1..course.events() {
        let Stage::Iterate(throw) = course.stage(cursor) else {
            assert_eq!(course.active(cursor), 0);
            continue;
        };
        assert_eq!(
            course.active(cursor) as usize,
            throws[throw as usize - 1].len()
        );
    }
    assert_eq!(throws[0].len(), 11 * 10 * 5);
}

#[test]
fn a_curve_in_space_ends_at_the_set_of_the_sampler() {
    let domain = SolidDomain::from_size(SIZE, 1.0, Boundary::Periodic).unwrap();
    let course = Arc::new(Course::of_space(domain, 7, &mut Unobserved).unwrap());
    let numbers: Vec<_> = space_numbers().collect();
    let mut maker = CurveMaker::new(Arc::clone(&course), &numbers, None).unwrap();
    while !maker.proceed(10_000).unwrap() {}
    let curve = maker.finish();
    let made = solid_sample(domain, 7, &mut Unobserved).unwrap();
    let last = |key: &str| {
        let column = curve.numbers.iter().position(|number| number.key == key);
        *curve.columns[column.unwrap()].last().unwrap()
    };
    assert_eq!(last("samples").to_bits(), (made.len() as f64).to_bits());
    let density = made.len() as f64 / (11.0 * 10.0 * 4.5);
    assert!((last("density") - density).abs() < 1e-5, "{density}");
    assert!(last("min_distance_r") >= 1.0 && last("min_distance_r") < 1.01);
    assert!(
        curve.columns[3]
            .iter()
            .skip(1)
            .all(|conflicts| conflicts.to_bits() == 0)
    );
    // Each throw has a row where it begins, with the number of its cubes.
    let recording = recorded(7, Boundary::Periodic);
    let column = curve
        .numbers
        .iter()
        .position(|number| number.key == "active_cubes");
    let mut cubes = curve.columns[column.unwrap()]
        .iter()
        .map(|count| *count as usize);
    assert_eq!(cubes.next(), Some(0));
    for throw in recording.active_cubes() {
        assert!(cubes.any(|count| count == throw.len()), "{}", throw.len());
    }
}

#[test]
fn numbers_of_the_other_kind_of_set_are_refused() {
    let in_space = space_numbers_named(&["gaps"]).unwrap_err();
    assert!(matches!(in_space, NumberError::NotHere { .. }));
    let text = in_space.to_string();
    assert!(text.contains("\"gaps\" is not followed in space") && text.contains("active_cubes"));
    let planar = numbers_named(&["active_cubes"]).unwrap_err().to_string();
    assert!(planar.contains("is not followed in the plane"), "{planar}");
    let unknown = space_numbers_named(&["cubes"]).unwrap_err();
    assert!(matches!(unknown, NumberError::Unknown { .. }));

    let domain = SolidDomain::from_size(SIZE, 1.0, Boundary::Periodic).unwrap();
    let course = Arc::new(Course::of_space(domain, 7, &mut Unobserved).unwrap());
    let gaps = numbers_named(&["gaps"]).unwrap();
    let refused = CurveMaker::new(course, &gaps, None)
        .map(|_| ())
        .unwrap_err();
    assert!(
        matches!(refused, CurveError::NotHere { key: "gaps", .. }),
        "{refused}"
    );
}

#[test]
fn watches_of_a_run_in_space_have_its_numbers() {
    let recording = Arc::new(recorded(3, Boundary::Periodic));
    recording.give_numbers(|| Arc::clone(&SPACE_MOMENT_NUMBERS));
    let mut debugger = Debugger::new(Arc::clone(&recording), DEFAULT_BUDGET);
    debugger.jump(recording.len() / 2);
    // Projections of balls to a plane are much closer than r, and would be conflicts there.
    assert_eq!(debugger.evaluate("conflicts"), Ok("0".to_owned()));
    assert_eq!(
        debugger.evaluate("min_distance_r >= 1"),
        Ok("true".to_owned())
    );
    assert_eq!(debugger.evaluate("gaps"), Ok("none".to_owned()));
    assert_eq!(debugger.evaluate("active_cubes > 0"), Ok("true".to_owned()));
    debugger.jump(recording.len());
    assert_eq!(debugger.evaluate("active_cubes"), Ok("0".to_owned()));

    // The panel lists the meaning in space, which of the density is another one than in the plane.
    let density = |numbers: &MomentNumbers| {
        let found = numbers.names.iter().find(|number| number.name == "density");
        found.unwrap().meaning
    };
    let [in_space, planar] =
        [&SPACE_MOMENT_NUMBERS, &MOMENT_NUMBERS].map(|numbers| density(numbers));
    assert_eq!(in_space, space_number("density").unwrap().meaning);
    assert_ne!(in_space, planar);
}
