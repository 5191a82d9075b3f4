//! The inspector: everything known about the sample pointed at, or else the selected one.

use egui::{RichText, Ui, vec2};
use tilescope_core::stages::detect::Sites;
use tilescope_core::{Fate, Origin, Stage, Standing};

use super::divide;
use crate::command::Command;
use crate::sentence::grouped;
use crate::session::Session;
use crate::state::State;
use crate::theme::Palette;
use crate::widgets::{heading, row};

/// Height kept for the sample's rows, so that the legend below stays where it is.
const HEIGHT: f32 = 200.0;

/// Shows the inspector.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.look);
    let id = state.hovered.or(state.selected);
    let name = match (state.hovered, state.selected) {
        (Some(_), _) => "Sample under the pointer",
        (None, Some(_)) => "Selected sample",
        (None, None) => "Sample",
    };
    heading(ui, name);
    let size = vec2(ui.available_width(), HEIGHT);
    ui.allocate_ui(size, |ui| {
        ui.set_min_size(size);
        ui.spacing_mut().item_spacing.y = 2.0;
        ui.spacing_mut().interact_size.y = 18.0;
        if let (Some(id), Some(session), Some(stage)) = (id, &state.session, state.current_stage())
        {
            sample(ui, session, stage, id, palette, commands);
        } else {
            let text = "Point at a sample to read where it comes from and what became of it; click to keep it.";
            ui.label(RichText::new(text).color(palette.muted));
        }
    });
    divide(ui, palette);
}

fn sample(
    ui: &mut Ui,
    session: &Session,
    stage: Stage,
    id: u32,
    palette: &Palette,
    commands: &mut Vec<Command>,
) {
    let run = session.run();
    let point = run.samples.points[id as usize];
    let place = run.domain.user_from_lattice(point);
    row(ui, "Id", &grouped(id as usize), palette);
    row(ui, "x", &format!("{:.6}", place[0]), palette);
    row(ui, "y", &format!("{:.6}", place[1]), palette);
    match run.samples.origins[id as usize] {
        Origin::Tiled {
            block,
            pattern,
            own,
        } => {
            row(ui, "Tiled into block", &block.to_string(), palette);
            row(ui, "Pattern sample", &grouped(pattern as usize), palette);
            let lies = if own {
                "inside its block"
            } else {
                "in the margin"
            };
            row(ui, "Lies", lies, palette);
        }
        Origin::Inserted { iteration, sites } => {
            row(ui, "Inserted in iteration", &iteration.to_string(), palette);
            match sites {
                Sites::Three(ids) => others(ui, "At the circumcentre of", &ids, palette, commands),
                Sites::Border(ids) => others(ui, "On the border between", &ids, palette, commands),
                Sites::Corner(id) => others(ui, "In the corner near", &[id], palette, commands),
                Sites::Dart => row(ui, "By", "a dart", palette),
                Sites::Unrecorded => row(ui, "Sites", "not kept in a large run", palette),
            }
        }
    }
    let standing = match run.standing(id, stage) {
        Standing::Absent => "not there yet",
        Standing::Tiled => "tiled, undecided",
        Standing::Valid => "valid",
        Standing::Eliminated { .. } => "eliminated",
        Standing::Dropped => "outside the domain",
    };
    row(ui, "At this stage", standing, palette);
    match run.samples.fates[id as usize] {
        Fate::Undecided => row(ui, "In the end", "undecided", palette),
        Fate::Kept => row(ui, "In the end", "kept", palette),
        Fate::Dropped => row(ui, "In the end", "dropped", palette),
        Fate::Eliminated { by } => others(ui, "Eliminated by", &[by], palette, commands),
    }
}

fn others(ui: &mut Ui, name: &str, ids: &[u32], palette: &Palette, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        ui.label(RichText::new(name).color(palette.muted));
        if ids.len() < 3 {
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                links(ui, ids, commands);
            });
        }
    });
    if ids.len() >= 3 {
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Min), |ui| {
            ui.set_max_height(20.0);
            links(ui, ids, commands);
        });
    }
}

fn links(ui: &mut Ui, ids: &[u32], commands: &mut Vec<Command>) {
    for &id in ids.iter().rev() {
        let link = ui.link(RichText::new(grouped(id as usize)).monospace());
        if link.on_hover_text("Select it and fly there").clicked() {
            commands.push(Command::GoToSample(id));
        }
    }
}
