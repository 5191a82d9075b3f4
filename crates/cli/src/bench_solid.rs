//! `tilescope bench --space`: rates of sets of balls in a periodic cube, and of their judges.

use std::fmt::Write;
use std::time::Instant;

use anyhow::{Result, ensure};
use rayon::ThreadPoolBuilder;
use serde_json::{Value, json};
use tilescope_analysis::{JudgeChoice, SolidRegion, VerifyOptions, verify_solid};
use tilescope_core::{
    Boundary, SolidDomain, SolidRequest, Unobserved, solid_sample, solid_sample_parallel,
};

use crate::bench_common::{BenchArguments, yes};
use crate::progress::bar;
use crate::{interrupt, output, verdict_code};

/// The kinds of work that each round times.
#[derive(Clone, Copy, Debug, PartialEq)]
enum TimedWork {
    /// The sequential engine makes the set on one thread. Its code is made to be read, and recordings are of its runs.
    MakeInSequence,
    /// The parallel engine makes the set on one thread.
    MakeAlone,
    /// The parallel engine makes the set on all threads.
    Make,
    /// All threads judge the set by cubes.
    JudgeByCubes,
    /// All threads judge the set by covered circles.
    JudgeByCircles,
}

impl TimedWork {
    const ALL: [Self; 5] = [
        Self::MakeInSequence,
        Self::MakeAlone,
        Self::Make,
        Self::JudgeByCubes,
        Self::JudgeByCircles,
    ];

    fn name(self) -> String {
        let threads = rayon::current_num_threads();
        match self {
            Self::MakeInSequence => "made as recorded, 1 thread".to_owned(),
            Self::MakeAlone => "made, 1 thread".to_owned(),
            Self::Make => format!("made, threads: {threads}"),
            Self::JudgeByCubes => format!("judged by cubes, threads: {threads}"),
            Self::JudgeByCircles => format!("judged by circles, threads: {threads}"),
        }
    }
}

/// The seconds of each kind of work, and whether all sets were valid.
struct Timed {
    /// Of the set of the last round; those of other seeds have about as many.
    samples: usize,
    seconds: Vec<(TimedWork, Vec<f64>)>,
    is_valid: bool,
}

/// Times the making and the verifying of sets in space, and prints the rates.
pub fn run(arguments: &BenchArguments) -> Result<u8> {
    // Without a round there is no median. The largest number is chosen, not measured.
    ensure!(
        (1..=1000).contains(&arguments.rounds),
        "--rounds is {}; it must be between 1 and 1000",
        arguments.rounds
    );
    // One bar for all rounds, as each takes about the same time.
    let bar = bar("bench", arguments.rounds);
    let mut timed = Timed {
        samples: 0,
        seconds: TimedWork::ALL.map(|work| (work, Vec::new())).to_vec(),
        is_valid: true,
    };
    for round in 0..arguments.rounds {
        interrupt::check("the rest of the rounds")?;
        add_round(&mut timed, arguments.samples, arguments.seed + round)?;
        bar.set_position(round + 1);
    }
    bar.finish_and_clear();
    output::report(arguments.json, || timed.json(), || timed.text())?;
    Ok(verdict_code(timed.is_valid))
}

/// Makes a set by both engines and judges it by both judges: every kind of work runs once.
fn add_round(timed: &mut Timed, samples: u64, seed: u64) -> Result<()> {
    let request = SolidRequest {
        size: [1.0; 3],
        boundary: Boundary::Periodic,
        seed,
    };
    // The set has about this number of samples, which is near enough: rates hardly depend on it.
    let radius = request.radius_estimate(samples)?;
    let domain = SolidDomain::from_size(request.size, radius, request.boundary)?;
    let region = SolidRegion {
        width: 1.0,
        height: 1.0,
        depth: 1.0,
        boundary: tilescope_analysis::Boundary::Periodic,
    };

    let single = ThreadPoolBuilder::new().num_threads(1).build()?;
    // The work is done in the order of `TimedWork::ALL`: the first kind makes the positions that the later kinds
    // compare and judge.
    let mut positions = Vec::new();
    for (work, seconds) in &mut timed.seconds {
        let began = Instant::now();
        match work {
            TimedWork::MakeInSequence => {
                let places = solid_sample(domain, seed, &mut Unobserved)?;
                // Positions in user units are no part of the rate, which is that of the lattice.
                seconds.push(began.elapsed().as_secs_f64());
                positions = domain.users_from_lattice(&places);
            }
            TimedWork::MakeAlone | TimedWork::Make => {
                let make = || solid_sample_parallel(domain, seed, &mut Unobserved);
                let places = if *work == TimedWork::MakeAlone {
                    single.install(make)?
                } else {
                    make()?
                };
                seconds.push(began.elapsed().as_secs_f64());
                // Both engines promise the same set. Rates of different sets could not be compared.
                ensure!(
                    domain.users_from_lattice(&places) == positions,
                    "the two engines make different sets of seed {seed}"
                );
            }
            TimedWork::JudgeByCubes | TimedWork::JudgeByCircles => {
                let is_cubes = *work == TimedWork::JudgeByCubes;
                let options = VerifyOptions {
                    judges: if is_cubes {
                        JudgeChoice::Subdivision
                    } else {
                        JudgeChoice::Circles
                    },
                    ..VerifyOptions::default()
                };
                let control = |_| interrupt::flow();
                // The time is that of the verdict alone: the covering radius, which certificates state, is not
                // measured.
                let report = verify_solid(&positions, region, radius, &options, &control)?;
                seconds.push(began.elapsed().as_secs_f64());
                timed.is_valid &= report.valid();
            }
        }
    }
    timed.samples = positions.len();
    Ok(())
}

impl Timed {
    /// Returns each kind of work with its median rate, in samples a second: of an even number of rounds the slower one of
    /// the middle two.
    fn rates(&self) -> impl Iterator<Item = (TimedWork, f64)> {
        self.seconds.iter().map(|(work, seconds)| {
            let mut sorted = seconds.clone();
            sorted.sort_by(f64::total_cmp);
            (*work, self.samples as f64 / sorted[sorted.len() / 2])
        })
    }

    /// Returns the rates as a table.
    fn text(&self) -> String {
        let mut out = "sets in space                     samples Msamples/s\n".to_owned();
        for (work, rate) in self.rates() {
            let _ = writeln!(
                out,
                "{:<32} {:>8} {:>10.3}",
                work.name(),
                self.samples,
                rate / 1e6
            );
        }
        let rounds = self.seconds.first().map_or(0, |(_, seconds)| seconds.len());
        let _ = writeln!(
            out,
            "median of {rounds} rounds; periodic cubes; all valid: {}",
            yes(self.is_valid)
        );
        out
    }

    /// Returns the rates for programs.
    fn json(&self) -> Value {
        let row = |(work, rate): (TimedWork, f64)| {
            let seconds = self.seconds.iter().find(|(other, _)| *other == work);
            json!({
                "work": work.name(),
                "samples_per_second": rate,
                "seconds": seconds.map(|(_, seconds)| seconds),
            })
        };
        json!({
            "samples": self.samples,
            "rows": self.rates().map(row).collect::<Vec<_>>(),
            "valid": self.is_valid,
        })
    }
}
