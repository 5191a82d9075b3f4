//! Whether a text that is on the screen while a question is open gives the answer away. Begin with [`leak`].
//!
//! A text leaks if it states the number that is asked for beside a word of the question, or names right candidates and not
//! all others. Free are the question, its options, bare numbers, and texts that all candidates have alike, as those of a
//! list and of labels. Orders, cuts and spectra are drawn or pointed at, so no text can state them.

use std::collections::{BTreeMap, BTreeSet};

use super::rules::content_words;
use crate::kinds::Secret;
use crate::question::Question;

/// How many words before and after a number say what it counts.
const BESIDE: usize = 3;
/// The index of the event whose question is searched for leaks. Only a trace asks about further events, and its secret
/// is the right option of the first one.
const EVENT: usize = 0;
/// The word that makes a number beside it that of a sample; also in the plural.
const SAMPLE: &str = "sample";

/// Returns why the texts of a frame give the answer to a question away, with the first text that does; `None` if none does.
#[must_use]
pub fn leak(question: &Question, texts: &BTreeSet<String>) -> Option<String> {
    let said: Vec<&str> = texts
        .iter()
        .map(String::as_str)
        .filter(|text| !is_free(text, question))
        .collect();

    match question.interaction.secret()? {
        Secret::Number(number) => said
            .iter()
            .find(|text| states(text, number, question))
            .map(|text| format!("\"{text}\" states the number that is asked for")),
        Secret::Samples(candidates, right) => {
            let all: Vec<Vec<f64>> = candidates.iter().map(|&s| vec![f64::from(s)]).collect();
            let is_right = |index: usize| right.contains(&candidates[index]);

            // A sample that the question names may be named by other texts, too, unless the question names all candidates.
            let mut known: BTreeSet<usize> = (0..candidates.len())
                .filter(|&index| question.named(EVENT).contains(&candidates[index]))
                .collect();
            if known.len() == candidates.len() {
                known.clear();
            }
            named(&said, &all, &known, &is_right)
        }
        Secret::Places(candidates, right) => {
            let all: Vec<Vec<f64>> = candidates.iter().map(|at| at.to_vec()).collect();
            let is_right = |index: usize| right.contains(&candidates[index]);
            named(&said, &all, &BTreeSet::new(), &is_right)
        }
        Secret::Option(options, right) => chosen(&said, options, right),
    }
}

/// Returns whether a text is a part of the question or of an option, or a row of the list of samples.
fn is_free(text: &str, question: &Question) -> bool {
    let options = question.interaction.listed();
    let is_option = |option: &String| option.contains(text) || text.ends_with(option.as_str());
    let is_asked = question.ask(EVENT).contains(text) || text.contains(question.ask(EVENT));
    is_asked || is_row(text) || options.iter().any(is_option)
}

/// Returns whether a text is a row of a list of samples, such as "sample 538", with or without a number before it: of a long
/// list some rows are in view.
fn is_row(text: &str) -> bool {
    let row = text.trim_start_matches(|c: char| c.is_ascii_digit() || c == ' ');
    let sample = row.strip_prefix(SAMPLE).map(str::trim);
    sample.is_some_and(|sample| number(sample).is_some())
}

/// Returns the words and numbers of a text, in lower case.
fn parts(text: &str) -> Vec<String> {
    let is_inner = |c: char| c == '.' || c == ',';
    text.split(|c: char| !c.is_alphanumeric() && !is_inner(c))
        .map(|part| part.trim_matches(is_inner).to_lowercase())
        .filter(|part| !part.is_empty())
        .collect()
}

/// Returns the number that a part of a text is, and half a unit of its last digit.
fn number(part: &str) -> Option<(f64, f64)> {
    // A comma divides thousands.
    let plain = part.replace(',', "");
    let decimals = plain.split_once('.').map_or(0, |(_, after)| after.len());
    let number = plain.parse().ok()?;
    Some((number, 0.5 * 0.1_f64.powi(i32::try_from(decimals).ok()?)))
}

/// Returns whether a part of a text is a number, as far as its digits go.
fn is_number(part: &str, wanted: f64) -> bool {
    // Texts have two decimals (`Scene::fill`). One with fewer states a number only if it is as near as with two; the
    // rest is rounding.
    number(part).is_some_and(|(number, half)| (number - wanted).abs() <= half.min(0.005 + 1e-9))
}

/// Returns whether a text has a number beside a word of the question.
fn states(text: &str, wanted: f64, question: &Question) -> bool {
    let asked = content_words(question.ask(EVENT));
    let parts = parts(text);
    let is_asked = |part: &String| !content_words(part).is_disjoint(&asked);
    parts.iter().enumerate().any(|(at, part)| {
        let beside = at.saturating_sub(BESIDE)..(at + BESIDE + 1).min(parts.len());
        is_number(part, wanted) && parts[beside].iter().any(is_asked)
    })
}

/// Returns a text without its digits: lists and labels have the same for all of their rows.
fn shape(text: &str) -> String {
    text.replace(|c: char| c.is_ascii_digit(), "")
}

/// Returns which of the candidates a text names, each by its numbers.
fn candidates_in(text: &str, candidates: &[Vec<f64>]) -> BTreeSet<usize> {
    let parts = parts(text);
    // Only a sample's own number names it; a place has two coordinates, which hardly are those of anything else.
    let has = |numbers: &[f64]| match numbers {
        [sample] => parts.iter().any(|part| part.starts_with(SAMPLE)) && holds(&parts, *sample),
        _ => numbers.iter().all(|&number| holds(&parts, number)),
    };
    let all = candidates.iter().enumerate();
    all.filter(|(_, numbers)| has(numbers))
        .map(|(index, _)| index)
        .collect()
}

fn holds(parts: &[String], wanted: f64) -> bool {
    parts.iter().any(|part| is_number(part, wanted))
}

/// Returns why texts give the answer away by naming a right candidate but not all candidates, if they do. Candidates
/// that are `known` from the question do not count.
fn named(
    texts: &[&str],
    candidates: &[Vec<f64>],
    known: &BTreeSet<usize>,
    is_right: &dyn Fn(usize) -> bool,
) -> Option<String> {
    // Texts of one shape are the rows of one list, which together may name all candidates: each shape has the candidates that
    // its texts name, and one of the texts, for the message.
    let mut alike: BTreeMap<String, (BTreeSet<usize>, &str)> = BTreeMap::new();

    for text in texts {
        let found = &candidates_in(text, candidates) - known;
        // The message shows a text that names a right candidate.
        if found.iter().any(|&index| is_right(index)) {
            alike.entry(shape(text)).or_default().1 = text;
        }
        alike.entry(shape(text)).or_default().0.extend(found);
    }

    let mut leaking = alike.values().filter(|(found, _)| {
        found.iter().any(|&index| is_right(index)) && found.len() < candidates.len() - known.len()
    });

    let (_, text) = leaking.next()?;
    Some(format!(
        "\"{text}\" names a right candidate and not all others"
    ))
}

/// Returns why texts say what the right option alone says, if one does: all the words and numbers that no other option
/// has.
fn chosen(texts: &[&str], options: &[String], right: usize) -> Option<String> {
    let own = |index: usize| -> BTreeSet<String> {
        let mut own = said(options.get(index).map_or("", String::as_str));
        for (other, option) in options.iter().enumerate() {
            if other != index {
                own.retain(|word| !said(option).contains(word));
            }
        }
        own
    };

    let wanted = own(right);
    // One word alone is the name of many things, such as of a layer.
    if wanted.len() < 2 {
        return None;
    }

    let mut leaking = texts.iter().filter(|text| wanted.is_subset(&said(text)));
    let text = leaking.next()?;
    Some(format!("\"{text}\" says what the right option says"))
}

/// Returns the content words and the numbers of a text.
fn said(text: &str) -> BTreeSet<String> {
    let mut said = content_words(text);
    said.extend(
        parts(text)
            .into_iter()
            .filter(|part| number(part).is_some()),
    );
    said
}

#[cfg(test)]
mod tests {
    use tilescope_core::Unobserved;

    use super::*;
    use crate::lesson::Lesson;
    use crate::scene::Scene;

    /// Returns the question of a gate about a small run, at the end of tiling.
    fn asked(gate: &str) -> Question {
        let text = format!(
            "---\ntitle: T\nobjective: O\n---\n# S\n```run\nradius: 0.06\nleaf: 6\nmoment: end of tile\n```\n```gate g\n{gate}\n```\n"
        );
        let lesson = Lesson::read("test", &text).expect("a lesson");
        let step = &lesson.steps[0];
        let made = step.scene.run(None).make(&mut Unobserved);
        let recording = made.expect("a run");
        let scene = Scene::find(&recording, &step.scene)
            .expect("no fault")
            .expect("a moment");
        Question::of(step.gate.as_ref().expect("a gate"), &scene).expect("a question")
    }

    /// Returns whether texts leak.
    fn leaks(question: &Question, texts: &[&str]) -> bool {
        let texts = texts.iter().map(|text| (*text).to_owned()).collect();
        leak(question, &texts).is_some()
    }

    #[test]
    fn a_text_that_states_the_number_leaks_and_a_bare_number_does_not() {
        let question = asked("type: number\nask: How many conflicts are there?\nanswer: 1042");
        for text in [
            "1042 conflicts",
            "Conflicts: 1,042",
            "1042 pairs in conflict",
        ] {
            assert!(leaks(&question, &[text]), "{text}");
        }
        for text in [
            "1042",
            "1041 conflicts",
            "1042 samples",
            "How many conflicts are there?",
            "Conflicts",
        ] {
            assert!(!leaks(&question, &[text]), "{text}");
        }
    }

    #[test]
    fn a_text_that_names_right_candidates_alone_leaks_and_a_list_of_all_does_not() {
        let question = asked(
            "type: pick\nask: Which one is eliminated?\ncandidates: s == 3 || s == 5 || s == 8\nanswer: s == 5",
        );
        for texts in [
            &["Sample 5 is covered by sample 1"][..],
            &["Samples 3 and 5"],
            &["Sample 5", "Sample 3"],
        ] {
            assert!(leaks(&question, texts), "{texts:?}");
        }
        for texts in [
            &["Sample 5", "Sample 3", "Sample 8"][..],
            &["9  sample 5"],
            &["sample 5"],
            &["5"],
            &["5 r"],
            &["Sample 3 is covered by sample 1"],
            &["Sample 55"],
        ] {
            assert!(!leaks(&question, texts), "{texts:?}");
        }
    }

    #[test]
    fn what_the_question_names_other_texts_may_name() {
        let asking = |ask: &str| {
            asked(&format!(
                "type: pick\nask: {ask}\ncandidates: s == 3 || s == 5\nanswer: s == 5"
            ))
        };
        let texts = ["Sample 5 eliminates sample 1"];
        assert!(!leaks(
            &asking("Sample {2 + 3} has its turn. Which one stays?"),
            &texts
        ));
        // The controls.
        assert!(leaks(&asking("Which one stays?"), &texts));
        assert!(leaks(
            &asking("Which of {1 + 2} and {2 + 3} stays?"),
            &texts
        ));
    }

    #[test]
    fn a_question_that_counts_samples_names_none() {
        let named = |ask: &str| {
            let question = asked(&format!("type: number\nask: {ask}\nanswer: 1"));
            question.named(0).to_vec()
        };
        assert!(named("{inserted} of {samples()} less {eliminated}?").is_empty());
        assert_eq!(named("Is it {1 + 2}?"), [3_u32]);
    }

    #[test]
    fn a_text_that_states_a_right_place_leaks() {
        let question = asked(
            "type: place\nask: Where?\nright: [3.25, 4.5]\ncandidate: [7.0, 8.0]\nwithin: 0.2",
        );
        assert!(leaks(&question, &["The gap is at 3.25, 4.50"]));
        assert!(!leaks(&question, &["The gap is at 3.25, 4.60"]));
        assert!(!leaks(&question, &["A: 3.25, 4.50", "A: 7.00, 8.00"]));
    }

    #[test]
    fn a_text_that_says_what_the_right_option_says_leaks() {
        let question = asked(
            "type: choice\nask: What is next?\noption: Sample 12 is eliminated when: true\noption: Sample 12 stays when: false\noption: Sample 30 claims its disk when: false",
        );
        let also = asked(
            "type: choice\nask: What is next?\noption: Sample 17 is eliminated when: true\noption: Sample 12 stays when: false",
        );
        // One own word is too little, two are the option.
        assert!(!leaks(&question, &["Sample 12 is eliminated by sample 3"]));
        assert!(leaks(&also, &["Sample 17 is eliminated by sample 3"]));
        assert!(!leaks(
            &also,
            &[
                "Sample 12 is eliminated by sample 3",
                "Eliminated",
                "A. Sample 17 is eliminated"
            ]
        ));
    }
}
