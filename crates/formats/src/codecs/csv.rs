//! Comma-separated values with the header `x,y`, as they are written. `table` reads them and their dialects.

use crate::text::{push, push_line};

/// The header of a table that has positions alone.
pub(super) const HEAD: &[u8] = b"x,y\n";

/// Writes the points, and their levels if there are any.
pub(super) fn write(points: &[[f64; 2]], levels: &[u32]) -> Vec<u8> {
    let mut out = HEAD.to_vec();
    if levels.is_empty() {
        push_rows(&mut out, points);
        return out;
    }
    out = b"x,y,level\n".to_vec();
    for (point, level) in points.iter().zip(levels) {
        push_line(&mut out, point, ",");
        out.pop();
        push(&mut out, format_args!(",{level}\n"));
    }
    out
}

pub(super) fn push_rows(out: &mut Vec<u8>, points: &[[f64; 2]]) {
    for point in points {
        push_line(out, point, ",");
    }
}
