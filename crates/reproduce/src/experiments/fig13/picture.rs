//! The figures: for each radius a column a method, from samples to anisotropy; and the rates.

use tilescope_analysis::measures::anisotropy_reference_db;
use tilescope_figures::chart::{
    Axis, Figure, ImageChart, LineChart, Look, Panel, Series, figure_scene,
};
use tilescope_figures::{
    Font, Group, Marker, Palette, Rect, Scene, Shape, Style, Text, View, text_width,
};

use super::SHARED;
use super::method::{Method, PATTERN};
use super::rates::Row;
use super::spectra::Found;
use crate::bars::{Bar, Bars, bars_scene, drawn_number as number, whisker, whisker_words};
use crate::error::ReproduceError;
use crate::experiments::common::ramp;
use crate::outcome::Picture;
use crate::sets::Set;

/// Side in radii of the part of a set that is shown.
const SHOWN: f64 = 36.0;
/// Frequencies are shown up to this `nu`.
const NU: f64 = 2.5;
/// Width of the figure, its margin, and the plot's place in a column, as charts have them.
const WIDTH: f64 = 1200.0;
const MARGIN: f64 = 20.0;
const LEFT: f64 = 66.0;
const RIGHT: f64 = 18.0;
/// Room above and below a square of samples.
const ABOVE: f64 = 34.0;
const BELOW: f64 = 16.0;
/// Size of a column's heading.
const HEADING: f64 = 15.0;
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
        Method::OnePattern { leaf: SHARED },
        Method::Copies,
    ];
    methods.map(|method| (method, Method::Reference)).to_vec()
}

/// A method, and what its curves are drawn over.
type Column<'a> = (&'a Found, &'a Found);

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
    let palette = Palette::LIGHT;
    let range = decibels(columns);
    let row = |panel: &dyn Fn(&Found, &Found) -> Panel| -> Vec<Panel> {
        columns
            .iter()
            .map(|(one, below)| panel(one, below))
            .collect()
    };
    let figure = Figure {
        title: format!(
            "{title}: radius {}, about {} samples, {} sets of each",
            reference.radius,
            number(reference.count[0], 3),
            reference.sets
        ),
        rows: vec![
            row(&image),
            row(&power),
            row(&|one, below| anisotropy(one, below, range)),
        ],
    };
    let mut scene = figure_scene(&figure, &palette)?;
    let column = (WIDTH - 2.0 * MARGIN) / columns.len() as f64;
    let side = column - LEFT - RIGHT;
    let top = first_panel(&scene);
    lower(&mut scene, ABOVE + side + BELOW);
    for (index, set) in sets.iter().enumerate() {
        let at = [MARGIN + index as f64 * column + LEFT, top + ABOVE];
        scene.groups.push(samples(set, at, side, &palette));
        scene.groups.push(border(at, side, &palette));
        scene
            .groups
            .push(heading(&columns[index].0.method, at, side, &palette));
    }
    scene.groups.push(ramp(WIDTH - MARGIN, BLACK, &palette));
    Ok(Picture {
        name: format!("{name}-{}", reference.radius.to_string().replace('.', "-")),
        caption: caption(title, reference, columns),
        scene,
    })
}

fn caption(title: &str, first: &Found, columns: &[Column<'_>]) -> String {
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

/// Returns where the panels begin: below the legend.
fn first_panel(scene: &Scene) -> f64 {
    let clips = scene.groups.iter().filter_map(|group| group.clip);
    let top = clips.map(|clip| clip.min[1]).fold(f64::INFINITY, f64::min);
    // The heading's room stays above the plot.
    if top.is_finite() { top - 34.0 } else { 60.0 }
}

/// Moves all panels down.
fn lower(scene: &mut Scene, by: f64) {
    let heads = ["title", "legend"];
    for group in &mut scene.groups {
        if heads.contains(&group.name.as_str()) {
            continue;
        }
        group.view.origin[1] += by;
        if let Some(clip) = &mut group.clip {
            clip.min[1] += by;
            clip.max[1] += by;
        }
    }
    scene.height += by;
}

/// The dots of a part of a set, y upwards.
fn samples(set: &Set, at: [f64; 2], side: f64, palette: &Palette) -> Group {
    let scale = side / (SHOWN * set.radius);
    let inside = |p: &&[f64; 2]| p.iter().all(|x| *x < (SHOWN + 1.0) * set.radius);
    let mark = |p: &[f64; 2]| {
        let place = [p[0], SHOWN * set.radius - p[1]];
        Shape::marker(Marker::Dot, place, 2.6, Style::filled(palette.sample))
    };
    Group {
        view: View { scale, origin: at },
        clip: Some(Rect::new(at, at.map(|x| x + side))),
        shapes: set.points.iter().filter(inside).map(mark).collect(),
        ..Group::new("samples")
    }
}

/// A method's name, no wider than its column.
fn heading(method: &Method, at: [f64; 2], side: f64, palette: &Palette) -> Group {
    let name = method.name();
    let size = HEADING * (side / text_width(&name, Font::SemiBold, HEADING)).min(1.0);
    let mut text = Text::new([at[0], at[1] - 12.0], name, size, palette.text);
    text.font = Font::SemiBold;
    let mut group = Group::new("heading");
    group.shapes.push(Shape::Text(text));
    group
}

fn border(at: [f64; 2], side: f64, palette: &Palette) -> Group {
    let mut group = Group::new("border");
    group.shapes.push(Shape::Rect {
        rect: Rect::new(at, at.map(|x| x + side)),
        style: Style::stroked(palette.muted, 1.0),
    });
    group
}

/// Returns how many of so many cells, an odd number, fill a quarter of the width with cells of half pixels: what they leave out is the rim.
fn cells(columns: usize) -> usize {
    let width = 0.25 * (WIDTH - 2.0 * MARGIN) - LEFT - RIGHT;
    let cell = 0.5 * (2.0 * width / columns as f64).ceil();
    let fit = (width / cell) as usize;
    fit.min(columns) - usize::from(fit < columns && fit.is_multiple_of(2))
}

fn image(one: &Found, _: &Found) -> Panel {
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

fn power(one: &Found, below: &Found) -> Panel {
    let series = |of: &Found, band: bool| Series {
        name: of.method.name(),
        look: look(of.method),
        points: places(of, |index| Some(of.curves.power[index])),
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
    let [low, high] = all.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], db| {
        [low.min(db), high.max(db)]
    });
    let room = (0.08 * (high - low)).max(0.1);
    [low - room, high + room]
}

fn anisotropy(one: &Found, below: &Found, [low, high]: [f64; 2]) -> Panel {
    let series = |of: &Found| Series {
        name: of.method.name(),
        look: look(of.method),
        points: places(of, |index| of.curves.anisotropy[index]),
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
fn noise(one: &Found) -> Series {
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

fn places(of: &Found, value: impl Fn(usize) -> Option<f64>) -> Vec<[f64; 2]> {
    let each = of.curves.nu.iter().enumerate();
    each.filter_map(|(index, nu)| Some([*nu, value(index)?]))
        .collect()
}

/// Returns the figure of the rates.
pub fn rates(rows: &[Row], samples: u64, rounds: u64) -> Picture {
    let mut groups: Vec<Bars> = Vec::new();
    for row in rows {
        let heading = row.leaf.map_or_else(
            || "From scratch".to_owned(),
            |leaf| format!("KDRT, leaf {leaf} r"),
        );
        let kind = groups.iter().position(|group| group.heading == heading);
        let kind = kind.unwrap_or_else(|| {
            groups.push(Bars {
                heading,
                bars: Vec::new(),
            });
            groups.len() - 1
        });
        groups[kind].bars.push(bar(row, kind));
    }
    let title = format!(
        "Millions of samples a second, sets of about {}, and times the reference on one thread",
        number(samples as f64, 3)
    );
    Picture {
        name: "rates".to_owned(),
        caption: format!(
            "Rates of every engine, the pattern ready-made: medians of {rounds} rounds, whiskers {}; behind them the ratio to \
             the reference sampler on one thread in the same round.",
            whisker_words(rounds as usize)
        ),
        scene: bars_scene(
            &title,
            "rate, millions of samples a second",
            &groups,
            &Palette::LIGHT,
        ),
    }
}

fn bar(row: &Row, kind: usize) -> Bar {
    let median = row.rate.quartiles[1] / 1e6;
    Bar {
        name: format!("{}{}", row.name, threads(row.threads)),
        value: median,
        spread: Some(whisker(&row.rate).map(|rate| rate / 1e6)),
        text: format!(
            "{} ({} x)",
            number(median, 3),
            number(row.ratio.quartiles[1], 3)
        ),
        kind,
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
