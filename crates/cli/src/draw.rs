//! `tilescope draw`: draws a point set as PNG or SVG.

mod part;

use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use clap::{Args, ValueEnum};
use tilescope_analysis::{COVERING_TOLERANCE, Number, Region, exposed_arcs, lossy};
use tilescope_core::{Boundary, Key, NOT_OF_EXACT, Parameters, PatternSpec, stages};
use tilescope_drawing::orbit::OrbitView;
use tilescope_figures::{
    DiskRadii, FigureError, Palette, PictureOptions, PlaneLook, Rect, Scene, SetPicture, set_scene,
    to_png_controlled,
};
use tilescope_formats::{Certificate, CertifiedRadius, PointSet, Provenance, ReadSet, write_whole};
use tilescope_session::look::Look;
use tilescope_session::words::grouped;

use crate::ground::GroundArguments;
use crate::options::SetArguments;
use crate::paths::{InFile, check_file, check_inputs_stay, extension, named};
use crate::progress::verifying;
use crate::solid::{self, Slice, orbit};
use crate::{EXIT_FINE, interrupt, output};
use part::{Shown, window};

/// Widths of a picture in pixels. In a smaller one even the disks of the coarsest periodic set, 10 r wide, would be no more than
/// three pixels across; the exporters refuse wider ones ([`tilescope_figures::MAX_SIDE`]).
const WIDTHS: RangeInclusive<u32> = 16..=32_768;

/// Arguments of `tilescope draw`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, allow_negative_numbers = true)]
pub struct DrawArguments {
    /// The point set
    file: PathBuf,
    /// The picture: .png or .svg, with --turn .gif, .apng or .png
    picture: PathBuf,
    #[command(flatten)]
    set: SetArguments,
    #[command(flatten)]
    ground: GroundArguments,
    /// Width of the picture in pixels; without it 1600, and 480 for an animation
    #[arg(long, value_name = "PX")]
    size: Option<u32>,
    /// Draw only this part of the domain, in the file's units
    #[arg(long, num_args = 4, value_names = ["X0", "Y0", "X1", "Y1"], allow_negative_numbers = true)]
    window: Option<Vec<f64>>,
    /// Leave the disks out
    #[arg(long)]
    no_disks: bool,
    /// Draw the parts of circles that lie in no other disk: around each gap they form a ring, and a maximal set of one radius
    /// in a rectangle has none
    #[arg(long)]
    gaps: bool,
    /// Of a set in space, draw this plane: each ball that it meets is a disk, with a dot that is orange above the plane, blue below
    /// it, and paler the farther away. Places in none of the disks are gaps, which --gaps colours
    #[arg(long, value_name = "AXIS=PLACE", value_parser = Slice::parse)]
    slice: Option<Slice>,
    /// Of a set in space, draw balls of half the radius, seen from this direction in degrees: around from the x axis, then above;
    /// after them a magnification and "whole", so that no corner is cut out
    #[arg(long, value_name = "AZIMUTH,ELEVATION[,ZOOM[,whole]]", num_args = 0..=1,
        default_missing_value = "300,30", value_parser = orbit::parse,
        conflicts_with_all = ["slice", "gaps", "window", "no_disks"])]
    orbit: Option<OrbitView>,
    /// With --orbit, an animation in which the set turns once
    #[arg(long, requires = "orbit")]
    turn: bool,
    /// Colours
    #[arg(long, value_enum, default_value = "light")]
    theme: Theme,
}

const EXAMPLES: &str = "\
Disks need a radius: from the certificate, or --radius. Where it varies each sample has its own: from a column radius of the
file, or from the field that the certificate states; images must be given. Blocks are drawn when the certificate states
the parameters of KDRT or of exact tiling; samples have their block's colour when the file states their origin
(.ply and .json do).

Examples:
  tilescope draw set.csv set.png
  tilescope draw theirs.csv gaps.png --radius 0.01 --gaps
  tilescope draw set.ply zoom.svg --window 0.2 0.2 0.4 0.4 --theme dark
  tilescope draw field.npy field.png --radius-image grey.png
  tilescope draw balls.ply plane.png --slice z=5
  tilescope draw balls.ply balls.png --orbit
  tilescope draw balls.ply turn.gif --orbit 30,20 --turn --theme dark";

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Theme {
    Light,
    Dark,
}

/// Draws a set into a file.
pub fn run(arguments: &DrawArguments) -> Result<u8> {
    interrupt::listen();

    let path = &arguments.picture;
    // The parser does not ask for --orbit beside an option that cannot stand with it, such as --slice.
    ensure!(
        !arguments.turn || arguments.orbit.is_some(),
        "--turn turns the balls that --orbit draws: give --orbit, or leave --turn out"
    );
    let kind = PictureKind::of(path, arguments.turn)?;

    // Checked before the set is read. A picture over the set would destroy it and its certificate.
    check_file(path)?;
    check_inputs_stay(path, [arguments.file.as_path()])?;
    let has_image = arguments.ground.radius_image.is_some();
    arguments.set.refuse_two_radii(has_image)?;
    output::note_left_out(&arguments.set, &arguments.file);
    let width = arguments.width();
    ensure!(
        WIDTHS.contains(&width),
        "--size is {width}; it must be between {} and {} pixels",
        WIDTHS.start(),
        WIDTHS.end()
    );

    if let Some(view) = arguments.orbit {
        return of_space(arguments, view, kind);
    }
    let (laid_out, shown) = match arguments.slice {
        Some(slice) => of_plane(arguments, slice)?,
        None => of_set(arguments)?,
    };
    write_picture(path, &laid_out, kind)?;
    output::emit(&format!("{shown} samples drawn into {}\n", named(path)))?;
    Ok(EXIT_FINE)
}

/// Writes a picture that is laid out in pixels.
fn write_picture(path: &Path, laid_out: &Scene, kind: PictureKind) -> Result<()> {
    let bytes = match kind {
        PictureKind::Svg => tilescope_figures::to_svg(laid_out)?.into_bytes(),
        PictureKind::Png => {
            let scale = 1.0;
            match to_png_controlled(laid_out, scale, &mut |_, _| interrupt::flow()) {
                // Only a request to end cancels the picture, and the check below reports it.
                Err(FigureError::Cancelled) => Vec::new(),
                drawn => drawn?,
            }
        }
        // A file of another kind than its name says would be worse than none.
        PictureKind::Gif | PictureKind::Apng => {
            bail!("{}: one picture is written as .png or .svg", named(path))
        }
    };

    interrupt::check("the picture")?;
    Ok(write_whole(path, &bytes)?)
}

/// Draws the balls of a set in space, in a picture or in an animation of a turn.
fn of_space(arguments: &DrawArguments, view: OrbitView, kind: PictureKind) -> Result<u8> {
    refuse_ground(arguments)?;
    let path = &arguments.picture;
    let balls = orbit::read(&arguments.file, &arguments.set)?;
    let look = match arguments.theme {
        Theme::Light => Look::Light,
        Theme::Dark => Look::Dark,
    };
    let drawn = orbit::Drawn {
        balls: &balls,
        view,
        width: arguments.width(),
        palette: tilescope_drawing::palette::Palette::of(look),
    };

    let count = grouped(balls.points.len());
    // Frames are written one by one, so that only one of them is in memory.
    if kind.is_animation() {
        let frames = drawn.write_turn(path, kind == PictureKind::Gif)?;
        output::emit(&format!(
            "{count} balls turned in {frames} frames, in {}\n",
            named(path)
        ))?;
    } else {
        write_picture(path, &drawn.scene()?, kind)?;
        output::emit(&format!("{count} balls drawn into {}\n", named(path)))?;
    }
    Ok(EXIT_FINE)
}

/// What kind of file a picture is, by its extension.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PictureKind {
    Png,
    Svg,
    Gif,
    Apng,
}

impl PictureKind {
    /// Returns the kind that the extension asks for, of an animation or of a picture.
    fn of(path: &Path, is_animation: bool) -> Result<Self> {
        Ok(match (extension(path).as_str(), is_animation) {
            ("png", false) => Self::Png,
            ("svg", false) => Self::Svg,
            ("gif", true) => Self::Gif,
            ("apng" | "png", true) => Self::Apng,
            (_, true) => bail!(
                "{}: the extension of an animation must be .gif, .apng or .png",
                named(path)
            ),
            ("gif" | "apng", false) => bail!(
                "{}: the extension must be .png or .svg; animations are those of --orbit --turn",
                named(path)
            ),
            (_, false) => bail!("{}: the extension must be .png or .svg", named(path)),
        })
    }

    const fn is_animation(self) -> bool {
        matches!(self, Self::Gif | Self::Apng)
    }
}

impl DrawArguments {
    /// Returns the width in pixels. An animation is smaller: its frames are as many times as large in the file.
    fn width(&self) -> u32 {
        self.size.unwrap_or(if self.turn { 480 } else { 1600 })
    }
}

/// Refuses a field or a shape, which sets in space do not have.
fn refuse_ground(arguments: &DrawArguments) -> Result<()> {
    // Only an option that is given has a name here.
    let is_given = true;
    let ground = arguments.ground.option().map(|name| (name, is_given));
    solid::refuse(ground.as_slice(), solid::PLANAR)
}

/// Returns the picture of a planar set, and how many samples it shows.
fn of_set(arguments: &DrawArguments) -> Result<(Scene, Shown)> {
    ensure!(
        !solid::is_in_space(&arguments.set, &arguments.file),
        "{}: the set has a third side, and a picture is that of a plane of it, --slice z=PLACE, or of its balls, --orbit",
        named(&arguments.file)
    );
    let read = arguments.set.read_varying(&arguments.file)?;
    ensure!(
        !read.set.is_empty(),
        "{}: the set is empty",
        named(&arguments.file)
    );

    let stated = read.certificate.as_ref();
    // Sides that are given take the place of the stated ones; without either the domain is the unit square.
    let region = (arguments.set).region_over(stated.map_or(Region::UNIT_SQUARE, |c| c.region));
    // Degrees are of different lengths along the two axes, and disks would not be circles.
    (arguments.set)
        .refuse_degrees(&read, region)
        .in_file(&arguments.file)?;

    scene(arguments, &read, region)
}

/// Returns the picture of a plane of a set in space, and how many samples it shows, of those whose balls meet the plane.
fn of_plane(arguments: &DrawArguments, slice: Slice) -> Result<(Scene, Shown)> {
    refuse_ground(arguments)?;
    let disks = solid::plane::read(&arguments.file, &arguments.set, slice)?;
    let (count, region) = (disks.middles.len(), disks.region);
    let name = lossy(arguments.file.file_name().unwrap_or_default());

    // What the disks do not show: on which side of the plane a sample lies.
    let above = disks.above();
    let look = PlaneLook {
        above: &above,
        gaps: arguments.gaps,
    };
    let picture = SetPicture {
        points: &disks.middles,
        size: region.size(),
        boundary: Boundary::of(region.is_periodic()),
        radii: DiskRadii::Own(&disks.radii),
        blocks: Vec::new(),
        block_of: None,
        exposed: Vec::new(),
        plane: Some(look),
        caption: format!("{name}: {slice} meets {count} of {} balls", disks.samples),
    };
    let options = picture_options(arguments, &region, disks.origin)?;
    let shown = Shown::of(picture.points, &region, options.window);
    Ok((set_scene(&picture, &options), shown))
}

/// Returns how a picture is drawn of a domain whose lower corner lies at `origin` in the units of the file.
fn picture_options(
    arguments: &DrawArguments,
    region: &Region,
    origin: [f64; 2],
) -> Result<PictureOptions> {
    Ok(PictureOptions {
        width: f64::from(arguments.width()),
        palette: match arguments.theme {
            Theme::Light => Palette::LIGHT,
            Theme::Dark => Palette::DARK,
        },
        window: window(arguments.window.as_deref(), region, origin)?,
        disks: !arguments.no_disks,
    })
}

/// Returns the scene of a set in the plane, and how many samples it shows: the samples and the parts that the arguments add.
fn scene(arguments: &DrawArguments, read: &ReadSet, region: Region) -> Result<(Scene, Shown)> {
    let given = &arguments.set;
    let (set, certificate) = (&read.set, read.certificate.as_ref());
    let radius_of_each = own_radii(arguments, read)?;
    // Where the radius varies, the certificate's radius is not used: disks of one radius would be wrong.
    let stated = certificate
        .map(|c| &c.radius)
        .filter(|radius| !radius.varies());
    let radius = given.least_radius().or(stated.map(CertifiedRadius::least));
    let origin = given.origin().or(certificate.and_then(|c| c.origin));

    // Blocks of other sides or another radius are not those of this set.
    let as_certified =
        certificate.is_some_and(|c| c.region == region && Some(c.radius.least()) == radius);

    // Nothing verifies the set here, so that lengths of the command line were not checked yet.
    let sides = [("--width", region.width), ("--height", region.height)];
    let of_radius = radius.map(|radius| ("--radius", radius));
    for (name, length) in sides.into_iter().chain(of_radius) {
        ensure!(
            length.is_finite() && length > 0.0,
            "{name} is {}; it must be above 0",
            Number(length)
        );
    }

    // Inserted samples belong to no block, and have no block's colour.
    let block_of = |provenance: &Provenance| {
        Some(provenance.block).filter(|block| *block != Provenance::NO_BLOCK)
    };
    let provenance = set.provenance.as_ref();
    let is_varying = certificate.is_some_and(Certificate::is_varying) || radius_of_each.is_some();
    ensure!(
        !arguments.gaps || !is_varying && !arguments.ground.is_given(),
        "--gaps: where the radius varies a sample covers no disk, and beyond a shape nothing is covered, so that parts of \
         circles show no gaps; tilescope verify counts them; leave it out"
    );
    let arcs = (arguments.gaps).then(|| exposed(set, region, radius));

    let radii = match (&radius_of_each, radius) {
        (Some(own), _) => DiskRadii::Own(own),
        (None, Some(radius)) => DiskRadii::Equal(radius),
        (None, None) => DiskRadii::Unknown,
    };
    let picture = SetPicture {
        points: &set.points,
        size: region.size(),
        boundary: Boundary::of(region.is_periodic()),
        radii,
        blocks: (certificate.filter(|_| as_certified).and_then(blocks)).unwrap_or_default(),
        block_of: provenance.map(|all| all.iter().map(block_of).collect()),
        exposed: arcs.transpose()?.unwrap_or_default(),
        plane: None,
        caption: caption(set.len(), radii, &arguments.file),
    };

    let options = picture_options(arguments, &region, origin.unwrap_or_default())?;
    let shown = Shown::of(&set.points, &region, options.window);
    Ok((set_scene(&picture, &options), shown))
}

/// Returns the radius of each sample; `None` if all have the same one, if no disks are drawn, and if the field that the
/// certificate states cannot be had, which a note reports.
fn own_radii(arguments: &DrawArguments, read: &ReadSet) -> Result<Option<Vec<f64>>> {
    let (file, set, ground) = (&arguments.file, &arguments.set, &arguments.ground);
    let stated = read.certificate.as_ref();
    // One radius that is given is that of all disks. For a picture without disks no field need be given.
    if arguments.no_disks || (set.radius.is_some() && !ground.is_given()) {
        return Ok(None);
    }
    // Radii that stand in a column of the file need no field. Reading has compared the file's digest with that of its
    // certificate, if there is one, so that these are the certified radii.
    if let (Some(radii), false) = (&read.radii, ground.is_given()) {
        return Ok(Some(radii.clone()));
    }

    let is_field = stated.is_some_and(|stated| stated.radius.varies());
    if !is_field && !ground.is_given() {
        return Ok(None);
    }
    let varying = match ground.judged(file, set, stated) {
        // The certificate states a field of which this command line lacks the image, say. The samples can still be drawn; a
        // field that was given and cannot be used is an error.
        Err(error) if !ground.is_given() => {
            output::note(&format!("note: disks are left out: {error:#}"));
            return Ok(None);
        }
        judged => judged?,
    };
    let Some(varying) = varying.map(|ground| ground.varying) else {
        return Ok(None);
    };

    // The disks of another field would show conflicts and gaps that the set does not have.
    if let Some(stated) = stated {
        ensure!(
            stated.radius == varying.radius,
            "the radius is {}, and the certificate states {}: give the field that the set was made with",
            varying.radius,
            stated.radius
        );
    }
    // Only a field has a radius for each sample; a shape alone has one radius everywhere, and `radii` is empty.
    Ok(Some(varying.radii(&read.set.points)).filter(|radii| !radii.is_empty()))
}

/// Returns the parts of the circles around samples that lie in no other disk.
fn exposed(set: &PointSet, region: Region, radius: Option<f64>) -> Result<Vec<(usize, [f64; 2])>> {
    let radius = radius.context("--gaps needs a radius: from the certificate, or --radius")?;
    // The verifier takes places within this distance of a sample for covered: arcs are left around the gaps that it counts.
    let covering = radius * (1.0 + COVERING_TOLERANCE);
    let arcs = verifying(|control| exposed_arcs(&set.points, region, covering, control))?;
    Ok(arcs
        .iter()
        .map(|arc| (arc.sample, [arc.from, arc.to]))
        .collect())
}

/// Returns the building blocks of the tiling that a certificate describes, if it describes one.
fn blocks(certificate: &Certificate) -> Option<Vec<Rect>> {
    let mut value = serde_json::to_value(&certificate.parameters).ok()?;
    match certificate.method.as_str() {
        "kdrt" => {}
        // Exact tiling states only what it uses, and blocks do not depend on the rest.
        "exact" => {
            let defaults = serde_json::to_value(Parameters::default()).ok()?;
            for parameter in NOT_OF_EXACT {
                let name = parameter.key();
                value[name] = defaults[name].clone();
            }
        }
        // Other methods do not cut the whole domain into blocks.
        _ => return None,
    }
    // A pattern from a file does not parse as a pattern's description; blocks do not depend on it.
    value["pattern"] = serde_json::json!(PatternSpec::default());
    let parameters: Parameters = serde_json::from_value(value).ok()?;

    // Cuts are drawn from the seed for a domain and a leaf, whatever else is random: these are the blocks of the set's own run.
    let (domain, leaf) = (parameters.validate().ok()?, parameters.leaf_units().ok()?);
    let tree = stages::blocks::split(&domain, leaf, Key::from_seed(parameters.seed));
    let corner = |p| domain.user_from_lattice(p);
    let leaves = tree.leaves.iter();
    let rects = leaves.map(|block| Rect::new(corner(block.rect.min), corner(block.rect.max)));
    Some(rects.collect())
}

fn caption(count: usize, radii: DiskRadii<'_>, file: &Path) -> String {
    let name = lossy(file.file_name().unwrap_or_default());
    let radius = match radii {
        DiskRadii::Unknown => String::new(),
        DiskRadii::Equal(radius) => format!(", r = {radius:.6}"),
        DiskRadii::Own(own) => {
            let least = own.iter().copied().fold(f64::INFINITY, f64::min);
            let greatest = own.iter().copied().fold(0.0, f64::max);
            format!(", r = {least:.6} to {greatest:.6}")
        }
    };
    format!("{name}: {count} samples{radius}")
}
