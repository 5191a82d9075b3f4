//! What several experiments have in common: parameters of sets with seeds of their own, and charts.
//! Nothing here measures or decides.

use tilescope_core::{Parameters, PatternSpec};
use tilescope_figures::Palette;
use tilescope_figures::chart::{Axis, Figure, LineChart, Look, Panel, Series, figure_scene};

use crate::error::ReproduceError;
use crate::outcome::{Column, Picture};
use crate::report::number;
use crate::study::Settings;

/// About the samples of a KDRT set to a squared radius.
const DENSITY: f64 = 0.698;

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
