//! The catalogue of the numbers that describe a set. `tilescope analyze`, the window, Python, the expressions of lessons and the
//! glossary read it; a number that stands here appears in all of them. How one is computed is in the modules of its measure;
//! those that only read a spectrum are in the modules below this one.

mod rings;
mod slope;
mod space;

use super::distances::NearestDistances;
use super::measured::{MeasuredSet, Part};
use super::order::Order;

pub use space::{SPACE_CATALOGUE, SolidMoment, SolidMomentPairs, space_number};

/// A number that describes a set.
#[derive(Clone, Copy, Debug)]
pub struct SetNumber {
    /// Its name in JSON, CSV, Python and the expressions of lessons.
    pub key: &'static str,
    /// Its name in tables, as it is written within a sentence.
    pub name: &'static str,
    /// Its name in the narrow table of the window; `None` if that has no row for it.
    pub short: Option<&'static str>,
    /// Its unit; empty for a number without one.
    pub unit: &'static str,
    /// Decimals in tables; none for counts.
    pub decimals: usize,
    /// What it means, in one or two sentences.
    pub meaning: &'static str,
    /// The part of the measures that it is read from, its cost; `None` if it costs nothing.
    pub needs: Option<Part>,
    /// Whether it is of sets in space.
    is_in_space: bool,
    /// Reads the number from the measures of a set.
    value: fn(&MeasuredSet) -> Option<f64>,
}

impl SetNumber {
    /// Returns this number of a set; `None` if it is not defined for the set, not finite, or not yet measured. A planar number is
    /// not defined for a set in space, nor one of these for a planar set.
    #[must_use]
    pub fn of(&self, set: &MeasuredSet) -> Option<f64> {
        if set.space.is_some() != self.is_in_space {
            return None;
        }
        (self.value)(set).filter(|value| value.is_finite())
    }
}

/// Returns the number with a key.
///
/// ```
/// use tilescope_analysis::measures::number;
///
/// assert_eq!(number("density").unwrap().decimals, 4);
/// assert!(number("Density").is_none());
/// ```
#[must_use]
pub fn number(key: &str) -> Option<&'static SetNumber> {
    CATALOGUE.iter().find(|number| number.key == key)
}

/// A number with the fields that most numbers share.
const PLAIN: SetNumber = SetNumber {
    key: "",
    name: "",
    short: None,
    unit: "",
    decimals: 0,
    meaning: "",
    needs: None,
    is_in_space: false,
    value: |_| None,
};

/// Makes the catalogue of its rows, each with some fields of [`SetNumber`].
macro_rules! catalogue {
    ($({ $($field:ident: $value:expr),* $(,)? })*) => {
        /// All numbers, in the sequence of tables.
        #[allow(clippy::needless_update, reason = "some rows have every field, others share those of a plain one")]
        pub static CATALOGUE: &[SetNumber] = &[$(SetNumber { $($field: $value,)* ..PLAIN }),*];
    };
}

catalogue! {
    {
        key: "samples", name: "samples N", short: Some("Samples"), decimals: 0,
        needs: None, value: |set| Some(set.samples as f64),
        meaning: "The samples of the set. At a moment of a run these are the samples kept: tiled or inserted, and not eliminated.",
    }
    {
        key: "radius", name: "radius r", unit: "user units", decimals: 8,
        needs: None, value: MeasuredSet::r,
        meaning: "The radius r, or the smallest distance between two samples if no radius is known.",
    }
    {
        key: "density", name: "density", short: Some("Density N r\u{b2}/A"), unit: "N r\u{b2} / area", decimals: 4,
        needs: None, value: |set| Some(set.samples as f64 * set.r()?.powi(2) / set.area()),
        meaning: "Samples times r\u{b2}, divided by the area: 0.6966 for maximal sets by dart throwing. Of a shape it is the area inside; where the radius varies, each place counts by its own.",
    }
    {
        key: "packing", name: "packing", unit: "of hexagonal", decimals: 4,
        needs: None, value: |set| Some(set.samples as f64 * 3f64.sqrt() / 2.0 / set.area() * set.r()?.powi(2)),
        meaning: "The samples, as a share of the most that disks of this radius allow: those of the hexagonal packing.",
    }
    {
        key: "min_distance_r", name: "smallest distance", short: Some("Smallest distance, r"), unit: "r", decimals: 6,
        needs: Some(Part::Report), value: |set| Some(set.verdict()?.min_distance / set.r()?),
        meaning: "The smallest distance between two samples.",
    }
    {
        key: "covering_radius_r", name: "covering radius", unit: "r", decimals: 6,
        needs: Some(Part::Report), value: |set| Some(set.verdict()?.covering_radius / set.r()?),
        meaning: "The largest distance from any place of the domain to its nearest sample. A set counts as maximal up to (1 + 2^-15) r, since its positions are rounded to a lattice.",
    }
    {
        key: "conflicts", name: "conflicts", short: Some("Conflicts"), unit: "pairs", decimals: 0,
        needs: Some(Part::Report), value: |set| Some(set.judged()?.conflicts as f64),
        meaning: "Pairs of samples closer than r.",
    }
    {
        key: "gaps", name: "gaps", short: Some("Open places"), unit: "places", decimals: 0,
        needs: Some(Part::Report), value: |set| Some(set.judged()?.gaps as f64),
        meaning: "The centres of empty circles larger than r: a gap has one or more.",
    }
    {
        key: "relative_radius", name: "relative radius", short: Some("Relative radius"), unit: "r_max", decimals: 4,
        needs: Some(Part::Report), value: |set| Some(set.verdict()?.relative_radius),
        meaning: "The smallest distance, divided by that of the densest packing of as many samples.",
    }
    {
        key: "mean_nearest_distance", name: "mean nearest distance", unit: "r_max", decimals: 4,
        needs: Some(Part::Distances), value: |set| (set.distances.as_deref()).map(NearestDistances::mean_relative_distance),
        meaning: "The mean distance from a sample to its nearest neighbour, divided by that of the densest packing of as many samples.",
    }
    {
        key: "effective_nyquist", name: "effective Nyquist frequency", short: Some("Eff. Nyquist \u{3bd}"), unit: "nu", decimals: 3,
        needs: Some(Part::Smooth), value: |set| set.curve.as_ref()?.effective_nyquist(),
        meaning: "The largest frequency below which the mean power stays under 0.1, by the spectrum that follows from g(r). That is smooth, so that a square lattice, whose first peak is at 1, has 0.92.",
    }
    {
        key: "effective_nyquist_psa", name: "Nyquist frequency by psa", unit: "nu", decimals: 3,
        needs: Some(Part::Smooth), value: |set| set.curve.as_ref()?.effective_nyquist_psa(),
        meaning: "The effective Nyquist frequency as the program psa has it: from the rise of the mean power back to where it is last under 0.1.",
    }
    {
        key: "oscillation", name: "oscillation of power", short: Some("Oscillation"), decimals: 3,
        needs: Some(Part::Smooth), value: |set| set.curve.as_ref()?.oscillation(),
        meaning: "10 times the root mean square of P \u{2212} 1 beyond the first frequency where P is nearly 1, P being the spectrum that follows from g(r). The scatter of a set of a few hundred samples adds to it.",
    }
    {
        key: "peak", name: "frequency of most power", unit: "1/r", decimals: 3,
        needs: Some(Part::Spectrum), value: rings::peak,
        meaning: "The frequency at which the radial mean of the power is highest.",
    }
    {
        key: "low_power", name: "power below 0.3 / r", decimals: 4,
        needs: Some(Part::Spectrum), value: rings::low_power,
        meaning: "The mean power of the frequencies below 0.3 / r: 1 for independent random samples.",
    }
    {
        key: "anisotropy", name: "largest anisotropy", unit: "dB", decimals: 2,
        needs: Some(Part::Spectrum), value: rings::anisotropy,
        meaning: "The largest anisotropy of a ring of frequencies from 0.3 / r on: about 0 dB without a preferred direction, but for the scatter of the ring.",
    }
    {
        key: "spectral_slope", name: "spectral slope", short: Some("Spectral slope"), decimals: 2,
        needs: Some(Part::Spectrum), value: |set| slope::slope(&set.spectrum.as_ref()?.profile),
        meaning: "The exponent b of a power law P = c \u{3bd}^b through the radial mean of the power below \u{3bd} = 0.5: 0 for independent random samples, 2 for a jittered grid. Sets of fewer than about 300 samples have none.",
    }
    {
        key: "area_deviation", name: "deviation of cell areas", unit: "mean area", decimals: 4,
        needs: Some(Part::Cells), value: |set| Some(set.order.as_ref()?.relative_areas.deviation),
        meaning: "The standard deviation of the areas of the Voronoi cells, in mean areas.",
    }
    {
        key: "six_sided", name: "cells with six sides", unit: "share", decimals: 4,
        needs: Some(Part::Cells), value: |set| set.order.as_deref().map(Order::six_sided),
        meaning: "The share of the Voronoi cells that have six sides.",
    }
    {
        key: "mean_sides", name: "mean sides of a cell", decimals: 3,
        needs: Some(Part::Cells), value: |set| Some(set.order.as_ref()?.mean_sides),
        meaning: "The mean number of sides of a Voronoi cell: 6 for every periodic set in general position.",
    }
    {
        key: "bond_order", name: "bond order, local", decimals: 4,
        needs: Some(Part::Cells), value: |set| Some(set.order.as_ref()?.bond_order),
        meaning: "How nearly the neighbours of a sample are the corners of a regular hexagon, in the mean: 1 for the hexagonal lattice, 0 for the square one.",
    }
    {
        key: "global_bond_order", name: "bond order, global", decimals: 4,
        needs: Some(Part::Cells), value: |set| Some(set.order.as_ref()?.global_bond_order),
        meaning: "The bond order of all samples together: near 0 also where the hexagons of neighbours have no common direction.",
    }
    {
        key: "star_discrepancy", name: "L2 star discrepancy", decimals: 6,
        needs: Some(Part::Discrepancy), value: |set| Some(set.discrepancy?.star),
        meaning: "How far the share of samples in boxes from the lower left corner is from the area of the boxes, in quadratic mean.",
    }
    {
        key: "centered_discrepancy", name: "L2 centred discrepancy", decimals: 6,
        needs: Some(Part::Discrepancy), value: |set| Some(set.discrepancy?.centered),
        meaning: "The same deviation for boxes from the nearest corner, together with the projections onto the axes.",
    }
}
