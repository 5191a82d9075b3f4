//! `tilescope analyze`: every measure of one or more point sets, as a table, as curves and as a report.
//! A file that cannot be analysed is named, and the others are analysed all the same.

mod bins;
mod curves;
mod differences;
mod gather;
mod measured;
mod names;
mod page;
mod pictures;
mod report;
mod scalars;
mod subject;
mod table;

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use tilescope_analysis::measures::Spectrum;
use tilescope_figures::Palette;
use tilescope_figures::chart::{Figure, figure_scene};
use tilescope_formats::write_whole;

use crate::options::{SetArguments, UNIT_SQUARE};
use crate::place::check_place;
use crate::{EXIT_BAD_INPUT, EXIT_FINE, interrupt, output};
use gather::Analysis;

/// Arguments of `tilescope analyze`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct AnalyzeArguments {
    /// The point sets, in any formats
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Take all FILEs for sets of one kind: mean curves with bands, numbers with standard errors
    #[arg(long)]
    average: bool,
    /// Hold the sets against this one: it is drawn dashed, and differences from it are drawn and
    /// printed; of several, against their average. The list ends with the next option
    #[arg(long, value_name = "FILE", num_args = 1..)]
    against: Vec<PathBuf>,
    /// The largest frequency that is looked at, as nu = |k| / sqrt(N) [default: 2.5, or 1023 cycles
    /// along a side where that takes more than 2 GiB of memory]
    #[arg(long, value_name = "NU")]
    frequencies: Option<f64>,
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
hexagonal lattice of as many samples (of sets of one known radius, of as many as the first has). Shaded bands hold the true mean with probability 0.95.

Effective Nyquist frequencies are those of the smooth spectrum that follows from g(r): they hardly scatter, and
lie 2 to 3 % below Heck's on the mean periodogram of many sets.

With --average all sets must have the domain of the first and its number of samples to within 10 %;
frequencies are the first one's, and nu is taken with the mean number of samples.

Examples:
  tilescope analyze set.csv
  tilescope analyze --average kdrt-*.npy --against reference-*.npy --out report.html
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

pub fn run(arguments: &AnalyzeArguments) -> Result<u8> {
    interrupt::listen();
    let kind = arguments.out.as_deref().map(kind_of).transpose()?;
    check_no_input_is_replaced(arguments)?;
    if let Some(path) = &arguments.out {
        check_place(path).context("--out")?;
    }
    if let Some(nu) = arguments.frequencies {
        // What is too much for one sample is too much for any set.
        Spectrum::window_to(nu, 1.0, UNIT_SQUARE).context("--frequencies")?;
    }
    let mut analysis = Analysis::of(arguments)?;
    let nothing = analysis.held().is_empty();
    let written = match (kind, &arguments.out, nothing) {
        (Some(kind), Some(path), false) => {
            let written =
                bytes(&mut analysis, kind).and_then(|bytes| Ok(write_whole(path, &bytes)?));
            written.map(|()| Some(path.as_path()))
        }
        _ => Ok(None),
    };
    // What was found out is printed, whether or not it could be saved.
    let saved = written.as_ref().ok().copied().flatten();
    if arguments.json {
        let saved = saved.map(|path| path.display().to_string());
        let object = report::json(&analysis, saved.as_deref());
        output::emit(&format!("{object}\n"))?;
    } else if !nothing {
        output::emit(&to_text(&analysis, saved))?;
    }
    written?;
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

fn bytes(analysis: &mut Analysis, kind: Kind) -> Result<Vec<u8>> {
    if kind == Kind::Csv {
        return Ok(report::csv(analysis).into_bytes());
    }
    let scene = |figure: &Figure| figure_scene(figure, &Palette::LIGHT);
    if kind == Kind::Html {
        let svg = |figure| anyhow::Ok(tilescope_figures::to_svg(&scene(figure)?)?);
        let figures: Result<Vec<String>> = curves::figures(analysis).iter().map(svg).collect();
        return Ok(page::html(analysis, &figures?).into_bytes());
    }
    let (figure, left_out) = curves::figure(analysis);
    if left_out > 0 {
        analysis.note(format!(
            "{left_out} of {} periodograms are left out of the picture; a report that ends in .html has all",
            analysis.subjects.len()
        ));
    }
    if kind == Kind::Png {
        return Ok(tilescope_figures::to_png(&scene(&figure)?, 2.0)?);
    }
    Ok(tilescope_figures::to_svg_with_fonts(&scene(&figure)?)?.into_bytes())
}

fn to_text(analysis: &Analysis, saved: Option<&Path>) -> String {
    let mut out = table::text(&table::measures(&analysis.subjects, analysis.against));
    if let Some(reference) = analysis.reference() {
        out.push('\n');
        let (held, comparisons) = (analysis.held(), &analysis.comparisons);
        out.push_str(&table::text(&differences::table(
            reference,
            held,
            comparisons,
        )));
    }
    if let Some(path) = saved {
        let _ = writeln!(out, "\nreport         {}", path.display());
    }
    out
}
