//! The comparison of the two runs: its commands, and how the second run follows the first. [`crate::compare`] computes the
//! differences.

use std::sync::Arc;

use tilescope_debugger::{DEFAULT_BUDGET, Debugger, Divergence, OutlineRows};
use tilescope_session::recipe::Recipe;

use super::effects::{Context, Effect};
use super::run_view::Asked;
use super::{Appearance, Form, GpuState, RunView, Runs};
use crate::command::{Command, ViewCommand, Which};
use crate::compare::link::{common, corresponding};
use crate::compare::{CompareCommand, ComparePreset, Comparison};
use crate::device::EngineChoice;
use crate::draft::Draft;
use crate::layout::Panel;
use tilescope_drawing::brushed::BrushedCause;
use tilescope_drawing::subject::{Contrast, Subject};
use tilescope_session::jobs::Wake;
use tilescope_session::layers::SessionKind;
use tilescope_session::moment::Moment;
use tilescope_session::session::Session;

/// Why a set in a field or a shape has no second run of changed parameters.
const OF_GROUND: &str = "A set in a field or a shape has no variants like those of a run; the parameters as typed can be compared.";

impl Runs {
    /// Applies a command. A second run may be made of the parameters as typed, by the chosen engine.
    pub(super) fn apply(
        &mut self,
        command: CompareCommand,
        form: &Form,
        gpu: &GpuState,
        context: &mut Context,
    ) {
        match command {
            CompareCommand::Start(preset) => self.start_comparison(preset, form, gpu, context),
            CompareCommand::Keep => self.keep(context),
            CompareCommand::Swap => self.swap(context),
            CompareCommand::Close => self.second = None,
            CompareCommand::GoToDivergence => self.go_to_divergence(context),
            CompareCommand::LinkCameras(on) => {
                self.set(|comparison| comparison.linked_cameras = on);
            }
            CompareCommand::LinkPlayback(on) => {
                self.set(|comparison| comparison.linked_playback = on);
            }
            CompareCommand::ShowDifferences(on) => {
                self.set(|comparison| comparison.shows_differences = on);
            }
        }
    }

    fn set(&mut self, change: impl FnOnce(&mut Comparison)) {
        if let Some((_, comparison)) = &mut self.second {
            change(comparison);
        }
    }

    /// Returns why this second run cannot be made now, or `None` if it can.
    #[must_use]
    pub fn preset_refusal(
        &self,
        preset: ComparePreset,
        form: &Form,
        gpu: &GpuState,
    ) -> Option<String> {
        let Some(session) = &self.first.session else {
            return Some("There is no session yet.".to_owned());
        };

        if preset == ComparePreset::Typed {
            return form.refusal(gpu);
        }

        match session.kind() {
            // The variants would be of the whole domain.
            SessionKind::Exact if session.ground.is_some() => return Some(OF_GROUND.to_owned()),
            SessionKind::Run | SessionKind::Exact => {}
            SessionKind::Combination => return Some(super::engine::NO_PARAMETERS.to_owned()),
            SessionKind::Varying => return Some(OF_GROUND.to_owned()),
            SessionKind::Solid => {
                let text = "A set in space has no variants like those of a run; the parameters as typed can be compared.";
                return Some(text.to_owned());
            }
            SessionKind::Nested => {
                let text = "Nested levels have no variants like those of a run; the parameters as typed can be compared.";
                return Some(text.to_owned());
            }
        }

        if preset == ComparePreset::Engine && self.other_engine() == EngineChoice::Gpu {
            // A GPU must have passed its test; the CPU is always ready. The parameters stay the same, so that they are valid.
            return gpu.device.not_ready();
        }

        let first = &session.run().parameters;
        let second = preset.parameters(first, &form.draft.parameters);
        let own = session.own.clone();
        let recipe = Recipe {
            own,
            ..Recipe::from(second)
        };

        // The changed parameter may be invalid together with the others.
        let refused = second
            .validate_sequential()
            .err()
            .or_else(|| recipe.check().err());
        refused.map(|error| tilescope_session::words::sentence(&error.to_string()))
    }

    /// Returns the sessions of the two runs, once both are there.
    fn compared(&self) -> Option<[&Arc<Session>; 2]> {
        let (side, _) = self.second.as_ref()?;
        Some([self.first.session.as_ref()?, side.session.as_ref()?])
    }

    /// Returns why the window cannot go to the divergence of the two runs, or `None` if it can.
    #[must_use]
    pub fn parting_refusal(&self) -> Option<&'static str> {
        let Some((_, comparison)) = &self.second else {
            return Some("There is no second run.");
        };
        let Some([first, second]) = self.compared() else {
            return Some("The second run is not ready yet.");
        };
        match comparison.divergence(first, second) {
            None if comparison.failure().is_some() => {
                Some("The search for where they diverge has failed.")
            }
            None => Some("The search for where they diverge is still running."),
            Some(Divergence::Same) => Some("They never diverge."),
            Some(Divergence::Domain { .. }) => Some("Their domains differ from the start."),
            Some(_) => None,
        }
    }

    /// Returns the engine other than the one that made the session.
    fn other_engine(&self) -> EngineChoice {
        match &self.first.session {
            Some(session) if session.engine != "CPU" => EngineChoice::Cpu,
            _ => EngineChoice::Gpu,
        }
    }

    /// Starts the second run of a preset; does nothing if that is refused.
    fn start_comparison(
        &mut self,
        preset: ComparePreset,
        form: &Form,
        gpu: &GpuState,
        context: &mut Context,
    ) {
        // Menus show the reason, but a script may issue the command nevertheless.
        if self.preset_refusal(preset, form, gpu).is_some() {
            return;
        }
        let Some(session) = &self.first.session else {
            return;
        };

        let recipe = match preset {
            ComparePreset::Typed => form.recipe(),
            _ => Recipe {
                parameters: preset.parameters(&session.run().parameters, &form.draft.parameters),
                own: session.own.clone(),
                // Nested levels, fields, shapes and sets in space were refused above.
                nested: None,
                ground: None,
                depth: None,
            },
        };

        let engine = match preset {
            ComparePreset::Engine => self.other_engine(),
            _ => gpu.engine,
        };

        context.ask(Effect::OpenPanel(Panel::Compare));
        self.compare_with(recipe, engine, context);
    }

    /// Starts making the second run of a recipe by an engine.
    pub(super) fn compare_with(
        &mut self,
        recipe: Recipe,
        engine: EngineChoice,
        context: &mut Context,
    ) {
        let (side, _) = self.second.get_or_insert_default();
        // A link can name the run only by its parameters.
        let is_planar_run = recipe.nested.is_none() && recipe.depth.is_none();
        let can_be_linked = is_planar_run && recipe.own.is_none() && recipe.ground.is_none();
        side.asked = can_be_linked.then_some(recipe.parameters);
        context.ask(Effect::Sample(Which::Second, Box::new(recipe), engine));
    }

    /// Makes the current run also the second one, at the same moment; nested levels and stipples with all of their samples.
    fn keep(&mut self, context: &mut Context) {
        let Some(session) = self.first.session.clone() else {
            return;
        };
        let cursor_and_end = self.first.cursor();
        context.ask(Effect::OpenPanel(Panel::Compare));

        let (side, _) = self.second.get_or_insert_default();
        // The second run begins anew: of the old one only its place in the window stays.
        let viewport = side.viewport;
        *side = RunView::default();

        // The two runs share the recording, and each has its own cursor.
        let recording = session.recording().map(Arc::clone);
        side.debugger = recording.map(|recording| Debugger::new(recording, DEFAULT_BUDGET));
        if let (Some(debugger), Some((cursor, _))) = (&mut side.debugger, cursor_and_end) {
            debugger.jump(cursor);
        }
        side.rows = session.outline.as_ref().map(OutlineRows::new);

        // It is seen as the first one is.
        let first = &self.first;
        (side.stage, side.camera, side.viewport) = (first.stage, first.camera, viewport);
        (side.fitted, side.before_pattern) = (first.fitted, first.before_pattern);
        // Sessions without prefixes are not changed by this.
        side.show_whole(session.summary.count);
        side.session = Some(session);

        side.verify(context);
    }

    /// Swaps the two runs, if there are two. The form then shows the parameters of the first one.
    fn swap(&mut self, context: &mut Context) {
        // A script may ask for it without a second run.
        let Some((mut side, comparison)) = self.second.take() else {
            return;
        };

        // A viewport belongs to a place in the window, so that it is not swapped.
        let viewports = (self.first.viewport, side.viewport);
        // Breakpoints, watches and scenes stay in the first place, whichever run is there, as the panels show them.
        let stops = self.first.take_stops();
        std::mem::swap(&mut self.first, &mut side);
        (self.first.viewport, side.viewport) = viewports;
        // With linked cameras the second run's plane was pinned at the place of the first run's plane. After the swap,
        // the plane of the run that is now the first one follows the events exactly if that of the first run did so
        // before.
        if comparison.linked_cameras {
            self.first.pin_as(&side);
        }

        // The loop counts events of the run that the panels showed before.
        context.ask(Effect::EndLoop);
        self.first.put_stops(stops, context);
        self.second = Some((side, comparison));

        if let Some(session) = &self.first.session
            && session.has_recipe()
        {
            let recipe = session.recipe();
            context.ask(Effect::Form(Box::new(Form {
                draft: Draft::from_parameters(recipe.parameters)
                    .with_nesting(recipe.nested)
                    .with_ground(recipe.ground.as_deref())
                    .with_depth(recipe.depth),
                own_pattern: session.own.clone(),
                // The effect takes only the draft and the pattern of this form (`Form::take`).
                ..Form::default()
            })));
            // The steps to undo belong to the run that was the first one before.
            context.ask(Effect::Forget);
        }
    }

    /// Applies a command to the view of the second run. If the cameras or the playback are linked, the first run follows.
    pub(super) fn apply_to_second_view(&mut self, command: ViewCommand, context: &mut Context) {
        let before = self.second_at();
        let moves = Command::View(Which::Second, command).rules().moves_camera;
        if let Some((side, _)) = &mut self.second {
            side.apply_to_view(command, context);
        }

        let after = self.second_at();
        let Some((side, comparison)) = &mut self.second else {
            return;
        };

        if moves && comparison.linked_cameras {
            (self.first.camera, self.first.fitted) = (side.camera, side.fitted);
            // Only the first camera flies, and the second follows it in every frame.
            self.first.flight = side.flight.take();
            self.first.follow_orbit(side);
        }

        if comparison.linked_playback && before != after {
            self.follow_second();
        }
    }

    fn second_at(&self) -> Option<Moment> {
        self.second.as_ref()?.0.moment()
    }

    fn follow_second(&mut self) {
        let (Some(at), Some([first, second])) = (self.second_at(), self.compared()) else {
            return;
        };
        // The run that the other one follows comes first, here the second.
        let common = self.common_cursors().map(|[a, b]| [b, a]);
        let to = corresponding(second, at, first, common);
        self.first.go_to(to);
    }

    /// Returns the cursors up to which the two runs are equal, if they are known.
    fn common_cursors(&self) -> Option<[usize; 2]> {
        let (_, comparison) = self.second.as_ref()?;
        let [first, second] = self.compared()?;
        common(first, second, comparison.divergence(first, second))
    }

    /// Makes the second run follow the first as far as the two are linked.
    pub(super) fn follow_first(&mut self) {
        let Some((side, comparison)) = &mut self.second else {
            return;
        };
        if comparison.linked_cameras {
            // The camera is copied in every frame, so that it needs no flight of its own.
            (side.camera, side.fitted, side.flight) = (self.first.camera, self.first.fitted, None);
            // The same place is seen in both only in the same plane.
            side.follow_plane(&self.first);
            side.follow_orbit(&self.first);
        }

        if !comparison.linked_playback {
            return;
        }

        let (Some(at), Some([first, second])) = (self.first.moment(), self.compared()) else {
            return;
        };
        let to = corresponding(first, at, second, self.common_cursors());
        if self.second_at() != Some(to)
            && let Some((side, _)) = &mut self.second
        {
            side.go_to(to);
        }
    }

    /// Advances the second run by `dt_secs`, and its measures as far as they are `asked` for. Returns whether something moves.
    pub(super) fn advance_second(
        &mut self,
        dt_secs: f32,
        asked: Asked,
        context: &mut Context,
    ) -> bool {
        let moves = self.second.as_mut().is_some_and(|(run, _)| {
            run.fly_on(dt_secs);
            run.follow_prefix(dt_secs, context);
            run.follow_moment(asked, context);
            run.flight.is_some() || run.awaits_rest()
        });
        self.follow_first();
        self.compare(&context.wake);
        moves
    }

    /// Starts computing the differences.
    fn compare(&mut self, wake: &Wake) {
        let Some((side, mut comparison)) = self.second.take() else {
            return;
        };
        let first = self.first.session.as_ref().zip(self.first.shown());
        let second = side.session.as_ref().zip(side.shown());
        if let (Some((first, a)), Some((second, b))) = (first, second) {
            comparison.seek(first, second, wake);
            let moments = [(first, &a), (second, &b)];
            comparison.differences.want(moments, wake);
        }
        self.second = Some((side, comparison));
    }

    /// Waits for the comparison.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn settle_comparison(&mut self, wake: &Wake) {
        self.compare(wake);
        if let Some((_, comparison)) = &mut self.second {
            comparison.settle();
        }
        // By the divergence the second run may have moved, and the differences are then those of another moment.
        self.follow_first();
        self.compare(wake);
        if let Some((_, comparison)) = &mut self.second {
            comparison.differences.settle();
        }
    }

    /// Goes to the divergence of the two runs: in both, the first event that differs is the last one that has
    /// happened.
    fn go_to_divergence(&mut self, context: &mut Context) {
        let (Some((_, comparison)), Some([first, second])) = (&self.second, self.compared()) else {
            return;
        };

        let events = match comparison.divergence(first, second) {
            Some(&Divergence::Events { a, b, .. }) => [a, b],
            Some(&Divergence::Ends { event, .. }) => [event, event],
            // Of runs without events, only the stage in which they differ is known.
            Some(&Divergence::Stage { stage, .. }) => {
                let index_in = |session: &Arc<Session>| {
                    let index = session.stages.iter().position(|&other| other == stage);
                    // A run without this stage shows its last one.
                    index.unwrap_or(usize::MAX)
                };
                let [index_a, index_b] = [first, second].map(index_in);
                self.first.show_stage(index_a);
                // The second run is moved here, as it follows the first one only with linked playback.
                if let Some((side, _)) = &mut self.second {
                    side.show_stage(index_b);
                }
                return;
            }
            // The runs are the same, or not compared yet, or their domains differ: there is no event to go to.
            _ => return,
        };

        // The moment right after an event shows what differs. A cursor is the number of events before its moment.
        let [after_a, after_b] = events.map(|event| event + 1);
        self.first.jump(after_a);
        // The camera of the second run follows if the two are linked. Otherwise it stays where the user has put it.
        self.first.apply_to_view(ViewCommand::GoToCurrent, context);
        if let Some((side, _)) = &mut self.second {
            side.jump(after_b);
        }
    }

    /// Returns the samples that only one of two compared runs has, seen from the second one or the first.
    #[must_use]
    pub fn contrast(&self, from_second: bool) -> Option<Contrast<'_>> {
        let (side, comparison) = self.second.as_ref()?;
        let (a, b) = (self.first.shown()?, side.shown()?);
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

    /// Returns the subject of a run's canvas; `causes` are those of the brush, which only the first run has.
    #[must_use]
    pub fn subject<'a>(
        &'a self,
        which: Which,
        appearance: &Appearance,
        causes: Option<&'a BrushedCause>,
    ) -> Option<Subject<'a>> {
        let contrast = self.contrast(which == Which::Second);
        self.get(which)?.subject(appearance, contrast, causes)
    }
}
