//! `tilescope lesson`: checks lessons, begins new ones, pins their keys, and merges results.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use clap::{Args, Subcommand};
use serde_json::json;
use tilescope_core::{SampleError, Unobserved};
use tilescope_lessons::results::{self, Results};
use tilescope_lessons::{Checked, Lesson, LessonError, Runs, Translation, check, shipped};

use crate::progress::Bar;
use crate::{EXIT_FINE, EXIT_NEGATIVE, FromWindow, interrupt, output};

/// Arguments of `tilescope lesson`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub struct LessonArguments {
    /// What is done with lessons.
    #[command(subcommand)]
    pub command: LessonCommand,
}

/// The commands of `tilescope lesson`.
#[derive(Debug, Subcommand)]
pub enum LessonCommand {
    /// Check lessons: read them, compute every key for many runs, and let three learners answer
    Check(CheckArguments),
    /// Write a new lesson to begin with
    New {
        /// The file, NAME.md
        file: PathBuf,
    },
    /// Open the window on a lesson
    Play {
        /// A file, which is read again whenever it is saved, the name of a lesson that comes with the program, or
        /// "lecture": the lecture of fifty minutes, in presenter mode
        lesson: String,
        /// Begin in presenter mode: for a projector, led by a clicker, with notes in a second window
        #[arg(long)]
        present: bool,
    },
    /// Make a handout: one HTML file with a picture of each step, the questions and space to write
    Handout(HandoutArguments),
    /// Make a lesson of the scenes of a session, to be presented or given questions
    From {
        /// The session, NAME.tilescope
        session: PathBuf,
        /// The lesson, NAME.md; beside the session if not given
        #[arg(long, value_name = "FILE")]
        out: Option<PathBuf>,
    },
    /// List the lessons that come with the program
    List,
    /// Write the keys of lessons to NAME.keys beside them, so that a change of the engine shows as a difference
    Keys(CheckArguments),
    /// Write or renew a translation, NAME.LANGUAGE.md, with every text of the lesson that it lacks
    Translate {
        /// The lesson, NAME.md
        file: PathBuf,
        /// The language, such as de
        language: String,
    },
    /// Merge the results of learners into one table
    Results {
        /// The files that learners saved
        #[arg(required = true)]
        files: Vec<PathBuf>,
        /// The file to write: .csv, or .json for xAPI statements
        #[arg(long, value_name = "FILE")]
        out: PathBuf,
    },
}

/// Which lessons, and how thoroughly.
#[derive(Debug, Args)]
pub struct CheckArguments {
    /// The lessons, NAME.md; without any, those that come with the program
    files: Vec<PathBuf>,
    /// The most seeds of each question
    #[arg(long, value_name = "N", default_value_t = 40, value_parser = clap::value_parser!(u64).range(1..=1000))]
    seeds: u64,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// What a handout holds.
#[derive(Debug, Args)]
pub struct HandoutArguments {
    /// A file, or the name of a lesson that comes with the program
    lesson: String,
    /// The file to write
    #[arg(long, value_name = "FILE.html")]
    out: PathBuf,
    /// Print the answers
    #[arg(long)]
    answers: bool,
    /// Print the speaker's notes
    #[arg(long)]
    notes: bool,
    /// The language: that of NAME.LANGUAGE.md
    #[arg(long, value_name = "LANGUAGE", default_value = "en")]
    language: String,
}

/// A handout to be made.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Handout {
    /// The lesson's name and text.
    pub lesson: (String, String),
    /// The language, and the translation's text, if it is not that of the lesson.
    pub language: (String, Option<String>),
    /// Whether the answers are printed.
    pub answers: bool,
    /// Whether the speaker's notes are printed.
    pub notes: bool,
}

const EXAMPLES: &str = "\
Examples:
  tilescope lesson play gaps            the window, with a lesson that comes with the program
  tilescope lesson play gaps --present  the same, for a projector and a clicker
  tilescope lesson play lecture         the lecture of fifty minutes
  tilescope lesson handout gaps --out gaps.html --answers
  tilescope lesson from talk.tilescope  a lesson of a session's scenes
  tilescope lesson new mine.md          a lesson to begin with
  tilescope lesson check mine.md        every question, for 40 runs; exit code 1 if anything is wrong
  tilescope lesson translate mine.md de
  tilescope lesson results *.json --out class.csv";

/// Runs `tilescope lesson`. Returns the exit code.
pub fn run(arguments: &LessonArguments, window: FromWindow) -> Result<u8> {
    interrupt::listen();
    match &arguments.command {
        LessonCommand::Check(arguments) => check_all(arguments),
        LessonCommand::New { file } => new(file),
        // The program opens the window before commands are run.
        LessonCommand::Play { lesson, .. } => bail!("there is no display to play {lesson} on"),
        LessonCommand::Handout(arguments) => handout(arguments, window),
        LessonCommand::From { session, out } => from(session, out.as_deref(), window),
        LessonCommand::List => list(),
        LessonCommand::Keys(arguments) => keys(arguments),
        LessonCommand::Translate { file, language } => translate(file, language),
        LessonCommand::Results { files, out } => merge(files, out),
    }
}

/// Returns the lesson that is to be played, as a file or the name of one that comes with the program.
///
/// # Errors
///
/// Neither a file nor such a name.
#[must_use]
pub fn played(arguments: &LessonArguments) -> Option<Result<Played>> {
    let LessonCommand::Play { lesson, present } = &arguments.command else {
        return None;
    };
    let lessons = shipped::lessons();
    if lesson == "lecture" {
        return Some(Ok(Played::Lecture));
    }
    let presented = *present;
    if lessons.iter().any(|shipped| shipped.name == *lesson) {
        return Some(Ok(Played::Shipped(lesson.clone(), presented)));
    }
    let file = PathBuf::from(lesson);
    if file.is_file() {
        return Some(Ok(Played::File(file, presented)));
    }
    let names: Vec<&str> = lessons
        .iter()
        .map(|shipped| shipped.name.as_ref())
        .collect();
    Some(Err(anyhow::anyhow!(
        "\"{lesson}\" is no file, and no lesson that comes with the program: lecture, {}",
        names.join(", ")
    )))
}

/// A lesson that is to be played.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Played {
    /// One that comes with the program, and whether in presenter mode.
    Shipped(String, bool),
    /// A file, and whether in presenter mode.
    File(PathBuf, bool),
    /// The lecture of fifty minutes, in presenter mode.
    Lecture,
}

/// A lesson file and its translations, as they are read.
struct Source {
    /// Where it comes from, for messages.
    name: String,
    lesson: Result<Lesson, LessonError>,
    /// Each translation's file name and what reading it gave.
    translations: Vec<(String, Result<Translation, LessonError>)>,
}

fn sources(files: &[PathBuf]) -> Result<Vec<Source>> {
    if files.is_empty() {
        let lessons = shipped::lessons();
        let all = lessons.iter().map(|shipped| Source {
            name: format!("{}.md", shipped.name),
            lesson: Lesson::read(&shipped.name, &shipped.text),
            translations: vec![(
                format!("{}.de.md", shipped.name),
                Translation::read(&shipped.german),
            )],
        });
        return Ok(all.collect());
    }
    files.iter().map(|file| source(file)).collect()
}

fn source(file: &Path) -> Result<Source> {
    let name = name_of(file)?;
    let text = read(file)?;
    let folder = file.parent().unwrap_or(Path::new(""));
    let folder = if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    };
    let mut translations = Vec::new();
    let entries = fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    let mut beside: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .collect();
    beside.sort();
    for path in beside {
        let other = path
            .file_name()
            .map(|other| other.to_string_lossy().into_owned())
            .unwrap_or_default();
        let language = other
            .strip_prefix(&format!("{name}."))
            .and_then(|rest| rest.strip_suffix(".md"));
        if language.is_some_and(|language| !language.is_empty() && !language.contains('.')) {
            translations.push((path.display().to_string(), Translation::read(&read(&path)?)));
        }
    }
    Ok(Source {
        name: file.display().to_string(),
        lesson: Lesson::read(&name, &text),
        translations,
    })
}

fn name_of(file: &Path) -> Result<String> {
    let name = file
        .file_stem()
        .map(|name| name.to_string_lossy().into_owned());
    let is_lesson = file.extension().is_some_and(|extension| extension == "md");
    match name {
        Some(name) if is_lesson && !name.is_empty() => Ok(name),
        _ => bail!("{}: a lesson is a file NAME.md", file.display()),
    }
}

/// Reads a text file of a size that a lesson or results may have.
fn read(file: &Path) -> Result<String> {
    let limit = results::MAX_BYTES as u64;
    let length = fs::metadata(file)
        .with_context(|| file.display().to_string())?
        .len();
    ensure!(
        length <= limit,
        "{}: {length} bytes; at most {limit} are read",
        file.display()
    );
    fs::read_to_string(file).with_context(|| file.display().to_string())
}

/// Checks a lesson with a bar.
fn checked(lesson: &Lesson, seeds: u64) -> Result<Checked> {
    let bar = Bar::new(&lesson.name);
    let mut go_on = |share: f64| {
        bar.set((1000.0 * share) as u64, 1000);
        interrupt::flow().is_continue()
    };
    let found = check(
        lesson,
        seeds as usize,
        &mut Runs::default(),
        &mut Unobserved,
        &mut go_on,
    );
    bar.clear();
    found.map_err(|error: SampleError| error.into())
}

fn check_all(arguments: &CheckArguments) -> Result<u8> {
    let mut objects = Vec::new();
    let mut text = String::new();
    let mut faults = 0;
    for source in sources(&arguments.files)? {
        let lesson = match source.lesson {
            Ok(lesson) => lesson,
            Err(error) => {
                faults += 1;
                let _ = writeln!(text, "{}: {error}", source.name);
                objects.push(json!({"file": source.name, "faults": [error.to_string()]}));
                continue;
            }
        };
        let found = checked(&lesson, arguments.seeds)?;
        let mut lines: Vec<String> = found
            .faults
            .iter()
            .map(|fault| format!("{}: {fault}", source.name))
            .collect();
        for (name, translation) in &source.translations {
            lines.extend(of_translation(&lesson, name, translation));
        }
        faults += lines.len();
        for line in &lines {
            let _ = writeln!(text, "{line}");
        }
        let (gates, runs) = (lesson.gates().count(), found.questions);
        let _ = writeln!(
            text,
            "{}: {} steps, {gates} questions, asked {runs} times; scores: perfect {:.2}, guessing {:.2}, misconceived {:.2}{}",
            source.name,
            lesson.steps.len(),
            found.perfect,
            found.guessing,
            found.misconceived,
            if lines.is_empty() { "" } else { "; NOT FINE" },
        );
        objects.push(json!({
            "file": source.name, "steps": lesson.steps.len(), "questions": gates, "asked": runs, "perfect": found.perfect,
            "guessing": found.guessing, "misconceived": found.misconceived, "faults": lines,
        }));
    }
    output::report(arguments.json, || json!(objects), || text)?;
    Ok(if faults == 0 {
        EXIT_FINE
    } else {
        EXIT_NEGATIVE
    })
}

/// Returns the faults of a translation.
fn of_translation(
    lesson: &Lesson,
    name: &str,
    translation: &Result<Translation, LessonError>,
) -> Vec<String> {
    match translation {
        Err(error) => vec![format!("{name}: {error}")],
        Ok(translation) => {
            let (missing, stale) = translation.compared(lesson);
            let missing = missing
                .iter()
                .map(|text| format!("{name}: not translated: \"{text}\""));
            missing
                .chain(stale.iter().map(|error| format!("{name}: {error}")))
                .collect()
        }
    }
}

fn new(file: &Path) -> Result<u8> {
    name_of(file)?;
    ensure!(
        !file.exists(),
        "{}: the file exists; it is not overwritten",
        file.display()
    );
    write(file, shipped::TEMPLATE)?;
    output::emit(&format!(
        "{0}\ncheck it:  tilescope lesson check {0}\nplay it:   tilescope lesson play {0}\n",
        file.display()
    ))?;
    Ok(EXIT_FINE)
}

fn write(file: &Path, text: &str) -> Result<()> {
    tilescope_formats::write_whole(file, text.as_bytes())
        .with_context(|| file.display().to_string())
}

fn list() -> Result<u8> {
    let mut text = String::new();
    for shipped in shipped::lessons() {
        let lesson = Lesson::read(&shipped.name, &shipped.text);
        let lesson = lesson.map_err(|error| anyhow::anyhow!("{}: {error}", shipped.name))?;
        let _ = writeln!(
            text,
            "{:<12} {} ({} min): {}",
            lesson.name, lesson.title, lesson.minutes, lesson.objective
        );
    }
    output::emit(&text)?;
    Ok(EXIT_FINE)
}

/// Returns the name and the text of a lesson, and the text of its translation into a language.
fn lesson_named(name: &str, language: &str) -> Result<(String, String, Option<String>)> {
    let is_other = language != "en";
    if let Some(shipped) = shipped::lessons()
        .iter()
        .find(|shipped| shipped.name == name)
    {
        ensure!(
            !is_other || language == "de",
            "--language {language}: {name} comes in en and de"
        );
        let translation = is_other.then(|| shipped.german.to_string());
        return Ok((name.to_owned(), shipped.text.to_string(), translation));
    }
    let file = Path::new(name);
    ensure!(
        file.is_file(),
        "\"{name}\" is no file, and no lesson that comes with the program"
    );
    let name = name_of(file)?;
    let translation = file.with_file_name(format!("{name}.{language}.md"));
    let translation = is_other.then(|| read(&translation)).transpose()?;
    Ok((name, read(file)?, translation))
}

fn handout(arguments: &HandoutArguments, window: FromWindow) -> Result<u8> {
    let is_html = arguments
        .out
        .extension()
        .is_some_and(|extension| extension == "html");
    ensure!(
        is_html,
        "--out {}: the file is .html",
        arguments.out.display()
    );
    let (name, text, translation) = lesson_named(&arguments.lesson, &arguments.language)?;
    let made = (window.handout)(Handout {
        lesson: (name, text),
        language: (arguments.language.clone(), translation),
        answers: arguments.answers,
        notes: arguments.notes,
    });
    let html = made.map_err(|fault| anyhow::anyhow!("{}: {fault}", arguments.lesson))?;
    write(&arguments.out, &html)?;
    output::emit(&format!(
        "{}: {} bytes\n",
        arguments.out.display(),
        html.len()
    ))?;
    Ok(EXIT_FINE)
}

fn from(session: &Path, out: Option<&Path>, window: FromWindow) -> Result<u8> {
    let out = out.map_or_else(|| session.with_extension("md"), Path::to_path_buf);
    name_of(&out)?;
    ensure!(
        !out.exists(),
        "{}: the file exists; it is not overwritten",
        out.display()
    );
    let made = (window.lesson_of_session)(&read_session(session)?);
    let text = made.map_err(|fault| anyhow::anyhow!("{}: {fault}", session.display()))?;
    write(&out, &text)?;
    output::emit(&format!(
        "{0}\npresent it:  tilescope lesson play {0} --present\nprint it:    tilescope lesson handout {0} --out {1}\n",
        out.display(),
        out.with_extension("html").display()
    ))?;
    Ok(EXIT_FINE)
}

/// Larger sessions are not read.
const MAX_SESSION: u64 = 16 << 20;

fn read_session(file: &Path) -> Result<String> {
    let length = fs::metadata(file)
        .with_context(|| file.display().to_string())?
        .len();
    ensure!(
        length <= MAX_SESSION,
        "{}: {length} bytes; at most {MAX_SESSION} are read",
        file.display()
    );
    fs::read_to_string(file).with_context(|| file.display().to_string())
}

fn keys(arguments: &CheckArguments) -> Result<u8> {
    ensure!(
        !arguments.files.is_empty(),
        "name the lessons whose keys are to be written"
    );
    for file in &arguments.files {
        let source = source(file)?;
        let lesson = source
            .lesson
            .map_err(|error| anyhow::anyhow!("{}: {error}", source.name))?;
        let found = checked(&lesson, arguments.seeds)?;
        if let Some(fault) = found.faults.first() {
            bail!("{}: {fault}", source.name);
        }
        write(&file.with_extension("keys"), &found.keys)?;
    }
    Ok(EXIT_FINE)
}

fn translate(file: &Path, language: &str) -> Result<u8> {
    let is_language = (2..=8).contains(&language.len())
        && language.chars().all(|c| c.is_ascii_lowercase() || c == '-');
    ensure!(is_language, "\"{language}\" is not a language such as de");
    let name = name_of(file)?;
    let lesson = Lesson::read(&name, &read(file)?)
        .map_err(|error| anyhow::anyhow!("{}: {error}", file.display()))?;
    let target = file.with_file_name(format!("{name}.{language}.md"));
    let old = if target.exists() {
        Translation::read(&read(&target)?)
            .map_err(|error| anyhow::anyhow!("{}: {error}", target.display()))?
    } else {
        Translation::default()
    };
    let (missing, stale) = old.compared(&lesson);
    write(&target, &old.renewed(&lesson))?;
    output::emit(&format!(
        "{}: {} texts to be translated (marked TODO), {} that the lesson no longer has are left out\n",
        target.display(),
        missing.len(),
        stale.len()
    ))?;
    Ok(EXIT_FINE)
}

fn merge(files: &[PathBuf], out: &Path) -> Result<u8> {
    let mut all = Vec::new();
    for file in files {
        let mut results =
            Results::read(&read(file)?).with_context(|| file.display().to_string())?;
        if results.learner.is_empty() {
            results.learner = file
                .file_stem()
                .map(|name| name.to_string_lossy().into_owned())
                .unwrap_or_default();
        }
        all.push(results);
    }
    let text = match out.extension().and_then(|extension| extension.to_str()) {
        Some("csv") => results::csv(&all)?,
        Some("json") => {
            let statements: Vec<_> = all.iter().map(Results::xapi).collect();
            let flat: Vec<_> = statements
                .iter()
                .filter_map(|list| list.as_array())
                .flatten()
                .collect();
            serde_json::to_string_pretty(&flat)?
        }
        _ => bail!(
            "--out {}: the file is .csv, or .json for xAPI statements",
            out.display()
        ),
    };
    write(out, &text)?;
    let entries: usize = all.iter().map(|results| results.entries.len()).sum();
    output::emit(&format!(
        "{}: {entries} entries of {} learners\n",
        out.display(),
        all.len()
    ))?;
    Ok(EXIT_FINE)
}
