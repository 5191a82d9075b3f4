//! Everything the window shows, and the one place where commands change it. It knows no widgets: tests
//! drive it without a window.

use std::sync::Arc;

use egui::Rect;
use tilescope_core::Stage;
use tilescope_debugger::{Debugger, Direction, OutlineRows, Stops};

use crate::actions::Palette;
use crate::analysis::Analysis;
use crate::arrangement::Drawer;
use crate::camera::{Camera, Flight};
use crate::canvas::layers::{Colouring, Layers};
use crate::clock::Playback;
use crate::command::Command;
use crate::compare::Comparison;
use crate::device::{Device, Engine};
use crate::draft::Draft;
use crate::embedding::Embedding;
use crate::export::ExportForm;
use crate::files::{Delivery, FileForm, NamedBytes};
use crate::geometry::Geometry;
use crate::jobs::{Job, Wake};
use crate::layout::Layout;
use crate::passes::Passes;
use crate::recipe::OwnPattern;
use crate::session::{MakeError, Session};
use crate::theme::Look;
use crate::verification::{Sight, Verdict};
pub use debug::{EventQuery, Found, MOST_FOUND};
#[cfg(test)]
pub(crate) use engine::MOST_ON_A_PAGE as MOST_PASSES_ON_A_PAGE;
pub use hits::{Hits, MOST_HITS};
pub use page::PageStart;
pub use side::Side;

/// What the verifier has said so far.
pub enum Verification {
    /// There is nothing to verify.
    Nothing,
    /// It is at work.
    Pending(Job<Result<Verdict, String>>),
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

/// Whether the window may have the full screen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FullScreen {
    /// It may.
    #[default]
    Free,
    /// It is to have it now, or to give it back.
    Asked,
    /// It may not, and why.
    Refused(&'static str),
}

impl FullScreen {
    /// Returns why the window may not have it, if so.
    #[must_use]
    pub const fn refusal(self) -> Option<&'static str> {
        match self {
            Self::Refused(why) => Some(why),
            Self::Free | Self::Asked => None,
        }
    }
}

/// The state of the window.
pub struct State {
    /// The parameters as typed.
    pub draft: Draft,
    /// The pattern of one's own for the next run, if it comes from a file.
    pub own_pattern: Option<OwnPattern>,
    /// Who samples.
    pub engine: Engine,
    /// Why the GPU that was to sample does not.
    pub gpu_failure: Option<String>,
    /// The way in which a breakpoint is being looked for.
    continuing: Option<Direction>,
    /// What is known of the GPU.
    pub device: Device,
    /// What draws the window, where it is not always the same: on a page. There a GPU that passed its test samples without
    /// being chosen.
    display: Option<String>,
    /// What is being looked at; stays until the next one is ready.
    pub session: Option<Arc<Session>>,
    /// The run at work.
    pub sampling: Option<Job<Result<Session, MakeError>>>,
    /// What the verifier says about the session.
    pub verification: Verification,
    /// The stage shown, as its place in the session's list.
    pub stage: usize,
    /// The events of the session and the cursor among them, where they were kept.
    pub debugger: Option<Debugger>,
    /// What the user has set for debugging, while there are no events to debug.
    stops: Stops,
    /// What the event browser shows of the tree.
    pub rows: Option<OutlineRows>,
    /// The cursor to which the event browser was opened last.
    revealed: usize,
    /// The passes of the session's parameters on the GPU, once they were asked for.
    pub passes: Option<Passes>,
    /// The second run, and what is known of the two together.
    pub comparison: Option<(Side, Comparison)>,
    /// What is measured of the moment.
    pub analysis: Analysis,
    /// How time runs.
    pub playback: Playback,
    /// Where the breakpoints would stop a run.
    pub hits: Hits,
    /// What the event browser looks for.
    pub query: EventQuery,
    /// The triangulation of the moment.
    pub geometry: Geometry,
    /// The history of what is selected.
    pub history_found: Found,
    /// The layers shown.
    pub layers: Layers,
    /// What the colour of samples means.
    pub colouring: Colouring,
    /// Light, dark or for a projector; [`Self::choose_look`] changes it.
    pub look: Look,
    /// The look to which the projector mode returns.
    look_before: Look,
    /// Whether the bar on top is left out, as where the window is part of something else.
    pub bare: bool,
    /// Whether the window may have the full screen.
    pub full_screen: FullScreen,
    /// Whether the camera jumps instead of flying.
    pub reduced_motion: bool,
    /// What the user chose of that; the system's wish counts otherwise.
    motion_chosen: Option<bool>,
    /// Where the panels stand.
    pub layout: Layout,
    /// What a window shows that is too small for them.
    pub drawer: Drawer,
    /// The list of all actions, when open.
    pub palette: Option<Palette>,
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
    /// The selected place, in r.
    pub place: Option<[f64; 2]>,
    /// The place that a verdict was followed to.
    pub sight: Option<Sight>,
    /// The export sheet, when open.
    pub export: Option<ExportForm>,
    /// The sheet of saved sessions and pattern files, when open.
    pub file: Option<FileForm>,
    /// What is read or written for it.
    pub filing: Option<crate::files::Filing>,
    /// The system's dialog for it, while open.
    #[cfg(not(target_arch = "wasm32"))]
    pub finding: Option<(crate::files::Purpose, Job<Option<std::path::PathBuf>>)>,
    /// The dialog of the browser for it, and the reading of what was chosen.
    #[cfg(target_arch = "wasm32")]
    pub finding: Option<(crate::files::Purpose, Job<crate::files::web::Found>)>,
    /// Where files go that are written.
    pub delivery: Delivery,
    /// Files that are to be downloaded.
    downloads: Vec<NamedBytes>,
    /// The file that the session was saved to or opened from last.
    pub session_path: Option<String>,
    /// How many frames the animation of the sheet has.
    frames: Option<crate::export::frames::Count>,
    /// A notice, when there is one.
    pub notice: Option<Notice>,
    /// The address of the page, without a fragment, to which copied links belong. There is none natively.
    pub link_base: Option<String>,
    /// What is to be put on the clipboard.
    pub copied: Option<String>,
    /// What of the window is left where it is part of another page.
    pub embedding: Option<Embedding>,
    /// A link whose run is being made.
    arriving: Option<Box<link::Arriving>>,
    /// What a screen reader should say.
    announcer: announce::Announcer,
    /// The export at work.
    pub exporting: Option<Job<export::Outcome>>,
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
    history: undo::History,
    wake: Wake,
}

impl State {
    /// Returns the state of a window that has just opened: the default session is being sampled.
    #[must_use]
    pub fn new(wake: Wake) -> Self {
        let mut state = Self {
            draft: Draft::default(),
            own_pattern: None,
            engine: Engine::default(),
            device: Device::default(),
            display: None,
            session: None,
            sampling: None,
            verification: Verification::Nothing,
            stage: 0,
            debugger: None,
            stops: Stops::default(),
            rows: None,
            revealed: 0,
            passes: None,
            comparison: None,
            analysis: Analysis::default(),
            playback: Playback::default(),
            hits: Hits::default(),
            query: EventQuery::default(),
            geometry: Geometry::default(),
            history_found: Found::default(),
            layers: Layers::default(),
            colouring: Colouring::default(),
            look: Look::Dark,
            look_before: Look::Dark,
            bare: false,
            full_screen: FullScreen::default(),
            reduced_motion: false,
            motion_chosen: None,
            layout: Layout::default(),
            drawer: Drawer::default(),
            palette: None,
            camera: Camera::default(),
            gpu_failure: None,
            continuing: None,
            flight: None,
            viewport: Rect::NOTHING,
            hovered: None,
            selected: None,
            place: None,
            sight: None,
            export: None,
            file: None,
            session_path: None,
            filing: None,
            finding: None,
            delivery: Delivery::default(),
            downloads: Vec::new(),
            frames: None,
            notice: None,
            link_base: None,
            copied: None,
            embedding: None,
            arriving: None,
            announcer: announce::Announcer::default(),
            exporting: None,
            #[cfg(not(target_arch = "wasm32"))]
            browsing: None,
            fitted: true,
            before_pattern: None,
            adapter: None,
            generation: 0,
            history: undo::History::default(),
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
        match command {
            Command::Undo => self.undo(),
            Command::Redo => self.redo(),
            command => match undo::concerns(&command) {
                Some(part) => {
                    let before = self.memento();
                    let remembered = command.clone();
                    self.carry_out(command);
                    self.remember(before, part, Some(&remembered));
                }
                None => self.carry_out(command),
            },
        }
        self.follow_first();
        self.follow_passes();
    }

    fn carry_out(&mut self, command: Command) {
        match command {
            Command::Type(field, text) => self.draft.set_text(field, text),
            Command::Choose(choice) => self.draft.choose(choice),
            Command::ResetParameters => {
                self.draft = Draft::default();
                self.own_pattern = None;
            }
            Command::Engine(engine) => self.choose_engine(engine),
            Command::NameAdapter(name) => self.name_adapter(name),
            Command::Run => self.run(),
            Command::Combine(command) => self.combine(command),
            Command::Cancel => {
                if let Some(job) = &self.sampling {
                    job.cancel();
                }
            }
            Command::ToggleLayer(layer) => self.layers.toggle(layer),
            Command::Colour(colouring) => self.colouring = colouring,
            Command::Hover(id) => self.hovered = id,
            Command::DismissNotice => self.notice = None,
            Command::ToggleTheme => self.choose_look(self.look.other()),
            Command::Look(look) => self.choose_look(look),
            Command::ToggleProjector if self.look == Look::Projector => {
                self.choose_look(self.look_before);
            }
            Command::ToggleProjector => self.choose_look(Look::Projector),
            Command::ToggleFullScreen => self.full_screen = FullScreen::Asked,
            Command::ToggleReducedMotion => self.toggle_reduced_motion(),
            Command::OpenPanel(panel) => self.open_panel(panel),
            Command::Inspect => self.inspect(),
            Command::Drawer(command) => self.apply_to_drawer(command),
            Command::ResetLayout => self.layout = Layout::default(),
            Command::Undo | Command::Redo => {}
            Command::TogglePalette
            | Command::ClosePalette
            | Command::PaletteText(_)
            | Command::PaletteChoice(_) => self.apply_to_palette(command),
            Command::OpenPasses => self.open_passes(),
            Command::Passes(command) => self.apply_to_passes(command),
            Command::File(command) => self.apply_to_files(command),
            Command::Compare(command) => self.apply_to_comparison(command),
            Command::Analysis(command) => self.apply_to_analysis(command),
            Command::Debug(command) => {
                let before = self.stage;
                self.apply_to_debugger(command);
                self.follow_cursor();
                self.moved(before);
            }
            Command::ShowStage(_)
            | Command::StepBack
            | Command::StepForward
            | Command::FirstStage
            | Command::LastStage
            | Command::TogglePlay
            | Command::Time(_) => self.apply_to_clock(&command),
            Command::Viewport(_)
            | Command::Pan(_)
            | Command::Zoom(..)
            | Command::SelectMiddle
            | Command::Fit
            | Command::FlyTo(..)
            | Command::FlyToBlock(_)
            | Command::GoToCurrent
            | Command::FlyToWitness(_)
            | Command::GoToSample(_) => self.apply_to_camera(&command),
            Command::Export(command) => self.apply_to_export(command),
            Command::CopyLink => self.copy_link(),
            Command::OpenLink(text) => self.open_link(&text),
        }
    }

    pub(super) fn tell(&mut self, text: String, is_error: bool) {
        self.notice = Some(Notice { text, is_error });
    }
}

mod analysis;
mod announce;
mod camera;
mod combine;
mod compare;
pub(crate) mod debug;
mod engine;
pub(crate) mod export;
mod files;
pub(crate) mod hits;
mod link;
mod page;
mod remote;
mod side;
#[cfg(test)]
mod tests;
mod time;
mod undo;
mod view;
mod work;
