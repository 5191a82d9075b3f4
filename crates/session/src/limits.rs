//! How large a set may be, in the program and on a page.

/// As [`MAX_STAGED`], on a page.
pub const MAX_STAGED_ON_A_PAGE: f64 = 200_000.0;

/// Sets expected to be larger are made by the parallel engine, which keeps the result alone: the sequential one takes
/// 105 bytes for each sample and ten times as long.
///
/// A page keeps less: its memory is that of a tab, and a session is there twice, in a worker and in the window.
pub const MAX_STAGED: f64 = if cfg!(target_arch = "wasm32") {
    MAX_STAGED_ON_A_PAGE
} else {
    500_000.0
};

/// The most samples of a run on a page: a tab has no room for more.
pub const MAX_ON_A_PAGE: f64 = 2_000_000.0;

/// The longest point set that is read: a million samples as text.
pub const MAX_PATTERN_BYTES: u64 = 100_000_000;

/// The most samples of a run whose passes are shown on a page: the CPU's twin computes between its frames.
pub const MAX_PASSES_ON_A_PAGE: usize = 50_000;
