//! Textures of pictures that are made elsewhere, kept from frame to frame.

use std::sync::Arc;

use egui::{ColorImage, Id, TextureHandle, TextureOptions, Ui};

/// Returns the texture of a picture, which is kept under `id` until another picture is given.
pub fn texture_of<T: Send + Sync + 'static>(
    ui: &Ui,
    id: Id,
    picture: &Arc<T>,
    options: TextureOptions,
    image: impl FnOnce(&T) -> ColorImage,
) -> TextureHandle {
    let kept: Option<(Arc<T>, TextureHandle)> = ui.data(|data| data.get_temp(id));
    // One picture is one allocation, so that pixels need not be compared.
    if let Some((_, texture)) = kept.filter(|(of, _)| Arc::ptr_eq(of, picture)) {
        return texture;
    }
    let texture = ui.ctx().load_texture("picture", image(picture), options);
    ui.data_mut(|data| data.insert_temp(id, (Arc::clone(picture), texture.clone())));
    texture
}
