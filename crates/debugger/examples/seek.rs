//! Prints how long recording and seeking take: `cargo run --release -p tilescope-debugger --example seek`. Only the
//! example reads the clock, not the crate.

use std::time::{Duration, Instant};

use tilescope_core::{Parameters, Unobserved, Variant, sample, sample_recorded};
use tilescope_debugger::{
    DEFAULT_BUDGET, Direction, Outline, OutlineRows, Query, Recording, State, Step, Tape, Target,
    density, moves, why,
};

fn best(runs: usize, mut work: impl FnMut()) -> Duration {
    let time = || {
        let start = Instant::now();
        work();
        start.elapsed()
    };
    std::iter::repeat_with(time)
        .take(runs)
        .min()
        .unwrap_or_default()
}

fn main() {
    for (name, variant, radius) in [
        ("default session", Variant::Staged, 0.008_36),
        ("default session, as printed", Variant::AsPrinted, 0.008_36),
        ("70,000 samples, as printed", Variant::AsPrinted, 0.003_15),
        ("1 million samples", Variant::Staged, 0.000_84),
    ] {
        let parameters = Parameters {
            radius,
            variant,
            ..Parameters::default()
        };
        let plain = best(3, || drop(sample(&parameters, &mut Unobserved)));
        let taped = best(3, || {
            let mut tape = Tape::new(&parameters, DEFAULT_BUDGET);
            sample_recorded(&parameters, &mut Unobserved, &mut tape).expect("valid parameters");
        });
        let recording =
            Recording::new(&parameters, DEFAULT_BUDGET, &mut Unobserved).expect("valid parameters");
        let (samples, events) = (recording.run().result.len(), recording.len());
        let left_out = recording.tape().left_out();
        println!("{name}: {samples} samples, {events} events, {left_out} left out");
        println!("  plain {plain:?}, recorded {taped:?}");
        seek(&recording);
        find(&recording);
        list(&recording);
    }
}

/// Seeks to a thousand cursors all over the tape, and steps.
fn seek(recording: &Recording) {
    let mut state = State::default();
    let (mut worst, mut total) = (Duration::ZERO, Duration::ZERO);
    let cursors = 1_000;
    for k in 0..cursors {
        let cursor = (k * 7_919_777_u64 % recording.len() as u64) as usize;
        let time = best(1, || state.seek(recording, cursor));
        (worst, total) = (worst.max(time), total + time);
    }
    println!(
        "  seek anywhere: {:?} on average, {worst:?} at worst",
        total / cursors as u32
    );
    let middle = recording.len() / 2;
    state.seek(recording, middle);
    let back = best(100, || {
        state.seek(recording, state.cursor() - 1);
    });
    let step = |cursor, direction| moves::step(recording, cursor, Step::Out, direction);
    let out = best(1, || {
        std::hint::black_box(step(middle, Direction::Forwards));
    });
    let query = Query::parse("insert iteration>1").expect("a query");
    let found = best(1, || {
        std::hint::black_box(query.find_all(recording, usize::MAX));
    });
    println!("  step back {back:?}, step out {out:?}, query {found:?}");
}

/// Makes the indices and searches for events near the end of the tape, where a scan is slowest.
fn find(recording: &Recording) {
    let made = best(1, || recording.prepare());
    let named: usize = (0..recording.run().samples.len() as u32)
        .map(|id| recording.events_of(id).len())
        .sum();
    let bytes = 4 * (recording.len() + named + recording.run().samples.len());
    println!("  indices made in {made:?}, {} MB", bytes / 1_000_000);
    let from = Direction::Forwards;
    let run = best(3, || {
        std::hint::black_box(moves::run_to(recording, 0, Target::Violation, from));
    });
    let sample = Target::Sample(recording.run().samples.len() as u32 - 1);
    let indexed = best(3, || {
        std::hint::black_box(moves::run_to(recording, 0, sample, from));
    });
    let scan = best(3, || {
        let meant = |index, event: &_| moves::matches_target(recording, index, event, sample);
        std::hint::black_box(moves::find(recording, 0, from, meant));
    });
    let history = best(3, || {
        std::hint::black_box(why::history_of_sample(recording, 0));
    });
    println!("  run to the last sample {indexed:?} (scan {scan:?}), to a violation {run:?}");
    println!("  history of a sample {history:?}");
}

/// Makes the tree of events, expands its largest node and counts events for a time line.
fn list(recording: &Recording) {
    let mut outline = None;
    let made = best(1, || outline = Some(Outline::new(recording)));
    let outline = outline.expect("it was made");
    let largest = outline.roots().max_by_key(|&root| outline.end(root) - root);
    let largest = largest.expect("a phase");
    let mut rows = OutlineRows::new(&outline);
    let expand = best(1, || {
        rows.toggle(&outline, largest);
    });
    let rows_shown = rows.len();
    let page = best(3, || {
        for k in 0..50 {
            std::hint::black_box(rows.row(rows_shown / 2 + k));
        }
    });
    let reveal = best(1, || rows.expand_to(&outline, recording.len() / 2));
    let line = best(3, || {
        std::hint::black_box(density(recording, 0..recording.len(), 1_000));
    });
    println!("  tree {made:?}, expanding {rows_shown} rows {expand:?}, 50 rows {page:?}");
    println!("  revealing an event {reveal:?}, 1000 buckets {line:?}");
}
