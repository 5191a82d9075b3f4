//! Pixels at known places.

use super::*;
use crate::scene::View;

const WHITE: Color = [255; 4];
const RED: Color = [255, 0, 0, 255];
const BLUE: Color = [0, 0, 255, 255];

fn scene(shapes: Vec<Shape>) -> Scene {
    let mut scene = Scene::new(40.0, 30.0, WHITE);
    let mut group = Group::new("shapes");
    group.shapes = shapes;
    scene.groups.push(group);
    scene
}

fn draw(shape: Shape) -> Pixels {
    to_pixels(&scene(vec![shape]), 1.0).expect("drawable")
}

/// Number of pixels that are not the background.
fn inked(pixels: &Pixels) -> usize {
    let touched = |pixel: &&[u8]| *pixel != WHITE;
    pixels.rgba.chunks_exact(4).filter(touched).count()
}

#[test]
fn a_disk_is_where_it_should_be_and_as_large() {
    let pixels = draw(Shape::circle([20.0, 15.0], 10.0, Style::filled(RED)));
    assert_eq!(pixels.at(20, 15), Some(RED));
    assert_eq!(pixels.at(20, 6), Some(RED));
    assert_eq!(pixels.at(20, 3), Some(WHITE));
    assert_eq!(pixels.at(11, 8), Some(WHITE));
    assert_eq!(pixels.at(40, 0), None);
    let ink = pixels
        .rgba
        .chunks_exact(4)
        .map(|p| f64::from(255 - p[1]) / 255.0);
    let area = std::f64::consts::PI * 100.0;
    let share = ink.sum::<f64>() / area;
    // Edges are sampled 4 x 4 to a pixel: off by up to an eighth of a pixel all around, 2.5% here.
    assert!((share - 1.0).abs() < 0.025, "{share}");
}

#[test]
fn views_scale_positions_and_not_strokes() {
    let mut scene = scene(vec![Shape::line(
        [0.0, 1.0],
        [2.0, 1.0],
        Stroke::new(RED, 2.0),
    )]);
    let domain = Rect::new([0.0; 2], [2.0; 2]);
    scene.groups[0].view = View::fit(domain, Rect::new([5.0, 5.0], [25.0, 25.0]));
    let pixels = to_pixels(&scene, 1.0).expect("drawable");
    assert_eq!(inked(&pixels), 20 * 2);
    assert_eq!(pixels.at(5, 14), Some(RED));
    let doubled = to_pixels(&scene, 2.0).expect("drawable");
    assert_eq!((doubled.width, doubled.height), (80, 60));
    assert_eq!(inked(&doubled), 40 * 4);
}

#[test]
fn later_shapes_cover_earlier_ones_and_opacity_mixes() {
    let square = |color| Shape::Rect {
        rect: Rect::new([5.0, 5.0], [15.0, 15.0]),
        style: Style::filled(color),
    };
    let pixels = to_pixels(&scene(vec![square(RED), square(BLUE)]), 1.0).expect("drawable");
    assert_eq!(pixels.at(10, 10), Some(BLUE));
    let mixed = draw(square([0, 0, 0, 128]));
    let [grey, ..] = mixed.at(10, 10).expect("inside");
    assert!(grey.abs_diff(127) <= 1);
}

#[test]
fn a_clip_hides_what_lies_outside() {
    let mut scene = scene(vec![
        Shape::circle([20.0, 15.0], 12.0, Style::filled(RED)),
        Shape::marker(Marker::Square, [3.0, 3.0], 4.0, Style::filled(RED)),
    ]);
    let whole = inked(&to_pixels(&scene, 1.0).expect("drawable"));
    scene.groups[0].clip = Some(Rect::new([10.0, 10.0], [20.0, 20.0]));
    let clipped = to_pixels(&scene, 1.0).expect("drawable");
    assert_eq!(inked(&clipped), 100);
    assert!(whole > 400);
    scene.groups[0].clip = Some(Rect::new([50.0, 50.0], [60.0, 60.0]));
    assert_eq!(inked(&to_pixels(&scene, 1.0).expect("drawable")), 0);
}

#[test]
fn dashes_leave_spaces() {
    let solid = Stroke::new(RED, 2.0);
    let line = |stroke| inked(&draw(Shape::line([0.0, 10.0], [40.0, 10.0], stroke)));
    assert_eq!(line(solid), 80);
    assert_eq!(line(solid.dashed(4.0, 4.0)), 40);
}

#[test]
fn every_marker_inks_its_centre_and_stays_in_its_size() {
    for marker in [
        Marker::Dot,
        Marker::Cross,
        Marker::Triangle,
        Marker::Diamond,
        Marker::Square,
    ] {
        let pixels = draw(Shape::marker(
            marker,
            [20.0, 15.0],
            10.0,
            Style::filled(RED),
        ));
        assert_eq!(pixels.at(20, 15), Some(RED), "{marker:?}");
        assert_eq!(pixels.at(13, 15), Some(WHITE), "{marker:?}");
        assert!((20..=100).contains(&inked(&pixels)), "{marker:?}");
    }
}

#[test]
fn hatching_inks_a_share_of_the_area() {
    let hatch = Hatch {
        color: RED,
        spacing: 4.0,
        width: 1.0,
    };
    let style = Style {
        fill: Some(Fill::Hatch(hatch)),
        stroke: None,
    };
    let rect = Rect::new([0.0; 2], [40.0, 30.0]);
    let pixels = draw(Shape::Rect { rect, style });
    let ink = pixels
        .rgba
        .chunks_exact(4)
        .map(|p| f64::from(255 - p[1]) / 255.0);
    let share = ink.sum::<f64>() / 1200.0;
    assert!((0.2..0.3).contains(&share), "{share}");
}

#[test]
fn text_is_drawn_anchored_and_turned() {
    let bounds = |change: &dyn Fn(&mut Text)| {
        let mut text = Text::new([20.0, 15.0], "HHH", 8.0, RED);
        change(&mut text);
        let pixels = draw(Shape::Text(text));
        let inked = |x: u32, y: u32| pixels.at(x, y) != Some(WHITE);
        let columns: Vec<u32> = (0..40).filter(|&x| (0..30).any(|y| inked(x, y))).collect();
        let rows: Vec<u32> = (0..30).filter(|&y| (0..40).any(|x| inked(x, y))).collect();
        assert!(!columns.is_empty(), "something is drawn");
        [
            columns[0],
            columns[columns.len() - 1],
            rows[0],
            rows[rows.len() - 1],
        ]
    };
    let [left, right, top, bottom] = bounds(&|_| ());
    assert!(left >= 20 && right > 30 && top >= 8 && bottom == 14);
    let [left, right, ..] = bounds(&|t| t.anchor = Anchor::Middle);
    assert!(left < 15 && right > 25 && right < 31);
    assert!(bounds(&|t| t.anchor = Anchor::End)[1] <= 20);
    assert!(bounds(&|t| t.baseline = Baseline::Top)[2] >= 14);
    let [left, right, top, _] = bounds(&|t| t.quarter_turns = 3);
    assert!(left >= 13 && right <= 20 && top < 5, "reads upwards");
}

#[test]
fn sizes_and_numbers_out_of_range_are_named() {
    let sized = |width: f64, scale: f64| to_pixels(&Scene::new(width, 10.0, WHITE), scale);
    for width in [0.0, -3.0, f64::NAN, f64::INFINITY, 40_000.0] {
        assert!(
            matches!(sized(width, 1.0), Err(FigureError::Size { .. })),
            "{width}"
        );
    }
    assert!(matches!(
        sized(100.0, 1000.0),
        Err(FigureError::Size { .. })
    ));
    assert!(matches!(sized(100.0, 1e-3), Err(FigureError::Size { .. })));
    for scale in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(sized(10.0, scale), Err(FigureError::Scale(_))));
    }
    let vast = Scene::new(32_768.0, 32_768.0, WHITE);
    let pixels = 1 << 30;
    assert_eq!(to_pixels(&vast, 1.0), Err(FigureError::Pixels { pixels }));
    let fine = Shape::circle([1.0, 1.0], 1.0, Style::filled(RED));
    let broken = Shape::circle([1.0, f64::NAN], 1.0, Style::filled(RED));
    let error = to_pixels(&scene(vec![fine, broken]), 1.0).expect_err("NaN");
    assert_eq!(
        error.to_string(),
        "shape 1 of group \"shapes\" has a coordinate or length that is not finite"
    );
    let mut flat = scene(Vec::new());
    flat.groups[0].view.scale = 0.0;
    assert!(matches!(
        to_pixels(&flat, 1.0),
        Err(FigureError::View { .. })
    ));
}

#[test]
fn places_far_away_do_no_harm() {
    let stroke = Stroke::new(RED, 3.0);
    let style = Style::filled(RED).with_stroke(stroke.dashed(1e-300, 1e-300));
    for value in [1e300_f64, -1e300, 1e30, 1e9, 150_000.0, 90_000.0, 1e-300] {
        draw(Shape::circle([value, 10.0], 5.0, style));
        draw(Shape::circle(
            [10.0, 10.0],
            value.clamp(0.0, MAX_LENGTH),
            style,
        ));
        draw(Shape::line(
            [value, 0.0],
            [-value, 10.0],
            stroke.dashed(4.0, 4.0),
        ));
        let points = [[value, 0.0], [10.0, value], [10.0, 10.0]];
        let points = points.map(DVec2::from).to_vec();
        draw(Shape::Polyline {
            points: points.clone(),
            stroke,
        });
        draw(Shape::Polygon { points, style });
        draw(Shape::marker(Marker::Cross, [10.0, value], 8.0, style));
        draw(Shape::Text(Text::new([value, 10.0], "x", 10.0, RED)));
    }
    draw(Shape::Polyline {
        points: Vec::new(),
        stroke,
    });
}

#[test]
fn what_passes_through_from_far_away_is_seen() {
    let far = draw(Shape::line(
        [-1e9, 10.0],
        [1e9, 10.0],
        Stroke::new(RED, 2.0),
    ));
    assert_eq!(inked(&far), 80);
    let rect = Rect::new([-1e9, -1e9], [20.0, 1e9]);
    let style = Style::filled(RED).with_stroke(Stroke::new(BLUE, 2.0));
    let half = draw(Shape::Rect { rect, style });
    assert_eq!([half.at(18, 5), half.at(19, 5)], [Some(RED), Some(BLUE)]);
    assert_eq!([half.at(20, 5), half.at(21, 5)], [Some(BLUE), Some(WHITE)]);
}

#[test]
fn lengths_beyond_any_picture_are_named() {
    let huge = Shape::circle([0.0; 2], 60_000.0, Style::filled(RED));
    assert!(to_pixels(&scene(vec![huge.clone()]), 1.0).is_ok());
    let error = to_pixels(&scene(vec![huge]), 2.0).expect_err("too large");
    assert_eq!(
        error.to_string(),
        "shape 0 of group \"shapes\" has a length of 120000 pixels; the limit is 100000"
    );
}
