//! Maps each event to the line of pseudocode that it executes. One table for each variant; a test checks that every
//! line of the listings is reached by some run.

use tilescope_core::stages::detect::Sites;
use tilescope_core::{Insertion, Parameters, RunEvent, Stage, Variant, Verdict};

use crate::listing::{LineId, Listings};

#[derive(Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub(crate) enum Program {
    Staged,
    Darts,
    Printed,
}

/// Finds the lines of a run's events.
#[derive(Clone)]
pub struct Lines {
    program: Program,
    starts: [(&'static str, u8); 9],
}

const NAMES: [&str; 9] = [
    "blocks",
    "tile",
    "printed",
    "gaps",
    "eliminate",
    "detect",
    "insert",
    "darts",
    "finish",
];

impl Lines {
    /// Returns the lines of runs of `parameters`.
    #[must_use]
    pub fn new(parameters: &Parameters) -> Self {
        let program = match (parameters.variant, parameters.insertion) {
            (Variant::AsPrinted, _) => Program::Printed,
            (Variant::Staged, Insertion::Circumcentre) => Program::Staged,
            (Variant::Staged, Insertion::Uniform) => Program::Darts,
        };
        Self::of_program(program)
    }

    /// Returns the program of these lines.
    pub(crate) const fn program(&self) -> Program {
        self.program
    }

    /// Returns the lines of a program.
    pub(crate) fn of_program(program: Program) -> Self {
        let start = |name: &'static str| {
            let listings = &Listings::shipped().listings;
            let found = listings.iter().find(|listing| listing.name == name);
            (name, found.map_or(0, |listing| listing.lines.start))
        };
        Self {
            program,
            starts: NAMES.map(start),
        }
    }

    /// Returns the line that an event executes.
    #[must_use]
    pub fn of(&self, run_event: &RunEvent) -> LineId {
        let (name, number) = self.name(run_event);
        let start = self.starts.iter().find(|(other, _)| *other == name);
        LineId(start.map_or(0, |(_, start)| start + number - 1))
    }

    fn name(&self, run_event: &RunEvent) -> (&'static str, u8) {
        match *run_event {
            RunEvent::Begin(stage) => self.begin(stage),
            RunEvent::Split { turned, .. } => ("blocks", if turned { 3 } else { 2 }),
            RunEvent::Leaf { .. } => ("blocks", 4),
            RunEvent::Clip { .. } => ("tile", 2),
            RunEvent::Tiled { inside, .. } => ("tile", if inside { 3 } else { 4 }),
            RunEvent::Finish { .. } => ("finish", 2),
            RunEvent::Candidate { sites, verdict, .. } => self.candidate(sites, verdict),
            RunEvent::Rank { .. } => ("insert", 1),
            RunEvent::Pass { .. } => ("insert", 2),
            RunEvent::NoGap { .. } => ("detect", 4),
            RunEvent::Pairs { .. } => ("gaps", 1),
            RunEvent::Dart { ranked: false, .. } => ("darts", 2),
            RunEvent::Dart {
                ranked: true,
                verdict,
                ..
            } => ("darts", if verdict == Verdict::Accepted { 4 } else { 3 }),
            RunEvent::Cut { .. } => ("darts", 6),
            _ if self.program == Program::Printed => printed(run_event),
            _ => self.staged(run_event),
        }
    }

    const fn begin(&self, stage: Stage) -> (&'static str, u8) {
        match (stage, self.program) {
            (Stage::Blocks | Stage::Pattern, _) => ("blocks", 1),
            (Stage::Tile, _) => ("tile", 1),
            (Stage::Eliminate, Program::Printed) => ("printed", 1),
            (Stage::Eliminate, _) => ("eliminate", 1),
            _ => ("finish", 1),
        }
    }

    fn candidate(&self, sites: Sites, verdict: Verdict) -> (&'static str, u8) {
        let printed = self.program == Program::Printed;
        match (sites, verdict) {
            (Sites::Three(_), Verdict::Accepted) if printed => ("gaps", 4),
            (Sites::Three(_), Verdict::Covered { .. }) if printed => ("gaps", 3),
            (Sites::Three(_), _) if printed => ("gaps", 2),
            _ if printed => ("gaps", 6),
            (Sites::Three(_), Verdict::Accepted) => ("detect", 6),
            (Sites::Three(_), _) => ("detect", 5),
            _ => ("detect", 7),
        }
    }

    fn staged(&self, run_event: &RunEvent) -> (&'static str, u8) {
        let darts = self.program == Program::Darts;
        match *run_event {
            RunEvent::Take { .. } => ("eliminate", 2),
            RunEvent::Keep { rest, .. } => ("eliminate", if rest { 6 } else { 3 }),
            RunEvent::Test { .. } => ("eliminate", 4),
            RunEvent::Eliminate { .. } => ("eliminate", 5),
            RunEvent::Mark { .. } => ("eliminate", 7),
            RunEvent::Iteration { .. } => (if darts { "darts" } else { "detect" }, 1),
            RunEvent::Detect { .. } => ("detect", 2),
            RunEvent::Insert { .. } if darts => ("darts", 5),
            RunEvent::Insert { .. } => ("insert", 3),
            RunEvent::IterationEnd { .. } if darts => ("darts", 7),
            RunEvent::IterationEnd { inserted, .. } => ("insert", if inserted > 0 { 4 } else { 5 }),
            _ => ("detect", 3),
        }
    }
}

const fn printed(run_event: &RunEvent) -> (&'static str, u8) {
    match *run_event {
        RunEvent::Take { .. } => ("printed", 2),
        RunEvent::Keep { rest: false, .. } => ("printed", 3),
        RunEvent::Mark { sample, because } => ("printed", if sample == because { 4 } else { 9 }),
        RunEvent::Search { radius, .. } if radius == tilescope_core::R => ("printed", 5),
        RunEvent::Test { .. } => ("printed", 6),
        RunEvent::Eliminate { .. } => ("printed", 7),
        RunEvent::Search { radius, .. }
            if radius == tilescope_core::stages::detect::DETECTOR_REACH =>
        {
            ("printed", 8)
        }
        RunEvent::Search { .. } => ("printed", 14),
        RunEvent::Keep { .. } => ("printed", 11),
        RunEvent::Iteration { .. } => ("printed", 12),
        RunEvent::Call { iteration, .. } => ("printed", if iteration == 1 { 10 } else { 15 }),
        RunEvent::Detect { .. } => ("printed", 13),
        RunEvent::IterationEnd { inserted, .. } => ("printed", if inserted > 0 { 16 } else { 17 }),
        _ => ("gaps", 5),
    }
}
