//! Packages of lessons for course systems: ZIP archives with the built page, a page around it that speaks with the system
//! (`web/course`), and the list of the lesson's questions. Begin with [`Package::read`].

mod archive;
mod manifest;
mod page;

use std::collections::BTreeMap;

use quick_xml::escape::escape;
use serde::{Deserialize, Serialize};

use crate::prose::plain;
use crate::shipped::Shipped;
use crate::{Lesson, LessonError, Translation};
use manifest::Description;
pub use page::BuiltPage;

/// The languages that a package may begin with: those of the lessons that come with the program.
pub const PACKAGE_LANGUAGES: [&str; 2] = ["en", "de"];

/// The files of the page around the program that are in every package, by their names there.
const SHARED: [&str; 3] = ["course.css", "course.js", "record.js"];
/// The page itself, with marks as `[[title]]`.
const INDEX: &str = "index.html";

/// How a course system and the page speak with each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum CourseSystem {
    /// SCORM 1.2, which every system takes.
    #[serde(rename = "scorm-1.2")]
    Scorm12,
    /// SCORM 2004, fourth edition.
    #[serde(rename = "scorm-2004")]
    Scorm2004,
    /// cmi5, for systems with a record store.
    #[serde(rename = "cmi5")]
    Cmi5,
}

impl CourseSystem {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Scorm12, Self::Scorm2004, Self::Cmi5];

    /// Returns its name in messages.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Scorm12 => "SCORM 1.2",
            Self::Scorm2004 => "SCORM 2004",
            Self::Cmi5 => "cmi5",
        }
    }

    /// Returns its name in names of files.
    #[must_use]
    pub const fn file_name(self) -> &'static str {
        match self {
            Self::Scorm12 => "scorm-1.2",
            Self::Scorm2004 => "scorm-2004",
            Self::Cmi5 => "cmi5",
        }
    }

    /// Returns the name of the script that speaks with the system.
    const fn script(self) -> &'static str {
        match self {
            Self::Scorm12 | Self::Scorm2004 => "scorm.js",
            Self::Cmi5 => "cmi5.js",
        }
    }

    /// Returns the policy of the page: what it may load. Only a record store is reached over the network, wherever it is.
    fn policy(self) -> String {
        let connect = match self {
            Self::Scorm12 | Self::Scorm2004 => "'none'",
            Self::Cmi5 => "'self' https: http:",
        };
        format!(
            "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; frame-src 'self'; \
             connect-src {connect}; base-uri 'none'; form-action 'none'"
        )
    }
}

/// What a package is to hold, and for whom.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PackageOrder {
    /// The lesson, whole, with its German translation, empty if it has none.
    pub lesson: Shipped,
    /// The kind of course system.
    pub system: CourseSystem,
    /// The names of the only steps that it has, in the order of the lesson; empty for all.
    pub steps: Vec<String>,
    /// The language to begin with, of [`PACKAGE_LANGUAGES`].
    pub language: String,
    /// The percent of the score from which on the lesson counts as passed; without it there is only a score.
    pub pass: Option<u8>,
}

/// Why there is no package.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PackageError {
    /// The lesson has a fault.
    #[error("{0}")]
    Lesson(LessonError),
    /// The translation has a fault.
    #[error("its translation: {0}")]
    Translation(LessonError),
    /// There is no such step.
    #[error("{0}")]
    Step(String),
    /// The lesson, or each of the chosen steps, has no question.
    #[error("{0} no question, so that a course would get no score")]
    NoQuestion(&'static str),
    /// The page was built by another version of the program.
    // On a page it may have been replaced after it was loaded.
    #[error(
        "the page is of another version of the program: {0}; load the page again or, for \
         the program, build it by web/build"
    )]
    OtherVersion(&'static str),
    /// The archive or a part of it cannot be written.
    #[error("the archive cannot be written: {0}")]
    Archive(String),
}

/// What the page reads about its lesson: the file `lesson.js`.
#[derive(Clone, Debug, Serialize)]
struct PackagedLesson {
    system: CourseSystem,
    name: String,
    language: String,
    /// The languages in which the lesson can be read.
    languages: Vec<&'static str>,
    /// The hash of the lesson's text: what a system has kept of another one does not count.
    hash: String,
    /// The share of the score from which on the lesson counts as passed.
    mastery: Option<f64>,
    questions: Vec<PackagedQuestion>,
}

/// A question. The lesson is done when the page has an answer to all of them.
#[derive(Clone, Debug, Serialize)]
struct PackagedQuestion {
    gate: String,
    id: String,
    step: String,
    title: String,
    seed: u64,
    traced: bool,
}

/// A package whose lesson was read, and that lacks the page.
#[derive(Clone, Debug)]
pub struct Package {
    /// The lesson with the chosen steps alone.
    lesson: Shipped,
    packaged: PackagedLesson,
    description: Description,
}

impl Package {
    /// Reads the lesson of a package.
    ///
    /// # Errors
    ///
    /// A fault of the lesson or of its translation, a step that is not there, and a lesson without questions.
    pub fn read(order: &PackageOrder) -> Result<Self, PackageError> {
        let mut source = order.lesson.clone();
        let read =
            |text: &str| Lesson::read(&order.lesson.name, text).map_err(PackageError::Lesson);
        let mut lesson = read(&source.text)?;
        if !order.steps.is_empty() {
            let part = lesson.with_steps(&source.text, &order.steps);
            // The line of a step that is not there says nothing.
            let part = part.map_err(|fault| PackageError::Step(fault.message))?;
            lesson = read(&part)?;
            source.text = part.into();
        }

        // The lesson itself is in English. German is the only other language of packages; a lesson without a German
        // text stays as it is.
        let translation = match (&*source.german, &*order.language) {
            ("", _) | (_, "en") => Translation::default(),
            (german, _) => Translation::read(german).map_err(PackageError::Translation)?,
        };

        let packaged = packaged_lesson(&lesson, &translation, order);
        if packaged.questions.is_empty() {
            let is_whole = order.steps.is_empty();
            let who = if is_whole {
                "the lesson has"
            } else {
                "these steps have"
            };
            return Err(PackageError::NoQuestion(who));
        }

        let description = Description {
            id: identity(&lesson.name, &order.steps),
            title: plain(translation.of(&lesson.title)),
            objective: plain(translation.of(&lesson.objective)),
            language: order.language.clone(),
            mastery: packaged.mastery,
        };
        Ok(Self {
            lesson: source,
            packaged,
            description,
        })
    }

    /// Returns how many questions a course gets answers to.
    #[must_use]
    pub fn questions(&self) -> usize {
        self.packaged.questions.len()
    }

    /// Returns the package's file. The same lesson, page and options give the same bytes, natively and in a browser.
    ///
    /// # Errors
    ///
    /// A page of another version of the program, and an archive that would be too large.
    pub fn archive(self, mut page: BuiltPage) -> Result<Vec<u8>, PackageError> {
        let texts = page.course_texts()?;
        let mut files = page.program(self.lesson)?;
        files.extend(around(&self.packaged, &self.description.title, texts)?);

        // The manifest comes last, as it lists all other files.
        let names: Vec<&str> = files.keys().map(String::as_str).collect();
        let written = manifest::of(self.packaged.system, &self.description, &names);
        let (manifest, text) = written.map_err(|error| PackageError::Archive(error.to_string()))?;
        files.insert(manifest.to_owned(), text);
        archive::archive_of(&files)
    }
}

/// Returns what the page reads about its lesson.
fn packaged_lesson(
    lesson: &Lesson,
    translation: &Translation,
    order: &PackageOrder,
) -> PackagedLesson {
    // Where a course system does not take a gate's name, the question is named by its number.
    let questions = lesson
        .gates()
        .enumerate()
        .map(|(index, (step, gate))| PackagedQuestion {
            gate: gate.name.clone(),
            id: identifier(&gate.name, index),
            step: step.name.clone(),
            title: plain(translation.of(&step.title)),
            seed: step.scene.parameters.seed,
            traced: gate.kind.is_trace(),
        });

    // The first language is that of the lesson itself.
    let has_german = !order.lesson.german.is_empty();
    PackagedLesson {
        system: order.system,
        name: lesson.name.clone(),
        language: order.language.clone(),
        languages: PACKAGE_LANGUAGES[..=usize::from(has_german)].to_vec(),
        hash: lesson.hash.clone(),
        mastery: order.pass.map(|percent| f64::from(percent) / 100.0),
        questions: questions.collect(),
    }
}

/// Returns the name of a question for course systems, of which SCORM 1.2 takes letters, digits and hyphens alone.
fn identifier(name: &str, index: usize) -> String {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'-';
    if name.bytes().all(is_plain) {
        name.to_owned()
    } else {
        format!("question-{}", index + 1)
    }
}

/// Returns the name of a package among those of a course: that of the lesson, and the steps if they were chosen.
fn identity(lesson: &str, steps: &[String]) -> String {
    let names = [&[lesson.to_owned()][..], steps].concat();
    let escaped = names.iter().map(|name| {
        let bytes = name.bytes().map(|byte| match byte {
            b'-' => char::from(byte).to_string(),
            _ if byte.is_ascii_alphanumeric() => char::from(byte).to_string(),
            // Identifiers of XML have no percent signs, so that the sign is a low line. It is escaped, too, or two names
            // might give one identifier: "a." and "a_2e".
            _ => format!("_{byte:02x}"),
        });
        bytes.collect::<String>()
    });
    escaped.collect::<Vec<_>>().join(".")
}

/// Returns the files of the page around the program; `texts` are those of the built page.
fn around(
    packaged: &PackagedLesson,
    title: &str,
    mut texts: BTreeMap<String, String>,
) -> Result<BTreeMap<String, Vec<u8>>, PackageError> {
    let mut take = |name: &str| {
        let lacks = PackageError::OtherVersion("it lacks a text of the page of a package");
        texts.remove(name).ok_or(lacks)
    };

    let policy = packaged.system.policy();
    // A page may hold no control characters, which `escape` keeps, and a title needs none.
    let clean = |c: char| if c.is_control() { '\u{fffd}' } else { c };
    let index = [
        ("language", &*packaged.language),
        ("title", title),
        ("policy", policy.as_str()),
    ]
    .into_iter()
    .fold(take(INDEX)?, |page, (mark, value)| {
        let value: String = value.chars().map(clean).collect();
        page.replace(&format!("[[{mark}]]"), &escape(value))
    });

    let written = serde_json::to_string_pretty(packaged);
    let data = written.map_err(|error| PackageError::Archive(error.to_string()))?;
    let lesson = format!("export const LESSON = {data};\n");
    let mut files = BTreeMap::from([
        (INDEX.to_owned(), index.into_bytes()),
        ("lesson.js".to_owned(), lesson.into_bytes()),
    ]);
    for name in SHARED.into_iter().chain([packaged.system.script()]) {
        files.insert(name.to_owned(), take(name)?.into_bytes());
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn different_packages_have_different_identities() {
        let step = |name: &str| vec![name.to_owned()];
        assert_eq!(identity("gaps", &step("a-gap")), "gaps.a-gap");
        // A name that looks like an escaped one, and names that look like a name and a step.
        assert_ne!(identity("a_2e", &[]), identity("a.", &[]));
        assert_ne!(identity("a.b", &[]), identity("a", &step("b")));
        assert_eq!(identity("a_b", &[]), "a_5fb");
    }
}
