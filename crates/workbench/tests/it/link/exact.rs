//! Exact tilings in a window: chosen in the form, visited event by event, linked, saved, and compared with KDRT.

use serde_json::json;
use tilescope_core::{Parameter, Parameters, Stage, TilingMethod};
use tilescope_session::layers::SessionKind;
use tilescope_session::sentence::{name_in, stage_sentence};
use tilescope_workbench::command::{Command, FormCommand};
use tilescope_workbench::compare::{CompareCommand, ComparePreset};
use tilescope_workbench::draft::{Choice, Preset};
use tilescope_workbench::files::SaveTask;
use tilescope_workbench::link::read;
use tilescope_workbench::state::State;

use super::support::{digest, notice_text, opened, settle, state};

fn form(state: &mut State, command: FormCommand) {
    state.apply(Command::Form(command));
}

fn choose(state: &mut State, method: TilingMethod) {
    let choice = Choice::Parameter(Parameter::Method, json!(method));
    form(state, FormCommand::Choose(choice));
}

/// Returns a window with an exact tiling of some hundred samples.
fn exact() -> State {
    let mut state = state();
    let small = [
        (Parameter::Radius, "0.03"),
        (Parameter::Leaf, "8"),
        (Parameter::Seed, "3"),
    ];
    for (parameter, text) in small {
        form(&mut state, FormCommand::Type(parameter, text.to_owned()));
    }
    choose(&mut state, TilingMethod::Exact);
    state.apply(Command::Run);
    settle(&mut state);
    state
}

#[test]
fn the_form_gives_exact_tiling_its_own_pattern_and_takes_it_back() {
    let mut state = state();
    let kdrt = state.form().draft.parameters;
    choose(&mut state, TilingMethod::Exact);
    let draft = &state.form().draft;
    assert_eq!(draft.parameters.pattern, draft.parameters.usual_pattern());
    assert_eq!(draft.text(Parameter::PatternSide), "200");
    assert_eq!(draft.refusals(), []);

    // The pattern's seed follows, until another is typed.
    form(
        &mut state,
        FormCommand::Type(Parameter::Seed, "9".to_owned()),
    );
    assert_eq!(state.form().draft.parameters.pattern.seed, 9);
    let typed = FormCommand::Type(Parameter::PatternSeed, "4".to_owned());
    form(&mut state, typed);
    form(
        &mut state,
        FormCommand::Type(Parameter::Seed, "1".to_owned()),
    );
    assert_eq!(state.form().draft.parameters.pattern.seed, 4);
    let typed = FormCommand::Type(Parameter::PatternSeed, "1".to_owned());
    form(&mut state, typed);

    // A typed side stays, and is no choice of a seed.
    for (parameter, text) in [(Parameter::PatternSide, "300"), (Parameter::Seed, "7")] {
        form(&mut state, FormCommand::Type(parameter, text.to_owned()));
    }
    let pattern = state.form().draft.parameters.pattern;
    assert_eq!((pattern.side, pattern.seed), (300.0, 7));
    for (parameter, text) in [(Parameter::Seed, "1"), (Parameter::PatternSide, "200")] {
        form(&mut state, FormCommand::Type(parameter, text.to_owned()));
    }

    choose(&mut state, TilingMethod::Kdrt);
    assert_eq!(state.form().draft.parameters, kdrt);
}

#[test]
fn a_choice_without_meaning_is_refused_by_its_name() {
    let mut state = state();
    choose(&mut state, TilingMethod::Exact);
    let choice = Choice::Parameter(Parameter::Order, json!("index"));
    form(&mut state, FormCommand::Choose(choice));
    let refusals = state.form().draft.refusals();
    assert!(refusals[0].reason.contains("The order has no meaning"));
}

#[test]
fn an_exact_tiling_is_shown_with_its_levels_and_comes_back_from_link_and_file() {
    let state = exact();
    let session = state.runs().first.session.as_ref().expect("a session");
    assert_eq!(session.kind(), SessionKind::Exact);
    assert!(session.recording().is_some());
    assert_eq!(name_in(session, Stage::Iterate(1)), "Levels 0, 1");
    let sentence = stage_sentence(session, Stage::Iterate(2));
    assert!(
        sentence.starts_with("Level 2: darts thrown at "),
        "{sentence}"
    );

    // What a stage loses and brings adds up to what is there.
    let stages = &session.stages;
    let count = |index: usize| session.count_after(index);
    assert_eq!(count(stages.len() - 1), session.summary.count);
    let lost: usize = (0..stages.len())
        .filter(|&index| matches!(stages[index], Stage::Iterate(_)))
        .map(|index| session.lost_in(index))
        .sum();
    assert_eq!(lost, session.summary.eliminated);
    assert_eq!(count(stages.len() - 2), session.summary.count);

    let link = state.link();
    assert!(link.fragment.contains("method=exact"), "{}", link.fragment);
    assert!(!link.fragment.contains("pattern"), "{}", link.fragment);
    let there = opened(&link.fragment);
    assert_eq!(notice_text(&there), "");
    assert_eq!(digest(&there), digest(&state));

    let saved = SaveTask::of(&state).run.expect("a run");
    assert_eq!(saved.parameters.method, TilingMethod::Exact);
    let text = saved.to_json().expect("text");
    let read = tilescope_debugger::Session::from_json(&text).expect("a session");
    assert_eq!(read, saved);
}

#[test]
fn one_command_compares_it_with_kdrt_where_only_seams_differ() {
    let mut state = exact();
    let first = state.runs().first.session.as_ref().expect("a session");
    let parameters = first.run().parameters;
    state.apply(Command::Compare(CompareCommand::Start(
        ComparePreset::Method,
    )));
    settle(&mut state);

    let (side, _) = state.runs().second.as_ref().expect("a second run");
    let second = side.session.as_ref().expect("made");
    let expected = Parameters {
        method: TilingMethod::Kdrt,
        ..parameters
    };
    assert_eq!(second.run().parameters, expected);
    assert_ne!(second.digest(), digest(&state));
    let first = state.runs().first.session.as_ref().expect("a session");
    assert_eq!(first.run().blocks, second.run().blocks);

    // Both have the same samples deep in their blocks.
    let points = first.run().points();
    let shared = second.run().points().into_iter();
    let shared = shared.filter(|point| points.contains(point)).count();
    assert!(shared > points.len() / 3, "{shared} of {}", points.len());
    let link = state.link().fragment;
    let there = opened(&link);
    let (side, _) = there.runs().second.as_ref().expect("a second run");
    assert_eq!(
        side.session.as_ref().expect("made").digest(),
        second.digest()
    );
}

#[test]
fn the_preset_is_an_exact_tiling_of_the_first_session() {
    let parameters = Preset::Exact.parameters();
    assert_eq!(parameters.method, TilingMethod::Exact);
    assert_eq!(parameters.pattern, parameters.usual_pattern());
    assert!(parameters.validate_sequential().is_ok());

    // The next seed has the next pattern, as in the form.
    let next = ComparePreset::NextSeed.parameters(&parameters, &parameters);
    assert_eq!(next.pattern, next.usual_pattern());
    assert_ne!(next.pattern, parameters.pattern);
}

#[test]
fn a_link_to_a_set_by_darts_names_no_tiling() {
    let shape = "shape=0,0_1,0_1,1";
    for (asked, is_by_darts) in [
        ("depth=1", true),
        ("radius-expression=0.1%2B0.1*x", true),
        // Negative controls: a rectangle and a shape of one radius are tiled.
        ("seed=2", false),
        (shape, false),
    ] {
        let (content, warnings) = read(&format!("v=2&radius=0.1&method=exact&{asked}"));
        let said = warnings.sentences().concat();
        assert_eq!(!said.is_empty(), is_by_darts, "{asked}: {said}");
        assert_eq!(said.contains("method \"exact\""), is_by_darts, "{said}");
        let expected = if is_by_darts {
            Parameters::default().pattern
        } else {
            content.parameters.usual_pattern()
        };
        assert_eq!(content.parameters.pattern, expected, "{asked}");
        let is_kdrt = content.parameters.method == TilingMethod::Kdrt;
        assert_eq!(is_kdrt, is_by_darts, "{asked}");
    }

    // A second run is given by its differences from the link's parameters, also from a method that is left out.
    let (content, _) = read("v=2&radius=0.1&method=exact&depth=1&b=&b.seed=2");
    let second = content.view.second.expect("a second run");
    assert_eq!(second.method, TilingMethod::Exact);

    // A form where a third side is typed after the method leads to a link without a warning.
    let mut state = exact();
    form(&mut state, FormCommand::Depth("0.5".to_owned()));
    state.apply(Command::Run);
    settle(&mut state);
    let link = state.link();
    assert!(!link.fragment.contains("method"), "{}", link.fragment);
    assert!(!link.fragment.contains("pattern"), "{}", link.fragment);
    let there = opened(&link.fragment);
    assert_eq!(notice_text(&there), "");
    assert_eq!(digest(&there), digest(&state));
}
