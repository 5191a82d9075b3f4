//! `tilescope bench --live`: steps and processor time of the measures that move with a run, without drawing.

use std::fmt::Write;
use std::fs;
use std::sync::Arc;
use std::time::Instant;

use anyhow::Result;
use serde_json::json;
use tilescope_core::Parameters;
use tilescope_debugger::{DEFAULT_BUDGET, Recording};
use tilescope_live::{Course, FRAMES, JUMPS, Motion, STEPS, TIMED_RADII, Timed, timed};

use crate::bench_common::BenchArguments;
use crate::progress::{Stopwatch, bar};
use crate::{EXIT_FINE, interrupt, output};

pub fn run(arguments: &BenchArguments) -> Result<u8> {
    // The clock counts this thread alone: of a measure that is made anew on several, it would miss the others' time.
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .use_current_thread();
    let rows = pool.build()?.install(measured)?;

    // Numbers, names and truth values can always be written.
    let json = || json!(rows);
    output::report(arguments.json, json, || to_text(&rows))?;
    Ok(EXIT_FINE)
}

/// Times each motion through a run of each size, without and with the analysis. Returns a row for each of these.
fn measured() -> Result<Vec<Timed>> {
    let mut rows = Vec::new();
    // Each motion has a row with the analysis and one without it.
    let bar = bar("bench", (TIMED_RADII.len() * Motion::ALL.len() * 2) as u64);
    for radius in TIMED_RADII {
        let parameters = Parameters {
            radius,
            ..Parameters::default()
        };
        // Making the run is not timed; the stopwatch lets Ctrl-C end it.
        let recording = Recording::new(&parameters, DEFAULT_BUDGET, &mut Stopwatch::start())?;
        let course = Arc::new(Course::of_recording(&recording));

        for motion in Motion::ALL {
            for analysis in [false, true] {
                // A row takes a while, and Ctrl-C need not wait for the others.
                interrupt::check("the bench ended")?;
                let clock = Clock::start();
                let seconds = || clock.seconds();
                rows.push(timed(&recording, &course, motion, analysis, &seconds)?);
                bar.inc(1);
            }
        }
    }
    Ok(rows)
}

/// Returns the rows as a table: steps and milliseconds of a move, the part of the moments at which all measures were
/// there, and the part of the frequencies that were shown.
fn to_text(rows: &[Timed]) -> String {
    let mut out =
        "samples motion analysis           steps       ms  arrived  frequencies\n".to_owned();
    for row in rows {
        let percent = |part: f64| format!("{:.0}%", 100.0 * part);
        let (analysis, parts) = if row.analysis {
            ("with", [percent(row.arrived), percent(row.frequencies)])
        } else {
            // Without measures nothing can lag behind the cursor.
            ("without", Default::default())
        };
        let (motion, [arrived, frequencies]) = (row.motion.name(), parts);
        let _ = writeln!(
            out,
            "{:>7} {motion:<6} {analysis:<8} {:>15.0} {:>8.3} {arrived:>8} {frequencies:>12}",
            row.samples, row.steps, row.milliseconds
        );
    }

    let _ = writeln!(
        out,
        "\nmeans of {FRAMES} frames, {STEPS} steps and {JUMPS} jumps, in {} on one thread, without drawing",
        Clock::WHAT
    );
    out
}

/// The time that this thread computes. Other programs do not count, where the system measures the time of threads.
struct Clock {
    began: Instant,
    computed: Option<f64>,
}

impl Clock {
    const WHAT: &str = if cfg!(target_os = "linux") {
        "processor time"
    } else {
        "elapsed time"
    };

    fn start() -> Self {
        Self {
            began: Instant::now(),
            computed: computed(),
        }
    }

    fn seconds(&self) -> f64 {
        let computed = computed().zip(self.computed).map(|(now, then)| now - then);
        computed.unwrap_or_else(|| self.began.elapsed().as_secs_f64())
    }
}

/// Returns the seconds that this thread has computed, to within some milliseconds; `None` where the system does not tell.
fn computed() -> Option<f64> {
    let text = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds: f64 = text.split(' ').next()?.parse().ok()?;
    Some(nanoseconds / 1e9)
}

#[cfg(test)]
mod tests {
    use tilescope_core::Unobserved;

    use super::*;

    #[test]
    fn every_motion_is_measured_with_and_without_the_analysis() {
        let parameters = Parameters {
            radius: 0.05,
            leaf: 10.0,
            ..Parameters::default()
        };
        let recording = Recording::new(&parameters, DEFAULT_BUDGET, &mut Unobserved).unwrap();
        let course = Arc::new(Course::of_recording(&recording));

        for motion in Motion::ALL {
            let [without, with] = [false, true]
                .map(|analysis| timed(&recording, &course, motion, analysis, &|| 0.0).unwrap());
            assert!(
                without.steps == 0.0 && with.steps > 0.0,
                "{}",
                motion.name()
            );
            // So few samples never take a frame's steps.
            assert_eq!(
                (with.arrived, with.frequencies),
                (1.0, 1.0),
                "{}",
                motion.name()
            );

            let cursors = motion.cursors(&course);
            assert!(cursors.iter().all(|cursor| *cursor <= course.events()));
            let text = to_text(&[without, with]);
            let name = format!(" {} ", motion.name());
            assert_eq!(text.matches(&name).count(), 2, "{text}");
            assert_eq!(text.matches("100%").count(), 2, "{text}");
        }
        let play = Motion::Play.cursors(&course);
        assert_eq!(
            (play.len(), play[0], play[FRAMES]),
            (FRAMES + 1, 0, course.events())
        );
        assert!(play.is_sorted());
    }
}
