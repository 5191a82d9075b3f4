//! How moments become events and events moments: five words, a few bits and nothing lost.
//! It never looks at the run.

use tilescope_core::stages::detect::Sites;
use tilescope_core::{Moment, Point, Stage, Verdict};

use super::{Event, NONE};
use crate::kind::Kind;

/// Returns the moment of an event, or `None` for a notice of thinning.
pub(super) fn unpack(event: &Event) -> Option<Moment> {
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

    fn tiling(&self) -> Moment {
        let [a, b, ..] = self.words;
        match self.kind {
            Kind::Begin => Moment::Begin(stage(self.tags, a)),
            Kind::Split => Moment::Split {
                index: a,
                turned: self.flag(),
            },
            Kind::Leaf => Moment::Leaf { block: a },
            Kind::Clip => Moment::Clip { block: a },
            _ => Moment::Tiled {
                sample: a,
                block: b,
                inside: self.flag(),
            },
        }
    }

    fn elimination(&self) -> Moment {
        let [a, b, ..] = self.words;
        match self.kind {
            Kind::Take => Moment::Take {
                sample: a,
                valid: self.flag(),
            },
            Kind::Keep => Moment::Keep {
                sample: a,
                rest: self.flag(),
            },
            Kind::Test => Moment::Test {
                pivot: a,
                other: b,
                covers: self.flag(),
            },
            Kind::Eliminate => Moment::Eliminate { sample: a, by: b },
            _ => Moment::Mark {
                sample: a,
                because: b,
            },
        }
    }

    fn detection(&self) -> Moment {
        let [a, b, c, ..] = self.words;
        match self.kind {
            Kind::Iteration => Moment::Iteration {
                number: a,
                detectors: b,
            },
            Kind::Detect => Moment::Detect { sample: a },
            Kind::Search => Moment::Search {
                centre: a,
                radius: b as i32,
                found: c,
            },
            Kind::NoGap => Moment::NoGap { sample: a },
            Kind::Call => Moment::Call {
                pivot: a,
                iteration: b,
            },
            Kind::Pairs => Moment::Pairs {
                pivot: a,
                others: b,
            },
            _ => Moment::IterationEnd {
                number: a,
                inserted: b,
            },
        }
    }

    fn insertion(&self) -> Moment {
        let [a, b, c, d, _] = self.words;
        match self.kind {
            Kind::Rank => Moment::Rank { candidates: a },
            Kind::Pass => Moment::Pass {
                point: point(a, b),
                by: c,
            },
            Kind::Insert => Moment::Insert {
                sample: a,
                iteration: b,
            },
            Kind::Dart => Moment::Dart {
                point: point(a, b),
                ranked: self.is_ranked(),
                verdict: verdict(self.tags, c),
            },
            Kind::Cut => Moment::Cut {
                cell: point(a, b),
                side: c as i32,
                kept: d,
            },
            _ => Moment::Finish { count: a },
        }
    }

    fn candidate(&self) -> Moment {
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
        Moment::Candidate {
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

/// What a part of [`pack`] returns for moments that are not its own: never.
const fn nothing() -> Event {
    plain(Kind::Candidate, [NONE; 5])
}

/// Returns the event of a moment, without its line.
pub(super) fn pack(moment: &Moment) -> Event {
    match moment {
        Moment::Begin(_)
        | Moment::Split { .. }
        | Moment::Leaf { .. }
        | Moment::Clip { .. }
        | Moment::Tiled { .. }
        | Moment::Take { .. }
        | Moment::Keep { .. }
        | Moment::Test { .. }
        | Moment::Eliminate { .. }
        | Moment::Mark { .. } => pack_tiled(moment),
        Moment::Iteration { .. }
        | Moment::Detect { .. }
        | Moment::Search { .. }
        | Moment::NoGap { .. }
        | Moment::Call { .. }
        | Moment::Pairs { .. }
        | Moment::Rank { .. }
        | Moment::Insert { .. }
        | Moment::IterationEnd { .. }
        | Moment::Finish { .. } => pack_filling(moment),
        Moment::Pass { .. } | Moment::Dart { .. } | Moment::Cut { .. } => pack_place(moment),
        Moment::Candidate { .. } => pack_candidate(moment),
    }
}

/// Packs what happens before gaps are looked for.
fn pack_tiled(moment: &Moment) -> Event {
    match *moment {
        Moment::Begin(stage) => {
            let (tags, k) = stage_tags(stage);
            Event {
                tags,
                ..one(Kind::Begin, k)
            }
        }
        Moment::Split { index, turned } => flagged(Kind::Split, index, 0, turned),
        Moment::Leaf { block } => one(Kind::Leaf, block),
        Moment::Clip { block } => one(Kind::Clip, block),
        Moment::Tiled {
            sample,
            block,
            inside,
        } => flagged(Kind::Tiled, sample, block, inside),
        Moment::Take { sample, valid } => flagged(Kind::Take, sample, 0, valid),
        Moment::Keep { sample, rest } => flagged(Kind::Keep, sample, 0, rest),
        Moment::Test {
            pivot,
            other,
            covers,
        } => flagged(Kind::Test, pivot, other, covers),
        Moment::Eliminate { sample, by } => two(Kind::Eliminate, sample, by),
        Moment::Mark { sample, because } => two(Kind::Mark, sample, because),
        _ => nothing(),
    }
}

/// Packs what happens while gaps are filled.
fn pack_filling(moment: &Moment) -> Event {
    match *moment {
        Moment::Iteration { number, detectors } => two(Kind::Iteration, number, detectors),
        Moment::Detect { sample } => one(Kind::Detect, sample),
        Moment::Search {
            centre,
            radius,
            found,
        } => plain(Kind::Search, [centre, radius as u32, found, 0, 0]),
        Moment::NoGap { sample } => one(Kind::NoGap, sample),
        Moment::Call { pivot, iteration } => two(Kind::Call, pivot, iteration),
        Moment::Pairs { pivot, others } => two(Kind::Pairs, pivot, others),
        Moment::Rank { candidates } => one(Kind::Rank, candidates),
        Moment::Insert { sample, iteration } => two(Kind::Insert, sample, iteration),
        Moment::IterationEnd { number, inserted } => two(Kind::IterationEnd, number, inserted),
        Moment::Finish { count } => one(Kind::Finish, count),
        _ => nothing(),
    }
}

/// Packs what happens at a place that is no sample's.
fn pack_place(moment: &Moment) -> Event {
    match *moment {
        Moment::Pass { point, by } => plain(Kind::Pass, [point.x as u32, point.y as u32, by, 0, 0]),
        Moment::Dart {
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
        Moment::Cut { cell, side, kept } => plain(
            Kind::Cut,
            [cell.x as u32, cell.y as u32, side as u32, kept, 0],
        ),
        _ => nothing(),
    }
}

/// Packs an examined place. Offsets that come with another sample's id are within reach, below 2^19 units.
fn pack_candidate(moment: &Moment) -> Event {
    let &Moment::Candidate {
        detector,
        sites,
        offset: [x, y],
        verdict,
    } = moment
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
