//! Text tables: a point a line, as programs and people write them.
//!
//! Fields are separated by commas, semicolons, tabs or blanks, and may stand in quotation marks. A header names the
//! columns; without one x and y come first. Decimal commas are never read: a row that could be read in two ways is refused.

use super::Raw;
use super::kept::ColumnUse;
use super::xyz::planar;
use crate::column_names as names;
use crate::error::{FilePlace, FormatError, quote};
use crate::fields::{QuotedRow, Separator, looks_numeric};
use crate::format::{Format, Precision};
use crate::text::{is_remark, number, push, split_line, without_bom, words};

/// Reads a whole table. `columns` are those that the caller chose; with `any_z`, a column z is not read.
pub(super) fn read(
    bytes: &[u8],
    format: Format,
    columns: Option<[&str; 2]>,
    any_z: bool,
) -> Result<Raw, FormatError> {
    let (mut table, mut points) = (TextTable::new(format, columns), Vec::new());
    table.any_z = any_z;
    table.take(bytes, &mut points)?;
    table.finish(points.len() as u64)?;
    Ok(Raw::new(points, Precision::Double))
}

/// Returns the table with only those of its rows for which `kept`, in their order, is true. All other lines stay, and
/// so does each row to the byte; a number of points that a line states is that of the new table.
pub(super) fn keep(
    bytes: &[u8],
    format: Format,
    columns: Option<[&str; 2]>,
    kept: &[bool],
) -> Result<Vec<u8>, FormatError> {
    let mut table = TextTable::new(format, columns);
    let mut rest = without_bom(bytes);
    let mut out = bytes[..bytes.len() - rest.len()].to_vec();

    // The lines before the first row are read as when points are read, and copied.
    while !rest.is_empty() {
        let was_stated = table.stated.is_some();
        let after = table.take_head(rest)?;
        if table.rows.is_some() {
            break;
        }

        // The line that states the number of points now states that of the kept ones.
        let line = &rest[..rest.len() - after.len()];
        if table.stated.is_some() && !was_stated {
            let (text, _) = split_line(line);
            let count = kept.iter().filter(|kept| **kept).count();
            push(&mut out, format_args!("{count}"));
            out.extend_from_slice(&line[text.len()..]);
        } else {
            out.extend_from_slice(line);
        }
        rest = after;
    }

    // The lines that are rows when points are read are rows here, too, and `kept` has an entry for each of them; remarks
    // and blank lines stay.
    let mut kept = kept.iter();
    while !rest.is_empty() {
        let (row, after) = split_line(rest);
        if !is_row(row) || kept.next().is_none_or(|kept| *kept) {
            out.extend_from_slice(&rest[..rest.len() - after.len()]);
        }
        rest = after;
    }
    Ok(out)
}

/// Returns the numbers in a column, chosen by its name, or by its number from 1.
pub(super) fn column(
    bytes: &[u8],
    format: Format,
    columns: Option<[&str; 2]>,
    wanted: &str,
    of_use: ColumnUse,
) -> Result<Vec<f64>, FormatError> {
    let pick = |rows: &TableRows| names::one(wanted, &rows.names, rows.count);
    column_by(bytes, format, columns, of_use, pick)
}

/// Refuses a table whose head shows that it has no points in space, and says which columns are needed. Of a set (`is_set`)
/// rows without names have three numbers; between commas, where a number more may be the end of one with a decimal comma,
/// those of other clouds have, too.
pub(super) fn check_in_space(
    bytes: &[u8],
    format: Format,
    is_set: bool,
) -> Result<(), FormatError> {
    let mut table = TextTable::new(format, None);
    table.any_z = true;
    // The columns of the first row are counted, whatever they are.
    table.chosen = Some(["1", "2"].map(str::to_owned));
    let mut rest = without_bom(bytes);
    while table.rows.is_none() && !rest.is_empty() {
        rest = match table.take_head(rest) {
            Ok(rest) => rest,
            // A single column cannot be chosen twice. Faults of other heads are reported when they are read.
            Err(FormatError::Header { .. }) if table.header.names.is_empty() => {
                return Err(unlike_space(format, table.line + 1, 1));
            }
            Err(_) => return Ok(()),
        };
    }
    // A table without rows is refused where it is read.
    let Some(rows) = &table.rows else {
        return Ok(());
    };

    if rows.names.is_empty() {
        let most = if is_set || rows.separator == Separator::Comma {
            3
        } else {
            usize::MAX
        };
        let fits = (3..=most).contains(&rows.count);
        return if fits {
            Ok(())
        } else {
            Err(unlike_space(format, table.line + 1, rows.count))
        };
    }
    let line = [table.header.line, table.remark.line].into_iter().max();
    let fault = |reason| FormatError::Header {
        format,
        place: FilePlace::Line(line.unwrap_or_default()),
        reason,
    };
    names::check_in_space(&rows.names).map_err(fault)
}

/// Why rows without names are no points in space.
fn unlike_space(format: Format, line: u64, count: usize) -> FormatError {
    let columns = if count == 1 { "column" } else { "columns" };
    let help = if count > 3 {
        "; leave the others out, or name x, y and z in a first line"
    } else {
        ""
    };
    FormatError::Row {
        format,
        place: FilePlace::Line(line),
        reason: format!(
            "{count} {columns} and no header, and a set in space has three: x, y and z{help}"
        ),
    }
}

/// Returns the third coordinates of a table of points in space: those of the column z, without names of the third column.
pub(super) fn heights(bytes: &[u8], format: Format) -> Result<Vec<f64>, FormatError> {
    let pick = |rows: &TableRows| {
        let none = || "no column is named z, and a set in space has x, y and z".to_owned();
        rows.z.ok_or_else(none)
    };
    column_by(bytes, format, None, ColumnUse::Order, pick)
}

/// Returns the numbers of one column. `pick` finds the column once the head of the table is read.
fn column_by(
    bytes: &[u8],
    format: Format,
    columns: Option<[&str; 2]>,
    of_use: ColumnUse,
    pick: impl Fn(&TableRows) -> Result<usize, String>,
) -> Result<Vec<f64>, FormatError> {
    let mut table = TextTable::new(format, columns);
    let mut rest = without_bom(bytes);
    while table.rows.is_none() && !rest.is_empty() {
        rest = table.take_head(rest)?;
    }

    let mut values = Vec::new();
    // A table without rows has no numbers.
    let Some(rows) = &mut table.rows else {
        return Ok(values);
    };
    // The line that names the columns is at fault: the header, or else a remark, or else the first row. Lines count from 1, with
    // the header.
    let named_in = [table.header.line, table.remark.line];
    let line = named_in.into_iter().find(|line| *line > 0);
    let place = FilePlace::Line(line.unwrap_or(table.line + 1));
    let column = pick(rows).map_err(|reason| FormatError::Header {
        format,
        place,
        reason,
    })?;

    while !rest.is_empty() {
        let row;
        (row, rest) = split_line(rest);
        table.line += 1;
        if is_row(row) {
            values.push(rows.value(row, column, of_use, FilePlace::Line(table.line))?);
        }
    }
    Ok(values)
}

/// A table that is read line by line.
#[derive(Clone, Debug)]
pub(crate) struct TextTable {
    format: Format,
    chosen: Option<[String; 2]>,
    /// Lines read so far.
    line: u64,
    /// The separator, if a line states it or there is a header.
    separator: Option<Separator>,
    header: Header,
    /// The last remark that names coordinates.
    remark: Header,
    /// The number of points, if a line states it.
    stated: Option<u64>,
    /// Whether z may be anything.
    any_z: bool,
    rows: Option<TableRows>,
}

/// The names of columns and their line; without names there is no header.
#[derive(Clone, Debug, Default)]
struct Header {
    names: Vec<String>,
    line: u64,
}

/// How the rows of a table are read; known from the first one on.
#[derive(Clone, Debug)]
struct TableRows {
    format: Format,
    separator: Separator,
    /// The names of the columns, if they have names.
    names: Vec<String>,
    /// Which columns are x and y.
    places: [usize; 2],
    /// Which column is z and must be 0.
    z: Option<usize>,
    /// The most fields that a row may have, but for empty ones at its end.
    count: usize,
    /// Whether each row must have as many fields; otherwise fields may lack at its end.
    exact: bool,
    quoted: QuotedRow,
}

impl TextTable {
    pub fn new(format: Format, columns: Option<[&str; 2]>) -> Self {
        Self {
            format,
            chosen: columns.map(|columns| columns.map(str::to_owned)),
            line: 0,
            separator: None,
            header: Header::default(),
            remark: Header::default(),
            stated: None,
            any_z: false,
            rows: None,
        }
    }

    /// Reads the next lines, which are whole; only the last line of the file may lack its end.
    pub fn take(&mut self, bytes: &[u8], points: &mut Vec<[f64; 2]>) -> Result<(), FormatError> {
        let mut rest = if self.line == 0 {
            without_bom(bytes)
        } else {
            bytes
        };
        while self.rows.is_none() && !rest.is_empty() {
            rest = self.take_head(rest)?;
        }

        let Some(rows) = &mut self.rows else {
            return Ok(());
        };
        // Most tables have no quotation marks. One search through all rows spares a search in each.
        let quotes = rest.contains(&b'"');
        while !rest.is_empty() {
            let row;
            (row, rest) = split_line(rest);
            self.line += 1;
            if is_row(row) {
                let is_quoted = quotes && row.contains(&b'"');
                points.push(rows.point(row, is_quoted, FilePlace::Line(self.line))?);
            }
        }
        Ok(())
    }

    /// Refuses a table that ended after `found` points if it states another number, or has only a header that cannot be used.
    pub fn finish(&self, found: u64) -> Result<(), FormatError> {
        if let Some(stated) = self.stated.filter(|&stated| stated != found) {
            return Err(FormatError::Count {
                format: self.format,
                stated,
                found,
            });
        }

        // With rows, a header of no use was refused at the first of them. Chosen columns need no names of x and y, and are
        // looked for at the first row alone.
        let Header { names, line } = &self.header;
        if self.rows.is_none() && self.chosen.is_none() && !names.is_empty() {
            let named = names::named(names);
            named.map_err(|reason| self.header_fault(FilePlace::Line(*line), reason))?;
        }
        Ok(())
    }

    /// Reads a line before the first row and returns what follows it. At the first row it decides how rows are read, and
    /// returns all.
    fn take_head<'a>(&mut self, text: &'a [u8]) -> Result<&'a [u8], FormatError> {
        let (line, rest) = split_line(text);
        let place = FilePlace::Line(self.line + 1);
        self.refuse_unmarked_utf_16(line, place)?;

        if is_remark(line) {
            if let Some(names) = names::in_remark(line) {
                self.remark = Header {
                    names,
                    line: self.line + 1,
                };
            }
        // Only the first line can state the separator: in a later line the same text would be a row.
        } else if self.line == 0
            && let Some(stated) = Separator::stated(line)
        {
            self.separator = Some(stated.map_err(|found| self.header_fault(
                place,
                format!(
                    "sep={} is not a separator that is read: those are a comma, a semicolon, a tab and a blank",
                    quote(found)
                ),
            ))?);
        } else if is_row(line) {
            let separator = self.separator.unwrap_or_else(|| Separator::of(line));
            let fields = self.fields(line, separator, place)?;
            // A line that can be a header is the header, if there was none yet. A whole number alone, before any
            // header, is the count of points. Everything else is a row.
            if self.header.names.is_empty() && is_header(&fields) {
                self.header = Header {
                    names: fields.iter().map(|field| names::name(field)).collect(),
                    line: self.line + 1,
                };
                self.separator = Some(separator);
            } else if let Some(count) = self.count_line(&fields) {
                self.stated = Some(count);
            } else {
                self.rows = Some(self.rows_like(&fields, separator, place)?);
                // The text from this row on is returned, so that the row is read like those that follow it.
                return Ok(text);
            }
        }
        self.line += 1;
        Ok(rest)
    }

    /// Every second byte of Latin text in UTF-16 is 0.
    fn refuse_unmarked_utf_16(&self, line: &[u8], place: FilePlace) -> Result<(), FormatError> {
        let is_zero = |at: usize| line.get(at) == Some(&0);
        if (is_zero(0) && is_zero(2)) || (is_zero(1) && is_zero(3)) {
            let reason = "this is UTF-16 without a byte-order mark; save it as UTF-8".to_owned();
            return Err(self.header_fault(place, reason));
        }
        Ok(())
    }

    fn header_fault(&self, place: FilePlace, reason: String) -> FormatError {
        FormatError::Header {
            format: self.format,
            place,
            reason,
        }
    }

    /// The fields of a line, without those that are empty at its end.
    fn fields(
        &self,
        line: &[u8],
        separator: Separator,
        place: FilePlace,
    ) -> Result<Vec<Vec<u8>>, FormatError> {
        let mut quoted = QuotedRow::new(separator);
        if !quoted.take(line) {
            return Err(open_quote(self.format, place));
        }

        // The same fields that `TableRows::point` reads of a row.
        let mut fields: Vec<Vec<u8>> = match separator {
            Separator::Blank if !line.contains(&b'"') => words(line).map(<[u8]>::to_vec).collect(),
            _ => quoted.fields().map(<[u8]>::to_vec).collect(),
        };
        // Some programs end each row with a separator.
        while fields
            .last()
            .is_some_and(|last| last.trim_ascii().is_empty())
        {
            fields.pop();
        }
        Ok(fields)
    }

    /// The number of points, if a line holds nothing else, as in `.pts` files. `None` for other lines, for a line after
    /// the header, and once a line has stated the number.
    fn count_line(&self, fields: &[Vec<u8>]) -> Option<u64> {
        let [field] = fields else { return None };
        let is_first = self.header.names.is_empty() && self.stated.is_none();
        let text = std::str::from_utf8(field).ok().filter(|_| is_first)?;
        text.trim().parse().ok()
    }

    /// How the rows of a table are read whose first row has these fields.
    fn rows_like(
        &self,
        fields: &[Vec<u8>],
        separator: Separator,
        place: FilePlace,
    ) -> Result<TableRows, FormatError> {
        let format = self.format;
        let found = fields.len();
        // Names in a remark count if there is no header and a name for each field; otherwise the remark is about something else.
        let is_of_remark = self.header.names.is_empty() && self.remark.names.len() == found;
        let Header { names, line } = if is_of_remark {
            &self.remark
        } else {
            &self.header
        };

        // Without a header, whose line is then 0, a choice of columns that do not exist is reported for the first line.
        let fault = |reason| self.header_fault(FilePlace::Line((*line).max(1)), reason);
        let mut rows = TableRows {
            format,
            separator,
            names: names.clone(),
            places: [0, 1],
            z: None,
            count: found.max(names.len()),
            // Between blanks a missing field is not seen, so that its neighbour would take its place. Without names the
            // first row says how many fields each row has.
            exact: separator == Separator::Blank || names.is_empty(),
            quoted: QuotedRow::new(separator),
        };

        if let Some(choice) = &self.chosen {
            // A choice of two columns is a choice of a plane, so that z may be anything.
            rows.places = names::chosen(choice, names, rows.count).map_err(fault)?;
        } else if !names.is_empty() {
            // A row of more fields than there are names is refused: it is not known which field a name is of.
            let named = names::named(names).map_err(fault)?;
            (rows.places, rows.z, rows.count) = (named.places, named.z, names.len());
        // With decimal commas, four numbers between commas are a point: 12,5,7,3 is (12, 5) or (12.5, 7.3).
        } else if separator == Separator::Comma && found > 3 {
            let reason = two_readings(fields);
            return Err(FormatError::Row {
                format,
                place,
                reason,
            });
        } else if found < 2 {
            return Err(rows.miscounted(found, 2, place));
        // A third column without a name is z, and must be 0.
        } else {
            rows.z = (found > 2).then_some(2);
        }
        rows.z = rows.z.filter(|_| !self.any_z);
        Ok(rows)
    }
}

impl TableRows {
    /// Returns the point of a row. `is_quoted` says that it has a quotation mark. A row whose mark is still open at the
    /// end of the line is refused, as it would go on in the next one.
    fn point(
        &mut self,
        row: &[u8],
        is_quoted: bool,
        place: FilePlace,
    ) -> Result<[f64; 2], FormatError> {
        if is_quoted {
            if !self.quoted.take(row) {
                return Err(open_quote(self.format, place));
            }
            return self.point_of(self.quoted.fields(), place);
        }

        // A row without quotation marks needs no parser: splitting it gives the same fields.
        match self.separator {
            Separator::Blank => self.point_of(words(row), place),
            separator => {
                let by = separator.byte();
                self.point_of(row.split(|&b| b == by), place)
            }
        }
    }

    /// Returns the number in one column of a row.
    fn value(
        &mut self,
        row: &[u8],
        column: usize,
        of_use: ColumnUse,
        place: FilePlace,
    ) -> Result<f64, FormatError> {
        let format = self.format;
        let by = self.separator.byte();
        // The row is divided into fields as when its coordinates are read.
        let field = if row.contains(&b'"') {
            if !self.quoted.take(row) {
                return Err(open_quote(format, place));
            }
            self.quoted.fields().nth(column)
        } else if self.separator == Separator::Blank {
            words(row).nth(column)
        } else {
            row.split(|&b| b == by).nth(column)
        };

        // `parse` also accepts NaN and infinities, which are no coordinates and have no place in an order.
        let field = field.unwrap_or_default().trim_ascii();
        let value = std::str::from_utf8(field)
            .ok()
            .and_then(|text| text.parse().ok());
        value.filter(|&value| of_use.accepts(value)).ok_or_else(|| {
            let reason = format!(
                "\"{}\" in column {} is not {}",
                quote(field),
                self.names.get(column).unwrap_or(&(column + 1).to_string()),
                of_use.wanted()
            );
            FormatError::Row {
                format,
                place,
                reason,
            }
        })
    }

    /// Returns the point of a row with these fields.
    fn point_of<'a>(
        &self,
        fields: impl Iterator<Item = &'a [u8]>,
        place: FilePlace,
    ) -> Result<[f64; 2], FormatError> {
        let [at_x, at_y] = self.places;
        let (mut x, mut y, mut z) = (None, None, None);
        // How many fields there are up to the last that is not empty: some programs end each row with a separator.
        let mut filled = 0;
        for (column, field) in fields.enumerate() {
            let field = field.trim_ascii();
            if column == at_x {
                x = Some(field);
            } else if column == at_y {
                y = Some(field);
            } else if Some(column) == self.z {
                z = Some(field);
            }

            if !field.is_empty() {
                filled = column + 1;
            }
        }

        if filled > self.count || (self.exact && filled < self.count) {
            return Err(self.miscounted(filled, self.count, place));
        }

        let (Some(x), Some(y)) = (x, y) else {
            return Err(self.miscounted(filled, at_x.max(at_y) + 1, place));
        };
        if let Some(column) = self.z {
            let z = z.ok_or_else(|| self.miscounted(filled, column + 1, place))?;
            planar(number(z, self.format, place)?, self.format, place)?;
        }
        let value = |field| number(field, self.format, place);
        Ok([value(x)?, value(y)?])
    }

    /// Refuses a row of too few or too many fields.
    fn miscounted(&self, found: usize, expected: usize, place: FilePlace) -> FormatError {
        let format = self.format;
        // Numbers with decimal commas are the likely reason for too many fields between commas.
        if self.separator == Separator::Comma && found > expected {
            let counts = format!("{found} columns where {expected} are needed");
            return FormatError::Row {
                format,
                place,
                reason: format!("{counts}; numbers must have decimal points, as 0.5 has"),
            };
        }

        FormatError::Columns {
            format,
            place,
            found,
            expected,
        }
    }
}

/// Whether a line is neither blank nor a remark.
fn is_row(line: &[u8]) -> bool {
    match line.iter().find(|b| !b.is_ascii_whitespace()) {
        None => false,
        Some(b'#' | b'%' | b'/') => !is_remark(line),
        Some(_) => true,
    }
}

/// A line is a header if none of its fields is a number, or if it names x and y beside numbers.
fn is_header(fields: &[Vec<u8>]) -> bool {
    let is_number = |field: &Vec<u8>| looks_numeric(field);
    let names: Vec<String> = fields.iter().map(|field| names::name(field)).collect();
    !fields.iter().any(is_number) || names::is_header(&names)
}

fn open_quote(format: Format, place: FilePlace) -> FormatError {
    FormatError::Row {
        format,
        place,
        reason: "a quotation mark is open at the end of the line; each row must end in its line"
            .to_owned(),
    }
}

/// Why a row of more than three numbers between commas is refused without a header, with what it may be.
fn two_readings(fields: &[Vec<u8>]) -> String {
    let count = fields.len();
    let first: Vec<String> = fields.iter().take(4).map(|field| quote(field)).collect();
    let [a, b, c, d] = &first[..] else {
        return format!("{count} columns and no header");
    };
    format!(
        "{count} columns and no header: the point may be ({a}, {b}), or ({a}.{b}, {c}.{d}) with decimal commas; write \
         decimal points, and a first line that names the columns x and y"
    )
}

#[cfg(test)]
mod tests;
