//! Frames as an animated GIF or PNG with the parameters inside. After the first frame a file holds what changes.
//! Two frames are in memory at a time. No time stamp is written.

mod changes;
mod colors;

use std::io::Write;
use std::ops::ControlFlow;

use gif::{AnyExtension, DisposalMethod, Encoder, Extension, Frame, Repeat};

use crate::error::FigureError;
use crate::png::{text_chunk, with_program};
use crate::raster::Pixels;
use changes::{Change, Layer};
use colors::Indexed;

/// The most frames of an animation. Chosen, not measured.
pub const MAX_FRAMES: usize = 10_000;

/// The most pixels of a frame, 2^24 (4,096 x 4,096). Two frames are in memory at a time, of 64 MiB each.
pub const MAX_FRAME_PIXELS: u64 = 1 << 24;

/// The largest side of a frame of a GIF, whose sizes have 16 bits.
pub const MAX_GIF_SIDE: u32 = 65_535;

/// The shortest time for a frame, in hundredths of a second: viewers slow shorter ones down to a tenth of a
/// second.
pub const MIN_DELAY: u16 = 2;

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
        /// How many frames were asked for.
        frames: usize,
    },
    /// A frame has no pixel or too many.
    #[error("a frame of {width} x {height} pixels cannot be animated; the limit is {limit}")]
    FrameSize {
        /// Width of the frame in pixels.
        width: u32,
        /// Height of the frame in pixels.
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
        /// How many frames the iterator gave.
        found: usize,
        /// How many frames it had announced.
        expected: usize,
    },
    /// A frame could not be drawn.
    #[error("frame {index} could not be drawn: {cause}")]
    Frame {
        /// The frame, from 0.
        index: usize,
        /// Why it could not be drawn.
        cause: FigureError,
    },
    /// The encoder or what it writes to refused.
    #[error("the animation could not be written: {0}")]
    Encode(String),
    /// The callback asked to stop. The file is not complete.
    #[error("the animation was cancelled after {frames} frames")]
    Cancelled {
        /// How many frames were written before.
        frames: usize,
    },
}

/// [`write_gif`] and [`write_apng`] call it before each frame and after the last with the number of frames written and of
/// all frames. `Break` stops before the next frame.
pub type FrameProgress<'a> = &'a mut dyn FnMut(usize, usize) -> ControlFlow<()>;

/// Writes an animation that repeats forever as a GIF.
///
/// `delay` is the time for a frame in hundredths of a second. Each frame has the 256 colours that most of its changed
/// pixels have, or 255 if some pixels stay as in the frame before: these take one index. Other changed pixels take the
/// nearest colour.
/// Transparent pixels are laid on white. `metadata` becomes comments.
///
/// # Errors
///
/// See [`AnimationError`]. After an error the file is not complete.
pub fn write_gif(
    frames: impl ExactSizeIterator<Item = Result<Pixels, FigureError>>,
    delay: u16,
    metadata: &[(String, String)],
    out: impl Write,
    progress: FrameProgress<'_>,
) -> Result<(), AnimationError> {
    let mut checked = Frames::new(frames, delay, progress)?;
    let first = checked.first(MAX_GIF_SIDE)?;

    // `checked.first` refuses a side that does not fit into 16 bits. Later frames have the same size.
    let (width, height) = (first.width as u16, first.height as u16);
    // There is no palette of the whole file: each frame has the colours that it needs most.
    let mut encoder = Encoder::new(out, width, height, &[]).map_err(refused)?;
    encoder.set_repeat(Repeat::Infinite).map_err(refused)?;

    // The program's name, and the metadata.
    for (key, value) in with_program(metadata) {
        let comment = format!("{key}: {value}");
        let kind = AnyExtension::from(Extension::Comment);
        encoder
            .write_raw_extension(kind, &[comment.as_bytes()])
            .map_err(refused)?;
    }

    let mut next = Some(first);
    while let Some(change) = next {
        let indexed = Indexed::of(&change);
        let frame = Frame {
            delay,
            // The pixels that stay are transparent, so that the frame before must remain below them.
            dispose: DisposalMethod::Keep,
            transparent: indexed.transparent,
            left: change.left as u16,
            top: change.top as u16,
            width: change.width as u16,
            height: change.height as u16,
            palette: Some(indexed.palette),
            buffer: indexed.pixels.into(),
            ..Frame::default()
        };

        // The pixels of the change are freed before the next frame is drawn, so that two frames are in memory at a time.
        drop(change);
        encoder.write_frame(&frame).map_err(refused)?;
        next = checked.next()?;
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
/// See [`AnimationError`]. After an error the file is not complete.
pub fn write_apng(
    frames: impl ExactSizeIterator<Item = Result<Pixels, FigureError>>,
    delay: u16,
    metadata: &[(String, String)],
    out: impl Write,
    progress: FrameProgress<'_>,
) -> Result<(), AnimationError> {
    let count = frames.len();
    let mut checked = Frames::new(frames, delay, progress)?;
    // The limit on pixels keeps the sides of a PNG far below what its format allows.
    let first = checked.first(u32::MAX)?;

    let mut encoder = png::Encoder::new(out, first.width, first.height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    // Zero plays repeat forever.
    encoder.set_animated(count as u32, 0).map_err(refused)?;
    let per_second = 100;
    encoder
        .set_frame_delay(delay, per_second)
        .map_err(refused)?;
    for (key, value) in with_program(metadata) {
        let (keyword, text) = text_chunk(&key, &value);
        encoder.add_itxt_chunk(keyword, text).map_err(refused)?;
    }

    let mut writer = encoder.write_header().map_err(refused)?;
    let mut next = Some(first);
    while let Some(change) = next {
        let (rgba, blend) = match change.layer() {
            Layer::Over(rgba) => (rgba, png::BlendOp::Over),
            Layer::Instead(rgba) => (rgba, png::BlendOp::Source),
        };
        writer.set_blend_op(blend).map_err(refused)?;

        // By default a frame remains below the next one. The encoder refuses a size that does not fit at the current
        // place: the place goes back to the corner first.
        writer.reset_frame_position().map_err(refused)?;
        let sized = writer.set_frame_dimension(change.width, change.height);
        sized.map_err(refused)?;
        let placed = writer.set_frame_position(change.left, change.top);
        placed.map_err(refused)?;

        writer.write_image_data(&rgba).map_err(refused)?;
        // Two frames are in memory at a time, as in a GIF.
        drop(change);
        next = checked.next()?;
    }

    writer.finish().map_err(refused)
}

fn refused(error: impl std::fmt::Display) -> AnimationError {
    AnimationError::Encode(error.to_string())
}

/// Frames, one at a time, each checked against the limits.
struct Frames<'a, I> {
    source: I,
    /// The number of frames that were announced.
    count: usize,
    /// The number of frames that were written.
    written: usize,
    /// The width and the height of the first frame.
    size: [u32; 2],
    /// The last frame, with which the next one is compared.
    last: Option<Pixels>,
    progress: FrameProgress<'a>,
}

impl<'a, I: ExactSizeIterator<Item = Result<Pixels, FigureError>>> Frames<'a, I> {
    /// Returns the frames of an animation, to be drawn one by one, or the error for too few or too many, or too short a delay.
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
            last: None,
            progress,
        })
    }

    /// Draws the first frame and returns it as a change of all pixels, or an error if it is empty or too large.
    fn first(&mut self, largest_side: u32) -> Result<Change, AnimationError> {
        self.report()?;
        let pixels = self.draw()?;

        let (width, height) = (pixels.width, pixels.height);
        let area = u64::from(width) * u64::from(height);
        let limit = match area {
            _ if width.max(height) > largest_side => u64::from(largest_side),
            1..=MAX_FRAME_PIXELS => {
                self.size = [width, height];
                return Ok(self.changed(pixels));
            }
            // A frame without a pixel is refused like one with too many.
            _ => MAX_FRAME_PIXELS,
        };

        Err(AnimationError::FrameSize {
            width,
            height,
            limit,
        })
    }

    /// Returns what the next frame changes, once the one before was written; `None` behind the last one.
    fn next(&mut self) -> Result<Option<Change>, AnimationError> {
        self.written += 1;
        self.report()?;
        if self.written == self.count {
            return Ok(None);
        }

        let pixels = self.draw()?;
        let [first_width, first_height] = self.size;
        // What changes is found pixel by pixel, and only the first frame says how large the picture is.
        if [pixels.width, pixels.height] != self.size {
            return Err(AnimationError::Uneven {
                index: self.written,
                width: pixels.width,
                height: pixels.height,
                first_width,
                first_height,
            });
        }

        Ok(Some(self.changed(pixels)))
    }

    /// Returns what a frame changes, and keeps it as the last one.
    fn changed(&mut self, pixels: Pixels) -> Change {
        let change = Change::between(self.last.as_ref(), &pixels);
        self.last = Some(pixels);
        change
    }

    /// Reports the progress. After the last frame nothing is left to cancel.
    fn report(&mut self) -> Result<(), AnimationError> {
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
