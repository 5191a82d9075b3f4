//! The parts of a picture, drawn on a surface that records the calls, compared with the states that they show.

use std::sync::Arc;

use emath::{Pos2, Rect, Vec2, vec2};
use serde_json::json;
use tilescope_core::{Boundary, Insertion, Parameter, RunEvent, Stage, Standing, Variant};
use tilescope_debugger::Recording;
use tilescope_drawing::looks::{Looks, Swatches};
use tilescope_drawing::palette::{DARK, Palette};
use tilescope_drawing::parts::Part;
use tilescope_drawing::picture::MomentView;
use tilescope_drawing::scene::Scene;
use tilescope_drawing::surface::{Arc as Angles, Mark, Stroke, Surface, Tag};
use tilescope_figures::to_svg;
use tilescope_session::layers::Layer;
use tilescope_session::words::grouped;
use tilescope_workbench::command::{
    AppearanceCommand, FormCommand, TimeCommand, ViewCommand, Which,
};
use tilescope_workbench::draft::Choice;
use tilescope_workbench::export::{ExportKind, picture};
use tilescope_workbench::state::{ExportSource, Settings};
use tilescope_workbench::{Command, State};

type Color = ecolor::Color32;

/// A surface that records what is drawn.
#[derive(Default)]
struct Written {
    marks: Vec<(Mark, Pos2)>,
    dashes: Vec<([Pos2; 2], Stroke)>,
    circles: Vec<(Pos2, f32, Option<Stroke>)>,
    disks: Vec<Pos2>,
    arcs: Vec<Pos2>,
    others: usize,
}

impl Surface for Written {
    fn rect(&mut self, _: Rect, _: Option<Color>, _: Option<Stroke>) {
        self.others += 1;
    }

    fn line(&mut self, _: [Pos2; 2], _: Stroke) {
        self.others += 1;
    }

    fn dashes(&mut self, ends: [Pos2; 2], stroke: Stroke) {
        self.dashes.push((ends, stroke));
    }

    fn circle(&mut self, center: Pos2, radius: f32, _: Option<Color>, stroke: Option<Stroke>) {
        self.circles.push((center, radius, stroke));
    }

    fn arc(&mut self, center: Pos2, _: f32, _: Angles, _: Stroke) {
        self.arcs.push(center);
    }

    fn disk(&mut self, center: Pos2, _: f32, _: Color) {
        self.disks.push(center);
    }

    fn mark(&mut self, mark: Mark, center: Pos2, _: [f32; 2], _: Color) {
        self.marks.push((mark, center));
    }

    fn outline(&mut self, _: &[Pos2], _: Stroke) {
        self.others += 1;
    }

    fn tag(&mut self, _: &Tag) {
        self.others += 1;
    }

    fn text_size(&self, text: &str, size: f32) -> Vec2 {
        vec2(0.6 * size * text.len() as f32, size)
    }
}

impl Written {
    fn count(&self, mark: Mark) -> usize {
        self.marks
            .iter()
            .filter(|(other, _)| *other == mark)
            .count()
    }

    fn is_empty(&self) -> bool {
        let points = self.disks.len() + self.arcs.len();
        self.marks.len() + self.dashes.len() + self.circles.len() + points + self.others == 0
    }
}

/// A small run of 16 r by 16 r, all of it in view.
fn small(choices: &[Choice]) -> State {
    let mut state = State::new(Arc::new(|| {}));
    state.restore(Settings {
        prefers_reduced_motion: Some(true),
        ..Settings::default()
    });
    let canvas = Rect::from_min_size(Pos2::ZERO, vec2(1_000.0, 1_000.0));
    state.apply(Command::View(Which::First, ViewCommand::Viewport(canvas)));
    for (field, text) in [
        (Parameter::Radius, "0.0625"),
        (Parameter::Leaf, "6"),
        (Parameter::Seed, "5"),
        (Parameter::PatternSide, "20"),
    ] {
        state.apply(Command::Form(FormCommand::Type(field, text.to_owned())));
    }
    for choice in choices {
        state.apply(Command::Form(FormCommand::Choose(choice.clone())));
    }
    state.settle();
    state.apply(Command::Run);
    state.settle();
    // Samples that a bounded domain drops lie up to one r outside its border.
    state.apply(Command::View(
        Which::First,
        ViewCommand::FlyTo([8.0; 2].into(), 24.0),
    ));
    state.settle();
    state
}

fn jump(state: &mut State, cursor: usize) {
    state.apply(Command::Time(TimeCommand::Jump(cursor)));
}

/// Draws those of the parts that are visible at the moment shown.
fn written(state: &State, palette: &Palette, parts: &[Part]) -> Written {
    let subject = state
        .runs()
        .subject(Which::First, state.appearance(), None)
        .expect("a run");
    let scene = Scene::new(state.runs().first.viewport, subject, palette);
    let mut swatches = Swatches::default();
    swatches.follow(&subject, palette);
    let looks = Looks::new(&subject, palette, &swatches);
    let mut written = Written::default();
    for part in parts.iter().filter(|part| part.is_on(&scene)) {
        part.draw(&scene, &looks, &mut written);
    }
    written
}

fn recording(state: &State) -> Arc<Recording> {
    let session = state.runs().first.session.as_ref().expect("a session");
    Arc::clone(session.recording().expect("events"))
}

fn cursors(recording: &Recording, of: impl Fn(&RunEvent) -> bool) -> Vec<usize> {
    let events = recording.tape().from(0);
    let found = events.filter(|(_, event)| event.run_event().is_some_and(|event| of(&event)));
    found.map(|(index, _)| index + 1).collect()
}

#[test]
fn every_sample_is_drawn_by_its_status() {
    let mut state = small(&[Choice::Parameter(
        Parameter::Boundary,
        json!(Boundary::Bounded),
    )]);
    let recording = recording(&state);
    let tiled = cursors(&recording, |event| matches!(event, RunEvent::Tiled { .. }));
    let mut seen = [0; 3];
    for cursor in (tiled[0]..=recording.len()).step_by(97) {
        jump(&mut state, cursor);
        let drawn = written(&state, &DARK, &[Part::Samples]);
        let session = state.runs().first.session.as_ref().expect("a session");
        let moment = state.runs().first.moment().expect("a moment");
        let samples = &session.run().samples;
        let mut expected = [0; 3];
        for (id, origin) in (0..).zip(&samples.origins) {
            let is_inserted = matches!(origin, tilescope_core::Origin::Inserted { .. });
            match moment.standing(session, id) {
                Standing::Eliminated { .. } => expected[0] += 1,
                Standing::Valid | Standing::Tiled => expected[1 + usize::from(is_inserted)] += 1,
                // Dropped samples are drawn faintly during tiling.
                Standing::Dropped => expected[1] += usize::from(moment.stage == Stage::Tile),
                Standing::Absent => {}
            }
        }
        // An inserted sample has an outline, which is a mark below it.
        let inserted = drawn.count(Mark::Diamond) / 2;
        let marks = [drawn.count(Mark::Cross), drawn.count(Mark::Dot), inserted];
        assert_eq!(marks, expected, "{cursor}");
        seen = [0, 1, 2].map(|k| seen[k] + marks[k]);
    }
    assert!(seen.iter().all(|count| *count > 20), "{seen:?}");
}

/// Checks that the picture of the moment can be written, names the moment, and is clipped to its frame.
fn check_picture(state: &State) {
    let view = ExportSource::of(state).view(ExportKind::Picture, false);
    let view = view.expect("a canvas");
    let session = state.runs().first.session.as_ref().expect("a session");
    let moment = state.runs().first.moment().expect("a moment");
    let shown = MomentView {
        moment,
        view: view.clone(),
    };
    let scene = picture::scene(session, &shown, None);
    assert!(to_svg(&scene).is_ok(), "{moment:?}");
    let (at, all) = state.runs().first.cursor().expect("events");
    let message = format!("(event {} of {})", grouped(at), grouped(all));
    assert!(scene.title.ends_with(&message), "{}", scene.title);
    let frame = view.frame();
    for group in scene.groups.iter().filter(|group| group.name != "heading") {
        let clip = group.clip.expect("what is seen of the plane is clipped");
        let [width, height] = [0, 1].map(|k| (clip.max[k] - clip.min[k]) as f32);
        let fits = width <= frame.width() + 0.01 && height <= frame.height() + 0.01;
        assert!(fits && width > 0.0 && height > 0.0, "{}", group.name);
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
            let mut state = small(&[
                Choice::Parameter(Parameter::Boundary, json!(boundary)),
                Choice::Parameter(Parameter::Variant, json!(variant)),
                Choice::Parameter(Parameter::Insertion, json!(insertion)),
            ]);
            let len = recording(&state).len();
            for cursor in (0..=len).step_by((len / 150).max(1)) {
                jump(&mut state, cursor);
                let drawn = written(&state, &DARK, &Part::ALL);
                check_picture(&state);
                let has_samples = state.runs().first.current_stage() > Some(Stage::Blocks);
                assert!(!has_samples || !drawn.is_empty(), "{cursor}");
            }
        }
    }
}

/// Returns how many of the points lie outside the domain of 16 r, in view.
fn outside(state: &State, points: &[Pos2]) -> usize {
    let run = &state.runs().first;
    let corners = [[0.0, 16.0], [16.0, 0.0]];
    let [from, to] = corners.map(|at| run.camera.screen_from_domain(run.viewport, at));
    let domain = Rect::from_min_max(from, to).expand(0.01);
    let is_out = |at: &&Pos2| !domain.contains(**at) && run.viewport.contains(**at);
    points.iter().filter(is_out).count()
}

#[test]
fn copies_around_a_periodic_domain_are_drawn_like_the_domain() {
    for boundary in [Boundary::Periodic, Boundary::Bounded] {
        let mut state = small(&[Choice::Parameter(Parameter::Boundary, json!(boundary))]);
        state.apply(Command::Appearance(AppearanceCommand::ToggleLayer(
            Layer::Disks,
        )));
        let recording = recording(&state);
        let is_periodic = boundary == Boundary::Periodic;
        let end = |stage| recording.end_of(stage).expect("the stage");

        // Within 4 r around 16 r lie 1.25 times as many samples as within; the viewport cuts off some.
        let drawn = written(&state, &DARK, &[Part::Disks]);
        let around = outside(&state, &drawn.disks);
        let within = drawn.disks.len() - around;
        assert_eq!(2 * around > within, is_periodic, "{around} and {within}");
        jump(&mut state, end(Stage::Tile));
        let drawn = written(&state, &DARK, &[Part::Conflicts]);
        let ends: Vec<Pos2> = drawn.dashes.iter().flat_map(|(ends, _)| *ends).collect();
        assert_eq!(outside(&state, &ends) > 20, is_periodic);

        jump(&mut state, end(Stage::Eliminate));
        state.settle();
        let drawn = written(&state, &DARK, &[Part::GapBorders]);
        assert!(!drawn.arcs.is_empty());
        assert_eq!(outside(&state, &drawn.arcs) > 20, is_periodic);
    }
}

#[test]
fn conflict_lines_lead_to_samples_that_are_drawn() {
    let mut state = small(&[]);
    let end = recording(&state).end_of(Stage::Eliminate).expect("it");
    jump(&mut state, end);
    // Of pairs of which one sample was eliminated there are lines while those samples are drawn, too.
    let layers = state
        .appearance()
        .layers(state.runs().first.current_stage());
    assert!(layers.has(Layer::Eliminated) && layers.has(Layer::Conflicts));
    assert!(!written(&state, &DARK, &[Part::Conflicts]).dashes.is_empty());
    let hide = AppearanceCommand::ToggleLayer(Layer::Eliminated);
    state.apply(Command::Appearance(hide));
    assert!(written(&state, &DARK, &[Part::Conflicts]).dashes.is_empty());
}

#[test]
fn an_elimination_shows_its_conflict_and_what_it_changed() {
    let mut state = small(&[]);
    let steps = cursors(&recording(&state), |event| {
        matches!(event, RunEvent::Eliminate { .. })
    });
    assert!(steps.len() > 20);
    for cursor in steps {
        jump(&mut state, cursor);
        let drawn = written(&state, &DARK, &[Part::Step]);
        let [(ends, stroke)] = drawn.dashes[..] else {
            panic!("{cursor}: {} dashed lines", drawn.dashes.len());
        };
        // Across the periodic border the line is the short one.
        let r = state.runs().first.camera.scale as f32;
        assert!(ends[0].distance(ends[1]) <= 1.001 * r, "{cursor}");
        assert_eq!(stroke.color, DARK.conflict);
        let changed = Stroke::new(3.0, DARK.conflict);
        let rings = drawn
            .circles
            .iter()
            .filter(|circle| circle.2 == Some(changed));
        assert_eq!(rings.count(), 1, "{cursor}");
    }
}

#[test]
fn the_circle_under_test_goes_through_its_samples() {
    let mut state = small(&[]);
    let steps = cursors(&recording(&state), |event| {
        matches!(event, RunEvent::Candidate { .. })
    });
    let mut seen = 0;
    for &cursor in steps.iter().step_by(7) {
        jump(&mut state, cursor);
        let drawn = written(&state, &DARK, &[Part::Step]);
        let with_width = |width: f32| {
            let circles = drawn.circles.iter();
            circles.filter(move |circle| {
                circle
                    .2
                    .is_some_and(|stroke| stroke.width.to_bits() == width.to_bits())
            })
        };
        let Some((center, radius, _)) = with_width(1.8).next() else {
            continue;
        };
        for (site, ..) in with_width(2.2) {
            seen += 1;
            assert!((site.distance(*center) - radius).abs() < 0.05, "{cursor}");
        }
    }
    assert!(seen > 60, "{seen}");
}

#[test]
fn a_search_marks_as_many_samples_as_it_found() {
    let mut state = small(&[Choice::Parameter(
        Parameter::Boundary,
        json!(Boundary::Bounded),
    )]);
    let recording = recording(&state);
    let steps = cursors(&recording, |event| matches!(event, RunEvent::Search { .. }));
    assert!(steps.len() > 20);
    for cursor in steps {
        jump(&mut state, cursor);
        let drawn = written(&state, &DARK, &[Part::Step]);
        let search = recording.context(cursor).search.expect("a search");
        let found = Stroke::new(1.3, DARK.detector);
        let rings = drawn
            .circles
            .iter()
            .filter(|circle| circle.2 == Some(found));
        assert_eq!(
            rings.count(),
            recording.test_buffer(&search).len(),
            "{cursor}"
        );
    }
}

#[test]
fn hidden_layers_are_not_drawn() {
    let mut state = small(&[]);
    let steps = cursors(&recording(&state), |event| {
        matches!(event, RunEvent::Candidate { .. })
    });
    jump(&mut state, steps[3]);
    for (layer, part) in [
        (Layer::Blocks, Part::Borders),
        (Layer::Disks, Part::Disks),
        (Layer::Tree, Part::Tree),
        (Layer::Pattern, Part::Clips),
        (Layer::Samples, Part::Samples),
        (Layer::Detectors, Part::Search),
    ] {
        let [off, on] = [false, true].map(|on| {
            if state.appearance().layers(None).has(layer) != on {
                let toggle = AppearanceCommand::ToggleLayer(layer);
                state.apply(Command::Appearance(toggle));
            }
            let drawn = written(&state, &DARK, &[part]);
            drawn.disks.len() + drawn.marks.len() + drawn.dashes.len() + drawn.others
        });
        assert!(off < on, "{layer:?}: {off} and {on}");
    }
}

#[test]
fn before_the_first_event_there_is_no_sample() {
    let mut state = small(&[]);
    jump(&mut state, 0);
    let drawn = written(&state, &DARK, &Part::ALL);
    assert!(drawn.marks.is_empty() && drawn.circles.is_empty());
}
