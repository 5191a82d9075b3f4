//! What of the window is left where it is part of another page, as of a lecture's. Who may speak to it is the page's business.

/// What is left of the window.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Embedding {
    /// The canvas alone.
    Canvas,
    /// The canvas, the sentence, the controls and the line.
    Player,
}

impl Embedding {
    /// Every one.
    pub const ALL: [Self; 2] = [Self::Canvas, Self::Player];

    /// Returns its name in addresses.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Canvas => "canvas",
            Self::Player => "player",
        }
    }

    /// Returns the one of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|one| one.name() == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_come_back() {
        for one in Embedding::ALL {
            assert_eq!(Embedding::named(one.name()), Some(one));
        }
        assert_eq!(Embedding::named("Player"), None);
    }
}
