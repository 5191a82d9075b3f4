//! What several experiments have in common: parameters of sets with seeds of their own, intervals of counts, and charts.
//! Nothing here measures or decides.

use tilescope_analysis::measures::chi_square_quantile;
use tilescope_core::{Parameters, PatternSpec};
use tilescope_figures::chart::{Axis, Figure, LineChart, Look, Panel, Series, figure_scene};
use tilescope_figures::{Anchor, Group, Palette, Rect, Shape, Style, Text};

use crate::error::ReproduceError;
use crate::numbers::number;
use crate::outcome::{Column, Picture};
use crate::study::Settings;

/// About the samples of a KDRT set to a squared radius.
const DENSITY: f64 = 0.698;
/// What an interval of a count misses.
const MISSED: f64 = 0.01;

/// Returns the parameters of a periodic square with about `samples`, in units of the radius.
pub fn square(samples: f64, leaf: f64) -> Parameters {
    let side = (samples / DENSITY).sqrt();
    Parameters {
        width: side,
        height: side,
        radius: 1.0,
        leaf,
        ..Parameters::default()
    }
}

/// Returns the seed of the set `index` of an experiment.
pub fn seed(settings: &Settings, index: usize) -> u64 {
    settings.seed.wrapping_mul(1000).wrapping_add(index as u64)
}

/// Gives a set a seed and a pattern of its own.
pub fn seeded(parameters: Parameters, seed: u64) -> Parameters {
    let pattern = PatternSpec {
        seed,
        ..parameters.pattern
    };
    Parameters {
        seed,
        pattern,
        ..parameters
    }
}

/// Returns a curve.
pub fn curve(name: &str, number: usize, points: Vec<[f64; 2]>) -> Series {
    Series {
        name: name.to_owned(),
        look: Look::Numbered(number),
        points,
        band: None,
    }
}

/// Returns what others are held against.
pub fn reference(name: &str, points: Vec<[f64; 2]>) -> Series {
    Series {
        look: Look::Reference,
        ..curve(name, 0, points)
    }
}

/// Returns curves over axes that reach as far as their data.
pub fn chart(title: &str, x: &str, y: &str, series: Vec<Series>) -> LineChart {
    LineChart {
        title: title.to_owned(),
        x: Axis::new(x),
        y: Axis::new(y),
        series,
        levels: Vec::new(),
    }
}

/// Returns the picture of panels side by side, one row.
pub fn picture(
    name: &str,
    title: &str,
    caption: String,
    rows: Vec<Vec<Panel>>,
) -> Result<Picture, ReproduceError> {
    let figure = Figure {
        title: title.to_owned(),
        rows,
    };
    Ok(Picture {
        name: name.to_owned(),
        caption,
        scene: figure_scene(&figure, &Palette::LIGHT)?,
    })
}

/// Returns what shades of power mean, from white to what is black, beside a title; it ends before `right`.
pub fn ramp(right: f64, black: f64, palette: &Palette) -> Group {
    let (steps, wide, at) = (32_u8, 4.0, [right - 170.0, 20.0]);
    let mut group = Group::new("ramp");
    for step in 0..steps {
        let x = at[0] + wide * f64::from(step);
        let level = 255 - (255 * u16::from(step) / u16::from(steps - 1)) as u8;
        group.shapes.push(Shape::Rect {
            rect: Rect::new([x, at[1]], [x + wide, at[1] + 14.0]),
            style: Style::filled([level, level, level, 255]),
        });
    }
    let end = at[0] + wide * f64::from(steps);
    group.shapes.push(Shape::Rect {
        rect: Rect::new(at, [end, at[1] + 14.0]),
        style: Style::stroked(palette.muted, 1.0),
    });
    let base = at[1] + 12.0;
    let mut zero = Text::new([at[0] - 8.0, base], "power 0", 13.0, palette.text);
    zero.anchor = Anchor::End;
    let most = Text::new([end + 8.0, base], format!("{black}"), 13.0, palette.text);
    group.shapes.extend([zero, most].map(Shape::Text));
    group
}

/// Returns columns of their keys, heads and digits.
pub fn columns(heads: &[(&str, &str, usize)]) -> Vec<Column> {
    let column = |(key, head, digits): &(&str, &str, usize)| Column::new(key, head, *digits);
    heads.iter().map(column).collect()
}

/// Returns a count with all its digits, in groups of three.
pub fn counted(count: usize) -> String {
    let digits = count.checked_ilog10().unwrap_or(0) as usize + 1;
    number(count as f64, digits)
}

/// Returns where the mean of a Poisson variable is, with 99 % confidence, of which `count` was seen.
pub fn poisson_interval(count: usize) -> [f64; 2] {
    let bound = |tail: f64, events: usize| 0.5 * chi_square_quantile(tail, 2.0 * events as f64);
    let low = if count == 0 {
        0.0
    } else {
        bound(1.0 - 0.5 * MISSED, count)
    };
    [low, bound(0.5 * MISSED, count + 1)]
}
