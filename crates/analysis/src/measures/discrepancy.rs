//! L2 discrepancies of the unit square by their closed forms, which take all pairs. The region is scaled to the unit
//! square; its border counts, periodic or not. Nothing is approximated.
//!
//! A pair's term is a product of `p(the larger) + q(the smaller)` over both axes. If one half of the samples lies left
//! of the other half, the term of a pair between the halves is a sum of products, each of a factor of one sample and a
//! factor of the other. Which factors these are depends only on which of the two is the lower one: so the terms of all
//! such pairs are added up while the halves, sorted by y, are merged.

use glam::DVec2;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::check_set;
use super::error::MeasureError;
use crate::error::VerifyError;
use crate::monitor::{Control, Monitor};
use crate::region::Region;

/// L2 discrepancies of a set.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Discrepancy {
    /// The root of the mean square over all places `x` of: share of samples in `[0, x]` less the area of `[0, x]`
    /// (Warnock 1972). `sqrt((1/4 - 1/9) / N)` in quadratic mean for noise.
    pub star: f64,
    /// Hickernell's centred one of 1998: boxes begin at the nearest corner, and the projections onto the axes
    /// count too. `sqrt((25/16 - 169/144) / N)` in quadratic mean for noise.
    pub centered: f64,
}

// Sums for both forms are two values: of the star discrepancy first, then of the centred one.

/// Samples whose pairs are added one by one: fewer take longer to merge.
const FEW: usize = 32;

/// Samples that one thread does without a report.
const CHUNK: usize = 4096;

impl Discrepancy {
    /// Returns the discrepancies of a set. Time grows as that of sorting the samples, and the result does not depend
    /// on threads. The sums over pairs are right to a relative 1e-13.
    ///
    /// # Errors
    ///
    /// No sample, samples outside the region.
    pub fn of(
        points: &[[f64; 2]],
        region: Region,
        control: Control<'_>,
    ) -> Result<Self, MeasureError> {
        // The closed forms need a sample, and no second one.
        let fewest = 1;
        check_set(points, region, fewest)?;
        let monitor = Monitor::begin(control, work(points.len()))?;
        let extent = DVec2::new(region.width, region.height);
        let mut places: Vec<_> = (points.par_iter())
            .map(|&point| DVec2::from(point) / extent)
            .collect();

        // Sums of chunks are added in their sequence, so that they do not depend on threads.
        let sum = |value: fn(DVec2) -> DVec2| -> DVec2 {
            let chunks = places.par_chunks(CHUNK);
            let sums = chunks.map(|chunk| rounded(chunk.iter().map(|&a| value(a))));
            rounded(sums.collect::<Vec<DVec2>>())
        };
        let (of_singles, of_selves) = (sum(single), sum(|a| term(a, a)));

        places.par_sort_by(|a, b| a.x.total_cmp(&b.x));
        // A buffer, into which `pairs` merges sorted halves.
        let mut room = places.clone();
        let of_pairs = pairs(&mut places, &mut room, &monitor)?;

        // The closed forms take pairs in both orders, and each sample with itself.
        let n = points.len() as f64;
        let mean_single = of_singles / n;
        let mean_pair = (of_selves + 2.0 * of_pairs) / (n * n);
        // Rounding may leave a tiny negative number.
        let root = |square: f64| square.max(0.0).sqrt();

        // The parts of the closed forms without samples are (1/3)^2 and (13/12)^2. Each form has its own mean single
        // term: the star form subtracts half of its mean, the centred one two times its mean.
        Ok(Self {
            star: root(1.0 / 9.0 - 0.5 * mean_single.x + mean_pair.x),
            centered: root(169.0 / 144.0 - 2.0 * mean_single.y + mean_pair.y),
        })
    }
}

/// Returns a sum that is rounded once.
fn rounded(values: impl IntoIterator<Item = DVec2>) -> DVec2 {
    let add = |sum: CompensatedSum, value| sum.plus(value);
    let sum = values.into_iter().fold(CompensatedSum::default(), add);
    sum.sum + sum.rest
}

/// A sum and what rounding took from it, after Knuth. The sums over pairs cancel to a millionth in large sets, and on
/// lattices rounding goes one way.
#[derive(Clone, Copy, Default)]
struct CompensatedSum {
    sum: DVec2,
    rest: DVec2,
}

impl CompensatedSum {
    /// Returns the sum with one more value, whose rounding goes to the rest.
    fn plus(self, value: DVec2) -> Self {
        let sum = self.sum + value;
        let added = sum - self.sum;
        let lost = (self.sum - (sum - added)) + (value - added);
        Self {
            sum,
            rest: self.rest + lost,
        }
    }
}

/// The single term of a sample.
fn single(a: DVec2) -> DVec2 {
    let off = (a - 0.5).abs();
    DVec2::new(
        (1.0 - a * a).element_product(),
        (1.0 + 0.5 * off - 0.5 * off * off).element_product(),
    )
}

/// The term of a pair.
fn term(a: DVec2, b: DVec2) -> DVec2 {
    let (larger, smaller) = (a.max(b), a.min(b));
    DVec2::new(
        (1.0 - larger).element_product(),
        (high_of(larger) + low_of(smaller)).element_product(),
    )
}

/// What the larger of two coordinates gives to a term of the centred form, `1 + |a - 1/2| / 2 + |b - 1/2| / 2 - |a - b| / 2`.
fn high_of(a: DVec2) -> DVec2 {
    1.0 + 0.5 * ((a - 0.5).abs() - a)
}

/// What the smaller one gives.
fn low_of(a: DVec2) -> DVec2 {
    0.5 * ((a - 0.5).abs() + a)
}

/// The work of [`pairs`], in samples.
fn work(count: usize) -> u64 {
    let merged = if count > CHUNK {
        work(count / 2) + work(count - count / 2)
    } else {
        0
    };
    count as u64 + merged
}

/// Returns the sums over the pairs of samples that are sorted by x, and sorts them by y.
fn pairs(
    points: &mut [DVec2],
    room: &mut [DVec2],
    monitor: &Monitor<'_>,
) -> Result<DVec2, VerifyError> {
    // The pairs within each half are summed on two threads. Those between the halves are summed while these are merged.
    let count = points.len();
    let sum = if count > CHUNK {
        let (left, right) = points.split_at_mut(count / 2);
        let (left_room, right_room) = room.split_at_mut(count / 2);
        let (left_sum, right_sum) = rayon::join(
            || pairs(left, left_room, monitor),
            || pairs(right, right_room, monitor),
        );
        // Plain additions suffice here: a sum is rounded once for each halving, and a million samples are halved only
        // fifteen times.
        left_sum? + right_sum? + merge(points, room)
    } else {
        pairs_of_chunk(points, room)
    };
    monitor.advance(count as u64)?;
    Ok(sum)
}

/// Does on one thread what [`pairs`] does on several.
fn pairs_of_chunk(points: &mut [DVec2], room: &mut [DVec2]) -> DVec2 {
    let count = points.len();
    if count <= FEW {
        // Each sample meets those before it, so that each pair counts once.
        let before = |(index, &b): (usize, &DVec2)| {
            let terms = points[..index].iter().map(|&a| term(a, b));
            terms.sum::<DVec2>()
        };
        let sum = points.iter().enumerate().map(before).sum();
        points.sort_by(|a, b| a.y.total_cmp(&b.y));
        return sum;
    }

    let (left, right) = points.split_at_mut(count / 2);
    let (left_room, right_room) = room.split_at_mut(count / 2);
    pairs_of_chunk(left, left_room) + pairs_of_chunk(right, right_room) + merge(points, room)
}

/// Returns the sums over the pairs of a sample of the first half and one of the second half, which lies to the right of the
/// first. Each half is sorted by y; afterwards all samples are.
fn merge(points: &mut [DVec2], room: &mut [DVec2]) -> DVec2 {
    let (left_half, right_half) = points.split_at(points.len() / 2);
    // The sums of the left samples that lie below or above the next sample in the order of y. At first all lie above.
    let (mut below, mut above) = (LeftSums::default(), LeftSums::default());
    for a in left_half {
        above.add(*a, 1.0);
    }

    let mut sum = CompensatedSum::default();
    let mut left = left_half.iter().peekable();
    let mut right = right_half.iter().peekable();
    for place in room.iter_mut() {
        // Of two samples of equal y either may come first: the terms are the same.
        if let Some(a) = left.next_if(|a| right.peek().is_none_or(|b| a.y <= b.y)) {
            below.add(*a, 1.0);
            above.add(*a, -1.0);
            *place = *a;
        } else if let Some(b) = right.next() {
            sum = sum.plus(below.terms_below(*b) + above.terms_above(*b));
            *place = *b;
        }
    }
    points.copy_from_slice(room);
    sum.sum + sum.rest
}

/// Sums over samples that lie left of others.
#[derive(Clone, Copy, Default)]
struct LeftSums {
    count: f64,
    /// Of `low` along x and y, and of their product.
    low: DVec2,
    low_low: f64,
    /// Of `high` along y, and of its product with `low` along x.
    high_y: f64,
    low_high: f64,
    /// Of `1 - y`, for the star discrepancy.
    star: f64,
}

impl LeftSums {
    /// Adds a sample, or takes it away again with a sign of -1.
    fn add(&mut self, a: DVec2, sign: f64) {
        let (low, high) = (low_of(a), high_of(a));
        self.count += sign;
        self.low += sign * low;
        self.low_low += sign * low.x * low.y;
        self.high_y += sign * high.y;
        self.low_high += sign * low.x * high.y;
        self.star += sign * (1.0 - a.y);
    }

    /// The terms of a sample with these, which lie below it.
    fn terms_below(&self, b: DVec2) -> DVec2 {
        let high = high_of(b);
        let of_low = high.y * self.low.x + self.low_low;
        DVec2::new(
            (1.0 - b.x) * (1.0 - b.y) * self.count,
            high.x * (high.y * self.count + self.low.y) + of_low,
        )
    }

    /// The terms of a sample with these, which lie above it.
    fn terms_above(&self, b: DVec2) -> DVec2 {
        let (low, high) = (low_of(b), high_of(b));
        let of_low = self.low_high + low.y * self.low.x;
        DVec2::new(
            (1.0 - b.x) * self.star,
            high.x * (self.high_y + low.y * self.count) + of_low,
        )
    }
}
