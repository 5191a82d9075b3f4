//! `combine`: one set of several, side by side (section 4.2 of the paper).

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use pyo3::prelude::*;
use serde_json::json;
use tilescope_core::combine::file::{Layout, PieceSource, Set};
use tilescope_core::memory::{Making, ask_for};
use tilescope_core::{MAXIMAL_DENSITY, combine::combine as combined};
use tilescope_formats::{Overrides, positions_digest};
use tilescope_sets::{KnownDomain, Made, Stated, named_by_content, set_of_piece, stated_layout};

use crate::arguments::SetArgument;
use crate::failure::Failure;
use crate::files::of_file;
use crate::memory::ask_to_read;
use crate::sample::{PythonSet, into_python};
use crate::task::{TaskWatch, run};

/// A set that the caller has in memory.
struct GivenSet<'a> {
    points: &'a [[f64; 2]],
    domain: KnownDomain,
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

    // Only this thread may touch Python's objects, so the points and domains are read from them here, for the threads
    // below.
    let mut given = HashMap::new();
    for (name, set) in &sets {
        let held = GivenSet {
            points: set.points()?,
            domain: set.known_domain()?,
        };
        given.insert(name.as_str(), held);
    }

    // Memory is asked for before the pieces are made, which may take long. A combination keeps each sample with its
    // fate, as the sequential engine does, and is taken to need as much.
    let samples = placed.domain.area_radii() * MAXIMAL_DENSITY;
    let made = run(py, progress, |watch| {
        ask_for(samples, Making::Sequential.bytes_a_sample())?;
        let make = |source: &PieceSource| set_of(source, &folder, &given, watch);
        // The callback after each set has nothing to do: `watch` shows the progress within sets.
        let pieces = placed.pieces(make, |_| {})?;
        let options = layout.options();

        let found = combined(placed.domain, &pieces, &options, &mut watch.observer())?;
        // Files are named without folders, sets in memory by their digests.
        let named = |path: &str| match given.get(path) {
            Some(held) => {
                let digest = json!(positions_digest(held.points));
                Ok(Stated::from([("positions_digest".to_owned(), digest)]))
            }
            None => named_by_content(&folder.join(path)),
        };
        Ok(Made::combined(
            &found,
            stated_layout(&layout, &placed, named)?,
        ))
    })?;
    into_python(made, py)
}

/// Reads or makes the set of a piece.
fn set_of(
    source: &PieceSource,
    folder: &Path,
    given: &HashMap<&str, GivenSet<'_>>,
    watch: &TaskWatch,
) -> Result<Set, Failure> {
    set_of_piece(source, &mut watch.observer(), |path, beside| {
        let missing = || Failure::Value("the set has no certificate; give its radius".into());
        if let Some(held) = given.get(path) {
            // `beside` is what the layout states beside the set's name: it comes before what the set has of its own.
            let known = beside.over(Some(held.domain)).ok_or_else(missing)?;
            return Ok(known.set(held.points)?);
        }

        let path = folder.join(path);
        ask_to_read(&path)?;
        let control = watch.control("verify");
        // The certificate is read as well: it states what the layout leaves out. Without a certificate the positions
        // stay in the unit of the file, and the layout states the set's domain and radius in the same unit.
        let certificate = true;
        let read = of_file(&path, &Overrides::default(), certificate, &control)?.in_domain(None);
        let stated = read.certificate.as_ref().map(Into::into);
        let known = beside.over(stated).ok_or_else(missing)?;
        let set = known.set(&read.set.points).map_err(Failure::from);
        set.map_err(|error| error.of(&path.display().to_string()))
    })
}
