//! Stipples: as many dots as are asked for, as dense as an image is dark.
//!
//! No radius gives a maximal set of exactly N samples. So a set of a few more is made, and the first N that arrived are kept:
//! the beginning of a process of darts is spread over the whole image, the denser the darker. The verifier measures within
//! which factor of their radii these cover.

mod look;

use std::sync::Arc;

use tilescope_core::memory::{Making, ask_for};
use tilescope_core::{
    Boundary, Domain, MAXIMAL_DENSITY, Observer, Point, RadiusField, Rect, SampleError, Shape,
    varying_sample,
};
use tilescope_formats::PointSet;

use super::error::VaryingError;
use super::ground::Ground;
use super::image::GrayImage;
use super::source::{DENSITY_CAP, RadiusSource, ShapeSource};
use super::{MAX_RUNS, VaryingRecipe};
use crate::facts::{Facts, Stated};
use crate::made::Made;

pub use look::{StippleLook, color_of};

/// Places lighter than this share of black are white paper, if nothing else is asked for. Without such a limit the largest
/// radius puts stray dots on white; the noise of a JPEG image beside black letters is mostly below it.
pub const DEFAULT_WHITE: f64 = 1.0 / 64.0;

/// Where half of black is white, little is left of an image.
const MAX_WHITE: f64 = 0.5;

/// A field has at least this many nodes along the radius of black. More would take time and change no visible dot.
const NODES_A_RADIUS: f64 = 4.0;

/// How many dots may be made beyond those that are asked for, and left out: this many roots of them. The number of dots of a
/// field scatters by 0.2 roots, so that two or three runs meet this. The dots left out are the last arrivals, which fill the
/// narrowest places.
const LEFT_OUT: f64 = 0.6;

/// How far above the dots that are asked for runs aim, in roots of them: a third of [`LEFT_OUT`].
const AIM: f64 = 0.2;

/// Where dots go on beyond the frame, they do so by this many of the largest radii at its border, but by no more than
/// the longer side of the image: no dot in the frame is near one that is farther out by that many radii.
const BEYOND: f64 = 2.0;

/// What a stipple is made from.
#[derive(Clone, Debug)]
pub struct StippleRecipe {
    /// The image, in its tone.
    pub image: GrayImage,
    /// Places lighter than this share of black have no dots; with 0 all places have.
    pub white: f64,
    /// How many dots there are to be.
    pub dots: u64,
    /// The width of the image in the units of the dots; its pixels, if not given.
    pub width: Option<f64>,
    /// Whether dots are made beyond the frame, too, and dropped there: at a border there are more dots otherwise.
    pub runs_on: bool,
    /// The seed of all random draws.
    pub seed: u64,
}

/// A stipple, and what it is drawn with.
#[derive(Clone, Debug)]
pub struct Stipple {
    /// The dots, in the sequence of their arrival.
    pub made: Made,
    /// The radius of black.
    pub black: f64,
    /// Pixels lighter than the largest radius can show, which have that radius.
    pub capped: usize,
    /// The field and the shape in which the dots were made.
    pub ground: Ground,
    /// How many sets were made until one had the dots that were asked for, and few more.
    pub runs: usize,
}

/// Refuses a share of black below which there are no dots, if it is out of range.
///
/// # Errors
///
/// [`VaryingError::Tone`] with the number and its range.
pub fn check_white(white: f64) -> Result<(), VaryingError> {
    if (0.0..=MAX_WHITE).contains(&white) {
        return Ok(());
    }
    Err(VaryingError::Tone {
        name: "white",
        value: white,
        range: 0.0..=MAX_WHITE,
    })
}

impl StippleRecipe {
    /// Makes the stipple.
    ///
    /// # Errors
    ///
    /// [`VaryingError`] when the numbers are out of range, the image has no dark place or too few pixels for the given
    /// number of dots, no try makes as many dots, and when it is cancelled.
    pub fn make(&self, observer: &mut dyn Observer) -> Result<Stipple, VaryingError> {
        check_white(self.white)?;
        // All runs have the same blocks, as the radius changes by some hundredths only.
        let mut black = self.estimate()?;
        let image = self.image.in_blocks(self.block(black))?;

        // One dot may always be left out. For one or two dots the allowance of `LEFT_OUT` would be rounded down to 0, and
        // a run could make exactly the wanted number only by chance.
        let dots = self.dots as f64;
        let aim = dots + AIM * dots.sqrt();
        let most = self.dots + ((LEFT_OUT * dots.sqrt()) as u64).max(1);
        let mut nearest = 0;
        let mut best: Option<Run> = None;
        let mut runs = 0;
        for _ in 0..MAX_RUNS {
            runs += 1;
            let run = self.run(&image, black, observer)?;
            let found = run.points.len() as u64;
            if found.abs_diff(self.dots) < self.dots.abs_diff(nearest) {
                nearest = found;
            }
            let is_better = |best: &Run| run.points.len() < best.points.len();
            // Of runs with enough dots the one that leaves out fewest covers best. It is taken even if no try meets
            // `most`.
            if found >= self.dots && best.as_ref().is_none_or(is_better) {
                best = Some(run);
            }
            if (self.dots..=most).contains(&found) {
                break;
            }
            // The count falls with the square of the radius of black, but for borders and steep places. Without any dot
            // this radius would become 0, and stay so in all further tries.
            black *= (found.max(1) as f64 / aim).sqrt();
        }

        let count = self.dots;
        best.map(|run| self.finished(run, runs))
            .ok_or(VaryingError::Count { count, nearest })
    }

    /// Returns the recipe of the field and the shape of a stipple that was made with this radius of black.
    ///
    /// # Errors
    ///
    /// [`VaryingError::White`] when the image has no dark place.
    pub fn settled(&self, black: f64) -> Result<VaryingRecipe, VaryingError> {
        // The blocks follow from the first estimate, as when it was made.
        let image = self.image.in_blocks(self.block(self.estimate()?))?;
        Ok(self.recipe(&image, black))
    }

    /// Returns what certificates state of the way in which a stipple is made on this ground, which is that of `settled`.
    #[must_use]
    pub fn stated(&self, settled: &VaryingRecipe, ground: &Ground) -> Stated {
        let mut parameters = settled.stated_on(ground);
        parameters.insert("dots".to_owned(), self.dots.into());
        parameters.insert("run-on".to_owned(), self.runs_on.into());
        parameters
    }

    /// Returns the width of a pixel.
    fn pitch(&self) -> f64 {
        let columns = self.image.pixels()[0] as f64;
        self.width.map_or(1.0, |width| width / columns)
    }

    /// Returns the radius of black that gives about as many dots.
    fn estimate(&self) -> Result<f64, VaryingError> {
        let dark = self.image.darkness(self.white);
        if dark == 0.0 {
            return Err(VaryingError::White {
                name: self.image.name().to_owned(),
                white: self.white,
            });
        }
        let pitch = self.pitch();
        Ok(pitch * (MAXIMAL_DENSITY * dark / self.dots.max(1) as f64).sqrt())
    }

    /// Returns the side of the blocks of pixels that the field has a node for.
    fn block(&self, black: f64) -> usize {
        let pixels = self.image.pixels();
        let fits = |block: &usize| {
            let is_fine = *block as f64 * self.pitch() * NODES_A_RADIUS <= black;
            is_fine && pixels.iter().all(|count| count % block == 0)
        };
        // Powers of two are enough, as each holds the one before: where one does not fit, no larger one does.
        let powers = (0..usize::BITS - 1).map(|bits| 1 << bits);
        powers.take_while(fits).last().unwrap_or(1)
    }

    /// Returns what a set is made from with some radius of black.
    fn recipe(&self, image: &GrayImage, black: f64) -> VaryingRecipe {
        let shape = (self.white > 0.0).then(|| ShapeSource::Dark {
            image: image.clone(),
            white: self.white,
        });
        // Without a width, a pixel is 1 unit wide.
        let columns = self.image.pixels()[0] as f64;
        VaryingRecipe {
            radius: RadiusSource::Density {
                image: image.clone(),
                black,
            },
            shape,
            size: [Some(self.width.unwrap_or(columns)), None],
            origin: None,
            boundary: Boundary::Bounded,
            seed: self.seed,
            count: None,
            exact: None,
        }
    }

    /// Makes all dots that there are with some radius of black.
    fn run(
        &self,
        image: &GrayImage,
        black: f64,
        observer: &mut dyn Observer,
    ) -> Result<Run, VaryingError> {
        let recipe = self.recipe(image, black);
        let ground = recipe.ground()?;
        // The memory of the dots that are wanted is asked for before it is needed: a program ends at once when an
        // allocation fails. Dots that are left out, and those beyond the frame, are not counted here.
        let bytes = Making::Varying.bytes_a_sample();
        ask_for(self.dots as f64, bytes).map_err(SampleError::from)?;

        let points = if self.runs_on {
            let wider = Wider::around(&ground, image, self.white)?;
            let points = varying_sample(&wider.field, &wider.shape, self.seed, observer)?;
            wider.cropped(&points, ground.field.domain())
        } else {
            varying_sample(&ground.field, &ground.shape, self.seed, observer)?
        };
        Ok(Run {
            recipe,
            ground,
            black,
            points,
        })
    }

    /// Keeps the first dots of a run, which is one of `runs`.
    fn finished(&self, run: Run, runs: usize) -> Stipple {
        let Run {
            recipe,
            ground,
            black,
            mut points,
        } = run;
        // Points are in the sequence of their arrival.
        let made = points.len() as u64;
        points.truncate(usize::try_from(self.dots).unwrap_or(usize::MAX));

        let parameters = self.stated(&recipe, &ground);
        let domain = *ground.field.domain();
        // Darkness goes with the inverse square of the radius. The largest radius is that of the density's cap or, if
        // that is smaller, the largest that the field can have beside its least one.
        let largest = ground.limit.min(DENSITY_CAP * black);
        let lightest = (black / largest).powi(2);
        Stipple {
            made: Made {
                set: PointSet::from_points(domain.users_from_lattice(&points)),
                facts: Facts {
                    radius: ground.varying.judged.radius(),
                    varying: Some(Arc::clone(&ground.varying)),
                    made: Some(made),
                    ..Facts::new("reference", parameters, &domain)
                },
            },
            black,
            capped: self.image.lighter_than(self.white, lightest),
            ground,
            runs,
        }
    }
}

/// All dots of some radius of black.
struct Run {
    recipe: VaryingRecipe,
    ground: Ground,
    black: f64,
    points: Vec<Point>,
}

/// Field and shape beyond the frame on all sides, where they are as at the nearest place of its border.
struct Wider {
    field: RadiusField,
    shape: Shape,
    /// The units by which they reach beyond the frame.
    margin: i32,
}

impl Wider {
    /// Returns the field and the shape with a margin in which dots go on as at the border.
    fn around(ground: &Ground, image: &GrayImage, white: f64) -> Result<Self, VaryingError> {
        let (frame, bits, [columns, rows]) = (ground.field.domain(), ground.bits, image.pixels());
        // At a node the field has exactly the node's radius.
        let at = |column: usize, row: usize| {
            ground
                .field
                .radius_at(Point::new((column << bits) as i32, (row << bits) as i32))
        };
        let across = (0..=columns).flat_map(|column| [at(column, 0), at(column, rows)]);
        let along = (0..=rows).flat_map(|row| [at(0, row), at(columns, row)]);
        // A border always has nodes, so that the 1 never stands in.
        let greatest = across.chain(along).max().unwrap_or(1);
        // Where a border is white, its radius is as large as possible, and the margin would be many times the image: it
        // is no wider than the image's longer side (chosen, not measured). Nodes are 2^bits units apart.
        let reach = (f64::from(greatest) * BEYOND / f64::from(1_u32 << bits)).ceil() as usize;
        let pixels = reach.min(columns.max(rows));

        // A rectangle excludes its upper corner, and the last node of a bounded domain lies on its border.
        let margin = (pixels << bits) as i32;
        let max = Point::new(
            frame.width() + 2 * margin + 1,
            frame.height() + 2 * margin + 1,
        );
        let min = Point::new(0, 0);
        let domain = Domain::of_rect(&Rect { min, max }, Boundary::Bounded)?;
        // A node beyond the frame has the radius of the nearest node in it. There is one node more than pixels on each
        // axis.
        let nearest = |index: usize, last: usize| index.saturating_sub(pixels).min(last);
        let nodes = (0..=rows + 2 * pixels).flat_map(|row| {
            (0..=columns + 2 * pixels)
                .map(move |column| at(nearest(column, columns), nearest(row, rows)))
        });
        let field = RadiusField::from_nodes(domain, bits, &nodes.collect::<Vec<i32>>())?;

        let shape = if white > 0.0 {
            let inside = image.darker_than(white);
            let wide = columns + 2 * pixels;
            let pixel = |index: usize| {
                let (row, column) = (index / wide, index % wide);
                inside[nearest(row, rows - 1) * columns + nearest(column, columns - 1)]
            };
            let all: Vec<bool> = (0..wide * (rows + 2 * pixels)).map(pixel).collect();
            Shape::mask(bits, wide, &all)?
        } else {
            Shape::rectangle()
        };
        Ok(Self {
            field,
            shape,
            margin,
        })
    }

    /// Returns the dots in the frame.
    fn cropped(&self, points: &[Point], frame: &Domain) -> Vec<Point> {
        let moved = points
            .iter()
            .map(|point| Point::new(point.x - self.margin, point.y - self.margin));
        // The far border belongs to no pixel of the frame.
        let is_inside = |point: &Point| {
            (0..frame.width()).contains(&point.x) && (0..frame.height()).contains(&point.y)
        };
        moved.filter(is_inside).collect()
    }
}

#[cfg(test)]
mod tests;
