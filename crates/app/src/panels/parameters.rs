//! The parameter form: fields with their errors beside them, and below them the button that runs or cancels, which
//! stays in view.

use egui::{
    Color32, ComboBox, CursorIcon, ProgressBar, RichText, Sense, TextEdit, Ui, UiBuilder, vec2,
};
use tilescope_core::Parameters;
use tilescope_drawing::palette::Palette;
use tilescope_session::jobs::Job;
use tilescope_session::session::{MakeError, Session};
use tilescope_session::words::{grouped, sentence};
use tilescope_ui::theme::row_height;
use tilescope_ui::widgets::{Kebab, Known, heading, primary_button};

use super::choices::{
    BOUNDARIES, INSERTIONS, Listed, ORDERS, ORIENTATIONS, PATTERN_BOUNDARIES, SEARCHES, VARIANTS,
    meaning,
};
use super::engine;
use tilescope_workbench::command::{Command, FormCommand, Which};
use tilescope_workbench::draft::{Choice, DraftRefusal, Field, Preset};
use tilescope_workbench::layout::Panel;
use tilescope_workbench::state::{Form, GpuState};

/// Left edge of the fields, from the panel's left edge.
const FIELD_START: f32 = 102.0;
/// Minimum and maximum width of a field with its frame; the longest choice fits in the minimum.
const FIELD_WIDTHS: [f32; 2] = [140.0, 160.0];
/// Room for a unit beside a field.
const UNIT_WIDTH: f32 = 14.0;
/// Minimum width of the panel for its fields, without margins, in screen points.
pub(super) const MIN_WIDTH: f32 = FIELD_START + FIELD_WIDTHS[0] + UNIT_WIDTH;
/// Margin above and below the Run button.
const RUN_MARGIN: f32 = 6.0;
/// Height of the line above the button that names the parameters that differ from the run shown.
const REMARK_HEIGHT: f32 = 18.0;
/// Margin right of the button, equal to the scroll bar beside the fields.
const SCROLL_BAR_WIDTH: f32 = 8.0;
/// Width of the Cancel button.
const CANCEL_WIDTH: f32 = 60.0;
/// In a lower panel, in screen points, the button scrolls with the fields.
const MIN_HEIGHT_FOR_RUN: f32 = 100.0;

/// The context of the panel.
pub struct FormContext<'a> {
    /// The colours.
    pub palette: &'static Palette,
    /// The parameters and the engine.
    pub form: &'a Form,
    /// The state of the GPU.
    pub gpu: &'a GpuState,
    /// The run in progress.
    pub sampling: Option<&'a Job<Result<Session, MakeError>>>,
    /// Why the parameters cannot be run, if so.
    pub refusal: Option<String>,
    /// The parameters that differ from the run shown, if any.
    pub remark: Option<String>,
    /// The parameters of the run shown; a combination has none.
    pub made: Option<Parameters>,
    /// A remark on the engine of the next run: a short line and the full text.
    pub engine: Option<(&'static str, String)>,
    /// Whether the GPU is the default engine.
    pub auto_is_gpu: bool,
}

/// Returns the width of a field, given the room from `ui`'s cursor to the panel's right edge.
pub(super) fn field_width(ui: &Ui) -> f32 {
    let [least, most] = FIELD_WIDTHS;
    (ui.available_width() - UNIT_WIDTH).clamp(least, most)
}

/// Shows the panel: the fields scroll, and the button stays in view where there is room for both.
pub fn show(ui: &mut Ui, context: &FormContext<'_>, commands: &mut Vec<Command>) {
    let room = ui.available_rect_before_wrap();
    if room.height() < MIN_HEIGHT_FOR_RUN {
        super::common::scrolled(ui, Panel::Parameters, |ui| {
            form(ui, context, commands);
            run_or_cancel(ui, context, commands);
        });
        return;
    }
    let remark = context.remark.as_ref().map_or(0.0, |_| REMARK_HEIGHT);
    let height = run_height(ui) + remark + 2.0 * RUN_MARGIN;
    let (above, below) = room.split_top_bottom_at_y(room.bottom() - height);
    ui.scope_builder(UiBuilder::new().max_rect(above), |ui| {
        super::common::scrolled(ui, Panel::Parameters, |ui| form(ui, context, commands));
    });
    let line = context.palette.line;
    ui.painter().hline(room.x_range(), below.top(), (1.0, line));
    let below = below.shrink2(vec2(0.0, RUN_MARGIN));
    let below = below.with_max_x(below.right() - SCROLL_BAR_WIDTH);
    ui.scope_builder(UiBuilder::new().max_rect(below), |ui| {
        run_or_cancel(ui, context, commands);
    });
}

fn form(ui: &mut Ui, context: &FormContext<'_>, commands: &mut Vec<Command>) {
    let palette = context.palette;
    let refusals = context.form.draft.refusals();
    presets(ui, context, commands);
    heading(ui, "Domain");
    pair(
        ui,
        context,
        "Size",
        [(Field::Width, "Width"), (Field::Height, "Height")],
        &refusals,
        commands,
    );
    let radius = (Field::Radius, "Radius", "");
    number(ui, context, radius, &refusals, commands);
    samples(ui, context, commands);
    let p = &context.form.draft.parameters;
    let why = "Periodic: opposite sides are joined, and the set tiles the plane. Bounded: the domain ends at its border.";
    if let Some(chosen) = choice(
        ui,
        ("boundary", "Boundary"),
        why,
        p.boundary,
        &BOUNDARIES,
        palette,
    ) {
        commands.push(Command::Form(FormCommand::Choose(Choice::Boundary(chosen))));
    }

    heading(ui, "Tiling");
    for field in [
        (Field::Seed, "Seed", ""),
        (Field::Leaf, "Smallest block", "r"),
        (Field::PatternSide, "Pattern size", "r"),
        (Field::PatternSeed, "Pattern seed", ""),
    ] {
        number(ui, context, field, &refusals, commands);
    }
    let why = "Whether the pattern repeats. A periodic one can be clipped anywhere; the paper uses a bounded one.";
    let chosen = choice(
        ui,
        ("pattern-boundary", "Pattern border"),
        why,
        p.pattern.boundary,
        &PATTERN_BOUNDARIES,
        palette,
    );
    if let Some(chosen) = chosen {
        commands.push(Command::Form(FormCommand::Choose(Choice::PatternBoundary(
            chosen,
        ))));
    }
    own_pattern(ui, context, commands);
    let why = "How the pattern lies where a block clips from it. Random rotations and mirrors repeat less.";
    if let Some(chosen) = choice(
        ui,
        ("dihedral", "Orientation"),
        why,
        p.dihedral,
        &ORIENTATIONS,
        palette,
    ) {
        commands.push(Command::Form(FormCommand::Choose(Choice::Dihedral(chosen))));
    }
    algorithm(ui, context, commands);
    engine::show(ui, context, commands);
    for (k, refusal) in refusals.iter().filter(|r| r.field.is_none()).enumerate() {
        trouble(ui, &refusal.reason, palette).known_as(format_args!("refusal-{k}"));
    }
}

/// Shows the presets, each of which sets all parameters and runs, and the choice of live runs.
fn presets(ui: &mut Ui, context: &FormContext<'_>, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        preset_menu(ui, commands);
        let mut live = context.form.live;
        let switch = ui.checkbox(&mut live, "Live");
        switch.known_as("live");
        let why = "Runs at once when a parameter changes, up to 50,000 samples. Drag the name of a number sideways, or press Up and Down in its field, to change it.";
        if switch.on_hover_text(why).changed() {
            commands.push(Command::Form(FormCommand::Live(live)));
        }
    });
}

fn preset_menu(ui: &mut Ui, commands: &mut Vec<Command>) {
    let menu = ui.menu_button("Presets", |ui| {
        for preset in Preset::ALL {
            let row = ui.button(preset.name());
            row.known_as(format_args!("preset.{}", Kebab(preset)));
            if row.on_hover_text(preset.explanation()).clicked() {
                commands.push(Command::Form(FormCommand::Preset(preset)));
                commands.push(Command::Run);
                ui.close();
            }
        }
    });
    menu.response.known_as("presets");
}

/// Notes that the pattern comes from a file, if it does.
fn own_pattern(ui: &mut Ui, context: &FormContext<'_>, commands: &mut Vec<Command>) {
    let palette = context.palette;
    let Some(own) = &context.form.own_pattern else {
        repeats(ui, context, palette);
        return;
    };
    let text = format!(
        "The pattern comes from {}: {} samples.",
        own.file.path,
        grouped(own.pattern.samples().len())
    );
    ui.label(RichText::new(text).color(palette.muted))
        .known_as("own-pattern");
    let generated = ui.link("Use a generated pattern");
    if generated.known_as("generated-pattern").clicked() {
        commands.push(Command::Form(FormCommand::GeneratedPattern));
    }
}

/// Notes that the pattern repeats within blocks, if it does.
fn repeats(ui: &mut Ui, context: &FormContext<'_>, palette: &Palette) {
    if let Some(side) = context.form.draft.side_without_repeats() {
        let text = format!(
            "The pattern repeats within the largest blocks; a side of {side} r would avoid that."
        );
        ui.label(RichText::new(text).color(palette.muted))
            .known_as("pattern-repeats");
    }
}

fn algorithm(ui: &mut Ui, context: &FormContext<'_>, commands: &mut Vec<Command>) {
    let palette = context.palette;
    let p = &context.form.draft.parameters;
    heading(ui, "Elimination and insertion");
    let why = "Who wins a conflict: the sample that comes first in this order claims its disk, and the other one is eliminated.";
    if let Some(chosen) = choice(ui, ("order", "Who wins"), why, p.order, &ORDERS, palette) {
        commands.push(Command::Form(FormCommand::Choose(Choice::Order(chosen))));
    }
    let why =
        "Where a gap is filled: at circumcentres (the paper, slightly biased) or by uniform darts.";
    if let Some(chosen) = choice(
        ui,
        ("insertion", "Insertion"),
        why,
        p.insertion,
        &INSERTIONS,
        palette,
    ) {
        commands.push(Command::Form(FormCommand::Choose(Choice::Insertion(
            chosen,
        ))));
    }
    let why = "How far around itself a detector looks for gaps. 2 r is the paper's choice and misses a few.";
    if let Some(chosen) = choice(
        ui,
        ("search", "Gap search"),
        why,
        p.search,
        &SEARCHES,
        palette,
    ) {
        commands.push(Command::Form(FormCommand::Choose(Choice::Search(chosen))));
    }
    let why = "Algorithm 4 in stages, elimination first, or as the paper prints it.";
    if let Some(chosen) = choice(
        ui,
        ("variant", "Algorithm 4"),
        why,
        p.variant,
        &VARIANTS,
        palette,
    ) {
        commands.push(Command::Form(FormCommand::Choose(Choice::Variant(chosen))));
    }
}

/// Shows the number of samples, the other end of the radius.
fn samples(ui: &mut Ui, context: &FormContext<'_>, commands: &mut Vec<Command>) {
    let palette = context.palette;
    let draft = &context.form.draft;
    let refusal = draft.count_refusal();
    let meaning =
        "About how many samples the run will have. Type a number to set the radius by it.";
    labelled(ui, ("Samples", meaning), palette, |ui, _| {
        let mut text = draft.count_text();
        let color = refusal.is_some().then_some(palette.conflict);
        let width = field_width(ui);
        let field = text_field(ui, &mut text, ("Samples", meaning), width, color);
        field.known_as("count");
        if field.changed() {
            commands.push(Command::Form(FormCommand::Count(text)));
        }
        enter(ui, &field, context, commands);
    });
    if let Some(refusal) = refusal {
        trouble(ui, &refusal, palette).known_as("count.refusal");
    }
    if context.form.draft.keeps_result_only() {
        let text = "So large a run keeps its result only: there will be no steps to go through.";
        ui.label(RichText::new(text).small().color(palette.accent))
            .known_as("result-only");
    }
}

/// Shows a labelled line; `add` shows the field and receives the label's id.
pub(super) fn labelled(
    ui: &mut Ui,
    (name, meaning): (&str, &str),
    palette: &Palette,
    add: impl FnOnce(&mut Ui, egui::Id),
) -> egui::Response {
    let shown = ui.horizontal(|ui| {
        let start = ui.cursor().left();
        let text = RichText::new(name).color(palette.muted);
        let label = ui.add(egui::Label::new(text).selectable(false).sense(Sense::DRAG));
        let label = label.on_hover_text(meaning);
        let gap = start + FIELD_START - ui.cursor().left();
        ui.add_space(gap.max(0.0));
        add(ui, label.id);
        label
    });
    shown.inner
}

/// How far the name of a number is dragged for a step, in screen points.
const STEP: f32 = 8.0;

/// Changes a number while its name is dragged sideways.
fn drag(ui: &Ui, label: &egui::Response, field: Field, commands: &mut Vec<Command>) {
    if label.hovered() || label.dragged() {
        ui.ctx().set_cursor_icon(CursorIcon::ResizeHorizontal);
    }
    if !label.dragged() {
        return;
    }
    let before: f32 = ui.data(|data| data.get_temp(label.id)).unwrap_or_default();
    let moved = if label.drag_started() { 0.0 } else { before } + label.drag_delta().x;
    let steps = (moved / STEP).trunc();
    ui.data_mut(|data| data.insert_temp(label.id, moved - steps * STEP));
    if steps != 0.0 {
        let nudge = FormCommand::Nudge(field, steps as i32);
        commands.push(Command::Form(nudge));
    }
}

/// Returns the label of fields, with a mark if one of them is not as in the run shown.
fn marked(context: &FormContext<'_>, fields: &[Field], name: &str) -> String {
    let draft = &context.form.draft;
    let made = context.made.as_ref();
    let differs = made.is_some_and(|made| fields.iter().any(|&field| draft.differs(field, made)));
    if differs {
        format!("{name} \u{2022}")
    } else {
        name.to_owned()
    }
}

fn number(
    ui: &mut Ui,
    context: &FormContext<'_>,
    (field, name, unit): (Field, &str, &str),
    refusals: &[DraftRefusal],
    commands: &mut Vec<Command>,
) {
    let palette = context.palette;
    let refusal = refusals.iter().find(|r| r.field == Some(field));
    let name_shown = marked(context, &[field], name);
    let label = labelled(ui, (&name_shown, meaning(field)), palette, |ui, _| {
        let width = field_width(ui);
        edit(ui, context, field, name, width, refusal.is_some(), commands);
        if !unit.is_empty() {
            ui.label(RichText::new(unit).color(palette.muted));
        }
    });
    drag(ui, &label, field, commands);
    if let Some(refusal) = refusal {
        refused(ui, field, refusal, palette);
    }
}

/// Two fields on a line.
fn pair(
    ui: &mut Ui,
    context: &FormContext<'_>,
    name: &str,
    fields: [(Field, &str); 2],
    refusals: &[DraftRefusal],
    commands: &mut Vec<Command>,
) {
    let palette = context.palette;
    let refusal = |field| refusals.iter().find(|r| r.field == Some(field));
    let name_shown = marked(context, &fields.map(|(field, _)| field), name);
    labelled(ui, (&name_shown, meaning(fields[0].0)), palette, |ui, _| {
        ui.spacing_mut().item_spacing.x = 6.0;
        let width = (field_width(ui) - 6.0) / 2.0;
        for (field, name) in fields {
            edit(
                ui,
                context,
                field,
                name,
                width,
                refusal(field).is_some(),
                commands,
            );
        }
    });
    for (field, _) in fields {
        if let Some(refusal) = refusal(field) {
            refused(ui, field, refusal, palette);
        }
    }
}

fn text_field(
    ui: &mut Ui,
    text: &mut String,
    (name, meaning): (&str, &str),
    width: f32,
    color: Option<Color32>,
) -> egui::Response {
    let edit = TextEdit::singleline(text)
        .align(egui::Align2::LEFT_CENTER)
        .id_salt(name)
        .font(egui::TextStyle::Monospace)
        .text_color_opt(color)
        .margin(egui::Margin::symmetric(8, 4))
        .desired_width(width);
    ui.add(edit).accessible_name(name).on_hover_text(meaning)
}

fn edit(
    ui: &mut Ui,
    context: &FormContext<'_>,
    field: Field,
    name: &str,
    width: f32,
    is_wrong: bool,
    commands: &mut Vec<Command>,
) {
    let palette = context.palette;
    let mut text = context.form.draft.text(field).to_owned();
    let color = is_wrong.then_some(palette.conflict);
    let response = text_field(ui, &mut text, (name, meaning(field)), width, color);
    response.known_as(key(field));
    if response.changed() {
        commands.push(Command::Form(FormCommand::Type(field, text)));
    }
    if response.has_focus() {
        let pressed = |key| ui.input(|input| input.num_presses(key)) as i32;
        let steps = pressed(egui::Key::ArrowUp) - pressed(egui::Key::ArrowDown);
        if steps != 0 {
            commands.push(Command::Form(FormCommand::Nudge(field, steps)));
        }
    }
    enter(ui, &response, context, commands);
}

/// Runs when Enter was pressed in a field.
fn enter(
    ui: &Ui,
    response: &egui::Response,
    context: &FormContext<'_>,
    commands: &mut Vec<Command>,
) {
    let entered = response.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
    if entered && context.refusal.as_deref().is_none() && context.sampling.is_none() {
        commands.push(Command::Run);
    }
}

/// Returns a field's key in links and files.
const fn key(field: Field) -> &'static str {
    match field {
        Field::Width => "width",
        Field::Height => "height",
        Field::Radius => "radius",
        Field::Seed => "seed",
        Field::Leaf => "leaf",
        Field::PatternSide => "pattern",
        Field::PatternSeed => "pattern-seed",
    }
}

fn refused(ui: &mut Ui, field: Field, refusal: &DraftRefusal, palette: &Palette) {
    let id = format_args!("refusal-{}", key(field));
    trouble(ui, &refusal.reason, palette).known_as(id);
}

fn trouble(ui: &mut Ui, reason: &str, palette: &Palette) -> egui::Response {
    ui.label(RichText::new(reason).small().color(palette.conflict))
}

fn choice<T: Copy + PartialEq>(
    ui: &mut Ui,
    (key, name): (&str, &str),
    explanation: &str,
    current: T,
    options: &[Listed<T>],
    palette: &Palette,
) -> Option<T> {
    let mut chosen = current;
    let text = options.iter().find(|(value, ..)| *value == current);
    labelled(ui, (name, explanation), palette, |ui, label| {
        let combo = ComboBox::from_id_salt(name)
            .selected_text(text.map_or("", |(_, text, _)| text))
            .width(field_width(ui))
            .truncate()
            .show_ui(ui, |ui| {
                for (value, text, meaning) in options {
                    let option = ui.selectable_value(&mut chosen, *value, *text);
                    option.on_hover_text(*meaning);
                }
            });
        let response = combo.response.labelled_by(label);
        response.known_as(key);
        response.on_hover_text(explanation);
    });
    (chosen != current).then_some(chosen)
}

fn run_height(ui: &Ui) -> f32 {
    row_height(ui.ctx(), 34.0)
}

/// Button and progress take the same room, so that nothing moves; Cancel is beside them, so that a double click on Run
/// does not hit it.
fn run_or_cancel(ui: &mut Ui, context: &FormContext<'_>, commands: &mut Vec<Command>) {
    let palette = context.palette;
    let height = run_height(ui);
    if let Some(remark) = context.remark.as_ref() {
        ui.spacing_mut().item_spacing.y = 2.0;
        let size = vec2(ui.available_width(), REMARK_HEIGHT - 2.0);
        let text = RichText::new(remark).small().color(palette.accent);
        let label = ui.add_sized(size, egui::Label::new(text).truncate());
        label.known_as("run-remark");
        label.on_hover_text(remark);
    }
    ui.horizontal(|ui| {
        let room = vec2(ui.available_width() - CANCEL_WIDTH, height);
        ui.allocate_ui(room, |ui| {
            if let Some(job) = context.sampling {
                let activity = sentence(&job.activity());
                let text = format!("{activity} {:.0}%", job.fraction() * 100.0);
                let bar = ProgressBar::new(job.fraction())
                    .desired_height(height)
                    .fill(palette.accent.gamma_multiply(0.5))
                    .text(RichText::new(text.trim_start_matches('.').trim()).small());
                ui.add(bar);
                return;
            }
            let refusal = context.refusal.as_deref();
            let name = if context.remark.is_some() {
                "Run to apply"
            } else {
                "Run"
            };
            let run = primary_button(ui, name, refusal, palette);
            if run.known_as("run").clicked() {
                commands.push(Command::Run);
            }
        });
        match context.sampling {
            Some(job) if job.is_cancelled() => {
                ui.label(RichText::new("Stopping").small().color(palette.muted));
            }
            Some(_) => {
                let cancel = ui.link(RichText::new("Cancel").small());
                if cancel.known_as("cancel").clicked() {
                    commands.push(Command::Cancel(Which::First));
                }
            }
            None => {
                let reset = ui.link(RichText::new("Reset").small());
                reset.known_as("reset-parameters");
                let reset =
                    reset.on_hover_text("Reset the parameters to those of the first session");
                if reset.clicked() {
                    commands.push(Command::Form(FormCommand::Reset));
                }
            }
        }
    });
}
