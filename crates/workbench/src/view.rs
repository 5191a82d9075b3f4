//! The view of a session, as it is saved with the session: camera, layers, colours, panels, selection, clock, the second
//! run. Views come from untrusted files: each part is checked by itself. `state/view.rs` makes and applies them.

use glam::DVec2;

use serde::{Deserialize, Serialize, de::DeserializeOwned};
use serde_json::{Map, Value, json};
use tilescope_core::{MAXIMAL_DENSITY, Parameters};
use tilescope_debugger::MAX_SAMPLES;
use tilescope_drawing::camera::{Camera, MAX_OFFSET, is_near};
use tilescope_drawing::orbit::OrbitView;
use tilescope_session::layers::{Layer, Layers};
use tilescope_session::selection::Selection;

use crate::appearance::Appearance;
use crate::clock::{Playback, SPEEDS};
use crate::compare::Comparison;
use crate::curve::ShownCurve;
use crate::layout::{Layout, text};

/// The widest view of a scene across its shorter side, in r. It reaches from any valid place to any other, whichever is its middle.
const MAX_RADII: f64 = 4.0 * MAX_OFFSET;

/// Stands for layers that follow the stage.
pub const AUTOMATIC: &str = "automatic";

/// The view of a session: parts of the state.
#[derive(Clone, Debug, PartialEq)]
pub struct SavedView {
    /// The camera; `None` fits the whole domain into any window.
    pub camera: Option<Camera>,
    /// Where the plane through a set in space lies along the third axis, in user units, if it was moved; `None`
    /// where it follows the events, or lies in the middle of the box.
    pub plane: Option<f64>,
    /// From where a set in space is seen as balls, if it is shown so; `None` for a plane through it.
    pub orbit: Option<OrbitView>,
    /// How moments are drawn.
    pub appearance: Appearance,
    /// Where the panels stand.
    pub layout: Layout,
    /// The selected sample or place.
    pub selection: Selection,
    /// The state of playback.
    pub playback: Playback,
    /// The parameters of the second run.
    pub second: Option<Parameters>,
    /// Whether cameras are linked, playback is linked, and differences are marked.
    pub links: [bool; 3],
}

impl Default for SavedView {
    fn default() -> Self {
        Self {
            camera: None,
            plane: None,
            orbit: None,
            appearance: Appearance::default(),
            layout: Layout::default(),
            selection: Selection::Nothing,
            playback: Playback::default(),
            second: None,
            links: Comparison::default().links(),
        }
    }
}

impl SavedView {
    /// Returns the view as JSON.
    #[must_use]
    pub fn to_json(&self) -> Value {
        let appearance = &self.appearance;
        let mut map = Map::new();
        let mut put = |name: &str, value: Value| {
            map.insert(name.to_owned(), value);
        };

        if let Some(camera) = self.camera {
            put("camera", json!(camera));
        }
        put("fitted", json!(self.camera.is_none()));
        if let Some(plane) = self.plane {
            put("plane", json!(plane));
        }
        if let Some(orbit) = self.orbit {
            put("orbit", json!(orbit));
        }

        let names = |layers: Layers| json!(layers.iter().map(Layer::name).collect::<Vec<_>>());
        let layers = appearance.chosen_layers.map(names);
        put("layers", layers.unwrap_or_else(|| json!(AUTOMATIC)));
        put("colouring", json!(appearance.colouring));
        put("look", json!(appearance.look));
        put("curve", json!(appearance.curve));
        put("layout", json!(self.layout));

        if self.selection != Selection::Nothing {
            put("selection", json!(self.selection));
        }

        // The passes of the GPU are not saved, so that a clock of passes is not either.
        put("clock", json!(self.playback.clock_of_events()));
        // A run plays either in a given time or at a given speed.
        match self.playback.whole_run_secs {
            Some(secs) => put("whole-run", json!(secs)),
            None => put("speed", json!(self.playback.speed)),
        }

        if let Some(range) = &self.playback.range {
            put("range", json!([range.start, range.end]));
        }
        if let Some(second) = &self.second {
            put("second", json!(second));
            put("links", json!(self.links));
        }

        Value::Object(map)
    }

    /// Returns the saved view, and the names of its invalid parts. A part that is missing or invalid is taken from
    /// `now`, the current view, with two exceptions: without a valid second run the view has none, and without valid
    /// balls it shows a plane.
    #[must_use]
    pub fn from_json(value: &Value, now: &Self) -> (Self, Vec<&'static str>) {
        let mut parts = Parts {
            value,
            dropped: Vec::new(),
        };

        let mut view = now.clone();
        let camera = parts.take("camera", |Camera { center, scale }| {
            Camera::checked(center, scale)
        });
        // A view that is fitted to the domain needs no camera, even if a file has one. Any other view has the saved camera, or that of
        // `now`.
        match parts.take("fitted", Some) {
            Some(true) => view.camera = None,
            _ => view.camera = camera.or(view.camera),
        }

        // A plane beyond the box is moved to its end where the view is applied.
        let plane = parts.take("plane", |place: f64| place.is_finite().then_some(place));
        view.plane = plane.or(view.plane);
        // A saved view without this part shows a plane.
        view.orbit = parts.take("orbit", |orbit: OrbitView| Some(orbit.within_limits()));

        parts.set(&mut view.appearance.chosen_layers, "layers", layers);
        parts.set(&mut view.appearance.colouring, "colouring", Some);
        parts.set(&mut view.appearance.look, "look", Some);
        parts.set(&mut view.appearance.curve, "curve", |curve: ShownCurve| {
            // A file can state a height beyond the limits.
            Some(curve.within_limits())
        });
        parts.set(&mut view.layout, "layout", |saved: String| {
            text::read(&saved)
        });
        parts.set(&mut view.selection, "selection", selection);

        if let Some(clock) = parts.take("clock", Some) {
            view.playback.choose(clock);
        }
        if let Some(speed) = parts.take("speed", speed) {
            view.playback.choose_speed(speed);
        }
        // The duration is set after the speed, because choosing a speed removes it.
        if let Some(secs) = parts.take("whole-run", whole_run) {
            view.playback.whole_run_secs = Some(secs);
        }

        let range = parts.take("range", |[start, end]: [usize; 2]| {
            (start < end).then_some(start..end)
        });
        view.playback.range = range.or(view.playback.range);

        view.second = parts.take("second", second);
        parts.set(&mut view.links, "links", Some);

        (view, parts.dropped)
    }
}

/// The camera of a scene, in r, whatever the size of the canvas.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SceneCamera {
    /// The width of the view across its shorter side.
    pub radii: f64,
    /// The middle of the view; `None` for the place of the event.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub center: Option<DVec2>,
    /// The place of the event in the run where the scene was made. In another run the view moves with the event.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub event: Option<DVec2>,
}

impl SceneCamera {
    /// Reads the camera of a scene's view; `None` if it has none, which fits the whole domain.
    #[must_use]
    pub fn of(view: &Value) -> Option<Self> {
        Self::deserialize(view.get("camera")?).ok()
    }

    /// Returns the middle of the view where the event is at `event`; `None` if the camera is not valid. In another run than
    /// the scene's own the view moves with the event.
    #[must_use]
    pub fn placed(self, event: Option<DVec2>, is_same_run: bool) -> Option<DVec2> {
        let center = match (self.center, self.event, event) {
            (Some(center), Some(from), Some(to)) if !is_same_run => center + (to - from),
            (Some(center), _, _) => center,
            (None, _, event) => event?,
        };
        let is_valid = is_near(center) && self.radii > 0.0 && self.radii <= MAX_RADII;
        is_valid.then_some(center)
    }
}

struct Parts<'a> {
    value: &'a Value,
    dropped: Vec<&'static str>,
}

impl Parts<'_> {
    /// Returns a part if it is there and `check` accepts it. One that is invalid is added to `dropped`; one that is missing or
    /// null is not.
    fn take<S: DeserializeOwned, T>(
        &mut self,
        name: &'static str,
        check: impl FnOnce(S) -> Option<T>,
    ) -> Option<T> {
        let value = self.value.get(name).filter(|value| !value.is_null())?;
        let taken = serde_json::from_value(value.clone()).ok().and_then(check);
        if taken.is_none() {
            self.dropped.push(name);
        }
        taken
    }

    /// Replaces a value by the saved one, if that is valid.
    fn set<S: DeserializeOwned, T>(
        &mut self,
        value: &mut T,
        name: &'static str,
        check: impl FnOnce(S) -> Option<T>,
    ) {
        if let Some(taken) = self.take(name, check) {
            *value = taken;
        }
    }
}

/// Returns the layers, `None` within for those of the stage. Layers unknown to this version are ignored.
#[allow(clippy::option_option, reason = "the shape of the other parts")]
fn layers(saved: Value) -> Option<Option<Layers>> {
    if saved.as_str() == Some(AUTOMATIC) {
        return Some(None);
    }
    let names: std::collections::HashSet<String> = serde_json::from_value(saved).ok()?;
    let mut layers = Layers::none();
    for layer in Layer::ALL {
        if names.contains(layer.name()) {
            layers.toggle(layer);
        }
    }
    Some(Some(layers))
}

fn selection(saved: Selection) -> Option<Selection> {
    let is_valid = match saved {
        Selection::Nothing => false,
        Selection::Sample(_) => true,
        Selection::Place(place) => is_near(place),
    };
    is_valid.then_some(saved)
}

/// Returns the parameters of a second run from a file, limited like those of a session.
fn second(second: Parameters) -> Option<Parameters> {
    let domain = second.validate_sequential().ok()?;
    (MAXIMAL_DENSITY * domain.area_radii() <= MAX_SAMPLES as f64).then_some(second)
}

/// Returns the speed, if it is between the slowest and the fastest choice.
#[must_use]
pub fn speed(speed: f32) -> Option<f32> {
    let fastest = SPEEDS[SPEEDS.len() - 1];
    (SPEEDS[0]..=fastest).contains(&speed).then_some(speed)
}

/// Returns the duration of a whole run, if it is from a second to an hour.
#[must_use]
pub fn whole_run(secs: f32) -> Option<f32> {
    (1.0..=3600.0).contains(&secs).then_some(secs)
}

#[cfg(test)]
mod tests {
    use tilescope_session::layers::Colouring;
    use tilescope_session::look::Look;

    use super::*;
    use crate::clock::Clock;
    use crate::curve::CurveNumber;

    fn view() -> SavedView {
        let mut view = SavedView {
            camera: Some(Camera {
                center: [3.25, -1.5].into(),
                scale: 12.0,
            }),
            selection: Selection::Place([2.0, 3.0].into()),
            second: Some(Parameters {
                seed: 9,
                ..Parameters::default()
            }),
            links: [true, false, true],
            ..SavedView::default()
        };
        view.appearance.chosen_layers = Some(Layers::none());
        view.appearance.colouring = Colouring::Provenance;
        view.appearance.look = Look::Light;
        view.appearance.curve.number = CurveNumber::of("gaps");
        view.playback.choose(Clock::Line);
        view.playback.choose_speed(8.0);
        view.playback.range = Some(10..20);
        view
    }

    #[test]
    fn views_are_read_as_written() {
        let text = serde_json::to_string(&view().to_json()).unwrap();
        let (back, dropped) =
            SavedView::from_json(&serde_json::from_str(&text).unwrap(), &SavedView::default());
        assert_eq!(back, view());
        assert_eq!(dropped, [""; 0]);
        // Missing parts stay, except the second run.
        let alone = SavedView {
            second: None,
            ..back.clone()
        };
        assert_eq!(SavedView::from_json(&Value::Null, &back), (alone, vec![]));
    }

    #[test]
    fn invalid_parts_are_dropped_by_name_and_the_rest_is_read() {
        let broken = json!({
            "camera": {"center": [0.0, 1e300], "scale": 12.0},
            "layers": ["Samples", "Fireworks"],
            "colouring": "plaid",
            "curve": {"number": "speed", "height": 90},
            "layout": {"root": 7},
            "selection": {"place": [null, 2]},
            "speed": -1.0,
            "range": [20, 10],
            "second": {"radius": 0},
            "clock": "event",
            "unknown": [1, 2, 3],
        });
        let (view, dropped) = SavedView::from_json(&broken, &SavedView::default());
        let expected = [
            "camera",
            "colouring",
            "curve",
            "layout",
            "selection",
            "speed",
            "range",
            "second",
        ];
        assert_eq!(dropped, expected);
        assert_eq!(view.playback.clock, Clock::Event);
        // Twenty million samples are too many for a file to ask for.
        let large = Parameters {
            radius: 0.000_18,
            ..Parameters::default()
        };
        assert!(large.validate_sequential().is_ok());
        let (view_of_large, dropped) =
            SavedView::from_json(&json!({ "second": large }), &SavedView::default());
        assert_eq!((view_of_large.second, dropped), (None, vec!["second"]));
        let layers = view.appearance.layers(None);
        assert!(layers.has(Layer::Samples) && !layers.has(Layer::Blocks));
    }
}
