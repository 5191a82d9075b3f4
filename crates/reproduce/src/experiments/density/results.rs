//! The density, its error, and what the lattice leaves out, from the counts. Begin with [`DensityResults::of`].

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use tilescope_analysis::measures::student_quantile;

use super::coarse::CoarseSets;
use super::line::FittedLine;
use super::torus::{LEVELS, TorusSets};
use crate::error::{ReproduceError, Result};
use crate::experiments::common::MISSED;
use crate::outcome::Verdict;

/// The published coverage by disks of diameter r, 0.547 073 5 (Zhang and Torquato 2013), as N r^2 / area: a disk covers
/// pi / 4 of a squared diameter.
pub const PUBLISHED: f64 = 0.547_073_5 * 4.0 / PI;
/// Its standard error: 2.8e-6 of coverage.
pub const PUBLISHED_ERROR: f64 = 2.8e-6 * 4.0 / PI;
/// By what share the radius of a control is off. The published error is a fortieth of what this does to the density.
pub const OFF: f64 = 1e-4;
/// The last level of the control that stops too early. Levels behind it insert three samples in ten thousand.
pub const UNFINISHED: usize = 10;
/// The levels by which the later ones are predicted. On coarser ones gaps are not small beside disks: among 46 million samples a
/// line through levels 5 to 11 fits no longer (chi-square 14.6 of five degrees of freedom; from level 6 on 1.9 of four). On finer
/// ones the lattice shows, whose units are a sixteenth of the cells of level 11; level 15 inserts a fifth more than half of
/// level 14.
const HALVING: RangeInclusive<usize> = 7..=11;

/// What the lattice leaves out of the density, by two estimates, each with its standard error.
#[derive(Clone, Copy, Debug)]
pub struct LatticeError {
    pub by_levels: [f64; 2],
    pub by_coarse: [f64; 2],
}

impl LatticeError {
    /// Returns by how much the estimate from coarse lattices is larger, and the standard error of that.
    pub fn difference(&self) -> [f64; 2] {
        let [one, other] = [self.by_levels, self.by_coarse];
        [other[0] - one[0], one[1].hypot(other[1])]
    }

    /// Returns the estimate that is used, which is that by levels, and its error. The difference from the other one counts as an
    /// error, too, as assumptions of the two estimates may cause it.
    pub fn used(&self) -> [f64; 2] {
        let [value, error] = self.by_levels;
        [value, error.hypot(self.difference()[0])]
    }
}

/// What a run found.
#[derive(Clone, Debug)]
pub struct DensityResults {
    pub batches: Vec<TorusSets>,
    /// All batches together.
    pub all: TorusSets,
    pub small: Vec<TorusSets>,
    pub coarse: Vec<CoarseSets>,
    pub lattice: LatticeError,
}

impl DensityResults {
    /// Returns the results of batches, of sets on small tori and of sets on coarse lattices. Fails without a batch.
    pub fn of(batches: &[TorusSets], small: &[TorusSets], coarse: Vec<CoarseSets>) -> Result<Self> {
        let joined = batches.iter().cloned().reduce(|a, b| a.joined(&b));
        let none = || ReproduceError::Engine("there is no set to count".to_owned());
        let all = joined.ok_or_else(none)?;
        let lattice = LatticeError {
            by_levels: left_out_by_levels(&all),
            by_coarse: left_out_by_coarse(&coarse),
        };
        Ok(Self {
            batches: batches.to_vec(),
            all,
            small: small.to_vec(),
            coarse,
            lattice,
        })
    }

    /// Returns the density that was counted and what the lattice leaves out together, with the error of this sum.
    pub fn density(&self) -> [f64; 2] {
        let [[density, error], [left_out, doubt]] = [self.all.density(), self.lattice.used()];
        [density + left_out, error.hypot(doubt)]
    }

    /// Returns how far a density is from the published one, and the interval that holds the truth with probability 99 % by the
    /// errors of both.
    pub fn beside_published(&self, density: f64) -> (f64, [f64; 2]) {
        let error = self.density()[1].hypot(PUBLISHED_ERROR);
        let reach = student_quantile(MISSED, f64::INFINITY) * error;
        let difference = density - PUBLISHED;
        (difference, [difference - reach, difference + reach])
    }

    /// Returns whether a density is the published one, within the errors.
    pub fn agrees(&self, density: f64) -> bool {
        let (_, [low, high]) = self.beside_published(density);
        (low..=high).contains(&0.0)
    }

    /// Returns the densities that these sets would have if the radius were off by [`OFF`], to either side, or if they had
    /// been stopped after level [`UNFINISHED`].
    pub fn controls(&self) -> [f64; 3] {
        let [density, _] = self.density();
        let late: u64 = self.all.by_level[UNFINISHED + 1..].iter().sum();
        let [left_out, _] = self.lattice.used();
        [
            density * (1.0 - OFF).powi(2),
            density * (1.0 + OFF).powi(2),
            density - late as f64 / self.all.area() - left_out,
        ]
    }

    /// Returns how many of the controls the rule refuses: those that are farther from the density found than the interval
    /// reaches.
    pub fn refused(&self) -> usize {
        let [density, _] = self.density();
        let (_, [low, high]) = self.beside_published(density);
        let reach = 0.5 * (high - low);
        let controls = self.controls().into_iter();
        controls.filter(|one| (one - density).abs() > reach).count()
    }

    /// Returns the verdict on the published density. A control that is not refused says that there are too few sets.
    pub fn verdict(&self) -> Verdict {
        let all_refused = self.refused() == self.controls().len();
        Verdict::if_known(all_refused, self.agrees(self.density()[0]))
    }
}

/// Returns the line of what levels insert to an area, times 2^level, over 2^-level.
///
/// Small gaps of all sizes are equally many, so that levels halve: the line is level where gaps are small beside disks, and
/// its slope is the first correction for gaps that are not.
pub fn halving(sets: &TorusSets) -> FittedLine {
    let place = |level: usize| {
        let count = sets.by_level[level] as f64;
        // Small gaps are filled far from each other, so that their number is nearly that of independent events. Without any, the
        // error is that of one.
        let error = count.max(1.0).sqrt();
        let half = 0.5_f64.powi(level as i32);
        (half, [count, error].map(|count| count / half / sets.area()))
    };
    FittedLine::through(HALVING.map(place))
}

/// Returns what the lattice leaves out, by what its levels insert, and the standard error.
///
/// Without a lattice, levels would go on along the line, and all that follow level l would insert a 2^-l + b 4^-l / 3 together.
/// The levels of the lattice that follow [`HALVING`] are the last, and insert less than that.
fn left_out_by_levels(sets: &TorusSets) -> [f64; 2] {
    let last = *HALVING.end();
    let scale = 0.5_f64.powi(last as i32);
    let [expected, error] = halving(sets).combined([scale, scale * scale / 3.0]);

    let inserted: u64 = sets.by_level[last + 1..].iter().sum();
    let area = sets.area();
    let [late, late_error] = [inserted as f64, (inserted as f64).sqrt()].map(|count| count / area);
    [expected - late, error.hypot(late_error)]
}

/// Returns what a lattice leaves out of the density, times the units to r: for each coarse lattice, with the standard error.
pub fn coarse_losses(coarse: &[CoarseSets]) -> Vec<[f64; 2]> {
    let loss = |one: &CoarseSets| {
        let [density, error] = one.density();
        [PUBLISHED - density, error].map(|share| share * f64::from(one.radius))
    };
    coarse.iter().map(loss).collect()
}

/// Returns what the lattice leaves out, by coarse lattices, and the standard error.
///
/// What a lattice leaves out is in proportion to its spacing s, with terms of higher order on coarse ones: loss / s = a + b s.
/// Losses count from the published density: were that off by 10^-5, a would change by a thousandth of itself.
fn left_out_by_coarse(coarse: &[CoarseSets]) -> [f64; 2] {
    let spacings = coarse.iter().map(|one| f64::from(one.radius).recip());
    let line = FittedLine::through(spacings.zip(coarse_losses(coarse)));
    line.combined([0.5_f64.powi(LEVELS as i32 - 1), 0.0])
}
