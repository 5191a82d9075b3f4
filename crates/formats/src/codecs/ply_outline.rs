//! All elements of a PLY file, with their lines in the header and their lists: all that writing the file again needs, without
//! some of its rows. Reading points needs less, which [`super::ply_header`] has.

use std::ops::Range;

use super::ply_header::{Encoding, Scalar};
use crate::binary::Cursor;
use crate::error::{FilePlace, FormatError, quote};
use crate::format::Format;
use crate::text::words;

/// How a property stands in a row.
#[derive(Clone, Copy, Debug)]
enum Stored {
    Scalar(Scalar),
    /// A number, and as many items.
    List {
        count: Scalar,
        item: Scalar,
    },
}

/// An element with all of its properties.
#[derive(Clone, Debug)]
pub(super) struct OutlinedElement {
    pub name: Vec<u8>,
    pub count: u64,
    stored: Vec<Stored>,
    /// Whether a property has numbers of vertices, as the faces and the edges of a mesh have.
    pub numbers_vertices: bool,
    /// Where its lines are in the header.
    pub lines: Vec<Range<usize>>,
}

impl OutlinedElement {
    pub fn is_vertex(&self) -> bool {
        self.name == b"vertex"
    }

    /// Returns how many of `bytes`, which begin with the rows of the element, belong to these rows; in a text file, how
    /// many lines do.
    pub fn length(&self, bytes: &[u8], encoding: Encoding) -> Result<usize, FormatError> {
        let Encoding::Binary(endian) = encoding else {
            // No file in memory has `usize::MAX` lines. A count above that is cut to it: either number asks for all
            // lines that are left.
            return Ok(usize::try_from(self.count).unwrap_or(usize::MAX));
        };

        let mut cursor = Cursor::new(bytes, 0, Format::PlyBinary);
        let width_of = |stored: &Stored| match stored {
            Stored::Scalar(scalar) => Some(scalar.bytes() as u64),
            Stored::List { .. } => None,
        };
        // Rows without lists all have the same width, so that they are not gone through.
        if let Some(width) = self.stored.iter().map(width_of).sum::<Option<u64>>() {
            cursor.records(self.count, width)?;
            return Ok(cursor.offset() as usize);
        }

        for _ in 0..self.count {
            for stored in &self.stored {
                match *stored {
                    Stored::Scalar(scalar) => cursor.take(scalar.bytes() as u64)?,
                    Stored::List { count, item } => {
                        let items = count.value(cursor.take(count.bytes() as u64)?, endian);
                        // A negative number of items becomes 0 by the cast.
                        cursor.records(items as u64, item.bytes() as u64)?
                    }
                };
            }
        }
        Ok(cursor.offset() as usize)
    }
}

/// Returns the elements of a header, which was read without a fault.
pub(super) fn elements(header: &[u8], format: Format) -> Result<Vec<OutlinedElement>, FormatError> {
    let mut elements = Vec::<OutlinedElement>::new();
    let mut begin = 0;
    for (row, line) in header.split_inclusive(|&b| b == b'\n').zip(1..) {
        let at = begin..begin + row.len();
        begin = at.end;
        // Reading points does not look at the types of lists, so that an unknown one is found only here.
        let scalar = |name: &[u8]| {
            Scalar::from_name(name).ok_or_else(|| FormatError::Header {
                format,
                place: FilePlace::Line(line),
                reason: format!("\"{}\" is not a type", quote(name)),
            })
        };

        let fields: Vec<&[u8]> = words(row).collect();
        let (stored, name) = match fields[..] {
            [b"element", name, count] => {
                // The count is a number, as a header with another one was refused.
                let count = std::str::from_utf8(count)
                    .ok()
                    .and_then(|it| it.parse().ok());
                elements.push(OutlinedElement {
                    name: name.to_vec(),
                    count: count.unwrap_or(0),
                    stored: Vec::new(),
                    numbers_vertices: false,
                    lines: vec![at],
                });
                continue;
            }
            [b"property", b"list", count, item, name] => {
                let (count, item) = (scalar(count)?, scalar(item)?);
                (Stored::List { count, item }, name)
            }
            [b"property", kind, name] => (Stored::Scalar(scalar(kind)?), name),
            // Other lines, such as comments, are of no element, and stay as they are.
            _ => continue,
        };

        // There is an element, as a header with a property before any was refused.
        if let Some(element) = elements.last_mut() {
            element.stored.push(stored);
            element.lines.push(at);
            // Programs name such properties `vertex_index`, `vertex_indices`, `vertex1` or `vertex2`.
            element.numbers_vertices |= !element.is_vertex() && name.starts_with(b"vertex");
        }
    }
    Ok(elements)
}
