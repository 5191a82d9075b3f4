//! What instancing draws, pixel by pixel, on the device that the harness finds.

use egui::{Color32, Pos2, Rect, pos2, vec2};
use egui_kittest::Harness;
use tilescope_app::camera::Camera;
use tilescope_app::canvas::instanced::{
    InstancedCanvas, Limits, Look, PaintOptions, Symbol, Symbols,
};
use tilescope_core::{Boundary, Domain, Point, R};

const RED: Color32 = Color32::from_rgb(230, 90, 20);
const GROUND: Color32 = Color32::from_rgb(18, 21, 25);
const SIZE: f32 = 200.0;

/// A canvas in the middle of a window, and the colour patch that egui itself draws beside it.
struct Probe {
    canvas: InstancedCanvas,
    camera: Camera,
    layers: Vec<PaintOptions>,
    patch: Color32,
    due: bool,
}

impl Probe {
    fn rect() -> Rect {
        Rect::from_min_size(pos2(20.0, 10.0), vec2(SIZE, SIZE))
    }
}

impl eframe::App for Probe {
    fn ui(&mut self, ui: &mut egui::Ui, _: &mut eframe::Frame) {
        let rect = Self::rect();
        ui.painter().rect_filled(ui.max_rect(), 0.0, GROUND);
        let patch = Rect::from_min_size(pos2(2.0, 2.0), vec2(6.0, 6.0));
        ui.painter().rect_filled(patch, 0.0, self.patch);
        let painter = ui.painter_at(rect);
        self.due = false;
        for layer in &self.layers {
            self.due |= self.canvas.paint(&painter, rect, self.camera, layer);
        }
    }
}

fn domain(size: [f64; 2], boundary: Boundary) -> Domain {
    Domain::from_size(size, 1.0, boundary).expect("a domain")
}

fn probe(domain: &Domain, points: &[Point], camera: Camera) -> Harness<'static, Probe> {
    let (domain, points) = (*domain, points.to_vec());
    Harness::builder()
        .with_size([SIZE + 40.0, SIZE + 20.0])
        .wgpu()
        .build_eframe(move |creation| {
            let state = creation.wgpu_render_state.as_ref().expect("a device");
            let mut canvas = InstancedCanvas::new(state);
            canvas.set_points(1, &points, &domain).expect("few points");
            canvas.set_looks(1, |_| Look::new(Symbol::Dot, RED));
            Probe {
                canvas,
                camera,
                layers: vec![PaintOptions::symbols(Symbols::ALL, camera.scale)],
                patch: RED,
                due: false,
            }
        })
}

/// A picture as rows of colours.
struct Picture {
    width: usize,
    pixels: Vec<[u8; 4]>,
}

impl Picture {
    fn at(&self, x: f32, y: f32) -> [u8; 4] {
        self.pixels[y as usize * self.width + x as usize]
    }

    fn at_pos(&self, pos: Pos2) -> [u8; 4] {
        self.at(pos.x, pos.y)
    }

    /// How much each pixel differs from the ground, within the canvas.
    fn marks(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        let ground = GROUND.to_array();
        let in_canvas = |x: usize, y: usize| Probe::rect().contains(pos2(x as f32, y as f32));
        let places = (0..self.pixels.len()).map(|k| (k % self.width, k / self.width));
        let places = places.filter(move |&(x, y)| in_canvas(x, y));
        places.map(move |(x, y)| {
            let pixel = self.pixels[y * self.width + x];
            (x, y, f64::from(pixel[0].abs_diff(ground[0])))
        })
    }

    fn marked(&self) -> usize {
        self.marks().filter(|mark| mark.2 > 0.0).count()
    }

    /// The middle of all that is not ground.
    fn centroid(&self) -> [f64; 2] {
        let (mut sum, mut weight) = ([0.0; 2], 0.0);
        for (x, y, mark) in self.marks() {
            sum[0] += mark * (x as f64 + 0.5);
            sum[1] += mark * (y as f64 + 0.5);
            weight += mark;
        }
        assert!(weight > 0.0, "nothing was drawn");
        sum.map(|s| s / weight)
    }

    fn difference(&self, other: &Self) -> usize {
        let pairs = self.pixels.iter().zip(&other.pixels);
        pairs.filter(|(a, b)| a != b).count()
    }
}

fn shoot(harness: &mut Harness<'_, Probe>) -> Picture {
    harness.step();
    harness.step();
    shoot_now(harness)
}

fn shoot_now(harness: &mut Harness<'_, Probe>) -> Picture {
    let image = harness.render().expect("a picture");
    Picture {
        width: image.width() as usize,
        pixels: image.pixels().map(|pixel| pixel.0).collect(),
    }
}

fn at(x: f64, y: f64) -> Point {
    let unit = f64::from(R);
    Point::new((x * unit) as i32, (y * unit) as i32)
}

/// A crowd of samples, some two per squared r, in a square of `side` r.
fn crowd(count: u32, side: f64) -> Vec<Point> {
    let place = |k: u32, step: f64| (f64::from(k) * step).fract() * side;
    let one = |k| at(place(k, 0.754_877_666_246), place(k, 0.569_840_290_998));
    (1..=count).map(one).collect()
}

#[test]
fn a_sample_is_at_its_pixel_in_the_colour_that_egui_paints() {
    let domain = domain([20.0; 2], Boundary::Bounded);
    let camera = Camera {
        center: [8.0, 9.0],
        scale: 20.0,
    };
    let place = [10.0, 12.0];
    let mut harness = probe(&domain, &[at(place[0], place[1])], camera);
    for color in [RED, Color32::from_rgba_unmultiplied(40, 200, 250, 120)] {
        harness.state_mut().patch = color;
        let version = u64::from(color.a());
        let canvas = &mut harness.state_mut().canvas;
        assert_eq!(
            canvas.set_looks(version, |_| Look::new(Symbol::Dot, color)),
            usize::from(color != RED)
        );
        let picture = shoot(&mut harness);
        let pos = camera.screen_from_domain(Probe::rect(), place);
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
        center: [10.0; 2],
        scale: 60.0,
    };
    let mut harness = probe(&domain, &[at(10.0, 10.0)], camera);
    harness.state_mut().layers = vec![PaintOptions::disks()];
    assert_eq!(shoot(&mut harness).marked(), 0, "its look shows no disk");
    let look = Look::new(Symbol::Dot, RED).with_disk(true);
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
fn places_are_exact_far_from_the_origin() {
    let domain = domain([65_000.0, 10.0], Boundary::Bounded);
    let units = Point::new(60_000 * R + 12_345, 5 * R + 777);
    for scale in [2_000.0, 4_000.0] {
        let camera = Camera {
            center: [60_000.375, 5.023_712_158],
            scale,
        };
        let mut harness = probe(&domain, &[units], camera);
        let centroid = shoot(&mut harness).centroid();
        let place = [units.x, units.y].map(|u| f64::from(u) / f64::from(R));
        let rect = Probe::rect();
        let expected = [
            f64::from(rect.center().x) + (place[0] - camera.center[0]) * scale,
            f64::from(rect.center().y) - (place[1] - camera.center[1]) * scale,
        ];
        for k in 0..2 {
            let off = (centroid[k] - expected[k]).abs();
            assert!(off < 0.05, "{off} pixels at {scale}");
        }
        let single = place[0] as f32 - camera.center[0] as f32;
        let in_single = f64::from(rect.center().x) + f64::from(single) * scale;
        let off = (in_single - expected[0]).abs();
        assert!(off > 1.0, "single precision would be {off} pixels off");
    }
}

#[test]
fn images_appear_across_a_periodic_border_and_only_there() {
    let camera = Camera {
        center: [0.0, 20.0],
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
fn what_is_left_out_for_the_view_would_not_be_seen() {
    let domain = domain([100.0; 2], Boundary::Periodic);
    let points = crowd(20_000, 100.0);
    for center in [[50.0, 50.0], [0.5, 99.0], [33.0, 0.0]] {
        let camera = Camera {
            center,
            scale: 15.0,
        };
        let mut harness = probe(&domain, &points, camera);
        let look = |id: u32| Look::new(Symbol::Dot, RED).with_disk(id.is_multiple_of(7));
        let canvas = &mut harness.state_mut().canvas;
        canvas.set_looks(2, look);
        // A kept picture is rounded once more than one drawn in place.
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
        center: [50.0; 2],
        scale: 2.0,
    };
    let mut harness = probe(&domain, &crowd(20_000, 100.0), camera);
    harness.state_mut().canvas.set_limits(Limits {
        moving_symbols: 2_000,
        ..Limits::SOFTWARE
    });
    let rest = shoot(&mut harness);
    assert!(!harness.state().due);
    harness.state_mut().camera.center[0] += 0.5;
    harness.step();
    assert!(harness.state().due, "another frame is due");
    let moving = shoot_now(&mut harness);
    assert!(moving.marked() * 4 < rest.marked());
    assert!(moving.marked() > 1_250 * 3);
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
        center: [200.0; 2],
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
            Look::new(Symbol::Diamond, RED)
        } else {
            Look::HIDDEN
        }
    };
    harness.state_mut().canvas.set_looks(2, shown);
    harness.state_mut().camera.center = radii(chosen);
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
fn a_new_look_of_one_sample_changes_its_pixels_only() {
    let domain = domain([100.0; 2], Boundary::Bounded);
    let camera = Camera {
        center: [50.0; 2],
        scale: 10.0,
    };
    let mut points = crowd(20_000, 45.0);
    points.push(at(50.0, 50.0));
    let id = points.len() as u32 - 1;
    let mut harness = probe(&domain, &points, camera);
    let before = shoot(&mut harness);
    let green = Look::new(Symbol::Diamond, Color32::from_rgb(10, 240, 90));
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
        .set_looks(3, |_| Look::new(Symbol::Dot, RED));
    assert_eq!(shoot(&mut harness).difference(&before), 0);
}

#[test]
fn every_symbol_has_its_shape_and_outlines_lie_around() {
    let domain = domain([20.0; 2], Boundary::Bounded);
    let camera = Camera {
        center: [10.0; 2],
        scale: 40.0,
    };
    let mut harness = probe(&domain, &[at(10.0, 10.0)], camera);
    let pos = camera.screen_from_domain(Probe::rect(), [10.0; 2]);
    let mut version = 1;
    let mut shot = |look: Look, options: PaintOptions| {
        version += 1;
        harness.state_mut().canvas.set_looks(version, |_| look);
        harness.state_mut().layers = vec![options];
        shoot(&mut harness)
    };
    let all = PaintOptions::symbols(Symbols::ALL, camera.scale);
    let mut areas = Vec::new();
    for symbol in [Symbol::Dot, Symbol::Cross, Symbol::Diamond, Symbol::Ring] {
        let picture = shot(Look::new(symbol, RED), all);
        let hollow = symbol == Symbol::Cross;
        assert_eq!(picture.at_pos(pos) == RED.to_array(), !hollow, "{symbol:?}");
        areas.push(picture.marked());
        let others = PaintOptions::symbols(Symbols::ALL.without(symbol), camera.scale);
        assert_eq!(shot(Look::new(symbol, RED), others).marked(), 0);
    }
    areas.dedup();
    assert_eq!(areas.len(), 4);
    assert_eq!(shot(Look::HIDDEN, all).marked(), 0);
    let outlined = Look::new(Symbol::Diamond, RED).with_outline(true);
    let picture = shot(outlined, all.with_outline(Color32::WHITE));
    assert_eq!(picture.at_pos(pos), RED.to_array());
    let bright = picture.pixels.iter().filter(|pixel| pixel[2] > 150).count();
    assert!(bright > 8, "{bright} white pixels");
    let large = Look {
        size: 2.0,
        ..Look::new(Symbol::Dot, RED)
    };
    let ratio = shot(large, all).marked() as f32 / areas[0] as f32;
    assert!((3.0..4.5).contains(&ratio), "{ratio}");
}

#[test]
fn new_samples_replace_the_old_ones() {
    let domain = domain([20.0; 2], Boundary::Bounded);
    let camera = Camera {
        center: [10.0; 2],
        scale: 10.0,
    };
    let mut harness = probe(&domain, &[at(10.0, 10.0), at(12.0, 12.0)], camera);
    let first = shoot(&mut harness);
    let canvas = &mut harness.state_mut().canvas;
    canvas.set_points(1, &[], &domain).expect("the same");
    assert_eq!(canvas.generation(), Some(1));
    canvas.set_points(2, &[at(5.0, 5.0)], &domain).expect("one");
    assert_eq!(canvas.set_looks(1, |_| Look::new(Symbol::Dot, RED)), 1);
    let second = shoot(&mut harness);
    assert!(second.marked() * 2 == first.marked());
    let pos = camera.screen_from_domain(Probe::rect(), [5.0, 5.0]);
    assert_eq!(second.at_pos(pos), RED.to_array());
    let canvas = &mut harness.state_mut().canvas;
    canvas.set_points(3, &[], &domain).expect("none");
    assert_eq!(shoot(&mut harness).marked(), 0);
}

#[test]
fn a_picture_kept_at_rest_is_the_one_drawn_anew() {
    let domain = domain([100.0; 2], Boundary::Periodic);
    let camera = Camera {
        center: [3.0, 50.0],
        scale: 6.0,
    };
    let mut harness = probe(&domain, &crowd(20_000, 100.0), camera);
    let disks = PaintOptions::disks().with_images(true);
    harness.state_mut().layers.insert(0, disks);
    let teal = Color32::from_rgb(10, 160, 140);
    for version in 2..4 {
        // Every layer changes with the version, which kept pictures must follow.
        let look = |id| Look::new(Symbol::Dot, [RED, teal][(id + version) as usize % 2]);
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
        center: [50.0; 2],
        scale: 6.0,
    };
    let mut harness = probe(&domain, &crowd(20_000, 100.0), camera);
    harness.state_mut().canvas.set_limits(Limits {
        still: 0,
        ..Limits::SOFTWARE
    });
    assert!(shoot(&mut harness).marked() > 5_000);
    let canvas = &mut harness.state_mut().canvas;
    canvas.set_looks(9, |_| Look::HIDDEN);
    assert_eq!(shoot(&mut harness).marked(), 0);
}
