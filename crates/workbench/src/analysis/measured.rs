//! The measures of a set, in parts: the quick and informative ones first. `tilescope_analysis` computes them.

use std::sync::Arc;

use tilescope_analysis::measures::{
    FrequencyWindow, MeasureError, PairCorrelation, Periodogram, PowerCurve, Spectrum,
};
use tilescope_analysis::{Control, Region, Report, VerifyError, VerifyOptions, verify};
use tilescope_session::words::{counted, sentence};

/// The size of a set from which the spectrum of its low frequencies is measured first.
const ROUGH_FROM: usize = 20_000;
/// The factor by which that spectrum has fewer frequencies along each axis.
const ROUGHER: i64 = 4;

/// A set to be measured.
#[derive(serde::Serialize, serde::Deserialize)]
pub struct Samples {
    /// The positions.
    pub points: Vec<[f64; 2]>,
    /// Their region.
    pub region: Region,
    /// The Poisson-disk radius, in the unit of the positions.
    pub radius: f64,
}

/// The measures of a set that are known so far.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct MeasuredSet {
    /// The number of samples.
    pub samples: usize,
    /// Their region.
    pub region: Region,
    /// The Poisson-disk radius, in the unit of the region.
    pub radius: f64,
    /// The pair correlation.
    pub pairs: Option<Arc<PairCorrelation>>,
    /// Conflicts, gaps, distances and density; or why there is no verdict. Without a verdict the other parts are measured,
    /// too.
    pub report: Option<Result<Arc<Report>, String>>,
    /// The spectrum of low frequencies, until the whole one is known.
    pub rough: Option<Arc<Spectrum>>,
    /// The spectrum.
    pub spectrum: Option<Arc<Spectrum>>,
    /// The smooth spectrum derived from g(r), for the effective Nyquist frequency and oscillation; known with
    /// the spectrum unless the region is too narrow.
    pub curve: Option<Arc<PowerCurve>>,
}

/// A part of the measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum MeasurePart {
    /// The pair correlation.
    Pairs,
    /// The verifier's report.
    Report,
    /// The spectrum of low frequencies.
    Rough,
    /// The spectrum.
    Spectrum,
}

impl MeasurePart {
    /// Returns the name of the measure in this part, as shown while it runs.
    #[must_use]
    pub const fn doing(self) -> &'static str {
        match self {
            Self::Pairs => "g(r)",
            Self::Report => "conflicts and gaps",
            Self::Rough => "low frequencies",
            Self::Spectrum => "spectrum",
        }
    }
}

impl MeasuredSet {
    /// Returns the measures before any part is known.
    #[must_use]
    pub fn nothing(set: &Samples) -> Self {
        Self {
            samples: set.points.len(),
            region: set.region,
            radius: set.radius,
            pairs: None,
            report: None,
            rough: None,
            spectrum: None,
            curve: None,
        }
    }

    /// Returns the part to measure next; `None` when all are known.
    #[must_use]
    pub fn missing(&self) -> Option<MeasurePart> {
        if self.pairs.is_none() {
            Some(MeasurePart::Pairs)
        } else if self.report.is_none() {
            Some(MeasurePart::Report)
        } else if self.spectrum.is_some() {
            None
        } else if self.rough.is_none() && self.samples >= ROUGH_FROM {
            Some(MeasurePart::Rough)
        } else {
            Some(MeasurePart::Spectrum)
        }
    }

    /// Measures a part of `set`.
    ///
    /// Fails for fewer than three samples, for samples outside the region or all at one position, and when
    /// `control` breaks.
    pub fn measure(
        &mut self,
        part: MeasurePart,
        set: &Samples,
        control: Control<'_>,
    ) -> Result<(), MeasureError> {
        let (points, region) = (&set.points[..], set.region);
        match part {
            MeasurePart::Pairs => {
                let pairs = match PairCorrelation::in_units_of(points, region, set.radius, control)
                {
                    // The set is too dense for a bin of r to be within range.
                    Err(MeasureError::OutOfRange { .. }) => {
                        PairCorrelation::to_look_at(points, region, control)?
                    }
                    pairs => pairs?,
                };
                self.pairs = Some(Arc::new(pairs));
            }
            MeasurePart::Report => {
                let options = VerifyOptions::default();
                let report = match verify(points, region, set.radius, &options, control) {
                    Err(VerifyError::Cancelled) => return Err(MeasureError::Cancelled),
                    other => other.map_err(|error| sentence(&error.to_string())),
                };
                self.report = Some(report.map(Arc::new));
            }
            MeasurePart::Rough => {
                let whole = Spectrum::window(points.len() as f64, region);
                let fewer = |end: i64| ((end - 1) / ROUGHER).max(1);
                let [x, y] = [&whole.x, &whole.y].map(|axis| fewer(axis.end));
                let window = FrequencyWindow {
                    x: -x..x + 1,
                    y: -y..y + 1,
                };
                self.rough = Some(spectrum(points, region, &window, control)?);
            }
            MeasurePart::Spectrum => {
                let window = Spectrum::window(points.len() as f64, region);
                let found = spectrum(points, region, &window, control)?;
                self.curve = PowerCurve::of_samples(points, region, control)?.map(Arc::new);
                self.spectrum = Some(found);
                self.rough = None;
            }
        }
        Ok(())
    }

    /// Returns all measures of `set`, without the spectrum of low frequencies.
    pub fn whole(set: &Samples, control: Control<'_>) -> Result<Self, MeasureError> {
        let mut measured = Self::nothing(set);
        measured.measure(MeasurePart::Pairs, set, control)?;
        measured.measure(MeasurePart::Report, set, control)?;
        measured.measure(MeasurePart::Spectrum, set, control)?;
        Ok(measured)
    }

    /// Returns the spectrum, or otherwise that of low frequencies.
    #[must_use]
    pub fn spectrum_so_far(&self) -> Option<&Arc<Spectrum>> {
        self.spectrum.as_ref().or(self.rough.as_ref())
    }

    /// Returns the verifier's report, once there is one.
    #[must_use]
    pub fn verdict(&self) -> Option<&Report> {
        Some(self.report.as_ref()?.as_ref().ok()?)
    }

    /// Returns whether conflicts and gaps were verified with a radius of `unit`.
    #[must_use]
    pub fn is_judged_with(&self, unit: f64) -> bool {
        (self.radius - unit).abs() <= 1e-9 * unit
    }

    /// Returns the pair correlation as pairs of a distance, divided by `unit`, and g.
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

fn spectrum(
    points: &[[f64; 2]],
    region: Region,
    window: &FrequencyWindow,
    control: Control<'_>,
) -> Result<Arc<Spectrum>, MeasureError> {
    let periodogram = Periodogram::of(points, region, window, control)?;
    Spectrum::of(&periodogram).map(Arc::new)
}

/// Returns why a set cannot be measured, as a sentence; `None` if the user stopped it.
#[must_use]
pub fn refusal(error: &MeasureError) -> Option<String> {
    match error {
        MeasureError::Cancelled => None,
        MeasureError::TooFew { count, limit } => Some(format!(
            "{}; at least {limit} are needed to be measured.",
            counted(*count, "sample stands", "samples stand")
        )),
        error => Some(sentence(&error.to_string())),
    }
}
