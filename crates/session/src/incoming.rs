//! Files as bytes: one to be opened, and the files that came with it. The same limits and rules about names
//! apply on a disk ([`disk`]) and in a browser.

#[cfg(not(target_arch = "wasm32"))]
pub mod disk;

use std::fmt;
use std::path::PathBuf;

use serde_json::Value;
use tilescope_core::json::{self, without_mark};
use tilescope_debugger::MAX_BYTES;
use tilescope_formats::{
    CERTIFICATE_SUFFIX, Certificate, CertificateUse, FormatError, Hint, ReadSet, read_bytes,
};

use crate::limits::MAX_PATTERN_BYTES;
use crate::words::last_part;

/// The most files that are read when several are opened together. Chosen, not measured.
pub const MAX_FILES: usize = 64;

/// The parameters of certificates that name an image by which a set was made.
pub const IMAGES: [&str; 3] = ["radius-image", "density-image", "mask"];

/// A file in memory.
#[derive(Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct NamedBytes {
    /// Its name; natively its path.
    pub name: String,
    /// Its content, byte for byte.
    #[serde(with = "crate::encoding::as_bytes")]
    pub bytes: Vec<u8>,
}

impl NamedBytes {
    /// Returns a file in memory.
    #[must_use]
    pub fn new(name: impl Into<String>, bytes: impl Into<Vec<u8>>) -> Self {
        let (name, bytes) = (name.into(), bytes.into());
        Self { name, bytes }
    }
}

impl fmt::Debug for NamedBytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({} bytes)", self.name, self.bytes.len())
    }
}

/// Why a file was not read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Unread {
    /// The work was cancelled.
    #[cfg_attr(
        target_arch = "wasm32",
        allow(dead_code, reason = "what is in memory is not read in parts")
    )]
    Stopped,
    /// It failed; the reason in words.
    Failed(String),
}

impl<E: std::fmt::Display> From<E> for Unread {
    fn from(error: E) -> Self {
        Self::Failed(error.to_string())
    }
}

/// A file to be opened, with the files that came with it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Incoming {
    /// Its name as messages show it; natively its path.
    pub name: String,
    /// Its content, byte for byte.
    pub bytes: Vec<u8>,
    /// Files that came with it: its certificate, and the files that it names.
    pub beside: Vec<NamedBytes>,
    /// The folder in which files that it names are looked for, too; `None` in a browser.
    pub folder: Option<PathBuf>,
}

impl Incoming {
    /// Returns a file that came alone.
    #[must_use]
    pub fn new(file: NamedBytes) -> Self {
        Self {
            name: file.name,
            bytes: file.bytes,
            beside: Vec::new(),
            folder: None,
        }
    }

    /// Fails if it is longer than `limit` bytes.
    pub fn within(&self, limit: u64) -> Result<(), String> {
        too_long(&self.name, self.bytes.len() as u64, limit).map_or(Ok(()), Err)
    }

    /// Returns its text, without a byte-order mark; fails if it is not text or is longer than a session may be.
    pub fn text(&self) -> Result<&str, String> {
        self.within(MAX_BYTES as u64)?;
        let text = std::str::from_utf8(without_mark(&self.bytes));
        text.map_err(|_| {
            let name = &self.name;
            format!("{name}: this is not a saved session: it is not text")
        })
    }

    /// Returns the certificate that came with it.
    #[must_use]
    pub fn certificate(&self) -> Option<&NamedBytes> {
        let of_this = |other: &&NamedBytes| is_certificate_of(&other.name, &self.name);
        self.beside.iter().find(of_this)
    }

    /// Returns the point set in it, in domain units, if its certificate states a field or a shape; `None` for other
    /// files. A file that cannot be read gives `None`, too: it is read as another kind after that, and the error of that
    /// reading says why.
    #[must_use]
    pub fn varying_set(&self) -> Option<ReadSet> {
        self.within(MAX_PATTERN_BYTES).ok()?;
        let file = self.certificate()?;
        // A certificate of version 1 states one radius in a rectangle, so that its set need not be read here.
        let stated: Value = serde_json::from_slice(&file.bytes).ok()?;
        if stated["version"] == 1 {
            return None;
        }

        let hint = Hint {
            certificate: CertificateUse::Checked,
            varying: true,
            ..Hint::from_name(last_part(&self.name))
        };
        let certificate = Some((file.name.as_str(), file.bytes.as_slice()));
        let read = read_bytes(&self.bytes, &hint, certificate).ok()?;
        let states_ground = |read: &ReadSet| {
            read.certificate
                .as_ref()
                .is_some_and(Certificate::is_varying)
        };
        Some(read).filter(states_ground)
    }

    /// Returns the point set in it, in domain units if it has a certificate. A certificate that is false or unreadable is
    /// left out, and [`ReadSet::refused`] says why. Errors begin with the file's name.
    pub fn point_set(&self) -> Result<ReadSet, String> {
        self.within(MAX_PATTERN_BYTES)?;
        let name = last_part(&self.name);

        let beside = self.certificate();
        let certificate = beside.map(|file| (file.name.as_str(), file.bytes.as_slice()));

        let read_as = |used| {
            let hint = Hint {
                certificate: used,
                ..Hint::from_name(name)
            };
            read_bytes(&self.bytes, &hint, certificate)
        };

        let read = match read_as(CertificateUse::Checked) {
            Err(why @ (FormatError::FalseCertificate { .. } | FormatError::Certificate { .. })) => {
                // A set with a false certificate is still a set. It is read again without the claims of the certificate.
                read_as(CertificateUse::LeftOut).map(|read| ReadSet {
                    refused: Some(why.to_string()),
                    ..read
                })
            }
            outcome => outcome,
        };

        read.map_err(|error| {
            // If the file is a session or a layout, that says more than the error of a format.
            if holds_document(&self.bytes) == Some(true) {
                return format!(
                    "{} is a saved session or a layout, not a point set",
                    self.name
                );
            }

            let text = error.to_string();
            // Some errors of formats name the file already.
            if text.contains(name) {
                text
            } else {
                format!("{}: {text}", self.name)
            }
        })
    }

    /// Returns a file that it names, with that file's certificate, if they came with it. Only the last part of the path
    /// is compared, since files that came together have no folders.
    #[must_use]
    pub fn companion(&self, named: &str) -> Option<Self> {
        let last = last_part(named);
        let is_it = |file: &&NamedBytes| last_part(&file.name) == last;
        let file = self.beside.iter().find(is_it)?;
        let mut found = Self::new(file.clone());
        let certificate = |other: &&NamedBytes| is_certificate_of(&other.name, last);
        found.beside = self.beside.iter().filter(certificate).cloned().collect();
        Some(found)
    }

    /// Returns the files among `others` that it does not use: for a session, a layout or a set with a certificate those that
    /// it or its certificate does not name, otherwise all.
    #[must_use]
    pub fn without_named(&self, mut others: Vec<String>) -> Vec<String> {
        if others.is_empty() {
            return others;
        }
        let naming = if self.is_document() {
            Some(&self.bytes)
        } else {
            self.certificate().map(|file| &file.bytes)
        };
        if let Some(bytes) = naming {
            // A document that is broken names no files.
            let text = std::str::from_utf8(bytes).unwrap_or_default();
            others.retain(|name| !text.contains(last_part(name)));
        }
        others
    }

    /// Returns the names of the images that its certificate states as its field and its mask, without folders.
    #[must_use]
    pub fn named_images(&self) -> Vec<String> {
        let certificate = self.certificate();
        let stated: Option<Value> =
            certificate.and_then(|file| serde_json::from_slice(&file.bytes).ok());
        let parameters = stated.map(|stated| stated["parameters"].clone());
        let file = |image: &str| {
            let name = parameters.as_ref()?[image]["file"].as_str()?;
            Some(last_part(name).to_owned())
        };
        IMAGES.into_iter().filter_map(file).collect()
    }

    /// Returns whether it is an archive of files.
    #[must_use]
    pub fn is_archive(&self) -> bool {
        // The name may be any: the bytes are those with which an entry of a ZIP file begins.
        ends_with(&self.name, "zip") || self.bytes.starts_with(b"PK\x03\x04")
    }

    /// Returns whether it is a session, a layout or other JSON that cannot be a point set. The content decides; the
    /// name counts only if the content is broken.
    #[must_use]
    pub fn is_document(&self) -> bool {
        self.bytes.len() <= MAX_BYTES
            && holds_document(&self.bytes).unwrap_or_else(|| ends_with(&self.name, "json"))
    }
}

/// Returns why a file of this length is not read, or `None` if it is.
pub fn too_long(name: &str, length: u64, limit: u64) -> Option<String> {
    let [has, most] = [length, limit].map(tilescope_debugger::grouped);
    (length > limit).then(|| format!("{name} has {has} bytes; at most {most} are read"))
}

/// Returns why each of several files, given by name and length, is not read, or `None` if it is. One file may be as
/// long as a point set, all together twice as long; the factor is chosen, not measured.
#[must_use]
pub fn refusals(files: &[(&str, u64)]) -> Vec<Option<String>> {
    let mut left = 2 * MAX_PATTERN_BYTES;
    let refusal = |(k, &(name, length)): (usize, &(&str, u64))| {
        let why = too_long(name, length, MAX_PATTERN_BYTES);
        if why.is_some() {
            return why;
        }

        if k >= MAX_FILES {
            return Some(format!(
                "{name} is one of more than {MAX_FILES} files, which are the most that are read at once"
            ));
        }

        if length > left {
            let most = tilescope_debugger::grouped(2 * MAX_PATTERN_BYTES);
            return Some(format!(
                "{name} and the files before it have more than {most} bytes, which are the most that are read at once"
            ));
        }

        // Only bytes that are read count here, so that a file that is too long does not shut out the rest. Its place
        // counts, since `pick` considers the first files, whatever their lengths.
        left -= length;
        None
    };
    files.iter().enumerate().map(refusal).collect()
}

fn ends_with(name: &str, ending: &str) -> bool {
    name.rsplit_once('.')
        .is_some_and(|(_, last)| last.eq_ignore_ascii_case(ending))
}

fn is_certificate_of(name: &str, set: &str) -> bool {
    name.strip_suffix(CERTIFICATE_SUFFIX)
        .is_some_and(|stem| last_part(stem) == last_part(set))
}

/// Returns whether bytes begin like a JSON object.
#[must_use]
pub fn begins_as_object(bytes: &[u8]) -> bool {
    without_mark(bytes).trim_ascii_start().starts_with(b"{")
}

/// Returns whether JSON is a session or a layout; `None` if it is not JSON.
#[must_use]
pub fn holds_document(bytes: &[u8]) -> Option<bool> {
    let value: Value = json::from_bytes(bytes).ok()?;
    let is_session = value.get("cursor").is_some() || value.get("version").is_some();
    Some(is_session || holds_combination(&value))
}

/// Returns which of several files is to be opened, and which files belong neither to it nor to another one. A
/// certificate goes with its set. A session or layout (`is_document` tests the file at an index) is opened before
/// the sets that it may name, and a set with its certificate before the image or the polygon that this may name: the order of
/// the files decides between files of one kind alone. `None` without files.
pub fn pick(
    names: &[&str],
    mut is_document: impl FnMut(usize) -> bool,
) -> Option<(usize, Vec<usize>)> {
    let considered = names.len().min(MAX_FILES);

    // A certificate of another file is not opened by itself, if that file is considered, too.
    let is_lone = |&k: &usize| {
        let others = names[..considered]
            .iter()
            .enumerate()
            .filter(|&(other, _)| other != k);
        !others
            .into_iter()
            .any(|(_, set)| is_certificate_of(names[k], set))
    };

    let lone: Vec<usize> = (0..considered).filter(is_lone).collect();

    // A file that is alone is opened whatever it holds, so that its content need not be read here.
    let document = lone.iter().copied().find(|&k| {
        let has_others = lone.len() > 1;
        has_others && is_document(k)
    });
    let has_certificate = |k: &usize| {
        let names = &names[..considered];
        names
            .iter()
            .any(|other| is_certificate_of(other, names[*k]))
    };
    let certified = || lone.iter().copied().find(has_certificate);
    let opened = document
        .or_else(certified)
        .or_else(|| lone.first().copied())?;

    let mut left = lone;
    left.retain(|&k| k != opened);
    // Files beyond the limit are not opened either.
    left.extend(considered..names.len());
    Some((opened, left))
}

/// Sorts files that came together: returns the one to be opened, with the others beside it, and the names of
/// those that it cannot use. `None` if there are no files.
#[must_use]
pub fn gather(mut files: Vec<NamedBytes>) -> Option<(Incoming, Vec<String>)> {
    let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).collect();
    let is_document = |k: usize| {
        let bytes: &[u8] = &files[k].bytes;
        bytes.len() <= MAX_BYTES && begins_as_object(bytes) && holds_document(bytes) == Some(true)
    };

    let (opened, others) = pick(&names, is_document)?;
    // The names are taken before the file is, as indices behind it change then.
    let other_names: Vec<String> = others.iter().map(|&k| files[k].name.clone()).collect();

    let file = files.remove(opened);
    // The removed file counts, too. Those beyond the limit were not looked at, and are not kept either.
    files.truncate(MAX_FILES - 1);
    let mut incoming = Incoming::new(file);
    incoming.beside = files;
    let unused = incoming.without_named(other_names);
    Some((incoming, unused))
}

/// Returns whether a JSON object is a layout or a saved combination, rather than a session or a point set.
#[must_use]
pub fn holds_combination(value: &Value) -> bool {
    value.get("combination").is_some() || value.get("pieces").is_some()
}
