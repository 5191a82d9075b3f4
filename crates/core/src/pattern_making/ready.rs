//! Patterns that come with the program, packed: exactly those that generation makes, so that
//! no run waits for one. It makes nothing and keeps nothing.

use crate::lattice::Boundary;
use crate::parameters::PatternSpec;

/// A pattern that comes with the program.
#[derive(Clone, Copy, Debug)]
pub struct ReadyMade {
    /// Name of its file in `assets/patterns`.
    pub name: &'static str,
    /// What it is equal to when generated.
    pub spec: PatternSpec,
    /// Its packed form.
    pub packed: &'static [u8],
}

macro_rules! ready {
    (periodic, $side:literal, $seed:literal) => {
        ready!(Boundary::Periodic, "periodic", $side, $seed)
    };
    (bounded, $side:literal, $seed:literal) => {
        ready!(Boundary::Bounded, "bounded", $side, $seed)
    };
    ($boundary:expr, $word:literal, $side:literal, $seed:literal) => {
        ReadyMade {
            name: concat!($word, "-", $side, "-", $seed, ".pattern"),
            spec: PatternSpec {
                side: $side as f64,
                boundary: $boundary,
                seed: $seed,
            },
            packed: include_bytes!(concat!(
                "../../../../assets/patterns/",
                concat!($word, "-", $side, "-", $seed, ".pattern")
            )),
        }
    };
}

/// All of them. The default side comes with eight seeds, for whoever averages many sets; a larger
/// bounded one would take as many bytes as four of those and is made in 0.06 s. A page comes with one seed: the others
/// would be a fifteenth of what it loads.
pub static READY_MADE: &[ReadyMade] = &[
    ready!(periodic, 20, 0),
    ready!(periodic, 30, 0),
    ready!(periodic, 50, 0),
    ready!(periodic, 100, 0),
    #[cfg(not(target_arch = "wasm32"))]
    ready!(periodic, 100, 1),
    #[cfg(not(target_arch = "wasm32"))]
    ready!(periodic, 100, 2),
    #[cfg(not(target_arch = "wasm32"))]
    ready!(periodic, 100, 3),
    #[cfg(not(target_arch = "wasm32"))]
    ready!(periodic, 100, 4),
    #[cfg(not(target_arch = "wasm32"))]
    ready!(periodic, 100, 5),
    #[cfg(not(target_arch = "wasm32"))]
    ready!(periodic, 100, 6),
    #[cfg(not(target_arch = "wasm32"))]
    ready!(periodic, 100, 7),
    ready!(periodic, 200, 0),
    ready!(bounded, 50, 0),
    ready!(bounded, 100, 0),
];
