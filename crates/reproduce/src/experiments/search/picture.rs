//! Pictures of the largest gaps that looking 2r far leaves: what is uncovered, and why no site sees both others.

use tilescope_analysis::{Boundary, Region, Tessellation};
use tilescope_core::Boundary as Ends;
use tilescope_figures::{
    Anchor, Baseline, Color, Fill, Font, Hatch, Marker, Palette, PictureOptions, Rect, Scene,
    SetPicture, Shape, Stroke, Style, Text, set_scene, with_alpha,
};

use super::witness::{Witness, told};
use crate::error::ReproduceError;
use crate::experiments::common::above_samples;
use crate::numbers::number;
use crate::outcome::Picture;
use crate::sets::Set;

/// Sides of the part that is shown, in radii.
const PART: f64 = 8.0;
/// Witnesses that are shown.
const SHOWN: usize = 2;
/// Samples further than this many radii from a witness have no part in its picture.
const AROUND: f64 = 12.0;

/// Returns a picture of each of the worst witnesses.
pub fn witnesses(set: &Set, worst: &[Witness]) -> Result<Vec<Picture>, ReproduceError> {
    let picture = |(index, witness): (usize, &Witness)| {
        Ok(Picture {
            name: format!("witness-{}", index + 1),
            caption: format!(
                "A gap (hatched) that looking 2 r far leaves: its centre is {} r from the nearest samples; {}. Dashed circles of \
                 2 r around the three sites show what each of them sees; the full disks have radius r.",
                number(witness.distance / set.radius, 5),
                told(witness)
            ),
            scene: scene(set, witness)?,
        })
    };
    worst.iter().take(SHOWN).enumerate().map(picture).collect()
}

fn scene(set: &Set, witness: &Witness) -> Result<Scene, ReproduceError> {
    let half = 0.5 * PART * set.radius;
    // The neighbourhood alone, in the middle of a small domain of its own.
    let middle = [2.0 * AROUND * set.radius; 2];
    let (points, size) = (around(set, witness.center, middle), middle.map(|x| 2.0 * x));
    let window = Rect::new(middle.map(|x| x - half), middle.map(|x| x + half));
    let options = PictureOptions {
        width: 900.0,
        window: Some(window),
        ..PictureOptions::default()
    };
    let distance = number(witness.distance / set.radius, 5);
    let picture = SetPicture {
        points: &points,
        size,
        boundary: Ends::Bounded,
        radius: Some(set.radius),
        blocks: Vec::new(),
        block_of: None,
        caption: format!("The centre of the gap is {distance} r from the nearest samples"),
    };
    let mut scene = set_scene(&picture, &options);
    let region = Region {
        width: size[0],
        height: size[1],
        boundary: Boundary::Bounded,
    };
    let parts = Tessellation::of(&points, region, set.radius)?;
    let gap = parts.gap_at(middle).map(|gap| &parts.gaps[gap].fill[..]);
    // Positions of a picture point down; its middle stays where it is.
    let flip = |[x, y]: [f64; 2]| [x, 2.0 * middle[1] - y];
    let triangles = gap.unwrap_or_default().iter();
    let triangles: Vec<_> = triangles
        .map(|corners| corners.map(|corner| flip(corner.to_array())))
        .collect();
    let sites = witness.sites.map(|[x, y]| [middle[0] + x, middle[1] - y]);
    let mut shapes = hole(&triangles, &options.palette);
    shapes.extend(triangle(
        witness,
        sites,
        middle,
        (set.radius, &options.palette),
    ));
    above_samples(&mut scene, "gap", shapes);
    Ok(scene)
}

/// Returns the samples around a position, moved so that it lies at `middle`.
fn around(set: &Set, center: [f64; 2], middle: [f64; 2]) -> Vec<[f64; 2]> {
    let period = [set.region.width, set.region.height];
    (set.points.iter())
        .map(|p| [0, 1].map(|k| p[k] - center[k]))
        .map(|d| [0, 1].map(|k| d[k] - period[k] * (d[k] / period[k]).round()))
        .filter(|d| d.iter().all(|x| x.abs() < AROUND * set.radius))
        .map(|d| [0, 1].map(|k| middle[k] + d[k]))
        .collect()
}

/// Returns the uncovered area, solid below a hatch.
fn hole(triangles: &[[[f64; 2]; 3]], palette: &Palette) -> Vec<Shape> {
    let solid = Fill::Solid(with_alpha(palette.gap, 170));
    let hatch = Fill::Hatch(Hatch {
        color: palette.gap,
        spacing: 5.0,
        width: 2.0,
    });
    let filled = |fill| {
        let style = Style {
            fill: Some(fill),
            stroke: None,
        };
        triangles.iter().map(move |corners| Shape::Polygon {
            points: corners.map(Into::into).to_vec(),
            style,
        })
    };
    filled(solid).chain(filled(hatch)).collect()
}

/// Returns the three sites, what each of them sees, and how far apart they are.
fn triangle(
    witness: &Witness,
    at: [[f64; 2]; 3],
    middle: [f64; 2],
    (radius, palette): (f64, &Palette),
) -> Vec<Shape> {
    let colors: [Color; 3] = [palette.conflict, palette.detector, palette.inserted];
    let mut shapes = vec![Shape::circle(
        middle,
        witness.distance,
        Style::stroked(palette.gap, 1.5),
    )];
    for (site, color) in at.iter().zip(colors) {
        let sight = Style {
            fill: None,
            stroke: Some(Stroke::new(color, 2.0).dashed(9.0, 5.0)),
        };
        shapes.push(Shape::circle(*site, 2.0 * radius, sight));
    }
    for (k, side) in witness.sides().iter().enumerate() {
        let ends = [at[(k + 1) % 3], at[(k + 2) % 3]];
        let what = format!("{} r", number(side / radius, 4));
        shapes.extend(side_of(ends, at[k], &what, radius, palette));
    }
    for (site, color) in at.iter().zip(colors) {
        shapes.push(Shape::marker(
            Marker::Dot,
            *site,
            15.0,
            Style::filled(color),
        ));
    }
    shapes.push(Shape::marker(
        Marker::Cross,
        middle,
        12.0,
        Style::stroked(palette.text, 1.5),
    ));
    shapes
}

/// Returns a side of the triangle of sites, its length written beyond its middle, as seen from the third site.
fn side_of(
    [from, to]: [[f64; 2]; 2],
    third: [f64; 2],
    what: &str,
    radius: f64,
    palette: &Palette,
) -> Vec<Shape> {
    let half = [0, 1].map(|k| 0.5 * (from[k] + to[k]));
    let away = [0, 1].map(|axis| half[axis] - third[axis]);
    let length = away[0].hypot(away[1]).max(1e-9);
    let position = [0, 1].map(|axis| half[axis] + 0.4 * radius * away[axis] / length);
    let mut shapes = vec![Shape::line(from, to, Stroke::new(palette.text, 1.2))];
    shapes.extend(label(position, what, radius, palette));
    shapes
}

/// Returns a text in the middle of its position, on a ground of its own.
fn label(at: [f64; 2], what: &str, radius: f64, palette: &Palette) -> [Shape; 2] {
    let [x, y] = [0.33, 0.11].map(|half| half * radius);
    let corner = |[right, up]: [f64; 2]| [at[0] + right * x, at[1] + up * y];
    let ground = Shape::Polygon {
        points: [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
            .map(|offset| corner(offset).into())
            .to_vec(),
        style: Style::filled(with_alpha(palette.background, 215)),
    };
    let mut text = Text::new(at, what, 18.0, palette.text);
    text.anchor = Anchor::Middle;
    text.baseline = Baseline::Middle;
    text.font = Font::SemiBold;
    [ground, Shape::Text(text)]
}
