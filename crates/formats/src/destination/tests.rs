//! Where outputs go, and what stands on the disk after a failure or an end at every operation.

use std::cell::Cell;
use std::io;
use std::ops::ControlFlow;
use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

#[cfg(unix)]
use std::os::unix::fs::symlink;

use tempfile::TempDir;
use tilescope_analysis::{Boundary, Progress, Region};

use super::*;
use crate::check::Overrides;
use crate::export::ExportContext;
use crate::files::{check, export, export_unverified, write_whole};
use crate::point_set::PointSet;
use crate::stream::{StreamExport, StreamOptions};

const GO: fn(Progress) -> ControlFlow<()> = |_| ControlFlow::Continue(());

/// The number of the operation before which this process ends, if it is a child of a test.
const END_AT: &str = "TILESCOPE_TEST_END_AT";
/// Which of [`WRITERS`] the child runs.
const WRITER: &str = "TILESCOPE_TEST_WRITER";
/// The folder in which it runs.
const FOLDER: &str = "TILESCOPE_TEST_FOLDER";

/// How the child ends: at once, without removing anything, as a killed process does.
const ENDED: i32 = 9;

thread_local! {
    /// How many operations follow before one fails.
    static FAIL_AFTER: Cell<Option<u32>> = const { Cell::new(None) };
}

/// Fails, or ends the process, if this operation is the one that a test chose.
pub(super) fn before_step() -> io::Result<()> {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    if let Some(chosen) = std::env::var(END_AT)
        .ok()
        .and_then(|at| at.parse::<u32>().ok())
        && COUNT.fetch_add(1, Ordering::Relaxed) == chosen
    {
        std::process::exit(ENDED);
    }
    match FAIL_AFTER.get() {
        Some(0) => {
            FAIL_AFTER.set(None);
            Err(io::Error::other("a test lets this fail"))
        }
        left => {
            FAIL_AFTER.set(left.map(|left| left - 1));
            Ok(())
        }
    }
}

fn context() -> ExportContext {
    let region = Region {
        width: 4.0,
        height: 4.0,
        boundary: Boundary::Periodic,
    };
    ExportContext::new(region, 0.9)
}

/// A lattice of spacing 1, moved to the right.
fn lattice(right: f64) -> PointSet {
    let point = |i: u32| [f64::from(i % 4) + right, f64::from(i / 4)];
    PointSet::from_points((0..16).map(point).collect())
}

/// A way to write a file; it returns whether it succeeded.
type Write = fn(&Path) -> bool;

/// Ways to write over a certified set.
const WRITERS: [(&str, Write); 5] = [
    ("export", |path| {
        export(path, &lattice(0.5), &context(), &GO).is_ok()
    }),
    ("without a verdict", |path| {
        export_unverified(path, &lattice(0.5), &context()).is_ok()
    }),
    ("something else", |path| {
        write_whole(path, b"x,y\n3,3\n").is_ok()
    }),
    ("a stream", |path| streamed(path, true)),
    ("a stream without a verdict", |path| streamed(path, false)),
];

fn streamed(path: &Path, verify: bool) -> bool {
    let options = StreamOptions {
        verify,
        resumable: true,
    };
    let Ok(mut export) = StreamExport::create(path, &context(), options) else {
        return false;
    };
    let (set, half) = (lattice(0.5), 8);
    export.push(&set.points[..half], None, &GO).is_ok()
        && export
            .checkpoint(&serde_json::json!({ "next": half }))
            .is_ok()
        && export.push(&set.points[half..], None, &GO).is_ok()
        && export.finish(&GO).is_ok()
}

/// A folder with a certified set, and the set's path.
fn certified() -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("set.csv");
    export(&path, &lattice(0.0), &context(), &GO).expect("valid");
    (folder, path)
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let name = |entry: io::Result<fs::DirEntry>| entry.expect("an entry").file_name();
    let mut names: Vec<String> = entries
        .map(|entry| name(entry).to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

/// Fails unless the file is as before or whole and new, and its certificate its own or missing. Returns whether the file
/// is as before, and whether there is a certificate.
fn state(path: &Path, before: &[u8], what: &str) -> (bool, bool) {
    let found = fs::read(path).expect("never missing");
    let radius = Some(0.9);
    let overrides = Overrides {
        radius,
        region: Some(context().region),
        ..Overrides::default()
    };
    let (_, checked) = check(path, &overrides, &GO).expect("whole");
    assert!(checked.differences.is_empty(), "{what}: {checked:?}");
    (found == before, checked.certificate.is_some())
}

#[test]
fn a_failure_at_any_operation_leaves_the_old_set_or_the_new_one() {
    for (name, write) in WRITERS {
        let mut fails = 0;
        loop {
            let (folder, path) = certified();
            let before = fs::read(&path).expect("there");
            FAIL_AFTER.set(Some(fails));
            let succeeded = write(&path);
            let was_used = FAIL_AFTER.take().is_none();

            let what = format!("{name}, failure {fails}");
            let (is_old, has_certificate) = state(&path, &before, &what);
            assert!(
                !is_old || has_certificate,
                "{what}: the certificate is lost"
            );
            assert!(!is_old || !succeeded, "{what}: nothing was written");
            let own = names(folder.path());
            let left: Vec<&String> = own
                .iter()
                .filter(|name| !["set.csv", "set.csv.certificate.json"].contains(&name.as_str()))
                // What a failed stream can be resumed from.
                .filter(|name| !name.contains(".resume.") && !name.ends_with(".partial"))
                .collect();
            assert!(left.is_empty(), "{what}: {left:?}");
            if !was_used {
                assert!(succeeded && !is_old, "{what}");
                break;
            }
            fails += 1;
        }
        assert!(fails >= 5, "{name} has {fails} operations");
    }
}

/// Each child is this test once more, which ends before the chosen operation.
#[test]
fn a_process_that_ends_at_any_operation_leaves_no_false_certificate() {
    if let Ok(writer) = std::env::var(WRITER) {
        let folder = std::env::var_os(FOLDER).expect("given");
        let (_, write) = (WRITERS.into_iter())
            .find(|(name, _)| *name == writer)
            .expect("a writer");
        assert!(write(&Path::new(&folder).join("set.csv")));
        return;
    }
    for (name, _) in WRITERS {
        let mut ends = 0;
        loop {
            let (folder, path) = certified();
            let before = fs::read(&path).expect("there");
            let test = "destination::tests::a_process_that_ends_at_any_operation_leaves_no_false_certificate";
            let mut child = Command::new(std::env::current_exe().expect("this test"));
            child.args(["--exact", test]);
            child.envs([(WRITER, name), (END_AT, &ends.to_string())]);
            let ran = child.env(FOLDER, folder.path()).output().expect("runs");

            let what = format!("{name}, ended before operation {ends}");
            let (is_old, _) = state(&path, &before, &what);
            if ran.status.success() {
                assert!(!is_old, "{what}");
                break;
            }
            let said = String::from_utf8_lossy(&ran.stdout);
            assert_eq!(ran.status.code(), Some(ENDED), "{what}: {said}");

            // The next writer finds nothing in its way and leaves nothing behind, of the process before it either.
            export(&path, &lattice(0.25), &context(), &GO).expect("valid");
            assert_eq!(state(&path, &before, &what), (false, true));
            let mut own = names(folder.path());
            own.retain(|name| !name.contains(".resume.") && !name.ends_with(".partial"));
            assert_eq!(own, ["set.csv", "set.csv.certificate.json"], "{what}");
            ends += 1;
        }
        assert!(ends >= 5, "{name} has {ends} operations");
    }
}

#[test]
fn an_interrupted_exchange_is_undone_or_ended_by_what_the_digests_say() {
    // The certificate is aside, and the file is the old one.
    let (folder, path) = certified();
    let own = certificate_path(&path);
    fs::rename(&own, folder.path().join(".set.csv.certificate.json.old~")).expect("writable");
    fs::write(folder.path().join(".set.csv.new~"), "half").expect("writable");
    let place = Place::of(&path).expect("a file");
    drop(place.lock(Duration::ZERO).expect("free"));
    assert_eq!(
        names(folder.path()),
        ["set.csv", "set.csv.certificate.json"]
    );

    // The file is the new one, and its certificate was still to be named.
    let (folder, path) = certified();
    let old = fs::read(certificate_path(&path)).expect("there");
    export(&path, &lattice(0.5), &context(), &GO).expect("valid");
    let at = |name: &str| folder.path().join(name);
    fs::rename(
        certificate_path(&path),
        at(".set.csv.certificate.json.new~"),
    )
    .expect("writable");
    fs::write(at(".set.csv.certificate.json.old~"), old).expect("writable");
    let place = Place::of(&path).expect("a file");
    drop(place.lock(Duration::ZERO).expect("free"));
    assert_eq!(
        names(folder.path()),
        ["set.csv", "set.csv.certificate.json"]
    );
    assert_eq!(state(&path, b"", "ended"), (false, true));
}

#[test]
fn writers_of_one_name_leave_a_set_with_its_own_certificate() {
    let (folder, path) = certified();
    for _ in 0..20 {
        std::thread::scope(|scope| {
            for right in [0.125, 0.25, 0.375, 0.5] {
                let path = &path;
                scope.spawn(move || {
                    export(path, &lattice(right), &context(), &GO).expect("each in its turn");
                });
            }
        });
        assert_eq!(state(&path, b"", "after four writers"), (false, true));
        assert_eq!(names(folder.path()).len(), 2);
    }
}

#[test]
fn a_writer_that_holds_the_name_is_named_and_not_disturbed() {
    let (_folder, path) = certified();
    let before = fs::read(&path).expect("there");
    let place = Place::of(&path).expect("a file");
    let lock = place.lock(Duration::ZERO).expect("free");
    let busy = place.lock(Duration::ZERO).expect_err("taken");
    assert!(
        busy.to_string()
            .contains("this or another process is writing it")
    );
    drop(lock);
    assert_eq!(state(&path, &before, "as before"), (true, true));
    assert!(place.lock(Duration::ZERO).is_ok());
}

#[test]
fn a_lock_file_with_content_is_somebody_else_s() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("set.csv.lock");
    fs::write(&file, "mine").expect("writable");
    write_whole(&folder.path().join("set.csv"), b"x,y\n").expect("writable");
    assert_eq!(fs::read(&file).expect("still there"), b"mine");
}

#[cfg(unix)]
#[test]
fn a_link_at_a_name_of_our_own_is_not_followed() {
    let (folder, path) = certified();
    let at = |name: &str| folder.path().join(name);
    fs::write(at("diary"), "mine").expect("writable");
    for (_, write) in WRITERS {
        for name in [
            ".set.csv.new~",
            ".set.csv.old~",
            ".set.csv.certificate.json.new~",
            ".set.csv.certificate.json.old~",
            "set.csv.partial",
            "set.csv.lock",
            "set.csv.resume.tmp",
            "set.csv.resume.0.state",
        ] {
            symlink("diary", at(name)).expect("a link");
            let _ = write(&path);
            assert_eq!(fs::read(at("diary")).expect("there"), b"mine", "{name}");
            // Some are refused and left where they are.
            let _ = fs::remove_file(at(name));
        }
    }
}

#[cfg(unix)]
#[test]
fn a_replaced_file_keeps_its_mode() {
    use std::os::unix::fs::PermissionsExt;

    for (name, write) in WRITERS {
        let (_folder, path) = certified();
        let mode = |path: &Path| fs::metadata(path).expect("there").permissions().mode() & 0o777;
        for (path, mode) in [(path.clone(), 0o600), (certificate_path(&path), 0o640)] {
            fs::set_permissions(path, fs::Permissions::from_mode(mode)).expect("allowed");
        }
        assert!(write(&path));
        assert_eq!(mode(&path), 0o600, "{name}");
        if certificate_path(&path).exists() {
            assert_eq!(mode(&certificate_path(&path)), 0o640, "{name}");
        }
    }
}

#[cfg(unix)]
#[test]
fn data_and_certificate_both_lie_where_a_link_leads() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("data")).expect("writable");
    export(&at("data/set.csv"), &lattice(0.0), &context(), &GO).expect("valid");
    symlink("data/set.csv", at("near.csv")).expect("a link");
    for (name, write) in WRITERS {
        // As programs before this one wrote it.
        fs::write(at("near.csv.certificate.json"), "{}").expect("writable");
        assert!(write(&at("near.csv")), "{name}");
        assert!(at("near.csv").is_symlink(), "{name}");
        assert!(!at("near.csv.certificate.json").exists(), "{name}");
        let far = state(&at("data/set.csv"), b"", name);
        assert_eq!(state(&at("near.csv"), b"", name), far, "{name}");
    }
    // A set that is kept elsewhere, with a link to its certificate, is read by both links.
    export(&at("data/set.csv"), &lattice(0.0), &context(), &GO).expect("valid");
    fs::rename(at("data/set.csv.certificate.json"), at("data/statement")).expect("writable");
    symlink("data/statement", at("near.csv.certificate.json")).expect("a link");
    assert_eq!(state(&at("near.csv"), b"", "two links"), (false, true));
}

#[cfg(unix)]
#[test]
fn links_lead_to_what_is_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    fs::create_dir(at("data")).expect("a folder");
    symlink("data/far", at("near")).expect("a link");
    symlink("set.csv", at("data/far")).expect("a link");
    let found = destination(&at("near")).expect("a place for a new file");
    assert_eq!(found, at("data/set.csv"));
    fs::write(at("data/set.csv"), "old").expect("written");
    assert_eq!(destination(&at("near")).expect("a file"), found);
    assert_eq!(destination(&at("new")).expect("a new file"), at("new"));
    symlink("round", at("round")).expect("a link");
    let error = destination(&at("round")).expect_err("no end");
    assert!(error.to_string().contains("40 links"), "{error}");
}

#[cfg(unix)]
#[test]
fn whatever_is_no_file_is_refused_by_its_kind() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    let _socket = std::os::unix::net::UnixListener::bind(at("socket")).expect("a socket");
    symlink("/dev/null", at("link")).expect("a link");
    symlink("/dev/fd/0", at("input")).expect("a link");
    for (path, kind) in [
        (folder.path().to_owned(), "a folder"),
        (at("socket"), "a socket"),
        (at("link"), "a device"),
        ("/dev/null".into(), "a device"),
        ("/dev/stdout".into(), "a stream of a process"),
        (at("input"), "a stream of a process"),
    ] {
        let error = destination(&path).expect_err("no file").to_string();
        assert!(error.contains(kind), "{error}");
    }
    assert!(check_own(&at("link")).is_err());
    assert!(check_own(&at("new")).is_ok());
}
