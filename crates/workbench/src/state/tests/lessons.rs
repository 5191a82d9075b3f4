//! Lessons in the state.

use tilescope_classroom::lesson_labels::lesson_labels;
use tilescope_classroom::lessons::{LessonCommand, WantedLesson};
use tilescope_debugger::{Direction, Recording};
use tilescope_session::layers::Layers;
use tilescope_session::selection::Selection;

use super::*;
use crate::command::{DebugCommand, LinkCommand};
use crate::files::{Delivery, FileCommand, NamedBytes, Purpose};
use crate::layout::Panel;
use crate::scenes::SceneCommand;
use glam::DVec2;
use tilescope_lessons::package::CourseSystem;
use tilescope_lessons::results::Results;
use tilescope_lessons::shipped::{Loaded, TEMPLATE, to_json};
use tilescope_lessons::{Answer, Control, DraftCommand, MarkKind};
use tilescope_session::language::Language;
use tilescope_session::units::position;

/// Returns the camera that somebody has chosen since the step was shown.
fn chosen_camera(state: &State) -> Option<tilescope_drawing::camera::Camera> {
    let canvas = state.runs.first.canvas_view();
    state.classroom.chosen_camera(&canvas)
}

fn lesson(state: &mut State, command: LessonCommand) {
    state.apply(Command::Lesson(command));
    state.settle();
}

/// A state with the template's question open.
fn asked() -> State {
    let mut state = settled();
    lesson(
        &mut state,
        LessonCommand::Read("template".to_owned(), TEMPLATE.to_owned()),
    );
    lesson(&mut state, LessonCommand::Step(Direction::Forwards));
    assert!(state.classroom.lessons.open_question().is_some());
    state
}

fn whole(state: &State) -> Arc<Recording> {
    Arc::clone(
        state
            .classroom
            .lessons
            .open
            .as_ref()
            .unwrap()
            .run
            .as_ref()
            .unwrap(),
    )
}

/// The option that is right, and one that is not.
fn options(state: &State) -> [usize; 2] {
    let question = state.classroom.lessons.open_question().unwrap();
    let right = question.right_option().expect("a choice");
    [right, usize::from(right == 0)]
}

fn choose(state: &mut State, option: usize) {
    lesson(state, LessonCommand::Draft(DraftCommand::Choose(option)));
    lesson(state, LessonCommand::Answer);
}

#[test]
fn a_place_that_a_question_is_about_is_marked() {
    let marked = |mark: &str| {
        let mut state = settled();
        let run = "radius: 0.06\nleaf: 6\nmoment: end of tile\n";
        let gate = "type: number\nask: How many?\nanswer: samples()\n";
        let text = format!(
            "---\ntitle: T\nobjective: O\n---\n# S\n```run\n{run}```\n```gate g\n{gate}{mark}```\n"
        );
        lesson(&mut state, LessonCommand::Read("t".to_owned(), text));
        let marks = state.classroom.lessons.open.as_ref().unwrap().marks();
        marks.iter().map(|mark| mark.at.x).collect::<Vec<f64>>()
    };
    let close = |a: Vec<f64>, b: &[f64]| {
        assert_eq!(a.len(), b.len(), "{a:?}");
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9), "{a:?}");
    };
    close(marked("mark: [4.0, 5.0]\n"), &[4.0]);
    close(marked("mark: [[4.0, 5.0], [6.5, 7.0]]\n"), &[4.0, 6.5]);
    // The control: without the field nothing is marked.
    close(marked(""), &[]);
}

#[test]
fn a_question_is_answered_wrongly_then_rightly_and_the_first_try_scores() {
    let mut state = asked();
    let [right, wrong] = options(&state);
    let cursor = state.runs.first.cursor().unwrap().0;
    choose(&mut state, wrong);
    let open = state.classroom.lessons.open.as_ref().unwrap();
    assert!(
        open.learner.is_open()
            && open
                .feedback
                .as_ref()
                .is_some_and(|said| said.sentence.is_some())
    );
    assert!(state.classroom.lessons.results.entries.is_empty());
    choose(&mut state, right);
    let open = state.classroom.lessons.open.as_ref().unwrap();
    assert!(!open.learner.is_open() && !open.reasons().is_empty());
    // The deciding event is shown, in the whole run.
    let (now, len) = state.runs.first.cursor().unwrap();
    assert!(now > cursor && len == whole(&state).len());
    let entries = &state.classroom.lessons.results.entries;
    assert_eq!(
        (entries.len(), entries[0].score, entries[0].tries),
        (1, 0.0, 2)
    );
    // The same question with another run.
    lesson(&mut state, LessonCommand::Practise(5));
    assert!(state.classroom.lessons.open_question().is_some());
    assert_ne!(whole(&state).run().parameters.seed, 1);
}

#[test]
fn results_are_stored_at_the_answer_merged_with_those_of_another_window() {
    let mut state = asked();
    state.classroom.lessons.now = 100.0;
    assert!(!state.classroom.lessons.has_unstored_results());
    let [right, wrong] = options(&state);
    choose(&mut state, wrong);
    choose(&mut state, right);
    assert!(state.classroom.lessons.has_unstored_results());
    // Another window answered another question since this one began.
    let mut other = state.classroom.lessons.results.clone();
    other.entries[0].gate = "other".to_owned();
    other.learner = "Ada".to_owned();
    let stored = state
        .classroom
        .lessons
        .store_results(Some(&other.to_json()));
    assert!(!stored.unreadable && !state.classroom.lessons.has_unstored_results());
    let read = Results::read(&stored.text).unwrap();
    assert_eq!((read.entries.len(), read.learner.as_str()), (2, "Ada"));
    assert_eq!(state.classroom.lessons.results, read);
    // A damaged store is reported, and the results of this window stay.
    let stored = state.classroom.lessons.store_results(Some("{"));
    assert!(stored.unreadable && Results::read(&stored.text).unwrap() == read);
    // A name that is given here replaces the one of the store.
    lesson(&mut state, LessonCommand::Name("Grace".to_owned()));
    let stored = state
        .classroom
        .lessons
        .store_results(Some(&other.to_json()));
    assert!(stored.text.contains("Grace") && !stored.text.contains("Ada"));
}

#[test]
fn a_lesson_of_a_file_has_the_translation_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.md");
    let beside = folder.path().join("mine.de.md");
    let text = "---\ntitle: The title\nobjective: O\n---\n# S\n```run\nradius: 0.06\nleaf: 6\nmoment: end of tile\n```\nWords.\n";
    std::fs::write(&path, text).unwrap();
    let mut state = settled();
    let title = |state: &State| {
        let learner = &state.classroom.lessons.open.as_ref().unwrap().learner;
        learner.words(&learner.lesson().title)
    };
    let speak = |state: &mut State, tag: &str| {
        lesson(state, LessonCommand::Language(tag.to_owned()));
    };
    let open = |state: &mut State| lesson(state, LessonCommand::File(path.clone()));

    // Without a translation, and in a language that is none, the texts stay as they are.
    speak(&mut state, "de");
    open(&mut state);
    assert_eq!(title(&state), "The title");
    assert!(state.messages.notice.is_none());
    std::fs::write(&beside, "> The title\n\nDer Titel\n").unwrap();
    speak(&mut state, "de");
    assert_eq!(title(&state), "Der Titel");
    speak(&mut state, "en");
    assert_eq!(title(&state), "The title");
    speak(&mut state, "../mine.de");
    assert_eq!(title(&state), "The title");

    // A fault is named, and the lesson opens as it was written.
    std::fs::write(&beside, "Der Titel\n").unwrap();
    speak(&mut state, "de");
    open(&mut state);
    assert_eq!(title(&state), "The title");
    let notice = state.messages.notice.as_ref().expect("a notice");
    assert!(notice.text.contains("mine.de.md"), "{}", notice.text);
}

#[test]
fn a_lesson_that_a_page_delivers_is_named_without_its_ending() {
    let file = |name: &str| NamedBytes::new(name, TEMPLATE);
    let opened = |commands: Vec<FileCommand>| {
        let mut state = settled();
        state.restore(Settings {
            delivery: Some(Delivery::Download),
            ..Settings::default()
        });
        for command in commands {
            state.apply(Command::File(command));
        }
        state.settle();
        let open = state.classroom.lessons.open.as_ref();
        open.map(|open| open.learner.lesson().name.clone())
    };

    let dropped = FileCommand::DroppedBytes(vec![file("Mine.MD")], Vec::new());
    assert_eq!(opened(vec![dropped]).as_deref(), Some("Mine"));
    let by_the_sheet = |names: &[&str]| {
        let chosen = names.iter().map(|name| file(name)).collect();
        let open = FileCommand::Sheet(Purpose::Open);
        opened(vec![open, FileCommand::Chosen(chosen), FileCommand::Go])
    };
    assert_eq!(
        by_the_sheet(&["a.md.md", "set.json"]).as_deref(),
        Some("a.md")
    );
    assert_eq!(by_the_sheet(&["mine.txt"]), None);
}

#[test]
fn a_step_of_a_lesson_that_cannot_be_read_is_not_shown_in_another() {
    let mut state = settled();
    let shelf = &mut state.classroom.lessons.shelf;
    let mut broken = shelf[0].clone();
    broken.name = "broken".into();
    broken.text = "no lesson".into();
    shelf.push(broken);

    let open = |state: &mut State, name: &str, step: Option<String>| {
        let wanted = WantedLesson {
            name: name.to_owned(),
            step,
            ..WantedLesson::default()
        };
        state.in_class(|class, context| class.open_wanted(wanted, context));
        state.settle();
        let learner = &state.classroom.lessons.open.as_ref().unwrap().learner;
        (learner.lesson().name.clone(), learner.step().name.clone())
    };
    let first = open(&mut state, "survivors", None);
    let last = {
        let open = state.classroom.lessons.open.as_ref().unwrap();
        open.learner.lesson().steps.last().unwrap().name.clone()
    };
    // The open lesson stays at its step, which is not the one that was wanted of the other lesson.
    assert_eq!(open(&mut state, "broken", Some(last.clone())), first);
    assert_eq!(open(&mut state, "survivors", Some(last.clone())).1, last);
}

#[test]
fn a_page_loads_the_words_of_a_language_when_a_lesson_is_open() {
    let mut state = settled();
    state.classroom.lessons.shelf.clear();
    let read = |state: &mut State| {
        let text = TEMPLATE.to_owned();
        lesson(state, LessonCommand::Read("t".to_owned(), text));
    };
    read(&mut state);
    assert!(!state.classroom.wants_lessons(), "English has no table");

    lesson(&mut state, LessonCommand::Language("loaded".to_owned()));
    assert!(state.classroom.wants_lessons());
    assert_eq!(state.classroom.lessons.in_words("Play"), "Play");
    let loaded = Loaded {
        lessons: tilescope_lessons::shipped::lessons(),
        tables: [(
            "loaded".to_owned(),
            "1,234.5%\n    1.234,5 %\nPlay\n    Los\n".to_owned(),
        )]
        .into(),
    };
    state.take_lessons(Ok(&to_json(&loaded)));
    state.settle();
    assert!(!state.classroom.wants_lessons() && !state.classroom.lessons.shelf.is_empty());
    assert_eq!(state.classroom.lessons.in_words("Play"), "Los");
    let language = Language::of("loaded").expect("the table");
    assert_eq!(language.decimal_sign(), ',');

    // A table with a fault is named, as other faults of what was loaded.
    let faulty = to_json(&Loaded {
        tables: [("faulty".to_owned(), "Play\n".to_owned())].into(),
        ..loaded
    });
    state.take_lessons(Ok(&faulty));
    let notice = state.messages.notice.as_ref().expect("a notice");
    assert!(notice.text.contains("line 1"), "{}", notice.text);
}

#[test]
fn an_answer_that_was_given_up_is_told_and_not_asked_for_again() {
    let mut state = settled();
    let text = "---\ntitle: T\nobjective: O\n---\n# S\n```run\nradius: 0.06\nleaf: 6\nmoment: end of tile\n```\n```gate g\ntype: place\nask: Where?\nright: [4.0, 4.0]\ncandidate: [12.0, 12.0]\n```\n";
    let read = LessonCommand::Read("t".to_owned(), text.to_owned());
    lesson(&mut state, read);
    let labels = lesson_labels("en");
    let told = |state: &State| {
        let open = state.classroom.lessons.open.as_ref().unwrap();
        (open.verdict("en"), open.told_answer("en"))
    };
    let wrong = DraftCommand::Place([12.0, 12.0]);
    lesson(&mut state, LessonCommand::Draft(wrong));
    lesson(&mut state, LessonCommand::Answer);
    assert_eq!(told(&state), (Some(labels.wrong), None));
    for _ in 0..2 {
        lesson(&mut state, LessonCommand::GiveUp);
    }
    assert_eq!(told(&state), (None, Some(labels.place_marked.to_owned())));
    let marks = state.classroom.lessons.open.as_ref().unwrap().marks();
    let right = marks.iter().find(|mark| mark.kind == MarkKind::Right);
    assert!((right.expect("a mark").at.x - 4.0).abs() < 1e-9);
}

#[test]
fn clearing_the_results_is_asked_once_more() {
    let mut state = asked();
    let [right, _] = options(&state);
    choose(&mut state, right);
    let _ = state.classroom.lessons.store_results(None);
    lesson(&mut state, LessonCommand::ClearResults);
    assert!(
        state.classroom.lessons.asks_to_clear && state.classroom.lessons.results.entries.len() == 1
    );
    // Keeping them, or any other action in the lessons, is a no.
    for no in [LessonCommand::KeepResults, LessonCommand::ToggleList] {
        lesson(&mut state, no);
        assert!(
            !state.classroom.lessons.asks_to_clear
                && !state.classroom.lessons.has_unstored_results()
        );
        lesson(&mut state, LessonCommand::ClearResults);
    }
    let before = state.classroom.lessons.results.to_json();
    lesson(&mut state, LessonCommand::ClearResults);
    assert!(
        state.classroom.lessons.results.entries.is_empty()
            && !state.classroom.lessons.asks_to_clear
    );
    // What another window still has does not come back.
    let stored = state.classroom.lessons.store_results(Some(&before));
    assert!(Results::read(&stored.text).unwrap().entries.is_empty());
}

#[test]
fn a_verdict_that_the_sentence_begins_with_is_not_said_twice() {
    let mut state = asked();
    let [right, _] = options(&state);
    choose(&mut state, right);
    let open = state.classroom.lessons.open.as_mut().unwrap();
    for (sentence, verdict) in [
        (None, Some("Right.")),
        (Some("Right: it has the smaller number."), None),
        (Some("Right."), None),
        (Some("Rightmost is 12."), Some("Right.")),
        (Some("It is so."), Some("Right.")),
    ] {
        open.feedback.as_mut().unwrap().sentence = sentence.map(str::to_owned);
        assert_eq!(open.verdict("en"), verdict, "{sentence:?}");
    }
}

#[test]
fn giving_up_is_asked_once_more() {
    let mut state = asked();
    lesson(&mut state, LessonCommand::Step(Direction::Forwards));
    lesson(&mut state, LessonCommand::GiveUp);
    assert!(state.classroom.lessons.open_question().is_some());
    lesson(&mut state, LessonCommand::GiveUp);
    assert!(state.classroom.lessons.open_question().is_none());
    assert!(state.classroom.lessons.results.entries[0].given_up);
    lesson(&mut state, LessonCommand::Leave);
    assert!(state.classroom.lessons.open.is_none() && state.runs.first.verdict().is_some());
}

/// Returns everything that the state contains and shows of the run, as text.
fn told(state: &State) -> String {
    let run = &state.runs.first;
    let session = run.session.as_ref().unwrap();
    let debugger = run.debugger.as_ref().unwrap();
    let recording = debugger.recording();
    let events = (0..recording.len()).map(|event| tilescope_debugger::sentence(recording, event));
    // The JSON for pages, without the parameters of the run.
    let mut sent = crate::remote::to_json(state);
    sent["parameters"] = serde_json::Value::Null;
    format!(
        "{sent} {:?} {:?} {:?} {:?} {:?} {:?} {:?}",
        state.messages.announcement(),
        state.link(),
        session.summary,
        session.stages,
        run.moment_texts(state.lessons().veil().is_some()),
        debugger.watch_values(u64::MAX),
        events.collect::<Vec<String>>(),
    )
}

#[test]
fn two_runs_that_differ_only_later_tell_the_same_while_the_question_is_open() {
    // Up to the end of elimination, runs with the two searches are the same; afterwards they are not.
    let text = |search: &str| {
        let run = "radius: 0.03\nleaf: 8\nmoment: end of eliminate\n";
        let gate =
            "type: number\nask: How many samples will be inserted?\nanswer: count(\"insert\")\n";
        format!(
            "---\ntitle: T\nobjective: O\n---\n# S\n```run\nsearch: {search}\n{run}```\n```gate g\n{gate}```\n"
        )
    };
    let of = |search: &str| {
        let mut state = settled();
        lesson(
            &mut state,
            LessonCommand::Read("t".to_owned(), text(search)),
        );
        for watch in ["kind", "a", "count", "verdict", "place_x", "event"] {
            state.apply(Command::Debug(DebugCommand::Watch(watch.to_owned())));
        }
        state
    };
    let (a, b) = (of("complete"), of("two-radii"));
    assert_ne!(whole(&a).run().result.len(), whole(&b).run().result.len());
    assert_eq!(told(&a), told(&b));
    let [cursor, len] = a
        .runs
        .first
        .cursor()
        .map(|(cursor, len)| [cursor, len])
        .unwrap();
    assert_eq!(cursor, len);
    // The control: once both have given up, they tell different things.
    let revealed = |mut state: State| {
        lesson(&mut state, LessonCommand::GiveUp);
        lesson(&mut state, LessonCommand::GiveUp);
        told(&state)
    };
    assert_ne!(revealed(a), revealed(b));
}

#[test]
fn the_camera_of_a_trace_follows_from_event_to_event() {
    let mut state = settled();
    lesson(&mut state, LessonCommand::Open("survivors".to_owned()));
    let open = state.classroom.lessons.open.as_ref().unwrap();
    let last = open.learner.lesson().steps.last().unwrap().name.clone();
    lesson(&mut state, LessonCommand::Go(last));
    let mut places = Vec::new();
    while let Some(question) = state.classroom.lessons.open_question() {
        let open = state.classroom.lessons.open.as_ref().unwrap();
        let (_, traced) = open.learner.tries();
        let asked = question.named(traced)[0];
        let point = open.run.as_ref().unwrap().point(asked).unwrap();
        let (place, _) = open.camera().expect("a place");
        assert!((position(point) - DVec2::from(place)).length() < 1e-6);
        places.push(place);
        let Answer::Choice(right) = question.right_answer(traced) else {
            panic!("a choice");
        };
        choose(&mut state, right);
    }
    // The control: it has moved.
    assert_eq!(places.len(), 4);
    let [first, second, ..] = places[..] else {
        panic!("four places");
    };
    assert!(DVec2::from(first).distance(second.into()) > 1e-3);
}

#[test]
fn the_spectrum_that_a_number_is_read_from_appears_after_the_answer() {
    let text = "---\ntitle: T\nobjective: O\n---\n# S\n```run\nradius: 0.03\nleaf: 8\nmoment: end\n```\n```gate g\n\
                type: number\nask: Where is the peak?\nanswer: measure(\"peak\")\ncurve: \"set\"\n```\n";
    let mut state = settled();
    lesson(
        &mut state,
        LessonCommand::Read("t".to_owned(), text.to_owned()),
    );
    let curves = |state: &State| {
        let shown = state.classroom.lessons.to_json()["question"]["controls"].clone();
        let shown = shown.as_array().into_iter().flatten();
        shown.filter(|control| control["control"] == "plot").count()
    };
    assert_eq!(curves(&state), 0);
    lesson(&mut state, LessonCommand::GiveUp);
    lesson(&mut state, LessonCommand::GiveUp);
    assert_eq!(curves(&state), 1);
}

#[test]
fn no_event_panel_time_line_watch_history_or_search_goes_past_the_question() {
    let mut state = asked();
    let cursor = state.runs.first.cursor().unwrap();
    assert_eq!(cursor.0, cursor.1);
    for command in [
        TimeCommand::StepForward,
        TimeCommand::LastStage,
        TimeCommand::Jump(usize::MAX),
        TimeCommand::Jump(cursor.1),
        TimeCommand::TogglePlay,
    ] {
        state.apply(Command::Time(command));
        state.advance(5.0);
        state.settle();
        // Playing from the end begins at the start, and ends at the question.
        let (at, len) = state.runs.first.cursor().unwrap();
        assert!(at <= len && len == cursor.1);
    }
    state.apply(Command::Time(TimeCommand::Jump(cursor.1)));
    assert_eq!(state.runs.first.cursor(), Some(cursor));
    let run = &state.runs.first;
    let debugger = run.debugger.as_ref().unwrap();
    let next_names = ["kind", "a", "b", "line", "verdict"];
    for name in next_names {
        assert_eq!(debugger.evaluate(name).unwrap(), "none", "{name}");
    }
    let recording = debugger.recording();
    assert!(recording.event(cursor.0).is_none());
    for sample in 0..recording.run().samples.len() as u32 {
        assert!(
            recording
                .events_of(sample)
                .iter()
                .all(|&event| (event as usize) < cursor.0)
        );
    }
    assert!(run.session.as_ref().unwrap().outline.is_some());
    assert!(
        state.runs.first.verdict().is_none()
            && matches!(state.runs.first.verification, Verification::Nothing)
    );
}

#[test]
fn no_other_run_export_file_or_comparison_is_made_meanwhile() {
    let mut state = asked();
    let generation = state.runs.first.session.as_ref().unwrap().generation;
    let all = [
        Command::Run,
        Command::Undo,
        Command::OpenPasses,
        Command::Form(FormCommand::Type(Parameter::Seed, "5".to_owned())),
        Command::Export(ExportCommand::Open(crate::export::ExportKind::Result)),
        Command::File(FileCommand::Sheet(Purpose::Save)),
        Command::Scene(SceneCommand::Tour),
    ];
    for command in all {
        assert!(command.rules().reveals);
        state.messages.notice = None;
        state.apply(command.clone());
        state.settle();
        let notice = state
            .messages
            .notice
            .as_ref()
            .map(|notice| notice.text.clone())
            .unwrap_or_default();
        assert!(
            notice.contains("Answer the question"),
            "{command:?}: {notice}"
        );
        assert_eq!(
            state.runs.first.session.as_ref().unwrap().generation,
            generation
        );
        assert!(!state.files.has_sheet() && state.classroom.lessons.open_question().is_some());
    }
}

#[test]
fn a_form_takes_one_answer_to_each_question_and_says_nothing_about_it() {
    let mut state = settled();
    lesson(&mut state, LessonCommand::Open("before".to_owned()));
    lesson(&mut state, LessonCommand::Step(Direction::Forwards));
    let gate = |state: &State| {
        let gate = state.classroom.lessons.learner()?.step().gate.as_ref()?;
        Some(gate.name.clone())
    };
    let mut scores = Vec::new();
    for index in 0..12 {
        let name = gate(&state).expect("a question");
        let [right, wrong] = options(&state);
        if index == 2 {
            // Giving up takes two calls, and goes on too.
            lesson(&mut state, LessonCommand::GiveUp);
            assert_eq!(gate(&state).as_ref(), Some(&name));
            lesson(&mut state, LessonCommand::GiveUp);
        } else {
            choose(&mut state, if index % 2 == 0 { right } else { wrong });
        }
        assert_ne!(gate(&state), Some(name.clone()), "it goes on");
        let open = state.classroom.lessons.open.as_ref().unwrap();
        assert!(open.feedback.is_none() && open.verdict("en").is_none());

        let entry = state.classroom.lessons.results.entries.last().unwrap();
        assert_eq!(
            (entry.gate.as_str(), entry.tries),
            (name.as_str(), u32::from(index != 2))
        );
        assert!(entry.form.is_some() && entry.concept.is_some());
        scores.push(entry.score);
    }
    assert_eq!(scores[..4], [1.0, 0.0, 0.0, 0.0]);

    // Neither the steps nor a card at the end tell which answers were right.
    let told = crate::remote::ask(&mut state, r#"{"do": "lesson", "go": "back"}"#);
    assert!(told.contains("\"ok\":true"), "{told}");
    assert!(!told.contains("\"score\":1"), "{told}");
    assert_eq!(state.classroom.lessons.outcome(), None);
    assert!(gate(&state).is_some() && state.classroom.lessons.open_question().is_some());
}

#[test]
fn layers_that_the_question_hides_cannot_be_shown_until_it_is_answered() {
    let mut state = asked();
    let shown = |state: &State| state.appearance.layers(state.runs.first.current_stage());
    let of_step = shown(&state);
    let hidden = Layer::ALL.into_iter().filter(|layer| !of_step.has(*layer));
    let hidden: Vec<Layer> = hidden.collect();
    assert!(hidden.contains(&Layer::Gaps), "{hidden:?}");
    for &layer in &hidden {
        state.messages.notice = None;
        state.apply(Command::Appearance(AppearanceCommand::ToggleLayer(layer)));
        assert_eq!(shown(&state), of_step, "{layer:?}");
        let notice = state.messages.notice.as_ref().expect("a notice");
        assert_eq!(notice.text, HIDDEN_LAYER);
    }

    // The automatic layers are those of the step.
    state.apply(Command::Appearance(AppearanceCommand::AutomaticLayers));
    assert_eq!(shown(&state), of_step);

    // A page asks for layers by name, and a scene of the user's own has others: only those of the step are shown.
    let answer = crate::remote::ask(
        &mut state,
        r#"{"do": "view", "layers": ["gaps", "samples"]}"#,
    );
    assert_eq!(
        shown(&state).iter().collect::<Vec<_>>(),
        [Layer::Samples],
        "{answer}"
    );
    state.appearance.chosen_layers = Some(Layers::default());
    state.apply(Command::Scene(SceneCommand::Add));
    assert_eq!(shown(&state), Layers::default().within(of_step));

    // What the step shows can be switched off and on again.
    let own = of_step.iter().next().expect("a layer");
    state.apply(Command::Appearance(AppearanceCommand::AutomaticLayers));
    for is_on in [false, true] {
        state.apply(Command::Appearance(AppearanceCommand::ToggleLayer(own)));
        assert_eq!(shown(&state).has(own), is_on);
    }

    // The control: the answer frees all layers.
    let [right, _] = options(&state);
    choose(&mut state, right);
    assert_eq!(
        state
            .classroom
            .lessons
            .hidden_layers(state.runs.first.current_stage()),
        Layers::none()
    );
    state.apply(Command::Appearance(AppearanceCommand::ToggleLayer(
        Layer::Voronoi,
    )));
    assert!(shown(&state).has(Layer::Voronoi));
}

#[test]
fn the_answer_and_another_run_are_shown_at_the_learners_zoom() {
    let mut state = asked();
    let still = AppearanceCommand::ToggleReducedMotion;
    state.apply(Command::Appearance(still));
    let own = state.runs.first.camera;
    let at = state.runs.first.viewport.center();
    let zoom = Command::View(Which::First, ViewCommand::Zoom(at, 1.25));
    state.apply(zoom);
    let zoomed = state.runs.first.camera;
    assert!(zoomed.scale > own.scale);
    let [right, _] = options(&state);
    choose(&mut state, right);
    assert_eq!(state.runs.first.camera, zoomed);
    lesson(&mut state, LessonCommand::Practise(5));
    assert!(state.classroom.lessons.open_question().is_some());
    let scale = state.runs.first.camera.scale;
    assert!((scale - zoomed.scale).abs() < 1e-9, "{scale}");

    // A place that the learner has turned away from comes back into view, at the same scale.
    let away = ViewCommand::Pan(emath::vec2(5_000.0, 0.0));
    state.apply(Command::View(Which::First, away));
    let seen = |state: &State| {
        let (run, open) = (
            &state.runs.first,
            state.classroom.lessons.open.as_ref().unwrap(),
        );
        let (place, _) = open.camera().expect("a place");
        let at = run.camera.screen_from_domain(run.viewport, place);
        run.viewport.contains(at)
    };
    assert!(!seen(&state));
    let [right, _] = options(&state);
    choose(&mut state, right);
    assert!(seen(&state));
    let scale = state.runs.first.camera.scale;
    assert!((scale - zoomed.scale).abs() < 1e-9, "{scale}");

    // The control: another step has its own camera.
    assert!(chosen_camera(&state).is_some());
    lesson(&mut state, LessonCommand::Step(Direction::Backwards));
    assert_eq!(chosen_camera(&state), None);
}

#[test]
fn links_name_the_moment_of_the_question_at_most() {
    let mut state = asked();
    let (cursor, _) = state.runs.first.cursor().unwrap();
    state.apply(Command::Link(LinkCommand::Copy));
    let link = state.window.copied.clone().unwrap();
    let names_run = |link: &str| {
        ["at=", "seed=", "radius=", "leaf="]
            .iter()
            .any(|key| link.contains(key))
    };
    assert!(!names_run(&link), "{link}");
    lesson(&mut state, LessonCommand::Leave);
    state.apply(Command::Time(TimeCommand::Jump(cursor)));
    state.apply(Command::Link(LinkCommand::Copy));
    let link = state.window.copied.clone().unwrap();
    assert!(names_run(&link), "{link}");
}

#[test]
fn faults_of_a_lesson_are_named_with_their_line() {
    let mut state = settled();
    let text = TEMPLATE.replace("type: choice", "type: choise");
    lesson(&mut state, LessonCommand::Read("broken".to_owned(), text));
    let notice = &state.messages.notice.as_ref().unwrap().text;
    assert!(
        notice.contains("line 3") && notice.contains("\"choice\""),
        "{notice}"
    );
    assert!(state.classroom.lessons.open.is_none());
    // A moment that the run does not have.
    let text = TEMPLATE.replace("where: (a < b) == odd_run()", "where: a == 123456");
    lesson(&mut state, LessonCommand::Read("broken".to_owned(), text));
    lesson(&mut state, LessonCommand::Step(Direction::Forwards));
    assert!(
        state
            .classroom
            .lessons
            .open
            .as_ref()
            .unwrap()
            .fault
            .is_some()
    );
}

#[test]
fn answers_are_put_together_on_the_canvas_and_from_the_list() {
    let mut state = settled();
    let text = "---\ntitle: T\nobjective: O\n---\n# S\n```run\nradius: 0.08\nleaf: 6\nmoment: end of tile\n```\n```gate g\ntype: pick\nseveral: yes\nask: Which?\ncandidates: far(s, 4.0, 4.0) < 2.5\nanswer: conflicts_of(s) > 0\n```\n";
    lesson(
        &mut state,
        LessonCommand::Read("t".to_owned(), text.to_owned()),
    );
    let question = state.classroom.lessons.open_question().unwrap().clone();
    let Answer::Pick(right) = question.right_answer(0) else {
        panic!("samples are picked");
    };
    // The index of a sample in the list.
    let index = |state: &State, sample: u32| {
        let open = state.classroom.lessons.open.as_ref().unwrap();
        let controls = open.controls("en");
        let mut items = controls.iter().flat_map(Control::items);
        items
            .position(|item| item.text == sample.to_string())
            .unwrap()
    };
    let first = right[0];
    state.apply(Command::View(
        Which::First,
        ViewCommand::Pick(Selection::Sample(first)),
    ));
    let draft = &state.classroom.lessons.open.as_ref().unwrap().draft;
    assert!(draft.chosen().eq([index(&state, first)]));
    // The inspector tells about the sample, so a click that answers leaves it closed.
    let inspect = Command::View(Which::First, ViewCommand::Inspect);
    let has_inspector = |state: &State| state.window.shows(Panel::Inspector);
    state.apply(inspect.clone());
    assert!(!has_inspector(&state));
    for sample in &right[1..] {
        let choose = DraftCommand::Choose(index(&state, *sample));
        lesson(&mut state, LessonCommand::Draft(choose));
    }
    lesson(&mut state, LessonCommand::Answer);
    assert!(state.classroom.lessons.open_question().is_none());
    assert!((state.classroom.lessons.results.entries[0].score - 1.0).abs() < 1e-9);
    let click = ViewCommand::Pick(Selection::Sample(first));
    state.apply(Command::View(Which::First, click));
    state.apply(inspect);
    assert!(has_inspector(&state));
}

#[test]
fn a_package_that_cannot_be_made_says_why() {
    /// Asks for a package, and returns the notice.
    fn said(state: &mut State) -> String {
        lesson(state, LessonCommand::Package(CourseSystem::Scorm12));
        let notice = state.messages.notice.as_ref();
        notice.expect("it says so").text.clone()
    }
    let mut state = settled();
    assert_eq!(said(&mut state), "Open a lesson first.");

    // A lesson without a question has no score, which is said before the page is looked for.
    let plain =
        "---\ntitle: T\nobjective: O\n---\n# S\n```run\nradius: 0.1\nleaf: 6\n```\nWords.\n";
    let read = LessonCommand::Read("plain".to_owned(), plain.to_owned());
    lesson(&mut state, read);
    let text = said(&mut state);
    assert!(text.contains("the lesson has no question"), "{text}");

    // Tests run where there is no built page.
    lesson(&mut state, LessonCommand::Open("gaps".to_owned()));
    let text = said(&mut state);
    assert!(
        text.contains("web/dist") && text.contains("web/build"),
        "{text}"
    );
}

#[test]
fn the_command_of_a_package_is_copied_and_holds_nothing_but_names() {
    let mut state = settled();
    // Without a lesson there is nothing to package.
    lesson(&mut state, LessonCommand::CopyPackaging);
    assert_eq!(state.window.copied, None);

    lesson(&mut state, LessonCommand::Open("survivors".to_owned()));
    lesson(&mut state, LessonCommand::CopyPackaging);
    let command = "tilescope lesson package survivors --scorm 1.2 --out \"survivors.zip\"";
    assert_eq!(state.window.copied.as_deref(), Some(command));
    let notice = state.messages.notice.as_ref().expect("it says so");
    assert!(
        !notice.is_error && notice.text.contains(command),
        "{}",
        notice.text
    );

    // A name that would be more than a name in a terminal.
    let name = "a\"; touch $HOME/b; `c` \"";
    lesson(
        &mut state,
        LessonCommand::Read(name.to_owned(), TEMPLATE.to_owned()),
    );
    lesson(&mut state, LessonCommand::CopyPackaging);
    let command = state.window.copied.as_deref().unwrap();
    let start = "tilescope lesson package \"a__ touch _HOME_b_ _c_ _.md\"";
    assert!(command.starts_with(start), "{command}");
    assert_eq!(command.matches('"').count(), 4, "{command}");
}

#[test]
fn the_command_of_a_package_names_the_file_of_the_lesson() {
    let folder = tempfile::tempdir().unwrap();
    let mut state = settled();
    let mut copy = |name: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, TEMPLATE).unwrap();
        lesson(&mut state, LessonCommand::File(path.clone()));
        state.window.copied = None;
        lesson(&mut state, LessonCommand::CopyPackaging);
        let notice = state.messages.notice.clone().expect("it says so");
        (
            path.display().to_string(),
            state.window.copied.clone(),
            notice,
        )
    };

    // Within quotes a terminal takes these signs as they are, so that the path is that of the file.
    let (path, copied, notice) = copy("Kurs (2), a+b @c~[e] #f & g='h'.md");
    let copied = copied.expect("a command");
    let start = format!("tilescope lesson package \"{path}\" --scorm 1.2 --out \"");
    assert!(copied.starts_with(&start), "{copied}");
    assert!(!notice.is_error, "{}", notice.text);

    // It would take these for something else, and another path would be that of no file.
    for (name, sign) in [
        ("a$HOME.md", "$"),
        ("50%.md", "%"),
        ("\u{201c}a\u{201d}.md", "\u{201c}"),
    ] {
        let (path, copied, notice) = copy(name);
        assert_eq!(copied, None);
        let said = format!("the path {path} has the sign {sign},");
        assert!(
            notice.is_error && notice.text.contains(&said),
            "{}",
            notice.text
        );
    }
}
