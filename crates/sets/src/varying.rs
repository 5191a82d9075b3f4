//! Sets whose radius varies, and sets that cover a shape: from a request to a made set, and from a certificate back to
//! what its set is judged in.
//!
//! Begin with [`VaryingRecipe`]. Its [`VaryingRecipe::ground`] is the field and the shape in lattice units, for the sampler and
//! for the judge. A field is integers at nodes: all that is computed in `f64` is done once for each node.

mod count;
mod error;
mod exactly;
mod expression;
mod grid;
mod ground;
mod image;
mod nodes;
mod painting;
mod pictures;
mod polygon;
mod source;
mod stipple;
#[cfg(test)]
pub(crate) mod tests;
mod window;

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use tilescope_core::memory::{Making, ask_for};
use tilescope_core::{
    Boundary, MAXIMAL_DENSITY, Observer, Parameters, PatternHistory, PatternSpec, Run, SampleError,
    exact_in_shape_parallel, varying_sample,
};
use tilescope_formats::{Certificate, CertifiedShape, PointSet};

use crate::facts::{Facts, Stated};
use crate::made::Made;
use crate::recipe::facts_of_exact;

use count::{CountSearch, Step};

pub use error::VaryingError;
pub use expression::{Expression, MAX_EXPRESSION};
pub use grid::RadiusGrid;
pub use ground::{Ground, check_pixels};
pub use image::{GrayImage, MAX_PIXELS, Tone};
pub use painting::{Brush, BrushStroke, PAINTED, PaintedRadii};
pub use pictures::ComputedPicture;
pub use polygon::{MAX_CORNERS, PlanarPolygon};
pub use source::{RadiusSource, ShapeSource};
pub use stipple::{DEFAULT_WHITE, Stipple, StippleLook, StippleRecipe, check_white, color_of};
pub use window::WindowMade;

/// The most sets that are made in search of a stipple; of twenty small images no one took more than five.
const MAX_RUNS: usize = 12;

/// What a set is made from whose radius varies, or that covers a shape.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VaryingRecipe {
    /// Where the radius comes from; with a count, its scale is free.
    pub radius: RadiusSource,
    /// The area to cover; without a shape, the whole domain.
    pub shape: Option<ShapeSource>,
    /// Width and height of the domain. Those that are not given follow from the polygon or from the pixels, or are 1.
    pub size: [Option<f64>; 2],
    /// Where the lower corner of the domain lies in the coordinates of polygons and expressions. If neither it nor a side is
    /// given, the domain is the rectangle around the polygon.
    pub origin: Option<[f64; 2]>,
    /// How the domain ends.
    pub boundary: Boundary,
    /// The seed of all random draws.
    pub seed: u64,
    /// How many samples there are to be, to within a hundredth.
    pub count: Option<u64>,
    /// The blocks of exact tiling, which then makes the set and needs a radius that is the same everywhere; without them the
    /// reference sampler makes it.
    #[serde(default)]
    pub exact: Option<ExactBlocks>,
}

/// The blocks of an exact tiling of a shape: parameters that the reference sampler does not have.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ExactBlocks {
    /// The shortest edge of a block, in radii.
    pub leaf: f64,
    /// The pattern whose darts blocks clip.
    pub pattern: PatternSpec,
    /// Whether blocks clip from all rotations and mirror images of the pattern.
    pub dihedral: bool,
}

impl ExactBlocks {
    /// Returns the blocks that the certificate of an exact tiling states; `None` if it does not state all of them.
    #[must_use]
    pub fn of_certificate(stated: &Certificate) -> Option<Self> {
        let of_name = |name: &str| stated.parameters.get(name).cloned();
        Some(Self {
            leaf: of_name("leaf")?.as_f64()?,
            pattern: serde_json::from_value(of_name("pattern")?).ok()?,
            dihedral: of_name("dihedral")?.as_bool()?,
        })
    }
}

impl From<&Parameters> for ExactBlocks {
    fn from(parameters: &Parameters) -> Self {
        Self {
            leaf: parameters.leaf,
            pattern: parameters.pattern,
            dihedral: parameters.dihedral,
        }
    }
}

impl VaryingRecipe {
    /// Returns the field, the shape and the domain in which the set of a certificate is judged, as a recipe without the
    /// set's seed and count. Images are taken from `given`, and other given values take the place of stated ones.
    ///
    /// # Errors
    ///
    /// [`VaryingError::Needed`] when a file is not given, [`VaryingError::Unstated`] when the certificate does not say, and
    /// those of an expression.
    pub fn of_certificate(stated: &Certificate, given: GivenGround) -> Result<Self, VaryingError> {
        let radius = RadiusSource::of_certificate(stated, given.radius)?;
        let dark = || ShapeSource::dark_of_certificate(stated, &radius);
        let shape = match (given.shape, &stated.shape) {
            (Some(shape), _) => Some(shape),
            (None, Some(CertifiedShape::Polygon { rings })) => {
                let polygon = PlanarPolygon::of_rings(rings.clone());
                Some(ShapeSource::Polygon(polygon))
            }
            // A certificate holds no pixels. Dark places follow from the density's image; other masks must be given.
            (None, Some(CertifiedShape::Mask { .. })) => {
                let needed = || needed("a mask", &stated.parameters, "mask", "--mask");
                Some(dark().ok_or_else(needed)?)
            }
            (None, None) => None,
        };

        // Both sides are stated, and so is the corner unless it lies at 0: nothing follows from the shape.
        let region = stated.region;
        Ok(Self {
            radius,
            shape,
            size: region.size().map(Some),
            origin: Some(stated.origin.unwrap_or_default()),
            boundary: Boundary::of(region.is_periodic()),
            // Nothing is made by this recipe, so that neither seed nor count has a meaning.
            seed: 0,
            count: None,
            // Exact tiling has a lattice of its own, in which masks are judged. The lattice is the same for all blocks,
            // so that the default ones stand here.
            exact: (stated.method == "exact").then(|| ExactBlocks::from(&Parameters::default())),
        })
    }

    /// Makes the set.
    ///
    /// # Errors
    ///
    /// [`VaryingError`] when field, shape or domain are refused, when the set would be too large, when no scale of the radii
    /// gives the count, and when it is cancelled.
    pub fn make(&self, observer: &mut dyn Observer) -> Result<Made, VaryingError> {
        Ok(self.make_settled(observer)?.0)
    }

    /// Makes the set, and returns also the recipe with the radii that it has, without a count.
    ///
    /// # Errors
    ///
    /// As [`Self::make`].
    pub fn make_settled(&self, observer: &mut dyn Observer) -> Result<(Made, Self), VaryingError> {
        let settled = |radius: RadiusSource| Self {
            radius,
            shape: self.shape.clone(),
            count: None,
            ..*self
        };
        // The pattern's lengths are in radii, so that every try has the same pattern.
        let pattern = |blocks: ExactBlocks| PatternHistory::of_spec(&blocks.pattern, observer);
        let history = self.exact.map(pattern).transpose()?;
        let history = history.as_ref();

        let Some(count) = self.count else {
            let made = self.attempt(&self.radius, history, observer)?;
            return Ok((made, settled(self.radius.clone())));
        };

        // The estimate does not check the source, as each attempt does.
        self.radius.check()?;
        let mut search = CountSearch::new(count);
        let estimate = search.scale_for(self.expected(&self.radius)?);
        let mut radius = self.radius.scaled(estimate);

        loop {
            let made = self.attempt(&radius, history, observer);
            let made = made.map_err(|error| error.of_count(count))?;
            match search.after(made.set.len() as u64) {
                Step::Found => return Ok((made, settled(radius))),
                Step::Again { scale } => radius = radius.scaled(scale),
                Step::Missed { nearest } => return Err(VaryingError::Count { count, nearest }),
            }
        }
    }

    /// Makes the set with these radii: by exact tiling, if its pattern's `history` is given, and otherwise by the reference
    /// sampler.
    fn attempt(
        &self,
        radius: &RadiusSource,
        history: Option<&PatternHistory>,
        observer: &mut dyn Observer,
    ) -> Result<Made, VaryingError> {
        let ground = self.ground_of(radius)?;
        // Memory is asked for before it is needed: a program ends at once when an allocation fails.
        let making = if history.is_some() {
            Making::Exact
        } else {
            Making::Varying
        };
        let bytes = making.bytes_a_sample();
        ask_for(self.expected(radius)?, bytes).map_err(SampleError::from)?;
        if let Some((blocks, history)) = self.exact.zip(history) {
            return self.tiled(radius, &ground, blocks, history, observer);
        }

        let points = varying_sample(&ground.field, &ground.shape, self.seed, observer)?;
        // Every place of the shape is covered, so that only an empty shape has no sample.
        if points.is_empty() {
            return Err(VaryingError::Nothing);
        }

        Ok(Made {
            set: PointSet::from_points(ground.field.domain().users_from_lattice(&points)),
            facts: self.facts_of_darts(radius, &ground),
        })
    }

    /// Returns the facts of a set on a ground that the reference sampler makes.
    fn facts_of_darts(&self, radius: &RadiusSource, ground: &Ground) -> Facts {
        let parameters = self.stated(radius, ground);
        Facts {
            // Where the radius varies, this is the least one.
            radius: ground.varying.judged.radius(),
            origin: ground.origin,
            capped: ground.capped(radius),
            varying: Some(Arc::clone(&ground.varying)),
            ..Facts::new("reference", parameters, ground.field.domain())
        }
    }

    /// Makes the set by exact tiling.
    fn tiled(
        &self,
        radius: &RadiusSource,
        ground: &Ground,
        blocks: ExactBlocks,
        history: &PatternHistory,
        observer: &mut dyn Observer,
    ) -> Result<Made, VaryingError> {
        let parameters = self.tiling_of(radius, ground, blocks)?;
        let run = exact_in_shape_parallel(&parameters, history, &ground.shape, observer)?;
        // Every place of the shape is covered, so that only an empty shape has no sample.
        if run.result.is_empty() {
            return Err(VaryingError::Nothing);
        }

        let facts = Facts {
            origin: ground.origin,
            varying: Some(Arc::clone(&ground.varying)),
            ..self.facts_of_tiling(&run)
        };
        Ok(Made::of_run(&run, facts))
    }

    /// Returns the parameters of an exact tiling of this recipe's shape, whose radius must be the same everywhere.
    fn tiling_of(
        &self,
        radius: &RadiusSource,
        ground: &Ground,
        blocks: ExactBlocks,
    ) -> Result<Parameters, VaryingError> {
        let RadiusSource::Constant(radius) = *radius else {
            return Err(VaryingError::ExactRadius);
        };
        let [width, height] = ground.field.domain().size();
        Ok(Parameters {
            width,
            height,
            radius,
            boundary: self.boundary,
            seed: self.seed,
            leaf: blocks.leaf,
            pattern: blocks.pattern,
            dihedral: blocks.dihedral,
            ..Parameters::default()
        })
    }

    /// Returns the facts of an exact tiling of this recipe's shape, but for the ground in which it is judged.
    #[must_use]
    pub fn facts_of_tiling(&self, run: &Run) -> Facts {
        let samples = run.result.len() as f64;
        self.with_shape(facts_of_exact(
            &run.parameters,
            &run.domain,
            &run.pattern,
            samples,
        ))
    }

    /// Returns the facts of an exact tiling with its shape among the parameters.
    fn with_shape(&self, mut facts: Facts) -> Facts {
        if let Some((name, value)) = self.shape.as_ref().and_then(ShapeSource::stated) {
            facts.parameters.insert(name.to_owned(), value);
        }
        facts
    }

    /// Returns field and shape in lattice units.
    ///
    /// # Errors
    ///
    /// [`VaryingError`] when field, shape or domain are refused.
    pub fn ground(&self) -> Result<Ground, VaryingError> {
        self.ground_of(&self.radius)
    }

    /// Returns what certificates state of the way in which a set on this ground is made, which is that of [`Self::ground`].
    #[must_use]
    pub fn stated_on(&self, ground: &Ground) -> Stated {
        self.stated(&self.radius, ground)
    }

    /// Returns about how many samples there are, if all of the domain is covered.
    ///
    /// # Errors
    ///
    /// [`VaryingError`] when field, shape or domain are refused, as far as this needs them.
    pub fn expected_samples(&self) -> Result<f64, VaryingError> {
        self.radius.check()?;
        self.expected(&self.radius)
    }

    /// Returns what certificates state of the way in which the set was made. A count is not stated: the radii are those
    /// that gave it.
    fn stated(&self, radius: &RadiusSource, ground: &Ground) -> Stated {
        // The sides of the domain that was made: those that were asked for may be missing.
        let [width, height] = ground.field.domain().size();
        let mut stated = Stated::from([
            ("width".to_owned(), width.into()),
            ("height".to_owned(), height.into()),
            ("boundary".to_owned(), json!(self.boundary)),
            ("seed".to_owned(), self.seed.into()),
        ]);
        let (name, value) = radius.stated();
        stated.insert(name.to_owned(), value);
        if let Some((name, value)) = self.shape.as_ref().and_then(ShapeSource::stated) {
            stated.insert(name.to_owned(), value);
        }
        stated
    }
}

/// A field and a shape that are given to judge a set, besides its certificate.
#[derive(Clone, Debug, Default)]
pub struct GivenGround {
    /// The field: an expression, an image or a grid.
    pub radius: GivenRadius,
    /// The area to cover, if it is no rectangle.
    pub shape: Option<ShapeSource>,
}

/// A field that is given without its radii, which a certificate states.
#[derive(Clone, Debug, Default)]
pub enum GivenRadius {
    /// No field is given.
    #[default]
    Nothing,
    /// An expression in the coordinates of the domain.
    Expression(Expression),
    /// An image, whose grey is the radius or the density.
    Image(GrayImage),
    /// Radii at the nodes of a grid.
    Grid(RadiusGrid),
}

/// The error of a file that a certificate states and that is not given.
fn needed(what: &'static str, stated: &Stated, name: &str, option: &'static str) -> VaryingError {
    let file = stated.get(name).and_then(|value| value["file"].as_str());
    VaryingError::Needed {
        what,
        file: file.unwrap_or("FILE").to_owned(),
        option,
    }
}

/// Returns a file by its name and its digest, as certificates state it.
fn stated_file(name: &str, digest: &str) -> Value {
    json!({ "file": name, "digest": digest })
}

/// Returns about how many samples there are in an area of some radius.
fn samples_in(area: f64, radius: f64) -> f64 {
    MAXIMAL_DENSITY * area / (radius * radius)
}
