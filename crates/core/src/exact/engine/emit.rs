//! The result: the samples of the ground's window in canonical order, and their counts.

use crate::engine::parallel::claim::tiled_tag;
use crate::engine::parallel::counts::WindowCounts;
use crate::engine::parallel::gaps::inserted_tag;
use crate::engine::parallel::window_maker::WindowSamples;
use crate::exact::engine::{ExactTiling, iteration_of};
use crate::exact::present::ArrivedSample;
use crate::lattice::{Point, Rect64};

impl ExactTiling<'_> {
    /// Puts the window's samples into `out`, in canonical order, with their counts, and with tags of their sources if they
    /// are wanted.
    pub(crate) fn emit(&self, with_tags: bool, out: &mut WindowSamples) {
        out.clear();
        self.count(&mut out.counts);
        let frame = &self.present.ground().frame;
        let (window, cells) = (frame.window, frame.window_cells());
        // No window crosses the domain's ends, so that all places are moved alike.
        let first = frame.point(window.min.x, window.min.y);
        let (right, up) = (first.x - window.min.x, first.y - window.min.y);

        let mut held = Vec::new();
        for row in cells.min.y..cells.max.y {
            for column in cells.min.x..cells.max.x {
                held.clear();
                self.present.in_cell(column, row, |id, place| {
                    // The outermost cells reach beyond the window.
                    if window.contains(place) {
                        held.push((place, id));
                    }
                });

                // Most cells have one.
                if held.len() > 1 {
                    held.sort_unstable_by_key(|(place, _)| place.row_major());
                }

                for &(place, id) in &held {
                    out.points.push(Point::new(place.x + right, place.y + up));
                    if with_tags {
                        out.tags.push(self.tag(self.present.get(id)));
                    }
                }
            }

            // How many samples there are up to the end of this row of cells.
            out.rows.push(out.points.len() as u32);
        }
    }

    fn tag(&self, sample: &ArrivedSample) -> u64 {
        match sample.pattern() {
            Some(pattern) => tiled_tag(self.tiles[sample.tile as usize].block, pattern),
            None => inserted_tag(self.iteration(sample)),
        }
    }

    /// Returns the iteration in which a sample counts as inserted.
    pub(super) fn iteration(&self, sample: &ArrivedSample) -> u32 {
        iteration_of(self.present.arrival(sample))
    }

    /// Counts what the window has.
    fn count(&self, counts: &mut WindowCounts) {
        counts.clear();
        let window = self.present.ground().frame.window;
        // Each block has its lowest corner in one window, so that the counts of all windows add up.
        let corners = self.blocks.iter().map(|block| block.rect.min);
        let inside = corners.filter(|&corner| Rect64::from(window).contains(corner));
        counts.blocks = inside.count() as u64;

        // Nearly all are the pattern's own, and stay. The rest were lost, or inserted here.
        let samples = self.present.samples().iter();
        let others = samples.filter(|sample| !sample.is_own());
        for sample in others.filter(|sample| window.contains(sample.place)) {
            // Tiled samples follow from the other counts.
            if sample.is_lost {
                counts.eliminated += 1;
            } else {
                // Iterations are counted from 1.
                counts.insert(self.iteration(sample) as usize - 1, 1);
            }
        }
    }
}
