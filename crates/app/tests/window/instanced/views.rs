//! Where samples are drawn: positions, images across borders, what the view leaves out, crowds.

use tilescope_canvas::instanced::{Limits, PaintOptions, Symbols};
use tilescope_core::{Boundary, Point, R};
use tilescope_drawing::camera::Camera;
use tilescope_drawing::look::{SampleLook, Symbol};

use super::probe::{Probe, RED, at, crowd, domain, probe, shoot, shoot_now};

#[test]
fn positions_are_exact_far_from_the_origin() {
    let domain = domain([65_000.0, 10.0], Boundary::Bounded);
    let units = Point::new(60_000 * R + 12_345, 5 * R + 777);
    for scale in [2_000.0, 4_000.0] {
        let camera = Camera {
            center: [60_000.375, 5.023_712_158].into(),
            scale,
        };
        let mut harness = probe(&domain, &[units], camera);
        let centroid = shoot(&mut harness).centroid();
        let position = [units.x, units.y].map(|u| f64::from(u) / f64::from(R));
        let rect = Probe::rect();
        let expected = [
            f64::from(rect.center().x) + (position[0] - camera.center[0]) * scale,
            f64::from(rect.center().y) - (position[1] - camera.center[1]) * scale,
        ];
        for k in 0..2 {
            let off = (centroid[k] - expected[k]).abs();
            assert!(off < 0.05, "{off} pixels at {scale}");
        }
        let single = position[0] as f32 - camera.center[0] as f32;
        let in_single = f64::from(rect.center().x) + f64::from(single) * scale;
        let off = (in_single - expected[0]).abs();
        assert!(off > 1.0, "single precision would be {off} pixels off");
    }
}

#[test]
fn images_appear_across_a_periodic_border_and_only_there() {
    let camera = Camera {
        center: [0.0, 20.0].into(),
        scale: 20.0,
    };
    let sample = at(38.0, 20.5);
    for (boundary, images) in [
        (Boundary::Periodic, true),
        (Boundary::Periodic, false),
        (Boundary::Bounded, true),
    ] {
        let mut harness = probe(&domain([40.0; 2], boundary), &[sample], camera);
        let options = PaintOptions::symbols(Symbols::ALL, camera.scale);
        harness.state_mut().layers = vec![options.with_images(images)];
        let picture = shoot(&mut harness);
        let pos = camera.screen_from_domain(Probe::rect(), [-2.0, 20.5]);
        if boundary == Boundary::Periodic && images {
            assert_eq!(picture.at_pos(pos), RED.to_array());
            assert!((picture.centroid()[0] - f64::from(pos.x)).abs() < 0.02);
        } else {
            assert_eq!(picture.marked(), 0);
        }
    }
}

#[test]
fn samples_outside_the_view_are_skipped_without_visible_change() {
    let domain = domain([100.0; 2], Boundary::Periodic);
    let points = crowd(20_000, 100.0);
    for center in [[50.0, 50.0], [0.5, 99.0], [33.0, 0.0]] {
        let camera = Camera {
            center: center.into(),
            scale: 15.0,
        };
        let mut harness = probe(&domain, &points, camera);
        let look = |id: u32| SampleLook::new(Symbol::Dot, RED).with_disk(id.is_multiple_of(7));
        let canvas = &mut harness.state_mut().canvas;
        canvas.set_looks(2, look);
        // A cached picture is rounded once more than one drawn directly.
        canvas.set_limits(Limits {
            still: usize::MAX,
            ..canvas.limits()
        });
        let mut shot = |cull: bool| {
            let layers = [
                PaintOptions::disks(),
                PaintOptions::symbols(Symbols::ALL, camera.scale),
            ];
            let layers = layers.map(|options| PaintOptions { cull, ..options }.with_images(true));
            harness.state_mut().layers = layers.to_vec();
            shoot(&mut harness)
        };
        let (part, whole) = (shot(true), shot(false));
        assert!(part.marked() > 4_000);
        assert_eq!(part.difference(&whole), 0);
    }
}

#[test]
fn a_moving_camera_sees_a_subset_and_a_resting_one_all() {
    let domain = domain([100.0; 2], Boundary::Bounded);
    let camera = Camera {
        center: [50.0; 2].into(),
        scale: 2.0,
    };
    let mut harness = probe(&domain, &crowd(20_000, 100.0), camera);
    harness.state_mut().canvas.set_limits(Limits {
        moving_symbols: 1_000,
        ..Limits::SOFTWARE
    });
    let rest = shoot(&mut harness);
    assert!(!harness.state().due);
    harness.state_mut().camera.center[0] += 0.5;
    harness.step();
    assert!(harness.state().due, "another frame is due");
    let moving = shoot_now(&mut harness);
    assert!(moving.marked() * 4 < rest.marked());
    // Samples 4 r from each other, of which there are about 0.7 in 16 squared r.
    assert!(moving.marked() > 400 * 3);
    harness.step();
    assert!(!harness.state().due);
    let after = shoot_now(&mut harness);
    assert!(after.marked() * 10 > rest.marked() * 9);
    harness.state_mut().camera.center[0] -= 0.5;
    assert_eq!(shoot(&mut harness).difference(&rest), 0);
}

#[test]
fn a_crowd_becomes_points_of_one_pixel() {
    let domain = domain([400.0; 2], Boundary::Bounded);
    let camera = Camera {
        center: [200.0; 2].into(),
        scale: 0.6,
    };
    let points: Vec<Point> = crowd(400_000, 400.0);
    let mut harness = probe(&domain, &points, camera);
    let radii = |id: u32| {
        let point = points[id as usize];
        [point.x, point.y].map(|units| f64::from(units) / f64::from(R))
    };
    let is_central = |&id: &u32| radii(id).iter().all(|x| (x - 200.0).abs() < 5.0);
    let chosen = (0..400_000).find(is_central).expect("a sample there");
    let shown = |id| {
        if id == chosen {
            SampleLook::new(Symbol::Diamond, RED)
        } else {
            SampleLook::HIDDEN
        }
    };
    harness.state_mut().canvas.set_looks(2, shown);
    harness.state_mut().camera.center = radii(chosen).into();
    let picture = shoot(&mut harness);
    assert_eq!(picture.marked(), 1);
    let centroid = picture.centroid();
    let pos = Probe::rect().center();
    assert!((centroid[0] - f64::from(pos.x)).abs() <= 0.6);
    assert!((centroid[1] - f64::from(pos.y)).abs() <= 0.6);
    let red = picture.marks().map(|mark| mark.2).fold(0.0, f64::max);
    assert!(
        (50.0..56.0).contains(&red),
        "a quarter, where many share a pixel: {red}"
    );
}

#[test]
fn a_beginning_is_drawn_whole_if_its_levels_are_beginnings() {
    let domain = domain([100.0; 2], Boundary::Bounded);
    let camera = Camera {
        center: [50.0; 2].into(),
        scale: 2.0,
    };
    let points = crowd(4_000, 100.0);
    let first = |count: usize, ends: &[usize]| {
        let mut harness = probe(&domain, &points[..count], camera);
        let state = harness.state_mut();
        if !ends.is_empty() {
            let canvas = &mut state.canvas;
            let made = canvas.set_points(2, &points, &domain, ends);
            made.expect("few points");
            canvas.set_looks(2, |_| SampleLook::new(Symbol::Dot, RED));
        }
        state.layers = state
            .layers
            .iter()
            .map(|it| it.with_prefix(900, 1.0))
            .collect();
        shoot(&mut harness)
    };
    let alone = first(900, &[]);
    assert!(alone.marked() > 900);
    // Where samples lie over each other, their order leaves a trace in few pixels.
    let beginning = first(4_000, &[63, 250, 1_000, 4_000]);
    assert!(beginning.difference(&alone) * 100 < alone.marked());
    // The control: levels by place alone leave out dots of finer levels.
    let by_place = first(4_000, &[]);
    assert!(by_place.marked() * 10 < alone.marked() * 9);
}
