//! The numbers of figure 13.

use serde_json::json;

use super::against::Against;
use super::spectra::MethodSpectra;
use crate::experiments::timing::whiskered;
use crate::outcome::Table;
use crate::rates::EngineRate;
use crate::texts::table;

/// Returns the numbers of each method and radius.
pub fn quality(found: &[MethodSpectra], against: &[Against]) -> Table {
    table("fig13/quality", found, |one| {
        let same = |held: &&Against| {
            held.radius.to_bits() == one.radius.to_bits() && held.method == one.method
        };
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

/// Returns the rates of all rounds.
pub fn rates(rows: &[EngineRate]) -> Table {
    table("fig13/rates", rows, |row| {
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

/// Returns all curves, for data files.
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
