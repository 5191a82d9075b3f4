//! The names of the formats and what each can carry.
//!
//! `detect` recognises the format of a file.

use std::fmt;
use std::path::Path;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// A point-set file format.
///
/// Layouts were read from the sources of psa (Schlömer & Deussen) and UTK (Coeurjolly, Ostromoukhov et al.), numpy's
/// format specification and the PLY description by Turk.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Format {
    /// `.csv`: header `x,y`, then a point a line.
    Csv,
    /// psa `.txt`: the number of points, then `x y` a line, in the unit torus.
    PsaText,
    /// psa `.rps`: no header, little-endian f32 pairs, in the unit torus.
    PsaRps,
    /// UTK `.dat`: `x y` a line, `#` between sets, in the unit torus.
    UtkText,
    /// UTK `.bin`: 20-byte header, then rows of f32 or f64, in the unit torus.
    UtkBinary,
    /// numpy `.npy`, shape (N, 2), f32 or f64.
    Npy,
    /// `.ply` as text: vertex x y z with z = 0, and the provenance when known.
    PlyAscii,
    /// `.ply`, binary little-endian: vertex x y z with z = 0, and the provenance when known.
    PlyBinary,
    /// `.xyz`: `x y z` a line with z = 0.
    Xyz,
    /// `.json`: positions with the certificate inside.
    Json,
    /// `.geojson`: a `FeatureCollection` of planar points, with level, rank and radius as properties where there are such.
    #[serde(rename = "geojson")]
    GeoJson,
    /// `.svg`: a circle for each point, in domain units, y downwards as SVG has it.
    Svg,
}

impl Format {
    /// Every format, in the order of the documentation.
    pub const ALL: [Self; 12] = [
        Self::Csv,
        Self::PsaText,
        Self::PsaRps,
        Self::UtkText,
        Self::UtkBinary,
        Self::Npy,
        Self::PlyAscii,
        Self::PlyBinary,
        Self::Xyz,
        Self::Json,
        Self::GeoJson,
        Self::Svg,
    ];

    /// The format that the extension of `path` stands for, whatever its case; `.ply` is the binary one.
    ///
    /// ```
    /// use tilescope_formats::Format;
    /// assert_eq!(Format::from_path("set.NPY".as_ref()), Some(Format::Npy));
    /// assert_eq!(Format::from_path("set.jpeg".as_ref()), None);
    /// ```
    #[must_use]
    pub fn from_path(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        if extension == "ply" {
            return Some(Self::PlyBinary);
        }
        Self::ALL.into_iter().find(|f| f.extension() == extension)
    }

    /// The short name, the extension, and the name in sentences.
    const fn names(self) -> [&'static str; 3] {
        match self {
            Self::Csv => ["csv", "csv", "CSV"],
            Self::PsaText => ["psa-text", "txt", "psa text"],
            Self::PsaRps => ["psa-rps", "rps", "psa RPS"],
            Self::UtkText => ["utk-text", "dat", "UTK text"],
            Self::UtkBinary => ["utk-binary", "bin", "UTK binary"],
            Self::Npy => ["npy", "npy", "NumPy array"],
            Self::PlyAscii => ["ply-ascii", "ply", "PLY (ASCII)"],
            Self::PlyBinary => ["ply-binary", "ply", "PLY (binary)"],
            Self::Xyz => ["xyz", "xyz", "XYZ"],
            Self::Json => ["json", "json", "JSON"],
            Self::GeoJson => ["geojson", "geojson", "GeoJSON"],
            Self::Svg => ["svg", "svg", "SVG"],
        }
    }

    /// The short name used on command lines and in certificates, such as `psa-text`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.names()[0]
    }

    /// The file extension, lower case, without the dot.
    #[must_use]
    pub const fn extension(self) -> &'static str {
        self.names()[1]
    }

    /// Whether positions are of the unit torus: a file holds them divided by the region's width.
    #[must_use]
    pub fn is_unit_torus(self) -> bool {
        matches!(
            self,
            Self::PsaText | Self::PsaRps | Self::UtkText | Self::UtkBinary
        )
    }

    /// Whether the format stores a [`Provenance`](crate::Provenance) beside each position.
    #[must_use]
    pub fn carries_provenance(self) -> bool {
        matches!(self, Self::PlyAscii | Self::PlyBinary | Self::Json)
    }

    /// Whether files of nested levels have the rank of each sample, in a column or as a property.
    #[must_use]
    pub fn carries_ranks(self) -> bool {
        matches!(
            self,
            Self::Csv | Self::PlyAscii | Self::PlyBinary | Self::GeoJson
        )
    }

    /// Whether files can be written and read here while the points pass by: they are a head and then a row for each
    /// point.
    #[must_use]
    pub fn streams(self) -> bool {
        matches!(
            self,
            Self::Csv | Self::PsaRps | Self::UtkBinary | Self::Npy | Self::PlyBinary
        )
    }

    /// The number type that is written when `wished` is wanted: text is always f64 (shortest round-trip decimals),
    /// psa's `.rps` always f32, other binary formats as wanted.
    #[must_use]
    pub fn precision(self, wished: Precision) -> Precision {
        match self {
            Self::PsaRps => Precision::Single,
            Self::UtkBinary | Self::Npy | Self::PlyBinary => wished,
            _ => Precision::Double,
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.names()[2])
    }
}

/// A name that is not a format's.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "no file format is called \"{0}\"; the names are csv, psa-text, psa-rps, utk-text, utk-binary, npy, ply-ascii, ply-binary, xyz, json, geojson and svg"
)]
pub struct UnknownFormatName(pub String);

impl FromStr for Format {
    type Err = UnknownFormatName;

    fn from_str(name: &str) -> Result<Self, UnknownFormatName> {
        Self::ALL
            .into_iter()
            .find(|format| format.name() == name)
            .ok_or_else(|| UnknownFormatName(name.to_owned()))
    }
}

/// The number type of a coordinate in a file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Precision {
    /// 32-bit floats: positions are rounded to 24 significant bits.
    #[serde(rename = "f32")]
    Single,
    /// 64-bit floats: positions are kept to the bit.
    #[default]
    #[serde(rename = "f64")]
    Double,
}

impl Precision {
    /// Bytes of one coordinate.
    #[must_use]
    pub fn bytes(self) -> usize {
        match self {
            Self::Single => 4,
            Self::Double => 8,
        }
    }
}

impl fmt::Display for Precision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Single => "f32",
            Self::Double => "f64",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_back_to_their_format() {
        for format in Format::ALL {
            assert_eq!(format.name().parse(), Ok(format));
            let json = serde_json::to_string(&format).expect("a plain name");
            assert_eq!(json, format!("\"{}\"", format.name()));
        }
        let error = "jpeg".parse::<Format>().expect_err("not a point set");
        for format in Format::ALL {
            assert!(error.to_string().contains(format.name()));
        }
    }

    #[test]
    fn extensions_lead_back_to_their_format_but_for_ascii_ply() {
        for format in Format::ALL {
            let path = format!("some.folder/set.{}", format.extension());
            let found = Format::from_path(path.as_ref());
            let expected = match format {
                Format::PlyAscii => Format::PlyBinary,
                other => other,
            };
            assert_eq!(found, Some(expected));
        }
        assert_eq!(Format::from_path("csv".as_ref()), None);
    }
}
