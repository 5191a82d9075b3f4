//! Saved sessions with a pattern from a file and a view, and files that ask for too much.

use std::sync::Arc;

use serde_json::json;
use tilescope_core::{Parameters, Pattern, PatternSpec, Unobserved};
use tilescope_debugger::{
    DEFAULT_BUDGET, Debugger, MAX_BUDGET, MAX_SAMPLES, MAX_SCENES, MAX_TEXT, PatternFile,
    Recording, SavedScene, Session, SessionError, pattern_digest,
};

use crate::support::{record, restored, restored_with, variants};

fn pattern(seed: u64) -> Pattern {
    let spec = PatternSpec {
        side: 22.0,
        seed,
        ..PatternSpec::default()
    };
    Pattern::generate(&spec, &mut Unobserved).unwrap()
}

/// A session whose pattern comes from a file.
fn with_pattern() -> Debugger {
    let (parameters, pattern) = (variants()[0], pattern(4));
    let digest = pattern_digest(&pattern);
    let pattern = Arc::new(pattern);
    let recording =
        Recording::with_pattern(&parameters, pattern, DEFAULT_BUDGET, &mut Unobserved).unwrap();
    let mut debugger = Debugger::new(Arc::new(recording), DEFAULT_BUDGET);
    let path = "sets/mine.ply".to_owned();
    debugger.pattern = Some(PatternFile { path, digest });
    debugger.view = json!({"zoom": 2.5, "panels": ["code", {"rows": 12}]});
    debugger.jump(500);
    debugger
}

fn plain() -> Session {
    let recording = Arc::new(record(&variants()[0], DEFAULT_BUDGET));
    Debugger::new(recording, DEFAULT_BUDGET).session()
}

#[test]
fn a_session_with_a_pattern_and_a_view_comes_back() {
    let debugger = with_pattern();
    let own = record(&variants()[0], DEFAULT_BUDGET);
    assert_ne!(debugger.recording().run().result, own.run().result);
    let text = debugger.session().to_json().unwrap();
    let session = Session::from_json(&text).unwrap();
    assert_eq!(session, debugger.session());
    let mut asked = Vec::new();
    let mut load = |file: &PatternFile| {
        asked.push(file.path.clone());
        Ok(pattern(4))
    };
    let back = restored_with(&session, &mut load).unwrap();
    assert_eq!(asked, ["sets/mine.ply"]);
    assert_eq!(back.session(), session);
    assert_eq!(back.view["panels"][1]["rows"], 12);
    assert_eq!(back.state(), debugger.state());
}

#[test]
fn a_pattern_that_is_gone_or_changed_is_an_error_that_names_the_file() {
    let session = with_pattern().session();
    let restore = |load: &mut dyn FnMut(&PatternFile) -> Result<Pattern, String>| {
        let back = restored_with(&session, load);
        back.map(|_| ()).unwrap_err()
    };
    let gone = restore(&mut |_| Err("there is no such file".to_owned()));
    assert_eq!(
        gone.to_string(),
        "the session's pattern sets/mine.ply cannot be loaded: there is no such file"
    );
    let changed = restore(&mut |_| Ok(pattern(5)));
    let SessionError::PatternChanged {
        path,
        expected,
        found,
    } = changed
    else {
        panic!("{changed}");
    };
    assert_eq!(path, "sets/mine.ply");
    assert_eq!(
        (expected, found),
        (pattern_digest(&pattern(4)), pattern_digest(&pattern(5)))
    );
    let refused = restored(&session).map(|_| ());
    assert!(matches!(refused, Err(SessionError::PatternGone { .. })));
}

#[test]
fn a_session_without_the_new_parts_is_written_and_read_as_before() {
    let session = plain();
    let text = session.to_json().unwrap();
    assert!(!text.contains("view") && !text.contains("\"pattern\": null"));
    let fields: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert!(fields.get("pattern").is_none() && fields.get("view").is_none());
    assert_eq!(Session::from_json(&text).unwrap(), session);
    let marked = format!("\u{FEFF}{text}");
    assert_eq!(Session::from_json(&marked).unwrap(), session);
    let mut never = |_: &PatternFile| -> Result<Pattern, String> { panic!("no file is named") };
    assert!(restored_with(&session, &mut never).is_ok());
}

/// The error of a session, from its text and when it is restored: they must agree.
fn refused(session: &Session) -> String {
    let text = serde_json::to_string(session).unwrap();
    let read = Session::from_json(&text).unwrap_err();
    let again = restored(session).map(|_| ()).unwrap_err();
    assert_eq!(read.to_string(), again.to_string());
    read.to_string()
}

#[test]
fn a_session_that_asks_for_too_much_is_refused_with_value_and_limit() {
    let good = plain();
    let budget = Session {
        budget: usize::MAX,
        ..good.clone()
    };
    let expected = format!("{} events of budget; at most {MAX_BUDGET}", usize::MAX);
    assert!(refused(&budget).contains(&expected));
    let first = SavedScene {
        event: 1,
        ..SavedScene::default()
    };
    let scenes = vec![first.clone(); MAX_SCENES + 1];
    let many = Session {
        scenes,
        ..good.clone()
    };
    assert!(refused(&many).contains("has 10001 scenes; at most 10000"));
    let watches = vec!["p".to_owned(); 1_001];
    let watched = Session {
        watches,
        ..good.clone()
    };
    assert!(refused(&watched).contains("has 1001 watches; at most 1000"));
    let watches = vec!["p".repeat(MAX_TEXT + 1)];
    let long = Session {
        watches,
        ..good.clone()
    };
    assert!(refused(&long).contains("has 10001 bytes in a watch; at most 10000"));
    let parameters = Parameters {
        radius: 1e-4,
        ..good.parameters
    };
    let large = Session {
        parameters,
        ..good.clone()
    };
    let error = refused(&large);
    assert!(
        error.contains("expected samples; at most") && error.contains(&MAX_SAMPLES.to_string())
    );
    // What is at the limit is taken.
    let scenes = vec![first; MAX_SCENES];
    let most = Session {
        scenes,
        budget: MAX_BUDGET,
        ..good
    };
    assert!(restored(&most).is_ok());
}

#[test]
fn a_million_scenes_and_deep_views_are_refused() {
    let text = plain().to_json().unwrap();
    let scene = r#"{"event":1,"caption":"n"}"#;
    let list = vec![scene; 1_000_000].join(",");
    let million = text.replace("\"scenes\": []", &format!("\"scenes\": [{list}]"));
    assert_ne!(million, text);
    let error = Session::from_json(&million).unwrap_err().to_string();
    assert!(error.contains("bytes; at most 16000000"), "{error}");
    let list = vec![scene; 400_000].join(",");
    let many = text.replace("\"scenes\": []", &format!("\"scenes\": [{list}]"));
    let error = Session::from_json(&many).unwrap_err().to_string();
    assert!(error.contains("400000 scenes; at most 10000"), "{error}");
    let deep = format!("{}{}", "[".repeat(100_000), "]".repeat(100_000));
    let deep = text.replace(
        "\"scenes\": []",
        &format!("\"scenes\": [], \"view\": {deep}"),
    );
    assert!(matches!(
        Session::from_json(&deep),
        Err(SessionError::Corrupt(_))
    ));
    let negative = text.replace("\"budget\": 5000000", "\"budget\": -1");
    let error = Session::from_json(&negative).unwrap_err().to_string();
    assert!(error.contains("-1"), "{error}");
}

#[test]
fn a_patterns_digest_tells_samples_and_boundaries_apart() {
    let periodic = pattern(4);
    let bounded = PatternSpec {
        side: 22.0,
        seed: 4,
        boundary: tilescope_core::Boundary::Bounded,
    };
    let bounded = Pattern::generate(&bounded, &mut Unobserved).unwrap();
    assert_eq!(pattern_digest(&periodic), pattern_digest(&pattern(4)));
    assert_ne!(pattern_digest(&periodic), pattern_digest(&bounded));
    assert_ne!(pattern_digest(&periodic), pattern_digest(&pattern(5)));
}
