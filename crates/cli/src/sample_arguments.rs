//! The arguments of `tilescope sample`: whether the set is made band by band, and the statements of its certificate. Other
//! modules make the set.

use std::path::{Path, PathBuf};

use anyhow::{Result, ensure};
use clap::{Args, ValueEnum};
use tilescope_core::{NestedRequest, Variant, WithinLevel};
use tilescope_formats::{ExportContext, Format, PointSet, Precision, Warning};
use tilescope_sets::Facts;

use crate::engine::EngineArguments;
use crate::ground::{CoordinateArguments, GroundArguments};
use crate::options::{JudgeArguments, Names, PRECISIONS, formats, named, pair};
use crate::output;
use crate::parameters::RunArguments;
use crate::paths::InFile;
use crate::space::SpaceArguments;

/// Seconds between checkpoints if none are given.
pub const CHECKPOINT: u64 = 30;

/// Sets of more than about this many samples are made band by band where that is possible, to save memory.
const LARGE: f64 = 1e6;

/// Exact tilings of more than about this many samples are made band by band. Bands follow the doubtful samples at the ends
/// of their windows, and take 1.6 times as long as a whole set (3.4 against 2.1 s for 2.8 million samples on one thread). A
/// whole set of so many samples takes about 2 GB, which is chosen, not measured.
const LARGE_EXACT: f64 = 2e7;

/// Arguments of `tilescope sample`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct SampleArguments {
    #[command(flatten)]
    pub run: RunArguments,
    #[command(flatten)]
    pub engine: EngineArguments,
    #[command(flatten)]
    pub nested: NestedArguments,
    #[command(flatten)]
    pub ground: GroundArguments,
    #[command(flatten)]
    pub coordinates: CoordinateArguments,
    #[command(flatten)]
    pub space: SpaceArguments,
    /// Only the samples of the set in this rectangle, X0 <= x < X1 and Y0 <= y < Y1, without making the
    /// rest. In a periodic domain it may cross the border or lie beyond it; in a bounded domain a rectangle
    /// that reaches the upper border includes it. Of a field or a shape it has the coordinates of these. With --levels the file has level and rank of each sample, as the whole set.
    /// Six numbers, X0 Y0 Z0 X1 Y1 Z1, are a box in space without end, which has a radius and a seed alone
    #[arg(long, num_args = 4..=6, value_names = ["X0", "Y0", "X1", "Y1"],
        conflicts_with_all = ["shuffle", "resume", "no_verify"])]
    pub window: Option<Vec<f64>>,
    /// KDRT; exact tiling, which has no bias at seams; or the reference sampler, which makes a maximal set from scratch and,
    /// of the arguments above, uses only radius or count, sides, boundary and seed. If not given KDRT, and the reference sampler
    /// for a radius that varies, for sets in space and for shapes, which are also tiled exactly
    #[arg(long, value_enum)]
    pub method: Option<SamplingMethod>,
    /// Save the set, validated, with a certificate beside it; the extension gives the format. Sets of more than a million
    /// samples by KDRT, and of more than 20 million by exact tiling with --radius, are written band by band: to npy, bin,
    /// rps, csv and ply of any size. All others have at most 200 million samples
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Continue an interrupted --out from its last checkpoint; all other arguments must be the same
    #[arg(long, requires = "out", conflicts_with = "levels")]
    pub resume: bool,
    /// Seconds between checkpoints of a file that is written band by band: an interruption loses no more work. If not given, 30
    #[arg(long, value_name = "SECONDS", requires = "out")]
    pub checkpoint: Option<u64>,
    /// Store positions with this added, for a domain at map coordinates: its lower corner. The certificate states it, and
    /// programs before it refuse such a set. Polygons and expressions are in these coordinates
    #[arg(long, num_args = 2, value_names = ["X", "Y"])]
    pub origin: Option<Vec<f64>>,
    #[command(flatten)]
    pub judge: JudgeArguments,
    /// Do not verify; a file then has no certificate
    #[arg(long, requires = "out", conflicts_with = "judge")]
    pub no_verify: bool,
    /// Format of the file, if its extension does not name one
    #[arg(long, value_name = "FORMAT", value_parser = formats(), requires = "out")]
    pub format: Option<Format>,
    /// Number type, for formats that leave the choice: f32 or f64. Rounding to f32 moves samples of large sets (from some
    /// 30,000 on) closer than the radius: such a file is NOT VALID, and a warning names the radius up to which it is
    /// conflict-free
    #[arg(long, value_parser = named::<Precision>(&PRECISIONS), default_value = "f64", requires = "out")]
    pub precision: Precision,
    /// Write the samples in an order drawn from this seed
    #[arg(long, value_name = "SEED", requires = "out", conflicts_with = "levels")]
    pub shuffle: Option<u64>,
    /// Print one JSON object
    #[arg(long)]
    pub json: bool,
}

const EXAMPLES: &str = "\
Examples:
  tilescope sample --radius 0.01
  tilescope sample --count 100000 --seed 7 --out set.npy
  tilescope sample --radius 0.02 --width 2 --boundary bounded --insertion uniform --out set.csv
  tilescope sample --count 100000000 --leaf 40 --out huge.npy
  tilescope sample --count 100000000 --engine gpu --out huge.npy
  tilescope sample --radius 0.002 --levels 8 --out levels.npy
  tilescope sample --exactly 10000 --levels 6 --out set.csv
  tilescope sample --radius 2 --width 100 --height 80 --origin 500000 5400000 --out trees.csv
  tilescope sample --radius 2e-5 --window 0.5 0.5 0.502 0.502
  tilescope sample --radius 1e-4 --levels 6 --window 0.5 0.5 0.52 0.52 --out part.csv
  tilescope sample --radius 1 --window 0 0 0 10 10 10 --out part.ply
  tilescope sample --radius 0.002 --search 2          the experiment that leaves gaps: exit code 1
  tilescope sample --count 100000 --method exact --out exact.npy
  tilescope sample --count 5000 --method reference --json
  tilescope sample --radius-expression '0.006 + 0.024*x' --out ramp.csv
  tilescope sample --density-image photo.png --count 20000 --out dense.csv
  tilescope sample --radius-image grey.png --radius 0.002..0.02 --out field.ply
  tilescope sample --shape park.geojson --radius 2 --out trees.csv
  tilescope sample --radius-expression '0.0001 + 0.0002*x' --window 0.5 0.5 0.52 0.52 --out part.csv
  tilescope sample --shape park.geojson --exactly 1000 --out trees.csv
  tilescope sample --size 10x10x10 --radius 1 --out balls.ply
  tilescope sample --width 2 --depth 3 --exactly 5000 --boundary bounded --out balls.npy";

/// How to make the set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SamplingMethod {
    /// Randomized tiling
    Kdrt,
    /// Tiling of all darts with their arrival order, without bias at seams. Blocks share a pattern of k samples: the law of
    /// the reference sampler holds in every window in which no part of the pattern occurs twice, and averages over N samples
    /// vary about as those of N k / (N + k) independent ones, which is less than k however large N is. So the pattern's seed is the
    /// seed, and its side 200 r up to 28,000 samples (k = 27,800) and 400 r above (k = 111,400), unless they are given. Its
    /// tables take 101 bytes a squared r: 4.1 and 16.2 MB. Below about 300,000 samples the reference sampler takes less
    /// time
    Exact,
    /// Ebeida et al. 2012
    Reference,
}

/// Arguments of nested levels.
#[derive(Debug, Args)]
pub struct NestedArguments {
    /// Make K sets by KDRT, each with all samples of the one before and maximal for a radius smaller by the root of 2. The last has
    /// the radius or the count given. The samples of the first come first, so that every prefix of the set is evenly spread
    #[arg(long, value_name = "K", conflicts_with = "pattern")]
    pub levels: Option<u32>,
    /// Exactly N samples: the first of a run of --levels whose last set has as many or a few more. There is no maximal
    /// set of exactly so many samples in general: of these, every place is within 1.42 radii. With a third side (--depth) no
    /// levels are needed, and none with a field or a shape: the first N by their arrival, with the factor of the radius within which
    /// they cover. Radii of an image or a formula are scaled for it
    #[arg(long, value_name = "N", group = "size", conflicts_with = "count")]
    pub exactly: Option<usize>,
    /// How the samples that a level adds follow each other
    #[arg(long, value_name = "ORDER", value_parser = named::<WithinLevel>(&ORDERS_WITHIN), default_value = "random",
        requires = "levels")]
    pub order_within: WithinLevel,
}

const ORDERS_WITHIN: Names<2> = [
    ("random", "In an order that is drawn"),
    (
        "farthest",
        "Each is the farthest from all samples before it",
    ),
];

impl NestedArguments {
    /// Returns the levels that the arguments ask for, if any. Refuses `--exactly` without levels: in the plane only
    /// levels give a set whose first samples are spread evenly.
    pub fn request(&self) -> Result<Option<NestedRequest>> {
        ensure!(
            self.exactly.is_none() || self.levels.is_some(),
            "--exactly needs --levels K, which KDRT alone has, or a third side (--depth D), a field or a shape, which `tilescope sample` takes"
        );
        Ok(self.of_levels())
    }

    fn of_levels(&self) -> Option<NestedRequest> {
        Some(NestedRequest {
            levels: self.levels?,
            exactly: self.exactly,
            order_within: self.order_within,
        })
    }
}

impl SampleArguments {
    /// Returns the method, which is KDRT unless another one is chosen.
    pub fn method(&self) -> SamplingMethod {
        self.method.unwrap_or(SamplingMethod::Kdrt)
    }

    /// Returns the file's format, if there is a file.
    fn format(&self) -> Option<Format> {
        let named = || self.out.as_deref().and_then(Format::from_path);
        self.format.or_else(named)
    }

    /// Returns whether the set is made band by band. The method, the engine and the format must allow it, and the set
    /// must not be shuffled. There must be a reason, too: the set is large, is resumed, or is not verified. Fails if
    /// `--resume` is given and the set cannot be made band by band. `expected` is the expected number of samples.
    pub fn streams(&self, expected: f64) -> Result<bool> {
        let makes_bands = match self.method() {
            SamplingMethod::Kdrt => self.engine.makes_bands(self.run.asked.variant),
            // A GPU makes exact tilings in one go, and so does the search for the radius of a count.
            SamplingMethod::Exact => {
                self.run.count.is_none() && self.engine.makes_windows(Variant::Staged)
            }
            SamplingMethod::Reference => false,
        };
        // A shuffled set is in no order of rows, in which bands could be written.
        let takes_bands = self.format().is_none_or(Format::streams) && self.shuffle.is_none();

        // Checkpoints lie between bands: a set that is made as a whole has none, and could only begin again.
        if self.resume {
            ensure!(makes_bands, self.why_not_by_bands());
            let formats = Format::ALL.into_iter().filter(|format| format.streams());
            let streams: Vec<_> = formats.map(Format::extension).collect();
            ensure!(
                takes_bands,
                "--resume needs a format that is written band by band ({}), and no --shuffle",
                streams.join(", ")
            );
        }
        // A small set is verified in memory. Without a verdict nothing needs it there, and it is written as it is made.
        let large = match self.method() {
            SamplingMethod::Exact => LARGE_EXACT,
            SamplingMethod::Kdrt | SamplingMethod::Reference => LARGE,
        };
        Ok(makes_bands && takes_bands && (self.resume || self.no_verify || expected > large))
    }

    /// Returns why `--resume` is refused for a set that is not made band by band: the method or the engine is the cause.
    fn why_not_by_bands(&self) -> &'static str {
        match self.method() {
            SamplingMethod::Kdrt => {
                "--resume needs the parallel engine or a GPU, which make sets band by band"
            }
            SamplingMethod::Exact => {
                "--resume with --method exact needs --radius and the parallel engine: --count, a GPU and the sequential engine make whole sets"
            }
            SamplingMethod::Reference => {
                "--resume is for KDRT and exact tiling: the reference sampler makes whole sets"
            }
        }
    }

    /// Returns the statements of the set's certificate.
    pub fn context(&self, facts: &Facts) -> ExportContext {
        ExportContext {
            format: self.format(),
            shuffle_seed: self.shuffle,
            precision: self.precision,
            origin: pair(self.origin.as_ref()).unwrap_or(facts.origin),
            verify: self.judge.options(),
            ..facts.context()
        }
    }
}

/// Leaves an origin out, with a note, where the format to be written cannot hold it. Fails there for sets with a field
/// or a shape, which lie at the origin.
pub fn leave_out_origin(
    path: &Path,
    format: Option<Format>,
    context: &mut ExportContext,
) -> Result<()> {
    let format = Format::to_write(path, format)?;
    let [x, y] = context.origin;
    if format.is_unit_torus() && (x != 0.0 || y != 0.0) {
        // Samples alone may be moved to zero; a shape or a field would then lie elsewhere than they do.
        ensure!(
            context.varying.is_none(),
            "{format} holds positions of the unit torus, without the origin {x} {y} at which the shape or the field lies"
        );
        context.origin = [0.0; 2];
        output::note(&format!(
            "note: {format} holds positions of the unit torus: the origin {x} {y} is left out"
        ));
    }
    Ok(())
}

/// Saves a set without a verdict, and so without a certificate.
pub fn save_unverified(
    set: &PointSet,
    path: &Path,
    context: &ExportContext,
) -> Result<Vec<Warning>> {
    tilescope_formats::export_unverified(path, set, context).in_file(path)
}
