//! Permalinks: makes the link to the run and view that are shown, from a [`LinkSource`], and applies an opened link to a run.
//! `state/work.rs` opens links: the run is made first; then moment, view and the rest are applied.

use serde_json::{Value, json};
use tilescope_classroom::lessons::{LessonSource, Lessons, WantedLesson};
use tilescope_core::Parameters;
use tilescope_debugger::{SavedScene, Stops};
use tilescope_session::ground::GroundRequest;
use tilescope_session::language::is_english;
use tilescope_session::words::{counted, grouped, quoted, slug, stage_name};
use tilescope_sets::{PAINTED, RadiusSource};

use super::effects::{Context, Effect};
use super::{Form, RunView, Runs, State};
use crate::layout::Layout;
use crate::link::{self, Link, LinkContent, LinkWarnings, NamedMoment};
use crate::view::SavedView;

/// A link whose run is being made.
pub(super) struct Arriving {
    pub content: LinkContent,
    pub warnings: LinkWarnings,
}

/// The parts of the state that a link is made from.
pub(super) struct LinkSource<'a> {
    /// The runs that are shown.
    pub runs: &'a Runs,
    /// The current view, as it is saved.
    pub view: SavedView,
    /// The layout, as it is saved.
    pub layout: &'a Layout,
    /// The input of the next run.
    pub form: &'a Form,
    /// Lessons: the one that is open, or wanted by a link.
    pub lessons: &'a Lessons,
}

impl<'a> LinkSource<'a> {
    /// Returns the parts of a state.
    pub(super) fn of(state: &'a State) -> Self {
        Self {
            runs: &state.runs,
            view: SavedView::of(state),
            layout: state.past.layout_to_store(&state.window),
            form: &state.form,
            lessons: &state.classroom.lessons,
        }
    }

    /// Returns the link to the run, moment and view that are shown. While the run of an opened link is being made, it is that
    /// link. Cheap enough to be called every frame.
    pub(super) fn link(&self) -> Link {
        if let Some(arriving) = &self.runs.arriving {
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

    /// Returns the parts of the set that is shown which a link leaves out: if there are any, the link leads to another set.
    pub(super) fn left_out_of_set(&self) -> Vec<String> {
        let mut left_out = Vec::new();
        self.put_run(&mut LinkContent::default(), &mut left_out);
        left_out
    }

    /// Returns the link to a step of a lesson: of the lesson that an opened link asks for and that opens next, otherwise of the
    /// one that is open; `None` without either. It names no run, so that it does not show what happens after the question.
    fn lesson_link(&self) -> Option<Link> {
        let lessons = self.lessons;

        let wanted = match (&lessons.wanted, &lessons.open) {
            // It is about to replace the open lesson.
            (Some(wanted), _) => wanted.clone(),
            (None, Some(open)) if open.source == LessonSource::Shipped => WantedLesson {
                name: open.learner.lesson().name.clone(),
                step: Some(open.learner.step().name.clone()),
                practice: open.learner.practised(),
            },
            (None, Some(_)) => {
                // A reader of the link does not have the lesson's file, so that the link is empty.
                let left_out = vec!["the lesson, which comes from a file".to_owned()];
                let fragment = String::new();
                return Some(Link { fragment, left_out });
            }
            (None, None) => return None,
        };

        let lesson = Some(wanted);
        // Another language than English is part of the link. English is not, so that a reader of such a link gets a language of their own.
        let language = Some(lessons.language.clone()).filter(|name| !is_english(name));
        Some(link::write(&LinkContent {
            lesson,
            language,
            ..LinkContent::default()
        }))
    }

    /// Returns the content of the link; adds the settings that a link cannot have to `left_out`.
    fn content(&self, left_out: &mut Vec<String>) -> LinkContent {
        let mut view = self.view.clone();
        // The link has the place that the camera flies to, not a place on its way. While the pattern is shown, the view has the camera
        // to return to, which does not fly.
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

            let layout = json!(self.layout);
            let is_other = |saved: &Value| !saved.is_null() && *saved != layout;
            let scenes = content.scenes.iter();
            match scenes
                .filter(|scene| is_other(&scene.view["layout"]))
                .count()
            {
                0 => {}
                count => left_out.push(format!(
                    "the panel layout of {}",
                    counted(count, "scene", "scenes")
                )),
            }

            for scene in &mut content.scenes {
                // A link names the moment of a scene by its event alone.
                scene.ends = None;
                // Layouts of panels would make the link too long.
                if let Some(view) = scene.view.as_object_mut() {
                    view.remove("layout");
                }
                // A scene of the link's own run does not name the run.
                if scene.run == debugger.run_id() {
                    (scene.run, scene.anchor) = (String::new(), None);
                }
            }
        }

        self.put_run(&mut content, left_out);
        // The typed method may not be the one that makes such a set.
        content.parameters = content.recipe().with_its_method().parameters;
        content
    }

    /// Adds the input of the run; adds what a link cannot have of it to `left_out`.
    fn put_run(&self, content: &mut LinkContent, left_out: &mut Vec<String>) {
        // Without a session, the link has the parameters as typed.
        content.parameters = self.form.draft.parameters;
        content.nested = self.form.draft.nesting();
        content.depth = self.form.draft.depth_asked();
        let asked = self.form.draft.ground_request();

        let Some(session) = &self.runs.first.session else {
            return self.put_ground(asked, content, left_out);
        };

        match &session.combination {
            None => {
                let recipe = link::normal(session.recipe());
                content.parameters = recipe.parameters;
                content.nested = recipe.nested.filter(link::allows);
                content.depth = recipe.depth;
                let made = recipe.ground.as_deref().cloned();
                self.put_ground(made, content, left_out);
                left_out.extend(link::excess(&recipe.parameters, recipe.depth));
                if session.nested.is_some() && content.nested.is_none() {
                    let why = match recipe.nested {
                        Some(_) => "have too many samples for a link",
                        None => "come from a file",
                    };
                    left_out.push(format!("the nested levels, which {why}"));
                    // The moment is one of the levels that are left out.
                    content.moment = NamedMoment::End;
                }
            }
            Some(combination) if combination.files > 0 => {
                // The link has the parameters as typed, so that it leads to their run.
                left_out.push("the combination, which has sets from files".to_owned());
                content.ground = asked.filter(link::carries);
                // The moment is one of the combination that is left out.
                content.moment = NamedMoment::End;
            }
            Some(combination) => {
                // The typed parameters are not those of the combination. The default ones stand for them, and those of run B are given by
                // their differences from the default ones.
                (content.parameters, content.nested) = (Parameters::default(), None);
                content.depth = None;
                content.combination = Some(combination.layout.clone());
            }
        }

        if session.own.is_some() {
            left_out.push("the pattern, which comes from a file".to_owned());
        }
    }

    /// Adds a field and a shape. An image stays on the visitor's machine, and a long polygon would make no link: then the link
    /// says that it leads to another set. That of painted radii leads to the set from before they were painted.
    fn put_ground(
        &self,
        asked: Option<GroundRequest>,
        content: &mut LinkContent,
        left_out: &mut Vec<String>,
    ) {
        let Some(request) = asked else {
            return;
        };
        if link::carries(&request) {
            content.ground = Some(request);
            return;
        }

        // The moment is one of the set that is left out.
        (content.lacks_ground, content.moment) = (true, NamedMoment::End);
        let is_painted = matches!(&request.radius, Some(RadiusSource::Image { image, .. }) if image.name() == PAINTED);
        let before = self.form.draft.before_painting().filter(|_| is_painted);
        let unpainted = before.map(|(radius, field)| {
            // Darts made the set of the painted radii, whatever the method of the one before.
            let painted = content.parameters;
            content.parameters.radius = radius;
            content.parameters.method = self.form.draft.parameters.method;
            content.parameters.pattern = content.parameters.pattern_following(&painted);
            GroundRequest {
                radius: field,
                ..request
            }
        });
        // Without its radii the request is that of the shape alone, or of nothing. The radii that were painted
        // over may themselves be an image.
        let is_asked = |ground: &GroundRequest| ground.radius.is_some() || ground.shape.is_some();
        let unpainted = unpainted.filter(|ground| !is_asked(ground) || link::carries(ground));
        let what = if unpainted.is_some() {
            "the painted radii: it leads to those from before they were painted"
        } else {
            "the field or the shape, which has an image or is too long for a link, so that it leads to another set"
        };
        left_out.push(what.to_owned());
        content.ground = unpainted.filter(is_asked);
    }

    /// Returns the name of the moment that is shown: its event, or without events its stage. At the end of the run it is the end, as
    /// without a session.
    fn linked_moment(&self) -> NamedMoment {
        let Some(session) = &self.runs.first.session else {
            return NamedMoment::End;
        };
        match self.runs.first.cursor() {
            Some((cursor, len)) if cursor < len => NamedMoment::Event(cursor),
            None if self.runs.first.stage + 1 < session.stages.len() => {
                NamedMoment::Stage(slug(&stage_name(session.stages[self.runs.first.stage])))
            }
            _ => NamedMoment::End,
        }
    }

    /// Returns the parameters of run B for a link; `None` if there is no run B, or if it has to be left out. `made` are
    /// those of the run B that is there, if it is made of parameters alone.
    fn linked_second(
        &self,
        made: Option<Parameters>,
        left_out: &mut Vec<String>,
    ) -> Option<Parameters> {
        let (side, _) = self.runs.second.as_ref()?;
        // While run B is being made, its parameters are those that were asked for.
        let second = made.or(side.asked.filter(|_| side.session.is_none()));
        if second.is_none() {
            left_out.push(
                "run B, which takes part of a file, is a combination, has nested levels or lies in a field, a shape or space"
                    .to_owned(),
            );
        }
        second
    }
}

impl Link {
    /// Copies the link behind the address of the page, if there is one, and says what it leaves out.
    pub(super) fn copy(self, address: Option<&str>, context: &mut Context) {
        let Self { fragment, left_out } = self;
        let hint = match address {
            Some(_) => ".",
            None => {
                ": put it behind the address of any Tilescope page, or open it with tilescope --link."
            }
        };

        let mut text = format!("The link is copied{hint}");
        if !left_out.is_empty() {
            text = format!("{text} It leaves out {}.", left_out.join("; "));
        }
        // Without an address the fragment is copied alone.
        let link = format!("{}#{fragment}", address.unwrap_or_default());
        context.ask(Effect::Copy(link));
        context.tell(text);
    }
}

/// Returns why a link could not be copied, in a window that is embedded in another page or not.
#[must_use]
pub fn not_copied(is_embedded: bool) -> String {
    let whence = if is_embedded {
        "the page around this one may have to allow it"
    } else {
        "the address bar holds the link, too"
    };
    format!("The browser did not let the link be copied: {whence}.")
}

impl RunView {
    /// Returns whether the current session is the one that a link asks for.
    pub(super) fn is_made_from(&self, content: &LinkContent) -> bool {
        let Some(session) = &self.session else {
            return false;
        };
        match (&session.combination, &content.combination) {
            (None, None) => {
                let asked = link::normal(content.recipe());
                session.has_recipe() && link::normal(session.recipe()) == asked
            }
            (Some(made), Some(asked)) => made.layout == *asked,
            // A run is no combination.
            _ => false,
        }
    }

    /// Goes to the moment of a link; to the end if there is no such moment.
    pub(super) fn take_moment(&mut self, moment: &NamedMoment, warnings: &mut LinkWarnings) {
        let len = self.cursor().map(|(_, len)| len);
        let nested = self
            .session
            .as_ref()
            .and_then(|session| session.nested.as_ref());
        // How many samples have ranks below that of the link.
        let count_below = match moment {
            NamedMoment::Rank(rank) => nested.and_then(|nested| nested.below(*rank)),
            _ => None,
        };
        if let Some(count) = count_below {
            return self.jump(count);
        }

        let index = match moment {
            // Nested levels have no stages.
            NamedMoment::Stage(name) if self.prefix().is_none() => self.stage_named(name),
            _ => None,
        };

        let missed = match (moment, len, index) {
            (NamedMoment::Event(cursor), Some(len), _) if *cursor <= len => {
                return self.jump(*cursor);
            }
            (NamedMoment::Stage(_), _, Some(index)) => return self.show_stage(index),
            (NamedMoment::End, ..) => None,
            (NamedMoment::Event(cursor), Some(len), _) => {
                let (item, whole) = match self.prefix() {
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
            // The samples below a rank were jumped to above, if the run has ranks.
            (NamedMoment::Rank(rank), ..) => Some(format!(
                "The link asked for ranks below {rank}, and only nested levels that are made from parameters have ranks"
            )),
            (NamedMoment::Stage(name), ..) => {
                Some(format!("This run has no stage \"{}\"", quoted(name)))
            }
        };

        if let Some(missed) = missed {
            warnings.add(format!("{missed}; the end is shown instead."));
        }
        // A number beyond the last stage shows the end.
        self.show_stage(usize::MAX);
    }

    /// Returns the index of a stage by its name in links.
    pub(crate) fn stage_named(&self, name: &str) -> Option<usize> {
        let stages = &self.session.as_ref()?.stages;
        stages
            .iter()
            .position(|&stage| slug(&stage_name(stage)) == name)
    }

    /// Replaces breakpoints, watches and scenes by those of a link.
    pub(super) fn take_linked_stops(&mut self, content: &LinkContent, warnings: &mut LinkWarnings) {
        let stop_count = content.breakpoints.len() + content.watches.len() + content.scenes.len();
        let Some(debugger) = &mut self.debugger else {
            if stop_count > 0 {
                let text = "This run has no events: breakpoints, watches and scenes were left out.";
                warnings.add(text.to_owned());
            }
            return;
        };

        let len = debugger.recording().len();
        // A scene that names no run is of the link's own run. One of another run is found by its anchor, so that the
        // number of its event need not fit this run.
        let fits = |scene: &&SavedScene| !scene.run.is_empty() || scene.event <= len;
        let scenes: Vec<SavedScene> = content.scenes.iter().filter(fits).cloned().collect();
        let after_end = content.scenes.len() - scenes.len();

        let stops = Stops {
            breakpoints: content.breakpoints.clone(),
            watches: content.watches.clone(),
            scenes,
        };

        if let Err(error) = debugger.put_stops(stops) {
            warnings.add(tilescope_session::words::sentence(&error.to_string()));
        }

        if after_end > 0 {
            let lost = counted(after_end, "scene", "scenes");
            warnings.add(format!(
                "The link has {lost} after the run's last event, {}, which were left out.",
                grouped(len)
            ));
        }
    }
}
