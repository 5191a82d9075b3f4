//! The caption of a scene over the canvas, with the buttons that go on and back. In a small window the tour's stands
//! below the canvas. Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

use egui::{
    Area, Button, FontId, Frame, Id, Label, Margin, Order, RichText, ScrollArea, Stroke, Ui, pos2,
    vec2,
};
use tilescope_debugger::{Direction, SavedScene};
use tilescope_drawing::palette::Palette;
use tilescope_ui::focus;
use tilescope_ui::theme::{is_for_fingers, semibold};
use tilescope_ui::widgets::{Known, primary_button};
use tilescope_workbench::command::Command;
use tilescope_workbench::scenes::{SceneCommand, SceneList, ShownScene, split_caption};
use tilescope_workbench::state::State;
use tilescope_workbench::tour::{TourScene, tour};

use super::common::read_out;

/// Font sizes of the caption over the canvas: in the window, and for a projector.
const CAPTION_SIZES: [f32; 2] = [15.0, 17.0];
/// Largest width of the caption, in screen points, and the smallest one between the scale bar and the zoom.
const CAPTION_WIDTHS: [f32; 2] = [560.0, 380.0];
/// Room for the scale bar, and for the zoom, beside the caption.
const BESIDE: f32 = 130.0;
/// The distance of the caption from the canvas' lower edge: between the scale bar and the zoom, and above them.
const ABOVE_EDGE: [f32; 2] = [14.0, 56.0];

/// A scene that is shown, with its caption.
struct Card<'a> {
    shown: ShownScene,
    /// How many scenes its list has.
    len: usize,
    scene: &'a SavedScene,
    of_tour: Option<&'static TourScene>,
    palette: &'static Palette,
    size: f32,
}

impl<'a> Card<'a> {
    /// Returns the card of the scene that is shown, if it has a caption.
    fn of(state: &'a State) -> Option<Self> {
        let shown = state.scenes().shown?;
        let scenes = shown.list.scenes(&state.runs().first);
        let scene = *scenes.get(shown.index)?;
        let of_tour = (shown.list == SceneList::Tour).then(|| &tour()[shown.index]);
        // A card without any words would only cover the canvas.
        let has_text = of_tour.is_some() || !scene.caption.is_empty();
        has_text.then_some(Self {
            shown,
            len: scenes.len(),
            scene,
            of_tour,
            palette: Palette::of(state.appearance().look),
            size: CAPTION_SIZES[usize::from(state.appearance().look.is_projector())],
        })
    }

    /// Shows title, text and buttons.
    fn contents(&self, ui: &mut Ui, commands: &mut Vec<Command>) {
        if let Some(of_tour) = self.of_tour {
            let font = FontId::new(self.size, semibold());
            ui.label(RichText::new(&of_tour.title).font(font))
                .known_as("caption-title");
        }

        // The speaker's note, which follows the caption, is for the lecturer alone.
        let text = RichText::new(split_caption(&self.scene.caption).0).size(self.size);
        let response = ui.add(Label::new(text).wrap());
        read_out(ui, &response);
        response.known_as("caption");
        offers(ui, self.of_tour, self.palette, commands);
        ui.add_space(6.0);

        ui.horizontal(|ui| {
            let of = format!("{} of {}", self.shown.index + 1, self.len);
            ui.label(RichText::new(of).color(self.palette.muted))
                .known_as("caption-number");
            steps(ui, self.shown, self.len, commands);
        });
    }
}

/// Returns whether the card stands below the canvas, as in a small window during the tour, and not over it.
pub fn is_below(state: &State) -> bool {
    let window = state.window();
    state.scenes().is_touring()
        && window.embedding.is_none()
        && window.drawer.arrangement.is_compact()
}

/// Shows the caption over the canvas.
pub fn show(ui: &Ui, state: &State, commands: &mut Vec<Command>) {
    let canvas = state.runs().first.viewport;
    // A card below the canvas is shown elsewhere. Before the first frame was laid out there is no canvas to stand over.
    if is_below(state) || !canvas.is_positive() {
        return;
    }
    let Some(card) = Card::of(state) else {
        return;
    };

    // The card stands between the scale bar and the zoom if there is room, and above them otherwise.
    let [widest, least] = CAPTION_WIDTHS;
    let between = canvas.width() - 2.0 * BESIDE;
    let (room, above) = if between >= least {
        (between, ABOVE_EDGE[0])
    } else {
        // At both sides 12 points of the canvas stay free.
        (canvas.width() - 24.0, ABOVE_EDGE[1])
    };
    // A card narrower than 200 points would be read word by word, so that it is that wide even where the canvas is not.
    let width = room.clamp(200.0, widest);
    let at = pos2(canvas.center().x, canvas.bottom() - above);

    Area::new(Id::unique("caption of the scene"))
        .order(Order::Middle)
        .pivot(egui::Align2::CENTER_BOTTOM)
        .fixed_pos(at)
        .constrain(true)
        .show(ui.ctx(), |ui| {
            Frame::new()
                .fill(card.palette.raised)
                .stroke(Stroke::new(1.0, card.palette.accent))
                .corner_radius(10)
                .shadow(ui.visuals().window_shadow)
                .inner_margin(Margin::symmetric(16, 12))
                .show(ui, |ui| {
                    // The frame has margins of 16 points at both sides.
                    ui.set_width(width - 32.0);
                    card.contents(ui, commands);
                });
        });
}

/// Room for title, buttons and margins of a card below the canvas, and for the further buttons that some cards have.
const AROUND_TEXT: [f32; 2] = [108.0, 60.0];

/// Returns the height of the card below a canvas, where it is `width` wide.
pub fn height_below(ctx: &egui::Context, state: &State, width: f32) -> f32 {
    let Some(card) = Card::of(state) else {
        return 0.0;
    };
    let text = split_caption(&card.scene.caption).0.to_owned();
    let font = FontId::proportional(card.size);
    let text_width = width - 2.0 * BELOW_MARGIN.x;
    let lines = ctx.fonts_mut(|fonts| fonts.layout(text, font, card.palette.text, text_width));
    let has_offers = card.of_tour.is_some_and(|scene| !scene.offers.is_empty());
    let [around, more] = AROUND_TEXT;
    (lines.size().y + around + if has_offers { more } else { 0.0 }).ceil()
}

/// The margin of a card below the canvas.
pub const BELOW_MARGIN: egui::Vec2 = vec2(14.0, 10.0);

/// Shows the card below the canvas; it scrolls where the window is too low for it.
pub fn show_below(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    if let Some(card) = Card::of(state) {
        ScrollArea::vertical()
            .id_salt("card of the tour")
            .auto_shrink([false, false])
            .show(ui, |ui| {
                card.contents(ui, commands);
                focus::follow(ui);
            });
    }
}

/// Shows the buttons of a scene of the tour, the first one in the colour of what to do next.
fn offers(
    ui: &mut Ui,
    of_tour: Option<&TourScene>,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let offers = of_tour.map_or(&[][..], |scene| scene.offers.as_slice());
    if offers.is_empty() {
        return;
    }

    ui.add_space(4.0);
    ui.columns(offers.len(), |columns| {
        for (index, (offer, ui)) in offers.iter().zip(columns).enumerate() {
            let button = if index == 0 {
                primary_button(ui, &offer.name, None, palette)
            } else {
                let size = vec2(ui.available_width(), 34.0);
                ui.add(Button::new(&offer.name).min_size(size))
            };
            let command = Command::Scene(SceneCommand::Offer(index));
            button.issues(
                format_args!("caption-offer-{}", index + 1),
                command,
                commands,
            );
        }
    });
}

/// Shows the buttons that go on, go back, and close the caption.
fn steps(ui: &mut Ui, shown: ShownScene, len: usize, commands: &mut Vec<Command>) {
    let is_tour = shown.list == SceneList::Tour;
    let is_last = shown.index + 1 == len;
    // Where fingers are used there are no keys to name.
    let named = |name: &str, key: &str| {
        if is_for_fingers(ui.ctx()) {
            name.to_owned()
        } else {
            format!("{name} ({key})")
        }
    };

    let on = match (is_tour, is_last) {
        (true, true) => named("Finish", "Space"),
        (true, false) => named("Next", "Space"),
        (false, _) => named("Next", "PageDown"),
    };
    let close = named("Close", "Esc");

    // Laid out from the right: the button that goes on is the outermost.
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
        let mut step = |ui: &mut Ui, name: &str, id: &str, is_enabled: bool, command| {
            ui.add_enabled(is_enabled, Button::new(name)).issues(
                id,
                Command::Scene(command),
                commands,
            );
        };
        // To go on from the last scene of the tour finishes it.
        let can_go_on = is_tour || !is_last;
        let next = SceneCommand::Step(Direction::Forwards);
        step(ui, &on, "caption-next", can_go_on, next);
        // The key of this button, PageUp, is not named: chosen, not measured.
        let back = SceneCommand::Step(Direction::Backwards);
        step(ui, "Back", "caption-back", shown.index > 0, back);
        let can_close = true;
        step(ui, &close, "caption-close", can_close, SceneCommand::Leave);
    });
}
