//! The power of a set in space by shells of frequency. A shell has some 4 pi k² frequencies, and a set of 10^5 samples some
//! 10^7 that one wants: a transform of all of them would need a grid for each. So the sums are made one by one, for all
//! frequencies of the inner shells and for a drawn part of the others.

use std::collections::HashSet;
use std::f64::consts::TAU;
use std::ops::Range;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::measures::check_range;
use crate::monitor::{Control, Monitor};

use super::SolidError;
use super::error::check_points;
use super::region::SolidRegion;

/// Shells with up to as many pairs of opposite frequencies are summed whole: in a cube those up to 8 cycles along its side.
const WHOLE: f64 = 420.0;

/// As many frequencies are drawn in a shell, unless that takes too long: the mean of their powers has an error of 6%.
const MOST_DRAWN: usize = 256;

/// As many are drawn of the largest sets: an error of 18% in each of some thousand shells.
const FEWEST_DRAWN: usize = 32;

/// Draws go down to the fewest where all would take more sums of one sample and one frequency than that: some 20 seconds
/// of one core.
const WORK: f64 = 2e10;

/// As many places are drawn for one frequency at most. In a flat box nearly all round to frequencies of other shells.
const TRIES: usize = 64;

/// The most cycles along a side: tables of waves have a row for each.
const MOST_CYCLES: f64 = 65_536.0;

/// Values of waves in a table that stays within the second-level cache, as far as the number of cycles allows.
const TABLE: usize = 1 << 17;

/// A shell of frequencies.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidShell {
    /// The mean magnitude of its frequencies, in [`SolidSpectrum::unit`].
    pub nu: f64,
    /// How many frequencies were summed. Of two opposite ones, which have one power, one is counted.
    pub count: usize,
    /// The mean of their powers: 1 for independent uniform samples.
    pub power: f64,
    /// The standard error of the mean. Powers of a periodic set scatter about as much as they are large.
    pub standard_error: f64,
    /// The variance of the powers over the square of their mean, in decibels: 0 without a preferred direction, up to chance.
    /// NaN of one frequency.
    #[serde(with = "crate::report::finite_or_null")]
    pub anisotropy_db: f64,
}

/// The power of a set in space by shells of frequency.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidSpectrum {
    /// How many samples the set has.
    pub samples: usize,
    /// The unit of frequencies: the cube root of samples to the volume, in cycles to a unit of length.
    pub unit: f64,
    /// The shells, as wide as a cycle along the shortest side, from that of the lowest frequency on.
    pub shells: Vec<SolidShell>,
}

impl SolidSpectrum {
    /// The largest frequency that is usual, in [`Self::unit`].
    pub const USUAL: f64 = 2.5;

    /// Returns the powers at frequencies up to `most`, in the unit of the spectrum.
    ///
    /// The power at a frequency `k` is `|sum w e^(-2 pi i k x)|² / sum w²`, with whole numbers of cycles along the sides. In a
    /// periodic region all weights `w` are 1. In a bounded one they are the product of `1 - cos(2 pi x / side)` over the axes
    /// (Hann's taper), since a set that ends suddenly has power at all frequencies along the axes; frequencies of at most one
    /// cycle along each side, at which the taper has power of its own, are left out.
    ///
    /// Inner shells have all of their frequencies, others 256 that are drawn by their number, and fewer, down to 32, if
    /// that would take more than 2 x 10^10 sums. The result does not depend on the number of threads.
    ///
    /// ```
    /// use std::ops::ControlFlow;
    /// use tilescope_analysis::{Boundary, SolidRegion, SolidSpectrum};
    ///
    /// // A cubic lattice of 8 x 8 x 8 samples is silent below 8 cycles along its side.
    /// let axis = |i: i32, step: i32| f64::from(i / step % 8);
    /// let points: Vec<[f64; 3]> = (0..512).map(|i| [axis(i, 1), axis(i, 8), axis(i, 64)]).collect();
    /// let region = SolidRegion { width: 8.0, height: 8.0, depth: 8.0, boundary: Boundary::Periodic };
    /// let spectrum = SolidSpectrum::of(&points, region, 1.0, &|_| ControlFlow::Continue(()))?;
    /// assert!(spectrum.shells[..7].iter().all(|shell| shell.power < 1e-20));
    /// assert!(spectrum.shells[7].power > 1.0);
    /// # Ok::<(), tilescope_analysis::SolidError>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`SolidError::Measure`] if one side is more than 65,536 times another, or `most` is not between a cycle along the
    /// shortest side and 65,536 cycles along the longest; points and regions that cannot be judged are refused as by
    /// [`verify_solid`](crate::verify_solid).
    pub fn of(
        points: &[[f64; 3]],
        region: SolidRegion,
        most: f64,
        control: Control<'_>,
    ) -> Result<Self, SolidError> {
        let unit = checked_unit(points, region, most)?;
        let last = (most * unit * region.shortest()).floor() as usize;
        let affordable = (WORK / (points.len() as f64 * last as f64)) as usize;
        let draws = affordable.clamp(FEWEST_DRAWN, MOST_DRAWN);
        let shells = (1..=last).map(|number| Shell { region, number });
        let chosen: Vec<Vec<Frequency>> = shells.map(|shell| shell.frequencies(draws)).collect();

        let all = chosen.concat();
        let monitor = Monitor::begin(control, points.len() as u64)?;
        let of_all = powers(points, region, &all, &monitor)?;

        let mut rest = &of_all[..];
        let of_shell = |frequencies: &Vec<Frequency>| {
            let (own, others) = rest.split_at(frequencies.len());
            rest = others;
            shell(frequencies, own, region, unit)
        };
        Ok(Self {
            samples: points.len(),
            unit,
            // A flat bounded box may have no frequency in its first shell.
            shells: chosen.iter().filter_map(of_shell).collect(),
        })
    }
}

/// Returns the unit of frequencies of a set, as [`SolidSpectrum::unit`], if frequencies up to `most` of it can be measured.
pub(super) fn checked_unit(
    points: &[[f64; 3]],
    region: SolidRegion,
    most: f64,
) -> Result<f64, SolidError> {
    check_points(points, region)?;
    let unit = (points.len() as f64 / region.volume()).cbrt();
    // The first shell has frequencies of about one cycle along the shortest side. Along the longest side they have
    // up to `ratio` cycles, for which the tables of waves must have rows.
    let ratio = region.longest() / region.shortest();
    check_range("the ratio of two sides", ratio, [1.0, MOST_CYCLES])?;
    let limits = [1.0 / region.shortest(), MOST_CYCLES / region.longest()];
    check_range(
        "the largest frequency",
        most,
        limits.map(|limit| limit / unit),
    )?;
    Ok(unit)
}

/// Cycles along the three sides.
type Frequency = [i64; 3];

/// The frequencies between two magnitudes that are a cycle along the shortest side apart.
struct Shell {
    region: SolidRegion,
    /// The middle between the two, in cycles along the shortest side.
    number: usize,
}

impl Shell {
    /// Returns the magnitude of a frequency in cycles along the shortest side.
    fn magnitude(&self, frequency: Frequency) -> f64 {
        magnitude(frequency, self.region) * self.region.shortest()
    }

    /// Returns the magnitudes that it has.
    fn range(&self) -> Range<f64> {
        let middle = self.number as f64;
        middle - 0.5..middle + 0.5
    }

    /// Whether a frequency is one of the shell. Of two opposite ones only one is, since they have one power.
    fn has(&self, frequency: Frequency) -> bool {
        let [x, y, z] = frequency;
        let is_first_of_two = (z, y, x) > (0, 0, 0);
        // The taper of bounded regions has power there.
        let is_of_taper =
            !self.region.is_periodic() && frequency.iter().all(|&cycles| cycles.abs() <= 1);
        is_first_of_two && !is_of_taper && self.range().contains(&self.magnitude(frequency))
    }

    /// Returns all frequencies of a shell that has few, and at most `draws` drawn ones of any other.
    fn frequencies(&self, draws: usize) -> Vec<Frequency> {
        let Range { start, end } = self.range();
        let size = self.region.size();
        let shortest = self.region.shortest();
        // Frequencies are a cycle along each side apart: their number is about the volume of the shell in such cells.
        // Of two opposite ones one is counted, so that half of the shell is enough.
        let half_shell = 2.0 / 3.0 * std::f64::consts::PI * (end.powi(3) - start.powi(3));
        let about = half_shell * self.region.volume() / shortest.powi(3);
        if about > WHOLE {
            return self.drawn(draws);
        }

        // Of two opposite frequencies `has` takes one that has 0 or more cycles along z.
        let [x, y, z] = size.map(|side| (end * side / shortest).floor() as i64);
        let rows = (0..=z).flat_map(|z| (-y..=y).map(move |y| [y, z]));
        let all = rows.flat_map(|[y, z]| (-x..=x).map(move |x| [x, y, z]));
        all.filter(|&frequency| self.has(frequency)).collect()
    }

    /// Draws frequencies of the shell, each once: the same ones for a shell of one number in regions of one shape.
    fn drawn(&self, draws: usize) -> Vec<Frequency> {
        let Range { start, end } = self.range();
        let size = self.region.size();
        let shortest = self.region.shortest();
        let mut random = Random(self.number as u64);
        let (mut found, mut known) = (Vec::with_capacity(draws), HashSet::new());

        for _ in 0..TRIES * draws {
            if found.len() == draws {
                break;
            }
            // A place is drawn evenly in the upper half of the shell, and rounded to the nearest frequency.
            let cubed = start.powi(3) + random.unit() * (end.powi(3) - start.powi(3));
            let (height, turn) = (random.unit(), TAU * random.unit());
            let across = (1.0 - height * height).sqrt();
            let direction = [across * turn.cos(), across * turn.sin(), height];
            let [x, y, z] = [0, 1, 2].map(|axis| {
                let cycles = cubed.cbrt() * direction[axis] * size[axis] / shortest;
                cycles.round() as i64
            });
            // Places have a z from 0 on: of the cell of a frequency with z = 0 they reach the upper half alone. The lower
            // half mirrors the upper half of the opposite frequency's cell, whose places count for this frequency, too.
            let frequency = if (z, y, x) < (0, 0, 0) {
                [-x, -y, -z]
            } else {
                [x, y, z]
            };
            if self.has(frequency) && known.insert(frequency) {
                found.push(frequency);
            }
        }
        found
    }
}

/// A sequence of drawn numbers (Steele et al. 2014, `SplitMix64`).
pub(super) struct Random(pub u64);

impl Random {
    /// Returns the next number, from 0 to below 1.
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut word = self.0;
        word = (word ^ (word >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        word = (word ^ (word >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (word ^ (word >> 31)) as f64 / 2_f64.powi(64)
    }
}

/// Returns the magnitude of a frequency in cycles to a unit of length.
fn magnitude(frequency: Frequency, region: SolidRegion) -> f64 {
    let size = region.size();
    let squares = [0, 1, 2].map(|axis| (frequency[axis] as f64 / size[axis]).powi(2));
    squares.iter().sum::<f64>().sqrt()
}

/// Returns what a shell has: the mean of its powers and how they scatter. Nothing without a frequency.
fn shell(
    frequencies: &[Frequency],
    powers: &[f64],
    region: SolidRegion,
    unit: f64,
) -> Option<SolidShell> {
    let count = powers.len() as f64;
    let magnitudes = frequencies
        .iter()
        .map(|&frequency| magnitude(frequency, region));
    let power = powers.iter().sum::<f64>() / count;
    let squares: f64 = powers.iter().map(|one| (one - power).powi(2)).sum();
    let variance = squares / (count - 1.0);

    (!powers.is_empty()).then(|| SolidShell {
        nu: magnitudes.sum::<f64>() / count / unit,
        count: powers.len(),
        power,
        // A single power does not show how powers scatter. They mostly follow an exponential law, whose standard
        // deviation is its mean: so the power itself stands for the error.
        standard_error: if powers.len() > 1 {
            (variance / count).sqrt()
        } else {
            power
        },
        anisotropy_db: 10.0 * (variance / (power * power)).log10(),
    })
}

/// Returns the power at each frequency.
fn powers(
    points: &[[f64; 3]],
    region: SolidRegion,
    frequencies: &[Frequency],
    monitor: &Monitor<'_>,
) -> Result<Vec<f64>, SolidError> {
    let most = |axis: usize| {
        let cycles = frequencies
            .iter()
            .map(|frequency| frequency[axis].unsigned_abs());
        // Without frequencies tables have the row of 0 cycles alone.
        cycles.max().unwrap_or(0) as usize
    };
    let rows = [0, 1, 2].map(|axis| most(axis) + 1);
    let table: usize = rows.iter().sum();
    // At least as many samples as a processor computes at once, however large the tables are. With more than a
    // thousand, tables of small sets would no longer be shorter than the set. Both limits are chosen, not measured.
    let at_once = (TABLE / table).clamp(16, 1024);

    let mut sums = vec![[0.0; 2]; frequencies.len()];
    let mut weights = 0.0;
    for some in points.chunks(at_once) {
        let waves: Vec<Waves> = (0..3)
            .into_par_iter()
            .map(|axis| Waves::of(some, region, axis, rows[axis]))
            .collect();
        let weighed: Vec<f64> = some.iter().map(|&point| weight(point, region)).collect();
        weights += weighed.iter().map(|weight| weight * weight).sum::<f64>();

        // Each sum takes the samples in their order, on whichever thread. The 64 sums that a thread takes at least are
        // chosen, not measured.
        sums.par_iter_mut()
            .zip(frequencies)
            .with_min_len(64)
            .for_each(|(sum, &frequency)| add(sum, &waves, &weighed, frequency));
        monitor.advance(some.len() as u64)?;
    }

    let power = |[re, im]: &[f64; 2]| (re * re + im * im) / weights;
    Ok(sums.iter().map(power).collect())
}

/// Returns the weight of a sample.
fn weight(point: [f64; 3], region: SolidRegion) -> f64 {
    if region.is_periodic() {
        return 1.0;
    }
    let size = region.size();
    let tapers = [0, 1, 2].map(|axis| 1.0 - (TAU * point[axis] / size[axis]).cos());
    tapers.iter().product()
}

/// The waves of 0, 1, 2, ... cycles along one axis at some samples.
struct Waves {
    samples: usize,
    /// The real parts: the samples of no cycle, of one cycle, and so on.
    re: Vec<f64>,
    im: Vec<f64>,
}

impl Waves {
    fn of(points: &[[f64; 3]], region: SolidRegion, axis: usize, rows: usize) -> Self {
        let samples = points.len();
        let (mut re, mut im) = (vec![1.0; rows * samples], vec![0.0; rows * samples]);
        for (sample, point) in points.iter().enumerate() {
            let turns = point[axis] / region.size()[axis];
            for row in 1..rows {
                // Whole turns go first, so that the phase of a high frequency keeps its digits.
                let (sin, cos) = (-TAU * (turns * row as f64).fract()).sin_cos();
                (re[row * samples + sample], im[row * samples + sample]) = (cos, sin);
            }
        }
        Self { samples, re, im }
    }

    /// Returns the wave of some cycles, and the sign of its imaginary part.
    fn row(&self, cycles: i64) -> ([&[f64]; 2], f64) {
        let first = cycles.unsigned_abs() as usize * self.samples;
        let range = first..first + self.samples;
        let sign = if cycles < 0 { -1.0 } else { 1.0 };
        ([&self.re[range.clone()], &self.im[range]], sign)
    }
}

/// Adds some samples to the sum of a frequency.
fn add(sum: &mut [f64; 2], waves: &[Waves], weights: &[f64], frequency: Frequency) {
    let [x, y, z] = [0, 1, 2].map(|axis| waves[axis].row(frequency[axis]));
    let mut total = [0.0; 2];
    for (sample, weight) in weights.iter().enumerate() {
        let at = |([re, im], sign): ([&[f64]; 2], f64)| [re[sample], sign * im[sample]];
        let [re, im] = product(product(at(x), at(y)), at(z));
        total[0] += weight * re;
        total[1] += weight * im;
    }
    *sum = [sum[0] + total[0], sum[1] + total[1]];
}

/// Returns the product of two complex numbers.
const fn product([a, b]: [f64; 2], [c, d]: [f64; 2]) -> [f64; 2] {
    [a * c - b * d, a * d + b * c]
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::region::Boundary;

    fn region(size: [f64; 3], boundary: Boundary) -> SolidRegion {
        let [width, height, depth] = size;
        SolidRegion {
            width,
            height,
            depth,
            boundary,
        }
    }

    fn noise(count: usize, size: [f64; 3]) -> Vec<[f64; 3]> {
        let mut random = Random(2017);
        let point = |_| size.map(|side| side * random.unit());
        (0..count).map(point).collect()
    }

    fn of(points: &[[f64; 3]], region: SolidRegion, most: f64) -> SolidSpectrum {
        SolidSpectrum::of(points, region, most, &|_| ControlFlow::Continue(())).unwrap()
    }

    /// The powers of a shell by their formula, over all frequencies of a cube around it.
    fn by_formula(points: &[[f64; 3]], region: SolidRegion, number: usize) -> Vec<f64> {
        let shell = Shell { region, number };
        let weights = || points.iter().map(|&point| weight(point, region));
        let squares: f64 = weights().map(|weight| weight * weight).sum();
        let power = |frequency: Frequency| {
            let [mut re, mut im] = [0.0; 2];
            for (point, weight) in points.iter().zip(weights()) {
                let turns =
                    (0..3).map(|axis| frequency[axis] as f64 * point[axis] / region.size()[axis]);
                let phase = -TAU * turns.sum::<f64>();
                re += weight * phase.cos();
                im += weight * phase.sin();
            }
            (re * re + im * im) / squares
        };
        let all = (0..31_i64.pow(3)).map(|i| [i % 31 - 15, i / 31 % 31 - 15, i / 961 - 15]);
        all.filter(|&one| shell.has(one)).map(power).collect()
    }

    #[test]
    fn powers_are_those_of_the_formula() {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            let region = region([3.0, 4.0, 5.0], boundary);
            let points = noise(70, region.size());
            let spectrum = of(&points, region, 2.0);
            for (index, found) in spectrum.shells[..3].iter().enumerate() {
                let expected = by_formula(&points, region, index + 1);
                let mean = expected.iter().sum::<f64>() / expected.len() as f64;
                assert_eq!(found.count, expected.len());
                assert!((found.power - mean).abs() < 1e-9, "{found:?} {mean}");
            }
        }
    }

    #[test]
    fn drawn_frequencies_have_the_mean_of_all() {
        let region = region([1.0; 3], Boundary::Periodic);
        let points = noise(300, region.size());
        let spectrum = of(&points, region, 1.7);
        let shell = spectrum.shells[10];
        assert_eq!(shell.count, MOST_DRAWN);
        let all = by_formula(&points, region, 11);
        let mean = all.iter().sum::<f64>() / all.len() as f64;
        assert!(
            (shell.power - mean).abs() < 4.0 * shell.standard_error,
            "{shell:?} {mean}"
        );
        // The control: the bound is narrow enough to exclude twice the mean.
        assert!((shell.power - 2.0 * mean).abs() > 4.0 * shell.standard_error);
    }

    /// In a flat box a large part of a shell has no cycles along the short side.
    #[test]
    fn frequencies_are_drawn_alike() {
        let region = region([20.0, 20.0, 1.0], Boundary::Periodic);
        let shell = Shell { region, number: 1 };
        let flat = |all: &[Frequency]| {
            let level = all.iter().filter(|[_, _, z]| *z == 0).count();
            level as f64 / all.len() as f64
        };
        let cube = (0..61_i64.pow(2)).map(|i| [i % 61 - 30, i / 61 - 30]);
        let whole: Vec<Frequency> = cube
            .flat_map(|[x, y]| (0..=1).map(move |z| [x, y, z]))
            .filter(|&one| shell.has(one))
            .collect();
        let (drawn, all) = (flat(&shell.drawn(MOST_DRAWN)), flat(&whole));
        // Four standard errors of a share of 256.
        assert!(all > 0.3 && (drawn - all).abs() < 0.125, "{drawn} {all}");
    }

    #[test]
    fn noise_has_the_power_1_in_all_directions() {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            let region = region([2.0, 3.0, 2.0], boundary);
            let spectrum = of(&noise(2_000, region.size()), region, 1.5);
            let many = spectrum.shells.iter().filter(|shell| shell.count > 50);
            for shell in many {
                assert!(
                    (shell.power - 1.0).abs() < 5.0 * shell.standard_error,
                    "{shell:?}"
                );
                assert!(shell.anisotropy_db.abs() < 4.0, "{shell:?}");
            }
        }
    }

    #[test]
    fn what_cannot_be_measured_is_refused_with_its_limit() {
        let region = region([1.0; 3], Boundary::Periodic);
        let points = noise(8, region.size());
        let refused = |most| {
            let found = SolidSpectrum::of(&points, region, most, &|_| ControlFlow::Continue(()));
            found.unwrap_err().to_string()
        };
        assert!(refused(0.4).starts_with("the largest frequency is 0.4, which is not between 0.5"));
        assert!(refused(f64::NAN).contains("NaN"));
        let long = self::region([1e6, 1.0, 1.0], Boundary::Periodic);
        let found = SolidSpectrum::of(&points, long, 1.0, &|_| ControlFlow::Continue(()));
        let text = found.unwrap_err().to_string();
        assert!(
            text.starts_with("the ratio of two sides is 1000000"),
            "{text}"
        );
        let cancelled = SolidSpectrum::of(&points, region, 1.0, &|_| ControlFlow::Break(()));
        assert_eq!(cancelled, Err(SolidError::Cancelled));
    }
}
