//! The style and the widgets of the window: fonts, spacing, buttons, icons, the focus ring, and announcements for screen
//! readers. It does not depend on the state of the window. Colours are in `drawing/src/palette.rs`, panels in
//! `tilescope-app`. Begin with [`theme`] for how the window looks, with [`widgets`] for its parts.
//!
//! ```
//! use tilescope_session::look::Look;
//! use tilescope_ui::theme::theme_of;
//!
//! assert_eq!(theme_of(Look::Projector), egui::Theme::Light);
//! assert_eq!(theme_of(Look::ProjectorDark), egui::Theme::Dark);
//! ```

pub mod focus;
pub mod presses;
pub mod spoken;
pub mod theme;
pub mod widgets;
