//! The last few patterns of runs, kept so that they are not generated again: equal specs have equal patterns.
//! Generating the default pattern takes 12 ms, natively and as WebAssembly.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::error::{ParameterError, SampleError};
use crate::lattice::{Boundary, Point};
use crate::parameters::PatternSpec;
use crate::pattern::Pattern;
use crate::progress::{Meter, Observer};
use crate::stage::Stage;

/// The most patterns kept.
const MAX_PATTERNS: usize = 8;

/// The most bytes of samples kept: two of the largest patterns, of 22 MB each, and many of the usual size.
const MAX_BYTES: usize = 64 << 20;

static KEPT: Mutex<Kept> = Mutex::new(Kept::new(MAX_PATTERNS, MAX_BYTES));

impl Pattern {
    /// Returns the pattern that `spec` describes: the same as [`Self::generate`], but made only if it is not among the
    /// last few that were used.
    ///
    /// The observer is called for [`Stage::Pattern`] in any case and may stop it. Patterns are kept for the whole
    /// process, at most 8 and 64 MB; the least recently used go first.
    ///
    /// ```
    /// use tilescope_core::{Pattern, PatternSpec, Unobserved};
    ///
    /// let pattern = Pattern::of_spec(&PatternSpec::default(), &mut Unobserved)?;
    /// assert_eq!(pattern.samples().len(), 6985);
    /// # Ok::<(), tilescope_core::SampleError>(())
    /// ```
    pub fn of_spec(
        spec: &PatternSpec,
        observer: &mut dyn Observer,
    ) -> Result<Arc<Self>, SampleError> {
        of_spec(&KEPT, spec, observer)
    }
}

/// Returns the pattern of a description, from those that are kept if it is among them.
fn of_spec(
    kept: &Mutex<Kept>,
    spec: &PatternSpec,
    observer: &mut dyn Observer,
) -> Result<Arc<Pattern>, SampleError> {
    let wanted = identity(spec)?;

    let found = lock(kept).find(wanted);
    let pattern = if let Some(pattern) = found {
        // The stage is reported in any case, so that an observer can stop the run.
        let total = pattern.samples().len() as u64;
        Meter::begin(observer, Stage::Pattern, total)?.end()?;
        pattern
    } else {
        // The pattern is made without the lock, so that a run that needs another one does not wait for it.
        Arc::new(Pattern::generate(spec, observer)?)
    };

    // One that was found becomes the most recently used one.
    lock(kept).keep(wanted, Arc::clone(&pattern));
    Ok(pattern)
}

/// The list is usable after a panic elsewhere, since each change of it is one call that does not fail.
fn lock(kept: &Mutex<Kept>) -> MutexGuard<'_, Kept> {
    kept.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A pattern's side on the lattice, boundary and seed: sides that differ by less than a unit are equal.
type Identity = (i32, Boundary, u64);

fn identity(spec: &PatternSpec) -> Result<Identity, ParameterError> {
    Ok((spec.side_units()?, spec.boundary, spec.seed))
}

/// Patterns kept for later, the least recently used first.
struct Kept {
    patterns: Vec<(Identity, Arc<Pattern>)>,
    max_patterns: usize,
    max_bytes: usize,
}

impl Kept {
    const fn new(max_patterns: usize, max_bytes: usize) -> Self {
        Self {
            patterns: Vec::new(),
            max_patterns,
            max_bytes,
        }
    }

    fn find(&self, identity: Identity) -> Option<Arc<Pattern>> {
        let mut all = self.patterns.iter();
        let (_, pattern) = all.find(|(kept, _)| *kept == identity)?;
        Some(Arc::clone(pattern))
    }

    /// Keeps a pattern as the most recently used one, and drops others beyond the limits.
    fn keep(&mut self, identity: Identity, pattern: Arc<Pattern>) {
        self.patterns.retain(|(kept, _)| *kept != identity);
        self.patterns.push((identity, pattern));
        while self.patterns.len() > self.max_patterns || self.bytes() > self.max_bytes {
            self.patterns.remove(0);
        }
    }

    fn bytes(&self) -> usize {
        let samples = self.patterns.iter().map(|(_, p)| p.samples().len());
        samples.sum::<usize>() * size_of::<Point>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::{Progress, Unobserved};
    use std::ops::ControlFlow;

    fn spec(side: f64, seed: u64) -> PatternSpec {
        PatternSpec {
            side,
            boundary: Boundary::Periodic,
            seed,
        }
    }

    fn ask(kept: &Mutex<Kept>, seed: u64) -> Arc<Pattern> {
        of_spec(kept, &spec(10.5, seed), &mut Unobserved).unwrap()
    }

    fn seeds(kept: &Mutex<Kept>) -> Vec<u64> {
        let kept = kept.lock().unwrap();
        kept.patterns.iter().map(|((.., seed), _)| *seed).collect()
    }

    #[test]
    fn a_pattern_is_made_once_and_is_the_generated_one() {
        let kept = Mutex::new(Kept::new(2, MAX_BYTES));
        let first = ask(&kept, 3);
        let generated = Pattern::generate(&spec(10.5, 3), &mut Unobserved).unwrap();
        assert_eq!(*first, generated);
        assert!(Arc::ptr_eq(&first, &ask(&kept, 3)));
        assert_ne!(*first, *ask(&kept, 4));
    }

    #[test]
    fn the_least_recently_used_pattern_goes_first() {
        let kept = Mutex::new(Kept::new(3, MAX_BYTES));
        for seed in [1, 2, 3, 1, 4] {
            let _ = ask(&kept, seed);
        }
        assert_eq!(seeds(&kept), [3, 1, 4]);
    }

    #[test]
    fn bytes_are_bounded_too() {
        // Each has about 77 samples of 8 bytes.
        let kept = Mutex::new(Kept::new(100, 1400));
        for seed in 1..6 {
            let _ = ask(&kept, seed);
        }
        assert_eq!(seeds(&kept), [4, 5]);
        let nothing = Mutex::new(Kept::new(100, 1));
        let _ = ask(&nothing, 1);
        assert!(seeds(&nothing).is_empty());
    }

    #[test]
    fn a_kept_pattern_is_reported_as_done() {
        let kept = Mutex::new(Kept::new(1, MAX_BYTES));
        let total = ask(&kept, 5).samples().len() as u64;
        let mut reported = Vec::new();
        let mut observer = |progress| {
            reported.push(progress);
            ControlFlow::Continue(())
        };
        let _ = of_spec(&kept, &spec(10.5, 5), &mut observer).unwrap();
        let stage = Stage::Pattern;
        let expected = [0, total].map(|done| Progress { stage, done, total });
        assert_eq!(reported, expected);
    }

    #[test]
    fn sides_that_differ_by_less_than_a_unit_are_one_pattern() {
        let of = |side| identity(&spec(side, 0)).unwrap();
        assert_eq!(of(100.0), of(100.0 + 1e-9));
        assert_ne!(of(100.0), of(100.01));
    }

    #[test]
    fn whoever_observes_may_stop_it() {
        let mut stop = |_| ControlFlow::Break(());
        for side in [100.0, 10.5] {
            let kept = Mutex::new(Kept::new(1, MAX_BYTES));
            let stage = Stage::Pattern;
            let outcome = of_spec(&kept, &spec(side, 0), &mut stop);
            assert_eq!(outcome, Err(SampleError::Cancelled { stage }));
            assert!(seeds(&kept).is_empty());
        }
    }

    #[test]
    fn an_impossible_side_is_refused_and_a_panic_elsewhere_is_survived() {
        let kept = Mutex::new(Kept::new(2, MAX_BYTES));
        let refused = of_spec(&kept, &spec(9.0, 0), &mut Unobserved);
        assert!(matches!(refused, Err(SampleError::Parameters(_))));
        let panicked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            let _guard = kept.lock();
            panic!("while it was locked");
        }));
        assert!(panicked.is_err() && kept.is_poisoned());
        assert_eq!(*ask(&kept, 1), *ask(&kept, 1));
    }
}
