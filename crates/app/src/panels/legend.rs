//! The legend: the meanings of the symbols, and of the colours of samples. The *brush* is a range of a curve of the
//! analysis, whose samples or pairs the canvas marks. Sizes are in screen points, and chosen, not measured, where no
//! reason stands beside them.

use egui::{Align2, Button, FontId, Painter, Rect, Response, RichText, Sense, Ui, pos2, vec2};
use tilescope_drawing::palette::Palette;
use tilescope_session::Session;
use tilescope_session::glossary;
use tilescope_session::layers::{Colouring, Layer, SessionKind};
use tilescope_session::octaves::counted_cells;
use tilescope_ui::language::Worded;
use tilescope_ui::widgets::{Kebab, Known, cell_symbol, explain, heading, name_group, symbol};

use super::content::{Content, Room};
use super::context::PanelContext;
use crate::ENABLED;
use tilescope_drawing::age::{Ages, LAST_TILED};
use tilescope_drawing::brushed::{BrushedCause, Cause};
use tilescope_drawing::looks::level_age;
use tilescope_workbench::command::{AppearanceCommand, Command};

pub const CONTENT: Content = Content::of_state(Room::Scrolled, |ui, state, commands| {
    let causes = state.analysis().causes(&state.runs().first, state.window());
    show(ui, &PanelContext::of(state), causes, commands);
});

/// Shows the legend of colours, symbols and marks.
pub fn show(
    ui: &mut Ui,
    context: &PanelContext<'_>,
    causes: Option<&BrushedCause>,
    commands: &mut Vec<Command>,
) {
    let palette = context.palette;
    heading(ui, "Legend");
    let kind = context.run.kind();
    colouring(ui, context, kind, commands);

    match (context.appearance.colouring.of(kind), &context.run.session) {
        (Colouring::Age, Some(session)) => ages(ui, Ages::of(session), palette),
        (Colouring::Level, Some(session)) => levels(ui, session, palette),
        (Colouring::Depth, Some(_)) => depths(ui, palette),
        // Blocks and origins have no order that a scale could show, and before there is a session nothing is coloured.
        _ => {}
    }

    ui.add_space(2.0);
    ui.spacing_mut().item_spacing.y = 1.0;
    let shown = context.run.layers(context.appearance);
    // The layers of nets are rarely on: listed always, they would make the list longer than the panel.
    let is_listed =
        |layer: &Layer| layer.is_of(kind) && (!Layer::NETS.contains(layer) || shown.has(*layer));
    for layer in Layer::ALL.into_iter().filter(is_listed) {
        if layer == Layer::Detectors && octaves(ui, context, palette) {
            continue;
        }
        let draw = |painter: &Painter, rect: Rect| {
            symbol(painter, layer, kind, rect.center(), palette);
        };
        let listed = entry(ui, layer.meaning(kind), palette, draw);
        listed.on_hover_ui(|ui| explain(ui, layer, kind, palette));
    }

    if context.is_compared {
        marks(ui, palette);
    }
    if let Some(found) = causes {
        brushed(ui, &found.cause, palette);
    }
}

/// Shows the colour of the active cells of each octave, with their number in the throw that is shown; returns whether the run
/// has octaves.
fn octaves(ui: &mut Ui, context: &PanelContext<'_>, palette: &Palette) -> bool {
    let session = context.run.session.as_ref();
    let Some((session, octaves)) = session.and_then(|found| Some((found, found.octaves()?))) else {
        return false;
    };

    let stage = context.run.current_stage();
    let counts = stage.and_then(|stage| session.cells_by_octave(stage));
    for octave in octaves.all() {
        let color = palette.octave(octave, octaves);
        let shown = entry(ui, &octaves.meaning(octave), palette, |painter, rect| {
            cell_symbol(painter, color, rect.center());
        });
        shown.known_as(format_args!("octave-{octave}"));
        // Between throws no cell is active.
        if let Some(counts) = &counts {
            let number = counted_cells(counts[octave], octave);
            shown.on_hover_text(ui.words(&number));
        }
    }
    true
}

/// Shows the marks of the brush.
fn brushed(ui: &mut Ui, cause: &Cause, palette: &Palette) {
    // Each entry has a colour, the radius of its circle, and a meaning. On the canvas, too, a larger circle
    // stands for a larger share.
    let entries: &[_] = match cause {
        Cause::Pairs { .. } => &[(palette.margin, 0.0, "brushed pair of samples")],
        Cause::Shares { .. } => &[
            (
                palette.conflict,
                6.0,
                "adds more to the brushed power than the mean sample",
            ),
            (palette.eliminated, 4.0, "adds as much as the mean sample"),
            (palette.detector, 2.0, "adds less, or takes from it"),
        ],
    };

    for (color, radius, meaning) in entries {
        entry(ui, meaning, palette, |painter, rect| {
            // A radius of 0 stands for a line, as brushed pairs are drawn.
            if *radius > 0.0 {
                painter.circle_filled(rect.center(), *radius, *color);
            } else {
                let ends = [rect.left_center(), rect.right_center()];
                painter.line_segment(ends, egui::Stroke::new(1.5, *color));
            }
        });
    }
}

/// Shows a symbol, drawn by `draw` in a rectangle, and its meaning.
fn entry(
    ui: &mut Ui,
    meaning: &str,
    palette: &Palette,
    draw: impl FnOnce(&Painter, Rect),
) -> Response {
    let shown = ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(vec2(22.0, 20.0), Sense::hover());
        draw(ui.painter(), rect);
        ui.label(RichText::new(meaning).size(12.5).color(palette.muted))
    });
    shown.inner
}

/// Shows the marks of samples that only one of two compared runs has.
fn marks(ui: &mut Ui, palette: &Palette) {
    for (whole, meaning) in [
        (true, "this run alone has it"),
        (false, "the other run alone has it"),
    ] {
        entry(ui, meaning, palette, |painter, rect| {
            tilescope_canvas::contrast_mark(painter, rect.center(), whole, palette);
        });
    }
}

/// Shows the choice of the meaning of colours.
fn colouring(
    ui: &mut Ui,
    context: &PanelContext<'_>,
    kind: SessionKind,
    commands: &mut Vec<Command>,
) {
    let palette = context.palette;
    let choices = [
        (
            Colouring::Block,
            match kind {
                SessionKind::Combination => "by piece",
                _ => "by block",
            },
            "Samples have the colour of the block, or the piece, that they come from.",
        ),
        (
            Colouring::Provenance,
            "by origin",
            "Samples inside their own block, from the margin around it, or inserted.",
        ),
        (
            Colouring::Age,
            match kind {
                SessionKind::Nested => "by order",
                _ => "by age",
            },
            "When a sample came: tiled early to late, then inserted iteration by iteration; of nested levels its place in their order.",
        ),
        (Colouring::Level, "by level", glossary::LEVEL.meaning),
        (
            Colouring::Depth,
            "by depth",
            "How far a sample lies above the plane or below it: the paler and smaller, the farther away.",
        ),
    ];
    // A colouring that this kind of session lacks would be drawn as another one, and is not offered.
    let offered = (choices.into_iter()).filter(|(colouring, ..)| colouring.of(kind) == *colouring);

    let shown = ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new("Colour").color(palette.muted));
        for (colouring, name, explanation) in offered {
            let is_chosen = context.appearance.colouring.of(kind) == colouring;
            let button = ui.add(Button::selectable(is_chosen, name));
            button.known_as(format_args!("colour.{}", Kebab(colouring)));
            if button.on_hover_text(explanation).clicked() {
                commands.push(Command::Appearance(AppearanceCommand::Colour(colouring)));
            }
        }
    });
    name_group(&shown.response, "Colour");
}

/// The number of bands that draw the tiled part of the ramp.
const SHADES: u16 = 64;

/// Shows the colour of each level, with its radius.
fn levels(ui: &mut Ui, session: &Session, palette: &Palette) {
    let Some(nested) = &session.nested else {
        return;
    };
    ui.spacing_mut().item_spacing.y = 1.0;
    for (level, claim) in nested.claims.iter().enumerate() {
        let radius = claim.distance / session.run().domain.radius();
        let meaning = format!("level {level}, radius {radius:.2} r");
        entry(ui, &meaning, palette, |painter, rect| {
            let color = palette.age(level_age(level, nested));
            painter.circle_filled(rect.center(), 5.0, color);
        });
    }
}

/// Shows the colours of samples above the plane, in it and below it.
fn depths(ui: &mut Ui, palette: &Palette) {
    ui.spacing_mut().item_spacing.y = 1.0;
    for (above, meaning) in [
        (0.5, "above the plane"),
        (0.0, "in the plane"),
        (-0.5, "below the plane"),
    ] {
        entry(ui, meaning, palette, |painter, rect| {
            painter.circle_filled(rect.center(), 5.0, palette.depth(above));
        });
    }
}

/// Shows the ramp of ages with its ends named: the tiled samples without steps, then a step for each iteration.
fn ages(ui: &mut Ui, ages: Ages, palette: &Palette) {
    let size = vec2(ui.available_width().min(300.0), 44.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    response.widget_info(|| {
        let name = "Ramp of ages, dark to light: tiled first to last, then inserted";
        egui::WidgetInfo::labeled(egui::Role::Image, ENABLED, name)
    });
    response.known_as("ages");

    let painter = ui.painter();
    let x = |age: f32| rect.left() + age * rect.width();
    let band = |from: f32, to: f32, age: f32| {
        let swatch = Rect::from_x_y_ranges(x(from)..=x(to), rect.top()..=rect.top() + 14.0);
        painter.rect_filled(swatch, 0.0, palette.age(age));
    };

    let tiled = ages.last_tiled();
    for k in 0..SHADES {
        let at = |k: u16| tiled * f32::from(k) / f32::from(SHADES);
        band(at(k), at(k + 1), at(k));
    }

    // A gap of 3% of the ramp separates tiled samples, which end at `LAST_TILED`, from inserted ones. Nested levels,
    // and sets that are made by darts, have one order from their first sample to their last: for them `tiled` is 1, the
    // end of the ramp, and there are no iterations.
    let start = LAST_TILED + 0.03;
    for k in 0..ages.iterations {
        let at = |k: u32| start + (1.0 - start) * k as f32 / ages.iterations as f32;
        band(at(k), at(k + 1), ages.of_iteration(k + 1));
    }

    let font = FontId::proportional(11.5);
    // A ramp of one order has no tiled samples to name.
    let first = if tiled < 1.0 { "tiled first" } else { "first" };
    let inserted = match ages.iterations {
        0 => String::new(),
        1 => "inserted".to_owned(),
        all => format!("iteration 1 to {all}"),
    };

    for (at, anchor, text) in [
        (0.0, Align2::LEFT_TOP, first),
        (tiled, Align2::RIGHT_TOP, "last"),
        (1.0, Align2::RIGHT_TOP, inserted.as_str()),
    ] {
        let corner = pos2(x(at), rect.top() + 18.0);
        painter.text(corner, anchor, text, font.clone(), palette.muted);
    }
}
