//! Tests across the crates.

mod arrows;
mod circles;
mod device;
mod digests;
mod documents;
mod engines;
mod instructions;
mod numbers;
mod properties;
mod support;
mod words;
