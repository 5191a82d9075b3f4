//! Symbols as small white textures, rendered from signed distances whenever the size of a symbol changes, then drawn
//! tinted by the ten thousand.

use std::collections::HashMap;
use std::sync::Arc;

use egui::{Color32, ColorImage, Context, Mesh, Shape, TextureHandle, TextureId, TextureOptions};

use tilescope_drawing::{DISK_FILL, DISK_RING};

/// Number of meshes kept to reuse their memory. Chosen, not measured.
const MAX_SPARE: usize = 16;

/// A symbol that is drawn as a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Sprite {
    /// A sample, as a full disk.
    Dot,
    /// A disk: a thin ring, faintly filled.
    Disk,
    /// An eliminated sample: a hollow cross.
    Cross,
    /// A gap detector: a ring with a dot.
    Detector,
    /// An inserted sample, as a diamond.
    Diamond,
    /// A candidate, as a hollow triangle.
    Triangle,
    /// The ring around the current sample.
    Halo,
    /// The cross-section of a line, soft on both sides.
    Stroke,
}

/// The textures of symbols in use, and meshes to be used again.
#[derive(Default)]
pub struct Sprites {
    /// The texture of each symbol at the size that was asked for last.
    ready: HashMap<Sprite, Ready>,
    /// Empty meshes with capacity, the largest last.
    spare: Vec<Mesh>,
}

struct Ready {
    radius_bits: u32,
    pixels_per_point_bits: u32,
    texture: TextureHandle,
    half_points: f32,
}

/// A texture and half the side of the square that shows it at its true size.
#[derive(Clone, Copy, Debug)]
pub struct Stamp {
    /// The texture, white on transparent.
    pub texture: egui::TextureId,
    /// Half the side of its square, in screen points.
    pub half: f32,
}

impl Sprites {
    /// Returns an empty mesh, reusing the memory of a returned one if possible: allocating megabytes in every frame
    /// costs more than writing to them.
    pub fn mesh(&mut self, texture: TextureId) -> Mesh {
        let mut mesh = self.spare.pop().unwrap_or_default();
        mesh.texture_id = texture;
        mesh
    }

    /// Takes back the meshes among `shapes` that are no longer shared.
    pub fn take_back(&mut self, shapes: impl IntoIterator<Item = Shape>) {
        for shape in shapes {
            if let Shape::Mesh(mesh) = shape
                && let Ok(mut mesh) = Arc::try_unwrap(mesh)
                && self.spare.len() < MAX_SPARE
            {
                // `Mesh::clear` would free the vertices.
                mesh.vertices.clear();
                mesh.indices.clear();
                self.spare.push(mesh);
            }
        }
        // `mesh` takes the last one, so that the largest is used first.
        self.spare.sort_by_key(|mesh| mesh.vertices.capacity());
    }

    /// Returns the picture of `sprite` for a symbol of `radius` screen points.
    pub fn stamp(&mut self, ctx: &Context, sprite: Sprite, radius: f32) -> Stamp {
        let pixels_per_point = ctx.pixels_per_point();
        // Sizes are rounded to an eighth of a pixel, so that zooming seldom makes new textures.
        let rounded = (radius * pixels_per_point * 8.0).round() / 8.0;
        let radius_bits = rounded.to_bits();

        let fits = |ready: &Ready| {
            ready.radius_bits == radius_bits
                && ready.pixels_per_point_bits == pixels_per_point.to_bits()
        };

        if !self.ready.get(&sprite).is_some_and(fits) {
            let image = draw(sprite, rounded, pixels_per_point);
            let half_points = image.width() as f32 / 2.0 / pixels_per_point;
            let name = format!("{sprite:?}");
            let texture = ctx.load_texture(name, image, TextureOptions::LINEAR);
            let ready = Ready {
                radius_bits,
                pixels_per_point_bits: pixels_per_point.to_bits(),
                texture,
                half_points,
            };
            self.ready.insert(sprite, ready);
        }

        let ready = &self.ready[&sprite];
        Stamp {
            texture: ready.texture.id(),
            half: ready.half_points,
        }
    }
}

/// Returns the picture of a symbol of `radius` pixels; `unit` is a screen point in pixels.
fn draw(sprite: Sprite, radius: f32, unit: f32) -> ColorImage {
    // Rings reach beyond the radius, and their edges are soft.
    let half = (radius + 3.0 * unit).ceil() as i32;
    let side = (2 * half) as usize;
    let mut pixels = Vec::with_capacity(side * side);
    for row in -half..half {
        for column in -half..half {
            let (x, y) = (column as f32 + 0.5, row as f32 + 0.5);
            let alpha = coverage(sprite, x, y, radius, unit).clamp(0.0, 1.0);
            pixels.push(Color32::from_white_alpha((alpha * 255.0).round() as u8));
        }
    }
    ColorImage::new([side, side], pixels)
}

/// Returns how opaque a symbol is at (x, y), in pixels from its middle; `unit` is a screen point in pixels. Distances to an outline are
/// negative inside it. Factors of the radius and widths of lines were chosen, not measured.
fn coverage(sprite: Sprite, x: f32, y: f32, radius: f32, unit: f32) -> f32 {
    // An edge is soft over one pixel, half of it on either side of the outline.
    let solid = |distance: f32| (0.5 - distance).clamp(0.0, 1.0);
    let line = |distance: f32, width: f32| solid(distance.abs() - width / 2.0);
    let from_middle = x.hypot(y);

    match sprite {
        Sprite::Dot => solid(from_middle - radius),
        Sprite::Disk => {
            let ring = line(from_middle - radius, 0.9 * unit);
            (DISK_FILL * solid(from_middle - radius)).max(DISK_RING * ring)
        }
        Sprite::Cross => {
            let turned = [(x + y).abs(), (x - y).abs()].map(|v| v * 0.5_f32.sqrt());
            // The arms of a small cross are thicker, as otherwise the cross could not be seen. The limit of half the
            // radius keeps it a cross: with the whole radius as `half_arm` it would be a square.
            let half_arm = (0.26 * radius).max((0.7 * unit).min(0.5 * radius));
            let bar = |along: f32, across: f32| (along - radius).max(across - half_arm);
            let distance = bar(turned[0], turned[1]).min(bar(turned[1], turned[0]));
            // A small cross is filled, because its outline would leave no hollow inside.
            if radius < 4.0 * unit {
                solid(distance)
            } else {
                line(distance, 1.1 * unit)
            }
        }
        Sprite::Detector => {
            // The ring of a small detector is thinner, so that it does not run into the dot.
            let width = (1.4 * unit).min(0.6 * radius);
            line(from_middle - radius, width).max(solid(from_middle - 0.34 * radius))
        }
        Sprite::Diamond => solid((x.abs() + y.abs() - radius) * 0.5_f32.sqrt()),
        Sprite::Triangle => {
            // Half planes of an equilateral triangle with its tip up, circumradius `radius`: y points down, and 0.866 is
            // the sine of 60 degrees.
            let sides = (0.866 * x.abs() - 0.5 * y).max(y);
            line(sides - 0.5 * radius, (1.5 * unit).min(0.6 * radius))
        }
        Sprite::Halo => line(from_middle - radius, 2.2 * unit),
        Sprite::Stroke => solid(y.abs() - radius),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn alpha(image: &ColorImage, x: usize, y: usize) -> u8 {
        image.pixels[y * image.width() + x].a()
    }

    #[test]
    fn shapes_are_where_they_should_be() {
        let dot = draw(Sprite::Dot, 5.0, 1.0);
        let middle = dot.width() / 2;
        assert_eq!(alpha(&dot, middle, middle), 255);
        assert_eq!(alpha(&dot, 0, 0), 0);
        let ring = draw(Sprite::Halo, 9.0, 1.0);
        let middle = ring.width() / 2;
        assert_eq!(alpha(&ring, middle, middle), 0);
        assert!(alpha(&ring, middle + 9, middle) > 100);
    }

    #[test]
    fn marks_of_neighbours_leave_the_ground_to_be_seen() {
        for scale in [1.5_f32, 2.0, 2.8, 4.0, 6.0, 8.0, 12.0, 20.0, 60.0] {
            let [_, cross, diamond, ring] = tilescope_drawing::look::radii(scale);
            for (sprite, radius) in [
                (Sprite::Cross, cross),
                (Sprite::Diamond, diamond),
                (Sprite::Detector, ring),
            ] {
                let image = draw(sprite, radius, 1.0);
                let opaque: f32 = image.pixels.iter().map(|p| f32::from(p.a()) / 255.0).sum();
                // A maximal set has 0.7 samples for each square of side r.
                let share = 0.7 * opaque / (scale * scale);
                let most = if scale < 2.0 { 0.8 } else { 0.5 };
                assert!(
                    share < most,
                    "{sprite:?} covers {share} at {scale} points per r"
                );
            }
        }
    }

    #[test]
    fn nothing_touches_the_edge_of_its_picture() {
        for sprite in [
            Sprite::Dot,
            Sprite::Disk,
            Sprite::Cross,
            Sprite::Detector,
            Sprite::Diamond,
            Sprite::Triangle,
            Sprite::Halo,
        ] {
            for radius in [1.0, 2.5, 7.3, 30.0] {
                let image = draw(sprite, radius, 1.0);
                let last = image.width() - 1;
                for k in 0..=last {
                    assert_eq!(alpha(&image, k, 0), 0, "{sprite:?} {radius}");
                    assert_eq!(alpha(&image, last, k), 0, "{sprite:?} {radius}");
                }
            }
        }
    }

    #[test]
    fn unshared_meshes_are_reused() {
        let mut sprites = Sprites::default();
        let shared = Shape::mesh(Mesh::default());
        let mut large = Mesh::default();
        large.reserve_vertices(1_000);
        sprites.take_back([
            shared.clone(),
            Shape::mesh(large),
            shared.clone(),
            Shape::Noop,
        ]);
        let again = sprites.mesh(TextureId::User(7));
        assert!(again.vertices.capacity() >= 1_000);
        assert_eq!(again.texture_id, TextureId::User(7));
        let fresh = sprites.mesh(TextureId::default());
        assert_eq!(fresh.vertices.capacity(), 0, "the shared one stays");
        drop(shared);
    }
}
