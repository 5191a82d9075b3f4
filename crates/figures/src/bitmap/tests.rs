//! Pixels at known places, sizes that are refused, and the same pixels in both exporters.

use std::io::Cursor;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::DVec2;

use super::*;
use crate::scene::{Group, Rect, Scene, Shape, View};
use crate::{to_pixels, to_svg};

const WHITE: [u8; 4] = [255; 4];

fn bitmap() -> Bitmap {
    Bitmap::grey(3, vec![0, 10, 20, 30, 40, 50]).expect("3 x 2")
}

fn scene(rect: Rect) -> Scene {
    let mut scene = Scene::new(12.0, 10.0, WHITE);
    let mut group = Group::new("image");
    group.shapes.push(Shape::Image {
        rect,
        bitmap: bitmap(),
    });
    scene.groups.push(group);
    scene
}

fn grey(scene: &Scene, scale: f64, x: u32, y: u32) -> u8 {
    to_pixels(scene, scale)
        .expect("drawable")
        .at(x, y)
        .expect("inside")[0]
}

#[test]
fn pixels_keep_their_edges_at_every_scale() {
    let scene = scene(Rect::new([1.0, 2.0], [7.0, 6.0]));
    for scale in [1.0, 2.0, 3.0] {
        let pixels = to_pixels(&scene, scale).expect("drawable");
        for y in 0..pixels.height {
            for x in 0..pixels.width {
                let at = (DVec2::new(x.into(), y.into()) + 0.5) / scale;
                let cell = ((at - DVec2::new(1.0, 2.0)) / 2.0).floor();
                let inside = (0.0..3.0).contains(&cell.x) && (0.0..2.0).contains(&cell.y);
                let expected = if inside {
                    (30.0 * cell.y + 10.0 * cell.x) as u8
                } else {
                    255
                };
                assert_eq!(pixels.at(x, y).map(|p| p[0]), Some(expected), "{x} {y}");
            }
        }
    }
}

#[test]
fn a_clip_and_the_picture_cut_and_far_places_do_no_harm() {
    let mut cut = scene(Rect::new([-2.0, -2.0], [4.0, 2.0]));
    assert_eq!((grey(&cut, 1.0, 0, 0), grey(&cut, 1.0, 3, 1)), (40, 50));
    assert_eq!(grey(&cut, 1.0, 4, 0), 255);
    cut.groups[0].clip = Some(Rect::new([1.0, 0.0], [12.0, 1.0]));
    assert_eq!((grey(&cut, 1.0, 0, 0), grey(&cut, 1.0, 1, 0)), (255, 40));
    assert_eq!(grey(&cut, 1.0, 1, 1), 255);
    let whole = scene(Rect::new([-1e300, -1e300], [1e300, 1e300]));
    assert_eq!(grey(&whole, 1.0, 5, 5), 40);
    for empty in [
        [[5.0; 2], [5.0; 2]],
        [[6.0; 2], [2.0; 2]],
        [[1e300; 2], [1e301; 2]],
    ] {
        let drawn = to_pixels(&scene(Rect::new(empty[0], empty[1])), 1.0).expect("drawable");
        assert!(drawn.rgba.iter().all(|v| *v == 255));
    }
}

#[test]
fn views_place_images_and_colours_are_kept() {
    let mut scene = scene(Rect::new([0.0; 2], [1.0; 2]));
    scene.groups[0].view = View {
        scale: 6.0,
        origin: DVec2::new(2.0, 0.0),
    };
    let red = Bitmap::rgb(1, &[[200, 1, 2]]).expect("1 x 1");
    assert_eq!((red.at(0, 0), red.at(1, 0)), (Some([200, 1, 2]), None));
    scene.groups[0].shapes.push(Shape::Image {
        rect: Rect::new([0.0; 2], [0.5; 2]),
        bitmap: red,
    });
    let pixels = to_pixels(&scene, 1.0).expect("drawable");
    assert_eq!(pixels.at(2, 2), Some([200, 1, 2, 255]));
    assert_eq!(pixels.at(7, 5), Some([50, 50, 50, 255]));
    assert_eq!(pixels.at(1, 0), Some(WHITE));
}

#[test]
fn sizes_out_of_range_are_refused() {
    let refused = |columns, count| Bitmap::grey(columns, vec![0; count]).is_err();
    assert!(refused(0, 0) && refused(3, 0) && refused(3, 4));
    assert!(refused(MAX_BITMAP_SIDE + 1, MAX_BITMAP_SIDE + 1));
    assert!(refused(1, MAX_BITMAP_SIDE + 1) && refused(usize::MAX, 3));
    assert!(!refused(1, MAX_BITMAP_SIDE) && !refused(MAX_BITMAP_SIDE, MAX_BITMAP_SIDE));
    let error = Bitmap::rgb(2, &[[0; 3]; 3]).expect_err("half a row");
    assert!(
        error
            .to_string()
            .starts_with("a bitmap of 9 bytes in rows of 6")
    );
    let nan = scene(Rect::new([f64::NAN, 0.0], [1.0; 2]));
    assert!(matches!(
        to_pixels(&nan, 1.0),
        Err(FigureError::NotFinite { .. })
    ));
    assert!(matches!(to_svg(&nan), Err(FigureError::NotFinite { .. })));
}

#[test]
fn a_document_holds_the_same_pixels_and_the_same_bytes_each_time() {
    let scene = scene(Rect::new([1.0, 2.0], [7.0, 6.0]));
    let text = to_svg(&scene).expect("drawable");
    assert_eq!(text, to_svg(&scene).expect("drawable"));
    assert!(text.contains("<image x=\"1\" y=\"2\" width=\"6\" height=\"4\""));
    let (_, data) = text.split_once("base64,").expect("data");
    let (data, _) = data.split_once('"').expect("quoted");
    let bytes = STANDARD.decode(data).expect("base64");
    let mut reader = png::Decoder::new(Cursor::new(bytes))
        .read_info()
        .expect("a PNG");
    let mut pixels = vec![0; reader.output_buffer_size().expect("small")];
    reader.next_frame(&mut pixels).expect("whole");
    assert_eq!(reader.info().size(), (3, 2));
    assert_eq!(pixels, [0, 10, 20, 30, 40, 50]);
}
