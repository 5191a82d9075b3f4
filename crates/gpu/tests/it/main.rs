//! Integration tests of `tilescope-gpu`.

mod device;
mod shaders;
mod support;
