//! Files on a disk: reads them up to a limit, finds the pattern of a session, and opens the system's dialog.
//! Native only.

use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use tilescope_debugger::{MAX_BYTES, PatternFile};
use tilescope_session::incoming::disk::{plain_file, read_limited};
use tilescope_session::incoming::{Unread, begins_as_object, holds_document, pick};
use tilescope_session::jobs::{Job, Monitor, Wake};
use tilescope_session::limits::MAX_PATTERN_BYTES;
use tilescope_session::recipe::{OwnPattern, load};

use super::{FileForm, Incoming, NamedBytes, Purpose, SESSION_NAME};

fn sentence(unread: Unread) -> String {
    match unread {
        Unread::Stopped => "cancelled: the file was not read".to_owned(),
        Unread::Failed(why) => why,
    }
}

/// Returns the first bytes of a file: enough to see whether it begins as an object of JSON. 64 were chosen, not
/// measured.
fn head(path: &Path) -> Result<Vec<u8>, String> {
    plain_file(path, u64::MAX)?;
    let mut bytes = Vec::new();
    let read = File::open(path).and_then(|file| file.take(64).read_to_end(&mut bytes));
    read.map(|_| bytes).map_err(|error| error.to_string())
}

/// Reads the one of several files that is to be opened. Also returns the names of the others that are not used with it.
pub(super) fn gather_paths(
    paths: &[PathBuf],
    purpose: Option<Purpose>,
    monitor: &Monitor,
) -> Result<(Incoming, Vec<String>), String> {
    let texts: Vec<_> = paths.iter().map(|path| path.to_string_lossy()).collect();
    let names: Vec<&str> = texts.iter().map(|text| &**text).collect();
    // The first bytes tell most point sets from documents. Only a file that may be a document is read whole to decide.
    // A file that cannot be read counts as no document here, and the reading below says why.
    let holds = |k: usize| {
        let may_be = begins_as_object(&head(&paths[k]).unwrap_or_default());
        may_be
            && read_limited(&paths[k], MAX_BYTES as u64, monitor)
                .is_ok_and(|bytes| holds_document(&bytes) == Some(true))
    };

    let (opened, left) = pick(&names, holds).ok_or("there is no file")?;
    // A longer document would be refused anyway. Dropped files and those for any other purpose may be point sets, which may be
    // longer.
    let limit = match purpose {
        Some(Purpose::Open | Purpose::Combination) => MAX_BYTES as u64,
        _ => MAX_PATTERN_BYTES,
    };

    let read = Incoming::from_path(&paths[opened], limit, monitor);
    let mut incoming = read.map_err(sentence)?;
    add_images(&mut incoming, paths, monitor)?;
    // A session finds its pattern on the disk by the path that it names, so that a file that it names counts as used.
    let others = left.into_iter().map(|k| names[k].to_owned()).collect();
    let unused = incoming.without_named(others);
    Ok((incoming, unused))
}

/// Puts the images that a set's certificate names beside it: those among `paths`, otherwise those in the set's folder. One that
/// is in neither is missing when the set is made, and the error there names it.
fn add_images(incoming: &mut Incoming, paths: &[PathBuf], monitor: &Monitor) -> Result<(), String> {
    for name in incoming.named_images() {
        let is_named = |path: &&PathBuf| path.file_name().is_some_and(|own| *own == *name);
        let given = paths.iter().find(is_named).cloned();
        let in_folder = || {
            let path = incoming.folder.as_ref()?.join(&name);
            path.is_file().then_some(path)
        };
        let Some(path) = given.or_else(in_folder) else {
            continue;
        };
        let bytes = read_limited(&path, MAX_PATTERN_BYTES, monitor).map_err(sentence)?;
        incoming.beside.push(NamedBytes::new(name, bytes));
    }
    Ok(())
}

/// Reads a session's pattern from the folder of the session's file, otherwise from its saved path.
pub(super) fn find_pattern(
    file: &PatternFile,
    folder: &Path,
    monitor: &Monitor,
) -> Result<OwnPattern, String> {
    let path = Path::new(&file.path);
    let beside = path.file_name().map(|name| folder.join(name));

    // The saved path itself is read below.
    if let Some(beside) = beside.filter(|beside| beside != path && beside.is_file()) {
        // A file of the same name may be a different one.
        let found = read_pattern(&beside, monitor);
        let is_it = |found: &OwnPattern| found.file.digest == file.digest;
        if found.as_ref().is_ok_and(is_it) {
            return found;
        }
    }

    // A session file must not make the program contact another machine.
    if file.path.starts_with(r"\\") || file.path.starts_with("//") {
        return Err("it lies on another machine; put it beside the session".to_owned());
    }

    // Whether this is the pattern of the session is checked by its digest when the run is recorded.
    read_pattern(path, monitor)
}

fn read_pattern(path: &Path, monitor: &Monitor) -> Result<OwnPattern, String> {
    let read = Incoming::from_path(path, MAX_PATTERN_BYTES, monitor);
    load(&read.map_err(sentence)?)
}

/// Opens the system's dialog; the job ends with the chosen file, or `None`.
#[must_use]
pub fn browse(form: &FileForm, wake: &Wake) -> Job<Option<PathBuf>> {
    let path = Path::new(form.path.trim());
    let mut dialog = rfd::AsyncFileDialog::new().set_title(form.purpose.title());
    if let Some(folder) = path.parent().filter(|folder| folder.is_dir()) {
        dialog = dialog.set_directory(folder);
    }

    match form.purpose {
        Purpose::Save => dialog = dialog.add_filter("Sessions", &["json"]),
        Purpose::Open => dialog = dialog.add_filter("Sessions and lessons", &["json", "md"]),
        Purpose::Combination => dialog = dialog.add_filter("Layouts", &["json"]),
        // A point set may have any extension.
        Purpose::Pattern | Purpose::Against => {}
    }

    if form.purpose == Purpose::Save {
        let typed = path.file_name();
        let name = typed.map_or(SESSION_NAME.into(), |name| name.to_string_lossy());
        return answered(wake, dialog.set_file_name(name).save_file());
    }
    answered(wake, dialog.pick_file())
}

/// Waits for the file that is chosen in a dialog. The dialog must be opened on the window's thread, and the wait must be on
/// another.
pub(crate) fn answered(
    wake: &Wake,
    answer: impl Future<Output = Option<rfd::FileHandle>> + Send + 'static,
) -> Job<Option<PathBuf>> {
    Job::start(wake, move |_| {
        pollster::block_on(answer).map(|file| file.path().to_owned())
    })
}
