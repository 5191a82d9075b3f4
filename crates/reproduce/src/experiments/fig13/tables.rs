//! The numbers of figure 13.

use super::against::Against;
use super::rates::Row;
use super::spectra::Found;
use crate::bars::{whisker, whisker_columns};
use crate::outcome::{Cell, Column, Table};

/// Key, heading and digits of its columns.
const QUALITY: [(&str, &str, usize); 19] = [
    ("radius", "radius", 4),
    ("method", "method", 1),
    ("sets", "sets", 4),
    ("samples", "samples", 6),
    ("samples_sd", "deviation", 2),
    ("density", "N r^2 / area", 4),
    ("min_distance_r", "least distance", 8),
    ("covering_radius_r", "covering radius", 7),
    ("low_power", "power below nu 0.5", 3),
    ("nyquist", "effective Nyquist (psa's), nu", 3),
    ("oscillation", "oscillation", 3),
    ("difference_percent", "difference, %", 3),
    ("chance_percent", "by chance, %", 3),
    ("left_percent", "left, %", 2),
    ("anisotropy_db", "anisotropy, dB", 2),
    ("anisotropy_alone_db", "of single sets, dB", 2),
    ("peak", "peak", 3),
    ("peak_limit", "limit", 3),
    ("peaks_above", "frequencies above", 5),
];

/// What is found of each method and radius.
pub fn quality(found: &[Found], against: &[Against]) -> Table {
    let row = |one: &Found| {
        let held = against.iter().find(|held| {
            held.radius.to_bits() == one.radius.to_bits() && held.method == one.method
        });
        let of =
            |value: fn(&Against) -> f64| held.map_or(Cell::Missing(()), |held| value(held).into());
        vec![
            one.radius.into(),
            one.method.name().into(),
            one.sets.into(),
            whole(one.count[0]),
            one.count[1].into(),
            one.density().into(),
            one.min_distance.into(),
            one.covering_radius.into(),
            one.low_power().into(),
            one.nyquist.unwrap_or(f64::NAN).into(),
            one.oscillation.unwrap_or(f64::NAN).into(),
            of(|held| 100.0 * held.difference),
            of(|held| 100.0 * held.chance),
            of(|held| 100.0 * held.left),
            one.excess.into(),
            one.excess_alone.into(),
            one.peaks.highest.into(),
            one.peaks.limit.into(),
            one.peaks.above.into(),
        ]
    };
    Table {
        name: "quality".to_owned(),
        title: "Quality by radius and method. Distances in r; anisotropy is that of the mean periodogram, and of single ones in the mean, above \
                the level of noise; peaks are powers over the radial mean, and the limit is what chance passes once in a hundred times. \
                The effective Nyquist frequency is psa's: strong single frequencies near zero do not end it"
            .to_owned(),
        columns: columns(&QUALITY),
        rows: found.iter().map(row).collect(),
        shown: true,
    }
}

/// A number of samples.
fn whole(count: f64) -> Cell {
    (count.round() as u64).into()
}

/// The rates, of so many rounds at most.
pub fn rates(rows: &[Row], rounds: usize) -> Table {
    let threads = |row: &Row| row.threads.map_or(Cell::Missing(()), Cell::from);
    let row = |row: &Row| {
        let [low, high] = whisker(&row.rate).map(|rate| rate / 1e6);
        vec![
            row.name.clone().into(),
            row.leaf.map_or(Cell::Missing(()), Cell::from),
            threads(row),
            whole(row.count),
            row.rate.count.into(),
            (row.rate.quartiles[1] / 1e6).into(),
            low.into(),
            high.into(),
            row.ratio.quartiles[1].into(),
            row.density.into(),
            row.min_distance.into(),
            row.covering_radius.into(),
        ]
    };
    let [low, high] = whisker_columns(rounds);
    let columns = columns(&[
        ("method", "method", 1),
        ("leaf_r", "leaf, r", 3),
        ("threads", "threads", 3),
        ("samples", "samples", 7),
        ("rounds", "rounds", 3),
        ("million_per_second", "million samples a second, median", 3),
        (low.0, low.1, 3),
        (high.0, high.1, 3),
        ("ratio", "times the reference on one thread", 3),
        ("density", "N r^2 / area", 4),
        ("min_distance_r", "least distance, r", 8),
        ("covering_radius_r", "covering radius, r", 7),
    ]);
    Table {
        name: "rates".to_owned(),
        title: "Rates, the pattern ready-made".to_owned(),
        columns,
        rows: rows.iter().map(row).collect(),
        shown: true,
    }
}

/// All curves, for data files.
pub fn curves(found: &[Found]) -> Table {
    let rows = found.iter().flat_map(|one| {
        let curves = &one.curves;
        curves.nu.iter().enumerate().map(|(index, nu)| {
            let band = curves.band.get(index).copied().unwrap_or([f64::NAN; 2]);
            let anisotropy = curves.anisotropy[index].unwrap_or(f64::NAN);
            vec![
                one.radius.into(),
                one.method.name().into(),
                (*nu).into(),
                curves.power[index].into(),
                band[0].into(),
                band[1].into(),
                anisotropy.into(),
            ]
        })
    });
    Table {
        name: "curves".to_owned(),
        title: "Radial mean powers and anisotropies".to_owned(),
        columns: columns(&[
            ("radius", "radius", 4),
            ("method", "method", 1),
            ("nu", "nu", 4),
            ("power", "power", 4),
            ("band_low", "band from", 4),
            ("band_high", "to", 4),
            ("anisotropy_db", "anisotropy, dB", 4),
        ]),
        rows: rows.collect(),
        shown: false,
    }
}

fn columns(all: &[(&str, &str, usize)]) -> Vec<Column> {
    let column = |(key, head, digits): &(&str, &str, usize)| Column::new(key, head, *digits);
    all.iter().map(column).collect()
}
