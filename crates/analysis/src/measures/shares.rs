//! The contribution of each sample to the power in a ring of frequencies: the sums of the periodogram, split by sample.
//! A transform gives the sums at the ring's frequencies, its adjoint their values at the samples.

use rayon::prelude::*;
use rustfft::num_complex::Complex;
use serde::Serialize;

use super::error::MeasureError;
use super::nufft::{MAX_FREQUENCY, TransformPlan};
use super::periodogram::{Taper, Weighed, unit_lengths};
use super::window::FrequencyWindow;
use super::{adjoint, check_range, check_set};
use crate::monitor::{Control, Monitor};
use crate::region::Region;

/// The power of a set in a ring of frequencies, as a sum over its samples.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrequencyShares {
    /// The ring: lengths of frequencies from the first up to below the second, as
    /// [`Periodogram::length`](super::Periodogram::length) has them.
    pub ring: [f64; 2],
    /// Number of frequencies in the ring, opposite ones counted apart; never the zero frequency.
    pub frequencies: u64,
    /// Mean of their powers, as [`Periodogram::of`](super::Periodogram::of) has them; 0 where there are none.
    pub mean_power: f64,
    /// The contribution of each sample, in the samples' order. They add up to `frequencies` times `mean_power`, and
    /// some may be negative: such samples lie where the waves of the others have their troughs.
    pub shares: Vec<f64>,
}

impl FrequencyShares {
    /// Samples whose part is below this have no relative share: there only the scatter of the other samples would show.
    pub const MIN_PART: f64 = 0.05;

    /// Returns the expected share of each sample if all were independent and uniform on the region, as a multiple of
    /// the mean: `N w^2 / sum w^2` with the weights of [`Periodogram::of`](super::Periodogram::of). It is 1 in periodic
    /// sets, and falls to 0 towards the border of bounded ones, whose taper it is.
    #[must_use]
    pub fn parts(points: &[[f64; 2]], region: Region) -> Vec<f64> {
        let set = Weighed::new(points, region, Taper::for_boundary(region.boundary));
        let unit = points.len() as f64 * set.scale;
        let samples = set.samples.iter();
        samples
            .map(|sample| unit * sample.weight * sample.weight)
            .collect()
    }

    /// Returns each sample's share over its expected share (see [`Self::parts`]): 1 on the average for independent
    /// uniform samples, wherever they lie, and the mean power if all contribute alike. NaN where the part is below
    /// [`Self::MIN_PART`], and where the ring has no frequency. `points` and `region` must be those that the shares are
    /// of.
    #[must_use]
    pub fn relative(&self, points: &[[f64; 2]], region: Region) -> Vec<f64> {
        let unit = self.frequencies as f64 / points.len() as f64;
        let parts = Self::parts(points, region).into_iter();
        (self.shares.iter().zip(parts))
            .map(|(share, part)| {
                if part < Self::MIN_PART || unit <= 0.0 {
                    f64::NAN
                } else {
                    share / (unit * part)
                }
            })
            .collect()
    }
}

/// Returns the contribution of each sample to the summed power of the integer frequencies `k` other than zero with
/// `ring[0] <= length(k) < ring[1]`, where `length` is that of [`Periodogram`](super::Periodogram): `|k|` on a square,
/// `nu sqrt(N)` in general.
///
/// Sample `j` contributes `w_j sum_k Re(conj(S(k)) (exp(-2 pi i k.x_j) - m(k))) / sum w^2`, with the weights `w`, the
/// coordinates and the sums `S(k) = sum_j w_j (exp(-2 pi i k.x_j) - m(k))` of
/// [`Periodogram::of`](super::Periodogram::of). `m(k)` is the mean density's part, which every sample
/// bears by its weight: the taper's transform at `k` over that at zero. It vanishes in periodic sets, and in
/// bounded ones everywhere but at the eight frequencies next to zero. So the shares add up to the power
/// and nothing is left over. Samples on the border of a bounded region weigh nothing and have a share of zero.
///
/// A share of independent uniform samples is `frequencies / N` on the average. By the kernel a share is wrong by at
/// most [`NUFFT_ERROR`](super::NUFFT_ERROR) times `w_j sum_k (|S(k)| + sum w) / sum w^2`, and mostly by the square root of
/// the number of frequencies less. The sum of the shares is the power of the
/// same transform but for rounding. The cost is twice that of a periodogram of all frequencies shorter than
/// `ring[1]`. The result does not depend on the number of threads.
///
/// # Errors
///
/// No sample or one outside the region; an inner length that is not between 0 and [`MAX_FREQUENCY`]; an outer one that
/// is not finite or does not exceed it ([`MeasureError::NotRising`]); a frequency beyond [`MAX_FREQUENCY`]; more
/// working memory than [`MAX_WINDOW_BYTES`](super::MAX_WINDOW_BYTES): of 4 GiB frequencies up to 6000 along both axes
/// fit, in two parts beyond 4200, and those shorter than `ring[0]` take memory, too ([`MeasureError::WindowTooLarge`]
/// names the part that does not fit). A ring without frequencies is no error.
pub fn frequency_shares(
    points: &[[f64; 2]],
    region: Region,
    ring: [f64; 2],
    control: Control<'_>,
) -> Result<FrequencyShares, MeasureError> {
    check_set(points, region, 1)?;
    let plans = plans_of(&window_of(region, ring)?)?;
    shares_by(&plans, points, region, ring, control)
}

/// Returns plans that together hold one of any two opposite frequencies of a window about zero, or both where a real
/// plan has `ky = 0`: one plan if memory suffices, otherwise those of two quarters of the window.
fn plans_of(window: &FrequencyWindow) -> Result<Vec<TransformPlan>, MeasureError> {
    match TransformPlan::new(window) {
        Err(MeasureError::WindowTooLarge { .. }) => {
            quarters(window).iter().map(TransformPlan::new).collect()
        }
        plan => plan.map(|plan| vec![plan]),
    }
}

/// Half of a window about zero: the quarter where no component is negative, and that where just `ky` is.
fn quarters(window: &FrequencyWindow) -> Vec<FrequencyWindow> {
    let (x, y) = (&window.x, &window.y);
    let quarters = [(0..x.end, 0..y.end), (1..x.end, y.start..0)];
    let windows = quarters.map(|(x, y)| FrequencyWindow { x, y });
    let filled = |window: &FrequencyWindow| window.columns() * window.rows() > 0;
    windows.into_iter().filter(filled).collect()
}

/// Returns the shares by the transforms of the plans of [`plans_of`].
fn shares_by(
    plans: &[TransformPlan],
    points: &[[f64; 2]],
    region: Region,
    ring: [f64; 2],
    control: Control<'_>,
) -> Result<FrequencyShares, MeasureError> {
    let work = |plan: &TransformPlan| plan.work(points.len()) + adjoint::work(plan, points.len());
    let monitor = Monitor::begin(control, plans.iter().map(work).sum())?;
    let set = Weighed::new(points, region, Taper::for_boundary(region.boundary));

    // The wave of the ring's frequencies at the place of each sample.
    let (mut sums, mut waves) = (RingSums::default(), vec![0.0; points.len()]);
    for plan in plans {
        let mut values = plan.run(&set.samples, &monitor)?.values;
        sums = sums.plus(restrict(&mut values, plan, &set, region, ring));
        let found = adjoint::at_samples(plan, values, &set.samples, &monitor)?;
        for (wave, value) in waves.iter_mut().zip(found) {
            *wave += value;
        }
    }

    // The power of the ring is a sum over the samples: of the wave at the place of each, less the part of the mean
    // density, times the sample's weight.
    let shares = (set.samples.iter().zip(waves))
        .map(|(sample, wave)| sample.weight * (wave - sums.mean_wave) * set.scale)
        .collect();
    // A ring without frequencies has a mean power of 0.
    let count = sums.frequencies.max(1) as f64;
    Ok(FrequencyShares {
        ring,
        frequencies: sums.frequencies,
        mean_power: sums.squares * set.scale / count,
        shares,
    })
}

/// Returns the rectangle about zero that holds all frequencies shorter than the ring's outer length.
fn window_of(region: Region, [inner, outer]: [f64; 2]) -> Result<FrequencyWindow, MeasureError> {
    let limit = MAX_FREQUENCY;
    check_range("the inner length of the ring", inner, [0.0, limit as f64])?;
    if !(outer.is_finite() && outer > inner) {
        return Err(MeasureError::NotRising {
            name: "the ring's lengths",
            index: 1,
            value: outer,
        });
    }
    // Rounding loses no frequency k of the ring. If the rounded `k * unit` is below `outer`, the exact one is, too.
    // Then the exact `outer / unit` exceeds k, and rounding does not take it below the whole number k.
    let [x, y] = unit_lengths(region).map(|unit| (outer / unit) as i64);
    if x.max(y) > limit {
        let frequency = x.max(y);
        return Err(MeasureError::FrequencyTooHigh { frequency, limit });
    }
    Ok(FrequencyWindow {
        x: -x..x + 1,
        y: -y..y + 1,
    })
}

/// Sums over the frequencies of a ring.
#[derive(Clone, Copy, Default)]
struct RingSums {
    frequencies: u64,
    /// The sum of `|S|^2`.
    squares: f64,
    /// The sum of `Re S m`.
    mean_wave: f64,
}

impl RingSums {
    fn plus(self, other: Self) -> Self {
        Self {
            frequencies: self.frequencies + other.frequencies,
            squares: self.squares + other.squares,
            mean_wave: self.mean_wave + other.mean_wave,
        }
    }
}

/// Makes a plan's transform the `S` of the ring's frequencies, and zero elsewhere. Returns the sums over the ring,
/// which count opposite frequencies apart. Where the transform holds one of two opposite frequencies, it is not
/// doubled: the adjoint adds the other one.
fn restrict(
    values: &mut [Complex<f64>],
    plan: &TransformPlan,
    set: &Weighed,
    region: Region,
    [inner, outer]: [f64; 2],
) -> RingSums {
    let ([x, y], [unit_x, unit_y]) = (plan.axes, unit_lengths(region));
    let rows = values.par_chunks_mut(x.count()).enumerate();

    let by_row: Vec<RingSums> = rows
        .map(|(row, values)| {
            let mut sums = RingSums::default();
            let ky = y.middle + plan.first_row() + row as i64;
            // A real plan has no rows below ky = 0, and its row ky = 0 holds both of any two opposite frequencies. Of
            // all other opposite frequencies just one is held, and counts twice.
            let times = if plan.real && ky == 0 { 1 } else { 2 };

            for (value, kx) in values.iter_mut().zip(x.middle - x.below..) {
                let length = (kx as f64 * unit_x).hypot(ky as f64 * unit_y);
                // Only frequencies of the ring count. The frequency zero is in no ring: its power depends on the number
                // of samples alone.
                if [kx, ky] == [0, 0] || !(inner..outer).contains(&length) {
                    *value = Complex::default();
                    continue;
                }

                *value = set.sum([kx, ky], *value);
                sums.frequencies += times;
                sums.squares += times as f64 * value.norm_sqr();
                sums.mean_wave += times as f64 * value.re * set.mean_factor([kx, ky]);
            }
            sums
        })
        .collect();
    // Rows are added in their order, so that rounding does not depend on threads.
    by_row.into_iter().fold(RingSums::default(), RingSums::plus)
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::monitor::Progress;
    use crate::region::Boundary;

    fn scattered(region: Region) -> Vec<[f64; 2]> {
        let places = (0..500).map(|i| [0.754_877, 0.569_84].map(|step| f64::from(i * i) * step));
        let inside = places.map(|place| place.map(|x| x - x.floor()));
        inside
            .map(|[x, y]| [x * region.width, y * region.height])
            .collect()
    }

    /// Large windows are taken in quarters: small ones come out the same either way.
    #[test]
    fn two_quarters_are_the_whole() {
        let go_on = |_: Progress| ControlFlow::Continue(());
        let shapes = [Boundary::Periodic, Boundary::Bounded]
            .into_iter()
            .flat_map(|boundary| [(1.0, 1.0, boundary), (5.0, 3.0, boundary)]);
        for ((width, height, boundary), inner) in
            shapes.flat_map(|shape| [(shape, 0.0), (shape, 50.0)])
        {
            let region = Region {
                width,
                height,
                boundary,
            };
            let (points, ring) = (scattered(region), [inner, 60.0]);
            let window = window_of(region, ring).expect("a window");
            let plans: Result<Vec<_>, _> =
                quarters(&window).iter().map(TransformPlan::new).collect();
            let plans = plans.expect("plans");
            assert!(plans.len() == 2 && plans.iter().all(|plan| !plan.real));
            let by = |plans: &[TransformPlan]| {
                shares_by(plans, &points, region, ring, &go_on).expect("shares")
            };
            let found = by(&plans);
            let whole = by(&plans_of(&window).expect("one plan fits"));
            assert_eq!(found.frequencies, whole.frequencies);
            assert!((found.mean_power / whole.mean_power - 1.0).abs() < 1e-9);
            let most = |values: &mut dyn Iterator<Item = f64>| {
                values.fold(0.0_f64, |most, value| most.max(value.abs()))
            };
            let pairs = found.shares.iter().zip(&whole.shares);
            let worst =
                most(&mut pairs.map(|(a, b)| a - b)) / most(&mut whole.shares.iter().copied());
            assert!(worst < 1e-9, "{region} {ring:?}: {worst:e}");
            // One quarter alone is not enough.
            assert!(by(&plans[..1]).frequencies < found.frequencies);
        }
    }

    /// A ring too large for one transform has quarters that fit, up to about 6000; an axis without frequencies has none.
    #[test]
    fn memory_decides_between_the_whole_and_its_quarters() {
        for (most, plans) in [(100, 1), (4000, 1), (5000, 2), (6000, 2)] {
            let found = plans_of(&FrequencyWindow::centered(most)).expect("plans");
            assert_eq!(found.len(), plans, "{most}");
            assert!(found.iter().all(|plan| plan.real == (plans == 1)));
        }
        let error = plans_of(&FrequencyWindow::centered(8000)).err();
        assert!(matches!(
            error,
            Some(MeasureError::WindowTooLarge { columns: 8001, .. })
        ));
        let line = FrequencyWindow {
            x: -50..51,
            y: 0..1,
        };
        assert_eq!(quarters(&line).len(), 1);
    }

    /// Noise on a bounded domain: by distance to the border, the mean relative share is the same, the mean share is not.
    #[test]
    fn relative_shares_of_bounded_noise_are_flat_where_the_shares_show_the_taper() {
        let go_on = |_: Progress| ControlFlow::Continue(());
        let region = Region {
            width: 3.0,
            height: 2.0,
            boundary: Boundary::Bounded,
        };
        let mut state = 11_u64;
        let mut draw = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        };
        let points: Vec<[f64; 2]> = (0..20_000).map(|_| [3.0 * draw(), 2.0 * draw()]).collect();
        let found = frequency_shares(&points, region, [20.0, 120.0], &go_on).unwrap();
        let relative = found.relative(&points, region);
        let unit = found.frequencies as f64 / points.len() as f64;
        let depth = |[x, y]: [f64; 2]| {
            (x / 3.0)
                .min(1.0 - x / 3.0)
                .min((y / 2.0).min(1.0 - y / 2.0))
        };
        let mean = |from: f64, to: f64, value: &dyn Fn(usize) -> f64| {
            let inside = (0..points.len()).filter(|j| (from..to).contains(&depth(points[*j])));
            let values: Vec<f64> = inside
                .map(value)
                .filter(|value| value.is_finite())
                .collect();
            values.iter().sum::<f64>() / values.len() as f64
        };
        for (from, to) in [(0.2, 0.25), (0.25, 0.35), (0.35, 0.5)] {
            let flat = mean(from, to, &|j| relative[j]);
            assert!((flat - 1.0).abs() < 0.1, "{from} {flat}");
        }
        let [rim, middle] =
            [(0.2, 0.25), (0.4, 0.5)].map(|(from, to)| mean(from, to, &|j| found.shares[j] / unit));
        assert!(middle > 3.0 * rim, "{rim} {middle}");
        let parts = FrequencyShares::parts(&points, region);
        assert!((parts.iter().sum::<f64>() / 20_000.0 - 1.0).abs() < 1e-9);
        for (part, share) in parts.iter().zip(&relative) {
            assert_eq!(*part < FrequencyShares::MIN_PART, share.is_nan());
        }
        let periodic = Region {
            boundary: Boundary::Periodic,
            ..region
        };
        let flat = FrequencyShares::parts(&points, periodic);
        assert!(flat.iter().all(|part| (part - 1.0).abs() < 1e-12));
    }
}
