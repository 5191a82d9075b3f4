//! A canvas in a window of its own, with functions that measure its picture.

use egui::{Color32, Pos2, Rect, pos2, vec2};
use egui_kittest::Harness;
use tilescope_canvas::instanced::{InstancedCanvas, PaintOptions, Symbols};
use tilescope_core::{Boundary, Domain, Point, R};
use tilescope_drawing::camera::Camera;
use tilescope_drawing::look::{SampleLook, Symbol};

pub const RED: Color32 = Color32::from_rgb(230, 90, 20);
pub const GROUND: Color32 = Color32::from_rgb(18, 21, 25);
pub const SIZE: f32 = 200.0;

/// A canvas in the middle of a window, and the colour patch that egui itself draws beside it.
pub struct Probe {
    pub canvas: InstancedCanvas,
    pub camera: Camera,
    pub layers: Vec<PaintOptions>,
    pub patch: Color32,
    pub due: bool,
}

impl Probe {
    pub fn rect() -> Rect {
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

pub fn domain(size: [f64; 2], boundary: Boundary) -> Domain {
    Domain::from_size(size, 1.0, boundary).expect("a domain")
}

pub fn probe(domain: &Domain, points: &[Point], camera: Camera) -> Harness<'static, Probe> {
    let (domain, points) = (*domain, points.to_vec());
    Harness::builder()
        .with_size([SIZE + 40.0, SIZE + 20.0])
        .wgpu()
        .build_eframe(move |creation| {
            let state = creation.wgpu_render_state.as_ref().expect("a device");
            let mut canvas = InstancedCanvas::new(state);
            canvas
                .set_points(1, &points, &domain, &[])
                .expect("few points");
            canvas.set_looks(1, |_| SampleLook::new(Symbol::Dot, RED));
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
pub struct Picture {
    pub width: usize,
    pub pixels: Vec<[u8; 4]>,
}

impl Picture {
    pub fn at(&self, x: f32, y: f32) -> [u8; 4] {
        self.pixels[y as usize * self.width + x as usize]
    }

    pub fn at_pos(&self, pos: Pos2) -> [u8; 4] {
        self.at(pos.x, pos.y)
    }

    /// How much each pixel of the canvas differs from the background.
    pub fn marks(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        let ground = GROUND.to_array();
        let in_canvas = |x: usize, y: usize| Probe::rect().contains(pos2(x as f32, y as f32));
        let pixels = (0..self.pixels.len()).map(|k| (k % self.width, k / self.width));
        let pixels = pixels.filter(move |&(x, y)| in_canvas(x, y));
        pixels.map(move |(x, y)| {
            let pixel = self.pixels[y * self.width + x];
            (x, y, f64::from(pixel[0].abs_diff(ground[0])))
        })
    }

    pub fn marked(&self) -> usize {
        self.marks().filter(|mark| mark.2 > 0.0).count()
    }

    /// The centroid of all pixels that differ from the background.
    pub fn centroid(&self) -> [f64; 2] {
        let (mut sum, mut weight) = ([0.0; 2], 0.0);
        for (x, y, mark) in self.marks() {
            sum[0] += mark * (x as f64 + 0.5);
            sum[1] += mark * (y as f64 + 0.5);
            weight += mark;
        }
        assert!(weight > 0.0, "nothing was drawn");
        sum.map(|s| s / weight)
    }

    pub fn difference(&self, other: &Self) -> usize {
        let pairs = self.pixels.iter().zip(&other.pixels);
        pairs.filter(|(a, b)| a != b).count()
    }
}

pub fn shoot(harness: &mut Harness<'_, Probe>) -> Picture {
    harness.step();
    harness.step();
    shoot_now(harness)
}

pub fn shoot_now(harness: &mut Harness<'_, Probe>) -> Picture {
    let image = harness.render().expect("a picture");
    Picture {
        width: image.width() as usize,
        pixels: image.pixels().map(|pixel| pixel.0).collect(),
    }
}

pub fn at(x: f64, y: f64) -> Point {
    let unit = f64::from(R);
    Point::new((x * unit) as i32, (y * unit) as i32)
}

/// A crowd of samples, some two per squared r, in a square of `side` r.
pub fn crowd(count: u32, side: f64) -> Vec<Point> {
    let coordinate = |k: u32, step: f64| (f64::from(k) * step).fract() * side;
    let one = |k| {
        at(
            coordinate(k, 0.754_877_666_246),
            coordinate(k, 0.569_840_290_998),
        )
    };
    (1..=count).map(one).collect()
}
