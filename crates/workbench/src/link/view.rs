//! Parts of a view in links: layers, selections, and the views of scenes.

use glam::DVec2;
use serde_json::{Map, Value, json};
use tilescope_drawing::camera::is_near;
use tilescope_session::layers::{Layer, Layers};
use tilescope_session::look::Look;
use tilescope_session::selection::Selection;

use super::read::COLOURINGS;
use super::text::{exact, finite, name, named, numbers, rounded};
use crate::view::{SavedView, SceneCamera};

/// Returns layers as a list of their names.
pub(super) fn layers_text(layers: Layers) -> String {
    layers.iter().map(Layer::key).collect::<Vec<_>>().join(",")
}

/// Returns the layers of a list, and the unknown names in it. If all names are unknown, the layers are `None`, those of the
/// stage: that is closer to the intention than an empty canvas.
pub(super) fn read_layers(names: &str) -> (Option<Layers>, Vec<&str>) {
    let (mut layers, mut unknown) = (Layers::none(), Vec::new());
    for name in names.split(',').filter(|name| !name.is_empty()) {
        match Layer::ALL.into_iter().find(|&l| l.key() == name) {
            Some(layer) if !layers.has(layer) => layers.toggle(layer),
            Some(_) => {}
            None => unknown.push(name),
        }
    }
    let is_lost = !unknown.is_empty() && layers == Layers::none();
    ((!is_lost).then_some(layers), unknown)
}

/// Returns a selection as text; `None` if nothing is selected.
pub(super) fn selection_text(selection: Selection) -> Option<String> {
    match selection {
        Selection::Nothing => None,
        Selection::Sample(id) => Some(format!("sample:{id}")),
        Selection::Place(place) => {
            let [x, y] = place.to_array().map(exact);
            Some(format!("place:{x},{y}"))
        }
    }
}

/// Reads a selection, as [`selection_text`] writes it.
pub(super) fn read_selection(text: &str) -> Option<Selection> {
    match text.split_once(':')? {
        ("sample", id) => id.parse().ok().map(Selection::Sample),
        ("place", place) => numbers(place)
            .map(DVec2::from)
            .filter(|place| is_near(*place))
            .map(Selection::Place),
        _ => None,
    }
}

/// Stands for a scene without a view.
const NO_VIEW: &str = "-";

/// Returns the view of a scene as text, without the layout of its panels: the parts that differ from those of a new
/// window, with slashes between them. The text has letters, digits and `-._~:,/` only.
pub(super) fn scene_view_text(view: &Value) -> String {
    if view.is_null() {
        return NO_VIEW.to_owned();
    }

    // A reader begins with the view of a new window, so that parts that are the same can be left out.
    let new_window = SavedView::default();
    // Invalid parts of the view are those of a new window, so that their names are not needed.
    let (saved, _invalid) = SavedView::from_json(view, &new_window);
    let mut parts = Vec::new();

    if let Some(camera) = SceneCamera::of(view) {
        let mut numbers = vec![rounded(camera.radii)];
        if let Some(center) = camera.center {
            numbers.extend(center.to_array().map(rounded));
            // A link has the place of the event behind the middle, and so only together with a middle. A view without
            // a middle does not need that place: the event is then the middle, wherever it is in the run that is
            // shown.
            let event = camera.event.map(|event| event.to_array().map(exact));
            numbers.extend(event.into_iter().flatten());
        }
        parts.push(format!("camera:{}", numbers.join(",")));
    }

    if let Some(layers) = saved.appearance.chosen_layers {
        parts.push(format!("layers:{}", layers_text(layers)));
    }
    if saved.appearance.colouring != new_window.appearance.colouring {
        parts.push(format!("colouring:{}", name(&saved.appearance.colouring)));
    }
    if saved.appearance.look != new_window.appearance.look {
        parts.push(format!("look:{}", name(&saved.appearance.look)));
    }

    if let Some(selection) = selection_text(saved.selection) {
        parts.push(format!("select:{selection}"));
    }

    parts.join("/")
}

/// Reads the view of a scene; `None` if a part of it is invalid. Unknown layers are left out.
pub(super) fn read_scene_view(text: &str) -> Option<Value> {
    if text == NO_VIEW {
        return Some(Value::Null);
    }

    let mut view = SavedView::default();
    let mut camera = None;
    for part in text.split('/').filter(|part| !part.is_empty()) {
        let (key, value) = part.split_once(':')?;
        match key {
            "camera" => camera = Some(read_camera(value)?),
            "layers" => {
                let (layers, _unknown) = read_layers(value);
                view.appearance.chosen_layers = layers;
            }
            "colouring" => view.appearance.colouring = named(&COLOURINGS, value)?,
            "look" => view.appearance.look = named(&Look::ALL, value)?,
            "select" => view.selection = read_selection(value)?,
            _ => return None,
        }
    }

    let mut parts: Map<String, Value> = view.to_json().as_object().cloned()?;
    // `to_json` writes the whole view; a scene in a link keeps only these parts of it.
    parts.retain(|name, _| matches!(&**name, "layers" | "colouring" | "look" | "selection"));
    if let Some(camera) = camera {
        parts.insert("camera".to_owned(), json!(camera));
    }

    Some(Value::Object(parts))
}

/// Reads the width of a view in r, perhaps its middle, and behind a middle perhaps the place of its event. `None` if a
/// number is invalid, or is none of these.
fn read_camera(text: &str) -> Option<SceneCamera> {
    // One number more than a camera can have, so that a longer list is refused.
    let numbers: Vec<f64> = text.split(',').take(6).map(finite).collect::<Option<_>>()?;
    let place = |at: usize| {
        let place = DVec2::from_slice(numbers.get(at..at + 2)?);
        is_near(place).then_some(place)
    };
    let camera = SceneCamera {
        radii: *numbers.first()?,
        center: place(1),
        event: place(3),
    };
    let places = [camera.center, camera.event].into_iter().flatten().count();
    // A place that is incomplete or too far away is not counted in `places`. Its numbers are then too many, and the
    // camera is invalid.
    let is_valid = numbers.len() == 1 + 2 * places && camera.radii > 0.0;
    is_valid.then_some(camera)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_of_scenes_are_read_as_they_were_written() {
        for text in [
            "-",
            "",
            "camera:26,60,60",
            "camera:26",
            "camera:9,30.5,-2,31,1.25/layers:samples,gaps/colouring:age/look:projector-dark/select:sample:7",
            "layers:/select:place:1.5,2",
        ] {
            let view = read_scene_view(text).expect(text);
            assert_eq!(scene_view_text(&view), text);
        }
        // A view that is where its event is has no middle, and a link then no place.
        let at_event = json!({"camera": {"radii": 12.0, "event": [1.0, 2.0]}});
        assert_eq!(scene_view_text(&at_event), "camera:12");
        let view = read_scene_view("layers:samples,fireworks").unwrap();
        assert_eq!(view["layers"], json!(["Samples"]));
        for text in [
            "camera",
            "camera:0,1,1",
            "camera:5,1",
            "camera:5,1e9,1",
            "camera:5,1,1,1,1,1",
            "look:plaid",
            "select:block:1",
            "speed:1",
        ] {
            assert_eq!(read_scene_view(text), None, "{text}");
        }
    }
}
