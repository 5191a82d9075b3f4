//! The pictures: nine sets in one, whole and where four of them meet.

use std::collections::HashSet;

use serde_json::json;
use tilescope_core::{Boundary, Point, Rect as Cells, Source};
use tilescope_figures::{
    Baseline, Font, Group, Marker, Palette, PictureOptions, Rect, Scene, SetPicture, Shape, Stroke,
    Style, Text, set_scene, text_width,
};

use super::Glued;
use crate::experiments::common::above_samples;
use crate::outcome::Picture;
use crate::texts::text;

/// Sides of the part that is shown large, in radii.
const PART: f64 = 36.0;

/// Pieces in a sequence in which no two neighbours, across borders either, have one tint of six.
const TINTED: [usize; 9] = [0, 1, 2, 3, 4, 5, 8, 6, 7];

pub fn pictures(glued: &Glued, rects: &[Cells]) -> Vec<Picture> {
    let combined = &glued.combined;
    let corner = combined.domain.user_from_lattice(rects[4].min);
    let half = 0.5 * PART * combined.domain.radius();
    let part = Rect::new(corner.map(|x| x - half), corner.map(|x| x + half));
    let values = json!({
        "before": glued.before, "after": combined.points.len(), "part": PART,
        "lost": combined.eliminated.iter().filter(|lost| lost.own).count(),
    });
    let picture = |(name, window): (&str, Option<Rect>)| {
        let title = text(&format!("fig12/{name}-title"), &values);
        Picture {
            name: name.to_owned(),
            caption: text(&format!("fig12/{name}"), &values),
            scene: scene(glued, rects, window, title),
        }
    };
    [("nine", None), ("seams", Some(part))].map(picture).into()
}

fn scene(glued: &Glued, rects: &[Cells], window: Option<Rect>, caption: String) -> Scene {
    let combined = &glued.combined;
    let user = |p: Point| combined.domain.user_from_lattice(p);
    let points = combined.positions();
    let tint = |piece: u32| TINTED.iter().position(|other| *other == piece as usize);
    let block = |source: &Source| match *source {
        Source::Tiled { block, .. } => tint(block).map(|at| at as u32),
        Source::Inserted { .. } => None,
    };
    let options = PictureOptions {
        window,
        ..PictureOptions::default()
    };
    let blocks = TINTED.map(|piece| Rect::new(user(rects[piece].min), user(rects[piece].max)));
    let set = SetPicture {
        points: &points,
        size: combined.domain.size(),
        boundary: Boundary::Periodic,
        radius: Some(combined.domain.radius()),
        blocks: blocks.into(),
        block_of: Some(combined.sources.iter().map(block).collect()),
        caption,
    };
    let mut scene = set_scene(&set, &options);
    let style = Style::filled(options.palette.eliminated);
    if let Some(part) = window {
        // Positions of a picture point down, within the part that is shown.
        let flip = |[x, y]: [f64; 2]| [x, part.min[1] + part.max[1] - y];
        let positions = points_of(glued).into_iter().map(flip);
        let cross = |at| Shape::marker(Marker::Cross, at, 13.0, style);
        above_samples(&mut scene, "eliminated", positions.map(cross).collect());
    }
    legend(&mut scene, &options.palette, window.is_some());
    scene
}

/// Side of a legend's mark, its line and its text.
const MARK: f64 = 12.0;
const LINE: f64 = 34.0;
const TEXT: f64 = 14.0;

/// Adds a line below the picture that says what its marks are.
fn legend(scene: &mut Scene, palette: &Palette, close: bool) {
    let at = scene.height + 0.5 * LINE - 8.0;
    let piece = palette.block_borders[0];
    let disk = Style::default().with_stroke(Stroke::new(palette.disk, 1.4));
    let entries = [
        (
            "sample, in the colour of its set",
            Marker::Dot,
            1.0,
            Style::filled(piece),
        ),
        (
            "inserted",
            Marker::Diamond,
            1.0,
            Style::filled(palette.inserted),
        ),
        (
            "eliminated",
            Marker::Cross,
            1.0,
            Style::filled(palette.eliminated),
        ),
        ("disk of radius r", Marker::Dot, 1.6, disk),
    ];
    let mut group = Group::new("legend");
    let mut x = 20.0 + 0.5 * MARK;
    for (name, kind, size, style) in entries.into_iter().take(if close { 4 } else { 2 }) {
        group
            .shapes
            .push(Shape::marker(kind, [x, at], size * MARK, style));
        let mut text = Text::new([x + MARK + 4.0, at], name, TEXT, palette.text);
        text.baseline = Baseline::Middle;
        x += MARK + 4.0 + text_width(name, Font::Regular, TEXT) + 2.5 * MARK;
        group.shapes.push(Shape::Text(text));
    }
    scene.groups.push(group);
    scene.height += LINE;
}

/// Returns the positions of eliminated samples that lay in their own set's rectangle, each once.
fn points_of(glued: &Glued) -> Vec<[f64; 2]> {
    let lost = glued.combined.eliminated.iter().filter(|lost| lost.own);
    let positions: HashSet<Point> = lost.map(|lost| lost.point).collect();
    let user = |p| glued.combined.domain.user_from_lattice(p);
    let mut positions: Vec<[f64; 2]> = positions.into_iter().map(user).collect();
    positions.sort_by(|a, b| a[1].total_cmp(&b[1]).then(a[0].total_cmp(&b[0])));
    positions
}
