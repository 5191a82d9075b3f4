//! The background work of a run, and showing a new session.

use std::mem::take;
use std::sync::Arc;

use tilescope_live::Wanted;
use tilescope_session::jobs::Job;
use tilescope_session::layers::Layers;
use tilescope_session::recipe::Recipe;
use tilescope_session::selection::Selection;
use tilescope_session::session::Session;
use tilescope_session::task::{self, SessionRef};
use tilescope_session::verification::{Verdict, VerifyTask};
use tilescope_session::words::sentence;

use super::{Made, RunView};
use crate::command::Which;
use crate::curve::CurveNumber;
use crate::device::EngineChoice;
use crate::state::Verification;
use crate::state::effects::{Context, Effect};

/// The parts of a run's moment that the window shows, so that they are measured.
#[derive(Clone, Copy)]
pub(in crate::state) struct Asked {
    pub(in crate::state) layers: Layers,
    pub(in crate::state) is_analysed: bool,
    /// The counted steps that the measures which move with it may take in a frame.
    pub(in crate::state) steps: u64,
    pub(in crate::state) curve: Option<CurveNumber>,
    pub(in crate::state) is_dark: bool,
}

impl RunView {
    /// Shows a session at its last stage and has it verified. Breakpoints, watches and scenes stay.
    pub(in crate::state) fn show(&mut self, session: Session, context: &mut Context) {
        self.show_unverified(session, context);
        self.verify(context);
    }

    /// Shows a session at its last stage.
    pub(in crate::state) fn show_unverified(&mut self, session: Session, context: &mut Context) {
        self.show_shared(&Arc::new(session), context);
    }

    /// Shows a session, which another run may show, too, at its last stage.
    pub(in crate::state) fn show_shared(&mut self, session: &Arc<Session>, context: &mut Context) {
        let same_domain = self.session.as_ref().is_some_and(|old| {
            old.run().domain.width() == session.run().domain.width()
                && old.run().domain.height() == session.run().domain.height()
        });

        let box_of = |session: &Session| session.solid.as_ref().map(|solid| solid.domain);
        let is_same_box = self.session.as_deref().and_then(box_of) == box_of(session);
        // In the same box the plane stays where it is.
        self.reset_plane(is_same_box);

        let selection = match (self.selected, self.place) {
            // An id means the same sample only in the same run. A place means the same in every run on the same domain.
            (Some(id), _) if self.is_same_run(session) => Selection::Sample(id),
            (_, Some(place)) if same_domain => Selection::Place(place),
            _ => Selection::Nothing,
        };

        self.stage = session.stages.len() - 1;
        (self.hovered, self.selected, self.witness_mark) = (None, None, None);
        self.place = None;
        self.show_whole(session.summary.count);
        self.session = Some(Arc::clone(session));
        self.debug(session, context);
        // Of a recorded run, the end is shown.
        if let Some(debugger) = &mut self.debugger {
            debugger.jump(usize::MAX);
        }

        self.pick(selection, context);

        // The file belongs to the session before.
        self.session_path = None;
        self.verification = Verification::Nothing;

        // A camera of another domain, or of the pattern, does not show the domain of this session.
        let from_pattern = self.before_pattern.take().is_some();
        if !same_domain || from_pattern {
            (self.fitted, self.framed) = (true, None);
            self.flight = None;
            if self.viewport.is_positive() {
                self.camera = self.fitting();
            }
        }
    }

    /// Ends the tour of a program that had no run before it: shows the run of the parameters as typed, as after the start.
    pub(in crate::state) fn end_as_started(
        &mut self,
        typed: Recipe,
        engine: EngineChoice,
        context: &mut Context,
    ) {
        let Some(session) = &self.session else {
            return;
        };

        let is_typed = session.has_recipe() && session.recipe() == typed;
        if is_typed && self.sampling.is_none() {
            self.show_stage(usize::MAX);
            self.fit(context);
        } else {
            // The tour has made another run since, or is making one.
            context.ask(Effect::Sample(Which::First, Box::new(typed), engine));
        }
    }

    /// Cancels the session that is being made.
    pub(in crate::state) fn cancel(&self) {
        if let Some(job) = &self.sampling {
            job.cancel();
        }
    }

    /// Becomes a run that was set aside. Breakpoints, watches and scenes stay, and the canvas keeps its size.
    pub(in crate::state) fn put_back(&mut self, run: Self, context: &mut Context) {
        let (stops, viewport) = (self.take_stops(), self.viewport);
        *self = run;
        // The window may have another size now.
        self.follow_viewport(viewport);
        // The breakpoints, watches and scenes that were set aside with the run give way to the present ones.
        drop(self.take_stops());
        self.put_stops(stops, context);
    }

    /// Returns whether a session is of the same run as the one shown.
    pub(in crate::state) fn is_same_run(&self, session: &Session) -> bool {
        self.session.as_ref().is_some_and(|old| {
            let are_runs = old.has_recipe() && session.has_recipe();
            are_runs && old.recipe() == session.recipe()
        })
    }

    /// Starts verifying the session.
    pub(in crate::state) fn verify(&mut self, context: &Context) {
        if let Some(session) = self.session.clone() {
            let judging = VerifyTask {
                prefix: session.has_prefixes().then_some(session.summary.count),
                session: SessionRef(session),
            };
            self.verification = Verification::Pending(task::start(&context.wake, judging));
        }
    }

    pub(super) fn finish_verification(&mut self, outcome: Result<Result<Verdict, String>, String>) {
        self.verification = match outcome {
            Ok(Ok(verdict)) => Verification::Done(Box::new(verdict)),
            Ok(Err(failure)) | Err(failure) => Verification::Failed(sentence(&failure)),
        };
    }

    /// Brings the measures that move with the run to the moment, and starts what takes longer, as far as something asks for
    /// them.
    pub(in crate::state) fn follow_moment(&mut self, asked: Asked, context: &Context) {
        if let Some(session) = &self.session {
            self.curve.want(session, asked.curve, &context.wake);
            self.orbit.want(session, asked.is_dark, &context.wake);
        }

        if !asked.is_analysed {
            self.measuring.rest();
            self.solid_measuring.rest();
        }

        // These are taken out of the run, because they change while `shown` borrows it.
        let (mut live, mut geometry) = (take(&mut self.live), take(&mut self.geometry));
        let mut measuring = take(&mut self.measuring);
        let mut solid_measuring = take(&mut self.solid_measuring);

        if let (Some(session), Some(shown)) = (&self.session, self.shown()) {
            let layers = session.drawable(asked.layers).drawn_at(shown.stage);
            // The panel of the analysis shows all measures; a part of the frequencies will do while all would take too many steps.
            // Of a set in space distances alone are followed.
            let is_in_space = session.solid.is_some();
            let is_analysed_in_plane = asked.is_analysed && !is_in_space;
            // The measures of circles are those of one radius in a rectangle.
            let has_circles = session.ground.is_none() && !is_in_space;
            let wanted = Wanted {
                spectrum: is_analysed_in_plane,
                thinned: is_analysed_in_plane,
                pairs: asked.is_analysed,
                // Where disks have radii of their own, and in a shape, gaps are looked for pixel by pixel.
                cover: is_analysed_in_plane || layers.has_gaps() && has_circles,
            };
            live.follow(session, &shown, wanted, asked.steps, &context.wake);
            if is_analysed_in_plane && has_circles {
                measuring.want(session, &shown, &context.wake);
            }
            if asked.is_analysed && is_in_space {
                solid_measuring.want(session, &shown, &context.wake);
            }
            if let Some(cover) = live.cover(&shown).filter(|_| layers.has_gaps()) {
                geometry.take_borders(&shown, cover);
            }
            if layers.wants_geometry() && !is_in_space {
                geometry.want(session, &shown, layers.has_net(), &context.wake);
            }
        }

        (self.live, self.geometry, self.measuring) = (live, geometry, measuring);
        self.solid_measuring = solid_measuring;
    }

    /// Stops measuring the moment.
    pub(in crate::state) fn stop_measuring(&mut self) {
        let mut measuring = take(&mut self.measuring);
        let mut solid_measuring = take(&mut self.solid_measuring);
        if let Some(shown) = self.shown() {
            measuring.stop(&shown);
            solid_measuring.stop(&shown);
        }
        (self.measuring, self.solid_measuring) = (measuring, solid_measuring);
    }

    /// Takes finished work on the session.
    pub(in crate::state) fn poll(&mut self) {
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

    /// Waits for the work on the session, including that on the parts that are `asked` for.
    #[cfg(not(target_arch = "wasm32"))]
    pub(in crate::state) fn settle(&mut self, asked: Asked, context: &Context) {
        if let Verification::Pending(job) = &self.verification {
            let outcome = job.wait();
            self.finish_verification(outcome);
        }
        self.settle_prefix(context);

        // No frame waits for this, so that the steps are not limited.
        let asked = Asked {
            steps: u64::MAX,
            ..asked
        };

        // The first round ends work that was started for another moment. The second one finds that the moment rests, and does its work.
        // The third one passes on the outcome, as gaps take their borders from a cover.
        for _ in 0..3 {
            self.follow_moment(asked, context);
            self.live.settle();
            self.curve.settle();
            self.orbit.settle();
            self.geometry.settle();
        }
        // Each round measures one more part.
        while self.measuring.settle() || self.solid_measuring.settle() {
            self.follow_moment(asked, context);
        }

        self.history_found.settle();
        if let Some(passes) = &mut self.passes {
            passes.settle();
        }
        self.query.found.settle();
    }

    /// Waits for the session that is being made, and takes it or its error.
    #[cfg(not(target_arch = "wasm32"))]
    pub(in crate::state) fn wait_made(&mut self) -> Option<Made> {
        Some(self.sampling.take()?.wait())
    }

    /// Takes the session that was being made, or its error, once the work has ended.
    pub(in crate::state) fn made(&mut self) -> Option<Made> {
        let outcome = self.sampling.as_ref().and_then(Job::poll)?;
        self.sampling = None;
        Some(outcome)
    }
}
