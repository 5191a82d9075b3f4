//! Studies in a temporary folder, for the tests of experiments (begin with `quick_run`), and tests of units of work.

use std::ops::ControlFlow;

use super::*;
use crate::error::ReproduceError;
use crate::outcome::Outcome;

/// A watch that lets everything finish.
pub struct Idle;

impl Watch for Idle {
    fn progress(&self, _: usize, _: &str) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

/// Carries out something with the control of a study of its own.
pub fn alone(settings: &Settings, work: impl FnOnce(&Control<'_>) -> Result<()>) {
    studied(Experiment::Fig12, settings, |study| {
        work(&study.control("test"))
    })
    .unwrap();
}

/// Carries out something with a study of its own.
pub fn studied<T>(
    experiment: Experiment,
    settings: &Settings,
    work: impl FnOnce(&Study<'_>) -> Result<T>,
) -> Result<T> {
    let folder = tempfile::tempdir().unwrap();
    let parts = Parts::open(folder.path().join("parts"), "test".into(), false)?;
    work(&Study::new(experiment, settings, 0, parts, &Idle))
}

/// Carries out an experiment in its quick form. It must have as many units as it said, its tables have rows of as
/// many cells as columns, and its pictures can be drawn.
pub fn quick_run(experiment: Experiment, settings: &Settings) -> Outcome {
    let outcome = studied(experiment, settings, |study| {
        let outcome = experiment.carry_out(study)?;
        assert_eq!(study.done.get(), experiment.units(settings));
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
fn a_unit_is_made_once_and_done_each_time() {
    let settings = Settings::default();
    studied(Experiment::Fig12, &settings, |study| {
        let made = Cell::new(0);
        let unit = || {
            study.unit("a", "a", |_| {
                made.set(made.get() + 1);
                Ok(made.get())
            })
        };
        assert_eq!((unit()?, unit()?), (1, 1));
        assert_eq!(study.done.get(), 2);
        Ok(())
    })
    .unwrap();
}

#[test]
fn a_stopped_unit_is_not_kept() {
    struct Stop;
    impl Watch for Stop {
        fn progress(&self, _: usize, _: &str) -> ControlFlow<()> {
            ControlFlow::Break(())
        }
    }
    let folder = tempfile::tempdir().unwrap();
    let settings = Settings::default();
    let parts = Parts::open(folder.path().to_owned(), "test".into(), false).unwrap();
    let study = Study::new(Experiment::Fig12, &settings, 0, parts, &Stop);
    let stopped = study.unit("a", "a", |_| Ok(1));
    assert!(matches!(stopped, Err(ReproduceError::Cancelled)));
    assert!(!folder.path().join("a.json").exists());
}
