//! Keeps the few worst of many witnesses in bounded memory. The order is total, so the same witnesses remain however
//! the work was divided. Counting is left to the caller.

use std::cmp::Ordering;

use serde::{Deserialize, Serialize};

use crate::witness::{Conflict, Gap};

/// A witness with a total order in which the worst comes first.
pub(crate) trait Witness: Copy {
    /// The order of witnesses: the worst comes first.
    fn rank(&self, other: &Self) -> Ordering;
}

impl Witness for Conflict {
    fn rank(&self, other: &Self) -> Ordering {
        let ends = |pair: &Self| (pair.first, pair.second);
        self.distance
            .total_cmp(&other.distance)
            .then_with(|| ends(self).cmp(&ends(other)))
    }
}

impl Witness for Gap {
    fn rank(&self, other: &Self) -> Ordering {
        (other.distance.total_cmp(&self.distance))
            .then_with(|| self.center[0].total_cmp(&other.center[0]))
            .then_with(|| self.center[1].total_cmp(&other.center[1]))
    }
}

/// The `limit` worst of the witnesses pushed so far.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Worst<T> {
    limit: usize,
    kept: Vec<T>,
    mildest: Option<T>,
}

impl<T: Witness> Worst<T> {
    pub fn new(limit: usize) -> Self {
        Self {
            limit,
            kept: Vec::new(),
            mildest: None,
        }
    }

    /// Takes a witness, unless `limit` others are known to be worse.
    pub fn push(&mut self, witness: T) {
        if (self.mildest.as_ref()).is_some_and(|mildest| witness.rank(mildest).is_ge()) {
            return;
        }
        self.kept.push(witness);
        // Room for as many again makes the sorting cheap on average.
        if self.kept.len() >= 2 * self.limit + 16 {
            self.prune();
        }
    }

    pub fn merge(&mut self, other: Self) {
        self.kept.extend(other.kept);
        self.prune();
    }

    /// The mildest of `limit` witnesses, once there are that many: from then on only worse ones are kept.
    pub fn mildest(&self) -> Option<&T> {
        self.mildest.as_ref()
    }

    /// The kept witnesses, worst first.
    pub fn into_sorted(mut self) -> Vec<T> {
        self.prune();
        self.kept
    }

    /// Drops all but the worst witnesses, up to the limit.
    fn prune(&mut self) {
        self.kept.sort_unstable_by(T::rank);
        self.kept.truncate(self.limit);
        if self.kept.len() == self.limit {
            self.mildest = self.kept.last().copied();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_the_worst_in_order_whatever_the_order_of_arrival() {
        let conflict = |i: usize| Conflict {
            first: i,
            second: i + 1,
            distance: ((i * 37) % 101) as f64,
        };
        let mut all = Worst::new(5);
        (0..100).for_each(|i| all.push(conflict(i)));
        let (mut left, mut right) = (Worst::new(5), Worst::new(5));
        (0..50).for_each(|i| left.push(conflict(99 - i)));
        (50..100).for_each(|i| right.push(conflict(99 - i)));
        right.merge(left);
        let all = all.into_sorted();
        assert_eq!(all.len(), 5);
        assert!(all.windows(2).all(|w| w[0].distance <= w[1].distance));
        assert_eq!(all[0].distance, 0.0);
        assert_eq!(all, right.into_sorted());
        assert!(Worst::<Conflict>::new(0).into_sorted().is_empty());
    }
}
