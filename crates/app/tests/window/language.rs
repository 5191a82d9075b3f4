//! While a German lesson is open, all texts of the window are German: those that an English window shows, too, are listed.

use std::collections::{BTreeMap, BTreeSet};

use egui::Shape;
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use tilescope_app::App;
use tilescope_classroom::lessons::LessonCommand;
use tilescope_classroom::talk::TalkCommand;
use tilescope_debugger::{Direction, Listings};
use tilescope_lessons::DraftCommand;
use tilescope_workbench::Command;

use crate::lesson::drafts;
use crate::support::{opened_at, settle};

/// Names and words that both languages have.
const SHARED: [&str; 13] = [
    "Tilescope",
    "Delaunay",
    "Voronoi",
    "JSON",
    "CSV",
    "xAPI",
    "GPU",
    "CPU",
    "Block",
    "Laser",
    "https",
    "Radius",
    "min",
];

/// Returns all texts of the accessibility tree, and those that are drawn.
pub fn texts(harness: &Harness<'_, App>) -> BTreeSet<String> {
    let nodes = harness.query_all_by(|node| node.bounding_box().is_some());
    let told = nodes.flat_map(|node| {
        let node = node.accesskit_node();
        [node.label(), node.value(), node.description()]
    });
    let mut texts: BTreeSet<String> = told.flatten().collect();
    for clipped in &harness.output().shapes {
        drawn(&clipped.shape, &mut texts);
    }
    texts
}

fn drawn(shape: &Shape, texts: &mut BTreeSet<String>) {
    match shape {
        Shape::Text(text) => drop(texts.insert(text.galley.text().to_owned())),
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| drawn(shape, texts)),
        _ => {}
    }
}

fn send(harness: &mut Harness<'_, App>, command: LessonCommand) {
    harness.state_mut().state.apply(Command::Lesson(command));
    settle(harness);
    harness.run();
}

fn talk(harness: &mut Harness<'_, App>, command: TalkCommand) {
    harness.state_mut().state.apply(Command::Talk(command));
    settle(harness);
    harness.run();
}

/// Plays the lessons of these names in a language, and returns the texts of every step, open and answered, and of a talk
/// with the last lesson, each with the place where it was first.
fn played(language: &str, names: &[&str]) -> BTreeMap<String, String> {
    let mut harness = opened_at([1280.0, 720.0]);
    let mut all = BTreeMap::new();
    let mut note = |harness: &Harness<'_, App>, place: String| {
        for text in texts(harness) {
            all.entry(text).or_insert_with(|| place.clone());
        }
    };
    send(&mut harness, LessonCommand::Language(language.to_owned()));
    for name in names {
        send(&mut harness, LessonCommand::Open((*name).to_owned()));
        send(&mut harness, LessonCommand::ToggleList);
        note(&harness, format!("{name}, list"));
        send(&mut harness, LessonCommand::ToggleList);
        let open = harness.state().state.lessons().open.as_ref();
        let steps = open.expect("a lesson").learner.lesson().steps.len();
        for step in 0..steps {
            note(&harness, format!("{name} {step}"));
            // An answer that lacks everything is refused with a sentence.
            if harness.state().state.lessons().open_question().is_some() {
                send(&mut harness, LessonCommand::Answer);
                note(&harness, format!("{name} {step}, without an answer"));
            }
            while harness.state().state.lessons().open_question().is_some() {
                for command in drafts(&harness) {
                    let command = match command {
                        // Learners type numbers as their language writes them.
                        DraftCommand::Type(number) if language == "de" => {
                            DraftCommand::Type(number.replace('.', ","))
                        }
                        other => other,
                    };
                    send(&mut harness, LessonCommand::Draft(command));
                }
                send(&mut harness, LessonCommand::Answer);
            }
            note(&harness, format!("{name} {step}, answered"));
            send(&mut harness, LessonCommand::Step(Direction::Forwards));
        }
    }
    talk(&mut harness, TalkCommand::Lesson { from_start: true });
    note(&harness, "stage".to_owned());
    // Without the stage its window shows the notes.
    talk(&mut harness, TalkCommand::StageClosed);
    for press in 0..8 {
        note(&harness, format!("notes, press {press}"));
        for vote in ["A 1", "few"] {
            talk(&mut harness, TalkCommand::Vote(vote.to_owned()));
        }
        note(&harness, format!("notes, press {press}, votes"));
        talk(&mut harness, TalkCommand::Next);
    }
    all
}

/// Returns whether a text has a word that a language could have in another form.
fn has_words(text: &str) -> bool {
    let words = text.split(|c: char| !c.is_alphabetic());
    words
        .filter(|word| word.len() > 2)
        .any(|word| !SHARED.contains(&word))
}

/// Returns whether a text is a line of the pseudocode, which is code in every language.
fn is_code(text: &str) -> bool {
    Listings::shipped().lines().iter().any(|line| {
        let words = line.text(&tilescope_core::Parameters::default());
        text.contains(&words) || line.id == text
    })
}

/// Returns the texts that a German and an English window share, and German texts with a decimal point.
fn untranslated(
    german: &BTreeMap<String, String>,
    english: &BTreeMap<String, String>,
) -> Vec<String> {
    let is_english = |text: &str| english.contains_key(text) && has_words(text) && !is_code(text);
    let wrong = german
        .iter()
        .filter(|(text, _)| is_english(text) || has_decimal_point(text));
    wrong
        .map(|(text, place)| format!("{place}: {text}"))
        .collect()
}

/// Returns whether a text has a number with a decimal point. A point before three digits divides thousands.
fn has_decimal_point(text: &str) -> bool {
    let signs: Vec<char> = text.chars().collect();
    let digits = |at: usize| {
        signs[at..]
            .iter()
            .take_while(|c| c.is_ascii_digit())
            .count()
    };
    (1..signs.len().saturating_sub(1)).any(|at| {
        let is_between = signs[at] == '.' && signs[at - 1].is_ascii_digit();
        is_between && ![0, 3].contains(&digits(at + 1))
    })
}

#[test]
#[ignore = "takes long: tests/run --slow runs it"]
fn all_texts_of_a_german_lesson_are_german() {
    let all = [
        "welcome",
        "maximal",
        "cuts",
        "clips",
        "survivors",
        "losses",
        "gaps",
        "rounds",
        "reach",
        "spectrum",
        "tiling",
        "exact",
        "parallel",
        "gluing",
        "ranks",
        "radii",
        "space",
    ];
    let [german, english] = std::thread::scope(|scope| {
        let played = |language| scope.spawn(move || played(language, &all));
        ["de", "en"]
            .map(played)
            .map(|texts| texts.join().expect("it is played"))
    });
    let wrong = untranslated(&german, &english);
    assert!(german.len() > 150 && english.len() > 150);
    assert_eq!(wrong, Vec::<String>::new(), "{}", wrong.join("\n"));
}

#[test]
fn texts_without_translation_are_found() {
    let map = |texts: &[&str]| -> BTreeMap<String, String> {
        let texts = texts.iter();
        texts
            .map(|text| ((*text).to_owned(), "here".to_owned()))
            .collect()
    };
    let english = map(&["Play", "Next step", "12 r", "Block 3", "A."]);
    let german = map(&[
        "Abspielen",
        "Next step",
        "12 r",
        "Block 3",
        "A.",
        "0.46 r",
        "1.204 Punkte",
    ]);
    let found = untranslated(&german, &english);
    assert_eq!(found, ["here: 0.46 r", "here: Next step"]);
}
