//! Writing the result to a file with its certificate, in the background; and asking the system for
//! the file's name. What is written and verified is `tilescope_formats`' business.

use std::collections::BTreeMap;

use tilescope_core::{Fate, Origin, Run};
use tilescope_formats::{PointSet, Precision, Provenance};

/// The export sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct ExportForm {
    /// The file to write; its extension chooses the format.
    pub path: String,
    /// Number type of the coordinates, where the format leaves the choice.
    pub precision: Precision,
}

impl Default for ExportForm {
    fn default() -> Self {
        Self {
            path: "tilescope.csv".to_owned(),
            precision: Precision::Double,
        }
    }
}

/// Returns the result of a run with where each sample comes from.
#[must_use]
pub fn point_set(run: &Run) -> PointSet {
    let provenance = |&id: &u32| match run.samples.origins[id as usize] {
        Origin::Tiled { block, pattern, .. } => Provenance::tiled(block, pattern),
        Origin::Inserted { iteration, .. } => Provenance::inserted(iteration),
    };
    debug_assert!(
        run.result
            .iter()
            .all(|&id| run.samples.fates[id as usize] == Fate::Kept)
    );
    PointSet {
        points: run.positions(),
        provenance: Some(run.result.iter().map(provenance).collect()),
    }
}

/// Returns the parameters of a run by name, for its certificate.
#[must_use]
pub fn parameter_map(run: &Run) -> BTreeMap<String, serde_json::Value> {
    match serde_json::to_value(run.parameters) {
        Ok(serde_json::Value::Object(map)) => map.into_iter().collect(),
        _ => BTreeMap::new(),
    }
}

#[cfg(not(target_arch = "wasm32"))]
pub use native::{browse, write};

#[cfg(not(target_arch = "wasm32"))]
mod native {
    use std::path::{Path, PathBuf};

    use tilescope_formats::{ExportContext, ExportError, Exported, Format, export};

    use super::{ExportForm, parameter_map, point_set};
    use crate::jobs::{Job, Monitor, Wake};
    use crate::session::Session;
    use crate::verification::region_of;

    /// Writes the file that `form` names and its certificate.
    pub fn write(
        session: &Session,
        form: &ExportForm,
        monitor: &Monitor,
    ) -> Result<Exported, ExportError> {
        let run = session.run();
        let mut context = ExportContext::new(region_of(session), run.domain.radius());
        context.precision = form.precision;
        "kdrt".clone_into(&mut context.method);
        context.parameters = parameter_map(run);
        let control = |progress| monitor.follow(progress);
        let path = Path::new(form.path.trim());
        export(path, &point_set(run), &context, &control)
    }

    /// Opens the system's dialog; the job ends with the chosen file, or `None`.
    #[must_use]
    pub fn browse(form: &ExportForm, wake: &Wake) -> Job<Option<PathBuf>> {
        let path = Path::new(form.path.trim());
        let name = path.file_name().map_or_else(
            || "tilescope.csv".to_owned(),
            |name| name.to_string_lossy().into_owned(),
        );
        let all: Vec<&str> = Format::ALL.iter().map(|f| f.extension()).collect();
        let mut dialog = rfd::AsyncFileDialog::new()
            .set_title("Export the samples and their certificate")
            .set_file_name(name)
            .add_filter("All point sets", &all);
        for format in Format::ALL {
            dialog = dialog.add_filter(format.to_string(), &[format.extension()]);
        }
        if let Some(folder) = path.parent().filter(|folder| folder.is_dir()) {
            dialog = dialog.set_directory(folder);
        }
        // The dialog must be made on the window's thread; waiting for it must not.
        let answer = dialog.save_file();
        Job::start(wake, move |_| {
            pollster::block_on(answer).map(|file| file.path().to_owned())
        })
    }
}
