//! The colours of what the rays of a picture meet.

use ecolor::Color32;

use super::bands::{Band, Surface};
use super::projection::{PlacedBall, Projection};
use super::{COLOR_BANDS, OrbitPicture, OrbitSet, band_color};

/// The direction of the light, of length 1: from the left, above and before the picture.
const LIGHT: [f32; 3] = [-0.424, 0.566, 0.707];
/// The share of light that every surface has.
const AMBIENT: f32 = 0.42;
/// How much the farthest surface is like the ground: depth is seen without dark colours, which a projector loses.
const HAZE: f32 = 0.5;
/// Below this share of a sphere's normal towards the eye its rim is dark, so that balls of a colour are told apart.
const RIM: f32 = 0.34;
/// How much lighter, or darker on a light ground, the flat faces are than spheres.
const FACE_TINT: f32 = 0.30;

type Rgb = [f32; 3];

/// All that shading needs.
pub(super) struct Shading<'a> {
    set: OrbitSet<'a>,
    projection: &'a Projection,
    /// Column, row and nearness of each ball of the set. They are 0 for balls that are cut away, which no ray meets.
    places: Vec<[f32; 3]>,
    colors: Vec<Rgb>,
    ground: Rgb,
    border: Rgb,
    notch: Rgb,
    face_tint: Rgb,
}

impl<'a> Shading<'a> {
    pub fn new(
        picture: &OrbitPicture<'a>,
        projection: &'a Projection,
        balls: &[PlacedBall],
    ) -> Self {
        let palette = picture.palette;
        let rgb = |color: Color32| [color.r(), color.g(), color.b()].map(f32::from);
        let mut places = vec![[0.0; 3]; picture.set.points.len()];
        for ball in balls {
            places[ball.index as usize] = [ball.column, ball.row, ball.near];
        }

        let bands = (0..COLOR_BANDS).map(|band| band_color(palette, band).map(f32::from));
        Self {
            set: picture.set,
            projection,
            places,
            colors: bands.collect(),
            ground: rgb(palette.domain),
            border: rgb(palette.border),
            // Light in every look: the edges of the cut lie before balls, which are darker.
            notch: if palette.dark {
                rgb(palette.text)
            } else {
                rgb(palette.domain)
            },
            face_tint: if palette.dark {
                [255.0; 3]
            } else {
                rgb(palette.domain)
            },
        }
    }

    /// Writes the pixels of a band, each the mean of its rays. A pixel has `rays` by `rays` of them.
    pub fn shade(&self, band: &Band, rays: usize, pixels: &mut [u8]) {
        let width = band.columns / rays;
        for (number, pixel) in pixels.chunks_exact_mut(4).enumerate() {
            let (row, column) = (number / width, number % width);
            // The mean is that of the encoded colours: between neighbours of a ball's edge the eye sees no difference.
            let mut sum = [0.0; 3];
            for y in row * rays..(row + 1) * rays {
                for x in column * rays..(column + 1) * rays {
                    let color = self.color(band, y, x);
                    sum = [0, 1, 2].map(|k| sum[k] + color[k]);
                }
            }
            for (channel, sum) in pixel.iter_mut().zip(sum) {
                *channel = (sum / (rays * rays) as f32 + 0.5) as u8;
            }
        }
    }

    /// Returns the colour of what a ray meets.
    fn color(&self, band: &Band, row: usize, column: usize) -> Rgb {
        let (surface, near) = band.at(row, column);
        let [x, y] = [column as f32 + 0.5, (band.top + row) as f32 + 0.5];
        let color = match surface {
            Surface::Ground => return self.ground,
            Surface::Border => self.border,
            Surface::Notch => self.notch,
            Surface::Sphere(index) => self.sphere(index, [x, y, near]),
            Surface::Face(index, axis) => self.face(index, axis, [x, y, near]),
        };

        // The nearest corner of the box has the nearness `depth`, and the opposite one -`depth`. The share of the way
        // from the one to the other is `away`.
        let depth = self.projection.depth;
        let away = ((depth - near) / (2.0 * depth)).clamp(0.0, 1.0);
        mixed(color, self.ground, HAZE * away)
    }

    fn own_color(&self, index: u32) -> Rgb {
        self.colors[self.set.color_band(index as usize) as usize]
    }

    /// Returns the colour of a sphere at a place.
    fn sphere(&self, index: u32, [x, y, near]: [f32; 3]) -> Rgb {
        let [column, row, middle] = self.places[index as usize];
        let radius = self.projection.radius;
        // Rows are counted downwards.
        let normal = [x - column, row - y, near - middle].map(|along| along / radius);
        let rim = (normal[2] / RIM).clamp(0.45, 1.0);
        darkened(self.own_color(index), rim * light(normal))
    }

    /// Returns the colour of a flat face across an axis, which has a dark rim of a ray or more.
    fn face(&self, index: u32, axis: usize, [x, y, near]: [f32; 3]) -> Rgb {
        let [column, row, middle] = self.places[index as usize];
        let radius = self.projection.radius;
        let towards_eye = self.projection.towards_eye(axis);
        let normal = self
            .projection
            .direction(axis)
            .map(|along| along * towards_eye);
        let offset = [x - column, row - y, near - middle];
        let away: f32 = (0..3).map(|k| offset[k] * normal[k]).sum();
        let square: f32 = offset.iter().map(|along| along * along).sum();

        // By Pythagoras in the plane of the face: the distance from its middle, and the radius of the disk.
        let [from_middle, disk] =
            [square, radius * radius].map(|square| (square - away * away).max(0.0).sqrt());
        // The width of the rim, and the brightness of rim and face below, were chosen by eye.
        let is_rim = disk - from_middle < (radius * 0.09).max(1.0);
        let tinted = mixed(self.own_color(index), self.face_tint, FACE_TINT);
        let color = if is_rim {
            self.own_color(index)
        } else {
            tinted
        };
        darkened(
            color,
            if is_rim {
                0.5
            } else {
                0.35 + 0.65 * light(normal)
            },
        )
    }
}

/// Returns how bright a surface of a normal is, from [`AMBIENT`] to 1.
fn light(normal: [f32; 3]) -> f32 {
    let towards: f32 = (0..3).map(|k| normal[k] * LIGHT[k]).sum();
    AMBIENT + (1.0 - AMBIENT) * towards.max(0.0)
}

fn darkened(color: Rgb, brightness: f32) -> Rgb {
    color.map(|channel| channel * brightness)
}

fn mixed(color: Rgb, other: Rgb, share: f32) -> Rgb {
    [0, 1, 2].map(|k| color[k] + (other[k] - color[k]) * share)
}
