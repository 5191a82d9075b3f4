//! The rules that a gate, or the gates of a lesson together, must keep. Each is a function that returns the faults. The guide
//! for authors says the rules; `findings.rs` collects what they are judged by.

use std::collections::{BTreeMap, BTreeSet};

use super::claims::mean;
use super::findings::Findings;
use crate::answer::letter;
use crate::error::LessonError;
use crate::kinds::Novelty;
use crate::lesson::{Gate, Lesson, Step};
use crate::moment::Moment;
use crate::prose;

/// The most words of a step's text before its question, and of that after it: Desmos' guide for activities advises no more on
/// a screen.
const MAX_WORDS: usize = 60;
/// The most words of a question: the same limit as for a step's text.
const MAX_ASK_WORDS: usize = 60;
/// The largest share of seeds in which one option is right: above it, a learner who always chooses the same is right most of
/// the time.
const MAX_SHARE: f64 = 0.6;
/// The largest share of seeds in which the right option is at one place of the list: of three shuffled options each place has
/// about a third, of two a half, which is too much.
const MAX_PLACE: f64 = 0.45;
/// The smallest share of seeds that have the moment of a question: below it, most draws of practice are in vain.
const MIN_FITTING: f64 = 0.5;
/// The number of seeds from which on shares are checked: of fewer a share says little.
const MIN_SEEDS_FOR_SHARES: usize = 10;
/// The smallest share of runs whose instance differs from that of the run before: 8 in 10 draws of practice bring a new one.
const MIN_NEW: f64 = 0.8;
/// The largest chance of a guesser to be right at the first try, in the mean over the gates of a lesson: choices of three
/// options alone, with 0.33, do not suffice.
const MAX_CHANCE: f64 = 0.3;
/// A question shows a misconception if a learner who has it scores at most this. Chosen, not measured.
const MAX_MISCONCEIVED: f64 = 0.5;
/// The letters of the shortest word that carries content; shorter ones are articles, prepositions and such.
const MIN_LETTERS: usize = 4;
/// Longer words without content of their own.
const EMPTY_WORDS: [&str; 44] = [
    "about",
    "after",
    "again",
    "also",
    "always",
    "before",
    "been",
    "between",
    "both",
    "does",
    "each",
    "every",
    "everywhere",
    "from",
    "have",
    "here",
    "into",
    "just",
    "more",
    "most",
    "mostly",
    "never",
    "none",
    "only",
    "other",
    "over",
    "same",
    "since",
    "some",
    "still",
    "than",
    "that",
    "their",
    "them",
    "then",
    "there",
    "these",
    "they",
    "this",
    "what",
    "when",
    "where",
    "which",
    "with",
];

/// Returns the faults of one gate, without `found.faults`, the errors of asking its question in the runs of the seeds.
/// A test (`is_test`) gives no reply to a wrong answer, and so needs no reasons.
pub(super) fn of_gate(
    step: &Step,
    gate: &Gate,
    found: &Findings,
    is_test: bool,
) -> Vec<LessonError> {
    let mut faults = moments(gate, found);
    faults.extend(options(gate, found));
    faults.extend(places(gate, found));
    faults.extend(novelty(gate, found));
    faults.extend(sight(step, found));
    faults.extend(reading(step, gate, found));
    if !is_test {
        faults.extend(reasons(gate, found));
    }
    faults
}

/// Returns the faults of a lesson's gates together, by the findings of each step.
pub(super) fn of_lesson(lesson: &Lesson, found: &BTreeMap<usize, Findings>) -> Vec<LessonError> {
    let mut faults = lengths(lesson);
    faults.extend(second_reading(lesson));
    faults.extend(events(lesson, found));
    faults.extend(chances(lesson, found));
    faults
}

/// Returns the faults of texts that are too long.
fn lengths(lesson: &Lesson) -> Vec<LessonError> {
    let mut faults = Vec::new();

    for step in &lesson.steps {
        for (what, part) in [
            ("text before the question", &step.text),
            ("text after the answer", &step.after),
        ] {
            let words: usize = part.iter().map(|paragraph| prose::words(paragraph)).sum();
            if words > MAX_WORDS {
                let message = format!(
                    "the {what} of \"{}\" has {words} words; at most {MAX_WORDS}",
                    step.title
                );
                faults.push(LessonError::new(step.line, message));
            }
        }

        if let Some(gate) = &step.gate {
            let words = prose::words(&gate.ask.text);
            if words > MAX_ASK_WORDS {
                let message = format!("the question has {words} words; at most {MAX_ASK_WORDS}");
                faults.push(LessonError::new(gate.ask.line, message));
            }
        }
    }
    faults
}

/// Returns the fault of a gate whose moment few seeds have.
fn moments(gate: &Gate, found: &Findings) -> Vec<LessonError> {
    let (fitting, asked) = (found.fitting, found.asked);
    // A fault of the questions, or of the picture in the step's own run, says why already.
    let is_explained = !found.faults.is_empty() || found.unseen.is_some();
    if fitting as f64 >= MIN_FITTING * asked as f64 || is_explained {
        return Vec::new();
    }
    let message = format!(
        "only {fitting} of {asked} seeds have the moment and show all that the question is about; at least half must"
    );
    vec![LessonError::new(gate.line, message)]
}

/// Returns the counted things whose share is above a limit, each with its share.
fn above(counts: &BTreeMap<usize, usize>, found: &Findings, limit: f64) -> Vec<(usize, f64)> {
    // Shares of few seeds are too uncertain to be judged.
    if found.fitting < MIN_SEEDS_FOR_SHARES {
        return Vec::new();
    }
    let share = |times: usize| times as f64 / found.fitting as f64;
    let shares = counts.iter().map(|(&index, &times)| (index, share(times)));
    shares.filter(|(_, share)| *share > limit).collect()
}

/// Returns the faults of options of the file that are right too often.
fn options(gate: &Gate, found: &Findings) -> Vec<LessonError> {
    // Learners who practise would soon choose such an option without a look.
    let often = above(&found.options, found, MAX_SHARE).into_iter();
    let faults = often.map(|(option, share)| {
        let line = gate
            .kind
            .options()
            .get(option)
            .map_or(gate.line, |it| it.text.line);

        let message = format!(
            "this option is right in {:.0}% of the seeds; at most {:.0}%, or \"practice: none\"",
            100.0 * share,
            100.0 * MAX_SHARE
        );
        LessonError::new(line, message)
    });
    faults.collect()
}

/// Returns the faults of places in the list at which the right option stands too often.
fn places(gate: &Gate, found: &Findings) -> Vec<LessonError> {
    let often = above(&found.places, found, MAX_PLACE).into_iter();
    let faults = often.map(|(place, share)| {
        let message = format!(
            "the right option is {} in {:.0}% of the seeds; at most {:.0}%, which takes three options",
            letter(place),
            100.0 * share,
            100.0 * MAX_PLACE
        );
        LessonError::new(gate.line, message)
    });
    faults.collect()
}

/// Returns the fault of a question whose own run leaves something out of sight. In practice another run is drawn instead.
fn sight(step: &Step, found: &Findings) -> Option<LessonError> {
    let what = found.unseen.as_ref()?;
    Some(LessonError::new(
        step.scene.line,
        format!("not all is to be seen: {what}"),
    ))
}

/// Returns the fault of a question that "again" asks as it was before.
fn novelty(gate: &Gate, found: &Findings) -> Vec<LessonError> {
    let instances = &found.instances;
    if instances.len() < MIN_SEEDS_FOR_SHARES {
        return Vec::new();
    }

    // A question that practice asks again unchanged can be answered from memory.
    let pairs = instances.windows(2);
    let new = pairs.filter(|pair| pair[0] != pair[1]).count() as f64;
    let share = new / (instances.len() - 1) as f64;
    if share >= MIN_NEW {
        return Vec::new();
    }

    let what = match gate.kind.novelty() {
        Novelty::Key => "the answer",
        Novelty::Texts | Novelty::Any => "what the question names",
    };

    let message = format!(
        "{what} differs from that of the seed before in {:.0}% of the seeds; at least {:.0}% must",
        100.0 * share,
        100.0 * MIN_NEW
    );
    vec![LessonError::new(gate.line, message)]
}

/// Returns the faults of wrong answers without a reason.
fn reasons(gate: &Gate, found: &Findings) -> Vec<LessonError> {
    let wrong = |message: &str| LessonError::new(gate.line, message);
    let mut faults = Vec::new();

    for (index, option) in gate.kind.options().iter().enumerate() {
        if option.sentence.is_none() && found.wrong.contains(&index) {
            let message = "this option can be wrong and has no reason: add \" => SENTENCE\"";
            faults.push(option.text.wrong(message));
        }
    }

    // `otherwise` is the reply to a wrong answer that the lesson does not foresee.
    let has_options = !gate.kind.options().is_empty();
    match &gate.otherwise {
        None if !has_options => faults.push(wrong(
            "a wrong answer that is not foreseen has no reason: add \"otherwise: SENTENCE\"",
        )),
        // Braces hold values of the run: without them the text is the same in every run and says nothing about this one.
        Some(text) if gate.practice.is_some() && !text.text.contains('{') => {
            faults.push(text.wrong(
                "this reason says nothing about the run: name a sample, a number or a place of it with {EXPRESSION}",
            ));
        }
        // Options have reasons of their own; a question without practice is asked of one run, whose values the author
        // has seen.
        _ => {}
    }

    // `because` is the first sentence after the answer. Where an answer near the number counts as right, the learner
    // has not seen the number itself, so that this sentence must give it.
    let is_inexact = gate.kind.is_inexact();
    match &gate.because {
        None if is_inexact => faults.push(wrong(
            "nothing says the exact number and how it comes about: add \"because: SENTENCE\"",
        )),
        Some(text) if is_inexact && !text.text.contains('{') => {
            faults
                .push(text.wrong("this does not say the exact number: give it with {EXPRESSION}"));
        }
        // A learner who gave the exact number has seen it.
        _ => {}
    }
    faults
}

/// Returns the content words of a text: in lower case, without the s of a plural.
pub(super) fn content_words(text: &str) -> BTreeSet<String> {
    // The expressions in braces are no words of the text.
    let without = prose::filled(text, |_| Ok(String::new())).unwrap_or_default();
    let plain = prose::plain(&without).to_lowercase();
    plain
        .split(|letter: char| !letter.is_alphabetic())
        .filter(|word| word.chars().count() >= MIN_LETTERS)
        .filter(|word| !EMPTY_WORDS.contains(word))
        .map(|word| word.strip_suffix('s').unwrap_or(word).to_owned())
        .collect()
}

/// Returns the faults of right options that the text above the question says.
fn reading(step: &Step, gate: &Gate, found: &Findings) -> Vec<LessonError> {
    // The author wants the answer to be read in the text.
    if gate.is_reading {
        return Vec::new();
    }

    let text = content_words(&step.text.join(" "));
    let said = gate
        .kind
        .options()
        .iter()
        .enumerate()
        .filter(|(index, option)| {
            let words = content_words(&option.text.text);
            // An option with a value of the run cannot be chosen by reading, as the text does not have this value.
            let names_value = option.text.text.contains('{');
            found.right.contains(index)
                && !names_value
                && !words.is_empty()
                && words.is_subset(&text)
        });

    let faults = said.map(|(_, option)| {
        let message = "every word of this right option stands in the text above: whoever has read it can \
                       answer without the picture. Change one of them, or say \"read: yes\"";
        option.text.wrong(message)
    });
    faults.collect()
}

/// Returns the fault of each further gate of a lesson that only checks reading.
fn second_reading(lesson: &Lesson) -> Vec<LessonError> {
    let readings = lesson.gates().filter(|(_, gate)| gate.is_reading).skip(1);
    let faults = readings.map(|(_, gate)| {
        let message = "a lesson has at most one question with \"read: yes\"";
        LessonError::new(gate.line, message)
    });
    faults.collect()
}

/// Returns the faults of gates that stop at the event of a gate before them: its answer has shown what happens there.
fn events(lesson: &Lesson, found: &BTreeMap<usize, Findings>) -> Vec<LessonError> {
    // Only at single events does an answer show what happens. At the start or end of a stage many things can be asked.
    let stops = |step: &Step| {
        step.gate.is_some()
            && matches!(
                step.scene.moment,
                Moment::Before(_) | Moment::After(_) | Moment::At(_)
            )
    };

    let stopping = found
        .iter()
        .filter(|(index, _)| stops(&lesson.steps[**index]));
    let gates: Vec<(&Step, &Findings)> =
        stopping.map(|(&at, of)| (&lesson.steps[at], of)).collect();

    let mut faults = Vec::new();
    for (later, (step, findings)) in gates.iter().enumerate() {
        let same = gates[..later].iter().find(|(other, of_other)| {
            // Equal cursors are the same event only in runs of the same parameters. The steps' own runs are compared,
            // as those of practice differ from them by the seed alone.
            let seed_of_practice = None;
            let [one, another] = [other, step].map(|step| step.scene.run(seed_of_practice));
            let is_one_run = one == another;
            let mut cursors = findings.cursors.iter();
            is_one_run
                && cursors.any(|(of_run, cursor)| of_other.cursors.get(of_run) == Some(cursor))
        });

        if let Some((other, _)) = same {
            let message = format!(
                "the question stops at the event of \"{}\", whose answer has shown it; let \"where\" leave it out",
                other.name
            );
            faults.push(LessonError::new(step.scene.line, message));
        }
    }
    faults
}

/// Returns the faults of a lesson that can be guessed, or that shows no misconception.
fn chances(lesson: &Lesson, found: &BTreeMap<usize, Findings>) -> Vec<LessonError> {
    // A step without a question, or with one that no run could ask, has no chances.
    let asked: Vec<&Findings> = found.values().filter(|of| !of.chances.is_empty()).collect();
    // A lesson with one question is an exercise: neither a mean over questions nor a choice of one among them makes sense.
    if asked.len() < 2 {
        return Vec::new();
    }

    // A fault of the whole lesson stands at its first question.
    let line = lesson.gates().next().map_or(1, |(_, gate)| gate.line);
    let mut faults = Vec::new();

    let chances: Vec<f64> = asked.iter().map(|of| mean(&of.chances)).collect();
    if mean(&chances) > MAX_CHANCE {
        faults.push(LessonError::new(line, format!(
            "who guesses is right at the first try in {:.0}% of the questions, at most {:.0}% is allowed: give more options, \
             candidates or numbered samples",
            100.0 * mean(&chances),
            100.0 * MAX_CHANCE
        )));
    }

    // A question shows the misconception only if it scores low in every run, as its answer may be right in some runs.
    let shows = |of: &&Findings| {
        let scores = &of.misconceived;
        !scores.is_empty() && scores.iter().all(|score| *score <= MAX_MISCONCEIVED)
    };
    if !asked.iter().any(shows) {
        let message = "no question shows a misconception: give one a wrong answer that a learner with it chooses, \
                       by \"wrong\" or by an option with a reason";
        faults.push(LessonError::new(line, message));
    }
    faults
}
