//! Integration tests of `tilescope-live`.

mod course;
mod curve;
mod expressions;
mod ground;
mod moment;
mod space;
mod support;
