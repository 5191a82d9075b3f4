//! A set in a field or a shape, and its radii, its shape and its dots beside it: pictures of one camera.
//! Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

use egui::{Align2, Painter, Rect, pos2, vec2};
use tilescope_canvas::overlay::tag;
use tilescope_drawing::palette::Palette;
use tilescope_drawing::subject::GroundView;
use tilescope_session::layers::{Layer, Layers};
use tilescope_session::session::Session;

use super::titles::GUTTER;

/// Returns the pictures of a session: only that of the set unless it lies in a field or a shape.
pub fn of_session(session: &Session) -> Vec<GroundView> {
    let mut views = Vec::new();
    if session.radius_varies() {
        views.push(GroundView::Radii);
    }
    if session.has_shape() {
        views.push(GroundView::Shape);
    }
    views.push(GroundView::Set);
    if session.ground.is_some() {
        views.push(GroundView::Dots);
    }
    views
}

/// Returns the name above a picture.
const fn name(view: GroundView) -> &'static str {
    match view {
        GroundView::Radii => "Radii",
        GroundView::Shape => "Shape",
        GroundView::Set => "Set",
        GroundView::Dots => "Dots",
    }
}

/// Returns the name of a picture's canvas for screen readers, and its id.
pub const fn canvas(view: GroundView) -> [&'static str; 2] {
    match view {
        GroundView::Radii => ["Canvas of radii", "canvas-radii"],
        GroundView::Shape => ["Canvas of the shape", "canvas-shape"],
        GroundView::Set => ["Canvas of samples", "canvas"],
        GroundView::Dots => ["Canvas of dots", "canvas-dots"],
    }
}

/// Returns the layers of a picture, where those of the set are `chosen`.
pub const fn layers(view: GroundView, chosen: Layers) -> Layers {
    let mut layers = Layers::none();
    match view {
        GroundView::Set => return chosen,
        // The area inside is no layer.
        GroundView::Shape => {}
        GroundView::Radii => layers.toggle(Layer::Field),
        GroundView::Dots => layers.toggle(Layer::Samples),
    }
    layers
}

/// Returns the rectangles of so many pictures of a domain, all of one size, row by row. Of all numbers of columns that is taken by
/// which the domain is largest. `aspect` is its width over its height.
pub fn tiles(rect: Rect, count: usize, aspect: f32) -> Vec<Rect> {
    let size_of = |columns: usize| {
        let counts = vec2(columns as f32, count.div_ceil(columns) as f32);
        ((rect.size() + vec2(GUTTER, GUTTER)) / counts - vec2(GUTTER, GUTTER)).floor()
    };
    let height_of = |columns: &usize| {
        let size = size_of(*columns);
        size.y.min(size.x / aspect)
    };
    let columns = (1..=count).max_by(|a, b| height_of(a).total_cmp(&height_of(b)));

    let columns = columns.unwrap_or(1);
    // A window may leave the canvas no room.
    let size = size_of(columns).max(vec2(1.0, 1.0));
    let tile = |index: usize| {
        let (row, column) = (index / columns, index % columns);
        let step = size + vec2(GUTTER, GUTTER);
        let corner = rect.min + vec2(column as f32, row as f32) * step;
        Rect::from_min_size(pos2(corner.x, corner.y), size)
    };
    (0..count).map(tile).collect()
}

/// Writes the name of a picture into its upper left corner; returns where it ends below.
pub fn write_name(painter: &Painter, rect: Rect, view: GroundView, palette: &Palette) -> f32 {
    let at = rect.left_top() + vec2(14.0, 10.0);
    tag(painter, at, Align2::LEFT_TOP, name(view), palette);
    at.y + 18.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_are_as_large_as_they_can_be_and_apart() {
        let canvases = [
            // Wide, almost square, and as a phone is held, for a square and for a photograph.
            ([1_600.0, 400.0], 1.0, 4, 4),
            ([900.0, 700.0], 1.0, 4, 2),
            ([390.0, 844.0], 1.0, 3, 1),
            ([390.0, 600.0], 1.0, 4, 2),
            ([390.0, 700.0], 1.5, 4, 1),
            ([800.0, 600.0], 1.0, 1, 1),
        ];
        for ([width, height], aspect, count, columns) in canvases {
            let rect = Rect::from_min_size(pos2(10.0, 20.0), vec2(width, height));
            let all = tiles(rect, count, aspect);
            let in_first_row = all.iter().filter(|tile| tile.min.y < all[0].max.y).count();
            assert_eq!((all.len(), in_first_row), (count, columns), "{width}");
            assert!(all.iter().all(|tile| rect.contains_rect(*tile)));
            for (index, tile) in all.iter().enumerate() {
                let others = all[index + 1..].iter();
                assert!(others.into_iter().all(|other| !tile.intersects(*other)));
            }
        }
        assert_eq!(tiles(Rect::ZERO, 2, 1.0).len(), 2);
    }

    #[test]
    fn only_the_set_has_the_layers_that_were_chosen() {
        let chosen = Layers::default();
        assert_eq!(layers(GroundView::Set, chosen), chosen);
        assert_eq!(layers(GroundView::Shape, chosen), Layers::none());
        let dots = layers(GroundView::Dots, chosen);
        assert!(dots.has(Layer::Samples) && dots.iter().count() == 1);
        assert!(layers(GroundView::Radii, chosen).has(Layer::Field));
    }
}
