//! The difference of two periodograms as a picture. The power of one set at one frequency scatters by as much as that power,
//! so that single frequencies cannot be compared: means over cells can. Sizes are in screen points, and chosen, not measured,
//! where no reason stands beside them.

use std::sync::Arc;

use egui::{
    Color32, ColorImage, Id, Rect, RichText, Role, Sense, Stroke, StrokeKind, TextureOptions, Ui,
    WidgetInfo, vec2,
};
use tilescope_analysis::measures::Spectrum;
use tilescope_drawing::palette::Palette;
use tilescope_ui::widgets::Known;

use super::picture::MAX_SIDE;
use crate::ENABLED;
use crate::textures::texture_of;

/// The difference that is drawn in the full colour: over three times the difference that two cells of 100 frequencies of noise
/// have by chance.
pub const FULL: f64 = 0.5;

/// The most cells along a side. Each then has 100 frequencies of a set of 10,000 samples, whose mean scatters by a tenth of the
/// power.
const MAX_CELLS: usize = 50;
/// Frequencies along the side of a cell of a small set, if the set has this many.
const MIN_FREQUENCIES: usize = 3;

/// What the powers of two spectra differ by, in cells of equal frequencies.
struct Differences {
    of: [Arc<Spectrum>; 2],
    /// Cells along a side.
    side: usize,
    /// The power of the second minus that of the first, row by row from the lowest frequency along y; NaN where one of the two is
    /// not measured.
    cells: Vec<f64>,
}

impl Differences {
    fn of(spectra: [&Arc<Spectrum>; 2]) -> Self {
        let pictures = spectra.map(|spectrum| &spectrum.picture);
        let fewest = pictures.map(|picture| picture.size.min(picture.rows) / MIN_FREQUENCIES);
        let side = fewest[0].min(fewest[1]).clamp(1, MAX_CELLS);

        let [first, second] = spectra.map(|spectrum| means(spectrum, side));
        let cells = first.iter().zip(second).map(|(a, b)| b - a);
        Self {
            of: spectra.map(Arc::clone),
            side,
            cells: cells.collect(),
        }
    }

    fn is_of(&self, [a, b]: [&Arc<Spectrum>; 2]) -> bool {
        Arc::ptr_eq(&self.of[0], a) && Arc::ptr_eq(&self.of[1], b)
    }

    /// Returns the difference at an offset from the middle, in shares of half the side.
    fn at(&self, [x, y]: [f32; 2]) -> Option<f64> {
        let index = |share: f32| {
            let cell = (0.5 * (f64::from(share) + 1.0) * self.side as f64).floor();
            (0.0..self.side as f64)
                .contains(&cell)
                .then_some(cell as usize)
        };
        let value = self.cells[index(y)? * self.side + index(x)?];
        value.is_finite().then_some(value)
    }

    /// Returns the picture, with high y frequencies at the top. A cell has the colour of the line of the run with more
    /// power there: the accent is that of run A.
    fn image(&self, palette: &Palette) -> ColorImage {
        let shade = |difference: f64| {
            // Cells that one of the spectra does not reach are grey.
            if !difference.is_finite() {
                return palette.line;
            }
            let color = if difference < 0.0 {
                palette.accent
            } else {
                super::line_of_second(palette).1
            };
            let part = (difference.abs() / FULL).min(1.0) as f32;
            palette.domain.lerp_to_gamma(color, part)
        };
        let rows = self.cells.chunks(self.side).rev();
        let pixels: Vec<Color32> = rows.flatten().map(|&cell| shade(cell)).collect();
        ColorImage::new([self.side, self.side], pixels)
    }
}

/// Returns the mean power of a spectrum in `side` by `side` cells, row by row; NaN where it has none.
fn means(spectrum: &Spectrum, side: usize) -> Vec<f64> {
    let picture = &spectrum.picture;
    let mut sums = vec![[0.0, 0.0]; side * side];
    let cell_of = |index: usize, count: usize, reach: f64| {
        // The frequency at the middle of a pixel: `count` pixels reach from -`reach` to `reach`.
        let nu = ((2 * index + 1) as f64 / count as f64 - 1.0) * reach;
        let cell = (0.5 * (nu / Spectrum::MAX_NU + 1.0) * side as f64).floor();
        // A frequency on the rim of the picture, where rounding may lead beyond it, belongs to the last cell.
        cell.clamp(0.0, (side - 1) as f64) as usize
    };

    for (index, power) in picture.power.iter().enumerate() {
        if power.is_finite() {
            let x = cell_of(
                index % picture.size,
                picture.size,
                spectrum.picture_reach[0],
            );
            let y = cell_of(
                index / picture.size,
                picture.rows,
                spectrum.picture_reach[1],
            );
            let [sum, count] = &mut sums[y * side + x];
            *sum += power;
            *count += 1.0;
        }
    }

    // A cell without a frequency has 0 / 0, which is NaN.
    sums.into_iter().map(|[sum, count]| sum / count).collect()
}

/// Shows the difference of the spectra of runs A and B in a square as wide as the room, at most [`MAX_SIDE`]. The square is
/// empty if one of the two is missing (`None`).
pub fn show(ui: &mut Ui, spectra: Option<[&Arc<Spectrum>; 2]>, palette: &Palette) {
    let side = ui.available_width().min(MAX_SIDE);
    let room = vec2(ui.available_width(), side);
    let (area, response) = ui.allocate_exact_size(room, Sense::hover());
    let rect = Rect::from_center_size(area.center(), vec2(side, side));
    let name = "Difference of the periodograms, B minus A, frequencies up to \u{3bd} = 2.5 from its middle";
    response.widget_info(|| WidgetInfo::labeled(Role::Image, ENABLED, name));
    response.known_as("chart.difference");

    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 2.0, palette.domain);
    if let Some(spectra) = spectra {
        let cells = differences(ui, spectra);
        // The picture has the colours of the look, so that each look has a texture of its own.
        let id = Id::unique(("picture of the difference", palette.dark));
        let texture = texture_of(ui, id, &cells, TextureOptions::NEAREST, |shown| {
            shown.image(palette)
        });
        painter.image(texture.id(), rect, tilescope_canvas::UNIT, Color32::WHITE);
        if let Some(at) = response.hover_pos() {
            let offset = (at - rect.center()) / (0.5 * side);
            let nu = f64::from(offset.length()) * Spectrum::MAX_NU;
            // Screens count y downwards, frequencies upwards.
            let value = cells
                .at([offset.x, -offset.y])
                .map_or_else(String::new, |value| {
                    format!("   B \u{2212} A = {value:+.3}")
                });
            let text = RichText::new(format!("\u{3bd} = {nu:.3}{value}")).monospace();
            response.on_hover_text_at_pointer(text);
        }
    }
    let border = Stroke::new(1.0, palette.border);
    painter.rect_stroke(rect, 0.0, border, StrokeKind::Inside);
}

/// Returns the differences of two spectra, those of the frame before if they are of the same two.
fn differences(ui: &Ui, spectra: [&Arc<Spectrum>; 2]) -> Arc<Differences> {
    let id = Id::unique("difference of the periodograms");
    let kept: Option<Arc<Differences>> = ui.data(|data| data.get_temp(id));
    kept.filter(|kept| kept.is_of(spectra)).unwrap_or_else(|| {
        let made = Arc::new(Differences::of(spectra));
        ui.data_mut(|data| data.insert_temp(id, Arc::clone(&made)));
        made
    })
}

#[cfg(test)]
mod tests {
    use tilescope_drawing::palette::DARK;

    use super::super::picture::tests::spectrum;
    use super::*;

    #[test]
    fn cells_have_the_mean_power_of_their_frequencies() {
        let (mut first, mut second) = (spectrum(1.0, 1.0), spectrum(2.0, 1.0));
        for power in &mut first.picture.power {
            *power = 0.5;
        }
        // The upper half has more power, the lower one less.
        let half = second.picture.power.len() / 2;
        for (index, power) in second.picture.power.iter_mut().enumerate() {
            *power = if index < half { 0.25 } else { 2.0 };
        }

        let [first, second] = [first, second].map(Arc::new);
        let found = Differences::of([&first, &second]);
        assert!(found.is_of([&first, &second]) && !found.is_of([&second, &first]));
        assert_eq!(found.at([0.3, 0.6]), Some(1.5));
        assert_eq!(found.at([-0.8, -0.6]), Some(-0.25));
        assert_eq!(found.at([0.0, 1.2]), None);
        let image = found.image(&DARK);
        assert_eq!(image.size, [found.side; 2]);
        assert_eq!(image.pixels[0], super::super::line_of_second(&DARK).1);
        let last = image.pixels[image.pixels.len() - 1];
        assert_eq!(last, DARK.domain.lerp_to_gamma(DARK.accent, 0.5));
    }

    #[test]
    fn equal_spectra_have_no_difference() {
        let spectrum = Arc::new(spectrum(1.0, 3.0));
        let found = Differences::of([&spectrum, &spectrum]);
        let mut known = found.cells.iter().filter(|cell| cell.is_finite());
        assert!(known.all(|cell| *cell == 0.0));
        assert!(found.side >= 10);
    }
}
