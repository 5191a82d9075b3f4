//! A window of nested levels, with the level and the rank of each of its samples.

use std::fmt::Write;
use std::time::Instant;

use anyhow::{Result, ensure};
use serde_json::{Value, json};
use tilescope_analysis::{CutReport, Number, PrefixClaim};
use tilescope_core::{Nested, NestedPlane, NestedRequest, Progress, Window, WithinLevel};
use tilescope_formats::{PointSet, positions_digest};
use tilescope_sets::{Facts, Recipe, stated};

use super::{WindowPlace, checked_window, judge, save};
use crate::nested::NEEDS_KDRT;
use crate::progress::Stopwatch;
use crate::sample_arguments::{SampleArguments, SamplingMethod};
use crate::{interrupt, output, verdict_code};

/// Makes a window of the plane of nested levels; judges, saves and reports it. `corners` are its left, bottom, right and
/// top ends.
pub fn run(
    arguments: &SampleArguments,
    corners: [f64; 4],
    recipe: &Recipe,
    request: NestedRequest,
) -> Result<u8> {
    // An impossible request is refused before the pattern is made, which takes long.
    check(arguments, recipe, request)?;
    let mut watch = Stopwatch::start();
    let plane = NestedPlane::new(&recipe.parameters, request.levels, &mut watch)?;
    let window = checked_window(plane.domain(), corners)?;

    // The time is that of the points alone, without their verdict.
    let began = Instant::now();
    let found = plane.window(&window, &mut |_: Progress| interrupt::flow())?;
    let seconds = began.elapsed().as_secs_f64();
    let reports = judged(&plane, &window, request.levels)?;
    let is_valid = reports.iter().all(CutReport::valid);

    // The request is stated among the parameters: together they make the window again.
    let mut parameters = recipe.stated(plane.domain().radius());
    parameters.extend(stated(&request));
    let set = PointSet::from_points(found.positions());
    let levels: Vec<_> = (found.ends().iter().zip(&reports))
        .map(|(&count, report)| level_json(count, report))
        .collect();
    let mut object = json!({
        "method": "kdrt",
        "parameters": parameters,
        "window": corners,
        "radius": plane.domain().radius(),
        "count": set.len(),
        "levels": levels,
        "positions_digest": positions_digest(&set.points),
        "seconds": seconds,
        "valid": is_valid,
        "file": null,
    });

    let place = WindowPlace {
        corners,
        origin: [0.0; 2],
        domain: plane.domain(),
        radius: &plane.domain().radius().to_string(),
    };
    let mut text = place.head(set.len(), seconds);
    for (&count, report) in found.ends().iter().zip(&reports) {
        text += &level_text(count, report);
    }
    let _ = writeln!(text, "verdict        {}", output::validity(is_valid));

    // Formats with columns write level and rank of each sample. There are ranks, as `check` demands a random order.
    let facts = Facts {
        levels: claims(&found, &plane),
        ranks: found.ranks().unwrap_or_default().into(),
        ..Facts::new("kdrt", parameters, plane.domain())
    };
    if let Some(file) = save(arguments, &set, &facts, &mut text)? {
        object["file"] = json!(file);
    }
    output::report(arguments.json, || object, || text)?;
    Ok(verdict_code(is_valid))
}

/// Refuses options that need the whole set, which is never made for a window, and methods and engines that make no
/// levels.
fn check(arguments: &SampleArguments, recipe: &Recipe, request: NestedRequest) -> Result<()> {
    ensure!(arguments.method() == SamplingMethod::Kdrt, "{NEEDS_KDRT}");
    // Only the whole set shows how many samples a radius gives.
    ensure!(
        recipe.count.is_none() && request.exactly.is_none(),
        "--count and --exactly would make the whole set to find its radius: with --window and --levels give --radius"
    );
    ensure!(
        request.order_within == WithinLevel::Random,
        "--order-within farthest needs the whole set: which sample of a window is the farthest depends on all others"
    );
    ensure!(
        !arguments.engine.wants_gpu(),
        "--engine gpu and --gpu-adapter make one set; --levels runs on the CPU"
    );
    Ok(())
}

/// Judges a window of each level, which is a set with a radius of its own.
fn judged(plane: &NestedPlane, window: &Window, levels: u32) -> Result<Vec<CutReport>> {
    let of_level = |level: u32| {
        let cut = plane.widened(window, level, &mut |_: Progress| interrupt::flow())?;
        judge(&cut, plane.radius(level))
    };
    (0..levels).map(of_level).collect()
}

/// Returns claims from which the column of levels has its numbers. No certificate states them: a part of a set has none.
fn claims(found: &Nested, plane: &NestedPlane) -> Vec<PrefixClaim> {
    let ends = (0..).zip(found.ends());
    ends.map(|(level, &count)| PrefixClaim::maximal(count, plane.radius(level)))
        .collect()
}

/// Returns the findings on a window's samples to the end of a level, for programs.
fn level_json(count: usize, report: &CutReport) -> Value {
    json!({
        "count": count,
        "radius": report.whole.radius,
        "conflicts": report.whole.conflicts,
        "gaps": report.gaps,
        "min_distance_r": report.whole.min_distance / report.whole.radius,
        "valid": report.valid(),
    })
}

/// Returns the same in a line.
fn level_text(count: usize, report: &CutReport) -> String {
    let whole = &report.whole;
    let conflicts = output::conflicts_answer(whole.conflicts);
    let distance = output::compared(whole.min_distance / whole.radius, 1.0, 9).0;
    let maximal = output::answer(report.gaps == 0, report.gaps);
    format!(
        "  {count:>8} of r = {}: conflict-free {conflicts}, min distance {distance} r, maximal {maximal}\n",
        Number(whole.radius)
    )
}
