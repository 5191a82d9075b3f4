//! Events: the moments of a run in 24 bytes each, with the line of pseudocode that each executes.
//! Packing loses nothing: an event gives back the moment that it was made from.
//! It never looks at the run.

use tilescope_core::stages::detect::Sites;
use tilescope_core::{Moment, Point, Stage, Verdict};

use crate::kind::Kind;
use crate::lines::Lines;
use crate::listing::LineId;

/// No sample, block or event.
pub const NONE: u32 = u32::MAX;

/// A moment, packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Event {
    kind: Kind,
    line: u8,
    tags: u8,
    extra: u8,
    words: [u32; 5],
}

impl Event {
    /// Returns the event of a moment in a run of `variant`.
    #[must_use]
    pub fn new(moment: &Moment, lines: &Lines) -> Self {
        let mut event = pack(moment);
        event.line = lines.of(moment).0;
        event
    }

    /// Returns the notice that `count` events were left out.
    #[must_use]
    pub const fn thinned(count: u32, line: LineId) -> Self {
        let mut event = plain(Kind::Thinned, [count, 0, 0, 0, 0]);
        event.line = line.0;
        event
    }

    /// Returns what the event is about.
    #[must_use]
    pub const fn kind(&self) -> Kind {
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
            Kind::Test => self.tags == 0,
            Kind::Candidate | Kind::Dart => self.tags & 7 != 0,
            Kind::Cut => true,
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
            Kind::Thinned => Some(self.words[0]),
            _ => None,
        }
    }

    /// Returns the samples that the event names; the rest of the array is [`NONE`].
    #[must_use]
    pub fn samples(&self) -> [u32; 4] {
        let [a, b, c, d, _] = self.words;
        match self.kind {
            Kind::Tiled
            | Kind::Take
            | Kind::Keep
            | Kind::Detect
            | Kind::Search
            | Kind::NoGap
            | Kind::Call
            | Kind::Pairs
            | Kind::Insert => [a, NONE, NONE, NONE],
            Kind::Test | Kind::Eliminate | Kind::Mark => [a, b, NONE, NONE],
            Kind::Pass | Kind::Dart => [c, NONE, NONE, NONE],
            Kind::Candidate if matches!(self.tags & 7, 3 | 4) => [a, b, c, d],
            Kind::Candidate => [a, b, c, NONE],
            _ => [NONE; 4],
        }
    }

    /// Returns whether the event names a sample.
    #[must_use]
    pub fn touches(&self, sample: u32) -> bool {
        sample != NONE && self.samples().contains(&sample)
    }

    /// Returns the moment, or `None` for a notice of thinning.
    #[must_use]
    pub fn moment(&self) -> Option<Moment> {
        let [a, b, c, _, _] = self.words;
        let flag = self.tags == 1;
        Some(match self.kind {
            Kind::Begin => Moment::Begin(stage(self.tags, a)),
            Kind::Split => Moment::Split {
                index: a,
                turned: flag,
            },
            Kind::Leaf => Moment::Leaf { block: a },
            Kind::Clip => Moment::Clip { block: a },
            Kind::Tiled => Moment::Tiled {
                sample: a,
                block: b,
                inside: flag,
            },
            Kind::Take => Moment::Take {
                sample: a,
                valid: flag,
            },
            Kind::Keep => Moment::Keep {
                sample: a,
                rest: flag,
            },
            Kind::Test => Moment::Test {
                pivot: a,
                other: b,
                covers: flag,
            },
            Kind::Eliminate => Moment::Eliminate { sample: a, by: b },
            Kind::Mark => Moment::Mark {
                sample: a,
                because: b,
            },
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
            Kind::Candidate => self.candidate(),
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
                ranked: self.extra == 1,
                verdict: verdict(self.tags, c),
            },
            Kind::Cut => Moment::Cut {
                cell: point(a, b),
                side: c as i32,
                kept: self.words[3],
            },
            Kind::IterationEnd => Moment::IterationEnd {
                number: a,
                inserted: b,
            },
            Kind::Finish => Moment::Finish { count: a },
            Kind::Thinned => return None,
        })
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

const fn plain(kind: Kind, words: [u32; 5]) -> Event {
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

fn pack(moment: &Moment) -> Event {
    let one = |kind, a| plain(kind, [a, 0, 0, 0, 0]);
    let two = |kind, a, b| plain(kind, [a, b, 0, 0, 0]);
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
        Moment::Candidate { .. } => pack_candidate(moment),
        Moment::Rank { candidates } => one(Kind::Rank, candidates),
        Moment::Pass { point, by } => plain(Kind::Pass, [point.x as u32, point.y as u32, by, 0, 0]),
        Moment::Insert { sample, iteration } => two(Kind::Insert, sample, iteration),
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
        Moment::IterationEnd { number, inserted } => two(Kind::IterationEnd, number, inserted),
        Moment::Finish { count } => one(Kind::Finish, count),
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
        return plain(Kind::Candidate, [NONE; 5]);
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
