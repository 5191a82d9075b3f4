//! Integration tests of `tilescope-figures`.

mod animations;
