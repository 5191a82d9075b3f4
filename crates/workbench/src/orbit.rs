//! A set in space as balls: the view, and its picture, which is made in the background. While the view moves the picture is
//! coarse, so that it follows; once the view rests it is made in full. Begin with [`RunOrbit::want`];
//! `tilescope_drawing::orbit` draws.

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use tilescope_drawing::orbit::{
    BallColors, MAX_PICTURE_SIDE, OrbitPicture, OrbitSet, OrbitView, described,
};
use tilescope_drawing::palette::Palette;
use tilescope_session::jobs::{Job, Monitor, Wake};
use tilescope_session::look::Look;
use tilescope_session::session::Session;
use tilescope_session::solid::MadeSolid;
use tilescope_session::task::{self, SessionRef, Task};
use tilescope_session::words::sentence;

/// How much smaller a coarse picture is along each side: with one ray for a pixel instead of four it has a sixteenth of the rays.
const COARSER: u32 = 2;

/// A change of how a set in space is seen as balls.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OrbitCommand {
    /// Shows the balls instead of a plane through the set, or the plane again.
    Show(bool),
    /// Turns the view by degrees, to the side and upwards.
    Turn([f64; 2]),
    /// Multiplies the magnification.
    Zoom(f64),
    /// Cuts the corner nearest to the eye out, or shows the whole set.
    Cut(bool),
    /// Returns to the view at first.
    Reset,
    /// Sets the width and the height of the picture, in pixels of the screen.
    Size([u32; 2]),
}

/// A picture of a set in space, opaque.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct OrbitImage {
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// Red, green, blue and opacity of each pixel, row by row.
    pub rgba: Vec<u8>,
}

/// All that a picture depends on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct OrbitKey {
    /// The generation of the session.
    generation: u64,
    view: OrbitView,
    /// Width and height in pixels of the screen.
    size: [u32; 2],
    is_dark: bool,
    is_coarse: bool,
}

/// Returns the set of a session as it is drawn; `points` are the samples of its run in user units, and `levels` those at which
/// they arrived.
#[must_use]
pub(crate) fn drawn_set<'a>(
    session: &Session,
    solid: &MadeSolid,
    points: &'a [[f64; 3]],
    levels: &'a [u8],
) -> OrbitSet<'a> {
    OrbitSet {
        points,
        size: solid.domain.size(),
        radius: session.run().domain.radius(),
        colors: BallColors::Levels(levels),
    }
}

/// Returns the colours of a look for a picture.
#[must_use]
pub(crate) const fn palette(is_dark: bool) -> &'static Palette {
    Palette::of(if is_dark { Look::Dark } else { Look::Light })
}

/// The task of drawing a set in space.
#[derive(Serialize, Deserialize)]
pub struct OrbitTask {
    session: SessionRef,
    key: OrbitKey,
}

impl Task for OrbitTask {
    /// The picture, or why there is none.
    type Outcome = Result<OrbitImage, String>;
    const NAME: &'static str = "orbit";

    fn run(self, monitor: &Monitor) -> Self::Outcome {
        let session = &*self.session;
        let Some(solid) = &session.solid else {
            return Err("this set is planar".to_owned());
        };
        let OrbitKey {
            view,
            size,
            is_dark,
            is_coarse,
            ..
        } = self.key;

        let points = solid.positions(session.run());
        let levels: Vec<u8> = solid.levels.of_samples().collect();
        let set = drawn_set(session, solid, &points, &levels);
        // The window enlarges a coarse picture to the room that the full one has.
        let drawn_size = if is_coarse {
            size.map(|side| side.div_ceil(COARSER))
        } else {
            size
        };
        let picture = OrbitPicture {
            is_coarse,
            ..OrbitPicture::new(set, view, drawn_size, palette(is_dark))
        };
        let drawn = picture.draw(&|| monitor.go_on());
        let pixels = drawn.map_err(|error| error.to_string())?;
        Ok(OrbitImage {
            size: drawn_size.map(|side| side as usize),
            rgba: pixels.rgba,
        })
    }
}

/// A set in space as balls, as far as it is shown so.
#[derive(Default)]
pub struct RunOrbit {
    is_shown: bool,
    view: OrbitView,
    /// Width and height of the picture in pixels of the screen; 0 until the window says how large it is.
    size: [u32; 2],
    /// The picture that was made last, or why there is none.
    drawn: Option<(OrbitKey, Result<Arc<OrbitImage>, String>)>,
    job: Option<(OrbitKey, Job<Result<OrbitImage, String>>)>,
}

impl RunOrbit {
    /// Returns whether balls are shown instead of a plane.
    #[must_use]
    pub const fn is_shown(&self) -> bool {
        self.is_shown
    }

    /// Returns from where they are seen.
    #[must_use]
    pub const fn view(&self) -> OrbitView {
        self.view
    }

    /// Returns the width and the height of the picture that is wanted, in pixels of the screen.
    #[must_use]
    pub const fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Returns the picture that was made last, perhaps of a view before this one.
    #[must_use]
    pub fn image(&self) -> Option<&Arc<OrbitImage>> {
        let (_, drawn) = self.drawn.as_ref()?;
        drawn.as_ref().ok()
    }

    /// Returns why there is no picture.
    #[must_use]
    pub fn failure(&self) -> Option<&str> {
        let (_, drawn) = self.drawn.as_ref()?;
        drawn.as_ref().err().map(String::as_str)
    }

    /// Returns what the picture of a session shows, in a sentence; `None` for a planar set.
    #[must_use]
    pub fn sentence(&self, session: &Session) -> Option<String> {
        let solid = session.solid.as_ref()?;
        let count = session.run().samples.points.len();
        let words = described(count, solid.domain.size(), self.view);
        Some(format!("{words}."))
    }

    /// Applies a command.
    pub(crate) fn apply(&mut self, command: OrbitCommand) {
        let view = self.view;
        match command {
            OrbitCommand::Show(is_shown) => self.is_shown = is_shown,
            OrbitCommand::Turn(by) => self.view = view.turned(by),
            OrbitCommand::Zoom(factor) => {
                let zoom = view.zoom * factor;
                self.view = OrbitView { zoom, ..view }.within_limits();
            }
            OrbitCommand::Cut(is_cut) => self.view = OrbitView { is_cut, ..view },
            OrbitCommand::Reset => self.view = OrbitView::default(),
            // A picture has at least one pixel along each side. If the screen has more pixels than the largest
            // picture, the window enlarges that picture.
            OrbitCommand::Size(size) => {
                self.size = size.map(|side| side.clamp(1, MAX_PICTURE_SIDE));
            }
        }
    }

    /// Shows balls from a view, or a plane.
    pub(crate) fn take(&mut self, view: Option<OrbitView>) {
        self.is_shown = view.is_some();
        self.view = view.unwrap_or(self.view).within_limits();
    }

    /// Takes a finished picture, and starts the one that is wanted next, if any is.
    pub(crate) fn want(&mut self, session: &Arc<Session>, is_dark: bool, wake: &Wake) {
        if let Some((key, job)) = &self.job
            && let Some(outcome) = job.poll()
        {
            let key = *key;
            self.keep(key, outcome);
        }

        if !self.is_shown || session.solid.is_none() || self.size.contains(&0) {
            (self.drawn, self.job) = (None, None);
            return;
        }
        let full = OrbitKey {
            generation: session.generation,
            view: self.view,
            size: self.size,
            is_dark,
            is_coarse: false,
        };
        let coarse = OrbitKey {
            is_coarse: true,
            ..full
        };

        let drawn = self.drawn.as_ref().map(|(key, _)| *key);
        if drawn == Some(full) {
            return;
        }
        // A coarse picture is finished even if the view has moved on: otherwise a drag would show none before its end. A
        // full one of another view gives way.
        if (self.job.as_ref()).is_some_and(|(key, _)| key.is_coarse || *key == full) {
            return;
        }
        let key = if drawn == Some(coarse) { full } else { coarse };
        let session = SessionRef(Arc::clone(session));
        self.job = Some((key, task::start(wake, OrbitTask { session, key })));
    }

    /// Keeps the outcome of a job.
    fn keep(&mut self, key: OrbitKey, outcome: Result<Result<OrbitImage, String>, String>) {
        let drawn = outcome.and_then(|drawn| drawn);
        let kept = drawn.map(Arc::new).map_err(|why| sentence(&why));
        self.drawn = Some((key, kept));
        self.job = None;
    }

    /// Waits for the picture that is being made.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn settle(&mut self) {
        if let Some((key, job)) = self.job.take() {
            let outcome = job.wait();
            self.keep(key, outcome);
        }
    }
}
