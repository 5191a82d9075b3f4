//! Numbers by which commands name things: those that nothing has are refused by a sentence, and none ends the program.

use std::convert::Infallible;

use serde_json::{Value, json};
use tilescope_debugger::SavedBreakpoint;
use tilescope_workbench::remote::to_json;
use tilescope_workbench::script::{apply_all, read};
use tilescope_workbench::{Command, State};

/// Numbers that nothing has, of every size that a script can hold.
const BEYOND: [u64; 4] = [100_000, 4_294_967_295, 9_007_199_254_740_993, u64::MAX];

/// Applies commands; returns the state after them and the notice after each.
fn after(commands: &[Value]) -> (State, Vec<Option<String>>) {
    let script = read(&json!(commands).to_string()).unwrap();
    let mut notices = Vec::new();
    let Ok(state) = apply_all(script, |state| {
        let notice = state.messages().notice.as_ref();
        notices.push(notice.map(|notice| notice.text.clone()));
        Ok::<_, Infallible>(())
    });
    (state, notices)
}

/// The commands that make a small run with a breakpoint, a watch and a scene.
fn small_run() -> Vec<Value> {
    let script = json!([
        {"form": {"type": ["radius", "0.1"]}}, {"form": {"type": ["pattern-side", "20"]}}, "run",
        {"debug": {"toggle-breakpoint": "eliminate.5"}}, {"debug": {"watch": "event"}}, {"scene": "add"},
    ]);
    script.as_array().unwrap().clone()
}

/// Returns the commands that name something by this number, and how their refusals begin.
fn commands(number: u64) -> Vec<(Value, String)> {
    let first = |command: Value| json!({"view": ["first", command]});
    let listed = [
        ("sample", first(json!({"go-to-sample": number}))),
        ("sample", first(json!({"pick": {"sample": number}}))),
        (
            "sample",
            json!({"time": {"run-to": [{"sample": number}, "forwards"]}}),
        ),
        ("event", json!({"time": {"jump": number}})),
        (
            "event",
            json!({"time": {"loop": {"start": 0, "end": number}}}),
        ),
        (
            "event",
            json!({"time": {"loop": {"start": number, "end": number}}}),
        ),
        ("stage", json!({"time": {"show-stage": number}})),
        ("event", json!({"debug": {"select-event": number}})),
        ("event", json!({"debug": {"toggle-event": number}})),
        (
            "breakpoint",
            json!({"debug": {"condition": [number, "a > b"]}}),
        ),
        ("breakpoint", json!({"debug": {"enable": [number, false]}})),
        (
            "breakpoint",
            json!({"debug": {"remove-breakpoint": number}}),
        ),
        ("watch", json!({"debug": {"edit-watch": [number, "event"]}})),
        ("watch", json!({"debug": {"remove-watch": number}})),
        ("scene", json!({"scene": {"replace": number}})),
        ("scene", json!({"scene": {"caption": [number, "here"]}})),
        ("scene", json!({"scene": {"remove": number}})),
        ("scene", json!({"scene": {"move": [0, number]}})),
        ("scene", json!({"scene": {"move": [number, 0]}})),
        ("scene", json!({"scene": {"show": number}})),
    ];
    let refusal = |what: &str| format!("{what} {number}: the ");
    listed
        .into_iter()
        .map(|(what, command)| (command, refusal(what)))
        .collect()
}

fn breakpoints(state: &State) -> Vec<SavedBreakpoint> {
    state
        .runs()
        .first
        .debugger
        .as_ref()
        .unwrap()
        .saved_breakpoints()
}

fn can_be_read(command: &Value) -> bool {
    serde_json::from_value::<Command>(command.clone()).is_ok()
}

#[test]
fn numbers_that_nothing_has_are_refused_with_what_there_is() {
    let (before, _) = after(&small_run());
    let run = before.runs().first.session.as_ref().unwrap().run();
    for number in BEYOND {
        // Samples have 32 bits: a larger number is no command at all.
        let mut listed = commands(number);
        listed.retain(|(command, _)| can_be_read(command));
        assert!(listed.len() >= 17, "{number}");
        let tried = listed.iter().map(|(command, _)| command.clone());

        let (state, notices) = after(&small_run().into_iter().chain(tried).collect::<Vec<_>>());
        let said = &notices[small_run().len()..];
        for ((command, refusal), notice) in listed.iter().zip(said) {
            let notice = notice.as_deref().unwrap_or_default();
            assert!(notice.starts_with(refusal), "{command}: {notice:?}");
            assert!(notice.contains(" has "), "{command}: {notice:?}");
        }
        assert_eq!(
            state.runs().first.cursor(),
            before.runs().first.cursor(),
            "{number}"
        );
        assert_eq!(breakpoints(&state), breakpoints(&before));
        if number == BEYOND[0] {
            let samples = run.samples.len();
            let expected =
                format!("sample 100000: the run has {samples} samples, numbered from 0.");
            assert_eq!(said[0].as_deref(), Some(expected.as_str()));
        }
    }
}

#[test]
fn numbers_that_are_there_are_not_refused() {
    let (before, _) = after(&small_run());
    let events = before.runs().first.cursor().unwrap().1;
    let run = before.runs().first.session.as_ref().unwrap().run();
    let tried = [
        // The word about the scene that was made.
        json!("dismiss-notice"),
        json!({"view": ["first", {"go-to-sample": run.samples.len() - 1}]}),
        json!({"time": {"jump": events}}),
        json!({"time": {"loop": {"start": 0, "end": events}}}),
        json!({"time": {"show-stage": 0}}),
        json!({"debug": {"select-event": events - 1}}),
        json!({"debug": {"enable": [0, false]}}),
        json!({"scene": {"show": 0}}),
    ];
    let (_, notices) = after(&[small_run(), tried.to_vec()].concat());
    for (command, notice) in tried.iter().zip(&notices[small_run().len()..]) {
        assert_eq!(*notice, None, "{command}");
    }
}

/// Numbers in commands that name things of a list that is shown: they change nothing if they are too large.
#[test]
fn no_number_ends_the_program() {
    let sessions = [
        small_run(),
        vec![json!({"form": {"preset": "nested"}}), json!("run")],
        vec![json!({"combine": "nine"})],
        vec![json!({"lesson": {"open": "survivors"}})],
        vec![json!({"compare": {"start": "next-seed"}})],
    ];
    for mut script in sessions {
        for number in BEYOND {
            let small = number.min(u64::from(u32::MAX));
            script.extend(commands(small).into_iter().map(|(command, _)| command));
            script.extend([
                json!({"view": ["second", {"go-to-sample": small}]}),
                json!({"view": ["first", {"hover": small}]}),
                json!({"view": ["second", {"hover": small}]}),
                json!({"window": {"finder-choice": number}}),
                json!({"lesson": {"draft": {"choose": number}}}),
                json!({"lesson": {"draft": {"pick": small}}}),
                json!({"lesson": {"draft": {"band": [number, "up"]}}}),
                json!({"lesson": "answer"}),
                json!({"passes": {"select": number}}),
                json!({"passes": {"buffer": number}}),
                json!({"passes": {"pick-row": small}}),
                json!({"passes": {"point-row": small}}),
                json!({"time": "step-forward"}),
            ]);
        }
        for command in &script {
            assert!(can_be_read(command), "{command}");
        }
        let (state, _) = after(&script);
        let _ = to_json(&state);
        assert_eq!(state.runs().first.hovered, None);
    }
}
