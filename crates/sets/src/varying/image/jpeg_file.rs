//! JPEG files. Decoders differ in the last bits, where they convert colours and enlarge the planes of chroma: of these files
//! the plane of luma is read, and nothing else. Its values come from wrapping 32-bit integers in a fixed sequence, with vector
//! instructions and without.

use zune_jpeg::JpegDecoder;
use zune_jpeg::errors::DecodeErrors;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use super::super::error::VaryingError;
use super::{ImageFile, Pixels};

/// The first bytes of a JPEG file.
pub(super) const SIGNATURE: &[u8] = b"\xff\xd8\xff";

/// The longest side of a JPEG image that its file can state.
const MAX_SIDE: usize = 65_535;

/// Decodes the luma of a JPEG image.
pub(super) fn read(file: &ImageFile<'_>) -> Result<Pixels, VaryingError> {
    let damaged =
        |error: DecodeErrors| file.fault(format!("the image cannot be decoded: {error:?}"));
    let options = DecoderOptions::default()
        .jpeg_set_out_colorspace(ColorSpace::Luma)
        .set_max_width(MAX_SIDE)
        .set_max_height(MAX_SIDE)
        // A decoder that goes on after a fault would lose a part of the image without an error.
        .set_strict_mode(true);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(file.bytes), options);
    // The size is checked twice: as the file states it, for a message of our own, and as the decoder will decode it.
    if let Some([columns, rows]) = stated_size(file.bytes) {
        file.check_size(columns, rows)?;
    }
    decoder.decode_headers().map_err(damaged)?;
    if let Some(info) = decoder.info() {
        file.check_size(info.width.into(), info.height.into())?;
    }

    // Grey images and those in YCbCr have luma as their first plane. Other colours have no grey that all programs agree
    // on.
    match decoder.input_colorspace() {
        Some(ColorSpace::Luma | ColorSpace::YCbCr) => {}
        Some(ColorSpace::CMYK | ColorSpace::YCCK) => {
            return Err(file.fault(
                "the image has the colours of four inks (CMYK), whose grey depends on a profile; save it in RGB",
            ));
        }
        _ => {
            return Err(file.fault(
                "the image has no plane of luma, as ordinary JPEG images have; save it as PNG",
            ));
        }
    }

    let luma = decoder.decode().map_err(damaged)?;
    // The headers were decoded above, so that the width is there.
    let columns = decoder.info().map_or(1, |info| usize::from(info.width));
    // 257 times 255 is 65,535: black stays the least and white the greatest value.
    let light = luma.iter().map(|&byte| u16::from(byte) * 257).collect();
    let turn = decoder.exif().map_or(1, |exif| orientation(exif));
    Ok(turned(light, columns, turn))
}

/// Returns width and height as the header of a frame states them, before a decoder refuses some sizes with other words.
/// Nothing if no such header is found: the decoder then names the fault.
fn stated_size(bytes: &[u8]) -> Option<[u32; 2]> {
    // Segments follow the two bytes that begin the image. Each begins with 255, a marker and its length.
    let mut rest = bytes.get(2..)?;
    loop {
        let [0xff, marker, high, low, ..] = *rest else {
            return None;
        };
        let length = usize::from(u16::from_be_bytes([high, low]));
        // Frames of all kinds, but for three other segments in their range.
        if matches!(marker, 0xc0..=0xcf) && !matches!(marker, 0xc4 | 0xc8 | 0xcc) {
            // Behind the marker, the length and the depth come the rows, and then the columns.
            let side = |at: usize| {
                let side = rest.get(at..at + 2)?;
                Some(u32::from(u16::from_be_bytes([side[0], side[1]])))
            };
            return Some([side(7)?, side(5)?]);
        }
        // A length counts its own two bytes. With less, the next marker would be read from within this one.
        rest = rest.get(2 + length.max(2)..)?;
    }
}

/// Returns the orientation that Exif data state, from 1, upright, to 8: at which sides of the picture the file's first
/// row and first column lie.
fn orientation(exif: &[u8]) -> u16 {
    const UPRIGHT: u16 = 1;
    const ORIENTATION_TAG: u32 = 0x0112;
    // Exif data are a TIFF file, which begins with MM where the greatest byte of a number comes first, and otherwise
    // with II.
    let is_big = exif.starts_with(b"MM");
    let number = |at: usize, length: usize| -> Option<u32> {
        let bytes = exif.get(at..at.checked_add(length)?)?;
        let add = |sum: u32, &byte: &u8| sum << 8 | u32::from(byte);
        Some(if is_big {
            bytes.iter().fold(0, add)
        } else {
            bytes.iter().rev().fold(0, add)
        })
    };

    let find = || {
        // Bytes 4 to 7 of the header say where the first directory lies.
        let directory = number(4, 4)? as usize;
        let entries = number(directory, 2)? as usize;
        // An entry has twelve bytes: what it is, its type, how many values, and a value of up to four bytes.
        let mut all = (0..entries).map(|index| directory + 2 + 12 * index);
        let entry = all.find(|&entry| number(entry, 2) == Some(ORIENTATION_TAG))?;
        // An orientation is a number of two bytes, which are the first of the four, whichever order they have.
        number(entry + 8, 2)
    };
    let found = find().filter(|found| (1..=8).contains(found));
    found.map_or(UPRIGHT, |found| found as u16)
}

/// Returns pixels turned upright. `orientation` is that of Exif data, from 1, upright, to 8.
fn turned(light: Vec<u16>, columns: usize, orientation: u16) -> Pixels {
    if orientation == 1 {
        return Pixels {
            columns,
            light,
            alpha: None,
        };
    }

    let rows = light.len() / columns;
    // From 5 on the file's columns are the picture's rows. With some numbers the file has its columns from right to
    // left, or its rows from below, as the picture is seen.
    let is_transposed = orientation >= 5;
    let mirrors_columns = matches!(orientation, 2 | 3 | 7 | 8);
    let mirrors_rows = matches!(orientation, 3 | 4 | 6 | 7);

    let new = if is_transposed {
        [rows, columns]
    } else {
        [columns, rows]
    };
    let from = |row: usize, column: usize| {
        let [x, y] = if is_transposed {
            [row, column]
        } else {
            [column, row]
        };
        let x = if mirrors_columns { columns - 1 - x } else { x };
        let y = if mirrors_rows { rows - 1 - y } else { y };
        light[y * columns + x]
    };
    let all = (0..new[1]).flat_map(|row| (0..new[0]).map(move |column| (row, column)));
    Pixels {
        columns: new[0],
        light: all.map(|(row, column)| from(row, column)).collect(),
        alpha: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Exif data with one entry, in one of the two sequences of bytes.
    fn exif(is_big: bool, orientation: u16) -> Vec<u8> {
        let word = |value: u16| {
            if is_big {
                value.to_be_bytes()
            } else {
                value.to_le_bytes()
            }
        };
        let long = |value: u32| {
            if is_big {
                value.to_be_bytes()
            } else {
                value.to_le_bytes()
            }
        };
        let mut bytes = if is_big { b"MM" } else { b"II" }.to_vec();
        bytes.extend(word(42));
        bytes.extend(long(8));
        bytes.extend(word(1));
        bytes.extend(word(0x0112));
        bytes.extend(word(3));
        bytes.extend(long(1));
        bytes.extend(word(orientation));
        bytes.extend(word(0));
        bytes
    }

    #[test]
    fn an_image_is_turned_as_it_says() {
        for (is_big, value) in (1..=8).flat_map(|value| [(true, value), (false, value)]) {
            assert_eq!(orientation(&exif(is_big, value)), value);
        }
        // The control: a number beyond 8, data cut off and empty data leave the image as it is.
        assert_eq!(orientation(&exif(true, 9)), 1);
        assert_eq!(orientation(&exif(true, 6)[..18]), 1);
        assert_eq!(orientation(b""), 1);

        // A picture of two rows, of three pixels, as a camera stores it. By the standard the first row of 6 is the right side
        // and its first column the top, of 8 the left side and the bottom.
        let stored = vec![1, 2, 3, 4, 5, 6];
        let shown = |orientation| {
            let pixels = turned(stored.clone(), 3, orientation);
            (pixels.columns, pixels.light)
        };
        assert_eq!(shown(1), (3, vec![1, 2, 3, 4, 5, 6]));
        assert_eq!(shown(2), (3, vec![3, 2, 1, 6, 5, 4]));
        assert_eq!(shown(3), (3, vec![6, 5, 4, 3, 2, 1]));
        assert_eq!(shown(4), (3, vec![4, 5, 6, 1, 2, 3]));
        assert_eq!(shown(5), (2, vec![1, 4, 2, 5, 3, 6]));
        assert_eq!(shown(6), (2, vec![4, 1, 5, 2, 6, 3]));
        assert_eq!(shown(7), (2, vec![6, 3, 5, 2, 4, 1]));
        assert_eq!(shown(8), (2, vec![3, 6, 2, 5, 1, 4]));
    }
}
