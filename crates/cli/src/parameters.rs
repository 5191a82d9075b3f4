//! Arguments that determine a run, and the parameters and pattern that they make.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, Result, bail};
use clap::{ArgGroup, Args, ValueEnum};
use tilescope_analysis::Region;
use tilescope_core::{
    Domain, Insertion, Observer, Order, Parameters, Pattern, PatternSpec, Search, Variant,
};
use tilescope_formats::Hint;

use crate::options::{BoundaryArgument, UNIT_SQUARE};

/// Arguments that determine a run.
#[derive(Debug, Args)]
#[command(group = ArgGroup::new("size").args(["radius", "count"]).required(true))]
pub struct RunArguments {
    /// Poisson-disk radius, in user units
    #[arg(long, value_name = "R")]
    pub radius: Option<f64>,
    /// Choose the radius so that about N samples result, to within 1%
    #[arg(long, value_name = "N")]
    pub count: Option<u64>,
    /// Width of the domain
    #[arg(long, value_name = "W", default_value_t = 1.0)]
    pub width: f64,
    /// Height of the domain
    #[arg(long, value_name = "H", default_value_t = 1.0)]
    pub height: f64,
    /// How the domain ends
    #[arg(long, value_enum, default_value = "periodic")]
    pub boundary: BoundaryArgument,
    /// Seed of every draw: any 64-bit number
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub seed: u64,
    /// Shortest edge of a building block, in radii: any number of at least 6
    #[arg(long, value_name = "LEAF", default_value_t = 30.0)]
    pub leaf: f64,
    /// Side of the generated pattern, in radii
    #[arg(long, value_name = "SIDE", default_value_t = 100.0)]
    pub pattern_side: f64,
    /// How the generated pattern ends: a bounded one is the paper's, and blocks must fit it
    #[arg(long, value_enum, default_value = "periodic")]
    pub pattern_boundary: BoundaryArgument,
    /// Seed of the generated pattern
    #[arg(long, value_name = "S", default_value_t = 0)]
    pub pattern_seed: u64,
    /// Clip from this point set instead; it needs a certificate or --pattern-radius
    #[arg(
        long,
        value_name = "FILE",
        conflicts_with_all = ["pattern_side", "pattern_seed", "pattern_boundary"]
    )]
    pub pattern: Option<PathBuf>,
    /// Radius of a pattern file without a certificate; its domain is then the unit square
    #[arg(long, value_name = "R", requires = "pattern")]
    pub pattern_radius: Option<f64>,
    /// Clip from the pattern's 8 rotations and mirror images
    #[arg(long)]
    pub dihedral: bool,
    /// Order of elimination
    #[arg(long, value_enum, default_value = "own-block-first")]
    pub order: OrderArgument,
    /// How gaps are filled
    #[arg(long, value_enum, default_value = "circumcentre")]
    pub insertion: InsertionArgument,
    /// How far gap detectors look, in radii: 4 is proven, 2 is an experiment that leaves gaps
    #[arg(long, value_name = "4|2", default_value = "4", value_parser = ["4", "2"])]
    pub search: String,
    /// Staged, or Algorithm 4 as printed
    #[arg(long, value_enum, default_value = "staged")]
    pub variant: VariantArgument,
}

/// An order of elimination.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum OrderArgument {
    /// Block by block, row by row
    Index,
    /// A random rank for each sample
    Random,
    /// Samples inside their own block before margin samples
    OwnBlockFirst,
    /// Four groups of far-apart cells in turn
    PhaseGroup,
}

/// A way to fill gaps.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum InsertionArgument {
    /// At uncovered circumcentres
    Circumcentre,
    /// Uniformly within the gap
    Uniform,
}

/// An arrangement of Algorithm 4.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub enum VariantArgument {
    /// Elimination first, then insertion
    Staged,
    /// Interleaved
    AsPrinted,
}

impl RunArguments {
    /// Returns the parameters; with `--count` the radius is still 0.
    pub fn parameters(&self) -> Parameters {
        Parameters {
            width: self.width,
            height: self.height,
            radius: self.radius.unwrap_or(0.0),
            boundary: self.boundary.into(),
            seed: self.seed,
            leaf: self.leaf,
            pattern: PatternSpec {
                side: self.pattern_side,
                boundary: self.pattern_boundary.into(),
                seed: self.pattern_seed,
            },
            dihedral: self.dihedral,
            order: match self.order {
                OrderArgument::Index => Order::Index,
                OrderArgument::Random => Order::Random,
                OrderArgument::OwnBlockFirst => Order::OwnBlockFirst,
                OrderArgument::PhaseGroup => Order::PhaseGroup,
            },
            insertion: match self.insertion {
                InsertionArgument::Circumcentre => Insertion::Circumcentre,
                InsertionArgument::Uniform => Insertion::Uniform,
            },
            search: if self.search == "2" {
                Search::TwoRadii
            } else {
                Search::Complete
            },
            variant: match self.variant {
                VariantArgument::Staged => Variant::Staged,
                VariantArgument::AsPrinted => Variant::AsPrinted,
            },
        }
    }

    /// Returns the pattern: from its file, kept or generated.
    pub fn pattern(&self, observer: &mut dyn Observer) -> Result<Arc<Pattern>> {
        match &self.pattern {
            Some(path) => self
                .pattern_from_file(path)
                .map(Arc::new)
                .with_context(|| path.display().to_string()),
            None => Ok(Pattern::of_spec(&self.parameters().pattern, observer)?),
        }
    }

    fn pattern_from_file(&self, path: &Path) -> Result<Pattern> {
        let (radius, wanted) = (self.pattern_radius, "--pattern-radius");
        let stated = |region: Option<Region>| region.unwrap_or(UNIT_SQUARE);
        Ok(set_of_file(path, radius, wanted, stated)?.pattern)
    }
}

/// A checked set with the domain that it is a set of.
pub struct FileSet {
    pub pattern: Pattern,
    pub domain: Domain,
}

/// Returns the set in a file, conflict-free and maximal. The region is what `region` makes of its certificate's; the radius
/// is `radius`, or its certificate's, or an error that asks for `wanted`.
pub fn set_of_file(
    path: &Path,
    radius: Option<f64>,
    wanted: &str,
    region: impl FnOnce(Option<Region>) -> Region,
) -> Result<FileSet> {
    let read = tilescope_formats::read(path, &Hint::default())?;
    let stated = read.certificate.as_ref();
    let Some(radius) = radius.or(stated.map(|stated| stated.radius)) else {
        bail!("the set has no certificate; give {wanted}");
    };
    let region = region(stated.map(|stated| stated.region));
    let boundary = match region.boundary {
        tilescope_analysis::Boundary::Periodic => tilescope_core::Boundary::Periodic,
        tilescope_analysis::Boundary::Bounded => tilescope_core::Boundary::Bounded,
    };
    let size = [region.width, region.height];
    Ok(FileSet {
        pattern: Pattern::from_positions(&read.set.points, size, radius, boundary)?,
        domain: Domain::from_size(size, radius, boundary)?,
    })
}
