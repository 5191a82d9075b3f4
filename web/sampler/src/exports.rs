//! The functions of the module. A host writes where [`values`] says, calls one of the others, and reads where [`result`] or
//! [`error`] says. Each returns how many numbers there are or, below 0, how many bytes the error has.
#![allow(
    unsafe_code,
    reason = "exporting a function under its own name counts as unsafe; nothing else here is"
)]

use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::{Planes, Settings, VALUES, Values};

/// What lies between the host and the sampler.
struct Shared {
    planes: Planes,
    values: Values,
    numbers: Vec<f64>,
    error: String,
}

static SHARED: Mutex<Shared> = Mutex::new(Shared {
    planes: Planes::NONE,
    values: [0; VALUES],
    numbers: Vec::new(),
    error: String::new(),
});

fn shared() -> MutexGuard<'static, Shared> {
    SHARED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Keeps a result or an error for the host.
fn answered(work: impl FnOnce(&mut Shared) -> Result<Vec<f64>, String>) -> i32 {
    let mut shared = shared();
    // The result of before is not needed any more, and would be in memory beside the next one.
    shared.numbers = Vec::new();

    match work(&mut shared) {
        Ok(numbers) => {
            shared.numbers = numbers;
            // A memory of 2^32 bytes holds fewer numbers than a half of that.
            shared.numbers.len() as i32
        }
        Err(error) => {
            shared.error = error;
            -(shared.error.len() as i32)
        }
    }
}

/// Returns where to write values, which is always the same place.
#[must_use]
#[unsafe(no_mangle)]
pub extern "C" fn values() -> *mut u64 {
    shared().values.as_mut_ptr()
}

/// Makes a set: its radius and its positions. Bit k of `given` says whether value k is given.
#[must_use]
#[unsafe(no_mangle)]
pub extern "C" fn sample(given: u32) -> i32 {
    answered(|shared| crate::sample(&Settings::read(given, &shared.values)?))
}

/// Makes a plane: its number.
#[must_use]
#[unsafe(no_mangle)]
pub extern "C" fn plane(given: u32) -> i32 {
    answered(|shared| {
        let number = shared
            .planes
            .make(&Settings::read(given, &shared.values)?)?;
        Ok(vec![number as f64])
    })
}

/// Makes a window of a plane, whose corners are the first four values. If `moves`, the next four are the corners of a window
/// whose samples are left out.
#[must_use]
#[unsafe(no_mangle)]
pub extern "C" fn window(number: usize, moves: bool) -> i32 {
    answered(|shared| {
        let at = |index: usize| f64::from_bits(shared.values[index]);
        let corners = |first| [[at(first), at(first + 1)], [at(first + 2), at(first + 3)]];
        let from = moves.then(|| corners(4));
        shared.planes.window(number, corners(0), from)
    })
}

/// Frees a plane.
#[must_use]
#[unsafe(no_mangle)]
pub extern "C" fn free(number: usize) -> i32 {
    answered(|shared| shared.planes.free(number).map(|()| Vec::new()))
}

/// Returns where the numbers lie.
#[must_use]
#[unsafe(no_mangle)]
pub extern "C" fn result() -> *const f64 {
    shared().numbers.as_ptr()
}

/// Returns where the error lies.
#[must_use]
#[unsafe(no_mangle)]
pub extern "C" fn error() -> *const u8 {
    shared().error.as_ptr()
}
