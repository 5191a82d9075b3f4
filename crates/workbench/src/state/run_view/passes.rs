//! Keeps the passes of a run on the GPU and the timeline in step.

use tilescope_session::incoming::NamedBytes;
use tilescope_session::look::Look;
use tilescope_session::words::sentence;

use super::RunView;
use crate::clock::Clock;
use crate::layout::Panel;
use crate::passes::{OnCanvas, PassCommand, Passes};
use crate::state::effects::{Context, Effect};
use crate::state::{GpuState, WindowState};

impl RunView {
    /// Moves the passes to the one that ends the stage shown, unless the chosen pass is of that stage, or the stage is
    /// the last one that is complete once the chosen pass has run.
    pub(in crate::state) fn lead_passes(&mut self) {
        let (Some(stage), Some(passes)) = (self.current_stage(), &mut self.passes) else {
            return;
        };
        let is_there = passes.position().is_some_and(|(other, _)| other == stage);
        if !is_there && passes.whole_stage() != Some(stage) {
            passes.select_stage(stage);
        }
    }

    /// Applies a command of the passes; the timeline follows to the last stage that is complete after the
    /// chosen pass.
    pub(in crate::state) fn apply_to_passes(
        &mut self,
        command: PassCommand,
        context: &mut Context,
    ) {
        let Some(passes) = &mut self.passes else {
            return;
        };

        let before = passes.selected();
        let shows_canvas = command == PassCommand::ShowCanvas;
        passes.apply(command);

        if let Some((name, bytes)) = passes.take_download() {
            context.ask(Effect::Download(NamedBytes { name, bytes }));
        }

        if before != passes.selected()
            && let Some(stage) = passes.whole_stage()
        {
            // A session without events does not have the last iteration as a stage. In its place the stage before it is
            // shown.
            let stages = self.session.iter().flat_map(|session| &session.stages);
            let count = stages.take_while(|&&other| other <= stage).count();
            if count > 0 {
                self.show_stage(count - 1);
            }
        }

        // The passes keep the moment that is shown now, as their buffers stay on the canvas until the timeline leaves
        // it.
        let moment = self.moment();
        if let Some(passes) = &mut self.passes {
            passes.note_moment(moment);
        }

        if shows_canvas {
            self.show_buffers(context);
        }
    }

    /// Opens the canvas, chooses passes as the clock, and flies to the selected row, if there is one.
    fn show_buffers(&mut self, context: &mut Context) {
        context.ask(Effect::Clock(Clock::Pass));
        context.ask(Effect::OpenPanel(Panel::Canvas));
        let position = self.passes.as_ref().and_then(Passes::picked_position);
        if let Some(position) = position {
            // A view of 12 radii shows a sample among all that can conflict with it, with their neighbours.
            self.fly_to(position, 12.0, context);
        }
    }

    /// Returns the rows of the GPU's buffers to show on the canvas. `None` unless the panel of passes is visible, passes are
    /// the clock, or the timeline is at the moment of the last command of the passes.
    #[must_use]
    pub fn buffers_on_canvas(
        &self,
        window: &WindowState,
        look: Look,
        clock: Clock,
    ) -> Option<OnCanvas<'_>> {
        let passes = self.passes.as_ref()?;
        let is_seen = window.shows(Panel::Passes) && !look.is_projector();
        let now = self.moment();
        let is_their_moment = now.is_some() && passes.moment() == now;
        let is_meant = is_seen || is_their_moment || clock == Clock::Pass;
        passes.on_canvas().filter(|_| is_meant)
    }

    /// Runs the passes of the session's parameters on a GPU, to inspect them.
    pub(in crate::state) fn open_passes(&mut self, gpu: &GpuState, context: &mut Context) {
        if gpu.passes_refusal(self).is_some() {
            return;
        }
        let (Some(gpu), Some(session)) = (gpu.device.ready(), &self.session) else {
            return;
        };
        match Passes::new(gpu, &session.run().parameters, &context.wake) {
            Ok(passes) => self.passes = Some(passes),
            Err(refusal) => context.tell_error(sentence(&refusal)),
        }
    }
}
