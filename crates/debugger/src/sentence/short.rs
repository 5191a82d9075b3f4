//! Events as rows of a list: numbers of samples and few words.

use tilescope_core::stages::detect::Sites;
use tilescope_core::{RunEvent, Verdict};

use super::{Words, coordinates, count, fraction, grouped, radii, size};
use crate::event::NONE;
use crate::recording::Recording;

/// Returns a short text of the event at `index` for a row of a list, or "end" behind the last event: at most about 60
/// characters, with numbers of samples.
#[must_use]
pub fn short(recording: &Recording, index: usize) -> String {
    let Some(event) = recording.event(index) else {
        return "end".to_owned();
    };

    let words = Words(recording);
    match event.run_event() {
        Some(run_event) => words.short(run_event),
        // Only a notice of tests that were left out is no run event, and it has their number.
        None => format!(
            "{} left out",
            count(event.left_out().unwrap_or(0).into(), "test")
        ),
    }
}

/// Returns a number of a sample, a block or an iteration, or of samples; words for a sample that is not recorded.
fn number(id: u32) -> String {
    match id {
        NONE => "a sample".to_owned(),
        id => grouped(id.into()),
    }
}

/// Returns the levels of an iteration of exact tiling, the first of which has two.
fn levels(iteration: u32) -> String {
    match iteration {
        1 => "levels 0, 1".to_owned(),
        level => format!("level {level}"),
    }
}

impl Words<'_> {
    /// Returns the short text of a run event. Most events of single samples are passed on to functions of their own.
    fn short(&self, run_event: RunEvent) -> String {
        match run_event {
            // Iterations of exact tiling are levels, and what it inserts are samples that the pattern lacks.
            RunEvent::Iteration { number: k, .. } if self.0.is_exact() => levels(k),
            RunEvent::IterationEnd {
                number: k,
                inserted,
            } if self.0.is_exact() => {
                format!(
                    "end of {}: {} the pattern lacks",
                    levels(k),
                    number(inserted)
                )
            }
            RunEvent::Insert { sample, .. } if self.0.is_exact() => {
                format!("{} comes, which the pattern lacks", number(sample))
            }

            RunEvent::Begin(stage) => format!("begin: {stage}"),
            RunEvent::Split { index, .. } => match self.0.run().blocks.splits.get(index as usize) {
                Some(split) => format!("cut a node, {}", size(&split.rect)),
                None => "cut a node".to_owned(),
            },
            RunEvent::Leaf { block } => format!("block {}", number(block)),
            RunEvent::Clip { block } => format!("clip for block {}", number(block)),

            RunEvent::Iteration { number: k, .. } => format!("iteration {}", number(k)),
            RunEvent::IterationEnd {
                number: k,
                inserted,
            } => format!(
                "end of iteration {}: {} inserted",
                number(k),
                number(inserted)
            ),
            RunEvent::Rank { candidates } => {
                format!("order {}", count(candidates.into(), "candidate"))
            }
            RunEvent::Finish { count: n } => format!("result: {}", count(n.into(), "sample")),

            RunEvent::Candidate { sites, verdict, .. } => short_candidate(sites, verdict),
            RunEvent::Dart { point, verdict, .. } => {
                format!("dart at {}: {}", coordinates(point), outcome(verdict))
            }
            RunEvent::Wake { point, .. } => format!("wake the dart at {}", coordinates(point)),

            // In exact tiling a sample is kept when it arrives, or lost to one that came first.
            RunEvent::Keep { sample, .. } if self.0.is_exact() => {
                format!("{} arrives and stays", number(sample))
            }
            RunEvent::Eliminate { sample, by } if self.0.is_exact() => format!(
                "{} is lost: {} came first, {}",
                number(sample),
                number(by),
                self.apart(by, sample)
            ),

            RunEvent::Cut { side, kept, .. } => {
                // A cell is cut in four in the plane, and in eight in space.
                let part = if self.0.heights().is_some() {
                    "octant"
                } else {
                    "quarter"
                };
                format!(
                    "cut a cell of {}: {}",
                    fraction(side),
                    count(kept.into(), part)
                )
            }
            RunEvent::Pass { by, .. } => format!("pass over a candidate: {} covers it", number(by)),
            _ => self.short_of_sample(run_event),
        }
    }

    /// Returns the short text of an event of tiling or elimination, or of the mark of a detector; events of other kinds
    /// are passed on.
    fn short_of_sample(&self, run_event: RunEvent) -> String {
        match run_event {
            RunEvent::Tiled { sample, inside, .. } => {
                format!(
                    "{} {}",
                    if inside { "tile" } else { "drop" },
                    number(sample)
                )
            }
            RunEvent::Take { sample, valid } => {
                let lost = if valid { "" } else { ": already eliminated" };
                format!("visit sample {}{lost}", number(sample))
            }

            RunEvent::Keep { sample, .. } => format!("keep {}", number(sample)),
            RunEvent::Test {
                pivot,
                other,
                covers,
            } => {
                let verb = if covers { "covers" } else { "does not cover" };
                let apart = self.apart(pivot, other);
                format!("{} {verb} {}, {apart}", number(pivot), number(other))
            }

            RunEvent::Eliminate { sample, by } => {
                let apart = self.apart(by, sample);
                format!("{} eliminates {}, {apart}", number(by), number(sample))
            }

            RunEvent::Mark { sample, .. } => format!("mark {} as a detector", number(sample)),

            _ => Self::short_of_search(run_event),
        }
    }

    /// Returns the short text of an event of the search for gaps.
    fn short_of_search(run_event: RunEvent) -> String {
        match run_event {
            RunEvent::Detect { sample } => format!("detector {}", number(sample)),
            RunEvent::Search {
                centre,
                radius,
                found,
            } => {
                let reach = radii(f64::from(radius));
                format!(
                    "{} within {reach} of {}",
                    count(found.into(), "sample"),
                    number(centre)
                )
            }

            RunEvent::NoGap { sample } => format!("no gap around {}", number(sample)),
            RunEvent::Call { pivot, .. } => format!("fill gaps around {}", number(pivot)),

            RunEvent::Pairs { pivot, others } => {
                format!(
                    "pairs of {} with {}",
                    count(others.into(), "sample"),
                    number(pivot)
                )
            }

            RunEvent::Insert { sample, .. } => format!("insert {}", number(sample)),

            // `short` and `short_of_sample` have texts for all other kinds.
            _ => String::new(),
        }
    }
}

fn short_candidate(sites: Sites, verdict: Verdict) -> String {
    let ids: Vec<String> = sites.ids().iter().map(|&id| number(id)).collect();
    let what = match sites {
        Sites::Three(_) => "centre ",
        Sites::Border(_) => "border ",
        Sites::Corner(_) => "corner ",
        Sites::Dart | Sites::Unrecorded => "place",
    };
    format!("{what}{}: {}", ids.join(", "), outcome(verdict))
}

fn outcome(verdict: Verdict) -> String {
    match verdict {
        Verdict::Accepted => "open".to_owned(),
        Verdict::TooFar => "too far".to_owned(),
        Verdict::Outside => "outside".to_owned(),
        Verdict::Thinned => "thinned".to_owned(),
        Verdict::Covered { by: NONE } => "covered".to_owned(),
        Verdict::Covered { by } => format!("covered by {}", number(by)),
        Verdict::NotNearest { nearer } => format!("nearer to {}", number(nearer)),
    }
}
