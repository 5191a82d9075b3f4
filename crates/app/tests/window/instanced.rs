//! Instanced drawing, pixel by pixel, on the device of the test harness.

mod looks;
mod probe;
mod views;
