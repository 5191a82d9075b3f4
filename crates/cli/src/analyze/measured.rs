//! One set with everything that is measured of it.

use std::ops::ControlFlow;
use std::path::Path;

use anyhow::{Context, Result};
use tilescope_analysis::measures::{
    CoarsePower, Discrepancy, FrequencyWindow, MeasureError, NearestDistances, Order,
    PairCorrelation, Periodogram, PowerCurve, RadialProfile, power_band,
};
use tilescope_analysis::{Boundary, Progress, Region, Report};
use tilescope_formats::{Check, CheckError};

use crate::options::{SetArguments, UNIT_SQUARE};
use crate::output;
use crate::progress::{measuring, verifying};

/// Frequencies are looked at up to this `nu`, or up to `MOST_CYCLES` along the shorter side.
const MOST_NU: f64 = 2.5;
const MOST_CYCLES: f64 = 1023.0;
/// Annuli of a profile at most.
const ANNULI: f64 = 150.0;
/// Distances are looked at up to this multiple of `r_max`, in so many bins each.
const MOST_DISTANCE: f64 = 5.0;
const BINS_PER_R_MAX: f64 = 40.0;
/// Cells along the picture of a periodogram.
const PICTURE_CELLS: usize = 121;
/// Probability that a band holds the true power.
const LEVEL: f64 = 0.95;

/// A set, its verdict and its measures.
pub struct Measured {
    /// The file as it was given.
    pub name: String,
    pub region: Region,
    /// The radius is known; otherwise it is the smallest distance.
    pub certain: bool,
    pub report: Report,
    pub distances: NearestDistances,
    pub order: Order,
    /// None for sets that are too large for it.
    pub discrepancy: Option<Discrepancy>,
    pub profile: RadialProfile,
    /// Factors from a mean power to the ends of its band; none where frequencies are correlated.
    pub bands: Option<Vec<[f64; 2]>>,
    pub curve: Option<PowerCurve>,
    pub pairs: PairCorrelation,
    pub picture: CoarsePower,
    /// Half of the picture's extent on a square, as `nu`.
    pub picture_reach: f64,
}

type Control<'a> = &'a (dyn Fn(Progress) -> ControlFlow<()> + Sync);

impl Measured {
    /// Reads, verifies and measures a file.
    pub fn of_file(path: &Path, arguments: &SetArguments) -> Result<Self> {
        let name = path.display().to_string();
        let (check, certain) = read(path, arguments).with_context(|| name.clone())?;
        for difference in &check.differences {
            eprint!("{}", output::warning_line(&format!("{name}: {difference}")));
        }
        measuring(|control| Self::of(name.clone(), check, certain, control)).context(name)
    }

    fn of(
        name: String,
        check: Check,
        certain: bool,
        control: Control<'_>,
    ) -> Result<Self, MeasureError> {
        let points = &check.set.points;
        let mut report = check.report;
        let region = report.region;
        let distances = NearestDistances::of(points, region, control)?;
        if !certain {
            report.radius = distances.summary.least;
            report.density = points.len() as f64 * report.radius.powi(2) / region.area();
        }
        let discrepancy = match Discrepancy::of(points, region, control) {
            Err(MeasureError::TooMany { .. }) => None,
            found => Some(found?),
        };
        let periodogram = periodogram(points, region, control)?;
        let longest = periodogram.window.x.end as f64;
        let profile = RadialProfile::of(&periodogram, (longest / ANNULI).max(1.0))?;
        let picture = CoarsePower::of(&periodogram, PICTURE_CELLS)?;
        let reach = 0.5 * (picture.size * picture.side) as f64 / (points.len() as f64).sqrt();
        Ok(Self {
            order: Order::of(points, region, control)?,
            pairs: pairs(points, region, control)?,
            bands: bands(&profile, region)?,
            curve: PowerCurve::of_profile(&profile).ok(),
            name,
            region,
            certain,
            report,
            distances,
            discrepancy,
            profile,
            picture,
            picture_reach: reach,
        })
    }

    /// Returns the mean powers as nu, power and, where there is one, the ends of its band.
    pub fn power(&self) -> Vec<Place> {
        let nus = self.profile.relative_frequencies();
        let each = nus.iter().zip(&self.profile.annuli).enumerate();
        each.map(|(index, (nu, annulus))| Place {
            x: *nu,
            y: annulus.power,
            band: (self.bands.as_ref()).map(|bands| bands[index].map(|end| end * annulus.power)),
        })
        .collect()
    }

    /// Returns the anisotropies in decibels; annuli without one are left out.
    pub fn anisotropy(&self) -> Vec<Place> {
        let nus = self.profile.relative_frequencies();
        let each = nus.iter().zip(&self.profile.annuli);
        each.map(|(nu, annulus)| Place::new(*nu, annulus.anisotropy_db))
            .filter(|place| place.y.is_finite())
            .collect()
    }

    /// Returns the pair correlation.
    pub fn correlation(&self) -> Vec<Place> {
        let each = self.pairs.g.iter().enumerate();
        each.map(|(bin, g)| Place::new(self.pairs.distance(bin), *g))
            .collect()
    }
}

/// A place of a curve.
pub struct Place {
    pub x: f64,
    pub y: f64,
    pub band: Option<[f64; 2]>,
}

impl Place {
    fn new(x: f64, y: f64) -> Self {
        Self { x, y, band: None }
    }
}

/// Reads and verifies a file; without a radius its spacing stands for one, and nothing is certain.
fn read(path: &Path, arguments: &SetArguments) -> Result<(Check, bool)> {
    let mut overrides = arguments.overrides(path)?;
    let mut certain = true;
    loop {
        match verifying(|control| tilescope_formats::check(path, &overrides, control)) {
            Err(CheckError::NoRegion(_)) if overrides.region.is_none() => {
                overrides.region = Some(UNIT_SQUARE);
            }
            Err(CheckError::NoRadius) if overrides.radius.is_none() => {
                let count = arguments.read(path)?.set.len();
                if count < 3 {
                    return Err(MeasureError::TooFew { count, limit: 3 }.into());
                }
                // The smallest distance and the covering radius do not depend on the radius; the
                // spacing keeps the search quick.
                let region = overrides.region.unwrap_or(UNIT_SQUARE);
                overrides.radius = Some((region.area() / count as f64).sqrt());
                certain = false;
            }
            outcome => return Ok((outcome?, certain)),
        }
    }
}

fn periodogram(
    points: &[[f64; 2]],
    region: Region,
    control: Control<'_>,
) -> Result<Periodogram, MeasureError> {
    let aspect = (region.width / region.height).max(region.height / region.width);
    let most = (MOST_NU * (points.len() as f64 * aspect).sqrt()).ceil();
    let window = FrequencyWindow::centered(most.clamp(8.0, MOST_CYCLES) as u32);
    Periodogram::of(points, region, &window, control)
}

/// A taper makes neighbouring frequencies depend on each other: there the bands would be too narrow.
fn bands(profile: &RadialProfile, region: Region) -> Result<Option<Vec<[f64; 2]>>, MeasureError> {
    if region.boundary == Boundary::Bounded {
        return Ok(None);
    }
    let band = |count: u64| power_band(0.5 * count as f64, LEVEL);
    let all: Result<_, _> = profile.annuli.iter().map(|a| band(a.count)).collect();
    all.map(Some)
}

fn pairs(
    points: &[[f64; 2]],
    region: Region,
    control: Control<'_>,
) -> Result<PairCorrelation, MeasureError> {
    let r_max = tilescope_analysis::measures::largest_min_distance(points.len(), region.area());
    let half = 0.499 * region.width.min(region.height) / r_max;
    let most = half.min(MOST_DISTANCE);
    let bins = (BINS_PER_R_MAX * most).ceil().max(1.0) as usize;
    PairCorrelation::of(points, region, most, bins, control)
}
