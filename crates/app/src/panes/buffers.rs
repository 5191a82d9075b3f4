//! Draws the rows of a GPU buffer over the picture, as rings, squares, borders and links, with a tag that names them.
//! Their positions are computed by `workbench/src/passes/placed.rs`. Sizes are in screen points, and chosen, not
//! measured, where no reason stands beside them.

use std::fmt::Write as _;

use egui::text::{LayoutJob, TextFormat};
use egui::{Color32, FontId, Mesh, Painter, Pos2, Rect, Stroke, StrokeKind, Ui, Vec2, pos2, vec2};
use tilescope_core::{Rect as LatticeRect, Stage};
use tilescope_drawing::palette::Palette;
use tilescope_gpu::RowPlace;
use tilescope_session::units::position;
use tilescope_ui::widgets::Known;

use crate::ENABLED;
use tilescope_canvas::sprites::{Sprite, Sprites, Stamp};
use tilescope_drawing::subject::Subject;
use tilescope_workbench::passes::OnCanvas;
use tilescope_workbench::passes::canvas::Rows;

/// More marks than this in view are left out. Chosen, not measured.
pub const MAX_MARKS: usize = 20_000;
/// Distance of the tag from the corner of the canvas, in screen points.
const INSET: Vec2 = vec2(22.0, 24.0);
/// Height of a remark at the top of the canvas, in screen points.
const NOTE: f32 = 32.0;
/// Rings of a smaller radius are drawn as dots, in screen points.
const MIN_RING: f32 = 3.0;
/// The largest radius of a ring, in points.
const LARGEST_RING: f32 = 13.0;
/// Smaller squares are filled and have no border, in screen points.
const MIN_BORDERED: f32 = 5.0;

/// Draws the rows of a buffer; returns the remark for the top of the canvas: `note`, or how much is left out,
/// if anything is.
pub fn show(
    ui: &Ui,
    rect: Rect,
    subject: &Subject<'_>,
    buffers: &OnCanvas<'_>,
    palette: &Palette,
    sprites: &mut Sprites,
    note: Option<String>,
) -> Option<String> {
    let painter = ui.painter_at(rect);
    let mut left_out = 0;
    // The pattern has a plane of its own, on which rows of the run have no place.
    if let Some(rows) = buffers
        .rows
        .filter(|_| subject.shown.stage != Stage::Pattern)
    {
        let row_painter = RowPainter {
            painter: &painter,
            rect,
            subject,
            palette,
        };
        let view = InView::of(&row_painter, &rows);
        left_out = view.left_out;
        row_painter.draw(&view, sprites);
        // The selected row comes last, so that it lies over the one under the pointer.
        for (row, width) in [(rows.shown.pointed(), 2.0), (rows.shown.picked(), 3.0)] {
            if let Some(row) = row {
                row_painter.single_out(rows.places.of(row as usize), width);
            }
        }
    }

    // There is room for one remark. That of the samples comes first.
    let remark = note.or_else(|| {
        let most = tilescope_session::words::grouped(MAX_MARKS);
        let more = tilescope_session::words::grouped(left_out);
        (left_out > 0).then(|| format!("{most} marks of the buffer are drawn, changed rows first; {more} more are in view. Zoom in."))
    });

    let corner = vec2(0.0, if remark.is_some() { NOTE } else { 0.0 }) + INSET;
    tag(ui, &painter, rect.min + corner, buffers, left_out, palette);
    remark
}

/// The geometry of a row, and whether it lies in the domain.
struct Mark {
    spot: RowPlace,
    is_inside: bool,
}

/// The marks in view.
#[derive(Default)]
struct InView {
    unchanged: Vec<Mark>,
    changed: Vec<Mark>,
    left_out: usize,
}

impl InView {
    /// Returns the marks of rows in view, changed ones first, up to the maximum.
    fn of(row_painter: &RowPainter<'_>, rows: &Rows<'_>) -> Self {
        let mut view = Self::default();
        let mut rest = MAX_MARKS;
        // Changed rows are taken first, so that unchanged ones are left out before them.
        for changed in [true, false] {
            let list = if changed {
                &mut view.changed
            } else {
                &mut view.unchanged
            };

            for &row in rows.shown.rows() {
                if rows.table.is_changed(row as usize) != changed {
                    continue;
                }
                for spot in rows.marks(row).iter().filter(|spot| row_painter.sees(spot)) {
                    if rest == 0 {
                        // A remark at the top of the canvas says how many are left out.
                        view.left_out += 1;
                    } else {
                        rest -= 1;
                        list.push(Mark {
                            spot: *spot,
                            is_inside: rows.lies_inside(spot),
                        });
                    }
                }
            }
        }
        view
    }
}

struct RowPainter<'a> {
    painter: &'a Painter,
    rect: Rect,
    subject: &'a Subject<'a>,
    palette: &'a Palette,
}

impl RowPainter<'_> {
    fn at(&self, point: tilescope_core::Point) -> Pos2 {
        let camera = self.subject.camera;
        camera.screen_from_domain(self.rect, position(point))
    }

    fn square(&self, rect: &LatticeRect) -> Rect {
        Rect::from_two_pos(self.at(rect.min), self.at(rect.max))
    }

    fn sees(&self, spot: &RowPlace) -> bool {
        match spot {
            // A ring may reach into view from this far outside; a singled-out one is 4 points larger.
            RowPlace::Point(p) => self.rect.expand(LARGEST_RING + 4.0).contains(self.at(*p)),
            RowPlace::Link(ends) => {
                Rect::from_two_pos(self.at(ends[0]), self.at(ends[1])).intersects(self.rect)
            }
            RowPlace::Rect(rect) => self.square(rect).intersects(self.rect),
        }
    }

    /// Returns the radius of rings, a little larger than that of samples.
    fn ring(&self) -> f32 {
        (0.32 * self.subject.camera.scale as f32).clamp(1.0, LARGEST_RING)
    }

    fn draw(&self, view: &InView, sprites: &mut Sprites) {
        let ctx = self.painter.ctx();
        let ring = self.ring();
        let [faint, strong] = if ring < MIN_RING {
            [sprites.stamp(ctx, Sprite::Dot, 1.4); 2]
        } else {
            [Sprite::Disk, Sprite::Halo].map(|sprite| sprites.stamp(ctx, sprite, ring))
        };
        let muted = self.palette.text.gamma_multiply(0.55);
        let is_changed = true;
        self.layer(&view.unchanged, faint, muted, !is_changed);
        self.layer(&view.changed, strong, self.palette.accent, is_changed);
    }

    /// Draws marks in two meshes: squares and lines below, rings above, which have the picture of `stamp`. Marks of
    /// changed rows are stronger.
    fn layer(&self, marks: &[Mark], stamp: Stamp, color: Color32, is_changed: bool) {
        let mut rings = Mesh::with_texture(stamp.texture);
        let mut squares = Mesh::default();
        for mark in marks {
            // Rows beyond the domain's border are faint: they are copies, or were dropped there.
            let color = color.gamma_multiply(if mark.is_inside { 1.0 } else { 0.45 });
            match &mark.spot {
                RowPlace::Rect(rect) => {
                    add_square(&mut squares, self.square(rect), color, is_changed);
                }
                RowPlace::Link(ends) => {
                    let ends = ends.map(|end| self.at(end));
                    add_line(
                        &mut squares,
                        ends,
                        if is_changed { 1.6 } else { 1.0 },
                        color,
                    );
                    // The ring is at the row's own sample. The other end is the sample that eliminated it.
                    add_ring(&mut rings, stamp, ends[0], color);
                }
                RowPlace::Point(point) => add_ring(&mut rings, stamp, self.at(*point), color),
            }
        }

        self.painter.add(squares);
        self.painter.add(rings);
    }

    /// Outlines all places of the selected row, or of the one under the pointer, by lines of this width; also those
    /// that have no mark, as the cell of a row that did not change.
    fn single_out(&self, spots: &[RowPlace], width: f32) {
        // The outline stands clear of the row's own mark, which stays visible.
        let stroke = Stroke::new(width, self.palette.halo);
        for spot in spots {
            match spot {
                RowPlace::Rect(rect) => {
                    let square = self.square(rect).expand(2.0);
                    self.painter
                        .rect_stroke(square, 0.0, stroke, StrokeKind::Outside);
                }
                RowPlace::Link(ends) => {
                    let ends = ends.map(|end| self.at(end));
                    self.painter.line_segment(ends, stroke);
                    self.painter
                        .circle_stroke(ends[0], self.ring() + 4.0, stroke);
                }
                RowPlace::Point(point) => {
                    let at = self.at(*point);
                    self.painter.circle_stroke(at, self.ring() + 4.0, stroke);
                }
            }
        }
    }
}

fn add_ring(mesh: &mut Mesh, stamp: Stamp, at: Pos2, color: Color32) {
    let rect = Rect::from_center_size(at, Vec2::splat(2.0 * stamp.half));
    mesh.add_rect_with_uv(rect, tilescope_canvas::UNIT, color);
}

/// Adds the border of a square, with a background if it is to look `strong`; small ones are filled. Widths and
/// opacities are chosen.
fn add_square(mesh: &mut Mesh, rect: Rect, color: Color32, strong: bool) {
    let width = if strong { 1.5 } else { 1.0 };
    // The squares of neighbouring cells stand half a point apart.
    let inner = rect.shrink(0.25);
    // The border of so small a square would fill it anyway.
    if inner.width().min(inner.height()) < MIN_BORDERED {
        let ground = color.gamma_multiply(if strong { 0.7 } else { 0.3 });
        mesh.add_colored_rect(inner, ground);
        return;
    }
    if strong {
        mesh.add_colored_rect(inner, color.gamma_multiply(0.2));
    }

    let (across, up) = (vec2(inner.width(), width), vec2(width, inner.height()));
    let color = color.gamma_multiply(if strong { 1.0 } else { 0.6 });
    for (corner, size) in [
        (inner.min, across),
        (pos2(inner.min.x, inner.max.y - width), across),
        (inner.min, up),
        (pos2(inner.max.x - width, inner.min.y), up),
    ] {
        mesh.add_colored_rect(Rect::from_min_size(corner, size), color);
    }
}

fn add_line(mesh: &mut Mesh, ends: [Pos2; 2], width: f32, color: Color32) {
    let along = (ends[1] - ends[0]).normalized();
    let across = along.rot90() * width / 2.0;
    let first = mesh.vertices.len() as u32;
    for (end, side) in [(0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0)] {
        mesh.colored_vertex(ends[end] + across * side, color);
    }
    mesh.add_triangle(first, first + 1, first + 2);
    mesh.add_triangle(first + 1, first + 2, first + 3);
}

/// Draws the tag that names the rows and says how many changed.
fn tag(
    ui: &Ui,
    painter: &Painter,
    corner: Pos2,
    buffers: &OnCanvas<'_>,
    left_out: usize,
    palette: &Palette,
) {
    let [what, changed] = buffers.text();
    let font = FontId::monospace(12.0);
    let format = |color| TextFormat::simple(font.clone(), color);
    let mut job = LayoutJob::default();
    job.append(&what, 0.0, format(palette.text));

    // Changes stand out, as they are what a pass is looked at for.
    let has_changes = buffers
        .rows
        .is_some_and(|rows| rows.shown.counts().changed > 0);
    let color = if has_changes {
        palette.accent
    } else {
        palette.muted
    };
    job.append(&changed, 0.0, format(color));
    // The tag keeps clear of both edges. In a very narrow canvas it reaches beyond, so that a line has room for a word
    // or two.
    job.wrap.max_width = (painter.clip_rect().width() - 2.0 * INSET.x).max(80.0);

    let galley = painter.layout_job(job);
    let text_rect = Rect::from_min_size(corner, galley.size());
    let ground = text_rect.expand2(vec2(7.0, 4.0));
    painter.rect_filled(ground, 5.0, palette.panel.gamma_multiply(0.92));
    painter.galley(text_rect.min, galley, palette.text);

    // The tag is a widget, so that screen readers find it.
    let response = ui.interact(
        ground,
        ui.scope_id().with("buffer on the canvas"),
        egui::Sense::hover(),
    );

    let mut words = format!("On the canvas: {what}{changed}");
    if left_out > 0 {
        let _ = write!(words, "; {left_out} more marks are in view than are drawn");
    }
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Label, ENABLED, &words));
    response.known_as("on-canvas");
}
