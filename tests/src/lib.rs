//! The number of random cases that the tests of all crates try. Tests across the crates are in `tests/tests`.
//!
//! ```
//! // At least one case is tried, the first one first.
//! assert_eq!(tilescope_tests::some(["periodic", "bounded"]).next(), Some("periodic"));
//! ```

use std::env::var_os;

/// Returns how many of a test's cases to try: a sixteenth in `tests/run --fast` (`TILESCOPE_FAST=1`), all in `tests/run
/// --slow` (`TILESCOPE_SLOW=1`), otherwise an eighth; at least one.
#[must_use]
pub fn cases(all: u32) -> u32 {
    let on = |name| var_os(name).is_some_and(|value| value == "1");
    let share = match (on("TILESCOPE_SLOW"), on("TILESCOPE_FAST")) {
        (true, _) => 1,
        (false, true) => 16,
        (false, false) => 8,
    };
    all.div_ceil(share)
}

/// Returns the first of a test's cases, as many as [`cases`] gives. Callers list the cases that differ most first.
pub fn some<T, const N: usize>(all: [T; N]) -> impl Iterator<Item = T> {
    let count = cases(N as u32) as usize;
    all.into_iter().take(count)
}
