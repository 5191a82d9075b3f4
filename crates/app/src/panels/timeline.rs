//! The bottom panel: what happened at the stage shown, in a sentence, and the stages to go through.

use egui::{
    Align, Align2, CursorIcon, FontId, Key, Layout, Pos2, Rect, Response, RichText, Role, Sense,
    Stroke, Ui, WidgetInfo, pos2, vec2,
};
use tilescope_core::Stage;

use crate::command::Command;
use crate::sentence::{counted, grouped, stage_name, stage_sentence};
use crate::state::State;
use crate::theme::Palette;
use crate::widgets::{Icon, icon_button};

/// Stages closer than this on the track show only short names, in screen points.
const ROOM_FOR_NAMES: f32 = 74.0;

/// Shows the panel.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.theme);
    keys(ui, commands);
    ui.horizontal(|ui| {
        ui.set_height(24.0);
        let sentence = match (&state.session, state.current_stage()) {
            (Some(session), Some(stage)) => stage_sentence(session, stage),
            _ => "The default session is being sampled.".to_owned(),
        };
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            counts(ui, state, palette);
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.add(egui::Label::new(RichText::new(sentence).size(15.0)).truncate());
            });
        });
    });
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        controls(ui, state, commands);
        ui.add_space(18.0);
        track(ui, state, commands);
    });
}

fn keys(ui: &Ui, commands: &mut Vec<Command>) {
    if ui.ctx().text_edit_focused() {
        return;
    }
    ui.input(|i| {
        for (key, command) in [
            (Key::ArrowLeft, Command::StepBack),
            (Key::ArrowRight, Command::StepForward),
            (Key::Home, Command::FirstStage),
            (Key::End, Command::LastStage),
        ] {
            if i.key_pressed(key) && i.modifiers.is_none() {
                commands.push(command);
            }
        }
    });
    // A focused button takes the space key for itself.
    if ui.memory(|m| m.focused().is_none()) && ui.input(|i| i.key_pressed(Key::Space)) {
        commands.push(Command::TogglePlay);
    }
}

fn counts(ui: &mut Ui, state: &State, palette: &Palette) {
    let Some(session) = &state.session else {
        return;
    };
    let count = match session.stages[state.stage] {
        Stage::Blocks => counted(session.summary.blocks, "block", "blocks"),
        _ => format!("{} samples", grouped(session.count_after(state.stage))),
    };
    let text = format!(
        "{count}   stage {} of {}",
        state.stage + 1,
        session.stages.len()
    );
    ui.label(RichText::new(text).monospace().color(palette.muted));
    ui.add_space(24.0);
}

fn controls(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.theme);
    let last = state.session.as_ref().map_or(0, |s| s.stages.len() - 1);
    let no_session = state
        .session
        .is_none()
        .then_some("There is no session yet.");
    let at_start = no_session.or((state.stage == 0).then_some("This is the first stage."));
    let at_end = no_session.or((state.stage == last).then_some("This is the last stage."));
    let (play, play_name) = match state.playing {
        Some(_) => (Icon::Pause, "Pause (Space)"),
        None => (Icon::Play, "Play (Space)"),
    };
    ui.spacing_mut().item_spacing.x = 2.0;
    for (icon, name, refusal, command) in [
        (
            Icon::First,
            "First stage (Home)",
            at_start,
            Command::FirstStage,
        ),
        (Icon::Back, "Stage back (Left)", at_start, Command::StepBack),
        (play, play_name, no_session, Command::TogglePlay),
        (
            Icon::Forward,
            "Stage forward (Right)",
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

/// A line with a node for each stage; click or drag to go there.
fn track(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let palette = Palette::of(state.theme);
    let size = vec2(ui.available_width() - 12.0, 46.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::drag());
    let Some(session) = &state.session else {
        return;
    };
    let last = session.stages.len() - 1;
    response.widget_info(|| WidgetInfo::slider(true, state.stage as f64, "Stage"));
    let line = Rect::from_min_max(
        pos2(rect.left() + 30.0, rect.top() + 13.0),
        pos2(rect.right() - 30.0, rect.top() + 13.0),
    );
    let step = line.width() / last.max(1) as f32;
    let node = |place: usize| pos2(line.left() + step * place as f32, line.top());
    if response.dragged()
        && let Some(pos) = response.interact_pointer_pos()
    {
        let place = ((pos.x - line.left()) / step)
            .round()
            .clamp(0.0, last as f32) as usize;
        if place != state.stage {
            commands.push(Command::ShowStage(place));
        }
    }
    let painter = ui.painter();
    let rail = Stroke::new(3.0, palette.line);
    painter.line_segment([node(0), node(last)], rail);
    let passed = Stroke::new(3.0, palette.accent);
    painter.line_segment([node(0), node(state.stage)], passed);
    for (place, &stage) in session.stages.iter().enumerate() {
        let middle = node(place);
        let area = Rect::from_center_size(middle + vec2(0.0, 9.0), vec2(step.min(96.0), 46.0));
        let response = ui.interact(area, ui.scope_id().with(("stage", place)), Sense::click());
        let clicked = stop(
            ui,
            &response,
            middle,
            stage,
            place,
            state,
            step > ROOM_FOR_NAMES,
        );
        if clicked {
            commands.push(Command::ShowStage(place));
        }
    }
}

fn stop(
    ui: &Ui,
    response: &Response,
    middle: Pos2,
    stage: Stage,
    place: usize,
    state: &State,
    roomy: bool,
) -> bool {
    let palette = Palette::of(state.theme);
    let name = stage_name(stage);
    let current = place == state.stage;
    response.widget_info(|| WidgetInfo::selected(Role::Button, true, current, &name));
    let painter = ui.painter();
    let hot = response.hovered() || response.has_focus();
    let reached = place <= state.stage;
    let color = if reached {
        palette.accent
    } else {
        palette.border
    };
    if current || hot {
        painter.circle_filled(middle, 11.0, palette.accent.gamma_multiply(0.22));
    }
    let radius = if current { 7.0 } else { 5.0 };
    let fill = if reached {
        palette.accent
    } else {
        palette.panel
    };
    painter.circle(middle, radius, fill, Stroke::new(2.0, color));
    let text = match stage {
        Stage::Iterate(k) if !roomy => k.to_string(),
        _ if roomy || current => name.clone(),
        _ => name.chars().take(1).collect(),
    };
    let ink = if current { palette.text } else { palette.muted };
    let font = FontId::proportional(12.0);
    painter.text(
        middle + vec2(0.0, 14.0),
        Align2::CENTER_TOP,
        text,
        font,
        ink,
    );
    response
        .clone()
        .on_hover_cursor(CursorIcon::PointingHand)
        .clicked()
}
