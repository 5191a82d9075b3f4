//! What changes from one frame to the next: the smallest rectangle around it, and which pixels in it stay as they
//! are. That is little for most steps, and what stays compresses to nearly nothing.

use crate::raster::Pixels;

/// What a frame changes.
pub(super) struct Change {
    pub left: u32,
    pub top: u32,
    pub width: u32,
    pub height: u32,
    /// The pixels of the rectangle.
    pub rgba: Vec<u8>,
    /// Whether each of them is as it was before.
    pub stays: Vec<bool>,
}

/// The pixels of a changed rectangle, red, green, blue and opacity.
pub(super) enum Layer {
    /// They are laid over those of the frame before, which show through the transparent ones.
    Over(Vec<u8>),
    /// They are put in their place.
    Instead(Vec<u8>),
}

impl Change {
    /// Returns the change from one frame to another of the same size; without a frame before, the whole frame is the change. A
    /// frame that changes nothing has one pixel, which stays.
    pub fn between(before: Option<&Pixels>, now: &Pixels) -> Self {
        let width = now.width as usize;
        // For each pixel of the frame, whether it is as it was before.
        let stays: Vec<bool> = match before {
            Some(before) => {
                let pairs = before.rgba.chunks_exact(4).zip(now.rgba.chunks_exact(4));
                pairs.map(|(before, now)| before == now).collect()
            }
            None => vec![false; now.rgba.len() / 4],
        };

        // Where nothing differs, the first pixel stands for the frame, since no format has frames without pixels. Rows
        // of no length cannot be cut, so that a frame without columns has rows of one.
        let rows = || stays.chunks_exact(width.max(1));
        let differs = |row: &[bool]| row.contains(&false);
        let top = rows().position(differs).unwrap_or(0);
        let bottom = rows().rposition(differs).unwrap_or(0);
        let left = rows()
            .filter_map(|row| row.iter().position(|stays| !stays))
            .min()
            .unwrap_or(0);
        let right = rows()
            .filter_map(|row| row.iter().rposition(|stays| !stays))
            .max()
            .unwrap_or(0);

        let (columns, height) = (left..right + 1, bottom + 1 - top);
        let mut change = Self {
            left: left as u32,
            top: top as u32,
            width: columns.len() as u32,
            height: height as u32,
            rgba: Vec::with_capacity(4 * columns.len() * height),
            stays: Vec::with_capacity(columns.len() * height),
        };

        for (y, row) in rows().enumerate().skip(top).take(height) {
            let start = 4 * (y * width + left);
            let end = start + 4 * columns.len();
            change.rgba.extend(&now.rgba[start..end]);
            change.stays.extend(&row[columns.clone()]);
        }

        change
    }

    /// Returns the pixels to lay over the frame before: those that stay are transparent. Where all pixels change, or a
    /// changed one is not opaque, they are to be put in the place of the old ones.
    pub fn layer(&self) -> Layer {
        let mut rgba = self.rgba.clone();
        let pixels = || self.rgba.chunks_exact(4).zip(&self.stays);

        // A changed pixel that is not opaque would let the old one show through. If all change, transparency saves nothing.
        let all_change = !self.stays.contains(&true);
        if all_change || pixels().any(|(pixel, stays)| !stays && pixel[3] != 255) {
            return Layer::Instead(rgba);
        }

        // All transparent pixels are alike, and so compress to nearly nothing.
        for (pixel, _) in rgba
            .chunks_exact_mut(4)
            .zip(&self.stays)
            .filter(|(_, stays)| **stays)
        {
            pixel.fill(0);
        }

        Layer::Over(rgba)
    }
}
