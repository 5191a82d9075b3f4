//! Why a sample of an exact tiling is there, or is not, in one line: when it arrived, where it is from, and who came first.

use tilescope_core::{Arrival, Fate, Origin, RunEvent, Verdict};

use super::{Words, count, grouped};
use crate::event::{Event, NONE};
use crate::recording::Recording;

/// Returns an arrival as `level 0, throw 3`. Throws are counted from 1, and only level 0 has several.
#[must_use]
pub fn arrival_text(arrival: Arrival) -> String {
    match arrival.level() {
        0 => format!("level 0, throw {}", arrival.throw() + 1),
        level => format!("level {level}"),
    }
}

/// Returns why a sample of an exact tiling is in the set, or was lost, in one line: its arrival, its block, and what it refused
/// or what it was refused by. `None` for other runs, and for a sample that there is not.
#[must_use]
pub fn why_here(recording: &Recording, sample: u32) -> Option<String> {
    if !recording.is_exact() {
        return None;
    }
    let words = Words(recording);
    let run = recording.run();

    let from = match run.samples.origins.get(sample as usize)? {
        Origin::Tiled { block, .. } => format!("tiled from block {}", grouped((*block).into())),
        Origin::Inserted { .. } => words.outlived(sample),
    };
    // Of two samples that are near each other the later one is lost.
    let came_to = match run.samples.fates[sample as usize] {
        Fate::Eliminated { by } => {
            format!(
                "lost, since {} came first, {} away",
                words.timed(by),
                words.apart(by, sample)
            )
        }
        Fate::Kept | Fate::Undecided | Fate::Dropped => words.refused_by(sample),
    };
    Some(format!("{}: {from}; {came_to}", words.timed(sample)))
}

impl Words<'_> {
    /// Returns `sample 412 (level 0, throw 3)`.
    fn timed(&self, sample: u32) -> String {
        let number = grouped(sample.into());
        match self.0.run().arrival_of(sample) {
            Some(arrival) => format!("sample {number} ({})", arrival_text(arrival)),
            None => format!("sample {number}"),
        }
    }

    /// Returns how the dart of a sample that the pattern lacks came to be one.
    fn outlived(&self, sample: u32) -> String {
        let recording = self.0;
        let announced = || {
            let (at, life) = (recording.point(sample)?, recording.life(sample)?);
            let event = recording.expected(at, life.born as usize)?;
            recording.event(event as usize)?.run_event()
        };

        // The darts of levels 0 and 1 are woken when the sample is missing that refused them first. Later darts are thrown at
        // places that such a loss has laid bare.
        match announced() {
            Some(RunEvent::Wake { behind: NONE, .. }) => {
                "woken, as its first blocker lies beyond its block".to_owned()
            }
            Some(RunEvent::Wake { behind, .. }) => {
                format!(
                    "woken, as its first blocker, {}, is lost",
                    self.timed(behind)
                )
            }
            _ => "thrown where a loss had left a place bare".to_owned(),
        }
    }

    /// Returns which samples and how many darts a sample refused. Of more than two samples the number is named.
    fn refused_by(&self, sample: u32) -> String {
        let (mut lost, mut darts) = (Vec::new(), 0);
        for &event in self.0.events_of(sample) {
            // Of its own events and those of others only the ones count in which it is the blocker.
            let run_event = self.0.event(event as usize).and_then(Event::run_event);
            match run_event {
                Some(RunEvent::Eliminate { sample: other, by }) if by == sample => {
                    lost.push(grouped(other.into()));
                }
                Some(RunEvent::Dart {
                    verdict: Verdict::Covered { by },
                    ..
                }) if by == sample => darts += 1,
                _ => {}
            }
        }

        // One or two fit a line, and can be looked at next.
        let samples = match lost.as_slice() {
            [] => None,
            [one] => Some(format!("sample {one}")),
            [one, other] => Some(format!("samples {one}, {other}")),
            more => Some(count(more.len() as u64, "sample")),
        };
        let darts = (darts > 0).then(|| count(darts, "dart"));
        match (samples, darts) {
            (None, None) => "stays".to_owned(),
            (Some(one), None) | (None, Some(one)) => format!("refused {one}"),
            (Some(samples), Some(darts)) => format!("refused {samples} and {darts}"),
        }
    }
}
