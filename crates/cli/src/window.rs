//! `tilescope sample --window`: makes a part of a set without the rest.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::time::Instant;

use anyhow::{Result, ensure};
use serde::Serialize;
use serde_json::{Value, json};
use tilescope_analysis::{Boundary, Region, VerifyOptions};
use tilescope_core::{Domain, MAXIMAL_DENSITY, Plane, Progress, R, Window};
use tilescope_formats::PointSet;
use tilescope_gpu::{ASKED_FOR, Backend, Engine};

use crate::make::{self, Made};
use crate::options::region;
use crate::progress::Stopwatch;
use crate::sample_arguments::{SampleArguments, SamplingMethod};
use crate::{interrupt, output, verdict_code};

/// The largest number of samples of a window: they are verified in memory.
const MAX_SAMPLES: f64 = 2e7;

/// The most gaps that the verifier lists; the cut borders of a window have fewer.
const MAX_GAPS: usize = 1 << 20;

/// The verdict of the verifier on a window.
#[derive(Serialize)]
struct WindowVerdict {
    /// Pairs in conflict in the window and around it.
    conflicts: u64,
    /// Uncovered places in the window.
    gaps: usize,
    /// The smallest distance in the window and around it, in radii.
    min_distance_r: f64,
    conflict_free: bool,
    maximal: bool,
    valid: bool,
}

/// A window that was made.
#[derive(Serialize)]
struct WindowReport {
    method: &'static str,
    parameters: BTreeMap<String, Value>,
    /// Left, bottom, right, top.
    window: [f64; 4],
    radius: f64,
    #[serde(skip)]
    domain: Domain,
    count: usize,
    seconds: f64,
    #[serde(flatten)]
    verdict: WindowVerdict,
    file: Option<String>,
}

pub fn run(arguments: &SampleArguments, window: &[f64]) -> Result<u8> {
    let &[left, bottom, right, top] = window else {
        anyhow::bail!("--window takes four numbers");
    };
    ensure!(
        arguments.method == SamplingMethod::Kdrt
            && arguments.engine.makes_windows(arguments.run.variant),
        "--window needs the parallel engine: the others, also the GPU's, make whole sets"
    );
    let mut watch = Stopwatch::start();
    let backend = Backend::new(Engine::Parallel, ASKED_FOR);
    let asked = arguments.run.parameters()?;
    let run = (arguments.run).resolve(asked, backend, false, &mut watch)?;
    watch.take();
    let plane = Plane::new(&run.parameters, &run.pattern)?;
    let domain = *plane.domain();
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
    let began = Instant::now();
    let points = plane.observed_window(&window, &mut |_: Progress| interrupt::flow())?;
    let seconds = began.elapsed().as_secs_f64();
    let verdict = judge(&plane, &window)?;
    let valid = verdict.valid;
    let (facts, count) = (run.facts()?, points.len());
    let parameters = facts.parameters.clone();
    let file = arguments.out.as_ref();
    let file = file.map(|path| path.display().to_string());
    if let (Some(path), Some(file)) = (&arguments.out, &file) {
        ensure!(
            count > 0,
            "{file}: no sample lies in the window, and files have at least one"
        );
        let set = PointSet::from_points(domain.users_from_lattice(&points));
        arguments.save_unverified(&Made { facts, set }, path)?;
    }
    let report = WindowReport {
        method: "kdrt",
        parameters,
        window: [left, bottom, right, top],
        radius: domain.radius(),
        domain,
        count,
        seconds,
        verdict,
        file,
    };
    output::report(arguments.json, || json!(report), || text(&report))?;
    Ok(verdict_code(valid))
}

fn check_size(window: &Window) -> Result<()> {
    let side = |axis: usize| (window.max[axis] - window.min[axis]) as f64 / f64::from(R);
    let expected = side(0) * side(1) * MAXIMAL_DENSITY;
    ensure!(
        expected <= MAX_SAMPLES,
        "about {expected:.3e} samples lie in the window; the limit is {MAX_SAMPLES:.0e}: \
         make the whole set with --out, or choose a smaller window"
    );
    Ok(())
}

fn text(report: &WindowReport) -> String {
    let [left, bottom, right, top] = report.window;
    let (domain, verdict) = (&report.domain, &report.verdict);
    // The border of a bounded domain belongs to the windows that reach it.
    let end = |high: f64, axis: usize| {
        let is_border = !domain.is_periodic() && high >= domain.size()[axis];
        if is_border { ']' } else { ')' }
    };
    let (x, y) = (end(right, 0), end(top, 1));
    let (region, r) = (output::region_text(&region(domain)), report.radius);
    let (count, milliseconds) = (report.count, report.seconds * 1e3);
    let mut out = format!(
        "window         [{left}, {right}{x} x [{bottom}, {top}{y} of {region}, r = {r}\n\
         samples        {count} in {milliseconds:.2} ms\n\
         conflict-free  {}   min distance {:.9} r\n\
         maximal        {}\n\
         verdict        {}\n",
        output::conflicts_answer(verdict.conflicts),
        verdict.min_distance_r,
        output::answer(verdict.maximal, verdict.gaps as u64),
        output::validity(verdict.valid),
    );
    if let Some(file) = &report.file {
        let remark = "a part of a set has no certificate";
        let _ = writeln!(out, "file           {file} ({remark})");
    }
    out
}

/// Judges a window of a plane by the samples in it and around it.
fn judge(plane: &Plane, window: &Window) -> Result<WindowVerdict> {
    let cut = plane.widened(window, &mut |_: Progress| interrupt::flow())?;
    let ([width, height], boundary) = (cut.size, Boundary::Bounded);
    let region = Region {
        width,
        height,
        boundary,
    };
    let options = VerifyOptions {
        witnesses: MAX_GAPS,
        ..VerifyOptions::default()
    };
    let radius = plane.domain().radius();
    let report = make::judge(&cut.positions, region, radius, &options)?;
    // Gaps outside the window arise where the set is cut.
    let gaps = report.worst_gaps.iter().map(|gap| gap.center);
    let gaps = gaps.filter(|center| cut.window_has(*center)).count();
    let conflicts = report.conflicts;
    Ok(WindowVerdict {
        conflicts,
        gaps,
        min_distance_r: report.min_distance / report.radius,
        conflict_free: conflicts == 0,
        maximal: gaps == 0,
        valid: conflicts == 0 && gaps == 0,
    })
}

/// Returns whether a window is valid. For `bench`, which times windows.
pub fn is_valid(plane: &Plane, window: &Window) -> Result<bool> {
    interrupt::check("the verdict")?;
    Ok(judge(plane, window)?.valid)
}
