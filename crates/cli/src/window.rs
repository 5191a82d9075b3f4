//! `tilescope sample --window`: a part of a set that is never made as a whole.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::ops::ControlFlow;
use std::time::Instant;

use anyhow::{Context, Result, ensure};
use serde_json::{Value, json};
use tilescope_analysis::{Boundary, Region, Report, VerifyOptions};
use tilescope_core::{Domain, MAXIMAL_DENSITY, Plane, Point, Progress, R, Window};
use tilescope_formats::PointSet;

use crate::facts::Facts;
use crate::make::{positions, with_radius};
use crate::options::region;
use crate::progress::{Stopwatch, verifying};
use crate::sample_arguments::{Method, SampleArguments, save_unverified};
use crate::{interrupt, output, verdict_code};

/// Units around a window that are computed to judge it: 4r, where 2r would do.
const MARGIN: i64 = 4 * R as i64;

/// The most samples of a window: they are judged in memory.
const MAX_SAMPLES: f64 = 2e7;

/// More gaps than the cut borders of a judged window have.
const MAX_GAPS: usize = 1 << 20;

/// What was found about a window.
pub struct Verdict {
    /// Pairs in conflict in the window and around it.
    pub conflicts: u64,
    /// Uncovered places in the window.
    pub gaps: usize,
    /// The smallest distance around, in radii.
    pub min_distance: f64,
}

impl Verdict {
    const fn is_valid(&self) -> bool {
        self.conflicts == 0 && self.gaps == 0
    }
}

/// A window as it was asked for and made.
struct Shown<'a> {
    parameters: BTreeMap<String, Value>,
    /// Left, bottom, right, top.
    sides: [f64; 4],
    radius: f64,
    domain: &'a Domain,
    count: usize,
    seconds: f64,
    verdict: Verdict,
    file: Option<String>,
}

pub fn run(arguments: &SampleArguments, window: &[f64]) -> Result<u8> {
    let &[left, bottom, right, top] = window else {
        anyhow::bail!("--window takes four numbers");
    };
    let (facts, plane) = plane(arguments)?;
    let domain = plane.domain();
    let window = domain.window([left, bottom], [right, top])?;
    let window_side = |axis: usize| [(left, right), (bottom, top)][axis];
    for (axis, name) in ["width", "height"].into_iter().enumerate() {
        // Of a bounded domain a window shows only what lies inside.
        ensure!(
            window.min[axis] < window.max[axis],
            "the window's {name} runs from {} to {}, which holds no place of the domain's 0 to {}",
            window_side(axis).0,
            window_side(axis).1,
            domain.size()[axis]
        );
    }
    check_size(&window)?;
    let began = Instant::now();
    let points = plane.observed_window(&window, &mut going_on)?;
    let seconds = began.elapsed().as_secs_f64();
    let verdict = judge(&plane, &window)?;
    if let Some(path) = &arguments.out {
        ensure!(
            !points.is_empty(),
            "{}: no sample lies in the window, and files have at least one",
            path.display()
        );
        let set = PointSet::from_points(positions(domain, &points));
        save_unverified(arguments, &facts, &set, path)?;
    }
    let shown = Shown {
        parameters: facts.parameters,
        sides: [left, bottom, right, top],
        radius: domain.radius(),
        domain,
        count: points.len(),
        seconds,
        verdict,
        file: arguments
            .out
            .as_ref()
            .map(|path| path.display().to_string()),
    };
    output::emit(&if arguments.json {
        format!("{}\n", json(&shown))
    } else {
        text(&shown)
    })?;
    Ok(verdict_code(shown.verdict.is_valid()))
}

/// Returns what is to be told of the run, and its plane.
fn plane(arguments: &SampleArguments) -> Result<(Facts, Plane)> {
    ensure!(
        arguments.method == Method::Kdrt
            && arguments.engine.makes_windows(&arguments.run.parameters()),
        "--window needs the parallel engine: the others, the GPU's too, make whole sets"
    );
    let mut watch = Stopwatch::start();
    let pattern = arguments.run.pattern(&mut watch)?;
    let parameters = with_radius(&arguments.run, &pattern, &mut watch)?;
    watch.take();
    let plane = Plane::new(&parameters, &pattern)?;
    let facts = Facts::of_run(&parameters, plane.domain(), Some(&arguments.run))?;
    Ok((facts, plane))
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

fn json(shown: &Shown<'_>) -> Value {
    json!({
        "method": "kdrt",
        "parameters": shown.parameters,
        "radius": shown.radius,
        "window": shown.sides,
        "count": shown.count,
        "seconds": shown.seconds,
        "conflicts": shown.verdict.conflicts,
        "gaps": shown.verdict.gaps,
        "min_distance_r": shown.verdict.min_distance,
        "conflict_free": shown.verdict.conflicts == 0,
        "maximal": shown.verdict.gaps == 0,
        "valid": shown.verdict.is_valid(),
        "file": shown.file,
    })
}

fn text(shown: &Shown<'_>) -> String {
    let [left, bottom, right, top] = shown.sides;
    let verdict = &shown.verdict;
    // The border of a bounded domain belongs to the windows that reach it.
    let end = |high: f64, axis: usize| {
        let is_border = !shown.domain.is_periodic() && high >= shown.domain.size()[axis];
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
        output::region_text(&region(shown.domain)),
        shown.radius,
        shown.count,
        shown.seconds * 1e3,
        output::conflicts_answer(verdict.conflicts),
        verdict.min_distance,
        output::answer(verdict.gaps == 0, verdict.gaps as u64),
        if verdict.is_valid() {
            "valid"
        } else {
            "NOT VALID"
        },
    );
    if let Some(file) = &shown.file {
        let _ = writeln!(
            out,
            "file           {file} (a part of a set has no certificate)"
        );
    }
    out
}

/// Judges a window of a plane, with a margin around it as far as there is plane.
pub fn judge(plane: &Plane, window: &Window) -> Result<Verdict> {
    let domain = plane.domain();
    let wide = widened(domain, window);
    let low = wide.min;
    let periodic = domain.is_periodic();
    let unit =
        [0, 1].map(|axis| domain.size()[axis] / f64::from([domain.width(), domain.height()][axis]));
    // A wide window may be longer than a periodic domain and show some samples twice.
    let images = |v: i32, axis: usize| {
        let side = i64::from([domain.width(), domain.height()][axis]);
        let first = i64::from(v) - low[axis];
        let (first, step) = if periodic {
            (first.rem_euclid(side), side)
        } else {
            (first, i64::MAX / 2)
        };
        let length = wide.max[axis] - low[axis];
        (0..2)
            .map(move |k| first + k * step)
            .filter(move |&offset| offset < length)
            .map(move |offset| offset as f64 * unit[axis])
    };
    let shown = |p: &Point| {
        let xs = images(p.x, 0);
        images(p.y, 1)
            .flat_map(move |y| xs.clone().map(move |x| [x, y]))
            .collect::<Vec<_>>()
    };
    let points: Vec<[f64; 2]> = plane
        .observed_window(&wide, &mut going_on)?
        .iter()
        .flat_map(shown)
        .collect();
    let last = i64::from(!periodic);
    let region = Region {
        width: (wide.max[0] - wide.min[0] - last) as f64 * unit[0],
        height: (wide.max[1] - wide.min[1] - last) as f64 * unit[1],
        boundary: Boundary::Bounded,
    };
    let options = VerifyOptions {
        witnesses: MAX_GAPS,
        ..VerifyOptions::default()
    };
    let report = verifying(|control| {
        tilescope_analysis::verify(&points, region, domain.radius(), &options, control)
    })
    .context("the verifier gives no verdict")?;
    Ok(verdict(&report, window, &wide, unit))
}

/// Stops the work of a window when the process was asked to end.
fn going_on(_: Progress) -> ControlFlow<()> {
    interrupt::flow()
}

fn widened(domain: &Domain, window: &Window) -> Window {
    let mut wide = *window;
    for axis in 0..2 {
        wide.min[axis] -= MARGIN;
        wide.max[axis] += MARGIN;
        if !domain.is_periodic() {
            let max = [domain.rect().max.x, domain.rect().max.y][axis];
            wide.min[axis] = wide.min[axis].max(0);
            wide.max[axis] = wide.max[axis].min(max.into());
        }
    }
    wide
}

/// Counts the gaps inside the window: those around it are made by the cut.
fn verdict(report: &Report, window: &Window, wide: &Window, unit: [f64; 2]) -> Verdict {
    let inside = |center: [f64; 2]| {
        (0..2).all(|axis| {
            let at = |v: i64| (v - wide.min[axis]) as f64 * unit[axis];
            (at(window.min[axis])..=at(window.max[axis])).contains(&center[axis])
        })
    };
    let gaps = report.worst_gaps.iter().filter(|gap| inside(gap.center));
    Verdict {
        conflicts: report.conflicts,
        gaps: gaps.count(),
        min_distance: report.min_distance / report.radius,
    }
}

/// Judges and says whether all is well, for callers that measure.
pub fn is_valid(plane: &Plane, window: &Window) -> Result<bool> {
    ensure!(!interrupt::requested(), "cancelled before the verdict");
    Ok(judge(plane, window)?.is_valid())
}
