//! The header of a PLY file: encoding, elements and their properties.
//!
//! Follows the description by Greg Turk (1994). An element that cannot be skipped without
//! walking its lists is refused here.

use crate::binary::{Endian, array};
use crate::error::{FilePlace, FormatError, quote};
use crate::format::Format;
use crate::text::words;

/// A scalar type of PLY.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    pub(super) fn from_name(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    pub(super) fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The value stored at the start of `bytes`; every one of these types fits into an f64.
    pub(super) fn value(self, bytes: &[u8], endian: Endian) -> f64 {
        // All scalars are turned to little-endian in a word wide enough for any.
        let mut word = array::<8>(bytes);
        if endian == Endian::Big {
            word[..self.bytes()].reverse();
        }

        match self {
            Self::I8 => f64::from(word[0].cast_signed()),
            Self::U8 => f64::from(word[0]),
            Self::I16 => f64::from(i16::from_le_bytes(array(&word))),
            Self::U16 => f64::from(u16::from_le_bytes(array(&word))),
            Self::I32 => f64::from(i32::from_le_bytes(array(&word))),
            Self::U32 => f64::from(u32::from_le_bytes(array(&word))),
            Self::F32 => f64::from(f32::from_le_bytes(array(&word))),
            Self::F64 => f64::from_le_bytes(word),
        }
    }
}

/// How the data after the header are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    Binary(Endian),
}

/// A property of scalar type.
#[derive(Clone, Debug)]
pub(super) struct Property {
    pub name: Vec<u8>,
    pub scalar: Scalar,
    /// Byte offset in a binary row.
    pub offset: usize,
}

/// An element: a table with rows of properties.
#[derive(Clone, Debug, Default)]
pub(super) struct Element {
    name: Vec<u8>,
    pub count: u64,
    pub properties: Vec<Property>,
    /// Bytes of a binary row.
    pub width: usize,
    has_list: bool,
}

impl Element {
    /// The index of the property called `name`.
    pub(super) fn column(&self, name: &str) -> Option<usize> {
        self.properties
            .iter()
            .position(|property| property.name == name.as_bytes())
    }
}

/// The parts of a header that are needed to read the data.
#[derive(Debug)]
pub(super) struct PlyHeader {
    pub encoding: Encoding,
    /// Elements stored before the vertices.
    pub before: Vec<Element>,
    pub vertex: Element,
    /// Whether elements follow the vertices.
    pub followed: bool,
    /// Byte offset of the data.
    pub data_offset: usize,
    /// Number of the first data line, from 1.
    pub data_line: u64,
}

/// The header as far as its lines were read.
struct Parser {
    format: Format,
    line: u64,
    encoding: Option<Encoding>,
    elements: Vec<Element>,
}

/// The header of `bytes`.
pub(super) fn parse(bytes: &[u8], format: Format) -> Result<PlyHeader, FormatError> {
    let mut parser = Parser {
        format,
        line: 0,
        encoding: None,
        elements: Vec::new(),
    };

    let mut offset = 0;
    for row in bytes.split_inclusive(|&b| b == b'\n') {
        parser.line += 1;
        // A line counts with its end, as the data begin right behind the end of the header's last line.
        offset += row.len();
        let row = row.trim_ascii();

        if parser.line == 1 && row != b"ply" {
            return Err(FormatError::Magic {
                format,
                expected: "a line \"ply\"",
            });
        }

        if row == b"end_header" {
            return parser.finish(offset);
        }
        parser.take(row)?;
    }
    Err(parser.fault("the file ends before \"end_header\"".to_owned()))
}

impl Parser {
    fn fault(&self, reason: String) -> FormatError {
        FormatError::Header {
            format: self.format,
            place: FilePlace::Line(self.line),
            reason,
        }
    }

    /// Reads a line of the header.
    fn take(&mut self, row: &[u8]) -> Result<(), FormatError> {
        let mut fields = words(row);
        let keyword = fields.next().unwrap_or_default();
        let fields: Vec<&[u8]> = fields.collect();
        match (keyword, fields.as_slice()) {
            // `parse` has checked that the first line is `ply`.
            (b"" | b"ply" | b"comment" | b"obj_info", _) => Ok(()),
            // The version behind the encoding is always 1.0.
            (b"format", [name, ..]) => self.encoding(name),
            (b"element", [name, count]) => self.element(name, count),
            // Whether the list is in the way depends on the place of its element. `finish` decides it, once all
            // elements are read.
            (b"property", [b"list", _, _, _]) => match self.elements.last_mut() {
                Some(element) => {
                    element.has_list = true;
                    Ok(())
                }
                None => Err(self.fault("a property before any element".to_owned())),
            },
            (b"property", [scalar, name]) => self.property(scalar, name),
            _ => Err(self.fault(format!("\"{}\" is not understood", quote(row)))),
        }
    }

    fn encoding(&mut self, name: &[u8]) -> Result<(), FormatError> {
        self.encoding = Some(match name {
            b"ascii" => Encoding::Ascii,
            b"binary_little_endian" => Encoding::Binary(Endian::Little),
            b"binary_big_endian" => Encoding::Binary(Endian::Big),
            _ => return Err(self.fault(format!("the encoding is \"{}\"", quote(name)))),
        });
        Ok(())
    }

    fn element(&mut self, name: &[u8], count: &[u8]) -> Result<(), FormatError> {
        let parsed = std::str::from_utf8(count).ok().and_then(|c| c.parse().ok());
        let count = parsed
            .ok_or_else(|| self.fault(format!("\"{}\" is not a number of rows", quote(count))))?;
        self.elements.push(Element {
            name: name.to_vec(),
            count,
            ..Element::default()
        });
        Ok(())
    }

    /// Adds a scalar property to the element that was read last.
    fn property(&mut self, scalar: &[u8], name: &[u8]) -> Result<(), FormatError> {
        let Some(scalar) = Scalar::from_name(scalar) else {
            return Err(self.fault(format!("\"{}\" is not a type", quote(scalar))));
        };
        let Some(element) = self.elements.last_mut() else {
            return Err(self.fault("a property before any element".to_owned()));
        };
        element.properties.push(Property {
            name: name.to_vec(),
            scalar,
            offset: element.width,
        });
        // In a binary row, properties follow each other without gaps.
        element.width += scalar.bytes();
        Ok(())
    }

    /// Returns the header, whose data begin at `data_offset`, once its last line is read.
    fn finish(mut self, data_offset: usize) -> Result<PlyHeader, FormatError> {
        let Some(encoding) = self.encoding else {
            return Err(self.fault("no line \"format\"".to_owned()));
        };

        let Some(at) = self.elements.iter().position(|e| e.name == b"vertex") else {
            return Err(self.fault("no element \"vertex\"".to_owned()));
        };

        // Rows with lists have no fixed width, so that vertices with lists are refused. In a binary file the elements
        // before the vertices are skipped by the width of their rows, so that lists in these elements are refused, too.
        // In a text file the rows of these elements are skipped as lines, and may have lists.
        let binary = encoding != Encoding::Ascii;
        let listed = |(index, e): (usize, &Element)| e.has_list && (index == at || binary);
        if self.elements.iter().take(at + 1).enumerate().any(listed) {
            return Err(FormatError::Unsupported {
                format: self.format,
                what: "a list property of the vertices or stored before them".to_owned(),
                supported: "scalar properties can",
            });
        }

        let followed = self.elements.len() > at + 1;
        let vertex = self.elements.swap_remove(at);
        // Only elements before the vertices are needed. The one that `swap_remove` moved into their place came behind them.
        self.elements.truncate(at);

        Ok(PlyHeader {
            encoding,
            before: self.elements,
            vertex,
            followed,
            data_offset,
            data_line: self.line + 1,
        })
    }
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "the expected values are exact")]
mod tests {
    use super::*;

    fn message(header: &str) -> String {
        parse(header.as_bytes(), Format::PlyAscii)
            .expect_err(header)
            .to_string()
    }

    #[test]
    fn offsets_follow_the_property_sizes() {
        let text = "ply\r\nformat binary_big_endian 1.0\r\ncomment a b c\r\nelement camera 2\r\n\
                    property uchar id\r\nelement vertex 7\r\nproperty short kind\r\nproperty double x\r\n\
                    property float y\r\nelement face 1\r\nproperty list uchar int vertex_indices\r\n\
                    end_header\r\nDATA";
        let header = parse(text.as_bytes(), Format::PlyBinary).expect("well-formed");
        assert_eq!(header.encoding, Encoding::Binary(Endian::Big));
        assert_eq!((header.before.len(), header.before[0].width), (1, 1));
        assert_eq!((header.vertex.count, header.vertex.width), (7, 14));
        let y = header.vertex.column("y").expect("there is a y");
        assert_eq!(header.vertex.properties[y].offset, 10);
        assert!(header.followed);
        assert_eq!(&text[header.data_offset..], "DATA");
        assert_eq!(header.data_line, 13);
    }

    #[test]
    fn faults_are_named_with_their_line() {
        for (header, part) in [
            ("plx\n", "does not begin with a line \"ply\""),
            ("ply\nformat ascii 1.0\n", "ends before \"end_header\""),
            (
                "ply\nformat morse 1.0\n",
                "line 2: the encoding is \"morse\"",
            ),
            (
                "ply\nelement vertex many\n",
                "\"many\" is not a number of rows",
            ),
            ("ply\nproperty float x\n", "a property before any element"),
            (
                "ply\nelement vertex 1\nproperty half x\n",
                "\"half\" is not a type",
            ),
            ("ply\nelement vertex 1\nend_header\n", "no line \"format\""),
            (
                "ply\nformat ascii 1.0\nend_header\n",
                "no element \"vertex\"",
            ),
            ("ply\nfnord\n", "\"fnord\" is not understood"),
            (
                "ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar int a\nend_header\n",
                "a list property",
            ),
        ] {
            let found = message(header);

            assert!(found.contains(part), "{found}");
        }
    }

    #[test]
    fn scalars_of_both_byte_orders() {
        assert_eq!(Scalar::I16.value(&[0xFF, 0xFE], Endian::Big), -2.0);
        assert_eq!(Scalar::I16.value(&[0xFE, 0xFF], Endian::Little), -2.0);
        assert_eq!(
            Scalar::U32.value(&[0xFF; 4], Endian::Big),
            f64::from(u32::MAX)
        );
        assert_eq!(Scalar::F32.value(&1.5_f32.to_be_bytes(), Endian::Big), 1.5);
        assert_eq!(Scalar::I8.value(&[0x80], Endian::Little), -128.0);
    }
}
