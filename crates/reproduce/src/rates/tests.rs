//! Ratios of made-up times, and sets that differ or are not valid.

use super::*;
use crate::study::Settings;
use crate::study::tests::alone;
use tilescope_core::Unobserved;

const ONE: Engine = Engine::Parallel { threads: 1 };

pub fn report() -> Report {
    let region = tilescope_analysis::Region {
        width: 1.0,
        height: 1.0,
        boundary: tilescope_analysis::Boundary::Periodic,
    };
    let options = tilescope_analysis::VerifyOptions::default();
    let report = tilescope_analysis::verify(&[[0.5, 0.5]], region, 0.8, &options, &|_| {
        std::ops::ControlFlow::Continue(())
    });
    report.unwrap()
}

fn time(engine: Engine, leaf: Option<f64>, seconds: f64) -> EngineTime {
    EngineTime {
        engine,
        leaf,
        seconds,
        verify_seconds: 0.5,
        equal: true,
        report: Report {
            count: 1000,
            ..report()
        },
    }
}

fn rows_of(rounds: &[Vec<EngineTime>]) -> Vec<EngineRate> {
    let rounds: Vec<&[EngineTime]> = rounds.iter().map(Vec::as_slice).collect();
    rows(&rounds, None)
}

#[test]
fn ratios_are_taken_within_a_round() {
    // The second round was disturbed: both took ten times as long.
    let round = |slow: f64| {
        let reference = time(Engine::Reference, None, 4.0 * slow);
        vec![reference, time(ONE, Some(20.0), slow)]
    };
    let rounds = [round(1.0), round(10.0), round(1.0)];
    let found = rows_of(&rounds);
    assert_eq!(found.len(), 2);
    assert!((found[1].ratio.least - 4.0).abs() < 1e-12);
    assert!((found[1].ratio.most - 4.0).abs() < 1e-12);
    assert!((found[1].rate.quartiles[1] - 1000.0).abs() < 1e-9);
    assert!((found[1].rate.least - 100.0).abs() < 1e-9);
    assert!((found[0].ratio.mean - 1.0).abs() < 1e-12);
    assert!((found[1].verify_rate - 2000.0).abs() < 1e-9);
    let rounds = rounds.each_ref().map(Vec::as_slice);
    let own = rows(&rounds, Some(&ONE));
    assert_eq!(own.len(), 1, "sets from scratch have no baseline of a leaf");
    assert!((own[0].ratio.mean - 1.0).abs() < 1e-12);
}

#[test]
fn rounds_of_other_threads_and_gpus_do_not_mix_methods() {
    let reference = || time(Engine::Reference, None, 8.0);
    let eight = Engine::Parallel { threads: 8 };
    let rows = rows_of(&[
        vec![reference(), time(ONE, Some(20.0), 4.0)],
        vec![
            reference(),
            time(eight, Some(20.0), 1.0),
            time(ONE, Some(20.0), 4.0),
            time(ONE, Some(40.0), 2.0),
        ],
    ]);
    let found: Vec<(Option<usize>, usize, f64, Option<f64>)> = rows
        .iter()
        .map(|row| {
            (
                row.engine.threads(),
                row.rate.count,
                row.ratio.mean,
                row.thread_ratio,
            )
        })
        .collect();
    let expected = [
        (Some(1), 2, 1.0, None),
        (Some(1), 2, 2.0, None),
        (Some(8), 1, 8.0, Some(4.0)),
        (Some(1), 1, 4.0, None),
    ];
    assert_eq!(found, expected);
    // By their indices in the list the second row would have eight times the rate of the reference in one round.
    assert!((rows[1].ratio.most - 2.0).abs() < 1e-12);
}

#[test]
fn a_set_that_differs_or_is_not_valid_has_no_rate() {
    let good = time(ONE, Some(20.0), 1.0);
    assert!(good.check().is_ok());
    let other = EngineTime {
        equal: false,
        ..good.clone()
    };
    let said = other.check().unwrap_err().to_string();
    assert!(said.contains("another set"), "{said}");
    let open = EngineTime {
        report: Report {
            gaps: 1,
            ..good.report
        },
        ..other
    };
    let said = EngineTime {
        equal: true,
        ..open
    };
    let said = said.check().unwrap_err().to_string();
    assert!(said.contains("1 gaps"), "{said}");
}

#[test]
fn sets_that_differ_from_the_first_are_marked_and_verified() {
    alone(&Settings::default(), |control| {
        let parameters = Parameters {
            radius: 0.03,
            ..Parameters::default()
        };
        let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved)?;
        let open = Engines::open(&[1], Vec::new())?;
        let engines = [ONE, Engine::Sequential, Engine::Reference];
        let found = times(&open, &engines, &parameters, &pattern, control)?;
        let equal: Vec<bool> = found.iter().map(|one| one.equal).collect();
        assert_eq!(equal, [true, true, false]);
        assert!(found.iter().all(|one| one.report.valid()));
        assert_eq!(found[1].report, found[0].report);
        assert_ne!(found[2].report.count, 0);
        assert_eq!(found[2].leaf, None);
        Ok(())
    });
}
