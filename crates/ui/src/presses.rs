//! Splits input so that presses, moves and releases reach egui in separate frames. A slow frame may hold both press and
//! release of a click, or a whole drag; egui would place the press at the pointer's last position and miss the drag.

use egui::{Context, Event, Plugin, RawInput, TouchPhase, Ui};

/// Most seconds that a deferred event is dated after the frame it happened in, so that a click stays short enough to be
/// one.
const LATEST_SECS: f64 = 0.1;

/// Events still to be passed on.
#[derive(Default)]
pub struct Presses {
    waiting: Vec<Event>,
    /// The time of the previous frame.
    before_secs: Option<f64>,
}

/// What an event does with the pointer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PointerAction {
    Moves,
    Presses,
    Releases,
}

impl PointerAction {
    const fn of(event: &Event) -> Option<Self> {
        match event {
            Event::PointerMoved(_) => Some(Self::Moves),
            Event::PointerButton { pressed: true, .. } => Some(Self::Presses),
            Event::PointerButton { pressed: false, .. } => Some(Self::Releases),
            _ => None,
        }
    }

    /// Returns whether the second event must wait for a later frame than the first. A press may share a frame with the
    /// moves before it, as it is made where the last one ends. A release may not: the drag would be over before a frame
    /// shows it.
    const fn parts_from(self, next: Self) -> bool {
        matches!(
            (self, next),
            (Self::Presses | Self::Releases, _) | (Self::Moves, Self::Releases)
        )
    }

    /// Returns whether a touch in this phase comes just before this pointer event.
    const fn follows(self, phase: TouchPhase) -> bool {
        match self {
            Self::Moves => matches!(phase, TouchPhase::Start | TouchPhase::Move),
            Self::Presses => matches!(phase, TouchPhase::Start),
            Self::Releases => matches!(phase, TouchPhase::End | TouchPhase::Cancel),
        }
    }
}

/// Returns how many of the events belong to this frame.
fn first_frame(events: &[Event]) -> usize {
    let mut before: Option<PointerAction> = None;
    for (index, event) in events.iter().enumerate() {
        let Some(doing) = PointerAction::of(event) else {
            continue;
        };
        if before.is_some_and(|before| before.parts_from(doing)) {
            // The touch event comes just before the pointer's event that it causes, and waits for the next frame with
            // it.
            let touches = |event: &&Event| matches!(event, Event::Touch { phase, .. } if doing.follows(*phase));
            let touching = events[..index].iter().rev().take_while(touches).count();
            return index - touching;
        }
        before = Some(doing);
    }
    events.len()
}

impl Plugin for Presses {
    fn debug_name(&self) -> &'static str {
        "presses"
    }

    fn input_hook(&mut self, _: &Context, input: &mut RawInput) {
        let were_waiting = !self.waiting.is_empty();
        let mut events = std::mem::take(&mut self.waiting);
        events.append(&mut input.events);
        self.waiting = events.split_off(first_frame(&events));
        input.events = events;
        if let (true, Some(now), Some(before)) = (were_waiting, &mut input.time, self.before_secs) {
            *now = now.min(before + LATEST_SECS);
        }
        self.before_secs = input.time;
    }

    fn on_begin_pass(&mut self, ui: &mut Ui) {
        if !self.waiting.is_empty() {
            ui.ctx().request_repaint();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Modifiers, PointerButton, Pos2, Rect, Sense, pos2, vec2};

    fn button(pos: Pos2, pressed: bool) -> Event {
        Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        }
    }

    fn touch(phase: TouchPhase) -> Event {
        Event::Touch {
            device_id: egui::TouchDeviceId(0),
            id: egui::TouchId(0),
            phase,
            pos: Pos2::ZERO,
            force: None,
        }
    }

    /// The responses of two clickable and draggable widgets, side by side.
    #[derive(Debug, Default, PartialEq)]
    struct Came {
        clicks: [usize; 2],
        dragged: [egui::Vec2; 2],
    }

    /// Shows frames of one second until no event is pending; all events arrive with the first.
    fn came(ctx: &Context, mut events: Vec<Event>) -> (Came, usize) {
        let mut came = Came::default();
        let mut frames = 0;
        loop {
            let input = RawInput {
                events: std::mem::take(&mut events),
                time: Some(f64::from(frames as u32) + ctx.input(|input| input.time).ceil() + 1.0),
                screen_rect: Some(Rect::from_min_size(Pos2::ZERO, vec2(200.0, 100.0))),
                ..RawInput::default()
            };
            let output = ctx.run_ui(input, |ui| {
                for k in 0..2 {
                    let low = pos2(100.0 * k as f32, 0.0);
                    let rect = Rect::from_min_size(low, vec2(100.0, 100.0));
                    let sense = Sense::click_and_drag();
                    let response = ui.interact(rect, egui::Id::unique(("part", k)), sense);
                    came.clicks[k] += usize::from(response.clicked());
                    came.dragged[k] += response.drag_delta();
                }
            });
            output.drop_without_applying_deltas();
            frames += 1;
            let waits = ctx.plugin::<Presses>().lock().waiting.is_empty();
            if waits {
                return (came, frames);
            }
        }
    }

    fn opened() -> Context {
        let ctx = Context::default();
        ctx.add_plugin(Presses::default());
        // egui finds widgets by their places in the previous frame.
        came(&ctx, Vec::new());
        ctx
    }

    #[test]
    fn every_click_of_one_slow_frame_goes_where_it_was_made() {
        let [a, b] = [pos2(50.0, 50.0), pos2(150.0, 50.0)];
        let click = |at| vec![Event::PointerMoved(at), button(at, true), button(at, false)];
        let (came, _) = came(&opened(), [click(a), click(b), click(a)].concat());
        assert_eq!(came.clicks, [2, 1]);
    }

    #[test]
    fn a_drag_within_one_slow_frame_is_one() {
        let path = [20.0, 40.0, 130.0, 160.0].map(|x| pos2(x, 50.0));
        let mut events = vec![Event::PointerMoved(path[0]), button(path[0], true)];
        events.extend(path.map(Event::PointerMoved));
        events.push(button(path[3], false));
        let (came, frames) = came(&opened(), events);
        // The drag began on the first widget, wherever it ended.
        assert_eq!(came.clicks, [0, 0]);
        assert_eq!(came.dragged, [vec2(140.0, 0.0), vec2(0.0, 0.0)]);
        assert_eq!(frames, 3);
    }

    #[test]
    fn moves_and_a_press_need_no_frame_of_their_own() {
        let at = pos2(50.0, 50.0);
        let events = [
            Event::PointerMoved(at),
            Event::PointerMoved(at),
            button(at, true),
        ];
        assert_eq!(first_frame(&events), 3);
        assert_eq!(first_frame(&[]), 0);
    }

    #[test]
    fn a_touch_comes_in_the_frame_of_its_pointer() {
        let at = pos2(50.0, 50.0);
        let (down, up) = (button(at, true), button(at, false));
        let [start, end] = [TouchPhase::Start, TouchPhase::End].map(touch);
        // Native windows report the touch first, browsers the pointer.
        let moved = Event::PointerMoved(at);
        let native = [
            start.clone(),
            moved,
            down.clone(),
            end.clone(),
            up.clone(),
            Event::PointerGone,
        ];
        assert_eq!(first_frame(&native), 3);
        assert_eq!(first_frame(&native[3..]), 3);
        let web = [down, start, up, Event::PointerGone, end];
        assert_eq!(first_frame(&web), 2);
        assert_eq!(first_frame(&web[2..]), 3);
    }
}
