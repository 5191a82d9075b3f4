//! What files say of a picture, and how large one may be. `drawing/src/picture.rs` draws it.

use serde_json::json;
use tilescope_drawing::brushed::BrushedCause;
use tilescope_drawing::picture::{self, MomentView, PictureView};
use tilescope_figures::animation::MAX_FRAME_PIXELS;
use tilescope_figures::{MAX_PIXELS, MAX_SIDE, Scene};
use tilescope_session::layers::{Layer, Layers};
use tilescope_session::session::Session;

use super::provenance::provenance;
use super::refusal::ExportRefusal;

/// The most samples that a picture draws. Chosen, not measured.
pub const MAX_DRAWN: usize = 1_000_000;

/// Returns the picture of a moment, with the run's parameters in its metadata.
#[must_use]
pub fn scene(session: &Session, shown: &MomentView, causes: Option<&BrushedCause>) -> Scene {
    let MomentView { moment, view } = shown;
    let mut scene = picture::scene(session, shown, causes);
    scene.metadata = provenance(session);
    let described_moment = moment.description(session).to_string();
    scene.metadata.push(("Moment".to_owned(), described_moment));
    scene.metadata.push(("View".to_owned(), described(view)));
    if !view.caption.is_empty() {
        let caption = ("Caption".to_owned(), view.caption.clone());
        scene.metadata.push(caption);
    }
    scene
}

/// Returns the description of a view for files, as a JSON object.
#[must_use]
pub fn described(view: &PictureView) -> String {
    let named = |layers: Layers| json!(layers.iter().map(Layer::name).collect::<Vec<_>>());
    let layers = view.chosen_layers.map(named);
    json!({
        "center_radii": view.camera.center,
        "points_per_radius": view.camera.scale,
        "size_points": view.size,
        "layers": layers.unwrap_or_else(|| json!("those of the stage")),
        "colouring": view.colouring,
        "selection": view.selection,
        "analysis": view.analysis,
        "palette": if view.is_dark() { "dark" } else { "light" },
    })
    .to_string()
}

/// Returns why a picture, or a frame of an animation, of this size is refused.
pub(crate) fn size_refusal(
    view: &PictureView,
    scale: f64,
    animated: bool,
) -> Option<ExportRefusal> {
    let [width, height] = view.pixels(scale);

    let most = if animated {
        MAX_FRAME_PIXELS
    } else {
        MAX_PIXELS
    };

    let (most_pixels, longest_side) = (most as usize, MAX_SIDE as usize);
    let fits = width.max(height) <= longest_side && width.saturating_mul(height) <= most_pixels;
    (!fits).then_some(ExportRefusal::TooLarge {
        width,
        height,
        pixels: most_pixels,
        side: longest_side,
    })
}
