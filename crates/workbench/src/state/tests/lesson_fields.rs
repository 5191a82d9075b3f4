//! Lessons in a field of radii and in space in the state: steps show the set, up to an open question, and what is made without the
//! coin has no recipe.

use tilescope_classroom::lessons::LessonCommand;
use tilescope_session::layers::SessionKind;

use super::*;
use crate::orbit::OrbitCommand;

fn lesson(state: &mut State, command: LessonCommand) {
    state.apply(Command::Lesson(command));
    state.settle();
}

fn go(state: &mut State, step: &str) {
    lesson(state, LessonCommand::Go(step.to_owned()));
    assert_eq!(
        state.runs.first.session.as_ref().unwrap().kind(),
        SessionKind::Varying
    );
}

/// Returns how many samples are shown.
fn shown(state: &State) -> usize {
    let shown = state.runs.first.shown().expect("a moment");
    shown.moment().covering(shown.session).len()
}

#[test]
fn steps_show_the_set_of_their_field_and_give_the_window_back() {
    let mut state = settled();
    let before = state.runs.first.session.as_ref().unwrap().recipe();
    lesson(&mut state, LessonCommand::Open("radii".to_owned()));
    let session = state.runs.first.session.clone().unwrap();
    assert_eq!(
        (session.kind(), shown(&state)),
        (SessionKind::Varying, session.summary.count)
    );
    let ground = session.ground.as_ref().expect("a field");
    assert!(
        ground.varies() && ground.radii_text().starts_with("1.000 to 3.5"),
        "{}",
        ground.radii_text()
    );

    // Nothing behind the moment of an open question is shown.
    go(&mut state, "near");
    let session = state.runs.first.session.clone().unwrap();
    assert!(session.is_cut_off_at(session.recording().unwrap().len()));
    assert!(shown(&state) > 100);
    lesson(&mut state, LessonCommand::Leave);
    assert_eq!(state.runs.first.session.as_ref().unwrap().recipe(), before);
}

#[test]
fn what_is_made_without_the_coin_has_no_recipe() {
    let mut state = settled();
    lesson(&mut state, LessonCommand::Open("radii".to_owned()));
    go(&mut state, "a-stripe");
    let uneven = state.runs.first.session.clone().unwrap();
    go(&mut state, "with-the-coin");
    let even = state.runs.first.session.clone().unwrap();
    assert!(!uneven.has_recipe() && even.has_recipe());
    assert_ne!(uneven.positions_digest(), even.positions_digest());

    // The set with the coin is the one that the program makes of its recipe.
    let recipe = even.ground.as_ref().unwrap().recipe();
    let made = recipe.make(&mut tilescope_core::Unobserved).expect("a set");
    assert_eq!(made.set.points, even.run().positions());
}

#[test]
fn steps_show_the_plane_of_their_box_and_nothing_behind_an_open_question() {
    let mut state = settled();
    let before = state.runs.first.session.as_ref().unwrap().recipe();
    lesson(&mut state, LessonCommand::Open("space".to_owned()));
    let run = &state.runs.first;
    let session = run.session.clone().unwrap();
    assert_eq!(session.kind(), SessionKind::Solid);
    assert_eq!(run.plane_place(), Some((10.0, 5.0)));
    assert_eq!(session.recipe().depth, Some(10.0));
    let whole = session.summary.count;
    let made = session.solid.as_ref().unwrap();
    assert_eq!(
        made.count_cut_of(usize::MAX, made.middle()),
        made.count_cut(made.middle())
    );

    // Balls that were shown before give way to the plane that the question is about.
    let balls = ViewCommand::Orbit(OrbitCommand::Show(true));
    state.apply(Command::View(Which::First, balls));
    assert!(state.runs.first.orbit().is_some());
    lesson(&mut state, LessonCommand::Go("refuses".to_owned()));
    let run = &state.runs.first;
    assert!(run.orbit().is_none());

    // The plane is at the dart of the question, whose samples alone are there: neither events nor heights tell of later ones.
    let session = run.session.clone().unwrap();
    let open = state.lessons().open.as_ref().unwrap();
    let asked = open.learner.scene().unwrap();
    let next = asked.recording().event(asked.cursor()).unwrap();
    assert_eq!(run.plane(), asked.recording().event_height(next));
    assert!(session.is_cut_off_at(session.recording().unwrap().len()));
    let samples = session.run().samples.len();
    assert!(samples > 100 && samples < whole);
    assert_eq!(
        session.recording().unwrap().heights().map(<[i32]>::len),
        Some(samples)
    );

    // A step without a plane of its own follows the events.
    lesson(&mut state, LessonCommand::Go("follow-it".to_owned()));
    assert_eq!(state.runs.first.follows_events(), Some(true));
    lesson(&mut state, LessonCommand::Leave);
    assert_eq!(state.runs.first.session.as_ref().unwrap().recipe(), before);
}
