//! The octaves of the active cells of a set in a field of radii. The process of darts begins with *base cells*, as wide as
//! the power of two below the least radius in them, and cuts them in four from level to level. The *octave* of a cell is
//! that of its base cell: 0 where radii are least, and one more for each doubling. It says what darts of a cell are
//! thinned against. Begin with [`Session::octaves`].

use serde::{Deserialize, Serialize};
use tilescope_core::stages::darts::throws;
use tilescope_core::{Run, Stage};

use crate::session::Session;
use crate::units::radii;
use crate::words::counted;

/// The octaves that cells of a set can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Octaves {
    /// The binary logarithm of the side of the base cells of octave 0, in units.
    least_bits: u32,
    /// How many there are: at least two.
    count: u32,
}

impl Octaves {
    /// Returns those of a run in a field; `None` where all radii are within one octave, and all cells of a throw alike.
    fn of(run: &Run) -> Option<Self> {
        let extremes = run.locality.as_deref()?.field.extremes();
        // A base cell is no wider than the least radius in it, and never needs to be smaller than the power of two below.
        let [least_bits, most_bits] = extremes.map(|radius| radius.max(1).ilog2());
        let count = most_bits - least_bits + 1;
        (count > 1).then_some(Self { least_bits, count })
    }

    /// Returns each octave by its number.
    #[must_use]
    pub fn all(self) -> std::ops::Range<usize> {
        0..self.count as usize
    }

    /// Returns the octave of a cell that is `side` units wide in a throw, counted from 1.
    #[must_use]
    pub fn of_cell(self, throw: u32, side: i32) -> usize {
        // Cells of level 0 are base cells, and throw several times; each throw after these has a level of its own, in
        // which cells are half as wide as before.
        let level = throw.saturating_sub(throws(0));
        let base_bits = side.max(1).ilog2() + level;
        // The bounds hold for all cells of the process. Cells of a file that says otherwise get the nearest octave.
        base_bits
            .saturating_sub(self.least_bits)
            .min(self.count - 1) as usize
    }

    /// Returns where an octave lies from the first, at 0, to the last, at 1.
    #[must_use]
    pub fn share(self, octave: usize) -> f32 {
        octave as f32 / (self.count - 1) as f32
    }

    /// Returns what the colour of an octave means, in a few words.
    #[must_use]
    pub fn meaning(self, octave: usize) -> String {
        let base = radii(1 << (self.least_bits + octave as u32));
        format!("active cell of octave {octave}: at first {base} r wide")
    }
}

impl Session {
    /// Returns the octaves of its active cells; `None` of sets of one octave, and of those that are made otherwise than by
    /// darts in a field.
    #[must_use]
    pub fn octaves(&self) -> Option<Octaves> {
        // In space all cubes of a throw have one side, and tiles throw darts at gaps alone.
        let has_cells = self.is_in_field() && self.solid.is_none() && self.recording().is_some();
        if has_cells {
            Octaves::of(self.run())
        } else {
            None
        }
    }

    /// Returns how many cells of each octave are active in the throw at a stage; `None` at other stages, and of sets without
    /// octaves.
    #[must_use]
    pub fn cells_by_octave(&self, stage: Stage) -> Option<Vec<usize>> {
        let octaves = self.octaves()?;
        let Stage::Iterate(throw) = stage else {
            return None;
        };
        let mut counts = vec![0; octaves.all().len()];
        for cell in &self.iteration(throw)?.cells {
            counts[octaves.of_cell(throw, cell.side)] += 1;
        }
        Some(counts)
    }
}

/// Returns the words for cells of an octave, such as "12 active cells of octave 2".
#[must_use]
pub fn counted_cells(count: usize, octave: usize) -> String {
    let cells = counted(count, "active cell", "active cells");
    format!("{cells} of octave {octave}")
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use tilescope_core::stages::disks::Cell;

    use super::*;
    use crate::draft::Preset;
    use crate::ground::GroundRequest;
    use crate::jobs::{Job, Wake};
    use crate::recipe::Recipe;
    use crate::varying::sample;

    /// Returns the session of a request, with the parameters of a preset.
    fn made(preset: Preset, request: GroundRequest) -> Session {
        let recipe = Recipe::from(preset.parameters());
        let wake: Wake = Arc::new(|| {});
        let job = Job::start(&wake, move |monitor| sample(&recipe, &request, 1, monitor));
        job.wait().expect("no panic").expect("a set")
    }

    #[test]
    fn the_octave_of_a_cell_is_that_of_the_base_cell_at_its_place() {
        let session = made(Preset::Ramp, Preset::Ramp.ground().expect("a field"));
        let octaves = session.octaves().expect("several octaves");
        let run = session.run();
        let locality = run.locality.as_deref().expect("a field");
        let mut seen = vec![0; octaves.all().len()];

        for (throw, iteration) in (1..).zip(&run.iterations) {
            for cell in &iteration.cells {
                // The cell at a place is found from the field alone, without throws and levels.
                let base = locality.base_side(cell.min).ilog2() - octaves.least_bits;
                assert_eq!(
                    octaves.of_cell(throw, cell.side),
                    base as usize,
                    "{throw} {cell:?}"
                );
                seen[base as usize] += 1;
            }
            let counts = session
                .cells_by_octave(Stage::Iterate(throw))
                .expect("a throw");
            assert_eq!(counts.iter().sum::<usize>(), iteration.cells.len());
        }
        // The radius grows from 0.008 to 0.04, through two doublings and a part of a third.
        assert!(
            seen.len() == 3 && seen.iter().all(|&cells| cells > 0),
            "{seen:?}"
        );
        assert_eq!(session.cells_by_octave(Stage::Finish), None);
        // The width alone does not say it: a cell cut in four would have the octave below, unless the throw counts.
        let cut = &run.iterations[5].cells;
        let differs = |cell: &&Cell| octaves.of_cell(1, cell.side) != octaves.of_cell(6, cell.side);
        assert!(cut.iter().any(|cell| differs(&cell)));
    }

    #[test]
    fn sets_of_one_radius_have_no_octaves() {
        let mut request = Preset::Star.ground().expect("a shape");
        request.radius = None;
        let session = made(Preset::Star, request);
        assert!(session.is_in_field() && session.octaves().is_none());
        assert_eq!(session.cells_by_octave(Stage::Iterate(1)), None);
    }
}
