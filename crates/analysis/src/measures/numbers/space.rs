//! The catalogue of the numbers of a set in space at a moment of its run. Keys are those of planar sets where the number is the same
//! but for the dimension.

use serde::{Deserialize, Serialize};

use super::{PLAIN as PLANAR, SetNumber};
use crate::measures::measured::{MeasuredSet, Part};

/// The numbers of a set in space, kept while its samples come and go. Lengths are in radii.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidMoment {
    /// The volume of the box, in cubed radii.
    pub volume: f64,
    /// Conflicts and the smallest distance, once they are followed to this moment.
    pub pairs: Option<SolidMomentPairs>,
    /// How many cubes throw a dart in the throw at work; 0 where none is.
    pub active_cubes: u32,
}

/// What the distances between samples in space say.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidMomentPairs {
    /// Pairs of samples closer than r.
    pub conflicts: u64,
    /// The smallest distance between two samples; infinite if there is none.
    #[serde(with = "crate::report::finite_or_null")]
    pub min_distance: f64,
}

/// A number with the fields that most numbers of sets in space share.
const PLAIN: SetNumber = SetNumber {
    is_in_space: true,
    ..PLANAR
};

/// The numbers of a set in space at a moment, in the sequence of tables.
pub static SPACE_CATALOGUE: &[SetNumber] = &[
    SetNumber {
        key: "samples",
        name: "samples N",
        short: Some("Samples"),
        value: |set| Some(set.samples as f64),
        meaning: "The samples of the set. At a moment of a run these are the samples that have arrived.",
        ..PLAIN
    },
    SetNumber {
        key: "density",
        name: "density",
        short: Some("Density N r\u{b3}/V"),
        unit: "N r\u{b3} / volume",
        decimals: 4,
        value: |set| Some(set.samples as f64 / set.space?.volume),
        meaning: "Samples times r\u{b3}, divided by the volume: 0.7336 for maximal sets by dart throwing in a large periodic box.",
        ..PLAIN
    },
    SetNumber {
        key: "min_distance_r",
        name: "smallest distance",
        short: Some("Smallest distance, r"),
        unit: "r",
        decimals: 6,
        needs: Some(Part::Report),
        value: |set| Some(set.space?.pairs?.min_distance),
        meaning: "The smallest distance between two samples, or of a sample from its copy around a periodic box.",
        ..PLAIN
    },
    SetNumber {
        key: "conflicts",
        name: "conflicts",
        short: Some("Conflicts"),
        unit: "pairs",
        needs: Some(Part::Report),
        value: |set| Some(set.space?.pairs?.conflicts as f64),
        meaning: "Pairs of samples closer than r. A dart that would make one is not kept, so that there are none.",
        ..PLAIN
    },
    SetNumber {
        key: "relative_radius",
        name: "relative radius",
        short: Some("Relative radius"),
        unit: "r_max",
        decimals: 4,
        needs: Some(Part::Report),
        value: relative_radius,
        meaning: "The smallest distance, divided by that of the densest packing of as many samples.",
        ..PLAIN
    },
    SetNumber {
        key: "active_cubes",
        name: "active cubes",
        short: Some("Active cubes"),
        unit: "cubes",
        value: |set| Some(set.space?.active_cubes.into()),
        meaning: "The cubes that throw a dart in the throw at work: those that no single sample covers. None before the first throw and after the last.",
        ..PLAIN
    },
];

/// Returns the number of sets in space with a key.
#[must_use]
pub fn space_number(key: &str) -> Option<&'static SetNumber> {
    SPACE_CATALOGUE.iter().find(|number| number.key == key)
}

/// Returns the smallest distance in those of the close packing, whose balls are the root of 2 to a cubed distance.
fn relative_radius(set: &MeasuredSet) -> Option<f64> {
    let space = set.space?;
    let packed = (2f64.sqrt() * space.volume / set.samples as f64).cbrt();
    Some(space.pairs?.min_distance / packed)
}
