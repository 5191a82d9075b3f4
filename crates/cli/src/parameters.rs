//! Arguments that determine a run, and the run that they resolve to, with its radius, pattern and engine.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock};

use anyhow::{Result, bail};
use clap::error::ErrorKind;
use clap::{Arg, ArgAction, ArgGroup, ArgMatches, Args, Command, FromArgMatches, value_parser};
use serde_json::Value;
use tilescope_analysis::Region;
use tilescope_core::combine::file::Set;
use tilescope_core::{
    Boundary, Domain, MAXIMAL_DENSITY, Parameter, ParameterKind, Parameters, Pattern,
    radius_estimate, radius_for_count,
};
use tilescope_formats::Hint;
use tilescope_gpu::Backend;

use crate::facts::{Facts, named_by_content};
use crate::options::words;
use crate::paths::InFile;
use crate::progress::Stopwatch;

/// Arguments that determine a run.
#[derive(Debug)]
pub struct RunArguments {
    /// The parameters; the radius is 0 if a count is given in its place.
    pub asked: Parameters,
    pub count: Option<u64>,
    pub pattern: Option<PathBuf>,
    pattern_radius: Option<f64>,
}

/// The options that say how large the samples' disks are: one of them must be given.
const SIZE: [&str; 2] = ["radius", "count"];

impl Args for RunArguments {
    fn augment_args(command: Command) -> Command {
        // In the order in which `--help` lists them: what must be given first, and what stands in for a generated pattern
        // behind the options of that.
        let size = ArgGroup::new("size").args(SIZE).required(true);
        let mut command = command
            .group(size)
            .arg(option(Parameter::Radius))
            .arg(count());
        for parameter in Parameter::all().filter(|it| *it != Parameter::Radius) {
            command = command.arg(option(parameter));
            if parameter == Parameter::PatternSeed {
                command = command.args(pattern_file());
            }
        }
        command
    }

    fn augment_args_for_update(command: Command) -> Command {
        Self::augment_args(command)
    }
}

impl FromArgMatches for RunArguments {
    fn from_arg_matches(matches: &ArgMatches) -> Result<Self, clap::Error> {
        let mut asked = Parameters {
            radius: 0.0,
            ..Parameters::default()
        };
        for parameter in Parameter::all() {
            let taken = take(&mut asked, parameter, matches);
            taken.map_err(|error| clap::Error::raw(ErrorKind::InvalidValue, error))?;
        }
        Ok(Self {
            asked,
            count: matches.get_one("count").copied(),
            pattern: matches.get_one("pattern").cloned(),
            pattern_radius: matches.get_one("pattern-radius").copied(),
        })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// Returns the option of a parameter, with the default that the core has.
fn option(parameter: Parameter) -> Arg {
    let row = parameter.row();
    let arg = Arg::new(row.key).long(row.key).help(row.help);
    let arg = match row.kind {
        ParameterKind::Real { .. } => arg.value_parser(value_parser!(f64)),
        ParameterKind::Whole(_) => arg.value_parser(value_parser!(u64)),
        ParameterKind::Choice { options, .. } => arg.value_parser(words(options)),
        ParameterKind::Switch { .. } => return arg.action(ArgAction::SetTrue),
    };

    let arg = arg.value_name(row.value_name);
    // The radius has no default, as it or a count must be given.
    if parameter == Parameter::Radius {
        return arg;
    }
    arg.default_value(DEFAULTS[&parameter].as_str())
}

/// The core's defaults as they are typed, which clap keeps as long as the program runs.
static DEFAULTS: LazyLock<BTreeMap<Parameter, String>> = LazyLock::new(|| {
    let defaults = Parameters::default();
    let typed = |parameter: Parameter| (parameter, parameter.text(&defaults));
    Parameter::all().map(typed).collect()
});

fn count() -> Arg {
    Arg::new("count")
        .long("count")
        .value_name("N")
        .help("Choose the radius so that N samples result, to within 1%")
        .value_parser(value_parser!(u64))
}

/// Returns the options of a pattern from a file.
fn pattern_file() -> [Arg; 2] {
    let file = Arg::new("pattern")
        .long("pattern")
        .value_name("FILE")
        .help("Clip from this point set instead; it needs a certificate or --pattern-radius")
        .value_parser(value_parser!(PathBuf))
        .conflicts_with_all(["pattern-side", "pattern-seed", "pattern-boundary"]);
    let radius = Arg::new("pattern-radius")
        .long("pattern-radius")
        .value_name("R")
        .help("Radius of a pattern file without a certificate; its domain is then the unit square")
        .value_parser(value_parser!(f64))
        .requires("pattern");
    [file, radius]
}

/// Sets a parameter to what its option says. A radius that is not given stays.
fn take(parameters: &mut Parameters, parameter: Parameter, matches: &ArgMatches) -> Result<()> {
    let key = parameter.key();
    match &parameter.row().kind {
        ParameterKind::Real { place, .. } => {
            let place = place(parameters);
            *place = matches.get_one(key).copied().unwrap_or(*place);
        }
        ParameterKind::Whole(place) => {
            let place = place(parameters);
            *place = matches.get_one(key).copied().unwrap_or(*place);
        }
        ParameterKind::Switch { place, .. } => *place(parameters) = matches.get_flag(key),
        ParameterKind::Choice { options, .. } => {
            let word: Option<&String> = matches.get_one(key);
            let mut options = options.iter();
            // The parser has refused all other words.
            if let Some(option) = options.find(|option| word.is_some_and(|it| it == option.word)) {
                parameter.set(parameters, parameter.value_of(option))?;
            }
        }
    }
    Ok(())
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
        let mut parameters = self.asked;
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
