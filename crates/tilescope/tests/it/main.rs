//! Tests of the program `tilescope`, run as its users run it.

mod analyze;
mod analyze_many;
mod combine;
mod command_line;
mod curve;
mod device;
mod fields;
mod judging;
mod large_sets;
mod lessons;
#[cfg(unix)]
mod places;
mod ranks;
mod reproduce;
mod script;
mod solid;
mod space;
mod stipple;
mod support;
mod text_tables;
mod varying;
mod varying_windows;
mod web;
mod words;
