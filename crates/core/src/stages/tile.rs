//! Clip and tile: every block, enlarged by r, receives a clip of the pattern (paper, Algorithm 2). Conflicts stay:
//! neighbouring clips overlap by design, and elimination resolves them.

use glam::I64Vec2;

use crate::error::{PatternError, SampleError};
use crate::lattice::{Domain, Point, R, Rect};
use crate::pattern::{Pattern, PatternVariant, Symmetry};
use crate::progress::Meter;
use crate::random::{Stream, below};
use crate::record::{Recorder, RunEvent};
use crate::samples::{Fate, Origin, Samples};
use crate::stages::blocks::{Block, Blocks};

/// The clip of a block.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Tile {
    /// The pattern's point on the enlarged block's lowest corner.
    pub start: Point,
    /// The symmetry under which the pattern was clipped.
    pub symmetry: Symmetry,
    /// The ids of the tile's samples.
    pub samples: std::ops::Range<u32>,
}

/// Appends every block's clip to `samples`, block by block and row by row, and returns the tiles. With `dihedral` each clip is
/// taken from one of the eight rotations and mirror images of the pattern.
///
/// In a periodic domain positions wrap; in a bounded one samples outside are [`Fate::Dropped`].
/// With each block enlarged by r the union of the tiles is maximal (paper, Theorem 3.1): a
/// pattern sample farther than r from a block cannot cover a point of it.
pub(crate) fn tile<T: Recorder>(
    domain: &Domain,
    blocks: &Blocks,
    pattern: &Pattern,
    dihedral: bool,
    samples: &mut Samples,
    mut meter: Meter<'_>,
    recorder: &mut T,
) -> Result<Vec<Tile>, SampleError> {
    // Turning a pattern sorts its samples: that is done once, not for every block.
    let symmetries = if dihedral { 8 } else { 1 };
    let variants: Vec<PatternVariant> = (0..symmetries)
        .map(|s| pattern.variant(Symmetry(s)))
        .collect();
    let mut clip = Vec::new();
    let mut tiles = Vec::with_capacity(blocks.leaves.len());

    for (block, index) in blocks.leaves.iter().zip(0..) {
        let [word, _] = block.key.draw(Stream::Dihedral, 0);
        let symmetry = below(word, variants.len() as u32);
        let variant = &variants[symmetry as usize];
        let start = clip_start(block, variant)?;

        let (width, height) = enlarged(&block.rect);
        clip.clear();
        variant.clip(start, width, height, |x, y, id| clip.push((y, x, id)));
        // A seam of the repeated pattern may break the order within a row.
        clip.sort_unstable();

        recorder.record(RunEvent::Clip { block: index });
        let first = samples.len() as u32;
        // Algorithm 2 scales the clip by the ratio of the sets (lines 4 and 10). On the lattice pattern and result have
        // the same radius, so it is only translated (line 9).
        let corner = I64Vec2::from(block.rect.min) - i64::from(R);
        for &(y, x, id) in &clip {
            let at = corner + I64Vec2::new(x.into(), y.into());
            push_tiled(domain, &block.rect, at, index, id, samples);
            // The event is put together once for each sample, which is spared where nothing is recorded.
            if T::ENABLED {
                recorder.record(RunEvent::Tiled {
                    sample: samples.len() as u32 - 1,
                    block: index,
                    inside: samples.fates.last() != Some(&Fate::Dropped),
                });
            }
        }

        let ids = first..samples.len() as u32;
        tiles.push(Tile {
            start,
            symmetry: Symmetry(symmetry as u8),
            samples: ids,
        });
        // The progress is counted in tiles, but the time until the observer is asked again in samples: a tile may hold
        // thousands.
        meter.work(clip.len() as u64)?;
        meter.tick()?;
    }
    meter.end()?;
    Ok(tiles)
}

/// Appends a sample of the clip of `block` to `samples`, at the place `at` of the plane. A periodic domain wraps the
/// place; outside of a bounded domain the sample is dropped. `index` is the number of the block, and `pattern` is the
/// sample's number in the pattern.
#[inline]
pub(crate) fn push_tiled(
    domain: &Domain,
    block: &Rect,
    at: I64Vec2,
    index: u32,
    pattern: u32,
    samples: &mut Samples,
) {
    let inside = |x: i64, min: i32, max: i32| (i64::from(min)..i64::from(max)).contains(&x);
    // Decided before the place wraps: a margin that crosses a periodic border is still a margin, also where it comes
    // back into its own block.
    let own = inside(at.x, block.min.x, block.max.x) && inside(at.y, block.min.y, block.max.y);
    let origin = Origin::Tiled {
        block: index,
        pattern,
        own,
    };

    match domain.wrap(at) {
        Some(point) => samples.push(point, origin, Fate::Undecided),
        // At most one radius outside, which 32 bits hold in the longest domain.
        None => samples.push(Point::new(at.x as i32, at.y as i32), origin, Fate::Dropped),
    }
}

/// Returns the width and the height of a block that is enlarged by r.
const fn enlarged(rect: &Rect) -> (i32, i32) {
    (rect.width() + 2 * R, rect.height() + 2 * R)
}

/// Returns the pattern's point on the lowest corner of a block enlarged by r. It is drawn by the block's key from all
/// points at which the enlarged block fits the pattern; fails if there are none.
pub(crate) fn clip_start(block: &Block, variant: &PatternVariant) -> Result<Point, PatternError> {
    let (width, height) = enlarged(&block.rect);
    let radii = |units: i32| f64::from(units) / f64::from(R);

    // An enlarged block fits a bounded pattern only at some starts, those for which the block lies in the paper's
    // shrunk domain (Theorem 3.1), or at none. It fits a periodic one everywhere. The starts fill a half-open
    // rectangle that begins at (0, 0).
    let starts = variant
        .starts(width, height)
        .ok_or_else(|| PatternError::TooSmall {
            block: [radii(block.rect.width()), radii(block.rect.height())],
            pattern: [radii(variant.width), radii(variant.height)],
        })?;

    let [x, y] = block.key.draw(Stream::Offset, 0);
    Ok(Point::new(
        below(x, starts.max.x as u32) as i32,
        below(y, starts.max.y as u32) as i32,
    ))
}
