//! Touch gestures on a canvas. A lifted finger ends a tap only if no second finger has touched since the first. This module
//! only interprets events; `panes/input.rs` of `tilescope-app` pans and selects.

use egui::{Event, Id, Pos2, RawInput, Response, TouchPhase, Ui, Vec2, pos2};

/// A gesture of two or more fingers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pinch {
    /// The place halfway between the fingers.
    pub middle: Pos2,
    /// How far they moved together, in screen points.
    pub moved: Vec2,
    /// How much farther apart they are than before.
    pub factor: f32,
}

/// The device that moves the pointer in this frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hand {
    /// A mouse, or no pointer.
    #[default]
    Mouse,
    /// One finger, which may just have been lifted.
    Finger,
    /// Two fingers have touched since the first, so lifting them is no tap.
    Gesture,
    /// The system cancelled the touch.
    Cancelled,
}

/// The touch state of this frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Touch {
    /// The device that moves the pointer.
    pub hand: Hand,
    /// The gesture of two fingers that began on this canvas.
    pub pinch: Option<Pinch>,
}

impl Touch {
    /// Returns the touch state on the canvas of `response`; stores the parts of a gesture that the next frame needs.
    #[must_use]
    pub fn follow(ui: &Ui, response: &Response) -> Self {
        let (is_down, multi, starts, is_lifted, is_cancelled) = ui.input(|input| {
            let count = |wanted: TouchPhase| {
                let of = move |event: &&Event| matches!(event, Event::Touch { phase, .. } if *phase == wanted);
                input.events.iter().filter(of).count()
            };
            (
                input.any_touches(),
                input.multi_touch(),
                count(TouchPhase::Start),
                count(TouchPhase::End) > 0,
                count(TouchPhase::Cancel) > 0,
            )
        });

        let id = Id::unique("fingers").with(response.id);
        let before = ui
            .data(|data| data.get_temp::<Before>(id))
            .unwrap_or_default();

        // A second finger makes a gesture, even if it comes down in the same frame as the first. A gesture lasts until all fingers
        // are lifted.
        let is_gesture = before.is_gesture || multi.is_some() || starts > 1;

        // A gesture belongs to the canvas on which it began.
        let begins_here = response.is_pointer_button_down_on() || before.is_here;
        let is_here = multi.is_some() && begins_here;
        let now = Before {
            is_gesture: is_gesture && is_down,
            is_here,
        };
        ui.data_mut(|data| data.insert_temp(id, now));

        let pinch = multi.filter(|_| is_here).map(|touch| Pinch {
            middle: touch.center_pos,
            moved: touch.translation_delta,
            factor: touch.zoom_delta,
        });

        let hand = if is_cancelled {
            Hand::Cancelled
        } else if is_gesture {
            Hand::Gesture
        } else if is_down || is_lifted {
            Hand::Finger
        } else {
            Hand::Mouse
        };

        Self {
            hand,
            // While two fingers are at one place, the ratio of distances is not a number.
            pinch: pinch.filter(|pinch| pinch.factor.is_finite() && pinch.factor > 0.0),
        }
    }
}

/// State kept from frame to frame.
#[derive(Clone, Copy, Debug, Default)]
struct Before {
    /// Whether a second finger has touched, and fingers are still down.
    is_gesture: bool,
    /// Whether two fingers are down in a gesture that began on this canvas.
    is_here: bool,
}

/// Far outside of every window.
const NOWHERE: Pos2 = pos2(-1e4, -1e4);

/// Moves the pointer out of the window when the system cancels a touch. The cancellation neither releases nor moves the
/// pointer, which would stay pressed.
pub fn release_cancelled(raw: &mut RawInput) {
    let cancelled = |event: &Event| {
        matches!(
            event,
            Event::Touch {
                phase: TouchPhase::Cancel,
                ..
            }
        )
    };
    if raw.events.iter().any(cancelled) {
        // The pointer moves away first, so that its release clicks nothing.
        raw.events.extend([
            Event::PointerMoved(NOWHERE),
            Event::PointerButton {
                pos: NOWHERE,
                button: egui::PointerButton::Primary,
                pressed: false,
                modifiers: egui::Modifiers::NONE,
            },
            Event::PointerGone,
        ]);
    }
}
