//! The words around a lesson, in the languages that lessons are translated into: `assets/lesson-labels.json` has them.

use std::collections::BTreeMap;
use std::sync::LazyLock;

/// The names of controls, hints and verdicts, for the window's panel and for the page's.
#[derive(Debug, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs)]
pub struct LessonLabels {
    pub lessons: &'static str,
    pub intro: &'static str,
    pub close: &'static str,
    pub close_list: &'static str,
    pub other_language: &'static str,
    pub answer: &'static str,
    pub hint: &'static str,
    pub give_up: &'static str,
    pub show_answer: &'static str,
    pub sure: &'static str,
    pub the_answer: &'static str,
    pub back: &'static str,
    pub next: &'static str,
    pub waits: &'static str,
    pub more: &'static str,
    pub again: &'static str,
    pub why: &'static str,
    pub right: &'static str,
    pub right_now: &'static str,
    pub not_quite: &'static str,
    pub wrong: &'static str,
    pub makes_run: &'static str,
    pub cannot_show: &'static str,
    pub answered: &'static str,
    pub own: &'static str,
    pub tour: &'static str,
    pub results: &'static str,
    pub no_results: &'static str,
    pub some_results: &'static str,
    pub name: &'static str,
    pub save: &'static str,
    pub clear: &'static str,
    pub clear_all: &'static str,
    pub keep: &'static str,
    pub number: &'static str,
    pub pick_several: &'static str,
    pub pick_one: &'static str,
    pub place: &'static str,
    pub your_point: &'static str,
    pub order: &'static str,
    pub cut: &'static str,
    pub vertical: &'static str,
    pub horizontal: &'static str,
    pub up: &'static str,
    pub same: &'static str,
    pub down: &'static str,
    pub step: &'static str,
    pub of: &'static str,
    pub present: &'static str,
    pub vote_now: &'static str,
    pub first_vote: &'static str,
    pub second_vote: &'static str,
    pub none_right: &'static str,
    pub few_right: &'static str,
    pub half_right: &'static str,
    pub most_right: &'static str,
    pub no_address: &'static str,
}

static LABELS: LazyLock<BTreeMap<&str, LessonLabels>> = LazyLock::new(|| {
    let text = include_str!("../../../assets/lesson-labels.json");
    serde_json::from_str(text).expect("the labels are valid")
});

/// Returns the words of a language; English if it has none.
#[must_use]
pub fn lesson_labels(language: &str) -> &'static LessonLabels {
    LABELS.get(language).unwrap_or(&LABELS["en"])
}
