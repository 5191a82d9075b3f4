//! The lessons that come with the program. In a browser they are loaded when they are asked for.

use std::borrow::Cow;
use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// A lesson that comes with the program, with its translation.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shipped {
    /// The name of its file, without `.md`.
    pub name: Cow<'static, str>,
    /// The text of its file.
    pub text: Cow<'static, str>,
    /// The text of its German translation.
    pub german: Cow<'static, str>,
    /// The keys that it had when it was released, to compare with; empty in a browser.
    #[serde(skip)]
    pub keys: &'static str,
}

#[cfg(not(target_arch = "wasm32"))]
macro_rules! shipped {
    ($($name:literal),* $(,)?) => {
        vec![$(Shipped {
            name: Cow::Borrowed($name),
            text: Cow::Borrowed(include_str!(concat!("../../../assets/lessons/", $name, ".md"))),
            german: Cow::Borrowed(include_str!(concat!("../../../assets/lessons/", $name, ".de.md"))),
            keys: include_str!(concat!("../../../assets/lessons/", $name, ".keys")),
        }),*]
    };
}

/// Returns the lessons, in their order. In a browser there are none: the page loads the text of [`to_json`].
#[must_use]
pub fn lessons() -> Vec<Shipped> {
    #[cfg(target_arch = "wasm32")]
    return Vec::new();
    #[cfg(not(target_arch = "wasm32"))]
    shipped![
        "welcome",
        "maximal",
        "spectrum",
        "cuts",
        "clips",
        "survivors",
        "losses",
        "gaps",
        "rounds",
        "reach",
        "tiling",
        "exact",
        "parallel",
        "gluing",
        "ranks",
        "radii",
        "space",
    ]
}

/// Returns the two forms of the concept inventory, before and after; lists show them apart from the lessons. In a browser
/// there are none, as of [`lessons`].
#[must_use]
pub fn forms() -> Vec<Shipped> {
    #[cfg(target_arch = "wasm32")]
    return Vec::new();
    #[cfg(not(target_arch = "wasm32"))]
    shipped!["before", "after"]
}

/// Returns the lessons and then the forms: everything that can be opened by its name.
#[must_use]
pub fn all() -> Vec<Shipped> {
    [lessons(), forms()].concat()
}

/// A lecture of fifty minutes: its lessons, and the minutes of each.
pub const LECTURE: [(&str, u32); 8] = [
    ("welcome", 4),
    ("maximal", 6),
    ("spectrum", 7),
    ("cuts", 5),
    ("clips", 6),
    ("losses", 8),
    ("gaps", 8),
    ("rounds", 6),
];

impl Shipped {
    /// Returns the text of its translation; `None` but for German.
    #[must_use]
    pub fn translation(&self, language: &str) -> Option<&str> {
        (text_language(language) == GERMAN).then_some(&*self.german)
    }
}

/// The language into which the lessons that come with the program are translated.
const GERMAN: &str = "de";

/// Returns the language of the texts of lessons that come with the program, where the window is in a given one: English where
/// they are not translated.
#[must_use]
pub fn text_language(language: &str) -> &'static str {
    if language == GERMAN { GERMAN } else { "en" }
}

/// What a page loads when lessons are first asked for.
#[derive(Debug, Default, Serialize, Deserialize)]
pub struct Loaded {
    /// The lessons and forms.
    pub lessons: Vec<Shipped>,
    /// The tables of words of other languages, by their tags.
    pub tables: BTreeMap<String, String>,
}

/// Returns the text that a page loads, as JSON.
#[must_use]
pub fn to_json(loaded: &Loaded) -> String {
    serde_json::to_string(loaded).unwrap_or_default()
}

/// Reads the text of [`to_json`].
///
/// # Errors
///
/// A text that is not such JSON.
pub fn from_json(text: &str) -> Result<Loaded, serde_json::Error> {
    serde_json::from_str(text)
}

/// The lesson that `tilescope lesson new` writes.
pub const TEMPLATE: &str = include_str!("../../../assets/lessons/template.md");
