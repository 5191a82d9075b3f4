//! The window on its default session, driven as a user would.

pub mod sessions;

use std::fmt::Display;

use egui_kittest::kittest::{NodeT, Queryable};
use egui_kittest::{Harness, Node};
use std::sync::Arc;

use tilescope_app::App;
use tilescope_debugger::{Debugger, EventKind};
use tilescope_session::Session;

/// Maximum number of frames until the window is idle. Background work requests a frame with each progress report, so
/// this bounds no time, but finds a window that never becomes idle.
pub const MAX_FRAMES: u64 = 50_000;

/// Returns the window after its session is made and verified.
pub fn opened() -> Harness<'static, App> {
    opened_at([1440.0, 900.0])
}

/// Returns the window at a size.
pub fn opened_at(size: [f32; 2]) -> Harness<'static, App> {
    let mut harness = Harness::builder()
        .with_size(size)
        .with_max_steps(MAX_FRAMES)
        .build_eframe(|creation| App::new(&creation.egui_ctx));
    settle(&mut harness);
    harness
}

/// Waits for all background work, and shows the results.
pub fn settle(harness: &mut Harness<'_, App>) {
    harness.state_mut().state.settle();
    harness.run();
}

/// Returns the widget of an id, if it is on the screen.
pub fn find<'a, S>(harness: &'a Harness<'_, S>, id: impl Display) -> Option<Node<'a>> {
    let id = id.to_string();
    let mut found = harness.query_all_by(move |node| node.author_id() == Some(id.as_str()));
    let node = found.next()?;
    assert!(found.next().is_none(), "{:?} is there twice", author(&node));
    Some(node)
}

/// Returns the widget of an id.
#[track_caller]
pub fn node<'a, S>(harness: &'a Harness<'_, S>, id: impl Display) -> Node<'a> {
    let found = find(harness, &id);
    found.unwrap_or_else(|| panic!("nothing is known as {id}, but {:?}", ids(harness)))
}

/// Returns the text of a widget: its label, or its value if it is plain text.
#[track_caller]
pub fn text<S>(harness: &Harness<'_, S>, id: impl Display) -> String {
    let node = node(harness, id).accesskit_node();
    node.label().or(node.value()).unwrap_or_default()
}

/// Returns whether the widget of an id is disabled.
#[track_caller]
pub fn is_disabled<S>(harness: &Harness<'_, S>, id: impl Display) -> bool {
    node(harness, id).accesskit_node().is_disabled()
}

/// Returns the ids on the screen.
pub fn ids<S>(harness: &Harness<'_, S>) -> Vec<String> {
    let known = harness.query_all_by(|node| node.author_id().is_some());
    known.filter_map(|node| author(&node)).collect()
}

/// Returns the id of a widget, if it has one.
pub fn author(node: &Node<'_>) -> Option<String> {
    node.accesskit_node().author_id().map(str::to_owned)
}

/// Returns the id of the focused widget.
pub fn focused<S>(harness: &Harness<'_, S>) -> Option<String> {
    let mut nodes = harness.query_all_by(|node| node.is_focused() && !node.is_root());
    author(&nodes.next()?)
}

/// Returns the session that is shown.
pub fn session(harness: &Harness<'_, App>) -> Arc<Session> {
    let session = harness.state().state.runs().first.session.clone();
    session.expect("a session")
}

/// Returns the debugger of the session that is shown.
pub fn debugger<'a>(harness: &'a Harness<'_, App>) -> &'a Debugger {
    let debugger = harness.state().state.runs().first.debugger.as_ref();
    debugger.expect("events")
}

/// Returns how many events have happened.
pub fn cursor(harness: &Harness<'_, App>) -> usize {
    harness
        .state()
        .state
        .runs()
        .first
        .cursor()
        .expect("events")
        .0
}

/// Returns the last event.
pub fn last_kind(harness: &Harness<'_, App>) -> Option<EventKind> {
    let last = cursor(harness).checked_sub(1)?;
    let debugger = harness
        .state()
        .state
        .runs()
        .first
        .debugger
        .as_ref()
        .expect("events");
    let event = debugger.recording().event(last);
    event.map(tilescope_debugger::Event::kind)
}

/// Returns the next event.
pub fn next_kind(harness: &Harness<'_, App>) -> Option<EventKind> {
    let debugger = harness.state().state.runs().first.debugger.as_ref();
    debugger
        .expect("events")
        .event()
        .map(tilescope_debugger::Event::kind)
}
