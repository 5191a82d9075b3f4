//! The numbers of the table, in its sequence, with their names and units.

use tilescope_analysis::measures::{Discrepancy, Order, PowerCurve};

/// What the numbers of a set are made from.
pub struct Found<'a> {
    pub samples: usize,
    /// The radius, or the smallest distance where it is not known.
    pub radius: f64,
    /// None where there is no radius: equal samples, and none is known.
    pub density: Option<f64>,
    pub min_distance: f64,
    pub covering_radius: f64,
    /// None where the radius is not known: of such a one they say nothing.
    pub conflicts: Option<u64>,
    pub gaps: Option<u64>,
    /// Smallest and mean nearest distance over `r_max`.
    pub relative: [f64; 2],
    /// None of sets in too narrow a domain.
    pub curve: Option<&'a PowerCurve>,
    /// None of sets with equal samples, which have no cells.
    pub order: Option<&'a Order>,
    /// None for sets that are too large for it.
    pub discrepancy: Option<Discrepancy>,
}

/// A number of the table.
#[derive(Clone)]
pub struct Scalar {
    /// Its name in JSON and CSV.
    pub key: &'static str,
    pub label: &'static str,
    pub unit: &'static str,
    /// None where it is not defined.
    pub value: Option<f64>,
    pub decimals: usize,
}

/// Name in files, label, unit, decimals.
type Row = (&'static str, &'static str, &'static str, usize);

/// Of the mean power of several sets, whose scatter is less.
const MEAN_CURVE: [Row; 2] = [
    (
        "mean_power_effective_nyquist",
        "effective Nyquist frequency of the mean power",
        "nu",
        3,
    ),
    (
        "mean_power_oscillation",
        "oscillation of the mean power",
        "",
        3,
    ),
];
const SET: [Row; 7] = [
    ("samples", "samples N", "", 0),
    ("radius", "radius r", "user units", 8),
    ("density", "density", "N r\u{b2} / area", 4),
    ("min_distance_r", "smallest distance", "r", 6),
    ("covering_radius_r", "covering radius", "r", 6),
    ("conflicts", "conflicts", "pairs", 0),
    ("gaps", "gaps", "places", 0),
];
const CURVES: [Row; 5] = [
    ("relative_radius", "relative radius", "r_max", 4),
    ("mean_nearest_distance", "mean nearest distance", "r_max", 4),
    ("effective_nyquist", "effective Nyquist frequency", "nu", 3),
    ("effective_nyquist_psa", "the same, as psa has it", "nu", 3),
    ("oscillation", "oscillation of power", "", 3),
];
const CELLS: [Row; 7] = [
    ("area_deviation", "deviation of cell areas", "mean area", 4),
    ("six_sided", "cells with six sides", "share", 4),
    ("mean_sides", "mean sides of a cell", "", 3),
    ("bond_order", "bond order, local", "", 4),
    ("global_bond_order", "bond order, global", "", 4),
    ("star_discrepancy", "L2 star discrepancy", "", 6),
    ("centered_discrepancy", "L2 centred discrepancy", "", 6),
];

/// Returns the numbers of a set.
pub fn scalars(set: &Found<'_>) -> Vec<Scalar> {
    let rows = SET.into_iter().chain(CURVES).chain(CELLS);
    let values = verdict(set).into_iter().chain(curves(set));
    let values = values.chain(cells(set));
    named(rows.zip(values))
}

/// Returns the numbers that a mean power has of its own.
pub fn of_mean_power(curve: Option<&PowerCurve>) -> Vec<Scalar> {
    let values = [
        curve.and_then(PowerCurve::effective_nyquist),
        curve.and_then(PowerCurve::oscillation),
    ];
    named(MEAN_CURVE.into_iter().zip(values))
}

fn named(values: impl Iterator<Item = (Row, Option<f64>)>) -> Vec<Scalar> {
    values
        .map(|((key, label, unit, decimals), value)| Scalar {
            key,
            label,
            unit,
            value: value.filter(|value| value.is_finite()),
            decimals,
        })
        .collect()
}

fn verdict(set: &Found<'_>) -> [Option<f64>; SET.len()] {
    let r = set.radius;
    [
        Some(set.samples as f64),
        Some(r).filter(|r| *r > 0.0),
        set.density,
        Some(set.min_distance / r),
        Some(set.covering_radius / r),
        set.conflicts.map(|count| count as f64),
        set.gaps.map(|count| count as f64),
    ]
}

fn curves(set: &Found<'_>) -> [Option<f64>; CURVES.len()] {
    let curve = set.curve;
    [
        Some(set.relative[0]),
        Some(set.relative[1]),
        curve.and_then(PowerCurve::effective_nyquist),
        curve.and_then(PowerCurve::effective_nyquist_psa),
        curve.and_then(PowerCurve::oscillation),
    ]
}

fn cells(set: &Found<'_>) -> [Option<f64>; CELLS.len()] {
    let of = |value: fn(&Order) -> f64| set.order.map(value);
    [
        of(|order| order.relative_areas.deviation),
        of(|order| {
            let all: u64 = order.sides.iter().sum();
            order.sides.get(6).copied().unwrap_or(0) as f64 / all as f64
        }),
        of(|order| order.mean_sides),
        of(|order| order.bond_order),
        of(|order| order.global_bond_order),
        set.discrepancy.map(|found| found.star),
        set.discrepancy.map(|found| found.centered),
    ]
}
