//! Pictures computed pixel by pixel for the visible part of the domain: the uncovered area, and samples that are too
//! many for symbols.

use glam::DVec2;

use egui::{Color32, ColorImage, Rect};
use tilescope_core::{Locality, R};
use tilescope_session::session::Session;

use tilescope_drawing::camera::Camera;
use tilescope_drawing::scene::drawn_around;

/// A grid of pixels over the canvas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelGrid {
    /// The camera, which gives places their pixels.
    pub camera: Camera,
    /// Where the canvas is, in screen points.
    pub viewport: Rect,
    /// Pixels in a screen point.
    pub pixels_per_point: f32,
}

/// What a picture was made from, as the key of a cache: the pixels, and all that the looks of samples depend on.
pub type MadeFrom = (PixelGrid, tilescope_drawing::looks::LooksKey);

impl PixelGrid {
    /// Returns the pixels of a row and of a column.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        let size = self.viewport.size() * self.pixels_per_point;
        [
            size.x.ceil().max(1.0) as usize,
            size.y.ceil().max(1.0) as usize,
        ]
    }

    /// Returns the pixels in one r.
    #[must_use]
    pub fn scale(&self) -> f64 {
        self.camera.scale * f64::from(self.pixels_per_point)
    }

    /// Returns the position, in r, of a place on the picture, in pixels right of and below the upper left corner.
    #[must_use]
    pub fn domain_from_pixel(&self, pixel: [f64; 2]) -> DVec2 {
        let half = self.viewport.size() * self.pixels_per_point * 0.5;
        let from_middle = DVec2::new(pixel[0] - f64::from(half.x), f64::from(half.y) - pixel[1]);
        self.camera.center + from_middle / self.scale()
    }

    /// Returns where `position` lies, in pixels from the upper left corner.
    #[must_use]
    pub fn pixel_from_domain(&self, position: DVec2) -> DVec2 {
        let half = self.viewport.size() * self.pixels_per_point * 0.5;
        let from_middle = (position - self.camera.center) * self.scale();
        DVec2::new(
            f64::from(half.x) + from_middle.x,
            f64::from(half.y) - from_middle.y,
        )
    }
}

/// The coverage of each pixel.
pub struct Coverage {
    size: [usize; 2],
    cells: Vec<u8>,
}

/// The pixels that are looked at, and skipped, together. Chosen, not measured.
const SKIP: usize = 16;

/// The pixel shows neither the domain nor a copy of it.
const OUTSIDE: u8 = 3;
/// Covered by a sample from before the stage.
const BEFORE: u8 = 2;
/// Covered only by samples that the stage added.
const NOW: u8 = 1;
/// No disk covers the pixel yet.
const OPEN: u8 = 0;

impl Coverage {
    /// Returns the coverage of a set without samples: every pixel of `frame` that shows the domain or a copy of it is
    /// open, all others are outside.
    #[must_use]
    pub fn open(frame: &PixelGrid, session: &Session) -> Self {
        let size = frame.size();
        let mut cells = vec![OUTSIDE; size[0] * size[1]];

        let domain = session.size_radii();
        let margin = drawn_around(session);
        // Rows of pixels go down and the domain's ordinates up, so that its upper left corner has the least column and
        // row.
        let low = frame.pixel_from_domain(DVec2::new(-margin, domain.y + margin));
        let high = frame.pixel_from_domain(DVec2::new(domain.x + margin, -margin));

        let columns = centres(low[0], high[0], size[0]);
        for row in centres(low[1], high[1], size[1]) {
            cells[row * size[0]..][columns.clone()].fill(OPEN);
        }
        Self { size, cells }
    }

    /// Closes the pixels outside of a shape, and returns the radius at each pixel, in lattice units; 0 where there is no place.
    pub fn local_radii(&mut self, frame: &PixelGrid, locality: &Locality) -> Vec<i32> {
        let domain = locality.field.domain();
        let mut radii = vec![0; self.cells.len()];
        for (index, (cell, radius)) in self.cells.iter_mut().zip(&mut radii).enumerate() {
            // The index counts pixels row by row.
            let pixel = [index % self.size[0], index / self.size[0]];
            let at = frame.domain_from_pixel(pixel.map(|k| k as f64 + 0.5)) * f64::from(R);
            let place = domain.wrap(at.floor().as_i64vec2());
            match place.filter(|&place| *cell == OPEN && locality.inside(place)) {
                Some(place) => *radius = locality.radius_at(place),
                None => *cell = OUTSIDE,
            }
        }
        radii
    }

    /// Covers the pixels that are near a sample of `radius` lattice units at the pixel coordinates `at`: nearer than
    /// the harmonic mean of its radius and theirs ([`Locality::near_at`]). `radii` are those at all pixels, and a pixel
    /// is `unit` lattice units wide. `before` says that the sample was there before the stage.
    pub fn cover_near(&mut self, at: DVec2, radius: i32, radii: &[i32], unit: f64, before: bool) {
        // The harmonic mean of two radii is at most twice the smaller one, and so at most twice the sample's.
        let reach = 2.0 * f64::from(radius) / unit;
        let state = if before { BEFORE } else { NOW };
        for row in centres(at[1] - reach, at[1] + reach, self.size[1]) {
            let dy = (row as f64 + 0.5 - at[1]) * unit;
            for column in centres(at[0] - reach, at[0] + reach, self.size[0]) {
                let index = row * self.size[0] + column;
                // Most pixels are covered by an earlier sample, and need no second look. The larger state wins, and
                // `OUTSIDE` is the largest.
                if self.cells[index] >= state {
                    continue;
                }
                let dx = (column as f64 + 0.5 - at[0]) * unit;
                let squared = (dx * dx + dy * dy) as i64;
                if Locality::near_at(squared, [radius, radii[index]]) {
                    self.cells[index] = state;
                }
            }
        }
    }

    /// Covers the disk of `radius` pixels around `at`; `before` says that its sample was there before the stage.
    pub fn cover(&mut self, at: DVec2, radius: f64, before: bool) {
        for row in centres(at[1] - radius, at[1] + radius, self.size[1]) {
            let dy = row as f64 + 0.5 - at[1];
            let half = (radius * radius - dy * dy).max(0.0).sqrt();
            let columns = centres(at[0] - half, at[0] + half, self.size[0]);
            for cell in &mut self.cells[row * self.size[0]..][columns] {
                // States are numbered so that the larger one wins.
                *cell = (*cell).max(if before { BEFORE } else { NOW });
            }
        }
    }

    #[cfg(test)]
    fn open_pixels(&self) -> usize {
        self.cells
            .iter()
            .map(|&cell| usize::from(cell == OPEN))
            .sum()
    }

    /// Returns the picture: uncovered pixels hatched in `color` with a solid edge, those covered by
    /// this stage in a faint tone.
    #[must_use]
    pub fn image(&self, color: Color32, pixels_per_point: f32) -> ColorImage {
        let [width, height] = self.size;
        let mut image = ColorImage::filled(self.size, Color32::TRANSPARENT);
        // The opacities are chosen, not measured.
        let (fill, hatch, edge) = (color.gamma_multiply(0.5), color.gamma_multiply(0.85), color);
        let faint = color.gamma_multiply(0.20);

        // Stripes are two screen points wide, and begin every seven. On coarse screens they are at least a pixel wide, and two apart.
        let period = (7.0 * pixels_per_point).round().max(3.0) as usize;
        let thick = (2.0 * pixels_per_point).round().max(1.0) as usize;

        for first in (0..width * height).step_by(SKIP) {
            let pixels = first..(first + SKIP).min(width * height);
            // Most stretches are covered or outside the domain, with the two largest states, and nothing is drawn
            // there.
            if self.cells[pixels.clone()]
                .iter()
                .all(|&cell| cell >= BEFORE)
            {
                continue;
            }
            for k in pixels {
                image.pixels[k] = match self.cells[k] {
                    OPEN if self.is_edge(k) => edge,
                    // Row plus column is constant along a diagonal, which makes the lines of the hatching.
                    OPEN if (k / width + k % width) % period < thick => hatch,
                    OPEN => fill,
                    NOW => faint,
                    // Pixels that were covered before, or are outside the domain, stay transparent.
                    _ => continue,
                };
            }
        }

        image
    }

    /// Returns whether a pixel beside the one at `k` is covered.
    fn is_edge(&self, k: usize) -> bool {
        let [width, height] = self.size;
        let (row, column) = (k / width, k % width);
        let closed = |k: usize| matches!(self.cells[k], BEFORE | NOW);
        column > 0 && closed(k - 1)
            || column + 1 < width && closed(k + 1)
            || row > 0 && closed(k - width)
            || row + 1 < height && closed(k + width)
    }
}

/// Returns the pixels whose centres lie between `from` and `to`.
fn centres(from: f64, to: f64, count: usize) -> std::ops::Range<usize> {
    // Rounded up by hand: `ceil` is a call where the instruction set lacks it.
    let limit = |value: f64| {
        let value = (value - 0.5).clamp(0.0, count as f64);
        let whole = value as usize;
        whole + usize::from((whole as f64) < value)
    };
    let (start, end) = (limit(from), limit(to));
    start..end.max(start)
}

/// Points accumulated per pixel.
pub struct Density {
    size: [usize; 2],
    /// Red, green and blue of the points on each pixel, times their weights there, and the sum of these weights.
    sums: Vec<[f32; 4]>,
}

impl Density {
    /// Returns an empty picture.
    #[must_use]
    pub fn empty(frame: &PixelGrid) -> Self {
        let size = frame.size();
        Self {
            size,
            sums: vec![[0.0; 4]; size[0] * size[1]],
        }
    }

    /// Adds a point of `color` at the pixel coordinates `at`.
    pub fn add(&mut self, at: DVec2, color: Color32) {
        let corner = (at - 0.5).floor();
        let [right, down] = (at - 0.5 - corner).as_vec2().to_array();
        // A point lies between the centres of four pixels, which share it: the nearer a centre, the larger its part.
        let weights = [
            (0, 0, (1.0 - right) * (1.0 - down)),
            (1, 0, right * (1.0 - down)),
            (0, 1, (1.0 - right) * down),
            (1, 1, right * down),
        ];

        for (dx, dy, weight) in weights {
            let (column, row) = (corner.x as i64 + dx, corner.y as i64 + dy);
            let inside = |value: i64, count: usize| (0..count as i64).contains(&value);
            if inside(column, self.size[0]) && inside(row, self.size[1]) {
                let sum = &mut self.sums[row as usize * self.size[0] + column as usize];
                for (channel, part) in sum.iter_mut().zip([color.r(), color.g(), color.b()]) {
                    *channel += weight * f32::from(part);
                }
                sum[3] += weight;
            }
        }
    }

    /// Returns the picture; `strength` says how opaque one point in a pixel is.
    #[must_use]
    pub fn image(&self, strength: f32) -> ColorImage {
        let pixel = |sum: &[f32; 4]| {
            if sum[3] <= 0.0 {
                return Color32::TRANSPARENT;
            }
            // The transparencies of points on one pixel multiply.
            let alpha = 1.0 - (-strength * sum[3]).exp();
            let part = |k: usize| (sum[k] / sum[3]) as u8;
            Color32::from_rgb(part(0), part(1), part(2)).gamma_multiply(alpha)
        };
        ColorImage::new(self.size, self.sums.iter().map(pixel).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn blank(side: usize) -> Coverage {
        Coverage {
            size: [side, side],
            cells: vec![OPEN; side * side],
        }
    }

    #[test]
    fn a_disk_covers_exactly_the_pixel_centres_within_its_radius() {
        let mut coverage = blank(40);
        let (at, radius) = ([17.3, 21.9], 11.4);
        coverage.cover(at.into(), radius, true);
        for row in 0..40 {
            for column in 0..40 {
                let (dx, dy) = (column as f64 + 0.5 - at[0], row as f64 + 0.5 - at[1]);
                let inside = dx * dx + dy * dy <= radius * radius;
                assert_eq!(coverage.cells[row * 40 + column] == BEFORE, inside);
            }
        }
    }

    #[test]
    fn pixels_covered_before_the_stage_stay_so() {
        let mut coverage = blank(10);
        coverage.cover([5.0, 5.0].into(), 3.0, true);
        coverage.cover([5.0, 5.0].into(), 100.0, false);
        assert_eq!(coverage.cells[5 * 10 + 5], BEFORE);
        assert_eq!(coverage.cells[0], NOW);
        assert_eq!(coverage.open_pixels(), 0);
    }

    #[test]
    fn density_keeps_points_at_the_border_inside() {
        let mut density = Density {
            size: [4, 4],
            sums: vec![[0.0; 4]; 16],
        };
        density.add([0.0, 0.0].into(), Color32::WHITE);
        density.add([4.0, 4.0].into(), Color32::WHITE);
        density.add([2.5, 1.5].into(), Color32::RED);
        let image = density.image(10.0);
        assert_eq!(image.pixels[6].r(), 255);
        assert!((density.sums[6][3] - 1.0).abs() < 1e-6);
    }
}
