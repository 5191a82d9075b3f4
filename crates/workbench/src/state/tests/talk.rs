//! Presenter mode in the state.

use tilescope_classroom::lessons::LessonCommand;
use tilescope_classroom::talk::{Cover, Talk, TalkCommand, advised};
use tilescope_lessons::{DraftCommand, Question, Vote, shipped};
use tilescope_session::combination::CombineCommand;

use super::*;
use crate::scenes::{SceneCommand, SceneList};
use tilescope_lessons::{Advice, RightShare};

fn talk(state: &mut State, command: TalkCommand) {
    state.apply(Command::Talk(command));
    state.settle();
}

fn presented(name: &str) -> State {
    let mut state = settled();
    state.classroom.lessons.now = 1_000.0;
    state.apply(Command::Lesson(LessonCommand::Open(name.to_owned())));
    state.settle();
    talk(&mut state, TalkCommand::Lesson { from_start: true });
    state
}

fn step(state: &State) -> usize {
    state
        .classroom
        .lessons
        .open
        .as_ref()
        .unwrap()
        .learner
        .index()
}

fn open(state: &State) -> &Talk {
    state.classroom.talks.open.as_ref().unwrap()
}

fn to_question(state: &mut State) {
    while state.classroom.lessons.open_question().is_none() {
        talk(state, TalkCommand::Next);
    }
}

#[test]
fn next_asks_for_votes_then_reveals_then_goes_on_and_records_nothing() {
    let mut state = presented("survivors");
    to_question(&mut state);
    let at = step(&state);
    talk(&mut state, TalkCommand::Next);
    assert!(open(&state).is_voting && state.classroom.lessons.open_question().is_some());
    assert_eq!(
        state.classroom.lessons.veil(),
        state.runs.first.cursor().map(|(_, len)| len)
    );
    talk(&mut state, TalkCommand::Next);
    assert!(state.classroom.lessons.open_question().is_none() && step(&state) == at);
    talk(&mut state, TalkCommand::Next);
    assert_eq!(step(&state), at + 1);
    talk(&mut state, TalkCommand::Previous);
    assert_eq!(step(&state), at);
    assert!(state.classroom.lessons.results.entries.is_empty());
}

#[test]
fn a_blank_stage_is_shown_again_by_next() {
    let mut state = presented("survivors");
    talk(&mut state, TalkCommand::Blank);
    talk(&mut state, TalkCommand::Next);
    assert!(open(&state).cover.is_none() && step(&state) == 0);
}

#[test]
fn votes_are_two_for_a_question_and_advise() {
    let mut state = presented("survivors");
    to_question(&mut state);
    let key = state.classroom.talk_key();
    for text in ["A 3 B 1", "half", "1 30 2"] {
        talk(&mut state, TalkCommand::Vote(text.to_owned()));
    }
    let votes = state.classroom.talks.record.votes_on(&key);
    assert_eq!(
        votes,
        [Vote::Counts(vec![3, 1, 0]), Vote::Counts(vec![1, 30, 2])]
    );
    let question = state
        .classroom
        .lessons
        .open_question()
        .and_then(Question::right_option);
    assert!(advised(votes, question).is_some());
    talk(&mut state, TalkCommand::Unvote);
    talk(&mut state, TalkCommand::Vote("Z 4".to_owned()));
    assert!(open(&state).vote_fault.as_ref().unwrap().contains("A to C"));
    let few = [Vote::Right(RightShare::Few)];
    assert_eq!(advised(&few, None), Some(Advice::Explain));
    assert_eq!(advised(&[], None), None);
}

#[test]
fn the_lecture_is_fifty_minutes_and_goes_from_lesson_to_lesson_and_back() {
    let mut state = settled();
    talk(&mut state, TalkCommand::Lecture);
    let [_, _, all] = open(&state).planned_secs(0);
    assert!((all - 3_000.0).abs() < 1e-6, "{all}");
    assert_eq!(open(&state).parts.len(), shipped::LECTURE.len());
    while open(&state).part == 0 {
        talk(&mut state, TalkCommand::Next);
    }
    let [before, ..] = open(&state).planned_secs(0);
    assert!((before - 240.0).abs() < 1e-6);
    talk(&mut state, TalkCommand::Previous);
    assert_eq!(open(&state).part, 0);
    let last = state
        .classroom
        .lessons
        .open
        .as_ref()
        .unwrap()
        .learner
        .lesson()
        .steps
        .len()
        - 1;
    assert_eq!(step(&state), last);
    talk(&mut state, TalkCommand::First);
    assert_eq!((open(&state).part, step(&state)), (0, 0));
}

#[test]
fn lines_belong_to_their_step_and_are_kept_only_on_request() {
    let mut state = presented("survivors");
    for at in [[1.0, 1.0], [2.0, 2.0]] {
        talk(&mut state, TalkCommand::Draw(at));
    }
    talk(&mut state, TalkCommand::Lift);
    talk(&mut state, TalkCommand::NextColor);
    talk(&mut state, TalkCommand::Draw([3.0, 3.0]));
    talk(&mut state, TalkCommand::Draw([f64::NAN, 3.0]));
    let colors: Vec<usize> = state
        .classroom
        .strokes()
        .iter()
        .map(|stroke| stroke.color)
        .collect();
    assert_eq!(colors, [0, 1]);
    assert_eq!(
        state.classroom.strokes()[0].points,
        [[1.0, 1.0], [2.0, 2.0]]
    );
    talk(&mut state, TalkCommand::UndoStroke);
    assert_eq!(state.classroom.strokes().len(), 1);
    talk(&mut state, TalkCommand::Next);
    assert!(state.classroom.strokes().is_empty());
    let saved = |state: &State| SaveTask::of(state).run.unwrap().view.get("talk").cloned();
    assert_eq!(saved(&state), None);
    talk(&mut state, TalkCommand::Keep(true));
    let view = serde_json::json!({ "talk": saved(&state).unwrap() });
    let mut other = settled();
    other.classroom.take_record(&view);
    assert_eq!(other.classroom.talks.record, state.classroom.talks.record);
    other
        .classroom
        .take_record(&serde_json::json!({ "talk": 7 }));
    assert_eq!(other.classroom.talks.record, state.classroom.talks.record);

    // A saved combination keeps them, too.
    other.apply(Command::Combine(CombineCommand::Nine));
    other.settle();
    let combination = SaveTask::of(&other).combination.unwrap();
    assert_eq!(combination.view["talk"], view["talk"]);
}

#[test]
fn scenes_are_presented_and_the_session_comes_back() {
    let mut state = settled();
    for (event, caption) in [
        (5_000, "Tiling. It is half done.\n---\nSay why."),
        (12_000, ""),
    ] {
        state.apply(Command::Time(TimeCommand::Jump(event)));
        state.apply(Command::Scene(SceneCommand::Add));
        let last = SceneList::Own.scenes(&state.runs.first).len() - 1;
        state.apply(Command::Scene(SceneCommand::Caption(
            last,
            caption.to_owned(),
        )));
    }
    let before = (state.runs.first.cursor(), state.runs.first.camera);
    talk(&mut state, TalkCommand::Scenes);
    let learner = &state
        .classroom
        .lessons
        .open
        .as_ref()
        .expect("a lesson")
        .learner;
    assert_eq!(learner.step().title, "Tiling");
    assert_eq!(learner.step().notes, ["Say why."]);
    assert_eq!(state.runs.first.cursor().map(|(at, _)| at), Some(5_000));
    talk(&mut state, TalkCommand::Next);
    assert_eq!(state.runs.first.cursor().map(|(at, _)| at), Some(12_000));
    talk(&mut state, TalkCommand::End);
    assert!(state.classroom.lessons.open.is_none());
    assert_eq!((state.runs.first.cursor(), state.runs.first.camera), before);
    assert_eq!(SceneList::Own.scenes(&state.runs.first).len(), 2);
    assert!(state.runs.first.verdict().is_some());
}

#[test]
fn scenes_that_are_none_are_refused() {
    let mut state = settled();
    talk(&mut state, TalkCommand::Scenes);
    assert!(state.classroom.talks.open.is_none());
    let notice = &state.messages.notice.as_ref().expect("a notice").text;
    assert!(notice.contains("no scenes"), "{notice}");
}

#[test]
fn a_code_is_gone_when_the_answer_comes_and_a_frame_presents_nothing() {
    let mut state = presented("survivors");
    to_question(&mut state);
    talk(&mut state, TalkCommand::Next);
    talk(&mut state, TalkCommand::ToggleCode);
    assert_eq!(open(&state).cover, Some(Cover::Code));
    talk(&mut state, TalkCommand::Next);
    assert_eq!(open(&state).cover, None);
    talk(&mut state, TalkCommand::End);
    state.window.embedding = Some(crate::embedding::Embedding::Player);
    let answer = crate::remote::ask(&mut state, r#"{"do": "lesson", "act": "present"}"#);
    assert!(answer.contains("presents nothing"), "{answer}");
    assert!(state.classroom.talks.open.is_none());
}

#[test]
fn answers_in_and_after_a_talk_do_not_count() {
    let mut state = presented("survivors");
    to_question(&mut state);
    for _ in 0..2 {
        let question = state.classroom.lessons.open_question().expect("a question");
        let right = question.right_option().expect("a choice");
        for command in [
            LessonCommand::Draft(DraftCommand::Choose(right)),
            LessonCommand::Answer,
        ] {
            state.apply(Command::Lesson(command));
        }
        assert!(state.classroom.lessons.open_question().is_none());
        assert!(state.classroom.lessons.results.entries.is_empty());
        talk(&mut state, TalkCommand::End);
        state.apply(Command::Lesson(LessonCommand::Go("one-of-two".to_owned())));
        state.settle();
    }
}

#[test]
fn a_handout_with_answers_or_notes_is_refused_while_a_question_is_open() {
    let mut state = presented("survivors");
    to_question(&mut state);
    talk(&mut state, TalkCommand::End);
    for (answers, notes) in [(true, false), (false, true)] {
        let handout = TalkCommand::Handout {
            answers,
            notes,
            path: None,
        };
        state.apply(Command::Talk(handout));
        assert!(!state.classroom.talks.makes_handout());
    }
    let notice = &state.messages.notice.as_ref().expect("a notice").text;
    assert!(notice.contains("what comes next"), "{notice}");
}

/// The JSON for the notes has notes and answers; that for pages and scripts has neither.
#[test]
fn what_pages_are_told_holds_no_note_and_no_answer() {
    let mut state = presented("survivors");
    to_question(&mut state);
    let learner = &state.classroom.lessons.open.as_ref().unwrap().learner;
    let (note, answer) = (
        learner.step().notes[0].clone(),
        learner.right_answer(&str::to_owned).unwrap(),
    );
    let words: Vec<&str> = note.split(' ').take(3).collect();
    let told = state.classroom.talk_json(&state.runs.first.canvas_view());
    assert!(told["notes"].to_string().contains(&words.join(" ")));
    assert_eq!(told["answer"], answer);
    let state_told = crate::remote::to_json(&state);
    assert_eq!(state_told["lesson"], serde_json::Value::Null);
    assert!(!state_told.to_string().contains(&words.join(" ")));
    assert!(state.link().fragment.contains("lesson=survivors"));
}

#[test]
fn another_window_goes_on_where_the_first_one_was() {
    let mut state = presented("survivors");
    to_question(&mut state);
    talk(&mut state, TalkCommand::Vote("few".to_owned()));
    talk(&mut state, TalkCommand::Draw([1.0, 2.0]));
    let kept = serde_json::to_string(
        &state
            .classroom
            .kept_of_talk(&state.runs.first.canvas_view()),
    )
    .unwrap();
    let mut other = settled();
    other.classroom.lessons.now = 2_000.0;
    talk(&mut other, TalkCommand::Restore(kept));
    assert_eq!(other.classroom.talk_key(), state.classroom.talk_key());
    assert_eq!(other.classroom.talks.record, state.classroom.talks.record);
    assert!((open(&other).begun - 1_000.0).abs() < 1e-9);
    talk(&mut other, TalkCommand::Restore("nonsense".to_owned()));
    assert!(other.messages.notice.is_some_and(|notice| notice.is_error));
}

#[test]
fn another_window_shows_what_was_revealed_as_it_was_looked_at() {
    let mut state = presented("survivors");
    to_question(&mut state);
    for _ in 0..2 {
        talk(&mut state, TalkCommand::Next);
    }
    assert!(state.classroom.lessons.open_question().is_none());
    let zoomed = ViewCommand::FlyTo([9.0, 11.0].into(), 3.0);
    state.apply(Command::View(Which::First, zoomed));
    while state.advance(0.1) {}

    let kept = state
        .classroom
        .kept_of_talk(&state.runs.first.canvas_view());
    let mut other = settled();
    let text = serde_json::to_string(&kept).unwrap();
    talk(&mut other, TalkCommand::Restore(text));
    assert_eq!(other.classroom.talk_key(), state.classroom.talk_key());
    assert_eq!(
        other.runs.first.cursor(),
        state.runs.first.cursor(),
        "the deciding event"
    );
    assert!(other.classroom.lessons.open_question().is_none());
    assert_eq!(other.runs.first.camera, state.runs.first.camera);
    assert!(other.classroom.lessons.results.entries.is_empty());

    // The next step begins as ever, and its camera is its own, which is not kept.
    for state in [&mut state, &mut other] {
        talk(state, TalkCommand::Next);
        assert!(state.classroom.lessons.open_question().is_some());
        assert_eq!(
            state
                .classroom
                .kept_of_talk(&state.runs.first.canvas_view())
                .camera,
            None
        );
    }

    // A camera that no window has is left out.
    let mut broken = kept;
    broken.camera.as_mut().unwrap().scale = -1.0;
    let text = serde_json::to_string(&broken).unwrap();
    talk(&mut other, TalkCommand::Restore(text));
    assert!(other.runs.first.camera.scale > 0.0);
    assert_eq!(
        other
            .classroom
            .kept_of_talk(&other.runs.first.canvas_view())
            .camera,
        None
    );
}

#[test]
fn a_form_takes_votes_reveals_nothing_and_keeps_the_first_vote_with_the_results() {
    let mut state = presented("before");
    to_question(&mut state);
    let concept = |state: &State| {
        let gate = state.classroom.lessons.learner()?.step().gate.as_ref()?;
        gate.concept
    };
    let first = concept(&state).expect("a question of the form");
    let question = state.classroom.lessons.open_question().expect("a question");
    let right = question.right_option().expect("a choice");
    let right = tilescope_lessons::letter(right);
    let vote = |state: &mut State, text: &str| talk(state, TalkCommand::Vote(text.to_owned()));
    vote(&mut state, "A 5 B 5 C 5 D 5");
    let shares = |state: &State| {
        let votes = state.classroom.lessons.results.votes.iter();
        votes
            .map(|vote| (vote.share, vote.count))
            .collect::<Vec<_>>()
    };
    assert_eq!(shares(&state), [(0.25, Some(20))]);

    // The vote after a discussion does not count, and one that was taken back is gone.
    vote(&mut state, &format!("{right} 20"));
    assert_eq!(shares(&state), [(0.25, Some(20))]);
    talk(&mut state, TalkCommand::Unvote);
    talk(&mut state, TalkCommand::Unvote);
    assert_eq!(shares(&state), []);
    vote(&mut state, &format!("{right} 20"));
    assert_eq!(shares(&state), [(1.0, Some(20))]);

    let at = state.runs.first.cursor();
    talk(&mut state, TalkCommand::Next);
    assert_eq!(
        (state.runs.first.cursor(), concept(&state)),
        (at, Some(first))
    );
    talk(&mut state, TalkCommand::Next);
    assert_ne!(concept(&state), Some(first), "the next question");
    assert!(state.classroom.lessons.results.entries.is_empty());

    // The control: votes on a lesson are not kept with the results.
    let mut state = presented("survivors");
    to_question(&mut state);
    vote(&mut state, "A 5 B 5");
    assert_eq!(shares(&state), []);
}

#[test]
fn the_picture_of_the_next_step_is_drawn_and_ends_with_the_last() {
    let mut state = presented("survivors");
    let picture = state
        .classroom
        .talks
        .next_picture
        .drawn()
        .expect("a picture");
    let pixels = picture.pixels.as_ref().expect("pixels");
    let first = &pixels.rgba[..4];
    assert!(pixels.rgba.chunks(4).any(|pixel| pixel != first));
    while open(&state).cover != Some(Cover::Over) {
        talk(&mut state, TalkCommand::Next);
    }
    assert!(state.classroom.talks.next_picture.drawn().is_none());
}

#[test]
fn closing_both_windows_ends_the_talk() {
    let mut state = presented("survivors");
    talk(&mut state, TalkCommand::StageClosed);
    assert!(state.classroom.talks.open.is_some());
    talk(&mut state, TalkCommand::NotesClosed);
    assert!(state.classroom.talks.open.is_none() && state.classroom.lessons.open.is_some());
}
