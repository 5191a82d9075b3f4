//! A set in space as balls of half the radius, cut open at a corner: a picture, or an animation in which it turns once.

use std::ops::ControlFlow;
use std::path::Path;

use anyhow::{Result, ensure};
use tilescope_analysis::{SolidRegion, lossy};
use tilescope_drawing::orbit::{
    BallColors, MAX_ELEVATION, MAX_PICTURE_SIDE, OrbitError, OrbitPicture, OrbitSet, OrbitView,
    TURN_FRAMES, ZOOMS, described, scene as orbit_scene,
};
use tilescope_drawing::palette::Palette;
use tilescope_figures::{AnimationError, FigureError, Scene, to_pixels, write_apng, write_gif};
use tilescope_formats::{FormatError, write_through};
use tilescope_session::words::counted;
use tilescope_sets::SolidMade;

use crate::interrupt;
use crate::options::SetArguments;
use crate::paths::{InFile, named};
use crate::progress::bar;

use super::{box_text, hinted, is_in_space, overrides};

/// Hundredths of a second for a frame of a turn, which takes 5.8 seconds: slow enough to follow a ball. Chosen by eye.
const FRAME_DELAY: u16 = 8;

/// Whether a line below the picture says what the colours mean.
const HAS_LEGEND: bool = true;

/// Reads a view: `30,20` are the degrees around and above. A magnification may follow, as in `30,20,1.5`, and behind it
/// `whole` for a box that is not cut open. Fails for other texts, and for an elevation or a magnification beyond its
/// limits.
pub fn parse(text: &str) -> Result<OrbitView, String> {
    let wrong = || {
        format!(
            "{text:?} is no direction; one is written as 300,30: degrees around from the x axis, and degrees above. \
             Without one, --orbit comes behind the files"
        )
    };
    let view = OrbitView::read(text).ok_or_else(wrong)?;

    // `OrbitView::read` is also for links and files, and puts numbers beyond the limits within them. Here such a number
    // is refused, as its picture would not be the one that was typed.
    let typed = |part: usize| {
        let part = text.split(',').nth(part)?;
        part.trim().parse::<f64>().ok()
    };
    if let Some(elevation) = typed(1).filter(|elevation| elevation.abs() > MAX_ELEVATION) {
        return Err(format!(
            "the elevation is {elevation} degrees; it must be -{MAX_ELEVATION} to {MAX_ELEVATION}"
        ));
    }
    if let Some(zoom) = typed(2).filter(|zoom| !ZOOMS.contains(zoom)) {
        let (least, most) = (*ZOOMS.start(), *ZOOMS.end());
        return Err(format!(
            "the magnification is {zoom}; it must be {least} to {most}"
        ));
    }
    Ok(view)
}

/// A set in space, as it is drawn.
pub struct Balls {
    pub points: Vec<[f64; 3]>,
    region: SolidRegion,
    radius: f64,
    /// The level at which each arrived; nothing if the file does not say it.
    levels: Vec<u8>,
    /// Whether the order of the file is that of arrival.
    is_in_order: bool,
    /// The name of the file.
    name: String,
    /// The line above the picture.
    caption: String,
}

/// Reads a set in space.
pub fn read(file: &Path, set: &SetArguments) -> Result<Balls> {
    ensure!(
        is_in_space(set, file),
        "{}: --orbit draws a set in space, and this one has no third side: neither its certificate nor --depth states one",
        named(file)
    );
    // The set is not verified: the picture shows it as it is, valid or not.
    let given = overrides(set, file)?;
    let read = tilescope_formats::read_solid(file, &given, set.depth)
        .map_err(hinted)
        .in_file(file)?;
    ensure!(!read.points.is_empty(), "{}: the set is empty", named(file));

    // Of all files only those that the program made, and did not shuffle, are known to be in the order of arrival.
    let is_in_order = read.certificate.is_some_and(|certificate| {
        certificate.method == SolidMade::METHOD && certificate.shuffle_seed.is_none()
    });
    let name = lossy(file.file_name().unwrap_or_default());
    let count = counted(read.points.len(), "ball", "balls");
    let sides = box_text(&read.region);
    let caption = format!("{name}: {count} of r/2 in a box of {sides}");
    Ok(Balls {
        points: read.points,
        region: read.region,
        radius: read.radius,
        levels: read.columns.level,
        is_in_order,
        name: name.to_string(),
        caption,
    })
}

impl Balls {
    /// Returns what their colours can show: levels if the file has them, or else their order, if that is known.
    fn colors(&self) -> BallColors<'_> {
        match (self.levels.is_empty(), self.is_in_order) {
            (false, _) => BallColors::Levels(&self.levels),
            (true, true) => BallColors::Arrival,
            (true, false) => BallColors::One,
        }
    }
}

/// Balls to be drawn.
pub struct Drawn<'a> {
    pub balls: &'a Balls,
    pub view: OrbitView,
    /// Width and height in pixels.
    pub width: u32,
    pub palette: &'a Palette,
}

impl<'a> Drawn<'a> {
    fn picture(&self) -> Result<OrbitPicture<'a>> {
        ensure!(
            self.width <= MAX_PICTURE_SIDE,
            "--size is {}; a picture of balls has at most {MAX_PICTURE_SIDE} pixels",
            self.width
        );
        let set = OrbitSet {
            points: &self.balls.points,
            size: self.balls.region.size(),
            radius: self.balls.radius,
            colors: self.balls.colors(),
        };
        // The box fits into a square from whichever side it is seen, so that a turn needs no other shape.
        let size = [self.width; 2];
        Ok(OrbitPicture::new(set, self.view, size, self.palette))
    }

    /// Returns the picture.
    pub fn scene(&self) -> Result<Scene> {
        let picture = self.picture()?;
        let drawn = orbit_scene(&picture, &self.balls.caption, HAS_LEGEND, &interrupt::flow);
        if drawn == Err(OrbitError::Cancelled) {
            interrupt::check("the picture")?;
        }
        let mut scene = drawn?;
        // The title is a sentence of its own: it would otherwise say again what the caption says.
        let words = described(picture.set.points.len(), picture.set.size, self.view);
        scene.title = format!("{}: {words}", self.balls.name);
        Ok(scene)
    }

    /// Writes an animation of a turn, and returns how many frames it has.
    pub fn write_turn(&self, path: &Path, is_gif: bool) -> Result<usize> {
        let still = self.picture()?;
        let metadata = [(
            "View".to_owned(),
            described(still.set.points.len(), still.set.size, still.view),
        )];
        // Every frame has the `open` corner of the first one. So the same corner of the set is cut out throughout, and
        // turns with the set.
        let frames = self.view.turn().map(|view| {
            let frame = OrbitPicture { view, ..still };
            let scene = orbit_scene(&frame, &self.balls.caption, HAS_LEGEND, &interrupt::flow);
            let cancelled_or_wrong = |error| match error {
                OrbitError::Cancelled => FigureError::Cancelled,
                other => FigureError::Chart(other.to_string()),
            };
            // The scene is laid out in pixels already.
            let scale = 1.0;
            to_pixels(&scene.map_err(cancelled_or_wrong)?, scale)
        });

        let shown = bar("draw", TURN_FRAMES as u64);
        let mut progress = |done: usize, _all: usize| -> ControlFlow<()> {
            shown.set_position(done as u64);
            interrupt::flow()
        };
        let written = write_through(path, |file| {
            let written = if is_gif {
                write_gif(frames, FRAME_DELAY, &metadata, file, &mut progress)
            } else {
                write_apng(frames, FRAME_DELAY, &metadata, file, &mut progress)
            };
            written.map_err(TurnError::from)
        });
        // An error after a request to end is its consequence.
        interrupt::check("the animation")?;
        written?;
        Ok(TURN_FRAMES)
    }
}

/// Why there is no animation.
#[derive(Debug, thiserror::Error)]
enum TurnError {
    #[error(transparent)]
    File(#[from] FormatError),
    #[error(transparent)]
    Animation(#[from] AnimationError),
}
