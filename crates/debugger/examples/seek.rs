//! Prints how long recording and seeking take: `cargo run --release -p tilescope-debugger --example seek`.
//! An example may read the clock; the crate never does.

use std::time::{Duration, Instant};

use tilescope_core::{Parameters, Unobserved, Variant, sample, sample_recorded};
use tilescope_debugger::{
    DEFAULT_BUDGET, Direction, Query, Recording, State, Step, Tape, Target, moves, why,
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
    }
}

/// Seeks to a thousand places all over the tape, and walks.
fn seek(recording: &Recording) {
    let mut state = State::start(recording);
    let (mut worst, mut total) = (Duration::ZERO, Duration::ZERO);
    let places = 1_000;
    for k in 0..places {
        let cursor = (k * 7_919_777_u64 % recording.len() as u64) as usize;
        let time = best(1, || state.seek(recording, cursor));
        (worst, total) = (worst.max(time), total + time);
    }
    println!(
        "  seek anywhere: {:?} on average, {worst:?} at worst",
        total / places as u32
    );
    let middle = recording.len() / 2;
    state.seek(recording, middle);
    let back = best(100, || {
        state.backwards(recording);
    });
    let step = |cursor, direction| moves::step(recording, cursor, Step::Out, direction);
    let out = best(1, || {
        std::hint::black_box(step(middle, Direction::Forwards));
    });
    let scan = best(1, || {
        std::hint::black_box(moves::run_to(
            recording,
            0,
            Target::Sample(u32::MAX - 1),
            Direction::Forwards,
        ));
    });
    let history = best(1, || {
        std::hint::black_box(why::history_of_sample(recording, 0));
    });
    let query = Query::parse("insert iteration>1").expect("a query");
    let found = best(1, || {
        std::hint::black_box(query.find_all(recording, usize::MAX));
    });
    println!("  step back {back:?}, step out {out:?}, run to nowhere {scan:?}");
    println!("  history of a sample {history:?}, query {found:?}");
}
