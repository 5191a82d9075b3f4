//! The settings of an experiment, and its units of work.

use std::cell::Cell;
use std::ops::Range;

use rayon::prelude::*;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::control::{Control, Watch};
use crate::error::Result;
use crate::experiment::Experiment;
use crate::parts::Parts;

/// The settings that the numbers of an experiment depend on, besides the machine.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Small sets and few of them: shows that everything works, in two minutes.
    pub quick: bool,
    /// Seed of the first set; every set of an experiment has its own.
    pub seed: u64,
    /// Makes more sets than usual: these show a bias of uniformity half as large as the usual number of sets does, and
    /// the density to two millionths. It has a meaning for the whole sizes alone.
    pub many: bool,
    /// Takes only those batches of density that an earlier run has kept. Their numbers do not depend on it.
    pub kept: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            quick: true,
            seed: 1,
            many: false,
            kept: false,
        }
    }
}

impl Settings {
    /// Returns the first for a whole reproduction, the second for a quick one.
    pub fn pick<T>(&self, whole: T, quick: T) -> T {
        if self.quick { quick } else { whole }
    }

    /// Returns the seed of the set `index` of an experiment.
    pub(crate) fn seed_of(&self, index: u64) -> u64 {
        self.seed.wrapping_mul(1000).wrapping_add(index)
    }
}

/// An experiment at work.
pub struct Study<'a> {
    pub settings: &'a Settings,
    pub experiment: Experiment,
    parts: Parts,
    watch: &'a dyn Watch,
    /// Units that are done, with those of the experiments before.
    done: Cell<usize>,
}

impl<'a> Study<'a> {
    /// Begins the study of an experiment, after `done` units of others.
    pub fn new(
        experiment: Experiment,
        settings: &'a Settings,
        done: usize,
        parts: Parts,
        watch: &'a dyn Watch,
    ) -> Self {
        Self {
            settings,
            experiment,
            parts,
            watch,
            done: Cell::new(done),
        }
    }

    /// Returns the result of a unit of work: the one that was kept, or what `make` returns, which is kept. `key`
    /// names the unit in files, `what` to the reader.
    pub fn unit<T: Serialize + DeserializeOwned>(
        &self,
        key: &str,
        what: &str,
        make: impl FnOnce(&Control<'_>) -> Result<T>,
    ) -> Result<T> {
        let control = self.control(what);
        // A cancelled run stops between two units.
        control.go_on()?;

        let result = if let Some(kept) = self.parts.load(key) {
            kept
        } else {
            let made = make(&control)?;
            // At once, so that an interrupted run goes on behind this unit.
            self.parts.save(key, control.seconds(), &made)?;
            made
        };

        // A kept unit counts as done as well.
        self.done.set(self.done.get() + 1);
        Ok(result)
    }

    /// Returns whether a unit was kept.
    pub fn has_kept<T: DeserializeOwned>(&self, key: &str) -> bool {
        self.parts.load::<T>(key).is_some()
    }

    /// Leaves a unit out, which counts as done.
    pub fn skip(&self) {
        self.done.set(self.done.get() + 1);
    }

    /// Returns the results of sets with these indices, made on all threads as one unit: `make` is given the seed of each.
    pub fn sets<T: Serialize + DeserializeOwned + Send>(
        &self,
        key: &str,
        what: &str,
        indices: Range<usize>,
        make: impl Fn(u64, &Control<'_>) -> Result<T> + Sync,
    ) -> Result<Vec<T>> {
        let settings = self.settings;
        self.unit(key, what, |control| {
            let indices = indices.into_par_iter();
            indices
                // The seed follows from the index, whichever thread takes it.
                .map(|index| make(settings.seed_of(index as u64), control))
                .collect()
        })
    }

    /// Returns the control of work that is no unit: pictures, which are made anew each time.
    pub fn control(&self, what: &str) -> Control<'_> {
        let what = format!("{}: {what}", self.experiment);
        Control::new(self.watch, self.done.get(), what)
    }
}

#[cfg(test)]
pub mod tests;
