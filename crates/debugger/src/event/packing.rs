//! Packs and unpacks events: five words and a few bits, without loss.

use glam::IVec2;
use tilescope_core::stages::detect::Sites;
use tilescope_core::{Point, RunEvent, Stage, Verdict};

use super::{Event, NONE};
use crate::kind::EventKind;

/// Makes [`pack`] and [`unpack`] from a list of the events that are only numbers: of each, the fields in the order of its
/// words, and behind a semicolon the field that is a flag.
macro_rules! events {
    ($($kind:ident { $($word:ident),* $(; $flag:ident)? })*) => {
        /// Returns the packed event, without its line.
        pub(super) fn pack(run_event: &RunEvent) -> Event {
            match *run_event {
                $(RunEvent::$kind { $($word,)* $($flag)? } => {
                    // Without a flag among the fields this is false.
                    let flag = false $(| $flag)?;
                    packed(EventKind::$kind, u8::from(flag), &[$($word as u32),*])
                })*
                RunEvent::Begin(stage) => pack_begin(stage),
                RunEvent::Pass { point: Point { x, y }, by } => {
                    packed(EventKind::Pass, 0, &[x as u32, y as u32, by])
                }
                RunEvent::Wake { point: Point { x, y }, behind } => {
                    packed(EventKind::Wake, 0, &[x as u32, y as u32, behind])
                }
                RunEvent::Cut { cell: Point { x, y }, z, side, kept } => {
                    packed(EventKind::Cut, 0, &[x as u32, y as u32, side as u32, kept, z as u32])
                }
                RunEvent::Dart { point, z, ranked, verdict } => pack_dart(point, z, ranked, verdict),
                RunEvent::Candidate { detector, sites, offset, verdict } => {
                    pack_candidate(detector, sites, offset, verdict)
                }
            }
        }

        /// Returns the run event that an event was packed from, or `None` for a notice that events were left out.
        pub(super) fn unpack(event: &Event) -> Option<RunEvent> {
            let [a, b, c, d, e] = event.words;
            // The last word of a dart and of a cell is their place on the third axis.
            let (point, z) = (Point::new(a as i32, b as i32), e as i32);
            Some(match event.kind {
                $(EventKind::$kind => {
                    let mut words = event.words.into_iter();
                    RunEvent::$kind { $($word: words.next()? as _,)* $($flag: event.tags == 1)? }
                })*
                EventKind::Begin => RunEvent::Begin(stage(event.tags, a)),
                EventKind::Pass => RunEvent::Pass { point, by: c },
                EventKind::Wake => RunEvent::Wake { point, behind: c },
                EventKind::Cut => RunEvent::Cut { cell: point, z, side: c as i32, kept: d },
                EventKind::Dart => {
                    let verdict = verdict(event.tags, c);
                    RunEvent::Dart { point, z, ranked: event.is_ranked(), verdict }
                }
                EventKind::Candidate => unpack_candidate(event),
                EventKind::Thinned => return None,
            })
        }
    };
}

events! {
    Split { index; turned }
    Leaf { block }
    Clip { block }
    Tiled { sample, block; inside }
    Take { sample; valid }
    Keep { sample; rest }
    Test { pivot, other; covers }
    Eliminate { sample, by }
    Mark { sample, because }
    Iteration { number, detectors }
    Detect { sample }
    Search { centre, radius, found }
    NoGap { sample }
    Call { pivot, iteration }
    Pairs { pivot, others }
    Rank { candidates }
    Insert { sample, iteration }
    IterationEnd { number, inserted }
    Finish { count }
}

/// Returns an event without a line; words that are not given are zero.
pub(super) fn packed(kind: EventKind, tags: u8, given: &[u32]) -> Event {
    let mut words = [0; 5];
    words[..given.len()].copy_from_slice(given);
    Event {
        kind,
        line: 0,
        tags,
        extra: 0,
        words,
    }
}

/// Packs the beginning of a stage, whose number is the tag; [`stage`] reads it.
fn pack_begin(stage: Stage) -> Event {
    let (tags, k) = match stage {
        Stage::Pattern => (0, 0),
        Stage::Blocks => (1, 0),
        Stage::Tile => (2, 0),
        Stage::Eliminate => (3, 0),
        Stage::Iterate(k) => (4, k),
        Stage::Regions => (5, 0),
        Stage::Finish => (6, 0),
    };
    packed(EventKind::Begin, tags, &[k])
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

fn pack_dart(point: Point, z: i32, ranked: bool, verdict: Verdict) -> Event {
    let (tags, by) = verdict_tags(verdict);
    let by = by.unwrap_or(NONE);
    // The place on the third axis is in the last word, as of a cell, which has one number more.
    let words = [point.x as u32, point.y as u32, by, 0, z as u32];
    Event {
        extra: u8::from(ranked),
        ..packed(EventKind::Dart, tags, &words)
    }
}

/// Returns the packed event of a candidate. Its words are three sites and the offset or, if the verdict names a sample, three
/// sites, this sample, and the low bits of the offset.
fn pack_candidate(detector: u32, sites: Sites, IVec2 { x, y }: IVec2, verdict: Verdict) -> Event {
    let (tag, ids) = match sites {
        Sites::Three(ids) => (0, ids),
        Sites::Border([a, b]) => (1, [a, b, NONE]),
        Sites::Corner(a) => (2, [a, NONE, NONE]),
        // No event of a candidate has these sites: only inserted samples have them.
        Sites::Dart | Sites::Unrecorded => (2, [detector, NONE, NONE]),
    };

    // The detector is one of the sites, so that the 0 is never used. Two bits say which, so that its id is kept once.
    let index = ids.iter().position(|&id| id == detector).unwrap_or(0) as u8;
    let (tags, by) = verdict_tags(verdict);

    let (words, extra) = match by {
        None => ([ids[0], ids[1], ids[2], x as u32, y as u32], 0),
        Some(by) => {
            // The sample that the verdict names takes a word from the offset. Only a place within the reach of
            // detection (`Reach::radius`) has such a verdict, and that reach is at most 3.5r = 7 * 2^14 units. Thus
            // 20 signed bits hold each coordinate of the offset: 16 of them are in the last word, and 4 in the extra
            // byte.
            let low = (x as u32 & 0xffff) | (y as u32) << 16;
            let high = (x >> 16 & 15) | (y >> 16 & 15) << 4;
            ([ids[0], ids[1], ids[2], by, low], high as u8)
        }
    };

    // Bits 0 to 2 of the tags are the verdict's, 3 and 4 say the kind of sites, and 5 and 6 which site is the detector.
    Event {
        extra,
        ..packed(EventKind::Candidate, tags | tag << 3 | index << 5, &words)
    }
}

/// Returns the candidate of an event that [`pack_candidate`] made.
fn unpack_candidate(event: &Event) -> RunEvent {
    let [a, b, c, d, e] = event.words;
    let sites = match (event.tags >> 3) & 3 {
        0 => Sites::Three([a, b, c]),
        1 => Sites::Border([a, b]),
        _ => Sites::Corner(a),
    };

    let verdict = verdict(event.tags & 7, d);
    let offset = match verdict {
        Verdict::Covered { .. } | Verdict::NotNearest { .. } => {
            // A shift to the top of the word, and an arithmetic one down again, extends the sign of a number of 20 bits.
            let join = |low: u32, high: u8| {
                (((u32::from(high) << 16 | (low & 0xffff)) << 12) as i32) >> 12
            };
            IVec2::new(join(e, event.extra & 15), join(e >> 16, event.extra >> 4))
        }
        _ => IVec2::new(d as i32, e as i32),
    };

    RunEvent::Candidate {
        detector: event.words[usize::from(event.tags >> 5)],
        sites,
        offset,
        verdict,
    }
}

/// Returns the number of a verdict, which takes three bits, and the sample that it names; [`verdict`] reads both.
const fn verdict_tags(verdict: Verdict) -> (u8, Option<u32>) {
    match verdict {
        Verdict::Accepted => (0, None),
        Verdict::TooFar => (1, None),
        Verdict::Outside => (2, None),
        Verdict::Covered { by } => (3, Some(by)),
        Verdict::NotNearest { nearer } => (4, Some(nearer)),
        Verdict::Thinned => (5, None),
    }
}

const fn verdict(tags: u8, by: u32) -> Verdict {
    match tags {
        0 => Verdict::Accepted,
        1 => Verdict::TooFar,
        2 => Verdict::Outside,
        3 => Verdict::Covered { by },
        5 => Verdict::Thinned,
        _ => Verdict::NotNearest { nearer: by },
    }
}
