//! The egui application: each frame it shows the panels, collects commands and applies them to the state. Tiles that are
//! dragged change the layout directly; everything else changes by commands. Begin with [`App::show`]. The two windows of a
//! talk are in `app/stage.rs`.

use std::sync::Arc;

use eframe::egui_wgpu::RenderState;
use egui::{CentralPanel, Context, Frame, Pos2, Ui, UiBuilder, ViewportCommand};
use egui_tiles::{Behavior, EditAction, SimplificationOptions, TileId, Tiles, UiResponse};
use tilescope_session::look::Look;
use tilescope_ui::focus;
use tilescope_ui::language::{self, Worded};
use tilescope_ui::presses::Presses;
use tilescope_ui::spoken::{Speaker, Spoken};
use tilescope_ui::theme::{self, InputStyle};
use tilescope_ui::widgets::{Kebab, Known};

#[cfg(not(target_arch = "wasm32"))]
use crate::kept::KeptFolder;
use crate::panes::Canvas;
use crate::{actions, panels, settings, tiles};
use tilescope_canvas::touch::release_cancelled;
use tilescope_workbench::arrangement::{Arrangement, DrawerCommand};
use tilescope_workbench::command::{Command, WindowCommand};
use tilescope_workbench::embedding::Embedding;
use tilescope_workbench::files::FileCommand;
use tilescope_workbench::files::MAX_RECENT;
use tilescope_workbench::layout::{Layout, Panel};
use tilescope_workbench::scenes::SceneCommand;
use tilescope_workbench::state::{FrameStart, Settings, State};

pub use stage::stage_accent;

use stage::Stage;

/// The application: the state of the workbench, and all that the window itself keeps between frames.
pub struct App {
    /// The state of the workbench.
    pub state: State,
    canvas: Canvas,
    commands: Vec<Command>,
    shown_look: Look,
    shown_input_style: InputStyle,
    /// The widget that had the focus in the previous frame.
    focused: Option<egui::Id>,
    /// The windows of a talk.
    stage: Stage,
    /// Copies a text to the clipboard and returns true, or returns false to leave it to egui.
    copier: fn(&str) -> bool,
    /// Toggles full screen and returns true, or returns false to leave it to egui.
    full_screen_turner: fn() -> bool,
    /// The folder for results and for the last session, which must not be lost; `None` in tests.
    #[cfg(not(target_arch = "wasm32"))]
    kept: Option<KeptFolder>,
    /// The text of the last session as this window has written it.
    #[cfg(not(target_arch = "wasm32"))]
    kept_session: Option<String>,
    #[cfg(not(target_arch = "wasm32"))]
    closing: closing::Closing,
    /// Files dropped on the page that are being read.
    #[cfg(target_arch = "wasm32")]
    dropped: Option<tilescope_session::jobs::Job<tilescope_workbench::files::web::ReadFiles>>,
}

impl App {
    /// Creates the application for a window with the context `ctx`; the default session starts.
    #[must_use]
    pub fn new(ctx: &Context) -> Self {
        let waker = ctx.clone();
        let mut state = State::new(Arc::new(move || waker.request_repaint()));
        // Whether the window is full is known with its first frame.
        state.begin_frame(FrameStart {
            now: now(),
            is_full: None,
        });

        theme::install(ctx, state.appearance().look);
        // A slow frame may hold a whole click or drag, which egui would misplace.
        ctx.add_plugin(Presses::default());

        Self {
            shown_look: state.appearance().look,
            shown_input_style: InputStyle::default(),
            state,
            canvas: Canvas::default(),
            commands: Vec::new(),
            focused: None,
            stage: Stage::default(),
            // A page replaces these two functions. Elsewhere they return false, and egui does the work.
            copier: |_| false,
            full_screen_turner: || false,
            #[cfg(not(target_arch = "wasm32"))]
            kept: None,
            #[cfg(not(target_arch = "wasm32"))]
            kept_session: None,
            #[cfg(not(target_arch = "wasm32"))]
            closing: closing::Closing::default(),
            #[cfg(target_arch = "wasm32")]
            dropped: None,
        }
    }

    /// Uses `copier` to copy texts to the clipboard; where it returns false, egui does so, without reporting failures.
    pub fn copy_with(&mut self, copier: fn(&str) -> bool) {
        self.copier = copier;
    }

    /// Passes announcements about the focus to `callback`, for screen readers.
    pub fn speak_to(ctx: &Context, callback: impl Fn(&Spoken) + Send + Sync + 'static) {
        ctx.add_plugin(Speaker::new(callback));
    }

    /// Returns whether a drag by one finger at this position is left to the surrounding page: on the canvas of an
    /// embedded window, where one finger only taps.
    #[must_use]
    pub fn scrolls_at(&self, ctx: &Context, pos: Pos2) -> bool {
        let is_below = |layer: egui::LayerId| layer.order == egui::Order::Background;
        self.state.window().embedding.is_some()
            && self.state.runs().first.viewport.contains(pos)
            && ctx.layer_id_at(pos).is_none_or(is_below)
    }

    /// Uses `full_screen_turner` to toggle full screen; where it returns false, egui does.
    pub fn turn_full_screen_with(&mut self, full_screen_turner: fn() -> bool) {
        self.full_screen_turner = full_screen_turner;
    }

    /// From now on draws samples by instancing on the window's device in `render_state`.
    pub fn draw_with(&mut self, render_state: &RenderState) {
        self.canvas.draw_with(render_state);
    }

    /// Shows one frame: advances the state, shows the panels and carries out the commands that they issue.
    pub fn show(&mut self, ui: &mut Ui) {
        // The time is read once for each frame, so that everything that moves shows the same moment.
        self.state.begin_frame(FrameStart {
            now: now(),
            is_full: ui.input(|input| input.viewport().fullscreen),
        });
        language::speak(ui.ctx(), self.state.lessons().shown_language());

        // The lesson takes its side of the window first: the room that is left decides how the panels are arranged.
        if self.state.window().embedding.is_none() && self.state.talks().open.is_none() {
            panels::lesson::show(ui, &self.state, &mut self.commands);
        }
        self.arrange(ui);
        self.follow_look(ui.ctx());

        let dt = ui.input(|i| i.stable_dt);
        // Something moves: play, a flight of the camera, or a picture that follows work in the background.
        if self.state.advance(dt) {
            ui.ctx().request_repaint();
        }
        self.follow_requests(ui.ctx());

        if self.state.talks().open.is_some() {
            // A talk has its windows to itself, without panels, menus and sheets.
            return self.show_talk(ui);
        }
        self.leave_stage(ui.ctx());

        // An embedded window has nothing to show a dropped file in.
        if self.state.window().embedding.is_none() {
            self.take_dropped(ui);
        }
        self.take_keys(ui);
        self.show_panels(ui);

        // While the run plays, values change in every frame: announcing each would drown everything else.
        let is_playing = self.state.time().playback.is_playing();
        ui.ctx()
            .with_plugin(|speaker: &mut Speaker| speaker.is_playing = is_playing);
        focus::ring(
            ui.ctx(),
            tilescope_drawing::palette::Palette::of(self.state.appearance().look),
        );
        self.follow_focus(ui.ctx());
        self.apply_commands(ui.ctx());
    }

    /// Carries out the actions whose keys were pressed, so that the panels of this frame show what they did.
    fn take_keys(&mut self, ui: &Ui) {
        let window = self.state.window();
        let is_covered =
            window.finder.is_some() || window.help.is_some() || self.state.files().has_sheet();
        // Left and right step through time, unless something that covers the window needs them.
        focus::keep_arrows(ui.ctx(), is_covered);
        if actions::press_keys(ui.ctx(), &mut self.state) {
            self.follow_commands(ui.ctx());
        }
    }

    /// Shows the panels as they are arranged in a window of this size and look.
    fn show_panels(&mut self, ui: &mut Ui) {
        if let Some(embedding) = self.embedding() {
            // A lesson beside the canvas has issued commands already. Of them those are kept that a window in the frame
            // of a page may carry out (`in_frame`): the others open what this part of the window does not show. Files
            // that were dropped on a small window with a lesson are kept, too.
            let takes_files = self.state.window().embedding.is_none();
            let stays = |command: &Command| {
                command.rules().in_frame || takes_files && matches!(command, Command::File(_))
            };
            self.commands.retain(stays);
            panels::show_embedded(
                ui,
                embedding,
                &self.state,
                &mut self.canvas,
                &mut self.commands,
            );
            // The canvas has issued commands since: a long press, for instance, would open a panel.
            self.commands.retain(stays);
        // A small window shows one panel at a time in every look: the projector mode needs more room.
        } else if self.state.window().drawer.arrangement.is_compact() {
            panels::compact::show(ui, &self.state, &mut self.canvas, &mut self.commands);
        } else if self.state.appearance().look.is_projector() {
            panels::show_projector(ui, &self.state, &mut self.canvas, &mut self.commands);
        } else {
            if !self.state.window().bare {
                panels::show_bars(ui, &self.state, &mut self.commands);
            }
            self.show_tiles(ui);
        }

        if self.state.window().embedding.is_none() {
            panels::show_floating(ui, &self.state, &mut self.commands);
        }
    }

    /// Returns the part of the window that is shown, if not all of it: as embedded in another page, and beside a lesson
    /// where there is no room for panels.
    fn embedding(&self) -> Option<Embedding> {
        let is_small =
            self.state.window().drawer.arrangement.is_compact() || self.state.lessons().on_page;
        let is_lesson = self.state.lessons().open.is_some() && is_small;
        let player = is_lesson.then_some(Embedding::Player);
        self.state.window().embedding.or(player)
    }

    /// Requests another frame when the focus has moved: a page accepts text only then.
    fn follow_focus(&mut self, ctx: &Context) {
        let focused = ctx.memory(egui::Memory::focused);
        if focused != self.focused {
            self.focused = focused;
            ctx.request_repaint();
        }
    }

    /// Opens files that were dropped on the page, once they are read.
    #[cfg(target_arch = "wasm32")]
    fn take_dropped(&mut self, ui: &Ui) {
        let dropped = ui.input(|input| input.raw.dropped_files.clone());
        if !dropped.is_empty() {
            let waker = ui.ctx().clone();
            let wake: tilescope_session::jobs::Wake = Arc::new(move || waker.request_repaint());
            let files = (dropped.iter())
                .filter_map(|file| file.web_file().cloned())
                .collect();
            self.dropped = Some(tilescope_workbench::files::web::take(files, &wake));
        }

        // The browser reads files in the background, so that they come in a later frame.
        let read = self
            .dropped
            .as_ref()
            .and_then(tilescope_session::jobs::Job::poll);
        if let Some(outcome) = read {
            self.dropped = None;
            let found = outcome.unwrap_or_else(|why| tilescope_workbench::files::web::ReadFiles {
                refused: vec![why],
                ..Default::default()
            });
            let command = FileCommand::DroppedBytes(found.files, found.refused);
            self.commands.push(Command::File(command));
        }
    }

    /// From now on keeps results and the last session in a folder; takes the results that are in it, and offers the session
    /// if the window opens with the default session (`is_default`) rather than with a link or a command.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn keep_in(&mut self, folder: KeptFolder, is_default: bool) {
        if let Some(results) = folder.results() {
            self.state.take_results(&results);
        }
        if is_default && let Ok(text) = std::fs::read_to_string(folder.last_session()) {
            self.state.restore(Settings {
                last_session: Some(text),
                ..Settings::default()
            });
        }
        self.kept = Some(folder);
    }

    /// Stores the results of lessons, if there are new ones.
    #[cfg(not(target_arch = "wasm32"))]
    fn keep_results(&mut self) {
        let state = &mut self.state;
        if let Some(kept) = &self.kept
            && state.lessons().has_unstored_results()
            && let Err(text) = kept.store_results(|stored| state.store_results(stored))
        {
            state.report(text);
        }
    }

    /// Opens files that were dropped on the window.
    #[cfg(not(target_arch = "wasm32"))]
    fn take_dropped(&mut self, ui: &Ui) {
        let dropped = ui.input(|input| input.raw.dropped_files.clone());
        let paths: Vec<String> = dropped
            .iter()
            .map(|file| file.path().to_string_lossy().into_owned())
            .collect();
        if !paths.is_empty() {
            self.commands
                .push(Command::File(FileCommand::Dropped(paths)));
        }
    }

    /// Shows the panels as tiles, and changes the layout where the user dragged them.
    fn show_tiles(&mut self, ui: &mut Ui) {
        let before = &self.state.window().layout;
        let mut layout = before.clone();

        let (room, around) = (ui.available_size(), [GAP, TAB_BAR]);
        // Panels get their least sizes in a copy of the layout, so that a small window does not change the shares that the
        // user has chosen.
        let timeline = panels::timeline_height(ui.ctx(), &self.state, room.x);
        layout.enlarge(room, around, |panel| panels::least_size(panel, timeline));

        let mut tree = tiles::tree(&layout);
        let mut shower = Shower {
            ctx: ui.ctx().clone(),
            state: &self.state,
            canvas: &mut self.canvas,
            commands: &mut self.commands,
            edited: false,
            moved: false,
            // A whole layout has the tabs of all panels: less padding leaves room for more of them in a row.
            spacing: if layout.is_whole() { 4.0 } else { 6.0 },
        };
        CentralPanel::no_frame().frame(Frame::new()).show(ui, |ui| {
            tree.ui(&mut shower, ui);
            focus::name_tiles(ui);
        });

        let (edited, moved) = (shower.edited, shower.moved);
        // Only what the user dragged changes the layout.
        if edited {
            // Dragging the last panel out of a row of tabs leaves the row empty.
            tree.simplify(&shower.simplification_options());
            // Where nothing was resized, the shares are those from before the panels got their least sizes.
            let kept = tiles::with_shares_of(tree, &tiles::tree(before), &tiles::tree(&layout));
            // A layout that lacks panels was made for a part of a window, and stays as it was made.
            if let Some(layout) = tiles::layout(&kept).filter(Layout::is_whole) {
                self.state.replace_layout(layout, moved);
            }
        }
    }

    /// Does what the state asks the window for.
    fn follow_requests(&mut self, ctx: &Context) {
        let requests = self.state.take_requests();
        // A page copies by a function of its own. Where that returns false, egui copies.
        if let Some(text) = requests.copied
            && !(self.copier)(&text)
        {
            ctx.copy_text(text);
        }
        if requests.turns_full_screen && !(self.full_screen_turner)() {
            let is_full = ctx.input(|input| input.viewport().fullscreen == Some(true));
            ctx.send_viewport_cmd(ViewportCommand::Fullscreen(!is_full));
        }
        if requests.quits {
            ctx.send_viewport_cmd(ViewportCommand::Close);
        }

        #[cfg(target_arch = "wasm32")]
        for file in requests.downloads {
            if let Err(text) = tilescope_workbench::download::start(&file) {
                self.state.report(text);
            }
        }
        // Detached: the window must not wait until the system's file manager is closed.
        #[cfg(not(target_arch = "wasm32"))]
        if let Some(folder) = requests.folder
            && let Err(error) = open::that_detached(&folder)
        {
            let folder = folder.display();
            self.state
                .report(format!("{folder} cannot be opened: {error}."));
        }
    }

    fn apply_commands(&mut self, ctx: &Context) {
        if self.commands.is_empty() {
            return;
        }
        for command in self.commands.drain(..) {
            self.state.apply(command);
        }
        self.follow_commands(ctx);
    }

    /// Carries out commands that concern the window itself.
    fn follow_commands(&mut self, ctx: &Context) {
        self.follow_requests(ctx);
        self.follow_look(ctx);
        ctx.request_repaint();
    }

    /// Arranges the panels for the window's size. A layout that lacks panels was made for a part of a window, and is shown as it
    /// is.
    fn arrange(&mut self, ui: &Ui) {
        let mut size = ui.available_size();
        // The projector mode enlarges points, so that a window has fewer of them. The arrangement is chosen by the window's size
        // without that enlargement.
        if self.state.appearance().look.is_projector() {
            size *= ui.ctx().zoom_factor();
        }

        let lessons = self.state.lessons();
        let look = self.state.appearance().look;
        // A layout is whole if every panel occurs once in it, shown or hidden.
        let arrangement = if self.state.window().layout.is_whole() {
            if lessons.open.is_some() || lessons.shows_list {
                Arrangement::beside_lesson(size, look)
            } else {
                Arrangement::of(size, look)
            }
        } else {
            Arrangement::Tiles
        };

        if arrangement != self.state.window().drawer.arrangement {
            let command = DrawerCommand::Arrange(arrangement);
            self.state
                .apply(Command::Window(WindowCommand::Drawer(command)));
        }
    }

    /// Applies the look, and the style for fingers and for less motion, if one of them has changed.
    fn follow_look(&mut self, ctx: &Context) {
        let is_compact = self.state.window().drawer.arrangement.is_compact();
        let input_style = InputStyle {
            // A window too small for tiles is taken for that of a phone, and so for fingers. Chosen, not measured.
            touch: is_compact,
            still: self.state.appearance().reduced_motion,
        };

        let look = self.state.appearance().look;
        // Restyling lays the whole window out anew.
        if (self.shown_look, self.shown_input_style) == (look, input_style) {
            return;
        }

        theme::restyle(ctx, look, input_style);
        // A small window has no room for the projector's larger type.
        let zoom = |look: Look, is_small| if is_small { 1.0 } else { look.zoom() };
        let (zoom_before, zoom_now) = (
            // The style was for touch exactly if the window was small.
            zoom(self.shown_look, self.shown_input_style.touch),
            zoom(look, is_compact),
        );

        // A zoom that does not change is not set, since the stage of a talk, for instance, may have set another one.
        if zoom_before.to_bits() != zoom_now.to_bits() {
            ctx.set_zoom_factor(zoom_now);
        }
        (self.shown_look, self.shown_input_style) = (look, input_style);
        ctx.request_repaint();
    }

    /// Restores the settings of an earlier use of the program. Without one the tour begins, if the window opens with the
    /// default session (`is_default`) rather than with a link or a command.
    pub fn remember(&mut self, storage: &dyn eframe::Storage, is_default: bool) {
        // Every use stores these two settings.
        let has = |key| storage.get_string(key).is_some();
        if is_default && ![LAYOUT_KEY, LOOK_KEY].into_iter().any(has) {
            self.state.apply(Command::Scene(SceneCommand::Tour));
        }

        // A page does not read files by their paths.
        let is_native = cfg!(not(target_arch = "wasm32"));
        let listed = storage.get_string(RECENT_KEY).filter(|_| is_native);
        let paths = |listed: String| listed.lines().map(str::to_owned).take(MAX_RECENT).collect();

        // The look is stored together with the choice of reduced motion.
        let (look, reduced_motion) = settings::get_value(storage, LOOK_KEY).unzip();
        self.state.restore(Settings {
            layout: settings::get_value(storage, LAYOUT_KEY),
            recent: listed.map(paths),
            look,
            reduced_motion,
            ..Settings::default()
        });
    }
}

/// Returns the time in seconds since 1970.
#[cfg(not(target_arch = "wasm32"))]
fn now() -> f64 {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    since.map_or(0.0, |since| since.as_secs_f64())
}

/// Returns the time in seconds since 1970.
#[cfg(target_arch = "wasm32")]
fn now() -> f64 {
    js_sys::Date::now() / 1000.0
}

/// Gap between tiles, in screen points.
const GAP: f32 = 2.0;
/// Height of a row of tabs above a tile.
const TAB_BAR: f32 = 27.0;

const LAYOUT_KEY: &str = "panels";
const LOOK_KEY: &str = "look";
/// The paths of the files that were opened or saved last, each in a line.
const RECENT_KEY: &str = "recent";

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        #[cfg(not(target_arch = "wasm32"))]
        self.find_other_screen(ui.ctx(), frame);
        #[cfg(target_arch = "wasm32")]
        let _ = frame;
        self.show(ui);
        #[cfg(not(target_arch = "wasm32"))]
        self.keep_results();
        #[cfg(not(target_arch = "wasm32"))]
        self.follow_closing(ui.ctx());
    }

    /// Stores the layout, the look and the recent files, and the session in its folder.
    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        settings::set_value(
            storage,
            LAYOUT_KEY,
            self.state.past().layout_to_store(self.state.window()),
        );
        let look = (
            self.state.appearance().look,
            // The system's wish for less motion is no choice of the user, and is not stored.
            self.state.appearance().motion_chosen(),
        );
        settings::set_value(storage, LOOK_KEY, &look);
        // A page does not read files by their paths, and has no folder to keep a session in.
        #[cfg(not(target_arch = "wasm32"))]
        storage.set_string(RECENT_KEY, self.state.files().recent.join("\n"));
        #[cfg(not(target_arch = "wasm32"))]
        self.keep_session();
    }

    fn raw_input_hook(&mut self, _: &Context, raw: &mut egui::RawInput) {
        release_cancelled(raw);
    }

    /// Not restored: egui's widget sizes follow from the layout.
    fn persist_egui_memory(&self) -> bool {
        false
    }
}

/// Frames for which a new tab is scrolled into view: the scroll buttons of its row appear with a delay.
const TAB_FRAMES: u8 = 4;

/// Shows the contents of each tile.
struct Shower<'a> {
    ctx: Context,
    state: &'a State,
    canvas: &'a mut Canvas,
    commands: &'a mut Vec<Command>,
    edited: bool,
    /// Whether a panel was moved.
    moved: bool,
    /// Padding beside the title of a tab, in screen points.
    spacing: f32,
}

impl Behavior<Panel> for Shower<'_> {
    fn pane_ui(&mut self, ui: &mut Ui, _: TileId, panel: &mut Panel) -> UiResponse {
        // egui's memory of a panel is keyed by the panel, so that it moves with it between tiles.
        let own = UiBuilder::new().scope_id(egui::Id::unique("panel").with(*panel));
        ui.scope_builder(own, |ui| {
            panels::show_panel(ui, *panel, self.state, self.canvas, self.commands);
        });
        UiResponse::None
    }

    fn tab_title_for_pane(&mut self, panel: &Panel) -> egui::WidgetText {
        self.ctx.words(panel.name()).into()
    }

    fn simplification_options(&self) -> SimplificationOptions {
        SimplificationOptions {
            // A row of tabs stays when one panel is left in it, with the tab by which that panel is dragged.
            prune_single_child_tabs: false,
            ..SimplificationOptions::default()
        }
    }

    /// Gives a tab its id and its menu, and scrolls to the tab of a panel that has come forward.
    fn on_tab_button(
        &mut self,
        _: &mut Tiles<Panel>,
        tile: TileId,
        button: egui::Response,
    ) -> egui::Response {
        // The tab of a row or column of panels has no menu.
        let Some(panel) = tiles::panel_of(tile) else {
            return button;
        };

        button.known_as(format_args!("tab.{}", Kebab(panel)));
        // The canvas cannot be hidden.
        if panel != Panel::Canvas {
            button.context_menu(|ui| {
                let hide = ui.button(ui.words(format!("Hide {}", panel.name())));
                hide.known_as(format_args!("tab.{}.hide", Kebab(panel)));
                if hide.clicked() {
                    let command = WindowCommand::HidePanel(panel);
                    self.commands.push(Command::Window(command));
                    ui.close();
                }
            });
        }

        // The number of frames since the panel came forward, up to `TAB_FRAMES`, is kept under this id.
        let id = egui::Id::unique("seen tab").with(tile);
        // A panel behind another tab is counted anew, so that its tab is scrolled to when the panel comes forward again.
        if !self.state.window().layout.shows(panel) {
            button.ctx.data_mut(|data| data.remove::<u8>(id));
            return button;
        }

        let seen_frames = (button.ctx)
            .data(|data| data.get_temp::<u8>(id))
            .unwrap_or_default();
        if seen_frames < TAB_FRAMES {
            let counted = seen_frames + 1;
            button.ctx.data_mut(|data| data.insert_temp(id, counted));
            button.scroll_to_me_animation(None, egui::style::ScrollAnimation::none());
            button.ctx.request_repaint();
        }
        button
    }

    fn on_edit(&mut self, action: EditAction) {
        // A drag that has just begun has not changed anything yet.
        self.edited |= action != EditAction::TileDragged;
        self.moved |= action == EditAction::TileDropped;
    }

    fn gap_width(&self, _: &egui::Style) -> f32 {
        GAP
    }

    fn tab_title_spacing(&self, _: &egui::Visuals) -> f32 {
        self.spacing
    }

    fn tab_bar_height(&self, _: &egui::Style) -> f32 {
        TAB_BAR
    }

    fn tab_bar_color(&self, _: &egui::Visuals) -> egui::Color32 {
        tilescope_drawing::palette::Palette::of(self.state.appearance().look).outside
    }
}

#[cfg(not(target_arch = "wasm32"))]
mod closing;
mod stage;
#[cfg(test)]
mod tests;
