//! Charts of errors by local frequency and by samples per pixel, and of power.

use tilescope_figures::chart::{Level, LineChart, Panel, Series};

use super::pictures::BLACK;
use super::plate::NYQUIST;
use super::results::SamplerResults;
use super::samplers::Sampler;
use crate::experiments::common::{curve, reference};
use crate::texts::chart;

/// Places of a curve, and its band if there is one everywhere.
type Curve = (Vec<[f64; 2]>, Option<Vec<[f64; 2]>>);

pub fn panels(all: &[SamplerResults]) -> Vec<Vec<Panel>> {
    let charts = [vec![plate(all), horizon(all)], vec![power(all)]];
    let rows = charts.map(|row| {
        let charts = row.into_iter().filter(|chart| !chart.series.is_empty());
        charts.map(Panel::Lines).collect::<Vec<_>>()
    });
    rows.into_iter().filter(|row| !row.is_empty()).collect()
}

/// Returns the curves of those samplers that have one.
fn series(
    all: &[SamplerResults],
    curve_of: impl Fn(&SamplerResults) -> Option<Curve>,
) -> Vec<Series> {
    let each = all.iter().enumerate().filter_map(|(index, one)| {
        let (points, band) = curve_of(one).filter(|(points, _)| !points.is_empty())?;
        let curve = curve(one.sampler.name(), index, points);
        Some(Series { band, ..curve })
    });
    each.collect()
}

fn plate(all: &[SamplerResults]) -> LineChart {
    let mut chart = chart(
        "fig10/plate",
        series(all, |one| Some((one.classes(), None))),
    );
    let ends = chart
        .series
        .iter()
        .filter_map(|series| series.points.last());
    // The axis ends where the longest curve does, but not before the Nyquist frequency.
    chart.x.range = Some([0.0, ends.map(|point| point[0]).fold(NYQUIST, f64::max)]);
    chart
}

fn horizon(all: &[SamplerResults]) -> LineChart {
    let mut series = series(all, |one| Some(logarithms(one)));
    series.extend(all.first().and_then(independent));
    let mut chart = chart("fig10/horizon", series);
    chart.x.ticks = Some(powers_of_two());
    chart.y.ticks = Some(round_numbers());
    chart
}

/// Ticks of logarithms to base 2.
fn powers_of_two() -> Vec<(f64, String)> {
    let each = (0..=16_u32).map(|power| (f64::from(power), (1_u32 << power).to_string()));
    each.collect()
}

/// Ticks of logarithms to base 10: 1, 2 and 5 times powers of ten.
fn round_numbers() -> Vec<(f64, String)> {
    let round = |(power, digit): (i32, f64)| {
        let value = digit / 10_f64.powi(power);
        (value.log10(), value.to_string())
    };
    let digits = |power| [1.0, 2.0, 5.0].map(|digit| (power, digit));
    (0..=6).rev().flat_map(digits).map(round).collect()
}

fn power(all: &[SamplerResults]) -> LineChart {
    // A regular grid has all of its power at single frequencies, which make no curve.
    let curve = |one: &SamplerResults| {
        let power = &one.spectrum.power;
        (one.sampler != Sampler::Grid).then(|| (power.clone(), None))
    };
    let mut chart = chart("fig10/power", series(all, curve));
    chart.y.range = Some([0.0, BLACK]);
    chart.levels = vec![Level {
        name: "independent samples".to_owned(),
        y: 1.0,
    }];
    chart
}

/// The power law with exponent -1/2, as for independent samples, through the last point of a sampler's curve.
fn independent(one: &SamplerResults) -> Option<Series> {
    let (points, _) = logarithms(one);
    let (first, last) = (points.first()?, points.last()?);
    let at = |x: f64| [x, last[1] - 0.5 * (x - last[0]) * 2_f64.log10()];
    let line = || vec![at(first[0]), at(last[0])];
    (first[0] < last[0]).then(|| reference("exponent \u{2212}1/2", line()))
}

/// The horizon's curve as logarithms: samples per pixel to base 2, errors to base 10.
fn logarithms(one: &SamplerResults) -> Curve {
    let curve = one.curve();
    let places = curve.iter().map(|at| [at.per_pixel.log2(), at.log]);
    (places.collect(), curve.iter().map(|at| at.band).collect())
}

#[cfg(test)]
mod tests {
    use super::super::results::tests::found;
    use super::*;

    #[test]
    fn the_line_of_independent_samples_halves_when_they_are_four_times_as_many() {
        let random = found(Sampler::Random, 0.2, 0.4, 1.0);
        let line = independent(&random).unwrap().points;
        let [near, far] = [line[0], line[1]];
        assert!(near[0].abs() < 1e-12 && (far[0] - 4.0).abs() < 1e-12);
        assert!((near[1] - far[1] - 4_f64.log10()).abs() < 1e-12);
        assert_eq!(logarithms(&random).1.unwrap().len(), 3);
    }

    #[test]
    fn ticks_have_the_numbers_whose_logarithms_they_are_at() {
        for (ticks, base) in [(powers_of_two(), 2_f64), (round_numbers(), 10.0)] {
            for (at, text) in &ticks {
                let value: f64 = text.parse().unwrap();
                assert!((base.powf(*at) / value - 1.0).abs() < 1e-9, "{text}");
            }
            let rise = ticks.windows(2).all(|pair| pair[0].0 < pair[1].0);
            assert!(rise, "{ticks:?}");
        }
        let found = |ticks: &[(f64, String)], text: &str| ticks.iter().any(|tick| tick.1 == text);
        assert!(
            ["1", "4", "16"]
                .iter()
                .all(|text| found(&powers_of_two(), text))
        );
        assert!(
            ["0.1", "0.2", "0.05"]
                .iter()
                .all(|text| found(&round_numbers(), text))
        );
        let all = [found_of_random()];
        assert_eq!(plate(&all).x.range.map(|range| range[0]), Some(0.0));
    }

    fn found_of_random() -> SamplerResults {
        found(Sampler::Random, 0.2, 0.4, 1.0)
    }

    #[test]
    fn a_grid_has_no_curve_of_power_and_a_sampler_without_images_none_of_error() {
        let mut all = vec![
            found(Sampler::Random, 0.2, 0.4, 1.0),
            found(Sampler::Grid, 0.2, 0.4, 1.0),
        ];
        assert_eq!(power(&all).series.len(), 1);
        assert_eq!(
            (plate(&all).series.len(), horizon(&all).series.len()),
            (2, 3)
        );
        all[1].plates.clear();
        all[1].horizons.clear();
        assert_eq!(
            (plate(&all).series.len(), horizon(&all).series.len()),
            (1, 2)
        );
        assert_eq!(panels(&all).len(), 2);
    }
}
