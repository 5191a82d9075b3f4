//! Verifying a thinned set in space: alone, and against the points from which it was chosen.

use std::path::Path;

use anyhow::{Result, bail};
use tilescope_analysis::{SolidRegion, ThinnedReport};
use tilescope_formats::{
    Certificate, CertificateDifference, CertificateUse, Depth, Hint, Thinned, implied_kept,
    in_space, keep_rows, read_whole, solid_certificate,
};
use tilescope_sets::thinning::{SpaceFile, SpaceRecipe, SpaceThinning, ThinFileError};

use crate::ground::{GroundArguments, file_name};
use crate::options::SetArguments;
use crate::paths::InFile;
use crate::progress::verifying;
use crate::solid::box_text;
use crate::thin::SET;
use crate::{output, verdict_code};

use super::{Verdict, other_rows, refuse_others, stranger};

/// Returns the certificate beside a file if it states that its points in space were chosen from others.
pub fn certificate(set: &SetArguments, file: &Path) -> Option<Certificate> {
    solid_certificate(file).filter(|stated| !set.no_certificate && stated.thinned.is_some())
}

/// Verifies a set whose certificate states that it was chosen from another one in space, and prints the verdict. Without a
/// `source` only the set itself is judged.
pub fn run(
    path: &Path,
    set: &SetArguments,
    ground: &GroundArguments,
    source: Option<&Path>,
    stated: &Certificate,
    as_json: bool,
) -> Result<u8> {
    refuse_others(set, ground)?;
    let (Some(thinned), Some(Depth(depth))) = (&stated.thinned, stated.depth) else {
        bail!("the certificate states no thinned set in space");
    };
    if let Some(name) = ground.option() {
        bail!(
            "{name}: points in space have one radius, which the certificate states; leave it out"
        );
    }
    let judged = SpaceJudge {
        stated,
        thinned,
        recipe: SpaceRecipe::of_certificate(stated, thinned).in_file(path)?,
        region: in_space(stated.region, depth),
    };

    let (bytes, name) = (read_whole(path)?, file_name(path));
    let hint = Hint {
        name: &name,
        format: set.format,
        // The certificate is about the choice of points, which one file alone cannot show. It is compared below.
        certificate: CertificateUse::LeftOut,
        ..Hint::default()
    };
    let chosen = SpaceFile::new(&bytes, hint).in_file(path)?;
    let findings = match source {
        None => judged.alone(&chosen).in_file(path)?,
        Some(source) => {
            let (bytes, name) = (read_whole(source)?, file_name(source));
            // A source may have several sets. The certificate states which of them was thinned.
            let of_set = stated
                .parameters
                .get(SET)
                .and_then(serde_json::Value::as_u64);
            let hint = Hint {
                name: &name,
                set: set.set.or(of_set.map(|index| index as usize)),
                ..hint
            };
            let given = SpaceFile::new(&bytes, hint).in_file(source)?;
            judged.against(&chosen, &given).in_file(source)?
        }
    };

    output::report(
        as_json,
        || findings.json(thinned),
        || findings.text(stated, thinned),
    )?;
    Ok(verdict_code(findings.passed()))
}

/// What a thinned set in space is judged by.
struct SpaceJudge<'a> {
    stated: &'a Certificate,
    thinned: &'a Thinned,
    recipe: SpaceRecipe,
    region: SolidRegion,
}

impl SpaceJudge<'_> {
    /// Judges what can be judged without the points that were given: the file, and that no two of its points are near.
    fn alone(&self, chosen: &SpaceFile<'_>) -> Result<Verdict, ThinFileError> {
        // Which point came first decides only about points that are left out, and here there are none.
        let with_ranks = false;
        let thinning = self.recipe.prepare(chosen, Some(self.region), with_ranks)?;
        let points = chosen.points();
        let all = vec![true; points.len()];
        let judged = verifying(|control| thinning.judge(points, &all, control))?;
        // What only the source could show is taken as stated, and the report says so.
        let report = ThinnedReport {
            given: self.thinned.given,
            uncovered: self.stated.gaps,
            ..judged
        };

        // The certificate is made anew, and every number compared.
        let (source, given) = (self.thinned.source.clone(), self.thinned.given);
        let made = thinning.certificate_of(chosen, &report, source, given);
        let mut differences = self.stated.thinned_differences(&made);
        differences.extend(self.too_small_box(&thinning, points));
        Ok(Verdict {
            differences,
            report,
            has_source: false,
        })
    }

    /// Judges the choice from the points that were given.
    fn against(
        &self,
        chosen: &SpaceFile<'_>,
        given: &SpaceFile<'_>,
    ) -> Result<Verdict, ThinFileError> {
        // Of several points given at one place only the one of the least rank can have been kept.
        let with_ranks = true;
        let thinning = self.recipe.prepare(given, Some(self.region), with_ranks)?;
        let points = given.points();
        let mut differences: Vec<CertificateDifference> = Vec::new();
        // If the file has a point that is not one of those given, or one twice, it is no choice from them: then none at
        // all counts as kept.
        let kept =
            implied_kept(points, chosen.points(), thinning.ranks()).unwrap_or_else(|index| {
                differences.push(stranger(index, &chosen.points()[index]));
                vec![false; points.len()]
            });
        if differences.is_empty()
            && keep_rows(given.bytes, &given.hint, &kept)?.bytes != chosen.bytes
        {
            differences.push(other_rows());
        }

        let report = verifying(|control| thinning.judge(points, &kept, control))?;
        let made = thinning.certificate(points, chosen, &report);
        differences.extend(self.stated.thinned_differences(&made));
        differences.extend(self.too_small_box(&thinning, points));
        Ok(Verdict {
            report,
            differences,
            has_source: true,
        })
    }

    /// Returns the finding that the stated box does not hold some points, if it is so. A larger box holds them, too.
    fn too_small_box(
        &self,
        thinning: &SpaceThinning,
        points: &[[f64; 3]],
    ) -> Option<CertificateDifference> {
        (!thinning.has_room_for(points)).then(|| CertificateDifference {
            field: "region",
            stated: box_text(&self.region),
            found: "points that reach over more".to_owned(),
        })
    }
}
