//! Safe wrappers around the functions of C, for the tests.

#![expect(unsafe_code, reason = "the functions are called as C calls them")]

use std::ffi::CStr;
use std::ptr::null_mut;

use tilescope_c::exports::{
    TilescopePlane, TilescopePoint, TilescopeSettings, TilescopeStatus, TilescopeWindow,
    tilescope_message, tilescope_plane_capacity, tilescope_plane_contains, tilescope_plane_free,
    tilescope_plane_gained, tilescope_plane_lost, tilescope_plane_new, tilescope_plane_window,
};

/// What a call returns in place of its result, with its message.
pub type Refusal = (TilescopeStatus, String);

/// Returns `value`, or the refusal that a status stands for.
fn checked<T>(status: TilescopeStatus, value: T) -> Result<T, Refusal> {
    if status == TilescopeStatus::Ok {
        return Ok(value);
    }
    // SAFETY: the message ends with a zero byte, and lives until the next failure on this thread.
    let text = unsafe { CStr::from_ptr(tilescope_message()) };
    Err((status, text.to_str().expect("UTF-8").to_owned()))
}

/// A plane that is freed in the end.
pub struct CPlane(*mut TilescopePlane);

impl Drop for CPlane {
    fn drop(&mut self) {
        // SAFETY: the plane was made by `tilescope_plane_new`, and nobody uses it any longer.
        unsafe { tilescope_plane_free(self.0) };
    }
}

impl CPlane {
    pub fn new(settings: &TilescopeSettings) -> Result<Self, Refusal> {
        let mut plane = null_mut();
        // SAFETY: both pointers lead to values that live beyond the call.
        let status = unsafe { tilescope_plane_new(settings, &raw mut plane) };
        assert_eq!(plane.is_null(), status != TilescopeStatus::Ok);
        checked(status, Self(plane))
    }

    pub fn capacity(&self, window: &TilescopeWindow) -> Result<usize, Refusal> {
        let mut capacity = 0;
        // SAFETY: the plane lives, and the others lead to values that live beyond the call.
        let status = unsafe { tilescope_plane_capacity(self.0, window, &raw mut capacity) };
        checked(status, capacity)
    }

    pub fn contains(&self, window: &TilescopeWindow, point: TilescopePoint) -> bool {
        let mut is_inside = false;
        // SAFETY: as in `capacity`.
        let status = unsafe { tilescope_plane_contains(self.0, window, point, &raw mut is_inside) };
        checked(status, is_inside).expect("a window")
    }

    /// Writes a window's samples to a buffer, and returns how many there are.
    pub fn fill(
        &self,
        window: &TilescopeWindow,
        points: &mut [TilescopePoint],
    ) -> Result<usize, Refusal> {
        let mut count = 0;
        let (buffer, capacity) = (points.as_mut_ptr(), points.len());
        // SAFETY: as in `capacity`; the buffer holds `capacity` points.
        let status =
            unsafe { tilescope_plane_window(self.0, window, buffer, capacity, &raw mut count) };
        // A number comes with a buffer that is too small, too.
        assert_eq!(count > capacity, status == TilescopeStatus::TooSmall);
        checked(status, count)
    }

    /// Writes what a window gains to a buffer, and returns how many samples these are.
    pub fn gain(
        &self,
        [from, to]: [&TilescopeWindow; 2],
        points: &mut [TilescopePoint],
    ) -> Result<usize, Refusal> {
        let mut count = 0;
        let (buffer, capacity) = (points.as_mut_ptr(), points.len());
        // SAFETY: as in `fill`.
        let status =
            unsafe { tilescope_plane_gained(self.0, from, to, buffer, capacity, &raw mut count) };
        checked(status, count)
    }

    /// Writes what a window loses to a buffer, and returns how many samples these are.
    pub fn lose(
        &self,
        [from, to]: [&TilescopeWindow; 2],
        points: &mut [TilescopePoint],
    ) -> Result<usize, Refusal> {
        let mut count = 0;
        let (buffer, capacity) = (points.as_mut_ptr(), points.len());
        // SAFETY: as in `fill`.
        let status =
            unsafe { tilescope_plane_lost(self.0, from, to, buffer, capacity, &raw mut count) };
        checked(status, count)
    }
}

/// Returns a buffer of so many points.
pub fn buffer(count: usize) -> Vec<TilescopePoint> {
    vec![TilescopePoint { x: 0.0, y: 0.0 }; count]
}

/// Returns the square window whose lowest corner is at (left, bottom).
pub const fn square(left: f64, bottom: f64, side: f64) -> TilescopeWindow {
    TilescopeWindow {
        left,
        bottom,
        right: left + side,
        top: bottom + side,
    }
}

/// Returns the bits of points, sorted.
pub fn sorted_bits(points: &[TilescopePoint]) -> Vec<[u64; 2]> {
    let mut all: Vec<[u64; 2]> = points
        .iter()
        .map(|point| [point.x.to_bits(), point.y.to_bits()])
        .collect();
    all.sort_unstable();
    all
}
