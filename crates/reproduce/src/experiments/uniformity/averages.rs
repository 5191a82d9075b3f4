//! Mean curves of many sets of each way: g(r), radial mean power and anisotropy, held against those of reference sets. A curve of
//! one set scatters by more than the bias at seams adds; that of K sets by a root of K less. Begin with [`averages`].

use std::ops::Range;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use tilescope_analysis::measures::{
    Average, DifferenceCurve, MeanCurve, MeanPeriodogram, PairCorrelation, Periodogram,
    RadialProfile, Spectrum, Summary,
};
use tilescope_core::Parameters;

use super::LEAF;
use crate::control::Control;
use crate::error::{ReproduceError, Result};
use crate::experiments::common::{seeded, square};
use crate::sets::{Set, exact_of};
use crate::study::{Settings, Study};

/// Sets that are measured at a time: their periodograms take the memory.
const AT_ONCE: usize = 20;
/// Sets of a unit of work: an interrupted run loses at most these. Their periodogram, which is kept, takes 5 MB.
const PORTION: usize = 250;
/// Bins of g(r) to an r, as [`PairCorrelation::in_units_of`] has them.
const BINS: f64 = 40.0;

/// A way to make sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum AveragedWay {
    /// By the reference sampler.
    Reference,
    /// By the reference sampler with other seeds: differs by chance alone.
    Again,
    /// By KDRT, each set from a pattern of its own.
    Kdrt,
    /// By exact tiling, each set from a pattern of its own.
    Exact,
}

impl AveragedWay {
    pub const ALL: [Self; 4] = [Self::Reference, Self::Again, Self::Kdrt, Self::Exact];

    /// Returns its name in tables and charts, and in the names of files.
    pub const fn words(self) -> [&'static str; 2] {
        match self {
            Self::Reference => ["reference sampler", "reference"],
            Self::Again => ["reference, other seeds", "again"],
            Self::Kdrt => ["KDRT", "kdrt"],
            Self::Exact => ["exact tiling", "exact"],
        }
    }
}

/// How many sets of which size are averaged.
#[derive(Clone, Copy, Debug)]
pub struct AveragePlan {
    pub sets: usize,
    /// Samples of a set, about.
    pub samples: f64,
    /// The side in r of the patterns of exact tiling.
    pub pattern: f64,
}

impl AveragePlan {
    /// Blocks share a pattern, so that the mean over sets of N samples from patterns of k varies as if there were k / N times as
    /// many sets at most: patterns hold several times what a set does.
    pub fn of(settings: &Settings) -> Self {
        let (sets, samples, pattern) = settings.pick((100, 10_000.0, 400.0), (6, 3_000.0, 100.0));
        Self {
            sets: if settings.many { 20 * sets } else { sets },
            samples,
            pattern,
        }
    }

    /// Returns the indices of the sets of each unit of work.
    fn portions(self) -> impl Iterator<Item = Range<usize>> {
        let firsts = (0..self.sets).step_by(PORTION);
        firsts.map(move |first| first..self.sets.min(first + PORTION))
    }

    /// Returns how many units of work the sets of all ways are.
    pub fn units(self) -> usize {
        AveragedWay::ALL.len() * self.portions().count()
    }
}

/// The mean curves of the sets of one way.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MeanCurves {
    pub way: AveragedWay,
    /// Samples of a set: mean, and its standard error.
    pub count: [f64; 2],
    pub powers: RadialProfile,
    /// How far the anisotropy lies above that of noise, in decibels.
    pub excess: f64,
    /// How far that of sets without preferred directions may be from zero, with probability 99 %.
    pub excess_reach: f64,
    /// Means of g(r) in bins of a fortieth of r, and their standard errors.
    pub pairs: [Vec<f64>; 2],
    pub sets: u64,
}

impl MeanCurves {
    /// Returns g(r) over r.
    fn pairs(&self) -> MeanCurve {
        let [means, errors] = self.pairs.clone();
        let middle = |bin: usize| (bin as f64 + 0.5) / BINS;
        MeanCurve {
            x: (0..means.len()).map(middle).collect(),
            y: means,
            errors: Some(errors),
            sets: self.sets,
        }
    }
}

/// Mean curves less those of the reference sets.
#[derive(Clone, Debug)]
pub struct AgainstReference {
    pub way: AveragedWay,
    pub sets: u64,
    /// The difference of the density, as a share of the reference's, and its standard error.
    pub density: [f64; 2],
    pub powers: DifferenceCurve,
    pub pairs: DifferenceCurve,
    /// The anisotropy above that of the reference sets, in decibels, and what chance makes of it with probability 99 %.
    pub anisotropy: [f64; 2],
}

impl AgainstReference {
    /// Returns the shares of annuli and of bins of g(r) outside the bands that hold 95 % of them by chance.
    pub fn outside(&self) -> [f64; 2] {
        [&self.powers, &self.pairs].map(|curve| curve.outside().unwrap_or(f64::NAN))
    }

    /// Compares the means of one way with those of the reference sampler.
    fn of(one: &MeanCurves, reference: &MeanCurves) -> Result<Self> {
        let level = Spectrum::LEVEL;
        let [mean, base] = [one.count[0], reference.count[0]];
        // The two means are independent, so that the squares of their errors add up. Both counts are nearly alike: the
        // error of their quotient is that of their difference, in parts of the reference's count.
        Ok(Self {
            way: one.way,
            sets: one.sets,
            density: [
                mean / base - 1.0,
                one.count[1].hypot(reference.count[1]) / base,
            ],
            powers: DifferenceCurve::of_powers(&one.powers, &reference.powers, level)?,
            pairs: DifferenceCurve::of_means(&one.pairs(), &reference.pairs(), level)?,
            anisotropy: [
                one.excess - reference.excess,
                one.excess_reach.hypot(reference.excess_reach),
            ],
        })
    }
}

/// Makes and measures the sets of all ways, some sets a unit of work, and holds the others against the reference.
pub fn averages(study: &Study<'_>) -> Result<Vec<AgainstReference>> {
    let plan = AveragePlan::of(study.settings);
    let measured = AveragedWay::ALL.map(|way| {
        let [name, key] = way.words();
        let mut all: Option<AveragedSets> = None;

        for (number, sets) in (1..).zip(plan.portions()) {
            let what = format!(
                "mean curves of sets up to {} of {}, {name}",
                sets.end, plan.sets
            );
            let portion = study.unit(&format!("averages-{key}-{number}"), &what, |control| {
                measure(plan, way, sets, study.settings, control)
            })?;
            all = Some(match all {
                None => portion,
                Some(before) => before.joined(portion)?,
            });
        }
        all.ok_or_else(nothing)?.curves(way)
    });

    let each: Vec<MeanCurves> = measured.into_iter().collect::<Result<_>>()?;
    // The reference is the first of all ways.
    let [reference, others @ ..] = &each[..] else {
        return Ok(Vec::new());
    };
    let against = others
        .iter()
        .map(|one| AgainstReference::of(one, reference));
    against.collect()
}

/// The measures of one set.
struct MeasuredOnce {
    count: usize,
    periodogram: Periodogram,
    pairs: Vec<f64>,
}

/// The error of a plan without sets.
fn nothing() -> ReproduceError {
    ReproduceError::Engine("there is no set to average".to_owned())
}

/// Sets of one way, averaged: what a unit of work keeps.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct AveragedSets {
    /// The samples of each set.
    counts: Vec<f64>,
    periodogram: Periodogram,
    pairs: Average,
}

impl AveragedSets {
    /// Returns the average of both.
    fn joined(mut self, mut other: Self) -> Result<Self> {
        self.counts.append(&mut other.counts);
        self.pairs.join(&other.pairs)?;

        let (own, others) = (&mut self.periodogram, &other.periodogram);
        let share = others.sets as f64 / (own.sets + others.sets) as f64;
        for (mean, power) in own.power.iter_mut().zip(&others.power) {
            *mean += share * (power - *mean);
        }
        own.samples += share * (others.samples - own.samples);
        own.sets += others.sets;
        Ok(self)
    }

    /// Returns the mean curves of these sets, which were made in one way.
    fn curves(self, way: AveragedWay) -> Result<MeanCurves> {
        let powers = Spectrum::of(&self.periodogram)?.profile;
        let sets = self.counts.len() as f64;
        let counts = Summary::of(self.counts).ok_or_else(nothing)?;
        Ok(MeanCurves {
            way,
            count: [counts.mean, counts.deviation / sets.sqrt()],
            excess: powers.anisotropy_excess_db(),
            excess_reach: powers.anisotropy_excess_reach_db(),
            powers,
            // Plans have several sets, so that there always are standard errors.
            pairs: [
                self.pairs.means().to_vec(),
                self.pairs.standard_errors().unwrap_or_default(),
            ],
            sets: self.pairs.sets(),
        })
    }
}

/// Makes and measures sets of a way, given by their indices.
fn measure(
    plan: AveragePlan,
    way: AveragedWay,
    sets: Range<usize>,
    settings: &Settings,
    control: &Control<'_>,
) -> Result<AveragedSets> {
    let mut periodograms = MeanPeriodogram::default();
    let mut pairs: Option<Average> = None;
    let mut counts = Vec::new();

    for first in sets.clone().step_by(AT_ONCE) {
        // Sets are measured on all threads, but added in the sequence of their seeds: sums of floats depend on the order, and
        // must not depend on threads.
        let indices = (first..sets.end.min(first + AT_ONCE)).into_par_iter();
        let some = indices.map(|index| once(plan, way, settings.seed_of(index as u64), control));
        for one in some.collect::<Result<Vec<MeasuredOnce>>>()? {
            counts.push(one.count as f64);
            periodograms.add(one.periodogram)?;
            let mean = pairs.get_or_insert_with(|| Average::new(one.pairs.len()));
            mean.add(&one.pairs)?;
        }
    }

    let (periodogram, pairs) = periodograms.mean().zip(pairs).ok_or_else(nothing)?;
    Ok(AveragedSets {
        counts,
        periodogram,
        pairs,
    })
}

/// Makes, verifies and measures a set.
fn once(
    plan: AveragePlan,
    way: AveragedWay,
    seed: u64,
    control: &Control<'_>,
) -> Result<MeasuredOnce> {
    let base = seeded(square(plan.samples, LEAF), seed);
    let domain = base.validate()?;

    // Each kind of reference sets has a high bit of its own in its seeds, so that no set of another way has these
    // seeds. KDRT and exact tiling share their seeds, as each is compared with reference sets alone.
    let scratch = |high_bit: u32| Set::reference(domain, seed ^ (1 << high_bit), control);
    let set = match way {
        AveragedWay::Reference => scratch(40)?,
        AveragedWay::Again => scratch(41)?,
        AveragedWay::Kdrt => Set::kdrt(&base, control)?.0,
        AveragedWay::Exact => {
            let mut own: Parameters = base;
            own.pattern.side = plan.pattern;
            Set::of_run(&exact_of(&own, control)?)
        }
    };

    let [name, _] = way.words();
    set.verified(&format!("{name}, seed {seed}"), control)?;

    let (points, region, go_on) = (&set.points, set.region, control.analysis());
    // Periodograms can be averaged only if all have one window: that of the plan, not of the set's own number of samples.
    let window = Spectrum::window(plan.samples, region);
    Ok(MeasuredOnce {
        count: points.len(),
        periodogram: Periodogram::of(points, region, &window, &go_on)?,
        pairs: PairCorrelation::in_units_of(points, region, set.radius, &go_on)?.g,
    })
}

#[cfg(test)]
mod tests {
    use tilescope_analysis::Region;
    use tilescope_analysis::measures::FrequencyWindow;

    use super::*;

    /// Averages sets that have one power at all frequencies and one value of g(r), each the set's own.
    fn averaged(values: &[f64]) -> AveragedSets {
        let window = FrequencyWindow::centered(1);
        let mut periodograms = MeanPeriodogram::default();
        let mut pairs = Average::new(1);
        for value in values {
            let one = Periodogram {
                power: vec![*value; 9],
                window: window.clone(),
                region: Region::UNIT_SQUARE,
                samples: 100.0 * value,
                sets: 1,
            };
            periodograms.add(one).unwrap();
            pairs.add(&[*value]).unwrap();
        }
        AveragedSets {
            counts: values.to_vec(),
            periodogram: periodograms.mean().unwrap(),
            pairs,
        }
    }

    #[test]
    fn portions_hold_every_set_once_and_join_to_the_average_of_all() {
        let plan = AveragePlan {
            sets: 2 * PORTION + 7,
            ..AveragePlan::of(&Settings::default())
        };
        let sets: Vec<usize> = plan.portions().flatten().collect();
        assert_eq!(sets, (0..plan.sets).collect::<Vec<_>>());
        assert_eq!(plan.units(), 3 * AveragedWay::ALL.len());

        let values = [1.0, 2.0, 4.0, 7.0, 11.0];
        let [first, second] = [&values[..3], &values[3..]].map(averaged);
        let (joined, all) = (first.joined(second).unwrap(), averaged(&values));
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
        assert_eq!(joined.counts, values);
        assert_eq!(joined.periodogram.sets, 5);
        near(joined.periodogram.samples, all.periodogram.samples);
        near(joined.periodogram.power[3], 5.0);
        near(joined.pairs.means()[0], 5.0);
        let error = |one: &AveragedSets| one.pairs.standard_errors().unwrap()[0];
        near(error(&joined), error(&all));
    }
}
