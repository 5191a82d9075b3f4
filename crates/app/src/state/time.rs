//! The commands that move in time. Where events were kept the cursor of the debugger is the only time
//! there is, and the stage follows from it.

use std::cell::Cell;

use tilescope_debugger::{Debugger, Direction, Event, Step, Stop, Target, moves};

use super::State;
use crate::clock::Clock;
use crate::command::TimeCommand;
use crate::moment::Shown;
use crate::passes::PassCommand;
use crate::subject::Subject;

/// So many conditions of breakpoints are looked at in a frame: some tens of milliseconds.
const MOST_CONDITIONS: u32 = 10_000;

impl State {
    /// Returns the moment that is shown.
    #[must_use]
    pub fn shown(&self) -> Option<Shown<'_>> {
        self.runs.first.shown()
    }

    /// Returns what the canvas shows.
    #[must_use]
    pub fn subject(&self) -> Option<Subject<'_>> {
        let first = &self.runs.first;
        Some(Subject {
            causes: self.causes(),
            buffers: self.buffers_on_canvas(),
            ..first.subject(&self.appearance, self.contrast(false))?
        })
    }

    /// Returns the cursor, and how many events there are; `None` for a session without events.
    #[must_use]
    pub fn cursor(&self) -> Option<(usize, usize)> {
        let debugger = self.runs.first.debugger.as_ref()?;
        Some((debugger.state().cursor(), debugger.recording().len()))
    }

    /// Returns whether the result is what is shown.
    #[must_use]
    pub fn is_at_end(&self) -> bool {
        match (self.cursor(), &self.runs.first.session) {
            (Some((cursor, len)), _) => cursor == len,
            (None, Some(session)) => self.runs.first.stage + 1 >= session.stages.len(),
            (None, None) => true,
        }
    }

    pub(super) fn apply_to_time(&mut self, command: TimeCommand) {
        if self.runs.first.session.is_none() {
            return;
        }
        let before = self.runs.first.stage;
        self.time.continuing = None;
        match command {
            TimeCommand::ShowStage(place) => self.show_stage(place),
            TimeCommand::StepBack => self.tick(Direction::Backwards),
            TimeCommand::StepForward => self.tick(Direction::Forwards),
            TimeCommand::FirstStage => self.show_stage(0),
            TimeCommand::LastStage => self.show_stage(usize::MAX),
            TimeCommand::TogglePlay => self.toggle_play(),
            TimeCommand::Clock(clock) if self.clock_refusal(clock).is_none() => {
                self.time.playback.choose(clock);
            }
            TimeCommand::Clock(_) => {}
            TimeCommand::Speed(speed) => self.time.playback.speed = speed,
            TimeCommand::Jump(cursor) => self.jump(cursor),
            TimeCommand::Step(step, direction) => self.step(step, direction),
            TimeCommand::RunTo(target, direction) => self.run_to(target, direction),
            TimeCommand::Continue(direction) => self.run_on(direction),
            TimeCommand::LoopStart => self.set_range(|range, at| range.start = at),
            TimeCommand::LoopEnd => self.set_range(|range, at| range.end = at),
            TimeCommand::Loop(range) => self.time.playback.range = range,
        }
        self.moved(before);
    }

    /// Does what follows from a move in time, which began at the stage `before`.
    pub(super) fn moved(&mut self, before: usize) {
        self.forget_unseen();
        if before != self.runs.first.stage {
            self.lead_passes();
        }
    }

    /// Returns why a clock cannot be chosen, or `None` if it can.
    #[must_use]
    pub fn clock_refusal(&self, clock: Clock) -> Option<&'static str> {
        match clock {
            Clock::Pass => self.runs.first.passes.is_none().then_some(
                "The passes of the GPU have not been run: the panel of GPU passes runs them.",
            ),
            Clock::Stage => None,
            Clock::Event | Clock::Line => self
                .runs
                .first
                .debugger
                .is_none()
                .then_some("This session has no events."),
        }
    }

    /// Returns the place of the chosen pass and of the last one, where the clock ticks by passes.
    #[must_use]
    pub fn pass_tick(&self) -> Option<(usize, usize)> {
        let passes = self
            .runs
            .first
            .passes
            .as_ref()
            .filter(|_| self.time.playback.clock == Clock::Pass)?;
        Some((passes.selected()?, passes.entries().len().checked_sub(1)?))
    }

    /// Shows the end of the stage at `place` of the list.
    pub(super) fn show_stage(&mut self, place: usize) {
        let Some(session) = &self.runs.first.session else {
            return;
        };
        let place = place.min(session.stages.len() - 1);
        match session.stage_end(place) {
            Some(cursor) => self.jump(cursor),
            None => self.set_stage(place),
        }
    }

    /// Moves to a cursor.
    pub(super) fn jump(&mut self, cursor: usize) {
        let (Some(debugger), Some(session)) =
            (&mut self.runs.first.debugger, &self.runs.first.session)
        else {
            return;
        };
        debugger.jump(cursor);
        let place = session.stage_at(debugger.state().cursor());
        self.set_stage(place);
    }

    /// Has the stage follow the cursor, which the debugger has moved.
    pub(super) fn follow_cursor(&mut self) {
        if let (Some(session), Some((cursor, _))) = (&self.runs.first.session, self.cursor()) {
            let place = session.stage_at(cursor);
            self.set_stage(place);
        }
    }

    fn step(&mut self, step: Step, direction: Direction) {
        if let Some(debugger) = &mut self.runs.first.debugger {
            debugger.step(step, direction);
            self.follow_cursor();
        }
    }

    /// Runs until the event that `target` means has happened, or until a line is the next one.
    fn run_to(&mut self, target: Target, direction: Direction) {
        let Some(debugger) = &mut self.runs.first.debugger else {
            return;
        };
        let stop = debugger.run_to(target, direction);
        self.follow_cursor();
        if stop == Stop::End {
            let text = none_there(target, direction);
            self.tell(crate::words::sentence(&text), false);
        }
    }

    fn run_on(&mut self, direction: Direction) {
        self.time.continuing = Some(direction);
        self.continue_on();
    }

    /// Runs on to a breakpoint, over so many at most whose conditions do not hold; the rest is left to the next frame.
    pub(super) fn continue_on(&mut self) {
        let (Some(direction), Some(debugger)) =
            (self.time.continuing, &mut self.runs.first.debugger)
        else {
            self.time.continuing = None;
            return;
        };
        let left = Cell::new(MOST_CONDITIONS);
        let stop = debugger.run_while(direction, &|| {
            let before = left.get();
            left.set(before.saturating_sub(1));
            before > 0
        });
        self.follow_cursor();
        if stop == Stop::End && left.get() == 0 {
            return;
        }
        self.time.continuing = None;
        if let Stop::BadCondition(index, error) = stop {
            let text = format!(
                "The condition of breakpoint {} cannot be computed: {error}",
                index + 1
            );
            self.tell(crate::words::sentence(&text), true);
        }
    }

    /// Goes on or back by one tick of the clock.
    fn tick(&mut self, direction: Direction) {
        if self.time.playback.clock == Clock::Pass && self.runs.first.passes.is_some() {
            self.apply_to_passes(match direction {
                Direction::Forwards => PassCommand::Next,
                Direction::Backwards => PassCommand::Previous,
            });
            return;
        }
        let Some(debugger) = &self.runs.first.debugger else {
            let place = match direction {
                Direction::Forwards => self.runs.first.stage.saturating_add(1),
                Direction::Backwards => self.runs.first.stage.saturating_sub(1),
            };
            self.show_stage(place);
            return;
        };
        match self.time.playback.clock {
            Clock::Event => self.step(Step::Into, direction),
            Clock::Line => {
                let cursor = next_line(debugger, direction);
                self.jump(cursor);
            }
            Clock::Stage | Clock::Pass => self.tick_stage(direction),
        }
    }

    fn tick_stage(&mut self, direction: Direction) {
        let Some((session, cursor)) = self
            .runs
            .first
            .session
            .as_ref()
            .zip(self.cursor().map(|(at, _)| at))
        else {
            return;
        };
        let whole = session.stage_end(self.runs.first.stage) == Some(cursor);
        match direction {
            Direction::Forwards => self.show_stage(self.runs.first.stage + usize::from(whole)),
            Direction::Backwards => self.show_stage(self.runs.first.stage.saturating_sub(1)),
        }
    }

    /// Returns whether there is nothing left to play.
    fn at_end(&self) -> bool {
        match self.pass_tick().or_else(|| self.cursor()) {
            Some((cursor, len)) => cursor == len,
            None => self
                .runs
                .first
                .session
                .as_ref()
                .is_some_and(|s| self.runs.first.stage + 1 == s.stages.len()),
        }
    }

    fn toggle_play(&mut self) {
        if self.time.playback.is_playing() {
            self.time.playback.stop();
            return;
        }
        if let Some(range) = self.time.playback.range.clone() {
            let inside = self.cursor().is_some_and(|(at, _)| range.contains(&at));
            if !inside {
                self.jump(range.start);
            }
        } else if self.at_end() {
            self.show_stage(0);
        }
        self.time.playback.start();
    }

    /// Plays on by `dt_secs`; returns whether it goes on.
    pub(super) fn play(&mut self, dt_secs: f32) -> bool {
        let before = self.runs.first.stage;
        let ticks = self.time.playback.advance(dt_secs);
        for _ in 0..ticks {
            self.tick(Direction::Forwards);
            match (self.time.playback.range.clone(), self.cursor()) {
                (Some(range), Some((at, _))) if at >= range.end => {
                    self.jump(range.start);
                    break;
                }
                _ if self.at_end() => {
                    self.time.playback.stop();
                    break;
                }
                _ => {}
            }
        }
        if ticks > 0 {
            self.moved(before);
        }
        self.time.playback.is_playing()
    }

    fn set_range(&mut self, change: impl FnOnce(&mut std::ops::Range<usize>, usize)) {
        let Some((at, len)) = self.cursor() else {
            return;
        };
        let mut range = self.time.playback.range.clone().unwrap_or(0..len);
        change(&mut range, at);
        self.time.playback.range = (range.start < range.end).then_some(range);
    }

    /// A sample that does not exist yet is not pointed at. What is selected stays: its history lies ahead.
    pub(super) fn forget_unseen(&mut self) {
        let Some(shown) = self.shown() else {
            return;
        };
        let absent = tilescope_core::Standing::Absent;
        let hovered = self
            .runs
            .first
            .hovered
            .filter(|&id| shown.standing(id) != absent);
        let finished = shown.stage == tilescope_core::Stage::Finish;
        self.runs.first.hovered = hovered;
        if !finished {
            self.runs.first.sight = None;
        }
    }
}

/// Returns where the next (or last) line of pseudocode begins that is not the one at the cursor.
fn next_line(debugger: &Debugger, direction: Direction) -> usize {
    let cursor = debugger.state().cursor();
    let line = debugger.event().map(Event::line);
    let other = |_: usize, event: &Event| Some(event.line()) != line;
    let end = match direction {
        Direction::Forwards => debugger.recording().len(),
        Direction::Backwards => 0,
    };
    moves::find(debugger.recording(), cursor, direction, other).unwrap_or(end)
}

/// Returns what a run looks for, as a noun.
/// Says that a run found nothing to stop at.
pub(super) fn none_there(target: Target, direction: Direction) -> String {
    let way = match direction {
        Direction::Forwards => "after",
        Direction::Backwards => "before",
    };
    format!("there is no {} {way} this moment", name_of(target))
}

fn name_of(target: Target) -> String {
    match target {
        Target::Line(_) => "execution of this line".to_owned(),
        Target::Kind(kind) => format!("event of kind \"{}\"", kind.name()),
        Target::Conflict => "conflict".to_owned(),
        Target::Elimination => "elimination".to_owned(),
        Target::Gap => "gap found".to_owned(),
        Target::Insertion => "insertion".to_owned(),
        Target::SecondInsertion => "second insertion in one gap".to_owned(),
        Target::Violation => "violated invariant".to_owned(),
        Target::Sample(id) => format!("event of sample {}", crate::words::grouped(id as usize)),
    }
}
