//! What needs a graphics driver; a software one will do.

mod arithmetic;
mod faults;
mod spots;
mod stages;
mod windows;
