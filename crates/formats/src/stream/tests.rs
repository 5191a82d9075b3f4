//! Compares streams with the same sets in memory: bytes, certificates, errors, interruptions.

mod checks;
mod exports;
mod resumed;

use std::collections::BTreeSet;
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use tempfile::TempDir;
use tilescope_analysis::{Boundary, Progress, Region, StreamBand};

use super::*;
use crate::export::ExportContext;
use crate::files::export;
use crate::format::{Format, Precision};
use crate::point_set::{PointSet, Provenance};
use crate::read::certificate_path;

const GO: fn(Progress) -> ControlFlow<()> = |_| ControlFlow::Continue(());
const STREAMED: [Format; 5] = [
    Format::Csv,
    Format::PsaRps,
    Format::UtkBinary,
    Format::Npy,
    Format::PlyBinary,
];
/// Bands so small that the verifier of these sets has many.
const SMALL: StreamBand = StreamBand {
    samples: 1,
    rows: 4,
    most_samples: 1 << 20,
};

fn region(boundary: Boundary) -> Region {
    Region {
        width: 12.0,
        height: 100.0,
        boundary,
    }
}

/// A lattice of spacing 1 whose points are moved by up to `jitter`, in rows, with provenance.
fn rows(boundary: Boundary, jitter: f64) -> PointSet {
    let region = region(boundary);
    let noise = |i: u32, step: f64| jitter * (2.0 * (f64::from(i + 1) * step).fract() - 1.0);
    let mut points: Vec<[f64; 2]> = (0..1200)
        .map(|i| {
            let [x, y] = [f64::from(i % 12) + 0.5, f64::from(i / 12) + 0.5];
            [x + noise(i, 0.754_877), y + noise(i, 0.569_84)]
        })
        .collect();
    points.retain(|&point| region.contains(point));
    points.sort_by(|a, b| (a[1].floor().total_cmp(&b[1].floor())).then(a[0].total_cmp(&b[0])));
    let provenance = (0..points.len() as u32).map(|i| Provenance::tiled(i % 7, i));
    PointSet {
        provenance: Some(provenance.collect()),
        points,
    }
}

fn context(boundary: Boundary, precision: Precision) -> ExportContext {
    let mut context = ExportContext::new(region(boundary), 0.8);
    context.precision = precision;
    context.parameters.insert("seed".to_owned(), 5.into());
    context
}

/// The five formats in each precision they have.
fn cases() -> Vec<(Format, Precision)> {
    let both = [Precision::Double, Precision::Single];
    let all = STREAMED.into_iter().flat_map(|f| both.map(|p| (f, p)));
    all.filter(|(f, p)| f.precision(*p) == *p).collect()
}

fn name(format: Format) -> String {
    format!("set.{}", format.extension())
}

/// A folder with a file exported in one piece; its path, its bytes and those of its certificate.
fn whole(
    set: &PointSet,
    context: &ExportContext,
    format: Format,
) -> (TempDir, PathBuf, [Vec<u8>; 2]) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join(name(format));
    export(&path, set, context, &GO).expect("a verdict");
    let bytes = bytes_of(&path);
    (folder, path, bytes)
}

fn bytes_of(path: &Path) -> [Vec<u8>; 2] {
    [path.to_owned(), certificate_path(path)].map(|path| fs::read(path).expect("there"))
}

fn names(folder: &Path) -> BTreeSet<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let name = |entry: fs::DirEntry| entry.file_name().to_string_lossy().into_owned();
    entries
        .map(|entry| name(entry.expect("an entry")))
        .collect()
}

/// Pushes a part of a set, a few points at a time.
fn push(export: &mut StreamExport, set: &PointSet, part: std::ops::Range<usize>, piece: usize) {
    let mut start = part.start;
    while start < part.end {
        let end = part.end.min(start + piece);
        let provenance = set.provenance.as_ref().map(|all| &all[start..end]);
        let pushed = export.push(&set.points[start..end], provenance, &GO);
        pushed.expect("taken");
        start = end;
    }
}
