//! `tilescope lesson package`: a lesson as a ZIP archive that course systems take. It has the built page, a page around it that
//! speaks with the system (`web/course`), and the list of the lesson's questions. Begin with [`package`].

mod archive;
mod manifest;
mod program;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, bail, ensure};
use clap::{ArgGroup, Args, ValueEnum};
use serde::Serialize;
use tilescope_figures::escape;
use tilescope_formats::write_whole;
use tilescope_lessons::shipped::Shipped;
use tilescope_lessons::{Lesson, Translation, plain};

use super::{LessonTexts, lesson_texts};
use crate::paths::{InFile, check_file, check_inputs_stay, extension, named};
use crate::web;
use manifest::Description;

/// The languages of the page.
const LANGUAGES: [&str; 2] = ["en", "de"];

/// The page's files that are in every package, by their names there.
const PAGE: [(&str, &str); 3] = [
    (
        "course.css",
        include_str!("../../../../web/course/course.css"),
    ),
    (
        "course.js",
        include_str!("../../../../web/course/course.js"),
    ),
    (
        "record.js",
        include_str!("../../../../web/course/record.js"),
    ),
];
/// The page itself, with marks as `[[title]]`.
const INDEX: &str = include_str!("../../../../web/course/index.html");

/// Arguments of `tilescope lesson package`.
#[derive(Debug, Args)]
#[command(group = ArgGroup::new("system").args(["scorm", "cmi5"]).required(true))]
pub struct PackageArguments {
    /// A file, or the name of a lesson that comes with the program
    lesson: String,
    /// The file to write
    #[arg(long, value_name = "FILE.zip")]
    out: PathBuf,
    /// Make a package by this version of SCORM, as most course systems take it
    #[arg(long, value_name = "VERSION")]
    scorm: Option<ScormVersion>,
    /// Make a package by cmi5, for course systems with a record store
    #[arg(long)]
    cmi5: bool,
    /// Only these steps, by their names in links, in the order of the lesson
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    steps: Vec<String>,
    /// The percent of the score from which on the lesson counts as passed; without it there is only a score
    #[arg(long, value_name = "PERCENT", value_parser = clap::value_parser!(u8).range(1..=100))]
    pass: Option<u8>,
    /// The language to begin with, en or de; a learner can change it where the lesson has both
    #[arg(long, value_name = "LANGUAGE", default_value = "en")]
    language: String,
    /// The built page [default: web/dist, or the folder `web` beside the program]
    #[arg(long, value_name = "DIR")]
    folder: Option<PathBuf>,
}

/// A version of SCORM.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ScormVersion {
    /// The one that every system takes
    #[value(name = "1.2")]
    Old,
    /// The fourth edition of SCORM 2004, with the score and the verdict apart
    #[value(name = "2004")]
    New,
}

/// How a course system and the page speak with each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum System {
    /// SCORM 1.2.
    #[serde(rename = "scorm-1.2")]
    Scorm12,
    /// SCORM 2004, fourth edition.
    #[serde(rename = "scorm-2004")]
    Scorm2004,
    /// cmi5.
    #[serde(rename = "cmi5")]
    Cmi5,
}

impl System {
    const fn of(arguments: &PackageArguments) -> Self {
        match arguments.scorm {
            Some(ScormVersion::Old) => Self::Scorm12,
            Some(ScormVersion::New) => Self::Scorm2004,
            None => Self::Cmi5,
        }
    }

    /// Returns its name in messages.
    const fn name(self) -> &'static str {
        match self {
            Self::Scorm12 => "SCORM 1.2",
            Self::Scorm2004 => "SCORM 2004",
            Self::Cmi5 => "cmi5",
        }
    }

    /// Returns the script that speaks with the system, by its name in the package.
    const fn script(self) -> (&'static str, &'static str) {
        match self {
            Self::Scorm12 | Self::Scorm2004 => {
                ("scorm.js", include_str!("../../../../web/course/scorm.js"))
            }
            Self::Cmi5 => ("cmi5.js", include_str!("../../../../web/course/cmi5.js")),
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

/// What the page reads about its lesson: the file `lesson.js`.
#[derive(Debug, Serialize)]
struct PackagedLesson {
    system: System,
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
#[derive(Debug, Serialize)]
struct PackagedQuestion {
    gate: String,
    id: String,
    step: String,
    title: String,
    seed: u64,
    traced: bool,
}

/// Makes a package; returns the line that says how large it is.
///
/// # Errors
///
/// An unknown lesson, step or language; a lesson without questions; no built page; a file that cannot be written.
pub fn package(arguments: &PackageArguments) -> Result<String> {
    let (lesson_name, out) = (&arguments.lesson, &arguments.out);
    let path = named(out);
    ensure!(
        extension(out) == "zip",
        "--out {path}: the file must end in .zip"
    );
    // Before the work, so that it is not in vain.
    check_file(out)?;
    check_inputs_stay(out, [Path::new(lesson_name)])?;
    let language = arguments.language.as_str();
    ensure!(
        LANGUAGES.contains(&language),
        "--language {language}: the page speaks {}",
        LANGUAGES.join(" and ")
    );

    let source = source(arguments)?;
    let lesson = Lesson::read(&source.name, &source.text)
        .map_err(|fault| anyhow!("{lesson_name}: {fault}"))?;
    // English is the language of the lesson itself, and of a lesson that has no translation.
    let translation = match (&*source.german, language) {
        ("", _) | (_, "en") => Translation::default(),
        (german, _) => Translation::read(german)
            .map_err(|fault| anyhow!("{lesson_name} in {language}: {fault}"))?,
    };

    let packaged = packaged_lesson(&lesson, &translation, &source, arguments);
    let asked = match (packaged.questions.len(), arguments.steps.is_empty()) {
        (0, true) => {
            bail!("{lesson_name}: the lesson has no question, so that a course would get no score")
        }
        (0, false) => bail!(
            "{lesson_name}: these steps have no question, so that a course would get no score"
        ),
        (1, _) => "1 question".to_owned(),
        (count, _) => format!("{count} questions"),
    };

    let description = Description {
        id: identity(&lesson.name, &arguments.steps),
        title: plain(translation.of(&lesson.title)),
        objective: plain(translation.of(&lesson.objective)),
        language,
        mastery: packaged.mastery,
    };
    let folder = web::folder(arguments.folder.as_deref())?;
    let mut files = program::files(&folder, source)?;
    files.extend(page(&packaged, &description.title)?);

    // The manifest comes last, as it lists all other files.
    let names: Vec<&str> = files.keys().map(String::as_str).collect();
    let (manifest, text) = manifest::of(packaged.system, &description, &names)?;
    files.insert(manifest.to_owned(), text);

    let bytes = archive::packed(&files)?;
    write_whole(out, &bytes).in_file(out)?;
    let (length, system) = (bytes.len(), packaged.system.name());
    Ok(format!("{path}: {length} bytes, {asked}, for {system}\n"))
}

/// Returns the lesson with the chosen steps, and its German translation, empty if it has none.
fn source(arguments: &PackageArguments) -> Result<Shipped> {
    let asked = lesson_texts(&arguments.lesson, &arguments.language)?;
    let LessonTexts {
        name,
        text,
        translation,
    } = asked;
    // In an English package German can be chosen, if there is a translation: an error means that there is none.
    let in_german = || lesson_texts(&arguments.lesson, "de").ok()?.translation;
    let german = translation.or_else(in_german);

    let text = if arguments.steps.is_empty() {
        text
    } else {
        let whole =
            Lesson::read(&name, &text).map_err(|fault| anyhow!("{}: {fault}", arguments.lesson))?;
        // The line of a step that is not there says nothing.
        whole
            .with_steps(&text, &arguments.steps)
            .map_err(|fault| anyhow!("{}: {}", arguments.lesson, fault.message))?
    };
    Ok(Shipped {
        name: name.into(),
        text: text.into(),
        german: german.unwrap_or_default().into(),
        // Keys are compared where lessons are checked; a package has none.
        keys: "",
    })
}

/// Returns what the page reads about its lesson.
fn packaged_lesson(
    lesson: &Lesson,
    translation: &Translation,
    source: &Shipped,
    arguments: &PackageArguments,
) -> PackagedLesson {
    // A question whose name a course system would refuse is named by its number among the questions, which is the index
    // of its gate.
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
    let has_german = !source.german.is_empty();
    PackagedLesson {
        system: System::of(arguments),
        name: lesson.name.clone(),
        language: arguments.language.clone(),
        languages: LANGUAGES[..=usize::from(has_german)].to_vec(),
        hash: lesson.hash.clone(),
        mastery: arguments.pass.map(|percent| f64::from(percent) / 100.0),
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
            b'-' | b'_' => char::from(byte).to_string(),
            _ if byte.is_ascii_alphanumeric() => char::from(byte).to_string(),
            // Identifiers of XML have no percent signs.
            _ => format!("_{byte:02x}"),
        });
        bytes.collect::<String>()
    });
    escaped.collect::<Vec<_>>().join(".")
}

/// Returns the files of the page around the program.
fn page(packaged: &PackagedLesson, title: &str) -> Result<BTreeMap<String, Vec<u8>>> {
    let policy = packaged.system.policy();
    let index = [
        ("language", &*packaged.language),
        ("title", title),
        ("policy", policy.as_str()),
    ]
    .into_iter()
    .fold(INDEX.to_owned(), |page, (mark, value)| {
        page.replace(&format!("[[{mark}]]"), &escape(value))
    });

    let data = serde_json::to_string_pretty(packaged).context("lesson.js")?;
    let mut files = BTreeMap::from([
        ("index.html".to_owned(), index.into_bytes()),
        (
            "lesson.js".to_owned(),
            format!("export const LESSON = {data};\n").into_bytes(),
        ),
    ]);
    for (name, text) in PAGE.into_iter().chain([packaged.system.script()]) {
        files.insert(name.to_owned(), text.as_bytes().to_vec());
    }
    Ok(files)
}

#[cfg(test)]
mod tests;
