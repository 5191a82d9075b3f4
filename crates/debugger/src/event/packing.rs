//! Packs and unpacks events: five words and a few bits, without loss.

use glam::IVec2;
use tilescope_core::stages::detect::Sites;
use tilescope_core::{Point, RunEvent, Stage, Verdict};

use super::{Event, NONE};
use crate::kind::EventKind;

/// Returns the run event that an event was packed from, or `None` for a notice of thinning.
pub(super) fn unpack(event: &Event) -> Option<RunEvent> {
    Some(match event.kind {
        EventKind::Begin
        | EventKind::Split
        | EventKind::Leaf
        | EventKind::Clip
        | EventKind::Tiled => event.tiling(),
        EventKind::Take
        | EventKind::Keep
        | EventKind::Test
        | EventKind::Eliminate
        | EventKind::Mark => event.elimination(),
        EventKind::Iteration
        | EventKind::Detect
        | EventKind::Search
        | EventKind::NoGap
        | EventKind::Call
        | EventKind::Pairs
        | EventKind::IterationEnd => event.detection(),
        EventKind::Candidate => event.candidate(),
        EventKind::Rank
        | EventKind::Pass
        | EventKind::Insert
        | EventKind::Dart
        | EventKind::Cut
        | EventKind::Finish => event.insertion(),
        EventKind::Thinned => return None,
    })
}

impl Event {
    const fn flag(&self) -> bool {
        self.tags == 1
    }

    fn tiling(&self) -> RunEvent {
        let [a, b, ..] = self.words;
        match self.kind {
            EventKind::Begin => RunEvent::Begin(stage(self.tags, a)),
            EventKind::Split => RunEvent::Split {
                index: a,
                turned: self.flag(),
            },
            EventKind::Leaf => RunEvent::Leaf { block: a },
            EventKind::Clip => RunEvent::Clip { block: a },
            _ => RunEvent::Tiled {
                sample: a,
                block: b,
                inside: self.flag(),
            },
        }
    }

    fn elimination(&self) -> RunEvent {
        let [a, b, ..] = self.words;
        match self.kind {
            EventKind::Take => RunEvent::Take {
                sample: a,
                valid: self.flag(),
            },
            EventKind::Keep => RunEvent::Keep {
                sample: a,
                rest: self.flag(),
            },
            EventKind::Test => RunEvent::Test {
                pivot: a,
                other: b,
                covers: self.flag(),
            },
            EventKind::Eliminate => RunEvent::Eliminate { sample: a, by: b },
            _ => RunEvent::Mark {
                sample: a,
                because: b,
            },
        }
    }

    fn detection(&self) -> RunEvent {
        let [a, b, c, ..] = self.words;
        match self.kind {
            EventKind::Iteration => RunEvent::Iteration {
                number: a,
                detectors: b,
            },
            EventKind::Detect => RunEvent::Detect { sample: a },
            EventKind::Search => RunEvent::Search {
                centre: a,
                radius: b as i32,
                found: c,
            },
            EventKind::NoGap => RunEvent::NoGap { sample: a },
            EventKind::Call => RunEvent::Call {
                pivot: a,
                iteration: b,
            },
            EventKind::Pairs => RunEvent::Pairs {
                pivot: a,
                others: b,
            },
            _ => RunEvent::IterationEnd {
                number: a,
                inserted: b,
            },
        }
    }

    fn insertion(&self) -> RunEvent {
        let [a, b, c, d, _] = self.words;
        match self.kind {
            EventKind::Rank => RunEvent::Rank { candidates: a },
            EventKind::Pass => RunEvent::Pass {
                point: point(a, b),
                by: c,
            },
            EventKind::Insert => RunEvent::Insert {
                sample: a,
                iteration: b,
            },
            EventKind::Dart => RunEvent::Dart {
                point: point(a, b),
                ranked: self.is_ranked(),
                verdict: verdict(self.tags, c),
            },
            EventKind::Cut => RunEvent::Cut {
                cell: point(a, b),
                side: c as i32,
                kept: d,
            },
            _ => RunEvent::Finish { count: a },
        }
    }

    fn candidate(&self) -> RunEvent {
        let [a, b, c, d, e] = self.words;
        let sites = match (self.tags >> 3) & 3 {
            0 => Sites::Three([a, b, c]),
            1 => Sites::Border([a, b]),
            _ => Sites::Corner(a),
        };
        let verdict = verdict(self.tags & 7, d);
        let offset = match verdict {
            Verdict::Covered { .. } | Verdict::NotNearest { .. } => {
                let join = |low: u32, high: u8| {
                    (((u32::from(high) << 16 | (low & 0xffff)) << 12) as i32) >> 12
                };
                IVec2::new(join(e, self.extra & 15), join(e >> 16, self.extra >> 4))
            }
            _ => IVec2::new(d as i32, e as i32),
        };
        RunEvent::Candidate {
            detector: self.words[usize::from(self.tags >> 5)],
            sites,
            offset,
            verdict,
        }
    }
}

/// Returns an event without a line.
pub(super) const fn plain(kind: EventKind, words: [u32; 5]) -> Event {
    Event {
        kind,
        line: 0,
        tags: 0,
        extra: 0,
        words,
    }
}

fn flagged(kind: EventKind, a: u32, b: u32, flag: bool) -> Event {
    Event {
        tags: u8::from(flag),
        ..plain(kind, [a, b, 0, 0, 0])
    }
}

const fn point(x: u32, y: u32) -> Point {
    Point::new(x as i32, y as i32)
}

const fn one(kind: EventKind, a: u32) -> Event {
    plain(kind, [a, 0, 0, 0, 0])
}

const fn two(kind: EventKind, a: u32, b: u32) -> Event {
    plain(kind, [a, b, 0, 0, 0])
}

/// Returns a placeholder that the parts of [`pack`] need for events that they are never called with.
const fn nothing() -> Event {
    plain(EventKind::Candidate, [NONE; 5])
}

/// Returns the packed event, without its line.
pub(super) fn pack(run_event: &RunEvent) -> Event {
    match run_event {
        RunEvent::Begin(_)
        | RunEvent::Split { .. }
        | RunEvent::Leaf { .. }
        | RunEvent::Clip { .. }
        | RunEvent::Tiled { .. }
        | RunEvent::Take { .. }
        | RunEvent::Keep { .. }
        | RunEvent::Test { .. }
        | RunEvent::Eliminate { .. }
        | RunEvent::Mark { .. } => pack_tiled(run_event),
        RunEvent::Iteration { .. }
        | RunEvent::Detect { .. }
        | RunEvent::Search { .. }
        | RunEvent::NoGap { .. }
        | RunEvent::Call { .. }
        | RunEvent::Pairs { .. }
        | RunEvent::Rank { .. }
        | RunEvent::Insert { .. }
        | RunEvent::IterationEnd { .. }
        | RunEvent::Finish { .. } => pack_filling(run_event),
        RunEvent::Pass { .. } | RunEvent::Dart { .. } | RunEvent::Cut { .. } => {
            pack_point(run_event)
        }
        RunEvent::Candidate { .. } => pack_candidate(run_event),
    }
}

/// Packs the events before gap detection.
fn pack_tiled(run_event: &RunEvent) -> Event {
    match *run_event {
        RunEvent::Begin(stage) => {
            let (tags, k) = stage_tags(stage);
            Event {
                tags,
                ..one(EventKind::Begin, k)
            }
        }
        RunEvent::Split { index, turned } => flagged(EventKind::Split, index, 0, turned),
        RunEvent::Leaf { block } => one(EventKind::Leaf, block),
        RunEvent::Clip { block } => one(EventKind::Clip, block),
        RunEvent::Tiled {
            sample,
            block,
            inside,
        } => flagged(EventKind::Tiled, sample, block, inside),
        RunEvent::Take { sample, valid } => flagged(EventKind::Take, sample, 0, valid),
        RunEvent::Keep { sample, rest } => flagged(EventKind::Keep, sample, 0, rest),
        RunEvent::Test {
            pivot,
            other,
            covers,
        } => flagged(EventKind::Test, pivot, other, covers),
        RunEvent::Eliminate { sample, by } => two(EventKind::Eliminate, sample, by),
        RunEvent::Mark { sample, because } => two(EventKind::Mark, sample, because),
        _ => nothing(),
    }
}

/// Packs the events while gaps are filled.
fn pack_filling(run_event: &RunEvent) -> Event {
    match *run_event {
        RunEvent::Iteration { number, detectors } => two(EventKind::Iteration, number, detectors),
        RunEvent::Detect { sample } => one(EventKind::Detect, sample),
        RunEvent::Search {
            centre,
            radius,
            found,
        } => plain(EventKind::Search, [centre, radius as u32, found, 0, 0]),
        RunEvent::NoGap { sample } => one(EventKind::NoGap, sample),
        RunEvent::Call { pivot, iteration } => two(EventKind::Call, pivot, iteration),
        RunEvent::Pairs { pivot, others } => two(EventKind::Pairs, pivot, others),
        RunEvent::Rank { candidates } => one(EventKind::Rank, candidates),
        RunEvent::Insert { sample, iteration } => two(EventKind::Insert, sample, iteration),
        RunEvent::IterationEnd { number, inserted } => {
            two(EventKind::IterationEnd, number, inserted)
        }
        RunEvent::Finish { count } => one(EventKind::Finish, count),
        _ => nothing(),
    }
}

/// Packs events at a point that is not a sample.
fn pack_point(run_event: &RunEvent) -> Event {
    match *run_event {
        RunEvent::Pass { point, by } => {
            plain(EventKind::Pass, [point.x as u32, point.y as u32, by, 0, 0])
        }
        RunEvent::Dart {
            point,
            ranked,
            verdict,
        } => {
            let (tags, by) = verdict_tags(verdict);
            let words = [point.x as u32, point.y as u32, by.unwrap_or(NONE), 0, 0];
            Event {
                tags,
                extra: u8::from(ranked),
                ..plain(EventKind::Dart, words)
            }
        }
        RunEvent::Cut { cell, side, kept } => plain(
            EventKind::Cut,
            [cell.x as u32, cell.y as u32, side as u32, kept, 0],
        ),
        _ => nothing(),
    }
}

/// Packs an examined point. Offsets that are packed together with another sample's id are within reach, below 2^19
/// units.
fn pack_candidate(run_event: &RunEvent) -> Event {
    let &RunEvent::Candidate {
        detector,
        sites,
        offset: IVec2 { x, y },
        verdict,
    } = run_event
    else {
        return nothing();
    };
    let (tag, ids) = match sites {
        Sites::Three(ids) => (0, ids),
        Sites::Border([a, b]) => (1, [a, b, NONE]),
        Sites::Corner(a) => (2, [a, NONE, NONE]),
        Sites::Dart | Sites::Unrecorded => (2, [detector, NONE, NONE]),
    };
    let index = ids.iter().position(|&id| id == detector).unwrap_or(0) as u8;
    let (tags, by) = verdict_tags(verdict);
    let (words, extra) = match by {
        None => ([ids[0], ids[1], ids[2], x as u32, y as u32], 0),
        Some(by) => {
            let low = (x as u32 & 0xffff) | (y as u32) << 16;
            let high = (x >> 16 & 15) | (y >> 16 & 15) << 4;
            ([ids[0], ids[1], ids[2], by, low], high as u8)
        }
    };
    Event {
        tags: tags | tag << 3 | index << 5,
        extra,
        ..plain(EventKind::Candidate, words)
    }
}

const fn verdict_tags(verdict: Verdict) -> (u8, Option<u32>) {
    match verdict {
        Verdict::Accepted => (0, None),
        Verdict::TooFar => (1, None),
        Verdict::Outside => (2, None),
        Verdict::Covered { by } => (3, Some(by)),
        Verdict::NotNearest { nearer } => (4, Some(nearer)),
    }
}

const fn verdict(tags: u8, by: u32) -> Verdict {
    match tags {
        0 => Verdict::Accepted,
        1 => Verdict::TooFar,
        2 => Verdict::Outside,
        3 => Verdict::Covered { by },
        _ => Verdict::NotNearest { nearer: by },
    }
}

const fn stage_tags(stage: Stage) -> (u8, u32) {
    match stage {
        Stage::Pattern => (0, 0),
        Stage::Blocks => (1, 0),
        Stage::Tile => (2, 0),
        Stage::Eliminate => (3, 0),
        Stage::Iterate(k) => (4, k),
        Stage::Regions => (5, 0),
        Stage::Finish => (6, 0),
    }
}

const fn stage(tags: u8, k: u32) -> Stage {
    match tags {
        0 => Stage::Pattern,
        1 => Stage::Blocks,
        2 => Stage::Tile,
        3 => Stage::Eliminate,
        4 => Stage::Iterate(k),
        5 => Stage::Regions,
        _ => Stage::Finish,
    }
}
