//! Averages of curves and periodograms with their errors and bands, on numbers done by hand and on noise. A band is
//! tested by how often it holds the truth. Averages over frequencies are tested in `spectra.rs`.

use crate::support::sets::torus;
use crate::support::{Random, go_on};
use tilescope_analysis::Region;
use tilescope_analysis::measures::{
    Average, FrequencyWindow, MeanPeriodogram, MeasureError, Periodogram, power_band,
};

fn periodogram(points: &[[f64; 2]], region: Region, window: &FrequencyWindow) -> Periodogram {
    Periodogram::of(points, region, window, &go_on).expect("a periodogram")
}

#[test]
fn averages_have_the_spread_of_their_sets() {
    let mut average = Average::new(2);
    assert_eq!(average.standard_errors(), None);
    for curve in [[1.0, 5.0], [2.0, 5.0], [6.0, 5.0]] {
        average.add(&curve).expect("two values");
    }
    assert_eq!(average.means(), [3.0, 5.0]);
    // The variance of 1, 2, 6 is 7.
    let errors = average.standard_errors().expect("three sets");
    assert!((errors[0] - (7.0f64 / 3.0).sqrt()).abs() < 1e-15 && errors[1] == 0.0);
    let band = average.band(0.95).expect("a level").expect("three sets");
    // Student's 4.3027 for two degrees of freedom.
    assert!(
        (band[0][1] - 3.0 - 4.302_652_729_911_275 * errors[0]).abs() < 1e-8,
        "{band:?}"
    );
    let short = average.add(&[1.0]);
    assert!(matches!(
        short,
        Err(MeasureError::LengthDiffers {
            count: 1,
            expected: 2,
            ..
        })
    ));
    assert!(matches!(
        average.band(1.5),
        Err(MeasureError::OutOfRange { value: 1.5, .. })
    ));
}

#[test]
fn averages_of_parts_join_to_that_of_all_curves() {
    let curves = [[1.0, -5.0], [2.0, 5.0], [6.0, 9.0], [4.0, 0.5], [-3.0, 7.0]];
    let of = |curves: &[[f64; 2]]| {
        let mut average = Average::new(2);
        for curve in curves {
            average.add(curve).expect("two values");
        }
        average
    };
    let all = of(&curves);
    for cut in 0..=curves.len() {
        let mut joined = of(&curves[..cut]);
        joined.join(&of(&curves[cut..])).expect("one length");
        assert_eq!(joined.sets(), all.sets());
        let errors = |one: &Average| one.standard_errors().expect("five sets");
        let near = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
        assert!(near(joined.means(), all.means()), "{cut}");
        assert!(near(&errors(&joined), &errors(&all)), "{cut}");
    }
    let short = of(&curves).join(&Average::new(1));
    assert!(matches!(short, Err(MeasureError::LengthDiffers { .. })));
}

/// Both kinds of band hold the true power of noise, 1, with about their stated probability.
#[test]
fn bands_hold_the_truth_as_often_as_they_say() {
    let window = FrequencyWindow {
        x: 1..40,
        y: -40..40,
    };
    let (mut random, region, sets) = (Random::new(41), torus(1.0, 1.0), 12);
    let mut mean = MeanPeriodogram::default();
    for _ in 0..sets {
        let set = periodogram(&random.points(800, region), region, &window);
        mean.add(set).expect("the same window");
    }
    let powers = mean.powers().expect("several sets");
    let means = powers.means();
    let count = means.len() as f64;
    let band = power_band(f64::from(sets), 0.9).expect("a level");
    let held = means
        .iter()
        .filter(|m| (**m * band[0]..**m * band[1]).contains(&1.0))
        .count() as f64;
    assert!((held / count - 0.9).abs() < 0.03, "{}", held / count);
    let intervals = powers.band(0.9).expect("a level").expect("sets");
    let held = intervals
        .iter()
        .filter(|[low, high]| (*low..*high).contains(&1.0))
        .count() as f64;
    // Exponential values are skewed, which costs Student's intervals some of their promise.
    assert!((0.78..0.93).contains(&(held / count)), "{}", held / count);
    // Chi-square of two degrees of freedom: the 5% points are -2 ln 0.05 and -2 ln 0.95.
    let single = power_band(1.0, 0.9).expect("a level");
    assert!(
        (single[0] + 1.0 / 0.05f64.ln()).abs() < 1e-9
            && (single[1] + 1.0 / 0.95f64.ln()).abs() < 1e-9
    );
}

#[test]
fn only_like_periodograms_are_averaged() {
    let points = Random::new(1).points(20, torus(1.0, 1.0));
    let mut mean = MeanPeriodogram::default();
    assert_eq!(MeanPeriodogram::default().mean(), None);
    let of = |region, most| periodogram(&points, region, &FrequencyWindow::centered(most));
    mean.add(of(torus(1.0, 1.0), 4)).expect("the first");
    let other = mean.add(of(torus(1.0, 1.0), 5));
    assert_eq!(other, Err(MeasureError::Differs { name: "the window" }));
    let other = mean.add(of(torus(2.0, 1.0), 4));
    assert_eq!(other, Err(MeasureError::Differs { name: "the region" }));
    assert_eq!(mean.mean().expect("one set").sets, 1);
}
