//! Ranks of the samples of nested levels: `tilescope verify --rank`, and `convert` with `--rank` and `--rank-image`.

use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use serde_json::json;
use tilescope_analysis::{PrefixClaim, RankedSet, VerifyOptions, verify, verify_ranks};
use tilescope_formats::{
    Certificate, CertificateUse, CertifiedLevel, ExportContext, Format, Hint, PointSet, ReadSet,
    read_ranks, read_whole,
};
use tilescope_sets::{GrayImage, Stated};

use crate::ground::{GroundArguments, file_name, image};
use crate::options::SetArguments;
use crate::paths::{InFile, named};
use crate::progress::verifying;
use crate::sample_arguments::{leave_out_origin, save_unverified};
use crate::{output, verdict_code};

/// The name of the column that has the ranks.
const RANK: &str = "rank";

/// Which samples of nested levels `convert` keeps.
#[derive(Clone, Debug, Args)]
pub struct RankArguments {
    /// Of a set with nested levels and their ranks, keep the samples with ranks below T, a number from above 0 to 1: about so
    /// large a share of them, evenly spread. The new file has the levels that are left, and ranks from 0 to 1 again
    #[arg(long, value_name = "T", conflicts_with_all = ["rank_image", "slice", "no_certificate"])]
    pub rank: Option<f64>,
    /// Of such a set, keep the samples with ranks below the darkness of a PNG or JPEG image that covers the domain, 0 for white and 1
    /// for black: as dense as it is dark. No two are closer than the radius of the finest level in use, and no more is
    /// stated: the file has no certificate
    #[arg(long, value_name = "IMAGE", conflicts_with_all = ["slice", "no_certificate"])]
    pub rank_image: Option<std::path::PathBuf>,
}

impl RankArguments {
    /// Returns the name of the option that is given, if one is.
    pub fn option(&self) -> Option<&'static str> {
        let given = [
            ("--rank", self.rank.is_some()),
            ("--rank-image", self.rank_image.is_some()),
        ];
        let mut names = given
            .into_iter()
            .filter_map(|(name, is_given)| is_given.then_some(name));
        names.next()
    }
}

/// Refuses a threshold below which no rank lies, or above which none does.
fn check_threshold(below: f64) -> Result<()> {
    ensure!(
        below > 0.0 && below <= 1.0,
        "--rank is {below}; it must be above 0 and at most 1"
    );
    Ok(())
}

/// Refuses arguments that would describe another set than the certificate, whose levels are judged, or that no set with ranks
/// has.
pub fn refuse_others(set: &SetArguments, ground: &GroundArguments) -> Result<()> {
    set.refuse_domain("to which its levels belong")?;
    ground.refuse("sets with ranks have one radius and no shape")
}

/// Returns the ranks in a file of this format, if it has a column of them.
pub fn of_file(path: &Path, set: &SetArguments, format: Format) -> Result<Option<Vec<f64>>> {
    // A file without columns is not read again to find none.
    if !format.carries_ranks() {
        return Ok(None);
    }
    let columns = set.columns.as_deref();
    // The parser of arguments takes two names or none.
    let columns = columns.and_then(|columns| <&[String; 2]>::try_from(columns).ok());
    let name = file_name(path);
    let hint = Hint {
        name: &name,
        format: set.format,
        columns: columns.map(|columns| columns.each_ref().map(String::as_str)),
        ..Hint::default()
    };
    read_ranks(&read_whole(path)?, &hint).in_file(path)
}

/// A set of nested levels with the ranks of its samples.
struct RankedFile {
    read: ReadSet,
    certificate: Certificate,
    /// The position in the file of the domain's lower corner.
    origin: [f64; 2],
    ranks: Vec<f64>,
    levels: Vec<PrefixClaim>,
}

impl RankedFile {
    /// Reads a set, its certificate and its ranks. Fails if it has no certificate or no levels, or not a rank for each
    /// sample.
    fn read(path: &Path, set: &SetArguments, certificate: CertificateUse) -> Result<Self> {
        let mut read = set.read_as(path, set.set, certificate)?;
        let name = named(path);
        let Some(certificate) = read.certificate.take() else {
            bail!("{name}: there is no certificate, which states the levels of a set");
        };
        let levels = certificate.claims();
        ensure!(
            !levels.is_empty(),
            "{name}: the certificate states no levels, of which samples have ranks"
        );

        let ranks = of_file(path, set, read.detection.format)?.with_context(|| {
            format!("{name}: it has no column {RANK}; csv, ply and geojson files of nested levels have one")
        })?;
        // The certificate's levels are about all samples of the file, so that each has to have a rank.
        ensure!(
            ranks.len() == read.set.len(),
            "{name}: there are {} ranks of {} samples",
            ranks.len(),
            read.set.len()
        );

        // An origin that is given takes the place of the stated one.
        let origin = set.origin().or(certificate.origin);
        Ok(Self {
            read,
            origin: origin.unwrap_or_default(),
            certificate,
            ranks,
            levels,
        })
    }

    /// Returns the set as its judge takes it.
    fn ranked(&self) -> RankedSet<'_> {
        RankedSet {
            points: &self.read.set.points,
            ranks: &self.ranks,
            region: self.certificate.region,
            levels: &self.levels,
            radius: self.certificate.radius.least(),
        }
    }

    /// Returns the samples that are kept, with the ranks that they have.
    fn kept(&self, is_kept: impl Fn(usize) -> bool) -> (PointSet, Vec<f64>) {
        let kept = (0..self.ranks.len()).filter(|&index| is_kept(index));
        let (points, ranks) = kept
            .map(|index| (self.read.set.points[index], self.ranks[index]))
            .unzip();
        (PointSet::from_points(points), ranks)
    }

    /// Returns the statements of a file with some of the samples, which has these levels and this radius. The new
    /// file states a parameter by which the samples were chosen: its name is `chosen_by`, and its value is `value`.
    fn context(
        &self,
        radius: f64,
        levels: Vec<PrefixClaim>,
        ranks: Vec<f64>,
        (chosen_by, value): (&str, serde_json::Value),
    ) -> ExportContext {
        let stated = &self.certificate;
        // The stated parameters make the larger set that these samples were chosen from, and stand under the name `of`.
        let of = json!(stated.parameters);
        let parameters = [(chosen_by.to_owned(), value), ("of".to_owned(), of)];
        ExportContext {
            program: stated.program.clone(),
            program_version: stated.program_version.clone(),
            method: stated.method.clone(),
            parameters: Stated::from(parameters),
            precision: stated.precision,
            origin: self.origin,
            levels,
            ranks: ranks.into(),
            ..ExportContext::new(stated.region, radius)
        }
    }
}

/// Judges the samples with ranks below a threshold, and prints the verdict.
pub fn judge(
    file: &Path,
    set: &SetArguments,
    below: f64,
    options: &VerifyOptions,
    as_json: bool,
) -> Result<u8> {
    check_threshold(below)?;
    // The file is not compared with its certificate when it is read. If the file has a fault, the verdict on its
    // samples shows it.
    let ranked = RankedFile::read(file, set, CertificateUse::AsStated)?;
    ensure!(
        ranked.ranks.iter().any(|&rank| rank < below),
        "{}: no sample has a rank below {below}",
        named(file)
    );

    let found = verifying(|control| verify_ranks(&ranked.ranked(), below, options, control));
    // `RankedFile::read` refuses sets without levels, of which nothing is claimed.
    let report = found.in_file(file)?.context("there are no levels")?;

    let level = CertifiedLevel::of(&report.kept);
    let (of, misplaced) = (ranked.ranks.len(), report.misplaced);
    let share = level.count as f64 / of as f64;
    let mut object = json!(level);
    // A rank in a wrong place is a fault of the file, even where the samples that are kept are as claimed.
    object["valid"] = json!(report.valid());
    object["rank"] = json!(below);
    object["of"] = json!(of);
    object["misplaced_ranks"] = json!(misplaced);

    output::report(
        as_json,
        || object,
        || {
            format!(
                "ranks below    {below}: {} of {of} samples, {share:.4} of them\n\
                 \x20  samples   smallest distance above   covering radius up to\n{}\
                 ranks in place {}\n\
                 verdict        {}\n",
                level.count,
                output::level_row(&level),
                output::answer(misplaced == 0, misplaced),
                output::validity(report.valid()),
            )
        },
    )?;
    Ok(verdict_code(report.valid()))
}

/// Returns the samples with ranks below a threshold as a set of the levels that are left, and the statements of its certificate.
pub fn set_below(
    input: &Path,
    set: &SetArguments,
    below: f64,
) -> Result<(PointSet, ExportContext)> {
    check_threshold(below)?;
    let ranked = RankedFile::read(input, set, CertificateUse::Checked)?;
    let name = named(input);
    // Levels are claims on the first samples, and those that are kept have to be such.
    ensure!(
        ranked.ranks.is_sorted(),
        "{name}: its ranks do not ascend, as those of nested levels do"
    );

    let (kept, ranks) = ranked.kept(|index| ranked.ranks[index] < below);
    let view = ranked.ranked();
    let claim = view
        .claim(below, kept.len())
        .context("there are no levels")?;
    // Without a whole level the set covers nothing, so that a certificate would have nothing to state. For 0 the finest
    // threshold is that of the first level.
    ensure!(
        claim.covering.is_some(),
        "{name}: of its first level the ranks go up to {}, and samples below {below} hold no whole level",
        view.finest_threshold(0.0)
    );

    // The threshold of a level is the rank below which all its samples lie. Divided by that of the last level left,
    // ranks are those of a run of these levels alone, which go up to 1.
    let finest = view.finest_threshold(below);
    let ranks = ranks.into_iter().map(|rank| rank / finest).collect();
    // Levels with fewer samples than are kept stay as they are. The claim about all kept samples follows as the last
    // level, and takes the place of the levels that would need more samples.
    let before = ranked
        .levels
        .iter()
        .filter(|level| level.count < claim.count);
    let levels = before.copied().chain([claim]).collect();
    let context = ranked.context(claim.distance, levels, ranks, (RANK, json!(below)));
    Ok((kept, context))
}

/// Writes the samples with ranks below the darkness of an image, and prints a verdict on their distance.
pub fn keep_painted(
    [input, output_path]: [&Path; 2],
    set: &SetArguments,
    painted: &Path,
    format: Option<Format>,
    options: &VerifyOptions,
) -> Result<u8> {
    let ranked = RankedFile::read(input, set, CertificateUse::Checked)?;
    let picture: GrayImage = image(painted, "--rank-image")?;
    let region = ranked.certificate.region;
    let (points, size) = (&ranked.read.set.points, [region.width, region.height]);

    // Each sample has the threshold of the pixel under it; white, 0, keeps none.
    let is_dark = |index: usize| ranked.ranks[index] < picture.darkness_at(points[index], size);
    // The ranks stay as they are: under thresholds that differ from place to place, no level is left whole to divide
    // them by.
    let (kept, ranks) = ranked.kept(is_dark);
    let highest = ranks.iter().copied().fold(0.0, f64::max);
    ensure!(
        !kept.is_empty(),
        "{}: the image keeps no sample, and files have at least one",
        named(painted)
    );

    // All that are kept are samples of the level that the highest rank belongs to, whatever their thresholds were.
    let just_above = highest.next_up();
    let claim = ranked.ranked().claim(just_above, kept.len());
    let distance = claim.context("there are no levels")?.distance;
    let report = verifying(|control| verify(&kept.points, region, distance, options, control));
    let report = report.in_file(output_path)?;

    // These counts serve the column `level` alone: no certificate is written.
    let mut counts = Vec::new();
    for level in &ranked.levels {
        let is_of_level = |index: usize| index < level.count && is_dark(index);
        let count = (0..points.len())
            .filter(|&index| is_of_level(index))
            .count();
        counts.push(PrefixClaim { count, ..*level });
    }

    let statement = (RANK, json!(file_name(painted)));
    let mut context = ExportContext {
        format,
        ..ranked.context(distance, counts, ranks, statement)
    };
    // Not every format holds an origin.
    leave_out_origin(output_path, format, &mut context)?;
    save_unverified(&kept, output_path, &context)?;

    // Gaps do not count: where the density is low, samples are missing on purpose.
    let apart = report.conflict_free();
    output::emit(&format!(
        "{} of {} samples, as dense as {} is dark\n\
         distance       above {distance} ({})   {}\n\
         file           {} (of a painted density no more is stated: it has no certificate)\n",
        kept.len(),
        points.len(),
        named(painted),
        report.min_distance,
        output::validity(apart),
        named(output_path)
    ))?;
    Ok(verdict_code(apart))
}
