//! The tables of `web/README.md` about links and requests, compared with the code.

use std::collections::BTreeSet;

use serde_json::{Value, json};
use tilescope_core::{Parameters, Stage};
use tilescope_session::layers::Layer;
use tilescope_session::look::Look;
use tilescope_session::words::{grouped, slug, stage_name};

use super::{MAX_BYTES, REQUESTS, Request, TARGETS, read};
use crate::clock::Clock;
use crate::link::{self, COLOURINGS, choice_name};

const README: &str = include_str!("../../../../web/README.md");

type Words = BTreeSet<String>;

/// Returns the rows of the table whose head begins with `head`, cell by cell.
fn table(head: &str) -> Vec<Vec<&'static str>> {
    let at = README.find(&format!("\n| {head} |")).expect(head);
    let lines = README[at + 1..].lines().skip(2);
    let rows = lines.take_while(|line| line.starts_with('|'));
    rows.map(|row| row.trim_matches('|').split('|').map(str::trim).collect())
        .collect()
}

/// Returns the parts of a text between single backquotes.
fn quoted(text: &str) -> impl Iterator<Item = String> {
    text.split('`').skip(1).step_by(2).map(str::to_owned)
}

/// Returns the names in the first column of a table.
fn first_column(head: &str) -> Words {
    table(head).iter().flat_map(|row| quoted(row[0])).collect()
}

fn words<T: Into<String>>(all: impl IntoIterator<Item = T>) -> Words {
    all.into_iter().map(Into::into).collect()
}

#[test]
fn every_key_of_links_is_documented() {
    assert_eq!(first_column("key"), words(link::keys()));
}

#[test]
fn every_name_is_documented() {
    let stages = [
        Stage::Pattern,
        Stage::Blocks,
        Stage::Tile,
        Stage::Eliminate,
        Stage::Iterate(1),
        Stage::Regions,
        Stage::Finish,
    ];
    let clocks = Clock::ALL.into_iter().filter(|clock| *clock != Clock::Pass);
    let expected = [
        (
            "stages",
            words(stages.map(|stage| slug(&stage_name(stage)))),
        ),
        ("layers", words(Layer::ALL.map(Layer::key))),
        ("colourings", words(COLOURINGS.each_ref().map(choice_name))),
        ("looks", words(Look::ALL.each_ref().map(choice_name))),
        (
            "clocks and units",
            words(clocks.map(|clock| choice_name(&clock))),
        ),
        (
            "kinds of events to seek",
            words(TARGETS.map(|(name, _)| name)),
        ),
    ];
    let rows = table("names of");
    assert_eq!(rows.len(), expected.len());
    for ((of, names), row) in expected.iter().zip(rows) {
        assert_eq!((*of, names), (row[0], &quoted(row[1]).collect()));
    }
}

#[test]
fn every_field_of_a_run_is_documented_with_values_that_it_takes() {
    let all = serde_json::to_value(Parameters::default()).expect("fields");
    let mut fields = Words::new();
    for (field, value) in all.as_object().expect("an object") {
        match value.as_object() {
            Some(inner) => fields.extend(inner.keys().map(|key| format!("{field}.{key}"))),
            None => drop(fields.insert(field.clone())),
        }
    }
    assert_eq!(first_column("field of `load`"), fields);
    for row in table("field of `load`") {
        for value in quoted(row[1]) {
            let value = serde_json::from_str(&value).unwrap_or(Value::String(value));
            for field in quoted(row[0]) {
                let parameters = match field.split_once('.') {
                    Some((outer, inner)) => json!({ outer: { inner: value } }),
                    None => json!({ field.as_str(): value }),
                };
                let request = json!({"do": "load", "parameters": parameters});
                let read = read(&request.to_string());
                assert!(
                    matches!(read, Ok(Request::Parameters(_))),
                    "{request}: {read:?}"
                );
            }
        }
    }
}

#[test]
fn every_request_is_documented_with_all_its_fields() {
    let rows = table("request");
    let mut named = Words::new();
    for row in &rows {
        let name = row[0].split('"').nth(1).expect("a name");
        named.insert(name.to_owned());
    }
    assert_eq!(named, words(REQUESTS.map(|(name, _)| name)));
    for (name, fields) in REQUESTS {
        let of_name = |row: &&Vec<&str>| row[0].contains(&format!("do: \"{name}\""));
        let shown: String = rows.iter().filter(of_name).map(|row| row[0]).collect();
        for field in fields {
            assert!(shown.contains(&format!("{field}: ")), "{name}: {field}");
        }
    }
}

#[test]
fn every_field_of_the_state_is_documented() {
    let state = super::to_json(&crate::State::new(std::sync::Arc::new(|| {})));
    let keys = |value: &Value| words(value.as_object().expect("an object").keys());
    assert_eq!(first_column("field of `state`"), keys(&state));
    let view = &REQUESTS
        .iter()
        .find(|(name, _)| *name == "view")
        .expect("it")
        .1;
    assert_eq!(keys(&state["view"]), words(view.iter().copied()));
}

#[test]
fn the_limits_of_a_page_are_documented() {
    let count = |most: f64| grouped(most as usize);
    let expected = [
        count(tilescope_session::limits::MAX_STAGED_ON_A_PAGE),
        count(link::MAX_SAMPLES_ON_A_PAGE),
        count(tilescope_session::limits::MAX_ON_A_PAGE),
        format!("{} r", link::MAX_PATTERN_SIDE_ON_A_PAGE),
        grouped(tilescope_session::limits::MAX_PASSES_ON_A_PAGE),
        grouped(link::MAX_BYTES),
        grouped(link::MAX_CHARACTERS),
        link::MAX_STOPS.to_string(),
        link::MAX_SCENES.to_string(),
        link::MAX_TEXT.to_string(),
        grouped(MAX_BYTES),
    ];
    let rows = table("limit");
    let limits: Vec<&str> = rows.iter().map(|row| row[1]).collect();
    assert_eq!(limits, expected);
}
