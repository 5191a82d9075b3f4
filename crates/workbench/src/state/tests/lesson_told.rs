//! What pages are given of a lesson.

use std::collections::BTreeSet;

use serde_json::Value;

use super::settled;
use crate::command::Command;
use tilescope_classroom::lessons::LessonCommand;

/// The part of the page that shows a question.
const SCRIPT: &str = include_str!("../../../../../web/page/lesson.js");
/// The guide, with a lesson of each type of question.
const GUIDE: &str = include_str!("../../../../../assets/lessons/README.md");

/// Returns the question of each lesson of the guide, in a language.
fn questions(language: &str) -> Vec<Value> {
    let examples = GUIDE.split("````markdown\n").skip(1);
    let examples = examples.filter_map(|rest| rest.split("````").next());
    let question = |text: &str| {
        let mut state = settled();
        for command in [
            LessonCommand::Language(language.to_owned()),
            LessonCommand::Read("example".to_owned(), text.to_owned()),
        ] {
            state.apply(Command::Lesson(command));
            state.settle();
        }
        state.classroom.lessons.to_json()["question"].clone()
    };
    examples.map(question).collect()
}

/// Returns the values of a key anywhere within a value.
fn within<'a>(value: &'a Value, key: &str) -> Vec<&'a Value> {
    let mut found: Vec<&Value> = value.get(key).into_iter().collect();
    match value {
        Value::Array(parts) => found.extend(parts.iter().flat_map(|part| within(part, key))),
        Value::Object(parts) => found.extend(parts.values().flat_map(|part| within(part, key))),
        _ => {}
    }
    found
}

/// Returns the names of all fields of the objects in a list of lists of them.
fn fields<'a>(objects: impl IntoIterator<Item = &'a Value>) -> BTreeSet<&'a str> {
    let objects = objects.into_iter().filter_map(Value::as_object);
    let names = objects.flat_map(|object| object.keys().map(String::as_str));
    names.collect()
}

/// Returns the fields of a variable that a script reads.
fn read<'a>(script: &'a str, variable: &str) -> BTreeSet<&'a str> {
    let is_inner = |c: char| c.is_alphanumeric() || c == '_';
    let path = format!("{variable}.");
    let found = script.match_indices(&path).filter_map(|(at, _)| {
        let rest = &script[at + path.len()..];
        let name = rest.split(|c: char| !is_inner(c)).next()?;
        // The end of a longer name is another variable.
        (!script[..at].ends_with(is_inner)).then_some(name)
    });
    found.collect()
}

#[test]
fn the_page_reads_what_a_question_has_and_shows_every_control() {
    let questions = questions("en");
    assert_eq!(questions.len(), tilescope_lessons::kind_names().count());
    let lists = |key: &str| -> Vec<&Value> {
        let lists = questions.iter().flat_map(|question| within(question, key));
        lists.filter_map(Value::as_array).flatten().collect()
    };
    let controls = lists("controls");
    let kinds: BTreeSet<&str> = controls
        .iter()
        .filter_map(|control| control["control"].as_str())
        .collect();

    let (_, rest) = SCRIPT
        .split_once("function answers(")
        .expect("it shows controls");
    let (shows, _) = rest.split_once("\n}\n").expect("an end");
    for kind in &kinds {
        assert!(shows.contains(&format!("case \"{kind}\":")), "{kind}");
    }
    assert_eq!(shows.matches("case \"").count(), kinds.len());
    for (part, variable, has) in [
        (SCRIPT, "question", fields(&questions)),
        (shows, "control", fields(controls)),
        (shows, "item", fields(lists("items"))),
        (shows, "row", fields(lists("rows"))),
        (shows, "word", fields(lists("words"))),
    ] {
        let reads = read(part, variable);
        assert!(!reads.is_empty(), "{variable}");
        assert!(reads.is_subset(&has), "{variable}: {reads:?} of {has:?}");
    }
    // Both are buttons of the same form.
    for list in ["items", "words"] {
        let has = fields(lists(list));
        assert!(
            ["id", "chosen", "change"]
                .iter()
                .all(|name| has.contains(name))
        );
    }
}

/// Returns the texts of the program in a value; those of lessons have a style.
fn said(value: &Value) -> Vec<&str> {
    match value {
        Value::Array(parts) => parts.iter().flat_map(said).collect(),
        Value::Object(parts) if !parts.contains_key("style") => {
            let texts = parts.iter().flat_map(|(key, part)| match part {
                Value::String(text) if ["text", "label", "name"].contains(&&**key) => {
                    vec![text.as_str()]
                }
                part => said(part),
            });
            texts.collect()
        }
        _ => Vec::new(),
    }
}

#[test]
fn controls_have_the_words_and_numbers_of_the_language() {
    let texts = |language: &str| -> Vec<String> {
        let told = questions(language);
        let texts = told.iter().flat_map(|question| said(&question["controls"]));
        texts.map(str::to_owned).collect()
    };
    let (english, german) = (texts("en"), texts("de"));
    assert_eq!(english.len(), german.len());
    let same = english.iter().filter(|text| german.contains(text));
    assert_eq!(same.collect::<Vec<_>>(), Vec::<&String>::new());
    let has = |texts: &[String], number: &str| texts.iter().any(|text| text.contains(number));
    assert!(has(&english, "0.") && !has(&german, "0."), "{german:?}");
}
