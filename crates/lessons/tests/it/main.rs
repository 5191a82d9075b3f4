//! Integration tests of `tilescope-lessons`.

mod guide;
