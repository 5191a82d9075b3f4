//! The program in a package: what the built page needs in a frame, with the package's lesson as its only one. Begin with
//! [`files`].

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result, ensure};
use tilescope_lessons::shipped::{Loaded, Shipped, from_json, to_json};

use crate::paths::{InFile, extension, named};

/// The folder of the program in a package.
const FOLDER: &str = "program";
/// The page that the program begins with.
const INDEX: &str = "index.html";
/// Where the first page, which a frame never shows, begins in the built page, and where the program's part follows.
const FIRST_PAGE: [&str; 2] = ["<div id=\"site\">", "<template id=\"program\">"];
/// How the name of the file with all lessons begins and ends; between stands a hash of its content.
const LESSONS: [&str; 2] = ["lessons-", ".json"];
/// Texts that may name other files of the page.
const TEXTS: [&str; 4] = ["html", "js", "css", "webmanifest"];

/// Returns the program's files by their paths in the package. Of the built page they are what its first document leads to,
/// without the page to be read before the program.
///
/// # Errors
///
/// A folder that cannot be read, and a page of another version.
pub fn files(folder: &Path, lesson: Shipped) -> Result<BTreeMap<String, Vec<u8>>> {
    let mut left = names(folder)?;
    let page = fs::read_to_string(folder.join(INDEX)).in_file(&folder.join(INDEX))?;
    let index = without_first_page(&page)
        .with_context(|| other_version(folder, "its index.html has no first page"))?;

    let mut found = BTreeMap::from([(INDEX.to_owned(), index.into_bytes())]);
    let mut open = vec![INDEX.to_owned()];
    // Files name each other as they are served. A named file is needed, and may name more.
    while let Some(name) = open.pop() {
        if !TEXTS.contains(&&*extension(name.as_ref())) {
            continue;
        }
        // Names are of plain letters, so that a text with wrong bytes is searched as well.
        let text = String::from_utf8_lossy(&found[&name]).into_owned();
        let (now, later): (Vec<String>, Vec<String>) = left
            .into_iter()
            .partition(|other| text.contains(other.as_str()));
        left = later;
        for other in now {
            let path = folder.join(&other);
            found.insert(other.clone(), fs::read(&path).in_file(&path)?);
            open.push(other);
        }
    }

    put_lesson(&mut found, folder, lesson)?;
    let inside = |(name, bytes)| (format!("{FOLDER}/{name}"), bytes);
    Ok(found.into_iter().map(inside).collect())
}

/// Returns the names of a page's files that a package may need.
fn names(folder: &Path) -> Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder).in_file(folder)? {
        let entry = entry.in_file(folder)?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let is_file = entry.file_type().in_file(folder)?.is_file();
        let ending = extension(name.as_ref());
        // `files` reads the index by itself. A frame installs no service worker, and course systems compress by
        // themselves.
        let is_apart = [INDEX, "sw.js"].contains(&&*name) || ["br", "gz"].contains(&&*ending);
        if is_file && !is_apart {
            names.push(name);
        }
    }
    Ok(names)
}

/// Returns the built page without the part to be read before the program, whose pictures a package would carry in vain.
fn without_first_page(index: &str) -> Option<String> {
    let (before, rest) = index.split_once(FIRST_PAGE[0])?;
    let (_, program) = rest.split_once(FIRST_PAGE[1])?;
    Some(format!("{before}{}{program}", FIRST_PAGE[1]))
}

/// Puts the package's lesson in the place of all lessons: the list in the frame then leads to no other, chosen steps and lessons
/// of files open like those that come with the program, and each has its translation.
fn put_lesson(found: &mut BTreeMap<String, Vec<u8>>, folder: &Path, lesson: Shipped) -> Result<()> {
    let mut lists = found
        .iter_mut()
        .filter(|(name, _)| name.starts_with(LESSONS[0]) && name.ends_with(LESSONS[1]));
    let (Some((name, list)), None) = (lists.next(), lists.next()) else {
        let why = "it does not have one file with lessons";
        return Err(anyhow::anyhow!(other_version(folder, why)));
    };

    // The words of the page stay; of its lessons none does.
    let loaded = from_json(&String::from_utf8_lossy(list)).with_context(|| name.clone())?;
    ensure!(
        !loaded.tables.is_empty(),
        other_version(
            folder,
            "its lessons come without the words of other languages"
        )
    );
    // The name keeps the hash of the former content: nothing checks it, and another name would have to be written into scripts.
    *list = to_json(&Loaded {
        lessons: vec![lesson],
        tables: loaded.tables,
    })
    .into_bytes();
    Ok(())
}

/// Returns the message for a page that another version of the program has made.
fn other_version(folder: &Path, why: &str) -> String {
    format!(
        "the page in {} is of another version of the program: {why}; run web/build",
        named(folder)
    )
}
