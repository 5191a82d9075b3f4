//! The lessons that come with the program: every question of 40 runs, three learners, translations, and pinned keys. Each
//! lesson is a test of its own, so that they run side by side.

use std::env::var_os;

use tilescope_core::{PatternSpec, Unobserved};
use tilescope_lessons::{Lesson, Runs, Translation, check, shipped};

/// Returns how many runs are made: questions are asked in at most 40 of them, claims are tested in all.
fn runs() -> usize {
    if var_os("TILESCOPE_SLOW").is_some_and(|value| value == "1") {
        200
    } else {
        40
    }
}

/// Checks a lesson, its translation and its pinned keys.
fn is_sound(name: &str) {
    let lessons = shipped::lessons();
    let shipped = lessons.iter().find(|shipped| shipped.name == name);
    let shipped = shipped.unwrap_or_else(|| panic!("no lesson is named {name}"));
    let lesson = Lesson::read(name, &shipped.text);
    let lesson = lesson.unwrap_or_else(|fault| panic!("{name}.md:{}: {fault}", fault.line));
    let gates = lesson.gates().count();
    assert!((2..=5).contains(&gates) && (4..=8).contains(&lesson.steps.len()));

    let mut made = Runs::default();
    let found = check(&lesson, runs(), &mut made, &mut Unobserved, &mut |_| true).unwrap();
    let of_lesson = found.faults.iter();
    let mut faults: Vec<String> = of_lesson.map(ToString::to_string).collect();
    assert!(found.perfect > 0.999 && found.guessing < 0.75, "{found:?}");

    let translation = Translation::read(&shipped.german).unwrap();
    let (missing, stale) = translation.compared(&lesson.texts());
    faults.extend(
        missing
            .iter()
            .map(|text| format!("{name}.de.md lacks \"{text}\"")),
    );
    faults.extend(
        stale
            .iter()
            .map(|text| format!("{name}.de.md: stale \"{text}\"")),
    );

    let lines = shipped.keys.lines().zip(found.keys.lines()).enumerate();
    for (line, (pinned, now)) in lines.filter(|(_, (pinned, now))| pinned != now).take(3) {
        faults.push(format!(
            "{name}.keys, line {}: {now}, pinned {pinned}",
            line + 1
        ));
    }
    if shipped.keys.lines().count() != found.keys.lines().count() {
        faults.push(format!("{name}.keys: tilescope lesson keys writes it"));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

macro_rules! sound {
    ($($name:ident),* $(,)?) => {
        const TESTED: &[&str] = &[$(stringify!($name)),*];
        $(
            #[test]
            fn $name() {
                is_sound(stringify!($name));
            }
        )*
    };
}

/// The lessons, each with the test that it is sound, translated and has its pinned keys.
mod every_lesson_is_sound {
    use super::is_sound;

    sound![
        welcome, maximal, spectrum, cuts, clips, survivors, losses, gaps, rounds, reach, tiling,
        exact, parallel, gluing, ranks, radii, space,
    ];

    #[test]
    fn and_none_is_left_out() {
        let shipped = tilescope_lessons::shipped::lessons();
        let names: Vec<&str> = shipped.iter().map(|one| one.name.as_ref()).collect();
        assert_eq!(names, TESTED);
    }
}

/// A step by exact tiling shows the set that every other part of the program makes with these parameters.
#[test]
fn exact_tilings_have_their_usual_pattern_in_each_practice() {
    let text = "---\ntitle: T\nobjective: O\n---\n# A\n```run\nmethod: exact\nradius: 0.02\nseed: 3\n```\nWords.\n\
                # B\n```run\npattern-side: 60\nseed: 4\n```\nWords.\n# C\n```run\nmethod: kdrt\n```\nWords.\n";
    let lesson = Lesson::read("t", text).expect("a lesson");
    let pattern = |step: usize, seed| lesson.steps[step].scene.run(seed).parameters.pattern;
    let of = |side, seed| PatternSpec {
        side,
        seed,
        ..PatternSpec::default()
    };
    assert_eq!(pattern(0, None), of(200.0, 3));
    assert_eq!(pattern(0, Some(9)), of(200.0, 9));
    // A given side stays, and is no choice of a seed.
    assert_eq!(pattern(1, None), of(60.0, 4));
    assert_eq!(pattern(1, Some(9)), of(60.0, 9));
    // KDRT has one pattern for all seeds.
    assert_eq!(pattern(2, None), of(60.0, 0));
    assert_eq!(pattern(2, Some(9)), of(60.0, 0));
}

#[test]
fn lessons_travel_as_json() {
    let lessons = shipped::lessons();
    let loaded = shipped::Loaded {
        lessons: lessons.clone(),
        tables: [("de".to_owned(), "Play\n    Abspielen\n".to_owned())].into(),
    };
    let shipped::Loaded {
        lessons: again,
        tables,
    } = shipped::from_json(&shipped::to_json(&loaded)).unwrap();
    assert_eq!(tables, loaded.tables);
    assert_eq!(again.len(), lessons.len());
    assert!(
        again
            .iter()
            .zip(&lessons)
            .all(|(a, b)| (&a.name, &a.text, &a.german) == (&b.name, &b.text, &b.german))
    );
    assert!(shipped::from_json("{}").is_err());
}

/// The plan in `web/example/` lists the lessons of the lecture, with their minutes and titles.
#[test]
fn the_plan_on_the_page_is_that_of_the_lecture() {
    let plan = include_str!("../../../../web/example/plan.html");
    let lessons = shipped::lessons();
    let mut at = 0;
    let mut from = 0;
    for (name, minutes) in shipped::LECTURE {
        let row = format!("<tr data-lesson=\"{name}\" data-minutes=\"{minutes}\">");
        let place = plan[at..].find(&row).unwrap_or_else(|| panic!("{row}"));
        at += place;
        let end = plan[at..].find("</tr>").expect("an end");
        let text = &plan[at..at + end];
        let lesson = lessons
            .iter()
            .find(|lesson| lesson.name == name)
            .expect("a lesson");
        let lesson = Lesson::read(name, &lesson.text).expect("it is sound");
        assert!(text.contains(&lesson.title), "{text}");
        let span = format!("<td>{from} \u{2013} {}</td>", from + minutes);
        assert!(text.contains(&span), "{text}");
        from += minutes;
    }
    assert_eq!(
        (from, plan.matches("<tr data-lesson").count()),
        (50, shipped::LECTURE.len())
    );
}
