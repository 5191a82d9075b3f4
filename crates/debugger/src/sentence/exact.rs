//! Sentences that only exact tilings have, about samples and darts that arrive in their order.

use tilescope_core::{Point, RunEvent, Stage, Verdict};

use super::{Words, coordinates, count, fraction, grouped, radii};
use crate::event::NONE;

impl Words<'_> {
    /// Returns the sentence of an event that exact tilings alone have, or that means another thing in them; `None` for all
    /// other events and runs.
    pub(super) fn exact(&self, run_event: RunEvent) -> Option<String> {
        if !self.0.is_exact() {
            return None;
        }

        Some(match run_event {
            RunEvent::Begin(Stage::Tile) => {
                let blocks = count(self.0.run().blocks.leaves.len() as u64, "block");
                format!("{blocks} are about to be laid on the pattern")
            }
            // `rest` says that the sample was never contested.
            RunEvent::Keep { sample, rest: true } => format!(
                "{} arrives deep in its block, where it stays",
                self.sample(sample)
            ),
            RunEvent::Keep { sample, .. } => format!(
                "{} arrives near a seam and stays, since no earlier sample covers it",
                self.sample(sample)
            ),
            RunEvent::Eliminate { sample, by } => format!(
                "{} arrives and is lost: {}, {} away, came first",
                self.sample(sample),
                self.sample(by),
                self.apart(by, sample)
            ),

            RunEvent::Wake { point, behind } => self.wake(point, behind),
            RunEvent::Dart {
                point,
                ranked,
                verdict,
                ..
            } => self.arrival(point, ranked, verdict)?,
            RunEvent::Insert { sample, .. } => format!(
                "{} is a sample that the pattern lacks: there its dart was refused",
                self.sample(sample)
            ),

            // Levels 0 and 1 arrive together, as iteration 1; from 2 on an iteration is a level. Its event counts the
            // active cells where that of other runs counts detectors.
            RunEvent::Iteration { number: 1, .. } => {
                "levels 0 and 1 begin: samples and woken darts arrive in their order".to_owned()
            }
            RunEvent::Iteration { number, detectors } => format!(
                "level {} begins with {}",
                grouped(number.into()),
                count(detectors.into(), "active cell")
            ),
            RunEvent::IterationEnd { number, inserted } => {
                let inserted = count(inserted.into(), "sample");
                match number {
                    1 => format!(
                        "levels 0 and 1 end: they brought {inserted} that the pattern lacks"
                    ),
                    number => {
                        format!("level {number} ends: it brought {inserted} that the pattern lacks")
                    }
                }
            }
            RunEvent::Cut {
                cell, side, kept, ..
            } => cut(cell, side, kept),
            // All other events mean the same as in any run.
            _ => return None,
        })
    }

    /// Returns the sentence of a dart that is woken. `behind` is the sample that refused it first, or [`NONE`] for one that the
    /// clip lacks.
    fn wake(&self, point: Point, behind: u32) -> String {
        let at = coordinates(point);
        // Of a shape, the pattern's samples outside are missing, too, as no dart falls there.
        let or_outside = match self.0.run().locality {
            Some(_) => ", or outside of the shape",
            None => "",
        };
        match behind {
            NONE => format!(
                "the dart at {at} is woken: what refused it first in the pattern lies beyond the border of its block{or_outside}"
            ),
            behind => format!(
                "the dart at {at} is woken: {}, which is lost, had refused it first",
                self.sample(behind)
            ),
        }
    }

    /// Returns the sentence of a dart; `None` for a verdict that exact tilings lack. A dart is examined where it falls,
    /// and again, as a `ranked` one, when its turn in the order of arrival comes.
    fn arrival(&self, point: Point, ranked: bool, verdict: Verdict) -> Option<String> {
        let at = coordinates(point);
        match (ranked, verdict) {
            (false, Verdict::Accepted) => Some(format!(
                "a dart of the pattern falls at {at}, where nothing that is earlier than its level covers it"
            )),
            (false, Verdict::Covered { by }) => Some(format!(
                "a dart of the pattern falls at {at} and is refused: {} came first",
                self.blocker(point, by)
            )),
            (true, Verdict::Accepted) => Some(format!(
                "the dart at {at} arrives, and no earlier sample covers it"
            )),
            (true, Verdict::Covered { by }) => Some(format!(
                "the dart at {at} arrives and is refused: {} came first",
                self.blocker(point, by)
            )),
            // No dart of an exact tiling gets one of these verdicts.
            (
                _,
                Verdict::TooFar | Verdict::Outside | Verdict::Thinned | Verdict::NotNearest { .. },
            ) => None,
        }
    }

    /// Returns the name of a sample, and how far it is from a place.
    fn blocker(&self, point: Point, by: u32) -> String {
        let away = self.0.point(by).map_or_else(String::new, |by| {
            let squared = self.0.domain().distance_squared(by, point);
            format!(", {} away,", radii((squared as f64).sqrt()))
        });
        format!("{}{away}", self.sample(by))
    }
}

fn cut(cell: Point, side: i32, kept: u32) -> String {
    let (at, side) = (coordinates(cell), fraction(side));
    let kept = match kept {
        0 => "no part of it is bare".to_owned(),
        1 => "one part may be bare".to_owned(),
        more => format!("{} parts may be bare", grouped(more.into())),
    };
    format!("the active cell at {at}, {side} wide, is cut: {kept}")
}
