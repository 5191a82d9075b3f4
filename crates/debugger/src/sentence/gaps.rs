//! Sentences about the search for gaps, candidates, insertions and darts.

use glam::IVec2;
use tilescope_core::stages::detect::Sites;
use tilescope_core::{Origin, Point, RunEvent, Verdict};

use super::{Words, coordinates, count, fraction, grouped, radii};
use crate::event::NONE;

impl Words<'_> {
    /// Returns the sentence of an event of the search for gaps; empty for kinds that have a sentence elsewhere.
    pub(super) fn search(&self, run_event: RunEvent) -> String {
        match run_event {
            RunEvent::Detect { sample } => {
                format!("{} begins to look for gaps", self.sample(sample))
            }
            RunEvent::Search {
                centre,
                radius,
                found,
            } => {
                let found = count(found.into(), "valid sample");
                let reach = radii(f64::from(radius));
                format!(
                    "within {reach} of {} there are {found}",
                    self.sample(centre)
                )
            }

            // The bisectors with the neighbours bound the detector's Voronoi cell. The event says that the cell lies
            // within the detector's disk, so that no place of the cell is bare.
            RunEvent::NoGap { sample } => {
                format!(
                    "the neighbours of {} leave no gap around it",
                    self.sample(sample)
                )
            }

            RunEvent::Call { pivot, iteration } => {
                let iteration = grouped(iteration.into());
                let pivot = self.sample(pivot);
                format!(
                    "gaps around {pivot} are about to be found and filled, in iteration {iteration}"
                )
            }
            RunEvent::Pairs { pivot, others } => {
                // n samples have n (n - 1) / 2 pairs.
                let pairs = u64::from(others) * u64::from(others.saturating_sub(1)) / 2;
                let (pairs, pivot) = (count(pairs, "pair"), self.sample(pivot));
                format!("{pivot} is about to form triangles with {pairs} of its test buffer")
            }

            RunEvent::Pass { point, by } => self.pass(point, by),
            // The functions that passed the event on have sentences for all other kinds.
            _ => String::new(),
        }
    }

    /// Returns the sentence of a candidate that an inserted sample covers; without the sample's place it names no distance.
    fn pass(&self, point: Point, by: u32) -> String {
        let (at, inserted) = (coordinates(point), self.sample(by));
        let apart = self.0.point(by).map_or_else(String::new, |by| {
            let squared = self.0.domain().distance_squared(by, point);
            format!(", {} away,", radii((squared as f64).sqrt()))
        });
        format!("the candidate at {at} is passed over: {inserted}{apart} covers it")
    }

    /// Returns the sentence of a candidate that a detector examines, with its verdict. `offset` is its place from the
    /// detector.
    pub(super) fn candidate(
        &self,
        detector: u32,
        sites: Sites,
        offset: IVec2,
        verdict: Verdict,
    ) -> String {
        // The detector is one of the sites: the sentence names it first, and then the others.
        let own = self.sample(detector);
        let other_ids = sites.ids().iter().filter(|&&id| id != detector);
        let named: Vec<String> = other_ids.map(|&id| self.sample(id)).collect();
        let others = named.join(" and ");

        let what = match sites {
            Sites::Three(_) => format!("the circumcentre of {own} with {others}"),
            Sites::Border(_) => format!("the border point as far from {own} as from {others}"),
            Sites::Corner(_) => format!("a corner of the domain, seen from {own}"),
            Sites::Dart | Sites::Unrecorded => format!("a place near {own}"),
        };

        let away = radii(f64::from(offset.x).hypot(f64::from(offset.y)));
        let outcome = match verdict {
            Verdict::Accepted => "lies in a gap".to_owned(),
            Verdict::TooFar => "is beyond the reach of detection".to_owned(),
            Verdict::Outside => "lies outside the domain".to_owned(),
            // No candidate is thinned, only darts are.
            Verdict::Thinned => "is left out".to_owned(),
            Verdict::Covered { by } => format!("is covered by {}", self.sample(by)),
            Verdict::NotNearest { nearer } => format!("is nearer to {}", self.sample(nearer)),
        };

        format!("{what}, {away} away, {outcome}")
    }

    /// Returns the sentence of an inserted sample, with the samples whose gap it fills, as far as they were recorded.
    pub(super) fn insertion(&self, sample: u32, iteration: u32) -> String {
        let name = self.sample(sample);
        let sites = match self.0.run().samples.origins.get(sample as usize) {
            Some(Origin::Inserted { sites, .. }) => *sites,
            _ => Sites::Unrecorded,
        };

        let numbers: Vec<String> = sites.ids().iter().map(|&id| grouped(id.into())).collect();
        // The last number is joined by a word, as in "1, 2 and 3".
        let samples = match numbers.split_last() {
            Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
            _ => numbers.concat(),
        };

        let at = match sites {
            Sites::Three(_) => format!("at the circumcentre of samples {samples}"),
            Sites::Border(_) => format!("on the border, as far from samples {samples}"),
            Sites::Corner(_) => format!("in a corner of the domain, seen from sample {samples}"),
            Sites::Dart => "where a dart landed".to_owned(),
            Sites::Unrecorded => "in a gap".to_owned(),
        };

        format!(
            "{name} is placed {at}, in iteration {}",
            grouped(iteration.into())
        )
    }

    /// Returns the sentence of a dart that lands or, if it is `ranked`, of one whose turn comes.
    pub(super) fn dart(&self, point: Point, ranked: bool, verdict: Verdict) -> String {
        let at = coordinates(point);
        // These are darts of uniform insertion, which does not record the sample that covers a place. Instead of the
        // sample's id the event has `NONE`, and the sentence names no sample. Exact tilings record the id, but have
        // sentences of their own (`exact`).
        let by = |id: u32| match id {
            NONE => String::new(),
            id => format!(" by {}", self.sample(id)),
        };

        // A dart is examined when it lands. If it lands in the open it is examined again when its rank is reached, as darts
        // of lower ranks may have become samples meanwhile.
        match (ranked, verdict) {
            (false, Verdict::Accepted) => format!("a dart lands at {at} in the open"),
            (true, Verdict::Accepted) => {
                format!("the dart at {at} is still uncovered when its turn comes")
            }

            (false, Verdict::Covered { by: id }) => {
                format!(
                    "a dart lands at {at}, which is covered{}, and is discarded",
                    by(id)
                )
            }
            (true, Verdict::Covered { by: id }) => {
                format!(
                    "the dart at {at} is covered by now{} and is discarded",
                    by(id)
                )
            }

            (_, Verdict::Outside) => {
                format!("a dart at {at} lands outside the domain and is discarded")
            }
            // Where the radius is the same everywhere no dart is thinned; `local` has the sentence of others.
            (_, Verdict::Thinned) => format!("a dart at {at} is left out"),
            // Only candidates have a reach, so that no dart gets these verdicts.
            (_, Verdict::TooFar | Verdict::NotNearest { .. }) => {
                format!("a dart at {at} is out of reach and is discarded")
            }
        }
    }
}

pub(super) fn cut(cell: Point, side: i32, kept: u32) -> String {
    let at = coordinates(cell);
    let side = fraction(side);
    let kept = match kept {
        0 => "no quarter is left open".to_owned(),
        1 => "one quarter may be open".to_owned(),
        more => format!("{more} quarters may be open"),
    };
    format!("the active cell at {at}, {side} wide, is cut in four: {kept}")
}
