//! Detects the format of some bytes by extension, then by content, and says on what evidence. Also checks that a file
//! is not written in a format that readers would take for another because of its name.
//!
//! A file that begins with a format's own mark is of that format whatever its name says. Only
//! its beginning is parsed; whether the rest is valid shows on decoding.

use std::fmt;
use std::path::Path;

use crate::binary::array;
use crate::error::FormatError;
use crate::format::Format;
use crate::text::{data_lines, lines, without_bom, words};

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
    /// The format.
    pub format: Format,
    /// The evidence.
    pub evidence: Evidence,
}

impl Detection {
    /// The format that the caller insists on, or that [`detect`] finds.
    pub(crate) fn of(bytes: &[u8], path: &Path, told: Option<Format>) -> Result<Self, FormatError> {
        let evidence = Evidence::Told;
        told.map_or_else(
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
    let named = Format::from_path(path);
    // Raw numbers may begin with any bytes.
    if bytes.starts_with(PARQUET_MAGIC) && named != Some(Format::PsaRps) {
        return Err(FormatError::Parquet);
    }
    let marked = by_mark(bytes);
    let found = match (named, marked) {
        (Some(named), Some(marked)) if same_family(named, marked) => (marked, Evidence::Extension),
        (Some(named), Some(marked)) => (marked, Evidence::ContentAgainst(named)),
        (Some(Format::PsaText), None) => psa_or_utk_text(bytes),
        (Some(named), None) => (named, Evidence::Extension),
        (None, Some(marked)) => (marked, Evidence::Content),
        (None, None) => {
            let shape = by_text_shape(bytes).or_else(|| looks_like_rps(bytes));
            let unknown = || FormatError::UnknownFormat {
                name: path.to_string_lossy().into_owned(),
            };
            (shape.ok_or_else(unknown)?, Evidence::Content)
        }
    };
    Ok(Detection {
        format: found.0,
        evidence: found.1,
    })
}

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
    // A raw f32 file may begin with any byte, so for these two marks more of the text is checked.
    let text = without_bom(bytes).trim_ascii_start();
    let second = text.get(1..).unwrap_or_default().trim_ascii_start().first();
    match (text.first()?, second?) {
        (b'{', b'"' | b'}') | (b'[', b'[' | b']') => Some(Format::Json),
        (b'<', b'?' | b's' | b'!') => Some(Format::Svg),
        _ => None,
    }
}

/// `.txt` is psa's extension, but files of plain `x y` lines often have it, too.
fn psa_or_utk_text(bytes: &[u8]) -> (Format, Evidence) {
    let columns = data_lines(bytes)
        .next()
        .map_or(0, |(_, line)| words(line).count());
    if columns == 2 {
        return (Format::UtkText, Evidence::ContentAgainst(Format::PsaText));
    }
    (Format::PsaText, Evidence::Extension)
}

/// The text format whose columns the first line has.
fn by_text_shape(bytes: &[u8]) -> Option<Format> {
    let (_, line) = data_lines(bytes).next()?;
    let text = std::str::from_utf8(line).ok()?;
    if text.contains(|c: char| c.is_control() && !c.is_whitespace()) {
        return None;
    }
    if text.contains(',') {
        return Some(Format::Csv);
    }
    if !words(line).all(|w| std::str::from_utf8(w).is_ok_and(|w| w.parse::<f64>().is_ok())) {
        return None;
    }
    match words(line).count() {
        1 => Some(Format::PsaText),
        2 => Some(Format::UtkText),
        3 => Some(Format::Xyz),
        _ => None,
    }
}

/// Headerless f32 pairs have no mark: accepted when every one of them lies in the unit square.
fn looks_like_rps(bytes: &[u8]) -> Option<Format> {
    let values = || {
        bytes
            .chunks_exact(4)
            .map(|word| f32::from_le_bytes(array(word)))
    };
    // Whole numbers of 32 bits read as floats give subnormal ones, or at most very small ones.
    let in_unit = |value: f32| (0.0..=1.0).contains(&value) && !value.is_subnormal();
    let is_spread = || values().any(|value| value > 1e-6);
    let whole = !bytes.is_empty() && bytes.len().is_multiple_of(8);
    // Text read as floats gives tiny numbers and would pass, so it is excluded first.
    let text = |b: &u8| b.is_ascii_graphic() || b.is_ascii_whitespace();
    (whole && !bytes.iter().all(text) && values().all(in_unit) && is_spread())
        .then_some(Format::PsaRps)
}

impl Format {
    /// The format to write a file called `path` in: `told`, or the one that its extension stands for.
    ///
    /// # Errors
    ///
    /// [`FormatError::UnknownFormat`] when neither gives a format, [`FormatError::Misnamed`] when the file would be
    /// read as another format.
    pub fn to_write(path: &Path, told: Option<Self>) -> Result<Self, FormatError> {
        let name = || path.to_string_lossy().into_owned();
        let named = Self::from_path(path);
        let format = (told.or(named)).ok_or_else(|| FormatError::UnknownFormat { name: name() })?;
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
        let marked = matches!(
            self,
            Self::UtkBinary | Self::Npy | Self::PlyAscii | Self::PlyBinary | Self::Json | Self::Svg
        );
        // Files of two numbers a line are often called .txt, too.
        marked || self == named || (self, named) == (Self::UtkText, Self::PsaText)
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
    fn nameless_text_is_known_by_its_columns() {
        assert_eq!(found(b"x,y\n", "").0, Format::Csv);
        assert_eq!(found(b"12\n0 0\n", "").0, Format::PsaText);
        assert_eq!(found(b"\xEF\xBB\xBF0 0\r\n", "").0, Format::UtkText);
        assert_eq!(found(b"# c\n0 0 0\n", "").0, Format::Xyz);
        let pair = [0.25_f32.to_le_bytes(), 0.5_f32.to_le_bytes()].concat();
        assert_eq!(found(&pair, "points").0, Format::PsaRps);
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
