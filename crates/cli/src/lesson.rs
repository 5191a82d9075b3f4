//! `tilescope lesson`: checks lessons, writes new ones and their keys, translations and handouts, and merges results.

mod gain_page;
mod package;

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, anyhow, bail, ensure};
use clap::{Args, Subcommand};
use serde_json::{Value, json};
use tilescope_analysis::{lossy, shown_in_line};
use tilescope_core::Unobserved;
use tilescope_figures::{Font, lacking};
use tilescope_formats::write_whole;
use tilescope_lessons::gain::Gains;
use tilescope_lessons::results::{self, Merged, Results};
use tilescope_lessons::shipped::{self, Shipped};
use tilescope_lessons::{Checked, Lesson, LessonError, Runs, Translation, check, is_language};

use package::PackageArguments;

use crate::paths::{InFile, check_inputs_stay, extension, named};
use crate::progress::bar;
use crate::{EXIT_FINE, FromWindow, interrupt, output, verdict_code};

/// The commands of `tilescope lesson`.
#[derive(Debug, Subcommand)]
pub enum LessonCommand {
    /// Check lessons: read them, compute every key for many runs, let three learners answer, and search what the window
    /// shows for answers
    Check(CheckArguments),
    /// Write a new lesson, to be edited
    New {
        /// The file, NAME.md
        file: PathBuf,
    },
    /// Open the window on a lesson
    Play {
        /// A file, which is read again whenever it is saved; the name of a lesson that comes with the program; or
        /// "lecture", the lecture of fifty minutes, in presenter mode
        lesson: String,
        /// Begin in presenter mode: for a projector, led by a clicker, with notes in a second window
        #[arg(long)]
        present: bool,
    },
    /// Make a handout: one HTML file with a picture of each step, the questions and space to write
    Handout(HandoutArguments),
    /// Make a package for a course system (LMS): a ZIP archive with the program and the lesson, which reports score,
    /// completion and answers by SCORM or cmi5
    Package(PackageArguments),
    /// Make a lesson of the scenes of a session, to be presented or given questions
    From {
        /// The session, NAME.tilescope
        session: PathBuf,
        /// The lesson, NAME.md; if not given, it is written beside the session
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
        /// The language, such as de, zh-Hant or pt-BR
        language: String,
    },
    /// Merge the results of learners into one table, and compare the forms before and after
    Results(ResultsArguments),
}

/// The lessons to check, and the number of runs.
#[derive(Debug, Args)]
pub struct CheckArguments {
    /// The lessons, NAME.md; if not given, those that come with the program
    files: Vec<PathBuf>,
    /// The largest number of seeds of each question
    #[arg(long, value_name = "N", default_value_t = 40, value_parser = clap::value_parser!(u64).range(1..=1000))]
    seeds: u64,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Arguments of `tilescope lesson results`.
#[derive(Debug, Args)]
pub struct ResultsArguments {
    /// The files that learners saved
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// The file to write: .csv, or .json for xAPI statements
    #[arg(long, value_name = "FILE", required_unless_present = "gain")]
    out: Option<PathBuf>,
    /// Write the normalized gain from the form before to the form after: .csv, or .html for a page with a picture; may be
    /// given twice
    #[arg(long, value_name = "FILE")]
    gain: Vec<PathBuf>,
}

/// Arguments of `tilescope lesson handout`.
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

/// The content of a handout.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Handout {
    /// The name by which the lesson is opened.
    pub name: String,
    /// The content of the lesson's file.
    pub text: String,
    /// The language of the handout.
    pub language: String,
    /// The text of the translation, if the language is not the lesson's.
    pub translation: Option<String>,
    /// Whether the answers are printed.
    pub answers: bool,
    /// Whether the speaker's notes are printed.
    pub notes: bool,
}

/// The end of the help of `tilescope lesson`.
pub(crate) const EXAMPLES: &str = "\
Examples:
  tilescope lesson play gaps            the window, with a lesson that comes with the program
  tilescope lesson play gaps --present  the same, for a projector and a clicker
  tilescope lesson play lecture         the lecture of fifty minutes
  tilescope lesson handout gaps --out gaps.html --answers
  tilescope lesson package gaps --scorm 1.2 --out gaps.zip
  tilescope lesson from talk.tilescope  a lesson of a session's scenes
  tilescope lesson new mine.md          a new lesson, to be edited
  tilescope lesson check mine.md        every question, for 40 runs; exit code 1 if anything is wrong
  tilescope lesson translate mine.md de
  tilescope lesson results *.json --out class.csv --gain gain.html";

/// Runs `tilescope lesson`. Returns the exit code.
pub fn run(command: &LessonCommand, window: FromWindow) -> Result<u8> {
    interrupt::listen();
    match command {
        LessonCommand::Check(arguments) => return check_all(arguments, window),
        LessonCommand::New { file } => new(file)?,
        // The program opens the window before commands are run.
        LessonCommand::Play { lesson, .. } => bail!(
            "{lesson} is played in the window, and there is none: there is no display, or this build has no window"
        ),
        LessonCommand::Handout(arguments) => handout(arguments, window)?,
        LessonCommand::Package(arguments) => output::emit(&package::package(arguments)?)?,
        LessonCommand::From { session, out } => from(session, out.as_deref(), window)?,
        LessonCommand::List => list()?,
        LessonCommand::Keys(arguments) => keys(arguments)?,
        LessonCommand::Translate { file, language } => translate(file, language)?,
        LessonCommand::Results(arguments) => merge(arguments)?,
    }
    Ok(EXIT_FINE)
}

/// A lesson to be played.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Played {
    /// A lesson that comes with the program.
    Shipped {
        /// The name by which it is opened.
        name: String,
        /// Whether it begins in presenter mode.
        is_presented: bool,
    },
    /// A lesson in a file.
    File {
        /// The path of the file.
        file: PathBuf,
        /// Whether it begins in presenter mode.
        is_presented: bool,
    },
    /// The lecture of fifty minutes, in presenter mode.
    Lecture,
}

/// Returns the lesson to be played; `None` if the command is not `play`.
///
/// # Errors
///
/// The argument is neither `lecture` nor a file nor the name of a lesson that comes with the program.
#[must_use]
pub fn played(command: &LessonCommand) -> Option<Result<Played>> {
    let LessonCommand::Play { lesson, present } = command else {
        return None;
    };
    let (file, is_presented) = (PathBuf::from(lesson), *present);
    // Names of the program come before files; a file of such a name is reached as ./NAME.
    Some(if lesson == "lecture" {
        Ok(Played::Lecture)
    } else if shipped_lesson(lesson).is_some() {
        let name = lesson.clone();
        Ok(Played::Shipped { name, is_presented })
    } else if file.is_file() {
        Ok(Played::File { file, is_presented })
    } else {
        let names: Vec<_> = shipped::all().into_iter().map(|one| one.name).collect();
        let (refusal, names) = (no_lesson(lesson), names.join(", "));
        Err(anyhow!("{refusal}: lecture, {names}"))
    })
}

fn no_lesson(name: &str) -> String {
    let name = shown_in_line(name);
    format!("\"{name}\" is no file, and no lesson that comes with the program")
}

fn shipped_lesson(name: &str) -> Option<Shipped> {
    shipped::all().into_iter().find(|one| one.name == name)
}

/// A lesson file and its translations, or why they cannot be read.
struct Source {
    /// The path, for messages.
    name: String,
    /// The content of the lesson's file.
    text: String,
    lesson: Result<Lesson, LessonError>,
    /// The path and the content of each translation.
    translations: Vec<(String, Result<Translation, LessonError>)>,
}

impl Source {
    fn of_shipped(shipped: &Shipped) -> Self {
        let (name, german) = (&shipped.name, Translation::read(&shipped.german));
        Self {
            name: format!("{name}.md"),
            text: shipped.text.clone().into_owned(),
            lesson: Lesson::read(name, &shipped.text),
            translations: vec![(format!("{name}.de.md"), german)],
        }
    }

    /// Reads a lesson and the files NAME.LANGUAGE.md beside it.
    fn of_file(file: &Path) -> Result<Self> {
        let name = name_of(file)?;
        let text = read(file)?;
        let lesson = Lesson::read(&name, &text);
        // A bare file name has the empty path as its parent, which is no folder that can be listed.
        let folder = (file.parent())
            .filter(|folder| *folder != Path::new(""))
            .unwrap_or(Path::new("."));
        let entries = fs::read_dir(folder).in_file(folder)?;

        // The file is NAME.LANGUAGE.md: without its ending the language is an extension, too. Any word is taken for a
        // language.
        let is_translation = |path: &PathBuf| {
            let named = path.with_extension("");
            path.extension().is_some_and(|extension| extension == "md")
                && named.extension().is_some()
                && named.file_stem().is_some_and(|stem| *stem == *name)
        };
        // An entry that the system fails to list is passed over.
        let entries = entries.filter_map(|entry| Some(entry.ok()?.path()));
        let mut paths: Vec<PathBuf> = entries.filter(is_translation).collect();
        // Systems list a folder in any order; the report is to have one order.
        paths.sort();

        // A fault of the text is a finding of the check; only a file that cannot be read ends it.
        let translation = |path: &PathBuf| Ok((named(path), Translation::read(&read(path)?)));
        Ok(Self {
            name: named(file),
            text,
            lesson,
            translations: paths.iter().map(translation).collect::<Result<_>>()?,
        })
    }
}

fn name_of(file: &Path) -> Result<String> {
    let is_lesson = file.extension().is_some_and(|extension| extension == "md");
    ensure!(is_lesson, "{}: a lesson is a file NAME.md", named(file));
    Ok(stem(file))
}

fn stem(file: &Path) -> String {
    let stem = file.file_stem().unwrap_or_default();
    stem.to_string_lossy().into_owned()
}

/// Reads a lesson or results.
fn read(file: &Path) -> Result<String> {
    read_text(file, results::MAX_BYTES as u64)
}

fn read_text(file: &Path, limit: u64) -> Result<String> {
    let (length, path) = (fs::metadata(file).in_file(file)?.len(), named(file));
    ensure!(
        length <= limit,
        "{path}: {length} bytes; at most {limit} are read"
    );
    fs::read_to_string(file).in_file(file)
}

fn write(file: &Path, text: &str) -> Result<()> {
    write_whole(file, text.as_bytes()).in_file(file)
}

/// Writes a file that must not exist yet.
fn create(file: &Path, text: &str) -> Result<()> {
    ensure!(
        !file.exists(),
        "{}: the file exists; it is not overwritten",
        named(file)
    );
    write(file, text)
}

/// Checks a lesson with a bar.
fn checked(lesson: &Lesson, seeds: u64) -> Result<Checked> {
    /// More steps than a terminal has columns.
    const STEPS: u64 = 1000;

    let bar = bar(&lesson.name, STEPS);
    let mut go_on = |share: f64| {
        bar.set_position((STEPS as f64 * share) as u64);
        interrupt::flow().is_continue()
    };
    let (seeds, mut runs) = (seeds as usize, Runs::default());
    let found = check(lesson, seeds, &mut runs, &mut Unobserved, &mut go_on);
    Ok(found?)
}

/// Returns a fault of a file as editors read it, to go to its line.
fn at(name: &str, fault: &LessonError) -> String {
    let LessonError { line, message } = fault;
    format!("{name}:{line}: {message}")
}

/// Adds the path and the line to the fault of a file.
fn with_line<T>(read: Result<T, LessonError>, file: &Path) -> Result<T> {
    read.map_err(|fault| anyhow!(at(&named(file), &fault)))
}

/// Checks lessons, or all that come with the program if none are named, and prints a report of each.
fn check_all(arguments: &CheckArguments, window: FromWindow) -> Result<u8> {
    // All files are read before the first is checked, which may take minutes.
    let sources: Vec<Source> = if arguments.files.is_empty() {
        shipped::all().iter().map(Source::of_shipped).collect()
    } else {
        let each = arguments.files.iter().map(|file| Source::of_file(file));
        each.collect::<Result<_>>()?
    };

    let (mut objects, mut text, mut is_fine) = (Vec::new(), String::new(), true);
    for source in sources {
        let report = reported(source, arguments.seeds, window)?;
        is_fine &= report.is_fine;
        text += &report.text;
        objects.push(report.object);
    }

    output::report(arguments.json, || json!(objects), || text)?;
    Ok(verdict_code(is_fine))
}

/// The findings of a check of one lesson.
struct Report {
    /// A line for each fault and each warning, then the lesson's numbers; of a lesson that cannot be read its fault
    /// alone.
    text: String,
    /// The same for programs.
    object: Value,
    /// Whether there is no fault.
    is_fine: bool,
}

/// Checks a lesson and its translations.
///
/// # Errors
///
/// The check was interrupted.
fn reported(source: Source, seeds: u64, window: FromWindow) -> Result<Report> {
    let name = source.name;
    let lesson = match source.lesson {
        Ok(lesson) => lesson,
        // The other parts of a lesson that cannot be read cannot be checked either.
        Err(error) => {
            let fault = at(&name, &error);
            return Ok(Report {
                text: format!("{fault}\n"),
                object: json!({ "file": name, "faults": [fault] }),
                is_fine: false,
            });
        }
    };
    // Every question is asked in the runs of all seeds. `found` has the faults, and the mean scores of three kinds of
    // learners.
    let found = checked(&lesson, seeds)?;
    // A letter that is missing is no fault: the lesson may be for machines whose fonts have it.
    let original = lesson.texts().concat();
    let mut warnings: Vec<String> = letters_warning(&name, &original).into_iter().collect();

    // Leaks are texts of the window that give an answer away. Without a window all other rules are checked, and the
    // report says that this one was not.
    let leaks = (window.leaks)(&lesson.name, &source.text).unwrap_or_else(|why| {
        warnings.push(format!(
            "{name}: warning: the texts of the window are not searched for answers: {why}"
        ));
        Vec::new()
    });
    let all = found.faults.iter().chain(&leaks);
    let mut faults: Vec<String> = all.map(|fault| at(&name, fault)).collect();

    // The fonts may have all letters of the lesson, and lack some of a translation.
    for (name, translation) in source.translations {
        if let Ok(translation) = &translation {
            let texts = lesson.texts();
            // As the window shows it: a text that is not translated stays in the lesson's language.
            let said: String = texts.iter().map(|text| translation.of(text)).collect();
            warnings.extend(letters_warning(&name, &said));
        }
        faults.extend(faults_of_translation(&name, translation, &lesson));
    }

    let mut text = String::new();
    for line in faults.iter().chain(&warnings) {
        let _ = writeln!(text, "{line}");
    }
    let is_fine = faults.is_empty();
    let (steps, gates) = (lesson.steps.len(), lesson.gates().count());
    let _ = writeln!(
        text,
        "{name}: {steps} steps, {gates} questions, asked {} times; \
         scores: perfect {:.2}, guessing {:.2}, misconceived {:.2}{}",
        found.questions,
        found.perfect,
        found.guessing,
        found.misconceived,
        if is_fine { "" } else { "; NOT FINE" },
    );

    let object = json!({
        "file": name, "steps": steps, "questions": gates, "asked": found.questions, "faults": faults, "warnings": warnings,
        "perfect": found.perfect, "guessing": found.guessing, "misconceived": found.misconceived,
    });
    Ok(Report {
        text,
        object,
        is_fine,
    })
}

/// Returns the faults of a translation, and the texts of the lesson that it lacks.
fn faults_of_translation(
    name: &str,
    translation: Result<Translation, LessonError>,
    lesson: &Lesson,
) -> Vec<String> {
    // `wrong` has the fault of a file that cannot be read, or translations of texts that the lesson does not have.
    let (missing, wrong) = match translation {
        Err(error) => (Vec::new(), vec![error]),
        Ok(translation) => translation.compared(&lesson.texts()),
    };
    // A text that is missing has no line of its own, and editors go to the first one.
    let missing = missing
        .iter()
        .map(|text| LessonError::new(1, format!("not translated: \"{text}\"")));
    let all = missing.chain(wrong);
    all.map(|fault| at(name, &fault)).collect()
}

/// Returns a warning about letters that the program's fonts lack, if a text has such.
fn letters_warning(name: &str, text: &str) -> Option<String> {
    let lacking = lacking(text, Font::Regular);
    let first = lacking.first()?;
    let (count, code) = (lacking.len(), u32::from(*first));
    Some(format!(
        "{name}: warning: the program's fonts lack {count} letters of the text, such as {first} (U+{code:04X}); the window \
         shows them by a font of the system, if it has one, and handouts by one of the reader's, but pictures and \
         animations show boxes with their codes"
    ))
}

fn new(file: &Path) -> Result<()> {
    name_of(file)?;
    create(file, shipped::TEMPLATE)?;
    let path = named(file);
    output::emit(&format!(
        "{path}\ncheck it:  tilescope lesson check {path}\nplay it:   tilescope lesson play {path}\n"
    ))
}

fn list() -> Result<()> {
    let mut text = String::new();
    for Source { name, lesson, .. } in shipped::all().iter().map(Source::of_shipped) {
        let lesson = lesson.context(name)?;
        let (name, title, minutes) = (&lesson.name, &lesson.title, lesson.minutes);
        let objective = &lesson.objective;
        let _ = writeln!(text, "{name:<12} {title} ({minutes} min): {objective}");
    }
    output::emit(&text)
}

/// The texts of a lesson, as they stand in its files.
struct LessonTexts {
    name: String,
    text: String,
    /// The translation, if the language that was asked for is not English.
    translation: Option<String>,
}

/// Returns the texts of a lesson: a file, or one that comes with the program.
fn lesson_texts(lesson: &str, language: &str) -> Result<LessonTexts> {
    check_language(language)?;

    // The lesson's own file is the text for `en`, the default, whatever its language.
    let is_translated = language != "en";
    // A lesson of the program has its translation with it, and no files beside it in which others could be.
    if let Some(shipped) = shipped_lesson(lesson) {
        let translation = shipped.translation(language).map(str::to_owned);
        ensure!(
            !is_translated || translation.is_some(),
            "--language {language}: {lesson} comes in en and de"
        );
        return Ok(LessonTexts {
            name: lesson.to_owned(),
            text: shipped.text.into_owned(),
            translation,
        });
    }

    let file = Path::new(lesson);
    ensure!(file.is_file(), no_lesson(lesson));
    let name = name_of(file)?;
    let beside = file.with_file_name(format!("{name}.{language}.md"));
    let translation = is_translated.then(|| read(&beside)).transpose()?;
    Ok(LessonTexts {
        name,
        text: read(file)?,
        translation,
    })
}

/// Writes a handout of a lesson.
fn handout(arguments: &HandoutArguments, window: FromWindow) -> Result<()> {
    let (lesson, out) = (&arguments.lesson, &arguments.out);
    let is_html = out.extension().is_some_and(|extension| extension == "html");
    let path = named(out);
    ensure!(is_html, "--out {path}: the file must end in .html");
    check_inputs_stay(out, [Path::new(lesson)])?;
    let texts = lesson_texts(lesson, &arguments.language)?;
    let made = (window.handout)(Handout {
        name: texts.name,
        text: texts.text,
        language: arguments.language.clone(),
        translation: texts.translation,
        answers: arguments.answers,
        notes: arguments.notes,
    });
    let html = made.map_err(|fault| anyhow!("{lesson}: {fault}"))?;

    write(out, &html)?;
    output::emit(&format!("{path}: {} bytes\n", html.len()))
}

/// The longest session that is read, in bytes: 16 MiB, chosen, not measured.
const MAX_SESSION: u64 = 16 << 20;

/// Makes a lesson of the scenes of a saved session.
fn from(session: &Path, out: Option<&Path>, window: FromWindow) -> Result<()> {
    let out = out.map_or_else(|| session.with_extension("md"), Path::to_path_buf);
    // The name of the file becomes the name of the lesson: it is checked before the work begins.
    name_of(&out)?;
    let made = (window.lesson_of_session)(&read_text(session, MAX_SESSION)?);
    let text = made.map_err(|fault| anyhow!("{}: {fault}", named(session)))?;
    // The lesson may have been edited since it was made, so that it is not replaced.
    create(&out, &text)?;
    let (path, html) = (named(&out), out.with_extension("html"));
    output::emit(&format!(
        "{path}\npresent it:  tilescope lesson play {path} --present\n\
         print it:    tilescope lesson handout {path} --out {}\n",
        named(&html)
    ))
}

/// Writes the keys of lessons, which are the right answers in all runs, beside their files.
fn keys(arguments: &CheckArguments) -> Result<()> {
    // The lessons that come with the program are no files beside which keys could stand.
    ensure!(
        !arguments.files.is_empty(),
        "name the lessons whose keys are to be written"
    );
    for file in &arguments.files {
        let lesson = with_line(Source::of_file(file)?.lesson, file)?;
        let found = checked(&lesson, arguments.seeds)?;
        // A lesson with a fault may have false keys: neither these are written nor those of the lessons after it.
        if let Some(fault) = found.faults.first() {
            bail!(at(&named(file), fault));
        }
        let target = file.with_extension("keys");
        // A link of this name may lead to the lesson itself.
        check_inputs_stay(&target, [file.as_path()])?;
        write(&target, &found.keys)?;
    }
    Ok(())
}

fn check_language(language: &str) -> Result<()> {
    ensure!(
        is_language(language),
        "\"{language}\" is not a language such as de, zh-Hant or pt-BR"
    );
    Ok(())
}

/// Writes the translation of a lesson anew: with the texts of the old one, and marks where texts are missing.
fn translate(file: &Path, language: &str) -> Result<()> {
    check_language(language)?;
    let name = name_of(file)?;
    let lesson = with_line(Lesson::read(&name, &read(file)?), file)?;
    let target = file.with_file_name(format!("{name}.{language}.md"));
    check_inputs_stay(&target, [file])?;
    // A translation that is there already keeps its texts.
    let old = if target.exists() {
        with_line(Translation::read(&read(&target)?), &target)?
    } else {
        Translation::default()
    };

    // Missing and stale texts are counted in the old translation: the renewed one has every text, if only as TODO.
    let texts = lesson.texts();
    let (missing, stale) = old.compared(&texts);
    write(&target, &old.renewed(&texts))?;
    output::emit(&format!(
        "{}: {} texts to be translated (marked TODO), {} that the lesson no longer has are left out\n",
        named(&target),
        missing.len(),
        stale.len()
    ))
}

/// Merges the results of learners, and writes their entries, their gains, or both, as the arguments ask.
fn merge(arguments: &ResultsArguments) -> Result<()> {
    let ResultsArguments { files, out, gain } = arguments;
    for target in out.iter().chain(gain) {
        check_inputs_stay(target, files.iter().map(PathBuf::as_path))?;
    }

    // A learner who gave no name is known by the name of the file.
    let named_results = |file: &PathBuf| {
        let name = lossy(file.file_stem().unwrap_or_default());
        Ok((
            name.into_owned(),
            Results::read(&read(file)?).in_file(file)?,
        ))
    };
    let handed_in: Vec<(String, Results)> =
        files.iter().map(named_results).collect::<Result<_>>()?;
    let merged = Merged::of(handed_in);

    // All texts are made before the first file is written, so that a fault leaves no file behind.
    let mut made = Vec::new();
    if let Some(out) = out {
        made.push((out, entries_text(&merged, out)?));
    }
    for file in gain {
        made.push((file, gains_text(&merged, file)?));
    }
    for (file, text) in &made {
        write(file, text)?;
    }

    let entries: usize = merged.all.iter().map(|one| one.entries.len()).sum();
    let learners = merged.learners();
    // A learner may hand in a file and later a longer one, which has the same entries and more.
    let repeated = match merged.repeated {
        0 => String::new(),
        count => format!("; {count} entries that were given twice count once"),
    };
    let names: Vec<String> = made.iter().map(|(file, _)| named(file)).collect();
    let paths = names.join(", ");
    output::emit(&format!(
        "{paths}: {entries} entries of {learners} learners{repeated}\n"
    ))
}

/// Returns the entries in the format of a file's extension.
fn entries_text(merged: &Merged, file: &Path) -> Result<String> {
    match extension(file).as_str() {
        "csv" => Ok(results::csv(&merged.all)?),
        "json" => {
            // Each learner's results are a list of statements; the file is one list of all.
            let statements: Vec<Value> = merged.all.iter().map(Results::xapi).collect();
            let lists = statements.iter().filter_map(Value::as_array);
            Ok(serde_json::to_string_pretty(
                &lists.flatten().collect::<Vec<_>>(),
            )?)
        }
        _ => {
            let path = named(file);
            bail!("--out {path}: the file must end in .csv, or in .json for xAPI statements")
        }
    }
}

/// Returns the gains in the format of a file's extension.
fn gains_text(merged: &Merged, file: &Path) -> Result<String> {
    let gains = Gains::of(merged);
    let path = named(file);
    ensure!(
        !gains.is_empty(),
        "--gain {path}: no learner has answers in both forms, before and after, and no class has votes in both"
    );
    match extension(file).as_str() {
        "csv" => Ok(gains.csv()?),
        "html" => gain_page::html(&gains),
        _ => bail!("--gain {path}: the file must end in .csv, or in .html for a page"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_build_without_a_window_says_that_the_texts_of_the_window_are_not_searched() {
        let text =
            "---\ntitle: T\nobjective: O\n---\n# S\n```run\nradius: 0.1\nleaf: 6\n```\nWords.\n";
        let with = |leaks: fn(&str, &str) -> Result<Vec<LessonError>, String>| {
            let source = Source {
                name: "t.md".to_owned(),
                lesson: Lesson::read("t", text),
                text: text.to_owned(),
                translations: Vec::new(),
            };
            let window = FromWindow {
                script: |_, _, _, _| Ok(None),
                handout: |_| Err(String::new()),
                lesson_of_session: |_| Err(String::new()),
                leaks,
            };
            reported(source, 1, window).expect("no interruption")
        };
        let without = with(|_, _| Err("this build has no window".to_owned()));
        let warning = "t.md: warning: the texts of the window are not searched for answers: this build has no window";
        assert!(
            without.text.lines().any(|line| line == warning),
            "{}",
            without.text
        );
        assert_eq!(without.object["warnings"], json!([warning]));

        // The control: with a window there is no warning, and what it finds is a fault.
        let silent = with(|_, _| Ok(Vec::new()));
        assert!(!silent.text.contains("warning"), "{}", silent.text);
        let leaking = with(|_, _| Ok(vec![LessonError::new(7, "it tells".to_owned())]));
        assert!(leaking.text.lines().any(|line| line == "t.md:7: it tells"));
        assert_eq!((silent.is_fine, leaking.is_fine), (without.is_fine, false));
    }
}
