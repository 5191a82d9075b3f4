//! A subject of the analysis: a set, or the average of several, with a column in the tables and a curve in the charts.
//! An average takes its sets one after another and keeps only their numbers.

use std::sync::Arc;

use tilescope_analysis::Region;
use tilescope_analysis::measures::{
    Average, DifferenceCurve, MeanCurve, MeanPeriodogram, MeasureError, PowerCurve, Spectrum,
};

use super::curve::Curve;
use super::measure::{Measure, of_mean_power};
use super::measured::{Common, Measurement, Member};

/// A column of the tables.
pub struct Subject {
    /// Its name in CSV and JSON: the path of the file as the command line has it.
    pub name: String,
    /// Its name in notes and differences: short and unique.
    pub label: String,
    /// Its heading in tables and charts: the label, marked if it is the reference.
    pub title: String,
    pub region: Region,
    /// Whether it is the average of `members`; otherwise it is its one member.
    pub average: bool,
    pub members: Vec<Member>,
    pub measures: Vec<Measure>,
    pub spectrum: Spectrum,
    /// Radial mean power, anisotropy and pair correlation, by their names in CSV and JSON.
    pub curves: [(&'static str, Curve); 3],
    /// Radial mean powers, with errors from the spread between sets.
    powers: MeanCurve,
    /// The pair correlation, with errors of the same kind.
    correlations: MeanCurve,
}

impl Subject {
    /// Returns the column of one set.
    pub fn one(set: Measurement) -> Result<Option<Self>, MeasureError> {
        let mut alone = Population::default();
        alone.add(set)?;
        let average = false;
        alone.finish(average)
    }

    /// Number of sets behind it.
    pub fn sets(&self) -> u64 {
        self.spectrum.profile.sets
    }

    /// Returns how its radial mean power and its pair correlation differ from a reference's.
    pub fn minus(&self, reference: &Self) -> Result<[DifferenceCurve; 2], MeasureError> {
        // A spectrum has bands of its own only if its powers are independent. Those of bounded sets, which are tapered,
        // are not, and their differences are judged by the spread between sets.
        let independent = self.spectrum.bands.is_some() && reference.spectrum.bands.is_some();
        let level = Spectrum::LEVEL;
        let power = if independent {
            let [own, base] = [self, reference].map(|subject| &subject.spectrum.profile);
            DifferenceCurve::of_powers(own, base, level)?
        } else {
            DifferenceCurve::of_means(&self.powers, &reference.powers, level)?
        };
        let pairs = DifferenceCurve::of_means(&self.correlations, &reference.correlations, level)?;
        Ok([power, pairs])
    }
}

/// An average to which sets are added one by one, or a single set.
#[derive(Default)]
pub struct Population {
    /// The settings of the first set, which all others share.
    pub common: Option<Common>,
    members: Vec<Member>,
    distances: Vec<f64>,
    periodograms: MeanPeriodogram,
    /// The spectrum of the first set. It is that of the mean, too, as long as no second set was added.
    first: Option<Arc<Spectrum>>,
    powers: Option<Average>,
    correlations: Option<Average>,
    smooth: Option<SmoothMean>,
    /// Whether a set has no smooth spectrum, so that there is no mean of them.
    lacks_smooth: bool,
}

/// The mean of smooth spectra.
struct SmoothMean {
    /// Those of the first set, which all others share.
    frequencies: Vec<f64>,
    powers: Average,
}

impl Population {
    /// Adds a set. The first one gives [`Self::common`], with which all others must have been measured.
    pub fn add(&mut self, set: Measurement) -> Result<(), MeasureError> {
        if self.common.is_none() {
            self.common = Some(Common::of(&set));
            self.distances = set.pairs.iter().map(|point| point[0]).collect();
        }
        // The mean of smooth spectra means something only if every set has one.
        match &set.curve {
            Some(curve) if !self.lacks_smooth => {
                let powers = curve.powers();
                let empty = || SmoothMean {
                    frequencies: curve.frequencies().to_vec(),
                    powers: Average::new(powers.len()),
                };
                self.smooth.get_or_insert_with(empty).powers.add(powers)?;
            }
            _ => self.lacks_smooth = true,
        }

        self.periodograms.add(set.periodogram)?;
        self.first.get_or_insert(set.spectrum);
        let powers = (self.powers).get_or_insert_with(|| Average::new(set.powers.len()));
        powers.add(&set.powers)?;

        // All sets are measured at the distances of the first, which were kept above.
        let correlation: Vec<f64> = set.pairs.iter().map(|point| point[1]).collect();
        let correlations =
            (self.correlations).get_or_insert_with(|| Average::new(correlation.len()));
        correlations.add(&correlation)?;
        self.members.push(set.member);
        Ok(())
    }

    /// Returns the column of the average, or of its only set; `None` without a set. With `average` the column is that
    /// of an average, even of one set: it is named so, and has the measures of the mean power.
    pub fn finish(self, average: bool) -> Result<Option<Subject>, MeasureError> {
        let (Some(mean), Some(powers), Some(correlations)) =
            (self.periodograms.mean(), self.powers, self.correlations)
        else {
            return Ok(None);
        };

        let of_only_set = self.first.filter(|_| mean.sets == 1);
        let spectrum =
            of_only_set.map_or_else(|| Spectrum::of(&mean), |own| Ok(Arc::unwrap_or_clone(own)))?;
        let mut measures = means(&self.members)?;
        let mut name = self.members[0].name.clone();
        if average {
            // The mean of valid curves at the same frequencies is a valid curve, so that `ok` hides no error.
            let of_mean = |smooth: SmoothMean| {
                PowerCurve::new(smooth.frequencies, smooth.powers.means().to_vec()).ok()
            };
            let smooth = (self.smooth.filter(|_| !self.lacks_smooth)).and_then(of_mean);
            measures.extend(of_mean_power(smooth.as_ref()));

            // An average was asked for, so that it is called one even if only one of the sets could be used.
            let sets = self.members.len();
            let plural = if sets == 1 { "" } else { "s" };
            name = format!("average of {sets} set{plural}");
        }

        // The law that gives bands by the number of frequencies does not hold for tapered sets: theirs come from the
        // spread.
        let bands = spectrum.bands.clone().or(powers.band(Spectrum::LEVEL)?);
        let distances = self.distances.iter().copied();
        let pairs = (distances.zip(correlations.means().iter().copied()))
            .map(<[f64; 2]>::from)
            .collect();

        let curves = [
            ("power", Curve::new(spectrum.power(), bands)),
            // The bands of the power do not fit this curve: it leaves out the annuli that have no anisotropy.
            ("anisotropy_db", Curve::new(spectrum.anisotropy(), None)),
            (
                "pair_correlation",
                Curve::new(pairs, correlations.band(Spectrum::LEVEL)?),
            ),
        ];

        // Label and title depend on the names of the other subjects.
        Ok(Some(Subject {
            name,
            label: String::new(),
            title: String::new(),
            region: mean.region,
            average,
            measures,
            powers: mean_curve(&powers, spectrum.profile.relative_frequencies()),
            correlations: mean_curve(&correlations, self.distances),
            curves,
            members: self.members,
            spectrum,
        }))
    }
}

fn mean_curve(average: &Average, x: Vec<f64>) -> MeanCurve {
    MeanCurve {
        x,
        y: average.means().to_vec(),
        errors: average.standard_errors(),
        sets: average.sets(),
    }
}

/// Returns the mean of each measure over the sets in which it is defined.
fn means(members: &[Member]) -> Result<Vec<Measure>, MeasureError> {
    let rows = members.first().map_or(0, |first| first.measures.len());
    let row = |row| {
        let of: Vec<&Measure> = members.iter().map(|one| &one.measures[row]).collect();
        Measure::mean(&of)
    };
    (0..rows).map(row).collect()
}
