//! Checks that every event has a sentence that names its samples.

use std::collections::BTreeSet;

use tilescope_core::{Parameters, R, RunEvent, Search};
use tilescope_debugger::{
    DEFAULT_BUDGET, Direction, EventKind, Listings, NONE, Recording, Target, grouped, moves,
    sentence, short,
};

use crate::support::{record, variants};

/// Returns whether a text names a sample: its number stands alone in it.
fn names(text: &str, sample: u32) -> bool {
    let number = grouped(sample.into());
    text.split(|c: char| !c.is_ascii_digit() && c != ',')
        .any(|word| word.trim_matches(',') == number)
}

/// Checks every sentence of a recording and returns the kinds that it reached.
fn check(recording: &Recording) -> BTreeSet<&'static str> {
    let mut kinds = BTreeSet::new();
    for (index, event) in recording.tape().from(0) {
        kinds.insert(event.kind().name());
        let text = sentence(recording, index);
        assert!(text.ends_with('.') && text.len() > 12, "{text}");
        assert!(text.starts_with(|c: char| c.is_ascii_uppercase() || c.is_ascii_digit()));
        assert!(!text.contains("  ") && !text.contains(" ,"), "{text}");
        for sample in event.samples().into_iter().filter(|&id| id != NONE) {
            assert!(names(&text, sample), "{text}: {event:?}");
        }
        let row = short(recording, index);
        assert!(!row.is_empty() && row.chars().count() <= 60, "{row}");
    }
    kinds
}

#[test]
fn every_event_of_every_variant_has_a_sentence_that_names_its_samples() {
    let mut kinds = BTreeSet::new();
    for parameters in variants() {
        kinds.extend(check(&record(&parameters, DEFAULT_BUDGET)));
    }
    let thinned = Parameters {
        radius: 1.0 / 44.0,
        ..variants()[2]
    };
    kinds.extend(check(&record(&thinned, 150_000)));
    let all: BTreeSet<&str> = EventKind::ALL.iter().map(|kind| kind.name()).collect();
    assert_eq!(kinds, all);
}

#[test]
fn a_number_within_another_is_no_name() {
    assert!(names("Sample 1,412 of block 7.", 1_412));
    assert!(!names("Sample 1,412 of block 7.", 412));
    assert!(!names("Sample 4123.", 412));
}

#[test]
fn an_elimination_says_who_whom_and_how_far() {
    let recording = record(&variants()[0], DEFAULT_BUDGET);
    let index = moves::run_to(&recording, 0, Target::Elimination, Direction::Forwards).unwrap();
    let Some(RunEvent::Eliminate { sample, by }) = recording.event(index).unwrap().run_event()
    else {
        panic!("an elimination");
    };
    let block = |id: u32| {
        let tiles = &recording.run().tiles;
        tiles
            .iter()
            .position(|tile| tile.samples.contains(&id))
            .unwrap()
    };
    let squared = recording.domain().distance_squared(
        recording.point(by).unwrap(),
        recording.point(sample).unwrap(),
    );
    let radii = (squared as f64).sqrt() / f64::from(tilescope_core::R);
    let expected = format!(
        "Sample {} of block {} eliminates sample {} of block {}, {radii:.2} r away.",
        grouped(by.into()),
        block(by),
        grouped(sample.into()),
        block(sample)
    );
    assert_eq!(sentence(&recording, index), expected);
    let row = format!(
        "{} eliminates {}, {radii:.2} r",
        grouped(by.into()),
        grouped(sample.into())
    );
    assert_eq!(short(&recording, index), row);
}

#[test]
fn behind_the_last_event_the_run_has_ended() {
    let recording = record(&variants()[1], DEFAULT_BUDGET);
    assert_eq!(sentence(&recording, recording.len()), "The run has ended.");
    assert_eq!(short(&recording, usize::MAX), "end");
}

#[test]
fn numbers_are_grouped_by_three() {
    for (number, text) in [
        (0, "0"),
        (999, "999"),
        (1_000, "1,000"),
        (12_345_678, "12,345,678"),
    ] {
        assert_eq!(grouped(number), text);
    }
}

#[test]
fn a_line_says_how_far_the_run_looks() {
    let mut seen = BTreeSet::new();
    for search in [Search::Complete, Search::TwoRadii] {
        // Exact tiling looks for no gaps.
        for variant in variants().into_iter().take(6) {
            let parameters = Parameters { search, ..variant };
            let recording = record(&parameters, DEFAULT_BUDGET);
            let events = recording.tape().from(0);
            for (_, event) in events.filter(|(_, event)| event.kind() == EventKind::Search) {
                let Some(RunEvent::Search { radius, .. }) = event.run_event() else {
                    panic!("a search");
                };
                let line = Listings::shipped().line(event.line()).unwrap();
                let text = line.text(&parameters);
                let looked = format!("{}r", (f64::from(radius) / f64::from(R)).round());
                if ["detect.3", "printed.14"].contains(&line.id.as_str()) {
                    assert!(text.contains(&looked), "{text}: {looked}");
                    assert!(search == Search::Complete || !text.contains("4r"), "{text}");
                    seen.insert((line.id.clone(), looked));
                }
                assert!(!text.contains('{'), "{text}");
            }
        }
    }
    // 2r, 4r and, near a border, 7r, staged and as printed.
    assert_eq!(seen.len(), 6, "{seen:?}");
}
