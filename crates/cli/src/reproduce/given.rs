//! Sets of other methods, as `--file` gives them: read, and refused where nothing could be said of them.
//! It measures nothing.

use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use tilescope_analysis::measures::MeasureError;
use tilescope_analysis::{Region, VerifyError};
use tilescope_reproduce::GivenSet;

use crate::options::{SetArguments, UNIT_SQUARE};
use crate::output;

/// Samples that figure 10 needs for a spectrum: of fewer it would show nothing.
const LEAST: usize = 500;
/// Part of either side of its domain over which a set must extend at least: those of another domain fill a corner of it.
const FILLED: f64 = 0.5;

/// Reads a set to stand beside others.
pub fn read(path: &Path, arguments: &SetArguments) -> Result<GivenSet> {
    let found = arguments.read(path)?;
    let stated = found.certificate.map(|certificate| certificate.region);
    let region = arguments.overrides(path)?.region.or(stated);
    let region = region.unwrap_or(UNIT_SQUARE);
    let points = found.set.points;
    check(&points, region).with_context(|| path.display().to_string())?;
    let name = path.file_name().unwrap_or_default();
    Ok(GivenSet {
        name: name.to_string_lossy().into_owned(),
        points,
        region,
    })
}

fn check(points: &[[f64; 2]], region: Region) -> Result<()> {
    let Region { width, height, .. } = region;
    ensure!(
        region.is_supported(),
        VerifyError::BadRegion { width, height }
    );
    if let Some(index) = points.iter().position(|point| !region.contains(*point)) {
        let [x, y] = points[index];
        let all = output::region_text(&region);
        bail!("sample {index} at ({x}, {y}) is not inside its domain, {all}");
    }
    let count = points.len();
    if let [point, rest @ ..] = points
        && !rest.is_empty()
        && rest
            .iter()
            .all(|other| other.map(f64::to_bits) == point.map(f64::to_bits))
    {
        let point = *point;
        return Err(MeasureError::AllEqual { count, point }.into());
    }
    ensure!(
        count >= LEAST,
        "{count} samples are too few to compare; there must be at least {LEAST}"
    );
    for (axis, (name, side)) in [("x", width), ("y", height)].into_iter().enumerate() {
        let all = points.iter().map(|point| point[axis]);
        let (low, high) = all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        ensure!(
            high - low >= FILLED * side,
            "its samples have {name} from {low} to {high}, less than {FILLED} of the domain's {side}: they do not fill it; --width and \
             --height tell another domain"
        );
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use tilescope_analysis::Boundary;

    use super::*;

    fn square(side: f64) -> Region {
        Region {
            width: side,
            height: side,
            boundary: Boundary::Periodic,
        }
    }

    fn grid(along: u32, part: f64) -> Vec<[f64; 2]> {
        let at = |index: u32| part * (f64::from(index) + 0.5) / f64::from(along);
        let each = (0..along * along).map(|index| [at(index % along), at(index / along)]);
        each.collect()
    }

    fn refused(points: &[[f64; 2]], region: Region, why: &[&str]) {
        let error = check(points, region).unwrap_err().to_string();
        assert!(why.iter().all(|part| error.contains(part)), "{error}");
    }

    #[test]
    fn sets_that_fill_their_domain_are_taken() {
        assert!(check(&grid(23, 1.0), square(1.0)).is_ok());
        assert!(check(&grid(23, 0.6), square(1.0)).is_ok());
        assert!(check(&grid(23, 1e9), square(1e9)).is_ok());
    }

    #[test]
    fn others_are_refused_with_value_and_limit() {
        for side in [f64::INFINITY, f64::NAN, 0.0, -1.0] {
            refused(&grid(23, 1.0), square(side), &[&side.to_string(), "2^100"]);
        }
        refused(&grid(23, 1.0), square(1e9), &["0.5 of", "1000000000"]);
        refused(&grid(23, 1.0), square(0.9), &["sample 21 at", "not inside"]);
        refused(&grid(22, 1.0), square(1.0), &["484 samples", "least 500"]);
        let same = [[0.5, 0.25]; 100];
        refused(&same, square(1.0), &["all 100 samples", "(0.5, 0.25)"]);
    }
}
