//! The lessons that come with the program.

/// A lesson that comes with the program, with its translation.
#[derive(Clone, Copy, Debug)]
pub struct Shipped {
    /// Its name.
    pub name: &'static str,
    /// Its file.
    pub text: &'static str,
    /// Its German translation.
    pub german: &'static str,
    /// Its pinned keys.
    pub keys: &'static str,
}

macro_rules! shipped {
    ($($name:literal),* $(,)?) => {
        [$(Shipped {
            name: $name,
            text: include_str!(concat!("../../../assets/lessons/", $name, ".md")),
            german: include_str!(concat!("../../../assets/lessons/", $name, ".de.md")),
            keys: include_str!(concat!("../../../assets/lessons/", $name, ".keys")),
        }),*]
    };
}

/// The lessons, in their order.
pub const LESSONS: [Shipped; 0] = shipped![];

/// The lesson that `tilescope lesson new` writes.
pub const TEMPLATE: &str = include_str!("../../../assets/lessons/template.md");
