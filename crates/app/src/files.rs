//! Saved sessions and pattern files: what the sheet asks for, and reading and writing them in the background. A session
//! is what `tilescope_debugger` saves; the window adds how it is looked at.

/// What a file is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Purpose {
    /// To keep the session.
    Save,
    /// To go on with a session.
    Open,
    /// To sample with a pattern of one's own.
    Pattern,
}

impl Purpose {
    /// Returns the title of the sheet.
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::Save => "Save the session",
            Self::Open => "Open a session",
            Self::Pattern => "Use a pattern from a file",
        }
    }

    /// Returns what happens, in a sentence.
    #[must_use]
    pub const fn explanation(self) -> &'static str {
        match self {
            Self::Save => {
                "Parameters, moment, breakpoints, watches, bookmarks and view are written; the run is computed again when the session is opened."
            }
            Self::Open => {
                "The run is computed again, and its digest proves that it is the one that was saved."
            }
            Self::Pattern => {
                "A point set with its certificate, in any format that is exported. It must be maximal; the next run clips from it."
            }
        }
    }

    /// Returns what the button says.
    #[must_use]
    pub const fn verb(self) -> &'static str {
        match self {
            Self::Save => "Save",
            Self::Open => "Open",
            Self::Pattern => "Use this pattern",
        }
    }
}

/// The sheet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileForm {
    /// What the file is for.
    pub purpose: Purpose,
    /// Its name.
    pub path: String,
    /// Whether the user was asked if an existing file may be replaced.
    pub asked: bool,
}

/// An action of the sheet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FileCommand {
    /// Opens the sheet.
    Sheet(Purpose),
    /// Closes it.
    Close,
    /// Types the file's name.
    Path(String),
    /// Asks for the file in the system's dialog.
    Browse,
    /// Reads or writes the file. Where a file would be replaced, the first call asks and the second does it.
    Go,
    /// Stops what is read or written.
    Cancel,
    /// Takes files that were dropped on the window: a session or a pattern.
    Dropped(Vec<String>),
    /// Returns to the pattern that the parameters describe.
    GeneratedPattern,
}

/// The longest pattern file that is read: a million samples as text.
pub const MOST_PATTERN_BYTES: u64 = 100_000_000;

/// The name of a session's file, where there is none yet.
pub const SESSION_NAME: &str = "tilescope-session.json";

#[cfg(not(target_arch = "wasm32"))]
pub use native::{
    Done, Filing, Opened, Outcome, browse, certificate_of, open, open_dropped, pattern, save,
};

#[cfg(not(target_arch = "wasm32"))]
mod native {
    use std::path::{Path, PathBuf};
    use std::sync::Arc;

    use tilescope_core::Pattern;
    use tilescope_debugger::{Debugger, MAX_BYTES, PatternFile, Session as Saved, SessionError};

    use super::{FileForm, MOST_PATTERN_BYTES, Purpose, SESSION_NAME};
    use crate::jobs::{Job, Monitor, Wake};
    use crate::recipe::{OwnPattern, Recipe, load};
    use crate::session::{Reporter, Session};

    /// A session that was read, and its run.
    pub struct Opened {
        /// The file.
        pub path: PathBuf,
        /// What was saved.
        pub saved: Saved,
        /// The run, computed again.
        pub session: Session,
    }

    /// A file that is being read or written.
    pub struct Filing {
        /// What for; a dropped one is looked at first.
        pub purpose: Option<Purpose>,
        /// Its name.
        pub path: String,
        /// The work.
        pub job: Job<Outcome>,
    }

    /// What became of a file, or why nothing did.
    pub type Outcome = Result<Done, String>;

    /// What became of a file.
    pub enum Done {
        /// It was written.
        Saved(PathBuf),
        /// A session was read.
        Opened(Box<Opened>),
        /// A pattern was read.
        Pattern(OwnPattern),
    }

    /// Returns where the certificate of a point set lies.
    #[must_use]
    pub fn certificate_of(path: &str) -> PathBuf {
        tilescope_formats::certificate_path(Path::new(path))
    }

    /// Writes a session.
    pub fn save(saved: &Saved, path: &Path) -> Outcome {
        let failed =
            |error: &dyn std::fmt::Display| format!("the session was not written: {error}");
        // What would be refused when it is opened is not written.
        saved.check().map_err(|error| failed(&error))?;
        let text = saved.to_json().map_err(|error| failed(&error))?;
        tilescope_formats::write_whole(path, text.as_bytes()).map_err(|error| failed(&error))?;
        Ok(Done::Saved(path.to_owned()))
    }

    /// Reads a session and computes its run again.
    pub fn open(path: &Path, generation: u64, monitor: &Monitor) -> Outcome {
        let named = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
        let saved = Saved::from_json(&text_of(path)?).map_err(|error| named(&error))?;
        let mut own = None;
        let mut loader = |file: &PatternFile| {
            let pattern = find_pattern(file, path)?;
            own = Some(pattern.clone());
            Ok(Pattern::clone(&pattern.pattern))
        };
        let mut observer = Reporter { monitor };
        let recording = match saved.record(&mut loader, &mut observer) {
            Ok(recording) => Arc::new(recording),
            Err(SessionError::Run(tilescope_core::SampleError::Cancelled { .. })) => {
                return Err("cancelled: the session was not opened".to_owned());
            }
            Err(error) => return Err(named(&error)),
        };
        // Proved here, in the background.
        Debugger::resume(&saved, Arc::clone(&recording)).map_err(|error| named(&error))?;
        let recipe = Recipe {
            parameters: saved.parameters,
            own,
        };
        let session = Session::from_recording(recording, generation).with(&recipe);
        Ok(Done::Opened(Box::new(Opened {
            path: path.to_owned(),
            saved,
            session,
        })))
    }

    fn text_of(path: &Path) -> Result<String, String> {
        let named = |error: &dyn std::fmt::Display| format!("{}: {error}", path.display());
        plain_file(path, MAX_BYTES as u64)?;
        let bytes = std::fs::read(path).map_err(|error| named(&error))?;
        String::from_utf8(bytes).map_err(|_| named(&"this is no saved session: it is not text"))
    }

    /// Fails where there is no file of at most `limit` bytes: a device or a pipe would never end.
    fn plain_file(path: &Path, limit: u64) -> Result<(), String> {
        let about =
            std::fs::metadata(path).map_err(|error| format!("{}: {error}", path.display()))?;
        if !about.is_file() {
            return Err(format!("{} is no file", path.display()));
        }
        if about.len() > limit {
            return Err(format!(
                "{} has {} bytes; at most {limit} are read",
                path.display(),
                about.len()
            ));
        }
        Ok(())
    }

    /// Reads a session's pattern from beside the session's file, else from where it was.
    fn find_pattern(file: &PatternFile, session: &Path) -> Result<OwnPattern, String> {
        let path = Path::new(&file.path);
        let beside = path
            .file_name()
            .and_then(|name| Some(session.parent()?.join(name)));
        if let Some(beside) = beside.filter(|beside| beside != path && beside.is_file()) {
            // One of the same name may be another.
            let found = read_pattern(&beside);
            if found
                .as_ref()
                .is_ok_and(|found| found.file.digest == file.digest)
            {
                return found;
            }
        }
        // Another machine is asked for nothing because a file says so.
        if file.path.starts_with(r"\\") || file.path.starts_with("//") {
            return Err("it lies on another machine; put it beside the session".to_owned());
        }
        read_pattern(path)
    }

    fn read_pattern(path: &Path) -> Result<OwnPattern, String> {
        plain_file(path, MOST_PATTERN_BYTES)?;
        load(path)
    }

    /// Reads a pattern.
    pub fn pattern(path: &Path) -> Outcome {
        read_pattern(path).map(Done::Pattern)
    }

    /// Reads a file that was dropped: a session if it is one, else a pattern.
    pub fn open_dropped(path: &Path, generation: u64, monitor: &Monitor) -> Outcome {
        let json = path.extension().is_some_and(|ending| ending == "json");
        if json && !holds_points(path) {
            open(path, generation, monitor)
        } else {
            pattern(path)
        }
    }

    /// Returns whether a JSON file is a point set rather than a session.
    fn holds_points(path: &Path) -> bool {
        let value = text_of(path)
            .ok()
            .and_then(|text| serde_json::from_str::<serde_json::Value>(&text).ok());
        let of_session = |value: &serde_json::Value| {
            value.get("cursor").is_some() || value.get("version").is_some()
        };
        value.is_some_and(|value| !of_session(&value))
    }

    /// Opens the system's dialog; the job ends with the chosen file, or `None`.
    #[must_use]
    pub fn browse(form: &FileForm, wake: &Wake) -> Job<Option<PathBuf>> {
        let path = Path::new(form.path.trim());
        let mut dialog = rfd::AsyncFileDialog::new().set_title(form.purpose.title());
        if let Some(folder) = path.parent().filter(|folder| folder.is_dir()) {
            dialog = dialog.set_directory(folder);
        }
        if form.purpose != Purpose::Pattern {
            dialog = dialog.add_filter("Sessions", &["json"]);
        }
        // The dialog must be made on the window's thread; waiting for it must not.
        if form.purpose == Purpose::Save {
            let name = path
                .file_name()
                .map_or(SESSION_NAME.into(), |name| name.to_string_lossy());
            let answer = dialog.set_file_name(name).save_file();
            return Job::start(wake, move |_| {
                pollster::block_on(answer).map(|file| file.path().to_owned())
            });
        }
        let answer = dialog.pick_file();
        Job::start(wake, move |_| {
            pollster::block_on(answer).map(|file| file.path().to_owned())
        })
    }
}
