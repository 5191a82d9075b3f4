//! `tilescope reproduce`: the paper's experiments by one command, with a report.

mod given;

use std::collections::BTreeSet;
use std::fmt::Write;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

use anyhow::{Context, Result, ensure};
use clap::Args;
use serde_json::json;
use tilescope_reproduce::{
    Experiment, Finished, Options, ReproduceError, Settings, Summary, Verdict, Watch, reproduce,
};

use crate::engine::ThreadArguments;
use crate::options::SetArguments;
use crate::progress::Bar;
use crate::{EXIT_BAD_INPUT, EXIT_FINE, interrupt, output};
use given::Refused;

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
    /// A set of another method, to stand beside the others in figure 10; may be given several times, and those that
    /// cannot be used are left out
    #[arg(long, value_name = "FILE")]
    file: Vec<PathBuf>,
    #[command(flatten)]
    set: SetArguments,
    #[command(flatten)]
    before: Before,
    #[command(flatten)]
    threads: ThreadArguments,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// What comes before the work, or instead of it.
#[derive(Debug, Args)]
struct Before {
    /// Forget what an earlier run of these experiments left in the folder
    #[arg(long)]
    fresh: bool,
    /// Only say how long it will take, without what --out has already
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
interrupted, the same command goes on where it stopped; what depends on other settings, another
machine or another version is made anew. Sides, boundary and format are those of --file.

Examples:
  tilescope reproduce all --quick --out reproduction
  tilescope reproduce fig13 search --out reproduction
  tilescope reproduce fig10 --file bnot.txt --out reproduction

Exit codes: 0 all experiments ended, whatever their verdicts, 2 one could not be carried out or a
file not be used, 130 interrupted.";

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
    let (given, refused) = given::read_all(&arguments.file, &arguments.set);
    for one in &refused {
        output::note(&format!("error: {}", one.reason));
    }
    if given.is_empty() && !refused.is_empty() {
        return Ok(EXIT_BAD_INPUT);
    }
    let settings = Settings {
        quick: arguments.quick,
        seed: arguments.seed,
        given,
        stated: given::stated(&arguments.set),
    };
    let watch = Told::default();
    let (Some(out), false) = (&arguments.out, arguments.before.plan) else {
        plan(&experiments, &settings, arguments)?;
        return Ok(code(refused.is_empty()));
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
        output::emit(&format!("{}\n", json(&summary, &refused)))?;
    } else {
        output::emit(&text(&summary, &refused))?;
    }
    Ok(code(summary.failed.is_empty() && refused.is_empty()))
}

const fn code(all_went_well: bool) -> u8 {
    if all_went_well {
        EXIT_FINE
    } else {
        EXIT_BAD_INPUT
    }
}

/// Returns the experiments in the sequence of a report, each once.
fn chosen(wanted: &[Wanted]) -> Vec<Experiment> {
    let all = wanted.iter().any(|one| one.0.is_none());
    let named: BTreeSet<Experiment> = wanted.iter().filter_map(|one| one.0).collect();
    let each = Experiment::ALL.into_iter();
    each.filter(|one| all || named.contains(one)).collect()
}

fn plan(
    experiments: &[Experiment],
    settings: &Settings,
    arguments: &ReproduceArguments,
) -> Result<()> {
    let kept = (arguments.out.as_deref()).filter(|_| !arguments.before.fresh);
    let each = tilescope_reproduce::expected(experiments, settings, kept);
    let each = each.context("measuring this machine")?;
    let total: f64 = each.iter().map(|(_, seconds)| seconds).sum();
    let out = if arguments.json {
        let each = each
            .iter()
            .map(|(one, seconds)| json!({ "experiment": one, "seconds": seconds }));
        let each: Vec<_> = each.collect();
        format!("{}\n", json!({ "seconds": total, "experiments": each }))
    } else {
        expected(total, &each)
    };
    output::emit(&out)
}

fn expected(total: f64, each: &[(Experiment, f64)]) -> String {
    let whole = if total < KEPT {
        "nothing is left to compute".to_owned()
    } else {
        duration(total)
    };
    let mut out = format!("expected on this machine: {whole}\n");
    for (one, seconds) in each {
        let told = if *seconds < KEPT {
            "kept from an earlier run".to_owned()
        } else {
            duration(*seconds)
        };
        let _ = writeln!(out, "  {:<12} {told}", one.name());
    }
    out
}

/// Less than this many seconds are no work: sums of works may differ by a hair.
const KEPT: f64 = 1e-6;

fn duration(seconds: f64) -> String {
    if seconds < 90.0 {
        format!("{:.0} s", seconds.max(1.0))
    } else {
        format!("{:.0} min", seconds / 60.0)
    }
}

/// Tells how far it is.
struct Told {
    bar: Bar,
    total: Mutex<f64>,
}

impl Default for Told {
    fn default() -> Self {
        Self {
            bar: Bar::new("reproduce"),
            total: Mutex::default(),
        }
    }
}

impl Told {
    fn total(&self) -> MutexGuard<'_, f64> {
        self.total.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Watch for Told {
    fn expected(&self, seconds: f64, each: &[(Experiment, f64)]) {
        *self.total() = seconds;
        output::note(expected(seconds, each).trim_end());
    }

    fn begins(&self, experiment: Experiment) {
        self.bar.suspend(|| output::note(experiment.title()));
    }

    fn progress(&self, seconds: f64, what: &str) -> ControlFlow<()> {
        const PER_SECOND: f64 = 1000.0;
        let total = *self.total();
        self.bar.name(what);
        let done = seconds.min(total) * PER_SECOND;
        self.bar.set(done as u64, (total * PER_SECOND) as u64);
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

fn text(summary: &Summary, refused: &[Refused]) -> String {
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
    for one in refused {
        let _ = writeln!(out, "left out       {}", one.reason);
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

fn json(summary: &Summary, refused: &[Refused]) -> serde_json::Value {
    let failed = summary.failed.iter();
    let failed = failed.map(|(one, reason)| json!({ "experiment": one, "reason": reason }));
    let failed: Vec<_> = failed.collect();
    let refused = refused.iter();
    let refused = refused.map(|one| json!({ "file": one.path, "reason": one.reason }));
    let refused: Vec<_> = refused.collect();
    json!({
        "experiments": summary.finished,
        "reproduced": summary.count(Verdict::Reproduced),
        "not_reproduced": summary.count(Verdict::NotReproduced),
        "not_comparable": summary.count(Verdict::NotComparable),
        "failed": failed,
        "left_out": refused,
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
        let told = expected(2.0, &[(Experiment::Fig10, 2.0), (Experiment::Eq4, 0.0)]);
        assert!(told.contains("fig10        2 s\n") && told.contains("eq4          kept"));
        let told = expected(0.0, &[(Experiment::Eq4, 0.0)]);
        assert!(told.starts_with("expected on this machine: nothing"));
    }
}
