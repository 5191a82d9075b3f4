//! Work in the background: starting it, taking its results, waiting for it. Results are shown here and
//! nowhere else.

use std::sync::Arc;

use super::undo::Part;
use super::{State, Verification};
use crate::device::Device;
use crate::errand::{self, Lent};
use crate::jobs::Job;
use crate::recipe::Recipe;
use crate::selection::Selection;
use crate::session::{MakeError, Session};
use crate::verification::{Judging, Verdict};
use crate::words::sentence;

impl State {
    pub(super) fn run(&mut self) {
        if self.run_refusal().is_some() {
            return;
        }
        (self.messages.notice, self.links.arriving) = (None, None);
        self.stop_reading();
        let recipe = self.typed();
        let is_new = self
            .runs
            .first
            .session
            .as_ref()
            .is_none_or(|session| session.recipe() != recipe);
        if is_new || self.shows_combination() {
            self.remember_run(Part::Run);
        }
        self.start_sampling(recipe, self.form.engine);
    }

    /// Returns what the parameters panel asks for.
    #[must_use]
    pub fn typed(&self) -> Recipe {
        Recipe {
            parameters: self.form.draft.parameters,
            own: self.form.own_pattern.clone(),
        }
    }

    /// Goes on by `dt_secs`: takes what jobs have finished, moves the camera, plays. Returns whether
    /// something is moving, so that another frame is due.
    pub fn advance(&mut self, dt_secs: f32) -> bool {
        self.poll();
        self.fly_on(dt_secs);
        let plays = self.time.playback.is_playing() && self.play(dt_secs);
        if self.time.continuing.is_some() {
            let before = self.runs.first.stage;
            self.continue_on();
            self.moved(before);
        }
        self.reveal();
        self.want_hits();
        self.want_geometry();
        self.want_analysis();
        self.count_frames();
        let flies = self.advance_second(dt_secs);
        self.follow_passes();
        self.announce();
        self.runs.first.flight.is_some() || plays || flies || self.time.continuing.is_some()
    }

    pub(super) fn fly_on(&mut self, dt_secs: f32) {
        if let Some(flight) = &mut self.runs.first.flight {
            let (camera, arrived) = flight.advance(dt_secs);
            self.runs.first.camera = camera;
            if arrived {
                self.runs.first.flight = None;
            }
        }
    }

    pub(super) fn want_geometry(&mut self) {
        let mut geometry = std::mem::take(&mut self.runs.first.geometry);
        if let Some(shown) = self
            .shown()
            .filter(|_| self.appearance.layers.wants_geometry())
        {
            geometry.want(&shown, &self.jobs.wake);
        }
        self.runs.first.geometry = geometry;
    }

    fn poll(&mut self) {
        if let Device::Testing(job) = &self.gpu.device
            && let Some(outcome) = job.poll()
        {
            self.finish_test(outcome);
        }
        self.poll_run();
        self.poll_export();
        self.poll_files();
    }

    /// Takes what concerns the run at hand.
    pub(super) fn poll_run(&mut self) {
        if let Some(outcome) = self.runs.first.sampling.as_ref().and_then(Job::poll) {
            self.finish_sampling(outcome);
        }
        if let Verification::Pending(job) = &self.runs.first.verification
            && let Some(outcome) = job.poll()
        {
            self.finish_verification(outcome);
        }
        self.runs.first.history_found.poll();
        if let Some(passes) = &mut self.runs.first.passes {
            passes.poll();
        }
        self.runs.first.query.found.poll();
    }

    pub(super) fn finish_sampling(&mut self, outcome: Result<Result<Session, MakeError>, String>) {
        self.runs.first.sampling = None;
        match outcome {
            Ok(Ok(session)) => {
                self.show_made(session);
                return self.arrive();
            }
            Ok(Err(error)) => self.not_made(&error),
            Err(failure) => self.tell(sentence(&failure), true),
        }
        self.links.arriving = None;
    }

    fn not_made(&mut self, error: &MakeError) {
        match error.cancelled() {
            Some(stage) => {
                let kept = if self.runs.first.session.is_some() {
                    " The session before it is still here."
                } else {
                    ""
                };
                self.tell(format!("Cancelled during stage \"{stage}\".{kept}"), false);
            }
            None => self.tell(sentence(&error.to_string()), true),
        }
    }

    /// Shows a session at its last stage and has it verified.
    pub fn show(&mut self, session: Session) {
        self.time.continuing = None;
        let same_domain = self.runs.first.session.as_ref().is_some_and(|old| {
            old.run().domain.width() == session.run().domain.width()
                && old.run().domain.height() == session.run().domain.height()
        });
        let same_run = self.runs.first.session.as_ref().is_some_and(|old| {
            let are_runs = old.combination.is_none() && session.combination.is_none();
            are_runs && old.recipe() == session.recipe()
        });
        let selection = match (self.runs.first.selected, self.runs.first.place) {
            (Some(id), _) if same_run => Selection::Sample(id),
            (_, Some(place)) if same_domain => Selection::Place(place),
            _ => Selection::Nothing,
        };
        let range = self.time.playback.range.take().filter(|_| same_run);
        self.runs.first.stage = session.stages.len() - 1;
        (
            self.runs.first.hovered,
            self.runs.first.selected,
            self.runs.first.sight,
        ) = (None, None, None);
        self.runs.first.place = None;
        self.time.playback.stop();
        let session = Arc::new(session);
        self.runs.first.session = Some(Arc::clone(&session));
        self.debug(&session);
        if let Some(debugger) = &mut self.runs.first.debugger {
            debugger.jump(usize::MAX);
        }
        self.time.playback.range = range;
        self.pick(selection);
        // What is saved next is another session.
        self.runs.first.session_path = None;
        self.verify();
        let from_pattern = self.runs.first.before_pattern.take().is_some();
        if !same_domain || from_pattern {
            self.runs.first.fitted = true;
            self.runs.first.flight = None;
            if self.runs.first.viewport.is_positive() {
                self.runs.first.camera = self.fitting();
            }
        }
    }

    /// Has the session at hand verified.
    pub(super) fn verify(&mut self) {
        let Some(session) = self.runs.first.session.clone() else {
            return;
        };
        let judging = Judging(Lent(session));
        self.runs.first.verification =
            Verification::Pending(errand::start(&self.jobs.wake, judging));
    }

    pub(super) fn finish_verification(&mut self, outcome: Result<Result<Verdict, String>, String>) {
        self.runs.first.verification = match outcome {
            Ok(Ok(verdict)) => Verification::Done(Box::new(verdict)),
            Ok(Err(failure)) | Err(failure) => Verification::Failed(sentence(&failure)),
        };
    }

    /// Waits for all work in the background and takes its results. For tests and scripts: a window
    /// calls [`Self::advance`] with every frame.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn settle(&mut self) {
        self.settle_device();
        self.settle_files();
        self.settle_run();
        while self.time.continuing.is_some() {
            self.continue_on();
        }
        self.settle_second();
        self.settle_analysis();
        self.follow_passes();
        self.want_hits();
        self.runs.first.hits.settle();
        if let Some(job) = self.files.exporting.take() {
            let outcome = job.wait();
            self.finish_export(outcome);
        }
    }

    /// Waits for what concerns the run at hand.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn settle_run(&mut self) {
        if let Some(job) = self.runs.first.sampling.take() {
            let outcome = job.wait();
            self.finish_sampling(outcome);
        }
        if let Verification::Pending(job) = &self.runs.first.verification {
            let outcome = job.wait();
            self.finish_verification(outcome);
        }
        self.want_geometry();
        self.runs.first.geometry.settle();
        self.want_geometry();
        self.runs.first.geometry.settle();
        self.runs.first.history_found.settle();
        if let Some(passes) = &mut self.runs.first.passes {
            passes.settle();
        }
        self.runs.first.query.found.settle();
    }
}
