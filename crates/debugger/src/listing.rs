//! The pseudocode listings: lines with ids, explanations and errata, read from `assets/pseudocode`. Events refer to
//! lines by number; breakpoints and saved sessions by id, which is stable.

use std::sync::LazyLock;

use tilescope_core::{Boundary, Parameters, Search};

/// The number of a line among all listings.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize,
)]
pub struct LineId(pub u8);

/// Reads and writes a [`LineId`] as the id of its line among the shipped listings, which is stable: for
/// `#[serde(with = "...")]`.
pub mod by_id {
    use serde::de::Error as _;
    use serde::{Deserialize, Deserializer, Serializer};

    use super::{LineId, Listings};

    /// Writes the id of a line, such as `eliminate.3`.
    pub fn serialize<S: Serializer>(line: &LineId, to: S) -> Result<S::Ok, S::Error> {
        match Listings::shipped().line(*line) {
            Some(line) => to.serialize_str(&line.id),
            None => Err(serde::ser::Error::custom("no such line of pseudocode")),
        }
    }

    /// Reads the id of a line; unknown ones are refused by name.
    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<LineId, D::Error> {
        let id = String::deserialize(from)?;
        let unknown = || D::Error::custom(format!("there is no line \"{id}\" of pseudocode"));
        Listings::shipped().find(&id).ok_or_else(unknown)
    }
}

/// A line of pseudocode.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ListingLine {
    /// Its stable id, such as `eliminate.3`.
    pub id: String,
    /// How far it is indented.
    pub indentation: u32,
    /// The text, with [`REACH`] as a placeholder.
    text: String,
    /// One sentence that explains it.
    pub explanation: String,
    /// An error or omission of the paper in this line.
    pub erratum: Option<String>,
}

/// The placeholder for the search radius of detection.
const REACH: &str = "{reach}";

impl ListingLine {
    /// Returns the text of the line for these parameters.
    #[must_use]
    pub fn text(&self, parameters: &Parameters) -> String {
        let reach = match (parameters.search, parameters.boundary) {
            (Search::TwoRadii, _) => "2r",
            (Search::Complete, Boundary::Periodic) => "4r",
            (Search::Complete, Boundary::Bounded) => "4r, near a border 7r",
        };
        self.text.replace(REACH, reach)
    }
}

/// A listing of pseudocode: a title and numbered lines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Listing {
    /// Its name: that of its file.
    pub name: String,
    /// Its title, as shown above it.
    pub title: String,
    /// The numbers of its lines.
    pub lines: std::ops::Range<u8>,
}

/// Several listings, whose lines are numbered through.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Listings {
    /// The listings, in the order of the stages.
    pub listings: Vec<Listing>,
    lines: Vec<ListingLine>,
}

/// An error in a listing's text.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ListingError {
    /// It does not begin with a title.
    #[error("listing {name} does not begin with \"# title\"")]
    NoTitle {
        /// The listing's name, that of its file.
        name: String,
    },
    /// A line does not have four or five parts, the first two of them numbers, or its text is empty.
    #[error(
        "listing {name}: \"{line}\" is not \"number | indentation | text | explanation | erratum\""
    )]
    BadLine {
        /// The listing's name, that of its file.
        name: String,
        /// The line as it is written.
        line: String,
    },
    /// There are more than 255 lines.
    #[error("more than 255 lines of pseudocode")]
    TooMany,
}

/// Names a listing, and includes its text.
macro_rules! listing {
    ($name:literal) => {
        (
            $name,
            include_str!(concat!("../../../assets/pseudocode/", $name, ".txt")),
        )
    };
}

const TEXTS: [(&str, &str); 10] = [
    listing!("blocks"),
    listing!("tile"),
    listing!("printed"),
    listing!("gaps"),
    listing!("eliminate"),
    listing!("detect"),
    listing!("insert"),
    listing!("darts"),
    listing!("exact"),
    listing!("finish"),
];

const REFERENCE: (&str, &str) = listing!("reference");

// Tests parse both, so that the defaults are never used.
static COMPARISON: LazyLock<Listings> =
    LazyLock::new(|| Listings::parse(&[REFERENCE]).unwrap_or_default());

static SHIPPED: LazyLock<Listings> = LazyLock::new(|| Listings::parse(&TEXTS).unwrap_or_default());

impl Listings {
    /// Returns the listings that come with the program.
    #[must_use]
    pub fn shipped() -> &'static Self {
        &SHIPPED
    }

    /// Returns the reference sampler's listing, to be shown beside the others. No event names its lines, and their
    /// numbers are its own.
    #[must_use]
    pub fn comparison() -> &'static Self {
        &COMPARISON
    }

    /// Returns the listings of texts, each with its name. Lines are numbered through all of them.
    pub fn parse(texts: &[(&str, &str)]) -> Result<Self, ListingError> {
        let mut all = Self::default();
        for &(name, text) in texts {
            let mut rows = text.lines().filter(|row| !row.trim().is_empty());
            let head = rows.next().and_then(|row| row.strip_prefix("# "));
            let title = head.ok_or_else(|| ListingError::NoTitle { name: name.into() })?;

            let first = all.lines.len();
            for row in rows {
                let line = parse_line(name, row).ok_or_else(|| ListingError::BadLine {
                    name: name.into(),
                    line: row.into(),
                })?;
                all.lines.push(line);
            }

            // An event has one byte for the number of its line.
            let byte = |n: usize| u8::try_from(n).map_err(|_| ListingError::TooMany);
            all.listings.push(Listing {
                name: name.into(),
                title: title.into(),
                lines: byte(first)?..byte(all.lines.len())?,
            });
        }

        Ok(all)
    }

    /// Returns all lines, by number.
    #[must_use]
    pub fn lines(&self) -> &[ListingLine] {
        &self.lines
    }

    /// Returns a line of these listings.
    #[must_use]
    pub fn line(&self, id: LineId) -> Option<&ListingLine> {
        self.lines.get(usize::from(id.0))
    }

    /// Returns the number of the line with a stable id.
    #[must_use]
    pub fn find(&self, id: &str) -> Option<LineId> {
        let index = self.lines.iter().position(|line| line.id == id)?;
        Some(LineId(index as u8))
    }
}

/// Reads a line of a listing: its number, indentation, text and explanation, and an erratum if there is one. `None`
/// if it has fewer than four or more than five parts, if the number or the indentation is no number, or if the text
/// is empty.
fn parse_line(name: &str, row: &str) -> Option<ListingLine> {
    let parts: Vec<&str> = row.split(" | ").map(str::trim).collect();
    let (&[number, indentation, text, explanation], rest) = parts.split_first_chunk()?;
    let number: u32 = number.parse().ok()?;
    if rest.len() > 1 || text.is_empty() {
        return None;
    }
    Some(ListingLine {
        id: format!("{name}.{number}"),
        indentation: indentation.parse().ok()?,
        text: text.into(),
        explanation: explanation.into(),
        erratum: rest.first().map(|&erratum| erratum.to_owned()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_line_has_an_id_of_its_own_and_one_sentence_of_explanation() {
        let listings = Listings::parse(&TEXTS).unwrap();
        let ids: BTreeSet<&str> = listings
            .lines()
            .iter()
            .map(|line| line.id.as_str())
            .collect();
        assert_eq!(ids.len(), listings.lines().len());
        for line in listings.lines() {
            assert!(line.explanation.ends_with('.'), "{}", line.id);
            assert_eq!(listings.line(listings.find(&line.id).unwrap()), Some(line));
        }
        assert!(listings.lines().iter().any(|line| line.erratum.is_some()));
    }

    #[test]
    fn the_reference_sampler_is_told_apart_from_what_is_executed() {
        let listings = Listings::parse(&[REFERENCE]).unwrap();
        assert_eq!(&listings, Listings::comparison());
        assert_eq!(listings.listings.len(), 1);
        assert_eq!(listings.lines().len(), 10);
        for line in listings.lines() {
            assert!(line.explanation.ends_with('.'), "{}", line.id);
            assert_eq!(Listings::shipped().find(&line.id), None);
        }
    }

    #[test]
    fn a_broken_listing_is_refused_by_name() {
        let error = Listings::parse(&[("x", "# X\n1 | 0 | text")]).unwrap_err();
        assert_eq!(
            error.to_string(),
            "listing x: \"1 | 0 | text\" is not \"number | indentation | text | explanation | erratum\""
        );
        let error = Listings::parse(&[("x", "1 | 0 | text | why.")]).unwrap_err();
        assert_eq!(error, ListingError::NoTitle { name: "x".into() });
    }
}
