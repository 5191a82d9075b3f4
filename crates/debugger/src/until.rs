//! A recording cut off at a cursor: it has the events before the cursor, and data of no later event.

use tilescope_core::{Fate, RunEvent, Samples, Stage, Variant};

use crate::recording::Recording;

/// The counts of events before a cursor. Everything is numbered in the order of the events, so that a count says where a
/// list of the run is cut. A clip is what a block gets of the pattern; the run's list of clips is `tiles`.
#[derive(Default)]
struct Counts {
    splits: usize,
    leaves: usize,
    clips: usize,
    samples: u32,
    iterations: usize,
    /// Of the last iteration alone, as are the next two.
    detectors: usize,
    candidates: usize,
    inserted: u32,
    is_within_iteration: bool,
    is_finished: bool,
}

impl Counts {
    /// Counts an event, the next one of the run.
    fn add(&mut self, run_event: RunEvent) {
        match run_event {
            RunEvent::Split { .. } => self.splits += 1,
            RunEvent::Leaf { .. } => self.leaves += 1,
            RunEvent::Clip { .. } => self.clips += 1,
            RunEvent::Tiled { .. } => self.samples += 1,
            RunEvent::Begin(Stage::Finish) => self.is_finished = true,

            // Counts within an iteration begin anew with each: only the last iteration may be incomplete and needs them.
            RunEvent::Iteration { number, .. } => {
                (self.iterations, self.is_within_iteration) = (number as usize, true);
                (self.detectors, self.candidates, self.inserted) = (0, 0, 0);
            }
            RunEvent::IterationEnd { .. } => self.is_within_iteration = false,
            RunEvent::Detect { .. } => self.detectors += 1,
            // The list of an iteration's candidates is there once the last of them is found. The event that puts them
            // in order follows at once, and has their number.
            RunEvent::Rank { candidates } => self.candidates = candidates as usize,

            // Algorithm 4 as printed inserts in iteration 1 without an event that begins it: the insertion shows that
            // it has begun. Its iterations have no active cells, which `is_within_iteration` is about.
            RunEvent::Insert { iteration, .. } => {
                (self.samples, self.inserted) = (self.samples + 1, self.inserted + 1);
                self.iterations = self.iterations.max(iteration as usize);
            }

            // Other events add to none of the run's lists.
            _ => {}
        }
    }
}

impl Recording {
    /// Returns the recording of the first `cursor` events. It holds no data of later ones: no later samples, fates,
    /// blocks, candidates and iterations, and a result only if the run had finished. States at its cursors equal those of
    /// this recording.
    #[must_use]
    pub fn until(&self, cursor: usize) -> Self {
        let cursor = cursor.min(self.len());
        // A recording of nested levels has samples alone, whose events are their arrivals: no stage could be cut.
        if let Some(first) = self.first_of_levels(cursor) {
            return first;
        }

        let mut run = self.run().clone();

        let mut counts = Counts::default();
        let events = self.tape().from(0).take(cursor);
        for run_event in events.filter_map(|(_, event)| event.run_event()) {
            counts.add(run_event);
        }

        run.blocks.splits.truncate(counts.splits);
        run.blocks.leaves.truncate(counts.leaves);
        run.tiles.truncate(counts.clips);
        // The last clip may be cut within its samples. Ids of samples count from 0, so that the count is the end.
        if let Some(last) = run.tiles.last_mut() {
            last.samples.end = last.samples.end.min(counts.samples);
        }

        self.cut_samples(&mut run.samples, counts.samples as usize, cursor);

        run.iterations.truncate(counts.iterations);
        // Without iterations the index wraps to the largest number, at which no list has an entry.
        if let Some(last) = run.iterations.get_mut(counts.iterations.wrapping_sub(1)) {
            // Inserted samples have ids in a row. Where none is inserted so far, the range is empty, within the samples left.
            let start = last.inserted.start.min(counts.samples);
            last.inserted = start..(start + counts.inserted).min(last.inserted.end);
            last.candidates.truncate(counts.candidates);

            // In Algorithm 4 as printed samples become detectors within the iteration; in stages all are known at its start.
            if run.parameters.variant == Variant::AsPrinted {
                last.detectors.truncate(counts.detectors);
            }

            // A run gets an iteration's list of active cells at the iteration's end.
            if counts.is_within_iteration {
                last.cells.clear();
            }
        }

        if !counts.is_finished {
            run.result.clear();
        }

        let tape = self.tape().until(&run.parameters, cursor);
        let mut past = Self::of(run, tape);
        past.heights = self.heights.clone().map(|heights| heights.of(past.run()));

        // A cut at the start or the end of the run, or at the end of a stage, leaves whole stages only.
        past.is_cut_within_stage =
            (1..self.len()).contains(&cursor) && self.stage_ending_at(cursor).is_none();
        past
    }

    /// Leaves the first `count` samples, with the fates that they have at a cursor.
    fn cut_samples(&self, samples: &mut Samples, count: usize, cursor: usize) {
        samples.points.truncate(count);
        samples.origins.truncate(count);
        samples.fates.truncate(count);

        // A fate is that of the whole run. Where its event lies ahead, the sample is undecided at the cursor. Dropped
        // samples were dropped when they were tiled.
        for (id, fate) in (0..).zip(&mut samples.fates) {
            let life = self.life(id);
            let before = |event: u32| (event as usize) < cursor;
            if *fate != Fate::Dropped && !life.is_some_and(|l| before(l.kept) || before(l.lost)) {
                *fate = Fate::Undecided;
            }
        }
    }

    /// Returns whether this is the recording of the first events of a stage and of all before it, made by [`Self::until`].
    #[must_use]
    pub const fn is_cut_within_stage(&self) -> bool {
        self.is_cut_within_stage
    }
}
