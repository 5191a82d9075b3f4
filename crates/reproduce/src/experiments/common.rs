//! Common parts of experiments: parameters of sets with seeds of their own, intervals of counts, charts and pictures.

use serde_json::Value;
use tilescope_analysis::measures::student_quantile;
use tilescope_core::Parameters;
use tilescope_figures::chart::{
    BarChart, BarGroup, ColorScale, Figure, Look, Panel, Series, TileChart, TileContent,
    figure_scene,
};
use tilescope_figures::{Group, Palette, Scene, Shape};

use crate::error::Result;
use crate::outcome::Picture;
use crate::texts::{PictureText, name, picture_texts};

/// About the samples of a KDRT set to a squared radius.
pub const DENSITY: f64 = 0.698;
/// Probability that an interval of a count misses its mean.
pub const MISSED: f64 = 0.01;

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

/// Gives a set a seed and a pattern of its own.
pub fn seeded(parameters: Parameters, seed: u64) -> Parameters {
    let mut own = parameters;
    (own.seed, own.pattern.seed) = (seed, seed);
    own
}

/// Returns a curve with the look of this number: its colour, its dashes and its marks.
pub fn curve(name: &str, number: usize, points: Vec<[f64; 2]>) -> Series {
    Series {
        name: name.to_owned(),
        look: Look::Numbered(number),
        points,
        band: None,
    }
}

/// Returns the curve that others are compared with.
pub fn reference(name: &str, points: Vec<[f64; 2]>) -> Series {
    Series {
        look: Look::Reference,
        ..curve(name, 0, points)
    }
}

/// Returns the picture of rows of panels, named as its texts are.
pub fn picture(id: &str, values: &Value, rows: Vec<Vec<Panel>>) -> Result<Picture> {
    let PictureText { title, caption, .. } = picture_texts(id, values);
    let figure = Figure { title, rows };
    Ok(Picture {
        name: name(id),
        caption,
        scene: figure_scene(&figure, &Palette::LIGHT)?,
    })
}

/// Returns the picture of groups of bars over an axis of one quantity.
pub fn bar_picture(id: &str, values: &Value, groups: Vec<BarGroup>) -> Result<Picture> {
    let label = picture_texts(id, values).axis;
    let bars = Panel::Bars(BarChart { label, groups });
    picture(id, values, vec![vec![bars]])
}

/// Returns a square picture with its heading and the line below it; `side` is its size in pixels, if not the default.
pub fn tile(side: Option<f64>, title: &str, note: String, content: TileContent) -> TileChart {
    TileChart {
        title: title.to_owned(),
        note,
        y: None,
        side,
        content,
    }
}

/// Returns ticks at whole numbers.
pub fn whole_ticks(reach: f64) -> Vec<(f64, String)> {
    let most = reach as i32;
    let label = |value: i32| value.to_string().replace('-', "\u{2212}");
    (-most..=most)
        .map(|value| (f64::from(value), label(value)))
        .collect()
}

/// Adds a group of shapes in the units and the view of the samples, above them.
pub fn above_samples(scene: &mut Scene, name: &str, shapes: Vec<Shape>) {
    if let Some(samples) = scene.groups.iter().find(|group| group.name == "samples") {
        let name = name.to_owned();
        let group = Group {
            name,
            shapes,
            ..samples.clone()
        };
        scene.groups.push(group);
    }
}

/// Returns the scale of shades of power, from white at 0 to black.
pub fn power_scale(black: f64) -> Panel {
    let shades = (0..32_u16).map(|step| [255 - (255 * step / 31) as u8; 3]);
    Panel::Scale(ColorScale {
        ends: ["power 0".to_owned(), black.to_string()],
        colors: shades.collect(),
    })
}

/// Returns the smallest and the largest of values, or infinities if there are none.
pub fn ends(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    })
}

/// Returns the largest of values that are not negative, or 0 if there are none.
pub fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, f64::max)
}

/// Returns the interval that holds the truth with probability 99 %, by the spread between `sets`. Of one set nothing is known.
pub fn interval([value, error]: [f64; 2], sets: usize) -> Option<[f64; 2]> {
    let reach = student_quantile(MISSED, sets.saturating_sub(1).max(1) as f64) * error;
    reach.is_finite().then_some([value - reach, value + reach])
}

/// Returns the slope of the straight line that fits points best, by least squares, or NaN.
pub fn slope(points: impl Iterator<Item = [f64; 2]> + Clone) -> f64 {
    let count = points.clone().count() as f64;
    let [x, y] = [0, 1].map(|axis| points.clone().map(|at| at[axis]).sum::<f64>() / count);
    let both: f64 = points.clone().map(|at| (at[0] - x) * (at[1] - y)).sum();
    both / points.map(|at| (at[0] - x).powi(2)).sum::<f64>()
}
