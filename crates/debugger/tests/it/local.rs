//! Recordings of runs in a field of radii and a shape: what each event says is compared with all samples, looked at one by one.

use std::sync::Arc;

use tilescope_core::{
    Boundary, Domain, Locality, Parameters, Point, R, RadiusField, RunEvent, Shape, Unobserved,
    Verdict,
};
use tilescope_debugger::{
    DEFAULT_BUDGET, Debugger, Recording, SessionError, State, Status, VERSION, sentence, why,
};

use crate::support::restored;

/// A field that grows to the right, in a polygon with a notch; a unit of length is r.
fn locality() -> Arc<Locality> {
    let domain = Domain::from_size([24.0, 20.0], 1.0, Boundary::Bounded).unwrap();
    let [columns, rows] = RadiusField::node_counts(&domain, 15).unwrap();
    let node = |index: usize| R + (index % columns) as i32 * (R / 12);
    let nodes: Vec<i32> = (0..columns * rows).map(node).collect();
    let corners = [(0, 0), (23, 1), (12, 8), (10, 19)].map(|(x, y)| Point::new(x * R, y * R));
    Arc::new(Locality {
        field: RadiusField::from_nodes(domain, 15, &nodes).unwrap(),
        shape: Shape::polygon(&[corners.to_vec()]).unwrap(),
    })
}

fn recorded() -> Arc<Recording> {
    let parameters = Parameters {
        seed: 5,
        ..Parameters::default()
    };
    let made = Recording::with_locality(&locality(), &parameters, DEFAULT_BUDGET, &mut Unobserved);
    Arc::new(made.unwrap())
}

#[test]
fn covered_darts_name_the_first_sample_that_is_near_them() {
    let (recording, locality) = (recorded(), locality());
    let points = &recording.run().samples.points;
    let (mut there, mut counts) = (0, [0; 3]);

    for index in 0..recording.len() {
        let said = sentence(&recording, index);
        match recording.event(index).unwrap().run_event() {
            Some(RunEvent::Insert { sample, .. }) => {
                assert_eq!(sample as usize, there);
                assert!(said.contains("its radius is"), "{said}");
                there += 1;
            }
            Some(RunEvent::Dart {
                point,
                verdict: Verdict::Covered { .. },
                ..
            }) => {
                let first = points[..there]
                    .iter()
                    .position(|&sample| locality.is_near(sample, point));
                let by = first.expect("a sample is near");
                let name = format!(": sample {by} is ");
                assert!(
                    said.contains(&name) && said.contains("harmonic mean"),
                    "{said}"
                );
                let born = recording.life(by as u32).unwrap().born as usize;
                assert_eq!(why::cause(&recording, index), Some(born));
                counts[0] += 1;
            }
            Some(RunEvent::Dart {
                verdict: Verdict::Thinned,
                ..
            }) => {
                assert!(said.contains("left out by its coin"), "{said}");
                counts[1] += 1;
            }
            Some(RunEvent::Dart {
                point,
                verdict: Verdict::Accepted,
                ..
            }) => {
                assert_eq!(recording.covering(point, index), None, "{said}");
                counts[2] += 1;
            }
            _ => {}
        }
    }
    assert_eq!(there, points.len());
    assert!(counts.iter().all(|&count| count > 0), "{counts:?}");
}

#[test]
fn a_covered_dart_that_one_radius_everywhere_would_not_cover_is_found() {
    let (recording, locality) = (recorded(), locality());
    // Darts are covered from farther away than R here. Were samples looked for within R, these would have no cause.
    let far = (0..recording.len()).filter(|&index| {
        let Some(RunEvent::Dart {
            point,
            verdict: Verdict::Covered { .. },
            ..
        }) = recording.event(index).unwrap().run_event()
        else {
            return false;
        };
        let within = recording.ever_near(point, R);
        let born = |id: &u32| (recording.life(*id).unwrap().born as usize) < index;
        !within.iter().any(born) && locality.radius_at(point) > R
    });
    assert!(far.count() > 10);
}

#[test]
fn every_moment_has_the_samples_inserted_before_it() {
    let recording = recorded();
    let mut state = State::default();
    for cursor in [0, 700, recording.len(), recording.len() / 2, 3] {
        state.seek(&recording, cursor);
        let ids = 0..recording.run().samples.len() as u32;
        let kept = ids.filter(|&id| recording.status(id, cursor) == Status::Kept);
        let count = kept.count();
        assert_eq!(
            (state.counts().kept, state.counts().inserted),
            (count, count)
        );
        assert_eq!(state, State::at(&recording, cursor));
    }
}

#[test]
fn a_saved_session_is_restored_in_its_field_alone() {
    let recording = recorded();
    let mut debugger = Debugger::new(Arc::clone(&recording), DEFAULT_BUDGET);
    debugger.jump(500);
    let mut saved = debugger.session();
    saved.ground = serde_json::json!("a field");
    assert_eq!(saved.version, VERSION - 2);
    assert!(matches!(restored(&saved), Err(SessionError::Ground)));

    let again = saved.record_in(&locality(), &mut Unobserved).unwrap();
    let again = Debugger::resume(&saved, Arc::new(again)).unwrap();
    assert_eq!(again.state().cursor(), 500);
    // Another shape gives other samples, which the digest shows.
    let other = Arc::new(Locality {
        shape: Shape::rectangle(),
        ..Locality::clone(&locality())
    });
    let other = saved.record_in(&other, &mut Unobserved).unwrap();
    let resumed = Debugger::resume(&saved, Arc::new(other));
    assert!(matches!(resumed, Err(SessionError::Different { .. })));
}
