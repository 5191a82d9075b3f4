//! The choice of buffer, side and rows in the table of a visited pass. It is kept from pass to pass.

use tilescope_gpu::layout::{Access, Name};

use super::filter::{Filter, FilterError};
use super::model::Visit;
use super::placed::{self, PlacedCounts};
use super::table::{BufferTable, PassSide};

/// A choice of buffer, side and rows, and the rows shown.
#[derive(Clone, Debug, Default)]
pub struct ShownBuffer {
    buffer: usize,
    /// The buffer chosen last, to be shown again in other passes.
    chosen: Option<Name>,
    /// The buffer whose rows are listed now: the chosen one, the first that the pass changed, or the first of all.
    entered: Option<Name>,
    side: PassSide,
    text: String,
    error: Option<FilterError>,
    rows: Vec<u32>,
    widths: Vec<usize>,
    is_filtered: bool,
    counts: PlacedCounts,
    picked: Option<u32>,
    pointed: Option<u32>,
}

impl ShownBuffer {
    /// Returns the index of the buffer among those of the pass.
    #[must_use]
    pub const fn buffer(&self) -> usize {
        self.buffer
    }

    /// Returns the buffer's table.
    #[must_use]
    pub fn table<'a>(&self, visit: Option<&'a Visit>) -> Option<&'a BufferTable> {
        visit?.buffers.get(self.buffer)
    }

    /// Returns the side of the pass that is shown.
    #[must_use]
    pub const fn side(&self) -> PassSide {
        self.side
    }

    /// Returns the filter as it was typed.
    #[must_use]
    pub fn filter(&self) -> &str {
        &self.text
    }

    /// Returns the filter's error, if it has one. All rows are shown then.
    #[must_use]
    pub const fn error(&self) -> Option<&FilterError> {
        self.error.as_ref()
    }

    /// Returns the rows that pass the filter.
    #[must_use]
    pub fn rows(&self) -> &[u32] {
        &self.rows
    }

    /// Returns the width of each column in characters.
    #[must_use]
    pub fn widths(&self) -> &[usize] {
        &self.widths
    }

    /// Returns the selected row.
    #[must_use]
    pub const fn picked(&self) -> Option<u32> {
        self.picked
    }

    /// Returns the row under the pointer.
    #[must_use]
    pub const fn pointed(&self) -> Option<u32> {
        self.pointed
    }

    /// Returns whether a filter is active.
    #[must_use]
    pub const fn is_filtered(&self) -> bool {
        self.is_filtered
    }

    /// Returns how many rows are on the canvas.
    #[must_use]
    pub const fn counts(&self) -> PlacedCounts {
        self.counts
    }

    /// Shows the buffer chosen last; if the pass lacks it, the first that it changed, or else the first of all.
    pub(super) fn enter(&mut self, visit: &Visit) {
        let chosen = |table: &BufferTable| Some(table.name) == self.chosen;
        // The rows of a buffer that the pass only reads can differ by an injected fault, which the pass did not write.
        let changed = |table: &BufferTable| {
            table.changed_count() > 0 && !matches!(table.access, Access::Read | Access::Uniform)
        };

        let index = visit
            .buffers
            .iter()
            .position(chosen)
            .or_else(|| visit.buffers.iter().position(changed))
            .unwrap_or(0);

        let entered = visit.buffers.get(index).map(|table| table.name);
        if entered != self.entered {
            // The selected row belongs to the former buffer.
            self.picked = None;
        }

        self.entered = entered;
        self.buffer = index;
        self.pointed = None;
        self.refresh(Some(visit));
    }

    /// Chooses a buffer of the visited pass by its index and lists its rows.
    pub(super) fn show(&mut self, visit: Option<&Visit>, index: usize) {
        if let Some(table) = visit.and_then(|visit| visit.buffers.get(index)) {
            self.buffer = index;
            (self.picked, self.pointed) = (None, None);
            self.chosen = Some(table.name);
            self.entered = self.chosen;
            self.refresh(visit);
        }
    }

    /// Shows a side of the pass, and lists its rows.
    pub(super) fn set_side(&mut self, visit: Option<&Visit>, side: PassSide) {
        self.side = side;
        self.refresh(visit);
    }

    /// Sets the filter, and lists the rows that satisfy it.
    pub(super) fn set_filter(&mut self, visit: Option<&Visit>, text: String) {
        self.text = text;
        self.refresh(visit);
    }

    /// Selects a row, or none.
    pub(super) const fn pick(&mut self, row: Option<u32>) {
        self.picked = row;
    }

    /// Points at a row, or at none.
    pub(super) const fn point(&mut self, row: Option<u32>) {
        self.pointed = row;
    }

    /// Lists the rows of the buffer that satisfy the filter, with the widths of columns and the counts on the canvas. Without
    /// a visit there are none.
    fn refresh(&mut self, visit: Option<&Visit>) {
        (self.rows, self.widths, self.error) = (Vec::new(), Vec::new(), None);
        (self.counts, self.is_filtered) = (PlacedCounts::default(), false);

        let Some(table) = self.table(visit) else {
            return;
        };

        // A table with a single row is shown field by field and never filtered.
        let text = if table.total > 1 { &self.text } else { "" };
        let filter = match Filter::parse(text, &table.columns) {
            Ok(filter) => filter,
            Err(error) => {
                // With a filter that cannot be read all rows are shown.
                self.error = Some(error);
                Filter::default()
            }
        };

        self.widths = table.widths(self.side);
        let is_accepted = |&row: &u32| {
            let row = row as usize;
            filter.accepts(row, table.side(self.side, row), table.is_changed(row))
        };
        self.rows = (0..table.rows() as u32).filter(is_accepted).collect();
        self.is_filtered = !filter.is_empty();

        if let Some(visit) = visit
            && let Some(placed) = visit.placed.get(self.buffer)
        {
            let (places, domain) = (placed.side(self.side), &visit.domain);
            self.counts = placed::count(places, &self.rows, table, self.is_filtered, domain);
        }
    }
}
