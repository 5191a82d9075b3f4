//! Radii that vary, and shapes: the arguments of Python, the recipes of sets, and the field and shape that sets are
//! judged by.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use numpy::prelude::*;
use numpy::{PyArray1, PyReadonlyArray2};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use tilescope_core::Boundary;
use tilescope_formats::{Certificate, Overrides, VaryingDomain, first_points};
use tilescope_sets::{
    Expression, Facts, GivenGround, GivenRadius, GrayImage, PlanarPolygon, RadiusGrid,
    RadiusSource, ShapeSource, VaryingRecipe,
};

use crate::arrays::rows;
use crate::domain::GivenDomain;
use crate::failure::Failure;
use crate::image::{Picture, image};
use crate::task::run;
use crate::values::real_if_given;

/// The arguments about a radius that varies and a shape, as the Python class `Field` holds them: at most one field and
/// at most one shape.
#[derive(FromPyObject)]
pub struct FieldArgument<'py> {
    /// The radius where it is the same everywhere, or where the density is 1.
    radius: Option<Bound<'py, PyAny>>,
    expression: Option<String>,
    /// Called with the x of columns and the y of rows of nodes, it returns the radii at nodes.
    function: Option<Bound<'py, PyAny>>,
    /// The radii of pixels.
    radii: Option<PyReadonlyArray2<'py, f64>>,
    /// A PNG file whose grey stands for radii that a certificate states.
    image: Option<PathBuf>,
    /// The image of a stipple, whose radius of black a certificate states.
    picture: Option<Picture<'py>>,
    density: Option<Density<'py>>,
    mask: Option<Pixels<'py>>,
    /// The name of the file or nothing, and `GeoJSON`.
    shape: Option<(String, Vec<u8>)>,
    planar: bool,
}

/// How dense samples are.
#[derive(FromPyObject)]
enum Density<'py> {
    /// Whole numbers of 16 bits, or a PNG file, as on the command line.
    Grey(Pixels<'py>),
    Numbers(PyReadonlyArray2<'py, f64>),
}

/// Pixels with a grey value each.
#[derive(FromPyObject)]
enum Pixels<'py> {
    Array(PyReadonlyArray2<'py, u16>),
    File(PathBuf),
}

impl Pixels<'_> {
    fn image(&self) -> Result<GrayImage, Failure> {
        match self {
            Self::Array(grey) => {
                let columns = grey.shape()[1];
                // Python passes contiguous arrays. Of any other array no pixels are read, and an image without any is
                // refused.
                let grey = grey.as_slice().map(<[u16]>::to_vec);
                Ok(GrayImage::from_grey(columns, grey.unwrap_or_default())?)
            }
            Self::File(path) => image(path),
        }
    }
}

/// Returns the pixels of a row, and all of them; none of an array with gaps, which Python does not pass.
fn pixels<'a>(array: &'a PyReadonlyArray2<'_, f64>) -> (usize, &'a [f64]) {
    (array.shape()[1], array.as_slice().unwrap_or_default())
}

impl FieldArgument<'_> {
    fn shape(&self) -> Result<Option<ShapeSource>, Failure> {
        if let Some((name, text)) = &self.shape {
            let shown = if name.is_empty() { "shape" } else { name };
            let polygon = PlanarPolygon::from_geojson(shown, text, self.planar)?;
            // Certificates name the file of a shape; a shape without a file is known by its corners alone.
            return Ok(Some(ShapeSource::Polygon(if name.is_empty() {
                polygon.unnamed()
            } else {
                polygon
            })));
        }
        let mask = self.mask.as_ref().map(Pixels::image);
        Ok(mask.transpose()?.map(ShapeSource::Mask))
    }

    /// Returns the radius, if it is given as one number.
    pub fn radius(&self) -> PyResult<Option<f64>> {
        real_if_given("radius", self.radius.as_ref())
    }

    /// Returns the field that is given. `like` has the domain, for functions that are evaluated at its nodes.
    fn field(&self, like: &VaryingRecipe) -> PyResult<GivenRadius> {
        let failure = Failure::from;
        if let Some(text) = &self.expression {
            let expression = Expression::parse(text).map_err(failure)?;
            return Ok(GivenRadius::Expression(expression));
        }
        if let Some(function) = &self.function {
            // The nodes of an expression, so that a function with its values makes the same set.
            let [xs, ys] = like.node_places().map_err(failure)?;
            let columns = xs.len();
            let py = function.py();
            let places = (PyArray1::from_vec(py, xs), PyArray1::from_vec(py, ys));
            let radii: PyReadonlyArray2<'_, f64> = function.call1(places)?.extract()?;
            let (_, radii) = pixels(&radii);
            let grid = RadiusGrid::new(columns, radii.to_vec()).map_err(failure)?;
            return Ok(GivenRadius::Grid(grid));
        }

        // An array has its values at pixels, and nodes have the means of those around.
        if let Some(radii) = &self.radii {
            let (columns, radii) = pixels(radii);
            let grid = RadiusGrid::of_pixels(columns, radii, like.boundary).map_err(failure)?;
            return Ok(GivenRadius::Grid(grid));
        }
        // An image stands for radii that only a certificate states.
        if let Some(path) = &self.image {
            return Ok(GivenRadius::Image(image(path)?));
        }
        if let Some(picture) = &self.picture {
            return Ok(GivenRadius::Image(picture.image()?));
        }
        match &self.density {
            None => Ok(GivenRadius::Nothing),
            Some(Density::Grey(grey)) => Ok(GivenRadius::Image(grey.image()?)),
            Some(Density::Numbers(numbers)) => {
                let (columns, density) = pixels(numbers);
                let grid = RadiusGrid::of_density(columns, density, like.boundary);
                Ok(GivenRadius::Grid(grid.map_err(failure)?))
            }
        }
    }

    /// Returns a recipe with this field and this shape in place of its own; the domain, the seed and the count stay.
    pub fn recipe(&self, mut like: VaryingRecipe) -> PyResult<VaryingRecipe> {
        let wanted = |name: &str| {
            PyValueError::new_err(format!("{name} is given without count or radius; give one"))
        };
        // First, as the nodes at which a function is evaluated may depend on the shape.
        like.shape = self.shape()?;
        // With a count the scale is searched for, and any number begins the search.
        let any = like.count.map(|_| 1.0);
        let radius = self.radius()?.or(any);
        // The radii of an expression or an array are lengths. Those of a density are multiples of the radius that
        // stands for a density of 1, which is the one that is given.
        let scale = if self.density.is_some() {
            radius.ok_or_else(|| wanted("density"))?
        } else {
            1.0
        };

        like.radius = match self.field(&like)? {
            GivenRadius::Expression(expression) => RadiusSource::Expression { expression, scale },
            GivenRadius::Grid(grid) => RadiusSource::Grid { grid, scale },
            GivenRadius::Image(image) if self.density.is_some() => {
                // Black pixels have the density 1, and so the radius that is given.
                let black = scale;
                RadiusSource::Density { image, black }
            }
            GivenRadius::Image(_) if self.picture.is_some() => {
                let text = "image is that of a stipple, whose certificate states the radius of black; of positions without \
                            a certificate give density and radius";
                return Err(PyValueError::new_err(text));
            }
            GivenRadius::Image(_) => {
                let text = "radius is the path of an image, which is for sets whose certificate states the radii of black \
                            and white; give an array of radii";
                return Err(PyValueError::new_err(text));
            }
            GivenRadius::Nothing => {
                RadiusSource::Constant(radius.ok_or_else(|| wanted("a shape or a mask"))?)
            }
        };
        Ok(like)
    }
}

/// Returns the recipe of a domain, to which a field and a shape are still to be given. Sides and a corner that are
/// `None` may follow from these.
pub fn bare(size: [Option<f64>; 2], origin: Option<[f64; 2]>, boundary: Boundary) -> VaryingRecipe {
    let expression = Expression::parse("1").map(|expression| RadiusSource::Expression {
        expression,
        scale: 1.0,
    });
    VaryingRecipe {
        // A placeholder, which the field replaces. It is an expression, since a function of Python is evaluated at the nodes
        // that an expression has. "1" always parses, so that the constant is never used. Seed and count are placeholders, too:
        // the caller that makes a set gives them, and a set that is only judged needs neither.
        radius: expression.unwrap_or(RadiusSource::Constant(1.0)),
        shape: None,
        size,
        origin,
        boundary,
        seed: 0,
        count: None,
        exact: None,
    }
}

/// A field and a shape that a set was made from and is judged in.
#[pyclass(frozen, module = "tilescope._tilescope")]
pub struct Ground {
    recipe: VaryingRecipe,
    origin: [f64; 2],
    pub varying: Arc<VaryingDomain>,
}

impl Ground {
    fn new(recipe: VaryingRecipe) -> Result<Self, Failure> {
        let made = recipe.ground()?;
        Ok(Self {
            recipe,
            origin: made.origin,
            varying: made.varying,
        })
    }

    /// Returns the field and the shape that a certificate states. Images have to be given, as it does not state their
    /// pixels; other values that are given take the place of stated ones.
    fn of_certificate(
        stated: &Certificate,
        domain: &GivenDomain,
        field: Option<&FieldArgument<'_>>,
    ) -> PyResult<Self> {
        // With another domain or radius the field and the shape could not have the digests that the certificate states.
        let radius = field.map(FieldArgument::radius).transpose()?.flatten();
        if let Some(name) = domain.first_given(radius) {
            return Err(PyValueError::new_err(format!(
                "{name} is that of the certificate, to which its field and its shape belong; leave it out"
            )));
        }

        let mut given = GivenGround::default();
        if let Some(field) = field {
            // A function is evaluated at the nodes of the stated domain.
            let region = stated.region;
            let origin = stated.origin.unwrap_or_default();
            let boundary = Boundary::of(region.is_periodic());
            let mut like = bare(region.size().map(Some), Some(origin), boundary);
            given.shape = field.shape()?;
            // Where the nodes of the domain lie may depend on its shape.
            like.shape.clone_from(&given.shape);
            given.radius = field.field(&like)?;
        }
        let recipe = VaryingRecipe::of_certificate(stated, given).map_err(Failure::from)?;
        Ok(Self::new(recipe)?)
    }

    /// Returns the field and the shape of a set that was made, if it has any, from its facts. `recipe` is settled, so
    /// that copies of the set need not search for the scale of a count again.
    pub fn of_made(recipe: VaryingRecipe, facts: &Facts) -> Option<Self> {
        let varying = facts.varying.clone()?;
        let origin = facts.origin;
        Some(Self {
            recipe,
            origin,
            varying,
        })
    }

    /// Returns where the domain's lower corner lies.
    pub const fn corner(&self) -> [f64; 2] {
        self.origin
    }

    /// Returns the field and the shape that the file `path` is judged by, those of its certificate or those that are given;
    /// nothing if there are none. `overrides` say how its positions are read.
    pub fn of_file(
        (path, overrides): (&Path, &Overrides),
        stated: Option<&Certificate>,
        domain: &GivenDomain,
        field: Option<&FieldArgument<'_>>,
    ) -> PyResult<Option<Self>> {
        match (stated.filter(|stated| stated.is_varying()), field) {
            (Some(stated), _) => Self::of_certificate(stated, domain, field).map(Some),
            (None, Some(field)) => {
                let like = bare(domain.size(), domain.origin, domain.bounded_or_given()?);
                let mut recipe = field.recipe(like)?;
                // No certificate says by which method a mask was filled, and so on which lattice: the positions show it.
                if recipe.has_two_lattices() {
                    let (positions, format) =
                        first_points(path, overrides).map_err(Failure::from)?;
                    recipe = recipe
                        .fitted_to(&positions, format)
                        .map_err(Failure::from)?;
                }
                Ok(Some(Self::new(recipe)?))
            }
            (None, None) => Ok(None),
        }
    }
}

#[pymethods]
impl Ground {
    /// Returns the field and the shape that [`Self::__reduce__`] stored.
    #[staticmethod]
    fn stored(text: &str) -> PyResult<Self> {
        let recipe =
            serde_json::from_str(text).map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok(Self::new(recipe)?)
    }

    /// Returns a function and its argument, by which `copy` and `pickle` make an equal value.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        let text = serde_json::to_string(&slf.get().recipe)
            .map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok((slf.get_type().getattr("stored")?, (text,)))
    }

    /// Returns width, height and boundary of the domain.
    fn domain(&self) -> (f64, f64, &'static str) {
        let region = self.varying.judged.region();
        let boundary = if region.is_periodic() {
            "periodic"
        } else {
            "bounded"
        };
        (region.width, region.height, boundary)
    }

    /// Returns where the domain's lower corner lies in the coordinates of shapes and functions.
    fn origin(&self) -> (f64, f64) {
        self.origin.into()
    }

    /// Returns the least radius.
    fn least(&self) -> f64 {
        self.varying.radius.least()
    }

    /// Returns the greatest radius.
    fn greatest(&self) -> f64 {
        self.varying.radius.greatest()
    }

    /// Returns whether the radius depends on the place.
    fn varies(&self) -> bool {
        self.varying.radius.varies()
    }

    /// Returns whether only a part of the domain is to be covered.
    fn has_shape(&self) -> bool {
        self.varying.shape.is_some()
    }

    /// Returns the radius at each of some positions of the domain; nothing if it is the same everywhere.
    fn radii<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let points = rows(&points)?;
        let radii = run(py, None, |_| Ok(self.varying.radii(points)))?;
        // Read-only, as all arrays of a set are.
        let array = PyArray1::from_vec(py, radii);
        array.readwrite().make_nonwriteable();
        Ok(array)
    }
}

/// Returns the field and the shape by which positions of unknown origin are judged.
#[pyfunction]
pub fn ground_of(given: GivenDomain, field: FieldArgument<'_>) -> PyResult<Ground> {
    let like = bare(given.size(), given.origin, given.bounded_or_given()?);
    Ok(Ground::new(field.recipe(like)?)?)
}
