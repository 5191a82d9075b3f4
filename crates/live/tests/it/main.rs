//! Integration tests of `tilescope-live`.

mod course;
mod curve;
mod moment;
mod support;
