//! Arguments that determine a run, and the run that they resolve to, with its radius, pattern and engine.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Result, bail};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{ArgGroup, Args};
use serde_json::Value;
use tilescope_analysis::Region;
use tilescope_core::combine::file::Set;
use tilescope_core::{
    Boundary, Domain, Insertion, MAXIMAL_DENSITY, Order, Parameters, Pattern, PatternSpec, Search,
    Variant, radius_estimate, radius_for_count,
};
use tilescope_formats::Hint;
use tilescope_gpu::Backend;

use crate::facts::{Facts, named_by_content};
use crate::options::{BOUNDARIES, Names, named};
use crate::paths::InFile;
use crate::progress::Stopwatch;

/// Arguments that determine a run.
#[derive(Debug, Args)]
#[command(group = ArgGroup::new("size").args(["radius", "count"]).required(true))]
pub struct RunArguments {
    /// Poisson-disk radius, in user units
    #[arg(long, value_name = "R")]
    pub radius: Option<f64>,
    /// Choose the radius so that N samples result, to within 1%
    #[arg(long, value_name = "N")]
    pub count: Option<u64>,
    /// Width of the domain
    #[arg(long, value_name = "W", default_value_t = 1.0)]
    pub width: f64,
    /// Height of the domain
    #[arg(long, value_name = "H", default_value_t = 1.0)]
    pub height: f64,
    /// How the domain ends
    #[arg(long, value_parser = named::<Boundary>(&BOUNDARIES), default_value = "periodic")]
    pub boundary: Boundary,
    /// Seed of every draw: any 64-bit number
    #[arg(long, value_name = "S", default_value_t = 1)]
    pub seed: u64,
    /// Shortest edge of a building block, in radii: any number of at least 6
    #[arg(long, value_name = "LEAF", default_value_t = 30.0)]
    pub leaf: f64,
    /// Side of the generated pattern, in radii
    #[arg(long, value_name = "SIDE", default_value_t = 100.0)]
    pub pattern_side: f64,
    /// How the generated pattern ends: a bounded one is the paper's, and must be larger than every block
    #[arg(long, value_parser = named::<Boundary>(&BOUNDARIES), default_value = "periodic")]
    pub pattern_boundary: Boundary,
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
    #[arg(long, value_parser = named::<Order>(&ORDERS), default_value = "own-block-first")]
    pub order: Order,
    /// How gaps are filled
    #[arg(long, value_parser = named::<Insertion>(&INSERTIONS), default_value = "circumcentre")]
    pub insertion: Insertion,
    /// How far gap detectors search, in radii: 4 is proven, 2 is an experiment that leaves gaps
    #[arg(long, value_name = "4|2", default_value = "4", value_parser = searches())]
    pub search: Search,
    /// Staged, or Algorithm 4 as printed
    #[arg(long, value_parser = named::<Variant>(&VARIANTS), default_value = "staged")]
    pub variant: Variant,
}

const ORDERS: Names<4> = [
    ("index", "Block by block, row by row"),
    ("random", "A random rank for each sample"),
    (
        "own-block-first",
        "Samples inside their own block before margin samples",
    ),
    ("phase-group", "Four groups of far-apart cells in turn"),
];
const INSERTIONS: Names<2> = [
    ("circumcentre", "At uncovered circumcentres"),
    ("uniform", "Uniformly within the gap"),
];
const VARIANTS: Names<2> = [
    ("staged", "Elimination first, then insertion"),
    ("as-printed", "Interleaved"),
];

fn searches() -> impl TypedValueParser<Value = Search> {
    PossibleValuesParser::new(["4", "2"]).map(|radii| match radii.as_str() {
        "2" => Search::TwoRadii,
        _ => Search::Complete,
    })
}

/// A run with its radius, pattern and engine, ready to be computed.
pub struct Resolved {
    pub parameters: Parameters,
    pub domain: Domain,
    pub pattern: Arc<Pattern>,
    pub backend: Backend,
    /// The pattern's file, as certificates name it.
    pattern_file: Option<Value>,
}

impl Resolved {
    /// Returns the facts about the run before it is made.
    pub fn facts(&self) -> Result<Facts> {
        let mut facts = Facts::of_run(&self.parameters, &self.domain)?;
        if let Some(file) = &self.pattern_file {
            facts.parameters.insert("pattern".into(), file.clone());
        }
        Ok(facts)
    }
}

impl RunArguments {
    /// Returns the parameters; with `--count` the radius is an estimate.
    pub fn parameters(&self) -> Result<Parameters> {
        let mut parameters = Parameters {
            width: self.width,
            height: self.height,
            radius: self.radius.unwrap_or_default(),
            boundary: self.boundary,
            seed: self.seed,
            leaf: self.leaf,
            pattern: PatternSpec {
                side: self.pattern_side,
                boundary: self.pattern_boundary,
                seed: self.pattern_seed,
            },
            dihedral: self.dihedral,
            order: self.order,
            insertion: self.insertion,
            search: self.search,
            variant: self.variant,
        };
        if let Some(count) = self.count {
            parameters.radius = radius_estimate(&parameters, count)?;
        }
        Ok(parameters)
    }

    /// Returns the expected number of samples.
    pub fn expected(&self, parameters: &Parameters) -> Result<f64> {
        Ok(match self.count {
            Some(count) => count as f64,
            None => parameters.validate()?.area_radii() * MAXIMAL_DENSITY,
        })
    }

    /// Returns the run. If its set stays `in_memory`, its size is limited.
    pub fn resolve(
        &self,
        mut parameters: Parameters,
        backend: Backend,
        in_memory: bool,
        watch: &mut Stopwatch,
    ) -> Result<Resolved> {
        if in_memory && self.count.is_none() {
            parameters.validate_sequential()?;
        }
        let (pattern, pattern_file) = match &self.pattern {
            Some(path) => {
                let radius = (self.pattern_radius, "--pattern-radius");
                let set = set_of_file(path, radius, [None; 2], None).in_file(path)?;
                (set.pattern, Some(named_by_content(path)?))
            }
            None => (Pattern::of_spec(&parameters.pattern, watch)?, None),
        };
        if let Some(count) = self.count {
            parameters.radius = radius_for_count(&parameters, count, &pattern, watch)?;
            watch.drop_tries();
        }
        let domain = if in_memory {
            parameters.validate_sequential()?
        } else {
            parameters.validate()?
        };
        Ok(Resolved {
            parameters,
            domain,
            pattern,
            backend,
            pattern_file,
        })
    }
}

/// Returns the set in a file; fails unless it is conflict-free and maximal. What is not given is the certificate's, or that
/// of the periodic unit square. If no radius is known, the error asks for `wanted`.
pub fn set_of_file(
    path: &Path,
    (radius, wanted): (Option<f64>, &str),
    size: [Option<f64>; 2],
    boundary: Option<Boundary>,
) -> Result<Set> {
    let read = tilescope_formats::read(path, &Hint::default())?;
    let stated = read.certificate.as_ref();
    let Some(radius) = radius.or(stated.map(|stated| stated.radius)) else {
        bail!("the set has no certificate; give {wanted}");
    };
    let region = stated.map_or(Region::UNIT_SQUARE, |stated| stated.region);
    let size = [0, 1].map(|axis| size[axis].unwrap_or(region.size()[axis]));
    let boundary = boundary.unwrap_or(Boundary::of(region.is_periodic()));
    let points = &read.set.points;
    Ok(Set::from_positions(points, size, radius, boundary)?)
}
