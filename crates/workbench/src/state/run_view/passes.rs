//! Keeps the passes of a run on the GPU and the timeline in step.

use tilescope_session::incoming::NamedBytes;

use super::RunView;
use crate::passes::PassCommand;
use crate::state::effects::{Context, Effect};

impl RunView {
    /// Moves the passes to the one that ends the stage shown, unless the chosen pass is of that stage, or that
    /// stage is the last complete one after it.
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
        passes.apply(command);
        if let Some((name, bytes)) = passes.take_download() {
            context.ask(Effect::Download(NamedBytes { name, bytes }));
        }
        if before != passes.selected()
            && let Some(stage) = passes.whole_stage()
        {
            // A session without events lacks the last iteration as a stage.
            let stages = self.session.iter().flat_map(|session| &session.stages);
            let count = stages.take_while(|&&other| other <= stage).count();
            if count > 0 {
                self.show_stage(count - 1);
            }
        }
        let moment = self.moment();
        if let Some(passes) = &mut self.passes {
            passes.note_moment(moment);
        }
    }
}
