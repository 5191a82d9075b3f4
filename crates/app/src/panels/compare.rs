//! The comparison of two runs: the choice of run B, the links between the two, their differences, and the first event at
//! which they diverge.
//! Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

use egui::{
    Button, ProgressBar, Rangef, RichText, Role, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2,
};
use tilescope_debugger::{Divergence, Recording};
use tilescope_drawing::palette::Palette;
use tilescope_session::words::{grouped, stage_name};
use tilescope_ui::language::Worded;
use tilescope_ui::table::{SpokenCell, spoken_row, table};
use tilescope_ui::widgets::{Kebab, Known, heading, primary_button, row};

use super::common::named_bar;
use super::content::{Content, Room};
use crate::ENABLED;
use tilescope_workbench::command::{Command, Which};
use tilescope_workbench::compare::{
    CompareCommand, ComparePreset, Comparison, contrast_of, difference,
};
use tilescope_workbench::state::{RunView, State};

/// The height of a line of values, and the room between two of them.
const LINE: f32 = 24.0;
const APART: f32 = 14.0;

/// The context of the panel of the comparison.
pub struct CompareContext<'a> {
    /// The colours of the look.
    pub palette: &'static Palette,
    /// The run that all panels show, run A.
    pub first: &'a RunView,
    /// Run B, if there is one, and the results of the comparison.
    pub second: Option<&'a (RunView, Comparison)>,
    /// The presets for run B, each with the reason why it cannot start now, if there is one.
    pub presets: Vec<(ComparePreset, Option<String>)>,
    /// Why going to the divergence is unavailable, if it is.
    pub parting: Option<&'static str>,
}

pub const CONTENT: Content = Content::of_state(Room::Scrolled, |ui, state, commands| {
    show(ui, &CompareContext::of(state), commands);
});

impl<'a> CompareContext<'a> {
    /// Returns what the panel shows of the state.
    fn of(state: &'a State) -> Self {
        let refusal = |preset| {
            state
                .runs()
                .preset_refusal(preset, state.form(), state.gpu())
        };
        let presets = ComparePreset::ALL.map(|preset| (preset, refusal(preset)));
        Self {
            palette: Palette::of(state.appearance().look),
            first: &state.runs().first,
            second: state.runs().second.as_ref(),
            presets: presets.into(),
            parting: state.runs().parting_refusal(),
        }
    }
}

/// Shows the comparison, or what a second run would show.
pub fn show(ui: &mut Ui, context: &CompareContext<'_>, commands: &mut Vec<Command>) {
    let palette = context.palette;
    // Commands of the comparison are collected apart, and become commands of the window at the end.
    let mut own = Vec::new();
    if let Some((side, comparison)) = context.second {
        second(ui, side, palette, commands);
        // There is nothing to compare before both runs are made.
        if let (Some(a), Some(b)) = (&context.first.session, &side.session) {
            heading(ui, "What differs in the parameters");
            let differing = contrast_of(a, b);
            let remark = match &differing {
                None => "A combination is made from a layout: it has no parameters to compare.",
                Some(rows) if rows.is_empty() => "Nothing: the parameters are the same.",
                Some(_) => "",
            };
            if !remark.is_empty() {
                ui.label(RichText::new(remark).color(palette.muted));
            }
            let mut rows = differing.unwrap_or_default();
            let [of_a, of_b] = [a, b].map(|session| grouped(session.summary.count));
            rows.push(("samples".to_owned(), of_a, of_b));

            let title = ui.words("What differs between A and B");
            table(ui, &title, [rows.len(), 3], Role::Table, |ui| {
                for (index, (name, in_a, in_b)) in rows.iter().enumerate() {
                    compared(ui, index, name, [in_a, in_b], palette);
                }
            });

            parting(ui, context, side, comparison, &mut own);
            now(ui, context, side, comparison, &mut own);
        }

        links(ui, comparison, &mut own);
        ui.add_space(8.0);
    } else {
        let text = "A second run beside this one: same view, same moment, what differs, and the first event at which the two part.";
        ui.label(RichText::new(text).color(palette.muted));
    }

    presets(ui, context, &mut own);
    commands.extend(own.into_iter().map(Command::Compare));
}

/// Shows what both runs have of one thing: its name on the left, the values of A and B on the right, or below where there is
/// no room for them.
fn compared(ui: &mut Ui, index: usize, name: &str, values: [&str; 2], palette: &Palette) {
    let name = ui.words(name);
    let texts: Vec<String> = ["A", "B"]
        .into_iter()
        .zip(values)
        .map(|(run, value)| format!("{run} {}", ui.words(value)))
        .collect();

    let lay = |text: &str, style: TextStyle, color| {
        let font = style.resolve(ui.style());
        ui.painter().layout_no_wrap(text.to_owned(), font, color)
    };
    let label = lay(&name, TextStyle::Body, palette.muted);
    let shown: Vec<_> = texts
        .iter()
        .map(|text| lay(text, TextStyle::Monospace, palette.text))
        .collect();
    // The width of the values, each with the gap before it.
    let wide: f32 = shown.iter().map(|galley| galley.size().x + APART).sum();

    let fits = label.size().x + wide <= ui.available_width();
    let lines = if fits { 1.0 } else { 2.0 };
    let size = vec2(ui.available_width(), lines * LINE);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let spoken = format!("{name}: {}", texts.join(", "));
    response.widget_info(|| WidgetInfo::labeled(Role::Row, ENABLED, &spoken));

    // Each text stands in the middle of its line. The name has the first line and the values have the last one: the
    // same line, if they fit.
    let top = |line: f32, height: f32| rect.top() + line * LINE + (LINE - height) / 2.0;
    let across = Rangef::new(rect.left(), rect.left() + label.size().x);
    let mut cells = vec![SpokenCell::new(Role::RowHeader, name, across)];
    let at = pos2(rect.left(), top(0.0, label.size().y));
    ui.painter().galley(at, label, palette.muted);

    // The first value begins behind its gap.
    let mut x = rect.right() - wide + APART;
    for (text, galley) in texts.into_iter().zip(shown) {
        let size = galley.size();
        let at = pos2(x, top(lines - 1.0, size.y));
        ui.painter().galley(at, galley, palette.text);
        cells.push(SpokenCell::new(
            Role::Cell,
            text,
            Rangef::new(x, x + size.x),
        ));
        x += size.x + APART;
    }
    spoken_row(ui, &response, index, cells);
}

/// Shows the buttons of run B, and how far it is sampled.
fn second(ui: &mut Ui, side: &RunView, palette: &Palette, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let ready = side.session.is_some();
        let swap = ui.add_enabled(ready, Button::new("Swap A and B"));
        swap.known_as("compare.swap");
        if swap
            .on_hover_text("All panels show run A.")
            .on_disabled_hover_text("The second run is not ready yet.")
            .clicked()
        {
            commands.push(Command::Compare(CompareCommand::Swap));
        }

        let command = Command::Compare(CompareCommand::Close);
        ui.button("Close B")
            .issues("compare.close", command, commands);

        if side.sampling.is_some() {
            let command = Command::Cancel(Which::Second);
            ui.button("Cancel B")
                .issues("compare.cancel", command, commands);
        }
    });

    // Without progress the bar's height is left free, so that nothing below moves when sampling ends.
    match &side.sampling {
        Some(job) => {
            let bar = ProgressBar::new(job.fraction()).desired_height(6.0);
            named_bar(ui, bar, "Sampling B", palette);
        }
        None => ui.add_space(6.0),
    }
}

/// Shows the buttons that begin a comparison.
fn presets(ui: &mut Ui, context: &CompareContext<'_>, own: &mut Vec<CompareCommand>) {
    heading(ui, "Compare this run with");
    for (preset, refusal) in &context.presets {
        let button = ui.add_enabled(
            refusal.is_none(),
            Button::new(ui.words(preset.name())).frame(true),
        );
        button.known_as(format_args!("compare.{}", Kebab(*preset)));
        let button = button.on_disabled_hover_text(refusal.as_deref().unwrap_or_default());
        if button.clicked() {
            own.push(CompareCommand::Start(*preset));
        }
    }

    // The other presets begin a second run at once; this one keeps the run shown, and the next one is compared with it.
    let kept = ui.add_enabled(
        context.first.session.is_some(),
        Button::new(ui.words("my next run (keeps this one as B)")),
    );
    kept.known_as("compare.keep");
    let kept = kept
        .on_hover_text(ui.words("Keeps this run as B; then change the parameters and run."))
        .on_disabled_hover_text("There is no session yet.");
    if kept.clicked() {
        own.push(CompareCommand::Keep);
    }
}

/// Shows the first event or stage at which the runs differ, and the button that goes there.
fn parting(
    ui: &mut Ui,
    context: &CompareContext<'_>,
    side: &RunView,
    comparison: &Comparison,
    own: &mut Vec<CompareCommand>,
) {
    let palette = context.palette;
    heading(ui, "Where they part");
    let (Some(a), Some(b)) = (&context.first.session, &side.session) else {
        return;
    };
    let Some(divergence) = comparison.divergence(a, b) else {
        let text = comparison.failure().unwrap_or("Searching\u{2026}");
        ui.label(RichText::new(text).color(palette.muted))
            .known_as("parting-0");
        return;
    };

    for (index, line) in description(divergence).into_iter().enumerate() {
        ui.label(line).known_as(format_args!("parting-{index}"));
    }

    // A recording that exceeds its budget leaves out tests, which are events that compare two samples. Tests are then
    // compared in neither run.
    let is_thinned = [a, b].into_iter().any(|session| {
        let left_out = |recording: &std::sync::Arc<Recording>| recording.tape().left_out() > 0;
        session.recording().is_some_and(left_out)
    });
    if is_thinned {
        let text = "Some events were not recorded: only recorded ones are compared.";
        ui.label(RichText::new(text).color(palette.muted));
    }

    let refusal = context.parting;
    let command = CompareCommand::GoToDivergence;
    primary_button(ui, "Go there in both", refusal, palette).issues("compare.go", command, own);
}

/// Returns sentences on where two runs diverge: how many events are the same, or at which stage or domain they differ,
/// then what each run has or does there.
fn description(divergence: &Divergence) -> Vec<String> {
    match divergence {
        Divergence::Same => {
            vec!["Nowhere: every event is the same, sample by sample, to the bit.".to_owned()]
        }

        Divergence::Domain { a, b } => vec![
            "The domains differ: the runs cannot be compared event by event.".to_owned(),
            format!("A: {a}."),
            format!("B: {b}."),
        ],

        Divergence::Events {
            a: index,
            sentence_a,
            sentence_b,
            ..
        } => vec![
            // Events are counted from 0, so that the index of the first one that differs is the number of equal ones.
            // The index in run B is another one only where tests were left out of a recording.
            match index {
                0 => "The first events differ:".to_owned(),
                1 => "The first event is the same. Then:".to_owned(),
                _ => format!("The first {} events are the same. Then:", grouped(*index)),
            },
            format!("A: {sentence_a}"),
            format!("B: {sentence_b}"),
        ],

        Divergence::Ends {
            a_goes_on,
            event,
            sentence,
        } => vec![
            // The index of the first additional event is the number of events that the runs share.
            match event {
                1 => "The one event of the shorter run is the same.".to_owned(),
                _ => format!(
                    "All {} events of the shorter run are the same.",
                    grouped(*event)
                ),
            },
            format!("{} goes on: {sentence}", if *a_goes_on { "A" } else { "B" }),
        ],

        Divergence::Stage { stage, a, b, .. } => vec![
            format!("At stage {}.", stage_name(*stage)),
            format!("A: {a}"),
            format!("B: {b}"),
        ],
    }
}

/// Shows how many samples the runs have in common at this moment, and the switch of their marks.
fn now(
    ui: &mut Ui,
    context: &CompareContext<'_>,
    side: &RunView,
    comparison: &Comparison,
    own: &mut Vec<CompareCommand>,
) {
    let palette = context.palette;
    heading(ui, "Samples at this moment");
    let (Some(a), Some(b)) = (context.first.shown(), side.shown()) else {
        return;
    };

    // The differences are searched for in the background. A dash stands for each number until it is there.
    let number = |count: Option<usize>| count.map_or_else(|| "\u{2013}".to_owned(), grouped);
    let found = comparison.differences.of(&a, &b);
    if difference::comparable(&a, &b) {
        for (name, count) in [
            ("in both", found.map(|samples| samples.common)),
            ("in A alone", found.map(|samples| samples.first.len())),
            ("in B alone", found.map(|samples| samples.second.len())),
        ] {
            row(ui, name, &number(count), palette);
        }
    } else {
        let text = "The domains differ: positions cannot be compared.";
        ui.label(RichText::new(text).color(palette.muted))
            .known_as("compare.refusal");
    }

    let mut on = comparison.shows_differences;
    let text = "Mark them on the canvas";
    let hint = "A square: this run alone has it. Four corners: the other run alone has it.";
    let marks = ui.checkbox(&mut on, text);
    marks.known_as("compare.marks");
    if marks.on_hover_text(hint).changed() {
        own.push(CompareCommand::ShowDifferences(on));
    }
}

/// Shows the switches by which the two runs follow each other.
fn links(ui: &mut Ui, comparison: &Comparison, own: &mut Vec<CompareCommand>) {
    heading(ui, "Together");
    let mut links_cameras = comparison.linked_cameras;
    let cameras = ui.checkbox(&mut links_cameras, "Link cameras");
    if cameras.known_as("compare.cameras").changed() {
        own.push(CompareCommand::LinkCameras(links_cameras));
    }

    let mut links_playback = comparison.linked_playback;
    let hint =
        "The same event as long as the runs are the same, then the same share of the same stage.";
    let playback = ui.checkbox(&mut links_playback, "Link playback");
    playback.known_as("compare.clocks");
    if playback.on_hover_text(hint).changed() {
        own.push(CompareCommand::LinkPlayback(links_playback));
    }
}
