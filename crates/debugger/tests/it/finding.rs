//! Compares indices, the tree of events and counts with plain scans of the tape.

use proptest::prelude::*;
use tilescope_core::{Boundary, Insertion, Parameters, Point, R, RunEvent, Verdict};
use tilescope_debugger::{
    DEFAULT_BUDGET, Debugger, Density, Direction, EventKind, LineId, Listings, Outline,
    OutlineRows, Recording, Stop, Target, density, moves, why,
};

use crate::support::{record, variants};

const FORWARDS: Direction = Direction::Forwards;
const BACKWARDS: Direction = Direction::Backwards;

fn scan(recording: &Recording, cursor: usize, target: Target, way: Direction) -> Option<usize> {
    moves::find(recording, cursor, way, |index, event| {
        moves::matches_target(recording, index, event, target)
    })
}

fn targets(recording: &Recording, line: u8, sample: u32) -> Vec<Target> {
    let mut all = vec![
        Target::Conflict,
        Target::Elimination,
        Target::Gap,
        Target::Insertion,
        Target::SecondInsertion,
        Target::Violation,
        Target::Line(LineId(line)),
        Target::Sample(sample % recording.run().samples.len() as u32),
        Target::Sample(u32::MAX - 1),
    ];
    all.extend(EventKind::ALL.iter().map(|&kind| Target::Kind(kind)));
    all
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(tilescope_tests::cases(12)))]

    #[test]
    fn runs_reach_what_a_scan_reaches(
        variant in 0_usize..8,
        indices in prop::collection::vec(any::<prop::sample::Index>(), 4),
        line in 0_u8..74,
        sample: u32,
    ) {
        let recording = record(&variants()[variant], DEFAULT_BUDGET);
        let ends = [0, recording.len(), recording.len() - 1];
        let inner = indices.iter().map(|index| index.index(recording.len()));
        for cursor in inner.chain(ends) {
            for target in targets(&recording, line, sample) {
                for way in [FORWARDS, BACKWARDS] {
                    let found = moves::run_to(&recording, cursor, target, way);
                    let expected = scan(&recording, cursor, target, way);
                    prop_assert_eq!(found, expected, "{:?} {:?} {}", target, way, cursor);
                }
            }
        }
    }

    #[test]
    fn counts_are_those_of_a_scan(
        variant in 0_usize..8,
        indices in prop::array::uniform2(any::<prop::sample::Index>()),
        buckets in 1_usize..300,
    ) {
        let recording = record(&variants()[variant], DEFAULT_BUDGET);
        let mut ends = indices.map(|index| index.index(recording.len() + 1));
        ends.sort_unstable();
        let (start, end) = (ends[0], ends[1]);
        let found = density(&recording, start..end, buckets);
        prop_assert_eq!(found.len(), buckets);
        let bound = |k: usize| start + (end - start) * k / buckets;
        for (k, counts) in found.iter().enumerate() {
            prop_assert_eq!(*counts, counted(&recording, bound(k), bound(k + 1)));
        }
    }
}

/// A reference implementation of the counts.
fn counted(recording: &Recording, start: usize, end: usize) -> Density {
    let mut counts = Density::default();
    for (_, event) in recording.tape().from(start).take(end - start) {
        let count = match event.run_event() {
            Some(RunEvent::Test { covers: false, .. }) => &mut counts.tests,
            Some(RunEvent::Test { .. } | RunEvent::Eliminate { .. }) => &mut counts.conflicts,
            Some(RunEvent::Insert { .. }) => &mut counts.insertions,
            Some(RunEvent::Candidate { verdict, .. } | RunEvent::Dart { verdict, .. })
                if verdict != Verdict::Accepted =>
            {
                &mut counts.tests
            }
            _ if Recording::is_gap(event) => &mut counts.gaps,
            _ => &mut counts.others,
        };
        *count += 1;
    }
    counts
}

#[test]
fn ranges_beyond_the_tape_and_no_buckets_are_empty() {
    let recording = record(&variants()[0], DEFAULT_BUDGET);
    assert_eq!(density(&recording, 0..usize::MAX, 0), []);
    let all = density(&recording, 0..usize::MAX, 1);
    assert_eq!(all[0].total() as usize, recording.len());
    let none = density(&recording, recording.len()..usize::MAX, 3);
    assert_eq!(none, [Density::default(); 3]);
    let inserted: usize = recording.run().summary().inserted.iter().sum();
    assert_eq!(all[0].insertions as usize, inserted);
}

#[test]
fn histories_and_causes_are_those_of_a_scan() {
    for parameters in variants() {
        let recording = record(&parameters, DEFAULT_BUDGET);
        recording.prepare();
        for sample in (0..recording.run().samples.len() as u32 + 2).step_by(29) {
            let events = recording.tape().from(0);
            let named = events.filter(|(_, event)| event.touches(sample));
            let expected: Vec<usize> = named.map(|(index, _)| index).collect();
            assert_eq!(why::history_of_sample(&recording, sample), expected);
        }
        for (index, event) in recording.tape().from(0) {
            if matches!(event.kind(), EventKind::NoGap | EventKind::Call) && index % 13 == 0 {
                let mut before = recording.tape().before(index);
                let search = before.find(|(_, event)| event.kind() == EventKind::Search);
                assert_eq!(
                    why::cause(&recording, index),
                    search.map(|(index, _)| index)
                );
            }
        }
    }
}

#[test]
fn a_run_stops_at_every_event_of_its_lines() {
    let recording = std::sync::Arc::new(record(&variants()[3], DEFAULT_BUDGET));
    let mut debugger = Debugger::new(recording.clone(), DEFAULT_BUDGET);
    let lines = ["eliminate.5", "insert.3", "finish.2"].map(|id| Listings::shipped().find(id));
    for line in lines.into_iter().flatten() {
        debugger.add_breakpoint(line, "");
    }
    let mut stops = Vec::new();
    while debugger.run(FORWARDS) != Stop::End {
        stops.push(debugger.state().cursor());
    }
    let events = recording.tape().from(0);
    let armed = events.filter(|(_, event)| lines.contains(&Some(event.line())));
    let expected: Vec<usize> = armed.map(|(index, _)| index).collect();
    assert_eq!(stops, expected);
    debugger.jump(recording.len());
    let mut back = Vec::new();
    while debugger.run(BACKWARDS) != Stop::End {
        back.push(debugger.state().cursor());
    }
    back.reverse();
    assert_eq!(back, expected);
}

#[test]
fn the_tree_of_a_recording_reaches_every_event_once() {
    let thinned = Parameters {
        radius: 1.0 / 44.0,
        ..variants()[2]
    };
    let thinned = record(&thinned, 150_000);
    assert!(thinned.tape().left_out() > 0);
    let whole = variants().into_iter().map(|p| record(&p, DEFAULT_BUDGET));
    for recording in whole.chain([thinned]) {
        let outline = Outline::new(&recording);
        let mut stack: Vec<usize> = outline.roots().collect();
        let mut seen = vec![0_u8; recording.len()];
        while let Some(event) = stack.pop() {
            seen[event] += 1;
            for child in outline.children(event) {
                assert_eq!(outline.parent(child), Some(event));
                assert!(
                    recording.event(child).unwrap().depth()
                        > recording.event(event).unwrap().depth()
                );
                stack.push(child);
            }
        }
        assert!(seen.iter().all(|&times| times == 1));
        let mut rows = OutlineRows::new(&outline);
        for event in (0..recording.len()).step_by(recording.len() / 40) {
            rows.expand_to(&outline, event);
            let row = rows.row_of(event).and_then(|k| rows.row(k)).unwrap();
            assert_eq!(row.event, event);
            assert_eq!(row.level, outline.parents(event).count());
        }
    }
}

/// Darts have no sites: the second one is near an earlier one, by the distances of all.
#[test]
fn a_second_dart_is_within_two_radii_of_an_earlier_one() {
    let parameters = Parameters {
        radius: 0.02,
        boundary: Boundary::Bounded,
        insertion: Insertion::Uniform,
        ..Parameters::default()
    };
    let recording = record(&parameters, DEFAULT_BUDGET);
    let mut before: Vec<Point> = Vec::new();
    let (mut second, mut far) = (0, 0);
    for index in 0..recording.len() {
        let event = recording.event(index).unwrap();
        let Some(RunEvent::Insert { sample, .. }) = event.run_event() else {
            continue;
        };
        let point = recording.point(sample).unwrap();
        let is_near = |other: &Point| {
            let offset = [point.x - other.x, point.y - other.y].map(i64::from);
            offset[0] * offset[0] + offset[1] * offset[1] <= 4 * i64::from(R) * i64::from(R)
        };
        let expected = before.iter().any(is_near);
        let target = Target::SecondInsertion;
        let found = moves::matches_target(&recording, index, event, target);
        assert_eq!(found, expected, "event {index}");
        second += usize::from(expected);
        far += usize::from(!expected);
        before.push(point);
    }
    assert!(second > 0 && far > 0, "{second} {far}");
}
