//! The lines that a lecturer draws over the canvas, in domain coordinates and in a few distinguishable colours.

use ecolor::Color32;
use serde::{Deserialize, Serialize};

/// The colours of the pen, for dark and for light canvases. Among many random colours with enough contrast these differ the
/// most, also with the usual kinds of colour blindness.
const COLORS: [[u32; 2]; 4] = [
    [0x00fd_db1a, 0x00e8_1834],
    [0x0089_deff, 0x003e_64f4],
    [0x00fa_430d, 0x003d_060b],
    [0x005c_8fb8, 0x000e_2496],
];
/// The most points of all lines of a step. Chosen, not measured.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// What the three kinds of colour blindness make of linear red, green and blue (Machado, Oliveira and Fernandes 2009,
    /// severity 1), and normal vision.
    const VISIONS: [[[f32; 3]; 3]; 4] = [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [
            [0.152, 1.053, -0.205],
            [0.115, 0.786, 0.099],
            [-0.004, -0.048, 1.052],
        ],
        [
            [0.367, 0.861, -0.228],
            [0.280, 0.673, 0.047],
            [-0.012, 0.043, 0.969],
        ],
        [
            [1.256, -0.077, -0.179],
            [-0.078, 0.931, 0.148],
            [0.005, 0.691, 0.304],
        ],
    ];

    /// Returns a colour as somebody sees it, in Oklab.
    fn seen(color: Color32, vision: &[[f32; 3]; 3]) -> [f32; 3] {
        let linear = ecolor::Rgba::from(color);
        let rgb = [linear.r(), linear.g(), linear.b()];
        let dot =
            |row: &[f32; 3], v: &[f32; 3]| -> f32 { row.iter().zip(v).map(|(a, b)| a * b).sum() };
        let rgb = vision.map(|row| dot(&row, &rgb).max(0.0));
        let cones = [
            [0.412, 0.536, 0.051],
            [0.212, 0.681, 0.107],
            [0.088, 0.282, 0.630],
        ]
        .map(|row| dot(&row, &rgb).cbrt());
        [
            [0.210, 0.794, -0.004],
            [1.978, -2.429, 0.451],
            [0.026, 0.783, -0.809],
        ]
        .map(|row| dot(&row, &cones))
    }

    #[test]
    fn colours_are_told_apart_by_everybody() {
        for dark in [true, false] {
            for vision in &VISIONS {
                for a in 0..PenStroke::COLORS {
                    for b in 0..a {
                        let [x, y] = [a, b].map(|index| seen(pen_color(index, dark), vision));
                        let squares = x.iter().zip(y).map(|(x, y)| (x - y).powi(2));
                        let distance = squares.sum::<f32>().sqrt();
                        assert!(distance > 0.18, "{a} and {b}, dark {dark}: {distance}");
                    }
                }
            }
        }
    }
}
