//! Finds the divergence of runs that differ in one known thing.

use tilescope_core::{
    Fate, Parameters, PatternSpec, Point, Run, RunEvent, Search, Stage, Unobserved, sample,
    sample_recorded,
};
use tilescope_debugger::{
    DEFAULT_BUDGET, Divergence, EventKind, Recording, Tape, first_divergence,
    first_divergence_of_runs,
};

use crate::support::{record, variants};

fn run(parameters: &Parameters) -> Run {
    sample(parameters, &mut Unobserved).unwrap()
}

/// A recording of the run that `change` has made of a variant's run.
fn changed(variant: usize, change: impl FnOnce(&mut Run)) -> Recording {
    let parameters = variants()[variant];
    let mut tape = Tape::new(&parameters, DEFAULT_BUDGET);
    let mut run = sample_recorded(&parameters, &mut Unobserved, &mut tape).unwrap();
    tape.seal();
    change(&mut run);
    Recording::of(run, tape)
}

fn stage(divergence: &Divergence) -> (Stage, Option<Point>, &str, &str) {
    match divergence {
        Divergence::Stage { stage, point, a, b } => (*stage, *point, a, b),
        other => panic!("{other:?}"),
    }
}

#[test]
fn equal_runs_are_the_same() {
    for parameters in variants() {
        let (a, b) = (
            record(&parameters, DEFAULT_BUDGET),
            record(&parameters, DEFAULT_BUDGET),
        );
        assert_eq!(first_divergence(&a, &b), Divergence::Same);
        assert_eq!(first_divergence_of_runs(a.run(), b.run()), Divergence::Same);
    }
}

#[test]
fn what_is_left_out_of_a_tape_is_no_difference() {
    let parameters = Parameters {
        radius: 1.0 / 44.0,
        ..variants()[2]
    };
    let (whole, thin) = (
        record(&parameters, usize::MAX),
        record(&parameters, 150_000),
    );
    assert!(thin.tape().left_out() > 0);
    assert_eq!(first_divergence(&whole, &thin), Divergence::Same);
    assert_eq!(first_divergence(&thin, &whole), Divergence::Same);
}

#[test]
fn a_point_moved_by_a_unit_is_found_where_it_is_tiled() {
    let whole = changed(0, |_| ());
    let moved = changed(0, |run| run.samples.points[40].x ^= 1);
    let Divergence::Events {
        a, b, sentence_a, ..
    } = first_divergence(&whole, &moved)
    else {
        panic!("they differ");
    };
    assert_eq!((a, b), (whole.life(40).unwrap().born as usize, a));
    assert!(
        sentence_a.starts_with("Sample 40 of block 0 is tiled"),
        "{sentence_a}"
    );
    let divergence = first_divergence_of_runs(whole.run(), moved.run());
    let (at, point, a, b) = stage(&divergence);
    assert_eq!(at, Stage::Tile);
    let points = [whole.point(40), moved.point(40)];
    assert!(points.contains(&point), "{point:?}");
    assert!(a.contains("tiled sample") && b.contains("tiled sample") && a != b);
}

#[test]
fn a_flipped_fate_is_found_at_elimination() {
    let whole = run(&variants()[0]);
    let mut flipped = whole.clone();
    let lost = |fate: &Fate| matches!(fate, Fate::Eliminated { .. });
    let id = whole.samples.fates.iter().position(lost).unwrap();
    flipped.samples.fates[id] = Fate::Kept;
    let divergence = first_divergence_of_runs(&whole, &flipped);
    let (at, point, a, b) = stage(&divergence);
    assert_eq!(
        (at, point),
        (Stage::Eliminate, Some(whole.samples.points[id]))
    );
    assert!(
        a.contains("is eliminated by the sample at") && b.ends_with("is kept"),
        "{a} {b}"
    );
    // An elimination by another sample is a difference, too.
    let Fate::Eliminated { by } = whole.samples.fates[id] else {
        panic!("eliminated");
    };
    let other = whole
        .result
        .iter()
        .copied()
        .find(|&other| other != by)
        .unwrap();
    flipped.samples.fates[id] = Fate::Eliminated { by: other };
    let divergence = first_divergence_of_runs(&whole, &flipped);
    assert_eq!(stage(&divergence).0, Stage::Eliminate);
    // A sample that was dropped is a difference of tiling.
    flipped.samples.fates[id] = Fate::Dropped;
    assert_eq!(
        stage(&first_divergence_of_runs(&whole, &flipped)).0,
        Stage::Tile
    );
}

#[test]
fn a_missing_candidate_is_found_in_its_iteration() {
    let whole = run(&variants()[0]);
    let mut missing = whole.clone();
    let gone = missing.iterations[0].candidates.remove(3);
    let divergence = first_divergence_of_runs(&whole, &missing);
    let (at, point, a, b) = stage(&divergence);
    assert_eq!((at, point), (Stage::Iterate(1), Some(gone.point)));
    assert!(a.starts_with("candidate at") && b.starts_with("no such candidate"));
    let back = first_divergence_of_runs(&missing, &whole);
    assert_eq!(stage(&back).1, Some(gone.point));
    // A candidate at the same point, made by other samples.
    let mut other = whole.clone();
    let [first, second] = [0, 1].map(|k| whole.iterations[0].candidates[k].sites);
    assert_ne!(first, second);
    other.iterations[0].candidates[0].sites = second;
    let divergence = first_divergence_of_runs(&whole, &other);
    let expected = Some(whole.iterations[0].candidates[0].point);
    assert_eq!(stage(&divergence).1, expected);
}

#[test]
fn a_result_that_lacks_a_sample_or_is_in_another_order_differs_at_the_end() {
    let whole = run(&variants()[0]);
    let mut missing = whole.clone();
    let id = missing.result.remove(7);
    let divergence = first_divergence_of_runs(&whole, &missing);
    let (at, point, ..) = stage(&divergence);
    assert_eq!(
        (at, point),
        (Stage::Finish, Some(whole.samples.points[id as usize]))
    );
    let mut swapped = whole.clone();
    swapped.result.swap(4, 5);
    let divergence = first_divergence_of_runs(&whole, &swapped);
    let (at, point, ..) = stage(&divergence);
    let expected = whole.samples.points[whole.result[4] as usize];
    assert_eq!((at, point), (Stage::Finish, Some(expected)));
}

#[test]
fn ids_are_no_difference() {
    let whole = changed(0, |_| ());
    let mut other = whole.run().clone();
    let (x, y) = (10, 20);
    assert_eq!(other.blocks.leaves.len(), whole.run().tiles.len());
    // Two samples of one block change their numbers.
    other.samples.points.swap(x, y);
    other.samples.origins.swap(x, y);
    other.samples.fates.swap(x, y);
    let swapped = |id: u32| match id as usize {
        id if id == x => y as u32,
        id if id == y => x as u32,
        _ => id,
    };
    for fate in &mut other.samples.fates {
        if let Fate::Eliminated { by } = fate {
            *by = swapped(*by);
        }
    }
    for iteration in &mut other.iterations {
        for detector in &mut iteration.detectors {
            *detector = swapped(*detector);
        }
        for candidate in &mut iteration.candidates {
            if let tilescope_core::stages::detect::Sites::Three(ids) = &mut candidate.sites {
                *ids = ids.map(swapped);
            }
        }
    }
    for id in &mut other.result {
        *id = swapped(*id);
    }
    assert_eq!(
        first_divergence_of_runs(whole.run(), &other),
        Divergence::Same
    );
}

/// Returns the events at which two recordings differ, and what each does.
fn parted(a: &Recording, b: &Recording) -> (usize, usize, String, String) {
    match first_divergence(a, b) {
        Divergence::Events {
            a,
            b,
            sentence_a,
            sentence_b,
        } => (a, b, sentence_a, sentence_b),
        other => panic!("they differ at an event: {other:?}"),
    }
}

#[test]
fn two_seeds_part_at_the_first_cut() {
    let parameters = variants()[0];
    let other = Parameters {
        seed: parameters.seed + 1,
        ..parameters
    };
    let (a, b) = (
        record(&parameters, DEFAULT_BUDGET),
        record(&other, DEFAULT_BUDGET),
    );
    let (i, j, sentence_a, sentence_b) = parted(&a, &b);
    assert_eq!((i, j), (1, 1), "{sentence_a} {sentence_b}");
    let divergence = first_divergence_of_runs(a.run(), b.run());
    assert_eq!(stage(&divergence).0, Stage::Blocks);
    let narrow = Parameters {
        width: 0.9,
        ..parameters
    };
    let narrow = record(&narrow, DEFAULT_BUDGET);
    let found = first_divergence(&a, &narrow);
    assert!(matches!(found, Divergence::Domain { .. }));
    assert_eq!(first_divergence_of_runs(a.run(), narrow.run()), found);
    let pattern = PatternSpec {
        seed: 3,
        ..parameters.pattern
    };
    let pattern = run(&Parameters {
        pattern,
        ..parameters
    });
    assert_eq!(
        stage(&first_divergence_of_runs(a.run(), &pattern)).0,
        Stage::Pattern
    );
}

#[test]
fn a_shorter_search_parts_at_the_first_search() {
    let complete = variants()[0];
    let short = Parameters {
        search: Search::TwoRadii,
        ..complete
    };
    let (a, b) = (
        record(&complete, DEFAULT_BUDGET),
        record(&short, DEFAULT_BUDGET),
    );
    let (i, j, sentence_a, sentence_b) = parted(&a, &b);
    assert_eq!(i, j);
    let is_search = |recording: &Recording| recording.event(i).unwrap().kind() == EventKind::Search;
    assert!(is_search(&a) && is_search(&b));
    assert!(sentence_a.contains("4.00 r") && sentence_b.contains("2.00 r"));
    let begins = a
        .tape()
        .from(0)
        .find(|(_, event)| event.kind() == EventKind::Iteration);
    assert!(begins.unwrap().0 < i);
}

#[test]
fn a_recording_that_goes_on_is_named() {
    let whole = changed(0, |_| ());
    let parameters = variants()[0];
    let mut tape = Tape::new(&parameters, DEFAULT_BUDGET);
    let run = sample_recorded(&parameters, &mut Unobserved, &mut tape).unwrap();
    tilescope_core::Recorder::record(&mut tape, RunEvent::Finish { count: 0 });
    tape.seal();
    let longer = Recording::of(run, tape);
    let found = first_divergence(&longer, &whole);
    let event = whole.len();
    let expected = |a_goes_on| Divergence::Ends {
        a_goes_on,
        event,
        sentence: "The result is there: 0 samples.".to_owned(),
    };
    assert_eq!(found, expected(true));
    assert_eq!(first_divergence(&whole, &longer), expected(false));
}
