//! The verdict on a point set with its extremes and witnesses. Plain data that survives a round trip through serde. The
//! verdict follows from its numbers.

use serde::{Deserialize, Serialize};

use crate::exact::covering_limit;
use crate::findings::{Findings, MAX_CONFLICTS};
use crate::judge::Judge;
use crate::region::Region;
use crate::witness::{Conflict, Gap};

/// The result of [`verify`](crate::verify) for a set. Lengths are in the unit of the samples.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Report {
    /// Who judged. Where both did, they agree, and the numbers are those of the first.
    pub judges: Vec<Judge>,
    /// How many samples were judged.
    pub count: usize,
    /// The region in which they were judged.
    pub region: Region,
    /// The radius `r` judged against.
    pub radius: f64,
    /// Relative tolerance of maximality: the covering radius may be `(1 + covering_tolerance) r`.
    pub covering_tolerance: f64,
    /// Number of pairs closer than `radius`, each pair once; [`MAX_CONFLICTS`] stand for that many or more.
    pub conflicts: u64,
    /// The closest of those pairs, closest first.
    pub worst_conflicts: Vec<Conflict>,
    /// Number of places, each once, that are centres of too large an empty circle: Voronoi vertices
    /// in the region and, when bounded, Voronoi edges crossing the border and the four corners.
    /// One hole usually has several such places; none means that no hole exists.
    pub gaps: u64,
    /// The largest of those circles, largest first.
    pub worst_gaps: Vec<Gap>,
    /// Smallest distance between two samples (periodic: between any two of the repeated plane, so
    /// at most the shorter extent). Infinite for one sample in a bounded region.
    #[serde(with = "finite_or_null")]
    pub min_distance: f64,
    /// Radius of the largest empty circle centred in the region. Infinite where it is not measured: subdivision only finds
    /// out whether every place is covered.
    #[serde(with = "finite_or_null")]
    pub covering_radius: f64,
    /// Of a set that is claimed to be the beginning of a larger one: the factor of their radius within which all places are
    /// covered, as measured. `gaps` then counts none, as each is within that factor.
    #[serde(default)]
    pub covering_factor: Option<f64>,
    /// The area that is to be covered: that of the region, or of a shape in it. Where the radius varies a place counts as much
    /// as `radius^2` is of its own squared, so that the area is that of a region of one radius with as much room.
    pub area: f64,
    /// `N r^2 / area`.
    pub density: f64,
    /// `min_distance / r_max`, where `r_max = sqrt(2 area / (sqrt(3) N))` is that of the densest
    /// packing. Infinite where `min_distance` is, and where the radius varies, as the packing then has no single distance.
    #[serde(with = "finite_or_null")]
    pub relative_radius: f64,
}

/// The set that a report is about: the number of its samples, and what they are judged against.
#[derive(Clone, Copy)]
pub(crate) struct JudgedSet {
    pub count: usize,
    pub region: Region,
    pub radius: f64,
    pub covering_tolerance: f64,
}

/// Returns the smallest distance in the densest packing of so many samples in an area, the hexagonal one.
pub(crate) fn distance_in_packing(count: usize, area: f64) -> f64 {
    (2.0 * area / (3f64.sqrt() * count as f64)).sqrt()
}

impl Report {
    /// Returns the report on a set. Lengths in `found` are those of the samples' unit, multiplied by `scale`; all
    /// others are in the samples' unit.
    pub(crate) fn new(set: JudgedSet, scale: f64, found: Findings) -> Self {
        let JudgedSet {
            count,
            region,
            radius,
            covering_tolerance,
        } = set;

        // The scale is a power of two, so that lengths come back without rounding. A conflict has the indices of its
        // samples and no places.
        let unscaled_conflict = |conflict: Conflict| Conflict {
            distance: conflict.distance / scale,
            ..conflict
        };

        let unscaled_gap = |gap: Gap| Gap {
            center: gap.center.map(|value| value / scale),
            distance: gap.distance / scale,
            ..gap
        };

        let (conflicts, gaps) = (
            found.worst_conflicts.into_sorted(),
            found.worst_gaps.into_sorted(),
        );

        let min_distance = found.min_distance / scale;
        let r_max = distance_in_packing(count, region.area());

        Self {
            judges: vec![found.judge],
            count,
            region,
            radius,
            covering_tolerance,
            // Searches stop counting conflicts somewhere beyond the limit, so that the number itself means nothing
            // there. Gaps are all counted.
            conflicts: found.conflicts.min(MAX_CONFLICTS),
            worst_conflicts: conflicts.into_iter().map(unscaled_conflict).collect(),
            gaps: found.gaps,
            worst_gaps: gaps.into_iter().map(unscaled_gap).collect(),
            min_distance,
            covering_radius: found.covering_radius / scale,
            // A set that is judged here is not claimed to be the beginning of a larger one.
            covering_factor: None,
            area: region.area(),
            density: count as f64 * radius * radius / region.area(),
            relative_radius: min_distance / r_max,
        }
    }

    /// Returns the density of the samples in the whole region, as certificates state it: that of a shape counts the places
    /// outside, too, and where the radius varies all places have the least.
    #[must_use]
    pub fn density_of_region(&self) -> f64 {
        self.count as f64 * self.radius * self.radius / self.region.area()
    }

    /// Returns the smallest distance over that of the densest packing of as many samples in the whole region, as certificates
    /// state it.
    #[must_use]
    pub fn relative_radius_of_region(&self) -> f64 {
        self.min_distance / distance_in_packing(self.count, self.region.area())
    }

    /// The verdict in numbers, for messages.
    pub(crate) fn summary(&self) -> String {
        let Self {
            conflicts,
            gaps,
            min_distance,
            covering_radius,
            ..
        } = self;
        format!(
            "{conflicts} conflicts, smallest distance {min_distance:e}, {gaps} gaps, covering radius {covering_radius:e}"
        )
    }

    /// Whether there are [`MAX_CONFLICTS`] or more: they were not counted further.
    #[must_use]
    pub fn more_conflicts(&self) -> bool {
        self.conflicts >= MAX_CONFLICTS
    }

    /// Whether no pair is closer than the radius (equation 2 of the paper).
    #[must_use]
    pub fn conflict_free(&self) -> bool {
        self.conflicts == 0 && (self.is_of_squares() || self.min_distance >= self.radius)
    }

    /// Whether no sample could be added: no empty circle centred in the region is larger than the
    /// radius, up to the tolerance (equation 3 of the paper, with the border of a bounded region).
    #[must_use]
    pub fn maximal(&self) -> bool {
        self.covers() && self.covering_factor.is_none_or(|factor| factor <= 1.0)
    }

    /// Whether every place is covered within the radius or, of the beginning of a set, within the factor of it.
    fn covers(&self) -> bool {
        let limit = covering_limit(self.covering_tolerance, self.radius);
        self.gaps == 0 && (self.is_of_squares() || self.covering_radius <= limit)
    }

    /// Whether the counts alone decide: where the radius varies, no single distance says whether there are conflicts or
    /// gaps.
    fn is_of_squares(&self) -> bool {
        self.judges == [Judge::Subdivision]
    }

    /// Whether the set is both conflict-free and maximal; whether it is conflict-free and covers within a factor that can be
    /// measured, if it is claimed to be the beginning of a larger one.
    #[must_use]
    pub fn valid(&self) -> bool {
        self.conflict_free() && self.covers()
    }
}

/// Writes an infinite number as null and reads it back: JSON has no infinity.
pub(crate) mod finite_or_null {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[expect(
        clippy::trivially_copy_pass_by_ref,
        reason = "serde fixes the signature"
    )]
    pub fn serialize<S: Serializer>(value: &f64, serializer: S) -> Result<S::Ok, S::Error> {
        Some(*value)
            .filter(|value| value.is_finite())
            .serialize(serializer)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
        Ok(Option::deserialize(deserializer)?.unwrap_or(f64::INFINITY))
    }
}
