//! The pictures of the page in a browser, icons and a still: `cargo run --release -p tilescope-drawing --example page
//! web/page`.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use glam::DVec2;
use png::{BitDepth, ColorType, Compression, Encoder, Filter};
use tilescope_core::{Fate, Origin, Parameters, PatternSpec, Run, Stage, Unobserved, sample};
use tilescope_drawing::picture::{MomentView, PictureView, scene, seam};
use tilescope_figures::{
    Color, Group, Palette, Pixels, Rect, Scene, Shape, Style, View, to_pixels, with_alpha,
};
use tilescope_session::Session;
use tilescope_session::moment::Moment;

type Failure = Box<dyn std::error::Error>;

/// Radii that an icon shows, side by side.
const ICON_RADII: f64 = 5.6;
/// Radius of an icon's corners, as a share of its side.
const CORNER: f64 = 0.22;
/// The part of a maskable icon that no mask cuts off is a disk of this share of its side.
const SAFE: f64 = 0.8;

/// Disks of the blocks that an icon shows.
const DISKS: [Color; 4] = [
    [0x6c, 0xa4, 0xff, 0xff],
    [0xe6, 0x9f, 0x00, 0xff],
    [0xd5, 0x7b, 0xc0, 0xff],
    [0xe6, 0xe9, 0xee, 0xff],
];
/// Radii that the still shows, side by side.
const STILL_RADII: f64 = 26.0;
/// Width of the still's frame in points, and the pixels of a point.
const WIDTH: f64 = 580.0;
const SCALE: f64 = 1.6;
/// Colours of the still.
const COLORS: usize = 28;

fn main() -> Result<(), Failure> {
    let folder = std::env::args().nth(1).ok_or("usage: page FOLDER")?;
    let folder = PathBuf::from(folder);
    let session = Session::from_run(run()?, 0);
    for side in [192, 512] {
        let mut rounded = to_pixels(&icon(&session, ICON_RADII), f64::from(side) / 512.0)?;
        round(&mut rounded);
        fs::write(folder.join(format!("icon-{side}.png")), encoded(&rounded)?)?;
        let whole = to_pixels(&icon(&session, ICON_RADII / SAFE), f64::from(side) / 512.0)?;
        let name = format!("icon-maskable-{side}.png");
        fs::write(folder.join(name), encoded(&whole)?)?;
    }
    fs::write(folder.join("still.png"), indexed(&still(&session)?)?)?;
    Ok(())
}

fn run() -> Result<Run, Failure> {
    let parameters = Parameters {
        radius: 1.0 / 64.0,
        leaf: 10.0,
        seed: 5,
        pattern: PatternSpec {
            side: 20.0,
            ..PatternSpec::default()
        },
        ..Parameters::default()
    };
    Ok(sample(&parameters, &mut Unobserved)?)
}

/// Disks around the corner of a block, in their blocks' colours, and what was inserted there. Half a radius wide, disks
/// do not overlap.
fn icon(session: &Session, radii: f64) -> Scene {
    const SIDE: f64 = 512.0;
    let run = session.run();
    let r = run.domain.radius();
    let corner = seam(session) * r;
    let half = DVec2::splat(0.5 * radii * r);
    let shown = Rect::new(corner - half, corner + half);
    let mut group = Group::new("disks");
    group.view = View::fit(shown, Rect::new([0.0; 2], [SIDE; 2]));
    let mut colors = BTreeMap::new();
    for (index, block) in run.blocks.leaves.iter().enumerate() {
        let corner = |p| run.domain.user_from_lattice(p);
        let rect = Rect::new(corner(block.rect.min), corner(block.rect.max));
        if rect.meets(&shown) {
            let color = DISKS[colors.len() % DISKS.len()];
            colors.insert(index as u32, color);
            let style = Style::filled(with_alpha(color, 40));
            group.shapes.push(Shape::Rect { rect, style });
        }
    }
    let samples = &run.samples;
    for (id, point) in samples.points.iter().enumerate() {
        if samples.fates[id] != Fate::Kept {
            continue;
        }
        let color = match samples.origins[id] {
            // Clips reach a little beyond their blocks.
            Origin::Tiled { block, .. } => colors.get(&block).copied().unwrap_or(DISKS[0]),
            Origin::Inserted { .. } => Palette::DARK.inserted,
        };
        let center = run.domain.user_from_lattice(*point);
        let radius = 0.42 * run.domain.radius();
        let disk = Shape::circle(center, radius, Style::filled(color));
        group.shapes.push(disk);
    }
    let mut scene = Scene::new(SIDE, SIDE, Palette::DARK.background);
    scene.groups.push(group);
    scene
}

/// The gaps along the seams, being filled.
fn still(session: &Session) -> Result<Pixels, Failure> {
    let index = session.stage_index(Stage::Iterate(1));
    let mut view = PictureView::of_stage(session, Stage::Iterate(1), WIDTH);
    view.size[1] = WIDTH / 2.0;
    view.camera.scale = WIDTH / STILL_RADII;
    (view.dark, view.print) = (true, false);
    let moment = Moment::after(session, index);
    let scene = scene(session, &MomentView { moment, view }, None);
    Ok(to_pixels(&scene, SCALE)?)
}

/// Makes the corners of a picture round.
fn round(pixels: &mut Pixels) {
    let side = f64::from(pixels.width);
    let radius = CORNER * side;
    for (index, pixel) in pixels.rgba.chunks_exact_mut(4).enumerate() {
        let at = [index as u32 % pixels.width, index as u32 / pixels.width];
        // How far the pixel's middle lies beyond the corners' centres.
        let beyond = at.map(|k| {
            let from_middle = (f64::from(k) + 0.5 - side / 2.0).abs();
            (from_middle - (side / 2.0 - radius)).max(0.0)
        });
        let inside = (radius - beyond[0].hypot(beyond[1]) + 0.5).clamp(0.0, 1.0);
        pixel[3] = (f64::from(pixel[3]) * inside).round() as u8;
    }
}

fn encoded(pixels: &Pixels) -> Result<Vec<u8>, Failure> {
    let opaque = pixels.rgba.chunks_exact(4).all(|pixel| pixel[3] == 255);
    let channels = if opaque { 3 } else { 4 };
    let bytes: Vec<u8> = pixels
        .rgba
        .chunks_exact(4)
        .flat_map(|pixel| pixel[..channels].to_vec())
        .collect();
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, pixels.width, pixels.height);
    encoder.set_color(if opaque {
        ColorType::Rgb
    } else {
        ColorType::Rgba
    });
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::High);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&bytes)?;
    writer.finish()?;
    Ok(file)
}

/// A picture in the colours of marks and in its most frequent ones: the others lie between them, along edges.
fn indexed(pixels: &Pixels) -> Result<Vec<u8>, Failure> {
    let mut counts: BTreeMap<[u8; 3], usize> = BTreeMap::new();
    let colors = pixels.rgba.chunks_exact(4).map(|p| [p[0], p[1], p[2]]);
    colors
        .clone()
        .for_each(|color| *counts.entry(color).or_default() += 1);
    let mut frequent: Vec<([u8; 3], usize)> = counts.into_iter().collect();
    frequent.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    // Marks are few and small, and what one looks for.
    let mut marks = Palette::DARK.marks().to_vec();
    marks.push(Palette::DARK.text);
    let marks: Vec<[u8; 3]> = marks.iter().map(|[r, g, b, _]| [*r, *g, *b]).collect();
    frequent.sort_by_key(|(color, _)| !marks.contains(color));
    frequent.truncate(COLORS);
    let nearest = |color: [u8; 3]| {
        let distance = |other: [u8; 3]| -> u32 {
            let differences = color
                .iter()
                .zip(other)
                .map(|(a, b)| u32::from(a.abs_diff(b)));
            differences.map(|difference| difference.pow(2)).sum()
        };
        let index = (0..frequent.len()).min_by_key(|&index| distance(frequent[index].0));
        index.unwrap_or(0) as u8
    };
    let indices: Vec<u8> = colors.map(nearest).collect();
    let mut file = Vec::new();
    let mut encoder = Encoder::new(&mut file, pixels.width, pixels.height);
    encoder.set_color(ColorType::Indexed);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_palette(
        frequent
            .iter()
            .flat_map(|(color, _)| *color)
            .collect::<Vec<u8>>(),
    );
    encoder.set_compression(Compression::High);
    encoder.set_filter(Filter::NoFilter);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&indices)?;
    writer.finish()?;
    Ok(file)
}
