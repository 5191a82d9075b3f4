//! How events are packed and unpacked: five words, a few bits and nothing lost.
//! It never looks at the run.

use tilescope_core::stages::detect::Sites;
use tilescope_core::{Point, RunEvent, Stage, Verdict};

use super::{Event, NONE};
use crate::kind::Kind;

/// Returns what an event was packed from, or `None` for a notice of thinning.
pub(super) fn unpack(event: &Event) -> Option<RunEvent> {
    Some(match event.kind {
        Kind::Begin | Kind::Split | Kind::Leaf | Kind::Clip | Kind::Tiled => event.tiling(),
        Kind::Take | Kind::Keep | Kind::Test | Kind::Eliminate | Kind::Mark => event.elimination(),
        Kind::Iteration
        | Kind::Detect
        | Kind::Search
        | Kind::NoGap
        | Kind::Call
        | Kind::Pairs
        | Kind::IterationEnd => event.detection(),
        Kind::Candidate => event.candidate(),
        Kind::Rank | Kind::Pass | Kind::Insert | Kind::Dart | Kind::Cut | Kind::Finish => {
            event.insertion()
        }
        Kind::Thinned => return None,
    })
}

impl Event {
    const fn flag(&self) -> bool {
        self.tags == 1
    }

    fn tiling(&self) -> RunEvent {
        let [a, b, ..] = self.words;
        match self.kind {
            Kind::Begin => RunEvent::Begin(stage(self.tags, a)),
            Kind::Split => RunEvent::Split {
                index: a,
                turned: self.flag(),
            },
            Kind::Leaf => RunEvent::Leaf { block: a },
            Kind::Clip => RunEvent::Clip { block: a },
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
            Kind::Take => RunEvent::Take {
                sample: a,
                valid: self.flag(),
            },
            Kind::Keep => RunEvent::Keep {
                sample: a,
                rest: self.flag(),
            },
            Kind::Test => RunEvent::Test {
                pivot: a,
                other: b,
                covers: self.flag(),
            },
            Kind::Eliminate => RunEvent::Eliminate { sample: a, by: b },
            _ => RunEvent::Mark {
                sample: a,
                because: b,
            },
        }
    }

    fn detection(&self) -> RunEvent {
        let [a, b, c, ..] = self.words;
        match self.kind {
            Kind::Iteration => RunEvent::Iteration {
                number: a,
                detectors: b,
            },
            Kind::Detect => RunEvent::Detect { sample: a },
            Kind::Search => RunEvent::Search {
                centre: a,
                radius: b as i32,
                found: c,
            },
            Kind::NoGap => RunEvent::NoGap { sample: a },
            Kind::Call => RunEvent::Call {
                pivot: a,
                iteration: b,
            },
            Kind::Pairs => RunEvent::Pairs {
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
            Kind::Rank => RunEvent::Rank { candidates: a },
            Kind::Pass => RunEvent::Pass {
                point: point(a, b),
                by: c,
            },
            Kind::Insert => RunEvent::Insert {
                sample: a,
                iteration: b,
            },
            Kind::Dart => RunEvent::Dart {
                point: point(a, b),
                ranked: self.is_ranked(),
                verdict: verdict(self.tags, c),
            },
            Kind::Cut => RunEvent::Cut {
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
                [join(e, self.extra & 15), join(e >> 16, self.extra >> 4)]
            }
            _ => [d as i32, e as i32],
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
pub(super) const fn plain(kind: Kind, words: [u32; 5]) -> Event {
    Event {
        kind,
        line: 0,
        tags: 0,
        extra: 0,
        words,
    }
}

fn flagged(kind: Kind, a: u32, b: u32, flag: bool) -> Event {
    Event {
        tags: u8::from(flag),
        ..plain(kind, [a, b, 0, 0, 0])
    }
}

const fn point(x: u32, y: u32) -> Point {
    Point::new(x as i32, y as i32)
}

const fn one(kind: Kind, a: u32) -> Event {
    plain(kind, [a, 0, 0, 0, 0])
}

const fn two(kind: Kind, a: u32, b: u32) -> Event {
    plain(kind, [a, b, 0, 0, 0])
}

/// What a part of [`pack`] returns for events that are not its own: never.
const fn nothing() -> Event {
    plain(Kind::Candidate, [NONE; 5])
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
            pack_place(run_event)
        }
        RunEvent::Candidate { .. } => pack_candidate(run_event),
    }
}

/// Packs what happens before gaps are looked for.
fn pack_tiled(run_event: &RunEvent) -> Event {
    match *run_event {
        RunEvent::Begin(stage) => {
            let (tags, k) = stage_tags(stage);
            Event {
                tags,
                ..one(Kind::Begin, k)
            }
        }
        RunEvent::Split { index, turned } => flagged(Kind::Split, index, 0, turned),
        RunEvent::Leaf { block } => one(Kind::Leaf, block),
        RunEvent::Clip { block } => one(Kind::Clip, block),
        RunEvent::Tiled {
            sample,
            block,
            inside,
        } => flagged(Kind::Tiled, sample, block, inside),
        RunEvent::Take { sample, valid } => flagged(Kind::Take, sample, 0, valid),
        RunEvent::Keep { sample, rest } => flagged(Kind::Keep, sample, 0, rest),
        RunEvent::Test {
            pivot,
            other,
            covers,
        } => flagged(Kind::Test, pivot, other, covers),
        RunEvent::Eliminate { sample, by } => two(Kind::Eliminate, sample, by),
        RunEvent::Mark { sample, because } => two(Kind::Mark, sample, because),
        _ => nothing(),
    }
}

/// Packs what happens while gaps are filled.
fn pack_filling(run_event: &RunEvent) -> Event {
    match *run_event {
        RunEvent::Iteration { number, detectors } => two(Kind::Iteration, number, detectors),
        RunEvent::Detect { sample } => one(Kind::Detect, sample),
        RunEvent::Search {
            centre,
            radius,
            found,
        } => plain(Kind::Search, [centre, radius as u32, found, 0, 0]),
        RunEvent::NoGap { sample } => one(Kind::NoGap, sample),
        RunEvent::Call { pivot, iteration } => two(Kind::Call, pivot, iteration),
        RunEvent::Pairs { pivot, others } => two(Kind::Pairs, pivot, others),
        RunEvent::Rank { candidates } => one(Kind::Rank, candidates),
        RunEvent::Insert { sample, iteration } => two(Kind::Insert, sample, iteration),
        RunEvent::IterationEnd { number, inserted } => two(Kind::IterationEnd, number, inserted),
        RunEvent::Finish { count } => one(Kind::Finish, count),
        _ => nothing(),
    }
}

/// Packs what happens at a place that is no sample's.
fn pack_place(run_event: &RunEvent) -> Event {
    match *run_event {
        RunEvent::Pass { point, by } => {
            plain(Kind::Pass, [point.x as u32, point.y as u32, by, 0, 0])
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
                ..plain(Kind::Dart, words)
            }
        }
        RunEvent::Cut { cell, side, kept } => plain(
            Kind::Cut,
            [cell.x as u32, cell.y as u32, side as u32, kept, 0],
        ),
        _ => nothing(),
    }
}

/// Packs an examined place. Offsets that come with another sample's id are within reach, below 2^19 units.
fn pack_candidate(run_event: &RunEvent) -> Event {
    let &RunEvent::Candidate {
        detector,
        sites,
        offset: [x, y],
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
    let place = ids.iter().position(|&id| id == detector).unwrap_or(0) as u8;
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
        tags: tags | tag << 3 | place << 5,
        extra,
        ..plain(Kind::Candidate, words)
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
