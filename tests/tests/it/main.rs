//! Tests across the crates.

mod arrows;
mod circles;
mod commands;
mod device;
mod digests;
mod documents;
mod engines;
mod instructions;
mod lints;
mod live_moments;
mod numbers;
mod packages;
mod page;
mod properties;
mod support;
mod varying;
mod words;
