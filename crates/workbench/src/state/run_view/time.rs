//! Moves a run in time. If events were recorded, the moment is the debugger's cursor, and the stage follows
//! from it.

use tilescope_core::{Stage, Standing};
use tilescope_debugger::{Debugger, Direction, Event, Step, Stop, Target, moves};
use tilescope_drawing::made::Made;
use tilescope_session::layers::SessionKind;
use tilescope_session::words::{counted, grouped};

use super::RunView;
use crate::clock::Clock;
use crate::state::effects::Context;
use tilescope_session::moment::Moment;

impl RunView {
    /// Returns the description of the moment: the number of blocks or samples, the event or stage, and the iteration,
    /// or in a plane through space how many cubes are active. Of a prefix it has the number of samples or dots; of
    /// nested levels also the radius of their disks, and the number below which their ranks are, unless a question of a
    /// lesson is open (`is_veiled`).
    #[must_use]
    pub fn moment_texts(&self, is_veiled: bool) -> Vec<String> {
        let Some(session) = &self.session else {
            return Vec::new();
        };

        if let (Some(count), Some(nested)) = (self.prefix(), &session.nested) {
            let radius = session.run().domain.radius();
            let samples = counted(session.summary.count, "sample", "samples");
            let mut texts = vec![
                format!("{} of {samples}", grouped(count)),
                format!("radius {:.2} r", nested.disk_radius(count) / radius),
            ];
            // A program that has the ranks gets the same samples by this number. Shown beside the count, it would give away
            // the answer to a question about ranks: a learner would only have to move the slider.
            let threshold = nested.threshold(count).filter(|_| !is_veiled);
            texts.extend(threshold.map(|threshold| format!("ranks below {threshold}")));
            return texts;
        }

        if let Some(count) = self.prefix() {
            let dots = counted(session.summary.count, "dot", "dots");
            return vec![format!("{} of {dots}", grouped(count))];
        }

        let blocks = || self.shown().map_or(0, |shown| Made::at(&shown).leaves);
        let count = match session.stages[self.stage] {
            Stage::Blocks if session.combination.is_some() => counted(blocks(), "piece", "pieces"),
            Stage::Blocks => counted(blocks(), "block", "blocks"),
            stage => {
                let debugger = self.debugger.as_ref();
                let now = debugger.map(|debugger| debugger.state().counts());
                // The debugger counts the samples of the run, but the stage of the pattern shows the samples of the pattern.
                let count = match now.filter(|_| stage != Stage::Pattern) {
                    Some(counts) => counts.undecided + counts.kept,
                    None => session.count_after(self.stage),
                };
                counted(count, "sample", "samples")
            }
        };

        let moment = match self.cursor() {
            // At the end of a recording that is cut off, it is not known how long the run is.
            Some((at, _)) if session.is_cut_off_at(at) => format!("event {}", grouped(at)),
            Some((at, len)) => format!("event {} of {}", grouped(at), grouped(len)),
            None => format!("stage {} of {}", self.stage + 1, session.stages.len()),
        };

        let mut texts = vec![count, moment];
        let stage = session.stages[self.stage];
        let plane = self.plane();
        if let Some(active) = plane.and_then(|plane| session.active_in_plane(stage, plane)) {
            texts.push(active);
            return texts;
        }
        if let Stage::Iterate(k) = stage {
            texts.push(format!("iteration {k}"));
        }
        texts
    }

    /// Returns the cursor, and how many events there are; `None` for a session without events. Of nested levels and of
    /// a stipple it is how many samples are shown, and how many there are.
    #[must_use]
    pub fn cursor(&self) -> Option<(usize, usize)> {
        if let (Some(count), Some(session)) = (self.prefix(), &self.session) {
            return Some((count, session.summary.count));
        }
        let debugger = self.debugger.as_ref()?;
        Some((debugger.state().cursor(), debugger.recording().len()))
    }

    /// Returns whether the end of the run is shown.
    #[must_use]
    pub fn is_at_end(&self) -> bool {
        match (self.cursor(), &self.session) {
            (Some((cursor, len)), _) => cursor == len,
            (None, Some(session)) => self.stage + 1 >= session.stages.len(),
            (None, None) => true,
        }
    }

    /// Returns the name of a clock's tick: nested levels have samples and levels instead of events and stages, and
    /// stipples have dots instead of events.
    #[must_use]
    pub fn clock_name(&self, clock: Clock) -> &'static str {
        match (clock, self.kind()) {
            (Clock::Event, SessionKind::Varying) if self.prefix().is_some() => "dot",
            (Clock::Event, SessionKind::Nested) => "sample",
            (Clock::Stage, SessionKind::Nested) => "level",
            _ => clock.name(),
        }
    }

    /// Returns why a clock cannot be chosen, or `None` if it can.
    #[must_use]
    pub fn clock_refusal(&self, clock: Clock) -> Option<&'static str> {
        match clock {
            Clock::Pass => self.passes.is_none().then_some(
                "The passes of the GPU have not been run: the panel of GPU passes runs them.",
            ),
            Clock::Stage => None,
            Clock::Event if self.prefix().is_some() => None,
            Clock::Event | Clock::Line => {
                let has_none = self.debugger.is_none();
                has_none.then_some("This session has no events.")
            }
        }
    }

    /// Shows the end of the stage at `index`.
    pub(in crate::state) fn show_stage(&mut self, index: usize) {
        let Some(session) = &self.session else {
            return;
        };
        if session.has_prefixes() {
            let end = session.ends().get(index).copied();
            // A stage beyond the last one is all of the set.
            return self.show_prefix(end.unwrap_or(usize::MAX));
        }
        let index = index.min(session.stages.len() - 1);
        match session.stage_end(index) {
            Some(cursor) => self.jump(cursor),
            None => self.set_stage(index),
        }
    }

    /// Shows the end of a stage of another run.
    pub(in crate::state) fn show_same_stage(&mut self, stage: Stage) {
        if let Some(session) = &self.session {
            let index = session.stage_index(stage);
            self.show_stage(index);
        }
    }

    /// Moves to a cursor.
    pub(in crate::state) fn jump(&mut self, cursor: usize) {
        if self.prefix().is_some() {
            return self.show_prefix(cursor);
        }
        let (Some(debugger), Some(session)) = (&mut self.debugger, &self.session) else {
            return;
        };
        debugger.jump(cursor);
        let index = session.stage_at(debugger.state().cursor());
        self.set_stage(index);
    }

    /// Updates the stage after the debugger has moved the cursor.
    pub(in crate::state) fn follow_cursor(&mut self) {
        if let (Some(session), Some((cursor, _))) = (&self.session, self.cursor()) {
            let index = session.stage_at(cursor);
            self.set_stage(index);
        }
    }

    pub(in crate::state) fn step(&mut self, step: Step, direction: Direction) {
        if let Some(debugger) = &mut self.debugger {
            debugger.step(step, direction);
            self.follow_cursor();
        }
    }

    /// Goes to the next event, or the one before, at which the number of the curve rises.
    pub(in crate::state) fn go_to_rise(&mut self, direction: Direction, context: &mut Context) {
        let (Some(points), Some((cursor, _))) = (self.curve.points(), self.cursor()) else {
            let why = "There is no curve: choose a number of the run first.";
            return context.tell(why.to_owned());
        };
        let Some(risen) = points.rise(cursor, direction) else {
            let there = match direction {
                Direction::Forwards => "after",
                Direction::Backwards => "before",
            };
            let why = format!("The curve does not rise {there} this moment.");
            return context.tell(why);
        };
        self.jump(risen);
    }

    /// Goes to the end of the current stage, or of the next one if the cursor is there already; backwards to the end of the stage
    /// before.
    pub(in crate::state) fn step_stage(&mut self, direction: Direction) {
        let (Some(session), Some((cursor, _))) = (&self.session, self.cursor()) else {
            return;
        };
        let whole = session.stage_end(self.stage) == Some(cursor);
        match direction {
            Direction::Forwards => self.show_stage(self.stage + usize::from(whole)),
            Direction::Backwards => self.show_stage(self.stage.saturating_sub(1)),
        }
    }

    /// Runs forwards to the next event of `target`, or backwards to the last one before the cursor, and stops just
    /// after that event. At a line of pseudocode it stops just before the line is carried out. If no event of
    /// `target` is found, the cursor stays, and a notice says so. Without recorded events it does nothing.
    pub(in crate::state) fn run_to(
        &mut self,
        target: Target,
        direction: Direction,
        context: &mut Context,
    ) {
        let Some(debugger) = &mut self.debugger else {
            return;
        };

        let stop = debugger.run_to(target, direction);
        self.follow_cursor();

        if stop == Stop::End {
            let text = none_there(target, direction);
            context.tell(tilescope_session::words::sentence(&text));
        }
    }

    /// Goes to the moment of another run.
    pub(in crate::state) fn go_to(&mut self, moment: Moment) {
        match (moment.cursor, &self.session) {
            (Some(cursor), _) if self.cursor().is_some() => self.jump(cursor),
            (_, Some(session)) => self.set_stage(session.stage_index(moment.stage)),
            (_, None) => {}
        }
        self.forget_unseen();
    }

    /// Updates what depends on the moment, after a move from the stage `before`.
    pub(in crate::state) fn moved(&mut self, before: usize) {
        self.forget_unseen();
        if before != self.stage {
            self.lead_passes();
        }
    }

    /// Removes the pointer's mark from a sample that does not exist yet, and before the last stage the mark of a verdict's witness,
    /// as the verdict is about the end. The selection stays, as its history is still to come.
    pub(in crate::state) fn forget_unseen(&mut self) {
        let Some(shown) = self.shown() else {
            return;
        };
        let hovered = self
            .hovered
            .filter(|&id| shown.standing(id) != Standing::Absent);
        let is_finished = shown.stage == Stage::Finish;
        self.hovered = hovered;
        self.witness_mark = self.witness_mark.take().filter(|_| is_finished);
    }
}

/// Returns the cursor at which the next (or previous) line of pseudocode other than the current one begins.
pub(in crate::state) fn next_line(debugger: &Debugger, direction: Direction) -> usize {
    let cursor = debugger.state().cursor();
    let line = debugger.event().map(Event::line);
    let other = |_: usize, event: &Event| Some(event.line()) != line;
    let end = match direction {
        Direction::Forwards => debugger.recording().len(),
        Direction::Backwards => 0,
    };
    moves::find(debugger.recording(), cursor, direction, other).unwrap_or(end)
}

/// Returns the message for a target that does not occur after, or before, the moment.
pub(crate) fn none_there(target: Target, direction: Direction) -> String {
    let side = match direction {
        Direction::Forwards => "after",
        Direction::Backwards => "before",
    };
    format!("there is no {} {side} this moment", name_of(target))
}

/// Returns the name of a target.
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
        Target::Sample(id) => format!("event of sample {}", grouped(id as usize)),
    }
}
