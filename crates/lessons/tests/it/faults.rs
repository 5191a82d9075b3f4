//! Lessons with faults: each misspelt directive and value is named with its line, and hostile files end in an error, soon.

use std::sync::Arc;

use tilescope_core::Unobserved;
use tilescope_lessons::{Arrival, Learner, Lesson, LessonError, MAX_BYTES, Runs, check, shipped};

const GUIDE: &str = include_str!("../../../../assets/lessons/README.md");

fn texts() -> Vec<String> {
    let examples = GUIDE.split("````markdown\n").skip(1);
    let examples = examples.map(|part| part.split("````").next().unwrap().to_owned());
    examples.chain([shipped::TEMPLATE.to_owned()]).collect()
}

/// Reads a lesson and asks its questions of three runs; returns the first fault.
fn fault(text: &str) -> Option<LessonError> {
    let lesson = match Lesson::read("test", text) {
        Ok(lesson) => lesson,
        Err(error) => return Some(error),
    };
    let found = check(
        &lesson,
        3,
        &mut Runs::default(),
        &mut Unobserved,
        &mut |_| true,
    )
    .unwrap();
    found.faults.into_iter().next()
}

/// Swaps the first two letters of a word that differ.
fn misspelt(word: &str) -> String {
    let mut letters: Vec<char> = word.chars().collect();
    match letters.windows(2).position(|pair| pair[0] != pair[1]) {
        Some(at) => letters.swap(at, at + 1),
        None => letters.push('x'),
    }
    letters.into_iter().collect()
}

#[test]
fn every_misspelt_field_is_named_with_its_line_and_the_nearest_right_one() {
    let mut tried = 0;
    for text in texts() {
        let lines: Vec<&str> = text.lines().collect();
        let mut is_inside = false;
        for (number, line) in lines.iter().enumerate() {
            if line.starts_with("```") {
                is_inside = !is_inside;
            }
            let is_front = number > 0
                && lines[..number]
                    .iter()
                    .filter(|line| **line == "---")
                    .count()
                    == 1;
            let (name, changed) = match line.split_once(':') {
                Some((key, rest))
                    if (is_inside || is_front) && !line.starts_with([' ', '#', '`']) =>
                {
                    (key, format!("{}:{rest}", misspelt(key)))
                }
                _ if is_inside && line.starts_with("```") => {
                    let (kind, name) = line[3..].split_once(' ').unwrap_or((&line[3..], ""));
                    (kind, format!("```{} {name}", misspelt(kind)))
                }
                _ => continue,
            };
            let mut all = lines.clone();
            all[number] = &changed;
            let error = Lesson::read("test", &all.join("\n")).expect_err(&changed);
            assert_eq!(error.line, number + 1, "{changed}: {error}");
            assert!(error.message.contains(name), "{changed}: {error}");
            tried += 1;
        }
    }
    assert!(tried > 100, "{tried}");
}

#[test]
fn every_misspelt_value_is_a_fault_at_its_line() {
    let words = [
        "type",
        "moment",
        "layers",
        "camera",
        "decided",
        "events",
        "answer",
        "right",
        "from",
        "to",
        "shows",
        "practice",
        "boundary",
        "candidates",
        "where",
    ];
    let mut tried = 0;
    for text in texts() {
        let lines: Vec<&str> = text.lines().collect();
        for (number, line) in lines.iter().enumerate() {
            let Some((key, value)) = line.split_once(": ").filter(|(key, _)| words.contains(key))
            else {
                continue;
            };
            // Numbers and texts in quotation marks have no letters that could be swapped.
            let Some(at) = value
                .find(|letter: char| letter.is_alphabetic())
                .filter(|_| !value.contains('"'))
            else {
                continue;
            };
            let end = value[at..]
                .find(|letter: char| !letter.is_alphanumeric() && letter != '_' && letter != '-');
            let end = end.map_or(value.len(), |end| at + end);
            if end - at < 3 {
                continue;
            }
            let changed = format!(
                "{key}: {}{}{}",
                &value[..at],
                misspelt(&value[at..end]),
                &value[end..]
            );
            let mut all = lines.clone();
            all[number] = &changed;
            let error = fault(&all.join("\n")).unwrap_or_else(|| panic!("{changed}: no fault"));
            assert_eq!(error.line, number + 1, "{changed}: {error}");
            tried += 1;
        }
    }
    assert!(tried > 30, "{tried}");
}

/// A lesson with one question of this kind.
fn asking(gate: &str) -> String {
    format!(
        "---\ntitle: T\nobjective: O\n---\n# S\n```run\nradius: 0.06\nleaf: 6\nmoment: end of tile\n```\n```gate g\n{gate}\n```\n"
    )
}

#[test]
fn hostile_files_are_refused() {
    let long = format!("{}{}", shipped::TEMPLATE, "x".repeat(10_000_000));
    let error = Lesson::read("long", &long).unwrap_err();
    assert!(error.message.contains(&MAX_BYTES.to_string()), "{error}");
    let number = |answer: &str| {
        asking(&format!(
            "type: number\nask: How many?\nanswer: {answer}\notherwise: Not of {{samples()}}.\nbecause: {{samples()}}."
        ))
    };
    for (what, text) in [
        (
            "nested parentheses",
            number(&format!("{}1{}", "(".repeat(300), ")".repeat(300))),
        ),
        (
            "nested calls",
            number(&format!("{}1{}", "abs(".repeat(200), ")".repeat(200))),
        ),
        ("a loop", number("loop { }")),
        ("another loop", number("while true { 1 }")),
        ("a function", number("fn f(x) { f(x) } f(1)")),
        (
            "a long array",
            number("[1, 2, 3].len() * range(0, 1000000000)"),
        ),
        (
            "many practice seeds",
            number("1\npractice: seeds 1..1000000000"),
        ),
        ("backwards seeds", number("1\npractice: seeds 9..1")),
        (
            "a huge run",
            shipped::TEMPLATE.replace("radius: 0.04", "radius: 0.00001"),
        ),
        (
            "no number",
            shipped::TEMPLATE.replace("radius: 0.04", "radius: NaN"),
        ),
        (
            "a negative number",
            shipped::TEMPLATE.replace("radius: 0.04", "radius: -1"),
        ),
        (
            "no end of a directive",
            shipped::TEMPLATE.replace("practice: seeds 1..40\n```", "practice: seeds 1..40\n"),
        ),
        ("no front matter", "# Only a step\n".to_owned()),
        ("nothing", String::new()),
        ("bytes", "\u{0}\u{1}\u{fffd}".to_owned()),
        (
            "many steps",
            format!(
                "---\ntitle: T\nobjective: O\n---\n{}",
                "# S\nText.\n".repeat(10_000)
            ),
        ),
        (
            "many options",
            asking(&format!(
                "type: choice\nask: What?\n{}",
                "option: A when: true\n".repeat(1_000)
            )),
        ),
        (
            "deep emphasis",
            format!(
                "---\ntitle: T\nobjective: O\n---\n# S\n{}x\n",
                "*a ".repeat(30_000)
            ),
        ),
        (
            "open braces",
            format!(
                "---\ntitle: T\nobjective: O\n---\n# S\n{}\n",
                "{".repeat(10_001)
            ),
        ),
    ] {
        let error = fault(&text).unwrap_or_else(|| panic!("{what}: no fault"));
        assert!(
            !error.message.is_empty() && error.message.chars().count() < 1_000,
            "{what}: {error}"
        );
    }
    // Marks that lessons do not have, however deep, are left out.
    let quoted = format!(
        "---\ntitle: T\nobjective: O\n---\n# S\n{}x\n",
        "> ".repeat(50_000)
    );
    let lesson = Lesson::read("quoted", &quoted).unwrap();
    assert_eq!(tilescope_lessons::plain(&lesson.steps[0].text[0]), "x");
    // The controls.
    assert_eq!(fault(&number("1 + 1")), None);
    assert_eq!(fault(shipped::TEMPLATE), None);
}

/// A lesson whose only step makes a claim, in line 11.
fn claiming(claim: &str) -> String {
    format!(
        "---\ntitle: T\nobjective: O\n---\n# S\n```run\nradius: 0.06\nleaf: 6\nmoment: end of tile\n\n{claim}\n```\n"
    )
}

#[test]
fn claims_that_do_not_hold_are_faults_at_their_lines() {
    for (claim, part) in [
        ("claim: samples() < 10", "false in 3 of 3 runs"),
        ("claim-mean: samples() > 1000000", "above 1000000"),
        ("claim-mean: samples() < 10", "below 10"),
        // The mean is the bound, which chance alone may reach.
        ("claim-mean: 5 > 5", "the mean is 5.0000"),
        ("claim-mean: samples()", "of the form"),
        ("claim-mean: samples() > many", "allowed are numbers"),
        ("claim: sampels() > 0", "samples"),
        ("claim: samples()", "true or false"),
        // A name that is no parameter's would compare the run with itself.
        (
            "claim: measure_with(\"density\", \"laef=10\") > 0",
            "Did you mean \"leaf\"?",
        ),
    ] {
        let error = fault(&claiming(claim)).unwrap_or_else(|| panic!("{claim}: no fault"));
        assert_eq!(error.line, 11, "{claim}: {error}");
        assert!(error.message.contains(part), "{claim}: {error}");
    }

    // The controls.
    for claim in [
        "claim: samples() > 10",
        "claim-mean: samples() > 10",
        "claim-mean: samples() < 1000000",
        "claim: measure_with(\"density\", \"leaf=10\") > 0",
    ] {
        assert_eq!(fault(&claiming(claim)), None, "{claim}");
    }
}

#[test]
fn nested_levels_are_not_compared_with_a_run() {
    for claim in [
        "claim: measure_with(\"density\", \"leaf=10\") > 0",
        "claim: same_points(\"parallel\")",
        "claim: exists(parts_at(\"leaf=10\"))",
    ] {
        let of_levels = claiming(claim).replace("moment: end of tile", "levels: 2");
        let error = fault(&of_levels).unwrap_or_else(|| panic!("{claim}: no fault"));
        assert!(
            error.message.contains("nested levels cannot be compared"),
            "{claim}: {error}"
        );
        // The control: a run with stages is compared.
        assert_eq!(fault(&claiming(claim)), None, "{claim}");
    }
}

#[test]
fn a_claim_that_no_run_tests_is_a_fault() {
    let text = claiming("claim: true").replace("\n\nclaim", "\nwhere: false\nclaim");
    let lesson = Lesson::read("test", &text).unwrap();
    let mut runs = Runs::default();
    let found = check(&lesson, 3, &mut runs, &mut Unobserved, &mut |_| true).unwrap();
    let is_named = |fault: &LessonError| fault.line == 11 && fault.message.contains("0 of 3 runs");
    assert!(found.faults.iter().any(is_named), "{:?}", found.faults);
}

/// The condition of the first question of [`SOUND`]: both samples lie inside the domain.
const INSIDE: &str = "(a < b) == odd_run() && min(border(position(a)[0], position(a)[1]), border(position(b)[0], position(b)[1])) > 2.5";

/// A lesson that keeps all rules for gates.
const SOUND: &str = r"---
title: T
objective: O
---
# One
```run
radius: 0.06
leaf: 6
moment: before eliminate
where: (a < b) == odd_run() && min(border(position(a)[0], position(a)[1]), border(position(b)[0], position(b)[1])) > 2.5
```
The order decides.
```gate one
type: choice
ask: Samples {a} and {b} are {distance} r apart. Which one is eliminated?
option: The smaller number when: a < b => It comes first.
option: The larger number when: a > b => It comes last.
option: Neither survives when: false => One loss is enough.
```
# Two
```run
moment: end of tile
```
```gate two
type: number
ask: How many conflicts are there?
answer: conflicts()
wrong: 2 * conflicts() => Each has two ends.
otherwise: There are {samples()} samples.
because: There are {conflicts()}.
```
";

/// Checks a lesson in 20 runs.
fn all_faults(text: &str) -> Vec<LessonError> {
    let lesson = Lesson::read("test", text).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let mut runs = Runs::default();
    let found = check(&lesson, 20, &mut runs, &mut Unobserved, &mut |_| true);
    found.unwrap().faults
}

#[test]
fn a_lesson_that_breaks_one_rule_has_faults_of_this_rule_only() {
    assert_eq!(all_faults(SOUND), []);
    for (from, to, line, part) in [
        // Every answer has a reply.
        (" => One loss is enough.", "", 18, "has no reason"),
        (
            "otherwise: There are {samples()} samples.\n",
            "",
            24,
            "otherwise",
        ),
        (
            "There are {samples()} samples",
            "Count again",
            29,
            "about the run",
        ),
        ("because: There are {conflicts()}.\n", "", 24, "because"),
        (
            "There are {conflicts()}.",
            "As many as lines.",
            30,
            "exact number",
        ),
        // Not by reading.
        (
            "The order decides.",
            "The larger number goes for an even seed, the one with the small one otherwise.",
            17,
            "stands in the text",
        ),
        // New each time.
        ("answer: conflicts()", "answer: 4", 24, "the answer differs"),
        (
            "Samples {a} and {b} are {distance} r apart.",
            "Here are {2.5}.",
            13,
            "the question names",
        ),
        ("(a < b) == odd_run()", "(a < b)", 16, "right in 100%"),
        (
            "option: Neither survives when: false => One loss is enough.\n",
            "",
            13,
            "three options",
        ),
        (
            "moment: end of tile",
            &format!("moment: before eliminate\nwhere: {INSIDE}"),
            21,
            "event of \"one\"",
        ),
        // In view.
        ("> 2.5", "< 2.4", 6, "domain's border"),
        (
            "leaf: 6\n",
            "leaf: 6\ncamera: [0.0, 0.0] radii 4\n",
            6,
            "the edge of a canvas",
        ),
        // The whole picture.
        (
            "moment: end of tile",
            "moment: end of tile\nlayers: conflicts",
            21,
            "samples at their ends",
        ),
        // Not by guessing.
        (
            "answer: conflicts()",
            "tolerance: 15\nanswer: conflicts()",
            13,
            "who guesses",
        ),
    ] {
        assert!(SOUND.contains(from), "{from}");
        let faults = all_faults(&SOUND.replacen(from, to, 1));
        let is_this = |fault: &LessonError| fault.line == line && fault.message.contains(part);
        assert!(
            !faults.is_empty() && faults.iter().all(is_this),
            "{from} -> {to}: {faults:?}"
        );
    }
}

#[test]
fn samples_that_are_chosen_between_are_apart_on_every_canvas() {
    let lesson = |camera: &str| {
        let gate = "type: pick\nask: Which one is eliminated?\ncandidates: s == a || s == b\nanswer: s == b";
        let run = format!(
            "leaf: 6\nmoment: before eliminate\nwhere: distance > 0.6 && {INSIDE}\ncamera: {camera}"
        );
        asking(&format!("{gate}\notherwise: Not {{a}}.")).replacen(
            "leaf: 6\nmoment: end of tile",
            &run,
            1,
        )
    };
    let faults = all_faults(&lesson("fit"));
    assert_eq!(faults.len(), 1, "{faults:?}");
    assert!(faults[0].message.contains("px apart"), "{faults:?}");

    // The control: nearer, they are apart.
    assert_eq!(all_faults(&lesson("a radii 6")), []);
}

#[test]
fn a_picture_without_its_inserted_samples_is_named() {
    let lesson = |layers: &str| {
        let gate = "type: number\nask: How many?\nanswer: samples()\notherwise: Not {samples()}.\nbecause: {samples()}.";
        let moment = format!("moment: end of iterate-1\nlayers: {layers}");
        asking(gate).replacen("moment: end of tile", &moment, 1)
    };
    let faults = all_faults(&lesson("samples disks"));
    assert_eq!(faults.len(), 1, "{faults:?}");
    assert!(faults[0].message.contains("holes that are none"));
    assert_eq!(all_faults(&lesson("samples disks inserted")), []);
}

/// Practice draws another run where something would be out of sight.
#[test]
fn practice_shows_all_that_its_question_is_about() {
    let text = SOUND.replacen(INSIDE, "(a < b) == odd_run()", 1);
    let lesson = Lesson::read("test", &text).unwrap();
    let mut runs = Runs::default();
    let mut is_shown = |seed| {
        let run = lesson.steps[0].scene.run(Some(seed));
        let recording = runs.of(&run, &mut Unobserved).unwrap();
        let mut learner = Learner::new(Arc::new(lesson.clone()), Arc::default());
        assert!(learner.practise_seed(seed));
        learner.arrive(&recording, 0.0).unwrap() == Arrival::Here
    };
    let shown = (1..=20).filter(|&seed| is_shown(seed)).count();
    assert!((1..20).contains(&shown), "{shown}");
}

#[test]
fn a_lesson_has_one_check_of_reading() {
    let said = SOUND.replace(
        "The order decides.",
        "The larger number goes, or the smaller number.",
    );
    let once = said.replace("type: choice", "type: choice\nread: yes");
    assert_eq!(all_faults(&once), []);
    let twice = once.replace("type: number", "type: number\nread: yes");
    let faults = all_faults(&twice);
    assert_eq!(faults.len(), 1, "{faults:?}");
    assert!(faults[0].message.contains("at most one question"));
}

#[test]
fn a_lesson_without_a_misconception_is_named() {
    let begin = SOUND.find("type: choice").unwrap();
    let end = begin + SOUND[begin..].find("```").unwrap();
    let number = "type: number\nask: How many?\nanswer: samples()\notherwise: Not {samples()}.\nbecause: {samples()}.\n";
    let text = format!("{}{number}{}", &SOUND[..begin], &SOUND[end..]);
    let text = text.replace("wrong: 2 * conflicts() => Each has two ends.\n", "");
    let faults = all_faults(&text);
    assert_eq!(faults.len(), 1, "{faults:?}");
    assert!(
        faults[0]
            .message
            .contains("no question shows a misconception")
    );
}
