//! How the session at hand is looked at, as one value, and taking such a value up.

use super::State;
use crate::command::{DebugCommand, Selection};
use crate::recipe::Recipe;
use crate::view::View;

impl State {
    /// Returns how the session at hand is looked at.
    #[must_use]
    pub fn view(&self) -> View {
        let second = self.comparison.as_ref().and_then(|(side, _)| {
            let session = side.session.as_ref()?;
            session.own.is_none().then_some(session.run().parameters)
        });
        View {
            camera: Some(self.camera),
            layers: Some(self.layers),
            colouring: Some(self.colouring),
            look: Some(self.look),
            layout: Some(self.layout.clone()),
            selection: self
                .selected
                .map(Selection::Sample)
                .or(self.place.map(Selection::Place)),
            clock: Some(self.playback.clock),
            speed: Some(self.playback.speed),
            range: self
                .playback
                .range
                .as_ref()
                .map(|range| [range.start, range.end]),
            second,
        }
    }

    /// Takes up how a session was looked at; what is not said stays. Returns the names of the parts that the session at
    /// hand does not allow.
    pub fn look_as(&mut self, view: View) -> Vec<&'static str> {
        let mut dropped = Vec::new();
        if let Some(camera) = view.camera {
            (self.camera, self.flight, self.fitted) = (camera, None, false);
            self.before_pattern = None;
        }
        self.layers = view.layers.unwrap_or(self.layers);
        self.colouring = view.colouring.unwrap_or(self.colouring);
        self.look = view.look.unwrap_or(self.look);
        if let Some(layout) = view.layout {
            self.layout = layout;
        }
        if let Some(clock) = view.clock {
            if self.clock_refusal(clock).is_none() {
                self.playback.clock = clock;
            } else {
                dropped.push("clock");
            }
        }
        self.playback.speed = view.speed.unwrap_or(self.playback.speed);
        if let Some([start, end]) = view.range {
            match self.cursor() {
                Some((_, len)) if end <= len => self.playback.range = Some(start..end),
                _ => dropped.push("range"),
            }
        }
        if let Some(selection) = view.selection {
            let samples = self
                .session
                .as_ref()
                .map_or(0, |session| session.run().samples.len());
            match selection {
                Selection::Sample(id) if id as usize >= samples => dropped.push("selection"),
                selection => self.apply_to_debugger(DebugCommand::Pick(selection)),
            }
        }
        self.comparison = None;
        if let Some(parameters) = view.second {
            self.compare_with(
                Recipe {
                    parameters,
                    own: None,
                },
                self.engine,
            );
        }
        dropped
    }
}
