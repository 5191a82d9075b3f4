//! `tilescope curve`: numbers of a run at every change of its samples, as a table.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, Result, ensure};
use clap::Args;
use tilescope_analysis::measures::SetNumber;
use tilescope_core::memory::Making;
use tilescope_core::{Domain, Parameter, Pattern, SolidDomain, SolidRequest};
use tilescope_debugger::{Debugger, PatternFile, Recording, Session};
use tilescope_formats::{read_whole, write_whole};
use tilescope_live::{
    Course, Curve, CurveMaker, FRAME_STEPS, Setting, is_of_spectrum, live_numbers,
    numbers_named_in, space_numbers,
};
use tilescope_sets::GivenDomain;

use crate::ground::{CoordinateArguments, GroundArguments};
use crate::make::ask_for_whole;
use crate::nested::{NEEDS_KDRT, ask_for_levels};
use crate::parameters::{RunArguments, set_of_file};
use crate::paths::{InFile, check_file, check_inputs_stay, named};
use crate::progress::{Stopwatch, bar};
use crate::sample_arguments::{NestedArguments, SamplingMethod};
use crate::solid::make::{USED, refuse_other_parameters};
use crate::solid::refuse;
use crate::space::SpaceArguments;
use crate::varying::{VaryingArguments, recipe};
use crate::{EXIT_FINE, interrupt, output};

/// Arguments of `tilescope curve`.
#[derive(Debug, Args)]
#[command(after_help = examples(), allow_negative_numbers = true)]
pub struct CurveArguments {
    #[command(flatten)]
    run: RunArguments,
    #[command(flatten)]
    nested: NestedArguments,
    #[command(flatten)]
    ground: GroundArguments,
    #[command(flatten)]
    coordinates: CoordinateArguments,
    #[command(flatten)]
    space: SpaceArguments,
    /// The lower corner of the domain of a field or a shape, in the coordinates of polygons and expressions
    #[arg(long, num_args = 2, value_names = ["X", "Y"])]
    origin: Option<Vec<f64>>,
    /// KDRT, exact tiling, or the reference sampler, which uses only radius or count, sides, boundary and seed; if not given,
    /// KDRT, and for a set in space, a shape or a radius that varies the reference sampler
    #[arg(long, value_enum)]
    method: Option<SamplingMethod>,
    /// The run of a saved session instead of one that the arguments describe
    #[arg(long, value_name = "FILE", group = "size", conflicts_with_all = options_of_runs())]
    session: Option<PathBuf>,
    /// The numbers, separated by commas; if not given, all that need no spectrum
    #[arg(long, value_name = "KEYS", value_delimiter = ',')]
    numbers: Vec<String>,
    /// At so many moments, evenly spread among the changes; if not given, at every change, and at 1000 moments if a number
    /// needs the spectrum
    #[arg(long, value_name = "K")]
    moments: Option<usize>,
    /// Save the table as CSV instead of printing it
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
}

/// Returns the text at the end of the help, with the numbers that a curve may have.
fn examples() -> String {
    let keys = |numbers: &mut dyn Iterator<Item = &'static SetNumber>| -> String {
        let each: Vec<&str> = numbers.map(|number| number.key).collect();
        each.join(", ")
    };
    // Those of the spectrum take far longer to make, and have fewer moments.
    let planar = |needs_spectrum| {
        keys(&mut live_numbers().filter(|number| is_of_spectrum(number) == needs_spectrum))
    };
    let [quick, of_spectrum] = [false, true].map(planar);
    let in_field = keys(&mut Setting::Field.numbers());
    let in_space = keys(&mut space_numbers());
    format!(
        "\
Each row is a moment: how many events have happened, the stage, and the numbers of the samples that are
there: tiled or inserted, and not eliminated. Events are counted as in the window. A number that is not
defined, as the smallest distance of no samples, is an empty cell.

Numbers, as `tilescope analyze` has them: {quick}.
Those that need the spectrum: {of_spectrum}.
In a shape all but covering_radius_r, by the area inside; where the radius varies: {in_field}.
Those of sets in space, by distances in space: {in_space}.

Examples:
  tilescope curve --radius 0.01 --numbers conflicts,gaps,min_distance_r --out run.csv
  tilescope curve --count 5000 --variant as-printed --numbers samples,gaps
  tilescope curve --count 2000 --method reference --numbers density,low_power --moments 200
  tilescope curve --shape park.geojson --radius 2 --numbers density,gaps --out park.csv
  tilescope curve --radius-expression '0.006 + 0.024*x' --numbers samples,conflicts,gaps
  tilescope curve --size 10x10x10 --radius 1 --numbers samples,density,active_cubes
  tilescope curve --session lecture.json --out lecture.csv"
    )
}

/// Returns the options that describe a run, which a saved session does, too.
fn options_of_runs() -> Vec<&'static str> {
    let parameters = Parameter::all().map(Parameter::key);
    parameters
        .chain([
            "count",
            "pattern",
            "pattern-radius",
            "levels",
            "exactly",
            "depth",
            "sides",
            "radius_image",
            "density_image",
            "radius_expression",
            "shape",
            "mask",
            "origin",
        ])
        .collect()
}

/// Computes the numbers of a run over its events, and prints or writes the table.
pub fn run(arguments: &CurveArguments) -> Result<u8> {
    interrupt::listen();
    if let Some(path) = &arguments.out {
        // A table in the place of an input would destroy it.
        let inputs = [&arguments.session, &arguments.run.pattern];
        let given = inputs.into_iter().flatten().map(PathBuf::as_path);
        check_inputs_stay(path, given.chain(arguments.ground.files()))?;
        check_file(path).context("--out")?;
    }
    // A misspelt number is refused before the run is made. Whether a saved session is of a set in space, its file says.
    if arguments.session.is_none() {
        numbers_of(arguments, asked_setting(arguments))?;
    }

    let followed = course(arguments)?;
    let numbers = numbers_of(arguments, followed.setting())?;
    // More samples than a spectrum can follow are refused here, before the first number is computed.
    let maker = CurveMaker::new(Arc::new(followed), &numbers, arguments.moments)?;
    let table = made(maker)?.csv();
    match &arguments.out {
        Some(path) => write_whole(path, table.as_bytes())?,
        None => output::emit(&table)?,
    }
    Ok(EXIT_FINE)
}

/// Returns what the samples of the run lie in that the arguments describe. An image, too, counts as a radius that varies.
fn asked_setting(arguments: &CurveArguments) -> Setting {
    let ground = &arguments.ground;
    if ground.is_given() {
        let has_one_radius = ground.field_option().is_none();
        return Setting::of_ground(has_one_radius);
    }
    Setting::of_box(arguments.space.is_given())
}

/// Returns the numbers that the arguments ask for, of a run whose samples lie in `setting`.
fn numbers_of(arguments: &CurveArguments, setting: Setting) -> Result<Vec<&'static SetNumber>> {
    let keys = &arguments.numbers;
    if keys.is_empty() {
        // Without a choice all numbers but those that need a spectrum at every row, which takes far longer.
        let quick = setting.numbers().filter(|number| !is_of_spectrum(number));
        return Ok(quick.collect());
    }
    numbers_named_in(keys, setting).context("--numbers")
}

/// Makes a curve with a bar; stops on Ctrl-C.
fn made(mut maker: CurveMaker) -> Result<Curve> {
    /// The steps between two looks at the bar: those of 25 frames, about a tenth of a second.
    const SLICE: u64 = 25 * FRAME_STEPS;

    let [_, all_moments] = maker.progress();
    let bar = bar("curve", all_moments as u64);
    while !maker.proceed(SLICE)? {
        let [made_moments, _] = maker.progress();
        bar.set_position(made_moments as u64);
        interrupt::check("the curve was made")?;
    }
    Ok(maker.finish())
}

/// Makes the run and returns its course.
fn course(arguments: &CurveArguments) -> Result<Course> {
    let mut watch = Stopwatch::start();
    if let Some(path) = &arguments.session {
        let recording = of_session(path, &mut watch).in_file(path)?;
        return Ok(Course::of_recording(&recording));
    }

    if arguments.ground.is_given() {
        if arguments.space.is_given() {
            let option = arguments.space.option();
            let whose = format!("{option} makes a set in space, which has neither field nor shape");
            arguments.ground.refuse(&whose)?;
        }
        return course_in_ground(arguments, &mut watch);
    }
    ensure!(
        arguments.origin.is_none(),
        "--origin: numbers of a run do not depend on where its rectangle lies; leave it out"
    );
    if arguments.space.is_given() {
        return course_in_space(arguments, &mut watch);
    }

    let method = arguments.method.unwrap_or(SamplingMethod::Kdrt);
    let mut recipe = arguments.run.recipe()?;
    if let Some(nested) = arguments.nested.request()? {
        // Nested levels are defined for randomized tiling alone. How many samples there may be is checked only where the
        // course is made, since `--exactly` replaces the radius.
        ensure!(method == SamplingMethod::Kdrt, "{NEEDS_KDRT}");
        ask_for_levels(&nested, &recipe.parameters)?;
        return Ok(Course::of_levels(&recipe, &nested, &mut watch)?);
    }

    // Checked before the radius of a count is searched for, and before memory is asked for.
    Course::check(&recipe.parameters)?;
    match method {
        SamplingMethod::Kdrt => {
            // The course keeps all samples in memory, which limits how many there may be.
            let in_memory = true;
            let run = arguments.run.settle(recipe, in_memory, &mut watch)?;
            ask_for_whole(Making::Sequential, &run.parameters)?;
            Ok(Course::of_run(&run, &mut watch)?)
        }
        // With a count the other methods have only an estimate of the radius, which is near enough to ask for memory.
        SamplingMethod::Reference => {
            ask_for_whole(Making::Reference, &recipe.parameters)?;
            Ok(Course::of_reference(&recipe, &mut watch)?)
        }
        SamplingMethod::Exact => {
            let samples = arguments.run.expected(&recipe.parameters)?;
            recipe.parameters.pattern = arguments.run.exact_pattern_for(samples)?;
            ask_for_whole(Making::Exact, &recipe.parameters)?;
            Ok(Course::of_exact(&recipe, &mut watch)?)
        }
    }
}

/// Makes the run of a set in a field or a shape, and returns its course.
fn course_in_ground(arguments: &CurveArguments, watch: &mut Stopwatch) -> Result<Course> {
    let asked = VaryingArguments {
        run: &arguments.run,
        nested: &arguments.nested,
        ground: &arguments.ground,
        coordinates: &arguments.coordinates,
        origin: arguments.origin.as_ref(),
        method: arguments.method,
    };
    let recipe = recipe(&asked)?;
    let exactly = ("--exactly", arguments.nested.exactly.is_some());
    refuse(
        &[exactly],
        "moments of a field or a shape are those of a whole set",
    )?;
    Ok(Course::of_ground(&recipe, watch)?)
}

/// Makes the run of a set in space, and returns its course.
fn course_in_space(arguments: &CurveArguments, watch: &mut Stopwatch) -> Result<Course> {
    let (option, nested) = (arguments.space.option(), &arguments.nested);
    refuse_other_parameters(arguments.method, &arguments.run.typed, option, &USED)?;
    let why = format!("{option} makes a whole set in space, by the reference sampler");
    let given = [
        ("--levels", nested.levels.is_some()),
        ("--exactly", nested.exactly.is_some()),
        ("--pattern", arguments.run.pattern.is_some()),
    ];
    refuse(&given, &why)?;

    let asked = &arguments.run.asked;
    let size = (arguments.space)
        .size([asked.width, asked.height])
        .context("a set in space has three sides")?;
    let (boundary, seed) = (asked.boundary, asked.seed);
    let domain = match arguments.run.count {
        Some(count) => {
            let request = SolidRequest {
                size,
                boundary,
                seed,
            };
            // An estimate is near enough to refuse a number before sets are made in search of the radius.
            let estimate = request.radius_estimate(count)?;
            Course::check_space(&SolidDomain::from_size(size, estimate, boundary)?)?;
            request.of_count(count, watch)?.domain
        }
        None => SolidDomain::from_size(size, asked.radius, boundary)?,
    };
    Ok(Course::of_space(domain, seed, watch)?)
}

/// Makes the run of a saved session, and checks that it is the same run.
fn of_session(path: &Path, watch: &mut Stopwatch) -> Result<Arc<Recording>> {
    let text = String::from_utf8(read_whole(path)?).context("this is not a saved session")?;
    let session = Session::from_json(&text)?;
    let mut load = |file: &PatternFile| pattern_beside(path, file).map_err(|e| format!("{e:#}"));
    let recording = Arc::new(match session.depth {
        Some(depth) => recording_in_space(&session, depth, watch)?,
        None => session.record(&mut load, watch)?,
    });
    // The debugger compares the run with the digest in the session; what it would show is not needed.
    Debugger::resume(&session, Arc::clone(&recording))?;
    Ok(recording)
}

/// Makes the run of a saved session of a set in space, which has a depth.
fn recording_in_space(session: &Session, depth: f64, watch: &mut Stopwatch) -> Result<Recording> {
    let parameters = &session.parameters;
    let (radius, boundary) = (parameters.radius, parameters.boundary);
    let [width, height] = [parameters.width, parameters.height];
    let domain = SolidDomain::from_size([width, height, depth], radius, boundary)?;
    // The session limits the samples of the base of the box alone.
    Course::check_space(&domain)?;
    // The projections of the samples lie in this domain.
    let planar = Domain::from_size([width, height], radius, boundary)?;
    let budget = session.budget;
    Ok(Recording::in_space(
        domain, planar, parameters, budget, watch,
    )?)
}

/// Reads the pattern of a saved session from the session's folder. A session from others names no other place to read from.
fn pattern_beside(session: &Path, file: &PatternFile) -> Result<Pattern> {
    let name = Path::new(&file.path).file_name();
    let path = session.with_file_name(name.unwrap_or_default());
    ensure!(
        path.is_file(),
        "there is no {}; put the pattern beside the session",
        named(&path)
    );
    let set = set_of_file(&path, &GivenDomain::default(), "it beside the pattern")?;
    Ok(Arc::unwrap_or_clone(set.pattern))
}

#[cfg(test)]
mod tests;
