//! `tilescope sample --window`: a part of a set that is never made as a whole.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::ops::ControlFlow;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use serde::Serialize;
use serde_json::{Value, json};
use tilescope_analysis::{Boundary, Region, VerifyOptions};
use tilescope_core::{Domain, MAXIMAL_DENSITY, Plane, Progress, R, Window};
use tilescope_formats::PointSet;
use tilescope_gpu::{ASKED_FOR, Backend, Engine};

use crate::make::{Made, positions};
use crate::options::region;
use crate::progress::{Stopwatch, verifying};
use crate::sample_arguments::{SampleArguments, SamplingMethod};
use crate::{interrupt, output, verdict_code};

/// The most samples of a window: they are judged in memory.
const MAX_SAMPLES: f64 = 2e7;

/// Gaps that the verifier lists, more than the cut borders of a window have.
const MAX_GAPS: usize = 1 << 20;

/// The verdict of the verifier on a window.
#[derive(Serialize)]
struct WindowVerdict {
    /// Pairs in conflict in the window and around it.
    conflicts: u64,
    /// Uncovered places in the window.
    gaps: usize,
    /// The smallest distance around.
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
        "--window needs the parallel engine: the others, the GPU's too, make whole sets"
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
        // A window of a bounded domain shows nothing outside the domain.
        ensure!(
            window.min[axis] < window.max[axis],
            "the window's {name} runs from {low} to {high}, which holds no place of the domain's 0 to {}",
            domain.size()[axis]
        );
    }
    check_size(&window)?;
    let began = Instant::now();
    let points = plane.observed_window(&window, &mut going_on)?;
    let seconds = began.elapsed().as_secs_f64();
    let verdict = judge(&plane, &window)?;
    let valid = verdict.valid;
    let (facts, count) = (run.facts()?, points.len());
    let parameters = facts.parameters.clone();
    if let Some(path) = &arguments.out {
        ensure!(
            count > 0,
            "{}: no sample lies in the window, and files have at least one",
            path.display()
        );
        let set = PointSet::from_points(positions(&domain, &points));
        arguments.save_unverified(&Made { facts, set }, path)?;
    }
    let file = arguments.out.as_ref();
    let report = WindowReport {
        method: "kdrt",
        parameters,
        window: [left, bottom, right, top],
        radius: domain.radius(),
        domain,
        count,
        seconds,
        verdict,
        file: file.map(|path| path.display().to_string()),
    };
    output::report(arguments.json, || json!(report), || text(&report))?;
    Ok(verdict_code(valid))
}

fn check_size(window: &Window) -> Result<()> {
    let side = |axis: usize| (window.max[axis] - window.min[axis]) as f64 / f64::from(R);
    let expected = side(0) * side(1) * MAXIMAL_DENSITY;
    ensure!(
        expected <= MAX_SAMPLES,
        "about {expected:.3e} samples lie in the window; at most {MAX_SAMPLES:.0e} can be shown: \
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
    let mut out = format!(
        "window         [{left}, {right}{} x [{bottom}, {top}{} of {}, r = {}\n\
         samples        {} in {:.2} ms\n\
         conflict-free  {}   min distance {:.9} r\n\
         maximal        {}\n\
         verdict        {}\n",
        end(right, 0),
        end(top, 1),
        output::region_text(&region(domain)),
        report.radius,
        report.count,
        report.seconds * 1e3,
        output::conflicts_answer(verdict.conflicts),
        verdict.min_distance_r,
        output::answer(verdict.maximal, verdict.gaps as u64),
        output::validity(verdict.valid),
    );
    if let Some(file) = &report.file {
        let _ = writeln!(
            out,
            "file           {file} (a part of a set has no certificate)"
        );
    }
    out
}

/// Judges a window of a plane by the samples in it and around it.
fn judge(plane: &Plane, window: &Window) -> Result<WindowVerdict> {
    let cut = plane.widened(window, &mut going_on)?;
    let region = Region {
        width: cut.size[0],
        height: cut.size[1],
        boundary: Boundary::Bounded,
    };
    let options = VerifyOptions {
        witnesses: MAX_GAPS,
        ..VerifyOptions::default()
    };
    let radius = plane.domain().radius();
    let report = verifying(|control| {
        tilescope_analysis::verify(&cut.positions, region, radius, &options, control)
    });
    let report = report.context("the verifier gives no verdict")?;
    // Gaps around the window come from the cut.
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

/// Stops the work of a window when the process was asked to end.
fn going_on(_: Progress) -> ControlFlow<()> {
    interrupt::flow()
}

/// Returns whether a window is valid, for callers that measure.
pub fn is_valid(plane: &Plane, window: &Window) -> Result<bool> {
    interrupt::check("the verdict")?;
    Ok(judge(plane, window)?.valid)
}
