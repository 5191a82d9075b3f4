//! Tables and charts of the density.

use serde_json::json;
use tilescope_analysis::measures::student_quantile;
use tilescope_figures::chart::{LineChart, Panel, Series};

use super::results::{DensityResults, PUBLISHED, PUBLISHED_ERROR, coarse_losses, halving};
use super::torus::TorusSets;
use crate::error::Result;
use crate::experiments::common::{MISSED, curve, picture, reference};
use crate::outcome::{Picture, Table};
use crate::texts::{chart, table};

/// The charts show densities in millionths.
const MILLION: f64 = 1e6;
/// The numbers of the curves' looks. The measured curve looks the same in both charts.
const MEASURED_LOOK: usize = 0;
const HALVING_LOOK: usize = 1;

/// Returns the charts: the density by the number of samples, and what each level inserts.
pub fn picture_of(found: &DensityResults) -> Result<Picture> {
    let rows = vec![vec![
        Panel::Lines(so_far(found)),
        Panel::Lines(by_level(&found.all)),
    ]];
    let values = json!({ "samples": found.all.sums.samples, "sets": found.all.sums.sets });
    picture("density/density", &values, rows)
}

/// Returns an entry for each batch: this batch joined with all batches before it.
fn growing(batches: &[TorusSets]) -> Vec<TorusSets> {
    let mut all: Vec<TorusSets> = Vec::new();
    for batch in batches {
        let next = all
            .last()
            .map_or_else(|| batch.clone(), |sum| sum.joined(batch));
        all.push(next);
    }
    all
}

/// Returns the chart of how the density settles: a point after each batch, which stands for all batches so far. The
/// point is the density, with what the lattice leaves out added, less the published density, in millionths.
fn so_far(found: &DensityResults) -> LineChart {
    // The quantile of a normal variable, as for the verdict.
    let quantile = student_quantile(MISSED, f64::INFINITY);
    // There are two estimates of what the lattice leaves out. This is the one that the verdict uses, with its error.
    let [left_out, doubt] = found.lattice.used();
    let (mut points, mut band) = (Vec::new(), Vec::new());

    for all in growing(&found.batches) {
        let [density, error] = all.density();
        let y = MILLION * (density + left_out - PUBLISHED);
        let reach = MILLION * quantile * error.hypot(doubt);
        points.push([all.sums.samples as f64 / MILLION, y]);
        band.push([y - reach, y + reach]);
    }

    // The published density with its interval is a line as long as the curve.
    let last = points.last().map_or(0.0, |[x, _]| *x);
    let reach = MILLION * quantile * PUBLISHED_ERROR;
    let published = Series {
        band: Some(vec![[-reach, reach]; 2]),
        ..reference("Zhang and Torquato 2013", vec![[0.0, 0.0], [last, 0.0]])
    };
    let here = Series {
        band: Some(band),
        ..curve("here", MEASURED_LOOK, points)
    };

    // The interval of the first few batches is far wider than the differences in the chart: it would press all else
    // flat. The chart shows 2.5 times the width of the last interval (chosen, not measured) beyond the last difference.
    let (apart, [low, high]) = found.beside_published(found.density()[0]);
    let end = MILLION * (apart.abs() + 2.5 * (high - low));
    let mut drawn = chart("density/so-far", vec![published, here]);
    drawn.x.range = Some([0.0, last]);
    drawn.y.range = Some([-end, end]);
    drawn
}

/// Returns the chart of what each level inserts to a unit of area, as a logarithm to base 2, beside levels that halve.
fn by_level(all: &TorusSets) -> LineChart {
    let area = all.area();
    let counts = all.by_level.iter().enumerate();
    // The number of a level that inserts nothing has no logarithm.
    let inserting = counts.filter(|(_, count)| **count > 0);
    let points = inserting.map(|(level, count)| [level as f64, (*count as f64 / area).log2()]);

    // The first term of the line fitted to the levels is what level 0 would insert to a unit of area, were each
    // level to insert half as much as the one before.
    let [first, _] = halving(all).terms;
    let halved = (0..all.by_level.len()).map(|level| [level as f64, first.log2() - level as f64]);
    let mut drawn = chart(
        "density/levels",
        vec![
            curve("halving", HALVING_LOOK, halved.collect()),
            curve("here", MEASURED_LOOK, points.collect()),
        ],
    );
    drawn.x.range = Some([0.0, all.by_level.len() as f64 - 1.0]);
    drawn
}

/// Returns all tables.
pub fn tables(found: &DensityResults) -> Vec<Table> {
    vec![
        estimates(found),
        levels(&found.all),
        coarse(found),
        tori(found),
        batches(found),
    ]
}

/// Returns the table of the counted density, of two estimates of what the lattice leaves out, of the counted density
/// with the estimate by levels added, and of the published density. Each value has its standard error.
fn estimates(found: &DensityResults) -> Table {
    let counted = found.all.density();
    let rows = [
        ("counted on the lattice", counted),
        ("left out, by levels", found.lattice.by_levels),
        ("left out, by coarse lattices", found.lattice.by_coarse),
        ("density", found.density()),
        ("Zhang and Torquato 2013", [PUBLISHED, PUBLISHED_ERROR]),
    ];
    table(
        "density/estimates",
        rows,
        |(what, [value, error])| json!({ "what": what, "value": value, "error": error }),
    )
}

fn levels(all: &TorusSets) -> Table {
    let [first, _] = halving(all).terms;
    let expected = |level: usize| first * all.area() * 0.5_f64.powi(level as i32);
    table(
        "density/levels",
        all.by_level.iter().enumerate(),
        |(level, count)| {
            json!({
                "level": level, "inserted": count, "halving": expected(level),
                "share": *count as f64 / expected(level),
            })
        },
    )
}

fn coarse(found: &DensityResults) -> Table {
    let rows = found.coarse.iter().zip(coarse_losses(&found.coarse));
    table("density/coarse", rows, |(one, [loss, loss_error])| {
        let [density, error] = one.density();
        json!({
            "radius": one.radius, "sets": one.sums.sets, "samples": one.sums.samples,
            "density": density, "error": error, "loss": loss, "loss_error": loss_error,
        })
    })
}

fn tori(found: &DensityResults) -> Table {
    let rows = found.small.iter().chain([&found.all]);
    let [whole, whole_error] = found.all.density();
    table("density/tori", rows, |one| {
        let [density, error] = one.density();
        json!({
            "side": one.side, "sets": one.sums.sets, "samples": one.sums.samples,
            "density": density, "error": error,
            "errors_apart": (density - whole) / error.hypot(whole_error),
        })
    })
}

fn batches(found: &DensityResults) -> Table {
    table("density/batches", &found.batches, |one| {
        let [density, error] = one.density();
        json!({
            "sets": one.sums.sets, "samples": one.sums.samples,
            "density": density, "error": error,
        })
    })
}
