//! The bar on top: menus, the name of the run, the verdict, export and theme. Sizes are in screen points, and chosen,
//! not measured, where no reason stands beside them.

use egui::{
    Align, Atom, Button, Color32, FontId, IdSalt, Layout, Popup, PopupCloseBehavior, RichText,
    Role, Shape, Stroke, TextStyle, Ui, Vec2, WidgetInfo, vec2,
};
use tilescope_classroom::lesson_labels::lesson_labels;
use tilescope_classroom::lessons::LessonCommand;
use tilescope_drawing::palette::Palette;
use tilescope_session::Session;
use tilescope_session::words::{counted, grouped};
use tilescope_ui::language::Worded;
use tilescope_ui::theme::{FINGER, is_for_fingers, semibold};
use tilescope_ui::widgets::{Icon, Kebab, Known, icon_button};

use super::verification;
use crate::ENABLED;
use crate::actions::{Action, Menu, Submenu, actions};
use crate::panels::context::PanelContext;
use tilescope_workbench::command::{AppearanceCommand, Command, ViewCommand, Which};
use tilescope_workbench::export::{ExportCommand, ExportKind};
use tilescope_workbench::files::FileCommand;
use tilescope_workbench::state::State;

/// Minimum room behind the menus, in screen points, to show the run's name.
const ROOM_FOR_RUN: f32 = 620.0;
/// Minimum room to show the engine, too.
const ROOM_FOR_ENGINE: f32 = 740.0;

/// Shows the bar of a large window.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.appearance().look);
    ui.horizontal_centered(|ui| {
        // The verdict keeps its width: the other parts of the bar make room for it.
        let verdict_width = verification::chip_width(ui, &PanelContext::of(state));
        // Where the menus' names are long, the program's name is left out first, and then the button of exports.
        if ui.available_width() >= TITLE + menus_width(ui) + ICONS + verdict_width {
            let title = RichText::new("Tilescope").font(FontId::new(17.0, semibold()));
            ui.label(title).known_as("title");
            ui.add_space(6.0);
        }

        menus(ui, state, commands);
        ui.add_space(10.0);

        let room = ui.available_width();
        if let Some(session) = state
            .runs()
            .first
            .session
            .as_ref()
            .filter(|_| room >= ROOM_FOR_RUN)
        {
            let parameters = &session.run().parameters;
            // In a combination the pieces take the place of blocks.
            let made = match (&session.combination, &session.nested) {
                (Some(_), _) => counted(session.summary.blocks, "piece", "pieces"),
                (None, Some(nested)) => counted(nested.claims.len(), "level", "levels"),
                (None, None) => format!("seed {}", parameters.seed),
            };
            let count = grouped(session.summary.count);
            let radius = radius_text(session);
            // The timeline counts the samples of the moment. This text counts those of the whole run, so that it begins
            // with "result".
            let text = format!("result: {count} samples   r {radius}   {made}");
            ui.label(RichText::new(ui.words(text)).color(palette.muted))
                .known_as("run-shown");
            if room >= ROOM_FOR_ENGINE {
                let engine = format!("engine: {}", session.engine);
                ui.label(RichText::new(ui.words(engine)).color(palette.muted))
                    .known_as("engine-used");
            }
        }

        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            theme_button(ui, state, commands);
            let command = Command::View(Which::First, ViewCommand::Fit);
            icon_button(ui, Icon::Fit, "Fit the domain (F)", None, palette)
                .issues("fit", command, commands);
            export_button(ui, state, verdict_width, commands);
            verification::chip(ui, &PanelContext::of(state), commands);
            export_progress(ui, state, commands);

            let offers_last = state.files().offers_session(state.past(), state.window());
            if offers_last && ui.available_width() >= ROOM_FOR_LAST {
                let last = (ui.button("Reopen the last session")).on_hover_text(LAST_SESSION);
                let command = Command::File(FileCommand::Last);
                last.issues("reopen-last", command, commands);
            }
        });
    });
}

/// Returns the radius of a run's set, or its least and largest.
fn radius_text(session: &Session) -> String {
    let radius = session.run().parameters.radius;
    match (&session.nested, &session.ground) {
        // The radius of nested levels may follow from their number of samples, and then has many digits.
        (Some(_), _) => format!("{radius:.6}"),
        // The lattice's r is no radius of this set, whose least and largest are named.
        (None, Some(made)) => made.radii_text(),
        (None, None) => radius.to_string(),
    }
}

/// Width of the program's name and the space behind it, in screen points.
const TITLE: f32 = 100.0;
/// Width of the two icons at the right and the spaces beside them, in screen points.
const ICONS: f32 = 100.0;

/// Returns the width of a button with a name, and of the space behind it.
fn button_width(ui: &Ui, name: &str) -> f32 {
    let font = TextStyle::Button.resolve(ui.style());
    let galley = ui
        .painter()
        .layout_no_wrap(name.to_owned(), font, Color32::WHITE);
    let spacing = ui.spacing();
    galley.size().x + 2.0 * spacing.button_padding.x + spacing.item_spacing.x
}

fn menus_width(ui: &Ui) -> f32 {
    let widths = Menu::ALL.map(|menu| button_width(ui, &ui.words(menu.name())));
    widths.iter().sum()
}

/// Shows the button that opens exports, if that leaves the verdict its width. The File menu has them always.
fn export_button(ui: &mut Ui, state: &State, verdict_width: f32, commands: &mut Vec<Command>) {
    let name = ui.words("Export\u{2026}");
    let space = 6.0;
    if ui.available_width() < button_width(ui, &name) + space + verdict_width {
        return;
    }
    let export = ui.add_enabled(state.runs().first.session.is_some(), Button::new(name));
    export.known_as("export");
    let why = "There is nothing to export before the first session is ready.";
    if export.on_disabled_hover_text(ui.words(why)).clicked() {
        commands.push(Command::Export(ExportCommand::Open(ExportKind::Result)));
    }
    ui.add_space(space);
}

/// Minimum room left in the bar, in screen points, to offer the last session; the File menu has it always.
const ROOM_FOR_LAST: f32 = 180.0;
/// What a click on the button of the last session does.
const LAST_SESSION: &str =
    "Opens what the window showed when it was closed last: parameters, run, moment and scenes.";

/// Shows how far a running export is while its sheet is closed, with a button that cancels it.
fn export_progress(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let exports = &state.files().exports;
    let Some(fraction) = exports.fraction().filter(|_| exports.sheet.is_none()) else {
        return;
    };
    let palette = Palette::of(state.appearance().look);
    let cancel = icon_button(ui, Icon::Close, "Cancel the export", None, palette);
    let command = Command::Export(ExportCommand::Cancel);
    cancel.issues("export-chip.cancel", command, commands);
    let text = format!("Exporting {:.0}%", 100.0 * fraction);
    ui.label(RichText::new(ui.words(text)).color(palette.candidate))
        .known_as("export-chip");
    // The export itself draws no frames. Ten in a second, a chosen number, keep the percentage up to date.
    ui.ctx()
        .request_repaint_after(std::time::Duration::from_millis(100));
}

/// Shows the bar of a small window; one menu has the rest.
pub fn show_compact(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.appearance().look);
    ui.horizontal_centered(|ui| {
        ui.spacing_mut().item_spacing.x = 6.0;
        let button = icon_button(ui, Icon::Menu, "Menu", None, palette);
        button.known_as("menu");

        let room = ui.ctx().content_rect().size();
        let menu = Popup::menu(&button)
            // A click in this menu opens another one within it, and must not close this one.
            .close_behavior(PopupCloseBehavior::CloseOnClickOutside)
            .show(|ui| {
                // The menu leaves 40 points of the window beside it, and 96 points above and below it. In a window
                // lower than any phone it keeps 120 points, in which it scrolls.
                ui.set_width(MAX_MENU_WIDTH.min(room.x - 40.0));
                let height = (room.y - 96.0).max(120.0);
                egui::ScrollArea::vertical()
                    .max_height(height)
                    .min_scrolled_height(height)
                    .show(ui, |ui| one_menu(ui, state, commands));
            });
        button.opens_menu(menu.is_some());

        if ui.available_width() >= ROOM_FOR_TITLE {
            ui.label(RichText::new("Tilescope").font(FontId::new(17.0, semibold())))
                .known_as("title");
        }

        if ui.available_width() >= ROOM_FOR_LESSONS {
            let name = lesson_labels(&state.lessons().language).lessons;
            let lessons = Button::new(name).min_size(vec2(FINGER, FINGER));
            let command = Command::Lesson(LessonCommand::ToggleList);
            ui.add(lessons).issues("lessons-list", command, commands);
        }

        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let command = Command::View(Which::First, ViewCommand::Fit);
            icon_button(ui, Icon::Fit, "Fit the domain (F)", None, palette)
                .issues("fit", command, commands);
            verification::chip(ui, &PanelContext::of(state), commands);
            export_progress(ui, state, commands);
        });
    });
}

/// Maximum width of a small window's menu, in screen points.
const MAX_MENU_WIDTH: f32 = 340.0;
/// Minimum room beside the menu to show the name of a small window; room for the lessons and the longest verdict is
/// reserved.
const ROOM_FOR_TITLE: f32 = 400.0;
/// Minimum room beside the menu to show the button of the lessons; room for the longest verdict is reserved. In a smaller
/// window, which no phone has, the menu has them.
const ROOM_FOR_LESSONS: f32 = 290.0;

/// Shows all menus in one: a chosen one opens below its name.
fn one_menu(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.appearance().look);
    ui.spacing_mut().item_spacing.y = 2.0;
    // The entries keep clear of the scroll bar.
    ui.set_max_width(ui.available_width() - 14.0);
    if let Some(session) = &state.runs().first.session {
        let count = grouped(session.summary.count);
        let engine = &session.engine;
        let radius = radius_text(session);
        let text = ui.words(format!(
            "result: {count} samples, r {radius}, engine: {engine}"
        ));
        ui.label(RichText::new(text).color(palette.muted))
            .known_as("run-shown");
    }

    let chosen_id = ui.scope_id().with("chosen menu");
    let chosen: Option<Menu> = ui.data(|data| data.get_temp(chosen_id)).flatten();
    let all = actions(state);
    for menu in Menu::ALL {
        let is_open = chosen == Some(menu);
        let mark = if is_open { "\u{2212}" } else { "+" };
        let name = RichText::new(ui.words(menu.name())).font(FontId::new(14.0, semibold()));
        let button = Button::new(name)
            .right_text(RichText::new(mark).color(palette.muted))
            .min_size(vec2(ui.available_width(), FINGER))
            .frame_when_inactive(false);
        let response = ui.add(button);
        let spoken = ui.words(format!("{} menu", menu.name()));
        response.widget_info(|| WidgetInfo::selected(Role::Button, ENABLED, is_open, &spoken));
        response.known_as(format_args!("menu.{}", Kebab(menu)));
        // A click on the name of the open menu closes it.
        if response.clicked() {
            let next = (!is_open).then_some(menu);
            ui.data_mut(|data| data.insert_temp(chosen_id, next));
        }

        if is_open {
            ui.indent(menu.name(), |ui| {
                nested(ui, &all, menu, commands);
            });
        }
    }
}

/// Shows the entries of a menu of a small window; a chosen submenu opens below its name.
fn nested(ui: &mut Ui, all: &[Action], menu: Menu, commands: &mut Vec<Command>) {
    let chosen_id = ui.scope_id().with("chosen submenu");
    let chosen: Option<Submenu> = ui.data(|data| data.get_temp(chosen_id)).flatten();
    for part in parts(all, menu) {
        if part[0].begins_group {
            ui.separator();
        }

        let Some(submenu) = part[0].submenu else {
            entries(ui, part, commands);
            continue;
        };

        let is_open = chosen == Some(submenu);
        let mark = if is_open { "\u{2212}" } else { "+" };
        let name = ui.words(submenu.name());
        let button = Button::new(name.as_str())
            .right_text(mark)
            .min_size(vec2(ui.available_width(), FINGER))
            .frame_when_inactive(false);
        let response = ui.add(button);
        response.widget_info(|| WidgetInfo::selected(Role::Button, ENABLED, is_open, &name));
        response.known_as(format_args!("submenu.{}", Kebab(submenu)));

        // A click on the name of the open submenu closes it.
        if response.clicked() {
            let next = (!is_open).then_some(submenu);
            ui.data_mut(|data| data.insert_temp(chosen_id, next));
        }
        if is_open {
            ui.indent(submenu.name(), |ui| entries(ui, part, commands));
        }
    }
}

fn theme_button(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let other = state.appearance().look.other();
    let icon = if other.is_dark() {
        Icon::Moon
    } else {
        Icon::Sun
    };
    let palette = Palette::of(state.appearance().look);
    let button = icon_button(ui, icon, other.name(), None, palette);
    let command = Command::Appearance(AppearanceCommand::ToggleTheme);
    button.issues("toggle-theme", command, commands);
}

/// Shows the menus of the menu bar.
fn menus(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let all = std::cell::OnceCell::new();
    for menu in Menu::ALL {
        let button = ui.menu_button(ui.words(menu.name()), |ui| {
            // The actions are listed for an open menu alone, not in every frame.
            let all: &Vec<Action> = all.get_or_init(|| actions(state));
            scrolled_if_low(ui, |ui| {
                for part in parts(all, menu) {
                    submenu(ui, part, commands);
                }
            });
        });
        button.response.opens_menu(button.inner.is_some());
        let id = format_args!("menu.{}", Kebab(menu));
        button.response.known_as(id);
    }
}

/// Height of the bar above a menu and of the margins around it, in screen points.
const AROUND_MENU: f32 = 72.0;

/// Shows a menu, which scrolls only in a window lower than it.
fn scrolled_if_low(ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    let height = ui.ctx().content_rect().height() - AROUND_MENU;
    egui::ScrollArea::vertical()
        .max_height(height)
        .min_scrolled_height(height)
        .show(ui, add);
}

/// Returns the actions of a menu in parts: those of a submenu, or those between two submenus or lines. No part is
/// empty.
fn parts(all: &[Action], menu: Menu) -> impl Iterator<Item = &[Action]> {
    all.chunk_by(|a, b| {
        let is_new = b.begins_group && b.submenu.is_none();
        a.menu == b.menu && a.submenu == b.submenu && !is_new
    })
    .filter(move |part| part[0].menu == menu)
}

/// Shows a part of a menu: a button that opens its submenu, or the entries.
fn submenu(ui: &mut Ui, part: &[Action], commands: &mut Vec<Command>) {
    if part[0].begins_group {
        ui.separator();
    }
    let Some(submenu) = part[0].submenu else {
        entries(ui, part, commands);
        return;
    };
    let button = ui.menu_button(ui.words(submenu.name()), |ui| {
        scrolled_if_low(ui, |ui| entries(ui, part, commands));
    });
    button.response.opens_menu(button.inner.is_some());
    let id = format_args!("submenu.{}", Kebab(submenu));
    button.response.known_as(id);
}

/// Shows entries, with room for check marks if any of them can have one.
fn entries(ui: &mut Ui, part: &[Action], commands: &mut Vec<Command>) {
    let has_marks = part.iter().any(|action| action.is_on.is_some());
    for (index, action) in part.iter().enumerate() {
        if index > 0 && action.begins_group {
            ui.separator();
        }
        entry(ui, action, has_marks, commands);
    }
}

/// Side of a check mark, in screen points.
const MARK: f32 = 12.0;

/// Shows an entry of a menu: an action with its mark and its keys. `has_marks` says that some entry of its part can
/// have a mark.
fn entry(ui: &mut Ui, action: &Action, has_marks: bool, commands: &mut Vec<Command>) {
    // Where fingers are used there are no keys to press.
    let shortcut = action.shortcut.filter(|_| !is_for_fingers(ui.ctx()));
    let mark = IdSalt::new("check mark");
    let name = ui.words(action.label());
    // The room of the mark is there whether or not the entry is on, so that the names of the entries begin at one place.
    let mut button = if has_marks {
        Button::new((Atom::custom(mark, Vec2::splat(MARK)), name.as_str()))
    } else {
        Button::new(name.as_str())
    };

    if let Some(keys) = shortcut {
        button = button.shortcut_text(crate::actions::shortcut_text(ui.ctx(), &keys));
    }

    let is_enabled = action.refusal.is_none();
    let shown = ui.add_enabled_ui(is_enabled, |ui| {
        let shown = button.atom_ui(ui);
        if let Some(rect) = shown.rect(mark).filter(|_| action.is_on == Some(true)) {
            check_mark(ui.painter(), rect.center(), ui.visuals().text_color());
        }
        shown
    });

    let response = shown.inner.response;
    if let Some(is_on) = action.is_on {
        response.widget_info(|| WidgetInfo::selected(Role::CheckBox, is_enabled, is_on, &name));
    }
    response.known_as(format_args!("entry.{}", action.id()));

    let response = response.on_disabled_hover_text(action.refusal.as_deref().unwrap_or_default());
    if response.clicked() {
        commands.push(action.command.clone());
        ui.close();
    }
}

fn check_mark(painter: &egui::Painter, at: egui::Pos2, color: egui::Color32) {
    let offsets = [vec2(-4.0, 0.0), vec2(-1.0, 3.5), vec2(4.5, -4.0)];
    let ends = offsets.map(|offset| at + offset).to_vec();
    painter.add(Shape::line(ends, Stroke::new(1.6, color)));
}
