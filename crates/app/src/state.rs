//! Everything the window shows, and the one place where commands change it. It knows no widgets: tests
//! drive it without a window.

use std::sync::Arc;

use egui::{Rect, Theme};
use tilescope_analysis::VerifyError;
use tilescope_core::{SampleError, Stage};

use crate::camera::{Camera, Flight};
use crate::canvas::layers::{Colouring, Layers};
use crate::command::{Command, Witness};
use crate::device::{Device, Engine};
use crate::draft::{Draft, sentence};
use crate::export::ExportForm;
use crate::jobs::{Job, Wake};
use crate::session::Session;
use crate::verification::{Sight, Verdict, region_of};

/// Seconds that each stage is shown when playing.
const SECONDS_PER_STAGE: f32 = 1.2;

/// What the verifier has said so far.
pub enum Verification {
    /// There is nothing to verify.
    Nothing,
    /// It is at work.
    Pending(Job<Result<Verdict, VerifyError>>),
    /// It has judged.
    Done(Box<Verdict>),
    /// It gave no verdict, and why.
    Failed(String),
}

/// Something the user should read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// Sentences.
    pub text: String,
    /// Whether something went wrong.
    pub is_error: bool,
}

/// The state of the window.
pub struct State {
    /// The parameters as typed.
    pub draft: Draft,
    /// Who samples.
    pub engine: Engine,
    /// What is known of the GPU.
    pub device: Device,
    /// What is being looked at; stays until the next one is ready.
    pub session: Option<Arc<Session>>,
    /// The run at work.
    pub sampling: Option<Job<Result<Session, SampleError>>>,
    /// What the verifier says about the session.
    pub verification: Verification,
    /// The stage shown, as its place in the session's list.
    pub stage: usize,
    /// Seconds left until the next stage, while playing.
    pub playing: Option<f32>,
    /// The layers shown.
    pub layers: Layers,
    /// What the colour of samples means.
    pub colouring: Colouring,
    /// Light or dark.
    pub theme: Theme,
    /// The view.
    pub camera: Camera,
    /// Where the camera is flying to.
    pub flight: Option<Flight>,
    /// Where the canvas is in the window.
    pub viewport: Rect,
    /// The sample under the pointer.
    pub hovered: Option<u32>,
    /// The selected sample.
    pub selected: Option<u32>,
    /// The place that a verdict was followed to.
    pub sight: Option<Sight>,
    /// The export sheet, when open.
    pub export: Option<ExportForm>,
    /// A notice, when there is one.
    pub notice: Option<Notice>,
    /// The export at work.
    #[cfg(not(target_arch = "wasm32"))]
    pub exporting: Option<Job<Result<tilescope_formats::Exported, tilescope_formats::ExportError>>>,
    /// The system's file dialog, while open.
    #[cfg(not(target_arch = "wasm32"))]
    pub browsing: Option<Job<Option<std::path::PathBuf>>>,
    /// Whether the whole domain is shown, and stays so when the window changes.
    fitted: bool,
    /// While the pattern, which has a domain of its own, is shown: the camera to return to, and
    /// whether it was fitted.
    before_pattern: Option<(Camera, bool)>,
    /// Part of the name of the adapter to open; the fastest, if not given.
    adapter: Option<String>,
    generation: u64,
    wake: Wake,
}

impl State {
    /// Returns the state of a window that has just opened: the default session is being sampled.
    #[must_use]
    pub fn new(wake: Wake) -> Self {
        let mut state = Self {
            draft: Draft::default(),
            engine: Engine::default(),
            device: Device::default(),
            session: None,
            sampling: None,
            verification: Verification::Nothing,
            stage: 0,
            playing: None,
            layers: Layers::default(),
            colouring: Colouring::default(),
            theme: Theme::Dark,
            camera: Camera::default(),
            flight: None,
            viewport: Rect::NOTHING,
            hovered: None,
            selected: None,
            sight: None,
            export: None,
            notice: None,
            #[cfg(not(target_arch = "wasm32"))]
            exporting: None,
            #[cfg(not(target_arch = "wasm32"))]
            browsing: None,
            fitted: true,
            before_pattern: None,
            adapter: None,
            generation: 0,
            wake,
        };
        state.apply(Command::Run);
        state
    }

    /// Returns the stage shown.
    #[must_use]
    pub fn current_stage(&self) -> Option<Stage> {
        self.session.as_ref()?.stages.get(self.stage).copied()
    }

    /// Returns the verdict, once there is one.
    #[must_use]
    pub fn verdict(&self) -> Option<&Verdict> {
        match &self.verification {
            Verification::Done(verdict) => Some(verdict),
            _ => None,
        }
    }

    /// Returns why the draft cannot be run now, or `None` if it can.
    #[must_use]
    pub fn run_refusal(&self) -> Option<String> {
        let refusal = self.draft.refusals().into_iter().next();
        let waiting = || match self.device {
            Device::Testing(_) if self.engine == Engine::Gpu => self.device.said(),
            _ => None,
        };
        refusal.map(|refusal| refusal.reason).or_else(waiting)
    }

    /// Carries out a command: the only way in which the state changes for a user.
    pub fn apply(&mut self, command: Command) {
        self.carry_out(command);
        self.follow_pattern();
    }

    fn carry_out(&mut self, command: Command) {
        match command {
            Command::Type(field, text) => self.draft.set_text(field, text),
            Command::Choose(choice) => self.draft.choose(choice),
            Command::ResetParameters => self.draft = Draft::default(),
            Command::Engine(engine) => self.choose_engine(engine),
            Command::NameAdapter(name) => self.name_adapter(name),
            Command::Run => self.run(),
            Command::Cancel => {
                if let Some(job) = &self.sampling {
                    job.cancel();
                }
            }
            Command::ToggleLayer(layer) => self.layers.toggle(layer),
            Command::Colour(colouring) => self.colouring = colouring,
            Command::ToggleTheme => {
                self.theme = match self.theme {
                    Theme::Dark => Theme::Light,
                    Theme::Light => Theme::Dark,
                }
            }
            Command::Hover(id) => self.hovered = id,
            Command::Select(id) => self.selected = id,
            Command::DismissNotice => self.notice = None,
            Command::ShowStage(_)
            | Command::StepBack
            | Command::StepForward
            | Command::FirstStage
            | Command::LastStage
            | Command::TogglePlay => self.apply_to_clock(&command),
            Command::Viewport(_)
            | Command::Pan(_)
            | Command::Zoom(..)
            | Command::Fit
            | Command::FlyTo(..)
            | Command::FlyToWitness(_)
            | Command::GoToSample(_) => self.apply_to_camera(&command),
            Command::OpenExport
            | Command::CloseExport
            | Command::ExportPath(_)
            | Command::ExportPrecision(_)
            | Command::BrowseExport
            | Command::Export => self.apply_to_export(command),
        }
    }

    fn apply_to_clock(&mut self, command: &Command) {
        let Some(session) = &self.session else {
            return;
        };
        let last = session.stages.len() - 1;
        match *command {
            Command::ShowStage(place) => self.stage = place.min(last),
            Command::StepBack => self.stage = self.stage.saturating_sub(1),
            Command::StepForward => self.stage = (self.stage + 1).min(last),
            Command::FirstStage => self.stage = 0,
            Command::LastStage => self.stage = last,
            Command::TogglePlay if self.playing.is_some() => self.playing = None,
            Command::TogglePlay => {
                if self.stage == last {
                    self.stage = 0;
                }
                self.playing = Some(SECONDS_PER_STAGE);
            }
            _ => {}
        }
        self.forget_unseen();
    }

    fn apply_to_camera(&mut self, command: &Command) {
        match *command {
            Command::Viewport(rect) => {
                self.viewport = rect;
                if self.fitted && self.session.is_some() {
                    self.camera = self.fitting();
                    self.flight = None;
                }
            }
            Command::Pan(delta) => {
                (self.flight, self.fitted) = (None, false);
                self.camera.pan(delta);
            }
            Command::Zoom(pos, factor) => {
                (self.flight, self.fitted) = (None, false);
                self.camera.zoom_about(self.viewport, pos, factor);
            }
            Command::Fit => {
                self.sight = None;
                self.fitted = true;
                self.flight = Some(Flight::new(self.camera, self.fitting()));
            }
            Command::FlyTo(center, radii) => self.fly_to(center, radii),
            Command::FlyToWitness(witness) => self.fly_to_witness(witness),
            Command::GoToSample(id) => {
                self.selected = Some(id);
                if let Some(session) = &self.session {
                    let center = session.place(id);
                    self.fly_to(center, 12.0);
                }
            }
            _ => {}
        }
    }

    fn fitting(&self) -> Camera {
        let on_pattern = self.current_stage() == Some(Stage::Pattern);
        let size = self.session.as_ref().map_or([1.0; 2], |session| {
            if on_pattern {
                // Its user unit is one radius.
                session.run.pattern.domain().size()
            } else {
                session.size_radii()
            }
        });
        Camera::fitting(size, self.viewport)
    }

    /// Fits the pattern when it comes into view, and returns to where the camera was afterwards.
    fn follow_pattern(&mut self) {
        let on_pattern = self.current_stage() == Some(Stage::Pattern);
        match (on_pattern, self.before_pattern) {
            (true, None) => {
                self.before_pattern = Some((self.camera, self.fitted));
                (self.flight, self.fitted) = (None, true);
                self.camera = self.fitting();
            }
            (false, Some((camera, fitted))) => {
                self.before_pattern = None;
                if self.flight.is_none() {
                    self.fitted = fitted;
                    self.camera = if fitted { self.fitting() } else { camera };
                }
            }
            _ => {}
        }
    }

    fn fly_to(&mut self, center: [f64; 2], radii: f64) {
        self.fitted = false;
        let room = f64::from(self.viewport.size().min_elem().max(1.0));
        let to = Camera {
            center,
            scale: room / radii,
        };
        self.flight = Some(Flight::new(self.camera, to));
    }

    fn fly_to_witness(&mut self, witness: Witness) {
        let (Some(session), Some(verdict)) = (&self.session, self.verdict()) else {
            return;
        };
        let Some(sight) = verdict.sight(witness, session) else {
            return;
        };
        let center = match sight {
            Sight::Circle(center, _) => center,
            Sight::Pair([a, b], _) => {
                let from = session.place(a);
                let to = session.image_near(b, from);
                [0, 1].map(|k| f64::midpoint(from[k], to[k]))
            }
        };
        // The verdict is about the result.
        self.stage = session.stages.len() - 1;
        self.sight = Some(sight);
        self.fly_to(center, 9.0);
    }

    fn apply_to_export(&mut self, command: Command) {
        match command {
            Command::OpenExport => {
                self.export.get_or_insert_default();
            }
            Command::CloseExport => self.export = None,
            Command::ExportPath(path) => {
                if let Some(form) = &mut self.export {
                    form.path = path;
                }
            }
            Command::ExportPrecision(precision) => {
                if let Some(form) = &mut self.export {
                    form.precision = precision;
                }
            }
            #[cfg(not(target_arch = "wasm32"))]
            Command::BrowseExport => {
                if let Some(form) = &self.export {
                    self.browsing = Some(crate::export::browse(form, &self.wake));
                }
            }
            #[cfg(not(target_arch = "wasm32"))]
            Command::Export => self.start_export(),
            _ => {}
        }
    }

    #[cfg(not(target_arch = "wasm32"))]
    fn start_export(&mut self) {
        if let (Some(form), Some(session)) = (self.export.clone(), self.session.clone()) {
            let work = move |monitor: &crate::jobs::Monitor| {
                crate::export::write(&session, &form, monitor)
            };
            self.exporting = Some(Job::start(&self.wake, work));
        }
    }

    fn run(&mut self) {
        if self.run_refusal().is_some() {
            return;
        }
        self.generation += 1;
        self.notice = None;
        self.start_sampling(self.generation);
    }

    /// Goes on by `dt_secs`: takes what jobs have finished, moves the camera, plays. Returns whether
    /// something is moving, so that another frame is due.
    pub fn advance(&mut self, dt_secs: f32) -> bool {
        self.poll();
        if let Some(flight) = &mut self.flight {
            let (camera, arrived) = flight.advance(dt_secs);
            self.camera = camera;
            if arrived {
                self.flight = None;
            }
        }
        if let Some(left) = &mut self.playing {
            *left -= dt_secs;
            if *left <= 0.0 {
                self.play_on();
            }
        }
        self.flight.is_some() || self.playing.is_some()
    }

    fn play_on(&mut self) {
        self.apply(Command::StepForward);
        let last = self.session.as_ref().map_or(0, |s| s.stages.len() - 1);
        self.playing = (self.stage < last).then_some(SECONDS_PER_STAGE);
    }

    fn poll(&mut self) {
        if let Device::Testing(job) = &self.device
            && let Some(outcome) = job.poll()
        {
            self.finish_test(outcome);
        }
        if let Some(outcome) = self.sampling.as_ref().and_then(Job::poll) {
            self.finish_sampling(outcome);
        }
        if let Verification::Pending(job) = &self.verification
            && let Some(outcome) = job.poll()
        {
            self.finish_verification(outcome);
        }
        #[cfg(not(target_arch = "wasm32"))]
        self.poll_export();
    }

    fn finish_sampling(&mut self, outcome: Result<Result<Session, SampleError>, String>) {
        self.sampling = None;
        match outcome {
            Ok(Ok(session)) => self.show_made(session),
            Ok(Err(SampleError::Cancelled { stage })) => {
                let kept = if self.session.is_some() {
                    " The session before it is still here."
                } else {
                    ""
                };
                self.tell(format!("Cancelled during stage \"{stage}\".{kept}"), false);
            }
            Ok(Err(error)) => self.tell(sentence(&error.to_string()), true),
            Err(failure) => self.tell(sentence(&failure), true),
        }
    }

    /// Shows a session at its last stage and has it verified.
    pub fn show(&mut self, session: Session) {
        let same_domain = self.session.as_ref().is_some_and(|old| {
            old.run.domain.width() == session.run.domain.width()
                && old.run.domain.height() == session.run.domain.height()
        });
        self.stage = session.stages.len() - 1;
        (self.hovered, self.selected, self.sight) = (None, None, None);
        self.playing = None;
        let session = Arc::new(session);
        self.session = Some(Arc::clone(&session));
        self.verification = Verification::Pending(Job::start(&self.wake, move |monitor| {
            let (points, region) = (session.run.positions(), region_of(&session));
            Verdict::of(&points, region, session.run.domain.radius(), monitor)
        }));
        let from_pattern = self.before_pattern.take().is_some();
        if !same_domain || from_pattern {
            self.fitted = true;
            self.flight = None;
            if self.viewport.is_positive() {
                self.camera = self.fitting();
            }
        }
    }

    fn finish_verification(&mut self, outcome: Result<Result<Verdict, VerifyError>, String>) {
        self.verification = match outcome {
            Ok(Ok(verdict)) => Verification::Done(Box::new(verdict)),
            Ok(Err(error)) => Verification::Failed(sentence(&error.to_string())),
            Err(failure) => Verification::Failed(sentence(&failure)),
        };
    }

    #[cfg(not(target_arch = "wasm32"))]
    fn poll_export(&mut self) {
        if let Some(outcome) = self.browsing.as_ref().and_then(Job::poll) {
            self.browsing = None;
            match outcome {
                Ok(Some(path)) => {
                    self.apply(Command::ExportPath(path.to_string_lossy().into_owned()));
                }
                Ok(None) => {}
                Err(failure) => self.tell(sentence(&failure), true),
            }
        }
        if let Some(outcome) = self.exporting.as_ref().and_then(Job::poll) {
            self.exporting = None;
            self.finish_export(outcome);
        }
    }

    #[cfg(not(target_arch = "wasm32"))]
    fn finish_export(
        &mut self,
        outcome: Result<
            Result<tilescope_formats::Exported, tilescope_formats::ExportError>,
            String,
        >,
    ) {
        match outcome {
            Ok(Ok(exported)) => {
                let mut text = format!(
                    "Wrote {} to {}. Certificate: {}.",
                    crate::sentence::counted(exported.report.count, "sample", "samples"),
                    exported.path.display(),
                    exported.certificate_path.display(),
                );
                for warning in &exported.warnings {
                    text.push(' ');
                    text.push_str(&sentence(&warning.to_string()));
                }
                self.export = None;
                self.tell(text, !exported.report.valid());
            }
            Ok(Err(error)) => {
                let text = format!("Nothing was exported: {error}");
                self.tell(sentence(&text), true);
            }
            Err(failure) => self.tell(sentence(&failure), true),
        }
    }

    fn tell(&mut self, text: String, is_error: bool) {
        self.notice = Some(Notice { text, is_error });
    }

    /// A sample that does not exist yet at the stage shown is not pointed at.
    fn forget_unseen(&mut self) {
        let (Some(session), Some(stage)) = (&self.session, self.current_stage()) else {
            return;
        };
        let seen = |id: &u32| session.exists(*id, stage);
        self.hovered = self.hovered.filter(seen);
        self.selected = self.selected.filter(seen);
        if stage != Stage::Finish {
            self.sight = None;
        }
    }

    /// Waits for all work in the background and takes its results. For tests and scripts: a window
    /// calls [`Self::advance`] with every frame.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn settle(&mut self) {
        self.settle_device();
        if let Some(job) = self.sampling.take() {
            let outcome = job.wait();
            self.finish_sampling(outcome);
        }
        if let Verification::Pending(job) = &self.verification {
            let outcome = job.wait();
            self.finish_verification(outcome);
        }
        if let Some(job) = self.exporting.take() {
            let outcome = job.wait();
            self.finish_export(outcome);
        }
    }
}

mod engine;
#[cfg(test)]
mod tests;
