//! The pages of the help sheet.

/// A page of the help sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HelpPage {
    /// The keys and what they do.
    Keys,
    /// The terms and what they mean.
    Terms,
    /// The program: version, paper, citation, licences.
    About,
}

impl HelpPage {
    /// Every page, in the sequence of the sheet.
    pub const ALL: [Self; 3] = [Self::Keys, Self::Terms, Self::About];

    /// Returns the name, as the sheet shows it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Keys => "Keys",
            Self::Terms => "Terms",
            Self::About => "About Tilescope",
        }
    }
}
