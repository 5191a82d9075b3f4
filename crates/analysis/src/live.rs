//! Measures that are kept while samples come and go one by one, so that they move with a run. Each takes steps that are
//! counted, never timed: a caller chooses by them between changes and a new beginning. They see places alone, nothing of
//! what put the samples there.

mod plane;
mod spectrum;
mod waves;

pub use plane::Plane;
pub use spectrum::LiveSpectrum;
