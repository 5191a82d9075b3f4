//! The marks on samples that only one of two compared runs has.

use egui::{Color32, Mesh, Painter, Pos2, Rect, vec2};
use tilescope_drawing::palette::Palette;
use tilescope_drawing::scene::Scene;

/// With more marks in view none are drawn, since they would merge into a surface. Chosen, not measured.
const MAX_MARKS: usize = 60_000;
/// Largest share of the picture that marks may cover; beyond it they hide the samples they mark. Chosen, not measured.
const MAX_INK: f32 = 0.25;
/// Line width of a mark, in screen points.
const WIDTH: f32 = 1.5;

/// Marks the samples that only one of the two runs has: by a whole square where only this run has one, by four corners
/// where only the other run has one. If such samples are in view, and are too many to mark or `crowded`, which means
/// drawn as points, none is marked, and a remark on that is returned. `None` in all other cases.
pub fn paint(painter: &Painter, scene: &Scene<'_>, crowded: bool) -> Option<String> {
    let contrast = scene.subject.contrast?;
    // Before tiling neither run has samples.
    if scene.stage < tilescope_core::Stage::Tile {
        return None;
    }

    // A mark is narrower than r, so that the marks of neighbours do not touch. The limits, which are chosen, keep it
    // visible far out, and small close by.
    let half = (0.42 * scene.scale()).clamp(1.5, 10.0);
    let view = scene.rect.expand(half);
    // Each mark has a place on the canvas, and whether it is a whole square.
    let there = contrast
        .there
        .iter()
        .map(|&id| (contrast.other.position(id), false));
    let here = contrast
        .here
        .iter()
        .map(|&id| (scene.session.position(id), true));
    let seen: Vec<(Pos2, bool)> = there
        .chain(here)
        .map(|(position, whole)| (scene.at(position), whole))
        .filter(|(at, _)| view.contains(*at))
        .collect();

    let room = scene.domain().intersect(scene.rect).area();
    // A mark has at most four whole sides, each of length 2 `half`.
    let ink = seen.len() as f32 * 4.0 * 2.0 * half * WIDTH;
    // Marks would hide samples that are drawn as points, and very many marks would merge or hide the others.
    if !seen.is_empty() && (crowded || seen.len() > MAX_MARKS || ink > MAX_INK * room) {
        return Some("Too many samples differ to mark them at this scale: zoom in.".to_owned());
    }

    let mut mesh = Mesh::default();
    for (at, whole) in seen {
        let rect = Rect::from_center_size(at, vec2(2.0 * half, 2.0 * half));
        add_square(&mut mesh, rect, whole, scene.palette.margin);
    }
    painter.add(mesh);
    None
}

/// Draws the mark of a sample that only one of two runs has.
pub fn mark(painter: &Painter, at: Pos2, whole: bool, palette: &Palette) {
    let mut mesh = Mesh::default();
    let rect = Rect::from_center_size(at, vec2(12.0, 12.0));
    add_square(&mut mesh, rect, whole, palette.margin);
    painter.add(mesh);
}

/// Adds a square of thin lines, or its corners alone.
fn add_square(mesh: &mut Mesh, rect: Rect, whole: bool, color: Color32) {
    let side = rect.width();
    // Each side is one line, or two short ones from its ends. Their share of 0.3 was chosen.
    let arm = if whole { side } else { (0.3 * side).max(WIDTH) };
    let starts = if whole {
        vec![0.0]
    } else {
        vec![0.0, side - arm]
    };

    for start in starts {
        for far in [0.0, side - WIDTH] {
            let row = rect.min + vec2(start, far);
            let column = rect.min + vec2(far, start);
            mesh.add_colored_rect(Rect::from_min_size(row, vec2(arm, WIDTH)), color);
            mesh.add_colored_rect(Rect::from_min_size(column, vec2(WIDTH, arm)), color);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

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
