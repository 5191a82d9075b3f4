//! `tilescope lesson package`: a lesson as a ZIP archive that course systems take. `tilescope_lessons::package` makes it of the
//! built page. Begin with [`package`].

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Result, anyhow, ensure};
use clap::{ArgGroup, Args, ValueEnum};
use tilescope_formats::write_whole;
use tilescope_lessons::package::{
    BuiltPage, CourseSystem, PACKAGE_LANGUAGES, Package, PackageOrder,
};
use tilescope_lessons::shipped::Shipped;

use super::{LessonTexts, lesson_texts};
use crate::paths::{InFile, check_file, check_inputs_stay, extension, named};
use crate::web;

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

impl PackageArguments {
    /// Returns the kind of course system that the package is for.
    const fn system(&self) -> CourseSystem {
        match self.scorm {
            Some(ScormVersion::Old) => CourseSystem::Scorm12,
            Some(ScormVersion::New) => CourseSystem::Scorm2004,
            None => CourseSystem::Cmi5,
        }
    }
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
    // The path is checked before the work, which would be in vain if the file could not be written.
    check_file(out)?;
    check_inputs_stay(out, [Path::new(lesson_name)])?;
    let language = arguments.language.as_str();
    ensure!(
        PACKAGE_LANGUAGES.contains(&language),
        "--language {language}: the page speaks {}",
        PACKAGE_LANGUAGES.join(" and ")
    );

    let order = PackageOrder {
        lesson: source(arguments)?,
        system: arguments.system(),
        steps: arguments.steps.clone(),
        language: language.to_owned(),
        pass: arguments.pass,
    };
    let package = Package::read(&order).map_err(|fault| anyhow!("{lesson_name}: {fault}"))?;
    let asked = match package.questions() {
        1 => "1 question".to_owned(),
        count => format!("{count} questions"),
    };

    let folder = web::folder(arguments.folder.as_deref())?;
    let read = |name: &str| {
        let path = folder.join(name);
        fs::read(&path).in_file(&path)
    };
    let bytes = package.archive(BuiltPage::of(read)?).in_file(&folder)?;
    write_whole(out, &bytes).in_file(out)?;
    let (length, system) = (bytes.len(), order.system.name());
    Ok(format!("{path}: {length} bytes, {asked}, for {system}\n"))
}

/// Returns the lesson with its German translation, empty if it has none.
fn source(arguments: &PackageArguments) -> Result<Shipped> {
    let asked = lesson_texts(&arguments.lesson, &arguments.language)?;
    let LessonTexts {
        name,
        text,
        translation,
    } = asked;
    // In an English package German can be chosen, if there is a translation: with a lesson of the program, or beside a file.
    let beside = Path::new(&arguments.lesson).with_file_name(format!("{name}.de.md"));
    let has_german = super::shipped_lesson(&arguments.lesson).is_some() || beside.exists();
    let german = match translation {
        None if has_german => lesson_texts(&arguments.lesson, "de")?.translation,
        translation => translation,
    };
    Ok(Shipped {
        name: name.into(),
        text: text.into(),
        german: german.unwrap_or_default().into(),
        // Keys are compared where lessons are checked; a package has none.
        keys: "",
    })
}

#[cfg(test)]
mod tests;
