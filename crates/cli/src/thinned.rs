//! Verifying a thinned set: alone, and against the points from which it was chosen. [`space`] has those in space.

pub mod space;

use std::fmt::Write;
use std::path::Path;

use anyhow::{Result, bail};
use serde_json::json;
use tilescope_analysis::{ThinnedReport, shown_in_line};
use tilescope_formats::{
    Certificate, CertificateDifference, CertificateUse, Depth, Hint, Thinned, implied_kept,
    in_space, keep_rows, read_whole,
};
use tilescope_sets::GivenRadius;
use tilescope_sets::thinning::{PointFile, ThinFileError, ThinRecipe};

use crate::ground::{GroundArguments, file_name};
use crate::options::{SetArguments, columns, is_by_x_and_y, refuse_stated};
use crate::paths::InFile;
use crate::progress::verifying;
use crate::solid::box_text;
use crate::thin::{COLUMNS, SET, report_json, report_text};
use crate::{output, verdict_code};

/// Verifies a set whose certificate states that it was chosen from another one, and prints the verdict. Without a
/// `source` only the set itself is judged. Of the ground only the radius is used: a thinned set has no shape.
pub fn run(
    path: &Path,
    set: &SetArguments,
    ground: &GroundArguments,
    source: Option<&Path>,
    as_json: bool,
) -> Result<u8> {
    let certificate = set.certificate(path)?;
    let thinned = certificate
        .as_ref()
        .and_then(|stated| stated.thinned.as_ref());
    let (Some(stated), Some(thinned)) = (&certificate, thinned) else {
        // Without a source the caller has found that the set was thinned.
        bail!("--source is for sets whose certificate states that they were thinned");
    };
    // The points were chosen by the certificate's own values: the choice cannot be judged by other ones.
    refuse_others(set, ground)?;

    let findings = verdict(
        path,
        set,
        ground.given(set.planar)?.radius,
        source,
        stated,
        thinned,
    )?;
    output::report(
        as_json,
        || findings.json(thinned),
        || findings.text(stated, thinned),
    )?;
    Ok(verdict_code(findings.passed()))
}

/// Refuses arguments that would describe another set than the certificate, or that no thinned set has. What a radius
/// follows from is not refused: an image is not in the certificate, and has to be given.
fn refuse_others(set: &SetArguments, ground: &GroundArguments) -> Result<()> {
    // The end of the messages: the certificate states values by which the points were chosen.
    let whose = "by which the points were chosen";
    set.refuse_domain(whose)?;
    let placed = [
        ("--depth", set.depth.is_some()),
        ("--origin", set.origin.is_some()),
        ("--origin-z", set.origin_z.is_some()),
    ];
    refuse_stated(&placed, whose)?;

    let shapes = [
        ("--shape", ground.shape.is_some()),
        ("--mask", ground.mask.is_some()),
    ];
    match shapes.into_iter().find(|(_, is_given)| *is_given) {
        Some((name, _)) => bail!("a thinned set has no shape; leave {name} out"),
        None => Ok(()),
    }
}

/// The findings of the judge, as text or as data.
struct Verdict {
    report: ThinnedReport,
    differences: Vec<CertificateDifference>,
    has_source: bool,
}

/// Reads the set and, if it is given, its source, and judges them.
fn verdict(
    path: &Path,
    set: &SetArguments,
    radius: GivenRadius,
    source: Option<&Path>,
    stated: &Certificate,
    thinned: &Thinned,
) -> Result<Verdict> {
    // The certificate says how the file is read, unless the arguments do.
    let as_stated: Option<Vec<String>> = (stated.parameters.get(COLUMNS))
        .and_then(|names| serde_json::from_value(names.clone()).ok());
    let (bytes, name) = (read_whole(path)?, file_name(path));
    // The reader leaves the certificate out: it is about the choice of points, which one file alone cannot show. It is
    // compared below.
    let hint = Hint {
        name: &name,
        format: set.format,
        columns: columns(set.columns.as_deref().or(as_stated.as_deref())),
        certificate: CertificateUse::LeftOut,
        any_z: is_by_x_and_y(stated),
        ..Hint::default()
    };
    let chosen = PointFile::new(&bytes, hint).in_file(path)?;
    let recipe = ThinRecipe::of_certificate(stated, thinned, radius).in_file(path)?;

    // Without the source all points of the file are kept ones, and none is left that could be uncovered.
    let Some(source) = source else {
        return alone(&chosen, &recipe, stated, thinned).in_file(path);
    };
    let (source_bytes, source_name) = (read_whole(source)?, file_name(source));
    // A source may have several sets. The certificate states which of them was thinned. Format and columns are those of
    // the chosen set, whose rows are copies.
    let of_set = stated
        .parameters
        .get(SET)
        .and_then(serde_json::Value::as_u64);
    let source_hint = Hint {
        name: &source_name,
        set: set.set.or(of_set.map(|index| index as usize)),
        ..hint
    };
    let given = PointFile::new(&source_bytes, source_hint).in_file(source)?;
    against((path, &chosen), (source, &given), &recipe, stated)
}

/// Judges what can be judged without the points that were given: the file, and that no two of its points are near.
fn alone(
    chosen: &PointFile<'_>,
    recipe: &ThinRecipe,
    stated: &Certificate,
    thinned: &Thinned,
) -> Result<Verdict, ThinFileError> {
    // Which point came first decides only about points that are left out, and here there are none.
    let with_ranks = false;
    let thinning = recipe.prepare(chosen, with_ranks)?;
    let all = vec![true; chosen.points().len()];
    let judged = verifying(|control| thinning.judge(chosen.points(), &all, control))?;
    // What only the source could show is taken as stated, and the report says so.
    let report = ThinnedReport {
        given: thinned.given,
        uncovered: stated.gaps,
        ..judged
    };

    // The certificate is made anew, and every number compared.
    let made = thinning.certificate_of(chosen, &report, thinned.source.clone(), thinned.given)?;
    Ok(Verdict {
        differences: stated.thinned_differences(&made),
        report,
        has_source: false,
    })
}

/// Judges the choice from the points that were given. Both files come with their paths, which errors about them name.
fn against(
    (path, chosen): (&Path, &PointFile<'_>),
    (source, given): (&Path, &PointFile<'_>),
    recipe: &ThinRecipe,
    stated: &Certificate,
) -> Result<Verdict> {
    let with_ranks = true;
    let thinning = recipe.prepare(given, with_ranks).in_file(source)?;
    let points = given.points();
    let mut differences = Vec::new();
    let implied = implied_kept(points, chosen.points(), thinning.ranks());
    // A point that is not one of the source is a finding. Which points were kept is then not known, and the judge takes
    // none as kept: the report still states how many were given.
    let kept = implied.unwrap_or_else(|index| {
        differences.push(stranger(index, &chosen.points()[index]));
        vec![false; points.len()]
    });

    // Other columns, and the order of the rows, are compared as bytes; not after the finding above, where no point
    // counts as kept.
    if differences.is_empty() {
        let rows = keep_rows(given.bytes, &given.hint, &kept).in_file(source)?;
        if rows.bytes != chosen.bytes {
            differences.push(other_rows());
        }
    }

    // The certificate is made anew, and every number compared.
    let report = verifying(|control| thinning.judge(points, &kept, control))
        .map_err(ThinFileError::from)
        .in_file(source)?;
    // If the radii are in a column, a certificate states those of the chosen file, and not those of the source.
    let made = thinning
        .certificate(points, chosen, &report)
        .in_file(path)?;
    differences.extend(stated.thinned_differences(&made));
    Ok(Verdict {
        report,
        differences,
        has_source: true,
    })
}

/// Returns the finding that a point of a file is none of its source.
fn stranger(index: usize, point: &[f64]) -> CertificateDifference {
    let place: Vec<String> = point.iter().map(f64::to_string).collect();
    CertificateDifference {
        field: "points",
        stated: "points of the source, each once".to_owned(),
        found: format!(
            "point {index} at ({}), which is none of those left",
            place.join(", ")
        ),
    }
}

/// Returns the finding that the rows of a file are not those of its source.
fn other_rows() -> CertificateDifference {
    CertificateDifference {
        field: "rows",
        stated: "rows of the source, unchanged".to_owned(),
        found: "other bytes".to_owned(),
    }
}

impl Verdict {
    fn passed(&self) -> bool {
        self.report.valid() && self.differences.is_empty()
    }

    fn json(&self, thinned: &Thinned) -> serde_json::Value {
        let mut object = json!({
            "priority": thinned.priority,
            "source": self.has_source,
            "differences": self.differences,
            "passed": self.passed(),
        });
        output::add(&mut object, report_json(&self.report));
        // Without the source this was not judged.
        if !self.has_source {
            object["uncovered"] = json!(null);
        }
        object
    }

    /// Returns the verdict in lines.
    fn text(&self, stated: &Certificate, thinned: &Thinned) -> String {
        let region = match stated.depth {
            None => output::region_text(&stated.region),
            Some(Depth(depth)) => box_text(&in_space(stated.region, depth)),
        };
        let radius = output::radius_text(&stated.radius);
        let priority = shown_in_line(&thinned.priority);
        let mut out = format!("thinned to r = {radius} on {region}, taken by: {priority}\n\n");
        let judged = if self.has_source {
            report_text(&self.report)
        } else {
            format!(
                "given          {}, as stated\n\
                 kept           {}\n\
                 conflict-free  {}\n\
                 covering       not judged: --source FILE has the points that were given\n\
                 verdict        {}\n",
                self.report.given,
                self.report.kept,
                output::conflicts_answer(self.report.conflicts),
                if self.report.conflicts == 0 {
                    "conflict-free"
                } else {
                    "NOT VALID"
                },
            )
        };
        out += &judged;

        if self.differences.is_empty() {
            let keys = stated.unchecked();
            let unchecked = shown_in_line(&keys.join(", ")).into_owned();
            // These fields of the certificate are about the source.
            let of_source = if self.has_source {
                ""
            } else {
                "thinned.source, thinned.given, gaps, "
            };
            let _ = writeln!(
                out,
                "certificate    true\n  stated only: {of_source}{unchecked}"
            );
        } else {
            out += "certificate    NOT TRUE\n";
            for it in &self.differences {
                let [stated, found] = [&it.stated, &it.found].map(|value| shown_in_line(value));
                let _ = writeln!(out, "  {}: stated {stated}, found {found}", it.field);
            }
        }
        out
    }
}
