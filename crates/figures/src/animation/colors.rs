//! The colours of a frame of a GIF: at most 256, chosen for each frame by itself.

use std::collections::{BTreeMap, HashMap};

use super::changes::Change;

/// Colours of a frame.
const COLORS: usize = 256;

type Rgb = [u8; 3];

/// A change with its colours as indices.
pub(super) struct Indexed {
    /// The colours, one after the other: red, green and blue.
    pub palette: Vec<u8>,
    /// The index of each pixel.
    pub pixels: Vec<u8>,
    /// The index of those that stay as they are, if there are any.
    pub transparent: Option<u8>,
}

impl Indexed {
    /// Returns a change with its most frequent colours, so that flat colours are kept exactly, which a palette of averages would
    /// not do. Other colours take the nearest one.
    pub fn of(change: &Change) -> Self {
        let pixels = || change.rgba.chunks_exact(4).zip(&change.stays);
        let colors = || {
            let changed = pixels().filter(|(_, stays)| !**stays);
            changed.map(|(pixel, _)| on_white(pixel))
        };

        // The index of the pixels that stay takes the place of a colour.
        let some_stay = change.stays.contains(&true);
        let room = COLORS - usize::from(some_stay);

        // Most pixels have the colour of the one before. Such runs are counted first, and looked up once each.
        let mut counts: BTreeMap<Rgb, u32> = BTreeMap::new();
        let mut last: Option<(Rgb, u32)> = None;
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

        let mut counted: Vec<(Rgb, u32)> = counts.into_iter().collect();
        // Colours of one count follow each other by their values, so that the same frame always has the same palette.
        counted.sort_by_key(|&(color, count)| (std::cmp::Reverse(count), color));
        let kept: Vec<Rgb> = counted.iter().take(room).map(|(color, _)| *color).collect();

        let by_color: HashMap<Rgb, u8> = (counted.iter().enumerate())
            .map(|(place, &(color, _))| match u8::try_from(place) {
                Ok(index) if place < room => (color, index),
                // A colour that did not fit takes the nearest one that did.
                _ => (color, nearest(&kept, color)),
            })
            .collect();

        // Where some pixels stay, `room` has left the index after the colours for them.
        let transparent = some_stay.then_some(kept.len() as u8);
        let index_of = |(pixel, stays): (&[u8], &bool)| match transparent {
            Some(transparent) if *stays => transparent,
            _ => by_color[&on_white(pixel)],
        };

        let indices = pixels().map(index_of).collect();
        let mut palette = kept.into_flattened();
        // The colour at the transparent index is never seen, but the table must have an entry there.
        palette.extend(transparent.map(|_| [0; 3]).into_iter().flatten());
        Self {
            palette,
            pixels: indices,
            transparent,
        }
    }
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

/// Returns the colour of a pixel that is laid on white. Half of the divisor, 127, rounds to the nearest.
fn on_white(pixel: &[u8]) -> Rgb {
    let opacity = u32::from(pixel[3]);
    [0, 1, 2].map(|k| ((u32::from(pixel[k]) * opacity + 255 * (255 - opacity) + 127) / 255) as u8)
}
