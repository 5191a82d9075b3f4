//! The analysis of a set in space: its numbers, which move with the run, and its spectrum and g(r), which are measured at rest.
//! Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

use egui::{ProgressBar, RichText, Ui};
use tilescope_analysis::SolidSpectrum;
use tilescope_analysis::measures::MeasuredSet;
use tilescope_session::moment::ShownMoment;
use tilescope_session::words::{counted, grouped};
use tilescope_ui::language::Worded;
use tilescope_ui::widgets::{Known, heading};
use tilescope_workbench::analysis::AnalysisCommand;
use tilescope_workbench::analysis::solid::{REACH, SolidMeasures};
use tilescope_workbench::command::Command;
use tilescope_workbench::live::IN_SPACE;
use tilescope_workbench::state::RunView;

use super::plot::{Curve, Dash, Plot, PlotAxis};
use super::{AnalysisContext, Sets, TWO_COLUMNS, line_of_second, lines, numbers};
use crate::panels::common::named_bar;

/// Height of a chart.
const HEIGHT: f32 = 168.0;
/// The end of the axis of power, which never changes, so that charts of different moments can be compared: the first ring of a
/// maximal set in space has 1.6.
const END_OF_POWER: f64 = 3.0;
/// The end of the axis of g, likewise.
const END_OF_PAIRS: f64 = 4.0;
/// Share of a colour that remains in the curves of another moment.
const FADED: f32 = 0.38;

/// Shows the numbers of the moment, and below or beside them the charts at rest.
pub fn show(
    ui: &mut Ui,
    context: &AnalysisContext<'_>,
    shown: &ShownMoment<'_>,
    commands: &mut Vec<Command>,
) {
    let sets = Sets::of(context, shown);
    if ui.available_width() >= TWO_COLUMNS {
        ui.columns_const(|[left, right]| {
            moving(left, context, shown, &sets);
            resting(right, context, shown, commands);
        });
    } else {
        moving(ui, context, shown, &sets);
        resting(ui, context, shown, commands);
    }
    ui.add_space(8.0);
}

/// Shows the numbers that move with the run.
fn moving(ui: &mut Ui, context: &AnalysisContext<'_>, shown: &ShownMoment<'_>, sets: &Sets<'_>) {
    let palette = context.palette;
    heading(ui, "This moment");
    let text = status(context.run, shown, sets.first.now.or(sets.first.live));
    lines(ui, RichText::new(ui.words(text))).known_as("analysis.status");

    heading(ui, "Numbers");
    numbers::show(ui, sets);
    let text = RichText::new(ui.words(IN_SPACE)).size(12.0);
    ui.label(text.color(palette.muted))
        .known_as("analysis.global");
}

/// Returns the counts of a moment in words, or why none move with the run.
fn status(run: &RunView, shown: &ShownMoment<'_>, live: Option<&MeasuredSet>) -> String {
    // Conflicts are not known in the few frames in which a far moment is being reached.
    let followed = live.and_then(|live| Some((live, live.space?, live.space?.pairs?)));
    let Some((live, space, pairs)) = followed else {
        let refusal = run.live.refusal();
        return refusal
            .unwrap_or("The run is being read\u{2026}")
            .to_owned();
    };
    let conflicts = match pairs.conflicts {
        0 => "no conflicts".to_owned(),
        count => counted(count as usize, "conflict", "conflicts"),
    };
    let samples = counted(live.samples, "sample", "samples");
    // A run in space without recorded events has no moment but its end.
    if shown.debugger.is_none() {
        return format!("At the end: {samples}, {conflicts}.");
    }
    format!(
        "At event {}: {samples}, {conflicts}, {}.",
        grouped(shown.cursor()),
        counted(space.active_cubes as usize, "active cube", "active cubes")
    )
}

/// Shows the spectrum and g(r) of the moment at which the cursor rests, or faded those of the moment before.
fn resting(
    ui: &mut Ui,
    context: &AnalysisContext<'_>,
    shown: &ShownMoment<'_>,
    commands: &mut Vec<Command>,
) {
    heading(ui, "At rest");
    progress(ui, context, shown, commands);
    let text = RichText::new(ui.words(resting_text(context.run, shown))).size(12.0);
    ui.label(text.color(context.palette.muted))
        .known_as("analysis.rest");

    ui.add_space(6.0);
    let is_compared = context.second.is_some();
    let power = Plot {
        title: "Power by shells P(\u{3bd})",
        x: PlotAxis {
            label: "frequency \u{3bd} = |k| (V/N)^(1/3)",
            sign: "\u{3bd}",
            range: [0.0, SolidSpectrum::USUAL],
        },
        y: PlotAxis {
            label: "power",
            sign: "P",
            range: [0.0, END_OF_POWER],
        },
        level: (1.0, "white noise"),
        curves: curves(context, shown, SolidMeasures::power),
        is_compared,
        brush: None,
        height: HEIGHT,
    };
    // Nothing is brushed in space, so that a drag has no effect.
    let _ = power.show(ui, context.palette);

    ui.add_space(6.0);
    let pairs = Plot {
        title: "Pair correlation g",
        x: PlotAxis {
            label: "distance, r-units (d / r)",
            sign: "d/r",
            range: [0.0, REACH],
        },
        y: PlotAxis {
            label: "pairs, relative to independent samples",
            sign: "g",
            range: [0.0, END_OF_PAIRS],
        },
        level: (1.0, "white noise"),
        curves: curves(context, shown, SolidMeasures::pairs),
        is_compared,
        brush: None,
        height: HEIGHT,
    };
    let _ = pairs.show(ui, context.palette);
}

/// Returns a sentence on the moment whose spectrum is shown.
fn resting_text(run: &RunView, shown: &ShownMoment<'_>) -> String {
    let measuring = &run.solid_measuring;
    if let Some(why) = measuring.failure(shown) {
        return why.to_owned();
    }
    match measuring.last(shown) {
        Some((known, true)) => {
            let count = grouped(known.measures.spectrum.samples);
            format!("Spectrum and g(r) of the {count} samples of this moment.")
        }
        Some((known, false)) => format!("Faded: those of {}.", known.name),
        None => "Spectrum and g(r) are measured once the run rests.".to_owned(),
    }
}

/// Shows the progress of measuring, with a button to stop or resume it. The height is the same with and without.
fn progress(
    ui: &mut Ui,
    context: &AnalysisContext<'_>,
    shown: &ShownMoment<'_>,
    commands: &mut Vec<Command>,
) {
    let measuring = &context.run.solid_measuring;
    let mut command = None;
    ui.horizontal(|ui| {
        ui.set_height(26.0);
        if let Some(fraction) = measuring.progress() {
            // The button stands before the bar, so that it stays under the pointer.
            let cancel = ui.button("Cancel");
            cancel.known_as("analysis.cancel");
            let cancel = cancel.on_hover_text("Stops measuring this moment.");
            command = cancel.clicked().then_some(AnalysisCommand::Stop);

            let bar = ProgressBar::new(fraction).desired_height(6.0);
            named_bar(ui, bar.desired_width(56.0), "Measuring", context.palette);
        } else if measuring.is_stopped(shown) && !measuring.is_measured(shown) {
            let resume = ui.button("Measure this moment").clicked();
            command = resume.then_some(AnalysisCommand::Resume);
        }
    });
    commands.extend(command.map(Command::Analysis));
}

/// Returns the curves of the moments of the run and of the second one, if that is in space, too.
fn curves(
    context: &AnalysisContext<'_>,
    shown: &ShownMoment<'_>,
    points: fn(&SolidMeasures) -> Vec<[f64; 2]>,
) -> Vec<Curve> {
    let of_run = |run: &RunView, shown: &ShownMoment<'_>, name: &str, (line, color)| {
        let (known, is_shown) = run.solid_measuring.last(shown)?;
        let color: egui::Color32 = color;
        Some(Curve {
            name: if is_shown { name } else { "a moment before" }.to_owned(),
            points: points(&known.measures),
            band: None,
            line,
            color: if is_shown {
                color
            } else {
                color.gamma_multiply(FADED)
            },
        })
    };

    let first_line = (Dash::Solid, context.palette.accent);
    let Some(second) = context.second else {
        let first = of_run(context.run, shown, "this moment", first_line);
        return first.into_iter().collect();
    };
    let first = of_run(context.run, shown, "run A", first_line);
    let second_line = line_of_second(context.palette);
    let second = (second.shown()).and_then(|shown| of_run(second, &shown, "run B", second_line));
    first.into_iter().chain(second).collect()
}
