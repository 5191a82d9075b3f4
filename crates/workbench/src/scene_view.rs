//! The moment and the view of a scene, for pictures of it.

use emath::{Pos2, Rect};
use glam::DVec2;
use tilescope_debugger::{Debugger, Marked, SavedScene};
use tilescope_drawing::camera::Camera;
use tilescope_drawing::orbit::OrbitView;
use tilescope_drawing::picture::{MomentView, PictureView};
use tilescope_session::moment::Moment;
use tilescope_session::selection::Selection;
use tilescope_session::session::Session;
use tilescope_session::units;

use crate::view::{SavedView, SceneCamera};

/// Returns the moment and the view of a scene on a canvas of `size` points; `None` if this run does not have its moment.
pub(crate) fn view_of_scene(
    session: &Session,
    debugger: &Debugger,
    scene: &SavedScene,
    size: [f64; 2],
    dark: bool,
) -> Option<MomentView> {
    let marked = debugger.marked(scene);
    let cursor = marked.cursor()?;
    let is_same_run = matches!(marked, Marked::Here(_));

    // Invalid parts of the view have their defaults, so that their names are not needed.
    let (saved, _invalid) = SavedView::from_json(&scene.view, &SavedView::default());
    let stage = session.stages.get(session.stage_at(cursor));
    let domain = session.size_at(stage.copied());
    let canvas = Rect::from_min_size(Pos2::ZERO, size.map(|side| side as f32).into());

    let place = place_of_scene(debugger, scene);
    // In another run the camera moves with the event, so that it shows the same step of the algorithm. Its `radii` are the length
    // of the canvas's shorter side, in r.
    let camera = SceneCamera::of(&scene.view).and_then(|camera| {
        let center = camera.placed(place, is_same_run)?;
        Camera::checked(center, size[0].min(size[1]) / camera.radii)
    });

    // In another run the selected number is that of another sample.
    let selection = if is_same_run {
        saved.selection
    } else {
        Selection::Nothing
    };

    let view = PictureView {
        camera: camera.unwrap_or_else(|| Camera::fitting(domain, canvas)),
        size,
        chosen_layers: saved.appearance.chosen_layers,
        colouring: saved.appearance.colouring,
        selection,
        dark,
        // An export sets print, legend and analysis itself.
        print: false,
        caption: scene.caption.clone(),
        legend: None,
        analysis: false,
        // The plane is at the same height in another run, too.
        plane: session
            .solid
            .as_ref()
            .zip(saved.plane)
            .map(|(solid, place)| solid.plane_at(place)),
    };

    Some(MomentView {
        moment: Moment::at(session, cursor),
        view,
    })
}

/// Returns the view of a scene that shows the balls of a set in space; `None` if it shows a plane, and for planar sets.
pub(crate) fn orbit_of_scene(session: &Session, scene: &SavedScene) -> Option<OrbitView> {
    // A scene may have come with a session of another set: a planar one has no balls.
    session.solid.as_ref()?;
    let (saved, _invalid) = SavedView::from_json(&scene.view, &SavedView::default());
    saved.orbit
}

/// Returns the place of the event after which a scene stops, in r.
pub(crate) fn place_of_scene(debugger: &Debugger, scene: &SavedScene) -> Option<DVec2> {
    let recording = debugger.recording();
    let last = debugger.marked(scene).cursor()?.checked_sub(1)?;
    let point = recording.event_point(recording.event(last)?)?;
    Some(units::position(point))
}
