//! The measures of a set, part by part, so that a caller can show the first parts while the others are measured. The
//! numbers of [`super::numbers`] are read from it.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::blue_noise::PowerCurve;
use super::discrepancy::Discrepancy;
use super::distances::NearestDistances;
use super::error::MeasureError;
use super::numbers::{CATALOGUE, SetNumber, SolidMoment};
use super::order::Order;
use super::pair_correlation::PairCorrelation;
use super::periodogram::Periodogram;
use super::spectrum::Spectrum;
use super::window::FrequencyWindow;
use crate::error::VerifyError;
use crate::monitor::Control;
use crate::region::Region;
use crate::report::Report;
use crate::verify::{VerifyOptions, verify};

/// The factor by which the spectrum of low frequencies has fewer frequencies along each axis.
const ROUGHER: i64 = 4;

/// A part of the measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Part {
    /// The pair correlation, g(r).
    Pairs,
    /// The verifier's report: conflicts, gaps and extreme distances.
    Report,
    /// The distance from each sample to its nearest neighbour.
    Distances,
    /// The spectrum of low frequencies, a sixteenth of the work of the whole.
    Rough,
    /// The spectrum. Its transform takes the most memory.
    Spectrum,
    /// The smooth spectrum that follows from g(r).
    Smooth,
    /// The order of the Voronoi cells.
    Cells,
    /// The L2 discrepancies, star and centred.
    Discrepancy,
}

impl Part {
    /// The parts in the sequence in which they are measured: quick ones that say much come first.
    pub const ALL: [Self; 8] = [
        Self::Pairs,
        Self::Report,
        Self::Distances,
        Self::Rough,
        Self::Spectrum,
        Self::Smooth,
        Self::Cells,
        Self::Discrepancy,
    ];

    /// Returns the parts that numbers of the catalogue are read from.
    pub fn of_numbers() -> impl Iterator<Item = Self> {
        let is_needed = |part: &Self| CATALOGUE.iter().any(|number| number.needs == Some(*part));
        Self::ALL.into_iter().filter(is_needed)
    }

    /// Returns the name of the part, as it is shown while the part is measured.
    #[must_use]
    pub const fn doing(self) -> &'static str {
        match self {
            Self::Pairs => "g(r)",
            Self::Report => "conflicts and gaps",
            Self::Distances => "nearest neighbours",
            Self::Rough => "low frequencies",
            Self::Spectrum => "spectrum",
            Self::Smooth => "smooth spectrum",
            Self::Cells => "cells",
            Self::Discrepancy => "discrepancy",
        }
    }
}

/// The measures of a set that are known so far. Cloning it shares them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MeasuredSet {
    /// The number of samples.
    pub samples: usize,
    /// The region of the samples.
    pub region: Region,
    /// The Poisson-disk radius in the unit of the region, if it is known.
    pub radius: Option<f64>,
    /// The pair correlation, once it is measured.
    pub pairs: Option<Arc<PairCorrelation>>,
    /// Conflicts, gaps, distances and density; or why there is no verdict. Without a verdict the other parts are measured,
    /// too.
    pub report: Option<Result<Arc<Report>, String>>,
    /// Distances to nearest neighbours.
    pub distances: Option<Arc<NearestDistances>>,
    /// The spectrum of low frequencies; dropped once the whole one is measured.
    pub rough: Option<Arc<Spectrum>>,
    /// The spectrum of all frequencies, once it is measured.
    pub spectrum: Option<Arc<Spectrum>>,
    /// The smooth spectrum, unless the region is too narrow for it.
    pub curve: Option<Arc<PowerCurve>>,
    /// The order of the cells, unless two samples are equal.
    pub order: Option<Arc<Order>>,
    /// The L2 discrepancies, once they are measured.
    pub discrepancy: Option<Discrepancy>,
    /// The followed measures of a set in space; `None` of planar sets. The other measures are of its projection.
    pub space: Option<SolidMoment>,
    /// The area that is to be covered, if it is another one than that of the region.
    covered: Option<f64>,
    /// The parts that were measured, also those that are not defined for this set.
    known: Vec<Part>,
}

impl MeasuredSet {
    /// Returns the measures of a set before any part is known.
    #[must_use]
    pub const fn new(samples: usize, region: Region, radius: Option<f64>) -> Self {
        Self {
            samples,
            region,
            radius,
            pairs: None,
            report: None,
            distances: None,
            rough: None,
            spectrum: None,
            curve: None,
            order: None,
            discrepancy: None,
            space: None,
            covered: None,
            known: Vec::new(),
        }
    }

    /// Returns the same measures of a set in a shape or a field, of which this area is to be covered ([`Report::area`]).
    #[must_use]
    pub fn covering(self, area: f64) -> Self {
        Self {
            covered: Some(area),
            ..self
        }
    }

    /// Returns whether a part was measured.
    #[must_use]
    pub fn knows(&self, part: Part) -> bool {
        self.known.contains(&part)
    }

    /// Measures a part of the set with these samples, unless it is known. The cells need the report, which is measured
    /// before them.
    ///
    /// # Errors
    ///
    /// Those of the part's own function: fewer than three samples (for the discrepancy: no sample), samples outside the
    /// region or all at one position, no cell away from the border; `control` broke. That the verifier refuses the set
    /// is no error: `report` then says why.
    pub fn measure(
        &mut self,
        part: Part,
        points: &[[f64; 2]],
        control: Control<'_>,
    ) -> Result<(), MeasureError> {
        if self.knows(part) {
            return Ok(());
        }

        let (samples, region) = (points.len() as f64, self.region);
        match part {
            Part::Pairs => self.pairs = Some(Arc::new(self.pairs_of(points, control)?)),
            Part::Report => {
                let report = self.report_of(points, control)?;
                self.report = Some(report.map(Arc::new));
            }
            Part::Distances => {
                self.distances = Some(Arc::new(NearestDistances::of(points, region, control)?));
            }
            Part::Rough => {
                // A quarter of the frequencies along each axis are a sixteenth of the work.
                let window = fewer(&Spectrum::window(samples, region));
                self.rough = Some(Arc::new(spectrum(points, region, &window, control)?));
            }
            Part::Spectrum => {
                let window = Spectrum::window(samples, region);
                self.take_spectrum(spectrum(points, region, &window, control)?);
            }
            Part::Smooth => {
                self.curve = PowerCurve::of_samples(points, region, control)?.map(Arc::new);
            }
            Part::Cells => self.order = self.order_of(points, control)?.map(Arc::new),
            Part::Discrepancy => {
                self.discrepancy = Some(Discrepancy::of(points, region, control)?);
            }
        }

        // A part is known even if the set has no such measure.
        self.note_measured(part);
        Ok(())
    }

    /// Returns the area that is to be covered: that of the region, unless [`Self::covering`] or a report says that it is a
    /// shape, or that the radius varies ([`Report::area`]).
    #[must_use]
    pub fn area(&self) -> f64 {
        let judged = self.verdict().map(|report| report.area);
        judged
            .or(self.covered)
            .unwrap_or_else(|| self.region.area())
    }

    /// Takes the report of a verifier that judged the set before. If no radius is known, it may be that for any
    /// radius: the smallest distance and the covering radius do not depend on it.
    pub fn take_report(&mut self, report: Report) {
        self.report = Some(Ok(Arc::new(report)));
        self.note_measured(Part::Report);
    }

    /// Takes the spectrum of a window of frequencies that the caller chose.
    pub fn take_spectrum(&mut self, spectrum: impl Into<Arc<Spectrum>>) {
        self.spectrum = Some(spectrum.into());
        self.rough = None;
        self.note_measured(Part::Spectrum);
    }

    /// Notes that a part is known.
    fn note_measured(&mut self, part: Part) {
        if !self.knows(part) {
            self.known.push(part);
        }
    }

    /// Returns g(r) in bins of a fortieth of the radius or, without one that suits the set, of the largest minimum
    /// distance that so many samples can have.
    fn pairs_of(
        &self,
        points: &[[f64; 2]],
        control: Control<'_>,
    ) -> Result<PairCorrelation, MeasureError> {
        let region = self.region;
        let Some(radius) = self.radius else {
            return PairCorrelation::to_look_at(points, region, control);
        };

        match PairCorrelation::in_units_of(points, region, radius, control) {
            // The radius that a caller gave does not suit the set: not even one bin lies within the distances that are
            // counted, or the bins would be far too narrow.
            Err(MeasureError::OutOfRange { .. }) => {
                PairCorrelation::to_look_at(points, region, control)
            }
            pairs => pairs,
        }
    }

    /// Returns the report on the set, or why there is none. The error is that of a search that was stopped.
    fn report_of(
        &self,
        points: &[[f64; 2]],
        control: Control<'_>,
    ) -> Result<Result<Report, String>, MeasureError> {
        // Without a radius only numbers that do not depend on it are read; the spacing keeps the search quick.
        let spacing = || (self.region.area() / points.len().max(1) as f64).sqrt();
        let radius = self.radius.unwrap_or_else(spacing);

        match verify(
            points,
            self.region,
            radius,
            &VerifyOptions::default(),
            control,
        ) {
            Err(VerifyError::Cancelled) => Err(MeasureError::Cancelled),
            report => Ok(report.map_err(|error| error.to_string())),
        }
    }

    /// Returns the order of the cells; `None` if two samples are equal, which have no cells.
    fn order_of(
        &mut self,
        points: &[[f64; 2]],
        control: Control<'_>,
    ) -> Result<Option<Order>, MeasureError> {
        // The report has the smallest distance, which is 0 if two samples are equal.
        self.measure(Part::Report, points, control)?;
        let has_equal = (self.verdict()).is_some_and(|report| report.min_distance <= 0.0);
        let order = (!has_equal).then(|| Order::of(points, self.region, control));
        order.transpose()
    }

    /// Returns these measures with distances in another radius. Conflicts and gaps are defined only if it is the one that
    /// they were judged with.
    #[must_use]
    pub fn with_radius(&self, radius: f64) -> Self {
        Self {
            radius: Some(radius),
            ..self.clone()
        }
    }

    /// Returns the numbers of the catalogue in its sequence; `None` for one that is not defined or not finite.
    pub fn numbers(&self) -> impl Iterator<Item = (&'static SetNumber, Option<f64>)> {
        CATALOGUE.iter().map(|number| (number, number.of(self)))
    }

    /// Returns the verifier's report, once there is one.
    #[must_use]
    pub fn verdict(&self) -> Option<&Report> {
        self.report.as_ref()?.as_deref().ok()
    }

    /// Returns the verifier's report if it was made for the radius of the set.
    #[must_use]
    pub fn judged(&self) -> Option<&Report> {
        let radius = self.radius?;
        // The two may be rounded differently.
        let is_same = |report: &&Report| (report.radius - radius).abs() <= 1e-9 * radius;
        self.verdict().filter(is_same)
    }

    /// Returns r: the radius, or the smallest distance if the radius is not known. `None` if that is zero, or not known.
    #[must_use]
    pub fn r(&self) -> Option<f64> {
        let least = || Some(self.verdict()?.min_distance);
        self.radius.or_else(least).filter(|r| *r > 0.0)
    }

    /// Returns the spectrum, or otherwise that of low frequencies.
    #[must_use]
    pub fn spectrum_so_far(&self) -> Option<&Arc<Spectrum>> {
        self.spectrum.as_ref().or(self.rough.as_ref())
    }

    /// Returns the pair correlation as pairs of a distance, divided by `unit`, and g; none before it is measured.
    #[must_use]
    pub fn correlation(&self, unit: f64) -> Vec<[f64; 2]> {
        let Some(pairs) = &self.pairs else {
            return Vec::new();
        };
        let scale = pairs.r_max / unit;
        let points = pairs.points().into_iter();
        points.map(|[x, g]| [x * scale, g]).collect()
    }
}

/// Returns the low frequencies of a window, at least up to 1 along each axis.
fn fewer(whole: &FrequencyWindow) -> FrequencyWindow {
    let [x, y] = [&whole.x, &whole.y].map(|axis| ((axis.end - 1) / ROUGHER).max(1));
    FrequencyWindow {
        x: -x..x + 1,
        y: -y..y + 1,
    }
}

/// Returns the spectrum of a set at the frequencies of a window.
fn spectrum(
    points: &[[f64; 2]],
    region: Region,
    window: &FrequencyWindow,
    control: Control<'_>,
) -> Result<Spectrum, MeasureError> {
    Spectrum::of(&Periodogram::of(points, region, window, control)?)
}
