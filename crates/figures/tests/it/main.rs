//! Integration tests of `tilescope-figures`.

mod animations;
mod moments;
