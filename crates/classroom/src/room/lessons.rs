//! Lessons: opening them, going from step to step, and giving answers. While a question is open, the window
//! holds the run only up to the question's moment, so that nothing can show, link or export a later moment. Meanwhile the window
//! refuses commands that would make or show another run. In a *trace* the learner predicts one event after the other; a *form*
//! is a test, which takes each answer once and shows nothing about it.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use glam::DVec2;
use tilescope_core::Stage;
use tilescope_debugger::{Direction, Recording};
use tilescope_drawing::camera::Camera;
use tilescope_lessons::package::{CourseSystem, PackageOrder};
use tilescope_lessons::shipped::Shipped;
use tilescope_lessons::{
    Arrival, Draft, DraftCommand, Learner, Lesson, LessonError, MAX_BYTES, Translation, results,
};
use tilescope_session::language::Language;
use tilescope_session::layers::{Layer, Layers};
use tilescope_session::selection::Selection;
use tilescope_session::session::Session;
use tilescope_session::words::sentence;

use crate::graded::FULL_MARKS;
use crate::lesson_picture::layers_named;
use crate::lesson_set::LessonSet;
use crate::lessons::{GivenAnswer, LessonCommand, LessonSource, Lessons, OpenLesson, WantedLesson};
use crate::room::{CanvasView, Classroom, Context, Effect, NewFile, StepView};

/// The name of files with results.
const RESULTS: &str = "tilescope-results";
/// Why a layer cannot be switched on while a question is open.
pub const HIDDEN_LAYER: &str =
    "The lesson shows this layer once its question is answered, or not at all.";
/// The most seeds of practice that are tried for a moment. Lessons are checked: at least half of the seeds have it.
const MAX_MISSED: u64 = 50;

/// Reads a lesson or a translation, if it is not longer than those may be.
fn read_short(path: &Path) -> Result<String, String> {
    // Where the length cannot be found, reading the file says why.
    let length = std::fs::metadata(path).map_or(0, |data| data.len());
    if length > MAX_BYTES as u64 {
        return Err(format!(
            "it has {length} bytes; a lesson has at most {MAX_BYTES}"
        ));
    }
    std::fs::read_to_string(path).map_err(|error| error.to_string())
}

/// Reads a translation; `None` if there is no such file. The error names the file.
fn translation_of_file(path: &Path) -> Option<Result<Translation, String>> {
    if !path.exists() {
        return None;
    }
    let read = read_short(path).and_then(|text| {
        let translation = Translation::read(&text);
        translation.map_err(|error| error.to_string())
    });
    Some(read.map_err(|error| format!("{}: {error}.", path.display())))
}

/// Shows the fault of a translation, if it has one.
fn tell_fault(fault: Option<String>, context: &mut Context) {
    if let Some(fault) = fault {
        context.tell_error(fault);
    }
}

/// Returns whether sh, cmd or PowerShell may read a character as something else within double quotes.
fn is_read_in_quotes(c: char) -> bool {
    // These end the quotes, or begin what a shell puts there: variables, commands, earlier lines. PowerShell takes curly quotes
    // for straight ones. The last sign stands for bytes that are not Unicode, so that the command would name another file.
    let is_read = "\"`$!%\u{201c}\u{201d}\u{201e}\u{fffd}".contains(c);
    // Where a backslash does not divide folders, it escapes what follows. Line breaks are control characters.
    let is_escape = c == '\\' && !std::path::is_separator(c);
    is_read || is_escape || c.is_control()
}

/// Returns when a file was changed last.
fn changed_at(path: &Path) -> Option<std::time::SystemTime> {
    std::fs::metadata(path).ok()?.modified().ok()
}

impl Lessons {
    /// Returns the layers that cannot be switched on at a stage, as the lesson hides them while its question is open.
    #[must_use]
    pub fn hidden_layers(&self, stage: Option<Stage>) -> Layers {
        let mut hidden = Layers::none();
        if let Some(allowed) = self.layers_of_question(stage) {
            let others = Layer::ALL.into_iter().filter(|&layer| !allowed.has(layer));
            others.for_each(|layer| hidden.toggle(layer));
        }
        hidden
    }

    /// Returns the layers that may be shown while a question is open: those of its step. `None` without an open question.
    fn layers_of_question(&self, stage: Option<Stage>) -> Option<Layers> {
        self.veil()?;
        let of_step = self.open.as_ref()?.layers();
        let of_stage = || Layers::of_stage(stage.unwrap_or(Stage::Finish));
        Some(of_step.map_or_else(of_stage, |names| layers_named(&names)))
    }

    /// Returns the chosen layers without those that the open question hides, whichever command has switched them on.
    #[must_use]
    pub fn permitted(&self, chosen: Option<Layers>, stage: Option<Stage>) -> Option<Layers> {
        let Some(allowed) = self.layers_of_question(stage) else {
            return chosen;
        };
        let open = self.open.as_ref();
        let has_own = open.is_some_and(|open| open.layers().is_some());
        match chosen {
            Some(layers) => Some(layers.within(allowed)),
            // In a step that names its layers, the automatic ones are those.
            None => has_own.then_some(allowed),
        }
    }

    /// Adds a selection on the canvas to the answer that is being put together. `at` is the position of a selected sample, in r.
    pub fn draft_from_canvas(&mut self, selection: Selection, at: Option<DVec2>) {
        match selection {
            Selection::Sample(sample) => self.change_draft(DraftCommand::Pick(sample)),
            Selection::Place(place) => self.change_draft(DraftCommand::Place(place.into())),
            Selection::Nothing => return,
        }
        // The question may ask for a place, which can be that of a sample.
        if let Some(at) = at {
            self.change_draft(DraftCommand::Place(at.into()));
        }
    }

    fn change_draft(&mut self, command: DraftCommand) {
        if let Some(open) = &mut self.open
            && open.learner.is_open()
            && let Some(question) = open.learner.question()
        {
            question.change(&mut open.draft, command);
            (open.lacking, open.feedback) = (None, None);
        }
    }
}

impl Classroom {
    /// Applies a command to the lessons.
    pub fn apply(&mut self, command: LessonCommand, context: &mut Context) {
        // The question whether to clear the results stays only until the next command, whatever that is.
        self.lessons.asks_to_clear &= command == LessonCommand::ClearResults;

        match command {
            LessonCommand::ToggleList => {
                // The list leaves no room for the card of the tour.
                context.ask(Effect::EndTour);
                self.lessons.shows_list = !self.lessons.shows_list;
            }
            LessonCommand::Open(name) => self.open_named(name, context),
            LessonCommand::Read(name, text) => {
                self.open_lesson(&name, &text, LessonSource::Text, context);
            }
            LessonCommand::Leave => self.close(context),
            LessonCommand::Step(direction) => self.step_lesson(direction, context),
            LessonCommand::Go(name) => match self.lessons.step_named(&name) {
                Some(index) => self.enter_step(index, context),
                None => context.tell_error(format!("The lesson has no step \"{name}\".")),
            },
            LessonCommand::Draft(command) => self.lessons.change_draft(command),
            LessonCommand::Answer => self.answer_question(context),
            LessonCommand::Hint => {
                if let Some(open) = &mut self.lessons.open {
                    open.hint = open.learner.hint();
                }
            }
            LessonCommand::GiveUp => self.give_up(context),
            LessonCommand::Practise(draw) => self.practise(draw, context),
            LessonCommand::Sure(level) => {
                if let Some(open) = &mut self.lessons.open {
                    open.learner.feel(level);
                }
            }
            LessonCommand::Language(language) => self.speak(language, context),
            LessonCommand::File(path) => self.open_lesson_file(&path, context),
            LessonCommand::SaveResults(format) => self.save_results(&format, context),
            LessonCommand::ClearResults => self.clear_results(),
            // The question whether to clear the results has ended above, and they stay as they are.
            LessonCommand::KeepResults => {}
            LessonCommand::Name(name) => self.lessons.name_learner(&name),
            LessonCommand::Package(system) => self.package(system, context),
            LessonCommand::CopyPackaging => self.copy_packaging(context),
        }
    }

    /// Opens a lesson that comes with the program; on a page, once it is loaded.
    fn open_named(&mut self, name: String, context: &mut Context) {
        match self.lessons.shipped(&name).cloned() {
            Some(shipped) => {
                self.open_lesson(&shipped.name, &shipped.text, LessonSource::Shipped, context);
            }
            None if self.lessons.shelf.is_empty() => {
                self.lessons.wanted = Some(WantedLesson {
                    name,
                    ..WantedLesson::default()
                });
            }
            None => context.tell_error(format!("There is no lesson \"{name}\".")),
        }
    }

    /// Gives up the question. The learner may first be asked whether to, and then the next command does it.
    fn give_up(&mut self, context: &mut Context) {
        let now = self.lessons.now;
        if let Some(open) = &mut self.lessons.open
            && open.learner.give_up(now)
        {
            let (score, given_up) = (0.0, true);
            self.note_answer(score, given_up);
            self.reveal(context);
        }
    }

    fn practise(&mut self, draw: u64, context: &mut Context) {
        // The place is that of another run, but the learner's zoom stays.
        let zoom = self.chosen_camera(&context.canvas);
        if let Some(open) = &mut self.lessons.open
            && open.learner.practise(draw)
        {
            (open.missed, open.zoom) = (0, zoom);
            self.show_step(context);
        }
    }

    /// Opens a lesson, or shows a notice with the fault for which it cannot be read.
    pub(crate) fn open_lesson(
        &mut self,
        name: &str,
        text: &str,
        source: LessonSource,
        context: &mut Context,
    ) {
        let lesson = match Lesson::read(name, text) {
            Ok(lesson) => lesson,
            Err(error) => {
                return context.tell_error(format!("The lesson {name} cannot be read: {error}"));
            }
        };

        let (translation, fault) = self.translation(name, &source);

        let step = match &self.lessons.open {
            // A lesson that is opened again, as a file that has changed, opens at the step that was shown. Only files have their
            // path in the source: the names distinguish other lessons.
            Some(open) if open.source == source && open.learner.lesson().name == name => {
                // If that step is gone, the first one is shown.
                let before = open.learner.step().name.clone();
                lesson.step_named(&before).unwrap_or(0)
            }
            _ => 0,
        };

        // The window carries out requests in order: `Begin` sets its own run aside before the step asks for another one.
        context.ask(Effect::Begin);

        self.lessons.shows_list = false;
        let learner = Learner::new(Arc::new(lesson), translation);
        self.lessons.open = Some(Box::new(OpenLesson {
            text: text.to_owned(),
            ..OpenLesson::new(learner, source)
        }));

        self.enter_step(step, context);
        // The fault of the translation is shown last, as a run that begins removes earlier notices.
        tell_fault(fault, context);
    }

    /// Opens a lesson from a file.
    pub(crate) fn open_lesson_file(&mut self, path: &Path, context: &mut Context) {
        let name = path
            .file_stem()
            .map(|name| name.to_string_lossy().into_owned());

        // Before the file is read, so that a change meanwhile is found afterwards.
        let changed = changed_at(path);

        match read_short(path) {
            Ok(text) => {
                context.ask(Effect::RememberFile(path.to_string_lossy().into_owned()));
                let source = LessonSource::File(path.to_owned());
                // A file that was read has a name.
                self.open_lesson(&name.unwrap_or_default(), &text, source, context);
            }
            Err(error) => context.tell_error(format!("{}: {error}.", path.display())),
        }

        // Also after an error, so that its notice is shown once for each change. The lesson that stays open then may be another
        // one.
        if let Some(open) = &mut self.lessons.open
            && open.source == LessonSource::File(path.to_owned())
        {
            open.changed = changed;
        }
    }

    /// Reads the lesson's file again if it has changed.
    pub fn follow_lesson_file(&mut self, context: &mut Context) {
        let Some(open) = &self.lessons.open else {
            return;
        };

        let LessonSource::File(path) = open.source.clone() else {
            return;
        };

        let changed = changed_at(&path);
        if changed.is_some() && changed != open.changed {
            self.open_lesson_file(&path, context);
        }
    }

    /// Asks for a package of the open lesson, with its German texts if there are any. The package begins in German if
    /// the window is in German and there are German texts, otherwise in English.
    fn package(&self, system: CourseSystem, context: &mut Context) {
        let Some(open) = &self.lessons.open else {
            return context.tell("Open a lesson first.".to_owned());
        };
        let name = &open.learner.lesson().name;
        let german = match &open.source {
            LessonSource::Shipped => self.lessons.shipped(name).map(|own| own.german.to_string()),
            // From the file beside the lesson's, if it can be read. Opening the lesson in German names a fault of it.
            LessonSource::File(path) => read_short(&path.with_extension("de.md")).ok(),
            LessonSource::Text => None,
        };

        let german = german.unwrap_or_default();
        let is_german = self.lessons.language == "de" && !german.is_empty();
        // A package of all steps, without a score to pass with: the command has options for these. Only tests of the
        // lessons that come with the program use the keys.
        context.ask(Effect::Package(Box::new(PackageOrder {
            lesson: Shipped {
                name: name.clone().into(),
                text: open.text.clone().into(),
                german: german.into(),
                keys: "",
            },
            system,
            steps: Vec::new(),
            language: if is_german { "de" } else { "en" }.to_owned(),
            pass: None,
        })));
    }

    /// Copies the command that makes a package of the open lesson, which also takes single steps and a score to pass with, and
    /// says what it is for.
    fn copy_packaging(&self, context: &mut Context) {
        // The menu offers the command only in a lesson.
        let Some(open) = &self.lessons.open else {
            return;
        };
        // A page around or a file may have given the name: nothing in it may end the quotes, be more
        // than a name for a shell, or name another folder.
        let safe = |text: &str| -> String {
            let is_plain = |c: char| c.is_alphanumeric() || "-_. ".contains(c);
            let characters = text.chars();
            characters
                .map(|c| if is_plain(c) { c } else { '_' })
                .collect()
        };
        let name = safe(&open.learner.lesson().name);
        let source = match &open.source {
            LessonSource::Shipped => name.clone(),
            // A shell divides words at blanks, and takes those within quotes as they are. The path stays as it is too, since
            // with other characters it would be that of another file.
            LessonSource::File(path) => {
                let path = path.display().to_string();
                if let Some(sign) = path.chars().find(|&c| is_read_in_quotes(c)) {
                    let sign = sign.escape_debug();
                    return context.tell_error(format!(
                        "The command cannot be copied: the path {path} has the sign {sign}, which means something else \
                         in a terminal. Rename the file or its folder."
                    ));
                }
                format!("\"{path}\"")
            }
            // The program has the text alone. By default the file has the name of the lesson.
            LessonSource::Text => format!("\"{name}.md\""),
        };

        let command = format!("tilescope lesson package {source} --scorm 1.2 --out \"{name}.zip\"");
        context.ask(Effect::Copy(command.clone()));
        context.tell(format!(
            "Copied: {command}. In a terminal it makes a package for course systems; --cmi5 or --scorm 2004 make other kinds."
        ));
    }

    /// Removes the results, once the learner has been asked.
    fn clear_results(&mut self) {
        let lessons = &mut self.lessons;
        if lessons.results.entries.is_empty() && lessons.results.votes.is_empty() {
            lessons.asks_to_clear = false;
            return;
        }

        if lessons.asks_to_clear {
            lessons.results.clear(lessons.now);
            lessons.mark_unstored();
        }

        // The first command asks, the second one clears.
        lessons.asks_to_clear = !lessons.asks_to_clear;
    }

    /// Writes the results, on a page as a download. `wanted` is a format (`csv`, `xapi`, otherwise JSON) or a path, whose ending
    /// gives the format.
    fn save_results(&mut self, wanted: &str, context: &mut Context) {
        let results = &self.lessons.results;

        // Writing to memory does not fail, so that no text is left empty.
        let extension = extension_of(wanted);
        let text = match extension {
            "csv" => results::csv(std::slice::from_ref(results)).unwrap_or_default(),
            "xapi.json" => serde_json::to_string_pretty(&results.xapi()).unwrap_or_default(),
            _ => results.to_json(),
        };

        // A word without a point is a format, and the window chooses the path.
        let path = wanted.contains('.').then(|| PathBuf::from(wanted));

        context.ask(Effect::Save(NewFile {
            stem: RESULTS.to_owned(),
            extension,
            path,
            bytes: text.into_bytes(),
        }));
    }

    /// Returns the translation of a lesson into the chosen language, and its fault if it has one. A lesson that comes with the
    /// program has its own; that of a lesson in a file is the file NAME.LANGUAGE.md beside it. Without a translation, or with a
    /// fault, the texts stay as they are.
    fn translation(&self, name: &str, source: &LessonSource) -> (Arc<Translation>, Option<String>) {
        let tag = self.lessons.language.as_str();
        // The tag may be any text: only that of a known language becomes a part of a path below.
        let language = Language::of(tag);

        let read = match source {
            LessonSource::Shipped => {
                let shipped = self.lessons.shipped(name);
                let text = shipped.and_then(|shipped| shipped.translation(tag));
                // Tests read these translations.
                text.map(|text| Ok(Translation::read(text).unwrap_or_default()))
            }
            LessonSource::File(path) if language.is_some() => {
                translation_of_file(&path.with_extension(format!("{tag}.md")))
            }
            LessonSource::File(_) | LessonSource::Text => None,
        };

        // Texts of any other language are in English, whose decimals follow a point.
        let sign = language.map_or('.', Language::decimal_sign);
        let (read, fault) = match read.transpose() {
            Ok(read) => (read.unwrap_or_default(), None),
            Err(fault) => (Translation::default(), Some(fault)),
        };
        (Arc::new(read.with_decimal_sign(sign)), fault)
    }

    /// Shows texts in another language. The question that is open is asked anew.
    fn speak(&mut self, language: String, context: &mut Context) {
        self.lessons.language = language;
        if let Some(mut open) = self.lessons.open.take() {
            let (lesson, index) = (Arc::clone(open.learner.lesson()), open.learner.index());
            let (translation, fault) = self.translation(&lesson.name, &open.source);
            open.learner = Learner::new(lesson, translation);
            self.lessons.open = Some(open);
            self.enter_step(index, context);
            tell_fault(fault, context);
        }
    }

    /// Closes the lesson, if one is open. A window that had no run before it keeps the run of the step.
    pub fn close(&mut self, context: &mut Context) {
        if let Some(lesson) = self.lessons.open.take() {
            self.lessons.close_list();
            context.ask(Effect::GiveBack(lesson));
        }
    }

    /// Goes to the step before or after the one that is shown, if the learner may.
    fn step_lesson(&mut self, direction: Direction, context: &mut Context) {
        let Some(open) = &mut self.lessons.open else {
            return;
        };

        let index = open.learner.index();
        match direction {
            Direction::Backwards if index > 0 => self.enter_step(index - 1, context),
            Direction::Forwards if open.learner.may_go_on() => self.enter_step(index + 1, context),
            // A step with an open question cannot be left forwards. The message says how to close the question.
            Direction::Forwards if open.learner.is_open() => {
                open.lacking =
                    Some("Answer the question first; or ask for a hint, or give up.".to_owned());
            }
            // Before the first step and after the last one there is no other.
            _ => {}
        }
    }

    /// Goes to the step at an index, and shows it with the step's own camera.
    pub(crate) fn enter_step(&mut self, index: usize, context: &mut Context) {
        if let Some(open) = &mut self.lessons.open {
            open.learner.go(index);
            (open.missed, open.zoom) = (0, None);
            self.show_step(context);
        }
    }

    /// Shows the step, once its run is there; otherwise starts making it.
    pub(crate) fn show_step(&mut self, context: &mut Context) {
        let Some(open) = &mut self.lessons.open else {
            return;
        };
        (open.draft, open.feedback, open.lacking) = (Draft::default(), None, None);
        (open.fault, open.hint) = (None, None);

        let wanted = open.learner.run();
        let run = open.run.clone();

        // Steps of one run share its recording.
        if let Some(run) = run.filter(|run| wanted.is_of(run)) {
            self.arrive_at_step(&run, context);
        } else {
            open.run = None;
            let recipe = LessonSet::recipe_of(&wanted);
            context.ask(Effect::MakeRun(Box::new(recipe)));
        }
    }

    /// Returns the recording of a session if it was made for the lesson.
    #[must_use]
    pub fn made_for_lesson(&self, session: &Session) -> Option<Arc<Recording>> {
        let open = self.lessons.open.as_ref()?;
        // Once the step has its run no other one is taken, and a run with a pattern of its own is not that of its parameters.
        if open.run.is_some() || session.own.is_some() {
            return None;
        }

        // A session of levels has no recording, as nothing happens in it but that samples arrive.
        let made = match session.recording() {
            Some(recording) => Arc::clone(recording),
            None => Arc::new(session.nested.as_ref()?.recording(session.run())?),
        };
        open.learner.run().is_of(&made).then_some(made)
    }

    /// Shows the step, now that its run is made.
    pub fn arrive_at_step(&mut self, run: &Arc<Recording>, context: &mut Context) {
        let now = self.lessons.now;
        let Some(open) = &mut self.lessons.open else {
            return;
        };
        open.run = Some(Arc::clone(run));

        match open.learner.arrive(run, now) {
            Ok(Arrival::Here) => {
                self.show_moment(context);
                // This window may continue a talk of another window. If that talk had reached this step, its camera is
                // set again, and an answer that was revealed is revealed again. This is possible only from here on, as
                // the question is made with the moment.
                self.restore_step(context);
            }
            Ok(Arrival::NoMoment)
                if open.learner.practised().is_some() && open.missed < MAX_MISSED =>
            {
                // In practice any run with the moment will do: another seed is drawn. `missed` grows, so that the draws differ.
                open.missed += 1;
                let draw = open.learner.parameters().seed + open.missed;
                open.learner.practise(draw);
                self.show_step(context);
            }
            // The run has no such moment, or the lesson has a fault.
            arrived => {
                let line = open.learner.step().scene.line;
                let missing = || LessonError::new(line, "the run has no such moment");
                open.fault = Some(arrived.err().unwrap_or_else(missing));
                // A step without its moment shows the start of its run.
                let set = open.set().map(Box::new);
                context.ask(Effect::ShowRun(Arc::clone(run), set, 0));
            }
        }
    }

    /// Shows the moment of the step: up to it if a question is open, otherwise in the whole run.
    pub(crate) fn show_moment(&mut self, context: &mut Context) {
        let Some(open) = &mut self.lessons.open else {
            return;
        };

        let (Some(run), Some(cursor)) = (open.shown_run().cloned(), open.learner.cursor()) else {
            return;
        };

        let set = open.shown_set();
        context.ask(Effect::ShowStep(Box::new(StepView {
            run,
            set,
            plane: open.learner.plane(),
            limit: open.learner.limit(),
            cursor,
            layers: open.layers().map(|names| layers_named(&names)),
            framed: open.camera(),
            zoom: open.zoom.take(),
        })));
    }

    /// Returns the camera, or the one that it flies to, if someone has chosen it since the step was shown; `None` if it is
    /// the step's own, and without a lesson.
    #[must_use]
    pub fn chosen_camera(&self, canvas: &CanvasView) -> Option<Camera> {
        let is_own = match self.lessons.open.as_ref()?.camera() {
            Some(framed) => canvas.framed == Some(framed),
            None => canvas.is_fitted,
        };

        (!is_own).then_some(canvas.destination)
    }

    /// Gives the answer that was put together, if it is complete and a question is open.
    fn answer_question(&mut self, context: &mut Context) {
        let now = self.lessons.now;
        let Some(open) = &mut self.lessons.open else {
            return;
        };

        let Some(question) = open.learner.question().filter(|_| open.learner.is_open()) else {
            return;
        };

        let given = match question.interaction.answer(&open.draft) {
            Ok(answer) => open.learner.answer(&answer, now),
            Err(lacking) => {
                open.lacking = Some(lacking.to_owned());
                return;
            }
        };

        match given {
            Ok(feedback) => {
                // A right answer goes on, in a trace to the next event; in a form any answer is done. Scores are rounded
                // sums, so that full marks begin a little below 1.
                let goes_on = feedback.is_done || feedback.score > FULL_MARKS;
                let score = feedback.score;
                // A form shows nothing about its answers, as this would help with the form after the lessons.
                let shown = Some(feedback).filter(|_| !open.learner.is_taken());
                (open.lacking, open.feedback) = (None, shown);

                let given_up = false;
                self.note_answer(score, given_up);

                if let Some(open) = self.lessons.open.as_mut().filter(|_| goes_on) {
                    // A question that is still open is a trace, whose next event needs a new answer. Otherwise the answer stays
                    // visible.
                    if open.learner.is_open() {
                        open.draft = Draft::default();
                    }
                    self.reveal(context);
                }
            }
            Err(error) => open.lacking = Some(sentence(&error.message)),
        }
    }

    /// Keeps the last answer for pages that embed the window.
    fn note_answer(&mut self, score: f64, given_up: bool) {
        let Some(open) = &self.lessons.open else {
            return;
        };

        let (learner, last) = (&open.learner, &self.lessons.last);
        // The second number is that of the events of a trace that are done.
        let (tries, _) = learner.tries();
        let step = learner.step();
        let gate = step.gate.as_ref();

        self.lessons.last = Some(GivenAnswer {
            number: last.as_ref().map_or(0, |last| last.number) + 1,
            lesson: learner.lesson().name.clone(),
            step: step.name.clone(),
            gate: gate.map_or_else(String::new, |gate| gate.name.clone()),
            seed: learner.parameters().seed,
            score,
            tries,
            // The question of a form stays open after its answer, so that nothing is revealed.
            done: !learner.is_open() || learner.is_taken(),
            given_up,
        });
    }

    /// Takes the results of an answer, and shows the moment after it: that of the deciding event, or the next one of a trace. A form
    /// reveals nothing, and goes to its next step instead.
    fn reveal(&mut self, context: &mut Context) {
        if let Some(open) = &mut self.lessons.open {
            let entries = open.learner.take_entries();
            let is_taken = open.learner.is_taken();
            // An answer in a talk is no result of a learner, as the notes of a talk show the answers.
            if !open.was_presented && !entries.is_empty() {
                self.lessons.results.add(entries);
                self.lessons.mark_unstored();
            }

            if is_taken {
                return self.step_lesson(Direction::Forwards, context);
            }
        }

        // The answer is shown as the learner looked at the question.
        let zoom = self.chosen_camera(&context.canvas);
        if let Some(open) = &mut self.lessons.open {
            open.zoom = zoom;
        }
        self.show_moment(context);
    }
}

/// Returns the extension of results in the format that `wanted` names, alone or as the ending of a path.
fn extension_of(wanted: &str) -> &'static str {
    let asks = |format: &str| wanted == format || wanted.ends_with(&format!(".{format}"));
    if asks("csv") {
        "csv"
    } else if asks("xapi") || asks("xapi.json") {
        "xapi.json"
    } else {
        "json"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_format_of_results_is_its_name_or_the_ending_of_a_path() {
        for (wanted, extension) in [
            ("csv", "csv"),
            ("mine.csv", "csv"),
            ("xapi", "xapi.json"),
            ("mine.xapi.json", "xapi.json"),
            ("json", "json"),
            ("mine.json", "json"),
            // Only a whole extension names a format.
            ("mine.notcsv", "json"),
            ("mine.notxapi", "json"),
        ] {
            assert_eq!(extension_of(wanted), extension, "{wanted}");
        }
    }
}
