//! Files that consist of a head and a row for each point, read and written some rows at a time.
//!
//! The same layouts, functions and errors as for whole files. Callers pass pieces of the file; only the position in it
//! is kept.

use std::borrow::Cow;

use super::table::TextTable;
use super::{Columns, csv, npy, ply, utk};
use crate::binary::{self, Endian};
use crate::error::FormatError;
use crate::format::{Format, Precision};
use crate::point_set::{PointSet, Provenance};
use crate::text::{as_utf8, whole_lines};

/// The head of a file of `count` points in a format that [streams](Format::streams), empty where it has none.
/// Its length does not depend on the count.
pub(crate) fn head(
    format: Format,
    precision: Precision,
    count: u64,
    provenance: bool,
) -> Result<Vec<u8>, FormatError> {
    Ok(match format {
        Format::Csv => csv::HEAD.to_vec(),
        Format::UtkBinary => utk::head(count, precision)?,
        Format::Npy => npy::head(count, precision),
        Format::PlyBinary => ply::binary_head(count, precision, provenance, &Columns::default()),
        _ => Vec::new(),
    })
}

/// Appends the rows of points given in file coordinates.
pub(crate) fn push_rows(
    out: &mut Vec<u8>,
    points: &[[f64; 2]],
    provenance: Option<&[Provenance]>,
    format: Format,
    precision: Precision,
) {
    match format {
        Format::Csv => csv::push_rows(out, points),
        Format::PlyBinary => {
            ply::push_rows(out, points, provenance, &Columns::default(), precision);
        }
        // The rows of the other formats that stream are pairs of numbers.
        _ => binary::push_pairs(out, points, precision),
    }
}

/// Where the rows are in a file.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    pub rows: Rows,
    pub precision: Precision,
    /// Where the rows begin.
    pub offset: u64,
    /// How many there are, if the file says so.
    pub count: Option<u64>,
    /// Whether something else may follow the rows.
    pub followed: bool,
}

impl Layout {
    /// The layout of a file of `format` that begins with `start`; `None` for a file that has to be read in memory, such
    /// as one whose rows are not contiguous. `columns` are those that the caller chose, which only text tables have.
    pub fn of(
        start: &[u8],
        format: Format,
        columns: Option<[&str; 2]>,
    ) -> Result<Option<Self>, FormatError> {
        // Columns can be chosen in tables only: a file of another format is then decoded as a table in memory, or refused.
        if columns.is_some() && format != Format::Csv {
            return Ok(None);
        }

        let pairs = |precision, endian, offset, count| {
            let kind = RowKind::Pairs(precision, endian);
            Self::new(format, kind, precision, offset, count)
        };

        Ok(match format {
            // UTF-16, of which `as_utf8` makes a copy, is converted as a whole, and then split into lines.
            Format::Csv if matches!(as_utf8(start), Cow::Owned(_)) => None,
            // A table reads its own header, so that its rows begin with the file.
            Format::Csv => {
                let kind = RowKind::Text(Box::new(TextTable::new(format, columns)));
                Some(Self::new(format, kind, Precision::Double, 0, None))
            }
            Format::PsaRps => Some(pairs(Precision::Single, Endian::Little, 0, None)),
            Format::UtkBinary => {
                let head = utk::read_head(start)?;
                let count = Some(u64::from(head.count));
                let layout = pairs(head.precision, Endian::Little, utk::HEADER_BYTES, count);
                // Several sets are read in memory, where one of them is chosen.
                (head.sets == 1).then_some(layout)
            }
            Format::Npy => {
                let (head, offset) = npy::read_head(start)?;
                let layout = pairs(head.precision, head.endian, offset, Some(head.count));
                // All x stand before all y in Fortran order, and a row with z is no pair.
                (!head.fortran && head.columns == 2).then_some(layout)
            }
            Format::PlyBinary => ply::read_head(start)?.map(|head| Self {
                followed: head.followed,
                ..Self::new(
                    format,
                    RowKind::Ply(head.table),
                    head.precision,
                    head.offset,
                    Some(head.count),
                )
            }),
            // Other formats are read in memory.
            _ => None,
        })
    }

    /// Returns the layout of rows that begin at `offset`.
    fn new(
        format: Format,
        kind: RowKind,
        precision: Precision,
        offset: u64,
        count: Option<u64>,
    ) -> Self {
        let rows = Rows {
            format,
            kind,
            next: 0,
        };
        Self {
            rows,
            precision,
            offset,
            count,
            followed: false,
        }
    }
}

/// Reads rows, piece by piece.
#[derive(Clone, Debug)]
pub(crate) struct Rows {
    format: Format,
    kind: RowKind,
    /// Rows read so far, but not of text, which counts its lines.
    next: u64,
}

#[derive(Clone, Debug)]
enum RowKind {
    Pairs(Precision, Endian),
    Ply(ply::BinaryTable),
    Text(Box<TextTable>),
}

impl Rows {
    /// Bytes of a row; none for lines of text.
    pub fn width(&self) -> Option<usize> {
        match &self.kind {
            RowKind::Pairs(precision, _) => Some(2 * precision.bytes()),
            RowKind::Ply(table) => Some(table.width()),
            RowKind::Text(_) => None,
        }
    }

    /// How many of `bytes` are whole rows, or lines with their end.
    pub fn whole(&self, bytes: &[u8]) -> usize {
        match self.width() {
            Some(width) => bytes.len() - bytes.len() % width,
            None => whole_lines(bytes),
        }
    }

    /// Refuses a text that ended after `found` points, as for whole files.
    pub fn finish(&self, found: u64) -> Result<(), FormatError> {
        match &self.kind {
            RowKind::Text(table) => table.finish(found),
            RowKind::Pairs(..) | RowKind::Ply(_) => Ok(()),
        }
    }

    /// How many rows there are among `bytes`, which are whole rows, or lines that [`push_rows`] wrote: each is a point.
    pub fn count(&self, bytes: &[u8]) -> u64 {
        match self.width() {
            Some(width) => (bytes.len() / width) as u64,
            None => bytes.split(|&byte| byte == b'\n').count() as u64 - 1,
        }
    }

    /// The points of the next whole rows, or lines, in file coordinates.
    pub fn read(&mut self, bytes: &[u8]) -> Result<PointSet, FormatError> {
        match &mut self.kind {
            RowKind::Pairs(precision, endian) => {
                let points = binary::pairs(bytes, self.next, *precision, *endian, self.format)?;
                self.next += points.len() as u64;
                Ok(PointSet::from_points(points))
            }
            RowKind::Ply(table) => {
                let mut set = table.new_set();
                table.take(bytes, self.next, &mut set)?;
                self.next += set.len() as u64;
                Ok(set)
            }
            RowKind::Text(table) => {
                let mut points = Vec::new();
                table.take(bytes, &mut points)?;
                Ok(PointSet::from_points(points))
            }
        }
    }
}
