//! The window on its default session, for tests that use it as a user would.

use egui_kittest::Harness;
use tilescope_app::App;

/// Returns the window when its session is made and verified.
pub fn opened() -> Harness<'static, App> {
    let mut harness = Harness::builder()
        .with_size([1440.0, 900.0])
        .with_max_steps(64)
        .build_eframe(|creation| App::new(&creation.egui_ctx));
    settle(&mut harness);
    harness
}

/// Waits for all work in the background, and shows what came of it.
pub fn settle(harness: &mut Harness<'_, App>) {
    harness.state_mut().state.settle();
    harness.run();
}
