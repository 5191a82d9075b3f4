//! A recording cut off at a cursor has the same past and no future.

use tilescope_core::{Fate, Stage};
use tilescope_debugger::{
    DEFAULT_BUDGET, EventKind, Outline, Recording, State, Status, density, sentence,
};

use crate::support::{record, statuses, variants};

/// The cursors at which recordings are cut off: every phase, and moments in between.
fn cursors(recording: &Recording) -> Vec<usize> {
    let mut cursors: Vec<usize> = (0..40).map(|k| k * recording.len() / 39).collect();
    let begins = recording.tape().iter().enumerate();
    cursors.extend(
        begins
            .filter(|(_, event)| event.depth() == 0)
            .map(|(at, _)| at),
    );
    cursors
}

#[test]
fn the_past_is_the_same() {
    for parameters in variants() {
        let whole = record(&parameters, DEFAULT_BUDGET);
        for cursor in cursors(&whole) {
            let past = whole.until(cursor);
            assert_eq!(past.len(), cursor);
            let (there, here) = (State::at(&whole, cursor), State::at(&past, cursor));
            assert_eq!(there.counts(), here.counts());
            assert_eq!(there.context(), here.context());
            let (there, here) = (statuses(&whole, cursor), statuses(&past, cursor));
            assert_eq!(there[..here.len()], here);
            assert!(there[here.len()..].iter().all(|s| *s == Status::Absent));
            for event in (0..cursor).rev().take(50) {
                assert_eq!(whole.event(event), past.event(event));
                assert_eq!(whole.context(event), past.context(event));
                // The sentence of a clip counts its samples, and only those tiled so far are known.
                let counts = whole.event(event).map(tilescope_debugger::Event::kind);
                if counts != Some(EventKind::Clip) {
                    assert_eq!(sentence(&whole, event), sentence(&past, event));
                }
                assert_eq!(whole.anchor(event), past.anchor(event));
            }
        }
    }
}

#[test]
fn nothing_is_told_of_later_events() {
    for parameters in variants() {
        let whole = record(&parameters, DEFAULT_BUDGET);
        for cursor in cursors(&whole) {
            let past = whole.until(cursor);
            let state = State::at(&past, cursor);
            let run = past.run();
            // Whatever the run holds has happened.
            for (fate, status) in run.samples.fates.iter().zip(statuses(&past, cursor)) {
                let told = match fate {
                    Fate::Undecided => Status::Undecided,
                    Fate::Kept => Status::Kept,
                    Fate::Eliminated { .. } => Status::Eliminated,
                    Fate::Dropped => Status::Dropped,
                };
                assert_eq!(told, status, "cursor {cursor}");
            }
            let summary = run.summary();
            assert_eq!(summary.eliminated, state.counts().eliminated);
            assert_eq!(
                summary.inserted.iter().sum::<usize>(),
                state.counts().inserted
            );
            // The last stage: if any event is one of it, the last event is.
            let last = cursor.checked_sub(1).and_then(|event| past.anchor(event));
            let has_finished = last.is_some_and(|anchor| anchor.stage == Stage::Finish);
            assert_eq!(run.result.is_empty(), !has_finished);
            let _ = (Outline::new(&past), density(&past, 0..cursor, 50));
            for id in 0..run.samples.len() as u32 {
                assert!(
                    past.events_of(id)
                        .iter()
                        .all(|&event| (event as usize) < cursor)
                );
            }
        }
    }
}

#[test]
fn a_recording_knows_whether_it_was_cut_off_within_a_stage() {
    for parameters in variants() {
        let whole = record(&parameters, DEFAULT_BUDGET);
        assert!(!whole.is_cut_within_stage());
        for cursor in cursors(&whole) {
            // A stage begins with an event of depth 0, which ends the one before.
            let is_end = whole.event(cursor).is_none_or(|next| next.depth() == 0);
            let past = whole.until(cursor);
            assert_eq!(past.is_cut_within_stage(), !is_end, "cursor {cursor}");
        }
    }
}
