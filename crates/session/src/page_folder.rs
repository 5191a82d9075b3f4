//! Where the built page lies that the program serves and makes packages of.

use std::path::{Path, PathBuf};

/// Returns whether a folder holds a built page.
#[must_use]
pub fn has_page(folder: &Path) -> bool {
    folder.join("index.html").is_file()
}

/// Returns the folder of the built page: `web/dist` below the current folder, or the folder `web` beside the program.
///
/// # Errors
///
/// There is no page; the folders that were looked at.
pub fn page_folder() -> Result<PathBuf, Vec<PathBuf>> {
    // web/build makes the first, in a checkout; an installed program has its page beside it.
    let mut tried = vec![PathBuf::from("web/dist")];
    tried.extend(std::env::current_exe().map(|program| program.with_file_name("web")));
    let found = tried.iter().find(|folder| has_page(folder));
    found.cloned().ok_or(tried)
}
