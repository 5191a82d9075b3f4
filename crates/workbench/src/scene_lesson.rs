//! A lesson made from the scenes of a session: a step for each scene, to be presented, printed, or given questions.

use std::fmt::Write as _;

use tilescope_core::{Boundary, Parameters, PatternSpec, SolidDomain, Stage};
use tilescope_debugger::{SavedScene, Session};
use tilescope_lessons::step_name;
use tilescope_session::layers::Layer;

use crate::scenes::split_caption;
use crate::view::{SavedView, SceneCamera};

/// The longest title, in characters: a longer first sentence becomes a part of the text. Chosen, not measured.
const TITLE: usize = 70;

/// Why the scenes of a run in a field or a shape are no lesson: it would be one of the rectangle.
pub(crate) const NO_GROUND: &str =
    "The run is in a field or a shape, which a lesson of scenes does not name.";

/// Returns the text of a lesson with a step for each scene: the first sentence of its caption as title, the rest as text,
/// and what follows a line of three hyphens as the speaker's note.
///
/// # Errors
///
/// A sentence: no scenes, or a run that a lesson cannot name.
pub(crate) fn lesson_of(
    scenes: &[SavedScene],
    parameters: &Parameters,
    depth: Option<f64>,
    has_own_pattern: bool,
) -> Result<String, String> {
    if scenes.is_empty() {
        let text = "There are no scenes: add some, with captions, and present them then.";
        return Err(text.to_owned());
    }

    // A lesson can choose the side of its pattern, and nothing else of it: its patterns have the usual seed, and are periodic.
    let generated = PatternSpec {
        side: parameters.pattern.side,
        boundary: Boundary::Periodic,
        ..parameters.usual_pattern()
    };
    if has_own_pattern || parameters.pattern != generated {
        let text = "The run has a pattern of its own, which a lesson cannot name: only its side can be chosen there.";
        return Err(text.to_owned());
    }

    let mut text =
        "---\ntitle: Scenes\nobjective: You have seen the scenes of this session.\n".to_owned();
    // A minute for each scene; a lesson may state from 1 to 120 minutes.
    let _ = writeln!(text, "minutes: {}\n---", scenes.len().clamp(1, 120));

    let mut titles: Vec<String> = Vec::new();
    for (index, scene) in scenes.iter().enumerate() {
        let (caption, note) = split_caption(&scene.caption);
        let (sentence, rest) = titled(caption);

        // The name of a step is made from its title, and no two steps may have the same one. A number stands for a title that is
        // empty or taken.
        let name = step_name(&sentence);
        let is_free = |title: &String| {
            !titles
                .iter()
                .any(|other| step_name(other) == step_name(title))
        };
        let own = Some(sentence).filter(|own| !name.is_empty() && is_free(own));
        // An earlier caption may be "Scene 3"; the next number is tried then. The titles so far take at most as many
        // numbers as there are titles, and there is one number more than that, so that one is free.
        let numbers = index + 1..=index + 1 + titles.len();
        let numbered = || {
            let mut all = numbers.map(|number| format!("Scene {number}"));
            all.find(is_free)
        };
        let title = own.or_else(numbered).unwrap_or_default();

        let _ = write!(text, "\n# {title}\n\n```run\n");
        // A step begins with the run of the step before it, so that only the first one needs to name it.
        if index == 0 {
            write_run(&mut text, parameters, depth);
        }
        write_moment(&mut text, scene, depth, parameters.radius);
        text.push_str("```\n");

        for paragraph in paragraphs(&rest) {
            let _ = write!(text, "\n{paragraph}\n");
        }

        let notes = paragraphs(note);
        if !notes.is_empty() {
            let _ = write!(text, "\n```note\n{}\n```\n", notes.join("\n\n"));
        }

        titles.push(title);
    }
    Ok(text)
}

/// Returns the lesson of a saved session's scenes; `text` is the session's file.
///
/// # Errors
///
/// Those of the session's file; a box that cannot be, no scenes, or a run that a lesson cannot name.
pub fn lesson_of_session(text: &str) -> Result<String, String> {
    let saved = Session::from_json(text).map_err(|error| error.to_string())?;
    // A file may have any numbers, but the planes of scenes can be put only within a box that is possible.
    if let Some(depth) = saved.depth {
        let Parameters {
            width,
            height,
            radius,
            boundary,
            ..
        } = saved.parameters;
        SolidDomain::from_size([width, height, depth], radius, boundary)
            .map_err(|error| error.to_string())?;
    }

    if !saved.ground.is_null() {
        return Err(NO_GROUND.to_owned());
    }
    let has_own_pattern = saved.pattern.is_some();
    lesson_of(
        &saved.scenes,
        &saved.parameters,
        saved.depth,
        has_own_pattern,
    )
}

/// Returns the first sentence of a caption without its full stop, and the rest. If the sentence is longer than [`TITLE`], returns no
/// title, and the whole caption as the rest.
fn titled(caption: &str) -> (String, String) {
    let caption = plain(caption);
    let ends = caption.match_indices(['.', '!', '?', '\n']);
    let end = ends
        .map(|(at, mark)| at + mark.len())
        .find(|&at| caption[at..].chars().next().is_none_or(char::is_whitespace));
    let (first, rest) = caption.split_at(end.unwrap_or(caption.len()));
    let first = first.trim().trim_end_matches('.');
    if first.chars().count() > TITLE {
        return (String::new(), caption);
    }
    (first.to_owned(), rest.trim().to_owned())
}

/// Returns a text without the characters that lessons read as marks.
fn plain(text: &str) -> String {
    let lines = text.trim().lines().map(|line| {
        let line = line.trim_start_matches(['#', '`', ' ', '\t']);
        line.replace('{', "(").replace('}', ")")
    });
    lines.collect::<Vec<_>>().join("\n")
}

fn paragraphs(text: &str) -> Vec<String> {
    let text = plain(text);
    let parts = text.split("\n\n").map(|part| part.trim().to_owned());
    parts.filter(|part| !part.is_empty()).collect()
}

/// Writes the parameters of a run, and the third side of a set in space.
fn write_run(text: &mut String, parameters: &Parameters, depth: Option<f64>) {
    for parameter in tilescope_lessons::parameters() {
        let value = match parameter.chosen(parameters) {
            Some(option) => option.name.to_owned(),
            None => parameter.value(parameters).to_string(),
        };
        let _ = writeln!(text, "{}: {value}", parameter.key());
    }
    if let Some(depth) = depth {
        let _ = writeln!(text, "depth: {depth}");
    }
}

/// Writes the moment, the plane, the layers and the camera of a scene. `depth` is the third side of a set in space,
/// `None` for a planar set. It and the radius are in user units.
fn write_moment(text: &mut String, scene: &SavedScene, depth: Option<f64>, radius: f64) {
    let ended_stage = &scene.ends;
    let moment = match (ended_stage, &scene.anchor) {
        // The pattern is made before the first event. A scene with neither a stage nor an anchor is at the start of its
        // run.
        (Some(Stage::Pattern), _) | (None, None) => "start".to_owned(),
        // Only the parallel engine has a stage of regions. A lesson's run is made by the sequential engine, which records events,
        // so that no lesson can name the end of the regions.
        (Some(stage), _) if *stage != Stage::Regions => {
            format!("end of {}", stage.to_string().replace(' ', "-"))
        }
        (_, Some(anchor)) => anchor.to_string(),
        // The end of the regions, without an anchor that says where it is in other runs.
        (Some(_), None) => "start".to_owned(),
    };
    let _ = writeln!(text, "moment: {moment}");

    // Invalid parts of the view have their defaults, so that their names are not needed.
    let (saved, _invalid) = SavedView::from_json(&scene.view, &SavedView::default());
    // If the scene has no plane of its own, its plane follows the events. A step of a lesson that names no plane does
    // so too.
    if let (Some(depth), Some(plane)) = (depth, saved.plane) {
        let place = plane.clamp(0.0, depth) / radius;
        let _ = writeln!(text, "plane: {place:.4}");
    }

    let names = saved.appearance.chosen_layers.map(|layers| {
        let names: Vec<String> = layers.iter().map(Layer::key).collect();
        names.join(" ")
    });
    // A lesson cannot ask for no layers.
    let layers = names.filter(|names| !names.is_empty());
    let _ = writeln!(text, "layers: {}", layers.as_deref().unwrap_or("automatic"));

    let camera = SceneCamera::of(&scene.view);
    // In another run, the camera would move with the scene's event. The lesson makes the run of the scene again, in
    // which that event is where it was.
    let is_same_run = true;
    let placed = camera.and_then(|camera| {
        let center = camera.placed(camera.event, is_same_run)?;
        Some((center, camera.radii))
    });
    if let Some((center, radii)) = placed {
        // A lesson refuses a camera beyond these limits.
        let radii = radii.clamp(2.0, 1_000.0);
        let [x, y] = center.to_array();
        let _ = writeln!(text, "camera: [{x:.4}, {y:.4}] radii {radii:.3}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tilescope_core::TilingMethod;
    use tilescope_lessons::Lesson;

    fn scene(caption: &str, ends: Option<Stage>) -> SavedScene {
        SavedScene {
            caption: caption.to_owned(),
            ends,
            ..SavedScene::default()
        }
    }

    #[test]
    fn each_scene_becomes_a_step_with_its_note() {
        let scenes = [
            scene(
                "The empty domain. Nothing has {happened}.\n---\nAsk for guesses.",
                None,
            ),
            scene("# After tiling", Some(Stage::Tile)),
            scene("", Some(Stage::Iterate(1))),
            scene("after: tiling!", Some(Stage::Finish)),
            scene("冲突在哪里？", Some(Stage::Finish)),
            // The number of the next scene is taken by this one's caption.
            scene("Scene 7", Some(Stage::Finish)),
            scene("", Some(Stage::Finish)),
        ];
        let parameters = Parameters {
            radius: 0.03,
            ..Parameters::default()
        };
        let text = lesson_of(&scenes, &parameters, None, false).unwrap();
        let lesson =
            Lesson::read("scenes", &text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        let titles: Vec<&str> = lesson
            .steps
            .iter()
            .map(|step| step.title.as_str())
            .collect();
        assert_eq!(
            titles,
            [
                "The empty domain",
                "After tiling",
                "Scene 3",
                "Scene 4",
                "冲突在哪里？",
                "Scene 7",
                "Scene 8"
            ]
        );
        assert_eq!(lesson.steps[0].text, ["Nothing has (happened)."]);
        assert_eq!(lesson.steps[0].notes, ["Ask for guesses."]);
        assert_eq!(lesson.steps[3].scene.parameters, parameters);
    }

    /// In exact tiling the usual pattern has the seed of the run.
    #[test]
    fn an_exact_tiling_becomes_a_lesson_with_its_pattern() {
        let mut parameters = Parameters {
            radius: 0.03,
            seed: 5,
            method: TilingMethod::Exact,
            ..Parameters::default()
        };
        parameters.pattern = parameters.usual_pattern();
        let scenes = [scene("A", None)];
        for side in [parameters.pattern.side, 120.0, 100.0] {
            parameters.pattern.side = side;
            let text = lesson_of(&scenes, &parameters, None, false).unwrap();
            let lesson = Lesson::read("scenes", &text).unwrap();
            assert_eq!(lesson.steps[0].scene.run(None).parameters, parameters);
        }

        for (seed, boundary) in [(0, Boundary::Periodic), (5, Boundary::Bounded)] {
            (parameters.pattern.seed, parameters.pattern.boundary) = (seed, boundary);
            assert!(lesson_of(&scenes, &parameters, None, false).is_err());
        }
    }

    #[test]
    fn what_a_lesson_cannot_name_is_refused() {
        let fine = Parameters::default();
        assert!(
            lesson_of(&[], &fine, None, false)
                .unwrap_err()
                .contains("no scenes")
        );
        let scenes = [scene("A", None)];
        assert!(
            lesson_of(&scenes, &fine, None, true)
                .unwrap_err()
                .contains("pattern")
        );
        let mut other = fine;
        other.pattern.seed = 7;
        assert!(
            lesson_of(&scenes, &other, None, false)
                .unwrap_err()
                .contains("pattern")
        );
        assert!(lesson_of(&scenes, &fine, None, false).is_ok());
    }
}
