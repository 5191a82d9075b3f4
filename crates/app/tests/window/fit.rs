//! Every panel at the sizes of small screens: no widget and no text is cut off, and Run is always visible.

use egui::epaint::ClippedShape;
use egui::{Rect, Shape, Vec2, pos2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use tilescope_app::App;
use tilescope_classroom::lessons::LessonCommand;
use tilescope_core::Parameter;
use tilescope_debugger::{Direction, Listings, Target};
use tilescope_session::selection::Selection;
use tilescope_workbench::Command;
use tilescope_workbench::arrangement::DrawerCommand;
use tilescope_workbench::command::{
    AppearanceCommand, DebugCommand, FormCommand, GpuCommand, TimeCommand, ViewCommand, Which,
    WindowCommand,
};
use tilescope_workbench::compare::{CompareCommand, ComparePreset};
use tilescope_workbench::device::EngineChoice;
use tilescope_workbench::layout::Panel;
use tilescope_workbench::scenes::SceneCommand;

use crate::support::{find, node, opened_at, settle};

/// Projectors, small laptops, and the smallest window with tiles.
const SCREENS: [[f32; 2]; 4] = [
    [1024.0, 768.0],
    [1280.0, 720.0],
    [1366.0, 768.0],
    [960.0, 600.0],
];
/// 1280 x 720 at 200% and at 400%, and phones in landscape.
const LOW: [[f32; 2]; 4] = [
    [640.0, 360.0],
    [320.0, 180.0],
    [568.0, 320.0],
    [667.0, 375.0],
];

/// A small run in the middle of its elimination, with something in every panel.
fn busy(size: [f32; 2]) -> Harness<'static, App> {
    let mut harness = opened_at(size);
    let state = &mut harness.state_mut().state;
    for command in [
        Command::Appearance(AppearanceCommand::ToggleReducedMotion),
        Command::Form(FormCommand::Type(Parameter::Radius, "0.03".to_owned())),
        Command::Form(FormCommand::Type(Parameter::Leaf, "12".to_owned())),
        Command::Run,
    ] {
        state.apply(command);
    }
    state.settle();
    let line = Listings::shipped().find("eliminate.5").expect("a line");
    for command in [
        Command::Time(TimeCommand::FirstStage),
        Command::Time(TimeCommand::RunTo(Target::Elimination, Direction::Forwards)),
        Command::Debug(DebugCommand::ToggleBreakpoint(line)),
        Command::Debug(DebugCommand::Condition(0, "distance < 0.5".to_owned())),
        Command::Debug(DebugCommand::Watch("distance".to_owned())),
        Command::Scene(SceneCommand::Add),
        Command::View(Which::First, ViewCommand::Pick(Selection::Sample(40))),
        Command::Compare(CompareCommand::Start(ComparePreset::Order)),
    ] {
        state.apply(command);
    }
    settle(&mut harness);
    harness
}

fn flat<'a>(shape: &'a Shape, found: &mut Vec<&'a Shape>) {
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|shape| flat(shape, found)),
        shape => found.push(shape),
    }
}

/// Returns whether an interval is partly outside of `clip`.
fn is_cut(rect: Rect, clip: Rect) -> bool {
    let is_seen = rect.intersect(clip).is_positive();
    is_seen && (rect.left() < clip.left() - 1.0 || rect.right() > clip.right() + 1.0)
}

/// Returns the texts shortened or cut off at the left or right, except those over the canvas and the sentence, whose
/// length varies.
fn cut_texts(harness: &Harness<'_, App>) -> Vec<String> {
    let state = &harness.state().state;
    let mut canvas = state.runs().first.viewport.expand(0.5);
    if let Some((second, _)) = &state.runs().second {
        // The two runs have headings.
        canvas = canvas.union(second.viewport.expand(0.5));
        canvas.min.y -= 50.0;
    }
    let sentence = state.runs().first.debugger.as_ref().map(|debugger| {
        let last = debugger.state().cursor().saturating_sub(1);
        tilescope_debugger::sentence(debugger.recording(), last)
    });
    let window = harness.ctx.content_rect();
    let mut cut = Vec::new();
    for ClippedShape {
        clip_rect, shape, ..
    } in &harness.output().shapes
    {
        if canvas.contains_rect(*clip_rect) {
            continue;
        }
        let clip = clip_rect.intersect(window);
        let mut shapes = Vec::new();
        flat(shape, &mut shapes);
        for shape in shapes {
            let Shape::Text(text) = shape else {
                continue;
            };
            if sentence.as_deref() == Some(text.galley.text()) {
                continue;
            }
            let rect = text.visual_bounding_rect();
            let is_short = text.galley.elided && rect.intersects(clip);
            if is_short || is_cut(rect, clip) {
                cut.push(format!("{:?} at {rect:?} in {clip:?}", text.galley.text()));
            }
        }
    }
    cut
}

/// Returns the widgets cut off at the left or right.
fn cut_widgets(harness: &Harness<'_, App>) -> Vec<String> {
    harness.ctx.viewport(|viewport| {
        let layers = viewport.this_pass.widgets.layers();
        let widgets = layers.flat_map(|(_, widgets)| widgets);
        let pressed = widgets.filter(|it| it.sense.interactive());
        let cut = pressed.filter(|it| is_cut(it.rect, it.interact_rect));
        cut.map(|it| format!("{:?} in {:?}", it.rect, it.interact_rect))
            .collect()
    })
}

fn within(harness: &Harness<'_, App>, id: &str) {
    let rect = node(harness, id).rect();
    let window = harness.ctx.content_rect().expand(0.5);
    assert!(window.contains_rect(rect), "{id}: {rect:?} in {window:?}");
}

#[test]
fn no_panel_is_cut_off_on_a_small_screen() {
    for size in SCREENS {
        let mut harness = busy(size);
        for panel in Panel::all() {
            harness
                .state_mut()
                .state
                .apply(Command::Window(WindowCommand::OpenPanel(panel)));
            harness.run();
            // Rows of lists vary in length and are shortened; their tooltips have the whole text.
            let window = harness.state().state.window();
            let lists = [Panel::Inspector, Panel::Events, Panel::Scenes];
            let listed = lists.into_iter().any(|list| window.shows(list));
            let texts = cut_texts(&harness);
            assert!(
                listed || texts.is_empty(),
                "{panel:?} at {size:?}: {texts:#?}"
            );
            let widgets = cut_widgets(&harness);
            assert!(widgets.is_empty(), "{panel:?} at {size:?}: {widgets:#?}");
            within(&harness, "time-toggle-play");
            within(&harness, "stage.eliminate");
            let arrow = harness.query_by_label("Scroll tabs right");
            assert!(arrow.is_none(), "no room for all tabs at {size:?}");
        }
    }
}

/// Checks that no button of the bar lies over another, and returns how many it has.
fn check_bar(harness: &Harness<'_, App>, size: [f32; 2]) -> usize {
    let buttons = harness.query_all_by(|node| {
        let bounds = node.bounding_box();
        bounds.is_some_and(|bounds| bounds.y1 <= 46.0)
    });
    let said = buttons.filter(|node| {
        let node = node.accesskit_node();
        // Rows of scrolled lists may lie behind the bar.
        let is_row = |id: &str| id.contains(".line") || id.contains(".breakpoint");
        node.label().is_some() && !node.author_id().is_some_and(is_row)
    });
    let rects: Vec<(Rect, String)> = said
        .map(|node| {
            (
                node.rect(),
                node.accesskit_node().label().unwrap_or_default(),
            )
        })
        .collect();
    for (k, (a, name)) in rects.iter().enumerate() {
        for (b, other) in &rects[..k] {
            let over = a.intersect(*b);
            let is_free = !over.is_positive() || over.width() < 1.0;
            assert!(is_free || name == other, "{name} over {other} at {size:?}");
        }
    }
    rects.len()
}

#[test]
fn nothing_of_the_bar_lies_over_another() {
    for size in SCREENS {
        assert!(check_bar(&opened_at(size), size) > 8);
    }
}

/// Names of menus are longer in German, and the bar is shorter beside a lesson.
#[test]
fn the_bar_has_room_for_long_names_of_menus() {
    for size in SCREENS {
        let mut harness = opened_at(size);
        let german = LessonCommand::Language("de".to_owned());
        harness.state_mut().state.apply(Command::Lesson(german));
        settle(&mut harness);
        harness.run();
        assert!(check_bar(&harness, size) > 8);
        assert!(find(&harness, "verdict").is_some(), "{size:?}");

        let open = LessonCommand::Open("clips".to_owned());
        harness.state_mut().state.apply(Command::Lesson(open));
        settle(&mut harness);
        harness.run();
        // Beside the lesson, the smaller of these windows have the bar of a phone.
        let is_small = (harness.state().state.window().drawer.arrangement).is_compact();
        assert_eq!(is_small, size[0] < 1280.0, "{size:?}");
        assert!(check_bar(&harness, size) > 8 || is_small);
    }
}

#[test]
fn run_is_seen_at_every_size() {
    for size in [
        [1024.0, 768.0],
        [1280.0, 720.0],
        [640.0, 480.0],
        [390.0, 844.0],
    ] {
        let mut harness = opened_at(size);
        // A remark on the engine leaves it in place.
        let state = &mut harness.state_mut().state;
        state.apply(Command::Gpu(GpuCommand::NameAdapter(Some(
            "no such adapter".to_owned(),
        ))));
        state.apply(Command::Gpu(GpuCommand::Engine(EngineChoice::Gpu)));
        settle(&mut harness);
        harness.state_mut().state.apply(Command::DismissNotice);
        let open = Command::Window(WindowCommand::OpenPanel(Panel::Parameters));
        harness.state_mut().state.apply(open);
        for text in ["0.00836", "0"] {
            let radius = Command::Form(FormCommand::Type(Parameter::Radius, text.to_owned()));
            harness.state_mut().state.apply(radius);
            harness.run();
            within(&harness, "run");
        }
    }
}

#[test]
fn low_windows_reach_everything() {
    for size in LOW {
        let mut harness = busy(size);
        for panel in Panel::all() {
            // Tabs of panels scroll.
            let show = DrawerCommand::Show(Some(panel));
            harness
                .state_mut()
                .state
                .apply(Command::Window(WindowCommand::Drawer(show)));
            settle(&mut harness);
            let tab = |text: &String| TABS.iter().any(|tab| text.starts_with(&format!("{tab:?}")));
            let listed = [
                Panel::Inspector,
                Panel::Events,
                Panel::Passes,
                Panel::Scenes,
            ]
            .contains(&panel);
            let mut texts = cut_texts(&harness);
            texts.retain(|text| !tab(text));
            assert!(
                listed || texts.is_empty(),
                "{panel:?} at {size:?}: {texts:#?}"
            );
        }
        harness
            .state_mut()
            .state
            .apply(Command::Window(WindowCommand::Drawer(DrawerCommand::Show(
                Some(Panel::Parameters),
            ))));
        settle(&mut harness);
        for id in [
            "menu",
            "time-toggle-play",
            "time-last-stage",
            "tab.parameters",
            "run",
        ] {
            node(&harness, id).focus();
            harness.run();
            within(&harness, id);
        }
        let chip = node(&harness, "verdict").rect();
        let title = find(&harness, "title").map(|node| node.rect());
        assert!(
            title.is_none_or(|title| !title.intersects(chip)),
            "{size:?}"
        );
    }
}

/// The names on the tabs of a compact window.
const TABS: [&str; 14] = [
    "Parameters",
    "Layers",
    "Playback",
    "Inspector",
    "Pseudocode",
    "Statistics",
    "Verification",
    "Events",
    "Scenes",
    "Watches",
    "Analysis",
    "Compare",
    "GPU passes",
    "Legend",
];

#[test]
fn a_tile_that_is_dragged_narrow_keeps_its_least_size() {
    let mut harness = opened_at([1440.0, 900.0]);
    let run = |harness: &Harness<'_, App>| node(harness, "run").rect();
    let before = run(&harness);
    let edge = pos2(
        harness.state().state.runs().first.viewport.left() - 1.0,
        400.0,
    );
    harness.drag_at(edge);
    harness.run();
    for x in [300.0, 200.0, 100.0, 20.0] {
        harness.hover_at(pos2(x, 400.0));
        harness.run();
    }
    harness.drop_at(pos2(20.0, 400.0));
    harness.run();
    let after = run(&harness);
    assert!(after.width() < before.width() + 0.5);
    assert!(harness.state().state.runs().first.viewport.left() > 200.0);
    assert_eq!(cut_texts(&harness), Vec::<String>::new());
    assert_eq!(cut_widgets(&harness), Vec::<String>::new());
}

#[test]
fn cut_off_widgets_are_found() {
    let text = |x: f32| Rect::from_min_size(pos2(x, 10.0), Vec2::new(40.0, 10.0));
    let clip = Rect::from_min_size(pos2(0.0, 0.0), Vec2::new(100.0, 100.0));
    assert!(!is_cut(text(60.0), clip) && is_cut(text(80.0), clip) && is_cut(text(-9.0), clip));
    // Widgets that are scrolled out of view do not count.
    assert!(!is_cut(text(120.0), clip));
}
