//! What concerns all parts at once: snapshots for undo, for lessons and for the tour, saved views, links, and sessions that
//! are opened from files and kept. Each part takes what is its own.

use std::sync::Arc;

use serde_json::Value;
use serde_json::json;
use tilescope_classroom::Classroom;
use tilescope_classroom::lessons::OpenLesson;
use tilescope_core::Parameters;
use tilescope_debugger::Debugger;
use tilescope_drawing::camera::Camera;
use tilescope_session::combining::SavedCombination;
use tilescope_session::incoming::NamedBytes;
use tilescope_session::layers::SessionKind;
use tilescope_session::recipe::{OwnPattern, Recipe};
use tilescope_session::selection::Selection;
use tilescope_session::session::Session;
use tilescope_session::words::{counted, sentence};

use super::borrowed::Borrowed;
use super::files::Saving;
use super::link::{Arriving, LinkSource};
use super::undo::{History, HistoryStep, Memento};
use super::{Appearance, Form, State};
use crate::clock::Clock;
use crate::command::{Command, FormCommand, TimeCommand, Which};
use crate::draft::Draft;
use crate::files::{
    Combined, Done, FileCommand, FileForm, LAST_SESSION, LastSession, Opened, Purpose, SaveTask,
    render,
};
use crate::layout::{Layout, Panel};
use crate::link::{self, Link, LinkContent, LinkWarnings};
use crate::rules::UndoPart;
use crate::scenes::SceneList;
use crate::view::SavedView;

/// Undo: snapshots, and steps back and forward.
impl State {
    /// Returns a snapshot of everything that can be undone.
    pub(super) fn memento(&self) -> Memento {
        Memento::of(&self.form, &self.runs.first, &self.appearance, &self.window)
    }

    /// Adds a step for `command`, if it changed something since `before`.
    pub(super) fn remember(&mut self, before: Memento, part: UndoPart, command: Option<&Command>) {
        let now = self.memento();
        self.past.history.remember(before, &now, part, command);
    }

    /// Adds the step of a run that is about to replace the current one, if there is one.
    pub(super) fn remember_run(&mut self, part: UndoPart) {
        if self.runs.first.session.is_some() {
            let now = self.memento();
            self.past.history.remember_run(part, now);
        }
    }

    /// Undoes or redoes a change.
    pub(super) fn step_in_history(&mut self, step: HistoryStep) {
        let now = self.memento();
        let session = self.runs.first.session.as_ref();
        let is_made = session.is_none_or(|session| session.has_recipe());
        let typed = is_made.then(|| self.form.recipe());
        let asked = self.messages.notice.as_ref();
        let asked = asked.map(|notice| notice.text.clone());
        self.with(|state, context| {
            let history = &mut state.past.history;
            history.step(step, now, typed, asked.as_deref(), context);
        });
    }

    /// Takes a layout that the user changed by dragging. Moving a panel can be undone.
    pub fn replace_layout(&mut self, layout: Layout, is_moved: bool) {
        let before = self.memento();
        self.window.layout = layout;
        if is_moved {
            self.remember(before, UndoPart::Layout, None);
        }
    }
}

/// What a lesson or the tour replaces, and gives back.
impl State {
    /// Sets aside what a lesson or the tour replaces, unless it is already.
    pub(super) fn borrow_window(&mut self) {
        if self.past.borrowed.is_some() {
            return;
        }
        let has_run = self.runs.first.session.is_some();
        let run = has_run.then(|| Box::new(self.runs.first.set_aside()));
        self.past.borrowed = Some(Box::new(Borrowed {
            panels: self.window.kept_panels(),
            form: self.form.clone(),
            appearance: self.appearance.clone(),
            playback: self.time.playback.clone(),
            scene: self.scenes.shown.take(),
            history: std::mem::take(&mut self.past.history),
            run,
            second: self.runs.second.take(),
        }));
        self.time.rest(false);
        // A window in a frame has no panels; its layout is that of the whole app.
        if self.window.embedding.is_none() {
            self.window.hide_sides();
        }
    }

    /// Shows the session that was set aside, at its end, if the parameters are those of its run. Returns whether it is
    /// shown.
    fn show_borrowed_session(&mut self) -> bool {
        let borrowed = self.past.borrowed.as_ref();
        let run = borrowed.and_then(|borrowed| borrowed.run.as_ref());
        let session = run.and_then(|run| run.session.clone());
        let typed = self.form.recipe();
        let is_same = |session: &&Arc<Session>| {
            session.has_recipe() && session.recipe() == typed && session.recording().is_some()
        };
        let Some(session) = session.as_ref().filter(is_same) else {
            return false;
        };
        self.on(Which::First, |run, context| {
            run.show_shared(session, context);
            run.verify(context);
        });
        true
    }

    /// Ends the lesson or the tour, if one is open, and restores what it had replaced.
    pub(super) fn give_back(&mut self) {
        // To close a lesson gives back what it replaced.
        self.in_class(Classroom::close);
        self.end_tour();
    }

    /// Ends the tour, if it is shown, and restores what it had replaced.
    pub(super) fn end_tour(&mut self) {
        if self.scenes.is_touring() {
            self.scenes.shown = None;
            self.give_back_of(None);
        }
    }

    /// Restores what a lesson that was closed, or the tour, had replaced.
    pub(super) fn give_back_of(&mut self, lesson: Option<OpenLesson>) {
        let Some(borrowed) = self.past.borrowed.take() else {
            return;
        };
        let borrowed = *borrowed;
        self.window.put_back(borrowed.panels);
        self.form.take(borrowed.form);
        self.appearance.chosen_layers = borrowed.appearance.chosen_layers;
        self.appearance.colouring = borrowed.appearance.colouring;
        self.time.rest(false);
        self.time.playback = borrowed.playback;
        self.time.playback.stop();
        self.scenes.shown = borrowed.scene;
        self.past.history = borrowed.history;
        self.runs.second = borrowed.second;
        match (borrowed.run, lesson) {
            (Some(run), _) => {
                self.runs.arriving = None;
                self.on(Which::First, |first, context| first.put_back(*run, context));
            }
            // A window that had no run before the lesson keeps that of the step, whole.
            (None, Some(lesson)) => {
                if let Some(recording) = &lesson.run {
                    self.in_time(|time, run, context| {
                        time.show_recording(recording, None, run, context);
                        run.verify(context);
                    });
                }
            }
            (None, None) => self.end_at_first_run(),
        }
    }

    /// Ends the tour of a program that had no run before it: its first run is shown as after the start.
    fn end_at_first_run(&mut self) {
        let run = &self.runs.first;
        let typed = self.form.recipe();
        let session = run.session.as_ref();
        let is_typed = session.is_some_and(|made| made.has_recipe() && made.recipe() == typed);
        if is_typed && run.sampling.is_none() {
            self.on(Which::First, |run, context| {
                run.show_stage(usize::MAX);
                run.fit(context);
            });
        } else if session.is_some() {
            // The tour has made another run since.
            self.start_sampling(Which::First, typed, self.gpu.engine);
        }
    }

    /// Brings back the panels that the tour has hidden, while the tour goes on.
    pub(super) fn bring_panels(&mut self) {
        if let Some(borrowed) = &self.past.borrowed
            && self.window.embedding.is_none()
        {
            self.window.put_back(borrowed.panels.clone());
        }
    }

    /// Shows the first scene of the tour. Its scenes are of the run with the default parameters; what the window shows comes
    /// back when the tour ends.
    pub(super) fn start_tour(&mut self) {
        self.give_back();
        self.classroom.lessons.lists = false;
        self.borrow_window();
        self.form.apply(FormCommand::Reset);
        // At the start of the program that run is being made already.
        let is_being_made = self.runs.first.sampling.is_some();
        if !self.show_borrowed_session() && !is_being_made {
            self.run();
        }
        self.show_scene_of_tour(0);
    }

    /// Shows a scene of the tour.
    pub(super) fn show_scene_of_tour(&mut self, index: usize) {
        self.in_scenes(|scenes, run, source, context| {
            scenes.show(SceneList::Tour, index, run, source, context);
        });
    }
}

/// Saved views and links.
impl State {
    /// Returns the current view.
    #[must_use]
    pub fn view(&self) -> SavedView {
        let second = self.runs.second.as_ref().and_then(|(side, _)| {
            let session = side.session.as_ref()?;
            let made = session.own.is_none() && session.kind() == SessionKind::Run;
            made.then_some(session.run().parameters)
        });
        let first = &self.runs.first;
        // The camera of the pattern is not saved, as the pattern has its own domain.
        let (camera, fitted) = first.before_pattern.unwrap_or((first.camera, first.fitted));
        let links = self
            .runs
            .second
            .as_ref()
            .map(|(_, comparison)| comparison.links());
        SavedView {
            camera: (!fitted).then_some(camera),
            appearance: self.appearance.clone(),
            layout: self.past.layout_to_store(&self.window).clone(),
            selection: first.selection(),
            playback: self.time.playback.clone(),
            second,
            links: links.unwrap_or_else(|| SavedView::default().links),
        }
    }

    /// Applies a view. Returns the names of the parts that do not fit the current session.
    pub fn look_as(&mut self, view: &SavedView) -> Vec<&'static str> {
        let mut dropped = Vec::new();
        let camera = self.runs.first.camera;
        let camera = view.camera.unwrap_or(camera);
        self.runs.first.take_camera(view.camera, camera);
        self.appearance.take(&view.appearance);
        self.window.layout.clone_from(&view.layout);
        // The passes of the GPU are not saved.
        let clock = view.playback.clock_of_events();
        if self.runs.first.clock_refusal(clock).is_none() {
            self.time.playback.choose(clock);
        } else if clock != self.time.playback.clock_of_events() {
            dropped.push("clock");
        }
        self.time.playback.speed = view.playback.speed;
        self.time.playback.whole_run_secs = view.playback.whole_run_secs;
        if let Some(range) = &view.playback.range {
            if self.cursor().is_some_and(|(_, len)| range.end <= len) {
                self.time.playback.range = Some(range.clone());
            } else {
                dropped.push("range");
            }
        }
        if view.selection != Selection::Nothing {
            if self.runs.first.can_select(view.selection) {
                self.on(Which::First, |run, context| {
                    run.pick(view.selection, context);
                });
            } else {
                dropped.push("selection");
            }
        }
        self.take_second(view);
        dropped
    }

    fn take_second(&mut self, view: &SavedView) {
        self.runs.second = None;
        let Some(parameters) = view.second else {
            return;
        };
        let engine = self.gpu.engine;
        self.with(|state, context| {
            let recipe = Recipe::from(parameters);
            state.runs.compare_with(recipe, engine, context);
        });
        if let Some((_, comparison)) = &mut self.runs.second {
            comparison.link(view.links);
        }
    }

    /// Returns the link to what is shown: run, moment and view. While the run of an opened link is being made, it is
    /// that link. Cheap enough to be called every frame.
    #[must_use]
    pub fn link(&self) -> Link {
        LinkSource {
            runs: &self.runs,
            view: self.view(),
            layout: self.past.layout_to_store(&self.window),
            form: &self.form,
            lessons: &self.classroom.lessons,
        }
        .link()
    }

    /// Opens a link: a fragment with or without its `#`, or a whole address. Parts that are invalid, unknown or
    /// too large are left out and named in a notice. The run is made first, unless it is the current one; a run
    /// that the user starts meanwhile replaces it.
    pub fn open_link(&mut self, text: &str) {
        let (content, warnings) = link::read(text);
        self.open_content(content, warnings);
    }

    /// Opens a link that was read.
    pub(crate) fn open_content(&mut self, content: LinkContent, mut warnings: LinkWarnings) {
        self.stop_making();
        (self.files.sheet, self.files.exports.sheet) = (None, None);
        self.window.finder = None;
        self.classroom.lessons.close_list();
        if let Some(language) = &content.language {
            self.classroom.lessons.language.clone_from(language);
        }
        if let Some(wanted) = content.lesson {
            // A lesson that is open gives way to the other one, and what it borrowed stays borrowed.
            self.messages.warn(&warnings);
            self.in_class(|class, context| class.open_wanted(wanted, context));
            return;
        }
        self.give_back();
        let before = self.memento();
        let is_made = self.runs.first.is_made_from(&content);
        if !is_made {
            self.remember_run(UndoPart::Everything);
        }
        self.form.own_pattern = None;
        if content.combination.is_none() {
            self.form.draft =
                Draft::from_parameters(content.parameters).with_nesting(content.nested);
        }
        if is_made {
            self.take_up_link(&content, &mut warnings);
            self.remember(before, UndoPart::Everything, None);
            self.messages.warn(&warnings);
            return;
        }
        self.messages.warn(&warnings);
        if let Some(layout) = content.combination.clone() {
            self.start_combining(layout);
        } else {
            let recipe = content.recipe();
            self.start_sampling(Which::First, recipe, self.gpu.engine);
        }
        self.runs.arriving = Some(Box::new(Arriving { content, warnings }));
    }

    /// Applies the rest of a link whose run has just been made.
    pub(super) fn arrive(&mut self) {
        let Some(arriving) = self.runs.arriving.take() else {
            return;
        };
        let Arriving {
            content,
            mut warnings,
        } = *arriving;
        if !self.runs.first.is_made_from(&content) {
            return;
        }
        let shown_before = warnings.clone();
        let notice = self.messages.notice.as_ref();
        let shown = notice.map(|notice| notice.text == shown_before.text());
        if shown == Some(true) {
            self.messages.notice = None;
        }
        self.take_up_link(&content, &mut warnings);
        // Warnings that the user has dismissed are not repeated unless there are new ones.
        if shown.is_some() || warnings != shown_before {
            self.messages.warn(&warnings);
        }
    }

    fn take_up_link(&mut self, content: &LinkContent, warnings: &mut LinkWarnings) {
        self.time.playback.stop();
        self.time.playback.range = None;
        self.on(Which::First, |run, context| {
            run.pick(Selection::Nothing, context);
        });
        self.runs.first.witness_mark = None;
        self.runs.first.take_moment(&content.moment, warnings);
        self.runs.first.take_linked_stops(content, warnings);
        self.files.scenes_are_saved(&self.runs.first);
        for part in self.look_as(&content.view) {
            let text = format!("The link's {part} does not fit this run and was left out.");
            warnings.add(text);
        }
        self.runs.follow_first();
    }
}

/// What pages ask for beside commands.
impl State {
    /// Starts a run with other parameters; the view stays as it is.
    pub(crate) fn load(&mut self, parameters: Parameters) {
        self.classroom.lessons.close_list();
        self.give_back();
        self.stop_making();
        self.form.own_pattern = None;
        self.form.draft = Draft::from_parameters(parameters);
        self.start_sampling(Which::First, Recipe::from(parameters), self.gpu.engine);
    }

    /// Sets the camera; without one, shows the whole domain.
    pub(crate) fn set_camera(&mut self, camera: Option<Camera>) {
        let now = self.runs.first.camera;
        self.runs.first.take_camera(camera, now);
    }

    /// Sets layers, colouring and look; layers that an open question hides stay hidden.
    pub(crate) fn set_appearance(&mut self, appearance: Appearance) {
        self.appearance = appearance;
        self.runs.first.follow_pattern();
        self.follow();
    }

    /// Moves in time by another unit than the chosen one.
    pub(crate) fn apply_by(&mut self, unit: Clock, command: TimeCommand) {
        let clock = std::mem::replace(&mut self.time.playback.clock, unit);
        self.apply(Command::Time(command));
        self.time.playback.clock = clock;
    }

    /// Stops playing.
    pub(crate) fn pause(&mut self) {
        self.time.playback.stop();
    }
}

/// Sessions from files.
impl State {
    /// Applies a command of files.
    pub(super) fn apply_to_files(&mut self, command: FileCommand) {
        match self.files.take_lesson(&command) {
            Some(Ok(lesson)) => {
                return self.in_class(|class, context| class.apply(lesson, context));
            }
            Some(Err(why)) => return self.tell(why, true),
            None if command == FileCommand::Last => return self.reopen_last(),
            None => {}
        }

        let saves = |form: &FileForm| form.purpose == Purpose::Save;
        let is_saved = command == FileCommand::Go && self.files.sheet.as_ref().is_some_and(saves);
        let saving = is_saved.then(|| Saving {
            run: self.saved(),
            combination: self.saved_combination(),
        });
        if matches!(command, FileCommand::Sheet(_)) {
            // What the sheet shows is about its own file.
            self.messages.notice = None;
        }
        self.with(|state, context| {
            state
                .files
                .apply(command, &state.runs.first, saving, context);
        });
    }

    /// Returns the current combination in saved form, with its view.
    #[must_use]
    pub fn saved_combination(&self) -> Option<SavedCombination> {
        let session = self.runs.first.session.as_ref()?;
        SavedCombination::of(session, self.runs.first.stage, self.view().to_json())
    }

    /// Returns the current session in saved form, with its view.
    #[must_use]
    pub fn saved(&self) -> Option<tilescope_debugger::Session> {
        let run = &self.runs.first;
        let (debugger, session) = (run.debugger.as_ref()?, run.session.as_ref()?);
        let mut saved = debugger.session();
        saved.view = self.view().to_json();
        if let (Some(record), Some(view)) =
            (self.classroom.saved_record(), saved.view.as_object_mut())
        {
            view.insert("talk".to_owned(), serde_json::json!(record));
        }
        saved.pattern = session.own.as_ref().map(|own| own.file.clone());
        Some(saved)
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
        self.with(|state, context| state.files.settle(context));
    }

    /// Returns the session as the text of a file, from which [`FileCommand::Last`] reopens it: run, moment, view, breakpoints
    /// and scenes. `None` if it is as the program starts, if a lesson or the tour has replaced it, or if it has files that
    /// are not part of it.
    #[must_use]
    pub fn session_to_keep(&self) -> Option<String> {
        if self.past.borrowed.is_some() || self.window.embedding.is_some() {
            return None;
        }
        let session = self.runs.first.session.as_ref()?;
        let parameters = Form::default().draft.parameters;
        let is_default = session.has_recipe() && session.recipe() == parameters.into();
        if is_default && self.runs.first.stops() == tilescope_debugger::Stops::default() {
            return None;
        }
        if self.runs.first.save_refusal().is_some() {
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
        let is_free = self.past.borrowed.is_none()
            && !self.past.history.can_undo()
            && self.files.filing.is_none();
        is_new && is_free && self.window.embedding.is_none()
    }

    fn reopen_last(&mut self) {
        let Some(last) = &mut self.files.last_session else {
            return;
        };
        last.is_reopened = true;
        let text = last.text.clone();
        let read: Option<Value> = serde_json::from_str(&text).ok();
        if let Some(link) = read.as_ref().and_then(|read| read["link"].as_str()) {
            self.open_link(link);
        } else {
            let file = NamedBytes::new(LAST_SESSION.to_owned(), text);
            self.apply_to_files(FileCommand::DroppedBytes(vec![file], Vec::new()));
        }
    }

    /// Takes what was read or written.
    pub(super) fn take_done(&mut self, done: Done) {
        // A notice, if any, is about this file.
        self.messages.notice = None;
        match done {
            Done::Saved(path) => self.saved_as(format!("Session saved to {path}."), path),
            Done::Download(file) => {
                let text = format!("The session is downloaded as {}.", file.name);
                self.saved_as(text, file.name.clone());
                self.files.downloads.push(file);
            }
            Done::Opened(opened) => self.take_up(*opened),
            Done::Combined(combined) => self.take_combination(*combined),
            Done::Against { file, no_pattern } => {
                if let Some(why) = no_pattern {
                    let name = file.name();
                    let text = format!(
                        "{name} is compared with this run: its curves are drawn dashed in the analysis. It cannot be used as a pattern: {why}. A pattern must be maximal and come with its certificate."
                    );
                    self.tell(text, false);
                }
                self.window.open_panel(Panel::Analysis);
                self.analysis.reference_file = Some(Arc::new(*file));
            }
            Done::Levels(session) => {
                self.give_back();
                self.stop_making();
                self.remember_run(UndoPart::Run);
                self.show(*session);
            }
            Done::Pattern(own) => self.take_pattern(own),
        }
    }

    fn saved_as(&mut self, mut text: String, path: String) {
        if self.runs.second.is_some() && self.view().second.is_none() {
            text.push_str(
                " The second run was not saved: it is not finished, or its pattern comes from a file.",
            );
        }
        self.tell(text, false);
        self.runs.first.session_path = Some(path);
        self.files.scenes_are_saved(&self.runs.first);
    }

    fn take_pattern(&mut self, own: OwnPattern) {
        let samples = counted(own.pattern.samples().len(), "sample", "samples");
        let text = format!(
            "The next run clips from the {samples} of {}. To compare it with this run instead, see the Analyze menu.",
            own.file.path
        );
        let before = self.memento();
        self.form.own_pattern = Some(own);
        self.remember(before, UndoPart::Form, None);
        self.tell(text, false);
    }

    /// Shows a session at the moment where it was saved, and cancels a running one.
    fn take_up(&mut self, opened: Opened) {
        let recording = opened.session.recording().map(Arc::clone);
        let resumed = recording.map(|recording| Debugger::resume(&opened.saved, recording));
        let debugger = match resumed {
            Some(Ok(debugger)) => debugger,
            Some(Err(error)) => return self.tell(sentence(&error.to_string()), true),
            None => return,
        };
        self.give_back();
        self.stop_making();
        self.form.draft = Draft::from_parameters(opened.saved.parameters);
        self.form.own_pattern.clone_from(&opened.session.own);
        (self.runs.first.selected, self.runs.first.place) = (None, None);
        self.show(opened.session);
        self.runs.first.debugger = Some(debugger);
        self.runs.first.follow_cursor();
        let (view, mut dropped) = SavedView::from_json(&opened.saved.view, &self.view());
        dropped.extend(self.look_as(&view));
        self.classroom.take_record(&opened.saved.view);
        self.past.history = History::default();
        self.opened_from(opened.path, &dropped);
    }

    /// Shows a combination that was read, at the stage where it was saved.
    fn take_combination(&mut self, combined: Combined) {
        self.give_back();
        self.stop_making();
        self.remember_run(UndoPart::Run);
        (self.runs.first.selected, self.runs.first.place) = (None, None);
        self.show_made(Which::First, combined.session);
        let Some(saved) = combined.saved else {
            return;
        };
        if let Some(session) = &self.runs.first.session {
            let last = session.stages.len() - 1;
            self.runs.first.set_stage(saved.stage.min(last));
        }
        let (view, mut dropped) = SavedView::from_json(&saved.view, &self.view());
        dropped.extend(self.look_as(&view));
        self.past.history = History::default();
        self.opened_from(combined.path, &dropped);
    }

    /// Sets the path of the session, and shows a notice of the parts of its view that were left out.
    fn opened_from(&mut self, path: String, dropped: &[&str]) {
        if !dropped.is_empty() {
            let text = format!(
                "{path} is open. These parts of its view are invalid and were left out: {}.",
                dropped.join(", ")
            );
            self.tell(text, false);
        }
        // The last session is in no file of the user's.
        if path != LAST_SESSION {
            self.runs.first.session_path = Some(path);
            self.files.scenes_are_saved(&self.runs.first);
        }
    }
}
