//! What every part of the window is drawn with: colours and type, buttons and symbols, the ring of the keyboard's focus, what
//! screen readers say. Nothing here knows what a window shows.

pub mod focus;
pub mod presses;
pub mod spoken;
pub mod theme;
pub mod widgets;
