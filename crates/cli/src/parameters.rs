//! Arguments that determine a run, and the run that they settle, with its radius and pattern.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use anyhow::{Context, Result, bail, ensure};
use clap::error::ErrorKind;
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgGroup, ArgMatches, Args, Command, FromArgMatches, value_parser};
use serde_json::json;
use tilescope_core::combine::file::Set;
use tilescope_core::{
    MAXIMAL_DENSITY, NOT_OF_EXACT, Parameter, ParameterKind, Parameters, PatternSpec, Progress,
    radius_estimate,
};
use tilescope_formats::Hint;
use tilescope_sets::{
    GivenDomain, GivenPattern, KnownDomain, Recipe, Settled, StatedSet, exact_pattern,
    named_by_content,
};

use crate::interrupt;
use crate::options::words;
use crate::paths::InFile;
use crate::progress::Stopwatch;
use crate::radius_span::{RadiusSpan, TWO_RADII};

/// Arguments that determine a run.
#[derive(Debug)]
pub struct RunArguments {
    /// The parameters; the radius is 0 if a count is given in its place.
    pub asked: Parameters,
    pub count: Option<u64>,
    /// The second of two radii.
    pub greatest: Option<f64>,
    pub pattern: Option<PathBuf>,
    pattern_radius: Option<f64>,
    /// The parameters that were typed, by their options.
    pub typed: Vec<Parameter>,
}

/// The options that say how large the samples' disks are. One of them must be given, or one that a command adds to
/// their group, such as the formula of `--radius-expression`.
const SIZE: [&str; 2] = ["radius", "count"];

impl Args for RunArguments {
    fn augment_args(command: Command) -> Command {
        // Both options of the size may be given: with an image, --count scales the two radii of --radius, and so does --exactly.
        let size = ArgGroup::new("size")
            .args(SIZE)
            .required(true)
            .multiple(true);
        // `--help` lists options in this order: the size first, as it must be given, and a pattern's file behind the options
        // of a generated pattern.
        let mut command = command
            .group(size)
            .arg(option(Parameter::Radius))
            .arg(count());
        for parameter in options().filter(|it| *it != Parameter::Radius) {
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
        // The radius stays 0 where a count or a formula is given in its place.
        let span: Option<&RadiusSpan> = matches.get_one(Parameter::Radius.key());
        let span = span.copied().unwrap_or_default();
        let mut asked = Parameters {
            radius: span.least,
            ..Parameters::default()
        };
        let count = matches.get_one("count").copied();
        refuse_sizes(matches, span.greatest, count.is_some())?;

        // The radius is read above, as its option may hold two numbers.
        for parameter in options().filter(|it| *it != Parameter::Radius) {
            let taken = take(&mut asked, parameter, matches);
            taken.map_err(|error| clap::Error::raw(ErrorKind::InvalidValue, error))?;
        }

        // Every option but the radius has a value by default: only a typed one can be refused by a method that has no
        // use for it.
        let is_typed = |parameter: &Parameter| {
            matches.value_source(parameter.key()) == Some(ValueSource::CommandLine)
        };
        Ok(Self {
            asked,
            typed: options().filter(is_typed).collect(),
            count,
            greatest: span.greatest,
            pattern: matches.get_one("pattern").cloned(),
            pattern_radius: matches.get_one("pattern-radius").copied(),
        })
    }

    fn update_from_arg_matches(&mut self, matches: &ArgMatches) -> Result<(), clap::Error> {
        *self = Self::from_arg_matches(matches)?;
        Ok(())
    }
}

/// Refuses two radii without an image to go with, a radius beside a number of samples without an image, and a radius beside
/// an expression.
fn refuse_sizes(
    matches: &ArgMatches,
    greatest: Option<f64>,
    has_count: bool,
) -> Result<(), clap::Error> {
    // Commands without images have no argument of this id, which means that it is not given.
    let is_given = |id: &str| matches.try_get_raw(id).is_ok_and(|values| values.is_some());
    let has_image = is_given("radius_image");
    // --exactly scales radii as --count does.
    let has_exactly = is_given("exactly");

    // The conflicts of clap have no exceptions, and with an image a radius and a number of samples go together: they are
    // refused here, in the words of clap.
    let why = if greatest.is_some() && !has_image {
        &format!("{TWO_RADII}\n")
    } else if has_count && is_given("radius") && !has_image {
        "the argument '--radius <R>' cannot be used with '--count <N>'\n"
    } else if has_exactly && is_given("radius") && !has_image {
        "the argument '--radius <R>' cannot be used with '--exactly <N>'\n"
    } else if is_given("radius") && is_given("radius_expression") {
        "the argument '--radius <R>' cannot be used with '--radius-expression <FORMULA>'\n"
    } else {
        return Ok(());
    };
    Err(clap::Error::raw(ErrorKind::ArgumentConflict, why))
}

/// Returns the parameters that are options. The method is an option of the commands that have one, with the reference
/// sampler among its values.
fn options() -> impl Iterator<Item = Parameter> {
    Parameter::all().filter(|parameter| *parameter != Parameter::Method)
}

/// Returns the option of a parameter, with the default that the core has.
fn option(parameter: Parameter) -> Arg {
    let row = parameter.row();
    let help = if NOT_OF_EXACT.contains(&parameter) {
        format!("{}; of KDRT alone", row.help)
    } else {
        row.help.to_owned()
    };
    let bare = Arg::new(row.key).long(row.key).help(&help);
    let with_parser = match row.kind {
        ParameterKind::Real { .. } if parameter == Parameter::Radius => {
            bare.value_parser(RadiusSpan::parse)
        }
        ParameterKind::Real { .. } => bare.value_parser(value_parser!(f64)),
        ParameterKind::Whole(_) => bare.value_parser(value_parser!(u64)),
        ParameterKind::Choice { options, .. } => bare.value_parser(words(options)),
        // A switch has no value: it is on where it stands, and off by default.
        ParameterKind::Switch { .. } => return bare.action(ArgAction::SetTrue),
    };

    let arg = with_parser.value_name(row.value_name);
    // The radius has no default, as it, a count or a formula must be given.
    if parameter == Parameter::Radius {
        return arg;
    }
    let with_default = arg.default_value(DEFAULTS[&parameter].as_str());

    // The pattern of exact tiling has other defaults, which clap would not show.
    let Some(of_exact) = default_of_exact(parameter) else {
        return with_default;
    };
    let default = &DEFAULTS[&parameter];
    let with_both = format!("{help} [default: {default}; of exact tiling {of_exact}]");
    with_default.help(with_both).hide_default_value(true)
}

/// Returns what exact tiling takes if an option is not given, where that is not what KDRT takes
/// ([`PatternSpec::for_exact`](tilescope_core::PatternSpec::for_exact)).
fn default_of_exact(parameter: Parameter) -> Option<&'static str> {
    match parameter {
        Parameter::PatternSide => Some("200, above 28,000 samples 400"),
        Parameter::PatternSeed => Some("the seed of the set"),
        _ => None,
    }
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
        .help("Clip from this point set instead; it needs a certificate or --pattern-radius. In 'sample', exact tiling takes a set by --method reference in a periodic square, whose darts are thrown again from the certificate's seed")
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

/// Sets a parameter to what its option says. Without a value it stays, and a switch is off.
fn take(parameters: &mut Parameters, parameter: Parameter, matches: &ArgMatches) -> Result<()> {
    let key = parameter.key();
    match &parameter.row().kind {
        ParameterKind::Real { place, .. } => {
            let value = place(parameters);
            *value = matches.get_one(key).copied().unwrap_or(*value);
        }
        ParameterKind::Whole(place) => {
            let value = place(parameters);
            *value = matches.get_one(key).copied().unwrap_or(*value);
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

impl RunArguments {
    /// Returns what the set is made from, but for a pattern from a file; with `--count` the radius is an estimate.
    pub fn recipe(&self) -> Result<Recipe> {
        let mut parameters = self.asked;
        if let Some(count) = self.count {
            parameters.radius = radius_estimate(&parameters, count)?;
        }

        Ok(Recipe {
            count: self.count,
            ..Recipe::from(parameters)
        })
    }

    /// Returns a recipe for exact tiling: the pattern has the defaults of that method, or is read from a file and its darts
    /// are thrown again. Refuses by their names the options that exact tiling has no use for.
    pub fn exact_recipe(&self, mut recipe: Recipe) -> Result<Recipe> {
        let samples = self.expected(&recipe.parameters)?;
        recipe.parameters.pattern = self.exact_spec(samples)?;
        if let Some(path) = &self.pattern {
            recipe.pattern = Some(self.reference_pattern(path).in_file(path)?);
        }
        Ok(recipe)
    }

    /// Reads a set by the reference sampler, and throws its darts again.
    fn reference_pattern(&self, path: &Path) -> Result<GivenPattern> {
        ensure!(
            self.pattern_radius.is_none(),
            "--pattern-radius is for a file without a certificate, and exact tiling needs one: it states the seed from which the darts of a set by the reference sampler are thrown again"
        );
        let read = tilescope_formats::read(path, &Hint::default())?;
        let certificate = read.certificate.as_ref().context(
            "the set has no certificate; exact tiling needs one, with the seed from which the darts of a set by the reference sampler are thrown again",
        )?;

        let set = StatedSet {
            method: &certificate.method,
            parameters: &certificate.parameters,
            known: KnownDomain::from(certificate),
            origin: certificate.origin.unwrap_or_default(),
            points: &read.set.points,
        };
        let source = json!(named_by_content(path)?);
        let go_on = &mut |_: Progress| interrupt::flow();
        Ok(GivenPattern::of_reference(&set, source, go_on)?)
    }

    /// Returns the pattern of an exact tiling of about so many samples that is recorded, or covers a shape. Refuses by their
    /// names the options that it has no use for, and a pattern from a file.
    pub fn exact_pattern_for(&self, samples: f64) -> Result<PatternSpec> {
        ensure!(
            self.pattern.is_none(),
            "--pattern needs `sample` of a rectangle: exact tiling of a shape, and `curve`, make their patterns; leave it out, or choose --pattern-side and --pattern-seed"
        );
        self.exact_spec(samples)
    }

    /// Returns the pattern of exact tiling for about so many samples, and refuses by their names the options that it has no use
    /// for.
    fn exact_spec(&self, samples: f64) -> Result<PatternSpec> {
        let unused = |parameter: &&Parameter| NOT_OF_EXACT.contains(parameter);
        if let Some(parameter) = self.typed.iter().find(unused) {
            bail!(
                "--{} is for KDRT: exact tiling keeps whatever arrived first; leave it out",
                parameter.key()
            );
        }
        Ok(exact_pattern(&self.asked, &self.typed, samples))
    }

    /// Returns the expected number of samples.
    pub fn expected(&self, parameters: &Parameters) -> Result<f64> {
        Ok(match self.count {
            Some(count) => count as f64,
            None => parameters.validate()?.area_radii() * MAXIMAL_DENSITY,
        })
    }

    /// Returns the run of a recipe. If its set stays `in_memory`, it may have at most as many samples as a set by the
    /// sequential engine, whichever engine makes it.
    pub fn settle(
        &self,
        mut recipe: Recipe,
        in_memory: bool,
        watch: &mut Stopwatch,
    ) -> Result<Settled> {
        // Without a count the size of the set is known already. So it is checked before the pattern is read or made,
        // which may take long.
        if in_memory && recipe.count.is_none() {
            recipe.parameters.validate_sequential()?;
        }
        if let Some(path) = &self.pattern {
            let given = GivenDomain {
                radius: self.pattern_radius,
                ..GivenDomain::default()
            };
            let set = set_of_file(path, &given, "--pattern-radius").in_file(path)?;
            recipe.pattern = Some(GivenPattern {
                pattern: set.pattern,
                source: json!(named_by_content(path)?),
                // Only exact tiling asks when samples arrived.
                arrivals: None,
            });
        }

        let run = recipe.settle(watch)?;
        // The tries that find a count's radius are not part of the time that the set takes.
        if recipe.count.is_some() {
            watch.drop_tries();
        }
        // With a count the radius is known only now, so that the size of the set was not checked above.
        if in_memory {
            run.parameters.validate_sequential()?;
        }
        Ok(run)
    }
}

/// Returns the set in a file; fails unless it is conflict-free and maximal. Sides, boundary and radius that are not given
/// are the certificate's; without one the domain is the periodic unit square. If no radius is known, the error asks for
/// `wanted`.
pub fn set_of_file(path: &Path, given: &GivenDomain, wanted: &str) -> Result<Set> {
    let read = tilescope_formats::read(path, &Hint::default())?;
    let stated = read.certificate.as_ref().map(Into::into);
    let Some(known) = given.over(stated) else {
        bail!("the set has no certificate; give {wanted}");
    };
    Ok(known.set(&read.set.points)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn defaults_of_the_pattern_are_named_for_both_methods() {
        let help = |parameter: Parameter| option(parameter).get_help().expect("help").to_string();
        let parts = [
            "[default: 100; of exact tiling 200, above 28,000 samples 400]",
            "[default: 0; of exact tiling the seed of the set]",
        ];
        for (parameter, part) in [Parameter::PatternSide, Parameter::PatternSeed]
            .into_iter()
            .zip(parts)
        {
            assert!(help(parameter).ends_with(part), "{}", help(parameter));
            assert!(option(parameter).is_hide_default_value_set());
        }
        // Negative control: the leaf has one default, which clap shows.
        assert!(!help(Parameter::Leaf).contains("exact"));
        assert!(!option(Parameter::Leaf).is_hide_default_value_set());
        assert!(
            help(Parameter::Order).ends_with("of KDRT alone")
                && !help(Parameter::Leaf).contains("KDRT")
        );
        // What the help says is what the core takes.
        let sides = [28_000.0, 28_001.0].map(|samples| PatternSpec::for_exact(samples, 7));
        assert_eq!(
            sides.map(|spec| (spec.side.to_string(), spec.seed)),
            [("200".to_owned(), 7), ("400".to_owned(), 7)]
        );
    }
}
