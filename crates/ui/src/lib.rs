//! egui style and widgets of the window: colours, type, buttons, icons, the focus ring, and announcements for screen
//! readers. It does not depend on the state of the window; panels are in `tilescope-app`.

pub mod focus;
pub mod presses;
pub mod spoken;
pub mod theme;
pub mod widgets;
