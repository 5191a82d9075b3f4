//! Turns the page's sources into the files to be served: fills in placeholders, chooses names, writes the service
//! worker's list.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use anyhow::{Context, Result, bail, ensure};

use crate::names;
use crate::rewrite::{Placeholder, rewrite};
use crate::script::without_comments;

/// A file from which the page is made.
pub struct Source {
    bytes: Vec<u8>,
    /// Whether two opening braces begin a placeholder in it, as in the page's own text files.
    has_placeholders: bool,
    /// Whether the program and the first page do without it: it is not stored for use without a network.
    is_apart: bool,
}

impl Source {
    /// Returns a file that a tool made, without placeholders.
    pub const fn made(bytes: Vec<u8>) -> Self {
        Self {
            bytes,
            has_placeholders: false,
            is_apart: false,
        }
    }

    /// Returns a page beside the program's own.
    pub fn apart(name: &str, bytes: Vec<u8>) -> Self {
        Self::of_page(name, bytes).set_apart()
    }

    /// Returns this file as one that only pages beside the program's own show.
    pub fn set_apart(self) -> Self {
        Self {
            is_apart: true,
            ..self
        }
    }

    /// Returns its text.
    ///
    /// # Errors
    ///
    /// It is not in UTF-8.
    pub fn text(&self) -> Result<&str> {
        Ok(std::str::from_utf8(&self.bytes)?)
    }

    /// Returns a file of the page.
    pub fn of_page(name: &str, bytes: Vec<u8>) -> Self {
        Self {
            bytes,
            has_placeholders: names::is_text(name),
            is_apart: false,
        }
    }
}

/// A file as it is served.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct File {
    /// Its path in the folder, with slashes.
    pub path: String,
    /// The bytes of its content.
    pub bytes: Vec<u8>,
    /// Whether the program needs it to start.
    pub to_start: bool,
    /// Whether its name contains a hash of its content.
    pub hashed: bool,
}

/// Returns the files of the page's folder.
pub fn read(folder: &Path) -> Result<BTreeMap<String, Source>> {
    let files = read_folder(folder)?;
    let sources = files.into_iter().map(|(name, bytes)| {
        let source = Source::of_page(&name, bytes);
        (name, source)
    });
    Ok(sources.collect())
}

/// Returns the example's files, which keep their names, since they are meant to be read and copied.
pub fn example(folder: &Path) -> Result<Vec<File>> {
    let files = read_folder(folder)?.into_iter();
    let file = |(name, bytes)| File {
        path: format!("example/{name}"),
        bytes,
        to_start: false,
        hashed: false,
    };
    Ok(files.map(file).collect())
}

/// Returns the file with the texts of a package's page, by their names, as JSON: the program needs all of them or none.
pub fn course(folder: &Path) -> Result<Source> {
    let texts = read_folder(folder)?.into_iter().map(|(name, bytes)| {
        let text = String::from_utf8(bytes).with_context(|| name.clone())?;
        Ok((name, text))
    });
    let texts: BTreeMap<String, String> = texts.collect::<Result<_>>()?;
    Ok(Source::made(serde_json::to_vec(&texts)?))
}

/// Returns the name and the bytes of each file of a folder, in any order. Fails if it holds a folder.
fn read_folder(folder: &Path) -> Result<Vec<(String, Vec<u8>)>> {
    let context = || format!("cannot read the folder {}", folder.display());
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).with_context(context)? {
        let path = entry.with_context(context)?.path();
        let name = path
            .file_name()
            .and_then(|name| name.to_str())
            .with_context(|| format!("{} is not named in UTF-8", path.display()))?;

        // Hidden files and backups of editors are no part of the page.
        if name.starts_with('.') || name.ends_with('~') {
            continue;
        }

        ensure!(path.is_file(), "{} is not a file", path.display());
        let bytes =
            std::fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
        files.push((name.to_owned(), bytes));
    }
    Ok(files)
}

/// What the policy of the page allows to connect to.
const CONNECTS: &str = "connect-src 'self'";

/// Allows the program, in the policy of its page, to send answers to the record store at `origin`. Otherwise the policy
/// names the page's own server alone.
///
/// # Errors
/// There is no `index.html`, it is not in UTF-8, or it has not exactly one policy.
pub fn allow_store(sources: &mut BTreeMap<String, Source>, origin: &str) -> Result<()> {
    let index = sources
        .get_mut("index.html")
        .context("there is no file index.html")?;
    let text = std::str::from_utf8(&index.bytes).context("index.html")?;
    let policies = text.matches(CONNECTS).count();
    ensure!(
        policies == 1,
        "index.html has \"{CONNECTS}\" {policies} times, not once"
    );
    index.bytes = text
        .replace(CONNECTS, &format!("{CONNECTS} {origin}"))
        .into_bytes();
    Ok(())
}

/// Returns every file under its final name, those of the program first. `address` is the folder's public address, or
/// empty.
///
/// # Errors
/// A placeholder that cannot be filled in, files that refer to each other in a circle, a missing `index.html`.
pub fn assemble(sources: &BTreeMap<String, Source>, address: &str) -> Result<Vec<File>> {
    let mut assembly = Assembly {
        sources,
        address,
        done: BTreeMap::new(),
        open: Vec::new(),
    };

    // The files that `index.html` leads to are finished first: those that are needed to start are among them.
    assembly.finish("index.html")?;
    let led_to: BTreeSet<String> = assembly.done.keys().cloned().collect();

    let own = |(name, source): &(&String, &Source)| *name != WORKER && !source.is_apart;
    for (name, _) in sources.iter().filter(own) {
        // A file that is not finished yet is one that `index.html` does not lead to.
        if assembly.finish(name)? {
            eprintln!("warning: nothing that index.html leads to refers to {name}");
        }
    }

    // The service worker stores these, so that the program runs without a network.
    let stored: BTreeSet<String> = assembly.done.keys().cloned().collect();

    // Then the pages beside it, with the pictures that they alone show.
    for name in sources.keys().filter(|name| *name != WORKER) {
        assembly.finish(name)?;
    }

    let (mut files, mut apart) = (Vec::new(), Vec::new());
    for (name, (path, bytes)) in assembly.done {
        let list = if stored.contains(&name) {
            &mut files
        } else {
            &mut apart
        };
        list.push(File {
            // Some files that others name are loaded on demand alone.
            to_start: led_to.contains(&name) && !names::is_later(&name),
            hashed: !names::is_stable(&name),
            path,
            bytes,
        });
    }

    // The service worker comes after the files that it lists.
    if let Some(worker) = sources.get(WORKER) {
        let bytes = service_worker(worker, &files)?;
        files.push(File {
            path: WORKER.to_owned(),
            bytes,
            to_start: false,
            hashed: false,
        });
    }

    files.extend(apart);
    Ok(files)
}

/// The service worker, which lists all files of the program and the first page.
const WORKER: &str = "sw.js";

/// Returns the service worker with the addresses of `files` and their version.
fn service_worker(source: &Source, files: &[File]) -> Result<Vec<u8>> {
    // The page is requested by its folder's name, because some servers redirect `index.html`.
    let address = |file: &File| match file.path.as_str() {
        "index.html" => "./".to_owned(),
        path => path.to_owned(),
    };
    let addresses: Vec<String> = files.iter().map(address).collect();

    // The version depends on every name and every content, so that no change goes unnoticed.
    let mut all = Vec::new();
    for file in files {
        all.extend_from_slice(file.path.as_bytes());
        // A zero ends the name: without it names and hashes could run into each other.
        all.push(0);
        all.extend_from_slice(blake3::hash(&file.bytes).as_bytes());
    }
    all.extend_from_slice(&source.bytes);

    let text = std::str::from_utf8(&source.bytes).context(WORKER)?;
    let filled = rewrite(text, |placeholder| match placeholder {
        // The list is of relative addresses, whatever the folder's public one is.
        Placeholder::Address => Ok(String::new()),
        Placeholder::Precache => Ok(serde_json::to_string(&addresses)?),
        Placeholder::Version => Ok(names::digest(&all)),
        Placeholder::Asset(name) | Placeholder::Size(name) => {
            bail!("{name} is in the list; the service worker names no file by itself")
        }
    });

    Ok(filled.context(WORKER)?.into_bytes())
}

struct Assembly<'a> {
    sources: &'a BTreeMap<String, Source>,
    address: &'a str,
    /// Final names and bytes by name.
    done: BTreeMap<String, (String, Vec<u8>)>,
    /// Files whose placeholders are being filled in.
    open: Vec<String>,
}

impl Assembly<'_> {
    /// Finishes a file and all files that it refers to; returns whether it was not finished before.
    fn finish(&mut self, name: &str) -> Result<bool> {
        if self.done.contains_key(name) {
            return Ok(false);
        }

        let source = self
            .sources
            .get(name)
            .with_context(|| format!("there is no file {name}"))?;

        // A name has the hash of the content, so that two files that hold each other's names cannot be named.
        if let Some(start) = self.open.iter().position(|open| open == name) {
            bail!(
                "{} and {name} refer to each other",
                self.open[start..].join(", ")
            );
        }

        self.open.push(name.to_owned());
        let content = if source.has_placeholders {
            let text = std::str::from_utf8(&source.bytes).with_context(|| name.to_owned())?;
            let filled = rewrite(text, |placeholder| self.value(placeholder));
            filled.with_context(|| name.to_owned())?.into_bytes()
        } else {
            source.bytes.clone()
        };

        // Comments go before the file gets its name, which has the hash of the served bytes.
        let bytes = if names::is_script(name) {
            let text = std::str::from_utf8(&content).with_context(|| name.to_owned())?;
            without_comments(text).into_bytes()
        } else {
            content
        };

        self.open.pop();
        let path = names::final_name(name, &bytes);
        self.done.insert(name.to_owned(), (path, bytes));
        Ok(true)
    }

    /// Returns what takes the place of a placeholder. A file that it names is finished first.
    fn value(&mut self, placeholder: Placeholder<'_>) -> Result<String> {
        match placeholder {
            Placeholder::Asset(WORKER) | Placeholder::Size(WORKER) => {
                // The worker's content depends on all files in its list, and so on the one with this placeholder, which
                // would depend on the worker's.
                bail!("{WORKER} lists this file; it has a stable name, so write that")
            }
            Placeholder::Asset(name) => {
                self.finish(name)?;
                Ok(self.done[name].0.clone())
            }
            Placeholder::Size(name) => {
                self.finish(name)?;
                Ok(self.done[name].1.len().to_string())
            }
            Placeholder::Address => Ok(self.address.to_owned()),
            Placeholder::Precache | Placeholder::Version => {
                bail!("only {WORKER} has a list and a version")
            }
        }
    }
}

#[cfg(test)]
mod tests;
