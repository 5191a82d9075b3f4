//! Layouts in files: JSON that places pieces side by side, its limits, and the rectangles and sets that it describes.
//! Opens no file; sets from files are read by the caller.

mod entry;
mod error;
mod set;

use serde::{Deserialize, Serialize};

use super::{CombineError, CombineOptions, MAX_PIECES, check_rects};
use crate::json;
use crate::lattice::{Boundary, Domain, Rect};
use crate::parameters::{Insertion, MAX_SEQUENTIAL_SAMPLES, MAXIMAL_DENSITY, Order};

pub use entry::{PieceEntry, PieceSource};
pub use error::LayoutError;
pub use set::{PieceError, Set};

/// The supported version of layouts.
pub const VERSION: u32 = 1;

/// The longest layout, in bytes. The largest number of pieces takes a quarter of it.
pub const MAX_LAYOUT_BYTES: u64 = 1 << 20;

/// A layout, as its file has it.
///
/// ```
/// use tilescope_core::combine::file::Layout;
///
/// let layout = Layout::from_json(br#"{
///     "version": 1, "radius": 0.01, "columns": [0.5, 0.5], "rows": [1],
///     "pieces": [{ "seed": 1, "method": "reference" }, { "file": "a.csv" }]
/// }"#)?;
/// assert_eq!(layout.placed()?.pieces.len(), 2);
/// # Ok::<(), tilescope_core::combine::file::LayoutError>(())
/// ```
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
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
    pieces: Vec<PieceEntry>,
}

const fn one() -> u64 {
    1
}

/// Read before the rest, so that a layout of another version is reported as such.
#[derive(Deserialize)]
struct Version {
    version: u32,
}

/// A piece's rectangle and source.
#[derive(Clone, Debug)]
pub struct PlacedPiece {
    /// Its rectangle in the result.
    pub rect: Rect,
    /// Where its set comes from.
    pub source: PieceSource,
    /// The point of the set that lies on the rectangle's lowest corner, in the set's units.
    pub offset: [f64; 2],
}

/// A layout with its rectangles and sources computed.
#[derive(Clone, Debug)]
pub struct PlacedLayout {
    /// The domain of the result.
    pub domain: Domain,
    /// The pieces; their rectangles partition the domain.
    pub pieces: Vec<PlacedPiece>,
    /// About how many samples will be computed: those of the result, and those of runs of their own size.
    pub expected: f64,
}

impl Layout {
    /// Reads a layout. Fails when it is too long or has another form or version.
    pub fn from_json(bytes: &[u8]) -> Result<Self, LayoutError> {
        if bytes.len() as u64 > MAX_LAYOUT_BYTES {
            let bytes = bytes.len() as u64;
            return Err(LayoutError::TooLong { bytes });
        }

        let Version { version } = json::from_bytes(bytes).map_err(LayoutError::NoLayout)?;
        if version != VERSION {
            return Err(LayoutError::Version { version });
        }
        json::from_bytes(bytes).map_err(LayoutError::Form)
    }

    /// Returns how the pieces are glued.
    #[must_use]
    pub fn options(&self) -> CombineOptions {
        CombineOptions {
            seed: self.seed,
            order: self.order,
            insertion: self.insertion,
            ..CombineOptions::default()
        }
    }

    /// Returns the layout's domain, rectangles and sources.
    ///
    /// Fails when there are too many pieces, the layout has neither columns and rows nor a width and a height, or has
    /// both, the domain is invalid, the rectangles do not partition it, a piece is not one of the three kinds (a file,
    /// parameters or a seed), or sets would be made that are too large. Offsets are checked later, with the sets they
    /// belong to.
    pub fn placed(&self) -> Result<PlacedLayout, LayoutError> {
        let (domain, rects) = self.rects()?;
        check_rects(&domain, &rects)?;

        let mut pieces = Vec::with_capacity(rects.len());
        // First the samples of the result alone, so that a domain that is too large is refused before the source of any
        // piece is looked at.
        let mut expected = domain.area_radii() * MAXIMAL_DENSITY;
        refuse_too_many(expected)?;

        for (k, (entry, rect)) in self.pieces.iter().zip(rects).enumerate() {
            let source = entry
                .source(self.boundary, &rect)
                .map_err(|error| error.of_piece(k))?;
            expected += source.expected_beside();

            // Without an offset the set's own lowest corner lies on the rectangle's.
            let offset = entry.offset.unwrap_or_default();
            pieces.push(PlacedPiece {
                rect,
                source,
                offset,
            });
        }

        refuse_too_many(expected)?;

        Ok(PlacedLayout {
            domain,
            pieces,
            expected,
        })
    }

    /// Returns the domain and the rectangles of the pieces. Fails unless the layout has either columns and rows or a
    /// width and a height.
    fn rects(&self) -> Result<(Domain, Vec<Rect>), LayoutError> {
        let (count, maximum) = (self.pieces.len(), MAX_PIECES);
        if count > maximum {
            return Err(CombineError::TooManyPieces { count, maximum }.into());
        }
        match (&self.columns, &self.rows, self.width, self.height) {
            (Some(columns), Some(rows), None, None) => self.grid(columns, rows),
            (None, None, Some(width), Some(height)) => self.free([width, height]),
            _ => Err(LayoutError::GridOrSize),
        }
    }

    /// Returns the domain and the rectangles that columns and rows of these lengths make, row by row. Fails when there
    /// are more or fewer pieces than rectangles, and when a piece names a rectangle of its own.
    fn grid(&self, columns: &[f64], rows: &[f64]) -> Result<(Domain, Vec<Rect>), LayoutError> {
        let (across, up, pieces) = (columns.len(), rows.len(), self.pieces.len());
        // Where `usize` has 32 bits, the product may be too large for it.
        let rectangles = across.saturating_mul(up);
        if rectangles != pieces {
            return Err(LayoutError::Count {
                columns: across,
                rows: up,
                rectangles,
                pieces,
            });
        }

        // A rectangle of a piece could contradict the columns and rows.
        let with_rect = self.pieces.iter().position(|entry| entry.rect.is_some());
        if let Some(k) = with_rect {
            return Err(LayoutError::RectInGrid.of_piece(k));
        }

        let (x, y) = (edges("columns", columns)?, edges("rows", rows)?);
        // Edges begin with 0, so that there is a last one.
        let size = [&x, &y].map(|edges| edges.last().copied().unwrap_or(0.0));
        let domain = Domain::from_size(size, self.radius, self.boundary)?;

        let rect = |row: &[f64], column: &[f64]| {
            domain.rect_from_user([column[0], row[0]], [column[1], row[1]])
        };

        let rects = y
            .windows(2)
            .flat_map(|row| x.windows(2).map(move |column| rect(row, column)));

        Ok((domain, rects.collect()))
    }

    /// Returns the domain of these sides and the rectangles that the pieces name. Fails when a piece names none, or one
    /// that is empty or not inside the domain. Whether they partition it is checked by the caller.
    fn free(&self, size: [f64; 2]) -> Result<(Domain, Vec<Rect>), LayoutError> {
        let domain = Domain::from_size(size, self.radius, self.boundary)?;

        let rect_of = |(k, entry): (usize, &PieceEntry)| {
            let Some(rect) = entry.rect else {
                return Err(LayoutError::NoRect.of_piece(k));
            };

            let [x0, y0, x1, y1] = rect;
            let inside = |low: f64, high: f64, side: f64| 0.0 <= low && low < high && high <= side;
            if inside(x0, x1, size[0]) && inside(y0, y1, size[1]) {
                return Ok(domain.rect_from_user([x0, y0], [x1, y1]));
            }
            Err(LayoutError::Rect { rect, size }.of_piece(k))
        };

        let rects = self.pieces.iter().enumerate().map(rect_of);
        Ok((domain, rects.collect::<Result<_, _>>()?))
    }
}

/// Refuses more samples than a result and the sets made for it may have.
fn refuse_too_many(expected: f64) -> Result<(), LayoutError> {
    if expected > MAX_SEQUENTIAL_SAMPLES {
        return Err(LayoutError::TooManySamples { expected });
    }
    Ok(())
}

/// Returns where columns or rows begin and end.
fn edges(name: &'static str, sides: &[f64]) -> Result<Vec<f64>, LayoutError> {
    let mut edges = vec![0.0];
    let mut sum = 0.0;
    for (index, &side) in sides.iter().enumerate() {
        if !(side.is_finite() && side > 0.0) {
            return Err(LayoutError::Side { name, index, side });
        }
        sum += side;
        edges.push(sum);
    }
    Ok(edges)
}
