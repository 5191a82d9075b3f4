//! The comparison in the state: its commands, and how the second run follows the first. [`crate::compare`] computes the
//! differences.

use std::sync::Arc;

use tilescope_debugger::{DEFAULT_BUDGET, Debugger, Divergence, OutlineRows};
use tilescope_session::recipe::Recipe;

use super::{RunView, State};
use crate::command::{Command, ViewCommand, Which};
use crate::compare::link::{common, corresponding};
use crate::compare::{CompareCommand, ComparePreset, Comparison};
use crate::device::EngineChoice;
use crate::draft::Draft;
use crate::layout::Panel;
use tilescope_drawing::subject::{Contrast, Subject};
use tilescope_session::layers::SessionKind;
use tilescope_session::moment::Moment;
use tilescope_session::session::Session;

impl State {
    pub(super) fn apply_to_comparison(&mut self, command: CompareCommand) {
        match command {
            CompareCommand::Start(preset) => self.start_comparison(preset),
            CompareCommand::Keep => self.keep(),
            CompareCommand::Swap => self.swap(),
            CompareCommand::Close => self.runs.second = None,
            CompareCommand::GoToDivergence => self.go_to_divergence(),
            CompareCommand::LinkCameras(on) => self.set(|known| known.linked_cameras = on),
            CompareCommand::LinkPlayback(on) => self.set(|known| known.linked_playback = on),
            CompareCommand::ShowDifferences(on) => self.set(|known| known.shows_differences = on),
        }
    }

    fn set(&mut self, change: impl FnOnce(&mut Comparison)) {
        if let Some((_, comparison)) = &mut self.runs.second {
            change(comparison);
        }
    }

    /// Returns why this second run cannot be made now, or `None` if it can.
    #[must_use]
    pub fn preset_refusal(&self, preset: ComparePreset) -> Option<String> {
        let Some(session) = &self.runs.first.session else {
            return Some("There is no session yet.".to_owned());
        };
        if preset == ComparePreset::Typed {
            return self.run_refusal();
        }
        match session.kind() {
            SessionKind::Run => {}
            SessionKind::Combination => return Some(super::combine::NO_PARAMETERS.to_owned()),
            SessionKind::Nested => {
                let text = "Nested levels have no variants like those of a run; the parameters as typed can be compared.";
                return Some(text.to_owned());
            }
        }
        if preset == ComparePreset::Engine && self.other_engine() == EngineChoice::Gpu {
            return self.gpu.device.not_ready();
        }
        let first = &session.run().parameters;
        let second = preset.parameters(first, &self.form.draft.parameters);
        let refused = second.validate_sequential().err();
        refused.map(|error| tilescope_session::words::sentence(&error.to_string()))
    }

    /// Returns the sessions of the two runs, and the comparison.
    fn compared(&self) -> Option<[&Arc<Session>; 2]> {
        let (side, _) = self.runs.second.as_ref()?;
        Some([self.runs.first.session.as_ref()?, side.session.as_ref()?])
    }

    /// Returns why the window cannot go to the divergence of the two runs, or `None` if it can.
    #[must_use]
    pub fn parting_refusal(&self) -> Option<&'static str> {
        let Some((_, comparison)) = &self.runs.second else {
            return Some("There is no second run.");
        };
        let Some([first, second]) = self.compared() else {
            return Some("The second run is not ready yet.");
        };
        match comparison.divergence(first, second) {
            None => Some("The search for where they diverge is still running."),
            Some(Divergence::Same) => Some("They never diverge."),
            Some(Divergence::Domain { .. }) => Some("Their domains differ from the start."),
            Some(_) => None,
        }
    }

    /// Returns the engine other than the one that made the session.
    fn other_engine(&self) -> EngineChoice {
        match &self.runs.first.session {
            Some(session) if session.engine != "CPU" => EngineChoice::Cpu,
            _ => EngineChoice::Gpu,
        }
    }

    fn start_comparison(&mut self, preset: ComparePreset) {
        if self.preset_refusal(preset).is_some() {
            return;
        }
        let Some(session) = &self.runs.first.session else {
            return;
        };
        let recipe = match preset {
            ComparePreset::Typed => self.typed(),
            _ => Recipe {
                parameters: preset
                    .parameters(&session.run().parameters, &self.form.draft.parameters),
                own: session.own.clone(),
                nested: None,
            },
        };
        let engine = match preset {
            ComparePreset::Engine => self.other_engine(),
            _ => self.gpu.engine,
        };
        self.window.open_panel(Panel::Compare);
        self.compare_with(recipe, engine);
    }

    pub(super) fn compare_with(&mut self, recipe: Recipe, engine: EngineChoice) {
        let (side, _) = self.runs.second.get_or_insert_default();
        let is_linked = recipe.own.is_none() && recipe.nested.is_none();
        side.asked = is_linked.then_some(recipe.parameters);
        self.start_sampling(Which::Second, recipe, engine);
    }

    /// Makes the current run also the second one, at the same moment.
    fn keep(&mut self) {
        let Some(session) = self.runs.first.session.clone() else {
            return;
        };
        let cursor = self.cursor();
        self.window.open_panel(Panel::Compare);
        let (side, _) = self.runs.second.get_or_insert_default();
        let viewport = side.viewport;
        *side = RunView::default();
        let recording = session.recording().map(Arc::clone);
        side.debugger = recording.map(|recording| Debugger::new(recording, DEFAULT_BUDGET));
        if let (Some(debugger), Some((cursor, _))) = (&mut side.debugger, cursor) {
            debugger.jump(cursor);
        }
        side.rows = session.outline.as_ref().map(OutlineRows::new);
        let first = &self.runs.first;
        (side.stage, side.camera, side.viewport) = (first.stage, first.camera, viewport);
        (side.fitted, side.before_pattern) = (first.fitted, first.before_pattern);
        side.show_whole(session.summary.count);
        side.session = Some(session);
        self.on(Which::Second, |run, context| run.verify(context));
    }

    /// Swaps the two runs; the form then shows the parameters of the new first run.
    fn swap(&mut self) {
        if let Some((mut side, comparison)) = self.runs.second.take() {
            let viewports = (self.runs.first.viewport, side.viewport);
            // Breakpoints, watches and scenes stay with the first run, as the panels show them.
            let stops = self.runs.first.take_stops();
            std::mem::swap(&mut self.runs.first, &mut side);
            (self.runs.first.viewport, side.viewport) = viewports;
            self.time.playback.range = None;
            self.on(Which::First, |run, context| run.put_stops(stops, context));
            self.runs.second = Some((side, comparison));
        }
        if let Some(session) = &self.runs.first.session
            && session.has_recipe()
        {
            let recipe = session.recipe();
            self.form.draft = Draft::from_parameters(recipe.parameters).with_nesting(recipe.nested);
            self.form.own_pattern.clone_from(&session.own);
            self.forget_changes();
        }
    }

    /// Applies a command to the view of the second run, and to the first, too, if the cameras are linked.
    pub(super) fn apply_to_second_view(&mut self, command: ViewCommand) {
        let before = self.second_at();
        let moves = Command::View(Which::Second, command).rules().moves_camera;
        self.on(Which::Second, |run, context| {
            run.apply_to_view(command, context);
        });
        let after = self.second_at();
        let Some((side, comparison)) = &mut self.runs.second else {
            return;
        };
        if moves && comparison.linked_cameras {
            (self.runs.first.camera, self.runs.first.fitted) = (side.camera, side.fitted);
            self.runs.first.flight = side.flight.take();
        }
        if comparison.linked_playback && before != after {
            self.follow_second();
        }
    }

    fn second_at(&self) -> Option<Moment> {
        self.runs.second.as_ref()?.0.moment()
    }

    fn follow_second(&mut self) {
        let (Some(at), Some([first, second])) = (self.second_at(), self.compared()) else {
            return;
        };
        let common = self.common().map(|[a, b]| [b, a]);
        let to = corresponding(second, at, first, common);
        self.runs.first.go_to(to);
    }

    /// Returns the cursors up to which the two runs are equal, if they are known.
    fn common(&self) -> Option<[usize; 2]> {
        let (_, comparison) = self.runs.second.as_ref()?;
        let [first, second] = self.compared()?;
        common(first, second, comparison.divergence(first, second))
    }

    /// Makes the second run follow the first as far as the two are linked.
    pub(super) fn follow_first(&mut self) {
        let Some((side, comparison)) = &mut self.runs.second else {
            return;
        };
        if comparison.linked_cameras {
            (side.camera, side.fitted, side.flight) =
                (self.runs.first.camera, self.runs.first.fitted, None);
        }
        if !comparison.linked_playback {
            return;
        }
        let (Some(at), Some([first, second])) = (self.runs.first.moment(), self.compared()) else {
            return;
        };
        let to = corresponding(first, at, second, self.common());
        if self.second_at() != Some(to) {
            self.on(Which::Second, |run, _| run.go_to(to));
        }
    }

    /// Advances the second run by `dt_secs`; returns whether something moves.
    pub(super) fn advance_second(&mut self, dt_secs: f32) -> bool {
        self.poll_run(Which::Second);
        let with_geometry = self.wants_geometry();
        let flies = self.on(Which::Second, |run, context| {
            run.fly_on(dt_secs);
            run.follow_prefix(dt_secs, context);
            if with_geometry {
                run.want_geometry(context);
            }
            run.flight.is_some() || run.awaits_rest()
        });
        self.follow_first();
        self.compare();
        flies == Some(true)
    }

    /// Starts computing the differences.
    fn compare(&mut self) {
        let Some((side, mut comparison)) = self.runs.second.take() else {
            return;
        };
        let first = self.runs.first.session.as_ref().zip(self.shown());
        let second = side.session.as_ref().zip(side.shown());
        if let (Some((first, a)), Some((second, b))) = (first, second) {
            comparison.seek(first, second, &self.jobs.wake);
            let moments = [(first, &a), (second, &b)];
            comparison.differences.want(moments, &self.jobs.wake);
        }
        self.runs.second = Some((side, comparison));
    }

    /// Waits for all work on the second run.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn settle_second(&mut self) {
        self.settle_run(Which::Second);
        self.compare();
        if let Some((_, comparison)) = &mut self.runs.second {
            comparison.settle();
        }
        self.follow_first();
        self.compare();
        if let Some((_, comparison)) = &mut self.runs.second {
            comparison.differences.settle();
        }
    }

    /// Goes to the divergence of the two runs: in both, the first event that differs is the last one that has
    /// happened.
    fn go_to_divergence(&mut self) {
        let (Some((_, comparison)), Some([first, second])) = (&self.runs.second, self.compared())
        else {
            return;
        };
        let cursors = match comparison.divergence(first, second) {
            Some(&Divergence::Events { a, b, .. }) => [a, b],
            Some(&Divergence::Ends { event, .. }) => [event, event],
            Some(&Divergence::Stage { stage, .. }) => {
                let index = first.stages.iter().position(|&other| other == stage);
                self.runs.first.show_stage(index.unwrap_or(usize::MAX));
                return;
            }
            _ => return,
        };
        // The moment after the event shows what differs.
        self.runs.first.jump(cursors[0] + 1);
        self.apply_to_view(ViewCommand::GoToCurrent);
        self.on(Which::Second, |run, _| run.jump(cursors[1] + 1));
    }

    /// Returns the samples that only one of two compared runs has, seen from the second one or the first.
    #[must_use]
    pub fn contrast(&self, from_second: bool) -> Option<Contrast<'_>> {
        let (side, comparison) = self.runs.second.as_ref()?;
        let (a, b) = (self.shown()?, side.shown()?);
        let difference = comparison.differences.of(&a, &b)?;
        let (first, second) = (&difference.first[..], &difference.second[..]);
        let (here, there, other) = if from_second {
            (second, first, a.session)
        } else {
            (first, second, b.session)
        };
        let contrast = Contrast { here, there, other };
        comparison.shows_differences.then_some(contrast)
    }

    /// Returns the subject of the second canvas.
    #[must_use]
    pub fn second_subject(&self) -> Option<Subject<'_>> {
        let (side, _) = self.runs.second.as_ref()?;
        side.subject(&self.appearance, self.contrast(true))
    }
}
