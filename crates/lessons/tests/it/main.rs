//! Integration tests of `tilescope-lessons`.

mod faults;
mod guide;
mod inventory;
mod levels;
mod shipped;
