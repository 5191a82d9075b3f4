//! Uniformity tests on counts whose truth is known: uniform ones pass, biased ones show their bias. The bias is made
//! here, with a known strength that the effect size must show. No sampler is run.

use crate::support::Random;
use crate::support::sets::{square, torus};
use tilescope_analysis::measures::{
    ClassCounts, Deviation, DistanceClasses, MeasureError, PositionClasses,
};

/// Counts over runs of samples drawn with the given shares, expected to have those of the second list.
fn drawn(seed: u64, runs: usize, samples: usize, truth: &[f64], expected: &[f64]) -> ClassCounts {
    let mut random = Random::new(seed);
    let mut counts = ClassCounts::new(truth.len()).expect("classes");
    for _ in 0..runs {
        let mut run = vec![0; truth.len()];
        for _ in 0..samples {
            let mut left = random.uniform();
            let class = truth.iter().position(|share| {
                left -= share;
                left < 0.0
            });
            run[class.unwrap_or(truth.len() - 1)] += 1;
        }
        counts.add_run(&run, expected).expect("counts");
    }
    counts
}

#[test]
fn uniform_counts_pass_with_even_probabilities() {
    let shares = [0.1, 0.2, 0.3, 0.4];
    let mut below = [0; 4];
    let mut held = 0;
    for seed in 0..400 {
        let found = drawn(seed, 5, 200, &shares, &shares)
            .uniformity(0.9)
            .expect("a test");
        assert_eq!(
            (found.samples, found.runs, found.chi_square.freedom),
            (1000, 5, 3)
        );
        below[((found.chi_square.probability * 4.0) as usize).min(3)] += 1;
        held += found
            .deviations
            .iter()
            .filter(|class| class.interval[0] < 0.0 && class.interval[1] > 0.0)
            .count();
    }
    // Binomial of 400 and 1/4: deviation 8.7.
    assert!(
        below.iter().all(|count| (100_i32 - *count).abs() < 44),
        "{below:?}"
    );
    let share = held as f64 / 1600.0;
    assert!((share - 0.9).abs() < 0.04, "{share}");
}

#[test]
fn a_bias_is_found_with_its_size() {
    // Relative deviations of +-20%: w = 0.2, V = w / sqrt(classes - 1).
    let (truth, even) = ([0.3, 0.2, 0.3, 0.2], [0.25; 4]);
    for (runs, samples) in [(10, 1000), (40, 4000)] {
        let found = drawn(7, runs, samples, &truth, &even)
            .uniformity(0.99)
            .expect("a test");
        assert!(found.chi_square.probability < 1e-6);
        assert!(
            (found.chi_square.cramers_v - 0.2 / 3f64.sqrt()).abs() < 0.02,
            "{:?}",
            found.chi_square
        );
        assert!((found.largest_deviation() - 0.2).abs() < 0.06);
        for (class, sign) in found.deviations.iter().zip([1.0, -1.0, 1.0, -1.0]) {
            assert!(class.relative * sign > 0.1);
            assert!(
                class.interval[0] * class.interval[1] > 0.0,
                "zero is excluded: {class:?}"
            );
        }
    }
}

#[test]
fn two_processes_are_compared_by_their_counts() {
    let (even, odd) = ([0.25; 4], [0.27, 0.23, 0.27, 0.23]);
    let a = drawn(1, 20, 2000, &even, &even);
    let b = drawn(2, 20, 1000, &even, &even);
    let c = drawn(3, 20, 2000, &odd, &even);
    let same = a.compare(&b).expect("a comparison");
    assert!(same.probability > 1e-3 && same.cramers_v < 0.02, "{same:?}");
    let other = a.compare(&c).expect("a comparison");
    assert!(other.probability < 1e-6, "{other:?}");
    // Half of each: deviations of 4% from the common shares.
    assert!((other.cramers_v - 0.04).abs() < 0.012, "{other:?}");
    // The statistic of a 2 x 2 table by its textbook formula.
    let mut table = [
        ClassCounts::new(2).expect("classes"),
        ClassCounts::new(2).expect("classes"),
    ];
    table[0].add_run(&[10, 20], &[0.5, 0.5]).expect("counts");
    table[1].add_run(&[30, 5], &[0.5, 0.5]).expect("counts");
    let found = table[0].compare(&table[1]).expect("a comparison");
    let expected = 65.0 * (10.0 * 5.0 - 20.0 * 30.0_f64).powi(2) / (30.0 * 35.0 * 40.0 * 25.0);
    assert!((found.statistic - expected).abs() < 1e-12 && found.freedom == 1);
    assert!((found.cramers_v - (expected / 65.0).sqrt()).abs() < 1e-12);
}

#[test]
fn intervals_of_one_run_take_samples_as_independent() {
    let mut counts = ClassCounts::new(2).expect("classes");
    counts.add_run(&[60, 40], &[0.5, 0.5]).expect("counts");
    let found = counts.uniformity(0.95).expect("a test");
    // z 1.96 times a deviation of 5 over 50.
    assert!((found.deviations[0].interval[0] - (0.2 - 0.195_996_398_454)).abs() < 1e-9);
    assert!((found.chi_square.statistic - 4.0).abs() < 1e-12);
    assert!((found.chi_square.probability - 0.045_500_263_896).abs() < 1e-10);
}

/// Samples that depend on each other within a run: the spread between runs must see it.
#[test]
fn intervals_of_many_runs_need_no_independence() {
    let mut random = Random::new(9);
    let mut held = 0;
    for _ in 0..300 {
        let mut counts = ClassCounts::new(2).expect("classes");
        for _ in 0..12 {
            // All 100 samples of a run fall into one class.
            let class = usize::from(random.uniform() < 0.5);
            let mut run = [0, 0];
            run[class] = 100;
            counts.add_run(&run, &[0.5, 0.5]).expect("counts");
        }
        let [low, high] = counts.uniformity(0.9).expect("a test").deviations[0].interval;
        held += i32::from(low <= 0.0 && high >= 0.0);
    }
    assert!((f64::from(held) / 300.0 - 0.9).abs() < 0.08, "{held}");
}

#[test]
fn places_fall_into_the_cells_that_hold_them() {
    let (points, region) = square(6, 4);
    let classes = PositionClasses {
        region,
        columns: 3,
        rows: 2,
    };
    assert_eq!(classes.counts(&points).expect("counts"), [4; 6]);
    let corner = classes
        .counts(&[[5.9, 0.1], [0.1, 3.9], [0.0, 0.0]])
        .expect("counts");
    assert_eq!(corner, [1, 0, 1, 1, 0, 0]);
    assert!((classes.shares().iter().sum::<f64>() - 1.0).abs() < 1e-12);
    assert!(matches!(
        classes.counts(&[[6.0, 0.0]]),
        Err(MeasureError::Set(_))
    ));
    let none = PositionClasses {
        columns: 0,
        ..classes
    };
    assert!(matches!(
        none.counts(&points),
        Err(MeasureError::BadCount { count: 0, .. })
    ));
}

#[test]
fn noise_is_uniform_on_a_grid_and_a_pile_is_not() {
    let region = torus(1.0, 1.0);
    let classes = PositionClasses {
        region,
        columns: 16,
        rows: 16,
    };
    let (mut noise, mut piled) = (
        ClassCounts::new(256).expect("classes"),
        ClassCounts::new(256).expect("classes"),
    );
    let mut random = Random::new(12);
    for _ in 0..20 {
        let points = random.points(2000, region);
        // Density falls from 1.43 at the left to 0.77 at the right.
        let pile: Vec<_> = points
            .iter()
            .map(|p| [p[0] - 0.3 * p[0] * (1.0 - p[0]), p[1]])
            .collect();
        noise
            .add_run(&classes.counts(&points).expect("counts"), &classes.shares())
            .expect("counts");
        piled
            .add_run(&classes.counts(&pile).expect("counts"), &classes.shares())
            .expect("counts");
    }
    let (noise, piled) = (
        noise.uniformity(0.95).expect("a test"),
        piled.uniformity(0.95).expect("a test"),
    );
    assert!(
        noise.chi_square.probability > 1e-3,
        "{:?}",
        noise.chi_square
    );
    assert!(piled.chi_square.probability < 1e-9);
    let deviations = [noise.deviations.clone(), piled.deviations.clone()];
    // The density is 1 / sqrt(0.49 + 1.2 x): it deviates by 0.18 in quadratic mean; V is that over sqrt(255),
    // beside 0.005 of noise.
    let [flat, slope] = [noise, piled].map(|found| found.chi_square.cramers_v);
    assert!((0.004..0.006).contains(&flat), "{flat}");
    assert!((0.0105..0.0145).contains(&slope), "{slope}");
    let excluded = |found: &[Deviation]| {
        let zero = |class: &&Deviation| class.interval[0] <= 0.0 && class.interval[1] >= 0.0;
        1.0 - found.iter().filter(zero).count() as f64 / 256.0
    };
    let [flat, slope] = deviations.map(|found| excluded(&found));
    assert!(flat < 0.12 && slope > 0.4, "{flat} {slope}");
}

#[test]
fn distances_fall_into_ranges_with_the_shares_of_uniform_places() {
    let classes = DistanceClasses::new(vec![0.0, 1.0, 3.0]).expect("edges");
    assert_eq!(
        classes
            .counts(&[0.0, 0.5, 1.0, 2.9, 3.0, 99.0])
            .expect("counts"),
        [2, 2, 2]
    );
    assert_eq!(
        classes.shares(&[0.1, 0.2, 1.5, 7.0]).expect("shares"),
        [0.5, 0.25, 0.25]
    );
    assert!(matches!(
        classes.counts(&[-0.1]),
        Err(MeasureError::OutOfRange { .. })
    ));
    assert!(matches!(
        classes.counts(&[f64::NAN]),
        Err(MeasureError::OutOfRange { .. })
    ));
    assert!(matches!(
        classes.shares(&[]),
        Err(MeasureError::TooFew { count: 0, limit: 1 })
    ));
    assert!(matches!(
        DistanceClasses::new(vec![]),
        Err(MeasureError::BadCount { count: 0, .. })
    ));
    let falling = DistanceClasses::new(vec![0.0, 2.0, 1.0]);
    assert!(matches!(
        falling,
        Err(MeasureError::NotRising { index: 2, .. })
    ));
}

#[test]
fn a_sample_where_none_can_be_is_infinitely_unlikely() {
    let mut counts = ClassCounts::new(3).expect("classes");
    counts
        .add_run(&[5, 5, 1], &[0.5, 0.5, 0.0])
        .expect("counts");
    let found = counts.uniformity(0.9).expect("a test").chi_square;
    assert!(found.statistic.is_infinite() && found.probability.abs() < f64::MIN_POSITIVE);
}

#[test]
fn counts_that_say_nothing_are_refused() {
    assert!(matches!(
        ClassCounts::new(0),
        Err(MeasureError::BadCount { .. })
    ));
    let mut counts = ClassCounts::new(2).expect("classes");
    assert!(matches!(
        counts.uniformity(0.9),
        Err(MeasureError::TooFew { .. })
    ));
    let refused = counts.add_run(&[1, 2, 3], &[0.5, 0.5]);
    assert!(matches!(
        refused,
        Err(MeasureError::LengthDiffers {
            count: 3,
            expected: 2,
            ..
        })
    ));
    for shares in [[0.5, 0.6], [1.5, -0.5], [f64::NAN, 0.5]] {
        assert!(matches!(
            counts.add_run(&[1, 2], &shares),
            Err(MeasureError::OutOfRange { .. })
        ));
    }
    assert_eq!(counts.runs(), 0);
    counts.add_run(&[3, 0], &[1.0, 0.0]).expect("counts");
    assert!(matches!(
        counts.uniformity(0.9),
        Err(MeasureError::TooFew { count: 1, limit: 2 })
    ));
    assert!(matches!(
        counts.uniformity(1.0),
        Err(MeasureError::OutOfRange { .. })
    ));
    let other = ClassCounts::new(3).expect("classes");
    assert!(matches!(
        counts.compare(&other),
        Err(MeasureError::LengthDiffers { .. })
    ));
    let empty = ClassCounts::new(2).expect("classes");
    assert!(matches!(
        counts.compare(&empty),
        Err(MeasureError::TooFew { count: 0, limit: 1 })
    ));
}
