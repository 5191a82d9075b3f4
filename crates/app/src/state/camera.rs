//! The commands that move the view. A place is shown; nothing is computed about it.

use egui::Rect;
use tilescope_core::Stage;

use super::State;
use crate::camera::{Camera, Flight, MAX_SCALE, MIN_SCALE};
use crate::command::ViewCommand;
use crate::layout::Panel;
use crate::selection::Selection;
use crate::units::radii;
use crate::verification::{Sight, Witness};

/// So far within the view, in screen points, is a selection kept.
const IN_VIEW: f32 = 32.0;

impl State {
    pub(super) fn apply_to_view(&mut self, command: ViewCommand) {
        match command {
            ViewCommand::Viewport(rect) => self.follow_viewport(rect),
            ViewCommand::Pan(delta) => {
                (self.runs.first.flight, self.runs.first.fitted) = (None, false);
                self.runs.first.camera.pan(delta);
            }
            ViewCommand::Zoom(pos, factor) => {
                (self.runs.first.flight, self.runs.first.fitted) = (None, false);
                let scales = self.scales();
                self.runs
                    .first
                    .camera
                    .zoom_about(self.runs.first.viewport, pos, factor, scales);
            }
            ViewCommand::SelectMiddle => {
                self.select_middle();
                self.inspect();
            }
            ViewCommand::Fit => {
                self.runs.first.sight = None;
                self.runs.first.fitted = true;
                // Whoever asks for all of the pattern asks for all of the domain, too.
                if let Some((_, fitted)) = &mut self.runs.first.before_pattern {
                    *fitted = true;
                }
                self.fly(self.fitting());
            }
            ViewCommand::FlyTo(center, radii) => self.fly_to(center, radii),
            ViewCommand::GoToCurrent => self.go_to_current(),
            ViewCommand::FlyToBlock(place) => self.fly_to_block(place),
            ViewCommand::FlyToWitness(witness) => self.fly_to_witness(witness),
            ViewCommand::GoToSample(id) => {
                self.pick(Selection::Sample(id));
                if let Some(session) = &self.runs.first.session {
                    let center = session.place(id);
                    self.fly_to(center, 12.0);
                }
            }
            ViewCommand::Hover(id) => self.runs.first.hovered = id,
        }
    }

    /// Fits what is fitted into the new viewport; otherwise a selection that was in view stays in view, as when a panel
    /// opens over the part of the canvas where it was picked.
    fn follow_viewport(&mut self, viewport: Rect) {
        let before = std::mem::replace(&mut self.runs.first.viewport, viewport);
        if self.runs.first.fitted && self.runs.first.session.is_some() {
            self.runs.first.camera = self.fitting();
            self.runs.first.flight = None;
        }
        self.runs.first.camera = self.within_scales(self.runs.first.camera);
        if self.runs.first.fitted {
            return;
        }
        let sample = self
            .runs
            .first
            .selected
            .zip(self.runs.first.session.as_ref());
        let place = sample
            .map(|(id, session)| session.place(id))
            .or(self.runs.first.place);
        let Some(place) = place.filter(|_| self.runs.first.before_pattern.is_none()) else {
            return;
        };
        if before.contains(self.runs.first.camera.screen_from_domain(before, place)) {
            let now = self.runs.first.camera.screen_from_domain(viewport, place);
            let room = viewport.shrink(IN_VIEW.min(0.5 * viewport.size().min_elem()));
            self.runs.first.camera.pan(room.clamp(now) - now);
        }
    }

    /// Selects the sample nearest to the middle of the view, within a radius of it, or else the place.
    fn select_middle(&mut self) {
        let Some(shown) = self.shown() else {
            return;
        };
        let middle = self.runs.first.camera.center;
        let mut best: Option<(f64, u32)> = None;
        shown.session.index.visit(middle, middle, 1.0, |seen| {
            let distance = (seen.place[0] - middle[0]).hypot(seen.place[1] - middle[1]);
            let there = shown.standing(seen.id) != tilescope_core::Standing::Absent;
            if there && best.is_none_or(|(least, _)| distance < least) {
                best = Some((distance, seen.id));
            }
        });
        self.pick(best.map_or(Selection::Place(middle), |(_, id)| Selection::Sample(id)));
    }

    /// Returns the size of what is shown, in r: of the domain, or of the pattern, which has its own.
    fn shown_size(&self) -> Option<[f64; 2]> {
        let session = self.runs.first.session.as_ref()?;
        Some(match self.current_stage() {
            // Its user unit is one radius.
            Some(Stage::Pattern) => session.run().pattern.domain().size(),
            _ => session.size_radii(),
        })
    }

    /// Returns whether the whole domain is shown, and stays so when the window changes.
    #[must_use]
    pub const fn is_fitted(&self) -> bool {
        self.runs.first.fitted
    }

    pub(super) fn fitting(&self) -> Camera {
        let size = self.shown_size().unwrap_or([1.0; 2]);
        Camera::fitting(size, self.runs.first.viewport)
    }

    /// Returns the scales at which what is shown may be looked at; without a session or a canvas all there are.
    fn scales(&self) -> [f64; 2] {
        match self.shown_size() {
            Some(size) if self.runs.first.viewport.is_positive() => {
                Camera::scales(size, self.runs.first.viewport)
            }
            _ => [MIN_SCALE, MAX_SCALE],
        }
    }

    /// Returns a camera brought to the nearest scale at which what is shown may be looked at.
    pub(super) fn within_scales(&self, camera: Camera) -> Camera {
        camera.within(self.scales())
    }

    /// Shows the stage at `place` of the session's list; whatever changes the stage does it here, so that the camera
    /// follows.
    pub(super) fn set_stage(&mut self, place: usize) {
        self.runs.first.stage = place;
        self.follow_pattern();
    }

    /// Fits the pattern when it comes into view, and returns to where the camera was afterwards.
    pub(super) fn follow_pattern(&mut self) {
        let on_pattern = self.current_stage() == Some(Stage::Pattern);
        match (on_pattern, self.runs.first.before_pattern) {
            (true, None) => {
                self.runs.first.before_pattern =
                    Some((self.runs.first.camera, self.runs.first.fitted));
                (self.runs.first.flight, self.runs.first.fitted) = (None, true);
                self.runs.first.camera = self.fitting();
            }
            (false, Some((camera, fitted))) => {
                (self.runs.first.before_pattern, self.runs.first.flight) = (None, None);
                self.runs.first.fitted = fitted;
                self.runs.first.camera = if fitted {
                    self.fitting()
                } else {
                    self.within_scales(camera)
                };
            }
            _ => {}
        }
    }

    pub(super) fn fly_to(&mut self, center: [f64; 2], radii: f64) {
        self.runs.first.fitted = false;
        let room = f64::from(self.runs.first.viewport.size().min_elem().max(1.0));
        let to = Camera {
            center,
            scale: room / radii,
        };
        self.fly(to);
    }

    fn go_to_current(&mut self) {
        let shown = self.shown();
        let place = shown.and_then(|shown| {
            let event = shown.last_event()?;
            shown.debugger?.recording().place(event)
        });
        if let Some(point) = place {
            self.fly_to([radii(point.x), radii(point.y)], 12.0);
        }
    }

    /// Flies to the gap that holds a place, else to its block.
    fn fly_to_block(&mut self, place: [f64; 2]) {
        let gap = self.shown().and_then(|shown| {
            let tessellation = self.runs.first.geometry.of(&shown)?;
            let gap = tessellation.gap_at(place)?;
            Some(tessellation.gaps[gap].deepest.0)
        });
        if let Some(deepest) = gap {
            self.pick(Selection::Place(place));
            self.fly_to(deepest, 5.0);
            return;
        }
        let Some(session) = &self.runs.first.session else {
            return;
        };
        let leaves = &session.run().blocks.leaves;
        let holds = |low: i32, high: i32, at: f64| radii(low) <= at && at < radii(high);
        let block = leaves.iter().find(|block| {
            let rect = &block.rect;
            holds(rect.min.x, rect.max.x, place[0]) && holds(rect.min.y, rect.max.y, place[1])
        });
        if let Some(rect) = block.map(|block| block.rect) {
            self.pick(Selection::Place(place));
            let center = [(rect.min.x, rect.max.x), (rect.min.y, rect.max.y)]
                .map(|(low, high)| f64::midpoint(radii(low), radii(high)));
            let size = radii((rect.max.x - rect.min.x).max(rect.max.y - rect.min.y));
            self.fly_to(center, 1.1 * size);
        }
    }

    pub(super) fn fly_to_witness(&mut self, witness: Witness) {
        let (Some(session), Some(verdict)) = (&self.runs.first.session, self.verdict()) else {
            return;
        };
        let Some(sight) = verdict.sight(witness, session) else {
            return;
        };
        let center = match sight {
            Sight::Circle(center, _) => center,
            Sight::Pair([a, b], _) => {
                let from = session.place(a);
                let to = session.image_near(b, from);
                [0, 1].map(|k| f64::midpoint(from[k], to[k]))
            }
        };
        // The verdict is about the result.
        let last = session.stages.len() - 1;
        self.show_stage(last);
        self.runs.first.sight = Some(sight);
        self.fly_to(center, 9.0);
    }

    /// Returns what the user chose of motion, if anything.
    #[must_use]
    pub const fn motion_chosen(&self) -> Option<bool> {
        self.appearance.motion_chosen
    }

    /// Takes up what the user chose, now or earlier.
    pub fn choose_motion(&mut self, chosen: Option<bool>) {
        if let Some(reduced) = chosen {
            self.appearance.motion_chosen = chosen;
            self.reduce_motion(reduced);
        }
    }

    /// Takes up what the system prefers, which counts until the user chooses.
    pub fn prefer_reduced_motion(&mut self, reduced: bool) {
        if self.appearance.motion_chosen.is_none() {
            self.reduce_motion(reduced);
        }
    }

    /// A flight at work ends where it leads.
    fn reduce_motion(&mut self, reduced: bool) {
        self.appearance.reduced_motion = reduced;
        if reduced {
            self.end_flight();
        }
    }

    pub(super) fn end_flight(&mut self) {
        if let Some(flight) = self.runs.first.flight.take() {
            self.runs.first.camera = flight.destination();
        }
    }

    /// Brings what is known of the selection into view, if there is a selection and the window has panels.
    pub(super) fn inspect(&mut self) {
        let is_selected = self.runs.first.selected.is_some() || self.runs.first.place.is_some();
        if is_selected && self.window.embedding.is_none() {
            self.window.open_panel(Panel::Inspector);
        }
    }

    /// Flies, or jumps where motion is reduced.
    fn fly(&mut self, to: Camera) {
        let to = self.within_scales(to);
        if self.appearance.reduced_motion {
            (self.runs.first.camera, self.runs.first.flight) = (to, None);
        } else {
            self.runs.first.flight = Some(Flight::new(self.runs.first.camera, to));
        }
    }
}
