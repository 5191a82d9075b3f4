//! Integration tests of `tilescope-lessons`.

mod faults;
mod fields;
mod guide;
mod inventory;
mod levels;
mod shipped;
mod space;
