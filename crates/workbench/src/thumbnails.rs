//! Small pictures of the scenes, drawn in the background one after another while their panel is open.

use std::sync::Arc;

use glam::DVec2;
use serde::{Deserialize, Serialize};
use tilescope_debugger::{Debugger, SavedScene};
use tilescope_drawing::camera::Camera;
use tilescope_drawing::orbit::{OrbitPicture, OrbitView};
use tilescope_drawing::picture::{MomentView, Thumbnail, thumbnail};
use tilescope_figures::to_pixels;
use tilescope_session::jobs::{Job, Monitor, Wake};
use tilescope_session::session::Session;
use tilescope_session::task::{self, SessionRef, Task};

use crate::orbit::{drawn_set, palette};
use crate::scene_view::{orbit_of_scene, place_of_scene, view_of_scene};
use crate::view::SceneCamera;

/// Width and height of a picture, in points of the window.
pub const THUMBNAIL_SIZE: [f64; 2] = [84.0, 56.0];
/// How much larger the picture is laid out than it is shown, so that lines and texts are small. Chosen, not measured.
const LAID_OUT: f64 = 3.0;
/// The height of a picture that shows the surroundings of an event, in r. Chosen, not measured.
const NEAR: f64 = 14.0;
/// The pixels in a point of the picture shown, so that it is sharp on dense screens.
const SHARPNESS: f64 = 2.0;

/// Everything that a picture depends on.
struct ThumbnailKey {
    /// The generation of the session that has the scene.
    generation: u64,
    dark: bool,
    /// The scene without its caption.
    scene: SavedScene,
}

impl ThumbnailKey {
    /// Returns whether the picture is that of a scene; its caption is not drawn, and so is not compared.
    fn is_of(&self, session: &Session, scene: &SavedScene, dark: bool) -> bool {
        let other = &self.scene;
        (self.generation, self.dark) == (session.generation, dark)
            && (other.event, other.ends) == (scene.event, scene.ends)
            && (&other.run, &other.anchor, &other.view) == (&scene.run, &scene.anchor, &scene.view)
    }
}

enum Drawn {
    Pending(Job<Option<Thumbnail>>),
    Done(Option<Arc<Thumbnail>>),
}

/// The pictures that were drawn or are being drawn.
#[derive(Default)]
pub struct Thumbnails(Vec<(ThumbnailKey, Drawn)>);

impl Thumbnails {
    /// Returns the picture of a scene, once it is drawn.
    #[must_use]
    pub fn of(&self, session: &Session, scene: &SavedScene, dark: bool) -> Option<&Arc<Thumbnail>> {
        let mut drawn = self.0.iter();
        match drawn.find(|(key, _)| key.is_of(session, scene, dark))? {
            (_, Drawn::Done(thumbnail)) => thumbnail.as_ref(),
            (_, Drawn::Pending(_)) => None,
        }
    }

    /// Waits for the picture that is being drawn; returns whether there was one.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn wait(&mut self) -> bool {
        for (_, drawn) in &mut self.0 {
            if let Drawn::Pending(job) = drawn {
                // A picture that could not be drawn is done, too.
                *drawn = Drawn::Done(job.wait().unwrap_or_default().map(Arc::new));
                return true;
            }
        }
        false
    }

    /// Takes the picture that was being drawn, drops those that are of no scene any more, as after a change of the
    /// session or of the look, and starts the next one.
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
                // A picture that could not be drawn is done, too, so that it is not tried again in each frame.
                *drawn = Drawn::Done(outcome.unwrap_or_default().map(Arc::new));
            }
        }

        let scenes = &debugger.scenes;
        let is_there =
            |key: &ThumbnailKey| scenes.iter().any(|scene| key.is_of(session, scene, dark));
        self.0.retain(|(key, _)| is_there(key));

        for scene in scenes {
            let is_pending =
                |(_, drawn): &(ThumbnailKey, Drawn)| matches!(drawn, Drawn::Pending(_));
            // One picture is drawn at a time: a later frame starts the next one.
            if self.0.iter().any(is_pending) {
                return;
            }

            let mut known = self.0.iter();
            if known.any(|(key, _)| key.is_of(session, scene, dark)) {
                continue;
            }

            let key = ThumbnailKey {
                generation: session.generation,
                dark,
                scene: SavedScene {
                    caption: String::new(),
                    ..scene.clone()
                },
            };

            let size = THUMBNAIL_SIZE.map(|side| LAID_OUT * side);
            // `None` if this run does not have the scene's moment, so that there is nothing to draw.
            let mut shown = view_of_scene(session, debugger, scene, size, dark);
            if let (Some(shown), Some(place)) = (&mut shown, place_to_show(debugger, scene)) {
                shown.view.camera = Camera {
                    center: place,
                    scale: size[0].min(size[1]) / NEAR,
                };
            }

            let drawn = shown.map_or(Drawn::Done(None), |shown| {
                let balls = orbit_of_scene(session, scene);
                let session = SessionRef(Arc::clone(session));
                let task = ThumbnailTask {
                    session,
                    shown,
                    balls,
                };
                Drawn::Pending(task::start(wake, task))
            });
            self.0.push((key, drawn));
        }
    }
}

/// Returns the place of a scene's event if the scene shows the whole domain: at this size all of its moments look alike, so the
/// picture shows the surroundings of the event. `None` if the scene has a camera of its own, or is of the end of a stage, which
/// concerns the whole domain.
fn place_to_show(debugger: &Debugger, scene: &SavedScene) -> Option<DVec2> {
    let is_whole = SceneCamera::of(&scene.view).is_none() && scene.ends.is_none();
    place_of_scene(debugger, scene).filter(|_| is_whole)
}

/// The task of drawing a small picture.
#[derive(Serialize, Deserialize)]
pub struct ThumbnailTask {
    session: SessionRef,
    shown: MomentView,
    /// From where the balls of a set in space are seen, if the scene shows them instead of a plane.
    balls: Option<OrbitView>,
}

impl Task for ThumbnailTask {
    type Outcome = Option<Thumbnail>;
    const NAME: &'static str = "thumbnail";

    fn run(self, monitor: &Monitor) -> Self::Outcome {
        if let Some(view) = self.balls {
            return self.of_balls(view, monitor);
        }

        let scene = thumbnail(&self.session, &self.shown);
        let pixels = to_pixels(&scene, SHARPNESS / LAID_OUT).ok()?;
        Some(pixels.into())
    }
}

impl ThumbnailTask {
    /// Draws the balls of the whole set, as the canvas does at any moment of the run.
    fn of_balls(&self, view: OrbitView, monitor: &Monitor) -> Option<Thumbnail> {
        let session = &*self.session;
        let solid = session.solid.as_ref()?;
        let points = solid.positions(session.run());
        let levels: Vec<u8> = solid.levels.of_samples().collect();
        let set = drawn_set(session, solid, &points, &levels);
        let size = THUMBNAIL_SIZE.map(|side| (SHARPNESS * side).round() as u32);
        let picture = OrbitPicture::new(set, view, size, palette(self.shown.view.dark));
        let pixels = picture.draw(&|| monitor.go_on()).ok()?;
        Some(Thumbnail {
            size: size.map(|side| side as usize),
            rgba: pixels.rgba,
        })
    }
}
