//! Playback in the state: the clock, playing, and running to a breakpoint. It moves the run that the panels
//! show.

use std::cell::Cell;
use std::ops::Range;
use std::sync::Arc;

use tilescope_classroom::lesson_set::LessonSet;
use tilescope_classroom::room::StepView;
use tilescope_debugger::{Direction, Recording, Step, Stop};
use tilescope_session::selection::Selection;

use super::RunView;
use super::effects::Context;
use super::run_view::next_line;
use crate::clock::{Clock, Course, Playback};
use crate::command::TimeCommand;
use crate::passes::PassCommand;
use crate::view::whole_run;

/// The most breakpoint conditions evaluated in a frame, which takes some tens of milliseconds.
const MAX_CONDITIONS: u32 = 10_000;

/// The state of playback.
#[derive(Default)]
pub struct Time {
    /// The clock, the speed, and whether it is playing.
    pub playback: Playback,
    /// The direction in which a breakpoint is being searched for, if so.
    pub(super) continuing: Option<Direction>,
    /// While a whole run is played: the share of its time that has passed, and the cursor there.
    played: Option<(f64, usize)>,
}

impl Time {
    /// Applies a command to the run that the panels show. Without a session it does nothing.
    pub(super) fn apply(&mut self, command: TimeCommand, run: &mut RunView, context: &mut Context) {
        if run.session.is_none() {
            return;
        }

        let before = run.stage;
        // Any command in time ends a search for a breakpoint that is under way.
        self.continuing = None;

        match command {
            TimeCommand::ShowStage(index) => run.show_stage(index),
            TimeCommand::StepBack => self.tick(Direction::Backwards, run, context),
            TimeCommand::StepForward => self.tick(Direction::Forwards, run, context),
            // A stipple has one stage, at whose end all dots are shown. Its first moment is that of the first dot.
            TimeCommand::FirstStage if run.shows_stipple() => run.jump(1),
            TimeCommand::FirstStage => run.show_stage(0),
            TimeCommand::LastStage => run.show_stage(usize::MAX),
            TimeCommand::TogglePlay => self.toggle_play(run),
            TimeCommand::Clock(clock) if run.clock_refusal(clock).is_none() => {
                self.playback.choose(clock);
            }
            TimeCommand::Speed(speed) => self.playback.choose_speed(speed),
            TimeCommand::WholeRun(secs) => {
                let playback = &mut self.playback;
                // A duration beyond the limits changes nothing.
                playback.whole_run_secs = whole_run(secs).or(playback.whole_run_secs);
            }
            // The clock is refused, and the chosen one stays.
            TimeCommand::Clock(_) => {}
            TimeCommand::Jump(cursor) => run.jump(cursor),
            TimeCommand::Step(step, direction) => run.step(step, direction),
            TimeCommand::RunTo(target, direction) => run.run_to(target, direction, context),

            TimeCommand::Continue(direction) => {
                self.continuing = Some(direction);
                self.continue_on(run, context);
            }

            TimeCommand::ToRise(direction) => run.go_to_rise(direction, context),
            TimeCommand::LoopStart => self.set_range(run, |range, at| range.start = at),
            TimeCommand::LoopEnd => self.set_range(run, |range, at| range.end = at),
            TimeCommand::Loop(range) => self.playback.range = range,
        }

        // Marks and passes follow to the new moment.
        run.moved(before);
    }

    /// Advances by `dt_secs`; returns whether it is still playing or searching.
    pub(super) fn advance(
        &mut self,
        dt_secs: f32,
        run: &mut RunView,
        context: &mut Context,
    ) -> bool {
        let plays = self.playback.is_playing() && self.play(dt_secs, run, context);
        if self.continuing.is_some() {
            let before = run.stage;
            self.continue_on(run, context);
            run.moved(before);
        }
        plays || self.continuing.is_some()
    }

    /// If the clock counts passes but there are none any more, returns to the previous clock.
    pub(super) const fn follow_passes(&mut self, run: &RunView) {
        if run.passes.is_none() {
            self.playback.clock = self.playback.clock_of_events();
        }
    }

    /// Shows a recorded run, whole or up to the cursor `limit`, without verifying it. `set` is the field of radii or
    /// the box of the run; `None` if the run has neither.
    pub(super) fn show_recording(
        &mut self,
        (recording, set): (&Arc<Recording>, Option<&LessonSet>),
        limit: Option<usize>,
        run: &mut RunView,
        context: &mut Context,
    ) {
        // A question that is open holds the recording up to its moment, so that nothing shows more.
        let shown = match limit {
            Some(cursor) => Arc::new(recording.until(cursor)),
            None => Arc::clone(recording),
        };
        let session = LessonSet::session(set, shown, context.next_generation());
        self.rest(run.is_same_run(&session));
        run.show_unverified(session, context);
    }

    /// Shows the moment of a lesson's step: up to it if a question is open, otherwise in the whole run.
    pub(super) fn show_step(&mut self, view: &StepView, run: &mut RunView, context: &mut Context) {
        let recording = (&view.run, view.set.as_ref());
        self.show_recording(recording, view.limit, run, context);
        let before = run.stage;
        run.jump(view.cursor);
        run.moved(before);
        run.cut_at(view.plane);
        // A step is about the plane, which balls would take the place of.
        run.take_orbit(None);
        run.pick(Selection::Nothing, context);
        // With a zoom the `radii` of the frame do not count: the zoom has the scale. Without either the whole domain is
        // shown.
        match (view.framed, view.zoom) {
            (Some((center, _)), Some(zoom)) => run.look_from(zoom, center.into(), context),
            (None, Some(zoom)) => run.look_from(zoom, zoom.center, context),
            (Some((center, radii)), None) => run.fly_to(center.into(), radii, context),
            (None, None) => run.fit(context),
        }
    }

    /// Stops, as another session is shown. The loop stays if that is of the same run.
    pub(super) fn rest(&mut self, same_run: bool) {
        self.continuing = None;
        self.playback.stop();
        if !same_run {
            self.playback.range = None;
        }
    }

    /// Returns the indices of the chosen pass and of the last one, if the clock is that of passes.
    #[must_use]
    pub fn pass_tick(&self, run: &RunView) -> Option<(usize, usize)> {
        let by_passes = self.playback.clock == Clock::Pass;
        let passes = run.passes.as_ref().filter(|_| by_passes)?;
        Some((passes.selected()?, passes.entries().len().checked_sub(1)?))
    }

    /// Runs on to a breakpoint. After [`MAX_CONDITIONS`] conditions that do not hold it continues in the next
    /// frame.
    pub(super) fn continue_on(&mut self, run: &mut RunView, context: &mut Context) {
        let (Some(direction), Some(debugger)) = (self.continuing, &mut run.debugger) else {
            self.continuing = None;
            return;
        };

        let conditions_left = Cell::new(MAX_CONDITIONS);
        let stop = debugger.run_while(direction, &|| {
            let before = conditions_left.get();
            conditions_left.set(before.saturating_sub(1));
            before > 0
        });

        run.follow_cursor();
        // Here `End` need not be the end of the run: if the conditions of this frame are used up, the next frame goes on from here.
        if stop == Stop::End && conditions_left.get() == 0 {
            return;
        }

        self.continuing = None;
        if let Stop::BadCondition(index, error) = stop {
            // The message counts breakpoints from 1.
            let text = format!(
                "The condition of breakpoint {} cannot be evaluated: {error}",
                index + 1
            );
            context.tell_error(tilescope_session::words::sentence(&text));
        }
    }

    /// Steps forward or back by one tick of the clock.
    fn tick(&self, direction: Direction, run: &mut RunView, context: &mut Context) {
        if self.playback.clock == Clock::Pass && run.passes.is_some() {
            let command = match direction {
                Direction::Forwards => PassCommand::Next,
                Direction::Backwards => PassCommand::Previous,
            };
            return run.apply_to_passes(command, context);
        }

        if run.prefix().is_some() {
            // Nested levels have samples in the place of events, and levels in the place of stages. Every clock but
            // that of events steps by levels.
            let by_sample = self.playback.clock == Clock::Event;
            return run.step_prefix(by_sample, direction);
        }

        let Some(debugger) = &run.debugger else {
            // Without events there are only stages to step through.
            return run.show_stage(match direction {
                Direction::Forwards => run.stage.saturating_add(1),
                Direction::Backwards => run.stage.saturating_sub(1),
            });
        };

        match self.playback.clock {
            Clock::Event => run.step(Step::Into, direction),
            Clock::Line => run.jump(next_line(debugger, direction)),
            // Without passes of the GPU, their clock steps by stages.
            Clock::Stage | Clock::Pass => run.step_stage(direction),
        }
    }

    /// Returns whether there is nothing left to play.
    fn is_at_end(&self, run: &RunView) -> bool {
        match self.pass_tick(run).or_else(|| run.cursor()) {
            Some((cursor, len)) => cursor == len,
            None => run.session.is_some() && run.is_at_end(),
        }
    }

    /// Starts or stops play. With a loop, play begins at the loop's start if the cursor is outside the loop. Without
    /// a loop, play begins at the start of the run if the cursor is at its end.
    fn toggle_play(&mut self, run: &mut RunView) {
        if self.playback.is_playing() {
            self.playback.stop();
            return;
        }

        if let Some(range) = self.playback.range.clone() {
            let inside = run.cursor().is_some_and(|(at, _)| range.contains(&at));
            if !inside {
                run.jump(range.start);
            }
        } else if self.is_at_end(run) {
            match run.prefix() {
                // A prefix has at least one sample.
                Some(_) => run.jump(1),
                None => run.show_stage(0),
            }
        }

        self.playback.start();
    }

    /// Plays for `dt_secs`; returns whether it is still playing.
    fn play(&mut self, dt_secs: f32, run: &mut RunView, context: &mut Context) -> bool {
        // A whole run is played in a given time, not by the ticks of a clock.
        if let (Some(secs), Some((at, _))) = (self.playback.pace_secs(), run.cursor()) {
            return self.play_course(dt_secs / secs, at, run);
        }

        let before = run.stage;
        let ticks = self.playback.advance(dt_secs);
        for _ in 0..ticks {
            self.tick(Direction::Forwards, run, context);
            match (self.playback.range.clone(), run.cursor()) {
                (Some(range), Some((at, _))) if at >= range.end => {
                    // The loop begins anew, and this frame shows its first moment: further ticks of the frame are dropped.
                    run.jump(range.start);
                    break;
                }
                _ if self.is_at_end(run) => {
                    self.playback.stop();
                    break;
                }
                // Within the run, and within the loop if there is one, the play goes on.
                _ => {}
            }
        }

        if ticks > 0 {
            run.moved(before);
        }
        self.playback.is_playing()
    }

    /// Plays the part `share` of the whole run's time, from the cursor `at`; returns whether it is still playing.
    fn play_course(&mut self, share: f32, at: usize, run: &mut RunView) -> bool {
        let before = run.stage;
        let Some(session) = &run.session else {
            return false;
        };

        let course = Course::of(session.ends().into_iter());
        // The part of the time that has passed is kept from frame to frame, as long as the cursor stays where the last
        // frame left it. A frame may be shorter than an event: a part that each frame computes from the cursor would
        // then never grow.
        let passed_before = match self.played {
            Some((passed, cursor)) if cursor == at => passed,
            _ => course.share(at),
        };
        let passed = passed_before + f64::from(share);

        // Rounding must not move the cursor back.
        let mut cursor = course.cursor(passed).max(at);
        if let Some(range) = self.playback.range.clone()
            && cursor >= range.end
        {
            cursor = range.start;
        }

        // Where the loop began anew nothing is kept: the next frame computes the part that has passed from the loop's
        // first cursor.
        self.played = (cursor >= at).then_some((passed, cursor));
        if cursor != at {
            run.jump(cursor);
            run.moved(before);
        }

        if passed >= 1.0 && self.playback.range.is_none() {
            self.playback.stop();
            self.played = None;
        }
        self.playback.is_playing()
    }

    /// Sets one end of the loop to the cursor; without a loop the other end is that of the run. A loop without events
    /// is removed.
    fn set_range(&mut self, run: &RunView, change: impl FnOnce(&mut Range<usize>, usize)) {
        let Some((at, len)) = run.cursor() else {
            return;
        };
        let mut range = self.playback.range.clone().unwrap_or(0..len);
        change(&mut range, at);
        self.playback.range = (range.start < range.end).then_some(range);
    }
}
