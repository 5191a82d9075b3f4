//! The lessons that come with the program: every question of 40 runs, three learners, translations, and pinned keys. All
//! are checked at once, since they share runs.

use tilescope_core::Unobserved;
use tilescope_lessons::{Lesson, Runs, Translation, check, shipped};

/// How many seeds each question is asked with.
const SEEDS: usize = 40;

#[test]
fn every_lesson_is_sound_translated_and_has_its_pinned_keys() {
    let mut runs = Runs::default();
    let mut faults = Vec::new();
    for shipped in shipped::lessons() {
        let lesson = Lesson::read(&shipped.name, &shipped.text);
        let lesson = lesson.unwrap_or_else(|error| panic!("{}.md: {error}", shipped.name));
        let gates = lesson.gates().count();
        assert!(
            (2..=5).contains(&gates) && (4..=8).contains(&lesson.steps.len()),
            "{}",
            shipped.name
        );
        let found = check(&lesson, SEEDS, &mut runs, &mut Unobserved, &mut |_| true).unwrap();
        faults.extend(
            found
                .faults
                .iter()
                .map(|fault| format!("{}.md: {fault}", shipped.name)),
        );
        assert!(
            found.perfect > 0.999 && found.guessing < 0.75,
            "{}: {found:?}",
            shipped.name
        );
        let translation = Translation::read(&shipped.german).unwrap();
        let (missing, stale) = translation.compared(&lesson);
        faults.extend(
            missing
                .iter()
                .map(|text| format!("{}.de.md lacks \"{text}\"", shipped.name)),
        );
        faults.extend(
            stale
                .iter()
                .map(|text| format!("{}.de.md: stale \"{text}\"", shipped.name)),
        );
        let lines = shipped.keys.lines().zip(found.keys.lines()).enumerate();
        for (line, (pinned, now)) in lines.filter(|(_, (pinned, now))| pinned != now).take(3) {
            faults.push(format!(
                "{}.keys, line {}: {now}, pinned {pinned}",
                shipped.name,
                line + 1
            ));
        }
        if shipped.keys.lines().count() != found.keys.lines().count() {
            faults.push(format!(
                "{}.keys: tilescope lesson keys writes it",
                shipped.name
            ));
        }
        runs.clear();
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn lessons_travel_as_json() {
    let lessons = shipped::lessons();
    let again = shipped::from_json(&shipped::to_json(&lessons)).unwrap();
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
