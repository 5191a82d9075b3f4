//! Files as bytes: what a browser drops, chooses and downloads equals what the native window reads from paths
//! and writes to them.

use crate::exporting;
use std::fs;
use std::path::Path;
use tilescope_workbench::command::{FormCommand, TimeCommand};

use tilescope_formats::{Overrides, certificate_path, check_bytes};
use tilescope_session::incoming::NamedBytes;
use tilescope_workbench::export::{ExportCommand, ExportKind, NumberField, write};
use tilescope_workbench::files::{Delivery, FileCommand, Purpose, SaveTask, packed};
use tilescope_workbench::state::{ExportSource, Settings};
use tilescope_workbench::{Command, State};

use crate::exporting::{fill_in, notice_text, opened};

fn file(state: &mut State, command: FileCommand) {
    state.apply(Command::File(command));
    state.settle();
}

fn named(path: &Path) -> NamedBytes {
    let name = path.file_name().unwrap().to_string_lossy();
    NamedBytes::new(name, fs::read(path).unwrap())
}

fn drop_bytes(state: &mut State, files: Vec<NamedBytes>) {
    state.apply(Command::DismissNotice);
    file(state, FileCommand::DroppedBytes(files, Vec::new()));
}

fn choose(state: &mut State, purpose: Purpose, files: Vec<NamedBytes>) {
    state.apply(Command::DismissNotice);
    file(state, FileCommand::Sheet(purpose));
    file(state, FileCommand::Chosen(files));
    file(state, FileCommand::Go);
}

fn open_path(state: &mut State, purpose: Purpose, path: &Path) {
    state.apply(Command::DismissNotice);
    file(state, FileCommand::Sheet(purpose));
    let path = path.to_string_lossy().into_owned();
    file(state, FileCommand::Path(path));
    file(state, FileCommand::Go);
}

/// A folder with a set, its certificate, a session that clips from the set, and the state that saved it.
fn pattern_session() -> (tempfile::TempDir, State) {
    let folder = tempfile::tempdir().unwrap();
    let mut state = opened();
    let set = folder.path().join("own.csv");
    exporting::write(&mut state, ExportKind::Result, &set, &[]);
    open_path(&mut state, Purpose::Pattern, &set);
    state.apply(Command::Run);
    state.settle();
    assert!(
        state.runs().first.session.as_ref().unwrap().own.is_some(),
        "{}",
        notice_text(&state)
    );
    open_path(&mut state, Purpose::Save, &folder.path().join("one.json"));
    assert!(notice_text(&state).starts_with("Session saved to"));
    (folder, state)
}

fn is_error(state: &State) -> bool {
    state
        .messages()
        .notice
        .as_ref()
        .is_some_and(|notice| notice.is_error)
}

#[test]
fn a_session_and_its_pattern_are_opened_from_bytes_as_from_paths() {
    let (folder, state) = pattern_session();
    let [session, set] = ["one.json", "own.csv"].map(|name| folder.path().join(name));
    let saved = SaveTask::of(&state).run.unwrap();
    let mut by_path = opened();
    open_path(&mut by_path, Purpose::Open, &session);
    assert_eq!(SaveTask::of(&by_path).run.unwrap().digest, saved.digest);
    let all = || vec![named(&set), named(&certificate_path(&set)), named(&session)];
    // In either order, a session is opened before the files that it names.
    for dropped in [true, false] {
        let mut other = opened();
        assert_ne!(SaveTask::of(&other).run.unwrap().digest, saved.digest);
        if dropped {
            drop_bytes(&mut other, all());
        } else {
            choose(&mut other, Purpose::Open, all());
        }
        assert!(!is_error(&other), "{}", notice_text(&other));
        assert!(other.files().sheet.is_none(), "the sheet is closed");
        let opened = SaveTask::of(&other).run.unwrap();
        assert_eq!(opened.digest, saved.digest);
        let pattern = opened.pattern.unwrap();
        assert_eq!(pattern.digest, saved.pattern.as_ref().unwrap().digest);
        assert_eq!(pattern.path, "own.csv");
        assert!(
            !notice_text(&other).contains("not opened"),
            "{}",
            notice_text(&other)
        );
    }
    // Without its pattern it is refused: sessions given as bytes read nothing from the disk.
    let mut other = opened();
    let before = SaveTask::of(&other).run;
    drop_bytes(&mut other, vec![named(&session)]);
    assert!(is_error(&other) && notice_text(&other).contains("did not come with the session"));
    assert_eq!(SaveTask::of(&other).run, before);
}

#[test]
fn content_decides_and_not_the_name() {
    let (folder, state) = pattern_session();
    let set = folder.path().join("own.csv");
    let digest = SaveTask::of(&state).run.unwrap().digest;
    let session = fs::read(folder.path().join("one.json")).unwrap();
    // A session is recognised under any name, also after the set that it clips from.
    for name in ["lecture", "lecture.v2", "lecture.csv"] {
        let named_so = NamedBytes::new(name, session.clone());
        let mut other = opened();
        let all = vec![named(&set), named(&certificate_path(&set)), named_so];
        drop_bytes(&mut other, all);
        assert!(!is_error(&other), "{name}: {}", notice_text(&other));
        assert_eq!(SaveTask::of(&other).run.unwrap().digest, digest, "{name}");
        let path = folder.path().join(name);
        fs::write(&path, &session).unwrap();
        let mut other = opened();
        let paths = [&set, &path].map(|path| path.to_string_lossy().into_owned());
        file(&mut other, FileCommand::Dropped(paths.to_vec()));
        assert_eq!(
            SaveTask::of(&other).run.unwrap().digest,
            digest,
            "{name}: {}",
            notice_text(&other)
        );
    }
    // So are a layout, a point set and an archive.
    let layout = NamedBytes::new("sets", tilescope_session::combination::NINE.as_bytes());
    let mut other = opened();
    drop_bytes(&mut other, vec![layout]);
    assert!(
        other.runs().first.shows_combination(),
        "{}",
        notice_text(&other)
    );
    let points = NamedBytes::new("points", fs::read(&set).unwrap());
    let certificate = fs::read(certificate_path(&set)).unwrap();
    let certificate = NamedBytes::new("points.certificate.json", certificate);
    let both = vec![points, certificate];
    let archive = NamedBytes::new("archive", packed(both.clone()).unwrap().bytes);
    for files in [both, vec![archive]] {
        let mut other = opened();
        drop_bytes(&mut other, files);
        assert!(
            other.form().own_pattern.is_some(),
            "{}",
            notice_text(&other)
        );
    }
}

#[test]
fn a_byte_order_mark_hides_no_session_and_no_layout() {
    let (folder, state) = pattern_session();
    let set = folder.path().join("own.csv");
    let marked =
        |name: &str, bytes: &[u8]| NamedBytes::new(name, [b"\xEF\xBB\xBF", bytes].concat());
    let session = marked(
        "one.json",
        &fs::read(folder.path().join("one.json")).unwrap(),
    );
    for dropped in [true, false] {
        let mut other = opened();
        let all = vec![named(&set), named(&certificate_path(&set)), session.clone()];
        if dropped {
            drop_bytes(&mut other, all);
        } else {
            choose(&mut other, Purpose::Open, all);
        }
        assert!(!is_error(&other), "{}", notice_text(&other));
        assert_eq!(
            SaveTask::of(&other).run.unwrap().digest,
            SaveTask::of(&state).run.unwrap().digest
        );
    }

    let layout = marked("nine.json", tilescope_session::combination::NINE.as_bytes());
    let mut other = opened();
    drop_bytes(&mut other, vec![layout]);
    assert!(
        other.runs().first.shows_combination(),
        "{}",
        notice_text(&other)
    );
}

#[test]
fn a_file_of_another_kind_is_named_as_such() {
    let (folder, mut state) = pattern_session();
    let [session, set] = ["one.json", "own.csv"].map(|name| folder.path().join(name));
    for (purpose, path, expected) in [
        (Purpose::Open, &set, "point set"),
        (Purpose::Pattern, &session, "saved session"),
        (Purpose::Against, &session, "saved session"),
        (Purpose::Combination, &session, "saved session"),
    ] {
        open_path(&mut state, purpose, path);
        assert!(
            is_error(&state) && notice_text(&state).contains(expected),
            "{purpose:?}: {}",
            notice_text(&state)
        );
        file(&mut state, FileCommand::Close);
    }
}

#[test]
fn a_session_without_an_ending_is_saved_as_json() {
    let folder = tempfile::tempdir().unwrap();
    let mut state = opened();
    let path = |name: &str| folder.path().join(name);
    for (typed, written) in [
        ("lecture", "lecture.json"),
        ("lecture.json", "lecture.json"),
        ("lecture.session", "lecture.session"),
    ] {
        open_path(&mut state, Purpose::Save, &path(typed));
        assert!(path(written).is_file(), "{typed}: {}", notice_text(&state));
        assert!(state.files().sheet.is_none(), "the sheet is closed");
        assert_eq!(
            state.runs().first.session_path.as_deref(),
            path(written).to_str()
        );
        assert!(!path("lecture").exists());
    }
    // Confirmation to replace a file concerns the name with the ending added.
    fs::write(path("other.json"), "mine").unwrap();
    open_path(&mut state, Purpose::Save, &path("other"));
    assert!(state.files().sheet.as_ref().unwrap().asked);
    assert_eq!(fs::read(path("other.json")).unwrap(), b"mine");
}

#[test]
fn a_pattern_is_the_same_from_bytes_and_from_a_path() {
    let (folder, _) = pattern_session();
    let set = folder.path().join("own.csv");
    let mut by_path = opened();
    open_path(&mut by_path, Purpose::Pattern, &set);
    let expected = by_path
        .form()
        .own_pattern
        .as_ref()
        .unwrap()
        .file
        .digest
        .clone();
    let both = || vec![named(&certificate_path(&set)), named(&set)];
    for dropped in [true, false] {
        let mut state = opened();
        if dropped {
            drop_bytes(&mut state, both());
        } else {
            choose(&mut state, Purpose::Pattern, both());
        }
        let own = state.form().own_pattern.as_ref().expect("a pattern");
        assert_eq!(own.file.digest, expected);
        assert!(notice_text(&state).contains("The next run clips from"));
    }
    // Another set makes another pattern.
    let mut other = opened();
    other.apply(Command::Form(FormCommand::Type(
        tilescope_core::Parameter::Seed,
        "9".to_owned(),
    )));
    other.apply(Command::Run);
    other.settle();
    let path = folder.path().join("other.ply");
    exporting::write(&mut other, ExportKind::Result, &path, &[]);
    let files = vec![named(&path), named(&certificate_path(&path))];
    drop_bytes(&mut other, files);
    assert_ne!(
        other.form().own_pattern.as_ref().unwrap().file.digest,
        expected
    );
}

#[test]
fn a_dropped_set_that_is_not_a_pattern_is_compared_with_the_run() {
    let (folder, _) = pattern_session();
    let set = folder.path().join("own.csv");
    let bare = folder.path().join("bare.csv");
    fs::copy(&set, &bare).unwrap();
    let mut by_path = opened();
    open_path(&mut by_path, Purpose::Against, &bare);
    let expected = by_path
        .analysis()
        .file_for(&by_path.runs().first)
        .unwrap()
        .unwrap()
        .clone();
    let path = bare.to_string_lossy().into_owned();
    for from_path in [true, false] {
        let mut state = opened();
        if from_path {
            file(&mut state, FileCommand::Dropped(vec![path.clone()]));
        } else {
            drop_bytes(&mut state, vec![named(&bare)]);
        }
        let file = state
            .analysis()
            .file_for(&state.runs().first)
            .expect("a file")
            .unwrap()
            .clone();
        assert_eq!(file.measured, expected.measured);
        assert!(state.form().own_pattern.is_none() && !is_error(&state));
        let message = notice_text(&state);
        assert!(message.starts_with("bare.csv is compared with this run"));
        assert!(message.contains("has no certificate"), "{message}");
    }
    // So is one whose certificate is that of other points, which is left out.
    let mut points = named(&set);
    let end = points.bytes.len() - 1;
    let row = points.bytes[..end].iter().rposition(|&byte| byte == b'\n');
    points.bytes.truncate(row.unwrap() + 1);
    let false_pair = vec![points, named(&certificate_path(&set))];
    let mut state = opened();
    drop_bytes(&mut state, false_pair.clone());
    assert!(state.form().own_pattern.is_none() && !is_error(&state));
    let message = notice_text(&state);
    assert!(
        message.contains("own.csv.certificate.json is not true: digest: "),
        "{message}"
    );
    assert!(state.analysis().file_for(&state.runs().first).is_some());
    let mut state = opened();
    choose(&mut state, Purpose::Pattern, false_pair.clone());
    assert!(is_error(&state) && notice_text(&state).contains("is not true"));
    choose(&mut state, Purpose::Against, false_pair);
    assert!(!is_error(&state) && notice_text(&state).contains("is not true"));
    // The sheet for patterns accepts only a pattern.
    let mut state = opened();
    choose(&mut state, Purpose::Pattern, vec![named(&bare)]);
    assert!(is_error(&state) && notice_text(&state).contains("has no certificate"));
    assert!(
        state.analysis().file_for(&state.runs().first).is_none() && state.files().sheet.is_some()
    );
    choose(&mut state, Purpose::Against, vec![named(&bare)]);
    assert_eq!(
        state
            .analysis()
            .file_for(&state.runs().first)
            .unwrap()
            .unwrap()
            .measured,
        expected.measured,
        "chosen"
    );
}

#[test]
fn a_layout_finds_its_sets_among_the_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let set = folder.path().join("a.csv");
    let mut state = opened();
    exporting::write(&mut state, ExportKind::Result, &set, &[]);
    let layout = folder.path().join("layout.json");
    let text = serde_json::json!({ "version": 1, "radius": 0.02, "columns": [0.5, 0.5],
        "rows": [1.0], "pieces": [{ "file": "a.csv" }, { "seed": 2 }] });
    fs::write(&layout, text.to_string()).unwrap();
    let stated = |state: &State| {
        let session = state.runs().first.session.as_ref().unwrap();
        let combination = session.combination.as_ref().expect("a combination");
        let digest = tilescope_debugger::digest(session.run());
        (digest, combination.stated.clone())
    };
    open_path(&mut state, Purpose::Combination, &layout);
    assert!(!is_error(&state), "{}", notice_text(&state));
    let expected = stated(&state);
    for dropped in [true, false] {
        let mut other = opened();
        let files = vec![named(&set), named(&certificate_path(&set)), named(&layout)];
        if dropped {
            drop_bytes(&mut other, files);
        } else {
            choose(&mut other, Purpose::Combination, files);
        }
        assert!(!is_error(&other), "{}", notice_text(&other));
        assert_eq!(stated(&other), expected);
    }
    let mut other = opened();
    drop_bytes(&mut other, vec![named(&layout)]);
    let message = notice_text(&other);
    assert!(
        is_error(&other) && message.contains("a.csv: it did not come with the layout"),
        "{message}"
    );
}

/// Makes the sheet's export in memory.
fn rendered(state: &State) -> Vec<NamedBytes> {
    let order = state.files().exports.job(ExportSource::of(state)).unwrap();
    let wake: tilescope_session::jobs::Wake = std::sync::Arc::new(|| {});
    let job = tilescope_session::jobs::Job::start(&wake, move |monitor| {
        write::render(&order, monitor).expect("files in memory")
    });
    job.wait().unwrap().files
}

#[test]
fn an_export_has_the_same_bytes_on_the_disk_and_in_memory() {
    let folder = tempfile::tempdir().unwrap();
    let mut state = opened();
    state.apply(Command::Time(TimeCommand::ShowStage(3)));
    for (kind, name) in [
        (ExportKind::Result, "a.csv"),
        (ExportKind::Result, "a.json"),
        (ExportKind::Result, "a.ply"),
        (ExportKind::Result, "a.npy"),
        (ExportKind::Samples, "moment.rps"),
        (ExportKind::Picture, "a.png"),
        (ExportKind::Picture, "a.svg"),
        (ExportKind::Animation, "a.gif"),
        (ExportKind::Animation, "a.apng"),
    ] {
        let path = folder.path().join(name);
        let every = [(NumberField::Every, "2000")];
        let entries = &every[..usize::from(kind == ExportKind::Animation)];
        fill_in(&mut state, kind, &path, entries);
        let made = rendered(&state);
        assert!(made == rendered(&state), "{name}: it is another one");
        exporting::export(&mut state, ExportCommand::Write);
        state.settle();
        assert!(path.exists(), "{name}: {}", notice_text(&state));
        let mut written = vec![named(&path)];
        let certificate = certificate_path(&path);
        assert_eq!(certificate.exists(), kind.is_set());
        if kind.is_set() {
            written.push(named(&certificate));
        }
        assert!(made == written, "{name}: {made:?} for {written:?}");
    }
    // Another export gives other bytes.
    let path = folder.path().join("b.npy");
    fill_in(&mut state, ExportKind::Result, &path, &[]);
    let double = rendered(&state);
    let single = ExportCommand::Precision(tilescope_formats::Precision::Single);
    exporting::export(&mut state, single);
    assert!(double[0] != rendered(&state)[0]);
}

/// The files of an archive.
fn unpacked(file: &NamedBytes) -> Vec<NamedBytes> {
    let bytes = std::io::Cursor::new(&file.bytes);
    let mut archive = zip::ZipArchive::new(bytes).expect("an archive");
    (0..archive.len())
        .map(|k| {
            let mut entry = archive.by_index(k).unwrap();
            let name = entry.name().unwrap().into_owned();
            assert_eq!(entry.compression(), zip::CompressionMethod::Stored);
            let mut bytes = Vec::new();
            std::io::Read::read_to_end(&mut entry, &mut bytes).unwrap();
            NamedBytes { name, bytes }
        })
        .collect()
}

#[test]
fn a_download_is_one_file_and_its_archive_can_be_verified() {
    let folder = tempfile::tempdir().unwrap();
    // Files on the disk do not matter to a browser.
    let taken = folder.path().join("set.csv");
    fs::write(&taken, "somebody else's").unwrap();
    let mut state = opened();
    state.restore(Settings {
        delivery: Some(Delivery::Download),
        ..Settings::default()
    });
    let mut archives = Vec::new();
    for _ in 0..2 {
        exporting::write(&mut state, ExportKind::Result, &taken, &[]);
        let message = notice_text(&state);
        assert!(
            message.starts_with("Downloaded ") && !is_error(&state),
            "{message}"
        );
        assert!(message.contains("set.csv.zip") && message.contains("set.csv.certificate.json"));
        assert!(state.files().exports.sheet.is_none(), "the sheet is closed");
        let mut downloads = state.take_requests().downloads;
        assert_eq!(downloads.len(), 1);
        archives.push(downloads.pop().unwrap());
    }
    assert!(archives[0] == archives[1], "an archive has no date");
    assert_eq!(archives[0].name, "set.csv.zip");
    let files = unpacked(&archives[0]);
    let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).collect();
    assert_eq!(names, ["set.csv", "set.csv.certificate.json"]);
    let control = |_| std::ops::ControlFlow::Continue(());
    let checked = |data: &[u8]| {
        let certificate = Some(files[1].bytes.as_slice());
        check_bytes(
            data,
            "set.csv",
            certificate,
            &Overrides::default(),
            &control,
        )
        .unwrap()
        .1
    };
    assert!(checked(&files[0].bytes).passed());
    let mut altered = files[0].bytes.clone();
    let digit = altered.iter().rposition(u8::is_ascii_digit).unwrap();
    altered[digit] = if altered[digit] == b'7' { b'3' } else { b'7' };
    assert!(!checked(&altered).passed());
    assert_eq!(fs::read(&taken).unwrap(), b"somebody else's");
    // A downloaded archive can be dropped, or opened by path, and gives a pattern.
    let mut other = opened();
    drop_bytes(&mut other, vec![archives[0].clone()]);
    let digest = other
        .form()
        .own_pattern
        .as_ref()
        .expect("a pattern")
        .file
        .digest
        .clone();
    let path = folder.path().join(&archives[0].name);
    fs::write(&path, &archives[0].bytes).unwrap();
    let mut third = opened();
    open_path(&mut third, Purpose::Pattern, &path);
    assert_eq!(
        third.form().own_pattern.as_ref().unwrap().file.digest,
        digest
    );
    // A picture is downloaded without an archive.
    exporting::write(&mut state, ExportKind::Picture, Path::new("view.svg"), &[]);
    let downloads = state.take_requests().downloads;
    assert_eq!(downloads[0].name, "view.svg");
    assert!(downloads[0].bytes.starts_with(b"<svg"));
    assert!(state.take_requests().downloads.is_empty(), "taken once");
    assert!(!Path::new("view.svg").exists());
    assert!(packed(Vec::new()).is_err());
}

#[test]
fn a_downloaded_session_equals_a_saved_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mine.json");
    let mut state = opened();
    open_path(&mut state, Purpose::Save, &path);
    let written = fs::read(&path).unwrap();
    state.restore(Settings {
        delivery: Some(Delivery::Download),
        ..Settings::default()
    });
    open_path(
        &mut state,
        Purpose::Save,
        Path::new("some/folder/mine.json"),
    );
    assert_eq!(
        notice_text(&state),
        "The session is downloaded as mine.json."
    );
    let downloads = state.take_requests().downloads;
    assert_eq!(downloads.len(), 1);
    assert_eq!(downloads[0].name, "mine.json");
    assert!(downloads[0].bytes == written);
    assert!(state.files().sheet.is_none());
    // In a browser, a file to open is chosen, not typed.
    file(&mut state, FileCommand::Sheet(Purpose::Open));
    assert_eq!(state.files().sheet.as_ref().unwrap().path, "");
    file(
        &mut state,
        FileCommand::Path(path.to_string_lossy().into_owned()),
    );
    file(&mut state, FileCommand::Go);
    assert!(is_error(&state) && notice_text(&state).contains("Browse"));
    let mut other = opened();
    other.restore(Settings {
        delivery: Some(Delivery::Download),
        ..Settings::default()
    });
    choose(&mut other, Purpose::Open, downloads);
    assert_eq!(SaveTask::of(&other).run, SaveTask::of(&state).run);
}
