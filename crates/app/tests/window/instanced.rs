//! What instancing draws, pixel by pixel, on the device that the harness finds.

mod looks;
mod probe;
mod views;
