//! The colour schemes: a [`Palette`] names colours by their meaning, and [`Palette::of`] chooses one for a look.
//! The hues can be told apart by colour-blind people (Okabe and Ito 2008). A colour means the same on the canvas, in
//! exported pictures, on chips and in the legend. The colours of charts and of pictures on paper are in
//! `tilescope_figures`. To add a scheme, begin here; the tests below check the contrasts of every palette.

use ecolor::Color32;
use tilescope_figures::Palette as Marks;
use tilescope_session::look::Look;
use tilescope_session::octaves::Octaves;

/// The colours of a look, each named by its meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Palette {
    /// Whether it is the dark palette.
    pub dark: bool,
    /// The ground of panels.
    pub panel: Color32,
    /// Cards and fields on panels.
    pub raised: Color32,
    /// Thin lines between widgets.
    pub line: Color32,
    /// The canvas outside the domain.
    pub outside: Color32,
    /// The canvas inside the domain.
    pub domain: Color32,
    /// The border of the domain.
    pub border: Color32,
    /// Text on panels and on the canvas.
    pub text: Color32,
    /// Text that matters less.
    pub muted: Color32,
    /// The one accent of the interface.
    pub accent: Color32,
    /// Text on a ground of the accent.
    pub on_accent: Color32,
    /// A sample where its colour says nothing more.
    pub sample: Color32,
    /// A sample from the margin around its block.
    pub margin: Color32,
    /// A conflict; also errors.
    pub conflict: Color32,
    /// An eliminated sample, and samples outside the domain.
    pub eliminated: Color32,
    /// A gap detector, and the search around it.
    pub detector: Color32,
    /// A gap, which no disk covers.
    pub gap: Color32,
    /// A candidate for insertion.
    pub candidate: Color32,
    /// An inserted sample; also success.
    pub inserted: Color32,
    /// The halo of the current sample.
    pub halo: Color32,
}

/// Returns a colour of the figures crate: marks have the same colours in the window and on paper.
const fn mark([red, green, blue, _]: tilescope_figures::Color) -> Color32 {
    Color32::from_rgb(red, green, blue)
}

const fn rgb(hex: u32) -> Color32 {
    Color32::from_rgb((hex >> 16) as u8, (hex >> 8) as u8, hex as u8)
}

/// The palette of dark looks.
pub const DARK: Palette = Palette {
    dark: true,
    panel: rgb(0x0015_181d),
    raised: rgb(0x001e_232a),
    line: rgb(0x002b_313a),
    outside: rgb(0x000c_0e11),
    domain: rgb(0x0012_1519),
    border: rgb(0x0057_6170),
    text: rgb(0x00e6_e9ee),
    muted: rgb(0x0098_a2b0),
    accent: rgb(0x006c_a4ff),
    on_accent: rgb(0x0009_1426),
    sample: mark(Marks::DARK.sample),
    margin: rgb(0x00e6_9f00),
    conflict: mark(Marks::DARK.conflict),
    eliminated: mark(Marks::DARK.eliminated),
    detector: mark(Marks::DARK.detector),
    gap: mark(Marks::DARK.gap),
    candidate: mark(Marks::DARK.candidate),
    inserted: mark(Marks::DARK.inserted),
    halo: rgb(0x00ff_ffff),
};

/// The palette of light looks.
pub const LIGHT: Palette = Palette {
    dark: false,
    panel: rgb(0x00f7_f8fa),
    raised: rgb(0x00ff_ffff),
    line: rgb(0x00db_dfe5),
    outside: rgb(0x00e9_ecf0),
    domain: rgb(0x00ff_ffff),
    border: rgb(0x007d_8796),
    text: rgb(0x0019_1e26),
    muted: rgb(0x005b_6675),
    accent: rgb(0x0020_5fd0),
    on_accent: rgb(0x00ff_ffff),
    sample: mark(Marks::LIGHT.sample),
    margin: rgb(0x00b8_6f00),
    conflict: mark(Marks::LIGHT.conflict),
    eliminated: mark(Marks::LIGHT.eliminated),
    detector: mark(Marks::LIGHT.detector),
    gap: mark(Marks::LIGHT.gap),
    candidate: mark(Marks::LIGHT.candidate),
    inserted: mark(Marks::LIGHT.inserted),
    halo: rgb(0x0000_0000),
};

impl Palette {
    /// Returns the palette of a look.
    #[must_use]
    pub const fn of(look: Look) -> &'static Self {
        match look {
            Look::Dark | Look::ProjectorDark => &DARK,
            Look::Light | Look::Projector => &LIGHT,
        }
    }

    /// Returns the colour of a building block: neighbours in the list differ strongly.
    #[must_use]
    pub fn block(&self, index: u32) -> Color32 {
        // The golden angle spreads hues; lightness alternates so that blocks do not differ by hue alone.
        let hue = f64::from(index) * 137.507_764 + 210.0;
        let step = f64::from(index % 3) * 0.045;
        let (lightness, chroma) = if self.dark {
            (0.74 + step, 0.105)
        } else {
            (0.50 + step, 0.125)
        };
        oklch(lightness, chroma, hue)
    }

    /// Returns the colour of a sample that lies so many radii above the plane, below it less than 0, as on paper: warm above and
    /// cool below.
    #[must_use]
    pub fn depth(&self, above: f64) -> Color32 {
        let marks = if self.dark { Marks::DARK } else { Marks::LIGHT };
        mark(marks.of_height(above))
    }

    /// Returns the colour of an age between 0, early, and 1, late: from blue over grey to yellow with growing
    /// lightness, so that the order is visible with colour blindness, too.
    #[must_use]
    pub fn age(&self, age: f32) -> Color32 {
        let (early, late) = if self.dark {
            ([0.56, -0.02, -0.14], [0.93, -0.02, 0.15])
        } else {
            ([0.30, -0.01, -0.15], [0.665, 0.02, 0.135])
        };
        let part = |k: usize| early[k] + (late[k] - early[k]) * f64::from(age.clamp(0.0, 1.0));
        oklab(part(0), part(1), part(2))
    }

    /// Returns the colour of the active cells of an octave: the larger their radii, the lighter, around the blue of active cells.
    /// Colours of ages would do as well, but samples have these beside the cells.
    #[must_use]
    pub fn octave(&self, octave: usize, octaves: Octaves) -> Color32 {
        self.octave_at(octaves.share(octave))
    }

    /// Returns the colour between the first octave, at 0, and the last, at 1.
    fn octave_at(&self, share: f32) -> Color32 {
        let (first, last) = if self.dark {
            ([0.54, 0.16, 275.0], [0.95, 0.09, 195.0])
        } else {
            ([0.28, 0.16, 275.0], [0.655, 0.09, 195.0])
        };
        let part = |k: usize| first[k] + (last[k] - first[k]) * f64::from(share);
        oklch(part(0), part(1), part(2))
    }
}

/// Returns the sRGB colour of an Oklab lightness, chroma and hue (Ottosson 2020).
fn oklch(lightness: f64, chroma: f64, hue_degrees: f64) -> Color32 {
    let (sin, cos) = hue_degrees.to_radians().sin_cos();
    oklab(lightness, chroma * cos, chroma * sin)
}

/// Returns the sRGB colour of a lightness and two opponent coordinates of Oklab.
fn oklab(lightness: f64, a: f64, b: f64) -> Color32 {
    // Ottosson's matrices: from Oklab to the cubes of cone responses, and below to linear sRGB.
    let l = (lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
    let m = (lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
    let s = (lightness - 0.089_484_177_5 * a - 1.291_485_548 * b).powi(3);

    let encode = |channel: f64| {
        // A colour outside sRGB gets the nearest value of each channel. The curve below is that of the standard of
        // sRGB.
        let linear = channel.clamp(0.0, 1.0);
        let encoded = if linear <= 0.003_130_8 {
            12.92 * linear
        } else {
            1.055 * linear.powf(1.0 / 2.4) - 0.055
        };
        (encoded * 255.0).round() as u8
    };

    Color32::from_rgb(
        encode(4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s),
        encode(-1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s),
        encode(-0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701 * s),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn luminance(color: Color32) -> f32 {
        let linear = ecolor::Rgba::from(color);
        0.2126 * linear.r() + 0.7152 * linear.g() + 0.0722 * linear.b()
    }

    fn contrast(a: Color32, b: Color32) -> f32 {
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn colours_of_ages_are_readable_and_grow_lighter() {
        for palette in Look::ALL.map(Palette::of) {
            let ramp: Vec<Color32> = (0..=32).map(|k| palette.age(k as f32 / 32.0)).collect();
            for color in &ramp {
                assert!(contrast(*color, palette.domain) > 3.0, "{color:?}");
            }
            for pair in ramp.windows(2) {
                assert!(luminance(pair[1]) > luminance(pair[0]), "{pair:?}");
            }
            assert!(contrast(ramp[0], ramp[32]) > 3.0);
        }
    }

    #[test]
    fn octaves_are_told_apart_by_how_light_they_are() {
        for palette in Look::ALL.map(Palette::of) {
            // Radii differ by a factor of 64 at most, so that there are seven octaves at most.
            let ratios = |count: u8| {
                let shares = (0..count).map(|k| f32::from(k) / f32::from(count - 1));
                let colors: Vec<_> = shares.map(|share| palette.octave_at(share)).collect();
                for color in &colors {
                    assert!(contrast(*color, palette.domain) > 3.0, "{color:?}");
                }
                let pairs = colors.windows(2).map(|pair| contrast(pair[0], pair[1]));
                pairs.fold(f32::INFINITY, f32::min)
            };
            assert!(ratios(7) > 1.15, "{}", ratios(7));
            // Many more would not be.
            assert!(ratios(30) < 1.15);
        }
    }

    #[test]
    fn text_and_symbols_have_enough_contrast() {
        for palette in Look::ALL.map(Palette::of) {
            for ground in [palette.panel, palette.raised, palette.domain] {
                assert!(contrast(palette.text, ground) > 7.0);
                assert!(contrast(palette.muted, ground) > 4.5);
            }
            assert!(contrast(palette.on_accent, palette.accent) > 4.5);
            // The focus ring.
            for ground in [
                palette.panel,
                palette.raised,
                palette.domain,
                palette.outside,
            ] {
                assert!(contrast(palette.accent, ground) > 3.0);
            }
            let symbols = [
                palette.sample,
                palette.margin,
                palette.conflict,
                palette.detector,
                palette.gap,
                palette.candidate,
                palette.inserted,
                palette.eliminated,
            ];
            for symbol in symbols.into_iter().chain((0..64).map(|k| palette.block(k))) {
                assert!(contrast(symbol, palette.domain) > 3.0, "{symbol:?}");
            }
        }
    }
}
