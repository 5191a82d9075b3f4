//! Arguments of several functions: the parameters of a run, a set, levels, a file.

use std::sync::Arc;

use numpy::{PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::{Value, json};
use tilescope_analysis::{JudgeChoice, PrefixClaim, Region, VerifyOptions};
use tilescope_core::{
    MAXIMAL_DENSITY, NOT_OF_EXACT, NestedRequest, Parameter, ParameterError, ParameterKind,
    Parameters, Pattern, PatternSpec, Search, WithinLevel, radius_estimate,
};
use tilescope_formats::{Format, Overrides, VaryingDomain, positions_digest};
use tilescope_sets::{
    ExactBlocks, GivenPattern, KnownDomain, Recipe, Stated, StatedSet, exact_pattern, stated,
};

use crate::arrays::rows;
use crate::drawing::DrawingFields;
use crate::failure::Failure;
use crate::ground::Ground;
use crate::task::{TaskWatch, run};
use crate::values::{named, real, real_if_given, shortened, shown, whole};

/// Returns how to verify. No name stands for both judges up to 2^20 samples, and covered circles for more.
pub fn verify_options(judge: Option<&str>) -> PyResult<VerifyOptions> {
    let judges = judge.map(|judge| named::<JudgeChoice>("judge", judge));
    Ok(VerifyOptions {
        judges: judges.transpose()?.unwrap_or_default(),
        ..VerifyOptions::default()
    })
}

/// Returns a file format by its name.
pub fn format(name: Option<&str>) -> PyResult<Option<Format>> {
    let named = name.map(|name| shortened(name).parse::<Format>());
    (named.transpose()).map_err(|error| PyValueError::new_err(error.to_string()))
}

/// Returns the overrides of a file that the arguments give: its format, and which of several sets is meant.
pub fn overrides(format_name: Option<&str>, set: Option<&Bound<'_, PyAny>>) -> PyResult<Overrides> {
    let index = set.map(|set| whole("set", set)).transpose()?;
    Ok(Overrides {
        format: format(format_name)?,
        // No file holds so many.
        set: index.map(|index| usize::try_from(index).unwrap_or(usize::MAX)),
        ..Overrides::default()
    })
}

/// Checks the domain and radius of a set: raises `ValueError` for values that no set can have.
#[pyfunction]
pub fn check_domain(
    radius: Option<&Bound<'_, PyAny>>,
    width: &Bound<'_, PyAny>,
    height: &Bound<'_, PyAny>,
    boundary: &str,
) -> PyResult<()> {
    let radius = real_if_given("radius", radius)?;
    let (width, height) = (real("width", width)?, real("height", height)?);
    // Also refuses NaN, which no comparison holds for.
    if let Some(radius) = radius.filter(|radius| !(radius.is_finite() && *radius > 0.0)) {
        return Err(Failure::from(ParameterError::Radius { radius }).into());
    }

    let region = Region {
        width,
        height,
        boundary: named("boundary", boundary)?,
    };
    if region.is_supported() {
        return Ok(());
    }
    let error = tilescope_analysis::VerifyError::BadRegion { width, height };
    Err(PyValueError::new_err(error.to_string()))
}

/// A level, as the Python class `Level` holds it.
#[derive(FromPyObject)]
pub struct LevelArgument {
    count: usize,
    distance: f64,
    covering: Option<f64>,
}

/// Returns the claims about the levels of a set.
pub fn claims(levels: &[LevelArgument]) -> Vec<PrefixClaim> {
    let claim = |level: &LevelArgument| (level.count, level.distance, level.covering).into();
    levels.iter().map(claim).collect()
}

/// Count, distance and covering of a level, which Python makes a `Level` of.
pub type LevelFields = (usize, f64, Option<f64>);

/// Returns the claims about levels as Python takes them.
pub fn level_fields(claims: &[PrefixClaim]) -> Vec<LevelFields> {
    let fields = |claim: &PrefixClaim| (claim.count, claim.distance, claim.covering);
    claims.iter().map(fields).collect()
}

/// Returns the claim that holds for the first `count` samples of a set with levels.
#[pyfunction]
pub fn prefix(levels: Vec<LevelArgument>, count: &Bound<'_, PyAny>) -> PyResult<LevelFields> {
    let count = usize::try_from(whole("count", count)?).unwrap_or(usize::MAX);
    let missing = || PyValueError::new_err(format!("the levels have fewer than {count} samples"));
    let claim = PrefixClaim::within(&claims(&levels), count).ok_or_else(missing)?;
    Ok((claim.count, claim.distance, claim.covering))
}

/// A set, as the Python class `PointSet` holds it.
#[derive(FromPyObject)]
pub struct SetArgument<'py> {
    points: PyReadonlyArray2<'py, f64>,
    pub provenance: Option<PyReadonlyArray2<'py, u32>>,
    domain: (f64, f64, String),
    /// The position in files of the domain's lower corner.
    pub origin: (f64, f64),
    radius: Option<f64>,
    pub levels: Vec<LevelArgument>,
    /// The rank of each sample, if it is known.
    #[pyo3(attribute("_ranks"))]
    ranks: Option<PyReadonlyArray1<'py, f64>>,
    pub method: String,
    /// The field and the shape, if its radius varies or it covers a shape.
    #[pyo3(attribute("_ground"))]
    pub ground: Option<Py<Ground>>,
    /// How many samples were made, if the set is the first of those.
    #[pyo3(attribute("_first_of"))]
    pub made: Option<u64>,
    /// How its samples are drawn as dots, if it is a stipple.
    #[pyo3(attribute("_drawing"))]
    pub drawing: Option<DrawingFields>,
    /// The parameters as a JSON object.
    #[pyo3(attribute("_parameters"))]
    pub parameters: String,
}

impl SetArgument<'_> {
    pub fn points(&self) -> PyResult<&[[f64; 2]]> {
        rows(&self.points)
    }

    /// Returns the rank of each sample, or nothing if they are not known.
    pub fn ranks(&self) -> PyResult<Vec<f64>> {
        let copied = self.ranks.as_ref().map(|ranks| ranks.to_vec());
        let copied = copied.transpose();
        copied
            .map(Option::unwrap_or_default)
            .map_err(|error| PyValueError::new_err(format!("the ranks have gaps: {error}")))
    }

    pub fn region(&self) -> PyResult<Region> {
        let (width, height, boundary) = &self.domain;
        Ok(Region {
            width: *width,
            height: *height,
            boundary: named("boundary", boundary)?,
        })
    }

    pub const fn known_radius(&self) -> Option<f64> {
        self.radius
    }

    /// Returns the radius, or an error that asks for it.
    pub fn radius(&self) -> PyResult<f64> {
        let missing = "the radius of the set is not known; give radius";
        self.radius.ok_or_else(|| PyValueError::new_err(missing))
    }

    /// Returns what the set is judged in, if its radius varies or it covers a shape.
    pub fn varying(&self) -> Option<Arc<VaryingDomain>> {
        let ground = self.ground.as_ref()?;
        Some(Arc::clone(&ground.get().varying))
    }

    /// Refuses a set whose radius varies or that covers a shape, for what takes one radius and rectangles alone.
    pub fn refuse_ground(&self, what: &str) -> PyResult<()> {
        match self.ground {
            None => Ok(()),
            Some(_) => Err(PyValueError::new_err(format!(
                "the set's radius varies or it covers a shape, which {what} does not take into account"
            ))),
        }
    }

    /// Returns the domain with the radius. Fails without a radius, and for a set whose radius varies or that covers a
    /// shape.
    pub fn known_domain(&self) -> PyResult<KnownDomain> {
        self.refuse_ground("a pattern or a combination")?;
        Ok(KnownDomain {
            region: self.region()?,
            radius: self.radius()?,
        })
    }
}

/// Returns the parameters of a run, and which of them are given. The others have their defaults; a radius that is not
/// given is 0 until [`settle_radius`] replaces it.
fn parameters_of(
    given: Option<&Bound<'_, PyDict>>,
    radius: Option<f64>,
) -> PyResult<(Parameters, Vec<Parameter>)> {
    let mut found = Vec::new();
    let mut parameters = Parameters {
        radius: radius.unwrap_or_default(),
        ..Parameters::default()
    };

    // In the order of the caller, so that the first wrong argument is the one that is named. Without a dictionary none
    // is given.
    for (name, value) in given.into_iter().flatten() {
        let name: String = name.extract()?;
        // The method is an argument of its own, with the reference sampler among its values.
        let mut all = Parameter::all().filter(|it| *it != Parameter::Method);
        let Some(parameter) = all.find(|it| it.key().replace('-', "_") == name) else {
            return Err(PyTypeError::new_err(format!(
                "there is no parameter {name}"
            )));
        };
        set_parameter(&mut parameters, parameter, &name, &value)?;
        found.push(parameter);
    }
    Ok((parameters, found))
}

/// Sets a parameter to a value of Python.
fn set_parameter(
    parameters: &mut Parameters,
    parameter: Parameter,
    name: &str,
    value: &Bound<'_, PyAny>,
) -> PyResult<()> {
    let wrong_type = |error: PyErr| {
        let said = error.value(value.py());
        PyTypeError::new_err(format!("argument '{name}': {said}"))
    };

    match &parameter.row().kind {
        ParameterKind::Real { place, .. } => *place(parameters) = real(name, value)?,
        ParameterKind::Whole(place) => *place(parameters) = whole(name, value)?,
        ParameterKind::Switch { place, .. } => {
            *place(parameters) = value.extract().map_err(wrong_type)?;
        }
        // In Python `search` is the number of radii, and no name.
        ParameterKind::Choice { .. } if parameter == Parameter::Search => {
            parameters.search = search_of(value)?;
        }
        ParameterKind::Choice { set, .. } => {
            // No name is so long that it would be shortened.
            let chosen = shortened(value.extract().map_err(wrong_type)?);
            let wrong = |error| PyValueError::new_err(format!("{name} is '{chosen}': {error}"));
            set(parameters, Value::from(chosen.as_str())).map_err(wrong)?;
        }
    }
    Ok(())
}

/// Returns how far detectors look for gaps, by the number of radii.
fn search_of(radii: &Bound<'_, PyAny>) -> PyResult<Search> {
    match radii.extract::<i64>() {
        Ok(4) => Ok(Search::Complete),
        Ok(2) => Ok(Search::TwoRadii),
        // A whole number that is too large raises another error than an object of a wrong type.
        found => {
            let text = format!("search is {}; it must be 4 or 2", shown(radii));
            let is_type = found.is_err_and(|error| error.is_instance_of::<PyTypeError>(radii.py()));
            Err(if is_type {
                PyTypeError::new_err(text)
            } else {
                PyValueError::new_err(text)
            })
        }
    }
}

/// Returns the request for nested levels, if there is one. Refuses other arguments of levels without it.
fn nested_of(
    levels: Option<u64>,
    exactly: Option<u64>,
    order_within: WithinLevel,
) -> PyResult<Option<NestedRequest>> {
    let Some(levels) = levels else {
        // An argument without effect would be believed to have one.
        if exactly.is_some() {
            return Err(refused("exactly is given without levels"));
        }
        if order_within != WithinLevel::default() {
            return Err(refused("order_within is given without levels"));
        }
        return Ok(None);
    };

    // A number that the type cannot hold is refused later, as any number that is too large.
    Ok(Some(NestedRequest {
        levels: u32::try_from(levels).unwrap_or(u32::MAX),
        order_within,
        exactly: exactly.map(|count| usize::try_from(count).unwrap_or(usize::MAX)),
    }))
}

/// Refuses what nested levels have no use for.
fn check_beside_levels(has_count: bool, has_pattern: bool) -> PyResult<()> {
    if has_count {
        let text = "count is given with levels; give exactly, or radius";
        return Err(refused(text));
    }
    if has_pattern {
        let text = "pattern is given with levels, which have a nested pattern of their own";
        return Err(refused(text));
    }
    Ok(())
}

/// Checks that one argument says how large the set is, and then all parameters, before anything is made. For a number of
/// samples the parameters get an estimate of the radius.
fn settle_radius(
    parameters: &mut Parameters,
    count: Option<u64>,
    exactly: Option<u64>,
    radius: Option<f64>,
) -> PyResult<()> {
    match (count.or(exactly), radius) {
        // Both numbers of samples at once were refused before: exactly comes with levels, and count without.
        (Some(_), Some(_)) if exactly.is_some() => {
            Err(refused("both exactly and radius are given; give one"))
        }
        (Some(_), Some(_)) => Err(refused("both count and radius are given; give one")),

        (None, None) => Err(refused("neither count nor radius is given; give one")),
        (Some(count), None) => {
            // The radius is searched for later. Its estimate is near enough to find wrong arguments by.
            parameters.radius = radius_estimate(parameters, count).map_err(Failure::from)?;
            Ok(())
        }
        // The parameters hold this radius already.
        (None, Some(_)) => {
            parameters.validate().map_err(Failure::from)?;
            Ok(())
        }
    }
}

/// Returns the origin of a given pattern: the one that is stated, or else, as also for a text that is no JSON, the
/// digest of its positions.
fn source_of(given: &SetArgument<'_>, source: Option<&str>) -> PyResult<Value> {
    if let Some(Ok(source)) = source.map(serde_json::from_str) {
        return Ok(source);
    }
    Ok(json!({ "positions_digest": positions_digest(given.points()?) }))
}

/// Returns a given set as a pattern. Fails when it is not conflict-free and maximal.
fn pattern_of(py: Python<'_>, given: &SetArgument<'_>) -> PyResult<Arc<Pattern>> {
    let (points, domain) = (given.points()?, given.known_domain()?);
    Ok(run(py, None, |_| Ok(domain.set(points)?))?.pattern)
}

fn refused(text: &str) -> PyErr {
    PyValueError::new_err(text.to_owned())
}

/// What a run is to be made from.
#[pyclass(frozen, module = "tilescope._tilescope")]
pub struct RunRequest {
    pub recipe: Recipe,
    /// The parameters that are given, whatever their values.
    given: Vec<Parameter>,
    /// Nested levels, if they are asked for.
    pub nested: Option<NestedRequest>,
    /// The set that is given as the pattern.
    given_set: Option<GivenSet>,
}

/// A set that is given as a pattern, with how it was made: exact tiling throws the darts of one by the reference sampler again.
struct GivenSet {
    method: String,
    parameters: Stated,
    known: KnownDomain,
    origin: [f64; 2],
    points: Vec<[f64; 2]>,
}

impl GivenSet {
    fn of(set: &SetArgument<'_>) -> PyResult<Self> {
        Ok(Self {
            method: set.method.clone(),
            // A set whose parameters are no JSON object has no seed, and is refused for that.
            parameters: serde_json::from_str(&set.parameters).unwrap_or_default(),
            known: set.known_domain()?,
            origin: set.origin.into(),
            points: set.points()?.to_vec(),
        })
    }

    /// Returns the pattern with the arrivals of its samples; `source` says where the set is from.
    fn arrived(&self, source: Value, watch: &TaskWatch) -> Result<GivenPattern, Failure> {
        let set = StatedSet {
            method: &self.method,
            parameters: &self.parameters,
            known: self.known,
            origin: self.origin,
            points: &self.points,
        };
        GivenPattern::of_reference(&set, source, &mut watch.observer()).map_err(Failure::from)
    }
}

#[pymethods]
impl RunRequest {
    /// Returns the request, or raises the first error in the arguments. `pattern_source` says where a given pattern is
    /// from, as JSON.
    #[new]
    #[pyo3(signature = (
        *, count, radius, pattern, pattern_source, levels, exactly, order_within, **parameters
    ))]
    #[expect(
        clippy::too_many_arguments,
        reason = "each is one of Python's, by its name"
    )]
    fn new(
        py: Python<'_>,
        count: Option<&Bound<'_, PyAny>>,
        radius: Option<&Bound<'_, PyAny>>,
        pattern: Option<SetArgument<'_>>,
        pattern_source: Option<&str>,
        levels: Option<&Bound<'_, PyAny>>,
        exactly: Option<&Bound<'_, PyAny>>,
        order_within: &str,
        parameters: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        let count = count.map(|count| whole("count", count)).transpose()?;
        let exactly = exactly.map(|count| whole("exactly", count)).transpose()?;
        let levels = levels.map(|levels| whole("levels", levels)).transpose()?;
        // Arguments that exclude each other are refused for any values, and so before the values of parameters are
        // checked.
        let nested = nested_of(levels, exactly, named("order_within", order_within)?)?;
        if nested.is_some() {
            check_beside_levels(count.is_some(), pattern.is_some())?;
        }

        let radius = real_if_given("radius", radius)?;
        let (mut parameters, given) = parameters_of(parameters, radius)?;
        settle_radius(&mut parameters, count, exactly, radius)?;

        // The pattern comes last, as it is verified, which takes longest.
        let verified = |set: SetArgument<'_>| -> PyResult<GivenPattern> {
            Ok(GivenPattern {
                source: source_of(&set, pattern_source)?,
                pattern: pattern_of(py, &set)?,
                // Only exact tiling asks when samples arrived.
                arrivals: None,
            })
        };
        let given_set = pattern.as_ref().map(GivenSet::of).transpose()?;
        let recipe = Recipe {
            parameters,
            count,
            pattern: pattern.map(verified).transpose()?,
        };
        Ok(Self {
            recipe,
            given,
            nested,
            given_set,
        })
    }

    /// Returns the side in radii of the generated pattern if it repeats within blocks, and that of one that would not. Raises
    /// what tiling raises for the arguments.
    fn repeating_pattern(&self, is_exact: bool) -> PyResult<Option<(f64, f64)>> {
        let parameters = match is_exact {
            _ if self.recipe.pattern.is_some() || self.nested.is_some() => return Ok(None),
            false => self.recipe.parameters,
            true => self.exact_parameters()?,
        };
        let needed = parameters.side_without_repeats();
        Ok(needed.map(|needed| (parameters.pattern.side, needed)))
    }
}

impl RunRequest {
    /// Returns the recipe for exact tiling: the darts of a given pattern are thrown again. Refuses by their names the
    /// arguments that it has no use for, and a pattern that the reference sampler did not make.
    pub fn exact_recipe(&self, py: Python<'_>) -> PyResult<Recipe> {
        let mut recipe = Recipe {
            parameters: self.exact_parameters()?,
            ..self.recipe.clone()
        };
        // The samples of a given pattern are known, but exact tiling also needs the darts that were refused.
        if let (Some(set), Some(given)) = (&self.given_set, &recipe.pattern) {
            let source = given.source.clone();
            let arrived = |watch: &TaskWatch| set.arrived(source, watch);
            recipe.pattern = Some(run(py, None, arrived)?);
        }
        Ok(recipe)
    }

    /// Returns the parameters with the pattern of exact tiling. Refuses arguments that exact tiling has no use for.
    fn exact_parameters(&self) -> PyResult<Parameters> {
        // With a count the radius is an estimate, which is near enough to choose the pattern by.
        let asked = self.recipe.parameters;
        let domain = asked.validate().map_err(Failure::from)?;
        Ok(Parameters {
            pattern: self.exact_pattern(domain.area_radii() * MAXIMAL_DENSITY)?,
            ..asked
        })
    }

    /// Returns the blocks of an exact tiling of about so many samples, and refuses by their names the arguments that it has no use
    /// for.
    pub fn exact_blocks(&self, samples: f64) -> PyResult<ExactBlocks> {
        // The recipe of a shape describes its pattern, and holds none.
        if self.recipe.pattern.is_some() {
            let text = "pattern is given with shape: exact tiling of a shape makes its pattern";
            return Err(refused(text));
        }
        Ok(ExactBlocks {
            pattern: self.exact_pattern(samples)?,
            ..ExactBlocks::from(&self.recipe.parameters)
        })
    }

    /// Returns the pattern of exact tiling for about so many samples. Refuses arguments that exact tiling has no use for.
    fn exact_pattern(&self, samples: f64) -> PyResult<PatternSpec> {
        let asked = &self.recipe.parameters;
        // An argument that is given its default is no mistake.
        let defaults = Parameters::default();
        let is_unused =
            |it: &Parameter| NOT_OF_EXACT.contains(it) && it.value(asked) != it.value(&defaults);
        if let Some(unused) = Parameter::all().find(is_unused) {
            let name = unused.key();
            return Err(refused(&format!(
                "{name} is given with method 'exact', which keeps whatever arrived first: leave it out"
            )));
        }

        Ok(exact_pattern(asked, &self.given, samples))
    }

    /// Returns every parameter by its name, with the radius of the run, those of levels among the others.
    pub fn stated(&self, radius: f64) -> Stated {
        let mut all = self.recipe.stated(radius);
        all.extend(self.nested.iter().flat_map(stated));
        all
    }
}
