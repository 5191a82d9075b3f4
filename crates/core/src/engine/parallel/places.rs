//! Windows that are asked for one after another, as where a viewer moves over the plane: their samples with their
//! places in the plane, and what a window gains when it moves.

use glam::I64Vec2;

use crate::error::SampleError;
use crate::lattice::{Domain, Point, Window};

use super::window_maker::{WindowMaker, WindowSamples, pieces_of_window};

/// Buffers for the samples of windows, which are used again from window to window.
#[derive(Default)]
pub struct PlaceBuffers {
    /// The samples of the piece of a window that was computed last.
    samples: WindowSamples,
    places: Vec<I64Vec2>,
}

impl PlaceBuffers {
    /// Returns the samples in `windows`, which do not overlap. Empty ones have none.
    pub(super) fn fill<M: WindowMaker>(
        &mut self,
        maker: &M,
        windows: &[Window],
    ) -> Result<&[I64Vec2], SampleError> {
        self.places.clear();
        // Tags say where a sample came from, and places alone are asked for.
        let with_tags = false;

        for window in windows {
            for piece in pieces_of_window(maker, window) {
                maker.fill(&piece, with_tags, &mut self.samples)?;
                let found = self.samples.points.iter();
                let places = found.map(|point| place(maker.domain(), window, *point));
                self.places.extend(places);
            }
        }
        Ok(&self.places)
    }
}

/// Returns the place of a sample's image in `window`.
fn place(domain: &Domain, window: &Window, point: Point) -> I64Vec2 {
    let point = I64Vec2::from(point);
    if !domain.is_periodic() {
        return point;
    }
    // A window is at most as long as the domain, so that it has one image.
    let sides = I64Vec2::new(domain.width().into(), domain.height().into());
    window.min + (point - window.min).rem_euclid(sides)
}

/// Returns the part of `to` outside of `from`, as rectangles that do not overlap. Some may be empty.
pub(super) fn beyond(from: &Window, to: &Window) -> [Window; 4] {
    let shared = Window {
        min: from.min.max(to.min),
        max: from.max.min(to.max),
    };
    if shared.min.cmplt(shared.max).all() {
        return to.without(&shared);
    }

    // Without a shared place all of `to` is outside.
    let nothing = Window {
        min: to.min,
        max: to.min,
    };
    [*to, nothing, nothing, nothing]
}
