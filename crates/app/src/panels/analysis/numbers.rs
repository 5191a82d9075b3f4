//! The table of numbers of the analysis, with a column for each set.

use egui::{Align2, Color32, FontId, Role, Sense, Ui, WidgetInfo, pos2, vec2};
use tilescope_analysis::Report;
use tilescope_analysis::measures::PowerCurve;
use tilescope_session::glossary;
use tilescope_session::words::{conflicts_in, counted, grouped};
use tilescope_ui::widgets::Known;

use super::Sets;
use tilescope_workbench::analysis::measured::MeasuredSet;

/// Width of a number, in screen points.
const COLUMN: f32 = 62.0;
const ROW: f32 = 19.0;

/// A row: its name, explanation, and the value of a set where r has the given length.
struct NumberRow {
    name: &'static str,
    explanation: &'static str,
    value: fn(&MeasuredSet, f64) -> Option<String>,
}

const NUMBERS: [NumberRow; 8] = [
    NumberRow {
        name: "Samples",
        explanation: "Samples kept at this moment: tiled or inserted, and not eliminated.",
        value: |set, _| Some(grouped(set.samples)),
    },
    NumberRow {
        name: "Density N r\u{b2}/A",
        explanation: glossary::DENSITY.meaning,
        value: |set, unit| {
            let density = set.samples as f64 * unit * unit / set.region.area();
            Some(format!("{density:.4}"))
        },
    },
    NumberRow {
        name: "Conflicts",
        explanation: glossary::CONFLICT.meaning,
        value: |set, unit| Some(grouped(judged(set, unit)?.conflicts as usize)),
    },
    NumberRow {
        name: "Open places",
        explanation: glossary::OPEN_PLACE.meaning,
        value: |set, unit| Some(grouped(judged(set, unit)?.gaps as usize)),
    },
    NumberRow {
        name: "Smallest distance, r",
        explanation: glossary::MIN_DISTANCE.meaning,
        value: |set, unit| Some(finite(set.verdict()?.min_distance / unit)),
    },
    NumberRow {
        name: "Relative radius",
        explanation: glossary::RELATIVE_RADIUS.meaning,
        value: |set, _| Some(finite(set.verdict()?.relative_radius)),
    },
    NumberRow {
        name: "Eff. Nyquist \u{3bd}",
        explanation: glossary::NYQUIST.meaning,
        value: |set, _| of_curve(set, PowerCurve::effective_nyquist),
    },
    NumberRow {
        name: "Oscillation",
        explanation: glossary::OSCILLATION.meaning,
        value: |set, _| of_curve(set, PowerCurve::oscillation),
    },
];

/// Shows the table. The rows are shown before their values are known.
pub fn show(ui: &mut Ui, sets: &Sets<'_>) {
    let heads = ["moment", "reference", "file"];
    let columns = if sets.reference_file.is_some() { 3 } else { 2 };
    row(
        ui,
        sets,
        (0, ""),
        &heads.map(str::to_owned)[..columns],
        false,
        "",
    );
    for (ordinal, number) in (1..).zip(&NUMBERS) {
        let value = |set: Option<&MeasuredSet>, unit| {
            let text = set.and_then(|set| (number.value)(set, unit));
            text.unwrap_or_else(|| "\u{2013}".to_owned())
        };
        let (now, faded) = sets
            .part(|set| (number.value)(set, 1.0))
            .unwrap_or_else(|| ("\u{2013}".to_owned(), false));
        let file = sets.reference_file.map(|file| &*file.measured);
        let texts = [
            now,
            value(sets.reference.map(|set| &**set), 1.0),
            value(file, sets.unit),
        ];
        let reason = sets
            .reference_file
            .and_then(|file| unjudged(&file.measured, sets.unit));
        let explanation = match reason.filter(|_| JUDGED.contains(&number.name)) {
            Some(reason) => format!("{} {reason}", number.explanation),
            None => number.explanation.to_owned(),
        };
        let texts = &texts[..columns];
        let name = (ordinal, number.name);
        row(ui, sets, name, texts, faded, &explanation);
    }
}

/// Numbers that depend on the radius the set was verified with.
const JUDGED: [&str; 2] = ["Conflicts", "Open places"];

/// Returns the verdict on a set, if it was verified with r of length `unit`.
fn judged(set: &MeasuredSet, unit: f64) -> Option<&Report> {
    set.verdict().filter(|_| set.is_judged_with(unit))
}

/// Returns why conflicts and gaps of a file are not shown, if they are for another radius.
pub fn unjudged(file: &MeasuredSet, unit: f64) -> Option<String> {
    (!file.is_judged_with(unit)).then(|| {
        format!(
            "The file was judged at r = {}, and this run's r is {unit}: compare with it again.",
            file.radius
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
        Some(Err(why)) => format!("{samples}. {why}"),
        None => format!("{samples}."),
    }
}

fn row(
    ui: &mut Ui,
    sets: &Sets<'_>,
    (ordinal, name): (usize, &str),
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
        response.known_as(format_args!("analysis.number-{ordinal}"));
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

fn finite(value: f64) -> String {
    if value.is_finite() {
        format!("{value:.4}")
    } else {
        "none".to_owned()
    }
}

/// Returns a number derived from the smooth spectrum, if the spectrum is known.
fn of_curve(set: &MeasuredSet, number: fn(&PowerCurve) -> Option<f64>) -> Option<String> {
    set.spectrum.as_ref()?;
    let found = set.curve.as_deref().and_then(number);
    Some(found.map_or_else(|| "none".to_owned(), finite))
}
