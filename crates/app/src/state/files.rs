//! The commands of saved sessions and pattern files, and what becomes of the files.

use super::State;
use crate::files::{FileCommand, FileForm, Purpose, SESSION_NAME};

const WEB: &str = "Files are opened and saved by the native program only.";

impl State {
    pub(super) fn apply_to_files(&mut self, command: FileCommand) {
        match command {
            FileCommand::Sheet(purpose) => {
                let path = match purpose {
                    Purpose::Pattern => String::new(),
                    Purpose::Save | Purpose::Open => self
                        .session_path
                        .clone()
                        .unwrap_or_else(|| SESSION_NAME.to_owned()),
                };
                self.export = None;
                self.file = Some(FileForm {
                    purpose,
                    path,
                    asked: false,
                });
            }
            FileCommand::Close => {
                self.file = None;
                // Nobody waits any more for what is read; what is written is written.
                #[cfg(not(target_arch = "wasm32"))]
                self.stop_reading();
            }
            FileCommand::Path(path) => {
                if let Some(form) = &mut self.file {
                    (form.path, form.asked) = (path, false);
                }
            }
            FileCommand::GeneratedPattern => self.own_pattern = None,
            #[cfg(not(target_arch = "wasm32"))]
            command => self.apply_to_disk(command),
            #[cfg(target_arch = "wasm32")]
            _ => {}
        }
    }

    /// Returns whether a sheet lies over the window.
    #[must_use]
    pub const fn has_sheet(&self) -> bool {
        self.file.is_some() || self.export.is_some()
    }

    /// Returns why the session cannot be saved, or `None` if it can.
    #[must_use]
    pub fn save_refusal(&self) -> Option<&'static str> {
        if self.session.is_none() {
            Some("There is no session yet.")
        } else if self.debugger.is_none() {
            Some(
                "Only a session with events can be saved; larger runs are made by their parameters alone.",
            )
        } else {
            None
        }
    }

    /// Returns why no file can be opened, or `None` if one can.
    #[must_use]
    pub const fn open_refusal(&self) -> Option<&'static str> {
        if cfg!(target_arch = "wasm32") {
            Some(WEB)
        } else {
            None
        }
    }

    /// Returns the session at hand as it is saved, with how it is looked at.
    #[must_use]
    pub fn saved(&self) -> Option<tilescope_debugger::Session> {
        let (debugger, session) = (self.debugger.as_ref()?, self.session.as_ref()?);
        let mut saved = debugger.session();
        saved.view = self.view().to_json();
        saved.pattern = session.own.as_ref().map(|own| own.file.clone());
        Some(saved)
    }
}

#[cfg(not(target_arch = "wasm32"))]
mod native {
    use std::path::{Path, PathBuf};
    use std::sync::Arc;

    use tilescope_debugger::Debugger;

    use super::{FileCommand, Purpose, State};
    use crate::draft::{Draft, sentence};
    use crate::files::{self, Done, Filing, Opened, Outcome};
    use crate::jobs::{Job, Monitor};
    use crate::view::View;

    impl State {
        pub(super) fn apply_to_disk(&mut self, command: FileCommand) {
            match command {
                FileCommand::Browse => {
                    if let Some(form) = &self.file {
                        self.finding = Some((form.purpose, files::browse(form, &self.wake)));
                    }
                }
                FileCommand::Go => self.file_away(),
                FileCommand::Cancel => {
                    if let Some(filing) = &self.filing {
                        filing.job.cancel();
                    }
                }
                FileCommand::Dropped(paths) => self.take_dropped(paths),
                _ => {}
            }
        }

        fn take_dropped(&mut self, mut paths: Vec<String>) {
            // A set's certificate comes with it and is no file by itself.
            let all = paths.clone();
            paths.retain(|path| {
                let of = |other: &String| files::certificate_of(other) == Path::new(path);
                !all.iter().any(of)
            });
            let Some(path) = paths.first().cloned() else {
                return;
            };
            if self.filing.is_some() {
                let text = format!("{path} was not opened: another file is being read or written.");
                self.tell(text, true);
                return;
            }
            if paths.len() > 1 {
                let text = format!(
                    "{} files were dropped; one is opened at a time: {path}.",
                    paths.len()
                );
                self.tell(text, false);
            }
            self.begin(None, path, move |path, generation, monitor| {
                files::open_dropped(path, generation, monitor)
            });
        }

        fn begin(
            &mut self,
            purpose: Option<Purpose>,
            path: String,
            work: impl FnOnce(&Path, u64, &Monitor) -> Outcome + Send + 'static,
        ) {
            self.generation += 1;
            let (generation, name) = (self.generation, PathBuf::from(&path));
            let job = Job::start(&self.wake, move |monitor| work(&name, generation, monitor));
            self.filing = Some(Filing { purpose, path, job });
        }

        pub(in crate::state) fn stop_reading(&mut self) {
            let saves = |filing: &Filing| filing.purpose == Some(Purpose::Save);
            self.filing = self.filing.take().filter(saves);
        }

        fn file_away(&mut self) {
            let Some(form) = &mut self.file else {
                return;
            };
            let path = form.path.trim().to_owned();
            if path.is_empty() || self.filing.is_some() {
                return;
            }
            let known = self.session_path.as_deref() == Some(path.as_str());
            let taken = Path::new(&path).exists() && !known;
            if form.purpose == Purpose::Save && taken && !form.asked {
                form.asked = true;
                return;
            }
            let (purpose, saved) = (form.purpose, self.saved());
            self.begin(
                Some(purpose),
                path,
                move |path, generation, monitor| match purpose {
                    Purpose::Save => match saved {
                        Some(saved) => files::save(&saved, path),
                        None => Err("there is no session to save".to_owned()),
                    },
                    Purpose::Open => files::open(path, generation, monitor),
                    Purpose::Pattern => files::pattern(path),
                },
            );
        }

        pub(in crate::state) fn poll_files(&mut self) {
            let found = self
                .finding
                .as_ref()
                .and_then(|(purpose, job)| Some((*purpose, job.poll()?)));
            if let Some((purpose, outcome)) = found {
                self.finding = None;
                // Meanwhile the sheet may have been opened for something else.
                let same = self
                    .file
                    .as_ref()
                    .is_some_and(|form| form.purpose == purpose);
                match outcome {
                    Ok(Some(path)) if same => {
                        self.apply_to_files(FileCommand::Path(path.to_string_lossy().into_owned()));
                    }
                    Ok(_) => {}
                    Err(failure) => self.tell(sentence(&failure), true),
                }
            }
            if let Some(outcome) = self.filing.as_ref().and_then(|filing| filing.job.poll()) {
                self.filed(outcome);
            }
        }

        pub(in crate::state) fn settle_files(&mut self) {
            if let Some(filing) = &self.filing {
                let outcome = filing.job.wait();
                self.filed(outcome);
            }
        }

        /// Closes the sheet if it is the one that this file was named in.
        fn close_sheet(&mut self, filing: &Filing) {
            let this = self.file.as_ref().is_some_and(|form| {
                Some(form.purpose) == filing.purpose && form.path.trim() == filing.path
            });
            if this {
                self.file = None;
            }
        }

        fn filed(&mut self, outcome: Result<Outcome, String>) {
            let Some(filing) = self.filing.take() else {
                return;
            };
            match outcome {
                Ok(Ok(done)) => {
                    self.close_sheet(&filing);
                    self.take_done(done);
                }
                Ok(Err(why)) | Err(why) => self.tell(sentence(&why), true),
            }
        }

        fn take_done(&mut self, done: Done) {
            match done {
                Done::Saved(path) => {
                    let path = path.to_string_lossy().into_owned();
                    let mut text = format!("The session is in {path}.");
                    if self.comparison.is_some() && self.view().second.is_none() {
                        text.push_str(" The run beside it is not: it is not finished, or its pattern comes from a file.");
                    }
                    self.tell(text, false);
                    self.session_path = Some(path);
                }
                Done::Opened(opened) => self.take_up(*opened),
                Done::Pattern(own) => {
                    let samples = own.pattern.samples().len();
                    let samples = crate::sentence::counted(samples, "sample", "samples");
                    let text = format!(
                        "The next run clips from the {samples} of {}.",
                        own.file.path
                    );
                    self.own_pattern = Some(own);
                    self.tell(text, false);
                }
            }
        }

        /// Shows a session that was read where it was left. A run at work is not waited for any more.
        fn take_up(&mut self, opened: Opened) {
            let recording = opened.session.recording().map(Arc::clone);
            let resumed = recording.map(|recording| Debugger::resume(&opened.saved, recording));
            let debugger = match resumed {
                Some(Ok(debugger)) => debugger,
                Some(Err(error)) => return self.tell(sentence(&error.to_string()), true),
                None => return,
            };
            (self.sampling, self.notice) = (None, None);
            self.draft = Draft::from_parameters(opened.saved.parameters);
            self.own_pattern.clone_from(&opened.session.own);
            self.show(opened.session);
            self.debugger = Some(debugger);
            self.follow_cursor();
            let (view, mut dropped) = View::from_json(&opened.saved.view);
            dropped.extend(self.look_as(&view));
            self.forget_changes();
            let path = opened.path.to_string_lossy().into_owned();
            if !dropped.is_empty() {
                let text = format!(
                    "{path} is open. These parts of its view make no sense and were left out: {}.",
                    dropped.join(", ")
                );
                self.tell(text, false);
            }
            self.session_path = Some(path);
        }
    }
}
