//! Measures of a set: the numbers of `tilescope analyze`, the spectrum, the pair correlation.

use numpy::prelude::*;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyDict};
use tilescope_analysis::measures::{
    MeasuredSet, PairBins, PairCorrelation, Part, Periodogram, PowerCurve, Spectrum,
};
use tilescope_analysis::{VerifyOptions, verify};

use crate::arguments::SetArgument;
use crate::arrays::array;
use crate::failure::Failure;
use crate::memory::ask_to_measure;
use crate::task::run;
use crate::values::real_if_given;

/// Returns the numbers of `tilescope analyze` by its names; `None` for one that is not defined. Of a set without a
/// known radius, the smallest distance stands for it.
#[pyfunction]
pub fn analyze<'py>(
    py: Python<'py>,
    set: SetArgument<'_>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    set.refuse_ground("analyze")?;
    let (points, region, known) = (set.points()?, set.region()?, set.known_radius());
    let measured = run(py, progress, |watch| {
        // Memory is asked for first, as a failed allocation would end the interpreter.
        ask_to_measure(points.len())?;
        // Without a known radius any will do, since the smallest distance and the covering radius do not depend on it.
        // One about as long as the samples' spacing keeps the search quick; a set without samples counts as one.
        let spacing = || (region.area() / points.len().max(1) as f64).sqrt();
        let (r, options) = (known.unwrap_or_else(spacing), VerifyOptions::default());
        let report = verify(points, region, r, &options, &watch.control("verify"))?;

        let mut measured = MeasuredSet::new(points.len(), region, known);
        measured.take_report(report);
        let control = watch.control("measure");
        for part in Part::of_numbers() {
            measured.measure(part, points, &control)?;
        }
        Ok(measured)
    })?;

    let numbers = measured.numbers();
    let values = numbers.map(|(number, value)| (number.key, value));
    values.into_py_dict(py)
}

/// Returns the spectrum of a set up to the frequency `nu`, or as far as it is usually looked at. It needs no radius, so
/// that sets whose radius varies or that cover a shape have one too.
#[pyfunction]
pub fn spectrum<'py>(
    py: Python<'py>,
    set: SetArgument<'_>,
    nu: Option<&Bound<'_, PyAny>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (points, region) = (set.points()?, set.region()?);
    let samples = points.len() as f64;
    let window = match real_if_given("nu", nu)? {
        Some(nu) => Spectrum::window_to(nu, samples, region).map_err(Failure::from)?,
        None => Spectrum::window(samples, region),
    };

    let (spectrum, curve) = run(py, progress, |watch| {
        ask_to_measure(points.len())?;
        let control = watch.control("spectrum");
        let periodogram = Periodogram::of(points, region, &window, &control)?;
        let spectrum = Spectrum::of(&periodogram)?;
        let curve = PowerCurve::of_samples(points, region, &watch.control("pairs"))?;
        Ok((spectrum, curve))
    })?;

    let found = PyDict::new(py);
    let (profile, picture) = (&spectrum.profile, spectrum.picture);
    // The anisotropy of an annulus with fewer than two pairs of frequencies is not defined: NaN stands there.
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

    // Both numbers are read from a curve that is computed from the pair correlation. It needs pairs at distances of
    // several `r_max`: a narrower domain has no curve, and so neither number.
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
    // Bins are parts of the radius if it is known, so that sets of one radius have the same.
    let bins = PairBins::of(set.known_radius(), points.len(), region);
    let places = run(py, progress, |watch| {
        ask_to_measure(points.len())?;
        let (farthest, control) = (bins.farthest(points.len(), region), watch.control("pairs"));
        let found = PairCorrelation::of(points, region, farthest, bins.count(), &control)?;
        Ok(found.points())
    })?;
    array(py, places)
}
