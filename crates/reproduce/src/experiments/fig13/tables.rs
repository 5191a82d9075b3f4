//! The numbers of figure 13.

use super::against::Against;
use super::spectra::MethodSpectra;
use crate::experiments::timing::{whisker, whisker_columns};
use crate::outcome::Table;
use crate::rates::EngineRate;
use crate::table::table;

/// Returns the numbers of each method and radius.
pub fn quality(found: &[MethodSpectra], against: &[Against]) -> Table {
    let same = |one: &MethodSpectra, held: &&Against| {
        held.radius.to_bits() == one.radius.to_bits() && held.method == one.method
    };
    let rows = found
        .iter()
        .map(|one| (one, against.iter().find(|held| same(one, held))));
    let percent =
        |held: Option<&Against>, value: fn(&Against) -> f64| held.map(|held| 100.0 * value(held));
    let title = "Quality by radius and method. Distances in r; anisotropy is that of the mean periodogram, and of single ones in the mean, above \
                 the level of noise; peaks are powers over the radial mean, and the limit is what chance passes once in a hundred times. \
                 The effective Nyquist frequency is psa's: strong single frequencies near zero do not end it";
    table("quality", title, rows)
        .column("radius", "radius", 4, |(one, _)| one.radius)
        .column("method", "method", 1, |(one, _)| one.method.name())
        .column("sets", "sets", 4, |(one, _)| one.sets)
        .column("samples", "samples", 6, |(one, _)| {
            one.count[0].round() as u64
        })
        .column("samples_sd", "deviation", 2, |(one, _)| one.count[1])
        .column("density", "N r^2 / area", 4, |(one, _)| one.density())
        .column("min_distance_r", "smallest distance", 8, |(one, _)| {
            one.min_distance
        })
        .column("covering_radius_r", "covering radius", 7, |(one, _)| {
            one.covering_radius
        })
        .column("low_power", "power below nu 0.5", 3, |(one, _)| {
            one.low_power()
        })
        .column("nyquist", "effective Nyquist (psa's), nu", 3, |(one, _)| {
            one.nyquist
        })
        .column("oscillation", "oscillation", 3, |(one, _)| one.oscillation)
        .column("difference_percent", "difference, %", 3, |(_, held)| {
            percent(*held, |held| held.difference)
        })
        .column("chance_percent", "by chance, %", 3, |(_, held)| {
            percent(*held, |held| held.chance)
        })
        .column("left_percent", "left, %", 2, |(_, held)| {
            percent(*held, |held| held.left)
        })
        .column("anisotropy_db", "anisotropy, dB", 2, |(one, _)| one.excess)
        .column(
            "anisotropy_alone_db",
            "of single sets, dB",
            2,
            |(one, _)| one.excess_alone,
        )
        .column("peak", "peak", 3, |(one, _)| one.peaks.highest)
        .column("peak_limit", "limit", 3, |(one, _)| one.peaks.limit)
        .column("peaks_above", "frequencies above", 5, |(one, _)| {
            one.peaks.above
        })
        .shown()
}

/// Returns the rates, of so many rounds at most.
pub fn rates(rows: &[EngineRate], rounds: usize) -> Table {
    let [low, high] = whisker_columns(rounds);
    table("rates", "Rates, the pattern ready-made", rows)
        .column("method", "method", 1, |row| row.engine.name())
        .column("leaf_r", "leaf, r", 3, |row| row.leaf)
        .column("threads", "threads", 3, |row| row.engine.threads())
        .column("samples", "samples", 7, |row| row.count.round() as u64)
        .column("rounds", "rounds", 3, |row| row.rate.count)
        .column(
            "million_per_second",
            "million samples a second, median",
            3,
            |row| row.rate.quartiles[1] / 1e6,
        )
        .column(low.0, low.1, 3, |row| whisker(&row.rate)[0] / 1e6)
        .column(high.0, high.1, 3, |row| whisker(&row.rate)[1] / 1e6)
        .column("ratio", "times the reference on one thread", 3, |row| {
            row.ratio.quartiles[1]
        })
        .column("density", "N r^2 / area", 4, |row| row.density)
        .column("min_distance_r", "smallest distance, r", 8, |row| {
            row.min_distance
        })
        .column("covering_radius_r", "covering radius, r", 7, |row| {
            row.covering_radius
        })
        .shown()
}

/// Returns all curves, for data files.
pub fn curves(found: &[MethodSpectra]) -> Table {
    let rows = found
        .iter()
        .flat_map(|one| (0..one.curves.nu.len()).map(move |index| (one, index)));
    let band = |one: &MethodSpectra, index: usize, end: usize| {
        one.curves.band.get(index).map(|ends| ends[end])
    };
    table("curves", "Radial mean powers and anisotropies", rows)
        .column("radius", "radius", 4, |(one, _)| one.radius)
        .column("method", "method", 1, |(one, _)| one.method.name())
        .column("nu", "nu", 4, |(one, index)| one.curves.nu[*index])
        .column("power", "power", 4, |(one, index)| one.curves.power[*index])
        .column("band_low", "band from", 4, |(one, index)| {
            band(one, *index, 0)
        })
        .column("band_high", "to", 4, |(one, index)| band(one, *index, 1))
        .column("anisotropy_db", "anisotropy, dB", 4, |(one, index)| {
            one.curves.anisotropy[*index]
        })
        .hidden()
}
