//! How much memory calls take, so that a call which there is not enough for raises `MemoryError` instead of ending the
//! interpreter. The numbers of bytes were measured, and a tenth was added.

use std::path::Path;

use tilescope_core::memory::{NoMemory, ask, ask_for};

/// To judge a sample, by both judges.
const JUDGING: f64 = 75.0;

/// To measure a sample: distances, spectrum, discrepancy.
const MEASURING: f64 = 290.0;

/// To export a sample: as it is stored, as it is read back, and to judge it.
const EXPORTING: f64 = 200.0;

/// To read a byte of a file: the bytes, the positions, and to judge them.
const READING: f64 = 7.0;

/// To draw a sample: its disk and its dot.
const DRAWING: f64 = 450.0;

/// To draw a pixel: its colours and opacity, and the clip mask.
const PIXEL: f64 = 6.0;

pub fn ask_to_judge(samples: usize) -> Result<(), NoMemory> {
    ask_for(samples as f64, JUDGING)
}

pub fn ask_to_measure(samples: usize) -> Result<(), NoMemory> {
    ask_for(samples as f64, MEASURING)
}

pub fn ask_to_export(samples: usize) -> Result<(), NoMemory> {
    ask_for(samples as f64, EXPORTING)
}

/// Asks for what a file takes; one that is missing takes nothing.
pub fn ask_to_read(path: &Path) -> Result<(), NoMemory> {
    let length = std::fs::metadata(path).map_or(0, |found| found.len());
    ask_for(length as f64, READING)
}

pub fn ask_to_draw(samples: usize, pixels: f64) -> Result<(), NoMemory> {
    ask((samples as f64 * DRAWING + pixels * PIXEL) as u64)
}
