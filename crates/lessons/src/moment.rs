//! The names of moments in lessons: `start`, `end`, `end of tile`, `before QUERY`, `after QUERY`, `ranks below 0.25`, or the anchor of an event
//! such as `eliminate.eliminate.1`; and the cursors that they stand for in a recording.

use tilescope_core::Stage;
use tilescope_debugger::{Anchor, Query, Recording, stage_named};

use crate::error::{LessonError, shortened};

/// A moment of a run.
#[derive(Clone, Debug, PartialEq)]
pub enum Moment {
    /// Before the first event.
    Start,
    /// After the last event.
    End,
    /// The end of a stage.
    EndOf(Stage),
    /// Just before an event that matches a query.
    Before(Query),
    /// Just after an event that matches a query.
    After(Query),
    /// Just after the event of an anchor.
    At(Anchor),
    /// Of nested levels, the samples with ranks below a number.
    Below(f64),
}

const STAGES: [&str; 6] = [
    "blocks",
    "tile",
    "eliminate",
    "iterate-1",
    "iterate-2",
    "finish",
];

/// The most events that are tried as the moment of a step.
const MAX_TRIED: usize = 2_000;

impl Moment {
    /// Reads a moment by its name; `line` is for the fault.
    pub(crate) fn read(text: &str, line: usize) -> Result<Self, LessonError> {
        let query = |text: &str| {
            Query::parse(text).map_err(|error| LessonError::new(line, error.to_string()))
        };

        Ok(match text {
            "start" => Self::Start,
            "end" => Self::End,
            _ => match text.split_once(' ') {
                Some(("before", rest)) => Self::Before(query(rest)?),
                Some(("after", rest)) => Self::After(query(rest)?),
                Some(("ranks", rest)) => Self::Below(rank(rest, line)?),
                // "of" may be left out.
                Some(("end", rest)) => Self::EndOf(stage(rest.trim_start_matches("of ").trim(), line)?),
                _ => Self::At(text.parse().map_err(|_| {
                    let text = shortened(text);
                    LessonError::new(line, format!(
                        "\"{text}\" is not a moment. Moments are: start, end, end of STAGE, before QUERY, after QUERY, \
                         ranks below NUMBER, and anchors such as eliminate.eliminate.1"
                    ))
                })?),
            },
        })
    }

    /// Returns the cursors of this moment in a run, in the order in which they are tried.
    pub(crate) fn cursors(&self, recording: &Recording) -> Vec<usize> {
        let found = |query: &Query| query.find_all(recording, MAX_TRIED);
        match self {
            // In a field of radii it is after the first event, with which the first throw begins. A step with a question shows
            // the run only up to its moment, and before that event there would be no stage to show.
            Self::Start => vec![usize::from(recording.run().locality.is_some())],
            Self::End => vec![recording.len()],
            Self::EndOf(stage) => recording.end_of(*stage).into_iter().collect(),
            Self::Before(query) => found(query),
            Self::After(query) => found(query).into_iter().map(|event| event + 1).collect(),
            // Only nested levels have ranks. A run without levels does not have this moment.
            Self::Below(rank) => {
                let levels = recording.levels().into_iter();
                levels.map(|levels| levels.below(*rank)).collect()
            }
            Self::At(anchor) => {
                let event = recording.anchored(anchor).into_iter();
                event.map(|event| event + 1).collect()
            }
        }
    }
}

/// Reads the rest of `ranks below 0.25`.
fn rank(text: &str, line: usize) -> Result<f64, LessonError> {
    // Some authors write a decimal comma.
    let number = text.strip_prefix("below ");
    let number = number.and_then(|number| number.trim().replace(',', ".").parse().ok());
    // Ranks lie in [0, 1), so that all are below 1 and none is below 0.
    number.filter(|rank| *rank > 0.0 && *rank <= 1.0).ok_or_else(|| {
        let text = shortened(text);
        let message = format!("\"ranks {text}\" is not of the form \"ranks below 0.25\", with a number above 0 and up to 1");
        LessonError::new(line, message)
    })
}

fn stage(name: &str, line: usize) -> Result<Stage, LessonError> {
    // No event is before the end of the pattern.
    let found = stage_named(name).filter(|stage| *stage != Stage::Pattern);
    found.ok_or_else(|| LessonError::unknown(line, "stage", name, &STAGES))
}
