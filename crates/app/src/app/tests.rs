//! The window frame by frame, without a display: several presses in one slow frame, scrolling of lists, and sentences
//! that are not cut off.

use egui::accesskit::{Node, NodeId};
use egui::{Event, Key, Modifiers, PointerButton, Pos2, RawInput, Rect};
use tilescope_canvas::objects::MAX_OF_KIND;
use tilescope_classroom::lessons::LessonCommand;
use tilescope_core::Stage;
use tilescope_debugger::{EventKind, Target};
use tilescope_session::octaves::counted_cells;
use tilescope_session::sentence::happened;

use super::*;
use tilescope_workbench::clock::Clock;
use tilescope_workbench::command::{
    AppearanceCommand, DebugCommand, FormCommand, TimeCommand, ViewCommand, Which, WindowCommand,
};
use tilescope_workbench::draft::Preset;
use tilescope_workbench::embedding::Embedding;
use tilescope_workbench::export::{ExportCommand, ExportKind};
use tilescope_workbench::scenes::SceneCommand;

/// A window without a display.
struct Window {
    ctx: Context,
    app: App,
    size: egui::Vec2,
    nodes: Vec<(NodeId, Node)>,
    shapes: Vec<egui::epaint::ClippedShape>,
}

impl Window {
    fn opened(size: [f32; 2]) -> Self {
        let ctx = Context::default();
        ctx.enable_accesskit();
        let mut app = App::new(&ctx);
        app.state.settle();
        let mut window = Self {
            ctx,
            app,
            size: size.into(),
            nodes: Vec::new(),
            shapes: Vec::new(),
        };
        window.rest();
        window
    }

    /// The window at its first start, before anything was stored.
    fn first(size: [f32; 2]) -> Self {
        let ctx = Context::default();
        ctx.enable_accesskit();
        let mut app = App::new(&ctx);
        app.remember(&MemoryStorage::default(), true);
        let mut window = Self {
            ctx,
            app,
            size: size.into(),
            nodes: Vec::new(),
            shapes: Vec::new(),
        };
        window.rest();
        window
    }

    /// Returns the share of the window's area that the canvas has.
    fn canvas_share(&self) -> f32 {
        self.app.state.runs().first.viewport.area() / (self.size.x * self.size.y)
    }

    fn is_known(&self, id: &str) -> bool {
        let is_it = |node: &(NodeId, Node)| node.1.author_id() == Some(id);
        self.nodes.iter().any(is_it)
    }

    /// Shows one frame in which these events arrive.
    fn frame(&mut self, events: Vec<Event>) {
        let input = RawInput {
            events,
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, self.size)),
            ..RawInput::default()
        };
        let app = &mut self.app;
        let output = self.ctx.run_ui(input, |ui| app.show(ui));
        if let Some(update) = &output.platform_output.accesskit_update {
            self.nodes.clone_from(&update.nodes);
        }
        self.shapes.clone_from(&output.shapes);
        output.drop_without_applying_deltas();
    }

    /// Shows frames until what was requested has been drawn.
    fn rest(&mut self) {
        for _ in 0..5 {
            self.app.state.settle();
            self.frame(Vec::new());
        }
    }

    fn apply(&mut self, command: Command) {
        self.app.state.apply(command);
        self.rest();
    }

    fn cursor(&self) -> usize {
        self.app.state.runs().first.cursor().expect("events").0
    }

    /// Returns where the widget of an id is.
    fn rect_of(&self, id: &str) -> Rect {
        let known = |node: &&(NodeId, Node)| node.1.author_id() == Some(id);
        let found = self.nodes.iter().find(known);
        let bounds = found.and_then(|node| node.1.bounds());
        let bounds = bounds.unwrap_or_else(|| panic!("nothing is known as {id}"));
        let scale = self.ctx.pixels_per_point();
        Rect::from_min_max(
            egui::pos2(bounds.x0 as f32, bounds.y0 as f32) / scale,
            egui::pos2(bounds.x1 as f32, bounds.y1 as f32) / scale,
        )
    }
}

fn press(key: Key, modifiers: Modifiers) -> Event {
    Event::Key {
        key,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers,
    }
}

fn click(at: Pos2) -> [Event; 3] {
    let button = |pressed| Event::PointerButton {
        pos: at,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    [Event::PointerMoved(at), button(true), button(false)]
}

#[test]
fn a_click_within_one_frame_goes_there_on_the_timeline() {
    for size in [[1440.0, 900.0], [390.0, 844.0]] {
        let mut window = Window::opened(size);
        let track = window.rect_of("moment");
        let (_, len) = window.app.state.runs().first.cursor().unwrap();
        let mut before = len;
        for part in [0.8, 0.35, 0.6] {
            // On the bar; its lower half has the names of the stages.
            let at = egui::pos2(track.left() + part * track.width(), track.top() + 8.0);
            window.frame(click(at).to_vec());
            window.rest();
            assert_ne!(window.cursor(), before);
            before = window.cursor();
        }
    }
}

#[test]
fn keys_of_one_frame_count_one_after_the_other() {
    let mut window = Window::opened([1440.0, 900.0]);
    let event = Command::Time(TimeCommand::Clock(Clock::Event));
    window.apply(event);
    let keys = |keys: &[Key]| {
        keys.iter()
            .map(|&key| press(key, Modifiers::NONE))
            .collect()
    };
    // At the end stepping forward is unavailable; after Home it is available again.
    window.frame(keys(&[Key::Home, Key::ArrowRight, Key::ArrowRight]));
    assert_eq!(window.cursor(), 2);
    window.frame(keys(&[Key::End, Key::ArrowLeft]));
    let (cursor, len) = window.app.state.runs().first.cursor().unwrap();
    assert_eq!(cursor, len - 1);
    // Each run to an event begins at the end of the one before.
    window.frame(keys(&[Key::Home, Key::E, Key::E]));
    let state = &window.app.state;
    let recording = state
        .runs()
        .first
        .session
        .as_ref()
        .unwrap()
        .recording()
        .unwrap();
    let eliminations = recording.tape().from(0).take(window.cursor());
    let count = eliminations.filter(|(_, event)| event.kind() == EventKind::Eliminate);
    assert_eq!(count.count(), 2);
    // The shortcut that opens the list of actions, and the one that closes it.
    window.frame(vec![
        press(Key::K, Modifiers::COMMAND),
        press(Key::Escape, Modifiers::NONE),
    ]);
    window.rest();
    assert!(window.app.state.window().finder.is_none());
}

/// Returns the ids marked as current, among those for which `is_meant` holds.
fn current(window: &Window, is_meant: fn(&str) -> bool) -> Vec<&str> {
    let is_current =
        |node: &Node| node.toggled() == Some(egui::accesskit::Toggled::True) && !node.is_hidden();
    let found = window.nodes.iter().map(|(_, node)| node);
    let ids = found
        .filter(|node| is_current(node))
        .filter_map(Node::author_id);
    ids.filter(|id| is_meant(id)).collect()
}

fn is_event(id: &str) -> bool {
    id.starts_with("event-")
}

#[test]
fn the_tree_shows_the_last_event_wherever_one_goes() {
    let mut window = Window::opened([1440.0, 900.0]);
    window.apply(Command::Window(WindowCommand::OpenPanel(Panel::Events)));
    let (_, len) = window.app.state.runs().first.cursor().unwrap();
    // Short and long jumps, both ways, into branches that were never expanded.
    let mut at = 7_usize;
    for step in 0..40 {
        at = (at * 7_919 + 13 * step) % len + 1;
        window.apply(Command::Time(TimeCommand::Jump(at)));
        let expected = [format!("event-{}", at - 1)];
        assert_eq!(current(&window, is_event), expected, "at {at}");
    }
}

#[test]
fn all_panels_show_the_same_moment() {
    let mut window = Window::opened([1440.0, 900.0]);
    window.apply(Command::Window(WindowCommand::OpenPanel(Panel::Events)));
    window.apply(Command::Time(TimeCommand::FirstStage));
    for target in [
        Target::Conflict,
        Target::Elimination,
        Target::Gap,
        Target::Insertion,
    ] {
        let forwards = tilescope_debugger::Direction::Forwards;
        window.apply(Command::Time(TimeCommand::RunTo(target, forwards)));
        let (cursor, recording) = {
            let state = &window.app.state;
            let session = state.runs().first.session.as_ref().unwrap();
            (
                state.runs().first.cursor().unwrap().0,
                Arc::clone(session.recording().unwrap()),
            )
        };
        // Row, line and sentence belong to the last event.
        let row = format!("event-{}", cursor - 1);
        assert_eq!(current(&window, is_event)[0], row);
        let listings = tilescope_debugger::Listings::shipped();
        let id = |index: usize| {
            let event = recording.event(index).unwrap();
            listings.line(event.line()).unwrap().id.clone()
        };
        let line = |index: usize| format!("{}.line", id(index));
        let lines = current(&window, |id| id.contains(".line"));
        assert_eq!(lines, [line(cursor - 1)]);
        // They are labelled as the line that has run and the one that runs next.
        for (index, tag) in [(cursor - 1, "done"), (cursor, "next")] {
            let line = line(index);
            let known = |node: &&(NodeId, Node)| node.1.author_id() == Some(line.as_str());
            let found = window.nodes.iter().find(known);
            let label = found.and_then(|node| node.1.label()).unwrap_or_default();
            assert!(label.contains(tag), "{label}");
        }
    }
}

/// Returns the drawn galleys with a text, each with its rectangle and its clip rectangle.
fn drawn(window: &Window, text: &str) -> Vec<(bool, Rect, Rect)> {
    fn visit(shape: &egui::Shape, clip: Rect, text: &str, found: &mut Vec<(bool, Rect, Rect)>) {
        match shape {
            egui::Shape::Text(shape) if shape.galley.text() == text => {
                let rect = Rect::from_min_size(shape.pos, shape.galley.size());
                found.push((shape.galley.elided, rect, clip));
            }
            egui::Shape::Vec(shapes) => {
                for shape in shapes {
                    visit(shape, clip, text, found);
                }
            }
            _ => {}
        }
    }
    let mut found = Vec::new();
    for clipped in &window.shapes {
        visit(&clipped.shape, clipped.clip_rect, text, &mut found);
    }
    found
}

/// Returns cursors: of the event of each kind that has the longest sentence, and of the end of each stage.
fn longest(window: &Window) -> Vec<usize> {
    let session = window.app.state.runs().first.session.as_ref().unwrap();
    let recording = session.recording().unwrap();
    let mut longest = std::collections::BTreeMap::<&str, (usize, usize)>::new();
    for (index, event) in recording.tape().from(0) {
        let length = tilescope_debugger::sentence(recording, index).len();
        let most = longest.entry(event.kind().name()).or_default();
        *most = (*most).max((length, index + 1));
    }
    let ends = (0..session.stages.len()).filter_map(|index| session.stage_end(index));
    longest
        .values()
        .map(|&(_, cursor)| cursor)
        .chain(ends)
        .collect()
}

#[test]
fn sentences_are_whole() {
    let projector = Some(Look::Projector);
    let player = Some(Embedding::Player);
    for (size, look, embedding) in [
        ([1280.0, 720.0], None, None),
        ([1024.0, 768.0], None, None),
        ([1600.0, 1000.0], None, None),
        ([1920.0, 1080.0], projector, None),
        ([1280.0, 720.0], projector, None),
        ([860.0, 480.0], None, player),
        ([844.0, 390.0], None, None),
    ] {
        let mut window = Window::opened(size);
        window.app.state.restore(Settings {
            embedding: Some(embedding),
            ..Settings::default()
        });
        if let Some(look) = look {
            window.apply(Command::Appearance(AppearanceCommand::Look(look)));
            // What a projector shows is larger.
            window.size /= window.ctx.zoom_factor();
            window.rest();
        }
        let mut tops = std::collections::BTreeSet::new();
        for cursor in longest(&window) {
            window
                .app
                .state
                .apply(Command::Time(TimeCommand::Jump(cursor)));
            window.frame(Vec::new());
            window.frame(Vec::new());
            let text = happened(window.app.state.runs().first.shown().as_ref());
            let found = drawn(&window, &text);
            let whole = |&(elided, rect, clip): &(bool, Rect, Rect)| {
                !elided && clip.expand(0.5).contains_rect(rect)
            };
            assert!(found.iter().any(whole), "{size:?} \"{text}\": {found:?}");
            let track = window.rect_of("moment");
            let all = Rect::from_min_size(Pos2::ZERO, window.size);
            assert!(all.contains_rect(track), "{size:?}: {track:?}");
            tops.insert(track.top() as i32);
        }
        // Nothing moves on screen from event to event.
        assert_eq!(tops.len(), 1, "{size:?}: {tops:?}");
    }
}

#[test]
fn the_default_session_has_its_gaps_where_it_fits() {
    for size in [[1280.0, 720.0], [1024.0, 768.0], [1440.0, 900.0]] {
        let mut window = Window::opened(size);
        window.apply(Command::View(Which::First, ViewCommand::Fit));
        while window.app.state.advance(0.1) {}
        let scale = window.app.state.runs().first.camera.scale;
        assert!(
            scale >= tilescope_drawing::MIN_DISK_SCALE,
            "{size:?}: {scale}"
        );
    }
}

#[test]
fn a_scene_and_a_row_lead_to_the_same_moment() {
    let mut window = Window::opened([1440.0, 900.0]);
    window.apply(Command::Window(WindowCommand::OpenPanel(Panel::Events)));
    window.apply(Command::Time(TimeCommand::Jump(4_000)));
    window.apply(Command::Scene(SceneCommand::Add));
    window.apply(Command::Time(TimeCommand::FirstStage));
    let last = window
        .app
        .state
        .runs()
        .first
        .debugger
        .as_ref()
        .unwrap()
        .scenes[0]
        .event
        - 1;
    window.apply(Command::Debug(DebugCommand::SelectEvent(last)));
    assert_eq!(window.cursor(), 4_000);
}

#[test]
fn the_first_start_shows_the_tour_alone_on_a_large_canvas() {
    for size in [[1280.0, 720.0], [1440.0, 900.0], [1920.0, 1080.0]] {
        let mut window = Window::first(size);
        let state = &window.app.state;
        assert!(
            state.scenes().is_touring()
                && !state.lessons().shows_list
                && !state.window().shows_sides()
        );
        let share = window.canvas_share();
        assert!(share >= 0.6, "{size:?}: {share}");
        let canvas = state.runs().first.viewport;
        assert!(canvas.contains_rect(window.rect_of("caption")), "{size:?}");
        // The last card brings the panels and offers the lessons.
        let forwards = SceneCommand::Step(tilescope_debugger::Direction::Forwards);
        for _ in 1..tilescope_workbench::tour::tour().len() {
            window.apply(Command::Scene(forwards.clone()));
        }
        assert!(window.app.state.scenes().is_touring() && window.app.state.window().shows_sides());
        let lessons = window.rect_of("caption-offer-1").center();
        window.frame(click(lessons).to_vec());
        window.rest();
        assert!(window.app.state.lessons().shows_list && !window.app.state.scenes().is_touring());
        assert!(window.is_known("lesson-welcome"), "{size:?}");
    }
}

#[test]
fn the_camera_of_the_first_frame_is_right_in_every_window() {
    let sizes = [
        [1280.0, 720.0],
        [1920.0, 1080.0],
        [390.0, 844.0],
        [844.0, 390.0],
    ];
    for size in sizes {
        let window = Window::first(size);
        let run = &window.app.state.runs().first;
        // The first scene shows 26 r across the shorter side of the canvas.
        let shown = f64::from(run.viewport.size().min_elem()) / run.camera.scale;
        assert!((shown - 26.0).abs() < 0.1, "{size:?}: {shown}");
    }
}

#[test]
fn on_a_phone_the_card_of_the_tour_stands_below_a_canvas_of_half_the_height() {
    for size in [[390.0, 844.0], [320.0, 568.0], [360.0, 640.0]] {
        let mut window = Window::first(size);
        for _ in tilescope_workbench::tour::tour() {
            let canvas = window.app.state.runs().first.viewport;
            assert!(
                canvas.height() >= 0.5 * size[1] - 1.0,
                "{size:?}: {canvas:?}"
            );
            let card = window.rect_of("caption-title");
            assert!(
                card.top() >= canvas.bottom(),
                "{size:?}: {card:?} in {canvas:?}"
            );
            let forwards = SceneCommand::Step(tilescope_debugger::Direction::Forwards);
            let state = &window.app.state;
            let last = tilescope_workbench::tour::tour().len() - 1;
            if state.scenes().shown.is_some_and(|shown| shown.index < last) {
                window.apply(Command::Scene(forwards));
            }
        }
        if size[1] > 800.0 {
            // Where the card need not scroll, its buttons are in the window.
            assert!(
                window.rect_of("caption-next").bottom() <= size[1],
                "{size:?}"
            );
        }
    }
}

#[test]
fn panels_that_a_lesson_hides_are_there_after_a_restart() {
    let mut window = Window::opened([1440.0, 900.0]);
    let layout = window.app.state.window().layout.clone();
    let open = LessonCommand::Open("welcome".to_owned());
    window.apply(Command::Lesson(open));
    assert_ne!(window.app.state.window().layout, layout);
    let mut storage = MemoryStorage::default();
    eframe::App::save(&mut window.app, &mut storage);
    let mut app = App::new(&Context::default());
    app.remember(&storage, true);
    assert_eq!(app.state.window().layout, layout);
}

#[test]
fn a_laptops_window_with_a_lesson_keeps_its_tiles_and_the_title_its_place() {
    let mut window = Window::opened([1280.0, 720.0]);
    let names: Vec<String> = {
        let shelf = window.app.state.lessons().shelf.iter();
        shelf.map(|lesson| lesson.name.to_string()).collect()
    };
    for language in ["en", "de"] {
        let command = LessonCommand::Language(language.to_owned());
        window.apply(Command::Lesson(command));
        for name in &names {
            window.apply(Command::Lesson(LessonCommand::Open(name.clone())));
            let arrangement = window.app.state.window().drawer.arrangement;
            assert_eq!(arrangement, Arrangement::Tiles);
            let (title, present) = (
                window.rect_of("lesson-title"),
                window.rect_of("lesson-present"),
            );
            assert!(
                title.right() <= present.left(),
                "{name}: {title:?} {present:?}"
            );
        }
    }
}

#[test]
fn a_click_on_a_copy_counts_as_one_on_what_it_is_a_copy_of() {
    let mut window = Window::opened([1440.0, 900.0]);
    let run = &window.app.state.runs().first;
    let session = run.session.clone().unwrap();
    let size = session.size_radii();
    // A sample near the lower border, whose copy stands beyond the upper one.
    let samples = 0..session.run().samples.points.len() as u32;
    let mut kept = samples.filter(|&id| {
        let shown = run.shown().unwrap();
        shown.covers(id) && session.position(id).y < 1.0 && session.position(id).x > 20.0
    });
    let sample = kept.next().unwrap();
    let copy = session.position(sample) + glam::DVec2::new(0.0, size.y);
    window.apply(Command::View(Which::First, ViewCommand::FlyTo(copy, 9.0)));
    for _ in 0..200 {
        window.app.state.advance(0.1);
    }
    window.rest();
    let screen = |window: &Window, at: glam::DVec2| {
        let run = &window.app.state.runs().first;
        run.camera.screen_from_domain(run.viewport, at)
    };
    let at = screen(&window, copy);
    window.frame(click(at).to_vec());
    window.rest();
    assert_eq!(window.app.state.runs().first.selected, Some(sample));
    // Between samples the place of the domain is selected.
    let place = copy + glam::DVec2::new(0.45, 0.2);
    let at = screen(&window, place);
    window.frame(click(at).to_vec());
    window.rest();
    let run = &window.app.state.runs().first;
    let selected = run
        .place
        .or_else(|| run.selected.map(|id| session.position(id)));
    let selected = selected.expect("a place or a sample");
    assert!(selected.y < 3.0, "{selected}");
    // Far outside, where nothing is drawn, there is nothing to select.
    let out = glam::DVec2::new(copy.x, size.y + 20.0);
    window.apply(Command::View(Which::First, ViewCommand::FlyTo(out, 9.0)));
    for _ in 0..200 {
        window.app.state.advance(0.1);
    }
    window.rest();
    let at = screen(&window, out);
    window.frame(click(at).to_vec());
    window.rest();
    let run = &window.app.state.runs().first;
    assert_eq!((run.selected, run.place), (None, None));
}

#[test]
fn a_running_export_is_seen_after_its_sheet_is_closed() {
    let folder = tempfile::tempdir().unwrap();
    let mut window = Window::opened([1440.0, 900.0]);
    let path = folder.path().join("run.gif").to_string_lossy().into_owned();
    for command in [
        ExportCommand::Open(ExportKind::Animation),
        ExportCommand::WholeRun(true),
        ExportCommand::Path(path),
        ExportCommand::Write,
    ] {
        window.app.state.apply(Command::Export(command));
    }
    window.frame(Vec::new());
    assert!(!window.is_known("export-chip"), "the sheet shows it");
    window
        .app
        .state
        .apply(Command::Export(ExportCommand::Close));
    window.frame(Vec::new());
    window.frame(Vec::new());
    let cancel = window.rect_of("export-chip.cancel").center();
    assert!(window.is_known("export-chip"));
    // A frame takes the press, the next one the release.
    window.frame(click(cancel).to_vec());
    window.frame(Vec::new());
    window.rest();
    assert!(!window.is_known("export-chip"));
    let left: Vec<_> = std::fs::read_dir(folder.path())
        .unwrap()
        .map(|entry| entry.unwrap().file_name())
        .collect();
    assert!(left.is_empty(), "{left:?}");
}

#[test]
fn results_are_in_the_folder_at_the_answer_and_the_last_session_at_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let kept = KeptFolder::new(folder.path().to_owned());
    let mut window = Window::opened([1440.0, 900.0]);
    window.app.keep_in(kept.clone(), true);
    window.apply(Command::Lesson(LessonCommand::Name("Ada".to_owned())));
    window.app.keep_results();
    let read = |folder: &std::path::Path| std::fs::read_to_string(folder.join("results.json"));
    assert!(read(folder.path()).unwrap().contains("Ada"));
    // Another window takes them, and is offered the session once something was done in this one.
    let next = |is_default| {
        let mut app = App::new(&Context::default());
        app.keep_in(kept.clone(), is_default);
        (
            app.state.lessons().results.learner.clone(),
            app.state
                .files()
                .offers_session(app.state.past(), app.state.window()),
        )
    };
    window.app.keep_session();
    assert_eq!(next(true), ("Ada".to_owned(), false));
    window.apply(Command::Scene(SceneCommand::Add));
    window.app.keep_session();
    assert!(
        next(true).1 && !next(false).1,
        "a link or a file opens something else"
    );
}

/// A storage in memory.
#[derive(Default)]
struct MemoryStorage(std::collections::HashMap<String, String>);

impl eframe::Storage for MemoryStorage {
    fn get_string(&self, key: &str) -> Option<String> {
        self.0.get(key).cloned()
    }

    fn set_string(&mut self, key: &str, value: String) {
        self.0.insert(key.to_owned(), value);
    }

    fn remove_string(&mut self, key: &str) {
        self.0.remove(key);
    }

    fn flush(&mut self) {}
}

#[test]
fn the_tour_begins_at_the_first_start_of_the_default_session_only() {
    let begins = |storage: &MemoryStorage, is_default| {
        let mut app = App::new(&Context::default());
        app.remember(storage, is_default);
        app.state.scenes().is_touring()
    };
    let mut storage = MemoryStorage::default();
    assert!(begins(&storage, true) && !begins(&storage, false));
    eframe::App::save(&mut Window::opened([1440.0, 900.0]).app, &mut storage);
    assert!(!begins(&storage, true));
}

#[test]
fn the_panels_stand_where_they_stood() {
    let mut first = Window::opened([1440.0, 900.0]);
    first
        .app
        .state
        .apply(Command::Window(WindowCommand::OpenPanel(Panel::Legend)));
    let mut storage = MemoryStorage::default();
    eframe::App::save(&mut first.app, &mut storage);
    let remembered = |storage: &MemoryStorage| {
        let mut app = App::new(&Context::default());
        app.remember(storage, true);
        app.state.window().layout.clone()
    };
    assert_eq!(remembered(&storage), first.app.state.window().layout);
}

/// Returns the texts of the options of the list of objects, in their order.
fn options(window: &Window) -> Vec<String> {
    let options = window
        .nodes
        .iter()
        .filter(|(_, node)| node.role() == egui::accesskit::Role::ListBoxOption);
    options
        .filter_map(|(_, node)| node.label().map(str::to_owned))
        .collect()
}

/// Returns a window in the middle of a run, where the list has samples and blocks.
fn amid_objects() -> Window {
    let mut window = Window::opened([1440.0, 900.0]);
    window.apply(Command::Time(TimeCommand::Jump(1_000)));
    window.rest();
    window
}

/// Returns the first node that `is_it` accepts.
fn node_of(window: &Window, is_it: impl Fn(&Node) -> bool) -> NodeId {
    let found = window.nodes.iter().find(|(_, node)| is_it(node));
    found.map(|(id, _)| *id).expect("there is such a node")
}

/// Returns a request of a screen reader.
fn request(target_node: NodeId, action: egui::accesskit::Action) -> Event {
    Event::AccessKitActionRequest(egui::accesskit::ActionRequest {
        action,
        target_tree: egui::accesskit::TreeId::ROOT,
        target_node,
        data: None,
    })
}

/// Returns the selected sample and the selected place, in r.
fn selected(window: &Window) -> (Option<u32>, Option<glam::DVec2>) {
    let run = &window.app.state.runs().first;
    (run.selected, run.place)
}

#[test]
fn the_list_of_objects_has_a_dozen_of_each_kind_and_counts_the_others() {
    let window = amid_objects();
    let all = options(&window);
    assert!((20..=45).contains(&all.len()), "{all:?}");
    let count = |kind: &str| all.iter().filter(|text| text.starts_with(kind)).count();
    let session = window.app.state.runs().first.session.as_ref().unwrap();
    let blocks = session.run().blocks.leaves.len();
    assert_eq!(
        [count("Sample "), count("Block ")],
        [MAX_OF_KIND, blocks.min(MAX_OF_KIND)],
        "{all:?}"
    );
    let is_count = |text: &String| text.ends_with("more samples in view");
    assert!(all.iter().any(is_count), "{all:?}");
}

#[test]
fn the_list_counts_active_cells_by_octave() {
    let mut window = Window::opened([1440.0, 900.0]);
    window.apply(Command::Form(FormCommand::Preset(Preset::Ramp)));
    window.apply(Command::Run);
    let counted = |window: &Window| -> Vec<String> {
        let all = options(window).into_iter();
        all.filter(|text| text.contains("of octave")).collect()
    };
    // At the end no cell is active.
    assert!(counted(&window).is_empty());

    // The fifth throw is the first of cells that were cut.
    window.apply(Command::Time(TimeCommand::ShowStage(4)));
    let session = window.app.state.runs().first.session.as_ref().unwrap();
    let counts = session.cells_by_octave(Stage::Iterate(5)).unwrap();
    let throw = session.iteration(5).unwrap();
    assert_eq!(counts.iter().sum::<usize>(), throw.cells.len());
    let wanted: Vec<String> = (counts.into_iter().enumerate())
        .map(|(octave, count)| counted_cells(count, octave))
        .collect();
    // Nodes of the tree come in no order.
    let said = counted(&window);
    assert!(wanted.iter().all(|text| said.contains(text)), "{said:?}");
    assert_eq!([wanted.len(), said.len()], [3, 3]);
}

#[test]
fn the_list_has_what_the_plane_through_a_set_in_space_cuts() {
    let mut window = Window::opened([1440.0, 900.0]);
    let link = "v=1&radius=0.5&width=6&height=5.5&depth=5&plane=z:2.5";
    window.app.state.open_link(link);
    window.rest();

    // At the end no cube is active. Most balls lie above the plane or below it.
    let count = |window: &Window, part: &str| {
        let all = options(window).into_iter();
        all.filter(|text| text.contains(part)).count()
    };
    assert_eq!(count(&window, "Sample "), MAX_OF_KIND);
    let aside = count(&window, " r above the plane") + count(&window, " r below the plane");
    assert!(aside > MAX_OF_KIND / 2);
    assert_eq!(count(&window, "Active cube"), 0);

    // All cells of the layer are active in the first throw: 12 x 11 of them.
    window.apply(Command::Time(TimeCommand::ShowStage(0)));
    assert_eq!(
        count(&window, "Active cube of side 1.00 r"),
        MAX_OF_KIND,
        "{:?}",
        options(&window)
    );
    let nodes = window.nodes.iter().filter_map(|(_, node)| node.label());
    let more = nodes.filter(|label| label.ends_with("more active cubes in view"));
    assert_eq!(more.count(), 1);
}

#[test]
fn arrow_keys_select_objects_of_the_list() {
    let mut window = amid_objects();
    let list = node_of(&window, |node| node.author_id() == Some("objects-a"));
    window.frame(vec![request(list, egui::accesskit::Action::Focus)]);
    assert_eq!(selected(&window), (None, None));

    // Down leads to the first object and on to the second one; up leads back.
    let mut seen = Vec::new();
    for key in [Key::ArrowDown, Key::ArrowDown, Key::ArrowUp] {
        window.frame(vec![press(key, Modifiers::NONE)]);
        window.rest();
        seen.push(selected(&window));
    }
    assert_ne!(seen[0], (None, None));
    assert_ne!(seen[1], seen[0]);
    assert_eq!(seen[2], seen[0]);

    // The first key came in the frame after the focus, and has not moved it.
    let focused = window.ctx.memory(egui::Memory::focused);
    assert_eq!(focused.map(|id| id.accesskit_id()), Some(list));
    // The arrows moved neither the picture nor the time.
    assert_eq!(window.cursor(), 1_000);
}

#[test]
fn a_request_of_a_screen_reader_selects_an_object() {
    let mut window = amid_objects();
    let all = options(&window);
    let is_sample = |text: &&String| text.starts_with("Sample ");
    let target = all.iter().rfind(is_sample).unwrap();
    let option = node_of(&window, |node| node.label() == Some(target.as_str()));
    window.frame(vec![request(option, egui::accesskit::Action::Click)]);
    window.rest();
    let (Some(id), None) = selected(&window) else {
        panic!("{target} is not selected: {:?}", selected(&window));
    };
    let number = tilescope_session::words::grouped(id as usize);
    assert!(target.starts_with(&format!("Sample {number} ")), "{target}");
}

#[test]
fn the_list_of_objects_is_empty_while_time_runs_by_itself() {
    let mut window = amid_objects();
    window.apply(Command::Time(TimeCommand::TogglePlay));
    assert_eq!(options(&window), Vec::<String>::new());
    window.apply(Command::Time(TimeCommand::TogglePlay));
    assert!(!options(&window).is_empty());
}

#[test]
fn an_open_question_has_no_list_of_objects() {
    let mut window = Window::opened([1440.0, 900.0]);
    let open = LessonCommand::Open("survivors".to_owned());
    window.apply(Command::Lesson(open));
    for step in ["one-of-two", "chain"] {
        window.apply(Command::Lesson(LessonCommand::Go(step.to_owned())));
        assert!(window.app.state.lessons().open_question().is_some());
        assert_eq!(options(&window), Vec::<String>::new());
    }
    // Without a question there is one.
    window.apply(Command::Lesson(LessonCommand::Leave));
    assert!(!options(&window).is_empty());
}
