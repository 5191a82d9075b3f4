//! Times the measures that move with a run, without drawing: played, step by step, and by jumps. A command line and a page call
//! it with clocks of their own.

use std::sync::Arc;

use serde::Serialize;
use tilescope_analysis::live::LiveSpectrum;
use tilescope_analysis::measures::MeasureError;
use tilescope_debugger::{Recording, State};

use crate::course::Course;
use crate::moment::{FRAME_STEPS, LiveMoment, Wanted};

/// Frames of a run that is played in 30 seconds, 60 in a second.
pub const FRAMES: usize = 1800;

/// Single changes of the samples, from the middle of the run on.
pub const STEPS: usize = 500;

/// Jumps to moments all over the run.
pub const JUMPS: usize = 20;

/// The radii of the runs that are timed: those of 10,041 and 100,218 samples.
pub const TIMED_RADII: [f64; 2] = [0.008_36, 0.002_643_7];

/// All that can be measured.
const ALL: Wanted = Wanted {
    spectrum: true,
    thinned: true,
    pairs: true,
    cover: true,
};

/// How the cursor moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Motion {
    /// Through the whole run in [`FRAMES`] frames.
    Play,
    /// From change to change of the samples.
    Step,
    /// To moments far from each other.
    Jump,
}

impl Motion {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Play, Self::Step, Self::Jump];

    /// Returns its name in tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Play => "play",
            Self::Step => "step",
            Self::Jump => "jump",
        }
    }

    /// Returns the cursors that are visited, the first of which is not timed.
    #[must_use]
    pub fn cursors(self, course: &Course) -> Vec<usize> {
        let (events, changes) = (course.events(), course.changes());
        match self {
            Self::Play => {
                // In 64 bits: in a browser numbers of events have 32.
                let at = |frame: usize| (frame as u64 * events as u64 / FRAMES as u64) as usize;
                (0..=FRAMES).map(at).collect()
            }
            Self::Step => {
                // The steps begin in the middle of the run's changes: chosen, not measured.
                let later = &changes[changes.len() / 2..];
                // A cursor counts the events that have happened, the change among them.
                let after = later.iter().map(|change| change.event as usize + 1);
                // The first cursor is the one that is not timed.
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
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Timed {
    /// How many samples the run has at its end.
    pub samples: usize,
    /// How the cursor moved.
    pub motion: Motion,
    /// Whether anything was measured.
    pub analysis: bool,
    /// The counted steps of a move.
    pub steps: f64,
    /// The milliseconds of a move.
    pub milliseconds: f64,
    /// The part of the moments at which all measures were there.
    pub arrived: f64,
    /// The part of the frequencies that were shown.
    pub frequencies: f64,
}

/// Moves a cursor of a recording, and returns what it took by `seconds`, a clock that never goes back. Without
/// `analysis` only the state of the recording moves, and nothing is measured.
///
/// # Errors
///
/// A measure is not defined in this domain.
pub fn timed(
    recording: &Recording,
    course: &Arc<Course>,
    motion: Motion,
    analysis: bool,
    seconds: &dyn Fn() -> f64,
) -> Result<Timed, MeasureError> {
    let mut cursors = motion.cursors(course);
    // A run without changes has no steps.
    if cursors.is_empty() {
        cursors.push(0);
    }
    let wanted = if analysis { ALL } else { Wanted::default() };
    let mut state = State::default();
    let mut moment = LiveMoment::new(Arc::clone(course));
    // The way to the first cursor is not timed, and has no limit of steps.
    state.seek(recording, cursors[0]);
    moment.seek(cursors[0], wanted, u64::MAX)?;

    let (mut steps, mut arrived, mut shown) = (0, 0, 0.0);
    let began = seconds();
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

    let taken = seconds() - began;
    // Every cursor but the first is the end of a move. There may be no other: then nothing is divided by zero.
    let moves = (cursors.len() - 1).max(1) as f64;
    Ok(Timed {
        samples: course.final_count(),
        motion,
        analysis,
        milliseconds: taken * 1e3 / moves,
        steps: steps as f64 / moves,
        arrived: arrived as f64 / moves,
        frequencies: shown / moves,
    })
}
