//! What is on disk after an export, a failed export and a check.

use std::collections::BTreeSet;
use std::ops::ControlFlow;

use tilescope_analysis::{Boundary, Progress, Region};

use super::*;
use crate::format::Format;
use crate::read::certificate_path;

const GO: fn(Progress) -> ControlFlow<()> = |_| ControlFlow::Continue(());

fn context() -> ExportContext {
    let region = Region {
        width: 4.0,
        height: 4.0,
        boundary: Boundary::Periodic,
    };
    ExportContext::new(region, 1.0)
}

fn lattice() -> PointSet {
    let point = |i: u32| [f64::from(i % 4), f64::from(i / 4)];
    PointSet::from_points((0..16).map(point).collect())
}

fn names(folder: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    entries
        .map(|e| {
            e.expect("an entry")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .collect()
}

#[test]
fn an_export_is_two_files_which_check() {
    let folder = tempfile::tempdir().expect("a folder");
    for format in Format::ALL {
        let path = folder
            .path()
            .join(format!("{}.{}", format.name(), format.extension()));
        let mut context = context();
        context.format = Some(format);
        let exported = export(&path, &lattice(), &context, &GO).expect("valid");
        assert_eq!(exported.certificate_path, certificate_path(&path));
        let (_, check) = check(&path, &Overrides::default(), &GO).expect("a verdict");
        assert!(check.passed(), "{format}: {:?}", check.differences);
        let read = read(&path, &Hint::default()).expect("own file");
        assert_eq!(read.set, lattice(), "{format}: domain units again");
        assert_eq!(read.detection.format, format);
        assert_eq!(read.certificate, Some(exported.certificate));
    }
    assert_eq!(names(folder.path()).len(), 2 * Format::ALL.len());
}

#[test]
fn a_failed_export_leaves_everything_as_it_was() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("set.csv");
    export(&path, &lattice(), &context(), &GO).expect("valid");
    let before = fs::read(&path).expect("there");
    let listed = names(folder.path());
    let stop = |_| ControlFlow::Break(());
    assert!(export(&path, &lattice(), &context(), &stop).is_err());
    let mut outside = lattice();
    outside.points[3] = [4.0, 4.0];
    assert!(export(&path, &outside, &context(), &GO).is_err());
    assert_eq!(fs::read(&path).expect("still there"), before);
    assert_eq!(names(folder.path()), listed);
}

#[test]
fn a_certificate_that_cannot_be_placed_is_refused_at_the_start() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, old) in [("set.csv", Some("x,y\n0,0\n")), ("new.csv", None)] {
        let path = folder.path().join(name);
        if let Some(old) = old {
            fs::write(&path, old).expect("writable");
        }
        fs::create_dir(certificate_path(&path)).expect("writable");
        let error = export(&path, &lattice(), &context(), &GO).expect_err("a folder");
        assert!(error.to_string().contains("a folder"), "{error}");
        assert_eq!(fs::read_to_string(&path).ok().as_deref(), old);
    }
    assert_eq!(names(folder.path()).len(), 3);
}

#[cfg(unix)]
#[test]
fn links_stay_and_what_they_lead_to_is_written() {
    use std::os::unix::fs::symlink;

    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("data")).expect("writable");
    fs::write(at("data/old.csv"), "old").expect("writable");
    symlink("data/old.csv", at("set.csv")).expect("writable");
    let exported = export(&at("set.csv"), &lattice(), &context(), &GO).expect("valid");
    assert_eq!(exported.path, at("set.csv"));
    assert!(at("set.csv").is_symlink());
    let (_, checked) = check(&at("set.csv"), &Overrides::default(), &GO).expect("a verdict");
    assert!(checked.passed() && checked.certificate.is_some());
    let both = ["old.csv", "old.csv.certificate.json"].map(str::to_owned);
    assert_eq!(names(&at("data")), BTreeSet::from(both));
    assert_eq!(
        exported.certificate_path,
        at("data/old.csv.certificate.json")
    );
    symlink("data/new.txt", at("text")).expect("writable");
    write_whole(&at("text"), b"whole").expect("writable");
    assert_eq!(fs::read(at("data/new.txt")).expect("there"), b"whole");
    write_through(&at("text"), |file| {
        file.write_all(b"through")
            .map_err(|e| io_error(&at("text"), e))
    })
    .expect("writable");
    assert_eq!(fs::read(at("data/new.txt")).expect("there"), b"through");
    assert!(at("text").is_symlink());
}

#[cfg(unix)]
#[test]
fn what_is_no_file_is_not_replaced() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("set.csv");
    let _socket = std::os::unix::net::UnixListener::bind(&path).expect("a socket");
    let written = export(&path, &lattice(), &context(), &GO);
    assert!(matches!(
        written,
        Err(ExportError::Format(FormatError::NotAFile { .. }))
    ));
    let written = write_whole(&path, b"whole");
    assert!(matches!(written, Err(FormatError::NotAFile { .. })));
    let written = write_through(&path, |_| Ok(()));
    assert!(matches!(written, Err(FormatError::NotAFile { .. })));
    assert_eq!(names(folder.path()).len(), 1);
}

#[test]
fn an_export_replaces_an_older_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("set.csv");
    let mut other = lattice();
    for point in &mut other.points {
        point[0] += 0.5;
    }
    export(&path, &other, &context(), &GO).expect("valid");
    export(&path, &lattice(), &context(), &GO).expect("valid");
    let (set, check) = check(&path, &Overrides::default(), &GO).expect("a verdict");
    assert!(check.passed());
    assert_eq!(set, lattice());
    assert_eq!(names(folder.path()).len(), 2);
}

#[test]
fn a_flipped_byte_on_disk_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("set.npy");
    export(&path, &lattice(), &context(), &GO).expect("valid");
    let mut bytes = fs::read(&path).expect("there");
    let end = bytes.len();
    bytes[end - 16] ^= 1;
    fs::write(&path, bytes).expect("writable");
    let (_, check) = check(&path, &Overrides::default(), &GO).expect("a verdict");
    let fields: Vec<_> = check.differences.iter().map(|d| d.field).collect();
    assert_eq!(fields[..2], ["digest", "positions_digest"]);
}

#[test]
fn missing_files_and_bad_certificates_are_errors_with_the_path() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("set.csv");
    let error = read(&path, &Hint::default()).expect_err("missing");
    assert!(error.to_string().contains("set.csv"), "{error}");
    fs::write(&path, "x,y\n0,0\n").expect("writable");
    fs::write(certificate_path(&path), "{}").expect("writable");
    let error = read(&path, &Hint::default()).expect_err("no certificate");
    assert!(
        error.to_string().contains("set.csv.certificate.json"),
        "{error}"
    );
    assert!(export("/".as_ref(), &lattice(), &context(), &GO).is_err());
    let nowhere = folder.path().join("no").join("set.csv");
    assert!(export(&nowhere, &lattice(), &context(), &GO).is_err());
}

#[test]
fn a_file_is_written_whole_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.svg");
    write_whole(&path, b"one").unwrap();
    write_whole(&path, b"two").unwrap();
    assert_eq!(std::fs::read(&path).unwrap(), b"two");
    let missing = folder.path().join("no such folder").join("picture.svg");
    assert!(matches!(
        write_whole(&missing, b"three"),
        Err(FormatError::Io { .. })
    ));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn what_is_written_through_is_whole_or_not_there() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("film.gif");
    let stopped: Result<(), FormatError> = write_through(&path, |file| {
        file.write_all(b"half").map_err(|e| io_error(&path, e))?;
        assert_eq!(
            names(folder.path()).len(),
            2,
            "under a temporary name, and a lock"
        );
        assert!(!path.exists());
        Err(io_error(&path, io::Error::other("stopped")))
    });
    assert!(stopped.is_err() && names(folder.path()).is_empty());
    let whole = |bytes: &'static [u8]| {
        write_through(&path, |file| {
            file.write_all(bytes).map_err(|e| io_error(&path, e))
        })
    };
    for bytes in [&b"first"[..], b"second"] {
        whole(bytes).expect("a folder to write in");
        assert_eq!(fs::read(&path).expect("there"), bytes);
    }
    assert_eq!(names(folder.path()).len(), 1);
    let nowhere = folder.path().join("missing").join("film.gif");
    let refused: Result<(), FormatError> = write_through(&nowhere, |_| Ok(()));
    assert!(
        refused
            .expect_err("no folder")
            .to_string()
            .contains("film.gif")
    );
}
