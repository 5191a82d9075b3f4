//! Every action of the window in one list: menus, shortcuts and the list of actions (Ctrl+K) are made from it and issue
//! the same commands. An action that is unavailable has the reason. Begin with [`Action`] and [`actions`]; the actions of
//! a menu are in the file of its name, those of Edit, View, Debug and Help below. To add one, add it where its menu is
//! filled; what its command does is in the workbench.

mod analyze;
mod compare;
mod file;
mod go;
mod keys;
mod lessons;
mod talk;

use std::sync::LazyLock;

use egui::{Key, KeyboardShortcut, Modifiers, vec2};

pub use keys::{keys_of, press_keys, shortcut_text, takes_key};
use tilescope_classroom::room::HIDDEN_LAYER;
use tilescope_debugger::{Direction, Listings};
use tilescope_session::layers::{Colouring, Layer, SessionKind};
use tilescope_session::limits::MAX_STAGED;
use tilescope_session::look::Look;
use tilescope_session::selection::Selection;
use tilescope_session::words::grouped;
use tilescope_ui::widgets::Kebab;
use tilescope_workbench::analysis::AnalysisCommand;
use tilescope_workbench::arrangement::DrawerCommand;
use tilescope_workbench::command::{
    AppearanceCommand, Brush, Command, DebugCommand, FormCommand, PaintCommand, TimeCommand,
    ViewCommand, Which, WindowCommand,
};
use tilescope_workbench::curve::CurveNumber;
use tilescope_workbench::finder::Finder;
use tilescope_workbench::help::HelpPage;
use tilescope_workbench::layout::Panel;
use tilescope_workbench::orbit::OrbitCommand;
use tilescope_workbench::scenes::{SceneCommand, SceneList};
use tilescope_workbench::state::{NO_PLANE, RunView, State, Time, is_taught, no_side_by_side};

/// A menu of the menu bar.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Menu {
    /// Runs, sessions, patterns, links and exports.
    #[default]
    File,
    /// Undo, parameters and the selection.
    Edit,
    /// Panels, layers, looks, camera and scenes.
    View,
    /// Playing, stepping and running through time.
    Go,
    /// Breakpoints, watches and the causes of events.
    Debug,
    /// The measures of the moment.
    Analyze,
    /// The second run, and how the two differ.
    Compare,
    /// Keys, terms, lessons and the program.
    Help,
}

impl Menu {
    /// Every menu, in the order of the menu bar.
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

    /// Returns the name in the menu bar.
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

/// A submenu, which opens beside its entry in a menu.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Submenu {
    /// The files that were opened or saved last.
    Recent,
    /// Moving and zooming by steps.
    Camera,
    /// The panels, each to be shown.
    Panels,
    /// The panels in view, each to be hidden.
    HidePanel,
    /// The layers of the canvas.
    Layers,
    /// The meanings of colours.
    Colours,
    /// The numbers that can be drawn over the events.
    Curve,
    /// Looks, and less motion.
    Look,
    /// Going through the scenes.
    Scenes,
    /// The length of a tick of the clock.
    Ticks,
    /// Stepping backwards by the debugger's steps.
    Backwards,
    /// Running backwards to events.
    Previous,
    /// The breakpoints that are set.
    Breakpoints,
    /// Repeating a part of the run.
    Loop,
    /// The runs to compare with.
    Presets,
}

impl Submenu {
    /// Returns the name in the menu that it is in.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Recent => "Recent files",
            Self::Camera => "Move and zoom",
            Self::Panels => "Panels",
            Self::HidePanel => "Hide a panel",
            Self::Layers => "Layers",
            Self::Colours => "Colours",
            Self::Curve => "Curve of the run",
            Self::Look => "Look",
            Self::Scenes => "Scenes",
            Self::Ticks => "Step by",
            Self::Backwards => "Step backwards",
            Self::Previous => "Run backwards to",
            Self::Breakpoints => "Breakpoints",
            Self::Loop => "Loop",
            Self::Presets => "Compare with",
        }
    }
}

/// An action of the window: a command, with its name, its keys and its position in the menus.
#[derive(Clone, Debug)]
pub struct Action {
    /// The menu that lists it.
    pub menu: Menu,
    /// Its name in the list of all actions.
    pub name: String,
    /// The shortcut that is shown beside it.
    pub shortcut: Option<KeyboardShortcut>,
    /// A second shortcut for the same.
    pub also: Option<KeyboardShortcut>,
    /// The command it issues.
    pub command: Command,
    /// Why it is unavailable, if it is.
    pub refusal: Option<String>,
    /// The submenu that it is in, if any.
    pub submenu: Option<Submenu>,
    /// Whether a line separates it from the actions before it.
    pub begins_group: bool,
    /// Of a switch, whether it is on.
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
    // The sort is stable, so that the others keep the order of the menus.
    found.sort_by_key(|action| !action.name.to_lowercase().starts_with(&text));
    found
}

const NO_SESSION: &str = "There is no session yet.";

/// Returns why nothing can be done with the first run before it is made.
fn no_session(state: &State) -> Option<&'static str> {
    state.runs().first.session.is_none().then_some(NO_SESSION)
}

static NO_EVENTS: LazyLock<String> = LazyLock::new(|| {
    let most = grouped(MAX_STAGED as usize);
    format!(
        "This session was made without events: runs of more than {most} samples keep their result alone."
    )
});

/// Why nested levels have no events.
pub const NO_EVENTS_OF_LEVELS: &str =
    "Nested levels have no events; the timeline shows how many of their samples there are.";

/// Why a stipple has no events.
pub const NO_EVENTS_OF_DOTS: &str =
    "A stipple has no events; the timeline shows how many of its dots there are.";

/// Why a set in space has no events.
pub const NO_EVENTS_OF_SPACE: &str = "A set in space of more than 50,000 samples keeps its result alone: a plane goes through it, and there are no events to step through.";

/// Returns why the first run has no events, if it has none.
fn no_events(state: &State) -> Option<&'static str> {
    match &state.runs().first {
        run if run.debugger.is_some() => None,
        run if run.session.is_none() => Some(NO_SESSION),
        _ if state.runs().first.shows_combination() => {
            Some("A combination has stages but no events: its sets existed before.")
        }
        run if run.shows_stipple() => Some(NO_EVENTS_OF_DOTS),
        run if run.prefix().is_some() => Some(NO_EVENTS_OF_LEVELS),
        run if run.plane().is_some() => Some(NO_EVENTS_OF_SPACE),
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
    compare::add(&mut list, state);
    lessons::add(&mut list, state);
    talk::add(&mut list, state);
    help(&mut list);

    // Keys are settled once every action is there: a lesson's replace others, Escape goes to one action, a talk's replace all.
    lessons::lead(&mut list, state);
    list.escape(state);
    talk::lead(&mut list, state);
    list.actions
}

#[derive(Default)]
struct List {
    actions: Vec<Action>,
    /// The menu of the actions that are added next.
    menu: Menu,
    /// The submenu of the actions that are added next.
    submenu: Option<Submenu>,
    /// Whether the next action begins a group.
    begins_group: bool,
}

impl List {
    /// Adds an action; the methods of [`Action`] give it keys, a reason why it is unavailable, or a state.
    fn add(&mut self, name: impl Into<String>, command: Command) -> &mut Action {
        self.actions.push_mut(Action {
            menu: self.menu,
            name: name.into(),
            shortcut: None,
            also: None,
            command,
            refusal: None,
            submenu: self.submenu,
            begins_group: std::mem::take(&mut self.begins_group),
            is_on: None,
        })
    }

    /// Begins a group: a line separates the next action from those before it.
    const fn group(&mut self) {
        self.begins_group = true;
    }

    /// Adds actions to a submenu.
    fn within(&mut self, submenu: Submenu, add: impl FnOnce(&mut Self)) {
        self.submenu = Some(submenu);
        add(self);
        self.submenu = None;
    }
}

impl Action {
    /// Sets the shortcut, if there is one.
    fn on_keys(&mut self, modifiers: Modifiers, key: impl Into<Option<Key>>) -> &mut Self {
        let key: Option<Key> = key.into();
        self.shortcut = key.map(|key| KeyboardShortcut::new(modifiers, key));
        self
    }

    /// Sets a shortcut without modifiers.
    fn on_key(&mut self, key: Key) -> &mut Self {
        self.on_keys(NONE, key)
    }

    /// Sets a second shortcut.
    const fn or_on(&mut self, modifiers: Modifiers, key: Key) {
        self.also = Some(KeyboardShortcut::new(modifiers, key));
    }

    /// Makes the action unavailable, if there is a reason.
    fn refused(&mut self, refusal: Option<&str>) -> &mut Self {
        self.refusal = refusal.map(str::to_owned);
        self
    }

    /// Marks the action as a switch that is on or off.
    const fn marked(&mut self, is_on: bool) {
        self.is_on = Some(is_on);
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

    /// Returns the shortcuts of the action, first the one that menus show.
    pub fn keys(&self) -> impl Iterator<Item = KeyboardShortcut> {
        self.shortcut.into_iter().chain(self.also)
    }
}

impl List {
    /// Gives Escape to one action, so that each press closes or leaves one thing. It is the first of these that there is: the
    /// caption of a scene, the selection, the range selected in a curve, the open panel of a small window, the projector mode.
    fn escape(&mut self, state: &State) {
        let projector = (state.appearance().look.is_projector())
            .then_some(Command::Appearance(AppearanceCommand::ToggleProjector));
        let caption = state
            .scenes()
            .shown
            .map(|_| Command::Scene(SceneCommand::Leave));
        // Marks on the picture come before a panel, and a mode of the whole window comes last.
        let ways = [
            Command::View(Which::First, ViewCommand::Pick(Selection::Nothing)),
            Command::Analysis(AnalysisCommand::Brush(None)),
            Command::Window(WindowCommand::Drawer(DrawerCommand::Show(None))),
        ];

        for way in caption.into_iter().chain(ways).chain(projector) {
            // A refused action has nothing to close, so that the key goes to the next one.
            let is_way = |action: &&mut Action| action.command == way && action.refusal.is_none();
            if let Some(action) = self.actions.iter_mut().find(is_way) {
                // Menus show the first key of an action: an action that has one keeps it.
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

/// Adds undo, and the actions of parameters and of the selection.
fn edit(list: &mut List, state: &State) {
    list.menu = Menu::Edit;
    let no_past = (!state.past().history.can_undo()).then_some("Nothing was changed yet.");
    let no_future = (!state.past().history.can_redo()).then_some("Nothing was undone.");

    let undo = list.add("Undo", Command::Undo);
    undo.on_keys(COMMAND, Key::Z).refused(no_past);
    let redo = list.add("Redo", Command::Redo);
    redo.on_keys(COMMAND | SHIFT, Key::Z).refused(no_future);
    list.add("Reset parameters", Command::Form(FormCommand::Reset));
    painting(list, state);

    let run = &state.runs().first;
    // A selection is a sample, or a place without one.
    let nothing_selected = run.selected.is_none() && run.place.is_none();

    list.group();
    // A click selects at the pointer. The keyboard selects at the centre of the view instead.
    let middle = Command::View(Which::First, ViewCommand::SelectMiddle);
    list.add("Select at the centre of the view", middle)
        .on_key(Key::M)
        .refused(no_session(state));
    let deselect = Command::View(Which::First, ViewCommand::Pick(Selection::Nothing));
    list.add("Deselect", deselect)
        .refused(nothing_selected.then_some("Nothing is selected."));

    list.group();
    let finder = Command::Window(WindowCommand::ToggleFinder);
    list.add("All actions\u{2026}", finder)
        .on_keys(COMMAND, Key::K);
}

/// Adds painting radii, with the pointer and with the keyboard in the middle of the view, the choice of the brush, and the
/// ways to undo and to save all that was painted.
fn painting(list: &mut List, state: &State) {
    let form = state.form();
    let paint = |command| Command::Form(FormCommand::Paint(command));
    let refusal = form.draft.paint_refusal().or_else(|| no_session(state));

    list.group();
    let tool = list.add("Paint radii", paint(PaintCommand::Tool(!form.paints)));
    tool.refused(refusal.filter(|_| !form.paints))
        .marked(form.paints);
    // In a lesson, in a talk and over a set in space, the canvas does not show the form's radii. The brush can be
    // switched on there for later, but neither the key nor the pointer paints.
    let elsewhere = is_taught(state) || state.runs().first.plane().is_some();
    let not_here =
        elsewhere.then_some("Radii of a lesson, a talk or a set in space are not painted.");
    let off = (!form.paints).then_some("Choose Paint radii first.");
    list.add("Paint in the middle of the view", paint(PaintCommand::Dab))
        .on_key(Key::O)
        .refused(refusal.or(not_here).or(off));

    let brush = form.brush;
    let other = Brush {
        is_larger: !brush.is_larger,
        ..brush
    };
    list.add(
        "Brush makes radii larger",
        paint(PaintCommand::Brush(other)),
    )
    .marked(brush.is_larger);
    let ground = &form.draft.ground;
    let unpainted = (!ground.is_painted()).then_some("No radii were painted.");
    // The radii from before are kept with the form, and not in files or links.
    let no_way_back = ground
        .unpainted
        .is_none()
        .then_some("The image holds the painted radii alone, not those from before.");
    list.add("Radii as before painting", paint(PaintCommand::Reset))
        .refused(unpainted.or(no_way_back));
    list.add("Save painted radii as an image", paint(PaintCommand::Save))
        .refused(unpainted);
}

fn help(list: &mut List) {
    list.menu = Menu::Help;
    list.add("Tour", Command::Scene(SceneCommand::Tour));
    for page in HelpPage::ALL {
        let key = (page == HelpPage::Keys).then_some(Key::Questionmark);
        let command = Command::Window(WindowCommand::Help(page));
        list.add(page.name(), command).on_keys(NONE, key);
    }
}

/// Adds going through the scenes, and making one.
fn scenes(list: &mut List, state: &State) {
    // While a scene of the tour is shown, a user without scenes can go through those of the tour.
    let has_scenes =
        state.scenes().shown.is_some() || !SceneList::Own.scenes(&state.runs().first).is_empty();
    let no_scenes = (!has_scenes).then_some("There are no scenes: B makes one.");
    let step = |direction| Command::Scene(SceneCommand::Step(direction));

    let add_scene = Command::Scene(SceneCommand::Add);
    list.add("Make a scene of this moment", add_scene)
        .on_key(Key::B)
        .refused(no_events(state));

    let next = list.add("Next scene", step(Direction::Forwards));
    next.on_key(Key::PageDown).refused(no_scenes);
    // In the tour the space key, which plays otherwise, goes to the next scene.
    if state.scenes().is_touring() {
        next.or_on(NONE, Key::Space);
    }
    let previous = list.add("Previous scene", step(Direction::Backwards));
    previous.on_key(Key::PageUp).refused(no_scenes);

    if state.scenes().shown.is_some() {
        let leave = Command::Scene(SceneCommand::Leave);
        list.add("Close the scene's caption", leave);
    }
}

/// Returns the name of the action that enters the projector mode or leaves it.
#[must_use]
pub const fn projector_action(look: Look) -> &'static str {
    if look.is_projector() {
        "Leave the projector mode"
    } else {
        Look::Projector.name()
    }
}

/// Adds the actions that change how a moment is shown: the camera, panels, layers, looks and scenes.
fn view(list: &mut List, state: &State) {
    list.menu = Menu::View;
    let view_of_a = |command| Command::View(Which::First, command);
    list.add("Fit the domain", view_of_a(ViewCommand::Fit))
        .on_key(Key::F);

    let current = view_of_a(ViewCommand::GoToCurrent);
    list.add("Show the current event", current)
        .on_key(Key::Period);
    let follow = Command::Appearance(AppearanceCommand::ToggleFollow);
    list.add("Follow the events with the camera", follow)
        .on_keys(SHIFT, Key::F)
        .marked(state.appearance().follows_events);
    list.within(Submenu::Camera, |list| camera(list, state));

    let beside = Command::Appearance(AppearanceCommand::ToggleSideBySide);
    list.add("Radii, shape, set and dots side by side", beside)
        .refused(no_side_by_side(state))
        .marked(state.appearance().is_side_by_side);

    list.group();
    list.within(Submenu::Panels, |list| panels(list, state));
    list.within(Submenu::HidePanel, |list| hidden_panels(list, state));
    list.within(Submenu::Layers, |list| layers(list, state));
    list.within(Submenu::Colours, |list| colours(list, state));
    list.within(Submenu::Curve, |list| {
        curves(list, state);
        list.group();
        rises(list, state);
    });
    list.within(Submenu::Look, |list| look(list, state));
    list.within(Submenu::Scenes, |list| scenes(list, state));

    list.group();
    let command = Command::Window(WindowCommand::ToggleFullScreen);
    let full = list.add("Full screen", command);
    // F11, the usual key, is a step of the debugger.
    full.on_keys(Modifiers::ALT, Key::Enter)
        .refused(state.window().full_screen.refusal());
    // Where the system does not say whether the window is full, the action is no switch.
    full.is_on = state.window().is_full;

    let drawer = &state.window().drawer;
    // A small window shows at most one panel, which can be closed. Other windows hide their panels one by one.
    if drawer.arrangement.is_compact() {
        let no_panel = drawer.open.is_none().then_some("No panel is open.");
        let close = Command::Window(WindowCommand::Drawer(DrawerCommand::Show(None)));
        list.add("Close the panel", close).refused(no_panel);
    }
}

/// The keys that show and hide the timeline.
const TIMELINE_KEYS: (Modifiers, Key) = (SHIFT, Key::F4);

/// Returns why the panels cannot be reached, if so.
const fn no_panels(state: &State) -> Option<&'static str> {
    if state.appearance().look.is_projector() {
        Some("The projector mode shows no panels: F2 leaves it.")
    } else {
        None
    }
}

/// Adds an action for each panel that brings it into view, one that shows or hides the panels at the sides, and one
/// that resets the layout.
fn panels(list: &mut List, state: &State) {
    let window = state.window();
    let why_not = no_panels(state);
    for panel in Panel::all() {
        let command = Command::Window(WindowCommand::OpenPanel(panel));
        let action = list.add(format!("Panel: {}", panel.name()), command);
        // The projector mode, which refuses other panels, has room for the analysis.
        action.refused(why_not.filter(|_| panel != Panel::Analysis));
        // The key only shows its panel. If it hid the panel as well, a digit typed beside a field would take it away.
        if let Some(key) = Key::from_name(panel.key()) {
            action.on_key(key);
        }
        // `hidden_panels` gives the same keys to the action that hides the timeline, while that is in view.
        if panel == Panel::Timeline && !window.can_hide(panel) {
            action.on_keys(TIMELINE_KEYS.0, TIMELINE_KEYS.1);
        }
        action.marked(window.shows(panel));
    }

    list.group();
    // A small window has no panels at its sides.
    if !window.drawer.arrangement.is_compact() {
        let name = if window.shows_sides() {
            "Hide the side panels"
        } else {
            "Show the side panels"
        };
        let sides = list.add(name, Command::Window(WindowCommand::ToggleSides));
        sides.on_key(Key::F4).refused(why_not);
    }

    let reset = Command::Window(WindowCommand::ResetLayout);
    list.add("Reset layout", reset);
}

/// Adds what hides the panels that are in view.
fn hidden_panels(list: &mut List, state: &State) {
    let no_panels = no_panels(state);
    for panel in Panel::all().filter(|panel| state.window().can_hide(*panel)) {
        let command = Command::Window(WindowCommand::HidePanel(panel));
        let action = list.add(format!("Hide the panel: {}", panel.name()), command);
        action.refused(no_panels.filter(|_| panel != Panel::Analysis));
        if panel == Panel::Timeline {
            action.on_keys(TIMELINE_KEYS.0, TIMELINE_KEYS.1);
        }
    }
}

/// Adds the layers of the canvas.
fn layers(list: &mut List, state: &State) {
    let automatic = Command::Appearance(AppearanceCommand::AutomaticLayers);
    list.add("Layers: automatic", automatic)
        .on_key(Key::T)
        .marked(state.appearance().chosen_layers.is_none());
    list.group();

    let shown = state.runs().first.layers(state.appearance());
    let kind = state.runs().first.kind();
    // While a lesson's question is open, layers that would show its answer are hidden.
    let hidden = state
        .lessons()
        .hidden_layers(state.runs().first.current_stage());

    for layer in Layer::ALL {
        let command = Command::Appearance(AppearanceCommand::ToggleLayer(layer));
        let lacking = match kind {
            _ if layer == Layer::Gaps && state.runs().first.shows_stipple() => Some(
                "Dots of a stipple need not cover every place, so that gaps say nothing about it.",
            ),
            _ if layer.is_of(kind) => None,
            SessionKind::Nested => {
                Some("This layer shows parts of a run, which nested levels do not have.")
            }
            SessionKind::Varying => Some(
                "This layer shows parts of a tiling, or circles of one radius, which a set in a field or a shape does not have.",
            ),
            SessionKind::Solid => Some(
                "This layer shows parts of a tiling or of a plane, which a set in space does not have.",
            ),
            // In these sessions a layer of another kind can be switched on, and shows nothing.
            SessionKind::Run | SessionKind::Exact | SessionKind::Combination => None,
        };
        list.add(format!("Layer: {}", layer.name()), command)
            .refused(hidden.has(layer).then_some(HIDDEN_LAYER).or(lacking))
            .marked(shown.has(layer));
    }
}

/// Adds the meanings that the colour of samples can have.
fn colours(list: &mut List, state: &State) {
    for (name, colouring) in [
        ("Colour by block", Colouring::Block),
        ("Colour by origin", Colouring::Provenance),
        ("Colour by age", Colouring::Age),
        ("Colour by level", Colouring::Level),
        ("Colour by depth", Colouring::Depth),
    ] {
        let command = Command::Appearance(AppearanceCommand::Colour(colouring));
        let kind = state.runs().first.kind();

        let refusal = match kind {
            _ if colouring == Colouring::Depth => "Only samples in space have a depth.",
            SessionKind::Nested => "Samples of nested levels have neither block nor origin.",
            SessionKind::Varying => {
                "Samples in a field or a shape have neither block nor level; all were thrown as darts."
            }
            SessionKind::Solid => {
                "Samples in space have neither block nor level; all were thrown as darts."
            }
            SessionKind::Run | SessionKind::Exact | SessionKind::Combination => {
                "Only nested levels have levels."
            }
        };

        // A colouring that the run cannot show would be drawn as another one, so that it is refused.
        list.add(name, command)
            .refused((colouring.of(kind) != colouring).then_some(refusal))
            .marked(state.appearance().colouring.of(kind) == colouring);
    }
}

/// Adds the numbers that can be drawn over the events of the run.
fn curves(list: &mut List, state: &State) {
    let shown = state.appearance().curve.number;
    let lacks_events = state.runs().first.cursor().is_none();
    let refusal =
        lacks_events.then_some("This session has no events, over which a curve could be drawn.");

    let session = state.runs().first.session.as_deref();
    for number in CurveNumber::all() {
        let command = Command::Appearance(AppearanceCommand::Curve(Some(number)));
        let lacks_number = number.refusal(session);
        list.add(format!("Curve: {}", number.row().name), command)
            .refused(refusal.or(lacks_number))
            .marked(shown == Some(number));
    }

    let command = Command::Appearance(AppearanceCommand::Curve(None));
    let nothing = "No curve is shown.";
    list.add("No curve", command)
        .refused(shown.is_none().then_some(nothing));
}

/// Adds going to where the number of the curve rises.
fn rises(list: &mut List, state: &State) {
    let has_curve = state.runs().first.curve.points().is_some();
    let refusal = (!has_curve).then_some("No curve of the run is shown.");
    for (name, modifiers, direction) in [
        ("Next rise of the curve", NONE, Direction::Forwards),
        ("Previous rise of the curve", SHIFT, Direction::Backwards),
    ] {
        list.add(name, Command::Time(TimeCommand::ToRise(direction)))
            .on_keys(modifiers, Key::R)
            .refused(refusal);
    }
}

/// Adds the looks and the choice of less motion.
fn look(list: &mut List, state: &State) {
    let shown = state.appearance().look;
    for look in Look::ALL {
        // This look is a mode: its action enters and leaves it.
        if look == Look::Projector {
            let projector = Command::Appearance(AppearanceCommand::ToggleProjector);
            list.add(projector_action(shown), projector)
                .on_key(Key::F2)
                .marked(shown.is_projector());
        } else {
            let command = Command::Appearance(AppearanceCommand::Look(look));
            list.add(look.name(), command).marked(shown == look);
        }
    }

    list.group();
    let motion = Command::Appearance(AppearanceCommand::ToggleReducedMotion);
    list.add("Reduced motion", motion)
        .marked(state.appearance().reduced_motion);
}

/// How far a key pans the view, in screen points. Chosen, not measured.
const PAN: f32 = 80.0;

/// Adds the camera's actions, for the keyboard.
fn camera(list: &mut List, state: &State) {
    let view_of_a = |command| Command::View(Which::First, command);
    // The picture moves against the view.
    for (name, key, delta) in [
        ("Move the view left", Key::ArrowLeft, vec2(PAN, 0.0)),
        ("Move the view right", Key::ArrowRight, vec2(-PAN, 0.0)),
        ("Move the view up", Key::ArrowUp, vec2(0.0, PAN)),
        ("Move the view down", Key::ArrowDown, vec2(0.0, -PAN)),
    ] {
        let action = list.add(name, view_of_a(ViewCommand::Pan(delta)));
        action.on_keys(SHIFT, key).refused(no_session(state));
    }

    list.group();
    // Keys zoom about the middle; the wheel zooms about the pointer.
    let middle = state.runs().first.viewport.center();
    let orbit = state.runs().first.orbit();
    // The factors are chosen. They are inverse to each other, so that zooming in and out leads back.
    for (name, key, factor) in [("Zoom in", Key::Plus, 1.25), ("Zoom out", Key::Minus, 0.8)] {
        let zoom = match orbit {
            Some(_) => ViewCommand::Orbit(OrbitCommand::Zoom(factor)),
            None => ViewCommand::Zoom(middle, factor),
        };
        let action = list.add(name, view_of_a(zoom));
        action.on_key(key).refused(no_session(state));
    }

    list.group();
    // A press moves the plane by two steps, a tenth of r.
    for (name, key, steps) in [
        ("Move the plane up", Key::K, 2),
        ("Move the plane down", Key::J, -2),
    ] {
        let action = list.add(name, view_of_a(ViewCommand::StepPlane(steps)));
        let no_plane = state.runs().first.plane().is_none().then_some(NO_PLANE);
        action.on_key(key).refused(no_plane);
    }
    let balls = OrbitCommand::Show(orbit.is_none());
    let no_space = state.runs().first.plane().is_none().then_some(NO_PLANE);
    list.add(
        "Show the set as balls",
        view_of_a(ViewCommand::Orbit(balls)),
    )
    .on_key(Key::Y)
    .refused(no_space)
    .marked(orbit.is_some());
    let follows = state.runs().first.follows_events();
    let pin = view_of_a(ViewCommand::PinPlane(follows == Some(true)));
    let no_events = "The plane follows the events of a recorded set in space, and there are none.";
    list.add("Let the plane follow the events", pin)
        .refused(follows.is_none().then_some(no_events))
        .marked(follows == Some(true));
}

/// Returns why time cannot go forwards, and why it cannot go backwards, if so.
#[must_use]
pub fn time_refusals(run: &RunView, time: &Time) -> [Option<&'static str>; 2] {
    let Some(session) = &run.session else {
        return [Some(NO_SESSION); 2];
    };
    // The shortest prefix of nested levels has one sample.
    let first = usize::from(run.prefix().is_some());
    // The place in time and the last one, by what the run has: its passes, events or prefixes, or else its stages.
    let (at, last) = time
        .pass_tick(run)
        .or_else(|| run.cursor())
        .unwrap_or((run.stage, session.stages.len() - 1));
    [
        (at == last).then_some("This is the end of the run."),
        (at == first).then_some("This is the start of the run."),
    ]
}

/// Adds the actions of breakpoints and watches, and the way to an event's cause.
fn debug(list: &mut List, state: &State) {
    list.menu = Menu::Debug;
    let why_no_events = no_events(state);
    // At the end of the run there is no next event, and so no line to stop at.
    if let Some(debugger) = &state.runs().first.debugger
        && let Some(event) = debugger.event()
    {
        let line = event.line();
        let is_set = debugger.breakpoints().iter().any(|set| set.line == line);
        let toggle = Command::Debug(DebugCommand::ToggleBreakpoint(line));
        list.add("Breakpoint on the next line", toggle)
            .on_key(Key::F9)
            .marked(is_set);
    }

    let at_start = state.runs().first.cursor().is_some_and(|(at, _)| at == 0);
    let no_cause = at_start.then_some("Nothing has happened yet.");
    let why = Command::Debug(DebugCommand::Why);
    list.add("Why? Go to the cause of the last event", why)
        .on_key(Key::W)
        .refused(why_no_events.or(no_cause));

    list.group();
    list.within(Submenu::Breakpoints, |list| breakpoints(list, state));
    // The current sample is called p in expressions.
    let sample = Command::Debug(DebugCommand::Watch("p".to_owned()));
    list.add("Watch the current sample", sample)
        .refused(why_no_events);
}

/// Adds the breakpoints that are set, each to be switched, and the way to the panel with their conditions.
fn breakpoints(list: &mut List, state: &State) {
    let run = &state.runs().first;
    if let (Some(debugger), Some(session)) = (&run.debugger, &run.session) {
        let parameters = &session.run().parameters;
        for (index, breakpoint) in debugger.breakpoints().iter().enumerate() {
            // A breakpoint keeps the number of its line, which the listings may lack: it has no text to be named by.
            let Some(line) = Listings::shipped().line(breakpoint.line) else {
                continue;
            };
            let name = format!("Breakpoint: {}, {}", line.id, line.text(parameters));
            let switch = DebugCommand::Enable(index, !breakpoint.enabled);
            list.add(name, Command::Debug(switch))
                .marked(breakpoint.enabled);
        }
    }

    // Breakpoints have no panel of their own: that of the scenes lists them below.
    let panel = Command::Window(WindowCommand::OpenPanel(Panel::Scenes));
    list.add("Breakpoint: conditions\u{2026}", panel)
        .refused(no_events(state));
}
