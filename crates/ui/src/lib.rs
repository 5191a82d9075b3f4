//! The style and the widgets of the window: fonts, spacing, buttons, icons, the focus ring, and announcements for screen
//! readers. It does not depend on the state of the window. Colours are in `drawing/src/palette.rs`, panels in
//! `tilescope-app`. Begin with [`theme`] for how the window looks, with [`widgets`] for its parts.
//!
//! ```
//! use tilescope_session::look::Look;
//!
//! let context = egui::Context::default();
//! tilescope_ui::theme::install(&context, Look::ProjectorDark);
//! assert_eq!(context.theme(), egui::Theme::Dark);
//! ```

pub mod focus;
pub mod language;
pub mod presses;
pub mod spoken;
pub mod table;
pub mod theme;
pub mod widgets;
