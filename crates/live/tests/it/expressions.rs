//! Conditions and watches with numbers of the moment.

use std::sync::Arc;

use tilescope_analysis::measures::Part;
use tilescope_debugger::{DEFAULT_BUDGET, Debugger, Direction, Listings, Stop};
use tilescope_live::{Course, add_numbers};

use crate::support::{from_nothing, record, variants};

#[test]
fn a_breakpoint_stops_at_the_first_gap() {
    let recording = Arc::new(record(&variants()[0]));
    let mut debugger = Debugger::new(Arc::clone(&recording), DEFAULT_BUDGET);
    add_numbers(debugger.evaluator_mut(), &recording);
    assert_eq!(debugger.evaluate("samples()"), Ok("0".to_owned()));
    assert_eq!(debugger.evaluate("gaps()"), Ok("none".to_owned()));
    assert!(
        debugger.evaluate("peak()").is_err(),
        "it needs the spectrum"
    );

    // The line that inserts a sample, after which a gap is filled.
    let line = Listings::shipped().find("insert.3").unwrap();
    debugger.add_breakpoint(line, "gaps() < 5 && conflicts() == 0");
    assert_eq!(debugger.run(Direction::Forwards), Stop::Breakpoint(0));
    let cursor = debugger.state().cursor();
    let course = Course::of_recording(&recording);
    let gaps = |cursor| {
        from_nothing(&course, cursor, &[Part::Report])
            .verdict()
            .unwrap()
            .gaps
    };
    assert!(gaps(cursor) < 5);
    assert_eq!(debugger.evaluate("gaps()"), Ok(gaps(cursor).to_string()));

    // The control: one insertion before, the condition did not hold.
    let before = course.changes_before(cursor);
    let earlier = course.changes()[before - 1].event as usize;
    assert!(gaps(earlier) >= 5, "{}", gaps(earlier));
}
