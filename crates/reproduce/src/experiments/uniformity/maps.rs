//! Maps of the domain: how far each cell is from the mean, in colours that the colour-blind tell apart, with their scale.
//! They show and decide nothing.

use tilescope_figures::{
    Anchor, Baseline, Bitmap, Font, Group, Palette, Rect, Scene, Shape, Stroke, Style, Text,
};

use super::subject::{Found, Subject};
use crate::error::ReproduceError;
use crate::numbers::number;
use crate::outcome::Picture;

/// Deviation at which colours end.
const END: f64 = 0.1;
/// From blue over nearly white to red, in equal steps: told apart without red or without green as well.
const COLORS: [[u8; 3]; 5] = [
    [5, 48, 97],
    [67, 147, 195],
    [247, 247, 247],
    [214, 96, 77],
    [103, 0, 31],
];
const WIDTH: f64 = 1200.0;
const MARGIN: f64 = 20.0;
const BETWEEN: f64 = 24.0;
/// Maps beside each other.
const COLUMNS: usize = 3;
const TITLE: f64 = 52.0;
const HEAD: f64 = 26.0;

/// Returns the colour of a deviation.
fn color(deviation: f64) -> [u8; 3] {
    let steps = (COLORS.len() - 1) as f64;
    let at = (0.5 * (deviation / END).clamp(-1.0, 1.0) + 0.5) * steps;
    let from = (at as usize).min(COLORS.len() - 2);
    let part = at - from as f64;
    [0, 1, 2].map(|k| {
        let [a, b] = [COLORS[from][k], COLORS[from + 1][k]].map(f64::from);
        (a + part * (b - a)).round() as u8
    })
}

/// Returns the maps of all sets, and the scale.
pub fn maps(found: &Found, cells: usize) -> Result<Picture, ReproduceError> {
    let Found {
        reference,
        moved,
        circumcentre,
        uniform,
        random,
        ..
    } = found;
    let shown = [reference, circumcentre, uniform, random, moved];
    let side = (WIDTH - 2.0 * MARGIN - (COLUMNS - 1) as f64 * BETWEEN) / COLUMNS as f64;
    let place = |index: usize| {
        let across = (index % COLUMNS) as f64 * (side + BETWEEN);
        let down = (index / COLUMNS) as f64 * (side + HEAD + BETWEEN);
        [MARGIN + across, TITLE + HEAD + down]
    };
    let palette = Palette::LIGHT;
    let mut shapes = vec![bold([MARGIN, 34.0], "Samples by place in the domain", 20.0)];
    for (index, subject) in shown.into_iter().enumerate() {
        shapes.extend(map(subject, cells, place(index), side)?);
    }
    shapes.extend(scale(place(shown.len()), side)?);
    let end = |index: usize| place(index)[1] + side + MARGIN;
    let mut scene = Scene::new(WIDTH, end(shown.len()), palette.background);
    "Samples by place in the domain".clone_into(&mut scene.title);
    let mut group = Group::new("maps");
    group.shapes = shapes;
    scene.groups.push(group);
    Ok(Picture {
        name: "maps".to_owned(),
        caption: format!(
            "Samples in each of {cells} x {cells} cells of the domain, against the mean: blue fewer, red more, from {} % to +{} %. \
             The last map is the control with a bias put in.",
            number(-100.0 * END, 2),
            number(100.0 * END, 2)
        ),
        scene,
    })
}

/// Returns the map of a subject, y upwards, with its name above.
fn map(
    subject: &Subject,
    cells: usize,
    [x, y]: [f64; 2],
    side: f64,
) -> Result<[Shape; 3], ReproduceError> {
    let deviations = &subject.cells.deviations;
    let rows = deviations.chunks(cells).rev().flatten();
    let colors: Vec<[u8; 3]> = rows.map(|cell| color(cell.relative)).collect();
    let rect = Rect::new([x, y], [x + side, y + side]);
    Ok([
        bold([x, y - 9.0], subject.name, 14.0),
        Shape::Image {
            rect,
            bitmap: Bitmap::rgb(cells, &colors)?,
        },
        frame(rect),
    ])
}

/// Returns the scale of colours, with percentages beside it.
fn scale([x, y]: [f64; 2], side: f64) -> Result<Vec<Shape>, ReproduceError> {
    const STEPS: usize = 101;
    let deviation = |step: usize| END * (1.0 - 2.0 * step as f64 / (STEPS - 1) as f64);
    let colors: Vec<[u8; 3]> = (0..STEPS).map(|step| color(deviation(step))).collect();
    let rect = Rect::new([x, y], [x + 30.0, y + side]);
    let mut shapes = vec![
        bold([x, y - 9.0], "samples of a cell, % from the mean", 14.0),
        Shape::Image {
            rect,
            bitmap: Bitmap::rgb(1, &colors)?,
        },
        frame(rect),
    ];
    for tick in 0..=4 {
        let share = 0.25 * f64::from(tick);
        let value = 100.0 * END * (1.0 - 2.0 * share);
        let sign = if value > 0.0 { "+" } else { "" };
        let at = [x + 40.0, y + share * side];
        let words = format!("{sign}{} %", number(value, 1));
        let mut text = Text::new(at, words, 14.0, Palette::LIGHT.text);
        (text.anchor, text.baseline) = (Anchor::Start, Baseline::Middle);
        shapes.push(Shape::Text(text));
    }
    Ok(shapes)
}

fn frame(rect: Rect) -> Shape {
    Shape::Rect {
        rect,
        style: Style {
            fill: None,
            stroke: Some(Stroke::new(Palette::LIGHT.muted, 1.0)),
        },
    }
}

fn bold(at: [f64; 2], text: &str, size: f64) -> Shape {
    let mut text = Text::new(at, text, size, Palette::LIGHT.text);
    text.font = Font::SemiBold;
    Shape::Text(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_white_in_the_middle_and_end_at_the_ends() {
        assert_eq!(color(0.0), COLORS[2]);
        assert_eq!([color(-END), color(-1.0)], [COLORS[0]; 2]);
        assert_eq!([color(END), color(1.0)], [COLORS[4]; 2]);
        let [less, more] = [-0.05, 0.05].map(color);
        assert!(less[2] > less[0] && more[0] > more[2]);
    }
}
