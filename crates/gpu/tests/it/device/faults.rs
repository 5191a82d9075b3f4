//! Device failures become errors that name the cause, and nothing hangs or panics. Needs an adapter; a software one
//! will do.

use std::sync::Arc;

use tilescope_core::{Parameters, Pattern, PatternSpec, Stage, Unobserved, Variant};
use tilescope_gpu::layout::Name;
use tilescope_gpu::{Choice, Gpu, GpuError, GpuSweep, Limits, Options, Stepper, self_test};

use crate::support::device::gpu;

const ROOMY: Limits = Limits {
    max_buffer_size: u64::MAX,
    max_storage_buffer_binding_size: u64::MAX,
    max_compute_workgroups_per_dimension: u32::MAX,
    max_storage_buffers_per_shader_stage: u32::MAX,
};

fn parameters() -> Parameters {
    Parameters {
        radius: 0.01,
        ..Parameters::default()
    }
}

fn pattern() -> Arc<Pattern> {
    Pattern::of_spec(&PatternSpec::default(), &mut Unobserved).unwrap()
}

fn open(limits: Limits) -> Result<Arc<Gpu>, GpuError> {
    let choice = Choice {
        software: true,
        limits: Some(limits),
        ..Choice::default()
    };
    pollster::block_on(Gpu::open(&choice)).map(Arc::new)
}

fn sweep(gpu: &Arc<Gpu>, parameters: &Parameters, options: Options) -> Result<GpuSweep, GpuError> {
    let pattern = pattern();
    pollster::block_on(GpuSweep::new(
        Arc::clone(gpu),
        parameters,
        &pattern,
        options,
    ))
}

fn stepper(gpu: &Arc<Gpu>) -> Result<Stepper, GpuError> {
    let pattern = pattern();
    pollster::block_on(Stepper::new(
        Arc::clone(gpu),
        &parameters(),
        &pattern,
        Stage::Blocks,
    ))
}

fn sample(gpu: &Arc<Gpu>, parameters: &Parameters) -> Result<usize, GpuError> {
    let sweep = sweep(gpu, parameters, Options::default())?;
    let (sampled, _) = pollster::block_on(sweep.finish(&mut Unobserved))?;
    Ok(sampled.points.len())
}

#[test]
fn an_unknown_adapter_is_named_with_those_that_there_are() {
    let choice = Choice {
        name: Some("Voodoo".to_owned()),
        ..Choice::default()
    };
    let error = pollster::block_on(Gpu::open(&choice)).unwrap_err();
    let known = gpu().report().name.clone();
    assert!(matches!(&error, GpuError::NoSuchAdapter { found, .. } if found.contains(&known)));
    assert!(error.to_string().contains("Voodoo") && error.to_string().contains(&known));
}

#[test]
fn a_software_adapter_serves_only_if_it_was_asked_for() {
    if !gpu().report().is_software {
        // If there is a real GPU, it is the fastest adapter.
        assert!(
            !pollster::block_on(Gpu::open(&Choice::default()))
                .unwrap()
                .report()
                .is_software
        );
        return;
    }
    let error = pollster::block_on(Gpu::open(&Choice::default())).unwrap_err();
    assert!(matches!(error, GpuError::SoftwareOnly { .. }), "{error}");
}

#[test]
fn limits_below_what_every_run_needs_are_refused_with_number_and_limit() {
    let error = open(Limits {
        max_storage_buffers_per_shader_stage: 4,
        ..ROOMY
    })
    .unwrap_err();
    let text = error.to_string();
    assert!(
        matches!(
            error,
            GpuError::LimitTooLow {
                value: 4,
                minimum: 8,
                ..
            }
        ),
        "{text}"
    );
    assert!(
        text.contains("maxStorageBuffersPerShaderStage = 4") && text.contains('8'),
        "{text}"
    );
    let error = open(Limits {
        max_compute_workgroups_per_dimension: 100,
        ..ROOMY
    });
    assert!(matches!(
        error,
        Err(GpuError::LimitTooLow { value: 100, .. })
    ));
}

#[test]
fn small_limits_make_small_windows_and_smaller_ones_are_refused() {
    let small = open(Limits {
        max_storage_buffer_binding_size: 300_000,
        ..ROOMY
    })
    .unwrap();
    let windows = sweep(&small, &parameters(), Options::default()).unwrap();
    assert!(windows.window_side() < 100);
    assert_eq!(sample(&small, &parameters()), sample(gpu(), &parameters()));
    let error = stepper(&small).err().unwrap();
    assert!(
        matches!(error, GpuError::NotInOneGo { needed: 100, .. }),
        "{error}"
    );
    let tiny = open(Limits {
        max_buffer_size: 20_000,
        ..ROOMY
    })
    .unwrap();
    let error = sample(&tiny, &parameters()).unwrap_err();
    let text = error.to_string();
    assert!(
        matches!(
            error,
            GpuError::TooLittleMemory {
                allowed: 20_000,
                ..
            }
        ),
        "{text}"
    );
    assert!(
        text.contains("20000") && text.contains("8 x 8 cells"),
        "{text}"
    );
}

#[test]
#[ignore = "takes long: tests/run --slow runs it"]
fn windows_that_need_more_than_the_first_become_smaller() {
    // Halos of one cell are doubled in nearly every window, and the limits allow only the first.
    let parameters = Parameters {
        radius: 0.006,
        leaf: 6.0,
        order: tilescope_core::Order::Random,
        boundary: tilescope_core::Boundary::Bounded,
        ..Parameters::default()
    };
    let expected = sample(gpu(), &parameters).unwrap();
    for bytes in tilescope_tests::some([230_000, 260_000, 320_000]) {
        let small = open(Limits {
            max_storage_buffer_binding_size: bytes,
            ..ROOMY
        })
        .unwrap();
        let options = Options {
            halo: Some(1),
            ..Options::default()
        };
        let sweep = sweep(&small, &parameters, options).unwrap();
        assert!(sweep.window_side() < 100);
        let (sampled, _) = pollster::block_on(sweep.finish(&mut Unobserved)).unwrap();
        assert_eq!(sampled.points.len(), expected);
    }
}

#[test]
fn too_little_memory_is_refused_with_the_number() {
    let options = Options {
        memory: Some(1_000),
        ..Options::default()
    };
    let error = sweep(gpu(), &parameters(), options).err().unwrap();
    assert!(
        matches!(error, GpuError::TooLittleMemory { allowed: 1_000, .. }),
        "{error}"
    );
}

#[test]
fn a_device_that_goes_away_is_reported_as_lost_from_then_on() {
    let lost = open(ROOMY).unwrap();
    assert!(sample(&lost, &parameters()).is_ok());
    lost.device().0.destroy();
    for _ in 0..2 {
        let error = sample(&lost, &parameters()).unwrap_err();
        assert!(matches!(error, GpuError::DeviceLost { .. }), "{error}");
        assert!(error.of_device().is_ok());
    }
    let error = pollster::block_on(self_test(&lost)).unwrap_err();
    assert!(matches!(error, GpuError::DeviceLost { .. }), "{error}");
}

#[test]
fn a_device_that_goes_away_in_the_middle_of_a_run_ends_it_with_an_error() {
    let lost = open(ROOMY).unwrap();
    let mut stepper = stepper(&lost).unwrap();
    pollster::block_on(stepper.step()).unwrap();
    lost.device().0.destroy();
    let error = pollster::block_on(stepper.finish()).unwrap_err();
    assert!(matches!(error, GpuError::DeviceLost { .. }), "{error}");
}

#[test]
fn algorithm_4_as_printed_is_the_sequential_engines() {
    let printed = Parameters {
        variant: Variant::AsPrinted,
        ..parameters()
    };
    let error = sample(gpu(), &printed).unwrap_err();
    assert!(error.of_device().is_err());
}

async fn stepper_table(stepper: &Stepper, name: Name) -> Vec<Vec<i64>> {
    stepper.table(name, u64::MAX).await.unwrap().rows
}

#[test]
fn a_sample_changed_on_the_device_is_caught() {
    let mut changed = stepper(gpu()).unwrap();
    while pollster::block_on(changed.step()).unwrap() != Some(Stage::Tile) {}
    // In the middle of the domain, deep in a block, where the moved sample is in no conflict: one unit to the right.
    let starts = pollster::block_on(stepper_table(&changed, Name::Starts));
    // The frame is square: this is the middle of its middle row.
    let middle = starts.len() / 2 + starts.len().isqrt() / 2;
    let first = starts[middle][0] as usize;
    let places = pollster::block_on(stepper_table(&changed, Name::Places));
    let is_kept = |row: &Vec<i64>| row[2] == 1 && row[0] > 0 && row[0] < 30_000;
    let index = first + places[first..].iter().position(is_kept).unwrap();
    let chosen = &places[index];
    let word = (1 << 30 | chosen[1] << 15 | (chosen[0] + 1)) as u32;
    changed.set_word(Name::Places, index as u64, word);
    pollster::block_on(changed.finish()).unwrap();
    let changed = pollster::block_on(changed.run()).unwrap();
    let mut right = stepper(gpu()).unwrap();
    pollster::block_on(right.finish()).unwrap();
    let right = pollster::block_on(right.run()).unwrap();
    let cpu = tilescope_core::sample(&parameters(), &mut Unobserved).unwrap();
    assert!(right.points() == cpu.points());
    assert!(changed.points() != cpu.points());
}
