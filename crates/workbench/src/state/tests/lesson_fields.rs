//! Lessons in a field of radii in the state: steps show the field's set, up to an open question, and what is made without the coin
//! has no recipe.

use tilescope_classroom::lessons::LessonCommand;
use tilescope_session::layers::SessionKind;

use super::*;

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
