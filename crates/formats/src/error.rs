//! Errors of point-set files, with one variant for each cause.
//!
//! Each message names the format, the place, the value found and the expected one. Quoted tokens are cut to a bounded
//! length.

use std::fmt;

use tilescope_analysis::Number;

use crate::format::Format;

/// A place in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FilePlace {
    /// A line, counted from 1.
    Line(u64),
    /// A byte offset from the start of the file.
    Offset(u64),
    /// A point, counted from 0.
    Point(u64),
}

impl fmt::Display for FilePlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(n) => write!(f, "line {n}"),
            Self::Offset(n) => write!(f, "byte {n}"),
            Self::Point(n) => write!(f, "point {n}"),
        }
    }
}

/// Why bytes are not a readable point set, or a point set cannot be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FormatError {
    /// A file could not be read or written.
    #[error("{path}: {source}")]
    Io {
        /// The path of the file.
        path: String,
        /// The error that the system reported.
        source: std::io::Error,
    },
    /// A file is too large to be read into memory.
    #[error("{path}: {bytes} bytes exceed the limit of {limit} for what is read into memory")]
    TooLarge {
        /// The path of the file.
        path: String,
        /// Its bytes, or more than are allowed.
        bytes: u64,
        /// The most that are read.
        limit: u64,
    },
    /// There is no memory for the content of a file.
    #[error(
        "{path}: there is no memory for its {bytes} bytes; close other programs or use a machine with more"
    )]
    NoMemory {
        /// The path of the file.
        path: String,
        /// The length of the file in bytes.
        bytes: u64,
    },
    /// Another writer is at work on the same file.
    #[error(
        "{path}: this or another process is writing it; wait until it ends, or choose another name"
    )]
    Busy {
        /// The file that is being written.
        path: String,
    },
    /// The path of an output names something other than a regular file.
    #[error("{path}: this is {kind}; give the name of a file, which is made or replaced")]
    NotAFile {
        /// The path as it was given.
        path: String,
        /// What it names instead, as messages have it.
        kind: &'static str,
    },
    /// A file is to be written in a format that would not be recognised under its name.
    #[error("{name}: {format} would be read as {named}, which the name stands for; call it .{}", .format.extension())]
    Misnamed {
        /// The name of the file.
        name: String,
        /// The format that the name stands for.
        named: Format,
        /// The format asked for.
        format: Format,
    },
    /// Neither the name nor the content says what the file is.
    #[error(
        "the format of \"{name}\" is known neither from its extension nor from its content{}",
        of_archive(name)
    )]
    UnknownFormat {
        /// The name that was given, possibly empty.
        name: String,
    },
    /// The file is one that another tool reads.
    #[error(
        "Parquet and GeoParquet cannot be read here; the Python package reads them (tilescope.read)"
    )]
    Parquet,
    /// The positions of a `GeoJSON` file seem to be degrees: they fit, and reach beyond the domain.
    #[error(
        "GeoJSON: point {index} at ({x}, {y}) lies beyond the domain, {width} x {height}, and all points lie within 180 \
         and 90, as longitudes and latitudes do: distances in degrees are not those of a plane; project the points to a \
         plane first, in metres for instance"
    )]
    Degrees {
        /// The index of the first point beyond the domain.
        index: usize,
        /// The first coordinate of that point, as the file has it.
        x: f64,
        /// The second coordinate of that point, as the file has it.
        y: f64,
        /// Width of the domain.
        width: f64,
        /// Height of the domain.
        height: f64,
    },
    /// A format of the unit torus cannot hold positions with an origin.
    #[error(
        "{format} holds positions of the unit torus, which begins at 0 0; csv, npy, ply, xyz, json, geojson and svg hold an origin"
    )]
    OriginOfTorus {
        /// The format that was asked for.
        format: Format,
    },
    /// Floating-point numbers around an origin are too far apart for the radius. The radius that the message asks for
    /// is 5 % above the least, so that it suffices however it is rounded to two digits.
    #[error(
        "at the origin {origin} numbers ({precision}) are {spacing:.1e} apart, more than {limit} of the radius {}: rounded \
         to them, samples would no longer keep their distance and cover; an origin nearer to 0, or a radius of at least \
         {:.1e}, would do", Number(*.radius), 1.05 * spacing / limit
    )]
    OriginTooFar {
        /// The position in the file of the region's lower corner, in words.
        origin: String,
        /// Number type of the coordinates.
        precision: crate::format::Precision,
        /// How far apart numbers of that type are there, in domain units.
        spacing: f64,
        /// The sampling radius, in domain units.
        radius: f64,
        /// The largest spacing allowed, in radii.
        limit: f64,
    },
    /// The file does not begin as its format must.
    #[error("{format}: the file does not begin with {expected}")]
    Magic {
        /// The format being read.
        format: Format,
        /// What its first bytes must be.
        expected: &'static str,
    },
    /// A header is malformed.
    #[error("{format}: header, {place}: {reason}")]
    Header {
        /// The format being read.
        format: Format,
        /// Where in the file.
        place: FilePlace,
        /// The fault, with the value found.
        reason: String,
    },
    /// The file is not of its format's syntax.
    #[error("{format}: {place}: {reason}")]
    Malformed {
        /// The format being read.
        format: Format,
        /// Where in the file.
        place: FilePlace,
        /// The fault, in words, with the value found.
        reason: String,
    },
    /// The file is well-formed but of a kind that is not supported.
    #[error("{format}: {what} cannot be read; {supported}")]
    Unsupported {
        /// The format being read.
        format: Format,
        /// What the file has.
        what: String,
        /// What can be read instead.
        supported: &'static str,
    },
    /// A token is not a number.
    #[error("{format}: {place}: \"{token}\" is not a number")]
    NotANumber {
        /// The format being read.
        format: Format,
        /// Where in the file.
        place: FilePlace,
        /// The token, cut to 40 characters.
        token: String,
    },
    /// A number has a decimal comma.
    #[error(
        "{format}: {place}: \"{token}\" has a decimal comma; numbers must have decimal points, as 0.5 has"
    )]
    DecimalComma {
        /// The format being read.
        format: Format,
        /// Where in the file.
        place: FilePlace,
        /// The token, cut to 40 characters.
        token: String,
    },
    /// A coordinate is NaN or infinite, or became so by rounding to f32.
    #[error("{format}: {place}: the coordinate {value} is not a finite number")]
    NotFinite {
        /// The format being read or written.
        format: Format,
        /// Where in the file, or at which point of the set.
        place: FilePlace,
        /// The value as it was read, or as rounding left it.
        value: f64,
    },
    /// A line has too few or too many columns.
    #[error("{format}: {place}: {found} columns where {expected} are needed")]
    Columns {
        /// The format being read.
        format: Format,
        /// The place of the row in the file.
        place: FilePlace,
        /// The number of columns in that row.
        found: usize,
        /// The number of columns that each row must have.
        expected: usize,
    },
    /// A row of a table cannot be read, or could be read in two ways.
    #[error("{format}: {place}: {reason}")]
    Row {
        /// The format being read.
        format: Format,
        /// The place of the row in the file.
        place: FilePlace,
        /// The fault, with the value found and what would do instead.
        reason: String,
    },
    /// Columns were chosen in a file that is no table of text.
    #[error("{format}: columns can be chosen in text tables only, in which each line has a point")]
    NoColumns {
        /// The format being read.
        format: Format,
    },
    /// Points cannot be chosen from a file of this format, or not in the way asked for.
    #[error("{format}: points cannot be chosen from it: {reason}")]
    NotChosen {
        /// The format of the file.
        format: Format,
        /// Why, and what would do.
        reason: &'static str,
    },
    /// A third coordinate is not zero, so the set is not planar.
    #[error("{format}: {place}: z is {z}, and only planar sets (z = 0) are read")]
    NotPlanar {
        /// The format being read.
        format: Format,
        /// The place of the position in the file.
        place: FilePlace,
        /// The third coordinate, which is not 0.
        z: f64,
    },
    /// A format cannot hold sets in space.
    #[error(
        "{format} holds no third coordinate: {reason}; ply, npy, csv, xyz, utk-binary (.bin) and utk-text (.dat) hold sets in space"
    )]
    NoThird {
        /// The format that was asked for.
        format: Format,
        /// Why the format holds no third coordinate.
        reason: &'static str,
    },
    /// The file states a number of points and holds another.
    #[error("{format}: the file states {stated} points and holds {found}")]
    Count {
        /// The format being read.
        format: Format,
        /// The number that the header states.
        stated: u64,
        /// The number that is there.
        found: u64,
    },
    /// The data ends earlier than the header states.
    #[error(
        "{format}: truncated: {needed} bytes are needed from byte {offset} on and {available} are there"
    )]
    Truncated {
        /// The format being read.
        format: Format,
        /// Where the missing piece begins.
        offset: u64,
        /// Bytes which the header implies (saturating).
        needed: u64,
        /// Bytes which are there.
        available: u64,
    },
    /// Bytes follow the last point.
    #[error("{format}: {extra} bytes follow the last point, at byte {offset}")]
    Trailing {
        /// The format being read.
        format: Format,
        /// Where the surplus begins.
        offset: u64,
        /// The number of surplus bytes.
        extra: u64,
    },
    /// The set has no points.
    #[error("{format}: the set has no points")]
    Empty {
        /// The format being read or written.
        format: Format,
    },
    /// The file holds several sets and none was chosen, or the chosen one does not exist.
    #[error("{format}: the file holds {}", several(*.found, *.chosen))]
    Sets {
        /// The format being read.
        format: Format,
        /// Sets in the file.
        found: usize,
        /// The set asked for, counted from 0.
        chosen: Option<usize>,
    },
    /// JSON that does not parse as a point-set document.
    #[error("JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// A certificate that does not parse.
    #[error("the certificate {name} is not readable: {reason}")]
    Certificate {
        /// The certificate's file name, or "inside the file".
        name: String,
        /// The fault, in words.
        reason: String,
    },
    /// A certificate that is not that of the file beside or around it.
    #[error("the certificate {name} is not true: {difference}")]
    FalseCertificate {
        /// The certificate's file name, or "inside the file".
        name: String,
        /// The first statement that does not hold, in words.
        difference: String,
    },
    /// Provenance whose length is not the number of points.
    #[error("{found} provenance entries for {points} points")]
    Provenance {
        /// The number of entries of provenance.
        found: usize,
        /// The number of points in the set.
        points: usize,
    },
    /// Ranks of another number than the points'.
    #[error("{found} ranks for {points} points")]
    Ranks {
        /// The number of ranks.
        found: usize,
        /// The number of points in the set.
        points: usize,
    },
    /// A column, or a list beside that of points, with another number of entries than there are points.
    #[error("{found} entries of {name} for {points} points")]
    Column {
        /// The name of the column.
        name: &'static str,
        /// The number of entries.
        found: usize,
        /// The number of points in the set.
        points: usize,
    },
    /// A rank that no sample can have.
    #[error("a rank is {}; it must be at least 0 and below 1", Number(*.rank))]
    Rank {
        /// The rank.
        rank: f64,
    },
    /// A radius or region that cannot be written or used.
    #[error("{name} is {}; it must be finite and above 0", Number(*.value))]
    Parameter {
        /// The name of the parameter, as messages have it.
        name: &'static str,
        /// The value that was refused.
        value: f64,
    },
    /// More points than the format's counter holds.
    #[error("{format}: {points} points are more than the format can count ({limit})")]
    TooMany {
        /// The format being written.
        format: Format,
        /// The number of points in the set.
        points: usize,
        /// The largest number it can state.
        limit: u64,
    },
}

/// An error of the file system.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn io_error(path: &std::path::Path, source: std::io::Error) -> FormatError {
    FormatError::Io {
        path: path.display().to_string(),
        source,
    }
}

/// Returns how many sets there are, which one was chosen and how one is chosen.
fn several(found: usize, chosen: Option<usize>) -> String {
    let was = chosen.map_or_else(|| "none".to_owned(), |set| set.to_string());
    match found {
        1 => format!("one set, which is set 0; {was} was chosen"),
        _ => format!(
            "{found} sets, 0 to {}, and {was} was chosen; choose one by --set I (verify, analyze, convert, draw) or set=I (Python)",
            found - 1
        ),
    }
}

/// Bytes of a file as a short printable quotation for a message.
pub(crate) fn quote(bytes: &[u8]) -> String {
    const MAX_QUOTED: usize = 40;
    // A character has at most four bytes.
    let cut = &bytes[..bytes.len().min(4 * MAX_QUOTED)];
    let text = String::from_utf8_lossy(cut);
    let mut quoted: String = text
        .chars()
        .take(MAX_QUOTED)
        .flat_map(char::escape_debug)
        .collect();
    if text.chars().count() > MAX_QUOTED || cut.len() < bytes.len() {
        quoted.push_str("...");
    }
    quoted
}

/// Returns a hint for files that look like archives.
fn of_archive(name: &str) -> &'static str {
    let extension = std::path::Path::new(name).extension();
    if extension.is_some_and(|extension| extension.eq_ignore_ascii_case("zip")) {
        "; an archive has to be unpacked first"
    } else {
        ""
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quotations_are_short_and_printable() {
        assert_eq!(quote(b"abc"), "abc");
        assert_eq!(quote(b"a\x00\n"), "a\\0\\n");
        assert_eq!(quote(&[b'x'; 1000]).len(), 43);
        assert!(!quote(&[0xFF; 3]).is_empty());
    }

    #[test]
    fn messages_name_value_place_and_limit() {
        let error = FormatError::Columns {
            format: Format::Csv,
            place: FilePlace::Line(3),
            found: 1,
            expected: 2,
        };
        assert_eq!(
            error.to_string(),
            "CSV: line 3: 1 columns where 2 are needed"
        );
        let sets = FormatError::Sets {
            format: Format::UtkText,
            found: 3,
            chosen: None,
        };
        assert_eq!(
            sets.to_string(),
            "UTK text: the file holds 3 sets, 0 to 2, and none was chosen; choose one by --set I (verify, analyze, convert, draw) or set=I (Python)"
        );
        let beyond = FormatError::Sets {
            format: Format::Csv,
            found: 1,
            chosen: Some(4),
        };
        assert_eq!(
            beyond.to_string(),
            "CSV: the file holds one set, which is set 0; 4 was chosen"
        );
    }
}
