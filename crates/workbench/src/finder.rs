//! The list of all actions while it is open.

/// What was typed to find an action, and which of those found is chosen.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Finder {
    /// What was typed.
    pub text: String,
    /// The place of the choice among the actions found.
    pub choice: usize,
}
