//! Mean curves of many sets of each way: g(r), radial mean power and anisotropy, held against those of reference sets. A curve of
//! one set scatters by more than the bias at seams adds; that of K sets by a root of K less. Begin with [`averages`].

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

/// Makes and measures the sets of all ways, a unit of work each, and holds the others against the reference.
pub fn averages(study: &Study<'_>) -> Result<Vec<AgainstReference>> {
    let plan = AveragePlan::of(study.settings);
    let measured = AveragedWay::ALL.map(|way| {
        let [name, key] = way.words();
        let what = format!("mean curves of {} sets, {name}", plan.sets);
        study.unit(&format!("averages-{key}"), &what, |control| {
            measure(plan, way, study.settings, control)
        })
    });

    let each: Vec<MeanCurves> = measured.into_iter().collect::<Result<_>>()?;
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

/// Makes and measures the sets of a way.
fn measure(
    plan: AveragePlan,
    way: AveragedWay,
    settings: &Settings,
    control: &Control<'_>,
) -> Result<MeanCurves> {
    let mut periodograms = MeanPeriodogram::default();
    let mut pairs: Option<Average> = None;
    let mut counts = Vec::new();

    for first in (0..plan.sets).step_by(AT_ONCE) {
        // Sets are measured on all threads, but added in the sequence of their seeds: sums of floats depend on the order, and
        // must not depend on threads.
        let seeds = (first..plan.sets.min(first + AT_ONCE)).into_par_iter();
        let some = seeds.map(|index| once(plan, way, settings.seed_of(index as u64), control));
        for one in some.collect::<Result<Vec<MeasuredOnce>>>()? {
            counts.push(one.count as f64);
            periodograms.add(one.periodogram)?;
            let mean = pairs.get_or_insert_with(|| Average::new(one.pairs.len()));
            mean.add(&one.pairs)?;
        }
    }

    let nothing = || ReproduceError::Engine("there is no set to average".to_owned());
    let (mean, pairs) = periodograms.mean().zip(pairs).ok_or_else(nothing)?;
    let powers = Spectrum::of(&mean)?.profile;
    let counts = Summary::of(counts).ok_or_else(nothing)?;

    Ok(MeanCurves {
        way,
        count: [counts.mean, counts.deviation / (plan.sets as f64).sqrt()],
        excess: powers.anisotropy_excess_db(),
        excess_reach: powers.anisotropy_excess_reach_db(),
        powers,
        // Plans have several sets, so that there always are standard errors.
        pairs: [
            pairs.means().to_vec(),
            pairs.standard_errors().unwrap_or_default(),
        ],
        sets: pairs.sets(),
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

    // A high bit sets the seeds of each kind of reference sets apart, from each other and from those of the tiled sets: no
    // two kinds share a draw.
    let scratch = |apart: u32| Set::reference(domain, seed ^ (1 << apart), control);
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
