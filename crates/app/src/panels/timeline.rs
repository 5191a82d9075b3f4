//! The timeline: what happened last, in a sentence, and the ways through time.

use egui::{Align, Button, ComboBox, Layout, RichText, Role, Ui, WidgetInfo};
use tilescope_core::Stage;

use super::track;
use crate::actions::time_refusals;
use crate::clock::{Clock, SPEEDS};
use crate::command::{Command, TimeCommand};
use crate::sentence::{counted, grouped, stage_sentence};
use crate::state::State;
use crate::theme::Palette;
use crate::widgets::{Icon, icon_button};

/// From this width on there is room beside the sentence.
const WIDE: f32 = 760.0;

/// Shows the panel.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.look);
    ui.horizontal(|ui| {
        ui.set_height(24.0);
        let sentence = happened(state);
        // What happened comes before how much of it there is.
        let wide = ui.available_width() >= WIDE;
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if wide {
                counts(ui, state, palette);
            }
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                let label = egui::Label::new(RichText::new(sentence).size(15.0)).truncate();
                let response = ui.add(label);
                super::read_out(ui, &response);
            });
        });
    });
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        controls(ui, state, commands);
        ui.add_space(6.0);
        clocks(ui, state, commands);
        ui.add_space(14.0);
        track::show(ui, state, commands);
    });
}

fn counts(ui: &mut Ui, state: &State, palette: &Palette) {
    let Some(session) = &state.session else {
        return;
    };
    let count = match session.stages[state.stage] {
        Stage::Blocks => counted(session.summary.blocks, "block", "blocks"),
        Stage::Pattern => format!("{} samples", grouped(session.count_after(state.stage))),
        _ => match &state.debugger {
            Some(debugger) => {
                let counts = debugger.state().counts();
                format!("{} samples", grouped(counts.undecided + counts.kept))
            }
            None => format!("{} samples", grouped(session.count_after(state.stage))),
        },
    };
    let place = match state.cursor() {
        Some((at, len)) => format!("event {} of {}", grouped(at), grouped(len)),
        None => format!("stage {} of {}", state.stage + 1, session.stages.len()),
    };
    let iteration = match session.stages[state.stage] {
        Stage::Iterate(k) => format!("   iteration {k}"),
        _ => String::new(),
    };
    let text = format!("{count}   {place}{iteration}");
    ui.label(RichText::new(text).monospace().color(palette.muted));
    ui.add_space(24.0);
}

fn controls(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.look);
    let no_session = state
        .session
        .is_none()
        .then_some("There is no session yet.");
    let [at_end, at_start] = time_refusals(state);
    let (play, play_name) = if state.playback.is_playing() {
        (Icon::Pause, "Pause (Space)")
    } else {
        (Icon::Play, "Play (Space)")
    };
    let clock = state.playback.clock.name();
    ui.spacing_mut().item_spacing.x = 2.0;
    for (icon, name, refusal, command) in [
        (
            Icon::First,
            "First stage (Home)",
            at_start,
            Command::FirstStage,
        ),
        (
            Icon::Back,
            &format!("{} back (Left)", capital(clock)),
            at_start,
            Command::StepBack,
        ),
        (play, play_name, no_session, Command::TogglePlay),
        (
            Icon::Forward,
            &format!("{} forward (Right)", capital(clock)),
            at_end,
            Command::StepForward,
        ),
        (Icon::Last, "Last stage (End)", at_end, Command::LastStage),
    ] {
        if icon_button(ui, icon, name, refusal, palette).clicked() {
            commands.push(command);
        }
    }
}

/// What has happened last: the stage, where it is whole, else the event.
#[must_use]
pub fn happened(state: &State) -> String {
    let Some(shown) = state.shown() else {
        return "The default session is being sampled.".to_owned();
    };
    match (shown.debugger, shown.cursor().checked_sub(1)) {
        (Some(debugger), Some(last)) if !shown.ends_stage() => {
            tilescope_debugger::sentence(debugger.recording(), last)
        }
        _ => stage_sentence(shown.session, shown.stage),
    }
}

fn capital(name: &str) -> String {
    let mut letters = name.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}

/// What a tick is, and how fast time runs.
fn clocks(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let playback = &state.playback;
    let chosen = ComboBox::from_id_salt("clock")
        .width(72.0)
        .selected_text(playback.clock.name());
    let response = chosen.show_ui(ui, |ui| {
        for clock in Clock::ALL {
            let refusal = state.clock_refusal(clock);
            let button = Button::selectable(playback.clock == clock, clock.name());
            let response = ui.add_enabled(refusal.is_none(), button);
            let response = response.on_disabled_hover_text(refusal.unwrap_or_default());
            if response.clicked() {
                commands.push(Command::Time(TimeCommand::Clock(clock)));
            }
        }
    });
    let response = response.response;
    response.widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, "Clock"));
    response.on_hover_text("What one tick of play and the arrow keys is");
    let chosen = ComboBox::from_id_salt("speed")
        .width(58.0)
        .selected_text(format!("{}\u{d7}", playback.speed));
    let response = chosen.show_ui(ui, |ui| {
        for speed in SPEEDS {
            let same = (playback.speed - speed).abs() < 1e-6;
            if ui
                .selectable_label(same, format!("{speed}\u{d7}"))
                .clicked()
            {
                commands.push(Command::Time(TimeCommand::Speed(speed)));
            }
        }
    });
    response
        .response
        .widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, "Speed"));
}
