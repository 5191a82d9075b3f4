//! Pages of a lesson, in both languages.

use super::*;

const ADDRESS: &str = "https://a.example/t/";

/// The lesson whose runs are made fastest.
fn cuts() -> Entry {
    let lessons = shipped::lessons();
    let lesson = lessons.iter().find(|lesson| lesson.name == "cuts");
    entry(lesson.expect("a lesson")).unwrap()
}

fn page(entry: &Entry, words: &Words, address: &str) -> String {
    lesson_page(entry, Some(entry), words, address).unwrap()
}

#[test]
fn marks_are_filled_and_wrong_ones_named() {
    let values = [("a", "1 [[b]]".to_owned()), ("b", "2".to_owned())];
    // What a value holds is no mark.
    assert_eq!(filled("x [[a]][[b]] ]]", &values).unwrap(), "x 1 [[b]]2 ]]");
    for (page, part) in [("[[c]]", "[[c]] is not known"), ("[[a", "not closed")] {
        let error = filled(page, &values).unwrap_err().to_string();
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn a_page_has_the_lesson_in_its_language_and_leads_into_the_program() {
    let entry = cuts();
    let english = page(&entry, &ENGLISH, "");
    let german = page(&entry, &GERMAN, "");

    for (page, words, link) in [
        (&english, &ENGLISH, "href=\"../../#lesson=cuts\""),
        (
            &german,
            &GERMAN,
            "href=\"../../../#lesson=cuts&amp;language=de\"",
        ),
    ] {
        let sheet = entry.sheet(words);
        assert!(page.contains(&format!("<h1>{}</h1>", plain_html(&sheet.title))));
        assert!(page.contains(&format!("<html lang=\"{}\">", words.tag)));
        assert!(page.contains(link), "{page}");
        assert_eq!(page.matches("<section>").count(), sheet.steps.len());
        let questions = sheet.steps.iter().filter(|step| !step.question.is_empty());
        // One more is the script that listens to the frames.
        assert_eq!(page.matches("data-snippet").count(), questions.count() + 1);
    }
    assert_ne!(entry.english.title, entry.german.title);

    // Without a public address nothing claims one.
    assert!(!english.contains("canonical") && !english.contains("og:url"));
    assert!(english.contains(SOME_ADDRESS));
}

#[test]
fn a_public_address_stands_in_every_place_that_needs_it() {
    let entry = cuts();
    let german = page(&entry, &GERMAN, ADDRESS);
    for part in [
        "<link rel=\"canonical\" href=\"https://a.example/t/lesson/cuts/de/\" />",
        "hreflang=\"en\" href=\"https://a.example/t/lesson/cuts/\"",
        "\"url\":\"https://a.example/t/lesson/cuts/de/\"",
        "src=&quot;https://a.example/t/?embed=player",
    ] {
        assert!(german.contains(part), "{part}");
    }
    assert!(!german.contains(SOME_ADDRESS));

    let map = sitemap(&[entry], ADDRESS);
    assert_eq!(map.matches("<loc>").count(), 3);
    assert!(map.contains("<loc>https://a.example/t/lesson/cuts/de/</loc>"));
}

#[test]
fn no_answer_stands_in_a_page() {
    let lessons = shipped::lessons();
    let lesson = lessons.iter().find(|lesson| lesson.name == "cuts");
    let lesson = lesson.expect("a lesson");
    let read = tilescope_lessons::Lesson::read(&lesson.name, &lesson.text).unwrap();
    let english = page(&cuts(), &ENGLISH, "");

    // Texts with values of the run are other ones on the page.
    let plain = |text: &&str| !text.contains(['{', '*', '`']) && !text.starts_with("- ");
    let after = read.steps.iter().flat_map(|step| &step.after);
    let notes = read.steps.iter().flat_map(|step| &step.notes);
    let hidden: Vec<&str> = after
        .chain(notes)
        .map(String::as_str)
        .filter(plain)
        .collect();
    assert!(!hidden.is_empty());
    for text in hidden {
        assert!(!english.contains(&plain_html(text)), "{text}");
    }

    // Control: a text that is meant to stand there is found.
    let shown = read.steps.iter().flat_map(|step| &step.text);
    let mut shown = shown.map(String::as_str).filter(plain);
    assert!(shown.all(|text| english.contains(&plain_html(text))));
}

#[test]
fn covers_and_the_large_picture_are_steps_of_lessons() {
    let lessons = shipped::lessons();
    for (name, number) in COVERS.into_iter().chain([HERO]) {
        let lesson = lessons.iter().find(|lesson| lesson.name == name);
        let lesson = lesson.unwrap_or_else(|| panic!("{name}"));
        let read = tilescope_lessons::Lesson::read(name, &lesson.text).unwrap();
        assert!((1..=read.steps.len()).contains(&number), "{name}");
    }
}
