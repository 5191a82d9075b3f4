//! The parts of the window that are shown when it is embedded in another page, such as a lecture. The page in
//! `web/` decides which origins may control it.

/// The parts of the window that are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Embedding {
    /// The canvas alone, without controls.
    Canvas,
    /// The canvas, the sentence, the controls and the timeline.
    Player,
}

impl Embedding {
    /// Every embedding, each with a name in addresses.
    pub const ALL: [Self; 2] = [Self::Canvas, Self::Player];

    /// Returns the name in addresses.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Canvas => "canvas",
            Self::Player => "player",
        }
    }

    /// Returns the one with this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|one| one.name() == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn embeddings_are_found_by_their_names() {
        for one in Embedding::ALL {
            assert_eq!(Embedding::named(one.name()), Some(one));
        }
        assert_eq!(Embedding::named("Player"), None);
    }
}
