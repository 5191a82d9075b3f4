//! Background work in the state: starts it, takes its results, waits for it. Every frame calls [`State::advance`]; tests and
//! scripts call [`State::settle`].

use tilescope_classroom::Classroom;
use tilescope_session::jobs::Wake;
use tilescope_session::layers::{Layer, SessionKind};
use tilescope_session::session::{MakeError, Session};
use tilescope_session::words::sentence;

use super::run_view::{Made, TRANSITION_SECS};
use super::{Messages, State, Which};
use crate::clock::Clock;
use crate::command::Command;
use crate::files::FileCommand;
use crate::layout::Panel;
use crate::passes::OnCanvas;
use crate::rules::UndoPart;

/// Larger runs, in samples, do not start by themselves.
const MAX_LIVE: f64 = 50_000.0;

impl State {
    pub(super) fn run(&mut self) {
        // The button is off then; scripts, links and pages that embed the window are told why nothing runs.
        if let Some(why) = self.form.refusal(&self.gpu) {
            return self.tell_of(Which::First, why, true);
        }
        self.stop_making();
        let recipe = self.form.recipe();
        let session = self.runs.first.session.as_ref();
        let is_same = |session: &Session| session.has_recipe() && session.recipe() == recipe;
        if !session.is_some_and(|session| is_same(session)) {
            self.remember_run(UndoPart::Run);
        }
        self.start_sampling(Which::First, recipe, self.gpu.engine);
    }

    /// Runs after a change of the parameters, if live runs were chosen and the run is small.
    pub(super) fn run_live(&mut self, command: &Command) {
        let expected = self.form.draft.expected_samples();
        let is_small = expected.is_some_and(|count| count <= MAX_LIVE);
        if !self.form.live || !is_small || self.form.refusal(&self.gpu).is_some() {
            return;
        }
        let recipe = self.form.recipe();
        let session = self.runs.first.session.as_ref();
        if session.is_none_or(|session| session.recipe() != recipe) {
            let now = self.runs.first.session.is_some().then(|| self.memento());
            self.past.history.remember_live_run(command, now);
            self.start_sampling(Which::First, recipe, self.gpu.engine);
        }
    }

    /// Advances by `dt_secs`: takes finished work, moves cameras, plays. Returns whether something is moving,
    /// so that another frame is needed.
    pub fn advance(&mut self, dt_secs: f32) -> bool {
        self.poll();
        self.in_class(Classroom::follow_lesson_file);
        self.on(Which::First, |run, _| run.fly_on(dt_secs));
        let cursor = self.cursor();
        let runs = self.in_time(|time, run, context| time.advance(dt_secs, run, context));
        let is_fast = self.time.playback.is_fast(TRANSITION_SECS);
        if !is_fast {
            self.follow_event(cursor);
        }
        let shows_events = self.window.shows(Panel::Events);
        let with_geometry = self.wants_geometry();
        let awaits_rest = self.on(Which::First, |run, context| {
            run.follow_prefix(dt_secs, context);
            if shows_events {
                run.reveal();
            }
            run.want_hits(context);
            if with_geometry {
                run.want_geometry(context);
            }
            run.awaits_rest()
        });
        let is_analysed = self.window.shows(Panel::Analysis);
        let wake = Wake::clone(&self.runs.jobs.wake);
        self.analysis.follow(&self.runs.first, is_analysed, &wake);
        self.follow_scenes();
        let dark = self.appearance.look.is_dark();
        self.in_class(|class, context| {
            class.follow_talk(dark, context);
            class.follow_handout(context);
        });
        self.in_exports(|exports, source, _, _| exports.count_frames(source));
        self.poll_run(Which::Second);
        let flies = self.with_of(Which::Second, |state, context| {
            state.runs.advance_second(dt_secs, with_geometry, context)
        });
        self.time.follow_passes(&self.runs.first);
        let is_playing = self.time.playback.is_playing();
        let Messages {
            announcer, notice, ..
        } = &mut self.messages;
        let lessons = &self.classroom.lessons;
        announcer.follow(&self.runs.first, is_playing, notice.as_ref(), lessons);
        let is_wanted = !is_fast && !self.appearance.reduced_motion;
        let changes = self.runs.first.advance_transition(dt_secs, is_wanted);
        self.runs.first.flight.is_some() || runs || flies || changes || awaits_rest == Some(true)
    }

    fn poll(&mut self) {
        self.with(|state, context| state.gpu.poll(context));
        self.poll_run(Which::First);
        self.in_exports(|exports, source, delivery, context| {
            exports.poll(source, delivery, context);
        });
        self.with(|state, context| state.files.poll(&state.runs.first, context));
        if let Some(path) = self.files.take_awaiting(&self.runs.first) {
            self.apply(Command::File(FileCommand::Dropped(vec![path])));
        }
    }

    /// Takes finished work on a run.
    pub(super) fn poll_run(&mut self, which: Which) {
        if let Some(outcome) = self.on(which, |run, _| run.made()).flatten() {
            self.finish_sampling(which, outcome);
        }
        self.on(which, |run, _| run.poll());
    }

    fn finish_sampling(&mut self, which: Which, outcome: Made) {
        match outcome {
            Ok(Ok(session)) => {
                if which == Which::Second {
                    return self.show_made(which, session);
                }
                if let Some(run) = self.classroom.made_for_lesson(&session) {
                    // The lesson shows it only up to its question.
                    drop(session);
                    return self.in_class(|class, context| class.arrive_at_step(&run, context));
                }
                // A live run shows the stage that was shown.
                let run = &self.runs.first;
                let is_live = self.form.live && !run.is_at_end();
                let stage = run.current_stage().filter(|_| is_live);
                self.show_made(which, session);
                if let Some(stage) = stage {
                    self.runs.first.show_same_stage(stage);
                }
                self.arrive();
                // The scene of the tour is one of the run that is there now.
                if let Some(shown) = self.scenes.shown.filter(|_| self.scenes.is_touring()) {
                    self.show_scene_of_tour(shown.index);
                }
                return;
            }
            Ok(Err(error)) => self.not_made(which, &error),
            Err(failure) => self.tell_of(which, sentence(&failure), true),
        }
        if which == Which::First {
            self.runs.arriving = None;
        }
    }

    fn not_made(&mut self, which: Which, error: &MakeError) {
        match error.cancelled() {
            Some(stage) => {
                let run = self.runs.get(which);
                let kept = match run.and_then(|run| run.session.as_ref()) {
                    Some(_) => " The previous session is kept.",
                    None => "",
                };
                let text = format!("Cancelled during stage \"{stage}\".{kept}");
                self.tell_of(which, text, false);
            }
            None => self.tell_of(which, sentence(&error.to_string()), true),
        }
    }

    /// Shows a session at its last stage and starts verifying it.
    pub fn show(&mut self, session: Session) {
        self.show_in(Which::First, session);
    }

    pub(super) fn show_in(&mut self, which: Which, session: Session) {
        if which == Which::First {
            let same_run = self.runs.first.is_same_run(&session);
            self.time.rest(same_run);
        }
        self.on(which, |run, context| run.show(session, context));
    }

    /// Waits for all work in the background and takes its results. For tests and scripts; a window calls
    /// [`Self::advance`] every frame.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn settle(&mut self) {
        self.with(|state, context| state.gpu.settle(context));
        if let Some(path) = self.files.take_awaiting(&self.runs.first) {
            self.apply(Command::File(FileCommand::Dropped(vec![path])));
        }
        self.with(|state, context| state.files.settle(context));
        self.settle_run(Which::First);
        while self.time.continuing.is_some() {
            self.in_time(super::Time::continue_on);
        }
        self.settle_run(Which::Second);
        let wake = Wake::clone(&self.runs.jobs.wake);
        self.runs.settle_comparison(&wake);
        let is_analysed = self.window.shows(Panel::Analysis);
        let run = &self.runs.first;
        self.analysis.settle_with(run, is_analysed, &wake);
        self.time.follow_passes(&self.runs.first);
        self.on(Which::First, |run, context| {
            run.want_hits(context);
            run.hits.settle();
        });
        self.follow_scenes();
        while self.scenes.thumbnails.wait() {
            self.follow_scenes();
        }
        let dark = self.appearance.look.is_dark();
        self.in_class(|class, context| class.settle_talk(dark, context));
        self.in_exports(|exports, _, _, context| exports.settle(context));
    }

    /// Draws the pictures of the scenes while their panel is open.
    fn follow_scenes(&mut self) {
        if self.window.shows(Panel::Scenes) {
            let dark = self.appearance.look.is_dark();
            let wake = &self.runs.jobs.wake;
            self.scenes.follow_thumbnails(&self.runs.first, dark, wake);
        }
    }

    /// Shows a session, with a notice if the CPU replaced the GPU or the GPU's run differs.
    pub(super) fn show_made(&mut self, which: Which, mut session: Session) {
        let failure = session.failure.take();
        let differs = session.kind() == SessionKind::Run
            && session.has_stages()
            && session.recording().is_none();
        let engine = session.engine.clone();
        let is_combination = session.combination.is_some();
        self.show_in(which, session);
        // A combination is shown with its seams.
        if let Some(layers) = &mut self.appearance.chosen_layers
            && is_combination
            && !layers.has(Layer::Seams)
        {
            layers.toggle(Layer::Seams);
        }

        if differs {
            let text = format!(
                "The run of {engine} differs from the CPU's run with the same parameters. It is shown as it is, without events. \
                 The passes of the GPU show where the two diverge."
            );
            self.tell_of(which, text, true);
        }
        if let Some(failure) = failure {
            let text = self.gpu.failed(failure);
            self.tell_of(which, text, true);
        }
    }

    /// Returns the rows of the GPU's buffers to show on the canvas. `None` unless the panel of passes is visible,
    /// passes are the clock, or the timeline is at the moment of the last command of the passes.
    #[must_use]
    pub fn buffers_on_canvas(&self) -> Option<OnCanvas<'_>> {
        let passes = self.runs.first.passes.as_ref()?;
        let is_seen = self.window.shows(Panel::Passes) && !self.appearance.look.is_projector();
        let now = self.runs.first.moment();
        let is_then = now.is_some() && passes.moment() == now;
        let is_meant = is_seen || is_then || self.time.playback.clock == Clock::Pass;
        passes.on_canvas().filter(|_| is_meant)
    }

    /// Returns whether a layer is on that needs the triangulation of the moment.
    pub(super) fn wants_geometry(&self) -> bool {
        let layers = self.appearance.layers(self.current_stage());
        let session = self.runs.first.session.as_ref();
        session.is_some_and(|session| session.drawable(layers).wants_geometry())
    }

    /// Waits for the work on a run.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn settle_run(&mut self, which: Which) {
        if let Some(job) = self.on(which, |run, _| run.sampling.take()).flatten() {
            let outcome = job.wait();
            self.finish_sampling(which, outcome);
        }
        let with_geometry = self.wants_geometry();
        self.on(which, |run, context| run.settle(with_geometry, context));
    }
}
