//! Maps each event to the line of pseudocode that it executes. One table for each variant; a test checks that every
//! line of the listings is reached by some run.

use tilescope_core::stages::detect::Sites;
use tilescope_core::{Insertion, Parameters, RunEvent, Stage, TilingMethod, Variant, Verdict};

use crate::listing::{LineId, Listings};

/// Finds the lines of a run's events.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Lines {
    /// Stages that place circumcentres.
    Staged,
    /// Stages that throw darts.
    Darts,
    /// Algorithm 4 as printed.
    Printed,
    /// Exact tiling, by the order of arrival.
    Exact,
}

impl Lines {
    /// Returns the lines of runs of `parameters`.
    #[must_use]
    pub const fn new(parameters: &Parameters) -> Self {
        match (parameters.method, parameters.variant, parameters.insertion) {
            (TilingMethod::Exact, _, _) => Self::Exact,
            (TilingMethod::Kdrt, Variant::AsPrinted, _) => Self::Printed,
            (TilingMethod::Kdrt, Variant::Staged, Insertion::Circumcentre) => Self::Staged,
            (TilingMethod::Kdrt, Variant::Staged, Insertion::Uniform) => Self::Darts,
        }
    }

    /// Returns the line that an event executes.
    #[must_use]
    pub fn of(self, run_event: &RunEvent) -> LineId {
        let (name, number) = self.listing_line(run_event);
        let mut listings = Listings::shipped().listings.iter();
        let listing = listings.find(|listing| listing.name == name);
        // Each name below is that of a listing, so that the 0 is never used.
        LineId(listing.map_or(0, |listing| listing.lines.start + number - 1))
    }

    /// Returns the name of the listing and the number of the line in it, from 1.
    fn listing_line(self, run_event: &RunEvent) -> (&'static str, u8) {
        match *run_event {
            RunEvent::Begin(stage) => self.begin(stage),
            // Exact tiling has a listing of its own, also for events that other runs have.
            _ if self == Self::Exact => exact(run_event),
            RunEvent::Split { .. } | RunEvent::Leaf { .. } | RunEvent::Finish { .. } => {
                shared(run_event)
            }

            RunEvent::Clip { .. } => ("tile", 2),
            RunEvent::Tiled { inside, .. } => ("tile", if inside { 3 } else { 4 }),

            RunEvent::Candidate { sites, verdict, .. } => self.candidate(sites, verdict),
            RunEvent::Rank { .. } => ("insert", 1),
            RunEvent::Pass { .. } => ("insert", 2),
            RunEvent::NoGap { .. } => ("detect", 4),
            RunEvent::Pairs { .. } => ("gaps", 1),

            // A dart is examined as it is thrown, and once more in its turn, by rank, if nothing covered it.
            RunEvent::Dart { ranked: false, .. } => ("darts", 2),
            RunEvent::Dart {
                ranked: true,
                verdict,
                ..
            } => ("darts", if verdict == Verdict::Accepted { 4 } else { 3 }),
            RunEvent::Cut { .. } => ("darts", 6),

            _ if self == Self::Printed => printed(run_event),
            _ => self.staged(run_event),
        }
    }

    const fn begin(self, stage: Stage) -> (&'static str, u8) {
        match (stage, self) {
            (Stage::Blocks | Stage::Pattern, _) => ("blocks", 1),
            (Stage::Tile, Self::Exact) => ("exact", 1),
            (Stage::Tile, _) => ("tile", 1),
            (Stage::Eliminate, Self::Printed) => ("printed", 1),
            (Stage::Eliminate, _) => ("eliminate", 1),
            // The end of the run: iterations begin with an event of another kind, and regions have no events.
            _ => ("finish", 1),
        }
    }

    /// Returns the line of a candidate, by its sites and by how its test ends.
    fn candidate(self, sites: Sites, verdict: Verdict) -> (&'static str, u8) {
        let printed = self == Self::Printed;
        match (sites, verdict) {
            (Sites::Three(_), Verdict::Accepted) if printed => ("gaps", 4),
            (Sites::Three(_), Verdict::Covered { .. }) if printed => ("gaps", 3),
            (Sites::Three(_), _) if printed => ("gaps", 2),
            // Fewer sites than three are those of a place on the border of the domain.
            _ if printed => ("gaps", 6),

            (Sites::Three(_), Verdict::Accepted) => ("detect", 6),
            (Sites::Three(_), _) => ("detect", 5),
            _ => ("detect", 7),
        }
    }

    /// Returns the line of an event of the stages, by circumcentres or by darts.
    fn staged(self, run_event: &RunEvent) -> (&'static str, u8) {
        let darts = self == Self::Darts;
        match *run_event {
            RunEvent::Take { .. } => ("eliminate", 2),
            // The rest are the samples that were never contested. They are kept once no turn is left.
            RunEvent::Keep { rest, .. } => ("eliminate", if rest { 6 } else { 3 }),
            RunEvent::Test { .. } => ("eliminate", 4),
            RunEvent::Eliminate { .. } => ("eliminate", 5),
            RunEvent::Mark { .. } => ("eliminate", 7),

            // In iterations, insertion by darts has some of the events of circumcentres, on lines of its own listing.
            RunEvent::Iteration { .. } => (if darts { "darts" } else { "detect" }, 1),
            RunEvent::Detect { .. } => ("detect", 2),

            RunEvent::Insert { .. } if darts => ("darts", 5),
            RunEvent::Insert { .. } => ("insert", 3),
            RunEvent::IterationEnd { .. } if darts => ("darts", 7),
            RunEvent::IterationEnd { inserted, .. } => ("insert", if inserted > 0 { 4 } else { 5 }),

            // Of the events that detection has, only its search is left.
            _ => ("detect", 3),
        }
    }
}

/// Returns the line of an event that all runs have.
const fn shared(run_event: &RunEvent) -> (&'static str, u8) {
    match *run_event {
        RunEvent::Split { turned, .. } => ("blocks", if turned { 3 } else { 2 }),
        RunEvent::Leaf { .. } => ("blocks", 4),
        _ => ("finish", 2),
    }
}

/// Returns the line of an event of exact tiling.
const fn exact(run_event: &RunEvent) -> (&'static str, u8) {
    match *run_event {
        RunEvent::Clip { .. } => ("exact", 2),
        RunEvent::Tiled { .. } => ("exact", 3),

        // `behind` is the sample that refused the dart first. The largest number is no id: that sample was never laid
        // down, and the dart is woken with the clip of its block.
        RunEvent::Wake {
            behind: u32::MAX, ..
        } => ("exact", 4),
        // A sample with an id is lost, and its loss wakes the dart.
        RunEvent::Wake { .. } => ("exact", 9),

        RunEvent::Iteration { .. } => ("exact", 5),
        RunEvent::Dart { ranked: false, .. } => ("exact", 6),
        RunEvent::Keep { .. } => ("exact", 7),
        RunEvent::Eliminate { .. } => ("exact", 8),
        RunEvent::Dart {
            verdict: Verdict::Accepted,
            ..
        } => ("exact", 11),
        RunEvent::Dart { .. } => ("exact", 10),
        RunEvent::Insert { .. } => ("exact", 12),
        RunEvent::Cut { .. } => ("exact", 13),
        RunEvent::IterationEnd { .. } => ("exact", 14),
        // Blocks and the result are those of any run.
        _ => shared(run_event),
    }
}

/// Returns the line of an event of Algorithm 4 as printed.
const fn printed(run_event: &RunEvent) -> (&'static str, u8) {
    match *run_event {
        RunEvent::Take { .. } => ("printed", 2),
        // A sample that was contested is kept in its turn, the others once no turn is left.
        RunEvent::Keep { rest: false, .. } => ("printed", 3),
        // Line 4 of the listing marks the sample whose turn it is, line 9 another one because of a loss near it.
        RunEvent::Mark { sample, because } => ("printed", if sample == because { 4 } else { 9 }),

        // The radius tells the searches apart: r for conflicts, a little above 2r for samples that border the gap of a lost
        // one, and another radius in the second loop.
        RunEvent::Search { radius, .. } if radius == tilescope_core::R => ("printed", 5),

        RunEvent::Test { .. } => ("printed", 6),
        RunEvent::Eliminate { .. } => ("printed", 7),
        RunEvent::Search { radius, .. }
            if radius == tilescope_core::stages::detect::DETECTOR_REACH =>
        {
            ("printed", 8)
        }
        RunEvent::Search { .. } => ("printed", 14),

        RunEvent::Keep { rest: true, .. } => ("printed", 11),
        RunEvent::Iteration { .. } => ("printed", 12),
        // The first loop is iteration 1, the second one has all later ones.
        RunEvent::Call { iteration, .. } => ("printed", if iteration == 1 { 10 } else { 15 }),
        RunEvent::Detect { .. } => ("printed", 13),
        RunEvent::IterationEnd { inserted, .. } => ("printed", if inserted > 0 { 16 } else { 17 }),
        // Of the events of a run as printed, only insertions are left.
        _ => ("gaps", 5),
    }
}
