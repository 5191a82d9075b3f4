//! Linear ramps: how many samples there are to a squared local radius, and how far apart pairs are, in local radii.

use serde::{Deserialize, Serialize};
use tilescope_core::Boundary;
use tilescope_sets::Ground;

use super::fields::{FieldCounts, Written, integral, samples};
use crate::control::Control;
use crate::error::Result;

/// Slopes of the ramps, and how many times the least radius the largest is. Steep ramps need more contrast: a place must be
/// far from both ends. Fields have at most 48 times.
pub const RAMPS: [Ramp; 6] = [
    Ramp::new(0.0, 4.0),
    Ramp::new(0.05, 8.0),
    Ramp::new(0.1, 16.0),
    Ramp::new(0.2, 32.0),
    Ramp::new(0.3, 40.0),
    Ramp::new(0.4, 40.0),
];
/// Samples are counted this many of their own radii from the border, where there are more of them (0.23 for each R of it).
/// Farther in, no place of a ramp steeper than 0.5 would be left.
const MARGIN: f64 = 2.0;
/// Pairs need more room: the other sample of a pair may be some three radii away, and has a disk of its own.
const PAIR_MARGIN: f64 = 4.0;
/// No place of a steeper ramp is this far from both ends.
const STEEPEST_WITH_PAIRS: f64 = 0.2;

/// Bins of pair distances, from h on, where h is the harmonic mean of both radii.
pub const BINS: usize = 15;
const BIN: f64 = 0.1;
/// Steps of the sum over the area of a bin, and how far it reaches: 2.5 h are at most 3.1 radii where the slope is 0.2.
const AREA_STEP: f64 = 0.02;
const AREA_REACH: i32 = 200;

/// A radius that grows along x, from 1.
#[derive(Clone, Copy, Debug)]
pub struct Ramp {
    pub slope: f64,
    contrast: f64,
}

/// The counts of one set on a ramp.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct RampSet {
    count: u64,
    /// Samples whose pairs are counted, and their pairs in each bin.
    centers: u64,
    pairs: Vec<u64>,
}

/// What all sets on a ramp have.
#[derive(Clone, Debug)]
pub struct RampSets {
    pub slope: f64,
    pub counts: FieldCounts,
    /// Pair correlation and its standard error in each bin; none where the ramp is too steep for it.
    pub pairs: Vec<[f64; 2]>,
}

impl Ramp {
    const fn new(slope: f64, contrast: f64) -> Self {
        Self { slope, contrast }
    }

    /// Returns width and height. A height of 12 of the largest radii leaves most of it inside the margins.
    fn size(self) -> [f64; 2] {
        // The width of a level field is about that of the others.
        let width = if self.slope > 0.0 {
            (self.contrast - 1.0) / self.slope
        } else {
            150.0
        };
        [width, 12.0 * self.contrast]
    }

    fn radius_at(self, x: f64) -> f64 {
        1.0 + self.slope * x
    }

    /// Returns the height of the part at some x that is `margin` radii from all borders; 0 if there is none.
    fn height_inside(self, x: f64, margin: f64) -> f64 {
        let [width, height] = self.size();
        let away = margin * self.radius_at(x);
        if x < away || width - x < away {
            return 0.0;
        }
        (height - 2.0 * away).max(0.0)
    }

    fn is_inside(self, [x, y]: [f64; 2], margin: f64) -> bool {
        let [_, height] = self.size();
        let inside = self.height_inside(x, margin);
        inside > 0.0 && (y - 0.5 * height).abs() <= 0.5 * inside
    }

    fn has_pairs(self) -> bool {
        self.slope <= STEEPEST_WITH_PAIRS
    }

    /// Returns the field of the ramp.
    pub fn ground(self) -> Result<Ground> {
        let field = Written {
            radius: format!("1+{}*x", self.slope),
            size: self.size(),
            boundary: Boundary::Bounded,
        };
        field.ground()
    }

    /// Makes a set on the field of the ramp, and counts its samples and its pairs.
    pub fn made(self, ground: &Ground, seed: u64, control: &Control<'_>) -> Result<RampSet> {
        let points = samples(ground, seed, control)?;
        let inside = points.iter().filter(|&&at| self.is_inside(at, MARGIN));
        let mut set = RampSet {
            count: inside.count() as u64,
            centers: 0,
            pairs: vec![0; BINS],
        };

        if self.has_pairs() {
            for &center in points.iter().filter(|&&at| self.is_inside(at, PAIR_MARGIN)) {
                set.centers += 1;
                let reach = PAIR_MARGIN * self.radius_at(center[0]);
                // Most samples are farther away than any bin reaches; to leave them out first saves most of the time.
                let is_beside = |other: &&[f64; 2]| {
                    (other[0] - center[0]).abs() < reach && (other[1] - center[1]).abs() < reach
                };
                let beside = points.iter().filter(is_beside);
                // The center itself has no bin.
                for bin in beside.filter_map(|&other| self.bin(center, other)) {
                    set.pairs[bin] += 1;
                }
            }
        }
        Ok(set)
    }

    /// Returns the bin of the distance of two places, in units of the harmonic mean of their radii.
    fn bin(self, from: [f64; 2], to: [f64; 2]) -> Option<usize> {
        let [one, other] = [from, to].map(|[x, _]| self.radius_at(x));
        let near = 2.0 * one * other / (one + other);
        let bin = ((from[0] - to[0]).hypot(from[1] - to[1]) / near - 1.0) / BIN;
        // A pair that is near has no bin: the set would not be valid.
        (bin >= 0.0 && bin < BINS as f64).then_some(bin as usize)
    }

    /// Returns the area of each bin around a sample in squared local radii, which is the same at all places: a ramp looks
    /// the same from each of them, in radii of that place.
    fn bin_areas(self) -> [f64; BINS] {
        let mut areas = [0.0; BINS];
        let steps = || (-AREA_REACH..AREA_REACH).map(|step| (f64::from(step) + 0.5) * AREA_STEP);
        for x in steps() {
            let radius = self.radius_at(x);
            for y in steps() {
                if let Some(bin) = self.bin([0.0; 2], [x, y]) {
                    // Samples are as dense as 1 / R^2: an area counts in squares of its own radius, not of the sample's.
                    areas[bin] += (AREA_STEP / radius).powi(2);
                }
            }
        }
        areas
    }

    /// Returns density and pair correlation of sets on this ramp.
    pub fn joined(self, sets: &[RampSet]) -> RampSets {
        // Only samples inside the margins were counted.
        let [width, _] = self.size();
        let area_at = |x: f64| self.height_inside(x, MARGIN) / self.radius_at(x).powi(2);
        let counts = FieldCounts {
            counts: sets.iter().map(|set| set.count).collect(),
            area: integral(0.0, width, area_at),
        };

        let mut pairs = Vec::new();
        if self.has_pairs() {
            let centers: u64 = sets.iter().map(|set| set.centers).sum();
            let [density, _] = counts.density();
            for (bin, area) in self.bin_areas().into_iter().enumerate() {
                let found: u64 = sets.iter().map(|set| set.pairs[bin]).sum();
                let expected = centers as f64 * density * area;
                // Most pairs are found from both ends, so that half as many are independent. Without a pair the error is that of
                // one.
                let error = (2.0 * found.max(1) as f64).sqrt();
                pairs.push([found as f64, error].map(|count| count / expected));
            }
        }
        RampSets {
            slope: self.slope,
            counts,
            pairs,
        }
    }
}

/// Returns the middle of a bin, in harmonic means of both radii.
pub fn middle(bin: usize) -> f64 {
    1.0 + BIN * (bin as f64 + 0.5)
}
