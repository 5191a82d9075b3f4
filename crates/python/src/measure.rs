//! Measures of a set: the numbers of `tilescope analyze`, the spectrum, the pair correlation.

use numpy::prelude::*;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use tilescope_analysis::measures::{
    Discrepancy, MeasureError, NearestDistances, Order, PairBins, PairCorrelation, Periodogram,
    PowerCurve, Spectrum,
};
use tilescope_analysis::{VerifyOptions, verify};

use crate::arguments::SetArgument;
use crate::arrays::array;
use crate::failure::Failure;
use crate::task::run;

/// Names and values of measures; a value that is not defined is `None`.
type Measures = Vec<(&'static str, Option<f64>)>;

/// Returns the numbers of `tilescope analyze` by its names. Of a set without a known radius, the smallest distance stands for
/// it.
#[pyfunction]
pub fn analyze<'py>(
    py: Python<'py>,
    set: SetArgument<'_>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (points, region, known) = (set.points()?, set.region()?, set.known_radius());
    let measures: Measures = run(py, progress, |watch| {
        let samples = points.len();
        // The smallest distance and the covering radius do not depend on the radius; the spacing keeps the search quick.
        let asked = known.unwrap_or_else(|| (region.area() / samples.max(1) as f64).sqrt());
        let report = verify(
            points,
            region,
            asked,
            &VerifyOptions::default(),
            &watch.control("verify"),
        )?;
        let distances = NearestDistances::of(points, region, &watch.control("distances"))?;
        let discrepancy = match Discrepancy::of(points, region, &watch.control("discrepancy")) {
            Err(MeasureError::TooMany { .. }) => None,
            discrepancy => Some(discrepancy?),
        };
        let curve = PowerCurve::of_samples(points, region, &watch.control("pairs"))?;
        // Equal samples have no cells.
        let order =
            (report.min_distance > 0.0).then(|| Order::of(points, region, &watch.control("cells")));
        let order = order.transpose()?;
        let least = distances.summary.least;
        let r = known.unwrap_or(least);
        let judged = known.map(|_| &report);
        let six_sided = |order: &Order| {
            let all: u64 = order.sides.iter().sum();
            order.sides.get(6).copied().unwrap_or(0) as f64 / all as f64
        };
        let (curve, order) = (curve.as_ref(), order.as_ref());
        Ok(vec![
            ("samples", Some(samples as f64)),
            ("radius", Some(r).filter(|r| *r > 0.0)),
            ("density", Some(samples as f64 * r.powi(2) / region.area())),
            ("min_distance_r", Some(least / r)),
            ("covering_radius_r", Some(report.covering_radius / r)),
            ("conflicts", judged.map(|report| report.conflicts as f64)),
            ("gaps", judged.map(|report| report.gaps as f64)),
            ("relative_radius", Some(distances.relative_radius())),
            (
                "mean_nearest_distance",
                Some(distances.mean_relative_distance()),
            ),
            (
                "effective_nyquist",
                curve.and_then(PowerCurve::effective_nyquist),
            ),
            (
                "effective_nyquist_psa",
                curve.and_then(PowerCurve::effective_nyquist_psa),
            ),
            ("oscillation", curve.and_then(PowerCurve::oscillation)),
            (
                "area_deviation",
                order.map(|order| order.relative_areas.deviation),
            ),
            ("six_sided", order.map(six_sided)),
            ("mean_sides", order.map(|order| order.mean_sides)),
            ("bond_order", order.map(|order| order.bond_order)),
            (
                "global_bond_order",
                order.map(|order| order.global_bond_order),
            ),
            ("star_discrepancy", discrepancy.as_ref().map(|d| d.star)),
            (
                "centered_discrepancy",
                discrepancy.as_ref().map(|d| d.centered),
            ),
        ])
    })?;
    let found = PyDict::new(py);
    for (name, value) in measures {
        found.set_item(name, value.filter(|value| value.is_finite()))?;
    }
    Ok(found)
}

/// Returns the spectrum of a set up to the frequency `nu`, or as far as it is usually looked at.
#[pyfunction]
pub fn spectrum<'py>(
    py: Python<'py>,
    set: SetArgument<'_>,
    nu: Option<f64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (points, region) = (set.points()?, set.region()?);
    let samples = points.len() as f64;
    let window = match nu {
        Some(nu) => Spectrum::window_to(nu, samples, region).map_err(Failure::from)?,
        None => Spectrum::window(samples, region),
    };
    let (spectrum, curve) = run(py, progress, |watch| {
        let control = watch.control("spectrum");
        let periodogram = Periodogram::of(points, region, &window, &control)?;
        let spectrum = Spectrum::of(&periodogram)?;
        let curve = PowerCurve::of_samples(points, region, &watch.control("pairs"))?;
        Ok((spectrum, curve))
    })?;
    let found = PyDict::new(py);
    let (profile, picture) = (&spectrum.profile, spectrum.picture);
    let anisotropy = profile.annuli.iter().map(|annulus| annulus.anisotropy_db);
    let frequencies = PyArray1::from_vec(py, profile.relative_frequencies());
    found.set_item("frequencies", frequencies)?;
    found.set_item("power", PyArray1::from_vec(py, profile.powers()))?;
    found.set_item("anisotropy", PyArray1::from_iter(py, anisotropy))?;
    let bands = spectrum.bands.map(|bands| array(py, bands));
    found.set_item("bands", bands.transpose()?)?;
    let power = PyArray1::from_vec(py, picture.power);
    found.set_item("picture", power.reshape([picture.rows, picture.size])?)?;
    found.set_item("picture_reach", spectrum.picture_reach)?;
    let curve = curve.as_ref();
    let nyquist = curve.and_then(PowerCurve::effective_nyquist);
    found.set_item("effective_nyquist", nyquist)?;
    found.set_item("oscillation", curve.and_then(PowerCurve::oscillation))?;
    Ok(found)
}

/// Distances over `r_max` in the first column, g(r) in the second.
type PairCurve<'py> = Bound<'py, PyArray2<f64>>;

/// Returns the pair correlation of a set.
#[pyfunction]
pub fn pair_correlation<'py>(
    py: Python<'py>,
    set: SetArgument<'_>,
    progress: Option<Py<PyAny>>,
) -> PyResult<PairCurve<'py>> {
    let (points, region) = (set.points()?, set.region()?);
    let bins = PairBins::of(set.known_radius(), points.len(), region);
    let places = run(py, progress, |watch| {
        let (farthest, control) = (bins.farthest(points.len(), region), watch.control("pairs"));
        let found = PairCorrelation::of(points, region, farthest, bins.count(), &control)?;
        Ok(found.points())
    })?;
    array(py, places)
}
