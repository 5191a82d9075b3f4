//! Pictures of a set, as PNG or SVG.

use pyo3::prelude::*;
use tilescope_analysis::Region;
use tilescope_core::Boundary;
use tilescope_figures::{
    DiskRadii, Palette, PictureOptions, Rect, SetPicture, set_scene_controlled, to_png_controlled,
    to_svg_with_fonts_controlled,
};

use crate::arguments::SetArgument;
use crate::failure::Failure;
use crate::memory::ask_to_draw;
use crate::task::run;
use crate::values::{rectangle, whole};

/// Widths of pictures in pixels that are accepted, those of `tilescope draw`: in smaller ones disks would be no more
/// than specks, and the exporters refuse wider ones.
const SIZES: std::ops::RangeInclusive<u64> = 16..=32_768;

/// The height of margins and caption, in widths of the picture: about, as the pixels are counted only to ask for
/// memory.
const FRAME: f64 = 0.1;

/// Returns the bytes of a picture of a set, or of the part of it in `window`.
#[pyfunction]
#[pyo3(signature = (set, *, caption, svg, size, window, disks, theme, progress))]
#[expect(
    clippy::too_many_arguments,
    reason = "each is one of Python's, by its name"
)]
pub fn draw(
    py: Python<'_>,
    set: SetArgument<'_>,
    caption: String,
    svg: bool,
    size: &Bound<'_, PyAny>,
    window: Option<&Bound<'_, PyAny>>,
    disks: bool,
    theme: &str,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<u8>> {
    let size = width(size)?;
    let (points, region) = (set.points()?, set.region()?);
    let window = window_within(window, &region)?;

    // A large set has few samples in a window, and the others need not be laid out. A disk reaches into the window from
    // as far as the greatest radius; samples of an unknown radius are drawn as dots alone.
    let (varying, radius) = (set.varying(), set.known_radius());
    let greatest = varying.as_ref().map(|varying| varying.radius.greatest());
    let reach = greatest.or(radius).unwrap_or_default();
    let in_window = reaching_into(points, &region, reach, window);

    let points = in_window.as_deref().unwrap_or(points);
    // There are radii of single samples only if the radius varies: a set that covers a shape may have one radius.
    let own_radii = varying.map_or_else(Vec::new, |varying| varying.radii(points));
    let radii = match radius {
        _ if !own_radii.is_empty() => DiskRadii::Own(&own_radii),
        Some(radius) => DiskRadii::Equal(radius),
        None => DiskRadii::Unknown,
    };
    let picture = SetPicture {
        points,
        size: region.size(),
        boundary: Boundary::of(region.is_periodic()),
        radii,
        blocks: Vec::new(),
        block_of: None,
        exposed: Vec::new(),
        plane: None,
        caption,
    };

    let options = PictureOptions {
        width: size as f64,
        palette: palette(theme)?,
        window: window.map(|[x0, y0, x1, y1]| Rect::new([x0, y0], [x1, y1])),
        disks,
    };

    run(py, progress, |watch| {
        let shown = options
            .window
            .map_or(region.size(), |window| window.size().to_array());
        // Only a bitmap takes memory for each of its pixels.
        let pixels = options.width * options.width * (shown[1] / shown[0] + FRAME);
        ask_to_draw(picture.points.len(), if svg { 0.0 } else { pixels })?;
        let mut control = watch.steps("lay out");
        let scene = set_scene_controlled(&picture, &options, &mut control)?;

        let mut control = watch.steps("draw");
        Ok(if svg {
            to_svg_with_fonts_controlled(&scene, &mut control)?.into_bytes()
        } else {
            // The scene is laid out in pixels already.
            let scale = 1.0;
            to_png_controlled(&scene, scale, &mut control)?
        })
    })
}

/// Returns the width of a picture in pixels.
pub fn width(size: &Bound<'_, PyAny>) -> PyResult<u64> {
    let size = whole("size", size)?;
    if SIZES.contains(&size) {
        return Ok(size);
    }
    let (least, most) = (SIZES.start(), SIZES.end());
    let text = format!("size is {size}; it must be between {least} and {most} pixels");
    Err(Failure::Value(text).into())
}

/// Returns the colours of a theme.
fn palette(theme: &str) -> PyResult<Palette> {
    match theme {
        "light" => Ok(Palette::LIGHT),
        "dark" => Ok(Palette::DARK),
        _ => {
            let text = format!("theme is '{theme}'; it must be 'light' or 'dark'");
            Err(Failure::Value(text).into())
        }
    }
}

/// Returns the corners of a window, from the domain's lower corner on; `None` if no window is given. Refuses a window
/// that is empty, that does not reach into the domain, or whose corners are not finite.
pub fn window_within(
    window: Option<&Bound<'_, PyAny>>,
    region: &Region,
) -> PyResult<Option<[f64; 4]>> {
    let window = window
        .map(|corners| rectangle("window", corners))
        .transpose()?;
    if let Some([x0, y0, x1, y1]) = window {
        let inside = x1 > 0.0 && y1 > 0.0 && x0 < region.width && y0 < region.height;
        let finite = [x0, y0, x1, y1].iter().all(|v| v.is_finite());
        if !(finite && x0 < x1 && y0 < y1 && inside) {
            return Err(Failure::Value(format!(
                "window is ({x0}, {y0}, {x1}, {y1}); it must be (x0, y0, x1, y1) with x0 < x1 and y0 < y1, and \
                 reach into the domain, {} x {}",
                region.width, region.height
            ))
            .into());
        }
    }
    Ok(window)
}

/// Returns the samples whose disks, or copies of them, reach into a window: of a large set, few. `None` without a
/// window, when all are drawn.
fn reaching_into(
    points: &[[f64; 2]],
    region: &Region,
    radius: f64,
    window: Option<[f64; 4]>,
) -> Option<Vec<[f64; 2]>> {
    let [x0, y0, x1, y1] = window?;
    let along = |value: f64, low: f64, high: f64, side: f64| {
        // In a periodic domain a sample is drawn on the opposite side as well; in others a few more samples do no harm.
        let copies = [0.0, -side, side].map(|shift| value + shift);
        copies
            .iter()
            .any(|value| (low - radius..=high + radius).contains(value))
    };
    // The square around a disk reaches farther than the disk, so this keeps a few disks too many. The picture cuts them
    // off.
    let reaches =
        |&&[x, y]: &&[f64; 2]| along(x, x0, x1, region.width) && along(y, y0, y1, region.height);
    Some(points.iter().filter(reaches).copied().collect())
}
