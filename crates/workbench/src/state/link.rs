//! Permalinks in the state: makes the link to what is shown, and opens links. Begin with [`State::link`] and
//! [`State::open_link`]. To open one, its run is made first; then moment, view and the rest are applied.

use serde_json::{Value, json};
use tilescope_core::Parameters;
use tilescope_debugger::{SavedScene, Stops};
use tilescope_session::selection::Selection;
use tilescope_session::words::{counted, grouped, stage_name};

use super::State;
use crate::command::Which;
use crate::draft::Draft;
use crate::lessons::{LessonSource, WantedLesson};
use crate::link::{self, Link, LinkContent, LinkWarnings, NamedMoment, slug};
use crate::rules::UndoPart;

/// A link whose run is being made.
pub(super) struct Arriving {
    content: LinkContent,
    warnings: LinkWarnings,
}

impl State {
    /// Returns the link to what is shown: run, moment and view. While the run of an opened link is being made, it is
    /// that link. Cheap enough to be called every frame.
    #[must_use]
    pub fn link(&self) -> Link {
        if let Some(arriving) = &self.links.arriving {
            return link::write(&arriving.content);
        }
        if let Some(link) = self.lesson_link() {
            return link;
        }
        let mut left_out = Vec::new();
        let content = self.content(&mut left_out);
        let mut link = link::write(&content);
        left_out.append(&mut link.left_out);
        Link { left_out, ..link }
    }

    /// Returns the link to the step of the open lesson. It names no run, so that it does not show what happens after the
    /// question.
    fn lesson_link(&self) -> Option<Link> {
        let lessons = &self.classroom.lessons;
        let lesson = match (&lessons.wanted, &lessons.open) {
            (Some(wanted), _) => wanted.clone(),
            (None, Some(open)) if open.source == LessonSource::Shipped => WantedLesson {
                name: open.learner.lesson().name.clone(),
                step: Some(open.learner.step().name.clone()),
                practice: open.learner.practised(),
            },
            (None, Some(_)) => {
                let left_out = vec!["the lesson, which comes from a file".to_owned()];
                let fragment = String::new();
                return Some(Link { fragment, left_out });
            }
            (None, None) => return None,
        };
        let lesson = Some(lesson);
        // Whoever follows the link gets the language that is shown; English, the lessons' own, is not named, so that readers
        // of other languages get theirs.
        let language = Some(lessons.language.clone()).filter(|name| name == "de");
        Some(link::write(&LinkContent {
            lesson,
            language,
            ..LinkContent::default()
        }))
    }

    fn content(&self, left_out: &mut Vec<String>) -> LinkContent {
        let mut view = self.view();
        if self.runs.first.before_pattern.is_none() {
            let flight = self.runs.first.flight.as_ref();
            let destination = flight.map(tilescope_drawing::camera::Flight::destination);
            view.camera = view.camera.map(|camera| destination.unwrap_or(camera));
        }
        view.second = self.linked_second(view.second, left_out);
        let mut content = LinkContent {
            moment: self.linked_moment(),
            view,
            ..LinkContent::default()
        };
        if let Some(debugger) = &self.runs.first.debugger {
            content.breakpoints = debugger.saved_breakpoints();
            content.watches.clone_from(&debugger.watches);
            content.scenes.clone_from(&debugger.scenes);
            let layout = json!(self.layout_to_store());
            let is_other = |layout_of: &Value| !layout_of.is_null() && *layout_of != layout;
            let scenes = content.scenes.iter();
            match scenes.filter(|mark| is_other(&mark.view["layout"])).count() {
                0 => {}
                count => left_out.push(format!(
                    "the panel layout of {}",
                    counted(count, "scene", "scenes")
                )),
            }
            for mark in &mut content.scenes {
                mark.ends = None;
                if let Some(view) = mark.view.as_object_mut() {
                    view.remove("layout");
                }
                // A scene of the link's own run does not name the run.
                if mark.run == debugger.run_id() {
                    (mark.run, mark.anchor) = (String::new(), None);
                }
            }
        }
        self.put_run(&mut content, left_out);
        content
    }

    fn put_run(&self, content: &mut LinkContent, left_out: &mut Vec<String>) {
        content.parameters = self.form.draft.parameters;
        content.nested = self.form.draft.nesting();
        let Some(session) = &self.runs.first.session else {
            return;
        };
        match &session.combination {
            None => {
                let recipe = link::normal(session.recipe());
                content.parameters = recipe.parameters;
                content.nested = recipe.nested.filter(link::allows);
                left_out.extend(link::excess(&recipe.parameters));
                if session.nested.is_some() && content.nested.is_none() {
                    let why = match recipe.nested {
                        Some(_) => "have too many samples for a link",
                        None => "come from a file",
                    };
                    left_out.push(format!("the nested levels, which {why}"));
                    content.moment = NamedMoment::End;
                }
            }
            Some(combination) if combination.files > 0 => {
                left_out.push("the combination, which has sets from files".to_owned());
            }
            Some(combination) => {
                // The typed parameters are not those of the combination. Parameters of run B differ from the defaults.
                (content.parameters, content.nested) = (Parameters::default(), None);
                content.combination = Some(combination.layout.clone());
            }
        }
        if session.own.is_some() {
            left_out.push("the pattern, which comes from a file".to_owned());
        }
    }

    fn linked_moment(&self) -> NamedMoment {
        let Some(session) = &self.runs.first.session else {
            return NamedMoment::End;
        };
        match self.cursor() {
            Some((cursor, len)) if cursor < len => NamedMoment::Event(cursor),
            None if self.runs.first.stage + 1 < session.stages.len() => {
                NamedMoment::Stage(slug(&stage_name(session.stages[self.runs.first.stage])))
            }
            _ => NamedMoment::End,
        }
    }

    fn linked_second(
        &self,
        made: Option<Parameters>,
        left_out: &mut Vec<String>,
    ) -> Option<Parameters> {
        let (side, _) = self.runs.second.as_ref()?;
        let second = made.or(side.asked.filter(|_| side.session.is_none()));
        if second.is_none() {
            left_out.push(
                "run B, which takes part of a file, is a combination or has nested levels"
                    .to_owned(),
            );
        }
        second
    }

    pub(super) fn copy_link(&mut self) {
        let Link { fragment, left_out } = self.link();
        let base = self.links.base.as_deref();
        self.links.copied = Some(format!("{}#{fragment}", base.unwrap_or_default()));
        let hint = match base {
            Some(_) => ".",
            None => {
                ": put it behind the address of any Tilescope page, or open it with tilescope --link."
            }
        };
        let mut text = format!("The link is copied{hint}");
        if !left_out.is_empty() {
            text = format!("{text} It leaves out {}.", left_out.join("; "));
        }
        self.tell(text, false);
    }

    /// Shows a notice that the link could not be copied.
    pub fn tell_not_copied(&mut self) {
        let whence = if self.window.embedding.is_some() {
            "the page around this one may have to allow it"
        } else {
            "the address bar holds the link, too"
        };
        let text = format!("The browser did not let the link be copied: {whence}.");
        self.tell(text, true);
    }

    /// Shows a notice that the browser does not store results.
    pub fn tell_not_stored(&mut self) {
        let text = "The browser does not store your results: they are gone when this page is closed. The list of lessons saves them to a file.";
        self.tell(text.to_owned(), true);
    }

    /// Opens a link: a fragment with or without its `#`, or a whole address. Parts that are invalid, unknown or
    /// too large are left out and named in a notice. The run is made first, unless it is the current one; a run
    /// that the user starts meanwhile replaces it.
    pub fn open_link(&mut self, text: &str) {
        let (content, warnings) = link::read(text);
        self.open_content(content, warnings);
    }

    pub(super) fn open_content(&mut self, content: LinkContent, mut warnings: LinkWarnings) {
        self.stop_making();
        (self.files.sheet, self.files.exports.sheet) = (None, None);
        self.window.finder = None;
        self.classroom.lessons.close_list();
        if let Some(language) = &content.language {
            self.classroom.lessons.language.clone_from(language);
        }
        if let Some(wanted) = content.lesson {
            // A lesson that is open gives way to the other one, and what it borrowed stays borrowed.
            self.tell_of_link(&warnings);
            self.in_class(|class, context| class.open_wanted(wanted, context));
            return;
        }
        self.give_back();
        let before = self.memento();
        let is_made = self.is_made_from(&content);
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
            self.tell_of_link(&warnings);
            return;
        }
        self.tell_of_link(&warnings);
        if let Some(layout) = content.combination.clone() {
            self.start_combining(layout);
        } else {
            let recipe = content.recipe();
            self.start_sampling(Which::First, recipe, self.gpu.engine);
        }
        self.links.arriving = Some(Box::new(Arriving { content, warnings }));
    }

    /// Returns whether the current session is the one that a link asks for.
    fn is_made_from(&self, content: &LinkContent) -> bool {
        let Some(session) = &self.runs.first.session else {
            return false;
        };
        match (&session.combination, &content.combination) {
            (None, None) => {
                let asked = link::normal(content.recipe());
                session.has_recipe() && link::normal(session.recipe()) == asked
            }
            (Some(made), Some(asked)) => made.layout == *asked,
            _ => false,
        }
    }

    /// Applies the rest of a link whose run has just been made.
    pub(super) fn arrive(&mut self) {
        let Some(arriving) = self.links.arriving.take() else {
            return;
        };
        let Arriving {
            content,
            mut warnings,
        } = *arriving;
        if !self.is_made_from(&content) {
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
            self.tell_of_link(&warnings);
        }
    }

    fn take_up_link(&mut self, content: &LinkContent, warnings: &mut LinkWarnings) {
        self.time.playback.stop();
        self.time.playback.range = None;
        self.on(Which::First, |run, context| {
            run.pick(Selection::Nothing, context);
        });
        self.runs.first.witness_mark = None;
        self.take_moment(&content.moment, warnings);
        self.take_linked_stops(content, warnings);
        self.scenes_are_saved();
        for part in self.look_as(&content.view) {
            let text = format!("The link's {part} does not fit this run and was left out.");
            warnings.add(text);
        }
        self.follow_first();
    }

    /// Shows the warnings about a link, after an existing notice.
    fn tell_of_link(&mut self, warnings: &LinkWarnings) {
        if warnings.is_empty() {
            return;
        }
        let mut text = match self.messages.notice.take() {
            Some(notice) => notice.text + " ",
            None => String::new(),
        };
        text.push_str(&warnings.text());
        self.tell(text, true);
    }

    fn take_moment(&mut self, moment: &NamedMoment, warnings: &mut LinkWarnings) {
        let len = self.cursor().map(|(_, len)| len);
        let index = match moment {
            // Nested levels have no stages.
            NamedMoment::Stage(name) if self.runs.first.prefix().is_none() => {
                self.stage_named(name)
            }
            _ => None,
        };
        let missed = match (moment, len, index) {
            (NamedMoment::Event(cursor), Some(len), _) if *cursor <= len => {
                return self.runs.first.jump(*cursor);
            }
            (NamedMoment::Stage(_), _, Some(index)) => return self.runs.first.show_stage(index),
            (NamedMoment::End, ..) => None,
            (NamedMoment::Event(cursor), Some(len), _) => {
                let (item, whole) = match self.runs.first.prefix() {
                    Some(_) => ("sample", "set"),
                    None => ("event", "run"),
                };
                let len = grouped(len);
                Some(format!(
                    "The link asked for {item} {cursor} of a {whole} of {len}"
                ))
            }
            (NamedMoment::Event(_), None, _) => {
                Some("The link asked for an event, and this run has none".to_owned())
            }
            (NamedMoment::Stage(name), ..) => {
                Some(format!("This run has no stage \"{}\"", link::quoted(name)))
            }
        };
        if let Some(missed) = missed {
            warnings.add(format!("{missed}; the end is shown instead."));
        }
        self.runs.first.show_stage(usize::MAX);
    }

    /// Returns the index of a stage by its name in links.
    pub(super) fn stage_named(&self, name: &str) -> Option<usize> {
        let stages = &self.runs.first.session.as_ref()?.stages;
        stages
            .iter()
            .position(|&stage| slug(&stage_name(stage)) == name)
    }

    fn take_linked_stops(&mut self, content: &LinkContent, warnings: &mut LinkWarnings) {
        let stops = content.breakpoints.len() + content.watches.len() + content.scenes.len();
        let Some(debugger) = &mut self.runs.first.debugger else {
            if stops > 0 {
                let text = "This run has no events: breakpoints, watches and scenes were left out.";
                warnings.add(text.to_owned());
            }
            return;
        };
        let len = debugger.recording().len();
        let fits = |mark: &&SavedScene| !mark.run.is_empty() || mark.event <= len;
        let scenes: Vec<SavedScene> = content.scenes.iter().filter(fits).cloned().collect();
        let behind = content.scenes.len() - scenes.len();
        let stops = Stops {
            breakpoints: content.breakpoints.clone(),
            watches: content.watches.clone(),
            scenes,
        };
        if let Err(error) = debugger.put_stops(stops) {
            warnings.add(tilescope_session::words::sentence(&error.to_string()));
        }
        if behind > 0 {
            let marks = counted(behind, "scene", "scenes");
            warnings.add(format!(
                "The link has {marks} after the run's last event, {}, which were left out.",
                grouped(len)
            ));
        }
    }
}
