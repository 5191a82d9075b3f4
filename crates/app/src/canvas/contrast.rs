//! Two runs side by side: where their pictures go, what stands above each, the marks on samples that only one of them
//! has, and the pointer's place on the other picture. What differs is handed to it.

use egui::{Color32, FontId, Mesh, Pos2, Rect, Stroke, Ui, vec2};

use super::paint::Scene;
use super::subject::Subject;
use crate::compare::{Comparison, contrast_of};
use crate::sentence::stage_sentence;
use crate::session::Session;
use crate::state::{Side, State, Verification};
use crate::theme::{Palette, semibold};
use crate::widgets::{Kebab, Known};

/// Between two pictures, in screen points.
const GUTTER: f32 = 3.0;
/// Height of what stands above a picture.
const HEADING: f32 = 44.0;
/// With more marks in view none are drawn: one would see no more than a surface.
const MOST_MARKS: usize = 60_000;
/// So much of the picture may be covered by marks: beyond, they hide what they mark.
const MOST_INK: f32 = 0.25;
/// How wide the lines of a mark are, in screen points.
const WIDTH: f32 = 1.5;

/// Narrower pictures, in screen points, stand below each other where there is room.
const NARROW: f32 = 300.0;

/// Returns where the two pictures go: beside each other, or else below.
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

/// What stands above a picture: which run it is, and what has happened there.
pub struct Title {
    letter: &'static str,
    run: String,
    happened: String,
}

/// Returns the title of the first run.
pub fn first_title(state: &State) -> Title {
    let subject = state.subject();
    let other = state
        .comparison
        .as_ref()
        .and_then(|(side, _)| side.session.as_deref());
    let own = state.session.as_deref();
    title("A", own, other, subject.as_ref(), &state.verification)
}

/// Returns the title of the second run.
pub fn second_title(state: &State, side: &Side) -> Title {
    let subject = state.second_subject();
    let (own, other) = (side.session.as_deref(), state.session.as_deref());
    title("B", own, other, subject.as_ref(), &side.verification)
}

fn title(
    letter: &'static str,
    own: Option<&Session>,
    other: Option<&Session>,
    subject: Option<&Subject<'_>>,
    verification: &Verification,
) -> Title {
    let mut parts = Vec::new();
    if let (Some(own), Some(other)) = (own, other) {
        let differing = contrast_of(own, other).unwrap_or_default();
        parts.extend(
            differing
                .into_iter()
                .map(|(name, value, _)| format!("{name} {value}")),
        );
        if own.combination.is_some() {
            parts.push(crate::sentence::counted(
                own.summary.blocks,
                "piece",
                "pieces",
            ));
        } else if parts.is_empty() {
            parts.push(format!("seed {}", own.run().parameters.seed));
        }
        if own.engine != other.engine {
            parts.push(own.engine.clone());
        }
    }
    if let Some(own) = own {
        parts.push(crate::sentence::counted(
            own.summary.count,
            "sample",
            "samples",
        ));
    }
    parts.push(verdict(verification).to_owned());
    parts.retain(|part| !part.is_empty());
    Title {
        letter,
        run: parts.join("   "),
        happened: subject.map(happened).unwrap_or_default(),
    }
}

fn verdict(verification: &Verification) -> &'static str {
    match verification {
        Verification::Done(verdict) if verdict.report.valid() => "verified",
        Verification::Done(_) => "not valid",
        Verification::Pending(_) => "being verified",
        Verification::Failed(_) => "not verified",
        Verification::Nothing => "",
    }
}

fn happened(subject: &Subject<'_>) -> String {
    let shown = &subject.shown;
    let Some(debugger) = shown.debugger.filter(|_| !shown.ends_stage()) else {
        return stage_sentence(shown.session, shown.stage);
    };
    match debugger.state().cursor().checked_sub(1) {
        Some(last) => tilescope_debugger::sentence(debugger.recording(), last),
        None => String::new(),
    }
}

/// Draws a title in the upper part of `rect`; returns the rest.
pub fn heading(ui: &Ui, rect: Rect, state: &State, title: &Title) -> Rect {
    let palette = Palette::of(state.look);
    let (mut above, mut below) = (rect, rect);
    above.max.y = rect.min.y + HEADING;
    below.min.y = above.max.y;
    let painter = ui.painter_at(above);
    painter.rect_filled(above, 0.0, palette.raised);
    let line = |text: &str, font: FontId, color: Color32| {
        let mut job = egui::text::LayoutJob::simple_singleline(text.to_owned(), font, color);
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
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, true, &words));
    response.known_as(format_args!("run-{}", Kebab(title.letter)));
    response.on_hover_text(words);
    below
}

/// Marks the samples that only one of the two runs has: a whole square where this run alone has one, four corners
/// where the other alone has one. Returns a remark if there are too many in view.
pub fn paint(scene: &Scene<'_>, crowded: bool) -> Option<String> {
    let contrast = scene.subject.contrast?;
    if scene.stage < tilescope_core::Stage::Tile {
        return None;
    }
    let half = (0.42 * scene.scale()).clamp(1.5, 10.0);
    let view = scene.rect.expand(half);
    let there = contrast.there.iter();
    let there = there.map(|&id| (contrast.other.place(id), false));
    let here = contrast.here.iter();
    let here = here.map(|&id| (scene.session.place(id), true));
    let seen: Vec<(Pos2, bool)> = there
        .chain(here)
        .map(|(place, whole)| (scene.at(place), whole))
        .filter(|(at, _)| view.contains(*at))
        .collect();
    let domain = scene.screen_rect([0.0; 2], scene.session.size_radii());
    let room = domain.intersect(scene.rect).area();
    let ink = seen.len() as f32 * 4.0 * 2.0 * half * WIDTH;
    if !seen.is_empty() && (crowded || seen.len() > MOST_MARKS || ink > MOST_INK * room) {
        return Some("Too many samples differ to mark them at this scale: zoom in.".to_owned());
    }
    let mut mesh = Mesh::default();
    for (at, whole) in seen {
        let rect = Rect::from_center_size(at, vec2(2.0 * half, 2.0 * half));
        add_square(&mut mesh, rect, whole, scene.palette.margin);
    }
    scene.painter.add(mesh);
    None
}

/// Draws the mark of a sample that only one of two runs has.
pub fn mark(painter: &egui::Painter, at: egui::Pos2, whole: bool, palette: &Palette) {
    let mut mesh = Mesh::default();
    let rect = Rect::from_center_size(at, vec2(12.0, 12.0));
    add_square(&mut mesh, rect, whole, palette.margin);
    painter.add(mesh);
}

/// Adds a square of thin lines, or its corners alone.
fn add_square(mesh: &mut Mesh, rect: Rect, whole: bool, color: Color32) {
    let side = rect.width();
    let arm = if whole { side } else { (0.3 * side).max(WIDTH) };
    let ends = if whole {
        vec![0.0]
    } else {
        vec![0.0, side - arm]
    };
    for start in ends {
        for far in [0.0, side - WIDTH] {
            let row = rect.min + vec2(start, far);
            let column = rect.min + vec2(far, start);
            mesh.add_colored_rect(Rect::from_min_size(row, vec2(arm, WIDTH)), color);
            mesh.add_colored_rect(Rect::from_min_size(column, vec2(WIDTH, arm)), color);
        }
    }
}

/// Shows on each picture what the pointer is at on the other, if the two move together.
pub fn echo(
    ui: &Ui,
    rects: [Rect; 2],
    subjects: [&Option<Subject<'_>>; 2],
    comparison: &Comparison,
    state: &State,
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
        let place = from.camera.domain_from_screen(rects[here], pointer);
        let at = to.camera.screen_from_domain(rects[there], place);
        let painter = ui.painter_at(rects[there]);
        let stroke = Stroke::new(1.2, Palette::of(state.look).halo.gamma_multiply(0.7));
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

    #[test]
    fn a_whole_square_is_longer_than_its_corners() {
        let length = |whole| {
            let mut mesh = Mesh::default();
            let rect = Rect::from_min_size(pos2(0.0, 0.0), vec2(20.0, 20.0));
            add_square(&mut mesh, rect, whole, Color32::WHITE);
            let area = |quad: &[egui::epaint::Vertex]| {
                let side = quad[3].pos - quad[0].pos;
                side.x.abs() * side.y.abs()
            };
            mesh.vertices.chunks(4).map(area).sum::<f32>()
        };
        assert!(length(true) > 1.5 * length(false));
    }
}
