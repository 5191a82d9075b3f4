//! Integration tests of `tilescope-debugger`.

mod bookmarks;
mod divergence;
mod finding;
mod saved;
mod sentences;
mod sessions;
mod support;
mod time_travel;
