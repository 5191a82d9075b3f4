//! The table of numbers of the analysis, with a column for each set.

use egui::{Align2, Color32, FontId, Role, Sense, Ui, WidgetInfo, pos2, vec2};
use tilescope_analysis::measures::{CATALOGUE, MeasuredSet, Part, SetNumber};
use tilescope_session::words::{conflicts_in, counted, grouped, sentence};
use tilescope_ui::widgets::Known;

use super::Sets;

/// Width of a number, in screen points.
const COLUMN: f32 = 62.0;
const ROW: f32 = 19.0;
/// Fewer samples are not measured.
const MIN_SAMPLES: usize = 3;

/// Shows the table. The rows are shown before their values are known.
pub fn show(ui: &mut Ui, sets: &Sets<'_>) {
    let heads = ["moment", "reference", "file"];
    let columns = if sets.reference_file.is_some() { 3 } else { 2 };
    let heads = heads.map(str::to_owned);
    row(ui, sets, ("", ""), &heads[..columns], false, "");

    // The file keeps its own unit, and this run's r has another length in it.
    let file = (sets.reference_file).map(|file| file.measured.with_radius(sets.unit));
    for number in CATALOGUE {
        let Some(name) = number.short else {
            continue;
        };
        let shown = |set: Option<&MeasuredSet>| {
            let text = set.and_then(|set| text_of(number, set));
            text.unwrap_or_else(|| "\u{2013}".to_owned())
        };
        let (now, faded) = sets.part(|set| text_of(number, set)).unwrap_or_else(|| {
            let awaits_rest = sets.live.is_some_and(|live| awaits_rest(number, live));
            let text = if awaits_rest { "at rest" } else { "\u{2013}" };
            (text.to_owned(), false)
        });
        let reference = sets.reference.map(|set| &**set);
        let texts = [now, shown(reference), shown(file.as_ref())];

        let explanation = match file.as_ref().and_then(unjudged) {
            Some(reason) if is_of_verdict(number) => format!("{} {reason}", number.meaning),
            _ => number.meaning.to_owned(),
        };
        let name = (number.key, name);
        row(ui, sets, name, &texts[..columns], faded, &explanation);
    }
}

/// Returns a number of a set, once it is known.
fn text_of(number: &SetNumber, set: &MeasuredSet) -> Option<String> {
    match number.of(set) {
        Some(value) if number.decimals == 0 => Some(grouped(value as usize)),
        // The column has room for so many decimals.
        Some(value) => Some(format!("{value:.4}")),
        // It is measured, and this set has none; without a verdict nothing is known of it.
        None => {
            let is_measured = |part| part != Part::Report && set.knows(part);
            (number.needs.is_some_and(is_measured)).then(|| "none".to_owned())
        }
    }
}

/// Returns whether a number is not known while the run moves, though the set has one.
fn awaits_rest(number: &SetNumber, live: &MeasuredSet) -> bool {
    live.samples >= MIN_SAMPLES && number.needs.is_some_and(|part| !live.knows(part))
}

/// Returns whether a number depends on the radius that the set was judged with.
fn is_of_verdict(number: &SetNumber) -> bool {
    number.needs == Some(Part::Report) && number.decimals == 0
}

/// Returns why conflicts and gaps of a file are not shown, if they are for another radius than that of the run.
pub fn unjudged(file: &MeasuredSet) -> Option<String> {
    let (report, unit) = (file.verdict()?, file.radius?);
    file.judged().is_none().then(|| {
        format!(
            "The file was judged at r = {}, and this run's r is {unit}: compare with it again.",
            report.radius
        )
    })
}

/// Returns the numbers of samples, conflicts and gaps, in words.
pub fn counts(set: &MeasuredSet) -> String {
    let samples = counted(set.samples, "sample", "samples");
    match &set.report {
        Some(Ok(report)) => format!(
            "{samples}, {}, {}.",
            conflicts_in(report),
            counted(report.gaps as usize, "open place", "open places")
        ),
        Some(Err(why)) => format!("{samples}. {}", sentence(why)),
        None => format!("{samples}."),
    }
}

fn row(
    ui: &mut Ui,
    sets: &Sets<'_>,
    (key, name): (&str, &str),
    texts: &[String],
    faded: bool,
    explanation: &str,
) {
    let palette = sets.palette;
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    let is_head = name.is_empty();
    if !is_head {
        let names = ["", "reference ", "file "];
        let each = names
            .iter()
            .zip(texts)
            .map(|(name, text)| format!("{name}{text}"));
        let old = if faded { " (of a moment before)" } else { "" };
        let description = format!("{name}: {}{old}", each.collect::<Vec<_>>().join(", "));
        response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &description));
        response.known_as(format_args!("analysis.number-{key}"));
        response.on_hover_text(explanation);
    }
    let painter = ui.painter();
    let at = rect.left_center();
    let font = FontId::proportional(12.8);
    painter.text(at, Align2::LEFT_CENTER, name, font, palette.muted);
    for (k, text) in texts.iter().enumerate() {
        let color: Color32 = match k {
            _ if is_head => palette.muted,
            0 if faded => palette.text.gamma_multiply(0.45),
            0 => palette.text,
            _ => palette.muted,
        };
        let font = if is_head {
            FontId::proportional(11.5)
        } else {
            FontId::monospace(12.3)
        };
        let x = rect.right() - COLUMN * (texts.len() - 1 - k) as f32;
        painter.text(pos2(x, at.y), Align2::RIGHT_CENTER, text, font, color);
    }
}
