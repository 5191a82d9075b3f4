//! Radii that are painted: a field as grey values of 16 bits, which strokes of a soft brush make smaller or larger. Begin with
//! [`PaintedRadii`].
//!
//! The image is that of a PNG file: the saved file holds the field, and certificates name it by the file's digest.

use serde::{Deserialize, Serialize};
use tilescope_core::Boundary;

use super::VaryingRecipe;
use super::error::VaryingError;
use super::image::{GrayImage, WHITE};
use super::source::RadiusSource;

/// The name of the file of a painted field.
pub const PAINTED: &str = "painted.png";

/// The pixels along the longer side of a field that is no image yet. A brush of a fiftieth of the side is then 20 pixels wide, and
/// steps from pixel to pixel are lost in its soft edge; one step to undo holds half a megabyte.
const PIXELS: usize = 512;

/// The pixels of an image are painted themselves up to this number on a side. A larger image is painted in [`PIXELS`].
const MAX_OWN_PIXELS: usize = 1024;

/// The largest radius is at most this many times the least: half the limit of a lattice, as its r may lie up to a factor of two below
/// the least radius.
const MAX_RANGE: f64 = 32.0;

/// A field can be painted up to so many times smaller and larger than its extremes, as far as [`MAX_RANGE`] allows.
const ROOM: f64 = 4.0;

/// A soft round brush.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct Brush {
    /// Its radius, as a share of the longer side of the domain.
    pub size: f64,
    /// The binary logarithm of the factor in its middle: with 1, one stroke halves the radius or doubles it.
    pub strength: f64,
    /// Whether strokes make radii larger, and not smaller.
    pub is_larger: bool,
}

impl Default for Brush {
    fn default() -> Self {
        Self {
            size: 0.08,
            strength: 1.0,
            is_larger: false,
        }
    }
}

impl Brush {
    /// The least and the largest size: from a few pixels to half of the domain.
    pub const SIZES: [f64; 2] = [0.01, 0.5];
    /// The least and the largest strength: from 7 % more to four times as much.
    pub const STRENGTHS: [f64; 2] = [0.1, 2.0];

    /// Returns the brush with its numbers within their limits.
    #[must_use]
    pub fn limited(self) -> Self {
        let within = |number: f64, [low, high]: [f64; 2], usual: f64| {
            // A script may give text that is no number.
            if number.is_finite() {
                number.clamp(low, high)
            } else {
                usual
            }
        };
        let usual = Self::default();
        Self {
            size: within(self.size, Self::SIZES, usual.size),
            strength: within(self.strength, Self::STRENGTHS, usual.strength),
            ..self
        }
    }
}

/// A stroke of a brush.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct BrushStroke {
    /// The brush that makes it.
    pub brush: Brush,
    /// The places through which it goes, from the lower corner of the domain, in its unit; one place is a dab.
    pub path: Vec<[f64; 2]>,
}

/// A field of radii that is being painted.
#[derive(Clone, Debug, PartialEq)]
pub struct PaintedRadii {
    columns: usize,
    /// Row by row from the lowest row up.
    grey: Vec<u16>,
    /// The radii of black and of white.
    radii: [f64; 2],
    /// Width and height of the domain.
    size: [f64; 2],
    is_periodic: bool,
}

impl PaintedRadii {
    /// Returns the radii of a recipe, to be painted; those of a field that was painted are taken as they are.
    ///
    /// # Errors
    ///
    /// Those of the recipe's field; [`VaryingError::Unsquare`] if no squares fill the domain.
    pub fn of(recipe: &VaryingRecipe) -> Result<Self, VaryingError> {
        if let RadiusSource::Image { image, radii } = &recipe.radius
            && image.name() == PAINTED
        {
            // The squares are the image's, so that the rounding of the sides to the lattice does not matter.
            let size = recipe.ground()?.field.domain().size();
            return Ok(Self {
                columns: image.columns,
                grey: image.grey.to_vec(),
                radii: *radii,
                size,
                is_periodic: recipe.boundary == Boundary::Periodic,
            });
        }

        let ground = recipe.ground()?;
        let (field, domain) = (&ground.field, ground.field.domain());
        // If the recipe has the sides, they are taken from there. The sides of the domain are rounded to its lattice,
        // each by itself: squares that fill the recipe's sides may not fill the rounded ones.
        let size = match recipe.size {
            [Some(width), Some(height)] => [width, height],
            _ => domain.size(),
        };
        let [columns, rows] = pixels(recipe, size)?;

        let unit = domain.radius() / f64::from(tilescope_core::R);
        let extremes = field.extremes().map(|radius| f64::from(radius) * unit);
        let is_periodic = recipe.boundary == Boundary::Periodic;
        // A side of a periodic domain must be longer than four times the largest radius. A radius a little below a
        // quarter of the shorter side is never refused.
        let most = if is_periodic {
            size[0].min(size[1]) / 4.01
        } else {
            f64::INFINITY
        };
        let radii = range(extremes, most);
        let pitch = size[0] / columns as f64;
        let middle = |at: usize| (at as f64 + 0.5) * pitch;
        let places =
            (0..rows).flat_map(|row| (0..columns).map(move |column| [middle(column), middle(row)]));
        let grey = places.map(|at| {
            let radius = field.radius_at(domain.lattice_from_user(at));
            grey_of(f64::from(radius) * unit, radii)
        });

        Ok(Self {
            columns,
            grey: grey.collect(),
            radii,
            size,
            is_periodic,
        })
    }

    /// Paints a stroke. A pixel that the stroke passes several times is painted once, so that the result does not
    /// depend on how often a pointer reports its place.
    pub fn paint(&mut self, stroke: &BrushStroke) {
        let brush = stroke.brush.limited();
        let reach = brush.size * self.size[0].max(self.size[1]);
        let sign = if brush.is_larger { 1.0 } else { -1.0 };

        let distances = self.distances(&stroke.path, reach);
        for (grey, distance) in self.grey.iter_mut().zip(distances) {
            if distance >= reach {
                continue;
            }
            // The weight is 1 in the middle. It has no corner there or at the edge, which would be seen as a line.
            let share = distance / reach;
            let weight = (1.0 - share * share) * (1.0 - share * share);

            let radius = radius_of(*grey, self.radii);
            // The function of libm has the same bits on every machine.
            let factor = libm::exp2(sign * brush.strength * weight);
            *grey = grey_of(radius * factor, self.radii);
        }
    }

    /// Returns the distance of each pixel's middle from a path, around a periodic domain, too; infinite where no segment is within
    /// about `reach`. Each segment is compared only with the pixels around it, as a long stroke of a small brush has hundreds.
    fn distances(&self, path: &[[f64; 2]], reach: f64) -> Vec<f64> {
        let rows = self.grey.len() / self.columns;
        let counts = [self.columns as i64, rows as i64];
        let pitch = self.size[0] / self.columns as f64;
        let mut distances = vec![f64::INFINITY; self.grey.len()];

        // Each place is joined to the next one, and the last place to itself: a dab is thus a segment without a length.
        // A longer stroke ends with such a segment, which changes no distance.
        let last = path.last().copied();
        let ends = path
            .iter()
            .copied()
            .zip(path.iter().skip(1).copied().chain(last));

        for (from, to) in ends {
            let segment = self.beginning_inside([from, to]);
            let [across, up] = [0, 1].map(|axis| {
                let [from, to] = segment.map(|end| end[axis]);
                let first = ((from.min(to) - reach) / pitch).floor() as i64;
                let end = ((from.max(to) + reach) / pitch).floor() as i64 + 1;
                if self.is_periodic {
                    first..end
                } else {
                    first.max(0)..end.min(counts[axis])
                }
            });

            for row in up {
                for column in across.clone() {
                    let at = [column, row].map(|index| (index as f64 + 0.5) * pitch);
                    // A pixel beyond the border of a periodic domain is one at the other side.
                    let [column, row] = [column.rem_euclid(counts[0]), row.rem_euclid(counts[1])];
                    let distance = &mut distances[(row * counts[0] + column) as usize];
                    *distance = distance.min(distance_to(at, segment));
                }
            }
        }
        distances
    }

    /// Returns a segment of a stroke, moved by whole sides of a periodic domain such that it begins inside.
    fn beginning_inside(&self, segment: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
        let shift = [0, 1].map(|axis| {
            let side = self.size[axis];
            if self.is_periodic {
                (segment[0][axis] / side).floor() * side
            } else {
                0.0
            }
        });
        // A script may give places anywhere: one beyond the next copy of the domain is moved to its border, so that no more than
        // these copies are looked at.
        segment.map(|end| {
            [0, 1].map(|axis| {
                (end[axis] - shift[axis]).clamp(-self.size[axis], 2.0 * self.size[axis])
            })
        })
    }

    /// Returns the field as a source of radii: an image of a PNG file, with the radii of black and of white.
    ///
    /// # Errors
    ///
    /// [`VaryingError::Image`] if the file cannot be encoded.
    pub fn source(&self) -> Result<RadiusSource, VaryingError> {
        let image = GrayImage::as_png(PAINTED, self.columns, &self.grey)?;
        let radii = self.radii;
        Ok(RadiusSource::Image { image, radii })
    }
}

/// Returns the pixels in which the radii of a recipe are painted: squares that fill the domain.
fn pixels(recipe: &VaryingRecipe, size: [f64; 2]) -> Result<[usize; 2], VaryingError> {
    let of_shape = recipe.shape.as_ref().and_then(super::ShapeSource::pixels);
    // A mask and a field have the same pixels, however many.
    if let Some(pixels) = of_shape {
        return Ok(pixels);
    }
    let of_image = match &recipe.radius {
        RadiusSource::Image { image, .. } | RadiusSource::Density { image, .. } => {
            Some(image.pixels())
        }
        RadiusSource::Constant(_) | RadiusSource::Expression { .. } | RadiusSource::Grid { .. } => {
            None
        }
    };

    let is_small = |pixels: &[usize; 2]| pixels.iter().all(|count| *count <= MAX_OWN_PIXELS);
    if let Some(pixels) = of_image.filter(is_small) {
        return Ok(pixels);
    }
    squares(size).ok_or(VaryingError::Unsquare {
        size,
        limit: PIXELS,
    })
}

/// Returns the largest number of squares, at most [`PIXELS`] along the longer side, that fill a domain.
fn squares(size: [f64; 2]) -> Option<[usize; 2]> {
    let longer = size[0].max(size[1]);
    let counts = |along: usize| size.map(|side| side / longer * along as f64);
    // The quotients of the sides are rounded, by some parts in 2^53.
    let is_whole = |count: f64| count >= 0.5 && (count / count.round() - 1.0).abs() < 1e-12;
    let along = (1..=PIXELS)
        .rev()
        .find(|&along| counts(along).into_iter().all(is_whole))?;
    Some(counts(along).map(|count| count.round() as usize))
}

/// Returns the radii of black and of white for a field of these extremes; that of white is at most `most`, if the field allows.
fn range([least, greatest]: [f64; 2], most: f64) -> [f64; 2] {
    // The room is the same at both ends. A field that fills the whole range has none, and is painted within it.
    let room = (MAX_RANGE * least / greatest).sqrt().clamp(1.0, ROOM);
    [least / room, (greatest * room).min(most).max(greatest)]
}

/// Returns the distance of a place from a segment.
fn distance_to(at: [f64; 2], [from, to]: [[f64; 2]; 2]) -> f64 {
    let from_here = [0, 1].map(|axis| at[axis] - from[axis]);
    let along = [0, 1].map(|axis| to[axis] - from[axis]);
    let squared = along[0] * along[0] + along[1] * along[1];
    let dot = from_here[0] * along[0] + from_here[1] * along[1];
    let share = if squared > 0.0 {
        (dot / squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let [x, y] = [0, 1].map(|axis| from_here[axis] - share * along[axis]);
    (x * x + y * y).sqrt()
}

fn radius_of(grey: u16, [black, white]: [f64; 2]) -> f64 {
    black + (white - black) * f64::from(grey) / f64::from(WHITE)
}

/// Returns the grey of a radius, which is made one of the range.
fn grey_of(radius: f64, [black, white]: [f64; 2]) -> u16 {
    let share = (radius - black) / (white - black);
    (share.clamp(0.0, 1.0) * f64::from(WHITE)).round() as u16
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::varying::Expression;

    fn recipe(radius: RadiusSource) -> VaryingRecipe {
        VaryingRecipe {
            radius,
            shape: None,
            size: [Some(2.0), Some(1.0)],
            origin: None,
            boundary: Boundary::Bounded,
            seed: 1,
            count: None,
            exact: None,
        }
    }

    fn dab(at: [f64; 2], is_larger: bool) -> BrushStroke {
        let brush = Brush {
            size: 0.1,
            strength: 1.0,
            is_larger,
        };
        BrushStroke {
            brush,
            path: vec![at],
        }
    }

    /// Returns the radius of the painted field at a place of the domain.
    fn radius_at(painted: &PaintedRadii, at: [f64; 2]) -> f64 {
        let recipe = recipe(painted.source().expect("an image"));
        let field = recipe.ground().expect("a field").field;
        let domain = *field.domain();
        let units = field.radius_at(domain.lattice_from_user(at));
        f64::from(units) * domain.radius() / f64::from(tilescope_core::R)
    }

    fn is_about(found: f64, wanted: f64) -> bool {
        (found / wanted - 1.0).abs() < 0.01
    }

    #[test]
    fn a_dab_halves_or_doubles_the_radius_in_its_middle_and_nothing_far_away() {
        let mut painted = PaintedRadii::of(&recipe(RadiusSource::Constant(0.04))).expect("a field");
        assert_eq!((painted.columns, painted.grey.len()), (512, 512 * 256));
        painted.paint(&dab([0.5, 0.5], false));
        painted.paint(&dab([1.5, 0.5], true));
        for (x, wanted) in [(0.5, 0.02), (1.0, 0.04), (1.5, 0.08)] {
            let found = radius_at(&painted, [x, 0.5]);
            assert!(is_about(found, wanted), "{x}: {found}");
        }
    }

    #[test]
    fn a_stroke_counts_once_however_often_it_is_reported() {
        let start = PaintedRadii::of(&recipe(RadiusSource::Constant(0.04))).expect("a field");
        let path = vec![[0.3, 0.5], [1.7, 0.5]];
        let many = (0..=140)
            .map(|at| [0.3 + f64::from(at) / 100.0, 0.5])
            .collect();
        let painted = |path: Vec<[f64; 2]>| {
            let mut painted = start.clone();
            painted.paint(&BrushStroke {
                path,
                ..dab([0.0; 2], false)
            });
            painted
        };
        let (short, long) = (painted(path), painted(many));
        let differences = short
            .grey
            .iter()
            .zip(&long.grey)
            .map(|(a, b)| a.abs_diff(*b));
        assert!(differences.max() <= Some(1));
        assert_ne!(short, start);
        assert_eq!(painted(Vec::new()), start);
    }

    #[test]
    fn painting_goes_on_from_the_image_and_stays_in_its_range() {
        let expression = Expression::parse("0.02 + 0.02*x").expect("an expression");
        let radius = RadiusSource::Expression {
            expression,
            scale: 1.0,
        };
        let mut painted = PaintedRadii::of(&recipe(radius)).expect("a field");
        for _ in 0..20 {
            painted.paint(&dab([1.0, 0.5], false));
        }
        let again =
            PaintedRadii::of(&recipe(painted.source().expect("an image"))).expect("a field");
        assert_eq!(again, painted);

        // The extremes are 0.02 and 0.06, so that the range is 32 times: the sampler accepts it, whatever is painted.
        let least = radius_at(&painted, [1.0, 0.5]);
        assert!(is_about(least, 0.02 / (32.0_f64 / 3.0).sqrt()), "{least}");
        painted.paint(&dab([0.3, 0.2], true));
        painted.paint(&dab([0.3, 0.2], true));
        recipe(painted.source().expect("an image"))
            .ground()
            .expect("a field");
    }

    #[test]
    fn the_saved_file_is_the_field() {
        let mut painted = PaintedRadii::of(&recipe(RadiusSource::Constant(0.04))).expect("a field");
        painted.paint(&dab([0.5, 0.5], false));
        let RadiusSource::Image { image, .. } = painted.source().expect("an image") else {
            panic!("no image");
        };
        let read =
            GrayImage::read("other.png", &image.to_png().expect("a file")).expect("an image");
        // Images are equal if their files are.
        assert_eq!(read, image);
        assert_eq!(read.grey, image.grey);
    }

    #[test]
    fn a_stroke_over_more_than_half_a_periodic_domain_is_painted_to_its_end() {
        let periodic = VaryingRecipe {
            boundary: Boundary::Periodic,
            ..recipe(RadiusSource::Constant(0.04))
        };
        let start = PaintedRadii::of(&periodic).expect("a field");
        let mut painted = start.clone();
        painted.paint(&BrushStroke {
            path: vec![[0.4, 0.5], [1.6, 0.5]],
            ..dab([0.0; 2], false)
        });

        // In the row in the middle; 512 columns are two units wide.
        let at = |radii: &PaintedRadii, column: usize| radii.grey[radii.grey.len() / 2 + column];
        for column in [128, 256, 384] {
            assert!(at(&painted, column) < at(&start, column), "{column}");
        }
        assert_eq!(at(&painted, 2), at(&start, 2));
    }

    #[test]
    fn a_stroke_goes_around_a_periodic_domain_and_ends_at_a_border() {
        let dark_at_far_side = |boundary| {
            let recipe = VaryingRecipe {
                boundary,
                ..recipe(RadiusSource::Constant(0.04))
            };
            let mut painted = PaintedRadii::of(&recipe).expect("a field");
            painted.paint(&dab([0.01, 0.5], false));
            let row = painted.grey.len() / painted.columns / 2;
            painted.grey[row * painted.columns + painted.columns - 1] < painted.grey[0]
        };
        assert!(dark_at_far_side(Boundary::Periodic));
        assert!(!dark_at_far_side(Boundary::Bounded));
    }

    #[test]
    fn no_stroke_makes_radii_too_large_for_a_periodic_domain() {
        let boundary = Boundary::Periodic;
        let of_large = VaryingRecipe {
            boundary,
            ..recipe(RadiusSource::Constant(0.1))
        };
        let mut painted = PaintedRadii::of(&of_large).expect("a field");
        for _ in 0..4 {
            painted.paint(&dab([0.5, 0.5], true));
        }
        let radius = painted.source().expect("an image");
        let made = VaryingRecipe { radius, ..of_large };
        made.ground().expect("a field");
        // The control: in a bounded domain the radius would be four times as large, which goes around no side of 1.
        assert!(range([0.1; 2], f64::INFINITY)[1] * 4.0 > 1.0);
    }

    #[test]
    fn a_domain_that_no_squares_fill_is_refused() {
        let size = [Some(1.0), Some(std::f64::consts::FRAC_1_SQRT_2)];
        let recipe = VaryingRecipe {
            size,
            ..recipe(RadiusSource::Constant(0.04))
        };
        let said = PaintedRadii::of(&recipe)
            .expect_err("no squares")
            .to_string();
        assert!(said.contains("0.70") && said.contains("512"), "{said}");
    }
}
