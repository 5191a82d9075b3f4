//! Small plots of spectra: mean power by frequency in 1/r.

use egui::{Align2, FontId, Sense, Stroke, Ui, pos2, vec2};
use tilescope_drawing::palette::Palette;
use tilescope_lessons::Curve;

/// The highest frequency, in 1/r, and the highest power that are shown.
const REACH: [f64; 2] = [3.0, 3.0];

/// Shows curves in one plot, `height` points high; the second one is that after the change.
pub fn show(ui: &mut Ui, curves: &[&Curve], height: f32, palette: &Palette) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    let plot = rect
        .shrink2(vec2(10.0, 4.0))
        .with_max_y(rect.bottom() - 16.0);
    let painter = ui.painter().with_clip_rect(rect);
    painter.rect_filled(rect, 4.0, palette.raised);
    let place = |[x, y]: [f64; 2]| {
        let (x, y) = (x / REACH[0], (y / REACH[1]).min(1.0));
        pos2(
            plot.left() + x as f32 * plot.width(),
            plot.bottom() - y as f32 * plot.height(),
        )
    };
    let thin = Stroke::new(1.0, palette.line);
    painter.line_segment([place([0.0, 0.0]), place([REACH[0], 0.0])], thin);
    painter.line_segment([place([0.0, 1.0]), place([REACH[0], 1.0])], thin);
    for tick in [0.5, 1.0, 1.5, 2.0, 2.5] {
        let at = place([tick, 0.0]);
        painter.text(
            at + vec2(0.0, 2.0),
            Align2::CENTER_TOP,
            format!("{tick}"),
            FontId::proportional(11.0),
            palette.muted,
        );
    }
    let unit = plot.right_bottom() + vec2(0.0, 2.0);
    painter.text(
        unit,
        Align2::RIGHT_TOP,
        "1/r",
        FontId::proportional(11.0),
        palette.muted,
    );
    for (curve, color) in curves.iter().zip([palette.sample, palette.inserted]) {
        let inside = curve.iter().filter(|[x, _]| *x <= REACH[0]);
        let points = inside.map(|&at| place(at)).collect::<Vec<_>>();
        painter.line(points, Stroke::new(1.5, color));
    }
}
