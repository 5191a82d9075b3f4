//! Permalinks: a run and its view as the fragment of an address, readable and short. Links may come from anywhere: each
//! part is checked by itself and limited, and warnings name the parts that are changed or ignored. Begin with [`read()`] and
//! [`write()`]; `state/link.rs` makes links of the run and view that are shown, and opens links.

mod content;
mod parameters;
mod read;
mod text;
mod view;
mod warnings;
mod write;

pub use content::{LinkContent, NamedMoment};
pub(crate) use content::{allows, carries, normal};
pub(crate) use parameters::excess;
pub use parameters::link_key;
pub use read::COLOURINGS;
#[cfg(test)]
pub use read::keys;
pub use read::read;
pub use text::{name as choice_name, named as choice_named};
pub use warnings::LinkWarnings;
pub use write::{Link, write};

/// The newest version of links that this program reads, and that of exact tilings of a shape, which it writes. In links before
/// these tilings, darts make every shape, whatever the method.
pub const VERSION: u32 = 2;

/// The version of all other links, which programs before exact tilings of a shape read.
pub(crate) const VERSION_OF_OTHERS: u32 = 1;

/// The most characters of a fragment that this program writes. Chosen, not measured, like the limits below.
pub const MAX_CHARACTERS: usize = 8_000;

/// The most bytes of a fragment that are read.
pub const MAX_BYTES: usize = 65_536;

/// [`MAX_SAMPLES`] on a page.
pub const MAX_SAMPLES_ON_A_PAGE: f64 = 200_000.0;

/// [`MAX_PATTERN_SIDE`] on a page.
pub const MAX_PATTERN_SIDE_ON_A_PAGE: f64 = 500.0;

/// The most samples expected of a run, a second run, a combination or a pattern that a link asks for.
pub const MAX_SAMPLES: f64 = if cfg!(target_arch = "wasm32") {
    MAX_SAMPLES_ON_A_PAGE
} else {
    2_000_000.0
};

/// The longest side of a pattern that a link asks for, in r; such a pattern has at most [`MAX_SAMPLES`].
pub const MAX_PATTERN_SIDE: f64 = if cfg!(target_arch = "wasm32") {
    MAX_PATTERN_SIDE_ON_A_PAGE
} else {
    1_500.0
};

/// The most breakpoints of a link, and the most watches.
pub const MAX_STOPS: usize = 32;

/// The most scenes of a link.
pub const MAX_SCENES: usize = 64;

/// The most characters of a condition, a watch or a note in a link.
pub const MAX_TEXT: usize = 200;

/// The longest layout of a combination in a link, as characters of the link.
pub const MAX_COMBINATION: usize = 4_000;

/// The most characters of a link that the radius as a function and the polygon take together, with their escapes. The rest
/// of [`MAX_CHARACTERS`] is for the parameters and the view.
pub const MAX_GROUND: usize = 6_000;
