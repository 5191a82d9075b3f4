//! Windows of sets whose radius varies, or that cover a shape.

use std::time::Instant;

use anyhow::{Context, Result, ensure};
use tilescope_core::{Progress, Window};
use tilescope_sets::Ground;

use super::{FoundWindow, check_expected};
use crate::interrupt;
use crate::make::NO_VERDICT;
use crate::progress::verifying;
use crate::sample_arguments::SampleArguments;
use crate::varying;

/// Computes the samples of one window of the set, judges them and prints the report. Returns the exit code of the program.
pub fn run(arguments: &SampleArguments, corners: [f64; 4]) -> Result<u8> {
    ensure!(
        arguments.run.count.is_none(),
        "--count would make the whole set to find the scale of its radii: with --window give the radii themselves"
    );
    let recipe = varying::recipe_of(arguments)?;
    let ground = recipe.ground()?;
    let window = checked_window(&ground, corners)?;

    // The time is that of the points alone, without their verdict.
    let began = Instant::now();
    let made = recipe.make_window(&ground, &window, &mut |_: Progress| interrupt::flow())?;
    let seconds = began.elapsed().as_secs_f64();
    let options = arguments.judge.options();
    let report = verifying(|control| made.judge(&options, control)).context(NO_VERDICT)?;

    let found = FoundWindow {
        corners,
        domain: ground.field.domain(),
        set: &made.set,
        facts: &made.facts,
        seconds,
        report: &report,
    };
    found.show(arguments)
}

/// Returns the window between two corners. Refuses one without a place of the domain, and one with too many samples.
fn checked_window(ground: &Ground, corners: [f64; 4]) -> Result<Window> {
    let window = ground.window(corners)?;
    let size = ground.field.domain().size();
    for (axis, name) in ["width", "height"].into_iter().enumerate() {
        let [low, high] = [corners[axis], corners[axis + 2]];
        let first = ground.origin[axis];
        // A window of a bounded domain was cut at the border.
        ensure!(
            window.min[axis] < window.max[axis],
            "the window's {name} runs from {low} to {high} and holds no place of the domain, {first} to {}",
            first + size[axis]
        );
    }
    check_expected(ground.expected_in(&window))?;
    Ok(window)
}
