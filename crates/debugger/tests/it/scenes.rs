//! Scenes outlive their run: in it they are at their events, in other runs at their anchors or nowhere.

use std::sync::Arc;

use tilescope_core::{Parameters, Unobserved};
use tilescope_debugger::{DEFAULT_BUDGET, Debugger, Marked, Recording, SavedScene, Session};

use crate::support::restored;

fn debugger(seed: u64, radius: f64) -> Debugger {
    let parameters = Parameters {
        seed,
        radius,
        leaf: 8.0,
        ..Parameters::default()
    };
    let recording = Recording::new(&parameters, DEFAULT_BUDGET, &mut Unobserved).unwrap();
    Debugger::new(Arc::new(recording), DEFAULT_BUDGET)
}

/// Where the scenes of a session are.
fn marked(debugger: &Debugger) -> Vec<Marked> {
    let marks = debugger.scenes.iter();
    marks.map(|mark| debugger.marked(mark)).collect()
}

#[test]
fn every_event_is_found_by_its_anchor() {
    let debugger = debugger(1, 0.04);
    let recording = debugger.recording();
    for event in (0..recording.len()).step_by(37) {
        let anchor = recording.anchor(event).unwrap();
        assert_eq!(recording.anchored(&anchor), Some(event), "{anchor}");
        assert_eq!(anchor.to_string().parse(), Ok(anchor));
    }
    let last = recording.anchor(recording.len() - 1).unwrap();
    let behind = tilescope_debugger::Anchor {
        ordinal: last.ordinal + 1,
        ..last
    };
    assert_eq!(recording.anchored(&behind), None);
    let far = tilescope_debugger::Anchor {
        ordinal: usize::MAX,
        ..last
    };
    assert_eq!(recording.anchored(&far), None);
}

#[test]
fn scenes_stay_with_their_moments_in_other_runs_and_come_back_exactly() {
    let mut first = debugger(1, 0.02);
    let len = first.recording().len();
    let moments = [0, 5, len / 2, len - 40, len];
    for cursor in moments {
        first.jump(cursor);
        first.add_scene(usize::MAX, serde_json::Value::Null);
    }
    first.scenes[2].caption = "half".to_owned();
    assert_eq!(marked(&first), moments.map(Marked::Here));
    let set = first.scenes.clone();
    // A run of fewer samples does not have them all.
    let mut small = debugger(2, 0.06);
    small.put_stops(first.take_stops()).unwrap();
    assert!(first.scenes.is_empty());
    let there = marked(&small);
    assert_eq!(there[0], Marked::Like(0));
    assert!(there.contains(&Marked::Nowhere));
    for mark in &small.scenes {
        if let Marked::Like(cursor) = small.marked(mark) {
            let last = cursor.checked_sub(1);
            let anchor = last.and_then(|event| small.recording().anchor(event));
            match mark.ends {
                Some(stage) => assert_eq!(small.recording().end_of(stage), Some(cursor)),
                None => assert_eq!(anchor, mark.anchor),
            }
        }
    }
    // They are saved with this run, which has fewer events, and are restored in the first one.
    let text = small.session().to_json().unwrap();
    let saved = Session::from_json(&text).unwrap();
    let mut restored = restored(&saved).unwrap();
    assert_eq!(restored.scenes, small.scenes);
    let mut again = debugger(1, 0.02);
    again.put_stops(restored.take_stops()).unwrap();
    assert_eq!(again.scenes, set);
    assert_eq!(marked(&again), moments.map(Marked::Here));
}

#[test]
fn saved_scenes_that_name_no_run_are_of_the_run_that_was_saved() {
    let mut debugger = debugger(1, 0.04);
    debugger.jump(77);
    debugger.add_scene(usize::MAX, serde_json::Value::Null);
    let set = debugger.scenes.clone();
    let mut saved = debugger.session();
    saved.scenes = vec![SavedScene {
        event: 77,
        ..SavedScene::default()
    }];
    let text = saved.to_json().unwrap();
    assert!(!text.contains("anchor") && !text.contains("\"run\""));
    let saved = Session::from_json(&text).unwrap();
    let back = restored(&saved).unwrap();
    assert_eq!(back.scenes, set);
}
