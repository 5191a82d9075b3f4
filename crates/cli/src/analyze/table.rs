//! Tables of measures: one row per measure, one column per set. Wide tables are split between sets; table libraries do
//! not do that.

use std::fmt::Write;

use super::differences::{Difference, Differences};
use super::measure::{Measure, Spread};
use super::measured::Member;
use super::subject::Subject;
use crate::output::region_text;

/// Tables with more characters in a row than this are split into several.
const MAX_WIDTH: usize = 110;

/// Letters between two columns.
const GAP: usize = 3;

/// Rows of measures and columns of sets, still without a form.
#[derive(Default)]
pub struct Table {
    /// The heading of the labels.
    pub head: String,
    /// A label and a unit each.
    pub rows: Vec<(String, &'static str)>,
    pub columns: Vec<Column>,
}

/// A column: its name, and a cell for each row.
pub struct Column {
    pub name: String,
    pub cells: Vec<String>,
    /// Whether it stays beside the column before it.
    joined: bool,
}

impl Column {
    /// Returns a column that may stand apart from the one before it.
    pub fn new(name: &str, cells: impl IntoIterator<Item = String>) -> Self {
        Self {
            name: name.to_owned(),
            cells: cells.into_iter().collect(),
            joined: false,
        }
    }
}

/// Returns the measures of all subjects.
pub fn measures(subjects: &[Subject]) -> Table {
    // Averages have more measures than sets.
    let longest = subjects.iter().max_by_key(|subject| subject.measures.len());
    let rows: &[Measure] = longest.map_or(&[], |subject| &subject.measures);
    let of_a_set = ["format", "domain", "radius is"].map(|label| (label.to_owned(), ""));
    let of_measures = rows.iter().map(labelled);
    // A measure that a subject lacks is a dash in its column.
    Table {
        head: "measure".to_owned(),
        rows: of_a_set.into_iter().chain(of_measures).collect(),
        columns: subjects.iter().flat_map(|one| columns(one, rows)).collect(),
    }
}

/// Returns the column of a subject, and those of the spread between the sets of an average.
fn columns(subject: &Subject, rows: &[Measure]) -> Vec<Column> {
    // One set has no spread.
    let several = subject.members.len() > 1;
    let column = |name: &str, words: [String; 3], value: &dyn Fn(&Measure) -> String| {
        // A row may be one that only averages have, so that measures are found by their keys.
        let cell = |row: &Measure| {
            let own = subject.measures.iter().find(|own| own.key == row.key);
            own.map_or_else(|| "-".to_owned(), value)
        };
        Column::new(name, words.into_iter().chain(rows.iter().map(cell)))
    };

    // The rows about the set come first, in the order in which `measures` labels them.
    let words = [
        format(&subject.members),
        region_text(&subject.region),
        origin(&subject.members),
    ];
    // The last argument of `text` is how many decimals are added to those of the measure: one for means of whole
    // numbers. The columns below have one more, too.
    let mean = |own: &Measure| own.text(own.value, usize::from(several && own.decimals == 0));
    let mut columns = vec![column(&subject.title, words, &mean)];

    if several {
        type Part = fn(&Spread) -> f64;
        let spreads: [(&str, Part); 3] = [
            ("standard error", |spread| spread.standard_error),
            ("least", |spread| spread.least),
            ("most", |spread| spread.most),
        ];
        columns.extend(spreads.map(|(name, value)| {
            let value = |own: &Measure| own.text(own.spread.as_ref().map(value), 1);
            column(name, [const { String::new() }; 3], &value)
        }));
    }

    // A wide table is split between subjects only.
    for column in &mut columns[1..] {
        column.joined = true;
    }
    columns
}

fn labelled(measure: &Measure) -> (String, &'static str) {
    (measure.label.clone(), measure.unit)
}

fn format(members: &[Member]) -> String {
    let first = members.first().map(|member| member.format);
    match first {
        Some(first) if members.iter().all(|member| member.format == first) => first.to_string(),
        _ => "several".to_owned(),
    }
}

fn origin(members: &[Member]) -> String {
    let known = members.iter().filter(|member| member.has_radius).count();
    match known {
        0 => "smallest distance".to_owned(),
        all if all == members.len() => "known".to_owned(),
        some => format!("known of {some}"),
    }
}

/// Returns the differences of subjects, by their labels, from a reference.
pub fn differences<'a>(
    reference: &str,
    labels: impl Iterator<Item = &'a str>,
    all: &[Differences],
) -> Table {
    let Some(first) = all.first() else {
        return Table::default();
    };
    // Either single sets are compared or one average, so that all subjects have the measures of the first.
    let of_measures = first.measures.iter().map(|difference| &difference.measure);
    let column = |(label, of): (&str, &Differences)| {
        let curves = of.of_curves.iter().map(|own| own.text(own.value, 0));
        let measures = of.measures.iter().map(Difference::text);
        Column::new(label, measures.chain(curves))
    };
    Table {
        head: format!("less {reference}"),
        rows: of_measures.chain(&first.of_curves).map(labelled).collect(),
        columns: labels.zip(all).map(column).collect(),
    }
}

/// Returns the table of the files behind an average.
pub fn files(members: &[Member]) -> Table {
    let measures = members.first().map_or(&[][..], |first| &first.measures);
    let column = |(index, measure): (usize, &Measure)| {
        // All files of an average have the same measures.
        let cell = |member: &Member| {
            let own = &member.measures[index];
            own.text(own.value, 0)
        };
        let name = with_unit(&measure.label, measure.unit);
        Column::new(&name, members.iter().map(cell))
    };
    let row = |member: &Member| (member.name.clone(), "");
    Table {
        head: "file".to_owned(),
        rows: members.iter().map(row).collect(),
        columns: measures.iter().enumerate().map(column).collect(),
    }
}

fn with_unit(label: &str, unit: &str) -> String {
    match unit {
        "" => label.to_owned(),
        unit => format!("{label}, {unit}"),
    }
}

fn character_count(text: &str) -> usize {
    text.chars().count()
}

/// Returns a table as aligned text, in several parts if it is wide.
pub fn text(table: &Table) -> String {
    let labels: Vec<String> = (table.rows.iter())
        .map(|(label, unit)| with_unit(label, unit))
        .collect();
    let lengths = (labels.iter().chain([&table.head])).map(|text| character_count(text));
    let label_width = lengths.max().unwrap_or(0);

    let mut parts: Vec<String> = Vec::new();
    let mut rest = &table.columns[..];
    while !rest.is_empty() {
        // Each part repeats the labels, whose width is not left for columns.
        let columns_width = MAX_WIDTH.saturating_sub(label_width);
        let (part, behind) = rest.split_at(end_of_part(rest, columns_width));
        let mut out = String::new();
        let mut line = |label: &str, cell: &dyn Fn(&Column) -> String| {
            let _ = write!(out, "{label:label_width$}");
            for column in part {
                let _ = write!(out, "{:>1$}", cell(column), width(column));
            }
            out.push('\n');
        };

        line(&table.head, &|column| column.name.clone());
        for (row, label) in labels.iter().enumerate() {
            // The first part has every row, so that none is lost. A later one leaves out rows whose cells are all
            // empty, as the text of a set may be: it stands only in the first column of a subject.
            if parts.is_empty() || part.iter().any(|column| !column.cells[row].is_empty()) {
                line(label, &|column| column.cells[row].clone());
            }
        }

        parts.push(out);
        rest = behind;
    }
    parts.join("\n")
}

/// Returns the width of a column in characters, with the gap before it.
fn width(column: &Column) -> usize {
    let cells = column.cells.iter().map(|cell| character_count(cell));
    GAP + cells.max().unwrap_or(0).max(character_count(&column.name))
}

/// Returns the number of columns of the next part: those of as many subjects as fit into `most` characters, and of at
/// least one.
fn end_of_part(columns: &[Column], most: usize) -> usize {
    // A part may end before a column that begins a subject, and behind the last column.
    let is_end = |end: &usize| columns.get(*end).is_none_or(|next| !next.joined);
    let fits = |end: &usize| columns[..*end].iter().map(width).sum::<usize>() <= most;
    let mut ends = (1..=columns.len()).filter(is_end).peekable();

    // A subject that is wider than a part has one to itself: without a column the parts would never end.
    let least = ends.peek().copied().unwrap_or(columns.len());
    ends.take_while(fits).last().unwrap_or(least)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(name: &str, cells: &[&str], joined: bool) -> Column {
        Column {
            joined,
            ..Column::new(name, cells.iter().map(|&cell| cell.to_owned()))
        }
    }

    #[test]
    fn columns_of_one_subject_stay_together() {
        let parts = |joined: &[usize]| -> Vec<usize> {
            let names = ["a", "b", "error", "c", "error"].map(|name| format!("{name:30}"));
            let columns = names.iter().enumerate();
            let columns = columns.map(|(k, name)| column(name, &["1"], joined.contains(&k)));
            let table = Table {
                head: "measure".to_owned(),
                rows: vec![("samples".to_owned(), "")],
                columns: columns.collect(),
            };
            let found = text(&table);
            let heads = found.split("\n\n").map(|part| part.lines().next().unwrap());
            heads
                .map(|head| head.split_whitespace().count() - 1)
                .collect()
        };
        assert_eq!(parts(&[2, 4]), [3, 2]);
        assert_eq!(parts(&[3, 4]), [2, 3]);
        assert_eq!(parts(&[1, 2, 3, 4]), [5]);
    }

    #[test]
    fn a_later_part_has_no_rows_without_a_word() {
        let names = ["a", "b"].map(|name| name.repeat(MAX_WIDTH / 2));
        let table = Table {
            head: "measure".to_owned(),
            rows: ["domain", "samples"]
                .map(|label| (label.to_owned(), ""))
                .to_vec(),
            columns: vec![
                column(&names[0], &["1 x 1", "9"], false),
                column(&names[1], &["", "8"], false),
            ],
        };
        let found = text(&table);
        let parts: Vec<&str> = found.split("\n\n").collect();
        assert_eq!(parts.len(), 2);
        assert!(parts[0].contains("domain") && !parts[1].contains("domain"));
        assert!(parts.iter().all(|part| part.contains("samples")));
    }
}
