//! Reads the box and the plane of a step that shows a set in space. Begin with [`space`].

use crate::error::LessonError;
use crate::fields::Fields;
use crate::scene_spec::SceneSpec;

/// The longest third side, in user units: far beyond a box with [`MAX_SAMPLES`], and not infinite.
const DEPTHS: [f64; 2] = [0.0, 1e9];

/// Changes the box of a scene by the fields of its `run` directive.
pub(super) fn space(scene: &mut SceneSpec, fields: &Fields) -> Result<(), LessonError> {
    if let Some(field) = fields.get("depth") {
        scene.depth = match field.value.as_str() {
            "none" => None,
            _ => Some(field.number(DEPTHS)?),
        };
    }

    // Like the camera, the plane is not that of the step before.
    scene.plane = match fields.get("plane") {
        None => None,
        Some(field) if scene.depth.is_none() => {
            return Err(field.wrong("\"plane\" needs \"depth: ...\""));
        }
        Some(field) if field.value == "events" => None,
        Some(field) => Some(field.expression(&[])?),
    };

    // The parameters may have changed, also where the depth stays as the step before set it.
    let wrong = |message: String| LessonError::new(fields.line, message);
    if scene.depth.is_some() && (scene.levels.is_some() || scene.radius.is_some()) {
        let message = "a set in space has one radius and no levels: \"levels: none\" and \"radius-expression: none\" go with a depth";
        return Err(wrong(message.to_owned()));
    }
    match scene.run(None).domain_in_space() {
        Some(made) => made.map(|_| ()).map_err(|error| wrong(error.to_string())),
        None => Ok(()),
    }
}
