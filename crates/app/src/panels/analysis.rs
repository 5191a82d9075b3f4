//! The live analysis: numbers and curves of the kept samples at this moment, beside those of a second run, of maximal
//! sets and of a file. They move with the run; where a run has none that do, outdated values are faded until new ones
//! arrive. The *brush* is a range of a curve, whose samples or pairs the canvas marks. The measuring itself is in the
//! workbench. Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

mod charts;
mod difference;
mod numbers;
mod picture;
mod plot;
mod space;

use std::sync::Arc;

use egui::{Button, Color32, DragValue, FontId, ProgressBar, RichText, Sense, Ui, vec2};
use tilescope_analysis::measures::{MeasuredSet, Spectrum};
use tilescope_drawing::palette::Palette;
use tilescope_session::ground::MadeGround;
use tilescope_session::moment::ShownMoment;
use tilescope_session::session::Session;
use tilescope_session::words::{capital, grouped};
use tilescope_ui::language::Worded;
use tilescope_ui::theme::semibold;
use tilescope_ui::widgets::{Kebab, Known, heading};

use super::common::named_bar;
use super::content::{Content, Room};
use plot::{Dash, Dragged};
use tilescope_workbench::analysis::brush::{Brush, BrushAxis, FIRST_PEAK};
use tilescope_workbench::analysis::measured::missing;
use tilescope_workbench::analysis::reference_file::ReferenceFile;
use tilescope_workbench::analysis::{Analysis, AnalysisCommand, name_of};
use tilescope_workbench::command::{Command, Which};
use tilescope_workbench::files::{FileCommand, Purpose};
use tilescope_workbench::live::{GLOBAL, GLOBAL_IN_SHAPE, Live};
use tilescope_workbench::state::{RunView, State};

/// Minimum width of the panel for two columns of charts, in screen points.
const TWO_COLUMNS: f32 = 620.0;
/// The distances, in r, that a brush selects first: the pair correlation of a maximal set is highest just above r.
const JUST_ABOVE_R: [f64; 2] = [1.0, 1.05];

/// Returns the line of run B.
const fn line_of_second(palette: &Palette) -> (Dash, Color32) {
    (Dash::Long, palette.inserted)
}

/// The context of the panel of the analysis.
pub struct AnalysisContext<'a> {
    /// The colours of the look.
    pub palette: &'static Palette,
    /// The run whose moment is measured.
    pub run: &'a RunView,
    /// The run that it is compared with.
    pub second: Option<&'a RunView>,
    /// The measures beside those of the runs.
    pub analysis: &'a Analysis,
    /// The reference file, or why it could not be measured.
    pub reference_file: Option<Result<&'a Arc<ReferenceFile>, String>>,
    /// The result of the brush, in words.
    pub brush_text: String,
}

/// The measures of the moment of a run, as far as they are there.
#[derive(Clone, Copy)]
struct RunMeasures<'a> {
    /// The measures of a moment at rest.
    now: Option<&'a MeasuredSet>,
    /// Those that move with the run.
    live: Option<&'a MeasuredSet>,
    /// The measures of another moment, shown until those of this one are there. In a run whose measures move with it,
    /// only the spectrum can be of another moment.
    before: Option<&'a MeasuredSet>,
    /// Whether the radius depends on the place, or the domain is a shape.
    is_local: bool,
    session: &'a Session,
    /// Whether the set is in space, and its numbers are those of sets there.
    is_in_space: bool,
}

impl<'a> RunMeasures<'a> {
    /// Returns the measures of a run at the moment shown, and those that stand in for them.
    fn of(run: &'a RunView, shown: &ShownMoment<'a>) -> Self {
        let measuring = &run.measuring;
        let now = measuring.of(shown).map(|known| &*known.measured);
        // A set in space has those of a moment at rest only if it has no events.
        let now = now.or_else(|| run.solid_measuring.numbers(shown));
        let is_whole = now.is_some_and(|now| missing(now).is_none());
        // Until the measures at rest are whole, others stand in for them. Where measuring has failed, these would hide
        // the failure.
        let is_wanted = !is_whole && measuring.failure(shown).is_none();
        // A run whose measures move with it needs none of another moment, except for the spectrum, which may lag
        // behind.
        let before = match run.live.refusal() {
            Some(_) => measuring.last(shown).map(|known| &*known.measured),
            None => run.live.behind(shown).map(|behind| &*behind.measured),
        };
        Self {
            now,
            live: run.live.of(shown).map(|set| &**set).filter(|_| is_wanted),
            before: before.filter(|_| is_wanted),
            is_local: shown.session.ground.is_some(),
            session: shown.session,
            is_in_space: shown.session.solid.is_some(),
        }
    }

    /// Returns a part of the measures, and whether it is outdated.
    fn part<T>(&self, part: impl Fn(&'a MeasuredSet) -> Option<T>) -> Option<(T, bool)> {
        let present = self
            .now
            .and_then(&part)
            .or_else(|| self.live.and_then(&part))
            .map(|found| (found, false));
        present.or_else(|| self.before.and_then(&part).map(|found| (found, true)))
    }

    /// Returns whether the radius depends on the place.
    fn varies(&self) -> bool {
        let ground = self.session.ground.as_ref();
        ground.is_some_and(MadeGround::varies)
    }

    fn spectrum(&self) -> Option<(&'a Arc<Spectrum>, bool)> {
        self.part(MeasuredSet::spectrum_so_far)
    }
}

/// The sets shown, and their colours and line styles.
struct Sets<'a> {
    /// The moment of the run.
    first: RunMeasures<'a>,
    /// The moment of the run that it is compared with.
    second: Option<RunMeasures<'a>>,
    reference: Option<&'a Arc<MeasuredSet>>,
    reference_file: Option<&'a Arc<ReferenceFile>>,
    /// The length of r in the unit of the file.
    unit: f64,
    palette: &'a Palette,
}

impl<'a> Sets<'a> {
    fn of(context: &AnalysisContext<'a>, shown: &ShownMoment<'a>) -> Self {
        let second = context.second.and_then(|run| Some((run, run.shown()?)));
        Self {
            first: RunMeasures::of(context.run, shown),
            second: second.map(|(run, shown)| RunMeasures::of(run, &shown)),
            reference: context.analysis.reference.measured(),
            reference_file: context.reference_file.clone().and_then(Result::ok),
            unit: shown.session.run().domain.radius(),
            palette: context.palette,
        }
    }
}

pub const CONTENT: Content = Content::of_state(Room::Scrolled, |ui, state, commands| {
    show(ui, &AnalysisContext::of(state), commands);
});

impl<'a> AnalysisContext<'a> {
    /// Returns the context of the analysis of run A, and of run B if there is one.
    pub fn of(state: &'a State) -> Self {
        Self {
            palette: Palette::of(state.appearance().look),
            run: &state.runs().first,
            second: state.runs().get(Which::Second),
            analysis: state.analysis(),
            reference_file: state.analysis().file_for(&state.runs().first),
            brush_text: state.analysis().brush_text(&state.runs().first),
        }
    }
}

/// Shows the analysis: its state, charts and numbers, in two columns where there is room.
pub fn show(ui: &mut Ui, context: &AnalysisContext<'_>, commands: &mut Vec<Command>) {
    let palette = context.palette;
    let Some(shown) = context.run.shown() else {
        let text = "There is no session yet.";
        ui.label(RichText::new(text).color(palette.muted));
        return;
    };

    // A set in space has numbers and charts of its own.
    if shown.session.solid.is_some() {
        return space::show(ui, context, &shown, commands);
    }

    // Commands of the analysis are collected apart, and become commands of the window at the end.
    let mut own = Vec::new();
    let sets = Sets::of(context, &shown);
    status(ui, context, &shown, &sets, &mut own);
    if sets.first.is_local {
        let global = if sets.first.varies() {
            GLOBAL
        } else {
            GLOBAL_IN_SHAPE
        };
        let text = RichText::new(ui.words(global))
            .size(12.0)
            .color(palette.muted);
        ui.label(text).known_as("analysis.global");
    }

    // The causes of a range are looked for with one radius.
    let brush = context.analysis.brush.filter(|_| !sets.first.is_local);
    if ui.available_width() >= TWO_COLUMNS {
        // The curves have a column to themselves, below the legend that names their lines.
        ui.columns_const(|[left, right]| {
            charts::picture(left, &sets, brush, &mut own);
            rest(left, context, &sets, commands, &mut own);
            legend(right, context, &sets);
            charts::curves(right, &sets, brush, &mut own);
        });
    } else {
        charts::picture(ui, &sets, brush, &mut own);
        legend(ui, context, &sets);
        charts::curves(ui, &sets, brush, &mut own);
        rest(ui, context, &sets, commands, &mut own);
    }

    ui.add_space(8.0);
    own.retain(|command| !(sets.first.is_local && matches!(command, AnalysisCommand::Brush(_))));
    commands.extend(own.into_iter().map(Command::Analysis));
}

/// Shows the brush, the numbers, and the choice of a file to compare with.
fn rest(
    ui: &mut Ui,
    context: &AnalysisContext<'_>,
    sets: &Sets<'_>,
    commands: &mut Vec<Command>,
    own: &mut Vec<AnalysisCommand>,
) {
    ui.add_space(6.0);
    if !sets.first.is_local {
        heading(ui, "Brush");
        brushed(ui, context, own);
    }
    heading(ui, "Numbers");
    numbers::show(ui, sets);
    file(ui, context, commands, own);
}

/// Shows which moment is measured, and the progress. The height is the same whatever the text.
fn status(
    ui: &mut Ui,
    context: &AnalysisContext<'_>,
    shown: &ShownMoment<'_>,
    sets: &Sets<'_>,
    own: &mut Vec<AnalysisCommand>,
) {
    ui.label(RichText::new("This moment").font(FontId::new(13.5, semibold())));
    // The progress has its own line, since a narrow panel has no room for it beside the heading. The line keeps its height
    // when the progress ends.
    ui.horizontal(|ui| {
        ui.set_height(26.0);
        progress(ui, context, shown, own);
    });

    let text_of = |run: &RunView, shown: &ShownMoment<'_>, text: String| {
        let is_failure = run.measuring.failure(shown).is_some();
        let palette = context.palette;
        RichText::new(text).color(if is_failure {
            palette.muted
        } else {
            palette.text
        })
    };
    let status = status_text(context.run, shown, &sets.first);
    let second = context.second.and_then(|run| Some((run, run.shown()?)));
    // The sentence below the canvas already announces the event to screen readers: no text here is announced again.
    let (Some((run, other)), Some(measures)) = (second, &sets.second) else {
        lines(ui, text_of(context.run, shown, status)).known_as("analysis.status");
        return;
    };
    let text = text_of(context.run, shown, format!("A: {status}"));
    lines(ui, text).known_as("analysis.status");
    let text = format!("B: {}", status_text(run, &other, measures));
    lines(ui, text_of(run, &other, text)).known_as("analysis.status-b");
}

/// Returns a sentence on which moment of a run is measured, and how far.
fn status_text(run: &RunView, shown: &ShownMoment<'_>, measures: &RunMeasures<'_>) -> String {
    let measuring = &run.measuring;
    let name = capital(&name_of(shown));
    // Beside a planar run A, the table has the numbers of planar sets, and no spectrum follows.
    if shown.session.solid.is_some() {
        return format!("{name}: a set in space, whose numbers are shown where it is run A.");
    }
    if let Some(why) = measuring.failure(shown) {
        return format!("{name}: {why}");
    }
    if measuring.is_whole(shown) {
        let counts = measures.now.map(numbers::counts).unwrap_or_default();
        return format!("{name}: {counts}");
    }
    // While the run moves, its live measures are of this moment already, though perhaps with fewer frequencies.
    if let Some(live) = measures.live {
        let spectrum = spectrum_text(&run.live, shown);
        return format!("{name}: {} {spectrum}", numbers::counts(live));
    }

    // The measures of another moment are named only where they are drawn, faded.
    let old = match measuring.last(shown).filter(|_| measures.before.is_some()) {
        Some(known) => format!(" Faded: {}.", known.name),
        None => String::new(),
    };
    // A run whose measures cannot move with it says why not. One in a field or a shape is not measured at rest either.
    let refusal = run.live.refusal().unwrap_or_default();
    if shown.session.ground.is_some() && !refusal.is_empty() {
        return format!("{name}: {refusal}");
    }
    let doing = if measuring.is_stopped(shown) {
        "not measured."
    } else {
        "being measured\u{2026}"
    };
    format!("{name}: {doing}{old} {refusal}")
}

/// Returns a sentence on the spectrum that is shown while the run moves: its share of the frequencies, or its moment.
fn spectrum_text(live: &Live, shown: &ShownMoment<'_>) -> String {
    match live.share(shown).map(f64::recip) {
        None => match live.behind(shown) {
            Some(behind) => {
                let at = grouped(behind.cursor);
                // Moments of nested levels are numbers of samples.
                match shown.debugger {
                    Some(_) => format!("Faded: the spectrum of event {at}."),
                    None => format!("Faded: the spectrum of the first {at} samples."),
                }
            }
            None => "The spectrum follows.".to_owned(),
        },
        // The share is 1, a fourth or a ninth.
        Some(in_all) if in_all < 1.5 => "All frequencies are shown.".to_owned(),
        Some(in_all) => format!("1 in {in_all:.0} frequencies is shown."),
    }
}

/// Shows the progress of measuring, with a button to stop or resume it.
fn progress(
    ui: &mut Ui,
    context: &AnalysisContext<'_>,
    shown: &ShownMoment<'_>,
    own: &mut Vec<AnalysisCommand>,
) {
    let (palette, measuring) = (context.palette, &context.run.measuring);
    if let Some((part, fraction)) = measuring.progress() {
        // The button stands before the text, whose length changes, so that it stays under the pointer.
        let cancel = ui.button("Cancel");
        cancel.known_as("analysis.cancel");
        let cancel = cancel.on_hover_text("Stops measuring this moment.");
        if cancel.clicked() {
            own.push(AnalysisCommand::Stop);
        }

        let bar = ProgressBar::new(fraction).desired_height(6.0);
        named_bar(ui, bar.desired_width(56.0), "Measuring", palette);
        ui.label(RichText::new(part.doing()).size(11.5).color(palette.muted));
    } else if measuring.failure(shown).is_some() {
        ui.button("Measure again")
            .issues("analysis.again", AnalysisCommand::Resume, own);
    // A moment that was measured whole before has nothing left to measure.
    } else if measuring.is_stopped(shown)
        && !measuring.is_whole(shown)
        && ui.button("Measure this moment").clicked()
    {
        own.push(AnalysisCommand::Resume);
    }
}

/// Shows text in a room of three lines, so that nothing below moves when the text changes.
fn lines(ui: &mut Ui, text: RichText) -> egui::Response {
    let room = vec2(ui.available_width(), 52.0);
    let layout = egui::Layout::top_down(egui::Align::Min);
    let add = |ui: &mut Ui| {
        ui.set_min_size(room);
        ui.label(text)
    };
    ui.allocate_ui_with_layout(room, layout, add).inner
}

/// Shows the legend of the lines.
fn legend(ui: &mut Ui, context: &AnalysisContext<'_>, sets: &Sets<'_>) {
    ui.add_space(4.0);
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 2.0;
        entries(ui, context, sets);
    });
}

/// Shows an entry of the legend for each line of the charts.
fn entries(ui: &mut Ui, context: &AnalysisContext<'_>, sets: &Sets<'_>) {
    let palette = sets.palette;
    let spectrum = sets.first.spectrum();
    let has_band = spectrum.is_some_and(|(spectrum, _)| spectrum.bands.is_some());
    // With a second run beside it, this one is named A.
    let this = match (sets.second, has_band) {
        (None, true) => "this moment, with its 95% band",
        (None, false) => "this moment",
        (Some(_), true) => "run A at this moment, with its 95% band",
        (Some(_), false) => "run A at this moment",
    };

    entry(ui, Dash::Solid, palette.accent, this).known_as("analysis.moment");
    if sets.second.is_some() {
        let (line, color) = line_of_second(palette);
        entry(ui, line, color, "run B at its moment").known_as("analysis.second");
    }

    let reference = &context.analysis.reference;
    let name = match reference {
        tilescope_workbench::analysis::Reference::Failed(why) => format!("reference: {why}"),
        _ => format!("reference: {}", reference.name()),
    };
    entry(ui, Dash::Dotted, palette.text, &name).known_as("analysis.reference");

    match context.reference_file.clone() {
        Some(Ok(file)) => {
            let guessed = if file.guessed {
                " (unit square assumed)"
            } else {
                ""
            };
            let radius = file.measured.radius;
            let judged = radius.map_or_else(String::new, |r| format!(", judged at r = {r}"));
            let name = format!("file: {}{guessed}{judged}", file.name());
            entry(ui, Dash::Dashed, palette.conflict, &name).known_as("analysis.file");
            // The file was judged with the r that the run had when the file was read. A line says so if the run has
            // another r by now.
            if let Some(reason) = numbers::unjudged(&file.measured.with_radius(sets.unit)) {
                ui.label(RichText::new(reason).size(12.0).color(palette.muted))
                    .known_as("analysis.unjudged");
            }
        }
        Some(Err(why)) => {
            ui.label(RichText::new(why).size(12.0).color(palette.conflict))
                .known_as("analysis.refusal");
        }
        None => {}
    }
}

/// Shows a line of the legend.
fn entry(ui: &mut Ui, line: Dash, color: Color32, text: &str) -> egui::Response {
    let muted = ui.visuals().weak_text_color();
    ui.horizontal_top(|ui| {
        let (rect, _) = ui.allocate_exact_size(vec2(26.0, 17.0), Sense::hover());
        plot::sample(ui.painter(), rect, line, color);
        let text = RichText::new(text).size(12.0).color(muted);
        ui.add(egui::Label::new(text).wrap())
    })
    .inner
}

/// Shows the buttons that choose and clear a file to compare with.
fn file(
    ui: &mut Ui,
    context: &AnalysisContext<'_>,
    commands: &mut Vec<Command>,
    own: &mut Vec<AnalysisCommand>,
) {
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        let open = ui.button("Compare with a file\u{2026}");
        let command = Command::File(FileCommand::Sheet(Purpose::Against));
        open.issues("analysis.hold", command, commands);

        let there = context.analysis.reference_file.is_some();
        let clear = ui.add_enabled(there, Button::new("Clear"));
        clear.known_as("analysis.clear");
        if clear
            .on_hover_text("Stops comparing with the file.")
            .on_disabled_hover_text("This run is not compared with a file.")
            .clicked()
        {
            own.push(AnalysisCommand::Clear);
        }
    });
}

/// Shows the brushed range as numbers, for the keyboard.
fn brushed(ui: &mut Ui, context: &AnalysisContext<'_>, own: &mut Vec<AnalysisCommand>) {
    let (palette, brush) = (context.palette, context.analysis.brush);
    // A range that is switched on begins where the curves of maximal sets are highest.
    for (axis, name, start) in [
        (BrushAxis::Frequency, "Frequencies", FIRST_PEAK),
        (BrushAxis::Distance, "Distances", JUST_ABOVE_R),
    ] {
        let range = Brush::along(brush, axis);
        ui.horizontal(|ui| {
            let mut on = range.is_some();
            let [mut low, mut high] = range.unwrap_or(start);
            // The fields of both rows begin at the same place, right of the longer name.
            let fields_left = ui.max_rect().left() + 108.0;
            let switch = ui.checkbox(&mut on, name);
            let id = format_args!("brush.{}", Kebab(axis));
            let mut changed = switch.known_as(id).changed();
            ui.add_space((fields_left - ui.cursor().left()).max(0.0));

            for (value, which) in [(&mut low, "from"), (&mut high, "to")] {
                let field = DragValue::new(value)
                    .range(0.0..=axis.end())
                    // A drag over 200 points changes the value by 1.
                    .speed(0.005)
                    .fixed_decimals(3);
                let field = match axis {
                    BrushAxis::Frequency => field.prefix("\u{3bd} "),
                    BrushAxis::Distance => field.suffix(" r"),
                };
                let field = ui.add_enabled(on, field);
                // The text of a field is a number alone, so that screen readers get a name.
                let label = format!("Brush: {name} {which}");
                field.widget_info(|| egui::WidgetInfo::labeled(egui::Role::SpinButton, on, &label));
                field.known_as(format_args!("brush.{}.{which}", Kebab(axis)));
                changed |= field.changed();
                field.on_disabled_hover_text("Switched off: no range is selected.");
            }

            if changed {
                // Two equal numbers are no range, and clear the brush as the switch does.
                let brush = Brush::between(axis, low, high).filter(|_| on);
                own.push(AnalysisCommand::Brush(brush));
            }
        });
    }
    ui.horizontal(|ui| {
        // Without a search the row is empty, so that nothing below it moves when one begins.
        ui.set_height(24.0);
        if let Some(fraction) = context.analysis.marks.progress() {
            let bar = ProgressBar::new(fraction).desired_height(6.0);
            named_bar(ui, bar.desired_width(56.0), "Search", palette);
            let cancel = ui.button("Cancel the search");
            cancel.known_as("brush.cancel");
            if cancel.on_hover_text("Clears the brush.").clicked() {
                own.push(AnalysisCommand::Brush(None));
            }
        }
    });

    let text = RichText::new(&*context.brush_text).size(12.0);
    let response = lines(ui, text.color(palette.muted));
    super::common::read_out(ui, &response);
    response.known_as("brush.status");
}

/// Issues what a drag along `axis` has changed, if anything: a range that differs from `brush`, or that the brush is
/// cleared.
fn drag(
    axis: BrushAxis,
    dragged: Option<Dragged>,
    brush: Option<Brush>,
    own: &mut Vec<AnalysisCommand>,
) {
    match dragged {
        Some(Dragged::Between(a, b)) => {
            let dragged = Brush::between(axis, a, b);
            // A drag begins without a width, which is no range yet, and may move within the same range: both issue nothing.
            if dragged.is_some() && dragged != brush {
                own.push(AnalysisCommand::Brush(dragged));
            }
        }
        // A click without a drag.
        Some(Dragged::Nothing) => own.push(AnalysisCommand::Brush(None)),
        None => {}
    }
}
