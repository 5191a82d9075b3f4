//! Colours by meaning, for figures and for the app's canvas.
//!
//! Built on the palette of Okabe & Ito (2008), which readers with any common colour vision tell apart; every mark
//! has a shape of its own as well. Colours are named by their meaning and not by their hue.

/// Red, green, blue and opacity, sRGB, not premultiplied.
pub type Color = [u8; 4];

/// `color` with opacity `alpha`.
#[must_use]
pub const fn with_alpha(color: Color, alpha: u8) -> Color {
    [color[0], color[1], color[2], alpha]
}

const fn rgb(hex: u32) -> Color {
    [(hex >> 16) as u8, (hex >> 8) as u8, hex as u8, 255]
}

/// The colours of one theme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Palette {
    /// The ground of pictures, behind everything.
    pub background: Color,
    /// Behind panels and legends.
    pub surface: Color,
    /// Text, and the lines of axes.
    pub text: Color,
    /// Secondary text, ticks, scale bars.
    pub muted: Color,
    /// Grid lines and frames.
    pub line: Color,
    /// The interface's one accent.
    pub accent: Color,
    /// A sample, drawn as a dot.
    pub sample: Color,
    /// The ring of a disk.
    pub disk: Color,
    /// The faint fill of a disk.
    pub disk_fill: Color,
    /// Tints of building blocks, to be cycled through.
    pub block_tints: [Color; 6],
    /// Borders of the blocks, same order.
    pub block_borders: [Color; 6],
    /// A conflict: dashed edge (vermilion).
    pub conflict: Color,
    /// An eliminated sample: hollow cross.
    pub eliminated: Color,
    /// A gap detector: ring with a dot (blue).
    pub detector: Color,
    /// A gap: hatching (purple).
    pub gap: Color,
    /// A candidate: small triangle.
    pub candidate: Color,
    /// An inserted sample: diamond (green).
    pub inserted: Color,
    /// A sample above the plane that is drawn (orange).
    pub above: Color,
    /// A sample below the plane that is drawn (blue).
    pub below: Color,
}

impl Palette {
    /// Dark marks on white.
    pub const LIGHT: Self = Self {
        background: rgb(0xFF_FFFF),
        surface: rgb(0xF6_F7F9),
        text: rgb(0x1A_1D21),
        muted: rgb(0x5B_6470),
        line: rgb(0xD5_DAE0),
        accent: rgb(0x00_72B2),
        sample: rgb(0x23_2A34),
        disk: rgb(0x7D_8896),
        disk_fill: with_alpha(rgb(0x7D_8896), 24),
        block_tints: [
            rgb(0xE3_EFF8),
            rgb(0xFC_EFD6),
            rgb(0xDD_F1E9),
            rgb(0xF6_E5EE),
            rgb(0xFA_F6D2),
            rgb(0xF8_E2D6),
        ],
        block_borders: [
            rgb(0x7F_B3D8),
            rgb(0xDF_B060),
            rgb(0x6D_BD9F),
            rgb(0xCF_92B3),
            rgb(0xC9_BE4F),
            rgb(0xDB_9A77),
        ],
        conflict: rgb(0xD5_4A00),
        eliminated: rgb(0x8D_7F76),
        detector: rgb(0x00_72B2),
        gap: rgb(0xA8_3F92),
        candidate: rgb(0x96_7A00),
        inserted: rgb(0x00_8E68),
        above: rgb(0xB8_6F00),
        below: rgb(0x2B_5FB8),
    };

    /// Light marks on near-black.
    pub const DARK: Self = Self {
        background: rgb(0x14_171B),
        surface: rgb(0x1D_2126),
        text: rgb(0xEC_EEF1),
        muted: rgb(0x9A_A3AE),
        line: rgb(0x38_3E46),
        accent: rgb(0x56_B4E9),
        sample: rgb(0xD5_DBE4),
        disk: rgb(0x7B_8592),
        disk_fill: with_alpha(rgb(0x9A_A3AE), 22),
        block_tints: [
            rgb(0x1B_2A36),
            rgb(0x33_2A18),
            rgb(0x18_2F27),
            rgb(0x32_222C),
            rgb(0x2F_2D16),
            rgb(0x35_251C),
        ],
        block_borders: [
            rgb(0x3F_6D8F),
            rgb(0x83_6530),
            rgb(0x33_755D),
            rgb(0x7E_5069),
            rgb(0x77_702B),
            rgb(0x88_5A40),
        ],
        conflict: rgb(0xFF_6A2B),
        eliminated: rgb(0xA4_9488),
        detector: rgb(0x56_B4E9),
        gap: rgb(0xD5_7BC0),
        candidate: rgb(0xF0_E442),
        inserted: rgb(0x19_C79A),
        above: rgb(0xE6_9F00),
        below: rgb(0x6F_A8FF),
    };

    /// The tint and border of block `index`.
    #[must_use]
    pub fn block(&self, index: usize) -> (Color, Color) {
        let at = index % self.block_tints.len();
        (self.block_tints[at], self.block_borders[at])
    }

    /// Returns the colour of a sample that lies so far above the plane that is drawn, from -1, below it by as much as its disk
    /// can reach, over 0, in the plane, to 1: warm above and cool below, and that of a sample in the plane.
    #[must_use]
    pub fn of_height(&self, above: f64) -> Color {
        let end = if above < 0.0 { self.below } else { self.above };
        // Half of the way has the whole colour: samples farther away are drawn pale, where two hues differ little.
        let share = (2.0 * above.abs()).min(1.0);
        let mix = |k: usize| {
            let [from, to] = [self.sample[k], end[k]].map(f64::from);
            (from + share * (to - from)).round() as u8
        };
        [mix(0), mix(1), mix(2), 255]
    }

    /// The colours of marks, which must stand out from the background and from each other.
    #[must_use]
    pub fn marks(&self) -> [Color; 10] {
        [
            self.sample,
            self.disk,
            self.conflict,
            self.eliminated,
            self.detector,
            self.gap,
            self.candidate,
            self.inserted,
            self.above,
            self.below,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Contrast as WCAG 2 defines it, 1 to 21.
    fn contrast(a: Color, b: Color) -> f64 {
        let luminance = |color: Color| {
            let linear = |channel: u8| {
                let value = f64::from(channel) / 255.0;
                if value <= 0.040_45 {
                    value / 12.92
                } else {
                    ((value + 0.055) / 1.055).powf(2.4)
                }
            };
            0.2126 * linear(color[0]) + 0.7152 * linear(color[1]) + 0.0722 * linear(color[2])
        };
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn contrast_knows_black_and_white() {
        let [white, black] = [[255; 4], [0, 0, 0, 255]];
        assert!((contrast(white, black) - 21.0).abs() < 1e-9);
        assert!((contrast(white, white) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn marks_stand_out_and_text_is_readable() {
        for palette in [Palette::LIGHT, Palette::DARK] {
            for mark in palette.marks() {
                let found = contrast(mark, palette.background);
                assert!(found >= 3.0, "{mark:?} has contrast {found}");
            }
            for text in [palette.text, palette.muted] {
                assert!(contrast(text, palette.background) >= 4.5);
                assert!(contrast(text, palette.surface) >= 4.5);
            }
            for tint in palette.block_tints {
                assert!(contrast(palette.sample, tint) >= 7.0);
                assert!(contrast(tint, palette.background) < 1.5, "soft");
            }
        }
    }

    #[test]
    fn marks_differ_and_blocks_cycle() {
        for palette in [Palette::LIGHT, Palette::DARK] {
            let marks = palette.marks();
            for (index, mark) in marks.iter().enumerate() {
                assert!(!marks[..index].contains(mark));
            }
            assert_eq!(palette.block(1), palette.block(7));
        }
    }

    #[test]
    fn heights_go_from_cool_over_the_sample_to_warm() {
        for palette in [Palette::LIGHT, Palette::DARK] {
            let ends = [palette.below, palette.sample, palette.above];
            assert_eq!(
                [-1.0, 0.0, 1.0].map(|height| palette.of_height(height)),
                ends
            );
            assert_eq!(palette.of_height(0.5), palette.above);
            let [red, _, blue, _] = palette.of_height(0.25);
            let [sample, above] = [palette.sample, palette.above];
            assert!(
                red > sample[0].min(above[0]) && blue < sample[2],
                "{red} {blue}"
            );
        }
    }
}
