//! The words around a lesson: `assets/lesson-labels.json` has the English ones, the tables of languages the others.

use std::collections::BTreeMap;
use std::sync::{LazyLock, Mutex, PoisonError};

use tilescope_session::language::Language;

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
    pub place_marked: &'static str,
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
    pub right_mark: &'static str,
    pub own_mark: &'static str,
    pub right_place: &'static str,
    pub you_can: &'static str,
    pub first_tries: &'static str,
    pub take_again: &'static str,
    pub next_lesson: &'static str,
    pub makes_run: &'static str,
    pub cannot_show: &'static str,
    pub answered: &'static str,
    pub own: &'static str,
    pub forms: &'static str,
    pub forms_intro: &'static str,
    pub skip: &'static str,
    pub tour: &'static str,
    pub results: &'static str,
    pub no_results: &'static str,
    pub some_results: &'static str,
    pub name: &'static str,
    pub save: &'static str,
    pub clear: &'static str,
    pub clear_all: &'static str,
    pub keep: &'static str,
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

static ENGLISH: LazyLock<LessonLabels> = LazyLock::new(|| labels(None));
/// The labels of other languages, by their tags, each made when it is first wanted.
static OTHERS: Mutex<BTreeMap<String, &'static LessonLabels>> = Mutex::new(BTreeMap::new());

/// Returns the labels in a language; `None` is English.
fn labels(language: Option<&Language>) -> LessonLabels {
    let english = include_str!("../../../assets/lesson-labels.json");
    let mut words: BTreeMap<&str, String> =
        serde_json::from_str(english).expect("the labels are valid");
    if let Some(language) = language {
        for text in words.values_mut() {
            *text = language.text(text);
        }
    }

    // Made once for each language and needed to the end of the program, so that they may be leaked.
    let json = serde_json::to_string(&words).expect("texts are valid");
    serde_json::from_str(Box::leak(json.into_boxed_str())).expect("no text has quotation marks")
}

/// Returns the words of a language; English if it has no table, or a page has not loaded it yet.
#[must_use]
pub fn lesson_labels(language: &str) -> &'static LessonLabels {
    let Some(table) = Language::of(language) else {
        return &ENGLISH;
    };
    let mut others = OTHERS.lock().unwrap_or_else(PoisonError::into_inner);
    others
        .entry(language.to_owned())
        .or_insert_with(|| Box::leak(Box::new(labels(Some(table)))))
}

#[cfg(test)]
mod tests {
    use tilescope_session::language::TABLES;

    use super::*;

    #[test]
    fn every_label_is_translated() {
        let english = serde_json::to_value(lesson_labels("en")).unwrap();
        for (tag, _) in TABLES {
            let translated = serde_json::to_value(lesson_labels(tag)).unwrap();
            for (name, text) in english.as_object().unwrap() {
                assert_ne!(&translated[name], text, "{tag}: {name}");
            }
        }
        assert_eq!(lesson_labels("xx").close, lesson_labels("en").close);
    }
}
