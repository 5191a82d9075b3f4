//! A whole run by windows that are made without each other, and the proof that together they are the run.
//!
//! What a window has near the ends of its halo is not what the domain has there, and differences spread. A window alone can be
//! certain of its samples only by following all that is in doubt, which takes as long as the samples. A whole run needs no
//! doubt: *if each window has the samples within r of it as its neighbours made them, all samples are right.* For then each
//! dart of a window is a sample exactly if no earlier sample *of the whole* covers it, since its own window decided so among
//! the same samples; and only one set has that property everywhere (induction over the order of arrival).

use std::sync::{Mutex, PoisonError};

use rayon::prelude::*;

use crate::engine::parallel::window_maker::parts;
use crate::lattice::{Domain, Point, R, Rect, Window};

/// A window, and what it had around itself.
struct Surrounded {
    window: Rect,
    /// The samples outside of the window but at most R from it on both axes, in the sequence of [`strips`].
    around: Vec<Point>,
}

/// What windows that were made alone had around themselves.
#[derive(Default)]
pub(super) struct Agreement {
    windows: Mutex<Vec<Surrounded>>,
}

impl Agreement {
    /// Keeps what a window had around itself.
    pub(super) fn add(&self, window: Rect, around: Vec<Point>) {
        let mut windows = self.windows.lock().unwrap_or_else(PoisonError::into_inner);
        windows.push(Surrounded { window, around });
    }

    /// Returns whether each window had around itself what all windows together have there: `points`, in canonical order.
    pub(super) fn holds(&self, domain: &Domain, points: &[Point]) -> bool {
        let windows = self.windows.lock().unwrap_or_else(PoisonError::into_inner);
        windows.par_iter().all(|held| {
            let mut made = Vec::with_capacity(held.around.len());
            for strip in strips(&held.window) {
                for part in parts(domain, &strip) {
                    append_within(points, &part, &mut made);
                }
            }
            // Where an end of a periodic domain crosses a strip, its parts follow each other in another sequence.
            made == held.around || sorted(made) == sorted(held.around.clone())
        })
    }
}

/// Returns samples in canonical order.
fn sorted(mut points: Vec<Point>) -> Vec<Point> {
    points.sort_unstable_by_key(|point| point.canonical());
    points
}

/// Returns the four strips of width R around a window, which do not overlap.
fn strips(window: &Rect) -> [Window; 4] {
    let (inner, reach) = (Window::from(*window), i64::from(R));
    inner.grown(reach, reach).without(&inner)
}

/// Appends to `out` those of `points`, which are in canonical order, that lie in a rectangle.
fn append_within(points: &[Point], rect: &Rect, out: &mut Vec<Point>) {
    for row in rect.min.y / R..=(rect.max.y - 1) / R {
        // Cells of a row follow each other, so that those of the rectangle are one range.
        let start = Point::new(rect.min.x / R * R, row * R).canonical();
        let first = points.partition_point(|point| point.canonical() < start);
        let last_column = (rect.max.x - 1) / R;
        let in_row = |point: &&Point| point.y / R == row && point.x / R <= last_column;
        let held = points[first..].iter().take_while(in_row);
        out.extend(held.filter(|point| rect.contains(**point)));
    }
}
