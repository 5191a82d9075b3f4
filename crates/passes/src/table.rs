//! A buffer before and after a pass, as a table of numbers.

use tilescope_gpu::BufferRows;
use tilescope_gpu::layout::{Access, Name};

/// The most numbers that are read back of a buffer each time, rows times columns: 4 MB for one side of a table, at most
/// about 80 MB for the ten buffers of the largest pass.
pub const MAX_NUMBERS: u64 = 500_000;

/// Which side of a pass a table shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PassSide {
    /// The buffer before the pass.
    Before,
    /// The buffer after the pass.
    After,
    /// Both, where they differ.
    #[default]
    Both,
}

impl PassSide {
    /// All sides, in the order of the menu.
    pub const ALL: [Self; 3] = [Self::Before, Self::After, Self::Both];

    /// Returns its name, as the menu shows it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Before => "before",
            Self::After => "after",
            Self::Both => "before \u{2192} after",
        }
    }
}

/// A buffer before and after a pass.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BufferTable {
    /// The name of the buffer.
    pub name: Name,
    /// Whether the pass reads or writes it.
    pub access: Access,
    /// Its length in bytes.
    pub bytes: u64,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// The rows of the buffer; only the first ones may have been read.
    pub total: u64,
    /// The numbers before the pass, row by row.
    before: Vec<i64>,
    /// `None` if equal to `before`.
    after: Option<Vec<i64>>,
    changed: Vec<bool>,
    changed_count: usize,
}

impl BufferTable {
    /// Returns the table of a buffer read before and after a pass. Rows that only one side has are left out: a buffer
    /// that is not allocated yet has none.
    #[must_use]
    pub fn new(
        name: Name,
        access: Access,
        bytes: u64,
        before: &BufferRows,
        after: &BufferRows,
    ) -> Self {
        let rows = before.rows.len().min(after.rows.len());
        let pairs = before.rows.iter().zip(&after.rows);
        let changed: Vec<bool> = pairs.map(|(a, b)| a != b).collect();
        let changed_count = changed.iter().filter(|&&changed| changed).count();

        let flat = |table: &BufferRows| table.rows[..rows].concat();
        Self {
            name,
            access,
            bytes,
            columns: after.columns.clone(),
            total: after.total,
            before: flat(before),
            // Most buffers are only read; equal sides are kept once.
            after: (changed_count > 0).then(|| flat(after)),
            changed,
            changed_count,
        }
    }

    /// Returns how many rows were read.
    #[must_use]
    pub const fn rows(&self) -> usize {
        self.changed.len()
    }

    /// Returns how many of these the pass changed.
    #[must_use]
    pub const fn changed_count(&self) -> usize {
        self.changed_count
    }

    /// Returns whether the pass changed a row.
    #[must_use]
    pub fn is_changed(&self, row: usize) -> bool {
        self.changed.get(row).copied().unwrap_or(false)
    }

    /// Returns a row before the pass; empty if there is no such row.
    #[must_use]
    pub fn before(&self, row: usize) -> &[i64] {
        self.cells(&self.before, row)
    }

    /// Returns a row after the pass; empty if there is no such row.
    #[must_use]
    pub fn after(&self, row: usize) -> &[i64] {
        self.cells(self.after.as_ref().unwrap_or(&self.before), row)
    }

    fn cells<'a>(&self, of: &'a [i64], row: usize) -> &'a [i64] {
        let width = self.columns.len();
        of.get(row * width..(row + 1) * width).unwrap_or_default()
    }

    /// Returns the row that filters test for a side; for both sides, the one after the pass.
    #[must_use]
    pub fn side(&self, side: PassSide, row: usize) -> &[i64] {
        match side {
            PassSide::Before => self.before(row),
            PassSide::After | PassSide::Both => self.after(row),
        }
    }

    /// Returns the text of a cell; empty if there is no such cell.
    #[must_use]
    pub fn cell(&self, side: PassSide, row: usize, column: usize) -> String {
        let value = |of: &[i64]| of.get(column).map_or_else(String::new, i64::to_string);
        let (before, after) = (value(self.before(row)), value(self.after(row)));
        match side {
            PassSide::Before => before,
            PassSide::Both if before != after => format!("{before} \u{2192} {after}"),
            PassSide::After | PassSide::Both => after,
        }
    }

    /// Returns the width of each column in characters, including its name.
    #[must_use]
    pub fn widths(&self, side: PassSide) -> Vec<usize> {
        // Names of columns are ASCII, so that their bytes are their characters.
        let mut widths: Vec<usize> = self.columns.iter().map(String::len).collect();
        let digits = |value: i64| {
            // Zero has no logarithm, but one digit.
            let log = value.unsigned_abs().checked_ilog10().unwrap_or(0);
            log as usize + 1 + usize::from(value < 0)
        };

        for row in 0..self.rows() {
            // Only rows that changed are compared cell by cell.
            let may_differ = self.is_changed(row);
            for (column, width) in widths.iter_mut().enumerate() {
                let (before, after) = (self.before(row)[column], self.after(row)[column]);
                let needed = match side {
                    PassSide::Before => digits(before),
                    // An arrow between two spaces stands between the numbers.
                    PassSide::Both if may_differ && before != after => {
                        digits(before) + digits(after) + 3
                    }
                    PassSide::After | PassSide::Both => digits(after),
                };
                *width = needed.max(*width);
            }
        }

        widths
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(rows: &[[i64; 2]]) -> BufferRows {
        BufferRows {
            columns: vec!["x".to_owned(), "pattern index".to_owned()],
            rows: rows.iter().map(|row| row.to_vec()).collect(),
            total: 9,
        }
    }

    #[test]
    fn changed_rows_are_those_that_differ() {
        let (before, after) = (
            table(&[[1, 2], [3, 4]]),
            table(&[[1, 2], [3, -1_000_000_000_000]]),
        );
        let table = BufferTable::new(Name::Origins, Access::Update, 72, &before, &after);
        assert_eq!(
            (table.rows(), table.total, table.changed_count()),
            (2, 9, 1)
        );
        assert!(!table.is_changed(0) && table.is_changed(1) && !table.is_changed(7));
        assert_eq!(table.cell(PassSide::Before, 1, 1), "4");
        assert_eq!(table.cell(PassSide::After, 1, 1), "-1000000000000");
        assert_eq!(
            table.cell(PassSide::Both, 1, 1),
            "4 \u{2192} -1000000000000"
        );
        assert_eq!(table.cell(PassSide::Both, 1, 0), "3");
        assert_eq!(table.cell(PassSide::Both, 7, 0), "");
        assert_eq!(table.widths(PassSide::Before), [1, 13]);
        assert_eq!(table.widths(PassSide::Both), [1, 18]);
        let same = BufferTable::new(Name::Origins, Access::Read, 72, &before, &before);
        assert_eq!(same.changed_count(), 0);
        assert_eq!(same.after(1), [3, 4]);
    }
}
