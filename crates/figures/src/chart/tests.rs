//! Tests of charts: positions of curves, ticks and legends, refusals, equal bytes, and the sizes of bars and tiles.

#![allow(clippy::float_cmp, reason = "equal widths are meant")]

use super::*;
use crate::palette::Palette;
use crate::scene::{Group, Rect, Scene, Shape};
use crate::{to_png, to_svg};

fn series(name: &str, number: usize, points: Vec<[f64; 2]>) -> Series {
    Series {
        name: name.to_owned(),
        look: Look::Numbered(number),
        points,
        band: None,
    }
}

fn chart(series: Vec<Series>) -> LineChart {
    LineChart {
        title: "Radial mean power".to_owned(),
        x: Axis::new("nu"),
        y: Axis::new("power"),
        series,
        levels: vec![Level {
            name: "noise".to_owned(),
            y: 1.0,
        }],
    }
}

fn image() -> ImageChart {
    ImageChart {
        title: "Periodogram".to_owned(),
        x: Axis::new("nu x").with_range(-1.0, 1.0),
        y: Axis::new("nu y").with_range(-1.0, 1.0),
        columns: 3,
        values: vec![0.0, 1.0, 2.0, 0.5, f64::NAN, 0.5, 9.0, -1.0, 1.0],
        clamp: [0.0, 2.0],
        absent: Some(4),
    }
}

fn figure(panels: Vec<Panel>) -> Figure {
    Figure {
        title: "Two sets".to_owned(),
        rows: vec![panels],
    }
}

fn scene(panel: Panel) -> Result<Scene, ChartError> {
    figure_scene(&figure(vec![panel]), &Palette::LIGHT)
}

fn group<'a>(scene: &'a Scene, name: &str) -> &'a Group {
    let found = scene.groups.iter().find(|group| group.name == name);
    found.unwrap_or_else(|| panic!("no group {name}"))
}

fn wave(height: f64) -> Vec<[f64; 2]> {
    let at = |i: i32| [0.1 * f64::from(i), height * f64::from(i % 5)];
    (0..40).map(at).collect()
}

#[test]
fn curves_lie_in_their_frame() {
    let made = scene(Panel::Lines(chart(vec![
        series("a.csv", 0, wave(1.0)),
        series("b.csv", 1, wave(-0.5)),
    ])));
    let made = made.unwrap();
    let curves = group(&made, "curves");
    let frame = curves.clip.unwrap();
    let mut places = 0;
    for shape in &curves.shapes {
        if let Shape::Polyline { points, .. } = shape {
            for point in points {
                assert!((0..2).all(|k| (frame.min[k]..=frame.max[k]).contains(&point[k])));
                places += 1;
            }
        }
    }
    assert_eq!(places, 80);
    // A given range cuts off instead: the same curve then leaves the frame.
    let mut short = chart(vec![series("a.csv", 0, wave(1.0))]);
    short.y = short.y.with_range(0.0, 2.0);
    let made = scene(Panel::Lines(short)).unwrap();
    let curves = group(&made, "curves");
    let outside = |shape: &Shape| match shape {
        Shape::Polyline { points, .. } => points.iter().any(|p| p.y < curves.clip.unwrap().min.y),
        _ => false,
    };
    assert!(curves.shapes.iter().any(outside));
}

#[test]
fn values_are_where_their_ticks_are() {
    let line = vec![[0.0, 0.0], [2.0, 10.0]];
    let mut plain = chart(vec![series("a.csv", 0, line)]);
    plain.y = plain.y.with_range(0.0, 10.0);
    let made = scene(Panel::Lines(plain)).unwrap();
    let frame = group(&made, "curves").clip.unwrap();
    let Shape::Polyline { points, .. } = &group(&made, "curves").shapes[0] else {
        panic!("no curve");
    };
    let [_, upper, _, lower] = frame.corners();
    for (point, corner) in points.iter().zip([lower, upper]) {
        assert!(point.distance(corner) < 1e-9, "{point:?} {corner:?}");
    }
    let texts = texts(group(&made, "axes"));
    for label in ["0.0", "1.0", "2.0", "0", "4", "10", "nu", "power"] {
        assert!(texts.iter().any(|text| text == label), "{label}: {texts:?}");
    }
}

fn texts(group: &Group) -> Vec<String> {
    let text = |shape: &Shape| match shape {
        Shape::Text(text) => Some(text.text.clone()),
        _ => None,
    };
    group.shapes.iter().filter_map(text).collect()
}

fn dashes(shapes: &[Shape]) -> Vec<String> {
    let dash = |shape: &Shape| match shape {
        Shape::Segments { stroke, .. } => Some(format!("{:?}", stroke.dash)),
        _ => None,
    };
    shapes.iter().filter_map(dash).collect()
}

#[test]
fn levels_have_their_names_where_no_curve_runs() {
    let mut some = chart(vec![series("a.csv", 0, wave(1.0))]);
    let names = ["noise", "lattice", "darts"];
    for (count, y) in [(1, 1.0), (2, 3.0), (3, 2.0)] {
        if count > 1 {
            let name = names[count - 1].to_owned();
            some.levels.push(Level { name, y });
        }
        let made = scene(Panel::Lines(some.clone())).unwrap();
        let plot = group(&made, "curves").clip.unwrap();
        let named = group(&made, "level names");
        let mut found = texts(named);
        found.reverse();
        assert_eq!(found, names[..count]);
        let mut samples = dashes(&named.shapes);
        samples.reverse();
        assert_eq!(samples, dashes(&group(&made, "levels").shapes));
        let each: std::collections::BTreeSet<&String> = samples.iter().collect();
        assert_eq!(each.len(), count, "every level has dashes of its own");
        for shape in &named.shapes {
            if let Shape::Text(text) = shape {
                assert!(text.at.y < plot.min.y, "{text:?}");
            }
        }
    }
    // Without room, they stand at their lines.
    for level in &mut some.levels {
        level.name.push_str(&" and so on".repeat(9));
    }
    let made = scene(Panel::Lines(some)).unwrap();
    let plot = group(&made, "curves").clip.unwrap();
    for shape in &group(&made, "level names").shapes {
        let Shape::Text(text) = shape else {
            panic!("nothing hides a curve: {shape:?}");
        };
        assert!(text.at.y > plot.min.y);
    }
}

#[test]
fn an_axis_has_the_ticks_it_is_given() {
    let named = |values: &[f64]| -> Vec<(f64, String)> {
        let each = values.iter().map(|value| (*value, format!("at {value}")));
        each.collect()
    };
    let mut one = chart(vec![series("a.csv", 0, vec![[0.0, 0.0], [4.0, 1.0]])]);
    one.levels.clear();
    one.x = Axis::new("samples").with_ticks(named(&[-1.0, 0.0, 1.0, 4.0, 4.5]));
    let made = scene(Panel::Lines(one.clone())).unwrap();
    let frame = group(&made, "curves").clip.unwrap();
    let mut found = Vec::new();
    for shape in &group(&made, "axes").shapes {
        if let Shape::Text(text) = shape
            && text.text.starts_with("at ")
        {
            found.push((text.text.clone(), text.at.x));
        }
    }
    let at = |part: f64| frame.min.x + part * frame.size().x;
    let expected = [("at 0", 0.0), ("at 1", 0.25), ("at 4", 1.0)];
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for ((text, x), (name, part)) in found.iter().zip(expected) {
        assert!(text == name && (x - at(part)).abs() < 1e-9, "{found:?}");
    }
    assert!(texts(group(&made, "axes")).contains(&"0.2".to_owned()));
    one.x = one.x.with_ticks(named(&[0.0, f64::NAN]));
    assert!(matches!(
        scene(Panel::Lines(one)),
        Err(ChartError::NotFinite { index: 1, .. })
    ));
}

#[test]
fn the_legend_has_every_name_once() {
    let names: Vec<String> = (0..30)
        .map(|i| format!("a rather long name {i}.csv"))
        .collect();
    let all = |_| {
        let each = names.iter().enumerate();
        Panel::Lines(chart(each.map(|(i, n)| series(n, i, wave(1.0))).collect()))
    };
    let made = figure_scene(&figure((0..2).map(all).collect()), &Palette::DARK).unwrap();
    assert_eq!(texts(group(&made, "legend")), names);
    for shape in &group(&made, "legend").shapes {
        if let Shape::Text(text) = shape {
            assert!(text.at.x < made.width - 100.0 && text.at.y < made.height);
        }
    }
}

#[test]
fn sixty_series_look_different_and_neighbours_not_by_colour_alone() {
    let looks: Vec<_> = (0..60)
        .map(|i| lines::drawn(Look::Numbered(i), &Palette::LIGHT))
        .map(|d| {
            (
                d.stroke.color,
                format!("{:?} {:?}", d.stroke.dash, d.marker),
            )
        })
        .collect();
    for (i, look) in looks.iter().enumerate() {
        assert!(!looks[..i].contains(look), "{i}");
        assert!(i == 0 || look.1 != looks[i - 1].1);
    }
}

#[test]
fn numbers_that_are_none_are_refused() {
    for bad in [f64::NAN, f64::INFINITY] {
        let mut points = wave(1.0);
        points[7][1] = bad;
        let refused = scene(Panel::Lines(chart(vec![series("a.csv", 0, points)])));
        let error = refused.unwrap_err();
        assert!(
            matches!(&error, ChartError::NotFinite { index: 7, series, .. } if series == "a.csv"),
            "{error}"
        );
    }
    let empty = scene(Panel::Lines(chart(vec![series("a.csv", 0, vec![])])));
    assert!(matches!(empty, Err(ChartError::EmptySeries { .. })));
    assert!(matches!(
        scene(Panel::Lines(chart(vec![]))),
        Err(ChartError::Empty(_))
    ));
    assert!(figure_scene(&figure(vec![]), &Palette::LIGHT).is_err());
    let mut short = series("a.csv", 0, wave(1.0));
    short.band = Some(vec![[0.0, 1.0]; 39]);
    let refused = scene(Panel::Lines(chart(vec![short])));
    assert!(matches!(refused, Err(ChartError::Band { found: 39, .. })));
    let flat = LineChart {
        x: Axis::new("nu").with_range(1.0, 1.0),
        ..chart(vec![series("a.csv", 0, wave(1.0))])
    };
    assert!(matches!(
        scene(Panel::Lines(flat)),
        Err(ChartError::Range(_))
    ));
}

#[test]
fn a_constant_curve_has_axes() {
    let one = scene(Panel::Lines(chart(vec![series(
        "a.csv",
        0,
        vec![[3.0, 1.0]],
    )])));
    assert!(to_svg(&one.unwrap()).is_ok());
}

#[test]
fn the_absent_cell_is_ringed_and_not_painted() {
    let made = scene(Panel::Image(image())).unwrap();
    let painted: usize = (group(&made, "cells").shapes.iter())
        .map(|shape| match shape {
            Shape::Segments { segments, .. } => segments.len(),
            _ => 0,
        })
        .sum();
    assert_eq!(
        painted, 8,
        "nine cells without the middle one, no two alike in a row"
    );
    let Shape::Circle { center, .. } = group(&made, "absent").shapes[0] else {
        panic!("no ring");
    };
    let frame = group(&made, "cells").clip.unwrap();
    assert!(center.distance(frame.middle()) < 1e-9);
    let present = ImageChart {
        absent: None,
        ..image()
    };
    assert!(matches!(
        scene(Panel::Image(present)),
        Err(ChartError::NotFinite { index: 4, .. })
    ));
}

/// Shapes follow from the ranges, not from the numbers of cells.
#[test]
fn a_unit_is_as_long_along_both_axes() {
    let shape = |x: f64, y: f64| {
        let mut chart = image();
        chart.x = Axis::new("x").with_range(-x, x);
        chart.y = Axis::new("y").with_range(-y, y);
        let made = scene(Panel::Image(chart)).unwrap();
        let frame = group(&made, "cells").clip.unwrap();
        let [width, height] = [0, 1].map(|k| frame.max[k] - frame.min[k]);
        // Cells of a third of the frame, and the ring in its middle.
        for shape in &group(&made, "cells").shapes {
            if let Shape::Segments { stroke, .. } = shape {
                let wide = stroke.width - height / 3.0;
                assert!((0.0..1.0).contains(&wide), "{wide}");
            }
        }
        assert!(frame.max.x < made.width && frame.max.y < made.height);
        width / height
    };
    for (x, y) in [(1.0, 1.0), (3.0, 1.0), (0.2, 1.0), (100.0, 70.0)] {
        let found = shape(x, y);
        assert!((found / (x / y) - 1.0).abs() < 1e-9, "{x} {y}: {found}");
    }
    assert!(shape(3.0, 1.0) > 2.0 * shape(1.0, 1.0));
}

#[test]
fn a_last_row_of_fewer_images_has_them_no_larger() {
    let rows = [3, 1].map(|count| vec![Panel::Image(image()); count]);
    let figure = |rows: &[Vec<Panel>]| Figure {
        title: "Pictures".to_owned(),
        rows: rows.to_vec(),
    };
    let widths = |rows: &[Vec<Panel>]| -> Vec<f64> {
        let made = figure_scene(&figure(rows), &Palette::LIGHT).unwrap();
        let cells = made.groups.iter().filter(|group| group.name == "cells");
        let plots = cells.map(|group| group.clip.unwrap());
        plots.map(|plot| plot.size().x).collect()
    };
    let all = widths(&rows);
    assert!(
        all.len() == 4 && all.iter().all(|width| *width == all[0]),
        "{all:?}"
    );
    assert!(widths(&rows[1..])[0] > all[0], "alone it is larger");
}

#[test]
fn images_that_are_no_grids_are_refused() {
    for (columns, clamp) in [(0, [0.0, 1.0]), (4, [0.0, 1.0]), (3, [1.0, 1.0])] {
        let bad = ImageChart {
            columns,
            clamp,
            ..image()
        };
        assert!(scene(Panel::Image(bad)).is_err(), "{columns} {clamp:?}");
    }
}

#[test]
fn equal_figures_have_equal_bytes() {
    let make = || {
        let mut curve = series("a.csv", 0, wave(1.0));
        curve.band = Some(wave(1.0).iter().map(|p| [p[1] - 0.5, p[1] + 0.5]).collect());
        let panels = vec![Panel::Lines(chart(vec![curve])), Panel::Image(image())];
        figure_scene(&figure(panels), &Palette::LIGHT).unwrap()
    };
    assert_eq!(to_png(&make(), 1.0).unwrap(), to_png(&make(), 1.0).unwrap());
    assert_eq!(to_svg(&make()).unwrap(), to_svg(&make()).unwrap());
    assert!(to_svg(&make()).unwrap().contains("Radial mean power"));
}

fn scene_texts(scene: &Scene) -> impl Iterator<Item = &crate::scene::Text> {
    let shapes = scene.groups.iter().flat_map(|group| &group.shapes);
    shapes.filter_map(|shape| match shape {
        Shape::Text(text) => Some(text),
        _ => None,
    })
}

#[test]
fn bars_are_as_long_as_their_values_and_their_texts_stay_inside() {
    let bar = |value: f64, text: &str| Bar {
        name: "a long name of a bar".to_owned(),
        value,
        whisker: Some([0.9 * value, 1.1 * value]),
        text: text.to_owned(),
        color: 1,
    };
    let chart = |bars: Vec<Bar>| BarChart {
        label: "quantity, unit".to_owned(),
        groups: vec![BarGroup {
            heading: "group".to_owned(),
            bars,
        }],
    };
    let bars = chart(vec![bar(1.0, "1 of something"), bar(4.0, "4 of something")]);
    let drawn = scene(Panel::Bars(bars.clone())).unwrap();
    drawn.validate().unwrap();
    let width = |shape: &Shape| match shape {
        Shape::Rect { rect, .. } => Some(rect.size().x),
        _ => None,
    };
    let widths: Vec<f64> = group(&drawn, "bars")
        .shapes
        .iter()
        .filter_map(width)
        .collect();
    assert!((widths[1] / widths[0] - 4.0).abs() < 1e-9);
    for text in scene_texts(&drawn).filter(|text| text.anchor == crate::Anchor::Start) {
        let end = text.at.x + crate::text_width(&text.text, text.font, text.size);
        assert!(end < drawn.width, "{end}");
    }

    // Bars that all have no length are drawn, too.
    let none = scene(Panel::Bars(chart(vec![bar(0.0, "0"), bar(0.0, "0")])));
    none.unwrap().validate().unwrap();

    let empty = scene(Panel::Bars(chart(Vec::new())));
    assert!(matches!(empty, Err(ChartError::Empty(_))));
    let infinite = scene(Panel::Bars(chart(vec![bar(f64::INFINITY, "")])));
    assert!(matches!(infinite, Err(ChartError::NotFinite { .. })));
    let mixed = figure(vec![Panel::Bars(bars), Panel::Image(image())]);
    let mixed = figure_scene(&mixed, &Palette::LIGHT);
    assert!(matches!(mixed, Err(ChartError::Mixed(_))));
}

fn tile(title: &str) -> TileChart {
    let bitmap = crate::Bitmap::grey(2, vec![0, 255, 255, 0]).unwrap();
    TileChart {
        title: title.to_owned(),
        note: "note".to_owned(),
        y: None,
        side: Some(100.0),
        content: TileContent::Pixels(bitmap),
    }
}

#[test]
fn tiles_of_a_given_side_make_the_figure_as_wide_as_they_are_and_keep_their_pixels() {
    let row = |count: usize| (0..count).map(|_| Panel::Tile(tile("a"))).collect();
    let sheet = Figure {
        title: String::new(),
        rows: vec![row(2), row(1)],
    };
    let drawn = figure_scene(&sheet, &Palette::LIGHT).unwrap();
    assert!((drawn.width - 250.0).abs() < 1e-9, "{}", drawn.width);
    let frame = group(&drawn, "tile").clip.unwrap();
    assert!((frame.size().x - 100.0).abs() < 1e-9);
    let pixels = crate::to_pixels(&drawn, 1.0).unwrap();
    let at = |x: f64, y: f64| {
        let pixel = pixels.at((frame.min.x + x) as u32, (frame.min.y + y) as u32);
        pixel.map(|p| p[0])
    };
    assert_eq!(at(49.0, 49.0), Some(0));
    assert_eq!(at(50.0, 49.0), Some(255));
    assert_eq!(at(50.0, 50.0), Some(0));

    // Tiles of several sides stand side by side with the same gap.
    let sides = [100.0, 60.0, 80.0];
    let of_side = |side: f64| {
        Panel::Tile(TileChart {
            side: Some(side),
            ..tile("a")
        })
    };
    let drawn = figure_scene(&figure(sides.map(of_side).to_vec()), &Palette::LIGHT).unwrap();
    let frames: Vec<_> = (drawn.groups.iter())
        .filter(|group| group.name == "tile")
        .filter_map(|group| group.clip)
        .collect();
    assert_eq!(frames.len(), 3);
    let gaps = [0, 1].map(|left| frames[left + 1].min.x - frames[left].max.x);
    assert!((gaps[0] - gaps[1]).abs() < 1e-9, "{gaps:?}");

    let mixed = figure(vec![Panel::Tile(tile("a")), Panel::Image(image())]);
    let mixed = figure_scene(&mixed, &Palette::LIGHT);
    assert!(matches!(mixed, Err(ChartError::Mixed(_))));
}

#[test]
fn long_titles_of_tiles_are_made_to_fit_and_axes_and_scales_have_their_words() {
    let ticks = vec![(-1.0, "low".to_owned()), (1.0, "high".to_owned())];
    let named = TileChart {
        y: Some(Axis::new("row").with_range(-1.0, 1.0).with_ticks(ticks)),
        ..tile(&"wide ".repeat(30))
    };
    let scale = ColorScale {
        ends: ["power 0".to_owned(), "3".to_owned()],
        colors: vec![[255; 3], [0; 3]],
    };
    let drawn = figure(vec![Panel::Tile(named), Panel::Scale(scale)]);
    let drawn = figure_scene(&drawn, &Palette::LIGHT).unwrap();
    let place = |name: &str| {
        scene_texts(&drawn)
            .find(|text| text.text.starts_with(name))
            .unwrap()
    };
    let wide = place("wide");
    assert!(crate::text_width(&wide.text, wide.font, wide.size) <= 100.0 + 1e-9);
    let [low, high] = ["low", "high"].map(|name| place(name).at);
    assert!((low.y - high.y - 100.0).abs() < 1e-9 && low.x < wide.at.x);
    assert!(place("row").quarter_turns == 3 && place("3").at.x > place("power 0").at.x);
}

#[test]
fn a_blank_chart_has_the_axes_of_the_chart_that_it_stands_for() {
    let blank = |cells| BlankChart {
        title: "Periodogram".to_owned(),
        x: Axis::new("nu x").with_range(-1.0, 1.0),
        y: Axis::new("nu y").with_range(-1.0, 1.0),
        cells,
        why: "1 sample stands; at least 2 are needed to be measured.".to_owned(),
    };
    let cell = Rect::new([10.0, 20.0], [310.0, 420.0]);
    let drawn = |panel: &Panel| panel_groups(panel, cell, &Palette::LIGHT);
    let named = |groups: &[Group], name: &str| {
        let found = groups.iter().find(|group| group.name == name);
        found.cloned()
    };
    let full = drawn(&Panel::Image(image())).unwrap();
    let empty = drawn(&Panel::Blank(blank(Some([3, 3])))).unwrap();
    assert_eq!(named(&empty, "axes"), named(&full, "axes"));
    assert!(named(&full, "cells").is_some() && named(&empty, "cells").is_none());

    // The words are in the plot, on more than one line where it is narrow.
    let words = named(&empty, "nothing to show").unwrap().shapes;
    assert!(words.len() > 1);
    let Shape::Rect { rect: plot, .. } = named(&empty, "axes").unwrap().shapes[0] else {
        panic!("a border");
    };
    for word in words {
        let Shape::Text(text) = word else {
            panic!("words");
        };
        assert!(plot.meets(&Rect::new(text.at, text.at + 1.0)), "{text:?}");
    }

    // A plot of curves takes all of its place.
    let curves = drawn(&Panel::Blank(blank(None))).unwrap();
    let Shape::Rect { rect, .. } = named(&curves, "axes").unwrap().shapes[0] else {
        panic!("a border");
    };
    assert_eq!(panel_around(rect), cell);

    let refused = Panel::Blank(blank(Some([0, 3])));
    assert_eq!(
        drawn(&refused),
        Err(ChartError::Empty("Periodogram".to_owned()))
    );
    let without_range = BlankChart {
        x: Axis::new("nu x"),
        ..blank(None)
    };
    let refused = drawn(&Panel::Blank(without_range));
    assert_eq!(refused, Err(ChartError::Range("nu x".to_owned())));
    assert!(
        drawn(&Panel::Bars(BarChart {
            label: String::new(),
            groups: Vec::new()
        }))
        .is_err()
    );
}
