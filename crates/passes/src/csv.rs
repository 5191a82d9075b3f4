//! Rows of a buffer's table as comma-separated values, each as it was before the pass and after it.

use std::fmt::Write as _;

use tilescope_gpu::layout::Name;

use super::table::BufferTable;

/// Returns the rows of these indices as CSV: a header, then for each row its index, whether it changed (0 or 1), all
/// columns before the pass and all after it. Lines end with a line feed. Nothing is quoted, as names of columns have no
/// commas.
#[must_use]
pub fn csv(table: &BufferTable, rows: &[u32]) -> String {
    let mut text = String::from("row,changed");
    // Writing to a string never fails, so the results are ignored.
    for side in ["before", "after"] {
        for column in &table.columns {
            let _ = write!(text, ",{column} {side}");
        }
    }
    text.push('\n');

    for &row in rows {
        let row = row as usize;
        let _ = write!(text, "{row},{}", u8::from(table.is_changed(row)));
        for value in table.before(row).iter().chain(table.after(row)) {
            let _ = write!(text, ",{value}");
        }
        text.push('\n');
    }
    text
}

/// Returns the file name for a buffer of a pass; passes count from 1, as in the window.
#[must_use]
pub fn file_name(pass: usize, shader: &str, buffer: Name) -> String {
    format!("pass-{:03}-{shader}-{}.csv", pass + 1, buffer.as_str())
}
