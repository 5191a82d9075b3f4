//! The parts of version 2: what a certificate states of a set that is more than points of one radius in a rectangle at 0 0.
//! [`Certificate`](super::Certificate) lists them.
//!
//! Readers refuse parts that they cannot read, and parts that they can read but not judge, each by its name: a
//! statement that is passed over would be lost from the next certificate of the same points.

use std::borrow::Cow;
use std::fmt::{self, Display};
use std::ops::RangeInclusive;

use serde::de::{DeserializeOwned, Error};
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Map, Value};
use tilescope_analysis::Region;

use super::Distinct;
use crate::digest::bytes_digest;

/// A part with a value of its own.
pub(super) trait Part: DeserializeOwned {
    /// The name of its field in the certificate.
    const NAME: &'static str;

    /// Returns the limit that the value breaks, if it breaks one.
    fn broken_limit(&self) -> Option<&'static str>;
}

/// An origin; beside a depth there is none, and later versions may state a third number.
impl Part for [f64; 2] {
    const NAME: &'static str = "origin";

    fn broken_limit(&self) -> Option<&'static str> {
        (!self.iter().all(|at| at.is_finite())).then_some("it must be finite")
    }
}

/// The third side of the region, in domain units. The region's boundary is that of all sides.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Depth(pub f64);

impl Part for Depth {
    const NAME: &'static str = "depth";

    fn broken_limit(&self) -> Option<&'static str> {
        (!EXTENTS.contains(&self.0)).then_some("a side must be from 2^-100 to 2^100")
    }
}

/// The part of the region that is to be covered, and that all points lie in. Coordinates are in domain units, as positions in
/// the file: with the origin added, if there is one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum CertifiedShape {
    /// The places around which the rings wind an odd number of times, and the places on the rings: a ring within another one is
    /// a hole.
    Polygon {
        /// The corners of each ring, in order; the last one is joined to the first.
        rings: Vec<Vec<[f64; 2]>>,
    },
    /// The pixels of an image that are set, beginning at the region's lower corner.
    Mask {
        /// [`bytes_digest`](crate::bytes_digest) of the mask.
        digest: String,
        /// The side of a pixel.
        pitch: f64,
    },
}

impl CertifiedShape {
    /// Whether two shapes have the same places whatever they are judged in: of a polygon neither the direction nor the first
    /// corner of a ring matters, nor the sequence of rings.
    pub(crate) fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Polygon { rings }, Self::Polygon { rings: others }) => {
                rings == others || edges(rings) == edges(others)
            }
            (Self::Mask { .. }, Self::Mask { .. }) => self == other,
            (Self::Polygon { .. }, Self::Mask { .. })
            | (Self::Mask { .. }, Self::Polygon { .. }) => false,
        }
    }

    /// Returns the digest of a polygon, equal for two that are the same, or that of a mask.
    pub(crate) fn digest(&self) -> Cow<'_, str> {
        match self {
            Self::Mask { digest, .. } => digest.into(),
            Self::Polygon { rings } => {
                let mut bytes = b"tilescope polygon\n".to_vec();
                let numbers = edges(rings).into_iter().flatten().flatten();
                bytes.extend(numbers.flat_map(u64::to_le_bytes));
                bytes_digest(&bytes).into()
            }
        }
    }
}

/// Returns the edges of rings by the bits of their ends, the smaller end first, in an order of their own: by the even-odd rule
/// they have all that matters of a polygon.
fn edges(rings: &[Vec<[f64; 2]>]) -> Vec<[[u64; 2]; 2]> {
    let of_ring = |ring: &Vec<[f64; 2]>| {
        // Adding 0 turns -0 into 0, which is the same place.
        let corners: Vec<[u64; 2]> = (ring.iter())
            .map(|corner| corner.map(|at| (at + 0.0).to_bits()))
            .collect();
        let next = corners.iter().cycle().skip(1);
        let ends = corners.iter().zip(next);
        ends.map(|(&from, &to)| [from.min(to), from.max(to)])
            .collect::<Vec<_>>()
    };
    let mut edges: Vec<_> = rings.iter().flat_map(of_ring).collect();
    edges.sort_unstable();
    edges
}

/// A triangle is the simplest ring with an inside.
const MIN_CORNERS: usize = 3;

impl Part for CertifiedShape {
    const NAME: &'static str = "shape";

    fn broken_limit(&self) -> Option<&'static str> {
        match self {
            Self::Polygon { rings } if rings.is_empty() => Some("a polygon has at least one ring"),
            Self::Polygon { rings } => (rings.iter().any(|ring| ring.len() < MIN_CORNERS))
                .then_some("a ring has at least 3 corners"),
            Self::Mask { digest, pitch } => broken_raster(digest, *pitch),
        }
    }
}

/// The radius that the verdict is about.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum CertifiedRadius {
    /// One radius for the whole region.
    Constant(f64),
    /// Another one at each place.
    Field(RadiusField),
    /// Another one for each point, as a column of the file has it.
    Column(RadiusColumn),
}

impl CertifiedRadius {
    /// The only radius, or the least.
    #[must_use]
    pub const fn least(&self) -> f64 {
        match self {
            Self::Constant(radius) => *radius,
            Self::Field(field) => field.least,
            Self::Column(column) => column.least,
        }
    }

    /// The only radius, or the greatest.
    #[must_use]
    pub const fn greatest(&self) -> f64 {
        match self {
            Self::Constant(radius) => *radius,
            Self::Field(field) => field.greatest,
            Self::Column(column) => column.greatest,
        }
    }

    /// Whether it depends on the place or on the point.
    #[must_use]
    pub const fn varies(&self) -> bool {
        match self {
            Self::Constant(_) => false,
            Self::Field(_) | Self::Column(_) => true,
        }
    }
}

impl fmt::Display for CertifiedRadius {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Constant(radius) => radius.fmt(f),
            Self::Field(field) => write!(
                f,
                "{} to {}, a field with nodes {} apart and the digest {}",
                field.least, field.greatest, field.pitch, field.digest
            ),
            Self::Column(column) => write!(
                f,
                "{} to {}, the column {}",
                column.least, column.greatest, column.column
            ),
        }
    }
}

/// A radius that depends on the place: numbers at the nodes of a grid, and between them bilinear. Density and relative radius
/// are then those of the least radius, and the covering radius is not measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RadiusField {
    /// Which of two radii counts.
    pub rule: RadiusRule,
    /// [`bytes_digest`](crate::bytes_digest) of the field, which has the number of its nodes and its unit in its head.
    pub digest: String,
    /// The distance between nodes, in domain units.
    pub pitch: f64,
    /// The least radius at a node.
    pub least: f64,
    /// The greatest radius at a node.
    pub greatest: f64,
}

impl Part for RadiusField {
    const NAME: &'static str = "radius";

    fn broken_limit(&self) -> Option<&'static str> {
        broken_order(self.least, self.greatest).or_else(|| broken_raster(&self.digest, self.pitch))
    }
}

/// A radius for each point of a thinned set, from a column or a property of its file. Density and relative radius are then those
/// of the least radius. The file's own digest is that of the radii, too.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RadiusColumn {
    /// Which of two radii counts.
    pub rule: RadiusRule,
    /// The name of the column, or its number from 1.
    pub column: String,
    /// The least radius of a point in the file.
    pub least: f64,
    /// The greatest radius of a point in the file.
    pub greatest: f64,
}

impl Part for RadiusColumn {
    const NAME: &'static str = "radius";

    fn broken_limit(&self) -> Option<&'static str> {
        if self.column.is_empty() {
            return Some("the column has no name");
        }
        broken_order(self.least, self.greatest)
    }
}

/// Returns the limit broken by the least and the greatest of some radii.
fn broken_order(least: f64, greatest: f64) -> Option<&'static str> {
    let are_ordered = 0.0 < least && least <= greatest;
    (!(are_ordered && greatest.is_finite()))
        .then_some("the least radius must be above 0, and no more than the greatest")
}

/// How near two places of different radii may be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RadiusRule {
    /// The harmonic mean of the two radii.
    HarmonicMean,
}

/// The set is the beginning of a larger one that was maximal: the points that are left out were added last.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CertifiedPrefix {
    /// How many points were made.
    pub made: u64,
    /// How many of them the set has.
    pub kept: u64,
    /// The factor of the radius within which they cover, as measured.
    pub factor: f64,
}

impl Part for CertifiedPrefix {
    const NAME: &'static str = "prefix";

    fn broken_limit(&self) -> Option<&'static str> {
        let Self { made, kept, factor } = *self;
        if !(1..=made).contains(&kept) {
            return Some("from 1 to `made` points are kept");
        }
        // Points that cover within less would be a set of a smaller radius.
        (!(1.0..f64::INFINITY).contains(&factor)).then_some("the factor must be at least 1")
    }
}

/// The points were chosen from another set: each, in the order of the priority, that was near none chosen before it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Thinned {
    /// [`positions_digest`](crate::positions_digest) of that set.
    pub source: String,
    /// How many points it has.
    pub given: u64,
    /// In which order its points were taken: a word, and what belongs to it. This crate does not interpret it.
    pub priority: String,
}

impl Part for Thinned {
    const NAME: &'static str = "thinned";

    fn broken_limit(&self) -> Option<&'static str> {
        if self.given == 0 {
            return Some("at least one point is given");
        }
        if self.priority.is_empty() {
            return Some("the priority has no name");
        }
        (!is_digest(&self.source)).then_some(DIGEST_LIMIT)
    }
}

/// The sides that the verifier accepts.
const EXTENTS: RangeInclusive<f64> = Region::MIN_EXTENT..=Region::MAX_EXTENT;

const DIGEST_LIMIT: &str = "a digest is `blake3:` and 64 hexadecimal digits";

fn is_digest(text: &str) -> bool {
    let is_digit = |c: u8| matches!(c, b'0'..=b'9' | b'a'..=b'f');
    (text.strip_prefix("blake3:"))
        .is_some_and(|digits| digits.len() == 64 && digits.bytes().all(is_digit))
}

/// Returns the limit broken by values at the nodes, or the pixels, of a grid.
fn broken_raster(digest: &str, pitch: f64) -> Option<&'static str> {
    if !is_digest(digest) {
        return Some(DIGEST_LIMIT);
    }
    (!EXTENTS.contains(&pitch)).then_some("the pitch must be from 2^-100 to 2^100")
}

/// What a field is called beside other parts: the radius itself is none.
pub(super) const FIELD: &str = "radius that varies";

/// Says of a part that it is understood, but that no judge could confirm it beside a third side.
pub(super) fn beyond_judging(part: &str) -> String {
    format!(
        "the certificate has the part `{part}` beside `depth`: this version can judge each, but not both together"
    )
}

/// Reads a part. A fault of it names the part, its value and the limit.
pub(super) fn part<'de, D: Deserializer<'de>, T: Part>(from: D) -> Result<Option<T>, D::Error> {
    let Distinct(value) = Distinct::deserialize(from)?;
    let fault = |limit: &dyn Display| {
        // A polygon may have thousands of corners.
        let (name, value) = (T::NAME, abridged(&value.to_string()));
        D::Error::custom(format_args!("`{name}` is {value}: {limit}"))
    };

    let part = T::deserialize(&value).map_err(|error| fault(&error))?;
    match part.broken_limit() {
        Some(limit) => Err(fault(&limit)),
        None => Ok(Some(part)),
    }
}

/// The longest text of a value in a message, in characters.
const MAX_SHOWN: usize = 120;

fn abridged(text: &str) -> String {
    match text.char_indices().nth(MAX_SHOWN) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text.to_owned(),
    }
}

/// Reads the radius: a number, a field or a column.
pub(super) fn radius<'de, D: Deserializer<'de>>(from: D) -> Result<CertifiedRadius, D::Error> {
    let Distinct(value) = Distinct::deserialize(from)?;
    if !value.is_object() {
        let radius = f64::deserialize(value).map_err(D::Error::custom)?;
        return Ok(CertifiedRadius::Constant(radius));
    }
    // `part` returns an option for the fields that may be left out. For a value that is there, it is never `None`.
    let missing = || D::Error::custom("`radius` is missing");
    // A field has no member of this name.
    if value.get("column").is_some() {
        let column: Option<RadiusColumn> = part(value).map_err(D::Error::custom)?;
        return column.map(CertifiedRadius::Column).ok_or_else(missing);
    }
    let field: Option<RadiusField> = part(value).map_err(D::Error::custom)?;
    field.map(CertifiedRadius::Field).ok_or_else(missing)
}

/// The fields that a certificate has besides those it may have: none, as any is refused by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct NoOther;

impl<'de> Deserialize<'de> for NoOther {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let others = Map::<String, Value>::deserialize(from)?;
        match others.keys().next() {
            Some(name) => Err(D::Error::custom(format_args!(
                "the certificate has the part `{}`, which this version does not know",
                abridged(name)
            ))),
            None => Ok(Self),
        }
    }
}

#[cfg(test)]
mod tests;
