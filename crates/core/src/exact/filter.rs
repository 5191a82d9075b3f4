//! A small set of samples that never misses one, but may report others.

/// Samples by the last eight bits of their numbers. A tile loses few of its samples, so that few others are reported: those only
/// cost a cut that finds nothing.
#[derive(Clone, Copy, Default)]
pub(super) struct SampleFilter([u64; 4]);

impl SampleFilter {
    /// Adds a sample.
    pub(super) const fn add(&mut self, sample: u32) {
        self.0[sample as usize / 64 % 4] |= 1 << (sample % 64);
    }

    /// Returns whether a sample, or another one with the same last eight bits, was added.
    pub(super) const fn may_have(&self, sample: u32) -> bool {
        self.0[sample as usize / 64 % 4] >> (sample % 64) & 1 == 1
    }
}
