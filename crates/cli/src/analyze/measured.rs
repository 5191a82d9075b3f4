//! One file, read, verified and measured: plain numbers and curves; its samples are gone.

use std::ops::ControlFlow;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use tilescope_analysis::measures::{
    Discrepancy, FrequencyWindow, MeasureError, NearestDistances, Order, PairCorrelation,
    Periodogram, Spectrum, largest_min_distance,
};
use tilescope_analysis::{Progress, Region, Report, VerifyError};
use tilescope_formats::{Check, CheckError, StreamReader};

use super::scalars::{Found, Scalar, scalars};
use crate::options::{SetArguments, UNIT_SQUARE};
use crate::output;
use crate::progress::{measuring, verifying};

/// Numbers of samples that are averaged differ from the first set's by this part of it at most.
pub const SPREAD_OF_COUNTS: f64 = 0.1;

/// What is known of a set beside its curves.
pub struct Member {
    /// The file as it was given.
    pub name: String,
    pub region: Region,
    pub samples: usize,
    /// The radius is known; otherwise it is the smallest distance.
    pub certain: bool,
    /// The verdict; none where the radius is not known.
    pub valid: Option<bool>,
    pub scalars: Vec<Scalar>,
}

/// A set and its curves.
pub struct Measured {
    pub member: Member,
    pub spectrum: Spectrum,
    pub pairs: PairCorrelation,
    pub periodogram: Periodogram,
}

/// What all sets of an average share: decided by the first of them.
pub struct Common {
    name: String,
    region: Region,
    samples: usize,
    window: FrequencyWindow,
    /// Largest distance of the pair correlation over `r_max`, and its bins.
    pairs: (f64, usize),
}

/// How files are measured.
pub struct Request<'a> {
    pub arguments: &'a SetArguments,
    /// The largest frequency as nu, where it was given.
    pub nu: Option<f64>,
}

type Control<'a> = &'a (dyn Fn(Progress) -> ControlFlow<()> + Sync);

impl Request<'_> {
    /// Reads, verifies and measures a file.
    pub fn measured(&self, path: &Path, common: Option<&Common>) -> Result<Measured> {
        let name = path.display().to_string();
        let measured = || -> Result<Measured> {
            self.refuse_early(path)?;
            let (check, certain) = read(path, self.arguments)?;
            for difference in &check.differences {
                eprint!("{}", output::warning_line(&format!("{name}: {difference}")));
            }
            let (samples, region) = (check.report.count, check.report.region);
            if let Some(common) = common {
                common.admit(samples, region)?;
            }
            let window = self.window(samples as f64, region)?;
            let shared = common.map_or((window, None), |common| {
                (common.window.clone(), Some(common.pairs))
            });
            let found = measuring(|control| of(&name, check, certain, shared, control))?;
            Ok(found)
        };
        measured().context(name.clone())
    }

    fn window(&self, samples: f64, region: Region) -> Result<FrequencyWindow, MeasureError> {
        match self.nu {
            Some(nu) => Spectrum::window_to(nu, samples, region),
            None => Ok(Spectrum::window(samples, region)),
        }
    }

    /// Refuses frequencies beyond memory before the set is read, where its head has its size and nothing else
    /// decides its domain.
    fn refuse_early(&self, path: &Path) -> Result<(), MeasureError> {
        let SetArguments { width, height, .. } = self.arguments;
        if self.nu.is_none() || width.is_some() || height.is_some() {
            return Ok(());
        }
        // What cannot be opened is told when it is read.
        if let Ok(reader) = StreamReader::open(path, self.arguments.format)
            && let Some(count) = reader.count()
        {
            let stated = reader.certificate().map(|stated| stated.region);
            self.window(count as f64, stated.unwrap_or(UNIT_SQUARE))?;
        }
        Ok(())
    }
}

impl Common {
    /// Returns what the first set of an average decides for the others.
    pub fn of(first: &Measured) -> Self {
        let Member {
            name,
            region,
            samples,
            ..
        } = &first.member;
        Self {
            name: name.clone(),
            region: *region,
            samples: *samples,
            window: first.periodogram.window.clone(),
            pairs: (
                first.pairs.bin_width * first.pairs.g.len() as f64,
                first.pairs.g.len(),
            ),
        }
    }

    fn admit(&self, samples: usize, region: Region) -> Result<()> {
        ensure!(
            region == self.region,
            "its domain, {}, is not that of {}, {}",
            output::region_text(&region),
            self.name,
            output::region_text(&self.region)
        );
        let off = (samples as f64 / self.samples as f64 - 1.0).abs();
        ensure!(
            off <= SPREAD_OF_COUNTS,
            "its {samples} samples are not within {} % of the {} of {}: they are not averaged",
            100.0 * SPREAD_OF_COUNTS,
            self.samples,
            self.name
        );
        Ok(())
    }
}

/// Returns the largest distance of the pair correlation over `r_max`, and its bins: 40 to each `r_max`. Sets of fewer samples, as
/// far as they are averaged with this one, reach as far.
fn reach_of_pairs(samples: usize, region: Region) -> (f64, usize) {
    let r_max = largest_min_distance(samples, region.area());
    let half = 0.499 * region.width.min(region.height) / r_max;
    let most = (half * (1.0 - SPREAD_OF_COUNTS).sqrt()).min(5.0);
    (most, (40.0 * most).ceil().max(1.0) as usize)
}

fn of(
    name: &str,
    check: Check,
    certain: bool,
    (window, pairs): (FrequencyWindow, Option<(f64, usize)>),
    control: Control<'_>,
) -> Result<Measured, MeasureError> {
    let points = &check.set.points;
    let mut report = check.report;
    let region = report.region;
    let relative = distances(points, certain, &mut report, control)?;
    let discrepancy = discrepancy(points, region, control)?;
    let periodogram = Periodogram::of(points, region, &window, control)?;
    let spectrum = Spectrum::of(&periodogram)?;
    let (most, bins) = pairs.unwrap_or_else(|| reach_of_pairs(points.len(), region));
    let pairs = PairCorrelation::of(points, region, most, bins, control)?;
    let order = Order::of(points, region, control)?;
    let found = Found {
        report: &report,
        certain,
        relative,
        curve: spectrum.curve.as_ref(),
        order: &order,
        discrepancy,
    };
    Ok(Measured {
        member: Member {
            name: name.to_owned(),
            region,
            samples: report.count,
            certain,
            valid: certain.then(|| report.valid()),
            scalars: scalars(&found),
        },
        spectrum,
        pairs,
        periodogram,
    })
}

/// Returns the discrepancies; none of sets that are too large for them.
fn discrepancy(
    points: &[[f64; 2]],
    region: Region,
    control: Control<'_>,
) -> Result<Option<Discrepancy>, MeasureError> {
    match Discrepancy::of(points, region, control) {
        Err(MeasureError::TooMany { .. }) => Ok(None),
        found => found.map(Some),
    }
}

/// Returns smallest and mean nearest distance over `r_max`; the smallest stands for a radius that is not known.
fn distances(
    points: &[[f64; 2]],
    certain: bool,
    report: &mut Report,
    control: Control<'_>,
) -> Result<[f64; 2], MeasureError> {
    let region = report.region;
    let found = NearestDistances::of(points, region, control)?;
    if !certain {
        report.radius = found.summary.least;
        report.density = points.len() as f64 * report.radius.powi(2) / region.area();
    }
    Ok([found.relative_radius(), found.mean_relative_distance()])
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
            Err(error) => return Err(reason(error, path, arguments)),
            Ok(found) => return Ok((found, certain)),
        }
    }
}

/// Says why a file was not verified: no verdict was asked for, and numbers beyond all limits have hundreds of digits.
fn reason(error: CheckError, path: &Path, arguments: &SetArguments) -> anyhow::Error {
    match error {
        CheckError::Verify(VerifyError::Duplicate { .. }) => {
            let read = arguments.read(path).ok();
            let equal = read.and_then(|found| all_equal(&found.set.points));
            equal.map_or_else(|| error.into(), Into::into)
        }
        CheckError::Verify(VerifyError::BadRadius { radius }) => anyhow::anyhow!(
            "the radius {radius:?} is not a positive number between 2^-100 and 2^100 times the domain's longer side"
        ),
        CheckError::Verify(VerifyError::BadRegion { width, height }) => anyhow::anyhow!(
            "the domain {width:?} x {height:?} is not supported: sides must lie between 2^-100 and 2^100, one at most 2^40 times the other"
        ),
        other => other.into(),
    }
}

fn all_equal(points: &[[f64; 2]]) -> Option<MeasureError> {
    let (&point, rest) = points.split_first()?;
    let equal = rest
        .iter()
        .all(|other| other.map(f64::to_bits) == point.map(f64::to_bits));
    equal.then_some(MeasureError::AllEqual {
        count: points.len(),
        point,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_sets_at_one_place_are_all_equal() {
        let same = [[0.25, 0.5]; 4];
        let error = all_equal(&same).unwrap().to_string();
        assert_eq!(error, "all 4 samples are at the one place (0.25, 0.5)");
        assert_eq!(all_equal(&[[0.0, 0.0], [0.0, 0.0], [0.0, 0.1]]), None);
    }
}
