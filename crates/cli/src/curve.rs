//! `tilescope curve`: numbers of a run at every change of its samples, as a table.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context, Result, ensure};
use clap::Args;
use tilescope_analysis::measures::SetNumber;
use tilescope_core::memory::Making;
use tilescope_core::{Parameter, Pattern, SolidDomain, SolidRequest};
use tilescope_debugger::{Debugger, PatternFile, Recording, Session};
use tilescope_formats::{read_whole, write_whole};
use tilescope_live::{
    Course, Curve, CurveMaker, FRAME_STEPS, is_of_spectrum, live_numbers, numbers_named,
    space_numbers, space_numbers_named,
};
use tilescope_sets::GivenDomain;

use crate::make::ask_for_whole;
use crate::nested::{NEEDS_KDRT, ask_for_levels};
use crate::parameters::{RunArguments, set_of_file};
use crate::paths::{InFile, check_file, check_inputs_stay, named};
use crate::progress::{Stopwatch, bar};
use crate::sample_arguments::{NestedArguments, SamplingMethod};
use crate::solid::make::{USED, refuse_other_parameters};
use crate::solid::refuse;
use crate::space::SpaceArguments;
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
    space: SpaceArguments,
    /// KDRT, exact tiling, or the reference sampler, which uses only radius or count, sides, boundary and seed; if not given,
    /// KDRT, and for a set in space the reference sampler
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
    let planar = |needs_spectrum| {
        keys(&mut live_numbers().filter(|number| is_of_spectrum(number) == needs_spectrum))
    };
    let [quick, of_spectrum] = [false, true].map(planar);
    let in_space = keys(&mut space_numbers());
    format!(
        "\
Each row is a moment: how many events have happened, the stage, and the numbers of the samples that are
there: tiled or inserted, and not eliminated. Events are counted as in the window. A number that is not
defined, as the smallest distance of no samples, is an empty cell.

Numbers, as `tilescope analyze` has them: {quick}.
Those that need the spectrum: {of_spectrum}.
Those of sets in space, by distances in space: {in_space}.

Examples:
  tilescope curve --radius 0.01 --numbers conflicts,gaps,min_distance_r --out run.csv
  tilescope curve --count 5000 --variant as-printed --numbers samples,gaps
  tilescope curve --count 2000 --method reference --numbers density,low_power --moments 200
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
        ])
        .collect()
}

/// Computes the numbers of a run over its events, and prints or writes the table.
pub fn run(arguments: &CurveArguments) -> Result<u8> {
    interrupt::listen();
    if let Some(path) = &arguments.out {
        // A table in the place of an input would destroy it.
        let inputs = [&arguments.session, &arguments.run.pattern];
        check_inputs_stay(path, inputs.into_iter().flatten().map(PathBuf::as_path))?;
        check_file(path).context("--out")?;
    }
    // A misspelt number is refused before the run is made. Whether a saved session is of a set in space, its file says.
    let is_in_space = arguments.space.is_given();
    if arguments.session.is_none() {
        numbers_of(arguments, is_in_space)?;
    }

    let followed = course(arguments)?;
    let numbers = numbers_of(arguments, followed.is_in_space())?;
    // More samples than a spectrum can follow are refused here, before the first number is computed.
    let maker = CurveMaker::new(Arc::new(followed), &numbers, arguments.moments)?;
    let table = made(maker)?.csv();
    match &arguments.out {
        Some(path) => write_whole(path, table.as_bytes())?,
        None => output::emit(&table)?,
    }
    Ok(EXIT_FINE)
}

/// Returns the numbers that the arguments ask for, of a run in space or of a planar one.
fn numbers_of(arguments: &CurveArguments, is_in_space: bool) -> Result<Vec<&'static SetNumber>> {
    let keys = &arguments.numbers;
    match (keys.is_empty(), is_in_space) {
        (true, true) => Ok(space_numbers().collect()),
        // Without a choice all numbers but those that need a spectrum at every row, which takes far longer.
        (true, false) => Ok(live_numbers()
            .filter(|number| !is_of_spectrum(number))
            .collect()),
        (false, true) => space_numbers_named(keys).context("--numbers"),
        (false, false) => numbers_named(keys).context("--numbers"),
    }
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
            recipe.parameters.pattern = arguments.run.exact_pattern(&recipe.parameters)?;
            ask_for_whole(Making::Exact, &recipe.parameters)?;
            Ok(Course::of_exact(&recipe, &mut watch)?)
        }
    }
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
    let recording = Arc::new(session.record(&mut load, watch)?);
    // The debugger compares the run with the digest in the session; what it would show is not needed.
    Debugger::resume(&session, Arc::clone(&recording))?;
    Ok(recording)
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
mod tests {
    use std::fs;

    use clap::Parser;
    use tilescope_core::{Parameters, PatternSpec, Unobserved, solid_sample};
    use tilescope_debugger::{DEFAULT_BUDGET, pattern_digest};
    use tilescope_formats::{ExportContext, PointSet, export};

    use super::*;

    /// Returns a saved session of a run, with its pattern in a file if there is a name for it.
    fn saved(pattern: &Pattern, file: Option<&str>) -> Session {
        let parameters = Parameters {
            radius: 0.05,
            leaf: 10.0,
            ..Parameters::default()
        };
        let pattern_used = Arc::new(pattern.clone());
        let recording =
            Recording::with_pattern(&parameters, pattern_used, DEFAULT_BUDGET, &mut Unobserved);
        let mut debugger = Debugger::new(Arc::new(recording.unwrap()), DEFAULT_BUDGET);
        debugger.pattern = file.map(|path| PatternFile {
            path: path.to_owned(),
            digest: pattern_digest(pattern),
        });
        debugger.session()
    }

    #[test]
    fn a_saved_session_is_the_same_run_or_is_refused() {
        let pattern = Pattern::of_spec(&PatternSpec::default(), &mut Unobserved).unwrap();
        let session = saved(&pattern, None);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("saved.json");
        let read = |session: &Session| {
            fs::write(&path, session.to_json().unwrap()).unwrap();
            of_session(&path, &mut Stopwatch::start())
        };
        let recording = read(&session).unwrap();
        assert_eq!(tilescope_debugger::digest(recording.run()), session.digest);

        // The control: another result.
        let other = Session {
            digest: "0".repeat(16),
            ..session
        };
        let error = read(&other).err().unwrap().to_string();
        assert!(error.contains("it is not the same run"), "{error}");
    }

    #[test]
    fn the_pattern_of_a_session_lies_beside_it() {
        let spec = PatternSpec {
            side: 30.0,
            seed: 9,
            ..PatternSpec::default()
        };
        let pattern = Pattern::of_spec(&spec, &mut Unobserved).unwrap();
        let session = saved(&pattern, Some("elsewhere/pattern.npy"));
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("saved.json");
        fs::write(&path, session.to_json().unwrap()).unwrap();
        let error = of_session(&path, &mut Stopwatch::start()).err().unwrap();
        assert!(
            error
                .to_string()
                .contains("put the pattern beside the session"),
            "{error}"
        );

        let domain = pattern.domain();
        let set = PointSet::from_points(domain.users_from_lattice(pattern.samples()));
        let context = ExportContext::new(tilescope_sets::region(domain), domain.radius());
        let go_on = |_| std::ops::ControlFlow::Continue(());
        export(&folder.path().join("pattern.npy"), &set, &context, &go_on).unwrap();
        let recording = of_session(&path, &mut Stopwatch::start()).unwrap();
        assert_eq!(tilescope_debugger::digest(recording.run()), session.digest);
    }

    /// Reads the words of a command line.
    fn arguments(words: &[&str]) -> CurveArguments {
        let words = ["tilescope", "curve"].iter().chain(words);
        match crate::Arguments::try_parse_from(words).unwrap().command {
            Some(crate::Command::Curve(arguments)) => *arguments,
            _ => panic!("a curve"),
        }
    }

    #[test]
    fn a_curve_in_space_has_the_numbers_of_the_set() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.csv");
        let out = path.to_str().unwrap();
        let words = [
            "--size", "10x10x4", "--radius", "1", "--seed", "3", "--out", out,
        ];
        assert_eq!(run(&arguments(&words)).unwrap(), EXIT_FINE);

        let table = fs::read_to_string(&path).unwrap();
        let mut rows = table.lines();
        assert_eq!(
            rows.next(),
            Some(
                "event,stage,samples,density,min_distance_r,conflicts,relative_radius,active_cubes"
            )
        );
        // At first nothing has arrived, and at the end no cube is active.
        assert!(
            rows.next().is_some_and(|row| row.ends_with(",0,0,,0,,0")),
            "{table:.200}"
        );
        let domain =
            SolidDomain::from_size([10.0, 10.0, 4.0], 1.0, tilescope_core::Boundary::Periodic);
        let made = solid_sample(domain.unwrap(), 3, &mut Unobserved).unwrap();
        let last: Vec<&str> = rows.next_back().unwrap().split(',').collect();
        assert_eq!(last[2], made.len().to_string());
        assert_eq!((last[5], last[7]), ("0", "0"));

        // About so many samples by a radius that is searched for.
        let words = [
            "--size",
            "10x10x4",
            "--count",
            "400",
            "--numbers",
            "samples",
        ];
        let found = course(&arguments(&words)).unwrap().final_count();
        assert!(found.abs_diff(400) <= 4, "{found}");
    }

    #[test]
    fn options_and_numbers_of_planar_runs_are_refused_in_space() {
        let refused = |words: &[&str]| {
            let words = [&["--size", "10x10x4", "--radius", "1"], words].concat();
            crate::describe(&run(&arguments(&words)).unwrap_err())
        };
        for (words, part) in [
            (
                &["--numbers", "gaps"][..],
                "\"gaps\" is not followed in space",
            ),
            (
                &["--method", "kdrt"],
                "--method kdrt: --size makes a set in space",
            ),
            (&["--leaf", "9"], "--leaf: --size makes a set in space"),
            (&["--levels", "3"], "--levels: --size makes a whole set"),
        ] {
            let said = refused(words);
            assert!(said.contains(part), "{said}");
        }
        let large = arguments(&["--size", "1000x1000x1000", "--radius", "1"]);
        let said = crate::describe(&run(&large).unwrap_err());
        assert!(
            said.contains("about 733") && said.contains("2000000"),
            "{said}"
        );
    }
}
