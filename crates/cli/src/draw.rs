//! `tilescope draw`: a point set as PNG or SVG.

use std::path::{Path, PathBuf};

use anyhow::{Result, bail, ensure};
use clap::{Args, ValueEnum};
use tilescope_analysis::{Boundary, Number, Region};
use tilescope_core::{Key, Parameters, stages};
use tilescope_figures::{Palette, PictureOptions, Rect, Scene, SetPicture, set_scene};
use tilescope_formats::{Certificate, PointSet, Provenance, write_whole};

use crate::options::{SetArguments, UNIT_SQUARE};
use crate::place::check_place;
use crate::{EXIT_FINE, interrupt, output};

/// Arguments of `tilescope draw`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct DrawArguments {
    /// The point set
    file: PathBuf,
    /// The picture: .png or .svg
    picture: PathBuf,
    #[command(flatten)]
    set: SetArguments,
    /// Width of the picture in pixels
    #[arg(long, value_name = "PX", default_value_t = 1600)]
    size: u32,
    /// Draw only this part of the domain, in user units
    #[arg(long, num_args = 4, value_names = ["X0", "Y0", "X1", "Y1"], allow_negative_numbers = true)]
    window: Option<Vec<f64>>,
    /// Leave the disks out
    #[arg(long)]
    no_disks: bool,
    /// Colours
    #[arg(long, value_enum, default_value = "light")]
    theme: Theme,
}

const EXAMPLES: &str = "\
Disks need a radius: from the certificate, or --radius. Blocks are drawn when the certificate tells
the parameters of a KDRT run; samples have their block's colour when the file tells their origin
(.ply and .json do).

Examples:
  tilescope draw set.csv set.png
  tilescope draw set.ply zoom.svg --window 0.2 0.2 0.4 0.4 --theme dark";

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Theme {
    Light,
    Dark,
}

/// Formats of pictures.
#[derive(Clone, Copy)]
enum Picture {
    Png,
    Svg,
}

pub fn run(arguments: &DrawArguments) -> Result<u8> {
    interrupt::listen();
    let picture = picture_of(&arguments.picture)?;
    check_place(&arguments.picture)?;
    ensure!(
        (16..=32_768).contains(&arguments.size),
        "--size is {}; it must be between 16 and 32768 pixels",
        arguments.size
    );
    let read = arguments.set.read(&arguments.file)?;
    ensure!(
        !read.set.is_empty(),
        "{}: the set is empty",
        arguments.file.display()
    );
    let scene = scene(arguments, &read.set, read.certificate.as_ref())?;
    let bytes = match picture {
        Picture::Png => tilescope_figures::to_png(&scene, 1.0)?,
        Picture::Svg => tilescope_figures::to_svg(&scene)?.into_bytes(),
    };
    ensure!(!interrupt::requested(), "cancelled before the picture");
    write_whole(&arguments.picture, &bytes)?;
    output::emit(&format!(
        "{} samples drawn into {}\n",
        read.set.len(),
        arguments.picture.display()
    ))?;
    Ok(EXIT_FINE)
}

fn picture_of(path: &Path) -> Result<Picture> {
    let extension = path
        .extension()
        .unwrap_or_default()
        .to_string_lossy()
        .to_lowercase();
    match extension.as_str() {
        "png" => Ok(Picture::Png),
        "svg" => Ok(Picture::Svg),
        _ => bail!("{}: the extension must be .png or .svg", path.display()),
    }
}

fn scene(
    arguments: &DrawArguments,
    set: &PointSet,
    certificate: Option<&Certificate>,
) -> Result<Scene> {
    let given = &arguments.set;
    let base = certificate.map_or(UNIT_SQUARE, |c| c.region);
    let region = Region {
        width: given.width.unwrap_or(base.width),
        height: given.height.unwrap_or(base.height),
        boundary: given.boundary.map_or(base.boundary, Into::into),
    };
    let radius = given.radius.or(certificate.map(|c| c.radius));
    // Blocks of other sides or another radius are not those of this set.
    let as_certified = certificate.is_some_and(|c| c.region == region && Some(c.radius) == radius);
    for (name, value) in [("--width", region.width), ("--height", region.height)] {
        ensure!(
            value.is_finite() && value > 0.0,
            "{name} is {}; it must be above 0",
            Number(value)
        );
    }
    if let Some(radius) = radius {
        ensure!(
            radius.is_finite() && radius > 0.0,
            "--radius is {}; it must be above 0",
            Number(radius)
        );
    }
    let picture = SetPicture {
        points: &set.points,
        size: [region.width, region.height],
        boundary: match region.boundary {
            Boundary::Periodic => tilescope_core::Boundary::Periodic,
            Boundary::Bounded => tilescope_core::Boundary::Bounded,
        },
        radius,
        blocks: certificate
            .filter(|_| as_certified)
            .map(blocks)
            .unwrap_or_default(),
        block_of: set
            .provenance
            .as_ref()
            .map(|all| all.iter().map(block_of).collect()),
        caption: caption(set.len(), radius, &arguments.file),
    };
    let options = PictureOptions {
        width: f64::from(arguments.size),
        palette: match arguments.theme {
            Theme::Light => Palette::LIGHT,
            Theme::Dark => Palette::DARK,
        },
        window: window(arguments.window.as_deref(), &region)?,
        disks: !arguments.no_disks,
    };
    Ok(set_scene(&picture, &options))
}

fn window(given: Option<&[f64]>, region: &Region) -> Result<Option<Rect>> {
    let Some(&[x0, y0, x1, y1]) = given else {
        return Ok(None);
    };
    ensure!(
        [x0, y0, x1, y1].iter().all(|v| v.is_finite()) && x0 < x1 && y0 < y1,
        "--window is {x0} {y0} {x1} {y1}; it must be X0 < X1 and Y0 < Y1"
    );
    ensure!(
        x1 > 0.0 && y1 > 0.0 && x0 < region.width && y0 < region.height,
        "--window is {x0} {y0} {x1} {y1}; nothing of the domain, {} x {}, lies in it",
        region.width,
        region.height
    );
    Ok(Some(Rect::new([x0, y0], [x1, y1])))
}

fn block_of(provenance: &Provenance) -> Option<u32> {
    (provenance.block != Provenance::NO_BLOCK).then_some(provenance.block)
}

/// Returns the building blocks of the KDRT run that a certificate describes, or none.
fn blocks(certificate: &Certificate) -> Vec<Rect> {
    let value = serde_json::to_value(&certificate.parameters).unwrap_or_default();
    // A pattern from a file does not parse as a pattern's description, and has no say here.
    let mut value = value;
    if let Some(map) = value.as_object_mut() {
        map.insert(
            "pattern".into(),
            serde_json::json!(tilescope_core::PatternSpec::default()),
        );
    }
    let parameters: Option<Parameters> = (certificate.method == "kdrt")
        .then(|| serde_json::from_value(value).ok())
        .flatten();
    let split = parameters.and_then(|p| {
        let (domain, leaf) = (p.validate().ok()?, p.leaf_units().ok()?);
        Some((
            domain,
            stages::blocks::split(&domain, leaf, Key::from_seed(p.seed)),
        ))
    });
    let Some((domain, blocks)) = split else {
        return Vec::new();
    };
    let corner = |p| domain.user_from_lattice(p);
    blocks
        .leaves
        .iter()
        .map(|b| Rect::new(corner(b.rect.min), corner(b.rect.max)))
        .collect()
}

fn caption(count: usize, radius: Option<f64>, file: &Path) -> String {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    match radius {
        Some(radius) => format!("{name}: {count} samples, r = {radius:.6}"),
        None => format!("{name}: {count} samples"),
    }
}
