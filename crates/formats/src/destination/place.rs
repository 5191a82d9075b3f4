//! The place of an output and its certificate, which change together.
//!
//! The certificate of the old file goes aside first, then the new file gets its name, then the new certificate. So a
//! process may end anywhere: at any moment the file is the old or the new one, and its certificate is its own or
//! missing. The names of new and old files are fixed, and used only by the owner of the lock, who finds and removes what
//! an ended process left.

use std::ffi::OsString;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::{Lock, create_own, destination, step, sync_folder};
use crate::certificate::{Certificate, MAX_CERTIFICATE_BYTES};
use crate::digest::digest_text;
use crate::error::{FormatError, io_error};
use crate::read::certificate_path;

/// Where a file and its certificate are written, with links resolved.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    /// The path of the file that is written.
    pub file: PathBuf,
    /// The path of its certificate.
    pub certificate: PathBuf,
    /// The certificate that programs before this one wrote beside a link to the file, if the output is named by a link.
    beside_link: Option<PathBuf>,
}

impl Place {
    /// The place of an output called `path`.
    ///
    /// # Errors
    ///
    /// As [`destination`].
    pub fn of(path: &Path) -> Result<Self, FormatError> {
        let file = destination(path)?;
        let certificate = certificate_path(&file);
        let beside_link = Some(certificate_path(path)).filter(|other| *other != certificate);
        Ok(Self {
            // A certificate may be a link of its own, for instance into a store of data.
            certificate: destination(&certificate).unwrap_or(certificate),
            file,
            beside_link,
        })
    }

    /// Refuses a place whose certificate could not be written.
    pub fn takes_certificate(&self) -> Result<(), FormatError> {
        destination(&self.certificate).map(drop)
    }

    /// Locks the place, and removes what a process that ended there left behind.
    pub fn lock(&self, patience: Duration) -> Result<Lock, FormatError> {
        let lock = Lock::take(&self.file, patience)?;
        self.recover();
        Ok(lock)
    }

    /// The name of the new file until it is put in its place.
    pub fn new_file(&self) -> PathBuf {
        hidden(&self.file, "new")
    }

    /// Whether a certificate lies beside the file that states its digest.
    pub fn has_own_certificate(&self) -> bool {
        is_of(&self.certificate, &self.file)
    }

    /// Puts the certificate in its place if it is missing there and one of its temporary files states the file's
    /// digest. Then removes all temporary files of this place. Files that cannot be renamed or removed are left: the
    /// next writer tries again.
    fn recover(&self) {
        let left = [
            hidden(&self.certificate, "new"),
            hidden(&self.certificate, "old"),
        ];

        // A process that ended between two renames left the certificate under one of these names. The digest in it says
        // whether it is the certificate of the old file or of the new one.
        if !self.certificate.exists()
            && let Some(own) = left.iter().find(|left| is_of(left, &self.file))
        {
            let _ = fs::rename(own, &self.certificate);
        }

        // A certificate that an older program wrote beside a link is removed and not put back. The file is then without
        // a certificate, which is safe.
        let mut remains = left.to_vec();
        remains.extend([self.new_file(), hidden(&self.file, "old")]);
        remains.extend(self.beside_link.as_deref().map(|one| hidden(one, "old")));

        for name in remains {
            let _ = fs::remove_file(name);
        }
    }

    /// Puts the file `new` in its place, with a certificate of these bytes, or with none. The caller holds the lock.
    ///
    /// # Errors
    ///
    /// [`FormatError::Io`]; the old file and its certificate are then as they were, unless the new file could not be
    /// taken back, or all that failed is to make the renaming durable.
    pub fn put(&self, new: &Path, certificate: Option<&[u8]>) -> Result<(), FormatError> {
        // The new certificate is written first, under a temporary name.
        let stated_path = hidden(&self.certificate, "new");
        if let Some(bytes) = certificate {
            write_new(&stated_path, &self.certificate, bytes)?;
        }

        let mut aside = Vec::new();
        let stated = certificate.map(|_| &*stated_path);
        let placed = self.exchange(new, stated, &mut aside);
        // If the old file is in its place, the certificates that were moved aside come back, the last one first.
        // Otherwise they are removed, as they would be false about the new file. The error to be told is that of the
        // exchange, whatever else fails here.
        let is_old = placed.as_ref().is_err_and(|failure| failure.is_old);
        for (name, away) in aside.into_iter().rev() {
            let _ = if is_old {
                fs::rename(away, name)
            } else {
                fs::remove_file(away)
            };
        }

        if let Some(stated) = stated.filter(|_| placed.is_err()) {
            let _ = fs::remove_file(stated);
        }
        placed.map_err(|failure| failure.error)?;
        // Until the folder is synchronised, a power cut could undo the renaming.
        sync_folder(&self.file).map_err(|e| io_error(&self.file, e))
    }

    /// Renames the files. `aside` gets the names of those that were moved away, and where they are.
    fn exchange(
        &self,
        new: &Path,
        stated: Option<&Path>,
        aside: &mut Vec<(PathBuf, PathBuf)>,
    ) -> Result<(), Failure> {
        let failed = |path: &Path, is_old| {
            let path = path.to_owned();
            move |error| Failure {
                error: io_error(&path, error),
                is_old,
            }
        };

        // Until the new file is renamed, the old one is in its place.
        let is_old = true;
        for old in [Some(&self.certificate), self.beside_link.as_ref()] {
            // Only a file can be a certificate: a folder or a device of this name stays, and so does anything that cannot be
            // looked up.
            let Some(old) = old.filter(|old| old.is_file()) else {
                continue;
            };
            let away = hidden(old, "old");
            step(|| fs::rename(old, &away)).map_err(failed(old, is_old))?;
            aside.push((old.clone(), away));
        }

        if !aside.is_empty() {
            // Without this a power cut could lose the renaming above but keep the one below: the new file would then have the
            // old certificate.
            sync_folder(&self.certificate).map_err(failed(&self.certificate, is_old))?;
        }

        // If the new certificate cannot be renamed, the new file is taken back: the old one keeps a second name for that, except
        // on file systems without hard links. Without a certificate nothing can fail after the file.
        let old = hidden(&self.file, "old");
        let existed = self.file.exists();
        let kept = existed && stated.is_some() && step(|| fs::hard_link(&self.file, &old)).is_ok();

        let outcome = self.rename_both(new, stated).map_err(|(error, path)| {
            // All is as before if the new file never took its place, if the old one came back by its second name, or if
            // there was no old one and the new one is gone.
            let undone = match path {
                path if path == self.file => true,
                _ if kept => fs::rename(&old, &self.file).is_ok(),
                _ => !existed && fs::remove_file(&self.file).is_ok(),
            };
            failed(path, undone)(error)
        });

        if kept {
            let _ = fs::remove_file(&old);
        }
        outcome
    }

    /// Gives both new files their names; an error is of the name that was not given.
    fn rename_both(
        &self,
        new: &Path,
        stated: Option<&Path>,
    ) -> Result<(), (std::io::Error, &Path)> {
        let named = |name| move |error| (error, name);
        // In this order a file lacks its certificate for a moment, rather than having one of other points.
        step(|| fs::rename(new, &self.file)).map_err(named(&*self.file))?;

        let Some(stated) = stated else {
            return Ok(());
        };
        step(|| fs::rename(stated, &self.certificate)).map_err(named(&*self.certificate))
    }
}

/// Why an exchange failed.
struct Failure {
    error: FormatError,
    /// Whether the old file is in its place.
    is_old: bool,
}

/// Writes a new file of this program's own through to the device. It will replace `like`.
pub(crate) fn write_new(path: &Path, like: &Path, bytes: &[u8]) -> Result<(), FormatError> {
    let written = create_own(path, like).and_then(|mut file| {
        step(|| std::io::Write::write_all(&mut file, bytes))?;
        step(|| file.sync_all())
    });
    written.map_err(|error| {
        let _ = fs::remove_file(path);
        io_error(like, error)
    })
}

/// A name for the new or the old content of a file, which lists of files do not show.
fn hidden(file: &Path, kind: &str) -> PathBuf {
    let mut name = OsString::from(".");
    name.push(file.file_name().unwrap_or_default());
    name.push(format!(".{kind}~"));
    file.with_file_name(name)
}

/// Whether the file `left` is a certificate that states the digest of `file`.
fn is_of(left: &Path, file: &Path) -> bool {
    let length = fs::symlink_metadata(left).map_or(0, |about| about.len());
    // A certificate of no length is none, and a longer one is not read.
    if !(1..=MAX_CERTIFICATE_BYTES as u64).contains(&length) {
        return false;
    }
    let stated = fs::read(left)
        .ok()
        .and_then(|bytes| Certificate::from_bytes(&bytes, "").ok());
    let mut hasher = blake3::Hasher::new();
    let hashed = File::open(file).and_then(|file| hasher.update_reader(file).map(drop));
    hashed.is_ok() && stated.and_then(|stated| stated.digest) == Some(digest_text(&hasher))
}
