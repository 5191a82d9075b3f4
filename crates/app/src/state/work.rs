//! Work in the background: starting it, taking its results, waiting for it. Results are shown here and
//! nowhere else.

use std::sync::Arc;

use super::undo::Part;
use super::{State, Verification};
use crate::command::Selection;
use crate::device::Device;
use crate::draft::sentence;
use crate::errand::Lent;
use crate::jobs::Job;
use crate::recipe::Recipe;
use crate::session::{MakeError, Session};
use crate::verification::{Judging, Verdict};

impl State {
    pub(super) fn run(&mut self) {
        if self.run_refusal().is_some() {
            return;
        }
        (self.notice, self.arriving) = (None, None);
        self.stop_reading();
        let recipe = self.typed();
        let is_new = self
            .session
            .as_ref()
            .is_none_or(|session| session.recipe() != recipe);
        if is_new || self.shows_combination() {
            self.remember_run(Part::Run);
        }
        self.start_sampling(recipe, self.engine);
    }

    /// Returns what the parameters panel asks for.
    #[must_use]
    pub fn typed(&self) -> Recipe {
        Recipe {
            parameters: self.draft.parameters,
            own: self.own_pattern.clone(),
        }
    }

    /// Goes on by `dt_secs`: takes what jobs have finished, moves the camera, plays. Returns whether
    /// something is moving, so that another frame is due.
    pub fn advance(&mut self, dt_secs: f32) -> bool {
        self.poll();
        self.fly_on(dt_secs);
        let plays = self.playback.is_playing() && self.play(dt_secs);
        if self.continuing.is_some() {
            let before = self.stage;
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
        self.flight.is_some() || plays || flies || self.continuing.is_some()
    }

    pub(super) fn fly_on(&mut self, dt_secs: f32) {
        if let Some(flight) = &mut self.flight {
            let (camera, arrived) = flight.advance(dt_secs);
            self.camera = camera;
            if arrived {
                self.flight = None;
            }
        }
    }

    pub(super) fn want_geometry(&mut self) {
        let mut geometry = std::mem::take(&mut self.geometry);
        if let Some(shown) = self.shown().filter(|_| self.layers.wants_geometry()) {
            geometry.want(&shown, &self.wake);
        }
        self.geometry = geometry;
    }

    fn poll(&mut self) {
        if let Device::Testing(job) = &self.device
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
        if let Some(outcome) = self.sampling.as_ref().and_then(Job::poll) {
            self.finish_sampling(outcome);
        }
        if let Verification::Pending(job) = &self.verification
            && let Some(outcome) = job.poll()
        {
            self.finish_verification(outcome);
        }
        self.history_found.poll();
        if let Some(passes) = &mut self.passes {
            passes.poll();
        }
        self.query.found.poll();
    }

    pub(super) fn finish_sampling(&mut self, outcome: Result<Result<Session, MakeError>, String>) {
        self.sampling = None;
        match outcome {
            Ok(Ok(session)) => {
                self.show_made(session);
                return self.arrive();
            }
            Ok(Err(error)) => self.not_made(&error),
            Err(failure) => self.tell(sentence(&failure), true),
        }
        self.arriving = None;
    }

    fn not_made(&mut self, error: &MakeError) {
        match error.cancelled() {
            Some(stage) => {
                let kept = if self.session.is_some() {
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
        self.continuing = None;
        let same_domain = self.session.as_ref().is_some_and(|old| {
            old.run().domain.width() == session.run().domain.width()
                && old.run().domain.height() == session.run().domain.height()
        });
        let same_run = self.session.as_ref().is_some_and(|old| {
            let are_runs = old.combination.is_none() && session.combination.is_none();
            are_runs && old.recipe() == session.recipe()
        });
        let selection = match (self.selected, self.place) {
            (Some(id), _) if same_run => Selection::Sample(id),
            (_, Some(place)) if same_domain => Selection::Place(place),
            _ => Selection::Nothing,
        };
        let range = self.playback.range.take().filter(|_| same_run);
        self.stage = session.stages.len() - 1;
        (self.hovered, self.selected, self.sight) = (None, None, None);
        self.place = None;
        self.playback.stop();
        let session = Arc::new(session);
        self.session = Some(Arc::clone(&session));
        self.debug(&session);
        if let Some(debugger) = &mut self.debugger {
            debugger.jump(usize::MAX);
        }
        self.playback.range = range;
        self.pick(selection);
        // What is saved next is another session.
        self.session_path = None;
        self.verify();
        let from_pattern = self.before_pattern.take().is_some();
        if !same_domain || from_pattern {
            self.fitted = true;
            self.flight = None;
            if self.viewport.is_positive() {
                self.camera = self.fitting();
            }
        }
    }

    /// Has the session at hand verified.
    pub(super) fn verify(&mut self) {
        let Some(session) = self.session.clone() else {
            return;
        };
        let judging = Judging(Lent(session));
        self.verification = Verification::Pending(Job::run(&self.wake, judging));
    }

    pub(super) fn finish_verification(&mut self, outcome: Result<Result<Verdict, String>, String>) {
        self.verification = match outcome {
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
        while self.continuing.is_some() {
            self.continue_on();
        }
        self.settle_second();
        self.settle_analysis();
        self.follow_passes();
        self.want_hits();
        self.hits.settle();
        if let Some(job) = self.exporting.take() {
            let outcome = job.wait();
            self.finish_export(outcome);
        }
    }

    /// Waits for what concerns the run at hand.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn settle_run(&mut self) {
        if let Some(job) = self.sampling.take() {
            let outcome = job.wait();
            self.finish_sampling(outcome);
        }
        if let Verification::Pending(job) = &self.verification {
            let outcome = job.wait();
            self.finish_verification(outcome);
        }
        self.want_geometry();
        self.geometry.settle();
        self.want_geometry();
        self.geometry.settle();
        self.history_found.settle();
        if let Some(passes) = &mut self.passes {
            passes.settle();
        }
        self.query.found.settle();
    }
}
