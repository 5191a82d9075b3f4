//! Animations, read back by the decoders.

#![allow(missing_docs, reason = "tests")]

use std::io::{self, Cursor, Write};
use std::ops::ControlFlow;

use tilescope_figures::animation::{
    AnimationError, MAX_FRAME_PIXELS, MAX_FRAMES, MAX_GIF_SIDE, MIN_DELAY, write_apng, write_gif,
};
use tilescope_figures::{FigureError, Pixels};

const WIDTH: u32 = 20;
const HEIGHT: u32 = 12;

/// A frame in two flat colours; `k` decides them.
fn frame(k: u8) -> Pixels {
    let pixel = |index: u32| {
        if index % WIDTH < WIDTH / 2 {
            [k * 40, 10, 200, 255]
        } else {
            [255, 255 - k, 7, 255]
        }
    };
    Pixels {
        width: WIDTH,
        height: HEIGHT,
        rgba: (0..WIDTH * HEIGHT).flat_map(pixel).collect(),
    }
}

fn frames(count: u8) -> impl ExactSizeIterator<Item = Result<Pixels, FigureError>> {
    (0..count).map(|k| Ok(frame(k)))
}

fn metadata() -> Vec<(String, String)> {
    vec![
        ("seed".into(), "42".into()),
        ("Title".into(), "gaps \u{2264} r".into()),
        ("empty".into(), String::new()),
    ]
}

fn go_on(_: usize, _: usize) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

type Written = Result<Vec<u8>, AnimationError>;

fn gif(frames: impl ExactSizeIterator<Item = Result<Pixels, FigureError>>, delay: u16) -> Written {
    let mut bytes = Vec::new();
    write_gif(frames, delay, &metadata(), &mut bytes, &mut go_on).map(|()| bytes)
}

fn apng(frames: impl ExactSizeIterator<Item = Result<Pixels, FigureError>>, delay: u16) -> Written {
    let mut bytes = Vec::new();
    write_apng(frames, delay, &metadata(), &mut bytes, &mut go_on).map(|()| bytes)
}

/// The size, and delay and pixels of each frame.
fn read_gif(bytes: &[u8]) -> ([u32; 2], Vec<(u16, Vec<u8>)>) {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(bytes).unwrap();
    assert_eq!(decoder.repeat(), gif::Repeat::Infinite);
    let size = [decoder.width(), decoder.height()].map(u32::from);
    let mut read = Vec::new();
    while let Some(frame) = decoder.read_next_frame().unwrap() {
        read.push((frame.delay, frame.buffer.to_vec()));
    }
    (size, read)
}

/// The size, the texts, and delay and pixels of each frame.
type ReadApng = ([u32; 2], Vec<(String, String)>, Vec<([u16; 2], Vec<u8>)>);

fn read_apng(bytes: &[u8]) -> ReadApng {
    let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().unwrap();
    let control = reader.info().animation_control.unwrap();
    assert_eq!(control.num_plays, 0);
    let size = [reader.info().width, reader.info().height];
    let mut read = Vec::new();
    for _ in 0..control.num_frames {
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        reader.next_frame(&mut pixels).unwrap();
        let frame = reader.info().frame_control.unwrap();
        read.push(([frame.delay_num, frame.delay_den], pixels));
    }
    let texts = reader.info().utf8_text.iter();
    let texts = texts
        .map(|text| (text.keyword.clone(), text.get_text().unwrap()))
        .collect();
    (size, texts, read)
}

fn contains(bytes: &[u8], part: &str) -> bool {
    bytes
        .windows(part.len())
        .any(|window| window == part.as_bytes())
}

#[test]
fn a_gif_has_its_frames_delays_pixels_and_comments() {
    let bytes = gif(frames(5), 25).unwrap();
    let (size, read) = read_gif(&bytes);
    assert_eq!((size, read.len()), ([WIDTH, HEIGHT], 5));
    for (k, (delay, pixels)) in (0..).zip(&read) {
        assert_eq!(*delay, 25);
        assert_eq!(*pixels, frame(k).rgba);
    }
    for comment in ["Software: Tilescope", "seed: 42", "Title: gaps \u{2264} r"] {
        assert!(contains(&bytes, comment), "{comment}");
    }
    assert!(!contains(&bytes, "empty") && !contains(&bytes, "seed: 43"));
    assert_ne!(read[0].1, read[1].1);
}

#[test]
fn an_apng_has_its_frames_delays_pixels_and_texts() {
    let bytes = apng(frames(4), 50).unwrap();
    let (size, texts, read) = read_apng(&bytes);
    assert_eq!((size, read.len()), ([WIDTH, HEIGHT], 4));
    for (k, (delay, pixels)) in (0..).zip(&read) {
        assert_eq!(*delay, [50, 100]);
        assert_eq!(*pixels, frame(k).rgba);
    }
    let expected = [
        ("Software", "Tilescope"),
        ("seed", "42"),
        ("Title", "gaps \u{2264} r"),
    ];
    assert_eq!(
        texts,
        expected.map(|(key, value)| (key.to_owned(), value.to_owned()))
    );
}

/// A frame of which a step changes one pixel, and every fourth step nothing. Some pixels are not opaque.
fn stepped(step: u32, opaque: bool) -> Pixels {
    let mut pixels = frame(1);
    for done in (1..=step).filter(|done| done % 4 != 0) {
        let place = (done * 37 % (WIDTH * HEIGHT)) as usize;
        let opacity = if opaque { 255 } else { 100 };
        pixels.rgba[4 * place..4 * place + 4].copy_from_slice(&[done as u8, 200, 9, opacity]);
    }
    pixels
}

/// Lays a part of a picture over it: what is transparent keeps what is below, unless the part replaces it.
fn lay_over(canvas: &mut [u8], part: &[u8], [left, top, width]: [u32; 3], replaces: bool) {
    for (index, pixel) in (0..).zip(part.chunks_exact(4)) {
        let (x, y) = (left + index % width, top + index / width);
        let at = 4 * (y * WIDTH + x) as usize;
        if replaces || pixel[3] != 0 {
            canvas[at..at + 4].copy_from_slice(pixel);
        }
    }
}

#[test]
fn what_stays_is_left_out_and_every_frame_is_seen_whole() {
    let count = 12;
    let film = |opaque| (0..count).map(move |step| Ok(stepped(step, opaque)));
    let bytes = gif(film(true), 10).unwrap();
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(&bytes[..]).unwrap();
    let mut canvas = vec![0; (4 * WIDTH * HEIGHT) as usize];
    for step in 0..count {
        let frame = decoder.read_next_frame().unwrap().unwrap();
        let place = [frame.left, frame.top, frame.width].map(u32::from);
        lay_over(&mut canvas, &frame.buffer, place, false);
        assert_eq!(canvas, stepped(step, true).rgba, "{step}");
        assert!(step == 0 || (frame.width, frame.height) == (1, 1));
    }
    assert!(decoder.read_next_frame().unwrap().is_none());
    for opaque in [true, false] {
        let bytes = apng(film(opaque), 10).unwrap();
        let mut reader = png::Decoder::new(Cursor::new(bytes)).read_info().unwrap();
        for step in 0..count {
            let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut pixels).unwrap();
            let frame = *reader.info().frame_control.as_ref().unwrap();
            let size = (4 * frame.width * frame.height) as usize;
            let place = [frame.x_offset, frame.y_offset, frame.width];
            let replaces = frame.blend_op == png::BlendOp::Source;
            lay_over(&mut canvas, &pixels[..size], place, replaces);
            assert_eq!(canvas, stepped(step, opaque).rgba, "{step}");
        }
    }
}

#[test]
fn many_colours_become_the_nearest_of_the_most_frequent() {
    // 5,000 shades once each on a ground of one colour that takes half of the picture.
    let shade = |index: u32| [(index % 100 * 2) as u8, (index / 100 * 4) as u8, 90, 255];
    let pixels = (0..10_000).flat_map(|i| {
        if i < 5000 {
            [255, 255, 255, 255]
        } else {
            shade(i - 5000)
        }
    });
    let picture = Pixels {
        width: 100,
        height: 100,
        rgba: pixels.collect(),
    };
    let expected = picture.rgba.clone();
    let (_, read) = read_gif(&gif(vec![Ok(picture)].into_iter(), 10).unwrap());
    let colors: std::collections::BTreeSet<&[u8]> = read[0].1.chunks_exact(4).collect();
    assert!(colors.len() <= 256 && colors.len() > 100);
    assert_eq!(read[0].1[..20_000], expected[..20_000]);
}

#[test]
fn the_same_frames_give_the_same_bytes() {
    assert_eq!(gif(frames(3), 10).unwrap(), gif(frames(3), 10).unwrap());
    assert_eq!(apng(frames(3), 10).unwrap(), apng(frames(3), 10).unwrap());
    assert_ne!(apng(frames(3), 10).unwrap(), apng(frames(3), 11).unwrap());
}

#[test]
fn what_cannot_be_animated_is_refused_with_its_limit() {
    for write in [gif_of, apng_of] {
        assert!(matches!(
            write(Vec::new(), 10),
            Err(AnimationError::NoFrames)
        ));
        let short = write(vec![Ok(frame(0))], MIN_DELAY - 1).unwrap_err();
        assert_eq!(
            short.to_string(),
            "1 hundredths of a second for a frame are too few; the limit is 2"
        );
        let mut other = frame(1);
        other.height /= 2;
        let uneven = write(vec![Ok(frame(0)), Ok(other)], 10);
        assert!(matches!(
            uneven,
            Err(AnimationError::Uneven {
                index: 1,
                height: 6,
                ..
            })
        ));
        let scale = FigureError::Scale(0.0);
        let failed = write(vec![Ok(frame(0)), Err(scale)], 10);
        assert!(matches!(
            failed,
            Err(AnimationError::Frame { index: 1, .. })
        ));
        let huge = Pixels {
            width: 4097,
            height: 4096,
            rgba: Vec::new(),
        };
        let huge = write(vec![Ok(huge)], 10);
        assert!(matches!(
            huge,
            Err(AnimationError::FrameSize {
                limit: MAX_FRAME_PIXELS,
                ..
            })
        ));
        let nothing = Pixels {
            width: 0,
            height: 5,
            rgba: Vec::new(),
        };
        assert!(matches!(
            write(vec![Ok(nothing)], 10),
            Err(AnimationError::FrameSize { .. })
        ));
    }
    let wide = Pixels {
        width: MAX_GIF_SIDE + 1,
        height: 1,
        rgba: vec![0; 4 * 65_536],
    };
    let limit = u64::from(MAX_GIF_SIDE);
    let refused = gif(vec![Ok(wide)].into_iter(), 10);
    assert!(matches!(refused, Err(AnimationError::FrameSize { limit: l, .. }) if l == limit));
    let long = (0..=MAX_FRAMES).map(|_| Ok(frame(0)));
    let long = apng(long.collect::<Vec<_>>().into_iter(), 10);
    assert!(matches!(
        long,
        Err(AnimationError::TooManyFrames { frames: 10_001 })
    ));
}

fn gif_of(frames: Vec<Result<Pixels, FigureError>>, delay: u16) -> Written {
    gif(frames.into_iter(), delay)
}

fn apng_of(frames: Vec<Result<Pixels, FigureError>>, delay: u16) -> Written {
    apng(frames.into_iter(), delay)
}

#[test]
fn cancelling_stops_before_the_next_frame_is_drawn() {
    for is_gif in [true, false] {
        let mut drawn = 0;
        let frames = (0..10_u8).map(|k| {
            drawn += 1;
            Ok(frame(k))
        });
        let mut told = Vec::new();
        let mut stop = |done: usize, of: usize| {
            told.push((done, of));
            if done == 3 {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        };
        let mut bytes = Vec::new();
        let result = if is_gif {
            write_gif(frames, 10, &[], &mut bytes, &mut stop)
        } else {
            write_apng(frames, 10, &[], &mut bytes, &mut stop)
        };
        assert!(matches!(
            result,
            Err(AnimationError::Cancelled { frames: 3 })
        ));
        assert_eq!((drawn, told), (3, vec![(0, 10), (1, 10), (2, 10), (3, 10)]));
    }
}

/// A writer that takes so many writes and then no more.
struct Failing(usize);

impl Write for Failing {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let left = self.0.checked_sub(1);
        self.0 = left.ok_or_else(|| io::Error::other("the disk is full"))?;
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_writer_that_fails_at_any_write_is_an_error() {
    for is_gif in [true, false] {
        let written = |writes| {
            let (out, frames) = (Failing(writes), frames(3));
            if is_gif {
                write_gif(frames, 10, &metadata(), out, &mut go_on)
            } else {
                write_apng(frames, 10, &metadata(), out, &mut go_on)
            }
        };
        let mut writes = 0;
        while let Err(error) = written(writes) {
            assert!(error.to_string().contains("the disk is full"), "{error}");
            writes += 1;
        }
        assert!(writes > 10, "{writes} writes");
    }
}

#[test]
fn progress_ends_with_all_frames() {
    let mut last = (0, 0);
    let mut note = |done: usize, of: usize| {
        last = (done, of);
        ControlFlow::Continue(())
    };
    write_gif(frames(4), 10, &[], Vec::new(), &mut note).unwrap();
    assert_eq!(last, (4, 4));
}
