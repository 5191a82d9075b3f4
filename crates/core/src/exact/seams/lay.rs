//! The samples that are laid down: those of each block near its border, and those deeper ones that are asked about.
//!
//! A *tile* is the part of a block in the frame, and a *piece* the part of a tile that one copy of the pattern fills.
//! *Late* darts are those of the levels of which the pattern's history keeps no refused ones.

use glam::I64Vec2;

use crate::engine::parallel::clip::{Clipper, PlacedBlock};
use crate::exact::agenda::What;
use crate::exact::filter::SampleFilter;
use crate::exact::pieces::pieces;
use crate::exact::seams::disks::DOUBTFUL;
use crate::exact::seams::{ListedSample, PatternFate, SeamTile, SeamTiling};
use crate::lattice::{Point, R, Rect, Rect64, covers_offset};
use crate::pattern::Symmetry;

/// Samples deeper in their block than this are listed only where they are asked about. So deep no disk touches a cell
/// that two blocks share, so that a cell's list has deep samples of one block alone: such a cell reaches at most R into
/// a block, and a disk R farther. The half of R above these 2 R is a margin, chosen, not measured. Near the end of what
/// is known, those at most R inside the part where late darts are known, or outside of it, are listed, too.
pub(super) const DEEP: i64 = 5 * R as i64 / 2;

/// No place of a frame is so far from another one, and sums of two such distances still fit 32 bits.
const FAR: i64 = 1 << 28;

impl SeamTiling<'_> {
    /// Adds the tile `rect` of a block: the part of it that lies in the frame. `placed` is the block's index among
    /// those of the frame. `is_cut` says whether places of the tile may lie outside of the shape.
    pub(super) fn add_tile(&mut self, block: &PlacedBlock, placed: u32, rect: Rect, is_cut: bool) {
        let (tile, first_piece) = (self.tiles.len() as u32, self.bounds.len() as u32);
        let symmetry = Symmetry(block.symmetry);
        // Late darts at places that something unknown may cover are not thrown.
        if let Some(core) = Rect64::from(rect).within(&self.ground.core()) {
            // `block.start` is where the turned pattern has the lowest place of the block enlarged by r. `pieces` needs
            // where the turned pattern has the lowest place of `core` enlarged by r.
            let start = I64Vec2::from(block.start) + I64Vec2::from(core.min) - block.rect.min;
            let pattern_rect = self.history.pattern().domain().rect();
            for piece in pieces(tile, &core, start, symmetry, &pattern_rect) {
                self.bounds.push(piece.placed(&piece.sources));
                self.marked.add(piece);
            }
        }

        // A block's border may be far outside 32 bits. A border beyond `FAR` is near no place of the frame, so that it
        // does not matter where exactly the border lies.
        let cut_off = |at: I64Vec2| {
            let at = at.clamp(I64Vec2::splat(-FAR), I64Vec2::splat(FAR));
            Point::new(at.x as i32, at.y as i32)
        };
        let whole = Rect {
            min: cut_off(block.rect.min),
            max: cut_off(block.rect.max),
        };
        // Where something is unknown, the frame's edge counts as a border of the tile, too: samples near it may depend on
        // samples beyond. Without unknowns only the block's own border matters.
        let has_unknown = self.ground.has_unknown();
        self.tiles.push(SeamTile {
            block: block.index,
            placed,
            rect,
            whole: if has_unknown { rect } else { whole },
            symmetry,
            moved: self.ground.moved(block),
            first_piece,
            end_piece: self.bounds.len() as u32,
            is_cut,
            missing: SampleFilter::default(),
        });
    }

    /// Lists the samples of the last tile that are near its border. The pattern's samples around the tile count as lost
    /// from the beginning: the darts that they refused are woken.
    #[inline(always)]
    pub(super) fn clip(&mut self, clipper: &Clipper, block: &PlacedBlock) {
        let tile = self.tiles.len() as u32 - 1;
        let SeamTile { whole, .. } = self.tiles[tile as usize];
        let target = self.ground.rect();

        let interior = self.interior(tile);
        for part in Rect64::from(whole).without(&interior) {
            clipper.clip(block, &part, &target, |x, y, pattern| {
                let place = Point::new(x, y);
                // A sample outside of the shape counts as lost: the darts that it refused are decided again.
                if self.is_outside(tile, place) {
                    self.release(tile, place, pattern);
                    return;
                }
                let id = self.list_near(place, tile, pattern);
                // A sample deeper than r stays, since samples of other blocks cover only places within r of the border.
                // But late darts that are not thrown, near the unknown part, may cover it, too.
                if whole.depth(place) <= R || self.is_late_near_unknown(place, pattern) {
                    self.agenda.add(self.dart(id), What::Sample(id));
                }
            });
        }

        // A sample at most r outside may be the first blocker of darts inside.
        let reach = i64::from(R);
        let around = Rect {
            min: Point::new(target.min.x - R, target.min.y - R),
            max: Point::new(target.max.x + R, target.max.y + R),
        };
        let whole = Rect64::from(whole);
        for part in whole.grown(reach, reach).without(&whole) {
            clipper.clip(block, &part, &around, |x, y, pattern| {
                self.wake(tile, Point::new(x, y), pattern);
            });
        }
    }

    /// Lists a sample of the pattern in all cells that its disk touches, and returns its id.
    #[inline(always)]
    fn list_near(&mut self, place: Point, tile: u32, pattern: u32) -> u32 {
        let id = self.samples.len() as u32;
        self.samples.push(ListedSample {
            place,
            tile,
            number: pattern,
            is_left_out: false,
        });
        self.disks
            .add(place, self.history.arrival(pattern).when(), id);
        id
    }

    /// Returns the cell of a place of a tile, whose list has samples deep in the block, too, from now on.
    #[inline(always)]
    pub(super) fn whole_cell(&mut self, clipper: &Clipper, place: Point, tile: u32) -> usize {
        let cell = self.disks.cell(place);
        self.make_whole(clipper, cell, place, tile);
        cell
    }

    /// Lists the samples deep in the block of a tile in the cell of a place, unless it has them. Returns whether it got any.
    #[inline(always)]
    pub(super) fn make_whole(
        &mut self,
        clipper: &Clipper,
        cell: usize,
        place: Point,
        tile: u32,
    ) -> bool {
        !self.disks.make_whole(cell) && self.complete(clipper, cell, place, tile)
    }

    /// Adds to a cell's list the samples deep in a block whose disks touch the cell. Returns whether there are any.
    #[inline(never)]
    fn complete(&mut self, clipper: &Clipper, cell: usize, place: Point, tile: u32) -> bool {
        let placed = self.tiles[tile as usize].placed;
        let min = Point::new(place.x & -R, place.y & -R);
        // Samples beyond the frame are in no list.
        let end = self.ground.rect().max;
        let around = Rect {
            min: Point::new((min.x - R).max(0), (min.y - R).max(0)),
            max: Point::new((min.x + 2 * R).min(end.x), (min.y + 2 * R).min(end.y)),
        };
        // Most cells that are asked about lie near the border.
        let interior = self.interior(tile);
        if interior.within(&around).is_none() {
            return false;
        }

        let (block, before) = (self.blocks[placed as usize], self.samples.len());
        clipper.clip(&block, &interior, &around, |x, y, pattern| {
            let at = Point::new(x, y);
            // Disks of samples in the corners may pass the cell by.
            let nearest = Point::new(x.clamp(min.x, min.x + R - 1), y.clamp(min.y, min.y + R - 1));
            if !covers_offset(at - nearest) {
                return;
            }

            // The sample may be lost, or have become doubtful while only other cells listed it. Both are rare. The
            // filter `missing` has all such samples. Where a tile has several copies of the pattern, the sample has a
            // place in each copy: only fates of this place count.
            let mut is_doubtful = false;
            if self.tiles[tile as usize].missing.may_have(pattern) {
                let fates = self.fates.of(tile, pattern);
                let mut own = fates.filter(|fate| fate.place == at);
                match own.next() {
                    // A lost sample may have been doubtful before, and its last fate comes first.
                    Some(PatternFate { is_lost: true, .. }) => return,
                    fate => is_doubtful = fate.is_some(),
                }
            }

            // Each cell that lists the sample gives it an id of its own. None of these is handed out, since the sample
            // is copied with the interior.
            let id = self.samples.len() as u32;
            self.samples.push(ListedSample {
                place: at,
                tile,
                number: pattern,
                is_left_out: true,
            });
            let when = self.history.arrival(pattern).when();
            let listed = if is_doubtful { id | DOUBTFUL } else { id };
            self.disks.add_to(cell, at, when, listed);
        });
        self.samples.len() > before
    }

    /// Returns the places so deep in the `whole` of a tile that samples there are listed only where they are asked about. A small
    /// one has none, and one that the shape cuts has none either, as its samples may lie at the shape's border. The rectangle is
    /// then empty, but still lies in `whole`, since callers ask for the rest of it around the rectangle.
    #[inline(always)]
    pub(super) fn interior(&self, tile: u32) -> Rect64 {
        let SeamTile { whole, is_cut, .. } = &self.tiles[tile as usize];
        // Rectangles are half open, so that the lowest place is 0 deep, and the highest one is 1 deep.
        let deeper = |rect: &Rect, deep: i64| Rect64::from(*rect).grown(-deep - 1, -deep);
        let Rect64 { mut min, mut max } = deeper(whole, DEEP);
        // Late samples of the pattern near the border of the known part may depend on the plane beyond.
        if let Some(known) = self.ground.late_known() {
            let known = deeper(&known, R.into());
            (min, max) = (min.max(known.min), max.min(known.max));
        }

        if !is_cut && min.cmplt(max).all() {
            Rect64 { min, max }
        } else {
            let min = I64Vec2::from(whole.min);
            Rect64 { min, max: min }
        }
    }
}
