//! Files in the state: the commands of the file sheet, and starting to read and write. `outcome.rs` takes the results.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde_json::{Value, json};
use tilescope_classroom::lessons::LessonCommand;
use tilescope_classroom::room::NewFile;
use tilescope_debugger::Stops;
use tilescope_session::combining::SavedCombination;
use tilescope_session::ground::PortableGround;
use tilescope_session::incoming::NamedBytes;
use tilescope_session::jobs::{Job, Monitor};
use tilescope_session::session::Session;
use tilescope_session::task;
use tilescope_session::words::{last_part, sentence};
use tilescope_sets::region;

#[cfg(not(target_arch = "wasm32"))]
use super::Notice;
use super::effects::{Context, Effect};
use super::link::LinkSource;
use super::{FileState, Form, Past, RunView, State, WindowState};
use crate::command::Command;
use crate::curve::CurveFormat;
use crate::export::provenance;
use crate::files;
use crate::files::{
    Delivery, Done, FileCommand, FileForm, FileOutcome, FileSource, Filing, LAST_SESSION,
    MAX_RECENT, Purpose, ReadTask, SESSION_NAME, SaveTask,
};
use crate::view::SavedView;

mod outcome;

impl SaveTask {
    /// Returns the current session in saved form, with its view: a run with its events, or a combination.
    #[must_use]
    pub fn of(state: &State) -> Self {
        let mut view = SavedView::of(state).to_json();
        // Neither a session of the debugger nor a saved combination has a field for the record of a talk, which is stored with
        // the view.
        let record = state.classroom.saved_record();
        if let (Some(record), Some(view)) = (record, view.as_object_mut()) {
            view.insert("talk".to_owned(), json!(record));
        }
        let first = &state.runs.first;
        let session = first.session.as_ref();
        let run = first.debugger.as_ref().zip(session);

        // At least one of the two is `None`: combinations have no events.
        Self {
            // Saving from the sheet puts the name that is typed there in its place.
            name: LAST_SESSION.to_owned(),
            combination: session
                .and_then(|session| SavedCombination::of(session, first.stage, view.clone())),
            run: run.map(|(debugger, session)| {
                let mut saved = debugger.session();
                saved.view = view;
                saved.pattern = session.own.as_ref().map(|own| own.file.clone());
                if let Some(solid) = &session.solid {
                    // The parameters asked for are saved: the run itself has another insertion, by darts.
                    (saved.parameters, saved.depth) = (solid.asked, Some(solid.depth()));
                }
                if let Some(made) = &session.ground {
                    // The field is made again from the parameters that were asked for, not from those of the run.
                    let (parameters, request) = &made.asked;
                    saved.parameters = *parameters;
                    saved.ground = json!(PortableGround::of(request));
                }
                saved
            }),
        }
    }
}

/// Returns the session as the text of a file, from which [`FileCommand::Last`] reopens it: run, moment, view, breakpoints
/// and scenes.
///
/// `None` in four cases: There is no session. It is the run with which the program starts, without breakpoints, watches and
/// scenes. A lesson or the tour has replaced it, or the window is embedded in another page. Or it has images or files that
/// neither a session nor a link holds.
#[must_use]
pub fn session_to_keep(state: &State) -> Option<String> {
    // The run of a lesson, of the tour or of a page around the window is not the user's own.
    if state.past.borrowed.is_some() || state.window.embedding.is_some() {
        return None;
    }

    let run = &state.runs.first;
    let session = run.session.as_ref()?;
    let parameters = Form::default().draft.parameters;
    let is_default = session.has_recipe() && session.recipe() == parameters.into();
    // The program begins with this run anyway: it is kept only if something was marked in it.
    if is_default && run.stops() == Stops::default() {
        return None;
    }

    if run.save_refusal().is_some() {
        // A session without events can be kept as a link alone. A link that leaves out a part of the set would reopen
        // another set, so that it is not kept. A link may leave out window layouts and the second run: the set is still
        // the same.
        let is_same_set = LinkSource::of(state).left_out_of_set().is_empty();
        return is_same_set.then(|| json!({ "link": state.link().fragment }).to_string());
    }
    String::from_utf8(files::render(&SaveTask::of(state)).ok()?.bytes).ok()
}

impl FileState {
    /// Returns whether a command may save the current session.
    pub(super) fn saves(&self, command: &FileCommand) -> bool {
        let saves = |form: &FileForm| form.purpose == Purpose::Save;
        *command == FileCommand::Go && self.sheet.as_ref().is_some_and(saves)
    }

    /// Applies a command; `saved` is the current session if the command may save it.
    pub(super) fn apply(
        &mut self,
        command: FileCommand,
        run: &RunView,
        saved: Option<SaveTask>,
        context: &mut Context,
    ) {
        // Lessons are opened by another part, whichever way their files come.
        match self.take_lesson(&command) {
            Some(Ok(lesson)) => {
                return context.ask(Effect::Issue(Box::new(Command::Lesson(lesson))));
            }
            Some(Err(why)) => return context.tell_error(why),
            None => {}
        }

        match command {
            FileCommand::Sheet(purpose) => {
                // An older notice is not about the file of this sheet.
                context.ask(Effect::CloseNotice);
                self.open_sheet(purpose, run.session_path.as_deref());
            }
            FileCommand::Close => {
                self.sheet = None;
                // Closing the sheet gives up a file that is being read, but not one that is being written.
                self.stop_reading();
            }
            FileCommand::Path(path) => {
                if let Some(form) = &mut self.sheet {
                    // The question whether to replace a file was about another path, and chosen files have no path at
                    // all.
                    (form.path, form.asked) = (path, false);
                    form.chosen = Arc::default();
                }
            }

            FileCommand::Chosen(files) => self.choose(files),
            FileCommand::Browse => self.browse(context),
            FileCommand::Go => self.save_or_read(run, saved, context),
            // The file may be a point set to be compared with the first run. So every file waits until there is a run.
            FileCommand::Open(path) => self.awaiting = Some(path),
            FileCommand::Last => self.reopen_last(run, context),
            FileCommand::SaveCurve(format) => self.save_curve(run, format, context),

            FileCommand::Cancel => {
                if let Some(filing) = &self.filing {
                    filing.job.cancel();
                }
            }

            #[cfg(not(target_arch = "wasm32"))]
            FileCommand::Dropped(paths) => {
                let names = paths.iter().map(PathBuf::from).collect();
                self.take_dropped(&paths, FileSource::Paths(names), &[], run, context);
            }
            // A page gets dropped files as bytes, without paths.
            #[cfg(target_arch = "wasm32")]
            FileCommand::Dropped(_) => {}
            FileCommand::DroppedBytes(files, refused) => {
                let names: Vec<String> = files.iter().map(|file| file.name.clone()).collect();
                self.take_dropped(&names, FileSource::Bytes(files), &refused, run, context);
            }
        }
    }

    /// Reopens the last session of an earlier use of the program, by a link or as a file.
    fn reopen_last(&mut self, run: &RunView, context: &mut Context) {
        let Some(last) = &mut self.last_session else {
            return;
        };
        last.is_reopened = true;
        let text = last.text.clone();

        // `session_to_keep` wrote it: an object with a link, or the file of a session.
        let read: Option<Value> = serde_json::from_str(&text).ok();
        if let Some(link) = read.as_ref().and_then(|read| read["link"].as_str()) {
            context.ask(Effect::OpenLink(link.to_owned()));
        } else {
            let file = NamedBytes::new(LAST_SESSION.to_owned(), text);
            let (no_messages, nothing_to_save) = (Vec::new(), None);
            self.apply(
                FileCommand::DroppedBytes(vec![file], no_messages),
                run,
                nothing_to_save,
                context,
            );
        }
    }

    /// Returns whether to offer the last session: it was not reopened yet, and nothing was changed since the start.
    #[must_use]
    pub fn offers_session(&self, past: &Past, window: &WindowState) -> bool {
        let last = self.last_session.as_ref();
        let is_new = last.is_some_and(|last| !last.is_reopened);
        let is_free = past.borrowed.is_none() && !past.history.can_undo() && self.filing.is_none();
        is_new && is_free && window.embedding.is_none()
    }

    /// Opens the sheet for a purpose, with a path to begin with.
    fn open_sheet(&mut self, purpose: Purpose, session_path: Option<&str>) {
        let path = match purpose {
            // Unlike a session, a pattern, a layout or a set to be compared has no usual name.
            Purpose::Pattern | Purpose::Combination | Purpose::Against => String::new(),
            // In a browser, files are chosen in its dialog, without a path.
            Purpose::Open if self.in_browser() => String::new(),
            Purpose::Save | Purpose::Open => session_path.unwrap_or(SESSION_NAME).to_owned(),
        };
        // One sheet is open at a time.
        self.exports.sheet = None;
        self.sheet = Some(FileForm {
            purpose,
            path,
            asked: false,
            chosen: Arc::default(),
        });
    }

    /// Returns whether files are chosen in a browser and downloaded, instead of having paths. The native program does
    /// so only in tests, which act as a page.
    #[must_use]
    pub fn in_browser(&self) -> bool {
        self.delivery == Delivery::Download
    }

    /// Returns whether a sheet is open.
    #[must_use]
    pub const fn has_sheet(&self) -> bool {
        self.sheet.is_some() || self.exports.sheet.is_some()
    }

    /// Returns whether a sheet waits for the answer whether to replace a file.
    #[must_use]
    pub fn asks_to_replace(&self) -> bool {
        let saves = self.sheet.as_ref().is_some_and(|form| form.asked);
        saves || self.exports.sheet.as_ref().is_some_and(|form| form.asked)
    }

    /// Opens the dialog for files of the system or of the browser.
    fn browse(&mut self, context: &mut Context) {
        let Some(form) = &self.sheet else {
            return;
        };
        #[cfg(not(target_arch = "wasm32"))]
        match files::dialog::refusal() {
            // A test that acts as a page has no system's dialog, as it gives files without paths.
            _ if self.in_browser() => {}
            Some(why) => context.tell_error(why),
            None => self.finding = Some((form.purpose, files::browse(form, &context.wake))),
        }
        // A page saves by a download, without a dialog.
        #[cfg(target_arch = "wasm32")]
        if form.purpose != Purpose::Save {
            self.finding = Some((form.purpose, files::web::choose(&context.wake)));
        }
    }

    /// Takes chosen files, and shows their names in the field of the path.
    fn choose(&mut self, files: Vec<NamedBytes>) {
        let Some(form) = self.sheet.as_mut() else {
            return;
        };
        let names: Vec<&str> = files.iter().map(|file| file.name.as_str()).collect();
        (form.path, form.asked) = (names.join(", "), false);
        form.chosen = files.into();
    }

    /// Starts reading dropped files, of which notices name the first; `refused` has the reasons why others of them are
    /// not even read.
    fn take_dropped(
        &mut self,
        names: &[String],
        source: FileSource,
        refused: &[String],
        run: &RunView,
        context: &mut Context,
    ) {
        let Some(first) = names.first() else {
            // All files were refused. The reason for the first one is shown.
            if let Some(why) = refused.first() {
                context.tell_error(tilescope_session::words::ended(why));
            }
            return;
        };

        if self.filing.is_some() {
            let text = format!("{first} was not opened: another file is being read or written.");
            context.tell_error(text);
            return;
        }

        let decided_by_content = None;
        self.begin_reading(decided_by_content, first.clone(), source, run, context);
        // The notice about the file that is read also names the files that were refused.
        if let Some(filing) = &mut self.filing {
            filing.refused = refused.to_vec();
        }
    }

    /// Starts to read a file in the background; without a purpose its content decides what it is for.
    fn begin_reading(
        &mut self,
        purpose: Option<Purpose>,
        path: String,
        source: FileSource,
        run: &RunView,
        context: &mut Context,
    ) {
        // A set that is to be compared with the run must have the run's domain and radius: the task checks that.
        let domain = run.session.as_ref().map(|session| session.run().domain);
        let region_and_radius = domain.map(|domain| (region(&domain), domain.radius()));

        let generation = context.next_generation();
        let task = ReadTask {
            purpose,
            source,
            generation,
            run: region_and_radius,
        };

        let job = task::start(&context.wake, task);
        self.wait_for(purpose, path, job);
    }

    fn start_filing(
        &mut self,
        purpose: Option<Purpose>,
        path: String,
        context: &Context,
        work: impl FnOnce(&Monitor) -> FileOutcome + Send + 'static,
    ) {
        let job = Job::start(&context.wake, work);
        self.wait_for(purpose, path, job);
    }

    fn wait_for(&mut self, purpose: Option<Purpose>, path: String, job: Job<FileOutcome>) {
        let refused = Vec::new();
        self.filing = Some(Filing {
            purpose,
            path,
            refused,
            job,
        });
    }

    /// Stops reading; a file that is being written is still written.
    pub(super) fn stop_reading(&mut self) {
        let saves = |filing: &Filing| filing.purpose == Some(Purpose::Save);
        self.filing = self.filing.take().filter(saves);
    }

    /// Does what the file sheet is for: starts saving the session, or reading the file.
    fn save_or_read(&mut self, run: &RunView, saved: Option<SaveTask>, context: &mut Context) {
        let Some(form) = &mut self.sheet else {
            return;
        };

        let path = form.path.trim().to_owned();
        // Without a name there is nothing to do, and one file is read or written at a time.
        if path.is_empty() || self.filing.is_some() {
            return;
        }

        let purpose = form.purpose;
        if purpose == Purpose::Save {
            if let Some(saved) = saved {
                let name = files::with_json(path);
                self.start_saving(SaveTask { name, ..saved }, run, context);
            }
        } else if !form.chosen.is_empty() {
            let source = FileSource::Bytes(form.chosen.to_vec());
            self.begin_reading(Some(purpose), path, source, run, context);
        } else if self.in_browser() {
            // A page cannot open a path.
            let text = "Choose the file with Browse, or drop it on the window.";
            context.tell_error(text.to_owned());
        } else {
            #[cfg(not(target_arch = "wasm32"))]
            self.begin_reading(
                Some(purpose),
                path.clone(),
                FileSource::Paths(vec![PathBuf::from(path)]),
                run,
                context,
            );
        }
    }

    /// Starts writing a session to the file that the task names. If that would replace another file, the first call only asks.
    #[cfg_attr(
        target_arch = "wasm32",
        allow(unused_variables, reason = "a page replaces no files")
    )]
    fn start_saving(&mut self, task: SaveTask, run: &RunView, context: &Context) {
        let path = task.name.clone();
        // The sheet closes once the file that it names is written, so that it must have the name with the added extension.
        if let Some(form) = &mut self.sheet {
            form.path.clone_from(&path);
        }

        match self.delivery {
            #[cfg(not(target_arch = "wasm32"))]
            Delivery::Disk => {
                // The session's own file is replaced without a question.
                let is_own = run.session_path.as_deref() == Some(path.as_str());
                let would_replace = Path::new(&path).exists() && !is_own;

                if let Some(form) = &mut self.sheet
                    && would_replace
                    && !form.asked
                {
                    form.asked = true;
                    return;
                }

                self.start_filing(Some(Purpose::Save), path, context, move |_| {
                    FileOutcome::of(files::save(&task).map(|()| Done::Saved(task.name)))
                });
            }
            Delivery::Download => {
                let task = SaveTask {
                    name: last_part(&path).to_owned(),
                    ..task
                };
                self.start_filing(Some(Purpose::Save), path, context, move |_| {
                    FileOutcome::of(files::render(&task).map(Done::Download))
                });
            }
        }
    }

    /// Returns the command that opens the lesson that a command brings, the first one among several files, or why it cannot be
    /// read; `None` if the command brings no lesson. A sheet that names a lesson closes.
    pub(super) fn take_lesson(
        &mut self,
        command: &FileCommand,
    ) -> Option<Result<LessonCommand, String>> {
        let is_lesson = |name: &str| name.to_lowercase().ends_with(".md");

        match command {
            FileCommand::Dropped(paths) => {
                let path = paths.iter().find(|path| is_lesson(path))?;
                Some(Ok(LessonCommand::File(path.into())))
            }

            FileCommand::DroppedBytes(files, _) => {
                let file = files.iter().find(|file| is_lesson(&file.name))?;
                Some(read_lesson(file))
            }

            FileCommand::Go => {
                // The sheet for sessions also opens lessons. Files that a page's dialog delivered have no paths.
                let opens = |sheet: &FileForm| {
                    let mut names = sheet.chosen.iter().map(|file| file.name.as_str());
                    sheet.purpose == Purpose::Open
                        && (is_lesson(&sheet.path) || names.any(is_lesson))
                };
                let sheet = self.sheet.take_if(|sheet| opens(sheet))?;
                let chosen = sheet.chosen.iter().find(|file| is_lesson(&file.name));
                Some(chosen.map_or_else(|| Ok(LessonCommand::File(sheet.path.into())), read_lesson))
            }

            // None of these brings a lesson. A file of `Open` waits for a run, and then comes as one of `Dropped`.
            FileCommand::Sheet(_)
            | FileCommand::Close
            | FileCommand::Path(_)
            | FileCommand::Browse
            | FileCommand::Chosen(_)
            | FileCommand::Cancel
            | FileCommand::Open(_)
            | FileCommand::SaveCurve(_)
            | FileCommand::Last => None,
        }
    }

    /// Saves the curve of a run, or says why there is none.
    fn save_curve(&self, run: &RunView, format: CurveFormat, context: &mut Context) {
        let curve = (run.session.as_ref())
            .and_then(|session| run.curve.file(session, format, provenance(session)));

        let why = match (curve, run.curve.number()) {
            (Some(Ok(bytes)), Some(number)) => {
                let file = NewFile {
                    stem: format!("curve-{}", number.key()),
                    extension: format.extension(),
                    path: None,
                    bytes,
                };
                self.save_new(file, context);
                return;
            }
            (Some(Err(error)), _) => sentence(&error.to_string()),
            (_, Some(_)) => "The curve is not made yet.".to_owned(),
            (_, None) => "No curve is shown: choose its number first.".to_owned(),
        };

        context.tell_error(why);
    }

    /// Writes a file to its path, or without a path to a new one in the current folder; on a page, downloads it. Returns whether
    /// it was written or given to the browser; a notice says so, or why not.
    pub(super) fn save_new(&self, file: NewFile, context: &mut Context) -> bool {
        let NewFile {
            stem,
            extension,
            path,
            bytes,
        } = file;

        if self.in_browser() {
            let file = NamedBytes::new(format!("{stem}.{extension}"), bytes);
            context.ask(Effect::Download(file));
            return true;
        }

        let named = |number: usize| match number {
            0 => PathBuf::from(format!("{stem}.{extension}")),
            _ => PathBuf::from(format!("{stem}-{number}.{extension}")),
        };
        // A path that the user gave is written to, whatever is there. A file without one gets a name that no other file
        // has. A thousand numbers were taken to be enough: without a free one the path is empty, and writing fails with
        // a notice.
        let path = path.or_else(|| (0..1_000).map(named).find(|path| !path.exists()));
        write_new(&path.unwrap_or_default(), &bytes, context)
    }

    /// Lists a file as the most recent one. Its path is complete, so that it is found from other folders.
    pub(super) fn remember_file(&mut self, path: &str) {
        if self.in_browser() {
            return;
        }
        let whole = std::path::absolute(path);
        let path = whole.map_or_else(|_| path.to_owned(), |path| path.display().to_string());
        self.recent.retain(|other| *other != path);
        self.recent.insert(0, path);
        self.recent.truncate(MAX_RECENT);
    }
}

#[cfg(target_arch = "wasm32")]
fn write_new(_: &Path, _: &[u8], _: &mut Context) -> bool {
    false
}

/// Writes a file, and reports its path or why it was not written. Returns whether it was.
#[cfg(not(target_arch = "wasm32"))]
fn write_new(path: &Path, bytes: &[u8], context: &mut Context) -> bool {
    let written = tilescope_formats::write_whole(path, bytes);
    let is_written = written.is_ok();
    match written {
        Ok(()) => {
            // Without a current folder the path is shown as it is.
            let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
            let text = format!("Saved as {}.", path.display());
            context.ask(Effect::Tell(Notice {
                folder: path.parent().map(Path::to_owned),
                ..Notice::remark(text)
            }));
        }
        Err(error) => context.tell_error(sentence(&error.to_string())),
    }
    is_written
}

/// Returns the command that opens a lesson from a file in memory, named as the file without its ending.
fn read_lesson(file: &NamedBytes) -> Result<LessonCommand, String> {
    let text = String::from_utf8(file.bytes.clone())
        .map_err(|_| format!("{}: the file is not text.", file.name))?;
    // The ending may have capitals, as the search for lessons allows them.
    let name = file.name[..file.name.len() - ".md".len()].to_owned();
    Ok(LessonCommand::Read(name, text))
}

/// Returns whether a session's field or shape is from an image. A grid and a polygon with more corners than a session
/// holds count as images: they are refused alike.
fn has_image(session: &Session) -> bool {
    let request = session.ground.as_ref().map(|made| &made.asked.1);
    request.is_some_and(|request| PortableGround::of(request).is_none())
}

impl RunView {
    /// Returns why the session cannot be saved, or `None` if it can.
    #[must_use]
    pub fn save_refusal(&self) -> Option<&'static str> {
        let Some(session) = &self.session else {
            return Some("There is no session yet.");
        };
        let events = "Only a session with events can be saved; a larger run is reproduced by its parameters.";
        let files = "This combination has sets from files, which a saved session would not contain; keep its layout instead.";
        let image = "A run from an image, from a grid of radii or in a polygon of very many corners is not saved as a session, which would not contain it; an export of the set names it.";
        let levels = "Nested levels are not saved as a session: a link to them, or an export of the set, gives them again.";
        match &session.combination {
            None if session.nested.is_some() => Some(levels),
            None if has_image(session) => Some(image),
            Some(combination) => (combination.files > 0).then_some(files),
            None => self.debugger.is_none().then_some(events),
        }
    }
}
