//! The help sheet: the keys, the terms, and a description of the program.

use egui::{Align, Button, FontId, Grid, Id, Label, Layout, Modal, RichText, Ui, vec2};
use tilescope_drawing::palette::Palette;
use tilescope_session::glossary::TERMS;
use tilescope_session::layers::Layer;
use tilescope_ui::theme::semibold;
use tilescope_ui::widgets::{Kebab, Known, figure, heading};

use super::sheet;
use crate::actions::{Menu, actions};
use tilescope_workbench::command::{Command, WindowCommand};
use tilescope_workbench::help::HelpPage;
use tilescope_workbench::state::State;

/// Width of the sheet, in screen points.
const WIDTH: f32 = 620.0;
/// Width of the column of keys.
const KEYS_WIDTH: f32 = 150.0;

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
    let Some(page) = state.window.help else {
        return;
    };
    let palette = Palette::of(state.appearance.look);
    let modal = Modal::new(Id::unique("help")).show(ui.ctx(), |ui| {
        ui.set_width(sheet::width(ui, WIDTH));
        let mut is_closed = false;
        ui.horizontal(|ui| {
            for other in HelpPage::ALL {
                let tab = ui.selectable_label(other == page, other.name());
                tab.known_as(format_args!("help.{}", Kebab(other)));
                if tab.clicked() {
                    commands.push(Command::Window(WindowCommand::Help(other)));
                }
            }
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                let close = ui.button("Close");
                is_closed = close.known_as("help.close").clicked();
            });
        });
        ui.separator();
        sheet::scrolled(ui, WIDTH, |ui| match page {
            HelpPage::Keys => keys(ui, state, palette),
            HelpPage::Terms => terms(ui, palette),
            HelpPage::About => about(ui, palette),
        });
        is_closed
    });
    if modal.inner || modal.should_close() {
        commands.push(Command::Window(WindowCommand::CloseHelp));
    }
}

/// Lists the keys of all actions, menu by menu.
fn keys(ui: &mut Ui, state: &State, palette: &Palette) {
    let all = actions(state);
    for menu in Menu::ALL {
        let keyed = all.iter().filter(|action| action.menu == menu);
        let keyed: Vec<_> = keyed.filter(|action| action.shortcut.is_some()).collect();
        if keyed.is_empty() {
            continue;
        }
        heading(ui, menu.name());
        let grid = Grid::new(menu.name())
            .num_columns(2)
            .spacing(vec2(12.0, 3.0));
        grid.min_col_width(KEYS_WIDTH).show(ui, |ui| {
            for action in keyed {
                let keys = action.keys().map(|keys| ui.ctx().format_shortcut(&keys));
                let keys = keys.collect::<Vec<_>>().join(", ");
                ui.label(RichText::new(keys).monospace().color(palette.accent));
                ui.add(Label::new(action.name.as_str()).wrap());
                ui.end_row();
            }
        });
    }
    heading(ui, "On the canvas");
    ui.label(
        "Drag to move, turn the wheel or pinch to zoom. A click selects a sample or a place, a double click flies to its \
         block. The right button opens a menu about what is there. With the canvas focused, arrow keys move it, Enter \
         selects in its middle, and the menu key opens that menu.",
    );
}

/// Lists the terms with their meanings.
fn terms(ui: &mut Ui, palette: &Palette) {
    for term in TERMS {
        ui.horizontal_wrapped(|ui| {
            ui.label(RichText::new(term.name).font(FontId::new(13.5, semibold())));
            if !term.paper.is_empty() {
                let section = format!("section {} of the paper", term.paper);
                ui.label(RichText::new(section).small().color(palette.muted));
            }
        });
        ui.label(term.meaning);
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
    ui.label(RichText::new(BIBTEX).monospace().small());
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
