//! The table of numbers of the analysis, with a column for each set.
//! Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

use egui::{
    Align2, Color32, FontId, Rangef, Rect, Response, Role, Sense, Ui, WidgetInfo, pos2, vec2,
};
use tilescope_analysis::measures::{CATALOGUE, MeasuredSet, Part, SPACE_CATALOGUE, SetNumber};
use tilescope_core::SOLID_DENSITY;
use tilescope_session::words::{conflicts_in, counted, grouped, sentence};
use tilescope_ui::language::Worded;
use tilescope_ui::table::{SpokenCell, spoken_row, table};
use tilescope_ui::widgets::Known;
use tilescope_workbench::live::{NO_MEANING, NO_MEANING_IN_SHAPE};

use super::{RunMeasures, Sets};
use crate::ENABLED;

/// Width of a number, in screen points.
const COLUMN: f32 = 62.0;
/// Width of the names of numbers.
const NAME: f32 = 128.0;
/// Height of a row.
const ROW: f32 = 19.0;
/// Fewer samples have no pair correlation, and are not measured.
const MIN_SAMPLES: usize = 3;

/// A column of the table.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Column {
    /// The moment of the run, or of run A.
    Moment,
    /// That of run B.
    Second,
    /// How much more B has than A.
    Difference,
    /// The set of reference.
    Reference,
    /// The file to compare with.
    File,
}

impl Column {
    /// Returns the columns of a table, the most important first: those that have room.
    fn of(sets: &Sets<'_>, width: f32) -> Vec<Self> {
        let compared = sets.second.is_some();
        // Files are planar sets.
        let is_planar = !sets.first.is_in_space;
        let all = [
            (Self::Moment, true),
            (Self::Second, compared),
            (Self::Difference, compared),
            (Self::Reference, true),
            (Self::File, is_planar && sets.reference_file.is_some()),
        ];
        let shown = all.into_iter().filter(|(_, is_there)| *is_there);
        // Two runs and their difference are shown in any case, however narrow the panel.
        let most = ((width - NAME) / COLUMN).floor().max(3.0) as usize;
        shown.map(|(column, _)| column).take(most).collect()
    }

    const fn head(self, is_compared: bool) -> &'static str {
        match self {
            Self::Moment if is_compared => "A",
            Self::Moment => "moment",
            Self::Second => "B",
            Self::Difference => "B \u{2212} A",
            Self::Reference => "reference",
            Self::File => "file",
        }
    }
}

/// Shows the table. The rows are shown before their values are known.
pub fn show(ui: &mut Ui, sets: &Sets<'_>) {
    let columns = Column::of(sets, ui.available_width());
    let is_compared = sets.second.is_some();
    let heads: Vec<&str> = (columns.iter())
        .map(|column| column.head(is_compared))
        .collect();
    // Only a number of a run can be that of an earlier moment (`now`). Heads are no numbers, a difference is shown only
    // if both numbers are of this moment, and the reference and the file do not change.
    let is_outdated = false;
    // `row` takes a row without a name for that of the heads.
    let of_heads = heads.iter().map(|head| ((*head).to_owned(), is_outdated));
    let of_heads: Vec<(String, bool)> = of_heads.collect();

    let catalogue = if sets.first.is_in_space {
        SPACE_CATALOGUE
    } else {
        CATALOGUE
    };
    let named = catalogue.iter().filter(|number| number.short.is_some());
    // The heads are a row, and the names a column.
    let size = [named.count() + 1, columns.len() + 1];
    let name = ui.words("Numbers of the sets");
    table(ui, &name, size, Role::Table, |ui| {
        row(ui, sets, 0, ("", ""), &heads, &of_heads, "");
        numbers(ui, sets, catalogue, &columns, &heads);
    });
}

/// Shows the rows of numbers below the heads.
fn numbers(
    ui: &mut Ui,
    sets: &Sets<'_>,
    catalogue: &'static [SetNumber],
    columns: &[Column],
    heads: &[&str],
) {
    // As in `show`: a difference, the reference and the file are never of an earlier moment.
    let is_outdated = false;

    // The file keeps its own unit. It is judged by this run's r, whose length in that unit is `sets.unit`.
    let file = (sets.reference_file).map(|file| file.measured.with_radius(sets.unit));
    let named = catalogue
        .iter()
        .filter_map(|number| Some((number, number.short?)));
    for (index, (number, name)) in named.enumerate() {
        let texts = columns.iter().map(|column| match column {
            Column::Moment => now(number, &sets.first),
            Column::Second => sets.second.map_or_else(unknown, |run| now(number, &run)),
            Column::Difference => (difference(number, sets).unwrap_or_else(dash), is_outdated),
            Column::Reference if sets.first.is_in_space => {
                (in_space(number).unwrap_or_else(dash), is_outdated)
            }
            Column::Reference => {
                let set = sets.reference.map(|set| &**set);
                (
                    set.and_then(|set| text_of(number, set))
                        .unwrap_or_else(dash),
                    is_outdated,
                )
            }
            Column::File => {
                let text = file.as_ref().and_then(|set| text_of(number, set));
                (text.unwrap_or_else(dash), is_outdated)
            }
        });
        let texts: Vec<(String, bool)> = texts.collect();

        let explanation = match file.as_ref().and_then(unjudged) {
            Some(reason) if is_of_verdict(number) => format!("{} {reason}", number.meaning),
            _ if !has_meaning(number, &sets.first) => {
                let why = if sets.first.varies() {
                    NO_MEANING
                } else {
                    NO_MEANING_IN_SHAPE
                };
                format!("{} {why}", number.meaning)
            }
            _ => number.meaning.to_owned(),
        };
        let key = (number.key, name);
        // Row 0 has the heads.
        row(ui, sets, index + 1, key, heads, &texts, &explanation);
    }
}

fn dash() -> String {
    "\u{2013}".to_owned()
}

/// Returns the number of large maximal sets in space, of which the density alone is known.
fn in_space(number: &SetNumber) -> Option<String> {
    (number.key == "density").then(|| format!("{SOLID_DENSITY:.4}"))
}

fn unknown() -> (String, bool) {
    (dash(), false)
}

/// Returns a number of the moment of a run, and whether it is outdated.
fn now(number: &SetNumber, run: &RunMeasures<'_>) -> (String, bool) {
    if !has_meaning(number, run) {
        return unknown();
    }
    run.part(|set| text_of(number, set)).unwrap_or_else(|| {
        let awaits_rest = run.live.is_some_and(|live| awaits_rest(number, live));
        let text = if awaits_rest {
            "at rest".to_owned()
        } else {
            dash()
        };
        (text, false)
    })
}

/// Returns by how much a number of run B is larger than that of run A, if both have it at the moment that is shown.
fn difference(number: &SetNumber, sets: &Sets<'_>) -> Option<String> {
    let value = |run: RunMeasures<'_>| {
        let (value, faded) = run.part(|set| number.of(set))?;
        (!faded && has_meaning(number, &run)).then_some(value)
    };
    let difference = value(sets.second?)? - value(sets.first)?;
    // As many decimals as the numbers beside it have.
    let decimals = if number.decimals == 0 { 0 } else { 4 };
    let rounded = format!("{:.decimals$}", difference.abs());
    // A difference that is 0 with these decimals has no sign.
    let is_zero = rounded.chars().all(|c| matches!(c, '0' | '.'));
    let sign = match difference {
        _ if is_zero => "",
        below if below < 0.0 => "\u{2212}",
        _ => "+",
    };

    let text = if decimals == 0 {
        grouped(difference.abs() as usize)
    } else {
        rounded
    };
    Some(format!("{sign}{text}"))
}

/// Returns a number of a set, once it is known.
fn text_of(number: &SetNumber, set: &MeasuredSet) -> Option<String> {
    match number.of(set) {
        Some(value) if number.decimals == 0 => Some(grouped(value as usize)),
        // The column has room for four decimals.
        Some(value) => Some(format!("{value:.4}")),
        // A number that was measured and is missing is one that this set has not. Those of the verdict are not
        // measured, but judged: where one is missing there is no verdict yet.
        None => {
            let is_measured = |part| part != Part::Report && set.knows(part);
            (number.needs.is_some_and(is_measured)).then(|| "none".to_owned())
        }
    }
}

/// Returns whether a number is not known while the run moves, though the set has one.
fn awaits_rest(number: &SetNumber, live: &MeasuredSet) -> bool {
    // In space all numbers are followed.
    live.space.is_none()
        && live.samples >= MIN_SAMPLES
        && number.needs.is_some_and(|part| !live.knows(part))
}

/// Returns whether a number is one of this run. In a field or a shape these are the numbers that move with the run, and none is
/// measured at rest besides; in a field also those that its spectrum has, which is that of all samples.
fn has_meaning(number: &SetNumber, run: &RunMeasures<'_>) -> bool {
    !run.is_local || run.session.setting().defines(number) || number.needs == Some(Part::Spectrum)
}

/// Returns whether a number depends on the radius that the set was judged with.
fn is_of_verdict(number: &SetNumber) -> bool {
    // Conflicts and gaps do: these counts are the verdict's only numbers without decimals.
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

/// Shows the row of an index: its key and name, a text for each column with whether it is outdated, and an explanation of the
/// number. A row without a name is that of the heads.
fn row(
    ui: &mut Ui,
    sets: &Sets<'_>,
    index: usize,
    (key, name): (&str, &str),
    heads: &[&str],
    texts: &[(String, bool)],
    explanation: &str,
) {
    let palette = sets.palette;
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::hover());
    let is_head = name.is_empty();
    if !is_head {
        let each = heads.iter().zip(texts).map(|(head, (text, faded))| {
            let old = if *faded { " (of a moment before)" } else { "" };
            // The moment of the only run needs no head: the number itself says it.
            match *head {
                "moment" => format!("{text}{old}"),
                head => format!("{head} {text}{old}"),
            }
        });
        let description = format!("{name}: {}", each.collect::<Vec<_>>().join(", "));
        response.widget_info(|| WidgetInfo::labeled(Role::Row, ENABLED, &description));
        response.known_as(format_args!("analysis.number-{key}"));
    }
    speak(ui, &response, index, name, texts);
    if !is_head {
        response.on_hover_text(explanation);
    }

    let painter = ui.painter();
    let at = rect.left_center();
    let font = FontId::proportional(12.8);
    painter.text(at, Align2::LEFT_CENTER, name, font, palette.muted);
    // The columns of the runs come first: A, B and their difference, or the one run.
    let run_columns = if sets.second.is_some() { 3 } else { 1 };
    for (column, (text, faded)) in texts.iter().enumerate() {
        let color: Color32 = match column {
            _ if is_head => palette.muted,
            _ if *faded => palette.text.gamma_multiply(0.45),
            of_run if of_run < run_columns => palette.text,
            _ => palette.muted,
        };
        let font = if is_head {
            FontId::proportional(11.5)
        } else {
            FontId::monospace(12.3)
        };
        let x = end_of(rect, column, texts.len());
        painter.text(pos2(x, at.y), Align2::RIGHT_CENTER, text, font, color);
    }
}

/// Returns where a column of so many ends: the last one at the right edge.
fn end_of(rect: Rect, column: usize, columns: usize) -> f32 {
    rect.right() - COLUMN * (columns - 1 - column) as f32
}

/// Gives a drawn row to screen readers as row `index` of the table. The row of the heads has no name.
fn speak(ui: &mut Ui, row: &Response, index: usize, name: &str, texts: &[(String, bool)]) {
    let rect = row.rect;
    let is_head = name.is_empty();
    let (first, role) = if is_head {
        (Role::ColumnHeader, Role::ColumnHeader)
    } else {
        (Role::RowHeader, Role::Cell)
    };
    // The names have no head on the screen.
    let title = if is_head { "number" } else { name };
    let names = Rangef::new(rect.left(), rect.left() + NAME);

    let mut cells = vec![SpokenCell::new(first, ui.words(title), names)];
    cells.extend(texts.iter().enumerate().map(|(column, (text, faded))| {
        let end = end_of(rect, column, texts.len());
        let old = if *faded { " (of a moment before)" } else { "" };
        let text = ui.words(format!("{text}{old}"));
        SpokenCell::new(role, text, Rangef::new(end - COLUMN, end))
    }));
    spoken_row(ui, row, index, cells);
}
