//! Lessons with nested levels in the state: the slider shows prefixes, an open question holds the levels up to its moment, and a
//! painted density leaves some of the samples.

use tilescope_classroom::lessons::LessonCommand;
use tilescope_session::layers::SessionKind;

use super::*;

const ASKED: &str = "---\ntitle: T\nobjective: O\n---\n# S\n```run\nradius: 0.03\nlevels: 3\nmoment: ranks below 0.25\n```\n\
                     ```gate g\ntype: number\nask: How many?\nanswer: 7\n```\n";

fn lesson(state: &mut State, command: LessonCommand) {
    state.apply(Command::Lesson(command));
    state.settle();
}

/// Returns how many samples are shown, and how many there are.
fn shown(state: &State) -> (usize, usize) {
    let run = &state.runs.first;
    assert_eq!(run.kind(), SessionKind::Nested);
    let (count, all) = run.cursor().expect("nested levels have a cursor");
    assert_eq!(run.prefix(), Some(count));
    (count, all)
}

/// Returns the number below which the ranks of the samples shown are, as it stands beside the slider.
fn threshold(state: &State) -> f64 {
    let texts = state
        .runs
        .first
        .moment_texts(state.lessons().veil().is_some());
    let text = texts.last().expect("a text of the moment");
    let number = text.strip_prefix("ranks below ");
    number
        .and_then(|number| number.parse().ok())
        .unwrap_or_else(|| panic!("{texts:?}"))
}

#[test]
fn the_slider_of_a_lesson_shows_prefixes_and_their_ranks() {
    let mut state = settled();
    lesson(&mut state, LessonCommand::Open("ranks".to_owned()));
    let (count, all) = shown(&state);
    assert_eq!((count, threshold(&state)), (all, 1.0));
    // Nothing is verified in a lesson.
    assert_eq!(state.runs.first.prefix_verdict(), "");

    state.apply(Command::Time(TimeCommand::Jump(100)));
    assert_eq!(shown(&state), (100, all));
    let session = state.runs.first.session.clone().unwrap();
    let nested = session.nested.as_ref().unwrap();
    assert_eq!(nested.below(threshold(&state)), Some(100));

    lesson(&mut state, LessonCommand::Go("twice-as-far".to_owned()));
    assert_eq!(
        (shown(&state).0, threshold(&state)),
        (nested.ends().nth(1).unwrap(), 0.25)
    );
}

#[test]
fn a_painted_density_leaves_some_of_the_samples() {
    let mut state = settled();
    lesson(&mut state, LessonCommand::Open("ranks".to_owned()));
    let (_, all) = shown(&state);
    lesson(
        &mut state,
        LessonCommand::Go("one-set-any-picture".to_owned()),
    );
    let (count, left) = shown(&state);
    assert!(count == left && left > all / 3 && left < all);
    // No parameters make such a set, so that nothing else is taken for it.
    let session = state.runs.first.session.clone().unwrap();
    assert!(!session.has_recipe());

    lesson(&mut state, LessonCommand::Go("a-set-in-order".to_owned()));
    assert_eq!(shown(&state), (all, all));
    assert!(state.runs.first.session.as_ref().unwrap().has_recipe());
}

#[test]
fn an_open_question_holds_the_levels_up_to_its_moment() {
    let mut state = settled();
    lesson(
        &mut state,
        LessonCommand::Read("t".to_owned(), ASKED.to_owned()),
    );
    let (count, all) = shown(&state);
    assert_eq!(count, all);
    state.apply(Command::Time(TimeCommand::Jump(all + 5)));
    assert_eq!(shown(&state), (all, all));

    // Giving up asks once whether to.
    lesson(&mut state, LessonCommand::GiveUp);
    assert_eq!(shown(&state), (all, all));
    lesson(&mut state, LessonCommand::GiveUp);
    let (count, whole) = shown(&state);
    assert!(count == all && whole > 3 * all, "{count} {whole}");
}

#[test]
fn no_text_of_the_moment_names_ranks_while_a_question_is_open() {
    let mut state = settled();
    lesson(&mut state, LessonCommand::Open("ranks".to_owned()));
    lesson(&mut state, LessonCommand::Go("fewer".to_owned()));
    let names_ranks = |state: &State| {
        let texts = state
            .runs
            .first
            .moment_texts(state.lessons().veil().is_some());
        assert!(texts.len() >= 2, "{texts:?}");
        texts.iter().any(|text| text.starts_with("ranks below"))
    };

    // The question asks how many samples have ranks below 0.3, which the slider would tell.
    let (_, all) = shown(&state);
    for count in [all, all / 3] {
        state.apply(Command::Time(TimeCommand::Jump(count)));
        assert!(!names_ranks(&state), "{count}");
    }

    // Giving up asks once whether to.
    lesson(&mut state, LessonCommand::GiveUp);
    assert!(!names_ranks(&state));
    lesson(&mut state, LessonCommand::GiveUp);
    assert!(names_ranks(&state));
}
