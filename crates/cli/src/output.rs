//! What commands print: text for people, one JSON object for programs.

use std::fmt::Write;
use std::path::Path;

use serde_json::{Value, json};
use tilescope_analysis::{Boundary, MAX_CONFLICTS, Number, Region, Report};
use tilescope_core::{Stage, Summary};

use crate::facts::Facts;

/// Prints text. A closed pipe is no error: whoever read has seen enough, and the exit code is for somebody else.
pub fn emit(text: &str) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    let written = std::io::Write::write_all(&mut out, text.as_bytes())
        .and_then(|()| std::io::Write::flush(&mut out));
    match written {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}

/// Prints a line to standard error. Nothing else can be done where that is closed or full.
pub fn note(line: &str) {
    let _ = std::io::Write::write_all(&mut std::io::stderr(), format!("{line}\n").as_bytes());
}

/// A made set with its verdict.
pub struct Outcome<'a> {
    pub facts: &'a Facts,
    pub count: u64,
    /// None if it was not verified.
    pub report: Option<&'a Report>,
    /// The certificate, when the set was saved.
    pub saved: Option<&'a Path>,
    pub warnings: Vec<String>,
}

/// Returns the JSON object of a made set.
pub fn json(outcome: &Outcome<'_>) -> Value {
    let Outcome {
        facts,
        count,
        report,
        saved,
        warnings,
    } = outcome;
    let seconds: Vec<Value> = facts
        .seconds
        .iter()
        .map(|(stage, seconds)| json!({ "stage": stage.to_string(), "seconds": seconds }))
        .collect();
    let mut object = json!({
        "method": facts.method,
        "parameters": facts.parameters,
        "radius": facts.radius,
        "seconds": seconds,
        "certificate": saved.map(|path| path.display().to_string()),
        "warnings": warnings,
    });
    if let Value::Object(map) = &mut object {
        match report {
            Some(report) => map.extend(verdict_json(report)),
            None => map.extend([
                ("count".to_owned(), json!(count)),
                ("verified".to_owned(), json!(false)),
            ]),
        }
        if let Some(told) = &facts.engine {
            map.insert("engine".into(), json!(told.engine));
            map.insert("engine_reason".into(), json!(told.reason));
        }
        if let Some(s) = &facts.summary {
            map.insert("blocks".into(), json!(s.blocks));
            map.insert("tiled".into(), json!(s.tiled));
            map.insert("dropped".into(), json!(s.dropped));
            map.insert("eliminated".into(), json!(s.eliminated));
            map.insert("iterations".into(), json!(s.inserted.len()));
            map.insert("inserted".into(), json!(s.inserted));
        }
    }
    object
}

/// Returns the fields of a verdict, lengths in radii where the name says so.
pub fn verdict_json(report: &Report) -> serde_json::Map<String, Value> {
    let fields = json!({
        "count": report.count,
        "density": report.density,
        "min_distance_r": finite(report.min_distance / report.radius),
        "covering_radius_r": report.covering_radius / report.radius,
        "relative_radius": finite(report.relative_radius),
        "covering_tolerance": report.covering_tolerance,
        "conflicts": report.conflicts,
        "more_conflicts": report.more_conflicts(),
        "gaps": report.gaps,
        "conflict_free": report.conflict_free(),
        "maximal": report.maximal(),
        "valid": report.valid(),
    });
    match fields {
        Value::Object(map) => map,
        _ => serde_json::Map::new(),
    }
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// Returns the text for a made set: stages, verdict, file.
pub fn text(outcome: &Outcome<'_>) -> String {
    let Outcome {
        facts,
        count,
        report,
        saved,
        warnings,
    } = outcome;
    let mut out = String::new();
    let _ = writeln!(
        out,
        "{} on {}, r = {}",
        facts.method,
        region_text(&facts.region),
        Number(facts.radius)
    );
    if let Some(told) = &facts.engine {
        let _ = writeln!(out, "engine         {}: {}", told.engine, told.reason);
    }
    out.push('\n');
    out.push_str(&stage_table(facts.summary.as_ref(), &facts.seconds));
    out.push('\n');
    match report {
        Some(report) => out.push_str(&verdict_text(report)),
        None => {
            let _ = writeln!(
                out,
                "samples        {count}\nverdict        none: not verified"
            );
        }
    }
    for warning in warnings {
        out.push_str(&warning_line(warning));
    }
    if let Some(path) = saved {
        let _ = writeln!(out, "certificate    {}", path.display());
    }
    out
}

/// Returns a line for a warning; some only take note of something.
pub fn warning_line(warning: &str) -> String {
    if warning.starts_with("note: ") {
        format!("{warning}\n")
    } else {
        format!("warning: {warning}\n")
    }
}

/// Returns "1 x 1, periodic".
pub fn region_text(region: &Region) -> String {
    let boundary = match region.boundary {
        Boundary::Periodic => "periodic",
        Boundary::Bounded => "bounded",
    };
    let sides = [region.width, region.height].map(Number);
    format!("{} x {}, {boundary}", sides[0], sides[1])
}

/// Returns a table: a row a stage, with what it did and how long it took.
pub fn stage_table(summary: Option<&Summary>, seconds: &[(Stage, f64)]) -> String {
    let mut out = String::new();
    let mut rest = 0.0;
    // Algorithm 4 as printed has no separate iteration 1.
    let at_once = !seconds.iter().any(|&(stage, _)| stage == Stage::Iterate(1));
    for &(stage, time) in seconds {
        let did = summary
            .map(|s| what_happened(stage, s, at_once))
            .unwrap_or_default();
        // Uniform insertion ends in many levels that fill a handful of slivers.
        if matches!(stage, Stage::Iterate(_)) && summary.is_none() {
            rest += time;
            continue;
        }
        let _ = writeln!(
            out,
            "  {:<12} {:>9.1} ms   {did}",
            stage.to_string(),
            time * 1e3
        );
    }
    if rest > 0.0 {
        let _ = writeln!(out, "  {:<12} {:>9.1} ms", "throw darts", rest * 1e3);
    }
    out
}

fn what_happened(stage: Stage, s: &Summary, at_once: bool) -> String {
    match stage {
        Stage::Pattern => String::new(),
        Stage::Blocks if s.blocks == 1 => "1 building block".to_owned(),
        Stage::Blocks => format!("{} building blocks", s.blocks),
        Stage::Tile if s.dropped > 0 => {
            format!("{} samples, {} more outside dropped", s.tiled, s.dropped)
        }
        Stage::Tile => format!("{} samples", s.tiled),
        Stage::Eliminate if at_once => {
            let first = s.inserted.first().copied().unwrap_or(0);
            format!("{} eliminated, {first} inserted at once", s.eliminated)
        }
        Stage::Eliminate => format!("{} eliminated", s.eliminated),
        Stage::Iterate(k) => match s.inserted.get(k as usize - 1) {
            Some(n) => format!("{n} inserted"),
            None => "no gap is left".to_owned(),
        },
        Stage::Regions => format!(
            "{} building blocks, {} samples tiled{}, {} eliminated, {} inserted",
            s.blocks,
            s.tiled,
            if s.dropped > 0 {
                format!(" and {} dropped outside", s.dropped)
            } else {
                String::new()
            },
            s.eliminated,
            s.inserted
                .iter()
                .map(ToString::to_string)
                .collect::<Vec<_>>()
                .join(" + ")
        ),
        Stage::Finish => format!("{} samples in canonical order", s.count),
    }
}

/// Returns the verdict in a few lines.
pub fn verdict_text(report: &Report) -> String {
    let mut out = String::new();
    let r = report.radius;
    let _ = writeln!(out, "samples        {}", report.count);
    let _ = writeln!(out, "density        {:.4} N r^2 / area", report.density);
    let _ = writeln!(
        out,
        "conflict-free  {}   min distance {:.9} r",
        conflicts_answer(report.conflicts),
        report.min_distance / r
    );
    let _ = writeln!(
        out,
        "maximal        {}   covering radius {:.9} r, at most {:.9} r",
        answer(report.maximal(), report.gaps),
        report.covering_radius / r,
        1.0 + report.covering_tolerance
    );
    for conflict in report.worst_conflicts.iter().take(3) {
        let _ = writeln!(
            out,
            "  conflict: samples {} and {}, {:.6} r apart",
            conflict.first,
            conflict.second,
            conflict.distance / r
        );
    }
    if !report.maximal() {
        for gap in report.worst_gaps.iter().take(3) {
            let _ = writeln!(
                out,
                "  gap: ({}, {}) is {:.6} r from the nearest sample",
                gap.center[0],
                gap.center[1],
                gap.distance / r
            );
        }
    }
    let _ = writeln!(
        out,
        "verdict        {}",
        if report.valid() { "valid" } else { "NOT VALID" }
    );
    out
}

pub fn answer(yes: bool, count: u64) -> String {
    if yes {
        "yes".to_owned()
    } else {
        format!("NO, {count}")
    }
}

/// Returns the answer about conflicts, which are counted up to a limit.
pub fn conflicts_answer(count: u64) -> String {
    let more = if count >= MAX_CONFLICTS {
        " or more"
    } else {
        ""
    };
    answer(count == 0, count) + more
}
