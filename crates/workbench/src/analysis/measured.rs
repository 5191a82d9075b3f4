//! What is measured of a set, part by part, the quick and telling parts first. Every number comes from
//! `tilescope_analysis`; nothing is computed here.

use std::ops::ControlFlow;
use std::sync::Arc;

use tilescope_analysis::measures::{
    FrequencyWindow, MeasureError, PairCorrelation, Periodogram, PowerCurve, Spectrum,
};
use tilescope_analysis::{Progress, Region, Report, VerifyError, VerifyOptions, verify};

/// Sets of so many samples get the spectrum of their low frequencies first.
const ROUGH_FROM: usize = 20_000;
/// By how much fewer frequencies along an axis that has.
const ROUGHER: i64 = 4;

/// Asked how far a measure has come, answers whether it shall go on.
pub type Control<'a> = &'a (dyn Fn(Progress) -> ControlFlow<()> + Sync);

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

/// What is known of a set so far.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct MeasuredSet {
    /// How many samples there are.
    pub samples: usize,
    /// Their region.
    pub region: Region,
    /// The Poisson-disk radius, in the unit of the region.
    pub radius: f64,
    /// The pair correlation.
    pub pairs: Option<Arc<PairCorrelation>>,
    /// Conflicts, gaps, distances and density; or why the verifier gives no verdict, which stops nothing else.
    pub report: Option<Result<Arc<Report>, String>>,
    /// The spectrum of low frequencies, while the whole one is not there.
    pub rough: Option<Arc<Spectrum>>,
    /// The spectrum.
    pub spectrum: Option<Arc<Spectrum>>,
    /// The smooth spectrum that follows from g(r), for effective Nyquist frequency and oscillation: there with the spectrum,
    /// unless the region is too narrow.
    pub curve: Option<Arc<PowerCurve>>,
}

/// A part of what is measured.
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
    /// Returns what is being done when it is measured.
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
    /// Returns what is known before anything is measured.
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

    /// Returns what comes next; `None` when all is known.
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
    /// Fails for fewer than three samples, for samples that are no places of the region or all one place, and when `control` breaks.
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
                    // No bin of r is within reach of so dense a set.
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
                    other => other
                        .map_err(|error| tilescope_session::words::sentence(&error.to_string())),
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

    /// Returns everything that is measured of `set`, without the rougher part that comes first.
    pub fn whole(set: &Samples, control: Control<'_>) -> Result<Self, MeasureError> {
        let mut measured = Self::nothing(set);
        for part in [
            MeasurePart::Pairs,
            MeasurePart::Report,
            MeasurePart::Spectrum,
        ] {
            measured.measure(part, set, control)?;
        }
        Ok(measured)
    }

    /// Returns the spectrum, or that of low frequencies.
    #[must_use]
    pub fn spectrum_so_far(&self) -> Option<&Arc<Spectrum>> {
        self.spectrum.as_ref().or(self.rough.as_ref())
    }

    /// Returns the verifier's report, once there is one.
    #[must_use]
    pub fn verdict(&self) -> Option<&Report> {
        Some(self.report.as_ref()?.as_ref().ok()?)
    }

    /// Returns whether conflicts and gaps were judged with r of length `unit`.
    #[must_use]
    pub fn is_judged_with(&self, unit: f64) -> bool {
        (self.radius - unit).abs() <= 1e-9 * unit
    }

    /// Returns distance and g(r), distances divided by `unit`.
    #[must_use]
    pub fn correlation(&self, unit: f64) -> Vec<[f64; 2]> {
        let Some(pairs) = &self.pairs else {
            return Vec::new();
        };
        let scale = pairs.r_max / unit;
        let places = pairs.places().into_iter();
        places.map(|[x, g]| [x * scale, g]).collect()
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

/// Returns why a set cannot be measured, as a sentence; `None` if it was the user's wish.
#[must_use]
pub fn refusal(error: &MeasureError) -> Option<String> {
    match error {
        MeasureError::Cancelled => None,
        MeasureError::TooFew { count, limit } => Some(format!(
            "{}; at least {limit} are needed to be measured.",
            tilescope_session::words::counted(*count, "sample stands", "samples stand")
        )),
        error => Some(tilescope_session::words::sentence(&error.to_string())),
    }
}
