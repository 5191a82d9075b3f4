//! Sets whose radius varies, made as users make them and judged, and the counts of their samples.

use serde::{Deserialize, Serialize};
use tilescope_analysis::{Radii, Shape as JudgedShape, VaryingRegion, VerifyOptions};
use tilescope_core::{Boundary, Domain, R, RadiusField, Shape, varying_sample};
use tilescope_sets::{Expression, Ground, RadiusSource, VaryingRecipe, region};

use crate::control::Control;
use crate::error::{ReproduceError, Result};

/// Strips of an integral over x. The smoothest field needs hundreds, the steepest some thousands.
const STRIPS: u32 = 1 << 14;

/// How many samples sets on one field have, and the field's area in squared local radii.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FieldCounts {
    pub counts: Vec<u64>,
    /// The integral of dA / R^2 over the part in which samples are counted.
    pub area: f64,
}

impl FieldCounts {
    /// Returns the number of samples in all sets.
    pub fn samples(&self) -> u64 {
        self.counts.iter().sum()
    }

    /// Returns the density, N R^2, and its standard error by the spread between sets; NaN for fewer than two.
    pub fn density(&self) -> [f64; 2] {
        let sets = self.counts.len() as f64;
        let mean = self.samples() as f64 / sets;
        let squares = self
            .counts
            .iter()
            .map(|&count| (count as f64 - mean).powi(2));
        let spread = squares.sum::<f64>() / (sets - 1.0);
        [mean / self.area, (spread / sets).sqrt() / self.area]
    }
}

/// Returns the integral of a function of x, by strips.
pub fn integral(from: f64, to: f64, of: impl Fn(f64) -> f64) -> f64 {
    let strip = (to - from) / f64::from(STRIPS);
    let middle = |index: u32| from + (f64::from(index) + 0.5) * strip;
    strip * (0..STRIPS).map(|index| of(middle(index))).sum::<f64>()
}

/// A field by an expression of x and y, in a rectangle.
#[derive(Clone, Debug)]
pub struct Written {
    pub radius: String,
    pub size: [f64; 2],
    pub boundary: Boundary,
}

impl Written {
    /// Returns the field and what sets on it are judged in. It takes longer than a set, and serves those of all seeds.
    pub fn ground(&self) -> Result<Ground> {
        // Lengths are in least radii, so that the scale of the field is 1.
        let recipe = VaryingRecipe {
            radius: RadiusSource::Expression {
                expression: Expression::parse(&self.radius)?,
                scale: 1.0,
            },
            shape: None,
            size: self.size.map(Some),
            origin: None,
            boundary: self.boundary,
            // The field depends on no seed.
            seed: 0,
            count: None,
            exact: None,
        };
        Ok(recipe.ground()?)
    }
}

/// Returns the samples of a seed on a field. Fails unless the judge finds the set valid.
pub fn samples(ground: &Ground, seed: u64, control: &Control<'_>) -> Result<Vec<[f64; 2]>> {
    let points = varying_sample(&ground.field, &ground.shape, seed, &mut control.observer())?;
    let users = ground.field.domain().users_from_lattice(&points);

    let judged = &ground.varying.judged;
    let report = judged.verify(&users, &VerifyOptions::default(), &control.analysis())?;
    if !report.valid() {
        let what = format!("a field from the radius {}, seed {seed}", judged.radius());
        return Err(ReproduceError::invalid(&what, &report));
    }
    Ok(users)
}

/// Returns how many samples a torus of `side` radii has whose radius is `octave` times the least one of a field, everywhere.
///
/// The field is not made from an expression. There the lattice follows the least radius, so that an expression with one
/// radius everywhere gives that radius 2^15 units, whatever it is. Here a radius of 1 has 2^15 units, and the field's
/// radius has `octave` times as many.
pub fn plateau(octave: f64, side: f64, seed: u64, control: &Control<'_>) -> Result<u64> {
    let domain = Domain::from_size([side * octave; 2], 1.0, Boundary::Periodic)?;
    let radius = (octave * f64::from(R)).round() as i32;
    let field =
        RadiusField::constant(domain, radius).map_err(tilescope_sets::VaryingError::from)?;
    let points = varying_sample(&field, &Shape::rectangle(), seed, &mut control.observer())?;

    // The judge gets the radius and the sides in units. Its region, and the radius that its report states, are in least radii.
    let (region, sides) = (region(&domain), [domain.width(), domain.height()]);
    let radii = Radii::Constant(radius);
    let judged = VaryingRegion::new(region, sides, octave, radii, &JudgedShape::Rectangle)?;
    let users = domain.users_from_lattice(&points);
    let report = judged.verify(&users, &VerifyOptions::default(), &control.analysis())?;
    if !report.valid() {
        let what = format!("radius {octave}, seed {seed}");
        return Err(ReproduceError::invalid(&what, &report));
    }
    Ok(points.len() as u64)
}
