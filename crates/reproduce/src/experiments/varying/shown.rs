//! Tables and charts of sets whose radius varies.

use serde_json::json;
use tilescope_figures::chart::{LineChart, Panel, Series};

use super::claims::CLASS;
use super::fields::FieldCounts;
use super::ramps::middle;
use super::rules::RadiusRule;
use super::tones::{STEPS, darkness};
use super::{RuledField, VaryingResults};
use crate::error::Result;
use crate::experiments::common::{curve, picture, reference};
use crate::experiments::density::PUBLISHED;
use crate::outcome::{Picture, Table};
use crate::texts::{chart, table};

/// Bands around measured curves are this many standard errors to either side.
const BAND: f64 = 2.0;

/// Returns the charts: density by slope, density between octaves, pairs and tones.
pub fn picture_of(found: &VaryingResults) -> Result<Picture> {
    let ramps = found.ramps.iter().map(|one| (one.slope, &one.counts));
    let plateaus = found
        .plateaus
        .iter()
        .map(|(octave, counts)| (*octave, counts));
    let rows = vec![
        vec![
            Panel::Lines(densities("varying/by-slope", ramps.collect())),
            Panel::Lines(densities("varying/by-octave", plateaus.collect())),
        ],
        vec![
            Panel::Lines(pair_chart(found)),
            Panel::Lines(tone_chart(found)),
        ],
    ];
    picture("varying/varying", &json!({}), rows)
}

/// Returns a curve with a band of its errors.
fn measured(name: &str, look: usize, places: impl Iterator<Item = (f64, [f64; 2])>) -> Series {
    let places: Vec<_> = places.collect();
    let band = |&(_, [y, error]): &(f64, [f64; 2])| [y - BAND * error, y + BAND * error];
    Series {
        band: Some(places.iter().map(band).collect()),
        ..curve(
            name,
            look,
            places.iter().map(|&(x, [y, _])| [x, y]).collect(),
        )
    }
}

/// Returns a level line over the places of another curve.
fn level(name: &str, y: f64, curve: &Series) -> Series {
    let ends = [curve.points.first(), curve.points.last()];
    let points = ends.into_iter().flatten().map(|&[x, _]| [x, y]);
    reference(name, points.collect())
}

/// Returns the chart of densities, beside the published one.
fn densities(id: &str, all: Vec<(f64, &FieldCounts)>) -> LineChart {
    let here = measured(
        "here",
        0,
        all.into_iter().map(|(x, counts)| (x, counts.density())),
    );
    let published = level("Zhang and Torquato 2013", PUBLISHED, &here);
    chart(id, vec![published, here])
}

/// Returns the chart of pair correlations in local radii.
fn pair_chart(found: &VaryingResults) -> LineChart {
    let with_pairs = found.ramps.iter().filter(|one| !one.pairs.is_empty());
    let series = with_pairs.enumerate().map(|(number, ramp)| {
        let places = ramp.pairs.iter().enumerate();
        // Look 0 is that of "here" in the other charts.
        let name = format!("slope {}", ramp.slope);
        measured(
            &name,
            number + 1,
            places.map(|(bin, &pair)| (middle(bin), pair)),
        )
    });
    chart("varying/pairs", series.collect())
}

/// Returns the chart of tones, step by step.
fn tone_chart(found: &VaryingResults) -> LineChart {
    let steps = (0..STEPS).map(|step| (darkness(step), found.tone(step..step + 1)));
    let here = measured("here", 0, steps);
    let asked = level("as asked for", 1.0, &here);
    chart("varying/tones", vec![asked, here])
}

/// Returns all tables.
pub fn tables(found: &VaryingResults) -> Vec<Table> {
    let density = |id: &str, all: Vec<(f64, &FieldCounts)>| {
        table(id, all, |(at, counts)| {
            let [density, error] = counts.density();
            json!({
                "at": at, "sets": counts.counts.len(), "samples": counts.samples(),
                "density": density, "error": error, "relative": density / PUBLISHED,
            })
        })
    };

    // The three kinds of fields have one form of table, in which `at` is what varies.
    let ramps = found.ramps.iter().map(|one| (one.slope, &one.counts));
    let waves = found
        .waves
        .iter()
        .map(|(contrast, counts)| (*contrast, counts));
    let plateaus = found
        .plateaus
        .iter()
        .map(|(octave, counts)| (*octave, counts));
    vec![
        density("varying/slopes", ramps.collect()),
        density("varying/contrasts", waves.collect()),
        density("varying/plateaus", plateaus.collect()),
        rules(found),
        tones(found),
        pairs(found),
    ]
}

/// Returns the table of five rules, with the density on each field relative to that of one radius.
fn rules(found: &VaryingResults) -> Table {
    // The keys of the columns: one for each of `RuledField::ALL` but the first. The first field has one radius, and the
    // densities on the others are divided by that on it.
    let fields = ["slope", "steep", "step", "cliff"];
    debug_assert_eq!(RuledField::ALL.len(), fields.len() + 1);
    table(
        "varying/rules",
        RadiusRule::ALL.iter().enumerate(),
        |(rule_index, rule)| {
            let mut row = json!({ "rule": rule.name() });
            for (field_index, key) in (1..).zip(&fields) {
                let [ratio, error] = found.relative(rule_index, field_index);
                row[*key] = ratio.into();
                row[format!("{key}_error")] = error.into();
            }
            row
        },
    )
}

/// Returns the table of tones by classes of steps.
fn tones(found: &VaryingResults) -> Table {
    table("varying/tones", (0..STEPS).step_by(CLASS), |first| {
        let [ratio, error] = found.tone(first..first + CLASS);
        json!({
            "from": darkness(first), "to": darkness(first + CLASS - 1), "ratio": ratio, "error": error,
        })
    })
}

/// Returns the table of pair correlations, for data files.
fn pairs(found: &VaryingResults) -> Table {
    let with_pairs = found.ramps.iter().filter(|one| !one.pairs.is_empty());
    let rows = with_pairs.flat_map(|ramp| {
        let bins = ramp.pairs.iter().enumerate();
        bins.map(|(bin, pair)| (ramp.slope, middle(bin), *pair))
    });
    table(
        "varying/pairs",
        rows,
        |(slope, distance, [pairs, error])| json!({ "slope": slope, "distance": distance, "pairs": pairs, "error": error }),
    )
}
