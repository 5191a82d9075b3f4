//! Integration tests of `tilescope-analysis`.

mod against_truth;
mod averages;
mod blue_noise;
mod distances;
mod distant_pairs;
mod judges;
mod live_cover;
mod live_pairs;
mod live_slices;
mod live_spectrum;
mod live_squares;
mod numbers;
mod order;
mod periodogram;
mod refusals;
mod shares;
mod solid;
mod spectra;
mod squares;
mod streams;
mod support;
mod tessellation;
mod thinned;
mod thinned_solid;
mod uniformity;
mod verdicts;
