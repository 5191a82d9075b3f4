//! A hint over an embedded canvas: how to zoom and pan after a gesture that scrolls the surrounding page instead.
//! Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

use egui::{Align2, Context, Id, ModifierNames, Modifiers, Painter, Rect, Ui, vec2};
use tilescope_drawing::palette::Palette;

use crate::overlay::tag;

/// How long the hint stays after the last such gesture, in seconds. Chosen, not measured.
const SECS: f64 = 1.6;

/// A gesture that scrolls the page instead of the canvas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hint {
    /// The wheel without Ctrl.
    Wheel,
    /// A drag by one finger.
    Fingers,
}

impl Hint {
    /// Returns the gesture to use instead, as a sentence.
    #[must_use]
    pub fn text(self, ctx: &Context) -> String {
        match self {
            Self::Wheel => {
                let keys = ModifierNames::NAMES.format(&Modifiers::COMMAND, ctx.os().is_mac());
                format!("{keys} and the wheel zoom")
            }
            Self::Fingers => "Two fingers move and zoom".to_owned(),
        }
    }
}

fn id() -> Id {
    Id::unique("hint on the canvas")
}

/// Shows a hint from now on.
pub fn give(ui: &Ui, hint: Hint) {
    let now = ui.input(|input| input.time);
    ui.data_mut(|data| data.insert_temp(id(), (hint, now)));
}

/// Returns the hint to show now.
#[must_use]
pub fn given(ctx: &Context) -> Option<Hint> {
    let (hint, at): (Hint, f64) = ctx.data(|data| data.get_temp(id()))?;
    let rest = at + SECS - ctx.input(|input| input.time);
    if rest <= 0.0 {
        return None;
    }
    // The hint ends without any input.
    ctx.request_repaint_after(std::time::Duration::from_secs_f64(rest));
    Some(hint)
}

/// Draws the hint, if there is one.
pub fn show(painter: &Painter, rect: Rect, palette: &Palette) {
    let Some(hint) = given(painter.ctx()) else {
        return;
    };
    let text = hint.text(painter.ctx());
    let at = rect.center_bottom() - vec2(0.0, 0.25 * rect.height());
    tag(painter, at, Align2::CENTER_CENTER, &text, palette);
}
