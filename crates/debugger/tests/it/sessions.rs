//! Moves, breakpoints, watches, causes, histories, queries and saved sessions on small runs.

use std::sync::Arc;

use tilescope_core::{Origin, R, RunEvent, TilingMethod, Unobserved};
use tilescope_debugger::{
    DEFAULT_BUDGET, Debugger, Direction, EventKind, Listings, Query, Recording, Session,
    SessionError, Status, Step, Stop, Target, moves, why,
};

use crate::support::{record, restored, variants};

const FORWARDS: Direction = Direction::Forwards;
const BACKWARDS: Direction = Direction::Backwards;

fn debugger(variant: usize) -> Debugger {
    let recording = Arc::new(record(&variants()[variant], DEFAULT_BUDGET));
    Debugger::new(recording, DEFAULT_BUDGET)
}

fn last_kind(debugger: &Debugger) -> Option<EventKind> {
    let last = debugger.state().cursor().checked_sub(1)?;
    debugger
        .recording()
        .event(last)
        .map(tilescope_debugger::Event::kind)
}

#[test]
fn steps_respect_the_depth_of_events() {
    let mut debugger = debugger(2);
    let take = debugger.run_to(Target::Kind(EventKind::Eliminate), FORWARDS);
    assert_eq!(take, Stop::Target);
    assert_eq!(last_kind(&debugger), Some(EventKind::Eliminate));
    debugger.step(Step::Into, BACKWARDS);
    let at = debugger.state().cursor();
    debugger.step(Step::Out, BACKWARDS);
    let search = debugger.event().unwrap();
    assert!(search.depth() < 4, "{search:?}");
    debugger.step(Step::Out, BACKWARDS);
    assert_eq!(debugger.event().unwrap().kind(), EventKind::Take);
    let taken = debugger.state().cursor();
    assert!(taken < at);
    debugger.step(Step::Over, FORWARDS);
    assert_eq!(debugger.event().unwrap().kind(), EventKind::Take);
    assert!(debugger.state().cursor() > at);
    debugger.step(Step::Into, BACKWARDS);
    debugger.step(Step::Into, FORWARDS);
    debugger.jump(taken);
    debugger.step(Step::Into, FORWARDS);
    assert_eq!(debugger.state().cursor(), taken + 1);
}

#[test]
fn stepping_off_either_end_stays_there() {
    let mut debugger = debugger(0);
    debugger.step(Step::Into, BACKWARDS);
    assert_eq!(debugger.state().cursor(), 0);
    debugger.jump(usize::MAX);
    let end = debugger.recording().len();
    assert_eq!(debugger.state().cursor(), end);
    debugger.step(Step::Over, FORWARDS);
    assert_eq!(debugger.state().cursor(), end);
    assert_eq!(debugger.event(), None);
}

#[test]
fn runs_reach_what_they_look_for_both_ways() {
    for variant in 0..8 {
        let mut debugger = debugger(variant);
        for target in [
            Target::Conflict,
            Target::Elimination,
            Target::Gap,
            Target::Insertion,
        ] {
            debugger.jump(0);
            assert_eq!(
                debugger.run_to(target, FORWARDS),
                Stop::Target,
                "{variant} {target:?}"
            );
            // Nothing is passed over, and what was reached is the last event.
            let recording = Arc::clone(debugger.recording());
            let meant = |index: usize| {
                let event = recording.event(index).unwrap();
                moves::matches_target(&recording, index, event, target)
            };
            let first = debugger.state().cursor();
            assert!(meant(first - 1) && !(0..first - 1).any(meant));
            assert_eq!(debugger.run_to(target, FORWARDS), Stop::Target);
            let second = debugger.state().cursor();
            assert!(meant(second - 1) && !(first..second - 1).any(meant));
            // The way back ends at the same moments.
            assert_eq!(debugger.run_to(target, BACKWARDS), Stop::Target);
            assert_eq!(debugger.state().cursor(), first);
            assert_eq!(debugger.run_to(target, BACKWARDS), Stop::End);
            assert_eq!(debugger.state().cursor(), first);
        }
        debugger.jump(0);
        assert_eq!(debugger.run_to(Target::Violation, FORWARDS), Stop::End);
        assert_eq!(debugger.state().cursor(), 0);
    }
}

#[test]
fn a_run_to_a_line_stops_before_it_as_a_breakpoint_does() {
    let mut debugger = debugger(0);
    let line = Listings::shipped().find("eliminate.5").unwrap();
    debugger.add_breakpoint(line, "");
    debugger.run(FORWARDS);
    let stopped = debugger.state().cursor();
    assert_eq!(debugger.event().unwrap().line(), line);
    debugger.jump(0);
    debugger.run_to(Target::Line(line), FORWARDS);
    assert_eq!(debugger.state().cursor(), stopped);
    debugger.jump(0);
    debugger.run_to(Target::Elimination, FORWARDS);
    assert_eq!(debugger.state().cursor(), stopped + 1);
}

#[test]
fn the_first_event_is_reached_and_both_ends_are_ends() {
    let mut debugger = debugger(0);
    let begin = Target::Kind(EventKind::Begin);
    assert_eq!(debugger.run_to(begin, BACKWARDS), Stop::End);
    assert_eq!(debugger.run_to(begin, FORWARDS), Stop::Target);
    assert_eq!(debugger.state().cursor(), 1);
    assert_eq!(debugger.run_to(begin, BACKWARDS), Stop::End);
    debugger.jump(usize::MAX);
    let end = debugger.state().cursor();
    let finish = Target::Kind(EventKind::Finish);
    assert_eq!(debugger.run_to(finish, FORWARDS), Stop::End);
    debugger.jump(end - 1);
    assert_eq!(debugger.run_to(finish, FORWARDS), Stop::Target);
    assert_eq!(debugger.state().cursor(), end);
}

#[test]
fn events_have_the_same_numbers_in_queries_and_expressions() {
    let mut debugger = debugger(0);
    let recording = Arc::clone(debugger.recording());
    for number in [1, 2, 40, recording.len()] {
        let query = Query::parse(&format!("event={number}")).unwrap();
        // The event that is about to happen at a cursor has the cursor as its index, and the next number.
        assert_eq!(query.find_all(&recording, 9), [number - 1]);
        debugger.jump(number - 1);
        assert_eq!(debugger.evaluate("event").unwrap(), number.to_string());
    }
}

#[test]
fn a_second_insertion_lies_beside_an_inserted_sample() {
    let recording = record(&variants()[0], DEFAULT_BUDGET);
    let second = moves::run_to(&recording, 0, Target::SecondInsertion, FORWARDS).unwrap();
    let sample = recording.event(second).unwrap().samples()[0];
    let near = recording.valid_near(recording.point(sample).unwrap(), 4 * R, second);
    let inserted = |&id: &u32| {
        matches!(
            recording.run().samples.origins[id as usize],
            Origin::Inserted { .. }
        )
    };
    assert!(near.iter().any(inserted));
}

#[test]
fn an_engine_that_keeps_two_samples_within_r_is_caught() {
    let parameters = variants()[0];
    let good = record(&parameters, DEFAULT_BUDGET);
    let mut run = good.run().clone();
    let kept: Vec<u32> = run.result.clone();
    // The second sample is moved onto the first.
    run.samples.points[kept[1] as usize] = run.samples.points[kept[0] as usize];
    let mut tape = tilescope_debugger::Tape::new(&parameters, DEFAULT_BUDGET);
    tilescope_core::sample_recorded(&parameters, &mut Unobserved, &mut tape).unwrap();
    tape.seal();
    let bad = Recording::of(run, tape);
    let event = moves::run_to(&bad, 0, Target::Violation, FORWARDS).unwrap();
    assert!(kept[..2].contains(&bad.event(event).unwrap().samples()[0]));
}

#[test]
fn every_change_has_a_chain_of_causes_up_to_a_split() {
    for parameters in variants() {
        let recording = record(&parameters, DEFAULT_BUDGET);
        let mut checked = 0;
        for (index, event) in recording.tape().from(0) {
            if matches!(
                event.kind(),
                EventKind::Eliminate | EventKind::Insert | EventKind::Keep | EventKind::Tiled
            ) && index % 7 == 0
            {
                let causes = why::causes(&recording, index);
                assert!(causes.is_sorted_by(|a, b| a > b));
                let first = recording.event(*causes.last().unwrap()).unwrap();
                let expected = match event.kind() {
                    // A dart is thrown whatever there was: its chain ends at the iteration.
                    EventKind::Insert
                        if parameters.insertion == tilescope_core::Insertion::Uniform =>
                    {
                        EventKind::Iteration
                    }
                    _ => EventKind::Split,
                };
                assert_eq!(first.kind(), expected, "{event:?} {causes:?}");
                checked += 1;
            }
        }
        assert!(checked > 50);
    }
}

#[test]
fn an_eliminated_samples_history_tells_its_life() {
    let recording = record(&variants()[0], DEFAULT_BUDGET);
    let lost = moves::run_to(&recording, 0, Target::Elimination, FORWARDS).unwrap();
    let Some(RunEvent::Eliminate { sample, by }) = recording.event(lost).unwrap().run_event()
    else {
        panic!("an elimination");
    };
    let history = why::history_of_sample(&recording, sample);
    let life = recording.life(sample).unwrap();
    assert_eq!(history[0], life.born as usize);
    assert!(history.contains(&lost));
    assert_eq!(recording.status(sample, lost), Status::Undecided);
    assert_eq!(recording.status(sample, lost + 1), Status::Eliminated);
    let history = why::history_of_point(&recording, recording.point(sample).unwrap());
    assert!(
        history.contains(&lost) && history.contains(&(recording.life(by).unwrap().kept as usize))
    );
    assert_eq!(
        recording.event(history[0]).unwrap().kind(),
        EventKind::Split
    );
}

#[test]
fn queries_find_what_a_plain_scan_finds() {
    let recording = record(&variants()[0], DEFAULT_BUDGET);
    let query = |text: &str| Query::parse(text).unwrap().find_all(&recording, usize::MAX);
    let inserted = query("insert");
    assert_eq!(
        inserted.len(),
        recording.run().summary().inserted.iter().sum::<usize>()
    );
    let first = query("insert iteration=1");
    assert_eq!(first.len(), recording.run().summary().inserted[0]);
    assert_eq!(
        first.len() + query("insert iteration>1").len(),
        inserted.len()
    );
    let sample = recording.event(inserted[0]).unwrap().samples()[0];
    assert_eq!(
        query(&format!("sample={sample}")),
        why::history_of_sample(&recording, sample)
    );
    assert_eq!(
        query("tiled block=1").len(),
        recording.run().tiles[1].samples.len()
    );
    assert_eq!(query("").len(), recording.len());
    assert_eq!(Query::parse("").unwrap().find_all(&recording, 3), [0, 1, 2]);
}

#[test]
fn a_conditional_breakpoint_stops_where_its_condition_holds() {
    let mut debugger = debugger(0);
    let line = Listings::shipped().find("eliminate.5").unwrap();
    debugger.add_breakpoint(line, "distance < 0.5 && p == b");
    assert_eq!(debugger.run(FORWARDS), Stop::Breakpoint(0));
    let first = debugger.state().cursor();
    let distance: f64 = debugger.evaluate("distance").unwrap().parse().unwrap();
    assert!(distance < 0.5);
    while debugger.run(FORWARDS) != Stop::End {}
    assert_eq!(debugger.state().cursor(), debugger.recording().len());
    let mut last = 0;
    while debugger.run(BACKWARDS) != Stop::End {
        last = debugger.state().cursor();
    }
    assert_eq!(last, first);
    debugger.enable_breakpoint(0, false);
    assert_eq!(debugger.run(FORWARDS), Stop::End);
}

#[test]
fn errors_of_expressions_are_values() {
    let mut debugger = debugger(0);
    debugger.watches = ["1 + 2", "kind", "p", "nonsense", "1 +", "p + 1"]
        .map(String::from)
        .to_vec();
    let values = debugger.watch_values(u64::MAX);
    assert_eq!(values[0].1, Ok("3".to_owned()));
    assert_eq!(values[1].1, Ok("begin".to_owned()));
    assert_eq!(values[2].1, Ok("none".to_owned()));
    for (text, value) in &values[3..] {
        assert!(value.is_err(), "{text}");
    }
    assert!(
        debugger
            .evaluate(&"1+".repeat(1_000))
            .unwrap_err()
            .to_string()
            .contains("more than")
    );
    assert!(debugger.evaluate("eval(\"1\")").is_err());
    assert!(debugger.evaluate("while true {}").is_err());
    let line = Listings::shipped().find("eliminate.2").unwrap();
    debugger.add_breakpoint(line, "1 +");
    assert!(debugger.breakpoints()[0].error().is_some());
    assert!(matches!(debugger.run(FORWARDS), Stop::BadCondition(0, _)));
    debugger.remove_breakpoint(0);
    debugger.add_breakpoint(line, "p");
    assert!(matches!(debugger.run(FORWARDS), Stop::BadCondition(0, _)));
}

#[test]
fn every_name_in_scope_has_a_value() {
    let mut debugger = debugger(2);
    debugger.run_to(Target::Insertion, FORWARDS);
    for (name, _) in tilescope_debugger::NAMES {
        let value = debugger.evaluate(name);
        assert!(value.is_ok(), "{name}: {value:?}");
    }
    assert_eq!(
        debugger.evaluate("distance(p, p)"),
        Ok("0.000000".to_owned())
    );
    assert_eq!(debugger.evaluate("x_of(p) == x"), Ok("true".to_owned()));
}

#[test]
fn a_saved_session_comes_back_as_it_was() {
    let mut debugger = debugger(1);
    let line = Listings::shipped().find("darts.5").unwrap();
    debugger.add_breakpoint(line, "iteration > 1");
    debugger.enable_breakpoint(0, false);
    debugger.watches.push("kept".to_owned());
    debugger.jump(77);
    debugger.add_scene(usize::MAX, serde_json::Value::Null);
    debugger.scenes[0].caption = "look here".to_owned();
    debugger.jump(1234);
    let text = debugger.session().to_json().unwrap();
    let session = Session::from_json(&text).unwrap();
    let back = restored(&session).unwrap();
    assert_eq!(back.session(), session);
    assert_eq!(back.state(), debugger.state());
}

#[test]
fn a_session_that_cannot_be_restored_says_why() {
    let mut debugger = debugger(0);
    debugger.add_breakpoint(Listings::shipped().find("darts.5").unwrap(), "");
    let session = debugger.session();
    let text = session.to_json().unwrap();
    assert!(matches!(
        Session::from_json(&text[..40]),
        Err(SessionError::Corrupt(_))
    ));
    let newer = text.replace("\"version\": 2", "\"version\": 9");
    assert!(matches!(
        Session::from_json(&newer),
        Err(SessionError::Newer { found: 9 })
    ));
    // What is of another method must not pass for a run by that of the parameters; those with steps may be named.
    let named = |method: &str| {
        let head = format!("{{ \"method\": \"{method}\",");
        Session::from_json(&text.replacen('{', &head, 1))
    };
    assert!(named("kdrt").is_ok());
    let exact = named("exact").unwrap();
    assert_eq!(exact.parameters.method, TilingMethod::Exact);
    for (method, said) in [
        ("reference", "steps of the reference sampler"),
        ("best", "no such method"),
    ] {
        let error = named(method).unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
    }
    let unknown = text.replace("darts.5", "darts.55");
    let error = Session::from_json(&unknown).unwrap_err();
    assert!(matches!(error, SessionError::UnknownLine { line } if line == "darts.55"));
    let restore = |session: &Session| restored(session).map(|_| ());
    let mut other = session.clone();
    other.parameters.seed += 1;
    assert!(matches!(
        restore(&other),
        Err(SessionError::Different { .. })
    ));
    let mut beyond = session.clone();
    beyond.cursor = usize::MAX;
    assert!(matches!(
        restore(&beyond),
        Err(SessionError::NoSuchEvent { .. })
    ));
    let mut broken = session;
    broken.parameters.radius = 0.0;
    assert!(matches!(restore(&broken), Err(SessionError::Run(_))));
}
