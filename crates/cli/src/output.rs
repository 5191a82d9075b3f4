//! The output of commands: text for people, one JSON object for programs.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use tilescope_analysis::{
    Boundary, Judge, MAX_CONFLICTS, Number, Region, Report, shown, shown_in_line,
};
use tilescope_core::{Stage, Summary};
use tilescope_formats::{
    Certificate, CertificateDifference, CertifiedLevel, CertifiedRadius, CertifiedShape,
    VaryingDomain, Warning, is_valid,
};
use tilescope_gpu::Backend;
use tilescope_sets::Facts;

use crate::options::SetArguments;
use crate::paths::named;
use crate::progress::Stopwatch;

/// Prints text. A closed pipe is no error: its reader needs no more, and the exit code is that of the work.
///
/// Words in the text may come from files of others. Characters that a terminal would obey are printed as escapes.
pub fn emit(text: &str) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    let written = std::io::Write::write_all(&mut out, shown(text).as_bytes())
        .and_then(|()| std::io::Write::flush(&mut out));
    match written {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}

/// Prints a line to standard error, with escapes as [`emit`] has them. A failure to do so is ignored, as there is nowhere
/// to report it.
pub fn note(line: &str) {
    let line = format!("{}\n", shown(line));
    let _ = std::io::Write::write_all(&mut std::io::stderr(), line.as_bytes());
}

/// Prints a note if the arguments leave out the certificate of the set in a file.
pub fn note_left_out(set: &SetArguments, file: &Path) {
    if set.no_certificate {
        let file = named(file);
        note(&format!(
            "note: {file}: read without its certificate, so nothing is known of how the set was made"
        ));
    }
}

/// Prints a report, as one JSON object or as text.
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

/// The verdict on a set and its file; nothing, of a set that was not verified.
#[derive(Default)]
pub struct Judged {
    pub report: Option<Report>,
    /// The judged levels, if the set has nested levels.
    pub levels: Vec<CertifiedLevel>,
    /// The certificate, if the set was saved with one.
    pub certificate: Option<PathBuf>,
    pub warnings: Vec<Warning>,
}

/// What it took to make a set.
#[derive(Default)]
pub struct Work {
    /// The engine that computed it, if one was chosen.
    pub backend: Option<Backend>,
    pub seconds: Vec<(Stage, f64)>,
}

impl Work {
    /// Returns work on the CPU for which no engine was chosen.
    pub fn on_cpu(watch: &mut Stopwatch) -> Self {
        Self {
            backend: None,
            seconds: watch.take(),
        }
    }
}

/// A set that was made, with its verdict and its file.
pub struct Outcome {
    pub facts: Facts,
    pub work: Work,
    pub count: u64,
    /// The digest of its positions as they were made, before a file rounds them or has them in another order; `None` where
    /// only a part of them passed by.
    pub positions_digest: Option<String>,
    pub judged: Judged,
    /// Those of the file, and remarks on the run.
    pub warnings: Vec<String>,
}

impl Outcome {
    pub fn new(facts: Facts, work: Work, count: u64, judged: Judged) -> Self {
        let warnings = judged.warnings.iter();
        Self {
            facts,
            work,
            count,
            positions_digest: None,
            warnings: warnings.map(ToString::to_string).collect(),
            judged,
        }
    }

    /// Returns the outcome with the digest of the positions.
    pub fn with_digest(self, digest: String) -> Self {
        Self {
            positions_digest: Some(digest),
            ..self
        }
    }

    /// Returns the exit code; a set without a verdict has no negative one.
    pub fn code(&self) -> u8 {
        let Judged { report, levels, .. } = &self.judged;
        let is_valid = |report| is_valid(report, levels);
        crate::verdict_code(report.as_ref().is_none_or(is_valid))
    }

    /// Returns the facts and the verdict as an object. Its `radius` is the least one where the radius varies. It has
    /// `verified`, which is `false`, in the place of a verdict if there is none.
    pub fn json(&self) -> Value {
        let (facts, judged) = (&self.facts, &self.judged);
        let seconds = (self.work.seconds.iter())
            .map(|(stage, s)| json!({ "stage": stage.to_string(), "seconds": s }));

        let mut object = json!({
            "method": facts.method,
            "parameters": facts.parameters,
            "radius": facts.radius,
            "seconds": seconds.collect::<Vec<Value>>(),
            "positions_digest": self.positions_digest,
            "certificate": judged.certificate.as_ref().map(|path| path.display().to_string()),
            "warnings": self.warnings,
        });
        if let Some(summary) = &facts.summary {
            add(&mut object, json!(summary));
            object["iterations"] = json!(summary.inserted.len());
        }

        let verdict = match &judged.report {
            Some(report) => verdict_json(report),
            None => json!({ "count": self.count, "verified": false }),
        };
        add(&mut object, verdict);
        // What only some sets have is left out of the objects of others.
        if !judged.levels.is_empty() {
            object["levels"] = json!(judged.levels);
        }
        if let Some(backend) = &self.work.backend {
            object["engine"] = json!(backend.engine.name());
            object["engine_reason"] = json!(backend.reason);
        }
        object
    }

    /// Returns the facts and the verdict as text: stages, verdict, file.
    pub fn text(&self) -> String {
        let (facts, judged) = (&self.facts, &self.judged);
        let region = region_text(&facts.region);
        let varying = facts.varying.as_deref().map(ground_text);
        let radius = varying.unwrap_or_else(|| Number(facts.radius).to_string());

        let mut out = format!("{} on {region}, r = {radius}\n", facts.method);
        // Where an engine was chosen, as for KDRT, its name and the reason for the choice.
        if let Some(Backend { engine, reason, .. }) = &self.work.backend {
            let _ = writeln!(out, "engine         {}: {reason}", engine.name());
        }

        let stages = stage_table(facts, &self.work.seconds);
        let count = self.count;
        let verdict = match &judged.report {
            Some(report) => verdict_text(report, &judged.levels),
            None => format!("samples        {count}\nverdict        none: not verified\n"),
        };
        let _ = write!(out, "\n{stages}\n{verdict}");
        out.extend(self.warnings.iter().map(|warning| warning_line(warning)));
        if let Some(path) = &judged.certificate {
            let _ = writeln!(out, "certificate    {}", named(path));
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

/// Returns the fields of a verdict. Lengths are in radii if the name ends in `_r`; where the radius varies, in the
/// least one, which is that of the report.
pub fn verdict_json(report: &Report) -> Value {
    // JSON has null for numbers that are not finite.
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
        "covering_factor": report.covering_factor,
        "valid": report.valid(),
        "judges": report.judges,
    })
}

/// Returns the lines on a certificate: whether it is true, and what of it no check compares; or that there is none.
pub fn certificate_text(
    certificate: Option<&Certificate>,
    differences: &[CertificateDifference],
) -> String {
    let Some(certificate) = certificate else {
        return "certificate    none\n".to_owned();
    };
    if differences.is_empty() {
        let keys = certificate.unchecked().join(", ");
        let unchecked = shown_in_line(&keys);
        return format!("certificate    true\n  stated only: {unchecked}\n");
    }

    let mut out = "certificate    NOT TRUE\n".to_owned();
    for d in differences {
        let [stated, found] = [&d.stated, &d.found].map(|value| shown_in_line(value));
        let _ = writeln!(out, "  {}: stated {stated}, found {found}", d.field);
    }
    out
}

/// Returns the line of a warning, or of a note.
pub fn warning_line(warning: &str) -> String {
    let is_note = warning.starts_with("note: ");
    format!("{}{warning}\n", if is_note { "" } else { "warning: " })
}

/// Returns "0.01", "0.01 to 0.2, a field", or "0.01 to 0.2, the column radius".
pub fn radius_text(radius: &CertifiedRadius) -> String {
    match radius {
        CertifiedRadius::Constant(radius) => Number(*radius).to_string(),
        CertifiedRadius::Field(field) => {
            format!(
                "{} to {}, a field",
                Number(field.least),
                Number(field.greatest)
            )
        }
        CertifiedRadius::Column(column) => {
            format!(
                "{} to {}, the column {}",
                Number(column.least),
                Number(column.greatest),
                shown_in_line(&column.column)
            )
        }
    }
}

/// Returns "0.01 to 0.2, a field, in a polygon of 2 rings with 9 corners": the radius, for a field the least and the greatest
/// one, and the shape, if there is one.
pub fn ground_text(varying: &VaryingDomain) -> String {
    let radius = radius_text(&varying.radius);
    match &varying.shape {
        None => radius,
        Some(CertifiedShape::Polygon { rings }) => {
            let corners: usize = rings.iter().map(Vec::len).sum();
            let rings = counted(rings.len(), "ring");
            format!("{radius}, in a polygon of {rings} with {corners} corners")
        }
        Some(CertifiedShape::Mask { pitch, .. }) => {
            format!("{radius}, in a mask with pixels of {}", Number(*pitch))
        }
    }
}

/// Returns "1 ring" or "2 rings".
fn counted(count: usize, what: &str) -> String {
    let ending = if count == 1 { "" } else { "s" };
    format!("{count} {what}{ending}")
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

/// Returns a table with a row for each stage: its time and its effect.
fn stage_table(facts: &Facts, seconds: &[(Stage, f64)]) -> String {
    let mut out = String::new();
    let mut dart_seconds = 0.0;
    let summary = facts.summary.as_ref();
    // The reference sampler, which has no summary, and exact tiling end in many levels that fill a handful of slivers: all
    // levels share a row.
    let levels_share_row = summary.is_none() || facts.method == "exact";

    let names = Names::of(facts.method);

    // Algorithm 4 as printed fills the first gaps while it eliminates, and has no separate iteration 1. Sets that are
    // made by regions have no iteration 1 either, but none of their rows uses this value.
    let at_once = !seconds.iter().any(|&(stage, _)| stage == Stage::Iterate(1));
    for &(stage, time) in seconds {
        if matches!(stage, Stage::Iterate(_)) && levels_share_row {
            dart_seconds += time;
            continue;
        }
        let did = summary.map(|summary| what_happened(stage, summary, at_once, names));
        let (name, did) = (stage.to_string(), did.unwrap_or_default());
        let _ = writeln!(out, "  {name:<12} {:>9.1} ms   {did}", time * 1e3);
    }

    if dart_seconds > 0.0 {
        // Insertions at once are counted in the row of elimination.
        let inserted = |s: &Summary| s.inserted.iter().skip(at_once.into()).sum::<usize>();
        let did = summary.map(|summary| format!("   {} {}", inserted(summary), names.new));
        let did = did.unwrap_or_default();
        let milliseconds = dart_seconds * 1e3;
        let _ = writeln!(out, "  {:<12} {milliseconds:>9.1} ms{did}", "throw darts");
    }
    out
}

/// What a method calls the samples that go and those that come after tiling.
#[derive(Clone, Copy)]
struct Names {
    lost: &'static str,
    new: &'static str,
}

impl Names {
    /// Returns the names of a method, as certificates name it: exact tiling resolves no conflicts and fills no gaps.
    fn of(method: &str) -> Self {
        if method == "exact" {
            Self {
                lost: "lost",
                new: "that the pattern lacks",
            }
        } else {
            Self {
                lost: "eliminated",
                new: "inserted",
            }
        }
    }
}

/// Returns the effect of a stage in a few words. `at_once` says that the first insertions happened during elimination.
fn what_happened(stage: Stage, s: &Summary, at_once: bool, names: Names) -> String {
    // Samples are dropped only beyond a bounded border: of a periodic domain there is nothing to say.
    let dropped = |text: &str| match s.dropped {
        0 => String::new(),
        count => text.replace('#', &count.to_string()),
    };
    let (blocks, tiled, eliminated) = (s.blocks, s.tiled, s.eliminated);
    let Names { lost, new } = names;

    match stage {
        Stage::Pattern => String::new(),
        Stage::Blocks if blocks == 1 => "1 building block".to_owned(),
        Stage::Blocks => format!("{blocks} building blocks"),
        Stage::Tile => format!("{tiled} samples{}", dropped(", # more outside dropped")),
        Stage::Eliminate if at_once => {
            let first = s.inserted.first().copied().unwrap_or(0);
            format!("{eliminated} {lost}, {first} {new} at once")
        }
        Stage::Eliminate => format!("{eliminated} {lost}"),
        // Iterations are numbered from 1.
        Stage::Iterate(k) => match s.inserted.get(k as usize - 1) {
            Some(n) => format!("{n} {new}"),
            // The last detection finds no gap, so that it has no count.
            None => "no gap is left".to_owned(),
        },
        Stage::Regions => {
            let inserted: Vec<String> = s.inserted.iter().map(ToString::to_string).collect();
            // Without any gap there was no insertion to count.
            let inserted = if inserted.is_empty() {
                "0".to_owned()
            } else {
                inserted.join(" + ")
            };
            let dropped = dropped(" and # dropped outside");
            format!(
                "{blocks} building blocks, {tiled} samples tiled{dropped}, {eliminated} {lost}, {inserted} {new}"
            )
        }
        Stage::Finish => format!("{} samples in canonical order", s.count),
    }
}

/// Returns the verdict in a few lines. Of nested levels each has a row: the promised values and, in brackets, the found
/// ones.
pub fn verdict_text(report: &Report, levels: &[CertifiedLevel]) -> String {
    if !levels.is_empty() {
        let rows: String = levels.iter().map(level_row).collect();
        let valid = validity(is_valid(report, levels));
        return format!(
            "   samples   smallest distance above   covering radius up to\n{rows}verdict        {valid}\n"
        );
    }
    // Subdivision judges sets whose radius varies or that cover a shape. Few of these have one radius that could be the
    // unit of lengths, so that lengths are in the unit of the file.
    if report.judges == [Judge::Subdivision] {
        return subdivision_text(report);
    }

    let (r, count, density) = (report.radius, report.count, report.density);
    let conflict_free = conflicts_answer(report.conflicts);
    let maximal = answer(report.maximal(), report.gaps);
    // Positions are rounded to a lattice, and maximality has a tolerance for it. Squares of lengths on the lattice are whole
    // numbers, 2^30 for r: lengths near r differ by 2^-31 r and more, which about nine decimals show.
    let limit = 1.0 + report.covering_tolerance;
    let (closest, _) = compared(report.min_distance / r, 1.0, 9);
    let (farthest, most) = compared(report.covering_radius / r, limit, 9);
    let judges = Judge::joined(&report.judges);

    let mut out = format!(
        "samples        {count}\n\
         density        {density:.4} N r^2 / area\n\
         conflict-free  {conflict_free}   min distance {closest} r\n\
         maximal        {maximal}   covering radius {farthest} r, at most {most} r\n\
         verified by    {judges}\n"
    );

    // A set may have millions of conflicts; three show the fault.
    for conflict in report.worst_conflicts.iter().take(3) {
        let (a, b) = (conflict.first, conflict.second);
        let apart = match compared(conflict.distance / r, 1.0, 6) {
            // Below r by less than the digits of a quotient can show.
            (distance, one) if distance == one => "less than 1 r apart by rounding".to_owned(),
            (distance, _) => format!("{distance} r apart"),
        };
        let _ = writeln!(out, "  conflict: samples {a} and {b}, {apart}");
    }

    for gap in report.worst_gaps.iter().take(3) {
        let ([x, y], (far, _)) = (gap.center, compared(gap.distance / r, limit, 6));
        let place = format!("({x}, {y}) is {far} r from the nearest sample");
        let _ = writeln!(out, "  gap: {place}");
    }

    let _ = writeln!(out, "verdict        {}", validity(report.valid()));
    out
}

/// Returns the verdict on a set whose radius varies or that covers a shape, with lengths in the unit of the file.
fn subdivision_text(report: &Report) -> String {
    let covers = match report.covering_factor {
        // A set that is the beginning of a larger one has a factor. It is rounded up, so that the sentence is true of
        // every place.
        Some(factor) => format!(
            "prefix         yes   every place is within {:.6} times its radius",
            (factor * 1e6).ceil() / 1e6
        ),
        None => format!("maximal        {}", answer(report.maximal(), report.gaps)),
    };
    // A density is by the area to be covered, where each place counts by its own radius: any maximal set has about 0.70.
    let mut out = format!(
        "samples        {}\n\
         density        {:.4} N r^2 / area that is covered\n\
         conflict-free  {}   min distance {}\n\
         {covers}\n\
         verified by    {}\n",
        report.count,
        report.density,
        conflicts_answer(report.conflicts),
        Number(report.min_distance),
        Judge::joined(&report.judges),
    );

    // Three of each show the fault.
    for conflict in report.worst_conflicts.iter().take(3) {
        let (a, b, apart) = (conflict.first, conflict.second, Number(conflict.distance));
        let _ = writeln!(out, "  conflict: samples {a} and {b}, {apart} apart");
    }
    for gap in report.worst_gaps.iter().take(3) {
        let ([x, y], far) = (gap.center, Number(gap.distance));
        let _ = writeln!(out, "  gap: ({x}, {y}) is {far} from the nearest sample");
    }
    let _ = writeln!(out, "verdict        {}", validity(report.valid()));
    out
}

/// Returns the row of a level.
pub fn level_row(level: &CertifiedLevel) -> String {
    // A single point is infinitely far from a second one.
    let found = level.min_distance.unwrap_or(f64::INFINITY);
    let (closest, promised_distance) = compared(found, level.distance, 6);

    // Where no covering is promised, a dash stands for the promise; compared with itself, the measured one has six decimals.
    let measured = level.covering_radius;
    let (farthest, covering) = compared(measured, level.covering.unwrap_or(measured), 6);
    let promised_covering = (level.covering).map_or_else(|| "-".to_owned(), |_| covering);

    format!(
        "  {:>8}   {promised_distance} ({closest})   {promised_covering} ({farthest})   {}\n",
        level.count,
        validity(level.valid)
    )
}

/// Returns a value and the limit that it is compared with, with `decimals` decimals or as many more as show on which side of
/// the limit the value lies.
pub fn compared(value: f64, limit: f64, decimals: usize) -> (String, String) {
    let texts = |decimals| (format!("{value:.decimals$}"), format!("{limit:.decimals$}"));
    let shown = |text: &str| text.parse::<f64>().ok();
    // The texts have to compare as the numbers do: below the limit, equal to it, or above.
    let shows = |(value_text, limit_text): &(String, String)| {
        shown(value_text).partial_cmp(&shown(limit_text)) == Some(value).partial_cmp(&Some(limit))
    };
    // Lengths are in radii, near 1; of two that differ by rounding, the 17th decimal differs. Tiny ones, which no number of
    // decimals tells apart, are written with exponents.
    let mut all = (decimals..=17).map(texts);
    all.find(shows)
        .unwrap_or_else(|| (format!("{value:e}"), format!("{limit:e}")))
}

pub const fn validity(valid: bool) -> &'static str {
    if valid { "valid" } else { "NOT VALID" }
}

pub fn answer(yes: bool, count: u64) -> String {
    if yes {
        return "yes".to_owned();
    }
    format!("NO, {count}")
}

/// Returns the answer about conflicts, which are counted up to a limit.
pub fn conflicts_answer(count: u64) -> String {
    let is_limit = count >= MAX_CONFLICTS;
    answer(count == 0, count) + if is_limit { " or more" } else { "" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_tiling_has_words_of_its_own() {
        let summary = Summary {
            blocks: 4,
            tiled: 700,
            dropped: 0,
            eliminated: 60,
            inserted: vec![30, 12],
            count: 682,
        };
        let did = |method| what_happened(Stage::Regions, &summary, false, Names::of(method));
        let tiled = "4 building blocks, 700 samples tiled, ";
        assert_eq!(
            did("exact"),
            format!("{tiled}60 lost, 30 + 12 that the pattern lacks")
        );
        // Negative control: KDRT keeps the paper's words.
        assert_eq!(
            did("kdrt"),
            format!("{tiled}60 eliminated, 30 + 12 inserted")
        );
    }

    #[test]
    fn a_value_beside_a_limit_has_the_digits_that_show_its_side() {
        let pair = |value, limit| compared(value, limit, 6);
        let texts = |value: &str, limit: &str| (value.to_owned(), limit.to_owned());
        assert_eq!(pair(0.5, 1.0), texts("0.500000", "1.000000"));
        assert_eq!(pair(1.0, 1.0), texts("1.000000", "1.000000"));
        assert_eq!(pair(1.0 - 4e-9, 1.0), texts("0.999999996", "1.000000000"));
        assert_eq!(
            pair(1.0_f64.next_down(), 1.0),
            texts("0.9999999999999999", "1.0000000000000000")
        );
        let limit = 1.0 + 2.0_f64.powi(-15);
        for value in [limit.next_up(), limit.next_down()] {
            let (value_text, limit_text) = pair(value, limit);
            assert_ne!(value_text, limit_text);
        }
        assert_eq!(pair(f64::INFINITY, 1.0).0, "inf");
        let tiny = 1e-30_f64;
        assert_ne!(pair(tiny.next_up(), tiny).0, pair(tiny.next_up(), tiny).1);
    }
}
