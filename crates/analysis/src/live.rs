//! Measures that are kept while samples come and go one by one, so that they move with a run. Each takes steps that are
//! counted, never timed: a caller chooses by them between changes and a new beginning. They see places alone, and nothing that
//! shows how the samples came there.

mod cell;
mod cover;
mod pairs;
mod place_grid;
mod plane;
mod renewal;
mod solid_box;
mod solid_grid;
mod solid_pairs;
mod spectrum;
mod tournament;
mod verdict;
mod waves;

pub use cover::LiveCover;
pub use pairs::LivePairs;
pub use plane::Plane;
pub use renewal::{LiveSample, Renew, Renewal};
pub use solid_box::SolidBox;
pub use solid_pairs::{LiveSolidPairs, LiveSolidSample};
pub use spectrum::{LiveSpectrum, SpectrumWork};
pub use verdict::LiveVerdict;
