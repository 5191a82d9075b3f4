//! Tables of measures: a row a measure, a column a set.

use std::fmt::Write;

use super::measured::Member;
use super::scalars::Scalar;
use super::subject::{Number, Subject};
use crate::output::region_text;

/// Columns wider than this many letters together are split into several tables.
const WIDE: usize = 110;

/// A row of a table.
pub struct Row {
    pub label: String,
    pub unit: &'static str,
    pub cells: Vec<String>,
}

/// A table with the sets' names on top.
#[derive(Default)]
pub struct Table {
    /// Above the labels.
    pub head: String,
    pub names: Vec<String>,
    pub rows: Vec<Row>,
    /// Columns that are never parted from the one before them.
    pub joined: Vec<usize>,
}

/// Which of a number's values stands in a column.
type Value = fn(&Number) -> Option<f64>;

/// A column: its heading, whose it is, and which of a number's values stands in it.
struct Column<'a> {
    name: String,
    subject: &'a Subject,
    value: Value,
    /// Words stand in the first column of a subject alone.
    first: bool,
}

impl<'a> Column<'a> {
    fn all(subject: &'a Subject, reference: bool) -> Vec<Self> {
        let after = if reference { " (reference)" } else { "" };
        let column = |name: String, value, first| Self {
            name,
            subject,
            value,
            first,
        };
        let name = format!("{}{after}", subject.label);
        let mut columns = vec![column(name, |number| number.scalar.value, true)];
        if subject.members.len() > 1 {
            let spread: [(&str, Value); 3] = [
                ("standard error", |number| {
                    number.spread.map(|spread| spread.standard_error)
                }),
                ("least", |number| number.spread.map(|spread| spread.least)),
                ("most", |number| number.spread.map(|spread| spread.most)),
            ];
            for (name, value) in spread {
                columns.push(column(name.to_owned(), value, false));
            }
        }
        columns
    }

    fn words(&self, word: &dyn Fn(&Subject) -> String) -> String {
        if self.first {
            word(self.subject)
        } else {
            String::new()
        }
    }

    /// Errors have a digit more than what they are errors of, and so have means of whole numbers.
    fn cell(&self, key: &str) -> String {
        let mut numbers = self.subject.numbers.iter();
        let Some(number) = numbers.find(|number| number.scalar.key == key) else {
            return "-".to_owned();
        };
        let several = self.subject.members.len() > 1;
        let more = several && (!self.first || number.scalar.decimals == 0);
        let decimals = number.scalar.decimals + usize::from(more);
        let text = |value| format!("{value:.decimals$}");
        (self.value)(number).map_or_else(|| "-".to_owned(), text)
    }
}

/// Returns the measures of all subjects; the first may be what others are held against.
pub fn measures(subjects: &[Subject], against: bool) -> Table {
    let columns: Vec<Column<'_>> = (subjects.iter().enumerate())
        .flat_map(|(index, subject)| Column::all(subject, against && index == 0))
        .collect();
    let words = |label: &str, word: &dyn Fn(&Subject) -> String| Row {
        label: label.to_owned(),
        unit: "",
        cells: columns.iter().map(|column| column.words(word)).collect(),
    };
    let domain = words("domain", &|subject| region_text(&subject.region));
    let format = words("format", &|subject| format(&subject.members));
    let origin = words("radius is", &|subject| origin(&subject.members));
    let numbers = keys(subjects).into_iter().map(|scalar| Row {
        label: scalar.label.to_owned(),
        unit: scalar.unit,
        cells: (columns.iter())
            .map(|column| column.cell(scalar.key))
            .collect(),
    });
    Table {
        head: "measure".to_owned(),
        names: columns.iter().map(|column| column.name.clone()).collect(),
        rows: [format, domain, origin]
            .into_iter()
            .chain(numbers)
            .collect(),
        joined: (0..columns.len())
            .filter(|&column| !columns[column].first)
            .collect(),
    }
}

/// Returns the numbers that subjects have: averages have more than sets.
fn keys(subjects: &[Subject]) -> Vec<&Scalar> {
    let most = subjects.iter().max_by_key(|subject| subject.numbers.len());
    most.map_or(Vec::new(), |subject| {
        let numbers = subject.numbers.iter();
        numbers.map(|number| &number.scalar).collect()
    })
}

fn format(members: &[Member]) -> String {
    let first = members.first().map(|member| member.format);
    match first {
        Some(first) if members.iter().all(|member| member.format == first) => first.to_string(),
        _ => "several".to_owned(),
    }
}

fn origin(members: &[Member]) -> String {
    let known = members.iter().filter(|member| member.certain).count();
    match known {
        0 => "smallest distance".to_owned(),
        all if all == members.len() => "known".to_owned(),
        some => format!("known of {some}"),
    }
}

/// Returns the table of the files behind an average.
pub fn files(members: &[Member]) -> Table {
    let Some(first) = members.first() else {
        return Table::default();
    };
    let cell = |scalar: &Scalar| {
        let text = |value| format!("{value:.*}", scalar.decimals);
        scalar.value.map_or_else(|| "-".to_owned(), text)
    };
    Table {
        head: "file".to_owned(),
        names: (first.scalars.iter())
            .map(|scalar| match scalar.unit {
                "" => scalar.label.to_owned(),
                unit => format!("{}, {unit}", scalar.label),
            })
            .collect(),
        rows: (members.iter())
            .map(|member| Row {
                label: member.name.clone(),
                unit: "",
                cells: member.scalars.iter().map(cell).collect(),
            })
            .collect(),
        joined: Vec::new(),
    }
}

fn letters(text: &str) -> usize {
    text.chars().count()
}

/// Returns the letters of the columns, with room between.
fn widths(table: &Table) -> Vec<usize> {
    let width = |(column, name): (usize, &String)| {
        let cells = table.rows.iter().map(|row| letters(&row.cells[column]));
        cells.max().unwrap_or(0).max(letters(name)) + 3
    };
    table.names.iter().enumerate().map(width).collect()
}

/// Returns a table as aligned text, in as many parts as its width asks for.
pub fn text(table: &Table) -> String {
    let label = |row: &Row| match row.unit {
        "" => row.label.clone(),
        unit => format!("{}, {unit}", row.label),
    };
    let labels: Vec<String> = table.rows.iter().map(label).collect();
    let first = (labels.iter().chain([&table.head])).map(|text| letters(text));
    let first = first.max().unwrap_or(0);
    let widths = widths(table);
    let mut out = String::new();
    let mut from = 0;
    while from < widths.len() {
        let to = end_of_part(table, &widths, first, from);
        if from > 0 {
            out.push('\n');
        }
        let head = (&table.head, &table.names);
        let rows = labels.iter().zip(table.rows.iter().map(|row| &row.cells));
        // Words stand in the first column of a subject: a later part may have none of them.
        let told = |cells: &[String]| cells[from..to].iter().any(|cell| !cell.is_empty());
        let rows = rows.filter(|(_, cells)| from == 0 || told(cells));
        for (label, cells) in std::iter::once(head).chain(rows) {
            let _ = write!(out, "{label:first$}");
            for column in from..to {
                let _ = write!(out, "{:>1$}", cells[column], widths[column]);
            }
            out.push('\n');
        }
        from = to;
    }
    out
}

/// Returns the end of the part that begins with the column `from`: as many subjects as fit, and at least one.
fn end_of_part(table: &Table, widths: &[usize], labels: usize, from: usize) -> usize {
    let ends = (from + 1..=widths.len()).filter(|end| !table.joined.contains(end));
    let fits = |end: &usize| labels + widths[from..*end].iter().sum::<usize>() <= WIDE;
    let mut ends = ends.peekable();
    let least = ends.peek().copied().unwrap_or(widths.len());
    ends.take_while(fits).last().unwrap_or(least)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_of_one_subject_stay_together() {
        let row = Row {
            label: "samples".to_owned(),
            unit: "",
            cells: ["1", "2", "3", "4", "5"].map(str::to_owned).to_vec(),
        };
        let mut table = Table {
            head: "measure".to_owned(),
            names: ["a", "b", "error", "c", "error"]
                .map(|name| format!("{name:30}"))
                .to_vec(),
            rows: vec![row],
            joined: vec![2, 4],
        };
        let parts = |table: &Table| -> Vec<usize> {
            let found = text(table);
            let heads = found.split("\n\n").map(|part| part.lines().next().unwrap());
            heads
                .map(|head| head.split_whitespace().count() - 1)
                .collect()
        };
        assert_eq!(parts(&table), [3, 2]);
        table.joined = vec![3, 4];
        assert_eq!(parts(&table), [2, 3]);
        table.joined = vec![1, 2, 3, 4];
        assert_eq!(parts(&table), [5]);
    }

    #[test]
    fn a_later_part_has_no_rows_without_a_word() {
        let row = |label: &str, cells: [&str; 2]| Row {
            label: label.to_owned(),
            unit: "",
            cells: cells.map(str::to_owned).to_vec(),
        };
        let table = Table {
            head: "measure".to_owned(),
            names: ["a", "b"].map(|name| name.repeat(WIDE / 2)).to_vec(),
            rows: vec![row("domain", ["1 x 1", ""]), row("samples", ["9", "8"])],
            joined: Vec::new(),
        };
        let found = text(&table);
        let parts: Vec<&str> = found.split("\n\n").collect();
        assert_eq!(parts.len(), 2);
        assert!(parts[0].contains("domain") && !parts[1].contains("domain"));
        assert!(parts.iter().all(|part| part.contains("samples")));
    }
}
