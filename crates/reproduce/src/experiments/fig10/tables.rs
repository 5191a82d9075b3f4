//! All numbers of the figure: means to be read, sets and curves for data files.

use tilescope_analysis::measures::Summary;

use super::plate::PlateErrors;
use super::results::{DENSE, SamplerResults};
use crate::outcome::Table;
use crate::table::table;

/// Returns the tables.
pub fn tables(all: &[SamplerResults]) -> Vec<Table> {
    vec![
        plates(all),
        horizons(all),
        plate_sets(all),
        plate_classes(all),
        horizon_sets(all),
        power(all),
    ]
}

fn mean(one: &SamplerResults, value: fn(&PlateErrors) -> f64) -> Option<f64> {
    Some(Summary::of(one.plates.iter().map(value))?.mean)
}

fn deviation(one: &SamplerResults) -> Option<f64> {
    let errors = Summary::of(one.plate_errors())?;
    (errors.count > 1).then_some(errors.deviation)
}

fn plates(all: &[SamplerResults]) -> Table {
    let rendered = all.iter().filter(|one| !one.plates.is_empty());
    table("zone-plates", "Zone plate", rendered)
        .column("sampler", "sampler", 0, |one| one.sampler.name())
        .column("sets", "sets", 3, |one| one.plates.len())
        .column("samples", "samples", 9, |one| one.plates[0].count)
        .column("side_pixels", "side, pixels", 5, |one| one.plates[0].side)
        .column("rmse", "RMSE", 4, |one| mean(one, |plate| plate.rmse))
        .column("rmse_deviation", "deviation", 2, |one| deviation(one))
        .column("rmse_below_nyquist", "RMSE below Nyquist", 4, |one| {
            mean(one, |plate| plate.below)
        })
        .column("rmse_above_nyquist", "RMSE above Nyquist", 4, |one| {
            mean(one, |plate| plate.above)
        })
        .column("signal_to_noise_db", "signal to noise, dB", 3, |one| {
            mean(one, |plate| plate.signal_db)
        })
        .column(
            "low_power",
            "mean power at \u{3bd} \u{2264} 0.5",
            3,
            |one| one.spectrum.low,
        )
        .shown()
}

fn horizons(all: &[SamplerResults]) -> Table {
    let rendered = || all.iter().filter(|one| !one.horizons.is_empty());
    let longest = rendered().max_by_key(|one| one.horizons.len());
    let mut horizons =
        table("horizons", "Horizon", rendered())
            .column("sampler", "sampler", 0, |one| one.sampler.name());
    // Quick runs have too few numbers of samples for exponents.
    if rendered().any(|one| one.slope().is_some()) {
        let head = format!("exponent from {DENSE} on");
        horizons = horizons.column("exponent", &head, 3, |one| one.slope());
    }
    let head = "pixels without a sample at the least, %";
    horizons = horizons.column("empty_percent_sparsest", head, 3, |one| {
        100.0 * one.horizons[0][0].empty
    });
    for sets in longest.iter().flat_map(|one| &one.horizons) {
        let per_pixel = sets[0].per_pixel;
        let key = format!("rmse_{per_pixel}_per_pixel");
        let head = format!("RMSE at {per_pixel} per pixel");
        horizons = horizons.column(&key, &head, 4, |one| {
            let mut all = one.horizons.iter();
            let sets = all.find(|sets| sets[0].per_pixel == per_pixel)?;
            Some(Summary::of(sets.iter().map(|set| set.rmse))?.mean)
        });
    }
    horizons.shown()
}

/// Each zone plate with the name of its sampler.
fn each_plate(all: &[SamplerResults]) -> impl Iterator<Item = (&'static str, &PlateErrors)> {
    all.iter()
        .flat_map(|one| one.plates.iter().map(|plate| (one.sampler.name(), plate)))
}

fn plate_sets(all: &[SamplerResults]) -> Table {
    table("zone-plate-sets", "Zone plates, each set", each_plate(all))
        .column("sampler", "sampler", 0, |(name, _)| *name)
        .column("set", "set", 3, |(_, plate)| plate.index)
        .column("samples", "samples", 9, |(_, plate)| plate.count)
        .column("side_pixels", "side, pixels", 5, |(_, plate)| plate.side)
        .column("empty_pixels", "empty pixels", 6, |(_, plate)| plate.empty)
        .column("rmse", "RMSE", 6, |(_, plate)| plate.rmse)
        .column(
            "rmse_below_nyquist",
            "RMSE below Nyquist",
            6,
            |(_, plate)| plate.below,
        )
        .column(
            "rmse_above_nyquist",
            "RMSE above Nyquist",
            6,
            |(_, plate)| plate.above,
        )
        .column(
            "signal_to_noise_db",
            "signal to noise, dB",
            4,
            |(_, plate)| plate.signal_db,
        )
        .hidden()
}

fn plate_classes(all: &[SamplerResults]) -> Table {
    let rows = each_plate(all).flat_map(|(name, plate)| {
        let classes = plate.classes.iter();
        classes.map(move |class| (name, plate.index, *class))
    });
    let title = "Zone plates by local frequency";
    table("zone-plate-frequencies", title, rows)
        .column("sampler", "sampler", 0, |row| row.0)
        .column("set", "set", 3, |row| row.1)
        .column(
            "cycles_per_pixel",
            "local frequency, cycles per pixel",
            3,
            |row| row.2[0],
        )
        .column("rmse", "RMSE", 6, |row| row.2[1])
        .hidden()
}

fn horizon_sets(all: &[SamplerResults]) -> Table {
    let sets = all.iter().flat_map(|one| {
        let sets = one.horizons.iter().flatten();
        sets.map(|set| (one.sampler.name(), set))
    });
    table("horizon-sets", "Horizons, each set", sets)
        .column("sampler", "sampler", 0, |(name, _)| *name)
        .column("samples_per_pixel", "samples per pixel", 4, |(_, set)| {
            set.per_pixel
        })
        .column("set", "set", 3, |(_, set)| set.index)
        .column("samples", "samples", 9, |(_, set)| set.count)
        .column("rmse", "RMSE", 6, |(_, set)| set.rmse)
        .column(
            "empty_share",
            "share of pixels without a sample",
            4,
            |(_, set)| set.empty,
        )
        .hidden()
}

fn power(all: &[SamplerResults]) -> Table {
    let places = all.iter().flat_map(|one| {
        let places = one.spectrum.power.iter();
        places.map(|place| (one.sampler.name(), *place))
    });
    table("power", "Radial mean power", places)
        .column("sampler", "sampler", 0, |(name, _)| *name)
        .column("nu", "\u{3bd}", 4, |(_, place)| place[0])
        .column("power", "radial mean power", 4, |(_, place)| place[1])
        .hidden()
}
