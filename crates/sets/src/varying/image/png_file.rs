//! PNG files of any colour type and depth.

use std::io::Cursor;

use png::{BitDepth, ColorType, Decoder, Limits, Transformations};

use super::super::error::VaryingError;
use super::{ImageFile, Pixels, WHITE};

/// The first bytes of a PNG file.
pub(super) const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Where the header of a PNG file has width and height.
const DIMENSIONS: usize = 16;

/// Decodes a PNG image.
pub(super) fn read(file: &ImageFile<'_>) -> Result<Pixels, VaryingError> {
    // The size is checked before anything is decoded, since the decoder would refuse some sizes with a message of its
    // own.
    let side = |at: usize| {
        let bytes = file.bytes.get(at..at + 4);
        bytes
            .and_then(|side| side.try_into().ok())
            .map(u32::from_be_bytes)
    };
    if let (Some(columns), Some(rows)) = (side(DIMENSIONS), side(DIMENSIONS + 4)) {
        file.check_size(columns, rows)?;
    }

    // The limit is twice the largest image: 2^26 pixels of 8 bytes each.
    let limits = Limits { bytes: 1 << 30 };
    let mut decoder = Decoder::new_with_limits(Cursor::new(file.bytes), limits);
    // Palettes become colours, and depths below 8 bits 8 bits; 16 bits stay.
    decoder.set_transformations(Transformations::EXPAND);
    let damaged = |error: png::DecodingError| file.fault(format!("the image is damaged: {error}"));
    let mut reader = decoder.read_info().map_err(damaged)?;
    if reader.info().is_animated() {
        return Err(file.fault("the image is animated; save one picture of it"));
    }
    // The buffer has at most 8 bytes for each pixel, and the number of pixels was checked above, so that its size never
    // overflows.
    let size = reader.output_buffer_size().unwrap_or(0);
    let mut data = vec![0; size];
    let info = reader.next_frame(&mut data).map_err(damaged)?;

    let values = words(&data[..info.buffer_size()], info.bit_depth);
    Ok(pixels(&values, info.color_type, info.width as usize))
}

/// Encodes grey values of 16 bits, row by row from the highest row down.
///
/// Fails only if the encoder does, which writes to memory.
pub(in crate::varying) fn encoded(
    columns: usize,
    light: &[u16],
) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, columns as u32, (light.len() / columns) as u32);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(BitDepth::Sixteen);
    let data: Vec<u8> = light.iter().flat_map(|value| value.to_be_bytes()).collect();
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&data)?;
    writer.finish()?;
    Ok(bytes)
}

/// Returns the values of a decoded image in 16 bits.
fn words(data: &[u8], depth: BitDepth) -> Vec<u16> {
    if depth == BitDepth::Sixteen {
        let pairs = data.chunks_exact(2);
        return pairs
            .map(|pair| u16::from_be_bytes([pair[0], pair[1]]))
            .collect();
    }
    // 257 times 255 is 65,535: black and white stay what they are.
    data.iter().map(|&byte| u16::from(byte) * 257).collect()
}

/// Returns the luminance of pixels, and their alpha if some of them are transparent.
pub(super) fn pixels(words: &[u16], color: ColorType, columns: usize) -> Pixels {
    let (channels, has_alpha) = match color {
        ColorType::Grayscale => (1, false),
        ColorType::GrayscaleAlpha => (2, true),
        // Palettes are expanded.
        ColorType::Rgb | ColorType::Indexed => (3, false),
        ColorType::Rgba => (4, true),
    };

    // The weights of Rec. 709, in integers: they have the same bits everywhere. Half of the divisor rounds to the
    // nearest.
    let all = words.chunks_exact(channels);
    let light = all.clone().map(|pixel| match *pixel {
        [r, g, b] | [r, g, b, _] => {
            let luminance = 2126 * u32::from(r) + 7152 * u32::from(g) + 722 * u32::from(b);
            ((luminance + 5000) / 10_000) as u16
        }
        _ => pixel[0],
    });
    // An alpha channel that is opaque everywhere is left out, so that the grey values serve as the mask.
    let alpha = |pixel: &[u16]| pixel[channels - 1];
    let is_transparent = has_alpha && all.clone().any(|pixel| u32::from(alpha(pixel)) < WHITE);
    Pixels {
        columns,
        light: light.collect(),
        alpha: is_transparent.then(|| all.map(alpha).collect()),
    }
}
