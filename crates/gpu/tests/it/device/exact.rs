//! Exact tilings on a device: equal to core's engine bit for bit, in samples, sources and counts.

use std::sync::Arc;

use proptest::prelude::*;
use tilescope_core::{
    Boundary, Parameters, PatternHistory, PatternSpec, Point, Progress, R, Run, SampleError, Stage,
    TilingMethod, Unobserved, exact_sample,
};
use tilescope_gpu::layout::Name;
use tilescope_gpu::{
    ExactReference, ExactStepper, Gpu, GpuError, RowPlace, Unplaced, exact_on_gpu,
    exact_with_reports,
};

use crate::support::device::{checked_gpu, gpu};

fn history(parameters: &Parameters) -> PatternHistory {
    PatternHistory::of_spec(&parameters.pattern, &mut Unobserved).unwrap()
}

fn parameters(side: f64, leaf: f64) -> Parameters {
    Parameters {
        method: TilingMethod::Exact,
        width: side,
        height: side,
        radius: 1.0,
        leaf,
        pattern: PatternSpec {
            side: 20.0,
            ..PatternSpec::default()
        },
        ..Parameters::default()
    }
}

/// Fails unless two runs have the same samples, sources and counts.
fn compare(device: &Run, cpu: &Run) -> Result<(), String> {
    let differs = |what: &str| Err(format!("{what} differ: {:?}", cpu.parameters));
    if device.points() != cpu.points() {
        return differs("points");
    }
    if device.samples.origins != cpu.samples.origins {
        return differs("sources");
    }
    if device.summary() != cpu.summary() {
        return differs("counts");
    }
    Ok(())
}

fn on(gpu: &Arc<Gpu>, parameters: &Parameters, history: &PatternHistory) -> Result<Run, GpuError> {
    pollster::block_on(async {
        exact_on_gpu(gpu, parameters, history.arrived(), &mut Unobserved).await
    })
}

/// Fails unless the device gives the CPU's run, with trusted shaders and with checked ones. Returns the run.
fn made(parameters: &Parameters) -> Result<Run, String> {
    let history = history(parameters);
    let cpu = exact_sample(parameters, &history, &mut Unobserved).unwrap();
    for gpu in [gpu(), checked_gpu()] {
        let device = on(gpu, parameters, &history).map_err(|error| error.to_string())?;
        compare(&device, &cpu)?;
    }
    Ok(cpu)
}

#[test]
fn exact_tilings_are_equal() {
    for (boundary, dihedral, leaf) in [
        (Boundary::Periodic, false, 8.0),
        (Boundary::Bounded, true, 13.0),
    ] {
        let parameters = Parameters {
            height: 33.3,
            boundary,
            dihedral,
            ..parameters(47.7, leaf)
        };
        let run = made(&parameters).unwrap_or_else(|error| panic!("{error}"));
        // What is compared has losses, and darts of many levels.
        let summary = run.summary();
        assert!(summary.eliminated > 50 && summary.inserted.len() > 4);
        assert!(run.points().len() > 1000);
    }
}

/// Control: a run with another seed, and one that lacks a sample, are not taken for equal.
#[test]
fn runs_that_differ_are_caught() {
    let parameters = parameters(20.0, 8.0);
    let history = history(&parameters);
    let device = on(gpu(), &parameters, &history).unwrap();
    let other = Parameters {
        seed: parameters.seed + 1,
        ..parameters
    };
    let cpu = exact_sample(&other, &history, &mut Unobserved).unwrap();
    let caught = compare(&device, &cpu).unwrap_err();
    assert!(caught.starts_with("points differ"), "{caught}");

    let mut cpu = exact_sample(&parameters, &history, &mut Unobserved).unwrap();
    assert_eq!(compare(&device, &cpu), Ok(()));
    cpu.result.pop();
    assert!(compare(&device, &cpu).is_err());
}

#[test]
fn passes_are_reported_in_the_order_of_throws() {
    let parameters = parameters(16.0, 8.0);
    let history = history(&parameters);
    let mut observer = Unobserved;
    let run = exact_with_reports(gpu(), &parameters, history.arrived(), &mut observer);
    let (_, reports) = pollster::block_on(run).unwrap();
    assert!(reports.is_sorted_by_key(|report| report.stage));
    assert_eq!(reports[0].name, "lay");
    assert_eq!(reports.last().unwrap().name, "collect");
    let judged = |level: u32| {
        let of_level = reports
            .iter()
            .filter(|report| report.stage == Stage::Iterate(level));
        of_level.filter(|report| report.name == "judge").count()
    };
    // Level 0 has four throws, which count as iteration 1 together with that of level 1.
    assert!(judged(1) >= 5 && judged(7) >= 1);
}

/// Steps through a run pass by pass. After each stage its samples are compared with the CPU's; returns the stages that were
/// compared, each with its first difference. `change` may change words after a pass, by its number from 1.
fn inspect(
    parameters: &Parameters,
    change: impl Fn(&ExactStepper, usize),
) -> Vec<(Stage, Option<String>)> {
    let history = history(parameters);
    let reference = ExactReference::new(parameters, &history, &mut Unobserved).unwrap();
    pollster::block_on(async {
        let stepper = ExactStepper::new(Arc::clone(gpu()), parameters, history.arrived());
        let mut stepper = stepper.await.unwrap();
        let mut compared = Vec::new();
        while stepper.step_pass().await.unwrap().is_some() {
            change(&stepper, stepper.reports().len());
            if let Some(stage) = stepper.ended_stage() {
                let samples = stepper.samples().await.unwrap();
                let difference = reference.compare(stage, &samples);
                compared.push((stage, difference.map(|difference| difference.to_string())));
            }
        }
        assert_eq!(stepper.restarts(), 0);
        compared
    })
}

#[test]
fn every_stage_of_an_inspected_run_is_equal_and_a_changed_word_is_noticed() {
    let parameters = parameters(14.0, 8.0);
    let compared = inspect(&parameters, |_, _| ());
    let levels = (1..=15).map(Stage::Iterate);
    let stages = [Stage::Tile]
        .into_iter()
        .chain(levels)
        .chain([Stage::Finish]);
    let expected: Vec<(Stage, Option<String>)> = stages.map(|stage| (stage, None)).collect();
    assert_eq!(compared, expected);

    // The first sample that was laid down moves. The stage shows it; later ones need not: a sample in conflict is lost, and its
    // dart is thrown again.
    let spoilt = inspect(&parameters, |stepper, passes| {
        if passes == 1 {
            stepper.set_word(Name::Darts, 0, 7);
        }
    });
    let difference = spoilt[0].1.as_deref().unwrap_or_default();
    assert!(difference.starts_with("points at "), "{difference}");
}

/// Changed words close lists of cells to rings: the passes that follow them come to an end, and the run has a difference.
#[test]
fn lists_that_were_closed_to_rings_end() {
    let linked = |stepper: &ExactStepper, passes: usize| {
        let reports = stepper.reports();
        let is_link = |at: usize| reports[at].name == "link darts";
        is_link(passes - 1) && !(0..passes - 1).any(is_link)
    };
    let spoilt = inspect(&parameters(14.0, 8.0), |stepper, passes| {
        if linked(stepper, passes) {
            // The last of a dart's eight words is the number of the next dart, from 1 on: these follow themselves. Some of them
            // stay to the end.
            for dart in 0..20 {
                stepper.set_word(Name::Darts, 8 * u64::from(dart) + 7, dart + 1);
            }
        }
    });
    assert_eq!(spoilt.last().map(|(stage, _)| *stage), Some(Stage::Finish));
    assert!(spoilt.iter().any(|(_, difference)| difference.is_some()));
}

#[test]
fn rows_of_an_inspected_run_lie_where_its_darts_do() {
    let parameters = parameters(14.0, 8.0);
    let history = history(&parameters);
    let domain = parameters.validate().unwrap().rect();
    pollster::block_on(async {
        let stepper = ExactStepper::new(Arc::clone(gpu()), &parameters, history.arrived());
        let mut stepper = stepper.await.unwrap();
        // Far enough that all lists are in use: into the rounds of the first throw.
        while stepper.reports().len() < 14 {
            stepper.step_pass().await.unwrap();
        }
        let rows = stepper.rows().await.unwrap();
        for name in [
            Name::Darts,
            Name::Questions,
            Name::OpenCells,
            Name::LaidPieces,
            Name::Heads,
        ] {
            let table = stepper.table(name, 50).await.unwrap();
            let places = rows.locate(name, &table);
            assert_eq!(places.unplaced(), None);
            let [place] = places.of(0) else {
                panic!("{name:?} has no place");
            };
            match *place {
                RowPlace::Point(point) => assert!(domain.contains(point), "{name:?}"),
                RowPlace::Rect(rect) => {
                    assert!(domain.contains(rect.min) && rect.width() > 0, "{name:?}");
                }
                RowPlace::Link(_) => panic!("{name:?} has links"),
            }
        }
        // A dart's row has its place in the first two columns.
        let table = stepper.table(Name::Darts, 1).await.unwrap();
        let at = Point::new(table.rows[0][0] as i32, table.rows[0][1] as i32);
        assert_eq!(
            rows.locate(Name::Darts, &table).of(0),
            [RowPlace::Point(at)]
        );
        let numbers = rows.locate(
            Name::Counters,
            &stepper.table(Name::Counters, 1).await.unwrap(),
        );
        assert_eq!(numbers.unplaced(), Some(Unplaced::Numbers));
    });
}

/// Returns the width of the widest cell of a list, as it is shown. Cells at the ends of a piece are narrower.
async fn widest(stepper: &ExactStepper, name: Name) -> i32 {
    let rows = stepper.rows().await.unwrap();
    let table = stepper.table(name, 500).await.unwrap();
    let places = rows.locate(name, &table);
    let mut widest = 0;
    for row in 0..table.rows.len() {
        if let [RowPlace::Rect(rect)] = places.of(row) {
            widest = widest.max(rect.width());
        }
    }
    widest
}

/// Cells that are cut for a level are shown twice as wide as those that come of them, and no wider once the lists are swapped.
#[test]
fn open_cells_are_shown_as_wide_as_they_are() {
    let parameters = parameters(14.0, 8.0);
    let history = history(&parameters);
    pollster::block_on(async {
        let stepper = ExactStepper::new(Arc::clone(gpu()), &parameters, history.arrived());
        let mut stepper = stepper.await.unwrap();
        while stepper
            .reports()
            .last()
            .is_none_or(|report| report.name != "cut cells")
        {
            stepper.step_pass().await.unwrap();
        }
        let [cut, next] = [
            widest(&stepper, Name::OpenCells).await,
            widest(&stepper, Name::NextOpenCells).await,
        ];
        assert_eq!([cut, next], [R, R / 2]);
        // The next pass gives the lists each other's names.
        stepper.step_pass().await.unwrap();
        assert_eq!(widest(&stepper, Name::OpenCells).await, R / 2);
    });
}

#[test]
fn an_observer_stops_the_run_between_throws() {
    let parameters = parameters(16.0, 8.0);
    let history = history(&parameters);
    let stopped = Stage::Iterate(3);
    let mut stop = |progress: Progress| {
        if progress.stage == stopped {
            std::ops::ControlFlow::Break(())
        } else {
            std::ops::ControlFlow::Continue(())
        }
    };
    let run = exact_on_gpu(gpu(), &parameters, history.arrived(), &mut stop);
    let stage = stopped;
    assert_eq!(
        pollster::block_on(run).err(),
        Some(GpuError::Sample(SampleError::Cancelled { stage }))
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: tilescope_tests::cases(16), max_shrink_iters: 20, ..ProptestConfig::default() })]
    #[test]
    fn any_exact_tiling_is_equal(
        seed: u64,
        (width, height) in (10.0_f64..60.0, 10.0_f64..60.0),
        leaf in 6.0_f64..40.0,
        side in 10.0_f64..40.0,
        bounded: bool,
        dihedral: bool,
    ) {
        let parameters = Parameters {
            width,
            height,
            seed,
            dihedral,
            boundary: Boundary::of(!bounded),
            pattern: PatternSpec { side, seed, ..PatternSpec::default() },
            ..parameters(10.0, leaf)
        };
        let compared = made(&parameters);
        prop_assert!(compared.is_ok(), "{}", compared.unwrap_err());
    }
}
