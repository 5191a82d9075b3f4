//! Tables and charts of maximal sets of balls.

use serde_json::json;
use tilescope_figures::chart::{LineChart, Panel, Series};

use super::balls::{BINS_IN_R, MeasuredBalls};
use super::claims::EXPECTED_PAIRS;
use super::results::{PUBLISHED, SetMean, SpaceResults, floor, middle, pairs};
use crate::error::Result;
use crate::experiments::common::{curve, largest, picture, reference};
use crate::outcome::{Picture, Table};
use crate::texts::{chart, table};

/// Returns the charts: density of each set, pairs by distance and power by frequency.
pub fn picture_of(found: &SpaceResults) -> Result<Picture> {
    let rows = vec![
        vec![Panel::Lines(densities(found))],
        vec![
            Panel::Lines(pair_chart(found)),
            Panel::Lines(power_chart(found)),
        ],
    ];
    let values = json!({
        "sets": found.large.len(), "side": found.side,
        "small_sets": found.small.len(), "small_side": found.small_side,
    });
    picture("space/space", &values, rows)
}

/// Returns a curve with a band of 99 % intervals. Means of one set have none.
fn measured(name: &str, look: usize, places: impl Iterator<Item = (f64, SetMean)>) -> Series {
    let places: Vec<_> = places.collect();
    let band: Option<Vec<[f64; 2]>> = places.iter().map(|(_, mean)| mean.interval()).collect();
    Series {
        band,
        ..curve(
            name,
            look,
            places.iter().map(|(x, mean)| [*x, mean.mean]).collect(),
        )
    }
}

/// Returns the chart of the density of each large set, and of all sets so far.
fn densities(found: &SpaceResults) -> LineChart {
    let sets = &found.large;
    let each = sets.iter().enumerate();
    let each = each.map(|(index, set)| [(index + 1) as f64, set.density()]);
    // Of fewer than four sets the interval is far wider than the axis below: its band would fill the chart.
    let so_far = (4..=sets.len()).map(|count| {
        let mean = SetMean::of(&sets[..count], MeasuredBalls::density);
        (count as f64, mean)
    });

    let last = sets.len() as f64;
    let published = reference(
        "Zhang and Torquato 2013",
        vec![[1.0, PUBLISHED], [last, PUBLISHED]],
    );
    let mut drawn = chart(
        "space/densities",
        vec![
            published,
            curve("each set", 1, each.collect()),
            measured("all so far", 0, so_far),
        ],
    );

    // Densities of sets differ in the third digit, so that on an axis from 0 on all curves would be one line. The axis
    // shows each set, with a margin of a fifth. An interval that reaches farther than the axis is cut off.
    let differences = sets.iter().map(|set| (set.density() - PUBLISHED).abs());
    let reach = 1.2 * largest(differences);
    drawn.x.range = Some([1.0, last]);
    drawn.y.range = Some([PUBLISHED - reach, PUBLISHED + reach]);
    drawn
}

/// Returns the chart of g(r), from contact on, which is at r: maximal sets have no nearer pairs.
fn pair_chart(found: &SpaceResults) -> LineChart {
    let bins = found.large.first().map_or(0, |set| set.pairs.len());
    let mean = |sets: &[MeasuredBalls], name, look| {
        let places = (BINS_IN_R..bins).map(|bin| (middle(bin), pairs(sets, bin)));
        measured(name, look, places)
    };
    let expected = EXPECTED_PAIRS.iter().zip(BINS_IN_R..);
    let expected = expected.map(|(&g, bin)| [middle(bin), g]);
    chart(
        "space/pairs",
        vec![
            reference("expected", expected.collect()),
            mean(&found.large, "here", 0),
            mean(&found.scattered, "scattered", 2),
        ],
    )
}

/// Returns the mean over sets of the power of each shell, with its frequency.
fn powers(sets: &[MeasuredBalls]) -> impl Iterator<Item = (f64, SetMean)> + '_ {
    let shells = sets.first().map_or(0, |set| set.shells.len());
    (0..shells).map(|shell| {
        let nu = SetMean::of(sets, |set| set.shells[shell].nu).mean;
        (nu, SetMean::of(sets, |set| set.shells[shell].power))
    })
}

/// Returns the chart of the radial mean power.
fn power_chart(found: &SpaceResults) -> LineChart {
    // "here" and "scattered" have the looks that they have in the chart of pairs.
    chart(
        "space/power",
        vec![
            measured("here", 0, powers(&found.small)),
            measured("scattered", 2, powers(&found.scattered)),
        ],
    )
}

/// Returns all tables.
pub fn tables(found: &SpaceResults) -> Vec<Table> {
    vec![
        kinds(found),
        sets(found),
        pair_table(found),
        power_table(found),
    ]
}

/// Returns the table of maximal sets beside the controls.
fn kinds(found: &SpaceResults) -> Table {
    let rows = [
        ("maximal, large", &found.large),
        ("maximal, small", &found.small),
        ("stopped", &found.stopped),
        ("scattered", &found.scattered),
    ];
    table("space/kinds", rows, |(kind, sets)| {
        let density = SetMean::of(sets, MeasuredBalls::density);
        let of = |quantity: fn(&MeasuredBalls) -> f64| sets.iter().map(quantity);
        // Spectra are not measured in large cubes: that cell stays empty.
        let power = (!sets[0].shells.is_empty()).then(|| floor(sets).mean);

        json!({
            "kind": kind, "side": sets[0].side, "sets": sets.len(),
            "samples": sets.iter().map(|set| set.samples).sum::<usize>(),
            "density": density.mean, "error": density.error,
            "disks": SetMean::of(sets, |set| set.disks).mean,
            "contact": pairs(sets, BINS_IN_R).mean, "floor": power,
            "least": of(|set| set.least_distance).fold(f64::INFINITY, f64::min),
            "farthest": of(|set| set.farthest_place).fold(0.0, f64::max),
        })
    })
}

/// Returns the table of all maximal sets, for data files.
fn sets(found: &SpaceResults) -> Table {
    let all = found.large.iter().chain(&found.small);
    table("space/sets", all, |set| {
        json!({
            "side": set.side, "samples": set.samples, "density": set.density(), "disks": set.disks,
            "least": set.least_distance, "farthest": set.farthest_place, "judges": set.judges,
        })
    })
}

/// Returns the table of pairs by distance, for data files.
fn pair_table(found: &SpaceResults) -> Table {
    let bins = found.large.first().map_or(0, |set| set.pairs.len());
    table("space/pairs", 0..bins, |bin| {
        let g = pairs(&found.large, bin);
        json!({
            "distance": middle(bin), "pairs": g.mean, "error": g.error,
            "stopped": pairs(&found.stopped, bin).mean, "scattered": pairs(&found.scattered, bin).mean,
        })
    })
}

/// Returns the table of the radial mean power, for data files.
fn power_table(found: &SpaceResults) -> Table {
    let here = powers(&found.small);
    // The cubes of all three kinds have the same side, so that they have the same shells. In units of samples their
    // frequencies differ a little: the rows have those of maximal sets.
    let controls = powers(&found.stopped).zip(powers(&found.scattered));
    table(
        "space/power",
        here.zip(controls),
        |((nu, power), ((_, stopped), (_, scattered)))| {
            json!({
                "nu": nu, "power": power.mean, "error": power.error,
                "stopped": stopped.mean, "scattered": scattered.mean,
            })
        },
    )
}
