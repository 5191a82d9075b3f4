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
