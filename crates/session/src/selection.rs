//! The user's selection: a sample, a place, or nothing.

use glam::DVec2;

/// The user's selection, of which there is one at a time.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Selection {
    /// Nothing is selected, or no longer.
    Nothing,
    /// A sample, by its id.
    Sample(u32),
    /// A place of the domain, in r.
    Place(DVec2),
}
