//! Tests that span the crates.

mod arrows;
mod circles;
mod device;
mod digests;
mod engines;
mod instructions;
mod numbers;
mod patterns;
mod properties;
mod support;
