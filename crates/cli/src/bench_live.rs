//! `tilescope bench --live`: steps and processor time of the measures that move with a run, without drawing.

use std::fmt::Write;
use std::fs;
use std::sync::Arc;
use std::time::Instant;

use anyhow::Result;
use serde_json::{Value, json};
use tilescope_analysis::live::LiveSpectrum;
use tilescope_core::Parameters;
use tilescope_debugger::{DEFAULT_BUDGET, Recording, State};
use tilescope_live::{Course, FRAME_STEPS, LiveMoment, Wanted};

use crate::bench_common::BenchArguments;
use crate::progress::{Stopwatch, bar};
use crate::{EXIT_FINE, interrupt, output};

/// The radii of the runs: those of 10,041 and about 100,400 samples.
const RADII: [f64; 2] = [0.008_36, 0.002_643_7];

/// Frames of a run that is played in 30 seconds, 60 in a second.
const FRAMES: usize = 1800;

/// Single changes of the samples, from the middle of the run on.
const STEPS: usize = 500;

/// Jumps to moments all over the run.
const JUMPS: usize = 20;

/// All that can be measured.
const ALL: Wanted = Wanted {
    spectrum: true,
    thinned: true,
    pairs: true,
    cover: true,
};

/// How the cursor moves.
#[derive(Clone, Copy)]
enum Motion {
    Play,
    Step,
    Jump,
}

impl Motion {
    const ALL: [Self; 3] = [Self::Play, Self::Step, Self::Jump];

    const fn name(self) -> &'static str {
        match self {
            Self::Play => "play",
            Self::Step => "step",
            Self::Jump => "jump",
        }
    }

    /// Returns the cursors that are visited, the first of which is not measured.
    fn cursors(self, course: &Course) -> Vec<usize> {
        let (events, changes) = (course.events(), course.changes());
        match self {
            Self::Play => (0..=FRAMES).map(|frame| frame * events / FRAMES).collect(),
            Self::Step => {
                let later = &changes[changes.len() / 2..];
                // A cursor counts the events that have happened, the change among them.
                let after = later.iter().map(|change| change.event as usize + 1);
                // The first cursor is where the steps begin.
                after.take(STEPS + 1).collect()
            }
            Self::Jump => {
                // Steps of the golden section spread evenly, and far from each other.
                let at = |jump: usize| ((jump as f64 * 0.618_034).fract() * events as f64) as usize;
                (0..=JUMPS).map(at).collect()
            }
        }
    }

    /// Returns the most steps of a move: a frame has little time, and at rest there is enough.
    const fn budget(self) -> u64 {
        match self {
            Self::Play => FRAME_STEPS,
            Self::Step | Self::Jump => u64::MAX,
        }
    }
}

/// What moves of a kind took, as means.
struct MotionRow {
    samples: usize,
    motion: Motion,
    /// Whether anything was measured.
    analysis: bool,
    steps: f64,
    milliseconds: f64,
    /// The part of the moments at which all measures were there.
    arrived: f64,
    /// The part of the frequencies that were shown.
    frequencies: f64,
}

pub fn run(arguments: &BenchArguments) -> Result<u8> {
    // The clock counts this thread alone: of a measure that is made anew on several, it would miss the others' time.
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .use_current_thread();
    let rows = pool.build()?.install(measured)?;

    let json = || Value::Array(rows.iter().map(MotionRow::json).collect());
    output::report(arguments.json, json, || to_text(&rows))?;
    Ok(EXIT_FINE)
}

fn measured() -> Result<Vec<MotionRow>> {
    let mut rows = Vec::new();
    // Each motion has a row with the analysis and one without it.
    let bar = bar("bench", (RADII.len() * Motion::ALL.len() * 2) as u64);
    for radius in RADII {
        let parameters = Parameters {
            radius,
            ..Parameters::default()
        };
        let recording = Recording::new(&parameters, DEFAULT_BUDGET, &mut Stopwatch::start())?;
        let course = Arc::new(Course::of_recording(&recording));

        for motion in Motion::ALL {
            for analysis in [false, true] {
                // A row takes a while, and Ctrl-C need not wait for the others.
                interrupt::check("the bench ended")?;
                rows.push(row(&recording, &course, motion, analysis)?);
                bar.inc(1);
            }
        }
    }
    Ok(rows)
}

/// Moves a cursor, and returns what it took.
fn row(
    recording: &Recording,
    course: &Arc<Course>,
    motion: Motion,
    analysis: bool,
) -> Result<MotionRow> {
    let cursors = motion.cursors(course);
    let wanted = if analysis { ALL } else { Wanted::default() };
    let mut state = State::default();
    let mut moment = LiveMoment::new(Arc::clone(course));
    // The way to the first cursor is not measured, and has no limit of steps.
    state.seek(recording, cursors[0]);
    moment.seek(cursors[0], wanted, u64::MAX)?;

    let (mut steps, mut arrived, mut shown) = (0, 0, 0.0);
    let clock = Clock::start();
    for &cursor in &cursors[1..] {
        state.seek(recording, cursor);
        let moved = moment.seek(cursor, wanted, motion.budget())?;
        steps += moved.steps;
        arrived += usize::from(moved.arrived);
        if analysis {
            // Panels read these numbers in every frame. Without a reader the compiler could leave them out.
            let _ = std::hint::black_box(moment.measured());
            shown += moment.spectrum().map_or(0.0, LiveSpectrum::share);
        }
    }

    // Every cursor but the first is the end of a move.
    let moves = (cursors.len() - 1) as f64;
    Ok(MotionRow {
        samples: course.final_count(),
        motion,
        analysis,
        milliseconds: clock.seconds() * 1e3 / moves,
        steps: steps as f64 / moves,
        arrived: arrived as f64 / moves,
        frequencies: shown / moves,
    })
}

impl MotionRow {
    fn json(&self) -> Value {
        json!({
            "samples": self.samples,
            "motion": self.motion.name(),
            "analysis": self.analysis,
            "steps": self.steps,
            "milliseconds": self.milliseconds,
            "arrived": self.arrived,
            "frequencies": self.frequencies,
        })
    }
}

fn to_text(rows: &[MotionRow]) -> String {
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

/// The time that this thread computes. Other programs do not count, where the system tells.
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
            let [without, with] =
                [false, true].map(|analysis| row(&recording, &course, motion, analysis).unwrap());
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
