//! All numbers of the figure: means to be read, sets and curves for data files.

use serde_json::json;
use tilescope_analysis::measures::Summary;

use super::plate::PlateErrors;
use super::results::SamplerResults;
use crate::outcome::Table;
use crate::texts::table;

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

/// Returns the errors of zone plates by sampler.
fn plates(all: &[SamplerResults]) -> Table {
    let rendered = all.iter().filter(|one| !one.plates.is_empty());
    table("fig10/zone-plates", rendered, |one| {
        let mean = |value: fn(&PlateErrors) -> f64| {
            Summary::of(one.plates.iter().map(value)).map(|all| all.mean)
        };
        // Sizes are those of the first set: all sets of a sampler were asked for the same. A single set has no
        // deviation.
        let errors = Summary::of(one.plate_errors()).filter(|errors| errors.count > 1);

        json!({
            "sampler": one.sampler.name(), "sets": one.plates.len(), "samples": one.plates[0].count,
            "side_pixels": one.plates[0].side, "rmse": mean(|plate| plate.rmse),
            "rmse_deviation": errors.map(|errors| errors.deviation),
            "rmse_below_nyquist": mean(|plate| plate.below),
            "rmse_above_nyquist": mean(|plate| plate.above),
            "signal_to_noise_db": mean(|plate| plate.signal_db), "low_power": one.spectrum.low,
        })
    })
}

/// Returns the table of the horizons' mean errors by samples per pixel, a row for each sampler.
fn horizons(all: &[SamplerResults]) -> Table {
    let rendered = || all.iter().filter(|one| !one.horizons.is_empty());
    // The table has a column for each number of samples per pixel, which takes the place of `{n}` in the key below. The
    // sampler with the most images has all of these numbers; others leave some cells empty.
    let longest = rendered().max_by_key(|one| one.horizons.len());
    // The column of exponents is left out in quick runs, which have too few numbers of samples for them.
    let exponents = rendered().any(|one| one.slope().is_some());

    table("fig10/horizons", rendered(), |one| {
        let rmse = longest
            .iter()
            .flat_map(|longest| &longest.horizons)
            .map(|of_longest| {
                let per_pixel = of_longest[0].per_pixel;
                let own = one
                    .horizons
                    .iter()
                    .find(|sets| sets[0].per_pixel == per_pixel);
                let errors = own.and_then(|sets| Summary::of(sets.iter().map(|set| set.rmse)));
                (per_pixel, errors.map(|errors| errors.mean))
            });

        // Horizons are in the order of the samples per pixel, so that the first has the fewest. The share of empty
        // pixels is that of the first set with this number.
        let mut row = json!({
            "sampler": one.sampler.name(), "empty_percent_sparsest": 100.0 * one.horizons[0][0].empty,
            "rmse_{n}_per_pixel": rmse.collect::<Vec<_>>(),
        });
        if exponents {
            row["exponent"] = json!(one.slope());
        }

        row
    })
}

/// Each zone plate with the name of its sampler.
fn each_plate(all: &[SamplerResults]) -> impl Iterator<Item = (&'static str, &PlateErrors)> {
    all.iter()
        .flat_map(|one| one.plates.iter().map(|plate| (one.sampler.name(), plate)))
}

fn plate_sets(all: &[SamplerResults]) -> Table {
    table("fig10/zone-plate-sets", each_plate(all), |(name, plate)| {
        json!({
            "sampler": name, "set": plate.index, "samples": plate.count, "side_pixels": plate.side,
            "empty_pixels": plate.empty, "rmse": plate.rmse, "rmse_below_nyquist": plate.below,
            "rmse_above_nyquist": plate.above, "signal_to_noise_db": plate.signal_db,
        })
    })
}

/// Returns the errors of zone plates by class of frequencies.
fn plate_classes(all: &[SamplerResults]) -> Table {
    let rows = each_plate(all).flat_map(|(name, plate)| {
        let classes = plate.classes.iter();
        classes.map(move |class| (name, plate.index, *class))
    });

    table(
        "fig10/zone-plate-frequencies",
        rows,
        |(name, set, [frequency, rmse])| {
            json!({
                "sampler": name, "set": set, "cycles_per_pixel": frequency, "rmse": rmse,
            })
        },
    )
}

fn horizon_sets(all: &[SamplerResults]) -> Table {
    let sets = all.iter().flat_map(|one| {
        let sets = one.horizons.iter().flatten();
        sets.map(|set| (one.sampler.name(), set))
    });
    table("fig10/horizon-sets", sets, |(name, set)| {
        json!({
            "sampler": name, "samples_per_pixel": set.per_pixel, "set": set.index, "samples": set.count,
            "rmse": set.rmse, "empty_share": set.empty,
        })
    })
}

fn power(all: &[SamplerResults]) -> Table {
    let places = all.iter().flat_map(|one| {
        let places = one.spectrum.power.iter();
        places.map(|place| (one.sampler.name(), *place))
    });
    table("fig10/power", places, |(name, [nu, power])| {
        json!({
            "sampler": name, "nu": nu, "power": power,
        })
    })
}
