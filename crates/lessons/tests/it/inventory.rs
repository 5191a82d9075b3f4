//! The concept inventory: its two forms are sound, ask about the same with other instances, and are as hard for a learner who
//! guesses or has the misconceptions; and the guide says which lessons teach its concepts.

use std::collections::BTreeMap;
use std::sync::Arc;

use tilescope_core::Unobserved;
use tilescope_lessons::shipped::{self, Shipped};
use tilescope_lessons::{
    Answer, Arrival, ChoiceOption, Concept, Learner, Lesson, Runs, TestForm, Translation, check,
};

/// The largest difference of a learner's mean scores in the two forms.
const MAX_DIFFERENCE: f64 = 0.05;

fn forms() -> [Shipped; 2] {
    shipped::forms().try_into().expect("two forms")
}

fn read(form: &Shipped) -> Lesson {
    let lesson = Lesson::read(&form.name, &form.text);
    lesson.unwrap_or_else(|error| panic!("{}.md: {error}", form.name))
}

/// A question of a form as it is asked.
struct Item {
    concept: Concept,
    kind: &'static str,
    /// The options in the file; the one with a reason is the misconception.
    options: Vec<ChoiceOption>,
    /// The question and its options, with the values of the run.
    instance: String,
    /// The mean score of a learner who takes any option.
    guessed: f64,
    /// The score of a learner who takes the misconception.
    misconceived: f64,
}

/// Asks the questions of a form.
fn items(lesson: &Lesson, runs: &mut Runs) -> Vec<Item> {
    let lesson = Arc::new(lesson.clone());
    let steps = lesson.steps.iter().enumerate();
    let gates = steps.filter_map(|(index, step)| Some((index, step, step.gate.as_ref()?)));
    let ask = |(index, step, gate): (usize, &tilescope_lessons::Step, &tilescope_lessons::Gate)| {
        let recording = runs.of(&step.scene.run(None), &mut Unobserved).unwrap();
        let asked = || {
            let mut learner = Learner::new(Arc::clone(&lesson), Arc::default());
            learner.go(index);
            assert_eq!(learner.arrive(&recording, 0.0), Ok(Arrival::Here));
            learner
        };
        let learner = asked();
        let question = learner.question().expect("a question");
        let (options, shown) = (gate.kind.options(), question.options());
        // A trace has options too, but no letter that is right throughout.
        assert!(
            question.right_option().is_some(),
            "{}: votes need the letters of a choice",
            gate.name
        );
        let score = |option: usize| {
            let mut learner = asked();
            let answer = learner.answer(&Answer::Choice(option), 1.0);
            answer.expect("an option").score
        };
        let all = shown.iter().enumerate();
        let guessed: f64 = all.map(|(option, _)| score(option)).sum();

        let believed = options.iter().find(|option| option.sentence.is_some());
        let believed = believed.unwrap_or_else(|| panic!("{}: no misconception", gate.name));
        let believed = learner.words(&believed.text.text);
        let believed = shown.iter().position(|text| *text == believed);
        let mut sorted = shown.to_vec();
        sorted.sort();
        Item {
            concept: gate.concept.expect("a concept"),
            kind: gate.kind_name,
            options: options.to_vec(),
            instance: format!("{} {}", question.ask(0), sorted.join(" ")),
            guessed: guessed / shown.len() as f64,
            misconceived: score(believed.expect("it is shown")),
        }
    };
    gates.map(ask).collect()
}

/// Returns an expression without the block whose event it names, which is part of the instance.
fn without_block(text: &str) -> String {
    let mut parts = text.split(" block=");
    let first = parts.next().unwrap_or_default();
    let rest = parts.map(|part| part.trim_start_matches(|c: char| c.is_ascii_digit()));
    std::iter::once(first).chain(rest).collect()
}

fn mean(items: &[Item], score: fn(&Item) -> f64) -> f64 {
    items.iter().map(score).sum::<f64>() / items.len() as f64
}

/// Returns in what the questions of two forms are not equivalent.
fn differences(one: &[Item], other: &[Item]) -> Vec<String> {
    let mut found = Vec::new();
    if one.len() != other.len() {
        found.push(format!("{} and {} questions", one.len(), other.len()));
    }

    let misconception = |item: &Item| {
        let mut options = item.options.iter();
        let option = options.find(|option| option.sentence.is_some());
        option.map(|option| {
            (
                without_block(&option.text.text),
                option.sentence.clone().map(|it| it.text),
            )
        })
    };
    for (a, b) in one.iter().zip(other) {
        let name = a.concept.name();
        for (what, is_same) in [
            ("concept", a.concept == b.concept),
            ("type", a.kind == b.kind),
            ("number of options", a.options.len() == b.options.len()),
            ("misconception", misconception(a) == misconception(b)),
            ("instance", a.instance != b.instance),
        ] {
            if !is_same {
                found.push(format!("{name}: {what}"));
            }
        }
    }

    for (who, score) in [
        ("guesser", (|item| item.guessed) as fn(&Item) -> f64),
        ("misconceived learner", |item| item.misconceived),
    ] {
        let [a, b] = [one, other].map(|items| mean(items, score));
        if (a - b).abs() > MAX_DIFFERENCE {
            found.push(format!("{who}: {a:.3} and {b:.3}"));
        }
    }
    found
}

#[test]
fn each_form_asks_about_every_concept_is_translated_and_has_its_pinned_keys() {
    let mut faults = Vec::new();
    for (form, is) in forms().iter().zip([TestForm::Before, TestForm::After]) {
        let lesson = read(form);
        assert_eq!(lesson.form, Some(is));
        let concepts: Vec<Concept> = lesson
            .gates()
            .filter_map(|(_, gate)| gate.concept)
            .collect();
        assert_eq!(concepts, Concept::ALL);

        let mut runs = Runs::default();
        let found = check(&lesson, 40, &mut runs, &mut Unobserved, &mut |_| true).unwrap();
        let name = &form.name;
        faults.extend(
            found
                .faults
                .iter()
                .map(|fault| format!("{name}.md: {fault}")),
        );
        assert_eq!(found.questions, 12, "{:?}", found.faults);
        if form.keys != found.keys {
            faults.push(format!("{name}.keys is not:\n{}", found.keys));
        }

        let translation = Translation::read(&form.german).unwrap();
        let (missing, stale) = translation.compared(&lesson.texts());
        faults.extend(
            missing
                .iter()
                .map(|text| format!("{name}.de.md lacks \"{text}\"")),
        );
        faults.extend(stale.iter().map(|fault| format!("{name}.de.md: {fault}")));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn the_forms_are_equivalent_and_share_no_instance() {
    let [before, after] = forms();
    // The forms below have the same scenes, whose runs are made once.
    let mut runs = Runs::default();
    let [one, other] = [&before, &after].map(|form| items(&read(form), &mut runs));
    assert_eq!(differences(&one, &other), Vec::<String>::new());

    // The control: what breaks one property is found, and is found as this property.
    let mut found = |changes: &[[&str; 2]]| {
        let mut text = after.text.to_string();
        for [from, to] in changes {
            assert!(text.contains(from), "{from}");
            text = text.replacen(from, to, 1);
        }
        let spoilt = Lesson::read("after", &text).unwrap();
        differences(&one, &items(&spoilt, &mut runs))
    };
    let fewer = found(&[["option: Only {a} when: !kept(b) && kept(a)\n", ""]]);
    assert_eq!(fewer, ["order: number of options"]);
    let another = found(&[[
        "option: No: its disks overlap",
        "option: No: its disks touch",
    ]]);
    assert_eq!(another, ["maximal: misconception"]);
    // The misconception is right, and what was right is wrong.
    let right = found(&[
        ["option: One when: true", "option: One when: false"],
        [
            "one for each block when: false",
            "one for each block when: true",
        ],
    ]);
    assert_eq!(right, ["misconceived learner: 0.000 and 0.083"]);
    let same = differences(&one, &one);
    assert_eq!(same.len(), 12, "{same:?}");
    assert!(same.iter().all(|it| it.ends_with(": instance")), "{same:?}");
}

/// Returns the rows of the guide's table of concepts, sorted: name, meaning, and the questions that teach it.
fn rows() -> Vec<String> {
    let guide = include_str!("../../../../assets/lessons/README.md");
    let (_, rest) = guide
        .split_once("| concept | is | taught by |\n|---|---|---|\n")
        .expect("the table");
    rest.lines()
        .take_while(|line| line.starts_with('|'))
        .map(str::to_owned)
        .collect()
}

#[test]
fn the_guide_says_which_questions_teach_each_concept() {
    let mut taught: BTreeMap<Concept, Vec<String>> = BTreeMap::new();
    for shipped in shipped::lessons() {
        let lesson = read(&shipped);
        assert_eq!(lesson.form, None);
        for (_, gate) in lesson.gates() {
            if let Some(concept) = gate.concept {
                let of = taught.entry(concept).or_default();
                of.push(format!("`{}`, {}", shipped.name, gate.name));
            }
        }
    }
    let row = |concept: Concept| {
        let by = taught.get(&concept).map(|of| of.join("; "));
        let by = by.unwrap_or_default();
        assert!(!by.is_empty(), "no lesson teaches {}", concept.name());
        format!("| `{}` | {} | {by} |", concept.name(), concept.meaning())
    };
    assert_eq!(rows(), Concept::ALL.map(row));
}

/// The plan of the lecture in `web/example/` links to both forms, by their titles.
#[test]
fn the_plan_of_the_lecture_offers_both_forms() {
    let plan = include_str!("../../../../web/example/plan.html");
    for form in forms() {
        let title = read(&form).title;
        let link = format!("<a href=\"../#lesson={}\">{title}</a>", form.name);
        assert!(plan.contains(&link), "{link}");
    }
}

#[test]
fn a_form_with_a_question_that_cannot_be_compared_or_gives_help_is_refused() {
    let text = |form: &str, gates: [&str; 2]| {
        let gate = |(index, fields): (usize, &str)| {
            format!(
                "# S{index}\n```gate g{index}\n{fields}\nask: How?\noption: A when: true\noption: B when: false => No.\n```\n"
            )
        };
        let gates: String = gates.into_iter().enumerate().map(gate).collect();
        format!("---\ntitle: T\nobjective: O\n{form}---\n{gates}")
    };
    let sound = [
        "type: choice\nconcept: loss",
        "type: choice\nconcept: reach",
    ];
    let lesson = Lesson::read("f", &text("form: after\n", sound)).unwrap();
    assert!(lesson.gates().all(|(_, gate)| gate.practice.is_none()));

    let events = "type: trace\nconcept: reach\nevents: keep";
    for (form, second, line, part) in [
        ("form: later\n", sound[1], 4, "before"),
        ("form: after\n", "type: choice", 15, "needs a \"concept\""),
        (
            "form: after\n",
            "type: choice\nconcept: loss",
            15,
            "\"loss\" already",
        ),
        ("form: after\n", "type: choice\nconcept: raech", 17, "reach"),
        (
            "form: after\n",
            "type: choice\nconcept: reach\nhint: So.",
            15,
            "no hint",
        ),
        ("form: after\n", events, 15, "no trace"),
    ] {
        let error = Lesson::read("f", &text(form, [sound[0], second])).unwrap_err();
        assert!(error.message.contains(part), "{second}: {error}");
        assert_eq!(error.line, line, "{second}: {error}");
    }

    // The control: a lesson may have all of these.
    assert!(Lesson::read("f", &text("", [sound[0], "type: choice\nhint: So."])).is_ok());
}
