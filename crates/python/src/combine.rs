//! `combine`: one set of several, side by side (section 4.2 of the paper).

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use pyo3::prelude::*;
use serde_json::{Value, json};
use tilescope_analysis::{Region, lossy};
use tilescope_core::combine::file::{Layout, PieceSource, PlacedLayout, Set};
use tilescope_core::memory::{Making, ask_for};
use tilescope_core::{Boundary, MAXIMAL_DENSITY, Pattern, combine::combine as combined};
use tilescope_formats::{Overrides, bytes_digest, positions_digest, read_whole};

use crate::arguments::{SetArgument, set};
use crate::failure::Failure;
use crate::files::of_file;
use crate::memory::ask_to_read;
use crate::sample::{PythonSet, made, provenance_of_sources};
use crate::task::{TaskWatch, run};

/// A set that the caller has in memory: its positions, domain and radius.
struct GivenSet<'a> {
    points: &'a [[f64; 2]],
    region: Region,
    radius: f64,
}

/// Makes the set of a layout. `sets` stand in for the files whose names they have; other files are in `folder`.
#[pyfunction]
pub fn combine<'py>(
    py: Python<'py>,
    layout: &str,
    folder: PathBuf,
    sets: HashMap<String, SetArgument<'py>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<PythonSet<'py>> {
    let layout = Layout::from_json(layout.as_bytes()).map_err(Failure::from)?;
    let placed = layout.placed().map_err(Failure::from)?;
    let mut given = HashMap::new();
    for (name, set) in &sets {
        let set = GivenSet {
            points: set.points()?,
            region: set.region()?,
            radius: set.radius()?,
        };
        given.insert(name.as_str(), set);
    }
    let samples = placed.domain.area_radii() * MAXIMAL_DENSITY;
    let made = run(py, progress, |watch| {
        ask_for(samples, Making::Sequential.bytes_a_sample())?;
        let make = |source: &PieceSource| set_of(source, &folder, &given, watch);
        let pieces = placed.pieces(make, |_| {})?;
        let options = layout.options();
        let found = combined(placed.domain, &pieces, &options, &mut watch.observer())?;
        let parameters = json!({ "layout": stated(&layout, &placed, &folder, &given)? });
        let provenance = Some(provenance_of_sources(&found.sources));
        let set = made(
            "combined",
            &parameters,
            &found.domain,
            &found.points,
            provenance,
        );
        Ok(set.with_counts(found.summary()))
    })?;
    made.into_python(py)
}

/// Reads or makes the set of a piece.
fn set_of(
    source: &PieceSource,
    folder: &Path,
    given: &HashMap<&str, GivenSet<'_>>,
    watch: &TaskWatch,
) -> Result<Set, Failure> {
    let mut observer = watch.observer();
    match source {
        PieceSource::File {
            path,
            radius,
            size: [width, height],
            boundary,
        } => {
            let of = |region: Region| {
                let size = [
                    width.unwrap_or(region.width),
                    height.unwrap_or(region.height),
                ];
                let is_periodic =
                    boundary.map_or(region.is_periodic(), |b| b == Boundary::Periodic);
                Region::new(size, is_periodic)
            };
            if let Some(held) = given.get(path.as_str()) {
                let radius = radius.unwrap_or(held.radius);
                return set(held.points, &of(held.region), radius);
            }
            let path = folder.join(path);
            ask_to_read(&path)?;
            let read = of_file(&path, &Overrides::default(), true, &watch.control("verify"))?
                .in_domain(None);
            let certificate = read.certificate.as_ref();
            let radius = radius.or(certificate.map(|stated| stated.radius));
            let missing = || Failure::Value("the set has no certificate; give its radius".into());
            let region = certificate.map_or(Region::UNIT_SQUARE, |stated| stated.region);
            set(&read.set.points, &of(region), radius.ok_or_else(missing)?)
                .map_err(|error| error.of(&path.display().to_string()))
        }
        PieceSource::Reference { seed, own } => Ok(Set::of_reference(*own, *seed, &mut observer)?),
        PieceSource::Run { parameters, .. } => {
            let pattern = Pattern::of_spec(&parameters.pattern, &mut observer)?;
            Ok(Set::of_run(parameters, &pattern, &mut observer)?)
        }
    }
}

/// Returns the layout as a certificate states it: files without folders, and sets by their digests.
fn stated(
    layout: &Layout,
    placed: &PlacedLayout,
    folder: &Path,
    given: &HashMap<&str, GivenSet<'_>>,
) -> Result<Value, Failure> {
    let mut stated = json!(layout);
    for (piece, place) in stated["pieces"]
        .as_array_mut()
        .into_iter()
        .flatten()
        .zip(&placed.pieces)
    {
        if let PieceSource::File { path, .. } = &place.source {
            if let Some(held) = given.get(path.as_str()) {
                piece["positions_digest"] = json!(positions_digest(held.points));
                continue;
            }
            let path = folder.join(path);
            piece["file"] = json!(lossy(path.file_name().unwrap_or_default()));
            piece["digest"] = json!(bytes_digest(&read_whole(&path)?));
        }
    }
    Ok(stated)
}
