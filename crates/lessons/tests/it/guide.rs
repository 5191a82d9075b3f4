//! The guide for authors: its examples are checked as lessons, and its table of functions is the code's.

use std::fs;

use tilescope_core::Unobserved;
use tilescope_lessons::{Lesson, Runs, check, functions, kind_names, shipped};

const GUIDE: &str = include_str!("../../../../assets/lessons/README.md");

fn examples() -> Vec<&'static str> {
    let parts = GUIDE.split("````markdown\n").skip(1);
    parts
        .map(|part| part.split("````").next().unwrap())
        .collect()
}

fn faults(name: &str, text: &str, seeds: usize) -> Vec<String> {
    let lesson = match Lesson::read(name, text) {
        Ok(lesson) => lesson,
        Err(error) => return vec![error.to_string()],
    };
    let found = check(
        &lesson,
        seeds,
        &mut Runs::default(),
        &mut Unobserved,
        &mut |_| true,
    )
    .unwrap();
    assert!(
        found.questions > 0 || !found.faults.is_empty(),
        "{name}: no question was asked"
    );
    found.faults.iter().map(ToString::to_string).collect()
}

#[test]
fn every_example_is_a_lesson_and_there_is_one_of_each_type() {
    let mut types: Vec<&str> = Vec::new();
    for text in examples() {
        let lesson =
            Lesson::read("example", text).unwrap_or_else(|error| panic!("{error}\n{text}"));
        types.extend(lesson.gates().map(|(_, gate)| gate.kind_name));
        let found = faults("example", text, 12);
        assert!(found.is_empty(), "{text}\n{found:#?}");
    }
    types.sort_unstable();
    let mut names: Vec<&str> = kind_names().collect();
    names.sort_unstable();
    assert_eq!(types, names);
}

#[test]
fn the_template_is_fine() {
    assert_eq!(
        faults("template", shipped::TEMPLATE, 40),
        Vec::<String>::new()
    );
}

#[test]
fn the_table_of_functions_is_that_of_the_code() {
    assert_eq!(functions().count(), 70);
    let rows = functions().map(|(form, meaning)| format!("| `{form}` | {meaning} |\n"));
    let table = format!(
        "| function | gives |\n|---|---|\n{}",
        rows.collect::<String>()
    );
    let (before, rest) = GUIDE.split_once("<!-- generated: functions -->\n").unwrap();
    let (found, after) = rest.split_once("<!-- end -->").unwrap();
    if std::env::var_os("TILESCOPE_RENEW").is_some() {
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../assets/lessons/README.md"
        );
        let text = format!("{before}<!-- generated: functions -->\n{table}<!-- end -->{after}");
        fs::write(path, text).unwrap();
        return;
    }
    assert_eq!(
        found, table,
        "TILESCOPE_RENEW=1 cargo test -p tilescope-lessons writes it"
    );
}
