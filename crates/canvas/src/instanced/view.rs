//! From a camera to draw parameters: which copies of the domain are in view, and the shader's parameters for each.

use glam::DVec2;

use egui::{Color32, Painter, Rect};
use tilescope_core::R;

use super::gpu::LayerUniforms;
use super::set::Symbols;
use tilescope_drawing::camera::Camera;
use tilescope_drawing::look::radii;
use tilescope_drawing::{DISK_FILL, DISK_RING};

/// Which marks a layer draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marks {
    /// The disks of all samples whose look shows it.
    Disks,
    /// Symbols of these kinds.
    Symbols(Symbols),
}

/// The marks of a layer and their style.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaintOptions {
    /// The kind of mark.
    pub marks: Marks,
    /// Whether a periodic domain's images around it are drawn: eight copies, as far as the painter's clip rectangle
    /// lets them be seen.
    pub images: bool,
    /// The radii of dot, cross, diamond and ring, in screen points.
    pub radii: [f32; 4],
    /// The colour of outlines.
    pub outline: Color32,
    /// Opacity of a disk's fill, relative to its look's colour.
    pub disk_fill: f32,
    /// Opacity of a disk's ring, relative to its look's colour.
    pub disk_ring: f32,
    /// Whether samples outside the view are skipped; the picture is the same either way.
    pub cull: bool,
    /// The radius of disks, in r.
    pub disk_radius: f64,
    /// Only samples of ids below this are drawn: the first of nested levels.
    pub shown: u32,
}

impl PaintOptions {
    /// Returns the options for disks.
    #[must_use]
    pub const fn disks() -> Self {
        Self {
            marks: Marks::Disks,
            images: false,
            radii: [0.0; 4],
            outline: Color32::TRANSPARENT,
            disk_fill: DISK_FILL,
            disk_ring: DISK_RING,
            cull: true,
            disk_radius: 1.0,
            shown: u32::MAX,
        }
    }

    /// Returns the options for symbols of the usual [`radii`] at `scale` (screen points per r).
    #[must_use]
    pub const fn symbols(symbols: Symbols, scale: f64) -> Self {
        Self {
            marks: Marks::Symbols(symbols),
            radii: radii(scale as f32),
            ..Self::disks()
        }
    }

    /// Returns these options with outlines of `color`.
    #[must_use]
    pub const fn with_outline(self, outline: Color32) -> Self {
        Self { outline, ..self }
    }

    /// Returns these options with or without images.
    #[must_use]
    pub const fn with_images(self, images: bool) -> Self {
        Self { images, ..self }
    }

    /// Returns these options for the first `shown` samples alone, with disks of this radius, in r.
    #[must_use]
    pub const fn with_prefix(self, shown: u32, disk_radius: f64) -> Self {
        Self {
            disk_radius,
            shown,
            ..self
        }
    }

    /// Returns how far a mark extends from its position, in screen points, including antialiasing.
    fn reach(&self, scale: f64) -> f64 {
        match self.marks {
            Marks::Disks => scale * self.disk_radius + 3.0,
            Marks::Symbols(_) => {
                // A brush enlarges samples by up to a half. The rest is room for outlines and antialiasing.
                f64::from(self.radii.into_iter().fold(0.0, f32::max)) * 2.0 + 4.0
            }
        }
    }
}

/// A view of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneView {
    pub camera: Camera,
    pub rect: Rect,
    pub pixels_per_point: f32,
}

/// A copy of the domain that meets the view: by how much it is shifted, and the part of the domain to draw, in r.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Copy {
    pub shift: DVec2,
    pub low: DVec2,
    pub high: DVec2,
}

impl PlaneView {
    pub fn of(painter: &Painter, rect: Rect, camera: Camera) -> Self {
        Self {
            camera,
            rect,
            pixels_per_point: painter.ctx().pixels_per_point(),
        }
    }

    /// Returns pixels per r.
    pub fn scale(&self) -> f64 {
        self.camera.scale * f64::from(self.pixels_per_point)
    }

    /// Returns the copies of a domain of `size` r of which marks may be seen within `clip`; images only of a
    /// periodic one.
    pub fn copies(
        &self,
        clip: Rect,
        size: DVec2,
        periodic: bool,
        options: &PaintOptions,
    ) -> Vec<Copy> {
        // A mark whose middle is outside the clip rectangle may reach into the rectangle. The reach is converted from points to r.
        let reach = options.reach(self.camera.scale) / self.camera.scale;
        let low = self
            .camera
            .domain_from_screen(self.rect, clip.left_bottom());
        let high = self.camera.domain_from_screen(self.rect, clip.right_top());

        // The domain itself comes first, and its images are drawn over it.
        let steps: &[f64] = if periodic && options.images {
            &[0.0, -1.0, 1.0]
        } else {
            &[0.0]
        };

        let mut copies = Vec::new();
        for up in steps {
            for right in steps {
                let shift = DVec2::new(*right, *up) * size;
                let (low, high) = (low - reach - shift, high + reach - shift);
                // Samples that a bounded domain drops are up to one radius outside the domain. Two radii leave room for rounding.
                if (high.cmpge(DVec2::splat(-2.0)) & low.cmple(size + 2.0)).all() {
                    copies.push(Copy { shift, low, high });
                }
            }
        }

        copies
    }

    /// Returns the shader's parameters for a copy of the domain that is shifted by `shift` r.
    pub fn frame(&self, shift: DVec2, options: &PaintOptions) -> LayerUniforms {
        let pixels = self.pixels_per_point;

        // The camera's place is given in whole radii and the rest, which is in units of the lattice: one float of 32
        // bits would be too coarse in a large domain.
        let center = self.camera.center - shift;
        // These bounds fit into whole numbers of 32 bits, and beyond them nothing is in view.
        let whole = center.floor().clamp(DVec2::splat(-1e9), DVec2::splat(1e9));

        let middle = self.rect.center();
        // Disks share one radius, and no kind of symbol is drawn with them.
        let (kinds, radii) = match options.marks {
            Marks::Disks => (0, [(self.scale() * options.disk_radius) as f32; 4]),
            Marks::Symbols(symbols) => (symbols.0, options.radii.map(|radius| radius * pixels)),
        };

        LayerUniforms {
            // The size is known only when the callback is prepared, and is set there.
            target_size: [0.0; 2],
            middle: [middle.x * pixels, middle.y * pixels],
            whole: whole.as_ivec2().to_array(),
            rest: ((center - whole) * f64::from(R)).as_vec2().to_array(),
            // Pixels per r, per unit of the lattice, and per screen point.
            scale: [
                self.scale() as f32,
                (self.scale() / f64::from(R)) as f32,
                pixels,
                // The opacity of points: the caller sets it, as it depends on how many are drawn.
                1.0,
            ],
            radii,
            outline: options
                .outline
                .to_array()
                .map(|byte| f32::from(byte) / 255.0),
            disk: [options.disk_fill, options.disk_ring],
            kinds,
            shown: options.shown,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{pos2, vec2};

    fn view(center: [f64; 2], scale: f64) -> PlaneView {
        let center = center.into();
        PlaneView {
            camera: Camera { center, scale },
            rect: Rect::from_min_size(pos2(0.0, 0.0), vec2(100.0, 100.0)),
            pixels_per_point: 1.0,
        }
    }

    #[test]
    fn images_are_drawn_where_they_meet_the_view_only() {
        let options = PaintOptions::disks().with_images(true);
        let copies = |center, options: &PaintOptions, periodic| {
            let view = view(center, 10.0);
            let shifts = view.copies(view.rect, [50.0; 2].into(), periodic, options);
            shifts
                .iter()
                .map(|copy| copy.shift.to_array())
                .collect::<Vec<[f64; 2]>>()
        };
        assert_eq!(copies([25.0, 25.0], &options, true), [[0.0; 2]]);
        assert_eq!(copies([1.0, 25.0], &options, true).len(), 2);
        assert!(copies([1.0, 25.0], &options, true).contains(&[-50.0, 0.0]));
        assert_eq!(copies([1.0, 1.0], &options, true).len(), 4);
        assert_eq!(copies([1.0, 1.0], &options, false), [[0.0; 2]]);
        let none = PaintOptions::disks();
        assert_eq!(copies([1.0, 1.0], &none, true), [[0.0; 2]]);
        assert!(copies([-40.0, 25.0], &none, true).is_empty());
    }

    #[test]
    fn the_centre_is_split_without_loss() {
        let center = [60_000.123_456_789, -3.75];
        let view = view(center, 2_000.0);
        let frame = view.frame([0.0; 2].into(), &PaintOptions::disks());
        for (k, center) in center.into_iter().enumerate() {
            let back = f64::from(frame.whole[k]) + f64::from(frame.rest[k]) / f64::from(R);
            assert!((back - center).abs() < 1e-7, "{back}");
        }
        assert_eq!(frame.whole, [60_000, -4]);
    }
}
