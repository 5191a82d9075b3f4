//! Compares the GPU engine's results with the parallel engine's: sets of up to 200,000 samples, in one window and in
//! many, with halos so narrow that windows must be recomputed. Needs an adapter; a software one will do.

use std::ops::ControlFlow;
use std::sync::Arc;

use proptest::prelude::*;
use tilescope_core::{
    Boundary, Insertion, Order, Parameters, Pattern, PatternSpec, Progress, SampleError, Stage,
    Sweep, Unobserved,
};
use tilescope_gpu::{Gpu, GpuError, GpuSweep, Options};

use crate::support::device::{checked_gpu, gpu};
use tilescope_tests::some;

fn sweep(parameters: &Parameters, options: Options) -> Result<GpuSweep, GpuError> {
    sweep_on(gpu(), parameters, options)
}

fn sweep_on(
    gpu: &Arc<Gpu>,
    parameters: &Parameters,
    options: Options,
) -> Result<GpuSweep, GpuError> {
    let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
    let gpu = Arc::clone(gpu);
    pollster::block_on(GpuSweep::new(gpu, parameters, &pattern, options))
}

/// Fails unless the device gives the parallel engine's samples, sources and counts, with trusted shaders and with checked ones.
/// Returns the side of a window.
fn compare(parameters: &Parameters, options: Options) -> Result<u32, String> {
    let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
    let cpu = Sweep::new(parameters, &pattern, options.sources).unwrap();
    let (cpu, cpu_summary) = cpu.finish(&mut Unobserved).unwrap();
    let mut side = 0;
    for (shaders, gpu) in [("trusted", gpu()), ("checked", checked_gpu())] {
        let sweep = sweep_on(gpu, parameters, options).map_err(|error| error.to_string())?;
        side = sweep.window_side();
        let (gpu, gpu_summary) =
            pollster::block_on(sweep.finish(&mut Unobserved)).map_err(|error| error.to_string())?;
        let differs = |what: &str| {
            Err(format!(
                "{what} differ: {shaders}, {parameters:?}, {options:?}"
            ))
        };
        if gpu.points != cpu.points {
            return differs("points");
        }
        if gpu.sources != cpu.sources {
            return differs("sources");
        }
        if gpu_summary != cpu_summary {
            return differs(&format!("{gpu_summary:?} and {cpu_summary:?}"));
        }
    }
    Ok(side)
}

fn assert_equal(parameters: &Parameters, options: Options) -> u32 {
    compare(parameters, options).unwrap_or_else(|error| panic!("{error}"))
}

const SOURCES: Options = Options {
    memory: None,
    sources: true,
    timed: false,
    halo: None,
};

#[test]
#[ignore = "takes long: tests/run --slow runs it"]
fn two_hundred_thousand_samples_are_equal() {
    for (leaf, insertion, order) in [
        (6.0, Insertion::Circumcentre, Order::Index),
        (20.0, Insertion::Uniform, Order::Random),
        (40.0, Insertion::Circumcentre, Order::OwnBlockFirst),
        (80.0, Insertion::Circumcentre, Order::PhaseGroup),
    ] {
        let parameters = Parameters {
            radius: 0.001_86,
            leaf,
            insertion,
            order,
            ..Parameters::default()
        };
        assert_equal(&parameters, Options::default());
    }
}

#[test]
fn many_windows_give_what_one_gives() {
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        for insertion in [Insertion::Circumcentre, Insertion::Uniform] {
            let parameters = Parameters {
                width: 1.0,
                height: 0.8,
                radius: 0.004,
                leaf: 9.0,
                boundary,
                insertion,
                ..Parameters::default()
            };
            let few = Options {
                memory: Some(2_500_000),
                ..SOURCES
            };
            let side = assert_equal(&parameters, few);
            assert!(side < 200, "one window of {side} cells holds everything");
        }
    }
}

#[test]
fn narrow_halos_are_repaired() {
    use Insertion::{Circumcentre, Uniform};
    let all = [
        (Circumcentre, 1),
        (Uniform, 2),
        (Circumcentre, 5),
        (Uniform, 1),
        (Circumcentre, 2),
        (Uniform, 5),
    ];
    for (insertion, halo) in some(all) {
        let parameters = Parameters {
            radius: 0.005,
            leaf: 7.0,
            order: Order::Random,
            insertion,
            ..Parameters::default()
        };
        let narrow = Options {
            memory: Some(2_000_000),
            halo: Some(halo),
            ..SOURCES
        };
        assert_equal(&parameters, narrow);
    }
}

#[test]
fn a_run_goes_on_where_another_engine_stopped() {
    let parameters = Parameters {
        radius: 0.004,
        ..Parameters::default()
    };
    let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
    let options = Options {
        memory: Some(2_500_000),
        ..Options::default()
    };
    let mut first = sweep(&parameters, options).unwrap();
    let mut points = pollster::block_on(first.step(&mut Unobserved))
        .unwrap()
        .unwrap()
        .points;
    let (done, rows) = first.rows();
    assert!(done > 0 && done < rows);
    let mut second = Sweep::new(&parameters, &pattern, false).unwrap();
    second.restore(&first.state());
    while let Some(band) = second.step(&mut Unobserved).unwrap() {
        points.extend(band.points);
    }
    let whole = Sweep::new(&parameters, &pattern, false).unwrap();
    let (whole, summary) = whole.finish(&mut Unobserved).unwrap();
    assert!(points == whole.points);
    assert_eq!(second.summary(), summary);
}

#[test]
fn a_run_can_be_cancelled_between_windows_and_within_one() {
    let parameters = Parameters {
        radius: 0.004,
        ..Parameters::default()
    };
    for memory in [Some(2_500_000), None] {
        let options = Options {
            memory,
            ..Options::default()
        };
        let mut seen = 0;
        // Before the band, before its first window, then whenever the host reads counters.
        let mut stop = |_: Progress| {
            seen += 1;
            if seen < 4 {
                ControlFlow::Continue(())
            } else {
                ControlFlow::Break(())
            }
        };
        let sweep = sweep(&parameters, options).unwrap();
        let cancelled = pollster::block_on(sweep.finish(&mut stop));
        let stage = Stage::Regions;
        assert_eq!(
            cancelled.unwrap_err(),
            GpuError::Sample(SampleError::Cancelled { stage })
        );
    }
}

#[test]
#[ignore = "takes long: tests/run --slow runs it"]
fn windows_of_many_blocks_after_windows_of_more_are_equal() {
    // More pieces of blocks than a row of workgroups has, and buffers that hold more from the window before.
    let parameters = Parameters {
        width: 1.9,
        height: 0.8,
        radius: 0.002,
        leaf: 6.0,
        seed: 2,
        ..Parameters::default()
    };
    let options = Options {
        memory: Some(12_000_000),
        ..SOURCES
    };
    let side = assert_equal(&parameters, options);
    assert!((300..500).contains(&side), "{side}");
}

#[test]
#[ignore = "takes long: tests/run --slow runs it"]
fn the_longest_domains_are_equal() {
    for (width, height, boundary) in some([
        (65_532.0, 6.0, Boundary::Bounded),
        (32_800.0, 10.0, Boundary::Periodic),
    ]) {
        let parameters = Parameters {
            width,
            height,
            radius: 1.0,
            boundary,
            ..Parameters::default()
        };
        assert_equal(&parameters, Options::default());
    }
}

#[test]
fn dense_patterns_make_equal_sets() {
    // A hexagonal pattern, two thirds denser than usual.
    let positions: Vec<[f64; 2]> = (0..46)
        .flat_map(|row| (0..40).map(move |column| (column, row)))
        .map(|(column, row)| {
            let shift = f64::from(row % 2) / 2.0;
            [(f64::from(column) + shift) / 40.0, f64::from(row) / 46.0]
        })
        .collect();
    let pattern = Pattern::from_positions(&positions, [1.0; 2], 0.0249, Boundary::Periodic);
    let pattern = Arc::new(pattern.unwrap());
    let parameters = Parameters {
        radius: 0.005,
        ..Parameters::default()
    };
    let cpu = Sweep::new(&parameters, &pattern, false).unwrap();
    let (cpu, _) = cpu.finish(&mut Unobserved).unwrap();
    let gpu = GpuSweep::new(Arc::clone(gpu()), &parameters, &pattern, Options::default());
    let gpu = pollster::block_on(async { gpu.await?.finish(&mut Unobserved).await });
    assert!(cpu.points.len() > 40_000);
    assert!(gpu.unwrap().0.points == cpu.points);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: tilescope_tests::cases(24), max_shrink_iters: 20, ..ProptestConfig::default() })]
    #[test]
    fn any_run_is_equal_in_any_windows(
        seed: u64,
        (width, height) in (6.0_f64..220.0, 6.0_f64..220.0),
        leaf in 6.0_f64..80.0,
        order in prop::sample::select(vec![Order::Index, Order::Random, Order::OwnBlockFirst, Order::PhaseGroup]),
        uniform: bool,
        bounded: bool,
        dihedral: bool,
        halo in 1_u32..24,
        megabytes in 3_u64..9,
    ) {
        let shortest = if bounded { 6.0 } else { 10.0 };
        let parameters = Parameters {
            width: width.max(shortest),
            height: height.max(shortest),
            radius: 1.0,
            seed,
            leaf,
            order,
            dihedral,
            boundary: if bounded { Boundary::Bounded } else { Boundary::Periodic },
            insertion: if uniform { Insertion::Uniform } else { Insertion::Circumcentre },
            pattern: PatternSpec { side: 50.0, ..PatternSpec::default() },
            ..Parameters::default()
        };
        let options = Options { memory: Some(megabytes * 1_000_000), halo: Some(halo), ..SOURCES };
        let compared = compare(&parameters, options);
        prop_assert!(compared.is_ok(), "{}", compared.unwrap_err());
    }
}
