//! Images as grey values, from PNG and JPEG files: the same values on every machine.

mod jpeg_file;
mod png_file;
mod tone;

use std::sync::Arc;

use png::ColorType;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use tilescope_formats::bytes_digest;

use super::error::VaryingError;
use super::stated_file;

pub use tone::Tone;

/// The most pixels of an image, 8192 x 8192: the field, the judge's copy and their tables then take about 2 GB.
pub const MAX_PIXELS: u64 = 1 << 26;

/// About this many grey values are looked at before an image is used.
const FEW: usize = 4096;

/// White, in 16 bits.
pub(super) const WHITE: u32 = 65_535;

/// Grey values of 16 bits, row by row from the lowest row up.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct GrayImage {
    /// The file's name, or nothing if it is not from a file.
    name: String,
    /// The digest of the file's bytes, or of the pixels.
    digest: String,
    pub(super) columns: usize,
    /// The tone of the light, on white paper where the image is transparent.
    pub(super) grey: Arc<[u16]>,
    /// How grey values follow from the light of the pixels.
    pub(super) tone: Tone,
    /// The side of the squares of pixels whose mean each grey value is.
    pub(super) block: usize,
    pixels: Arc<Pixels>,
}

/// Images are equal if they are of files with the same bytes, in the same tone and the same blocks.
impl PartialEq for GrayImage {
    fn eq(&self, other: &Self) -> bool {
        let content = |image: &Self| (image.columns, image.tone, image.block);
        self.digest == other.digest && content(self) == content(other)
    }
}

/// The pixels of a file, row by row from the highest row down.
#[derive(Debug, Serialize, Deserialize)]
struct Pixels {
    columns: usize,
    /// The luminance of each pixel.
    light: Vec<u16>,
    /// Opacity; `None` if all pixels are wholly opaque.
    alpha: Option<Vec<u16>>,
}

impl GrayImage {
    /// Returns few of the grey values, from all parts of the image.
    pub(super) fn few(&self) -> impl Iterator<Item = u16> {
        few_of(&self.grey)
    }

    /// Returns whether a file of these bytes is one that [`Self::read`] reads, or an image of another kind that it names.
    #[must_use]
    pub fn is_image(bytes: &[u8]) -> bool {
        bytes.starts_with(png_file::SIGNATURE) || bytes.starts_with(jpeg_file::SIGNATURE)
    }

    /// Reads a PNG image of any colour type and depth, or a JPEG image. Colours of PNG become grey by their luminance (Rec.
    /// 709), without a change of gamma; the grey of JPEG is its luma, as it is stored. Transparent pixels lie before white. A
    /// JPEG image is turned upright, if it says how.
    ///
    /// # Errors
    ///
    /// [`VaryingError::Image`] for other files, animated images and damaged ones; [`VaryingError::Pixels`] without
    /// pixels, and with more than [`MAX_PIXELS`].
    pub fn read(name: &str, bytes: &[u8]) -> Result<Self, VaryingError> {
        let file = ImageFile { name, bytes };
        let pixels = if bytes.starts_with(png_file::SIGNATURE) {
            png_file::read(&file)?
        } else if bytes.starts_with(jpeg_file::SIGNATURE) {
            jpeg_file::read(&file)?
        } else {
            return Err(file.fault(other_kind(bytes)));
        };

        // The image as it is, until another tone or larger blocks are asked for.
        let tone = Tone::default();
        Ok(Self {
            name: name.to_owned(),
            digest: bytes_digest(bytes),
            columns: pixels.columns,
            grey: pixels.grey(&tone).into(),
            tone,
            block: 1,
            pixels: Arc::new(pixels),
        })
    }

    /// Returns the same image in another tone, of all its pixels.
    ///
    /// # Errors
    ///
    /// [`VaryingError::Tone`] when a number of the tone is out of range.
    pub fn toned(&self, tone: Tone) -> Result<Self, VaryingError> {
        tone.check()?;
        Ok(Self {
            columns: self.pixels.columns,
            grey: self.pixels.grey(&tone).into(),
            tone,
            block: 1,
            ..self.clone()
        })
    }

    /// Returns the image with the mean grey of squares of `block` x `block` pixels in their place.
    ///
    /// # Errors
    ///
    /// [`VaryingError::Block`] unless such squares fill the image.
    pub(super) fn in_blocks(&self, block: usize) -> Result<Self, VaryingError> {
        let pixels = self.pixels();
        if block == 0 || pixels.iter().any(|count| count % block != 0) {
            return Err(VaryingError::Block { block, pixels });
        }

        // A band of rows at a time, so that the sums of a row of blocks are all that is held.
        let columns = self.columns / block;
        let bands = self.grey.chunks_exact(self.columns * block);
        let mut grey = Vec::with_capacity(self.grey.len() / (block * block));
        for band in bands {
            let mut sums = vec![0_u64; columns];
            for row in band.chunks_exact(self.columns) {
                for (sum, values) in sums.iter_mut().zip(row.chunks_exact(block)) {
                    *sum += values.iter().map(|&grey| u64::from(grey)).sum::<u64>();
                }
            }
            // Half of the area is added, so that means are rounded to the nearest value.
            let area = (block * block) as u64;
            grey.extend(sums.iter().map(|sum| ((sum + area / 2) / area) as u16));
        }
        Ok(Self {
            columns,
            grey: grey.into(),
            block: self.block * block,
            ..self.clone()
        })
    }

    /// Returns an image of grey values, row by row from the lowest row up.
    ///
    /// # Errors
    ///
    /// [`VaryingError::Grid`] unless there are whole rows, [`VaryingError::Pixels`] with more than [`MAX_PIXELS`].
    pub fn from_grey(columns: usize, grey: Vec<u16>) -> Result<Self, VaryingError> {
        check_pixels(columns, grey.len())?;
        let pixels = Pixels {
            columns,
            light: upside_down(&grey, columns),
            alpha: None,
        };
        Ok(Self::unnamed(pixels, grey))
    }

    /// Returns an image of pixels of 16 bits, row by row from the highest row down: what [`Self::read`] reads of a PNG file
    /// of them. Each has so many `channels`: grey, grey and opacity, three colours, or these and opacity.
    ///
    /// # Errors
    ///
    /// [`VaryingError::Grid`] unless there are whole rows of whole pixels of at most four channels, [`VaryingError::Pixels`]
    /// with more than [`MAX_PIXELS`].
    pub fn from_channels(
        columns: usize,
        channels: usize,
        words: &[u16],
    ) -> Result<Self, VaryingError> {
        let count = words.len();
        let partial = VaryingError::Grid { count, columns };
        let color = match channels {
            1 => ColorType::Grayscale,
            2 => ColorType::GrayscaleAlpha,
            3 => ColorType::Rgb,
            4 => ColorType::Rgba,
            _ => return Err(partial),
        };
        // Words beyond the last whole pixel are no pixel.
        if !words.len().is_multiple_of(channels) {
            return Err(partial);
        }
        check_pixels(columns, words.len() / channels)?;
        let pixels = png_file::pixels(words, color, columns);
        let grey = pixels.grey(&Tone::default());
        Ok(Self::unnamed(pixels, grey))
    }

    /// Returns an image that is not from a file, with its grey values as they are in no other tone. Certificates know it by a
    /// digest of its pixels.
    fn unnamed(pixels: Pixels, grey: Vec<u16>) -> Self {
        let columns = pixels.columns;
        // Without the number of columns, arrays of other shapes and the same values would have one digest.
        let mut bytes = format!("tilescope grey: {columns} columns\n").into_bytes();
        let light = upside_down(&pixels.light, columns);
        bytes.extend(light.iter().flat_map(|light| light.to_le_bytes()));
        // Of an opaque image this adds nothing, so that it has the digest of its grey values.
        for alpha in pixels.alpha.iter().flatten() {
            bytes.extend(alpha.to_le_bytes());
        }

        Self {
            name: String::new(),
            digest: bytes_digest(&bytes),
            columns,
            grey: grey.into(),
            tone: Tone::default(),
            block: 1,
            pixels: Arc::new(pixels),
        }
    }

    /// Returns the image that [`Self::read`] reads of a PNG file of these grey values, which are row by row from the lowest row up, and
    /// have 16 bits in the file.
    ///
    /// # Errors
    ///
    /// [`VaryingError::Grid`] unless there are whole rows, [`VaryingError::Pixels`] with more than [`MAX_PIXELS`].
    pub fn as_png(name: &str, columns: usize, grey: &[u16]) -> Result<Self, VaryingError> {
        check_pixels(columns, grey.len())?;
        let encoded = png_file::encoded(columns, &upside_down(grey, columns));
        let bytes = encoded.map_err(|error| VaryingError::Image {
            name: name.to_owned(),
            reason: error.to_string(),
        })?;
        Self::read(name, &bytes)
    }

    /// Returns a PNG file of the grey values, in 16 bits: the one that [`Self::as_png`] has read, byte by byte.
    ///
    /// # Errors
    ///
    /// [`VaryingError::Image`] if it cannot be encoded.
    pub fn to_png(&self) -> Result<Vec<u8>, VaryingError> {
        let encoded = png_file::encoded(self.columns, &upside_down(&self.grey, self.columns));
        encoded.map_err(|error| VaryingError::Image {
            name: self.name.clone(),
            reason: error.to_string(),
        })
    }

    /// Returns the name of the image for messages.
    #[must_use]
    pub fn name(&self) -> &str {
        if self.name.is_empty() {
            "the array"
        } else {
            &self.name
        }
    }

    /// Returns how certificates state the image: by its file or its pixels, and its content.
    pub(super) fn stated(&self) -> Value {
        if self.name.is_empty() {
            return json!({ "pixels": self.pixels(), "digest": self.digest });
        }
        stated_file(&self.name, &self.digest)
    }

    /// Returns its tone.
    #[must_use]
    pub fn tone(&self) -> Tone {
        self.tone
    }

    /// Returns the grey values of a row and of a column.
    #[must_use]
    pub fn pixels(&self) -> [usize; 2] {
        [self.columns, self.grey.len() / self.columns]
    }

    /// Returns how dark the pixel at a place is, 0 white and 1 black. The image covers the domain from 0 to `size`.
    #[must_use]
    pub fn darkness_at(&self, place: [f64; 2], size: [f64; 2]) -> f64 {
        let pixels = self.pixels();
        let [column, row] = [0, 1].map(|axis| {
            let at = place[axis] / size[axis] * pixels[axis] as f64;
            // The border of a bounded domain belongs to its last pixel.
            (at as usize).min(pixels[axis] - 1)
        });
        darkness(self.grey[row * self.columns + column])
    }

    /// Returns whether it has transparent pixels, so that as a mask its opaque ones are inside, and not its light ones.
    #[must_use]
    pub fn has_transparency(&self) -> bool {
        self.pixels.alpha.is_some()
    }

    /// Returns which pixels are inside as a mask: the opaque ones; if all are opaque, those lighter than half grey.
    pub(super) fn inside(&self) -> Vec<bool> {
        match &self.pixels.alpha {
            Some(alpha) => {
                let opaque: Vec<bool> = alpha.iter().copied().map(is_more_than_half).collect();
                upside_down(&opaque, self.columns)
            }
            None => self.grey.iter().copied().map(is_more_than_half).collect(),
        }
    }

    /// Returns about which share of its pixels is inside as a mask, from few of them: cheap enough to be asked for in each
    /// frame of a window.
    #[must_use]
    pub fn inside_share(&self) -> f64 {
        // The sequence of rows makes no difference to a share.
        let values: &[u16] = self.pixels.alpha.as_deref().unwrap_or(&self.grey);
        let few = few_of(values);
        let [inside, all] = few.fold([0, 0], |[inside, all], value| {
            [inside + u32::from(is_more_than_half(value)), all + 1]
        });
        f64::from(inside) / f64::from(all)
    }

    /// Returns which grey values are at least so dark: 0 is white, and 1 black.
    pub(super) fn darker_than(&self, least: f64) -> Vec<bool> {
        self.grey
            .iter()
            .map(|&grey| darkness(grey) >= least)
            .collect()
    }

    /// Returns the sum of the darkness of the pixels that are at least so dark, in black pixels.
    pub(super) fn darkness(&self, least: f64) -> f64 {
        let dark = self.grey.iter().filter(|&&grey| darkness(grey) >= least);
        // A sum of integers has no rounding that depends on its order.
        let sum: u64 = dark.map(|&grey| u64::from(WHITE - u32::from(grey))).sum();
        sum as f64 / f64::from(WHITE)
    }

    /// Returns how many pixels are at least as dark as `least`, and not as dark as `most`.
    pub(super) fn lighter_than(&self, least: f64, most: f64) -> usize {
        let between = |&&grey: &&u16| (least..most).contains(&darkness(grey));
        self.grey.iter().filter(between).count()
    }
}

impl Pixels {
    /// Returns the grey values in a tone, from the lowest row up.
    fn grey(&self, tone: &Tone) -> Vec<u16> {
        let of = tone.table();
        let shown = |&light: &u16| of[usize::from(light)];
        let grey: Vec<u16> = match &self.alpha {
            None => self.light.iter().map(shown).collect(),
            Some(alpha) => (self.light.iter().zip(alpha))
                .map(|(light, &alpha)| before_white(shown(light), alpha))
                .collect(),
        };
        upside_down(&grey, self.columns)
    }
}

/// Returns few of the values of an image, from all parts of it.
fn few_of(values: &[u16]) -> impl Iterator<Item = u16> {
    // An odd step, as one that divides a row would see few columns alone.
    let step = (values.len() / FEW) | 1;
    values.iter().copied().step_by(step)
}

/// Returns whether a value is nearer to light or opaque than to dark or transparent.
fn is_more_than_half(value: u16) -> bool {
    u32::from(value) > WHITE / 2
}

/// Returns a grey value of some opacity before white.
fn before_white(grey: u16, alpha: u16) -> u16 {
    let [grey, alpha, white] = [grey.into(), alpha.into(), u64::from(WHITE)];
    // Half of the divisor makes the division round to the nearest.
    ((grey * alpha + white * (white - alpha) + white / 2) / white) as u16
}

/// Returns how dark a grey value is: 0 is white, and 1 black.
fn darkness(grey: u16) -> f64 {
    f64::from(WHITE - u32::from(grey)) / f64::from(WHITE)
}

/// A file that is to be an image.
struct ImageFile<'a> {
    name: &'a str,
    bytes: &'a [u8],
}

impl ImageFile<'_> {
    fn fault(&self, reason: impl Into<String>) -> VaryingError {
        VaryingError::Image {
            name: self.name.to_owned(),
            reason: reason.into(),
        }
    }

    /// Refuses an image without pixels, or with too many.
    fn check_size(&self, columns: u32, rows: u32) -> Result<(), VaryingError> {
        if (1..=MAX_PIXELS).contains(&(u64::from(columns) * u64::from(rows))) {
            return Ok(());
        }
        Err(VaryingError::Pixels {
            name: self.name.to_owned(),
            columns,
            rows,
        })
    }
}

/// Refuses pixels that are no whole rows, and too many.
pub(super) fn check_pixels(columns: usize, count: usize) -> Result<(), VaryingError> {
    if columns == 0 || count == 0 || !count.is_multiple_of(columns) {
        return Err(VaryingError::Grid { count, columns });
    }
    // Counted before anything is made of them.
    if count as u64 > MAX_PIXELS {
        let side = |count: usize| u32::try_from(count).unwrap_or(u32::MAX);
        return Err(VaryingError::Pixels {
            name: "the array".to_owned(),
            columns: side(columns),
            rows: side(count / columns),
        });
    }
    Ok(())
}

/// Says of a file what it is instead.
fn other_kind(bytes: &[u8]) -> &'static str {
    match bytes {
        [b'G', b'I', b'F', b'8', ..] => "it is a GIF image; save one picture of it as PNG",
        _ if bytes.starts_with(b"RIFF") && bytes.get(8..12) == Some(b"WEBP") => {
            "it is a WebP image; save it as PNG"
        }
        [_, _, _, _, b'f', b't', b'y', b'p', ..] => {
            "it is a video, or an image as HEIC or AVIF; save it as PNG"
        }
        _ => "it is no PNG or JPEG image",
    }
}

/// Returns rows in the other order: images begin at the top, domains at the bottom.
fn upside_down<T: Copy>(values: &[T], columns: usize) -> Vec<T> {
    values
        .chunks_exact(columns)
        .rev()
        .flatten()
        .copied()
        .collect()
}

#[cfg(test)]
pub(super) mod tests;
