//! `tilescope reproduce`: the paper's experiments by one command, with a report.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use serde_json::json;
use tilescope_reproduce::{
    Experiment, Finished, Options, Planned, ReproduceError, Settings, Summary, Verdict, Watch,
    plan, reproduce,
};

use crate::engine::ThreadArguments;
use crate::progress::Bar;
use crate::{EXIT_BAD_INPUT, EXIT_FINE, interrupt, output};

/// Arguments of `tilescope reproduce`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct ReproduceArguments {
    /// The experiments, or all
    #[arg(required = true, value_name = "EXPERIMENT", value_parser = wanted)]
    experiments: Vec<Wanted>,
    /// The folder of the report; made if it is not there
    #[arg(long, value_name = "DIR", required_unless_present = "plan")]
    out: Option<PathBuf>,
    /// Small sets and few of them: everything in less than two minutes on two cores
    #[arg(long)]
    quick: bool,
    /// Seed of the first set; every set has its own
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// An option of earlier versions, refused with the command that replaces it
    #[arg(long, hide = true)]
    file: Vec<PathBuf>,
    #[command(flatten)]
    before: Before,
    #[command(flatten)]
    threads: ThreadArguments,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Options that act before the work, or instead of it.
#[derive(Debug, Args)]
struct Before {
    /// Delete what an earlier run of these experiments left in the folder
    #[arg(long)]
    fresh: bool,
    /// Only say how many units of work there are, and how many of them --out has already
    #[arg(long)]
    plan: bool,
}

const EXAMPLES: &str = "\
Experiments:
  fig10        zone plate and horizon: integration by random, jittered, reference and KDRT samples
  fig11        where the time goes for a million samples
  fig12        nine independent sets become one
  fig13        spectra and rates by radius and leaf size, against the reference sampler
  iterations   iterations of insertion, in ten runs of ten million samples
  eq4          the share of samples that elimination and insertion touch, by leaf size
  search       gaps that stay when detectors look 2r far, and 4r
  uniformity   whether every place is as likely as any other, by either insertion
  all          all of them

The folder receives report.html and REPORT.md, figures (PNG, SVG) and data (CSV, JSON). When
interrupted, run the same command again to continue; what depends on other settings, another
machine or another version is made anew.

A set of another method is compared by tilescope analyze theirs.txt --against ours-*.npy.

Examples:
  tilescope reproduce all --quick --out reproduction
  tilescope reproduce fig13 search --out reproduction

Exit codes: 0 all experiments ended, whatever their verdicts, 2 one could not be carried out,
130 interrupted.";

/// One experiment, or all.
#[derive(Clone, Copy, Debug)]
struct Wanted(Option<Experiment>);

fn wanted(name: &str) -> Result<Wanted, String> {
    if name == "all" {
        return Ok(Wanted(None));
    }
    let one = name.parse();
    one.map(|one| Wanted(Some(one)))
        .map_err(|error: String| format!("{error}, all"))
}

pub fn run(arguments: &ReproduceArguments) -> Result<u8> {
    interrupt::listen();
    arguments.threads.set()?;
    let experiments = chosen(&arguments.experiments);
    if let Some(path) = arguments.file.first() {
        let path = path.display();
        bail!(
            "--file is no longer an option of reproduce: tilescope analyze {path} --against OURS compares the file with other sets, \
             which tilescope sample makes"
        );
    }
    let settings = Settings {
        quick: arguments.quick,
        seed: arguments.seed,
    };
    let watch = Progress::default();
    let (Some(out), false) = (&arguments.out, arguments.before.plan) else {
        show_plan(&experiments, &settings, arguments)?;
        return Ok(EXIT_FINE);
    };
    ensure!(
        !out.exists() || out.is_dir(),
        "{}: this is a file; --out names a folder",
        out.display()
    );
    std::fs::create_dir_all(out)
        .with_context(|| format!("{}: --out cannot be made", out.display()))?;
    let options = Options {
        settings,
        out: out.clone(),
        fresh: arguments.before.fresh,
    };
    let outcome = reproduce(&experiments, &options, &watch);
    watch.bar.clear();
    let summary = outcome?;
    if arguments.json {
        output::emit(&format!("{}\n", json(&summary)))?;
    } else {
        output::emit(&text(&summary))?;
    }
    Ok(if summary.failed.is_empty() {
        EXIT_FINE
    } else {
        EXIT_BAD_INPUT
    })
}

/// Returns the experiments in the sequence of a report, each once.
fn chosen(wanted: &[Wanted]) -> Vec<Experiment> {
    let all = wanted.iter().any(|one| one.0.is_none());
    let named: BTreeSet<Experiment> = wanted.iter().filter_map(|one| one.0).collect();
    let each = Experiment::ALL.into_iter();
    each.filter(|one| all || named.contains(one)).collect()
}

fn show_plan(
    experiments: &[Experiment],
    settings: &Settings,
    arguments: &ReproduceArguments,
) -> Result<()> {
    let kept = (arguments.out.as_deref()).filter(|_| !arguments.before.fresh);
    let each = plan(experiments, settings, kept);
    if !arguments.json {
        return output::emit(&plan_text(&each));
    }
    let experiments: Vec<_> = (each.iter())
        .map(|one| {
            json!({
                "experiment": one.experiment,
                "units": one.units,
                "kept": one.kept,
                "kept_seconds": one.seconds,
            })
        })
        .collect();
    let [units, kept] = totals(&each);
    let plan = json!({ "units": units, "kept": kept, "experiments": experiments });
    output::emit(&format!("{plan}\n"))
}

/// Returns the units of all experiments, and how many of them are kept.
fn totals(each: &[Planned]) -> [usize; 2] {
    let sum = |count: fn(&Planned) -> usize| each.iter().map(count).sum();
    [sum(|one| one.units), sum(|one| one.kept)]
}

fn plan_text(each: &[Planned]) -> String {
    let [units, kept] = totals(each);
    let mut out = format!("units of work: {units}, of which {kept} are kept from an earlier run\n");
    for one in each {
        let _ = write!(out, "  {:<12} {:>3}", one.experiment.name(), one.units);
        if one.kept > 0 {
            let took = duration(one.seconds);
            let _ = write!(
                out,
                ", {} kept from an earlier run, made in {took}",
                one.kept
            );
        }
        out.push('\n');
    }
    out
}

fn duration(seconds: f64) -> String {
    if seconds < 90.0 {
        format!("{:.0} s", seconds.max(1.0))
    } else {
        format!("{:.0} min", seconds / 60.0)
    }
}

/// Shows how far a reproduction is.
struct Progress {
    bar: Bar,
    units: AtomicUsize,
}

impl Default for Progress {
    fn default() -> Self {
        Self {
            bar: Bar::new("reproduce"),
            units: AtomicUsize::default(),
        }
    }
}

impl Watch for Progress {
    fn planned(&self, each: &[Planned]) {
        self.units.store(totals(each)[0], Ordering::Relaxed);
        output::note(plan_text(each).trim_end());
    }

    fn begins(&self, experiment: Experiment) {
        self.bar.suspend(|| output::note(experiment.title()));
    }

    fn progress(&self, done: usize, what: &str) -> ControlFlow<()> {
        self.bar.name(what);
        let units = self.units.load(Ordering::Relaxed);
        self.bar.set(done as u64, units as u64);
        interrupt::flow()
    }

    fn finished(&self, finished: &Finished) {
        self.bar.suspend(|| {
            for claim in &finished.claims {
                output::note(&format!(
                    "  {:<VERDICT$} {}",
                    finished.words(claim),
                    claim.claim
                ));
            }
        });
    }

    fn failed(&self, experiment: Experiment, error: &ReproduceError) {
        self.bar
            .suspend(|| output::note(&format!("error: {experiment}: {error}")));
    }
}

/// Room for the longest verdict.
const VERDICT: usize = "not reproduced (quick)".len();

fn text(summary: &Summary) -> String {
    let mut out = String::new();
    for one in &summary.finished {
        let _ = writeln!(out, "{}", one.experiment.title());
        for claim in &one.claims {
            let _ = writeln!(
                out,
                "  {:<VERDICT$} {}\n{:indent$}the paper: {}\n{:indent$}here: {}",
                one.words(claim),
                claim.claim,
                "",
                claim.paper,
                "",
                claim.ours,
                indent = VERDICT + 3
            );
        }
    }
    let _ = writeln!(
        out,
        "\nof the paper: {} reproduced, {} not reproduced, {} not comparable\nreport         {}",
        summary.count(Verdict::Reproduced),
        summary.count(Verdict::NotReproduced),
        summary.count(Verdict::NotComparable),
        summary.report.display()
    );
    out
}

fn json(summary: &Summary) -> serde_json::Value {
    let failed = summary.failed.iter();
    let failed = failed.map(|(one, reason)| json!({ "experiment": one, "reason": reason }));
    let failed: Vec<_> = failed.collect();
    json!({
        "experiments": summary.finished,
        "reproduced": summary.count(Verdict::Reproduced),
        "not_reproduced": summary.count(Verdict::NotReproduced),
        "not_comparable": summary.count(Verdict::NotComparable),
        "failed": failed,
        "report": summary.report.display().to_string(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn experiments_are_chosen_once_and_in_the_report_s_sequence() {
        let names = |words: &[&str]| {
            let each: Result<Vec<Wanted>, String> = words.iter().map(|word| wanted(word)).collect();
            each.map(|each| chosen(&each))
        };
        let two = names(&["fig13", "fig10", "fig13"]).unwrap();
        assert_eq!(two, [Experiment::Fig10, Experiment::Fig13]);
        assert_eq!(names(&["search", "all"]).unwrap(), Experiment::ALL);
        let error = names(&["fig9"]).unwrap_err();
        assert!(error.contains("fig9 is no experiment") && error.ends_with("all"));
    }

    #[test]
    fn durations_are_told_in_seconds_or_minutes() {
        assert_eq!(duration(0.2), "1 s");
        assert_eq!(duration(89.0), "89 s");
        assert_eq!(duration(600.0), "10 min");
        let planned = |experiment, kept| Planned {
            experiment,
            units: 9,
            kept,
            seconds: 2.0,
        };
        let text = plan_text(&[planned(Experiment::Fig10, 0), planned(Experiment::Eq4, 3)]);
        assert!(text.starts_with("units of work: 18, of which 3 are kept"));
        assert!(text.contains("fig10          9\n"), "{text}");
        assert!(text.contains("eq4            9, 3 kept from an earlier run, made in 2 s\n"));
    }
}
