//! How the session at hand is looked at, as one value, and taking such a value up.

use tilescope_session::recipe::Recipe;
use tilescope_session::selection::Selection;

use super::State;
use crate::command::Which;
use crate::view::View;

impl State {
    /// Returns how the session at hand is looked at.
    #[must_use]
    pub fn view(&self) -> View {
        let second = self.runs.second.as_ref().and_then(|(side, _)| {
            let session = side.session.as_ref()?;
            let made = session.own.is_none() && session.combination.is_none();
            made.then_some(session.run().parameters)
        });
        View {
            // The pattern has a domain of its own, and its camera ends with it.
            camera: Some(
                self.runs
                    .first
                    .before_pattern
                    .map_or(self.runs.first.camera, |(camera, _)| camera),
            ),
            fitted: Some(
                self.runs
                    .first
                    .before_pattern
                    .map_or(self.runs.first.fitted, |(_, fitted)| fitted),
            ),
            layers: Some(self.appearance.layers),
            colouring: Some(self.appearance.colouring),
            look: Some(self.appearance.look),
            layout: Some(self.window.layout.clone()),
            selection: Some(self.runs.first.selection())
                .filter(|selection| *selection != Selection::Nothing),
            // The passes of the GPU are not saved.
            clock: Some(self.time.playback.clock_of_events()),
            speed: Some(self.time.playback.speed),
            range: self
                .time
                .playback
                .range
                .as_ref()
                .map(|range| [range.start, range.end]),
            second,
            links: self.runs.second.as_ref().map(|(_, comparison)| {
                [
                    comparison.linked_cameras,
                    comparison.linked_clocks,
                    comparison.shows_differences,
                ]
            }),
        }
    }

    /// Takes up how a session was looked at; what is not said stays. Returns the names of the parts that the session at
    /// hand does not allow.
    pub fn look_as(&mut self, view: &View) -> Vec<&'static str> {
        let mut dropped = Vec::new();
        if let Some(camera) = view.camera {
            let fitted = view.fitted == Some(true);
            self.runs
                .first
                .take_camera((!fitted).then_some(camera), camera);
        }
        self.appearance.layers = view.layers.unwrap_or(self.appearance.layers);
        self.appearance.colouring = view.colouring.unwrap_or(self.appearance.colouring);
        self.appearance
            .choose_look(view.look.unwrap_or(self.appearance.look));
        if let Some(layout) = &view.layout {
            self.window.layout.clone_from(layout);
        }
        if let Some(clock) = view.clock {
            if self.runs.first.clock_refusal(clock).is_none() {
                self.time.playback.choose(clock);
            } else {
                dropped.push("clock");
            }
        }
        self.time.playback.speed = view.speed.unwrap_or(self.time.playback.speed);
        if let Some([start, end]) = view.range {
            match self.cursor() {
                Some((_, len)) if end <= len => self.time.playback.range = Some(start..end),
                _ => dropped.push("range"),
            }
        }
        if let Some(selection) = view.selection {
            if self.runs.first.can_select(selection) {
                self.on(Which::First, |run, context| run.pick(selection, context));
            } else {
                dropped.push("selection");
            }
        }
        self.take_second(view);
        dropped
    }

    fn take_second(&mut self, view: &View) {
        self.runs.second = None;
        let Some(parameters) = view.second else {
            return;
        };
        let recipe = Recipe {
            parameters,
            own: None,
        };
        self.compare_with(recipe, self.gpu.engine);
        if let (Some([cameras, clocks, marks]), Some((_, comparison))) =
            (view.links, &mut self.runs.second)
        {
            comparison.linked_cameras = cameras;
            comparison.linked_clocks = clocks;
            comparison.shows_differences = marks;
        }
    }
}
