//! Overlays: scale bar, coordinates, remarks, and a marker at the conflict or gap that decides a verdict.
//! Sizes are in screen points, and were chosen, not measured.

use glam::DVec2;

use egui::{Align2, FontId, Painter, Pos2, Rect, Stroke, pos2, vec2};
use tilescope_core::{Point, R};
use tilescope_drawing::camera::Camera;
use tilescope_drawing::palette::Palette;

use tilescope_drawing::subject::Subject;
use tilescope_session::words::significant;
use tilescope_ui::language::Worded;

/// On a lower canvas remarks would cover the picture and are not shown.
const MIN_HEIGHT: f32 = 200.0;

/// The distance of overlays from the edges of the canvas, in screen points.
const INSET: f32 = 18.0;
/// A remark stands beside the domain if there is this much room.
const MIN_WIDTH_BESIDE: f32 = 150.0;

/// Shows that a session is being computed, or that there is none.
pub fn waiting(painter: &Painter, rect: Rect, at_work: bool, palette: &Palette) {
    let text = if at_work {
        "Sampling\u{2026}"
    } else {
        "There is no session: choose parameters and run."
    };

    let font = FontId::proportional(15.0);
    painter.text(
        rect.center(),
        Align2::CENTER_CENTER,
        painter.ctx().words(text),
        font,
        palette.muted,
    );
}

/// Draws a bar of a round number of r, or of units of the domain, between 44 and 110 screen points long.
pub fn scale_bar(painter: &Painter, rect: Rect, subject: &Subject<'_>, palette: &Palette) {
    // A low canvas has no room for the bar.
    if rect.height() < MIN_HEIGHT {
        return;
    }

    let (shown_length, length) = bar(subject);
    // The bar stands in the lower left corner, on a rectangle that hides the picture a little. Sizes were chosen by
    // eye.
    let from = rect.left_bottom() + vec2(INSET + 6.0, -INSET);
    let to = from + vec2(length, 0.0);
    let ground = Rect::from_two_pos(from + vec2(-9.0, -28.0), to + vec2(9.0, 9.0));

    painter.rect_filled(ground, 6.0, palette.panel.gamma_multiply(0.82));
    let stroke = Stroke::new(2.0, palette.text);
    painter.line_segment([from, to], stroke);
    for end in [from, to] {
        painter.line_segment([end - vec2(0.0, 4.0), end + vec2(0.0, 4.0)], stroke);
    }

    let middle = pos2(f32::midpoint(from.x, to.x), from.y - 6.0);
    let suffix = if own_unit(subject).is_some() {
        ""
    } else {
        " r"
    };
    let text = painter.ctx().words(format!("{shown_length}{suffix}"));
    let font = FontId::monospace(12.0);
    painter.text(middle, Align2::CENTER_BOTTOM, text, font, palette.text);
}

/// Returns the length of r in the unit of the domain where lengths are shown in that unit: in a field or a shape, where r is no
/// radius of the set.
fn own_unit(subject: &Subject<'_>) -> Option<f64> {
    let session = subject.shown.session;
    session.ground.as_ref()?;
    Some(session.run().domain.radius())
}

/// Returns the length of the scale bar, in r or in the unit of the domain, and in screen points.
fn bar(subject: &Subject<'_>) -> (f64, f32) {
    // How many screen points the unit of length takes that is shown.
    let scale = subject.camera.scale / own_unit(subject).unwrap_or(1.0);
    // The longest round length up to 110 points. Round lengths differ by factors of 2.5 at most, so that it is over 44.
    let shown_length = round_length(110.0 / scale);
    (shown_length, (shown_length * scale) as f32)
}

/// Returns the coordinates of a position in a field or a shape and, unless it lies outside of that, the radius there.
/// `None` in a session without a field and a shape, and if the run has no radii by place.
fn local_position(subject: &Subject<'_>, position: DVec2) -> Option<String> {
    let unit = own_unit(subject)?;
    let session = subject.shown.session;
    let (_parameters, request) = &session.ground.as_ref()?.asked;
    let DVec2 { x, y } = position * unit + DVec2::from(request.origin);
    let text = format!("x {x:>9.5}  y {y:>9.5}");

    let locality = session.run().locality.as_ref()?;
    let lattice = (position * f64::from(R)).floor();
    let place = Point::new(lattice.x as i32, lattice.y as i32);
    let is_there = session.run().domain.rect().contains(place) && locality.inside(place);
    if !is_there {
        return Some(text);
    }
    let radius = f64::from(locality.radius_at(place)) / f64::from(R);
    Some(format!("{text}  radius {}", significant(radius * unit)))
}

/// Returns the largest number that is at most `radii` and 1, 2 or 5 times a power of ten.
fn round_length(radii: f64) -> f64 {
    let power = 10_f64.powf(radii.log10().floor());
    let steps = [5.0, 2.0, 1.0];
    let step = steps.into_iter().find(|step| step * power <= radii);
    let length = step.unwrap_or(1.0) * power;
    // Powers of ten below 1 are inexact.
    (length * 1e6).round() / 1e6
}

/// Draws the coordinates under the pointer, and the scale as a percentage of the fitted one, as far as there is room.
pub fn cursor(
    painter: &Painter,
    rect: Rect,
    subject: &Subject<'_>,
    pointer: Option<Pos2>,
    palette: &Palette,
) {
    if rect.height() < MIN_HEIGHT {
        return;
    }

    let shown = &subject.shown;
    let fitted = Camera::fitting(shown.session.size_at(Some(shown.stage)), rect).scale;
    // Numbers have fixed widths, so that the text does not jump while they change.
    let zoom = format!("{:>5.0}%", 100.0 * subject.camera.scale / fitted);
    // Without a pointer over the picture there are no coordinates, and the scale is shown alone.
    let coordinates = pointer
        .map(|pos| subject.camera.domain_from_screen(rect, pos))
        .map(|position| {
            let DVec2 { x, y } = position;
            let in_radii = || format!("x {x:>8.3} r  y {y:>8.3} r");
            local_position(subject, position).unwrap_or_else(in_radii)
        });
    let both = coordinates
        .as_ref()
        .map(|coordinates| format!("{coordinates}  {zoom}"));

    // The text must fit beside the scale bar, which takes 15 points besides its length; the text's own ground takes 6.
    let room = rect.width() - 2.0 * INSET - (bar(subject).1 + 21.0);
    let fits = |text: &String| {
        let font = FontId::monospace(12.0);
        let galley = painter.layout_no_wrap(text.clone(), font, palette.text);
        galley.size().x <= room
    };

    // The longest text that fits is shown.
    let texts = [both, coordinates, Some(zoom.trim_start().to_owned())];
    if let Some(text) = texts.into_iter().flatten().find(fits) {
        let corner = rect.right_bottom() - vec2(INSET, INSET - 4.0);
        tag(painter, corner, Align2::RIGHT_BOTTOM, &text, palette);
    }
}

/// Draws a remark at the top of the canvas: beside the domain where there is room, else over it.
pub fn note(
    painter: &Painter,
    rect: Rect,
    subject: &Subject<'_>,
    text: Option<&str>,
    palette: &Palette,
) {
    if let Some(text) = text.filter(|_| rect.height() >= MIN_HEIGHT) {
        let font = FontId::proportional(12.5);
        let origin = subject.camera.screen_from_domain(rect, [0.0; 2]);
        // The width that is free on the left of the domain.
        let beside = origin.x - rect.left() - 2.0 * INSET;

        let (width, middle) = if beside >= MIN_WIDTH_BESIDE {
            (beside, rect.left() + INSET + 0.5 * beside)
        } else {
            (rect.width() - 2.0 * INSET, rect.center().x)
        };

        let galley = painter.layout(painter.ctx().words(text), font, palette.text, width);
        let pos = pos2(middle, rect.top() + INSET - 4.0);
        let placed = Align2::CENTER_TOP.anchor_size(pos, galley.size());
        painter.rect_filled(placed.expand2(vec2(12.0, 6.0)), 14.0, palette.panel);
        painter.galley(placed.min, galley, palette.text);
    }
}

/// Draws text in the language of the window, on a background, so that it is readable over the picture.
pub fn tag(painter: &Painter, pos: Pos2, anchor: Align2, text: &str, palette: &Palette) {
    let text = painter.ctx().words(text);
    let galley = painter.layout_no_wrap(text, FontId::monospace(12.0), palette.text);
    let rect = anchor.anchor_size(pos, galley.size());
    let ground = palette.panel.gamma_multiply(0.9);
    painter.rect_filled(rect.expand2(vec2(6.0, 3.0)), 5.0, ground);
    painter.galley(rect.min, galley, palette.text);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[allow(clippy::float_cmp, reason = "round numbers are exact")]
    fn bars_have_round_lengths() {
        for (radii, expected) in [
            (1.3, 1.0),
            (2.0, 2.0),
            (49.0, 20.0),
            (0.07, 0.05),
            (700.0, 500.0),
        ] {
            assert_eq!(round_length(radii), expected);
        }
    }
}
