//! `tilescope analyze`: every measure of one or more point sets, as a table, as curves and as a report.
//! A file that cannot be analysed is named, and the others are analysed.

mod curve;
mod curves;
mod differences;
mod gather;
mod measure;
mod measured;
mod names;
pub(crate) mod page;
mod report;
mod space;
mod subject;
mod table;

use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use clap::Args;
use tilescope_analysis::Region;
use tilescope_analysis::measures::Spectrum;
use tilescope_figures::Palette;
use tilescope_figures::chart::{Figure, figure_scene};
use tilescope_formats::write_whole;

use crate::ground::GroundArguments;
use crate::options::SetArguments;
use crate::paths::{check_file, check_inputs_stay, extension, named};
use crate::space::SizeArgument;
use crate::{EXIT_BAD_INPUT, EXIT_FINE, interrupt, output};
use gather::Analysis;
use space::InSpace;

/// Arguments of `tilescope analyze`.
#[derive(Clone, Debug, Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct AnalyzeArguments {
    /// The point sets, in any formats
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    /// Average all FILEs, and all planar sets of those that hold several: mean curves with bands, numbers with standard errors
    #[arg(long)]
    average: bool,
    /// Compare the sets with this one, or with the average of several: it is drawn dashed, and differences
    /// from it are drawn and printed. The list ends with the next option
    #[arg(long, value_name = "FILE", num_args = 1..)]
    against: Vec<PathBuf>,
    /// The largest frequency of spectra, as nu = |k| / sqrt(N) [default: 2.5, or 1023 cycles along a side
    /// if 2.5 takes more than 2 GiB of memory]; in space |k| / cbrt(N / volume), 2.5 by default
    #[arg(long, value_name = "NU")]
    frequencies: Option<f64>,
    #[command(flatten)]
    set: SetArguments,
    #[command(flatten)]
    ground: GroundArguments,
    #[command(flatten)]
    size: SizeArgument,
    /// Save a report: .html (table and curves), .png or .svg (curves), .csv (all numbers)
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

const EXAMPLES: &str = "\
Sides and boundary that neither a certificate nor an argument gives are those of the periodic unit
square. A radius that neither gives is the smallest distance between two samples.

Where the radius varies or there is a shape, a certificate that states an expression and polygons is
enough; images must be given. The numbers are then those of all places together, in the least radius.

Frequencies are given as nu = |k| / sqrt(N), distances over r_max, the smallest distance in the
hexagonal lattice of as many samples; if all sets have one known radius, of as many as the first set has.
Shaded bands hold the true mean with probability 0.95.

Effective Nyquist frequencies are those of the smooth spectrum that follows from g(r): they hardly
scatter, and lie 2 to 3 % below those of Heck's definition on the mean periodogram of many sets; a square
lattice has 0.92 instead of 1.

Sets in space, those with a certificate of one or with --depth, have the power by shells of frequency, with
nu = |k| / cbrt(N / volume), and g(r) over the distance in radii. Powers of two single sets are compared
by the scatter between their frequencies, and averages by the spread between sets. Reports that are pages or
pictures also show the power at all frequencies without a cycle along x, along y, or along z.

With --average all sets must have the domain of the first and its number of samples to within 10 %;
frequencies are the first one's, and nu is taken with the mean number of samples; in space it is the mean of the
sets' own.

Examples:
  tilescope analyze set.csv
  tilescope analyze --average kdrt-*.npy --against reference-*.npy --out report.html
  tilescope analyze kdrt.npy darts.npy --against reference.npy --out report.html
  tilescope analyze theirs.txt --radius 0.01 --boundary bounded --json
  tilescope analyze *.npy --out numbers.csv
  tilescope analyze balls.ply --out balls.html
  tilescope analyze balls.ply --against theirs.ply

Exit codes: 0 all files were analysed, 2 a file was not, or the arguments cannot be used.";

/// The extensions that a report may have.
const EXTENSIONS: [&str; 5] = ["html", "htm", "png", "svg", "csv"];

/// Measures the sets of some files, prints the numbers and writes the report.
pub fn run(arguments: &AnalyzeArguments) -> Result<u8> {
    interrupt::listen();
    let has_image = arguments.ground.radius_image.is_some();
    arguments.set.refuse_two_radii(has_image)?;
    // From here on three sides in one word are as three options.
    let mut arguments = arguments.clone();
    arguments.set.take_sides(&arguments.size);
    let arguments = &arguments;
    let out = arguments.out.as_deref();
    // The path is checked before the work, so that the command does not fail only when it writes. A report in the place
    // of an input would destroy it.
    if let Some(path) = out {
        ensure!(
            EXTENSIONS.contains(&extension(path).as_str()),
            "{}: the extension of a report must be .html, .png, .svg or .csv",
            named(path)
        );
        let inputs = arguments.files.iter().chain(&arguments.against);
        let inputs = inputs.map(PathBuf::as_path);
        check_inputs_stay(path, inputs.chain(arguments.ground.files()))?;
        check_file(path).context("--out")?;
    }

    if space::is_asked(arguments)? {
        (arguments.ground).refuse("sets in space have one radius and no shape")?;
        return in_space(arguments);
    }
    if let Some(nu) = arguments.frequencies {
        // A frequency that is too large for one sample is too large for any set.
        Spectrum::window_to(nu, 1.0, Region::UNIT_SQUARE).context("--frequencies")?;
    }

    let mut analysis = Analysis::of(arguments)?;
    // The reference alone is compared with nothing: there is nothing to draw.
    let is_empty = analysis.compared().is_empty();
    // The path of the report if it was written, or why it could not be.
    let written = match out.filter(|_| !is_empty) {
        Some(path) => save(&mut analysis, path).map(|()| out),
        None => Ok(None),
    };

    // The results are printed, whether or not they could be saved.
    let saved = (written.as_ref().ok().copied().flatten()).map(|path| path.display().to_string());
    // The failures were printed as they came. Programs get their object all the same, with the failures in it.
    if arguments.json || !is_empty {
        let json = || report::json(&analysis, saved.as_deref());
        output::report(arguments.json, json, || text(&analysis, saved.as_deref()))?;
    }

    written?;
    let is_fine = analysis.failures.is_empty();
    Ok(if is_fine { EXIT_FINE } else { EXIT_BAD_INPUT })
}

/// Measures sets in space, prints the numbers and writes the report.
fn in_space(arguments: &AnalyzeArguments) -> Result<u8> {
    let analysis = InSpace::of(arguments)?;
    // If no file could be measured there is nothing to draw.
    let out = arguments.out.as_deref().filter(|_| !analysis.is_empty());
    let written = match out {
        Some(path) => save_in_space(&analysis, path),
        None => Ok(()),
    };

    // The results are printed, whether or not they could be saved.
    let saved = out
        .filter(|_| written.is_ok())
        .map(|path| path.display().to_string());
    if arguments.json || !analysis.is_empty() {
        let json = || analysis.json(saved.as_deref());
        let text = || with_report(analysis.text(), saved.as_deref());
        output::report(arguments.json, json, text)?;
    }

    written?;
    let is_fine = analysis.is_fine();
    Ok(if is_fine { EXIT_FINE } else { EXIT_BAD_INPUT })
}

/// Writes the report on sets in space in the format of the path's extension.
fn save_in_space(analysis: &InSpace, path: &Path) -> Result<()> {
    let bytes = match extension(path).as_str() {
        "csv" => analysis.csv().into_bytes(),
        "png" | "svg" => {
            let (figure, left_out) = analysis.figure();
            if left_out > 0 {
                output::note(&format!(
                    "note: the planes of {left_out} sets are left out of the picture; a report that ends in .html has all"
                ));
            }
            picture(&figure, path)?
        }
        // `run` lets only the extensions of pages through here.
        _ => analysis
            .html(&page_figures(&analysis.figures())?)
            .into_bytes(),
    };
    Ok(write_whole(path, &bytes)?)
}

/// Returns figures as SVG without fonts, for a page that has them.
fn page_figures(figures: &[Figure]) -> Result<Vec<String>> {
    let svg = |figure| {
        let scene = figure_scene(figure, &Palette::LIGHT)?;
        anyhow::Ok(tilescope_figures::to_svg(&scene)?)
    };
    figures.iter().map(svg).collect()
}

/// Returns a figure in the format of the path's extension, .png or .svg.
fn picture(figure: &Figure, path: &Path) -> Result<Vec<u8>> {
    let scene = figure_scene(figure, &Palette::LIGHT)?;
    if extension(path) == "png" {
        Ok(tilescope_figures::to_png(&scene, SCALE)?)
    } else {
        // A file of its own has no page around it whose style has the fonts.
        Ok(tilescope_figures::to_svg_with_fonts(&scene)?.into_bytes())
    }
}

/// Pixels of a point in a PNG picture, so that letters stay sharp on screens of high density.
const SCALE: f64 = 2.0;

/// Writes the report in the format of the path's extension.
fn save(analysis: &mut Analysis, path: &Path) -> Result<()> {
    let bytes = match extension(path).as_str() {
        "csv" => report::csv(analysis).into_bytes(),
        "png" | "svg" => {
            let (figure, left_out) = curves::figure(analysis);
            if left_out > 0 {
                analysis.note(format!(
                    "{left_out} of {} periodograms are left out of the picture; a report that ends in .html has all",
                    analysis.subjects.len()
                ));
            }
            picture(&figure, path)?
        }
        // `run` lets only the extensions of pages through here.
        _ => {
            let figures = page_figures(&curves::figures(analysis))?;
            page::html(analysis, &figures).into_bytes()
        }
    };

    Ok(write_whole(path, &bytes)?)
}

fn text(analysis: &Analysis, saved: Option<&str>) -> String {
    let mut out = table::text(&table::measures(&analysis.subjects));
    if let Some(reference) = analysis.reference() {
        let table = table::differences(
            &reference.label,
            analysis.compared().iter().map(|one| one.label.as_str()),
            &analysis.differences,
        );
        out = format!("{out}\n{}", table::text(&table));
    }
    with_report(out, saved)
}

/// Adds the path of a report that was saved to the text that is printed.
fn with_report(text: String, saved: Option<&str>) -> String {
    match saved {
        Some(path) => format!("{text}\nreport         {path}\n"),
        None => text,
    }
}
