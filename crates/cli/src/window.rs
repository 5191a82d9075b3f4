//! `tilescope sample --window`: makes a part of a set without the rest.

mod nested;

use std::fmt::Write;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use serde_json::json;
use tilescope_analysis::{CutReport, Region, VerifyOptions, verify_cut};
use tilescope_core::{
    Domain, ExactPlane, MAXIMAL_DENSITY, PatternHistory, Plane, Progress, R, WidenedWindow, Window,
    WindowMaker,
};
use tilescope_formats::{PointSet, positions_digest};
use tilescope_sets::{Facts, facts_of_exact, region};

use crate::make::NO_VERDICT;
use crate::paths::named;
use crate::progress::{Stopwatch, verifying};
use crate::sample_arguments::{SampleArguments, SamplingMethod, save_unverified};
use crate::{interrupt, output, verdict_code};

/// The largest number of samples of a window: they are verified in memory.
const MAX_SAMPLES: f64 = 2e7;

/// Computes the samples of one window of the domain, judges them and prints the report. Returns the exit code of the program.
pub fn run(arguments: &SampleArguments, asked: &[f64]) -> Result<u8> {
    let &[left, bottom, right, top] = asked else {
        anyhow::bail!(
            "--window takes four numbers, or six in space; {} are given",
            asked.len()
        );
    };
    let corners = [left, bottom, right, top];
    let mut watch = Stopwatch::start();
    let mut recipe = arguments.run.recipe()?;

    if let Some(request) = arguments.nested.request()? {
        return nested::run(arguments, corners, &recipe, request);
    }
    match arguments.method() {
        SamplingMethod::Kdrt => {
            ensure!(
                arguments.engine.makes_windows(arguments.run.asked.variant),
                "--window needs the parallel engine: the others, also the GPU's, make whole sets"
            );
            // Only the window is in memory, and `check_size` limits it, so that the set may have any size. `--count` is
            // allowed: the radius of a large set is estimated and as a rule confirmed by a smaller set, so that the
            // whole set need not be made.
            let in_memory = false;
            let run = arguments.run.settle(recipe, in_memory, &mut watch)?;
            let plane = Plane::new(&run.parameters, &run.pattern)?;
            show(arguments, corners, &plane, &run.facts)
        }
        SamplingMethod::Exact => {
            ensure!(
                !arguments.engine.wants_gpu(),
                "--window runs on the CPU: a GPU makes whole sets"
            );
            ensure!(
                recipe.count.is_none(),
                "--count would make the whole set to find its radius: with --window and --method exact give --radius"
            );
            recipe.parameters.pattern = arguments.run.exact_pattern(&recipe.parameters)?;
            let history = PatternHistory::of_spec(&recipe.parameters.pattern, &mut watch)?;
            let plane = ExactPlane::new(&recipe.parameters, &history)?;

            // How many samples the whole set would have is estimated, as it is never made.
            let samples = arguments.run.expected(&recipe.parameters)?;
            let facts = facts_of_exact(
                &recipe.parameters,
                plane.domain(),
                history.pattern(),
                samples,
            );
            show(arguments, corners, &plane, &facts)
        }
        SamplingMethod::Reference => {
            anyhow::bail!("--window needs tiling: the reference sampler makes whole sets")
        }
    }
}

/// Makes a window of a plane, judges, saves and reports it.
fn show(
    arguments: &SampleArguments,
    corners: [f64; 4],
    plane: &impl WindowMaker,
    facts: &Facts,
) -> Result<u8> {
    let domain = *plane.domain();
    let window = checked_window(&domain, corners)?;

    // The time is that of the points alone, without their verdict.
    let began = Instant::now();
    let points = plane.observed_window(&window, &mut |_: Progress| interrupt::flow())?;
    let seconds = began.elapsed().as_secs_f64();
    // Whether a place of the window is covered may depend on samples outside of it.
    let widened = plane.widened(&window, &mut |_: Progress| interrupt::flow())?;
    let report = judge(&widened, domain.radius())?;

    let count = points.len();
    let set = PointSet::from_points(domain.users_from_lattice(&points));
    // A conflict counts wherever it is in the part around the window that was judged, but a gap only in the window:
    // around it the cut makes gaps.
    let mut object = json!({
        "method": facts.method,
        "parameters": facts.parameters,
        "window": corners,
        "radius": domain.radius(),
        "count": count,
        "positions_digest": positions_digest(&set.points),
        "seconds": seconds,
        "conflicts": report.whole.conflicts,
        "gaps": report.gaps,
        "min_distance_r": report.whole.min_distance / report.whole.radius,
        "conflict_free": report.whole.conflict_free(),
        "maximal": report.gaps == 0,
        "valid": report.valid(),
        "file": null,
    });

    let mut lines = text(corners, &domain, count, seconds, &report);
    if let Some(file) = save(arguments, &set, facts, &mut lines)? {
        object["file"] = json!(file);
    }
    output::report(arguments.json, || object, || lines)?;
    Ok(verdict_code(report.valid()))
}

/// Saves the samples of a window, if there is a file for them, and adds a line about it. Returns the file's name.
fn save(
    arguments: &SampleArguments,
    set: &PointSet,
    facts: &Facts,
    text: &mut String,
) -> Result<Option<String>> {
    let Some(path) = &arguments.out else {
        return Ok(None);
    };
    let file = named(path);
    ensure!(
        !set.is_empty(),
        "{file}: no sample lies in the window, and files have at least one"
    );
    save_unverified(set, path, &arguments.context(facts))?;
    let _ = writeln!(
        text,
        "file           {file} (a part of a set has no certificate)"
    );
    Ok(Some(file))
}

/// Returns the window between two corners. Refuses one without a place of the domain, and one with too many samples.
fn checked_window(domain: &Domain, [left, bottom, right, top]: [f64; 4]) -> Result<Window> {
    let window = domain.window([left, bottom], [right, top])?;
    for (axis, name) in ["width", "height"].into_iter().enumerate() {
        let [low, high] = [[left, right], [bottom, top]][axis];
        // A window of a bounded domain was cut at the border.
        ensure!(
            window.min[axis] < window.max[axis],
            "the window's {name} runs from {low} to {high} and holds no place of the domain, 0 to {}",
            domain.size()[axis]
        );
    }
    check_size(&window)?;
    Ok(window)
}

fn check_size(window: &Window) -> Result<()> {
    // In radii, as the density of a maximal set is the number of samples in a square of side r.
    let side = |axis: usize| (window.max[axis] - window.min[axis]) as f64 / f64::from(R);
    let expected = side(0) * side(1) * MAXIMAL_DENSITY;
    ensure!(
        expected <= MAX_SAMPLES,
        "about {expected:.3e} samples lie in the window; the limit is {MAX_SAMPLES:.0e}: \
         make the whole set with --out, or choose a smaller window"
    );
    Ok(())
}

/// Returns the first lines of a window's report: where it is, and how many samples it has.
fn head(
    [left, bottom, right, top]: [f64; 4],
    domain: &Domain,
    count: usize,
    seconds: f64,
) -> String {
    // A window has its lower ends and not its upper ones, so that windows side by side share no sample. Only the border
    // of a bounded domain belongs to the windows that reach it.
    let end = |high: f64, axis: usize| {
        let is_border = !domain.is_periodic() && high >= domain.size()[axis];
        if is_border { ']' } else { ')' }
    };
    let (x, y) = (end(right, 0), end(top, 1));
    let (region, r) = (output::region_text(&region(domain)), domain.radius());
    format!(
        "window         [{left}, {right}{x} x [{bottom}, {top}{y} of {region}, r = {r}\n\
         samples        {count} in {:.2} ms\n",
        seconds * 1e3
    )
}

/// Returns the report of a window in lines.
fn text(
    corners: [f64; 4],
    domain: &Domain,
    count: usize,
    seconds: f64,
    report: &CutReport,
) -> String {
    let whole = &report.whole;
    let first_lines = head(corners, domain, count, seconds);
    // In radii, so that the limit is 1, which need not be shown beside it.
    let (least, decimals) = (whole.min_distance / whole.radius, 9);
    let (min_distance, _limit) = output::compared(least, 1.0, decimals);
    format!(
        "{first_lines}conflict-free  {}   min distance {min_distance} r\n\
         maximal        {}\n\
         verdict        {}\n",
        output::conflicts_answer(whole.conflicts),
        output::answer(report.gaps == 0, report.gaps),
        output::validity(report.valid()),
    )
}

/// Judges a window of a plane by the samples in it and around it, for a radius.
fn judge(cut: &WidenedWindow, radius: f64) -> Result<CutReport> {
    // The part around has ends of its own, also where the domain is periodic.
    let is_periodic = false;
    let asked = (Region::new(cut.size, is_periodic), radius);
    let options = VerifyOptions::default();
    verifying(|control| verify_cut(&cut.positions, asked, cut.window, &options, control))
        .context(NO_VERDICT)
}
