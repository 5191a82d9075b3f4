//! Files that are broken, too large or malicious: each is refused with a reason, and the current session stays.

use tilescope_session::incoming::{Incoming, NamedBytes};
use tilescope_workbench::files::{
    FileCommand, MAX_FILES, SaveTask, gather, packed, refusals, unpacked,
};
use tilescope_workbench::{Command, State};

use crate::exporting::{notice_text, opened};

fn drop_files(state: &mut State, files: &[(&str, &[u8])]) -> (String, bool) {
    state.apply(Command::DismissNotice);
    let files = files
        .iter()
        .map(|&(name, bytes)| NamedBytes::new(name, bytes));
    let command = FileCommand::DroppedBytes(files.collect(), Vec::new());
    state.apply(Command::File(command));
    state.settle();
    let notice = state.messages().notice.clone().expect("a sentence");
    (notice.text, notice.is_error)
}

/// Files, and a part of the message about each.
const BROKEN: [(&str, &[u8], &str); 12] = [
    ("empty.json", b"", "not a saved session"),
    ("empty.csv", b"", "empty.csv"),
    (
        "cut.json",
        b"{\"version\": 1, \"parameters\": {",
        "not a saved session",
    ),
    (
        "newer.json",
        b"{\"version\": 99, \"cursor\": 3}",
        "version 99",
    ),
    ("binary.json", b"\xff\xfe\x00\x01", "not text"),
    ("binary.csv", b"\xff\xfe\x00\x01\x80", "binary.csv"),
    ("nan.csv", b"x,y\n0.1,NaN\n0.2,0.3\n0.5,0.5\n", "nan.csv"),
    (
        "two.csv",
        b"x,y\n0.1,0.2\n0.2,0.3\n",
        "fewer than 3 samples",
    ),
    (
        "outside.csv",
        b"x,y\n0.1,7.5\n0.2,0.3\n0.5,0.5\n",
        "outside.csv",
    ),
    (
        "lone.csv.certificate.json",
        b"{}",
        "drop it together with its point set",
    ),
    ("", b"", "known neither"),
    ("../../etc/passwd", b"root:x:0:0", "passwd"),
];

#[test]
fn broken_files_are_refused_by_name() {
    let mut state = opened();
    let before = SaveTask::of(&state).run;
    for (name, bytes, expected) in BROKEN {
        let (text, is_error) = drop_files(&mut state, &[(name, bytes)]);
        assert!(is_error, "{name}: {text}");
        let lowered = text.to_lowercase();
        assert!(lowered.contains(expected), "{name}: {text}");
        // Names keep their case.
        assert!(
            !lowered.starts_with(name) || text.starts_with(name),
            "{text}"
        );
        assert_eq!(SaveTask::of(&state).run, before, "{name}");
        assert!(
            state.analysis().file_for(&state.runs().first).is_none()
                && state.form().own_pattern.is_none()
        );
    }
    // A certificate that cannot be read is left out, and the notice says why.
    let set = b"x,y\n0.1,0.2\n0.6,0.3\n0.5,0.8\n";
    let files = [
        ("a.csv", &set[..]),
        ("a.csv.certificate.json", b"{\"format_version\": 7}"),
    ];
    let (text, is_error) = drop_files(&mut state, &files);
    assert!(!is_error && text.contains("format_version is 7"), "{text}");
    assert!(
        state.analysis().file_for(&state.runs().first).is_some()
            && state.form().own_pattern.is_none()
    );
}

#[test]
fn one_of_several_files_is_opened_and_the_others_are_named() {
    let mut state = opened();
    let set = b"x,y\n0.1,0.2\n0.6,0.3\n0.5,0.8\n";
    let files = [("a.csv", &set[..]), ("b.csv", set), ("c.csv", set)];
    let (text, is_error) = drop_files(&mut state, &files);
    assert!(
        !is_error
            && state
                .analysis()
                .file_for(&state.runs().first)
                .unwrap()
                .unwrap()
                .path
                == "a.csv"
    );
    assert!(
        text.starts_with("a.csv is compared with this run"),
        "{text}"
    );
    assert!(
        text.contains("2 other files were not opened: b.csv, c.csv."),
        "{text}"
    );
    // Files that were not read are named, too.
    let refused = vec!["huge.csv has 2,000,000,000 bytes; at most 100,000,000 are read".to_owned()];
    let only = FileCommand::DroppedBytes(Vec::new(), refused.clone());
    state.apply(Command::File(only));
    assert!(notice_text(&state).starts_with("huge.csv has 2,000,000,000 bytes"));
    let both = FileCommand::DroppedBytes(vec![NamedBytes::new("a.csv", set)], refused);
    state.apply(Command::File(both));
    state.settle();
    assert!(
        notice_text(&state).contains("compared with")
            && notice_text(&state).contains("2,000,000,000")
    );
    state.apply(Command::DismissNotice);
    state.apply(Command::File(FileCommand::DroppedBytes(
        Vec::new(),
        Vec::new(),
    )));
    assert_eq!(state.messages().notice, None);
}

#[test]
fn lengths_are_checked_before_reading() {
    let message = refusals(&[
        ("fits.csv", 100_000_000),
        ("long.csv", 100_000_001),
        ("two.csv", 2_147_483_648),
        ("fits-too.csv", 100_000_000),
        ("one-more.csv", 1),
        ("empty.csv", 0),
    ]);
    let is_read: Vec<bool> = message.iter().map(Option::is_none).collect();
    assert_eq!(is_read, [true, false, false, true, false, true]);
    let long = message[1].as_ref().unwrap();
    assert_eq!(
        long,
        "long.csv has 100,000,001 bytes; at most 100,000,000 are read"
    );
    assert!(message[2].as_ref().unwrap().contains("2,147,483,648"));
    assert!(message[4].as_ref().unwrap().contains("200,000,000"));
    let many = vec![("a.csv", 1); MAX_FILES + 1];
    let message = refusals(&many);
    assert!(message[..MAX_FILES].iter().all(Option::is_none));
    assert!(
        message[MAX_FILES]
            .as_ref()
            .unwrap()
            .contains("more than 64 files")
    );
    // The same limit in memory.
    let file = Incoming::new(NamedBytes::new("long.csv", vec![b'1'; 101]));
    assert!(file.within(101).is_ok());
    let why = file.within(100).unwrap_err();
    assert_eq!(why, "long.csv has 101 bytes; at most 100 are read");
    assert!(
        Incoming::new(NamedBytes::new("s.json", vec![b' '; 16_000_001]))
            .text()
            .is_err()
    );
}

#[test]
fn sets_are_matched_with_certificates_and_documents_are_opened_first() {
    let file = |name: &str, text: &str| NamedBytes::new(name, text);
    let opened = |files: Vec<NamedBytes>| {
        let (incoming, left) = gather(files).expect("a file");
        (
            incoming.name.clone(),
            incoming.certificate().is_some(),
            left,
        )
    };
    assert!(gather(Vec::new()).is_none());
    let set = || file("a.csv", "0.1,0.2");
    let certificate = || file("a.csv.certificate.json", "{}");
    assert_eq!(
        opened(vec![certificate(), set()]),
        ("a.csv".into(), true, vec![])
    );
    assert_eq!(opened(vec![set()]), ("a.csv".into(), false, vec![]));
    // A certificate of another set does not belong to this one.
    let other = file("b.csv.certificate.json", "{}");
    let (name, has, left) = opened(vec![set(), other]);
    assert_eq!((name.as_str(), has), ("a.csv", false));
    assert_eq!(left, ["b.csv.certificate.json"]);
    // A layout is opened before its sets, and refers to them.
    let layout = file("l.json", r#"{"pieces": [{"file": "sets/a.csv"}]}"#);
    let others = vec![set(), certificate(), file("z.csv", ""), layout];
    let (incoming, left) = gather(others).unwrap();
    assert_eq!(incoming.name, "l.json");
    assert_eq!(left, ["z.csv"]);
    let companion = incoming.companion("sets/a.csv").expect("the set");
    assert!(companion.certificate().is_some() && companion.bytes == b"0.1,0.2");
    assert!(incoming.companion("sets/b.csv").is_none());
    // A point set in JSON is not a document.
    let json = file("p.json", "[[0.1, 0.2]]");
    assert_eq!(opened(vec![set(), json]).0, "a.csv");
    let many: Vec<NamedBytes> = (0..200).map(|k| file(&format!("{k}.csv"), "")).collect();
    let (incoming, left) = gather(many).unwrap();
    assert_eq!((incoming.name.as_str(), left.len()), ("0.csv", 199));
    assert!(incoming.beside.len() <= MAX_FILES);
    // Certificates of sets that are beyond the limit are files like others.
    let certificates = (0..MAX_FILES).map(|k| file(&format!("{k}.csv.certificate.json"), "{}"));
    let sets = (0..MAX_FILES).map(|k| file(&format!("{k}.csv"), ""));
    let (incoming, _) = gather(certificates.chain(sets).collect()).unwrap();
    assert_eq!(incoming.name, "0.csv.certificate.json");
}

#[test]
fn invalid_and_oversized_archives_are_refused() {
    let mut state = opened();
    let files = |count: usize| (0..count).map(|k| NamedBytes::new(format!("{k}.csv"), "1,2"));
    let whole = packed(files(2).collect()).unwrap();
    assert_eq!(unpacked(&whole).unwrap(), files(2).collect::<Vec<_>>());
    let mut altered = whole.bytes.clone();
    let at = altered
        .windows(3)
        .position(|bytes| bytes == b"1,2")
        .unwrap();
    altered[at] = b'7';
    let many = packed(files(MAX_FILES + 1).collect()).unwrap();
    for (bytes, expected) in [
        (b"".to_vec(), "cannot be unpacked"),
        (b"PK\x03\x04 nothing else".to_vec(), "cannot be unpacked"),
        (
            whole.bytes[..whole.bytes.len() / 2].to_vec(),
            "cannot be unpacked",
        ),
        (altered, "hecksum"),
        (many.bytes, "65 files; at most 64 are read"),
    ] {
        let (text, is_error) = drop_files(&mut state, &[("a.zip", &bytes)]);
        assert!(is_error && text.contains(expected), "{text}");
        assert!(text.starts_with("a.zip"), "{text}");
    }
}
