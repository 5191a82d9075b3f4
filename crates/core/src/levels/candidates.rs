//! The places of a pixel that may be candidates (see [`super::gaps`]), made from the samples that decide about it.

use glam::{DVec2, I64Vec2, IVec2};

use crate::lattice::Point;
use crate::radius::Radius;

use super::gaps::GapPixel;
use super::region::LevelRegion;

/// A circumcentre, rounded, that no sample is nearer to than those that made it.
#[derive(Clone, Copy)]
pub(super) struct GapPlace {
    pub at: Point,
    /// Uncovered places of the triangle that it belongs to are no farther from it than this.
    pub reach: i32,
    /// Whether it is a candidate. If not, a sample covers it by less than two units.
    pub is_uncovered: bool,
}

/// The places of a pixel that may be candidates.
pub(super) struct Candidates<'a> {
    pub region: &'a LevelRegion,
    pub pixel: &'a GapPixel,
    pub sites: &'a [IVec2],
}

impl Candidates<'_> {
    /// Appends the places that the sites make in the pixel.
    pub fn find(&self, found: &mut Vec<GapPlace>) {
        for (k, &a) in self.sites.iter().enumerate() {
            for (l, &b) in self.sites.iter().enumerate().skip(k + 1) {
                for &c in &self.sites[l + 1..] {
                    // A filter in floating point; integers decide on the triples that it lets pass.
                    if may_hold(self.pixel.side, [a, b, c]) {
                        self.consider(circumcentre([a, b, c]), &[a, b, c], found);
                    }
                }
            }
        }

        if self.region.frame.border.meets(&self.pixel.rect()) {
            self.on_border(found);
        }
    }

    /// Adds the place at `centre` of the pixel if no sample is nearer to it than `made_by` and none lies within R - 2
    /// units. Samples in one line have no centre, and make no place.
    fn consider(&self, centre: Option<I64Vec2>, made_by: &[IVec2], found: &mut Vec<GapPlace>) {
        let side = 0..i64::from(self.pixel.side);
        // Each pixel finds the places that it holds, so that no two search for the same.
        let Some(centre) = centre.filter(|at| side.contains(&at.x) && side.contains(&at.y)) else {
            return;
        };

        let square = |site: &IVec2| site.as_i64vec2().distance_squared(centre);
        // `made_by` is never empty.
        let nearest_square = made_by.iter().map(square).min().unwrap_or(0);
        let radius = self.region.grid.radius();
        // By so much rounding can change squared distances: 9.7 R at most (`stages/detect.rs`), and 12 R are allowed.
        let slack = 12 * i64::from(radius.units);
        // A sample within R covers the place, however near those that made it are. But rounding moved the place by up
        // to 0.71 units: if a sample covers it by less than two units, its true circumcentre may still be bare.
        let units = i64::from(radius.units);
        let limit = (nearest_square - slack).max((units - 2).pow(2) + 1);
        let squares = self.sites.iter().map(square);
        let lowest = squares.min().unwrap_or(nearest_square);
        if lowest < limit {
            return;
        }

        let (x, y) = (centre.x as i32, centre.y as i32);
        let place = Point::new(self.pixel.min.x + x, self.pixel.min.y + y);
        // Pixels at the upper edges may reach beyond the frame.
        if self.region.frame.rect.contains(place) {
            found.push(GapPlace {
                at: place,
                reach: gap_reach(nearest_square, radius),
                is_uncovered: lowest > radius.squared,
            });
        }
    }

    /// Adds the candidates on the lines and corners of a closed border.
    fn on_border(&self, found: &mut Vec<GapPlace>) {
        let through = self.region.frame.border.through(&self.pixel.rect());
        let border = through.seen_from(self.pixel.min.into());

        for (k, a) in self.sites.iter().enumerate() {
            let others = &self.sites[k + 1..];
            for (place, other) in border.places(a.as_i64vec2(), others, |b| b.as_i64vec2()) {
                match other {
                    Some(b) => self.consider(Some(place), &[*a, *b], found),
                    None => self.consider(Some(place), &[*a], found),
                }
            }
        }
    }
}

/// Returns how far from a rounded circumcentre the uncovered places of its triangle are at most. `search` has the proof.
fn gap_reach(nearest_square: i64, radius: Radius) -> i32 {
    // The true centre is at most 0.71 units off. A root is right to far less than a unit, and what it is cut by is added.
    let circumradius = (nearest_square as f64).sqrt() + 1.0;
    let square = circumradius * circumradius - radius.squared as f64;
    square.max(0.0).sqrt() as i32 + 3
}

/// Returns the circumcentre of three places, rounded half up to the lattice, or `None` if they are collinear or so
/// nearly that it has no coordinates of 64 bits.
#[inline]
fn circumcentre(sites: [IVec2; 3]) -> Option<I64Vec2> {
    let [a, b, c] = sites.map(IVec2::as_i64vec2);
    let (from_a_to_b, from_a_to_c) = (b - a, c - a);
    let d = 2 * from_a_to_b.perp_dot(from_a_to_c);
    if d == 0 {
        return None;
    }

    // The centre lies at these numerators over d from a. Components are below 2^24, squares below 2^49, numerators
    // below 2^74.
    let (b2, c2) = (from_a_to_b.length_squared(), from_a_to_c.length_squared());
    let times = |square: i64, length: i64| i128::from(square) * i128::from(length);
    let x = times(b2, from_a_to_c.y) - times(c2, from_a_to_b.y);
    let y = times(c2, from_a_to_b.x) - times(b2, from_a_to_c.x);
    let [right, up] = [x, y].map(|n| i64::try_from(round_half_up(n, d.into())).ok());

    Some(a + I64Vec2::new(right?, up?))
}

/// Returns whether the circumcentre of three places of a conflict-free set may lie in a square of `side` units at (0, 0).
///
/// If it does, its distance from the places is at most 5 R, so that d, the triangle's area times 4, is above 0.2 R^2, and
/// the numerators, below (10 R)^3, have errors of less than 10^-6 d.
#[inline]
fn may_hold(side: i32, sites: [IVec2; 3]) -> bool {
    let [a, b, c] = sites.map(IVec2::as_dvec2);
    let (b, c) = (b - a, c - a);
    let d = 2.0 * b.perp_dot(c);
    let centre = (c.length_squared() * b - b.length_squared() * c).perp() / d + a;
    let high = DVec2::splat(f64::from(side) + 1.0);
    (centre.cmpge(DVec2::NEG_ONE) & centre.cmplt(high)).all()
}

/// Returns `numerator / denominator` rounded to the nearest integer, halves upwards.
const fn round_half_up(numerator: i128, denominator: i128) -> i128 {
    let sign = denominator.signum();
    let (n, d) = (numerator * sign, denominator * sign);
    (2 * n + d).div_euclid(2 * d)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn place() -> impl Strategy<Value = IVec2> {
        let along = -229_376_i32..=229_376;
        (along.clone(), along).prop_map(IVec2::from)
    }

    proptest! {
        /// Where 64 bits suffice, the centre is that of runs of one level, and the filter lets it pass.
        #[test]
        fn centres_are_those_of_one_level(a in place(), b in place(), c in place()) {
            let centre = circumcentre([a, b, c]);
            let [b_off, c_off] = [b, c].map(|p| (p - a).as_i64vec2());
            let known = crate::circumcentre::circumcentre(b_off, c_off);
            prop_assert_eq!(centre, known.map(|at| at + a.as_i64vec2()));
            if let Some(at) = centre.filter(|at| at.abs().max_element() < 300_000) {
                prop_assert!(may_hold(1, [a, b, c].map(|p| p - at.as_ivec2())));
            }
        }
    }
}
