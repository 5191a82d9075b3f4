//! `tilescope combine`: sets that are there or are made for it, placed side by side by a layout, become one set
//! (section 4.2 of the paper), verified and saved.

mod pieces;
#[cfg(test)]
mod refusals;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, ensure};
use clap::Args;
use serde_json::{Value, json};
use tilescope_core::Sampled;
use tilescope_core::combine::file::{
    Layout, LayoutError, MAX_LAYOUT_BYTES, PieceSource, PlacedLayout,
};
use tilescope_core::combine::{Combined, combine};
use tilescope_formats::{Exported, Format, PointSet, Precision};

use crate::engine::ThreadArguments;
use crate::facts::{Facts, named_by_content};
use crate::make::{self, Made};
use crate::options::region;
use crate::output::{self, Outcome};
use crate::place::check_target;
use crate::progress::{Stopwatch, verifying};
use crate::sample_arguments::PrecisionArgument;
use crate::{interrupt, verdict_code};

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
    /// Format of the file, where the extension does not tell
    #[arg(long, value_name = "FORMAT", requires = "out")]
    format: Option<Format>,
    /// Number type, for formats that leave the choice: f32 or f64
    #[arg(long, value_enum, default_value = "f64", requires = "out")]
    precision: PrecisionArgument,
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
  offset       of a set by file or parameters: which place of it, in its own units, lies on the
               rectangle's lowest corner
Every set is scaled until its radius is the layout's. One that is not conflict-free and maximal is
refused. A periodic set repeats; a bounded one must reach over its rectangle.

Examples:
  tilescope combine nine.json --out nine.csv
  tilescope combine nine.json --json"#;

pub fn run(arguments: &CombineArguments) -> Result<u8> {
    interrupt::listen();
    arguments.threads.set()?;
    if let Some(path) = &arguments.out {
        check_target(path, arguments.format, "--format")?;
    }
    let glued = glue(&arguments.layout).with_context(|| arguments.layout.display().to_string())?;
    let facts = &glued.made.facts;
    let (report, saved, warnings) = match &arguments.out {
        Some(path) => {
            let exported = save(arguments, &glued.made, path)?;
            let certificate = Some(exported.certificate_path);
            (exported.report, certificate, exported.warnings)
        }
        None => (
            make::judge(&glued.made.set.points, facts.region, facts.radius)?,
            None,
            Vec::new(),
        ),
    };
    let outcome = Outcome {
        facts,
        count: glued.made.set.len() as u64,
        report: Some(&report),
        saved: saved.as_deref(),
        warnings: warnings.iter().map(ToString::to_string).collect(),
    };
    if arguments.json {
        output::emit(&format!("{}\n", glued.json(&outcome)))?;
    } else {
        let text = output::text(&outcome);
        output::emit(&format!("{}\n{text}", glued.census))?;
    }
    Ok(verdict_code(report.valid()))
}

/// A combined set with what is to be told of it.
struct Glued {
    made: Made,
    census: Census,
    seams: usize,
}

impl Glued {
    fn json(&self, outcome: &Outcome<'_>) -> Value {
        let mut object = output::json(outcome);
        if let Some(map) = object.as_object_mut() {
            map.insert("pieces".into(), self.census.json());
            map.insert("seams".into(), json!(self.seams));
        }
        object
    }
}

/// Reads a layout, makes its pieces and glues them.
fn glue(path: &Path) -> Result<Glued> {
    let layout = read(path)?;
    let placed = layout.placed()?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let made = pieces::make(&placed, folder)?;
    let mut watch = Stopwatch::start();
    let combined = combine(placed.domain, &made.pieces, &layout.options(), &mut watch)?;
    let facts = Facts {
        method: "combined",
        engine: None,
        parameters: BTreeMap::from([("layout".to_owned(), stated(&layout, &placed, folder)?)]),
        region: region(&combined.domain),
        radius: combined.domain.radius(),
        summary: Some(combined.summary().clone()),
        seconds: watch.take(),
    };
    let seams = combined.seams.len();
    Ok(Glued {
        made: Made {
            facts,
            set: set_of(combined),
        },
        census: made.census,
        seams,
    })
}

/// Reads a layout. Fails when it is too long or has another form.
fn read(path: &Path) -> Result<Layout> {
    let about = fs::metadata(path)?;
    ensure!(about.is_file(), "this is no file");
    let bytes = about.len();
    if bytes > MAX_LAYOUT_BYTES {
        return Err(LayoutError::TooLong { bytes }.into());
    }
    Ok(Layout::from_json(&fs::read(path)?)?)
}

/// Returns the layout as a certificate states it: files without folders, with their digests.
fn stated(layout: &Layout, placed: &PlacedLayout, folder: &Path) -> Result<Value> {
    let mut stated = serde_json::to_value(layout)?;
    for (k, place) in placed.places.iter().enumerate() {
        if let PieceSource::File { path, .. } = &place.source {
            let named = named_by_content(&folder.join(path))?;
            stated["pieces"][k]["file"] = named["file"].clone();
            stated["pieces"][k]["digest"] = named["digest"].clone();
        }
    }
    Ok(stated)
}

/// Returns the samples with their provenance: pieces in the place of blocks.
fn set_of(combined: Combined) -> PointSet {
    let points = combined.positions();
    let sampled = Sampled {
        points: combined.points,
        sources: Some(combined.sources),
    };
    PointSet {
        points,
        provenance: make::provenance(&sampled),
    }
}

fn save(arguments: &CombineArguments, made: &Made, path: &Path) -> Result<Exported> {
    let mut context = made.facts.context();
    let named = || Format::from_path(path);
    context.format = arguments.format.or_else(named);
    context.precision = match arguments.precision {
        PrecisionArgument::F32 => Precision::Single,
        PrecisionArgument::F64 => Precision::Double,
    };
    verifying(|control| tilescope_formats::export(path, &made.set, &context, control))
        .with_context(|| path.display().to_string())
}
