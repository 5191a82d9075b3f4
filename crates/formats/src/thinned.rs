//! Certificates of thinned sets: what they state, and which points of the source a file has.

use std::collections::BTreeMap;

use serde_json::Value;
use tilescope_analysis::{Judge, Region, ThinnedReport};

use crate::certificate::{Certificate, CertifiedRadius, NoOther, Thinned};
use crate::check::{CertificateDifference, Contents, Differences, contradictions};
use crate::codecs::ReadSet;
use crate::digest::{bytes_digest, positions_digest};

/// What a certificate of a thinned set is made from.
#[derive(Clone, Debug)]
pub struct ThinnedFacts<'a> {
    /// The name of the file, for the certificate.
    pub name: &'a str,
    /// The bytes of the file.
    pub data: &'a [u8],
    /// The set that was read from these bytes, as [`decode`](crate::decode) returns it.
    pub read: &'a ReadSet,
    /// A rectangle around all points given.
    pub region: Region,
    /// Where its lower corner lies.
    pub origin: [f64; 2],
    /// The radius, or the radii of points.
    pub radius: CertifiedRadius,
    /// How the points were chosen.
    pub parameters: BTreeMap<String, Value>,
    /// From what they were chosen.
    pub thinned: Thinned,
    /// What a judge found.
    pub report: &'a ThinnedReport,
}

impl ThinnedFacts<'_> {
    /// Returns the certificate that states these facts.
    #[must_use]
    pub fn certificate(&self) -> Certificate {
        let (report, read) = (self.report, self.read);
        let count = read.set.len() as u64;

        // The judge of thinned sets counts faults and measures no distance, so that the measures stay null.
        // `with_version` raises the version for the part of thinned sets.
        let stated = Certificate {
            format_version: 1,
            program: "tilescope".to_owned(),
            program_version: env!("CARGO_PKG_VERSION").to_owned(),
            method: "thinned".to_owned(),
            parameters: self.parameters.clone(),
            region: self.region,
            // An origin at 0 is not stated.
            origin: Some(self.origin).filter(|&[x, y]| x != 0.0 || y != 0.0),
            depth: None,
            shape: None,
            radius: self.radius.clone(),
            // Each point given, and not each place, is to be near a kept one, which is decided exactly.
            covering_tolerance: 0.0,
            count,
            min_distance: None,
            covering_radius: None,
            conflicts: report.conflicts,
            gaps: report.uncovered,
            // As in every certificate, the density is that of the least radius where radii differ.
            density: count as f64 * self.radius.least().powi(2) / self.region.area(),
            relative_radius: None,
            valid: report.valid(),
            // The judge of thinned sets has no name of its own. It has that of the judge that subdivides squares, since
            // it divides, too: it divides the points, until few are left in a part.
            judges: vec![Judge::Subdivision],
            levels: Vec::new(),
            prefix: None,
            thinned: Some(self.thinned.clone()),
            file: self.name.to_owned(),
            file_format: read.detection.format,
            precision: read.precision,
            // The region and the radius are in units of the file.
            scale: 1.0,
            shuffle_seed: None,
            rounding: None,
            positions_digest: positions_digest(&read.set.points),
            digest: Some(bytes_digest(self.data)),
            // A certificate has no field besides these.
            others: NoOther,
        };
        stated.with_version()
    }
}

impl Certificate {
    /// Returns the statements of this certificate of a thinned set that are not true, `found` being the one that was made anew
    /// from the file and, where it was given, from the set from which the points were chosen.
    #[must_use]
    pub fn thinned_differences(&self, found: &Self) -> Vec<CertificateDifference> {
        let contents = Contents {
            format: found.file_format,
            precision: found.precision,
            digest: found.digest.clone(),
            positions_digest: found.positions_digest.clone(),
            count: found.count,
        };

        // Statements about the file's content, and numbers that follow from others, are compared as for every
        // certificate.
        let mut list = Differences(contradictions(self, &contents));
        list.exact("radius", &self.radius, &found.radius);
        list.exact("conflicts", &self.conflicts, &found.conflicts);
        list.exact("gaps", &self.gaps, &found.gaps);

        // No judge of thinned sets measures these, so that a certificate that states one of them is not true.
        list.measure("min_distance", self.min_distance, None);
        list.measure("covering_radius", self.covering_radius, None);
        list.measure("relative_radius", self.relative_radius, None);

        // The priority is not compared, as `found` was made by the stated one.
        if let (Some(stated), Some(made)) = (&self.thinned, &found.thinned) {
            list.exact("thinned.source", &stated.source, &made.source);
            list.exact("thinned.given", &stated.given, &made.given);
        }
        list.0
    }
}

/// Returns for each of the points given whether it is a point of a thinned file; of several points at one place, only
/// that of the least rank is. `ranks` has the rank of each point given; without it, the rank is the index.
///
/// # Errors
///
/// The index of a point of the file that is not one of those given, or that the file has a second time.
pub fn implied_kept<const AXES: usize>(
    given: &[[f64; AXES]],
    thinned: &[[f64; AXES]],
    ranks: Option<&[u32]>,
) -> Result<Vec<bool>, usize> {
    // Rows are kept unchanged, so that coordinates are compared by their bits, which sort, too: 0 and -0 differ.
    let bits = |point: &[f64; AXES]| point.map(f64::to_bits);
    let points = thinned.iter().map(bits).zip(0..);
    let mut sorted: Vec<FilePoint<AXES>> = points
        .map(|(bits, index)| FilePoint { bits, index })
        .collect();
    sorted.sort_unstable();
    // A thinned set has no point twice, as the distance of two points at one place is below any radius.
    if let Some(pair) = sorted.windows(2).find(|pair| pair[0].bits == pair[1].bits) {
        return Err(pair[1].index);
    }

    // Of several points at one place, only that of the least rank can have been kept: it is decided first, and excludes
    // the others.
    let rank = |index: usize| ranks.map_or(index as u32, |ranks| ranks[index]);
    let mut sources: Vec<Option<usize>> = vec![None; sorted.len()];
    for (index, point) in given.iter().enumerate() {
        if let Ok(at) = sorted.binary_search_by_key(&bits(point), |point| point.bits) {
            let is_first = sources[at].is_none_or(|other| rank(index) < rank(other));
            if is_first {
                sources[at] = Some(index);
            }
        }
    }

    // A point of the file without a source is not one of those given.
    let mut kept = vec![false; given.len()];
    for (source, point) in sources.iter().zip(&sorted) {
        kept[source.ok_or(point.index)?] = true;
    }
    Ok(kept)
}

/// A point of a thinned file: the bits of its coordinates, and its index in the file.
#[derive(PartialEq, Eq, PartialOrd, Ord)]
struct FilePoint<const AXES: usize> {
    bits: [u64; AXES],
    index: usize,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_are_told_apart_by_rank() {
        let given = [[1.0, 2.0], [3.0, 4.0], [1.0, 2.0], [0.0, 0.0], [-0.0, 0.0]];
        let kept = |thinned: &[[f64; 2]], ranks| implied_kept(&given, thinned, ranks);
        let first = [true, true, false, false, false];
        assert_eq!(kept(&given[..2], None), Ok(first.to_vec()));
        let last = [false, true, true, false, false];
        assert_eq!(kept(&given[..2], Some(&[4, 3, 2, 1, 0])), Ok(last.to_vec()));
        let zeros = [false, false, false, true, true];
        assert_eq!(kept(&given[3..], None), Ok(zeros.to_vec()));

        // One that is not one of them, and one twice.
        assert_eq!(kept(&[[3.0, 4.0], [3.0, 5.0]], None), Err(1));
        assert_eq!(kept(&[[3.0, 4.0], [1.0, 2.0], [3.0, 4.0]], None), Err(2));
    }
}
