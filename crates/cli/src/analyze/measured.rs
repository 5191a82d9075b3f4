//! One file, read, verified and measured: plain numbers and curves; its samples are gone.

use std::cell::Cell;
use std::ops::ControlFlow;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use tilescope_analysis::measures::{
    Discrepancy, FrequencyWindow, MeasureError, NearestDistances, Order, PairCorrelation,
    Periodogram, PowerCurve, Spectrum, largest_min_distance,
};
use tilescope_analysis::{MAX_CONFLICTS, Progress, Region, Report, VerifyError};
use tilescope_formats::{CheckError, Format, StreamReader};

use super::bins::Bins;
use super::scalars::{Found, Scalar, scalars};
use crate::options::{SetArguments, UNIT_SQUARE};
use crate::output;
use crate::progress::{measuring, verifying};

/// Numbers of samples that are averaged differ from the first set's by this part of it at most.
pub const SPREAD_OF_COUNTS: f64 = 0.1;

/// Frequencies that take more memory are looked at only when they are asked for: 2 GiB are those of 1.3 million samples.
const UNASKED_BYTES: u64 = 1 << 31;

/// What is known of a set beside its curves.
pub struct Member {
    /// The file as it was given.
    pub name: String,
    pub region: Region,
    /// As it was recognised.
    pub format: Format,
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
    /// The smooth spectrum that follows from g(r); none in too narrow a domain.
    pub curve: Option<PowerCurve>,
    /// Distance over `r_max`, and g(r).
    pub pairs: Vec<[f64; 2]>,
    pub periodogram: Periodogram,
    bins: Bins,
}

/// What all sets of an average share: decided by the first of them.
pub struct Common {
    name: String,
    region: Region,
    samples: usize,
    window: FrequencyWindow,
    bins: Bins,
}

/// How files are measured.
pub struct Request<'a> {
    arguments: &'a SetArguments,
    /// The largest frequency as nu, where it was given.
    nu: Option<f64>,
    /// The radius of all sets, where it is known and the same: their distances begin there, and are cut there.
    radius: Option<f64>,
    /// The `r_max` of the first set of one radius, the unit of all their distances.
    unit: Cell<Option<f64>>,
}

/// A set that was read, and what the verifier says of it.
struct Read {
    points: Vec<[f64; 2]>,
    format: Format,
    region: Region,
    radius: f64,
    /// The radius is known; otherwise one stands for it that keeps searches quick.
    certain: bool,
    report: Report,
    /// What is to be told of it.
    warnings: Vec<String>,
}

type Control<'a> = &'a (dyn Fn(Progress) -> ControlFlow<()> + Sync);

impl<'a> Request<'a> {
    /// Returns how all of `paths` are measured.
    pub fn new(arguments: &'a SetArguments, nu: Option<f64>, paths: &[&Path]) -> Self {
        let radii = paths
            .iter()
            .filter_map(|path| stated_radius(path, arguments).ok());
        let radii: Option<Vec<f64>> = radii.collect();
        let first = radii.as_ref().and_then(|radii| radii.first().copied());
        let same = |first: &f64| {
            let near = |radius: &f64| (radius / first - 1.0).abs() <= 1e-9;
            radii.iter().flatten().all(near)
        };
        Self {
            arguments,
            nu,
            radius: first.filter(same),
            unit: Cell::new(None),
        }
    }

    /// Reads, verifies and measures a file.
    pub fn measured(&self, path: &Path, common: Option<&Common>) -> Result<Measured> {
        let name = path.display().to_string();
        let measured = || -> Result<Measured> {
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
            let bins = Bins::of(self.radius, samples, region);
            let shared = common.map_or((window, bins), |common| {
                (common.window.clone(), common.bins)
            });
            let mut found = measuring(|control| of(&name, &set, shared, control))?;
            if self.radius.is_some() {
                let own = largest_min_distance(samples, region.area());
                let unit = self.unit.get().unwrap_or(own);
                self.unit.set(Some(unit));
                for place in &mut found.pairs {
                    place[0] *= own / unit;
                }
            }
            Ok(found)
        };
        measured().context(name.clone())
    }

    fn window(&self, samples: f64, region: Region) -> Result<FrequencyWindow, MeasureError> {
        if let Some(nu) = self.nu {
            return Spectrum::window_to(nu, samples, region);
        }
        let wide = Spectrum::window_to(Spectrum::MAX_NU, samples, region);
        let bytes = wide.as_ref().ok().and_then(|wide| wide.bytes().ok());
        match wide {
            Ok(wide) if bytes.is_some_and(|bytes| bytes <= UNASKED_BYTES) => Ok(wide),
            _ => Ok(Spectrum::window(samples, region)),
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
            bins: first.bins,
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

fn of(
    name: &str,
    set: &Read,
    (window, bins): (FrequencyWindow, Bins),
    control: Control<'_>,
) -> Result<Measured, MeasureError> {
    let (points, region, samples) = (&set.points, set.region, set.points.len());
    let distances = NearestDistances::of(points, region, control)?;
    let min_distance = distances.summary.least;
    let radius = if set.certain {
        set.radius
    } else {
        min_distance
    };
    let discrepancy = discrepancy(points, region, control)?;
    let periodogram = Periodogram::of(points, region, &window, control)?;
    let spectrum = Spectrum::of(&periodogram)?;
    let most = bins.farthest(samples, region);
    let pairs = PairCorrelation::of(points, region, most, bins.count(), control)?;
    let curve = PowerCurve::of_samples(points, region, control)?;
    let report = &set.report;
    let order = if has_equal(report) {
        None
    } else {
        Some(Order::of(points, region, control)?)
    };
    let judged = set.certain.then_some(report);
    let found = Found {
        samples,
        radius,
        density: (radius > 0.0).then(|| samples as f64 * radius.powi(2) / region.area()),
        min_distance,
        covering_radius: report.covering_radius,
        conflicts: judged.map(|report| report.conflicts),
        gaps: judged.map(|report| report.gaps),
        relative: [
            distances.relative_radius(),
            distances.mean_relative_distance(),
        ],
        curve: curve.as_ref(),
        order: order.as_ref(),
        discrepancy,
    };
    Ok(Measured {
        member: Member {
            name: name.to_owned(),
            region,
            format: set.format,
            samples,
            certain: set.certain,
            valid: judged.map(Report::valid),
            scalars: scalars(&found),
        },
        spectrum,
        curve,
        pairs: pairs.places(),
        periodogram,
        bins,
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

/// Returns the radius that the arguments, a file or its certificate state, if any does. Fails for a file that cannot be read.
fn stated_radius(path: &Path, arguments: &SetArguments) -> Result<Option<f64>> {
    if arguments.radius.is_some() {
        return Ok(arguments.radius);
    }
    let certificate = match StreamReader::open(path, arguments.format) {
        Ok(reader) => reader.certificate().cloned(),
        // Not all formats are read in pieces.
        Err(_) => arguments.read(path)?.certificate,
    };
    Ok(certificate.map(|stated| stated.radius))
}

/// Reads and verifies a file; without a radius its spacing stands for one, and nothing is certain.
fn read(path: &Path, arguments: &SetArguments) -> Result<Read> {
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
            Err(error) => return Err(reason(error)),
            Ok(found) => {
                let mut warnings: Vec<String> =
                    found.differences.iter().map(ToString::to_string).collect();
                if let Some(pair) = found.report.worst_conflicts.first()
                    && has_equal(&found.report)
                {
                    warnings.push(format!(
                        "samples {} and {} are the same point: it is measured without cells",
                        pair.first, pair.second
                    ));
                }
                if certain && found.report.more_conflicts() {
                    warnings.push(format!(
                        "conflicts were counted up to {MAX_CONFLICTS}; there may be more"
                    ));
                }
                return Ok(Read {
                    format: found.detection.format,
                    region: found.report.region,
                    radius: found.report.radius,
                    certain,
                    warnings,
                    report: found.report,
                    points: found.set.points,
                });
            }
        }
    }
}

/// Says why a file was not verified: no verdict was asked for, and numbers beyond all limits have hundreds of digits.
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

/// Whether two samples are the same point.
fn has_equal(report: &Report) -> bool {
    report.min_distance <= 0.0
}
