//! The user's selection: a sample, a place, or nothing.

use glam::DVec2;

/// A selection.
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
