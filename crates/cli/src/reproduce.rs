//! `tilescope reproduce`: the paper's experiments by one command, with a report.

use std::fmt::Write;
use std::ops::ControlFlow;
use std::path::PathBuf;

use anyhow::{Context, Result, ensure};
use clap::Args;
use indicatif::ProgressBar;
use serde_json::json;
use tilescope_reproduce::{
    Claim, Experiment, Finished, Options, Planned, ReproduceError, Settings, Summary, Verdict,
    Watch, plan, reproduce,
};

use crate::engine::ThreadArguments;
use crate::paths::named;
use crate::progress::bar;
use crate::{EXIT_BAD_INPUT, EXIT_FINE, interrupt, output};

/// Arguments of `tilescope reproduce`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct ReproduceArguments {
    /// The experiments, or all
    #[arg(required = true, value_name = "EXPERIMENT", value_parser = wanted)]
    experiments: Vec<Wanted>,
    /// The folder of the report; it is made if it is missing
    #[arg(long, value_name = "DIR", required_unless_present = "plan")]
    out: Option<PathBuf>,
    /// Few and small sets: all experiments in less than two minutes on two cores
    #[arg(long)]
    quick: bool,
    /// Seed of the first set; every set has its own
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    /// 2,000 sets of each way for uniformity instead of 400, and 2,000 mean curves instead of 100: tells a bias of half
    /// the size; 11 billion samples for density instead of 2.2 billion
    #[arg(long, conflicts_with = "quick")]
    many: bool,
    #[command(flatten)]
    before: Before,
    #[command(flatten)]
    threads: ThreadArguments,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Options about the results of an earlier run.
#[derive(Debug, Args)]
struct Before {
    /// Delete the results of an earlier run of these experiments from the folder
    #[arg(long)]
    fresh: bool,
    /// Make no further batches of density, and conclude from those that an earlier run with these settings left
    #[arg(long, conflicts_with = "fresh")]
    kept: bool,
    /// Only print the number of units of work, and how many of them --out already has
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
  search       gaps that remain when detectors search within 2r, and within 4r
  uniformity   whether samples are as likely in one place as in another, and pairs and spectra those of
               the reference sampler: by KDRT with either insertion, and by exact tiling
  density      samples to an area, of 48,000 independent sets (--many: 240,000), beside the published value
  varying      sets whose radius varies: samples to an area by slope and contrast, pairs, five rules, tones
  stippling    stipples beside weighted Voronoi stippling and error diffusion, with as many dots
  space        maximal sets of balls: samples to a volume beside the published value, pairs, powers, and
               how far places and samples are apart
  all          all of them

The folder receives report.html and REPORT.md, figures (PNG, SVG) and data (CSV, JSON). After an
interruption, run the same command again to continue. Results of other settings, of another machine
or of another version are made anew.

To compare a set of another method: tilescope analyze theirs.txt --against ours-*.npy

Examples:
  tilescope reproduce all --quick --out reproduction
  tilescope reproduce fig13 search --out reproduction

Exit codes: 0 all experiments ended, whatever their verdicts, 2 an experiment failed, 130 interrupted.";

/// One experiment, or all.
#[derive(Clone, Copy, Debug)]
struct Wanted(Option<Experiment>);

fn wanted(name: &str) -> Result<Wanted, String> {
    if name == "all" {
        return Ok(Wanted(None));
    }
    // The error lists the names of experiments, of which "all" is none.
    let one = name
        .parse()
        .map_err(|error: String| format!("{error}, all"));
    one.map(|one| Wanted(Some(one)))
}

/// Carries out experiments and writes their report, or prints what would be carried out.
pub fn run(arguments: &ReproduceArguments) -> Result<u8> {
    interrupt::listen();
    arguments.threads.set()?;
    let experiments = chosen(&arguments.experiments);
    let settings = Settings {
        quick: arguments.quick,
        seed: arguments.seed,
        many: arguments.many,
        kept: arguments.before.kept,
    };

    // With --kept an experiment concludes from the units that it has. Only density can do so: its units are batches,
    // and any number of them will do. Other experiments need all of their units.
    let of_density = experiments == [Experiment::Density];
    ensure!(of_density || !settings.kept, "--kept is for density alone");

    // `planned` gives the bar its length, once the units are counted.
    let no_length = 0;
    let watch = WatchBar(bar("reproduce", no_length));
    let fresh = arguments.before.fresh;

    // Without a folder there is no place for results, so that the plan is all that can be shown.
    let (Some(out), false) = (&arguments.out, arguments.before.plan) else {
        // With --fresh the results in the folder do not count.
        let counted_folder = arguments.out.as_deref().filter(|_| !fresh);
        let each = plan(&experiments, &settings, counted_folder);
        let [units, kept] = totals(&each);
        let json = || json!({ "units": units, "kept": kept, "experiments": each });
        output::report(arguments.json, json, || plan_text(&each))?;
        return Ok(EXIT_FINE);
    };

    let path = named(out);
    // The error of the system would not say that the option wants a folder.
    let is_file = out.exists() && !out.is_dir();
    ensure!(!is_file, "{path}: this is a file; --out names a folder");
    std::fs::create_dir_all(out).with_context(|| format!("{path}: --out cannot be made"))?;
    let options = Options {
        settings,
        out: out.clone(),
        fresh,
    };

    let outcome = reproduce(&experiments, &options, &watch);
    // The bar is cleared before an error is printed, which then stands in a line of its own.
    watch.0.finish_and_clear();
    let summary = outcome?;

    output::report(arguments.json, || json(&summary), || text(&summary))?;
    // A claim that is not reproduced is a finding; only an experiment that could not be carried out is a fault.
    let is_fine = summary.failed.is_empty();
    Ok(if is_fine { EXIT_FINE } else { EXIT_BAD_INPUT })
}

/// Returns the experiments in the sequence of a report, each once.
fn chosen(wanted: &[Wanted]) -> Vec<Experiment> {
    let mut all = Experiment::ALL.to_vec();
    let is_wanted = |one: &Experiment| {
        let mut wanted = wanted.iter();
        wanted.any(|Wanted(asked)| asked.is_none_or(|asked| asked == *one))
    };
    all.retain(is_wanted);
    all
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
            let (kept, took) = (one.kept, duration(one.seconds));
            let _ = write!(out, ", {kept} kept from an earlier run, made in {took}");
        }
        out.push('\n');
    }
    out
}

/// Returns a time in seconds or in minutes, in whole ones. 90 s are chosen, not measured; less than a second counts as
/// one, as no work takes 0 s.
fn duration(seconds: f64) -> String {
    if seconds < 90.0 {
        format!("{:.0} s", seconds.max(1.0))
    } else {
        format!("{:.0} min", seconds / 60.0)
    }
}

/// A bar of units of work, which Ctrl-C stops.
pub struct WatchBar(pub ProgressBar);

impl WatchBar {
    /// Prints a line beside the bar.
    fn note(&self, line: &str) {
        self.0.suspend(|| output::note(line));
    }
}

impl Watch for WatchBar {
    fn planned(&self, each: &[Planned]) {
        self.0.set_length(totals(each)[0] as u64);
        self.note(plan_text(each).trim_end());
    }

    fn begins(&self, experiment: Experiment) {
        self.note(experiment.title());
    }

    fn progress(&self, done: usize, what: &str) -> ControlFlow<()> {
        self.0.set_message(what.to_owned());
        self.0.set_position(done as u64);
        interrupt::flow()
    }

    fn finished(&self, finished: &Finished) {
        for claim in &finished.claims {
            self.note(&verdict_line(finished, claim));
        }
    }

    fn failed(&self, experiment: Experiment, error: &ReproduceError) {
        self.note(&format!("error: {experiment}: {error}"));
    }
}

fn verdict_line(finished: &Finished, claim: &Claim) -> String {
    format!(
        "  {:<VERDICT_WIDTH$} {}",
        finished.words(claim),
        claim.claim
    )
}

/// Width of the column of verdicts: that of the longest.
const VERDICT_WIDTH: usize = "not reproduced (quick)".len();

/// Returns the claims with their verdicts, in lines.
fn text(summary: &Summary) -> String {
    let mut out = String::new();

    for one in &summary.finished {
        let _ = writeln!(out, "{}", one.experiment.title());
        for claim in &one.claims {
            // Under the claim, which has two blanks before its verdict and one behind it.
            let indent = " ".repeat(VERDICT_WIDTH + 3);
            let line = verdict_line(one, claim);
            let (paper, ours) = (&claim.paper, &claim.ours);
            let _ = writeln!(
                out,
                "{line}\n{indent}the paper: {paper}\n{indent}here: {ours}"
            );
        }
    }

    let _ = writeln!(
        out,
        "\nof the paper: {} reproduced, {} not reproduced, {} not comparable\nreport         {}",
        summary.count(Verdict::Reproduced),
        summary.count(Verdict::NotReproduced),
        summary.count(Verdict::NotComparable),
        named(&summary.report)
    );
    out
}

fn json(summary: &Summary) -> serde_json::Value {
    let failed =
        |(one, reason): &(Experiment, String)| json!({ "experiment": one, "reason": reason });
    json!({
        "experiments": summary.finished,
        "reproduced": summary.count(Verdict::Reproduced),
        "not_reproduced": summary.count(Verdict::NotReproduced),
        "not_comparable": summary.count(Verdict::NotComparable),
        "failed": summary.failed.iter().map(failed).collect::<Vec<_>>(),
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
