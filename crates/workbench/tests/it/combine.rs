//! Combinations in the window: equal to those of the core, shown, saved and exported.

use std::fs;
use std::ops::ControlFlow;
use std::path::Path;
use std::sync::Arc;

use serde_json::json;
use tilescope_analysis::{Boundary as Judged, Region};
use tilescope_core::combine::file::{Layout, LayoutError, PieceSource, Set};
use tilescope_core::combine::{Combined, combine};
use tilescope_core::{Boundary, Domain, Point, Stage, Standing, Unobserved, reference_sample};
use tilescope_drawing::picture::MomentView;
use tilescope_formats::{
    ExportContext, Overrides, PointSet, bytes_digest, check, positions_digest,
};
use tilescope_session::combination::{CombineCommand, NINE};
use tilescope_session::layers::Layer;
use tilescope_workbench::command::{AppearanceCommand, TimeCommand, ViewCommand, Which};
use tilescope_workbench::compare::{CompareCommand, ComparePreset};
use tilescope_workbench::export::{ExportKind, picture};
use tilescope_workbench::files::SaveTask;
use tilescope_workbench::state::ExportSource;
use tilescope_workbench::{Command, State};

use crate::combining::{drop_text, nine};
use crate::exporting::{export_view, notice_text, opened, write};

/// The core's combination of a layout of reference sets.
fn of_core(text: &str) -> Combined {
    let layout = Layout::from_json(text.as_bytes()).unwrap();
    let placed = layout.placed().unwrap();
    let set = |source: &PieceSource| match source {
        PieceSource::Reference { seed, own } => {
            Ok(Set::of_reference(*own, *seed, &mut Unobserved).unwrap())
        }
        _ => Err(LayoutError::NoSource),
    };
    let pieces = placed.pieces(set, |_| {}).unwrap();
    combine(placed.domain, &pieces, &layout.options(), &mut Unobserved).unwrap()
}

/// The positions of the samples with this status after a stage.
fn standing(state: &State, stage: Stage, so: fn(Standing) -> bool) -> Vec<Point> {
    let run = state.runs().first.session.as_ref().unwrap().run();
    let ids = 0..run.samples.len() as u32;
    let found = ids.filter(|&id| so(run.standing(id, stage)));
    found.map(|id| run.samples.points[id as usize]).collect()
}

#[test]
fn nine_sets_in_the_window_equal_those_of_the_core() {
    let state = nine();
    let expected = of_core(NINE);
    let session = state.runs().first.session.as_ref().unwrap();
    let run = session.run();
    assert_eq!(run.points(), expected.points);
    assert_eq!(session.summary, *expected.summary());
    // The command line's test pins the same digest.
    assert_eq!(
        positions_digest(&run.positions()),
        "blake3:a0a039606fe50301d6d486f592414acc0ee4ebef6ae5507b6887af0932e54c14"
    );
    assert!(state.runs().first.verdict().unwrap().report.valid());
    let combination = session.combination.as_ref().unwrap();
    assert_eq!(combination.seams, expected.seams);
    assert_eq!((combination.seams.len(), combination.files), (18, 0));
    // Eliminated samples can be shown, and before elimination all that were placed.
    let eliminated = |standing| matches!(standing, Standing::Eliminated { .. });
    let lost: Vec<Point> = expected.eliminated.iter().map(|lost| lost.point).collect();
    assert_eq!(standing(&state, Stage::Finish, eliminated), lost);
    let placed = standing(&state, Stage::Tile, |it| it == Standing::Tiled);
    assert_eq!(placed.len(), expected.summary().tiled);
    let valid = standing(&state, Stage::Eliminate, |it| it == Standing::Valid);
    assert_eq!(valid.len(), placed.len() - lost.len());
    assert!(!session.conflicts.is_empty());
}

#[test]
fn stages_of_a_combination_can_be_stepped_through() {
    let mut state = nine();
    let session = Arc::clone(state.runs().first.session.as_ref().unwrap());
    assert_eq!(
        session.stages[..3],
        [Stage::Blocks, Stage::Tile, Stage::Eliminate]
    );
    assert_eq!(state.runs().first.current_stage(), Some(Stage::Finish));
    state.apply(Command::Time(TimeCommand::FirstStage));
    assert_eq!(state.runs().first.current_stage(), Some(Stage::Blocks));
    state.apply(Command::Time(TimeCommand::StepForward));
    assert_eq!(state.runs().first.current_stage(), Some(Stage::Tile));
    assert_eq!(session.count_after(1), session.summary.tiled);
    // There are no events, no parameters to vary and no passes, and each refusal says so.
    assert!(state.runs().first.debugger.is_none());
    let refusal = state
        .runs()
        .preset_refusal(ComparePreset::NextSeed, state.form(), state.gpu())
        .unwrap();
    assert!(refusal.contains("layout"), "{refusal}");
    assert!(
        state
            .runs()
            .preset_refusal(ComparePreset::Typed, state.form(), state.gpu())
            .is_none()
    );
    assert!(
        state
            .gpu()
            .passes_refusal(&state.runs().first)
            .unwrap()
            .contains("combination")
    );
    let refusal = ExportSource::of(&state)
        .kind_refusal(ExportKind::Animation)
        .unwrap();
    assert!(refusal.to_string().contains("no time to animate"));
    // Compare with a run of the panel's parameters, and swap the two.
    let draft = state.form().draft.parameters;
    state.apply(Command::Compare(CompareCommand::Start(
        ComparePreset::Typed,
    )));
    state.settle();
    state.apply(Command::Compare(CompareCommand::Swap));
    state.settle();
    assert!(!state.runs().first.shows_combination());
    state.apply(Command::Compare(CompareCommand::Swap));
    state.settle();
    assert!(state.runs().first.shows_combination());
    assert_eq!(state.form().draft.parameters, draft);
}

/// The number of segments and rectangles of a group in the moment's picture.
fn drawn(state: &State, name: &str) -> usize {
    let view = export_view(state, ExportKind::Picture).unwrap();
    let moment = state.runs().first.moment().unwrap();
    let session = state.runs().first.session.as_ref().unwrap();
    let scene = picture::scene(session, &MomentView { moment, view }, None);
    let shapes = scene.groups.iter().filter(|group| group.name == name);
    let shapes = shapes.flat_map(|group| &group.shapes);
    let count = |shape: &tilescope_figures::Shape| match shape {
        tilescope_figures::Shape::Segments { segments, .. } => segments.len(),
        _ => 1,
    };
    shapes.map(count).sum()
}

#[test]
fn pictures_show_the_seams_while_their_layer_is_on() {
    let mut state = nine();
    state.apply(Command::View(Which::First, ViewCommand::Fit));
    // Six seams on the border of the periodic domain are drawn on both sides.
    assert_eq!(drawn(&state, "seams"), 18 + 6);
    assert!(drawn(&state, "band") >= 36);
    state.apply(Command::Appearance(AppearanceCommand::ToggleLayer(
        Layer::Seams,
    )));
    assert_eq!((drawn(&state, "seams"), drawn(&state, "band")), (0, 0));
    // Making a combination shows the seams.
    state.apply(Command::Combine(CombineCommand::Nine));
    state.settle();
    assert!(state.appearance().layers(None).has(Layer::Seams));
}

#[test]
fn an_export_has_the_certificate_of_a_combination() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("nine.csv");
    let mut state = nine();
    write(&mut state, ExportKind::Result, &path, &[]);
    let go_on = |_| ControlFlow::Continue(());
    let (_, checked) = check(&path, &Overrides::default(), &go_on).unwrap();
    assert!(checked.report.valid() && checked.differences.is_empty());
    let certificate = checked.certificate.unwrap();
    assert_eq!(certificate.method, "combined");
    assert_eq!(certificate.parameters["layout"]["pieces"][8]["seed"], 9);
    assert!(!certificate.parameters.contains_key("seed"));
    // Without one of its samples the set has another digest and is not maximal.
    let text = fs::read_to_string(&path).unwrap();
    let middle = text.lines().count() / 2;
    let kept = text.lines().enumerate().filter(|(k, _)| *k != middle);
    let kept: Vec<&str> = kept.map(|(_, line)| line).collect();
    fs::write(&path, kept.join("\n")).unwrap();
    let (_, checked) = check(&path, &Overrides::default(), &go_on).unwrap();
    assert!(!checked.report.maximal() && !checked.differences.is_empty());
}

/// Saves a reference set of [0, 2] x [0, 2] with radius 0.1 and its certificate.
fn save_set(path: &Path, seed: u64) {
    let domain = Domain::from_size([2.0, 2.0], 0.1, Boundary::Periodic).unwrap();
    let points = reference_sample(domain, seed, &mut Unobserved).unwrap();
    let user = |&point: &Point| domain.user_from_lattice(point);
    let region = Region {
        width: 2.0,
        height: 2.0,
        boundary: Judged::Periodic,
    };
    let set = PointSet {
        points: points.iter().map(user).collect(),
        provenance: None,
    };
    let go_on = |_| ControlFlow::Continue(());
    tilescope_formats::export(path, &set, &ExportContext::new(region, 0.1), &go_on).unwrap();
}

#[test]
fn sets_from_files_are_glued_and_named_by_their_content() {
    let folder = tempfile::tempdir().unwrap();
    save_set(&folder.path().join("a.csv"), 1);
    save_set(&folder.path().join("b.ply"), 2);
    let layout = json!({ "version": 1, "radius": 0.1, "columns": [2, 3], "rows": [2], "boundary": "bounded",
        "pieces": [{ "file": "a.csv" }, { "file": "b.ply", "offset": [0.5, 0.25] }] });
    let path = folder.path().join("layout.json");
    let mut state = opened();
    drop_text(&mut state, &path, &layout.to_string());
    assert!(
        state.runs().first.shows_combination(),
        "{}",
        notice_text(&state)
    );
    assert!(state.runs().first.verdict().unwrap().report.valid());
    let session = state.runs().first.session.clone().unwrap();
    let combination = session.combination.as_ref().unwrap();
    assert_eq!((combination.files, combination.seams.len()), (2, 1));
    // A session would depend on files.
    assert!(
        state
            .runs()
            .first
            .save_refusal()
            .unwrap()
            .contains("sets from files")
    );
    assert!(SaveTask::of(&state).combination.is_none());
    let out = folder.path().join("out.csv");
    write(&mut state, ExportKind::Result, &out, &[]);
    let go_on = |_| ControlFlow::Continue(());
    let (_, checked) = check(&out, &Overrides::default(), &go_on).unwrap();
    assert!(checked.report.valid() && checked.differences.is_empty());
    let stated = &checked.certificate.unwrap().parameters["layout"]["pieces"];
    assert_eq!(stated[1]["file"], "b.ply");
    assert_ne!(stated[0]["digest"], stated[1]["digest"]);
    for (piece, name) in [(0, "a.csv"), (1, "b.ply")] {
        let bytes = fs::read(folder.path().join(name)).unwrap();
        assert_eq!(stated[piece]["digest"], bytes_digest(&bytes));
    }
}

#[test]
fn a_piece_with_thousands_of_neighbours_is_glued() {
    let folder = tempfile::tempdir().unwrap();
    save_set(&folder.path().join("a.csv"), 1);
    // A ring of unit squares, each beside the next, around one piece.
    let (last, side) = (201, 202);
    let mut rects = vec![[1, 1, last, last]];
    for k in 0..last {
        rects.push([k, 0, k + 1, 1]);
        rects.push([last, k, side, k + 1]);
        rects.push([k + 1, last, k + 2, side]);
        rects.push([0, k + 1, 1, k + 2]);
    }
    let scale = |at: i32| f64::from(at) * 0.125;
    let pieces: Vec<_> = rects
        .iter()
        .enumerate()
        .map(|(k, rect)| {
            let offset = [f64::from(k as i32 % 7) * 0.25, 0.5];
            json!({ "rect": rect.map(scale), "file": "a.csv", "offset": offset })
        })
        .collect();
    let layout = json!({ "version": 1, "radius": 0.1, "width": scale(side), "height": scale(side),
        "pieces": pieces });
    let path = folder.path().join("layout.json");
    let mut state = opened();
    drop_text(&mut state, &path, &layout.to_string());
    assert!(
        state.runs().first.shows_combination(),
        "{}",
        notice_text(&state)
    );
    assert!(state.runs().first.verdict().unwrap().report.valid());
    let session = state.runs().first.session.clone().unwrap();
    let combination = session.combination.as_ref().unwrap();
    assert_eq!(combination.files, 805);
    assert!(combination.in_reach > 0.0 && combination.in_reach < 0.25);
    let digest = bytes_digest(&fs::read(folder.path().join("a.csv")).unwrap());
    let stated = combination.stated["pieces"].as_array().unwrap();
    assert!(stated.iter().all(|piece| piece["digest"] == digest));
}

#[test]
fn large_combinations_keep_their_result_with_its_seams() {
    let text = NINE.replace("0.02", "0.0033");
    let mut state = opened();
    state.apply(Command::Combine(CombineCommand::Text(text.clone())));
    state.settle();
    let session = state.runs().first.session.clone().unwrap();
    assert!(session.summary.count > 500_000 && !session.has_stages());
    let expected = of_core(&text);
    assert_eq!(session.run().points(), expected.points);
    assert_eq!(session.summary, *expected.summary());
    let combination = session.combination.as_ref().unwrap();
    assert_eq!(combination.seams, expected.seams);
    assert_eq!(session.stages, [Stage::Blocks, Stage::Finish]);
}
