//! Verdicts on made-up rates.

use super::*;
use crate::rates::Engine;
use tilescope_analysis::measures::Summary;

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

pub fn rows(parallel: f64, sequential: f64) -> Vec<EngineRate> {
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
    let verdict = |rows: &[EngineRate]| claims(rows)[0].verdict;
    assert_eq!(verdict(&rows(30.0, 2.6)), Verdict::Reproduced);
    assert_eq!(verdict(&rows(2.4, 9.0)), Verdict::NotReproduced);
    assert_eq!(verdict(&rows(30.0, 2.4)), Verdict::NotReproduced);
    assert_eq!(verdict(&rows(3.0, 3.0)[..1]), Verdict::NotComparable);
    for ratio in [3.0, 30.0] {
        let claims = claims(&rows(ratio, 3.0));
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
