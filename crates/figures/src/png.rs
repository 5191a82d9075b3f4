//! The scene as a PNG file with its parameters inside.
//!
//! Opaque pictures are stored without an opacity channel; title and metadata become `iTXt` chunks. No time stamp is
//! written: the same scene gives the same bytes.

#[cfg(not(target_arch = "wasm32"))]
use std::sync::mpsc::{RecvTimeoutError, channel};
#[cfg(not(target_arch = "wasm32"))]
use std::thread::Builder;
#[cfg(not(target_arch = "wasm32"))]
use std::time::Duration;

use png::{BitDepth, ColorType, Encoder};

use crate::error::FigureError;
use crate::raster::{Pixels, to_pixels_while};
use crate::scene::Scene;

/// The longest keyword of a text chunk (PNG specification, 11.3.3).
const KEYWORD_LENGTH: usize = 79;

/// The bytes of a PNG of `scene` with `scale` pixels for each of its own.
///
/// # Errors
///
/// As [`to_pixels`], and [`FigureError::Encode`].
pub fn to_png(scene: &Scene, scale: f64) -> Result<Vec<u8>, FigureError> {
    to_png_while(scene, scale, &|| true)
}

/// As [`to_png`], as long as `goes_on` returns true: it is asked every few milliseconds, while the scene is drawn and while
/// its pixels are compressed.
///
/// # Errors
///
/// Those of [`to_png`], and [`FigureError::Cancelled`] once `goes_on` returns false.
pub fn to_png_while(
    scene: &Scene,
    scale: f64,
    goes_on: &dyn Fn() -> bool,
) -> Result<Vec<u8>, FigureError> {
    let pixels = to_pixels_while(scene, scale, goes_on)?;
    let texts: Vec<(String, String)> = text_chunks(scene).collect();
    beside(move || encoded(pixels, texts), goes_on)?
}

/// Returns a PNG of pixels with texts in its head.
fn encoded(pixels: Pixels, texts: Vec<(String, String)>) -> Result<Vec<u8>, FigureError> {
    let Pixels {
        width,
        height,
        mut rgba,
    } = pixels;
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
    for (key, value) in texts {
        encoder.add_itxt_chunk(key, value).map_err(encode_error)?;
    }
    let mut writer = encoder.write_header().map_err(encode_error)?;
    writer.write_image_data(&rgba).map_err(encode_error)?;
    writer.finish().map_err(encode_error)?;
    Ok(bytes)
}

/// How often it is asked whether to go on beside work that cannot ask itself.
#[cfg(not(target_arch = "wasm32"))]
const BETWEEN_QUESTIONS: Duration = Duration::from_millis(20);

/// Works on another thread, as long as `goes_on` returns true. Work that is no longer wanted ends by itself, unseen: the
/// encoder takes all pixels at once, and its way of taking them row by row gives other bytes.
#[cfg(not(target_arch = "wasm32"))]
fn beside<T: Send + 'static>(
    work: impl FnOnce() -> T + Send + 'static,
    goes_on: &dyn Fn() -> bool,
) -> Result<T, FigureError> {
    let (sender, receiver) = channel();
    let work = move || {
        // Nobody receives what is no longer wanted.
        let _ = sender.send(work());
    };
    let begun = Builder::new().name("png".to_owned()).spawn(work);
    begun.map_err(|error| FigureError::Encode(error.to_string()))?;

    while goes_on() {
        match receiver.recv_timeout(BETWEEN_QUESTIONS) {
            Ok(done) => return Ok(done),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => {
                return Err(FigureError::Encode("the encoder ended early".to_owned()));
            }
        }
    }
    Err(FigureError::Cancelled)
}

/// Works at once: pages have no such threads.
#[cfg(target_arch = "wasm32")]
fn beside<T>(work: impl FnOnce() -> T, goes_on: &dyn Fn() -> bool) -> Result<T, FigureError> {
    if goes_on() {
        Ok(work())
    } else {
        Err(FigureError::Cancelled)
    }
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
    let title = ("Title".to_owned(), scene.title.clone());
    let title = Some(title).filter(|(_, value)| !value.is_empty());
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

/// `key` as the specification wants keywords: 1 to 79 printable characters without outer spaces.
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
    use std::cell::Cell;
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
    fn a_picture_stops_while_it_is_drawn() {
        let mut scene = scene([255; 4]);
        let circle = scene.groups[0].shapes[0].clone();
        scene.groups[0].shapes = vec![circle; 10 * 64];
        let asked = Cell::new(0);
        let stop_at = |most: usize| {
            asked.set(0);
            let goes_on = || {
                asked.set(asked.get() + 1);
                asked.get() <= most
            };
            to_png_while(&scene, 1.0, &goes_on)
        };

        assert_eq!(stop_at(usize::MAX), to_png(&scene, 1.0));
        // Ten questions while drawing, and at least one while compressing.
        assert!(asked.get() >= 11);
        for most in 0..11 {
            assert_eq!(stop_at(most), Err(FigureError::Cancelled), "{most}");
            assert_eq!(asked.get(), most + 1, "nothing is done after the answer");
        }
    }

    #[test]
    fn work_that_cannot_stop_is_left_alone() {
        let (sender, receiver) = channel::<()>();
        let asked = Cell::new(0);
        let goes_on = || {
            asked.set(asked.get() + 1);
            asked.get() < 3
        };
        // This work ends only after the answer.
        let left = beside(move || receiver.recv(), &goes_on);
        assert_eq!((left, asked.get()), (Err(FigureError::Cancelled), 3));
        drop(sender);
        assert_eq!(beside(|| 7, &|| true), Ok(7));
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
