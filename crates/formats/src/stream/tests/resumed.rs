//! Interruptions: a resumed export gives the same bytes, and one that cannot be resumed says why.

use serde_json::{Value, json};

use super::*;
use crate::error::FormatError;
use crate::export::ExportError;

const RESUMABLE: StreamOptions = StreamOptions {
    verify: true,
    resumable: true,
};

fn begun(path: &Path, context: &ExportContext) -> StreamExport {
    let export = StreamExport::create(path, context, RESUMABLE).expect("begun");
    export.with_band(SMALL)
}

/// An export interrupted as by a power cut: the points pushed after the checkpoint are only partly in the file.
fn interrupted(path: &Path, context: &ExportContext, set: &PointSet, stops: [usize; 2]) {
    let mut export = begun(path, context);
    let [kept, lost] = stops;
    push(&mut export, set, 0..kept / 2, 50);
    export
        .checkpoint(&json!({ "next": kept / 2 }))
        .expect("saved");
    push(&mut export, set, kept / 2..kept, 50);
    export
        .checkpoint(&json!({ "next": kept, "seed": u64::MAX }))
        .expect("saved");
    let mut before = names(path.parent().expect("a folder"));
    push(&mut export, set, kept..lost, 50);
    drop(export);
    before.retain(|name| Path::new(name).extension() != Some("lock".as_ref()));
    let mut bytes = fs::read(partial_path(path)).expect("kept");
    bytes.extend_from_slice(&[0xA5; 1001]);
    fs::write(partial_path(path), bytes).expect("writable");
    assert_eq!(names(path.parent().expect("a folder")), before);
}

#[test]
fn a_resumed_export_has_the_same_bytes_and_certificate() {
    for (format, precision) in cases() {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            let (set, context) = (rows(boundary, 0.2), context(boundary, precision));
            let (_folder, _, expected) = whole(&set, &context, format);
            for kept in [0, 3, 400, 1000, set.len()] {
                let folder = tempfile::tempdir().expect("a folder");
                let path = folder.path().join(name(format));
                interrupted(&path, &context, &set, [kept, set.len()]);
                let token = checkpoint_token(&path).expect("readable");
                let (export, found) = StreamExport::resume(&path, &context).expect("resumable");
                assert_eq!(token.as_ref(), Some(&found));
                assert_eq!(found, json!({ "next": kept, "seed": u64::MAX }));
                let mut export = export.with_band(SMALL);
                assert_eq!(export.count(), kept as u64);
                push(&mut export, &set, kept..set.len(), 77);
                export.checkpoint(&Value::Null).expect("saved");
                export.finish(&GO).expect("proven");
                assert_eq!(bytes_of(&path), expected, "{format} {precision} {kept}");
                assert_eq!(names(folder.path()).len(), 2, "{:?}", names(folder.path()));
            }
        }
    }
}

#[test]
fn an_unverified_export_resumes_too() {
    let context = context(Boundary::Periodic, Precision::Double);
    let set = rows(Boundary::Periodic, 0.2);
    let (_folder, _, expected) = whole(&set, &context, Format::Csv);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("set.csv");
    let options = StreamOptions {
        verify: false,
        resumable: true,
    };
    let mut export = StreamExport::create(&path, &context, options).expect("begun");
    push(&mut export, &set, 0..500, 500);
    export.checkpoint(&json!(500)).expect("saved");
    drop(export);
    let (mut export, token) = StreamExport::resume(&path, &context).expect("resumable");
    assert_eq!(token, json!(500));
    push(&mut export, &set, 500..set.len(), 500);
    assert!(export.finish(&GO).expect("proven").verified.is_none());
    assert_eq!(fs::read(&path).expect("there"), expected[0]);
    assert_eq!(names(folder.path()).len(), 1);
}

fn refused(path: &Path, context: &ExportContext) -> String {
    let before = names(path.parent().expect("a folder"));
    let error = StreamExport::resume(path, context).expect_err("refused");
    assert!(matches!(error, ExportError::Resume { .. }), "{error}");
    assert_eq!(
        names(path.parent().expect("a folder")),
        before,
        "left as it is"
    );
    error.to_string()
}

#[test]
fn what_is_missing_or_damaged_is_named() {
    let context = context(Boundary::Periodic, Precision::Double);
    let set = rows(Boundary::Periodic, 0.2);
    for (format, _) in cases() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join(name(format));
        assert!(refused(&path, &context).contains("there is no checkpoint"));
        assert_eq!(checkpoint_token(&path).expect("none"), None);
        interrupted(&path, &context, &set, [900, 1000]);
        let partial = partial_path(&path);
        let good = fs::read(&partial).expect("there");
        let with = |bytes: &[u8]| {
            fs::write(&partial, bytes).expect("writable");
            refused(&path, &context)
        };
        assert!(with(&good[..good.len() / 2]).contains("bytes, and the checkpoint is of"));
        let mut flipped = good.clone();
        flipped[good.len() / 2] ^= 0x10;
        let message = with(&flipped);
        // In some formats the damage shows before the digest does.
        assert!(message.contains("set."), "{message}");
        fs::remove_file(&partial).expect("there");
        assert!(refused(&path, &context).contains("it is not there"));
        fs::write(&partial, &good).expect("writable");
        drop(StreamExport::resume(&path, &context).expect("whole again"));
        // A new export discards the interrupted one, and removes its own files where it is not finished.
        let new = StreamExport::create(&path, &context, StreamOptions::default());
        drop(new.expect("a new file"));
        assert!(
            names(folder.path()).is_empty(),
            "{:?}",
            names(folder.path())
        );
    }
}

#[test]
fn an_export_that_ended_after_its_last_renaming_is_finished() {
    let context = context(Boundary::Periodic, Precision::Double);
    let set = rows(Boundary::Periodic, 0.2);
    for (format, verify) in STREAMED.into_iter().flat_map(|f| [(f, true), (f, false)]) {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join(name(format));
        let options = StreamOptions {
            verify,
            resumable: true,
        };
        let export = StreamExport::create(&path, &context, options).expect("begun");
        let mut export = export.with_band(SMALL);
        push(&mut export, &set, 0..900, 50);
        export.checkpoint(&json!(900)).expect("saved");
        assert!(matches!(
            finish_interrupted(&path),
            Err(ExportError::Format(FormatError::Busy { .. }))
        ));
        let kept: Vec<(String, Vec<u8>)> = (names(folder.path()).into_iter())
            .filter(|name| name.contains(".resume."))
            .map(|name| {
                (
                    name.clone(),
                    fs::read(folder.path().join(name)).expect("there"),
                )
            })
            .collect();
        push(&mut export, &set, 900..set.len(), 50);
        export.finish(&GO).expect("proven");
        let after = |left: &str| {
            for (name, bytes) in &kept {
                fs::write(folder.path().join(name), bytes).expect("writable");
            }
            fs::write(folder.path().join(left), "").expect("writable");
        };

        // The process ended before it removed the checkpoint, or before the certificate had its name.
        let lock = format!("{}.lock", name(format));
        after(&lock);
        let points = set.len() as u64;
        assert_eq!(finish_interrupted(&path).expect("readable"), Some(points));
        let files = if verify { 2 } else { 1 };
        assert_eq!(names(folder.path()).len(), files, "{format}");
        if verify {
            let certificate = certificate_path(&path);
            let unnamed = format!(".{}.certificate.json.new~", name(format));
            fs::rename(&certificate, folder.path().join(unnamed)).expect("writable");
            after(&lock);
            assert_eq!(finish_interrupted(&path).expect("readable"), Some(points));
            assert!(certificate.exists());
        }

        // Another file of that name is not the one that was being written.
        after(&lock);
        let mut bytes = fs::read(&path).expect("there");
        let middle = bytes.len() / 2;
        bytes[middle] ^= 1;
        fs::write(&path, bytes).expect("writable");
        assert_eq!(finish_interrupted(&path).expect("readable"), None);
        assert!(resume_path(&path).exists());
    }
}

#[test]
fn a_damaged_checkpoint_or_another_context_is_refused() {
    let asked = context(Boundary::Periodic, Precision::Double);
    let set = rows(Boundary::Periodic, 0.2);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("set.npy");
    interrupted(&path, &asked, &set, [900, 1000]);
    let mut other = asked.clone();
    other.radius = 0.7;
    assert!(refused(&path, &other).contains("radius is 0.8, asked was 0.7"));
    let other = context(Boundary::Bounded, Precision::Double);
    assert!(refused(&path, &other).contains("its region is periodic"));
    let other = context(Boundary::Periodic, Precision::Single);
    assert!(refused(&path, &other).contains("precision is f64, asked was f32"));
    let document = resume_path(&path);
    let good = fs::read_to_string(&document).expect("there");
    fs::write(&document, &good[..good.len() / 2]).expect("writable");
    assert!(refused(&path, &asked).contains("EOF"));
    fs::write(&document, good.replace("\"version\": 1", "\"version\": 2")).expect("writable");
    assert!(refused(&path, &asked).contains("its version is 2"));
    fs::write(&document, &good).expect("writable");
    let state = names(folder.path())
        .into_iter()
        .find(|n| n.contains(".state"));
    let state = folder.path().join(state.expect("there"));
    let mut bytes = fs::read(&state).expect("there");
    bytes[100] ^= 1;
    fs::write(&state, &bytes).expect("writable");
    assert!(refused(&path, &asked).contains("not what the checkpoint names"));
}

#[test]
fn only_a_resumable_export_has_checkpoints_and_a_new_one_forgets_the_old() {
    let context = context(Boundary::Periodic, Precision::Double);
    let set = rows(Boundary::Periodic, 0.2);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("set.npy");
    let plain = StreamExport::create(&path, &context, StreamOptions::default());
    let error = plain.expect("begun").checkpoint(&Value::Null);
    assert!(matches!(error, Err(ExportError::Resume { .. })));
    interrupted(&path, &context, &set, [900, 1000]);
    // What interruptions leave at other moments.
    for left in [
        "set.npy.resume.0.state",
        "set.npy.resume.2.state",
        "set.npy.resume.tmp",
    ] {
        fs::write(folder.path().join(left), "left").expect("writable");
    }
    let new = begun(&path, &context);
    assert_eq!(checkpoint_token(&path).expect("none"), None);
    drop(new);
    assert!(names(folder.path()).is_empty());
}

#[test]
fn a_number_that_is_not_that_of_the_rows_is_refused() {
    let context = context(Boundary::Periodic, Precision::Double);
    let set = rows(Boundary::Periodic, 0.2);
    for (format, verify) in STREAMED.into_iter().flat_map(|f| [(f, true), (f, false)]) {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join(name(format));
        let options = StreamOptions {
            verify,
            resumable: true,
        };
        let mut export = StreamExport::create(&path, &context, options).expect("begun");
        push(&mut export, &set, 0..900, 50);
        export.checkpoint(&Value::Null).expect("saved");
        drop(export);
        let document = resume_path(&path);
        let good = fs::read_to_string(&document).expect("there");
        for count in ["901", "899", "0"] {
            let bad = good.replace("\"count\": 900", &format!("\"count\": {count}"));
            assert_ne!(bad, good);
            fs::write(&document, bad).expect("writable");
            let message = refused(&path, &context);
            assert!(
                message.contains(&format!("states {count} points")),
                "{message}"
            );
            assert!(message.contains("which are 900 points"), "{message}");
        }
        fs::write(&document, good).expect("writable");
        assert!(StreamExport::resume(&path, &context).is_ok(), "{format}");
    }
}

#[test]
fn a_second_export_of_a_name_is_refused_and_the_first_is_not_harmed() {
    let context = context(Boundary::Periodic, Precision::Double);
    let set = rows(Boundary::Periodic, 0.2);
    let (_folder, _, expected) = whole(&set, &context, Format::Npy);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("set.npy");
    let busy = |outcome: Result<StreamExport, ExportError>| {
        let error = outcome.expect_err("at work");
        let is_busy = matches!(error, ExportError::Format(FormatError::Busy { .. }));
        assert!(is_busy, "{error}");
    };
    let mut first = begun(&path, &context);
    push(&mut first, &set, 0..700, 50);
    first.checkpoint(&json!(700)).expect("saved");
    let before = names(folder.path());
    busy(StreamExport::create(&path, &context, RESUMABLE));
    busy(StreamExport::resume(&path, &context).map(|(export, _)| export));
    #[cfg(unix)]
    {
        let link = folder.path().join("link.npy");
        std::os::unix::fs::symlink("set.npy", &link).expect("a link");
        busy(StreamExport::create(&link, &context, RESUMABLE));
        fs::remove_file(link).expect("there");
    }
    assert_eq!(names(folder.path()), before);
    drop(first);
    let (mut second, _) = StreamExport::resume(&path, &context).expect("nobody writes");
    push(&mut second, &set, 700..set.len(), 50);
    second.finish(&GO).expect("proven");
    assert_eq!(bytes_of(&path), expected);
    assert_eq!(names(folder.path()).len(), 2);
    // The lock file of a killed process does not lock.
    fs::write(folder.path().join("set.npy.lock"), "").expect("writable");
    drop(begun(&path, &context));
    assert_eq!(names(folder.path()).len(), 2);
}

#[cfg(unix)]
#[test]
fn a_stream_goes_where_a_link_leads() {
    let context = context(Boundary::Periodic, Precision::Double);
    let set = rows(Boundary::Periodic, 0.2);
    let folder = tempfile::tempdir().expect("a folder");
    let (path, data) = (folder.path().join("set.npy"), folder.path().join("data"));
    fs::create_dir(&data).expect("writable");
    std::os::unix::fs::symlink("data/far.npy", &path).expect("a link");
    for verify in [true, false] {
        let options = StreamOptions {
            verify,
            resumable: true,
        };
        let mut export = StreamExport::create(&path, &context, options).expect("begun");
        push(&mut export, &set, 0..700, 50);
        export.checkpoint(&json!(700)).expect("saved");
        drop(export);
        assert_eq!(checkpoint_token(&path).expect("readable"), Some(json!(700)));
        let (mut export, _) = StreamExport::resume(&path, &context).expect("resumable");
        push(&mut export, &set, 700..set.len(), 50);
        let streamed = export.finish(&GO).expect("proven");
        assert_eq!(streamed.path, path);
        assert!(path.is_symlink());
        let mut both = BTreeSet::from(["far.npy".to_owned()]);
        both.extend(verify.then(|| "far.npy.certificate.json".to_owned()));
        assert_eq!(names(&data), both);
    }
    let _socket = std::os::unix::net::UnixListener::bind(data.join("no.npy")).expect("a socket");
    let refused = StreamExport::create(&data.join("no.npy"), &context, RESUMABLE);
    assert!(
        refused
            .expect_err("no file")
            .to_string()
            .contains("a socket")
    );
}

#[test]
fn an_origin_is_resumed_and_another_is_refused() {
    let context = ExportContext {
        origin: [5e5, 5.4e6],
        ..context(Boundary::Periodic, Precision::Double)
    };
    let set = rows(Boundary::Periodic, 0.2);
    for format in [Format::Csv, Format::Npy, Format::PlyBinary] {
        let (_folder, _, expected) = whole(&set, &context, format);
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join(name(format));
        interrupted(&path, &context, &set, [400, set.len()]);

        let other = ExportContext {
            origin: [0.0; 2],
            ..context.clone()
        };
        let refused = StreamExport::resume(&path, &other).expect_err("another origin");
        assert!(
            refused
                .to_string()
                .contains("its origin is 500000 5400000, asked was 0 0"),
            "{refused}"
        );

        let (export, _) = StreamExport::resume(&path, &context).expect("resumable");
        let mut export = export.with_band(SMALL);
        push(&mut export, &set, 400..set.len(), 77);
        export.finish(&GO).expect("proven");
        assert_eq!(bytes_of(&path), expected, "{format}");
    }
}
