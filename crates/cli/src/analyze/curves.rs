//! The figure of an analysis: curves of all sets over each other, and their periodograms.

use tilescope_analysis::measures::anisotropy_reference_db;
use tilescope_figures::chart::{Axis, Figure, ImageChart, Level, LineChart, Look, Panel, Series};

use super::measured::{Measured, Place};

/// A peak higher than this is cut off: those of lattices would flatten everything else.
const HIGHEST: f64 = 8.0;
/// Power that is black in a periodogram.
const BLACK: f64 = 3.0;
/// Periodograms in a row, and in the figure.
const IN_A_ROW: usize = 4;
const MOST_PICTURES: usize = 12;

/// Returns the figure; the first set may be what others are held against.
pub fn figure(sets: &[Measured], against: bool) -> Figure {
    let look = |index: usize| match (against, index) {
        (true, 0) => Look::Reference,
        (true, _) => Look::Numbered(index - 1),
        (false, _) => Look::Numbered(index),
    };
    let name = |index: usize| match look(index) {
        Look::Reference => format!("{} (reference)", sets[index].name),
        Look::Numbered(_) => sets[index].name.clone(),
    };
    let series = |curve: fn(&Measured) -> Vec<Place>| -> Vec<Series> {
        let each = sets.iter().enumerate();
        let each = each.map(|(index, set)| series(name(index), look(index), &curve(set)));
        each.filter(|series| !series.points.is_empty()).collect()
    };
    let spectra = [
        power(series(Measured::power)),
        anisotropy(series(Measured::anisotropy)),
    ];
    let spectra = spectra.into_iter().filter(|chart| !chart.series.is_empty());
    let pairs = Panel::Lines(correlation(series(Measured::correlation)));
    // Squares of frequencies are squares of the plane on a square alone.
    let square = |set: &&Measured| set.region.width.to_bits() == set.region.height.to_bits();
    let shown = sets.iter().filter(square).take(MOST_PICTURES);
    let mut pictures: Vec<Panel> = shown.map(|set| Panel::Image(picture(set))).collect();
    let mut rows = vec![spectra.map(Panel::Lines).collect()];
    if pictures.len() <= 2 {
        pictures.insert(0, pairs);
        rows.push(pictures);
    } else {
        rows.push(vec![pairs]);
        rows.extend(pictures.chunks(IN_A_ROW).map(<[Panel]>::to_vec));
    }
    rows.retain(|row| !row.is_empty());
    let title = match sets {
        [set] => format!("Analysis of {}", set.name),
        _ => format!("Analysis of {} sets", sets.len()),
    };
    Figure { title, rows }
}

fn series(name: String, look: Look, places: &[Place]) -> Series {
    let band: Vec<[f64; 2]> = places.iter().filter_map(|place| place.band).collect();
    Series {
        name,
        look,
        points: places.iter().map(|place| [place.x, place.y]).collect(),
        band: (band.len() == places.len()).then_some(band),
    }
}

/// Returns an axis that cuts off high peaks.
fn cut(label: &str, series: &[Series]) -> Axis {
    let highest = (series.iter().flat_map(|series| &series.points))
        .map(|point| point[1])
        .fold(0.0, f64::max);
    if highest > HIGHEST {
        return Axis::new(format!("{label}, cut off at {HIGHEST}")).with_range(0.0, HIGHEST);
    }
    Axis::new(label)
}

fn noise(y: f64) -> Level {
    Level {
        name: "white noise".to_owned(),
        y,
    }
}

fn power(series: Vec<Series>) -> LineChart {
    LineChart {
        title: "Radial mean power".to_owned(),
        x: from_zero("frequency \u{3bd} = |k| / \u{221a}N", &series),
        y: cut("power P(\u{3bd})", &series),
        levels: vec![noise(1.0)],
        series,
    }
}

fn anisotropy(series: Vec<Series>) -> LineChart {
    LineChart {
        title: "Anisotropy".to_owned(),
        x: from_zero("frequency \u{3bd} = |k| / \u{221a}N", &series),
        y: Axis::new("anisotropy, dB"),
        levels: vec![Level {
            name: "no preferred direction: \u{2212}10 log\u{2081}\u{2080} K, K = 1 set".to_owned(),
            y: anisotropy_reference_db(1),
        }],
        series,
    }
}

fn correlation(series: Vec<Series>) -> LineChart {
    LineChart {
        title: "Pair correlation".to_owned(),
        x: from_zero("distance r / r_max", &series),
        y: cut("g(r)", &series),
        levels: vec![noise(1.0)],
        series,
    }
}

fn from_zero(label: &str, series: &[Series]) -> Axis {
    let ends = series.iter().filter_map(|series| series.points.last());
    let end = ends.map(|point| point[0]).fold(0.0, f64::max);
    Axis::new(label).with_range(0.0, end)
}

fn picture(set: &Measured) -> ImageChart {
    let reach = set.picture_reach;
    let side = set.picture.side;
    let each = if side == 1 {
        String::new()
    } else {
        format!(", means of {side} \u{d7} {side}")
    };
    let middle = set.picture.power.len() / 2;
    let absent = !set.picture.power[middle].is_finite();
    ImageChart {
        title: format!("Periodogram of {}", file_name(&set.name)),
        x: Axis::new(format!(
            "\u{3bd} along x (white 0, black {BLACK} and above{each})"
        ))
        .with_range(-reach, reach),
        y: Axis::new("\u{3bd} along y").with_range(-reach, reach),
        columns: set.picture.size,
        values: set.picture.power.clone(),
        clamp: [0.0, BLACK],
        absent: absent.then_some(middle),
    }
}

/// Returns the last part of a name, cut to what a panel has room for.
fn file_name(name: &str) -> String {
    const MOST: usize = 18;
    let last = name.rsplit(['/', '\\']).next().unwrap_or(name);
    if last.chars().count() <= MOST {
        return last.to_owned();
    }
    let kept: String = last.chars().take(MOST - 1).collect();
    format!("{kept}\u{2026}")
}
