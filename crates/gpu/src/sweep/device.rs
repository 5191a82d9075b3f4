//! Windows with too little room and too little memory. Needs an adapter; a software one will do.

use super::*;
use crate::adapter::Choice;
use crate::fit::MAX_TRIES;
use crate::plan::{Room, WindowPlan};
use pollster::block_on;
use tilescope_core::{Insertion, Unobserved};

fn sweep(insertion: Insertion) -> GpuSweep {
    let parameters = Parameters {
        radius: 0.01,
        leaf: 8.0,
        insertion,
        ..Parameters::default()
    };
    let choice = Choice {
        software: true,
        ..Choice::default()
    };
    let gpu = block_on(Gpu::open(&choice));
    let gpu = gpu.expect("this test needs a GPU adapter; a software one (lavapipe) will do");
    let pattern = Pattern::of_spec(&parameters.pattern, &mut Unobserved).unwrap();
    let sweep = GpuSweep::new(Arc::new(gpu), &parameters, &pattern, Options::default());
    block_on(sweep).unwrap()
}

#[test]
fn too_little_room_is_noticed_and_made_up_for() {
    for insertion in [Insertion::Circumcentre, Insertion::Uniform] {
        let mut sweep = sweep(insertion);
        let window = sweep.setup.domain.rect();
        let plan = WindowPlan::new(&sweep.setup, &window, HALO, None).unwrap();
        let room = plan.room();
        let expected =
            block_on(sweep.attempt(&window, Allowance::new(HALO), &mut Unobserved)).unwrap();
        assert!(expected.is_ok());

        // In each of these one list has far less room than it needs.
        let uniform = insertion == Insertion::Uniform;
        let mut rooms = vec![
            Room { tiled: 99, ..room },
            Room { unsure: 9, ..room },
            Room {
                proposals: 9,
                ..room
            },
            Room { result: 99, ..room },
        ];
        // Each insertion has a list of its own: uniform insertion one of active cells, the other one of open cells.
        rooms.push(if uniform {
            Room { active: 9, ..room }
        } else {
            Room { open: 9, ..room }
        });

        for small in rooms {
            let mut allowance = Allowance::new(HALO);
            allowance.room = Some(small);
            // More room is enough: the halo must not grow.
            let max_halo = 0;
            let mut tries = 0;
            let found = loop {
                match block_on(sweep.attempt(&window, allowance, &mut Unobserved)).unwrap() {
                    Err(shortage @ Shortage::Room(_)) => {
                        allowance.grow(shortage, max_halo).unwrap();
                    }
                    other => break other,
                }
                tries += 1;
            };
            assert!(
                tries > 0 && tries < MAX_TRIES,
                "{small:?} took {tries} tries"
            );
            assert!(found == expected, "{small:?}");
        }
    }
}

#[test]
fn memory_that_is_not_there_makes_smaller_windows() {
    let mut sweep = sweep(Insertion::Circumcentre);
    let expected = block_on(sweep.step(&mut Unobserved)).unwrap();
    sweep.restore(&SweepState {
        rows: 0,
        count: 0,
        counts: WindowCounts::default(),
    });
    // As if other programs had used the rest. The bytes are chosen so that a part of the domain fits, and not all of
    // it.
    sweep.memory = 600_000;
    let side = sweep.side;
    let (mut points, mut bands) = (Vec::new(), 0);
    while let Some(band) = block_on(sweep.step(&mut Unobserved)).unwrap() {
        bands += 1;
        points.extend(band.points);
    }
    assert!(
        sweep.rows().0 > 0 && side == sweep.side,
        "the next run may have more"
    );
    assert!(bands > 1);
    assert!(Some(points) == expected.map(|band| band.points));
}
