//! Every action of the window in one list: menus, shortcuts and the Ctrl+K palette are made from it and issue the same
//! commands. An action that is unavailable carries the reason. Begin with `Action`; each menu's actions are in a file
//! of its name.

mod analyze;
mod compare;
mod file;
mod go;
mod keys;
mod lessons;
mod talk;

use std::sync::LazyLock;

use egui::{Key, KeyboardShortcut, Modifiers, vec2};

pub use keys::{keys_of, press_keys, takes_key};
use tilescope_debugger::Direction;
use tilescope_session::layers::{Colouring, Layer};
use tilescope_session::limits::MAX_STAGED;
use tilescope_session::look::Look;
use tilescope_session::selection::Selection;
use tilescope_session::words::grouped;
use tilescope_ui::widgets::Kebab;
use tilescope_workbench::analysis::AnalysisCommand;
use tilescope_workbench::arrangement::DrawerCommand;
use tilescope_workbench::command::{
    AppearanceCommand, Command, DebugCommand, FormCommand, ViewCommand, Which, WindowCommand,
};
use tilescope_workbench::finder::Finder;
use tilescope_workbench::help::HelpPage;
use tilescope_workbench::layout::Panel;
use tilescope_workbench::scenes::{SceneCommand, SceneList};
use tilescope_workbench::state::{RunView, State, Time};

/// The menus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Menu {
    /// Files.
    File,
    /// Undo, parameters, selection.
    Edit,
    /// Panels, layers, looks, camera.
    View,
    /// Time.
    Go,
    /// Breakpoints, scenes, causes.
    Debug,
    /// Measures of the moment.
    Analyze,
    /// The second run.
    Compare,
    /// Keys, terms, the program.
    Help,
}

impl Menu {
    /// Every menu.
    pub const ALL: [Self; 8] = [
        Self::File,
        Self::Edit,
        Self::View,
        Self::Go,
        Self::Debug,
        Self::Analyze,
        Self::Compare,
        Self::Help,
    ];

    /// Returns its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::File => "File",
            Self::Edit => "Edit",
            Self::View => "View",
            Self::Go => "Go",
            Self::Debug => "Debug",
            Self::Analyze => "Analyze",
            Self::Compare => "Compare",
            Self::Help => "Help",
        }
    }
}

/// The submenus.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Submenu {
    /// Moving and zooming by steps.
    Camera,
    /// The panels.
    Panels,
    /// The layers of the canvas.
    Layers,
    /// What colours stand for.
    Colours,
    /// Themes and motion.
    Look,
    /// The scenes.
    Scenes,
    /// What a tick is.
    Ticks,
    /// Stepping backwards.
    Backwards,
    /// Running backwards.
    Previous,
    /// Repeating a part of the run.
    Loop,
    /// What a run can be compared with.
    Presets,
}

impl Submenu {
    /// Returns its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Camera => "Move and zoom",
            Self::Panels => "Panels",
            Self::Layers => "Layers",
            Self::Colours => "Colours",
            Self::Look => "Look",
            Self::Scenes => "Scenes",
            Self::Ticks => "Step by",
            Self::Backwards => "Step backwards",
            Self::Previous => "Run backwards to",
            Self::Loop => "Loop",
            Self::Presets => "Compare with",
        }
    }
}

/// An action.
#[derive(Clone, Debug)]
pub struct Action {
    /// Its menu.
    pub menu: Menu,
    /// Its name.
    pub name: String,
    /// Its shortcut.
    pub shortcut: Option<KeyboardShortcut>,
    /// An alternative shortcut.
    pub also: Option<KeyboardShortcut>,
    /// The command it issues.
    pub command: Command,
    /// Why it is unavailable, if it is.
    pub refusal: Option<String>,
    /// The submenu that it is in, if any.
    pub submenu: Option<Submenu>,
    /// Whether a line separates it from the actions before it.
    pub begins_group: bool,
    /// Whether what it switches is on; `None` for other actions.
    pub is_on: Option<bool>,
}

/// Returns the actions whose names contain every typed word; names that begin with the text come first.
#[must_use]
pub fn found(finder: &Finder, state: &State) -> Vec<Action> {
    let text = finder.text.trim().to_lowercase();
    let fits = |action: &Action| {
        let name = format!("{} {}", action.menu.name(), action.name).to_lowercase();
        text.split_whitespace().all(|word| name.contains(word))
    };
    let mut found: Vec<Action> = actions(state).into_iter().filter(fits).collect();
    found.sort_by_key(|action| !action.name.to_lowercase().starts_with(&text));
    found
}

const NO_SESSION: &str = "There is no session yet.";
static NO_EVENTS: LazyLock<String> = LazyLock::new(|| {
    let most = grouped(MAX_STAGED as usize);
    format!(
        "This session was made without events: runs of more than {most} samples keep their result alone."
    )
});

/// Returns why what is shown has no events, if it has none.
fn no_events(state: &State) -> Option<&'static str> {
    match &state.runs.first {
        run if run.debugger.is_some() => None,
        run if run.session.is_none() => Some(NO_SESSION),
        _ if state.shows_combination() => {
            Some("A combination has stages but no events: its sets were there before.")
        }
        _ => Some(NO_EVENTS.as_str()),
    }
}

/// Returns every action, with its current name and availability.
#[must_use]
pub fn actions(state: &State) -> Vec<Action> {
    let mut list = List::default();
    file::add(&mut list, state);
    edit(&mut list, state);
    view(&mut list, state);
    go::add(&mut list, state);
    debug(&mut list, state);
    analyze::add(&mut list, state);
    compare::compare(&mut list, state);
    lessons::add(&mut list, state);
    talk::add(&mut list, state);
    help(&mut list);
    lessons::lead(&mut list, state);
    list.escape(state);
    talk::lead(&mut list, state);
    list.actions
}

#[derive(Default)]
struct List {
    actions: Vec<Action>,
    /// The submenu of the actions that are added next.
    submenu: Option<Submenu>,
    /// Whether the next action begins a group.
    begins_group: bool,
}

impl List {
    fn add(
        &mut self,
        menu: Menu,
        name: impl Into<String>,
        keys: Option<(Modifiers, Key)>,
        command: Command,
        refusal: Option<&str>,
    ) {
        self.actions.push(Action {
            menu,
            name: name.into(),
            shortcut: keys.map(|(modifiers, key)| KeyboardShortcut::new(modifiers, key)),
            also: None,
            command,
            refusal: refusal.map(str::to_owned),
            submenu: self.submenu,
            begins_group: std::mem::take(&mut self.begins_group),
            is_on: None,
        });
    }

    /// Begins a group: a line separates the next action from those before it.
    const fn group(&mut self) {
        self.begins_group = true;
    }

    /// Marks the action added last as a switch that is on or off.
    fn mark(&mut self, is_on: bool) {
        if let Some(action) = self.actions.last_mut() {
            action.is_on = Some(is_on);
        }
    }

    /// Adds actions to a submenu.
    fn within(&mut self, submenu: Submenu, add: impl FnOnce(&mut Self)) {
        self.submenu = Some(submenu);
        add(self);
        self.submenu = None;
    }
}

impl Action {
    /// Returns its id, which does not change with its name.
    #[must_use]
    pub fn id(&self) -> Kebab<(Menu, &Command)> {
        Kebab((self.menu, &self.command))
    }

    /// Returns its name within its menu: in a submenu, what follows the colon.
    #[must_use]
    pub fn label(&self) -> &str {
        match self.name.split_once(": ") {
            Some((_, label)) if self.submenu.is_some() => label,
            _ => &self.name,
        }
    }

    /// Returns its shortcuts.
    pub fn keys(&self) -> impl Iterator<Item = KeyboardShortcut> {
        self.shortcut.into_iter().chain(self.also)
    }
}

impl List {
    /// Gives Escape to the action that closes or leaves what was entered last.
    fn escape(&mut self, state: &State) {
        let projector = state
            .appearance
            .look
            .is_projector()
            .then_some(Command::Appearance(AppearanceCommand::ToggleProjector));
        let caption = state.scene.map(|_| Command::Scene(SceneCommand::Leave));
        let ways = [
            Command::View(Which::First, ViewCommand::Pick(Selection::Nothing)),
            Command::Analysis(AnalysisCommand::Brush(None)),
            Command::Window(WindowCommand::Drawer(DrawerCommand::Show(None))),
        ];
        for way in caption.into_iter().chain(ways).chain(projector) {
            let is_way = |action: &&mut Action| action.command == way && action.refusal.is_none();
            if let Some(action) = self.actions.iter_mut().find(is_way) {
                let key = match action.shortcut {
                    Some(_) => &mut action.also,
                    None => &mut action.shortcut,
                };
                *key = Some(KeyboardShortcut::new(NONE, Key::Escape));
                break;
            }
        }
    }
}

const COMMAND: Modifiers = Modifiers::COMMAND;
const SHIFT: Modifiers = Modifiers::SHIFT;
const NONE: Modifiers = Modifiers::NONE;

fn edit(list: &mut List, state: &State) {
    let mut add = |name: &str, keys, command, refusal: Option<&str>| {
        list.add(Menu::Edit, name, keys, command, refusal);
    };
    let no_past = (!state.can_undo()).then_some("Nothing was changed yet.");
    let no_future = (!state.can_redo()).then_some("Nothing was undone.");
    add("Undo", Some((COMMAND, Key::Z)), Command::Undo, no_past);
    add(
        "Redo",
        Some((COMMAND | SHIFT, Key::Z)),
        Command::Redo,
        no_future,
    );
    add(
        "Reset parameters",
        None,
        Command::Form(FormCommand::Reset),
        None,
    );
    let nothing = (state.runs.first.selected.is_none() && state.runs.first.place.is_none())
        .then_some("Nothing is selected.");
    let no_session = state.runs.first.session.is_none().then_some(NO_SESSION);
    list.group();
    list.add(
        Menu::Edit,
        "Select at the centre of the view",
        Some((NONE, Key::M)),
        Command::View(Which::First, ViewCommand::SelectMiddle),
        no_session,
    );
    let deselect = Command::View(Which::First, ViewCommand::Pick(Selection::Nothing));
    list.add(Menu::Edit, "Deselect", None, deselect, nothing);
    list.group();
    list.add(
        Menu::Edit,
        "All actions\u{2026}",
        Some((COMMAND, Key::K)),
        Command::Window(WindowCommand::ToggleFinder),
        None,
    );
}

fn help(list: &mut List) {
    list.add(
        Menu::Help,
        "Tour",
        None,
        Command::Scene(SceneCommand::Tour),
        None,
    );
    for page in HelpPage::ALL {
        let keys = (page == HelpPage::Keys).then_some((NONE, Key::Questionmark));
        let command = Command::Window(WindowCommand::Help(page));
        list.add(Menu::Help, page.name(), keys, command, None);
    }
}

/// Adds the scenes. In the tour the space key, which plays otherwise, goes on.
fn scenes(list: &mut List, state: &State) {
    let has_scenes = state.scene.is_some() || !state.scenes(SceneList::Own).is_empty();
    let no_scenes = (!has_scenes).then_some("There are no scenes: B makes one.");
    let step = |direction| Command::Scene(SceneCommand::Step(direction));
    let mut add = |name: &str, key, command, refusal| {
        list.add(Menu::View, name, key, command, refusal);
    };
    let key = |key| Some((NONE, key));
    let add_scene = Command::Scene(SceneCommand::Add);
    add(
        "Make a scene of this moment",
        key(Key::B),
        add_scene,
        no_events(state),
    );
    add(
        "Next scene",
        key(Key::PageDown),
        step(Direction::Forwards),
        no_scenes,
    );
    add(
        "Previous scene",
        key(Key::PageUp),
        step(Direction::Backwards),
        no_scenes,
    );
    let next = step(Direction::Forwards);
    if state.is_touring()
        && let Some(next) = list
            .actions
            .iter_mut()
            .find(|action| action.command == next)
    {
        next.also = Some(KeyboardShortcut::new(NONE, Key::Space));
    }
    if state.scene.is_some() {
        let leave = Command::Scene(SceneCommand::Leave);
        list.add(Menu::View, "Close the scene's caption", None, leave, None);
    }
}

/// Returns the name of the action that enters the projector mode or leaves it.
#[must_use]
pub const fn projector_action(look: Look) -> &'static str {
    match look {
        Look::Projector | Look::ProjectorDark => "Leave the projector mode",
        Look::Dark | Look::Light => Look::Projector.name(),
    }
}

fn view(list: &mut List, state: &State) {
    let mut add = |name: &str, key, command| {
        let command = Command::View(Which::First, command);
        list.add(Menu::View, name, Some((NONE, key)), command, None);
    };
    add("Fit the domain", Key::F, ViewCommand::Fit);
    add(
        "Show the current event",
        Key::Period,
        ViewCommand::GoToCurrent,
    );
    let follow = Command::Appearance(AppearanceCommand::ToggleFollow);
    let keys = Some((SHIFT, Key::F));
    list.add(
        Menu::View,
        "Follow the events with the camera",
        keys,
        follow,
        None,
    );
    list.mark(state.appearance.follows_events);
    list.within(Submenu::Camera, |list| camera(list, state));
    list.group();
    list.within(Submenu::Panels, |list| panels(list, state));
    list.within(Submenu::Layers, |list| layers(list, state));
    list.within(Submenu::Colours, |list| colours(list, state));
    list.within(Submenu::Look, |list| look(list, state));
    list.within(Submenu::Scenes, |list| scenes(list, state));
    list.group();
    list.add(
        Menu::View,
        "Full screen",
        Some((Modifiers::ALT, Key::Enter)),
        Command::Window(WindowCommand::ToggleFullScreen),
        state.window.full_screen.refusal(),
    );
    if let Some(is_full) = state.window.is_full {
        list.mark(is_full);
    }
    if state.window.drawer.arrangement.is_compact() {
        let drawer = &state.window.drawer;
        let no_panel = drawer.open.is_none().then_some("No panel is open.");
        let close = Command::Window(WindowCommand::Drawer(DrawerCommand::Show(None)));
        list.add(Menu::View, "Close the panel", None, close, no_panel);
    }
}

/// Returns the keys that show and hide a panel.
const fn panel_keys(panel: Panel) -> Option<(Modifiers, Key)> {
    Some(match panel {
        Panel::Parameters => (NONE, Key::Num1),
        Panel::Inspector => (NONE, Key::Num2),
        Panel::Pseudocode => (NONE, Key::Num3),
        Panel::Statistics => (NONE, Key::Num4),
        Panel::Verification => (NONE, Key::Num5),
        Panel::Events => (NONE, Key::Num6),
        Panel::Scenes => (NONE, Key::Num7),
        Panel::Watches => (NONE, Key::Num8),
        Panel::Compare => (NONE, Key::Num9),
        Panel::Legend => (NONE, Key::Num0),
        Panel::Timeline => (SHIFT, Key::F4),
        // The analysis has a key in its menu.
        Panel::Canvas | Panel::Analysis | Panel::Passes => return None,
    })
}

/// Adds the panels: what is visible is hidden, all else is brought into view.
fn panels(list: &mut List, state: &State) {
    let window = &state.window;
    let no_panels = state
        .appearance
        .look
        .is_projector()
        .then_some("The projector mode shows no panels: F2 leaves it.");
    for panel in Panel::all() {
        let (name, keys) = (panel.name(), panel_keys(panel));
        let (name, command) = if window.can_hide(panel) {
            let name = format!("Hide the panel: {name}");
            (name, WindowCommand::HidePanel(panel))
        } else {
            let name = format!("Panel: {name}");
            (name, WindowCommand::OpenPanel(panel))
        };
        let refusal = no_panels.filter(|_| panel != Panel::Analysis);
        list.add(Menu::View, name, keys, Command::Window(command), refusal);
        list.mark(window.shows(panel));
    }
    list.group();
    if !window.drawer.arrangement.is_compact() {
        let name = if window.shows_sides() {
            "Hide the side panels"
        } else {
            "Show the side panels"
        };
        let keys = Some((NONE, Key::F4));
        let sides = Command::Window(WindowCommand::ToggleSides);
        list.add(Menu::View, name, keys, sides, no_panels);
    }
    let reset = Command::Window(WindowCommand::ResetLayout);
    list.add(Menu::View, "Reset layout", None, reset, None);
}

/// Adds the layers of the canvas.
fn layers(list: &mut List, state: &State) {
    let automatic = Command::Appearance(AppearanceCommand::AutomaticLayers);
    let keys = Some((NONE, Key::T));
    list.add(Menu::View, "Layers: automatic", keys, automatic, None);
    list.mark(state.appearance.chosen_layers.is_none());
    list.group();
    let shown = state.appearance.layers(state.current_stage());
    for layer in Layer::ALL {
        let command = Command::Appearance(AppearanceCommand::ToggleLayer(layer));
        let name = format!("Layer: {}", layer.name());
        list.add(Menu::View, name, None, command, None);
        list.mark(shown.has(layer));
    }
}

/// Adds what the colour of samples can stand for.
fn colours(list: &mut List, state: &State) {
    for (name, colouring) in [
        ("Colour by block", Colouring::Block),
        ("Colour by origin", Colouring::Provenance),
        ("Colour by age", Colouring::Age),
    ] {
        let command = Command::Appearance(AppearanceCommand::Colour(colouring));
        list.add(Menu::View, name, None, command, None);
        list.mark(state.appearance.colouring == colouring);
    }
}

/// Adds themes and motion.
fn look(list: &mut List, state: &State) {
    let shown = state.appearance.look;
    let theme = |list: &mut List, look: Look| {
        let command = Command::Appearance(AppearanceCommand::Look(look));
        list.add(Menu::View, look.name(), None, command, None);
        list.mark(shown == look);
    };
    theme(list, Look::Dark);
    theme(list, Look::Light);
    let projector = Command::Appearance(AppearanceCommand::ToggleProjector);
    let keys = Some((NONE, Key::F2));
    list.add(Menu::View, projector_action(shown), keys, projector, None);
    list.mark(shown.is_projector());
    theme(list, Look::ProjectorDark);
    list.group();
    let motion = Command::Appearance(AppearanceCommand::ToggleReducedMotion);
    list.add(Menu::View, "Reduced motion", None, motion, None);
    list.mark(state.appearance.reduced_motion);
}

/// How far a key pans the view, in screen points.
const PAN: f32 = 80.0;

/// Adds the camera's actions, for the keyboard.
fn camera(list: &mut List, state: &State) {
    let no_session = state.runs.first.session.is_none().then_some(NO_SESSION);
    for (name, key, delta) in [
        ("Move the view left", Key::ArrowLeft, vec2(PAN, 0.0)),
        ("Move the view right", Key::ArrowRight, vec2(-PAN, 0.0)),
        ("Move the view up", Key::ArrowUp, vec2(0.0, PAN)),
        ("Move the view down", Key::ArrowDown, vec2(0.0, -PAN)),
    ] {
        let keys = Some((SHIFT, key));
        let command = Command::View(Which::First, ViewCommand::Pan(delta));
        list.add(Menu::View, name, keys, command, no_session);
    }
    list.group();
    let middle = state.runs.first.viewport.center();
    for (name, key, factor) in [("Zoom in", Key::Plus, 1.25), ("Zoom out", Key::Minus, 0.8)] {
        let command = Command::View(Which::First, ViewCommand::Zoom(middle, factor));
        list.add(Menu::View, name, Some((NONE, key)), command, no_session);
    }
}

/// Returns why time cannot go forwards, and why it cannot go backwards, if so.
#[must_use]
pub fn time_refusals(run: &RunView, time: &Time) -> [Option<&'static str>; 2] {
    let Some(session) = &run.session else {
        return [Some(NO_SESSION); 2];
    };
    let (at, last) = time
        .pass_tick(run)
        .or_else(|| run.cursor())
        .unwrap_or((run.stage, session.stages.len() - 1));
    [
        (at == last).then_some("This is the end of the run."),
        (at == 0).then_some("This is the start of the run."),
    ]
}

fn debug(list: &mut List, state: &State) {
    let debugger = state.runs.first.debugger.as_ref();
    let no_events = no_events(state);
    if let Some(debugger) = debugger
        && let Some(event) = debugger.event()
    {
        let line = event.line();
        list.add(
            Menu::Debug,
            "Breakpoint on the next line",
            Some((NONE, Key::F9)),
            Command::Debug(DebugCommand::ToggleBreakpoint(line)),
            None,
        );
        let breakpoints = debugger.breakpoints();
        list.mark(breakpoints.iter().any(|there| there.line == line));
    }
    let mut add = |name: &str, keys, command, refusal: Option<&str>| {
        list.add(Menu::Debug, name, keys, Command::Debug(command), refusal);
    };
    let at_start = state.cursor().is_some_and(|(at, _)| at == 0);
    let no_cause = at_start.then_some("Nothing has happened yet.");
    add(
        "Why? Go to the cause of the last event",
        Some((NONE, Key::W)),
        DebugCommand::Why,
        no_events.or(no_cause),
    );
    list.group();
    let mut add = |name: &str, keys, command| {
        list.add(Menu::Debug, name, keys, Command::Debug(command), no_events);
    };
    let sample = DebugCommand::Watch("p".to_owned());
    add("Watch the current sample", None, sample);
}
