//! Sentences of runs in which the radius depends on the place: they name the radii, and give lengths in the units of the domain,
//! as r is no radius of any sample there.

use tilescope_core::{Locality, Point, RunEvent, Verdict};

use super::{Words, count, grouped, significant};

/// Returns three parts of the sentence of a covered dart, which lands or, if it is `ranked`, has its turn. The first
/// part stands before the dart's place. The second stands behind the place if the sentence names the sample that
/// covers the dart, and the third stands there if no such sample is known.
pub(super) const fn covered_words(ranked: bool) -> [&'static str; 3] {
    if ranked {
        [
            "the dart at",
            "is discarded",
            " is covered by now and is discarded",
        ]
    } else {
        [
            "a dart lands at",
            "and is discarded",
            ", which is covered, and is discarded",
        ]
    }
}

impl Words<'_> {
    /// Returns the sentence of a dart, a throw, an insertion or a cut in a run whose radius depends on the place.
    /// `None` for other events and runs, for verdicts that no dart gets, and for a sample without a place in the
    /// recording.
    pub(super) fn local(&self, run_event: RunEvent, index: usize) -> Option<String> {
        let locality = self.0.run().locality.as_deref()?;
        // An exact tiling of a shape has one radius, so that its events are those of any tiling.
        if self.0.is_exact() {
            return None;
        }

        Some(match run_event {
            RunEvent::Dart {
                point,
                ranked,
                verdict,
                ..
            } => self.local_dart(locality, point, ranked, verdict, index)?,

            RunEvent::Insert { sample, iteration } => {
                let place = self.0.point(sample)?;
                format!(
                    "sample {} is placed where a dart landed, at {}, in throw {}; its radius is {}",
                    grouped(sample.into()),
                    self.place(place),
                    grouped(iteration.into()),
                    self.radius(locality, place)
                )
            }

            // Such a run has no detectors. Instead of them the event counts the active cells, in which darts are
            // thrown.
            RunEvent::Iteration { number, detectors } => format!(
                "throw {} begins with {}",
                grouped(number.into()),
                count(detectors.into(), "active cell")
            ),
            // Every sample of such a run was a dart.
            RunEvent::IterationEnd { number, inserted } => format!(
                "throw {} ends: {} became samples",
                grouped(number.into()),
                count(inserted.into(), "dart")
            ),

            RunEvent::Cut {
                cell, side, kept, ..
            } => {
                // A quarter without a place of the shape is left out like one whose places are all near one sample.
                let kept = match kept {
                    0 => "each quarter is near one sample as a whole, or outside".to_owned(),
                    1 => "one quarter may be open".to_owned(),
                    more => format!("{more} quarters may be open"),
                };
                let (at, side) = (self.place(cell), self.length(side.into()));
                format!("the active cell at {at}, {side} wide, is cut in four: {kept}")
            }

            // All other events are those of any run.
            _ => return None,
        })
    }

    /// Returns the sentence of a dart that lands or, if it is `ranked`, of one whose turn comes; `index` is its
    /// event's. `None` for verdicts that no dart gets, and if the sample that covers the dart has no place in the
    /// recording: then the sentence is that of any run. If no such sample is found, the sentence names none.
    fn local_dart(
        &self,
        locality: &Locality,
        point: Point,
        ranked: bool,
        verdict: Verdict,
        index: usize,
    ) -> Option<String> {
        let at = self.place(point);
        // A dart outside has no radius. It may even lie where the field has no nodes.
        let radius = || self.radius(locality, point);

        Some(match (ranked, verdict) {
            (false, Verdict::Accepted) => {
                format!(
                    "a dart lands at {at} in the open; the radius there is {}",
                    radius()
                )
            }
            (true, Verdict::Accepted) => {
                format!(
                    "the dart at {at}, of radius {}, is still uncovered when its turn comes",
                    radius()
                )
            }

            (_, Verdict::Covered { .. }) => {
                let [what, verb, nameless] = covered_words(ranked);
                let own = radius();
                // The process keeps no ids, so that the earliest sample near the place is looked up.
                let Some(by) = self.0.covering(point, index) else {
                    return Some(format!("{what} {at}{nameless}"));
                };
                // The sentence shows the rule at work: the distance against the mean of both radii.
                let other = self.0.point(by)?;
                let squared = self.0.domain().distance_squared(point, other) as f64;
                let (apart, theirs) = (self.length(squared.sqrt()), self.radius(locality, other));
                let mean = self.length(locality.reach(point, other).into());
                format!(
                    "{what} {at} {verb}: sample {} is {apart} away; the radius here is {own}, there {theirs}, and their harmonic mean, {mean}, is not less than that",
                    grouped(by.into())
                )
            }

            (_, Verdict::Outside) => format!("a dart at {at} falls outside and is discarded"),
            (_, Verdict::Thinned) => format!(
                "a dart at {at} is left out by its coin: its cell throws as many as suit the cell's side, and the radius here, {}, is larger",
                radius()
            ),
            // Only candidates of detectors get these verdicts.
            (_, Verdict::TooFar | Verdict::NotNearest { .. }) => return None,
        })
    }

    /// Returns a length in the units of the domain, with three digits.
    fn length(&self, units: f64) -> String {
        significant(units * self.0.domain().unit().min_element())
    }

    fn radius(&self, locality: &Locality, place: Point) -> String {
        self.length(locality.radius_at(place).into())
    }

    /// Returns a place in the units of the domain, with as many decimals as its lengths need.
    fn place(&self, place: Point) -> String {
        let unit = self.0.domain().unit();
        let (x, y) = (f64::from(place.x) * unit.x, f64::from(place.y) * unit.y);
        // Digits down to a thousandth of r, by which no two samples can be taken for each other. The most, 9, are chosen, not measured.
        let decimals = (3.0 - self.0.domain().radius().log10().floor()).clamp(0.0, 9.0) as usize;
        format!("({x:.decimals$}, {y:.decimals$})")
    }
}
