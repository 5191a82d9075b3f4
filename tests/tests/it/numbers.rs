//! Numbers that the method must reproduce: counts of an independent prototype, the jamming density of random sequential
//! addition, the spectrum of the reference sampler, and the search radius that the paper believed to suffice.

use crate::support::{judge, run};
use std::ops::ControlFlow;

use tilescope_analysis::Region;
use tilescope_analysis::measures::{FrequencyWindow, Periodogram, RadialProfile};
use tilescope_core::{
    Boundary, Domain, Order, Parameters, PatternSpec, Search, Summary, Unobserved, radius_estimate,
    reference_sample,
};

/// 300 r square, periodic, leaf 20 r, pattern 100 r.
fn prototype(order: Order, seed: u64) -> Parameters {
    Parameters {
        width: 300.0,
        height: 300.0,
        radius: 1.0,
        leaf: 20.0,
        order,
        seed,
        ..Parameters::default()
    }
}

#[test]
fn counts_agree_with_the_prototype() {
    // Order, eliminated, inserted in iteration 1 and 2, as seen in one run of the prototype.
    let rows = [
        (Order::Index, 11_034.0, 1_919.0, 112.0),
        (Order::Random, 11_282.0, 2_203.0, 71.0),
        (Order::OwnBlockFirst, 10_659.0, 1_526.0, 54.0),
    ];
    for (order, eliminated, first, second) in rows {
        let seeds = 12;
        let runs: Vec<Summary> = (0..seeds)
            .map(|seed| run(&prototype(order, seed)).summary())
            .collect();
        let mean = |of: &dyn Fn(&Summary) -> usize| {
            runs.iter().map(|s| of(s) as f64).sum::<f64>() / f64::from(seeds as u32)
        };
        let near = |name: &str, found: f64, seen: f64, share: f64| {
            assert!(
                (found / seen - 1.0).abs() < share,
                "{order:?} {name}: {found}, seen {seen}"
            );
        };
        near("tiled", mean(&|s| s.tiled), 71_957.0, 0.02);
        near("eliminated", mean(&|s| s.eliminated), eliminated, 0.06);
        near("iteration 1", mean(&|s| s.inserted[0]), first, 0.08);
        // Only dozens of samples, so a single run of the prototype gives their mean only roughly.
        near("iteration 2", mean(&|s| s.inserted[1]), second, 0.35);
        let density = mean(&|s| s.count) / 90_000.0;
        assert!((0.695..0.703).contains(&density), "{order:?}: {density}");
    }
}

/// Maximal random sequential addition of disks jams at a coverage of 0.547 07 (Torquato, Uche and
/// Stillinger 2006), which is a density N r^2 / area of 0.696 55 here.
#[test]
fn the_reference_sampler_has_the_jamming_density() {
    let domain = Domain::from_size([400.0, 400.0], 1.0, Boundary::Periodic).unwrap();
    let sets = 6;
    let count: usize = (0..sets)
        .map(|seed| {
            reference_sample(domain, seed, &mut Unobserved)
                .unwrap()
                .len()
        })
        .sum();
    let density = count as f64 / (domain.area_radii() * f64::from(sets as u32));
    // Six sets of 111,000 samples: a standard error of about 0.0002.
    assert!((density - 0.696_55).abs() < 0.000_9, "{density}");
}

const UNIT_TORUS: Region = Region {
    width: 1.0,
    height: 1.0,
    boundary: tilescope_analysis::Boundary::Periodic,
};

/// Radial mean power of ten sets of about 10,000 samples, over 0.1 to 2 sqrt(N).
fn mean_spectrum(sets: impl Iterator<Item = Vec<[f64; 2]>>) -> Vec<f64> {
    let mut sum = Vec::new();
    let mut sets_seen = 0.0;
    for set in sets {
        let window = FrequencyWindow::centered(201);
        let go_on = |_| ControlFlow::Continue(());
        let periodogram = Periodogram::of(&set, UNIT_TORUS, &window, &go_on).unwrap();
        let annuli = RadialProfile::of(&periodogram, 1.0).unwrap().annuli;
        sum.resize(200, 0.0);
        for (sum, bin) in sum.iter_mut().zip(&annuli) {
            *sum += bin.power;
        }
        sets_seen += 1.0;
    }
    sum.iter().skip(10).map(|power| power / sets_seen).collect()
}

#[test]
fn the_spectrum_is_the_reference_samplers() {
    let base = Parameters::default();
    let base = Parameters {
        radius: radius_estimate(&base, 10_000).unwrap(),
        ..base
    };
    let domain = base.validate().unwrap();
    // Ten independent realisations: with one pattern for all ten, that pattern's own noise would
    // repeat in every set instead of averaging out.
    let kdrt = mean_spectrum((100..110).map(|seed| {
        let pattern = PatternSpec {
            seed,
            ..base.pattern
        };
        run(&Parameters {
            seed,
            pattern,
            ..base
        })
        .positions()
    }));
    let reference = mean_spectrum((0..10).map(|seed| {
        let points = reference_sample(domain, seed, &mut Unobserved).unwrap();
        points
            .iter()
            .map(|&p| domain.user_from_lattice(p))
            .collect()
    }));
    assert!(kdrt.len() > 150);
    let squares = kdrt
        .iter()
        .zip(&reference)
        .map(|(a, b)| (a - b).powi(2))
        .sum::<f64>();
    let scale = reference.iter().map(|b| b.powi(2)).sum::<f64>();
    let difference = (squares / scale).sqrt();
    println!(
        "radial mean power differs by {:.2}% RMS",
        100.0 * difference
    );
    assert!(difference < 0.03, "{difference}");
    let peak = reference.iter().copied().fold(0.0, f64::max);
    assert!((1.65..1.9).contains(&peak), "{peak}");
}

#[test]
fn a_search_of_two_radii_leaves_gaps_and_four_leaves_none() {
    let mut gaps = 0;
    for seed in 0..3 {
        let wide = Parameters {
            radius: 0.002,
            leaf: 40.0,
            seed,
            ..Parameters::default()
        };
        let narrow = Parameters {
            search: Search::TwoRadii,
            ..wide
        };
        let complete = run(&wide);
        assert!(judge(&complete.domain, &complete.positions()).valid());
        let experiment = run(&narrow);
        let report = judge(&experiment.domain, &experiment.positions());
        assert!(report.conflict_free());
        gaps += report.gaps;
    }
    assert!(gaps > 20, "{gaps}");
}
