//! The native window: opening it, or saying in a typed error why there is none.

use std::panic::{AssertUnwindSafe, catch_unwind};

use thiserror::Error;

use crate::app::App;

/// Why no window opened.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum AppError {
    /// There is no display to open a window on.
    #[error("there is no display: neither DISPLAY nor WAYLAND_DISPLAY is set")]
    NoDisplay,
    /// The window or its graphics could not be made.
    #[error("no window could be opened: {0}")]
    Window(#[from] eframe::Error),
    /// The windowing system failed in a way that it does not report as an error.
    #[error("no window could be opened: {0}")]
    WindowSystem(String),
}

/// How the window opens.
#[derive(Clone, Debug, PartialEq)]
pub struct WindowOptions {
    /// Its inner size in screen points.
    pub size: [f32; 2],
    /// Whether it opens in the light theme.
    pub light: bool,
}

impl Default for WindowOptions {
    fn default() -> Self {
        Self {
            size: [1440.0, 900.0],
            light: false,
        }
    }
}

/// Returns whether a window can be expected to open: on Linux, whether a display is named.
#[must_use]
pub fn display_available() -> bool {
    if cfg!(target_os = "linux") {
        ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"]
            .into_iter()
            .any(|name| std::env::var_os(name).is_some_and(|value| !value.is_empty()))
    } else {
        true
    }
}

/// Opens the window and returns when it is closed.
///
/// Fails with a typed error, never with a panic, where there is no display or no graphics.
pub fn run_native(options: &WindowOptions) -> Result<(), AppError> {
    if !display_available() {
        return Err(AppError::NoDisplay);
    }
    let native = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("Tilescope")
            .with_inner_size(options.size)
            .with_min_inner_size([960.0, 600.0]),
        renderer: eframe::Renderer::Wgpu,
        ..eframe::NativeOptions::default()
    };
    let light = options.light;
    let run = || {
        eframe::run_native(
            "tilescope",
            native,
            Box::new(move |creation| {
                let mut app = App::new(&creation.egui_ctx);
                if let Some(render_state) = &creation.wgpu_render_state {
                    app.draw_with(render_state);
                }
                if let Some(storage) = creation.storage {
                    app.remember(storage);
                }
                if light {
                    app.state.apply(crate::Command::ToggleTheme);
                }
                Ok(Box::new(app))
            }),
        )
    };
    match catch_unwind(AssertUnwindSafe(run)) {
        Ok(outcome) => Ok(outcome?),
        Err(panic) => Err(AppError::WindowSystem(crate::jobs::panic_sentence(&*panic))),
    }
}
