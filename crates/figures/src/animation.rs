//! Frames as an animated GIF or PNG with the parameters inside.
//! One frame is in memory at a time. Never draws, never opens a file and never writes a time stamp.

use std::collections::{BTreeMap, HashMap};
use std::io::Write;
use std::ops::ControlFlow;

use gif::{AnyExtension, DisposalMethod, Encoder, Extension, Frame, Repeat};

use crate::error::FigureError;
use crate::png::text_chunk;
use crate::raster::Pixels;

/// The most frames of an animation.
pub const MAX_FRAMES: usize = 10_000;

/// The most pixels of a frame, 2^24 (4,096 x 4,096).
pub const MAX_FRAME_PIXELS: u64 = 1 << 24;

/// The largest side of a frame of a GIF, whose sizes have 16 bits.
pub const MAX_GIF_SIDE: u32 = 65_535;

/// The shortest time for a frame, in hundredths of a second: viewers slow shorter ones down to a tenth of a
/// second.
pub const MIN_DELAY: u16 = 2;

/// Colours of a frame of a GIF.
const COLORS: usize = 256;

/// Why there is no animation.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AnimationError {
    /// There is no frame.
    #[error("an animation needs at least one frame")]
    NoFrames,
    /// There are too many frames.
    #[error("an animation of {frames} frames is too long; the limit is {MAX_FRAMES}")]
    TooManyFrames {
        /// Frames asked for.
        frames: usize,
    },
    /// A frame has no pixel or too many.
    #[error("a frame of {width} x {height} pixels cannot be animated; the limit is {limit}")]
    FrameSize {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
        /// The largest number of pixels, or in a GIF the largest side.
        limit: u64,
    },
    /// A frame has another size than the first one.
    #[error(
        "frame {index} has {width} x {height} pixels and the first one has {first_width} x {first_height}"
    )]
    Uneven {
        /// The frame, from 0.
        index: usize,
        /// Its width in pixels.
        width: u32,
        /// Its height in pixels.
        height: u32,
        /// The width of the first frame.
        first_width: u32,
        /// The height of the first frame.
        first_height: u32,
    },
    /// The time for a frame is too short.
    #[error("{delay} hundredths of a second for a frame are too few; the limit is {MIN_DELAY}")]
    Delay {
        /// Hundredths of a second asked for.
        delay: u16,
    },
    /// There are fewer frames than the iterator said.
    #[error("{found} frames came where {expected} were announced")]
    Missing {
        /// Frames that came.
        found: usize,
        /// Frames announced.
        expected: usize,
    },
    /// A frame could not be drawn.
    #[error("frame {index} could not be drawn: {cause}")]
    Frame {
        /// The frame, from 0.
        index: usize,
        /// Why.
        cause: FigureError,
    },
    /// The encoder or what it writes to refused.
    #[error("the animation could not be written: {0}")]
    Encode(String),
    /// The callback asked to stop. What was written so far is no complete file.
    #[error("the animation was cancelled after {frames} frames")]
    Cancelled {
        /// Frames written.
        frames: usize,
    },
}

/// What [`write_gif`] and [`write_apng`] tell before each frame and after the last: frames written, and frames
/// in all. `Break` stops before the next frame.
pub type FrameProgress<'a> = &'a mut dyn FnMut(usize, usize) -> ControlFlow<()>;

/// Writes an animation that repeats forever as a GIF.
///
/// `delay` is the time for a frame in hundredths of a second. Each frame has the 256 colours that most of its
/// pixels have; other pixels take the nearest of them. What is transparent is seen on white. `metadata`
/// becomes comments.
///
/// # Errors
///
/// See [`AnimationError`]. What was written before an error is no complete file.
pub fn write_gif(
    frames: impl ExactSizeIterator<Item = Result<Pixels, FigureError>>,
    delay: u16,
    metadata: &[(String, String)],
    out: impl Write,
    progress: FrameProgress<'_>,
) -> Result<(), AnimationError> {
    let mut frames = Frames::new(frames, delay, progress)?;
    let first = frames.first(MAX_GIF_SIDE)?;
    let (width, height) = (first.width as u16, first.height as u16);
    let mut encoder = Encoder::new(out, width, height, &[]).map_err(refused)?;
    encoder.set_repeat(Repeat::Infinite).map_err(refused)?;
    for (key, value) in with_program(metadata) {
        let comment = format!("{key}: {value}");
        let kind = AnyExtension::from(Extension::Comment);
        encoder
            .write_raw_extension(kind, &[comment.as_bytes()])
            .map_err(refused)?;
    }
    let mut next = Some(first);
    while let Some(pixels) = next {
        let (palette, buffer) = indexed(&pixels);
        let frame = Frame {
            delay,
            dispose: DisposalMethod::Keep,
            width,
            height,
            palette: Some(palette),
            buffer: buffer.into(),
            ..Frame::default()
        };
        drop(pixels);
        encoder.write_frame(&frame).map_err(refused)?;
        next = frames.next()?;
    }
    encoder.into_inner().map_err(refused)?;
    Ok(())
}

/// Writes an animation that repeats forever as an animated PNG, whose pixels are those of the frames.
///
/// `delay` is the time for a frame in hundredths of a second; `metadata` becomes `iTXt` chunks. Viewers
/// without animation show the first frame.
///
/// # Errors
///
/// See [`AnimationError`]. What was written before an error is no complete file.
pub fn write_apng(
    frames: impl ExactSizeIterator<Item = Result<Pixels, FigureError>>,
    delay: u16,
    metadata: &[(String, String)],
    out: impl Write,
    progress: FrameProgress<'_>,
) -> Result<(), AnimationError> {
    let count = frames.len();
    let mut frames = Frames::new(frames, delay, progress)?;
    let first = frames.first(u32::MAX)?;
    let mut encoder = png::Encoder::new(out, first.width, first.height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_animated(count as u32, 0).map_err(refused)?;
    encoder.set_frame_delay(delay, 100).map_err(refused)?;
    encoder
        .set_blend_op(png::BlendOp::Source)
        .map_err(refused)?;
    for (key, value) in with_program(metadata) {
        let (keyword, text) = text_chunk(&key, &value);
        encoder.add_itxt_chunk(keyword, text).map_err(refused)?;
    }
    let mut writer = encoder.write_header().map_err(refused)?;
    let mut next = Some(first);
    while let Some(pixels) = next {
        writer.write_image_data(&pixels.rgba).map_err(refused)?;
        drop(pixels);
        next = frames.next()?;
    }
    writer.finish().map_err(refused)
}

fn refused(error: impl std::fmt::Display) -> AnimationError {
    AnimationError::Encode(error.to_string())
}

fn with_program(metadata: &[(String, String)]) -> impl Iterator<Item = (String, String)> {
    let program = ("Software".to_owned(), "Tilescope".to_owned());
    let given = metadata.iter().cloned();
    [program]
        .into_iter()
        .chain(given)
        .filter(|(_, value)| !value.is_empty())
}

/// Frames, one at a time, each checked against the limits.
struct Frames<'a, I> {
    source: I,
    count: usize,
    written: usize,
    size: [u32; 2],
    progress: FrameProgress<'a>,
}

impl<'a, I: ExactSizeIterator<Item = Result<Pixels, FigureError>>> Frames<'a, I> {
    fn new(frames: I, delay: u16, progress: FrameProgress<'a>) -> Result<Self, AnimationError> {
        let count = frames.len();
        match count {
            0 => return Err(AnimationError::NoFrames),
            1..=MAX_FRAMES => {}
            frames => return Err(AnimationError::TooManyFrames { frames }),
        }
        if delay < MIN_DELAY {
            return Err(AnimationError::Delay { delay });
        }
        Ok(Self {
            source: frames,
            count,
            written: 0,
            size: [0; 2],
            progress,
        })
    }
    fn first(&mut self, largest_side: u32) -> Result<Pixels, AnimationError> {
        self.tell()?;
        let pixels = self.draw()?;
        let (width, height) = (pixels.width, pixels.height);
        let area = u64::from(width) * u64::from(height);
        let limit = match area {
            _ if width.max(height) > largest_side => u64::from(largest_side),
            1..=MAX_FRAME_PIXELS => {
                self.size = [width, height];
                return Ok(pixels);
            }
            _ => MAX_FRAME_PIXELS,
        };
        Err(AnimationError::FrameSize {
            width,
            height,
            limit,
        })
    }

    /// The next frame, when one more was written; `None` behind the last.
    fn next(&mut self) -> Result<Option<Pixels>, AnimationError> {
        self.written += 1;
        self.tell()?;
        if self.written == self.count {
            return Ok(None);
        }
        let pixels = self.draw()?;
        let [first_width, first_height] = self.size;
        if [pixels.width, pixels.height] != self.size {
            return Err(AnimationError::Uneven {
                index: self.written,
                width: pixels.width,
                height: pixels.height,
                first_width,
                first_height,
            });
        }
        Ok(Some(pixels))
    }

    /// Tells how far it is. Behind the last frame nothing is left to cancel.
    fn tell(&mut self) -> Result<(), AnimationError> {
        let frames = self.written;
        match (self.progress)(frames, self.count) {
            ControlFlow::Break(()) if frames < self.count => {
                Err(AnimationError::Cancelled { frames })
            }
            _ => Ok(()),
        }
    }

    fn draw(&mut self) -> Result<Pixels, AnimationError> {
        let index = self.written;
        match self.source.next() {
            Some(frame) => frame.map_err(|cause| AnimationError::Frame { index, cause }),
            None => Err(AnimationError::Missing {
                found: index,
                expected: self.count,
            }),
        }
    }
}

type Rgb = [u8; 3];

/// The palette of a frame and the index of each pixel. Pictures of flat colours keep them exactly, which a
/// palette of averages would not; shades between them are rare and take the nearest.
fn indexed(pixels: &Pixels) -> (Vec<u8>, Vec<u8>) {
    let colors = || pixels.rgba.chunks_exact(4).map(on_white);
    let mut counts: BTreeMap<Rgb, u32> = BTreeMap::new();
    let mut last: Option<(Rgb, u32)> = None;
    // Equal neighbours are counted together, as most pixels have one.
    for color in colors() {
        last = match last {
            Some((same, count)) if same == color => Some((same, count + 1)),
            before => {
                note(&mut counts, before);
                Some((color, 1))
            }
        };
    }
    note(&mut counts, last);
    let mut palette: Vec<(Rgb, u32)> = counts.into_iter().collect();
    palette.sort_by_key(|&(color, count)| (std::cmp::Reverse(count), color));
    let kept: Vec<Rgb> = palette
        .iter()
        .take(COLORS)
        .map(|(color, _)| *color)
        .collect();
    let index: HashMap<Rgb, u8> = (palette.iter().enumerate())
        .map(|(place, &(color, _))| match u8::try_from(place) {
            Ok(place) => (color, place),
            Err(_) => (color, nearest(&kept, color)),
        })
        .collect();
    let buffer = colors().map(|color| index[&color]).collect();
    (kept.into_flattened(), buffer)
}

fn note(counts: &mut BTreeMap<Rgb, u32>, run: Option<(Rgb, u32)>) {
    if let Some((color, count)) = run {
        *counts.entry(color).or_default() += count;
    }
}

fn nearest(palette: &[Rgb], color: Rgb) -> u8 {
    let distance = |other: &Rgb| -> u32 {
        (0..3)
            .map(|k| u32::from(other[k].abs_diff(color[k])).pow(2))
            .sum()
    };
    let places = palette.iter().enumerate();
    places
        .min_by_key(|(_, other)| distance(other))
        .map_or(0, |(place, _)| place as u8)
}

fn on_white(pixel: &[u8]) -> Rgb {
    let opacity = u32::from(pixel[3]);
    [0, 1, 2].map(|k| ((u32::from(pixel[k]) * opacity + 255 * (255 - opacity) + 127) / 255) as u8)
}
