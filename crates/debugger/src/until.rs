//! A recording cut off at a cursor: what had happened until then, and nothing of what happened later.

use tilescope_core::{Fate, RunEvent, Stage, Variant};

use crate::recording::Recording;

impl Recording {
    /// Returns the recording of the first `cursor` events. It holds nothing of later ones: no later samples, fates,
    /// blocks, candidates and iterations, and a result only if the run had finished. States at its cursors equal those of
    /// this recording.
    #[must_use]
    pub fn until(&self, cursor: usize) -> Self {
        let cursor = cursor.min(self.len());
        let mut run = self.run().clone();
        let (mut splits, mut leaves, mut clips, mut samples) = (0, 0, 0, 0);
        let (mut iterations, mut detectors, mut candidates) = (0, 0, 0);
        let (mut inserted, mut ended, mut finished) = (0, true, false);
        for (_, event) in self.tape().from(0).take(cursor) {
            match event.run_event() {
                Some(RunEvent::Split { .. }) => splits += 1,
                Some(RunEvent::Leaf { .. }) => leaves += 1,
                Some(RunEvent::Clip { .. }) => clips += 1,
                Some(RunEvent::Tiled { .. }) => samples += 1,
                Some(RunEvent::Begin(Stage::Finish)) => finished = true,
                Some(RunEvent::Iteration { number, .. }) => {
                    (iterations, inserted) = (number as usize, 0);
                    (detectors, candidates, ended) = (0, 0, false);
                }
                Some(RunEvent::IterationEnd { .. }) => ended = true,
                Some(RunEvent::Detect { .. }) => detectors += 1,
                Some(RunEvent::Rank { candidates: all }) => candidates = all as usize,
                Some(RunEvent::Insert { iteration, .. }) => {
                    (samples, inserted) = (samples + 1, inserted + 1);
                    iterations = iterations.max(iteration as usize);
                }
                _ => {}
            }
        }
        run.blocks.splits.truncate(splits);
        run.blocks.leaves.truncate(leaves);
        run.tiles.truncate(clips);
        if let Some(last) = run.tiles.last_mut() {
            last.samples.end = last.samples.end.min(samples);
        }
        run.samples.points.truncate(samples as usize);
        run.samples.origins.truncate(samples as usize);
        run.samples.fates.truncate(samples as usize);
        for (id, fate) in (0..).zip(&mut run.samples.fates) {
            let life = self.life(id);
            let before = |event: u32| (event as usize) < cursor;
            if *fate != Fate::Dropped && !life.is_some_and(|l| before(l.kept) || before(l.lost)) {
                *fate = Fate::Undecided;
            }
        }
        run.iterations.truncate(iterations);
        if let Some(last) = run.iterations.get_mut(iterations.wrapping_sub(1)) {
            let start = last.inserted.start.min(samples);
            last.inserted = start..(start + inserted).min(last.inserted.end);
            last.candidates.truncate(candidates);
            // In Algorithm 4 as printed samples become detectors within the iteration.
            if run.parameters.variant == Variant::AsPrinted {
                last.detectors.truncate(detectors);
            }
            if !ended {
                last.cells.clear();
            }
        }
        if !finished {
            run.result.clear();
        }
        let tape = self.tape().until(&run.parameters, cursor);
        let mut past = Self::of(run, tape);
        past.is_cut_within_stage =
            (1..self.len()).contains(&cursor) && self.stage_ending_at(cursor).is_none();
        past
    }

    /// Returns whether this is the recording of the first events of a stage and of all before it, made by [`Self::until`].
    #[must_use]
    pub const fn is_cut_within_stage(&self) -> bool {
        self.is_cut_within_stage
    }
}
