//! The help sheet: the keys, the terms, and a description of the program. Sizes are in screen points, and chosen, not
//! measured, where no reason stands beside them.

use egui::{Align, Button, FontId, Grid, Id, Label, Layout, Modal, RichText, Ui, vec2};
use tilescope_drawing::palette::Palette;
use tilescope_session::glossary::terms;
use tilescope_session::layers::Layer;
use tilescope_ui::theme::semibold;
use tilescope_ui::widgets::{Kebab, Known, figure, heading, name_group};

use super::sheet;
use crate::actions::{Action, Menu, actions, shortcut_text};
use tilescope_workbench::command::{Command, WindowCommand};
use tilescope_workbench::help::HelpPage;
use tilescope_workbench::state::State;

/// Width of the sheet, in screen points.
const WIDTH: f32 = 620.0;
/// Width of the sheet of keys, which have two columns.
const WIDTH_OF_KEYS: f32 = 880.0;
/// Room from which on the keys have two columns.
const TWO_COLUMNS: f32 = 720.0;
/// Width of the column of keys.
const KEYS_WIDTH: f32 = 120.0;
/// The height of a heading among keys, in rows.
const ROWS_OF_HEADING: usize = 2;

/// How to cite the paper.
const BIBTEX: &str = "@inproceedings{WangSuda2017,
  author    = {Wang, Tong and Suda, Reiji},
  title     = {Fast Maximal {Poisson}-Disk Sampling by Randomized Tiling},
  booktitle = {Proceedings of High-Performance Graphics (HPG '17)},
  year      = {2017},
  doi       = {10.1145/3105762.3105778}
}";

/// Shows the sheet, if it is open.
pub fn show(ui: &Ui, state: &State, commands: &mut Vec<Command>) {
    let Some(page) = state.window().help else {
        return;
    };
    let palette = Palette::of(state.appearance().look);
    let modal = Modal::new(Id::unique("help")).show(ui.ctx(), |ui| {
        let width = match page {
            HelpPage::Keys => WIDTH_OF_KEYS,
            HelpPage::Terms | HelpPage::About => WIDTH,
        };
        ui.set_width(sheet::width(ui, width));

        let mut is_closed = false;
        ui.horizontal(|ui| {
            let tabs = ui.horizontal(|ui| {
                for other in HelpPage::ALL {
                    let tab = ui.selectable_label(other == page, other.name());
                    tab.known_as(format_args!("help.{}", Kebab(other)));
                    if tab.clicked() {
                        commands.push(Command::Window(WindowCommand::Help(other)));
                    }
                }
            });
            name_group(&tabs.response, "Pages");
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let close = ui.button("Close");
                is_closed = close.known_as("help.close").clicked();
            });
        });

        ui.separator();
        sheet::scrolled(ui, width, |ui| match page {
            HelpPage::Keys => keys(ui, state, palette),
            HelpPage::Terms => glossary(ui, palette),
            HelpPage::About => about(ui, palette),
        });
        is_closed
    });

    // Escape and a click beside the sheet close it as well.
    if modal.inner || modal.should_close() {
        commands.push(Command::Window(WindowCommand::CloseHelp));
    }
}

/// Lists the keys of all actions, menu by menu, in two columns where there is room.
fn keys(ui: &mut Ui, state: &State, palette: &Palette) {
    let all = actions(state);
    let has_keys = |action: &&Action| action.shortcut.is_some();
    let menus: Vec<(Menu, Vec<&Action>)> = Menu::ALL
        .into_iter()
        .map(|menu| {
            let of_menu = all.iter().filter(|action| action.menu == menu);
            (menu, of_menu.filter(has_keys).collect())
        })
        .filter(|(_, keyed): &(Menu, Vec<&Action>)| !keyed.is_empty())
        .collect();

    if ui.available_width() < TWO_COLUMNS {
        for menu in &menus {
            keys_of_menu(ui, menu, palette);
        }
    } else {
        // Menus stay whole; the first column takes them while it has less than half of the rows.
        let rows = |menu: &(Menu, Vec<&Action>)| menu.1.len() + ROWS_OF_HEADING;
        let all_rows: usize = menus.iter().map(rows).sum();
        let mut before = 0;
        let first = menus.iter().take_while(|menu| {
            let is_first = 2 * before < all_rows;
            before += rows(menu);
            is_first
        });
        let (left, right) = menus.split_at(first.count());
        ui.columns(2, |columns| {
            for (ui, menus) in columns.iter_mut().zip([left, right]) {
                // Columns justify their texts, which tears short ones apart.
                ui.with_layout(Layout::top_down(Align::Min), |ui| {
                    for menu in menus {
                        keys_of_menu(ui, menu, palette);
                    }
                });
            }
        });
    }
    heading(ui, "On the canvas");
    ui.label(
        "Drag to move, turn the wheel or pinch to zoom. A click selects a sample or a place, a double click flies to its \
         block. The right button opens a menu about what is there. With the canvas focused, arrow keys move it, Enter \
         selects in its middle, and the menu key opens that menu. Tab leads on to the list of the objects in view, of which \
         up and down select one.",
    );
}

/// Lists the keys of the actions of a menu.
fn keys_of_menu(ui: &mut Ui, (menu, keyed): &(Menu, Vec<&Action>), palette: &Palette) {
    heading(ui, menu.name());
    let grid = Grid::new(menu.name())
        .num_columns(2)
        .spacing(vec2(12.0, 3.0));
    grid.min_col_width(KEYS_WIDTH).show(ui, |ui| {
        for action in keyed {
            let texts = action.keys().map(|keys| shortcut_text(ui.ctx(), &keys));
            let keys = texts.collect::<Vec<_>>().join(", ");
            ui.label(RichText::new(keys).monospace().color(palette.accent));
            ui.add(Label::new(action.name.as_str()).wrap());
            ui.end_row();
        }
    });
}

/// Lists the terms with their meanings.
fn glossary(ui: &mut Ui, palette: &Palette) {
    for term in terms() {
        ui.horizontal_wrapped(|ui| {
            ui.label(RichText::new(term.name).font(FontId::new(13.5, semibold())));
            if !term.paper.is_empty() {
                let section = format!("section {} of the paper", term.paper);
                ui.label(RichText::new(section).small().color(palette.muted));
            }
        });
        ui.label(term.meaning);
        // Layers are explained by the sentences of their terms, and have a figure.
        let layer = Layer::ALL
            .into_iter()
            .find(|l| l.explanation() == term.meaning);
        if let Some(layer) = layer {
            figure(ui, layer, palette);
        }
        ui.add_space(6.0);
    }
}

/// Describes the program, names the paper that it shows, and offers the citation.
fn about(ui: &mut Ui, palette: &Palette) {
    let name = concat!("Tilescope ", env!("CARGO_PKG_VERSION"));
    ui.label(RichText::new(name).font(FontId::new(17.0, semibold())))
        .known_as("help.version");
    ui.label(
        "Shows how maximal Poisson-disk sets are made by KD-tree based randomized tiling (KDRT): a run is recorded, and any \
         moment of it can be visited, questioned and explained. Every set is judged by code that shares nothing with the \
         sampler.",
    );

    heading(ui, "The paper");
    ui.label(
        "Tong Wang and Reiji Suda: Fast Maximal Poisson-Disk Sampling by Randomized Tiling. High-Performance Graphics, 2017.",
    );
    ui.hyperlink_to(
        "doi.org/10.1145/3105762.3105778",
        "https://doi.org/10.1145/3105762.3105778",
    );
    ui.add_space(4.0);

    ui.label(RichText::new(BIBTEX).font(FontId::monospace(11.0)));
    let copy = ui.add(Button::new("Copy the citation"));
    if copy.known_as("help.copy").clicked() {
        ui.ctx().copy_text(BIBTEX.to_owned());
    }

    heading(ui, "Licences");
    ui.label(
        "Tilescope is licensed under the MIT license or the Apache License 2.0, as you choose.",
    );
    ui.label(
        RichText::new(
            "The fonts Inter and JetBrains Mono are under the SIL Open Font License 1.1.",
        )
        .color(palette.muted),
    );
}
