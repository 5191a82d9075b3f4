//! Integration tests of `tilescope-debugger`.

mod divergence;
mod exact;
mod finding;
mod local;
mod saved;
mod scenes;
mod sentences;
mod sessions;
mod support;
mod time_travel;
mod until;
