//! The list of all actions (Ctrl+K): typing filters it, arrow keys select, Enter runs the selected action. Sizes are in
//! screen points, and chosen, not measured, where no reason stands beside them.

use egui::{
    Align2, FontId, Key, Modal, Rect, RichText, Role, ScrollArea, Sense, TextEdit, Ui, WidgetInfo,
    vec2,
};
use tilescope_drawing::palette::Palette;
use tilescope_ui::theme::row_height;
use tilescope_ui::widgets::Known;

use super::sheet;
use crate::ENABLED;
use crate::actions::{self, Action};
use tilescope_workbench::command::{Command, WindowCommand};
use tilescope_workbench::finder::Finder;
use tilescope_workbench::state::State;

/// Height of a row, unless enlarged for touch.
const ROW: f32 = 30.0;

/// Where the names begin, from the left edge of a row; the name of every menu fits before it.
const NAME_START: f32 = 76.0;
/// Least gap between a menu and a name.
const AFTER_MENU: f32 = 10.0;

/// Shows the list, if it is open.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let Some(open) = &state.window().finder else {
        return;
    };
    let mut found = Vec::new();
    let modal = Modal::new(egui::Id::unique("actions")).show(ui.ctx(), |ui| {
        ui.set_width(sheet::width(ui, 480.0));
        // Text and Enter may come in one frame: the text filters the list first.
        let (field_id, filter) = field(ui, open, commands);
        found = actions::found(&filter, state);
        // A script may choose a row beyond the end, and actions may go while the list is open: the last row is chosen then.
        let choice = filter.choice.min(found.len().saturating_sub(1));

        ui.add_space(6.0);
        let seen = ui.scope_id().with("seen");
        // Only a new choice is brought into view, so that a user may scroll on from there.
        let has_moved = ui.data(|data| data.get_temp(seen)) != Some(choice);
        ui.data_mut(|data| data.insert_temp(seen, choice));

        // The field, the margins, and some room above and below the list take 110 points.
        let room = ui.ctx().content_rect().height() - 110.0;
        let enters = keys(ui, choice, found.len(), commands);
        // Enter is ignored until something was typed or selected: the first action was not chosen by anyone.
        let is_meant = choice > 0 || !filter.text.trim().is_empty();
        let mut run_row = (enters && is_meant).then_some(choice);

        ScrollArea::vertical()
            // A dozen rows of normal height are enough to choose from: more letters leave fewer actions.
            .max_height(room.min(12.0 * ROW))
            .auto_shrink([false, false])
            .show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = 0.0;
                for (index, action) in found.iter().enumerate() {
                    if show_action(ui, state, action, field_id, index == choice, has_moved) {
                        run_row = Some(index);
                    }
                }
                if found.is_empty() {
                    ui.label(
                        RichText::new("No action has this name.")
                            .color(Palette::of(state.appearance().look).muted),
                    );
                }
            });
        run_row
    });

    let chosen = modal.inner.and_then(|index| found.get(index));
    if let Some(action) = chosen.filter(|action| action.refusal.is_none()) {
        commands.push(Command::Window(WindowCommand::CloseFinder));
        // This action opens and closes the list, which is closed by now: it would open again.
        if action.command != Command::Window(WindowCommand::ToggleFinder) {
            commands.push(action.command.clone());
        }
    } else if modal.should_close() {
        commands.push(Command::Window(WindowCommand::CloseFinder));
    }
}

/// Shows the text field. Returns its id, and the text and the choice that hold in this frame: a new text begins at the
/// first action.
fn field(ui: &mut Ui, open: &Finder, commands: &mut Vec<Command>) -> (egui::Id, Finder) {
    let mut text = open.text.clone();
    let response = ui.add(
        TextEdit::singleline(&mut text)
            .align(egui::Align2::LEFT_CENTER)
            .hint_text("What do you want to do?")
            .desired_width(f32::INFINITY),
    );
    response.widget_info(|| WidgetInfo::labeled(Role::TextInput, ENABLED, "Find an action"));
    response.known_as("find-action");
    // The field has the focus as long as the list is open, whatever is clicked in it.
    if !response.has_focus() {
        response.request_focus();
    }
    if !response.changed() {
        return (response.id, open.clone());
    }
    commands.push(Command::Window(WindowCommand::FinderText(text.clone())));
    (response.id, Finder { text, choice: 0 })
}

/// Moves the selection; returns whether it was confirmed.
fn keys(ui: &Ui, choice: usize, count: usize, commands: &mut Vec<Command>) -> bool {
    ui.input(|input| {
        if input.key_pressed(Key::ArrowDown) && choice + 1 < count {
            commands.push(Command::Window(WindowCommand::FinderChoice(choice + 1)));
        }
        if input.key_pressed(Key::ArrowUp) && choice > 0 {
            commands.push(Command::Window(WindowCommand::FinderChoice(choice - 1)));
        }
        input.key_pressed(Key::Enter) && count > 0
    })
}

/// Shows an action in the list; returns whether it was clicked. `field` is the id of the text field. If the choice
/// `has_moved` since the frame before, the chosen action is scrolled to.
fn show_action(
    ui: &mut Ui,
    state: &State,
    action: &Action,
    field: egui::Id,
    is_chosen: bool,
    has_moved: bool,
) -> bool {
    let palette = Palette::of(state.appearance().look);
    // An action that is refused stays in the list, so that its tooltip can say why.
    let is_enabled = action.refusal.is_none();
    let sense = if is_enabled {
        Sense::click()
    } else {
        Sense::hover()
    };
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), row_height(ui.ctx(), ROW)), sense);
    response
        .widget_info(|| WidgetInfo::selected(Role::Button, is_enabled, is_chosen, &action.name));
    response.known_as(format_args!("action.{}", action.id()));

    if is_chosen {
        // The field keeps the focus while screen readers follow the selection.
        ui.ctx().accesskit_node_builder(field, |node| {
            node.set_active_descendant(response.id.accesskit_id());
        });
        ui.painter()
            .rect_filled(rect, 5.0, palette.accent.gamma_multiply(0.22));
        if has_moved {
            ui.scroll_to_rect_animation(rect, None, egui::style::ScrollAnimation::none());
        }
    } else if response.hovered() {
        ui.painter()
            .rect_filled(rect, 5.0, palette.text.gamma_multiply(0.07));
    }

    texts(ui, action, rect, palette);
    match &action.refusal {
        Some(refusal) => {
            response.on_hover_text(refusal);
            false
        }
        None => response.clicked(),
    }
}

/// Draws an action's menu, name and keys in its row.
fn texts(ui: &Ui, action: &Action, rect: Rect, palette: &Palette) {
    let ink = if action.refusal.is_none() {
        palette.text
    } else {
        palette.muted.gamma_multiply(0.7)
    };

    let painter = ui.painter();
    let menu = painter.text(
        rect.left_center() + vec2(10.0, 0.0),
        Align2::LEFT_CENTER,
        action.menu.name(),
        FontId::proportional(12.0),
        palette.muted,
    );
    // The names of actions begin at one place. A menu that reached beyond it would move the name to the right.
    let start = (menu.right() + AFTER_MENU).max(rect.left() + NAME_START);
    painter.text(
        egui::pos2(start, rect.center().y),
        Align2::LEFT_CENTER,
        &action.name,
        FontId::proportional(13.5),
        ink,
    );

    if let Some(shortcut) = &action.shortcut {
        let keys = crate::actions::shortcut_text(ui.ctx(), shortcut);
        painter.text(
            rect.right_center() - vec2(10.0, 0.0),
            Align2::RIGHT_CENTER,
            keys,
            FontId::monospace(12.0),
            palette.muted,
        );
    }
}
