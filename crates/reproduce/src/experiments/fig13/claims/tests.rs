//! Verdicts on numbers that were made up: what must pass, and what must not.

use super::super::against::tests::one;
use super::*;
use crate::rates::Engine;
use tilescope_analysis::measures::Summary;

/// A leaf close to its pattern's size.
fn close() -> Against {
    Against {
        radius: 0.0025,
        method: Method::Kdrt {
            leaf: 80.0,
            side: 100.0,
        },
        excess: 3.8,
        peak: 2.6,
        ..one()
    }
}

#[test]
fn spectra_that_differ_are_not_similar_and_loud_chance_says_nothing() {
    assert_eq!(similar(&[one()]).verdict, Verdict::Reproduced);
    let far = Against {
        left: 0.06,
        ..one()
    };
    assert_eq!(similar(&[one(), far]).verdict, Verdict::NotReproduced);
    let loud = Against {
        chance: 0.11,
        ..far
    };
    assert_eq!(similar(&[loud]).verdict, Verdict::NotComparable);
    assert_eq!(similar(&[]).verdict, Verdict::NotComparable);
}

#[test]
fn the_worst_is_the_one_that_differs_most_from_what_chance_makes() {
    // Both are within chance: nothing is left of either.
    let near = |radius, difference| Against {
        radius,
        difference,
        left: 0.0,
        ..one()
    };
    let text = similar(&[near(0.005, 0.019), near(0.0025, 0.012)]).ours;
    assert!(text.contains("by 1.2 to 1.9 % of the power"), "{text}");
    assert!(text.contains("from each other by 2.0 %"), "{text}");
    assert!(
        text.contains("0.950 times as much as they do (radius 0.005"),
        "{text}"
    );
}

#[test]
fn regularity_is_serious_where_it_is_as_much_as_chance_and_detectable_before() {
    let verdicts = |one: Against| {
        [
            level([&[one], &[]], one.apart, None)[0].verdict,
            spikes(&[one], &[], None)[0].verdict,
        ]
    };
    assert_eq!(verdicts(one()), [Verdict::Reproduced; 2]);
    let bad = Against {
        excess: 3.1,
        peak: 2.1,
        ..one()
    };
    assert_eq!(verdicts(bad), [Verdict::NotReproduced; 2]);
    let just = Against {
        excess: 3.0,
        peak: 1.9,
        ..one()
    };
    assert_eq!(verdicts(just), [Verdict::Reproduced; 2]);
    let text = |excess| detectable(&[Against { excess, ..one() }], 0.03);
    assert!(text(0.46).contains("detectable: at most +0.46 dB (11 % more variance)"));
    assert!(text(0.46).contains("differ by at most 0.030 dB"));
    assert!(text(0.02).contains("not detectable"));
}

#[test]
fn leaves_close_to_the_pattern_have_their_own_verdict_and_controls_have_none() {
    let control = Against {
        method: Method::Copies,
        excess: 12.0,
        peak: 9.0,
        left: 2.0,
        ..one()
    };
    let shared = Against {
        method: Method::OnePattern { leaf: 40.0 },
        excess: 5.0,
        peak: 5.0,
        ..one()
    };
    let all = claims(&[one(), control, shared, close()], &rows(3.0, 3.0));
    let verdicts: Vec<Verdict> = all[2..].iter().map(|claim| claim.verdict).collect();
    let [yes, no] = [Verdict::Reproduced, Verdict::NotReproduced];
    assert_eq!(verdicts, [yes, yes, no, yes, no]);
    assert!(all[3].ours.contains("copies side by side 12.0 dB"));
    assert!(all[4].ours.contains("leaf 80 r +3.80"), "{}", all[4].ours);
    // The same leaf is fine where the same rules find nothing.
    let fine = Against {
        excess: 0.8,
        peak: 1.2,
        ..close()
    };
    let all = claims(&[one(), fine], &rows(3.0, 3.0));
    assert_eq!([all[4].verdict, all[6].verdict], [yes; 2]);
}

#[test]
fn a_single_block_is_no_evidence_for_tiles_or_against_them() {
    let whole = |excess| Against {
        radius: 0.02,
        method: Method::kdrt(80.0),
        excess,
        peak: excess,
        ..one()
    };
    for excess in [0.0, 9.0] {
        let [claim, _] = level([&[one(), whole(excess)], &[]], 0.03, None);
        assert_eq!(claim.verdict, Verdict::NotComparable);
        assert!(
            claim
                .ours
                .contains("leaf 80 r one block: nothing was tiled"),
            "{}",
            claim.ours
        );
        let [claim, _] = spikes(&[whole(excess)], &[], None);
        assert_eq!(claim.verdict, Verdict::NotComparable);
        assert_eq!(similar(&[whole(excess)]).verdict, Verdict::NotComparable);
        // With a tiling of that leaf at another radius there is something to judge.
        let tiled = Against {
            radius: 0.0025,
            ..whole(0.5)
        };
        let [claim, _] = level([&[one(), whole(excess), tiled], &[]], 0.03, None);
        assert_eq!(claim.verdict, Verdict::Reproduced);
    }
}

#[test]
fn a_few_blocks_may_refute_and_do_not_confirm() {
    let few = |excess, peak| Against {
        radius: 0.005,
        excess,
        peak,
        ..close()
    };
    let verdicts = |one: Against| {
        [
            level([&[], &[one]], 0.03, None)[1].clone(),
            spikes(&[], &[one], None)[1].clone(),
        ]
    };
    for claim in verdicts(few(2.25, 1.64)) {
        assert_eq!(claim.verdict, Verdict::NotComparable);
        assert!(
            claim
                .reason
                .ends_with("leaves of 80 r have no others here."),
            "{}",
            claim.reason
        );
    }
    for claim in verdicts(few(3.8, 2.6)) {
        assert_eq!(claim.verdict, Verdict::NotReproduced);
    }
    // As much of enough blocks is an answer.
    let many = Against {
        radius: 0.0025,
        ..few(2.25, 1.64)
    };
    for claim in verdicts(many) {
        assert_eq!(claim.verdict, Verdict::Reproduced);
    }
}

#[test]
fn values_are_listed_by_leaf_and_radius_and_nothing_has_no_sign() {
    let other = Against {
        radius: 0.01,
        excess: -0.1,
        ..one()
    };
    let text = by_leaf(&[other, one()], &anisotropy());
    assert_eq!(text, "leaf 40 r \u{2212}0.10 / +0.30 (radii 0.01 / 0.005)");
    assert_eq!(signed(-0.004), "0.00");
    assert_eq!(signed(0.004), "0.00");
    assert_eq!(signed(-0.006), "\u{2212}0.01");
}

fn row(engine: Engine, leaf: Option<f64>, ratio: f64) -> EngineRate {
    let of = |value| Summary::of([value]).unwrap();
    EngineRate {
        engine,
        leaf,
        times: Vec::new(),
        count: 2e6,
        rate: of(5e5 * ratio),
        verify_rate: 1e6,
        ratio: of(ratio),
        thread_ratio: None,
        density: 0.698,
        min_distance: 1.0,
        covering_radius: 1.0,
    }
}

fn rows(parallel: f64, sequential: f64) -> Vec<EngineRate> {
    vec![
        row(Engine::Reference, None, 1.0),
        row(Engine::Parallel { threads: 1 }, Some(20.0), parallel),
        // More threads may not save it.
        row(Engine::Parallel { threads: 2 }, Some(20.0), 9.0),
        row(Engine::Sequential, Some(20.0), sequential),
    ]
}

#[test]
fn every_engine_on_one_thread_counts_and_a_ratio_to_another_baseline_is_no_verdict() {
    let verdict = |rows: &[EngineRate]| super::rates(rows)[0].verdict;
    assert_eq!(verdict(&rows(30.0, 2.6)), Verdict::Reproduced);
    assert_eq!(verdict(&rows(2.4, 9.0)), Verdict::NotReproduced);
    assert_eq!(verdict(&rows(30.0, 2.4)), Verdict::NotReproduced);
    assert_eq!(verdict(&rows(3.0, 3.0)[..1]), Verdict::NotComparable);
    for ratio in [3.0, 30.0] {
        let claims = super::rates(&rows(ratio, 3.0));
        assert_eq!(claims[1].verdict, Verdict::NotComparable);
        assert!(
            claims[0]
                .ours
                .contains("KDRT, sequential 3.00 at leaf 20 r"),
            "{}",
            claims[0].ours
        );
    }
}
