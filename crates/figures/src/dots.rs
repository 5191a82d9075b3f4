//! A picture of points as dots of ink on paper.

use crate::scene::{Group, Scene, Shape, Style, View};

/// Returns the picture of dots, each a place and a radius in the unit of a domain of this size. The picture is
/// `columns` pixels wide. The domain's y points up.
#[must_use]
pub fn on_paper(
    size: [f64; 2],
    columns: u32,
    [paper, ink]: [[u8; 3]; 2],
    dots: impl IntoIterator<Item = ([f64; 2], f64)>,
) -> Scene {
    let [width, height] = size;
    let pixels_a_unit = f64::from(columns) / width;
    let color = |[red, green, blue]: [u8; 3]| [red, green, blue, u8::MAX];

    // Dots are drawn in the unit of the domain, and the view makes pixels of them.
    let mut group = Group {
        view: View {
            scale: pixels_a_unit,
            ..View::PIXELS
        },
        ..Group::new("dots")
    };
    let style = Style::filled(color(ink));
    for ([x, y], radius) in dots {
        // The scene's y points down.
        let center = [x, height - y];
        group.shapes.push(Shape::circle(center, radius, style));
    }

    // A picture has at least one row, however flat the domain is.
    let rows = (height * pixels_a_unit).round().max(1.0);
    let mut scene = Scene::new(f64::from(columns), rows, color(paper));
    scene.title = format!("{} dots", group.shapes.len());
    scene.groups.push(group);
    scene
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::to_pixels;

    #[test]
    fn dots_have_ink_at_their_places_and_the_rest_is_paper() {
        let dots = [([2.0, 1.0], 0.5)];
        let scene = on_paper([8.0, 4.0], 80, [[9, 8, 7], [250, 0, 0]], dots);
        assert_eq!((scene.width, scene.height), (80.0, 40.0));
        let picture = to_pixels(&scene, 1.0).expect("a picture");
        // y points up: a dot in the lower half of the domain is in the lower half of the picture.
        assert_eq!(picture.at(20, 30), Some([250, 0, 0, 255]));
        assert_eq!(picture.at(20, 10), Some([9, 8, 7, 255]));
    }
}
