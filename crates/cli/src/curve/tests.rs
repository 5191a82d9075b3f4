//! Runs of saved sessions and of sets in space.

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

#[test]
fn a_saved_session_in_space_has_the_numbers_of_its_set() {
    let parameters = Parameters {
        width: 11.0,
        height: 10.0,
        radius: 1.0,
        seed: 5,
        ..Parameters::default()
    };
    let domain = SolidDomain::from_size([11.0, 10.0, 4.0], 1.0, parameters.boundary).unwrap();
    let planar = Domain::from_size([11.0, 10.0], 1.0, parameters.boundary).unwrap();
    let recording =
        Recording::in_space(domain, planar, &parameters, DEFAULT_BUDGET, &mut Unobserved);
    let debugger = Debugger::new(Arc::new(recording.unwrap()), DEFAULT_BUDGET);
    // The window adds the third side.
    let session = Session {
        depth: Some(4.0),
        ..debugger.session()
    };

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("saved.json");
    let file = path.to_str().unwrap();
    let of_file = |session: &Session| {
        fs::write(&path, session.to_json().unwrap()).unwrap();
        course(&arguments(&["--session", file]))
    };
    let of_session = of_file(&session).unwrap();
    assert_eq!(of_session.setting(), Setting::Space);
    let words = ["--size", "11x10x4", "--radius", "1", "--seed", "5"];
    let asked = course(&arguments(&words)).unwrap();
    assert_eq!(of_session.changes(), asked.changes());

    // The controls: another depth is another set, and a box of too many balls is refused before it is made.
    for (depth, part) in [(4.5, "it is not the same run"), (40_000.0, "2000000")] {
        let other = Session {
            depth: Some(depth),
            ..session.clone()
        };
        let error = crate::describe(&of_file(&other).err().unwrap());
        assert!(error.contains(part), "{error}");
    }
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
        Some("event,stage,samples,density,min_distance_r,conflicts,relative_radius,active_cubes")
    );
    // At first nothing has arrived, and at the end no cube is active.
    assert!(
        rows.next().is_some_and(|row| row.ends_with(",0,0,,0,,0")),
        "{table:.200}"
    );
    let domain = SolidDomain::from_size([10.0, 10.0, 4.0], 1.0, tilescope_core::Boundary::Periodic);
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
