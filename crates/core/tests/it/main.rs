//! Integration tests of `tilescope-core`.

mod combine;
mod combine_refusals;
mod combining;
mod definition;
mod extremes;
mod levels;
