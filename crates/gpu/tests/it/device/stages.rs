//! Compares the GPU engine with the sequential one, stage by stage: every sample with its id, origin and fate, every
//! detector, candidate and cell. Needs an adapter; a software one will do.

use std::sync::Arc;

use proptest::prelude::*;
use tilescope_core::windows::CELL_BITS;
use tilescope_core::{
    Boundary, Insertion, Order, Parameters, Pattern, PatternSpec, Search, Sequential, Stage,
    Unobserved,
};
use tilescope_gpu::cpu_reference::{CpuReference, difference};
use tilescope_gpu::layout::Name;
use tilescope_gpu::{PassReport, Stepper};

use crate::support::device::gpu;

/// Runs both engines and compares them after every stage from `first` on.
fn compare(parameters: &Parameters, first: Stage) -> Result<usize, String> {
    let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
    let mut cpu = CpuReference::new(parameters, &pattern).unwrap();
    let mut stepper =
        pollster::block_on(Stepper::new(Arc::clone(gpu()), parameters, &pattern, first))
            .map_err(|error| error.to_string())?;
    let mut compared = 0;
    while let Some(stage) = pollster::block_on(stepper.step()).map_err(|error| error.to_string())? {
        cpu.advance(stage, &mut Unobserved).unwrap();
        let gpu = pollster::block_on(stepper.run()).map_err(|error| error.to_string())?;
        if let Some(what) = cpu.compare(stage, &gpu) {
            return Err(format!("after {stage}: {what}; {parameters:?}"));
        }
        compared += 1;
    }
    assert!(cpu.is_done(), "the sequential engine has more to do");
    Ok(compared)
}

fn assert_equal(parameters: &Parameters) {
    let compared = compare(parameters, Stage::Blocks).unwrap_or_else(|error| panic!("{error}"));
    assert!(compared >= 5, "only {compared} stages were compared");
}

const ORDERS: [Order; 4] = [
    Order::Index,
    Order::Random,
    Order::OwnBlockFirst,
    Order::PhaseGroup,
];

#[test]
fn every_order_insertion_and_boundary_is_equal_at_every_stage() {
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        for insertion in [Insertion::Circumcentre, Insertion::Uniform] {
            for order in ORDERS {
                assert_equal(&Parameters {
                    radius: 0.02,
                    leaf: 9.0,
                    boundary,
                    insertion,
                    order,
                    ..Parameters::default()
                });
            }
        }
    }
}

#[test]
fn every_stage_may_be_the_first_one_of_the_device() {
    for (boundary, insertion) in [
        (Boundary::Periodic, Insertion::Circumcentre),
        (Boundary::Bounded, Insertion::Uniform),
        (Boundary::Bounded, Insertion::Circumcentre),
        (Boundary::Periodic, Insertion::Uniform),
    ] {
        let parameters = Parameters {
            radius: 0.02,
            leaf: 7.0,
            order: Order::Random,
            boundary,
            insertion,
            ..Parameters::default()
        };
        for first in [
            Stage::Tile,
            Stage::Eliminate,
            Stage::Iterate(1),
            Stage::Iterate(2),
            Stage::Finish,
        ] {
            let compared =
                compare(&parameters, first).unwrap_or_else(|error| panic!("{first}: {error}"));
            assert!(compared > 0, "{first}");
        }
    }
}

/// Asserts that exactly the last pass of each stage is reported as ending it.
fn assert_ends(reports: &[PassReport], ended: &[Option<Stage>]) {
    assert_eq!(reports.len(), ended.len());
    for (pass, report) in reports.iter().enumerate() {
        let next = reports.get(pass + 1);
        let ends = next.is_none_or(|next| next.stage != report.stage);
        let expected = ends.then_some(report.stage);
        assert_eq!(ended[pass], expected, "pass {pass}: {report:?}");
    }
}

/// Returns a small run at its beginning.
fn small() -> Stepper {
    let parameters = Parameters {
        radius: 0.02,
        ..Parameters::default()
    };
    let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
    let stepper = Stepper::new(Arc::clone(gpu()), &parameters, &pattern, Stage::Blocks);
    pollster::block_on(stepper).unwrap()
}

#[test]
fn every_pass_tells_what_it_did() {
    let mut stepper = small();
    let mut names = Vec::new();
    let mut ended = Vec::new();
    while let Some(report) = pollster::block_on(stepper.step_pass()).unwrap() {
        let groups = report.workgroups.expect("a pass that was waited for");
        let all: u64 = groups.iter().map(|&n| u64::from(n)).product();
        assert_eq!(report.invocations, Some(64 * all), "{report:?}");
        assert!(!report.bindings.is_empty());
        names.push(report.name);
        ended.push(stepper.ended_stage());
        assert_eq!(names.len(), stepper.reports().len(), "{report:?}");
    }
    assert_ends(stepper.reports(), &ended);
    for name in [
        "blocks",
        "tile",
        "eliminate",
        "candidates",
        "place",
        "gather",
    ] {
        assert!(names.contains(&name), "{names:?}");
    }
    if gpu().report().has_timestamps {
        let timed = stepper
            .reports()
            .iter()
            .filter(|report| report.seconds.is_some());
        assert!(timed.count() > names.len() / 2);
    }
    for (name, length) in stepper.buffers() {
        let table = pollster::block_on(stepper.table(name, 3)).unwrap();
        assert!(table.total > 0 && length > 0, "{name:?}");
        assert!(
            table
                .rows
                .iter()
                .all(|row| row.len() == table.columns.len()),
            "{name:?}"
        );
    }
}

#[test]
fn a_first_stage_beyond_the_end_is_refused() {
    let parameters = Parameters {
        radius: 0.02,
        ..Parameters::default()
    };
    let refused = compare(&parameters, Stage::Iterate(200)).unwrap_err();
    assert!(refused.contains("iterate 200"), "{refused}");
    let refused = compare(&parameters, Stage::Regions).unwrap_err();
    assert!(refused.contains("regions"), "{refused}");
}

#[test]
fn a_run_that_differs_in_one_sample_is_caught() {
    let parameters = Parameters {
        radius: 0.02,
        ..Parameters::default()
    };
    let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
    let cpu = Sequential::new(&parameters, pattern).unwrap();
    let cpu = cpu.finish(&mut Unobserved).unwrap();
    let mut other = cpu.clone();
    assert_eq!(difference(&other, &cpu), None);
    let sample = other.result[other.result.len() / 2] as usize;
    other.samples.points[sample].x ^= 1;
    let found = difference(&other, &cpu).unwrap();
    assert_eq!((found.list, found.index), ("points", Some(sample)));
    assert_ne!(found.device, found.cpu);
    let mut other = cpu.clone();
    other.result.swap(3, 4);
    let found = difference(&other, &cpu).unwrap();
    assert_eq!((found.list, found.index), ("result", Some(3)));
    let mut other = cpu.clone();
    let last = other.result.pop().unwrap();
    let found = difference(&other, &cpu).unwrap();
    assert_eq!(
        (found.index, found.device.as_str()),
        (Some(other.result.len()), "")
    );
    assert_eq!(found.cpu, last.to_string());
    assert!(found.to_string().contains("nothing on the device"));
}

#[test]
fn a_word_set_on_the_device_is_found_by_the_cpu_reference() {
    let parameters = Parameters {
        radius: 0.02,
        ..Parameters::default()
    };
    let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
    let stepper = Stepper::new(Arc::clone(gpu()), &parameters, &pattern, Stage::Blocks);
    let mut stepper = pollster::block_on(stepper).unwrap();
    assert_eq!((stepper.ended_stage(), stepper.restarts()), (None, 0));
    let mut cpu = CpuReference::new(&parameters, &pattern).unwrap();
    while stepper.ended_stage() != Some(Stage::Tile) {
        pollster::block_on(stepper.step_pass()).unwrap().unwrap();
    }
    cpu.advance(Stage::Tile, &mut Unobserved).unwrap();
    let equal = pollster::block_on(stepper.run()).unwrap();
    assert_eq!(cpu.compare(Stage::Tile, &equal), None);
    let starts = pollster::block_on(stepper.table(Name::Starts, u64::MAX)).unwrap();
    let tiled = starts.rows.iter().map(|row| row[0]).max().unwrap();
    let places = pollster::block_on(stepper.table(Name::Places, tiled as u64)).unwrap();
    // Most samples of the frame lie in the halo, which is not compared: one of these lies in the window.
    let found: Vec<_> = (0..places.rows.len())
        .step_by(places.rows.len() / 64)
        .filter_map(|place| {
            let [x, y, fate] = places.rows[place][..] else {
                panic!("{:?}", places.columns);
            };
            let word = |x: i64| x as u32 | (y as u32) << CELL_BITS | (fate as u32) << 30;
            stepper.set_word(Name::Places, place as u64, word(x ^ 1));
            let corrupted = pollster::block_on(stepper.run()).unwrap();
            stepper.set_word(Name::Places, place as u64, word(x));
            cpu.compare(Stage::Tile, &corrupted)
        })
        .collect();
    assert!(!found.is_empty());
    assert!(found.iter().all(|difference| difference.list == "points"));
    let mended = pollster::block_on(stepper.run()).unwrap();
    assert_eq!(cpu.compare(Stage::Tile, &mended), None);
}

/// The list of a cell's samples, the end of which is put where no list is long enough, is read up to the end of the buffer.
#[test]
fn a_cell_whose_samples_have_no_end_does_not_hold_the_device_up() {
    let mut whole = small();
    pollster::block_on(whole.finish()).unwrap();
    let whole = pollster::block_on(whole.run()).unwrap();

    let mut stepper = small();
    while stepper.ended_stage() != Some(Stage::Tile) {
        pollster::block_on(stepper.step_pass()).unwrap().unwrap();
    }
    // The middle of the frame, where cells have samples.
    let starts = pollster::block_on(stepper.table(Name::Starts, u64::MAX)).unwrap();
    let middle = starts.rows.len() as u64 / 2;
    stepper.set_word(Name::Starts, middle, u32::MAX);

    let ended = pollster::block_on(async {
        stepper.finish().await?;
        stepper.run().await
    });
    // The passes find too many samples in a cell, or the samples of the cell are missing.
    assert!(ended.is_err() || ended.is_ok_and(|run| difference(&run, &whole).is_some()));
}

#[test]
fn a_run_that_is_rewound_runs_the_same_passes_to_the_same_result() {
    let mut stepper = small();
    pollster::block_on(stepper.finish()).unwrap();
    let before = pollster::block_on(stepper.run()).unwrap();
    pollster::block_on(stepper.rewind()).unwrap();
    assert!(stepper.reports().is_empty() && stepper.ended_stage().is_none());
    assert_eq!(
        pollster::block_on(stepper.step()).unwrap(),
        Some(Stage::Blocks)
    );
    let blocks = pollster::block_on(stepper.run()).unwrap();
    assert!(difference(&blocks, &before).is_some());
    pollster::block_on(stepper.finish()).unwrap();
    let after = pollster::block_on(stepper.run()).unwrap();
    assert_eq!(difference(&after, &before), None);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: tilescope_tests::cases(40), max_shrink_iters: 20, ..ProptestConfig::default() })]
    #[test]
    fn any_run_is_equal_at_every_stage(
        seed: u64,
        (width, height) in (6.0_f64..60.0, 6.0_f64..60.0),
        leaf in 6.0_f64..80.0,
        order in prop::sample::select(ORDERS.to_vec()),
        uniform: bool,
        bounded: bool,
        bounded_pattern: bool,
        dihedral: bool,
        two_radii in prop::bool::weighted(0.2),
    ) {
        // A bounded pattern holds blocks of less than twice the leaf, enlarged.
        let bounded_pattern = bounded_pattern && leaf < 22.0 && width.min(height) >= 2.0 * leaf;
        let boundary = if bounded { Boundary::Bounded } else { Boundary::Periodic };
        let shortest = if bounded { 6.0 } else { 10.0 };
        let (width, height) = (width.max(shortest), height.max(shortest));
        let parameters = Parameters {
            width,
            height,
            radius: 1.0,
            seed,
            leaf,
            order,
            boundary,
            dihedral,
            insertion: if uniform { Insertion::Uniform } else { Insertion::Circumcentre },
            search: if two_radii { Search::TwoRadii } else { Search::Complete },
            pattern: PatternSpec {
                side: 50.0,
                boundary: if bounded_pattern { Boundary::Bounded } else { Boundary::Periodic },
                seed: 0,
            },
            ..Parameters::default()
        };
        let compared = compare(&parameters, Stage::Blocks);
        prop_assert!(compared.is_ok(), "{}", compared.unwrap_err());
    }
}
