//! Integration tests of `tilescope-core`.

mod combine;
mod combine_refusals;
mod combining;
mod definition;
mod exact;
mod extremes;
mod levels;
mod solid;
mod solid_judged;
mod varying;
