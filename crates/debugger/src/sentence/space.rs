//! Sentences of runs in space: they name places by three coordinates, and say how far above or below a dart its blocker lies.

use tilescope_core::{Point, R, RunEvent, Verdict};

use super::local::covered_words;
use super::{Words, count, fraction, grouped, radii};

impl Words<'_> {
    /// Returns the sentence of a dart, a throw, an insertion or a cut in a run in space. `None` for other events and
    /// runs, for verdicts that no dart gets in space, and for a sample without a place in the recording.
    pub(super) fn space(&self, run_event: RunEvent, index: usize) -> Option<String> {
        let heights = self.0.heights()?;

        Some(match run_event {
            RunEvent::Dart {
                point,
                z,
                ranked,
                verdict,
            } => self.space_dart(point, z, ranked, verdict, index)?,

            RunEvent::Insert { sample, iteration } => {
                let (at, z) = (self.0.point(sample)?, *heights.get(sample as usize)?);
                format!(
                    "sample {} is placed where a dart landed, at {}, in throw {}",
                    grouped(sample.into()),
                    place(at, z),
                    grouped(iteration.into()),
                )
            }

            // Such a run has no detectors. Instead of them the event counts the active cubes, in which darts are
            // thrown.
            RunEvent::Iteration { number, detectors } => format!(
                "throw {} begins with {}",
                grouped(number.into()),
                count(detectors.into(), "active cube")
            ),
            // Every sample of such a run was a dart.
            RunEvent::IterationEnd { number, inserted } => format!(
                "throw {} ends: {} became samples",
                grouped(number.into()),
                count(inserted.into(), "dart")
            ),

            RunEvent::Cut {
                cell,
                z,
                side,
                kept,
            } => {
                let kept = match kept {
                    0 => "each octant lies in one ball as a whole".to_owned(),
                    1 => "one octant may be open".to_owned(),
                    more => format!("{more} octants may be open"),
                };
                let (at, side) = (place(cell, z), fraction(side));
                format!("the active cube at {at}, {side} wide, is cut in eight: {kept}")
            }

            // All other events are those of any run.
            _ => return None,
        })
    }

    /// Returns the sentence of a dart that lands or, if it is `ranked`, of one whose turn comes; `index` is its event's.
    /// `None` for verdicts that no dart gets in space, and if its blocker has no place: the sentence is then that of
    /// any run.
    fn space_dart(
        &self,
        point: Point,
        z: i32,
        ranked: bool,
        verdict: Verdict,
        index: usize,
    ) -> Option<String> {
        let at = place(point, z);
        Some(match (ranked, verdict) {
            (false, Verdict::Accepted) => format!("a dart lands at {at} in the open"),
            (true, Verdict::Accepted) => {
                format!("the dart at {at} is still uncovered when its turn comes")
            }

            (_, Verdict::Covered { .. }) => {
                let [what, verb, nameless] = covered_words(ranked);
                // The process keeps no ids, so that the earliest sample near the place is looked up.
                let Some(by) = self.0.covering_in_space(point, z, index) else {
                    return Some(format!("{what} {at}{nameless}"));
                };
                let seen = self.seen(by, point, z)?;
                format!(
                    "{what} {at} {verb}: sample {} is {seen}",
                    grouped(by.into())
                )
            }

            (_, Verdict::Outside) => {
                format!("a dart at {at} lands outside the box and is discarded")
            }
            // Balls have one radius, so that no coin thins their darts. A reach and a rival that is nearer are of candidates
            // alone.
            (_, Verdict::Thinned | Verdict::TooFar | Verdict::NotNearest { .. }) => return None,
        })
    }

    /// Returns "0.71 r away, 0.40 r below" of a sample, as seen from a place; at the same height "0.00 r above".
    fn seen(&self, sample: u32, point: Point, z: i32) -> Option<String> {
        let above = f64::from(self.0.above(sample, z)?);
        let planar = self
            .0
            .domain()
            .distance_squared(self.0.point(sample)?, point) as f64;
        let away = radii((planar + above * above).sqrt());
        let side = if above < 0.0 { "below" } else { "above" };
        Some(format!("{away} away, {} {side}", radii(above.abs())))
    }
}

/// Returns the coordinates of a place of space, in r from the lowest corner of the box.
fn place(point: Point, z: i32) -> String {
    let [x, y, z] = [point.x, point.y, z].map(|units| f64::from(units) / f64::from(R));
    format!("({x:.2}, {y:.2}, {z:.2}) r")
}
