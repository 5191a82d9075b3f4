//! The numbers that describe a set, gathered from its verdict and the measures beside this module.

use serde::Serialize;

use super::blue_noise::PowerCurve;
use super::discrepancy::Discrepancy;
use super::distances::NearestDistances;
use super::error::MeasureError;
use super::order::Order;
use crate::monitor::Control;
use crate::report::Report;

/// The numbers of a set; `None` where one is not defined. Serialized, a number that is not finite is null.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SetNumbers {
    /// Number of samples N.
    pub samples: f64,
    /// The radius r, or the smallest distance between two samples if no radius is known.
    pub radius: Option<f64>,
    /// N r² / area.
    pub density: Option<f64>,
    /// The smallest distance, in r.
    pub min_distance_r: f64,
    /// The largest distance from a place to the nearest sample, in r.
    pub covering_radius_r: f64,
    /// Pairs closer than r, if r is known.
    pub conflicts: Option<f64>,
    /// Places farther than r from all samples, if r is known.
    pub gaps: Option<f64>,
    /// The smallest distance, in `r_max`.
    pub relative_radius: f64,
    /// The mean distance to the nearest sample, in `r_max`.
    pub mean_nearest_distance: f64,
    /// [`PowerCurve::effective_nyquist`].
    pub effective_nyquist: Option<f64>,
    /// [`PowerCurve::effective_nyquist_psa`].
    pub effective_nyquist_psa: Option<f64>,
    /// [`PowerCurve::oscillation`].
    pub oscillation: Option<f64>,
    /// Standard deviation of the areas of Voronoi cells, in mean areas. Cells and what follows from them are not defined
    /// if two samples are equal.
    pub area_deviation: Option<f64>,
    /// Share of the cells that have six sides.
    pub six_sided: Option<f64>,
    /// Mean number of sides of a cell.
    pub mean_sides: Option<f64>,
    /// [`Order::bond_order`].
    pub bond_order: Option<f64>,
    /// [`Order::global_bond_order`].
    pub global_bond_order: Option<f64>,
    /// [`Discrepancy::star`], unless the set is too large for it.
    pub star_discrepancy: Option<f64>,
    /// [`Discrepancy::centered`], unless the set is too large for it.
    pub centered_discrepancy: Option<f64>,
}

impl SetNumbers {
    /// Measures a set that was verified, and returns also the power from which its blue noise is read. If no radius is
    /// known, `report` is that for any radius: the smallest distance and the covering radius do not depend on it.
    ///
    /// # Errors
    ///
    /// Fewer than three samples, samples outside the region, samples that are all equal; the caller cancelled.
    pub fn of(
        points: &[[f64; 2]],
        report: &Report,
        has_radius: bool,
        control: Control<'_>,
    ) -> Result<(Self, Option<PowerCurve>), MeasureError> {
        let (region, samples) = (report.region, points.len() as f64);
        let distances = NearestDistances::of(points, region, control)?;
        let discrepancy = match Discrepancy::of(points, region, control) {
            Err(MeasureError::TooMany { .. }) => None,
            discrepancy => Some(discrepancy?),
        };
        let curve = PowerCurve::of_samples(points, region, control)?;
        let has_cells = report.min_distance > 0.0;
        let order = has_cells.then(|| Order::of(points, region, control));
        let order = order.transpose()?;
        let least = distances.summary.least;
        let r = if has_radius { report.radius } else { least };
        let radius = Some(r).filter(|r| *r > 0.0);
        let judged = has_radius.then_some(report);
        let of_curve = |value: fn(&PowerCurve) -> Option<f64>| curve.as_ref().and_then(value);
        let of_order = |value: fn(&Order) -> f64| order.as_ref().map(value);
        let six_sided = |order: &Order| {
            let all: u64 = order.sides.iter().sum();
            order.sides.get(6).copied().unwrap_or(0) as f64 / all as f64
        };
        let numbers = Self {
            samples,
            radius,
            density: radius.map(|r| samples * r.powi(2) / region.area()),
            min_distance_r: least / r,
            covering_radius_r: report.covering_radius / r,
            conflicts: judged.map(|report| report.conflicts as f64),
            gaps: judged.map(|report| report.gaps as f64),
            relative_radius: distances.relative_radius(),
            mean_nearest_distance: distances.mean_relative_distance(),
            effective_nyquist: of_curve(PowerCurve::effective_nyquist),
            effective_nyquist_psa: of_curve(PowerCurve::effective_nyquist_psa),
            oscillation: of_curve(PowerCurve::oscillation),
            area_deviation: of_order(|order| order.relative_areas.deviation),
            six_sided: of_order(six_sided),
            mean_sides: of_order(|order| order.mean_sides),
            bond_order: of_order(|order| order.bond_order),
            global_bond_order: of_order(|order| order.global_bond_order),
            star_discrepancy: discrepancy.as_ref().map(|found| found.star),
            centered_discrepancy: discrepancy.as_ref().map(|found| found.centered),
        };
        Ok((numbers, curve))
    }
}
