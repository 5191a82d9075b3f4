//! A stream writes the same bytes as an export in memory, and no file if it fails.

use tilescope_analysis::VerifyError;

use super::*;
use crate::codecs::rows::head;
use crate::error::FormatError;
use crate::export::{ExportError, Warning};

fn streamed(
    path: &Path,
    set: &PointSet,
    context: &ExportContext,
    piece: usize,
    options: StreamOptions,
) -> Streamed {
    let export = StreamExport::create(path, context, options).expect("begun");
    let mut export = export.with_band(SMALL).expecting(set.len() as u64);
    push(&mut export, set, 0..set.len(), piece);
    assert_eq!(export.count(), set.len() as u64);
    export.finish(&GO).expect("proven")
}

#[test]
fn all_formats_and_precisions_have_the_bytes_of_the_export_in_memory() {
    for (format, precision) in cases() {
        for boundary in [Boundary::Periodic, Boundary::Bounded] {
            for (jitter, piece) in [(0.01, 7), (0.2, 100), (0.2, 5000)] {
                let context = context(boundary, precision);
                let mut set = rows(boundary, jitter);
                if piece == 100 {
                    set.provenance = None;
                }
                let (_folder, _, expected) = whole(&set, &context, format);
                let folder = tempfile::tempdir().expect("a folder");
                let path = folder.path().join(name(format));
                let found = streamed(&path, &set, &context, piece, StreamOptions::default());
                assert_eq!(bytes_of(&path)[0], expected[0], "{format} {precision}");
                let texts = [&bytes_of(&path)[1], &expected[1]]
                    .map(|b| String::from_utf8_lossy(b).into_owned());
                assert_eq!(texts[0], texts[1], "{format} {precision} {boundary:?}");
                assert_eq!(names(folder.path()).len(), 2);
                assert_eq!(
                    (found.count, found.bytes),
                    (set.len() as u64, expected[0].len() as u64)
                );
                let verified = found.verified.expect("asked for");
                let again = export(&path, &set, &context, &GO).expect("a verdict");
                assert_eq!(verified.certificate, again.certificate);
                assert_eq!(
                    (&verified.warnings, &found.warnings),
                    (&again.warnings, &again.warnings)
                );
            }
        }
    }
}

/// The radius is exactly the distance of the closest pair, so that rounding makes conflicts; then just above it.
#[test]
fn what_rounding_did_is_stated_as_in_memory() {
    let boundary = Boundary::Periodic;
    let set = rows(boundary, 0.1);
    let options = tilescope_analysis::VerifyOptions::default();
    let report = tilescope_analysis::verify(&set.points, region(boundary), 0.8, &options, &GO);
    let tight = report.expect("a verdict").min_distance;
    for (radius, blamed) in [(tight, true), (tight.next_up(), false)] {
        let mut context = context(boundary, Precision::Single);
        context.radius = radius;
        // The other pairs are further apart; so the one that was the closest decides.
        let (_folder, _, expected) = whole(&set, &context, Format::Npy);
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("set.npy");
        let found = streamed(&path, &set, &context, 90, StreamOptions::default());
        assert_eq!(bytes_of(&path), expected);
        let certificate = found.verified.expect("asked for").certificate;
        if certificate.conflicts > 0 {
            assert_eq!(certificate.rounding.expect("moved").made_conflicts, blamed);
        }
    }
}

#[test]
fn without_verification_the_bytes_are_the_same_and_no_certificate_lies_beside_them() {
    let options = StreamOptions {
        verify: false,
        ..StreamOptions::default()
    };
    for (format, precision) in cases() {
        let context = context(Boundary::Bounded, precision);
        let mut set = rows(Boundary::Bounded, 0.3);
        // An older file's certificate would be a false one.
        let (folder, path, _) = whole(&rows(Boundary::Bounded, 0.0), &context, format);
        set.points.reverse();
        let found = streamed(&path, &set, &context, 333, options);
        assert!(found.verified.is_none());
        assert_eq!(names(folder.path()), BTreeSet::from([name(format)]));
        let (_other, _, expected) = whole(&set, &context, format);
        assert_eq!(fs::read(&path).expect("there"), expected[0]);
        let left_out = Warning::ProvenanceLeftOut { format };
        assert_eq!(
            found.warnings.contains(&left_out),
            !format.carries_provenance()
        );
    }
}

#[test]
fn what_is_refused_leaves_everything_as_it_was() {
    let context = context(Boundary::Periodic, Precision::Double);
    let good = rows(Boundary::Periodic, 0.1);
    let mut reversed = good.points.clone();
    reversed.reverse();
    let mut nan = good.points.clone();
    nan[900] = [f64::NAN, 75.0];
    let mut twin = good.points.clone();
    twin[900] = twin[899];
    for (bad, resumable) in [(&reversed, false), (&nan, true), (&twin, false)] {
        let (folder, path, before) = whole(&good, &context, Format::Csv);
        let options = StreamOptions {
            verify: true,
            resumable,
        };
        let mut export = StreamExport::create(&path, &context, options).expect("begun");
        assert!(names(folder.path()).contains("set.csv.partial"));
        let outcome = export
            .push(bad, None, &GO)
            .and_then(|()| export.checkpoint(&serde_json::Value::Null));
        match outcome {
            Err(ExportError::Verify {
                source: VerifyError::OutOfOrder { .. },
                ..
            }) => {
                assert_eq!(bad, &reversed);
            }
            Err(ExportError::Format(FormatError::NotFinite { .. })) => assert!(resumable),
            // A small set's duplicates are found when it is complete.
            Err(ExportError::Resume { .. }) => assert_eq!(bad, &twin),
            other => panic!("{other:?}"),
        }
        let again = export.push(&good.points, None, &GO);
        assert!(bad == &twin || matches!(again, Err(ExportError::Failed { .. })));
        assert!(export.finish(&GO).is_err());
        assert_eq!(bytes_of(&path), before);
        assert_eq!(names(folder.path()).len(), 2);
    }
}

#[test]
fn cancelled_and_empty_exports_leave_nothing() {
    let context = context(Boundary::Periodic, Precision::Double);
    let set = rows(Boundary::Periodic, 0.1);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("set.ply");
    let begin = || StreamExport::create(&path, &context, StreamOptions::default()).expect("begun");
    let stop = |_| ControlFlow::Break(());
    let mut export = begin();
    assert!(export.push(&set.points, None, &stop).is_err());
    drop(export);
    let mut export = begin();
    export.push(&set.points, None, &GO).expect("taken");
    assert!(matches!(
        export.finish(&stop),
        Err(ExportError::Verify {
            source: VerifyError::Cancelled,
            ..
        })
    ));
    let empty = begin().finish(&GO);
    assert!(matches!(
        empty,
        Err(ExportError::Format(FormatError::Empty { .. }))
    ));
    drop(begin());
    assert!(names(folder.path()).is_empty());
}

#[test]
fn faulty_storage_is_found_out() {
    let context = context(Boundary::Periodic, Precision::Double);
    let set = rows(Boundary::Periodic, 0.1);
    for (format, _) in cases() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join(name(format));
        let options = StreamOptions {
            verify: true,
            resumable: true,
        };
        let mut export = StreamExport::create(&path, &context, options).expect("begun");
        export.push(&set.points, None, &GO).expect("taken");
        export.checkpoint(&serde_json::Value::Null).expect("saved");
        let mut bytes = fs::read(partial_path(&path)).expect("there");
        let end = bytes.len();
        bytes[end - 20] ^= 1;
        fs::write(partial_path(&path), bytes).expect("writable");
        let error = export.finish(&GO).expect_err("another file");
        assert!(matches!(error, ExportError::ReadBack { .. }), "{error}");
        assert!(!path.exists());
    }
}

#[test]
fn what_no_stream_can_be_is_refused_at_the_start() {
    let folder = tempfile::tempdir().expect("a folder");
    let begin = |name: &str, context: &ExportContext| {
        let path = folder.path().join(name);
        StreamExport::create(&path, context, StreamOptions::default()).expect_err("refused")
    };
    let mut asked = context(Boundary::Periodic, Precision::Double);
    for format in Format::ALL.into_iter().filter(|format| !format.streams()) {
        asked.format = Some(format);
        assert!(
            matches!(begin("set", &asked), ExportError::NotStreamed { format: f } if f == format)
        );
    }
    asked.format = None;
    assert!(matches!(
        begin("set.jpeg", &asked),
        ExportError::Format(FormatError::UnknownFormat { .. })
    ));
    asked.radius = -1.0;
    assert!(matches!(
        begin("set.npy", &asked),
        ExportError::Format(FormatError::Parameter { .. })
    ));
    asked.radius = 0.8;
    asked.shuffle_seed = Some(4);
    assert!(matches!(
        begin("set.npy", &asked),
        ExportError::ShuffledStream { seed: 4 }
    ));
    asked.shuffle_seed = None;
    assert!(matches!(
        begin("no/set.npy", &asked),
        ExportError::Format(FormatError::Io { .. })
    ));
    assert!(names(folder.path()).is_empty());
}

#[test]
fn provenance_is_given_always_or_never() {
    let context = context(Boundary::Periodic, Precision::Double);
    let set = rows(Boundary::Periodic, 0.1);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("set.ply");
    let provenance = set.provenance.as_deref().expect("there");
    for (first, second) in [
        (Some(&provenance[..2]), None),
        (None, Some(&provenance[..2])),
    ] {
        let mut export =
            StreamExport::create(&path, &context, StreamOptions::default()).expect("begun");
        export.push(&set.points[..2], first, &GO).expect("taken");
        let error = export
            .push(&set.points[2..4], second, &GO)
            .expect_err("another kind");
        assert!(matches!(
            error,
            ExportError::Format(FormatError::Provenance { .. })
        ));
    }
}

#[test]
fn heads_are_of_one_length_whatever_the_count() {
    for (format, precision) in cases() {
        for provenance in [false, true] {
            let length = |count| {
                head(format, precision, count, provenance)
                    .expect("few")
                    .len()
            };
            for count in [9, 10, 3_000_000_000, u64::from(u32::MAX)] {
                assert_eq!(length(count), length(1), "{format}");
            }
            let more = head(format, precision, u64::from(u32::MAX) + 1, provenance);
            assert_eq!(more.is_err(), format == Format::UtkBinary);
        }
    }
}
