//! The view in the state: makes the one that is saved, and applies one. Sessions that are opened are shown by it.

use tilescope_core::Parameters;
use tilescope_session::recipe::Recipe;
use tilescope_session::selection::Selection;

use super::effects::{Context, Effect};
use super::{Runs, State, Time};
use crate::device::EngineChoice;
use crate::orbit::RunOrbit;
use crate::view::SavedView;

impl Runs {
    /// Returns the parameters of the second run, if it is made of parameters alone.
    pub(super) fn second_parameters(&self) -> Option<Parameters> {
        let session = self.second.as_ref()?.0.session.as_ref()?;
        let is_of_parameters = session.own.is_none() && session.ground.is_none();
        let made = is_of_parameters && session.kind().is_run();
        made.then_some(session.run().parameters)
    }
}

impl SavedView {
    /// Returns the current view of a window.
    #[must_use]
    pub fn of(state: &State) -> Self {
        let runs = &state.runs;
        let first = &runs.first;
        // While the pattern is shown, its camera is not saved, as the pattern has a domain of its own: the camera to
        // return to is.
        let (camera, fitted) = first.before_pattern.unwrap_or((first.camera, first.fitted));
        let second = runs.second.as_ref();
        // Without a second run the view states the links that every new comparison begins with.
        let links = second.map(|(_, comparison)| comparison.links());
        Self {
            camera: (!fitted).then_some(camera),
            plane: first.moved_plane(),
            orbit: first.orbit().map(RunOrbit::view),
            appearance: state.appearance.clone(),
            layout: state.past.layout_to_store(&state.window).clone(),
            selection: first.selection(),
            playback: state.time.playback.clone(),
            second: runs.second_parameters(),
            links: links.unwrap_or_else(|| Self::default().links),
        }
    }

    /// Applies the view to runs and playback; the second run is made by `engine`. Returns the names of the parts that do not
    /// fit the current session.
    pub(super) fn apply(
        &self,
        runs: &mut Runs,
        time: &mut Time,
        engine: EngineChoice,
        context: &mut Context,
    ) -> Vec<&'static str> {
        let mut dropped = Vec::new();
        context.ask(Effect::Appearance(Box::new(self.appearance.clone())));
        context.ask(Effect::Curve(self.appearance.curve));
        context.ask(Effect::Layout(self.layout.clone()));

        let run = &mut runs.first;
        // A view without a camera is fitted into the canvas. Until there is a canvas, the camera stays as it is.
        let without_canvas = self.camera.unwrap_or(run.camera);
        run.take_camera(self.camera, without_canvas);
        if let Some(place) = self.plane {
            if run.plane().is_some() {
                run.show_plane(place, context);
            } else {
                dropped.push("plane");
            }
        }
        if !run.take_orbit(self.orbit) {
            dropped.push("orbit");
        }

        // The passes of the GPU are not saved, so that a clock of passes is not applied.
        let clock = self.playback.clock_of_events();
        if run.clock_refusal(clock).is_none() {
            time.playback.choose(clock);
        } else if clock != time.playback.clock_of_events() {
            // A refused clock is a loss only if it is not the clock that the window has.
            dropped.push("clock");
        }
        time.playback.speed = self.playback.speed;
        time.playback.whole_run_secs = self.playback.whole_run_secs;

        // A loop or a selection may be beyond the end of this run. Where the view has none, those of the window stay.
        if let Some(range) = &self.playback.range {
            if run.cursor().is_some_and(|(_, len)| range.end <= len) {
                time.playback.range = Some(range.clone());
            } else {
                dropped.push("range");
            }
        }

        if self.selection != Selection::Nothing {
            if run.can_select(self.selection) {
                run.pick(self.selection, context);
            } else {
                dropped.push("selection");
            }
        }

        runs.second = None;
        if let Some(parameters) = self.second {
            runs.compare_with(Recipe::from(parameters), engine, context);
            if let Some((_, comparison)) = &mut runs.second {
                comparison.link(self.links);
            }
        }
        dropped
    }
}
