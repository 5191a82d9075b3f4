//! Makes packages of lessons for course systems in the background, of the built page: natively that of the folder which the
//! command line uses too, in a browser the page itself.

use serde::{Deserialize, Serialize};
use tilescope_lessons::package::{BuiltPage, Package, PackageOrder};
use tilescope_session::incoming::NamedBytes;
use tilescope_session::jobs::{Job, Monitor, Wake};
use tilescope_session::task::{Task, run_for};

/// A package that is being made.
pub struct Packaging {
    /// The name of its file, without the ending.
    pub stem: String,
    /// The sentence that says what it holds.
    pub content: String,
    /// The work.
    pub job: Job<Result<NamedBytes, String>>,
}

/// The task of making a package once all files of the page are there. Its outcome is the package, or a sentence with the reason
/// why there is none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PackageTask {
    /// What it is to hold.
    pub order: PackageOrder,
    /// The files of the page.
    pub files: Vec<NamedBytes>,
}

impl Task for PackageTask {
    type Outcome = Result<NamedBytes, String>;
    const NAME: &'static str = "package";

    fn run(self, _monitor: &Monitor) -> Self::Outcome {
        let mut page = BuiltPage::begin();
        for NamedBytes { name, bytes } in self.files {
            page.put(name, bytes);
        }
        let package = Package::read(&self.order).and_then(|package| package.archive(page));
        let bytes = package.map_err(|fault| fault.to_string())?;
        Ok(NamedBytes::new("package", bytes))
    }
}

/// Starts to make a package; the job ends with its bytes, or with a sentence.
#[must_use]
pub fn start(order: PackageOrder, wake: &Wake) -> Job<Result<NamedBytes, String>> {
    Job::start_future(wake, move |monitor| async move {
        let files = page_files().await?;
        run_for(PackageTask { order, files }, &monitor).await?
    })
}

/// Returns the page's files in the form of a task.
fn listed(page: BuiltPage) -> Vec<NamedBytes> {
    let files = page.into_files().into_iter();
    files
        .map(|(name, bytes)| NamedBytes::new(name, bytes))
        .collect()
}

/// Returns the files of the built page that lies beside the program or in the folder where web/build puts it.
#[cfg(not(target_arch = "wasm32"))]
fn page_files() -> std::future::Ready<Result<Vec<NamedBytes>, String>> {
    std::future::ready(files_of_folder(
        tilescope_session::page_folder::page_folder(),
    ))
}

/// Reads the files of a page's folder; the error of a missing one names the folders that were looked at. Its text
/// ends the sentence that begins with "There is no package: ".
#[cfg(not(target_arch = "wasm32"))]
fn files_of_folder(
    folder: Result<std::path::PathBuf, Vec<std::path::PathBuf>>,
) -> Result<Vec<NamedBytes>, String> {
    let folder = folder.map_err(|tried| {
        let tried: Vec<_> = tried.iter().map(|p| p.display().to_string()).collect();
        let tried = tried.join(" or ");
        format!("it holds the page for browsers, which is not in {tried}; web/build makes it")
    })?;

    let page = BuiltPage::of(|name| {
        let path = folder.join(name);
        std::fs::read(&path).map_err(|error| format!("{}: {error}", path.display()))
    });
    Ok(listed(page?))
}

/// Fetches the files of the page that shows this program. They are those that it was loaded from, or a newer version's, of
/// which each file names the others.
#[cfg(target_arch = "wasm32")]
async fn page_files() -> Result<Vec<NamedBytes>, String> {
    let mut page = BuiltPage::begin();
    while let Some(name) = page.next_name() {
        let bytes = super::web::fetched(&name).await;
        let bytes = bytes.map_err(|why| format!("{name} cannot be fetched: {why}"))?;
        page.put(name, bytes);
    }
    Ok(listed(page))
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use tilescope_lessons::package::CourseSystem;
    use tilescope_lessons::shipped::{Loaded, all, to_json};

    use super::*;
    use crate::worker::perform;

    /// Writes a folder that looks like a built page.
    fn built_page(folder: &Path) {
        let tables = [("de".to_owned(), "Words\n    Wörter".to_owned())].into();
        let lessons = to_json(&Loaded {
            lessons: Vec::new(),
            tables,
        });
        let names = [
            "index.html",
            "course.css",
            "course.js",
            "record.js",
            "cmi5.js",
        ];
        let course = names.map(|name| (name, format!("{name} [[title]]")));
        let course = serde_json::to_string(&std::collections::BTreeMap::from(course));
        let index = "course-0123456789ab.json lessons-0123456789ab.json <div id=\"site\"><template id=\"program\">";
        for (name, text) in [
            ("index.html", index),
            ("course-0123456789ab.json", &course.expect("texts")),
            ("lessons-0123456789ab.json", &lessons),
        ] {
            std::fs::write(folder.join(name), text).expect("a file");
        }
    }

    /// Returns the order of a package for cmi5.
    fn order() -> PackageOrder {
        let lesson = all().into_iter().find(|lesson| lesson.name == "gaps");
        PackageOrder {
            lesson: lesson.expect("a lesson"),
            system: CourseSystem::Cmi5,
            steps: Vec::new(),
            language: "de".to_owned(),
            pass: None,
        }
    }

    #[test]
    fn a_worker_makes_the_package_that_is_made_here() {
        let folder = tempfile::tempdir().expect("a folder");
        built_page(folder.path());
        let files = files_of_folder(Ok(folder.path().to_owned())).expect("a page");
        let task = PackageTask {
            order: order(),
            files,
        };
        let monitor = Monitor::reporting(|_, _| {});
        let here = task.clone().run(&monitor).expect("a package");

        let (input, _) = tilescope_session::task::session_ref::packed(&task).expect("bytes");
        let there = perform(PackageTask::NAME, &input, &monitor).expect("an outcome");
        let there: Result<NamedBytes, String> = postcard::from_bytes(&there).expect("an outcome");
        assert_eq!(there.as_ref(), Ok(&here));

        // The same as without a task.
        let read = |name: &str| std::fs::read(folder.path().join(name));
        let page = BuiltPage::of(read).expect("a page");
        let package = Package::read(&task.order).expect("a lesson").archive(page);
        assert_eq!(package.as_ref(), Ok(&here.bytes));

        // The control: another language gives other bytes.
        let other = PackageTask {
            order: PackageOrder {
                language: "en".to_owned(),
                ..order()
            },
            ..task
        };
        assert_ne!(other.run(&monitor), Ok(here));
    }

    #[test]
    fn what_is_missing_of_a_page_is_named() {
        let nowhere = vec!["here".into(), "there".into()];
        let error = files_of_folder(Err(nowhere)).expect_err("no page");
        assert!(
            error.contains("here or there") && error.contains("web/build"),
            "{error}"
        );

        let folder = tempfile::tempdir().expect("a folder");
        built_page(folder.path());
        let lost = folder.path().join("lessons-0123456789ab.json");
        std::fs::remove_file(&lost).expect("it was there");
        let error = files_of_folder(Ok(folder.path().to_owned())).expect_err("a file is gone");
        assert!(error.contains(&lost.display().to_string()), "{error}");

        // A page that an older version has built has no texts for packages.
        std::fs::write(folder.path().join("index.html"), "an older page").expect("a file");
        let files = files_of_folder(Ok(folder.path().to_owned())).expect("a page");
        let task = PackageTask {
            order: order(),
            files,
        };
        let error = task
            .run(&Monitor::reporting(|_, _| {}))
            .expect_err("too old");
        assert!(error.contains("another version"), "{error}");
    }
}
