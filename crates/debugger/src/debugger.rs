//! A debugging session: one cursor over a recording, with breakpoints, watches and scenes. A user interface reads
//! its state and calls its moves.

use std::mem::take;
use std::sync::{Arc, OnceLock};

use crate::event::Event;
use crate::expression::{Evaluator, Expression, ExpressionError};
use crate::listing::{LineId, Listings};
use crate::moves::{self, Direction, Step, Target};
use crate::recording::Recording;
use crate::session::{
    PatternFile, SavedBreakpoint, SavedScene, Session, SessionError, VERSION, VERSION_OF_EXACT,
    VERSION_OF_GROUND, VERSION_OF_KDRT, VERSION_OF_SPACE,
};
use crate::state::State;

/// A line of pseudocode where runs stop, with a condition for it.
#[derive(Clone, Debug)]
pub struct Breakpoint {
    /// The line, among the shipped listings.
    pub line: LineId,
    /// The text of the condition; empty for none.
    pub condition: String,
    /// Whether it stops a run.
    pub enabled: bool,
    parsed: Option<Result<Expression, ExpressionError>>,
}

impl Breakpoint {
    /// Returns the error in the condition's text, if there is one.
    #[must_use]
    pub const fn error(&self) -> Option<&ExpressionError> {
        match &self.parsed {
            Some(Err(error)) => Some(error),
            _ => None,
        }
    }
}

/// Why a move of the cursor ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Stop {
    /// It reached its target.
    Target,
    /// It reached the breakpoint of this index.
    Breakpoint(usize),
    /// The condition of the breakpoint of this index could not be evaluated.
    BadCondition(usize, ExpressionError),
    /// There was nothing to reach, or the caller stopped the run. After a run to a breakpoint that there is not, the cursor is
    /// at the end or the start.
    End,
}

/// The breakpoints, watches and scenes of a session, which are kept when another run replaces it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Stops {
    /// The breakpoints, in the order in which they were added.
    pub breakpoints: Vec<SavedBreakpoint>,
    /// The watched expressions, as they were typed.
    pub watches: Vec<String>,
    /// The scenes, of any run, in the user's order.
    pub scenes: Vec<SavedScene>,
}

/// Where a scene is in a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marked {
    /// It was set in this run, at this cursor.
    Here(usize),
    /// It was set in another run. In this run the corresponding event has just happened at this cursor.
    Like(usize),
    /// This run has no such event.
    Nowhere,
}

impl Marked {
    /// Returns the cursor, if there is one.
    #[must_use]
    pub const fn cursor(self) -> Option<usize> {
        match self {
            Self::Here(cursor) | Self::Like(cursor) => Some(cursor),
            Self::Nowhere => None,
        }
    }
}

/// A cursor over a recording, with all that a user keeps beside it.
pub struct Debugger {
    recording: Arc<Recording>,
    /// Made when an expression first needs it: most runs have none, and its functions take a while to register.
    evaluator: OnceLock<Evaluator>,
    budget: usize,
    state: State,
    run_id: OnceLock<String>,
    breakpoints: Vec<Breakpoint>,
    /// The watched expressions, as they were typed.
    pub watches: Vec<String>,
    /// The scenes, of this run and of others, in the user's order.
    pub scenes: Vec<SavedScene>,
    /// The state of the user interface, which is saved with the session but not read here.
    pub view: serde_json::Value,
    /// The file of the pattern with which the recording was made, if it came from one.
    pub pattern: Option<PatternFile>,
}

impl Debugger {
    /// Returns a session at the start of a recording that was made with `budget`.
    #[must_use]
    pub fn new(recording: Arc<Recording>, budget: usize) -> Self {
        Self {
            evaluator: OnceLock::new(),
            state: State::default(),
            recording,
            budget,
            run_id: OnceLock::new(),
            breakpoints: Vec::new(),
            watches: Vec::new(),
            scenes: Vec::new(),
            view: serde_json::Value::Null,
            pattern: None,
        }
    }

    fn evaluator(&self) -> &Evaluator {
        let made = || Evaluator::new(Arc::clone(&self.recording));
        self.evaluator.get_or_init(made)
    }

    /// Returns the recording that the cursor moves over.
    #[must_use]
    pub const fn recording(&self) -> &Arc<Recording> {
        &self.recording
    }

    /// Returns the state at the cursor.
    #[must_use]
    pub const fn state(&self) -> &State {
        &self.state
    }

    /// Returns the event that is about to happen.
    #[must_use]
    pub fn event(&self) -> Option<&Event> {
        self.recording.event(self.state.cursor())
    }

    /// Returns the breakpoints in the order in which they were added; indices of [`Stop`] refer to it.
    #[must_use]
    pub fn breakpoints(&self) -> &[Breakpoint] {
        &self.breakpoints
    }

    /// Adds a breakpoint. An empty condition always holds. A condition that does not parse, or names a number that is
    /// for watches alone, is kept with its error.
    pub fn add_breakpoint(&mut self, line: LineId, condition: &str) {
        let text = condition.trim();
        let parsed = (!text.is_empty()).then(|| self.evaluator().parse_condition(text));
        self.breakpoints.push(Breakpoint {
            line,
            condition: text.to_owned(),
            enabled: true,
            parsed,
        });
    }

    /// Removes a breakpoint. An unknown index changes nothing.
    pub fn remove_breakpoint(&mut self, index: usize) {
        if index < self.breakpoints.len() {
            self.breakpoints.remove(index);
        }
    }

    /// Enables or disables a breakpoint.
    pub fn enable_breakpoint(&mut self, index: usize, enabled: bool) {
        if let Some(breakpoint) = self.breakpoints.get_mut(index) {
            breakpoint.enabled = enabled;
        }
    }

    /// Returns every watched expression with its value at the cursor, or the error: [`ExpressionError::Pending`] for one whose
    /// numbers of the moment take more than its part of about `steps` counted steps. Calls that follow come nearer.
    #[must_use]
    pub fn watch_values(&self, steps: u64) -> Vec<(&str, Result<String, ExpressionError>)> {
        let each = steps / self.watches.len().max(1) as u64;
        let value = |text: &String| {
            let expression = self.evaluator().parse(text)?;
            self.evaluator()
                .value_within(&expression, &self.state, each)
        };
        let watches = self.watches.iter();
        watches.map(|text| (text.as_str(), value(text))).collect()
    }

    /// Returns the value of an expression at the cursor.
    pub fn evaluate(&self, text: &str) -> Result<String, ExpressionError> {
        let expression = self.evaluator().parse(text)?;
        self.evaluator().value(&expression, &self.state)
    }

    /// Moves to a cursor, at most the number of events.
    pub fn jump(&mut self, cursor: usize) {
        self.state.seek(&self.recording, cursor);
    }

    /// Moves the cursor by a step, as [`moves::step`] computes it.
    pub fn step(&mut self, step: Step, direction: Direction) {
        let cursor = moves::step(&self.recording, self.state.cursor(), step, direction);
        self.jump(cursor);
    }

    /// Runs to just after the next (or last) event that matches `target`, or to just before the next execution of a
    /// line. If there is none, the cursor stays.
    pub fn run_to(&mut self, target: Target, direction: Direction) -> Stop {
        let from = self.state.cursor();
        match moves::arrive(&self.recording, from, target, direction) {
            Some(cursor) => {
                self.jump(cursor);
                Stop::Target
            }
            None => Stop::End,
        }
    }

    /// Runs to the next (or last) breakpoint whose condition holds, or to the end (or start).
    pub fn run(&mut self, direction: Direction) -> Stop {
        self.run_while(direction, &|| true)
    }

    /// Like [`Self::run`], but calls `go_on` at the start and at every breakpoint whose condition does not hold. If it returns
    /// false, the cursor stays where it then is, and [`Stop::End`] is returned.
    pub fn run_while(&mut self, direction: Direction, go_on: &dyn Fn() -> bool) -> Stop {
        loop {
            if !go_on() {
                return Stop::End;
            }

            let from = self.state.cursor();
            let armed = |event: &Event| {
                let mut enabled = self.breakpoints.iter().filter(|b| b.enabled);
                enabled.any(|b| b.line == event.line())
            };

            // Events of a class have one line and one kind, so that `nearest` asks about one event of each class instead of all
            // events, and finds the nearest beyond `from` by a few binary searches, past millions of events.
            let hit = self.recording.classes().nearest(from, direction, armed);
            let Some(cursor) = hit else {
                let forwards = direction == Direction::Forwards;
                self.jump(if forwards { self.recording.len() } else { 0 });
                return Stop::End;
            };

            // A condition is evaluated on the state just before the line, which the jump makes.
            self.jump(cursor);
            if let Some(stop) = self.stop_here() {
                return stop;
            }
        }
    }

    /// Returns the breakpoint that stops the run at the event that is about to happen, if there is one.
    fn stop_here(&self) -> Option<Stop> {
        let line = self.event()?.line();
        let here = self.breakpoints.iter().enumerate();
        // Several breakpoints may be on one line: the first whose condition holds, or fails, stops the run.
        for (index, breakpoint) in here.filter(|(_, b)| b.enabled && b.line == line) {
            let holds = match &breakpoint.parsed {
                None => Ok(true),
                Some(Err(error)) => Err(error.clone()),
                Some(Ok(expression)) => self.evaluator().holds(expression, &self.state),
            };

            match holds {
                Ok(true) => return Some(Stop::Breakpoint(index)),
                Ok(false) => {}
                // A condition that cannot be evaluated stops the run, too. Taken for a false one, it would be passed
                // unnoticed.
                Err(error) => return Some(Stop::BadCondition(index, error)),
            }
        }
        None
    }

    /// Returns an identifier of the run. Runs with the same result but other events have different ones.
    #[must_use]
    pub fn run_id(&self) -> &str {
        self.run_id.get_or_init(|| {
            let recording = &self.recording;
            format!("{}-{}", recording.digest(), recording.len())
        })
    }

    /// Adds a scene of the moment at the cursor, with this view, at `index` of the scenes or as the last.
    pub fn add_scene(&mut self, index: usize, view: serde_json::Value) {
        let scene = self.anchored(SavedScene {
            event: self.state.cursor(),
            view,
            ..SavedScene::default()
        });
        self.scenes.insert(index.min(self.scenes.len()), scene);
    }

    /// Returns where a scene is in this run.
    #[must_use]
    pub fn marked(&self, scene: &SavedScene) -> Marked {
        if scene.run == self.run_id() && scene.event <= self.recording.len() {
            return Marked::Here(scene.event);
        }

        // In another run an event has another number. A scene at the end of a stage is looked up by the stage, since
        // the events before that end are not the same.
        let cursor = match (scene.ends, &scene.anchor) {
            (Some(stage), _) => self.recording.end_of(stage),
            (None, Some(anchor)) => self.recording.anchored(anchor).map(|event| event + 1),
            // Only the start of a run has no event before it by which it could be found.
            (None, None) => (scene.event == 0).then_some(0),
        };

        cursor.map_or(Marked::Nowhere, Marked::Like)
    }

    /// Returns a scene with the run and the anchor that it lacks.
    fn anchored(&self, mut scene: SavedScene) -> SavedScene {
        // Without a run it was set in this one, where its number of events can be looked up.
        if scene.run.is_empty() {
            self.run_id().clone_into(&mut scene.run);
            let last = scene.event.checked_sub(1);
            scene.anchor = last.and_then(|event| self.recording.anchor(event));
            scene.ends = self.recording.stage_ending_at(scene.event);
        }
        scene
    }

    /// Returns breakpoints, watches and scenes.
    #[must_use]
    pub fn stops(&self) -> Stops {
        Stops {
            breakpoints: self.saved_breakpoints(),
            watches: self.watches.clone(),
            scenes: self.scenes.clone(),
        }
    }

    /// Takes breakpoints, watches and scenes out of this session.
    pub fn take_stops(&mut self) -> Stops {
        let breakpoints = self.saved_breakpoints();
        self.breakpoints.clear();
        Stops {
            breakpoints,
            watches: take(&mut self.watches),
            scenes: take(&mut self.scenes),
        }
    }

    /// Replaces breakpoints, watches and scenes. A scene without a run counts as one of this run.
    pub fn put_stops(&mut self, stops: Stops) -> Result<(), SessionError> {
        self.breakpoints.clear();
        for saved in &stops.breakpoints {
            self.add_saved(saved)?;
        }
        self.watches = stops.watches;
        let anchored = stops.scenes.into_iter().map(|scene| self.anchored(scene));
        self.scenes = anchored.collect();
        Ok(())
    }

    /// Returns the breakpoints as they are saved.
    #[must_use]
    pub fn saved_breakpoints(&self) -> Vec<SavedBreakpoint> {
        let lines = Listings::shipped();
        let saved = |b: &Breakpoint| SavedBreakpoint {
            line: lines
                .line(b.line)
                .map_or_else(String::new, |line| line.id.clone()),
            condition: (!b.condition.is_empty()).then(|| b.condition.clone()),
            enabled: b.enabled,
        };
        self.breakpoints.iter().map(saved).collect()
    }

    /// Returns the session in the form in which it is saved.
    #[must_use]
    pub fn session(&self) -> Session {
        Session {
            // The lowest version that holds such a run, so that older programs open the session where they can.
            version: if self.recording.is_exact() && self.recording.run().locality.is_some() {
                VERSION
            } else if self.recording.is_in_space() {
                VERSION_OF_SPACE
            } else if self.recording.run().locality.is_some() {
                VERSION_OF_GROUND
            } else if self.recording.is_exact() {
                VERSION_OF_EXACT
            } else {
                VERSION_OF_KDRT
            },

            parameters: self.recording.run().parameters,
            budget: self.budget,
            digest: self.recording.digest(),
            cursor: self.state.cursor(),
            breakpoints: self.saved_breakpoints(),
            watches: self.watches.clone(),
            scenes: self.scenes.clone(),
            view: self.view.clone(),
            pattern: self.pattern.clone(),
            // A recording does not hold what its field and its shape were made from: the caller adds that.
            ground: serde_json::Value::Null,
            // Nor does it hold the third side.
            depth: None,
        }
    }

    /// Returns the session as it was, on a recording of its run, such as [`Session::record`] makes.
    ///
    /// Fails when the session exceeds a limit, when the digest of the recording's result is not the saved one, and when the
    /// session names an event or a line that there is not.
    pub fn resume(session: &Session, recording: Arc<Recording>) -> Result<Self, SessionError> {
        session.check()?;
        let found = recording.digest();
        if found != session.digest {
            let expected = session.digest.clone();
            return Err(SessionError::Different { expected, found });
        }

        let events = recording.len();
        let mut debugger = Self::new(recording, session.budget);

        // A scene without a run belongs to this one. Scenes of other runs may name events that this run does not have.
        let of_this = |scene: &&SavedScene| scene.run.is_empty() || scene.run == debugger.run_id();
        let scenes = session.scenes.iter().filter(of_this);
        let mut cursors = scenes.map(|scene| scene.event).chain([session.cursor]);

        // `jump` stops at the end of the run, which for a cursor beyond the end is not the saved moment.
        if let Some(event) = cursors.find(|&event| event > events) {
            return Err(SessionError::NoSuchEvent { event, events });
        }

        debugger.put_stops(Stops {
            breakpoints: session.breakpoints.clone(),
            watches: session.watches.clone(),
            scenes: session.scenes.clone(),
        })?;

        debugger.view.clone_from(&session.view);
        debugger.pattern.clone_from(&session.pattern);
        debugger.jump(session.cursor);
        Ok(debugger)
    }

    fn add_saved(&mut self, saved: &SavedBreakpoint) -> Result<(), SessionError> {
        let line = saved.line()?;
        self.add_breakpoint(line, saved.condition.as_deref().unwrap_or_default());
        let index = self.breakpoints.len() - 1;
        self.enable_breakpoint(index, saved.enabled);
        Ok(())
    }
}
