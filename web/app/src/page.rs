//! The interface to the page's JavaScript: starts the app on a canvas, chooses the display that draws it, answers
//! requests and reports changes.

use std::any::Any;
use std::cell::Cell;
use std::rc::Rc;

use eframe::egui_wgpu::{WgpuConfiguration, WgpuSetup, WgpuSetupCreateNew, wgpu};
use eframe::{Storage, WebOptions, WebRunner};
use egui::{Event, Ui};
use js_sys::{Date, Object};
use serde::Deserialize;
use tilescope_app::App;
use tilescope_app::panes::leads_zoom;
use tilescope_classroom::lessons::NOT_STORED;
use tilescope_session::language;
use tilescope_session::look::Look;
use tilescope_session::task::set_task_pool;
use tilescope_ui::focus::{self, End};
use tilescope_workbench::Command;
use tilescope_workbench::command::LinkCommand;
use tilescope_workbench::device::EngineChoice;
use tilescope_workbench::embedding::Embedding;
use tilescope_workbench::remote::{ask, to_json};
use tilescope_workbench::state::{PageAddress, PageStart, Settings, not_copied};
use wasm_bindgen::JsValue;
use wasm_bindgen::prelude::wasm_bindgen;
use web_sys::HtmlCanvasElement;

use crate::hooks;
use crate::local::LocalStore;
use crate::pool::{Pool, Program};
use crate::tree::Tree;

/// Changes are reported to the page at most once in so many seconds.
const REPORTS_SECS: f64 = 0.25;
/// The most workers, whatever the number of processors, since each has its own memory.
const MAX_WORKERS: usize = 2;

/// The key of results in the browser's store.
const RESULTS_KEY: &str = "lessons";
/// The key of results that could not be read and were replaced.
const UNREADABLE_RESULTS_KEY: &str = "lessons.unreadable";
/// The key of the look, under which `App` stores it.
const LOOK_KEY: &str = "look";
/// The key of the language of lessons in the browser's store.
const LANGUAGE_KEY: &str = "language";

/// Options for starting the app.
#[derive(Default, Deserialize)]
#[serde(default)]
struct Options {
    /// The fragment of a link to open.
    link: String,
    /// The part of the app to show when it is embedded in another page.
    embed: Option<String>,
    /// The engine: "cpu", "gpu", or the best one.
    engine: String,
    /// The display: "auto", "webgpu" or "webgl".
    display: String,
    /// The reason for this display, if it must be reported.
    reason: String,
    /// The languages that the browser prefers, the most wanted one first.
    languages: Vec<String>,
    /// Whether animations are off.
    reduced_motion: bool,
    /// Whether the system prefers light colours.
    light: bool,
    /// Whether the browser allows full screen.
    full_screen: bool,
    /// The address of the worker's script.
    worker: String,
    /// The address of the bindings.
    bindings: String,
}

/// The app on a page.
#[wasm_bindgen]
pub struct Tilescope {
    runner: WebRunner,
    pool: Pool,
    display: String,
    shared: Rc<Shared>,
}

/// State by which a touch or the wheel goes to the app or to the page around. It is separate because it is read while
/// the runner is borrowed.
#[derive(Default)]
struct Shared {
    /// Whether the current touch is left to the page around.
    is_yielded: Cell<bool>,
    /// Whether a list is open, which then gets the wheel.
    has_list: Cell<bool>,
}

/// Starts the app on a canvas and returns once it can be used.
///
/// # Errors
///
/// A sentence, if the options do not parse or the browser has no display.
#[wasm_bindgen]
pub async fn start(
    canvas: HtmlCanvasElement,
    options: &str,
    hooks: Object,
) -> Result<Tilescope, JsValue> {
    let options: Options = serde_json::from_str(options).map_err(|error| error.to_string())?;
    hooks::tell(Some(hooks));

    // Every page has a window.
    let cores = web_sys::window().map_or(1.0, |window| window.navigator().hardware_concurrency());
    let pool = Pool::new(Program {
        worker: options.worker.clone(),
        bindings: options.bindings.clone(),
        module: hooks::given("module").unwrap_or(JsValue::UNDEFINED),
        later: hooks::given("later"),
        // One processor is left to the page, unless there is no other.
        workers: ((cores as usize).saturating_sub(1)).clamp(1, MAX_WORKERS),
    });
    set_task_pool(Some(Rc::new(pool.clone())));

    let runner = WebRunner::new();
    let shared = Rc::<Shared>::default();
    let runner_options = web_options(&options, &shared);
    let (pool_of_page, shared_with_page) = (pool.clone(), Rc::clone(&shared));
    let started = runner
        .start(
            canvas,
            runner_options,
            Box::new(move |creation| {
                Ok(Box::new(Page::new(
                    creation,
                    &options,
                    pool_of_page,
                    shared_with_page,
                )))
            }),
        )
        .await;

    // The first worker runs already. A page that did not start would never ask it to end.
    if let Err(error) = started {
        set_task_pool(None);
        pool.close();
        return Err(error);
    }

    let display = runner
        .app_mut::<Page>()
        .map_or_else(String::new, |page| page.display.clone());
    Ok(Tilescope {
        runner,
        pool,
        display,
        shared,
    })
}

#[wasm_bindgen]
impl Tilescope {
    /// Answers a request, both as JSON.
    pub fn ask(&self, request: &str) -> String {
        let busy = r#"{"ok":false,"error":"The app is busy or broken; ask again."}"#;
        let Some(mut page) = self.runner.app_mut::<Page>() else {
            return busy.to_owned();
        };
        page.work();
        let answer = ask(&mut page.app.state, request);
        // A request for the state changes nothing.
        let parsed = serde_json::from_str::<serde_json::Value>(request);
        if parsed.is_ok_and(|request| request["do"] != "state") {
            page.ctx.request_repaint();
        }
        // Results and wanted lessons do not wait for the next frame: a hidden page draws none, and the page may be left
        // before it.
        page.store_results();
        page.load_lessons();
        answer
    }

    /// Takes the results that another tab has put into the browser's store.
    pub fn take_results(&self, stored: &str) {
        if let Some(mut page) = self.runner.app_mut::<Page>() {
            page.take_results(stored);
            page.ctx.request_repaint();
        }
    }

    /// Returns the answers that are kept, as xAPI statements in JSON. Equal answers have equal ids.
    pub fn statements(&self) -> String {
        let page = self.runner.app_mut::<Page>();
        page.map_or_else(
            || "[]".to_owned(),
            |page| page.app.state.lessons().results.xapi().to_string(),
        )
    }

    /// Stores the settings for the next visit. The page asks for it when it is hidden, as the browser may end it then.
    pub fn keep(&self) {
        if let Some(mut page) = self.runner.app_mut::<Page>() {
            page.store_results();
            eframe::App::save(&mut *page, &mut LocalStore);
        }
    }

    /// Opens what a link's fragment describes.
    pub fn open_link(&self, fragment: String) {
        if let Some(mut page) = self.runner.app_mut::<Page>() {
            page.app
                .state
                .apply(Command::Link(LinkCommand::Open(fragment)));
            // The address may no longer hold this program's link, so it must be reported again even if nothing changed.
            page.link = None;
            page.ctx.request_repaint();
        }
    }

    /// Returns whether the app uses a key, so that the browser must not handle it.
    pub fn takes_key(&self, key: &str, command: bool, shift: bool, alt: bool) -> bool {
        let held = modifiers(command, shift, alt);
        let page = self.runner.app_mut::<Page>();
        page.is_some_and(|page| tilescope_app::actions::takes_key(&page.app.state, key, held))
    }

    /// Returns whether one finger at a place of the canvas is left to the page around, which scrolls.
    pub fn scrolls_at(&self, x: f32, y: f32) -> bool {
        let page = self.runner.app_mut::<Page>();
        page.is_some_and(|page| {
            let pos = egui::pos2(x, y) / page.ctx.zoom_factor();
            page.app.scrolls_at(&page.ctx, pos)
        })
    }

    /// Leaves the current touch to the page around, or takes it.
    pub fn yield_touch(&self, is_yielded: bool) {
        self.shared.is_yielded.set(is_yielded);
    }

    /// Moves the focus to the first control, or to the last one.
    pub fn enter_by_tab(&self, backwards: bool) {
        if let Some(page) = self.runner.app_mut::<Page>() {
            let end = if backwards { End::Last } else { End::First };
            focus::enter(&page.ctx, end);
        }
    }

    /// Returns whether Tab leaves the app, because the focus is on the last control or, backwards, on the first. The
    /// focus then leaves it.
    pub fn leaves_by_tab(&self, backwards: bool) -> bool {
        let page = self.runner.app_mut::<Page>();
        let end = if backwards { End::First } else { End::Last };
        page.is_some_and(|page| focus::leave(&page.ctx, end))
    }

    /// Does something to the control that the page shows as the element of a number, as if by hand: "click", "focus",
    /// "increment", "decrement", "show" (scrolls to it), "number" or "text" (sets its value).
    pub fn ask_control(&self, number: u32, action: &str, text: Option<String>) {
        self.with_tree(|tree| tree.ask(number, action, text));
    }

    /// Presses a key whose event has come to one of those elements.
    pub fn press_key(&self, name: &str, code: &str, command: bool, shift: bool, alt: bool) {
        self.with_tree(|tree| tree.press(name, code, modifiers(command, shift, alt)));
    }

    /// Takes whether the page's focus is on one of those elements.
    pub fn hold_focus(&self, holds: bool) {
        self.with_tree(|tree| tree.hold_focus(holds));
    }

    /// Changes the tree and draws a frame, which takes what it holds.
    fn with_tree(&self, change: impl FnOnce(&mut Tree)) {
        if let Some(page) = self.runner.app_mut::<Page>() {
            page.ctx.with_plugin(change);
            page.ctx.request_repaint();
        }
    }

    /// Takes the lessons that the page has loaded.
    pub fn take_lessons(&self, json: &str) {
        self.take_loaded(Ok(json));
    }

    /// Takes the reason why the page could not load the lessons.
    pub fn lessons_failed(&self, error: &str) {
        self.take_loaded(Err(error));
    }

    fn take_loaded(&self, loaded: Result<&str, &str>) {
        if let Some(mut page) = self.runner.app_mut::<Page>() {
            page.app.state.take_lessons(loaded);
            page.ctx.request_repaint();
        }
    }

    /// Carries out a command of the lecturer's notes: a `TalkCommand` in JSON. Returns an error message, or an empty
    /// text.
    pub fn talk(&self, command: &str) -> String {
        let Some(mut page) = self.runner.app_mut::<Page>() else {
            return String::new();
        };
        match serde_json::from_str(command) {
            Ok(command) => {
                page.app.state.apply(Command::Talk(command));
                page.ctx.request_repaint();
                String::new()
            }
            Err(error) => error.to_string(),
        }
    }

    /// Passes the compiled later part of the program on to the workers.
    pub fn take_later(&self, later: JsValue) {
        self.pool.take_later(later);
    }

    /// Shows a notice that copying failed.
    pub fn copy_failed(&self) {
        if let Some(mut page) = self.runner.app_mut::<Page>() {
            let is_embedded = page.app.state.window().embedding.is_some();
            page.app.state.report(not_copied(is_embedded));
            page.ctx.request_repaint();
        }
    }

    /// Follows the system's preference for reduced motion, unless the user chose otherwise in the app.
    pub fn prefer_reduced_motion(&self, reduced: bool) {
        if let Some(mut page) = self.runner.app_mut::<Page>() {
            page.app.state.restore(Settings {
                prefers_reduced_motion: Some(reduced),
                ..Settings::default()
            });
            page.ctx.request_repaint();
        }
    }

    /// Returns the parts of the session that the link cannot hold; empty if it holds all, or while the app is busy.
    pub fn left_out(&self) -> String {
        let page = self.runner.app_mut::<Page>();
        page.map_or_else(String::new, |page| {
            page.app.state.link().left_out.join("; ")
        })
    }

    /// Returns the display in use: "WebGPU" or "WebGL 2".
    pub fn display(&self) -> String {
        self.display.clone()
    }

    /// Ends the app: it draws and reports nothing more.
    pub fn destroy(&self) {
        hooks::tell(None);
        set_task_pool(None);
        self.pool.close();
        self.runner.destroy();
    }
}

/// Returns modifiers, with Ctrl and the command key of a Mac as one.
fn modifiers(command: bool, shift: bool, alt: bool) -> egui::Modifiers {
    egui::Modifiers {
        alt,
        ctrl: command,
        shift,
        mac_cmd: false,
        command,
    }
}

/// Returns the window's options on a page: which interfaces of the browser may draw it, and which events the browser must
/// not handle.
fn web_options(options: &Options, shared: &Rc<Shared>) -> WebOptions {
    let mut create = WgpuSetupCreateNew::without_display_handle();
    create.instance_descriptor.backends = match options.display.as_str() {
        "webgpu" => wgpu::Backends::BROWSER_WEBGPU,
        "webgl" => wgpu::Backends::GL,
        _ => wgpu::Backends::BROWSER_WEBGPU | wgpu::Backends::GL,
    };
    WebOptions {
        wgpu_options: WgpuConfiguration {
            wgpu_setup: WgpuSetup::CreateNew(create),
            ..WgpuConfiguration::default()
        },
        should_prevent_default: Box::new(prevents(options.embed.is_some(), Rc::clone(shared))),
        ..WebOptions::default()
    }
}

/// Returns whether the browser's default action of an event is prevented. In a frame the plain wheel and one finger
/// scroll the page around.
fn prevents(is_embedded: bool, shared: Rc<Shared>) -> impl Fn(&Event) -> bool {
    move |event| match event {
        Event::MouseWheel { modifiers, .. } => {
            !is_embedded || shared.has_list.get() || leads_zoom(*modifiers)
        }
        Event::PointerButton { .. } | Event::PointerMoved(_) | Event::PointerGone => {
            !shared.is_yielded.get()
        }
        _ => true,
    }
}

/// The app, and the values that were last reported to the page.
struct Page {
    app: App,
    ctx: egui::Context,
    pool: Pool,
    shared: Rc<Shared>,
    display: String,
    /// Whether the browser's store is used: a page within another page stores nothing.
    stores: bool,
    /// The number of frames begun, counted up to 255.
    frames: u8,
    /// When changes were last reported, in seconds of the browser's clock.
    reported_secs: f64,
    announcement: Option<String>,
    /// The language of lessons that the browser's store has, or that was in use when the page began.
    language: Option<String>,
    /// Whether the browser refused to store results.
    is_refused: bool,
    /// Whether the page was asked to load the lessons.
    asked_for_lessons: bool,
    /// The last reported link; `None` if the link must be reported in any case.
    link: Option<String>,
    state: String,
    talk: String,
}

impl Page {
    /// Makes the page's app: restores the settings of earlier visits, and opens the link.
    fn new(
        creation: &eframe::CreationContext<'_>,
        options: &Options,
        pool: Pool,
        shared: Rc<Shared>,
    ) -> Self {
        let mut app = App::new(&creation.egui_ctx);
        let stores = options.embed.is_none();
        let display = connect(&mut app, creation);

        let storage = creation.storage.filter(|_| stores);
        let stored_language = storage.and_then(|storage| restore(&mut app, storage, options));
        // A language that the learner chose earlier comes before those that the browser prefers.
        let languages = stored_language.iter().chain(&options.languages);
        app.state.restore(Settings {
            page: Some(PageAddress {
                address: address(),
                language: preferred(languages),
            }),
            ..Settings::default()
        });
        // A preference of the browser is not stored: only a change from it is.
        let language = stored_language.or_else(|| Some(app.state.lessons().language.clone()));

        // Opening a link removes notices, so that it comes before the notices of the start.
        if !options.link.is_empty() {
            app.state
                .apply(Command::Link(LinkCommand::Open(options.link.clone())));
        }
        app.state.begin_on_page(&PageStart {
            display: display.clone(),
            reason: options.reason.clone(),
            engine: match options.engine.as_str() {
                "cpu" => EngineChoice::Cpu,
                "gpu" => EngineChoice::Gpu,
                _ => EngineChoice::Auto,
            },
            embedding: options.embed.as_deref().and_then(Embedding::named),
            reduced_motion: options.reduced_motion,
            full_screen: options.full_screen,
        });
        // The pool sends no task to a worker before this. Tasks of the session that the link has replaced are cancelled by
        // now, and never start.
        pool.open();
        Self {
            app,
            ctx: creation.egui_ctx.clone(),
            pool,
            shared,
            display,
            stores,
            frames: 0,
            reported_secs: 0.0,
            announcement: None,
            language,
            is_refused: false,
            asked_for_lessons: false,
            link: None,
            state: String::new(),
            // JSON has this for a talk that is not there.
            talk: "null".to_owned(),
        }
    }

    /// Puts new results into the browser's store. They are merged with those that are there, as another tab may have stored
    /// some.
    fn store_results(&mut self) {
        let state = &mut self.app.state;
        // A page within another page stores nothing.
        if !self.stores || !state.lessons().has_unstored_results() {
            return;
        }
        let mut store = LocalStore;
        let before = store.get_string(RESULTS_KEY);
        let results = state.store_results(before.as_deref());
        // Results that cannot be read are put aside under a key of their own, before the new ones take their place.
        if let Some(before) = before.filter(|_| results.unreadable) {
            store.set_string(UNREADABLE_RESULTS_KEY, before);
        }

        // The notice is shown once, not at every answer.
        if !LocalStore::put(RESULTS_KEY, &results.text) && !self.is_refused {
            self.is_refused = true;
            self.app.state.report(NOT_STORED.to_owned());
        }
    }

    /// Takes the results that another tab has stored.
    fn take_results(&mut self, stored: &str) {
        let state = &mut self.app.state;
        if !self.stores || !state.take_results(stored) {
            return;
        }
        let merged = state.lessons().results.to_json();

        // Both tabs may have read the store before either wrote: what the other one has replaced is written again.
        if merged != stored {
            LocalStore::put(RESULTS_KEY, &merged);
        }
    }

    /// Stores the language of lessons when the learner or a link has changed it.
    fn store_language(&mut self) {
        let language = &self.app.state.lessons().language;
        if self.stores && self.language.as_ref() != Some(language) {
            LocalStore::put(LANGUAGE_KEY, language);
            self.language = Some(language.clone());
        }
    }

    /// Advances the background work where no frame does: before an answer, and while the page is hidden. Only frames
    /// let time pass for playback and cameras.
    fn work(&mut self) {
        self.pool.tick();
        let passed_secs = 0.0;
        self.app.state.advance(passed_secs);
    }

    /// Makes the page load the lessons once they are wanted.
    fn load_lessons(&mut self) {
        let wants = self.app.state.classroom().wants_lessons();
        if wants && !self.asked_for_lessons {
            hooks::lessons();
        }
        self.asked_for_lessons = wants;
    }

    /// Reports changes to the page.
    fn report_changes(&mut self) {
        // Announcements are passed on at once, other changes only now and then.
        let state = &self.app.state;
        let announcement = state.messages().announcement();
        if announcement != self.announcement {
            hooks::announce(announcement.as_deref().unwrap_or_default());
            self.announcement = announcement;
        }
        self.load_lessons();

        let state = &self.app.state;
        // Date::now is used, as the browser's clock goes on while the page is hidden and that of egui stands still.
        let now_secs = Date::now() / 1e3;
        let due_secs = self.reported_secs + REPORTS_SECS - now_secs;
        if due_secs > 0.0 {
            self.ctx
                .request_repaint_after(std::time::Duration::from_secs_f64(due_secs));
            return;
        }

        self.reported_secs = now_secs;
        let talk = state
            .classroom()
            .talk_json(&state.runs().first.canvas_view())
            .to_string();
        // A talk is reported for the window with its notes, which a page within another page does not open.
        if talk != self.talk && self.stores {
            hooks::talk(&talk);
            self.talk = talk;
        }

        let state_json = to_json(state);
        let link = state_json["link"].as_str().unwrap_or_default();
        if self.link.as_deref() != Some(link) {
            hooks::link(link);
            self.link = Some(link.to_owned());
        }
        let state_text = state_json.to_string();
        if state_text != self.state {
            hooks::state(&state_text);
            self.state = state_text;
        }
    }
}

impl eframe::App for Page {
    fn logic(&mut self, ctx: &egui::Context, _: &mut eframe::Frame) {
        // Nothing is drawn while the page is hidden, as behind the window with the notes of a talk. Its run goes on, and the
        // notes get what their commands have changed.
        if ctx.input(|input| input.viewport().visible()) == Some(false) {
            self.work();
            self.store_results();
            self.report_changes();
        }
    }

    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        // When the second frame begins, the first has been drawn.
        if self.frames == 1 {
            hooks::drawn();
        }
        self.frames = self.frames.saturating_add(1);
        eframe::App::ui(&mut self.app, ui, frame);
        let lessons = self.app.state.lessons();
        // The window is in a lesson's language while one is open, and else in English.
        let is_translated = lessons.shown_language().is_some();
        let language = if is_translated {
            &lessons.language
        } else {
            "en"
        };
        ui.ctx()
            .with_plugin(|tree: &mut Tree| language.clone_into(&mut tree.language));
        self.store_results();
        self.store_language();
        self.shared.has_list.set(egui::Popup::is_any_open(ui.ctx()));
        // Tasks that this frame has cancelled are ended at once, since there may be no next frame.
        self.pool.tick();
        self.report_changes();
    }

    fn raw_input_hook(&mut self, ctx: &egui::Context, raw: &mut egui::RawInput) {
        eframe::App::raw_input_hook(&mut self.app, ctx, raw);
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        if self.stores {
            eframe::App::save(&mut self.app, storage);
        }
    }

    fn persist_egui_memory(&self) -> bool {
        false
    }

    fn as_any_mut(&mut self) -> Option<&mut dyn Any> {
        Some(self)
    }
}

/// Connects the app with its display and with the functions of the page. Returns the name of the display, or an empty text
/// without one.
fn connect(app: &mut App, creation: &eframe::CreationContext<'_>) -> String {
    let mut display = String::new();
    if let Some(render) = &creation.wgpu_render_state {
        app.draw_with(render);
        display = name_of(render.adapter.get_info().backend).to_owned();
        render
            .device
            .set_device_lost_callback(|_, reason| hooks::lost(&reason));
    }

    app.copy_with(hooks::copy);
    App::speak_to(&creation.egui_ctx, |spoken| {
        hooks::field(&spoken.field);
        // The field may change without a text to announce.
        if !spoken.text.is_empty() {
            hooks::announce_focus(&spoken.text);
        }
    });
    // Behind the speaker, which reads the tree of controls of each frame: this plugin takes the tree out of the output.
    creation.egui_ctx.add_plugin(Tree::default());
    app.turn_full_screen_with(hooks::full_screen);
    display
}

/// Restores what earlier visits have stored. Returns the language of lessons, if one is stored.
fn restore(app: &mut App, storage: &dyn Storage, options: &Options) -> Option<String> {
    // A first visit begins with the tour, unless a link says what to show.
    let has_no_link = options.link.is_empty();
    app.remember(storage, has_no_link);
    if let Some(results) = storage.get_string(RESULTS_KEY) {
        // Results that cannot be read stay in the store until new ones are stored.
        app.state.take_results(&results);
    }

    // Until a visitor's own look is stored, the system's preference counts; a link to a view may name another.
    if options.light && storage.get_string(LOOK_KEY).is_none() {
        app.state.restore(Settings {
            look: Some(Look::Light),
            ..Settings::default()
        });
    }
    storage.get_string(LANGUAGE_KEY)
}

/// Returns the tag of the language that is wanted first, English if the window has none of them.
fn preferred<'a>(languages: impl IntoIterator<Item = &'a String>) -> String {
    let primary = |language: &'a String| language.split('-').next().unwrap_or_default();
    let known = |language: &&str| language::TAGS.contains(language);
    let found = languages.into_iter().map(primary).find(known);
    found.unwrap_or("en").to_owned()
}

/// Returns the address of the page for links: without its fragment, and without the parameters that links leave out. `None` if
/// the browser does not give it.
fn address() -> Option<String> {
    let location = web_sys::window()?.location();
    let (origin, path) = (location.origin().ok()?, location.pathname().ok()?);
    let search = location.search().ok()?;
    let kept: Vec<&str> = search
        .trim_start_matches('?')
        .split('&')
        .filter(|pair| {
            // Every text has a first part.
            let name = pair.split('=').next().unwrap_or_default();
            !NOT_IN_LINKS.contains(&name)
        })
        .collect();
    let question = if kept.is_empty() { "" } else { "?" };
    Some(format!("{origin}{path}{question}{}", kept.join("&")))
}

/// Parameters of the address that links leave out: those of an embedded page, and those of a record store, with which others
/// could write there. The empty name is that of the one part into which an address without parameters is split.
const NOT_IN_LINKS: [&str; 7] = [
    "",
    "embed",
    "origin",
    "endpoint",
    "auth",
    "actor",
    "registration",
];

/// Returns the name of a backend.
fn name_of(backend: wgpu::Backend) -> &'static str {
    match backend {
        wgpu::Backend::BrowserWebGpu => "WebGPU",
        _ => "WebGL 2",
    }
}
