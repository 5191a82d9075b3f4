//! One file, read, verified and measured. Its numbers and curves are kept, its samples are not.

use std::cell::Cell;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use tilescope_analysis::measures::{
    Discrepancy, FrequencyWindow, MeasureError, NearestDistances, Order, PairBins, PairCorrelation,
    Periodogram, PowerCurve, Spectrum, largest_min_distance,
};
use tilescope_analysis::{MAX_CONFLICTS, Region, Report, VerifyError};
use tilescope_formats::{CheckError, Format, StreamReader};

use super::measure::{Measure, of_set};
use crate::options::{SetArguments, UNIT_SQUARE};
use crate::output;
use crate::progress::{Control, measuring, verifying};

/// Frequencies that take more memory than this are computed only when they are asked for: 2 GiB are those of 1.3 million
/// samples.
const MAX_UNASKED_BYTES: u64 = 1 << 31;

/// The facts about a set beside its curves.
#[derive(Clone)]
pub struct Member {
    /// The file as it was given.
    pub name: String,
    pub region: Region,
    /// As it was recognised.
    pub format: Format,
    pub samples: usize,
    /// Whether the radius is known; otherwise it is the smallest distance.
    pub has_radius: bool,
    /// The verdict, where the radius is known.
    pub valid: Option<bool>,
    pub measures: Vec<Measure>,
}

/// A set and its curves.
pub struct MeasuredSet {
    pub member: Member,
    pub spectrum: Spectrum,
    /// The smooth spectrum that follows from g(r), unless the domain is too narrow.
    pub curve: Option<PowerCurve>,
    /// Distance over `r_max`, and g(r).
    pub pairs: Vec<[f64; 2]>,
    pub periodogram: Periodogram,
    bins: PairBins,
}

/// The settings that all sets of an average share, taken from the first.
pub struct Common {
    first: Member,
    window: FrequencyWindow,
    bins: PairBins,
}

/// How files are measured.
pub struct Request<'a> {
    arguments: &'a SetArguments,
    /// The largest frequency as nu, where it was given.
    nu: Option<f64>,
    /// The radius of all sets, if it is known and the same: their distances begin there, and are cut there.
    radius: Option<f64>,
    /// The `r_max` of the first set of one radius, the unit of all their distances.
    unit: Cell<Option<f64>>,
}

/// A set that was read, and what the verifier says of it.
struct CheckedSet {
    points: Vec<[f64; 2]>,
    format: Format,
    region: Region,
    /// Whether the radius is known; otherwise the report is for one that keeps searches quick.
    has_radius: bool,
    report: Report,
    warnings: Vec<String>,
}

impl<'a> Request<'a> {
    /// Returns how all of `paths` are measured. Files that cannot be read have no say in it.
    pub fn new(arguments: &'a SetArguments, nu: Option<f64>, paths: &[&Path]) -> Self {
        let stated = |path: &&Path| match arguments.radius {
            Some(radius) => Some(Some(radius)),
            None => (arguments.certificate(path).ok()).map(|found| found.map(|c| c.radius)),
        };
        let radii: Option<Vec<f64>> = paths.iter().filter_map(stated).collect();
        let radii = radii.unwrap_or_default();
        let is_same = |first: &f64| (radii.iter()).all(|r| (r / first - 1.0).abs() <= 1e-9);
        Self {
            arguments,
            nu,
            radius: radii.first().copied().filter(is_same),
            unit: Cell::new(None),
        }
    }

    /// Reads, verifies and measures a file.
    pub fn measure(&self, path: &Path, common: Option<&Common>) -> Result<MeasuredSet> {
        let measured = self.measured(path, common);
        measured.with_context(|| path.display().to_string())
    }

    fn measured(&self, path: &Path, common: Option<&Common>) -> Result<MeasuredSet> {
        let name = path.display();
        self.refuse_early(path)?;
        let set = read(path, self.arguments)?;
        for warning in &set.warnings {
            output::note(output::warning_line(&format!("{name}: {warning}")).trim_end());
        }
        let (samples, region) = (set.points.len(), set.region);
        if let Some(common) = common {
            common.admit(samples, region)?;
        }
        let window = self.window(samples as f64, region)?;
        let bins = PairBins::of(self.radius, samples, region);
        let shared = common.map_or((window, bins), |common| {
            (common.window.clone(), common.bins)
        });
        let mut measured = measuring(|control| measure(name.to_string(), &set, shared, control))?;
        if self.radius.is_some() {
            let own = largest_min_distance(samples, region.area());
            let unit = self.unit.get().unwrap_or(own);
            self.unit.set(Some(unit));
            for point in &mut measured.pairs {
                point[0] *= own / unit;
            }
        }
        Ok(measured)
    }

    fn window(&self, samples: f64, region: Region) -> Result<FrequencyWindow, MeasureError> {
        if let Some(nu) = self.nu {
            return Spectrum::window_to(nu, samples, region);
        }
        let wide = Spectrum::window_to(Spectrum::MAX_NU, samples, region).ok();
        let fits = |wide: &FrequencyWindow| wide.bytes().is_ok_and(|b| b <= MAX_UNASKED_BYTES);
        Ok((wide.filter(fits)).unwrap_or_else(|| Spectrum::window(samples, region)))
    }

    /// Refuses frequencies that take too much memory before the set is read, where the file's head has its size and
    /// the domain does not depend on arguments.
    fn refuse_early(&self, path: &Path) -> Result<(), MeasureError> {
        let SetArguments { width, height, .. } = self.arguments;
        if self.nu.is_none() || width.is_some() || height.is_some() {
            return Ok(());
        }
        // Reading reports why a file cannot be opened.
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
    pub fn of(first: &MeasuredSet) -> Self {
        Self {
            first: first.member.clone(),
            window: first.periodogram.window.clone(),
            bins: first.bins,
        }
    }

    fn admit(&self, samples: usize, region: Region) -> Result<()> {
        let first = &self.first;
        ensure!(
            region == first.region,
            "its domain, {}, is not that of {}, {}",
            output::region_text(&region),
            first.name,
            output::region_text(&first.region)
        );
        let off = (samples as f64 / first.samples as f64 - 1.0).abs();
        ensure!(
            off <= PairBins::MAX_COUNT_SPREAD,
            "its {samples} samples are not within {} % of the {} of {}: they are not averaged",
            100.0 * PairBins::MAX_COUNT_SPREAD,
            first.samples,
            first.name
        );
        Ok(())
    }
}

fn measure(
    name: String,
    set: &CheckedSet,
    (window, bins): (FrequencyWindow, PairBins),
    control: Control<'_>,
) -> Result<MeasuredSet, MeasureError> {
    let (points, region, report) = (&set.points, set.region, &set.report);
    let samples = points.len();
    let distances = NearestDistances::of(points, region, control)?;
    let discrepancy = match Discrepancy::of(points, region, control) {
        Err(MeasureError::TooMany { .. }) => None,
        discrepancy => Some(discrepancy?),
    };
    let periodogram = Periodogram::of(points, region, &window, control)?;
    let spectrum = Spectrum::of(&periodogram)?;
    let farthest = bins.farthest(samples, region);
    let pairs = PairCorrelation::of(points, region, farthest, bins.count(), control)?;
    let curve = PowerCurve::of_samples(points, region, control)?;
    // Equal samples have no cells.
    let order = (!has_equal(report)).then(|| Order::of(points, region, control));
    let order = order.transpose()?;
    let least = distances.summary.least;
    let r = if set.has_radius { report.radius } else { least };
    // Conflicts and gaps mean nothing for a radius that is not known.
    let judged = set.has_radius.then_some(report);
    let of_curve = |value: fn(&PowerCurve) -> Option<f64>| curve.as_ref().and_then(value);
    let of_order = |value: fn(&Order) -> f64| order.as_ref().map(value);
    let six_sided = |order: &Order| {
        let all: u64 = order.sides.iter().sum();
        order.sides.get(6).copied().unwrap_or(0) as f64 / all as f64
    };
    let measures = of_set(&[
        Some(samples as f64),
        Some(r).filter(|r| *r > 0.0),
        (r > 0.0).then(|| samples as f64 * r.powi(2) / region.area()),
        Some(least / r),
        Some(report.covering_radius / r),
        judged.map(|report| report.conflicts as f64),
        judged.map(|report| report.gaps as f64),
        Some(distances.relative_radius()),
        Some(distances.mean_relative_distance()),
        of_curve(PowerCurve::effective_nyquist),
        of_curve(PowerCurve::effective_nyquist_psa),
        of_curve(PowerCurve::oscillation),
        of_order(|order| order.relative_areas.deviation),
        of_order(six_sided),
        of_order(|order| order.mean_sides),
        of_order(|order| order.bond_order),
        of_order(|order| order.global_bond_order),
        discrepancy.map(|found| found.star),
        discrepancy.map(|found| found.centered),
    ]);
    Ok(MeasuredSet {
        member: Member {
            name,
            region,
            format: set.format,
            samples,
            has_radius: set.has_radius,
            valid: judged.map(Report::valid),
            measures,
        },
        spectrum,
        curve,
        pairs: pairs.points(),
        periodogram,
        bins,
    })
}

/// Reads and verifies a file; without a radius its mean spacing replaces the radius.
fn read(path: &Path, arguments: &SetArguments) -> Result<CheckedSet> {
    let mut overrides = arguments.overrides(path)?;
    let mut has_radius = true;
    let check = loop {
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
                has_radius = false;
            }
            Err(error) => return Err(reason(error)),
            Ok(check) => break check,
        }
    };
    let report = check.report;
    let mut warnings: Vec<String> = check.differences.iter().map(ToString::to_string).collect();
    if let Some(pair) = report
        .worst_conflicts
        .first()
        .filter(|_| has_equal(&report))
    {
        warnings.push(format!(
            "samples {} and {} are the same point: it is measured without cells",
            pair.first, pair.second
        ));
    }
    if has_radius && report.more_conflicts() {
        warnings.push(format!(
            "conflicts were counted up to {MAX_CONFLICTS}; there may be more"
        ));
    }
    Ok(CheckedSet {
        format: check.detection.format,
        region: report.region,
        has_radius,
        warnings,
        report,
        points: check.set.points,
    })
}

/// Returns why a file was not verified. Numbers are written with exponents: those beyond the limits may have hundreds of digits.
fn reason(error: CheckError) -> anyhow::Error {
    match error {
        CheckError::Verify(error @ VerifyError::OutOfRegion { .. }) => {
            anyhow::anyhow!("{error}; --width, --height and --boundary state another domain")
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

/// Returns whether two samples are the same point.
fn has_equal(report: &Report) -> bool {
    report.min_distance <= 0.0
}
