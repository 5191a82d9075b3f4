//! Runs, links and files that are shown, and the background work for them: starts it, takes its results, waits for it. Every
//! frame calls [`State::advance`]; tests and scripts call [`State::settle`].

use std::sync::Arc;

use tilescope_classroom::Classroom;
use tilescope_core::Parameters;
use tilescope_debugger::Debugger;
use tilescope_session::jobs::Wake;
use tilescope_session::layers::{Layer, SessionKind};
use tilescope_session::recipe::Recipe;
use tilescope_session::selection::Selection;
use tilescope_session::session::{MakeError, Session};
use tilescope_session::solid::MadeSolid;
use tilescope_session::words::sentence;

use super::effects::Effect;
use super::link::{Arriving, LinkSource};
use super::run_view::{self, Asked, RunView, TRANSITION_SECS};
use super::undo::{History, Made, Memento};
use super::{Messages, Notice, State, Which};
use crate::command::{Command, FormCommand, PaintCommand};
use crate::draft::Draft;
use crate::files::{FileCommand, LAST_SESSION, Opened, SavedContent};
use crate::layout::Panel;
use crate::link::{self, Link};
use crate::live::frame_steps;
use crate::rules::UndoPart;
use crate::scenes::SceneList;
use crate::view::SavedView;

/// Larger runs, in samples, do not start by themselves. Chosen, not measured.
const MAX_LIVE: f64 = 50_000.0;

impl State {
    /// Starts a run of the parameters in the form, or says why there is none.
    pub(super) fn run(&mut self) {
        // The button is off then. Scripts, links and pages that embed the window get the reason why nothing runs.
        if let Some(why) = self.form.refusal(&self.gpu) {
            return self.messages.tell_error(why);
        }
        self.stop_making();
        let recipe = self.form.recipe();
        if !is_made_by(&self.runs.first, &recipe) {
            self.remember_run(UndoPart::Run);
        }
        self.start_sampling(Which::First, recipe, self.gpu.engine);
    }

    /// Runs after a change of the parameters, if live runs were chosen and the run is small. Also runs after each
    /// stroke of the brush, and after the painting is reset.
    pub(super) fn run_live(&mut self, command: &Command) {
        let expected = self.form.draft.expected_samples();
        let is_small = expected.is_some_and(|count| count <= MAX_LIVE);
        let is_painted = match command {
            Command::Form(FormCommand::Paint(PaintCommand::Reset)) => true,
            // A stroke that was refused painted nothing.
            Command::Form(FormCommand::Paint(PaintCommand::Stroke(_))) => {
                self.form.draft.ground.is_painted()
            }
            _ => false,
        };
        // Even a large run starts after a stroke, since a stroke without its samples would show nothing. If the run
        // is still being made at the next stroke, that stroke cancels the run.
        let is_wanted = is_painted || self.form.live && is_small;
        if !is_wanted || self.form.refusal(&self.gpu).is_some() {
            return;
        }
        let recipe = self.form.recipe();
        if !is_made_by(&self.runs.first, &recipe) {
            let now = self.runs.first.session.is_some().then(|| Memento::of(self));
            self.past.history.remember_live_run(command, now);
            self.start_sampling(Which::First, recipe, self.gpu.engine);
        }
    }

    /// Advances by `dt_secs`: takes finished work, moves cameras, plays. Returns whether something is moving,
    /// so that another frame is needed.
    pub fn advance(&mut self, dt_secs: f32) -> bool {
        self.poll();
        self.in_class(Classroom::follow_lesson_file);

        self.on(Which::First, |run, _| run.fly_on(dt_secs));
        let cursor_before = self.runs.first.cursor();
        let plays = self.with(|state, context| {
            let run = &mut state.runs.first;
            state.time.advance(dt_secs, run, context)
        });
        let is_fast = self.time.playback.is_fast(TRANSITION_SECS);
        // In fast play the camera would chase events that are too short to be seen.
        if !is_fast && self.appearance.follows_events {
            self.on(Which::First, |run, context| {
                run.follow_event(cursor_before, context);
            });
        }

        // Everything that follows the moment of the first run.
        let shows_events = self.window.shows(Panel::Events);
        let asked = asked_of(self, Which::First, dt_secs);
        let awaits_rest = self.on(Which::First, |run, context| {
            run.follow_prefix(dt_secs, context);
            // Only while a panel shows the tree of events is it unfolded, down to the event before the cursor.
            if shows_events {
                run.reveal();
            }
            run.want_hits(context);
            run.follow_moment(asked, context);
            run.awaits_rest()
        });

        let wake = Wake::clone(&self.runs.jobs.wake);
        self.analysis
            .follow(&self.runs.first, asked.is_analysed, &wake);
        let dark = self.appearance.look.is_dark();
        self.scenes
            .follow_thumbnails(&self.runs, &self.window, dark);
        self.in_class(|class, context| {
            class.follow_talk(dark, context);
            class.follow_handout(context);
        });
        self.in_exports(|exports, source, _, _| exports.count_frames(source));

        // The second run comes after the first one, as its moment and camera may follow it.
        let made = self.runs.get_mut(Which::Second).and_then(RunView::made);
        self.finish_sampling(Which::Second, made);
        self.on(Which::Second, |run, _| run.poll());
        let asked = asked_of(self, Which::Second, dt_secs);
        let second_moves = self.with_of(Which::Second, |state, context| {
            state.runs.advance_second(dt_secs, asked, context)
        });

        self.time.follow_passes(&self.runs.first);
        let is_playing = self.time.playback.is_playing();
        let Messages {
            announcer, notice, ..
        } = &mut self.messages;
        let lessons = &self.classroom.lessons;
        announcer.follow(&self.runs.first, is_playing, notice.as_ref(), lessons);

        let may_fade = !is_fast && !self.appearance.reduced_motion;
        let fades = self.runs.first.advance_transition(dt_secs, may_fade);
        self.runs.first.flight.is_some()
            || plays
            || second_moves
            || fades
            || awaits_rest == Some(true)
    }

    /// Takes the work that has ended since the last frame, of the GPU, the first run, exports and files.
    fn poll(&mut self) {
        self.with(|state, context| state.gpu.poll(context));
        let made = self.runs.first.made();
        self.finish_sampling(Which::First, made);
        self.runs.first.poll();
        self.in_exports(|exports, source, delivery, context| {
            exports.poll(source, delivery, context);
        });
        self.with(|state, context| state.files.poll(&mut state.runs, context));
        if let Some(path) = self.files.take_awaiting(&self.runs.first) {
            self.apply(Command::File(FileCommand::Dropped(vec![path])));
        }
    }

    /// Shows the session that was made, or says why there is none. Without `made` it does nothing. The outer error of
    /// `made` says why the job broke off; the inner error says why the job made no session.
    fn finish_sampling(&mut self, which: Which, made: Option<run_view::Made>) {
        let Some(outcome) = made else {
            return;
        };

        match outcome {
            Ok(Ok(session)) => {
                // What follows concerns lessons, links and the tour, which are about the first run alone.
                if which == Which::Second {
                    return self.show(which, session);
                }

                if let Some(run) = self.classroom.made_for_lesson(&session) {
                    // The lesson shows its run only up to its question, so that the whole session is not shown.
                    drop(session);
                    return self.in_class(|class, context| class.arrive_at_step(&run, context));
                }

                // A run that was made because a parameter changed shows the same stage as the run before it, unless that showed its end.
                let run = &self.runs.first;
                let is_live = self.form.live && !run.is_at_end();
                let stage = run.current_stage().filter(|_| is_live);
                self.show(which, session);
                if let Some(stage) = stage {
                    self.runs.first.show_same_stage(stage);
                }

                self.arrive();
                // The tour shows its scene again, as its run is there only now.
                if let Some(shown) = self.scenes.shown.filter(|_| self.scenes.is_touring()) {
                    self.in_scenes(|scenes, run, source, context| {
                        scenes.show(SceneList::Tour, shown.index, run, source, context);
                    });
                }
                return;
            }

            Ok(Err(error)) => {
                let run = self.runs.get(which);
                let is_kept = run.is_some_and(|run| run.session.is_some());
                self.messages.tell_of(which, not_made(&error, is_kept));
            }
            Err(failure) => {
                let notice = Notice::error(sentence(&failure));
                self.messages.tell_of(which, notice);
            }
        }

        if which == Which::First {
            // A link cannot be applied without its run.
            self.runs.arriving = None;
        }
    }

    /// Waits for all work in the background and takes its results. For tests and scripts; a window calls
    /// [`Self::advance`] every frame.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn settle(&mut self) {
        self.with(|state, context| state.gpu.settle(context));
        // A file that waited for a run is opened first, so that it is read with the other files below.
        if let Some(path) = self.files.take_awaiting(&self.runs.first) {
            self.apply(Command::File(FileCommand::Dropped(vec![path])));
        }
        self.with(|state, context| state.files.settle(&mut state.runs, context));

        let made = self.runs.first.wait_made();
        self.finish_sampling(Which::First, made);
        let asked = asked_of(self, Which::First, 0.0);
        self.on(Which::First, |run, context| {
            run.settle(asked, context);
        });

        // A search for a breakpoint may take several frames, each of which does a part of it.
        while self.time.continuing.is_some() {
            self.with(|state, context| {
                state.time.continue_on(&mut state.runs.first, context);
            });
        }

        let second = self.runs.get_mut(Which::Second);
        let made = second.and_then(RunView::wait_made);
        self.finish_sampling(Which::Second, made);
        let asked = asked_of(self, Which::Second, 0.0);
        self.on(Which::Second, |run, context| {
            run.settle(asked, context);
        });

        let wake = Wake::clone(&self.runs.jobs.wake);
        self.runs.settle_comparison(&wake);
        let run = &self.runs.first;
        let is_analysed = asked_of(self, Which::First, 0.0).is_analysed;
        self.analysis.settle_with(run, is_analysed, &wake);

        self.time.follow_passes(&self.runs.first);
        self.on(Which::First, |run, context| {
            run.want_hits(context);
            run.hits.settle();
        });

        let dark = self.appearance.look.is_dark();
        loop {
            // One picture is drawn at a time, so that each turn starts the next one.
            self.scenes
                .follow_thumbnails(&self.runs, &self.window, dark);
            if !self.scenes.thumbnails.wait() {
                break;
            }
        }

        self.in_class(|class, context| class.settle_talk(dark, context));
        self.in_exports(|exports, _, _, context| exports.settle(context));
    }

    /// Shows a session at its last stage and has it verified; says if the CPU replaced the GPU or the GPU's run differs.
    pub fn show(&mut self, which: Which, mut session: Session) {
        let failure = session.failure.take();
        // A run of the GPU that was found to differ from the CPU's has stages, but no events.
        let differs = session.kind() == SessionKind::Run
            && session.has_stages()
            && session.recording().is_none();
        let engine = session.engine.clone();
        let is_combination = session.combination.is_some();

        if which == Which::First {
            // Playback stops; a loop stays if the run is the same.
            let is_same_run = self.runs.first.is_same_run(&session);
            self.time.rest(is_same_run);
        }

        self.on(which, |run, context| run.show(session, context));
        // Layers that the user chose for a run may lack the seams, without which a combination looks like a run.
        if let Some(layers) = &mut self.appearance.chosen_layers
            && is_combination
            && !layers.has(Layer::Seams)
        {
            layers.toggle(Layer::Seams);
        }

        if differs {
            let text = format!(
                "The run of {engine} differs from the CPU's run with the same parameters. It is shown as it is, without events. \
                 The passes of the GPU show where the two diverge."
            );
            self.messages.tell_of(which, Notice::error(text));
        }
        if let Some(failure) = failure {
            let text = self.gpu.failed(failure);
            self.messages.tell_of(which, Notice::error(text));
        }
    }

    /// Shows a session that was read from a file, at the moment where it was saved. Parts of its view that are invalid or do
    /// not fit are named in a notice.
    pub(super) fn show_opened(&mut self, opened: Opened) {
        let Opened {
            path,
            saved,
            session,
        } = opened;
        // This comes before the window gives anything up, because the saved session may not fit its recording.
        let debugger = match (&saved, session.recording()) {
            (SavedContent::Run(saved), Some(recording)) => {
                match Debugger::resume(saved, Arc::clone(recording)) {
                    Ok(debugger) => Some(debugger),
                    Err(error) => return self.messages.tell_error(sentence(&error.to_string())),
                }
            }
            // A saved run always has events.
            (SavedContent::Run(_), None) => return,
            (SavedContent::Combination(_), _) => None,
        };

        self.give_back();
        self.stop_making();

        match &saved {
            SavedContent::Run(saved) => {
                self.form.draft = draft_of(saved.parameters, &session);
                self.form.own_pattern.clone_from(&session.own);
            }
            // Opening a layout can be undone. After a session is opened, the steps are dropped below.
            SavedContent::Combination(_) => self.remember_run(UndoPart::Run),
        }
        // A selection in the run before means nothing in this one.
        (self.runs.first.selected, self.runs.first.place) = (None, None);
        self.show(Which::First, session);

        let run = &mut self.runs.first;
        let view = match saved {
            SavedContent::Run(saved) => {
                run.debugger = debugger;
                run.follow_cursor();
                // Votes and drawings of a talk are saved in the view.
                self.classroom.take_record(&saved.view);
                saved.view
            }
            SavedContent::Combination(Some(saved)) => {
                let stage_count = run.session.as_ref().map_or(0, |made| made.stages.len());
                run.set_stage(saved.stage.min(stage_count.saturating_sub(1)));
                self.classroom.take_record(&saved.view);
                saved.view
            }
            // A layout has no view.
            SavedContent::Combination(None) => return,
        };

        let (view, mut dropped) = SavedView::from_json(&view, &SavedView::of(self));
        dropped.extend(self.look_as(&view));
        // The steps to undo belong to the session before.
        self.past.history = History::default();
        if !dropped.is_empty() {
            let text = format!(
                "{path} is open. These parts of its view are invalid and were left out: {}.",
                dropped.join(", ")
            );
            self.messages.tell(text);
        }
        // The session of an earlier use of the program was in no file of the user's.
        if path != LAST_SESSION {
            self.runs.first.session_path = Some(path);
            self.files.scenes_are_saved(&self.runs.first);
        }
    }

    /// Applies a view. Returns the names of the parts that do not fit the current session.
    pub fn look_as(&mut self, view: &SavedView) -> Vec<&'static str> {
        self.with(|state, context| {
            let engine = state.gpu.engine;
            view.apply(&mut state.runs, &mut state.time, engine, context)
        })
    }

    /// Returns the link to the run, moment and view that are shown. While the run of an opened link is being made, it is that
    /// link. Cheap enough to be called every frame.
    #[must_use]
    pub fn link(&self) -> Link {
        LinkSource::of(self).link()
    }

    /// Opens a link: a fragment with or without its `#`, or a whole address. Parts that are invalid, unknown or
    /// too large are left out and named in a notice. The run is made first, unless it is the current one; a run
    /// that the user starts meanwhile replaces it.
    pub fn open_link(&mut self, text: &str) {
        let (content, warnings) = link::read(text);
        self.stop_making();
        // What covers the window is closed, so that what the link shows is seen.
        (self.files.sheet, self.files.exports.sheet) = (None, None);
        self.window.finder = None;
        self.classroom.lessons.close_list();
        if let Some(language) = &content.language {
            self.classroom.lessons.language.clone_from(language);
        }
        if let Some(wanted) = content.lesson {
            // The new lesson takes the place of one that is open. What that one had borrowed of the window stays borrowed.
            self.messages.warn(&warnings);
            self.in_class(|class, context| class.open_wanted(wanted, context));
            return;
        }

        self.give_back();
        let before = Memento::of(self);
        let is_made = self.runs.first.is_made_from(&content);
        // If the run is to be made, the step to undo is added now. Otherwise it is added below, once the link is applied.
        if !is_made {
            self.remember_run(UndoPart::Everything);
        }

        // A link cannot name a pattern from a file, so that the next run has none.
        self.form.own_pattern = None;
        let made = if let Some(layout) = content.combination.clone() {
            Made::Combination(layout)
        } else {
            let draft = Draft::from_parameters(content.parameters);
            self.form.draft = draft
                .with_nesting(content.nested)
                .with_ground(content.ground.as_ref())
                .with_depth(content.depth);
            Made::Run(content.recipe())
        };

        self.messages.warn(&warnings);
        self.runs.arriving = Some(Box::new(Arriving { content, warnings }));
        if is_made {
            self.arrive();
            let no_command = None;
            self.remember(before, UndoPart::Everything, no_command);
        } else {
            self.carry_out(Which::First, vec![Effect::Make(Box::new(made))]);
        }
    }

    /// Applies the rest of a link whose run is there.
    fn arrive(&mut self) {
        let Some(arriving) = self.runs.arriving.take() else {
            return;
        };
        let Arriving {
            content,
            mut warnings,
        } = *arriving;
        // Another run may have been started meanwhile.
        if !self.runs.first.is_made_from(&content) {
            return;
        }

        let shown_before = warnings.clone();
        let notice = self.messages.notice.as_ref();
        // `None` if no notice is shown, because the user has dismissed it; `Some(false)` if another notice is shown.
        let shows_warnings = notice.map(|notice| notice.text == shown_before.text());

        // A notice with these warnings is closed, as they are shown again below, together with new ones.
        if shows_warnings == Some(true) {
            self.messages.notice = None;
        }

        self.with(|state, context| {
            let (run, playback) = (&mut state.runs.first, &mut state.time.playback);
            playback.stop();
            playback.range = None;
            run.pick(Selection::Nothing, context);
            run.witness_mark = None;
            run.take_moment(&content.moment, &mut warnings);
            run.take_linked_stops(&content, &mut warnings);
            state.files.scenes_are_saved(run);
        });
        for part in self.look_as(&content.view) {
            let text = format!("The link's {part} does not fit this run and was left out.");
            warnings.add(text);
        }
        self.runs.follow_first();
        // Warnings that the user has dismissed are not repeated unless there are new ones.
        if shows_warnings.is_some() || warnings != shown_before {
            self.messages.warn(&warnings);
        }
    }

    /// Ends open work before the window closes: a lesson or the tour gives back what it replaced, an export is cancelled and
    /// removes its unfinished file, and a session that is being saved is saved.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn finish(&mut self) {
        self.give_back();
        if let Some(job) = &self.files.exports.work {
            job.cancel();
        }
        self.in_exports(|exports, _, _, context| exports.settle(context));
        self.with(|state, context| state.files.settle(&mut state.runs, context));
    }
}

/// Returns the draft of a session with these parameters: with its field and its shape, or its third side.
fn draft_of(parameters: Parameters, session: &Session) -> Draft {
    let ground = session.ground.as_ref().map(|made| &made.asked.1);
    let depth = session.solid.as_ref().map(MadeSolid::depth);
    Draft::from_parameters(parameters)
        .with_ground(ground)
        .with_depth(depth)
}

/// Returns whether a recipe makes the run that is shown. Combinations, and levels from a file, come from no recipe.
fn is_made_by(run: &RunView, recipe: &Recipe) -> bool {
    let session = run.session.as_ref();
    session.is_some_and(|session| session.has_recipe() && session.recipe() == *recipe)
}

/// Returns what the window shows of a run, in a frame after one of `dt_secs`. The curve is of the first run.
fn asked_of(state: &State, which: Which, dt_secs: f32) -> Asked {
    let is_first = which == Which::First;
    // Two runs share the time of a frame.
    let runs = if state.runs.second.is_some() { 2 } else { 1 };
    // Layers follow the stage of the run itself, as its canvas does. Without this run nothing is measured of it, so that any will do.
    let run = state.runs.get(which).unwrap_or(&state.runs.first);
    Asked {
        layers: run.layers(&state.appearance),
        is_analysed: state.window.shows(Panel::Analysis),
        steps: frame_steps(dt_secs) / runs,
        curve: state.appearance.curve.number.filter(|_| is_first),
        is_dark: state.appearance.look.is_dark(),
    }
}

/// Returns the notice of a run that was not made; whether the previous session is kept.
fn not_made(error: &MakeError, is_kept: bool) -> Notice {
    let kept = if is_kept {
        " The previous session is kept."
    } else {
        ""
    };
    match error.cancelled() {
        Some(stage) => {
            let text = format!("Cancelled during stage \"{stage}\".{kept}");
            Notice::remark(text)
        }
        None => Notice::error(sentence(&error.to_string())),
    }
}
