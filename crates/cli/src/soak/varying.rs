//! Rounds of sets in random fields and shapes: the set, the same set recorded, in half of the rounds a window of it, and the verdicts
//! by subdivision. A shape of one radius is tiled exactly, too, by both engines. Ranges are chosen, not measured, where no reason stands beside them.

use std::f64::consts::TAU;
use std::sync::Arc;

use anyhow::Result;
use tilescope_analysis::{Report, VerifyOptions};
use tilescope_core::{
    Boundary, Locality, MIN_SIDE_RADII_PERIODIC, Parameters, PatternHistory, Point, Unobserved,
    Unrecorded, exact_in_shape, varying_recorded,
};
use tilescope_sets::{
    ExactBlocks, Expression, GrayImage, Ground, PlanarPolygon, RadiusSource, ShapeSource,
    VaryingError, VaryingRecipe,
};

use super::{Dice, Feature, Tally, faults_of, pattern, random_window, shows};
use crate::interrupt;

/// The smallest and the largest area of a round in squares of the largest radius; where radii differ there are up to hundreds of
/// samples in each.
const AREAS: [f64; 2] = [150.0, 6_000.0];

/// The width of a domain over its height, to within whole pixels.
const ASPECTS: [f64; 2] = [0.3, 3.0];

/// The largest radius over the least.
const CONTRASTS: [f64; 2] = [1.05, 16.0];

/// The pixels along a side of an image: from a few steps across the domain to noise that is finer than most disks.
const PIXELS: [f64; 2] = [2.0, 60.0];

/// Pixels are at most so wide: 32 of a density's least radii, each 0.22 of the largest one, are wider.
const WIDEST_PIXEL: f64 = 6.0;

/// The lightest grey of an image, of white.
const LIGHTEST: f64 = 0.95;

/// The corners of a polygon.
const CORNERS: [f64; 2] = [3.0, 40.0];

/// The first indices of long rows of draws: for the pixels of two images, up to 60 x 200, or four times as many where
/// their number is doubled along both sides, and for the corners of a polygon.
const OF_FIELD: u32 = 100_000;
const OF_MASK: u32 = 200_000;
const OF_CORNERS: u32 = 300_000;

/// The index of the draw of a leaf.
const OF_BLOCKS: u32 = 400_000;

/// The index of the draw of whether there is a window.
const OF_WINDOW: u32 = 500_000;

/// The shortest edge of the blocks of exact tilings.
const LEAVES: [f64; 2] = [6.0, 30.0];

/// Makes a round of the seed that was drawn. The set depends on no other of the `parameters`: size, radius and boundary
/// are drawn here. Faults are reported with `command`.
pub fn round(
    parameters: &Parameters,
    dice: &Dice,
    options: &VerifyOptions,
    command: &str,
) -> Result<Tally> {
    let drawn = recipe(parameters.seed, dice)?;
    let made = match drawn.make(&mut Unobserved) {
        // A mask of few pixels may have no pixel in the shape, or its pixels may be wider than a mask's may be. Both are
        // refused rightly.
        Err(VaryingError::Nothing | VaryingError::Shape(_))
            if matches!(drawn.shape, Some(ShapeSource::Mask(_))) =>
        {
            return Ok(Tally {
                rounds: 1,
                ..Tally::default()
            });
        }
        made => made?,
    };

    let ground = drawn.ground()?;
    let domain = *ground.field.domain();
    let locality = Arc::new(Locality {
        field: ground.field.clone(),
        shape: ground.shape.clone(),
    });
    let run = varying_recorded(&locality, parameters, &mut Unobserved, &mut Unrecorded)?;
    let recorded_agrees = domain.users_from_lattice(&run.points()) == made.set.points;

    let mut report = made.judge(options, &|_| interrupt::flow())?;
    let window = Windowed::of(&drawn, &ground, &run.points(), dice, options)?;
    let mut windows_agree = window.agrees;
    window.add_to(&mut report);
    let mut engines_agree = true;
    if drawn.shape.is_some() && matches!(drawn.radius, RadiusSource::Constant(_)) {
        let tiled = tiled_exactly(&drawn, dice, options)?;
        engines_agree = tiled.engines_agree;
        windows_agree &= tiled.window.agrees;
        tiled.window.add_to(&mut report);
        report.count += tiled.report.count;
        report.conflicts += tiled.report.conflicts;
        report.gaps += tiled.report.gaps;
    }

    let is_valid = report.conflicts == 0 && report.gaps == 0;
    let checks = [
        (recorded_agrees, "the recorded set differs: "),
        (
            engines_agree,
            "exact tiling of the shape on all threads differs: ",
        ),
        (windows_agree, "a --window differs from the set: "),
        (is_valid, "not valid: "),
    ];
    let faults = faults_of(&checks);
    Ok(Tally {
        rounds: 1,
        samples: report.count as u64,
        conflicts: report.conflicts,
        gaps: report.gaps,
        unequal: u64::from(!(recorded_agrees && engines_agree && windows_agree)),
        commands: (!faults.is_empty())
            .then(|| faults + command)
            .into_iter()
            .collect(),
        ..Tally::default()
    })
}

/// A shape that was tiled exactly.
struct ExactShape {
    /// Whether the engine of all threads made what the sequential one made.
    engines_agree: bool,
    report: Report,
    window: Windowed,
}

/// A window of a set that was made alone; in half of the rounds there is none, which agrees.
struct Windowed {
    /// Whether it has the samples of the whole.
    agrees: bool,
    conflicts: u64,
    gaps: u64,
}

impl Windowed {
    /// Makes a random window of a set, whose lattice points are given.
    fn of(
        drawn: &VaryingRecipe,
        ground: &Ground,
        whole: &[Point],
        dice: &Dice,
        options: &VerifyOptions,
    ) -> Result<Self> {
        let domain = ground.field.domain();
        let drawn_window = random_window(domain, dice, 0);
        // In half of the rounds, as a window takes about as long as the set.
        let Some(window) = drawn_window.filter(|_| dice.share(OF_WINDOW) < 0.5) else {
            return Ok(Self {
                agrees: true,
                conflicts: 0,
                gaps: 0,
            });
        };

        let made = drawn.make_window(ground, &window, &mut Unobserved)?;
        let mut expected = whole.to_vec();
        expected.retain(|point| shows(&window, domain, *point));
        let report = made.judge(options, &|_| interrupt::flow())?;
        Ok(Self {
            agrees: domain.users_from_lattice(&expected) == made.set.points,
            conflicts: report.whole.conflicts,
            gaps: report.gaps,
        })
    }

    fn add_to(&self, report: &mut Report) {
        report.conflicts += self.conflicts;
        report.gaps += self.gaps;
    }
}

/// Tiles the shape of a round exactly, by both engines. The radius is the same everywhere.
fn tiled_exactly(
    drawn: &VaryingRecipe,
    dice: &Dice,
    options: &VerifyOptions,
) -> Result<ExactShape> {
    let leaf = dice.scale(OF_BLOCKS, LEAVES);
    let pattern = pattern(dice, leaf, drawn.seed);
    let blocks = ExactBlocks {
        leaf,
        pattern,
        dihedral: dice.has(Feature::Dihedral),
    };
    let recipe = VaryingRecipe {
        exact: Some(blocks),
        ..drawn.clone()
    };
    let made = recipe.make(&mut Unobserved)?;

    let ground = recipe.ground()?;
    let [width, height] = ground.field.domain().size();
    let parameters = Parameters {
        width,
        height,
        radius: made.facts.radius,
        boundary: drawn.boundary,
        seed: drawn.seed,
        leaf,
        pattern,
        dihedral: blocks.dihedral,
        ..Parameters::default()
    };
    // The engine that is written to be read is the definition, and the recipe has that of all threads.
    let history = PatternHistory::of_spec(&pattern, &mut Unobserved)?;
    let run = exact_in_shape(&parameters, &history, &ground.shape, &mut Unobserved)?;
    Ok(ExactShape {
        engines_agree: run.positions() == made.set.points,
        window: Windowed::of(&recipe, &ground, &run.points(), dice, options)?,
        report: made.judge(options, &|_| interrupt::flow())?,
    })
}

/// The domain of a round, in the largest radius.
struct Frame {
    size: [f64; 2],
    /// The pixels of a row and of a column of each image, which are squares that fill the domain.
    pixels: [usize; 2],
}

impl Frame {
    /// Draws the area, the aspect and the pixels of a round. Each draw has a number of its own, which stands before its
    /// range, so that the order of the draws does not matter.
    fn draw(dice: &Dice) -> Self {
        let columns = dice.scale(1, PIXELS);
        // A flat image, too, has the least number of pixels in a column.
        let rows = (columns / dice.scale(2, ASPECTS)).max(2.0);
        let mut pixels = [columns, rows].map(|count| count as usize);

        // A periodic domain has to have room for the largest radius along both sides, and a little more, so that
        // rounding to the lattice does not lead below it.
        let shortest = MIN_SIDE_RADII_PERIODIC + 0.5;
        let aspect = pixels[0] as f64 / pixels[1] as f64;
        let width = (dice.scale(0, AREAS) * aspect).sqrt();
        let width = width.max(shortest).max(shortest * aspect);
        while width / pixels[0] as f64 > WIDEST_PIXEL {
            pixels = pixels.map(|count| 2 * count);
        }
        Self {
            size: [width, width / aspect],
            pixels,
        }
    }

    /// Returns an image of noise, from black to a light grey.
    fn image(&self, first: u32, dice: &Dice) -> Result<GrayImage> {
        let [columns, rows] = self.pixels;
        let pixel =
            |index: u32| (dice.share(first + index) * LIGHTEST * f64::from(u16::MAX)) as u16;
        let grey = (0..(columns * rows) as u32).map(pixel).collect();
        Ok(GrayImage::from_grey(columns, grey)?)
    }

    /// Draws where the radii come from. The largest is 1, the unit of the frame, or a little less.
    fn radius(&self, dice: &Dice) -> Result<RadiusSource> {
        if !dice.has(Feature::Field) {
            return Ok(RadiusSource::Constant(1.0));
        }
        // A field is refused whose nodes are more than 32 of the least radii apart. Pixels are the nodes of images, and
        // of formulas beside a mask. So the least radius is not below 1/31 of a pixel's side: with a bound of 1/32,
        // rounding alone could break the limit.
        let pitch = self.size[0] / self.pixels[0] as f64;
        let least = dice.scale(3, CONTRASTS).recip().max(pitch / 31.0);
        if dice.has(Feature::Image) {
            let (image, radii) = (self.image(OF_FIELD, dice)?, [least, 1.0]);
            return Ok(RadiusSource::Image { image, radii });
        }
        if dice.has(Feature::Density) {
            // The radius is `black` over the root of the darkness. So it is 1 for the lightest grey, which has 0.05 of the
            // darkness of black.
            let (image, black) = (self.image(OF_FIELD, dice)?, (1.0 - LIGHTEST).sqrt());
            return Ok(RadiusSource::Density { image, black });
        }

        // A formula. Whole waves along each side, so that the field goes around as a periodic domain does; the values
        // are from `least` to 1.
        let waves = [4, 5].map(|index| dice.pick(index, &[1.0, 2.0, 3.0, 5.0]));
        let [along_x, along_y] = [0, 1].map(|axis| TAU * waves[axis] / self.size[axis]);
        let (middle, half) = (0.5 * (1.0 + least), 0.5 * (1.0 - least));
        let text = format!("{middle} + {half}*sin({along_x}*x)*cos({along_y}*y)");
        Ok(RadiusSource::Expression {
            expression: Expression::parse(&text)?,
            scale: 1.0,
        })
    }

    fn shape(&self, dice: &Dice) -> Result<Option<ShapeSource>> {
        Ok(if dice.has(Feature::Polygon) {
            Some(ShapeSource::Polygon(self.polygon(dice)?))
        } else if dice.has(Feature::Mask) {
            Some(ShapeSource::Mask(self.image(OF_MASK, dice)?))
        } else {
            None
        })
    }

    /// Returns a polygon around the middle of the domain, whose corners lie in all directions in turn, so that no edges cross;
    /// with a hole of the same form in rounds that have holes.
    fn polygon(&self, dice: &Dice) -> Result<PlanarPolygon> {
        let corners = dice.scale(6, CORNERS) as u32;
        let corner = |index: u32, part: f64| {
            let angle = TAU * f64::from(index) / f64::from(corners);
            // A quarter of the way to the border at least: chosen, not measured.
            let reach = part * (0.25 + 0.75 * dice.share(OF_CORNERS + index));
            let [x, y] = [angle.cos(), angle.sin()].map(|along| 0.5 + 0.5 * reach * along);
            [self.size[0] * x, self.size[1] * y]
        };
        let ring = |part: f64| (0..corners).map(|index| corner(index, part)).collect();

        let mut rings: Vec<Vec<[f64; 2]>> = vec![ring(1.0)];
        if dice.has(Feature::Hole) {
            rings.push(ring(0.5));
        }
        Ok(PlanarPolygon::from_rings("soak", rings)?)
    }
}

/// Returns what a round makes: a set in a field, in a shape, in both or in neither.
fn recipe(seed: u64, dice: &Dice) -> Result<VaryingRecipe> {
    let frame = Frame::draw(dice);
    let shape = frame.shape(dice)?;
    // A domain with a shape has to be bounded.
    let is_periodic = shape.is_none() && !dice.has(Feature::Bounded);
    Ok(VaryingRecipe {
        radius: frame.radius(dice)?,
        shape,
        size: frame.size.map(Some),
        // Formulas and polygons are drawn for a domain whose lower corner is 0.
        origin: Some([0.0; 2]),
        boundary: Boundary::of(is_periodic),
        seed,
        count: None,
        exact: None,
    })
}
