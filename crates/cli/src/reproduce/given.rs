//! Sets of other methods, as `--file` gives them: read, and refused where nothing could be said of them. One that is refused
//! keeps no other from being read. It measures nothing.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail, ensure};
use clap::ValueEnum;
use tilescope_analysis::measures::MeasureError;
use tilescope_analysis::{Region, VerifyError};
use tilescope_reproduce::GivenSet;

use crate::options::{SetArguments, UNIT_SQUARE};
use crate::output;

/// Samples that figure 10 needs for a spectrum: of fewer it would show nothing.
const MIN_SAMPLES: usize = 500;
/// Part of either side of its domain over which a set must extend at least: those of another domain fill a corner of it.
const FILLED: f64 = 0.5;

/// A file that cannot stand beside others, and why.
pub struct Refused {
    pub path: String,
    pub reason: String,
}

/// Reads all sets; returns those that can be used, with names that tell them apart, and the others.
pub fn read_all(paths: &[PathBuf], arguments: &SetArguments) -> (Vec<GivenSet>, Vec<Refused>) {
    let (mut sets, mut refused) = (Vec::new(), Vec::new());
    for (path, name) in paths.iter().zip(names(paths)) {
        match read(path, arguments) {
            Ok(set) => sets.push(GivenSet { name, ..set }),
            Err(error) => refused.push(Refused {
                path: path.display().to_string(),
                reason: format!("{error:#}"),
            }),
        }
    }
    (sets, refused)
}

/// Returns the files' names; paths where several files have one name, and a number behind a path that was there before.
fn names(paths: &[PathBuf]) -> Vec<String> {
    let name = |path: &PathBuf| -> String {
        let name = path.file_name().unwrap_or_default();
        name.to_string_lossy().into_owned()
    };
    let all: Vec<String> = paths.iter().map(name).collect();
    let label = |(index, path): (usize, &PathBuf)| {
        let own = &all[index];
        if all.iter().filter(|other| *other == own).count() == 1 {
            return own.clone();
        }
        match paths[..index].iter().filter(|other| *other == path).count() {
            0 => path.display().to_string(),
            before => format!("{} ({})", path.display(), before + 1),
        }
    };
    paths.iter().enumerate().map(label).collect()
}

/// Returns the arguments that tell what the files do not, as they were given.
pub fn stated(arguments: &SetArguments) -> String {
    let mut out = String::new();
    for (name, side) in [("width", arguments.width), ("height", arguments.height)] {
        if let Some(side) = side {
            let _ = write!(out, " --{name} {side}");
        }
    }
    if let Some(value) = arguments.boundary.and_then(|b| b.to_possible_value()) {
        let _ = write!(out, " --boundary {}", value.get_name());
    }
    if let Some(format) = arguments.format {
        let _ = write!(out, " --format {}", format.name());
    }
    out
}

fn read(path: &Path, arguments: &SetArguments) -> Result<GivenSet> {
    let found = arguments.read(path)?;
    let stated = found.certificate.map(|certificate| certificate.region);
    let region = arguments.overrides(path)?.region.or(stated);
    let region = region.unwrap_or(UNIT_SQUARE);
    let points = found.set.points;
    check(&points, region).with_context(|| path.display().to_string())?;
    Ok(GivenSet {
        name: String::new(),
        path: path.display().to_string(),
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
        count >= MIN_SAMPLES,
        "{count} samples are too few to compare; there must be at least {MIN_SAMPLES}"
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
    fn names_tell_files_apart() {
        let of = |paths: &[&str]| names(&paths.iter().map(PathBuf::from).collect::<Vec<_>>());
        assert_eq!(of(&["a/x.csv", "b/y.csv"]), ["x.csv", "y.csv"]);
        assert_eq!(
            of(&["a/x.csv", "b/x.csv", "y.csv"]),
            ["a/x.csv", "b/x.csv", "y.csv"]
        );
        assert_eq!(of(&["x.csv", "x.csv"]), ["x.csv", "x.csv (2)"]);
    }

    #[test]
    fn arguments_are_told_as_they_were_given() {
        let none = SetArguments {
            radius: None,
            width: None,
            height: None,
            boundary: None,
            format: None,
        };
        assert_eq!(stated(&none), "");
        let some = SetArguments {
            width: Some(2.5),
            boundary: Some(crate::options::BoundaryArgument::Bounded),
            format: Some(tilescope_formats::Format::Xyz),
            ..none
        };
        assert_eq!(
            stated(&some),
            " --width 2.5 --boundary bounded --format xyz"
        );
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
