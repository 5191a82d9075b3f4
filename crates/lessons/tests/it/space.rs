//! Steps that show a set in space: their box, their plane, their functions, and the faults of each.

use std::sync::Arc;

use tilescope_core::{Boundary, R, SolidDomain, Unobserved, solid_sample};
use tilescope_lessons::{Arrival, Learner, Lesson};

/// The box, of 12 x 11 x 10 r, some 970 balls.
const BOX: &str = "radius: 0.5\nwidth: 6\nheight: 5.5\ndepth: 5\nseed: 3";

fn lesson(fields: &str) -> String {
    format!("---\ntitle: T\nobjective: O\n---\n# S\n```run\n{fields}\n```\n")
}

fn learner(fields: &str) -> Learner {
    let read = Lesson::read("t", &lesson(fields)).unwrap_or_else(|error| panic!("{error}"));
    let mut learner = Learner::new(Arc::new(read), Arc::default());
    let run = learner.run().make(&mut Unobserved).expect("a run");
    assert!(learner.run().is_of(&run));
    assert_eq!(learner.arrive(&run, 0.0), Ok(Arrival::Here));
    learner
}

/// Returns the words of the step, with the values of its run.
fn told(fields: &str, text: &str) -> String {
    learner(&format!("{BOX}\n{fields}")).words(text)
}

/// Returns the samples of the box in r.
fn samples() -> Vec<[f64; 3]> {
    let domain = SolidDomain::from_size([6.0, 5.5, 5.0], 0.5, Boundary::Periodic).expect("a box");
    let places = solid_sample(domain, 3, &mut Unobserved).expect("a set");
    let radii = |place: [i32; 3]| place.map(|units| f64::from(units) / f64::from(R));
    places.into_iter().map(radii).collect()
}

/// Returns the way from one coordinate to another around the box.
fn way(from: f64, to: f64, side: f64) -> f64 {
    (to - from) - ((to - from) / side).round() * side
}

#[test]
fn the_plane_cuts_the_balls_of_the_set() {
    let all = samples();
    let density = all.len() as f64 / (12.0 * 11.0 * 10.0);
    let said = told(
        "plane: 2.5",
        "{samples()} {plane()} {abs(measure(\"density\") - DENSITY) < 1e-9} {conflicts()}"
            .replace("DENSITY", &density.to_string())
            .as_str(),
    );
    assert_eq!(said, format!("{} 2.50 true 0", all.len()));

    // Disks and heights of some samples, by Pythagoras.
    for (id, place) in all.iter().enumerate().step_by(97) {
        let above = way(2.5, place[2], 10.0);
        let disk = (1.0 - above * above).max(0.0).sqrt();
        let asked = format!(
            "{{abs(above({id}) - {above:?}) < 1e-3}} {{abs(disk({id}) - {disk:?}) < 1e-2}}"
        );
        assert_eq!(told("plane: 2.5", &asked), "true true", "{id}");
    }
}

#[test]
fn samples_in_sight_are_sorted_as_they_are_seen_and_measured_in_space() {
    let (all, at) = (samples(), [5.0, 6.0]);
    let offset = |id: usize| {
        let [x, y, z] = all[id];
        [way(at[0], x, 12.0), way(at[1], y, 11.0), way(2.5, z, 10.0)]
    };
    let seen = |id: &usize| offset(*id)[0].hypot(offset(*id)[1]);
    let mut cut: Vec<usize> = (0..all.len())
        .filter(|&id| offset(id)[2].abs() <= 1.0)
        .collect();
    cut.sort_by(|a, b| seen(a).total_cmp(&seen(b)));
    for k in [0, 3] {
        let id = cut[k];
        let far = seen(&id).hypot(offset(id)[2]);
        let asked = format!(
            "{{dot(5.0, 6.0, {k})}} {{abs(far_in_space({id}, 5.0, 6.0) - {far:?}) < 1e-3}} {{dots_apart({id}, {id})}}"
        );
        assert_eq!(told("plane: 2.5", &asked), format!("{id} true 0"));
    }
    let beyond = format!("{{exists(dot(5.0, 6.0, {}))}}", cut.len());
    assert_eq!(told("plane: 2.5", &beyond), "false");
}

#[test]
fn a_finished_set_covers_every_plane_and_a_layer_of_it_does_not() {
    let asked = "{open_places()} {open_within(1.0)} {open_within(0.4) > 1000} {open_within(0.0)} {covered(3.0, 4.0)} {clear_above(3.0, 4.0)}";
    assert_eq!(told("plane: 4", asked), "0 0 true 16384 true 0");
    // Seen along the third axis many pairs of the layer are close, and none are in its middle alone.
    let pairs = "{close_pairs(1.0) > 50} {close_pairs(0.0)}";
    assert_eq!(told("plane: 4", pairs), "true 0");
}

#[test]
fn the_first_ball_above_an_open_place_covers_it_from_there_on() {
    let run = "moment: before dart verdict=accepted iteration=6\nplane: place_z";
    let asked = "{clear_above(place_x, place_y) > 0} {refusers(place_x, place_y)} {covered(place_x, place_y)} {plane() == place_z}";
    assert_eq!(told(run, asked), "true 0 false true");

    // As high as the plane can rise nothing covers the place, and a little higher the sample does.
    for (more, is_covered) in [("- 0.01", "false"), ("+ 0.01", "true")] {
        let first = "moment: before dart verdict=accepted iteration=6\nplane: ";
        let rise = told(run, "{clear_above(place_x, place_y)} {place_z}");
        let numbers: Vec<f64> = rise.split(' ').map(|word| word.parse().unwrap()).collect();
        let higher = format!(
            "{first}min(9.9, {} + {} {more})",
            numbers[1] + 0.0,
            numbers[0]
        );
        assert_eq!(told(&higher, "{covered(place_x, place_y)}"), is_covered);
    }
}

#[test]
fn active_cubes_are_those_of_the_throw_and_a_plane_cuts_few_late_ones() {
    let first = "moment: before dart iteration=1\nplane: 2.5";
    let asked = "{active_cubes()} {cube_side()} {cubes_in_plane()} {planes_cut()}";
    assert_eq!(told(first, asked), "1320 1 132 100");
    let late = "moment: before dart iteration=12\nplane: 2.5";
    let asked = "{planes_cut() < 60} {planes_cut() > 0} {active_cubes() > 0} {cube_side() < 0.01}";
    assert_eq!(told(late, asked), "true true true true");
}

#[test]
fn a_plane_that_is_not_said_follows_the_events() {
    let asked = "{plane() == previous(\"dart\").z}";
    assert_eq!(told("moment: after dart iteration=3", asked), "true");
    assert_eq!(
        told("moment: after dart iteration=3\nplane: 1", asked),
        "false"
    );
    assert_eq!(told("moment: start", "{plane()}"), "5");
}

#[test]
fn another_box_is_another_run_and_a_planar_run_is_none() {
    let run_of = |fields: &str| {
        let read = Lesson::read("t", &lesson(fields)).expect("a lesson");
        Learner::new(Arc::new(read), Arc::default()).run()
    };
    let (made, planar) = (run_of(BOX), run_of(&BOX.replace("depth: 5\n", "")));
    let recording = made.make(&mut Unobserved).expect("a run");
    assert!(made.is_of(&recording) && !planar.is_of(&recording));
    let projected = planar.make(&mut Unobserved).expect("a run");
    assert!(planar.is_of(&projected) && !made.is_of(&projected));
    for other in [
        BOX.replace("depth: 5", "depth: 6"),
        BOX.replace("seed: 3", "seed: 4"),
    ] {
        assert!(!run_of(&other).is_of(&recording), "{other}");
    }
    let leaf = format!("{BOX}\nleaf: 9");
    assert!(
        run_of(&leaf).is_of(&recording),
        "the leaf has no meaning in space"
    );
}

#[test]
fn the_next_step_keeps_the_box_and_not_the_plane() {
    let text = lesson(&format!("{BOX}\nplane: 2"))
        + "# A\n# B\n```run\nlayers: samples\n```\n# C\n```run\ndepth: none\n```\n";
    let read = Lesson::read("t", &text).expect("a lesson");
    let asked = |step: usize| {
        let scene = &read.steps[step].scene;
        (scene.depth.is_some(), scene.plane.is_some())
    };
    let all = [0, 1, 2, 3].map(asked);
    // A step without a run shows the scene of the step before it as it is.
    assert_eq!(
        all,
        [(true, true), (true, true), (true, false), (false, false)]
    );
}

#[test]
fn faults_of_boxes_and_planes_are_named() {
    for (fields, wanted) in [
        ("plane: 1", "\"plane\" needs"),
        ("depth: deep", "allowed are numbers"),
        ("depth: 0.01", "at least 4 r"),
        ("depth: 9", "at most 20000"),
        ("depth: 1\nlevels: 2", "no levels"),
        (
            "depth: 1\nradius: 1\nwidth: 16\nheight: 8\nboundary: bounded\nradius-expression: 1 + x / 99",
            "one radius",
        ),
    ] {
        let said = Lesson::read("t", &lesson(fields))
            .expect_err(fields)
            .message;
        assert!(said.contains(wanted), "{fields}: {said}");
    }

    let beyond = format!("{BOX}\nplane: 10.5");
    let read = Lesson::read("t", &lesson(&beyond)).expect("a lesson");
    let mut learner = Learner::new(Arc::new(read), Arc::default());
    let run = learner.run().make(&mut Unobserved).expect("a run");
    let said = learner.arrive(&run, 0.0).expect_err("a fault").message;
    assert!(said.contains("from 0 to 10 r"), "{said}");
    for (asked, wanted) in [
        ("{gaps()}", "open_places()"),
        ("{measure(\"peak\")}", "not \"peak\""),
        (
            "{parts_at(\"seed=2\")}",
            "a set in space cannot be compared",
        ),
    ] {
        let said = told("plane: 1", asked);
        assert!(said.contains(wanted), "{said}");
    }
    // Of a planar run there is nothing to cut.
    let planar = self::learner("radius: 0.05\nleaf: 8").words("{above(1)}");
    assert!(planar.contains("depth"), "{planar}");
}
