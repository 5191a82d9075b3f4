//! `tilescope sample --window`: makes a part of a set without the rest.

mod nested;
mod varying;

use std::fmt::Write;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use serde_json::{Value, json};
use tilescope_analysis::{CutReport, Region, VerifyOptions, verify_cut};
use tilescope_core::{
    Domain, ExactPlane, MAXIMAL_DENSITY, Plane, Progress, R, Variant, WidenedWindow, Window,
    WindowMaker,
};
use tilescope_formats::{PointSet, positions_digest};
use tilescope_sets::{Facts, region};

use crate::make::NO_VERDICT;
use crate::output::radius_text;
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
    // A field or a shape gives its domain a place of its own, so that an origin is a part of what is asked for.
    if arguments.ground.is_given() {
        return varying::run(arguments, corners);
    }
    ensure!(
        arguments.origin.is_none(),
        "--origin: --window gives a part of the domain from 0 0 on, unless a field or a shape is given; leave it out"
    );

    let mut watch = Stopwatch::start();
    let mut recipe = arguments.run.recipe()?;

    if let Some(request) = arguments.nested.request()? {
        return nested::run(arguments, corners, &recipe, request);
    }
    let check_engine = |variant| {
        ensure!(
            arguments.engine.makes_windows(variant),
            "--window needs the parallel engine: the others, also the GPU's, make whole sets"
        );
        Ok(())
    };
    match arguments.method() {
        SamplingMethod::Kdrt => {
            check_engine(arguments.run.asked.variant)?;
            // Only the window is in memory, and `check_size` limits it, so that the set may have any size. `--count` is
            // allowed: the radius of a large set is estimated and as a rule confirmed by a smaller set, so that the
            // whole set need not be made.
            let in_memory = false;
            let run = arguments.run.settle(recipe, in_memory, &mut watch)?;
            let plane = Plane::new(&run.parameters, &run.pattern)?;
            show(arguments, corners, &plane, &run.facts)
        }
        SamplingMethod::Exact => {
            // Its variants are refused below, by their name.
            check_engine(Variant::Staged)?;
            ensure!(
                recipe.count.is_none(),
                "--count would make the whole set to find its radius: with --window and --method exact give --radius"
            );
            recipe = arguments.run.exact_recipe(recipe)?;
            let history = recipe.history(&mut watch)?;
            let plane = ExactPlane::new(&recipe.parameters, &history)?;

            // How many samples the whole set would have is estimated, as it is never made.
            let samples = arguments.run.expected(&recipe.parameters)?;
            let facts = recipe.facts_of_exact(
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
    let found = FoundWindow {
        corners,
        domain: &domain,
        set: &PointSet::from_points(domain.users_from_lattice(&points)),
        facts,
        seconds,
        report: &judge(&widened, domain.radius())?,
    };
    found.show(arguments)
}

/// A window that was made, with its verdict.
struct FoundWindow<'a> {
    corners: [f64; 4],
    domain: &'a Domain,
    set: &'a PointSet,
    facts: &'a Facts,
    seconds: f64,
    report: &'a CutReport,
}

impl FoundWindow<'_> {
    /// Saves and reports the window. Returns the exit code of the program.
    fn show(&self, arguments: &SampleArguments) -> Result<u8> {
        let mut lines = self.text();
        let file = save(arguments, self.set, self.facts, &mut lines)?;
        output::report(arguments.json, || self.json(file.as_deref()), || lines)?;
        Ok(verdict_code(self.report.valid()))
    }

    /// Returns the report for programs.
    fn json(&self, file: Option<&str>) -> Value {
        let (facts, report) = (self.facts, self.report);
        // A conflict counts wherever it is in the part around the window that was judged, but a gap only in the window: around
        // it the cut makes gaps.
        json!({
            "method": facts.method,
            "parameters": facts.parameters,
            "window": self.corners,
            "radius": facts.radius,
            "count": self.set.len(),
            "positions_digest": positions_digest(&self.set.points),
            "seconds": self.seconds,
            "conflicts": report.whole.conflicts,
            "gaps": report.gaps,
            "min_distance_r": report.whole.min_distance / report.whole.radius,
            "conflict_free": report.whole.conflict_free(),
            "maximal": report.gaps == 0,
            "valid": report.valid(),
            "file": file,
        })
    }

    /// Returns the report in lines.
    fn text(&self) -> String {
        let (whole, varying) = (&self.report.whole, self.facts.varying.as_ref());
        let radius = match varying {
            Some(varying) => radius_text(&varying.radius),
            None => whole.radius.to_string(),
        };
        let place = WindowPlace {
            corners: self.corners,
            origin: self.facts.origin,
            domain: self.domain,
            radius: &radius,
        };
        let first_lines = place.head(self.set.len(), self.seconds);

        // In radii, so that the limit is 1, which need not be shown beside it.
        let (least, decimals) = (whole.min_distance / whole.radius, 9);
        let (min_distance, _limit) = output::compared(least, 1.0, decimals);
        let is_field = varying.is_some_and(|varying| varying.radius.varies());
        let of_least = if is_field { " of the least" } else { "" };
        // Fewer than two samples have no distance.
        let distance = if least.is_finite() {
            format!("   min distance {min_distance} r{of_least}")
        } else {
            String::new()
        };

        format!(
            "{first_lines}conflict-free  {}{distance}\n\
             maximal        {}\n\
             verdict        {}\n",
            output::conflicts_answer(whole.conflicts),
            output::answer(self.report.gaps == 0, self.report.gaps),
            output::validity(self.report.valid()),
        )
    }
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
    let has_shape = false;
    check_expected(side(0) * side(1) * MAXIMAL_DENSITY, has_shape)
}

/// Refuses a window with too many samples. Of a shape the number is that without it.
fn check_expected(expected: f64, has_shape: bool) -> Result<()> {
    // How much of the window a shape covers is not found out before its samples are made.
    let condition = if has_shape {
        ", if the shape covers all of it"
    } else {
        ""
    };
    ensure!(
        expected <= MAX_SAMPLES,
        "about {expected:.3e} samples lie in the window{condition}; the limit is {MAX_SAMPLES:.0e}: \
         make the whole set with --out, or choose a smaller window"
    );
    Ok(())
}

/// Where a window is.
struct WindowPlace<'a> {
    corners: [f64; 4],
    /// The lower corner of the domain in the same coordinates.
    origin: [f64; 2],
    domain: &'a Domain,
    /// The radius in words.
    radius: &'a str,
}

impl WindowPlace<'_> {
    /// Returns the first lines of a window's report: where it is, and how many samples it has.
    fn head(&self, count: usize, seconds: f64) -> String {
        let [left, bottom, right, top] = self.corners;
        // A window has its lower ends and not its upper ones, so that windows side by side share no sample. Only the border
        // of a bounded domain belongs to the windows that reach it.
        let end = |high: f64, axis: usize| {
            let from_origin = high - self.origin[axis];
            let is_border = !self.domain.is_periodic() && from_origin >= self.domain.size()[axis];
            if is_border { ']' } else { ')' }
        };
        let (x, y) = (end(right, 0), end(top, 1));
        let region = output::region_text(&region(self.domain));
        format!(
            "window         [{left}, {right}{x} x [{bottom}, {top}{y} of {region}, r = {}\n\
             samples        {count} in {:.2} ms\n",
            self.radius,
            seconds * 1e3
        )
    }
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
