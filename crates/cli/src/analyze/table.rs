//! Tables of measures: a row a measure, a column a set.

use std::fmt::Write;

use super::measured::Measured;
use super::scalars::{Scalar, scalars};
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
}

/// Returns the measures of all sets; the first may be what others are held against.
pub fn measures(sets: &[Measured], against: bool) -> Table {
    let scalars: Vec<Vec<Scalar>> = sets.iter().map(scalars).collect();
    let words = |label: &str, word: &dyn Fn(&Measured) -> String| Row {
        label: label.to_owned(),
        unit: "",
        cells: sets.iter().map(word).collect(),
    };
    let domain = words("domain", &|set| region_text(&set.region));
    let origin = words("radius is", &|set| {
        let known = ["smallest distance", "known"];
        known[usize::from(set.certain)].to_owned()
    });
    let numbers = (0..scalars.first().map_or(0, Vec::len)).map(|index| {
        let cell = |column: &Vec<Scalar>| {
            let scalar = &column[index];
            let text = |value| format!("{value:.*}", scalar.decimals);
            scalar.value.map_or_else(|| "-".to_owned(), text)
        };
        let scalar = &scalars[0][index];
        Row {
            label: scalar.label.to_owned(),
            unit: scalar.unit,
            cells: scalars.iter().map(cell).collect(),
        }
    });
    let name = |(index, set): (usize, &Measured)| {
        let reference = if against && index == 0 {
            " (reference)"
        } else {
            ""
        };
        format!("{}{reference}", set.name)
    };
    Table {
        head: "measure".to_owned(),
        names: sets.iter().enumerate().map(name).collect(),
        rows: [domain, origin].into_iter().chain(numbers).collect(),
    }
}

/// Returns a table as aligned text, in as many parts as its width asks for.
pub fn text(table: &Table) -> String {
    let letters = |text: &str| text.chars().count();
    let label = |row: &Row| match row.unit {
        "" => row.label.clone(),
        unit => format!("{}, {unit}", row.label),
    };
    let labels: Vec<String> = table.rows.iter().map(label).collect();
    let first = (labels.iter().chain([&table.head])).map(|text| letters(text));
    let first = first.max().unwrap_or(0);
    let widths: Vec<usize> = (table.names.iter().enumerate())
        .map(|(column, name)| {
            let cells = table.rows.iter().map(|row| letters(&row.cells[column]));
            cells.max().unwrap_or(0).max(letters(name)) + 3
        })
        .collect();
    let mut out = String::new();
    let mut from = 0;
    while from < widths.len() {
        let mut to = from + 1;
        while to < widths.len() && first + widths[from..=to].iter().sum::<usize>() <= WIDE {
            to += 1;
        }
        if from > 0 {
            out.push('\n');
        }
        let head = (&table.head, &table.names);
        let rows = labels.iter().zip(table.rows.iter().map(|row| &row.cells));
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
