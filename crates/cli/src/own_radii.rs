//! `tilescope verify` of a set without a certificate whose file has the radius of each sample: what can be judged of it.
//!
//! That no two samples are near each other follows from their own radii, by the rule of sets in a field: radii a and b keep
//! 2ab / (a + b) apart. Whether every place is covered depends on the radius at that place, which a column does not have.

use std::path::Path;

use anyhow::{Result, bail};
use serde_json::json;
use tilescope_analysis::{Number, Region, ThinnedRadii, ThinnedReport, ThinnedSet, verify_thinned};
use tilescope_formats::ReadSet;

use crate::options::SetArguments;
use crate::paths::{InFile, named};
use crate::progress::verifying;
use crate::{output, verdict_code};

/// How many pairs in conflict are named, at most. Chosen, not measured.
const NAMED: usize = 5;

/// Why covering has no verdict.
const NOT_JUDGED: &str = "not judged: the radius between the samples is not known; --radius-expression or --density-image \
                          with --radius gives the field";

/// Judges a set by the radii in its file, and prints the verdict; `None` if the file has no column of radii.
pub fn judge(path: &Path, set: &SetArguments, as_json: bool) -> Result<Option<u8>> {
    let read = set.read_varying(path)?;
    let Some(radii) = read.radii.as_deref() else {
        return Ok(None);
    };
    let region = region(path, set, &read)?;

    // The judge of thinned sets compares each pair by its own two radii. Here all points count as kept.
    let all = vec![true; read.set.len()];
    let samples = ThinnedSet {
        given: &read.set.points,
        kept: &all,
        radii: ThinnedRadii::Each(radii),
        ranks: None,
        period: (region.filter(Region::is_periodic)).map(|region| region.size()),
    };
    let found = verifying(|control| verify_thinned(&samples, NAMED, control)).in_file(path)?;
    output::report(
        as_json,
        || to_json(&read, radii, region, &found),
        || to_text(&read, radii, region, &found),
    )?;
    Ok(Some(verdict_code(found.conflicts == 0)))
}

/// Returns the domain that the arguments state by a side or by how it ends. `None` if they state neither: only the
/// points are judged then, in the plane, where an origin changes nothing.
fn region(path: &Path, set: &SetArguments, read: &ReadSet) -> Result<Option<Region>> {
    let is_given = set.width.is_some() || set.height.is_some() || set.boundary.is_some();
    if !is_given {
        // In degrees no length is a distance, and a column of radii has lengths.
        if read.degrees && !set.planar {
            bail!(
                "{}: all points lie within 180 and 90, as longitudes and latitudes do; --planar takes them as they are",
                named(path)
            );
        }
        return Ok(None);
    }

    // Sets in a field are made in a bounded domain unless another one is asked for, since few fields are periodic.
    let is_periodic = false;
    // A side that is not given is that of the unit square.
    let unit_square = Region::new([1.0, 1.0], is_periodic);
    let region = set.region_over(unit_square);
    set.refuse_degrees(read, region)?;
    let outside = |point: &[f64; 2]| !region.contains(*point);
    if let Some(index) = read.set.points.iter().position(outside) {
        let [x, y] = read.set.points[index].map(Number);
        bail!(
            "{}: sample {index} at {x} {y} lies outside of the domain of {}; --width, --height, --boundary and --origin state \
             another one",
            named(path),
            output::region_text(&region)
        );
    }
    Ok(Some(region))
}

/// Returns the least and the greatest radius.
fn extremes(radii: &[f64]) -> [f64; 2] {
    let least = radii.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = radii.iter().copied().fold(0.0, f64::max);
    [least, greatest]
}

fn to_json(
    read: &ReadSet,
    radii: &[f64],
    region: Option<Region>,
    found: &ThinnedReport,
) -> serde_json::Value {
    json!({
        "format": read.detection.format.to_string(),
        "precision": read.precision,
        "region": region,
        "count": found.given,
        "radii": extremes(radii),
        "certificate": false,
        "conflicts": found.conflicts,
        "conflicting": found.conflicting,
        "conflict_free": found.conflicts == 0,
        // Covering cannot be judged.
        "maximal": null,
        "passed": found.conflicts == 0,
    })
}

fn to_text(read: &ReadSet, radii: &[f64], region: Option<Region>, found: &ThinnedReport) -> String {
    let [least, greatest] = extremes(radii).map(Number);
    let domain = region.map_or_else(
        || "the plane".to_owned(),
        |region| output::region_text(&region),
    );
    let free = output::conflicts_answer(found.conflicts);
    let verdict = if found.conflicts == 0 {
        "conflict-free"
    } else {
        "NOT VALID"
    };

    let mut out = format!(
        "{}: {domain}, r = {least} to {greatest}, the column radius\n\n\
         samples        {}\n\
         conflict-free  {free}\n\
         covering       {NOT_JUDGED}\n\
         verdict        {verdict}\n",
        read.detection, found.given,
    );
    for [first, second] in &found.conflicting {
        let pair = format!("  samples {first} and {second} are nearer than 2ab / (a + b)\n");
        out.push_str(&pair);
    }
    out + "certificate    none\n"
}
