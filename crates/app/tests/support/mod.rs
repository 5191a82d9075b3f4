//! The window on its default session, for tests that use it as a user would.

pub mod sessions;

use egui_kittest::Harness;
use tilescope_app::App;
use tilescope_debugger::Kind;

/// So many frames may pass until the window rests: work in the background asks for one whenever it gets on, however
/// fast frames are, so that this is no bound on time; one that never rests is found all the same.
pub const MOST_FRAMES: u64 = 50_000;

/// Returns the window when its session is made and verified.
pub fn opened() -> Harness<'static, App> {
    opened_at([1440.0, 900.0])
}

/// Returns the window at a size.
pub fn opened_at(size: [f32; 2]) -> Harness<'static, App> {
    let mut harness = Harness::builder()
        .with_size(size)
        .with_max_steps(MOST_FRAMES)
        .build_eframe(|creation| App::new(&creation.egui_ctx));
    settle(&mut harness);
    harness
}

/// Waits for all work in the background, and shows what came of it.
pub fn settle(harness: &mut Harness<'_, App>) {
    harness.state_mut().state.settle();
    harness.run();
}

/// Returns how many events have happened.
pub fn cursor(harness: &Harness<'_, App>) -> usize {
    harness.state().state.cursor().expect("events").0
}

/// Returns what happened last.
pub fn last_kind(harness: &Harness<'_, App>) -> Option<Kind> {
    let last = cursor(harness).checked_sub(1)?;
    let debugger = harness.state().state.debugger.as_ref().expect("events");
    let event = debugger.recording().event(last);
    event.map(tilescope_debugger::Event::kind)
}

/// Returns what happens next.
pub fn next_kind(harness: &Harness<'_, App>) -> Option<Kind> {
    let debugger = harness.state().state.debugger.as_ref();
    debugger
        .expect("events")
        .event()
        .map(tilescope_debugger::Event::kind)
}
