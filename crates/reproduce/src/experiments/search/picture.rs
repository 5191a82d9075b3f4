//! Pictures of the largest gaps that looking 2r far leaves: the uncovered area, and why no site sees both others.

use glam::DVec2;
use serde_json::json;
use tilescope_analysis::{Region, Tessellation};
use tilescope_core::Boundary;
use tilescope_figures::{
    Anchor, Baseline, DiskRadii, Fill, Font, Hatch, Marker, Palette, PictureOptions, Rect, Scene,
    SetPicture, Shape, Stroke, Style, Text, set_scene, with_alpha,
};

use super::gaps::Witness;
use crate::error::Result;
use crate::experiments::common::above_samples;
use crate::numbers::number;
use crate::outcome::Picture;
use crate::sets::{Set, shortest};
use crate::texts::text;

// Sizes and numbers below are chosen, not measured.

/// Width of a picture, in points.
const WIDTH: f64 = 900.0;
/// Sides of the part that is shown, in radii.
const PART: f64 = 8.0;
/// Witnesses that are shown.
const SHOWN: usize = 2;
/// Samples further than this many radii from a witness have no part in its picture.
const AROUND: f64 = 12.0;

/// Returns a picture of each of the worst witnesses.
pub fn witnesses(set: &Set, worst: &[Witness]) -> Result<Vec<Picture>> {
    let picture = |(index, witness): (usize, &Witness)| {
        let values = json!({ "distance": witness.distance / set.radius, "sides": witness.sides() });
        Ok(Picture {
            name: format!("witness-{}", index + 1),
            caption: text("search/witness", &values),
            scene: scene(set, witness, text("search/witness-title", &values))?,
        })
    };
    worst.iter().take(SHOWN).enumerate().map(picture).collect()
}

/// Returns the picture of a witness: the samples around it, the uncovered area, and the three sites with what they see.
fn scene(set: &Set, witness: &Witness, caption: String) -> Result<Scene> {
    let radius = set.radius;
    // Only the neighbourhood is drawn, in the middle of a small domain of its own, whose border lies beyond all samples.
    let middle = [2.0 * AROUND * radius; 2];
    let (points, size) = (around(set, witness.center, middle), middle.map(|x| 2.0 * x));

    let half = 0.5 * PART * radius;
    let window = Rect::new(middle.map(|x| x - half), middle.map(|x| x + half));
    let options = PictureOptions {
        width: WIDTH,
        window: Some(window),
        ..PictureOptions::default()
    };

    let picture = SetPicture {
        points: &points,
        size,
        boundary: Boundary::Bounded,
        radii: DiskRadii::Equal(radius),
        blocks: Vec::new(),
        block_of: None,
        exposed: Vec::new(),
        plane: None,
        caption,
    };
    let mut scene = set_scene(&picture, &options);

    // The gap is the one that holds the witness's centre. If none does, no area is drawn.
    let is_periodic = false;
    let region = Region::new(size, is_periodic);
    let parts = Tessellation::of(&points, region, radius)?;
    let gap = parts.gap_at(middle).map(|gap| &parts.gaps[gap].fill[..]);

    // In a picture y points downwards: places are mirrored about its middle.
    let flip = |at: DVec2| DVec2::new(at.x, 2.0 * middle[1] - at.y);
    let triangles: Vec<_> = gap
        .unwrap_or_default()
        .iter()
        .map(|one| one.map(flip))
        .collect();

    let mut shapes = hole(&triangles, &options.palette);
    shapes.extend(triangle(witness, middle.into(), radius, &options.palette));
    above_samples(&mut scene, "gap", shapes);
    Ok(scene)
}

/// Returns the samples around a position, moved so that it lies at `middle`.
fn around(set: &Set, center: [f64; 2], middle: [f64; 2]) -> Vec<[f64; 2]> {
    let away = |p: &[f64; 2]| shortest([0, 1].map(|k| p[k] - center[k]), &set.region);
    let is_near = |d: &[f64; 2]| d.iter().all(|x| x.abs() < AROUND * set.radius);
    let near = set.points.iter().map(away).filter(is_near);
    near.map(|d| [0, 1].map(|k| middle[k] + d[k])).collect()
}

/// Returns the uncovered area, solid below a hatch.
fn hole(triangles: &[[DVec2; 3]], palette: &Palette) -> Vec<Shape> {
    // Transparency and hatch are chosen, not measured.
    let solid = Style::filled(with_alpha(palette.gap, 170));
    let mut hatched = solid;
    hatched.fill = Some(Fill::Hatch(Hatch {
        color: palette.gap,
        spacing: 5.0,
        width: 2.0,
    }));
    let styles = [solid, hatched].into_iter();
    styles
        .flat_map(|style| triangles.iter().map(move |corners| polygon(corners, style)))
        .collect()
}

fn polygon(corners: &[DVec2], style: Style) -> Shape {
    let points = corners.to_vec();
    Shape::Polygon { points, style }
}

/// Returns the three sites, what each of them sees, how far apart they are, and the empty circle around the witness
/// with a cross in its centre.
fn triangle(witness: &Witness, middle: DVec2, radius: f64, palette: &Palette) -> Vec<Shape> {
    let sites = witness.sites.map(|[x, y]| middle + DVec2::new(x, -y));
    // Each site and the circle of what it sees have a colour.
    let colored = sites
        .into_iter()
        .zip([palette.conflict, palette.detector, palette.inserted]);

    let empty = Style::stroked(palette.gap, 1.5);
    let mut shapes = vec![Shape::circle(middle, witness.distance, empty)];
    shapes.extend(colored.clone().map(|(site, color)| {
        let sight = Style::default().with_stroke(Stroke::new(color, 2.0).dashed(9.0, 5.0));
        Shape::circle(site, 2.0 * radius, sight)
    }));

    for (k, length) in witness.sides().iter().enumerate() {
        // Side k joins the two sites other than site k, as `Witness::sides` orders them.
        let corners = [1, 2, 3].map(|next| sites[(k + next) % 3]);
        let in_radii = format!("{} r", number(length / radius, 4));
        shapes.extend(side(corners, &in_radii, radius, palette));
    }

    // The dots of the sites come last, over the ends of the lines. Sizes are in points and were set by eye.
    let dot =
        |(site, color): (DVec2, _)| Shape::marker(Marker::Dot, site, 15.0, Style::filled(color));
    shapes.extend(colored.map(dot));
    let cross = Style::stroked(palette.text, 1.5);
    shapes.push(Shape::marker(Marker::Cross, middle, 12.0, cross));
    shapes
}

/// Returns the side from the first to the second of three sites. The text `length` is written beside the side's middle,
/// away from the third site, on a ground of its own.
fn side([from, to, third]: [DVec2; 3], length: &str, radius: f64, palette: &Palette) -> [Shape; 3] {
    let middle = from.midpoint(to);
    // The distance and the sizes of the text and of its ground were set by eye.
    let at = middle + 0.4 * radius * (middle - third).normalize_or_zero();
    let [x, y] = [0.33, 0.11].map(|half| half * radius);
    let corners = [[-x, -y], [x, -y], [x, y], [-x, y]].map(|offset| at + DVec2::from(offset));
    let ground = Style::filled(with_alpha(palette.background, 215));
    let mut text = Text::new(at, length, 18.0, palette.text);
    (text.anchor, text.baseline, text.font) = (Anchor::Middle, Baseline::Middle, Font::SemiBold);
    [
        Shape::line(from, to, Stroke::new(palette.text, 1.2)),
        polygon(&corners, ground),
        Shape::Text(text),
    ]
}
