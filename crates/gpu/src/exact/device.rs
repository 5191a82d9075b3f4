//! Exact tilings with too little room. Needs an adapter; a software one will do.

use pollster::block_on;
use tilescope_core::{PatternSpec, Unobserved};

use super::*;
use crate::adapter::{Choice, Limits};

fn gpu() -> Arc<Gpu> {
    let choice = Choice {
        software: true,
        ..Choice::default()
    };
    let gpu = block_on(Gpu::open(&choice));
    Arc::new(gpu.expect("this test needs a GPU adapter; a software one (lavapipe) will do"))
}

fn parameters(leaf: f64) -> (Parameters, PatternArrivals) {
    let parameters = Parameters {
        radius: 0.02,
        leaf,
        pattern: PatternSpec {
            side: 30.0,
            ..PatternSpec::default()
        },
        ..Parameters::default()
    };
    let arrived = PatternArrivals::of_spec(&parameters.pattern, &mut Unobserved);
    (parameters, arrived.unwrap())
}

/// Returns the samples of an attempt with so much room, or the room that it needs.
fn attempt(
    gpu: &Arc<Gpu>,
    (parameters, arrived): &(Parameters, PatternArrivals),
    room: DartRoom,
) -> Result<Vec<Point>, DartRoom> {
    let plan = ExactPlan::new(parameters, arrived, room).unwrap();
    block_on(async {
        let mut work = ExactWork::new(gpu, plan, arrived, Recording::Nothing)
            .await
            .unwrap();
        match work.run(&mut Unobserved).await.unwrap() {
            Some(needed) => Err(needed),
            None => Ok(work.points().await.unwrap()),
        }
    })
}

/// Lists that are too short end an attempt, whichever list it is; with the room that is asked for next the run comes to its end.
/// A list that suffices keeps its room.
#[test]
fn too_little_room_is_noticed_and_made_up_for() {
    let gpu = gpu();
    let run = parameters(8.0);
    let room = DartRoom::expected(&run.0, &run.1).unwrap();
    let expected = attempt(&gpu, &run, room).expect("the expected room suffices");

    // 99 darts are fewer than the samples that are laid down. In 2,500 those fit, but not the darts that are thrown as well.
    for mut small in [
        DartRoom { darts: 99, ..room },
        DartRoom {
            darts: 2500,
            ..room
        },
        DartRoom { cells: 9, ..room },
    ] {
        let (is_short_of_darts, mut tries) = (small.darts < room.darts, 0);
        let found = loop {
            match attempt(&gpu, &run, small) {
                Err(needed) => small = needed,
                Ok(found) => break found,
            }
            tries += 1;
        };
        assert!(tries > 0 && tries < MAX_TRIES, "{small:?} after {tries}");
        assert_eq!(found, expected);
        if is_short_of_darts {
            assert_eq!(small.cells, room.cells);
        } else {
            assert_eq!(small.darts, room.darts);
        }
    }
}

#[test]
fn a_run_that_does_not_fit_is_refused_by_the_name_of_the_limit() {
    let (parameters, arrived) = parameters(20.0);
    let room = DartRoom::expected(&parameters, &arrived).unwrap();
    let plan = ExactPlan::new(&parameters, &arrived, room).unwrap();
    let roomy = Limits {
        max_buffer_size: u64::MAX,
        max_storage_buffer_binding_size: u64::MAX,
        max_compute_workgroups_per_dimension: u32::MAX,
        max_storage_buffers_per_shader_stage: u32::MAX,
    };
    assert_eq!(plan.check(&roomy, u64::MAX), Ok(()));

    // The refusals name different limits: that of one binding, and that of all buffers together.
    let tight = Limits {
        max_storage_buffer_binding_size: 100_000,
        ..roomy
    };
    let refused = plan.check(&tight, u64::MAX).unwrap_err().to_string();
    assert!(
        refused.contains("maxStorageBufferBindingSize allows 100000"),
        "{refused}"
    );
    let refused = room.check(&parameters, &tight).unwrap_err().to_string();
    assert!(refused.contains("maxStorageBufferBindingSize"), "{refused}");
    let refused = plan.check(&roomy, 100_000).unwrap_err().to_string();
    assert!(
        refused.contains("the memory to be used allows 100000"),
        "{refused}"
    );
}
