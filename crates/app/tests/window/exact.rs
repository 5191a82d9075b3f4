//! Exact tiling in the window: the form says what its pattern means, and the inspector why a sample is there.

use serde_json::json;
use tilescope_classroom::lessons::LessonCommand;
use tilescope_core::{Fate, Origin, Parameter};
use tilescope_debugger::why_here;
use tilescope_lessons::shipped::{Shipped, lessons};
use tilescope_session::language::Language;
use tilescope_session::selection::Selection;
use tilescope_workbench::Command;
use tilescope_workbench::command::{FormCommand, ViewCommand, Which, WindowCommand};
use tilescope_workbench::compare::ComparePreset;
use tilescope_workbench::draft::Choice;
use tilescope_workbench::layout::Panel;

use crate::support::sessions::apply;
use crate::support::{debugger, find, node, opened, session, text};

fn form(command: FormCommand) -> Command {
    Command::Form(command)
}

fn exact() -> Command {
    form(FormCommand::Choose(Choice::Parameter(
        Parameter::Method,
        json!("exact"),
    )))
}

fn radius(text: &str) -> Command {
    form(FormCommand::Type(Parameter::Radius, text.to_owned()))
}

#[test]
fn the_form_says_what_the_pattern_means_and_offers_the_reference_sampler_where_it_does_not_pay() {
    let mut harness = opened();
    // Negative control: KDRT has a pattern whose seams matter more.
    assert!(find(&harness, "shared-pattern").is_none());

    for command in [radius("0.0064"), exact()] {
        apply(&mut harness, command);
    }
    let said = text(&harness, "shared-pattern");
    assert!(
        said.starts_with("N / k = 0.61: about 17,000 samples share a pattern of 28,000."),
        "{said}"
    );
    assert!(
        said.ends_with("vary about as those of 11,000 independent samples."),
        "{said}"
    );
    let time = text(&harness, "shared-pattern-time");
    assert_eq!(
        time,
        "From nothing about 0.16 s, of which the pattern takes 0.15 s; the reference sampler about 0.041 s."
    );

    // A small pattern repeats within blocks, and the text says that.
    let side = |text: &str| form(FormCommand::Type(Parameter::PatternSide, text.to_owned()));
    apply(&mut harness, side("30"));
    let repeating = text(&harness, "shared-pattern");
    assert!(
        repeating.contains("narrower") && !said.contains("narrower"),
        "{repeating}"
    );
    apply(&mut harness, side("200"));

    // German and Spanish windows have these texts in their languages.
    for tag in ["de", "es"] {
        let language = Language::of(tag).expect("a table");
        for english in [&said, &repeating, &time, "Use the reference sampler"] {
            assert!(language.translated(english).is_some(), "{tag}: {english}");
        }
    }

    // A large set pays for its pattern, so that nothing is offered.
    assert!(find(&harness, "reference-sampler").is_some());
    apply(&mut harness, radius("0.001"));
    assert!(find(&harness, "shared-pattern").is_some());
    assert!(find(&harness, "reference-sampler").is_none());

    apply(&mut harness, radius("0.02"));
    node(&harness, "reference-sampler").click();
    harness.run();
    assert!(find(&harness, "no-tiling").is_some() && find(&harness, "shared-pattern").is_none());
    apply(&mut harness, Command::Run);
    let set = session(&harness);
    assert!(set.ground.is_some() && !set.is_exact());
    assert!(
        (1_650..1_850).contains(&set.summary.count),
        "{}",
        set.summary.count
    );
}

#[test]
fn the_inspector_says_in_one_line_why_a_sample_is_there() {
    let mut harness = opened();
    for command in [
        exact(),
        radius("0.02"),
        Command::Run,
        Command::Window(WindowCommand::OpenPanel(Panel::Inspector)),
    ] {
        apply(&mut harness, command);
    }

    let set = session(&harness);
    let samples = &set.run().samples;
    let of = |wanted: fn(&Origin, &Fate) -> bool| {
        let mut all = samples.origins.iter().zip(&samples.fates);
        all.position(|(origin, fate)| wanted(origin, fate))
            .expect("a sample") as u32
    };
    for id in [
        of(|_, fate| matches!(fate, Fate::Eliminated { .. })),
        of(|origin, _| matches!(origin, Origin::Tiled { .. })),
        of(|origin, _| matches!(origin, Origin::Inserted { .. })),
    ] {
        let pick = ViewCommand::Pick(Selection::Sample(id));
        apply(&mut harness, Command::View(Which::First, pick));
        let line = why_here(debugger(&harness).recording(), id).expect("an exact tiling");
        assert_eq!(text(&harness, "why-here"), line);
        for tag in ["de", "es"] {
            let language = Language::of(tag).expect("a table");
            assert!(language.translated(&line).is_some(), "{tag}: {line}");
        }
    }

    // Who came first is what a lesson asks: while its question is open, the line is not there.
    let pick = Command::View(Which::First, ViewCommand::Pick(Selection::Sample(0)));
    for command in [
        LessonCommand::Open("exact".into()),
        LessonCommand::Go("chain".into()),
    ] {
        apply(&mut harness, Command::Lesson(command));
    }
    apply(&mut harness, pick);
    let state = &harness.state().state;
    assert!(state.lessons().veil().is_some() && session(&harness).is_exact());
    assert!(find(&harness, "why-here").is_none());
}

#[test]
fn the_lesson_names_the_button_of_compare_as_the_window_does() {
    let all = lessons();
    let lesson: &Shipped = all
        .iter()
        .find(|lesson| lesson.name == "exact")
        .expect("a lesson");
    let english = ComparePreset::Method.name();
    let german = Language::of("de")
        .expect("a table")
        .translated(english)
        .expect("a row");
    assert!(lesson.text.contains(&format!("*{english}*")));
    assert!(lesson.german.contains(&format!("*{german}*")), "{german}");
    // Negative control: no button has the name of another one.
    assert_ne!(german, english);
    let spanish = Language::of("es").expect("a table");
    for preset in ComparePreset::ALL {
        for language in [Language::of("de").expect("a table"), spanish] {
            assert!(
                language.translated(preset.name()).is_some(),
                "{}",
                preset.name()
            );
        }
    }
}
