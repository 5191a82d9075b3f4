//! What several panels share: scrolling, lines between sections, remarks, pictures as textures.

use std::sync::Arc;

use egui::{ColorImage, Id, ScrollArea, TextureHandle, TextureOptions, Ui};
use tilescope_drawing::palette::Palette;
use tilescope_ui::focus;
use tilescope_ui::widgets::Known;

use super::context::PanelContext;
use crate::actions::NO_EVENTS_OF_LEVELS;
use tilescope_workbench::layout::Panel;
use tilescope_workbench::thumbnails::Thumbnail;

/// Shows the content of a panel, which scrolls independently of other panels of the same tab.
pub fn scrolled(ui: &mut Ui, panel: Panel, add: impl FnOnce(&mut Ui)) {
    ScrollArea::vertical()
        .id_salt(panel.name())
        .auto_shrink([false, false])
        .show(ui, |ui| {
            ui.set_max_width(ui.available_width() - 12.0);
            add(ui);
            focus::follow(ui);
        });
}

/// Draws a thin line between two sections.
pub fn divide(ui: &mut Ui, palette: &Palette) {
    ui.add_space(10.0);
    let (rect, _) =
        ui.allocate_exact_size(egui::vec2(ui.available_width(), 1.0), egui::Sense::hover());
    ui.painter().rect_filled(rect, 0.0, palette.line);
    ui.add_space(6.0);
}

/// Shows why the session has no events.
pub fn no_events(ui: &mut Ui, context: &PanelContext<'_>) {
    let text = match &context.run.session {
        None => "There is no session yet.".to_owned(),
        Some(session) if session.combination.is_some() => {
            "A combination has stages but no events: its sets existed before.".to_owned()
        }
        Some(session) if session.nested.is_some() => NO_EVENTS_OF_LEVELS.to_owned(),
        Some(session) if session.has_stages() => {
            "The GPU's run differs from the CPU's, so that it has no events.".to_owned()
        }
        Some(_) => format!(
            "A run of more than {} samples keeps its result alone: there are no events to step through.",
            tilescope_session::words::grouped(tilescope_session::limits::MAX_STAGED as usize)
        ),
    };
    ui.label(egui::RichText::new(text).color(context.palette.muted))
        .known_as("no-events");
}

/// Returns the texture of a picture, which is kept under `id` until another picture is given.
pub fn texture_of<T: Send + Sync + 'static>(
    ui: &Ui,
    id: Id,
    picture: &Arc<T>,
    options: TextureOptions,
    image: impl FnOnce(&T) -> ColorImage,
) -> TextureHandle {
    let kept: Option<(Arc<T>, TextureHandle)> = ui.data(|data| data.get_temp(id));
    if let Some((_, texture)) = kept.filter(|(of, _)| Arc::ptr_eq(of, picture)) {
        return texture;
    }
    let texture = ui.ctx().load_texture("picture", image(picture), options);
    ui.data_mut(|data| data.insert_temp(id, (Arc::clone(picture), texture.clone())));
    texture
}

/// Returns the texture of a small picture, as [`texture_of`] does.
pub fn thumbnail_texture(ui: &Ui, id: Id, thumbnail: &Arc<Thumbnail>) -> TextureHandle {
    texture_of(ui, id, thumbnail, TextureOptions::LINEAR, |picture| {
        ColorImage::from_rgba_unmultiplied(picture.size, &picture.rgba)
    })
}

/// Has screen readers announce the text of a label whenever it changes.
pub fn read_out(ui: &Ui, response: &egui::Response) {
    ui.ctx().accesskit_node_builder(response.id, |node| {
        node.set_live(egui::accesskit::Live::Polite);
    });
}
