//! The figures: for each radius a column for each method, from samples to anisotropy; and the rates.

use tilescope_analysis::measures::anisotropy_reference_db;
use tilescope_figures::chart::{
    Axis, Bar, BarGroup, ImageChart, LineChart, Look, Panel, Series, TileChart, TileContent,
};

use super::method::{Method, PATTERN};
use super::spectra::MethodSpectra;
use crate::error::ReproduceError;
use crate::experiments::common::{bar_picture, ends, picture, power_scale};
use crate::experiments::timing::{whisker, whisker_words};
use crate::numbers::drawn_number as number;
use crate::outcome::Picture;
use crate::rates::{EngineRate, ONE_LEAF};
use crate::sets::Set;

/// Side in radii of the part of a set that is shown.
const SHOWN: f64 = 36.0;
/// Frequencies are shown up to this `nu`.
const NU: f64 = 2.5;
/// Width of the figure, its margin, and the room left and right of a plot, as charts have them.
const WIDTH: f64 = 1200.0;
const MARGIN: f64 = 20.0;
const LEFT: f64 = 66.0;
const RIGHT: f64 = 18.0;
/// Power that is black: between the mean and what rings of ten sets reach.
const BLACK: f64 = 2.5;

/// Methods that have a column, and what each is drawn over.
pub fn columns(leaves: &[f64]) -> Vec<(Method, Method)> {
    let kdrt = leaves.iter().map(|leaf| Method::kdrt(*leaf));
    let kdrt = kdrt.map(|method| (method, Method::Reference));
    [(Method::Reference, Method::Again)]
        .into_iter()
        .chain(kdrt)
        .collect()
}

/// Tilings whose regularity shows, beside one whose blocks fit its patterns; each over the reference.
pub fn regular() -> Vec<(Method, Method)> {
    let leaf = 80.0;
    let methods = [
        Method::kdrt(leaf),
        Method::Kdrt {
            leaf,
            side: PATTERN,
        },
        Method::OnePattern { leaf: ONE_LEAF },
        Method::Copies,
    ];
    methods.map(|method| (method, Method::Reference)).to_vec()
}

/// A method, and what its curves are drawn over.
type Column<'a> = (&'a MethodSpectra, &'a MethodSpectra);

/// Returns the figure of a radius: a column for each method with its set, the reference first.
pub fn spectra(
    (name, title): (&str, &str),
    columns: &[Column<'_>],
    sets: &[Set],
) -> Result<Picture, ReproduceError> {
    let Some((reference, _)) = columns.first() else {
        let nothing = "there is no column to draw".to_owned();
        return Err(ReproduceError::Engine(nothing));
    };
    let range = decibels(columns);
    let row = |panel: &dyn Fn(&MethodSpectra, &MethodSpectra) -> Panel| -> Vec<Panel> {
        let panels = columns.iter().map(|(one, below)| panel(one, below));
        panels.collect()
    };
    let samples = columns.iter().zip(sets);
    let samples = samples.map(|((one, _), set)| samples_tile(one.method, set));
    let figure_title = format!(
        "{title}: radius {}, about {} samples, {} sets of each",
        reference.radius,
        number(reference.count[0], 3),
        reference.sets
    );
    let rows = vec![
        samples.chain([power_scale(BLACK)]).collect(),
        row(&image),
        row(&power),
        row(&|one, below| anisotropy(one, below, range)),
    ];
    let radius = reference.radius.to_string().replace('.', "-");
    let caption = caption(title, reference, columns);
    picture(&format!("{name}-{radius}"), &figure_title, caption, rows)
}

fn caption(title: &str, first: &MethodSpectra, columns: &[Column<'_>]) -> String {
    let side =
        (2.0 * first.picture.reach * first.count[0].sqrt() / first.picture.columns as f64).round();
    let second = columns
        .iter()
        .any(|(_, below)| below.method == Method::Again);
    format!(
        "{title}, radius {}: a part of one set {SHOWN} r wide; mean periodogram of {} sets, each cell the mean of {side} x {side} frequencies, white none, \
         black {BLACK} and more; its radial mean, with the band that holds the true one with 95 % probability; its anisotropy, frequency by \
         frequency, beside the level of noise, which sets without preferred directions have, \
         and the band that holds 95 % of their rings. Dashed: the reference sets{}.",
        first.radius,
        first.sets,
        if second {
            "; in their own column, over a second group of them"
        } else {
            ""
        }
    )
}

/// Returns the dots of a part of a set under its method's name.
fn samples_tile(method: Method, set: &Set) -> Panel {
    let scaled = set
        .points
        .iter()
        .map(|p| p.map(|x| x / (SHOWN * set.radius)));
    let inside = |p: &[f64; 2]| p.iter().all(|x| *x < (SHOWN + 1.0) / SHOWN);
    Panel::Tile(TileChart {
        title: method.name(),
        note: String::new(),
        y: None,
        side: None,
        content: TileContent::Dots(scaled.filter(inside).collect()),
    })
}

/// Returns how many of so many cells, an odd number, fill a quarter of the width with cells of half pixels: what they
/// leave out is the rim.
fn cells(columns: usize) -> usize {
    let width = 0.25 * (WIDTH - 2.0 * MARGIN) - LEFT - RIGHT;
    let cell = 0.5 * (2.0 * width / columns as f64).ceil();
    let fit = (width / cell) as usize;
    fit.min(columns) - usize::from(fit < columns && fit.is_multiple_of(2))
}

fn image(one: &MethodSpectra, _: &MethodSpectra) -> Panel {
    let grid = &one.picture;
    let shown = cells(grid.columns);
    let cut = (grid.columns - shown) / 2;
    let reach = grid.reach * shown as f64 / grid.columns as f64;
    let axis = |label: &str| Axis::new(label).with_range(-reach, reach);
    let rows = grid.values.chunks(grid.columns).skip(cut).take(shown);
    let values: Vec<f64> = rows
        .flat_map(|row| row[cut..cut + shown].iter().map(|v| f64::from(*v)))
        .collect();
    let middle = values.len() / 2;
    Panel::Image(ImageChart {
        title: "Mean periodogram".to_owned(),
        x: axis("kx / \u{221a}N").with_ticks(whole(reach)),
        y: axis("ky / \u{221a}N").with_ticks(whole(reach)),
        columns: shown,
        absent: (values[middle] == 0.0).then_some(middle),
        values,
        clamp: [0.0, BLACK],
    })
}

/// Ticks at whole numbers.
fn whole(reach: f64) -> Vec<(f64, String)> {
    let most = reach as i32;
    let label = |value: i32| value.to_string().replace('-', "\u{2212}");
    (-most..=most)
        .map(|value| (f64::from(value), label(value)))
        .collect()
}

/// The axis of curves by frequency.
fn frequencies() -> Axis {
    Axis::new("\u{3bd} = |k| / \u{221a}N")
        .with_range(0.0, NU)
        .with_ticks(whole(NU))
}

/// Look of a method's curve: by the leaf, so that one leaf looks the same in all figures.
fn look(method: Method) -> Look {
    match method {
        Method::Reference => Look::Reference,
        Method::Again => Look::Numbered(3),
        Method::Kdrt { leaf, .. } if leaf < 30.0 => Look::Numbered(0),
        Method::Kdrt { leaf, .. } if leaf < 60.0 => Look::Numbered(1),
        Method::Kdrt { .. } if method.fits() => Look::Numbered(2),
        Method::Kdrt { .. } => Look::Numbered(4),
        Method::OnePattern { .. } => Look::Numbered(5),
        Method::Copies => Look::Numbered(6),
    }
}

fn power(one: &MethodSpectra, below: &MethodSpectra) -> Panel {
    let series = |of: &MethodSpectra, band: bool| Series {
        name: of.method.name(),
        look: look(of.method),
        points: points(of, |index| Some(of.curves.power[index])),
        band: (band && of.curves.band.len() == of.curves.nu.len()).then(|| of.curves.band.clone()),
    };
    Panel::Lines(LineChart {
        title: "Radial mean power".to_owned(),
        x: frequencies(),
        y: Axis::new("power").with_range(0.0, 2.0),
        series: vec![series(below, false), series(one, true)],
        levels: Vec::new(),
    })
}

/// The range of all anisotropies and of noise's level, with a little room: one axis for all columns.
fn decibels(columns: &[Column<'_>]) -> [f64; 2] {
    let all = columns.iter().flat_map(|(one, below)| [one, below]);
    let all = all.flat_map(|of| {
        let noise = anisotropy_reference_db(of.sets);
        of.curves
            .anisotropy
            .iter()
            .flatten()
            .copied()
            .chain([noise])
    });
    let [low, high] = ends(all);
    let room = (0.08 * (high - low)).max(0.1);
    [low - room, high + room]
}

fn anisotropy(one: &MethodSpectra, below: &MethodSpectra, [low, high]: [f64; 2]) -> Panel {
    let series = |of: &MethodSpectra| Series {
        name: of.method.name(),
        look: look(of.method),
        points: points(of, |index| of.curves.anisotropy[index]),
        band: None,
    };
    Panel::Lines(LineChart {
        title: "Anisotropy".to_owned(),
        x: frequencies(),
        y: Axis::new("anisotropy, dB").with_range(low, high),
        // The reference's curve runs along it: on top it is seen.
        series: vec![series(below), series(one), noise(one)],
        levels: Vec::new(),
    })
}

/// The level of sets without preferred directions, and where chance takes their rings.
fn noise(one: &MethodSpectra) -> Series {
    let level = anisotropy_reference_db(one.sets);
    let rings = one.curves.nu.iter().zip(&one.curves.noise);
    let rings = rings.filter_map(|(nu, ends)| Some((*nu, (*ends)?)));
    let (points, band) = rings.map(|(nu, ends)| ([nu, level], ends)).unzip();
    Series {
        name: "noise, 95 % of its rings".to_owned(),
        look: Look::Numbered(11),
        points,
        band: Some(band),
    }
}

fn points(of: &MethodSpectra, value: impl Fn(usize) -> Option<f64>) -> Vec<[f64; 2]> {
    let each = of.curves.nu.iter().enumerate();
    each.filter_map(|(index, nu)| Some([*nu, value(index)?]))
        .collect()
}

/// Returns the figure of the rates.
pub fn rates(rows: &[EngineRate], samples: u64, rounds: u64) -> Result<Picture, ReproduceError> {
    let mut groups: Vec<BarGroup> = Vec::new();
    for row in rows {
        let heading = row.leaf.map_or_else(
            || "From scratch".to_owned(),
            |leaf| format!("KDRT, leaf {leaf} r"),
        );
        let known = groups.iter().position(|group| group.heading == heading);
        let group = known.unwrap_or_else(|| {
            let bars = Vec::new();
            groups.push(BarGroup { heading, bars });
            groups.len() - 1
        });
        groups[group].bars.push(bar(row, group));
    }
    let title = format!(
        "Millions of samples a second, sets of about {}, and times the reference on one thread",
        number(samples as f64, 3)
    );
    let caption = format!(
        "Rates of every engine, the pattern ready-made: medians of {rounds} rounds, whiskers {}; behind them the ratio to \
         the reference sampler on one thread in the same round.",
        whisker_words(rounds as usize)
    );
    let bars = ("rate, millions of samples a second", groups);
    bar_picture("rates", &title, caption, bars)
}

fn bar(row: &EngineRate, color: usize) -> Bar {
    let median = row.rate.quartiles[1] / 1e6;
    let ratio = number(row.ratio.quartiles[1], 3);
    Bar {
        name: format!("{}{}", row.engine.name(), threads(row.engine.threads())),
        value: median,
        whisker: Some(whisker(&row.rate).map(|rate| rate / 1e6)),
        text: format!("{} ({ratio} x)", number(median, 3)),
        color,
    }
}

fn threads(threads: Option<usize>) -> String {
    match threads {
        None => String::new(),
        Some(1) => ", 1 thread".to_owned(),
        Some(threads) => format!(", {threads} threads"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_fill_the_plot_and_zero_stays_in_the_middle() {
        for columns in (9..=121).step_by(2) {
            let shown = cells(columns);
            assert!(shown % 2 == 1 && shown <= columns, "{columns}: {shown}");
            let cell = 0.5 * (2.0 * 206.0 / columns as f64).ceil();
            let width = cell * shown as f64;
            assert!(
                width <= 206.0 && width > 206.0 - 2.0 * cell,
                "{columns}: {width}"
            );
        }
    }
}
