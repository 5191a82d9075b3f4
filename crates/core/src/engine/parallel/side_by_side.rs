//! Pieces of work on all threads, which may be stopped between any two of them.

use std::ops::ControlFlow;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use crate::error::SampleError;
use crate::progress::{Observer, Progress};

/// Returns what `compute` makes of each piece, in their order.
///
/// The pieces are taken in turn by all threads of the current pool. `observer` stays on the calling thread, which asks it
/// before each piece that it takes itself, with the progress after all pieces taken so far. `compute` is given an observer,
/// too, for pieces that take long: on the calling thread that one asks `observer`, and on the others it only looks whether
/// `observer` has stopped the work. Then an error is returned, and no result.
pub(crate) fn compute_each<P: Sync, T: Send + Sync>(
    pieces: &[P],
    observer: &mut dyn Observer,
    progress: impl Fn(usize) -> Progress,
    compute: impl Fn(&P, &mut dyn Observer) -> T + Sync,
) -> Result<Vec<T>, SampleError> {
    let made: Vec<OnceLock<T>> = pieces.iter().map(|_| OnceLock::new()).collect();
    let (next, is_stopped) = (AtomicUsize::new(0), AtomicBool::new(false));

    // Each index is taken once, by a thread that is free. Relaxed order is enough: results are handed over by their
    // `OnceLock` and by the end of the scope.
    let take = || {
        let index = next.fetch_add(1, Ordering::Relaxed);
        (index < pieces.len() && !is_stopped.load(Ordering::Relaxed)).then_some(index)
    };
    let make = |index: usize, observer: &mut dyn Observer| {
        made[index].get_or_init(|| compute(&pieces[index], observer));
    };

    rayon::in_place_scope(|scope| {
        // One thread less is started, since the calling thread takes pieces, too.
        for _ in 1..rayon::current_num_threads().min(pieces.len()) {
            scope.spawn(|_| {
                let mut look = |_: Progress| flow(is_stopped.load(Ordering::Relaxed));
                while let Some(index) = take() {
                    make(index, &mut look);
                }
            });
        }

        while let Some(index) = take() {
            let now = progress(index);
            // The progress within a piece is not passed on: `observer` is shown that of the pieces.
            let mut ask = |_: Progress| {
                if observer.observe(now).is_break() {
                    is_stopped.store(true, Ordering::Relaxed);
                }
                flow(is_stopped.load(Ordering::Relaxed))
            };
            if ask(now).is_break() {
                break;
            }
            make(index, &mut ask);
        }
    });

    if is_stopped.into_inner() {
        let Progress { stage, .. } = progress(0);
        return Err(SampleError::Cancelled { stage });
    }

    // Nothing was stopped, so that every piece was made.
    Ok(made.into_iter().filter_map(OnceLock::into_inner).collect())
}

const fn flow(is_stopped: bool) -> ControlFlow<()> {
    if is_stopped {
        ControlFlow::Break(())
    } else {
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Unobserved;
    use crate::stage::Stage;

    const PIECES: [usize; 9] = [3, 1, 4, 1, 5, 9, 2, 6, 5];

    fn progress(done: usize) -> Progress {
        let (done, total) = (done as u64, PIECES.len() as u64);
        let stage = Stage::Regions;
        Progress { stage, done, total }
    }

    fn on<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build().unwrap().install(work)
    }

    #[test]
    fn every_piece_is_computed_in_its_place_on_any_number_of_threads() {
        for threads in [1, 2, 7] {
            let squares = on(threads, || {
                compute_each(&PIECES, &mut Unobserved, progress, |piece, _| piece * piece)
            });
            assert_eq!(squares, Ok(PIECES.map(|piece| piece * piece).to_vec()));
        }
        let none: [usize; 0] = [];
        let found = compute_each(&none, &mut Unobserved, progress, |piece, _| *piece);
        assert_eq!(found, Ok(Vec::new()));
    }

    /// The observer is asked before each piece and within it, and no other piece begins after it stops.
    #[test]
    fn the_observer_stops_it_between_pieces_and_within_one() {
        for (looks, stop_at, begun) in [(0, 3, 2), (0, 9, 8), (1, 3, 1), (1, 4, 2), (4, 2, 1)] {
            let (asked, computed) = (AtomicUsize::new(0), AtomicUsize::new(0));
            let mut stop = |_: Progress| flow(asked.fetch_add(1, Ordering::Relaxed) + 1 == stop_at);
            let stopped = on(1, || {
                // The observer need not be of the pool's thread.
                compute_each(&PIECES, &mut stop, progress, |_, observer| {
                    computed.fetch_add(1, Ordering::Relaxed);
                    (0..looks).all(|_| observer.observe(progress(0)).is_continue())
                })
            });
            let stage = Stage::Regions;
            assert_eq!(stopped, Err(SampleError::Cancelled { stage }));
            assert_eq!(asked.into_inner(), stop_at, "{looks} looks a piece");
            assert_eq!(
                computed.into_inner(),
                begun,
                "{looks} looks, stop {stop_at}"
            );
        }
    }

    /// Threads beside the one whose observer stops see it within their pieces: otherwise these would have no end.
    #[test]
    fn other_threads_stop_within_their_pieces() {
        let begun = AtomicUsize::new(0);
        // Says so once all threads have begun, which is the case after the pieces of two others.
        let mut stop = |_: Progress| flow(begun.load(Ordering::Relaxed) == 3);
        let stopped = on(3, || {
            compute_each(&PIECES, &mut stop, progress, |_, observer| {
                begun.fetch_add(1, Ordering::Relaxed);
                while observer.observe(progress(0)).is_continue() {
                    std::thread::yield_now();
                }
            })
        });
        let stage = Stage::Regions;
        assert_eq!(stopped, Err(SampleError::Cancelled { stage }));
    }
}
