//! The scene as a PNG file with its parameters inside.
//!
//! Opaque pictures are stored without an opacity channel; title and metadata become `iTXt` chunks. No time stamp is
//! written: the same scene gives the same bytes.

use std::io::Write;

use png::{BitDepth, ColorType, Encoder};

use crate::control::{Control, Steps, go_on};
use crate::error::FigureError;
use crate::raster::{Pixels, paint_pixels, size};
use crate::scene::Scene;

/// The longest keyword of a text chunk (PNG specification, 11.3.3).
const KEYWORD_LENGTH: usize = 79;

/// The bytes of a PNG of `scene` with `scale` pixels for each of its own.
///
/// # Errors
///
/// As [`to_pixels`](crate::to_pixels), and [`FigureError::Encode`].
pub fn to_png(scene: &Scene, scale: f64) -> Result<Vec<u8>, FigureError> {
    to_png_controlled(scene, scale, &mut go_on)
}

/// The same as [`to_png`]. Calls `control` while shapes are drawn and while rows of pixels are compressed.
///
/// # Errors
///
/// As [`to_png`], and [`FigureError::Cancelled`] when `control` breaks.
pub fn to_png_controlled(
    scene: &Scene,
    scale: f64,
    control: Control<'_>,
) -> Result<Vec<u8>, FigureError> {
    let [_, rows] = size(scene, scale)?;
    let mut steps = Steps::new(scene.shapes() + rows as usize, control);

    let Pixels {
        width,
        height,
        mut rgba,
    } = paint_pixels(scene, scale, &mut steps)?;

    // An opaque picture needs no opacity channel, a quarter of its bytes.
    let opaque = rgba.chunks_exact(4).all(|pixel| pixel[3] == 255);
    if opaque {
        drop_opacity(&mut rgba);
    }

    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, width, height);
    encoder.set_color(if opaque {
        ColorType::Rgb
    } else {
        ColorType::Rgba
    });
    encoder.set_depth(BitDepth::Eight);

    for (key, value) in text_chunks(scene) {
        encoder.add_itxt_chunk(key, value).map_err(encode_error)?;
    }
    let mut writer = encoder.write_header().map_err(encode_error)?;

    // Rows are compressed one by one, so that `control` can stop a large picture, which takes seconds.
    let mut stream = writer.stream_writer().map_err(encode_error)?;
    for row in rgba.chunks(rgba.len() / height as usize) {
        steps.row()?;
        stream
            .write_all(row)
            .map_err(|error| encode_error(error.into()))?;
    }

    stream.finish().map_err(encode_error)?;
    writer.finish().map_err(encode_error)?;
    Ok(bytes)
}

fn drop_opacity(rgba: &mut Vec<u8>) {
    let pixels = rgba.len() / 4;
    for pixel in 0..pixels {
        rgba.copy_within(4 * pixel..4 * pixel + 3, 3 * pixel);
    }
    rgba.truncate(3 * pixels);
}

#[expect(clippy::needless_pass_by_value, reason = "the shape map_err wants")]
fn encode_error(error: png::EncodingError) -> FigureError {
    FigureError::Encode(error.to_string())
}

fn text_chunks(scene: &Scene) -> impl Iterator<Item = (String, String)> {
    let title =
        Some(("Title".to_owned(), scene.title.clone())).filter(|(_, value)| !value.is_empty());
    title
        .into_iter()
        .chain(with_program(&scene.metadata))
        .map(|(key, value)| text_chunk(&key, &value))
}

/// The program's name and the metadata, as key and value, without empty values.
pub(crate) fn with_program(
    metadata: &[(String, String)],
) -> impl Iterator<Item = (String, String)> {
    let program = ("Software".to_owned(), "Tilescope".to_owned());
    let all = std::iter::once(program).chain(metadata.iter().cloned());
    all.filter(|(_, value)| !value.is_empty())
}

/// A keyword and a text as chunks may hold them.
pub(crate) fn text_chunk(key: &str, value: &str) -> (String, String) {
    (keyword(key), value.replace('\0', " "))
}

/// `key` as the specification requires keywords: 1 to 79 printable characters without outer spaces.
fn keyword(key: &str) -> String {
    let printable: String = key
        .chars()
        .filter(|c| (' '..='~').contains(c))
        .take(KEYWORD_LENGTH)
        .collect();
    let words: Vec<&str> = printable.split(' ').filter(|w| !w.is_empty()).collect();
    if words.is_empty() {
        return "Comment".to_owned();
    }
    words.join(" ")
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;
    use crate::scene::{Group, Shape, Style};

    fn scene(background: [u8; 4]) -> Scene {
        let mut scene = Scene::new(12.0, 8.0, background);
        let mut group = Group::new("disks");
        let red = Style::filled([255, 0, 0, 255]);
        group.shapes.push(Shape::circle([6.0, 4.0], 3.0, red));
        scene.groups.push(group);
        scene
    }

    fn decode(bytes: &[u8]) -> (png::Info<'static>, Vec<u8>) {
        let mut reader = png::Decoder::new(Cursor::new(bytes))
            .read_info()
            .expect("a PNG");
        let mut pixels = vec![0; reader.output_buffer_size().expect("small")];
        reader.next_frame(&mut pixels).expect("whole");
        (reader.info().clone(), pixels)
    }

    #[test]
    fn an_opaque_picture_is_rgb_and_a_transparent_one_rgba() {
        let (info, pixels) = decode(&to_png(&scene([255; 4]), 1.0).expect("drawn"));
        assert_eq!((info.width, info.height), (12, 8));
        assert_eq!(info.color_type, ColorType::Rgb);
        let at = |x: usize, y: usize| &pixels[(y * 12 + x) * 3..][..3];
        assert_eq!((at(6, 4), at(0, 0)), (&[255, 0, 0][..], &[255; 3][..]));
        let (info, pixels) = decode(&to_png(&scene([0; 4]), 1.0).expect("drawn"));
        assert_eq!(info.color_type, ColorType::Rgba);
        assert_eq!(pixels[..4], [0; 4]);
    }

    #[test]
    fn parameters_are_in_the_metadata() {
        let mut scene = scene([255; 4]);
        scene.title = "Gaps \u{2264} r".to_owned();
        scene.metadata.push(("seed".to_owned(), "42".to_owned()));
        scene
            .metadata
            .push(("\u{3c1}\n".to_owned(), "0.7".to_owned()));
        let (info, _) = decode(&to_png(&scene, 1.0).expect("drawn"));
        let texts: Vec<_> = info
            .utf8_text
            .iter()
            .map(|chunk| (chunk.keyword.as_str(), chunk.get_text().expect("UTF-8")))
            .collect();
        let expected = [
            ("Title", "Gaps \u{2264} r"),
            ("Software", "Tilescope"),
            ("seed", "42"),
            ("Comment", "0.7"),
        ];
        assert_eq!(texts, expected.map(|(k, v)| (k, v.to_owned())));
    }

    #[test]
    fn bytes_are_deterministic() {
        let once = to_png(&scene([255; 4]), 3.0).expect("drawn");
        assert_eq!(once, to_png(&scene([255; 4]), 3.0).expect("drawn"));
        assert_ne!(
            once,
            to_png(&scene([254, 255, 255, 255]), 3.0).expect("drawn")
        );
    }

    #[test]
    fn keywords_obey_the_specification() {
        assert_eq!(keyword("  a   b "), "a b");
        assert_eq!(keyword(""), "Comment");
        assert_eq!(keyword(&"k".repeat(200)).len(), KEYWORD_LENGTH);
    }
}
