//! The tag beside the pointer: the sample under it and its status, or else the gap, or else the block. The tag does not
//! cover the object that it names. Sizes were chosen, not measured.

use egui::{Align2, FontId, Painter, Pos2, Rect, Response, Stroke, StrokeKind, Ui, vec2};
use glam::DVec2;
use tilescope_analysis::tessellation::{Edge, GapRegion};
use tilescope_core::{Origin, Stage, Standing};
use tilescope_drawing::palette::Palette;
use tilescope_session::ground::MadeGround;
use tilescope_session::layers::Layer;
use tilescope_session::solid::Cut;
use tilescope_session::units::radii;
use tilescope_session::words::grouped;
use tilescope_ui::language::Worded;

use tilescope_drawing::MIN_DISK_SCALE;
use tilescope_drawing::made::Made;
use tilescope_drawing::subject::Subject;

/// An upper bound of the width of tags, in screen points. It decides on which side of the pointer a tag is.
const MAX_CARD_WIDTH: f32 = 380.0;
/// Minimum and maximum distance of a tag from the pointer, in screen points.
const NEAREST: f32 = 10.0;
const MAX_DISTANCE: f32 = 90.0;
/// Radius of the ring around the sample under the pointer.
const HALO: f32 = 15.0;
/// Pick radius around a sample in a gap, in screen points; beyond it the gap is named.
const ON_SAMPLE: f32 = 5.0;
/// Vertical room for a tag above the object that it names.
const MAX_CARD_HEIGHT: f32 = 64.0;

/// The object under the pointer.
struct Named {
    /// A short name and a full description.
    brief: String,
    full: String,
    /// Its position and radius, in screen points.
    at: Pos2,
    reach: f32,
}

/// Shows the tag beside the pointer and announces it to screen readers; `brief` shows the name only.
pub fn show(
    ui: &Ui,
    painter: &Painter,
    response: &Response,
    subject: &Subject<'_>,
    palette: &Palette,
    brief: bool,
) {
    // A pointer that drags the picture does not ask for a name.
    let pointer = response.hover_pos().filter(|_| !response.dragged());
    let Some(named) = pointer.and_then(|pos| pointed_at(subject, response.rect, pos)) else {
        return;
    };
    let text = &ui.words(if brief { &named.brief } else { &named.full });
    ui.ctx().accesskit_node_builder(response.id, |node| {
        node.set_description(text.as_str());
    });
    tag(painter, response.rect, &named, text, palette);
}

/// Returns the object under the pointer, if there is one.
fn pointed_at(subject: &Subject<'_>, rect: Rect, pointer: Pos2) -> Option<Named> {
    let shown = subject.shown;
    // The picture of the pattern has no samples, gaps and blocks of the run.
    if shown.stage == Stage::Pattern {
        return None;
    }
    let position = subject.camera.domain_from_screen(rect, pointer);

    // Where symbols are so small that they overlap, no single sample can be pointed at.
    let is_fine = subject.camera.scale * shown.spacing() >= MIN_DISK_SCALE;
    let hovered = subject.hovered.filter(|_| is_fine).map(|id| {
        let at = shown.session.position(id);
        (id, subject.camera.screen_from_domain(rect, at))
    });

    // Inside a gap the gap is named, unless the pointer is on the symbol of a sample.
    let on_sample = hovered.is_some_and(|(_, at)| at.distance(pointer) <= ON_SAMPLE);
    if let Some((described, reach)) = gap(subject, position).filter(|_| !on_sample) {
        let on_screen = reach * subject.camera.scale as f32;
        return Some(Named {
            brief: "Gap".to_owned(),
            full: described,
            at: pointer,
            reach: on_screen.clamp(NEAREST, MAX_DISTANCE),
        });
    }

    if let Some((id, at)) = hovered {
        let [brief, full] = sample(subject, id);
        return Some(Named {
            brief,
            full,
            at,
            reach: HALO,
        });
    }

    let [brief, full] = block(subject, position)?;
    Some(Named {
        brief,
        full,
        at: pointer,
        reach: NEAREST,
    })
}

/// Returns the words for a sample that another one removed: exact tiling resolves no conflicts; its later sample is lost.
fn eliminated(by: u32, is_exact: bool) -> String {
    let verb = if is_exact { "lost to" } else { "eliminated by" };
    format!("{verb} sample {}", grouped(by as usize))
}

/// Returns where a sample is from that came in an iteration of exact tiling: its iterations are levels, the first of which has
/// two.
fn lacking(iteration: u32) -> String {
    match iteration {
        1 => "that the pattern lacks, of level 0 or 1".to_owned(),
        level => format!("that the pattern lacks, of level {level}"),
    }
}

/// Returns the short name and the full description of a sample.
pub(crate) fn sample(subject: &Subject<'_>, id: u32) -> [String; 2] {
    let shown = subject.shown;
    let number = grouped(id as usize);
    // Nested sets have levels instead of blocks and iterations.
    if let Some(nested) = &shown.session.nested {
        let text = format!("Sample {number} of level {}", nested.level_of(id as usize));
        return [text.clone(), text];
    }

    // In a plane through a set in space it matters how the plane cuts the sample's ball.
    if let Some(cut) = shown.cut(id) {
        let text = format!("Sample {number}: {}", cut_text(cut));
        return [text.clone(), text];
    }

    let stands = match shown.standing(id) {
        Standing::Absent => "not there yet".to_owned(),
        Standing::Tiled => "not decided yet".to_owned(),
        Standing::Valid => "valid".to_owned(),
        Standing::Dropped => "dropped outside the domain".to_owned(),
        Standing::Eliminated { by } => eliminated(by, shown.session.is_exact()),
    };

    let word = block_name(shown.session);
    let from = match shown.session.run().samples.origins[id as usize] {
        // A large set of darts in a field or a shape keeps nothing but its samples, as does an exact tiling from a file: the
        // origin is a placeholder.
        Origin::Tiled { .. } if shown.session.is_in_field() => {
            let is_tiled = (shown.session.ground.as_ref()).is_some_and(MadeGround::is_tiled);
            if is_tiled {
                "from a file"
            } else {
                "made by darts"
            }
            .to_owned()
        }
        Origin::Tiled {
            block, own: true, ..
        } => format!("of {word} {}", grouped(block as usize)),
        Origin::Tiled { block, .. } => {
            format!("from the margin of {word} {}", grouped(block as usize))
        }
        // A set in a field or a shape that is recorded with its events has the throws of its darts as iterations.
        Origin::Inserted { iteration, .. } if shown.session.is_in_field() => {
            format!("of throw {iteration}")
        }
        Origin::Inserted { iteration, .. } if shown.session.is_exact() => lacking(iteration),
        Origin::Inserted { iteration, .. } => format!("inserted in iteration {iteration}"),
    };

    // The text says how much of the circle is exposed only while the exposed arcs are drawn.
    let exposed = subject
        .layers
        .has(Layer::CoveredCircles)
        .then(|| exposed(subject, id))
        .flatten()
        .unwrap_or_default();

    // In a field or a shape, a sample's radius is named, as radii may differ there. It is in the unit of the domain.
    let radius = shown.session.ground.as_ref().map_or_else(String::new, |_| {
        let in_units = shown.session.radius_of(id) * shown.session.run().domain.radius();
        let text = tilescope_session::words::significant(in_units);
        format!(", radius {text}")
    });

    [
        format!("Sample {number}: {stands}{radius}{exposed}"),
        format!("Sample {number} {from}: {stands}{radius}{exposed}"),
    ]
}

/// Describes how a plane cuts the ball of a sample.
fn cut_text(cut: Cut) -> String {
    let radius = format!("its disk has radius {:.2} r", cut.radius);
    match cut.side() {
        Some(side) => format!("{:.2} r {side} the plane, {radius}", cut.above.abs()),
        None => format!("in the plane, {radius}"),
    }
}

/// Describes how much of a sample's circle other disks cover, if the sample has a disk and its neighbours are known by now.
fn exposed(subject: &Subject<'_>, id: u32) -> Option<String> {
    let shown = &subject.shown;
    if shown.stage < Stage::Tile || !shown.covers(id) {
        return None;
    }
    let degrees = subject.geometry.exposed_degrees(shown, id)?;
    Some(if degrees > 0.0 {
        format!(", {degrees:.1}\u{b0} of its circle exposed")
    } else {
        ", its circle covered".to_owned()
    })
}

/// Returns whether uncovered places of the moment count as gaps: not before elimination, and neither the disks of a
/// prefix of nested levels nor those of a set in a field or in space have the radius r.
pub(crate) fn has_gaps(subject: &Subject<'_>) -> bool {
    let shown = &subject.shown;
    let is_of_radius_r = !shown.session.has_own_disks() && shown.prefix.is_none();
    is_of_radius_r && shown.stage >= Stage::Eliminate
}

/// Describes the gap at a position, with the distance from there to its farthest corner, in r; `None` if no gap is
/// known there.
fn gap(subject: &Subject<'_>, position: DVec2) -> Option<(String, f32)> {
    let shown = &subject.shown;
    let size = shown.session.size_radii();
    // Only places of the domain have to be covered: beyond its borders nothing is a gap.
    let is_inside = (position.cmpge(DVec2::ZERO) & position.cmplt(size)).all();
    if !has_gaps(subject) || !is_inside {
        return None;
    }

    let gap = subject.geometry.gap_at(shown, position)?;
    // Each edge begins at a corner, where the one before it ends.
    let corners = gap.boundary.iter().flatten().map(|edge| match *edge {
        Edge::Line { from, .. } => from,
        Edge::Arc {
            center, from_angle, ..
        } => center + DVec2::from_angle(from_angle),
    });
    let distances = corners.map(|corner| corner.distance(position));

    Some((gap_text(gap), distances.fold(0.0, f64::max) as f32))
}

/// Returns the description of a gap.
pub(crate) fn gap_text(gap: &GapRegion) -> String {
    let (area, deepest) = (gap.area, gap.deepest.1);
    format!("Gap: area {area:.4} r\u{b2}, deepest {deepest:.4} r")
}

/// Returns the word for the blocks of a session.
const fn block_name(session: &tilescope_session::Session) -> &'static str {
    match session.combination {
        Some(_) => "piece",
        None => "block",
    }
}

/// Returns the short name and the full description of the block at a position, in r; `None` if no block is there.
fn block(subject: &Subject<'_>, position: DVec2) -> Option<[String; 2]> {
    let made = Made::at(&subject.shown);
    // While the tree is being built, only the leaves made so far have a name.
    let leaves = &subject.shown.session.run().blocks.leaves[..made.leaves];
    let number = leaves.iter().position(|leaf| holds(&leaf.rect, position))?;
    Some(block_of(subject, number))
}

/// Returns whether a place, in r, lies in a rectangle.
fn holds(rect: &tilescope_core::Rect, place: DVec2) -> bool {
    // Half open, so that a place on an edge lies in one block.
    let axis = |low: i32, high: i32, at: f64| radii(low) <= at && at < radii(high);
    axis(rect.min.x, rect.max.x, place.x) && axis(rect.min.y, rect.max.y, place.y)
}

/// Returns the short name and the full description of a block by its number.
pub(crate) fn block_of(subject: &Subject<'_>, number: usize) -> [String; 2] {
    let blocks = &subject.shown.session.run().blocks;
    let leaf = &blocks.leaves[number];
    let brief = match subject.shown.session.combination {
        Some(_) => format!("Piece {}", grouped(number)),
        None => format!("Block {}", grouped(number)),
    };

    let sides = [leaf.rect.width(), leaf.rect.height()].map(radii);
    let size = format!("{:.1} \u{d7} {:.1} r", sides[0], sides[1]);
    let middle = middle_of(&leaf.rect);
    // A split comes later in the list than those above it in the tree, so that the last one that holds the middle cut off the
    // leaf. The text counts splits from 1.
    let last = blocks
        .splits
        .iter()
        .rposition(|split| holds(&split.rect, middle));
    let full = match last {
        Some(split) => format!("{brief}: {size}, cut off by split {}", grouped(split + 1)),
        None => format!("{brief}: {size}"),
    };
    [brief, full]
}

/// Returns the place in the middle of a rectangle, in r.
pub(crate) fn middle_of(rect: &tilescope_core::Rect) -> DVec2 {
    let middle = |low: i32, high: i32| f64::midpoint(radii(low), radii(high));
    DVec2::new(
        middle(rect.min.x, rect.max.x),
        middle(rect.min.y, rect.max.y),
    )
}

/// Shows the tag of an object that the list of objects has chosen, at `at` of the canvas `rect`.
pub(crate) fn chosen(ui: &Ui, rect: Rect, at: Pos2, text: &str, palette: &Palette) {
    let named = Named {
        brief: String::new(),
        full: String::new(),
        at,
        reach: HALO,
    };
    tag(&ui.painter_at(rect), rect, &named, text, palette);
}

/// Draws the text above and to the right of its target, or on another side if there is more room. The side depends on
/// the position alone, so that the tag does not jump when the text changes.
fn tag(painter: &Painter, rect: Rect, named: &Named, text: &str, palette: &Palette) {
    let margin = vec2(9.0, 5.0);
    let font = FontId::proportional(12.5);
    // In a canvas narrower than the text there are several lines.
    let room = (rect.width() - 2.0 * margin.x).max(1.0);
    let galley = painter.layout(text.to_owned(), font, palette.text, room);

    // The side is chosen as if the tag had its largest size.
    let to_right = named.at.x + named.reach + MAX_CARD_WIDTH < rect.right();
    let above = named.at.y - named.reach - MAX_CARD_HEIGHT > rect.top();

    // `x` is 1 to the right and -1 to the left; `y` is 1 downwards and -1 upwards.
    let (anchor, x) = match (to_right, above) {
        (true, true) => (Align2::LEFT_BOTTOM, 1.0),
        (true, false) => (Align2::LEFT_TOP, 1.0),
        (false, true) => (Align2::RIGHT_BOTTOM, -1.0),
        (false, false) => (Align2::RIGHT_TOP, -1.0),
    };
    let y = if above { -1.0 } else { 1.0 };

    let corner = named.at + vec2(x * (named.reach + margin.x), y * (named.reach + margin.y));
    let placed = anchor.anchor_size(corner, galley.size());

    // In a narrow canvas the text would begin left of the edge, and is moved back into the canvas.
    let overhang = (rect.left() + margin.x - placed.left()).max(0.0);
    let text_rect = placed.translate(vec2(overhang, 0.0));

    let ground = text_rect.expand2(margin);
    let stroke = Stroke::new(1.0, palette.line);
    painter.rect(ground, 6.0, palette.panel, stroke, StrokeKind::Inside);
    painter.galley(text_rect.min, galley, palette.text);
}
