//! What a user has selected: a sample or a place.

/// What is selected.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Selection {
    /// Nothing.
    Nothing,
    /// A sample.
    Sample(u32),
    /// A place of the domain, in r.
    Place([f64; 2]),
}
