//! How samples are drawn: colours, symbols, disks, and changes of them.

use egui::{Color32, pos2, vec2};
use tilescope_canvas::instanced::{Limits, PaintOptions, Symbols};
use tilescope_core::Boundary;
use tilescope_drawing::camera::Camera;
use tilescope_drawing::look::{SampleLook, Symbol};

use super::probe::{GROUND, Probe, RED, at, crowd, domain, probe, shoot};

#[test]
fn a_sample_is_at_its_pixel_in_the_colour_that_egui_paints() {
    let domain = domain([20.0; 2], Boundary::Bounded);
    let camera = Camera {
        center: [8.0, 9.0].into(),
        scale: 20.0,
    };
    let position = [10.0, 12.0];
    let mut harness = probe(&domain, &[at(position[0], position[1])], camera);
    for color in [RED, Color32::from_rgba_unmultiplied(40, 200, 250, 120)] {
        harness.state_mut().patch = color;
        let version = u64::from(color.a());
        let canvas = &mut harness.state_mut().canvas;
        assert_eq!(
            canvas.set_looks(version, |_| SampleLook::new(Symbol::Dot, color)),
            usize::from(color != RED)
        );
        let picture = shoot(&mut harness);
        let pos = camera.screen_from_domain(Probe::rect(), position);
        assert_eq!(picture.at_pos(pos), picture.at(5.0, 5.0));
        assert_eq!(picture.at_pos(pos + vec2(0.0, 30.0)), GROUND.to_array());
        let centroid = picture.centroid();
        assert!((centroid[0] - f64::from(pos.x)).abs() < 0.02);
        assert!((centroid[1] - f64::from(pos.y)).abs() < 0.02);
    }
    assert_eq!(
        shoot(&mut harness).at(2.0, 100.0),
        GROUND.to_array(),
        "clipped"
    );
}

#[test]
fn a_disks_ring_is_r_from_its_sample_and_its_fill_is_faint() {
    let domain = domain([20.0; 2], Boundary::Bounded);
    let camera = Camera {
        center: [10.0; 2].into(),
        scale: 60.0,
    };
    let mut harness = probe(&domain, &[at(10.0, 10.0)], camera);
    harness.state_mut().layers = vec![PaintOptions::disks()];
    assert_eq!(shoot(&mut harness).marked(), 0, "its look shows no disk");
    let look = SampleLook::new(Symbol::Dot, RED).with_disk(true);
    assert_eq!(harness.state_mut().canvas.change_looks(2, &[(0, look)]), 1);
    let picture = shoot(&mut harness);
    let middle = camera.screen_from_domain(Probe::rect(), [10.0; 2]);
    let red = |distance: f32, angle: f32| {
        picture.at_pos(middle + distance * egui::Vec2::angled(angle))[0]
    };
    for angle in [0.1, 0.9, 2.0, 3.3, 5.1] {
        let along: Vec<u8> = (0..90).map(|d| red(d as f32, angle)).collect();
        let peak = (0..90).max_by_key(|&d| along[d]).expect("ninety");
        assert!((59..=61).contains(&peak), "{peak} at {angle}");
        assert!(along[peak] > 60);
        assert!(along[30] > GROUND.r() && along[30] < 60);
        assert_eq!(along[65], GROUND.r());
    }
    harness.state_mut().camera.scale = 0.9;
    assert_eq!(
        shoot(&mut harness).marked(),
        0,
        "a disk under a pixel is not drawn"
    );
}

#[test]
fn a_new_look_of_one_sample_changes_its_pixels_only() {
    let domain = domain([100.0; 2], Boundary::Bounded);
    let camera = Camera {
        center: [50.0; 2].into(),
        scale: 10.0,
    };
    let mut points = crowd(20_000, 45.0);
    points.push(at(50.0, 50.0));
    let id = points.len() as u32 - 1;
    let mut harness = probe(&domain, &points, camera);
    let before = shoot(&mut harness);
    let green = SampleLook::new(Symbol::Diamond, Color32::from_rgb(10, 240, 90));
    let changes = [(id, green), (id + 1, green)];
    assert_eq!(harness.state_mut().canvas.change_looks(2, &changes), 1);
    let after = shoot(&mut harness);
    let pos = camera.screen_from_domain(Probe::rect(), [50.0; 2]);
    assert_eq!(after.at_pos(pos), [10, 240, 90, 255]);
    let far = |k: usize| {
        let pixel = pos2(
            (k % after.width) as f32 + 0.5,
            (k / after.width) as f32 + 0.5,
        );
        pixel.distance(pos) > 5.0
    };
    let changed = |k: &usize| before.pixels[*k] != after.pixels[*k];
    let changes: Vec<usize> = (0..after.pixels.len()).filter(changed).collect();
    assert!(changes.len() >= 5 && !changes.into_iter().any(far));
    harness
        .state_mut()
        .canvas
        .set_looks(3, |_| SampleLook::new(Symbol::Dot, RED));
    assert_eq!(shoot(&mut harness).difference(&before), 0);
}

#[test]
fn every_symbol_has_its_shape_and_outlines_lie_around() {
    let domain = domain([20.0; 2], Boundary::Bounded);
    let camera = Camera {
        center: [10.0; 2].into(),
        scale: 40.0,
    };
    let mut harness = probe(&domain, &[at(10.0, 10.0)], camera);
    let pos = camera.screen_from_domain(Probe::rect(), [10.0; 2]);
    let mut version = 1;
    let mut shot = |look: SampleLook, options: PaintOptions| {
        version += 1;
        harness.state_mut().canvas.set_looks(version, |_| look);
        harness.state_mut().layers = vec![options];
        shoot(&mut harness)
    };
    let all = PaintOptions::symbols(Symbols::ALL, camera.scale);
    let mut areas = Vec::new();
    for symbol in [Symbol::Dot, Symbol::Cross, Symbol::Diamond, Symbol::Ring] {
        let picture = shot(SampleLook::new(symbol, RED), all);
        let hollow = symbol == Symbol::Cross;
        assert_eq!(picture.at_pos(pos) == RED.to_array(), !hollow, "{symbol:?}");
        areas.push(picture.marked());
        let others = PaintOptions::symbols(Symbols::ALL.without(symbol), camera.scale);
        assert_eq!(shot(SampleLook::new(symbol, RED), others).marked(), 0);
    }
    areas.dedup();
    assert_eq!(areas.len(), 4);
    assert_eq!(shot(SampleLook::HIDDEN, all).marked(), 0);
    let outlined = SampleLook::new(Symbol::Diamond, RED).with_outline(true);
    let picture = shot(outlined, all.with_outline(Color32::WHITE));
    assert_eq!(picture.at_pos(pos), RED.to_array());
    let bright = picture.pixels.iter().filter(|pixel| pixel[2] > 150).count();
    assert!(bright > 8, "{bright} white pixels");
    let large = SampleLook {
        size: 2.0,
        ..SampleLook::new(Symbol::Dot, RED)
    };
    let ratio = shot(large, all).marked() as f32 / areas[0] as f32;
    assert!((3.0..4.5).contains(&ratio), "{ratio}");
}

#[test]
fn new_samples_replace_the_old_ones() {
    let domain = domain([20.0; 2], Boundary::Bounded);
    let camera = Camera {
        center: [10.0; 2].into(),
        scale: 10.0,
    };
    let mut harness = probe(&domain, &[at(10.0, 10.0), at(12.0, 12.0)], camera);
    let first = shoot(&mut harness);
    let canvas = &mut harness.state_mut().canvas;
    canvas.set_points(1, &[], &domain, &[]).expect("the same");
    assert_eq!(canvas.generation(), Some(1));
    canvas
        .set_points(2, &[at(5.0, 5.0)], &domain, &[])
        .expect("one");
    assert_eq!(
        canvas.set_looks(1, |_| SampleLook::new(Symbol::Dot, RED)),
        1
    );
    let second = shoot(&mut harness);
    assert!(second.marked() * 2 == first.marked());
    let pos = camera.screen_from_domain(Probe::rect(), [5.0, 5.0]);
    assert_eq!(second.at_pos(pos), RED.to_array());
    let canvas = &mut harness.state_mut().canvas;
    canvas.set_points(3, &[], &domain, &[]).expect("none");
    assert_eq!(shoot(&mut harness).marked(), 0);
}

#[test]
fn a_picture_kept_at_rest_is_the_one_drawn_anew() {
    let domain = domain([100.0; 2], Boundary::Periodic);
    let camera = Camera {
        center: [3.0, 50.0].into(),
        scale: 6.0,
    };
    let mut harness = probe(&domain, &crowd(20_000, 100.0), camera);
    let disks = PaintOptions::disks().with_images(true);
    harness.state_mut().layers.insert(0, disks);
    let teal = Color32::from_rgb(10, 160, 140);
    for version in 2..4 {
        // A new version changes every layer, and cached pictures must be redrawn.
        let look = |id| SampleLook::new(Symbol::Dot, [RED, teal][(id + version) as usize % 2]);
        let look = |id: u32| look(id).with_disk(id.is_multiple_of(version + 3));
        let mut shot = |still: usize| {
            let canvas = &mut harness.state_mut().canvas;
            canvas.set_limits(Limits {
                still,
                ..canvas.limits()
            });
            canvas.set_looks(version.into(), look);
            shoot(&mut harness);
            shoot(&mut harness)
        };
        let (kept, anew) = (shot(0), shot(usize::MAX));
        assert!(kept.marked() > 5_000);
        let apart = |(a, b): (&[u8; 4], &[u8; 4])| (0..4).map(|k| a[k].abs_diff(b[k])).max();
        let pairs = kept.pixels.iter().zip(&anew.pixels);
        let worst = pairs.filter_map(apart).max();
        assert!(worst <= Some(4), "rounding differs only: {worst:?}");
    }
}

#[test]
fn a_kept_picture_follows_new_looks() {
    let domain = domain([100.0; 2], Boundary::Bounded);
    let camera = Camera {
        center: [50.0; 2].into(),
        scale: 6.0,
    };
    let mut harness = probe(&domain, &crowd(20_000, 100.0), camera);
    harness.state_mut().canvas.set_limits(Limits {
        still: 0,
        ..Limits::SOFTWARE
    });
    assert!(shoot(&mut harness).marked() > 5_000);
    let canvas = &mut harness.state_mut().canvas;
    canvas.set_looks(9, |_| SampleLook::HIDDEN);
    assert_eq!(shoot(&mut harness).marked(), 0);
}
