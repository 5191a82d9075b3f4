//! The look of a sample: symbol, colour, disk, outline and size, packed into eight bytes. [`crate::looks`]
//! chooses it by stage and layers.

use ecolor::Color32;

/// The symbol of a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Symbol {
    /// Nothing is drawn, except its disk if the look shows it.
    #[default]
    None,
    /// A sample, as a dot.
    Dot,
    /// An eliminated sample: a cross, hollow when it is large.
    Cross,
    /// An inserted sample, as a diamond.
    Diamond,
    /// A gap detector: a ring around a small dot.
    Ring,
}

/// How a sample looks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SampleLook {
    /// Which symbol it has.
    pub symbol: Symbol,
    /// The colour of symbol and disk.
    pub color: Color32,
    /// Whether its disk is drawn in the disks' layer.
    pub disk: bool,
    /// Whether the symbol has an outline in the colour that the paint options name.
    pub outlined: bool,
    /// The symbol's size relative to other symbols of its kind: normally 1, from 0 to 15 in sixteenths.
    pub size: f32,
}

impl SampleLook {
    /// A sample that is not drawn.
    pub const HIDDEN: Self = Self {
        symbol: Symbol::None,
        color: Color32::TRANSPARENT,
        disk: false,
        outlined: false,
        size: 1.0,
    };

    /// Returns the look of a symbol in a colour, of the usual size, without disk or outline.
    #[must_use]
    pub const fn new(symbol: Symbol, color: Color32) -> Self {
        Self {
            symbol,
            color,
            ..Self::HIDDEN
        }
    }

    /// Returns this look, with or without its disk.
    #[must_use]
    pub const fn with_disk(self, disk: bool) -> Self {
        Self { disk, ..self }
    }

    /// Returns this look, with or without an outline.
    #[must_use]
    pub const fn with_outline(self, outlined: bool) -> Self {
        Self { outlined, ..self }
    }

    /// Returns this look at another size.
    #[must_use]
    pub const fn with_size(self, size: f32) -> Self {
        Self { size, ..self }
    }

    /// Returns the two words that the shader reads: the colour's bytes, and symbol, flags and size.
    #[must_use]
    pub fn packed(self) -> [u32; 2] {
        let size = (self.size * 16.0).round().clamp(0.0, 255.0) as u32;
        let flags = u32::from(self.disk) << 3 | u32::from(self.outlined) << 4;
        [
            u32::from_le_bytes(self.color.to_array()),
            self.symbol as u32 | flags | size << 8,
        ]
    }
}

/// Returns the radii of dot, cross, diamond and ring at `scale` screen points per r, in screen points. They are
/// fractions of r, so that symbols of neighbours never overlap, up to sizes at which they would hide their
/// surroundings.
#[must_use]
pub const fn radii(scale: f32) -> [f32; 4] {
    [
        (0.2 * scale).clamp(1.0, 5.5),
        (0.26 * scale).clamp(0.6, 8.0),
        (0.27 * scale).clamp(1.0, 8.5),
        (0.33 * scale).clamp(0.5, 9.0),
    ]
}

/// Returns the width of the outline around a symbol of `radius`, in screen points.
#[must_use]
pub const fn outline(radius: f32) -> f32 {
    (0.8 * radius).min(1.6)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn different_looks_have_different_words() {
        let mut seen = std::collections::HashSet::new();
        for symbol in [
            Symbol::None,
            Symbol::Dot,
            Symbol::Cross,
            Symbol::Diamond,
            Symbol::Ring,
        ] {
            for (disk, outlined) in [(false, false), (false, true), (true, false), (true, true)] {
                let look = SampleLook::new(symbol, Color32::RED).with_disk(disk);
                let look = look.with_outline(outlined);
                assert!(seen.insert(look.packed()));
                assert!(seen.insert(SampleLook { size: 2.0, ..look }.packed()));
            }
        }
    }
}
