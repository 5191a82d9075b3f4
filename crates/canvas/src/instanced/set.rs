//! Sets of symbols.

use tilescope_drawing::look::Symbol;

/// A set of symbols.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Symbols(pub(super) u32);

impl Symbols {
    /// The set of every symbol.
    pub const ALL: Self = Self(0b1_1110);

    /// Returns the set of `symbol` alone.
    #[must_use]
    pub const fn only(symbol: Symbol) -> Self {
        Self((1 << symbol as u32) & Self::ALL.0)
    }

    /// Returns this set without `symbol`.
    #[must_use]
    pub const fn without(self, symbol: Symbol) -> Self {
        Self(self.0 & !(1 << symbol as u32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_contain_the_given_symbols() {
        assert_eq!(Symbols::only(Symbol::None), Symbols(0));
        let rest = Symbols::ALL.without(Symbol::Cross);
        assert_eq!(
            Symbols(rest.0 | Symbols::only(Symbol::Cross).0),
            Symbols::ALL
        );
        assert_ne!(rest, Symbols::ALL);
    }
}
