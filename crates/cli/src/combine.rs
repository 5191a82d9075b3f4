//! `tilescope combine`: glues sets, from files or made for it, that a layout places side by side (section 4.2 of the
//! paper); the result is verified and saved.

mod pieces;
#[cfg(test)]
mod tests;

use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Result, ensure};
use clap::Args;
use serde_json::{Value, json};
use tilescope_core::combine::combine;
use tilescope_core::combine::file::{Layout, LayoutError, MAX_LAYOUT_BYTES, PieceSource};
use tilescope_formats::{ExportContext, Format, Precision, solid_certificate};
use tilescope_sets::{Made, named_by_content, stated_layout};

use crate::engine::ThreadArguments;
use crate::interrupt;
use crate::make::Worked;
use crate::options::{JudgeArguments, PRECISIONS, formats, named};
use crate::output::{self, Work};
use crate::paths::{InFile, check_inputs_stay, check_target};
use crate::progress::Stopwatch;

use pieces::Census;

/// Arguments of `tilescope combine`.
#[derive(Debug, Args)]
#[command(after_help = LAYOUT_HELP)]
pub struct CombineArguments {
    /// The layout: a JSON file, described below
    layout: PathBuf,
    /// Save the set, validated, with a certificate beside it; the extension gives the format
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Format of the file, if its extension does not name one
    #[arg(long, value_name = "FORMAT", value_parser = formats(), requires = "out")]
    format: Option<Format>,
    /// Number type, for formats that leave the choice: f32 or f64
    #[arg(long, value_parser = named::<Precision>(&PRECISIONS), default_value = "f64", requires = "out")]
    precision: Precision,
    #[command(flatten)]
    judge: JudgeArguments,
    #[command(flatten)]
    threads: ThreadArguments,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

const LAYOUT_HELP: &str = r#"The layout:
  {
    "version": 1,
    "boundary": "periodic",            or "bounded"; periodic if not given
    "radius": 0.005,                   of the result, in its units
    "columns": [0.5, 0.5],             widths, from left to right
    "rows": [0.4, 0.6],                heights, from bottom to top
    "pieces": [                        row by row from the bottom
      { "seed": 1 },
      { "seed": 2, "method": "reference" },
      { "file": "a.csv", "offset": [0.1, 0] },
      { "parameters": { "seed": 3, "leaf": 20, "insertion": "uniform" } }
    ]
  }
Instead of columns and rows: "width", "height", and in each piece "rect": [x0, y0, x1, y1].
The rectangles must fill the domain and not overlap. Also: "seed" of the gluing (1 if not given),
"order" and "insertion" as in sample.

Pieces:
  seed         a set as large as its rectangle, by "method" kdrt (if not given) or reference;
               its "boundary" is the layout's, if not given
  parameters   a set by kdrt. Width, height and radius are given together, or are the rectangle's
               and the layout's; the boundary is the layout's, all else as in sample, if not given
  file         a point set, relative to the layout's folder, with a certificate beside it or with
               "radius" and, unless it is the periodic unit square, "width", "height", "boundary"
  offset       of a set by file or parameters: which point of it, in its own units, lies on the
               rectangle's lowest corner
Every set is scaled until its radius is the layout's. One that is not conflict-free and maximal is
refused. A periodic set repeats; a bounded one must reach over its rectangle.

Examples:
  tilescope combine nine.json --out nine.csv
  tilescope combine nine.json --json"#;

/// Combines the sets of a layout, writes the result and prints its report.
pub fn run(arguments: &CombineArguments) -> Result<u8> {
    interrupt::listen();
    arguments.threads.set()?;
    // The file is checked before the pieces are made, which takes longest.
    if let Some(path) = &arguments.out {
        check_target(path, arguments.format, "--format")?;
        check_inputs_stay(path, [arguments.layout.as_path()])?;
    }
    let out = arguments.out.as_deref();
    let Glued {
        worked,
        census,
        seams,
    } = glue(&arguments.layout, out).in_file(&arguments.layout)?;

    // Without a file there is nothing to be written in a format.
    let context = ExportContext {
        format: arguments.format.or_else(|| Format::from_path(out?)),
        precision: arguments.precision,
        verify: arguments.judge.options(),
        ..worked.made.facts.context()
    };
    let outcome = worked.finish(out, &context)?;

    let json = || {
        let mut object = outcome.json();
        object["pieces"] = json!(census);
        object["seams"] = json!(seams);
        object
    };
    let text = || format!("{}\n{}", census.text(), outcome.text());
    output::report(arguments.json, json, text)?;
    Ok(outcome.code())
}

/// The set that a layout's pieces are glued to.
struct Glued {
    worked: Worked,
    census: Census,
    /// How many seams it has.
    seams: usize,
}

/// Reads a layout, makes its pieces and glues them. Fails if `out` is one of its files.
fn glue(path: &Path, out: Option<&Path>) -> Result<Glued> {
    let layout = read(path)?;
    let placed = layout.placed()?;
    // Files of a layout are relative to its folder, so that both can be moved together.
    // Only a root has no folder, and could not be read above.
    let folder = path.parent().unwrap_or(Path::new(""));
    // Only the layout names the files of its pieces, so that they are known no earlier.
    let of_file = |source: &PieceSource| match source {
        PieceSource::File { path, .. } => Some(folder.join(path)),
        PieceSource::Run { .. } | PieceSource::Reference { .. } => None,
    };
    let pieces = placed.pieces.iter();
    let files: Vec<PathBuf> = pieces.filter_map(|piece| of_file(&piece.source)).collect();
    if let Some(out) = out {
        check_inputs_stay(out, files.iter().map(PathBuf::as_path))?;
    }
    for file in &files {
        refuse_third_side(file).in_file(file)?;
    }

    let (pieces, census) = pieces::make(&placed, folder)?;
    // The time that the pieces took is in the census: this is the time of gluing alone.
    let mut watch = Stopwatch::start();
    let combined = combine(placed.domain, &pieces, &layout.options(), &mut watch)?;
    let work = Work::on_cpu(&mut watch);

    // The certificate names files by their content, as a path may hold another set tomorrow.
    let named = |path: &str| named_by_content(&folder.join(path));
    let made = Made::combined(&combined, stated_layout(&layout, &placed, named)?);
    Ok(Glued {
        worked: Worked { made, work },
        census,
        seams: combined.seams.len(),
    })
}

/// Reads a layout. Fails if it is too long or malformed.
fn read(path: &Path) -> Result<Layout> {
    let about = fs::metadata(path)?;
    ensure!(about.is_file(), "this is not a file");
    let bytes = about.len();
    if bytes > MAX_LAYOUT_BYTES {
        return Err(LayoutError::TooLong { bytes }.into());
    }
    let text = fs::read(path)?;
    // A third side is no misspelt field: the answer says what it would need.
    ensure!(
        !serde_json::from_slice(&text).is_ok_and(|layout| has_depth(&layout)),
        "\"depth\": sets in space are not combined: pieces and seams are those of a plane"
    );
    Ok(Layout::from_json(&text)?)
}

/// Refuses the file of a set in space.
fn refuse_third_side(file: &Path) -> Result<()> {
    ensure!(
        solid_certificate(file).is_none(),
        "its certificate states a third side, and sets in space are not combined: pieces and seams are those of a plane"
    );
    Ok(())
}

/// Whether a layout, or a part of it, states a third side.
fn has_depth(value: &Value) -> bool {
    match value {
        Value::Object(fields) => fields.contains_key("depth") || fields.values().any(has_depth),
        Value::Array(all) => all.iter().any(has_depth),
        _ => false,
    }
}
