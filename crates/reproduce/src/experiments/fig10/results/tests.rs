//! Made-up errors of samplers, for this and other tests, and the numbers that follow from them.

use super::*;

pub fn plated(rmse: f64, index: u64) -> PlateErrors {
    PlateErrors {
        index,
        count: 1000,
        side: 32,
        empty: 0,
        rmse,
        below: rmse,
        above: rmse,
        signal_db: 1.0,
        classes: vec![[0.1, rmse]],
        shades: None,
    }
}

pub fn rendered(rmse: f64, per_pixel: usize, index: u64) -> HorizonErrors {
    HorizonErrors {
        index,
        per_pixel,
        count: 1000,
        rmse,
        empty: 0.0,
        shades: None,
    }
}

/// A sampler whose errors scatter a little about given ones.
pub fn found(sampler: Sampler, plate: f64, horizon: f64, low: f64) -> SamplerResults {
    let scatter = |error: f64, index: u64| error * (1.0 + 0.001 * index as f64);
    let at = |per_pixel: usize| {
        let error = horizon / (per_pixel as f64).sqrt();
        (0..3)
            .map(|index| rendered(scatter(error, index), per_pixel, index))
            .collect()
    };
    SamplerResults {
        sampler,
        spectrum: MeanSpectrum {
            sets: 3,
            count: 1000,
            power: vec![[0.1, low], [1.0, 1.0]],
            low,
            picture: vec![0.0, 1.0, 1.0, 0.0],
            reach: 2.5,
        },
        plates: (0..3).map(|i| plated(scatter(plate, i), i)).collect(),
        horizons: [1, 4, 16].map(at).to_vec(),
    }
}

#[test]
fn slopes_and_means_are_those_of_the_errors() {
    let mut found = found(Sampler::Random, 0.2, 0.4, 1.0);
    assert_eq!(found.slope(), None, "from 4 on there are two numbers");
    let eight = rendered(0.4 * 1.001 / 8_f64.sqrt(), 8, 0);
    found.horizons.insert(2, vec![eight]);
    assert!((found.slope().unwrap() + 0.5).abs() < 1e-3);
    found.horizons.remove(2);
    assert!((found.densest()[0] - 0.1).abs() < 1e-12);
    assert!((found.overall()[0] - 0.2).abs() < 1e-12);
    let HorizonPoint {
        per_pixel,
        log,
        band,
    } = found.curve()[0];
    assert!((per_pixel - 1.0).abs() < 1e-12);
    assert!((log - 0.4004_f64.log10()).abs() < 1e-4);
    let [low, high] = band.unwrap();
    assert!(low < log && log < high && high - low < 0.01);
}

#[test]
fn ratios_of_scattered_errors_have_wide_intervals() {
    let narrow = Ratio::of(&[2.0, 2.02, 1.98], &[1.0, 1.01, 0.99]).unwrap();
    let wide = Ratio::of(&[1.0, 3.0, 2.0], &[1.0, 1.01, 0.99]).unwrap();
    let width = |ratio: Ratio| ratio.interval.map(|[low, high]| high - low);
    assert!((narrow.value - 2.0).abs() < 0.01);
    assert!(width(wide).unwrap() > 10.0 * width(narrow).unwrap());
    assert_eq!(Ratio::of(&[2.0], &[1.0, 1.0]).unwrap().interval, None);
    assert_eq!(Ratio::of(&[], &[1.0]), None);
}
