//! Images are read to the last bit, in all tones, and others are refused in words.

use png::{BitDepth, ColorType};

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
    GrayImage::read("a.png", bytes).map_err(|error| error.to_string())
}

#[test]
fn all_sixteen_bits_are_read_from_the_bottom() {
    let data = [0, 1, 255, 254, 18, 52, 0, 0];
    let bytes = png([2, 2], ColorType::Grayscale, BitDepth::Sixteen, &data);
    let image = read(&bytes).expect("an image");
    assert_eq!(image.pixels(), [2, 2]);
    assert_eq!(*image.grey, [0x1234, 0, 1, 0xfffe]);
    assert_eq!(image.inside(), [false, false, false, true]);
    assert_eq!(
        (image.inside_share(), image.has_transparency()),
        (0.25, false)
    );
}

#[test]
fn colours_have_their_luminance_and_transparent_pixels_are_white() {
    let data = [255, 0, 0, 255, 0, 0, 0, 0, 255, 255, 255, 255];
    let bytes = png([3, 1], ColorType::Rgba, BitDepth::Eight, &data);
    let image = read(&bytes).expect("an image");
    assert_eq!(*image.grey, [13_933, 65_535, 65_535]);
    // With transparency the colour does not count.
    assert_eq!(image.inside(), [true, false, true]);
    assert_eq!(
        (image.inside_share(), image.has_transparency()),
        (2.0 / 3.0, true)
    );
}

#[test]
fn pixels_of_a_program_are_those_of_a_file() {
    let words: Vec<u16> = (0..48)
        .map(|word| 65_535 - 1_300 * (word * 7 % 48))
        .collect();
    let data: Vec<u8> = words.iter().flat_map(|word| word.to_be_bytes()).collect();
    let tone = Tone {
        gamma: 1.7,
        contrast: 1.2,
        is_inverted: true,
    };
    for (channels, columns, color) in [
        (1, 6, ColorType::Grayscale),
        (2, 4, ColorType::GrayscaleAlpha),
        (3, 4, ColorType::Rgb),
        (4, 3, ColorType::Rgba),
    ] {
        let rows = 48 / (columns * channels);
        let file = png([columns, rows], color, BitDepth::Sixteen, &data);
        let file = read(&file).expect("an image").toned(tone).expect("a tone");
        let of = |words: &[u16]| {
            let image = GrayImage::from_channels(columns as usize, channels as usize, words);
            image.and_then(|image| image.toned(tone)).expect("an image")
        };
        let image = of(&words);
        assert_eq!((&image.grey, image.inside()), (&file.grey, file.inside()));

        // The controls: other pixels are another image, and so is another opacity alone.
        let mut other = words.clone();
        other[47] ^= 1 << 15;
        assert_ne!(of(&other), image);
        // Rows of other lengths and words beyond the last pixel.
        let columns = columns as usize;
        for (channels, words) in [
            (0, &words[..]),
            (5, &words[..]),
            (channels as usize, &words[1..]),
        ] {
            assert!(GrayImage::from_channels(columns, channels, words).is_err());
        }
    }

    // One with a channel of opacity that is opaque everywhere is the image without it.
    let opaque = [9, 65_535, 700, 65_535];
    let plain = GrayImage::from_grey(2, vec![9, 700]).expect("whole rows");
    assert_eq!(
        GrayImage::from_channels(2, 2, &opaque).expect("an image"),
        plain
    );
}

#[test]
fn jpeg_images_have_their_luma_as_it_is_stored() {
    let photo = include_bytes!("../../../../tilescope/tests/it/images/photo.jpg");
    let image = read(photo).expect("an image");
    assert_eq!(image.pixels(), [40, 30]);
    // 8 bits are all that there is, and white would be 65,535.
    assert!(image.grey.iter().all(|grey| grey % 257 == 0));
    let bytes: Vec<u8> = image.grey.iter().map(|grey| (grey / 257) as u8).collect();
    // The middle is light and the corners are dark.
    assert!(bytes[15 * 40 + 20] > 170 && bytes[0] < 90);
    // On every machine.
    assert_eq!(
        bytes_digest(&bytes),
        "blake3:0e67cf57204b611868f0d2e798510c95daa8da17ee138c40128abd7895346802"
    );

    // The same picture in scans has the same coefficients.
    let scans = include_bytes!("../../../../tilescope/tests/it/images/progressive.jpg");
    assert_eq!(read(scans).expect("an image").grey, image.grey);
    let inks = include_bytes!("../../../../tilescope/tests/it/images/cmyk.jpg");
    assert!(read(inks).expect_err("inks").contains("CMYK"));
    for length in [3, 20, 200, 300, photo.len() - 60] {
        assert!(read(&photo[..length]).is_err(), "{length}");
    }
}

#[test]
fn a_tone_is_made_of_contrast_then_gamma_then_inversion() {
    let data = [0, 64, 128, 192, 255];
    let bytes = png([5, 1], ColorType::Grayscale, BitDepth::Eight, &data);
    let image = read(&bytes).expect("an image");
    let toned = |gamma: f64, contrast: f64, is_inverted: bool| {
        let tone = Tone {
            gamma,
            contrast,
            is_inverted,
        };
        let grey = image.toned(tone).expect("a tone").grey;
        grey.iter().map(|grey| grey / 257).collect::<Vec<u16>>()
    };
    assert_eq!(toned(1.0, 1.0, false), data.map(u16::from));
    assert_eq!(toned(1.0, 1.0, true), [255, 191, 127, 63, 0]);
    assert_eq!(toned(1.0, 2.0, false), [0, 0, 128, 255, 255]);
    assert_eq!(toned(2.0, 1.0, false), [0, 16, 64, 144, 255]);
    assert_eq!(toned(2.0, 0.5, true), [239, 219, 191, 154, 111]);
    let refused = image.toned(Tone {
        gamma: f64::NAN,
        ..Tone::default()
    });
    assert!(refused.is_err());
}

#[test]
fn inverted_images_keep_transparent_places_white() {
    let data = [0, 0, 0, 0, 255, 255, 255, 255, 0, 0, 0, 255];
    let bytes = png([3, 1], ColorType::Rgba, BitDepth::Eight, &data);
    let inverted = Tone {
        is_inverted: true,
        ..Tone::default()
    };
    let image = read(&bytes).and_then(|image| image.toned(inverted).map_err(|e| e.to_string()));
    assert_eq!(*image.expect("an image").grey, [65_535, 0, 65_535]);
}

#[test]
fn blocks_have_the_mean_of_their_pixels() {
    let data = [0, 1, 2, 4, 10, 10, 20, 20];
    let bytes = png([4, 2], ColorType::Grayscale, BitDepth::Eight, &data);
    let image = read(&bytes).expect("an image");
    let blocks = image.in_blocks(2).expect("blocks");
    assert_eq!(*blocks.grey, [1349, 2956]);
    assert_eq!(blocks.pixels(), [2, 1]);
    let refused = image.in_blocks(4).expect_err("no whole block").to_string();
    assert_eq!(refused, "blocks of 4 x 4 pixels do not fill 4 x 2");
}

#[test]
fn what_is_no_image_to_use_is_refused_in_words() {
    let refusal = |bytes: &[u8]| read(bytes).expect_err("refused");
    assert_eq!(refusal(b"hello"), "a.png: it is no PNG or JPEG image");
    assert!(refusal(b"GIF89a").contains("GIF"));
    assert!(refusal(b"\xff\xd8\xff\xee").contains("cannot be decoded"));

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
