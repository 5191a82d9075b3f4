//! `tilescope analyze`: every measure of one or more point sets, as a table, as curves and as a report.
//! A file that cannot be analysed is named, and the others are analysed all the same.

mod curves;
mod differences;
mod measured;
mod report;
mod scalars;
mod table;

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use serde_json::{Value, json};
use tilescope_figures::Palette;
use tilescope_figures::chart::figure_scene;
use tilescope_formats::write_whole;

use crate::options::SetArguments;
use crate::{EXIT_BAD_INPUT, EXIT_FINE, describe, interrupt, output};
use measured::Measured;

/// Arguments of `tilescope analyze`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct AnalyzeArguments {
    /// The point sets, in any formats
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Hold the sets against this one: it is drawn dashed, and differences from it are printed
    #[arg(long, value_name = "FILE")]
    against: Option<PathBuf>,
    #[command(flatten)]
    set: SetArguments,
    /// Save a report: .html (table and curves), .png or .svg (curves), .csv (all numbers)
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

const EXAMPLES: &str = "\
Sides and boundary that neither a certificate nor an argument tells are those of the periodic unit
square. Where no radius is known, the smallest distance between two samples stands for it.

Frequencies are given as nu = |k| / sqrt(N), distances over r_max, the smallest distance in the
hexagonal lattice of as many samples. Shaded bands hold the true mean power with probability 0.95.

Examples:
  tilescope analyze set.csv
  tilescope analyze kdrt.npy darts.npy --against reference.npy --out report.html
  tilescope analyze theirs.txt --radius 0.01 --boundary bounded --json
  tilescope analyze *.npy --out numbers.csv

Exit codes: 0 all files were analysed, 2 one was not or the arguments cannot be used.";

/// What is saved.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Html,
    Png,
    Svg,
    Csv,
}

/// A file that was not analysed, and why.
struct Failure {
    name: String,
    reason: String,
}

/// Everything that was found out.
struct Analysis {
    /// The sets, that of `--against` first.
    sets: Vec<Measured>,
    /// Whether the first is what others are held against.
    against: bool,
    failures: Vec<Failure>,
}

impl Analysis {
    fn reference(&self) -> Option<&Measured> {
        self.sets.first().filter(|_| self.against)
    }
}

pub fn run(arguments: &AnalyzeArguments) -> Result<u8> {
    interrupt::listen();
    let kind = arguments.out.as_deref().map(kind_of).transpose()?;
    check_no_input_is_replaced(arguments)?;
    let analysis = analyse(arguments)?;
    let nothing = analysis.sets.len() == usize::from(analysis.against);
    if let (Some(kind), Some(path), false) = (kind, &arguments.out, nothing) {
        write_whole(path, &bytes(&analysis, kind)?)?;
    }
    if arguments.json {
        let saved = arguments.out.as_deref().filter(|_| !nothing);
        output::emit(&format!("{}\n", to_json(&analysis, saved)))?;
    } else if !nothing {
        output::emit(&to_text(&analysis, arguments.out.as_deref()))?;
    }
    Ok(if analysis.failures.is_empty() {
        EXIT_FINE
    } else {
        EXIT_BAD_INPUT
    })
}

/// A report that is a table would be written over a set of the same name.
fn check_no_input_is_replaced(arguments: &AnalyzeArguments) -> Result<()> {
    let Some(out) = arguments.out.as_deref() else {
        return Ok(());
    };
    // A file that is not there yet replaces nothing.
    let place = |path: &Path| path.canonicalize().ok();
    let inputs = arguments.files.iter().chain(&arguments.against);
    for input in inputs {
        let same = input == out || place(out).is_some_and(|out| place(input) == Some(out));
        ensure!(
            !same,
            "{}: --out would be written over this set; give it another name",
            input.display()
        );
    }
    Ok(())
}

fn kind_of(path: &Path) -> Result<Kind> {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    match extension.to_lowercase().as_str() {
        "html" | "htm" => Ok(Kind::Html),
        "png" => Ok(Kind::Png),
        "svg" => Ok(Kind::Svg),
        "csv" => Ok(Kind::Csv),
        _ => bail!(
            "{}: the extension of a report must be .html, .png, .svg or .csv",
            path.display()
        ),
    }
}

/// Analyses the files one after another; only Ctrl-C and a useless `--against` end it early.
fn analyse(arguments: &AnalyzeArguments) -> Result<Analysis> {
    let mut analysis = Analysis {
        sets: Vec::new(),
        against: arguments.against.is_some(),
        failures: Vec::new(),
    };
    if let Some(path) = &arguments.against {
        let reference = Measured::of_file(path, &arguments.set);
        analysis.sets.push(reference.context("--against")?);
    }
    for path in &arguments.files {
        let found = Measured::of_file(path, &arguments.set)
            .and_then(|found| same_domain(found, analysis.reference()));
        match found {
            Ok(found) => analysis.sets.push(found),
            Err(error) if interrupt::requested() => return Err(error),
            Err(error) => {
                let reason = describe(&error);
                eprintln!("error: {reason}");
                let name = path.display().to_string();
                analysis.failures.push(Failure { name, reason });
            }
        }
    }
    Ok(analysis)
}

fn same_domain(found: Measured, reference: Option<&Measured>) -> Result<Measured> {
    if let Some(reference) = reference {
        ensure!(
            found.region == reference.region,
            "{}: its domain, {}, is not that of {}, {}",
            found.name,
            output::region_text(&found.region),
            reference.name,
            output::region_text(&reference.region)
        );
    }
    Ok(found)
}

fn bytes(analysis: &Analysis, kind: Kind) -> Result<Vec<u8>> {
    if kind == Kind::Csv {
        return Ok(report::csv(analysis).into_bytes());
    }
    let figure = curves::figure(&analysis.sets, analysis.against);
    let scene = figure_scene(&figure, &Palette::LIGHT)?;
    if kind == Kind::Png {
        return Ok(tilescope_figures::to_png(&scene, 2.0)?);
    }
    let svg = tilescope_figures::to_svg(&scene)?;
    Ok(match kind {
        Kind::Html => report::html(analysis, &svg).into_bytes(),
        _ => svg.into_bytes(),
    })
}

fn to_text(analysis: &Analysis, saved: Option<&Path>) -> String {
    let mut out = table::text(&table::measures(&analysis.sets, analysis.against));
    if let Some(reference) = analysis.reference() {
        out.push('\n');
        out.push_str(&table::text(&differences::table(
            reference,
            &analysis.sets[1..],
        )));
    }
    if let Some(path) = saved {
        let _ = writeln!(out, "\nreport         {}", path.display());
    }
    out
}

fn to_json(analysis: &Analysis, saved: Option<&Path>) -> Value {
    let files: Vec<Value> = analysis.sets[usize::from(analysis.against)..]
        .iter()
        .map(|set| {
            let mut object = report::json(set);
            if let (Some(reference), Some(map)) = (analysis.reference(), object.as_object_mut()) {
                let differences = differences::json(reference, set);
                map.insert("differences".to_owned(), differences);
            }
            object
        })
        .collect();
    let failures: Vec<Value> = (analysis.failures.iter())
        .map(|failure| json!({ "file": failure.name, "reason": failure.reason }))
        .collect();
    json!({
        "files": files,
        "against": analysis.reference().map(report::json),
        "failures": failures,
        "report": saved.map(|path| path.display().to_string()),
    })
}
