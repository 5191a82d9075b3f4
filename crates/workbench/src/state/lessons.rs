//! Lessons in the state: opening them, going from step to step, and giving answers. While a question is open, the window
//! holds the run only up to the question's moment, so that nothing can show, link or export a later moment. [`crate::rules`]
//! says which commands would make or show another run; they are refused meanwhile.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use tilescope_core::Stage;
use tilescope_debugger::{Direction, Recording};
use tilescope_drawing::camera::Camera;
use tilescope_lessons::{Arrival, Learner, Lesson, LessonError, MAX_BYTES, Translation, results};
use tilescope_session::incoming::NamedBytes;
use tilescope_session::language::Language;
use tilescope_session::layers::{Layer, Layers};
use tilescope_session::recipe::Recipe;
use tilescope_session::selection::Selection;
use tilescope_session::session::Session;
use tilescope_session::words::sentence;

use super::{State, Which};
use crate::command::{AppearanceCommand, Command, ViewCommand};
use crate::device::EngineChoice;
use crate::files::{FileCommand, FileForm, Purpose};
use crate::graded::FULL_MARKS;
use crate::lesson_picture::layers_named;
use crate::lessons::{
    AnswerDraft, DraftCommand, GivenAnswer, LessonCommand, LessonSource, OpenLesson, WantedLesson,
};

/// The name of files with results.
const RESULTS: &str = "tilescope-results";
/// Why a layer cannot be switched on while a question is open.
pub const HIDDEN_LAYER: &str =
    "The lesson shows this layer once its question is answered, or not at all.";
/// The most seeds of practice that are tried for a moment.
const MAX_MISSED: u64 = 50;

/// Reads a lesson or a translation, if it is not longer than those may be.
fn read_short(path: &Path) -> Result<String, String> {
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

/// Returns when a file was changed last.
fn changed_at(path: &Path) -> Option<std::time::SystemTime> {
    std::fs::metadata(path).ok()?.modified().ok()
}

impl State {
    /// Returns whether a command is refused because a question is open; a notice says so.
    pub(super) fn refuse_veiled(&mut self, command: &Command) -> bool {
        let refusal = match command {
            Command::Appearance(AppearanceCommand::ToggleLayer(layer))
                if self.hidden_layers().has(*layer) =>
            {
                HIDDEN_LAYER
            }
            command if self.lessons.veil().is_some() && command.rules().reveals => {
                "Answer the question of the lesson first, or close the lesson: this would show what comes next."
            }
            _ => return false,
        };
        self.tell(refusal.to_owned(), false);
        true
    }

    /// Returns the layers that cannot be switched on, as the lesson hides them while its question is open.
    #[must_use]
    pub fn hidden_layers(&self) -> Layers {
        let mut hidden = Layers::none();
        if let Some(allowed) = self.layers_of_question() {
            let others = Layer::ALL.into_iter().filter(|&layer| !allowed.has(layer));
            others.for_each(|layer| hidden.toggle(layer));
        }
        hidden
    }

    /// Returns the layers that may be shown while a question is open: those of its step. `None` without an open question.
    fn layers_of_question(&self) -> Option<Layers> {
        self.lessons.veil()?;
        let of_step = self.lessons.open.as_ref()?.layers();
        let of_stage = || Layers::of_stage(self.current_stage().unwrap_or(Stage::Finish));
        Some(of_step.map_or_else(of_stage, |names| layers_named(&names)))
    }

    /// Switches off the layers that the open question hides, whichever command has switched them on.
    pub(super) fn hide_layers_of_question(&mut self) {
        let Some(allowed) = self.layers_of_question() else {
            return;
        };
        let has_own = self
            .lessons
            .open
            .as_ref()
            .is_some_and(|open| open.layers().is_some());
        let chosen = &mut self.appearance.chosen_layers;
        *chosen = match *chosen {
            Some(layers) => Some(layers.within(allowed)),
            // In a step that names its layers, the automatic ones are those.
            None => has_own.then_some(allowed),
        };
    }

    /// Adds a selection on the canvas to the answer that is being put together.
    pub(super) fn draft_from_canvas(&mut self, command: &Command) {
        let Command::View(Which::First, ViewCommand::Pick(selection)) = command else {
            return;
        };
        let draft = match *selection {
            Selection::Sample(sample) => DraftCommand::Pick(sample),
            Selection::Place(place) => DraftCommand::Place(place.into()),
            Selection::Nothing => return,
        };
        self.change_draft(draft);
        // The question may ask for a place, which can be that of a sample.
        if let Selection::Sample(sample) = *selection
            && self.lessons.open_question().is_some()
            && let Some(session) = &self.runs.first.session
            && (sample as usize) < session.run().samples.points.len()
        {
            let at = session.position(sample);
            self.change_draft(DraftCommand::Place(at.into()));
        }
    }

    fn change_draft(&mut self, command: DraftCommand) {
        if let Some(open) = &mut self.lessons.open
            && open.learner.is_open()
            && let Some(question) = open.learner.question()
        {
            open.draft.apply(command, question);
            (open.lacking, open.feedback) = (None, None);
        }
    }

    pub(super) fn apply_to_lessons(&mut self, command: LessonCommand) {
        // Whoever does something else does not mean to clear the results.
        self.lessons.asks_to_clear &= command == LessonCommand::ClearResults;

        match command {
            LessonCommand::ToggleList => {
                // One thing at a time: the list would leave the tour's card no room.
                if self.is_touring() {
                    self.leave_scene();
                }
                self.lessons.lists = !self.lessons.lists;
            }
            LessonCommand::Open(name) => match self.lessons.shipped(&name).cloned() {
                Some(shipped) => {
                    self.open_lesson(&shipped.name, &shipped.text, LessonSource::Shipped);
                }
                None if self.lessons.shelf.is_empty() => {
                    self.lessons.wanted = Some(WantedLesson {
                        name,
                        ..WantedLesson::default()
                    });
                }
                None => self.tell(format!("There is no lesson \"{name}\"."), true),
            },
            LessonCommand::Read(name, text) => self.open_lesson(&name, &text, LessonSource::Text),
            LessonCommand::Leave => self.leave_lesson(),
            LessonCommand::Step(direction) => self.step_lesson(direction),
            LessonCommand::Go(name) => match self.lessons.step_named(&name) {
                Some(index) => self.enter_step(index),
                None => self.tell(format!("The lesson has no step \"{name}\"."), true),
            },
            LessonCommand::Draft(command) => self.change_draft(command),
            LessonCommand::Answer => self.answer_question(),
            LessonCommand::Hint => {
                if let Some(open) = &mut self.lessons.open {
                    open.hint = open.learner.hint();
                }
            }
            LessonCommand::GiveUp => self.give_up(),
            LessonCommand::Practise(draw) => self.practise(draw),
            LessonCommand::Sure(level) => {
                if let Some(open) = &mut self.lessons.open {
                    open.learner.feel(level);
                }
            }
            LessonCommand::Language(language) => self.speak(language),
            LessonCommand::File(path) => self.open_lesson_file(&path),
            LessonCommand::SaveResults(format) => self.save_results(&format),
            LessonCommand::ClearResults => self.clear_results(),
            // Every other command ends the question whether to clear; this one does nothing else.
            LessonCommand::KeepResults => {}
            LessonCommand::Name(name) => self.lessons.name_learner(&name),
        }
    }

    fn give_up(&mut self) {
        let now = self.lessons.now;
        if let Some(open) = &mut self.lessons.open
            && open.learner.give_up(now)
        {
            self.note_answer(0.0, true);
            self.reveal();
        }
    }

    fn practise(&mut self, draw: u64) {
        // The place is that of another run, but the learner's zoom stays.
        let zoom = self.chosen_camera_of_step();
        if let Some(open) = &mut self.lessons.open
            && open.learner.practise(draw)
        {
            (open.missed, open.zoom) = (0, zoom);
            self.show_step();
        }
    }

    /// Opens a lesson, or shows a notice with the fault for which it cannot be read.
    pub(crate) fn open_lesson(&mut self, name: &str, text: &str, source: LessonSource) {
        let lesson = match Lesson::read(name, text) {
            Ok(lesson) => lesson,
            Err(error) => {
                return self.tell(format!("The lesson {name} cannot be read: {error}"), true);
            }
        };
        let (translation, fault) = self.translation(name, &source);
        let step = match &self.lessons.open {
            // A file that has changed opens at the step that was shown.
            Some(open) if open.source == source && open.learner.lesson().name == name => {
                let before = open.learner.step().name.clone();
                lesson.step_named(&before).unwrap_or(0)
            }
            _ => 0,
        };
        if self.is_touring() {
            self.leave_scene();
        }
        self.borrow_window();
        (self.lessons.lists, self.scene, self.messages.notice) = (false, None, None);
        let learner = Learner::new(Arc::new(lesson), translation);
        self.lessons.open = Some(Box::new(OpenLesson {
            text: text.to_owned(),
            ..OpenLesson::new(learner, source)
        }));
        self.enter_step(step);
        self.tell_fault(fault);
    }

    /// Opens a lesson from a file.
    pub(crate) fn open_lesson_file(&mut self, path: &Path) {
        let name = path
            .file_stem()
            .map(|name| name.to_string_lossy().into_owned());
        let changed = changed_at(path);
        match read_short(path) {
            Ok(text) => {
                self.files.remember_file(&path.to_string_lossy());
                let source = LessonSource::File(path.to_owned());
                self.open_lesson(&name.unwrap_or_default(), &text, source);
            }
            Err(error) => self.tell(format!("{}: {error}.", path.display()), true),
        }
        if let Some(open) = &mut self.lessons.open {
            open.changed = changed;
        }
    }

    /// Reads the lesson's file again if it has changed.
    pub(super) fn follow_lesson_file(&mut self) {
        let Some(open) = &self.lessons.open else {
            return;
        };
        let LessonSource::File(path) = open.source.clone() else {
            return;
        };
        let changed = changed_at(&path);
        if changed.is_some() && changed != open.changed {
            self.open_lesson_file(&path);
        }
    }

    /// Removes the results, once the learner has been asked.
    fn clear_results(&mut self) {
        let lessons = &mut self.lessons;
        if lessons.results.entries.is_empty() {
            lessons.asks_to_clear = false;
            return;
        }
        if lessons.asks_to_clear {
            lessons.results.clear(lessons.now);
            lessons.mark_unstored();
        }
        lessons.asks_to_clear = !lessons.asks_to_clear;
    }

    /// Writes the results; on a page, downloads them.
    fn save_results(&mut self, wanted: &str) {
        let results = &self.lessons.results;
        let (text, extension) = match wanted {
            name if name.ends_with("csv") => (
                results::csv(std::slice::from_ref(results)).unwrap_or_default(),
                "csv",
            ),
            name if name.ends_with("xapi") || name.ends_with(".xapi.json") => (
                serde_json::to_string_pretty(&results.xapi()).unwrap_or_default(),
                "xapi.json",
            ),
            _ => (results.to_json(), "json"),
        };
        let path = wanted.contains('.').then(|| PathBuf::from(wanted));
        self.save_text(RESULTS, extension, path, &text);
    }

    /// Writes a text to a file, by default to a new one beside where the program runs; on a page, downloads it.
    pub(super) fn save_text(
        &mut self,
        stem: &str,
        extension: &str,
        path: Option<PathBuf>,
        text: &str,
    ) {
        if self.files.in_browser() {
            let file = NamedBytes::new(format!("{stem}.{extension}"), text.to_owned());
            self.files.downloads.push(file);
            return;
        }
        let named = |number: usize| match number {
            0 => PathBuf::from(format!("{stem}.{extension}")),
            _ => PathBuf::from(format!("{stem}-{number}.{extension}")),
        };
        let path = path.or_else(|| (0..1_000).map(named).find(|path| !path.exists()));
        self.write_text(&path.unwrap_or_default(), text);
    }

    #[cfg(target_arch = "wasm32")]
    fn write_text(&mut self, _: &Path, _: &str) {}

    #[cfg(not(target_arch = "wasm32"))]
    fn write_text(&mut self, path: &Path, text: &str) {
        match tilescope_formats::write_whole(path, text.as_bytes()) {
            Ok(()) => {
                let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
                let mut notice = super::Notice::new(format!("Saved as {}.", path.display()), false);
                notice.folder = path.parent().map(Path::to_owned);
                self.messages.notice = Some(notice);
            }
            Err(error) => self.tell(sentence(&error.to_string()), true),
        }
    }

    /// Opens the first of some files that is a lesson. Returns whether there is one.
    pub(super) fn open_dropped_lesson(&mut self, command: &FileCommand) -> bool {
        let is_lesson = |name: &str| name.to_lowercase().ends_with(".md");
        match command {
            FileCommand::Dropped(paths) => {
                let path = paths.iter().find(|path| is_lesson(path)).map(PathBuf::from);
                path.inspect(|path| self.open_lesson_file(path)).is_some()
            }
            FileCommand::DroppedBytes(files, _) => {
                let Some(file) = files.iter().find(|file| is_lesson(&file.name)) else {
                    return false;
                };
                let name = file.name.trim_end_matches(".md").to_owned();
                match String::from_utf8(file.bytes.clone()) {
                    Ok(text) => self.open_lesson(&name, &text, LessonSource::Text),
                    Err(_) => self.tell(format!("{}: the file is not text.", file.name), true),
                }
                true
            }
            FileCommand::Go => {
                let opens =
                    |sheet: &&FileForm| sheet.purpose == Purpose::Open && is_lesson(&sheet.path);
                let sheet = self.files.sheet.as_ref().filter(opens);
                let Some(path) = sheet.map(|sheet| PathBuf::from(&sheet.path)) else {
                    return false;
                };
                self.files.sheet = None;
                self.open_lesson_file(&path);
                true
            }
            _ => false,
        }
    }

    /// Returns the translation of a lesson into the chosen language: of one that comes with the program its own, of a file the
    /// file NAME.LANGUAGE.md beside it. Where there is none, or one with a fault, which is returned too, the texts stay as
    /// they are.
    fn translation(&self, name: &str, source: &LessonSource) -> (Arc<Translation>, Option<String>) {
        let tag = self.lessons.language.as_str();
        // Only tags of known languages become names of files.
        let language = Language::of(tag);
        let shipped = self.lessons.shipped(name).filter(|_| tag == "de");
        let read = match source {
            LessonSource::Shipped => {
                shipped.map(|shipped| Ok(Translation::read(&shipped.german).unwrap_or_default()))
            }
            LessonSource::File(path) if language.is_some() => {
                translation_of_file(&path.with_extension(format!("{tag}.md")))
            }
            LessonSource::File(_) | LessonSource::Text => None,
        };

        let sign = language.map_or('.', Language::decimal_sign);
        let (read, fault) = match read.transpose() {
            Ok(read) => (read.unwrap_or_default(), None),
            Err(fault) => (Translation::default(), Some(fault)),
        };
        (Arc::new(read.with_decimal_sign(sign)), fault)
    }

    /// Tells the fault of a translation, once the lesson is open: a run that begins removes earlier notices.
    fn tell_fault(&mut self, fault: Option<String>) {
        if let Some(fault) = fault {
            self.tell(fault, true);
        }
    }

    /// Shows texts in another language. The question that is open is asked anew.
    fn speak(&mut self, language: String) {
        self.lessons.language = language;
        if let Some(mut open) = self.lessons.open.take() {
            let (lesson, index) = (Arc::clone(open.learner.lesson()), open.learner.index());
            let (translation, fault) = self.translation(&lesson.name, &open.source);
            open.learner = Learner::new(lesson, translation);
            self.lessons.open = Some(open);
            self.enter_step(index);
            self.tell_fault(fault);
        }
    }

    /// Closes the lesson. A window that had no run before it keeps the run of the step.
    fn leave_lesson(&mut self) {
        if self.lessons.open.is_some() {
            self.give_back();
        }
    }

    /// Shows the whole run of a lesson that was closed, if it was made, and verifies it.
    pub(super) fn keep_run_of_lesson(&mut self, run: Option<Arc<Recording>>) {
        if let Some(run) = run {
            self.show_run_of_lesson(&run, None);
            self.on(Which::First, |run, context| run.verify(context));
        }
    }

    fn step_lesson(&mut self, direction: Direction) {
        let Some(open) = &mut self.lessons.open else {
            return;
        };
        let index = open.learner.index();
        match direction {
            Direction::Backwards if index > 0 => self.enter_step(index - 1),
            Direction::Forwards if open.learner.may_go_on() => self.enter_step(index + 1),
            Direction::Forwards if open.learner.is_open() => {
                open.lacking =
                    Some("Answer the question first; or ask for a hint, or give up.".to_owned());
            }
            _ => {}
        }
    }

    pub(super) fn enter_step(&mut self, index: usize) {
        if let Some(open) = &mut self.lessons.open {
            open.learner.go(index);
            (open.missed, open.zoom) = (0, None);
            self.show_step();
        }
    }

    /// Shows the step, once its run is there; otherwise starts making it.
    pub(super) fn show_step(&mut self) {
        let Some(open) = &mut self.lessons.open else {
            return;
        };
        (open.draft, open.feedback, open.lacking) = (AnswerDraft::default(), None, None);
        (open.fault, open.hint) = (None, None);
        let parameters = open.learner.parameters();
        let run = open.run.clone();
        if let Some(run) = run.filter(|run| run.run().parameters == parameters) {
            self.arrive_at_step(&run);
        } else {
            open.run = None;
            self.links.arriving = None;
            self.time.playback.stop();
            self.start_sampling(Which::First, Recipe::from(parameters), EngineChoice::Cpu);
        }
    }

    /// Takes a session that was made for the lesson. Returns it if it was made for something else.
    pub(super) fn take_for_lesson(&mut self, session: Session) -> Option<Session> {
        let open = self.lessons.open.as_ref().filter(|open| open.run.is_none());
        let wanted = open.map(|open| open.learner.parameters());
        let recording = session.recording().filter(|recording| {
            wanted == Some(recording.run().parameters) && session.own.is_none()
        });
        let Some(recording) = recording.map(Arc::clone) else {
            return Some(session);
        };
        drop(session);
        self.arrive_at_step(&recording);
        None
    }

    fn arrive_at_step(&mut self, run: &Arc<Recording>) {
        let now = self.lessons.now;
        let Some(open) = &mut self.lessons.open else {
            return;
        };
        open.run = Some(Arc::clone(run));
        match open.learner.arrive(run, now) {
            Ok(Arrival::Here) => {
                self.show_moment();
                self.restore_step();
            }
            Ok(Arrival::NoMoment)
                if open.learner.practised().is_some() && open.missed < MAX_MISSED =>
            {
                open.missed += 1;
                let draw = open.learner.parameters().seed + open.missed;
                open.learner.practise(draw);
                self.show_step();
            }
            arrived => {
                let line = open.learner.step().scene.line;
                let missing = || LessonError::new(line, "the run has no such moment");
                open.fault = Some(arrived.err().unwrap_or_else(missing));
                // The step has no moment, so the start of the run is shown.
                self.show_run_of_lesson(run, Some(0));
            }
        }
    }

    /// Shows the moment of the step: up to it if a question is open, otherwise in the whole run.
    pub(super) fn show_moment(&mut self) {
        let Some(open) = &mut self.lessons.open else {
            return;
        };
        let (Some(run), Some(cursor)) = (open.run.clone(), open.learner.cursor()) else {
            return;
        };
        let (camera, zoom) = (open.camera(), open.zoom.take());
        let limit = open.learner.limit();
        self.appearance.chosen_layers = open.layers().map(|names| layers_named(&names));
        self.show_run_of_lesson(&run, limit);
        self.on(Which::First, |run, context| {
            let before = run.stage;
            run.jump(cursor);
            run.moved(before);
            run.pick(Selection::Nothing, context);
            match (camera, zoom) {
                (Some((center, _)), Some(zoom)) => run.look_from(zoom, center.into(), context),
                (None, Some(zoom)) => run.look_from(zoom, zoom.center, context),
                (Some((center, radii)), None) => run.fly_to(center.into(), radii, context),
                (None, None) => run.fit(context),
            }
        });
    }

    /// Returns the camera, or the one that it flies to, if someone has chosen it since the step was shown; `None` if it is
    /// the step's own.
    pub(super) fn chosen_camera_of_step(&self) -> Option<Camera> {
        let open = self.lessons.open.as_ref()?;
        let run = &self.runs.first;
        let is_own = match open.camera() {
            Some((center, radii)) => run.framed == Some((center.into(), radii)),
            None => run.is_fitted(),
        };
        (!is_own).then(|| run.destination())
    }

    /// Shows a run, whole or up to a cursor. It is not verified, as a verdict would answer questions.
    fn show_run_of_lesson(&mut self, run: &Arc<Recording>, limit: Option<usize>) {
        self.jobs.generation += 1;
        let shown = match limit {
            Some(cursor) => Arc::new(run.until(cursor)),
            None => Arc::clone(run),
        };
        let session = Session::from_recording(shown, self.jobs.generation);
        let same_run = self.runs.first.is_same_run(&session);
        self.time.rest(same_run);
        self.on(Which::First, |run, context| {
            run.show_unverified(session, context);
        });
    }

    fn answer_question(&mut self) {
        let now = self.lessons.now;
        let Some(open) = &mut self.lessons.open else {
            return;
        };
        let Some(question) = open.learner.question().filter(|_| open.learner.is_open()) else {
            return;
        };
        let given = match open.draft.answer(question) {
            Ok(answer) => open.learner.answer(&answer, now),
            Err(lacking) => {
                open.lacking = Some(lacking.to_owned());
                return;
            }
        };
        match given {
            Ok(feedback) => {
                let goes_on = feedback.is_done || feedback.score > FULL_MARKS;
                let score = feedback.score;
                // A form says nothing about its answers: it would help with the form that follows.
                let shown = Some(feedback).filter(|_| !open.learner.is_taken());
                (open.lacking, open.feedback) = (None, shown);
                self.note_answer(score, false);
                if let Some(open) = self.lessons.open.as_mut().filter(|_| goes_on) {
                    // The next event of a trace needs a new answer; any other answer stays visible.
                    if open.learner.is_open() {
                        open.draft = AnswerDraft::default();
                    }
                    self.reveal();
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
        let step = learner.step();
        let gate = step.gate.as_ref();
        self.lessons.last = Some(GivenAnswer {
            number: last.as_ref().map_or(0, |last| last.number) + 1,
            lesson: learner.lesson().name.clone(),
            step: step.name.clone(),
            gate: gate.map_or_else(String::new, |gate| gate.name.clone()),
            seed: learner.parameters().seed,
            score,
            tries: learner.tries().0,
            done: !learner.is_open() || learner.is_taken(),
            given_up,
        });
    }

    /// Shows the moment after an answer: that of the deciding event, or the next one of a trace.
    fn reveal(&mut self) {
        if let Some(open) = &mut self.lessons.open {
            let entries = open.learner.take_entries();
            let is_taken = open.learner.is_taken();
            // The notes of a talk show the answers.
            if !open.was_presented && !entries.is_empty() {
                self.lessons.results.add(entries);
                self.lessons.mark_unstored();
            }
            if is_taken {
                return self.step_lesson(Direction::Forwards);
            }
        }

        // The answer is shown as the learner looked at the question.
        let zoom = self.chosen_camera_of_step();
        if let Some(open) = &mut self.lessons.open {
            open.zoom = zoom;
        }
        self.show_moment();
    }
}

#[cfg(test)]
mod tests {
    use super::super::Verification;
    use super::super::tests::settled;
    use super::*;
    use crate::command::{DebugCommand, FormCommand, LinkCommand, TimeCommand};
    use crate::draft::Field;
    use crate::export::ExportCommand;
    use crate::layout::Panel;
    use crate::lesson_labels::lesson_labels;
    use crate::lessons::MarkKind;
    use crate::scenes::SceneCommand;
    use glam::DVec2;
    use tilescope_lessons::results::Results;
    use tilescope_lessons::shipped::{Loaded, TEMPLATE, to_json};
    use tilescope_lessons::{Answer, Key};
    use tilescope_session::units::position;

    fn lesson(state: &mut State, command: LessonCommand) {
        state.apply(Command::Lesson(command));
        state.settle();
    }

    /// A state with the template's question open.
    fn asked() -> State {
        let mut state = settled();
        lesson(
            &mut state,
            LessonCommand::Read("template".to_owned(), TEMPLATE.to_owned()),
        );
        lesson(&mut state, LessonCommand::Step(Direction::Forwards));
        assert!(state.lessons.open_question().is_some());
        state
    }

    fn whole(state: &State) -> Arc<Recording> {
        Arc::clone(state.lessons.open.as_ref().unwrap().run.as_ref().unwrap())
    }

    /// The option that is right, and one that is not.
    fn options(state: &State) -> [usize; 2] {
        let Key::Choice(right) = state.lessons.open_question().unwrap().key() else {
            panic!("a choice");
        };
        [*right, usize::from(*right == 0)]
    }

    fn choose(state: &mut State, option: usize) {
        lesson(state, LessonCommand::Draft(DraftCommand::Choose(option)));
        lesson(state, LessonCommand::Answer);
    }

    #[test]
    fn a_place_that_a_question_is_about_is_marked() {
        let marked = |mark: &str| {
            let mut state = settled();
            let run = "radius: 0.06\nleaf: 6\nmoment: end of tile\n";
            let gate = "type: number\nask: How many?\nanswer: samples()\n";
            let text = format!(
                "---\ntitle: T\nobjective: O\n---\n# S\n```run\n{run}```\n```gate g\n{gate}{mark}```\n"
            );
            lesson(&mut state, LessonCommand::Read("t".to_owned(), text));
            let marks = state.lessons.open.as_ref().unwrap().marks();
            marks.iter().map(|mark| mark.at.x).collect::<Vec<f64>>()
        };
        let close = |a: Vec<f64>, b: &[f64]| {
            assert_eq!(a.len(), b.len(), "{a:?}");
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9), "{a:?}");
        };
        close(marked("mark: [4.0, 5.0]\n"), &[4.0]);
        close(marked("mark: [[4.0, 5.0], [6.5, 7.0]]\n"), &[4.0, 6.5]);
        // The control: without the field nothing is marked.
        close(marked(""), &[]);
    }

    #[test]
    fn a_question_is_answered_wrongly_then_rightly_and_the_first_try_scores() {
        let mut state = asked();
        let [right, wrong] = options(&state);
        let cursor = state.cursor().unwrap().0;
        choose(&mut state, wrong);
        let open = state.lessons.open.as_ref().unwrap();
        assert!(
            open.learner.is_open()
                && open
                    .feedback
                    .as_ref()
                    .is_some_and(|said| said.sentence.is_some())
        );
        assert!(state.lessons.results.entries.is_empty());
        choose(&mut state, right);
        let open = state.lessons.open.as_ref().unwrap();
        assert!(!open.learner.is_open() && !open.reasons().is_empty());
        // The deciding event is shown, in the whole run.
        let (now, len) = state.cursor().unwrap();
        assert!(now > cursor && len == whole(&state).len());
        let entries = &state.lessons.results.entries;
        assert_eq!(
            (entries.len(), entries[0].score, entries[0].tries),
            (1, 0.0, 2)
        );
        // The same question with another run.
        lesson(&mut state, LessonCommand::Practise(5));
        assert!(state.lessons.open_question().is_some());
        assert_ne!(whole(&state).run().parameters.seed, 1);
    }

    #[test]
    fn results_are_stored_at_the_answer_merged_with_those_of_another_window() {
        let mut state = asked();
        state.lessons.now = 100.0;
        assert!(!state.lessons.has_unstored_results());
        let [right, wrong] = options(&state);
        choose(&mut state, wrong);
        choose(&mut state, right);
        assert!(state.lessons.has_unstored_results());
        // Another window answered another question since this one began.
        let mut other = state.lessons.results.clone();
        other.entries[0].gate = "other".to_owned();
        other.learner = "Ada".to_owned();
        let stored = state.lessons.store_results(Some(&other.to_json()));
        assert!(!stored.unreadable && !state.lessons.has_unstored_results());
        let read = Results::read(&stored.text).unwrap();
        assert_eq!((read.entries.len(), read.learner.as_str()), (2, "Ada"));
        assert_eq!(state.lessons.results, read);
        // A damaged store is reported, and the results of this window stay.
        let stored = state.lessons.store_results(Some("{"));
        assert!(stored.unreadable && Results::read(&stored.text).unwrap() == read);
        // A name that is given here replaces the one of the store.
        lesson(&mut state, LessonCommand::Name("Grace".to_owned()));
        let stored = state.lessons.store_results(Some(&other.to_json()));
        assert!(stored.text.contains("Grace") && !stored.text.contains("Ada"));
    }

    #[test]
    fn a_lesson_of_a_file_has_the_translation_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mine.md");
        let beside = folder.path().join("mine.de.md");
        let text = "---\ntitle: The title\nobjective: O\n---\n# S\n```run\nradius: 0.06\nleaf: 6\nmoment: end of tile\n```\nWords.\n";
        std::fs::write(&path, text).unwrap();
        let mut state = settled();
        let title = |state: &State| {
            let learner = &state.lessons.open.as_ref().unwrap().learner;
            learner.words(&learner.lesson().title)
        };
        let speak = |state: &mut State, tag: &str| {
            lesson(state, LessonCommand::Language(tag.to_owned()));
        };
        let open = |state: &mut State| lesson(state, LessonCommand::File(path.clone()));

        // Without a translation, and in a language that is none, the texts stay as they are.
        speak(&mut state, "de");
        open(&mut state);
        assert_eq!(title(&state), "The title");
        assert!(state.messages.notice.is_none());
        std::fs::write(&beside, "> The title\n\nDer Titel\n").unwrap();
        speak(&mut state, "de");
        assert_eq!(title(&state), "Der Titel");
        speak(&mut state, "en");
        assert_eq!(title(&state), "The title");
        speak(&mut state, "../mine.de");
        assert_eq!(title(&state), "The title");

        // A fault is named, and the lesson opens as it was written.
        std::fs::write(&beside, "Der Titel\n").unwrap();
        speak(&mut state, "de");
        open(&mut state);
        assert_eq!(title(&state), "The title");
        let notice = state.messages.notice.as_ref().expect("a notice");
        assert!(notice.text.contains("mine.de.md"), "{}", notice.text);
    }

    #[test]
    fn a_page_loads_the_words_of_a_language_when_a_lesson_is_open() {
        let mut state = settled();
        state.lessons.shelf.clear();
        let read = |state: &mut State| {
            let text = TEMPLATE.to_owned();
            lesson(state, LessonCommand::Read("t".to_owned(), text));
        };
        read(&mut state);
        assert!(!state.wants_lessons(), "English has no table");

        lesson(&mut state, LessonCommand::Language("loaded".to_owned()));
        assert!(state.wants_lessons());
        assert_eq!(state.in_words("Play"), "Play");
        let loaded = Loaded {
            lessons: tilescope_lessons::shipped::lessons(),
            tables: [(
                "loaded".to_owned(),
                "1,234.5%\n    1.234,5 %\nPlay\n    Los\n".to_owned(),
            )]
            .into(),
        };
        state.take_lessons(Ok(&to_json(&loaded)));
        state.settle();
        assert!(!state.wants_lessons() && !state.lessons.shelf.is_empty());
        assert_eq!(state.in_words("Play"), "Los");
        let language = Language::of("loaded").expect("the table");
        assert_eq!(language.decimal_sign(), ',');

        // A table with a fault is named, as other faults of what was loaded.
        let faulty = to_json(&Loaded {
            tables: [("faulty".to_owned(), "Play\n".to_owned())].into(),
            ..loaded
        });
        state.take_lessons(Ok(&faulty));
        let notice = state.messages.notice.as_ref().expect("a notice");
        assert!(notice.text.contains("line 1"), "{}", notice.text);
    }

    #[test]
    fn an_answer_that_was_given_up_is_told_and_not_asked_for_again() {
        let mut state = settled();
        let text = "---\ntitle: T\nobjective: O\n---\n# S\n```run\nradius: 0.06\nleaf: 6\nmoment: end of tile\n```\n```gate g\ntype: place\nask: Where?\nright: [4.0, 4.0]\ncandidate: [12.0, 12.0]\n```\n";
        let read = LessonCommand::Read("t".to_owned(), text.to_owned());
        lesson(&mut state, read);
        let labels = lesson_labels("en");
        let told = |state: &State| {
            let open = state.lessons.open.as_ref().unwrap();
            (open.verdict("en"), open.told_answer(labels))
        };
        let wrong = DraftCommand::Place([12.0, 12.0]);
        lesson(&mut state, LessonCommand::Draft(wrong));
        lesson(&mut state, LessonCommand::Answer);
        assert_eq!(told(&state), (Some(labels.wrong), None));
        for _ in 0..2 {
            lesson(&mut state, LessonCommand::GiveUp);
        }
        assert_eq!(told(&state), (None, Some(labels.place_marked.to_owned())));
        let marks = state.lessons.open.as_ref().unwrap().marks();
        let right = marks.iter().find(|mark| mark.kind == MarkKind::Right);
        assert!((right.expect("a mark").at.x - 4.0).abs() < 1e-9);
    }

    #[test]
    fn clearing_the_results_is_asked_once_more() {
        let mut state = asked();
        let [right, _] = options(&state);
        choose(&mut state, right);
        let _ = state.lessons.store_results(None);
        lesson(&mut state, LessonCommand::ClearResults);
        assert!(state.lessons.asks_to_clear && state.lessons.results.entries.len() == 1);
        // Keeping them, or any other action in the lessons, is a no.
        for no in [LessonCommand::KeepResults, LessonCommand::ToggleList] {
            lesson(&mut state, no);
            assert!(!state.lessons.asks_to_clear && !state.lessons.has_unstored_results());
            lesson(&mut state, LessonCommand::ClearResults);
        }
        let before = state.lessons.results.to_json();
        lesson(&mut state, LessonCommand::ClearResults);
        assert!(state.lessons.results.entries.is_empty() && !state.lessons.asks_to_clear);
        // What another window still has does not come back.
        let stored = state.lessons.store_results(Some(&before));
        assert!(Results::read(&stored.text).unwrap().entries.is_empty());
    }

    #[test]
    fn a_verdict_that_the_sentence_begins_with_is_not_said_twice() {
        let mut state = asked();
        let [right, _] = options(&state);
        choose(&mut state, right);
        let open = state.lessons.open.as_mut().unwrap();
        for (sentence, verdict) in [
            (None, Some("Right.")),
            (Some("Right: it has the smaller number."), None),
            (Some("Right."), None),
            (Some("Rightmost is 12."), Some("Right.")),
            (Some("It is so."), Some("Right.")),
        ] {
            open.feedback.as_mut().unwrap().sentence = sentence.map(str::to_owned);
            assert_eq!(open.verdict("en"), verdict, "{sentence:?}");
        }
    }

    #[test]
    fn giving_up_is_asked_once_more() {
        let mut state = asked();
        lesson(&mut state, LessonCommand::Step(Direction::Forwards));
        lesson(&mut state, LessonCommand::GiveUp);
        assert!(state.lessons.open_question().is_some());
        lesson(&mut state, LessonCommand::GiveUp);
        assert!(state.lessons.open_question().is_none());
        assert!(state.lessons.results.entries[0].given_up);
        lesson(&mut state, LessonCommand::Leave);
        assert!(state.lessons.open.is_none() && state.verdict().is_some());
    }

    /// Returns everything that the state contains and shows of the run, as text.
    fn told(state: &State) -> String {
        let run = &state.runs.first;
        let session = run.session.as_ref().unwrap();
        let debugger = run.debugger.as_ref().unwrap();
        let recording = debugger.recording();
        let events =
            (0..recording.len()).map(|event| tilescope_debugger::sentence(recording, event));
        // The JSON for pages, without the parameters of the run.
        let mut sent = state.to_json();
        sent["parameters"] = serde_json::Value::Null;
        format!(
            "{sent} {:?} {:?} {:?} {:?} {:?} {:?} {:?}",
            state.announcement(),
            state.link(),
            session.summary,
            session.stages,
            run.moment_texts(),
            debugger.watch_values(),
            events.collect::<Vec<String>>(),
        )
    }

    #[test]
    fn two_runs_that_differ_only_later_tell_the_same_while_the_question_is_open() {
        // Up to the end of elimination, runs with the two searches are the same; afterwards they are not.
        let text = |search: &str| {
            let run = "radius: 0.03\nleaf: 8\nmoment: end of eliminate\n";
            let gate = "type: number\nask: How many samples will be inserted?\nanswer: count(\"insert\")\n";
            format!(
                "---\ntitle: T\nobjective: O\n---\n# S\n```run\nsearch: {search}\n{run}```\n```gate g\n{gate}```\n"
            )
        };
        let of = |search: &str| {
            let mut state = settled();
            lesson(
                &mut state,
                LessonCommand::Read("t".to_owned(), text(search)),
            );
            for watch in ["kind", "a", "count", "verdict", "place_x", "event"] {
                state.apply(Command::Debug(DebugCommand::Watch(watch.to_owned())));
            }
            state
        };
        let (a, b) = (of("complete"), of("two-radii"));
        assert_ne!(whole(&a).run().result.len(), whole(&b).run().result.len());
        assert_eq!(told(&a), told(&b));
        let [cursor, len] = a.cursor().map(|(cursor, len)| [cursor, len]).unwrap();
        assert_eq!(cursor, len);
        // The control: once both have given up, they tell different things.
        let revealed = |mut state: State| {
            lesson(&mut state, LessonCommand::GiveUp);
            lesson(&mut state, LessonCommand::GiveUp);
            told(&state)
        };
        assert_ne!(revealed(a), revealed(b));
    }

    #[test]
    fn the_camera_of_a_trace_follows_from_event_to_event() {
        let mut state = settled();
        lesson(&mut state, LessonCommand::Open("survivors".to_owned()));
        let open = state.lessons.open.as_ref().unwrap();
        let last = open.learner.lesson().steps.last().unwrap().name.clone();
        lesson(&mut state, LessonCommand::Go(last));
        let mut places = Vec::new();
        while let Some(question) = state.lessons.open_question() {
            let open = state.lessons.open.as_ref().unwrap();
            let (_, traced) = open.learner.tries();
            let asked = question.named(traced)[0];
            let point = open.run.as_ref().unwrap().point(asked).unwrap();
            let (place, _) = open.camera().expect("a place");
            assert!((position(point) - DVec2::from(place)).length() < 1e-6);
            places.push(place);
            let Answer::Choice(right) = question.right_answer(traced) else {
                panic!("a choice");
            };
            choose(&mut state, right);
        }
        // The control: it has moved.
        assert_eq!(places.len(), 4);
        let [first, second, ..] = places[..] else {
            panic!("four places");
        };
        assert!(DVec2::from(first).distance(second.into()) > 1e-3);
    }

    #[test]
    fn the_spectrum_that_a_number_is_read_from_appears_after_the_answer() {
        let text = "---\ntitle: T\nobjective: O\n---\n# S\n```run\nradius: 0.03\nleaf: 8\nmoment: end\n```\n```gate g\n\
                    type: number\nask: Where is the peak?\nanswer: measure(\"peak\")\ncurve: \"set\"\n```\n";
        let mut state = settled();
        lesson(
            &mut state,
            LessonCommand::Read("t".to_owned(), text.to_owned()),
        );
        let curves = |state: &State| {
            let shown = state.lesson_json()["question"]["curves"].clone();
            shown.as_array().map(Vec::len)
        };
        assert_eq!(curves(&state), Some(0));
        lesson(&mut state, LessonCommand::GiveUp);
        lesson(&mut state, LessonCommand::GiveUp);
        assert_eq!(curves(&state), Some(1));
    }

    #[test]
    fn no_event_panel_time_line_watch_history_or_search_goes_past_the_question() {
        let mut state = asked();
        let cursor = state.cursor().unwrap();
        assert_eq!(cursor.0, cursor.1);
        for command in [
            TimeCommand::StepForward,
            TimeCommand::LastStage,
            TimeCommand::Jump(usize::MAX),
            TimeCommand::Jump(cursor.1),
            TimeCommand::TogglePlay,
        ] {
            state.apply(Command::Time(command));
            state.advance(5.0);
            state.settle();
            // Playing from the end begins at the start, and ends at the question.
            let (at, len) = state.cursor().unwrap();
            assert!(at <= len && len == cursor.1);
        }
        state.apply(Command::Time(TimeCommand::Jump(cursor.1)));
        assert_eq!(state.cursor(), Some(cursor));
        let run = &state.runs.first;
        let debugger = run.debugger.as_ref().unwrap();
        let next_names = ["kind", "a", "b", "line", "verdict"];
        for name in next_names {
            assert_eq!(debugger.evaluate(name).unwrap(), "none", "{name}");
        }
        let recording = debugger.recording();
        assert!(recording.event(cursor.0).is_none());
        for sample in 0..recording.run().samples.len() as u32 {
            assert!(
                recording
                    .events_of(sample)
                    .iter()
                    .all(|&event| (event as usize) < cursor.0)
            );
        }
        assert!(run.session.as_ref().unwrap().outline.is_some());
        assert!(
            state.verdict().is_none()
                && matches!(state.runs.first.verification, Verification::Nothing)
        );
    }

    #[test]
    fn no_other_run_export_file_or_comparison_is_made_meanwhile() {
        let mut state = asked();
        let generation = state.runs.first.session.as_ref().unwrap().generation;
        let all = [
            Command::Run,
            Command::Undo,
            Command::OpenPasses,
            Command::Form(FormCommand::Type(Field::Seed, "5".to_owned())),
            Command::Export(ExportCommand::Open(crate::export::ExportKind::Result)),
            Command::File(FileCommand::Sheet(Purpose::Save)),
            Command::Scene(SceneCommand::Tour),
        ];
        for command in all {
            assert!(command.rules().reveals);
            state.messages.notice = None;
            state.apply(command.clone());
            state.settle();
            let notice = state
                .messages
                .notice
                .as_ref()
                .map(|notice| notice.text.clone())
                .unwrap_or_default();
            assert!(
                notice.contains("Answer the question"),
                "{command:?}: {notice}"
            );
            assert_eq!(
                state.runs.first.session.as_ref().unwrap().generation,
                generation
            );
            assert!(!state.files.has_sheet() && state.lessons.open_question().is_some());
        }
    }

    #[test]
    fn a_form_takes_one_answer_to_each_question_and_says_nothing_about_it() {
        let mut state = settled();
        lesson(&mut state, LessonCommand::Open("before".to_owned()));
        lesson(&mut state, LessonCommand::Step(Direction::Forwards));
        let gate = |state: &State| {
            let gate = state.lessons.learner()?.step().gate.as_ref()?;
            Some(gate.name.clone())
        };
        let mut scores = Vec::new();
        for index in 0..12 {
            let name = gate(&state).expect("a question");
            let [right, wrong] = options(&state);
            if index == 2 {
                // Giving up takes two calls, and goes on too.
                lesson(&mut state, LessonCommand::GiveUp);
                assert_eq!(gate(&state).as_ref(), Some(&name));
                lesson(&mut state, LessonCommand::GiveUp);
            } else {
                choose(&mut state, if index % 2 == 0 { right } else { wrong });
            }
            assert_ne!(gate(&state), Some(name.clone()), "it goes on");
            let open = state.lessons.open.as_ref().unwrap();
            assert!(open.feedback.is_none() && open.verdict("en").is_none());

            let entry = state.lessons.results.entries.last().unwrap();
            assert_eq!(
                (entry.gate.as_str(), entry.tries),
                (name.as_str(), u32::from(index != 2))
            );
            assert!(entry.form.is_some() && entry.concept.is_some());
            scores.push(entry.score);
        }
        assert_eq!(scores[..4], [1.0, 0.0, 0.0, 0.0]);

        // Neither the steps nor a card at the end tell which answers were right.
        let told = state.ask(r#"{"do": "lesson", "go": "back"}"#);
        assert!(told.contains("\"ok\":true"), "{told}");
        assert!(!told.contains("\"score\":1"), "{told}");
        assert_eq!(state.lessons.outcome(), None);
        assert!(gate(&state).is_some() && state.lessons.open_question().is_some());
    }

    #[test]
    fn layers_that_the_question_hides_cannot_be_shown_until_it_is_answered() {
        let mut state = asked();
        let shown = |state: &State| state.appearance.layers(state.current_stage());
        let of_step = shown(&state);
        let hidden = Layer::ALL.into_iter().filter(|layer| !of_step.has(*layer));
        let hidden: Vec<Layer> = hidden.collect();
        assert!(hidden.contains(&Layer::Gaps), "{hidden:?}");
        for &layer in &hidden {
            state.messages.notice = None;
            state.apply(Command::Appearance(AppearanceCommand::ToggleLayer(layer)));
            assert_eq!(shown(&state), of_step, "{layer:?}");
            let notice = state.messages.notice.as_ref().expect("a notice");
            assert_eq!(notice.text, HIDDEN_LAYER);
        }

        // The automatic layers are those of the step.
        state.apply(Command::Appearance(AppearanceCommand::AutomaticLayers));
        assert_eq!(shown(&state), of_step);

        // A page asks for layers by name, and a scene of the user's own has others: only those of the step are shown.
        let answer = state.ask(r#"{"do": "view", "layers": ["gaps", "samples"]}"#);
        assert_eq!(
            shown(&state).iter().collect::<Vec<_>>(),
            [Layer::Samples],
            "{answer}"
        );
        state.appearance.chosen_layers = Some(Layers::default());
        state.apply(Command::Scene(SceneCommand::Add));
        assert_eq!(shown(&state), Layers::default().within(of_step));

        // What the step shows can be switched off and on again.
        let own = of_step.iter().next().expect("a layer");
        state.apply(Command::Appearance(AppearanceCommand::AutomaticLayers));
        for is_on in [false, true] {
            state.apply(Command::Appearance(AppearanceCommand::ToggleLayer(own)));
            assert_eq!(shown(&state).has(own), is_on);
        }

        // The control: the answer frees all layers.
        let [right, _] = options(&state);
        choose(&mut state, right);
        assert_eq!(state.hidden_layers(), Layers::none());
        state.apply(Command::Appearance(AppearanceCommand::ToggleLayer(
            Layer::Voronoi,
        )));
        assert!(shown(&state).has(Layer::Voronoi));
    }

    #[test]
    fn the_answer_and_another_run_are_shown_at_the_learners_zoom() {
        let mut state = asked();
        let still = AppearanceCommand::ToggleReducedMotion;
        state.apply(Command::Appearance(still));
        let own = state.runs.first.camera;
        let at = state.runs.first.viewport.center();
        let zoom = Command::View(Which::First, ViewCommand::Zoom(at, 1.25));
        state.apply(zoom);
        let zoomed = state.runs.first.camera;
        assert!(zoomed.scale > own.scale);
        let [right, _] = options(&state);
        choose(&mut state, right);
        assert_eq!(state.runs.first.camera, zoomed);
        lesson(&mut state, LessonCommand::Practise(5));
        assert!(state.lessons.open_question().is_some());
        let scale = state.runs.first.camera.scale;
        assert!((scale - zoomed.scale).abs() < 1e-9, "{scale}");

        // A place that the learner has turned away from comes back into view, at the same scale.
        let away = ViewCommand::Pan(emath::vec2(5_000.0, 0.0));
        state.apply(Command::View(Which::First, away));
        let seen = |state: &State| {
            let (run, open) = (&state.runs.first, state.lessons.open.as_ref().unwrap());
            let (place, _) = open.camera().expect("a place");
            let at = run.camera.screen_from_domain(run.viewport, place);
            run.viewport.contains(at)
        };
        assert!(!seen(&state));
        let [right, _] = options(&state);
        choose(&mut state, right);
        assert!(seen(&state));
        let scale = state.runs.first.camera.scale;
        assert!((scale - zoomed.scale).abs() < 1e-9, "{scale}");

        // The control: another step has its own camera.
        assert!(state.chosen_camera_of_step().is_some());
        lesson(&mut state, LessonCommand::Step(Direction::Backwards));
        assert_eq!(state.chosen_camera_of_step(), None);
    }

    #[test]
    fn links_name_the_moment_of_the_question_at_most() {
        let mut state = asked();
        let (cursor, _) = state.cursor().unwrap();
        state.apply(Command::Link(LinkCommand::Copy));
        let link = state.links.copied.clone().unwrap();
        let names_run = |link: &str| {
            ["at=", "seed=", "radius=", "leaf="]
                .iter()
                .any(|key| link.contains(key))
        };
        assert!(!names_run(&link), "{link}");
        lesson(&mut state, LessonCommand::Leave);
        state.apply(Command::Time(TimeCommand::Jump(cursor)));
        state.apply(Command::Link(LinkCommand::Copy));
        let link = state.links.copied.clone().unwrap();
        assert!(names_run(&link), "{link}");
    }

    #[test]
    fn faults_of_a_lesson_are_named_with_their_line() {
        let mut state = settled();
        let text = TEMPLATE.replace("type: choice", "type: choise");
        lesson(&mut state, LessonCommand::Read("broken".to_owned(), text));
        let notice = &state.messages.notice.as_ref().unwrap().text;
        assert!(
            notice.contains("line 3") && notice.contains("\"choice\""),
            "{notice}"
        );
        assert!(state.lessons.open.is_none());
        // A moment that the run does not have.
        let text = TEMPLATE.replace("where: (a < b) == odd_run()", "where: a == 123456");
        lesson(&mut state, LessonCommand::Read("broken".to_owned(), text));
        lesson(&mut state, LessonCommand::Step(Direction::Forwards));
        assert!(state.lessons.open.as_ref().unwrap().fault.is_some());
    }

    #[test]
    fn answers_are_put_together_on_the_canvas_and_from_the_list() {
        let mut state = settled();
        let text = "---\ntitle: T\nobjective: O\n---\n# S\n```run\nradius: 0.08\nleaf: 6\nmoment: end of tile\n```\n```gate g\ntype: pick\nseveral: yes\nask: Which?\ncandidates: far(s, 4.0, 4.0) < 2.5\nanswer: conflicts_of(s) > 0\n```\n";
        lesson(
            &mut state,
            LessonCommand::Read("t".to_owned(), text.to_owned()),
        );
        let question = state.lessons.open_question().unwrap().clone();
        let (Answer::Pick(right), tilescope_lessons::Form::Pick { candidates, .. }) =
            (question.right_answer(0), &question.form)
        else {
            panic!("samples are picked");
        };
        let first = right[0];
        state.apply(Command::View(
            Which::First,
            ViewCommand::Pick(Selection::Sample(first)),
        ));
        assert_eq!(state.lessons.open.as_ref().unwrap().draft.samples, [first]);
        // The inspector tells about the sample, so a click that answers leaves it closed.
        let inspect = Command::View(Which::First, ViewCommand::Inspect);
        let has_inspector = |state: &State| state.window.shows(Panel::Inspector);
        state.apply(inspect.clone());
        assert!(!has_inspector(&state));
        for sample in &right[1..] {
            let index = candidates.iter().position(|other| other == sample).unwrap();
            lesson(
                &mut state,
                LessonCommand::Draft(DraftCommand::Choose(index)),
            );
        }
        lesson(&mut state, LessonCommand::Answer);
        assert!(state.lessons.open_question().is_none());
        assert!((state.lessons.results.entries[0].score - 1.0).abs() < 1e-9);
        let click = ViewCommand::Pick(Selection::Sample(first));
        state.apply(Command::View(Which::First, click));
        state.apply(inspect);
        assert!(has_inspector(&state));
    }
}
