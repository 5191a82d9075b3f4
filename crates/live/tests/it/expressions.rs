//! Numbers of the moment in watches and conditions.

use std::sync::Arc;

use tilescope_analysis::measures::Part;
use tilescope_debugger::{
    DEFAULT_BUDGET, Debugger, Direction, ExpressionError, Listings, NAMES, Recording, Stop, words,
};
use tilescope_live::{Course, MOMENT_NUMBERS};

use crate::support::{from_nothing, record, variants};

/// Returns a debugger of a run whose expressions can name numbers.
fn debugger() -> (Arc<Recording>, Debugger) {
    let recording = Arc::new(record(&variants()[0]));
    recording.give_numbers(|| Arc::clone(&MOMENT_NUMBERS));
    let debugger = Debugger::new(Arc::clone(&recording), DEFAULT_BUDGET);
    (recording, debugger)
}

/// Returns the open places at a cursor, from nothing.
fn gaps(course: &Course, cursor: usize) -> usize {
    let set = from_nothing(course, cursor, &[Part::Report]);
    set.verdict().unwrap().gaps as usize
}

#[test]
fn a_condition_stops_where_its_number_says() {
    let (recording, mut debugger) = debugger();
    let line = Listings::shipped().find("insert.3").unwrap();
    debugger.add_breakpoint(line, "gaps < 5 && conflicts == 0");
    assert_eq!(debugger.run(Direction::Forwards), Stop::Breakpoint(0));

    let (course, cursor) = (Course::of_recording(&recording), debugger.state().cursor());
    let here = gaps(&course, cursor);
    assert!(here < 5);
    assert_eq!(debugger.evaluate("gaps"), Ok(here.to_string()));

    // The control: one insertion before, the condition did not hold.
    let before = course.changes_before(cursor);
    let earlier = course.changes()[before - 1].event as usize;
    assert!(gaps(&course, earlier) >= 5);
    debugger.jump(earlier);
    assert_eq!(debugger.evaluate("gaps < 5"), Ok("false".to_owned()));
}

#[test]
fn watches_have_every_live_number_and_conditions_those_without_a_spectrum() {
    let (recording, mut debugger) = debugger();
    assert_eq!(debugger.evaluate("samples"), Ok("0".to_owned()));
    assert_eq!(debugger.evaluate("gaps"), Ok("none".to_owned()));
    debugger.jump(recording.len());
    assert_eq!(debugger.evaluate("gaps + conflicts"), Ok("0".to_owned()));
    assert_eq!(
        debugger.evaluate("min_distance_r >= 1"),
        Ok("true".to_owned())
    );

    let line = Listings::shipped().find("insert.3").unwrap();
    for number in &MOMENT_NUMBERS.names {
        assert!(debugger.evaluate(number.name).is_ok(), "{}", number.name);
        debugger.add_breakpoint(line, &format!("{} > 0.5", number.name));
        let index = debugger.breakpoints().len() - 1;
        let refused = ["peak", "low_power", "anisotropy", "spectral_slope"].contains(&number.name);
        match debugger.breakpoints()[index].error() {
            Some(error @ ExpressionError::NotInConditions { .. }) if refused => {
                assert!(error.to_string().contains(number.name), "{error}");
            }
            other => assert!(other.is_none() && !refused, "{}: {other:?}", number.name),
        }
    }
}

/// A watch never waits for more steps than it has, and has the same value in the end.
#[test]
fn a_watch_is_pending_until_its_number_is_measured() {
    let (recording, mut debugger) = debugger();
    let far = Course::of_recording(&recording).events() / 2;
    debugger.jump(far);
    debugger.watches.push("gaps".to_owned());
    debugger.watches.push("inserted".to_owned());

    let mut calls = 0;
    let value = loop {
        let values = debugger.watch_values(2_000);
        // What takes no measuring is there at once.
        assert!(values[1].1.is_ok());
        match values[0].1.clone() {
            Err(ExpressionError::Pending { name: "gaps" }) => calls += 1,
            value => break value,
        }
        assert!(calls < 10_000);
    };
    assert!(calls > 5, "{calls}");
    let expected = gaps(&Course::of_recording(&recording), far);
    assert_eq!(value, Ok(expected.to_string()));
    assert_eq!(debugger.evaluate("gaps"), value);
}

#[test]
fn a_number_is_no_function_property_or_text() {
    let (_, debugger) = debugger();
    for text in ["\"gaps\"", "\"peak\" == \"peak\""] {
        assert!(debugger.evaluate(text).is_ok(), "{text}");
    }
    assert!(debugger.evaluate("gaps()").is_err());
    assert_eq!(words("a.gaps + gaps ( )").len(), 3);
    // An escaped sign ends no text, but a backslash between backquotes escapes nothing.
    assert_eq!(words(r#""a\" gaps""#), []);
    assert_eq!(words(r"`a\` + gaps").len(), 1);

    // The control: a recording that was given none.
    let plain = Debugger::new(Arc::new(record(&variants()[0])), DEFAULT_BUDGET);
    assert!(plain.evaluate("gaps").is_err());
}

#[test]
fn no_number_has_the_name_of_another_value() {
    for number in &MOMENT_NUMBERS.names {
        assert!(NAMES.iter().all(|(name, _)| *name != number.name));
        assert!(!number.meaning.is_empty());
    }
}
