//! Small pictures of the scenes, drawn in the background one after another while their panel is open.

use std::sync::Arc;

use glam::DVec2;
use serde::{Deserialize, Serialize};
use tilescope_core::Stage;
use tilescope_debugger::{Debugger, SavedScene};
use tilescope_drawing::camera::Camera;
use tilescope_figures::to_pixels;
use tilescope_session::jobs::{Job, Monitor, Wake};
use tilescope_session::moment::Moment;
use tilescope_session::selection::Selection;
use tilescope_session::session::Session;
use tilescope_session::task::{self, SessionRef, Task};
use tilescope_session::units;

use crate::export::picture::{PictureView, thumbnail};
use crate::scenes::SceneView;
use crate::view;

/// Width and height of a picture, in points of the window.
pub const THUMBNAIL_SIZE: [f64; 2] = [84.0, 56.0];
/// How much larger the picture is laid out than it is shown, so that lines and texts are small.
const LAID_OUT: f64 = 3.0;
/// The pixels in a point of the picture shown, so that it is sharp on dense screens.
const SHARPNESS: f64 = 2.0;

/// A small picture.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Thumbnail {
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// Red, green, blue and opacity of each pixel, row by row.
    pub rgba: Vec<u8>,
}

/// What a picture is drawn from: the session's generation, the cursor, and the view.
type Key = (u64, usize, PictureView);

enum Drawn {
    Pending(Job<Option<Thumbnail>>),
    Done(Option<Arc<Thumbnail>>),
}

/// The pictures that were drawn or are being drawn.
#[derive(Default)]
pub struct Thumbnails(Vec<(Key, Drawn)>);

impl Thumbnails {
    /// Returns the picture of a scene, once it is drawn.
    #[must_use]
    pub fn of(
        &self,
        session: &Session,
        debugger: &Debugger,
        scene: &SavedScene,
        dark: bool,
    ) -> Option<&Arc<Thumbnail>> {
        let key = key(session, debugger, scene, dark)?;
        let (_, drawn) = self.0.iter().find(|(other, _)| *other == key)?;
        match drawn {
            Drawn::Done(thumbnail) => thumbnail.as_ref(),
            Drawn::Pending(_) => None,
        }
    }

    /// Waits for the picture that is being drawn; returns whether there was one.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn wait(&mut self) -> bool {
        for (_, drawn) in &mut self.0 {
            if let Drawn::Pending(job) = drawn {
                *drawn = Drawn::Done(job.wait().unwrap_or_default().map(Arc::new));
                return true;
            }
        }
        false
    }

    /// Takes the picture that was being drawn, drops those of scenes that are gone, and starts the next one.
    pub(crate) fn follow(
        &mut self,
        session: &Arc<Session>,
        debugger: &Debugger,
        dark: bool,
        wake: &Wake,
    ) {
        for (_, drawn) in &mut self.0 {
            if let Drawn::Pending(job) = drawn
                && let Some(outcome) = job.poll()
            {
                *drawn = Drawn::Done(outcome.unwrap_or_default().map(Arc::new));
            }
        }
        let scenes = debugger.scenes.iter();
        let keys: Vec<Key> = scenes
            .filter_map(|scene| key(session, debugger, scene, dark))
            .collect();
        self.0.retain(|(key, _)| keys.contains(key));
        if self
            .0
            .iter()
            .any(|(_, drawn)| matches!(drawn, Drawn::Pending(_)))
        {
            return;
        }
        let is_missing = |key: &&Key| self.0.iter().all(|(other, _)| other != *key);
        if let Some(&(generation, cursor, view)) = keys.iter().find(is_missing) {
            let task = ThumbnailTask {
                moment: Moment::at(session, cursor),
                session: SessionRef(Arc::clone(session)),
                view,
            };
            let job = task::start(wake, task);
            self.0
                .push(((generation, cursor, view), Drawn::Pending(job)));
        }
    }
}

/// Returns what the picture of a scene is drawn from; `None` if this run does not have its moment.
fn key(session: &Session, debugger: &Debugger, scene: &SavedScene, dark: bool) -> Option<Key> {
    let cursor = debugger.marked(scene).cursor()?;
    let saved = SceneView::deserialize(&scene.view).unwrap_or_default();
    let is_pattern = session.stages.get(session.stage_at(cursor)) == Some(&Stage::Pattern);
    let size = if is_pattern {
        units::size(session.run().pattern.domain())
    } else {
        session.size_radii()
    };
    let laid_out = THUMBNAIL_SIZE.map(|side| LAID_OUT * side);
    let [width, height] = laid_out;
    let fit = || Camera {
        center: 0.5 * size,
        scale: 0.94 * (DVec2::new(width, height) / size).min_element(),
    };
    let camera = saved.camera.and_then(|camera| {
        let scale = height / camera.radii;
        view::sound_camera(camera.center?, scale)
    });
    let layers = saved.layers.and_then(view::layers);
    Some((
        session.generation,
        cursor,
        PictureView {
            camera: camera.unwrap_or_else(fit),
            size: laid_out,
            chosen_layers: layers.flatten(),
            colouring: saved.colouring.unwrap_or_default(),
            selection: Selection::Nothing,
            dark,
            print: false,
        },
    ))
}

/// The task of drawing a small picture.
#[derive(Serialize, Deserialize)]
pub struct ThumbnailTask {
    session: SessionRef,
    moment: Moment,
    view: PictureView,
}

impl Task for ThumbnailTask {
    type Outcome = Option<Thumbnail>;
    const NAME: &'static str = "thumbnail";

    fn run(self, _: &Monitor) -> Self::Outcome {
        let scene = thumbnail(&self.session, &self.moment, &self.view);
        let pixels = to_pixels(&scene, SHARPNESS / LAID_OUT).ok()?;
        Some(Thumbnail {
            size: [pixels.width as usize, pixels.height as usize],
            rgba: pixels.rgba,
        })
    }
}
