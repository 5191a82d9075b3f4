//! Where in a gap samples are inserted: the rank of an inserted sample's distance from all others among those of
//! uniform places of the same gap.

use glam::DVec2;

use tilescope_analysis::tessellation::GapRegion;
use tilescope_analysis::{Region, Tessellation};
use tilescope_core::threefry2x32_20;

use crate::error::Result;
use crate::experiments::common::largest;
use crate::sets::shortest;

/// Uniform places that a sample is ranked among: ranks are 0 to this number.
const PLACES: usize = 39;
/// Classes of ranks, of four each.
pub const CLASSES: usize = 10;
/// Draws for each place, at most; the rest of a gap may be small.
const TRIES: usize = 400;

/// The gaps between samples, before anything is inserted.
pub struct Gaps<'a> {
    survivors: &'a [[f64; 2]],
    region: Region,
    radius: f64,
    each: Vec<Gap>,
}

struct Gap {
    region: GapRegion,
    /// Farthest that a place may be from the deepest one.
    reach: f64,
    /// Sums of the areas of the triangles that fill the region, up to each.
    areas: Vec<f64>,
}

/// How many samples of a run have which rank.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ranked {
    pub classes: Vec<u64>,
    /// Samples that lie in no gap, or in one of which too little was left to find places in.
    pub skipped: u64,
}

impl<'a> Gaps<'a> {
    pub fn of(survivors: &'a [[f64; 2]], region: Region, radius: f64) -> Result<Self> {
        let parts = Tessellation::of(survivors, region, radius)?;
        Ok(Self {
            survivors,
            region,
            radius,
            each: parts.gaps.into_iter().map(Gap::new).collect(),
        })
    }

    /// Ranks samples in the sequence in which they were inserted: each among uniform places of the rest of its gap.
    pub fn ranked(&self, inserted: &[[f64; 2]], seed: u64) -> Ranked {
        let mut ranked = Ranked {
            classes: vec![0; CLASSES],
            skipped: 0,
        };
        for (index, &place) in inserted.iter().enumerate() {
            let mut draws = draws(seed, index as u32);
            match self.rank(place, &inserted[..index], &mut draws) {
                Some(rank) => ranked.classes[rank * CLASSES / (PLACES + 1)] += 1,
                None => ranked.skipped += 1,
            }
        }
        ranked
    }

    /// Returns how many of [`PLACES`] uniform places of a gap are nearer to a sample than `place`, which lies in that
    /// gap: a sample was inserted there after the `earlier` ones. `None` if it lies in no gap, or if too little of the
    /// gap is left.
    fn rank(
        &self,
        place: [f64; 2],
        earlier: &[[f64; 2]],
        draws: &mut impl FnMut() -> f64,
    ) -> Option<usize> {
        let from_deepest = |gap: &Gap, other| {
            let (deepest, _distance) = gap.region.deepest;
            self.distance(other, deepest.into())
        };
        let near = |&gap: &&Gap| from_deepest(gap, place) <= gap.reach;
        // The distance is cheap and rules most gaps out, so that few gaps have their triangles looked at.
        let gap = (self.each.iter().filter(near)).find(|gap| gap.region.contains(place))?;

        // Earlier samples more than 2 r from every place of the gap are left out. They are the nearest to none of these
        // places, each of which has a survivor within 2 r (core's `stages/detect.rs` has the proof).
        let farthest = gap.reach + 2.0 * self.radius;
        let around = |p: &&[f64; 2]| from_deepest(gap, **p) <= farthest;
        let earlier: Vec<[f64; 2]> = earlier.iter().filter(around).copied().collect();

        let own = self.clearance(gap, &earlier, place);
        let (mut places, mut nearer) = (0, 0);
        for _ in 0..TRIES * PLACES {
            let other = gap.draw(draws);
            let clearance = self.clearance(gap, &earlier, other);
            // A place that an earlier sample covers is no longer in the gap. The triangles that are drawn from reach a
            // little over the disks around the gap.
            if clearance > self.radius && gap.region.contains(other) {
                places += 1;
                nearer += usize::from(clearance < own);
            }
            if places == PLACES {
                return Some(nearer);
            }
        }

        // Earlier samples have left too little of the gap to find places in.
        None
    }

    /// Returns the distance from a place in a gap to the nearest sample. The nearest survivor is one of the gap's sites,
    /// since these are all survivors whose Voronoi cells reach into the gap.
    fn clearance(&self, gap: &Gap, earlier: &[[f64; 2]], place: [f64; 2]) -> f64 {
        let sites = gap.region.sites.iter().map(|site| &self.survivors[*site]);
        let distances = sites.chain(earlier).map(|p| self.distance(*p, place));
        distances.fold(f64::INFINITY, f64::min)
    }

    fn distance(&self, a: [f64; 2], b: [f64; 2]) -> f64 {
        let [x, y] = shortest([a[0] - b[0], a[1] - b[1]], &self.region);
        x.hypot(y)
    }
}

impl Gap {
    /// Prepares draws of uniform places in a gap.
    fn new(region: GapRegion) -> Self {
        let deepest = region.deepest.0;
        let corners = region.fill.as_flattened().iter();
        let farthest = largest(corners.map(|corner| corner.distance(deepest)));

        // The areas are added up, so that a uniform number below the total finds each triangle as often as its area
        // asks for.
        let mut total = 0.0;
        let area = |[a, b, c]: &[DVec2; 3]| {
            total += 0.5 * (b - a).perp_dot(c - a).abs();
            total
        };

        Self {
            areas: region.fill.iter().map(area).collect(),
            // The distance of the farthest corner may be rounded otherwise when it is compared with the reach. The
            // reach is a hair longer, so that this corner is within it in any case.
            reach: farthest * (1.0 + 1e-9),
            region,
        }
    }

    /// Returns a uniform place of the triangles; in a gap without triangles, its deepest place.
    fn draw(&self, draws: &mut impl FnMut() -> f64) -> [f64; 2] {
        let Some(total) = self.areas.last() else {
            return self.region.deepest.0.into();
        };
        let at = draws() * total;
        let triangle = self.areas.partition_point(|area| *area <= at);
        let [a, b, c] = self.region.fill[triangle.min(self.areas.len() - 1)];
        let (mut s, mut t) = (draws(), draws());
        // The two draws fill a parallelogram: its half beyond the triangle is turned into the triangle.
        if s + t > 1.0 {
            (s, t) = (1.0 - s, 1.0 - t);
        }
        (a + s * (b - a) + t * (c - a)).to_array()
    }
}

/// Returns a generator of uniform numbers in [0, 1), for one sample of one run.
pub fn draws(seed: u64, index: u32) -> impl FnMut() -> f64 {
    let mut counter = 0;
    move || {
        let [word, _] = threefry2x32_20([seed as u32, (seed >> 32) as u32], [index, counter]);
        counter += 1;
        f64::from(word) / 2f64.powi(32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiments::common::square;
    use crate::sets::Set;
    use crate::study::Settings;
    use crate::study::tests::alone;
    use tilescope_core::reference_sample;

    #[test]
    fn uniform_places_have_uniform_ranks_and_deepest_ones_the_highest() {
        alone(&Settings::default(), |control| {
            let domain = square(4000.0, 20.0).validate()?;
            let points = reference_sample(domain, 4, &mut control.observer())?;
            let mut set = Set::of(&domain, &points);
            // Every tenth sample leaves a gap.
            let mut index = 0;
            set.points.retain(|_| {
                index += 1;
                index % 10 != 0
            });
            let gaps = Gaps::of(&set.points, set.region, set.radius)?;
            let deepest = gaps.each.iter().map(|gap| gap.region.deepest.0.to_array());
            let deepest: Vec<[f64; 2]> = deepest.collect();
            let mut uniform = Vec::new();
            for (index, gap) in gaps.each.iter().enumerate() {
                let mut draws = draws(7, index as u32);
                let inside = (0..500)
                    .map(|_| gap.draw(&mut draws))
                    .find(|p| gap.region.contains(*p));
                uniform.extend(inside);
            }
            let wrap = |p: &[f64; 2]| {
                [
                    p[0].rem_euclid(set.region.width),
                    p[1].rem_euclid(set.region.height),
                ]
            };
            // One place in each gap, so that none has lost anything to an earlier one.
            let alone = |places: &[[f64; 2]]| {
                let mut classes = vec![0; CLASSES];
                for (index, place) in places.iter().enumerate() {
                    let one = gaps.ranked(&[wrap(place)], index as u64);
                    for (all, one) in classes.iter_mut().zip(one.classes) {
                        *all += one;
                    }
                }
                classes
            };
            let (flat, high) = (alone(&uniform), alone(&deepest));
            let total = flat.iter().sum::<u64>() as f64;
            assert!(total > 200.0);
            let expected = total / CLASSES as f64;
            let chi: f64 = flat
                .iter()
                .map(|n| (*n as f64 - expected).powi(2) / expected)
                .sum();
            assert!(chi < 27.9, "{chi} {flat:?}");
            assert_eq!(high[..CLASSES - 1], [0; CLASSES - 1]);
            Ok(())
        });
    }
}
