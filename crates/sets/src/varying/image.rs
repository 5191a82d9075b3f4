//! Images as grey values, from PNG files: the same values on every machine, which decoders of JPEG do not give.

use std::io::Cursor;

use png::{BitDepth, ColorType, Decoder, Limits, Transformations};
use tilescope_formats::bytes_digest;

use super::error::VaryingError;

/// The most pixels of an image, 8192 x 8192: the field, the judge's copy and their tables then take about 2 GB.
pub const MAX_PIXELS: u64 = 1 << 26;

/// The first bytes of a PNG file.
const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Where the header of a PNG file has width and height.
const DIMENSIONS: usize = 16;

/// White, in 16 bits.
pub(super) const WHITE: u32 = 65_535;

/// Grey values of 16 bits, row by row from the lowest row up.
#[derive(Clone, Debug)]
pub struct GrayImage {
    /// The file's name and the digest of its bytes.
    pub(super) name: String,
    pub(super) digest: String,
    pub(super) columns: usize,
    pub(super) grey: Vec<u16>,
    /// Whether each pixel is at least half opaque; `None` if all are wholly.
    opaque: Option<Vec<bool>>,
}

impl GrayImage {
    /// Reads a PNG image of any colour type and depth. Colours become grey by their luminance (Rec. 709), without a change of
    /// gamma; transparent pixels lie before white.
    ///
    /// # Errors
    ///
    /// [`VaryingError::Image`] for other files, animated images and damaged ones; [`VaryingError::Pixels`].
    pub fn from_png(name: &str, bytes: &[u8]) -> Result<Self, VaryingError> {
        let fault = |reason: String| VaryingError::Image {
            name: name.to_owned(),
            reason,
        };
        if !bytes.starts_with(SIGNATURE) {
            return Err(fault(no_png(bytes).to_owned()));
        }
        // Before anything is decoded, as the decoder refuses some sizes with other words.
        let side = |at: usize| {
            bytes
                .get(at..at + 4)
                .and_then(|side| side.try_into().ok())
                .map(u32::from_be_bytes)
        };
        if let (Some(columns), Some(rows)) = (side(DIMENSIONS), side(DIMENSIONS + 4))
            && !(1..=MAX_PIXELS).contains(&(u64::from(columns) * u64::from(rows)))
        {
            let name = name.to_owned();
            return Err(VaryingError::Pixels {
                name,
                columns,
                rows,
            });
        }

        let limits = Limits { bytes: 1 << 30 };
        let mut decoder = Decoder::new_with_limits(Cursor::new(bytes), limits);
        // Palettes become colours, and depths below 8 bits 8 bits; 16 bits stay.
        decoder.set_transformations(Transformations::EXPAND);
        let damaged = |error: png::DecodingError| fault(format!("the image is damaged: {error}"));
        let mut reader = decoder.read_info().map_err(damaged)?;
        if reader.info().is_animated() {
            return Err(fault(
                "the image is animated; save one picture of it".to_owned(),
            ));
        }
        // No more than 8 bytes for each of the pixels, which were counted above.
        let size = reader.output_buffer_size().unwrap_or(0);
        let mut data = vec![0; size];
        let info = reader.next_frame(&mut data).map_err(damaged)?;

        let words = words(&data[..info.buffer_size()], info.bit_depth);
        let columns = info.width as usize;
        Ok(Self {
            name: name.to_owned(),
            digest: bytes_digest(bytes),
            columns,
            ..grey_of(&words, info.color_type, columns)
        })
    }

    /// Returns the pixels of a row and of a column.
    #[must_use]
    pub fn pixels(&self) -> [usize; 2] {
        [self.columns, self.grey.len() / self.columns]
    }

    /// Returns which pixels are inside as a mask: the opaque ones; if all are opaque, those lighter than half grey.
    pub(super) fn inside(&self) -> Vec<bool> {
        let light = || {
            self.grey
                .iter()
                .map(|&grey| u32::from(grey) > WHITE / 2)
                .collect()
        };
        self.opaque.clone().unwrap_or_else(light)
    }
}

/// Says of a file what it is instead.
fn no_png(bytes: &[u8]) -> &'static str {
    match bytes {
        [0xff, 0xd8, ..] => {
            "it is a JPEG image, whose pixels depend on the program that reads it; save it as PNG"
        }
        [b'G', b'I', b'F', b'8', ..] => "it is a GIF image; save one picture of it as PNG",
        _ => "it is no PNG image",
    }
}

/// Returns the values of a decoded image in 16 bits.
fn words(data: &[u8], depth: BitDepth) -> Vec<u16> {
    if depth == BitDepth::Sixteen {
        let pairs = data.chunks_exact(2);
        return pairs
            .map(|pair| u16::from_be_bytes([pair[0], pair[1]]))
            .collect();
    }
    data.iter().map(|&byte| u16::from(byte) * 257).collect()
}

/// Returns an image without a name.
fn grey_of(words: &[u16], color: ColorType, columns: usize) -> GrayImage {
    let (samples, has_alpha) = match color {
        ColorType::Grayscale => (1, false),
        ColorType::GrayscaleAlpha => (2, true),
        // Palettes are expanded.
        ColorType::Rgb | ColorType::Indexed => (3, false),
        ColorType::Rgba => (4, true),
    };

    // Integers to the end: floating-point luminance would be rounded as the compiler likes.
    let pixels = words.chunks_exact(samples);
    let alpha = |pixel: &[u16]| {
        if has_alpha {
            u32::from(pixel[samples - 1])
        } else {
            WHITE
        }
    };
    let grey = pixels.clone().map(|pixel| {
        let luminance = match *pixel {
            [r, g, b] | [r, g, b, _] => {
                (2126 * u32::from(r) + 7152 * u32::from(g) + 722 * u32::from(b) + 5000) / 10_000
            }
            _ => u32::from(pixel[0]),
        };
        let alpha = u64::from(alpha(pixel));
        let white = u64::from(WHITE);
        ((u64::from(luminance) * alpha + white * (white - alpha) + white / 2) / white) as u16
    });

    // An alpha channel that is opaque everywhere says nothing, and grey is the mask.
    let is_transparent = pixels.clone().any(|pixel| alpha(pixel) < WHITE);
    let opaque = is_transparent.then(|| pixels.map(|pixel| alpha(pixel) > WHITE / 2).collect());

    GrayImage {
        name: String::new(),
        digest: String::new(),
        columns,
        grey: upside_down(&grey.collect::<Vec<u16>>(), columns),
        opaque: opaque.map(|opaque: Vec<bool>| upside_down(&opaque, columns)),
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
pub(super) mod tests {
    use super::*;

    /// Returns the bytes of a PNG image.
    pub fn png(size: [u32; 2], color: ColorType, depth: BitDepth, data: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, size[0], size[1]);
        encoder.set_color(color);
        encoder.set_depth(depth);
        let mut writer = encoder.write_header().expect("a header");
        writer.write_image_data(data).expect("pixels");
        writer.finish().expect("an end");
        bytes
    }

    fn read(bytes: &[u8]) -> Result<GrayImage, String> {
        GrayImage::from_png("a.png", bytes).map_err(|error| error.to_string())
    }

    #[test]
    fn all_sixteen_bits_are_read_from_the_bottom() {
        let data = [0, 1, 255, 254, 18, 52, 0, 0];
        let bytes = png([2, 2], ColorType::Grayscale, BitDepth::Sixteen, &data);
        let image = read(&bytes).expect("an image");
        assert_eq!(image.pixels(), [2, 2]);
        assert_eq!(image.grey, [0x1234, 0, 1, 0xfffe]);
        assert_eq!(image.inside(), [false, false, false, true]);
    }

    #[test]
    fn colours_have_their_luminance_and_transparent_pixels_are_white() {
        let data = [255, 0, 0, 255, 0, 0, 0, 0, 255, 255, 255, 255];
        let bytes = png([3, 1], ColorType::Rgba, BitDepth::Eight, &data);
        let image = read(&bytes).expect("an image");
        assert_eq!(image.grey, [13_933, 65_535, 65_535]);
        // With transparency the colour does not count.
        assert_eq!(image.inside(), [true, false, true]);
    }

    #[test]
    fn what_is_no_image_to_use_is_refused_in_words() {
        let refusal = |bytes: &[u8]| read(bytes).expect_err("refused");
        assert_eq!(refusal(b"hello"), "a.png: it is no PNG image");
        assert!(refusal(b"\xff\xd8\xff\xee").contains("JPEG"));

        let mut bytes = png([2, 1], ColorType::Grayscale, BitDepth::Eight, &[1, 2]);
        bytes[16..24].copy_from_slice(&[0, 0, 0, 0, 0, 0, 0, 1]);
        assert!(refusal(&bytes).contains("0 x 1 pixels; from 1 to 67108864"));
        bytes[16..24].copy_from_slice(&[0, 0, 0x75, 0x30, 0, 0, 0x75, 0x30]);
        assert!(refusal(&bytes).contains("30000 x 30000 pixels"));
        let whole = png([2, 1], ColorType::Grayscale, BitDepth::Eight, &[1, 2]);
        assert!(refusal(&whole[..40]).contains("the image is damaged"));

        let mut animated = Vec::new();
        let mut encoder = png::Encoder::new(&mut animated, 1, 1);
        encoder.set_animated(2, 0).expect("frames");
        let mut writer = encoder.write_header().expect("a header");
        for _ in 0..2 {
            writer.write_image_data(&[0]).expect("a frame");
        }
        writer.finish().expect("an end");
        assert!(refusal(&animated).contains("animated"));
    }
}
