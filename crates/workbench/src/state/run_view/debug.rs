//! The debugger of a run: breakpoints, watches, scenes, queries, and the selection with its history.

use std::sync::Arc;

use glam::DVec2;

use serde::{Deserialize, Serialize};
use tilescope_core::{Point, R};
use tilescope_debugger::{DEFAULT_BUDGET, Debugger, LineId, OutlineRows, Query, Stops, why};
use tilescope_session::selection::Selection;

use super::RunView;
use crate::command::DebugCommand;

use crate::state::effects::Context;
use tilescope_session::jobs::{Job, Monitor};
use tilescope_session::session::Session;
use tilescope_session::task::{self, SessionRef, Task};

/// The most events that a query finds. Chosen, not measured.
pub const MAX_FOUND: usize = 100_000;

/// Events found by a search in the background.
#[derive(Default)]
pub enum FoundEvents {
    /// Nothing was searched for.
    #[default]
    Nothing,
    /// The search is running.
    Pending(Job<Vec<usize>>),
    /// The events, in order.
    Events(Vec<usize>),
    /// They could not be found, and why.
    Failed(String),
}

impl FoundEvents {
    /// Returns the events, once they are known.
    #[must_use]
    pub fn events(&self) -> &[usize] {
        match self {
            Self::Events(events) => events,
            _ => &[],
        }
    }

    /// Takes the events when the search has ended.
    pub(in crate::state) fn poll(&mut self) {
        if let Self::Pending(job) = self
            && let Some(outcome) = job.poll()
        {
            *self = outcome.map_or_else(Self::Failed, Self::Events);
        }
    }

    /// Returns why the search failed, if it did.
    #[must_use]
    pub fn failure(&self) -> Option<&str> {
        match self {
            Self::Failed(why) => Some(why),
            _ => None,
        }
    }

    #[cfg(not(target_arch = "wasm32"))]
    pub(in crate::state) fn settle(&mut self) {
        if let Self::Pending(job) = self {
            *self = job.wait().map_or_else(Self::Failed, Self::Events);
        }
    }
}

/// The query of the event browser.
#[derive(Default)]
pub struct EventQuery {
    /// The query, as it is typed.
    pub text: String,
    /// Its error, if it has one.
    pub error: Option<String>,
    /// The events found; none while the text is empty.
    pub found: FoundEvents,
}

impl RunView {
    /// Applies a command to the debugger, and updates what depends on the moment, since some commands move to another
    /// one.
    pub(in crate::state) fn apply_to_debugger(&mut self, command: DebugCommand, context: &Context) {
        let stage_before = self.stage;
        match command {
            DebugCommand::Query(text) => self.look_for(text, context),
            DebugCommand::SelectEvent(event) => self.select_event(event),
            DebugCommand::ToggleEvent(event) => {
                let outline = self.session.as_ref().and_then(|s| s.outline.as_ref());
                if let (Some(outline), Some(rows)) = (outline, &mut self.rows) {
                    rows.toggle(outline, event);
                }
            }
            // The other commands concern the debugger alone: breakpoints, watches, and the jump to a cause.
            command => {
                if let Some(debugger) = &mut self.debugger {
                    change(debugger, command);
                }
            }
        }

        self.follow_cursor();
        self.moved(stage_before);
    }

    /// Returns breakpoints, watches and scenes.
    pub(in crate::state) fn stops(&self) -> Stops {
        match &self.debugger {
            Some(debugger) => debugger.stops(),
            None => self.stops.clone(),
        }
    }

    /// Takes breakpoints, watches and scenes out of the run.
    pub(in crate::state) fn take_stops(&mut self) -> Stops {
        match &mut self.debugger {
            Some(debugger) => debugger.take_stops(),
            None => std::mem::take(&mut self.stops),
        }
    }

    /// Puts breakpoints, watches and scenes into the run; without events, they are kept for a later run.
    pub(in crate::state) fn put_stops(&mut self, stops: Stops, context: &mut Context) {
        match &mut self.debugger {
            Some(debugger) => {
                if let Err(error) = debugger.put_stops(stops) {
                    context.tell_error(tilescope_session::words::sentence(&error.to_string()));
                }
            }
            None => self.stops = stops,
        }
    }

    /// Sets the debugger of a new session; breakpoints, watches and scenes stay.
    pub(in crate::state) fn debug(&mut self, session: &Session, context: &mut Context) {
        let stops = self.take_stops();
        let debugger = |recording| Debugger::new(Arc::clone(recording), DEFAULT_BUDGET);
        self.debugger = session.recording().map(debugger);
        self.put_stops(stops, context);
        self.rows = session.outline.as_ref().map(OutlineRows::new);
        // No cursor is so large, so that the tree is expanded to the event when it is first shown.
        (self.revealed, self.passes) = (usize::MAX, None);
        self.history_found = FoundEvents::Nothing;
        // The query stays as typed, and is searched for in the new events.
        let text = std::mem::take(&mut self.query.text);
        self.look_for(text, context);
    }

    /// Goes to the moment after an event and all events inside it, without expanding the tree.
    fn select_event(&mut self, event: usize) {
        let outline = self.session.as_ref().and_then(|s| s.outline.as_ref());
        if let Some(outline) = outline {
            let end = outline.end(event);
            self.jump(end);
            self.revealed = end;
        }
    }

    /// Expands the tree of events down to the event before the cursor, if the cursor was moved outside the tree. Called
    /// by a window that shows the tree.
    pub(in crate::state) fn reveal(&mut self) {
        let Some((cursor, _)) = self.cursor().filter(|(cursor, _)| *cursor != self.revealed) else {
            return;
        };
        self.revealed = cursor;
        let outline = self.session.as_ref().and_then(|s| s.outline.as_ref());
        if let (Some(outline), Some(rows), Some(last)) =
            (outline, &mut self.rows, cursor.checked_sub(1))
        {
            rows.expand_to(outline, last);
        }
    }

    fn look(&self, aim: Aim, context: &Context) -> FoundEvents {
        match &self.session {
            Some(session) if self.debugger.is_some() => {
                let session = SessionRef(Arc::clone(session));
                FoundEvents::Pending(task::start(&context.wake, FindEventsTask { session, aim }))
            }
            _ => FoundEvents::Nothing,
        }
    }

    fn look_for(&mut self, text: String, context: &Context) {
        let parsed = Query::parse(&text);
        self.query.error = parsed.as_ref().err().map(ToString::to_string);
        self.query.found = match parsed {
            Ok(query) if query != Query::default() => self.look(Aim::Query(text.clone()), context),
            _ => FoundEvents::Nothing,
        };
        self.query.text = text;
    }

    /// Returns whether the current session has the sample or place.
    pub(crate) fn can_select(&self, selection: Selection) -> bool {
        let Some(session) = &self.session else {
            return false;
        };
        let size = session.size_radii();
        match selection {
            Selection::Nothing => true,
            Selection::Sample(id) => (id as usize) < session.run().samples.len(),
            Selection::Place(place) => (place.cmpge(DVec2::ZERO) & place.cmplt(size)).all(),
        }
    }

    /// Selects a sample, a place or nothing, and starts looking up its history. Does nothing if the session does not
    /// have the sample or the place.
    pub(in crate::state) fn pick(&mut self, selection: Selection, context: &Context) {
        if !self.can_select(selection) {
            return;
        }

        (self.selected, self.place) = match selection {
            Selection::Nothing => (None, None),
            Selection::Sample(id) => (Some(id), None),
            Selection::Place(place) => (None, Some(place)),
        };

        self.history_found = match selection {
            Selection::Nothing => FoundEvents::Nothing,
            Selection::Sample(id) => self.look(Aim::Sample(id), context),
            Selection::Place(place) => {
                // Recordings have places on the lattice.
                let units = (place * f64::from(R)).round().as_ivec2();
                self.look(Aim::Place(Point::new(units.x, units.y)), context)
            }
        };
    }
}

/// The target of a search for events.
#[derive(Serialize, Deserialize)]
enum Aim {
    /// Events that a query matches.
    Query(String),
    /// Events that touched a sample.
    Sample(u32),
    /// Events that concern a place.
    Place(Point),
}

/// The task of searching the events of a session.
#[derive(Serialize, Deserialize)]
pub struct FindEventsTask {
    session: SessionRef,
    aim: Aim,
}

impl Task for FindEventsTask {
    type Outcome = Vec<usize>;
    const NAME: &'static str = "look";

    fn run(self, _: &Monitor) -> Self::Outcome {
        let Some(recording) = self.session.recording() else {
            return Vec::new();
        };
        match self.aim {
            Aim::Query(text) => Query::parse(&text)
                .map_or_else(|_| Vec::new(), |query| query.find_all(recording, MAX_FOUND)),
            Aim::Sample(id) => why::history_of_sample(recording, id),
            Aim::Place(point) => why::history_of_point(recording, point),
        }
    }
}

/// Applies a command that concerns the debugger alone. If no breakpoint or watch has the command's index, nothing
/// changes.
fn change(debugger: &mut Debugger, command: DebugCommand) {
    match command {
        DebugCommand::ToggleBreakpoint(line) => toggle(debugger, line),
        DebugCommand::Condition(index, text) => replace_condition(debugger, index, &text),
        DebugCommand::Enable(index, enabled) => debugger.enable_breakpoint(index, enabled),
        DebugCommand::RemoveBreakpoint(index) => debugger.remove_breakpoint(index),
        DebugCommand::Watch(text) => debugger.watches.push(text),
        DebugCommand::EditWatch(index, text) => {
            if let Some(watch) = debugger.watches.get_mut(index) {
                *watch = text;
            }
        }
        DebugCommand::RemoveWatch(index) => {
            if index < debugger.watches.len() {
                debugger.watches.remove(index);
            }
        }

        DebugCommand::Why => {
            let Some(last) = debugger.state().cursor().checked_sub(1) else {
                return;
            };
            if let Some(cause) = why::cause(debugger.recording(), last) {
                // The cursor goes behind the cause, because the moment after it shows its effect.
                debugger.jump(cause + 1);
            }
        }

        // These need the rest of the run as well, so that `apply_to_debugger` carries them out.
        DebugCommand::Query(_) | DebugCommand::SelectEvent(_) | DebugCommand::ToggleEvent(_) => {}
    }
}

fn toggle(debugger: &mut Debugger, line: LineId) {
    match debugger.breakpoints().iter().position(|b| b.line == line) {
        Some(index) => debugger.remove_breakpoint(index),
        None => debugger.add_breakpoint(line, ""),
    }
}

/// Replaces the condition of the breakpoint of an index; the order of the breakpoints stays.
fn replace_condition(debugger: &mut Debugger, index: usize, text: &str) {
    // A new breakpoint comes behind all others. To keep their order, this one and all behind it are removed and added again.
    let tail: Vec<_> = debugger.breakpoints().iter().skip(index).cloned().collect();

    for _ in &tail {
        debugger.remove_breakpoint(index);
    }

    for (offset, breakpoint) in tail.iter().enumerate() {
        // The first of them is the breakpoint whose condition changes.
        let condition = if offset == 0 {
            text
        } else {
            &breakpoint.condition
        };
        debugger.add_breakpoint(breakpoint.line, condition);
        debugger.enable_breakpoint(index + offset, breakpoint.enabled);
    }
}
