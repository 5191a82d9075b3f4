//! The layout file: its form, its limits, and the rectangles that it means. It makes no set.

use std::fs;
use std::path::Path;

use anyhow::{Context, Result, bail, ensure};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use tilescope_core::combine::{CombineOptions, MAX_PIECES, check_rects};
use tilescope_core::{
    Boundary, Domain, Insertion, MAX_SEQUENTIAL_SAMPLES, MAXIMAL_DENSITY, Order, Rect,
};

use super::entry::{Entry, Source};

/// The version of layouts that is read.
const VERSION: u32 = 1;

/// The longest layout: as many pieces as there may be take a quarter of it.
const MAX_LAYOUT_BYTES: u64 = 1 << 20;

/// A layout, as its file has it.
///
/// ```json
/// {
///   "version": 1, "radius": 0.01, "columns": [0.5, 0.5], "rows": [1],
///   "pieces": [{ "seed": 1, "method": "reference" }, { "file": "a.csv" }]
/// }
/// ```
#[derive(Debug, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct Layout {
    version: u32,
    #[serde(default)]
    boundary: Boundary,
    radius: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    width: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    height: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    columns: Option<Vec<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    rows: Option<Vec<f64>>,
    #[serde(default = "one")]
    seed: u64,
    #[serde(default)]
    order: Order,
    #[serde(default)]
    insertion: Insertion,
    pieces: Vec<Entry>,
}

const fn one() -> u64 {
    1
}

/// Read before the rest, so that a layout of another version is named as such.
#[derive(Deserialize)]
struct Version {
    version: u32,
}

/// A piece's rectangle and source.
#[derive(Clone, Debug)]
pub struct Place {
    pub rect: Rect,
    pub source: Source,
    /// The place of the set on the rectangle's lowest corner, in the set's units.
    pub offset: [f64; 2],
}

/// What a layout means.
#[derive(Clone, Debug)]
pub struct Placed {
    pub domain: Domain,
    pub places: Vec<Place>,
}

impl Layout {
    /// Reads a layout. Fails when it is too long or has another form.
    pub fn read(path: &Path) -> Result<Self> {
        let about = fs::metadata(path)?;
        ensure!(about.is_file(), "this is no file");
        ensure!(
            about.len() <= MAX_LAYOUT_BYTES,
            "the layout has {} bytes; it may have {MAX_LAYOUT_BYTES}",
            about.len()
        );
        let bytes = fs::read(path)?;
        let Version { version } =
            serde_json::from_slice(&bytes).context("this is no layout of pieces")?;
        ensure!(
            version == VERSION,
            "the layout has version {version}; this program reads version {VERSION}"
        );
        Ok(serde_json::from_slice(&bytes)?)
    }

    /// Returns how the pieces are glued.
    pub fn options(&self) -> CombineOptions {
        CombineOptions {
            seed: self.seed,
            order: self.order,
            insertion: self.insertion,
            ..CombineOptions::default()
        }
    }

    /// Returns what the layout means; files are relative to `folder`.
    ///
    /// Fails when the rectangles do not partition the domain, a piece is not one of the three kinds, or sets
    /// would be made that are too large.
    pub fn placed(&self, folder: &Path) -> Result<Placed> {
        let (domain, rects) = self.rects()?;
        check_rects(&domain, &rects)?;
        let mut places = Vec::with_capacity(rects.len());
        let mut expected = domain.area_radii() * MAXIMAL_DENSITY;
        limit(expected)?;
        for (k, (entry, rect)) in self.pieces.iter().zip(rects).enumerate() {
            let source = entry
                .source(self.boundary, &rect, folder)
                .with_context(|| format!("pieces[{k}]"))?;
            expected += entry.expected_beside(&source)?;
            let offset = entry.offset.unwrap_or_default();
            places.push(Place {
                rect,
                source,
                offset,
            });
        }
        limit(expected)?;
        Ok(Placed { domain, places })
    }

    fn rects(&self) -> Result<(Domain, Vec<Rect>)> {
        let count = self.pieces.len();
        ensure!(
            count <= MAX_PIECES,
            "there are {count} pieces; there may be at most {MAX_PIECES}"
        );
        match (&self.columns, &self.rows, self.width, self.height) {
            (Some(columns), Some(rows), None, None) => self.grid(columns, rows),
            (None, None, Some(width), Some(height)) => self.free([width, height]),
            _ => bail!("either \"columns\" and \"rows\" or \"width\" and \"height\" must be given"),
        }
    }

    /// Returns the rectangles of columns and rows.
    fn grid(&self, columns: &[f64], rows: &[f64]) -> Result<(Domain, Vec<Rect>)> {
        let (across, up, count) = (columns.len(), rows.len(), self.pieces.len());
        let wanted = across.saturating_mul(up);
        ensure!(
            wanted == count,
            "{across} columns and {up} rows make {wanted} rectangles; there are {count} pieces"
        );
        let placed = self.pieces.iter().position(|entry| entry.rect.is_some());
        if let Some(k) = placed {
            bail!("pieces[{k}]: a \"rect\" has no place in a layout of columns and rows");
        }
        let (x, y) = (edges("columns", columns)?, edges("rows", rows)?);
        let size = [&x, &y].map(|edges| edges.last().copied().unwrap_or(0.0));
        let domain = Domain::from_size(size, self.radius, self.boundary)?;
        let cell = |row: &[f64], column: &[f64]| {
            domain.rect_from_user([column[0], row[0]], [column[1], row[1]])
        };
        let rects = y
            .windows(2)
            .flat_map(|row| x.windows(2).map(move |column| cell(row, column)));
        Ok((domain, rects.collect()))
    }

    /// Returns the rectangles that the pieces name.
    fn free(&self, size: [f64; 2]) -> Result<(Domain, Vec<Rect>)> {
        let domain = Domain::from_size(size, self.radius, self.boundary)?;
        let rect = |(k, entry): (usize, &Entry)| {
            let Some([x0, y0, x1, y1]) = entry.rect else {
                bail!("pieces[{k}]: \"rect\" is missing; the layout has no columns and rows");
            };
            let inside = |low: f64, high: f64, side: f64| 0.0 <= low && low < high && high <= side;
            ensure!(
                inside(x0, x1, size[0]) && inside(y0, y1, size[1]),
                "pieces[{k}]: the rect [{x0}, {y0}, {x1}, {y1}] is empty or not inside {} x {}",
                size[0],
                size[1]
            );
            Ok(domain.rect_from_user([x0, y0], [x1, y1]))
        };
        let rects = self.pieces.iter().enumerate().map(rect);
        Ok((domain, rects.collect::<Result<_>>()?))
    }

    /// Returns the layout as a certificate states it: files without folders, with their digests.
    pub fn stated(&self, placed: &Placed) -> Result<Value> {
        let mut stated = serde_json::to_value(self)?;
        for (k, place) in placed.places.iter().enumerate() {
            if let Source::File { path, .. } = &place.source {
                let named = crate::make::named_by_content(path)?;
                stated["pieces"][k]["file"] = named["file"].clone();
                stated["pieces"][k]["digest"] = named["digest"].clone();
            }
        }
        Ok(stated)
    }
}

/// Refuses more samples than a result and the sets that are made for it may have.
fn limit(expected: f64) -> Result<()> {
    ensure!(
        expected <= MAX_SEQUENTIAL_SAMPLES,
        "about {expected:.3e} samples would be made; there may be {MAX_SEQUENTIAL_SAMPLES:.0e}"
    );
    Ok(())
}

/// Returns where columns or rows begin and end.
fn edges(name: &str, sides: &[f64]) -> Result<Vec<f64>> {
    let mut edges = vec![0.0];
    let mut sum = 0.0;
    for (k, &side) in sides.iter().enumerate() {
        ensure!(
            side.is_finite() && side > 0.0,
            "{name}[{k}] is {side}; it must be a finite number above 0"
        );
        sum += side;
        edges.push(sum);
    }
    Ok(edges)
}
