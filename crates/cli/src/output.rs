//! The output of commands: text for people, one JSON object for programs.

use std::fmt::Write;
use std::path::PathBuf;

use serde_json::{Value, json};
use tilescope_analysis::{Boundary, Judge, MAX_CONFLICTS, Number, Region, Report};
use tilescope_core::{Stage, Summary};
use tilescope_gpu::Backend;

use crate::facts::Facts;

/// Prints text. A closed pipe is no error: its reader wanted no more, and the exit code is that of the work.
pub fn emit(text: &str) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    let written = std::io::Write::write_all(&mut out, text.as_bytes())
        .and_then(|()| std::io::Write::flush(&mut out));
    match written {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}

/// Prints a line to standard error. A failure to do so is ignored, as there is nowhere to report it.
pub fn note(line: &str) {
    let _ = std::io::Write::write_all(&mut std::io::stderr(), format!("{line}\n").as_bytes());
}

/// Prints an object, or the text that says the same.
pub fn report(
    as_json: bool,
    object: impl FnOnce() -> Value,
    text: impl FnOnce() -> String,
) -> anyhow::Result<()> {
    emit(&if as_json {
        format!("{}\n", object())
    } else {
        text()
    })
}

/// A set that was made, and what became of it.
pub struct Outcome {
    pub facts: Facts,
    pub count: u64,
    /// `None` if it was not verified.
    pub report: Option<Report>,
    /// The certificate, if the set was saved with one.
    pub certificate: Option<PathBuf>,
    pub warnings: Vec<String>,
}

impl Outcome {
    /// Returns the exit code; a set without a verdict has no negative one.
    pub fn code(&self) -> u8 {
        crate::verdict_code(self.report.as_ref().is_none_or(Report::valid))
    }

    /// Returns what there is to say of the set as an object.
    pub fn json(&self) -> Value {
        let facts = &self.facts;
        let seconds = facts.seconds.iter();
        let seconds = seconds.map(|(stage, s)| json!({ "stage": stage.to_string(), "seconds": s }));
        let mut object = json!({
            "method": facts.method,
            "parameters": facts.parameters,
            "radius": facts.radius,
            "seconds": seconds.collect::<Vec<Value>>(),
            "certificate": self.certificate.as_ref().map(|path| path.display().to_string()),
            "warnings": self.warnings,
        });
        match &self.report {
            Some(report) => add(&mut object, verdict_json(report)),
            None => add(
                &mut object,
                json!({ "count": self.count, "verified": false }),
            ),
        }
        if let Some(backend) = &facts.backend {
            object["engine"] = json!(backend.engine.name());
            object["engine_reason"] = json!(backend.reason);
        }
        if let Some(s) = &facts.summary {
            add(
                &mut object,
                json!({
                    "blocks": s.blocks,
                    "tiled": s.tiled,
                    "dropped": s.dropped,
                    "eliminated": s.eliminated,
                    "iterations": s.inserted.len(),
                    "inserted": s.inserted,
                }),
            );
        }
        object
    }

    /// Returns what there is to say of the set as text: stages, verdict, file.
    pub fn text(&self) -> String {
        let facts = &self.facts;
        let (region, radius) = (region_text(&facts.region), Number(facts.radius));
        let mut out = format!("{} on {region}, r = {radius}\n", facts.method);
        if let Some(Backend { engine, reason, .. }) = &facts.backend {
            let _ = writeln!(out, "engine         {}: {reason}", engine.name());
        }
        let stages = stage_table(facts.summary.as_ref(), &facts.seconds);
        let verdict = self.report.as_ref().map_or_else(
            || {
                format!(
                    "samples        {}\nverdict        none: not verified\n",
                    self.count
                )
            },
            verdict_text,
        );
        let _ = write!(out, "\n{stages}\n{verdict}");
        out.extend(self.warnings.iter().map(|warning| warning_line(warning)));
        if let Some(path) = &self.certificate {
            let _ = writeln!(out, "certificate    {}", path.display());
        }
        out
    }
}

/// Adds the fields of one object to another.
pub fn add(object: &mut Value, fields: Value) {
    if let (Value::Object(object), Value::Object(fields)) = (object, fields) {
        object.extend(fields);
    }
}

/// Returns the fields of a verdict, lengths in radii where the name says so.
pub fn verdict_json(report: &Report) -> Value {
    // Numbers that are not finite are null in JSON.
    json!({
        "count": report.count,
        "density": report.density,
        "min_distance_r": report.min_distance / report.radius,
        "covering_radius_r": report.covering_radius / report.radius,
        "relative_radius": report.relative_radius,
        "covering_tolerance": report.covering_tolerance,
        "conflicts": report.conflicts,
        "more_conflicts": report.more_conflicts(),
        "gaps": report.gaps,
        "conflict_free": report.conflict_free(),
        "maximal": report.maximal(),
        "valid": report.valid(),
        "judges": report.judges,
    })
}

/// Returns the line of a warning, or of a note.
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
    let (width, height) = (Number(region.width), Number(region.height));
    format!("{width} x {height}, {boundary}")
}

/// Returns a table: a row a stage, with what it did and how long it took.
fn stage_table(summary: Option<&Summary>, seconds: &[(Stage, f64)]) -> String {
    let mut out = String::new();
    let mut rest = 0.0;
    // Algorithm 4 as printed has no separate iteration 1.
    let at_once = !seconds.iter().any(|&(stage, _)| stage == Stage::Iterate(1));
    for &(stage, time) in seconds {
        // The reference sampler ends in many levels that fill a handful of slivers.
        if matches!(stage, Stage::Iterate(_)) && summary.is_none() {
            rest += time;
            continue;
        }
        let did = summary.map(|summary| what_happened(stage, summary, at_once));
        let (name, did) = (stage.to_string(), did.unwrap_or_default());
        let _ = writeln!(out, "  {name:<12} {:>9.1} ms   {did}", time * 1e3);
    }
    if rest > 0.0 {
        let _ = writeln!(out, "  {:<12} {:>9.1} ms", "throw darts", rest * 1e3);
    }
    out
}

fn what_happened(stage: Stage, s: &Summary, at_once: bool) -> String {
    let dropped = |text: &str| match s.dropped {
        0 => String::new(),
        count => text.replace('#', &count.to_string()),
    };
    match stage {
        Stage::Pattern => String::new(),
        Stage::Blocks if s.blocks == 1 => "1 building block".to_owned(),
        Stage::Blocks => format!("{} building blocks", s.blocks),
        Stage::Tile => format!("{} samples{}", s.tiled, dropped(", # more outside dropped")),
        Stage::Eliminate if at_once => {
            let first = s.inserted.first().copied().unwrap_or(0);
            format!("{} eliminated, {first} inserted at once", s.eliminated)
        }
        Stage::Eliminate => format!("{} eliminated", s.eliminated),
        Stage::Iterate(k) => match s.inserted.get(k as usize - 1) {
            Some(n) => format!("{n} inserted"),
            None => "no gap is left".to_owned(),
        },
        Stage::Regions => {
            let inserted: Vec<String> = s.inserted.iter().map(ToString::to_string).collect();
            format!(
                "{} building blocks, {} samples tiled{}, {} eliminated, {} inserted",
                s.blocks,
                s.tiled,
                dropped(" and # dropped outside"),
                s.eliminated,
                inserted.join(" + ")
            )
        }
        Stage::Finish => format!("{} samples in canonical order", s.count),
    }
}

/// Returns the verdict in a few lines.
pub fn verdict_text(report: &Report) -> String {
    let r = report.radius;
    let mut out = format!(
        "samples        {}\n\
         density        {:.4} N r^2 / area\n\
         conflict-free  {}   min distance {:.9} r\n\
         maximal        {}   covering radius {:.9} r, at most {:.9} r\n\
         verified by    {}\n",
        report.count,
        report.density,
        conflicts_answer(report.conflicts),
        report.min_distance / r,
        answer(report.maximal(), report.gaps),
        report.covering_radius / r,
        1.0 + report.covering_tolerance,
        Judge::joined(&report.judges)
    );
    for conflict in report.worst_conflicts.iter().take(3) {
        let (first, second, apart) = (conflict.first, conflict.second, conflict.distance / r);
        let _ = writeln!(
            out,
            "  conflict: samples {first} and {second}, {apart:.6} r apart"
        );
    }
    let gaps = report.worst_gaps.iter().take(3);
    for gap in gaps.filter(|_| !report.maximal()) {
        let ([x, y], far) = (gap.center, gap.distance / r);
        let _ = writeln!(
            out,
            "  gap: ({x}, {y}) is {far:.6} r from the nearest sample"
        );
    }
    let verdict = validity(report.valid());
    let _ = writeln!(out, "verdict        {verdict}");
    out
}

pub const fn validity(valid: bool) -> &'static str {
    if valid { "valid" } else { "NOT VALID" }
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
