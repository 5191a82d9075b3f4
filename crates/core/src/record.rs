//! Events of a run, for recorders. A recorder does not change the run. [`Unrecorded`] costs nothing, since engines
//! check [`Recorder::ENABLED`] before they gather data that only a recording needs.

use glam::IVec2;

use crate::lattice::Point;
use crate::samples::Sites;
use crate::stage::Stage;

/// The result of examining a place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Verdict {
    /// It lies in a gap.
    Accepted,
    /// It is farther from its detector than the reach of detection.
    TooFar,
    /// It lies outside a bounded domain.
    Outside,
    /// A valid sample covers it.
    Covered {
        /// That sample's id, or `u32::MAX` where the process keeps no ids.
        by: u32,
    },
    /// A dart that does not exist, as fewer darts fall where the radius is large.
    Thinned,
    /// Another sample is clearly nearer to it than the samples that made it.
    NotNearest {
        /// The id of that sample.
        nearer: u32,
    },
}

/// An event of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunEvent {
    /// A stage of the run begins.
    Begin(Stage),
    /// A node of the KD-tree is cut.
    Split {
        /// Its index among the splits.
        index: u32,
        /// Whether it was too short across the axis whose turn it was.
        turned: bool,
    },
    /// A node of the KD-tree is a block.
    Leaf {
        /// The index of the block.
        block: u32,
    },
    /// A block's clip is placed in the pattern.
    Clip {
        /// The index of the block.
        block: u32,
    },
    /// A sample is tiled.
    Tiled {
        /// The id of the sample.
        sample: u32,
        /// The index of its block.
        block: u32,
        /// Whether it lies in the domain; otherwise it is dropped.
        inside: bool,
    },
    /// Elimination takes a sample.
    Take {
        /// The id of the sample.
        sample: u32,
        /// Whether it is still valid.
        valid: bool,
    },
    /// A sample is kept.
    Keep {
        /// The id of the sample.
        sample: u32,
        /// Whether it was never contested.
        rest: bool,
    },
    /// A kept sample is compared with another.
    Test {
        /// The id of the kept sample.
        pivot: u32,
        /// The id of the other one.
        other: u32,
        /// Whether the first covers the second.
        covers: bool,
    },
    /// A sample is eliminated.
    Eliminate {
        /// The id of the sample.
        sample: u32,
        /// The kept sample that covers it.
        by: u32,
    },
    /// A sample becomes a gap detector.
    Mark {
        /// The id of the sample.
        sample: u32,
        /// The eliminated, dropped or inserted sample that is the reason.
        because: u32,
    },
    /// An iteration of detection and insertion begins.
    Iteration {
        /// Its number, from 1.
        number: u32,
        /// How many detectors, or active cells, there are.
        detectors: u32,
    },
    /// A detector begins to look for gaps.
    Detect {
        /// The id of the sample.
        sample: u32,
    },
    /// The valid samples around a sample are gathered.
    Search {
        /// The sample in the middle.
        centre: u32,
        /// The radius of the search, in units.
        radius: i32,
        /// How many it finds, including the middle one if that is valid.
        found: u32,
    },
    /// A detector's neighbours prove that it has no gap.
    NoGap {
        /// The id of the detector.
        sample: u32,
    },
    /// Gaps are searched between a sample and all pairs of the test buffer.
    Call {
        /// The id of that sample.
        pivot: u32,
        /// The number of the iteration, from 1.
        iteration: u32,
    },
    /// The pairs of the test buffer are about to be examined.
    Pairs {
        /// The sample that is one of every three.
        pivot: u32,
        /// How many others there are.
        others: u32,
    },
    /// A place is examined.
    Candidate {
        /// The detector that examines it.
        detector: u32,
        /// The samples that make it.
        sites: Sites,
        /// The place as an offset from the detector, clamped to 32 bits.
        offset: IVec2,
        /// The result of the examination.
        verdict: Verdict,
    },
    /// The candidates of an iteration are put in order.
    Rank {
        /// How many there are.
        candidates: u32,
    },
    /// A candidate is skipped, since a sample inserted before it covers it.
    Pass {
        /// The place of the candidate.
        point: Point,
        /// The id of the inserted sample.
        by: u32,
    },
    /// A sample is inserted.
    Insert {
        /// The id of the sample.
        sample: u32,
        /// The number of the iteration, from 1.
        iteration: u32,
    },
    /// A dart that the pattern refused is to be asked again, since the sample that refused it first is missing.
    Wake {
        /// The place of the dart in the domain.
        point: Point,
        /// That sample's id if it was eliminated; `u32::MAX` if the block lacks it from the beginning.
        behind: u32,
    },
    /// A dart is thrown.
    Dart {
        /// The place where it lands.
        point: Point,
        /// Where it lands along the third axis, in units; 0 in the plane.
        z: i32,
        /// Whether it was sorted by rank, to be examined again in that order.
        ranked: bool,
        /// The result of the examination.
        verdict: Verdict,
    },
    /// An active cell is cut in four, or an active cube in eight.
    Cut {
        /// The lowest point of the cell.
        cell: Point,
        /// The lowest place of the cube along the third axis, in units; 0 in the plane.
        z: i32,
        /// The side of the cell, in units.
        side: i32,
        /// How many quarters or octants are not covered.
        kept: u32,
    },
    /// An iteration of detection and insertion ends.
    IterationEnd {
        /// The number of the iteration, from 1.
        number: u32,
        /// How many samples it inserted.
        inserted: u32,
    },
    /// The result is in canonical order.
    Finish {
        /// How many samples it has.
        count: u32,
    },
}

/// Receives the events of a run.
pub trait Recorder {
    /// Whether events are wanted at all.
    const ENABLED: bool = true;

    /// Called at every event, in sequence. Samples that an event names exist by then.
    fn record(&mut self, run_event: RunEvent);
}

/// The recorder that ignores all events.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unrecorded;

impl Recorder for Unrecorded {
    const ENABLED: bool = false;

    #[inline(always)]
    #[allow(clippy::inline_always, reason = "nothing must be left of it")]
    fn record(&mut self, _: RunEvent) {}
}
