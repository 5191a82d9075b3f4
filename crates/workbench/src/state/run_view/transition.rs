//! The short transition with which an event is drawn in after a step in time.

use tilescope_core::RunEvent;

use super::RunView;

/// The duration of a transition, in seconds. Chosen, not measured.
pub(in crate::state) const TRANSITION_SECS: f32 = 0.35;
/// The duration where a clip flies from the pattern to its block. Chosen, not measured.
const CLIP_SECS: f32 = 1.0;

/// How far the last event is drawn in.
#[derive(Default)]
pub(super) struct Transition {
    /// The cursor of the last frame.
    cursor: Option<usize>,
    /// The time since it was reached; `None` once the transition is over.
    elapsed_secs: Option<f32>,
    /// Whether a change of the cursor begins a transition.
    is_wanted: bool,
}

impl RunView {
    /// Advances the transition by `dt_secs`; without `is_wanted` there are none. Returns whether it goes on.
    pub(in crate::state) fn advance_transition(&mut self, dt_secs: f32, is_wanted: bool) -> bool {
        let cursor = self.cursor().map(|(cursor, _)| cursor);
        let is_new = cursor != self.transition.cursor;
        let is_first = self.transition.cursor.is_none();
        let elapsed_secs = match self.transition.elapsed_secs {
            // At the first frame of a run there was no step that could be drawn in.
            _ if !is_wanted || is_first => None,
            _ if is_new => Some(0.0),
            elapsed => elapsed.map(|elapsed| elapsed + dt_secs),
        };

        self.transition = Transition {
            cursor,
            elapsed_secs: elapsed_secs.filter(|&elapsed| elapsed < self.transition_secs()),
            is_wanted,
        };
        self.transition.elapsed_secs.is_some()
    }

    /// Returns the duration of the transition to the last event.
    fn transition_secs(&self) -> f32 {
        let shown = self.shown();
        let last = shown.and_then(|shown| shown.last_event()?.run_event());
        match last {
            Some(RunEvent::Clip { .. }) => CLIP_SECS,
            _ => TRANSITION_SECS,
        }
    }

    /// Returns how far the last event is drawn in, from 0 to 1.
    pub(super) fn drawn_in(&self) -> f32 {
        let Transition {
            cursor,
            elapsed_secs,
            is_wanted,
        } = self.transition;
        // A command may have moved the cursor since the last frame. A transition then begins, if one is wanted, or the
        // event is drawn at once.
        let is_new = cursor.is_some() && cursor != self.cursor().map(|(cursor, _)| cursor);
        let share = match elapsed_secs {
            _ if is_new && is_wanted => 0.0,
            Some(elapsed) if !is_new => elapsed / self.transition_secs(),
            _ => 1.0,
        };
        // Smoothstep: the motion begins and ends slowly.
        share * share * (3.0 - 2.0 * share)
    }
}
