//! Whether a learner sees what a question is about: on a canvas as large as in a window, and on one as on a telephone.
//! Begin with [`unseen`].

use crate::control::{MarkKind, Spot};
use crate::draft::Draft;
use crate::error::LessonError;
use crate::lesson::Gate;
use crate::question::Question;
use crate::scene::Scene;
use crate::scene_spec::SceneSpec;
use crate::sets::{PointSet, position, radii};
use crate::text::Text;

/// The canvases, in pixels: beside a lesson in a window, and above one on a telephone.
const CANVASES: [[f64; 2]; 2] = [[800.0, 500.0], [390.0, 300.0]];
/// The smallest distance to the domain's border and to the canvas's edge, in r: what decides about a sample are the
/// samples within 2 r, which are drawn whole.
const MIN_ROOM: f64 = 2.5;
/// The smallest distance to the edge of a canvas that shows less, as a share of its shorter side. A question about one
/// place is shown so near that 2.5 r may be more than half of the picture; a ring and a label need this much.
const MIN_SHARE: f64 = 0.1;
/// The smallest distance of two things that a learner chooses between, in pixels: that of two fingers' targets.
const MIN_APART: f64 = 24.0;

/// A thing that a question names, with its place in r.
struct Named {
    name: String,
    at: [f64; 2],
    /// Whether a learner points at it to answer.
    is_chosen: bool,
    /// Whether the plane through a set in space leaves it out of the picture.
    is_left_out: bool,
}

/// Returns a sentence that says which part of a question is out of sight in its scene, or hard to point at, if one is.
pub(crate) fn unseen(
    spec: &SceneSpec,
    gate: &Gate,
    question: &Question,
    scene: &Scene,
) -> Result<Option<String>, LessonError> {
    if let Some(hidden) = hidden_samples(spec, scene) {
        return Ok(Some(hidden));
    }

    // A trace follows the algorithm from sample to sample, wherever they are, and the camera follows the trace.
    if gate.kind.is_trace() {
        return Ok(None);
    }

    let things = named(gate, question, scene)?;
    if let Some(hidden) = things.iter().find(|thing| thing.is_left_out) {
        let name = &hidden.name;
        return Ok(Some(format!(
            "{name} is farther than r from the plane, which shows nothing of it"
        )));
    }
    if let Some(near) = near_the_border(&things, scene) {
        return Ok(Some(near));
    }

    let camera = scene.camera(&spec.camera)?;
    let domain_size = size_of_domain(scene);

    Ok(CANVASES.iter().find_map(|&canvas| {
        let (center, scale) = match camera {
            // A camera shows `across` r along the shorter side of the canvas.
            Some((center, across)) => (center, canvas[0].min(canvas[1]) / across),
            // Without a camera the whole domain is in the middle of the canvas.
            None => (
                domain_size.map(|side| 0.5 * side),
                fitting(domain_size, canvas),
            ),
        };

        // Where the whole domain is seen, no edge of the canvas cuts anything off.
        let outside = camera.and_then(|_| near_the_edge(&things, center, scale, canvas));
        outside.or_else(|| too_close(&things, scale, canvas))
    }))
}

/// Returns the size of the domain in r.
fn size_of_domain(scene: &Scene) -> [f64; 2] {
    let domain = scene.recording().domain();
    [domain.width(), domain.height()].map(radii)
}

/// Returns the pixels per r at which the whole domain fits a canvas.
fn fitting(size: [f64; 2], canvas: [f64; 2]) -> f64 {
    (canvas[0] / size[0]).min(canvas[1] / size[1])
}

/// Returns a sentence that says which samples the layers of a scene leave out of the picture, if they leave out some
/// that the picture needs.
fn hidden_samples(spec: &SceneSpec, scene: &Scene) -> Option<String> {
    // A scene that names no layers has those of the stage, which the window chooses.
    let layers = spec.layers.as_ref()?;
    let has = |name: &str| layers.iter().any(|layer| layer == name);
    // Trials with learners showed both faults: lines to samples that are not drawn, and holes where inserted ones are.
    if has("conflicts") && !has("samples") {
        return Some(
            "conflicts are drawn without the samples at their ends: add \"samples\" to the layers"
                .to_owned(),
        );
    }

    let set = PointSet::at(scene.recording(), scene.cursor());
    let inserted = set.ids.iter().filter(|&&sample| scene.is_inserted(sample));
    let count = inserted.count();
    let is_hidden = has("samples") && !has("inserted") && count > 0;
    is_hidden.then(|| {
        format!(
            "the picture has holes that are none, as {count} inserted samples are not drawn: add \"inserted\" to the layers"
        )
    })
}

/// Returns all that a question names at places of the domain: in its text, its options and its list, and its key.
fn named(gate: &Gate, question: &Question, scene: &Scene) -> Result<Vec<Named>, LessonError> {
    // Each sample below is one of the run, and so has a point.
    let of_sample = |sample: u32, is_chosen| Named {
        name: format!("sample {sample}"),
        at: scene
            .recording()
            .point(sample)
            .map(position)
            .unwrap_or_default(),
        is_chosen,
        // Of a planar set every sample is seen.
        is_left_out: (scene.now.above(sample.into())).is_ok_and(|above| above.abs() > 1.0),
    };
    let of_place = |name: &str, at, is_chosen| Named {
        name: name.to_owned(),
        at,
        is_chosen,
        is_left_out: false,
    };

    // The right samples and places are among the marks only once the question is answered.
    let is_done = true;
    let (chosen, not_chosen) = (true, false);
    // A learner points at the samples and places of the list. A sample has one mark, whether it is right or not. A
    // right place has another mark besides the one of its place in the list, at which the learner does not point.
    let marks = question
        .interaction
        .marks(&Draft::default(), is_done)
        .into_iter();
    let listed = marks.map(|mark| match (mark.at, mark.kind) {
        (Spot::Sample(sample), _) => of_sample(sample, chosen),
        (Spot::Place(at), MarkKind::Right) => of_place("a right place", at, not_chosen),
        (Spot::Place(at), _) => of_place("a place of the list", at, chosen),
    });

    let mut named: Vec<Named> = listed.collect();
    let marked = question.marked.iter();
    named.extend(marked.map(|&at| of_place("the mark", at, not_chosen)));

    let mut texts: Vec<&Text> = vec![&gate.ask];
    texts.extend(gate.kind.shown());
    for text in texts {
        let samples = scene.samples_in(text)?;
        named.extend(
            samples
                .into_iter()
                .map(|sample| of_sample(sample, not_chosen)),
        );
    }
    Ok(named)
}

/// Returns which thing is nearer to the domain's border than allowed, if one is.
fn near_the_border(named: &[Named], scene: &Scene) -> Option<String> {
    let size = size_of_domain(scene);
    let room = |at: [f64; 2]| {
        let sides = [at[0], at[1], size[0] - at[0], size[1] - at[1]];
        sides.into_iter().fold(f64::INFINITY, f64::min)
    };
    let near = named.iter().find(|thing| room(thing.at) < MIN_ROOM)?;
    let (name, found) = (&near.name, room(near.at));
    Some(format!(
        "{name} is {found:.2} r from the domain's border; it must be {MIN_ROOM} r, so that all around it is drawn"
    ))
}

/// Returns which thing is nearer to the edge of a canvas than allowed, if one is. `scale` is in pixels per r.
fn near_the_edge(
    named: &[Named],
    center: [f64; 2],
    scale: f64,
    canvas: [f64; 2],
) -> Option<String> {
    let [width, height] = canvas;
    // Where the canvas shows less than `MIN_ROOM` asks for, a share of its shorter side has to do.
    let needed = MIN_ROOM.min(MIN_SHARE * width.min(height) / scale);

    let room = |at: [f64; 2]| {
        let sides = [0, 1].map(|axis| 0.5 * canvas[axis] / scale - (at[axis] - center[axis]).abs());
        sides[0].min(sides[1])
    };

    let near = named.iter().find(|thing| room(thing.at) < needed)?;
    let (name, found) = (&near.name, room(near.at));
    Some(format!(
        "{name} is {found:.2} r from the edge of a canvas of {width} x {height}; it must be {needed:.2} r"
    ))
}

/// Returns which two things that a learner chooses between are closer on a canvas than allowed, if any are.
fn too_close(named: &[Named], scale: f64, [width, height]: [f64; 2]) -> Option<String> {
    let chosen: Vec<&Named> = named.iter().filter(|thing| thing.is_chosen).collect();

    for (index, a) in chosen.iter().enumerate() {
        for b in &chosen[..index] {
            let apart = scale * (a.at[0] - b.at[0]).hypot(a.at[1] - b.at[1]);
            if apart < MIN_APART {
                // The inner loop has the earlier one, which is named first.
                let (earlier, later) = (&b.name, &a.name);
                return Some(format!(
                    "{earlier} and {later} are {apart:.1} px apart on a canvas of {width} x {height}; \
                     {MIN_APART} px are needed to choose one of them"
                ));
            }
        }
    }
    None
}
