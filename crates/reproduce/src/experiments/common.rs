//! What several experiments share: parameters of sets with seeds of their own, intervals of counts, charts and pictures.

use tilescope_analysis::measures::{Summary, chi_square_quantile};
use tilescope_core::{Parameters, PatternSpec};
use tilescope_figures::Palette;
use tilescope_figures::chart::{
    Axis, BarChart, BarGroup, ColorScale, Figure, LineChart, Look, Panel, Series, figure_scene,
};

use crate::error::ReproduceError;
use crate::numbers::number;
use crate::outcome::Picture;
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

/// Returns the picture of groups of bars over an axis of one quantity.
pub fn bar_picture(
    name: &str,
    title: &str,
    caption: String,
    (label, groups): (&str, Vec<BarGroup>),
) -> Result<Picture, ReproduceError> {
    let label = label.to_owned();
    let bars = Panel::Bars(BarChart { label, groups });
    picture(name, title, caption, vec![vec![bars]])
}

/// Returns the scale of shades of power, from white at 0 to black.
pub fn power_scale(black: f64) -> Panel {
    let shades = (0..32_u16).map(|step| [255 - (255 * step / 31) as u8; 3]);
    Panel::Scale(ColorScale {
        ends: ["power 0".to_owned(), black.to_string()],
        colors: shades.collect(),
    })
}

/// Quartiles of fewer values would be interpolations.
const FEW: usize = 5;

/// Returns where a whisker begins and ends: quartiles, or of few values the least and the most.
pub fn whisker(summary: &Summary) -> [f64; 2] {
    if summary.count < FEW {
        [summary.least, summary.most]
    } else {
        [summary.quartiles[0], summary.quartiles[2]]
    }
}

/// Returns what [`whisker`] is of so many rounds, for captions.
pub const fn whisker_words(rounds: usize) -> &'static str {
    if rounds < FEW {
        "from least to most"
    } else {
        "from quartile to quartile"
    }
}

/// Returns key and heading of columns with both ends of [`whisker`] of so many rounds.
pub const fn whisker_columns(rounds: usize) -> [(&'static str, &'static str); 2] {
    if rounds < FEW {
        [("least", "least"), ("most", "most")]
    } else {
        [
            ("quartile_1", "first quartile"),
            ("quartile_3", "third quartile"),
        ]
    }
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_values_have_no_quartiles() {
        let of = |values: &[f64]| {
            whisker(&Summary::of(values.iter().copied()).unwrap()).map(|end| end as i32)
        };
        assert_eq!(of(&[1.0, 3.0]), [1, 3]);
        assert_eq!(of(&[1.0, 2.0, 3.0, 4.0]), [1, 4]);
        assert_eq!(of(&[1.0, 2.0, 3.0, 4.0, 5.0]), [2, 4]);
        assert_eq!(whisker_words(2), "from least to most");
        assert_eq!(whisker_columns(5)[0].0, "quartile_1");
    }
}
