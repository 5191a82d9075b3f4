//! The context of a cursor: current phase, iteration, sample, search and the candidate under test. It follows from the
//! last few events.

use glam::IVec2;
use tilescope_core::stages::detect::Sites;
use tilescope_core::{Point, RunEvent, Stage, Verdict};

use crate::event::Event;

/// A search for the valid samples around a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct NeighbourSearch {
    /// The sample in the middle.
    pub centre: u32,
    /// Its radius in units.
    pub radius: i32,
    /// How many samples it found.
    pub found: u32,
    /// The event that made it.
    pub event: u32,
}

/// A candidate under test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Examined {
    /// The detector that examines it.
    pub detector: u32,
    /// The samples that make it.
    pub sites: Sites,
    /// Its offset from the detector in units, clamped to 32 bits.
    pub offset: IVec2,
    /// The result of the test.
    pub verdict: Verdict,
}

/// The context of a cursor.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Context {
    /// The stage or iteration that has begun; `None` before the first event.
    pub phase: Option<Stage>,
    /// The iteration, from 1; 0 before the first.
    pub iteration: u32,
    /// The block that is being clipped.
    pub block: Option<u32>,
    /// The sample that is being tiled or processed, or around which gaps are searched (p in the listings).
    pub sample: Option<u32>,
    /// The sample with which it is compared (conflictPoint).
    pub other: Option<u32>,
    /// The last search of that sample: its test buffer is [`crate::Recording::test_buffer`].
    pub search: Option<NeighbourSearch>,
    /// The candidate under test.
    pub examined: Option<Examined>,
    /// The dart under test.
    pub dart: Option<(Point, Verdict)>,
}

impl Context {
    /// Applies an event, whose index on the tape is `index`. Events are applied in sequence.
    pub fn apply(&mut self, event: &Event, index: u32) {
        let Some(run_event) = event.run_event() else {
            return;
        };

        match run_event {
            RunEvent::Begin(stage) => self.enter(stage, self.iteration),
            RunEvent::Iteration { number, .. } => self.enter(Stage::Iterate(number), number),

            RunEvent::Clip { block } => self.block = Some(block),
            // Each of these makes a sample the current one. `rest` marks a sample deep inside its block: it is kept without
            // a turn, so that no `Take` comes before.
            RunEvent::Tiled { sample, .. }
            | RunEvent::Take { sample, .. }
            | RunEvent::Detect { sample }
            | RunEvent::Keep { sample, rest: true } => self.take(sample),

            // Algorithm 4 as printed inserts already in its first loop, where no event begins an iteration: the call names it.
            RunEvent::Call { iteration, .. } => self.iteration = iteration,
            RunEvent::Test { other, .. } => self.other = Some(other),

            // From here on candidates of all detectors are taken in one order, so that no detector is the current sample.
            RunEvent::Rank { .. } => {
                (self.sample, self.search, self.examined) = (None, None, None);
            }

            // Algorithm 4 as printed inserts while it goes through the samples of a search: the search's centre remains the
            // current sample.
            RunEvent::Insert { sample, .. } if self.search.is_none() => self.sample = Some(sample),

            // A wake is about a dart that the pattern refused, because of a sample that is missing in this run. The
            // dart will be asked again. Until it is, it is shown as accepted.
            RunEvent::Wake { point, .. } => self.dart = Some((point, Verdict::Accepted)),
            RunEvent::Dart { point, verdict, .. } => self.dart = Some((point, verdict)),

            RunEvent::Search {
                centre,
                radius,
                found,
            } => {
                // The candidate that was examined last belongs to the search before this one.
                self.examined = None;
                self.search = Some(NeighbourSearch {
                    centre,
                    radius,
                    found,
                    event: index,
                });
            }

            RunEvent::Candidate {
                detector,
                sites,
                offset,
                verdict,
            } => {
                self.examined = Some(Examined {
                    detector,
                    sites,
                    offset,
                    verdict,
                });
            }

            // All other events are about samples, cells or the tree of blocks, and leave the context as it is.
            _ => {}
        }
    }

    /// Begins a phase or an iteration.
    fn enter(&mut self, phase: Stage, iteration: u32) {
        *self = Self {
            phase: Some(phase),
            iteration,
            ..Self::default()
        };
    }

    fn take(&mut self, sample: u32) {
        self.sample = Some(sample);
        (self.other, self.search, self.examined) = (None, None, None);
    }
}
