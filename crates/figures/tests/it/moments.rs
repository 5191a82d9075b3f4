//! Pictures of moments against the states they show.

#![allow(missing_docs, reason = "tests")]

use tilescope_core::{Boundary, Insertion, Moment, Parameters, PatternSpec, Unobserved, Variant};
use tilescope_debugger::{DEFAULT_BUDGET, Recording, State};
use tilescope_figures::{
    Group, Layers, MomentOptions, Palette, Scene, Shape, moment_scene, to_svg,
};

fn recording(boundary: Boundary, variant: Variant, insertion: Insertion) -> Recording {
    let parameters = Parameters {
        radius: 1.0 / 16.0,
        leaf: 6.0,
        seed: 5,
        boundary,
        variant,
        insertion,
        pattern: PatternSpec {
            side: 20.0,
            ..PatternSpec::default()
        },
        ..Parameters::default()
    };
    Recording::new(&parameters, DEFAULT_BUDGET, &mut Unobserved).unwrap()
}

fn staged(boundary: Boundary) -> Recording {
    recording(boundary, Variant::Staged, Insertion::Circumcentre)
}

/// The whole domain with room around it.
fn whole() -> MomentOptions {
    MomentOptions {
        center: [0.5, 0.5],
        scale: 50.0,
        size: [1000.0, 1000.0],
        palette: Palette::LIGHT,
        layers: Layers::ALL,
        copies: true,
    }
}

fn group<'a>(scene: &'a Scene, name: &str) -> Option<&'a Group> {
    scene.groups.iter().find(|group| group.name == name)
}

fn shapes(scene: &Scene, name: &str) -> usize {
    group(scene, name).map_or(0, |group| group.shapes.len())
}

fn cursors(recording: &Recording, of: impl Fn(&Moment) -> bool) -> Vec<usize> {
    let events = recording.tape().from(0);
    let found = events.filter(|(_, event)| event.moment().is_some_and(|moment| of(&moment)));
    found.map(|(index, _)| index + 1).collect()
}

#[test]
fn every_sample_is_drawn_as_it_stands() {
    let recording = staged(Boundary::Bounded);
    for cursor in (0..=recording.len()).step_by(97).chain([recording.len()]) {
        let scene = moment_scene(&recording, cursor, &whole());
        let state = State::at(&recording, cursor);
        let counts = state.counts();
        assert_eq!(shapes(&scene, "undecided"), counts.undecided);
        assert_eq!(shapes(&scene, "eliminated"), counts.eliminated);
        assert_eq!(shapes(&scene, "inserted"), counts.inserted);
        assert_eq!(shapes(&scene, "kept"), counts.kept - counts.inserted);
    }
}

#[test]
fn every_event_of_every_variant_has_a_picture() {
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        for (variant, insertion) in [
            (Variant::Staged, Insertion::Circumcentre),
            (Variant::Staged, Insertion::Uniform),
            (Variant::AsPrinted, Insertion::Circumcentre),
        ] {
            let recording = recording(boundary, variant, insertion);
            let stride = (recording.len() / 150).max(1);
            for cursor in (0..=recording.len() + 5).step_by(stride) {
                let options = MomentOptions::around(&recording, cursor, 8.0);
                let scene = moment_scene(&recording, cursor, &options);
                assert!(to_svg(&scene).is_ok(), "{cursor}");
                let shown = cursor.min(recording.len());
                let end = format!("(event {shown} of {})", recording.len());
                assert!(scene.title.ends_with(&end), "{}", scene.title);
            }
        }
    }
}

#[test]
fn before_the_first_event_there_is_no_sample() {
    let recording = staged(Boundary::Periodic);
    let scene = moment_scene(&recording, 0, &whole());
    assert!(scene.title.starts_with("Before the first event"));
    for name in [
        "undecided",
        "kept",
        "inserted",
        "eliminated",
        "blocks",
        "current",
        "changed",
    ] {
        assert!(group(&scene, name).is_none(), "{name}");
    }
}

#[test]
fn an_elimination_shows_its_conflict_and_what_it_changed() {
    let recording = staged(Boundary::Periodic);
    let steps = cursors(&recording, |m| matches!(m, Moment::Eliminate { .. }));
    assert!(steps.len() > 20);
    for &cursor in &steps {
        let scene = moment_scene(&recording, cursor, &whole());
        let conflict = group(&scene, "conflict").unwrap();
        let Shape::Segments { segments, .. } = &conflict.shapes[0] else {
            panic!("a line")
        };
        let [a, b] = segments[0];
        // Across a seam the line is still the short one.
        assert!((a[0] - b[0]).hypot(a[1] - b[1]) <= recording.domain().radius() * 1.0001);
        assert_eq!(
            (shapes(&scene, "changed"), shapes(&scene, "current")),
            (1, 1)
        );
    }
    let before = moment_scene(&recording, steps[0] - 1, &whole());
    assert!(group(&before, "changed").is_none());
}

#[test]
fn the_circle_under_test_goes_through_its_samples() {
    let recording = staged(Boundary::Periodic);
    let steps = cursors(&recording, |m| matches!(m, Moment::Candidate { .. }));
    let unit = 1.0 / f64::from(recording.domain().width());
    let mut seen = 0;
    for &cursor in steps.iter().step_by(7) {
        let scene = moment_scene(&recording, cursor, &whole());
        let shapes = &group(&scene, "circle under test").unwrap().shapes;
        let [
            Shape::Circle { center, radius, .. },
            Shape::Polygon { points, .. },
            ..,
        ] = &shapes[..]
        else {
            continue;
        };
        seen += 1;
        assert_eq!(group(&scene, "place under test").unwrap().shapes.len(), 1);
        for point in points {
            let distance = (point[0] - center[0]).hypot(point[1] - center[1]);
            // The place is rounded to the lattice.
            assert!(
                (distance - radius).abs() < 4.0 * unit,
                "{cursor}: {distance} {radius}"
            );
        }
    }
    assert!(seen > 20);
}

#[test]
fn a_search_marks_as_many_samples_as_it_found() {
    let recording = staged(Boundary::Bounded);
    for cursor in cursors(&recording, |m| matches!(m, Moment::Search { .. })) {
        let scene = moment_scene(&recording, cursor, &whole());
        let search = State::at(&recording, cursor).context().search.unwrap();
        assert_eq!(
            shapes(&scene, "search"),
            1 + recording.test_buffer(&search).len()
        );
    }
}

#[test]
fn layers_that_are_off_are_not_drawn() {
    let recording = staged(Boundary::Periodic);
    let none = Layers {
        samples: true,
        ..Layers::NONE
    };
    let options = MomentOptions {
        layers: none,
        ..whole()
    };
    let cursor = cursors(&recording, |m| matches!(m, Moment::Candidate { .. }))[3];
    let names = |options| {
        let scene = moment_scene(&recording, cursor, options);
        scene
            .groups
            .into_iter()
            .map(|group| group.name)
            .collect::<Vec<_>>()
    };
    assert_eq!(names(&options), ["domain", "kept", "event", "frame"]);
    let all = names(&whole());
    for name in [
        "block borders",
        "gaps",
        "disks",
        "eliminated",
        "detectors",
        "search",
        "current",
    ] {
        assert!(all.iter().any(|other| other == name), "{name}");
    }
}

#[test]
fn dark_pictures_differ_and_options_without_a_size_are_refused() {
    let recording = staged(Boundary::Periodic);
    let dark = MomentOptions {
        palette: Palette::DARK,
        ..whole()
    };
    let scene = moment_scene(&recording, 500, &dark);
    assert_eq!(scene.background, Palette::DARK.background);
    assert_ne!(scene, moment_scene(&recording, 500, &whole()));
    for (scale, size) in [
        (0.0, [1000.0; 2]),
        (f64::NAN, [1000.0; 2]),
        (50.0, [0.0; 2]),
    ] {
        let options = MomentOptions {
            scale,
            size,
            ..whole()
        };
        assert!(
            to_svg(&moment_scene(&recording, 500, &options)).is_err(),
            "{scale} {size:?}"
        );
    }
}

#[test]
fn a_framed_moment_shows_just_what_was_asked_for() {
    let recording = staged(Boundary::Periodic);
    let radius = recording.domain().radius();
    let options = MomentOptions::framing([0.4, 0.6], 30.0, [640.0, 480.0]);
    let frame = options.frame();
    let size = [0, 1].map(|k| frame.max[k] - frame.min[k]);
    assert!((size[0] - 640.0).abs() < 1e-9 && (size[1] - 480.0).abs() < 1e-9);
    let window = options.window(radius);
    let wide = (window.max[0] - window.min[0]) / radius;
    assert!((wide - 640.0 / 30.0).abs() < 1e-9);
    assert!((f64::midpoint(window.min[1], window.max[1]) - 0.6).abs() < 1e-12);
    let scene = moment_scene(&recording, recording.len(), &options);
    assert!((scene.width - options.size[0]).abs() < 1e-9);
    assert!((scene.height - options.size[1]).abs() < 1e-9);
    let clip = group(&scene, "kept").and_then(|group| group.clip).unwrap();
    assert!((0..2).all(|k| (clip.min[k] - frame.min[k]).abs() < 1e-9));
    assert!((0..2).all(|k| (clip.max[k] - frame.max[k]).abs() < 1e-9));
}
