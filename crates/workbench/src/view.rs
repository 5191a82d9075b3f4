//! How a session is looked at, as it is saved with it: camera, layers, colours, panels, selection, clock, the second run.
//! What is read may come from anywhere: each part counts only if it makes sense.

use serde::{Deserialize, Serialize, de::DeserializeOwned};
use serde_json::{Map, Value};
use tilescope_core::{MAXIMAL_DENSITY, Parameters};
use tilescope_debugger::MAX_SAMPLES;
use tilescope_session::layers::{Colouring, Layer, Layers};
use tilescope_session::look::Look;
use tilescope_session::selection::Selection;

use crate::clock::{Clock, SPEEDS};
use crate::layout::{Layout, OldLayout, text};
use tilescope_drawing::camera::{Camera, MAX_SCALE, MIN_SCALE};

/// Farther from the origin than this, in r, there is no domain.
pub const FARTHEST: f64 = 200_000.0;

/// What is saved. A part that is missing stays as it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct View {
    /// The view of the domain.
    pub camera: Option<Camera>,
    /// Whether it shows the whole domain, however large the window is.
    pub fitted: Option<bool>,
    /// The layers that are on.
    pub layers: Option<Layers>,
    /// What colours mean.
    pub colouring: Option<Colouring>,
    /// The look.
    pub look: Option<Look>,
    /// Where the panels stand.
    pub layout: Option<Layout>,
    /// What is selected.
    pub selection: Option<Selection>,
    /// What a tick is.
    pub clock: Option<Clock>,
    /// How fast time runs.
    pub speed: Option<f32>,
    /// The cursors between which play goes round.
    pub range: Option<[usize; 2]>,
    /// What the run beside this one is made from.
    pub second: Option<Parameters>,
    /// Whether cameras move together, clocks run together, and differences are marked.
    pub links: Option<[bool; 3]>,
}

#[derive(Clone, Copy, Serialize, Deserialize)]
struct SavedCamera {
    center: [f64; 2],
    scale: f64,
}

#[derive(Clone, Copy, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum SavedSelection {
    Sample(u32),
    Place([f64; 2]),
}

impl View {
    /// Returns what is written.
    #[must_use]
    pub fn to_json(&self) -> Value {
        let mut map = Map::new();
        let mut put = |name: &str, value: Option<Value>| {
            if let Some(value) = value {
                map.insert(name.to_owned(), value);
            }
        };
        let camera = self.camera.map(|camera| SavedCamera {
            center: camera.center,
            scale: camera.scale,
        });
        put("camera", json(camera.as_ref()));
        let names = |layers: Layers| -> Vec<&str> {
            let on = Layer::ALL.into_iter().filter(|layer| layers.has(*layer));
            on.map(Layer::name).collect()
        };
        put("fitted", json(self.fitted.as_ref()));
        put("layers", json(self.layers.map(names).as_ref()));
        put("colouring", json(self.colouring.as_ref()));
        put("look", json(self.look.as_ref()));
        put("layout", json(self.layout.as_ref()));
        let selection = self.selection.and_then(|selection| match selection {
            Selection::Nothing => None,
            Selection::Sample(id) => Some(SavedSelection::Sample(id)),
            Selection::Place(place) => Some(SavedSelection::Place(place)),
        });
        put("selection", json(selection.as_ref()));
        put("clock", json(self.clock.as_ref()));
        put("speed", json(self.speed.as_ref()));
        put("range", json(self.range.as_ref()));
        put("second", json(self.second.as_ref()));
        put("links", json(self.links.as_ref()));
        Value::Object(map)
    }

    /// Returns what a saved view means, and the names of the parts that make no sense.
    #[must_use]
    pub fn from_json(value: &Value) -> (Self, Vec<&'static str>) {
        let mut parts = Parts {
            value,
            dropped: Vec::new(),
        };
        let view = Self {
            camera: parts.take("camera", camera),
            fitted: parts.take("fitted", Some),
            layers: parts.take("layers", layers),
            colouring: parts.take("colouring", Some),
            look: parts.take("look", Some),
            layout: parts.take("layout", layout),
            selection: parts.take("selection", selection),
            clock: parts.take("clock", Some),
            speed: parts.take("speed", speed),
            range: parts.take("range", |range: [usize; 2]| {
                (range[0] < range[1]).then_some(range)
            }),
            second: parts.take("second", second),
            links: parts.take("links", Some),
        };
        (view, parts.dropped)
    }
}

fn json<T: Serialize>(value: Option<&T>) -> Option<Value> {
    serde_json::to_value(value?).ok()
}

struct Parts<'a> {
    value: &'a Value,
    dropped: Vec<&'static str>,
}

impl Parts<'_> {
    fn take<S: DeserializeOwned, T>(
        &mut self,
        name: &'static str,
        sense: impl FnOnce(S) -> Option<T>,
    ) -> Option<T> {
        let value = self.value.get(name).filter(|value| !value.is_null())?;
        let taken = serde_json::from_value(value.clone()).ok().and_then(sense);
        if taken.is_none() {
            self.dropped.push(name);
        }
        taken
    }
}

fn camera(saved: SavedCamera) -> Option<Camera> {
    sound_camera(saved.center, saved.scale)
}

/// Returns the camera at `center`, in r, with `scale` screen points per r, if there may be one.
pub fn sound_camera(center: [f64; 2], scale: f64) -> Option<Camera> {
    let may_be = is_near(center) && (MIN_SCALE..=MAX_SCALE).contains(&scale);
    may_be.then_some(Camera { center, scale })
}

/// Returns whether there are domains that reach as far as `place`, in r.
pub fn is_near(place: [f64; 2]) -> bool {
    place.iter().all(|x| x.abs() <= FARTHEST)
}

/// Earlier versions saved a layout in another form.
fn layout(saved: Value) -> Option<Layout> {
    match saved {
        Value::String(text) => text::read(&text),
        old => serde_json::from_value::<OldLayout>(old).ok()?.completed(),
    }
}

/// Layers that this version does not know are passed over.
#[allow(clippy::unnecessary_wraps, reason = "the shape of the other parts")]
fn layers(names: Vec<String>) -> Option<Layers> {
    let mut layers = Layers::none();
    let names: std::collections::HashSet<String> = names.into_iter().collect();
    for layer in Layer::ALL {
        if names.contains(layer.name()) {
            layers.toggle(layer);
        }
    }
    Some(layers)
}

fn selection(saved: SavedSelection) -> Option<Selection> {
    match saved {
        SavedSelection::Sample(id) => Some(Selection::Sample(id)),
        SavedSelection::Place(place) => is_near(place).then_some(Selection::Place(place)),
    }
}

/// A run that is sampled because a file says so is no larger than a session may be.
fn second(second: Parameters) -> Option<Parameters> {
    let domain = second.validate_sequential().ok()?;
    (MAXIMAL_DENSITY * domain.area_radii() <= MAX_SAMPLES as f64).then_some(second)
}

/// Returns the speed, if it is between the slowest and the fastest to choose.
pub fn speed(speed: f32) -> Option<f32> {
    let fastest = SPEEDS[SPEEDS.len() - 1];
    (SPEEDS[0]..=fastest).contains(&speed).then_some(speed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn view() -> View {
        let mut layers = Layers::default();
        layers.toggle(Layer::Disks);
        View {
            camera: Some(Camera {
                center: [3.25, -1.5],
                scale: 12.0,
            }),
            layers: Some(layers),
            colouring: Some(Colouring::Provenance),
            look: Some(Look::Light),
            layout: Some(Layout::default()),
            selection: Some(Selection::Place([2.0, 3.0])),
            clock: Some(Clock::Line),
            speed: Some(8.0),
            range: Some([10, 20]),
            second: Some(Parameters {
                seed: 9,
                ..Parameters::default()
            }),
            fitted: Some(false),
            links: Some([true, false, true]),
        }
    }

    #[test]
    fn what_is_written_is_read() {
        let text = serde_json::to_string(&view().to_json()).unwrap();
        let (back, dropped) = View::from_json(&serde_json::from_str(&text).unwrap());
        assert_eq!(back, view());
        assert_eq!(dropped, [""; 0]);
        assert_eq!(View::from_json(&Value::Null), (View::default(), vec![]));
    }

    #[test]
    fn what_makes_no_sense_is_dropped_by_name_and_the_rest_counts() {
        let broken = json!({
            "camera": {"center": [0.0, 1e300], "scale": 12.0},
            "layers": ["Samples", "Fireworks"],
            "colouring": "plaid",
            "layout": {"root": 7},
            "selection": {"place": [null, 2]},
            "speed": -1.0,
            "range": [20, 10],
            "second": {"radius": 0},
            "clock": "event",
            "unknown": [1, 2, 3],
        });
        let (view, dropped) = View::from_json(&broken);
        let expected = [
            "camera",
            "colouring",
            "layout",
            "selection",
            "speed",
            "range",
            "second",
        ];
        assert_eq!(dropped, expected);
        assert_eq!(view.clock, Some(Clock::Event));
        // Twenty million samples are too many for a file to ask for.
        let large = Parameters {
            radius: 0.000_18,
            ..Parameters::default()
        };
        assert!(large.validate_sequential().is_ok());
        let (view_of_large, dropped) = View::from_json(&json!({ "second": large }));
        assert_eq!((view_of_large.second, dropped), (None, vec!["second"]));
        let layers = view.layers.unwrap();
        assert!(layers.has(Layer::Samples) && !layers.has(Layer::Blocks));
    }
}
