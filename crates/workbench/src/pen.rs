//! What a lecturer draws over the canvas: lines in domain coordinates, in a few colours that are told apart.

use ecolor::Color32;
use serde::{Deserialize, Serialize};

/// The colours of the pen, for dark and for light canvases: orange, sky blue, pink, yellow or brown. They are told apart
/// with the usual kinds of colour blindness.
const COLORS: [[u32; 2]; 4] = [
    [0x00ff_a040, 0x00b3_5000],
    [0x0066_c8ff, 0x0000_5a9c],
    [0x00ff_8fd0, 0x00a0_2a72],
    [0x00ff_f080, 0x0060_5000],
];
/// The most points of all lines of a step.
pub const MAX_POINTS: usize = 20_000;

/// A line that was drawn.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PenStroke {
    /// The index of its colour.
    pub color: usize,
    /// Its points, in r.
    pub points: Vec<[f64; 2]>,
}

impl PenStroke {
    /// How many colours there are.
    pub const COLORS: usize = COLORS.len();

    /// Returns its colour on a dark or light canvas.
    #[must_use]
    pub const fn color(&self, dark: bool) -> Color32 {
        pen_color(self.color, dark)
    }
}

/// Returns a colour of the pen on a dark or light canvas.
#[must_use]
pub const fn pen_color(index: usize, dark: bool) -> Color32 {
    let hex = COLORS[index % COLORS.len()][if dark { 0 } else { 1 }];
    Color32::from_rgb((hex >> 16) as u8, (hex >> 8) as u8, hex as u8)
}
