//! What the window would lose or stop if it were closed, and the session that the next start offers to reopen.

use serde_json::{Value, json};
use tilescope_session::incoming::NamedBytes;
use tilescope_session::words::counted;

use super::{Form, State};
use crate::files::{FileCommand, LAST_SESSION, LastSession, SaveTask, render};

impl State {
    /// Returns what is lost or ends if the window is closed now, each as a sentence.
    #[must_use]
    pub fn unfinished(&self) -> Vec<String> {
        let mut sentences = Vec::new();
        match self.unsaved_scenes() {
            0 => {}
            1 => sentences.push("1 scene is not saved.".to_owned()),
            count => sentences.push(format!(
                "{} are not saved.",
                counted(count, "scene", "scenes")
            )),
        }
        if self.files.exports.fraction().is_some() {
            sentences.push("An export is running.".to_owned());
        }
        sentences
    }

    /// Returns how many scenes are in no file and in no link that was opened.
    #[must_use]
    pub fn unsaved_scenes(&self) -> usize {
        let scenes = self.runs.first.stops().scenes;
        let saved = &self.files.saved_scenes;
        scenes.iter().filter(|scene| !saved.contains(scene)).count()
    }

    /// Notes that the scenes are in a file, or came from one.
    pub(super) fn scenes_are_saved(&mut self) {
        self.files.saved_scenes = self.runs.first.stops().scenes;
    }

    /// Ends what is open before the window closes: a lesson or the tour gives back what it replaced, an export is cancelled
    /// and removes its unfinished file, and a session that is being saved is saved.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn finish(&mut self) {
        self.give_back();
        if let Some(job) = &self.files.exports.work {
            job.cancel();
        }
        self.in_exports(|exports, _, _, context| exports.settle(context));
        self.settle_files();
    }

    /// Returns the session as the text of a file, from which [`FileCommand::Last`] reopens it: run, moment, view, breakpoints
    /// and scenes. `None` if it is as the program starts, if a lesson or the tour has replaced it, or if it has files that
    /// are not part of it.
    #[must_use]
    pub fn session_to_keep(&self) -> Option<String> {
        if self.borrowed.is_some() || self.window.embedding.is_some() {
            return None;
        }
        let session = self.runs.first.session.as_ref()?;
        let parameters = Form::default().draft.parameters;
        let is_default = session.has_recipe() && session.recipe() == parameters.into();
        if is_default && self.runs.first.stops() == tilescope_debugger::Stops::default() {
            return None;
        }
        if self.save_refusal().is_some() {
            let files = session
                .combination
                .as_ref()
                .map(|combination| combination.files);
            let link = || json!({ "link": self.link().fragment }).to_string();
            return (files.is_none_or(|files| files == 0) && session.own.is_none()).then(link);
        }
        let task = SaveTask {
            name: LAST_SESSION.to_owned(),
            run: self.saved(),
            combination: self.saved_combination(),
        };
        String::from_utf8(render(&task).ok()?.bytes).ok()
    }

    /// Offers to reopen a session that [`Self::session_to_keep`] returned at an earlier use of the program.
    pub fn offer_session(&mut self, text: String) {
        self.files.last_session = Some(LastSession {
            text,
            is_reopened: false,
        });
    }

    /// Returns whether to offer the last session: it was not reopened yet, and nothing was changed since the start.
    #[must_use]
    pub fn offers_session(&self) -> bool {
        let last = self.files.last_session.as_ref();
        let is_new = last.is_some_and(|last| !last.is_reopened);
        let is_free = self.borrowed.is_none() && !self.can_undo() && self.files.filing.is_none();
        is_new && is_free && self.window.embedding.is_none()
    }

    pub(super) fn reopen_last(&mut self) {
        let Some(last) = &mut self.files.last_session else {
            return;
        };
        last.is_reopened = true;
        let text = last.text.clone();
        let read: Option<Value> = serde_json::from_str(&text).ok();
        match read.as_ref().and_then(|read| read["link"].as_str()) {
            Some(link) => self.open_link(link),
            None => {
                let file = NamedBytes::new(LAST_SESSION.to_owned(), text);
                self.apply_to_files(FileCommand::DroppedBytes(vec![file], Vec::new()));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::settled;
    use super::*;
    use crate::command::{Command, FormCommand, TimeCommand};
    use crate::draft::{Choice, Field};
    use crate::export::{ExportCommand, ExportKind};
    use crate::lessons::LessonCommand;
    use crate::scenes::SceneCommand;

    fn apply(state: &mut State, command: Command) {
        state.apply(command);
        state.settle();
    }

    fn type_in(state: &mut State, field: Field, text: &str) {
        let command = FormCommand::Type(field, text.to_owned());
        apply(state, Command::Form(command));
    }

    #[test]
    fn closing_names_scenes_that_no_file_has_and_a_running_export() {
        let folder = tempfile::tempdir().unwrap();
        let mut state = settled();
        assert!(state.unfinished().is_empty());
        apply(&mut state, Command::Scene(SceneCommand::Add));
        assert_eq!(state.unfinished(), ["1 scene is not saved."]);
        apply(&mut state, Command::Scene(SceneCommand::Add));
        assert_eq!(state.unfinished(), ["2 scenes are not saved."]);
        let path = folder.path().join("session.json");
        let path = path.to_string_lossy().into_owned();
        for command in [
            FileCommand::Sheet(crate::files::Purpose::Save),
            FileCommand::Path(path.clone()),
            FileCommand::Go,
        ] {
            apply(&mut state, Command::File(command));
        }
        assert!(state.unfinished().is_empty());
        let caption = SceneCommand::Caption(0, "changed".to_owned());
        apply(&mut state, Command::Scene(caption));
        assert_eq!(state.unfinished(), ["1 scene is not saved."]);
        // Those of a file that is opened are in that file.
        let mut other = settled();
        apply(&mut other, Command::File(FileCommand::Dropped(vec![path])));
        assert_eq!(other.unsaved_scenes(), 0);
        assert_eq!(other.runs.first.stops().scenes.len(), 2);
    }

    #[test]
    fn an_export_that_is_running_when_the_window_closes_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let mut state = settled();
        let path = folder.path().join("run.gif").to_string_lossy().into_owned();
        for command in [
            ExportCommand::Open(ExportKind::Animation),
            ExportCommand::WholeRun(true),
            ExportCommand::Path(path),
            ExportCommand::Write,
            ExportCommand::Close,
        ] {
            state.apply(Command::Export(command));
        }
        assert_eq!(state.unfinished(), ["An export is running."]);
        state.finish();
        assert!(state.unfinished().is_empty());
        let left = std::fs::read_dir(folder.path()).unwrap();
        assert_eq!(left.count(), 0);
    }

    #[test]
    fn the_last_session_comes_back_by_one_command() {
        let mut state = settled();
        // As it starts there is nothing to keep.
        assert_eq!(state.session_to_keep(), None);
        type_in(&mut state, Field::Seed, "7");
        apply(&mut state, Command::Run);
        apply(&mut state, Command::Time(TimeCommand::Jump(700)));
        apply(&mut state, Command::Scene(SceneCommand::Add));
        let text = state.session_to_keep().unwrap();

        let mut next = settled();
        assert!(!next.offers_session());
        next.offer_session(text);
        let as_started = next.runs.first.session.as_ref().unwrap().recipe();
        assert_eq!(as_started.parameters.seed, 1, "nothing is restored unasked");
        assert!(next.offers_session());
        apply(&mut next, Command::File(FileCommand::Last));
        let session = next.runs.first.session.as_ref().unwrap();
        assert_eq!(
            session.recipe(),
            state.runs.first.session.as_ref().unwrap().recipe()
        );
        assert_eq!(next.cursor(), state.cursor());
        assert_eq!(
            next.runs.first.stops().scenes,
            state.runs.first.stops().scenes
        );
        assert!(!next.offers_session());
        // It is no file of the user's, which the next save would replace.
        assert_eq!(next.runs.first.session_path, None);
        assert_eq!(next.unsaved_scenes(), 1);
    }

    #[test]
    fn a_run_without_events_is_kept_as_a_link() {
        let mut state = settled();
        let levels = FormCommand::Choose(Choice::Levels(Some(2)));
        apply(&mut state, Command::Form(levels));
        apply(&mut state, Command::Run);
        assert!(state.save_refusal().is_some());
        let text = state.session_to_keep().unwrap();
        assert!(text.contains("link"), "{text}");
        let mut next = settled();
        next.offer_session(text);
        apply(&mut next, Command::File(FileCommand::Last));
        let recipe = |state: &State| state.runs.first.session.as_ref().unwrap().recipe();
        assert_eq!(recipe(&next), recipe(&state));
    }

    #[test]
    fn work_that_was_begun_ends_the_offer_and_a_lesson_keeps_nothing() {
        let mut state = settled();
        state.offer_session("{}".to_owned());
        type_in(&mut state, Field::Seed, "9");
        assert!(!state.offers_session());
        apply(&mut state, Command::Run);
        assert!(state.session_to_keep().is_some());
        let text = tilescope_lessons::shipped::TEMPLATE.to_owned();
        let read = LessonCommand::Read("template".to_owned(), text);
        apply(&mut state, Command::Lesson(read));
        assert_eq!(state.session_to_keep(), None);
        state.finish();
        assert!(state.session_to_keep().is_some());
    }
}
