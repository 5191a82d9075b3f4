//! Pictures of sets without their runs, with the colours and marks of the window.

use std::convert::Infallible;

use glam::DVec2;
use tilescope_core::Boundary;

use crate::canvas::{Canvas, PictureOptions};
use crate::control::{Control, Steps};
use crate::error::FigureError;
use crate::scene::{Fill, Marker, Rect, Scene, Style};

/// The radii of the disks around samples, in user units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DiskRadii<'a> {
    /// They are not known, and no disk is drawn.
    Unknown,
    /// All disks have this one.
    Equal(f64),
    /// Each disk has its own, in the order of the samples.
    Own(&'a [f64]),
}

impl DiskRadii<'_> {
    /// Returns the radius around a sample; 0 if it is not known.
    fn of(self, index: usize) -> f64 {
        match self {
            Self::Unknown => 0.0,
            Self::Equal(radius) => radius,
            Self::Own(radii) => radii.get(index).copied().unwrap_or(0.0),
        }
    }

    /// Returns the greatest radius; 0 if none is known.
    fn greatest(self) -> f64 {
        match self {
            Self::Unknown => 0.0,
            Self::Equal(radius) => radius,
            Self::Own(radii) => radii.iter().copied().fold(0.0, f64::max),
        }
    }
}

/// A set to draw without its run.
#[derive(Clone, Debug)]
pub struct SetPicture<'a> {
    /// Positions in user units.
    pub points: &'a [[f64; 2]],
    /// Width and height of the domain in user units.
    pub size: [f64; 2],
    /// How the domain ends.
    pub boundary: Boundary,
    /// Radii of the disks.
    pub radii: DiskRadii<'a>,
    /// Building blocks in user units, if known.
    pub blocks: Vec<Rect>,
    /// The block of each sample, where known; a sample without one was inserted.
    pub block_of: Option<Vec<Option<u32>>>,
    /// Parts of circles of equal radii around samples that lie in no other disk: the sample's index, and where the part begins and ends,
    /// as angles from the x axis, anticlockwise, in radians.
    pub exposed: Vec<(usize, [f64; 2])>,
    /// How a plane through a set in space looks; `None` for planar sets.
    pub plane: Option<PlaneLook<'a>>,
    /// A line above the picture.
    pub caption: String,
}

/// How a plane through a set in space looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneLook<'a> {
    /// How far each sample lies above the plane, in radii of the balls: from -1 to 1, below it less than 0.
    pub above: &'a [f64],
    /// Whether places of the plane that no disk covers have the colour of gaps.
    pub gaps: bool,
}

/// Returns the picture of a point set.
#[must_use]
pub fn set_scene(set: &SetPicture<'_>, options: &PictureOptions) -> Scene {
    let Ok(scene) = laid_out::<Infallible>(set, options, &mut || Ok(()));
    scene
}

/// Returns the picture of a point set. Calls `control` while samples are laid out.
///
/// # Errors
///
/// [`FigureError::Cancelled`] when `control` breaks.
pub fn set_scene_controlled(
    set: &SetPicture<'_>,
    options: &PictureOptions,
    control: Control<'_>,
) -> Result<Scene, FigureError> {
    // Disks, where they are drawn, and marks.
    let mut steps = Steps::new(2 * set.points.len(), control);
    laid_out(set, options, &mut || steps.shape())
}

/// Returns the picture of a point set. Calls `step` for each sample of each layer, and fails if it does.
fn laid_out<E>(
    set: &SetPicture<'_>,
    options: &PictureOptions,
    step: &mut dyn FnMut() -> Result<(), E>,
) -> Result<Scene, E> {
    // The greatest radius decides whether disks are drawn at all. Below, each sample gets its own radius.
    let mut canvas = Canvas::new(set.size.into(), set.boundary, set.radii.greatest(), options);
    canvas.blocks(set.blocks.iter().copied());
    let points: Vec<DVec2> = set.points.iter().copied().map(DVec2::from).collect();

    // Parts of circles, as of planar sets, would be too short here: a gap is cut by the plane at any of its heights.
    if set.plane.is_some_and(|plane| plane.gaps) {
        let covered = Style::filled(options.palette.background);
        let mut gaps = canvas.group("gaps");
        gaps.shapes.extend(canvas.domain(options.palette.gap));
        // Every disk is painted over the colour, which stays at the places in no disk.
        for (index, &point) in points.iter().enumerate() {
            step()?;
            canvas.radius = set.radii.of(index);
            gaps.shapes.extend(canvas.disk(point, covered));
        }
        canvas.push([gaps]);
    }

    // Disks lie below all samples: a disk would hide the dots that were painted before it.
    if canvas.draws_disks() {
        let fill = Fill::Solid(options.palette.disk_fill);
        let mut disks = canvas.group("disks");
        for (index, &point) in points.iter().enumerate() {
            step()?;
            // The canvas draws each image of a sample whose disk, of this radius, reaches into the picture.
            canvas.radius = set.radii.of(index);
            disks.shapes.extend(canvas.disk(point, canvas.ringed(fill)));
        }
        canvas.push([disks]);
    }

    let mut samples = canvas.group("samples");
    let mut inserted = canvas.group("inserted");
    for (index, &point) in points.iter().enumerate() {
        step()?;
        // A mark is as large as the canvas's radius makes it; at a radius of 0, which stands for an unknown one,
        // it has a usual size.
        canvas.radius = set.radii.of(index);
        if let Some(plane) = set.plane {
            canvas.beside_plane(&mut samples, point, plane.above[index]);
            continue;
        }
        let block = set.block_of.as_ref().map(|of| of[index]);
        match block {
            // A sample without a block was inserted. Where blocks are not known, all samples look alike.
            Some(None) => canvas.mark(&mut inserted, Marker::Diamond, point, canvas.inserted()),
            _ => canvas.mark(
                &mut samples,
                Marker::Dot,
                point,
                canvas.dot(block.flatten()),
            ),
        }
    }
    canvas.push([samples, inserted]);

    // The arcs come last, on top: they show where the disks leave a gap, and nothing may hide them. They are of circles
    // of equal radii, so that the radius that was set last is theirs.
    canvas.arcs(&points, &set.exposed);
    Ok(canvas.finish(&set.caption))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::palette::{Color, Palette, with_alpha};
    use crate::scene::{Group, Shape};

    /// The radii of the disks that are drawn.
    fn disks(radii: DiskRadii<'_>) -> Vec<f64> {
        let picture = SetPicture {
            points: &[[0.2, 0.5], [0.7, 0.5]],
            size: [1.0; 2],
            boundary: Boundary::Bounded,
            radii,
            blocks: Vec::new(),
            block_of: None,
            exposed: Vec::new(),
            plane: None,
            caption: String::new(),
        };
        let scene = set_scene(&picture, &PictureOptions::default());
        let disks = scene.groups.iter().filter(|group| group.name == "disks");
        let shapes = disks.flat_map(|group| &group.shapes);
        let radius = |shape: &Shape| {
            let Shape::Circle { radius, .. } = shape else {
                return None;
            };
            Some(*radius)
        };
        shapes.filter_map(radius).collect()
    }

    #[test]
    fn each_disk_has_its_radius_and_is_drawn_if_any_is_large_enough() {
        assert_eq!(disks(DiskRadii::Equal(0.1)), [0.1, 0.1]);
        assert_eq!(disks(DiskRadii::Own(&[0.001, 0.2])), [0.001, 0.2]);
        for radii in [
            DiskRadii::Unknown,
            DiskRadii::Equal(0.001),
            DiskRadii::Own(&[0.001, 0.002]),
        ] {
            assert!(disks(radii).is_empty(), "{radii:?}");
        }
    }

    #[test]
    fn a_plane_has_dots_by_side_and_gaps_below_its_disks() {
        let palette = Palette::LIGHT;
        let groups = |gaps: bool| {
            let picture = SetPicture {
                points: &[[0.2, 0.5], [0.7, 0.5]],
                size: [1.0; 2],
                boundary: Boundary::Bounded,
                radii: DiskRadii::Own(&[0.1, 0.2]),
                blocks: Vec::new(),
                block_of: None,
                exposed: Vec::new(),
                plane: Some(PlaneLook {
                    above: &[0.8, -0.4],
                    gaps,
                }),
                caption: String::new(),
            };
            set_scene(&picture, &PictureOptions::default()).groups
        };
        let named = |groups: &[Group], name: &str| -> Vec<Shape> {
            let with_name = groups.iter().filter(|group| group.name == name);
            with_name.flat_map(|group| group.shapes.clone()).collect()
        };
        let fills = |shapes: &[Shape]| -> Vec<Color> {
            let fill = |shape: &Shape| match shape {
                Shape::Rect { style, .. }
                | Shape::Circle { style, .. }
                | Shape::Marker { style, .. } => style.fill,
                _ => None,
            };
            let color = |fill| match fill {
                Fill::Solid(color) => Some(color),
                Fill::Hatch(_) => None,
            };
            shapes.iter().filter_map(fill).filter_map(color).collect()
        };

        let with_gaps = groups(true);
        let [above, below] = [0.8, -0.4].map(|height| palette.of_height(height));
        // 1 - 0.75 x 0.8 and 1 - 0.75 x 0.4 of the strength.
        let dots = [with_alpha(above, 102), with_alpha(below, 179)];
        assert_eq!(fills(&named(&with_gaps, "samples")), dots);
        let ground = [palette.gap, palette.background, palette.background];
        assert_eq!(fills(&named(&with_gaps, "gaps")), ground);
        // Gaps lie below all disks, which are as they are without gaps.
        assert_eq!(with_gaps[0].name, "gaps");
        let without = groups(false);
        assert!(named(&without, "gaps").is_empty());
        assert_eq!(named(&without, "disks"), named(&with_gaps, "disks"));
    }
}
