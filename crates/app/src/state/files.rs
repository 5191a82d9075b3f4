//! The commands of saved sessions and pattern files, and what becomes of the files.

use super::State;
use crate::files::{FileCommand, FileForm, Purpose, SESSION_NAME};

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
                self.file = Some(FileForm {
                    purpose,
                    path,
                    asked: false,
                });
            }
            FileCommand::Close => self.file = None,
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
    use crate::files::{self, Done, Opened, Outcome};
    use crate::jobs::Job;
    use crate::view::View;

    impl State {
        pub(super) fn apply_to_disk(&mut self, command: FileCommand) {
            match command {
                FileCommand::Browse => {
                    if let Some(form) = &self.file {
                        self.finding = Some(files::browse(form, &self.wake));
                    }
                }
                FileCommand::Go => self.file_away(),
                FileCommand::Cancel => {
                    if let Some(job) = &self.filing {
                        job.cancel();
                    }
                }
                FileCommand::Dropped(path) => {
                    self.generation += 1;
                    let generation = self.generation;
                    self.filing = Some(Job::start(&self.wake, move |monitor| {
                        files::open_dropped(Path::new(&path), generation, monitor)
                    }));
                }
                _ => {}
            }
        }

        fn file_away(&mut self) {
            let Some(form) = &mut self.file else {
                return;
            };
            if form.path.trim().is_empty() || self.filing.is_some() {
                return;
            }
            let path = PathBuf::from(form.path.trim());
            let known = self.session_path.as_deref() == Some(form.path.trim());
            if form.purpose == Purpose::Save && path.exists() && !known && !form.asked {
                form.asked = true;
                return;
            }
            let purpose = form.purpose;
            self.generation += 1;
            let (generation, saved) = (self.generation, self.saved());
            self.filing = Some(Job::start(&self.wake, move |monitor| match purpose {
                Purpose::Save => match saved {
                    Some(saved) => files::save(&saved, &path),
                    None => Err("there is no session to save".to_owned()),
                },
                Purpose::Open => files::open(&path, generation, monitor),
                Purpose::Pattern => files::pattern(&path),
            }));
        }

        pub(in crate::state) fn poll_files(&mut self) {
            if let Some(outcome) = self.finding.as_ref().and_then(Job::poll) {
                self.finding = None;
                match outcome {
                    Ok(Some(path)) => {
                        self.apply_to_files(FileCommand::Path(path.to_string_lossy().into_owned()));
                    }
                    Ok(None) => {}
                    Err(failure) => self.tell(sentence(&failure), true),
                }
            }
            if let Some(outcome) = self.filing.as_ref().and_then(Job::poll) {
                self.filing = None;
                self.filed(outcome);
            }
        }

        pub(in crate::state) fn settle_files(&mut self) {
            if let Some(job) = self.filing.take() {
                let outcome = job.wait();
                self.filed(outcome);
            }
        }

        fn filed(&mut self, outcome: Result<Outcome, String>) {
            match outcome {
                Ok(Ok(Done::Saved(path))) => {
                    let path = path.to_string_lossy().into_owned();
                    self.tell(format!("The session is in {path}."), false);
                    (self.session_path, self.file) = (Some(path), None);
                }
                Ok(Ok(Done::Opened(opened))) => self.take_up(*opened),
                Ok(Ok(Done::Pattern(own))) => {
                    let samples = own.pattern.samples().len();
                    let samples = crate::sentence::counted(samples, "sample", "samples");
                    let text = format!(
                        "The next run clips from the {samples} of {}.",
                        own.file.path
                    );
                    (self.own_pattern, self.file) = (Some(own), None);
                    self.tell(text, false);
                }
                Ok(Err(why)) | Err(why) => self.tell(sentence(&why), true),
            }
        }

        /// Shows a session that was read where it was left.
        fn take_up(&mut self, opened: Opened) {
            let recording = opened.session.recording().map(Arc::clone);
            let resumed = recording.map(|recording| Debugger::resume(&opened.saved, recording));
            let debugger = match resumed {
                Some(Ok(debugger)) => debugger,
                Some(Err(error)) => return self.tell(sentence(&error.to_string()), true),
                None => return,
            };
            self.notice = None;
            self.draft = Draft::from_parameters(opened.saved.parameters);
            self.own_pattern.clone_from(&opened.session.own);
            self.show(opened.session);
            self.debugger = Some(debugger);
            self.follow_cursor();
            let (view, mut dropped) = View::from_json(&opened.saved.view);
            dropped.extend(self.look_as(view));
            let path = opened.path.to_string_lossy().into_owned();
            if !dropped.is_empty() {
                let text = format!(
                    "{path} is open. These parts of its view make no sense and were left out: {}.",
                    dropped.join(", ")
                );
                self.tell(text, false);
            }
            (self.session_path, self.file) = (Some(path), None);
        }
    }
}
