//! The samples around a bin, found row by row.

use std::ops::RangeInclusive;

use super::{Binned, Bins, key};

/// The start of a row is first looked for among this many samples, one by one, from the start of that row around the
/// bin before. Chosen, not measured.
const NEAR: usize = 8;

/// The samples around one bin after another.
pub(super) struct Around<'a> {
    bins: &'a Bins<'a>,
    /// The samples in a bin and in those around it, row by row, each once.
    pub rows: Vec<&'a [Binned]>,
    /// Where each row began when the bin before was looked at. From one bin to the next a row moves on by few samples, and a
    /// search among all of them took a third of the judge's time.
    starts: Vec<usize>,
}

impl<'a> Around<'a> {
    pub const fn of(bins: &'a Bins<'a>) -> Self {
        Self {
            bins,
            rows: Vec::new(),
            starts: Vec::new(),
        }
    }

    /// Finds the rows around a bin.
    pub fn find(&mut self, bin: u128) {
        let number = |axis: u32| (bin >> (32 * axis)) as u64 & u64::from(u32::MAX);
        let [columns, rows, planes] = [0, 1, 2].map(|axis| self.spans(number(axis), axis));

        self.rows.clear();
        for z in planes.iter().cloned().flatten() {
            for y in rows.iter().cloned().flatten() {
                for x in columns.iter().filter(|columns| !columns.is_empty()) {
                    let (low, high) = (key(*x.start(), y, z), key(*x.end(), y, z));
                    // No bin before had so many rows around it. This row is searched from the front of all samples.
                    if self.starts.len() == self.rows.len() {
                        self.starts.push(0);
                    }
                    let start = &mut self.starts[self.rows.len()];
                    *start = first_at(&self.bins.binned, low, *start);

                    let row = &self.bins.binned[*start..];
                    // The end is searched one by one, as the row is nearly always short.
                    let beyond = row.iter().position(|sample| sample.key > high);
                    self.rows.push(&row[..beyond.unwrap_or(row.len())]);
                }
            }
        }
    }

    /// Returns the numbers on an axis of a bin and of those beside it, in two ranges, of which the second is mostly empty.
    fn spans(&self, number: u64, axis: u32) -> [RangeInclusive<u64>; 2] {
        let count = self.bins.counts[axis as usize];
        let last = count - 1;
        let none = RangeInclusive::new(1, 0);
        // Around a torus of three bins each is beside each. In a bounded region, to look at all of so few does no harm.
        if count <= 3 {
            return [0..=last, none];
        }

        let inside = number.saturating_sub(1)..=last.min(number + 1);
        // With more than three bins none is both the first and the last.
        let beyond = if self.bins.region.is_periodic() && number == 0 {
            last..=last
        } else if self.bins.region.is_periodic() && number == last {
            0..=0
        } else {
            none
        };
        [inside, beyond]
    }
}

/// Returns the index of the first sample whose bin has this key or a larger one, looked for from the place at which such a search
/// ended before.
fn first_at(binned: &[Binned], key: u128, hint: usize) -> usize {
    let is_before = |sample: &Binned| sample.key < key;
    // Behind the last bin along x come those of the next y: there the rows around begin anew, some of them farther back.
    let from = match hint.checked_sub(1) {
        Some(last) if !is_before(&binned[last]) => 0,
        _ => hint,
    };
    let rest = &binned[from..];
    let mut near = rest.iter().take(NEAR);
    let steps = near.position(|sample| !is_before(sample));
    from + steps.unwrap_or_else(|| rest.partition_point(is_before))
}
