//! The camera: which position of the domain is at the centre of the canvas, and how large one r appears. Domain
//! coordinates are in r with y upwards; the camera converts them to screen points.

use emath::{Pos2, Rect, Vec2, vec2};
use glam::DVec2;

/// The smallest scale of any domain, in screen points per r; the longest domain then spans 300 points.
pub const MIN_SCALE: f64 = 0.005;
/// The largest scale, in screen points per r: beyond it lattice units would become visible.
pub const MAX_SCALE: f64 = 4_000.0;
/// The smallest size of a domain relative to its size when fitted: below this, nothing can be recognised.
const MIN_SHARE_OF_FIT: f64 = 0.25;
/// The largest coordinate that a view may have, in r: no domain reaches so far from the origin.
pub const MAX_OFFSET: f64 = 200_000.0;
/// Seconds that a flight takes.
const FLIGHT_SECS: f32 = 0.7;
/// Empty space around a fitted domain, in screen points.
const FIT_MARGIN: f32 = 28.0;
/// The largest margin on each side, as a share of a small canvas.
const FIT_MARGIN_PART: f32 = 0.08;

/// Returns whether both coordinates of `place`, in r, are within [`MAX_OFFSET`] of the origin.
#[must_use]
pub fn is_near(place: DVec2) -> bool {
    place.abs().cmple(DVec2::splat(MAX_OFFSET)).all()
}

/// A view of the domain plane.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Camera {
    /// The position at the centre of the canvas, in r.
    pub center: DVec2,
    /// Screen points per r.
    pub scale: f64,
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            center: DVec2::ZERO,
            scale: 7.0,
        }
    }
}

impl Camera {
    /// Returns the camera at `center`, in r, with `scale` screen points per r; `None` if one is not valid.
    #[must_use]
    pub fn checked(center: DVec2, scale: f64) -> Option<Self> {
        let may_be = is_near(center) && (MIN_SCALE..=MAX_SCALE).contains(&scale);
        may_be.then_some(Self { center, scale })
    }

    /// Returns the camera that shows all of a domain of `size` r in `viewport`.
    #[must_use]
    pub fn fitting(size: impl Into<DVec2>, viewport: Rect) -> Self {
        let size = size.into();
        let margin = FIT_MARGIN.min(FIT_MARGIN_PART * viewport.size().min_elem());
        // A canvas of a few points is fitted as if it had 16: chosen, not measured.
        let room = (viewport.size() - Vec2::splat(2.0 * margin)).max(Vec2::splat(16.0));
        let scale = (f64::from(room.x) / size.x).min(f64::from(room.y) / size.y);
        Self {
            center: size / 2.0,
            scale: scale.clamp(MIN_SCALE, MAX_SCALE),
        }
    }

    /// Returns the smallest and the largest scale allowed for a domain of `size` r in `viewport`.
    #[must_use]
    pub fn scales(size: impl Into<DVec2>, viewport: Rect) -> [f64; 2] {
        let least = MIN_SHARE_OF_FIT * Self::fitting(size, viewport).scale;
        [least.max(MIN_SCALE), MAX_SCALE]
    }

    /// Returns this camera at the nearest scale between the smallest and the largest.
    #[must_use]
    pub const fn within(self, [least, most]: [f64; 2]) -> Self {
        Self {
            scale: self.scale.clamp(least, most),
            ..self
        }
    }

    /// Returns where the domain's `position` appears.
    #[must_use]
    pub fn screen_from_domain(&self, viewport: Rect, position: impl Into<DVec2>) -> Pos2 {
        let from_middle = (position.into() - self.center) * self.scale;
        viewport.center() + vec2(from_middle.x as f32, -from_middle.y as f32)
    }

    /// Returns the position of the domain that appears at `pos`.
    #[must_use]
    pub fn domain_from_screen(&self, viewport: Rect, pos: Pos2) -> DVec2 {
        let from_middle = pos - viewport.center();
        self.center + upwards(from_middle) / self.scale
    }

    /// Returns the lowest and highest coordinates that are visible, in r.
    #[must_use]
    pub fn visible(&self, viewport: Rect) -> (DVec2, DVec2) {
        let low = self.domain_from_screen(viewport, viewport.left_bottom());
        let high = self.domain_from_screen(viewport, viewport.right_top());
        (low, high)
    }

    /// Moves the picture by `delta` screen points.
    pub fn pan(&mut self, delta: Vec2) {
        self.center -= upwards(delta) / self.scale;
    }

    /// Zooms by `factor` between `scales`, keeping the position under `pos` where it is.
    pub fn zoom_about(&mut self, viewport: Rect, pos: Pos2, factor: f64, scales: [f64; 2]) {
        let before = self.domain_from_screen(viewport, pos);
        self.scale *= factor;
        *self = self.within(scales);
        self.center += before - self.domain_from_screen(viewport, pos);
    }
}

/// Returns a direction on the screen, where y points downwards, as one of the domain.
fn upwards(direction: Vec2) -> DVec2 {
    DVec2::new(f64::from(direction.x), -f64::from(direction.y))
}

/// A camera on its way from one view to another.
#[derive(Clone, Copy, Debug)]
pub struct Flight {
    from: Camera,
    to: Camera,
    elapsed_secs: f32,
}

impl Flight {
    /// Returns a flight that has just begun.
    #[must_use]
    pub const fn new(from: Camera, to: Camera) -> Self {
        Self {
            from,
            to,
            elapsed_secs: 0.0,
        }
    }

    /// Returns where the flight ends.
    #[must_use]
    pub const fn destination(&self) -> Camera {
        self.to
    }

    /// Advances by `dt_secs`; returns the camera and whether it has arrived.
    pub fn advance(&mut self, dt_secs: f32) -> (Camera, bool) {
        self.elapsed_secs += dt_secs;
        let t = (self.elapsed_secs / FLIGHT_SECS).clamp(0.0, 1.0);
        if t >= 1.0 {
            return (self.to, true);
        }
        // The flight begins and ends slowly: the polynomial is flat at 0 and at 1.
        let eased = f64::from(t * t * (3.0 - 2.0 * t));
        (self.at(eased), false)
    }

    /// Zooms evenly and moves so that the picture grows about one fixed position.
    fn at(&self, t: f64) -> Camera {
        let scale = self.from.scale * (self.to.scale / self.from.scale).powf(t);
        // One position stays fixed if the centre moves in proportion to the r in a point, here at both ends of the
        // flight.
        let (before, after) = (1.0 / self.from.scale, 1.0 / self.to.scale);
        // The share of the way that is left. Between nearly equal scales the quotient would be of rounding errors.
        let left = if (before - after).abs() > 1e-3 * before.max(after) {
            (1.0 / scale - after) / (before - after)
        } else {
            1.0 - t
        };
        let center = self.to.center + (self.from.center - self.to.center) * left;
        Camera { center, scale }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use emath::pos2;

    fn viewport() -> Rect {
        Rect::from_min_size(pos2(300.0, 50.0), Vec2::new(900.0, 700.0))
    }

    #[test]
    fn screen_and_domain_are_inverse() {
        let camera = Camera {
            center: [12.5, 80.25].into(),
            scale: 17.0,
        };
        for pos in [pos2(300.0, 50.0), pos2(777.0, 333.0), pos2(1200.0, 750.0)] {
            let there = camera.domain_from_screen(viewport(), pos);
            let back = camera.screen_from_domain(viewport(), there);
            assert!(
                (back - pos).length() < 1e-3,
                "{pos:?} came back as {back:?}"
            );
        }
    }

    #[test]
    fn zoom_keeps_the_place_under_the_cursor() {
        let mut camera = Camera::fitting([119.6, 119.6], viewport());
        let cursor = pos2(500.0, 600.0);
        let position = camera.domain_from_screen(viewport(), cursor);
        for factor in [1.7, 9.0, 0.02, 1e9, 1e-12] {
            camera.zoom_about(viewport(), cursor, factor, [MIN_SCALE, MAX_SCALE]);
            let now = camera.domain_from_screen(viewport(), cursor);
            assert!((now[0] - position[0]).abs() < 1e-6 && (now[1] - position[1]).abs() < 1e-6);
            assert!((MIN_SCALE..=MAX_SCALE).contains(&camera.scale));
        }
    }

    #[test]
    fn panning_moves_the_picture_with_the_pointer() {
        let mut camera = Camera::fitting([10.0, 20.0], viewport());
        let position = camera.domain_from_screen(viewport(), pos2(400.0, 400.0));
        camera.pan(Vec2::new(33.0, -21.0));
        let moved = camera.screen_from_domain(viewport(), position);
        assert!((moved - pos2(433.0, 379.0)).length() < 1e-3);
    }

    #[test]
    fn a_fitted_domain_is_wholly_visible() {
        let camera = Camera::fitting([65_000.0, 10.0], viewport());
        let (low, high) = camera.visible(viewport());
        assert!(low[0] < 0.0 && high[0] > 65_000.0 && low[1] < 0.0 && high[1] > 10.0);
    }

    #[test]
    fn a_flight_ends_at_its_destination() {
        let from = Camera::default();
        let to = Camera {
            center: [55.0, 3.0].into(),
            scale: 90.0,
        };
        let mut flight = Flight::new(from, to);
        let (halfway, arrived) = flight.advance(FLIGHT_SECS / 2.0);
        assert!(!arrived && halfway.scale > from.scale && halfway.scale < to.scale);
        assert_eq!(flight.advance(FLIGHT_SECS), (to, true));
    }
}
