//! Charts, maps and tables of the counts.

use serde_json::json;
use tilescope_analysis::measures::{DifferenceCurve, Uniformity};
use tilescope_figures::Bitmap;
use tilescope_figures::chart::{ColorScale, Level, LineChart, Panel, Series, TileContent};

use super::averages::{AgainstReference, AveragedWay};
use super::counted::EDGES;
use super::gaps::CLASSES;
use super::offsets::{SamplerUniformity, UniformityResults};
use crate::error::Result;
use crate::experiments::common::{curve, picture, tile};
use crate::numbers::signed;
use crate::outcome::{Picture, Table};
use crate::texts::{chart, table};

/// Sets of one way to make them, with the number of their curve.
type Subject<'a> = (usize, &'a SamplerUniformity);

/// Returns the charts by distance from borders and within gaps, and the maps, which have `cells` cells along each side.
pub fn pictures(found: &UniformityResults, cells: usize) -> Result<Vec<Picture>> {
    // The number of a curve decides its look: each way to make sets has the same one in all charts.
    // The control, with samples that were moved on purpose, is in the maps and tables alone.
    let [reference, _moved, circumcentre, uniform, random, exact] = &found.all;
    let five = [
        (1, reference),
        (0, circumcentre),
        (2, uniform),
        (3, random),
        (4, exact),
    ];
    // Inserted samples are counted in the sets of these two runs alone, which differ in insertion.
    let two = [(0, circumcentre), (2, uniform)];

    let charts = [
        [
            density("uniformity/blocks", &five, |one| &one.blocks),
            density("uniformity/domain", &five, |one| &one.domain),
        ],
        [ranks(&two), inserted(&two)],
    ];
    let borders = charts.map(|row| row.map(Panel::Lines).into());

    let values = json!({ "sets": circumcentre.sets });
    Ok(vec![
        picture("uniformity/borders", &values, borders.into())?,
        maps(found, cells)?,
    ])
}

/// Returns the middle of a class of distances; `None` for the last class, which has no end.
fn middle(class: usize) -> Option<f64> {
    let end = EDGES.get(class + 1)?;
    Some(0.5 * (EDGES[class] + end))
}

/// Returns the chart of densities by distance from a border, in percent above the reference sampler's.
fn density(
    id: &str,
    subjects: &[Subject<'_>],
    pick: fn(&SamplerUniformity) -> &Uniformity,
) -> LineChart {
    let series = |&(number, subject): &Subject<'_>| {
        let (mut points, mut band) = (Vec::new(), Vec::new());
        for (class, deviation) in pick(subject).deviations.iter().enumerate() {
            // A class without a middle has no place at which it could be drawn.
            if let Some(x) = middle(class) {
                let off = subject.against(deviation);
                points.push([x, 100.0 * off.relative]);
                band.push(off.interval.map(|end| 100.0 * end));
            }
        }
        Series {
            band: Some(band),
            ..curve(subject.name, number, points)
        }
    };

    let mut chart = chart(id, subjects.iter().map(series).collect());
    // The bias lies within a few r of a border, so that the chart ends at 7 r (chosen, not measured). The curves go on
    // beyond it, to the middles of farther classes.
    chart.x.range = Some([0.0, 7.0]);
    chart
}

/// Returns the chart of inserted samples by rank in their gap, relative to a uniform distribution. A rank is the share
/// of uniformly drawn places of the gap that are nearer to other samples than the inserted sample is.
fn ranks(subjects: &[Subject<'_>]) -> LineChart {
    let series = |&(number, subject): &Subject<'_>| {
        // Without inserted samples there are no ranks to draw.
        let ranks = &subject.inside.as_ref()?.deviations;
        let place = |class: usize| (class as f64 + 0.5) / ranks.len() as f64;

        let points =
            (ranks.iter().enumerate()).map(|(class, of)| [place(class), 1.0 + of.relative]);
        let band = ranks.iter().map(|of| of.interval.map(|end| 1.0 + end));
        Some(Series {
            band: Some(band.collect()),
            ..curve(subject.name, number, points.collect())
        })
    };

    let mut chart = chart(
        "uniformity/ranks",
        subjects.iter().filter_map(series).collect(),
    );
    chart.x.range = Some([0.0, 1.0]);
    chart.levels = vec![Level {
        name: "uniform".to_owned(),
        y: 1.0,
    }];
    chart
}

/// Returns the chart of the share of inserted samples that are within each distance from a block's border.
fn inserted(subjects: &[Subject<'_>]) -> LineChart {
    let series = |&(number, subject): &Subject<'_>| {
        // Without inserted samples the curve is flat. The 1 keeps it from a division by zero.
        let total = subject.inserted.iter().sum::<u64>().max(1) as f64;

        let mut sum = 0;
        let mut points = vec![[0.0, 0.0]];
        for (end, count) in EDGES[1..].iter().zip(&subject.inserted) {
            sum += count;
            points.push([*end, 100.0 * sum as f64 / total]);
        }
        curve(subject.name, number, points)
    };

    let mut chart = chart("uniformity/inserted", subjects.iter().map(series).collect());
    // The bias lies within a few r of a border; 5 r is the border of a class (chosen, not measured). There is a little
    // room above 100 %.
    chart.x.range = Some([0.0, 5.0]);
    chart.y.range = Some([0.0, 105.0]);
    chart
}

/// Returns the picture of mean curves less those of the reference sets.
pub fn mean_curves(against: &[AgainstReference]) -> Result<Picture> {
    let panel = |id: &str, pick: fn(&AgainstReference) -> &DifferenceCurve| {
        let series = against.iter().map(|one| {
            let of = pick(one);
            let [name, _] = one.way.words();
            // The numbers of curves are those of `pictures`, so that each way looks the same in all charts.
            let (number, band) = match one.way {
                // `Again` has the band of chance, about zero. All curves are of the same number of sets, so that one
                // band serves all. `Reference` is not drawn, since it has no difference from itself.
                AveragedWay::Reference | AveragedWay::Again => (1, of.bands.clone()),
                AveragedWay::Kdrt => (0, None),
                AveragedWay::Exact => (4, None),
            };
            Series {
                band,
                ..curve(name, number, of.points.clone())
            }
        });
        Panel::Lines(chart(id, series.collect()))
    };

    let rows = vec![vec![
        panel("uniformity/pairs", |one| &one.pairs),
        panel("uniformity/powers", |one| &one.powers),
    ]];
    let sets = against.first().map_or(0, |one| one.sets);
    picture("uniformity/curves", &json!({ "sets": sets }), rows)
}

/// Returns how far the mean curves of each way are from the reference's.
pub fn averages(against: &[AgainstReference]) -> Table {
    table("uniformity/averages", against, |one| {
        let [name, _] = one.way.words();
        let [annuli, bins] = one.outside().map(|share| 100.0 * share);
        let [density, density_error] = one.density.map(|share| 100.0 * share);
        let [anisotropy, reach] = one.anisotropy;
        json!({
            "sets_by": name, "sets": one.sets, "density_percent": density,
            "error_percent": density_error, "annuli_outside_percent": annuli,
            "bins_outside_percent": bins, "anisotropy_db": anisotropy, "chance_db": reach,
        })
    })
}

pub fn tables(found: &UniformityResults) -> Vec<Table> {
    vec![tests(found), distances(found), in_gaps(found)]
}

/// Returns each test with its effect.
fn tests(found: &UniformityResults) -> Table {
    let rows = found.all.iter().flat_map(|one| {
        // The tests of bands are left out: they are sums of the classes of distances.
        let of = [
            ("cells of the domain", Some(&one.cells)),
            ("distance from block borders", Some(&one.blocks)),
            ("distance from the domain's border", Some(&one.domain)),
            ("side of the domain's border", Some(&one.sides)),
            ("rank in the gap", one.inside.as_ref()),
        ];
        // Sets without inserted samples have no ranks.
        of.into_iter()
            .filter_map(|(by, test)| Some((one.name, by, test?)))
    });

    table("uniformity/tests", rows, |(name, by, test)| {
        let chi_square = &test.chi_square;
        json!({
            "sets_by": name, "classes_by": by, "sets": test.runs, "samples": test.samples,
            "classes": test.deviations.len(), "chi_square": chi_square.statistic,
            "chi_square_by_freedom": chi_square.statistic / chi_square.freedom as f64,
            "probability": chi_square.probability, "cramers_v": chi_square.cramers_v,
            "largest_percent": 100.0 * test.largest_deviation(),
        })
    })
}

/// Returns densities by distance from both kinds of border.
fn distances(found: &UniformityResults) -> Table {
    let rows = found.all.iter().flat_map(|one| {
        let borders = [("block", &one.blocks), ("domain", &one.domain)].into_iter();
        borders.flat_map(move |(border, test)| {
            let classes = test.deviations.iter().enumerate();
            classes.map(move |(class, deviation)| (one, border, class, deviation))
        })
    });

    table(
        "uniformity/distances",
        rows,
        |(one, border, class, deviation)| {
            let off = one.against(deviation);
            let [low, high] = off.interval.map(|end| 100.0 * end);
            // The test expects the number of samples that these sets have. The table compares with the reference sampler: the number
            // expected of its sets is less where these sets are denser, and more where they are thinner.
            let expected = deviation.expected * one.density.recip();
            // Inserted samples are counted by distance from the borders of blocks alone.
            let inserted = one.inserted.get(class).filter(|_| border == "block");
            json!({
                "sets_by": one.name, "border": border, "from_r": EDGES[class],
                "observed": deviation.observed, "expected": expected,
                "deviation_percent": 100.0 * off.relative, "low_percent": low, "high_percent": high,
                "inserted": inserted,
            })
        },
    )
}

fn in_gaps(found: &UniformityResults) -> Table {
    let rows = found.all.iter().flat_map(|one| {
        let ranks = one.inside.iter().flat_map(|inside| &inside.deviations);
        ranks.enumerate().map(move |(class, of)| (one, class, of))
    });
    table("uniformity/ranks", rows, |(one, class, of)| {
        json!({
            "sets_by": one.name, "rank_from": class as f64 / CLASSES as f64, "observed": of.observed,
            "expected": of.expected, "deviation_percent": 100.0 * of.relative, "skipped": one.skipped,
        })
    })
}

/// Deviation at which colours end.
const END: f64 = 0.1;
/// From blue over nearly white to red, in equal steps: told apart without red or without green as well.
const COLORS: [[u8; 3]; 5] = [
    [5, 48, 97],
    [67, 147, 195],
    [247, 247, 247],
    [214, 96, 77],
    [103, 0, 31],
];
/// Maps beside each other, and the side of each in pixels.
const MAPS: usize = 3;
const SIDE: f64 = 380.0;

/// Returns the colour of a deviation: between two of [`COLORS`] by linear interpolation, and that of an end beyond it.
fn color(deviation: f64) -> [u8; 3] {
    let steps = (COLORS.len() - 1) as f64;
    let at = (0.5 * (deviation / END).clamp(-1.0, 1.0) + 0.5) * steps;
    // The last colour has none behind it: at the upper end it is reached from the one before.
    let from = (at as usize).min(COLORS.len() - 2);
    let part = at - from as f64;
    [0, 1, 2].map(|k| {
        let [a, b] = [COLORS[from][k], COLORS[from + 1][k]].map(f64::from);
        (a + part * (b - a)).round() as u8
    })
}

/// Returns the maps of all sets: how far each of `cells` x `cells` parts of the domain is from the mean.
fn maps(found: &UniformityResults, cells: usize) -> Result<Picture> {
    let [reference, moved, others @ ..] = &found.all;
    let mut tiles = Vec::new();

    // The control, whose bias is known, comes last.
    for one in [reference].into_iter().chain(others).chain([moved]) {
        // Rows of the grid go upwards, those of a bitmap downwards.
        let rows = one.cells.deviations.chunks(cells).rev().flatten();
        let colors: Vec<[u8; 3]> = rows.map(|cell| color(cell.relative)).collect();
        let content = TileContent::Cells(Bitmap::rgb(cells, &colors)?);
        let no_note = String::new();
        tiles.push(Panel::Tile(tile(Some(SIDE), one.name, no_note, content)));
    }

    let mut rows: Vec<Vec<Panel>> = tiles.chunks(MAPS).map(<[Panel]>::to_vec).collect();
    // The scale has 64 steps, 0 for -END to 63 for END.
    let deviation = |step: i32| END * (f64::from(step) / 31.5 - 1.0);
    let [low, high] = [-END, END].map(|end| format!("{} %", signed(100.0 * end, 2)));
    rows[0].push(Panel::Scale(ColorScale {
        ends: [format!("samples of a cell, from the mean: {low}"), high],
        colors: (0..64).map(|step| color(deviation(step))).collect(),
    }));

    let values = json!({ "cells": cells, "low": -END, "high": END });
    picture("uniformity/maps", &values, rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_white_in_the_middle_and_end_at_the_ends() {
        assert_eq!(color(0.0), COLORS[2]);
        assert_eq!([color(-END), color(-1.0)], [COLORS[0]; 2]);
        assert_eq!([color(END), color(1.0)], [COLORS[4]; 2]);
        let [less, more] = [-0.05, 0.05].map(color);
        assert!(less[2] > less[0] && more[0] > more[2]);
    }
}
