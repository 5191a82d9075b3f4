//! Inputs that are opened more than once, although a pipe gives its bytes only once.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// The most bytes of a pipe, 2^30: they are kept in memory.
const MAX_BYTES: u64 = 1 << 30;

/// The bytes read from pipes, by path.
static GIVEN: Mutex<BTreeMap<PathBuf, &'static [u8]>> = Mutex::new(BTreeMap::new());

/// An input that was opened.
#[derive(Debug)]
pub(crate) enum Input {
    /// A file, which can be opened again.
    File(File),
    /// The rest of the bytes of anything else.
    Pipe(&'static [u8]),
}

impl Input {
    /// Opens a file. Anything else that `path` names is read to its end when it is first opened, and its bytes are kept
    /// until the program ends.
    pub fn open(path: &Path) -> io::Result<Self> {
        if fs::metadata(path)?.is_file() {
            return File::open(path).map(Self::File);
        }
        let mut given = GIVEN.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(bytes) = given.get(path) {
            return Ok(Self::Pipe(bytes));
        }
        let bytes: &'static [u8] = whole(File::open(path)?, MAX_BYTES)?.leak();
        given.insert(path.to_owned(), bytes);
        Ok(Self::Pipe(bytes))
    }

    /// The number of bytes.
    pub fn length(&self) -> io::Result<u64> {
        match self {
            Self::File(file) => Ok(file.metadata()?.len()),
            Self::Pipe(bytes) => Ok(bytes.len() as u64),
        }
    }
}

impl Read for Input {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::File(file) => file.read(buffer),
            Self::Pipe(bytes) => bytes.read(buffer),
        }
    }
}

fn whole(source: impl Read, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    source.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        let reason = format!(
            "it gives more than the {most} bytes of a pipe that are kept; save it as a file first"
        );
        return Err(io::Error::other(reason));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_gives_without_end_is_refused() {
        assert_eq!(whole(&b"1234"[..], 4).expect("enough").len(), 4);
        let error = whole(io::repeat(0), 1000).expect_err("endless");
        assert!(error.to_string().contains("1000 bytes"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_gives_the_same_again() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("pipe");
        let made = std::process::Command::new("mkfifo").arg(&path).status();
        assert!(made.expect("mkfifo runs").success());
        let read = || {
            let mut input = Input::open(&path).expect("open");
            let mut bytes = Vec::new();
            input.read_to_end(&mut bytes).expect("read");
            (input.length().expect("known"), bytes)
        };
        let first = std::thread::scope(|scope| {
            scope.spawn(|| fs::write(&path, "0.1,0.2\n").expect("written"));
            read()
        });
        assert_eq!(first.1, b"0.1,0.2\n");
        // The writer has ended.
        assert_eq!(read().1, first.1);
    }
}
