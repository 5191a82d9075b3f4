//! What every part of the window is drawn with: colours and type, buttons and symbols, the keyboard's focus, the words for
//! screen readers. It does not know what a window shows.

pub mod focus;
pub mod presses;
pub mod spoken;
pub mod theme;
pub mod widgets;
