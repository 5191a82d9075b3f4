//! Comma-separated values with the header `x,y`, as they are written. `table` reads them and their dialects.

use super::radii::RADIUS;
use super::{Columns, RANK};
use crate::text::{push, push_line};

/// The header of a table that has positions alone.
pub(super) const HEAD: &[u8] = b"x,y\n";

/// Writes the points with their columns.
pub(super) fn write(points: &[[f64; 2]], columns: &Columns) -> Vec<u8> {
    let mut out = HEAD.to_vec();
    if columns.is_empty() {
        push_rows(&mut out, points);
        return out;
    }

    // Further columns are named before the end of the head's line, which is taken off and put behind them. Levels are
    // only written, and so have no name that a reader shares.
    out.pop();
    let names = [
        ("level", columns.levels.len()),
        (RANK, columns.ranks.len()),
        (RADIUS, columns.radii.len()),
    ];
    for (name, _) in names.into_iter().filter(|&(_, count)| count > 0) {
        push(&mut out, format_args!(",{name}"));
    }
    out.push(b'\n');

    for (index, point) in points.iter().enumerate() {
        push_line(&mut out, point, ",");
        // Here, too, the end of the line goes behind the further columns.
        out.pop();
        if let Some(level) = columns.levels.get(index) {
            push(&mut out, format_args!(",{level}"));
        }
        if let Some(rank) = columns.ranks.get(index) {
            push(&mut out, format_args!(",{rank}"));
        }
        if let Some(radius) = columns.radii.get(index) {
            push(&mut out, format_args!(",{radius}"));
        }
        out.push(b'\n');
    }
    out
}

pub(super) fn push_rows(out: &mut Vec<u8>, points: &[[f64; 2]]) {
    for point in points {
        push_line(out, point, ",");
    }
}
