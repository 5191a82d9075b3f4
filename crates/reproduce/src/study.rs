//! What an experiment works with: its settings and its units of work.
//! It knows no experiment.

use std::cell::Cell;

use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::control::{Control, Watch};
use crate::error::ReproduceError;
use crate::experiment::Experiment;
use crate::parts::Parts;
use crate::sets::GivenSet;
use crate::work::{Rates, Work};

/// What the numbers of an experiment depend on, besides the machine.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Small sets and few of them: shows that everything works, in two minutes.
    pub quick: bool,
    /// Seed of the first set; every set of an experiment has its own.
    pub seed: u64,
    /// Sets from files, to stand beside the others where that makes sense.
    pub given: Vec<GivenSet>,
    /// The arguments that tell what the files do not: for the command that makes a result again.
    pub stated: String,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            quick: true,
            seed: 1,
            given: Vec::new(),
            stated: String::new(),
        }
    }
}

impl Settings {
    /// Returns the first for a whole reproduction, the second for a quick one.
    pub fn pick<T>(&self, whole: T, quick: T) -> T {
        if self.quick { quick } else { whole }
    }

    /// Returns the arguments that name the sets from files.
    pub fn arguments(&self) -> String {
        if self.given.is_empty() {
            return String::new();
        }
        let files: String = self.given.iter().map(GivenSet::argument).collect();
        format!("{files}{}", self.stated)
    }
}

/// An experiment at work.
pub struct Study<'a> {
    pub settings: &'a Settings,
    pub experiment: Experiment,
    pub rates: Rates,
    parts: Parts,
    watch: &'a dyn Watch,
    /// Seconds of work that lie behind, of all experiments.
    before: f64,
    /// Work of the units that were made; those that were kept are none.
    told: Cell<Work>,
}

impl<'a> Study<'a> {
    pub fn new(
        experiment: Experiment,
        settings: &'a Settings,
        (rates, before): (Rates, f64),
        parts: Parts,
        watch: &'a dyn Watch,
    ) -> Self {
        Self {
            settings,
            experiment,
            rates,
            parts,
            watch,
            before,
            told: Cell::default(),
        }
    }

    /// Returns what a unit of work gives: what was kept of it, or what `make` returns, which is kept. `key` names the unit
    /// in files, `what` to the reader.
    pub fn unit<T: Serialize + DeserializeOwned>(
        &self,
        (key, what): (&str, &str),
        work: Work,
        make: impl FnOnce(&Control<'_>) -> Result<T, ReproduceError>,
    ) -> Result<T, ReproduceError> {
        let control = self.control(what).of_unit(self.rates.seconds(&work));
        control.go_on()?;
        if let Some(kept) = self.parts.load(key) {
            return Ok(kept);
        }
        let made = make(&control)?;
        self.parts.save(key, work, &made)?;
        self.told.set(self.told.get() + work);
        Ok(made)
    }

    /// Carries out rounds, each a unit of `work`. What `open` returns serves all of them and is opened for the first round that was not kept.
    pub fn rounds<T: Serialize + DeserializeOwned, E>(
        &self,
        (key, what): (&str, &str),
        (rounds, work): (u64, Work),
        open: impl Fn(&Control<'_>) -> Result<E, ReproduceError>,
        round: impl Fn(u64, &E, &Control<'_>) -> Result<T, ReproduceError>,
    ) -> Result<Vec<T>, ReproduceError> {
        let mut opened = None;
        let mut all = Vec::new();
        for number in 0..rounds {
            let what = format!("{what}, round {} of {rounds}", number + 1);
            let one = self.unit((&format!("{key}-{number}"), &what), work, |control| {
                let opened = match &mut opened {
                    Some(opened) => opened,
                    none => none.insert(open(control)?),
                };
                round(number, opened, control)
            })?;
            all.push(one);
        }
        Ok(all)
    }

    /// Returns the control of work that is no unit: what is made anew each time, for pictures.
    pub fn control(&self, what: &str) -> Control<'_> {
        let seconds = self.before + self.rates.seconds(&self.told.get());
        Control::new(self.watch, seconds, format!("{}: {what}", self.experiment))
    }

    /// Returns the work of all units that were made so far.
    #[cfg(test)]
    pub fn told(&self) -> Work {
        self.told.get()
    }
}

#[cfg(test)]
pub mod tests {
    use std::ops::ControlFlow;

    use super::*;
    use crate::outcome::Outcome;

    /// A watch that lets everything finish.
    pub struct Idle;

    impl Watch for Idle {
        fn progress(&self, _: f64, _: &str) -> ControlFlow<()> {
            ControlFlow::Continue(())
        }
    }

    const RATES: Rates = Rates {
        tiled: 1e6,
        sequential: 1e6,
        reference: 1e6,
        verified: 1e6,
        transformed: 1e6,
    };

    /// Carries out something with the control of a study of its own.
    pub fn alone(
        settings: &Settings,
        work: impl FnOnce(&Control<'_>) -> Result<(), ReproduceError>,
    ) {
        studied(Experiment::Fig12, settings, |study| {
            work(&study.control("test"))
        })
        .unwrap();
    }

    /// Carries out something with a study of its own.
    pub fn studied<T>(
        experiment: Experiment,
        settings: &Settings,
        work: impl FnOnce(&Study<'_>) -> Result<T, ReproduceError>,
    ) -> Result<T, ReproduceError> {
        let folder = tempfile::tempdir().unwrap();
        let parts = Parts::open(folder.path().join("parts"), "test".into(), false)?;
        work(&Study::new(
            experiment,
            settings,
            (RATES, 0.0),
            parts,
            &Idle,
        ))
    }

    /// Carries out an experiment in its quick form. Its units must be the work that it said, its tables have rows of as many
    /// cells as columns, and its pictures can be drawn.
    pub fn quick_run(experiment: Experiment, settings: &Settings) -> Outcome {
        let outcome = studied(experiment, settings, |study| {
            let outcome = experiment.carry_out(study)?;
            let (told, said) = (study.told(), experiment.work(settings));
            let kinds = |work: Work| {
                let Work {
                    tiled,
                    sequential,
                    reference,
                    verified,
                    transformed,
                    other,
                } = work;
                [
                    tiled,
                    sequential,
                    reference,
                    verified,
                    transformed,
                    1e6 * other,
                ]
            };
            for (told, said) in kinds(told).into_iter().zip(kinds(said)) {
                assert!((told - said).abs() < 1.0, "{told} of {said}");
            }
            Ok(outcome)
        });
        let outcome = outcome.unwrap();
        for table in &outcome.tables {
            let fits = table
                .rows
                .iter()
                .all(|row| row.len() == table.columns.len());
            assert!(fits && !table.rows.is_empty(), "{}", table.name);
        }
        for picture in &outcome.pictures {
            picture.scene.validate().unwrap();
        }
        outcome
    }

    #[test]
    fn a_unit_is_made_once_and_is_work_only_then() {
        let settings = Settings::default();
        studied(Experiment::Fig12, &settings, |study| {
            let work = Work {
                tiled: 5.0,
                ..Work::default()
            };
            let made = Cell::new(0);
            let unit = || {
                study.unit(("a", "a"), work, |_| {
                    made.set(made.get() + 1);
                    Ok(made.get())
                })
            };
            assert_eq!((unit()?, unit()?), (1, 1));
            assert_eq!(study.told(), work);
            Ok(())
        })
        .unwrap();
    }

    #[test]
    fn a_stopped_unit_is_not_kept() {
        struct Stop;
        impl Watch for Stop {
            fn progress(&self, _: f64, _: &str) -> ControlFlow<()> {
                ControlFlow::Break(())
            }
        }
        let folder = tempfile::tempdir().unwrap();
        let settings = Settings::default();
        let parts = Parts::open(folder.path().to_owned(), "test".into(), false).unwrap();
        let study = Study::new(Experiment::Fig12, &settings, (RATES, 0.0), parts, &Stop);
        let stopped = study.unit(("a", "a"), Work::default(), |_| Ok(1));
        assert!(matches!(stopped, Err(ReproduceError::Cancelled)));
        assert!(!folder.path().join("a.json").exists());
    }
}
