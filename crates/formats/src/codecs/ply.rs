//! PLY vertices: x, y, z = 0 and, optionally, provenance.
//!
//! Writes ASCII and binary little-endian; reads big-endian too, skips other scalar properties and other elements.
//! A vertex with z other than 0 is refused.

use super::kept::ColumnUse;
use super::ply_header::{Element, Encoding, PlyHeader, Scalar, parse};
use super::ply_outline::{OutlinedElement, elements};
use super::radii::RADIUS;
use super::solid_columns::SolidColumns;
use super::xyz::planar;
use super::{Columns, RANK, Raw};
use crate::binary::{self, Cursor, Endian};
use crate::error::{FilePlace, FormatError, quote};
use crate::format::{Format, Precision};
use crate::point_set::{PointSet, Provenance};
use crate::text::{lines, number, push, split_line, words};

/// Names of the provenance properties, of type uint.
const PROVENANCE: [&str; 3] = ["block", "pattern_index", "iteration"];

/// Name of the property of type uint that nested levels have.
const LEVEL: &str = "level";

/// The columns of the vertex table.
#[derive(Clone, Copy, Debug)]
struct PlyColumns {
    position: [usize; 2],
    z: Option<usize>,
    provenance: Option<[usize; 3]>,
}

impl PlyColumns {
    /// Finds the columns of the vertices; `line`, the last one of the header, is named in errors. With `any_z` a z may
    /// be any number and is not read.
    fn find(vertex: &Element, format: Format, line: u64, any_z: bool) -> Result<Self, FormatError> {
        let axis = |name: &str| {
            vertex.column(name).ok_or_else(|| FormatError::Header {
                format,
                place: FilePlace::Line(line),
                reason: format!("vertices have no scalar property {name}"),
            })
        };

        // Only columns of the type that this program writes count: another program's "block" may be anything. Provenance is read
        // if all three are there.
        let own = |name| {
            let column = vertex.column(name)?;
            (vertex.properties[column].scalar == Scalar::U32).then_some(column)
        };
        let [block, index, iteration] = PROVENANCE.map(own);

        Ok(Self {
            position: [axis("x")?, axis("y")?],
            z: vertex.column("z").filter(|_| !any_z),
            provenance: block
                .zip(index)
                .zip(iteration)
                .map(|((block, index), iteration)| [block, index, iteration]),
        })
    }

    /// Adds the point of a row to the set, with its provenance if there are columns for it. `value` returns the number
    /// that stands in a column of the row.
    fn take(
        &self,
        set: &mut PointSet,
        format: Format,
        place: FilePlace,
        value: impl Fn(usize) -> Result<f64, FormatError>,
    ) -> Result<(), FormatError> {
        let point = [value(self.position[0])?, value(self.position[1])?];
        if let Some(z) = self.z {
            planar(value(z)?, format, place)?;
        }
        set.points.push(point);

        if let (Some(columns), Some(provenance)) = (self.provenance, &mut set.provenance) {
            let word = |column| {
                let number = value(column)?;
                // An ASCII file may have any number where its header promises an unsigned one.
                if number.fract() != 0.0 || !(0.0..=f64::from(u32::MAX)).contains(&number) {
                    let reason =
                        format!("{number} is no uint, which the header says the column holds");
                    return Err(FormatError::Malformed {
                        format,
                        place,
                        reason,
                    });
                }
                Ok(number as u32)
            };
            let [block, index, iteration] = columns.map(word);
            provenance.push([block?, index?, iteration?].into());
        }
        Ok(())
    }

    /// The precision of positions in a binary file.
    fn precision(&self, vertex: &Element) -> Precision {
        let [x, y] = self.position.map(|c| vertex.properties[c].scalar);
        if x.bytes() <= 4 && y.bytes() <= 4 {
            Precision::Single
        } else {
            Precision::Double
        }
    }

    fn new_set(&self) -> PointSet {
        PointSet {
            points: Vec::new(),
            provenance: self.provenance.map(|_| Vec::new()),
        }
    }
}

/// Reads the points of the vertices.
pub(super) fn read(bytes: &[u8], format: Format, any_z: bool) -> Result<Raw, FormatError> {
    let header = parse(bytes, format)?;
    let columns = PlyColumns::find(&header.vertex, format, header.data_line - 1, any_z)?;
    let (set, precision) = match header.encoding {
        // Text has no number type of its own: numbers are read as f64 whatever the header declares.
        Encoding::Ascii => (read_ascii(bytes, &header, &columns)?, Precision::Double),
        Encoding::Binary(endian) => {
            let precision = columns.precision(&header.vertex);
            (read_binary(bytes, &header, &columns, endian)?, precision)
        }
    };

    let mut raw = Raw::new(Vec::new(), precision);
    raw.set = set;
    Ok(raw)
}

/// Reads the vertices of a text file.
fn read_ascii(
    bytes: &[u8],
    header: &PlyHeader,
    columns: &PlyColumns,
) -> Result<PointSet, FormatError> {
    const FORMAT: Format = Format::PlyAscii;
    let vertex = &header.vertex;

    // Counts are claims of the header, and their sum may be too large for a number. Then all rows are skipped, and the count of
    // vertices below turns out wrong.
    let skipped = header
        .before
        .iter()
        .fold(0, |sum: u64, e| sum.saturating_add(e.count));

    let mut rows = lines(&bytes[header.data_offset..])
        .map(|(line, row)| (line + header.data_line - 1, row))
        .filter(|(_, row)| !row.is_empty())
        .skip(usize::try_from(skipped).unwrap_or(usize::MAX));

    // No room is reserved for the stated number of vertices, which may be false.
    let mut set = columns.new_set();
    let mut fields: Vec<&[u8]> = Vec::new();
    while (set.len() as u64) < vertex.count {
        let Some((line, row)) = rows.next() else {
            break;
        };

        fields.clear();
        fields.extend(words(row));
        let place = FilePlace::Line(line);
        if fields.len() != vertex.properties.len() {
            return Err(FormatError::Columns {
                format: FORMAT,
                place,
                found: fields.len(),
                expected: vertex.properties.len(),
            });
        }

        columns.take(&mut set, FORMAT, place, |c| {
            number(fields[c], FORMAT, place)
        })?;
    }

    // Rows behind the vertices are a surplus unless they belong to elements that follow.
    let surplus = if header.followed { 0 } else { rows.count() };
    let found = (set.len() + surplus) as u64;
    if found != vertex.count {
        return Err(FormatError::Count {
            format: FORMAT,
            stated: vertex.count,
            found,
        });
    }

    Ok(set)
}

/// Reads the vertices of a binary file.
fn read_binary(
    bytes: &[u8],
    header: &PlyHeader,
    columns: &PlyColumns,
    endian: Endian,
) -> Result<PointSet, FormatError> {
    const FORMAT: Format = Format::PlyBinary;
    let vertex = &header.vertex;
    let mut cursor = Cursor::new(bytes, header.data_offset, FORMAT);
    // Rows of elements before the vertices are skipped by their width. Rows with lists, which have none, were refused with the
    // header.
    for element in &header.before {
        cursor.records(element.count, element.width as u64)?;
    }
    let data = cursor.records(vertex.count, vertex.width as u64)?;
    // Elements behind the vertices may have lists of any length. Without such elements the file ends with the vertices.
    if !header.followed {
        cursor.finish()?;
    }

    let mut set = columns.new_set();
    let table = BinaryTable {
        columns: *columns,
        vertex: vertex.clone(),
        endian,
    };
    let first_vertex = 0;
    table.take(data, first_vertex, &mut set)?;
    Ok(set)
}

/// Binary rows of vertices.
#[derive(Clone, Debug)]
pub(super) struct BinaryTable {
    columns: PlyColumns,
    vertex: Element,
    endian: Endian,
}

impl BinaryTable {
    /// Reads whole rows, of which the first is vertex `first`.
    pub(super) fn take(
        &self,
        data: &[u8],
        first: u64,
        set: &mut PointSet,
    ) -> Result<(), FormatError> {
        const FORMAT: Format = Format::PlyBinary;
        for (row, index) in data.chunks_exact(self.vertex.width).zip(first..) {
            let value = |column: usize| {
                let property = &self.vertex.properties[column];
                let value = property.scalar.value(&row[property.offset..], self.endian);
                binary::finite(value, FORMAT, index)
            };
            (self.columns).take(set, FORMAT, FilePlace::Point(index), value)?;
        }
        Ok(())
    }
}

#[cfg(not(target_arch = "wasm32"))]
impl BinaryTable {
    /// Bytes of a row.
    pub(super) fn width(&self) -> usize {
        self.vertex.width
    }

    /// An empty set with room for what the rows hold.
    pub(super) fn new_set(&self) -> PointSet {
        self.columns.new_set()
    }
}

/// The head of a binary file: its columns, where the rows begin, how many there are, and whether other data follows
/// them.
#[cfg(not(target_arch = "wasm32"))]
pub(super) struct PlyHead {
    pub table: BinaryTable,
    pub precision: Precision,
    pub offset: u64,
    pub count: u64,
    pub followed: bool,
}

/// The head of a file that begins with `bytes`; none for an ASCII file.
#[cfg(not(target_arch = "wasm32"))]
pub(super) fn read_head(bytes: &[u8]) -> Result<Option<PlyHead>, FormatError> {
    const FORMAT: Format = Format::PlyBinary;
    let header = parse(bytes, FORMAT)?;
    // A stream reads z, which must be 0. The header's last line is the one before the data.
    let any_z = false;
    let columns = PlyColumns::find(&header.vertex, FORMAT, header.data_line - 1, any_z)?;
    let Encoding::Binary(endian) = header.encoding else {
        return Ok(None);
    };

    // Counts are claims of the header: a product or a sum that is too large for a number stays the largest number, which is
    // beyond the end of any file.
    let skipped = (header.before.iter()).fold(0, |sum: u64, element| {
        sum.saturating_add(element.count.saturating_mul(element.width as u64))
    });

    Ok(Some(PlyHead {
        precision: columns.precision(&header.vertex),
        offset: skipped.saturating_add(header.data_offset as u64),
        count: header.vertex.count,
        followed: header.followed,
        table: BinaryTable {
            columns,
            vertex: header.vertex,
            endian,
        },
    }))
}

/// Returns the file with only those of its vertices that are kept, to the byte, and the names of the elements left out: those
/// that refer to vertices by number, as the numbers would now be those of other vertices.
pub(super) fn keep(
    bytes: &[u8],
    format: Format,
    kept: &[bool],
) -> Result<(Vec<u8>, Vec<String>), FormatError> {
    let header = parse(bytes, format)?;
    let outlined = elements(&bytes[..header.data_offset], format)?;
    let mut out = Vec::with_capacity(bytes.len() / 2);
    keep_header(&bytes[..header.data_offset], &outlined, kept, &mut out);

    // Elements have their rows in the order in which the header lists them.
    let mut rest = &bytes[header.data_offset..];
    for element in &outlined {
        // The rows of a text file, the bytes of a binary one.
        let length = element.length(rest, header.encoding)?;
        // `kept` has an entry for each vertex.
        let stays = |row: usize| {
            !element.numbers_vertices
                && (!element.is_vertex() || kept.get(row).is_none_or(|kept| *kept))
        };
        rest = match header.encoding {
            Encoding::Ascii => keep_lines(rest, length, stays, &mut out),
            Encoding::Binary(_) => {
                let (rows, after) = rest.split_at(length);
                // Vertices have no lists, so that they are rows of one width. All rows of another element stay or go together,
                // as one chunk. Chunks need a width, even if there are no rows.
                let width = if element.is_vertex() {
                    header.vertex.width.max(1)
                } else {
                    length.max(1)
                };
                for (at, row) in rows.chunks_exact(width).enumerate() {
                    if stays(at) {
                        out.extend_from_slice(row);
                    }
                }
                after
            }
        };
    }
    out.extend_from_slice(rest);
    let referring = outlined.iter().filter(|element| element.numbers_vertices);
    let left_out = referring.map(|it| format!("{} ({} rows)", quote(&it.name), it.count));
    Ok((out, left_out.collect()))
}

/// Appends the header, with the number of vertices that are kept and without elements that are left out.
fn keep_header(header: &[u8], elements: &[OutlinedElement], kept: &[bool], out: &mut Vec<u8>) {
    let mut from = 0;
    for element in elements {
        // An element that refers to vertices loses all of its lines. The vertices have another number in their first
        // line, and the lines of all other elements stay.
        let changed = if element.numbers_vertices {
            &element.lines[..]
        } else {
            &element.lines[..usize::from(element.is_vertex())]
        };
        // What stands between the lines that change is copied as it is, with remarks and line ends.
        for line in changed {
            out.extend_from_slice(&header[from..line.start]);
            from = line.end;
            if element.is_vertex() {
                let (text, _) = split_line(&header[line.clone()]);
                let count = kept.iter().filter(|kept| **kept).count();
                push(out, format_args!("element vertex {count}"));
                out.extend_from_slice(&header[line.start + text.len()..line.end]);
            }
        }
    }
    out.extend_from_slice(&header[from..]);
}

/// Appends those of the next rows that stay, and returns what follows them. A row is a line that is not blank.
fn keep_lines<'a>(
    text: &'a [u8],
    rows: usize,
    stays: impl Fn(usize) -> bool,
    out: &mut Vec<u8>,
) -> &'a [u8] {
    let (mut rest, mut row) = (text, 0);
    while row < rows && !rest.is_empty() {
        let (line, after) = split_line(rest);
        let is_blank = line.trim_ascii().is_empty();
        if is_blank || stays(row) {
            out.extend_from_slice(&rest[..rest.len() - after.len()]);
        }
        row += usize::from(!is_blank);
        rest = after;
    }
    rest
}

/// Returns the numbers of a scalar property of the vertices.
pub(super) fn column(
    bytes: &[u8],
    format: Format,
    wanted: &str,
    of_use: ColumnUse,
) -> Result<Vec<f64>, FormatError> {
    let header = parse(bytes, format)?;
    let vertex = &header.vertex;
    let column = vertex.column(wanted).ok_or_else(|| {
        let names = vertex.properties.iter().map(|it| quote(&it.name));
        FormatError::Header {
            format,
            place: FilePlace::Line(header.data_line - 1),
            reason: format!(
                "vertices have no scalar property {wanted}; they have {}",
                names.collect::<Vec<_>>().join(", ")
            ),
        }
    })?;
    // A property other than a coordinate may be any number in a sound file, also one that is of no use here.
    let useful = |value: f64, place| {
        // The error is written only where it is one: to write it for each value took longer than to read all of them.
        let fault = || FormatError::Row {
            format,
            place,
            reason: format!("{wanted} is {value}, which is not {}", of_use.wanted()),
        };
        Some(value)
            .filter(|&value| of_use.accepts(value))
            .ok_or_else(fault)
    };

    let data = bytes.get(header.data_offset..).unwrap_or_default();
    match header.encoding {
        Encoding::Ascii => {
            // In text a row is a line that is not blank. Rows of earlier elements are skipped. That no row is missing
            // was checked when the points were read.
            let counts = header.before.iter().map(|element| element.count);
            let before = counts.fold(0, u64::saturating_add);
            let rows = (lines(data).filter(|(_, row)| !row.is_empty()))
                .skip(usize::try_from(before).unwrap_or(usize::MAX))
                .take(usize::try_from(vertex.count).unwrap_or(usize::MAX));
            rows.map(|(line, row)| {
                let place = FilePlace::Line(line + header.data_line - 1);
                let field = words(row).nth(column).unwrap_or_default();
                useful(number(field, format, place)?, place)
            })
            .collect()
        }
        Encoding::Binary(endian) => {
            let mut cursor = Cursor::new(data, 0, format);
            for element in &header.before {
                cursor.records(element.count, element.width as u64)?;
            }
            let rows = cursor.records(vertex.count, vertex.width as u64)?;
            let property = &vertex.properties[column];
            let value = |row: &[u8]| property.scalar.value(&row[property.offset..], endian);
            // The property that was found makes the rows at least one byte wide.
            let rows = rows.chunks_exact(vertex.width).zip(0..);
            rows.map(|(row, index)| useful(value(row), FilePlace::Point(index)))
                .collect()
        }
    }
}

/// A header whose length does not depend on `count`: the fewer digits the count has, the more dots end a comment.
/// `properties` are those behind the coordinates, each a type and a name.
fn header(encoding: &str, count: u64, coordinate: &str, properties: &[[&str; 2]]) -> Vec<u8> {
    let mut out = Vec::new();
    // The longest count, 2^64 - 1, has 20 digits. Heads of one length let a writer put the count in once it is known.
    let dots = ".".repeat(20 - count.to_string().len());
    push(
        &mut out,
        format_args!(
            "ply\nformat {encoding} 1.0\ncomment written by Tilescope {dots}\nelement vertex {count}\n"
        ),
    );
    for axis in ["x", "y", "z"] {
        push(&mut out, format_args!("property {coordinate} {axis}\n"));
    }
    for [kind, name] in properties {
        push(&mut out, format_args!("property {kind} {name}\n"));
    }
    out.extend_from_slice(b"end_header\n");
    out
}

/// The properties of a planar set behind the coordinates, in the order of its rows.
fn properties(provenance: bool, columns: &Columns) -> Vec<[&'static str; 2]> {
    let origins = PROVENANCE.into_iter().filter(|_| provenance);
    let level = Some(LEVEL).filter(|_| !columns.levels.is_empty());
    let integers = origins.chain(level).map(|name| ["uint", name]);
    let doubles = [(RANK, columns.ranks.len()), (RADIUS, columns.radii.len())];
    let doubles = doubles.into_iter().filter(|&(_, count)| count > 0);
    integers
        .chain(doubles.map(|(name, _)| ["double", name]))
        .collect()
}

/// Writes a text file, a vertex a line, with its columns in the order of the header.
pub(super) fn write_ascii(
    points: &[[f64; 2]],
    provenance: Option<&[Provenance]>,
    columns: &Columns,
) -> Vec<u8> {
    let count = points.len() as u64;
    let properties = properties(provenance.is_some(), columns);
    let mut out = header("ascii", count, "double", &properties);

    for (index, [x, y]) in points.iter().enumerate() {
        // Programs that read point clouds expect a z.
        push(&mut out, format_args!("{x} {y} 0"));
        if let Some(from) = provenance.and_then(|all| all.get(index)) {
            for word in <[u32; 3]>::from(*from) {
                push(&mut out, format_args!(" {word}"));
            }
        }
        if let Some(level) = columns.levels.get(index) {
            push(&mut out, format_args!(" {level}"));
        }
        if let Some(rank) = columns.ranks.get(index) {
            push(&mut out, format_args!(" {rank}"));
        }
        if let Some(radius) = columns.radii.get(index) {
            push(&mut out, format_args!(" {radius}"));
        }
        out.push(b'\n');
    }
    out
}

pub(super) fn write_binary(
    points: &[[f64; 2]],
    provenance: Option<&[Provenance]>,
    columns: &Columns,
    precision: Precision,
) -> Vec<u8> {
    let count = points.len() as u64;
    let mut out = binary_head(count, precision, provenance.is_some(), columns);
    push_rows(&mut out, points, provenance, columns, precision);
    out
}

/// The head of a binary file of `count` points; its length does not depend on the count.
pub(super) fn binary_head(
    count: u64,
    precision: Precision,
    provenance: bool,
    columns: &Columns,
) -> Vec<u8> {
    header_of_binary(count, precision, &properties(provenance, columns))
}

fn header_of_binary(count: u64, precision: Precision, properties: &[[&str; 2]]) -> Vec<u8> {
    let coordinate = match precision {
        Precision::Single => "float",
        Precision::Double => "double",
    };
    header("binary_little_endian", count, coordinate, properties)
}

/// Appends binary rows, with their columns in the order of the header.
pub(super) fn push_rows(
    out: &mut Vec<u8>,
    points: &[[f64; 2]],
    provenance: Option<&[Provenance]>,
    columns: &Columns,
    precision: Precision,
) {
    // Three words of provenance and one of the level take 16 bytes; ranks and radii, which few sets have, may make the buffer grow.
    out.reserve(points.len() * (3 * precision.bytes() + 16));

    for (index, &[x, y]) in points.iter().enumerate() {
        binary::push(out, &[x, y, 0.0], precision);
        if let Some(from) = provenance.and_then(|all| all.get(index)) {
            for word in <[u32; 3]>::from(*from) {
                out.extend_from_slice(&word.to_le_bytes());
            }
        }
        if let Some(level) = columns.levels.get(index) {
            out.extend_from_slice(&level.to_le_bytes());
        }
        if let Some(rank) = columns.ranks.get(index) {
            out.extend_from_slice(&rank.to_le_bytes());
        }
        if let Some(radius) = columns.radii.get(index) {
            out.extend_from_slice(&radius.to_le_bytes());
        }
    }
}

/// Writes points in space with their columns.
pub(super) fn write_solid(
    points: &[[f64; 3]],
    columns: &SolidColumns,
    format: Format,
    precision: Precision,
) -> Vec<u8> {
    let count = points.len() as u64;
    // With a sign, so that programs may subtract them: a box has fewer than 2^30 samples.
    let properties: Vec<_> = columns.names().map(|name| ["int", name]).collect();
    if format == Format::PlyAscii {
        let mut out = header("ascii", count, "double", &properties);
        for (index, [x, y, z]) in points.iter().enumerate() {
            push(&mut out, format_args!("{x} {y} {z}"));
            for number in columns.of(index) {
                push(&mut out, format_args!(" {number}"));
            }
            out.push(b'\n');
        }
        return out;
    }

    let mut out = header_of_binary(count, precision, &properties);
    out.reserve(points.len() * (3 * precision.bytes() + 4 * properties.len()));
    for (index, point) in points.iter().enumerate() {
        binary::push(&mut out, point, precision);
        for number in columns.of(index) {
            out.extend_from_slice(&number.to_le_bytes());
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(bytes: &[u8], format: Format) -> Result<Raw, FormatError> {
        super::read(bytes, format, false)
    }

    #[test]
    fn foreign_properties_and_elements_are_skipped() {
        let text = b"ply\nformat ascii 1.0\nelement camera 2\nproperty float f\nelement vertex 2\n\
            property uchar red\nproperty float y\nproperty float x\nelement face 1\n\
            property list uchar int vertex_indices\nend_header\n1\n2\n255 0.25 0.5\n0 0.5 0.75\n3 0 1 2\n";
        let raw = read(text, Format::PlyAscii).expect("readable");
        assert_eq!(raw.set.points, [[0.5, 0.25], [0.75, 0.5]]);
        assert!(raw.set.provenance.is_none());
    }

    #[test]
    fn big_endian_is_read() {
        let mut bytes = b"ply\nformat binary_big_endian 1.0\nelement vertex 1\nproperty float x\n\
            property double y\nproperty ushort k\nend_header\n"
            .to_vec();
        bytes.extend_from_slice(&0.5_f32.to_be_bytes());
        bytes.extend_from_slice(&0.25_f64.to_be_bytes());
        bytes.extend_from_slice(&[0, 1]);
        let raw = read(&bytes, Format::PlyBinary).expect("readable");
        assert_eq!(raw.set.points, [[0.5, 0.25]]);
        assert_eq!(raw.precision, Precision::Double);
        bytes.pop();
        assert!(matches!(
            read(&bytes, Format::PlyBinary),
            Err(FormatError::Truncated {
                needed: 14,
                available: 13,
                ..
            })
        ));
    }

    #[test]
    fn ascii_faults_are_named() {
        let start = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n\
                     property float z\nend_header\n";
        let message = |data: &str| {
            let text = format!("{start}{data}");
            let error = read(text.as_bytes(), Format::PlyAscii).err().expect(data);
            error.to_string()
        };
        let counted = "PLY (ASCII): the file states 2 points and holds";
        assert_eq!(message("0 0 0\n"), format!("{counted} 1"));
        assert_eq!(message("0 0 0\n1 1 0\n1 0 0\n"), format!("{counted} 3"));
        assert!(message("0 0 0\n1 1\n").contains("line 9: 2 columns where 3"));
        assert!(message("0 0 0\n1 1 4\n").contains("line 9: z is 4"));
        assert!(message("0 o 0\n").contains("\"o\" is not a number"));

        let start = start.replace(
            "property float z",
            "property uint block\nproperty uint pattern_index\nproperty uint iteration",
        );
        let outcome = |row: &str| {
            let text = format!("{start}{row}\n1 1 3 4 5\n");
            read(text.as_bytes(), Format::PlyAscii).map_err(|error| error.to_string())
        };
        assert!(outcome("0 0 4294967295 1 0").is_ok_and(|raw| raw.set.provenance.is_some()));
        for wrong in ["-5", "1.5", "4294967296"] {
            let reason = outcome(&format!("0 0 {wrong} 1 0")).err().expect(wrong);
            assert!(
                reason.contains(&format!("line 10: {wrong} is no uint")),
                "{reason}"
            );
        }
    }
}
