//! The figures and tables: for each radius a column for each method, from samples to anisotropy; and rates.

use serde_json::json;
use tilescope_analysis::measures::anisotropy_reference_db;
use tilescope_figures::chart::{Axis, Bar, BarGroup, ImageChart, Look, Panel, Series, TileContent};

use super::against::Against;
use super::method::{Method, PATTERN};
use super::spectra::MethodSpectra;
use crate::error::{ReproduceError, Result};
use crate::experiments::common::{
    bar_picture, curve, ends, picture, power_scale, tile, whole_ticks,
};
use crate::experiments::timing::{TimingPlan, whisker, whiskered};
use crate::numbers::drawn_number as number;
use crate::outcome::{Picture, Table};
use crate::rates::{EngineRate, ONE_LEAF, distinct};
use crate::sets::Set;
use crate::texts::{chart, table, text};

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
    let kdrt = leaves
        .iter()
        .map(|leaf| (Method::kdrt(*leaf), Method::Reference));
    let first = (Method::Reference, Method::Again);
    // Exact tiling is shown with the smallest leaf, with which it has the most seams.
    let exact = leaves
        .first()
        .map(|&leaf| (Method::Exact { leaf }, Method::Reference));
    [first].into_iter().chain(kdrt).chain(exact).collect()
}

/// Tilings whose regularity shows, beside one whose blocks fit its patterns; each over the reference.
pub fn regular() -> Vec<(Method, Method)> {
    let (leaf, side) = (80.0, PATTERN);
    let close = Method::Kdrt { leaf, side };
    let one = Method::OnePattern { leaf: ONE_LEAF };
    let methods = [Method::kdrt(leaf), close, one, Method::Copies];
    methods.map(|method| (method, Method::Reference)).into()
}

/// A method, and what its curves are drawn over.
type MethodColumn<'a> = (&'a MethodSpectra, &'a MethodSpectra);

/// Returns the figure of a radius: a column for each method with its set. Fails without columns.
pub fn spectra(
    name: &str,
    title: &str,
    columns: &[MethodColumn<'_>],
    sets: &[Set],
) -> Result<Picture> {
    // The caption takes its numbers from the first column.
    let Some((first, _)) = columns.first() else {
        let nothing = "there is no column to draw".to_owned();
        return Err(ReproduceError::Engine(nothing));
    };

    // All columns have one axis, so that they can be compared.
    let range = decibels(columns);
    let row = |panel: &dyn Fn(&MethodSpectra, &MethodSpectra) -> Panel| -> Vec<Panel> {
        let panels = columns.iter().map(|(one, below)| panel(one, below));
        panels.collect()
    };

    let samples = (columns.iter().zip(sets)).map(|((one, _), set)| samples_tile(one.method, set));
    let rows = vec![
        // The scale of shades is that of the periodograms in the next row.
        samples.chain([power_scale(BLACK)]).collect(),
        row(&|one, _| image(one, columns.len())),
        row(&power),
        row(&|one, below| anisotropy(one, below, range)),
    ];

    let (grid, [count, _]) = (&first.picture, first.count);
    // If there is a column of the reference sets, it is the first. Its curves are drawn over those of a second group of
    // reference sets: the caption says so.
    let over = first.method == Method::Reference;
    // `side` is how many frequencies wide a cell of the periodogram is.
    let values = json!({
        "title": title, "radius": first.radius, "samples": number(count, 3), "sets": first.sets,
        "shown": SHOWN, "black": BLACK,
        "side": (2.0 * grid.reach * count.sqrt() / grid.columns as f64).round(),
        "over": if over { text("fig13/over", &json!({})) } else { String::new() },
    });

    let drawn = picture("fig13/spectra", &values, rows)?;
    let radius = first.radius.to_string().replace('.', "-");
    Ok(Picture {
        name: format!("{name}-{radius}"),
        ..drawn
    })
}

/// Returns the dots of a part of a set under its method's name.
fn samples_tile(method: Method, set: &Set) -> Panel {
    let side = SHOWN * set.radius;
    let scaled = set.points.iter().map(|p| p.map(|x| x / side));
    // Samples up to 1 r beyond the upper edges, too: their dots may reach into the frame, which cuts them off.
    let inside = |p: &[f64; 2]| p.iter().all(|x| *x < (SHOWN + 1.0) / SHOWN);
    let dots = TileContent::Dots(scaled.filter(inside).collect());
    Panel::Tile(tile(None, &method.name(), String::new(), dots))
}

/// Returns how many of the `columns` of cells, an odd number, are shown in one of `plots` plots beside each other: an
/// odd number, too. The sides of cells are rounded up to half pixels; columns without room are left out at the rim.
fn cells(columns: usize, plots: usize) -> usize {
    let width = (WIDTH - 2.0 * MARGIN) / plots as f64 - LEFT - RIGHT;
    let cell = 0.5 * (2.0 * width / columns as f64).ceil();
    let fit = (width / cell) as usize;
    fit.min(columns) - usize::from(fit < columns && fit.is_multiple_of(2))
}

/// Returns the mean periodogram of a method, in one of the given number of plots beside each other.
fn image(one: &MethodSpectra, plots: usize) -> Panel {
    let grid = &one.picture;
    let shown = cells(grid.columns, plots);
    // The rim is left out on both sides alike, so that the zero frequency stays in the middle.
    let cut = (grid.columns - shown) / 2;
    let reach = grid.reach * shown as f64 / grid.columns as f64;

    let axis = |label: &str| Axis::new(label).with_range(-reach, reach);
    let rows = grid.values.chunks(grid.columns).skip(cut).take(shown);
    let values: Vec<f64> = rows
        .flat_map(|row| row[cut..cut + shown].iter())
        .copied()
        .map(f64::from)
        .collect();
    let middle = values.len() / 2;

    Panel::Image(ImageChart {
        title: "Mean periodogram".to_owned(),
        x: axis("kx / \u{221a}N").with_ticks(whole_ticks(reach)),
        y: axis("ky / \u{221a}N").with_ticks(whole_ticks(reach)),
        columns: shown,
        // Results keep a zero frequency without a value as 0.
        absent: (values[middle] == 0.0).then_some(middle),
        values,
        clamp: [0.0, BLACK],
    })
}

/// Look of a method's curve: by the leaf, so that one leaf looks the same in all figures.
fn look(method: Method) -> Look {
    // The limits between leaves lie between those that are measured, of 20, 40 and 80 r.
    match method {
        Method::Reference => Look::Reference,
        Method::Again => Look::Numbered(3),
        Method::Kdrt { leaf, .. } if leaf < 30.0 => Look::Numbered(0),
        Method::Kdrt { leaf, .. } if leaf < 60.0 => Look::Numbered(1),
        Method::Kdrt { .. } if method.fits() => Look::Numbered(2),
        Method::Kdrt { .. } => Look::Numbered(4),
        Method::OnePattern { .. } => Look::Numbered(5),
        Method::Exact { .. } => Look::Numbered(7),
        Method::Copies => Look::Numbered(6),
    }
}

/// Returns a chart by frequency.
fn by_frequency(id: &str, series: Vec<Series>, [low, high]: [f64; 2]) -> Panel {
    let mut chart = chart(id, series);
    chart.x.range = Some([0.0, NU]);
    chart.x.ticks = Some(whole_ticks(NU));
    chart.y.range = Some([low, high]);
    Panel::Lines(chart)
}

/// Returns the curve of a method with a value at each frequency.
fn series(of: &MethodSpectra, value: impl Fn(usize) -> Option<f64>) -> Series {
    let points =
        (of.curves.nu.iter().enumerate()).filter_map(|(index, nu)| Some([*nu, value(index)?]));
    Series {
        look: look(of.method),
        ..curve(&of.method.name(), 0, points.collect())
    }
}

/// Returns the chart of mean powers, from 0 to 2: these ends are chosen, not measured. A curve without a band at every
/// frequency has none.
fn power(one: &MethodSpectra, below: &MethodSpectra) -> Panel {
    let [below, own] = [below, one].map(|of| series(of, |index| Some(of.curves.power[index])));
    let band = Some(one.curves.band.clone()).filter(|band| band.len() == one.curves.nu.len());
    let own = Series { band, ..own };
    by_frequency("fig13/power", vec![below, own], [0.0, 2.0])
}

/// The range of all anisotropies and of noise's level, with a little room (chosen, not measured), so that an axis has a
/// length even if all are equal: one axis for all columns.
fn decibels(columns: &[MethodColumn<'_>]) -> [f64; 2] {
    let methods = columns.iter().flat_map(|(one, below)| [one, below]);
    let all = methods.flat_map(|of| {
        let values = of.curves.anisotropy.iter().flatten().copied();
        values.chain([anisotropy_reference_db(of.sets)])
    });
    let [low, high] = ends(all);
    let room = (0.08 * (high - low)).max(0.1);
    [low - room, high + room]
}

fn anisotropy(one: &MethodSpectra, below: &MethodSpectra, range: [f64; 2]) -> Panel {
    // The reference's curve runs along the level of noise: on top that is seen.
    let [below, own] = [below, one].map(|of| series(of, |index| of.curves.anisotropy[index]));
    by_frequency("fig13/anisotropy", vec![below, own, noise(one)], range)
}

/// The level of sets without preferred directions, and where chance takes their rings.
fn noise(one: &MethodSpectra) -> Series {
    let level = anisotropy_reference_db(one.sets);
    let rings = (one.curves.nu.iter().zip(&one.curves.noise))
        .filter_map(|(nu, ends)| Some((*nu, (*ends)?)));
    let (points, band) = rings.map(|(nu, ends)| ([nu, level], ends)).unzip();
    Series {
        band: Some(band),
        // No method has the look of this number.
        ..curve("noise, 95 % of its rings", 11, points)
    }
}

/// Returns the chart of rates, with a group of bars for each leaf size, and one for the engines that make sets from
/// scratch.
pub fn rates(rows: &[EngineRate], plan: TimingPlan) -> Result<Picture> {
    let heading = |row: &EngineRate| {
        let leaf = row.leaf.map(|leaf| format!("KDRT, leaf {leaf} r"));
        // Only the engines that tile a pattern have a leaf size.
        leaf.unwrap_or_else(|| "From scratch".to_owned())
    };

    let group = |(color, heading_of): (usize, String)| {
        let rows = rows.iter().filter(|row| heading(row) == heading_of);
        let bars = rows.map(|row| bar(row, color)).collect();
        BarGroup {
            heading: heading_of.clone(),
            bars,
        }
    };

    let headings = distinct(rows.iter().map(heading)).into_iter();
    let groups = headings.enumerate().map(group).collect();
    bar_picture("fig13/rates", &plan.values(), groups)
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

/// Returns the table of the sets' quality by radius and method.
pub fn quality(found: &[MethodSpectra], against: &[Against]) -> Table {
    table("fig13/quality", found, |one| {
        let same = |held: &&Against| {
            // Both radii come from one list, so that their bits are equal.
            held.radius.to_bits() == one.radius.to_bits() && held.method == one.method
        };

        // A method that could not be compared with both groups of reference sets has no differences in its row.
        let held = against.iter().find(same);
        let percent = |value: fn(&Against) -> f64| held.map(|held| 100.0 * value(held));

        json!({
            "radius": one.radius, "method": one.method.name(), "sets": one.sets,
            "samples": one.count[0].round() as u64, "samples_sd": one.count[1],
            "density": one.density(), "min_distance_r": one.min_distance,
            "covering_radius_r": one.covering_radius, "low_power": one.low_power(),
            "nyquist": one.nyquist, "oscillation": one.oscillation,
            "difference_percent": percent(|held| held.difference),
            "chance_percent": percent(|held| held.chance), "left_percent": percent(|held| held.left),
            "anisotropy_db": one.excess, "anisotropy_alone_db": one.excess_alone,
            "peak": one.peaks.highest, "peak_limit": one.peaks.limit, "peaks_above": one.peaks.above,
        })
    })
}

/// Returns the table of rates.
pub fn rate_table(rows: &[EngineRate]) -> Table {
    table("fig13/rates", rows, |row| {
        // Rates are in millions of samples a second.
        whiskered(
            &row.rate,
            1e-6,
            json!({
                "method": row.engine.name(), "leaf_r": row.leaf, "threads": row.engine.threads(),
                "samples": row.count.round() as u64, "rounds": row.rate.count,
                "million_per_second": row.rate.quartiles[1] / 1e6, "ratio": row.ratio.quartiles[1],
                "density": row.density, "min_distance_r": row.min_distance,
                "covering_radius_r": row.covering_radius,
            }),
        )
    })
}

pub fn curves(found: &[MethodSpectra]) -> Table {
    let rows = found
        .iter()
        .flat_map(|one| (0..one.curves.nu.len()).map(move |index| (one, index)));
    table("fig13/curves", rows, |(one, index)| {
        let curves = &one.curves;
        let band = |end: usize| curves.band.get(index).map(|ends| ends[end]);
        json!({
            "radius": one.radius, "method": one.method.name(), "nu": curves.nu[index],
            "power": curves.power[index], "band_low": band(0), "band_high": band(1),
            "anisotropy_db": curves.anisotropy[index],
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_fill_the_plot_and_zero_stays_in_the_middle() {
        for (plots, room) in [(4, 206.0), (5, 148.0)] {
            for columns in (9..=121).step_by(2) {
                let shown = cells(columns, plots);
                assert!(shown % 2 == 1 && shown <= columns, "{columns}: {shown}");
                let cell = 0.5 * (2.0 * room / columns as f64).ceil();
                let width = cell * shown as f64;
                assert!(
                    width <= room && width > room - 2.0 * cell,
                    "{columns}: {width}"
                );
            }
        }
    }
}
