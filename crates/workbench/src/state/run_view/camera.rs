//! The camera of a run, and pointing and selecting on its canvas.

use emath::Rect;
use glam::DVec2;
use tilescope_classroom::room::CanvasView;
use tilescope_core::{RunEvent, Stage};
use tilescope_drawing::camera::{Camera, Flight, MAX_SCALE, MIN_SCALE};
use tilescope_session::selection::Selection;
use tilescope_session::units;
use tilescope_session::verification::{Witness, WitnessShape};

use super::RunView;
use crate::command::ViewCommand;
use crate::state::effects::{Context, Effect};

/// The smallest distance at which a selection is kept from the edge of the view, in screen points. Chosen, not measured.
const IN_VIEW: f32 = 32.0;
/// The width of the view around the current event or a sample, in r. It shows a sample among all that can conflict with it, with their
/// neighbours.
const NEIGHBOURHOOD: f64 = 12.0;
/// The width in r from which on a view is narrowed when the camera follows the events. Chosen, not measured.
const FOLLOWED: f64 = 40.0;

impl RunView {
    /// Applies a command to the camera, the selection or the object under the pointer.
    pub(in crate::state) fn apply_to_view(&mut self, command: ViewCommand, context: &mut Context) {
        match command {
            ViewCommand::Viewport(rect) => self.follow_viewport(rect),
            ViewCommand::Pan(delta) => {
                // A picture that the user moves is no longer fitted or framed, and does not fly on.
                (self.flight, self.fitted, self.framed) = (None, false, None);
                self.camera.pan(delta);
            }
            ViewCommand::Zoom(pos, factor) => {
                (self.flight, self.fitted, self.framed) = (None, false, None);
                let scales = self.scales();
                self.camera.zoom_about(self.viewport, pos, factor, scales);
            }

            ViewCommand::SelectMiddle => {
                self.select_middle(context);
                context.ask(Effect::Inspect);
            }
            ViewCommand::Fit => self.fit(context),
            ViewCommand::FlyTo(center, radii) => self.fly_to(center, radii, context),

            ViewCommand::Centre(center) => {
                (self.fitted, self.framed) = (false, None);
                let scale = self.camera.scale;
                self.fly(Camera { center, scale }, context);
            }
            ViewCommand::CopyPosition(place) => {
                if let Some(session) = &self.session {
                    // Places of the window are in r, and a text for other programs is in the unit of the domain.
                    let DVec2 { x, y } = place * session.run().domain.radius();
                    context.ask(Effect::Copy(format!("{x:.6}, {y:.6}")));
                }
            }

            ViewCommand::GoToCurrent => self.go_to_current(context),
            ViewCommand::FlyToBlock(place) => self.fly_to_block(place, context),
            ViewCommand::FlyToWitness(witness) => self.fly_to_witness(witness, context),
            ViewCommand::GoToSample(id) => {
                self.bring_plane(id);
                self.pick(Selection::Sample(id), context);
                if let Some(session) = &self.session {
                    let center = session.position(id);
                    self.fly_to(center, NEIGHBOURHOOD, context);
                }
            }

            ViewCommand::Hover(id) => {
                // Right after a new run the pointer may still name a sample of the run before.
                let is_there = |id: &u32| self.can_select(Selection::Sample(*id));
                self.hovered = id.filter(is_there);
            }

            ViewCommand::Pick(selection) => {
                self.pick(selection, context);
                self.forget_unseen();
            }
            ViewCommand::Inspect => context.ask(Effect::Inspect),
            ViewCommand::Plane(place) => self.show_plane(place, context),
            ViewCommand::StepPlane(steps) => self.step_plane(steps, context),
            ViewCommand::PinPlane(is_pinned) => self.pin_plane(is_pinned, context),
            ViewCommand::Orbit(command) => self.change_orbit(command, context),
        }
    }

    /// Refits a fitted domain, or a place that was flown to, into the new viewport. Unless the domain is fitted, a
    /// selection that was in view stays in view: a panel may open over the part of the canvas where it was picked. If
    /// needed, the camera moves a place that was flown to out of the middle, so that the selection stays in view.
    pub(in crate::state) fn follow_viewport(&mut self, viewport: Rect) {
        let before = std::mem::replace(&mut self.viewport, viewport);
        let camera_before = self.camera;
        if self.fitted && self.session.is_some() {
            self.camera = self.fitting();
            self.flight = None;
        }
        // In an unchanged viewport, as of a run that is put back, the camera shows the framed place already or flies
        // to it.
        if before != viewport
            && let Some((center, radii)) = self.framed
        {
            // A flight that began in the other viewport would end at the wrong scale.
            (self.camera, self.flight) = (self.framing(center, radii), None);
        }
        self.camera = self.within_scales(self.camera);
        // A fitted domain has every place in view.
        if self.fitted {
            return;
        }

        let sample = self
            .selected
            .zip(self.session.as_ref())
            .map(|(id, session)| session.position(id));
        let position = sample.or(self.place);
        // While the pattern is shown, places of the domain are not on the canvas.
        let Some(position) = position.filter(|_| self.before_pattern.is_none()) else {
            return;
        };
        if before.contains(camera_before.screen_from_domain(before, position)) {
            let now = self.camera.screen_from_domain(viewport, position);
            // In a tiny canvas the margin is at most half a side, so that it leaves at least a point.
            let room = viewport.shrink(IN_VIEW.min(0.5 * viewport.size().min_elem()));
            self.camera.pan(room.clamp(now) - now);
        }
    }

    /// Selects the sample nearest to the middle of the view, if one is at most r from it along each axis, otherwise the
    /// place in the middle.
    fn select_middle(&mut self, context: &Context) {
        let Some(shown) = self.shown() else {
            return;
        };

        let middle = self.camera.center;
        let mut best: Option<(f64, u32)> = None;
        // A rectangle without extent, widened by 1 r to each side.
        let reach = 1.0;
        shown.session.index.visit(middle, middle, reach, |seen| {
            let distance = seen.position.distance(middle);
            // The index has all samples of the run, also those that are not there yet.
            let there = shown.standing(seen.id) != tilescope_core::Standing::Absent;
            if there && best.is_none_or(|(least, _)| distance < least) {
                best = Some((distance, seen.id));
            }
        });

        let nearest = best.map_or(Selection::Place(middle), |(_, id)| Selection::Sample(id));
        self.pick(nearest, context);
    }

    /// Returns the size, in r, of the domain or of the pattern, whichever is shown.
    fn shown_size(&self) -> Option<DVec2> {
        let session = self.session.as_ref()?;
        Some(session.size_at(self.current_stage()))
    }

    /// Returns the camera of the canvas for lessons.
    #[must_use]
    pub fn canvas_view(&self) -> CanvasView {
        CanvasView {
            destination: self.destination(),
            is_fitted: self.fitted,
            framed: self.framed.map(|(center, radii)| (center.into(), radii)),
        }
    }

    /// Returns the position of a selected sample, in r; `None` if no sample is selected.
    pub(in crate::state) fn position_of(&self, selection: Selection) -> Option<DVec2> {
        let Selection::Sample(sample) = selection else {
            return None;
        };
        let session = self.session.as_ref()?;
        let is_there = (sample as usize) < session.run().samples.points.len();
        is_there.then(|| session.position(sample))
    }

    /// Returns whether the whole domain is fitted into the canvas, also when the window changes.
    #[must_use]
    pub const fn is_fitted(&self) -> bool {
        self.fitted
    }

    pub(in crate::state) fn fitting(&self) -> Camera {
        // Without a session nothing is drawn, so that any size will do.
        let size = self.shown_size().unwrap_or(DVec2::ONE);
        Camera::fitting(size, self.viewport)
    }

    /// Returns the range of scales allowed for that size; all scales without a session or a canvas.
    fn scales(&self) -> [f64; 2] {
        match self.shown_size() {
            Some(size) if self.viewport.is_positive() => Camera::scales(size, self.viewport),
            _ => [MIN_SCALE, MAX_SCALE],
        }
    }

    /// Returns a camera corrected to the nearest allowed scale.
    pub(in crate::state) fn within_scales(&self, camera: Camera) -> Camera {
        camera.within(self.scales())
    }

    /// Shows the stage at `index` of the session. Every change of the stage goes through this function,
    /// so that the camera follows.
    pub(in crate::state) fn set_stage(&mut self, index: usize) {
        self.stage = index;
        self.follow_pattern();
    }

    /// Fits the pattern when its stage is entered, and restores the camera afterwards.
    pub(in crate::state) fn follow_pattern(&mut self) {
        let on_pattern = self.current_stage() == Some(Stage::Pattern);
        match (on_pattern, self.before_pattern) {
            (true, None) => {
                // The pattern has its own domain, where the run's camera means nothing.
                self.before_pattern = Some((self.camera, self.fitted));
                (self.flight, self.fitted, self.framed) = (None, true, None);
                self.camera = self.fitting();
            }
            (false, Some((camera, fitted))) => {
                // A place that was framed before is shown by its camera, but is no longer framed when the window
                // changes.
                (self.before_pattern, self.flight) = (None, None);
                self.fitted = fitted;
                self.camera = self.within_scales(if fitted { self.fitting() } else { camera });
            }
            // The stage of the pattern is neither entered nor left.
            _ => {}
        }
    }

    pub(in crate::state) fn fly_to(&mut self, center: DVec2, radii: f64, context: &Context) {
        self.fitted = false;
        self.framed = Some((center, radii));
        self.fly(self.framing(center, radii), context);
    }

    /// Takes a camera; if it does not show a place well inside the canvas, flies to the place at the camera's scale.
    pub(in crate::state) fn look_from(&mut self, camera: Camera, place: DVec2, context: &Context) {
        self.take_camera(Some(camera), camera);
        let inner = self.inner_viewport();
        if !inner.contains(self.camera.screen_from_domain(self.viewport, place)) {
            let scale = self.camera.scale;
            self.fly(
                Camera {
                    center: place,
                    scale,
                },
                context,
            );
        }
    }

    /// Returns the part of the canvas where something is well in view. The margin of a fifth was chosen, not measured.
    fn inner_viewport(&self) -> Rect {
        self.viewport.shrink(0.2 * self.viewport.size().min_elem())
    }

    /// Returns the camera that shows the given number of r around a place.
    fn framing(&self, center: DVec2, radii: f64) -> Camera {
        // Without a canvas there is no positive size, and 1 stands for it.
        let room = f64::from(self.viewport.size().min_elem().max(1.0));
        Camera {
            center,
            scale: room / radii,
        }
    }

    /// Returns the place of the last event, in r.
    pub(in crate::state) fn current_place(&self) -> Option<DVec2> {
        let shown = self.shown()?;
        let event = shown.last_event()?;
        let point = shown.debugger?.recording().event_point(event)?;
        Some(units::position(point))
    }

    /// Fits the domain, or the pattern if that is shown, into the canvas.
    pub(in crate::state) fn fit(&mut self, context: &Context) {
        self.witness_mark = None;
        (self.fitted, self.framed) = (true, None);
        // Fitting the pattern also fits the domain when it is shown again.
        if let Some((_, fitted)) = &mut self.before_pattern {
            *fitted = true;
        }
        self.fly(self.fitting(), context);
    }

    fn go_to_current(&mut self, context: &Context) {
        if let Some(place) = self.current_place() {
            self.fly_to(place, NEIGHBOURHOOD, context);
        }
    }

    /// Keeps the last event in view, if the cursor is no longer `before`: flies closer if the view is wide, and at the
    /// same scale to the event if that is near the edge. At the end of a stage, which concerns the whole domain, the
    /// camera stays.
    pub(in crate::state) fn follow_event(
        &mut self,
        before: Option<(usize, usize)>,
        context: &Context,
    ) {
        let ends_stage = self.shown().is_none_or(|shown| shown.ends_stage());
        if !ends_stage && self.cursor() != before {
            self.approach_event(context);
        }
    }

    /// Shows the event that was looked for, with the samples at both of its ends. At the end of the run no such event
    /// was found, and the camera stays.
    pub(in crate::state) fn lead_to_event(&mut self, context: &Context) {
        if !self.is_at_end() {
            self.approach_event(context);
        }
    }

    /// Returns the place of the last event; of one between two samples the place between them, across the border of a
    /// periodic domain where they are nearest.
    fn middle_of_event(&self) -> Option<DVec2> {
        let place = self.current_place()?;
        let event = self.shown()?.last_event()?;
        let session = self.session.as_ref()?;
        // Only a notice that events were left out is no event of the run, and it has no place.
        Some(match event.run_event()? {
            RunEvent::Test {
                pivot: a, other: b, ..
            }
            | RunEvent::Eliminate { sample: a, by: b } => {
                let from = session.position(a);
                from.midpoint(session.image_near(b, from))
            }
            // All other events are at one place.
            _ => place,
        })
    }

    /// Flies to the current event, if it is near the edge of the view, out of sight or too small to be seen.
    fn approach_event(&mut self, context: &Context) {
        let Some(place) = self.middle_of_event() else {
            return;
        };

        // While the camera flies, its destination counts.
        let camera = self.destination();
        // Without a canvas there is no positive size, and 1 stands for it.
        let room = f64::from(self.viewport.size().min_elem().max(1.0));
        let is_wide = room / camera.scale > FOLLOWED;
        let at = camera.screen_from_domain(self.viewport, place);

        if is_wide || !self.inner_viewport().contains(at) {
            // A view that is not wide keeps its width.
            let width = if is_wide {
                NEIGHBOURHOOD
            } else {
                room / camera.scale
            };
            self.fly_to(place, width, context);
        }
    }

    /// Selects a place, and flies to the gap that contains it, otherwise to its block. Where there is neither, as
    /// outside the domain and in sets without blocks, it does nothing.
    fn fly_to_block(&mut self, place: DVec2, context: &Context) {
        let middle_of_gap = self.shown().and_then(|shown| {
            let is_gap = self.geometry.is_gap(&shown, place);
            // Until the extent of the gap is known, the place stands for the deepest place in it.
            let gap = self.geometry.gap_at(&shown, place);
            let middle = gap.map_or(place, |gap| {
                let (deepest, _distance) = gap.deepest;
                deepest
            });
            is_gap.then_some(middle)
        });
        if let Some(middle) = middle_of_gap {
            self.pick(Selection::Place(place), context);
            // Most gaps are smaller than a disk: a view of 5 radii shows one with the disks around it.
            self.fly_to(middle, 5.0, context);
            return;
        }

        let Some(session) = &self.session else {
            return;
        };

        let leaves = &session.run().blocks.leaves;
        // The upper ends do not count, so that a place on a border is in one block only.
        let holds =
            |low: i32, high: i32, at: f64| units::radii(low) <= at && at < units::radii(high);
        let block = leaves.iter().find(|block| {
            let rect = &block.rect;
            holds(rect.min.x, rect.max.x, place.x) && holds(rect.min.y, rect.max.y, place.y)
        });

        if let Some(rect) = block.map(|block| block.rect) {
            self.pick(Selection::Place(place), context);
            let center = units::position(rect.min).midpoint(units::position(rect.max));
            let size = units::radii((rect.max.x - rect.min.x).max(rect.max.y - rect.min.y));
            // The factor leaves some room around the block.
            self.fly_to(center, 1.1 * size, context);
        }
    }

    /// Shows the prefix of nested levels that the verdict is about, otherwise the end of the run, and flies to the
    /// witness.
    pub(in crate::state) fn fly_to_witness(&mut self, witness: Witness, context: &Context) {
        let (Some(session), Some(verdict)) = (&self.session, self.verdict()) else {
            return;
        };
        let Some(witness_mark) = verdict.witness_mark(witness, session) else {
            return;
        };

        let center = match witness_mark.shape {
            WitnessShape::Circle(center, _) => center,
            WitnessShape::Pair([a, b], _) => {
                // In a periodic domain the two may be nearest across the border.
                let from = session.position(a);
                from.midpoint(session.image_near(b, from))
            }
        };

        // A verdict with a claim is about a prefix of nested levels. Any other verdict leads to the end of the run,
        // which shows all dots of a stipple.
        match verdict.claim {
            Some(claim) => self.jump(claim.count),
            None => self.show_stage(session.stages.len() - 1),
        }

        // A pair of a set in space is seen in a plane through one of the two.
        if let WitnessShape::Pair([id, _], _) = witness_mark.shape {
            self.bring_plane(id);
        }
        // The mark comes after the jump, which may remove the one that is there.
        self.witness_mark = Some(witness_mark);
        // A view of 9 radii shows the witness with the samples around it. Chosen, not measured.
        self.fly_to(center, 9.0, context);
    }

    /// Returns the camera; while it flies, the one at the end of the flight.
    pub(in crate::state) fn destination(&self) -> Camera {
        let flight = self.flight.as_ref();
        flight.map_or(self.camera, Flight::destination)
    }

    pub(in crate::state) fn end_flight(&mut self) {
        if let Some(flight) = self.flight.take() {
            self.camera = flight.destination();
        }
    }

    /// Sets the camera, or fits the domain without one; `otherwise` is the camera if there is no canvas yet.
    pub(in crate::state) fn take_camera(&mut self, camera: Option<Camera>, otherwise: Camera) {
        (self.fitted, self.framed) = (camera.is_none(), None);
        self.camera = camera.unwrap_or(otherwise);
        (self.flight, self.before_pattern) = (None, None);
        if self.fitted && self.viewport.is_positive() {
            self.camera = self.fitting();
        }
        self.camera = self.within_scales(self.camera);
        self.follow_pattern();
    }

    /// Advances the flight by `dt_secs`.
    pub(in crate::state) fn fly_on(&mut self, dt_secs: f32) {
        if let Some(flight) = &mut self.flight {
            let (camera, arrived) = flight.advance(dt_secs);
            self.camera = camera;
            if arrived {
                self.flight = None;
            }
        }
    }

    /// Flies, or jumps if motion is reduced.
    fn fly(&mut self, to: Camera, context: &Context) {
        let to = self.within_scales(to);
        if context.reduced_motion {
            (self.camera, self.flight) = (to, None);
        } else {
            self.flight = Some(Flight::new(self.camera, to));
        }
    }
}
