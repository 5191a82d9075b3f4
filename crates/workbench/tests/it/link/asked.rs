//! Requests of a page that embeds the window, and the answers.

use serde_json::{Value, json};
use tilescope_workbench::clock::Clock;
use tilescope_workbench::remote::{self, to_json};
use tilescope_workbench::{Command, State};

use super::support::{settle, state};

fn ask(state: &mut State, request: &Value) -> Value {
    answer(state, &request.to_string())
}

fn answer(state: &mut State, request: &str) -> Value {
    serde_json::from_str(&remote::ask(state, request)).expect("an answer in JSON")
}

fn small() -> State {
    let mut state = state();
    let load = json!({"do": "load", "parameters": {"radius": 0.03, "leaf": 12, "seed": 7}});
    assert_eq!(ask(&mut state, &load), json!({"ok": true, "dropped": []}));
    let answer = ask(&mut state, &json!({"do": "state"}));
    assert_eq!(answer["state"]["ready"], json!(false));
    settle(&mut state);
    state
}

#[test]
fn the_state_is_described() {
    let mut state = small();
    let answer = &ask(&mut state, &json!({"do": "state"}))["state"];
    let session = state.runs().first.session.as_ref().unwrap();
    assert_eq!(answer["seed"], json!(7));
    assert_eq!(answer["parameters"]["radius"], json!(0.03));
    assert_eq!(answer["samples"], json!(session.summary.count));
    assert_eq!(
        answer["digest"],
        json!(tilescope_debugger::digest(session.run()))
    );
    assert_eq!(
        answer["events"],
        json!(state.runs().first.cursor().unwrap().1)
    );
    assert_eq!(answer["cursor"], answer["events"]);
    assert_eq!(
        (&answer["stage"], &answer["verified"]),
        (&json!("finish"), &json!(true))
    );
    assert_eq!(
        (&answer["ready"], &answer["playing"]),
        (&json!(true), &json!(false))
    );
    assert_eq!(answer["engine"], json!("CPU"));
    assert_eq!(answer["link"], json!("v=1&seed=7&radius=0.03&leaf=12"));
    assert!(answer["sentence"].as_str().unwrap().starts_with("Finish: "));
    let keys: Vec<&String> = answer.as_object().unwrap().keys().collect();
    assert_eq!(keys.len(), 21, "{keys:?}");
    let positions = tilescope_formats::positions_digest(&session.run().positions());
    assert_eq!(answer["positions_digest"], json!(positions));
    // These fields are set on a page only.
    assert_eq!(
        (&answer["gpu"], &answer["chosen"]),
        (&json!("unknown"), &json!(null))
    );
    assert_eq!(answer["notice"], json!(null));
    // Before there is a session there is an answer, too.
    let early = to_json(&State::new(std::sync::Arc::new(|| {})));
    assert_eq!(
        (&early["ready"], &early["digest"]),
        (&json!(false), &json!(null))
    );
}

#[test]
fn a_page_moves_through_time() {
    let mut state = small();
    let done = json!({"ok": true});
    let cursor = |state: &State| state.runs().first.cursor().unwrap().0;
    assert_eq!(ask(&mut state, &json!({"do": "seek", "event": 100})), done);
    assert_eq!(cursor(&state), 100);
    assert_eq!(
        ask(&mut state, &json!({"do": "step", "by": 1, "unit": "event"})),
        done
    );
    assert_eq!(cursor(&state), 101);
    assert_eq!(ask(&mut state, &json!({"do": "step", "by": -1})), done);
    assert_eq!(cursor(&state), 100);
    assert_eq!(
        ask(&mut state, &json!({"do": "step", "unit": "line"})),
        done
    );
    assert!(cursor(&state) > 100);
    assert_eq!(
        state.time().playback.clock,
        Clock::Stage,
        "the clock is the user's"
    );
    assert_eq!(
        ask(&mut state, &json!({"do": "seek", "stage": "eliminate"})),
        done
    );
    assert_eq!(to_json(&state)["stage"], json!("eliminate"));
    assert_eq!(
        ask(&mut state, &json!({"do": "step", "by": 1, "unit": "stage"})),
        done
    );
    assert_eq!(to_json(&state)["stage"], json!("iterate-1"));
    assert_eq!(ask(&mut state, &json!({"do": "seek", "part": 0.5})), done);
    let (at, len) = state.runs().first.cursor().unwrap();
    assert!(at.abs_diff(len / 2) <= 1);
    assert_eq!(ask(&mut state, &json!({"do": "play", "speed": 2})), done);
    assert!(state.time().playback.is_playing() && to_json(&state)["playing"] == json!(true));
    assert_eq!(ask(&mut state, &json!({"do": "play"})), done);
    assert!(state.time().playback.is_playing(), "it goes on");
    assert_eq!(ask(&mut state, &json!({"do": "pause"})), done);
    assert!(!state.time().playback.is_playing());
}

#[test]
fn a_page_seeks_events() {
    let mut state = small();
    let cursor = |state: &State| state.runs().first.cursor().unwrap().0;
    assert_eq!(
        ask(&mut state, &json!({"do": "seek", "event": 0}))["ok"],
        json!(true)
    );
    let mut found = Vec::new();
    for name in ["conflict", "elimination", "gap", "insertion"] {
        let answer = ask(&mut state, &json!({"do": "seek", "next": name}));
        assert_eq!(answer, json!({"ok": true}), "{name}");
        found.push(cursor(&state));
    }
    assert!(
        found.is_sorted_by(|a, b| a < b),
        "in this sequence: {found:?}"
    );
    let recording = state.runs().first.debugger.as_ref().unwrap().recording();
    let eliminates = recording.event(found[1] - 1).unwrap().kind();
    assert_eq!(eliminates, tilescope_debugger::EventKind::Eliminate);
    assert_eq!(
        ask(&mut state, &json!({"do": "seek", "previous": "conflict"}))["ok"],
        json!(true)
    );
    assert!(cursor(&state) < found[3]);
    // If there is no such event, nothing moves.
    assert_eq!(
        ask(&mut state, &json!({"do": "seek", "event": 5}))["ok"],
        json!(true)
    );
    let answer = ask(&mut state, &json!({"do": "seek", "previous": "insertion"}));
    assert_eq!(
        answer["error"],
        json!("There is no insertion before this moment.")
    );
    assert_eq!((cursor(&state), &state.messages().notice), (5, &None));
}

#[test]
fn a_page_sets_the_view() {
    let mut state = small();
    let before = to_json(&state)["view"].clone();
    assert_eq!(
        (&before["camera"], &before["look"]),
        (&json!("whole"), &json!("dark"))
    );
    let wanted = json!({
        "camera": [12.5, 3.0, 40.0], "layers": ["disks", "kd-tree"], "colouring": "age", "look": "light"
    });
    let mut request = wanted.clone();
    request["do"] = json!("view");
    assert_eq!(ask(&mut state, &request), json!({"ok": true}));
    let answer = to_json(&state)["view"].clone();
    assert_eq!(answer["layers"], json!(["kd-tree", "disks"]));
    for field in ["camera", "colouring", "look"] {
        assert_eq!(answer[field], wanted[field], "{field}");
    }
    // Parts that are not given stay.
    assert_eq!(
        ask(&mut state, &json!({"do": "view", "camera": "whole"}))["ok"],
        json!(true)
    );
    let whole = to_json(&state)["view"].clone();
    assert_eq!(
        (&whole["camera"], &whole["look"]),
        (&json!("whole"), &json!("light"))
    );
    assert_eq!(whole["layers"], answer["layers"]);
}

#[test]
fn links_are_loaded_and_dropped_parts_are_named() {
    let mut state = state();
    let load = json!({"do": "load", "link": "v=1&radius=0.03&at=50&look=plaid&x=1"});
    let answer = ask(&mut state, &load);
    assert_eq!(answer["ok"], json!(true));
    let dropped = answer["dropped"].as_array().unwrap();
    assert_eq!(dropped.len(), 2, "{answer}");
    settle(&mut state);
    assert_eq!(to_json(&state)["cursor"], json!(50));
}

#[test]
fn seeds_that_numbers_would_round_are_text() {
    let mut state = state();
    let seeds = json!({"radius": 0.03, "seed": u64::MAX.to_string(), "pattern": {"seed": "9007199254740993"}});
    let answer = ask(&mut state, &json!({"do": "load", "parameters": seeds}));
    assert_eq!(answer, json!({"ok": true, "dropped": []}));
    settle(&mut state);
    let answer = to_json(&state);
    assert_eq!(answer["seed"], json!(u64::MAX.to_string()));
    assert_eq!(answer["parameters"]["seed"], answer["seed"]);
    assert_eq!(
        answer["parameters"]["pattern"]["seed"],
        json!("9007199254740993")
    );
    let run = state.runs().first.session.as_ref().unwrap().run();
    assert_eq!(run.parameters.seed, u64::MAX);
    assert_eq!(run.parameters.pattern.seed, (1 << 53) + 1);
    let wrong = json!({"do": "load", "parameters": {"radius": "0.03"}});
    assert_eq!(
        ask(&mut state, &wrong)["ok"],
        json!(false),
        "other fields are numbers"
    );
}

#[test]
fn seeking_is_refused_while_a_run_is_made() {
    let mut state = small();
    let load = json!({"do": "load", "parameters": {"radius": 0.03, "leaf": 12, "seed": 8}});
    assert_eq!(ask(&mut state, &load)["ok"], json!(true));
    for request in [
        json!({"do": "step", "by": -1}),
        json!({"do": "play"}),
        json!({"do": "seek", "part": 0}),
    ] {
        let error = ask(&mut state, &request)["error"].to_string();
        assert!(error.contains("A run is being made"), "{error}");
    }
    settle(&mut state);
    assert_eq!(
        ask(&mut state, &json!({"do": "seek", "part": 0}))["ok"],
        json!(true)
    );
    assert_eq!(to_json(&state)["cursor"], json!(0));
}

const REFUSED: &[(&str, &str)] = &[
    ("", "not a JSON object"),
    ("[]", "not a JSON object"),
    ("null", "not a JSON object"),
    ("{\"do\":", "not a JSON object"),
    ("{}", "\"do\" is null"),
    (
        r#"{"do":"destroy"}"#,
        "\"do\" is \"destroy\"; it must be one of",
    ),
    (r#"{"do":["state"]}"#, "\"do\" is [\"state\"]"),
    (
        r#"{"do":"state","now":1}"#,
        "\"state\" has no field \"now\"",
    ),
    (r#"{"do":"pause","by":1}"#, "no field \"by\""),
    (
        r#"{"do":"load"}"#,
        "exactly one of \"link\" and \"parameters\"",
    ),
    (
        r#"{"do":"load","link":"v=1","parameters":{}}"#,
        "exactly one of",
    ),
    (
        r#"{"do":"load","link":7}"#,
        "\"link\" is 7; it must be a text",
    ),
    (r#"{"do":"load","parameters":[]}"#, "must be an object"),
    (
        r#"{"do":"load","parameters":{"radius":1e-9}}"#,
        "The width is",
    ),
    (
        r#"{"do":"load","parameters":{"radius":1e-4}}"#,
        "a page may ask for 2,000,000",
    ),
    (
        r#"{"do":"load","parameters":{"radius":-1}}"#,
        "radius is -1",
    ),
    (
        r#"{"do":"load","parameters":{"radius":"x"}}"#,
        "\"radius\" is \"x\"",
    ),
    (r#"{"do":"load","parameters":{"seed":-1}}"#, "-1"),
    (r#"{"do":"load","parameters":{"order":"none"}}"#, "none"),
    (
        r#"{"do":"load","parameters":{"colour":1}}"#,
        "no field \"colour\"",
    ),
    (
        r#"{"do":"load","parameters":{"method":"exact","order":"index"}}"#,
        "The order has no meaning in exact tiling",
    ),
    (
        r#"{"do":"load","parameters":{"method":"reference"}}"#,
        "Method reference: the steps of the reference sampler",
    ),
    (
        r#"{"do":"load","parameters":{"pattern":7}}"#,
        "\"pattern\" is 7; it must be an object",
    ),
    (
        r#"{"do":"load","parameters":{"pattern":{"side":1900}}}"#,
        "1900 r; a page may ask for 1500 r",
    ),
    (
        r#"{"do":"load","parameters":{"pattern":{"size":9}}}"#,
        "\"pattern\" has no field \"size\"",
    ),
    (r#"{"do":"step","by":2}"#, "\"by\" is 2; it must be 1 or -1"),
    (r#"{"do":"step","unit":"pass"}"#, "\"unit\" is \"pass\""),
    (r#"{"do":"seek"}"#, "exactly one of"),
    (r#"{"do":"seek","event":1,"part":0}"#, "exactly one of"),
    (r#"{"do":"seek","event":-1}"#, "\"event\" is -1"),
    (r#"{"do":"seek","event":1.5}"#, "\"event\" is 1.5"),
    (
        r#"{"do":"seek","event":99999999}"#,
        "Event 99999999 is beyond the last one",
    ),
    (
        r#"{"do":"seek","stage":"lunch"}"#,
        "no stage \"lunch\"; there are pattern, blocks",
    ),
    (r#"{"do":"seek","stage":3}"#, "the name of a stage"),
    (
        r#"{"do":"seek","part":1.5}"#,
        "\"part\" is 1.5; it must be from 0 to 1",
    ),
    (
        r#"{"do":"seek","next":"event"}"#,
        "must be one of \"conflict\", \"elimination\", \"gap\"",
    ),
    (r#"{"do":"seek","next":"gap","event":1}"#, "exactly one of"),
    (r#"{"do":"view"}"#, "\"view\" is empty"),
    (r#"{"do":"view","zoom":2}"#, "no field \"zoom\""),
    (r#"{"do":"view","camera":[0,0]}"#, "\"camera\" is [0,0]"),
    (
        r#"{"do":"view","camera":[0,0,1e9]}"#,
        "a scale from 0.005 to 4000",
    ),
    (
        r#"{"do":"view","layers":["disks","tinsel"]}"#,
        "\"layers\" is \"tinsel\"; it must be \"automatic\", or a list of some of",
    ),
    (
        r#"{"do":"view","layers":"disks"}"#,
        "\"layers\" is \"disks\"",
    ),
    (
        r#"{"do":"view","look":"plaid"}"#,
        "must be one of \"dark\", \"light\", \"projector\"",
    ),
    (r#"{"do":"play","speed":1e9}"#, "from 0.25 to 512"),
    (r#"{"do":"play","speed":"fast"}"#, "\"speed\" is \"fast\""),
];

#[test]
fn invalid_requests_are_refused_by_name() {
    let mut state = small();
    let before = to_json(&state);
    let long = format!("{{\"do\":\"state\",\"x\":\"{}\"}}", "x".repeat(70_000));
    let deep = "[".repeat(60_000);
    let made = [(&*deep, "not a JSON object"), (&*long, "at most 65536")];
    for (request, part) in REFUSED.iter().copied().chain(made) {
        let answer = answer(&mut state, request);
        assert_eq!(answer["ok"], json!(false), "{request:.60}");
        let error = answer["error"].as_str().unwrap();
        assert!(error.contains(part), "{request:.60}: {error}");
        assert!(error.len() < 400, "{error}");
    }
    assert_eq!(to_json(&state), before, "the state is unchanged");
    let mut early = State::new(std::sync::Arc::new(|| {}));
    for request in [
        json!({"do": "step"}),
        json!({"do": "play"}),
        json!({"do": "seek", "part": 0}),
    ] {
        let error = ask(&mut early, &request)["error"].to_string();
        assert!(error.contains("There is no session yet"), "{error}");
    }
}

#[test]
fn stages_are_sought_in_a_run_without_events() {
    let mut state = state();
    state.apply(Command::Combine(
        tilescope_session::combination::CombineCommand::Nine,
    ));
    settle(&mut state);
    let refused = ask(&mut state, &json!({"do": "seek", "event": 3}));
    assert!(refused["error"].to_string().contains("no events"));
    let refused = ask(&mut state, &json!({"do": "step", "unit": "event"}));
    assert!(refused["error"].to_string().contains("no events"));
    assert_eq!(
        ask(&mut state, &json!({"do": "seek", "part": 0}))["ok"],
        json!(true)
    );
    assert_eq!(to_json(&state)["stage"], json!("blocks"));
    assert_eq!(
        ask(&mut state, &json!({"do": "step", "unit": "stage"}))["ok"],
        json!(true)
    );
    assert_eq!(to_json(&state)["stage"], json!("tile"));
}

#[test]
fn a_long_run_to_a_breakpoint_takes_several_frames() {
    use tilescope_debugger::{Direction, Event};
    use tilescope_workbench::command::{DebugCommand, TimeCommand};
    let mut state = state();
    let debugger = state.runs().first.debugger.as_ref().expect("events");
    let len = debugger.recording().len();
    // The line that is executed most often.
    let mut counts = std::collections::HashMap::new();
    for at in 0..len {
        let event: &Event = debugger.recording().event(at).expect("an event");
        *counts.entry(event.line()).or_insert(0_usize) += 1;
    }
    let (&line, &hits) = counts.iter().max_by_key(|(_, hits)| **hits).unwrap();
    assert!(hits > 10_000, "{hits}");
    state.apply(Command::Debug(DebugCommand::ToggleBreakpoint(line)));
    state.apply(Command::Debug(DebugCommand::Condition(
        0,
        "false".to_owned(),
    )));
    state.apply(Command::Time(TimeCommand::FirstStage));
    let on = Command::Time(TimeCommand::Continue(Direction::Forwards));
    state.apply(on.clone());
    let (first, _) = state.runs().first.cursor().unwrap();
    assert!(first < len, "it stopped to let a frame be drawn");
    state.advance(0.0);
    let (second, _) = state.runs().first.cursor().unwrap();
    assert!(second > first, "and goes on with the next");
    settle(&mut state);
    assert_eq!(state.runs().first.cursor(), Some((len, len)));
    // Any other move in time ends it.
    state.apply(Command::Time(TimeCommand::FirstStage));
    state.apply(on);
    state.apply(Command::Time(TimeCommand::Jump(7)));
    settle(&mut state);
    assert_eq!(state.runs().first.cursor(), Some((7, len)));
}
