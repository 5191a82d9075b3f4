//! Small plots of spectra: mean power by frequency in 1/r. Sizes are in screen points, and chosen, not measured, where
//! no reason stands beside them.

use egui::{Align2, FontId, Sense, Stroke, Ui, pos2, vec2};
use tilescope_drawing::palette::Palette;
use tilescope_lessons::Curve;
use tilescope_ui::language::Worded;

/// The highest frequency, in 1/r, and the highest power that the plot shows.
const REACH: [f64; 2] = [3.0, 3.0];

/// Shows one curve, or that before a change and that after it, in a plot `height` points high.
pub fn show(ui: &mut Ui, curves: &[&Curve], height: f32, palette: &Palette) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    // The numbers of the axis stand below the plot.
    let plot = rect
        .shrink2(vec2(10.0, 4.0))
        .with_max_y(rect.bottom() - 16.0);

    let painter = ui.painter().with_clip_rect(rect);
    painter.rect_filled(rect, 4.0, palette.raised);
    let at = |[x, y]: [f64; 2]| {
        // More power than the plot shows is drawn at its upper end.
        let (x, y) = (x / REACH[0], (y / REACH[1]).min(1.0));
        pos2(
            plot.left() + x as f32 * plot.width(),
            plot.bottom() - y as f32 * plot.height(),
        )
    };

    // The power of white noise is 1 at every frequency.
    let thin = Stroke::new(1.0, palette.line);
    for level in [0.0, 1.0] {
        painter.line_segment([at([0.0, level]), at([REACH[0], level])], thin);
    }

    // The unit stands in the place of the last number, at the right end.
    let (below, font) = (vec2(0.0, 2.0), FontId::proportional(11.0));
    for tick in [0.5, 1.0, 1.5, 2.0, 2.5] {
        let (pos, text) = (at([tick, 0.0]) + below, ui.words(format!("{tick}")));
        painter.text(pos, Align2::CENTER_TOP, text, font.clone(), palette.muted);
    }
    let pos = plot.right_bottom() + below;
    painter.text(pos, Align2::RIGHT_TOP, "1/r", font, palette.muted);

    for (curve, color) in curves.iter().zip([palette.sample, palette.inserted]) {
        // A curve that goes on beyond the last frequency would be drawn into the plot's margin.
        let inside = curve.iter().filter(|[x, _]| *x <= REACH[0]);
        let points = inside.map(|&point| at(point)).collect::<Vec<_>>();
        painter.line(points, Stroke::new(1.5, color));
    }
}
