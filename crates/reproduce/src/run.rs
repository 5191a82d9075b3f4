//! Carries out experiments one after another and writes what they found into a folder. After every experiment the
//! folder is complete; an interrupted reproduction goes on where it stopped.

use std::fs;
use std::path::{Path, PathBuf};

use tilescope_figures::{to_png, to_svg_with_fonts};
use tilescope_formats::write_whole;

use crate::control::{Planned, Watch};
use crate::error::{ReproduceError, Result};
use crate::experiment::Experiment;
use crate::machine::Machine;
use crate::numbers::csv;
use crate::outcome::{Finished, Outcome, Picture, Verdict};
use crate::parts::Parts;
use crate::report;
use crate::study::{Settings, Study};

/// Options of a reproduction.
#[derive(Clone, Debug)]
pub struct Options {
    /// The settings that the numbers depend on.
    pub settings: Settings,
    /// The folder of the result; made if it is not there. Nothing else in it is touched.
    pub out: PathBuf,
    /// Whether the parts of earlier runs are deleted first.
    pub fresh: bool,
}

/// The results of a reproduction.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// The experiments, in the sequence asked for.
    pub finished: Vec<Finished>,
    /// Those that could not be carried out, and why.
    pub failed: Vec<(Experiment, String)>,
    /// The path of the report.
    pub report: PathBuf,
}

impl Summary {
    /// Returns how many claims of the paper have this verdict.
    #[must_use]
    pub fn count(&self, verdict: Verdict) -> usize {
        let claims = (self.finished.iter().flat_map(|one| &one.claims))
            .filter(|claim| claim.is_of_the_paper());
        claims.filter(|claim| claim.verdict == verdict).count()
    }
}

/// Returns the units of work of each experiment, and how many of them are kept in the folder `out`: none if there is no
/// folder. Makes nothing.
#[must_use]
pub fn plan(experiments: &[Experiment], settings: &Settings, out: Option<&Path>) -> Vec<Planned> {
    let made_by = build_and_machine(&Machine::this());
    let planned = |&experiment: &Experiment| {
        let stamp = stamp_of(experiment, settings, &made_by);
        let units = experiment.units(settings);
        // The seconds that each kept unit took.
        let mut kept_seconds = out
            .map(|out| Parts::kept(&folder(out, experiment), &stamp))
            .unwrap_or_default();
        // A run with the setting `many` leaves more batches of the experiment `density` than these settings may have.
        kept_seconds.truncate(units);

        Planned {
            experiment,
            units,
            kept: kept_seconds.len(),
            seconds: kept_seconds.iter().sum(),
        }
    };

    experiments.iter().map(planned).collect()
}

/// Returns where an experiment's parts are kept.
fn folder(out: &Path, experiment: Experiment) -> PathBuf {
    out.join("parts").join(experiment.name())
}

/// Carries out the experiments and writes `report.html`, `REPORT.md`, `figures/` (PNG and SVG) and `data/` (CSV of
/// all numbers, JSON of each experiment) into the folder. What earlier runs left there of other experiments stays in
/// the report.
///
/// The same settings give the same numbers, except times; units that are kept in `parts/` are not computed again, if
/// settings, program, machine and threads are the same. An experiment that fails does not keep the others from being
/// carried out. Cancelling does, and so does a file of the result that cannot be read or written.
pub fn reproduce(
    experiments: &[Experiment],
    options: &Options,
    watch: &dyn Watch,
) -> Result<Summary> {
    let settings = &options.settings;
    let machine = Machine::this();
    let made_by = build_and_machine(&machine);

    // With `fresh` the parts of earlier runs are deleted below, so that none of them count as kept.
    let counted_folder = Some(options.out.as_path()).filter(|_| !options.fresh);
    let each = plan(experiments, settings, counted_folder);
    watch.planned(&each);

    let mut summary = Summary {
        finished: Vec::new(),
        failed: Vec::new(),
        report: options.out.join("report.html"),
    };

    let mut done = 0;
    for Planned {
        experiment, units, ..
    } in each
    {
        watch.begins(experiment);

        let stamp = stamp_of(experiment, settings, &made_by);
        let parts = Parts::open(folder(&options.out, experiment), stamp, options.fresh)?;
        let study = Study::new(experiment, settings, done, parts, watch);

        // Units count through all experiments. Those of a failed one are skipped, but counted.
        done += units;
        let outcome = match experiment.carry_out(&study) {
            Ok(outcome) => outcome,
            Err(ReproduceError::Cancelled) => return Err(ReproduceError::Cancelled),
            // The other experiments are carried out nevertheless.
            Err(error) => {
                watch.failed(experiment, &error);
                summary.failed.push((experiment, error.to_string()));
                continue;
            }
        };

        // The report is written after each experiment, so that the folder is complete whenever the run is interrupted.
        let finished = keep(experiment, outcome, options, &machine)?;
        report::write(&options.out)?;
        watch.finished(&finished);
        summary.finished.push(finished);
    }

    Ok(summary)
}

/// Identifies this build and machine, since another one may give other numbers. A program whose file cannot be read is
/// identified by its version and the machine.
fn build_and_machine(machine: &Machine) -> String {
    let read = std::env::current_exe().and_then(fs::read);
    let digest = read.map_or_else(
        |_| String::new(),
        |bytes| tilescope_formats::bytes_digest(&bytes),
    );
    format!("{} {digest} {}", env!("CARGO_PKG_VERSION"), machine.line())
}

/// Returns the stamp that kept numbers must have to be used: program, machine and settings.
fn stamp_of(experiment: Experiment, settings: &Settings, made_by: &str) -> String {
    let Settings { quick, seed, .. } = settings;
    // The experiment `density` makes the same batches with and without `many`, and only more of them with it. So a run
    // with `many` uses those that a run without it has kept.
    let many = settings.many && experiment != Experiment::Density;
    format!("{experiment} quick {quick} seed {seed} many {many} {made_by}")
}

/// Writes the results of an experiment, and returns them as the report reads them.
fn keep(
    experiment: Experiment,
    outcome: Outcome,
    options: &Options,
    machine: &Machine,
) -> Result<Finished> {
    let (figures, data) = (options.out.join("figures"), options.out.join("data"));
    for folder in [&figures, &data] {
        fs::create_dir_all(folder).map_err(ReproduceError::io(folder))?;
    }

    for picture in &outcome.pictures {
        draw(picture, &figures, experiment)?;
    }
    for table in &outcome.tables {
        let path = data.join(format!("{experiment}-{}.csv", table.name));
        write_whole(&path, csv(table).as_bytes())?;
    }

    let settings = &options.settings;
    let named = |picture: Picture| (picture.name, picture.caption);
    let finished = Finished {
        experiment,
        quick: settings.quick,
        many: settings.many,
        seed: settings.seed,
        machine: machine.clone(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        claims: outcome.claims,
        pictures: outcome.pictures.into_iter().map(named).collect(),
        tables: outcome.tables,
        notes: outcome.notes,
    };

    // This file is written last: the report reads it, and shows the pictures and tables that must then be there.
    let path = data.join(format!("{experiment}.json"));
    let bytes = serde_json::to_vec_pretty(&finished)?;
    write_whole(&path, &bytes)?;
    Ok(finished)
}

/// Writes a picture as PNG, twice its size, and as SVG.
fn draw(picture: &Picture, folder: &Path, of: Experiment) -> Result<()> {
    let path = |extension: &str| folder.join(format!("{of}-{}.{extension}", picture.name));
    write_whole(&path("png"), &to_png(&picture.scene, 2.0)?)?;
    write_whole(&path("svg"), to_svg_with_fonts(&picture.scene)?.as_bytes())?;
    Ok(())
}

#[cfg(test)]
mod tests;
