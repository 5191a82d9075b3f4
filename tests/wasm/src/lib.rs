//! The engines as four plain exports: a host writes a task as JSON into memory, calls [`run`] and reads the points.
//! There are no bindings and no imports, so that any WebAssembly host can run the module.
#![allow(
    unsafe_code,
    reason = "exporting a function under its own name counts as unsafe; nothing else here is"
)]

use std::sync::{Mutex, MutexGuard, PoisonError};

use serde::{Deserialize, Serialize};
use tilescope_core::{
    InstructionSet, Parameters, Pattern, Plane, Point, SampleError, Sweep, Unobserved, WindowMaker,
    reference_sample, sample,
};

/// A computation.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub enum Task {
    /// A run of the sequential engine.
    Sequential(Parameters),
    /// A run of the parallel engine, with or without sources.
    Sweep(Parameters, bool),
    /// The window of a plane between two corners in user units.
    Window(Parameters, [f64; 2], [f64; 2]),
    /// The reference sampler's set.
    Reference(Parameters),
}

impl Task {
    /// Returns the points.
    pub fn points(&self) -> Result<Vec<Point>, SampleError> {
        let pattern = |p: &Parameters| Pattern::of_spec(&p.pattern, &mut Unobserved);
        match self {
            Self::Sequential(p) => Ok(sample(p, &mut Unobserved)?.points()),
            Self::Sweep(p, sources) => {
                let pattern = pattern(p)?;
                let sweep = Sweep::new(p, &pattern, *sources)?;
                Ok(sweep.finish(&mut Unobserved)?.0.points)
            }
            Self::Window(p, low, high) => {
                let pattern = pattern(p)?;
                let plane = Plane::new(p, &pattern)?;
                plane.window(&plane.domain().window(*low, *high)?)
            }
            Self::Reference(p) => reference_sample(p.validate()?, p.seed, &mut Unobserved),
        }
    }
}

/// Returns x and y of each point, little-endian.
#[must_use]
pub fn bytes_of(points: &[Point]) -> Vec<u8> {
    let pairs = points
        .iter()
        .flat_map(|p| [p.x.to_le_bytes(), p.y.to_le_bytes()]);
    pairs.flatten().collect()
}

/// A task before a run, its result afterwards.
static BUFFER: Mutex<Vec<u8>> = Mutex::new(Vec::new());

fn buffer() -> MutexGuard<'static, Vec<u8>> {
    BUFFER.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns where to write a task of `length` bytes.
#[must_use]
#[cfg_attr(target_arch = "wasm32", unsafe(no_mangle))]
pub extern "C" fn resize(length: usize) -> *mut u8 {
    let mut buffer = buffer();
    buffer.clear();
    buffer.resize(length, 0);
    buffer.as_mut_ptr()
}

/// Runs the task in the buffer. Returns the number of bytes of the answer: [`bytes_of`] the points, or, if the number
/// is negative, an error message.
#[must_use]
#[cfg_attr(target_arch = "wasm32", unsafe(no_mangle))]
pub extern "C" fn run() -> i64 {
    let task = std::mem::take(&mut *buffer());
    let points = serde_json::from_slice(&task)
        .map_err(|error| error.to_string())
        .and_then(|task: Task| task.points().map_err(|error| error.to_string()));
    let (answer, sign) = match points {
        Ok(points) => (bytes_of(&points), 1),
        Err(message) => (message.into_bytes(), -1),
    };
    let length = i64::try_from(answer.len()).unwrap_or(i64::MAX);
    *buffer() = answer;
    sign * length
}

/// Returns the address of the answer.
#[must_use]
#[cfg_attr(target_arch = "wasm32", unsafe(no_mangle))]
pub extern "C" fn answer() -> *const u8 {
    buffer().as_ptr()
}

/// Puts the name of the instruction set into the buffer and returns its length.
#[must_use]
#[cfg_attr(target_arch = "wasm32", unsafe(no_mangle))]
pub extern "C" fn instructions() -> usize {
    let name = InstructionSet::best().name();
    *buffer() = name.into();
    name.len()
}
