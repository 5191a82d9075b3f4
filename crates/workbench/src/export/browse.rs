//! The system's dialog for the name of an exported file.

use std::path::PathBuf;

use tilescope_session::jobs::{Job, Wake};

use super::ExportKind;
use super::form::ExportForm;
use crate::files::answered;

/// Opens the system's dialog; the job ends with the chosen file, or `None`.
#[must_use]
pub fn browse(form: &ExportForm, wake: &Wake) -> Job<Option<PathBuf>> {
    let path = form.file();
    let extensions = form.kind.extensions();
    let name = path.file_name().map_or_else(
        || format!("tilescope.{}", extensions[0]),
        |name| name.to_string_lossy().into_owned(),
    );

    let (title, all) = match form.kind {
        ExportKind::Result | ExportKind::Samples => {
            ("Export the samples and their certificate", "All point sets")
        }
        ExportKind::Picture => ("Export a picture of this moment", "All pictures"),
        ExportKind::Scenes => ("Export pictures of the scenes", "All pictures"),
        ExportKind::Animation => ("Export an animation", "All animations"),
    };

    let mut dialog = rfd::AsyncFileDialog::new()
        .set_title(title)
        .set_file_name(name)
        .add_filter(all, &extensions);
    // The first filter shows files of all formats of the kind, and each of these shows one format.
    for (name, extensions) in form.kind.formats() {
        dialog = dialog.add_filter(name, &extensions);
    }

    // If the folder does not exist, the system chooses where the dialog begins.
    if let Some(folder) = path.parent().filter(|folder| folder.is_dir()) {
        dialog = dialog.set_directory(folder);
    }

    answered(wake, dialog.save_file())
}
