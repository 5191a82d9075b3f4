//! Tiling and elimination of a region. Interiors of blocks are copied without tests; samples near a block's border
//! claim their disks in the order of elimination, one by one (`claim_one`): a sample is eliminated if a survivor before
//! it covers it (`Region::covered`). See `stages::eliminate` for the definition; here it is arranged so that almost
//! nothing must be sorted.
//!
//! A block is filled with a *clip*, the part of the pattern in the block enlarged by r; the enlargement is its *margin*. The
//! region works on a rectangle of cells, its *frame*. A *tag* names the origin of a sample.

use fearless_simd::Simd;
use glam::IVec2;

use crate::lattice::{R, Rect, Rect64, covers_offset};
use crate::parameters::Order;
use crate::stages::order::Ranking;

use super::clip::{Clipper, PlacedBlock};
use super::region::{Loss, Region, flag, push};

/// A sample near a border, compared by the order of elimination.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Contested {
    rank: u32,
    sequence: u32,
    /// The sample's position in its block's clip, which determines its id in a run.
    row: i64,
    column: i64,
    x: i32,
    y: i32,
    tag: u64,
}

/// How samples near the borders are ordered.
pub(crate) enum Turns<'a> {
    /// Block after block, own and margin samples alike.
    Index,
    /// All own samples block after block, then all margin samples block after block.
    OwnFirst,
    /// By rank, then block, then position.
    Sorted(&'a Ranking),
}

impl<'a> Turns<'a> {
    /// Returns how samples are ordered for `order`. Within a block the sequence does not matter, since the samples of
    /// one clip are never in conflict, unless the block touches an image of itself.
    pub(crate) fn new(order: Order, touches_itself: bool, ranking: &'a Ranking) -> Self {
        match order {
            Order::Index if !touches_itself => Self::Index,
            Order::OwnBlockFirst if !touches_itself => Self::OwnFirst,
            _ => Self::Sorted(ranking),
        }
    }
}

/// Returns the tag of a sample clipped from the pattern's sample `pattern` for the block number `block`.
pub(crate) fn tiled_tag(block: u32, pattern: u32) -> u64 {
    u64::from(block) << 32 | u64::from(pattern)
}

impl<const TAGS: bool> Region<TAGS> {
    /// Tiles the frame and decides the fates of all tiled samples, as far as they can be known from the frame.
    #[inline(always)]
    pub(crate) fn claim<S: Simd>(&mut self, simd: S, clipper: &Clipper, turns: &Turns<'_>) {
        // The list is taken out of the region, which changes meanwhile.
        let blocks = std::mem::take(&mut self.blocks);

        // The margin of another block reaches r into a block. A sample deeper than 2 r is farther than r from all
        // samples of that margin. If all own samples come first, no margin eliminates an own sample. Then only the own
        // samples of other blocks can, and these lie outside the block: a sample deeper than r is safe.
        let depth = i64::from(if matches!(turns, Turns::OwnFirst) {
            R
        } else {
            2 * R
        });

        let target = self.frame.tiled();

        // Nothing can eliminate the samples of the interiors: they are copied without a test.
        for block in &blocks {
            let inner = interior(block, depth);
            // Samples without tags are computed eight at a time. With tags they are inserted one by one, since the tag
            // is kept beside the slot.
            if TAGS {
                clipper.clip(block, &inner, &target, |x, y, id| {
                    self.insert(x, y, tiled_tag(block.index, id));
                });
            } else {
                let slots = &mut self.slots;
                clipper.clip_slots(simd, block, &inner, &self.frame, |cell, slot| {
                    push(&mut slots[cell], slot);
                });
            }
        }

        match turns {
            Turns::Index => {
                for block in &blocks {
                    self.claim_own(simd, clipper, block, depth, &target);
                    self.claim_margin(simd, clipper, block, &target);
                }
            }
            Turns::OwnFirst => {
                for block in &blocks {
                    self.claim_own(simd, clipper, block, depth, &target);
                }
                for block in &blocks {
                    self.claim_margin(simd, clipper, block, &target);
                }
            }
            Turns::Sorted(ranking) => {
                self.claim_sorted(simd, clipper, ranking, &blocks, depth, &target);
            }
        }

        self.blocks = blocks;
    }

    /// Decides the fates of a block's own samples that are not in its interior, in the order in which they are clipped.
    /// A block lies in the domain, and so do its own samples. They need no test for it, unlike those of margins.
    #[inline(always)]
    fn claim_own<S: Simd>(
        &mut self,
        simd: S,
        clipper: &Clipper,
        block: &PlacedBlock,
        depth: i64,
        target: &Rect,
    ) {
        // All are clipped before the first is decided, since a decision needs the whole region.
        self.waiting.clear();
        for part in block.rect.without(&interior(block, depth)) {
            clipper.clip(block, &part, target, |x, y, id| {
                self.waiting.push((x, y, tiled_tag(block.index, id)));
            });
        }

        for k in 0..self.waiting.len() {
            let (x, y, tag) = self.waiting[k];
            self.claim_one(simd, x, y, tag);
        }
    }

    /// Decides the fates of the samples in a block's margin, in the order in which they are clipped.
    #[inline(always)]
    fn claim_margin<S: Simd>(
        &mut self,
        simd: S,
        clipper: &Clipper,
        block: &PlacedBlock,
        target: &Rect,
    ) {
        // As in `claim_own`, all are clipped before the first is decided.
        self.waiting.clear();
        for part in block.rect.grown(R.into(), R.into()).without(&block.rect) {
            clipper.clip(block, &part, target, |x, y, id| {
                self.waiting.push((x, y, tiled_tag(block.index, id)));
            });
        }

        for k in 0..self.waiting.len() {
            let (x, y, tag) = self.waiting[k];
            if self.frame.holds(x, y) {
                self.claim_one(simd, x, y, tag);
            } else {
                // A sample outside of a bounded domain is lost like an eliminated one: places that it covered may now
                // be bare.
                self.lose(x, y, Loss::Certain);
            }
        }
    }

    /// Decides the fates of all samples of margins, and of those at most `depth` units inside their blocks, in the
    /// order of their ranks.
    fn claim_sorted<S: Simd>(
        &mut self,
        simd: S,
        clipper: &Clipper,
        ranking: &Ranking,
        blocks: &[PlacedBlock],
        depth: i64,
        target: &Rect,
    ) {
        // The buffer is taken out of the region, which changes meanwhile. `Region::reset` has emptied it.
        let mut contested = std::mem::take(&mut self.contested);
        for block in blocks {
            let own = block.rect.without(&interior(block, depth));
            let margin = block.rect.grown(R.into(), R.into()).without(&block.rect);

            for (part, is_own) in own
                .map(|p| (p, true))
                .into_iter()
                .chain(margin.map(|p| (p, false)))
            {
                clipper.clip(block, &part, target, |x, y, id| {
                    // Outside of a bounded domain samples are dropped: they take no part in the elimination.
                    if !self.frame.holds(x, y) {
                        self.lose(x, y, Loss::Certain);
                        return;
                    }
                    contested.push(Contested {
                        // The rank is drawn for the place in the domain, so that all windows rank a sample alike.
                        rank: ranking.rank(self.frame.point(x, y), is_own),
                        sequence: block.sequence,
                        row: i64::from(y) - block.rect.min[1],
                        column: i64::from(x) - block.rect.min[0],
                        x,
                        y,
                        tag: tiled_tag(block.index, id),
                    });
                });
            }
        }

        // No two are equal, as the position is compared too: an unstable sort has one result.
        contested.sort_unstable();
        for sample in &contested {
            self.claim_one(simd, sample.x, sample.y, sample.tag);
        }
        self.contested = contested;
    }

    /// Decides one sample: all samples before it in the order are decided.
    #[inline(always)]
    fn claim_one<S: Simd>(&mut self, simd: S, x: i32, y: i32, tag: u64) {
        if self.covered(simd, x, y) {
            self.lose(x, y, Loss::Certain);
            return;
        }

        // Flags are read first: few samples are near the edge or one of unknown fate, and only there is more to look
        // at.
        let cell = self.frame.cell_at(x, y);
        let flags = self.flags[cell];
        if flags & (flag::EDGE | flag::NEAR_UNKNOWN) != 0 && self.is_unknown(x, y, cell) {
            self.lose(x, y, Loss::Unknown);
            self.make_unsure(cell);
            self.flag_around(cell, flag::NEAR_UNKNOWN);
            return;
        }

        self.insert(x, y, tag);
    }

    /// Returns whether a sample before (x, y) in the order that may cover it has no known fate.
    #[cold]
    fn is_unknown(&self, x: i32, y: i32, cell: usize) -> bool {
        // Samples beyond the edge are not known, and one of them may come first.
        if self.flags[cell] & flag::EDGE != 0 {
            return true;
        }

        // Samples are decided in their order, so that all that are listed as lost come before this one. Cells have
        // sides of r: a sample that covers (x, y) lies in its cell or in one of the eight around it.
        let stride = self.frame.stride();
        let rows = [cell - stride, cell, cell + stride];
        rows.into_iter()
            .flat_map(|row| row - 1..=row + 1)
            .any(|near| {
                self.lost_in(near).any(|lost| {
                    lost.loss == Loss::Unknown && covers_offset(IVec2::new(lost.x - x, lost.y - y))
                })
            })
    }
}

/// Returns the places that are more than `depth` units inside a block. The block is half open, so that below and left
/// it takes a unit more.
#[inline(always)]
fn interior(block: &PlacedBlock, depth: i64) -> Rect64 {
    block.rect.grown(-depth - 1, -depth)
}
