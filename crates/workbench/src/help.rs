//! The pages of the help sheet.

/// A page of the help sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HelpPage {
    /// The keys.
    Keys,
    /// The terms and what they mean.
    Terms,
    /// The program: version, paper, citation, licences.
    About,
}

impl HelpPage {
    /// Every page.
    pub const ALL: [Self; 3] = [Self::Keys, Self::Terms, Self::About];

    /// Returns its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Keys => "Keys",
            Self::Terms => "Terms",
            Self::About => "About Tilescope",
        }
    }
}
