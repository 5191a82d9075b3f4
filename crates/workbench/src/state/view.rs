//! The current view as a [`SavedView`], and applying one.

use tilescope_session::layers::SessionKind;
use tilescope_session::recipe::Recipe;
use tilescope_session::selection::Selection;

use super::State;
use crate::command::Which;
use crate::view::SavedView;

impl State {
    /// Returns the current view.
    #[must_use]
    pub fn view(&self) -> SavedView {
        let second = self.runs.second.as_ref().and_then(|(side, _)| {
            let session = side.session.as_ref()?;
            let made = session.own.is_none() && session.kind() == SessionKind::Run;
            made.then_some(session.run().parameters)
        });
        let first = &self.runs.first;
        // The camera of the pattern is not saved, as the pattern has its own domain.
        let (camera, fitted) = first.before_pattern.unwrap_or((first.camera, first.fitted));
        let links = self
            .runs
            .second
            .as_ref()
            .map(|(_, comparison)| comparison.links());
        SavedView {
            camera: (!fitted).then_some(camera),
            appearance: self.appearance.clone(),
            layout: self.layout_to_store().clone(),
            selection: first.selection(),
            playback: self.time.playback.clone(),
            second,
            links: links.unwrap_or_else(|| SavedView::default().links),
        }
    }

    /// Applies a view. Returns the names of the parts that do not fit the current session.
    pub fn look_as(&mut self, view: &SavedView) -> Vec<&'static str> {
        let mut dropped = Vec::new();
        let camera = self.runs.first.camera;
        let camera = view.camera.unwrap_or(camera);
        self.runs.first.take_camera(view.camera, camera);
        self.appearance.take(&view.appearance);
        self.window.layout.clone_from(&view.layout);
        // The passes of the GPU are not saved.
        let clock = view.playback.clock_of_events();
        if self.runs.first.clock_refusal(clock).is_none() {
            self.time.playback.choose(clock);
        } else if clock != self.time.playback.clock_of_events() {
            dropped.push("clock");
        }
        self.time.playback.speed = view.playback.speed;
        self.time.playback.whole_run_secs = view.playback.whole_run_secs;
        if let Some(range) = &view.playback.range {
            if self.cursor().is_some_and(|(_, len)| range.end <= len) {
                self.time.playback.range = Some(range.clone());
            } else {
                dropped.push("range");
            }
        }
        if view.selection != Selection::Nothing {
            if self.runs.first.can_select(view.selection) {
                self.on(Which::First, |run, context| {
                    run.pick(view.selection, context);
                });
            } else {
                dropped.push("selection");
            }
        }
        self.take_second(view);
        dropped
    }

    fn take_second(&mut self, view: &SavedView) {
        self.runs.second = None;
        let Some(parameters) = view.second else {
            return;
        };
        self.compare_with(Recipe::from(parameters), self.gpu.engine);
        if let Some((_, comparison)) = &mut self.runs.second {
            comparison.link(view.links);
        }
    }
}
