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
        arguments.run.count.is_none() && arguments.nested.exactly.is_none(),
        "--count and --exactly would make the whole set to find the scale of its radii: with --window give the radii themselves"
    );
    let recipe = varying::recipe_of(arguments)?;
    let ground = recipe.ground()?;
    let window = checked_window(&ground, corners)?;
    check_expected(ground.expected_in(&window), recipe.shape.is_some())?;

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

/// Returns the window between two corners. Refuses one without a place of the domain.
fn checked_window(ground: &Ground, corners: [f64; 4]) -> Result<Window> {
    let domain = ground.field.domain();
    let place_of = |axis: usize| {
        [
            ground.origin[axis],
            ground.origin[axis] + domain.size()[axis],
        ]
    };
    let none = |axis: usize| {
        let (low, high, [first, end]) = (corners[axis], corners[axis + 2], place_of(axis));
        let name = ["width", "height"][axis];
        format!(
            "the window's {name} runs from {low} to {high} and holds no place of the domain, {first} to {end}"
        )
    };
    // Where a bounded domain ends, nothing is left of a window beyond, however far away it is.
    for axis in [0, 1].into_iter().filter(|_| !domain.is_periodic()) {
        let [first, end] = place_of(axis);
        let is_beyond = corners[axis + 2] <= first || corners[axis] > end;
        ensure!(!is_beyond, none(axis));
    }

    let window = ground.window(corners)?;
    for axis in 0..2 {
        // A window between two lattice lines has no place either.
        ensure!(window.min[axis] < window.max[axis], none(axis));
    }
    Ok(window)
}
