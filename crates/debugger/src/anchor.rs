//! Anchors: references to events that can be found again in other runs, by stage, kind and ordinal within the stage.

use std::fmt;
use std::ops::Range;
use std::str::FromStr;

use serde::{Deserialize, Serialize};
use tilescope_core::{RunEvent, Stage};

use crate::kind::EventKind;
use crate::recording::Recording;

/// A reference to an event by its kind and ordinal in its stage. Written as `eliminate.test.12` or
/// `iterate-2.insert.1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Anchor {
    /// The stage or iteration that has the event.
    pub stage: Stage,
    /// The kind of the event.
    pub kind: EventKind,
    /// Which one of this kind it is in the stage, from 1.
    pub ordinal: usize,
}

/// A text that is not an anchor.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("\"{0}\" is not an anchor such as eliminate.test.12")]
pub struct AnchorError(String);

impl fmt::Display for Anchor {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let stage = self.stage.to_string().replace(' ', "-");
        write!(f, "{stage}.{}.{}", self.kind.name(), self.ordinal)
    }
}

impl From<Anchor> for String {
    fn from(anchor: Anchor) -> Self {
        anchor.to_string()
    }
}

impl TryFrom<String> for Anchor {
    type Error = AnchorError;

    fn try_from(text: String) -> Result<Self, AnchorError> {
        text.parse()
    }
}

impl FromStr for Anchor {
    type Err = AnchorError;

    fn from_str(text: &str) -> Result<Self, AnchorError> {
        let read = || {
            let mut parts = text.split('.');
            // Ordinals count from 1, so that a 0 is a mistake.
            let anchor = Self {
                stage: stage_named(parts.next()?)?,
                kind: EventKind::named(parts.next()?)?,
                ordinal: parts.next()?.parse().ok().filter(|&ordinal| ordinal > 0)?,
            };
            // A name has three parts; a fourth makes it another name.
            parts.next().is_none().then_some(anchor)
        };
        read().ok_or_else(|| AnchorError(text.to_owned()))
    }
}

/// Returns the stage of a name as anchors have it, such as `tile` or `iterate-2`.
#[must_use]
pub fn stage_named(name: &str) -> Option<Stage> {
    let others = [
        Stage::Pattern,
        Stage::Blocks,
        Stage::Tile,
        Stage::Eliminate,
        Stage::Finish,
    ];
    // Regions are missing: they are a stage of the parallel engine, whose runs have no events.
    match name.strip_prefix("iterate-") {
        Some(number) => number.parse().ok().map(Stage::Iterate),
        None => others.into_iter().find(|stage| stage.to_string() == name),
    }
}

impl Recording {
    /// Returns the stages in order, each with its events.
    fn stages(&self) -> Vec<(Stage, Range<usize>)> {
        let mut stages: Vec<(Stage, Range<usize>)> = Vec::new();
        for &begin in &self.begins {
            let begin = begin as usize;

            let stage = match self.event(begin).and_then(crate::Event::run_event) {
                Some(RunEvent::Begin(stage)) => stage,
                Some(RunEvent::Iteration { number, .. }) => Stage::Iterate(number),
                // The list has events of these two kinds alone.
                _ => continue,
            };

            if let Some((last, events)) = stages.last_mut() {
                // Two beginnings of one stage in a row, as no engine of today records them, count as one.
                if *last == stage {
                    continue;
                }
                events.end = begin;
            }

            // The last stage ends with the recording, the others where the next one begins.
            stages.push((stage, begin..self.len()));
        }
        stages
    }

    /// Returns the cursor at the end of a stage, if the run has that stage.
    #[must_use]
    pub fn end_of(&self, stage: Stage) -> Option<usize> {
        let stages = self.stages();
        let (_, events) = stages.iter().find(|(other, _)| *other == stage)?;
        Some(events.end)
    }

    /// Returns the stage that ends at a cursor, if one does.
    #[must_use]
    pub fn stage_ending_at(&self, cursor: usize) -> Option<Stage> {
        let stages = self.stages();
        let ending = stages.iter().find(|(_, events)| events.end == cursor);
        ending.map(|(stage, _)| *stage)
    }

    /// Returns the anchor of an event.
    #[must_use]
    pub fn anchor(&self, event: usize) -> Option<Anchor> {
        let kind = self.event(event)?.kind();
        let stages = self.stages();
        let (stage, events) = stages.iter().find(|(_, events)| events.contains(&event))?;
        let before = |end| self.classes().count(end, |other| other.kind() == kind);
        Some(Anchor {
            stage: *stage,
            kind,
            ordinal: before(event + 1) - before(events.start),
        })
    }

    /// Returns the index of an anchor's event, if this run has it.
    #[must_use]
    pub fn anchored(&self, anchor: &Anchor) -> Option<usize> {
        let stages = self.stages();
        let (_, events) = stages.iter().find(|(stage, _)| *stage == anchor.stage)?;

        let before = |end| {
            self.classes()
                .count(end, |other| other.kind() == anchor.kind)
        };
        // How many events of this kind the run has up to the wanted event, which is counted, too. An ordinal is read
        // from a text and may be too large to be added.
        let wanted_count = before(events.start).checked_add(anchor.ordinal)?;
        if wanted_count > before(events.end) {
            return None;
        }

        // `before` never falls, so that a binary search finds the lowest end with the wanted number of events before
        // it. The wanted event is the last one before this end.
        let (mut low, mut high) = (events.start, events.end);
        while low + 1 < high {
            let middle = usize::midpoint(low, high);
            if before(middle) < wanted_count {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some(high - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn anchors_are_read_as_they_are_written() {
        for (text, stage, kind, ordinal) in [
            ("blocks.split.1", Stage::Blocks, EventKind::Split, 1),
            (
                "iterate-12.no-gap.340",
                Stage::Iterate(12),
                EventKind::NoGap,
                340,
            ),
            ("finish.finish.1", Stage::Finish, EventKind::Finish, 1),
        ] {
            let anchor = Anchor {
                stage,
                kind,
                ordinal,
            };
            assert_eq!(anchor.to_string(), text);
            assert_eq!(text.parse(), Ok(anchor));
        }
        for text in [
            "",
            "tile",
            "tile.test",
            "tile.test.0",
            "tile.test.-1",
            "tile.test.1.2",
            "shore.test.1",
            "tile.shell.1",
        ] {
            assert!(text.parse::<Anchor>().is_err(), "{text}");
        }
    }
}
