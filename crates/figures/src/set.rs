//! Pictures of sets without their runs, with the colours and marks of the window.

use std::convert::Infallible;

use glam::DVec2;
use tilescope_core::Boundary;

use crate::canvas::{Canvas, PictureOptions};
use crate::control::{Control, Steps};
use crate::error::FigureError;
use crate::scene::{Fill, Marker, Rect, Scene};

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
    /// A line above the picture.
    pub caption: String,
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

    // Disks lie below all samples: a disk would hide the dots that were painted before it.
    if canvas.draws_disks() {
        let fill = Fill::Solid(options.palette.disk_fill);
        let mut disks = canvas.group("disks");
        for (index, &point) in points.iter().enumerate() {
            step()?;
            // The canvas draws each image of a sample whose disk, of this radius, reaches into the picture.
            canvas.radius = set.radii.of(index);
            disks.shapes.extend(canvas.disk(point, fill));
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
    use crate::scene::Shape;

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
}
