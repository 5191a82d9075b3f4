//! Limits on the size of sets and files, natively and on a page.

/// [`MAX_STAGED`] on a page.
pub const MAX_STAGED_ON_A_PAGE: f64 = 200_000.0;

/// Above this expected size, the parallel engine makes the set and keeps only the result: the sequential one
/// takes 105 bytes for each sample and ten times as long.
///
/// A page has a lower limit: a tab has little memory, and holds each session twice, in a worker and in the window.
pub const MAX_STAGED: f64 = if cfg!(target_arch = "wasm32") {
    MAX_STAGED_ON_A_PAGE
} else {
    500_000.0
};

/// The most samples of a run on a page, limited by the memory of a tab.
pub const MAX_ON_A_PAGE: f64 = 2_000_000.0;

/// The longest point set that is read, in bytes: enough for a million samples as text.
pub const MAX_PATTERN_BYTES: u64 = 100_000_000;

/// The most samples of a run whose passes are shown on a page, where the CPU computes the comparison between
/// frames.
pub const MAX_PASSES_ON_A_PAGE: usize = 50_000;
