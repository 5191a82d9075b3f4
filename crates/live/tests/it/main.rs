//! Integration tests of `tilescope-live`.

mod course;
mod curve;
mod expressions;
mod moment;
mod space;
mod support;
