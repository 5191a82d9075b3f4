//! Detects the format of some bytes by extension, then by content, and says on what evidence. Also checks that a file
//! is not written in a format that readers would take for another because of its name.
//!
//! A file that begins with a format's own mark is of that format whatever its name says. Text has no marks: its first two
//! lines decide, together with what the name says of text. Only the beginning is parsed; whether the rest is valid shows on
//! decoding.

use std::fmt;
use std::path::Path;

use crate::binary::array;
use crate::column_names as names;
use crate::error::FormatError;
use crate::fields::{Separator, looks_numeric, unquoted};
use crate::format::Format;
use crate::text::{as_utf8, is_remark, lines, without_bom, words};

/// First bytes of a numpy file.
pub(crate) const NPY_MAGIC: &[u8] = b"\x93NUMPY";
/// First bytes of a UTK binary file: 0x214B5455, little-endian.
pub(crate) const UTK_MAGIC: &[u8] = b"UTK!";
/// First bytes of a Parquet file.
const PARQUET_MAGIC: &[u8] = b"PAR1";

/// The evidence for a format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Evidence {
    /// The caller named it.
    Told,
    /// The file's extension, which its content does not contradict.
    Extension,
    /// The content: there is no known extension.
    Content,
    /// The content, against the extension, which stands for this other format.
    ContentAgainst(Format),
}

/// A format and how it was recognised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Detection {
    /// The format of the file.
    pub format: Format,
    /// The evidence for that format.
    pub evidence: Evidence,
}

impl Detection {
    /// The format that the caller insists on, or that [`detect`] finds.
    pub(crate) fn of(
        bytes: &[u8],
        path: &Path,
        asked: Option<Format>,
    ) -> Result<Self, FormatError> {
        let evidence = Evidence::Told;
        asked.map_or_else(
            || detect(bytes, path),
            |format| Ok(Self { format, evidence }),
        )
    }
}

impl fmt::Display for Detection {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let format = self.format;
        match self.evidence {
            Evidence::Told => write!(f, "{format}, as asked"),
            Evidence::Extension => write!(f, "{format}, by its extension"),
            Evidence::Content => write!(f, "{format}, by its content"),
            Evidence::ContentAgainst(named) => {
                write!(f, "{format}, by its content (its name says {named})")
            }
        }
    }
}

/// The format of `bytes` which come from a file called `path` (empty if it has no name).
///
/// # Errors
///
/// [`FormatError::UnknownFormat`] when neither name nor content shows the format, [`FormatError::Parquet`] for a Parquet
/// file.
///
/// ```
/// use tilescope_formats::{Format, detect};
/// let found = detect(b"x,y\n0,0\n", "points".as_ref()).unwrap();
/// assert_eq!(found.format, Format::Csv);
/// assert_eq!(found.to_string(), "CSV, by its content");
/// ```
pub fn detect(bytes: &[u8], path: &Path) -> Result<Detection, FormatError> {
    let bytes = &*as_utf8(bytes);
    let named = Format::from_path(path);
    // A file of raw numbers may begin with any bytes, those of a Parquet file among them.
    if bytes.starts_with(PARQUET_MAGIC) && named != Some(Format::PsaRps) {
        return Err(FormatError::Parquet);
    }

    // A mark in the bytes decides, then the name, except among tables of text, whose look decides.
    let marked = by_mark(bytes);
    let (format, evidence) = match (named, marked) {
        // Most programs call GeoJSON .json. Its type need not come first in an object, so that only the name may show
        // it.
        (Some(Format::GeoJson), Some(Format::Json))
        | (Some(Format::Json), Some(Format::GeoJson)) => (Format::GeoJson, Evidence::Extension),
        (Some(named), Some(marked)) if same_family(named, marked) => (marked, Evidence::Extension),
        (Some(named), Some(marked)) => (marked, Evidence::ContentAgainst(named)),
        (Some(named), None) if !is_table(named) => (named, Evidence::Extension),
        // A text that looks like no format is left to the codec of its name, which reports the fault.
        (Some(named), None) => match text_format(bytes, path).unwrap_or(named) {
            found if found == named => (named, Evidence::Extension),
            found => (found, Evidence::ContentAgainst(named)),
        },
        (None, Some(marked)) => (marked, Evidence::Content),
        (None, None) => {
            let shape = text_format(bytes, path).or_else(|| looks_like_rps(bytes));
            let unknown = || FormatError::UnknownFormat {
                name: path.to_string_lossy().into_owned(),
            };
            (shape.ok_or_else(unknown)?, Evidence::Content)
        }
    };

    Ok(Detection { format, evidence })
}

/// Whether two formats have the same extension, as the two of PLY have.
fn same_family(a: Format, b: Format) -> bool {
    a.extension() == b.extension()
}

/// The format whose unmistakable beginning `bytes` have.
fn by_mark(bytes: &[u8]) -> Option<Format> {
    if bytes.starts_with(NPY_MAGIC) {
        return Some(Format::Npy);
    }
    if bytes.starts_with(UTK_MAGIC) {
        return Some(Format::UtkBinary);
    }
    if bytes.starts_with(b"ply\n") || bytes.starts_with(b"ply\r") {
        let ascii = lines(bytes)
            .take_while(|(_, line)| *line != b"end_header")
            .any(|(_, line)| line.starts_with(b"format ascii"));
        return Some(if ascii {
            Format::PlyAscii
        } else {
            Format::PlyBinary
        });
    }

    // A raw f32 file may begin with any byte: for JSON and SVG the first two characters that are not blank have to fit.
    let text = without_bom(bytes).trim_ascii_start();
    let second = text.get(1..).unwrap_or_default().trim_ascii_start().first();
    match (text.first()?, second?) {
        (b'{', b'"') if begins_with_type(&text[1..]) => Some(Format::GeoJson),
        (b'{', b'"' | b'}') | (b'[', b'[' | b']') => Some(Format::Json),
        // `<?xml`, `<svg`, and a comment or a document type before it.
        (b'<', b'?' | b's' | b'!') => Some(Format::Svg),
        _ => None,
    }
}

/// Whether the first member of an object is its type, as in `GeoJSON`; sets of this program have none.
fn begins_with_type(members: &[u8]) -> bool {
    members.trim_ascii_start().starts_with(b"\"type\"")
}

/// Whether a format is a table of text, so that others of its kind may bear its name.
const fn is_table(format: Format) -> bool {
    matches!(
        format,
        Format::Csv | Format::PsaText | Format::UtkText | Format::Xyz
    )
}

/// What the name of a file says of the text in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum NamedText {
    /// A table in the units of its user: `.csv`, `.tsv`, `.tab`.
    Table,
    /// A point cloud: `.xyz`, `.pts`, `.asc`.
    Cloud,
    /// Anything: `.txt`, which is also psa's, and `.dat`, which is also UTK's.
    Any,
    /// The name is not that of a text format.
    Unknown,
}

impl NamedText {
    fn of(path: &Path) -> Self {
        let extension = path.extension().unwrap_or_default().to_string_lossy();
        match &*extension.to_ascii_lowercase() {
            "csv" | "tsv" | "tab" => Self::Table,
            "xyz" | "pts" | "asc" => Self::Cloud,
            "txt" | "dat" => Self::Any,
            _ => Self::Unknown,
        }
    }
}

/// What the first lines of a text hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TextShape {
    /// Numbers between blanks, this many in a line.
    Numbers(usize),
    /// A number alone in its line, then this many numbers a line.
    Counted(usize),
    /// Numbers between other separators, names of coordinates, or a line that states the separator.
    Table,
    /// Words that are neither numbers nor names of coordinates.
    Words { are_several: bool },
}

/// The format of a text in a file called `path`. `None` if the bytes are no text, if they have no lines but remarks,
/// and if neither their shape nor the name says what they are.
fn text_format(bytes: &[u8], path: &Path) -> Option<Format> {
    let (named, shape) = (NamedText::of(path), text_shape(bytes)?);
    Some(match (named, shape) {
        // The codecs of XYZ and CSV both read any table, in the units of the file. Several words in a `.txt` or `.dat`
        // may be a header: the codec of CSV says what its names lack.
        (NamedText::Cloud, _) => Format::Xyz,
        (NamedText::Table, _)
        | (_, TextShape::Table)
        | (NamedText::Any, TextShape::Words { are_several: true }) => Format::Csv,
        // psa reads number by number, wherever lines end.
        (_, TextShape::Numbers(1) | TextShape::Counted(..=2)) => Format::PsaText,
        (_, TextShape::Numbers(2)) => Format::UtkText,
        // Of three numbers or more, the third is z.
        (_, TextShape::Counted(_) | TextShape::Numbers(3))
        | (NamedText::Any, TextShape::Numbers(_)) => Format::Xyz,
        // Without a name, many numbers in a line may be anything, and words alone are no table.
        (NamedText::Unknown, TextShape::Numbers(_)) | (_, TextShape::Words { .. }) => return None,
    })
}

/// The shape of a text; `None` if it is binary or has no lines but remarks.
fn text_shape(bytes: &[u8]) -> Option<TextShape> {
    let mut remarks = Vec::new();
    let mut rows = lines(bytes).map(|(_, line)| line).filter(|line| {
        let is_remark = is_remark(line);
        if is_remark && let Some(names) = names::in_remark(line) {
            // The last remark with names before a row may name the columns, as when the table is read. Here the remarks
            // up to the second row are seen.
            remarks = names;
        }
        !line.is_empty() && !is_remark
    });

    let first = rows.next()?;
    let second = rows.next().unwrap_or_default();
    // The iterator fills `remarks`, which are read below.
    drop(rows);

    let text = std::str::from_utf8(first).ok()?;
    // Binary data may be valid UTF-8, but nearly always has control characters. Text has none.
    if text.contains(|c: char| c.is_control() && !c.is_whitespace()) {
        return None;
    }

    let separator = Separator::of(first);
    let fields: Vec<&[u8]> = match separator {
        Separator::Blank => words(first).collect(),
        separator => first.split(|&b| b == separator.byte()).collect(),
    };

    let strings = |fields: &[&[u8]]| -> Vec<String> {
        let text = |field: &&[u8]| String::from_utf8_lossy(unquoted(field)).into_owned();
        fields.iter().map(text).collect()
    };
    // Names of coordinates, a line that states the separator, or commas make a table whatever its fields are.
    let is_names = names::is_header(&strings(&fields));
    if is_names || Separator::stated(first).is_some() || separator == Separator::Comma {
        return Some(TextShape::Table);
    }

    if !fields.iter().all(|field| looks_numeric(field)) {
        let are_several = fields.len() > 1;
        return Some(TextShape::Words { are_several });
    }

    // All fields are numbers from here on. Semicolons between them make a table. Tabs between them count as blanks,
    // since the codecs of psa's and UTK's text read both.
    if separator == Separator::Semicolon {
        return Some(TextShape::Table);
    }

    // Without names x and y are the first columns: names in a remark make a difference only if they say otherwise.
    let in_order = |names: &[String]| names::named(names).is_ok_and(|found| found.places == [0, 1]);
    if remarks.len() == fields.len() && !in_order(&remarks) {
        return Some(TextShape::Table);
    }

    Some(match (fields.len(), words(second).count()) {
        // A number alone, before rows of several, is their count.
        (1, columns @ 2..) => TextShape::Counted(columns),
        (columns, _) => TextShape::Numbers(columns),
    })
}

/// Headerless f32 pairs have no mark: accepted when every one of them lies in the unit square, unless they look like
/// text or like whole numbers.
fn looks_like_rps(bytes: &[u8]) -> Option<Format> {
    let values = || {
        bytes
            .chunks_exact(4)
            .map(|word| f32::from_le_bytes(array(word)))
    };
    // A file of 32-bit whole numbers is no such file: read as floats, those up to 897,988,541 are subnormal or at most
    // 1e-6.
    let in_unit = |value: f32| (0.0..=1.0).contains(&value) && !value.is_subnormal();
    let is_spread = || values().any(|value| value > 1e-6);
    let whole = !bytes.is_empty() && bytes.len().is_multiple_of(8);
    // Digits and spaces read as floats are small numbers and would pass, so text is excluded first.
    let text = |b: &u8| b.is_ascii_graphic() || b.is_ascii_whitespace();
    (whole && !bytes.iter().all(text) && values().all(in_unit) && is_spread())
        .then_some(Format::PsaRps)
}

impl Format {
    /// The format to write a file called `path` in: `asked` if there is one, or the one that its extension stands for.
    ///
    /// # Errors
    ///
    /// [`FormatError::UnknownFormat`] when neither gives a format, [`FormatError::Misnamed`] when the file would be
    /// read as another format.
    pub fn to_write(path: &Path, asked: Option<Self>) -> Result<Self, FormatError> {
        let name = || path.to_string_lossy().into_owned();
        let named = Self::from_path(path);
        let format =
            (asked.or(named)).ok_or_else(|| FormatError::UnknownFormat { name: name() })?;
        match named {
            Some(named) if !format.is_recognised_as(named) => Err(FormatError::Misnamed {
                name: name(),
                named,
                format,
            }),
            _ => Ok(format),
        }
    }

    /// Whether a file of this format is recognised under a name that stands for `named`.
    fn is_recognised_as(self, named: Self) -> bool {
        let marked = match self {
            // What this program writes in these formats begins with a mark, which decides under any name.
            Self::UtkBinary
            | Self::Npy
            | Self::PlyAscii
            | Self::PlyBinary
            | Self::GeoJson
            | Self::Svg => true,
            // JSON is taken for GeoJSON if its name says so.
            Self::Json => named != Self::GeoJson,
            Self::Csv | Self::PsaText | Self::PsaRps | Self::UtkText | Self::Xyz => false,
        };
        // Any table may be called .txt or .dat.
        let by_text = is_table(self) && matches!(named, Self::PsaText | Self::UtkText);
        marked || self == named || by_text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(bytes: &[u8], name: &str) -> (Format, Evidence) {
        let detection = detect(bytes, name.as_ref()).expect("recognisable");
        (detection.format, detection.evidence)
    }

    #[test]
    fn content_wins_over_a_wrong_name() {
        let against = Evidence::ContentAgainst(Format::Csv);
        assert_eq!(found(b"\x93NUMPY\x01", "a.csv"), (Format::Npy, against));
        assert_eq!(found(b"UTK!\x05", "a.csv"), (Format::UtkBinary, against));
        assert_eq!(found(b"{\"points\"", "a.csv"), (Format::Json, against));
        assert_eq!(found(b"{ \"type\":", "a.csv"), (Format::GeoJson, against));
        assert_eq!(found(b"<svg", "a.csv"), (Format::Svg, against));
        assert_eq!(
            found(b"0.5 0.5\n", "a.txt"),
            (Format::UtkText, Evidence::ContentAgainst(Format::PsaText))
        );
    }

    #[test]
    fn the_two_ply_share_an_extension() {
        let ascii = b"ply\nformat ascii 1.0\n";
        assert_eq!(
            found(ascii, "a.ply"),
            (Format::PlyAscii, Evidence::Extension)
        );
        let binary = b"ply\r\nformat binary_little_endian 1.0\r\n";
        assert_eq!(found(binary, ""), (Format::PlyBinary, Evidence::Content));
    }

    #[test]
    fn geojson_is_known_by_its_name_or_by_its_first_member() {
        let own = (Format::GeoJson, Evidence::Extension);
        assert_eq!(found(b"{\"type\": 1", "a.json"), own);
        assert_eq!(found(b"{\"bbox\": [1]", "a.geojson"), own);
        let json = (Format::Json, Evidence::Extension);
        assert_eq!(found(b"{\"bbox\": [1]", "a.json"), json);
    }

    #[test]
    fn nameless_text_is_known_by_its_columns() {
        assert_eq!(found(b"x,y\n", "").0, Format::Csv);
        assert_eq!(found(b"12\n0 0\n", "").0, Format::PsaText);
        assert_eq!(found(b"\xEF\xBB\xBF0 0\r\n", "").0, Format::UtkText);
        assert_eq!(found(b"# c\n0 0 0\n", "").0, Format::Xyz);
        let pair = [0.25_f32.to_le_bytes(), 0.5_f32.to_le_bytes()].concat();
        assert_eq!(found(&pair, "points").0, Format::PsaRps);
    }

    #[test]
    fn tables_are_known_by_what_they_hold_before_what_they_are_called() {
        for (name, text, format) in [
            ("a.txt", "0.5,0.25\n", Format::Csv),
            ("a.txt", "x,y\n0.5,0.25\n", Format::Csv),
            ("a.dat", "0,5;0,25\n", Format::Csv),
            ("a.dat", "X Y\n0.5 0.25\n", Format::Csv),
            ("a.txt", "east north\n0.5 0.25\n", Format::Csv),
            ("a.txt", "sep=;\n0.5;0.25\n", Format::Csv),
            ("a.txt", "# x y\n0.5 0.25\n", Format::UtkText),
            ("a.txt", "# y x\n0.5 0.25\n", Format::Csv),
            ("a.txt", "# y x\n# made by hand\n0.5 0.25\n", Format::Csv),
            ("a.txt", "# lon lat\n0.5 0.25\n", Format::Csv),
            ("a.txt", "0,5 0,25\n", Format::UtkText),
            ("a.txt", "1\n0.5 0.25\n", Format::PsaText),
            ("a.dat", "1\r\n0.5 0.25\r\n", Format::PsaText),
            ("a.txt", "1\n0.5 0.25 0 7\n", Format::Xyz),
            ("a.dat", "0.5 0.25 0 7\n", Format::Xyz),
            ("a.pts", "1\n0.5 0.25 0 7 8 9 10\n", Format::Xyz),
            ("a.PTS", "0.5 0.25\n", Format::Xyz),
            ("a.xyz", "//X Y Z\n0.5 0.25 0\n", Format::Xyz),
            ("a.tsv", "0.5\t0.25\n", Format::Csv),
            ("a.csv", "0.5 0.25\n", Format::Csv),
            ("a.csv", "hello", Format::Csv),
            ("a.txt", "hello", Format::PsaText),
            ("a", "x;y\n0.5;0.25\n", Format::Csv),
            ("a", "0.5;0.25\n", Format::Csv),
        ] {
            assert_eq!(found(text.as_bytes(), name).0, format, "{name}: {text}");
            let marked = std::iter::once(0xFEFF).chain(text.encode_utf16());
            let wide: Vec<u8> = marked.flat_map(u16::to_le_bytes).collect();
            assert_eq!(found(&wide, name).0, format, "{name} in UTF-16: {text}");
        }
        assert!(detect(b"", "a.pts".as_ref()).is_err());
        assert!(detect(b"east north\n1 2\n", "a".as_ref()).is_err());
    }

    #[test]
    fn what_is_nothing_known_is_refused() {
        for bytes in [&b""[..], b"hello world", b"\x00\xFF\xFF\xFF", b"1 2 3 4\n"] {
            assert!(detect(bytes, "picture.jpeg".as_ref()).is_err());
        }
    }

    #[test]
    fn whole_numbers_are_no_raw_floats() {
        let raw =
            |values: &[i32]| -> Vec<u8> { values.iter().flat_map(|v| v.to_le_bytes()).collect() };
        for values in [&[0, 1, 2, 3][..], &[0, 0], &[20_000_000, 30_000_000]] {
            let error = detect(&raw(values), "grid.raw".as_ref()).expect_err("whole numbers");
            assert!(matches!(error, FormatError::UnknownFormat { .. }));
        }
        let floats = [0.0_f32, 0.25, 1.0, 0.5].map(f32::to_le_bytes).concat();
        assert_eq!(found(&floats, "grid.raw").0, Format::PsaRps);
    }

    #[test]
    fn parquet_is_refused_by_name() {
        for name in ["points.parquet", "points.csv", ""] {
            let error = detect(b"PAR1\x15\x04\x15\xf0", name.as_ref()).expect_err(name);
            assert_eq!(
                error.to_string(),
                "Parquet and GeoParquet cannot be read here; the Python package reads them (tilescope.read)"
            );
        }
        assert_eq!(found(b"PAR1\x15\x04\x15\xf0", "a.rps").0, Format::PsaRps);
    }

    #[test]
    fn what_is_written_is_recognised_under_its_name() {
        let context = crate::export::ExportContext::new(
            tilescope_analysis::Region {
                width: 1.0,
                height: 1.0,
                boundary: tilescope_analysis::Boundary::Periodic,
            },
            0.5,
        );
        let set = crate::PointSet::from_points(vec![[0.25, 0.25], [0.75, 0.75]]);
        for format in Format::ALL {
            let name = format!("set.{}", format.extension());
            let context = crate::ExportContext {
                format: Some(format),
                ..context.clone()
            };
            let exported = crate::export_bytes(&name, &set, &context, &|_| {
                std::ops::ControlFlow::Continue(())
            });
            let bytes = exported.expect("a verdict").data;
            for other in Format::ALL {
                let name = format!("set.{}", other.extension());
                let found = crate::detect(&bytes, name.as_ref()).expect("its name tells");
                match Format::to_write(name.as_ref(), Some(format)) {
                    Ok(_) => assert_eq!(found.format, format, "{name}"),
                    Err(FormatError::Misnamed { .. }) => assert_ne!(found.format, format, "{name}"),
                    Err(error) => panic!("{error}"),
                }
            }
            assert_eq!(
                Format::to_write("set".as_ref(), Some(format)).ok(),
                Some(format)
            );
        }
        assert!(Format::to_write("set".as_ref(), None).is_err());
        let error = Format::to_write("y.npy".as_ref(), Some(Format::Csv)).expect_err("misnamed");
        assert_eq!(
            error.to_string(),
            "y.npy: CSV would be read as NumPy array, which the name stands for; call it .csv"
        );
    }
}
