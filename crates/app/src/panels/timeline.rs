//! The timeline: what happened last, in a sentence, and the ways through time.

use egui::text::LayoutJob;
use egui::{Align, Button, ComboBox, FontId, Layout, RichText, Role, Ui, WidgetInfo, vec2};
use tilescope_core::Stage;

use super::track;
use crate::actions::time_refusals;
use crate::clock::{Clock, SPEEDS};
use crate::command::{Command, TimeCommand};
use crate::sentence::{counted, grouped, stage_sentence};
use crate::state::State;
use crate::theme::{FINGER, Palette};
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
        clock(ui, state, 72.0, commands);
        speed(ui, state, commands);
        ui.add_space(14.0);
        track::show(ui, state, commands);
    });
}

/// Height of the sentence and of the controls between their margins.
const LINE: f32 = 20.0;
/// Between the rows of a small window.
const APART: f32 = 4.0;

/// Returns how high the controls of a small window are; a low one has one line for the sentence instead of two.
#[must_use]
pub fn compact_height(is_low: bool) -> f32 {
    12.0 + sentence_height(is_low) + FINGER + 2.0 + track::COMPACT_HEIGHT + 2.0 * APART
}

const fn sentence_height(is_low: bool) -> f32 {
    if is_low { LINE } else { 2.0 * LINE }
}

/// Shows the sentence, the controls and the track below each other, large enough for fingers.
pub fn show_compact(ui: &mut Ui, state: &State, is_low: bool, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.y = APART;
    let size = vec2(ui.available_width(), sentence_height(is_low));
    ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
        ui.set_min_size(size);
        let mut text = LayoutJob::simple(
            happened(state),
            FontId::proportional(14.5),
            Palette::of(state.look).text,
            size.x,
        );
        // What does not fit is in the panel of the clocks.
        text.wrap.max_rows = if is_low { 1 } else { 2 };
        let galley = ui.painter().layout_job(text);
        let response = ui.add(egui::Label::new(galley));
        super::read_out(ui, &response);
    });
    ui.horizontal(|ui| {
        controls(ui, state, commands);
        ui.add_space(6.0);
        clock(ui, state, ui.available_width().min(110.0), commands);
    });
    track::show(ui, state, commands);
}

/// Shows what a small window has no room for beside its controls: the whole sentence, counts, speed, the line and the loop.
pub fn more(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.look);
    ui.label(RichText::new(happened(state)).size(14.5));
    for text in told(state) {
        ui.label(RichText::new(text).monospace().color(palette.muted));
    }
    ui.add_space(4.0);
    ui.horizontal_wrapped(|ui| {
        clock(ui, state, 110.0, commands);
        speed(ui, state, commands);
    });
    ui.horizontal_wrapped(|ui| {
        for (name, command) in [
            ("Loop from here", TimeCommand::LoopStart),
            ("Loop up to here", TimeCommand::LoopEnd),
            ("No loop", TimeCommand::Loop(None)),
        ] {
            let button = ui.add_enabled(state.debugger.is_some(), Button::new(name));
            let button = button.on_disabled_hover_text("There are no events to go round.");
            if button.clicked() {
                commands.push(Command::Time(command));
            }
        }
    });
}

fn counts(ui: &mut Ui, state: &State, palette: &Palette) {
    let told = told(state);
    if told.is_empty() {
        return;
    }
    let text = told.join("   ");
    ui.label(RichText::new(text).monospace().color(palette.muted));
    ui.add_space(24.0);
}

/// Returns how much of what there is at this moment, and which moment it is.
fn told(state: &State) -> Vec<String> {
    let Some(session) = &state.session else {
        return Vec::new();
    };
    let count = match session.stages[state.stage] {
        Stage::Blocks if session.combination.is_some() => {
            counted(session.summary.blocks, "piece", "pieces")
        }
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
    let mut told = vec![count, place];
    if let Stage::Iterate(k) = session.stages[state.stage] {
        told.push(format!("iteration {k}"));
    }
    told
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

/// What a tick is.
fn clock(ui: &mut Ui, state: &State, width: f32, commands: &mut Vec<Command>) {
    let playback = &state.playback;
    let chosen = ComboBox::from_id_salt("clock")
        .width(width)
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
}

/// How fast time runs.
fn speed(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let playback = &state.playback;
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
