//! The certificate: a JSON document with the contents of a point-set file and the verdict on it.
//!
//! Written beside a data file as `<file>.certificate.json`, and inside a JSON point set. Every number in it is measured
//! on the positions read back from the file.

mod parts;

use std::collections::BTreeMap;
use std::fmt;

use serde::de::{Error, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Map, Value};
use tilescope_analysis::{Judge, PrefixClaim, PrefixReport, Region};

pub(crate) use self::parts::NoOther;
use self::parts::Part;
use crate::error::FormatError;
use crate::format::{Format, Precision};
use crate::indented::indented;

pub use self::parts::{
    CertifiedPrefix, CertifiedRadius, CertifiedShape, Depth, RadiusColumn, RadiusField, RadiusRule,
    Thinned,
};

/// The highest version that this crate reads. It is written for sets with a part of it, such as an origin, which
/// programs that read version 1 alone would take for other sets; version 1 is written for all others.
pub const CERTIFICATE_FORMAT_VERSION: u32 = 2;

/// The version of certificates that have a part.
const WITH_PARTS: u32 = 2;

/// The suffix that makes a certificate's file name from the data file's name.
pub const CERTIFICATE_SUFFIX: &str = ".certificate.json";

/// The largest certificate file read, 16 MiB. One is about 2 KiB; the rest is room for parameters and for a polygon of 100,000
/// corners, each of which takes about 50 bytes, and took 100 before. A data file given in its place by mistake is refused before it is parsed.
pub const MAX_CERTIFICATE_BYTES: usize = 16 << 20;

/// How storing changed the positions.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Rounding {
    /// The largest change of a coordinate, in domain units, around the torus when periodic.
    pub largest_shift: f64,
    /// Whether a set that was conflict-free before has conflicts now.
    pub made_conflicts: bool,
    /// Whether a set that was maximal before has gaps now.
    pub made_gaps: bool,
    /// The same in a sentence.
    pub note: String,
}

/// The first points of a file of nested levels, as measured. Lengths are in domain units.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CertifiedLevel {
    /// How many points there are to the end of the level.
    pub count: u64,
    /// No two of them are to be closer than this.
    pub distance: f64,
    /// No place is to be farther from them than this, but for the tolerance; null where that is not promised.
    #[serde(deserialize_with = "stated")]
    pub covering: Option<f64>,
    /// Smallest distance between two of them; null for a single point of a bounded region.
    #[serde(deserialize_with = "stated")]
    pub min_distance: Option<f64>,
    /// Radius of the largest empty circle centred in the region.
    pub covering_radius: f64,
    /// Whether distance and covering are as stated.
    pub valid: bool,
}

impl CertifiedLevel {
    /// Returns the level as a judge found it, with its claim.
    #[must_use]
    pub fn of(found: &PrefixReport) -> Self {
        Self {
            count: found.claim.count as u64,
            distance: found.claim.distance,
            covering: found.claim.covering,
            min_distance: finite(found.report.min_distance),
            covering_radius: found.report.covering_radius,
            valid: found.valid(),
        }
    }

    /// Returns the claim about these points.
    #[must_use]
    pub fn claim(&self) -> PrefixClaim {
        PrefixClaim {
            count: usize::try_from(self.count).unwrap_or(usize::MAX),
            distance: self.distance,
            covering: self.covering,
        }
    }
}

/// What a point-set file holds, how it was made and what the verifier found. Lengths are in domain units.
///
/// Every field must be there when one is read, null where it may be, and no others; only [`Self::levels`] and the parts
/// of version 2 may be left out:
///
/// | part | states | left out |
/// |---|---|---|
/// | `origin` | `[x, y]`, where the file holds the region's lower corner | 0 0 |
/// | `depth` | a third side of the region, see [`Depth`] | the set is planar |
/// | `shape` | which part of the region is to be covered, see [`CertifiedShape`] | all of it |
/// | `radius` | an object, where the radius varies, see [`RadiusField`] and [`RadiusColumn`] | a number, as in version 1 |
/// | `prefix` | that the set is the beginning of a larger one, see [`CertifiedPrefix`] | it is whole |
/// | `thinned` | that its points were chosen from another set, see [`Thinned`] | they were not |
/// | `judges` | `subdivision`: squares or cubes, cut until each is seen to be covered | it may not be |
///
/// A set with a third side has no other part but a prefix or `thinned`. A prefix is judged where there is a third side, a shape or a radius
/// that varies; other certificates with one are refused.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Certificate {
    /// Version of this document's layout, see [`CERTIFICATE_FORMAT_VERSION`].
    pub format_version: u32,
    /// The name of the program that wrote the file.
    pub program: String,
    /// The version of that program.
    pub program_version: String,
    /// The name of the sampling method.
    pub method: String,
    /// The seed and every other parameter of the method, by name.
    #[serde(deserialize_with = "distinct")]
    pub parameters: BTreeMap<String, Value>,
    /// The region of the positions.
    pub region: Region,
    /// The position in the file of the region's lower corner, in version 2; version 1 has none, and positions begin at 0 0.
    #[serde(
        default,
        deserialize_with = "parts::part",
        skip_serializing_if = "Option::is_none"
    )]
    pub origin: Option<[f64; 2]>,
    /// A third side of the region, in version 2.
    #[serde(
        default,
        deserialize_with = "parts::part",
        skip_serializing_if = "Option::is_none"
    )]
    pub depth: Option<Depth>,
    /// The part of the region that is to be covered, in version 2; all of it if none is stated.
    #[serde(
        default,
        deserialize_with = "parts::part",
        skip_serializing_if = "Option::is_none"
    )]
    pub shape: Option<CertifiedShape>,
    /// The sampling radius, which in version 2 may vary.
    #[serde(deserialize_with = "parts::radius")]
    pub radius: CertifiedRadius,
    /// Relative tolerance of maximality used by the verifier.
    pub covering_tolerance: f64,
    /// The number of points in the file.
    pub count: u64,
    /// Smallest distance between two points; null for a single point of a bounded region.
    #[serde(deserialize_with = "stated")]
    pub min_distance: Option<f64>,
    /// Radius of the largest empty circle, or ball, centred in the region; null for a set of a shape, of a radius that
    /// varies or chosen from another one, whose judges do not measure it.
    #[serde(deserialize_with = "stated")]
    pub covering_radius: Option<f64>,
    /// Pairs closer than the radius; [`MAX_CONFLICTS`](tilescope_analysis::MAX_CONFLICTS) stand for that many or more.
    pub conflicts: u64,
    /// Places where a point could be added.
    pub gaps: u64,
    /// `N r^2 / area`; with a third side `N r^3 / volume`.
    pub density: f64,
    /// `min_distance / r_max`; null where `min_distance` is.
    #[serde(deserialize_with = "stated")]
    pub relative_radius: Option<f64>,
    /// The verdict: conflict-free and maximal; of a prefix, conflict-free and covering within its factor.
    pub valid: bool,
    /// The judges that gave this verdict.
    pub judges: Vec<Judge>,
    /// The levels, if the file holds nested levels: each with its guarantee for all points to its end.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub levels: Vec<CertifiedLevel>,
    /// That the set is the beginning of a larger one, in version 2.
    #[serde(
        default,
        deserialize_with = "parts::part",
        skip_serializing_if = "Option::is_none"
    )]
    pub prefix: Option<CertifiedPrefix>,
    /// That the points were chosen from another set, in version 2.
    #[serde(
        default,
        deserialize_with = "parts::part",
        skip_serializing_if = "Option::is_none"
    )]
    pub thinned: Option<Thinned>,
    /// The data file's name when it was written, without folders.
    pub file: String,
    /// The format of the data file.
    pub file_format: Format,
    /// Number type of its coordinates.
    pub precision: Precision,
    /// Domain length of one unit of the file: the region's width in unit-torus formats, otherwise 1.
    pub scale: f64,
    /// The seed of the order in which the points were written, if they were shuffled.
    #[serde(deserialize_with = "stated")]
    pub shuffle_seed: Option<u64>,
    /// How storing changed the positions; null when all are stored exactly.
    #[serde(deserialize_with = "stated")]
    pub rounding: Option<Rounding>,
    /// [`positions_digest`](crate::positions_digest) of the file coordinates in the file's order.
    pub positions_digest: String,
    /// [`bytes_digest`](crate::bytes_digest) of the data file; null inside the file it would have to contain.
    #[serde(deserialize_with = "stated")]
    pub digest: Option<String>,
    /// Every other field, all of which are refused.
    #[serde(flatten, skip_serializing)]
    pub(crate) others: NoOther,
}

/// Read before the rest, so that a certificate of a newer version is reported as such.
#[derive(Deserialize)]
struct Version {
    format_version: u32,
}

impl Certificate {
    /// The certificate in `bytes`, which come from a file called `name`.
    ///
    /// # Errors
    ///
    /// [`FormatError::Certificate`] when it is too large, of a newer version or not JSON, when it lacks a field, has an
    /// unknown one, has one twice or has one of another type, when `digest` or `covering_radius` is null and must not
    /// be, and when it has a part that its version lacks or that this program cannot judge.
    pub fn from_bytes(bytes: &[u8], name: &str) -> Result<Self, FormatError> {
        let fault = |reason: String| FormatError::Certificate {
            name: name.to_owned(),
            reason,
        };

        // A data file that is given in a certificate's place by mistake may have any size, and is not parsed.
        if bytes.len() > MAX_CERTIFICATE_BYTES {
            let length = bytes.len();
            let reason = format!("{length} bytes exceed the limit of {MAX_CERTIFICATE_BYTES}");
            return Err(fault(reason));
        }

        // The version is read first, by itself: otherwise fields of a newer version would be reported as unknown.
        let bytes = crate::text::without_bom(bytes);
        let version: Version = serde_json::from_slice(bytes).map_err(|e| fault(e.to_string()))?;
        refuse_unknown_version(version.format_version, name)?;
        let stated: Self = serde_json::from_slice(bytes).map_err(|e| fault(e.to_string()))?;
        stated.check_version(name)?;

        // A certificate beside a file states the file's digest. Only one inside its file cannot.
        if stated.digest.is_none() {
            return Err(fault(
                "`digest` is null, which it may be only inside a JSON file".to_owned(),
            ));
        }
        Ok(stated)
    }

    /// The parameters that the certificate states a second time, as its region, depth or radius: each with its name,
    /// the field under which a difference of the two is reported, and the value of the region, depth or radius. Only a
    /// set of one radius has a parameter `radius`, which is then the least.
    pub(crate) fn known_parameters(&self) -> Vec<(&'static str, &'static str, Value)> {
        let region = &self.region;
        let depth = self
            .depth
            .map(|Depth(depth)| ("depth", "parameters.depth", depth.into()));
        let planar = [
            ("width", "parameters.width", region.width.into()),
            ("height", "parameters.height", region.height.into()),
            ("radius", "parameters.radius", self.radius.least().into()),
            (
                "boundary",
                "parameters.boundary",
                serde_json::to_value(region.boundary).unwrap_or_default(),
            ),
        ];
        planar.into_iter().chain(depth).collect()
    }

    /// Returns the fields that a check does not compare with the file: how the set was made, by whom it was judged, the
    /// file's name when it was written, and how storing changed the positions.
    #[must_use]
    pub fn unchecked(&self) -> Vec<String> {
        // Parameters stated a second time, as the region or the radius, are compared with that statement.
        let known = self.known_parameters();
        let is_known = |name: &str| known.iter().any(|&(other, ..)| other == name);
        let parameters = (self.parameters.keys())
            .filter(|name| !is_known(name))
            .map(|name| format!("parameters.{name}"));

        let shuffled = self.shuffle_seed.map(|_| "shuffle_seed");
        let rounded = self.rounding.as_ref().map(|_| "rounding");
        let made = self.prefix.map(|_| "prefix.made");
        (["program", "program_version", "method", "file", "judges"].into_iter())
            .chain(shuffled)
            .chain(rounded)
            .chain(made)
            .map(str::to_owned)
            .chain(parameters)
            .collect()
    }

    /// Returns the claims about the points to the end of each level.
    #[must_use]
    pub fn claims(&self) -> Vec<PrefixClaim> {
        self.levels.iter().map(CertifiedLevel::claim).collect()
    }

    /// Returns the claim about the first `count` points that follows from the stated levels; `None` if there are no levels, or
    /// fewer points.
    #[must_use]
    pub fn prefix(&self, count: usize) -> Option<PrefixClaim> {
        PrefixClaim::within(&self.claims(), count)
    }

    /// Returns the density of the given number of points in the region.
    pub(crate) fn implied_density(&self, count: u64) -> f64 {
        let (radius, area) = (self.radius.least(), self.region.area());
        match self.depth {
            None => count as f64 * radius.powi(2) / area,
            Some(Depth(depth)) => count as f64 * radius.powi(3) / (area * depth),
        }
    }

    /// Whether the radius varies or a shape is to be covered, which a reader has to take into account.
    #[must_use]
    pub const fn is_varying(&self) -> bool {
        self.shape.is_some() || self.radius.varies()
    }

    /// Whether its judge only counts faults, and measures neither the smallest distance nor the covering radius.
    pub(crate) const fn is_counted(&self) -> bool {
        self.is_varying() || self.thinned.is_some()
    }

    /// Refuses a certificate with a third side for a reader of planar sets.
    pub(crate) fn refuse_depth(&self, name: &str) -> Result<(), FormatError> {
        let Some(Depth(depth)) = self.depth else {
            return Ok(());
        };
        Err(FormatError::Certificate {
            name: name.to_owned(),
            reason: format!(
                "its set has a third side, {depth}, which is not taken into account here; `tilescope verify`, `convert` and \
                 `draw --slice` do"
            ),
        })
    }

    /// Refuses a certificate of a thinned set, of a varying radius or of a shape, for a reader that can judge only sets
    /// of one radius that cover a rectangle.
    pub(crate) fn refuse_varying(&self, name: &str) -> Result<(), FormatError> {
        let what = if self.thinned.is_some() {
            "its points were chosen from another set"
        } else if self.is_varying() {
            "its radius varies or it has a shape"
        } else {
            return Ok(());
        };
        Err(FormatError::Certificate {
            name: name.to_owned(),
            reason: format!(
                "{what}, which is not taken into account here; `tilescope verify` and `tilescope draw` do"
            ),
        })
    }

    /// Returns the certificate with the version that its parts need. A certificate without parts is of
    /// version 1, which programs from before version 2 read as well.
    pub(crate) fn with_version(self) -> Self {
        let has_parts = self.parts().next().is_some();
        Self {
            format_version: if has_parts { WITH_PARTS } else { 1 },
            ..self
        }
    }

    /// Returns the names of the parts of version 2 that it states.
    fn parts(&self) -> impl Iterator<Item = &'static str> {
        let parts = [
            (<[f64; 2]>::NAME, self.origin.is_some()),
            (Depth::NAME, self.depth.is_some()),
            (CertifiedShape::NAME, self.shape.is_some()),
            (parts::FIELD, self.radius.varies()),
            (CertifiedPrefix::NAME, self.prefix.is_some()),
            (Thinned::NAME, self.thinned.is_some()),
        ];
        (parts.into_iter()).filter_map(|(part, is_stated)| is_stated.then_some(part))
    }

    /// Returns a part that is stated beside a third side, although no judge of sets in space takes it into account.
    fn beside_depth(&self) -> Option<&'static str> {
        self.depth?;
        let levels = Some("levels").filter(|_| !self.levels.is_empty());
        let judged = [Depth::NAME, CertifiedPrefix::NAME, Thinned::NAME];
        let is_other = |part: &&str| !judged.contains(part);
        self.parts().find(is_other).or(levels)
    }

    /// Refuses a certificate of a newer version, one that has a part in version 1 or none in version 2, one without a
    /// covering radius that judges measure, and one with a part that no judge of this program takes into account.
    pub(crate) fn check_version(&self, name: &str) -> Result<(), FormatError> {
        let version = self.format_version;
        refuse_unknown_version(version, name)?;

        let reason = match self.parts().next() {
            // Programs of version 1 would pass the part over, and take the set for another one: positions with an
            // origin, for example, for positions in the domain.
            Some(part) if version < WITH_PARTS => format!("version {version} has no {part}"),
            // Without a part the certificate is written in version 1, see `with_version`.
            None if version >= WITH_PARTS => {
                format!("version {version} needs an origin, or another part that version 1 lacks")
            }
            _ if self.covering_radius.is_none() && !self.is_counted() => {
                "`covering_radius` is null, which it may be only where the radius varies, where there is a shape or in a \
                 thinned set"
                    .to_owned()
            }
            // The factor of a prefix is measured by subdivision, which judges only varying radii, shapes and sets in
            // space.
            _ if self.prefix.is_some() && !self.is_varying() && self.depth.is_none() => {
                "it has the part `prefix`, which is judged only where the radius varies, where there is a shape or a third side"
                    .to_owned()
            }
            // Only the judge of thinned sets reads a column of the file: a radius of each point does not give places a radius.
            _ if matches!(self.radius, CertifiedRadius::Column(_)) && self.thinned.is_none() => {
                "its radii are those of a column, which are judged only in a thinned set".to_owned()
            }
            // If the part were passed over, the next certificate of these points would lack it.
            _ => match self.beside_depth() {
                Some(part) => parts::beyond_judging(part),
                None => return Ok(()),
            },
        };
        Err(FormatError::Certificate {
            name: name.to_owned(),
            reason,
        })
    }

    /// The certificate as the bytes of its file: indented JSON, with each corner of a polygon on one line, and a final newline.
    ///
    /// # Errors
    ///
    /// [`FormatError::Json`] should serialisation fail, which plain data do not.
    pub fn to_bytes(&self) -> Result<Vec<u8>, FormatError> {
        let mut bytes = indented(self)?;
        bytes.push(b'\n');
        Ok(bytes)
    }
}

/// Reads a field that may be null but not be left out, as serde's own reading of an `Option` allows.
fn stated<'de, D: Deserializer<'de>, T: Deserialize<'de>>(from: D) -> Result<Option<T>, D::Error> {
    Option::deserialize(from)
}

/// Reads parameters, none of them twice: readers differ in which of two they would take.
fn distinct<'de, D: Deserializer<'de>>(from: D) -> Result<BTreeMap<String, Value>, D::Error> {
    let Distinct(value) = Distinct::deserialize(from)?;
    match value {
        Value::Object(parameters) => Ok(parameters.into_iter().collect()),
        other => Err(D::Error::custom(format_args!(
            "`parameters` is {other}, which is no object"
        ))),
    }
}

/// A JSON value in which no object has a name twice.
struct Distinct(Value);

impl<'de> Deserialize<'de> for Distinct {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(DistinctVisitor).map(Self)
    }
}

struct DistinctVisitor;

impl<'de> Visitor<'de> for DistinctVisitor {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a JSON value")
    }

    fn visit_unit<E>(self) -> Result<Value, E> {
        Ok(Value::Null)
    }

    fn visit_bool<E>(self, value: bool) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_u64<E>(self, value: u64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_i64<E>(self, value: i64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_f64<E>(self, value: f64) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_str<E>(self, value: &str) -> Result<Value, E> {
        Ok(value.into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Value, A::Error> {
        let mut values = Vec::new();
        while let Some(Distinct(value)) = list.next_element()? {
            values.push(value);
        }
        Ok(Value::Array(values))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut object: A) -> Result<Value, A::Error> {
        let mut values = Map::new();
        while let Some((name, Distinct(value))) = object.next_entry::<String, _>()? {
            if values.contains_key(&name) {
                return Err(A::Error::custom(format_args!("duplicate field `{name}`")));
            }
            values.insert(name, value);
        }
        Ok(Value::Object(values))
    }
}

fn refuse_unknown_version(found: u32, name: &str) -> Result<(), FormatError> {
    if (1..=CERTIFICATE_FORMAT_VERSION).contains(&found) {
        return Ok(());
    }
    Err(FormatError::Certificate {
        name: name.to_owned(),
        reason: format!(
            "its format_version is {found}; this program reads 1 to {CERTIFICATE_FORMAT_VERSION}"
        ),
    })
}

/// JSON has no infinity; an infinite value becomes null.
pub(crate) fn finite(value: f64) -> Option<f64> {
    Some(value).filter(|v| v.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_are_named() {
        let message = |text: &str| {
            let error = Certificate::from_bytes(text.as_bytes(), "a.certificate.json");
            error.expect_err(text).to_string()
        };
        assert!(message("{").contains("a.certificate.json is not readable: EOF"));
        assert!(message("{\"format_version\": 3}").contains("format_version is 3"));
        assert!(message("{\"format_version\": 1}").contains("missing field `program`"));
        let large = " ".repeat(MAX_CERTIFICATE_BYTES + 1);
        assert!(message(&large).contains("exceed the limit"));
    }
}
