//! Tables by columns: each column has a key, a heading, and the function that gives its cell of a row.

use crate::outcome::{Cell, Column, Table};

/// A table whose columns are added one by one.
pub struct TypedTable<R> {
    rows: Vec<R>,
    table: Table,
}

/// Returns a table of rows, without columns yet.
pub fn table<R>(name: &str, title: &str, rows: impl IntoIterator<Item = R>) -> TypedTable<R> {
    let rows: Vec<R> = rows.into_iter().collect();
    let table = Table {
        name: name.to_owned(),
        title: title.to_owned(),
        columns: Vec::new(),
        rows: vec![Vec::new(); rows.len()],
        shown: true,
    };
    TypedTable { rows, table }
}

impl<R> TypedTable<R> {
    /// Adds a column with its key in data files, its heading in reports, and the significant digits of numbers there.
    pub fn column<C: Into<Cell>>(
        mut self,
        key: &str,
        head: &str,
        digits: usize,
        cell: impl Fn(&R) -> C,
    ) -> Self {
        self.table.columns.push(Column::new(key, head, digits));
        for (cells, row) in self.table.rows.iter_mut().zip(&self.rows) {
            cells.push(cell(row).into());
        }
        self
    }

    /// Returns the table for reports and data files.
    pub fn shown(self) -> Table {
        self.table
    }

    /// Returns the table for data files alone.
    pub fn hidden(self) -> Table {
        Table {
            shown: false,
            ..self.table
        }
    }
}
