//! The measures of one set in space.

use std::path::Path;

use anyhow::{Result, ensure};
use tilescope_analysis::{
    JudgeChoice, PlanePower, SolidCorrelation, SolidError, SolidRegion, SolidShell, SolidSpectrum,
    SolidVerdict, VerifyOptions, disks_in_planes, measure_solid,
};

use crate::analyze::measure::{Form, Measure};
use crate::options::SetArguments;
use crate::paths::InFile;
use crate::progress::watched;
use crate::solid::box_text;
use crate::solid::check::{ReadSet, read};

/// Width of a bin of the pair correlation, in radii.
const BIN: f64 = 0.05;

/// The longest distance of the pair correlation, in radii: there it is 1 to within a hundredth.
const REACH: f64 = 4.0;

/// Planes across each axis on which disks are counted. In a periodic box their mean is twice the density but for chance.
const PLANES: usize = 16;

/// Frequencies below which power is said to be low, and from which on anisotropy counts, in cycles to a radius, as of
/// planar sets.
const LOW: f64 = 0.3;

/// Anisotropies of fewer frequencies scatter by decibels, and are not compared.
const FEW: usize = 50;

/// Numbers of samples that differ by a larger share have no common average: their frequencies differ, too.
const ALIKE: f64 = 0.1;

/// A set with its measures.
pub struct Measured {
    pub name: String,
    pub region: SolidRegion,
    /// Whether the radius was given or stated, and not measured.
    pub has_radius: bool,
    pub numbers: Vec<Measure>,
    /// The largest frequency, in cycles to a unit of length.
    most: f64,
    pub spectrum: SolidSpectrum,
    /// The power without a cycle along x, along y, and along z.
    pub planes: [PlanePower; 3],
    correlation: SolidCorrelation,
}

/// The choices that hold for all sets.
pub struct Request<'a> {
    pub set: &'a SetArguments,
    /// The largest frequency as nu, if one is given.
    pub most: Option<f64>,
}

impl Request<'_> {
    /// Measures the set of a file, with the frequencies and distances of a first one if they are to be averaged.
    pub fn measure(&self, path: &Path, first: Option<&Measured>) -> Result<Measured> {
        let given = read(path, self.set)?;
        if let Some(first) = first {
            check_alike(&given, first).in_file(path)?;
        }
        self.measure_read(path, &given, first).in_file(path)
    }

    /// Measures a set that was read. Its errors do not name the file, which [`Self::measure`] adds.
    fn measure_read(
        &self,
        path: &Path,
        given: &ReadSet,
        first: Option<&Measured>,
    ) -> Result<Measured> {
        let (points, region, radius) = (&given.points[..], given.region, given.radius);
        let shortest = region.size().into_iter().fold(f64::INFINITY, f64::min);

        // Sets are averaged at the frequencies and the distances of the first set. `most` and `bin` are therefore in
        // units of length, as nu and the radius differ from set to set. In this set nu is 1 at the frequency `unit`.
        let unit = (points.len() as f64 / region.volume()).cbrt();
        let usual = || self.most.unwrap_or(SolidSpectrum::USUAL) * unit;
        let most = first.map_or_else(usual, |first| first.most);
        let bin = first.map_or(BIN * radius, |first| first.correlation.bin_width);
        // A hair less than half the side, since rounding may lift a whole number of bins above it.
        let reach = (REACH * radius).min(0.499 * shortest);
        let bins = first.map_or((reach / bin) as usize, |first| first.correlation.g.len());
        // The radius may be so long for its box that no bin fits. The error then names the distance of one bin, which is
        // too long.
        let bins = bins.max(1);

        let spectrum = watched("spectrum", |control| {
            SolidSpectrum::of(points, region, most / unit, control)
        })
        .map_err(|error| match error {
            // Of what a spectrum is asked for, only a frequency that is given may be out of range.
            SolidError::Measure(_) if self.most.is_some() => {
                anyhow::Error::from(error).context("--frequencies")
            }
            other => other.into(),
        })?;
        // What a spectrum by shells can be asked for, planes can be, too.
        let planes = watched("planes", |control| {
            PlanePower::of(points, region, most / unit, control)
        })?;
        let correlation = watched("pairs", |control| {
            SolidCorrelation::of(points, region, bin * bins as f64, bins, control)
        })?;
        // A set that judges refuse, as one of a box too small for its radius, has measures all the same.
        let judged = watched("verify", |control| {
            let options = VerifyOptions {
                // One judge is enough, as numbers are measured here and nothing is certified.
                judges: JudgeChoice::Subdivision,
                ..VerifyOptions::default()
            };
            let is_prefix = false;
            measure_solid(points, region, radius, is_prefix, &options, control)
        });
        let verdict = match judged {
            Err(SolidError::Period { .. } | SolidError::BadRadius { .. }) => None,
            other => Some(other?),
        };
        Ok(Measured {
            name: path.display().to_string(),
            region,
            has_radius: given.has_radius,
            numbers: numbers(given, verdict.as_ref(), &spectrum, &correlation),
            most,
            spectrum,
            planes,
            correlation,
        })
    }
}

/// Refuses a set that cannot be averaged with another.
fn check_alike(given: &ReadSet, first: &Measured) -> Result<()> {
    ensure!(
        given.region == first.region,
        "its domain, {}, is not that of {}, {}",
        box_text(&given.region),
        first.name,
        box_text(&first.region)
    );
    let (own, others) = (given.points.len(), first.spectrum.samples);
    ensure!(
        own.abs_diff(others) as f64 <= ALIKE * others as f64,
        "its {own} samples differ by more than 10 % from the {others} of {}",
        first.name
    );
    Ok(())
}

/// Returns the numbers of a set, under the keys that planar sets have.
fn numbers(
    given: &ReadSet,
    verdict: Option<&SolidVerdict>,
    spectrum: &SolidSpectrum,
    correlation: &SolidCorrelation,
) -> Vec<Measure> {
    let mut all = numbers_of_set(given, verdict);
    all.extend(numbers_of_curves(given.radius, spectrum, correlation));
    all
}

/// Returns the numbers of a set that are known without its spectrum. A set without a verdict lacks those of it.
fn numbers_of_set(given: &ReadSet, verdict: Option<&SolidVerdict>) -> Vec<Measure> {
    let radius = given.radius;
    let count = given.points.len() as f64;
    let density = count * radius.powi(3) / given.region.volume();
    // In the densest packing there are the root of 2 samples to a cubed radius.
    let packing = density / 2_f64.sqrt();

    let report = verdict.map(|verdict| &verdict.report);
    let closest = report.map(|own| own.min_distance / radius);
    let farthest = verdict.map(|own| own.covering_radius / radius);
    let conflicts = report.map(|own| own.conflicts as f64);
    let gaps = report.map(|own| own.gaps as f64);
    let relative = verdict.map(SolidVerdict::relative_radius);
    let of_planes = disks_in_planes(&given.points, given.region, radius, PLANES);
    let disks = of_planes.map(|all| all.mean);

    // Six decimals show the tolerance of lengths, about 2^-15 r. The other numbers of decimals are chosen, not
    // measured.
    vec![
        number("samples", "samples N", "", 0, Some(count)),
        number("radius", "radius r", "user units", 8, Some(radius)),
        number("density", "density", "N r\u{b3} / volume", 4, Some(density)),
        number("packing", "packing", "of close packing", 4, Some(packing)),
        number("disks", "disks in a plane", "per r\u{b2}", 4, disks),
        number("min_distance_r", "smallest distance", "r", 6, closest),
        number("covering_radius_r", "covering radius", "r", 6, farthest),
        number("conflicts", "conflicts", "pairs", 0, conflicts),
        number("gaps", "gaps", "places", 0, gaps),
        number("relative_radius", "relative radius", "r_max", 4, relative),
    ]
}

/// Returns the numbers that are read from the spectrum and from the pair correlation.
fn numbers_of_curves(
    radius: f64,
    spectrum: &SolidSpectrum,
    correlation: &SolidCorrelation,
) -> Vec<Measure> {
    // In cycles to a radius.
    let frequency = |shell: &SolidShell| shell.nu * spectrum.unit * radius;
    let (low, high): (Vec<SolidShell>, Vec<SolidShell>) = spectrum
        .shells
        .iter()
        .partition(|shell| frequency(shell) < LOW);

    // Of a small set no shell is so low, and it has no such number.
    let count: usize = low.iter().map(|shell| shell.count).sum();
    let sum: f64 = low
        .iter()
        .map(|shell| shell.count as f64 * shell.power)
        .sum();
    let low_power = (count > 0).then(|| sum / count as f64);

    let shells = spectrum.shells.iter();
    let highest = shells.max_by(|a, b| a.power.total_cmp(&b.power));
    let many = high.iter().filter(|shell| shell.count >= FEW);
    let anisotropy = many.map(|shell| shell.anisotropy_db).max_by(f64::total_cmp);
    let largest = correlation.g.iter().copied().max_by(f64::total_cmp);

    vec![
        number(
            "peak",
            "frequency of most power",
            "1/r",
            3,
            highest.map(frequency),
        ),
        number(
            "peak_power",
            "most power",
            "",
            3,
            highest.map(|shell| shell.power),
        ),
        number("low_power", "power below 0.3 / r", "", 4, low_power),
        number("anisotropy", "largest anisotropy", "dB", 2, anisotropy),
        number("peak_correlation", "largest g(r)", "", 2, largest),
    ]
}

fn number(
    key: &str,
    label: &str,
    unit: &'static str,
    decimals: usize,
    value: Option<f64>,
) -> Measure {
    let form = Form { unit, decimals };
    Measure::new(key.to_owned(), label.to_owned(), form, value)
}

impl Measured {
    /// Returns three curves: the power and the anisotropy of each shell over its frequency, and g(r) over the distance
    /// in radii.
    pub fn curves(&self) -> [Vec<[f64; 2]>; 3] {
        let shells = || self.spectrum.shells.iter();
        // A bin is `BIN` radii wide. If several sets are averaged, all have the bins of the first set, so that this
        // radius is that of the first set.
        let radius = self.correlation.bin_width / BIN;
        let middle = |bin: usize| (bin as f64 + 0.5) * self.correlation.bin_width / radius;
        [
            shells().map(|shell| [shell.nu, shell.power]).collect(),
            // A shell of one frequency has no anisotropy.
            shells()
                .filter(|shell| shell.anisotropy_db.is_finite())
                .map(|shell| [shell.nu, shell.anisotropy_db])
                .collect(),
            self.correlation
                .g
                .iter()
                .enumerate()
                .map(|(bin, g)| [middle(bin), *g])
                .collect(),
        ]
    }
}
