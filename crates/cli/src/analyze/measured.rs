//! Reads, verifies and measures a file. Its numbers and curves are kept; its samples are not.

use std::cell::Cell;
use std::fmt::Display;
use std::path::Path;
use std::sync::Arc;

use anyhow::{Result, anyhow, bail, ensure};
use serde::{Serialize, Serializer};
use tilescope_analysis::measures::{
    FrequencyWindow, MeasureError, MeasuredSet, PairBins, PairCorrelation, Part, Periodogram,
    PowerCurve, Spectrum, largest_min_distance,
};
use tilescope_analysis::{Control, MAX_CONFLICTS, Region, VerifyError};
use tilescope_formats::{Check, CheckError, Format, PointSet, StreamReader};
use tilescope_sets::check_or_unit_square;

use super::measure::{Measure, of_set, values_by_key};
use crate::ground::GroundArguments;
use crate::options::{SetArguments, WITHOUT_CERTIFICATE, hinted};
use crate::output;
use crate::paths::{InFile, named};
use crate::progress::{verifying, watched};

/// Frequencies that take more memory than this are computed only with `--frequencies`: those of 1.3 million samples
/// take 2 GiB.
const MAX_UNASKED_BYTES: u64 = 1 << 31;

/// The facts about a set, without its curves.
#[derive(Clone, Serialize)]
pub struct Member {
    #[serde(flatten, serialize_with = "values_by_key")]
    pub measures: Vec<Measure>,
    /// The path of the file as the command line has it, and its set if it is one of several.
    #[serde(rename = "file")]
    pub name: String,
    pub region: Region,
    /// The format that was recognised by the file's name and its first lines.
    #[serde(serialize_with = "as_text")]
    pub format: Format,
    pub samples: usize,
    /// Whether the radius is known; otherwise it is the smallest distance.
    #[serde(rename = "radius_known")]
    pub has_radius: bool,
    /// The verdict, if the radius is known.
    pub valid: Option<bool>,
}

fn as_text<S: Serializer>(value: &impl Display, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_str(value)
}

/// A set and its curves, to be averaged with those of others.
pub struct Measurement {
    pub member: Member,
    /// The radial mean power.
    pub powers: Vec<f64>,
    /// The smooth spectrum that follows from g(r), unless the domain is too narrow.
    pub curve: Option<Arc<PowerCurve>>,
    /// Distance over `r_max`, and g(r).
    pub pairs: Vec<[f64; 2]>,
    pub periodogram: Periodogram,
    /// The shown parts of the periodogram.
    pub spectrum: Arc<Spectrum>,
    bins: PairBins,
}

/// The settings that all sets of an average share, taken from the first.
pub struct Common {
    first: Member,
    window: FrequencyWindow,
    bins: PairBins,
}

/// A set of a file.
#[derive(Clone, Copy)]
pub struct Source<'p> {
    pub path: &'p Path,
    /// Which set, if the file holds several and no argument chooses one.
    set: Option<usize>,
}

impl<'p> Source<'p> {
    /// Returns the only set of a file, or the one that the arguments choose.
    pub fn whole(path: &'p Path) -> Self {
        Self { path, set: None }
    }

    /// Returns the path as the command line has it, and the set if it is one of several.
    pub fn name(&self) -> String {
        let path = named(self.path);
        match self.set {
            Some(set) => format!("{path}, set {set}"),
            None => path,
        }
    }
}

/// How files are measured.
pub struct Request<'a> {
    arguments: &'a SetArguments,
    /// The field and the shape of sets whose certificates name their images, or that have none.
    ground: &'a GroundArguments,
    /// The largest frequency as nu, if the arguments give it.
    nu: Option<f64>,
    /// The radius of all sets, if it is known and the same; then the bins of distances begin there.
    radius: Option<f64>,
    /// The `r_max` of the first set, the unit of all distances, if all sets have one radius.
    unit: Cell<Option<f64>>,
}

impl<'a> Request<'a> {
    /// Returns how all of `paths` are measured. Files that cannot be read do not influence it.
    pub fn new(
        (arguments, ground): (&'a SetArguments, &'a GroundArguments),
        nu: Option<f64>,
        paths: &[&Path],
    ) -> Self {
        // Files that cannot be read are passed over here. One that can be read may still state no radius. Where a
        // radius varies, no two samples are nearer than the least one, so that bins may begin there.
        let readable = paths
            .iter()
            .filter_map(|path| arguments.certificate(path).ok());
        let stated: Option<Vec<f64>> = match arguments.least_radius() {
            Some(radius) => Some(vec![radius]),
            None => readable.map(|found| Some(found?.radius.least())).collect(),
        };

        // A single set of unknown radius leaves all without a common one.
        let radii = stated.unwrap_or_default();
        // Radii that differ by rounding alone count as the same.
        let is_same = |first: &f64| (radii.iter()).all(|r| (r / first - 1.0).abs() <= 1e-9);
        Self {
            arguments,
            ground,
            nu,
            radius: radii.first().copied().filter(is_same),
            unit: Cell::new(None),
        }
    }

    /// Returns the sets of a file that are measured: the one that the arguments choose, or all.
    pub fn sources<'p>(&self, path: &'p Path) -> Result<Vec<Source<'p>>> {
        Ok(match self.arguments.sets(path)? {
            1 => vec![Source::whole(path)],
            count => (0..count)
                .map(|set| Source {
                    path,
                    set: Some(set),
                })
                .collect(),
        })
    }

    /// Reads, verifies and measures a set.
    pub fn measure(&self, source: Source<'_>, common: Option<&Common>) -> Result<Measurement> {
        self.measured(source, common).in_file(source.path)
    }

    /// Reads, verifies and measures a set; with the window and the bins in `common` if it is a later one of an average.
    fn measured(&self, source: Source<'_>, common: Option<&Common>) -> Result<Measurement> {
        self.refuse_early(source.path)?;
        let VerifiedFile {
            set,
            check,
            has_radius,
        } = read(source, self.arguments, self.ground)?;
        let (samples, region) = (set.len(), check.report.region);
        // A set that cannot be averaged is refused before it is measured.
        if let Some(common) = common {
            common.admit(samples, region)?;
        }

        // A set by itself has its own frequencies and bins; in an average those of the first set are taken. Its own
        // window is asked for in any case: a number of frequencies that a set cannot have is refused.
        let bins = PairBins::of(self.radius, samples, region);
        let own = (self.window(samples as f64, region)?, bins);
        let shared = common.map(|common| (common.window.clone(), common.bins));
        let (window, bins) = shared.unwrap_or(own);

        let (points, report) = (&set.points, check.report);
        // The verdict for a radius that is not known means nothing.
        let valid = has_radius.then(|| report.valid());
        let radius = has_radius.then_some(report.radius);
        let measure = |control: Control<'_>| {
            // The report has the smallest distance, which need not be searched for again.
            let mut measures = MeasuredSet::new(samples, region, radius);
            measures.take_report(report.clone());
            // The spectrum comes last, as it takes the most memory, and by the window above, in place of the default
            // one.
            for part in Part::of_numbers().filter(|part| *part != Part::Spectrum) {
                measures.measure(part, points, control)?;
            }
            let periodogram = Periodogram::of(points, region, &window, control)?;
            let spectrum = Arc::new(Spectrum::of(&periodogram)?);
            let powers = spectrum.profile.powers();
            measures.take_spectrum(Arc::clone(&spectrum));

            let farthest = bins.farthest(samples, region);
            let pairs = PairCorrelation::of(points, region, farthest, bins.count(), control)?;
            let member = Member {
                name: source.name(),
                region,
                format: check.detection.format,
                samples,
                has_radius,
                valid,
                measures: of_set(&measures),
            };
            Ok::<_, MeasureError>(Measurement {
                member,
                powers,
                curve: measures.curve,
                pairs: pairs.points(),
                periodogram,
                spectrum,
                bins,
            })
        };

        let mut measured = watched("measure", measure)?;
        if self.radius.is_some() {
            self.put_in_one_unit(&mut measured);
        }
        Ok(measured)
    }

    /// Gives distances in the unit of the first set. The curves of sets of one radius jump at that radius: with the
    /// unit of each set, which follows from its number of samples, they would jump at different x.
    fn put_in_one_unit(&self, measured: &mut Measurement) {
        let Member {
            samples, region, ..
        } = measured.member;
        let own = largest_min_distance(samples, region.area());
        let unit = self.unit.get().unwrap_or(own);
        self.unit.set(Some(unit));
        for point in &mut measured.pairs {
            point[0] *= own / unit;
        }
    }

    fn window(&self, samples: f64, region: Region) -> Result<FrequencyWindow, MeasureError> {
        if let Some(nu) = self.nu {
            return Spectrum::window_to(nu, samples, region);
        }
        // Unasked, a large set gets a shorter spectrum rather than none.
        let wide = Spectrum::window_to(Spectrum::MAX_NU, samples, region).ok();
        let fits = |wide: &FrequencyWindow| wide.bytes().is_ok_and(|b| b <= MAX_UNASKED_BYTES);
        Ok((wide.filter(fits)).unwrap_or_else(|| Spectrum::window(samples, region)))
    }

    /// Refuses frequencies that take too much memory before the set is read, if the head of the file has its size and
    /// no argument changes the domain.
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
            self.window(count as f64, stated.unwrap_or(Region::UNIT_SQUARE))?;
        }
        Ok(())
    }
}

/// Refuses a domain that is not that of the set `name`.
pub fn check_domain(own: Region, name: &str, region: Region) -> Result<()> {
    let [text, other] = [own, region].map(|region| output::region_text(&region));
    ensure!(
        own == region,
        "its domain, {text}, is not that of {name}, {other}"
    );
    Ok(())
}

impl Common {
    /// Returns the settings of the first set of an average.
    pub fn of(first: &Measurement) -> Self {
        Self {
            first: first.member.clone(),
            window: first.periodogram.window.clone(),
            bins: first.bins,
        }
    }

    /// Refuses a set that cannot be averaged with the first.
    fn admit(&self, samples: usize, region: Region) -> Result<()> {
        let first = &self.first;
        check_domain(region, &first.name, first.region)?;
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

/// A set that was read and verified.
struct VerifiedFile {
    set: PointSet,
    check: Check,
    /// Whether its radius is known; if not, the report is for the mean spacing of the samples.
    has_radius: bool,
}

/// Reads and verifies a file, and prints warnings.
fn read(
    source: Source<'_>,
    arguments: &SetArguments,
    ground: &GroundArguments,
) -> Result<VerifiedFile> {
    let path = source.path;
    let mut overrides = arguments.overrides(path)?;
    overrides.set = source.set.or(overrides.set);
    let check_with =
        |overrides: &_| verifying(|control| tilescope_formats::check(path, overrides, control));
    if ground.is_given() {
        ground.judge_in(path, arguments, &mut overrides)?;
    }

    // A set without a stated domain is taken for one of the periodic unit square.
    let mut outcome = check_or_unit_square(&overrides, check_with);
    // As for `verify`: a field and a shape are made only for a set whose certificate states them.
    if let Err(CheckError::NoField) = outcome {
        ground.judge_in(path, arguments, &mut overrides)?;
        outcome = check_or_unit_square(&overrides, check_with);
    }
    let has_radius = !matches!(outcome, Err(CheckError::NoRadius));
    if !has_radius {
        // Read once more, as a check without a radius returns no points.
        let count = arguments.read(path, overrides.set)?.set.len();
        // The spacing below is meant for sets that can be measured, of three samples and more.
        if count < 3 {
            return Err(MeasureError::TooFew { count, limit: 3 }.into());
        }
        // The smallest distance and the covering radius do not depend on the radius; the spacing keeps the search quick.
        let region = overrides.region.unwrap_or(Region::UNIT_SQUARE);
        overrides.radius = Some((region.area() / count as f64).sqrt());
        outcome = check_or_unit_square(&overrides, check_with);
    }

    let (set, check) = outcome.map_err(reason)?;
    // A certificate that is not true may be that of other points, and such a set must not be averaged. Where only the
    // region, the radius or the shape differs, as the arguments replaced it, that is warned of below.
    if let Some(differs) = check.falsehood() {
        bail!("its certificate is not true: {differs}; {WITHOUT_CERTIFICATE}");
    }

    output::note_left_out(arguments, path);
    let (report, name) = (&check.report, source.name());
    let warn = |warning: &str| output::note(&format!("warning: {name}: {warning}"));
    for difference in &check.differences {
        warn(&difference.to_string());
    }
    if overrides.varying.is_some() {
        let note = "note: {name}: where the radius varies or there is a shape, numbers and curves are those of all places of \
                    the domain together, in the least radius";
        output::note(&note.replace("{name}", &name));
    }
    // Two samples at one place have no cells of their own.
    if let (true, Some(pair)) = (report.min_distance <= 0.0, report.worst_conflicts.first()) {
        let (first, second) = (pair.first, pair.second);
        let pair = format!("samples {first} and {second} are the same point");
        warn(&format!("{pair}: the set is measured without cells"));
    }
    // Of a radius that is not known conflicts are not shown.
    if has_radius && report.more_conflicts() {
        let counted = format!("conflicts were counted up to {MAX_CONFLICTS}");
        warn(&format!("{counted}; there may be more"));
    }

    Ok(VerifiedFile {
        set,
        check,
        has_radius,
    })
}

/// Returns why a file was not verified. Numbers are written with exponents: without, those beyond the limits may have
/// hundreds of digits.
fn reason(error: CheckError) -> anyhow::Error {
    match error {
        CheckError::Verify(VerifyError::BadRadius { radius }) => anyhow!(
            "the radius {radius:?} is not a positive number between 2^-100 and 2^100 times the domain's longer side"
        ),
        CheckError::Verify(VerifyError::BadRegion { width, height }) => anyhow!(
            "the domain {width:?} x {height:?} is not supported: sides must lie between 2^-100 and 2^100, one at most 2^40 times the other"
        ),
        other => hinted(other),
    }
}
