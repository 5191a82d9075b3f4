//! Stepping forwards and then backwards restores the state, and the state at the end is the engine's.

use proptest::prelude::*;
use tilescope_core::stages::detect::Sites;
use tilescope_core::{Fate, Parameters, Point, RunEvent, Stage, Unobserved, Verdict, sample};
use tilescope_debugger::{
    DEFAULT_BUDGET, Event, EventKind, Lines, Listings, Recording, State, Status,
};

use crate::support::{record, statuses, variants};

/// The state at a cursor, event by event from the start.
fn replayed(recording: &Recording, cursor: usize) -> State {
    let mut state = State::default();
    while state.cursor() < cursor {
        state.seek(recording, state.cursor() + 1);
    }
    assert_eq!(statuses(recording, cursor), of_events(recording, cursor));
    state
}

/// The statuses at a cursor, by nothing but the events before it.
fn of_events(recording: &Recording, cursor: usize) -> Vec<Status> {
    let mut statuses = vec![Status::Absent; recording.run().samples.len()];
    for event in recording.tape().iter().take(cursor) {
        let (sample, status) = match event.run_event() {
            Some(RunEvent::Tiled { sample, inside, .. }) if inside => (sample, Status::Undecided),
            Some(RunEvent::Tiled { sample, .. }) => (sample, Status::Dropped),
            Some(RunEvent::Keep { sample, .. } | RunEvent::Insert { sample, .. }) => {
                (sample, Status::Kept)
            }
            Some(RunEvent::Eliminate { sample, .. }) => (sample, Status::Eliminated),
            _ => continue,
        };
        statuses[sample as usize] = status;
    }
    statuses
}

#[test]
fn the_last_state_is_the_engines_run() {
    for parameters in variants() {
        let recording = record(&parameters, DEFAULT_BUDGET);
        let run = sample(&parameters, &mut Unobserved).unwrap();
        assert_eq!(recording.run().samples, run.samples);
        assert_eq!(recording.run().result, run.result);
        let state = replayed(&recording, recording.len());
        assert_eq!(state, State::at(&recording, recording.len()));
        let statuses = statuses(&recording, recording.len());
        for (status, fate) in statuses.iter().zip(&run.samples.fates) {
            let expected = match fate {
                Fate::Kept => Status::Kept,
                Fate::Eliminated { .. } => Status::Eliminated,
                Fate::Dropped => Status::Dropped,
                Fate::Undecided => Status::Undecided,
            };
            assert_eq!(*status, expected);
        }
        let (counts, summary) = (state.counts(), run.summary());
        assert_eq!(counts.kept, summary.count);
        assert_eq!(counts.eliminated, summary.eliminated);
        assert_eq!(counts.dropped, summary.dropped);
        assert_eq!(counts.inserted, summary.inserted.iter().sum::<usize>());
        assert_eq!(counts.undecided, 0);
    }
}

#[test]
fn every_line_of_pseudocode_is_reached_by_some_run() {
    let listings = Listings::shipped();
    let mut reached = vec![false; listings.lines().len()];
    // Too flat to be cut across y, so that every turn of y is skipped.
    let flat = Parameters {
        height: 0.2,
        radius: 1.0 / 60.0,
        leaf: 6.5,
        ..variants()[0]
    };
    for parameters in variants().into_iter().chain([flat]) {
        for event in record(&parameters, DEFAULT_BUDGET).tape().iter() {
            reached[usize::from(event.line().0)] = true;
        }
    }
    let missed = listings
        .lines()
        .iter()
        .zip(reached)
        .filter(|(_, reached)| !reached);
    let missed: Vec<&str> = missed.map(|(line, _)| line.id.as_str()).collect();
    assert_eq!(missed, Vec::<&str>::new());
}

#[test]
fn a_test_buffer_holds_as_many_samples_as_the_engine_found() {
    for parameters in variants() {
        let recording = record(&parameters, DEFAULT_BUDGET);
        let mut searches = 0;
        for (index, event) in recording.tape().from(0) {
            if event.kind() == EventKind::Search && searches < 400 {
                let search = recording.context(index + 1).search.unwrap();
                assert_eq!(recording.test_buffer(&search).len(), search.found as usize);
                searches += 1;
            }
        }
        let throws = parameters.insertion == tilescope_core::Insertion::Uniform;
        assert!(searches > 0 || throws || recording.is_exact());
    }
}

#[test]
fn beyond_the_budget_only_tests_are_left_out_and_a_notice_says_so() {
    let parameters = Parameters {
        radius: 1.0 / 44.0,
        ..variants()[2]
    };
    let (whole, thin) = (
        record(&parameters, usize::MAX),
        record(&parameters, 200_000),
    );
    assert_eq!(whole.tape().left_out(), 0);
    assert!(thin.len() < whole.len());
    assert!((70_000..=200_000).contains(&thin.len()), "{}", thin.len());
    let notices: u64 = thin
        .tape()
        .iter()
        .filter_map(Event::left_out)
        .map(u64::from)
        .sum();
    assert_eq!(notices, thin.tape().left_out());
    let rows = thin
        .tape()
        .iter()
        .filter(|event| event.left_out().is_some())
        .count();
    assert_eq!(
        whole.len() as u64,
        thin.len() as u64 - rows as u64 + notices
    );
    let changes = |recording: &Recording| -> Vec<Event> {
        recording
            .tape()
            .iter()
            .filter(|e| !e.is_detail() && e.left_out().is_none())
            .copied()
            .collect()
    };
    assert_eq!(changes(&whole), changes(&thin));
    assert_eq!(statuses(&whole, whole.len()), statuses(&thin, thin.len()));
    // Iteration in both directions agrees with indices after thinning, too.
    let forwards: Vec<usize> = thin
        .tape()
        .from(65_530)
        .take(12)
        .map(|(index, _)| index)
        .collect();
    let mut backwards: Vec<usize> = thin
        .tape()
        .before(65_542)
        .take(12)
        .map(|(index, _)| index)
        .collect();
    backwards.reverse();
    assert_eq!(forwards, backwards);
    for (index, event) in thin.tape().before(65_542).take(12) {
        assert_eq!(thin.event(index), Some(event));
    }
}

#[test]
fn an_event_has_at_most_24_bytes() {
    assert!(size_of::<Event>() <= 24);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(tilescope_tests::cases(24)))]

    #[test]
    fn a_random_walk_ends_in_the_state_replayed_from_the_start(
        variant in 0_usize..8,
        moves in prop::collection::vec((any::<bool>(), 0_u32..13), 1..12),
        jump: prop::sample::Index,
    ) {
        let recording = record(&variants()[variant], DEFAULT_BUDGET);
        let mut state = State::at(&recording, jump.index(recording.len()));
        for (back, size) in moves {
            let size = 1 << size;
            let (before, from) = (state.clone(), state.cursor());
            let to = if back { from.saturating_sub(size) } else { from + size };
            state.seek(&recording, to);
            let mut there_and_back = state.clone();
            there_and_back.seek(&recording, from);
            prop_assert_eq!(&there_and_back, &before);
        }
        let expected = replayed(&recording, state.cursor());
        prop_assert_eq!(&state, &expected);
        prop_assert_eq!(&State::at(&recording, state.cursor()), &expected);
    }

    #[test]
    fn packing_a_candidate_loses_nothing(
        ids in prop::array::uniform3(any::<u32>()),
        own in 0_usize..3,
        near in prop::array::uniform2(-114_688_i32..=114_688),
        far: [i32; 2],
        by: u32,
        verdict in 0_u32..5,
        arity in 0_usize..3,
    ) {
        let sites = [Sites::Corner(ids[0]), Sites::Border([ids[0], ids[1]]), Sites::Three(ids)];
        let (verdict, offset) = match verdict {
            0 => (Verdict::Accepted, near),
            1 => (Verdict::TooFar, far),
            2 => (Verdict::Outside, far),
            3 => (Verdict::Covered { by }, near),
            _ => (Verdict::NotNearest { nearer: by }, near),
        };
        let (sites, detector) = (sites[arity], ids[own.min(arity)]);
        let run_event = RunEvent::Candidate { detector, sites, offset: offset.into(), verdict };
        let event = Event::new(&run_event, &Lines::new(&variants()[0]));
        prop_assert_eq!(event.run_event(), Some(run_event));
    }
}

#[test]
fn packing_loses_nothing() {
    let lines = Lines::new(&variants()[0]);
    let point = Point::new(-3, i32::MAX);
    for run_event in [
        RunEvent::Begin(Stage::Iterate(7)),
        RunEvent::Split {
            index: 3,
            turned: true,
        },
        RunEvent::Tiled {
            sample: 9,
            block: 2,
            inside: false,
        },
        RunEvent::Test {
            pivot: 1,
            other: 2,
            covers: true,
        },
        RunEvent::Mark {
            sample: 4,
            because: 5,
        },
        RunEvent::Search {
            centre: 1,
            radius: 131_088,
            found: 44,
        },
        RunEvent::Call {
            pivot: 8,
            iteration: 2,
        },
        RunEvent::Pass { point, by: 6 },
        RunEvent::Dart {
            point,
            z: -7,
            ranked: true,
            verdict: Verdict::Covered { by: u32::MAX },
        },
        RunEvent::Cut {
            cell: point,
            z: 123_456_789,
            side: 4,
            kept: 3,
        },
        RunEvent::IterationEnd {
            number: 2,
            inserted: 0,
        },
    ] {
        assert_eq!(Event::new(&run_event, &lines).run_event(), Some(run_event));
    }
}
