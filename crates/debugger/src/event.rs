//! Events of a run, packed into 24 bytes each, with the line of pseudocode that each executes. Packing loses nothing:
//! the run event can be unpacked again.

mod packing;

use tilescope_core::RunEvent;

use crate::kind::EventKind;
use crate::lines::Lines;
use crate::listing::LineId;

/// Stands for no sample, block or event.
pub const NONE: u32 = u32::MAX;

/// An event of a run, packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Event {
    kind: EventKind,
    line: u8,
    tags: u8,
    extra: u8,
    words: [u32; 5],
}

impl Event {
    /// Returns the packed form of an event.
    #[must_use]
    pub fn new(run_event: &RunEvent, lines: &Lines) -> Self {
        let mut event = packing::pack(run_event);
        event.line = lines.of(run_event).0;
        event
    }

    /// Returns the notice that `count` events were left out.
    #[must_use]
    pub fn thinned(count: u32, line: LineId) -> Self {
        let mut event = packing::packed(EventKind::Thinned, 0, &[count]);
        event.line = line.0;
        event
    }

    /// Returns the kind of the event.
    #[must_use]
    pub const fn kind(&self) -> EventKind {
        self.kind
    }

    /// Returns the line of pseudocode that the event executes.
    #[must_use]
    pub const fn line(&self) -> LineId {
        LineId(self.line)
    }

    /// Returns the depth in the tree of events.
    #[must_use]
    pub const fn depth(&self) -> u8 {
        self.kind.depth()
    }

    /// Returns whether the event changes no set and led to nothing, so that it may be thinned.
    #[must_use]
    pub const fn is_detail(&self) -> bool {
        match self.kind {
            // The tag of a test says whether one sample covers the other.
            EventKind::Test => self.tags == 0,
            // The lowest three bits are the verdict: 0 is that of an accepted place.
            EventKind::Candidate | EventKind::Dart => self.tags & 7 != 0,
            EventKind::Cut => true,
            // Events of all other kinds are kept.
            _ => false,
        }
    }

    /// Returns whether a dart was sorted by rank.
    pub(crate) const fn is_ranked(&self) -> bool {
        self.extra == 1
    }

    /// Returns how many events a notice stands for, or `None` for other events.
    #[must_use]
    pub const fn left_out(&self) -> Option<u32> {
        match self.kind {
            EventKind::Thinned => Some(self.words[0]),
            _ => None,
        }
    }

    /// Returns the samples that the event names; the rest of the array is [`NONE`].
    #[must_use]
    pub fn samples(&self) -> [u32; 4] {
        let [a, b, c, d, _] = self.words;
        match self.kind {
            EventKind::Tiled
            | EventKind::Take
            | EventKind::Keep
            | EventKind::Detect
            | EventKind::Search
            | EventKind::NoGap
            | EventKind::Call
            | EventKind::Pairs
            | EventKind::Insert => [a, NONE, NONE, NONE],
            EventKind::Test | EventKind::Eliminate | EventKind::Mark => [a, b, NONE, NONE],
            // Their first two words are a place.
            EventKind::Pass | EventKind::Wake | EventKind::Dart => [c, NONE, NONE, NONE],
            // The lowest three bits are the verdict: a candidate that is covered (3), or has a nearer sample (4), names
            // that sample, too.
            EventKind::Candidate if matches!(self.tags & 7, 3 | 4) => [a, b, c, d],
            EventKind::Candidate => [a, b, c, NONE],
            // The words of all other kinds are numbers of other things.
            _ => [NONE; 4],
        }
    }

    /// Returns whether the event names a sample.
    #[must_use]
    pub fn touches(&self, sample: u32) -> bool {
        sample != NONE && self.samples().contains(&sample)
    }

    /// Returns the run event that it was packed from, or `None` for a notice of thinning.
    #[must_use]
    pub fn run_event(&self) -> Option<RunEvent> {
        packing::unpack(self)
    }
}
