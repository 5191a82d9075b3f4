//! Two runs side by side: the rectangles of their pictures, the titles above, and the pointer's position on the other
//! picture. Sizes are in screen points, and chosen, not measured, where no reason stands beside them.

use super::CanvasContext;
use crate::ENABLED;
use egui::{Color32, FontId, Rect, Stroke, Ui, vec2};
use tilescope_session::sentence::happened;
use tilescope_session::session::Session;
use tilescope_ui::theme::semibold;
use tilescope_ui::widgets::{Kebab, Known};

use tilescope_drawing::subject::Subject;
use tilescope_workbench::compare::{Comparison, contrast_of};
use tilescope_workbench::state::{RunView, Verification};

/// Gap between two pictures, in screen points.
pub(super) const GUTTER: f32 = 3.0;
/// Height of a title.
const HEADING: f32 = 44.0;
/// Narrower pictures, in screen points, are stacked if there is room.
const NARROW: f32 = 300.0;

/// Returns the rectangles of the two pictures: side by side, or else stacked.
pub fn halves(rect: Rect) -> [Rect; 2] {
    let (mut left, mut right) = (rect, rect);
    if rect.width() < 2.0 * NARROW && rect.height() > rect.width() {
        left.max.y = (rect.center().y - GUTTER / 2.0).round();
        right.min.y = left.max.y + GUTTER;
        return [left, right];
    }
    left.max.x = (rect.center().x - GUTTER / 2.0).round();
    right.min.x = left.max.x + GUTTER;
    [left, right]
}

/// The title of a picture: the run, and its last event.
pub struct Title {
    letter: &'static str,
    run: String,
    happened: String,
}

/// Returns the title of run A.
pub fn first_title(context: &CanvasContext<'_>) -> Title {
    let subject = context.subjects[0];
    let other = context
        .runs
        .second
        .as_ref()
        .and_then(|(side, _)| side.session.as_deref());
    let own = context.runs.first.session.as_deref();
    title(
        "A",
        own,
        other,
        subject.as_ref(),
        &context.runs.first.verification,
    )
}

/// Returns the title of run B.
pub fn second_title(context: &CanvasContext<'_>, side: &RunView) -> Title {
    let subject = context.subjects[1];
    let (own, other) = (
        side.session.as_deref(),
        context.runs.first.session.as_deref(),
    );
    title("B", own, other, subject.as_ref(), &side.verification)
}

/// Returns a title. It has the parameters in which the runs differ, the number of pieces or of nested levels if the set
/// has these, the engine if the runs differ in it, the number of samples, the verdict, and the last event. A run
/// without pieces, levels and differing parameters has its seed instead of these. Until both runs are there, only the
/// number of samples, the verdict and the event are named. A run that is not there yet has no number of samples and no
/// event.
fn title(
    letter: &'static str,
    own: Option<&Session>,
    other: Option<&Session>,
    subject: Option<&Subject<'_>>,
    verification: &Verification,
) -> Title {
    let mut parts = Vec::new();
    if let (Some(own), Some(other)) = (own, other) {
        // The parameters that differ tell the runs apart; a combination has none to compare. Where none differs, the
        // seed still names the run.
        let differing = contrast_of(own, other).unwrap_or_default();
        parts.extend(
            differing
                .into_iter()
                .map(|(name, value, _of_other)| format!("{name} {value}")),
        );
        if own.combination.is_some() {
            parts.push(tilescope_session::words::counted(
                own.summary.blocks,
                "piece",
                "pieces",
            ));
        } else if let Some(nested) = &own.nested {
            let levels = nested.claims.len();
            parts.push(tilescope_session::words::counted(levels, "level", "levels"));
        } else if parts.is_empty() {
            parts.push(format!("seed {}", own.run().parameters.seed));
        }
        if own.engine != other.engine {
            parts.push(own.engine.clone());
        }
    }

    if let Some(own) = own {
        parts.push(tilescope_session::words::counted(
            own.summary.count,
            "sample",
            "samples",
        ));
    }

    parts.push(verdict(verification).to_owned());
    // The words of a verdict are empty before there is one.
    parts.retain(|part| !part.is_empty());

    Title {
        letter,
        run: parts.join("   "),
        happened: subject.map_or_else(String::new, |subject| happened(Some(&subject.shown))),
    }
}

fn verdict(verification: &Verification) -> &'static str {
    match verification {
        Verification::Done(verdict) if verdict.valid() => "verified",
        Verification::Done(_) => "not valid",
        Verification::Pending(_) => "being verified",
        Verification::Failed(_) => "not verified",
        Verification::Nothing => "",
    }
}

/// Draws a title at the top of `rect`; returns the rest.
pub fn heading(ui: &Ui, rect: Rect, context: &CanvasContext<'_>, title: &Title) -> Rect {
    let palette = context.palette;
    let (mut above, mut below) = (rect, rect);
    above.max.y = rect.min.y + HEADING;
    below.min.y = above.max.y;

    let painter = ui.painter_at(above);
    painter.rect_filled(above, 0.0, palette.raised);
    let line = |text: &str, font: FontId, color: Color32| {
        let mut job = egui::text::LayoutJob::simple_singleline(text.to_owned(), font, color);
        // The text begins behind the letter, 40 points from the left edge, and ends 12 points before the right edge.
        job.wrap = egui::text::TextWrapping::truncate_at_width(above.width() - 52.0);
        ui.painter().layout_job(job)
    };

    let letter = painter.layout_no_wrap(
        title.letter.to_owned(),
        FontId::new(20.0, semibold()),
        palette.accent,
    );
    let at = above.left_center() + vec2(14.0, -letter.size().y / 2.0);
    painter.galley(at, letter, palette.accent);

    for (text, y, size, color) in [
        (&title.run, 5.0, 13.0, palette.text),
        (&title.happened, 23.0, 12.5, palette.muted),
    ] {
        let galley = line(text, FontId::proportional(size), color);
        painter.galley(above.left_top() + vec2(40.0, y), galley, color);
    }

    let id = ui.scope_id().with(("title of a run", title.letter));
    let response = ui.interact(above, id, egui::Sense::hover());
    let words = format!("Run {}: {}. {}", title.letter, title.run, title.happened);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, ENABLED, &words));
    response.known_as(format_args!("run-{}", Kebab(title.letter)));
    response.on_hover_text(words);
    below
}

/// Marks on each picture the position of the pointer on the other, if their cameras are linked.
pub fn echo(
    ui: &Ui,
    rects: [Rect; 2],
    subjects: [&Option<Subject<'_>>; 2],
    comparison: &Comparison,
    context: &CanvasContext<'_>,
) {
    let Some(pointer) = ui.input(|input| input.pointer.hover_pos()) else {
        return;
    };
    if !comparison.linked_cameras {
        return;
    }

    for (here, there) in [(0, 1), (1, 0)] {
        let (Some(from), Some(to)) = (subjects[here], subjects[there]) else {
            continue;
        };
        if !rects[here].contains(pointer) {
            continue;
        }

        let position = from.camera.domain_from_screen(rects[here], pointer);
        let at = to.camera.screen_from_domain(rects[there], position);
        let painter = ui.painter_at(rects[there]);
        let stroke = Stroke::new(1.2, context.palette.halo.gamma_multiply(0.7));
        // The cross is open in its middle, so that the place itself is seen.
        for side in [vec2(9.0, 0.0), vec2(0.0, 9.0)] {
            for way in [-1.0, 1.0] {
                painter.line_segment([at + way * side * 0.35, at + way * side], stroke);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    #[test]
    fn the_halves_are_equally_large_and_apart() {
        let rect = Rect::from_min_max(pos2(10.0, 20.0), pos2(1011.0, 600.0));
        let [left, right] = halves(rect);
        assert!((left.width() - right.width()).abs() <= 2.0);
        assert!(left.max.x < right.min.x);
        assert!(rect.contains_rect(left) && rect.contains_rect(right));
    }
}
