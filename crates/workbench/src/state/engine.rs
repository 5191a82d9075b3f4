//! Starts making runs and combinations. `state/gpu.rs` chooses the engine.

use std::sync::Arc;

use tilescope_core::combine::file::Layout;
use tilescope_gpu::Gpu;
use tilescope_session::combination::{CombineCommand, NINE};
use tilescope_session::combining::CombineTask;
use tilescope_session::jobs::Job;
use tilescope_session::recipe::Recipe;
use tilescope_session::sampling::SampleTask;
use tilescope_session::task;
use tilescope_session::words::sentence;

use super::effects::{Context, Effect};
use super::undo::Made;
use super::{Runs, Which};
use crate::rules::UndoPart;

/// The refusal of commands that need a run's parameters.
pub(super) const NO_PARAMETERS: &str =
    "A combination is made from a layout and has no parameters to change.";

impl Runs {
    /// Starts a run of `recipe`, on a GPU if one is given and makes such runs.
    pub(super) fn sample(
        &mut self,
        which: Which,
        recipe: Recipe,
        gpu: Option<Arc<Gpu>>,
        context: &mut Context,
    ) {
        let generation = context.next_generation();
        // Nested levels, and sets in a field, a shape or space, are made on the CPU.
        let is_tiled = recipe.nested.is_none() && recipe.ground.is_none() && recipe.depth.is_none();
        let job = match gpu.filter(|_| is_tiled) {
            Some(gpu) => Job::start_future(&context.wake, move |monitor| async move {
                tilescope_session::sampling::on_gpu(gpu, &recipe, generation, &monitor).await
            }),
            None => task::start(&context.wake, SampleTask { recipe, generation }),
        };

        // If there is no second run, a job for it is dropped, which stops it.
        if let Some(run) = self.get_mut(which) {
            run.sampling = Some(job);
        }
    }

    /// Asks for the combination of a layout, or shows the fault of the layout.
    pub(super) fn read_layout(&mut self, command: CombineCommand, context: &mut Context) {
        let text = match command {
            CombineCommand::Nine => NINE.to_owned(),
            CombineCommand::Text(text) => text,
        };
        context.ask(Effect::CloseNotice);

        match Layout::from_json(text.as_bytes()) {
            Ok(layout) => {
                // A link that waits for its run would wait in vain: the combination takes the run's place.
                self.arriving = None;
                context.ask(Effect::RememberRun(UndoPart::Run));
                context.ask(Effect::Make(Box::new(Made::Combination(layout))));
            }
            Err(error) => context.tell_error(sentence(&error.to_string())),
        }
    }

    /// Starts making a combination; the current session stays until it is ready.
    pub(super) fn combine(&mut self, layout: Layout, context: &mut Context) {
        let generation = context.next_generation();
        let combining = CombineTask { layout, generation };
        self.first.sampling = Some(task::start(&context.wake, combining));
    }

    /// Stops making a run, and drops the link that waits for it.
    pub(super) fn stop_making(&mut self) {
        (self.first.sampling, self.arriving) = (None, None);
    }
}
