//! The search in the list of all actions, while the list is open.

/// The search text, and which of the actions found is selected.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Finder {
    /// The search text, as typed.
    pub text: String,
    /// The index of the selected action among those found.
    pub choice: usize,
}
