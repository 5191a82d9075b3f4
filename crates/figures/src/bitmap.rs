//! Pixels as a shape: shades or colours in rows, for pictures that were computed pixel by pixel.
//!
//! Nothing is smoothed or transparent: every pixel of the picture takes the one pixel in which its centre lies.

use png::{BitDepth, ColorType, Compression, Encoder};

use crate::error::{FigureError, MAX_BITMAP_SIDE};
use crate::rect::Rect;

/// Opaque pixels in rows, the uppermost row first.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Bitmap {
    columns: usize,
    rows: usize,
    /// Bytes of a pixel: 1 for shades of grey, 3 for red, green and blue.
    depth: usize,
    bytes: Vec<u8>,
}

impl Bitmap {
    /// Returns shades of grey, 0 black, in rows of `columns`.
    ///
    /// # Errors
    ///
    /// [`FigureError::Bitmap`] where they do not fill 1 to [`MAX_BITMAP_SIDE`] rows, or `columns` is out of these bounds.
    ///
    /// ```
    /// use tilescope_figures::Bitmap;
    /// assert_eq!(Bitmap::grey(2, vec![0, 255, 255, 0]).map(|b| b.size()), Ok([2, 2]));
    /// assert!(Bitmap::grey(2, vec![0, 255, 255]).is_err());
    /// ```
    pub fn grey(columns: usize, shades: Vec<u8>) -> Result<Self, FigureError> {
        Self::new(columns, 1, shades)
    }

    /// Returns sRGB colours in rows of `columns`.
    ///
    /// # Errors
    ///
    /// As [`Self::grey`].
    pub fn rgb(columns: usize, colors: &[[u8; 3]]) -> Result<Self, FigureError> {
        Self::new(columns, 3, colors.as_flattened().to_vec())
    }

    /// Returns a bitmap of `depth` bytes for each pixel, or the error if these fill no whole rows, or if a side is 0 or
    /// too long.
    fn new(columns: usize, depth: usize, bytes: Vec<u8>) -> Result<Self, FigureError> {
        let sides = 1..=MAX_BITMAP_SIDE;
        let row = columns.saturating_mul(depth);
        // The columns are checked first: without any, a row would have no bytes, and is divided by.
        let fits = sides.contains(&columns)
            && bytes.len().is_multiple_of(row)
            && sides.contains(&(bytes.len() / row));

        if !fits {
            let bytes = bytes.len();
            return Err(FigureError::Bitmap { bytes, row });
        }

        Ok(Self {
            columns,
            rows: bytes.len() / row,
            depth,
            bytes,
        })
    }

    /// Returns columns and rows.
    #[must_use]
    pub fn size(&self) -> [usize; 2] {
        [self.columns, self.rows]
    }

    /// Returns the colour at a column and a row, or none outside.
    #[must_use]
    pub fn at(&self, column: usize, row: usize) -> Option<[u8; 3]> {
        let inside = column < self.columns && row < self.rows;
        inside.then(|| self.color(column, row))
    }

    fn color(&self, column: usize, row: usize) -> [u8; 3] {
        let start = (row * self.columns + column) * self.depth;
        match self.bytes[start..start + self.depth] {
            [r, g, b] => [r, g, b],
            _ => [self.bytes[start]; 3],
        }
    }

    /// Paints the pixels of a picture of `width` columns (RGBA) whose centres lie in both `rect` and `seen`.
    pub(crate) fn paint(&self, rgba: &mut [u8], width: usize, rect: Rect, seen: Rect) {
        let height = rgba.len() / (4 * width.max(1));
        let ends = |rect: Rect, axis: usize| [rect.min[axis], rect.max[axis]];
        let columns = spread(ends(rect, 0), ends(seen, 0), self.columns, width);
        let rows = spread(ends(rect, 1), ends(seen, 1), self.rows, height);
        for (y, row) in rows {
            for (x, column) in &columns {
                let [r, g, b] = self.color(*column, row);
                let start = 4 * (y * width + x);
                rgba[start..start + 4].copy_from_slice(&[r, g, b, 255]);
            }
        }
    }

    /// Returns the bytes of a PNG of the pixels; the same pixels give the same bytes.
    pub(crate) fn to_png(&self) -> Result<Vec<u8>, FigureError> {
        let refused = |error: png::EncodingError| FigureError::Encode(error.to_string());
        let mut bytes = Vec::new();
        let mut encoder = Encoder::new(&mut bytes, self.columns as u32, self.rows as u32);
        encoder.set_color(if self.depth == 1 {
            ColorType::Grayscale
        } else {
            ColorType::Rgb
        });
        encoder.set_depth(BitDepth::Eight);
        // Small files rather than short times: chosen, not measured.
        encoder.set_compression(Compression::High);

        let mut writer = encoder.write_header().map_err(refused)?;
        writer.write_image_data(&self.bytes).map_err(refused)?;
        writer.finish().map_err(refused)?;

        Ok(bytes)
    }
}

/// Returns the pixels of a line of `length` whose centres lie between `ends` and in `seen`, each with the cell in which its
/// centre lies.
fn spread(ends: [f64; 2], seen: [f64; 2], cells: usize, length: usize) -> Vec<(usize, usize)> {
    // The centre of the pixel of index i lies at i + 0.5.
    let from = (ends[0].max(seen[0]).max(0.0) - 0.5).ceil();
    let to = (ends[1].min(seen[1]).min(length as f64) - 0.5).ceil();
    let scale = cells as f64 / (ends[1] - ends[0]);
    // An empty line has no pixel, whatever the scale.
    (from as usize..to.max(0.0) as usize)
        .map(|pixel| {
            let cell = (pixel as f64 + 0.5 - ends[0]) * scale;
            (pixel, (cell.max(0.0) as usize).min(cells - 1))
        })
        .collect()
}

#[cfg(test)]
mod tests;
