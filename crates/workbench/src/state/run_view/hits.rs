//! The events at which the breakpoints would stop, for the timeline: computed in the background when the
//! breakpoints change.

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use tilescope_debugger::{DEFAULT_BUDGET, Debugger, Direction, LineId, Recording, Stop};
use tilescope_session::jobs::{Job, Monitor};
use tilescope_session::task::{self, SessionRef, Task};
use tilescope_session::words::counted;

use super::RunView;
use crate::state::effects::Context;

/// The most events that are marked. Chosen, not measured.
pub const MAX_HITS: usize = 20_000;

/// The number of evaluation errors after which counting stops. Chosen, not measured.
const MAX_UNCLEAR: usize = 1_000;

/// A session's generation, and the enabled breakpoints with their conditions.
type Key = (u64, Vec<(LineId, String)>);

/// The events at which the breakpoints would stop, if known.
#[derive(Default)]
pub struct Hits {
    key: Option<Key>,
    counting: Counting,
}

/// The count in the background.
#[derive(Default)]
enum Counting {
    /// No breakpoint is enabled.
    #[default]
    Nothing,
    Running(Job<FoundHits>),
    /// The events, or why they could not be found.
    Ended(Result<FoundHits, String>),
}

/// Events before which a run would stop.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
pub struct FoundHits {
    /// The events, in order.
    events: Vec<usize>,
    /// Whether there are no others: counting ends early at [`MAX_HITS`], and where conditions fail too often.
    are_all: bool,
}

impl Hits {
    /// Returns in words how often the breakpoints stop a run, that this is being counted, or why it could not be counted.
    /// `None` without enabled breakpoints.
    #[must_use]
    pub fn description(&self) -> Option<String> {
        match &self.counting {
            Counting::Nothing => None,
            Counting::Running(_) => Some("Being counted\u{2026}".to_owned()),
            Counting::Ended(Err(why)) => Some(why.clone()),
            Counting::Ended(Ok(found)) => {
                let times = counted(found.events.len(), "time", "times");
                Some(if found.are_all {
                    format!("They stop a run {times}.")
                } else if found.events.is_empty() {
                    // Only conditions that fail end a count before its first stop.
                    let failed = counted(MAX_UNCLEAR, "time", "times");
                    format!(
                        "Conditions could not be evaluated {failed}: counting ended there, before any stop."
                    )
                } else {
                    format!("They stop a run {times} or more; the first are on the timeline.")
                })
            }
        }
    }

    /// Returns the first [`MAX_HITS`] events before which a run would stop.
    #[must_use]
    pub fn events(&self) -> &[usize] {
        match &self.counting {
            Counting::Ended(Ok(found)) => &found.events,
            Counting::Nothing | Counting::Running(_) | Counting::Ended(Err(_)) => &[],
        }
    }

    /// Takes the events when the count has ended.
    fn poll(&mut self) {
        if let Counting::Running(job) = &self.counting
            && let Some(outcome) = job.poll()
        {
            self.counting = Counting::Ended(outcome);
        }
    }

    #[cfg(not(target_arch = "wasm32"))]
    pub(in crate::state) fn settle(&mut self) {
        if let Counting::Running(job) = &self.counting {
            self.counting = Counting::Ended(job.wait());
        }
    }
}

impl RunView {
    /// Takes the events that were found, and starts to look for them again if the enabled breakpoints or the session have
    /// changed.
    pub(in crate::state) fn want_hits(&mut self, context: &Context) {
        self.hits.poll();
        let (Some(session), Some(debugger)) = (&self.session, &self.debugger) else {
            self.hits = Hits::default();
            return;
        };

        let enabled = debugger.breakpoints().iter().filter(|b| b.enabled);
        let breakpoints = enabled.map(|b| (b.line, b.condition.as_str()));
        // The comparison with the breakpoints that were looked for last makes no copies, because it is made in every
        // frame.
        let same = self.hits.key.as_ref().is_some_and(|(generation, known)| {
            let all_known = known.iter().map(|(line, text)| (*line, text.as_str()));
            *generation == session.generation && all_known.eq(breakpoints.clone())
        });

        if same {
            return;
        }

        let breakpoints: Vec<(LineId, String)> = breakpoints
            .map(|(line, text)| (line, text.to_owned()))
            .collect();
        self.hits.key = Some((session.generation, breakpoints.clone()));
        self.hits.counting = if breakpoints.is_empty() {
            Counting::Nothing
        } else {
            let session = SessionRef(Arc::clone(session));
            Counting::Running(task::start(
                &context.wake,
                CountHitsTask {
                    session,
                    breakpoints,
                },
            ))
        };
    }
}

/// The task of finding the events at which breakpoints stop, in a session's events.
#[derive(Serialize, Deserialize)]
pub struct CountHitsTask {
    session: SessionRef,
    /// The lines of the enabled breakpoints, and their conditions.
    breakpoints: Vec<(LineId, String)>,
}

impl Task for CountHitsTask {
    type Outcome = FoundHits;
    const NAME: &'static str = "hits";

    fn run(self, monitor: &Monitor) -> Self::Outcome {
        match self.session.recording() {
            Some(recording) => hits(recording, &self.breakpoints, monitor),
            // A run without events has none at which it could stop.
            None => FoundHits {
                events: Vec::new(),
                are_all: true,
            },
        }
    }
}

/// Returns the moments at which breakpoints stop the run, as far as the limits allow.
fn hits(
    recording: &Arc<Recording>,
    breakpoints: &[(LineId, String)],
    monitor: &Monitor,
) -> FoundHits {
    // A new debugger stands at the start of the run, from which all hits are counted.
    let mut debugger = Debugger::new(Arc::clone(recording), DEFAULT_BUDGET);
    for (line, condition) in breakpoints {
        debugger.add_breakpoint(*line, condition);
    }

    let go_on = || !monitor.is_cancelled();

    let (mut events, mut unclear, mut are_all) = (Vec::new(), 0, false);
    while events.len() < MAX_HITS && unclear < MAX_UNCLEAR && go_on() {
        match debugger.run_while(Direction::Forwards, &go_on) {
            // `run_while` has no target, so that it never stops at one.
            Stop::Breakpoint(_) | Stop::Target => events.push(debugger.state().cursor()),
            // A condition that cannot be evaluated stops a run, but is not counted as a hit.
            Stop::BadCondition(..) => unclear += 1,
            Stop::End => {
                are_all = true;
                break;
            }
        }
    }
    FoundHits { events, are_all }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;
    use tilescope_core::Parameters;
    use tilescope_debugger::Event;
    use tilescope_session::session::Session;

    /// A count that conditions end early is no count of all stops.
    #[test]
    fn a_count_that_ended_early_says_so() {
        let parameters = Parameters {
            radius: 0.02,
            ..Parameters::default()
        };
        let wake: tilescope_session::jobs::Wake = Arc::new(|| {});
        let job = Job::start(&wake, move |monitor| {
            let session = Session::sample(&parameters.into(), 1, monitor).unwrap();
            let recording = session.recording().unwrap();
            let mut counts = BTreeMap::new();
            for line in (0..recording.len()).filter_map(|at| recording.event(at).map(Event::line)) {
                *counts.entry(line).or_insert(0) += 1;
            }
            let is_between = |count: usize| (MAX_UNCLEAR + 1..MAX_HITS).contains(&count);
            let line = *counts
                .iter()
                .find(|(_, count)| is_between(**count))
                .unwrap()
                .0;

            // `p` is a place, and no condition.
            let conditions = ["", "p", "false"];
            conditions.map(|condition| hits(recording, &[(line, condition.to_owned())], monitor))
        });

        let described = job.wait().unwrap().map(|found| {
            let hits = Hits {
                key: None,
                counting: Counting::Ended(Ok(found)),
            };
            hits.description().unwrap()
        });
        let has_ended_early = described
            .each_ref()
            .map(|text| text.contains("counting ended"));
        assert_eq!(has_ended_early, [false, true, false], "{described:?}");
    }
}
