//! Nested levels in the window: made, shown prefix by prefix, verified, saved and opened.

use std::path::Path;
use std::sync::Arc;

use serde_json::json;
use tilescope_analysis::Region;
use tilescope_core::{
    NestedPlane, NestedRequest, Parameter, Parameters, Standing, Unobserved, WithinLevel,
};
use tilescope_formats::Certificate;
use tilescope_session::layers::Layer;
use tilescope_session::session::Session;
use tilescope_session::verification::{Verdict, Witness};
use tilescope_workbench::clock::Clock;
use tilescope_workbench::command::{FormCommand, TimeCommand, ViewCommand, Which};
use tilescope_workbench::compare::{CompareCommand, ComparePreset};
use tilescope_workbench::draft::Choice;
use tilescope_workbench::export::ExportKind;
use tilescope_workbench::files::FileCommand;
use tilescope_workbench::state::{ExportSource, Verification};
use tilescope_workbench::{Command, State};

use crate::exporting::{notice_text, write};

fn form(state: &mut State, command: FormCommand) {
    state.apply(Command::Form(command));
}

fn time(state: &mut State, command: TimeCommand) {
    state.apply(Command::Time(command));
}

/// A window with four levels of some 1,700 samples.
fn made() -> State {
    let mut state = State::new(Arc::new(|| {}));
    state.settle();
    form(
        &mut state,
        FormCommand::Type(Parameter::Radius, "0.02".to_owned()),
    );
    form(&mut state, FormCommand::Choose(Choice::Levels(Some(4))));
    assert!(
        state
            .form()
            .remark(&state.runs().first, state.gpu())
            .unwrap()
            .contains("nested levels")
    );
    state.apply(Command::Run);
    state.settle();
    state
}

fn session(state: &State) -> &Arc<Session> {
    state.runs().first.session.as_ref().unwrap()
}

fn ends(state: &State) -> Vec<usize> {
    session(state).ends()
}

/// The verdict on the prefix that is shown.
fn verdict(state: &State) -> &Verdict {
    let verdict = state.runs().first.verdict().unwrap();
    let judged = verdict.claim.map(|claim| claim.count);
    assert_eq!(judged, state.runs().first.prefix());
    assert_eq!(state.runs().first.prefix_at_work(), None);
    verdict
}

#[test]
fn the_levels_of_the_window_are_those_of_the_core() {
    let state = made();
    let parameters = Parameters {
        radius: 0.02,
        ..Parameters::default()
    };
    let plane = NestedPlane::new(&parameters, 4, &mut Unobserved).unwrap();
    let nested = plane.whole(&mut Unobserved).unwrap();
    assert_eq!(session(&state).run().points(), nested.points());
    assert_eq!(ends(&state), nested.ends());
    assert!(verdict(&state).valid());
    assert_eq!(
        state.runs().first.cursor(),
        Some((nested.points().len(), nested.points().len()))
    );
    assert_eq!(state.form().remark(&state.runs().first, state.gpu()), None);
}

#[test]
fn a_prefix_is_moved_by_levels_and_samples_and_typed() {
    let mut state = made();
    let ends = ends(&state);
    let prefix = |state: &State| state.runs().first.prefix().unwrap();
    time(&mut state, TimeCommand::FirstStage);
    assert_eq!(prefix(&state), ends[0]);
    time(&mut state, TimeCommand::StepForward);
    assert_eq!(prefix(&state), ends[1]);
    time(&mut state, TimeCommand::Clock(Clock::Event));
    time(&mut state, TimeCommand::StepForward);
    assert_eq!(prefix(&state), ends[1] + 1);
    let shown = state.runs().first.shown().unwrap();
    assert_eq!(shown.standing(ends[1] as u32), Standing::Valid);
    assert_eq!(shown.standing(ends[1] as u32 + 1), Standing::Absent);
    for (asked, found) in [(0, 1), (7, 7), (1 << 40, 7), (ends[3], ends[3])] {
        time(&mut state, TimeCommand::Jump(asked));
        assert_eq!(prefix(&state), found);
    }
    time(&mut state, TimeCommand::Clock(Clock::Stage));
    time(&mut state, TimeCommand::StepBack);
    assert_eq!(prefix(&state), ends[2]);
    time(&mut state, TimeCommand::ShowStage(3));
    // Playing begins with one sample and ends with all.
    time(&mut state, TimeCommand::TogglePlay);
    assert_eq!(prefix(&state), 1);
    for _ in 0..400 {
        state.advance(0.1);
    }
    assert_eq!(
        (prefix(&state), state.time().playback.is_playing()),
        (ends[3], false)
    );
}

#[test]
fn every_verdict_names_its_prefix_and_levels_hold_what_they_promise() {
    let mut state = made();
    let radius = session(&state).run().domain.radius();
    let ends = ends(&state);
    for (count, distance, covering) in [
        (1, 2.83, None),
        (ends[0], 2.83, Some(2.83)),
        (ends[0] + 1, 2.0, Some(2.83)),
        (ends[2] + 300, 1.0, Some(1.41)),
        (ends[3], 1.0, Some(1.0)),
    ] {
        time(&mut state, TimeCommand::Jump(count));
        assert_eq!(state.runs().first.prefix_at_work(), Some(count));
        state.settle();
        let found = verdict(&state);
        assert!(found.valid(), "{count}: {found:?}");
        assert_eq!(found.report.count, count);
        let claim = found.claim.unwrap();
        let near = |a: f64, b: f64| (a / radius - b).abs() < 0.01;
        assert!(near(claim.distance, distance), "{count}");
        match (claim.covering, covering) {
            (Some(found), Some(expected)) => assert!(near(found, expected), "{count}"),
            (found, expected) => assert_eq!(found, expected),
        }
    }
    // A verdict stays until there is the next one, under its own number.
    time(&mut state, TimeCommand::Jump(ends[1]));
    assert_eq!(
        state.runs().first.verdict().unwrap().claim.unwrap().count,
        ends[3]
    );
    state.apply(Command::View(
        Which::First,
        ViewCommand::FlyToWitness(Witness::ClosestPair),
    ));
    assert_eq!(state.runs().first.prefix(), Some(ends[3]));
}

#[test]
fn verdicts_come_while_the_prefix_moves() {
    let mut state = made();
    let mut judged = std::collections::BTreeSet::new();
    for count in (1..=ends(&state)[3]).rev().step_by(3) {
        time(&mut state, TimeCommand::Jump(count));
        state.advance(0.016);
        std::thread::sleep(std::time::Duration::from_millis(2));
        judged.extend(
            state
                .runs()
                .first
                .verdict()
                .and_then(|verdict| verdict.claim)
                .map(|c| c.count),
        );
    }
    assert!(judged.len() > 3, "{judged:?}");
}

#[test]
fn a_sample_of_a_finer_level_among_the_first_is_found() {
    let mut state = made();
    let [first, .., all] = ends(&state)[..] else {
        panic!("four levels");
    };
    // The same set, but for the order of two samples.
    let mut run = session(&state).run().clone();
    run.samples.points.swap(first / 2, all - 1);
    let levels = session(&state).nested.clone().unwrap();
    for (is_spoilt, judged) in [(false, " Verified."), (true, " This is not so.")] {
        if is_spoilt {
            state.show(
                Which::First,
                Session::from_levels(run.clone(), levels.clone(), 77),
            );
        }
        time(&mut state, TimeCommand::Jump(first));
        assert_eq!(state.runs().first.prefix_verdict(), " Verifying.");
        state.settle();
        assert_eq!(verdict(&state).valid(), !is_spoilt);
        assert_eq!(state.runs().first.prefix_verdict(), judged);
    }
    time(&mut state, TimeCommand::LastStage);
    state.settle();
    assert!(verdict(&state).valid());
}

#[test]
fn exactly_so_many_samples_are_made_and_exported_as_promised() {
    let mut state = made();
    form(&mut state, FormCommand::Exactly("none".to_owned()));
    let refusal = state.form().refusal(state.gpu()).unwrap();
    assert!(refusal.contains("not a whole number"), "{refusal}");
    form(&mut state, FormCommand::Exactly("1,000".to_owned()));
    form(&mut state, FormCommand::Choose(Choice::Levels(Some(1))));
    let refusal = state.form().refusal(state.gpu()).unwrap();
    assert!(refusal.contains("at least 2 levels"), "{refusal}");
    form(&mut state, FormCommand::Choose(Choice::Levels(Some(4))));
    form(
        &mut state,
        FormCommand::Choose(Choice::Within(WithinLevel::Farthest)),
    );
    state.apply(Command::Run);
    state.settle();
    assert_eq!(state.form().remark(&state.runs().first, state.gpu()), None);
    assert_eq!(session(&state).summary.count, 1_000);
    let nesting = NestedRequest {
        levels: 4,
        exactly: Some(1_000),
        order_within: WithinLevel::Farthest,
    };
    assert_eq!(session(&state).recipe().nested, Some(nesting));
    // The set ends within its last level: it is not maximal for its radius, and need not be.
    let found = verdict(&state);
    assert!(found.valid() && found.report.covering_radius > found.claim.unwrap().distance);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("exact.ply");
    write(&mut state, ExportKind::Result, &path, &[]);
    let notice = state.messages().notice.as_ref().unwrap();
    assert!(!notice.is_error, "{}", notice.text);
    let certificate = certificate(&path);
    assert!(certificate.levels.iter().all(|level| level.valid) && !certificate.valid);
    assert_eq!(certificate.parameters["exactly"], 1_000);
}

fn certificate(path: &Path) -> Certificate {
    let beside = tilescope_formats::certificate_path(path);
    Certificate::from_bytes(&std::fs::read(beside).unwrap(), "certificate").unwrap()
}

#[test]
fn an_exported_prefix_keeps_its_order_and_opens_as_levels() {
    let mut state = made();
    let original = Arc::clone(session(&state));
    let count = ends(&state)[1] + 50;
    time(&mut state, TimeCommand::Jump(count));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("prefix.csv");
    write(&mut state, ExportKind::Samples, &path, &[]);
    let text = std::fs::read_to_string(&path).unwrap();
    let column = |number| -> Vec<&str> {
        let cells = text.lines().map(|line| line.split(',').nth(number));
        cells.map(Option::unwrap).collect()
    };
    let levels = column(2);
    assert_eq!((levels[0], levels[1], levels[count]), ("level", "0", "2"));
    // The ranks of a prefix are those of the run, whose radius its certificate states.
    let ranks = column(3);
    let last = original.nested.as_ref().unwrap().ranks[count - 1].to_string();
    assert_eq!((ranks[0], ranks[count]), ("rank", last.as_str()));
    let stated = certificate(&path);
    assert_eq!(stated.levels.len(), 3);
    assert_eq!(stated.parameters["moment"]["prefix"], count);
    state.apply(Command::File(FileCommand::Dropped(vec![
        path.display().to_string(),
    ])));
    state.settle();
    let opened = Arc::clone(session(&state));
    assert_eq!(opened.run().points(), original.run().points()[..count]);
    assert_eq!(
        opened.ends(),
        [ends_of(&original)[0], ends_of(&original)[1], count]
    );
    assert!(verdict(&state).valid());
    assert!(
        state
            .form()
            .remark(&state.runs().first, state.gpu())
            .unwrap()
            .contains("file")
    );
    let link = state.link();
    assert_eq!(link.left_out, ["the nested levels, which come from a file"]);
    assert!(!link.fragment.contains("at="), "{}", link.fragment);
    // A spoilt certificate is refused in words.
    let beside = tilescope_formats::certificate_path(&path);
    let text = std::fs::read_to_string(&beside).unwrap();
    let mut value: serde_json::Value = serde_json::from_str(&text).unwrap();
    value["levels"][1]["count"] = 1.into();
    std::fs::write(&beside, value.to_string()).unwrap();
    state.apply(Command::File(FileCommand::Dropped(vec![
        path.display().to_string(),
    ])));
    state.settle();
    assert!(
        notice_text(&state).contains("do not fit"),
        "{}",
        notice_text(&state)
    );
    assert!(Arc::ptr_eq(session(&state), &opened));
}

fn ends_of(session: &Session) -> Vec<usize> {
    session.ends()
}

#[test]
fn a_link_leads_to_the_same_prefix() {
    let mut state = made();
    form(&mut state, FormCommand::Exactly("1500".to_owned()));
    let farthest = Choice::Within(WithinLevel::Farthest);
    form(&mut state, FormCommand::Choose(farthest));
    state.apply(Command::Run);
    state.settle();
    time(&mut state, TimeCommand::Jump(400));
    let link = state.link();
    assert_eq!(link.left_out, Vec::<String>::new());
    assert!(
        link.fragment
            .contains("levels=4&exactly=1500&order-within=farthest&at=400"),
        "{}",
        link.fragment
    );
    let mut other = State::new(Arc::new(|| {}));
    other.settle();
    other.open_link(&link.fragment);
    other.settle();
    assert_eq!(
        session(&other).run().points(),
        session(&state).run().points()
    );
    assert_eq!(other.runs().first.cursor(), Some((400, 1_500)));
    assert_eq!(other.form().draft.nesting(), state.form().draft.nesting());
    assert_eq!(other.link(), link);
    assert!(other.messages().notice.is_none());
    // Opening it again makes nothing anew.
    let before = Arc::clone(session(&other));
    other.open_link(&link.fragment);
    other.settle();
    assert!(Arc::ptr_eq(session(&other), &before));
    // The radius that was typed is not used, and not one that a link may ask for.
    form(
        &mut other,
        FormCommand::Type(Parameter::Radius, "0.0001".to_owned()),
    );
    other.apply(Command::Run);
    other.settle();
    let unused = other.link();
    assert_eq!(unused.left_out, Vec::<String>::new());
    let before = Arc::clone(session(&other));
    other.open_link(&unused.fragment);
    other.settle();
    assert!(Arc::ptr_eq(session(&other), &before));
    assert!(other.messages().notice.is_none());
    assert_eq!(other.link(), unused);
    // Levels have no stages.
    other.open_link(&format!("{}&stage=finish", unused.fragment));
    other.settle();
    assert_eq!(other.runs().first.cursor(), Some((1_500, 1_500)));
    // A link to a run leads back from levels.
    other.open_link("v=1&radius=0.02");
    other.settle();
    assert!(session(&other).nested.is_none() && other.form().draft.levels.is_none());
}

#[test]
fn a_link_leads_to_the_samples_below_a_rank() {
    let mut state = State::new(Arc::new(|| {}));
    state.settle();
    state.open_link("levels=3&radius=0.02&rank=0.5");
    state.settle();
    let ends = ends_of(session(&state));
    // Below a half are the samples of the last level but one, and a link to this moment names their number.
    assert_eq!(state.runs().first.cursor(), Some((ends[1], ends[2])));
    assert!(state.link().fragment.contains(&format!("at={}", ends[1])));
    assert!(state.messages().notice.is_none());

    // Not every number is a rank, and a run has none.
    let (_, warnings) = tilescope_workbench::link::read("levels=3&rank=1.5");
    assert!(warnings.text().contains("rank"), "{}", warnings.text());
    state.open_link("radius=0.02&rank=0.5");
    state.settle();
    assert!(
        notice_text(&state).contains("have ranks"),
        "{}",
        notice_text(&state)
    );
}

#[test]
fn a_link_to_a_combination_leaves_out_the_levels_that_are_typed() {
    let mut state = State::new(Arc::new(|| {}));
    state.settle();
    state.open_link("combine=nine");
    state.settle();
    let link = state.link();
    assert!(link.fragment.contains("combine=nine"), "{}", link.fragment);
    form(&mut state, FormCommand::Choose(Choice::Levels(Some(4))));
    assert_eq!(state.link(), link);
}

#[test]
fn levels_that_cannot_be_made_are_left_out_of_a_link() {
    for (text, why) in [
        ("levels=11&radius=0.02", "levels"),
        ("levels=0", "levels"),
        ("levels=many", "levels \"many\" is invalid"),
        ("levels=3&exactly=99999999999", "that a link may ask for"),
        ("levels=1&exactly=1000", "at least 2 levels"),
        ("exactly=1000", "not how many"),
        ("order-within=farthest", "not how many"),
        ("levels=4&insertion=uniform", "insertion"),
    ] {
        let (content, warnings) = tilescope_workbench::link::read(text);
        assert_eq!(content.nested, None, "{text}");
        assert!(warnings.text().contains(why), "{text}: {}", warnings.text());
    }
    // A wrong part leaves the others.
    let (content, warnings) = tilescope_workbench::link::read("levels=3&order-within=nearest");
    assert_eq!(content.nested.map(|nested| nested.levels), Some(3));
    assert!(warnings.text().contains("nearest"));
    // More samples than there are.
    let mut state = State::new(Arc::new(|| {}));
    state.settle();
    state.open_link("levels=3&exactly=1000&at=2000");
    state.settle();
    assert_eq!(state.runs().first.cursor(), Some((1_000, 1_000)));
    assert!(notice_text(&state).contains("sample 2000 of a set of 1,000"));
}

#[test]
fn undo_leads_back_to_the_run_and_redo_to_the_levels() {
    let mut state = made();
    state.apply(Command::Undo);
    state.settle();
    assert!(session(&state).nested.is_none() && state.form().draft.levels.is_none());
    state.apply(Command::Redo);
    state.settle();
    assert!(session(&state).nested.is_some());
    assert_eq!(state.form().draft.levels, Some(4));
}

/// Nested levels have no events, so that a run diverges from them at a stage.
#[test]
fn both_of_two_runs_go_to_the_stage_at_which_they_diverge() {
    let mut state = made();
    form(&mut state, FormCommand::Choose(Choice::Levels(None)));
    let comparing = [
        CompareCommand::Start(ComparePreset::Typed),
        CompareCommand::LinkPlayback(false),
    ];
    for command in comparing {
        state.apply(Command::Compare(command));
        state.settle();
    }

    let second = |state: &State| state.runs().get(Which::Second).unwrap().cursor();
    let (at, end) = second(&state).unwrap();
    assert_eq!(at, end);
    state.apply(Command::Compare(CompareCommand::GoToDivergence));
    let (at, _) = second(&state).unwrap();
    assert!(at < end, "{at}");
}

#[test]
fn what_nested_levels_lack_is_refused_in_words() {
    let mut state = made();
    let refusals = [
        state.gpu().passes_refusal(&state.runs().first),
        state
            .runs()
            .preset_refusal(ComparePreset::NextSeed, state.form(), state.gpu()),
        state.runs().first.save_refusal().map(str::to_owned),
        ExportSource::of(&state)
            .kind_refusal(ExportKind::Animation)
            .map(|why| why.to_string()),
    ];
    for refusal in refusals {
        assert!(refusal.unwrap().to_lowercase().contains("nested levels"));
    }
    let subject = state.runs().subject(Which::First, state.appearance(), None);
    let layers = subject.unwrap().layers;
    assert!(layers.has(Layer::Samples) && !layers.has(Layer::Gaps));
    // Too many levels for the domain, and a choice that nested levels do not have.
    form(&mut state, FormCommand::Choose(Choice::Levels(Some(11))));
    assert!(
        state
            .form()
            .refusal(state.gpu())
            .unwrap()
            .contains("levels")
    );
    form(&mut state, FormCommand::Choose(Choice::Levels(Some(4))));
    let uniform = Choice::Parameter(
        Parameter::Insertion,
        json!(tilescope_core::Insertion::Uniform),
    );
    form(&mut state, FormCommand::Choose(uniform));
    assert!(
        state
            .form()
            .refusal(state.gpu())
            .unwrap()
            .contains("insertion")
    );
}

#[test]
fn cancelled_levels_leave_the_session() {
    let mut state = State::new(Arc::new(|| {}));
    state.settle();
    let before = session(&state).generation;
    form(&mut state, FormCommand::Choose(Choice::Levels(Some(6))));
    state.apply(Command::Run);
    state.apply(Command::Cancel(Which::First));
    state.settle();
    assert_eq!(session(&state).generation, before);
    assert!(notice_text(&state).contains("Cancelled"));
    assert!(matches!(
        state.runs().first.verification,
        Verification::Done(_)
    ));
}

#[test]
fn disks_of_a_prefix_cover_the_domain() {
    let mut state = made();
    let ends = ends(&state);
    time(&mut state, TimeCommand::Jump(ends[1] + 7));
    let shown = state.runs().first.shown().unwrap();
    let run = shown.session.run();
    let radius = shown.disk_radius() * run.domain.radius();
    let points = run
        .domain
        .users_from_lattice(&run.samples.points[..ends[1] + 7]);
    let [width, height] = run.domain.size();
    let region = Region {
        width,
        height,
        boundary: tilescope_analysis::Boundary::Periodic,
    };
    let options = tilescope_analysis::VerifyOptions::default();
    let go_on = |_| std::ops::ControlFlow::Continue(());
    let judged = |radius| tilescope_analysis::verify(&points, region, radius, &options, &go_on);
    assert!(judged(radius).unwrap().maximal());
    assert!(!judged(0.9 * radius).unwrap().maximal());
}
