//! What a user has selected: a sample or a place.

use glam::DVec2;

/// What is selected.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Selection {
    /// Nothing.
    Nothing,
    /// A sample.
    Sample(u32),
    /// A place of the domain, in r.
    Place(DVec2),
}
