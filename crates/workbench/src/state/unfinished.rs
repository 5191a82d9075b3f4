//! What the window would lose or stop if it were closed.

use tilescope_session::words::counted;

use super::{FileState, Form, RunView};

impl FileState {
    /// Returns the work that is lost or ends if the window is closed now, each piece as a sentence.
    #[must_use]
    pub fn unfinished(&self, run: &RunView, form: &Form) -> Vec<String> {
        let mut sentences = Vec::new();
        match self.unsaved_scenes(run) {
            0 => {}
            1 => sentences.push("1 scene is not saved.".to_owned()),
            count => sentences.push(format!(
                "{} are not saved.",
                counted(count, "scene", "scenes")
            )),
        }
        if form.has_unsaved_radii() {
            sentences.push("The painted radii are not saved.".to_owned());
        }
        if self.exports.fraction().is_some() {
            sentences.push("An export is running.".to_owned());
        }
        sentences
    }

    /// Returns how many scenes are in no file and in no link that was opened.
    #[must_use]
    pub fn unsaved_scenes(&self, run: &RunView) -> usize {
        let scenes = run.stops().scenes;
        let saved = &self.saved_scenes;
        scenes.iter().filter(|scene| !saved.contains(scene)).count()
    }

    /// Notes that the scenes are in a file, or came from one.
    pub(super) fn scenes_are_saved(&mut self, run: &RunView) {
        self.saved_scenes = run.stops().scenes;
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::settled;
    use super::super::{Settings, State, session_to_keep};
    use crate::command::{Command, FormCommand, TimeCommand};
    use crate::draft::Choice;
    use crate::export::{ExportCommand, ExportKind};
    use crate::files::FileCommand;
    use crate::scenes::SceneCommand;
    use tilescope_classroom::lessons::LessonCommand;
    use tilescope_core::Parameter;

    fn apply(state: &mut State, command: Command) {
        state.apply(command);
        state.settle();
    }

    fn type_in(state: &mut State, field: Parameter, text: &str) {
        let command = FormCommand::Type(field, text.to_owned());
        apply(state, Command::Form(command));
    }

    #[test]
    fn closing_names_scenes_that_no_file_has_and_a_running_export() {
        let folder = tempfile::tempdir().unwrap();
        let mut state = settled();
        assert!(
            state
                .files
                .unfinished(&state.runs.first, &state.form)
                .is_empty()
        );
        apply(&mut state, Command::Scene(SceneCommand::Add));
        assert_eq!(
            state.files.unfinished(&state.runs.first, &state.form),
            ["1 scene is not saved."]
        );
        apply(&mut state, Command::Scene(SceneCommand::Add));
        assert_eq!(
            state.files.unfinished(&state.runs.first, &state.form),
            ["2 scenes are not saved."]
        );
        let path = folder.path().join("session.json");
        let path = path.to_string_lossy().into_owned();
        for command in [
            FileCommand::Sheet(crate::files::Purpose::Save),
            FileCommand::Path(path.clone()),
            FileCommand::Go,
        ] {
            apply(&mut state, Command::File(command));
        }
        assert!(
            state
                .files
                .unfinished(&state.runs.first, &state.form)
                .is_empty()
        );
        let caption = SceneCommand::Caption(0, "changed".to_owned());
        apply(&mut state, Command::Scene(caption));
        assert_eq!(
            state.files.unfinished(&state.runs.first, &state.form),
            ["1 scene is not saved."]
        );
        // Those of a file that is opened are in that file.
        let mut other = settled();
        apply(&mut other, Command::File(FileCommand::Dropped(vec![path])));
        assert_eq!(other.files.unsaved_scenes(&other.runs.first), 0);
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
        assert_eq!(
            state.files.unfinished(&state.runs.first, &state.form),
            ["An export is running."]
        );
        state.finish();
        assert!(
            state
                .files
                .unfinished(&state.runs.first, &state.form)
                .is_empty()
        );
        let left = std::fs::read_dir(folder.path()).unwrap();
        assert_eq!(left.count(), 0);
    }

    #[test]
    fn the_last_session_comes_back_by_one_command() {
        let mut state = settled();
        // As it starts there is nothing to keep.
        assert_eq!(session_to_keep(&state), None);
        type_in(&mut state, Parameter::Seed, "7");
        apply(&mut state, Command::Run);
        apply(&mut state, Command::Time(TimeCommand::Jump(700)));
        apply(&mut state, Command::Scene(SceneCommand::Add));
        let text = session_to_keep(&state).unwrap();

        let mut next = settled();
        assert!(!next.files.offers_session(&next.past, &next.window));
        next.restore(Settings {
            last_session: Some(text),
            ..Settings::default()
        });
        let as_started = next.runs.first.session.as_ref().unwrap().recipe();
        assert_eq!(as_started.parameters.seed, 1, "nothing is restored unasked");
        assert!(next.files.offers_session(&next.past, &next.window));
        apply(&mut next, Command::File(FileCommand::Last));
        let session = next.runs.first.session.as_ref().unwrap();
        assert_eq!(
            session.recipe(),
            state.runs.first.session.as_ref().unwrap().recipe()
        );
        assert_eq!(next.runs.first.cursor(), state.runs.first.cursor());
        assert_eq!(
            next.runs.first.stops().scenes,
            state.runs.first.stops().scenes
        );
        assert!(!next.files.offers_session(&next.past, &next.window));
        // It is no file of the user's, which the next save would replace.
        assert_eq!(next.runs.first.session_path, None);
        assert_eq!(next.files.unsaved_scenes(&next.runs.first), 1);
    }

    #[test]
    fn a_run_without_events_is_kept_as_a_link() {
        let mut state = settled();
        let levels = FormCommand::Choose(Choice::Levels(Some(2)));
        apply(&mut state, Command::Form(levels));
        apply(&mut state, Command::Run);
        assert!(state.runs.first.save_refusal().is_some());
        let text = session_to_keep(&state).unwrap();
        assert!(text.contains("link"), "{text}");
        let mut next = settled();
        next.restore(Settings {
            last_session: Some(text),
            ..Settings::default()
        });
        apply(&mut next, Command::File(FileCommand::Last));
        let recipe = |state: &State| state.runs.first.session.as_ref().unwrap().recipe();
        assert_eq!(recipe(&next), recipe(&state));
    }

    #[test]
    fn work_that_was_begun_ends_the_offer_and_a_lesson_keeps_nothing() {
        let mut state = settled();
        state.restore(Settings {
            last_session: Some("{}".to_owned()),
            ..Settings::default()
        });
        type_in(&mut state, Parameter::Seed, "9");
        assert!(!state.files.offers_session(&state.past, &state.window));
        apply(&mut state, Command::Run);
        assert!(session_to_keep(&state).is_some());
        let text = tilescope_lessons::shipped::TEMPLATE.to_owned();
        let read = LessonCommand::Read("template".to_owned(), text);
        apply(&mut state, Command::Lesson(read));
        assert_eq!(session_to_keep(&state), None);
        state.finish();
        assert!(session_to_keep(&state).is_some());
    }
}
