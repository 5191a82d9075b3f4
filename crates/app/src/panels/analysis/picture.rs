//! The periodogram as a picture, as papers print it: black is no power, white is three times the power of noise; a ring
//! selects a band of frequencies. Sizes are in screen points, and chosen, not measured, where no reason stands beside
//! them.

use std::sync::Arc;

use egui::{
    Color32, ColorImage, CursorIcon, Id, Painter, Pos2, Rect, Role, Sense, Stroke, TextureOptions,
    Ui, WidgetInfo, vec2,
};
use tilescope_analysis::measures::Spectrum;
use tilescope_drawing::palette::Palette;
use tilescope_ui::widgets::Known;

use super::plot::{Dragged, dragged};
use crate::ENABLED;
use crate::textures::texture_of;

/// Power that is drawn white.
pub const WHITE: f64 = 3.0;

/// Maximum width of the picture, in screen points.
pub const MAX_SIDE: f32 = 480.0;

/// Shows the periodogram of a run in a square as wide as the room, at most [`MAX_SIDE`], with frequencies up to
/// [`Spectrum::MAX_NU`] along both axes. `run` ends the picture's id, "" or "-b"; `faded` says that the spectrum is of another
/// moment; `brush` is the ring, from its inner to its outer frequency. Returns the change of the ring, if it was changed.
pub fn show(
    ui: &mut Ui,
    run: &str,
    spectrum: Option<&Arc<Spectrum>>,
    faded: bool,
    brush: Option<[f64; 2]>,
    palette: &Palette,
) -> Option<Dragged> {
    let side = ui.available_width().min(MAX_SIDE);
    let room = vec2(ui.available_width(), side);
    let (area, response) = ui.allocate_exact_size(room, Sense::CLICK | Sense::DRAG);
    let rect = Rect::from_center_size(area.center(), vec2(side, side));
    let reach = Spectrum::MAX_NU;

    let name =
        "Periodogram, frequencies up to \u{3bd} = 2.5 from its middle; a ring can be dragged";
    response.widget_info(|| WidgetInfo::labeled(Role::Image, ENABLED, name));
    response.known_as(format_args!("chart.periodogram{run}"));
    let response = response.on_hover_cursor(CursorIcon::Crosshair);

    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 2.0, palette.domain);
    // The screen points of a frequency of 1.
    let per_nu = f64::from(side) / (2.0 * reach);
    if let Some(spectrum) = spectrum {
        // Frequencies that are not measured stay grey.
        painter.rect_filled(rect, 2.0, palette.line);
        let size = spectrum
            .picture_reach
            .map(|half| (2.0 * half * per_nu) as f32);
        let cells = Rect::from_center_size(rect.center(), vec2(size[0], size[1]));
        // A chosen share of the opacity, at which the shades of another moment can still be distinguished.
        let tint = Color32::WHITE.gamma_multiply(if faded { 0.35 } else { 1.0 });
        let id = Id::unique(("periodogram of the moment", run));
        let texture = texture_of(ui, id, spectrum, TextureOptions::NEAREST, image);
        painter.image(texture.id(), cells, tilescope_canvas::UNIT, tint);
    }

    ring(&painter, rect, brush, per_nu, palette);
    let border = Stroke::new(1.0, palette.border);
    painter.rect_stroke(rect, 0.0, border, egui::StrokeKind::Inside);

    let nu = |at: Pos2| f64::from(at.distance(rect.center())) / per_nu;
    let over = response.hover_pos().filter(|at| rect.contains(*at));
    // During a drag the value under the pointer would hide the range that is dragged.
    let response = match over.filter(|_| !response.dragged()) {
        Some(at) => {
            let offset = at - rect.center();
            let power = spectrum
                .and_then(|spectrum| power_at(spectrum, offset, per_nu))
                .map_or_else(String::new, |power| format!("   P = {power:.3}"));
            let text = format!("\u{3bd} = {:.3}{power}", nu(at));
            response.on_hover_text_at_pointer(egui::RichText::new(text).monospace())
        }
        None => response,
    };
    dragged(ui, &response, brush, nu)
}

fn ring(painter: &Painter, rect: Rect, brush: Option<[f64; 2]>, per_nu: f64, palette: &Palette) {
    for end in brush.into_iter().flatten() {
        let radius = (end * per_nu) as f32;
        // A dark line inside a light one is visible on any power.
        painter.circle_stroke(rect.center(), radius, Stroke::new(3.2, Color32::WHITE));
        painter.circle_stroke(rect.center(), radius, Stroke::new(1.6, palette.conflict));
    }
}

/// Returns the mean power of the pixel at an offset from the centre.
fn power_at(spectrum: &Spectrum, offset: egui::Vec2, per_nu: f64) -> Option<f64> {
    let picture = &spectrum.picture;
    let index = |offset: f32, half: f64, cells: usize| {
        let part = f64::from(offset) / per_nu / half;
        let cell = (0.5 * (part + 1.0) * cells as f64).floor();
        (0.0..cells as f64).contains(&cell).then_some(cell as usize)
    };
    let [half_x, half_y] = spectrum.picture_reach;
    let x = index(offset.x, half_x, picture.size)?;
    // Screens count y downwards, frequencies upwards.
    let y = index(-offset.y, half_y, picture.rows)?;
    let power = picture.power.get(y * picture.size + x).copied();
    power.filter(|power| power.is_finite())
}

/// Returns the picture, with high y frequencies at the top. Frequencies without a power, such as zero, are left out.
fn image(spectrum: &Spectrum) -> ColorImage {
    let (size, rows) = (spectrum.picture.size, spectrum.picture.rows);
    let shade = |power: f64| {
        if power.is_finite() {
            let part = (power / WHITE).clamp(0.0, 1.0);
            Color32::from_gray((255.0 * part).round() as u8)
        } else {
            Color32::TRANSPARENT
        }
    };
    let lines = spectrum.picture.power.chunks(size).rev();
    let pixels = lines.flatten().map(|&power| shade(power)).collect();
    ColorImage::new([size, rows], pixels)
}

#[cfg(test)]
pub(super) mod tests {
    use std::ops::ControlFlow;

    use tilescope_analysis::measures::Periodogram;
    use tilescope_analysis::{Boundary, Region};

    use super::*;

    pub fn spectrum(width: f64, height: f64) -> Spectrum {
        let region = Region {
            width,
            height,
            boundary: Boundary::Periodic,
        };
        // Multiples of the inverse plastic number and of its square, whose fractions fill a square evenly. The number
        // of points is chosen.
        let fractions = (1..=600).map(|i| [0.754_877, 0.569_84].map(|step| f64::from(i) * step));
        let points: Vec<[f64; 2]> = fractions
            .map(|[x, y]| [x.fract() * width, y.fract() * height])
            .collect();
        let window = Spectrum::window(points.len() as f64, region);
        let go_on = |_| ControlFlow::Continue(());
        let periodogram = Periodogram::of(&points, region, &window, &go_on).unwrap();
        Spectrum::of(&periodogram).unwrap()
    }

    #[test]
    fn pictures_of_oblong_domains_have_as_many_pixels_as_their_size_says() {
        for (width, height) in [(1.0, 1.0), (2.0, 1.0), (1.0, 3.0), (8.0, 1.0)] {
            let spectrum = spectrum(width, height);
            let (image, picture) = (image(&spectrum), &spectrum.picture);
            assert_eq!(image.size, [picture.size, picture.rows]);
            assert_eq!(image.pixels.len(), image.size[0] * image.size[1]);
            let is_square = f64::abs(width - height) < 1e-9;
            assert_eq!(picture.size == picture.rows, is_square);
        }
    }

    #[test]
    fn low_power_is_dark_and_high_power_is_light() {
        let mut spectrum = spectrum(1.0, 1.0);
        for (index, power) in spectrum.picture.power.iter_mut().enumerate() {
            *power = [0.0, 1.5, 9.0][index % 3];
        }
        let image = image(&spectrum);
        let lines: Vec<_> = image.pixels.chunks(image.size[0]).rev().flatten().collect();
        let expected = [0, 128, 255].map(Color32::from_gray);
        assert_eq!(lines[..3], expected.each_ref());
    }

    #[test]
    fn the_power_under_the_pointer_is_that_of_its_cell_in_oblong_domains_too() {
        let per_nu = 40.0;
        for (width, height) in [(1.0, 1.0), (2.0, 1.0), (1.0, 3.0)] {
            let spectrum = spectrum(width, height);
            let picture = &spectrum.picture;
            let [half_x, half_y] = spectrum.picture_reach;
            for (index, power) in picture.power.iter().enumerate() {
                let (x, y) = (index % picture.size, index / picture.size);
                // The middle of a cell, as an offset from the picture's centre in screen points.
                let middle = |cell: usize, cells: usize, half: f64| {
                    (((2 * cell + 1) as f64 / cells as f64 - 1.0) * half * per_nu) as f32
                };
                // Screens count y downwards, frequencies upwards.
                let at = vec2(
                    middle(x, picture.size, half_x),
                    -middle(y, picture.rows, half_y),
                );
                let expected = Some(*power).filter(|power| power.is_finite());
                assert_eq!(power_at(&spectrum, at, per_nu), expected, "{x} {y}");
            }
            let beyond = vec2(1.01 * (half_x * per_nu) as f32, 0.0);
            assert_eq!(power_at(&spectrum, beyond, per_nu), None);
        }
    }
}
