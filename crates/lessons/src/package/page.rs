//! The built page as a package needs it: the program in a frame, with the package's lesson as its only one, and the texts of
//! the page around it. Begin with [`BuiltPage`].

use std::collections::{BTreeMap, BTreeSet};

use super::PackageError;
use crate::shipped::{Loaded, Shipped, from_json, to_json};

/// The folder of the program in a package.
const FOLDER: &str = "program";
/// The page that the program begins with.
const INDEX: &str = "index.html";
/// The one file that keeps its name and that a frame may need.
const MANIFEST: &str = "manifest.webmanifest";
/// Where the first page, which a frame never shows, begins in the built page, and where the program's part follows.
const FIRST_PAGE: [&str; 2] = ["<div id=\"site\">", "<template id=\"program\">"];
/// How the names of two files begin and end, between which stands a hash of their content: that with all lessons, and that
/// with the texts of the page around the program.
const LESSONS: [&str; 2] = ["lessons-", ".json"];
const COURSE: [&str; 2] = ["course-", ".json"];
/// Texts that may name other files of the page.
const TEXTS: [&str; 4] = ["html", "js", "css", "webmanifest"];
/// The hexadecimal digits of a hash in a name.
const DIGITS: usize = 12;

/// The files of a built page that a package needs: what its first document leads to, without the page to be read before the
/// program. They are asked for one by one, so that a page fetches its own as a command reads those of a folder.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct BuiltPage {
    /// The files by their names.
    files: BTreeMap<String, Vec<u8>>,
    /// The names that were found so far.
    known: BTreeSet<String>,
    /// Those of them that were not asked for yet.
    open: Vec<String>,
}

impl BuiltPage {
    /// Returns a page of which no file is there yet. Take names from [`Self::next_name`] and bring their files to
    /// [`Self::put`], until there are no more.
    #[must_use]
    pub fn begin() -> Self {
        Self {
            open: vec![INDEX.to_owned()],
            ..Self::default()
        }
    }

    /// Returns a page whose files `read` returns by their names.
    ///
    /// # Errors
    ///
    /// Those of `read`.
    pub fn of<E>(mut read: impl FnMut(&str) -> Result<Vec<u8>, E>) -> Result<Self, E> {
        let mut page = Self::begin();
        while let Some(name) = page.next_name() {
            let bytes = read(&name)?;
            page.put(name, bytes);
        }
        Ok(page)
    }

    /// Returns the name of a file that is needed and was not asked for before; `None` when the page is whole.
    pub fn next_name(&mut self) -> Option<String> {
        self.open.pop()
    }

    /// Takes a file of the page.
    pub fn put(&mut self, name: String, bytes: Vec<u8>) {
        let ending = name.rsplit_once('.').map_or("", |(_, ending)| ending);
        // Files name each other as they are served. A named file is needed, and may name more.
        if TEXTS.contains(&ending) {
            let whole = String::from_utf8_lossy(&bytes);
            // The pictures of the page to be read before the program would be carried in vain.
            let part = (name == INDEX)
                .then(|| without_first_page(&whole))
                .flatten();
            for found in names_in(part.as_deref().unwrap_or(&whole)) {
                if self.known.insert(found.to_owned()) {
                    self.open.push(found.to_owned());
                }
            }
        }
        self.files.insert(name, bytes);
    }

    /// Returns the files of the page, and their bytes as one file has them.
    #[must_use]
    pub fn into_files(self) -> BTreeMap<String, Vec<u8>> {
        self.files
    }

    /// Returns the texts of the page around the program, by their names in a package.
    pub(super) fn course_texts(&mut self) -> Result<BTreeMap<String, String>, PackageError> {
        let why = "it has no texts of the page of a package";
        let name = self.only(COURSE).ok_or(PackageError::OtherVersion(why))?;
        // The package has them as files of their own, outside the program.
        let bytes = self.files.remove(&name).unwrap_or_default();
        serde_json::from_slice(&bytes).map_err(|_| PackageError::OtherVersion(why))
    }

    /// Returns the program's files by their paths in the package, with the package's lesson in the place of all
    /// lessons. The list in the frame then leads to no other lesson. A lesson of chosen steps, or one from a file,
    /// opens like those that come with the program, and with its translation.
    pub(super) fn program(
        mut self,
        lesson: Shipped,
    ) -> Result<BTreeMap<String, Vec<u8>>, PackageError> {
        let other = PackageError::OtherVersion;
        let page = self
            .files
            .get(INDEX)
            .map(|bytes| String::from_utf8_lossy(bytes));
        let index = page.and_then(|page| without_first_page(&page));
        let index = index.ok_or(other("its index.html has no first page"))?;
        self.files.insert(INDEX.to_owned(), index.into_bytes());

        let lists = "it does not have one file with lessons";
        let name = self.only(LESSONS).ok_or(other(lists))?;
        // The words of the page stay; of its lessons none does.
        let loaded = std::str::from_utf8(&self.files[&name]).map(from_json);
        let Ok(Ok(Loaded { tables, .. })) = loaded else {
            return Err(other("its lessons cannot be read"));
        };
        if tables.is_empty() {
            return Err(other(
                "its lessons come without the words of other languages",
            ));
        }

        // The name keeps the hash of the former content: nothing checks it, and another name would have to be written into
        // scripts.
        let lessons = vec![lesson];
        self.files
            .insert(name, to_json(&Loaded { lessons, tables }).into_bytes());
        let inside = |(name, bytes)| (format!("{FOLDER}/{name}"), bytes);
        Ok(self.files.into_iter().map(inside).collect())
    }

    /// Returns the name of the only file whose name begins and ends so.
    fn only(&self, [begin, end]: [&str; 2]) -> Option<String> {
        let is_one = |name: &&String| name.starts_with(begin) && name.ends_with(end);
        let mut names = self.files.keys().filter(is_one);
        let first = names.next()?;
        names.next().is_none().then(|| first.clone())
    }
}

/// Returns the names of files of the page that stand in a text.
fn names_in(text: &str) -> impl Iterator<Item = &str> {
    let is_of_name = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    text.split(move |c| !is_of_name(c))
        .filter(|name| *name == MANIFEST || has_hash(name))
}

/// Returns whether a name is one of the page's files, which have a hash of their content before the ending.
fn has_hash(name: &str) -> bool {
    let stem = name.rsplit_once('.').map(|(stem, _)| stem);
    let hash = stem.and_then(|stem| stem.rsplit_once('-'));
    let is_digit = |byte: u8| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte);
    hash.is_some_and(|(_, hash)| hash.len() == DIGITS && hash.bytes().all(is_digit))
}

/// Returns the built page without the part to be read before the program.
fn without_first_page(index: &str) -> Option<String> {
    let (before, rest) = index.split_once(FIRST_PAGE[0])?;
    let (_, program) = rest.split_once(FIRST_PAGE[1])?;
    Some(format!("{before}{}{program}", FIRST_PAGE[1]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_are_found_in_any_text_and_no_others() {
        let text = "import('./main-0123456789ab.js'), \"a_b-ffffffffffff.wasm\" manifest.webmanifest \
                    main-0123456789ab.js.br short-0123.js main-0123456789AB.js sw.js /x/still-0123456789ab.png?";
        let found: Vec<&str> = names_in(text).collect();
        let expected = [
            "main-0123456789ab.js",
            "a_b-ffffffffffff.wasm",
            MANIFEST,
            "still-0123456789ab.png",
        ];
        assert_eq!(found, expected);
    }

    #[test]
    fn each_file_is_asked_for_once_and_only_if_another_one_names_it() {
        let mut asked = Vec::new();
        let page = BuiltPage::of(|name| {
            asked.push(name.to_owned());
            let text = match name {
                INDEX => {
                    "<link href=\"a-0123456789ab.js\"><div id=\"site\">hero-0123456789ab.svg\
                     <template id=\"program\">a-0123456789ab.js"
                }
                "a-0123456789ab.js" => "b-0123456789ab.css",
                // Two files that name each other.
                "b-0123456789ab.css" => "a-0123456789ab.js",
                other => return Err(other.to_owned()),
            };
            Ok(text.into())
        });
        assert_eq!(page.expect("a page").into_files().len(), 3);
        assert_eq!(asked, [INDEX, "a-0123456789ab.js", "b-0123456789ab.css"]);

        // The control: a file that is missing is named.
        let missing = BuiltPage::of(|name| match name {
            INDEX => Ok(b"gone-0123456789ab.js".to_vec()),
            other => Err(other.to_owned()),
        });
        assert_eq!(missing, Err("gone-0123456789ab.js".to_owned()));
    }
}
