//! The tone of a ramp of 64 steps: how many dots of a stipple lie in each step, beside how many its darkness asks for.

use tilescope_analysis::VerifyOptions;
use tilescope_sets::{GrayImage, StippleRecipe};

use crate::control::Control;
use crate::error::{ReproduceError, Result};

/// Steps of the ramp, the lightest first: the darkness of step k, from 1, is k / 64.
pub const STEPS: usize = 64;
/// Pixels of a step and rows of the image. The field is bilinear between pixels, so that few of the pixels of a step may lie
/// at its edges.
const STEP_PIXELS: usize = 16;
const ROWS: usize = 256;
/// Light in an image.
const WHITE: usize = 65_535;

/// Returns how dark a step is.
pub fn darkness(step: usize) -> f64 {
    (step + 1) as f64 / STEPS as f64
}

/// Returns which share of all dots a step asks for.
pub fn share(step: usize) -> f64 {
    let all: f64 = (0..STEPS).map(darkness).sum();
    darkness(step) / all
}

/// Returns how many dots of the stipple of a seed lie in each step. Fails unless the judge finds it valid.
pub fn counted(dots: u64, seed: u64, control: &Control<'_>) -> Result<Vec<u64>> {
    let row = (0..STEPS * STEP_PIXELS).map(|column| {
        let step = column / STEP_PIXELS;
        (WHITE - (step + 1) * WHITE / STEPS) as u16
    });
    let row: Vec<u16> = row.collect();
    let recipe = StippleRecipe {
        image: GrayImage::from_grey(row.len(), row.repeat(ROWS))?,
        // No place of the ramp is white, and all of it is asked for.
        white: 0.0,
        dots,
        width: None,
        // At a border there are more dots, which would be those of the first and of the last step.
        runs_on: true,
        seed,
    };
    let stipple = recipe.make(&mut control.observer())?;

    let report = (stipple.made).judge(&VerifyOptions::default(), &control.analysis())?;
    if !report.valid() {
        return Err(ReproduceError::invalid("a ramp of 64 steps", &report));
    }
    let mut counts = vec![0; STEPS];
    for [x, _] in &stipple.made.set.points {
        // The far border belongs to the last step.
        counts[((x / STEP_PIXELS as f64) as usize).min(STEPS - 1)] += 1;
    }
    Ok(counts)
}
