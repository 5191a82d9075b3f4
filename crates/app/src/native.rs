//! The native window: opens it, and returns a typed error if it cannot be opened or is lost.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use thiserror::Error;

use tilescope_workbench::command::Command;

use crate::app::App;
use crate::kept::KeptFolder;

/// The name under which eframe stores the window's settings, and of the folder for results.
const NAME: &str = "tilescope";

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
    /// The window was open and was lost, by a bug or because graphics or the windowing system failed.
    #[error("the window was open and is lost: {0}")]
    Lost(String),
}

impl AppError {
    /// Returns whether a window was open: unsaved work in it is then lost, and the caller should not fall back to
    /// another mode.
    #[must_use]
    pub const fn was_open(&self) -> bool {
        matches!(self, Self::Lost(_))
    }
}

/// Counts the window's frames, to tell how far it came before an error.
#[derive(Default)]
struct Frames {
    drawn: AtomicU64,
    /// Whether a frame is in progress.
    inside: AtomicBool,
}

impl Frames {
    /// Returns whether the window was open. An error during a frame is not a failure to open.
    fn shown(&self) -> bool {
        self.drawn.load(Ordering::Relaxed) > 0 || self.inside.load(Ordering::Relaxed)
    }
}

/// An application whose frames are counted.
struct Counted<A> {
    app: A,
    frames: Arc<Frames>,
}

impl<A: eframe::App> eframe::App for Counted<A> {
    fn logic(&mut self, ctx: &egui::Context, frame: &mut eframe::Frame) {
        self.app.logic(ctx, frame);
    }

    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        // A frame may take several passes; the second begins when the first is drawn.
        let drawn = ui.ctx().cumulative_frame_nr();
        self.frames.drawn.store(drawn, Ordering::Relaxed);
        self.frames.inside.store(true, Ordering::Relaxed);
        self.app.ui(ui, frame);
        self.frames.inside.store(false, Ordering::Relaxed);
    }

    fn raw_input_hook(&mut self, ctx: &egui::Context, raw: &mut egui::RawInput) {
        self.app.raw_input_hook(ctx, raw);
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        self.app.save(storage);
    }

    fn persist_egui_memory(&self) -> bool {
        self.app.persist_egui_memory()
    }
}

/// How to open the window.
#[derive(Clone, Debug, PartialEq)]
pub struct WindowOptions {
    /// A link to open: an address, or its fragment.
    pub link: Option<String>,
    /// Commands to begin with, such as those that open a lesson.
    pub commands: Vec<Command>,
    /// Its inner size in screen points.
    pub size: [f32; 2],
    /// Whether it opens in the light theme.
    pub light: bool,
}

impl Default for WindowOptions {
    fn default() -> Self {
        Self {
            link: None,
            commands: Vec::new(),
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
            // The width of a small phone, for which the narrowest arrangement is laid out. The height is chosen.
            .with_min_inner_size([360.0, 360.0]),
        renderer: eframe::Renderer::Wgpu,
        ..eframe::NativeOptions::default()
    };

    let (light, link) = (options.light, options.link.clone());
    let commands = options.commands.clone();
    // After an error, the number of frames shows whether the window was open.
    let frames = Arc::new(Frames::default());
    let counter = Arc::clone(&frames);

    let run = || {
        eframe::run_native(
            NAME,
            native,
            Box::new(move |creation| {
                let mut app = App::new(&creation.egui_ctx);
                if let Some(render_state) = &creation.wgpu_render_state {
                    app.draw_with(render_state);
                }
                // A link or a command says what to show: then neither the last session is offered nor the tour shown.
                let is_default = link.is_none() && commands.is_empty();
                if let Some(folder) = eframe::storage_dir(NAME) {
                    app.keep_in(KeptFolder::new(folder), is_default);
                }
                if let Some(storage) = creation.storage {
                    app.remember(storage, is_default);
                }

                // Options come last: they replace the settings of earlier uses.
                if light {
                    app.state.apply(tilescope_workbench::Command::Appearance(
                        tilescope_workbench::command::AppearanceCommand::Look(
                            tilescope_session::look::Look::Light,
                        ),
                    ));
                }
                if let Some(link) = link {
                    app.state.apply(tilescope_workbench::Command::Link(
                        tilescope_workbench::command::LinkCommand::Open(link),
                    ));
                }
                for command in commands {
                    app.state.apply(command);
                }
                let frames = counter;
                Ok(Box::new(Counted { app, frames }))
            }),
        )
    };

    // Some windowing systems report a failure by a panic, which must not end a caller that can go on without a window.
    outcome(catch_unwind(AssertUnwindSafe(run)), &frames)
}

/// Returns the outcome of a window. A panic of the program unwinds through the windowing system, which may panic
/// itself.
fn outcome(
    ended: Result<Result<(), eframe::Error>, Box<dyn Any + Send>>,
    frames: &Frames,
) -> Result<(), AppError> {
    match ended {
        Ok(Ok(())) => Ok(()),
        Ok(Err(error)) if frames.shown() => Err(AppError::Lost(error.to_string())),
        Ok(Err(error)) => Err(error.into()),
        Err(panic) if frames.shown() => Err(AppError::Lost(panic_message(&*panic))),
        Err(panic) => Err(AppError::WindowSystem(panic_message(&*panic))),
    }
}

fn panic_message(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|text| (*text).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned())
        .unwrap_or_else(|| "no message".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fails in this frame, counted from 1.
    struct Failing(usize);

    impl eframe::App for Failing {
        fn ui(&mut self, _: &mut egui::Ui, _: &mut eframe::Frame) {
            self.0 -= 1;
            assert!(self.0 > 0, "out of ink");
        }
    }

    /// Runs frames as a window does, then ends with an error.
    fn ended(failing: usize, made: usize) -> Result<(), AppError> {
        let frames = Arc::new(Frames::default());
        let mut window = Counted {
            app: Failing(failing),
            frames: Arc::clone(&frames),
        };
        let ctx = egui::Context::default();
        let run = || {
            for _ in 0..made {
                let _ = ctx.run_ui(egui::RawInput::default(), |ui| {
                    let mut frame = eframe::Frame::_new_kittest();
                    eframe::App::ui(&mut window, ui, &mut frame);
                });
            }
            Err(eframe::Error::AppCreation("no surface".into()))
        };
        outcome(catch_unwind(AssertUnwindSafe(run)), &frames)
    }

    #[test]
    fn a_window_that_was_never_drawn_was_not_opened() {
        for frames in [0, 1] {
            let error = ended(usize::MAX, frames).unwrap_err();
            assert!(!error.was_open(), "{error}");
            assert!(error.to_string().contains("no surface"), "{error}");
        }
        let none = Frames::default();
        let error = outcome(Err(Box::new("no display")), &none).unwrap_err();
        assert!(!error.was_open() && error.to_string().contains("no display"));
        assert!(outcome(Ok(Ok(())), &none).is_ok());
    }

    #[test]
    fn a_window_that_was_drawn_or_whose_frame_fails_is_lost() {
        let error = ended(usize::MAX, 2).unwrap_err();
        assert!(error.was_open() && error.to_string().contains("no surface"));
        for failing in [1, 2, 5] {
            let error = ended(failing, 9).unwrap_err();
            assert!(error.was_open(), "{error}");
            assert!(error.to_string().contains("out of ink"), "{error}");
        }
    }
}
