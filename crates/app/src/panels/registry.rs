//! The registry of panels: how each fills its tile, and the part of the state that it receives. To add a panel, begin here
//! with `row`; its name, its letter in links and where it stands by default are in `workbench/src/layout.rs`.

use egui::{Frame, Margin, ScrollArea, Ui, Vec2, vec2};
use tilescope_debugger::Direction;
use tilescope_drawing::palette::Palette;
use tilescope_ui::widgets::Known;

use super::analysis::AnalysisContext;
use super::common::scrolled;
use super::compare::CompareContext;
use super::context::{PanelContext, TimeContext};
use super::parameters::FormContext;
use super::{
    analysis, compare, events, inspector, layers, legend, parameters, pseudocode, scenes, stages,
    timeline, verification, watches,
};
use crate::actions::keys_of;
use crate::panes::Canvas;
use crate::panes::CanvasContext;
use tilescope_workbench::command::{Command, GpuCommand, TimeCommand};
use tilescope_workbench::compare::ComparePreset;
use tilescope_workbench::device::{CHOOSE_GPU_FIRST, EngineChoice};
use tilescope_workbench::layout::Panel;
use tilescope_workbench::state::State;

/// How the content of a panel fills its tile.
enum Room {
    /// It scrolls as a whole.
    Scrolled,
    /// It does its own layout.
    Whole,
}

/// How to show a panel.
enum Show {
    /// From the context of run A.
    Run(fn(&mut Ui, &PanelContext<'_>, &mut Vec<Command>)),
    /// From a context of its own.
    Parts(fn(&mut Ui, &State, &mut Vec<Command>)),
}

impl Show {
    fn call(&self, ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
        match self {
            Self::Run(show) => show(ui, &PanelContext::of(state), commands),
            Self::Parts(show) => show(ui, state, commands),
        }
    }
}

/// Returns how a panel is shown. For the canvas this is the bar above it; the canvas itself is drawn by `app.rs`, which
/// keeps its caches.
fn row(panel: Panel) -> (Room, Show) {
    use Room::{Scrolled, Whole};
    use Show::{Parts, Run};
    match panel {
        Panel::Statistics => (Scrolled, Run(stages::show)),
        Panel::Inspector => (Scrolled, Run(inspector::show)),
        Panel::Watches => (Scrolled, Run(watches::show)),
        Panel::Verification => (Scrolled, Run(verification::show)),
        Panel::Pseudocode => (Whole, Run(pseudocode::show)),
        Panel::Events => (Whole, Run(events::show)),
        Panel::Canvas => (Whole, Run(layers::show)),
        Panel::Timeline => (
            Whole,
            Parts(|ui, state, commands| {
                timeline::show(ui, &TimeContext::of(state), commands);
            }),
        ),
        Panel::Scenes => (
            Scrolled,
            Parts(|ui, state, commands| {
                let run_on = Command::Time(TimeCommand::Continue(Direction::Forwards));
                let keys = keys_of(state, &run_on);
                scenes::show(ui, state, keys, commands);
            }),
        ),
        Panel::Legend => (
            Scrolled,
            Parts(|ui, state, commands| {
                legend::show(ui, &PanelContext::of(state), state.causes(), commands);
            }),
        ),
        Panel::Compare => (
            Scrolled,
            Parts(|ui, state, commands| {
                compare::show(ui, &CompareContext::of(state), commands);
            }),
        ),
        Panel::Analysis => (
            Scrolled,
            Parts(|ui, state, commands| {
                analysis::show(ui, &AnalysisContext::of(state), commands);
            }),
        ),
        Panel::Parameters => (
            Whole,
            Parts(|ui, state, commands| {
                parameters::show(ui, &FormContext::of(state), commands);
            }),
        ),
        Panel::Passes => (
            Whole,
            Parts(|ui, state, commands| {
                let refusal = state.passes_refusal();
                // The engine is all that is missing.
                let can_choose = refusal.as_deref() == Some(CHOOSE_GPU_FIRST);
                let context = PanelContext::of(state);
                passes(ui, &context, refusal.as_deref(), can_choose, commands);
            }),
        ),
    }
}

impl<'a> AnalysisContext<'a> {
    /// Returns the context of the analysis of run A.
    pub fn of(state: &'a State) -> Self {
        Self {
            palette: Palette::of(state.appearance().look),
            run: &state.runs().first,
            analysis: state.analysis(),
            reference_file: state.reference_file(),
            brush_text: state.brush_text(),
        }
    }
}

impl<'a> CompareContext<'a> {
    fn of(state: &'a State) -> Self {
        let presets = ComparePreset::ALL.map(|preset| (preset, state.preset_refusal(preset)));
        Self {
            palette: Palette::of(state.appearance().look),
            first: &state.runs().first,
            second: state.runs().second.as_ref(),
            presets: presets.into(),
            parting: state.parting_refusal(),
        }
    }
}

impl<'a> FormContext<'a> {
    fn of(state: &'a State) -> Self {
        Self {
            palette: Palette::of(state.appearance().look),
            form: state.form(),
            gpu: state.gpu(),
            sampling: state.runs().first.sampling.as_ref(),
            refusal: state.run_refusal(),
            remark: state.run_remark(),
            memory: state.form().draft.memory_needed(),
            engine_differs: state.engine_differs(),
            made: match &state.runs().first.session {
                Some(session) if session.has_recipe() => Some(session.recipe().parameters),
                _ => None,
            },
            engine: state
                .gpu()
                .engine_text(state.form().draft.parameters.variant),
            auto_is_gpu: state.gpu().takes(EngineChoice::Auto),
        }
    }
}

/// Shows a panel in its tile.
pub fn show_panel(
    ui: &mut Ui,
    panel: Panel,
    state: &State,
    canvas: &mut Canvas,
    commands: &mut Vec<Command>,
) {
    let frame = Frame::new().fill(Palette::of(state.appearance().look).panel);
    let side = frame.inner_margin(Margin {
        left: 12,
        right: 4,
        top: 8,
        bottom: 8,
    });
    let (room, show) = row(panel);
    match (panel, room) {
        (Panel::Canvas, _) => {
            let chips = frame.inner_margin(Margin::symmetric(12, 8));
            egui::Panel::top("layers")
                .frame(chips)
                .show(ui, |ui| show.call(ui, state, commands));
            canvas.show(ui, &CanvasContext::of(state), commands);
        }
        (Panel::Timeline, _) => {
            filled(ui, frame.inner_margin(TIMELINE_MARGIN), |ui| {
                show.call(ui, state, commands);
            });
        }
        (_, Room::Whole) => filled(ui, side, |ui| show.call(ui, state, commands)),
        (_, Room::Scrolled) => filled(ui, side, |ui| {
            scrolled(ui, panel, |ui| show.call(ui, state, commands));
        }),
    }
}

/// Returns the minimum size of a panel, in screen points, below which its rows would be cut off. The timeline's height
/// depends on its sentence.
#[must_use]
pub fn least_size(panel: Panel, timeline: f32) -> Vec2 {
    match panel {
        Panel::Canvas => vec2(320.0, 160.0),
        Panel::Timeline => vec2(320.0, timeline),
        Panel::Parameters => vec2(parameters::MIN_WIDTH + BESIDE_PANEL, MIN_PANEL_SIZE.y),
        // With less room it scrolls.
        Panel::Passes => Vec2::ZERO,
        _ => MIN_PANEL_SIZE,
    }
}

/// Minimum size of most panels, and of the tab labels of those that share a tile by default.
const MIN_PANEL_SIZE: Vec2 = vec2(272.0, 96.0);
/// A panel's margins and its scroll bar.
const BESIDE_PANEL: f32 = 28.0;

/// Margins of the timeline.
const TIMELINE_MARGIN: Margin = Margin::symmetric(16, 8);

/// Returns the minimum height of the timeline's tile of this width.
pub fn timeline_height(ctx: &egui::Context, state: &State, width: f32) -> f32 {
    let margin = TIMELINE_MARGIN.sum();
    timeline::height(ctx, &TimeContext::of(state), width - margin.x) + margin.y
}

fn filled(ui: &mut Ui, frame: Frame, add: impl FnOnce(&mut Ui)) {
    frame.show(ui, |ui| {
        ui.set_min_size(ui.available_size());
        add(ui);
    });
}

/// Minimum room for the list and table of passes, in screen points.
const ROOM_FOR_PASSES: egui::Vec2 = egui::vec2(620.0, 400.0);

/// Shows the GPU passes, or how to get them.
fn passes(
    ui: &mut Ui,
    context: &PanelContext<'_>,
    refusal: Option<&str>,
    can_choose: bool,
    commands: &mut Vec<Command>,
) {
    let palette = context.palette;
    if let Some(passes) = &context.run.passes {
        let mut own = Vec::new();
        // A list beside a table: it has no narrower form, so it scrolls.
        let size = ui.available_size().max(ROOM_FOR_PASSES);
        ScrollArea::both()
            .id_salt(Panel::Passes.name())
            .show(ui, |ui| {
                ui.allocate_ui(size, |ui| {
                    super::passes::show(ui, passes, palette, &mut own);
                });
            });
        commands.extend(own.into_iter().map(Command::Passes));
        return;
    }
    let text = "Every compute pass of this session's run on the GPU, with its buffers before and after, compared with the CPU.";
    ui.label(egui::RichText::new(text).color(palette.muted));
    let button = ui.add_enabled(refusal.is_none(), egui::Button::new("Run the passes"));
    button.known_as("passes.run");
    let button = button.on_disabled_hover_text(refusal.unwrap_or_default());
    if button.clicked() {
        commands.push(Command::OpenPasses);
    }
    if let Some(refusal) = refusal {
        ui.label(egui::RichText::new(refusal).color(palette.muted));
    }
    if can_choose {
        let choose = Command::Gpu(GpuCommand::Engine(EngineChoice::Gpu));
        let button = ui.button("Choose the GPU");
        let button = button.on_hover_text("Opens the GPU and tests it against the CPU");
        button.issues("passes.choose-gpu", choose, commands);
    }
}
