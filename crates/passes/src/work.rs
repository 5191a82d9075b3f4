//! The background work of the passes: starts to list, visit or export them, and takes the results. `device.rs` does the
//! work.

use tilescope_session::jobs::Job;
use tilescope_session::words::{counted, sentence};

use super::device::{self, Arrival, Goal, Stop, Survey};
use super::{PassWork, Passes, csv, model};

impl Passes {
    pub(super) fn survey(&mut self) {
        // A fault changes the run, so the stopped run on the device cannot be continued.
        self.walker = None;
        self.visit = None;
        self.entries.clear();
        self.lines.clear();
        (self.notice, self.unlisted) = (None, None);
        self.export_result = None;
        let subject = self.subject.clone();
        let work = move |monitor| device::survey(subject, monitor);
        self.work = PassWork::Survey(Job::start_future(&self.wake, work));
    }

    /// Takes the outcome of a survey. Returns true, as the list has changed.
    pub(super) fn surveyed(&mut self, outcome: Result<Survey, String>) -> bool {
        self.work = PassWork::Idle;
        match outcome {
            Ok(survey) => {
                self.entries = survey.passes;
                self.restarts = survey.restarts;
                self.walker = survey.walker;
                let count = counted(self.entries.len(), "pass", "passes");
                self.unlisted = survey.stop.map(|stop| match stop {
                    Stop::Cancelled => {
                        format!("Cancelled after {count}: the list is incomplete.")
                    }
                    Stop::Failed(why) => format!("Stopped after {count}. {why}"),
                });
            }
            Err(failure) => self.unlisted = Some(sentence(&failure)),
        }

        self.lines = model::lines(&self.entries);
        let last = self.entries.len().checked_sub(1);
        // The selected pass stays selected. If the new list ends before it, the list's last pass is selected. If no
        // pass was selected, the first one is.
        self.selected = last.map(|last| self.selected.unwrap_or(0).min(last));
        self.is_wanted = self.selected.is_some();

        if let Some(stage) = self.wanted_stage.take() {
            self.select_stage(stage);
        }
        true
    }

    /// Chooses a pass, and visits it unless its buffers are at hand.
    pub(super) fn select(&mut self, pass: usize) {
        let is_on_its_way = self.is_wanted && self.selected == Some(pass);
        if pass >= self.entries.len() || is_on_its_way {
            return;
        }
        self.selected = Some(pass);
        self.notice = None;
        self.export_result = None;
        // `visit` has the last visit if that was of this pass: its buffers are still at hand.
        self.is_wanted = self.visit().is_none();
        // A visit under way is of another pass, or was cancelled already.
        if let PassWork::Visit(job) = &self.work {
            job.cancel();
        }
        self.go_on();
    }

    /// Starts visiting the selected pass if that is wanted and no other work is running.
    pub(super) fn go_on(&mut self) {
        let Some(pass) = self.selected.filter(|_| self.is_wanted) else {
            return;
        };
        let (PassWork::Idle, Some(entry)) = (&self.work, self.entries.get(pass)) else {
            return;
        };

        let goal = Goal {
            pass,
            entry: entry.clone(),
        };
        // The walker goes with the work and comes back with its outcome.
        let (subject, walker) = (self.subject.clone(), self.walker.take());
        let work = move |monitor| device::visit(subject, walker, goal, monitor);
        self.work = PassWork::Visit(Job::start_future(&self.wake, work));
    }

    /// Takes the outcome of a visit. Always returns true: the work in the background has changed.
    pub(super) fn visited(&mut self, outcome: Result<Arrival, String>) -> bool {
        self.work = PassWork::Idle;
        let outcome = match outcome {
            Ok(arrival) => {
                self.walker = arrival.walker;
                arrival.outcome
            }
            Err(failure) => Err(Stop::Failed(sentence(&failure))),
        };

        match outcome {
            Ok(visit) => {
                if Some(visit.pass) == self.selected {
                    self.is_wanted = false;
                    // `cancel` may have noted that the pass was not visited, when the visit had already ended.
                    self.notice = None;
                }
                self.shown.enter(&visit);
                self.visit = Some(visit);
            }
            // Another pass was selected meanwhile, and the caller's `go_on` visits it. If the user cancelled, none is wanted.
            Err(Stop::Cancelled) => {}
            // After a failure no pass is visited, not even one that was selected meanwhile: the same device would have
            // to run it. The user can select a pass to try again.
            Err(Stop::Failed(why)) => {
                self.is_wanted = false;
                self.notice = Some(why);
            }
        }
        true
    }

    /// Stops the work in the background. A visit that is stopped is not begun again.
    pub(super) fn cancel(&mut self) {
        match &self.work {
            PassWork::Idle => {}
            PassWork::Survey(job) => job.cancel(),
            PassWork::Visit(job) => {
                job.cancel();
                self.is_wanted = false;
                let text = "Cancelled: this pass was not visited. Select it again to visit it.";
                self.notice = Some(text.to_owned());
            }
        }
    }

    /// Returns the file name of the rows shown; a general one if there are none.
    pub(super) fn file_name(&self) -> String {
        let named = self.visit().and_then(|visit| {
            let table = self.shown.table(Some(visit))?;
            let pass = self.entries.get(visit.pass)?;
            Some(csv::file_name(visit.pass, pass.report.name, table.name))
        });
        named.unwrap_or_else(|| "pass.csv".to_owned())
    }

    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn export(&mut self) {
        let Some(text) = self.csv() else {
            return;
        };
        let path = std::path::PathBuf::from(self.path().trim());
        let rows = counted(self.shown.rows().len(), "row", "rows");
        self.export_result = None;
        self.export = Some(Job::start(&self.wake, move |_| {
            let written = tilescope_formats::write_whole(&path, text.as_bytes());
            let done = written.map(|()| format!("{rows} written to {}.", path.display()));
            done.map_err(|error| sentence(&error.to_string()))
        }));
    }

    #[cfg(target_arch = "wasm32")]
    pub(super) fn export(&mut self) {
        let Some(text) = self.csv() else {
            return;
        };
        let name = tilescope_session::words::last_part(self.path().trim()).to_owned();
        let rows = counted(self.shown.rows().len(), "row", "rows");
        self.export_result = Some(Ok(format!("{rows} downloaded as {name}.")));
        self.download = Some((name, text.into_bytes()));
    }
}
