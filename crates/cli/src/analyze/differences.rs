//! How sets differ from the one they are held against: value less reference, number by number.

use serde_json::{Map, Value, json};

use super::measured::Measured;
use super::scalars::{Scalar, scalars};
use super::table::{Row, Table};

/// Returns each number with its difference; none where either is not defined.
fn differences(reference: &Measured, set: &Measured) -> Vec<(Scalar, Option<f64>)> {
    let each = scalars(set).into_iter().zip(scalars(reference));
    each.map(|(scalar, base)| {
        let difference = scalar
            .value
            .zip(base.value)
            .map(|(value, base)| value - base);
        (scalar, difference)
    })
    .collect()
}

/// Returns the table of differences.
pub fn table(reference: &Measured, sets: &[Measured]) -> Table {
    let columns: Vec<_> = sets.iter().map(|set| differences(reference, set)).collect();
    let Some(first) = columns.first() else {
        return Table::default();
    };
    let rows = (first.iter().enumerate())
        .map(|(index, (scalar, _))| {
            let difference = |column: &Vec<(Scalar, Option<f64>)>| signed(&column[index]);
            Row {
                label: scalar.label.to_owned(),
                unit: scalar.unit,
                cells: columns.iter().map(difference).collect(),
            }
        })
        .collect();
    Table {
        head: format!("less {}", reference.name),
        names: sets.iter().map(|set| set.name.clone()).collect(),
        rows,
    }
}

fn signed((scalar, difference): &(Scalar, Option<f64>)) -> String {
    difference.map_or_else(|| "-".to_owned(), |d| format!("{d:+.*}", scalar.decimals))
}

/// Returns the differences by the numbers' names.
pub fn json(reference: &Measured, set: &Measured) -> Value {
    let each = differences(reference, set).into_iter();
    let map: Map<String, Value> = each
        .map(|(scalar, difference)| (scalar.key.to_owned(), json!(difference)))
        .collect();
    Value::Object(map)
}
