//! Makes runs with the chosen engine, and opens the passes of the GPU. `state/gpu.rs` chooses the engine.

use tilescope_session::jobs::Job;
use tilescope_session::layers::SessionKind;
use tilescope_session::limits::MAX_PASSES_ON_A_PAGE;
use tilescope_session::recipe::Recipe;
use tilescope_session::sampling::SampleTask;
use tilescope_session::session::Session;
use tilescope_session::task;
use tilescope_session::words::{grouped, sentence};

use super::{State, Which};
use crate::clock::Clock;
use crate::device::EngineChoice;
use crate::layout::Panel;
use crate::passes::{OnCanvas, PassCommand, Passes};

impl State {
    /// Starts a run of `recipe` by `engine`.
    pub(super) fn start_sampling(&mut self, which: Which, recipe: Recipe, engine: EngineChoice) {
        self.jobs.generation += 1;
        let generation = self.jobs.generation;
        let gpu = self.gpu.for_run(&recipe.parameters, engine);
        // Nested levels are made on the CPU.
        let job = match gpu.filter(|_| recipe.nested.is_none()) {
            Some(gpu) => Job::start_future(&self.jobs.wake, move |monitor| async move {
                tilescope_session::sampling::on_gpu(gpu, &recipe, generation, &monitor).await
            }),
            None => task::start(&self.jobs.wake, SampleTask { recipe, generation }),
        };
        self.on(which, |run, _| run.sampling = Some(job));
    }

    /// Returns whether another engine made the run shown than the one that makes the next. Nested levels and combinations
    /// are always made on the CPU.
    #[must_use]
    pub fn engine_differs(&self) -> bool {
        let Some(session) = &self.runs.first.session else {
            return false;
        };
        let has_choice = session.kind() == SessionKind::Run && session.has_recipe();
        if !has_choice || self.form.draft.levels.is_some() {
            return false;
        }
        let next = self
            .gpu
            .for_run(&self.form.draft.parameters, self.gpu.engine);
        next.is_some() != session.engine.starts_with("GPU")
    }

    /// Shows a session, with a notice if the CPU replaced the GPU or the GPU's run differs.
    pub(super) fn show_made(&mut self, which: Which, mut session: Session) {
        let failure = session.failure.take();
        let is_run = session.combination.is_none();
        let differs = session.kind() == SessionKind::Run
            && session.has_stages()
            && session.recording().is_none();
        let engine = session.engine.clone();
        if is_run {
            self.show_in(which, session);
        } else {
            self.show_combination(which, session);
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

    /// Returns why the passes cannot be inspected now, or `None` if they can.
    #[must_use]
    pub fn passes_refusal(&self) -> Option<String> {
        let Some(session) = &self.runs.first.session else {
            return Some("There is no session yet.".to_owned());
        };
        if session.combination.is_some() {
            let text =
                "This is a combination of sets, made on the CPU; the passes are those of a run.";
            return Some(text.to_owned());
        }
        if session.nested.is_some() {
            let text = "These are nested levels, made on the CPU; the passes are those of a run.";
            return Some(text.to_owned());
        }
        if session.own.is_some() {
            let text = "This session's pattern comes from a file; passes can be inspected only with a generated pattern.";
            return Some(text.to_owned());
        }
        if cfg!(target_arch = "wasm32") && session.summary.count > MAX_PASSES_ON_A_PAGE {
            let most = grouped(MAX_PASSES_ON_A_PAGE);
            return Some(format!(
                "A page shows the passes of runs of up to {most} samples; the native program has no such limit."
            ));
        }
        self.gpu.device.not_ready()
    }

    pub(super) fn open_passes(&mut self) {
        if self.passes_refusal().is_some() {
            return;
        }
        let (Some(gpu), Some(session)) = (self.gpu.device.ready(), &self.runs.first.session) else {
            return;
        };
        match Passes::new(gpu, &session.run().parameters, &self.jobs.wake) {
            Ok(passes) => self.runs.first.passes = Some(passes),
            Err(refusal) => self.tell(sentence(&refusal), true),
        }
    }

    /// If the clock counts passes but there are none any more, returns to the previous clock.
    pub(super) const fn follow_passes(&mut self) {
        if self.runs.first.passes.is_none() {
            self.time.playback.clock = self.time.playback.clock_of_events();
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

    pub(super) fn apply_to_passes(&mut self, command: PassCommand) {
        let shows_canvas = command == PassCommand::ShowCanvas;
        self.on(Which::First, |run, context| {
            run.apply_to_passes(command, context);
        });
        if shows_canvas && self.runs.first.passes.is_some() {
            self.show_buffers();
        }
    }

    /// Opens the canvas, chooses passes as the clock, and flies to the selected row, if there is one.
    fn show_buffers(&mut self) {
        self.time.playback.choose(Clock::Pass);
        self.window.open_panel(Panel::Canvas);
        self.on(Which::First, |run, context| {
            let position = run.passes.as_ref().and_then(Passes::picked_position);
            if let Some(position) = position {
                run.fly_to(position, 12.0, context);
            }
        });
    }
}
