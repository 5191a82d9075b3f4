//! The events at which the breakpoints would stop, for the timeline: computed in the background when the
//! breakpoints change.

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use tilescope_debugger::{DEFAULT_BUDGET, Debugger, Direction, LineId, Recording, Stop};
use tilescope_session::jobs::Monitor;
use tilescope_session::task::{self, SessionRef, Task};
use tilescope_session::words::counted;

use super::{FoundEvents, RunView};
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
    found: FoundEvents,
}

impl Hits {
    /// Returns the number of stops in words, that it is being counted, or why it could not be. `None` without
    /// enabled breakpoints.
    #[must_use]
    pub fn description(&self) -> Option<String> {
        match &self.found {
            FoundEvents::Nothing => None,
            FoundEvents::Pending(_) => Some("Being counted\u{2026}".to_owned()),
            FoundEvents::Failed(why) => Some(why.clone()),
            // Where conditions fail too often, counting ends early, and the number is that of the stops up to there.
            FoundEvents::Events(events) => {
                let times = counted(events.len(), "time", "times");
                Some(match events.len() {
                    MAX_HITS => {
                        format!("They stop a run {times} or more; the first are on the timeline.")
                    }
                    _ => format!("They stop a run {times}."),
                })
            }
        }
    }

    /// Returns the first [`MAX_HITS`] events before which a run would stop.
    #[must_use]
    pub fn events(&self) -> &[usize] {
        self.found.events()
    }

    #[cfg(not(target_arch = "wasm32"))]
    pub(in crate::state) fn settle(&mut self) {
        self.found.settle();
    }
}

impl RunView {
    /// Takes the events that were found, and starts to look for them again if the enabled breakpoints or the session have
    /// changed.
    pub(in crate::state) fn want_hits(&mut self, context: &Context) {
        self.hits.found.poll();
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
        self.hits.found = if breakpoints.is_empty() {
            FoundEvents::Nothing
        } else {
            let session = SessionRef(Arc::clone(session));
            FoundEvents::Pending(task::start(
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
    type Outcome = Vec<usize>;
    const NAME: &'static str = "hits";

    fn run(self, monitor: &Monitor) -> Self::Outcome {
        let recording = self.session.recording();
        recording.map_or_else(Vec::new, |recording| {
            hits(recording, &self.breakpoints, monitor)
        })
    }
}

/// Returns the moments at which breakpoints stop the run, as far as the limits allow.
fn hits(
    recording: &Arc<Recording>,
    breakpoints: &[(LineId, String)],
    monitor: &Monitor,
) -> Vec<usize> {
    // A new debugger stands at the start of the run, from which all hits are counted.
    let mut debugger = Debugger::new(Arc::clone(recording), DEFAULT_BUDGET);
    for (line, condition) in breakpoints {
        debugger.add_breakpoint(*line, condition);
    }

    let go_on = || !monitor.is_cancelled();

    let (mut found, mut unclear) = (Vec::new(), 0);
    while found.len() < MAX_HITS && unclear < MAX_UNCLEAR && go_on() {
        match debugger.run_while(Direction::Forwards, &go_on) {
            // `run_while` has no target, so that it never stops at one.
            Stop::Breakpoint(_) | Stop::Target => found.push(debugger.state().cursor()),
            // A condition that cannot be evaluated stops a run, but is not counted as a hit.
            Stop::BadCondition(..) => unclear += 1,
            Stop::End => break,
        }
    }
    found
}
