//! The markup, its escapes and its agreement with the scene.

use super::*;
use crate::scene::View;

const RED: Color = [255, 0, 0, 255];

fn scene(shapes: Vec<Shape>) -> Scene {
    let mut scene = Scene::new(40.0, 30.0, [255; 4]);
    let mut group = Group::new("disks & <gaps>");
    group.shapes = shapes;
    scene.groups.push(group);
    scene
}

fn svg(shapes: Vec<Shape>) -> String {
    to_svg(&scene(shapes)).expect("drawable")
}

/// Checks that tags nest and close and that no bare markup is left in text, as an XML parser would.
fn assert_well_formed(text: &str) {
    let mut open: Vec<&str> = Vec::new();
    for piece in text.split('<').skip(1) {
        let (tag, content) = piece.split_once('>').expect("a closed tag");
        assert!(!content.contains('>'), "bare > in {content}");
        let entities = content.split('&').skip(1);
        let known = ["amp;", "lt;", "gt;", "quot;", "apos;"];
        for entity in entities.chain(tag.split('&').skip(1)) {
            assert!(
                known.iter().any(|k| entity.starts_with(k)),
                "bare & in {piece}"
            );
        }
        assert_eq!(tag.matches('"').count() % 2, 0, "quotes in {tag}");
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name));
        } else if !tag.ends_with('/') {
            open.push(tag.split(' ').next().unwrap_or_default());
        }
    }
    assert!(open.is_empty(), "{open:?} left open");
}

fn everything() -> Vec<Shape> {
    let stroke = Stroke::new(RED, 1.5).dashed(3.0, 2.0);
    let hatch = Fill::Hatch(Hatch {
        color: RED,
        spacing: 4.0,
        width: 1.0,
    });
    let hatched = Style {
        fill: Some(hatch),
        stroke: None,
    };
    let points = [[1.0, 1.0], [30.0, 1.0], [1.0, 20.0]];
    let points = points.map(DVec2::from).to_vec();
    let text = Text::new([3.0, 3.0], "r < \"2\" & 'x' > \u{0}\u{3c1}", 10.0, RED);
    vec![
        Shape::circle([20.0, 15.0], 10.0, hatched),
        Shape::Rect {
            rect: Rect::new([1.0; 2], [9.0; 2]),
            style: Style::filled([1, 2, 3, 51]),
        },
        Shape::Polygon {
            points: points.clone(),
            style: hatched.with_stroke(stroke),
        },
        Shape::Polyline { points, stroke },
        Shape::line([0.0; 2], [5.0; 2], stroke),
        Shape::marker(Marker::Dot, [4.0; 2], 3.0, Style::filled(RED)),
        Shape::marker(Marker::Cross, [4.0; 2], 3.0, Style::stroked(RED, 1.0)),
        Shape::Text(text),
    ]
}

#[test]
fn every_shape_is_well_formed() {
    let mut scene = scene(everything());
    scene.title = "a < b & \"c\"".to_owned();
    scene
        .metadata
        .push(("<key>".to_owned(), "]]> & more".to_owned()));
    scene.groups[0].clip = Some(Rect::new([0.0; 2], [20.0; 2]));
    let text = to_svg(&scene).expect("drawable");
    assert_well_formed(&text);
    assert!(text.contains("r &lt; &quot;2&quot; &amp; &apos;x&apos; &gt; \u{fffd}\u{3c1}</text>"));
    assert!(text.contains("<title>a &lt; b &amp; &quot;c&quot;</title>"));
    assert!(text.contains("id=\"layer-0-disks----gaps-\""));
    assert!(text.contains("clip-path=\"url(#clip-0)\""));
    assert_eq!(text, to_svg(&scene).expect("drawable"), "deterministic");
}

#[test]
#[should_panic(expected = "bare & in")]
fn the_well_formedness_check_refuses_a_bare_ampersand() {
    assert_well_formed("<svg><text>a & b</text></svg>");
}

#[test]
#[should_panic(expected = "left: Some(\"text\")")]
fn the_well_formedness_check_refuses_crossed_tags() {
    assert_well_formed("<svg><text></svg></text>");
}

#[test]
fn numbers_are_rounded_and_styles_spelled_out() {
    let text = svg(vec![
        Shape::circle(
            [1.0 / 3.0, -0.000_01],
            2.0,
            Style::filled([0, 0x72, 0xB2, 51]),
        ),
        Shape::line([0.0; 2], [5.0, 0.0], Stroke::new(RED, 1.5).dashed(3.0, 2.0)),
    ]);
    assert!(
        text.contains(
            "<circle cx=\"0.333\" cy=\"0\" r=\"2\" fill=\"#0072b2\" fill-opacity=\"0.2\"/>"
        )
    );
    assert!(text.contains(
        "<path d=\"M0 0L5 0\" fill=\"none\" stroke=\"#ff0000\" stroke-width=\"1.5\" stroke-dasharray=\"3 2\"/>"
    ));
}

#[test]
fn views_place_and_texts_turn() {
    let mut label = Text::new([0.5, 0.5], "x", 10.0, RED);
    label.quarter_turns = 3;
    label.anchor = Anchor::Middle;
    let mut scene = scene(vec![
        Shape::circle([0.5, 0.5], 0.1, Style::filled(RED)),
        Shape::Text(label),
    ]);
    let unit = Rect::new([0.0; 2], [1.0; 2]);
    scene.groups[0].view = View::fit(unit, Rect::new([10.0, 0.0], [40.0, 30.0]));
    let text = to_svg(&scene).expect("drawable");
    assert!(text.contains("<circle cx=\"25\" cy=\"15\" r=\"3\""));
    assert!(
        text.contains("text-anchor=\"middle\" fill=\"#ff0000\" transform=\"rotate(270 25 15)\"")
    );
}

#[test]
fn what_the_rasteriser_refuses_is_refused_here() {
    let mut bad = scene(Vec::new());
    bad.width = f64::NAN;
    assert!(matches!(to_svg(&bad), Err(FigureError::Size { .. })));
    let nan = Shape::circle([0.0; 2], f64::NAN, Style::default());
    assert!(matches!(
        to_svg(&scene(vec![nan])),
        Err(FigureError::NotFinite { index: 0, .. })
    ));
}

#[test]
fn a_document_holds_the_fonts_of_its_text_and_no_other() {
    let mut scene = Scene::new(60.0, 40.0, [255; 4]);
    let plain = to_svg(&scene).unwrap();
    assert!(!to_svg_with_fonts(&scene).unwrap().contains("@font-face"));
    let mut group = Group::new("text");
    let text = Text::new([1.0, 20.0], "Power", 12.0, [0, 0, 0, 255]);
    group.shapes.push(Shape::Text(text));
    scene.groups.push(group);
    let svg = to_svg_with_fonts(&scene).unwrap();
    let rules: Vec<&str> = svg.matches("@font-face").collect();
    assert_eq!(rules.len(), 1);
    assert!(svg.contains("font-family:'Inter';font-weight:400"));
    assert!(!svg.contains("JetBrains"));
    let (_, data) = svg.split_once("base64,").unwrap();
    let (data, _) = data.split_once(')').unwrap();
    assert_eq!(STANDARD.decode(data).unwrap(), Font::Regular.bytes());
    // All else is the plain document.
    assert!(plain.lines().next() == svg.lines().next());
    assert_eq!(
        svg.lines().count(),
        to_svg(&scene).unwrap().lines().count() + 1
    );
}
