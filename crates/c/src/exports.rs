//! The functions of C. `tilescope.h` has the same with their guarantees in the words of C.

#![expect(unsafe_code, reason = "the argument is at the head of this crate")]
#![expect(
    clippy::missing_safety_doc,
    reason = "what callers guarantee is the same for all of them, and stands here once"
)]

// # Safety, of all functions
//
// Each pointer is null, or leads to a value of its type (to memory for one, where a function writes), which no other
// thread changes during the call. `points` leads to memory for `capacity` points. A plane is one that
// `tilescope_plane_new` made and that was not freed.
//
// What a function writes is first set to null, 0 or false: a caller that does not look at the status finds nothing
// there.

use std::ffi::c_char;

use tilescope_core::Window;

pub use crate::plane::{TilescopePlane, TilescopePoint, TilescopeSettings};
pub use crate::status::TilescopeStatus;

use crate::plane::{Asked, capacity};
use crate::pointers::{buffer, free, read, write};
use crate::status::{Failure, guarded, message};

/// A rectangle of the plane: `left <= x < right` and `bottom <= y < top`, in user units.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TilescopeWindow {
    /// The lowest x inside.
    pub left: f64,
    /// The lowest y inside.
    pub bottom: f64,
    /// The first x beyond.
    pub right: f64,
    /// The first y beyond.
    pub top: f64,
}

impl TilescopeWindow {
    /// Returns the window on the lattice of a plane.
    fn on(&self, plane: &TilescopePlane) -> Result<Window, Failure> {
        let (low, high) = ([self.left, self.bottom], [self.right, self.top]);
        Ok(plane.domain().window(low, high)?)
    }
}

/// Returns the usual settings.
#[unsafe(no_mangle)]
pub extern "C" fn tilescope_settings() -> TilescopeSettings {
    TilescopeSettings::default()
}

/// Makes a plane and stores it in `plane`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tilescope_plane_new(
    settings: *const TilescopeSettings,
    plane: *mut *mut TilescopePlane,
) -> TilescopeStatus {
    guarded(|| {
        // SAFETY: the caller's guarantee, at the head of this file.
        let target = unsafe { write(plane, "plane") }?;
        // A caller that does not look at the status finds no plane rather than a wild pointer.
        let handle = target.write(std::ptr::null_mut());

        // SAFETY: as above.
        let settings = unsafe { read(settings, "settings") }?;
        *handle = Box::into_raw(Box::new(TilescopePlane::new(settings)?));
        Ok(())
    })
}

/// Frees a plane; null is allowed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tilescope_plane_free(plane: *mut TilescopePlane) {
    if plane.is_null() {
        return;
    }
    guarded(|| {
        // SAFETY: the caller's guarantee, at the head of this file; planes are made by `Box::into_raw`.
        unsafe { free(plane) };
        Ok(())
    });
}

/// Stores the most samples that a window can have.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tilescope_plane_capacity(
    plane: *const TilescopePlane,
    window: *const TilescopeWindow,
    most: *mut usize,
) -> TilescopeStatus {
    guarded(|| {
        // SAFETY: the caller's guarantee, at the head of this file.
        let most = unsafe { write(most, "capacity") }?.write(0);
        // SAFETY: as above.
        let plane = unsafe { read(plane, "plane") }?;
        // SAFETY: as above.
        let window = unsafe { read(window, "window") }?;
        *most = capacity(&window.on(plane)?);
        Ok(())
    })
}

/// Writes the samples in a window.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tilescope_plane_window(
    plane: *const TilescopePlane,
    window: *const TilescopeWindow,
    points: *mut TilescopePoint,
    capacity: usize,
    count: *mut usize,
) -> TilescopeStatus {
    guarded(|| {
        // SAFETY: the caller's guarantee, at the head of this file.
        let count = unsafe { write(count, "count") }?.write(0);
        // SAFETY: as above.
        let plane = unsafe { read(plane, "plane") }?;
        // SAFETY: as above.
        let window = unsafe { read(window, "window") }?;
        // SAFETY: as above.
        let points = unsafe { buffer(points, capacity, "points") }?;

        plane.write(&Asked::Whole(window.on(plane)?), points, count)
    })
}

/// Writes the samples in `to` that are not in `from`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tilescope_plane_gained(
    plane: *const TilescopePlane,
    from: *const TilescopeWindow,
    to: *const TilescopeWindow,
    points: *mut TilescopePoint,
    capacity: usize,
    count: *mut usize,
) -> TilescopeStatus {
    guarded(|| {
        // SAFETY: the caller's guarantee, at the head of this file.
        let count = unsafe { write(count, "count") }?.write(0);
        // SAFETY: as above.
        let plane = unsafe { read(plane, "plane") }?;
        // SAFETY: as above.
        let from = unsafe { read(from, "from") }?.on(plane)?;
        // SAFETY: as above.
        let to = unsafe { read(to, "to") }?.on(plane)?;
        // SAFETY: as above.
        let points = unsafe { buffer(points, capacity, "points") }?;

        plane.write(&Asked::Gained { from, to }, points, count)
    })
}

/// Writes the samples in `from` that are not in `to`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tilescope_plane_lost(
    plane: *const TilescopePlane,
    from: *const TilescopeWindow,
    to: *const TilescopeWindow,
    points: *mut TilescopePoint,
    capacity: usize,
    count: *mut usize,
) -> TilescopeStatus {
    // Samples that are lost on a way are gained on the way back.
    // SAFETY: the caller's guarantee is the same.
    unsafe { tilescope_plane_gained(plane, to, from, points, capacity, count) }
}

/// Stores whether a sample lies in a window.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tilescope_plane_contains(
    plane: *const TilescopePlane,
    window: *const TilescopeWindow,
    point: TilescopePoint,
    is_inside: *mut bool,
) -> TilescopeStatus {
    guarded(|| {
        // SAFETY: the caller's guarantee, at the head of this file.
        let is_inside = unsafe { write(is_inside, "is_inside") }?.write(false);
        // SAFETY: as above.
        let plane = unsafe { read(plane, "plane") }?;
        // SAFETY: as above.
        let window = unsafe { read(window, "window") }?;

        let nearest = plane.domain().plane_from_user([point.x, point.y]);
        // A coordinate that is no number lies nowhere, but would be rounded to 0.
        let is_somewhere = point.x.is_finite() && point.y.is_finite();
        *is_inside = window.on(plane)?.contains(nearest) && is_somewhere;
        Ok(())
    })
}

/// Returns the message of the last failure on this thread.
#[unsafe(no_mangle)]
pub extern "C" fn tilescope_message() -> *const c_char {
    message()
}

/// Returns the version of the library.
#[unsafe(no_mangle)]
pub extern "C" fn tilescope_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}
